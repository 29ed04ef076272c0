//! Intervals of a mean that the library might have used instead.

use rand::Rng;
use statrs::distribution::{ContinuousCDF, Normal};
use wildfire::stats::{Interval, RESAMPLES, Series, quantile};

use crate::outcomes::below;

pub fn students_t(sample: &[f64]) -> Option<Interval> {
    Series::from_values(sample).mean_interval()
}

/// Percentile bootstrap and BCa (Efron, "Better bootstrap confidence intervals", JASA 82, 1987), of the same resamples.
pub fn percentile_and_bca(sample: &[f64], random: &mut impl Rng) -> [Option<Interval>; 2] {
    let mean = |numbers: &[f64]| numbers.iter().sum::<f64>() / numbers.len() as f64;
    let of_sample = mean(sample);
    let resample = |random: &mut _| (0..sample.len()).map(|_| sample[below(sample.len(), random)]).sum::<f64>();
    let mut means: Vec<f64> = (0..RESAMPLES).map(|_| resample(random) / sample.len() as f64).collect();
    means.sort_by(f64::total_cmp);
    let at = |shares: [f64; 2]| {
        let [low, high] = shares.map(|share| quantile(&means, share));
        Some(Interval { low: low?, high: high? })
    };
    let normal = Normal::standard();
    let less = means.iter().filter(|&&resampled| resampled < of_sample).count() as f64 / means.len() as f64;
    let bias = normal.inverse_cdf(less);
    let cubes: f64 = sample.iter().map(|x| (x - of_sample) * (x - of_sample) * (x - of_sample)).sum();
    let squares: f64 = sample.iter().map(|x| (x - of_sample) * (x - of_sample)).sum();
    let acceleration = cubes / (6.0 * squares * squares.sqrt());
    let corrected = [0.025, 0.975].map(|share| {
        let z = bias + normal.inverse_cdf(share);
        normal.cdf(bias + z / (1.0 - acceleration * z))
    });
    let is_number = corrected.iter().all(|share| share.is_finite());
    [at([0.025, 0.975]), if is_number { at(corrected) } else { None }]
}
