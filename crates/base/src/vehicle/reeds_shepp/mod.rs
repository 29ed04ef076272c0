//! Reeds-Shepp curves: the shortest ways of a vehicle with a smallest turning radius that drives forward and in reverse.
//!
//! Of all ways between two poses that never turn more sharply than the radius allows, one of 48 words is the shortest
//! (J. A. Reeds, L. A. Shepp, "Optimal paths for a car that goes both forwards and backwards", Pacific Journal of
//! Mathematics 145 (2), 1990). [`ReedsShepp`] solves them for a pair of poses: `middle` holds the formulas, `word` the
//! words, and `search` leaves out what cannot win.

mod middle;
mod search;
mod word;

pub use search::{CurvePrice, PricedCurve};
pub use word::{Curve, Family, Word};

use self::search::WordPair;
use crate::geometry::{Pose, ops};

/// The curves of a vehicle with this turning radius. Poses are finite and those of the rear axle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReedsShepp {
    /// Metres, positive.
    pub radius_m: f64,
}

impl ReedsShepp {
    /// Length of the shortest curve. The way back is as long, bit for bit.
    pub fn length_m(&self, from: Pose, to: Pose) -> f64 {
        self.length_below(from, to, f64::INFINITY).unwrap_or(f64::INFINITY)
    }

    /// Length of the shortest curve, if that is less than `bound_m`.
    pub fn length_below(&self, from: Pose, to: Pose, bound_m: f64) -> Option<f64> {
        if self.min_length_m(from, to) >= bound_m {
            return None;
        }
        let solved = WordPair::new(from, to, self.radius_m).shortest(bound_m / self.radius_m)?;
        Some(solved.total() * self.radius_m)
    }

    /// The shortest curve.
    ///
    /// # Panics
    /// When a number of the poses is not finite, or too large to be squared.
    pub fn shortest(&self, from: Pose, to: Pose) -> Curve {
        let pair = WordPair::new(from, to, self.radius_m);
        let solved = pair.shortest(f64::INFINITY).expect("L+S+L+ leads anywhere");
        pair.curve(&solved)
    }

    /// The curve of the lowest price, of all words and not only of the shortest: no dearer than the shortest curve of
    /// Dubins, nor than one back from the goal driven in reverse.
    ///
    /// # Panics
    /// When a number of the poses is not finite, or too large to be squared.
    pub fn cheapest(&self, from: Pose, to: Pose, price: &CurvePrice) -> PricedCurve {
        self.cheapest_below(from, to, price, f64::INFINITY).expect("L+S+L+ leads anywhere")
    }

    /// The curve of the lowest price, if that is less than `bound`.
    pub fn cheapest_below(&self, from: Pose, to: Pose, price: &CurvePrice, bound: f64) -> Option<PricedCurve> {
        if price.min_factor() * self.min_length_m(from, to) >= bound {
            return None;
        }
        let pair = WordPair::new(from, to, self.radius_m);
        let best = pair.cheapest(price, bound);
        pair.cheapest_loop(price, best.map_or(bound, |curve| curve.price)).or(best)
    }

    /// The curve of the lowest price among the 48 words, without [`Word::LOOPS`].
    ///
    /// # Panics
    /// When a number of the poses is not finite, or too large to be squared.
    pub fn cheapest_word(&self, from: Pose, to: Pose, price: &CurvePrice) -> PricedCurve {
        self.cheapest_word_below(from, to, price, f64::INFINITY).expect("L+S+L+ leads anywhere")
    }

    /// The curve of [`Self::cheapest_word`], if its price is less than `bound`.
    pub fn cheapest_word_below(&self, from: Pose, to: Pose, price: &CurvePrice, bound: f64) -> Option<PricedCurve> {
        if price.min_factor() * self.min_length_m(from, to) >= bound {
            return None;
        }
        WordPair::new(from, to, self.radius_m).cheapest(price, bound)
    }

    /// Replaces what `curves` holds by the curves of the 48 words that exist, the cheapest first; of equals, the word that comes
    /// first in [`Word::ALL`].
    ///
    /// Nothing is allocated when `curves` has room for all the words.
    pub fn candidates(&self, from: Pose, to: Pose, price: &CurvePrice, curves: &mut Vec<PricedCurve>) {
        curves.clear();
        let pair = WordPair::new(from, to, self.radius_m);
        curves.extend(pair.curves().map(|curve| PricedCurve { curve, price: price.cost(&curve) }));
        curves.sort_unstable_by(|a, b| {
            a.price.total_cmp(&b.price).then_with(|| a.curve.word.rank().cmp(&b.curve.word.rank()))
        });
    }

    /// A curve is no shorter than the straight line, and over a turning radius of it the heading changes by at most a radian.
    fn min_length_m(&self, from: Pose, to: Pose) -> f64 {
        let straight = from.position().distance(to.position());
        straight.max(self.radius_m * ops::wrap_angle(to.heading - from.heading).abs())
    }
}
