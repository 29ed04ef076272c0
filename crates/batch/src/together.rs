//! Vehicles that plan together: what a planner answers for an instance, as the independent check sees it, a row for each
//! instance, and the figures of all.

use std::io;
use std::path::Path;
use std::time::Duration;

use serde::{Serialize, Serializer};

use wildfire_base::document::number::{count, optional, percent, rounded};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::object;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_base::untrusted::{spreadsheet_cell, visible_start};
use wildfire_base::whole_file::WholeFile;
use wildfire_planning::judge::lower_bound_ratio;
use wildfire_planning::together::files::{read_solution, write_solution};
use wildfire_planning::together::judge::{self, RuleBreach, Schedule, ScheduleCheck};
use wildfire_planning::together::{Instance, Mode, PlanTogether, RepairEffort, RepairMethod, Route, Unsolved, plan};

use crate::plan::PROGRAM_VERSION;

/// Most sentences about faults of one solution.
const SHOWN_FAULTS: usize = 20;

const LEGEND: [&str; 4] = [
    "Flowtime: metres driven by all vehicles, a wait counted as 2.118 m; x bound: over the sum of their shortest \
     Reeds-Shepp curves without obstacles.",
    "Makespan: the largest flowtime of a vehicle; x bound: over the longest of these curves. Rows of several instances have \
     medians.",
    "Blocked: a start or a goal is on an obstacle, so the instance has no solution. Solved: share of the others.",
    "Violations: faults that an independent check found in the solutions.",
];

/// A solution as the independent check sees it.
#[derive(Debug)]
pub struct CheckedSolution {
    faults: Vec<RuleBreach>,
    figures: Option<SolutionFigures>,
}

/// The figures of a solution whose steps can all be driven.
#[derive(Clone, Copy, Debug, Serialize)]
struct SolutionFigures {
    flowtime_m: f64,
    flowtime_over_bound: f64,
    makespan_m: f64,
    makespan_over_bound: f64,
    cost: f64,
    steps: usize,
}

impl CheckedSolution {
    /// Checks the schedules of vehicles, those of the instance or of a file.
    pub fn new(instance: &Instance, mode: Mode, schedules: &[Schedule]) -> Self {
        let ScheduleCheck { faults, routes } = judge::check(instance, mode, schedules);
        Self { faults, figures: routes.map(|routes| SolutionFigures::new(instance, &routes)) }
    }
}

impl SolutionFigures {
    fn new(instance: &Instance, routes: &[Route]) -> Self {
        let (sum_m, max_m) = instance.bounds_m();
        let flowtimes = routes.iter().map(Route::flowtime_m);
        let flowtime_m = flowtimes.clone().sum::<f64>();
        let makespan_m = flowtimes.fold(0.0, f64::max);
        // Vehicles that are all at their goals have a bound of 0.
        let over = |metres: f64, bound_m: f64| lower_bound_ratio(metres, bound_m).unwrap_or(1.0);
        Self {
            flowtime_m,
            flowtime_over_bound: over(flowtime_m, sum_m),
            makespan_m,
            makespan_over_bound: over(makespan_m, max_m),
            cost: routes.iter().map(Route::cost).sum(),
            steps: routes.iter().map(|route| route.steps.len()).max().unwrap_or(0),
        }
    }
}

/// An instance and its solution; a row of the table.
#[derive(Debug, Serialize)]
pub struct InstanceRow {
    instance: String,
    width_m: f64,
    height_m: f64,
    obstacles: usize,
    vehicles: usize,
    mode: Mode,
    method: RepairMethod,
    seed: u64,
    /// `solved`, `blocked` or `unsolved`.
    status: &'static str,
    message: String,
    flowtime_m: Option<f64>,
    flowtime_over_bound: Option<f64>,
    makespan_m: Option<f64>,
    makespan_over_bound: Option<f64>,
    cost: Option<f64>,
    steps: Option<usize>,
    violations: usize,
    expansions: u64,
    rounds: u32,
    cpu_s: f64,
}

/// A planner's answer for an instance.
#[derive(Debug)]
pub struct InstanceAnswer {
    pub row: InstanceRow,
    /// The text of the solution's file, if there is one.
    pub solution: Option<String>,
}

impl InstanceAnswer {
    /// Plans for the vehicles of an instance within a limit of CPU time, and checks the solution as it is written.
    pub fn new(path: &Path, instance: &Instance, settings: &PlanTogether, limit: Duration) -> Self {
        let mut stopwatch = CpuStopwatch::start();
        let mut spent = Duration::ZERO;
        let mut is_stopped = || {
            spent += stopwatch.elapsed_since_last();
            spent >= limit
        };
        let mut effort = RepairEffort::default();
        let found = plan(instance, settings, &mut is_stopped, &mut effort);
        // The time since the planner's last question belongs to it too.
        is_stopped();
        let cpu_s = spent.as_secs_f64();
        let solution = found.as_ref().ok().map(|routes| write_solution(instance, routes, cpu_s));
        let checked = solution.as_ref().map(|text| {
            // The text is checked, as its numbers are those that others read.
            let schedules = read_solution(text).expect("what is written can be read");
            CheckedSolution::new(instance, settings.mode, &schedules)
        });
        let message = match &found {
            Ok(_) => checked.as_ref().and_then(|checked| checked.faults.first()).map(RuleBreach::to_string),
            Err(reason) => Some(reason.to_string()),
        };
        let status = match found {
            Ok(_) => "solved",
            // Vehicles whose starts touch have no solution either, whatever plans for them.
            Err(Unsolved::Blocked { .. } | Unsolved::Crowded { .. }) => "blocked",
            Err(_) => "unsolved",
        };
        let figures = checked.as_ref().and_then(|checked| checked.figures);
        let row = InstanceRow {
            instance: spreadsheet_cell(&path.display().to_string()).into_owned(),
            width_m: instance.size_m.x,
            height_m: instance.size_m.y,
            obstacles: instance.obstacles.len(),
            vehicles: instance.vehicles.len(),
            mode: settings.mode,
            method: settings.method,
            seed: settings.seed,
            status,
            message: message.unwrap_or_default(),
            flowtime_m: figures.map(|it| it.flowtime_m),
            flowtime_over_bound: figures.map(|it| it.flowtime_over_bound),
            makespan_m: figures.map(|it| it.makespan_m),
            makespan_over_bound: figures.map(|it| it.makespan_over_bound),
            cost: figures.map(|it| it.cost),
            steps: figures.map(|it| it.steps),
            violations: checked.map_or(0, |checked| checked.faults.len()),
            expansions: effort.expansions,
            rounds: effort.rounds,
            cpu_s,
        };
        Self { row, solution }
    }
}

impl InstanceRow {
    /// Returns whether the check found no violation.
    pub fn is_clean(&self) -> bool {
        self.violations == 0
    }

    /// Returns the name of its file, for sentences.
    fn name(&self) -> String {
        visible_start(&Path::new(&self.instance).file_name().unwrap_or_default().to_string_lossy())
    }
}

/// All instances.
#[derive(Debug)]
pub struct TogetherReport {
    pub settings: PlanTogether,
    pub limit_s: f64,
    pub rows: Vec<InstanceRow>,
}

/// Instances of maps of one size, without or with obstacles; or all.
#[derive(Debug, Serialize)]
struct Summary {
    maps: String,
    instances: usize,
    blocked: usize,
    solved: usize,
    solved_share: Option<f64>,
    median_flowtime_over_bound: Option<f64>,
    median_makespan_over_bound: Option<f64>,
    violations: usize,
    median_cpu_s: Option<f64>,
    max_cpu_s: Option<f64>,
}

impl Summary {
    fn new(maps: String, rows: &[&InstanceRow]) -> Self {
        let blocked = rows.iter().filter(|row| row.status == ("blocked")).count();
        let solved = rows.iter().filter(|row| row.status == ("solved")).count();
        let judged = rows.len() - blocked;
        // An instance without a solution is refused at once, which would lower the median.
        let cpu = |row: &InstanceRow| (row.status != "blocked").then_some(row.cpu_s);
        Self {
            maps,
            instances: rows.len(),
            blocked,
            solved,
            solved_share: (judged > 0).then(|| solved as f64 / judged as f64),
            median_flowtime_over_bound: median(rows, |row| row.flowtime_over_bound),
            median_makespan_over_bound: median(rows, |row| row.makespan_over_bound),
            violations: rows.iter().map(|row| row.violations).sum(),
            median_cpu_s: median(rows, cpu),
            max_cpu_s: rows.iter().filter_map(|row| cpu(row)).reduce(f64::max),
        }
    }

    fn cells(&self) -> Vec<String> {
        vec![
            self.maps.clone(),
            self.instances.to_string(),
            self.blocked.to_string(),
            self.solved_share.map_or(String::new(), percent),
            optional(self.median_flowtime_over_bound, 3),
            optional(self.median_makespan_over_bound, 3),
            self.violations.to_string(),
            optional(self.median_cpu_s, 3),
            optional(self.max_cpu_s, 2),
        ]
    }
}

/// The middle value; of an even number, the mean of the two in the middle.
fn median(rows: &[&InstanceRow], value: impl Fn(&InstanceRow) -> Option<f64>) -> Option<f64> {
    let mut values: Vec<f64> = rows.iter().filter_map(|row| value(row)).collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        even if even % 2 == 0 => Some(0.5 * (values[middle - 1] + values[middle])),
        _ => Some(values[middle]),
    }
}

impl TogetherReport {
    /// Writes a row for each instance.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let mut table = csv::Writer::from_writer(WholeFile::create(path)?);
        for row in &self.rows {
            table.serialize(row)?;
        }
        table.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
    }

    fn summaries(&self) -> Vec<Summary> {
        let mut keys: Vec<_> = self.rows.iter().map(group_of).collect();
        // Positive numbers are in the order of their bits.
        keys.sort_unstable();
        keys.dedup();
        let mut summaries: Vec<Summary> = keys
            .iter()
            .map(|group| {
                let rows: Vec<&InstanceRow> = self.rows.iter().filter(|row| group_of(row) == *group).collect();
                let kind = if group.2 { "obstacles" } else { "empty" };
                Summary::new(format!("{} x {} m, {kind}", rows[0].width_m, rows[0].height_m), &rows)
            })
            .collect();
        if summaries.len() > 1 {
            summaries.push(Summary::new("all".to_owned(), &self.rows.iter().collect::<Vec<_>>()));
        }
        summaries
    }
}

fn group_of(row: &InstanceRow) -> (u64, u64, bool) {
    (row.width_m.to_bits(), row.height_m.to_bits(), row.obstacles > 0)
}

impl Serialize for TogetherReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let report = object!(Report {
            program_version: PROGRAM_VERSION,
            mode: self.settings.mode,
            method: self.settings.method,
            seed: self.settings.seed,
            polish: self.settings.polish,
            limit_s: self.limit_s,
            rows: &self.rows,
            summary: self.summaries(),
        });
        report.serialize(serializer)
    }
}

/// The first sentences, and the number of further ones.
fn shown(mut sentences: Vec<String>) -> Vec<String> {
    let more = sentences.len().saturating_sub(SHOWN_FAULTS);
    sentences.truncate(SHOWN_FAULTS);
    sentences.extend((more > 0).then(|| format!("{more} more; --format json has all.")));
    sentences
}

impl From<&TogetherReport> for Document {
    fn from(report: &TogetherReport) -> Self {
        let PlanTogether { mode, method, seed, .. } = report.settings;
        let instances = count(report.rows.len(), "instance");
        let title = format!("{instances} by rules {}, method {}, seed {seed}", mode.name(), method.name());
        let mut document = Self::new(title);
        let headings = "Maps,Instances,Blocked,Solved\n%,Flowtime\nx bound,Makespan\nx bound,Viola-\ntions,CPU\nmedian s,CPU\nmax s";
        let headings: Vec<&str> = headings.split(',').collect();
        document.add(Table::new(&headings, report.summaries().iter().map(Summary::cells).collect()));
        let reasons = report.rows.iter().filter(|row| !row.message.is_empty());
        document.add_list(shown(reasons.map(|row| format!("{}: {}.", row.name(), row.message)).collect()));
        document.with([Block::List(LEGEND.map(str::to_owned).to_vec())])
    }
}

/// The verdict on one solution.
#[derive(Debug)]
pub struct VerdictReport {
    solution: String,
    mode: Mode,
    checked: CheckedSolution,
}

impl VerdictReport {
    /// Creates the report on a checked solution.
    pub fn new(solution: &Path, mode: Mode, checked: CheckedSolution) -> Self {
        Self { solution: solution.display().to_string(), mode, checked }
    }

    /// Returns whether the check found no violation.
    pub fn is_clean(&self) -> bool {
        self.checked.faults.is_empty()
    }
}

impl Serialize for VerdictReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let report = object!(Report {
            program_version: PROGRAM_VERSION,
            mode: self.mode,
            figures: &self.checked.figures,
            violations: self.checked.faults.iter().map(RuleBreach::to_string).collect::<Vec<_>>(),
        });
        report.serialize(serializer)
    }
}

impl From<&VerdictReport> for Document {
    fn from(report: &VerdictReport) -> Self {
        let CheckedSolution { faults, figures } = &report.checked;
        let mut document = Self::new(format!("{} by rules {}", visible_start(&report.solution), report.mode.name()));
        let verdict =
            if faults.is_empty() { "No violation.".to_owned() } else { count(faults.len(), "violation") + "." };
        let mut lines = vec![verdict];
        if let Some(figures) = figures {
            lines.push(format!(
                "Flowtime {} m, {} times its bound; makespan {} m, {} times its bound; cost {}; {}.",
                rounded(figures.flowtime_m, 1),
                rounded(figures.flowtime_over_bound, 3),
                rounded(figures.makespan_m, 1),
                rounded(figures.makespan_over_bound, 3),
                rounded(figures.cost, 1),
                count(figures.steps, "step"),
            ));
        }
        document.add_list(lines);
        document.add_list(shown(faults.iter().map(|fault| format!("{fault}.")).collect()));
        document
    }
}
