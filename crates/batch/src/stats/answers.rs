//! Yes/no answers: their rate, and the difference of the rates of paired answers.

use crate::stats::distributions::{binomial_at_most, normal_reach};
use crate::stats::{Interval, Series};

/// The numbers of pairs by the answers, yes or no, of the first and the second member.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PairedAnswers {
    pub both: u64,
    pub only_first: u64,
    pub only_second: u64,
    pub neither: u64,
}

impl PairedAnswers {
    pub fn add(&mut self, first: bool, second: bool) {
        *match (first, second) {
            (true, true) => &mut self.both,
            (true, false) => &mut self.only_first,
            (false, true) => &mut self.only_second,
            (false, false) => &mut self.neither,
        } += 1;
    }

    pub fn pairs(&self) -> u64 {
        self.both + self.only_first + self.only_second + self.neither
    }

    /// Returns the number of pairs whose first is yes.
    pub fn first_yes(&self) -> u64 {
        self.both + self.only_first
    }

    /// Returns the number of pairs whose second is yes.
    pub fn second_yes(&self) -> u64 {
        self.both + self.only_second
    }

    /// Returns the rate of the second minus the rate of the first; `None` without pairs.
    pub fn rate_difference(&self) -> Option<f64> {
        let difference = self.only_second as f64 - self.only_first as f64;
        (self.pairs() > 0).then(|| difference / self.pairs() as f64)
    }

    /// Returns the interval of the difference of the rates, within -1 to 1; `None` without pairs.
    ///
    /// Bonett, Price, "Adjusted Wald confidence interval for a difference of binomial proportions based on paired
    /// data", Journal of Educational and Behavioral Statistics 37, 2012: one pair more in either cell that differs.
    pub fn rate_difference_interval(&self) -> Option<Interval> {
        if self.pairs() == 0 {
            return None;
        }
        let pairs = (self.pairs() + 2) as f64;
        let [first, second] = [self.only_first, self.only_second].map(|count| (count + 1) as f64 / pairs);
        let difference = second - first;
        let error = ((first + second - difference * difference) / pairs).sqrt();
        let Interval { low, high } = Interval::about(difference, normal_reach() * error);
        Some(Interval { low: low.max(-1.0), high: high.min(1.0) })
    }

    /// Returns the p-value of McNemar's exact test that discordant pairs fall either way with equal probability; 1 if
    /// no pair is discordant.
    ///
    /// McNemar, "Note on the sampling error of the difference between correlated proportions or percentages",
    /// Psychometrika 12, 1947, with the binomial distribution in place of its approximation.
    pub fn mcnemar_p_value(&self) -> f64 {
        let rarer = self.only_first.min(self.only_second);
        (2.0 * binomial_at_most(rarer, self.only_first + self.only_second, 0.5)).min(1.0)
    }
}

/// Returns the interval of the mean of differences of rates, each of a subject with this number of answers, within -1
/// to 1; `None` without differences.
///
/// That of Bonett and Price, with one answer more that differs either way as a subject of its own: for subjects that were
/// asked once it is [`PairedAnswers::rate_difference_interval`].
pub fn mean_rate_difference_interval(differences: &[f64], times: usize) -> Option<Interval> {
    differences.first()?;
    let one = 1.0 / times as f64;
    let adjusted = Series::from_values(&[differences, &[one, -one]].concat());
    let n = adjusted.count() as f64;
    let error = adjusted.standard_error()? * ((n - 1.0) / n).sqrt();
    let Interval { low, high } = Interval::about(adjusted.mean()?, normal_reach() * error);
    Some(Interval { low: low.max(-1.0), high: high.min(1.0) })
}

/// Returns the interval of the rate of `hits` in `trials`, within 0 to 1; `None` without trials.
///
/// Wilson, "Probable inference, the law of succession, and statistical inference", JASA 22, 1927: all rates that the
/// normal test with their own standard error does not refuse.
pub fn wilson_interval(hits: u64, trials: u64) -> Option<Interval> {
    if trials == 0 {
        return None;
    }
    let n = trials as f64;
    let rate = hits as f64 / trials as f64;
    let z = normal_reach();
    let weight = z * z / n;
    let centre = (rate + 0.5 * weight) / (1.0 + weight);
    let half_width = z * (rate * (1.0 - rate) / n + 0.25 * weight / n).sqrt() / (1.0 + weight);
    // At the ends the bounds are exact, where rounding could leave the range.
    let low = if hits == 0 { 0.0 } else { centre - half_width };
    let high = if hits == trials { 1.0 } else { centre + half_width };
    Some(Interval { low, high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::{assert_close, assert_interval};

    const MCNEMAR: [(u64, u64, f64); 6] = [
        (0, 5, 0.0625),
        (3, 10, 0.09228515625),
        (10, 3, 0.09228515625),
        (7, 7, 1.0),
        (120, 90, 0.045114087864840696),
        (5200, 4800, 6.593515598672343e-05),
    ];

    fn answers(only_first: u64, only_second: u64, pairs: u64) -> PairedAnswers {
        PairedAnswers { both: 0, only_first, only_second, neither: pairs - only_first - only_second }
    }

    #[test]
    fn p_values_are_those_of_scipy() {
        // `scipy.stats.binomtest(b, b + c).pvalue`
        for (only_first, only_second, expected) in MCNEMAR {
            assert_close(answers(only_first, only_second, 100_000).mcnemar_p_value(), expected);
        }
        assert_eq!(answers(0, 0, 10).mcnemar_p_value(), 1.0);
    }

    #[test]
    fn interval_is_that_of_the_formula() {
        // In Python: p, q = 4 / 42, 11 / 42; q - p -+ norm.ppf(0.975) * sqrt((p + q - (q - p) ** 2) / 42)
        assert_interval(answers(3, 10, 40).rate_difference_interval(), -0.0068983608998942625, 0.34023169423322763);
        assert_eq!(answers(3, 10, 40).rate_difference(), Some(0.175));
        let single = [vec![-1.0; 3], vec![1.0; 10], vec![0.0; 27]].concat();
        assert_interval(mean_rate_difference_interval(&single, 1), -0.0068983608998942625, 0.34023169423322763);
        let several = mean_rate_difference_interval(&[1.0, 1.0, 0.5], 4).expect("there are three");
        assert!(0.0 < several.low && several.contains(2.5 / 3.0) && several.high < 1.0, "{several:?}");
        assert_eq!(mean_rate_difference_interval(&[], 2), None);
    }

    #[test]
    fn answers_are_counted_in_their_cell() {
        let mut answers = PairedAnswers::default();
        [(true, true), (true, false), (true, false), (false, true), (false, false)]
            .iter()
            .for_each(|&(first, second)| answers.add(first, second));
        assert_eq!(answers, PairedAnswers { both: 1, only_first: 2, only_second: 1, neither: 1 });
        assert_eq!((answers.pairs(), answers.first_yes(), answers.second_yes()), (5, 3, 2));
    }

    #[test]
    fn no_pairs_tell_nothing() {
        let none = PairedAnswers::default();
        assert_eq!((none.rate_difference(), none.rate_difference_interval()), (None, None));
        let few = answers(0, 2, 2).rate_difference_interval().expect("there are pairs");
        assert!(few.high <= 1.0 && few.low < 0.0, "{few:?}");
    }

    const WILSON: [(u64, u64, f64, f64); 7] = [
        (0, 30, 0.0, 0.11351339317396875),
        (1, 30, 0.005908590381612441, 0.16670390991409173),
        (15, 30, 0.3315412564053377, 0.6684587435946623),
        (30, 30, 0.8864866068260312, 1.0),
        (3, 5, 0.23072428127601297, 0.8823792257673521),
        (187, 200, 0.891980920700931, 0.9616236453508471),
        (1, 100000, 1.765247730378316e-06, 5.664709659040965e-05),
    ];

    #[test]
    fn intervals_of_rates_are_those_of_scipy() {
        // `scipy.stats.binomtest(k, n).proportion_ci(method="wilson")`
        for (hits, trials, low, high) in WILSON {
            assert_interval(wilson_interval(hits, trials), low, high);
        }
    }

    #[test]
    fn rate_of_nothing_has_no_interval() {
        assert_eq!(wilson_interval(0, 0), None);
    }
}
