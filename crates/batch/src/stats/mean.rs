//! Estimates of a mean with their uncertainty.

use rand::Rng;

use crate::stats::bootstrap::studentised_bootstrap;
use crate::stats::distributions::t_two_sided;
use crate::stats::{MeanEstimate, MeanMethod, Series};

/// Sample sizes for which resampling is worth its while. See [`estimate_mean`].
const RESAMPLED: std::ops::RangeInclusive<usize> = 10..=5000;

/// Estimates the mean of a sample; `None` for an empty one.
///
/// By the studentised bootstrap from 10 to 5000 numbers, and else, or where the numbers are too few or too much alike
/// for it, by Student's t. Below 10 a resample is too often nearly constant and the bootstrap's intervals are several
/// times as wide as needed; above 5000 the two differ by less than the bootstrap's own noise.
pub fn estimate_mean(values: &[f64], random: &mut impl Rng) -> Option<MeanEstimate> {
    // The bootstrap gives up on samples that are nearly constant; Student's t still has an answer for those.
    let resampled = if RESAMPLED.contains(&values.len()) { studentised_bootstrap(values, random) } else { None };
    resampled.or_else(|| students_t(values))
}

/// Estimates the mean of a sample by Student's t, whatever its size; `None` for an empty one.
pub fn students_t(values: &[f64]) -> Option<MeanEstimate> {
    let series = Series::from_values(values);
    let mean = series.mean()?;
    // Of numbers as large as 1e200 the spread is beyond all numbers.
    let error = series.standard_error().filter(|&error| error > 0.0 && error.is_finite());
    Some(MeanEstimate {
        mean,
        interval: error.and_then(|_| series.mean_interval()),
        p_value: error.map(|error| t_two_sided(mean / error, (values.len() - 1) as f64)),
        method: MeanMethod::StudentsT,
        p_method: MeanMethod::StudentsT,
    })
}

/// Returns Cohen's d of paired differences: their mean divided by their standard deviation. `None` without spread.
///
/// Cohen, "Statistical power analysis for the behavioral sciences", 1988, section 2.3.5, where it is d'z.
pub fn cohens_dz(differences: &[f64]) -> Option<f64> {
    let series = Series::from_values(differences);
    let deviation = series.standard_deviation().filter(|&deviation| deviation > 0.0)?;
    Some(series.mean()? / deviation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::{assert_close, assert_interval};
    use wildfire_base::rng;

    const FEW: [f64; 5] = [3.0, -1.5, 4.0, 2.5, 0.5];

    fn estimate(values: &[f64]) -> MeanEstimate {
        estimate_mean(values, &mut rng::stream(1, "bootstrap/test")).expect("there are values")
    }

    #[test]
    fn few_numbers_have_the_interval_and_test_of_scipy() {
        // `scipy.stats.ttest_1samp(x, 0)`, its `confidence_interval()` and `pvalue`
        let found = estimate(&FEW);
        assert_interval(found.interval, -1.027424565849732, 4.427424565849732);
        assert_close(found.p_value.expect("they differ"), 0.15857969657658086);
        assert_eq!(found.method, MeanMethod::StudentsT);
        // `numpy.mean(x) / numpy.std(x, ddof=1)`
        assert_close(cohens_dz(&FEW).expect("they differ"), 0.7739274711301751);
    }

    #[test]
    fn number_of_values_and_their_spread_choose_the_method() {
        let values = |n: u32| (0..n).map(|i| f64::from(i * 7919 % 101)).collect::<Vec<_>>();
        for (n, method) in [
            (2, MeanMethod::StudentsT),
            (9, MeanMethod::StudentsT),
            (10, MeanMethod::StudentisedBootstrap),
            (5001, MeanMethod::StudentsT),
        ] {
            assert_eq!(estimate(&values(n)).method, method, "{n}");
        }
        let mut rare = vec![0.0; 50];
        rare[0] = 1.0;
        assert_eq!(estimate(&rare).method, MeanMethod::StudentsT);
    }

    #[test]
    fn numbers_without_spread_have_a_mean_and_nothing_else() {
        let method = MeanMethod::StudentsT;
        let expected = MeanEstimate { mean: 2.0, interval: None, p_value: None, method, p_method: method };
        assert_eq!(estimate(&[2.0]), expected);
        assert_eq!(estimate(&[2.0; 20]), expected);
        assert_eq!(cohens_dz(&[2.0; 20]), None);
        assert_eq!(estimate_mean(&[], &mut rng::stream(1, "bootstrap/test")), None);
    }

    #[test]
    fn interval_of_skewed_numbers_holds_their_mean_about_as_often_as_it_says() {
        // Squares of uniform numbers have the mean 1/3. Of 300 samples, 95 % are 285; fewer than 270 or more than 297
        // would come up once in some thousand trials.
        let holds = |trial: &u64| {
            let random = &mut rng::stream(*trial, "test/coverage");
            let uniform =
                |random: &mut rng::Xoshiro256PlusPlus| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
            let sample: Vec<f64> = (0..30).map(|_| uniform(random)).map(|number| number * number).collect();
            let estimate = estimate_mean(&sample, random).expect("there are values");
            estimate.interval.expect("they differ").contains(1.0 / 3.0)
        };
        let covered = (0..300).filter(holds).count();
        assert!((270..=297).contains(&covered), "{covered} of 300");
    }

    #[test]
    fn both_methods_agree_on_many_ordinary_numbers() {
        let values: Vec<f64> = (0..2000_u32).map(|i| f64::from(i * 7919 % 2003)).collect();
        let [resampled, classical] =
            [estimate(&values), students_t(&values).expect("there are values")].map(|found| found.interval);
        let resampled = resampled.expect("they differ");
        let classical = classical.expect("they differ");
        let width = classical.high - classical.low;
        assert!((resampled.low - classical.low).abs() < 0.05 * width);
        assert!((resampled.high - classical.high).abs() < 0.05 * width);
    }
}
