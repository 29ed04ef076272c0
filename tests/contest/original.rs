//! The one set of figures that was published from the original program: the mean ratios of five runs (RBE 550 wildfire
//! assignment, 2024, Table I). Under its rules, kept in `original-2024`, they must not be unusual.

use rand::RngExt;
use wildfire::rng;
use wildfire::scenario;
use wildfire::sim;
use wildfire::timeline::Outcome;

const SEEDS: u64 = 200;
const DRAWS: usize = 20_000;
/// Intact, burned, extinguished.
const PUBLISHED: [f64; 3] = [0.302, 0.341, 0.357];

#[test]
fn published_means_of_five_runs_lie_in_the_central_95_percent() {
    let original = scenario::load("original-2024", &[]).expect("the built-in loads");
    let ratios: Vec<[f64; 3]> = (1..=SEEDS)
        .map(|seed| Outcome::new(&sim::run(&original, seed).expect("the preset runs").timeline))
        .map(|outcome| [outcome.intact_ratio(), outcome.burned_ratio(), outcome.extinguished_ratio()])
        .collect();
    let mut stream = rng::stream(1, "tests/original");
    for (kind, published) in PUBLISHED.into_iter().enumerate() {
        let mut five_run_mean =
            || (0..5).map(|_| ratios[stream.random_range(0..ratios.len())][kind]).sum::<f64>() / 5.0;
        let mut means: Vec<f64> = (0..DRAWS).map(|_| five_run_mean()).collect();
        means.sort_by(f64::total_cmp);
        let (low, high) = (means[DRAWS / 40], means[DRAWS - 1 - DRAWS / 40]);
        assert!(low <= published && published <= high, "{published} is not between {low:.3} and {high:.3}");
    }
}
