//! Landscape files of FARSITE (`.lcp`): a header of fixed length, then the layers of each cell together, from the north-west.
//!
//! Values stay as they are, with the names of their units as GDAL gives them.
//!
//! Source: Finney, "FARSITE: Fire Area Simulator - model development and evaluation", USDA Forest Service RMRS-RP-4, 1998;
//! places of the fields: GDAL, "LCP -- FARSITE v.4 LCP Format".

use super::crs::{Coordinates, FOOT_M};
use super::{Band, Raster, RasterFault, check_bands, check_place, check_size, with_room};

const HEADER_BYTES: usize = 7316;
/// Words that say that layers are absent or present.
const ABSENT: i32 = 20;
const PRESENT: i32 = 21;
/// The value of cells without data.
const NODATA: f32 = -9999.0;

/// Names of the layers in the order of the file, as LANDFIRE has them: elevation, slope, aspect, fuel; cover, height, base and
/// bulk density of the canopy; duff and coarse wood on the ground. The first five are in each file.
const LAYERS: [&str; 10] = ["ELEV", "SLPD", "ASP", "FBFM", "CC", "CH", "CBH", "CBD", "DUFF", "CWD"];
const ALWAYS: usize = 5;
const CROWNS: usize = 8;

/// Units of the layers by their numbers; nothing is said of the unit of fuels, duff and wood.
const HEIGHTS: [&str; 5] = ["", "Meters", "Feet", "Meters x 10", "Feet x 10"];
const UNITS: [&[&str]; 8] = [
    &["Meters", "Feet"],
    &["Degrees", "Percent"],
    &["Grass categories", "Grass degrees", "Azimuth degrees"],
    &[],
    &["Categories", "Percent"],
    &HEIGHTS,
    &HEIGHTS,
    &["", "kg/m^3", "lb/ft^3", "kg/m^3 x 100", "lb/ft^3 x 1000"],
];

/// Returns whether a file begins as landscape files do.
pub(super) fn is_start(bytes: &[u8]) -> bool {
    let is_flag = |at| int(bytes, at).is_some_and(|word| word == ABSENT || word == PRESENT);
    bytes.len() >= HEADER_BYTES && is_flag(0) && is_flag(4)
}

fn int(bytes: &[u8], at: usize) -> Option<i32> {
    Some(i32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn short(bytes: &[u8], at: usize) -> i16 {
    i16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn double(bytes: &[u8], at: usize) -> f64 {
    f64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes"))
}

/// Reads all layers.
pub(super) fn parse(bytes: &[u8], coordinates: Option<Coordinates>) -> Result<Vec<Band>, RasterFault> {
    let word = |at| int(bytes, at).expect("the header is whole");
    // Two flags at the beginning say whether the layers of crowns and those of ground fuels follow the first five.
    let layers: Vec<usize> = (0..LAYERS.len())
        .filter(|layer| match *layer {
            ..ALWAYS => true,
            ALWAYS..CROWNS => word(0) == PRESENT,
            _ => word(4) == PRESENT,
        })
        .collect();
    // A negative size becomes 0, which the check refuses.
    let size = |at| u64::try_from(word(at)).unwrap_or(0);
    let (cols, rows) = (size(4164), size(4168));
    check_size(rows, cols)?;
    check_bands(rows, cols, layers.len() as u64)?;
    let (cols, rows) = (cols as usize, rows as usize);
    let data = &bytes[HEADER_BYTES..];
    if data.len() < 2 * rows * cols * layers.len() {
        return Err(RasterFault::TooShort { bytes: bytes.len(), rows, cols });
    }
    let side_m = match word(4204) {
        0 => 1.0,
        1 => FOOT_M,
        2 => 1000.0,
        unit => {
            let message = format!("the landscape file measures its cells in unit {unit}; expected 0, 1 or 2");
            return Err(RasterFault::Landscape { message });
        }
    };
    let x = double(bytes, 4208) * side_m;
    let y = double(bytes, 4216) * side_m;
    if (x - y).abs() > 1e-6 * x.abs() {
        return Err(RasterFault::NotSquare { x, y });
    }
    let west_m = double(bytes, 4180) * side_m;
    let south_m = double(bytes, 4196) * side_m;
    // Coordinates in feet were converted above.
    let is_converted = matches!(coordinates, Some(Coordinates::Lengths { unit_m }) if (unit_m - side_m).abs() < 1e-6);
    let coordinates = if is_converted { Some(Coordinates::METRES) } else { coordinates };
    check_place([west_m, south_m], [cols, rows], x, coordinates)?;
    let mut bands = Vec::new();
    for (number, &layer) in layers.iter().enumerate() {
        let name = LAYERS[layer];
        let unit = short(bytes, 4224 + 2 * layer);
        let units = UNITS.get(layer).copied().unwrap_or_default();
        let unit_of = usize::try_from(unit).ok().and_then(|unit| units.get(unit)).filter(|unit| !unit.is_empty());
        if unit_of.is_none() && !units.is_empty() {
            let message = format!("the landscape file gives its {name} in an unknown unit, {unit}");
            return Err(RasterFault::Landscape { message });
        }
        let mut values = with_room(rows * cols)?;
        // The file's rows go south, those of a raster north; the layers of a cell lie side by side, two bytes each.
        for row in (0..rows).rev() {
            for col in 0..cols {
                values.push(f32::from(short(data, 2 * ((row * cols + col) * layers.len() + number))));
            }
        }
        let raster = Raster { rows, cols, west_m, south_m, cell_m: x, values, nodata: Some(NODATA), crs: None };
        let unit = unit_of.map(|unit| (*unit).to_owned());
        bands.push(Band { name: Some(name.to_owned()), unit, ..raster.into() });
    }
    Ok(bands)
}
