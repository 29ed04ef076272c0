//! Layers of a landscape that files give: fuel, elevation or slope, each a raster, all of one shape at one place.
//!
//! A resolved scenario holds them packed, so that it is complete without its files and yet short enough for the plan of a
//! batch: bytes packed by deflate (Deutsch, "DEFLATE Compressed Data Format Specification", RFC 1951, 1996) and written in
//! base 64 (Josefsson, RFC 4648, 2006, section 4). 32-bit values come as differences of neighbours, the first byte of all
//! of them before the second: heights that change little pack well so. Row 0 is the south edge.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use data_encoding::BASE64;
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use serde::{Deserialize, Serialize};

use wildfire_base::geometry::{FieldFrame, compass, ops};
use wildfire_fire::fuel::{CustomFuels, FuelModel, custom_number};
use wildfire_fire::{CanopyLayers, Relief};
use wildfire_grid::map_files::raster::crs::{FOOT_M, US_SURVEY_FOOT_M};
use wildfire_grid::map_files::raster::{self, Band, GeoKeys, MAX_RASTER_CELLS, MAX_RASTER_SIDE, Raster};

/// The effort of packing, as zlib counts it.
const PACKING: u8 = 6;

/// The share of a cell by which origins may differ, and the relative difference of sides: text is rounded.
const SAME_PLACE: f64 = 0.01;
const SAME_SIDE: f64 = 1e-6;

/// Heights in metres between which all land lies, with room for the sea floor near it.
const LOWEST_M: f32 = -500.0;
const HIGHEST_M: f32 = 9000.0;

/// The azimuth by which files say that a cell is flat.
const FLAT: f32 = -1.0;

/// What files say of a landscape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportedLayers {
    pub frame: FieldFrame,
    /// Where the south-west corner of the field is in the coordinate system of the files, metres.
    pub west_m: f64,
    pub south_m: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crs: Option<GeoKeys>,
    /// Numbers of fuel models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fuel: Option<PackedLayer>,
    /// Metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    elevation: Option<PackedLayer>,
    /// Rise over run to the east and to the north.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gradient: Option<[PackedLayer; 2]>,
    /// 1 for the cells of the rim, of which files without fuel say nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    outside: Option<PackedLayer>,
    /// The bands that were taken from files with several, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<String>,
    /// What of the files may have been misread or was left out, in sentences.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<String>,
    /// Those of [`CanopyLayers`].
    #[serde(default, skip_serializing_if = "is_without_trees")]
    canopy: [Option<PackedLayer>; 4],
}

fn is_without_trees(canopy: &[Option<PackedLayer>; 4]) -> bool {
    canopy.iter().all(Option::is_none)
}

/// How likely each cell is to catch fire by itself, beside the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Weights(PackedLayer);

impl Weights {
    /// Reads weights from a raster that lies on the field; a cell without a value has the weight 0.
    ///
    /// # Errors
    /// Returns a sentence that begins with the path, and names row and column where a value is wrong.
    pub(crate) fn read(path: &Path, frame: &FieldFrame, layers: Option<&ImportedLayers>) -> Result<Self, String> {
        let mut raster = raster::read(path).map_err(|error| error.to_string())?;
        let name = path.display().to_string();
        // Without a landscape there is no place to compare with, so only size and shape must fit.
        let [west_m, south_m] = layers.map_or([raster.west_m, raster.south_m], |it| [it.west_m, it.south_m]);
        let rows = frame.rows.into();
        let cols = frame.cols.into();
        let cell_m = frame.cell_m;
        let crs = layers.and_then(|it| it.crs.clone());
        // The field as a raster without values, so that one comparison serves layers and weights.
        let field = Raster { rows, cols, west_m, south_m, cell_m, values: Vec::new(), nodata: None, crs };
        check_same_place(&raster, &field, &name, "the field")?;
        for index in 0..raster.values.len() {
            let value = raster.values[index];
            // Without data nothing is ignited there.
            if raster.is_nodata(value) {
                raster.values[index] = 0.0;
            } else if !(0.0..=f32::MAX).contains(&value) {
                let row = raster.file_row(index / raster.cols);
                let col = index % raster.cols;
                return Err(format!("{name}: row {row}, column {col}: found {value}, expected a weight of 0 or more"));
            }
        }
        // Weights that are all 0 would leave no cell to choose.
        let is_any = raster.values.iter().any(|&weight| weight > 0.0);
        if is_any {
            Ok(Self(PackedLayer::from_numbers(&raster.values)))
        } else {
            Err(format!("{name}: all weights are 0"))
        }
    }

    /// Returns the weights by cell index; `None` if they were made for a field of another size.
    pub fn by_cell(&self, frame: &FieldFrame) -> Option<Vec<f32>> {
        self.0.numbers(frame.cell_count()).filter(|weights| weights.iter().all(|weight| *weight >= 0.0))
    }
}

/// A value for each cell, packed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PackedLayer(String);

/// What a layer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerKind {
    Fuel,
    Elevation,
    Slope,
    Aspect,
    /// A layer of [`CanopyLayers`], by its place there.
    Canopy(usize),
}

/// The greatest number of each layer of trees, and what it holds.
const CANOPY: [(f32, &str); 4] = [
    (1500.0, "the height of trees in tenths of metres, whole, from 0 to 1500"),
    (1500.0, "the height of the base of crowns in tenths of metres, whole, from 0 to 1500"),
    (1000.0, "the density of crowns in hundredths of kg/m3, whole, from 0 to 1000"),
    (100.0, "the cover of crowns in percent, whole, from 0 to 100"),
];

/// Between which numbers the greatest of each layer of trees lies in a forest, the name and size of its unit, and the scale
/// that makes it of the likely other one.
const USUAL_CANOPY: [([f32; 2], &str, f64, &str); 4] = [
    ([60.0, 800.0], "m", 0.1, "10"),
    ([10.0, 400.0], "m", 0.1, "10"),
    ([3.0, 100.0], "kg/m3", 0.01, "100"),
    ([10.0, 100.0], "%", 1.0, "100"),
];

/// Kilogrammes per cubic metre in a pound per cubic foot.
const KG_M3_PER_LB_FT3: f64 = 16.018_463_373_960_14;

/// Layers while their files are being read.
#[derive(Default)]
pub struct LayerReader {
    /// The first layer, whose shape and place the others must have, and its file.
    first: Option<(Raster, String)>,
    /// The last file that was read: others of its bands may be asked for next.
    bands: Option<(PathBuf, Vec<Band>)>,
    /// Which bands of files with several were taken for what.
    taken: Vec<String>,
    doubts: Vec<String>,
    /// Fuel models beside the built-in ones.
    custom_fuels: CustomFuels,
    /// Cells of the rim without data, as projected downloads have it: nothing grows there.
    outside: Vec<bool>,
    fuel: Option<Vec<u8>>,
    elevation: Option<Vec<f32>>,
    slope: Option<Vec<f32>>,
    aspect: Option<Vec<f32>>,
    canopy: [Option<Vec<f32>>; 4],
}

impl LayerReader {
    /// Creates a reader of layers whose fuel may be of these models, too.
    pub fn new(custom_fuels: CustomFuels) -> Self {
        Self { custom_fuels, ..Self::default() }
    }

    /// Reads a layer from a file and checks it, value by value and against those that were read before. Of a file with several
    /// bands the one is taken that holds this layer by its name, or by the order of LANDFIRE's products.
    ///
    /// # Errors
    /// Returns a sentence that begins with the path and names row and column, counted from 0 at the north-west corner.
    pub fn read(&mut self, kind: LayerKind, path: &Path) -> Result<(), String> {
        let mut name = path.display().to_string();
        // Several layers are often bands of one file, which is read once.
        let bands = match self.bands.take() {
            Some((before, bands)) if before == path => bands,
            _ => raster::read_bands(path).map_err(|error| error.to_string())?,
        };
        let number = match &bands[..] {
            [_] => 0,
            several => {
                let TakenBand { number, reason } =
                    kind.band(several).ok_or_else(|| format!("{name}: {}", kind.absent(several)))?;
                let band_name =
                    several[number].name.as_ref().map(|band_name| format!(" ({band_name})")).unwrap_or_default();
                self.taken.push(format!("{} from band {} of {name}{band_name}{reason}", kind.names().1, number + 1));
                name += &format!(", band {}", number + 1);
                if let Some(message) = kind.contradiction(several) {
                    return Err(format!("{name}: {message}"));
                }
                number
            }
        };
        let band = &bands[number];
        let mut raster = kind.converted(band).map_err(|message| format!("{name}: {message}"))?;
        let is_without_unit = band.unit.is_none();
        // Put back only now: `band` borrows from them.
        self.bands = Some((path.to_owned(), bands));
        if let Some((first, other)) = &self.first {
            check_same_place(&raster, first, &name, other)?;
        } else {
            // The first layer decides which cells lie outside the data; later ones may add border cells.
            self.outside = rim(&raster);
        }
        // In the order of the file, so that what is named is its first fault.
        for (row, col) in (0..raster.rows).flat_map(|row| (0..raster.cols).map(move |col| (row, col))) {
            let index = raster.file_row(row) * raster.cols + col;
            let value = raster.values[index];
            let is_absent = raster.is_nodata(value);
            // Programs that compute slopes leave out the outermost cells, and the direction of level ground.
            let is_border = [0, raster.rows - 1].contains(&row) || [0, raster.cols - 1].contains(&col);
            let is_level = kind == LayerKind::Aspect && self.slope.as_ref().is_some_and(|slope| slope[index] == 0.0);
            let expected = match is_absent {
                true if self.outside[index] || is_level => {
                    raster.values[index] = kind.without_data();
                    None
                }
                true if is_border && self.first.is_some() => {
                    self.outside[index] = true;
                    raster.values[index] = kind.without_data();
                    None
                }
                true if kind == LayerKind::Elevation => {
                    Some("a value in every cell within its rim; gdal_fillnodata.py in.tif out.tif fills gaps")
                }
                true => Some("a value in every cell within its rim"),
                false => kind.expects(value, &self.custom_fuels),
            };
            if let Some(expected) = expected {
                // The number itself is arbitrary and differs from file to file.
                let found = if is_absent { "NODATA".to_owned() } else { value.to_string() };
                return Err(format!("{name}: row {row}, column {col}: found {found}, expected {expected}"));
            }
        }
        let values = std::mem::take(&mut raster.values);
        if let LayerKind::Canopy(place) = kind
            // A stated unit was converted; only without one may numbers be in another.
            && is_without_unit
        {
            self.doubts.extend(doubt_of_trees(place, &values, &name));
        }
        match kind {
            LayerKind::Fuel => {
                let stored = values.iter().map(|&value| custom_number(value as u32).unwrap_or(value as u8));
                self.fuel = Some(stored.collect());
            }
            LayerKind::Elevation => self.elevation = Some(values),
            LayerKind::Slope => self.slope = Some(values),
            LayerKind::Aspect => self.aspect = Some(values),
            LayerKind::Canopy(place) => self.canopy[place] = Some(values),
        }
        // Kept without its values, as the place that others are compared with.
        if self.first.is_none() {
            self.first = Some((raster, name));
        }
        Ok(())
    }

    /// Packs what was read; `None` if nothing was.
    pub fn finish(mut self) -> Option<ImportedLayers> {
        let (first, name) = self.first?;
        let gradient = self.slope.zip(self.aspect).map(|(slope, aspect)| {
            let gradients: Vec<_> =
                slope.iter().zip(&aspect).map(|(&slope, &aspect)| gradient(slope, aspect)).collect();
            [0, 1].map(|axis| PackedLayer::from_numbers(&gradients.iter().map(|pair| pair[axis]).collect::<Vec<_>>()))
        });
        let outside = self.outside.iter().filter(|&&is_outside| is_outside).count();
        if outside > 0 {
            let share = (1000.0 * outside as f64 / self.outside.len() as f64).round() / 10.0;
            let cells = if outside == 1 { "1 cell".to_owned() } else { format!("{outside} cells") };
            self.doubts.insert(0, format!("Nothing burns in {cells} at the rim of {name} without data, {share} %."));
        }
        // Slopes at the rim need heights beyond it.
        if let Some(elevation) = &mut self.elevation {
            continue_into_rim(elevation, first.cols);
        }
        if let [Some(tops), Some(bases), ..] = &self.canopy {
            let upside_down = tops.iter().zip(bases).filter(|(top, base)| **top > 0.0 && base >= top).count();
            // A few such cells are errors of the data; many point to a unit.
            if 10 * upside_down > tops.iter().filter(|&&top| top > 0.0).count() {
                self.doubts.push(format!(
                    "In {upside_down} cells crowns begin at or above the tops of the trees: one of both rasters may be in \
                     another unit."
                ));
            }
        }
        // Outside the data nothing is known, so nothing burns.
        for (fuel, _) in self.fuel.iter_mut().flatten().zip(&self.outside).filter(|&(_, &is_outside)| is_outside) {
            *fuel = 0;
        }
        // With a layer of fuel the rim is known by its 0.
        let rim: Option<Vec<u8>> =
            (outside > 0 && self.fuel.is_none()).then(|| self.outside.iter().map(|&it| it.into()).collect());
        Some(ImportedLayers {
            frame: FieldFrame { cols: first.cols as u16, rows: first.rows as u16, cell_m: first.cell_m },
            west_m: first.west_m,
            south_m: first.south_m,
            crs: first.crs,
            fuel: self.fuel.as_deref().map(PackedLayer::from_bytes),
            elevation: self.elevation.as_deref().map(PackedLayer::from_numbers),
            gradient,
            canopy: self.canopy.map(|layer| layer.as_deref().map(PackedLayer::from_numbers)),
            outside: rim.as_deref().map(PackedLayer::from_bytes),
            bands: self.taken,
            doubts: self.doubts,
        })
    }
}

/// Marks the cells without data that are connected to the border of a raster, by corners too.
fn rim(raster: &Raster) -> Vec<bool> {
    let (rows, cols) = (raster.rows, raster.cols);
    let mut outside = vec![false; rows * cols];
    let sides = (0..rows).flat_map(|row| [row * cols, row * cols + cols - 1]);
    let mut open: Vec<usize> = sides.chain((0..cols).flat_map(|col| [col, (rows - 1) * cols + col])).collect();
    while let Some(index) = open.pop() {
        if !outside[index] && raster.is_nodata(raster.values[index]) {
            outside[index] = true;
            open.extend(around(index, cols, rows));
        }
    }
    outside
}

/// Lists the up to eight cells around one.
fn around(index: usize, cols: usize, rows: usize) -> impl Iterator<Item = usize> {
    let (row, col) = (index / cols, index % cols);
    let near = (row.saturating_sub(1)..=(row + 1).min(rows - 1))
        .flat_map(move |row| (col.saturating_sub(1)..=(col + 1).min(cols - 1)).map(move |col| row * cols + col));
    near.filter(move |&cell| cell != index)
}

/// Gives elevations to cells that have none, from the rim inwards to outwards, so that the cells beside them have the slope
/// that they would have at the border of a field.
fn continue_into_rim(elevation: &mut [f32], cols: usize) {
    let rows = elevation.len() / cols;
    let has_value: Vec<bool> = elevation.iter().map(|height| !height.is_nan()).collect();
    if has_value.iter().all(|&is_valid| is_valid) {
        return;
    }
    // Breadth first, so that every cell continues from the nearest ones with data.
    let mut open: VecDeque<usize> = (0..elevation.len()).filter(|&index| has_value[index]).collect();
    while let Some(index) = open.pop_front() {
        for cell in around(index, cols, rows) {
            if !elevation[cell].is_nan() {
                continue;
            }
            // The plane through the known cells beside it; farther out, the height of the cell that it was reached from.
            let beyond = |near: usize| {
                let place = |cell: usize| ((cell % cols) as isize, (cell / cols) as isize);
                let (col, row) = place(cell);
                let (near_col, near_row) = place(near);
                let col = 2 * near_col - col;
                let row = 2 * near_row - row;
                let is_there = (0..cols as isize).contains(&col) && (0..rows as isize).contains(&row);
                let far = is_there.then(|| row as usize * cols + col as usize).filter(|&far| has_value[far])?;
                Some(2.0 * elevation[near] - elevation[far])
            };
            let heights: Vec<f32> =
                around(cell, cols, rows).filter(|&near| has_value[near]).filter_map(beyond).collect();
            let mean = heights.iter().sum::<f32>() / heights.len() as f32;
            elevation[cell] = if heights.is_empty() { elevation[index] } else { mean };
            open.push_back(cell);
        }
    }
}

/// Says that the trees of a raster without a unit are of another size than those of a forest.
fn doubt_of_trees(place: usize, values: &[f32], name: &str) -> Option<String> {
    let (usual, unit, size, scale) = USUAL_CANOPY[place];
    let greatest = values.iter().copied().fold(0.0, f32::max);
    if greatest == 0.0 || (usual[0]..=usual[1]).contains(&greatest) {
        return None;
    }
    let found = (f64::from(greatest) * size * 100.0).round() / 100.0;
    let text = LayerKind::Canopy(place).names().1;
    let advice = if greatest < usual[0] {
        format!(
            "; if it is not in that unit, gdal_translate -a_scale {scale} in.tif out.tif converts {}",
            ["metres", "metres", "kg/m3", "shares"][place]
        )
    } else {
        String::new()
    };
    let of = CANOPY[place].1.split_once(" in ").and_then(|(_, unit)| unit.split(',').next()).unwrap_or_default();
    Some(format!("{name}: the greatest {text} is {found} {unit}, as the raster was read in {of}{advice}."))
}

/// Refuses a layer that does not lie on the first one.
fn check_same_place(raster: &Raster, first: &Raster, name: &str, other: &str) -> Result<(), String> {
    if (raster.rows, raster.cols) != (first.rows, first.cols) {
        return Err(format!(
            "{name}: it has {} rows and {} columns, expected {} and {} as in {other}",
            raster.rows, raster.cols, first.rows, first.cols
        ));
    }
    let epsg = |raster: &Raster| raster.crs.as_ref().and_then(GeoKeys::epsg);
    if let (Some(found), Some(expected)) = (epsg(raster), epsg(first))
        && found != expected
    {
        return Err(format!(
            "{name}: it is in the coordinate system EPSG:{found}, expected EPSG:{expected} as in {other}"
        ));
    }
    // Programs round cell sizes and corners differently.
    if (raster.cell_m - first.cell_m).abs() > SAME_SIDE * first.cell_m {
        return Err(format!("{name}: its cells are of {} m, expected {} m as in {other}", raster.cell_m, first.cell_m));
    }
    let tolerance = SAME_PLACE * first.cell_m;
    if (raster.west_m - first.west_m).abs() > tolerance || (raster.south_m - first.south_m).abs() > tolerance {
        return Err(format!(
            "{name}: its south-west corner is at ({}, {}), expected ({}, {}) as in {other}",
            raster.west_m, raster.south_m, first.west_m, first.south_m
        ));
    }
    Ok(())
}

impl LayerKind {
    const ALL: [Self; 8] = [
        Self::Elevation,
        Self::Slope,
        Self::Aspect,
        Self::Fuel,
        Self::Canopy(3),
        Self::Canopy(0),
        Self::Canopy(1),
        Self::Canopy(2),
    ];

    /// Returns the name that LANDFIRE's products have for the layer, and words for it.
    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Elevation => ("ELEV", "elevation"),
            Self::Slope => ("SLPD", "slope"),
            Self::Aspect => ("ASP", "aspect"),
            Self::Fuel => ("FBFM", "fuel models"),
            Self::Canopy(3) => ("CC", "cover of crowns"),
            Self::Canopy(0) => ("CH", "height of trees"),
            Self::Canopy(1) => ("CBH", "base height of crowns"),
            Self::Canopy(_) => ("CBD", "bulk density of crowns"),
        }
    }

    /// Returns what names of bands contain: codes of LANDFIRE's versions and words of GDAL, the preferred ones first.
    fn codes(self) -> &'static [&'static str] {
        match self {
            Self::Elevation => &["ELEV", "ELEVATION", "DEM"],
            Self::Slope => &["SLPD", "SLP", "SLOPE", PERCENT_SLOPE],
            Self::Aspect => &["ASP", "ASPECT"],
            Self::Fuel => &["FBFM40", "F40", "FBFM", "FBFM13", "F13", "FUEL MODELS", "FUEL MODEL", "FUEL"],
            Self::Canopy(3) => &["CC", "CANOPY COVER"],
            Self::Canopy(0) => &["CH", "CANOPY HEIGHT"],
            Self::Canopy(1) => &["CBH", "CANOPY BASE HEIGHT"],
            Self::Canopy(_) => &["CBD", "CANOPY BULK DENSITY"],
        }
    }

    /// Returns the band that holds this layer: by its name, such as `US_240FBFM40` or `LC22_F40_230`, or, where no band has a
    /// name, in the order of LANDFIRE's stacks.
    fn band(self, bands: &[Band]) -> Option<TakenBand> {
        // Without names the order of landscape files decides, which have 5, 8 or 10 bands.
        if bands.iter().all(|band| band.name.is_none()) {
            let place = Self::ALL.iter().position(|kind| *kind == self)?;
            let number = Some(place).filter(|place| [5, 8, 10].contains(&bands.len()) && *place < bands.len())?;
            return Some(TakenBand { number, reason: String::new() });
        }
        let mut found: Vec<(usize, usize)> = Vec::new();
        for (number, name) in bands.iter().enumerate().filter_map(|(number, band)| Some((number, band.name.as_ref()?)))
        {
            found.extend(self.codes().iter().position(|code| has_code(name, code)).map(|rank| (rank, number)));
        }
        // By the rank of the code, so that the preferred one comes first wherever it is in the file.
        found.sort_unstable();
        let (&(rank, number), others) = found.split_first()?;
        let others: Vec<String> = others.iter().map(|(_, other)| (other + 1).to_string()).collect();
        let is_first = found.get(1).is_some_and(|second| second.0 == rank);
        let reason = match (others.is_empty(), is_first) {
            (true, _) => String::new(),
            (_, true) => format!(", the first of several (also band {})", others.join(", ")),
            (_, false) => format!(", preferred as {} (not band {})", self.codes()[rank], others.join(", ")),
        };
        Some(TakenBand { number, reason })
    }

    /// What stands in cells of the rim.
    fn without_data(self) -> f32 {
        match self {
            Self::Elevation => f32::NAN,
            Self::Aspect => FLAT,
            _ => 0.0,
        }
    }

    /// Returns the values of a band in the units of LANDFIRE: metres, degrees, percent, tenths of metres, hundredths of kg/m3.
    /// Without a unit they are in these.
    fn converted(self, band: &Band) -> Result<Raster, String> {
        let of_name = band.name.as_ref().filter(|name| self == Self::Slope && has_code(name, PERCENT_SLOPE));
        let of_heights = band.height_unit.as_deref().filter(|_| self == Self::Elevation);
        let stated = band.unit.as_deref().or(of_heights).or(of_name.map(|_| "percent"));
        let mut raster = band.raster.clone();
        // Fuel numbers have no unit, whatever a file says.
        let Some(unit) = stated.filter(|unit| !unit.trim().is_empty() && self != Self::Fuel) else { return Ok(raster) };
        let convert = self.conversion(unit).ok_or_else(|| {
            let unit = wildfire_base::untrusted::visible_start(unit);
            format!(
                "its unit is `{unit}`, which is not known for the {}; expected {}, or none (gdal_edit.py -units NAME in.tif \
                 sets it)",
                self.names().1,
                match self {
                    Self::Slope => "degree or percent",
                    Self::Aspect => "degree",
                    Self::Canopy(2) => "kg/m3 or lb/ft3",
                    Self::Canopy(3) => "percent",
                    _ => "metre or foot",
                }
            )
        })?;
        for index in 0..raster.values.len() {
            let value = raster.values[index];
            // A converted NODATA value would be taken for data.
            if !raster.is_nodata(value) {
                raster.values[index] = convert(value.into()) as f32;
            }
        }
        Ok(raster)
    }

    /// Returns what makes values of the units of LANDFIRE out of those of a unit; `None` if it is not known.
    fn conversion(self, unit: &str) -> Option<Box<dyn Fn(f64) -> f64>> {
        let unit = unit.trim().to_lowercase();
        let (base, parts) = unit.rsplit_once(" x ").map_or((&unit[..], "1"), |(base, parts)| (base, parts));
        // A part that is not a number makes the size NaN, which is refused below.
        let size = length_m(base).map(|size| size / parts.parse::<f64>().unwrap_or(f64::NAN));
        let percent = ["%", "percent", "per cent"].contains(&base);
        let degrees = ["degree", "degrees", "deg", "\u{b0}", "azimuth degrees"].contains(&base);
        let radians = ["rad", "radian", "radians"].contains(&base);
        Some(match self {
            Self::Elevation => {
                let size = size.filter(|size| size.is_finite())?;
                Box::new(move |length| size * length)
            }
            Self::Canopy(0 | 1) => {
                // Canopy heights are whole tenths of metres here.
                let tenths = 10.0 * size.filter(|size| size.is_finite())?;
                Box::new(move |length| (tenths * length).round())
            }
            Self::Canopy(2) => {
                let size = match base {
                    "kg/m3" | "kg/m^3" | "kg m-3" | "kg/m\u{b3}" => 1.0,
                    "lb/ft3" | "lb/ft^3" => KG_M3_PER_LB_FT3,
                    _ => return None,
                };
                let hundredths = 100.0 * size / parts.parse::<f64>().ok()?;
                Box::new(move |density| (hundredths * density).round())
            }
            Self::Canopy(_) if ["fraction", "share", "1"].contains(&base) => Box::new(|share| (100.0 * share).round()),
            Self::Slope if percent => Box::new(|percent| ops::atan2(percent, 100.0).to_degrees()),
            Self::Slope | Self::Aspect if radians => Box::new(f64::to_degrees),
            // Counter-clockwise from east, 0 where the ground is flat (GRASS GIS, r.slope.aspect).
            Self::Aspect if base == "grass degrees" => {
                Box::new(|angle| if angle == 0.0 { FLAT.into() } else { (450.0 - angle) % 360.0 })
            }
            Self::Canopy(_) if percent => Box::new(|value| value),
            Self::Slope | Self::Aspect if degrees => Box::new(|value| value),
            Self::Fuel => Box::new(|value| value),
            _ => return None,
        })
    }

    /// Says how slopes and aspects of a stack contradict its elevations, if they are those in another unit.
    fn contradiction(self, bands: &[Band]) -> Option<String> {
        /// How far means may differ, as a share, and how steep ground must be on average.
        const TOLERANCE: f64 = 0.15;
        const MIN_DEG: f64 = 1.0;
        if !matches!(self, Self::Elevation | Self::Slope | Self::Aspect) {
            return None;
        }
        let layer = |kind: Self| {
            let number = kind.band(bands)?.number;
            Some((number + 1, kind.converted(&bands[number]).ok()?))
        };
        let (of_heights, heights) = layer(Self::Elevation)?;
        let slopes = layer(Self::Slope);
        let aspects = layer(Self::Aspect);
        let (rows, cols) = (heights.rows, heights.cols);
        let mut slope = SlopeErrors::default();
        let mut count = 0.0;
        let mut turned = 0.0;
        let mut azimuth = 0.0;
        // A sample is enough for means, and large rasters have billions of cells.
        let step = ((rows * cols / 100_000) as f64).sqrt().ceil().max(1.0) as usize;
        // Every so many rows and columns: every so many cells could be those of one column. Horn's slope needs all eight
        // neighbours, so the border is left out.
        let inner = (1..rows.saturating_sub(1)).step_by(step);
        let sampled = inner.flat_map(|row| (1..cols.saturating_sub(1)).step_by(step).map(move |col| (row, col)));
        for (row, col) in sampled {
            let height = |row: usize, col: usize| {
                let height = heights.value(row, col);
                if heights.is_nodata(height) { f64::NAN } else { height.into() }
            };
            // Horn (1981): differences in the middle count twice as much as those at the sides.
            let rise_by = |ahead: [f64; 3], behind: [f64; 3]| {
                (ahead[0] - behind[0] + 2.0 * (ahead[1] - behind[1]) + ahead[2] - behind[2]) / (8.0 * heights.cell_m)
            };
            let column = |col: usize| [row - 1, row, row + 1].map(|row| height(row, col));
            let across = |row: usize| [col - 1, col, col + 1].map(|col| height(row, col));
            let east = rise_by(column(col + 1), column(col - 1));
            let north = rise_by(across(row + 1), across(row - 1));
            let rise = ops::hypot(east, north);
            if rise.is_nan() {
                continue;
            }
            let expected = ops::atan(rise).to_degrees();
            if let Some(found) = slopes.as_ref().map(|(_, it)| it.value(row, col)).filter(|found| found.is_finite()) {
                slope.add(found.into(), rise);
            }
            if let Some(found) = aspects.as_ref().map(|(_, it)| it.value(row, col))
                // Where the ground is nearly level its aspect is noise.
                && expected > MIN_DEG
                && (0.0..=360.0).contains(&found)
            {
                // The difference of two angles, folded to 0 to 180 degrees.
                let apart = |angle: f64| ((f64::from(found) - angle + 540.0).rem_euclid(360.0) - 180.0).abs();
                count += 1.0;
                // Downhill as an azimuth, and the same direction against the clock from east.
                azimuth += apart(ops::atan2(-east, -north).to_degrees());
                turned += apart(ops::atan2(-north, -east).to_degrees());
            }
        }
        let of_slopes = slopes.map_or(0, |(number, _)| number);
        // Level ground fits any unit.
        if slope.expected[0] > MIN_DEG * slope.count && slope.errors[0] > TOLERANCE * slope.expected[0] {
            // A unit is named only if it explains what is found; else the data may simply be of another place.
            let fits = |way: usize| slope.errors[way] < TOLERANCE * slope.expected[way];
            if fits(1) {
                return Some(format!(
                    "by the elevations of band {of_heights} the slopes of band {of_slopes} are in percent, expected degrees; the \
                     elevations can be used instead"
                ));
            }
            if fits(2) {
                return Some(format!(
                    "by the slopes of band {of_slopes} the elevations of band {of_heights} are in feet, expected metres; \
                     gdal_translate -b {of_heights} -a_scale 0.3048 in.tif out.tif converts them"
                ));
            }
        }
        let of_aspects = aspects.map_or(0, |(number, _)| number);
        // Close to the one convention and far from the other, as neither noise nor data of another place would be.
        (count > 0.0 && turned < 15.0 * count && azimuth > 30.0 * count).then(|| {
            format!(
                "by the elevations of band {of_heights} the aspects of band {of_aspects} count from east against the clock, \
                 expected azimuths; the elevations can be used instead"
            )
        })
    }

    /// Says that no band holds this layer.
    fn absent(self, bands: &[Band]) -> String {
        let names: Vec<&str> = bands.iter().map(|band| band.name.as_deref().unwrap_or("without a name")).collect();
        let (band_name, text) = self.names();
        format!(
            "none of its {} bands is known to hold the {text} ({}); expected a band named {band_name}, or 5, 8 or 10 bands \
             without names in the order of LANDFIRE",
            bands.len(),
            names.join(", ")
        )
    }

    /// Returns what is expected instead of a value; `None` if the value is right.
    fn expects(self, value: f32, custom_fuels: &CustomFuels) -> Option<&'static str> {
        match self {
            Self::Fuel if is_fuel_model(value, custom_fuels) => None,
            Self::Fuel if custom_number(value.max(0.0) as u32).is_some() && value.fract() == 0.0 => Some(
                "the number of a fuel model: 1 to 13, 91, 92, 93, 98, 99, or 101 to 204 (no custom fuel model has this one)",
            ),
            Self::Fuel => Some("the number of a fuel model: 1 to 13, 91, 92, 93, 98, 99, or 101 to 204"),
            Self::Elevation if (LOWEST_M..=HIGHEST_M).contains(&value) => None,
            Self::Elevation => Some("an elevation from -500 to 9000 m (are these feet?)"),
            Self::Slope if (0.0..90.0).contains(&value) => None,
            Self::Slope => Some("a slope from 0 to 90 degrees (is this percent?)"),
            Self::Aspect if value == FLAT || (0.0..=360.0).contains(&value) => None,
            Self::Aspect => Some("a compass azimuth from 0 to 360 degrees, or -1 where the ground is flat"),
            Self::Canopy(place) if value.fract() == 0.0 && (0.0..=CANOPY[place].0).contains(&value) => None,
            Self::Canopy(place) => Some(CANOPY[place].1),
        }
    }
}

/// Says whether a value is the number of a built-in or a custom fuel model.
fn is_fuel_model(value: f32, custom_fuels: &CustomFuels) -> bool {
    if value.fract() != 0.0 || !(0.0..1000.0).contains(&value) {
        return false;
    }
    match custom_number(value as u32) {
        Some(number) => custom_fuels.model(number).is_some(),
        None => value < 256.0 && FuelModel::by_number(value as u8).is_some(),
    }
}

/// A band of several, and why it was taken where others could have been.
struct TakenBand {
    number: usize,
    reason: String,
}

/// The code of LANDFIRE's slopes in percent.
const PERCENT_SLOPE: &str = "SLPP";

/// Says whether a name contains a code, perhaps between numbers, such as `US_240FBFM40`, or consists of these words.
fn has_code(name: &str, code: &str) -> bool {
    let upper = name.to_ascii_uppercase();
    let parts = || upper.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    parts().any(|word: &str| {
        let rest = word.trim_start_matches(|letter: char| letter.is_ascii_digit()).strip_prefix(code);
        rest.is_some_and(|rest| rest.chars().all(|letter| letter.is_ascii_digit()))
    }) || code.contains(' ') && parts().eq(code.split(' '))
}

/// Returns the metres of a unit of length by its name in lower case.
fn length_m(unit: &str) -> Option<f64> {
    Some(match unit {
        "m" | "metre" | "metres" | "meter" | "meters" => 1.0,
        "dm" | "decimetre" | "decimetres" | "decimeter" | "decimeters" => 0.1,
        "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => 0.01,
        "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => 0.001,
        "km" | "kilometre" | "kilometres" | "kilometer" | "kilometers" => 1000.0,
        "ft" | "foot" | "feet" | "international foot" | "international feet" => FOOT_M,
        "us survey foot" | "us survey feet" | "us-ft" | "ftus" | "foot_us" | "us foot" | "us feet" => US_SURVEY_FOOT_M,
        _ => return None,
    })
}

/// How far slopes are from those of elevations, in sums: as degrees, as percent, and if the elevations are in feet.
#[derive(Default)]
struct SlopeErrors {
    count: f64,
    expected: [f64; 3],
    errors: [f64; 3],
}

impl SlopeErrors {
    fn add(&mut self, found: f64, rise: f64) {
        self.count += 1.0;
        let ways = [ops::atan(rise).to_degrees(), 100.0 * rise, ops::atan(FOOT_M * rise).to_degrees()];
        for (way, expected) in ways.into_iter().enumerate() {
            self.expected[way] += expected;
            self.errors[way] += (found - expected).abs();
        }
    }
}

/// Returns the rise over run to the east and to the north of a slope that faces an azimuth.
fn gradient(slope_deg: f32, aspect_deg: f32) -> [f32; 2] {
    if aspect_deg == FLAT {
        return [0.0; 2];
    }
    let steepness = ops::tan(f64::from(slope_deg).to_radians());
    let uphill = compass::unit_from(aspect_deg.into()) * steepness;
    [uphill.x as f32, uphill.y as f32]
}

impl ImportedLayers {
    /// Returns the numbers of fuel models by cell index: those of a file, or this one everywhere; 0 in the rim.
    pub fn fuel_or(&self, everywhere: u8) -> Vec<u8> {
        let cells = self.frame.cell_count();
        let bytes = |layer: &PackedLayer| layer.bytes(cells).expect("it was checked");
        let mut fuel = self.fuel.as_ref().map_or_else(|| vec![everywhere; cells], bytes);
        let outside = self.outside.as_ref().map(bytes).unwrap_or_default();
        fuel.iter_mut().zip(outside).filter(|&(_, is_outside)| is_outside == 1).for_each(|(fuel, _)| *fuel = 0);
        fuel
    }

    /// Returns how steep the ground is, if files say so.
    pub fn relief(&self) -> Option<Relief> {
        let numbers = |layer: &PackedLayer| layer.numbers(self.frame.cell_count()).expect("it was checked");
        if let Some(layer) = &self.elevation {
            return Some(Relief::Elevation(numbers(layer)));
        }
        let [east, north] = self.gradient.as_ref()?.each_ref().map(numbers);
        Some(Relief::Gradient(east.into_iter().zip(north).map(|(east, north)| [east, north]).collect()))
    }

    /// Puts the trees that files give in place of others.
    pub fn plant(&self, trees: &mut CanopyLayers) {
        for (layer, numbers) in self.canopy.iter().zip(&mut trees.0) {
            if let Some(layer) = layer {
                let imported = layer.numbers(self.frame.cell_count()).expect("it was checked");
                *numbers = imported.into_iter().map(|number| number as u16).collect();
            }
        }
    }

    /// Says whether files give the fuel or the relief.
    pub fn gives_ground(&self) -> bool {
        self.fuel.is_some() || self.elevation.is_some() || self.gradient.is_some()
    }

    /// Checks layers that were not read from rasters but from a plan.
    pub(crate) fn is_sound(&self, fuels: &CustomFuels) -> bool {
        let FieldFrame { cols, rows, cell_m } = self.frame;
        let side_fits = |side: u16| (1..=MAX_RASTER_SIDE).contains(&side.into());
        let is_whole = side_fits(cols) && side_fits(rows) && self.frame.cell_count() <= MAX_RASTER_CELLS;
        if !(is_whole && cell_m.is_finite() && cell_m > 0.0) {
            return false;
        }
        let cells = self.frame.cell_count();
        let fuel_fits = |layer: &PackedLayer| {
            layer
                .bytes(cells)
                .is_some_and(|fuel| fuel.iter().all(|number| *number == 0 || fuels.model(*number).is_some()))
        };
        let numbers_fit =
            |layer: &PackedLayer| layer.numbers(cells).is_some_and(|numbers| numbers.iter().all(|n| n.is_finite()));
        self.fuel.as_ref().is_none_or(fuel_fits)
            && self.outside.as_ref().is_none_or(|layer| layer.bytes(cells).is_some())
            && self.elevation.iter().chain(self.gradient.iter().flatten()).all(numbers_fit)
            && self.canopy.iter().flatten().all(numbers_fit)
    }

    /// Returns the same with fuel that no raster gives.
    pub(crate) fn with_fuel(self, fuel: &[u8]) -> Self {
        Self { fuel: Some(PackedLayer::from_bytes(fuel)), ..self }
    }

    /// Creates layers of fuel alone, such as an image gives.
    pub(crate) fn from_fuel(frame: FieldFrame, fuel: &[u8]) -> Self {
        let fuel = Some(PackedLayer::from_bytes(fuel));
        Self {
            frame,
            west_m: 0.0,
            south_m: 0.0,
            crs: None,
            fuel,
            elevation: None,
            gradient: None,
            canopy: [const { None }; 4],
            outside: None,
            bands: Vec::new(),
            doubts: Vec::new(),
        }
    }
}

impl PackedLayer {
    pub(crate) fn from_bytes(bytes: &[u8]) -> Self {
        Self(BASE64.encode(&compress_to_vec(bytes, PACKING)))
    }

    fn from_numbers(numbers: &[f32]) -> Self {
        let mut before = 0;
        // Neighbours are alike, so that their differences have equal leading bytes.
        let differences: Vec<[u8; 4]> = numbers
            .iter()
            .map(|number| {
                let bits = number.to_bits();
                let difference = bits.wrapping_sub(before);
                before = bits;
                difference.to_be_bytes()
            })
            .collect();
        // Bytes of one place side by side: equal ones in a row pack better.
        let bytes: Vec<u8> = (0..4).flat_map(|place| differences.iter().map(move |bytes| bytes[place])).collect();
        Self::from_bytes(&bytes)
    }

    /// Packs differences of neighbours, their high bytes before their low ones.
    pub(crate) fn from_integers(integers: &[i16]) -> Self {
        let before = std::iter::once(0).chain(integers.iter().copied());
        let differences: Vec<[u8; 2]> =
            integers.iter().zip(before).map(|(number, before)| number.wrapping_sub(before).to_be_bytes()).collect();
        let bytes: Vec<u8> = [0, 1].iter().flat_map(|&place| differences.iter().map(move |pair| pair[place])).collect();
        Self::from_bytes(&bytes)
    }

    pub(crate) fn integers(&self, expected: usize) -> Option<Vec<i16>> {
        let bytes = self.bytes(2 * expected)?;
        let mut number = 0_i16;
        let integers = (0..expected).map(|index| {
            number = number.wrapping_add(i16::from_be_bytes([bytes[index], bytes[expected + index]]));
            number
        });
        Some(integers.collect())
    }

    pub(crate) fn bytes(&self, expected: usize) -> Option<Vec<u8>> {
        let bytes = decompress_to_vec_with_limit(&BASE64.decode(self.0.as_bytes()).ok()?, expected).ok()?;
        (bytes.len() == expected).then_some(bytes)
    }

    fn numbers(&self, expected: usize) -> Option<Vec<f32>> {
        let bytes = self.bytes(4 * expected)?;
        let mut bits = 0_u32;
        let numbers = (0..expected).map(|index| {
            let difference = [0, 1, 2, 3].map(|place| bytes[place * expected + index]);
            bits = bits.wrapping_add(u32::from_be_bytes(difference));
            f32::from_bits(bits)
        });
        Some(numbers.collect())
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// Writes a raster of 2 rows and 3 columns, the south row first.
    fn file(folder: &Path, name: &str, values: [f32; 6], change: impl FnOnce(&mut Raster)) -> PathBuf {
        let west_m = 500_000.0;
        let south_m = 4_000_000.0;
        let cell_m = 30.0;
        let nodata = Some(-9999.0);
        let mut raster =
            Raster { rows: 2, cols: 3, west_m, south_m, cell_m, values: values.to_vec(), nodata, crs: None };
        change(&mut raster);
        let path = folder.join(name);
        raster::write_asc(&path, &raster).expect("the scratch folder takes files");
        path
    }

    const FUELS: [f32; 6] = [102.0, 102.0, 98.0, 145.0, 99.0, 1.0];

    #[test]
    fn layers_survive_being_packed() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let heights = [1.5, -2.25, 300.0, 1e-3, 0.0, 8848.5];
        let mut reader = LayerReader::default();
        reader.read(LayerKind::Fuel, &file(folder.path(), "fuel.asc", FUELS, |_| ())).expect("it is right");
        reader.read(LayerKind::Elevation, &file(folder.path(), "dem.asc", heights, |_| ())).expect("it fits");
        let layers = reader.finish().expect("two were read");
        assert_eq!((layers.frame.cols, layers.frame.rows, layers.frame.cell_m), (3, 2, 30.0));
        assert_eq!(layers.fuel_or(0), FUELS.map(|number| number as u8));
        assert_eq!(layers.relief(), Some(Relief::Elevation(heights.to_vec())));
        let written = serde_json::to_string(&layers).expect("it is text and numbers");
        let read: ImportedLayers = serde_json::from_str(&written).expect("it was written so");
        assert!(read == layers && read.is_sound(&CustomFuels::default()));
        let broken = written.replacen("\"fuel\":\"", "\"fuel\":\"AAAA", 1);
        assert!(
            !serde_json::from_str::<ImportedLayers>(&broken).expect("it is text").is_sound(&CustomFuels::default())
        );
    }

    #[test]
    fn slopes_face_downhill_and_gradients_point_uphill() {
        let [east, north] = gradient(45.0, 180.0);
        assert!(east == 0.0 && (north - 1.0).abs() < 1e-6, "a slope that faces south rises to the north");
        assert_eq!(gradient(30.0, -1.0), [0.0, 0.0]);
    }

    #[test]
    fn ignitions_are_drawn_in_proportion_to_their_weights() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let file = file(folder.path(), "weights.asc", [0.0, 3.0, 0.0, 0.0, -9999.0, 1.0], |_| ());
        let frame = FieldFrame { cols: 3, rows: 2, cell_m: 30.0 };
        let weights = Some(Weights::read(&file, &frame, None).expect("it fits"));
        let density = crate::IgnitionDensity { file, count: 1, weights };
        let [heavy, light] = [(1, 0), (2, 1)].map(wildfire_base::geometry::Cell::from);
        let mut heavy_first = 0_u32;
        for seed in 0..1000 {
            let order = density.order(&frame, seed, 0);
            assert!(order == [heavy, light] || order == [light, heavy], "{order:?}");
            heavy_first += u32::from(order[0] == heavy);
        }
        // Three of four, standard deviation 14.
        assert!(heavy_first.abs_diff(750) < 70, "{heavy_first}");
    }

    #[test]
    fn layers_that_do_not_fit_are_refused_with_file_row_and_column() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let fuel = file(folder.path(), "fuel.asc", FUELS, |_| ());
        let mut wrong = 0;
        let mut refusal = |kind, values, change: &dyn Fn(&mut Raster)| {
            wrong += 1;
            let path = file(folder.path(), &format!("{wrong}.asc"), values, change);
            let mut reader = LayerReader::default();
            reader.read(LayerKind::Fuel, &fuel).expect("it is right");
            reader.read(kind, &path).expect_err("it does not fit")
        };
        let mut with = |kind, value: f32| {
            let mut values = [1.0; 6];
            values[1] = value;
            refusal(kind, values, &|_| ())
        };
        for (kind, value, expected) in [
            (LayerKind::Fuel, 14.0, "row 1, column 1: found 14, expected the number of a fuel model"),
            (LayerKind::Fuel, 102.5, "found 102.5"),
            (LayerKind::Elevation, 12_000.0, "are these feet?"),
            (LayerKind::Slope, 110.0, "is this percent?"),
            (LayerKind::Aspect, 361.0, "a compass azimuth"),
        ] {
            let found = with(kind, value);
            assert!(found.contains(expected) && found.contains(".asc: row"), "{found}");
        }
        let flat = |change: &dyn Fn(&mut Raster)| {
            let path = file(folder.path(), "other.asc", [1.0; 6], change);
            let mut reader = LayerReader::default();
            reader.read(LayerKind::Fuel, &fuel).expect("it is right");
            reader.read(LayerKind::Elevation, &path).expect_err("it does not fit")
        };
        let shape = flat(&|raster| (raster.rows, raster.cols) = (3, 2));
        assert!(shape.contains("it has 3 rows and 2 columns, expected 2 and 3 as in"), "{shape}");
        assert!(flat(&|raster| raster.cell_m = 10.0).contains("its cells are of 10 m, expected 30 m"));
        assert!(
            flat(&|raster| raster.west_m += 1.0).contains("its south-west corner is at (500001, 4000000), expected")
        );
    }

    /// A raster of 20 rows and 24 columns of a function of east and north in metres, without data where it is NaN.
    fn layer(value: impl Fn(f32, f32) -> f32) -> Raster {
        let place = |index: usize| (30.0 * (index % 24) as f32, 30.0 * (index / 24) as f32);
        let values = (0..480).map(|index| value(place(index).0, place(index).1)).collect();
        let west_m = 500_000.0;
        let south_m = 4_000_000.0;
        let cell_m = 30.0;
        Raster { rows: 20, cols: 24, west_m, south_m, cell_m, values, nodata: None, crs: None }
    }

    fn band(name: &str, raster: Raster) -> Band {
        Band { name: Some(name.to_owned()), unit: None, height_unit: None, raster }
    }

    #[test]
    fn a_rim_without_data_burns_nothing_and_leaves_the_slopes_beside_it() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let is_rim = |east: f32, north: f32| east + north < 150.0 || north > 500.0;
        let plane =
            |east: f32, north: f32| if is_rim(east, north) { f32::NAN } else { 1000.0 + 0.3 * east - 0.1 * north };
        let file = |name: &str, raster: &Raster| {
            let path = folder.path().join(name);
            raster::write_asc(&path, raster).expect("the scratch folder takes files");
            path
        };
        let dem = file("dem.asc", &layer(plane));
        let mut reader = LayerReader::default();
        reader.read(LayerKind::Elevation, &dem).expect("only its rim is without data");
        let layers = reader.finish().expect("one was read");
        let fuel = layers.fuel_or(102);
        let relief = layers.relief().expect("there are heights");
        let landscape = wildfire_fire::Landscape { fuel, relief, ..wildfire_fire::Landscape::uniform(layers.frame, 0) };
        for index in 0..480 {
            let cell = layers.frame.cell(index);
            let outside = is_rim(30.0 * f32::from(cell.col), 30.0 * f32::from(cell.row));
            assert_eq!(landscape.fuel_number(cell), if outside { 0 } else { 102 });
            let apart = landscape.gradient(cell) - wildfire_base::geometry::DVec2::new(0.3, -0.1);
            assert!(outside || apart.length() < 1e-4, "{cell:?}: {apart}");
        }
        assert!(
            layers.doubts[0].contains("cells at the rim of") && layers.is_sound(&CustomFuels::default()),
            "{:?}",
            layers.doubts
        );
        // The rim of the first raster holds for all; a gap within it is named, and so is a raster of nothing else.
        let fuel = file("fuel.asc", &layer(|east, north| if is_rim(east, north) { f32::NAN } else { 102.0 }));
        let gap = |east: f32, north: f32| if (east, north) == (300.0, 300.0) { f32::NAN } else { plane(east, north) };
        let with_gap = file("gap.asc", &layer(gap));
        let without_border = |east: f32, north: f32| if east == 690.0 { f32::NAN } else { plane(east, north) };
        let bordered = file("border.asc", &layer(without_border));
        for (path, expected) in [(&with_gap, Some("row 9, column 10: found NODATA")), (&bordered, None), (&dem, None)] {
            let mut reader = LayerReader::default();
            reader.read(LayerKind::Fuel, &fuel).expect("only its rim is without data");
            let read = reader.read(LayerKind::Elevation, path);
            assert_eq!(read.is_ok(), expected.is_none());
            assert!(read.err().unwrap_or_default().contains(expected.unwrap_or_default()));
        }
    }

    #[test]
    fn units_that_files_state_are_applied_or_refused() {
        use LayerKind::{Aspect, Canopy, Elevation, Slope};
        let value = |kind: LayerKind, unit: &str, value: f32| {
            let band = Band { unit: Some(unit.to_owned()), ..band("CC", layer(|_, _| value)) };
            kind.converted(&band).map(|raster| raster.values[7])
        };
        for (kind, unit, stated, expected) in [
            (Elevation, "metre", 300.0, 300.0),
            (Elevation, "foot", 1000.0, 304.8),
            (Elevation, "US survey foot", 3937.0, 1200.0),
            (Elevation, "dm", 300.0, 30.0),
            (Slope, "Percent", 100.0, 45.0),
            (Slope, "degree", 30.0, 30.0),
            (Aspect, "Grass degrees", 90.0, 0.0),
            (Aspect, "Grass degrees", 0.0, FLAT),
            (Canopy(0), "m", 19.04, 190.0),
            (Canopy(0), "Feet x 10", 1000.0, 305.0),
            (Canopy(1), "Meters x 10", 12.0, 12.0),
            (Canopy(2), "kg/m^3", 0.12, 12.0),
            (Canopy(2), "lb/ft^3 x 1000", 10.0, 16.0),
            (Canopy(3), "fraction", 0.45, 45.0),
        ] {
            let found = value(kind, unit, stated).expect("the unit is known");
            assert!((found - expected).abs() < 1e-3, "{unit}: {found}");
        }
        for (kind, unit) in
            [(Elevation, "fathom"), (Slope, "m"), (Aspect, "Grass categories"), (Canopy(3), "Categories")]
        {
            let refused = value(kind, unit, 1.0).expect_err("the unit is not known");
            assert!(refused.contains(unit) && refused.contains("gdal_edit.py -units"), "{refused}");
        }
        let of_system = Band { height_unit: Some("US survey feet".into()), ..band("DEM", layer(|_, _| 3937.0)) };
        assert_eq!(Elevation.converted(&of_system).map(|raster| raster.values[0]), Ok(1200.0));
        assert_eq!(Slope.converted(&of_system).map(|raster| raster.values[0]), Ok(3937.0), "it is no height");
    }

    #[test]
    fn bands_are_recognised_by_the_names_of_every_version_and_the_choice_has_a_reason() {
        use LayerKind::{Aspect, Canopy, Elevation, Fuel, Slope};
        for (kind, names) in [
            (Fuel, &["LC22_F40_230", "US_105FBFM40", "LC24_FBFM13_250", "200F13_20", "Fuel models"][..]),
            (Elevation, &["LC20_Elev_220", "US_DEM2010", "ELEV2020", "Elevation"]),
            (Slope, &["LC20_SlpD_220", "US_SLP2010", "SLPP2020", "Slope"]),
            (Aspect, &["LC20_Asp_220", "ASP2020", "Aspect"]),
            (Canopy(0), &["LC23_CH_240", "230CH_22", "Canopy height"]),
            (Canopy(1), &["LC22_CBH_230", "Canopy base height"]),
            (Canopy(2), &["US_200CBD", "Canopy bulk density"]),
            (Canopy(3), &["LC22_CC_230", "Canopy cover"]),
        ] {
            for name in names {
                let stack = [band("Band x", layer(|_, _| 0.0)), band(name, layer(|_, _| 0.0))];
                let meant: Vec<_> = LayerKind::ALL.into_iter().filter(|kind| kind.band(&stack).is_some()).collect();
                assert_eq!(meant, [kind], "{name}");
            }
        }
        let stack =
            ["LC20_F13_200", "LC22_F40_230", "LC22_CC_230", "LC20_CC_200"].map(|name| band(name, layer(|_, _| 0.0)));
        let taken = |kind: LayerKind| kind.band(&stack).map(|band| (band.number, band.reason)).expect("there are some");
        assert_eq!(taken(Fuel), (1, ", preferred as F40 (not band 1)".to_owned()));
        assert_eq!(taken(Canopy(3)), (2, ", the first of several (also band 4)".to_owned()));
        let percent = band("LC20_SlpP_220", layer(|_, _| 100.0));
        assert_eq!(Slope.converted(&percent).map(|raster| raster.values[0]), Ok(45.0));
    }

    #[test]
    fn slopes_and_aspects_in_other_units_than_the_elevations_say_are_refused() {
        let hill = |east: f32, north: f32| {
            let square = f64::from((east - 300.0) * (east - 300.0) + (north - 330.0) * (north - 330.0));
            (400.0 * ops::exp(-square / 9e4)) as f32
        };
        // By the derivatives, not by differences of neighbours.
        let rise = |east: f32, north: f32| {
            let slope = hill(east, north) * 2.0 / 9e4;
            [-(east - 300.0) * slope, -(north - 330.0) * slope].map(f64::from)
        };
        let steepness = |east: f32, north: f32| ops::hypot(rise(east, north)[0], rise(east, north)[1]) as f32;
        let against_the_clock = |east: f32, north: f32| {
            let [east, north] = rise(east, north);
            ops::atan2(-north, -east).to_degrees().rem_euclid(360.0) as f32
        };
        let degrees = |east: f32, north: f32| ops::atan(steepness(east, north).into()).to_degrees() as f32;
        let azimuth = |east: f32, north: f32| (450.0 - against_the_clock(east, north)) % 360.0;
        let refusal = |heights: Raster, slopes: Raster, aspects: Raster| {
            let stack = [band("ELEV", heights), band("SLPD", slopes), band("ASP", aspects)];
            LayerKind::Slope.contradiction(&stack).unwrap_or_default()
        };
        assert_eq!(refusal(layer(hill), layer(degrees), layer(azimuth)), "");
        let percent = layer(|east, north| 100.0 * steepness(east, north));
        assert!(refusal(layer(hill), percent, layer(azimuth)).contains("the slopes of band 2 are in percent"));
        let feet = layer(|east, north| hill(east, north) / 0.3048);
        assert!(refusal(feet, layer(degrees), layer(azimuth)).contains("-b 1 -a_scale 0.3048"));
        assert!(refusal(layer(hill), layer(degrees), layer(against_the_clock)).contains("against the clock"));
    }

    #[test]
    fn trees_of_an_unlikely_size_are_doubted() {
        let doubt = |place, value| doubt_of_trees(place, &[0.0, value], "a.tif").unwrap_or_default();
        assert!(
            doubt(0, 19.0)
                .contains("the greatest height of trees is 1.9 m, as the raster was read in tenths of metres")
        );
        assert!(doubt(0, 19.0).contains("gdal_translate -a_scale 10 in.tif out.tif converts metres"));
        assert!(
            doubt(1, 2.0).contains("0.2 m") && doubt(2, 1.0).contains("0.01 kg/m3") && doubt(3, 1.0).contains("1 %")
        );
        assert!(doubt(0, 1200.0).contains("120 m"));
        for (place, value) in [(0, 190.0), (0, 0.0), (1, 20.0), (2, 12.0), (3, 45.0)] {
            assert_eq!(doubt(place, value), "");
        }
    }
}
