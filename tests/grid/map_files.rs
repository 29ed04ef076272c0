//! Maps are read whatever their format, refused with their place where they are wrong, and written for other tools.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use image::codecs::bmp::BmpEncoder;
use image::codecs::gif::GifEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};
use rand::RngExt;
use tempfile::TempDir;
use wildfire::grid::{Grid, drawn};
use wildfire::map_files::{self, MapFile, MapPlace, Reading, Tolerance};
use wildfire::rng;

const ROWS: usize = 3;
const COLS: usize = 4;

/// 3 rows of 4 cells that differ in every symmetry of the rectangle.
fn small_map() -> Grid<bool> {
    Grid::from_values(ROWS, COLS, b"100001100100".iter().map(|&byte| byte == b'1').collect())
}

fn small_grey() -> Grid<u8> {
    let values = small_map().values().iter().map(|&occupied| if occupied { 0 } else { 255 }).collect();
    Grid::from_values(ROWS, COLS, values)
}

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a scratch folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        // Collected with the separators of the system.
        self.0.path().join(name).components().collect()
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, bytes).expect("writable");
        path
    }

    fn read(&self, bytes: &[u8]) -> MapFile {
        map_files::read(&self.file("map", bytes), 50).expect("a map")
    }

    /// What is said about such a file, without its path, with which every error begins.
    fn objection(&self, bytes: &[u8]) -> String {
        objection_to(&self.file("map", bytes))
    }
}

fn objection_to(path: &Path) -> String {
    let sentence = map_files::read(path, 50).expect_err("no map").to_string();
    let start = format!("{}: ", path.display());
    sentence.strip_prefix(&start).expect("an error begins with the path").to_owned()
}

/// A PNG file of the given header fields whose image data are `raw`, filter bytes included.
fn png(cols: u32, rows: u32, depth: u8, colour_type: u8, extra: &[(&[u8; 4], &[u8])], raw: &[u8]) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |name: &[u8; 4], data: &[u8]| {
        let body = [name, data].concat();
        file.extend_from_slice(&(data.len() as u32).to_be_bytes());
        file.extend_from_slice(&body);
        file.extend_from_slice(&crc32fast::hash(&body).to_be_bytes());
    };
    let sides = [cols.to_be_bytes(), rows.to_be_bytes()].concat();
    chunk(b"IHDR", &[&sides[..], &[depth, colour_type, 0, 0, 0]].concat());
    extra.iter().for_each(|(name, data)| chunk(name, data));
    chunk(b"IDAT", &miniz_oxide::deflate::compress_to_vec_zlib(raw, 6));
    chunk(b"IEND", &[]);
    file
}

fn encoded_png(cols: u32, rows: u32, colour_type: ExtendedColorType, pixels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    PngEncoder::new(&mut file).write_image(pixels, cols, rows, colour_type).expect("it can be encoded");
    file
}

/// An image in the format of an encoder of the crate `image`.
fn encoded(
    pixels: &[u8],
    colour_type: ExtendedColorType,
    encode: impl Fn(&mut Vec<u8>, &[u8], ExtendedColorType),
) -> Vec<u8> {
    let mut file = Vec::new();
    encode(&mut file, pixels, colour_type);
    file
}

fn jpeg(pixels: &[u8], colour_type: ExtendedColorType) -> Vec<u8> {
    encoded(pixels, colour_type, |file, pixels, colour_type| {
        let encoder = JpegEncoder::new_with_quality(file, 100);
        encoder.write_image(pixels, COLS as u32, ROWS as u32, colour_type).expect("it can be encoded");
    })
}

fn webp(pixels: &[u8], colour_type: ExtendedColorType) -> Vec<u8> {
    encoded(pixels, colour_type, |file, pixels, colour_type| {
        let encoder = WebPEncoder::new_lossless(file);
        encoder.write_image(pixels, COLS as u32, ROWS as u32, colour_type).expect("it can be encoded");
    })
}

fn bmp(pixels: &[u8], colour_type: ExtendedColorType) -> Vec<u8> {
    encoded(pixels, colour_type, |file, pixels, colour_type| {
        let encoder = BmpEncoder::new(file);
        encoder.write_image(pixels, COLS as u32, ROWS as u32, colour_type).expect("it can be encoded");
    })
}

/// A GIF of so many frames, of which the first shows the pixels and the others their negative.
fn gif(rgb: &[u8], frames: usize) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = GifEncoder::new(&mut file);
    for frame in 0..frames {
        let pixels: Vec<u8> = rgb.iter().map(|&value| if frame == 0 { value } else { 255 - value }).collect();
        encoder.encode(&pixels, COLS as u32, ROWS as u32, ExtendedColorType::Rgb8).expect("it can be encoded");
    }
    drop(encoder);
    file
}

/// A TIFF image, little-endian and not packed, from its tags (number, type, value) and the bytes of one strip.
fn tiff(depth: u32, samples: u32, photometric: u32, extra: &[(u16, u32)], strip: &[u8]) -> Vec<u8> {
    let mut tags = vec![
        (256, COLS as u32),
        (257, ROWS as u32),
        (258, depth),
        (259, 1),
        (262, photometric),
        (273, 8),
        (277, samples),
        (278, ROWS as u32),
        (279, strip.len() as u32),
    ];
    tags.extend(extra);
    tags.sort_unstable();
    let mut file = b"II*\0".to_vec();
    file.extend_from_slice(&(8 + strip.len() as u32).to_le_bytes());
    file.extend_from_slice(strip);
    file.extend_from_slice(&(tags.len() as u16).to_le_bytes());
    for (tag, value) in tags {
        file.extend_from_slice(&tag.to_le_bytes());
        // Two samples fit into the field itself; more than two depths would not.
        let is_pair = tag == 258 && samples == 2;
        let (kind, count, value) = if is_pair { (3u16, 2u32, value << 16 | value) } else { (4, 1, value) };
        file.extend_from_slice(&kind.to_le_bytes());
        file.extend_from_slice(&count.to_le_bytes());
        file.extend_from_slice(&value.to_le_bytes());
    }
    file.extend_from_slice(&[0; 4]);
    file
}

/// A text in UTF-16, little-endian with a mark.
fn utf16(text: &str) -> Vec<u8> {
    std::iter::once(0xFEFF).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
}

/// A PAM image of this tuple type.
fn pam(tuple_type: &str, depth: u8, max: u16, samples: &[u8]) -> Vec<u8> {
    let tuple_type = if tuple_type.is_empty() { String::new() } else { format!("TUPLTYPE {tuple_type}\n") };
    let head = format!("P7\n# made\nWIDTH {COLS}\nHEIGHT {ROWS}\nDEPTH {depth}\nMAXVAL {max}\n{tuple_type}ENDHDR\n");
    [head.as_bytes(), samples].concat()
}

/// A NumPy array of such a type and order from the bytes of its values.
fn npy(descr: &str, fortran_order: &str, shape: &str, values: &[u8]) -> Vec<u8> {
    let dictionary = format!("{{'descr': {descr}, 'fortran_order': {fortran_order}, 'shape': {shape}, }}\n");
    [b"\x93NUMPY\x01\0", &(dictionary.len() as u16).to_le_bytes()[..], dictionary.as_bytes(), values].concat()
}

/// The small map in every format that is read.
fn small_map_files() -> Vec<(&'static str, Vec<u8>)> {
    let grey = small_grey();
    let rgb: Vec<u8> = grey.values().iter().flat_map(|&value| [value; 3]).collect();
    let wide: Vec<u8> = grey.values().iter().flat_map(|&value| [value; 2]).collect();
    let by_rows: Vec<u8> = small_map().values().iter().map(|&cell| u8::from(cell)).collect();
    let by_columns: Vec<u8> = (0..12).map(|at| by_rows[at % 3 * 4 + at / 3]).collect();
    let widened = |big_endian: bool, bytes: usize| -> Vec<u8> {
        let place = if big_endian { bytes - 1 } else { 0 };
        by_rows.iter().flat_map(|&cell| (0..bytes).map(move |at| if at == place { cell } else { 0 })).collect()
    };
    let floats =
        |bytes: fn(f32) -> Vec<u8>| -> Vec<u8> { by_rows.iter().flat_map(|&cell| bytes(cell.into())).collect() };
    vec![
        ("NumPy bool", npy("'|b1'", "False", "(3, 4)", &by_rows)),
        ("NumPy bool by columns", npy("'|b1'", "True", "(3, 4)", &by_columns)),
        ("NumPy u1", npy("\"|u1\"", "False", "(3,4,)", &by_rows)),
        ("NumPy i8, LE", npy("'<i8'", "False", "(3, 4)", &widened(false, 8))),
        ("NumPy u2, BE", npy("'>u2'", "False", "(3, 4)", &widened(true, 2))),
        ("NumPy i4, BE", npy("'>i4'", "False", "(3, 4)", &widened(true, 4))),
        ("NumPy f4, LE", npy("'<f4'", "False", "(3, 4)", &floats(|cell| cell.to_le_bytes().to_vec()))),
        ("NumPy f8, BE", npy("'>f8'", "False", "(3, 4)", &floats(|cell| f64::from(cell).to_be_bytes().to_vec()))),
        ("JPEG", jpeg(grey.values(), ExtendedColorType::L8)),
        ("JPEG of colours", jpeg(&rgb, ExtendedColorType::Rgb8)),
        ("WebP", webp(&rgb, ExtendedColorType::Rgb8)),
        ("WebP of grey", webp(grey.values(), ExtendedColorType::L8)),
        ("GIF", gif(&rgb, 1)),
        ("GIF of several frames", gif(&rgb, 3)),
        ("BMP", bmp(&rgb, ExtendedColorType::Rgb8)),
        ("BMP of grey", bmp(grey.values(), ExtendedColorType::L8)),
        ("TIFF", tiff(8, 1, 1, &[], grey.values())),
        ("TIFF of 1 bit", tiff(1, 1, 1, &[], &[0x70, 0x90, 0xB0])),
        ("TIFF of 1 bit, white is zero", tiff(1, 1, 0, &[], &[0x8F, 0x6F, 0x4F])),
        ("TIFF of 4 bits", tiff(4, 1, 1, &[], &[0x0F, 0xFF, 0xF0, 0x0F, 0xF0, 0xFF])),
        ("TIFF of 16 bits", tiff(16, 1, 1, &[], &wide)),
        ("TIFF of 1 bit, lowest first", tiff(1, 1, 1, &[(266, 2)], &[0x0E, 0x09, 0x0D])),
        // The rows 1000, 0110 and 0100 as libtiff packs them.
        ("TIFF of modified Huffman rows", tiff(1, 1, 1, &[(259, 2)], b"\x1E\x35\x4E\x80\x35\x43\xE0")),
        ("TIFF of Group 3", tiff(1, 1, 1, &[(259, 3)], b"\x00\x11\xE0\x01\x35\x4E\x80\x04\xD5\x0F\x80")),
        (
            "TIFF of Group 3 in two dimensions",
            tiff(1, 1, 1, &[(259, 3), (292, 1)], b"\x00\x18\xF0\x00\x90\x25\x00\x19\xAA\x1F"),
        ),
        (
            "TIFF of 8 bits, white is zero",
            tiff(8, 1, 0, &[], &by_rows.iter().map(|&cell| cell * 255).collect::<Vec<_>>()),
        ),
        ("text", b"1000\n0110\n0100\n".to_vec()),
        ("text without last line feed", b"1000\n0110\n0100".to_vec()),
        ("text of Windows", b"\xEF\xBB\xBF1000\r\n0110\r\n0100\r\n\r\n".to_vec()),
        ("text with blank lines and spaces behind it", b"1000 \n0110\t\n0100\n\n  \n\n".to_vec()),
        ("CSV", b"1,0,0,0\n0,1,1,0\n0,1,0,0\n".to_vec()),
        ("CSV with spaces", b"\xEF\xBB\xBF 1, 0 ,0,0\r\n0,1,1,0\r\n0,1, 0,\t0\r\n\n".to_vec()),
        ("table with spaces", b"1 0 0 0\n0 1 1 0\n0 1 0 0\n".to_vec()),
        ("table with spaces and tabs", b"  1 0\t\t0   0\r\n0 1 1 0 \r\n0 1 0 0".to_vec()),
        ("table with semicolons", b"1;0;0;0\n0; 1 ;1;0\n0;1;0;0\n".to_vec()),
        ("table of floats", b"1.0,0.0,0,0\n0,1,1e0,0\n-0.0,1.00,0e5,0\n".to_vec()),
        (
            "table as NumPy writes it",
            by_rows
                .chunks(COLS)
                .map(|row| {
                    row.iter().map(|cell| format!("{cell}.000000000000000000e+00")).collect::<Vec<_>>().join(" ")
                })
                .collect::<Vec<_>>()
                .join("\n")
                .into_bytes(),
        ),
        ("text of letters", b"#...\n.##.\n.#..\n".to_vec()),
        ("Moving AI", b"type octile\nheight 3\nwidth 4\nmap\n@..G\n.TO.\nG@..\n".to_vec()),
        (
            "Moving AI, width first",
            b"type octile\r\nwidth 4\r\nheight 3\r\nmap\r\nT...\r\n.OT.\r\n.@..\r\n\r\n".to_vec(),
        ),
        ("table with comments", b"# walls\n1 0 0 0\n#\n0 1 1 0\n0 1 0 0\n# end\n".to_vec()),
        ("text with comments", b"#####\n# walls: 0\n1000\n0110\n0100\n".to_vec()),
        ("text of letters below a comment", b"# a map\n#...\n.##.\n.#..\n".to_vec()),
        ("text in UTF-16", utf16("1000\r\n0110\r\n0100\r\n")),
        ("table in UTF-16", utf16("1;0;0;0\n0;1;1;0\n0;1;0;0\n")),
        ("Moving AI in UTF-16", utf16("type octile\nheight 3\nwidth 4\nmap\n@...\n.TT.\n.T..\n")),
        ("P7", pam("GRAYSCALE", 1, 255, grey.values())),
        ("P7 without a type", pam("", 1, 255, grey.values())),
        ("P7 black and white", pam("BLACKANDWHITE", 1, 1, &grey.values().iter().map(|&v| v / 255).collect::<Vec<_>>())),
        ("P7 of 16 bits", pam("GRAYSCALE", 1, 65_535, &wide)),
        ("P7 with colours", pam("RGB", 3, 255, &rgb)),
        (
            "P7 with alpha",
            pam("GRAYSCALE_ALPHA", 2, 255, &by_rows.iter().flat_map(|&cell| [0, 255 * cell]).collect::<Vec<_>>()),
        ),
        ("P1", b"P1\n# made by hand\n4 3\n1000\n0 1 1 0\n0100".to_vec()),
        ("P2", b"P2 4 3 255\n0 255 255 255 255 0 0 255\n# half\n255 0 255 255\n".to_vec()),
        ("P2 with another largest value", b"P2 4 3 9 0 9 9 9 9 0 0 9 9 1 9 9".to_vec()),
        (
            "P3",
            format!("P3\n4 3\n255\n{}", rgb.iter().map(|value| format!("{value} ")).collect::<String>()).into_bytes(),
        ),
        ("P4", b"P4\n4 3\n\x80\x60\x4f".to_vec()),
        ("P5", [b"P5\n4 3\n255\n", grey.values()].concat()),
        ("P5 of 16 bits", [b"P5 4 3 65535\n", &wide[..]].concat()),
        ("P6", [b"P6 4 3 255\n", &rgb[..]].concat()),
        ("PNG", encoded_png(4, 3, ExtendedColorType::L8, grey.values())),
        ("PNG of colours", encoded_png(4, 3, ExtendedColorType::Rgb8, &rgb)),
        ("PNG of 1 bit", png(4, 3, 1, 0, &[], &[0, 0x70, 0, 0x90, 0, 0xB0])),
        ("PNG with palette", png(4, 3, 1, 3, &[(b"PLTE", &[255, 255, 255, 20, 0, 30])], &[0, 0x80, 0, 0x60, 0, 0x40])),
    ]
}

#[test]
fn every_format_gives_the_same_map() {
    let folder = Folder::new();
    for (name, bytes) in small_map_files() {
        let path = folder.file("map", &bytes);
        let map = map_files::read(&path, 50).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(map.occupied, small_map(), "{name}");
        let is_image = ["P", "JPEG", "WebP", "GIF", "BMP", "TIFF"].iter().any(|start| name.starts_with(start));
        assert_eq!(map.grey.is_some(), is_image, "{name}: images have grey values");
        assert_eq!(map.tolerance, is_image.then_some(50), "{name}");
    }
}

#[test]
fn eight_bit_grey_is_read_as_it_is() {
    let folder = Folder::new();
    let ramp: Vec<u8> = (0..=255).collect();
    for bytes in [[b"P5 32 8 255\n", &ramp[..]].concat(), encoded_png(32, 8, ExtendedColorType::L8, &ramp)] {
        let map = folder.read(&bytes);
        assert_eq!(map.grey, Some(Grid::from_values(8, 32, ramp.clone())));
        assert!(map.notes.is_empty());
    }
}

#[test]
fn pixel_as_dark_as_the_tolerance_is_occupied() {
    let folder = Folder::new();
    let path = folder.file("map", b"P2 5 1 255 0 49 50 51 255");
    let occupied = |tolerance| map_files::read(&path, tolerance).expect("a map").occupied.values().to_vec();
    assert_eq!(occupied(50), [true, true, true, false, false]);
    assert_eq!(occupied(49), [true, true, false, false, false]);
    assert_eq!(occupied(0), [true, false, false, false, false]);
    assert_eq!(occupied(255), [true; 5]);
}

#[test]
fn conversion_to_eight_bit_grey_is_noted() {
    let folder = Folder::new();
    let wide = |values: &[u16]| values.iter().flat_map(|value| value.to_ne_bytes()).collect::<Vec<u8>>();
    let luma = "grey = 0.299 R + 0.587 G + 0.114 B";
    let palette: &[(&[u8; 4], &[u8])] = &[(b"PLTE", &[255, 0, 0, 0, 0, 0]), (b"tRNS", &[255, 0])];
    let cases: [(Vec<u8>, [u8; 2], String); 8] = [
        (
            encoded_png(2, 1, ExtendedColorType::L16, &wide(&[0x8000, 0xFFFF])),
            [128, 255],
            "(16-bit grey) was converted to 8-bit grey: values 0 to 65535 scaled to 0 to 255".into(),
        ),
        (
            encoded_png(2, 1, ExtendedColorType::La8, &[0, 0, 100, 255]),
            [255, 100],
            "(8-bit grey with alpha) was converted to 8-bit grey: laid over white".into(),
        ),
        (
            encoded_png(2, 1, ExtendedColorType::Rgb8, &[255, 0, 0, 0, 0, 255]),
            [76, 29],
            format!("(8-bit RGB) was converted to 8-bit grey: {luma}"),
        ),
        (
            encoded_png(2, 1, ExtendedColorType::Rgba16, &wide(&[0, 0, 0, 0, 0, 0xFFFF, 0, 0xFFFF])),
            [255, 150],
            format!(
                "(16-bit RGB with alpha) was converted to 8-bit grey: laid over white, {luma}, values 0 to 65535 scaled to 0 to 255"
            ),
        ),
        (
            png(2, 1, 2, 0, &[], &[0, 0b0110_0000]),
            [85, 170],
            "(2-bit grey) was converted to 8-bit grey: values 0 to 3 scaled to 0 to 255".into(),
        ),
        (
            png(2, 1, 1, 3, palette, &[0, 0b0100_0000]),
            [76, 255],
            format!("(1-bit palette with alpha) was converted to 8-bit grey: laid over white, {luma}"),
        ),
        (
            b"P2 2 1 100 50 100".to_vec(),
            [128, 255],
            "(grey) was converted to 8-bit grey: values 0 to 100 scaled to 0 to 255".into(),
        ),
        (
            b"P4 2 1 \x40".to_vec(),
            [255, 0],
            "(black and white) was converted to 8-bit grey: values 0 to 1 scaled to 0 to 255".into(),
        ),
    ];
    for (bytes, grey, note) in cases {
        let map = folder.read(&bytes);
        assert_eq!(map.notes, [format!("the image {note}")]);
        assert_eq!(map.grey.expect("an image").values(), grey, "{note}");
    }
}

#[test]
fn swamp_and_water_are_occupied_and_noted() {
    let map = Folder::new().read(b"type octile\nheight 1\nwidth 5\nmap\n.SGWW\n");
    assert_eq!(map.occupied.values(), [false, true, false, true, true]);
    assert_eq!(map.notes, ["swamp (S) and water (W) count as occupied (cells: 3)"]);
}

#[test]
fn faults_of_text_are_named_with_row_and_column() {
    let folder = Folder::new();
    let cell = "expected 0 (free) or 1 (occupied)";
    let cases: [(&[u8], String); 22] = [
        (b"010\n0x0\n", format!("row 1, column 1: found 'x', {cell}")),
        (b"010\n01\xC3\xA9\n", format!("row 1, column 2: found '\u{e9}', {cell}")),
        (b"\xFF\x01\x02", format!("row 0, column 0: found byte 0xFF, {cell}")),
        (b"0 1\n0 2\n", format!("row 1, column 1: found \"2\", {cell}")),
        (b"0;1\n0;\n", format!("row 1, column 1: found \"\", {cell}")),
        (b"0\t1\n0\n", "row 1, column 1: the width of the row is 1, expected 2".into()),
        (b"0.0,1e-3\n", format!("row 0, column 1: found \"1e-3\", {cell}")),
        (b"0.0\n1.0\n", format!("row 0, column 1: found '.', {cell}")),
        (b".#.\n.0.\n", "row 1, column 1: found '0', expected . (free) or # (occupied)".into()),
        (b"0,1\n0,a\x07b\n", format!("row 1, column 1: found byte 0x07, {cell}")),
        (b"\xE9\xFE,\x01\n", format!("row 0, column 0: found byte 0xE9, {cell}")),
        (b"01\r10\r", format!("row 0, column 2: found '\\r', {cell}")),
        (b"010\n01\n", "row 1, column 2: the width of the row is 2, expected 3".into()),
        (b"010\n0101\n", "row 1, column 3: the width of the row is 4, expected 3".into()),
        (b"010\n\n010\n", "row 1, column 0: the line is blank; expected a row of cells".into()),
        (b"\n010\n", "row 0, column 0: the line is blank; expected a row of cells".into()),
        (b"\n \n", "the file is empty; expected a map".into()),
        (b"", "the file is empty; expected a map".into()),
        (b"0,1\n0,2\n", format!("row 1, column 1: found \"2\", {cell}")),
        (b"0,0.5\n", format!("row 0, column 1: found \"0.5\", {cell}")),
        (b"0,1,\n", format!("row 0, column 2: found \"\", {cell}")),
        (b"0,1\n0\n", "row 1, column 1: the width of the row is 1, expected 2".into()),
    ];
    for (bytes, expected) in cases {
        assert_eq!(folder.objection(bytes), expected);
    }
    let long = [b"1,", &b"23456"[..].repeat(100)[..]].concat();
    assert_eq!(folder.objection(&long), format!("row 0, column 1: found \"23456234562345623456\" and more, {cell}"));
}

#[test]
fn faults_of_moving_ai_maps_are_named_with_their_line_or_cell() {
    let folder = Folder::new();
    let header = |text: &str| folder.objection(format!("type octile\n{text}").as_bytes());
    let unknown = "expected `type octile`, `height ROWS`, `width COLUMNS` or `map`";
    assert_eq!(header("height x\nwidth 2\nmap\n"), "line 2: expected a size in whole cells, found \"x\"");
    assert_eq!(header("height -1\nwidth 2\nmap\n"), "line 2: expected a size in whole cells, found \"-1\"");
    assert_eq!(header("height 2\n\nwidth 2\n"), format!("line 3: {unknown}"));
    assert_eq!(header("height 2\nmap\n..\n..\n"), "line 3: the header has no `width`");
    assert_eq!(header("height 2\nwidth 2\n"), "line 3: the file ends before a line `map`");
    assert_eq!(
        header("height 2\nwidth 2\nmap\n..\n"),
        "row 1, column 0: the file ends; its header declares a height of 2 and a width of 2"
    );
    assert_eq!(
        header("height 1\nwidth 2\nmap\n..\n..\n"),
        "row 1, column 0: the file continues; its header declares a height of 1"
    );
    assert_eq!(header("height 2\nwidth 2\nmap\n..\n...\n"), "row 1, column 2: the width of the row is 3, expected 2");
    assert_eq!(
        header("height 2\nwidth 2\nmap\n..\n. .\n"),
        "row 1, column 1: found ' ', expected a letter of a Moving AI map"
    );
}

#[test]
fn faults_of_netpbm_images_are_named_with_their_pixel() {
    let folder = Folder::new();
    let declares = "its header declares a height of 2 and a width of 3";
    let damaged = "the image is damaged";
    let cases: [(&[u8], String); 13] = [
        (b"P5 3 2 255\nabcd", format!("row 1, column 1: the file ends; {declares}")),
        (b"P5 3 2 256\n\0a\0b\0cd", format!("row 1, column 0: the file ends; {declares}")),
        (b"P6 3 2 255\nabcdefghijklmno", format!("row 1, column 2: the file ends; {declares}")),
        (b"P2 3 2 255 0 0 0 0", format!("row 1, column 1: the file ends; {declares}")),
        (b"P1 3 2 0 0", format!("row 0, column 2: the file ends; {declares}")),
        (b"P5 3 2 255\nabcdefg", "row 2, column 0: the file continues; its header declares a height of 2".into()),
        (b"P2 2 1 255 0 x", "row 0, column 1: found 'x', expected a whole number".into()),
        (b"P1 2 1 0 2", "row 0, column 1: found '2', expected 0 or 1".into()),
        (b"P2 2 1 15 0 16", "row 0, column 1: found 16, expected at most 15, as the header declares".into()),
        (b"P5 2 1 0\n", format!("{damaged}: the largest value must be 1 to 65535")),
        (b"P5 2 1 70000\n", format!("{damaged}: the largest value must be 1 to 65535")),
        (b"P5 -2 1 255\n", format!("{damaged}: the width must be a whole number, found '-'")),
        (b"P5 2", format!("{damaged}: the file ends before the height")),
    ];
    for (bytes, expected) in cases {
        assert_eq!(folder.objection(bytes), expected);
    }
}

#[test]
fn first_of_several_images_is_read_and_that_is_said() {
    let folder = Folder::new();
    let rgb: Vec<u8> = small_grey().values().iter().flat_map(|&value| [value; 3]).collect();
    let converted = "the image (GIF, RGB with alpha) was converted to 8-bit grey: laid over white, grey = 0.299 R + 0.587 G + \
                     0.114 B";
    let several = "the file holds several images; the first was read";
    assert_eq!(folder.read(&gif(&rgb, 1)).notes, [converted]);
    assert_eq!(folder.read(&gif(&rgb, 2)).notes, [converted, several]);
    let mut pages = tiff(8, 1, 1, &[], small_grey().values());
    // The place of the next list of tags is the last word of this one; it is the same list once more.
    let tags = pages[8 + ROWS * COLS..].to_vec();
    let (end, next) = (pages.len() - 4, pages.len() as u32);
    pages[end..].copy_from_slice(&next.to_le_bytes());
    pages.extend(tags);
    let map = folder.read(&pages);
    assert_eq!((map.occupied, map.notes), (small_map(), vec![several.to_owned()]));
}

#[test]
fn orientation_tag_is_applied() {
    let folder = Folder::new();
    // 6: the first row of the file is the right side of the picture.
    let map = folder.read(&tiff(8, 1, 1, &[(274, 6)], small_grey().values()));
    assert_eq!((map.occupied.rows(), map.occupied.cols()), (COLS, ROWS));
    let turned = (0..COLS).flat_map(|row| (0..ROWS).map(move |col| (ROWS - 1 - col, row)));
    assert_eq!(map.occupied.values(), turned.map(|place| small_map()[place]).collect::<Vec<_>>());
    assert_eq!(map.notes, ["the image was turned as its orientation tag says"]);
}

#[test]
fn arrays_that_are_no_maps_are_refused_with_their_place() {
    let folder = Folder::new();
    let place = "expected 0 (free) or 1 (occupied); `array == 0` or `array > 0` converts it, depending on which value is an \
         obstacle";
    let by_dictionary = "expected a dictionary of `descr`, `fortran_order` and `shape`";
    let kinds = "expected bool, integers or floats of 32 or 64 bits";
    let types = format!("{kinds}: `array.astype(bool)` makes them so");
    let cases: [(Vec<u8>, String); 18] = [
        (npy("'<i2'", "False", "(1, 2)", &[1, 0, 0xFF, 0xFF]), format!("row 0, column 1: found -1, {place}")),
        (npy("'>u4'", "False", "(2, 1)", &[0, 0, 0, 1, 0, 0, 1, 1]), format!("row 1, column 0: found 257, {place}")),
        (npy("'|u1'", "True", "(2, 3)", &[0, 1, 1, 7, 0, 0]), format!("row 1, column 1: found 7, {place}")),
        (npy("'<u8'", "False", "(1, 1)", &[0xFF; 8]), format!("row 0, column 0: found {}, {place}", u64::MAX)),
        (npy("'|u1'", "False", "(1, 2)", &[0, 255]), format!("row 0, column 1: found 255, {place}")),
        (npy("'<f4'", "False", "(1, 1)", &0.5f32.to_le_bytes()), format!("row 0, column 0: found 0.5, {place}")),
        (npy("'>f8'", "False", "(1, 1)", &f64::NAN.to_be_bytes()), format!("row 0, column 0: found NaN, {place}")),
        (npy("'<f2'", "False", "(1, 1)", &[0; 2]), format!("this NumPy array holds values of type \"<f2\"; {types}")),
        (
            npy("'<U10'", "False", "(1, 1)", &[0; 40]),
            format!(
                "this NumPy array holds values of type \"<U10\"; {kinds}: `array.astype(int)` makes numbers of digits"
            ),
        ),
        (
            npy("[('a', '<i4')]", "False", "(1, 1)", &[0; 4]),
            format!("this NumPy array holds values of type \"several members\"; {types}"),
        ),
        (
            npy("'|b1'", "False", "(2,)", &[0; 2]),
            "this NumPy array has 1 dimension; expected two, rows and columns".into(),
        ),
        (
            npy("'|b1'", "False", "(1, 2, 2)", &[0; 4]),
            "this NumPy array has 3 dimensions; expected two, rows and columns".into(),
        ),
        (
            npy("'|b1'", "False", "(99999, 2)", &[]),
            "the height of the map is 99999 and its width 2; expected 1 to 32767 each, and at most 268435456 cells"
                .into(),
        ),
        (
            npy("'|b1'", "False", "(2, 2)", &[0; 3]),
            "row 1, column 1: the file ends; its header declares a height of 2 and a width of 2".into(),
        ),
        (
            npy("'|b1'", "False", "(1, 2)", &[0; 3]),
            "row 1, column 0: the file continues; its header declares a height of 1".into(),
        ),
        (
            npy("'|b1'", "0", "(1, 2)", &[0; 2]),
            format!("this NumPy array has a header without a proper `fortran_order`; {by_dictionary}"),
        ),
        (
            b"\x93NUMPY\x04\0\x09\0\0\0".to_vec(),
            "this NumPy array has format version 4.0; expected version 1.0, 2.0 or 3.0".into(),
        ),
        (b"\x93NUMPY\x01".to_vec(), "this NumPy array ends within its header; expected the whole of it".into()),
    ];
    for (bytes, expected) in cases {
        assert_eq!(folder.objection(&bytes), expected);
    }
}

#[test]
fn ros_map_is_read_with_its_image_and_keeps_its_place() {
    let folder = Folder::new();
    fs::create_dir(folder.path("maps")).expect("writable");
    // Occupied, free, unknown.
    folder.file("maps/hall.pgm", b"P5 3 1 255\n\x00\xFE\xCD");
    let yaml = "image: hall.pgm\nresolution: 0.05\norigin: [-10.0, 3, 0.5]\nnegate: 0\noccupied_thresh: 0.65\n\
                free_thresh: 0.196\n";
    let path = folder.file("maps/hall.yaml", yaml.as_bytes());
    let map = map_files::read(&path, 50).expect("a map");
    assert_eq!(map.occupied.values(), [true, false, true]);
    assert_eq!((map.grey, map.tolerance), (None, None));
    assert_eq!(map.place, Some(MapPlace { cell_m: 0.05, origin: [-10.0, 3.0, 0.5] }));
    assert_eq!(
        map.notes,
        [
            "cells that are neither free nor occupied count as occupied (cells: 1)",
            "the heading of the map's origin, 0.5 radians, is ignored"
        ]
    );
    let inverted = Reading { inverted: true, ..Reading::default() };
    assert_eq!(map_files::read(&path, inverted).expect("a map").occupied.values(), [false, true, true]);

    let missing = folder.file("maps/none.yaml", yaml.replace("hall.pgm", "none.pgm").as_bytes());
    let sentence = map_files::read(&missing, 50).expect_err("no image").to_string();
    assert!(
        sentence.starts_with(&format!("{}: cannot be read: ", folder.path("maps/none.pgm").display())),
        "{sentence}"
    );
    let itself = folder.file("maps/itself.yaml", yaml.replace("hall.pgm", "itself.yaml").as_bytes());
    assert_eq!(
        objection_to(&itself),
        "this is another YAML file; expected an image, as the YAML file of a ROS map names one"
    );
    let bad = folder.file("maps/bad.yaml", yaml.replace("0.05", "0").as_bytes());
    assert_eq!(objection_to(&bad), "line 2: `resolution` is 0; expected a side in metres above 0");
    let long = folder.file("maps/long.yaml", yaml.repeat(1000).as_bytes());
    assert_eq!(objection_to(&long), "the file has more than 65536 bytes, the limit for files of this kind");
}

#[test]
fn transparent_pixels_of_ros_maps_are_unknown() {
    let folder = Folder::new();
    // White of alpha 0, 254 and 255, then opaque black.
    let alphas = [(255, 0), (255, 254), (255, 255), (0, 255)];
    let samples =
        |of: fn(u8, u8) -> Vec<u8>| alphas.iter().flat_map(|&(grey, alpha)| of(grey, alpha)).collect::<Vec<u8>>();
    let greys = samples(|grey, alpha| vec![grey, alpha]);
    let colours = samples(|grey, alpha| vec![grey, grey, grey, alpha]);
    let wide = samples(|grey, alpha| [[grey; 2], [alpha; 2]].concat());
    let mut webp = Vec::new();
    WebPEncoder::new_lossless(&mut webp).encode(&colours, 4, 1, ExtendedColorType::Rgba8).expect("it can be encoded");
    let palette: &[(&[u8; 4], &[u8])] =
        &[(b"PLTE", &[255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0]), (b"tRNS", &[0, 254])];
    let pam = b"P7\nWIDTH 4\nHEIGHT 1\nDEPTH 2\nMAXVAL 255\nTUPLTYPE GRAYSCALE_ALPHA\nENDHDR\n";
    let images = [
        ("grey", encoded_png(4, 1, ExtendedColorType::La8, &greys)),
        ("colours", encoded_png(4, 1, ExtendedColorType::Rgba8, &colours)),
        ("16 bits", encoded_png(4, 1, ExtendedColorType::La16, &wide)),
        ("palette", png(4, 1, 2, 3, palette, &[0, 0b0001_1011])),
        ("WebP", webp),
        ("PAM", [&pam[..], &greys].concat()),
    ];
    let yaml =
        "image: hall\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n";
    for (name, bytes) in images {
        folder.file("hall", &bytes);
        let read = |mode: &str| {
            map_files::read(&folder.file("hall.yaml", format!("{yaml}mode: {mode}\n").as_bytes()), 50).expect(name)
        };
        for mode in ["trinary", "scale"] {
            let map = read(mode);
            assert_eq!(map.occupied.values(), [true, true, false, true], "{name}, {mode}");
            assert!(map.notes[0].contains("transparent pixels are unknown"), "{name}: {:?}", map.notes);
            assert_eq!(map.notes[1], "cells that are neither free nor occupied count as occupied (cells: 2)");
        }
        // The mode without alpha: white is above 100, so unknown, and black is free.
        assert_eq!(read("raw").occupied.values(), [true, true, true, false], "{name}, raw");
        assert!(read("raw").notes[0].contains("alpha was ignored"));
    }
    // Grey and colours that stand for transparency.
    for (colour_type, key, raw) in
        [(0, &[0u8, 255][..], &[0u8, 255, 0][..]), (2, &[0, 255, 0, 255, 0, 255], &[0, 255, 255, 255, 0, 0, 0])]
    {
        folder.file("hall", &png(2, 1, 8, colour_type, &[(b"tRNS", key)], raw));
        let map = map_files::read(&folder.file("hall.yaml", yaml.as_bytes()), 50).expect("a map");
        assert_eq!((map.occupied.values(), map.notes.len()), (&[true, true][..], 2), "colour type {colour_type}");
    }
}

#[test]
fn ros_map_in_any_style_of_yaml_is_the_same() {
    let folder = Folder::new();
    folder.file("hall.pgm", b"P5 3 1 255\n\x00\xFE\xCD");
    let numbers = "resolution: 5.0e-2, origin: [-1, 2, 0], negate: no, occupied_thresh: 0.65, free_thresh: 0.196";
    let flow = format!("{{image: hall.pgm, {numbers}}}\n");
    let json = "{\"image\": \"hall.pgm\", \"resolution\": 0.05, \"origin\": [-1, 2, 0], \"negate\": 0, \
                \"occupied_thresh\": 0.65, \"free_thresh\": 0.196}";
    let block = numbers.replace("[-1, 2, 0]", "[-1; 2; 0]").replace(", ", "\n").replace(';', ",");
    let texts = [
        flow.clone(),
        format!("# hall\n---\n{flow}"),
        format!("--- {flow}...\n"),
        json.to_owned(),
        format!("\"image\": 'hall.pgm'\n{block}\n"),
        format!("%YAML 1.2\n---\n  image: hall.pgm\n  {}\n", block.replace('\n', "\n  ")),
    ];
    let maps = texts.map(|text| {
        let map = map_files::read(&folder.file("hall.yaml", text.as_bytes()), 50)
            .unwrap_or_else(|error| panic!("{error}: {text}"));
        (map.occupied.values().to_vec(), map.place)
    });
    let place = Some(MapPlace { cell_m: 0.05, origin: [-1.0, 2.0, 0.0] });
    assert!(maps.iter().all(|map| *map == (vec![true, false, true], place)), "{maps:?}");
    let utf16 = map_files::read(&folder.file("hall.yaml", &utf16(&flow)), 50).expect("a map");
    assert_eq!(utf16.place, place);
    let twice = folder.file("twice.yaml", format!("image: hall.pgm\n{block}\nresolution: 1\n").as_bytes());
    assert_eq!(objection_to(&twice), "line 7: `resolution` stands twice; expected it once");
    assert_eq!(
        folder.objection(b"type octile\nheight 1\nheight 2\nwidth 1\nmap\n.\n"),
        "line 3: `height` stands twice; expected it once"
    );
    assert!(folder.objection(b"{\"rows\": [\"01\"]}").starts_with("this is JSON text; "));
}

#[test]
fn tuples_of_netpbm_that_are_no_grey_or_colours_are_refused() {
    let folder = Folder::new();
    let objection = |text: &str| folder.objection(text.as_bytes());
    let head = "P7\nWIDTH 1\nHEIGHT 1\nDEPTH 4\nMAXVAL 255\n";
    let cmyk = objection(&format!("{head}TUPLTYPE CMYK\nENDHDR\nabcd"));
    assert!(
        cmyk.starts_with("this kind of PAM is not supported: its tuples are of type `CMYK` and depth 4;"),
        "{cmyk}"
    );
    let twice = objection(&format!("{head}WIDTH 2\nENDHDR\nabcd"));
    assert!(twice.contains("`WIDTH 2`; expected one number each for HEIGHT, WIDTH, DEPTH, MAXVAL"), "{twice}");
    assert!(objection("P7\nWIDTH 1\nDEPTH 1\nMAXVAL 1\nENDHDR\n\0").ends_with("its header has no HEIGHT"));
    assert!(objection(head).ends_with("its header has no line ENDHDR"));
    assert!(objection(&head.replace("255", "65536\nENDHDR")).ends_with("the largest value must be 1 to 65535"));
    assert!(objection(&format!("{head}ENDHDR\nabc")).starts_with("row 0, column 0: the file ends;"));
}

#[test]
fn tolerance_may_be_chosen_and_the_image_inverted() {
    let folder = Folder::new();
    // Grey walls on light ground.
    let path = folder.file("map", b"P2 5 1 255 100 110 200 210 220");
    let read = |tolerance, inverted| map_files::read(&path, Reading { tolerance, inverted }).expect("a map");
    let auto = read(Tolerance::Auto, false);
    assert_eq!((auto.occupied.values(), auto.tolerance), ([true, true, false, false, false].as_slice(), Some(154)));
    assert_eq!(auto.notes, ["the tolerance is 154, by Otsu's method"]);
    let negative = read(Tolerance::Auto, true);
    assert_eq!(negative.occupied.values(), [false, false, true, true, true]);
    assert_eq!(read(Tolerance::Grey(50), true).occupied.values(), [false, false, false, true, true]);
    let blank = map_files::read(
        &folder.file("map", b"P2 2 1 255 9 9"),
        Reading { tolerance: Tolerance::Auto, inverted: false },
    );
    let blank = blank.expect("a map");
    assert_eq!((blank.tolerance, blank.notes.len()), (Some(50), 1));
    let text = folder.file("map", b"01\n");
    assert_eq!(
        map_files::read(&text, Reading { inverted: true, ..Reading::default() }).expect("a map").occupied.values(),
        [true, false]
    );
}

#[test]
fn images_of_few_bytes_that_declare_many_pixels_are_refused() {
    let folder = Folder::new();
    // A lossless WebP of 16383 x 16383 pixels, and a GIF and a BMP with large screens.
    let webp = b"RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\xfe\xbf\xff\x0f\0\0\0\0\0\0\0\0\0";
    let gif = b"GIF89a\xff\x3f\xff\x3f\0\0\0,\0\0\0\0\x01\0\x01\0\0\x02\x02\x44\x01\0;";
    let mut bmp = bmp(small_grey().values(), ExtendedColorType::L8);
    bmp[18..26].copy_from_slice(&[0x60, 0x6D, 0, 0, 0x60, 0x6D, 0, 0]);
    let mut tiff = tiff(8, 1, 1, &[], small_grey().values());
    // Its first two tags are the sides.
    let first = 8 + ROWS * COLS + 2;
    tiff[first + 8..first + 12].copy_from_slice(&16_384u32.to_le_bytes());
    tiff[first + 20..first + 24].copy_from_slice(&16_384u32.to_le_bytes());
    for bytes in [&webp[..], &gif[..], &bmp, &tiff] {
        let sentence = folder.objection(bytes);
        let is_refused = ["expected at most", "cannot hold", "expected 1 to", "inconsistent sizes"]
            .iter()
            .any(|part| sentence.contains(part));
        assert!(is_refused, "{sentence}");
    }
}

#[test]
fn damaged_png_images_are_refused() {
    let folder = Folder::new();
    let whole = encoded_png(4, 3, ExtendedColorType::L8, small_grey().values());
    assert_eq!(folder.objection(&whole[..20]), "the image is damaged: the file ends within the header");
    assert!(folder.objection(&whole[..40]).starts_with("the image is damaged: "));
    assert!(folder.objection(&whole[..whole.len() - 20]).starts_with("the image is damaged: "));
    let missing_row = png(4, 3, 8, 0, &[], &[0; 10]);
    assert!(folder.objection(&missing_row).starts_with("the image is damaged: "));
    let bomb = png(32_767, 8_192, 8, 0, &[], &[0; 100]);
    assert_eq!(
        folder.objection(&bomb),
        format!("the image is damaged: {} bytes cannot hold a height of 8192 and a width of 32767", bomb.len())
    );
    let wide_colours = png(32_767, 8_192, 16, 6, &[], &[0; 100]);
    let too_large =
        "the pixels of the image take 2147418112 bytes, expected at most 536870912; 8-bit grey takes the least";
    assert_eq!(folder.objection(&wide_colours), too_large);
}

#[test]
fn jpeg_images_that_were_cut_off_are_refused_and_bytes_behind_the_end_are_not() {
    let folder = Folder::new();
    let pixels: Vec<u8> = small_grey().values().to_vec();
    let whole = jpeg(&pixels, ExtendedColorType::L8);
    let map = folder.read(&[&whole[..], b"\0\0 added by a scanner"].concat());
    assert_eq!(map.occupied, small_map());
    for end in [whole.len() / 2, whole.len() - 2, whole.len() - 1] {
        assert_eq!(
            folder.objection(&whole[..end]),
            "the image is damaged: the file ends before the image does",
            "{end} of {} bytes",
            whole.len()
        );
    }
}

#[test]
fn sound_images_of_a_kind_that_is_not_read_are_not_called_damaged() {
    let folder = Folder::new();
    let (grey, pixels) = (small_grey(), ROWS * COLS);
    let unread = |bytes: &[u8]| {
        let sentence = folder.objection(bytes);
        let reason = sentence.strip_prefix("this kind of TIFF is not supported: ").expect(&sentence).to_owned();
        assert!(reason.ends_with("; convert it, e.g. to PNG"), "{reason}");
        reason
    };
    let palette = tiff(8, 1, 3, &[(320, 8)], grey.values());
    assert!(unread(&palette).starts_with("its colours come from a palette;"));
    let floats = tiff(32, 1, 1, &[(339, 3)], &vec![0; 4 * pixels]);
    assert!(unread(&floats).starts_with("its samples are floats, or may be negative;"));
    assert!(unread(&tiff(32, 1, 1, &[], &vec![0; 4 * pixels])).starts_with("its samples have 32 bits;"));
}

#[test]
fn sizes_beyond_the_limits_are_refused() {
    let folder = Folder::new();
    let limits = "expected 1 to 32767 each, and at most 268435456 cells";
    for (rows, cols) in [(32_768, 1), (1, 32_768), (0, 5), (5, 0), (16_385, 16_384)] {
        let expected = format!("the height of the map is {rows} and its width {cols}; {limits}");
        let size_of = |bytes: &[u8]| folder.objection(bytes);
        assert_eq!(size_of(format!("P5 {cols} {rows} 255\n").as_bytes()), expected);
        assert_eq!(size_of(format!("type octile\nheight {rows}\nwidth {cols}\nmap\n").as_bytes()), expected);
        assert_eq!(size_of(&png(cols, rows, 8, 0, &[], &[0])), expected);
    }
    let goes_on = "the map continues; expected at most 32767 rows, 32767 columns and 268435456 cells";
    assert_eq!(folder.objection(&b"0".repeat(32_768)), format!("row 0, column 32767: {goes_on}"));
    assert_eq!(folder.objection(&b"0,".repeat(32_768)[..65_535]), format!("row 0, column 32767: {goes_on}"));
    assert_eq!(folder.objection(&b"0\n".repeat(32_768)), format!("row 32767, column 0: {goes_on}"));
    assert_eq!(folder.read(&b"0\n".repeat(32_767)).occupied.rows(), 32_767);
    assert_eq!(folder.read(&b"1".repeat(32_767)).occupied.cols(), 32_767);
    assert!(folder.objection(&b"1".repeat(600_000)).starts_with("line 1: the line is longer than 524272 bytes"));
}

#[test]
fn what_is_no_map_file_is_refused_in_words() {
    let folder = Folder::new();
    assert!(objection_to(&folder.path("missing")).starts_with("cannot be read: "));
    assert_eq!(objection_to(folder.0.path()), "this is a folder; expected a map file");
    let formats = "expected an image (PNG, JPEG, WebP, GIF, BMP, TIFF, PBM, PGM, PPM or PAM), rows of 0 and 1 or of . and \
                   #, a table or a NumPy array of 0 and 1, a Moving AI map, or the YAML file of a ROS map";
    assert_eq!(
        folder.objection(b"RIFF\0\0\0\0WAVE"),
        format!(
            "this is a RIFF file that is not a WebP image; \
        {formats}"
        )
    );
    let boxed = |brands: &[u8]| [&(16 + brands.len() as u32).to_be_bytes(), b"ftyp", brands, b"\0\0\0\0mdat"].concat();
    let saved = "which an image editor can save as PNG";
    for (brands, kind) in [
        (&b"heic\0\0\0\0mif1heic"[..], format!("a HEIC image, {saved}")),
        (b"mif1\0\0\0\0mif1avif", format!("an AVIF image, {saved}")),
        (b"isom\0\0\0\0mp42", "a film or another file of the MP4 family".to_owned()),
    ] {
        assert_eq!(folder.objection(&boxed(brands)), format!("this is {kind}; {formats}"));
    }
    assert_eq!(folder.objection(b"\x1F\x8B\x08"), format!("this is a gzip file; {formats}"));
}

#[test]
#[cfg(unix)]
fn endless_device_is_refused() {
    assert_eq!(
        objection_to(Path::new("/dev/zero")),
        "line 1: the line is longer than 524272 bytes, the limit for a row of a map"
    );
}

/// Files with holes, so that they take no room on the disk.
#[test]
fn huge_files_are_refused_at_once() {
    let folder = Folder::new();
    let path = folder.path("huge");
    let file = File::create(&path).expect("writable");
    file.set_len(5_000_000_000).expect("files may have holes");
    assert_eq!(objection_to(&path), "the file has 5000000000 bytes; expected at most 4294967296");
    file.set_len(4_000_000_000).expect("files may have holes");
    assert!(objection_to(&path).starts_with("line 1: the line is longer than"));
}

#[test]
fn damaged_files_of_every_format_are_read_or_refused_but_never_panic() {
    let folder = Folder::new();
    let mut rng = rng::stream(1, "damaged maps");
    let mut refused = 0;
    for (name, bytes) in small_map_files() {
        let mutations = (0..60).map(|_| mutated(&bytes, &mut rng)).collect::<Vec<_>>();
        let truncations = (0..bytes.len()).map(|end| bytes[..end].to_vec());
        for (number, damaged) in truncations.chain(mutations).enumerate() {
            let path = folder.file(&format!("{name} {number}"), &damaged);
            match map_files::read(&path, 50) {
                Ok(map) => assert!(!map.occupied.values().is_empty(), "{name}"),
                Err(error) => {
                    assert!(error.to_string().starts_with(&path.display().to_string()), "{name}: {error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 1000, "most of these are no maps");
}

/// The bytes with a few of them changed, inserted or left out.
fn mutated(bytes: &[u8], rng: &mut rng::Xoshiro256PlusPlus) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..rng.random_range(1..4) {
        let at = rng.random_range(0..bytes.len());
        let likely = [b'0', b'1', b'9', b' ', b'\n', b',', b'#', b'.', 0, 0xFF];
        let byte = if rng.random_bool(0.5) { likely[rng.random_range(0..likely.len())] } else { rng.random() };
        match rng.random_range(0..3) {
            0 => bytes[at] = byte,
            1 => bytes.insert(at, byte),
            _ => {
                // The last byte stays, so that there is something to mutate.
                if bytes.len() > 1 {
                    bytes.remove(at);
                }
            }
        }
    }
    bytes
}

#[test]
fn written_maps_are_read_again_as_they_were() {
    let folder = Folder::new();
    let path = folder.path("map");
    let mut rng = rng::stream(2, "round trips");
    for (rows, cols) in [(1, 1), (1, 70), (70, 1), (13, 21), (40, 33)] {
        let map = drawn::random(rows, cols, 0.4, &mut rng);
        map_files::write_text(&path, &map).expect("writable");
        assert_eq!(map_files::read(&path, 50).expect("a map").occupied, map);
        map_files::write_csv(&path, &map).expect("writable");
        assert_eq!(map_files::read(&path, 50).expect("a map").occupied, map);
        map_files::write_npy(&path, &map).expect("writable");
        assert_eq!(map_files::read(&path, 50).expect("a map").occupied, map);

        let grey = Grid::from_values(rows, cols, (0..rows * cols).map(|_| rng.random::<u8>()).collect());
        map_files::write_png(&path, &grey).expect("writable");
        let read = map_files::read(&path, 50).expect("a map");
        assert_eq!((read.grey, read.notes.len()), (Some(grey), 0));
    }
}

#[test]
fn csv_holds_integers_whole_and_floats_with_twelve_digits() {
    let folder = Folder::new();
    let path = folder.path("map.csv");
    let text = || fs::read_to_string(&path).expect("readable");
    map_files::write_csv(&path, &Grid::from_values(2, 3, vec![0u32, 1, 20, 300, 65_536, u32::MAX])).expect("writable");
    assert_eq!(text(), "0,1,20\n300,65536,4294967295\n");
    map_files::write_csv(&path, &Grid::from_values(1, 2, vec![0u16, u16::MAX])).expect("writable");
    assert_eq!(text(), "0,65535\n");
    map_files::write_csv(&path, &small_map()).expect("writable");
    assert_eq!(text(), "1,0,0,0\n0,1,1,0\n0,1,0,0\n");
    let floats = vec![1.0 / 3.0, 1e-5, 2.5, -0.0, f64::INFINITY, 1e15];
    map_files::write_csv(&path, &Grid::from_values(2, 3, floats)).expect("writable");
    assert_eq!(text(), "0.333333333333,1e-05,2.5\n-0,inf,1e+15\n");
}

#[test]
fn path_is_written_from_start_to_goal() {
    let folder = Folder::new();
    let path = folder.path("path.csv");
    map_files::write_path(&path, &[(0, 0), (1, 1), (1, 12)]).expect("writable");
    assert_eq!(fs::read_to_string(&path).expect("readable"), "0,0\n1,1\n1,12\n");
}

/// Reckoned by hand: 10 bytes before the dictionary, which spaces and a line feed bring to 128 bytes in all.
#[test]
fn numpy_array_has_the_bytes_of_format_version_1() {
    let folder = Folder::new();
    let path = folder.path("map.npy");
    let file = |dictionary: &str, values: &[u8]| {
        [b"\x93NUMPY\x01\x00\x76\x00", format!("{dictionary:<117}\n").as_bytes(), values].concat()
    };
    map_files::write_npy(&path, &Grid::from_values(2, 1, vec![1u32, 0x0102_0304])).expect("writable");
    let expected = file("{'descr': '<u4', 'fortran_order': False, 'shape': (2, 1), }", &[1, 0, 0, 0, 4, 3, 2, 1]);
    assert_eq!(fs::read(&path).expect("readable"), expected);
    map_files::write_npy(&path, &Grid::from_values(1, 2, vec![true, false])).expect("writable");
    let expected = file("{'descr': '|b1', 'fortran_order': False, 'shape': (1, 2), }", &[1, 0]);
    assert_eq!(fs::read(&path).expect("readable"), expected);
    map_files::write_npy(&path, &Grid::from_values(1, 2, vec![7u16, 0xABCD])).expect("writable");
    let expected = file("{'descr': '<u2', 'fortran_order': False, 'shape': (1, 2), }", &[7, 0, 0xCD, 0xAB]);
    assert_eq!(fs::read(&path).expect("readable"), expected);
    map_files::write_npy(&path, &Grid::from_values(1, 1, vec![-2.0f64])).expect("writable");
    let expected = file("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1), }", &[0, 0, 0, 0, 0, 0, 0, 0xC0]);
    assert_eq!(fs::read(&path).expect("readable"), expected);
}
