//! The search for the best word of a pair of poses.
//!
//! A word that cannot win costs no trigonometry. Two facts leave words out:
//! - Every pair of poses has a folded image under the symmetries ([`Chord::folded`]), and there only nine words are ever
//!   the shortest, one of each orbit of the symmetries: see [`WordPair::shortest`].
//! - The middle of a word, and the change of heading that is left for its outer arcs, are known before the angles of these
//!   arcs are, and bound the length from below: see [`View::outer_arcs`](crate::vehicle::curve::circles::View::outer_arcs).

use super::word::{Curve, Word, WordForm};
use crate::geometry::Pose;
use crate::vehicle::curve::chord::{Chord, Symmetry};
use crate::vehicle::curve::circles::{Circles, OuterArcs};

/// The price list of ways, in metres driven forward.
///
/// The cheapest curve can have another word than the shortest: where cusps or reversing are expensive, a longer way without them is cheaper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePrice {
    /// Cost of a metre in reverse; not negative.
    pub reverse_factor: f64,
    /// Cost of a change between forward and reverse; not negative.
    pub cusp_m: f64,
}

impl CurvePrice {
    /// The price that makes the shortest curve the cheapest.
    pub const LENGTH: Self = Self { reverse_factor: 1.0, cusp_m: 0.0 };

    /// Computes the cost of a curve.
    pub fn cost(&self, curve: &Curve) -> f64 {
        self.cost_of(curve.segments().map(|segment| segment.length_m))
    }

    /// Computes the cost of a curve that is driven from its end to its start.
    pub fn cost_back(&self, curve: &Curve) -> f64 {
        self.cost_of(curve.segments().map(|segment| -segment.length_m))
    }

    fn cost_of(&self, lengths_m: impl Iterator<Item = f64>) -> f64 {
        let mut cost = 0.0;
        let mut reverse = None;
        for length_m in lengths_m {
            let is_reverse = length_m < 0.0;
            if reverse.is_some_and(|before| before != is_reverse) {
                cost += self.cusp_m;
            }
            reverse = Some(is_reverse);
            cost += if is_reverse { -self.reverse_factor * length_m } else { length_m };
        }
        cost
    }

    /// The least that any metre costs.
    pub(super) fn min_factor(&self) -> f64 {
        self.reverse_factor.min(1.0)
    }
}

/// A curve and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PricedCurve {
    pub curve: Curve,
    pub price: f64,
}

/// Two poses, prepared for solving words.
pub(super) struct WordPair {
    circles: Circles,
    symmetry: Symmetry,
    radius_m: f64,
}

/// A word between the folded images of two poses, in turning radii.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    word: Word,
    middle: f64,
    outer: OuterArcs,
}

/// The shortest word so far, and the length that the next one has to beat.
struct Shortest {
    bound: f64,
    solved: Option<Solved>,
}

impl Solved {
    pub fn total(&self) -> f64 {
        self.outer.total
    }
}

impl WordPair {
    pub fn new(from: Pose, to: Pose, radius_m: f64) -> Self {
        let chord = Chord::between(from, to, radius_m);
        Self { circles: Circles::new(&chord.folded()), symmetry: chord.symmetry(), radius_m }
    }

    /// The shortest word, if it is shorter than `bound` turning radii.
    ///
    /// P. Souères, J.-P. Laumond, "Shortest paths synthesis for a car-like robot", IEEE Transactions on Automatic Control
    /// 41 (5), 1996, divide the plane around a goal of given heading among the words and use the same symmetries. That the
    /// nine words suffice is not proved here: the tests compare them with all 48.
    pub fn shortest(&self, bound: f64) -> Option<Solved> {
        let mut best = Shortest { bound, solved: None };
        // A call for each word, not a loop, lets the compiler decide all that depends on the word: this halves the time. The
        // words that most often win between far poses come first.
        self.improve(&mut best, Word::new(WordForm::LpSpRp, false, false));
        self.improve(&mut best, Word::new(WordForm::LpSpLp, false, false));
        self.improve(&mut best, Word::new(WordForm::LpRmSmLm, true, true));
        self.improve(&mut best, Word::new(WordForm::LpRmSmRm, true, true));
        self.improve(&mut best, Word::new(WordForm::LpRmSmLmRp, true, true));
        self.improve(&mut best, Word::new(WordForm::LpRmLp, false, false));
        self.improve(&mut best, Word::new(WordForm::LpRmLm, true, true));
        self.improve(&mut best, Word::new(WordForm::LpRmLmRp, true, true));
        self.improve(&mut best, Word::new(WordForm::LpRpLmRm, false, true));
        best.solved
    }

    #[inline(always)]
    fn improve(&self, best: &mut Shortest, word: Word) {
        if let Some(solved) = self.solve(word, best.bound)
            && solved.total() < best.bound
        {
            *best = Shortest { bound: solved.total(), solved: Some(solved) };
        }
    }

    /// The cheapest curve of the 48 words, if it is cheaper than `bound`.
    pub fn cheapest(&self, price: &CurvePrice, bound: f64) -> Option<PricedCurve> {
        let min_per_radius = price.min_factor() * self.radius_m;
        let shortest = self.shortest(bound / min_per_radius)?;
        let min = min_per_radius * shortest.total();
        let mut bound = bound;
        let mut best = self.cheaper_than(bound, &shortest, price);
        for word in Word::ALL {
            bound = best.map_or(bound, |curve| curve.price);
            let cusps = price.cusp_m * f64::from(word.cusps());
            // No word is shorter than the shortest, and from here on none has fewer cusps.
            if min + cusps >= bound {
                break;
            }
            if let Some(solved) = self.solve(word, (bound - cusps) / min_per_radius) {
                best = self.cheaper_than(bound, &solved, price).or(best);
            }
        }
        best
    }

    /// The cheapest curve of [`Word::LOOPS`], if there is one that is cheaper than `bound`.
    pub fn cheapest_loop(&self, price: &CurvePrice, bound: f64) -> Option<PricedCurve> {
        Word::LOOPS.into_iter().fold(None, |best: Option<PricedCurve>, word| {
            let bound = best.map_or(bound, |curve| curve.price);
            let solved = self.solve(word, f64::INFINITY);
            solved.and_then(|solved| self.cheaper_than(bound, &solved, price)).or(best)
        })
    }

    fn cheaper_than(&self, bound: f64, solved: &Solved, price: &CurvePrice) -> Option<PricedCurve> {
        let curve = self.curve(solved);
        let price = price.cost(&curve);
        (price < bound).then_some(PricedCurve { curve, price })
    }

    /// The curves of all words that exist.
    pub fn curves(&self) -> impl Iterator<Item = Curve> {
        Word::ALL.into_iter().filter_map(|word| self.solve(word, f64::INFINITY)).map(|solved| self.curve(&solved))
    }

    /// The word, if it exists and is shorter than `bound` turning radii.
    #[inline(always)]
    fn solve(&self, word: Word, bound: f64) -> Option<Solved> {
        let view = self.circles.view(word.form.ends(), word.reflected, word.flipped);
        let middle = word.form.middle(&view)?;
        let outer = view.outer_arcs(&middle, bound)?;
        Some(Solved { word, middle: middle.length, outer })
    }

    /// The curve between the poses themselves.
    pub fn curve(&self, solved: &Solved) -> Curve {
        let Solved { word, middle, outer } = solved;
        let mut lengths = word.form.lengths(*middle, outer);
        if self.symmetry.backwards {
            lengths[..word.form.len()].reverse();
        }
        Curve::new(word.under(self.symmetry), outer.total, lengths, self.radius_m)
    }
}
