//! Values of cells as rasters and arrays, with their place on earth.

use std::io;
use std::path::Path;

use wildfire_base::geometry::FieldFrame;
use wildfire_grid::Grid;
use wildfire_grid::map_files::raster::{GeoKeys, Raster, write_geotiff_bands};
use wildfire_sim::scenario::{GivenLayers, Scenario};
use wildfire_timeline::FireBehavior;

/// The value of a raster's cells that have none.
const NODATA: f32 = -9999.0;

/// The place of the field on earth, as the files of its landscape have it: its south-west corner in metres, and in which
/// coordinate system these are. The default is the origin of coordinates, without a name of their system.
#[derive(Clone, Debug, Default)]
pub struct MapPlace {
    pub west_m: f64,
    pub south_m: f64,
    pub crs: Option<GeoKeys>,
}

impl MapPlace {
    pub fn new(layers: &GivenLayers) -> Self {
        Self { west_m: layers.west_m, south_m: layers.south_m, crs: layers.crs.clone() }
    }

    pub fn of_scenario(scenario: Option<&Scenario>) -> Self {
        scenario.and_then(Scenario::layers).map_or_else(Self::default, Self::new)
    }

    /// Returns values by cell index, NaN where there is none.
    pub fn raster(&self, frame: FieldFrame, values: &[f64]) -> Raster {
        #[expect(clippy::cast_possible_truncation, reason = "rasters hold single precision")]
        let value = |&value: &f64| if value.is_nan() { NODATA } else { value as f32 };
        Raster {
            rows: frame.rows.into(),
            cols: frame.cols.into(),
            west_m: self.west_m,
            south_m: self.south_m,
            cell_m: frame.cell_m,
            values: values.iter().map(value).collect(),
            nodata: Some(NODATA),
            crs: self.crs.clone(),
        }
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
        let rasters = bands.map(|(name, values)| (name, self.raster(frame, values)));
        write_geotiff_bands(path, &rasters.each_ref().map(|(name, raster)| (*name, raster)))
    }
}

/// Returns values by cell index with the north row first.
pub fn north_first(frame: FieldFrame, values: &[f64]) -> Grid<f64> {
    let rows = values.chunks_exact(frame.cols.into()).rev().flatten().copied();
    Grid::from_values(frame.rows.into(), frame.cols.into(), rows.collect())
}
