//! Proofs along a motion: what holds at a few places with a margin holds between them.

/// Intervals that wait to be looked at; more are proven at once.
const WAITING: usize = 8;

/// Returns whether a quantity that changes by at most `rate` per metre stays non-negative, up to a tolerance, from 0 to
/// `length_m`.
///
/// `excess` gives a lower bound of the quantity at a place, or `None` to refuse the motion. A place with
/// excess `e` proves all that is nearer than `(e + tolerance) / rate`: there the quantity is above `-tolerance`. What
/// is left on either side is treated alike. The middle comes first, because an obstacle is found soonest there. The
/// tolerance bounds the effort: no proof covers less than `2 * tolerance / rate`.
///
/// `excess` is also given the bound that proves all of the interval about the place: a higher one is not needed.
pub(super) fn holds_everywhere(
    length_m: f64,
    rate: f64,
    tolerance: f64,
    mut excess: impl FnMut(f64, f64) -> Option<f64>,
) -> bool {
    // Each proof covers some metres, so no number of them covers an endless motion.
    if !length_m.is_finite() {
        return false;
    }
    let mut waiting = [(0.0, length_m); WAITING];
    let mut first = 0;
    let mut count = 1;
    // Widest intervals first: what fails is found far sooner than by proving one end of the motion before the other is
    // looked at, and what holds is proven at the same places.
    while count > 0 {
        let (from, to) = waiting[first % WAITING];
        first += 1;
        count -= 1;
        let middle = 0.5 * (from + to);
        let Some(room) = excess(middle, rate * (middle - from)) else { return false };
        let proven = (room + tolerance) / rate;
        if middle - proven <= from {
            continue;
        }
        for part in [(from, middle - proven), (middle + proven, to)] {
            if count < WAITING {
                waiting[(first + count) % WAITING] = part;
                count += 1;
            } else if !interval_holds(part, rate, tolerance, &mut excess) {
                return false;
            }
        }
    }
    true
}

/// Returns whether it does so in an interval, by proving one end of it before the other is looked at.
fn interval_holds(
    (from, to): (f64, f64),
    rate: f64,
    tolerance: f64,
    excess: &mut impl FnMut(f64, f64) -> Option<f64>,
) -> bool {
    let middle = 0.5 * (from + to);
    let Some(room) = excess(middle, rate * (middle - from)) else { return false };
    let proven = (room + tolerance) / rate;
    middle - proven <= from
        || interval_holds((from, middle - proven), rate, tolerance, excess)
            && interval_holds((middle + proven, to), rate, tolerance, excess)
}

/// Returns how far from 0 the quantity of [`holds_everywhere`] is proven, at most `length_m`; 0 if it fails at 0.
pub(super) fn proven_prefix(
    length_m: f64,
    rate: f64,
    tolerance: f64,
    mut excess: impl FnMut(f64) -> Option<f64>,
) -> f64 {
    let mut place = 0.0;
    if !length_m.is_finite() {
        return place;
    }
    // Each proof covers as much of the way as its room allows at the fastest point's rate.
    while let Some(room) = excess(place) {
        let next = place + (room + tolerance) / rate;
        if next >= length_m {
            return length_m;
        }
        // Room below the numbers' resolution would go on forever.
        if next <= place {
            break;
        }
        place = next;
    }
    place
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    #[test]
    fn what_holds_is_proven_and_what_fails_beyond_the_tolerance_is_refused() {
        let mut rng = rng::stream(1, "collision/sweep");
        let (mut proven, mut refused) = (0, 0);
        for _ in 0..500 {
            // Distance to the nearest of some places, less a floor: it changes by at most 1 a metre.
            let marks: Vec<f64> = (0..4).map(|_| rng.random_range(-15.0..25.0)).collect();
            let excess = |at: f64| marks.iter().map(|mark| (at - mark).abs()).fold(f64::INFINITY, f64::min) - 1.0;
            let places = (0..=10_000).map(|k| f64::from(k) * 1e-3);
            let failure = places.clone().find(|&place| excess(place) < 0.0).unwrap_or(10.0);
            let min = places.map(excess).fold(f64::INFINITY, f64::min);
            let mut calls = 0;
            let answer = holds_everywhere(10.0, 1.0, 0.03, |place, _| {
                calls += 1;
                (excess(place) >= 0.0).then(|| excess(place))
            });
            // Knowing no more than is needed is enough.
            let same = holds_everywhere(10.0, 1.0, 0.03, |place, enough| {
                (excess(place) >= 0.0).then(|| excess(place).min(enough))
            });
            assert_eq!(answer, same, "{marks:?}");
            assert!(!answer || min >= -0.03, "{min} at {marks:?}");
            assert!(answer || min < 0.001, "{min} at {marks:?}");
            assert!(calls <= 2 * 10 * 17, "{calls} places for 10 m, though none proves less than 6 cm");
            let prefix = proven_prefix(10.0, 1.0, 0.03, |place| (excess(place) >= 0.0).then(|| excess(place)));
            assert!(prefix == 0.0 || prefix <= failure + 0.031, "{prefix} m, but it fails at {failure} m");
            assert!(prefix >= (failure - 0.002).max(0.0) || excess(0.0) < 0.0, "{prefix} m of {failure} m");
            if answer { proven += 1 } else { refused += 1 }
        }
        assert!(proven > 50 && refused > 50, "{proven} proven, {refused} refused");
    }
}
