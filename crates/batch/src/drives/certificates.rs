//! Certificates: lower bounds on the length of all paths to goals, each with its proof, and the check of a file of them.

use std::io;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize, Serializer};

use crate::drives::{Attempt, DriveTable, PlannerSummary, SHOWN_ROWS, shortened_field};
use crate::plan::PROGRAM_VERSION;
use wildfire_base::document::number::{count, rounded};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::geometry::Pose;
use wildfire_base::object;
use wildfire_base::untrusted::visible_start;
use wildfire_base::whole_file::write_whole;
use wildfire_planning::Goal;
use wildfire_planning::certificate::Certificate;
use wildfire_planning::collision::{ClearanceField, CollisionChecker, MIN_CLEARANCE_M};
use wildfire_scenario::Problem;

/// The format of the file.
const FORMAT: u32 = 1;

/// The most bytes of a file that is read.
pub const MAX_CERTIFICATE_BYTES: u64 = 200_000_000;

/// The most sentences about faults.
const SHOWN_FAULTS: usize = 10;

/// A file of certificates.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CertificateFile {
    wildfire_certificates: u32,
    certificates: Vec<GoalCertificate>,
}

/// A goal with its certificate.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct GoalCertificate {
    field: String,
    goal: usize,
    certificate: Certificate,
}

impl CertificateFile {
    /// Computes a certificate for each goal pose to which one of the attempts, which are in the order of goals, found a
    /// valid path, and adds its bound to the rows of these attempts.
    pub fn new(attempts: &[Attempt], drives: &mut DriveTable) -> Self {
        let mut certificates = Vec::new();
        // A checker holds the clearance field of a whole landscape, which all goals of a problem share.
        let mut cached: Option<(&Problem, CollisionChecker)> = None;
        let is_one_goal =
            |one: &Attempt, next: &Attempt| std::ptr::eq(one.problem, next.problem) && one.goal == next.goal;
        let mut done = 0;
        for group in attempts.chunk_by(is_one_goal) {
            let rows = &mut drives.rows[done..done + group.len()];
            done += group.len();
            let lengths = rows.iter().filter_map(|row| Some(row.solved()?.length_m));
            // No group is empty, as an attempt begins each.
            let problem = group[0].problem;
            // The shortest valid path of any planner is as far as a proof has to reach.
            let (Some(shortest_m), Goal::Pose(goal)) = (lengths.min_by(f64::total_cmp), problem.goals[group[0].goal])
            else {
                continue;
            };
            let (_, checker) =
                cached.take_if(|(of, _)| std::ptr::eq(*of, problem)).unwrap_or_else(|| (problem, checker(problem)));
            let found = Certificate::new(&checker, problem.start, goal, MIN_CLEARANCE_M, shortest_m);
            if let Some(certificate) = found {
                rows.iter_mut().for_each(|row| row.certified_bound_m = Some(certificate.bound_m));
                certificates.push(GoalCertificate { field: problem.name.clone(), goal: group[0].goal, certificate });
            }
            cached = Some((problem, checker));
        }
        Self { wildfire_certificates: FORMAT, certificates }
    }

    /// Writes the file.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        write_whole(path, &serde_json::to_vec(self).expect("names and numbers are JSON"))
    }

    /// Reads the text of a file that `write` wrote; the error is a sentence.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let read: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        match read.wildfire_certificates {
            FORMAT => Ok(read),
            other => Err(format!("certificates of format {other}; this program reads {FORMAT}")),
        }
    }
}

fn checker(problem: &Problem) -> CollisionChecker {
    let field = ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied);
    CollisionChecker::new(Arc::new(field), problem.truck.vehicle)
}

/// Says for each planner what its paths are longer than certified.
pub fn gap_sentences(summaries: &[PlannerSummary], drives: &DriveTable) -> Vec<String> {
    summaries
        .iter()
        .map(|summary| {
            let rows = drives.rows.iter().filter(|row| row.planner == summary.planner);
            let gaps = rows.filter_map(|row| Some(row.solved()?.length_m / row.certified_bound_m? - 1.0));
            let gaps: Vec<f64> = gaps.collect();
            let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
            let max = gaps.iter().copied().fold(0.0, f64::max);
            let planner = visible_start(&summary.planner);
            if gaps.is_empty() {
                return format!("{planner}: no certified goal.");
            }
            let goals = count(gaps.len(), "certified goal");
            format!(
                "{planner}: {goals}; paths are at most {} % longer than the shortest, mean of goals; worst {} %.",
                rounded(100.0 * mean, 2),
                rounded(100.0 * max, 2)
            )
        })
        .collect()
}

/// A certificate that was checked.
#[derive(Debug, Serialize)]
struct CertificateCheck {
    field: String,
    goal: usize,
    certified_bound_m: f64,
    clearance_m: f64,
    corners: usize,
    /// The reason why it proves nothing.
    fault: Option<String>,
}

impl CertificateCheck {
    fn new(
        GoalCertificate { field, goal, certificate }: GoalCertificate,
        ends: (Pose, Goal),
        checker: &CollisionChecker,
    ) -> Self {
        let numbers = |pose: Pose| [pose.x, pose.y, pose.heading];
        // Starts must be equal bit for bit: a proof for a start that is a micrometre off proves nothing about this one.
        let matches = certificate.start == numbers(ends.0)
            && matches!(ends.1, Goal::Pose(pose) if certificate.goal == numbers(pose));
        let found = if matches {
            certificate.check(checker).err().map(|fault| fault.to_string())
        } else {
            Some("it is for another start or goal than the field's".to_owned())
        };
        let Certificate { bound_m, clearance_m, corners, .. } = certificate;
        Self { field, goal, certified_bound_m: bound_m, clearance_m, corners: corners.len(), fault: found }
    }
}

/// All certificates of a file, checked.
pub struct CertificateReport {
    rows: Vec<CertificateCheck>,
}

impl CertificateReport {
    /// Checks certificates on the fields of these problems; the error says which of them has no goal here.
    pub fn new(file: CertificateFile, problems: &[Problem]) -> Result<Self, String> {
        let mut cached: Option<(usize, CollisionChecker)> = None;
        let mut rows = Vec::new();
        for (number, certified) in file.certificates.into_iter().enumerate() {
            let named = problems.iter().position(|problem| problem.name == certified.field);
            let goals = named.map(|index| (index, problems[index].goals.get(certified.goal)));
            let Some((index, Some(&goal))) = goals else {
                return Err(format!(
                    "certificate {number} is for goal {} of the field {}, which is not among those given",
                    certified.goal,
                    visible_start(&certified.field)
                ));
            };
            let problem = &problems[index];
            let checker = cached.take_if(|(of, _)| *of == index).map_or_else(|| checker(problem), |(_, cached)| cached);
            rows.push(CertificateCheck::new(certified, (problem.start, goal), &checker));
            cached = Some((index, checker));
        }
        Ok(Self { rows })
    }

    /// Returns whether all certificates hold.
    pub fn is_clean(&self) -> bool {
        self.rows.iter().all(|row| row.fault.is_none())
    }
}

impl Serialize for CertificateReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        object!(Report { program_version: PROGRAM_VERSION, rows: &self.rows }).serialize(serializer)
    }
}

impl From<&CertificateReport> for Document {
    /// A row for each certificate if they are not too many, and what is wrong.
    fn from(report: &CertificateReport) -> Self {
        let faults: Vec<&CertificateCheck> = report.rows.iter().filter(|row| row.fault.is_some()).collect();
        let sound = report.rows.len() - faults.len();
        let mut document = Self::new(match report.rows.len() {
            0 => "No certificate was checked".to_owned(),
            all => format!("{sound} of {} hold", count(all, "certificate")),
        });
        // A table of hundreds of rows cannot be read, and what is refused is listed below it anyway.
        if (1..=SHOWN_ROWS).contains(&report.rows.len()) {
            let rows = report.rows.iter().map(|row| {
                let verdict = if row.fault.is_some() { "refused" } else { "holds" };
                let numbers = [row.goal.to_string(), rounded(row.certified_bound_m, 3), rounded(row.clearance_m, 3)];
                let [goal, bound, clearance] = numbers;
                vec![shortened_field(&row.field), goal, bound, clearance, row.corners.to_string(), verdict.into()]
            });
            let headings = ["Field", "Goal", "Bound\nm", "Clear.\nm", "Cor-\nners", "Verdict"];
            document.add(Table::new(&headings, rows.collect()));
        }
        let shown = faults.iter().take(SHOWN_FAULTS).map(|row| {
            let fault = row.fault.as_deref().unwrap_or_default();
            format!("Field {}, goal {}: {fault}.", shortened_field(&row.field), row.goal)
        });
        let hidden = faults.len().saturating_sub(SHOWN_FAULTS);
        let more = (hidden > 0).then(|| format!("... and {}.", count(hidden, "more refused certificate")));
        document.add_list(shown.chain(more).collect());
        document.with([Block::Text(
            "Bound: every path from the start to the goal that keeps the clearance is at least this long.".into(),
        )])
    }
}
