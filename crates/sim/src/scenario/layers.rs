//! Layers of a landscape that files give: fuel, elevation or slope, each a raster, all of one shape at one place.
//!
//! A resolved scenario holds them packed, so that it is complete without its files and yet short enough for the plan of a
//! batch: bytes packed by deflate (Deutsch, "DEFLATE Compressed Data Format Specification", RFC 1951, 1996) and written in
//! base 64 (Josefsson, RFC 4648, 2006, section 4). 32-bit values come as differences of neighbours, the first byte of all
//! of them before the second: heights that change little pack well so. Row 0 is the south edge.

use std::path::{Path, PathBuf};

use data_encoding::BASE64;
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use serde::{Deserialize, Serialize};

use wildfire_base::geometry::{FieldFrame, compass, ops};
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::{CanopyLayers, Relief};
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
pub struct GivenLayers {
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
    /// The bands that were taken from files with several, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<String>,
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
    pub(super) fn read(path: &Path, frame: &FieldFrame, layers: Option<&GivenLayers>) -> Result<Self, String> {
        let mut raster = raster::read(path).map_err(|error| error.to_string())?;
        let name = path.display().to_string();
        let [west_m, south_m] = layers.map_or([raster.west_m, raster.south_m], |it| [it.west_m, it.south_m]);
        let (rows, cols, cell_m) = (frame.rows.into(), frame.cols.into(), frame.cell_m);
        let field = Raster { rows, cols, west_m, south_m, cell_m, values: Vec::new(), nodata: None, crs: None };
        check_same_place(&raster, &field, &name, "the field")?;
        for index in 0..raster.values.len() {
            let value = raster.values[index];
            if raster.is_nodata(value) {
                raster.values[index] = 0.0;
            } else if !(0.0..=f32::MAX).contains(&value) {
                let (row, col) = (raster.file_row(index / raster.cols), index % raster.cols);
                return Err(format!("{name}: row {row}, column {col}: found {value}, expected a weight of 0 or more"));
            }
        }
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

/// Layers while their files are being read.
#[derive(Default)]
pub struct LayerReader {
    /// The first layer, whose shape and place the others must have, and its file.
    first: Option<(Raster, String)>,
    /// The last file that was read: others of its bands may be asked for next.
    bands: Option<(PathBuf, Vec<Band>)>,
    /// Which bands of files with several were taken for what.
    taken: Vec<String>,
    /// Cells for which a file of several bands has no fuel.
    without_fuel: Vec<bool>,
    fuel: Option<Vec<u8>>,
    elevation: Option<Vec<f32>>,
    slope: Option<Vec<f32>>,
    aspect: Option<Vec<f32>>,
    canopy: [Option<Vec<f32>>; 4],
}

impl LayerReader {
    /// Reads a layer from a file and checks it, value by value and against those that were read before. Of a file with several
    /// bands the one is taken that holds this layer by its name, or by the order of LANDFIRE's products.
    ///
    /// # Errors
    /// Returns a sentence that begins with the path and names row and column, counted from 0 at the north-west corner.
    pub fn read(&mut self, kind: LayerKind, path: &Path) -> Result<(), String> {
        let mut name = path.display().to_string();
        let bands = match self.bands.take() {
            Some((before, bands)) if before == path => bands,
            _ => raster::read_bands(path).map_err(|error| error.to_string())?,
        };
        let raster = match &bands[..] {
            [band] => band.raster.clone(),
            several => {
                let number = kind.band(several).ok_or_else(|| format!("{name}: {}", kind.absent(several)))?;
                let own = several[number].name.as_ref().map(|own| format!(" ({own})")).unwrap_or_default();
                self.taken.push(format!("{} from band {} of {name}{own}", kind.names().1, number + 1));
                name += &format!(", band {}", number + 1);
                several[number].raster.clone()
            }
        };
        let is_stack = bands.len() > 1;
        self.bands = Some((path.to_owned(), bands));
        if let Some((first, other)) = &self.first {
            check_same_place(&raster, first, &name, other)?;
        }
        // A stack may have a rim without data, where nothing grows; heights there would still make slopes beside it.
        let is_absent = |index: usize| raster.is_nodata(raster.values[index]);
        if is_stack && kind == LayerKind::Fuel {
            self.without_fuel = (0..raster.values.len()).map(is_absent).collect();
        }
        let is_rim = |index| {
            is_stack && kind != LayerKind::Elevation && self.without_fuel.get(index) == Some(&true) && is_absent(index)
        };
        // In the order of the file, so that what is named is its first fault.
        for (row, col) in (0..raster.rows).flat_map(|row| (0..raster.cols).map(move |col| (row, col))) {
            let index = raster.file_row(row) * raster.cols + col;
            let value = raster.values[index];
            let expected = if is_absent(index) { Some("a value in every cell") } else { kind.expects(value) };
            if let Some(expected) = expected.filter(|_| !is_rim(index)) {
                let found = if is_absent(index) { "NODATA".to_owned() } else { value.to_string() };
                return Err(format!("{name}: row {row}, column {col}: found {found}, expected {expected}"));
            }
        }
        let nothing = if kind == LayerKind::Aspect { FLAT } else { 0.0 };
        let values = raster.values.iter().enumerate();
        let values: Vec<f32> = values.map(|(index, &value)| if is_rim(index) { nothing } else { value }).collect();
        match kind {
            LayerKind::Fuel => self.fuel = Some(values.iter().map(|&number| number as u8).collect()),
            LayerKind::Elevation => self.elevation = Some(values),
            LayerKind::Slope => self.slope = Some(values),
            LayerKind::Aspect => self.aspect = Some(values),
            LayerKind::Canopy(place) => self.canopy[place] = Some(values),
        }
        if self.first.is_none() {
            self.first = Some((Raster { values: Vec::new(), ..raster }, name));
        }
        Ok(())
    }

    /// Packs what was read; `None` if nothing was.
    pub fn finish(self) -> Option<GivenLayers> {
        let (first, _) = self.first?;
        let gradient = self.slope.zip(self.aspect).map(|(slope, aspect)| {
            let gradients: Vec<_> =
                slope.iter().zip(&aspect).map(|(&slope, &aspect)| gradient(slope, aspect)).collect();
            [0, 1].map(|axis| PackedLayer::from_numbers(&gradients.iter().map(|pair| pair[axis]).collect::<Vec<_>>()))
        });
        Some(GivenLayers {
            frame: FieldFrame { cols: first.cols as u16, rows: first.rows as u16, cell_m: first.cell_m },
            west_m: first.west_m,
            south_m: first.south_m,
            crs: first.crs,
            fuel: self.fuel.as_deref().map(PackedLayer::from_bytes),
            elevation: self.elevation.as_deref().map(PackedLayer::from_numbers),
            gradient,
            canopy: self.canopy.map(|layer| layer.as_deref().map(PackedLayer::from_numbers)),
            bands: self.taken,
        })
    }
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

    /// Returns the number of the band that holds this layer: by its name, such as `US_240FBFM40`, or, where no band has a
    /// name, in the order of LANDFIRE's stacks.
    fn band(self, bands: &[Band]) -> Option<usize> {
        let own = self.names().0;
        if bands.iter().all(|band| band.name.is_none()) {
            let place = Self::ALL.iter().position(|kind| *kind == self)?;
            return Some(place).filter(|place| [5, 8, 10].contains(&bands.len()) && *place < bands.len());
        }
        let is_own = |name: &str| {
            let words = name.split(|letter: char| !letter.is_ascii_alphanumeric());
            let mut words = words.map(|word| word.trim_matches(|letter: char| letter.is_ascii_digit()));
            words.any(|word| word.eq_ignore_ascii_case(own))
        };
        bands.iter().position(|band| band.name.as_deref().is_some_and(is_own))
    }

    /// Says that no band holds this layer.
    fn absent(self, bands: &[Band]) -> String {
        let names: Vec<&str> = bands.iter().map(|band| band.name.as_deref().unwrap_or("without a name")).collect();
        let (own, words) = self.names();
        format!(
            "none of its {} bands is known to hold the {words} ({}); expected a band named {own}, or 5, 8 or 10 bands \
             without names in the order of LANDFIRE",
            bands.len(),
            names.join(", ")
        )
    }

    /// Returns what is expected instead of a value; `None` if the value is right.
    fn expects(self, value: f32) -> Option<&'static str> {
        let is_fuel =
            || value.fract() == 0.0 && (0.0..256.0).contains(&value) && { FuelModel::by_number(value as u8).is_some() };
        match self {
            Self::Fuel if is_fuel() => None,
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

/// Returns the rise over run to the east and to the north of a slope that faces an azimuth.
fn gradient(slope_deg: f32, aspect_deg: f32) -> [f32; 2] {
    if aspect_deg == FLAT {
        return [0.0; 2];
    }
    let steepness = ops::tan(f64::from(slope_deg).to_radians());
    let uphill = compass::unit_from(aspect_deg.into()) * steepness;
    [uphill.x as f32, uphill.y as f32]
}

impl GivenLayers {
    /// Returns the numbers of fuel models by cell index, if a file gives them.
    pub fn fuel(&self) -> Option<Vec<u8>> {
        self.fuel.as_ref().map(|layer| layer.bytes(self.frame.cell_count()).expect("it was checked"))
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
                let given = layer.numbers(self.frame.cell_count()).expect("it was checked");
                *numbers = given.into_iter().map(|number| number as u16).collect();
            }
        }
    }

    /// Says whether files give the fuel, and whether they give the relief.
    pub fn gives(&self) -> (bool, bool) {
        (self.fuel.is_some(), self.elevation.is_some() || self.gradient.is_some())
    }

    /// Checks layers that were not read from rasters but from a plan.
    pub(super) fn is_sound(&self) -> bool {
        let FieldFrame { cols, rows, cell_m } = self.frame;
        let side_fits = |side: u16| (1..=MAX_RASTER_SIDE).contains(&side.into());
        let is_whole = side_fits(cols) && side_fits(rows) && self.frame.cell_count() <= MAX_RASTER_CELLS;
        if !(is_whole && cell_m.is_finite() && cell_m > 0.0) {
            return false;
        }
        let cells = self.frame.cell_count();
        let is_known = |number: &u8| *number == 0 || FuelModel::by_number(*number).is_some();
        let fuel_fits = |layer: &PackedLayer| layer.bytes(cells).is_some_and(|fuel| fuel.iter().all(is_known));
        let numbers_fit =
            |layer: &PackedLayer| layer.numbers(cells).is_some_and(|numbers| numbers.iter().all(|n| n.is_finite()));
        self.fuel.as_ref().is_none_or(fuel_fits)
            && self.elevation.iter().chain(self.gradient.iter().flatten()).all(numbers_fit)
            && self.canopy.iter().flatten().all(numbers_fit)
    }

    /// Returns the same with fuel that no raster gives.
    pub(super) fn with_fuel(self, fuel: &[u8]) -> Self {
        Self { fuel: Some(PackedLayer::from_bytes(fuel)), ..self }
    }

    /// Creates layers of fuel alone, such as an image gives.
    pub(super) fn from_fuel(frame: FieldFrame, fuel: &[u8]) -> Self {
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
            bands: Vec::new(),
        }
    }
}

impl PackedLayer {
    pub(super) fn from_bytes(bytes: &[u8]) -> Self {
        Self(BASE64.encode(&compress_to_vec(bytes, PACKING)))
    }

    fn from_numbers(numbers: &[f32]) -> Self {
        let mut before = 0;
        let differences: Vec<[u8; 4]> = numbers
            .iter()
            .map(|number| {
                let bits = number.to_bits();
                let difference = bits.wrapping_sub(before);
                before = bits;
                difference.to_be_bytes()
            })
            .collect();
        let bytes: Vec<u8> = (0..4).flat_map(|place| differences.iter().map(move |bytes| bytes[place])).collect();
        Self::from_bytes(&bytes)
    }

    pub(super) fn bytes(&self, expected: usize) -> Option<Vec<u8>> {
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
        let (west_m, south_m, cell_m) = (500_000.0, 4_000_000.0, 30.0);
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
        assert_eq!(layers.fuel(), Some(FUELS.map(|number| number as u8).to_vec()));
        assert_eq!(layers.relief(), Some(Relief::Elevation(heights.to_vec())));
        let written = serde_json::to_string(&layers).expect("it is text and numbers");
        let read: GivenLayers = serde_json::from_str(&written).expect("it was written so");
        assert!(read == layers && read.is_sound());
        let broken = written.replacen("\"fuel\":\"", "\"fuel\":\"AAAA", 1);
        assert!(!serde_json::from_str::<GivenLayers>(&broken).expect("it is text").is_sound());
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
        let density = crate::scenario::IgnitionDensity { file, count: 1, weights };
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
            (LayerKind::Fuel, -9999.0, "row 1, column 1: found NODATA, expected a value in every cell"),
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
}
