//! Dubins and Reeds-Shepp curves: where they lead, how short they are, and that nothing is shorter.

use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

use rand::RngExt;
use wildfire::geometry::{Pose, ops};
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::vehicle::curve::{Curve, Gear, Letter, Letters, Steering};
use wildfire::vehicle::reeds_shepp::{PricedCurve, Word};
use wildfire::vehicle::{self, CurvePrice, Dubins, ReedsShepp, Segment};

use crate::answers::{both, larger};

const RADIUS_M: f64 = 13.0;
const REEDS_SHEPP: ReedsShepp = ReedsShepp { radius_m: RADIUS_M };
const DUBINS: Dubins = Dubins { radius_m: RADIUS_M };
/// Pairs of poses for a law: enough to see every word win, few enough for a build without optimisation.
const PAIRS: usize = if cfg!(debug_assertions) { 5_000 } else { 100_000 };

fn pose(x: f64, y: f64, heading: f64) -> Pose {
    Pose { x, y, heading }
}

const ORIGIN: Pose = Pose { x: 0.0, y: 0.0, heading: 0.0 };

fn random_pose(rng: &mut Xoshiro256PlusPlus, field_m: f64) -> Pose {
    let mut coordinate = || rng.random_range(0.0..field_m);
    let (x, y) = (coordinate(), coordinate());
    pose(x, y, rng.random_range(-PI..PI))
}

/// Pairs as near as a shuffle and as far as a field is wide.
fn random_pairs(name: &str) -> Vec<(Pose, Pose)> {
    let mut rng = rng::stream(1, name);
    let fields_m = [3.0, 10.0, 30.0, 60.0, 250.0];
    let mut pair = |index: usize| {
        let field_m = fields_m[index % fields_m.len()];
        (random_pose(&mut rng, field_m), random_pose(&mut rng, field_m))
    };
    (0..PAIRS).map(&mut pair).collect()
}

fn assert_same_pose(found: Pose, expected: Pose, tolerance: f64, what: &dyn std::fmt::Display) {
    let apart_m = found.position().distance(expected.position());
    let turned = ops::wrap_angle(found.heading - expected.heading).abs();
    assert!(apart_m < tolerance && turned < tolerance, "{what} ends {apart_m} m and {turned} rad beside {expected:?}");
}

fn candidates(from: Pose, to: Pose, price: &CurvePrice) -> Vec<PricedCurve> {
    let mut curves = Vec::with_capacity(Word::ALL.len());
    REEDS_SHEPP.candidates(from, to, price, &mut curves);
    curves
}

/// A row of a reference file: the poses, and the lengths after Reeds and Shepp and after Dubins.
struct Reference {
    from: Pose,
    to: Pose,
    reeds_shepp_m: f64,
    dubins_m: f64,
}

fn reference(file: &Path) -> Vec<Reference> {
    let mut reader = csv::Reader::from_path(file).expect("it can be read");
    let header = reader.headers().expect("a header").clone();
    let column = |name: &str| header.iter().position(|found| found == name).expect("the column is there");
    let (reeds_shepp, dubins) = (column("rs_len_ompl_2_0_1"), column("dubins_len_ompl_2_0_1"));
    let read_row = |row: csv::Result<csv::StringRecord>| {
        let row = row.expect("a row");
        let number = |column: usize| row[column].parse::<f64>().expect("a number");
        Reference {
            from: pose(number(0), number(1), number(2)),
            to: pose(number(3), number(4), number(5)),
            reeds_shepp_m: number(reeds_shepp),
            dubins_m: number(dubins),
        }
    };
    reader.into_records().map(read_row).collect()
}

#[test]
fn lengths_equal_those_of_independent_programs() {
    for file in both("reeds_shepp.csv").chain(larger("reeds_shepp_edge.csv")) {
        let rows = reference(&file);
        assert!(rows.len() >= 20, "{} has {} rows", file.display(), rows.len());
        for Reference { from, to, reeds_shepp_m, dubins_m } in rows {
            let found = [REEDS_SHEPP.length_m(from, to), DUBINS.length_m(from, to)];
            let expected = [reeds_shepp_m, dubins_m];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{from:?} to {to:?}: {found}, the reference has {expected}");
            }
        }
    }
}

/// Poses that a ruler and a pair of compasses can check, from a start in the origin that looks east.
#[test]
fn simple_ways_are_as_long_as_geometry_says() {
    let quarter = FRAC_PI_2 * RADIUS_M;
    let cases = [
        (ORIGIN, 0.0, "", ""),
        (pose(10.0, 0.0, 0.0), 10.0, "S+", "S+"),
        (pose(-10.0, 0.0, 0.0), 10.0, "S-", "L+S+L+"),
        (pose(13.0, 13.0, FRAC_PI_2), quarter, "L+", "L+"),
        (pose(13.0, -13.0, -FRAC_PI_2), quarter, "R+", "R+"),
        (pose(-13.0, 13.0, -FRAC_PI_2), quarter, "L-", "L+"),
        (pose(-13.0, -13.0, FRAC_PI_2), quarter, "R-", "R+"),
        (pose(0.0, 26.0, PI), 2.0 * quarter, "L+", "L+"),
        (pose(23.0, 13.0, FRAC_PI_2), quarter + 10.0, "S+L+", "S+L+"),
        (pose(13.0, 23.0, FRAC_PI_2), quarter + 10.0, "L+S+", "L+S+"),
        (pose(26.0, 36.0, 0.0), 2.0 * quarter + 10.0, "L+S+R+", "L+S+R+"),
        (pose(26.0, 26.0, 0.0), 2.0 * quarter, "L+R+", "L+R+"),
        // Turning by half a turn on the spot is a triangle of three arcs of a sixth of a circle.
        (pose(0.0, 0.0, PI), 2.0 * quarter, "three arcs", "LRL"),
    ];
    for (goal, length_m, word, dubins_word) in cases {
        let curve = REEDS_SHEPP.shortest(ORIGIN, goal);
        assert!((curve.length_m - length_m).abs() < 1e-9, "to {goal:?} by {}: {}", curve.word, curve.length_m);
        assert!((REEDS_SHEPP.length_m(ORIGIN, goal) - length_m).abs() < 1e-9);
        if word != "three arcs" {
            assert_eq!(driven_letters(&curve), word, "to {goal:?}");
            assert_eq!(driven_letters(&DUBINS.shortest(ORIGIN, goal)), dubins_word, "to {goal:?}");
        }
    }
    let back = DUBINS.length_m(ORIGIN, pose(-10.0, 0.0, 0.0));
    assert!((back - (TAU * RADIUS_M + 10.0)).abs() < 1e-9, "half a turn, 10 m, half a turn: {back}");
    // Circles around the two inner centres of three touching ones: a sixth, five sixths, a sixth of a circle.
    let about = DUBINS.length_m(ORIGIN, pose(0.0, 0.0, PI));
    assert!((about - 7.0 / 6.0 * TAU * RADIUS_M).abs() < 1e-9, "half a turn on the spot: {about}");
}

/// The letters of the segments that are driven, in the notation of the words.
fn driven_letters<W: Letters>(curve: &Curve<W>) -> String {
    let letter = |segment: Segment| Letter {
        steering: match segment.curvature {
            0.0 => Steering::Straight,
            left if left > 0.0 => Steering::Left,
            _ => Steering::Right,
        },
        gear: if segment.is_reverse() { Gear::Reverse } else { Gear::Forward },
    };
    curve.segments().map(|segment| letter(segment).to_string()).collect()
}

/// A sideways shift of `y` takes four arcs of `sqrt(y / 2)` turning radii, to the leading order.
#[test]
fn small_offsets_take_short_ways() {
    for offset in [1e-2, 1e-4, 1e-6, 1e-8] {
        let turned = REEDS_SHEPP.length_m(ORIGIN, pose(0.0, 0.0, offset));
        assert!((turned - RADIUS_M * offset).abs() < 1e-9, "a turn by {offset}: {turned}");
        let ahead = REEDS_SHEPP.length_m(ORIGIN, pose(offset, 0.0, 0.0));
        assert!((ahead - offset).abs() < 1e-12, "{offset} m ahead: {ahead}");
        let sideways = REEDS_SHEPP.length_m(ORIGIN, pose(0.0, offset, 0.0));
        let expected = (8.0 * RADIUS_M * offset).sqrt();
        assert!((sideways / expected - 1.0).abs() < 1e-3, "{offset} m sideways: {sideways}, about {expected}");
        for goal in
            [pose(0.0, 0.0, offset), pose(offset, 0.0, 0.0), pose(0.0, offset, 0.0), pose(offset, offset, offset)]
        {
            for PricedCurve { curve, .. } in candidates(ORIGIN, goal, &CurvePrice::LENGTH) {
                assert_same_pose(curve.path(ORIGIN).end(), goal, 1e-9, &curve.word);
            }
        }
    }
}

#[test]
fn every_word_ends_at_the_goal() {
    for (from, to) in random_pairs("curves/ends") {
        let priced = candidates(from, to, &CurvePrice::LENGTH);
        for curve in priced.iter().map(|priced| priced.curve) {
            let path = curve.path(from);
            assert_same_pose(path.end(), to, 1e-9, &curve.word);
            assert!((path.length_m() - curve.length_m).abs() < 1e-9, "{} is {} m", curve.word, path.length_m());
            assert_eq!(path.cusps(), curve.cusps());
        }
        for curve in DUBINS.curves(from, to) {
            let path = curve.path(from);
            assert_same_pose(path.end(), to, 1e-9, &curve.word);
            assert!((path.length_m() - curve.length_m).abs() < 1e-9, "{} is {} m", curve.word, path.length_m());
            assert_eq!(path.cusps(), 0);
            assert!(path.segments.iter().all(|segment| segment.length_m > 0.0));
        }
    }
}

#[test]
fn segments_are_those_of_the_word() {
    for (from, to) in random_pairs("curves/letters").into_iter().step_by(10) {
        for PricedCurve { curve, .. } in candidates(from, to, &CurvePrice::LENGTH) {
            assert_eq!(driven_letters(&curve), curve.word.to_string());
            assert!(curve.segments().all(|segment| segment.curvature.abs() * RADIUS_M <= 1.0));
        }
    }
}

/// The search solves nine words of a folded pair at most; this solves all 48.
#[test]
fn no_word_is_shorter_than_the_shortest() {
    let mut winners = BTreeSet::new();
    for (from, to) in random_pairs("curves/shortest") {
        let all = candidates(from, to, &CurvePrice::LENGTH);
        let min = all.iter().map(|priced| priced.curve.length_m).fold(f64::INFINITY, f64::min);
        let shortest = REEDS_SHEPP.shortest(from, to);
        assert_eq!(shortest.length_m, REEDS_SHEPP.length_m(from, to));
        assert_eq!(shortest.length_m, min, "{from:?} to {to:?} by {}", shortest.word);
        winners.insert(shortest.word.to_string());

        let dubins = DUBINS.curves(from, to).map(|curve| curve.length_m).fold(f64::INFINITY, f64::min);
        assert_eq!(DUBINS.length_m(from, to), dubins);
    }
    assert_eq!(winners.len(), Word::ALL.len(), "every word is the shortest somewhere: {winners:?}");
}

/// Knows nothing of words: whatever is driven at random, the curve to its end is no longer.
#[test]
fn nothing_that_is_driven_is_shorter_than_the_curve() {
    let mut rng = rng::stream(1, "curves/driven");
    for _ in 0..4 * PAIRS {
        let from = random_pose(&mut rng, 100.0);
        let mut segment = || {
            let steering = rng.random_range(-1..=1);
            let max_m = if steering == 0 { 40.0 } else { FRAC_PI_2 * RADIUS_M };
            Segment { curvature: f64::from(steering) / RADIUS_M, length_m: rng.random_range(-max_m..max_m) }
        };
        let driven = vehicle::Path { start: from, segments: (0..5).map(|_| segment()).collect() };
        assert!(REEDS_SHEPP.length_m(from, driven.end()) < driven.length_m() + 1e-9, "{driven:?}");
        let forward = vehicle::Path {
            start: from,
            segments: driven.segments.iter().map(|s| Segment { length_m: s.length_m.abs(), ..*s }).collect(),
        };
        assert!(DUBINS.length_m(from, forward.end()) < forward.length_m() + 1e-9, "{forward:?}");
    }
}

#[test]
fn lengths_are_a_metric() {
    let mut rng = rng::stream(1, "curves/metric");
    for (from, to) in random_pairs("curves/pairs") {
        let length_m = REEDS_SHEPP.length_m(from, to);
        assert_eq!(length_m, REEDS_SHEPP.length_m(to, from), "the way back");
        assert!(length_m >= from.position().distance(to.position()) - 1e-12, "shorter than the straight line");
        assert!(
            length_m >= RADIUS_M * ops::wrap_angle(to.heading - from.heading).abs() - 1e-12,
            "shorter than the turn"
        );
        assert!(length_m <= DUBINS.length_m(from, to) + 1e-12, "longer than without reverse");
        assert_eq!(REEDS_SHEPP.length_m(from, from), 0.0);
        let via = random_pose(&mut rng, 60.0);
        let detour_m = REEDS_SHEPP.length_m(from, via) + REEDS_SHEPP.length_m(via, to);
        assert!(length_m <= detour_m + 1e-9, "a detour by {via:?} is shorter");
    }
}

#[test]
fn lengths_scale_with_the_radius_and_do_not_depend_on_the_frame() {
    let mut rng = rng::stream(1, "curves/frame");
    for (from, to) in random_pairs("curves/scaled").into_iter().step_by(10) {
        let length_m = REEDS_SHEPP.length_m(from, to);
        let twice = |pose: Pose| Pose { x: 2.0 * pose.x, y: 2.0 * pose.y, ..pose };
        let larger = ReedsShepp { radius_m: 2.0 * RADIUS_M };
        assert!((larger.length_m(twice(from), twice(to)) - 2.0 * length_m).abs() < 1e-9);
        let frame = random_pose(&mut rng, 100.0);
        let moved = |pose: Pose| {
            let place = frame.transform(pose.position());
            Pose::new(place.x, place.y, frame.heading + pose.heading)
        };
        let unwrapped = |pose: Pose| Pose { heading: pose.heading + TAU, ..pose };
        assert!((REEDS_SHEPP.length_m(moved(from), moved(to)) - length_m).abs() < 1e-9);
        assert!((REEDS_SHEPP.length_m(unwrapped(from), to) - length_m).abs() < 1e-9);
    }
}

#[test]
fn a_bound_tells_whether_there_is_a_shorter_way() {
    for (from, to) in random_pairs("curves/bounds").into_iter().step_by(5) {
        let length_m = REEDS_SHEPP.length_m(from, to);
        for factor in [0.5, 0.9, 0.999_999, 1.000_001, 1.1, 2.0] {
            let expected = (factor > 1.0).then_some(length_m);
            assert_eq!(REEDS_SHEPP.length_below(from, to, factor * length_m), expected, "{factor} of {length_m}");
        }
        let price = CurvePrice { reverse_factor: 2.0, cusp_m: 3.0 };
        let cheapest = REEDS_SHEPP.cheapest(from, to, &price);
        assert_eq!(REEDS_SHEPP.cheapest_below(from, to, &price, 0.999_999 * cheapest.price), None);
        assert_eq!(REEDS_SHEPP.cheapest_below(from, to, &price, 1.000_001 * cheapest.price), Some(cheapest));
    }
}

#[test]
fn the_cheapest_of_the_48_words_is_the_first_candidate() {
    let prices = [
        CurvePrice::LENGTH,
        CurvePrice { reverse_factor: 1.0, cusp_m: 1.0 },
        CurvePrice { reverse_factor: 1.5, cusp_m: 0.0 },
        CurvePrice { reverse_factor: 3.0, cusp_m: 20.0 },
        CurvePrice { reverse_factor: 0.5, cusp_m: 5.0 },
    ];
    let mut curves = Vec::with_capacity(Word::ALL.len());
    for (index, (from, to)) in random_pairs("curves/prices").into_iter().enumerate() {
        let price = &prices[index % prices.len()];
        let room = curves.capacity();
        REEDS_SHEPP.candidates(from, to, price, &mut curves);
        assert_eq!(curves.capacity(), room, "the buffer grew");
        assert!(curves.is_sorted_by_key(|priced| priced.price));
        let cheapest = REEDS_SHEPP.cheapest_word(from, to, price);
        assert!(
            (cheapest.price - curves[0].price).abs() < 1e-12,
            "{from:?} to {to:?}: {cheapest:?}, not {:?}",
            curves[0]
        );
        assert_eq!(cheapest.price, price.cost(&cheapest.curve));
        assert!(cheapest.price <= price.cost(&REEDS_SHEPP.shortest(from, to)));
    }
}

/// Half a turn and 20 m to the left: the last quarter in reverse saves 20 m. Who pays more for that drives on forward.
#[test]
fn dear_cusps_and_dear_reversing_buy_a_longer_way() {
    let to = pose(30.0, 20.0, PI);
    let cheapest = |reverse_factor, cusp_m| REEDS_SHEPP.cheapest(ORIGIN, to, &CurvePrice { reverse_factor, cusp_m });
    let texts = [(1.0, 0.0), (1.0, 20.0), (1.0, 21.0), (4.0, 0.0)].map(|(reverse_factor, cusp_m)| {
        let curve = cheapest(reverse_factor, cusp_m).curve;
        (curve.word.to_string(), curve.cusps())
    });
    let spelled = |word: &str, cusps| (word.to_string(), cusps);
    let (cusp, detour) = (spelled("L+S+L+R-", 1), spelled("R+S+L+", 0));
    assert_eq!(texts, [cusp.clone(), cusp, detour.clone(), detour]);
    let dearer_m = cheapest(1.0, 21.0).curve.length_m - cheapest(1.0, 0.0).curve.length_m;
    assert!((20.0..21.0).contains(&dearer_m), "the detour is {dearer_m} m longer");
}

#[test]
fn who_may_not_reverse_drives_a_dubins_curve() {
    let forbidding = CurvePrice { reverse_factor: 1e6, cusp_m: 1e6 };
    for (from, to) in random_pairs("curves/forward").into_iter().step_by(5) {
        let cheapest = REEDS_SHEPP.cheapest(from, to, &forbidding).curve;
        let letters_forward = |word: Word| word.letters().all(|letter| letter.gear == Gear::Forward);
        assert!(letters_forward(cheapest.word), "{}", cheapest.word);
        let min = DUBINS.length_m(from, to);
        assert!((cheapest.length_m - min).abs() < 1e-9, "{from:?} to {to:?}: {} and {min}", cheapest.length_m);
    }
}

/// However prices are, and where poses coincide, face each other or are less than two turning circles apart.
#[test]
fn no_other_curve_is_cheaper_than_the_cheapest() {
    let mut rng = rng::stream(2, "curves/cheapest");
    let mut pairs = random_pairs("curves/cheapest");
    pairs.extend((0..4000).map(|_| (random_pose(&mut rng, 4.0 * RADIUS_M), random_pose(&mut rng, 4.0 * RADIUS_M))));
    for heading in [0.0, FRAC_PI_2, PI, -1e-9] {
        for x in [0.0, 1e-9, 1.0, 2.0 * RADIUS_M, 4.0 * RADIUS_M] {
            pairs.extend([pose(x, 0.0, heading), pose(0.0, x, heading), pose(-x, 0.0, heading)].map(|to| (ORIGIN, to)));
        }
    }
    let mut loops = 0;
    for (from, to) in pairs {
        for (reverse_factor, cusp_m) in [(1.0, 0.0), (1.0, 1.0), (1.05, 20.0), (3.0, 500.0), (0.5, 100.0), (0.0, 7.0)] {
            let price = CurvePrice { reverse_factor, cusp_m };
            let cheapest = REEDS_SHEPP.cheapest(from, to, &price);
            let shortest = price.cost(&REEDS_SHEPP.shortest(from, to));
            let backwards = reverse_factor * DUBINS.length_m(to, from);
            let others =
                [shortest, DUBINS.length_m(from, to), backwards, REEDS_SHEPP.cheapest_word(from, to, &price).price];
            let min = others.into_iter().fold(f64::INFINITY, f64::min);
            assert!(cheapest.price <= min + 1e-9, "{from:?} to {to:?}: {cheapest:?}, not {min}");
            assert_eq!(cheapest.price, price.cost(&cheapest.curve));
            let end = cheapest.curve.path(from).end();
            assert!((end.position() - to.position()).length() < 1e-8, "{from:?} to {to:?} ends in {end:?}");
            assert!(ops::wrap_angle(end.heading - to.heading).abs() < 1e-9, "{from:?} to {to:?} ends in {end:?}");
            loops += u32::from(Word::LOOPS.contains(&cheapest.curve.word));
        }
    }
    assert!(loops > 100, "{loops} loops");
}
