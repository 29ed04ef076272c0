//! A field and the paths on it as a picture.

use crate::cli::plan::PlanReport;
use crate::cli::plan::attempts::Attempt;
use crate::picture::{DriveScene, DrivenWays, Picture, draw_drives};
use crate::planning::TruckPlannerKind;
use crate::scenario::Problem;
use crate::vehicle::Path;

/// Draws the paths of all planners on one field.
pub fn draw(problem: &Problem, report: &PlanReport) -> Picture {
    let own: Vec<&Attempt> = report.attempts.iter().filter(|a| std::ptr::eq(a.problem, problem)).collect();
    let by = |planner: TruckPlannerKind| {
        let paths = own.iter().filter(|attempt| attempt.planner == planner);
        let paths: Vec<&Path> = paths.filter_map(|attempt| Some(&attempt.drive.as_ref().ok()?.path)).collect();
        DrivenWays { name: format!("{planner}, {} of {}", paths.len(), problem.goals.len()), paths }
    };
    let is_reached = |goal| own.iter().any(|attempt| attempt.goal == goal && attempt.drive.is_ok());
    draw_drives(&DriveScene {
        title: &format!("Drives on field {}", problem.name),
        frame: problem.terrain.frame,
        bushes: &problem.terrain.bushes,
        start: problem.start,
        goals: &problem.goals.iter().enumerate().map(|(n, &goal)| (goal, is_reached(n))).collect::<Vec<_>>(),
        ways: &report.planners.iter().map(|&planner| by(planner)).collect::<Vec<_>>(),
    })
}
