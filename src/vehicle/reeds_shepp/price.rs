use super::Curve;

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
        let mut cost = 0.0;
        let mut reverse = None;
        for segment in curve.segments() {
            if reverse.is_some_and(|before| before != segment.is_reverse()) {
                cost += self.cusp_m;
            }
            reverse = Some(segment.is_reverse());
            cost += if segment.is_reverse() { -self.reverse_factor * segment.length_m } else { segment.length_m };
        }
        cost
    }

    /// The least that any metre costs.
    pub(super) fn least_factor(&self) -> f64 {
        self.reverse_factor.min(1.0)
    }
}

/// A curve and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PricedCurve {
    pub curve: Curve,
    pub price: f64,
}
