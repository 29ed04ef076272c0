//! Batches against batches, from tables of runs that are written here by hand.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use wildfire::batch::comparison::{
    Comparison, ComparisonError, Contrast, JudgedContrast, Method, PublishedComparison, Questions, Selection, Verdict,
    compare,
};
use wildfire::stats::RESOLUTION;

const HEADER: &str = "scenario,seed,run,planner,field.coverage,status,message,intact,burning,burned_out,extinguished,\
                      ended_s,mean_response_s,first_fire_s,all_out_s,winner";

/// A run that can be written as a row.
#[derive(Clone)]
struct Run {
    seed: u64,
    planner: &'static str,
    coverage: &'static str,
    status: &'static str,
    extinguished: u64,
    all_out_s: Option<f64>,
    winner: &'static str,
}

impl Run {
    fn of(seed: u64, extinguished: u64) -> Self {
        let winner = if extinguished > 120 { "unimog" } else { "wumpus" };
        let all_out_s = Some(1000.0 + seed as f64);
        Self { seed, planner: "prm", coverage: "0.1", status: "done", extinguished, all_out_s, winner }
    }

    fn row(&self) -> String {
        let Self { seed, planner, coverage, status, extinguished, winner, .. } = self;
        if *status != "done" {
            return format!("s,{seed},0,{planner},{coverage},{status},\"no, it, failed\",,,,,,,,,\n");
        }
        let out = self.all_out_s.map_or(String::new(), |time| time.to_string());
        let burned = 250 - extinguished;
        format!(
            "s,{seed},0,{planner},{coverage},done,,0,0,{burned},{extinguished},3600,{}.5,60,{out},{winner}\n",
            seed % 7
        )
    }
}

/// Runs of `extinguished(seed)` cells.
fn runs(seeds: impl IntoIterator<Item = u64>, extinguished: impl Fn(u64) -> u64) -> Vec<Run> {
    seeds.into_iter().map(|seed| Run::of(seed, extinguished(seed))).collect()
}

fn noise(seed: u64) -> u64 {
    100 + seed * 7919 % 41
}

struct Scratch(tempfile::TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a scratch folder"))
    }

    fn batch(&self, name: &str, runs: &[Run]) -> PathBuf {
        let text = runs.iter().fold(format!("{HEADER}\n"), |text, run| text + &run.row());
        self.file(name, text.as_bytes())
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let folder = self.0.path().join(name);
        fs::create_dir_all(&folder).expect("writable");
        fs::write(folder.join("runs.csv"), bytes).expect("writable");
        folder
    }
}

fn by(column: &str) -> Selection {
    Selection { by: Some((column.into(), Vec::new())), only: Vec::new() }
}

fn compared(paths: &[&Path], metrics: &[&str]) -> Comparison {
    let metrics: Vec<_> = metrics.iter().map(|&name| name.to_owned()).collect();
    let paths: Vec<_> = paths.iter().map(|&path| path.to_owned()).collect();
    compare(&paths, &Selection::default(), &metrics).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(paths: &[&Path], selection: &Selection, metrics: &[&str]) -> String {
    let metrics: Vec<_> = metrics.iter().map(|&name| name.to_owned()).collect();
    let paths: Vec<_> = paths.iter().map(|&path| path.to_owned()).collect();
    compare(&paths, selection, &metrics).expect_err("it is refused").to_string()
}

fn only_judged(comparison: &Comparison) -> &JudgedContrast {
    &comparison.against_a[0].judged[0]
}

#[test]
fn difference_that_is_there_is_found_and_said() {
    let scratch = Scratch::new();
    let a = scratch.batch("a", &runs(1..=60, noise));
    let b = scratch.batch("b", &runs(1..=60, |seed| noise(seed) + 4 + seed % 5));
    let comparison = compared(&[&a, &b], &["saved"]);
    let judged = only_judged(&comparison);
    assert_eq!((judged.verdict, judged.contrast.pairs), (Verdict::Difference, 60));
    // Seeds 1 to 60 have every remainder twelve times: 4 + 2 in the mean.
    assert!((judged.contrast.difference - 6.0).abs() < 1e-9);
    let sentence = judged.sentence('B');
    assert!(sentence.starts_with("B saves 6.00 more bushes per run, 95 % interval 5."), "{sentence}");
}

#[test]
fn power_and_equivalence_are_those_of_the_differences_by_seed() {
    let scratch = Scratch::new();
    let a = scratch.batch("a", &runs(1..=60, noise));
    let b = scratch.batch("b", &runs(1..=60, |seed| noise(seed) + 4 + seed % 5));
    let with_questions = |power: &str, equivalent: &str| {
        let amount = |text: &str| Some(text.parse().expect("it is an amount"));
        compared(&[&a, &b], &["saved", "truck_won"])
            .asking(Questions { power: amount(power), equivalent: amount(equivalent) })
    };
    let comparison = with_questions("0.5 cells", "6.2").expect("both have an answer");
    let judged = only_judged(&comparison);
    // In Python: x = numpy.repeat([4, 5, 6, 7, 8], 12); effect = 0.5 / x.std(ddof=1); with statsmodels 0.15,
    // TTestPower().power(effect, 60, 0.05), .solve_power(effect_size=effect, power=0.8, alpha=0.05) rounded up, and
    // .solve_power(nobs=60, power=0.8, alpha=0.05) * x.std(ddof=1)
    let power = judged.power.expect("differences vary");
    assert_eq!((power.difference, power.seeds_needed), (0.5, Some(66)));
    assert!((power.power - 0.7615494804032632).abs() < 1e-9, "{power:?}");
    assert!((power.detectable - 0.524400805).abs() < 1e-5, "{power:?}");
    // DescrStatsW(x).ttost_mean(-6.2, 6.2)[0], .tconfint_mean(alpha=0.1)
    let equivalence = judged.equivalence.expect("differences vary");
    assert!((equivalence.p_value - 0.1408871408911236).abs() < 1e-9 && !equivalence.is_equivalent(), "{equivalence:?}");
    assert!((equivalence.interval.low - 5.692326834099681).abs() < 1e-9, "{equivalence:?}");
    assert!(
        only_judged(&with_questions("1", "6.5").expect("both have an answer"))
            .equivalence
            .expect("as above")
            .is_equivalent()
    );
    let refusal = with_questions("5 m", "1").expect_err("nothing is in metres").to_string();
    assert_eq!(refusal, "--power 5 m: no metric has this unit; expected one of saved: cells, truck_won: below 100 %");
    assert!(with_questions("1", "100 %").is_err(), "no two shares differ by that much");
}

#[test]
fn batch_does_not_differ_from_itself() {
    let scratch = Scratch::new();
    let a = scratch.batch("a", &runs(1..=30, noise));
    let comparison = compared(&[&a, &a], &[]);
    let judged = &comparison.against_a[0].judged;
    assert!(judged.len() >= 4, "the usual metrics that the table has columns for");
    assert!(judged.iter().all(|judged| judged.verdict == Verdict::Equal), "{judged:?}");
    assert_eq!(judged[0].sentence('B'), "equal in all 30 pairs");
}

#[test]
fn exchanged_sides_give_the_mirrored_answer() {
    let scratch = Scratch::new();
    let a = scratch.batch("a", &runs(1..=40, noise));
    let b = scratch.batch("b", &runs(1..=40, |seed| noise(seed * 3) + 5));
    for metric in ["saved", "truck_won"] {
        let [one, other] = [compared(&[&a, &b], &[metric]), compared(&[&b, &a], &[metric])];
        let [one, other] = [&one, &other].map(|comparison| only_judged(comparison).contrast.clone());
        let [ours, theirs] = [&one, &other].map(|contrast| contrast.interval.expect("the pairs differ"));
        assert!((one.difference + other.difference).abs() < 1e-9);
        assert!((ours.low + theirs.high).abs() < 1e-9 && (ours.high + theirs.low).abs() < 1e-9);
        assert_eq!((one.p_value, one.means), (other.p_value, [other.means[1], other.means[0]]));
    }
}

#[test]
fn order_of_the_rows_does_not_matter() {
    let scratch = Scratch::new();
    let a = runs(1..=40, noise);
    let b = runs(1..=40, |seed| noise(seed * 3));
    let reversed: Vec<_> = b.iter().rev().cloned().collect();
    let [a, b, reversed] =
        [("a", &a), ("b", &b), ("reversed", &reversed)].map(|(name, runs)| scratch.batch(name, runs));
    let [one, other] = [compared(&[&a, &b], &["saved"]), compared(&[&a, &reversed], &["saved"])];
    assert_eq!(only_judged(&one), only_judged(&other));
}

#[test]
fn seeds_without_a_partner_and_failed_runs_are_left_out_and_counted() {
    let scratch = Scratch::new();
    let mut ours = runs(1..=10, noise);
    let mut theirs = runs(3..=13, noise);
    ours[4].status = "failed"; // Seed 5.
    ours[5].status = "panicked"; // Seed 6.
    theirs[3].status = "failed"; // Seed 6.
    theirs[4].status = "failed"; // Seed 7.
    theirs[5].status = "failed"; // Seed 8.
    let [a, b] = [scratch.batch("a", &ours), scratch.batch("b", &theirs)];
    let comparison = compared(&[&a, &b], &["saved"]);
    let pairs = &comparison.against_a[0].pairs;
    assert_eq!((pairs.without_partner, pairs.failed, pairs.runs.len()), ([2, 3], [1, 2, 1], 4));
    assert_eq!([comparison.sides[0].failed, comparison.sides[1].failed], [2, 3]);
}

#[test]
fn planners_in_one_batch_are_compared_at_equal_coverage() {
    let scratch = Scratch::new();
    let mut all = Vec::new();
    for (planner, coverage, more) in
        [("prm", "0.1", 0), ("prm", "0.2", 50), ("lattice", "0.1", 3), ("lattice", "0.2", 53)]
    {
        let runs = runs(1..=12, |seed| noise(seed) + more);
        all.extend(runs.into_iter().map(|run| Run { planner, coverage, ..run }));
    }
    let batch = scratch.batch("a", &all);
    let of = |selection: &Selection| compare(std::slice::from_ref(&batch), selection, &["saved".into()]);
    let comparison = of(&by("planner")).expect("two planners");
    let rows = batch.join("runs.csv");
    assert_eq!(comparison.sides[1].description, format!("{} (scenario s, planner lattice)", rows.display()));
    let Contrast { pairs, difference, interval, p_value, .. } = &only_judged(&comparison).contrast;
    assert_eq!((*pairs, *difference, *interval), (24, 3.0, None), "every pair differs by three");
    assert!(p_value.is_some_and(|p| p < 5e-4), "ranks of twelve seeds tell");
    let reversed = Selection { by: Some(("planner".into(), vec!["lattice".into(), "prm".into()])), only: Vec::new() };
    assert_eq!(only_judged(&of(&reversed).expect("two planners")).contrast.difference, -3.0);
    let one = Selection { only: vec![("planner".into(), "prm".into())], ..Selection::default() };
    assert_eq!(only_judged(&of(&one).expect("only coverage varies")).contrast.difference, 50.0);
    let undecided = of(&Selection::default()).expect_err("two things vary").to_string();
    assert!(
        undecided.ends_with("several things vary in it, `planner`, `field.coverage`; choose one with --by"),
        "{undecided}"
    );
}

/// Runs of two planners on three coverages: on the first the second planner saves much more, on the second a little, on
/// the third some runs more and some fewer.
fn planners_on_coverages() -> Vec<Run> {
    let mut all = Vec::new();
    for (coverage, gain) in [("0.05", 27), ("0.1", 1), ("0.2", 0)] {
        let runs = runs(1..=40, |seed| noise(seed) + 10);
        all.extend(runs.iter().map(|run| Run { coverage, ..run.clone() }));
        let luck = |seed: u64| seed * 31 % 5;
        let gained = runs.iter().map(|run| Run {
            planner: "lattice",
            coverage,
            ..Run::of(run.seed, run.extinguished + gain + luck(run.seed) - 2)
        });
        all.extend(gained);
    }
    all
}

#[test]
fn mean_over_what_is_swept_is_taken_apart_where_it_hides_something() {
    let scratch = Scratch::new();
    let batch = scratch.batch("a", &planners_on_coverages());
    let of = |selection: &Selection| compare(std::slice::from_ref(&batch), selection, &["saved".into()]);
    let comparison = of(&by("planner")).expect("two planners");
    let pairs = &comparison.against_a[0].pairs;
    assert_eq!((pairs.stratified_by().as_str(), pairs.strata.len()), ("field.coverage", 3));
    assert!(pairs.strata.iter().all(|stratum| stratum.pairs == 40));
    let judged = only_judged(&comparison);
    let strata = judged.by_stratum.as_ref().expect("three coverages");
    assert!(strata.differ() && strata.seeds == 40 && strata.p_adjusted.is_some_and(|p| p < 1e-6), "{strata:?}");
    assert!(judged.sentence('B').ends_with("; it depends on field.coverage, p < 0.001"), "{}", judged.sentence('B'));
    let expected = [(27.0, Verdict::Difference), (1.0, Verdict::Difference), (0.0, Verdict::NoEvidence)];
    for ((_, stratum), (difference, verdict)) in strata.strata.iter().zip(expected) {
        assert!((stratum.contrast.difference - difference).abs() < 1e-9, "{stratum:?}");
        assert_eq!(stratum.verdict, verdict);
    }
}

#[test]
fn keys_that_were_swept_in_another_order_make_the_same_pairs() {
    let scratch = Scratch::new();
    let table = |columns: &str, is_turned: bool, more: u64| {
        let mut text = format!("scenario,seed,run,planner,{columns},status,message,intact,extinguished\n");
        for (one, other) in [(1, 10), (1, 20), (2, 10), (2, 20)] {
            for seed in 1..=6 {
                let keys = if is_turned { format!("{other},{one}") } else { format!("{one},{other}") };
                writeln!(text, "s,{seed},0,p,{keys},done,,{},{}", one * other, noise(seed) + more).expect("text");
            }
        }
        text
    };
    let a = scratch.file("a", table("a.b,c.d", false, 0).as_bytes());
    let b = scratch.file("b", table("c.d,a.b", true, 5).as_bytes());
    let comparison = compared(&[&a, &b], &["saved"]);
    let pairs = &comparison.against_a[0].pairs;
    assert_eq!((pairs.runs.len(), pairs.without_partner), (24, [0, 0]));
    assert_eq!(pairs.stratum_text(1), "a.b 1, c.d 20");
    assert_eq!(only_judged(&comparison).contrast.difference, 5.0);
}

#[test]
fn strata_are_what_where_gives() {
    let scratch = Scratch::new();
    let batch = scratch.batch("a", &planners_on_coverages());
    let of = |selection: &Selection| {
        compare(std::slice::from_ref(&batch), selection, &["saved".into(), "truck_won".into()]).expect("two planners")
    };
    let all = of(&by("planner"));
    for (index, coverage) in ["0.05", "0.1", "0.2"].into_iter().enumerate() {
        let one = of(&Selection { only: vec![("field.coverage".into(), coverage.into())], ..by("planner") });
        for (in_all, alone) in all.against_a[0].judged.iter().zip(&one.against_a[0].judged) {
            let (_, stratum) = &in_all.by_stratum.as_ref().expect("three coverages").strata[index];
            assert_eq!(stratum.contrast, alone.contrast, "{coverage}");
            assert_eq!(alone.by_stratum, None, "nothing is left to average over");
        }
    }
}

#[test]
fn difference_over_strata_is_one_of_means_by_seed() {
    let scratch = Scratch::new();
    // What a seed gains it gains on all coverages: three times the runs tell nothing more.
    let gain = |seed: u64| seed * 31 % 17;
    let on = |coverages: &[&'static str]| {
        let all = coverages.iter().flat_map(|&coverage| {
            let ours = runs(1..=20, noise).into_iter().map(move |run| Run { coverage, ..run });
            let theirs = runs(1..=20, |seed| noise(seed) + gain(seed));
            ours.chain(theirs.into_iter().map(move |run| Run { planner: "lattice", coverage, ..run }))
        });
        all.collect::<Vec<_>>()
    };
    let of = |name: &str, runs: &[Run]| {
        let batch = scratch.batch(name, runs);
        let comparison =
            compare(&[batch], &by("planner"), &["saved".into(), "truck_won".into()]).expect("two planners");
        comparison.against_a[0].judged.iter().map(|judged| judged.contrast.clone()).collect::<Vec<_>>()
    };
    let three = on(&["0.05", "0.1", "0.2"]);
    let [one, all] = [of("one", &on(&["0.1"])), of("all", &three)].map(|contrasts| contrasts[0].clone());
    assert_eq!([(one.pairs, one.seeds), (all.pairs, all.seeds)], [(20, 20), (60, 20)]);
    let [ours, theirs] = [&one, &all].map(|contrast| contrast.interval.expect("the pairs differ"));
    assert!((ours.low - theirs.low).abs() < 1e-9 && (ours.high - theirs.high).abs() < 1e-9, "{ours:?} {theirs:?}");
    assert_eq!((one.p_value, one.ranks), (all.p_value, all.ranks));
    // A run that failed takes its pair away, not its seed, and a seed without it is not far off for that.
    let mut holed = three.clone();
    holed.iter_mut().filter(|run| run.coverage == "0.2").for_each(|run| run.extinguished += 30);
    let theirs = |run: &&mut Run| run.coverage == "0.2" && run.planner == "lattice";
    holed.iter_mut().filter(theirs).for_each(|run| run.extinguished += 60);
    let whole = of("whole", &holed);
    holed.iter_mut().find(|run| theirs(run)).expect("the first").status = "failed";
    for (whole, holed) in whole.iter().zip(of("holed", &holed)) {
        let [wide, narrow] = [&holed, whole].map(|contrast| contrast.interval.expect("the pairs differ"));
        assert_eq!((holed.pairs, holed.seeds), (59, 20));
        let ratio = (wide.high - wide.low) / (narrow.high - narrow.low);
        assert!((0.8..1.25).contains(&ratio), "{wide:?} {narrow:?}");
    }
}

#[test]
fn p_beyond_the_resamples_is_students_and_called_so() {
    let scratch = Scratch::new();
    let a = scratch.batch("a", &runs(1..=60, |seed| noise(seed) + 2));
    for (more, expected) in [(2, Method::StudentsT), (0, Method::StudentisedBootstrap)] {
        let b = scratch.batch("b", &runs(1..=60, |seed| noise(seed) + more + seed * 31 % 5));
        let Contrast { method, p_method, p_value, .. } =
            &only_judged(&compared(&[&a, &b], &["saved"])).contrast.clone();
        assert_eq!((*method, *p_method), (Method::StudentisedBootstrap, expected));
        let p = p_value.expect("the pairs differ");
        assert_eq!(p < RESOLUTION, expected == Method::StudentsT, "{p}");
    }
}

#[test]
fn strata_that_do_not_differ_are_not_said_to() {
    let scratch = Scratch::new();
    let same = planners_on_coverages().into_iter().map(|run| {
        let is_gained = run.planner == "lattice" && run.coverage == "0.05";
        Run { extinguished: run.extinguished - if is_gained { 26 } else { 0 }, ..run }
    });
    let same: Vec<_> = same.filter(|run| run.coverage != "0.2").collect();
    let batch = scratch.batch("a", &same);
    let comparison = compare(&[batch], &by("planner"), &["saved".into()]).expect("two planners");
    let judged = only_judged(&comparison);
    let strata = judged.by_stratum.as_ref().expect("two coverages");
    assert!(!strata.differ() && !judged.sentence('B').contains("depends"), "{judged:?}");
}

#[test]
fn tests_of_strata_are_adjusted_together() {
    let scratch = Scratch::new();
    let batch = scratch.batch("a", &planners_on_coverages());
    let metrics = ["saved".into(), "truck_won".into(), "all_out_s".into()];
    let comparison = compare(&[batch], &by("planner"), &metrics).expect("two planners");
    let tests = comparison.against_a[0].judged.iter().filter_map(|judged| {
        let strata = judged.by_stratum.as_ref()?;
        Some((strata.test?.p_value, strata.p_adjusted.expect("it was tested")))
    });
    let tests: Vec<_> = tests.collect();
    assert_eq!(tests.len(), 2, "all fires are out at the same times");
    let min = tests.iter().map(|(alone, _)| *alone).fold(1.0, f64::min);
    for (alone, adjusted) in tests {
        let expected = if alone == min { 2.0 * alone } else { alone.max(2.0 * min) };
        assert!((adjusted - expected.min(1.0)).abs() <= 1e-12, "{alone} {adjusted}");
    }
}

#[test]
fn seeds_that_are_not_in_all_strata_test_nothing() {
    let scratch = Scratch::new();
    let apart = planners_on_coverages().into_iter().map(|run| {
        let first = if run.coverage == "0.05" { 1000 } else { 0 };
        Run { seed: run.seed + first, ..run }
    });
    let apart: Vec<_> = apart.filter(|run| run.coverage != "0.2").collect();
    let batch = scratch.batch("a", &apart);
    let comparison = compare(&[batch], &by("planner"), &["saved".into()]).expect("two planners");
    let strata = only_judged(&comparison).by_stratum.clone().expect("two coverages");
    assert_eq!((strata.seeds, strata.test, strata.p_adjusted), (0, None, None));
    assert_eq!(strata.strata.len(), 2);
}

#[test]
fn batch_of_one_planner_meets_its_like_in_a_batch_of_two() {
    let scratch = Scratch::new();
    let one = runs(1..=10, noise);
    let mut two = runs(1..=10, |seed| noise(seed) + 100);
    two.extend(one.iter().map(|run| Run { planner: "lattice", ..*run }));
    let [one, two] = [scratch.batch("one", &one), scratch.batch("two", &two)];
    let comparison = compared(&[&one, &two], &["saved"]);
    assert_eq!(comparison.against_a[0].pairs.without_partner, [0, 10]);
    assert_eq!(only_judged(&comparison).contrast.difference, 100.0);
}

#[test]
fn several_sides_are_set_against_the_first_and_tested_together() {
    let scratch = Scratch::new();
    let mut all = Vec::new();
    for (coverage, shift) in [("0.05", 0), ("0.1", 2), ("0.2", 9)] {
        let runs = runs(1..=30, |seed| noise(seed) + shift + seed * shift % 3);
        all.extend(runs.into_iter().map(|run| Run { coverage, ..run }));
    }
    let batch = scratch.batch("a", &all);
    let comparison = compared(&[&batch], &["saved", "extinguished"]);
    let letters: Vec<char> = comparison.against_a.iter().map(|against| against.letter).collect();
    assert_eq!(letters, ['B', 'C']);
    for judged in comparison.against_a.iter().flat_map(|against| &against.judged) {
        let (raw, adjusted) = (judged.contrast.p_value.expect("they differ"), judged.p_adjusted.expect("they differ"));
        assert!(raw <= adjusted && adjusted <= 4.0 * raw, "{raw} {adjusted}");
    }
}

#[test]
fn times_that_are_cut_off_count_as_long_as_both_sides_were_watched() {
    let scratch = Scratch::new();
    let ours = runs(1..=20, noise);
    let never_out = |run: Run| Run { all_out_s: run.all_out_s.filter(|_| run.seed > 4), ..run };
    let theirs: Vec<_> = ours.iter().cloned().map(never_out).collect();
    let [a, b] = [scratch.batch("a", &ours), scratch.batch("b", &theirs)];
    let comparison = compared(&[&a, &b], &["all_out_s"]);
    let Contrast { pairs, difference, cut_off, .. } = &only_judged(&comparison).contrast;
    // Seeds 1 to 4 count as 3600 s instead of 1001 to 1004 s.
    let expected = (4.0 * 3600.0 - 4010.0) / 20.0;
    assert_eq!(*pairs, 20);
    assert!((difference - expected).abs() < 1e-9, "{difference}");
    let cut_off = cut_off.as_ref().expect("it is a time");
    assert_eq!((cut_off.horizon, cut_off.counts), (Some(3600.0), [0, 4]));
    assert_eq!(cut_off.medians, [Some(1010.0), Some(1014.0)]);
}

#[test]
fn selections_that_cannot_be_met_are_refused_with_what_there_is() {
    let scratch = Scratch::new();
    let mut both = runs(1..=3, noise);
    both.extend(runs(1..=3, noise).into_iter().map(|run| Run { planner: "lattice", ..run }));
    let both = scratch.batch("both", &both);
    let one = scratch.batch("one", &runs(1..=3, noise));
    let others = scratch.batch("others", &runs(7..=9, noise));
    let only =
        |column: &str, value: &str| Selection { only: vec![(column.into(), value.into())], ..Selection::default() };
    let none = Selection::default();
    let level = Selection { by: Some(("planner".into(), vec!["prm".into(), "prn".into()])), only: Vec::new() };
    let twice = scratch.batch("twice", &[Run::of(1, 100), Run::of(2, 100), Run::of(1, 100)]);
    let cases: [(&[&Path], &Selection, &[&str], &str); 9] = [
        (&[&one, &twice], &none, &[], "runs.csv: seed 1 occurs twice"),
        (&[&both, &others], &none, &[], "A and B share no seed under equal `planner`"),
        (&[&both], &by("planer"), &[], "no column `planer` to choose runs by: did you mean `planner`?"),
        (&[&both], &level, &[], "no run has planner `prn`: expected `prm`, `lattice`"),
        (&[&both], &only("planner", "x"), &[], "no run has planner `x`"),
        (&[&one], &by("planner"), &[], "all runs have planner `prm`; expected at least two values to compare"),
        (&[&one], &none, &[], "expected a second batch to compare with"),
        (&[&one, &others], &none, &[], "A and B share no seed"),
        (&[&one, &others], &none, &["mean_respons_s"], "no metric `mean_respons_s`: did you mean `mean_response_s`?"),
    ];
    for (paths, selection, metrics, expected) in cases {
        let refusal = refusal(paths, selection, metrics);
        assert!(refusal.contains(expected), "{refusal}\nhas not\n{expected}");
    }
}

#[test]
fn wrong_files_are_refused_where_they_are_wrong() {
    let scratch = Scratch::new();
    let good = runs(1..=2, noise).iter().fold(format!("{HEADER}\n"), |text, run| text + &run.row());
    let row = Run::of(1, 100).row();
    let with = |row: &str| format!("{HEADER}\n{row}").into_bytes();
    let mut endless = format!("{HEADER}\ns,1,0,prm,0.1,done,\"").into_bytes();
    endless.resize(4 << 20, b'x');
    let long = "x".repeat(1001);
    let cases: [(&str, Vec<u8>, &str); 12] = [
        ("empty", Vec::new(), "there is no column `seed`"),
        ("other", b"a,b\n1,2\n".to_vec(), "there is no column `seed`"),
        ("no status", b"seed,planner\n1,2\n".to_vec(), "there is no column `status`"),
        ("twice", b"seed,status,seed\n1,done,1\n".to_vec(), "the column `seed` appears twice"),
        ("no rows", with(""), "has no runs to compare"),
        ("torn", good.as_bytes()[..good.len() - 20].to_vec(), "line 3: 12 fields; expected 16"),
        ("seed", with(&row.replacen("s,1", "s,-1", 1)), "line 2: seed is `-1`; expected a seed"),
        (
            "word",
            with(&row.replace(",100,", ",many,")),
            "line 2: extinguished is `many`; expected a number, or nothing",
        ),
        ("nan", with(&row.replace(",100,", ",NaN,")), "extinguished is `NaN`; expected a number"),
        ("huge", with(&row.replace(",100,", ",1e300,")), "extinguished is `1e300`; expected a number"),
        ("long", with(&row.replace("prm", &long)), "planner is `xxx"),
        ("endless", endless, "line 2: more than 1048576 bytes; expected a row to end before"),
    ];
    for (name, bytes, expected) in cases {
        let folder = scratch.file(name, &bytes);
        let refusal = refusal(&[&folder, &folder], &Selection::default(), &[]);
        assert!(refusal.contains(expected), "{name}: {refusal}\nhas not\n{expected}");
    }
    let nothing = scratch.0.path().join("nothing");
    let refusal = compare(&[nothing.clone(), nothing], &Selection::default(), &[]).expect_err("it is not there");
    assert!(matches!(refusal, ComparisonError::NoBatch { .. }));
}

#[test]
fn any_beginning_of_a_table_is_compared_or_refused() {
    let scratch = Scratch::new();
    let text = runs(1..=3, noise).iter().fold(format!("{HEADER}\n"), |text, run| text + &run.row());
    let whole = scratch.batch("whole", &runs(1..=3, noise));
    for length in 0..text.len() {
        let cut = scratch.file("cut", &text.as_bytes()[..length]);
        // Either answer is fine; it is a crash that would not be.
        let _ = compare(&[whole.clone(), cut], &Selection::default(), &[]);
    }
}

/// The published ratios with a CPU time for every part, as a batch of five runs.
fn published_batch(scratch: &Scratch) -> PathBuf {
    let mut text = String::from(
        "scenario,seed,status,intact_ratio,burned_ratio,extinguished_ratio,cpu_sampling_s,cpu_map_generation_s,\
         cpu_roadmap_search_s,cpu_local_search_s,cpu_unimog_total_s,cpu_prm_total_s,cpu_wumpus_s\n",
    );
    let runs = [[67, 84, 86, 237], [44, 113, 78, 235], [79, 70, 89, 238], [85, 54, 95, 234], [79, 78, 71, 228]];
    for (seed, [intact, burned, extinguished, all]) in runs.iter().enumerate() {
        let ratio = |count: &i32| f64::from(*count) / f64::from(*all);
        let (intact, burned, extinguished) = (ratio(intact), ratio(burned), ratio(extinguished));
        writeln!(text, "s,{seed},done,{intact},{burned},{extinguished},0.022,1,1,1,1,1,1").expect("text");
    }
    scratch.file("published", text.as_bytes())
}

#[test]
fn report_stands_beside_a_batch_like_it_without_a_difference() {
    let scratch = Scratch::new();
    let beside = PublishedComparison::from_batch(&published_batch(&scratch), &Selection::default())
        .expect("all columns are there");
    assert_eq!(beside.states.len(), 3);
    for state in &beside.states {
        let (published, batch) = (state.published.mean().expect("five"), state.batch.mean().expect("five"));
        assert!((published - batch).abs() < 1e-12);
        assert!(state.difference.is_some_and(|interval| interval.contains(0.0)));
        assert!(state.five_runs.contains(published) && state.as_far > 0.9, "{state:?}");
    }
    // The sums of the published table are 7.719, 3.234 and 10.359 s.
    let sum = |name: &str| {
        let time = beside.times.iter().find(|time| time.name == name);
        5.0 * time.unwrap_or_else(|| panic!("{name} is published")).published_s
    };
    for (name, expected) in [("Unimog total", 7.719), ("PRM only", 3.234), ("Wumpus search", 10.359)] {
        assert!((sum(name) - expected).abs() < 2e-3, "{name}: {}", sum(name));
    }
}

#[test]
fn report_needs_the_columns_of_its_tables() {
    let scratch = Scratch::new();
    let batch = scratch.batch("a", &runs(1..=3, noise));
    let refusal =
        PublishedComparison::from_batch(&batch, &Selection::default()).expect_err("columns are missing").to_string();
    assert!(refusal.ends_with("there is no column `intact_ratio`"), "{refusal}");
}
