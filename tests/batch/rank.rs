//! Entries ranked against each other, from tables of runs that are written here by hand.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use wildfire::batch::comparison::{Better, Comparison, Ranking, RankingRequest, Selection, compare, rank};
use wildfire::batch::plan::BatchRequest;

const HEADER: &str = "scenario,seed,run,planner,status,message,intact,burning,burned_out,extinguished,ended_s,\
                      mean_response_s,first_fire_s,all_out_s,winner,truck_plans,truck_failed_goal_blocked,\
                      truck_lattice_plans,stray";

/// A run that can be written as a row; `None` failed.
#[derive(Clone)]
struct Run {
    planner: &'static str,
    seed: u64,
    saved: Option<u64>,
    response_s: Option<f64>,
    all_out_s: Option<f64>,
}

impl Run {
    fn new(planner: &'static str, seed: u64, saved: Option<u64>) -> Self {
        Self { planner, seed, saved, response_s: Some(seed as f64), all_out_s: Some(1000.0 + seed as f64) }
    }

    fn row(&self, number: usize) -> String {
        let Self { planner, seed, saved, response_s, all_out_s } = self;
        let Some(saved) = saved else {
            return format!("smoke,{seed},{number},{planner},failed,no,,,,,,,,,,,,,\n");
        };
        let [response, out] = [response_s, all_out_s].map(|time| time.map_or(String::new(), |time| time.to_string()));
        let winner = if *saved > 120 { "unimog" } else { "wumpus" };
        let burned = 250_u64.saturating_sub(*saved);
        format!(
            "smoke,{seed},{number},{planner},done,,0,0,{burned},{saved},3600,{response},60,{out},{winner},100,7,3,0\n"
        )
    }
}

/// Runs of one planner, seed by seed.
fn runs(planner: &'static str, seeds: impl IntoIterator<Item = u64>, saved: impl Fn(u64) -> Option<u64>) -> Vec<Run> {
    seeds.into_iter().map(|seed| Run::new(planner, seed, saved(seed))).collect()
}

fn noise(seed: u64) -> u64 {
    100 + seed * 7919 % 41
}

struct Scratch(tempfile::TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a scratch folder"))
    }

    /// The folder of a batch with these runs, whose plan has `smoke` with these options and planners.
    fn batch_of(&self, name: &str, runs: &[Run], planners: &[&str], options: &[&str]) -> PathBuf {
        let mut request = BatchRequest { scenarios: vec!["smoke".into()], ..BatchRequest::default() };
        options.iter().for_each(|option| request.add_option(option).expect("an option"));
        request.add_planners(&planners.iter().map(|&name| name.to_owned()).collect::<Vec<_>>()).expect("planners");
        let plan = request.resolve(false).expect("a small batch");
        let text = runs.iter().enumerate().fold(format!("{HEADER}\n"), |text, (index, run)| text + &run.row(index + 1));
        let folder = self.0.path().join(name);
        fs::create_dir_all(&folder).expect("writable");
        fs::write(folder.join("runs.csv"), text).expect("writable");
        fs::write(folder.join("plan.json"), plan.to_json()).expect("writable");
        folder
    }

    /// The same where the planner of the runs is all that was asked for.
    fn batch(&self, name: &str, runs: &[Run]) -> PathBuf {
        let mut planners: Vec<&str> = runs.iter().map(|run| run.planner).collect();
        planners.dedup();
        self.batch_of(name, runs, &planners, &[])
    }

    fn path(&self) -> &Path {
        self.0.path()
    }
}

fn request(metric: &str) -> RankingRequest {
    RankingRequest { metric: Some(metric.into()), ..RankingRequest::default() }
}

fn ranked(paths: &[&Path], metric: &str) -> Ranking {
    let paths: Vec<PathBuf> = paths.iter().map(|&path| path.to_owned()).collect();
    rank(&paths, &request(metric)).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(paths: &[&Path], request: &RankingRequest) -> String {
    let paths: Vec<PathBuf> = paths.iter().map(|&path| path.to_owned()).collect();
    rank(&paths, request).expect_err("it is refused").to_string()
}

fn names(ranking: &Ranking) -> Vec<&str> {
    ranking.entries.iter().map(|entry| entry.name.as_str()).collect()
}

fn compared(a: &Path, b: &Path, metric: &str) -> Comparison {
    compare(&[a.to_owned(), b.to_owned()], &Selection::default(), &[metric.to_owned()])
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn planners_of_one_batch_are_entries_and_the_best_is_first() {
    let scratch = Scratch::new();
    let all = [
        runs("lattice", 1..=40, |seed| Some(noise(seed) + 5 + seed % 2)),
        runs("prm-rs", 1..=40, |seed| Some(noise(seed) + 20 + seed % 3)),
        runs("hybrid-astar", 1..=40, |seed| Some(noise(seed) + 20 + (seed + 1) % 3)),
    ];
    let ranking = ranked(&[&scratch.batch("planners", &all.concat())], "saved");
    assert_eq!(ranking.better, Better::Higher);
    assert_eq!(names(&ranking)[2], "lattice");
    let ranks: Vec<_> = ranking.entries.iter().map(|entry| entry.ranks).collect();
    assert_eq!(ranks, [[1, 2], [1, 2], [3, 3]]);
    let groups: Vec<_> = ranking.entries.iter().map(|entry| entry.groups.as_deref()).collect();
    assert_eq!(groups, [Some("a"), Some("a"), Some("b")]);
    assert_eq!((ranking.runs, ranking.seeds.as_str(), ranking.worst), (40, "1..40", None));
    let queries = ranking.entries[0].queries;
    assert_eq!((queries.drives, queries.failed, queries.rescued), (4000 - 280, 280, 120));
}

#[test]
fn ranking_of_two_is_their_comparison() {
    let scratch = Scratch::new();
    let a = scratch.batch("a", &runs("prm-rs", 1..=60, |seed| Some(noise(seed) + 9)));
    let b = scratch.batch("b", &runs("lattice", 1..=60, |seed| Some(noise(seed * 3) + seed % 5)));
    for metric in ["saved", "truck_won", "all_out_s", "mean_response_s"] {
        let ranking = ranked(&[&b, &a], metric);
        let [first, second] = [&a, &b].map(|path| path.file_name().expect("a name").to_string_lossy().into_owned());
        let (first, second) = if names(&ranking)[0] == first {
            (&a, &b)
        } else {
            assert_eq!(names(&ranking)[0], second);
            (&b, &a)
        };
        let comparison = compared(first, second, metric);
        let judged = &comparison.against_a[0].judged[0];
        let pair = &ranking.pairs[0];
        assert_eq!(pair.contrast.difference, judged.contrast.difference, "{metric}");
        assert_eq!(pair.contrast.interval, judged.contrast.interval, "{metric}");
        assert_eq!(pair.contrast.p_value, judged.contrast.p_value, "{metric}");
        assert_eq!(pair.p_adjusted, Some(judged.p_adjusted.unwrap_or(1.0)), "{metric}");
        for (entry, mean) in ranking.entries.iter().zip(judged.contrast.means) {
            assert!((entry.mean - mean).abs() < 1e-9 * mean.abs(), "{metric}");
        }
    }
}

#[test]
fn order_in_which_entries_are_given_does_not_change_the_table() {
    let scratch = Scratch::new();
    let folders: Vec<PathBuf> = (0..5_u64)
        .map(|entry| {
            let saved = |seed: u64| (seed % 11 != entry).then(|| noise(seed * (entry + 1)) + entry % 3);
            scratch.batch(&format!("entry-{entry}"), &runs("prm-rs", 1..=30, saved))
        })
        .collect();
    for metric in ["saved", "burned", "all_out_s", "truck_won"] {
        let paths: Vec<&Path> = folders.iter().map(PathBuf::as_path).collect();
        let once = ranked(&paths, metric);
        for turned in 1..5 {
            let turned: Vec<&Path> = paths[turned..].iter().rev().chain(&paths[..turned]).copied().collect();
            assert_eq!(ranked(&turned, metric), once, "{metric}");
        }
    }
}

#[test]
fn thirty_entries_of_a_hundred_seeds_of_which_two_are_alike() {
    let scratch = Scratch::new();
    let saved = |entry: u64, seed: u64| noise(seed) + 2 * entry + (seed * (entry + 3)) % 13;
    // The last is a copy of the eighth.
    let strength = |entry: u64| if entry == 29 { 7 } else { entry };
    let folders: Vec<PathBuf> = (0..30)
        .map(|entry| {
            let of_entry = |seed| Some(saved(strength(entry), seed));
            scratch.batch(&format!("entry-{entry:02}"), &runs("prm-rs", 1..=100, of_entry))
        })
        .collect();
    let ranking = ranked(&folders.iter().map(PathBuf::as_path).collect::<Vec<_>>(), "saved");
    assert_eq!((ranking.entries.len(), ranking.pairs.len()), (30, 435));
    let place = |name: &str| names(&ranking).iter().position(|found| *found == name).expect("it is ranked");
    let (one, copy) = (place("entry-07"), place("entry-29"));
    assert_eq!(one + 1, copy, "equal means, in the order of the names");
    let [one, copy] = [one, copy].map(|place| &ranking.entries[place]);
    assert_eq!((one.ranks, &one.groups, one.mean), (copy.ranks, &copy.groups, copy.mean));
    let pair = ranking.pairs.iter().find(|pair| pair.contrast.difference == 0.0).expect("the copies");
    assert_eq!((pair.is_significant, pair.p_adjusted), (false, Some(1.0)));
    // Holm's method keeps the order of the p-values, and makes none of them smaller.
    let mut ordered: Vec<_> =
        ranking.pairs.iter().map(|it| (it.contrast.p_value.unwrap_or(1.0), it.p_adjusted)).collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(ordered.windows(2).all(|both| both[0].1 <= both[1].1));
    assert!(ordered.iter().all(|(p, adjusted)| adjusted.is_some_and(|adjusted| adjusted >= *p)));
    // An entry's own place is among its ranks, and groups are as wide as the ranks allow.
    for (place, entry) in ranking.entries.iter().enumerate() {
        assert!((entry.ranks[0]..=entry.ranks[1]).contains(&(place + 1)), "{entry:?}");
    }
}

#[test]
fn failed_runs_count_as_the_worst_and_no_pair_is_dropped() {
    let scratch = Scratch::new();
    let good = scratch.batch("good", &runs("prm-rs", 1..=20, |seed| Some(noise(seed))));
    let half = scratch.batch("half", &runs("prm-rs", 1..=20, |seed| (seed % 2 == 0).then(|| noise(seed) + 50)));
    let none = scratch.batch("none", &runs("prm-rs", 1..=20, |_| None));
    let ranking = ranked(&[&none, &half, &good], "saved");
    assert_eq!(names(&ranking), ["good", "half", "none"]);
    let failed: Vec<_> = ranking.entries.iter().map(|entry| entry.failed).collect();
    assert_eq!((failed, ranking.worst), (vec![0, 10, 20], Some(0.0)));
    assert!(ranking.pairs.iter().all(|pair| pair.contrast.pairs == 20));
    let saved: u64 = (1..=20).filter(|seed| seed % 2 == 0).map(|seed| noise(seed) + 50).sum();
    assert!((ranking.entries[1].mean - saved as f64 / 20.0).abs() < 1e-9);
    assert_eq!(ranking.entries[2].mean, 0.0);
    // Where lower is better the worst is the largest number of all.
    let ranking = ranked(&[&none, &half, &good], "burned");
    let max = (1..=20).map(|seed| 250 - noise(seed)).max().expect("there are seeds");
    assert_eq!((ranking.better, ranking.worst), (Better::Lower, Some(max as f64)));
    assert_eq!(names(&ranking)[2], "none");
    // Where all runs of all entries failed, all are equal.
    let other = scratch.batch("other", &runs("prm-rs", 1..=20, |_| None));
    let ranking = ranked(&[&other, &none], "saved");
    assert_eq!(names(&ranking), ["none", "other"]);
    assert!(ranking.entries.iter().all(|entry| entry.ranks == [1, 2] && entry.failed == 20));
}

#[test]
fn runs_without_a_value_count_as_the_worst_too() {
    let scratch = Scratch::new();
    let mut idle = runs("prm-rs", 1..=20, |seed| Some(noise(seed)));
    idle.iter_mut().filter(|run| run.seed > 5).for_each(|run| run.response_s = None);
    let [idle, busy] =
        [scratch.batch("idle", &idle), scratch.batch("busy", &runs("prm-rs", 1..=20, |seed| Some(noise(seed))))];
    let ranking = ranked(&[&idle, &busy], "mean_response_s");
    assert_eq!((names(&ranking), ranking.worst), (vec!["busy", "idle"], Some(20.0)));
    assert_eq!((ranking.entries[1].without_value, ranking.entries[1].failed), (15, 0));
    let never: Vec<Run> =
        runs("prm-rs", 1..=5, |_| Some(1)).into_iter().map(|run| Run { response_s: None, ..run }).collect();
    assert!(refusal(&[&scratch.batch("never", &never)], &request("mean_response_s")).contains("no run has a value"));
}

#[test]
fn times_that_were_cut_off_count_up_to_the_first_cut() {
    let scratch = Scratch::new();
    let mut late = runs("prm-rs", 1..=20, |seed| Some(noise(seed)));
    late.iter_mut().filter(|run| run.seed % 4 == 0).for_each(|run| run.all_out_s = None);
    late[0].saved = None;
    let [late, soon] =
        [scratch.batch("late", &late), scratch.batch("soon", &runs("prm-rs", 1..=20, |seed| Some(noise(seed))))];
    let ranking = ranked(&[&late, &soon], "all_out_s");
    assert_eq!((names(&ranking), ranking.worst), (vec!["soon", "late"], Some(3600.0)));
}

#[test]
fn one_entry_has_the_first_rank() {
    let scratch = Scratch::new();
    let ranking = ranked(&[&scratch.batch("alone", &runs("prm-rs", 1..=3, |seed| Some(noise(seed))))], "saved");
    assert_eq!((names(&ranking), ranking.entries[0].ranks, ranking.pairs.len()), (vec!["prm-rs"], [1, 1], 0));
}

#[test]
fn other_seeds_and_other_rules_are_refused_with_what_differs() {
    let scratch = Scratch::new();
    let same = |seed| Some(noise(seed));
    let a = scratch.batch("a", &runs("prm-rs", 1..=5, same));
    let b = scratch.batch("b", &runs("prm-rs", 1..=6, same));
    let usual = request("saved");
    let message = refusal(&[&a, &b], &usual);
    assert_eq!(message, "a and b do not have the same seeds: 1..5 and 1..6; expected all entries to have the same");
    for (options, fragment) in [
        (["fire.relight=true"], "fire.relight is false and true"),
        (["unimog.speed_mps=7"], "unimog.speed_mps is 8.0 and 7.0"),
        (["wumpus.goal=nearest-intact"], "wumpus.goal is random-intact and nearest-intact"),
        (["unimog.prm_rs.seconds_per_expansion=0.1"], "unimog.prm_rs.seconds_per_expansion is 0.0 and 0.1"),
    ] {
        let c = scratch.batch_of("c", &runs("prm-rs", 1..=5, same), &[], &options);
        let message = refusal(&[&a, &c], &usual);
        assert_eq!(message, format!("a and c did not play by the same rules: {fragment}"));
        let key = options[0].split('=').next().expect("a key");
        let freed = RankingRequest { free: vec![key.into()], ..usual.clone() };
        assert!(rank(&[a.clone(), c.clone()], &freed).is_ok(), "{key}");
        // What planning costs in simulated time is free only where it is named.
        let table = RankingRequest { free: vec![key.rsplit_once('.').expect("two steps").0.into()], ..usual.clone() };
        assert_eq!(rank(&[a.clone(), c], &table).is_err(), key.ends_with("seconds_per_expansion"), "{key}");
    }
    // What is the entry's own is not compared.
    let renamed = scratch.batch_of(
        "own",
        &runs("lattice", 1..=5, same),
        &["lattice"],
        &["unimog.prm_rs.samples=77", "name=other"],
    );
    let text = fs::read_to_string(renamed.join("runs.csv")).expect("it is there").replace("smoke,", "other,");
    fs::write(renamed.join("runs.csv"), text).expect("writable");
    assert_eq!(ranked(&[&a, &renamed], "saved").entries.len(), 2);
    // Other programs, other memory.
    for (from, to, fragment) in [
        ("\"program_version\": \"", "\"program_version\": \"9.", "the program's version is"),
        ("\"format\": 2", "\"format\": 1", "is not a batch plan"),
    ] {
        let d = scratch.batch("d", &runs("prm-rs", 1..=5, same));
        let plan = fs::read_to_string(d.join("plan.json")).expect("it is there").replacen(from, to, 1);
        fs::write(d.join("plan.json"), plan).expect("writable");
        match rank(&[a.clone(), d], &usual) {
            Err(error) => assert!(error.to_string().contains(fragment), "{error}"),
            Ok(_) => assert_eq!(fragment, "is not a batch plan", "an older format that can be read"),
        }
    }
    fs::remove_file(a.join("plan.json")).expect("it is there");
    assert!(refusal(&[&a], &usual).contains("are not known: there is no plan.json beside"));
}

#[test]
fn what_is_no_batch_or_no_metric_is_refused() {
    let scratch = Scratch::new();
    let a = scratch.batch("a", &runs("prm-rs", 1..=5, |seed| Some(noise(seed))));
    let usual = request("saved");
    let nowhere = scratch.path().join("nowhere");
    assert!(refusal(&[&nowhere], &usual).contains("expected a folder with a runs.csv, or such a file"));
    fs::create_dir(scratch.path().join("empty")).expect("writable");
    assert!(refusal(&[&a, &scratch.path().join("empty")], &usual).contains("expected a folder with a runs.csv"));
    let message = refusal(&[&a], &request("savd"));
    assert!(message.contains("there is no metric `savd`: did you mean `saved`?"), "{message}");
    assert_eq!(
        refusal(&[&a], &request("stray")),
        "`stray` has no built-in better side: add `--better higher` or `--better lower`"
    );
    let explicit = RankingRequest { better: Some(Better::Lower), ..request("stray") };
    assert!(rank(std::slice::from_ref(&a), &explicit).is_ok());
    assert!(refusal(&[&a, &a], &usual).ends_with("runs.csv is given twice; expected every entry once"));
    let free = RankingRequest { free: vec!["*".into()], ..usual.clone() };
    assert!(refusal(&[&a], &free).contains("`*` would free everything"));
    let mut twice = runs("prm-rs", 1..=5, |seed| Some(noise(seed)));
    twice.push(twice[0].clone());
    assert!(refusal(&[&scratch.batch("twice", &twice)], &usual).contains("seed 1 occurs twice"));
    let many = (0..101).fold(format!("{HEADER}\n"), |mut text, entry| {
        let row = Run::new("prm-rs", 1, Some(3)).row(1).replace("prm-rs", &format!("p{entry}"));
        write!(text, "{row}").expect("a string takes any text");
        text
    });
    let folder = scratch.batch("many", &runs("prm-rs", 1..=5, |seed| Some(noise(seed))));
    fs::write(folder.join("runs.csv"), many).expect("writable");
    let message = refusal(&[&folder], &usual);
    assert!(message.contains("plan.json does not go with") || message.contains("expected at most 100"), "{message}");
}

#[test]
fn programs_that_are_kept_from_run_to_run_are_refused() {
    let scratch = Scratch::new();
    let entry = |name: &str, table: &[&str]| {
        let options = [&["planner.mine.command=[\"a\"]"], table].concat();
        scratch.batch_of(name, &runs("mine", 1..=5, |seed| Some(noise(seed))), &["mine"], &options)
    };
    let kept = entry("kept", &["planner.mine.reuse=true"]);
    let message = refusal(&[&kept], &request("saved"));
    assert!(message.starts_with("mine has `reuse = true` in [planner.mine]"), "{message}");
    // Limits of programs are rules, commands are not.
    let one = entry("one", &["planner.mine.query_cpu_s=1"]);
    let two = entry("two", &["planner.mine.query_cpu_s=1", "planner.mine.settings={ range_m = 3 }"]);
    let three = entry("three", &["planner.mine.query_cpu_s=2"]);
    assert_eq!(ranked(&[&one, &two], "saved").entries.len(), 2);
    let message = refusal(&[&one, &two, &three], &request("saved"));
    assert!(message.ends_with("planner.*.query_cpu_s of their programs is 1.0 and 2.0"), "{message}");
    let freed = RankingRequest { free: vec!["planner.*".into()], ..request("saved") };
    assert_eq!(rank(&[one.clone(), two, three], &freed).expect("limits may differ").entries.len(), 3);
    // Prices are no limits that `planner.*` frees.
    let four = entry("four", &["planner.mine.query_cpu_s=1", "planner.mine.expansions_per_query=5"]);
    let message = rank(&[one, four], &freed).expect_err("prices are equal for all").to_string();
    assert!(message.ends_with("planner.*.expansions_per_query of their programs is 0 and 5"), "{message}");
}

#[test]
fn rows_whose_bushes_do_not_add_up_are_refused_and_their_entry_can_be_left_out() {
    let scratch = Scratch::new();
    let honest = scratch.batch("honest", &runs("prm-rs", 1..=5, |seed| Some(noise(seed))));
    let sly = scratch.batch("sly", &runs("lattice", 1..=5, |seed| Some(noise(seed))));
    for (folder, more) in [(&honest, 0), (&sly, 7)] {
        let text = fs::read_to_string(folder.join("runs.csv")).expect("it is there");
        let rows = text.lines().enumerate().map(|(line, row)| match line {
            0 => format!("{row},obstacles\n"),
            3 => format!("{row},{}\n", 250 + more),
            _ => format!("{row},250\n"),
        });
        fs::write(folder.join("runs.csv"), rows.collect::<String>()).expect("writable");
    }
    let message = refusal(&[&honest, &sly], &request("saved"));
    assert_eq!(
        message,
        "sly, seed 3: intact, burning, burned_out and extinguished add up to 250, and there are 257 obstacles, so no \
         run wrote this row"
    );
    let without = |name: &str| RankingRequest { without: vec![name.into()], ..request("saved") };
    let ranking = rank(&[honest.clone(), sly.clone()], &without("sly")).expect("the other is fine");
    assert_eq!(names(&ranking), ["honest"]);
    assert_eq!(ranking.entries[0].run_numbers.len(), 5);
    assert_eq!(refusal(&[&honest, &sly], &without("sli")), "there is no entry `sli`: did you mean `sly`?");
    assert_eq!(refusal(&[&sly], &without("lattice")), "no entry is left; expected at least one that is not left out");
}

#[test]
fn what_varies_within_entries_is_a_mean_over_strata() {
    let scratch = Scratch::new();
    let rows = |planner: &'static str, more: u64| -> Vec<Run> {
        runs(planner, 1..=20, |seed| Some(noise(seed) + more + seed % 3))
    };
    let planners = ["prm-rs", "lattice"];
    let folder = scratch.batch_of("sweep", &[], &planners, &["fire.burn_out_s=30,40"]);
    let mut text = HEADER.replacen("planner,", "planner,fire.burn_out_s,", 1) + "\n";
    for (planner, more) in planners.into_iter().zip([9, 0]) {
        for burn_out in [30, 40] {
            for run in rows(planner, more + burn_out) {
                text += &run.row(1).replacen(&format!("{planner},"), &format!("{planner},{burn_out},"), 1);
            }
        }
    }
    fs::write(folder.join("runs.csv"), text).expect("writable");
    let ranking = ranked(&[&folder], "saved");
    assert_eq!((names(&ranking), ranking.runs, ranking.strata), (vec!["prm-rs", "lattice"], 40, 2));
    assert_eq!(ranking.columns, ["fire.burn_out_s"]);
    assert_eq!(ranking.pairs[0].contrast.difference, -9.0);
    let only = RankingRequest { only: vec![("fire.burn_out_s".into(), "30".into())], ..request("saved") };
    assert_eq!(rank(&[folder], &only).expect("one stratum").strata, 1);
}
