//! Sums of runs for each cell.

use crate::maps::BatchQuantity;
use crate::stats::{Interval, PairedAnswers, Series, UNBOUNDED};
use wildfire_timeline::BurnMap;

/// The burned cells of a run, the bushes among them, and those of these that nobody extinguished.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunCounts {
    pub cells: f64,
    pub bushes: f64,
    pub lost: f64,
}

impl RunCounts {
    pub fn new(map: &BurnMap<'_>) -> Self {
        let [cells, bushes, lost] = [map.burned(), map.burned_bushes(), map.lost_bushes()].map(|count| count as f64);
        Self { cells, bushes, lost }
    }
}

/// The runs of one side.
#[derive(Clone)]
pub struct SideSums {
    /// By cell index: the runs that have a value, and the sum of their values.
    counts: Vec<u32>,
    sums: Vec<f64>,
    pub runs: Vec<RunCounts>,
}

impl SideSums {
    pub fn new(cells: usize) -> Self {
        Self { counts: vec![0; cells], sums: vec![0.0; cells], runs: Vec::new() }
    }

    pub fn add(&mut self, values: &[f64], run: RunCounts) {
        self.runs.push(run);
        for ((count, sum), value) in self.counts.iter_mut().zip(&mut self.sums).zip(values) {
            if value.is_finite() {
                *count += 1;
                *sum += value;
            }
        }
    }

    /// Returns the shares of runs or the means over those with a value; NaN where there is none.
    pub fn finish(self, quantity: BatchQuantity, can_burn: &[bool]) -> Vec<f64> {
        let cells = self.counts.iter().zip(&self.sums).zip(can_burn);
        let values = cells.map(|((&count, &sum), &can_burn)| match quantity {
            BatchQuantity::BurnProbability if can_burn => f64::from(count) / self.runs.len() as f64,
            BatchQuantity::MeanArrival | BatchQuantity::MeanIntensity | BatchQuantity::FlameClass(_) if count > 0 => {
                sum / f64::from(count)
            }
            _ => f64::NAN,
        });
        values.collect()
    }
}

/// Sums of pairs of runs by cell index.
pub enum PairSums {
    /// Whether the cell burned, first on the side that is subtracted.
    Burned(Vec<PairedAnswers>),
    /// Differences of values, where both runs have one.
    Differences(Vec<Series>),
}

impl PairSums {
    pub fn new(cells: usize, quantity: BatchQuantity) -> Self {
        match quantity {
            BatchQuantity::BurnProbability => Self::Burned(vec![PairedAnswers::default(); cells]),
            BatchQuantity::MeanArrival | BatchQuantity::MeanIntensity | BatchQuantity::FlameClass(_) => {
                Self::Differences(vec![Series::default(); cells])
            }
        }
    }

    /// Adds a pair: the values of the batch, and those of the batch that is subtracted.
    pub fn add(&mut self, values: &[f64], minus: &[f64]) {
        let values = values.iter().zip(minus);
        match self {
            Self::Burned(answers) => {
                for (answers, (value, minus)) in answers.iter_mut().zip(values) {
                    // An arrival time is finite exactly if the cell burned.
                    answers.add(minus.is_finite(), value.is_finite());
                }
            }
            Self::Differences(differences) => {
                for (series, (value, minus)) in differences.iter_mut().zip(values) {
                    // A difference of times needs both: a cell that burned once only has no time on the other side.
                    if value.is_finite() && minus.is_finite() {
                        series.add(value - minus);
                    }
                }
            }
        }
    }

    /// Returns means, lower and upper ends of their intervals; NaN where there is none.
    pub fn finish(self, can_burn: &[bool]) -> [Vec<f64>; 3] {
        let cells = can_burn.len();
        let mut maps = [(); 3].map(|()| vec![f64::NAN; cells]);
        let mut put = |index: usize, mean: Option<f64>, interval: Option<Interval>| {
            maps[0][index] = mean.unwrap_or(f64::NAN);
            maps[1][index] = interval.map_or(f64::NAN, |interval| interval.low);
            maps[2][index] = interval.map_or(f64::NAN, |interval| interval.high);
        };
        match self {
            Self::Burned(answers) => {
                // A cell that never can burn would have an interval about zero, as if it had been observed not to.
                for (index, answers) in answers.iter().enumerate().filter(|(index, _)| can_burn[*index]) {
                    put(index, answers.rate_difference(), answers.rate_difference_interval());
                }
            }
            Self::Differences(differences) => {
                for (index, series) in differences.iter().enumerate() {
                    put(index, series.mean(), series.mean_interval_within(UNBOUNDED));
                }
            }
        }
        maps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: f64 = f64::NAN;

    #[test]
    fn shares_and_means_count_the_runs_that_burned() {
        let mut sums = SideSums::new(4);
        let run = RunCounts { cells: 1.0, bushes: 0.0, lost: 0.0 };
        sums.add(&[10.0, NONE, NONE, NONE], run);
        sums.add(&[20.0, 40.0, NONE, NONE], run);
        let can_burn = [true, true, true, false];
        let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        let of = |quantity| bits(sums.clone().finish(quantity, &can_burn));
        assert_eq!(of(BatchQuantity::BurnProbability), bits(vec![1.0, 0.5, 0.0, NONE]));
        assert_eq!(of(BatchQuantity::MeanArrival), bits(vec![15.0, 40.0, NONE, NONE]));
    }

    #[test]
    fn differences_are_of_pairs() {
        let mut burned = PairSums::new(2, BatchQuantity::BurnProbability);
        let mut later = PairSums::new(2, BatchQuantity::MeanArrival);
        for sums in [&mut burned, &mut later] {
            sums.add(&[30.0, NONE], &[10.0, 5.0]);
            sums.add(&[50.0, NONE], &[20.0, NONE]);
        }
        let [mean, lower, upper] = burned.finish(&[true, true]);
        assert_eq!(mean, [0.0, -0.5]);
        assert!(lower[1] < -0.5 && upper[1] > -0.5 && lower[0] < 0.0 && upper[0] > 0.0);
        let [mean, lower, upper] = later.finish(&[true, true]);
        assert_eq!(mean[0], 25.0);
        assert!(mean[1].is_nan() && lower[1].is_nan());
        assert!(lower[0] < 25.0 && upper[0] > 25.0);
    }

    #[test]
    fn a_batch_less_itself_is_nothing_and_signs_turn_with_the_sides() {
        let runs = [[1.0, NONE, 7.0], [NONE, NONE, 9.0], [2.0, 3.0, 8.0], [NONE, 1.0, 1.0]];
        for quantity in [BatchQuantity::BurnProbability, BatchQuantity::MeanArrival] {
            let sums = |pairs: &[(usize, usize)]| {
                let mut sums = PairSums::new(3, quantity);
                pairs.iter().for_each(|&(first, second)| sums.add(&runs[first], &runs[second]));
                sums.finish(&[true; 3])
            };
            assert_eq!(sums(&[(0, 0), (1, 1), (2, 2), (3, 3)])[0], [0.0; 3]);
            let [mean, lower, upper] = sums(&[(0, 1), (2, 3), (1, 2)]);
            let [turned, low, high] = sums(&[(1, 0), (3, 2), (2, 1)]);
            let close = |a: f64, b: f64| (a + b).abs() < 1e-12 || (a.is_nan() && b.is_nan());
            assert!(mean.iter().zip(&turned).all(|(&a, &b)| close(a, b)));
            assert!(lower.iter().zip(&high).all(|(&a, &b)| close(a, b)));
            assert!(upper.iter().zip(&low).all(|(&a, &b)| close(a, b)));
        }
    }
}
