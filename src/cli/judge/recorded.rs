//! The drives of a recorded run: each as a path towards its goal.

use wildfire_audit::{AuditField, MotionLimits, Outline, SampleStep, audit_leg};
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::trajectory::{Piece, SpeedLimits, Trajectory};
use wildfire_base::vehicle::{Dimensions, Path};
use wildfire_batch::drives::missed;
use wildfire_grid::Grid;
use wildfire_planning::collision::{ClearanceField, CollisionChecker};
use wildfire_planning::judge::{DriveFigures, Judge};
use wildfire_planning::{Goal, GoalDisc};
use wildfire_scenario::{Problem, Terrain, Unimog};
use wildfire_timeline::{AgentFact, AgentId, AgentStart, Body, Fact, Setting, Timeline};

/// What a recording that says nothing of a truck's speeds is measured with, m/s; only lengths are made of it.
const ANY_SPEED_MPS: f64 = 1.0;

/// A drive to a goal.
pub struct RecordedDrive {
    pub truck: AgentId,
    pub start: Pose,
    pub goal: Goal,
    pub figures: DriveFigures,
    /// True if the goal was dropped before the truck was there.
    pub is_dropped: bool,
    pub violation: Option<String>,
}

/// Measures and checks all drives of a run, truck by truck. Drives without a goal, by which one truck makes room for
/// another, are left out.
pub fn recorded_drives(timeline: &Timeline) -> Vec<RecordedDrive> {
    let trucks = timeline.setting.agents.iter().filter_map(|agent| match agent.body {
        Body::Truck(body) => Some((agent, body)),
        Body::Square { .. } => None,
    });
    trucks.flat_map(|(agent, body)| TruckJudge::new(&timeline.setting, *agent, body).drives(timeline)).collect()
}

/// Returns the question that a drive answers, for planners with the settings of `truck`.
pub fn problem(setting: &Setting, drive: &RecordedDrive, truck: &Unimog) -> Problem {
    let agent = setting.agent_index(drive.truck).map(|index| setting.agents[index]);
    let mut truck = truck.clone();
    if let Some(AgentStart { body: Body::Truck(body), limits, .. }) = agent {
        truck.vehicle = body;
        if let Some(limits) = limits {
            (truck.speed_mps, truck.reverse_speed_mps) = (limits.forward_mps, limits.reverse_mps);
            truck.limits.acceleration_mps2 = limits.acceleration_mps2;
            truck.limits.braking_mps2 = limits.braking_mps2;
            truck.limits.lateral_mps2 = limits.lateral_mps2;
        }
    }
    let terrain = Terrain::from_occupied(setting.frame, occupied(setting));
    Problem { name: setting.scenario.clone(), terrain, truck, start: drive.start, goals: vec![drive.goal] }
}

fn occupied(setting: &Setting) -> Grid<bool> {
    let mut occupied = Grid::filled(setting.frame.rows.into(), setting.frame.cols.into(), false);
    for cell in setting.obstacles() {
        occupied[(cell.row.into(), cell.col.into())] = true;
    }
    occupied
}

/// A truck of a run, and what its drives are held against.
struct TruckJudge<'a> {
    setting: &'a Setting,
    truck: AgentStart,
    body: Dimensions,
    judge: Judge,
    audit_field: AuditField,
}

impl<'a> TruckJudge<'a> {
    fn new(setting: &'a Setting, truck: AgentStart, body: Dimensions) -> Self {
        let field = ClearanceField::new(setting.frame, &occupied(setting));
        let audit_field = AuditField::new(setting.frame, &setting.obstacles(), Outline::new(&truck.body));
        let judge = Judge::new(CollisionChecker::new(field.into(), body));
        Self { setting, truck, body, judge, audit_field }
    }

    fn drives(&self, timeline: &Timeline) -> Vec<RecordedDrive> {
        let mut legs: Vec<(Cell, &Trajectory, bool)> = Vec::new();
        for event in &timeline.events {
            match &event.fact {
                Fact::Agent(agent, AgentFact::Planned { goal, trajectory, .. }) if *agent == self.truck.id => {
                    legs.push((*goal, trajectory, false));
                }
                Fact::Agent(agent, AgentFact::Dropped { trajectory, .. }) if *agent == self.truck.id => {
                    // A drive that is broken off has two facts: the plan, and the leg as it was really driven.
                    if let Some((_, leg, is_dropped)) = legs.last_mut() {
                        (*leg, *is_dropped) = (trajectory, true);
                    }
                }
                _ => {}
            }
        }
        legs.into_iter().map(|(goal, leg, is_dropped)| self.drive(goal, leg, is_dropped)).collect()
    }

    fn drive(&self, goal: Cell, leg: &Trajectory, is_dropped: bool) -> RecordedDrive {
        let radius_m = self.setting.rules.suppression_reach_m.unwrap_or(f64::INFINITY);
        let goal: Goal = GoalDisc { centre: self.setting.frame.centre(goal), radius_m }.into();
        let path = Path { start: leg.start(), segments: leg.pieces().iter().filter_map(Piece::segment).collect() };
        let limits = self.truck.limits.unwrap_or(SpeedLimits::new(ANY_SPEED_MPS, ANY_SPEED_MPS));
        let moving = leg.pieces().iter().filter(|piece| piece.segment().is_some());
        let figures = DriveFigures {
            // A leg that was broken off ends with a brake, which a path does not say.
            drive_s: moving.map(Piece::duration_s).sum::<f64>() + 0.0,
            ..self.judge.figures(leg.start(), goal, &path, limits)
        };
        let motion = MotionLimits { turning_radius_m: Some(self.body.turning_radius_m), limits: self.truck.limits };
        let audited = audit_leg(&self.audit_field, &motion, leg, SampleStep::default());
        let violation = audited.err().map(|violation| violation.to_string()).or_else(|| {
            // A drive that was broken off was not meant to end at its goal.
            let by = missed(goal, leg.end(), &self.body).filter(|_| !is_dropped)?;
            Some(format!("it ends {by} away"))
        });
        RecordedDrive { truck: self.truck.id, start: leg.start(), goal, figures, is_dropped, violation }
    }
}
