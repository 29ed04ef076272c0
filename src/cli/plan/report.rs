//! The report on planned drives: an object, a document and pictures of all answers.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use crate::cli::plan::repeat::Repeat;
use wildfire_base::document::number::count;
use wildfire_base::document::{Block, Document};
use wildfire_base::object;
use wildfire_base::vehicle::Path;
use wildfire_batch::drives::{
    Attempt, CertificateFile, DRIVE_LEGEND, DriveTable, PlannerSummary, SHOWN_ROWS, failure_sentences, gap_sentences,
    rows_table, shortened_field, summary_table, violation_sentences,
};
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_picture::{DriveScene, DrivenWays, Picture, draw_drives};
use wildfire_planning::{Goal, PlannerName, TruckPlannerKind};
use wildfire_scenario::{LoadedScenario, Problem};

/// The question and all answers.
pub struct PlanReport<'a> {
    pub loaded: &'a LoadedScenario,
    /// Changed values, as on the command line.
    pub changes: &'a [String],
    pub seed: u64,
    pub problems: &'a [Problem],
    pub planners: &'a [PlannerName],
    /// Problem by problem, goal by goal, planner by planner.
    pub attempts: Vec<Attempt<'a>>,
    /// Whether answers repeat, in the order of the planners, if they were asked twice.
    pub repeats: Option<Vec<Repeat>>,
    /// The attempts without their paths, in the same order.
    pub drives: DriveTable,
    pub summaries: Vec<PlannerSummary>,
    /// Lower bounds, if they were asked for.
    pub certificates: Option<CertificateFile>,
}

impl PlanReport<'_> {
    /// The place of a problem of the list.
    pub fn number_of(&self, problem: &Problem) -> usize {
        self.problems.iter().position(|other| std::ptr::eq(other, problem)).expect("it is in the list")
    }
}

/// The values of a planner's settings of the first truck, by names such as `hybrid.shortcuts`; of one that is not built
/// in, those of its table.
pub fn planner_settings(planner: &PlannerName, loaded: &LoadedScenario) -> Vec<(String, String)> {
    let tables = planner.built_in().map_or(&[][..], |kind| TruckPlannerKind::maker(kind).tables());
    let of_program = format!("planner.{planner}.");
    let values = loaded.values().into_iter();
    values.filter_map(|(name, value)| Some((setting_name(&name, &of_program, tables)?, value))).collect()
}

fn setting_name(name: &str, of_program: &str, tables: &[&str]) -> Option<String> {
    if let Some(setting) = name.strip_prefix(of_program) {
        return Some(setting.to_owned());
    }
    let name = name.strip_prefix("unimog.0.")?;
    let table = name.split_once('.')?.0;
    tables.contains(&table).then(|| name.to_owned())
}

/// Settings that bound a planner's effort: expansions, samples, tries.
const BUDGETS: [&str; 3] = ["max_expansions", "samples", "shortcuts"];

/// The settings that bound a planner's effort, as text.
fn budget(planner: &PlannerName, loaded: &LoadedScenario) -> String {
    let settings = planner_settings(planner, loaded).into_iter();
    let budgets = settings.filter(|(name, _)| BUDGETS.iter().any(|budget| name.rsplit('.').next() == Some(budget)));
    let budgets: Vec<_> = budgets.map(|(name, value)| format!("{name}={value}")).collect();
    if budgets.is_empty() { "none".into() } else { budgets.join(", ") }
}

impl Serialize for PlanReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let settings = self
            .planners
            .iter()
            .map(|planner| (planner.name(), planner_settings(planner, self.loaded).into_iter().collect()));
        let report = object!(Report {
            program_version: PROGRAM_VERSION,
            scenario: &self.loaded.scenario.name,
            seed: self.seed,
            settings: settings.collect::<BTreeMap<_, BTreeMap<_, _>>>(),
            fields: self.problems.iter().map(field).collect::<Vec<_>>(),
            rows: self.drives.members(),
            summary: self.drives.summary_members(&self.summaries),
            // Without repetitions there is no member.
            #[serde(flatten)]
            repeats: self.repeats.as_ref().map(|repeats| object!(Repeats { repeats })),
        });
        report.serialize(serializer)
    }
}

/// A field and its goals, which are as a field file has them.
fn field(problem: &Problem) -> impl Serialize {
    let goals = problem.goals.iter().map(|goal| match *goal {
        Goal::Pose(pose) => ("pose", [pose.x, pose.y, pose.heading]),
        Goal::Disc(disc) => ("disc", [disc.centre.x, disc.centre.y, disc.radius_m]),
    });
    object!(Field {
        field: &problem.name,
        start: [problem.start.x, problem.start.y, problem.start.heading],
        goals: goals.map(|goal| BTreeMap::from([goal])).collect::<Vec<_>>(),
    })
}

impl From<&PlanReport<'_>> for Document {
    /// The settings, a row for each goal and planner if they are not too many, a row for each planner, and what went
    /// wrong.
    fn from(report: &PlanReport) -> Self {
        let fields = match report.problems {
            [problem] => format!("Field `{}`", shortened_field(&problem.name)),
            problems => format!("{} fields", problems.len()),
        };
        let goals = count(report.problems.iter().map(|problem| problem.goals.len()).sum(), "goal");
        let changes: String = report.changes.iter().map(|change| format!(", {change}")).collect();
        let settings = format!("Settings of the scenario `{}`{changes}.", report.loaded.scenario.name);
        let settings = std::iter::once(settings)
            .chain(
                report
                    .planners
                    .iter()
                    .map(|planner| format!("Budget of {planner}: {}.", budget(planner, report.loaded))),
            )
            .collect();
        let mut document = Self::new(format!("{fields}, {goals}, seed {}", report.seed)).with([Block::List(settings)]);
        if report.attempts.len() <= SHOWN_ROWS {
            document.add(rows_table(&report.drives.rows));
        }
        document.add(summary_table(&report.summaries));
        let repeats = report.repeats.iter().flatten().map(Repeat::sentence);
        if report.certificates.is_some() {
            document.add_list(gap_sentences(&report.summaries, &report.drives));
        }
        let failures = failure_sentences(&report.drives).into_iter();
        document.add_list(failures.chain(violation_sentences(&report.drives)).chain(repeats).collect());
        document.with([Block::List(DRIVE_LEGEND.map(str::to_owned).to_vec())])
    }
}

impl PlanReport<'_> {
    /// Draws the paths of all planners on one field.
    pub fn draw(&self, problem: &Problem) -> Picture {
        // Problems are compared by address: two of them may have equal fields.
        let attempts: Vec<&Attempt> = self.attempts.iter().filter(|a| std::ptr::eq(a.problem, problem)).collect();
        let ways = self.planners.iter().map(|planner| {
            let paths = attempts.iter().filter(|attempt| attempt.planner == *planner);
            let paths: Vec<&Path> = paths.filter_map(|attempt| Some(&attempt.drive.as_ref().ok()?.path)).collect();
            DrivenWays { name: format!("{planner}, {} of {}", paths.len(), problem.goals.len()), paths }
        });
        let goals = problem.goals.iter().enumerate().map(|(number, &goal)| {
            (goal, attempts.iter().any(|attempt| attempt.goal == number && attempt.drive.is_ok()))
        });
        draw_drives(&DriveScene {
            title: &format!("Drives on field {}", problem.name),
            frame: problem.terrain.frame,
            bushes: &problem.terrain.bushes,
            start: problem.start,
            goals: &goals.collect::<Vec<_>>(),
            ways: &ways.collect::<Vec<_>>(),
        })
    }
}
