//! Wilcoxon's signed-rank test of paired differences (Wilcoxon, "Individual comparisons by ranking methods", Biometrics
//! Bulletin 1, 1945).
//!
//! Zeros are ranked with the others and then left out (Pratt, "Remarks on zeros and ties in the Wilcoxon signed rank
//! procedures", JASA 54, 1959), so that many pairs without a difference weaken the evidence; numbers of equal size
//! share the mean of their ranks. The test asks whether differences of either sign are equally likely at every rank.

use crate::stats::distributions::normal_two_sided;

/// Up to this many differences that are not zero, the p-value is exact, with ties and zeros as they are.
const EXACT_UP_TO: usize = 50;

/// Up to this sum of doubled ranks, too: among very many zeros ranks are high, and the sums of all choices would fill memory.
const EXACT_UP_TO_SUM: u64 = 1_000_000;

/// The rank sums of the differences above and below zero, and the test that they are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedRanks {
    pub above: f64,
    pub below: f64,
    /// The number of differences that are zero.
    pub zeros: usize,
    pub p_value: f64,
}

impl SignedRanks {
    /// Tests differences; `None` if all are zero.
    ///
    /// The p-value counts all choices of signs up to 50 differences among some 10,000 pairs; beyond, it is that of the normal
    /// distribution with the exact variance, which ties and zeros lessen, without a correction for continuity.
    pub fn from_differences(differences: &[f64]) -> Option<Self> {
        let ranked = ranked(differences);
        if ranked.is_empty() {
            return None;
        }
        let sum_where = |above: bool| ranked.iter().filter(|rank| rank.above == above).map(|rank| rank.doubled).sum();
        let (above, below): (u64, u64) = (sum_where(true), sum_where(false));
        let p_value = if ranked.len() <= EXACT_UP_TO && above + below <= EXACT_UP_TO_SUM {
            // Ranks are doubled, so that the mean ranks of ties are integers and the counting of sign choices is exact.
            exact_p_value(&ranked, above.min(below))
        } else {
            normal_p_value(&ranked, above, below)
        };
        let [above, below] = [above, below].map(|doubled| 0.5 * doubled as f64);
        Some(Self { above, below, zeros: differences.len() - ranked.len(), p_value })
    }

    /// Returns the matched-pairs rank-biserial correlation: 1 if every difference is above zero, -1 if every one is
    /// below.
    ///
    /// Kerby, "The simple difference formula", Comprehensive Psychology 3, 2014.
    pub fn rank_biserial(&self) -> f64 {
        (self.above - self.below) / (self.above + self.below)
    }
}

/// A difference that is not zero: its side, and its rank by size, doubled so that shared ranks are whole.
struct SignedRank {
    above: bool,
    doubled: u64,
}

fn ranked(differences: &[f64]) -> Vec<SignedRank> {
    let mut sorted = differences.to_vec();
    sorted.sort_unstable_by(|a, b| a.abs().total_cmp(&b.abs()));
    let mut ranks = Vec::with_capacity(sorted.len());
    let mut before = 0;
    for equal in sorted.chunk_by(|a, b| a.abs() == b.abs()) {
        let doubled = (2 * before + equal.len() + 1) as u64;
        let nonzero = equal.iter().filter(|&&difference| difference != 0.0);
        ranks.extend(nonzero.map(|&difference| SignedRank { above: difference > 0.0, doubled }));
        before += equal.len();
    }
    ranks
}

/// Returns twice the share of all choices of signs whose sum of ranks above zero is at most `smaller`.
fn exact_p_value(ranked: &[SignedRank], smaller: u64) -> f64 {
    let max: u64 = ranked.iter().map(|rank| rank.doubled).sum();
    let mut choices = vec![0_u64; max as usize + 1];
    choices[0] = 1;
    for rank in ranked {
        let step = rank.doubled as usize;
        // Downwards, or a rank would be added to sums that it is part of already.
        for sum in (step..choices.len()).rev() {
            choices[sum] += choices[sum - step];
        }
    }
    let at_most: u64 = choices[..=smaller as usize].iter().sum();
    // It fits, since `EXACT_UP_TO` is below 64.
    let all = 1_u64 << ranked.len();
    (2.0 * at_most as f64 / all as f64).min(1.0)
}

fn normal_p_value(ranked: &[SignedRank], above: u64, below: u64) -> f64 {
    // Each rank falls on either side like a coin: the difference of the sums has the variance of the squares.
    let variance: f64 = ranked.iter().map(|rank| rank.doubled as f64 * rank.doubled as f64).sum();
    normal_two_sided((above as f64 - below as f64) / variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::assert_close;

    const WILCOXON: [(u32, u32, f64); 10] = [
        (5, 101, 0.125),
        (8, 1009, 0.4609375),
        (12, 7, 0.12890625),
        (13, 5, 0.041015625),
        (40, 10007, 1.8189894035458565e-12),
        (50, 10007, 1.7763568394002505e-15),
        (60, 10007, 1.3042146411829483e-10),
        (80, 7, 7.877672907712382e-05),
        (300, 23, 4.334363858505244e-31),
        (1000, 11, 1.7368326561570998e-105),
    ];

    fn test(differences: &[f64]) -> SignedRanks {
        SignedRanks::from_differences(differences).expect("some differ from zero")
    }

    /// Without ties for `modulus` above `n`, with many and with zeros below.
    fn pattern(n: u32, modulus: u32) -> Vec<f64> {
        (1..=n).map(|i| f64::from(i * 37 % modulus) - 0.4 * f64::from(modulus / 2)).map(f64::floor).collect()
    }

    #[test]
    fn p_values_are_those_of_scipy() {
        // `scipy.stats.wilcoxon(d, zero_method="pratt", method=...)`: "exact" without ties or zeros, else
        // `PermutationMethod(n_resamples=numpy.inf)` up to 13 and "approx" above 50.
        for (n, modulus, p_value) in WILCOXON {
            assert_close(test(&pattern(n, modulus)).p_value, p_value);
        }
    }

    #[test]
    fn rank_sums_and_effect_by_hand() {
        // Sizes 0, 1, 1, 2, 5 have ranks 1, 2.5, 2.5, 4, 5.
        let found = test(&[1.0, 0.0, -1.0, 5.0, 2.0]);
        assert_eq!((found.above, found.below, found.zeros), (11.5, 2.5, 1));
        assert_close(found.rank_biserial(), 9.0 / 14.0);
        // Of 16 choices of signs, the sums 0, 2.5, 2.5 are at most 2.5.
        assert_close(found.p_value, 2.0 * 3.0 / 16.0);
    }

    #[test]
    fn very_many_zeros_cost_no_memory() {
        let differences: Vec<f64> = (0..3_000_000).map(|index| f64::from(u8::from(index < 40))).collect();
        let found = test(&differences);
        assert!(found.zeros == 2_999_960 && found.p_value < 1e-8, "{found:?}");
    }

    #[test]
    fn sides_can_be_exchanged() {
        for differences in [pattern(20, 101), pattern(200, 17)] {
            let mirrored: Vec<f64> = differences.iter().map(|difference| -difference).collect();
            let one = test(&differences);
            let other = test(&mirrored);
            assert_eq!((one.above, one.below, one.p_value), (other.below, other.above, other.p_value));
        }
    }

    #[test]
    fn five_alike_differences_are_no_proof() {
        let found = test(&[1.0; 5]);
        assert_eq!((found.p_value, found.rank_biserial()), (0.0625, 1.0));
        assert_eq!(SignedRanks::from_differences(&[0.0, -0.0]), None);
        assert_eq!(SignedRanks::from_differences(&[]), None);
    }
}
