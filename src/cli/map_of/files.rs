//! The files of a map.

use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use clap::Args;

use crate::cli::error::CliError;
use crate::cli::output_files::{Format, Output, write_all};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::input_file::is_standard_stream;
use wildfire_batch::maps::{BatchMaps, BatchQuantity};
use wildfire_grid::Grid;
use wildfire_grid::map_files::raster::{GeoKeys, Raster, write_asc, write_geotiff, write_geotiff_bands};
use wildfire_grid::map_files::write_npy;
use wildfire_picture::{FieldMap, MapQuantity, bush_covers, draw_field_maps, ground_covers};
use wildfire_scenario::{ImportedLayers, Scenario};
use wildfire_timeline::{FireBehavior, Setting, SpreadSetting};

/// The value of a raster's cells that have none.
const NODATA: f32 = -9999.0;

/// The files that are asked for.
#[derive(Debug, Args)]
pub struct MapOfFiles {
    /// Write an ESRI ASCII grid.
    #[arg(long, value_name = "FILE.asc")]
    asc: Option<PathBuf>,
    /// Write a GeoTIFF.
    #[arg(long, value_name = "FILE.tif")]
    tif: Option<PathBuf>,
    /// Write a NumPy array.
    #[arg(long, value_name = "FILE.npy")]
    npy: Option<PathBuf>,
    /// Write time, fire type, flame length and intensity of one run as the bands of a GeoTIFF.
    #[arg(long, value_name = "FILE.tif", conflicts_with_all = ["burn_probability", "mean_arrival", "mean_intensity", "flame_class"])]
    pub bands: Option<PathBuf>,
    /// Draw the map.
    #[arg(long, value_name = "FILE.png")]
    png: Option<PathBuf>,
    /// A heading above the picture.
    #[arg(long, value_name = "TEXT", requires = "png")]
    title: Option<String>,
}

/// A map, and how it is drawn.
pub struct Panel {
    pub title: String,
    pub quantity: MapQuantity,
    /// What goes into files, by cell index, each with what its files' names end in; none of a map that is only drawn.
    pub values: Vec<(String, Vec<f64>)>,
    /// What is drawn, if that is not the first of these.
    pub shown: Vec<f64>,
    pub without_value: &'static str,
    pub ignitions: Vec<Cell>,
    /// By cell index, of a batch: something there can burn, in some run.
    pub burnable: Option<Rc<Vec<bool>>>,
    pub setting: Setting,
    pub place: EarthPlace,
}

/// The place of the field on earth, as the files of its landscape have it: its south-west corner in metres, and in which
/// coordinate system these are.
#[derive(Clone, Debug, Default)]
pub struct EarthPlace {
    pub west_m: f64,
    pub south_m: f64,
    pub crs: Option<GeoKeys>,
}

impl EarthPlace {
    /// The origin of coordinates, without a name of their system, where no file says more.
    pub fn new(scenario: Option<&Scenario>) -> Self {
        scenario.and_then(Scenario::layers).map_or_else(Self::default, Self::from_layers)
    }

    pub fn from_layers(layers: &ImportedLayers) -> Self {
        Self { west_m: layers.west_m, south_m: layers.south_m, crs: layers.crs.clone() }
    }

    /// Writes arrival times and fire behaviour as the bands of one GeoTIFF.
    pub fn write_bands(
        &self,
        path: &Path,
        frame: FieldFrame,
        arrival_s: &[f64],
        behavior: &FireBehavior,
    ) -> io::Result<()> {
        let bands = [
            ("Arrival time (s)", arrival_s),
            ("Fire type (0 surface, 1 passive, 2 conditional, 3 active)", &behavior.fire_type),
            ("Flame length (m)", &behavior.flame_length_m),
            ("Fireline intensity (kW/m)", &behavior.intensity_kw_m),
        ];
        let rasters = bands.map(|(name, values)| (name, raster(self, frame, values)));
        write_geotiff_bands(path, &rasters.each_ref().map(|(name, raster)| (*name, raster)))
    }
}

/// Where the map is to be written.
pub struct MapFiles<'a> {
    asc: Option<&'a Path>,
    tif: Option<&'a Path>,
    npy: Option<&'a Path>,
    png: Option<&'a Path>,
    heading: &'a str,
    endings: &'static [&'static str],
}

impl Panel {
    /// The maps of a batch, or of two and their difference, from left to right.
    pub fn over_batch(quantity: BatchQuantity, maps: BatchMaps, place: &EarthPlace) -> Vec<Self> {
        let (panel_quantity, of_difference, without_value) = match quantity {
            BatchQuantity::BurnProbability => {
                (MapQuantity::Probability, MapQuantity::ProbabilityDifference, "never burned")
            }
            BatchQuantity::MeanArrival => (MapQuantity::ArrivalTime, MapQuantity::TimeDifference, "never burned"),
            BatchQuantity::MeanIntensity => (MapQuantity::Intensity, MapQuantity::IntensityDifference, "no front came"),
            BatchQuantity::FlameClass(_) => {
                (MapQuantity::Probability, MapQuantity::ProbabilityDifference, "no front came")
            }
        };
        let BatchMaps { mut setting, sides, difference, can_burn, is_same_ground, .. } = maps;
        if !is_same_ground {
            // No ground is that of all runs: what can burn in some is all that can be shown.
            setting.spread = None;
        }
        let burnable = Some(Rc::new(can_burn));
        let mut panels: Vec<Self> = sides
            .into_iter()
            .map(|side| Self {
                title: last_name(&side.title),
                quantity: panel_quantity,
                shown: if quantity == BatchQuantity::BurnProbability { shown(&side.values) } else { Vec::new() },
                values: vec![(String::new(), side.values)],
                without_value,
                ignitions: Vec::new(),
                burnable: burnable.clone(),
                setting: setting.clone(),
                place: place.clone(),
            })
            .collect();
        if let Some(difference) = difference {
            // The name of the last panel says what is subtracted from what, in the same order.
            // From what is subtracted to what it is subtracted from.
            panels.reverse();
            // A cell that burned on neither side has a difference of 0, and would be drawn as one that was examined.
            let burned: Vec<bool> = (0..difference.mean.len())
                .map(|index| panels.iter().any(|panel| panel.values[0].1[index] > 0.0))
                .collect();
            let shown = difference.mean.iter().zip(burned);
            let shown = shown.map(|(&mean, burned)| if burned { mean } else { f64::NAN }).collect();
            // Only the last map is written to files; the others are beside it in the picture.
            panels.iter_mut().for_each(Self::keep_drawing_only);
            let values = [("", difference.mean), ("-lower", difference.lower), ("-upper", difference.upper)];
            panels.push(Self {
                title: format!("{} minus {}", panels[1].title, panels[0].title),
                quantity: of_difference,
                values: values.map(|(ending, values)| (ending.to_owned(), values)).into(),
                shown,
                without_value,
                ignitions: Vec::new(),
                burnable,
                setting,
                place: place.clone(),
            });
        }
        panels
    }

    /// Takes from a map what would go into files.
    fn keep_drawing_only(&mut self) {
        let values = std::mem::take(&mut self.values);
        if self.shown.is_empty() {
            self.shown = values.into_iter().next().map(|(_, values)| values).unwrap_or_default();
        }
    }

    fn can_burn(&self, cell: Cell) -> bool {
        match &self.burnable {
            Some(burnable) => burnable[self.setting.frame.index(cell)],
            None => self.setting.bush_index(cell).is_some(),
        }
    }

    fn shown(&self) -> &[f64] {
        if self.shown.is_empty() { &self.values[0].1 } else { &self.shown }
    }
}

/// Leaves out the cells with 0.
// Ground that never burned is shown as such, not as burning with no probability.
fn shown(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&value| if value == 0.0 { f64::NAN } else { value }).collect()
}

/// The last name of a path, and what stands after the folder of a batch.
fn last_name(title: &str) -> String {
    title.rsplit('/').next().unwrap_or(title).to_owned()
}

impl<'a> MapFiles<'a> {
    /// `has_difference` says whether the last map is the difference of two, with its interval.
    pub fn new(arguments: &'a MapOfFiles, has_difference: bool) -> Self {
        Self {
            asc: arguments.asc.as_deref(),
            tif: arguments.tif.as_deref(),
            npy: arguments.npy.as_deref(),
            png: arguments.png.as_deref(),
            heading: arguments.title.as_deref().unwrap_or_default(),
            endings: if has_difference { &["", "-lower", "-upper"] } else { &[""] },
        }
    }

    /// Lists all files that will be written.
    pub fn every_path(&self) -> Vec<(Format, PathBuf)> {
        let rasters = [(Format::Asc, self.asc), (Format::Tif, self.tif), (Format::Npy, self.npy)];
        let rasters = rasters.into_iter().filter_map(|(format, path)| Some((format, path?)));
        let rasters =
            rasters.flat_map(|(format, path)| self.endings.iter().map(move |end| (format, with_end(path, end))));
        rasters.chain(self.png.map(|path| (Format::Png, path.to_owned()))).collect()
    }

    /// Writes the last map to rasters and arrays, and draws all of them.
    pub fn write(&self, panels: &[Panel], quiet: bool) -> Result<(), CliError> {
        let last = panels.last().expect("there is a map");
        for (end, values) in &last.values {
            let frame = last.setting.frame;
            let raster = || raster(&last.place, frame, values);
            let paths = [self.asc, self.tif, self.npy].map(|path| path.map(|path| with_end(path, end)));
            let [asc, tif, npy] = paths.each_ref().map(Option::as_deref);
            let outputs: [Output<'_>; 3] = [
                (asc, &|path| write_asc(path, &raster())),
                (tif, &|path| write_geotiff(path, &raster())),
                (npy, &|path| write_npy(path, &array(frame, values))),
            ];
            write_all(&outputs, quiet)?;
        }
        write_all(&[(self.png, &|path| self.draw(panels, path))], quiet)
    }

    fn draw(&self, panels: &[Panel], path: &Path) -> io::Result<()> {
        let setting = &panels[0].setting;
        let landscape = setting.spread.as_ref().map(SpreadSetting::landscape);
        let cells = (0..setting.frame.cell_count()).map(|index| setting.frame.cell(index));
        let covers = landscape.map_or_else(
            || bush_covers(&setting.frame, &cells.filter(|&cell| panels[0].can_burn(cell)).collect::<Vec<_>>()),
            ground_covers,
        );
        let maps: Vec<FieldMap<'_>> = panels
            .iter()
            .map(|panel| FieldMap {
                title: &panel.title,
                frame: setting.frame,
                quantity: panel.quantity,
                values: panel.shown(),
                without_value: panel.without_value,
                covers: &covers,
                landscape,
                ignitions: &panel.ignitions,
                // Bushes are islands, too small for lines.
                has_contours: panel.quantity == MapQuantity::ArrivalTime && landscape.is_some(),
            })
            .collect();
        draw_field_maps(self.heading, &maps).write_png(path)
    }
}

/// The path with an end to its name, before the ending that shows the format; stdout stays stdout.
fn with_end(path: &Path, end: &str) -> PathBuf {
    if end.is_empty() || is_standard_stream(path) {
        return path.to_owned();
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}{end}.{ending}"))
}

/// Returns values by cell index, NaN where there is none, as a raster.
pub fn raster(place: &EarthPlace, frame: FieldFrame, values: &[f64]) -> Raster {
    Raster {
        rows: frame.rows.into(),
        cols: frame.cols.into(),
        west_m: place.west_m,
        south_m: place.south_m,
        cell_m: frame.cell_m,
        values: values.iter().map(asc_value).collect(),
        nodata: Some(NODATA),
        crs: place.crs.clone(),
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rasters hold single precision")]
fn asc_value(&value: &f64) -> f32 {
    if value.is_nan() { NODATA } else { value as f32 }
}

/// The values with the north row first.
pub fn array(frame: FieldFrame, values: &[f64]) -> Grid<f64> {
    let rows = values.chunks_exact(frame.cols.into()).rev().flatten().copied();
    Grid::from_values(frame.rows.into(), frame.cols.into(), rows.collect())
}
