//! Files in the folder of a batch: plan, journal, tables. And plan files.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};

use wildfire::batch::comparison::{Selection, compare};
use wildfire::batch::execute::{
    Append, Batch, Disk, JournalIndex, OutputFolder, RUNS_FILE, STATES_PARQUET, Whole, batch_status,
};
use wildfire::batch::plan::{BatchPlan, BatchRequest, PLAN_FILE, PLAN_TEMPLATE, PlanError, Slice, Sweep};
use wildfire::batch::report::{PaperCharts, ReportParts, SelectedQuantities, merge, write_report};
use wildfire::batch::table::{FinishedBatch, run_column};
use wildfire::picture::charts::PaperSize;
use wildfire::scenario::ScenarioText;
use wildfire::sim::CustomRegistry;

use super::fuzz::text::mutated;
use super::fuzz::{Case, Law, below, chance, one_of};
use super::grammar::refusal_names_its_place;
use super::maps::check_message;

const JOURNAL: &str = "runs.journal";

/// A batch that was run: its plan and what it wrote.
struct Sample {
    plan: BatchPlan,
    plan_json: Vec<u8>,
    journal: Vec<u8>,
    runs_csv: Vec<u8>,
    states: Vec<u8>,
}

static SAMPLES: LazyLock<Vec<Sample>> = LazyLock::new(|| {
    vec![sample(&["duration_s=20", "field.coverage=0.05,0.1"], "1..2"), sample(&["wumpus=[]", "duration_s=5"], "7,9")]
});

fn sample(options: &[&str], seeds: &str) -> Sample {
    let mut request =
        BatchRequest { scenarios: vec!["smoke".into()], seeds: seeds.parse().ok(), ..BatchRequest::default() };
    for option in options {
        request.add_option(option).expect("an option");
    }
    let plan = request.resolve(false).expect("a small batch");
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = OutputFolder::named(&scratch.path().join("batch"), false).expect("a new folder");
    let mut batch = Batch::begin(plan.clone(), folder).expect("it begins");
    batch.run(&CustomRegistry::default(), 1, &Arc::new(AtomicBool::new(false)), |_| {}).expect("all runs take place");
    batch.finish(&AtomicBool::new(false)).expect("its tables are written");
    let read = |name: &str| fs::read(scratch.path().join("batch").join(name)).expect("it was written");
    Sample {
        plan_json: read(PLAN_FILE),
        journal: read(JOURNAL),
        runs_csv: read(RUNS_FILE),
        states: read(STATES_PARQUET),
        plan,
    }
}

/// A disk that takes everything and keeps nothing.
struct Nowhere;

impl Disk for Nowhere {
    fn whole_file(&self, _: &Path) -> io::Result<Box<dyn Whole>> {
        Ok(Box::new(Sunk))
    }

    fn journal(&self, file: File) -> Box<dyn Append> {
        Box::new(file)
    }
}

struct Sunk;

impl Write for Sunk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Whole for Sunk {
    fn finish(self: Box<Self>) -> io::Result<()> {
        Ok(())
    }
}

/// Checks that a plan of a batch is read or refused, and is the same when it is written and read again.
pub fn frozen_plan(case: &mut Case<'_>) -> Law {
    let samples: Vec<&[u8]> = SAMPLES.iter().map(|sample| &sample.plan_json[..]).collect();
    case.input = mutated(&mut case.dice, &samples, &["\"swept\"", "\"variants\": []", "{\"Real\": 1}", "null,"]);
    let refusal = match read_plan(case) {
        Err(PlanError::Tampered { found, expected, .. }) => {
            // The hash is put right, so that what it covers is looked at.
            let text = String::from_utf8_lossy(&case.input).replace(&expected, &found);
            case.input = text.into_bytes();
            read_plan(case)
        }
        read => read,
    };
    match refusal {
        Ok(plan) => {
            case.count("plans of batches accepted");
            plan_comes_back(case, &plan)
        }
        Err(refusal) => check_message(&refusal.to_string()),
    }
}

fn read_plan(case: &Case<'_>) -> Result<BatchPlan, PlanError> {
    case.write(PLAN_FILE, &case.input);
    BatchPlan::read(case.folder)
}

fn plan_comes_back(case: &Case<'_>, plan: &BatchPlan) -> Law {
    case.write(PLAN_FILE, plan.to_json().as_bytes());
    let back = BatchPlan::read(case.folder).map_err(|error| format!("a plan that was written is refused: {error}"))?;
    if back != *plan {
        return Err("another plan comes back".into());
    }
    let last = plan.run(plan.count());
    last.repeating_command();
    plan.title(last.variant);
    Ok(())
}

const PLANS: &[&str] = &[
    PLAN_TEMPLATE,
    "scenarios = ['smoke']\nseeds = '1..9'\nplanners = ['hybrid-astar', 'prm+primitives']\nrecord = 'all'\n\
     set = { fire.relight = true }\n[[sweep]]\nfield.coverage = [0.05, 0.1]\n",
    "seeds = [1, 5, 9]\n[[sweep]]\nunimog.speed_mps = [6, 10]\nwumpus.speed_mps = [1, 2]\n",
    "scenarios = ['smoke', 'contest']\nset = { name = 'x' }\n",
];

const PLAN_TOKENS: &[&str] = &[
    "[[sweep]]\n",
    "set = ",
    "seeds = ",
    "'1..1000'",
    "planners = ",
    "record = 'failed'\n",
    "scenarios = ['smoke']\n",
    "field.map = ['x']",
    "unimog = ",
    "wumpus.0.speed_mps = [1, 2, 3]\n",
    "duration_s = [1, 2]\n",
    "name = ['a', 'b']\n",
];

/// Checks that a plan file is read or refused, and that its plan is the same when it is written and read again.
pub fn plan_file(case: &mut Case<'_>) -> Law {
    case.input = mutated(&mut case.dice, PLANS, PLAN_TOKENS);
    let path = case.write("plan.toml", &case.input);
    let source = match ScenarioText::open(path.to_str().expect("scratch folders have plain names")) {
        Ok(source) => source,
        Err(refusal) => return refusal_names_its_place(&refusal),
    };
    let request = match BatchRequest::from_text(&source) {
        Ok(Some(request)) => request,
        Ok(None) => return Ok(()),
        Err(refusal) => return check_message(&refusal.to_string()),
    };
    case.count("plan files accepted");
    let variants: usize = request.sweeps.iter().map(|sweep| sweep.steps().len()).product();
    if variants * request.scenarios.len() > 8 {
        return Ok(());
    }
    match request.resolve(false) {
        Ok(plan) => plan_comes_back(case, &plan),
        Err(refusal) => check_message(&refusal.to_string()),
    }
}

/// Checks options of the command line: changes, sweeps and planners.
pub fn batch_options(case: &mut Case<'_>) -> Law {
    const OPTIONS: &[&str] = &[
        "field.coverage=0.05,0.1",
        "unimog.prm.samples=100",
        "unimog.planner=prm-rs,\"lattice\"",
        "unimog.0.start={ x_m = 1, y_m = 2 },{ x_m = 3, y_m = 4 }",
        "field.shapes=[\"I\", 'O'],[]",
        "a=1,,2",
    ];
    case.input = mutated(&mut case.dice, OPTIONS, &[",", "=", "unimog", ".0.", "'", "\"", "[", "{", "}}"]);
    let option = String::from_utf8_lossy(&case.input).into_owned();
    let mut request = BatchRequest { scenarios: vec!["smoke".into()], ..BatchRequest::default() };
    let planners: Vec<String> = option.split(',').map(str::to_owned).collect();
    let taken = request.add_option(&option).and_then(|()| match below(&mut case.dice, 4) {
        0 => request.add_planners(&planners),
        _ => Ok(()),
    });
    let sweeps =
        |request: &BatchRequest| request.sweeps.iter().map(|sweep: &Sweep| sweep.steps().len()).product::<usize>();
    match taken {
        Err(refusal) => check_message(&refusal.to_string()),
        Ok(()) if sweeps(&request) > 4 || chance(&mut case.dice, 80) => Ok(()),
        Ok(()) => match request.resolve(false) {
            Ok(plan) => plan_comes_back(case, &plan),
            Err(refusal) => check_message(&refusal.to_string()),
        },
    }
}

/// Checks that a journal with right checksums about anything is read or refused, and so are the tables made from it.
pub fn journal(case: &mut Case<'_>) -> Law {
    let sample = one_of(&mut case.dice, &SAMPLES);
    let mut lines: Vec<Vec<u8>> = sample.journal.split(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
    lines.pop();
    for _ in 0..1 + below(&mut case.dice, 2) {
        let at = below(&mut case.dice, lines.len());
        match below(&mut case.dice, 8) {
            0 => lines[at] = mutated(&mut case.dice, &lines, &[]),
            1 => lines.push(lines[at].clone()),
            2 if lines.len() > 1 => drop(lines.remove(at)),
            _ => {
                let contents: Vec<&[u8]> = lines.iter().map(|line| line.get(9..).unwrap_or_default()).collect();
                let json = mutated(&mut case.dice, &contents[at..=at], &["null", "{}", "[]", "\"done\"", "\"run\":1"]);
                lines[at] = [format!("{:08x} ", crc32fast::hash(&json)).as_bytes(), &json].concat();
            }
        }
    }
    case.input = lines.iter().flat_map(|line| [line, &b"\n"[..]].concat()).collect();
    if case.chance(10) {
        let length = below(&mut case.dice, case.input.len() + 1);
        case.input.truncate(length);
    }
    let path = case.write(JOURNAL, &case.input);
    let file = File::open(&path).map_err(|error| error.to_string())?;
    let read = JournalIndex::read(&path, &file, &sample.plan, Slice::WHOLE);
    match read {
        Err(refusal) => return check_message(&refusal.to_string()),
        Ok(index) if index.stored() > index.count() => return Err("it holds more runs than there are".into()),
        Ok(index) if index.missing(|_| true).count() as u64 + index.stored() != index.count() => {
            return Err("runs that it holds are missing".into());
        }
        Ok(_) => case.count("journals accepted"),
    }
    if case.chance(70) {
        return Ok(());
    }
    case.write(PLAN_FILE, &sample.plan_json);
    let folder = OutputFolder::shared(case.folder).map_err(|error| error.to_string())?;
    batch_status(&folder).map_err(|error| format!("a journal that can be read has no status: {error}"))?;
    match merge(&folder, &Nowhere, &AtomicBool::new(false)) {
        Ok(_) => {
            case.count("journals merged");
            Ok(())
        }
        Err(refusal) => check_message(&refusal.to_string()),
    }
}

/// Checks that tables of runs are compared, or refused.
pub fn compared_tables(case: &mut Case<'_>) -> Law {
    let samples: Vec<&[u8]> = SAMPLES.iter().map(|sample| &sample.runs_csv[..]).collect();
    let tokens = ["done,", "panicked,", "smoke,", "\"\"", "prm-rs", "intact", "seed,", "status,"];
    case.input = mutated(&mut case.dice, &samples, &tokens);
    let one = case.write("one.csv", &case.input);
    let other = *one_of(&mut case.dice, &samples);
    let other = case.write("other.csv", other);
    let paths: Vec<PathBuf> = if case.chance(70) { vec![one, other] } else { vec![one] };
    let by = ["planner", "field.coverage", "seed", "nothing"];
    let by = case.chance(30).then(|| ((*one_of(&mut case.dice, &by)).to_owned(), Vec::new()));
    match compare(&paths, &Selection { by, only: Vec::new() }, &[]) {
        Ok(_) => {
            case.count("comparisons made");
            Ok(())
        }
        Err(refusal) => check_message(&refusal.to_string()),
    }
}

/// Checks that the rows of a finished batch are read in their order, or refused.
pub fn finished_rows(case: &mut Case<'_>) -> Law {
    let sample = one_of(&mut case.dice, &SAMPLES);
    case.input = mutated(&mut case.dice, &[&sample.runs_csv], &["done,", "inf,", "nan,", "\"", "1e308,"]);
    write_batch(case, sample, &sample.states);
    let batch = FinishedBatch::open(case.folder).map_err(|error| error.to_string())?;
    let mut rows = match batch.rows() {
        Ok(rows) => rows.ok_or("there are no rows")?,
        Err(refusal) => return check_message(&refusal.to_string()),
    };
    for run in batch.runs() {
        match rows.next(&run) {
            Ok(row) => {
                row.is_done();
                row.number(run_column("intact"));
            }
            Err(refusal) => return check_message(&refusal.to_string()),
        }
    }
    case.count("finished batches accepted");
    Ok(())
}

fn write_batch(case: &Case<'_>, sample: &Sample, states: &[u8]) {
    case.write(PLAN_FILE, &sample.plan_json);
    case.write(RUNS_FILE, &case.input);
    case.write(STATES_PARQUET, states);
}

/// Checks that a report is written of anything that can be read, or is refused.
pub fn report(case: &mut Case<'_>) -> Law {
    let sample = one_of(&mut case.dice, &SAMPLES);
    let is_of_states = case.chance(70);
    let states = if is_of_states { mutated(&mut case.dice, &[&sample.states], &[]) } else { sample.states.clone() };
    case.input = if is_of_states {
        sample.runs_csv.clone()
    } else {
        mutated(&mut case.dice, &[&sample.runs_csv], &["inf", "1e308"])
    };
    write_batch(case, sample, &states);
    if is_of_states {
        case.input = states;
    }
    let batch = FinishedBatch::open(case.folder).map_err(|error| error.to_string())?;
    let size = PaperSize { width_mm: 88.0, font_pt: 8.0 };
    let paper = PaperCharts { size, pdf: true, pgf: true };
    let quantities = SelectedQuantities::default();
    match write_report(&batch, &ReportParts { playing: &[], field: None, quantities: &quantities, paper }) {
        Ok(_) => {
            case.count("reports written");
            Ok(())
        }
        Err(refusal) => check_message(&refusal.to_string()),
    }
}
