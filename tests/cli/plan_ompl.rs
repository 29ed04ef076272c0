//! The log of `wildfire plan --ompl` under a reader of that format.
//!
//! The reader knows what OMPL's `scripts/ompl_benchmark_statistics.py` expects: which line stands where, which words it
//! begins or ends with, and how values are divided.

use crate::story::Story;

/// A planner's runs: names and types of what is known, and the values.
struct Runs {
    planner: String,
    settings: Vec<(String, String)>,
    properties: Vec<(String, String)>,
    values: Vec<Vec<Option<f64>>>,
}

struct Log {
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
    fn ending(&mut self, words: &str) -> &'a str {
        let line = self.next();
        assert!(line.ends_with(words), "`{line}` does not end with `{words}`");
        line.split_whitespace().next().expect("a word")
    }

    fn count(&mut self, words: &str) -> usize {
        self.ending(words).parse().expect("a count")
    }

    /// What follows these words.
    fn beginning(&mut self, words: &str) -> &'a str {
        let line = self.next();
        line.strip_prefix(words).unwrap_or_else(|| panic!("`{line}` does not begin with `{words}`")).trim()
    }
}

fn read(text: &str) -> Log {
    let mut lines = Lines(text.lines());
    assert_eq!(lines.next().split_whitespace().nth(1), Some("version"));
    assert!(!lines.beginning("Experiment ").contains(char::is_whitespace), "the name is the last word of its line");
    for _ in 0..lines.count(" experiment properties") {
        assert!(lines.next().contains(" = "));
    }
    lines.beginning("Running on ");
    lines.beginning("Starting at ");
    assert_eq!(lines.next(), "<<<|");
    while lines.next() != "|>>>" {}
    let seed = lines.ending(" is the random seed").parse().expect("a seed");
    for words in [" seconds per run", " MB per run"] {
        lines.ending(words).parse::<f64>().expect("a number");
    }
    let runs_per_planner = lines.count(" runs per planner");
    lines.ending(" seconds spent to collect the data").parse::<f64>().expect("a number");
    let enums = (0..lines.count(" enum type")).map(|_| lines.next().split('|').map(str::to_owned).collect()).collect();
    let planners = (0..lines.count(" planners")).map(|_| read_planner(&mut lines)).collect();
    assert_eq!(lines.0.next(), None, "nothing follows the last planner");
    Log { seed, runs_per_planner, enums, planners }
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
        let known = ["REAL", "INTEGER", "BOOLEAN", "ENUM"];
        assert!(runs.properties.iter().all(|(_, kind)| known.contains(&kind.as_str())));
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
