//! Slopes and aspects: the gradient that they say, and whether the elevations of the same file contradict them.

use super::kind::{FLAT, LayerKind};
use wildfire_base::geometry::{compass, ops};
use wildfire_grid::map_files::raster::Band;
use wildfire_grid::map_files::raster::crs::FOOT_M;

/// Returns the rise over run to the east and to the north of a slope that faces an azimuth.
pub(super) fn gradient(slope_deg: f32, aspect_deg: f32) -> [f32; 2] {
    if aspect_deg == FLAT {
        return [0.0; 2];
    }
    let steepness = ops::tan(f64::from(slope_deg).to_radians());
    let uphill = compass::unit_from(aspect_deg.into()) * steepness;
    [uphill.x as f32, uphill.y as f32]
}

impl LayerKind {
    /// Says how slopes and aspects of a stack contradict its elevations, if they are those in another unit.
    pub(super) fn contradiction(self, bands: &[Band]) -> Option<String> {
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
                let apart = |angle: f64| ((f64::from(found) - angle + 540.0).rem_euclid(360.0) - 180.0).abs();
                count += 1.0;
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
        (count > 0.0 && turned < 15.0 * count && azimuth > 30.0 * count).then(|| {
            format!(
                "by the elevations of band {of_heights} the aspects of band {of_aspects} count from east against the clock, \
                 expected azimuths; the elevations can be used instead"
            )
        })
    }
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
