//! Layers as they are read from files: each checked value by value, and against those before it.

use std::path::{Path, PathBuf};

use super::ImportedLayers;
use super::kind::{LayerKind, TakenBand};
use super::packed::PackedLayer;
use super::rim::{continue_into_rim, rim};
use super::slopes::gradient;
use super::units::doubt_of_trees;
use wildfire_base::geometry::FieldFrame;
use wildfire_fire::fuel::{CustomFuels, custom_number};
use wildfire_grid::map_files::raster::{self, Band, GeoKeys, Raster};

/// The share of a cell by which origins may differ, and the relative difference of sides: text is rounded.
const SAME_PLACE: f64 = 0.01;
const SAME_SIDE: f64 = 1e-6;

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

/// Refuses a layer that does not lie on the first one.
pub(super) fn check_same_place(raster: &Raster, first: &Raster, name: &str, other: &str) -> Result<(), String> {
    if (raster.rows, raster.cols) != (first.rows, first.cols) {
        return Err(format!(
            "{name}: it has {} rows and {} columns, expected {} and {} as in {other}",
            raster.rows, raster.cols, first.rows, first.cols
        ));
    }
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

fn epsg(raster: &Raster) -> Option<u16> {
    raster.crs.as_ref().and_then(GeoKeys::epsg)
}
