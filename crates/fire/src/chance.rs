//! Chance that does not depend on the order of events: drawn by a hash, never from a sequence.
//!
//! What happens at a cell follows from the run's seed, the purpose, the cell, its episode and a number (a direction, an
//! ember). So two fires of one seed share their luck in every cell that both come to, whatever else happens between.
//!
//! The rule is frozen, because runs are quoted by their seed: [`rng::key`] of seed and purpose is combined by exclusive or
//! with `row * 2^32 + col`; the SplitMix64 output of that with `episode * 2^32 + number`; and the output of this is the
//! draw. Its upper 53 bits are a number in [0, 1).

use wildfire_base::geometry::{Cell, ops};
use wildfire_base::rng;

/// Chance for one purpose in one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chance {
    key: u64,
}

impl Chance {
    pub fn new(seed: u64, purpose: &str) -> Self {
        Self { key: rng::key(seed, purpose) }
    }

    /// Draws 64 bits.
    pub fn bits(self, cell: Cell, episode: u32, number: u32) -> u64 {
        let place = u64::from(cell.row) << 32 | u64::from(cell.col);
        let which = u64::from(episode) << 32 | u64::from(number);
        rng::mixed(rng::mixed(self.key ^ place) ^ which)
    }

    /// Draws a number in [0, 1), all multiples of 2^-53 alike.
    pub fn uniform(self, cell: Cell, episode: u32, number: u32) -> f64 {
        (self.bits(cell, episode, number) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Coefficients of algorithm AS 241, PPND7, lowest power first: numerator and denominator near the middle, in the tails,
/// and far out.
const MIDDLE: [[f64; 4]; 2] = [
    [3.387_132_717_9, 50.434_271_938, 159.291_131_92, 59.109_374_720],
    [1.0, 17.895_169_469, 78.757_757_664, 67.187_563_600],
];
const TAIL: [[f64; 4]; 2] = [
    [1.423_437_277_7, 2.756_815_390_0, 1.306_728_481_6, 0.170_238_211_03],
    [1.0, 0.737_001_642_50, 0.120_211_329_75, 0.0],
];
const FAR_TAIL: [[f64; 4]; 2] = [
    [6.657_905_115_0, 3.081_226_386_0, 0.428_682_943_37, 0.017_337_203_997],
    [1.0, 0.241_978_942_25, 0.012_258_202_635, 0.0],
];

/// Returns the standard normal deviate below which this share of all lies, to seven digits (Wichura, "Algorithm AS 241: The
/// percentage points of the normal distribution", 1988). A share of 0 counts as the smallest draw that is not 0.
pub fn normal(share: f64) -> f64 {
    let share = share.max(1.0 / (1u64 << 54) as f64);
    let from_middle = share - 0.5;
    if from_middle.abs() <= 0.425 {
        return from_middle * ratio(MIDDLE, 0.180_625 - from_middle * from_middle);
    }
    let depth = (-ops::ln(share.min(1.0 - share))).sqrt();
    let deviate = if depth <= 5.0 { ratio(TAIL, depth - 1.6) } else { ratio(FAR_TAIL, depth - 5.0) };
    deviate.copysign(from_middle)
}

/// Returns the quotient of two polynomials of the third degree.
fn ratio([above, below]: [[f64; 4]; 2], x: f64) -> f64 {
    let [above, below] = [above, below].map(|[a, b, c, d]| a + x * (b + x * (c + x * d)));
    above / below
}

/// The largest mean of [`poisson`], far from where its first term would vanish.
pub const MAX_MEAN: f64 = 500.0;

/// Returns the count below or at which more than this share of a Poisson distribution lies, by adding up its terms from 0
/// on. Means above [`MAX_MEAN`] count as that.
pub fn poisson(mean: f64, share: f64) -> u32 {
    let mean = mean.clamp(0.0, MAX_MEAN);
    let mut term = ops::exp(-mean);
    let mut sum = term;
    let mut count = 0;
    // In the far tail the terms no longer change the sum, which may stay below a share next to 1.
    while sum <= share && (f64::from(count) <= mean || sum + term > sum) {
        count += 1;
        term *= mean / f64::from(count);
        sum += term;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Cell = Cell { col: 7, row: 31 };

    /// Reckoned by a separate program from the rule in the module's text.
    #[test]
    fn draws_are_pinned() {
        let spread = Chance::new(1, "spread");
        assert_eq!(
            [spread.bits(CELL, 1, 0), spread.bits(CELL, 1, 7), spread.bits(CELL, 2, 0)],
            [0x630f_3cd2_fd7d_4305, 0x9410_29a0_5dca_ff2c, 0xea34_4a15_95f1_3e04]
        );
        assert_eq!(
            Chance::new(42, "embers").bits(Cell { col: 65535, row: 0 }, u32::MAX, u32::MAX),
            0x80ca_d77c_1f32_0f03
        );
    }

    #[test]
    fn draws_differ_in_every_part_of_their_names() {
        let draw = |seed, purpose, col, row, episode, number| {
            Chance::new(seed, purpose).bits(Cell { col, row }, episode, number)
        };
        let draws = [
            draw(1, "spread", 2, 3, 4, 5),
            draw(2, "spread", 2, 3, 4, 5),
            draw(1, "embers", 2, 3, 4, 5),
            draw(1, "spread", 3, 2, 4, 5),
            draw(1, "spread", 2, 4, 4, 5),
            draw(1, "spread", 2, 3, 5, 4),
            draw(1, "spread", 2, 3, 4, 6),
        ];
        for (place, draw) in draws.iter().enumerate() {
            assert!(!draws[..place].contains(draw), "{place}");
        }
    }

    /// Draws of neighbouring cells, episodes and numbers.
    fn draws() -> Vec<f64> {
        let chance = Chance::new(5, "test");
        let cells = (0..20).flat_map(|row| (0..20).map(move |col| Cell { col, row }));
        let which =
            cells.flat_map(|cell| (0..5).flat_map(move |episode| (0..10).map(move |number| (cell, episode, number))));
        which.map(|(cell, episode, number)| chance.uniform(cell, episode, number)).collect()
    }

    #[test]
    fn draws_are_even_and_unrelated() {
        let draws = draws();
        let count = draws.len() as f64;
        let mut tenths = [0.0; 10];
        for &draw in &draws {
            assert!((0.0..1.0).contains(&draw));
            tenths[(draw * 10.0) as usize] += 1.0;
        }
        let expected = count / 10.0;
        let chi_squared: f64 = tenths.iter().map(|found| (found - expected) * (found - expected) / expected).sum();
        assert!(chi_squared < 27.9, "p below 0.001: {chi_squared}");
        for lag in [1, 10, 50, 1000] {
            let products = draws.iter().zip(&draws[lag..]).map(|(a, b)| (a - 0.5) * (b - 0.5) * 12.0);
            let correlation = products.sum::<f64>() / count;
            assert!(correlation.abs() < 4.0 / count.sqrt(), "lag {lag}: {correlation}");
        }
    }

    #[test]
    fn deviates_are_those_of_the_normal_distribution() {
        for (share, deviate) in [
            (0.5, 0.0),
            (0.8413447460685429, 1.0),
            (0.9772498680518208, 2.0),
            (0.0013498980316300957, -3.0),
            (2.866515718791946e-07, -5.0),
            (1e-10, -6.361340902404056),
            (1e-15, -7.941345326170995),
        ] {
            assert!((normal(share) - deviate).abs() <= 2e-7 * deviate.abs().max(1.0), "{share}: {}", normal(share));
            let mirrored = normal(1.0 - share);
            assert!((mirrored + deviate).abs() < 1e-6 || share < 1e-9, "{share}");
        }
        assert!(normal(0.0) < -8.2 && normal(1.0 - f64::EPSILON / 2.0) > 8.1);
        let ascending: Vec<f64> = (0..=1000).map(|share| normal(f64::from(share) / 1000.0 * 0.999)).collect();
        assert!(ascending.is_sorted());
    }

    #[test]
    fn counts_are_those_of_the_poisson_distribution() {
        for mean in [0.0, 0.3, 4.0, 30.0, 450.0] {
            let counts: Vec<f64> = draws().into_iter().map(|draw| f64::from(poisson(mean, draw))).collect();
            let count = counts.len() as f64;
            let found = counts.iter().sum::<f64>() / count;
            let variance = counts.iter().map(|&one| (one - found) * (one - found)).sum::<f64>() / count;
            assert!((found - mean).abs() <= 4.0 * (mean / count).sqrt(), "{mean}: {found}");
            assert!((variance - mean).abs() <= 0.05 * mean, "{mean}: variance {variance}");
        }
        // Of mean 2, 13.53 % are none and 27.07 % one.
        assert_eq!([0.135, 0.136, 0.405, 0.407].map(|share| poisson(2.0, share)), [0, 1, 1, 2]);
        let max = poisson(1e9, 1.0 - f64::EPSILON / 2.0);
        assert!((500..800).contains(&max), "{max}");
    }
}
