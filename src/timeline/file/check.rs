//! What every recording promises its readers: finite values, ordered times, cells of the field, bounded counts.
//!
//! Whether the facts make sense together is not asked here: an audit must be able to read a run that went wrong.

use super::FileError;
use crate::geometry::{Cell, FieldFrame, Pose};
use crate::timeline::{AgentFact, AgentStart, Body, Event, Fact, FireFact, Rules, Setting, Timeline};
use crate::trajectory::{Piece, SpeedLimits, Trajectory};

/// Cells along a side of the field.
pub const MAX_SIDE: usize = 1000;
pub const MAX_AGENTS: usize = 200;
pub const MAX_FACTS: usize = 2_000_000;
/// Pieces of all legs together.
pub const MAX_PIECES: usize = 2_000_000;
/// Cells of all `OutOfReach` facts together.
pub const MAX_CELLS_OUT_OF_REACH: usize = 8_000_000;
/// Places of all `Searched` facts together, twice of what a run records at most.
pub const MAX_SEARCH_PLACES: usize = 8_000_000;
/// Edges of all `Searched` facts together.
pub const MAX_SEARCH_EDGES: usize = 8_000_000;
pub const MAX_NAME_BYTES: usize = 4096;

pub fn check(timeline: &Timeline) -> Result<(), FileError> {
    check_setting(&timeline.setting)?;
    limit("facts", timeline.events.len(), MAX_FACTS)?;
    require(timeline.events.is_sorted_by_key(|event| event.time), || "its facts are not in order of time".into())?;
    let (mut pieces, mut cells_out_of_reach) = (0, 0);
    let (mut search_places, mut search_edges) = (0, 0);
    for event in &timeline.events {
        check_event(event, &timeline.setting).map_err(|error| at_fact(error, event))?;
        match &event.fact {
            Fact::Agent(_, AgentFact::Planned { trajectory, .. })
            | Fact::Agent(_, AgentFact::Dropped { trajectory, .. })
            | Fact::Agent(_, AgentFact::GaveWay { trajectory, .. }) => {
                pieces += trajectory.pieces().len();
            }
            Fact::Agent(_, AgentFact::OutOfReach { cells, .. }) => cells_out_of_reach += cells.len(),
            Fact::Agent(_, AgentFact::Searched { graph, .. }) => {
                search_places += graph.places.len();
                search_edges += graph.edges.len();
            }
            _ => {}
        }
    }
    limit("pieces of legs", pieces, MAX_PIECES)?;
    limit("cells out of reach", cells_out_of_reach, MAX_CELLS_OUT_OF_REACH)?;
    limit("places of searches", search_places, MAX_SEARCH_PLACES)?;
    limit("edges of searches", search_edges, MAX_SEARCH_EDGES)
}

/// Refuses counts beyond a limit.
pub fn limit(what: &'static str, found: usize, limit: usize) -> Result<(), FileError> {
    if found <= limit { Ok(()) } else { Err(FileError::TooLarge { what, limit }) }
}

fn require(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), FileError> {
    if holds { Ok(()) } else { Err(FileError::Impossible(otherwise())) }
}

fn at_fact(error: FileError, event: &Event) -> FileError {
    match error {
        FileError::Impossible(what) => FileError::Impossible(format!("{what} in a fact at {}", event.time)),
        other => other,
    }
}

fn check_setting(setting: &Setting) -> Result<(), FileError> {
    let frame = setting.frame;
    limit("bytes of a name", setting.scenario.len().max(setting.program_version.len()), MAX_NAME_BYTES)?;
    limit("cells along a side", frame.cols.max(frame.rows).into(), MAX_SIDE)?;
    limit("agents", setting.agents.len(), MAX_AGENTS)?;
    require(frame.cols > 0 && frame.rows > 0, || "its field has no cells".into())?;
    require(is_size(frame.cell_m), || format!("its cells measure {} m", frame.cell_m))?;
    require(setting.bushes.iter().all(|&bush| contains(&frame, bush)), || "a bush stands outside the field".into())?;
    let ascend = setting.bushes.is_sorted_by(|a, b| frame.index(*a) < frame.index(*b));
    require(ascend, || "its bushes are not in the order of their indices".into())?;
    require(setting.agents.is_sorted_by(|a, b| a.id < b.id), || "its agents are not in order".into())?;
    setting.agents.iter().try_for_each(check_agent)?;
    check_rules(&setting.rules)
}

fn check_agent(agent: &AgentStart) -> Result<(), FileError> {
    let sizes_fit = match agent.body {
        Body::Square { size_m } => is_size(size_m),
        Body::Truck(body) => {
            [body.length_m, body.width_m, body.wheelbase_m, body.turning_radius_m].into_iter().all(is_size)
                && body.rear_overhang_m.is_finite()
        }
    };
    require(sizes_fit, || format!("the body of {} has no size", agent.id))?;
    require(agent.limits.is_none_or(are_limits), || format!("the limits of {} allow no motion", agent.id))?;
    require(is_finite(agent.pose), || format!("{} starts nowhere", agent.id))
}

fn are_limits(limits: SpeedLimits) -> bool {
    let speeds = [limits.forward_mps, limits.reverse_mps];
    let accelerations = [limits.acceleration_mps2, limits.braking_mps2, limits.lateral_mps2];
    speeds.into_iter().all(|speed| speed.is_finite() && speed >= 0.0)
        && accelerations.into_iter().flatten().all(is_size)
}

fn check_rules(rules: &Rules) -> Result<(), FileError> {
    let scores = [rules.score_wumpus_ignited, rules.score_wumpus_burned_out, rules.score_truck_extinguished];
    require(scores.into_iter().all(f64::is_finite), || "its scores are not finite".into())?;
    let reach = rules.suppression_reach_m.unwrap_or(0.0);
    require(reach.is_finite() && reach >= 0.0, || format!("suppression reaches {reach} m"))?;
    let spread = rules.fire.map_or(0.0, |fire| fire.spread_radius_m);
    require(spread.is_finite() && spread >= 0.0, || format!("fire spreads over {spread} m"))
}

fn check_event(event: &Event, setting: &Setting) -> Result<(), FileError> {
    let other = match event.fact {
        Fact::Agent(_, AgentFact::Blocked { by: other, .. }) | Fact::Agent(_, AgentFact::GaveWay { to: other, .. }) => {
            Some(other)
        }
        _ => None,
    };
    for agent in event.fact.agent().into_iter().chain(other) {
        require(setting.agent_index(agent).is_some(), || format!("{agent} is unknown"))?;
    }
    if let Some(cell) = event.fact.cell() {
        check_bush(cell, setting)?;
    }
    match &event.fact {
        Fact::Agent(_, AgentFact::OutOfReach { cells, .. }) => {
            cells.iter().try_for_each(|&cell| check_bush(cell, setting))
        }
        Fact::Agent(_, AgentFact::StartMoved { from, .. }) => {
            require(is_finite(*from), || "a start is not finite".into())
        }
        Fact::Fire(FireFact::Ignited { cause: crate::timeline::Cause::Spread(from), .. }) => check_bush(*from, setting),
        Fact::Agent(_, AgentFact::PlanFailed { until, .. }) => {
            require(*until >= event.time, || "planning time ends before it begins".into())
        }
        Fact::Agent(_, AgentFact::Planned { trajectory, .. })
        | Fact::Agent(_, AgentFact::GaveWay { trajectory, .. }) => {
            let sets_out_later = trajectory.start_time() >= event.time;
            require(sets_out_later, || "a leg sets out before it is planned".into())?;
            check_leg(trajectory)
        }
        Fact::Agent(_, AgentFact::Dropped { trajectory, .. }) => check_leg(trajectory),
        Fact::Agent(_, AgentFact::Searched { graph, .. }) => {
            let holds = |place: u32| (place as usize) < graph.places.len();
            let leads_somewhere = graph.edges.iter().all(|&(from, to)| holds(from) && holds(to));
            require(leads_somewhere, || "a search leads to a place that it does not hold".into())
        }
        Fact::Agent(_, AgentFact::LocalMinimum { x_m, y_m, .. }) => {
            require(x_m.is_finite() && y_m.is_finite(), || "a local minimum lies nowhere".into())
        }
        _ => Ok(()),
    }
}

fn check_bush(cell: Cell, setting: &Setting) -> Result<(), FileError> {
    require(setting.bush_index(cell).is_some(), || format!("no bush stands at {cell}"))
}

/// A leg's end is finite only if all of its way is.
fn check_leg(leg: &Trajectory) -> Result<(), FileError> {
    require(is_finite(leg.start()), || "a leg starts nowhere".into())?;
    require(leg.pieces().iter().all(is_motion), || "a leg has a piece that is no motion".into())?;
    require(leg.duration_s().is_finite() && is_finite(leg.end()), || "a leg has no end".into())
}

fn is_motion(piece: &Piece) -> bool {
    let numbers_fit = match *piece {
        Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
            let numbers = [segment.curvature, segment.length_m, speed_mps, acceleration_mps2];
            numbers.into_iter().all(f64::is_finite) && speed_mps >= 0.0
        }
        Piece::Turn { heading } => heading.is_finite(),
        Piece::Wait { seconds } => seconds >= 0.0,
    };
    numbers_fit && piece.duration_s().is_finite()
}

fn contains(frame: &FieldFrame, cell: Cell) -> bool {
    cell.col < frame.cols && cell.row < frame.rows
}

fn is_size(metres: f64) -> bool {
    metres.is_finite() && metres > 0.0
}

fn is_finite(pose: Pose) -> bool {
    [pose.x, pose.y, pose.heading].into_iter().all(f64::is_finite)
}
