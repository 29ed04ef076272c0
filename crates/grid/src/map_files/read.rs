//! Reading maps of any format.

use std::io::{BufRead, BufReader, Cursor, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};

use crate::Grid;
use crate::map_files::decoded::GreyImage;
use crate::map_files::error::with_room;
use crate::map_files::map::{MapFile, Reading};
use crate::map_files::pictures::{self, PictureFormat};
use crate::map_files::pixel::Transparency;
use crate::map_files::raster::tiff_header;
use crate::map_files::ros::{self, OccupiedPixels, RosMap};
use crate::map_files::rows::{Comments, without_mark};
use crate::map_files::text::Separator;
use crate::map_files::{Fault, MAX_BYTES, MapError, carried, moving_ai, npy, png, pnm, text, tiff_image};
use wildfire_base::input_file;
use wildfire_base::input_file::{InputFile, TextReader, is_standard_stream, is_utf16};

const BUFFER_BYTES: usize = 1 << 16;

/// Reads a map; pixels of images are occupied where their grey value is at most the tolerance.
///
/// The format is recognised by the content, never by the name: images (PNG, JPEG, WebP, GIF, BMP, TIFF, and Netpbm, P1 to
/// P7); rows of 0 (free) and 1 (occupied), or of `.` and `#`; tables of the numbers 0 and 1 with commas, semicolons, spaces
/// or tabs between them; NumPy arrays of these; Moving AI maps, where `.` and `G` are free and everything else is occupied,
/// swamp (`S`) and water (`W`) too; and the YAML file of a ROS map, which names its image. A picture of a map that this
/// program drew is the map that it shows. Images that are not 8-bit grey are converted, which a note says: alpha over
/// white, colours by their luma, other ranges of values scaled to 0 to 255.
///
/// # Errors
/// If the file is no such map, or breaks off, or is larger than [`MAX_SIDE`](super::MAX_SIDE) or
/// [`MAX_CELLS`](super::MAX_CELLS) allow. What a header declares is checked before any memory is taken for it.
pub fn read(path: &Path, reading: impl Into<Reading>) -> Result<MapFile, MapError> {
    finish(path, read_content(path, Transparency::OverWhite)?, reading.into())
}

/// Reads a map from the bytes of a file, whose path is used in errors and to find the image of a ROS map.
///
/// # Errors
/// Fails as [`read`] does.
pub fn read_bytes(path: &Path, bytes: Vec<u8>, reading: impl Into<Reading>) -> Result<MapFile, MapError> {
    let length = bytes.len() as u64;
    let content = if bytes.is_empty() {
        Err(Fault::Empty)
    } else {
        read_file(Cursor::new(bytes), length, Transparency::OverWhite)
    };
    let content = content.map_err(|fault| MapError { path: path.to_owned(), fault })?;
    finish(path, content, reading.into())
}

/// Returns whether bytes, judged by their start, are neither an image nor a table nor a map of another program: rows of
/// cells, or JSON.
pub fn is_plain_text(bytes: &[u8]) -> bool {
    let mut start = Vec::new();
    // An end within a character does not matter here.
    _ = TextReader::new(&bytes[..bytes.len().min(BUFFER_BYTES)]).read_to_end(&mut start);
    let has_comments = start.starts_with(b"# ") || start.windows(2).any(|pair| pair == b"\n#");
    match MapFormat::from_first_bytes(&start) {
        Ok(MapFormat::Sequential(SequentialFormat::Text(Comments::Everywhere))) => !has_comments,
        Ok(MapFormat::Sequential(SequentialFormat::Text(comments))) => comments == Comments::None,
        Ok(MapFormat::Whole(WholeFormat::Ros)) => false,
        _ => start.trim_ascii_start().starts_with(b"{"),
    }
}

fn finish(path: &Path, content: FileContent, reading: Reading) -> Result<MapFile, MapError> {
    match content {
        FileContent::Grey(GreyImage { grey, notes, .. }) => Ok(MapFile::from_grey(grey, notes, reading)),
        FileContent::Cells(mut occupied, note) => {
            if reading.inverted {
                occupied.values_mut().iter_mut().for_each(|cell| *cell = !*cell);
            }
            Ok(MapFile { notes: Vec::from_iter(note), reading, ..MapFile::from_cells(occupied) })
        }
        FileContent::Ros(text) => {
            let map = RosMap::parse(&text).map_err(|fault| MapError { path: path.to_owned(), fault })?;
            read_ros_map(&map, &folder_of(path), reading)
        }
    }
}

/// Reads the image of a ROS map, whose path begins in the folder of its YAML file.
fn read_ros_map(map: &RosMap, folder: &Path, reading: Reading) -> Result<MapFile, MapError> {
    let path = folder.join(&map.image);
    let found = match read_content(&path, map.transparency())? {
        FileContent::Grey(image) => Ok(image),
        FileContent::Cells(..) => Err("a map of cells"),
        FileContent::Ros(_) => Err("another YAML file"),
    };
    let image = found.map_err(|found| MapError { path, fault: Fault::NoImage { found } })?;
    let OccupiedPixels { occupied, unknown } = map.occupied(&image, reading.inverted);
    let mut notes = image.notes;
    if unknown > 0 {
        notes.push(format!("cells that are neither free nor occupied count as occupied (cells: {unknown})"));
    }
    if map.place.origin[2] != 0.0 {
        notes.push(format!("the heading of the map's origin, {} radians, is ignored", map.place.origin[2]));
    }
    Ok(MapFile { place: Some(map.place), reading, notes, ..MapFile::from_cells(occupied) })
}

/// The folder in which the paths of a file begin; for stdin the current one.
fn folder_of(path: &Path) -> PathBuf {
    let parent = path.parent().filter(|_| !is_standard_stream(path));
    parent.map(Path::to_owned).unwrap_or_default()
}

/// The content of a file, before it is decided which cells are occupied.
enum FileContent {
    Grey(GreyImage),
    Cells(Grid<bool>, Option<String>),
    /// The text of a YAML file.
    Ros(String),
}

fn read_content(path: &Path, transparency: Transparency) -> Result<FileContent, MapError> {
    let opened = input_file::open(path).map_err(not_opened);
    let read = opened.and_then(|input| match input {
        InputFile::Regular(_, 0) => Err(Fault::Empty),
        InputFile::Regular(_, bytes) if bytes > MAX_BYTES => Err(Fault::TooLarge { bytes }),
        InputFile::Regular(file, bytes) => read_file(BufReader::with_capacity(BUFFER_BYTES, file), bytes, transparency),
        stream => read_stream(stream, transparency),
    });
    read.map_err(|fault| MapError { path: path.to_owned(), fault })
}

fn not_opened(error: std::io::Error) -> Fault {
    if error.kind() == ErrorKind::IsADirectory { Fault::Folder } else { error.into() }
}

fn read_file<R: BufRead + Seek>(mut source: R, bytes: u64, transparency: Transparency) -> Result<FileContent, Fault> {
    if is_utf16(source.fill_buf()?) {
        return read_stream(&mut source as &mut dyn Read, transparency);
    }
    match MapFormat::from_first_bytes(source.fill_buf()?)? {
        MapFormat::Png => match carried::length(source.fill_buf()?) {
            Some(length) => read_carried(source, length, bytes),
            None => png::read(source, bytes, transparency).map(FileContent::Grey),
        },
        MapFormat::Whole(format) => read_whole(format, source, transparency),
        MapFormat::Sequential(format) => read_sequential(format, source, bytes, transparency),
    }
}

/// Reads the map that a picture of this program carries, which follows the header in `length` bytes.
fn read_carried(mut source: impl Read, length: usize, bytes: u64) -> Result<FileContent, Fault> {
    let end = carried::HEADER_BYTES + length;
    if end as u64 > bytes {
        return Err(Fault::Image { message: "the file ends within its embedded map".to_owned() });
    }
    let mut start = with_room(end)?;
    source.by_ref().take(end as u64).read_to_end(&mut start)?;
    let occupied = carried::read(&start[carried::HEADER_BYTES..])?;
    Ok(FileContent::Cells(occupied, Some("the picture embeds its map, which is read".to_owned())))
}

/// Reads an input that has no way back, a pipe, a device or stdin: its first bytes are kept, as they show the format,
/// and those of most images are all kept.
fn read_stream(stream: impl Read, transparency: Transparency) -> Result<FileContent, Fault> {
    let mut stream = TextReader::new(stream);
    let mut start = Vec::new();
    stream.by_ref().take(BUFFER_BYTES as u64).read_to_end(&mut start)?;
    let bytes = start.len() as u64;
    if start.is_empty() {
        return Err(Fault::Empty);
    }
    match MapFormat::from_first_bytes(&start)? {
        MapFormat::Png => {
            let image = png::read_bytes(start, stream)?;
            let bytes = image.len() as u64;
            read_file(Cursor::new(image), bytes, transparency)
        }
        MapFormat::Whole(format) => read_whole(format, Cursor::new(start).chain(stream), transparency),
        MapFormat::Sequential(format) => {
            let rest = BufReader::with_capacity(BUFFER_BYTES, stream.take(MAX_BYTES - bytes));
            read_sequential(format, Cursor::new(start).chain(rest), bytes, transparency)
        }
    }
}

/// Keeps all bytes of an input, of which there may be no more than such a file has, and reads them.
fn read_whole(format: WholeFormat, source: impl Read, transparency: Transparency) -> Result<FileContent, Fault> {
    let max = match format {
        WholeFormat::Picture(_) | WholeFormat::Tiff => pictures::MAX_FILE,
        WholeFormat::Ros => ros::MAX_FILE,
    };
    let mut bytes = Vec::new();
    // One byte more than may be read shows that the input exceeds the limit.
    source.take(max + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max {
        return Err(Fault::GoesBeyond { max });
    }
    match format {
        WholeFormat::Picture(format) => format.read(&bytes, transparency).map(FileContent::Grey),
        WholeFormat::Tiff => tiff_image::read(&bytes, transparency).map(FileContent::Grey),
        WholeFormat::Ros => Ok(FileContent::Ros(input_file::text(bytes)?)),
    }
}

/// Reads from front to end. `bytes` is how many bytes there are at least, which says how much room to make at first.
fn read_sequential(
    format: SequentialFormat,
    source: impl BufRead,
    bytes: u64,
    transparency: Transparency,
) -> Result<FileContent, Fault> {
    match format {
        SequentialFormat::Pnm => pnm::read(source, bytes, transparency).map(FileContent::Grey),
        SequentialFormat::MovingAi => {
            moving_ai::read(source, bytes).map(|(occupied, note)| FileContent::Cells(occupied, note))
        }
        SequentialFormat::Npy => npy::read(source, bytes).map(|occupied| FileContent::Cells(occupied, None)),
        SequentialFormat::Table(separator) => {
            text::read_table(source, bytes, separator).map(|occupied| FileContent::Cells(occupied, None))
        }
        SequentialFormat::Text(comments) => {
            text::read_text(source, bytes, comments).map(|occupied| FileContent::Cells(occupied, None))
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MapFormat {
    Png,
    Whole(WholeFormat),
    Sequential(SequentialFormat),
}

/// The formats of which all bytes are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum WholeFormat {
    Picture(PictureFormat),
    Tiff,
    Ros,
}

/// The formats that are read from front to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SequentialFormat {
    Pnm,
    MovingAi,
    Npy,
    Table(Separator),
    Text(Comments),
}

/// The first bytes of files that people may take for maps.
const FOREIGN: &[(&[u8], &str)] = &[
    (b"RIFF", "a RIFF file that is not a WebP image"),
    (b"%PDF", "a PDF document"),
    (b"<", "an SVG image or another XML document"),
    (b"{", "JSON text"),
    (b"\x1F\x8B", "a gzip file"),
    (b"PK\x03\x04", "a ZIP archive"),
];

/// Names files of boxes, whose first box says what they are: photographs of telephones, and films.
///
/// Source: ISO/IEC 14496-12, "ISO base media file format", section 4.3; ISO/IEC 23008-12, "Image File Format", section 10.
fn boxed_kind(start: &[u8]) -> Option<&'static str> {
    if start.get(4..8) != Some(b"ftyp") {
        return None;
    }
    let length = start.first_chunk().map_or(0, |length| u32::from_be_bytes(*length) as usize);
    let brands = start.get(8..length.min(start.len())).unwrap_or_default();
    let has = |expected: &[&[u8]]| brands.chunks_exact(4).any(|brand| expected.contains(&brand));
    Some(if has(&[b"avif", b"avis"]) {
        "an AVIF image, which an image editor can save as PNG"
    } else if has(&[b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"mif1", b"msf1"]) {
        "a HEIC image, which an image editor can save as PNG"
    } else {
        "a film or another file of the MP4 family"
    })
}

impl MapFormat {
    /// Tells the format from the first bytes of a file.
    fn from_first_bytes(start: &[u8]) -> Result<Self, Fault> {
        if let Some(picture) = PictureFormat::from_first_bytes(start) {
            return Ok(Self::Whole(WholeFormat::Picture(picture)));
        }
        if let Some(found) = boxed_kind(start) {
            return Err(Fault::Foreign { found });
        }
        let text = without_mark(start);
        // Before the foreign kinds, as JSON begins with a brace too.
        if ros::is_flow_start(text) {
            return Ok(Self::Whole(WholeFormat::Ros));
        }
        if let Some((_, found)) = FOREIGN.iter().find(|(signature, _)| start.starts_with(signature)) {
            return Err(Fault::Foreign { found });
        }
        let comments = Comments::of_text(text);
        let first_line = comments.first_row(text);
        Ok(if start.starts_with(png::SIGNATURE) {
            Self::Png
        } else if tiff_header::is_start(start) {
            Self::Whole(WholeFormat::Tiff)
        } else if start.starts_with(npy::SIGNATURE) {
            Self::Sequential(SequentialFormat::Npy)
        } else if pnm::is_start(start) {
            Self::Sequential(SequentialFormat::Pnm)
        } else if first_line.starts_with(b"type ") {
            Self::Sequential(SequentialFormat::MovingAi)
        } else if ros::is_start(text) {
            Self::Whole(WholeFormat::Ros)
        } else {
            // Text without a signature is a table if its first line has separators.
            match Separator::of_first_line(first_line) {
                Some(separator) => Self::Sequential(SequentialFormat::Table(separator)),
                None => Self::Sequential(SequentialFormat::Text(comments)),
            }
        })
    }
}
