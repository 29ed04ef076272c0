//! Samples per hectare: settings that mean the same on fields of all sizes.

use wildfire_base::geometry::FieldFrame;
use wildfire_base::ranges::{OutOfRange, check_range};

pub const SQUARE_METRES_PER_HECTARE: f64 = 10_000.0;

/// The most samples that a field may come to have.
const MAX_SAMPLES: f64 = 10_000_000.0;

/// Returns the area of a field in hectares.
pub fn hectares(frame: &FieldFrame) -> f64 {
    frame.width_m() * frame.height_m() / SQUARE_METRES_PER_HECTARE
}

/// Returns the number of samples of a field at a density, in samples per hectare.
pub fn samples_on(frame: &FieldFrame, density: f64) -> u32 {
    (density * hectares(frame)).round() as u32
}

/// Checks the density of a scenario, if it sets one.
///
/// # Errors
/// Refuses densities that are out of range, or too high for a field of this size.
pub fn check_density(density: Option<f64>, frame: &FieldFrame) -> Result<(), OutOfRange> {
    const NAME: &str = "samples_per_hectare";
    let Some(density) = density else { return Ok(()) };
    check_range(NAME, density, 0.0..=100_000.0)?;
    if density * hectares(frame) <= MAX_SAMPLES {
        return Ok(());
    }
    let expected = format!("at most {MAX_SAMPLES:e} samples on the field, which has {:.0} hectares", hectares(frame));
    Err(OutOfRange::new(NAME, density, expected))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(cells: u16) -> FieldFrame {
        FieldFrame { cols: cells, rows: cells, cell_m: 5.0 }
    }

    #[test]
    fn a_density_gives_samples_in_proportion_to_the_area() {
        assert_eq!((samples_on(&square(50), 80.0), samples_on(&square(500), 80.0)), (500, 50_000));
        assert_eq!(samples_on(&square(50), 0.0), 0);
    }

    #[test]
    fn a_density_is_refused_where_it_means_too_many_samples() {
        assert_eq!(check_density(None, &square(2000)), Ok(()));
        assert_eq!(check_density(Some(1000.0), &square(2000)), Ok(()));
        let refusal = check_density(Some(1001.0), &square(2000)).expect_err("that is more than ten million");
        assert!(refusal.expected.contains("10000 hectares"), "{}", refusal.expected);
        assert!(check_density(Some(-1.0), &square(50)).is_err());
    }
}
