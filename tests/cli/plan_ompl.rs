//! The log of `wildfire plan --ompl` under a reader of that format.
//!
//! The reader knows what OMPL's `scripts/ompl_benchmark_statistics.py` expects: which line stands where, which words it
//! begins or ends with, and how values are divided. What else the format's grammar allows, this program does not write.

use crate::children::output_of;
use crate::story::{Answer, Story};

/// A planner's runs: names and types of what is known, and the values.
struct Runs {
    planner: String,
    settings: Vec<(String, String)>,
    properties: Vec<(String, String)>,
    values: Vec<Vec<Option<f64>>>,
}

struct Log {
    date: String,
    hardware: String,
    seconds_per_run: f64,
    megabytes_per_run: f64,
    seed: u64,
    runs_per_planner: usize,
    /// Words of the enumerated properties, the name first.
    enums: Vec<Vec<String>>,
    planners: Vec<Runs>,
}

/// Lines of a log, taken one by one.
struct Lines<'a>(std::str::Lines<'a>);

impl<'a> Lines<'a> {
    fn next(&mut self) -> &'a str {
        self.0.next().expect("the log goes on")
    }

    /// The first word of a line that ends with these words.
    fn ending(&mut self, suffix: &str) -> &'a str {
        let line = self.next();
        assert!(line.ends_with(suffix), "`{line}` does not end with `{suffix}`");
        line.split_whitespace().next().expect("a word")
    }

    fn count(&mut self, suffix: &str) -> usize {
        self.ending(suffix).parse().expect("a count")
    }

    /// The lines between the signs of a text of several lines; a line that begins as its end does would be its end.
    fn block(&mut self) -> String {
        assert_eq!(self.next(), "<<<|");
        let lines = std::iter::from_fn(|| Some(self.next()).filter(|line| !line.starts_with("|>>>")));
        lines.collect::<Vec<_>>().join("\n")
    }

    /// What follows these words.
    fn beginning(&mut self, prefix: &str) -> &'a str {
        let line = self.next();
        line.strip_prefix(prefix).unwrap_or_else(|| panic!("`{line}` does not begin with `{prefix}`")).trim()
    }
}

fn read(text: &str) -> Log {
    let mut lines = Lines(text.lines());
    assert_eq!(lines.next().split_whitespace().nth(1), Some("version"));
    assert!(!lines.beginning("Experiment ").contains(char::is_whitespace), "the name is the last word of its line");
    for _ in 0..lines.count(" experiment properties") {
        assert!(lines.next().contains(" = "));
    }
    assert!(!lines.beginning("Running on ").contains(char::is_whitespace), "the host is the last word of its line");
    let date = lines.beginning("Starting at ").to_owned();
    // The problems, and the processors.
    lines.block();
    let hardware = lines.block();
    let seed = lines.ending(" is the random seed").parse().expect("a seed");
    let mut limit = |suffix: &str| lines.ending(suffix).parse::<f64>().expect("a number");
    let (seconds_per_run, megabytes_per_run) = (limit(" seconds per run"), limit(" MB per run"));
    let runs_per_planner = lines.count(" runs per planner");
    lines.ending(" seconds spent to collect the data").parse::<f64>().expect("a number");
    let enums = (0..lines.count(" enum type")).map(|_| lines.next().split('|').map(str::to_owned).collect()).collect();
    let planners = (0..lines.count(" planners")).map(|_| read_planner(&mut lines)).collect();
    assert_eq!(lines.0.next(), None, "nothing follows the last planner");
    Log { date, hardware, seconds_per_run, megabytes_per_run, seed, runs_per_planner, enums, planners }
}

fn read_planner(lines: &mut Lines) -> Runs {
    let pair = |(one, two): (&str, &str)| (one.to_owned(), two.to_owned());
    let planner = lines.next().to_owned();
    let settings = (0..lines.count(" common properties")).map(|_| lines.next().split_once(" = ").map(pair));
    let settings = settings.collect::<Option<Vec<_>>>().expect("a name and a value");
    let properties = (0..lines.count(" properties for each run")).map(|_| lines.next().rsplit_once(' ').map(pair));
    let properties = properties.collect::<Option<Vec<_>>>().expect("a name and a type");
    let value = |text: &str| (!text.is_empty()).then(|| text.parse().expect("values are numbers"));
    let values = (0..lines.count(" runs")).map(|_| {
        let line = lines.next();
        let divided: Vec<&str> = line.split("; ").collect();
        assert_eq!(divided.last(), Some(&""), "every value is followed by a semicolon and a space");
        divided[..divided.len() - 1].iter().copied().map(value).collect()
    });
    let values = values.collect();
    assert_eq!(lines.next(), ".");
    Runs { planner, settings, properties, values }
}

#[test]
fn log_reads_as_one_of_ompl() {
    let story = Story::begin();
    story.file(
        "mine.json",
        "{\"field\": \"|>>> no end\", \"n\": 20, \"cells_cr\": [[10, 10]], \"start\": [20, 20, 0],\n\
         \"goals\": [{\"pose\": [52, 52, 0]}, {\"pose\": [70, 70, 1]}]}",
    );
    let names = ["lattice", "hybrid-astar"];
    story
        .tell(&["plan", "mine.json", "--planner", "lattice,hybrid-astar", "--seed", "9", "--ompl", "a.log"])
        .expect_code(0);
    let log = read(&story.read("a.log"));
    assert_eq!((log.seed, log.runs_per_planner), (9, 2));
    assert_eq!(log.planners.iter().map(|runs| runs.planner.as_str()).collect::<Vec<_>>(), names);
    let [status] = &log.enums[..] else { panic!("one property is enumerated") };
    assert_eq!(status[0], "status");
    for runs in &log.planners {
        assert!(runs.properties.iter().any(|property| *property == ("time".into(), "REAL".into())));
        let kinds = ["REAL", "INTEGER", "BOOLEAN", "ENUM"];
        assert!(runs.properties.iter().all(|(_, kind)| kinds.contains(&kind.as_str())));
        assert!(runs.values.iter().all(|values| values.len() == runs.properties.len()));
        assert_eq!(runs.values.len(), 2);
    }
    let hybrid = &log.planners[1];
    assert!(hybrid.settings.iter().any(|(name, value)| name == "hybrid.headings" && value == "24"));
    let value = |run: usize, name: &str| {
        let at = hybrid.properties.iter().position(|(property, _)| property == name).expect("it is known");
        hybrid.values[run][at]
    };
    let status_of = |run| status[1 + value(run, "status").expect("a status") as usize].as_str();
    assert_eq!((value(0, "solved"), value(0, "solution length"), status_of(0)), (Some(0.0), None, "Invalid goal"));
    assert_eq!(
        (value(1, "solved"), value(1, "correct solution"), status_of(1)),
        (Some(1.0), Some(1.0), "Exact solution")
    );
    assert!(value(1, "solution length").is_some_and(|metres| metres > 70.0));
    assert!(value(1, "time").is_some_and(|seconds| seconds > 0.0));
}

/// The words after `plan`, and the day on which they are said.
fn logged(story: &Story, args: &[&str], day: &str) -> Log {
    let mut command = story.command(&[&["plan"], args, &["--ompl", "a.log"]].concat());
    let output = output_of(command.env("SOURCE_DATE_EPOCH", day));
    Answer::of(&output).expect_code(0);
    read(&story.read("a.log"))
}

#[test]
fn day_limits_and_processors_are_those_of_the_experiment() {
    let story = Story::begin();
    let log = logged(&story, &["--goals", "2", "--memory", "3GB"], "951782400");
    assert_eq!(log.date, "2000-02-29T00:00:00");
    assert_eq!((log.megabytes_per_run, log.seconds_per_run.fract()), (3000.0, 0.0));
    let times = log.planners.iter().flat_map(|runs| {
        let at = runs.properties.iter().position(|(name, _)| name == "time").expect("it is known");
        runs.values.iter().map(move |values| values[at].expect("it took time"))
    });
    assert!(log.seconds_per_run >= 1.0 && times.into_iter().all(|time| time <= log.seconds_per_run));
    assert!(log.hardware.contains("Architecture: "), "{}", log.hardware);
    #[cfg(all(target_os = "linux", target_arch = "x86_64"))]
    assert!(log.hardware.contains("Model name: "), "{}", log.hardware);
    let mut wrong = story.command(&["plan", "--goals", "1", "--ompl", "b.log"]);
    Answer::of(&output_of(wrong.env("SOURCE_DATE_EPOCH", "monday")))
        .expect_code(2)
        .expect_complaint(&["SOURCE_DATE_EPOCH is `monday`; expected whole seconds since 1970"]);
    assert!(!story.path("b.log").exists());
    // Without the variable it is the day on which it was written.
    story.tell(&["plan", "--goals", "1", "--ompl", "c.log"]).expect_code(0);
    let date = read(&story.read("c.log")).date;
    assert!(date.len() == 19 && date.as_str() > "2025-01-01T00:00:00", "{date}");
}

#[test]
fn benchmark_is_one_log_in_which_settings_tell_variants_apart() {
    let story = Story::begin();
    let args =
        ["--seeds", "3,4", "--goals", "2", "--set", "field.coverage=0.02,0.05", "--planner", "hybrid-astar,lattice"];
    let log = logged(&story, &args, "0");
    assert_eq!((log.seed, log.runs_per_planner), (3, 4));
    let coverage = |runs: &Runs| {
        let swept = runs.settings.iter().find(|(name, _)| name == "field.coverage");
        swept.expect("it is among the settings").1.clone()
    };
    let planners: Vec<_> = log.planners.iter().map(|runs| (runs.planner.as_str(), coverage(runs))).collect();
    let expected =
        ["0.02", "0.05"].map(|value| ["hybrid-astar", "lattice"].map(|name| (name, value.to_owned()))).concat();
    assert_eq!(planners, expected);
    for runs in &log.planners {
        let at = runs.properties.iter().position(|(name, _)| name == "seed").expect("it is known");
        let seeds: Vec<_> = runs.values.iter().map(|values| values[at]).collect();
        assert_eq!(seeds, [3.0, 3.0, 4.0, 4.0].map(Some));
    }
}
