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
use tiff::{ColorType, TiffError, TiffResult};

use super::crs::unit_name;
use super::tiff_chunks::{self, TiffDecoder};
use super::tiff_header::{self, TiffSize};
use super::{Band, GeoKeys, MAX_RASTER_CELLS, Raster, RasterFault, check_place, with_room};

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;

const PIXEL_IS_POINT: u16 = 2;
const PROJECTED: u16 = 1;
const PIXEL_IS_AREA: u16 = 1;

/// The layout in which each band has its own strips or tiles.
const PLANAR: u16 = 2;
/// The tag in which GDAL keeps what TIFF has no tag for, such as names of bands.
const GDAL_METADATA: Tag = Tag::Unknown(42_112);

/// Most bytes of a strip or a tile, decoded.
const MAX_CHUNK: usize = 8 * MAX_RASTER_CELLS;

/// Cells in a strip that is written.
const STRIP_CELLS: usize = 1 << 16;

/// Reads the bands, without one that is a mask of the others.
pub(super) fn parse_bands(mut bytes: Vec<u8>) -> Result<Vec<Band>, RasterFault> {
    let TiffSize { rows, cols, bands, bits, mask } = tiff_header::check(&mut bytes)?;
    let mut decoder =
        tiff_chunks::open(&bytes, MAX_CHUNK).map_err(|message| RasterFault::Damaged { message })?.map_err(damaged)?;
    // The header was read twice, by the check and by the decoder; a file may fool one of them.
    if decoder.dimensions().map_err(damaged)? != (cols as u32, rows as u32) {
        return Err(RasterFault::Damaged { message: "its header gives its size twice".into() });
    }
    let crs = geo_keys(&mut decoder)?;
    let place = RasterCorner::read(&mut decoder, crs.as_ref())?;
    let cell_m = place.cell_m;
    // Files may count rows from the south.
    let south_m = if place.south_first { place.edge_m } else { place.edge_m - rows as f64 * cell_m };
    let coordinates = crs.as_ref().and_then(GeoKeys::coordinates);
    check_place([place.west_m, south_m], [cols, rows], cell_m, coordinates)?;
    let nodata = nodata(&mut decoder)?;
    let mut items = BandItems::read(&mut decoder, bands)?;
    // Chunks without data may be missing from a file; their cells have the value for no data.
    let mut pixels = TiffPixels { rows, cols, bands, bits, absent: nodata.unwrap_or(0.0) };
    let mut all = pixels.read(&mut decoder)?;
    // As GDAL has it: a mask comes before a value for no data, and that before a band of opacity.
    let has_opacity = [2, 4].contains(&bands) && bits <= 16 && items.last().is_some_and(|last| last.is_opacity);
    let mut valid = None;
    if let Some(image) = mask {
        decoder.seek_to_image(image).map_err(damaged)?;
        pixels = TiffPixels { bands: 1, bits: 1, absent: 0.0, ..pixels };
        if decoder.colortype().map_err(damaged)? != ColorType::Gray(1) {
            pixels.bits = 8;
        }
        valid = pixels.read(&mut decoder)?.pop();
    }
    if has_opacity {
        // Taken off in any case: opacity is no band of data, even where something else says which cells are valid.
        let opacity = all.pop().filter(|_| valid.is_none() && nodata.is_none());
        valid = valid.or(opacity);
        items.pop();
    }
    let band = |(mut values, items): (Vec<f32>, BandItems)| {
        let mut nodata = nodata;
        if valid.is_some() || items.scale != 1.0 || items.offset != 0.0 {
            // Scaled values are no longer equal to the file's value for no data, so NaN takes its place.
            for (index, value) in values.iter_mut().enumerate() {
                let is_valid = valid.as_ref().map_or(nodata != Some(*value), |valid| valid[index] > 0.0);
                *value = if is_valid { narrowed(f64::from(*value) * items.scale + items.offset) } else { f32::NAN };
            }
            nodata = Some(f32::NAN);
        }
        // Rows were turned over on the assumption that the file begins in the north.
        if place.south_first {
            for row in 0..rows / 2 {
                let (south, north) = values.split_at_mut((rows - 1 - row) * cols);
                south[row * cols..][..cols].swap_with_slice(&mut north[..cols]);
            }
        }
        let crs = crs.clone();
        let height_unit = crs.as_ref().and_then(GeoKeys::height_unit_m).map(unit_name);
        let raster = Raster { rows, cols, west_m: place.west_m, south_m, cell_m, values, nodata, crs };
        Band { name: items.name, unit: items.unit, height_unit, raster }
    };
    Ok(all.into_iter().zip(items).map(band).collect())
}

/// What GDAL's list of items, in XML, says of a band.
#[derive(Clone)]
struct BandItems {
    name: Option<String>,
    unit: Option<String>,
    /// What makes numbers of the file's.
    scale: f64,
    offset: f64,
    /// The band says how opaque cells are, not what they hold.
    is_opacity: bool,
}

impl BandItems {
    fn read(decoder: &mut TiffDecoder<'_>, bands: usize) -> Result<Vec<Self>, RasterFault> {
        let plain = Self { name: None, unit: None, scale: 1.0, offset: 0.0, is_opacity: false };
        let mut all = vec![plain; bands];
        let extra = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).map_err(damaged)?.unwrap_or_default();
        // Extra samples are the last bands of an image.
        for (band, kind) in all.iter_mut().rev().zip(extra.iter().rev()) {
            band.is_opacity = [ExtraSamples::AssociatedAlpha, ExtraSamples::UnassociatedAlpha]
                .iter()
                .any(|alpha| alpha.to_u16() == *kind);
        }
        let Some(value) = decoder.find_tag(GDAL_METADATA).map_err(damaged)? else { return Ok(all) };
        let text = value.into_string().map_err(damaged)?;
        for item in text.split("<Item ").skip(1) {
            let Some((attributes, value)) = item.split_once('>') else { continue };
            let attribute = |key: &str| attributes.split_once(key)?.1.split('"').next();
            let number = attribute("sample=\"").and_then(|number| number.parse::<usize>().ok());
            // An item without a band's number is about the whole file.
            let Some(band) = number.and_then(|number| all.get_mut(number)) else { continue };
            let value = value.split('<').next().unwrap_or_default();
            // The ampersand comes last: `&amp;lt;` stands for `&lt;` and not for a bracket.
            let value = value.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
            let factor = || {
                let found = || wildfire_base::untrusted::visible_start(&value);
                let message = || format!("`{}`, the scale or offset of a band, is not a number", found());
                let number = value.trim().parse::<f64>().ok().filter(|number| number.is_finite());
                number.ok_or_else(|| RasterFault::Damaged { message: message() })
            };
            match attribute("role=\"") {
                Some("description") => band.name = Some(wildfire_base::untrusted::visible_start(&value)),
                Some("unittype") => band.unit = Some(value),
                Some("scale") => band.scale = factor()?,
                Some("offset") => band.offset = factor()?,
                Some("colorinterp") if value.eq_ignore_ascii_case("alpha") => band.is_opacity = true,
                // The unit that a landscape file gave, as GDAL copies it.
                None if attribute("name=\"").is_some_and(|name| name.ends_with("_UNIT_NAME")) => {
                    band.unit.get_or_insert(value);
                }
                _ => {}
            }
        }
        Ok(all)
    }
}

fn damaged(error: TiffError) -> RasterFault {
    RasterFault::Damaged { message: error.to_string() }
}

fn unfit<T>(message: impl Into<String>) -> Result<T, RasterFault> {
    Err(RasterFault::Unfit { message: message.into() })
}

/// The pixels of an image whose head was checked.
struct TiffPixels {
    rows: usize,
    cols: usize,
    bands: usize,
    bits: usize,
    /// What strips and tiles hold that the file leaves out, as GDAL may.
    absent: f32,
}

impl TiffPixels {
    /// Reads all strips or tiles by band, and turns the rows over.
    fn read(&self, decoder: &mut TiffDecoder<'_>) -> Result<Vec<Vec<f32>>, RasterFault> {
        let (width, height) = decoder.chunk_dimensions();
        let width = width as usize;
        // A file may give 2^32 - 1 rows per strip, which stands for a single strip (TIFF 6.0, section 8).
        let height = (height as usize).min(self.rows);
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
        // Either every band has its chunks after those of the band before, or the samples of a cell lie side by side.
        let (planes, together) = if is_planar { (self.bands, 1) } else { (1, self.bands) };
        let in_plane = across * self.rows.div_ceil(height);
        // A chunk of no bytes was left out by the writer, and its cells keep the absent value.
        for chunk in (0..planes * in_plane).filter(|&chunk| bytes.get(chunk) != Some(&0)) {
            let plane = chunk / in_plane;
            let number = chunk % in_plane;
            let north = number / across * height;
            let west = number % across * width;
            let cols = width.min(self.cols - west);
            let rows = height.min(self.rows - north);
            let mut samples =
                numbers(decoder.read_chunk(chunk as u32).map_err(|error| RasterFault::Damaged {
                    message: format!("row {north}, column {west}: {error}"),
                })?)?;
            if self.bits < 8 {
                samples = spread_out(&samples, cols * together, self.bits);
            }
            if samples.len() < rows * cols * together {
                return Err(RasterFault::Ends { row: north, col: west, rows: self.rows, cols: self.cols });
            }
            for (offset, row) in samples.chunks_exact(cols * together).take(rows).enumerate() {
                // The file's rows go south, those of a raster north.
                let start = (self.rows - 1 - north - offset) * self.cols + west;
                for (band, values) in bands[plane..plane + together].iter_mut().enumerate() {
                    let band_samples = row.iter().skip(band).step_by(together);
                    values[start..start + cols]
                        .iter_mut()
                        .zip(band_samples)
                        .for_each(|(value, &sample)| *value = sample);
                }
            }
        }
        Ok(bands)
    }
}

/// Takes apart bytes that hold several numbers, the first in the high bits; each row begins with a byte.
fn spread_out(bytes: &[f32], in_row: usize, bits: usize) -> Vec<f32> {
    let number = |row: &[f32], at: usize| {
        let byte = row[at * bits / 8] as u8;
        f32::from(byte >> (8 - bits - at * bits % 8) & ((1 << bits) - 1) as u8)
    };
    let rows = bytes.chunks_exact((in_row * bits).div_ceil(8));
    rows.flat_map(|row| (0..in_row).map(move |at| number(row, at))).collect()
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
    // Infinity is a value of its own, and not one beyond the range.
    if number.is_infinite() { number as f32 } else { number.clamp(f32::MIN.into(), f32::MAX.into()) as f32 }
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

/// Reads the coordinate system.
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
    Ok(Some(crs))
}

/// Returns whether text of a TIFF image may not have a letter.
fn is_no_text(letter: char) -> bool {
    !letter.is_ascii() || letter == '\0'
}

impl GeoKeys {
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
struct RasterCorner {
    west_m: f64,
    edge_m: f64,
    cell_m: f64,
    south_first: bool,
}

impl RasterCorner {
    fn read(decoder: &mut TiffDecoder<'_>, crs: Option<&GeoKeys>) -> Result<Self, RasterFault> {
        let mut numbers = |tag| {
            let value = decoder.find_tag(tag).map_err(damaged)?;
            value.map(Value::into_f64_vec).transpose().map_err(damaged)
        };
        let scale = numbers(Tag::ModelPixelScaleTag)?;
        let tie = numbers(Tag::ModelTiepointTag)?;
        let matrix = numbers(Tag::ModelTransformationTag)?;
        let ([x, y], west, edge) = match (scale.as_deref(), tie.as_deref(), matrix.as_deref()) {
            // The tie point may be at any cell, so the corner is computed back from it.
            (Some(&[x, y, ..]), Some(&[col, row, _, east, north, _, ..]), _) => {
                ([x, y], east - col * x, north + row * y)
            }
            // Terms off the diagonal turn or shear the raster, and cells could no longer be squares along the axes.
            (_, _, Some(&[x, x_by_row, _, east, y_by_col, y, _, north, ..])) => {
                if x_by_row != 0.0 || y_by_col != 0.0 {
                    return unfit("its rows do not run from west to east; gdalwarp in.tif out.tif rotates it");
                }
                ([x, -y], east, north)
            }
            // Several tie points without a scale are ground control points, which only a warp can resolve.
            (None, Some(points), _) if points.len() > 6 => {
                return unfit(
                    "it gives only single points of its position; gdalwarp -t_srs EPSG:NUMBER in.tif out.tif places its cells",
                );
            }
            _ => {
                return unfit(
                    "it does not give the position of its cells; gdal_translate -a_ullr WEST NORTH EAST SOUTH in.tif \
                     out.tif adds it",
                );
            }
        };
        if let Some(message) = crs.and_then(GeoKeys::coordinates).and_then(|it| it.refusal([west, edge])) {
            return unfit(message);
        }
        // A scale below zero is read in one way by the standard and in another by GDAL; a matrix says what is meant.
        if scale.is_some() && y < 0.0 {
            return unfit(
                "its scale is below 0, which makes the direction of its rows ambiguous; gdal_translate \
                in.tif out.tif fixes it",
            );
        }
        // Scales are often quotients that were rounded, so that a square cell may differ in the last digits.
        if (x - y.abs()).abs() > 1e-6 * x.abs() {
            return Err(RasterFault::NotSquare { x, y });
        }
        // Where pixels are points, the tie point is the middle of the first.
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
    // TIFF wants every sample beyond the one of a grey image declared.
    if bands.len() > 1 {
        image.extra_samples(&vec![ExtraSamples::Unspecified; bands.len() - 1])?;
    }
    let tags = image.encoder();
    let cell_m = raster.cell_m;
    tags.write_tag(Tag::ModelPixelScaleTag, &[cell_m, cell_m, 0.0][..])?;
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, raster.west_m, raster.north_m(), 0.0][..])?;
    match &raster.crs {
        None => {
            // The head of the directory: version 1, revision 1.0, and two keys of four numbers each.
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
    // TIFF begins in the north, a raster in the south.
    let rows = (0..raster.rows).rev().flat_map(|row| row * raster.cols..(row + 1) * raster.cols);
    // Samples of a cell lie side by side, the layout that TIFF assumes where a file does not say.
    let values: Vec<f32> = rows.flat_map(|cell| bands.iter().map(move |(_, band)| band.values[cell])).collect();
    image.write_data(&values)?;
    Ok(file.into_inner())
}
