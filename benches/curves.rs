//! What a Reeds-Shepp or Dubins curve costs, on the thread's CPU clock: medians over repetitions.
//!
//! Every call sees a pair of poses that it has not seen before in the pass, and there are too many pairs for a branch
//! predictor to learn.
//!
//! `cargo bench --bench curves`

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::f64::consts::PI;
use std::hint::black_box;

use rand::RngExt;
use wildfire::geometry::{Pose, ops};
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::time::cpu::CpuStopwatch;
use wildfire::vehicle::reeds_shepp::Word;
use wildfire::vehicle::{CurvePrice, Dubins, ReedsShepp};

const RADIUS_M: f64 = 13.0;
const PAIRS: usize = 100_000;
const REPETITIONS: usize = 15;

fn main() {
    let reeds_shepp = ReedsShepp { radius_m: RADIUS_M };
    let dubins = Dubins { radius_m: RADIUS_M };
    let price = CurvePrice { reverse_factor: 1.0, cusp_m: 1.0 };
    let reversing = CurvePrice { reverse_factor: 2.0, cusp_m: 5.0 };
    let mut curves = Vec::with_capacity(Word::ALL.len());
    let mut rng = rng::stream(1, "bench/curves");

    for field_m in [10.0, 60.0, 250.0] {
        let pairs: Vec<(Pose, Pose)> =
            (0..PAIRS).map(|_| (random_pose(&mut rng, field_m), random_pose(&mut rng, field_m))).collect();
        println!("{PAIRS} pairs in a field of {field_m} m, radius {RADIUS_M} m");
        report("length", &pairs, |from, to| reeds_shepp.length_m(from, to));
        report("length below 1.3 times the straight line + 3 m", &pairs, |from, to| {
            reeds_shepp.length_below(from, to, 1.3 * from.position().distance(to.position()) + 3.0)
        });
        report("shortest curve", &pairs, |from, to| reeds_shepp.shortest(from, to));
        report("cheapest curve, a cusp costs 1 m", &pairs, |from, to| reeds_shepp.cheapest(from, to, &price));
        report("the same, below 1.3 times the straight line + 3 m", &pairs, |from, to| {
            reeds_shepp.cheapest_below(from, to, &price, 1.3 * from.position().distance(to.position()) + 3.0)
        });
        report("cheapest curve, a cusp 5 m, reverse twice", &pairs, |from, to| {
            reeds_shepp.cheapest(from, to, &reversing)
        });
        report("all candidates, sorted", &pairs, |from, to| {
            reeds_shepp.candidates(from, to, &price, &mut curves);
        });
        report("Dubins, shortest curve", &pairs, |from, to| dubins.shortest(from, to));
        report("one sine and cosine", &pairs, |from, to| ops::sin_cos(0.5 * (from.heading + to.heading)));
        report("one atan2", &pairs, |from, to| ops::atan2(to.y - from.y, to.x - from.x));
        report("one acos", &pairs, |from, to| ops::acos((to.y - from.y) / (to.x + from.x)));
    }
}

fn random_pose(rng: &mut Xoshiro256PlusPlus, field_m: f64) -> Pose {
    Pose::new(rng.random_range(0.0..field_m), rng.random_range(0.0..field_m), rng.random_range(-PI..PI))
}

/// Prints the median cost of a call over all pairs together.
fn report<R>(what: &str, pairs: &[(Pose, Pose)], mut call: impl FnMut(Pose, Pose) -> R) {
    let mut costs: Vec<u128> = (0..REPETITIONS)
        .map(|_| {
            let mut watch = CpuStopwatch::start();
            for &(from, to) in black_box(pairs) {
                black_box(call(from, to));
            }
            watch.elapsed_since_last().as_nanos()
        })
        .collect();
    costs.sort_unstable();
    println!("  {what:<52} {:8.1} ns", costs[REPETITIONS / 2] as f64 / pairs.len() as f64);
}
