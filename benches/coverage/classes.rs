//! What a class saves by `--until groups`: 30 entries, whose runs are drawn from 200 seeds of their own.

use std::fmt::Write;

use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};
use wildfire::batch::plan::{BatchPlan, BatchRequest, StoppingGoal, StoppingRule, Value};
use wildfire::batch::stopping::{FIRST_LOOK, Monitor, STEP};
use wildfire::rng;
use wildfire::stats::{Series, holm};

use crate::outcomes::{below, saved};

const SEEDS: u64 = 200;
const CLASSES: u64 = 60;

/// Entries: planners that are more or less dear, with policies that are more or less good.
const ENTRIES: usize = 30;
const PRICES: [&str; 3] = ["0", "0.003", "0.01"];
const PLANNERS: [&str; 3] = ["prm+primitives", "prm-rs", "hybrid-astar"];
const POLICIES: [&str; 4] = ["nearest-burning", "nearest-by-drive", "oldest", "largest-cluster"];

/// How a class ended.
struct Ended {
    runs: u64,
    /// The variants that are not known to be worse than the best.
    first_group: Vec<usize>,
}

struct Class {
    runs: u64,
    first_group: Vec<usize>,
    /// Whether the first group is that of all runs.
    is_same: bool,
}

pub fn rates() -> Result<String, String> {
    let plan = plan()?;
    let outcomes =
        plan.variants.iter().map(|variant| saved(&variant.scenario, 1..=SEEDS)).collect::<Result<Vec<_>, _>>()?;
    let means: Vec<f64> = outcomes.iter().map(|it| Series::from_values(it).mean().unwrap_or(f64::NAN)).collect();
    let best = (0..means.len()).max_by(|&one, &other| means[one].total_cmp(&means[other])).expect("there are entries");
    let classes = (0..CLASSES).into_par_iter().map(|class| {
        let random = &mut rng::stream(class, "coverage/classes");
        let seeds: Vec<usize> = (0..SEEDS).map(|_| below(SEEDS as usize, random)).collect();
        let drawn: Vec<Vec<f64>> =
            outcomes.iter().map(|of_entry| seeds.iter().map(|&seed| of_entry[seed]).collect()).collect();
        let Ended { runs, first_group } = play(&plan, &drawn);
        Class { runs, is_same: first_group == first_group_of_all(&drawn), first_group }
    });
    let classes: Vec<Class> = classes.collect();
    let all = CLASSES * SEEDS * plan.variants.len() as u64;
    let played: u64 = classes.iter().map(|class| class.runs).sum();
    let kept = classes.iter().filter(|class| class.first_group.contains(&best)).count();
    let same = classes.iter().filter(|class| class.is_same).count();
    let size: usize = classes.iter().map(|class| class.first_group.len()).sum();
    let mut text =
        format!("{CLASSES} classes of {} entries with {SEEDS} seeds, by --until groups\n", plan.variants.len());
    writeln!(text, "runs played: {:.1} % of all", 100.0 * played as f64 / all as f64).expect("a string takes any text");
    writeln!(text, "the best entry is in the first group: {kept} of {CLASSES}").expect("a string takes any text");
    writeln!(text, "the first group is that of all runs: {same} of {CLASSES}").expect("a string takes any text");
    writeln!(text, "entries in the first group: {:.1}", size as f64 / CLASSES as f64).expect("a string takes any text");
    Ok(text)
}

fn plan() -> Result<BatchPlan, String> {
    let mut request =
        BatchRequest { seeds: Some(format!("1..{SEEDS}").parse().expect("a range")), ..BatchRequest::default() };
    request.scenarios = vec!["contest".into()];
    let lists =
        [("unimog.seconds_per_expansion", &PRICES[..]), ("unimog.planner", &PLANNERS), ("unimog.goal", &POLICIES)];
    for (key, values) in lists {
        request.add_option(&format!("{key}={}", values.join(","))).map_err(|error| error.to_string())?;
    }
    let plan = request.resolve(false).map_err(|error| error.to_string())?;
    // As in a class: each variant is an entry.
    let mut variants: Vec<_> = plan.variants.iter().take(ENTRIES).cloned().collect();
    for (place, variant) in (0..).zip(&mut variants) {
        variant.swept = vec![Value::Count(place)];
    }
    let goal = StoppingGoal::Groups { margin: 0.0 };
    let rule = StoppingRule { metric: "saved".into(), goal, max_seeds: plan.seeds.clone(), played: Vec::new() };
    Ok(BatchPlan { variants, swept_keys: vec!["entry".into()], until: Some(rule), ..plan })
}

/// Plays a class by its rule.
fn play(plan: &BatchPlan, drawn: &[Vec<f64>]) -> Ended {
    let mut monitor = Monitor::new(plan.until.clone().expect("the plan has a rule"), plan);
    let mut first_group = Vec::new();
    for played in 1..=SEEDS {
        for (variant, values) in drawn.iter().enumerate() {
            if monitor.active()[variant] {
                monitor.add(variant, values[played as usize - 1]);
            }
        }
        if played >= FIRST_LOOK && (played - FIRST_LOOK).is_multiple_of(STEP) {
            let look = monitor.look();
            first_group = look.best(plan).expect("the rule is about the best");
            if look.is_over() {
                break;
            }
        }
    }
    Ended { runs: monitor.played().iter().sum(), first_group }
}

/// Returns the best entry and those that do not differ from it by the tests of `wildfire rank`: paired, of all seeds,
/// adjusted over all pairs.
fn first_group_of_all(drawn: &[Vec<f64>]) -> Vec<usize> {
    let means: Vec<f64> = drawn.iter().map(|it| Series::from_values(it).mean().unwrap_or(f64::NAN)).collect();
    let best = (0..means.len()).max_by(|&one, &other| means[one].total_cmp(&means[other])).expect("there are entries");
    let pairs: Vec<[usize; 2]> =
        (0..drawn.len()).flat_map(|one| (one + 1..drawn.len()).map(move |other| [one, other])).collect();
    let degrees = StudentsT::new(0.0, 1.0, SEEDS as f64 - 1.0).expect("degrees of freedom are positive");
    let p_values: Vec<f64> = pairs
        .iter()
        .map(|&[one, other]| {
            let differences: Vec<f64> = drawn[one].iter().zip(&drawn[other]).map(|(one, other)| other - one).collect();
            let series = Series::from_values(&differences);
            let deviation = series.standard_deviation().unwrap_or(0.0);
            let t = series.mean().unwrap_or(0.0) / (deviation / (SEEDS as f64).sqrt());
            if deviation > 0.0 { 2.0 * degrees.sf(t.abs()) } else { 1.0 }
        })
        .collect();
    let adjusted = holm(&p_values);
    let is_close = |entry: usize| {
        let mut of_pair = pairs.iter().zip(&adjusted);
        entry == best || of_pair.any(|(pair, p)| pair.contains(&entry) && pair.contains(&best) && *p > 0.05)
    };
    (0..drawn.len()).filter(|&entry| is_close(entry)).collect()
}
