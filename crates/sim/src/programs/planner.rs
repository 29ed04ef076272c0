//! A program as a truck's planner.

use std::sync::Arc;
use std::time::Duration;

use glam::DVec2;

use super::external_client::{ExternalClient, Idle, Reply};
use super::launch::ProcessError;
use super::protocol::{FromProgram, GoalMessage, PathAnswer, PlanQuery, Reason, ToProgram};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Path, ReedsShepp, Segment};
use wildfire_planning::{
    BuildReport, CpuSource, Effort, Goal, NullObserver, Plan, PlanFailure, PlanningObserver, QueryCpu, SearchPhase,
    TruckPlanner,
};

/// Instructions of a module that count as one expansion.
pub const INSTRUCTIONS_PER_EXPANSION: u64 = 1_000_000;

/// Asks a program for paths.
///
/// Nothing of what it answers is believed: the gate is round this planner as round every one that is not built in.
pub struct ProgramPlanner {
    /// `None` when it has been given back.
    pub(super) respondent: Option<ExternalClient>,
    /// Where the program goes when the run is over, if it plays in other runs.
    pub(super) idle: Option<Arc<Idle>>,
    pub(super) curves: ReedsShepp,
}

impl TruckPlanner for ProgramPlanner {
    fn build_report(&self) -> BuildReport {
        let built = self.respondent.as_ref().and_then(|respondent| respondent.built);
        BuildReport { elsewhere: built.unwrap_or_default(), ..BuildReport::default() }
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.plan_observed(start, goal, &mut NullObserver)
    }

    fn plan_observed(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Plan {
        let respondent = self.respondent.as_mut().expect("it is given back when this is dropped");
        let min = respondent.expansions_per_query();
        let goal = match goal {
            Goal::Disc(disc) => GoalMessage::Disc([disc.centre.x, disc.centre.y, disc.radius_m]),
            Goal::Pose(pose) => GoalMessage::Pose(numbers(pose)),
        };
        let Reply { answer, cpu, starting, instructions } = respondent.ask(
            |id| ToProgram::Plan(PlanQuery { id, start: numbers(start), goal }).line(),
            |answer| match answer {
                FromProgram::Path(_) | FromProgram::None(_) => Ok(()),
                _ => Err("expected the type `path` or `none`"),
            },
        );
        let cpu = (cpu, starting);
        // What a module reports of itself counts for nothing: its instructions do.
        let counted =
            instructions.map(|count| u32::try_from(count.div_ceil(INSTRUCTIONS_PER_EXPANSION)).unwrap_or(u32::MAX));
        let effort = |reported: Option<u32>| Effort {
            // At least some, so that a program cannot plan for nothing by reporting none.
            local_expansions: counted.or(reported).unwrap_or(0).max(min),
            ..Effort::default()
        };
        match answer {
            Ok(FromProgram::Path(answer)) => {
                show(answer.searched.as_deref(), observer);
                let path = self.path(start, &answer);
                Plan {
                    effort: effort(answer.expansions),
                    cpu: cpu_of(cpu, answer.cpu_s.filter(|_| instructions.is_none())),
                    ..Plan::from(Ok(path))
                }
            }
            Ok(FromProgram::None(answer)) => {
                show(answer.searched.as_deref(), observer);
                let failure = match answer.reason {
                    Reason::Disconnected => PlanFailure::Disconnected,
                    Reason::StartBlocked => PlanFailure::StartBlocked,
                    Reason::GoalBlocked => PlanFailure::GoalBlocked,
                    Reason::BudgetSpent => PlanFailure::BudgetSpent,
                };
                Plan {
                    effort: effort(answer.expansions),
                    cpu: cpu_of(cpu, answer.cpu_s.filter(|_| instructions.is_none())),
                    ..Plan::from(Err(failure))
                }
            }
            Ok(_) => unreachable!("other answers are refused"),
            Err(ProcessError { kind, message }) => {
                Plan { effort: effort(None), cpu: cpu_of(cpu, None), ..Plan::failed(kind.into(), message) }
            }
        }
    }
}

impl ProgramPlanner {
    fn path(&self, start: Pose, answer: &PathAnswer) -> Path {
        let mut path = Path::standing(start);
        for &[curvature, length_m] in answer.segments.as_deref().unwrap_or_default() {
            path.segments.push(Segment { curvature, length_m });
        }
        let mut from = start;
        for &[x, y, heading] in answer.poses.as_deref().unwrap_or_default() {
            let to = Pose::new(x, y, heading);
            path.segments.extend(self.curves.shortest(from, to).segments());
            from = to;
        }
        path
    }
}

impl Drop for ProgramPlanner {
    fn drop(&mut self) {
        if let (Some(idle), Some(respondent)) = (&self.idle, self.respondent.take()) {
            idle.give_back(respondent);
        }
    }
}

fn numbers(pose: Pose) -> [f64; 3] {
    [pose.x, pose.y, pose.heading]
}

/// The larger of what was measured and what the program says.
fn cpu_of((measured, starting): (Option<Duration>, Duration), reported_s: Option<f64>) -> Option<QueryCpu> {
    let reported = reported_s.map(Duration::from_secs_f64);
    match (measured, reported) {
        (measured, Some(time)) if measured.is_none_or(|measured| time > measured) => {
            Some(QueryCpu { time, starting, source: CpuSource::Reported })
        }
        (measured, _) => measured.map(|time| QueryCpu { time, starting, source: CpuSource::Process }),
    }
}

fn show(searched: Option<&[[f64; 4]]>, observer: &mut dyn PlanningObserver) {
    if let Some(lines) = searched {
        observer.on_edges_examined(
            SearchPhase::Local,
            &mut lines.iter().map(|&[x0, y0, x1, y1]| [DVec2::new(x0, y0), DVec2::new(x1, y1)]),
        );
    }
}
