//! GeoTIFF images.
//!
//! The pixels are read and written by the crate `tiff`; where the cells are is said by tags of their own: the size of a
//! pixel and a tie point, or a matrix, and keys that describe the coordinate system.
//!
//! Source: Open Geospatial Consortium, "OGC GeoTIFF Standard", version 1.1, 2019; tags 42112 and 42113: GDAL, "GTiff
//! driver".

use std::io::Cursor;

use tiff::decoder::ifd::Value;
use tiff::decoder::{ChunkType, DecodingResult};
use tiff::encoder::colortype::Gray32Float;
use tiff::encoder::compression::DeflateLevel;
use tiff::encoder::{Compression, TiffEncoder};
use tiff::tags::{ExtraSamples, Tag};
use tiff::{TiffError, TiffResult};

use super::tiff_chunks::{self, TiffDecoder};
use super::tiff_header::{self, TiffSize};
use super::{Band, GeoKeys, MAX_RASTER_CELLS, Raster, RasterFault, check_place, with_room};

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const PROJECTED_SYSTEM: u16 = 3072;
const LINEAR_UNITS: u16 = 3076;

const GEOGRAPHIC: u16 = 2;
const PIXEL_IS_POINT: u16 = 2;
const PROJECTED: u16 = 1;
const PIXEL_IS_AREA: u16 = 1;
const METRE: u16 = 9001;
/// What stands for a custom value, and for none.
const USER_DEFINED: u16 = 32_767;
const UNDEFINED: u16 = 0;

/// The layout in which each band has its own strips or tiles.
const PLANAR: u16 = 2;
/// The tag in which GDAL keeps what TIFF has no tag for, such as names of bands.
const GDAL_METADATA: Tag = Tag::Unknown(42_112);

/// Most bytes of a strip or a tile, decoded.
const MAX_CHUNK: usize = 8 * MAX_RASTER_CELLS;

/// Cells in a strip that is written.
const STRIP_CELLS: usize = 1 << 16;

/// Reads the only band.
pub(super) fn parse(mut bytes: Vec<u8>) -> Result<Raster, RasterFault> {
    match tiff_header::check(&mut bytes)?.bands {
        1 => Ok(parse_bands(bytes)?.swap_remove(0).raster),
        bands => Err(RasterFault::one_of(bands)),
    }
}

pub(super) fn parse_bands(mut bytes: Vec<u8>) -> Result<Vec<Band>, RasterFault> {
    let TiffSize { rows, cols, bands } = tiff_header::check(&mut bytes)?;
    let damaged_chunk = |message| RasterFault::Damaged { message };
    let mut decoder = tiff_chunks::open(&bytes, MAX_CHUNK).map_err(damaged_chunk)?.map_err(damaged)?;
    if decoder.dimensions().map_err(damaged)? != (cols as u32, rows as u32) {
        return Err(RasterFault::Damaged { message: "its header gives its size twice".into() });
    }
    let crs = geo_keys(&mut decoder)?;
    let place = Place::read(&mut decoder, crs.as_ref())?;
    let cell_m = place.cell_m;
    let south_m = if place.south_first { place.edge_m } else { place.edge_m - rows as f64 * cell_m };
    check_place(place.west_m, south_m, cell_m)?;
    let nodata = nodata(&mut decoder)?;
    let names = band_names(&mut decoder, bands)?;
    let all = Pixels { rows, cols, bands, absent: nodata.unwrap_or(0.0) }.read(&mut decoder)?;
    let band = |(mut values, name): (Vec<f32>, _)| {
        if place.south_first {
            for row in 0..rows / 2 {
                let (south, north) = values.split_at_mut((rows - 1 - row) * cols);
                south[row * cols..][..cols].swap_with_slice(&mut north[..cols]);
            }
        }
        let crs = crs.clone();
        Band { name, raster: Raster { rows, cols, west_m: place.west_m, south_m, cell_m, values, nodata, crs } }
    };
    Ok(all.into_iter().zip(names).map(band).collect())
}

/// Returns the names of bands that GDAL has written into its list of items, in XML.
fn band_names(decoder: &mut TiffDecoder<'_>, bands: usize) -> Result<Vec<Option<String>>, RasterFault> {
    let mut names = vec![None; bands];
    let Some(value) = decoder.find_tag(GDAL_METADATA).map_err(damaged)? else { return Ok(names) };
    let text = value.into_string().map_err(damaged)?;
    for item in text.split("<Item ").skip(1).filter(|item| item.contains("role=\"description\"")) {
        let number = item.split_once("sample=\"").and_then(|(_, rest)| rest.split('"').next()?.parse::<usize>().ok());
        let name = item.split_once('>').and_then(|(_, rest)| rest.split('<').next());
        if let (Some(slot), Some(name)) = (number.and_then(|number| names.get_mut(number)), name) {
            *slot = Some(wildfire_base::untrusted::visible_start(name));
        }
    }
    Ok(names)
}

fn damaged(error: TiffError) -> RasterFault {
    RasterFault::Damaged { message: error.to_string() }
}

fn unfit<T>(message: impl Into<String>) -> Result<T, RasterFault> {
    Err(RasterFault::Unfit { message: message.into() })
}

/// The pixels of an image whose head was checked.
struct Pixels {
    rows: usize,
    cols: usize,
    bands: usize,
    /// What strips and tiles hold that the file leaves out, as GDAL may.
    absent: f32,
}

impl Pixels {
    /// Reads all strips or tiles by band, and turns the rows over.
    fn read(&self, decoder: &mut TiffDecoder<'_>) -> Result<Vec<Vec<f32>>, RasterFault> {
        let (width, height) = decoder.chunk_dimensions();
        let (width, height) = (width as usize, (height as usize).min(self.rows));
        if width == 0 || height == 0 || width * height > MAX_RASTER_CELLS {
            return Err(RasterFault::Damaged { message: "its strips or tiles have an impossible size".into() });
        }
        let across = match decoder.get_chunk_type() {
            ChunkType::Strip => 1,
            ChunkType::Tile => self.cols.div_ceil(width),
        };
        let counts = match decoder.get_chunk_type() {
            ChunkType::Strip => Tag::StripByteCounts,
            ChunkType::Tile => Tag::TileByteCounts,
        };
        let bytes = decoder.find_tag_unsigned_vec::<u64>(counts).map_err(damaged)?.unwrap_or_default();
        let mut bands = Vec::with_capacity(self.bands);
        for _ in 0..self.bands {
            let mut values = with_room(self.rows * self.cols)?;
            values.resize(self.rows * self.cols, self.absent);
            bands.push(values);
        }
        let is_planar = decoder.find_tag_unsigned::<u16>(Tag::PlanarConfiguration).map_err(damaged)? == Some(PLANAR);
        let (planes, together) = if is_planar { (self.bands, 1) } else { (1, self.bands) };
        let in_plane = across * self.rows.div_ceil(height);
        for chunk in (0..planes * in_plane).filter(|&chunk| bytes.get(chunk) != Some(&0)) {
            let (plane, number) = (chunk / in_plane, chunk % in_plane);
            let (north, west) = (number / across * height, number % across * width);
            let cut = |error| RasterFault::Damaged { message: format!("row {north}, column {west}: {error}") };
            let samples = numbers(decoder.read_chunk(chunk as u32).map_err(cut)?)?;
            let cols = width.min(self.cols - west);
            let rows = height.min(self.rows - north);
            if samples.len() < rows * cols * together {
                return Err(RasterFault::Ends { row: north, col: west, rows: self.rows, cols: self.cols });
            }
            for (offset, row) in samples.chunks_exact(cols * together).take(rows).enumerate() {
                let start = (self.rows - 1 - north - offset) * self.cols + west;
                for (band, values) in bands[plane..plane + together].iter_mut().enumerate() {
                    let own = row.iter().skip(band).step_by(together);
                    values[start..start + cols].iter_mut().zip(own).for_each(|(value, &sample)| *value = sample);
                }
            }
        }
        Ok(bands)
    }
}

/// Converts samples to what a raster holds.
fn numbers(samples: DecodingResult) -> Result<Vec<f32>, RasterFault> {
    Ok(match samples {
        DecodingResult::F32(samples) => samples,
        DecodingResult::F64(samples) => samples.into_iter().map(narrowed).collect(),
        DecodingResult::U8(samples) => samples.into_iter().map(f32::from).collect(),
        DecodingResult::I8(samples) => samples.into_iter().map(f32::from).collect(),
        DecodingResult::U16(samples) => samples.into_iter().map(f32::from).collect(),
        DecodingResult::I16(samples) => samples.into_iter().map(f32::from).collect(),
        DecodingResult::U32(samples) => samples.into_iter().map(|sample| sample as f32).collect(),
        DecodingResult::I32(samples) => samples.into_iter().map(|sample| sample as f32).collect(),
        DecodingResult::U64(_) | DecodingResult::I64(_) | DecodingResult::F16(_) => {
            return unfit(
                "its numbers are 64-bit integers or 16-bit floats; gdal_translate -ot Float32 in.tif out.tif converts \
                 them",
            );
        }
    })
}

/// Rounds a number to 32 bits; what is beyond their range, as values for no data often are, becomes its end.
fn narrowed(number: f64) -> f32 {
    number.clamp(f32::MIN.into(), f32::MAX.into()) as f32
}

/// Returns the value of cells without one, which GDAL writes as text.
fn nodata(decoder: &mut TiffDecoder<'_>) -> Result<Option<f32>, RasterFault> {
    let Some(value) = decoder.find_tag(Tag::GdalNodata).map_err(damaged)? else { return Ok(None) };
    let text = value.into_string().map_err(damaged)?;
    let text = text.trim_matches(|letter: char| letter.is_whitespace() || letter == '\0');
    match text.parse::<f64>() {
        Ok(nodata) => Ok(Some(narrowed(nodata))),
        Err(_) => Err(RasterFault::Damaged {
            message: format!(
                "`{}`, its value for no data, is not a number",
                wildfire_base::untrusted::visible_start(text)
            ),
        }),
    }
}

/// Reads the coordinate system, and refuses one that is not measured in metres.
fn geo_keys(decoder: &mut TiffDecoder<'_>) -> Result<Option<GeoKeys>, RasterFault> {
    let Some(directory) = decoder.find_tag(Tag::GeoKeyDirectoryTag).map_err(damaged)? else { return Ok(None) };
    let doubles = decoder.find_tag(Tag::GeoDoubleParamsTag).map_err(damaged)?;
    let ascii = decoder.find_tag(Tag::GeoAsciiParamsTag).map_err(damaged)?;
    let crs = GeoKeys {
        directory: directory.into_u16_vec().map_err(damaged)?,
        doubles: doubles.map(Value::into_f64_vec).transpose().map_err(damaged)?.unwrap_or_default(),
        ascii: ascii.map(Value::into_string).transpose().map_err(damaged)?.unwrap_or_default().replace(is_no_text, "?"),
    };
    if crs.directory.len() < 4 {
        return Err(RasterFault::Damaged { message: "its geo keys have no header".into() });
    }
    if crs.short(MODEL_TYPE) == Some(GEOGRAPHIC) {
        return unfit(
            "its cells are measured in degrees; gdalwarp -t_srs EPSG:NUMBER in.tif out.tif converts it to a grid in \
             metres",
        );
    }
    match crs.short(LINEAR_UNITS) {
        None | Some(METRE | USER_DEFINED | UNDEFINED) => Ok(Some(crs)),
        Some(unit) => unfit(format!(
            "its cells are not measured in metres but in unit {unit} (9002 and 9003 are feet); gdalwarp -t_srs \
             EPSG:NUMBER in.tif out.tif converts it to a grid in metres"
        )),
    }
}

/// Returns whether text of a TIFF image may not have a letter.
fn is_no_text(letter: char) -> bool {
    !letter.is_ascii() || letter == '\0'
}

impl GeoKeys {
    /// Returns the value of a key that is a number in the directory itself.
    fn short(&self, key: u16) -> Option<u16> {
        let keys = self.directory.get(4..)?.chunks_exact(4);
        keys.into_iter().find(|entry| entry[0] == key && entry[1] == 0).map(|entry| entry[3])
    }

    /// Returns the number of the projected coordinate system in the list of EPSG, if the keys name one.
    pub fn epsg(&self) -> Option<u16> {
        self.short(PROJECTED_SYSTEM).filter(|&number| number != USER_DEFINED && number != UNDEFINED)
    }

    /// Returns the directory of a file whose pixels are areas.
    pub(super) fn of_areas(&self) -> Vec<u16> {
        let mut directory = self.directory.clone();
        for entry in directory.get_mut(4..).into_iter().flat_map(|keys| keys.chunks_exact_mut(4)) {
            if entry[0] == RASTER_TYPE && entry[1] == 0 {
                entry[3] = PIXEL_IS_AREA;
            }
        }
        directory
    }
}

/// Where the west end of the first row's outer edge is: the north-west corner, or, if rows go from south to north, the
/// south-west one.
struct Place {
    west_m: f64,
    edge_m: f64,
    cell_m: f64,
    south_first: bool,
}

impl Place {
    fn read(decoder: &mut TiffDecoder<'_>, crs: Option<&GeoKeys>) -> Result<Self, RasterFault> {
        let mut numbers = |tag| {
            let value = decoder.find_tag(tag).map_err(damaged)?;
            value.map(Value::into_f64_vec).transpose().map_err(damaged)
        };
        let (scale, tie) = (numbers(Tag::ModelPixelScaleTag)?, numbers(Tag::ModelTiepointTag)?);
        let matrix = numbers(Tag::ModelTransformationTag)?;
        let ([x, y], west, edge) = match (scale.as_deref(), tie.as_deref(), matrix.as_deref()) {
            (Some(&[x, y, ..]), Some(&[col, row, _, east, north, _, ..]), _) => {
                ([x, y], east - col * x, north + row * y)
            }
            (_, _, Some(&[x, x_by_row, _, east, y_by_col, y, _, north, ..])) => {
                if x_by_row != 0.0 || y_by_col != 0.0 {
                    return unfit("its rows do not run from west to east; gdalwarp in.tif out.tif rotates it");
                }
                ([x, -y], east, north)
            }
            _ => {
                return unfit(
                    "it does not give the position of its cells; gdal_translate -a_ullr WEST NORTH EAST SOUTH in.tif \
                     out.tif adds it",
                );
            }
        };
        // A scale below zero is read in one way by the standard and in another by GDAL; a matrix says what is meant.
        if scale.is_some() && y < 0.0 {
            return unfit(
                "its scale is below 0, which makes the direction of its rows ambiguous; gdal_translate \
                in.tif out.tif fixes it",
            );
        }
        if (x - y.abs()).abs() > 1e-6 * x.abs() {
            return Err(RasterFault::NotSquare { x, y });
        }
        let half = if crs.and_then(|crs| crs.short(RASTER_TYPE)) == Some(PIXEL_IS_POINT) { 0.5 * x } else { 0.0 };
        let south_first = y < 0.0;
        Ok(Self { west_m: west - half, edge_m: edge + half.copysign(y), cell_m: x, south_first })
    }
}

/// Makes the bytes of an image: 32-bit values in strips, packed by deflate. All bands have the place of the first; names
/// have no letters that are special in XML.
pub(super) fn to_bytes(bands: &[(Option<&str>, &Raster)]) -> TiffResult<Vec<u8>> {
    let raster = bands[0].1;
    let mut file = Cursor::new(Vec::new());
    let packed = Compression::Deflate(DeflateLevel::Balanced);
    let mut encoder = TiffEncoder::new(&mut file)?.with_compression(packed);
    let mut image = encoder.new_image::<Gray32Float>(raster.cols as u32, raster.rows as u32)?;
    image.rows_per_strip(STRIP_CELLS.div_ceil(raster.cols).min(raster.rows) as u32)?;
    if bands.len() > 1 {
        image.extra_samples(&vec![ExtraSamples::Unspecified; bands.len() - 1])?;
    }
    let tags = image.encoder();
    let cell_m = raster.cell_m;
    tags.write_tag(Tag::ModelPixelScaleTag, &[cell_m, cell_m, 0.0][..])?;
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, raster.west_m, raster.north_m(), 0.0][..])?;
    match &raster.crs {
        None => {
            let keys = [1, 1, 0, 2, MODEL_TYPE, 0, 1, PROJECTED, RASTER_TYPE, 0, 1, PIXEL_IS_AREA];
            tags.write_tag(Tag::GeoKeyDirectoryTag, &keys[..])?;
        }
        Some(crs) => {
            tags.write_tag(Tag::GeoKeyDirectoryTag, &crs.of_areas()[..])?;
            if !crs.doubles.is_empty() {
                tags.write_tag(Tag::GeoDoubleParamsTag, &crs.doubles[..])?;
            }
            if !crs.ascii.is_empty() {
                tags.write_tag(Tag::GeoAsciiParamsTag, crs.ascii.as_str())?;
            }
        }
    }
    if let Some(nodata) = raster.nodata {
        tags.write_tag(Tag::GdalNodata, nodata.to_string().as_str())?;
    }
    let names = bands.iter().enumerate().filter_map(|(band, (name, _))| Some((band, (*name)?)));
    let items = names.map(|(band, name)| {
        format!("<Item name=\"DESCRIPTION\" sample=\"{band}\" role=\"description\">{name}</Item>\n")
    });
    let items = items.collect::<String>();
    if !items.is_empty() {
        tags.write_tag(GDAL_METADATA, format!("<GDALMetadata>\n{items}</GDALMetadata>\n").as_str())?;
    }
    let rows = (0..raster.rows).rev().flat_map(|row| row * raster.cols..(row + 1) * raster.cols);
    let values: Vec<f32> = rows.flat_map(|cell| bands.iter().map(move |(_, band)| band.values[cell])).collect();
    image.write_data(&values)?;
    Ok(file.into_inner())
}
