//! Repeated measures: the same subjects under several conditions.
//!
//! The analysis of variance of repeated measures: does the mean of the numbers depend on the condition? Subjects may be
//! as different from each other as they like, and numbers of one subject may go together; conditions may spread
//! differently. The price of the latter two is paid in degrees of freedom: both are multiplied by Box's epsilon,
//! estimated as Greenhouse and Geisser do ("On methods in the analysis of profile data", Psychometrika 24, 1959), which
//! is cautious where there are few subjects.
//!
//! With one number for each subject and condition that is a difference of two treatments, it is the test of an
//! interaction between treatment and condition. Welch's test for independent samples was not taken: it ignores that the
//! subjects are the same, and a condition in which nobody differs at all has an infinite weight in it.

use crate::stats::distributions::f_at_least;

/// Residuals that are mere rounding, as a share of the squares of all numbers.
const ROUNDING: f64 = 1e-28;

/// The test of equal means under all conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepeatedMeasures {
    /// Fisher's F; infinite where all subjects agree on the effects of the conditions.
    pub f: f64,
    /// The degrees of freedom of the conditions and of the residuals, both multiplied by epsilon.
    pub degrees: [f64; 2],
    /// The epsilon of Greenhouse and Geisser, from 1 / (conditions - 1) to 1.
    pub epsilon: f64,
    pub p_value: f64,
}

impl RepeatedMeasures {
    /// Tests rows, one per subject with its number under each condition, all of equal length.
    ///
    /// `None` for fewer than two subjects or conditions, or where neither conditions nor anything else make a
    /// difference within subjects. Takes time in proportion to the numbers times the lesser of subjects and conditions.
    pub fn from_rows(rows: &[Vec<f64>]) -> Option<Self> {
        let subjects = rows.len();
        let conditions = rows.first()?.len();
        if subjects < 2 || conditions < 2 {
            return None;
        }
        let of_conditions: Vec<f64> =
            (0..conditions).map(|condition| mean_of(rows.iter().map(|row| row[condition]), subjects)).collect();
        let of_all = mean_of(of_conditions.iter().copied(), conditions);
        let residuals = rows.iter().map(|row| {
            let of_subject = mean_of(row.iter().copied(), conditions);
            row.iter().zip(&of_conditions).map(|(number, mean)| number - mean - of_subject + of_all).collect()
        });
        let residuals: Vec<Vec<f64>> = residuals.collect();
        // The bound is relative to the numbers themselves, as residuals that are rounding grow with them.
        let rounding = ROUNDING * squares(rows.iter().flatten());
        let left = squares(residuals.iter().flatten());
        let effects: Vec<f64> = of_conditions.iter().map(|mean| mean - of_all).collect();
        let between = subjects as f64 * squares(effects.iter());
        let degrees = [(conditions - 1) as f64, ((conditions - 1) * (subjects - 1)) as f64];
        if left <= rounding {
            // The limit of ever smaller residuals.
            let certain = Self { f: f64::INFINITY, degrees, epsilon: 1.0, p_value: 0.0 };
            return (between > rounding).then_some(certain);
        }
        // tr(S)^2 over tr(S^2) does not change when the covariances S are multiplied by the degrees of freedom.
        // Rounding may bring it above 1, which is its largest value.
        let epsilon = (left * left / (degrees[0] * squares_of_products(&residuals))).min(1.0);
        let f = (between / degrees[0]) / (left / degrees[1]);
        let degrees = degrees.map(|degrees| epsilon * degrees);
        Some(Self { f, degrees, epsilon, p_value: f_at_least(f, degrees) })
    }
}

fn mean_of(numbers: impl Iterator<Item = f64>, count: usize) -> f64 {
    numbers.sum::<f64>() / count as f64
}

fn squares<'a>(numbers: impl Iterator<Item = &'a f64>) -> f64 {
    numbers.map(|number| number * number).sum()
}

/// Sums the squares of the products of all columns with each other, which are those of all rows with each other.
fn squares_of_products(rows: &[Vec<f64>]) -> f64 {
    let columns = rows[0].len();
    if rows.len() > columns {
        let transposed: Vec<Vec<f64>> =
            (0..columns).map(|column| rows.iter().map(|row| row[column]).collect()).collect();
        return squares_of_products(&transposed);
    }
    let sums = rows.iter().map(|one| {
        let with_all: Vec<f64> = rows.iter().map(|other| dot(one, other)).collect();
        squares(with_all.iter())
    });
    sums.sum()
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::assert_close;
    use rand::Rng;
    use wildfire_base::rng;

    fn rows<const N: usize>(numbers: &[[f64; N]]) -> Vec<Vec<f64>> {
        numbers.iter().map(|row| row.to_vec()).collect()
    }

    fn from_numbers(numbers: &[Vec<f64>]) -> RepeatedMeasures {
        RepeatedMeasures::from_rows(numbers).expect("the numbers differ")
    }

    /// Six subjects, whose numbers spread most under the second condition.
    fn uneven() -> Vec<Vec<f64>> {
        rows(&[[1.0, 5.0, 2.0], [0.0, 7.0, -1.0], [2.0, 9.0, 1.0], [1.5, 4.0, 3.0], [-1.0, 6.0, 0.5], [0.5, 11.0, 2.5]])
    }

    #[test]
    fn statistic_and_p_are_those_of_pingouin() {
        // `pingouin.rm_anova(..., correction=True)`: F, eps and p_GG_corr; the digits are those of the same sums in
        // NumPy and of `scipy.stats.f.sf`, which agree with it.
        let found = from_numbers(&uneven());
        assert_close(found.f, 22.827225130890056);
        assert_close(found.epsilon, 0.6457157017186754);
        assert_close(found.p_value, 0.0018904480477908057);
        let found = from_numbers(&rows(&[
            [1.0, 0.0, 2.0, 3.0],
            [2.0, 1.0, 0.0, 2.0],
            [4.0, 3.0, 5.0, 1.0],
            [0.0, 2.0, 1.0, 1.0],
            [3.0, 3.0, 2.0, 5.0],
        ]));
        assert_close(found.f, 0.17040358744394615);
        assert_close(found.epsilon, 0.6378211294522041);
        assert_close(found.p_value, 0.8378816813871796);
    }

    #[test]
    fn two_conditions_are_students_paired_test() {
        // `scipy.stats.ttest_rel(x[:, 0], x[:, 1])`
        let two: Vec<Vec<f64>> = uneven().into_iter().map(|row| row[..2].to_vec()).collect();
        let found = from_numbers(&two);
        assert_close(found.p_value, 0.002575161259595094);
        assert_close(found.f.sqrt(), 5.566607985435952);
        assert_close(found.epsilon, 1.0);
    }

    #[test]
    fn what_all_conditions_or_all_numbers_of_a_subject_share_does_not_matter() {
        let shifted: Vec<Vec<f64>> = uneven().into_iter().zip([100.0, -7.0, 0.0, 1e3, 5.0, 31.0]).map(add).collect();
        let found = from_numbers(&shifted);
        let expected = from_numbers(&uneven());
        assert!((found.p_value - expected.p_value).abs() < 1e-9, "{found:?} {expected:?}");
    }

    fn add((row, offset): (Vec<f64>, f64)) -> Vec<f64> {
        row.into_iter().map(|number| number + offset).collect()
    }

    #[test]
    fn conditions_without_any_spread_are_no_obstacle() {
        let rare = rows(&[[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]);
        assert!((0.1..1.0).contains(&from_numbers(&rare).p_value));
        let always = rows(&[[3.0, 53.0]; 4]);
        assert_eq!((from_numbers(&always).f, from_numbers(&always).p_value), (f64::INFINITY, 0.0));
    }

    #[test]
    fn without_subjects_conditions_or_differences_nothing_is_tested() {
        assert_eq!(RepeatedMeasures::from_rows(&[]), None);
        assert_eq!(RepeatedMeasures::from_rows(&rows(&[[1.0, 2.0]])), None);
        assert_eq!(RepeatedMeasures::from_rows(&rows(&[[1.0], [2.0]])), None);
        assert_eq!(RepeatedMeasures::from_rows(&rows(&[[0.1, 0.1, 0.1], [7.3, 7.3, 7.3]])), None);
    }

    #[test]
    fn false_alarms_are_as_rare_as_promised_where_spreads_differ() {
        // Of 1000 samples without a difference 50 should be called different; more than 75 would come up once in some
        // thousand trials. Conditions spread as 1, 3 and 10.
        let is_alarm = |trial: &u64| {
            let random = &mut rng::stream(*trial, "test/repeated-measures");
            let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            let numbers: Vec<Vec<f64>> =
                (0..12).map(|_| [1.0, 3.0, 10.0].map(|spread| spread * uniform()).to_vec()).collect();
            from_numbers(&numbers).p_value <= 0.05
        };
        let alarms = (0..1000).filter(is_alarm).count();
        assert!((20..=75).contains(&alarms), "{alarms} of 1000");
    }
}
