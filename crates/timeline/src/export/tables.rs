//! A run as tables for other tools: CSV with a header line, `,` between fields, `\n` at line ends.
//!
//! Times are seconds with nine decimals, exact to the nanosecond. All other numbers are the shortest decimals that
//! read back as the same `f64`, so that equal runs give equal files byte for byte.

use std::io::Write;

use super::{ExportError, Sampling};
use crate::{AgentFact, Cause, Event, Fact, FireFact, GroundEvent, GroundFact, Replay, Timeline};
use wildfire_base::geometry::Cell;
use wildfire_base::query::{Effort, FoundBy};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Trajectory;

const NANOS_PER_SECOND: u64 = 1_000_000_000;

/// Writes one line per fact, in order: `t_s,event,agent,col,row,detail`.
///
/// What happens to ground is among them, at one instant before the others; its events are `ground-ignited`,
/// `ground-extinguished` and `wetted`, which may be a bush. `agent` and `col,row` are empty where the fact concerns no agent or no single cell; for plans the cell is the goal.
/// `detail` holds `key=value` pairs separated by `; `, cells in it as `col:row`.
pub fn write_events(timeline: &Timeline, to: impl Write) -> Result<(), ExportError> {
    let mut table = csv::Writer::from_writer(to);
    table.write_record(["t_s", "event", "agent", "col", "row", "detail"])?;
    let mut ground = &timeline.ground[..];
    for event in &timeline.events {
        let earlier = ground.partition_point(|ground| ground.time <= event.time);
        ground[..earlier].iter().try_for_each(|event| write_ground_event(&mut table, event))?;
        ground = &ground[earlier..];
        write_event(&mut table, event)?;
    }
    ground.iter().try_for_each(|event| write_ground_event(&mut table, event))?;
    Ok(table.flush()?)
}

fn write_event(table: &mut csv::Writer<impl Write>, event: &Event) -> Result<(), csv::Error> {
    let fact = &event.fact;
    let agent = fact.agent().map_or_else(String::new, |agent| agent.to_string());
    let (col, row) = fact.cell().map_or_else(Default::default, |c| (c.col.to_string(), c.row.to_string()));
    table.write_record([&seconds(event.time), name(fact), &agent, &col, &row, &detail(fact)])
}

fn write_ground_event(table: &mut csv::Writer<impl Write>, event: &GroundEvent) -> Result<(), csv::Error> {
    let agent = event.agent().map_or_else(String::new, |agent| agent.to_string());
    let col = event.cell.col.to_string();
    let row = event.cell.row.to_string();
    let EventText { name, detail } = ground_event_text(event);
    table.write_record([&seconds(event.time), name, &agent, &col, &row, &detail])
}

/// The word for an event and its details, as in the columns `event` and `detail`.
#[derive(Debug)]
pub struct EventText {
    pub name: &'static str,
    pub detail: String,
}

/// Returns the word and the details of a fact.
pub fn event_text(fact: &Fact) -> EventText {
    EventText { name: name(fact), detail: detail(fact) }
}

/// Returns the word and the details of a change of the ground.
pub fn ground_event_text(event: &GroundEvent) -> EventText {
    let (name, detail) = match event.fact {
        GroundFact::Ignited(cause) => ("ground-ignited", cause_text(cause)),
        GroundFact::Extinguished { .. } => ("ground-extinguished", String::new()),
        GroundFact::Wetted { until, .. } => ("wetted", format!("until_s={}", seconds(until))),
        GroundFact::Cleared { flank, along_mm, holds } => {
            ("line-built", format!("flank={flank} along_m={} holds={holds}", f64::from(along_mm) / 1000.0))
        }
    };
    EventText { name, detail }
}

fn cause_text(cause: Cause) -> String {
    match cause {
        Cause::Agent(_) => "cause=lit".into(),
        Cause::Spread(from) => format!("cause=spread; from={}", short(from)),
        Cause::Spotted(from) => format!("cause=ember; from={}", short(from)),
        Cause::Scheduled => "cause=schedule".into(),
    }
}

/// Writes the position of every sampled agent at every sampled time:
/// `t_s,agent,x_m,y_m,heading_rad,speed_mps,activity`.
///
/// Poses and activities are those after all facts of the time. The pose is the world frame's, for a truck that of its
/// rear axle; the speed is never negative.
pub fn write_trace(timeline: &Timeline, sampling: &Sampling, to: impl Write) -> Result<(), ExportError> {
    let mut table = csv::Writer::from_writer(to);
    table.write_record(["t_s", "agent", "x_m", "y_m", "heading_rad", "speed_mps", "activity"])?;
    let mut replay = Replay::new(timeline);
    for time in sampling.times() {
        replay.seek(time);
        write_agents(&mut table, &replay, sampling.agents())?;
    }
    Ok(table.flush()?)
}

fn write_agents(table: &mut csv::Writer<impl Write>, replay: &Replay<'_>, agents: &[usize]) -> Result<(), csv::Error> {
    let time = seconds(replay.time());
    for state in agents.iter().map(|&agent| replay.agent(agent)) {
        let numbers = [state.pose.x, state.pose.y, state.pose.heading, state.speed_mps].map(|n| n.to_string());
        let [x, y, heading, speed] = &numbers;
        table.write_record([&time, &state.id.to_string(), x, y, heading, speed, state.activity.name()])?;
    }
    Ok(())
}

fn seconds(time: SimTime) -> String {
    let nanos = time.as_nanos();
    format!("{}.{:09}", nanos / NANOS_PER_SECOND, nanos % NANOS_PER_SECOND)
}

/// The word for a kind of fact in the `event` column.
fn name(fact: &Fact) -> &'static str {
    match fact {
        Fact::Agent(_, AgentFact::StartMoved { .. }) => "start-moved",
        Fact::Agent(_, AgentFact::RoadmapBuilt { .. }) => "roadmap-built",
        Fact::Agent(_, AgentFact::OutOfReach { .. }) => "out-of-reach",
        Fact::Fire(FireFact::Ignited { .. }) => "ignited",
        Fact::Fire(FireFact::BurnedOut { .. }) => "burned-out",
        Fact::Fire(FireFact::Extinguished { .. }) => "extinguished",
        Fact::Agent(_, AgentFact::Planned { .. }) => "planned",
        Fact::Agent(_, AgentFact::Searched { .. }) => "searched",
        Fact::Agent(_, AgentFact::PlanFailed { .. }) => "plan-failed",
        Fact::Agent(_, AgentFact::Dropped { .. }) => "dropped",
        Fact::Agent(_, AgentFact::Suppressing { .. }) => "suppressing",
        Fact::Agent(_, AgentFact::SuppressionEnded { .. }) => "suppression-ended",
        Fact::Agent(_, AgentFact::Rested { .. }) => "rested",
        Fact::Agent(_, AgentFact::LocalMinimum { .. }) => "local-minimum",
        Fact::Agent(_, AgentFact::Blocked { .. }) => "blocked",
        Fact::Agent(_, AgentFact::GaveWay { .. }) => "gave-way",
        Fact::Agent(_, AgentFact::Relocated { .. }) => "relocated",
        Fact::Agent(_, AgentFact::Halted { .. }) => "halted",
        Fact::Agent(_, AgentFact::RelocationFailed { .. }) => "relocation-failed",
        Fact::Agent(_, AgentFact::Refilling { .. }) => "refilling",
        Fact::Ended { .. } => "ended",
    }
}

fn detail(fact: &Fact) -> String {
    match fact {
        Fact::Agent(_, AgentFact::StartMoved { from, .. }) => {
            format!("from_x_m={}; from_y_m={}; from_heading_rad={}", from.x, from.y, from.heading)
        }
        Fact::Agent(_, AgentFact::RoadmapBuilt { samples, edges, components, .. }) => {
            format!("samples={samples}; edges={edges}; components={components}")
        }
        Fact::Agent(_, AgentFact::OutOfReach { cells, .. }) => {
            let cells: Vec<_> = cells.iter().map(|&cell| short(cell)).collect();
            format!("cells={}", cells.join(" "))
        }
        Fact::Fire(FireFact::Ignited { cause, .. }) => cause_text(*cause),
        Fact::Agent(_, AgentFact::Planned { trajectory, effort, found_by, .. }) => {
            let by_lattice = found_by.is_some_and(FoundBy::is_after_failure);
            let found_by = found_by.map_or_else(String::new, |found_by| format!("; found_by={found_by}"));
            format!("{}; {}; by_lattice={by_lattice}{found_by}", leg(trajectory), expansions(*effort))
        }
        Fact::Agent(_, AgentFact::PlanFailed { reason, effort, until, .. }) => {
            format!("reason={reason}; {}; until_s={}", expansions(*effort), seconds(*until))
        }
        Fact::Agent(_, AgentFact::Dropped { trajectory, .. }) => leg(trajectory),
        Fact::Agent(_, AgentFact::Searched { phase, graph, .. }) => {
            format!("phase={phase}; places={}; edges={}", graph.places.len(), graph.edges.len())
        }
        Fact::Agent(_, AgentFact::Blocked { by, .. }) => format!("by={by}"),
        Fact::Agent(_, AgentFact::GaveWay { to, trajectory, .. }) => format!("to={to}; {}", leg(trajectory)),
        Fact::Agent(_, AgentFact::Relocated { x_m, y_m, trajectory, effort, found_by }) => {
            let leg = leg(trajectory);
            let expansions = expansions(*effort);
            format!("x_m={x_m}; y_m={y_m}; {leg}; {expansions}; found_by={found_by}")
        }
        Fact::Agent(_, AgentFact::Halted { trajectory }) => leg(trajectory),
        Fact::Agent(_, AgentFact::RelocationFailed { x_m, y_m, reason, effort, until }) => {
            let reason = reason.map_or_else(|| "in-the-way".to_owned(), |reason| reason.to_string());
            let expansions = expansions(*effort);
            let until = seconds(*until);
            format!("x_m={x_m}; y_m={y_m}; reason={reason}; {expansions}; until_s={until}")
        }
        Fact::Agent(_, AgentFact::Refilling { until }) => format!("until_s={}", seconds(*until)),
        Fact::Agent(_, AgentFact::Rested { reason, .. }) => format!("reason={reason}"),
        Fact::Agent(_, AgentFact::LocalMinimum { x_m, y_m, .. }) => format!("x_m={x_m}; y_m={y_m}"),
        Fact::Ended { reason } => format!("reason={reason}"),
        // One portion is the usual amount of a stop, and no detail.
        &Fact::Agent(_, AgentFact::Suppressing { water_units, .. }) if water_units > 1 => {
            format!("portions={water_units}")
        }
        Fact::Fire(FireFact::BurnedOut { .. })
        | Fact::Fire(FireFact::Extinguished { .. })
        | Fact::Agent(_, AgentFact::Suppressing { .. })
        | Fact::Agent(_, AgentFact::SuppressionEnded { .. }) => String::new(),
    }
}

fn short(cell: Cell) -> String {
    format!("{}:{}", cell.col, cell.row)
}

fn leg(trajectory: &Trajectory) -> String {
    let starts = seconds(trajectory.start_time());
    let ends = seconds(trajectory.end_time());
    let distance_m = trajectory.distance_m(SimTime::MAX);
    let cusps = trajectory.cusps();
    format!("starts_s={starts}; ends_s={ends}; distance_m={distance_m}; cusps={cusps}")
}

fn expansions(effort: Effort) -> String {
    format!("roadmap_expansions={}; local_expansions={}", effort.roadmap_expansions, effort.local_expansions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{self, TRUCK};

    fn events(timeline: &Timeline) -> String {
        let mut bytes = Vec::new();
        write_events(timeline, &mut bytes).expect("memory takes all");
        String::from_utf8(bytes).expect("it is text")
    }

    fn trace(timeline: &Timeline, step_s: f64) -> String {
        let mut bytes = Vec::new();
        let sampling = Sampling::new(timeline, step_s, &[]).expect("a step");
        write_trace(timeline, &sampling, &mut bytes).expect("memory takes all");
        String::from_utf8(bytes).expect("it is text")
    }

    #[test]
    fn every_fact_is_one_line() {
        let timeline = sample::by_hand();
        let text = events(&timeline);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 1 + timeline.events.len());
        assert_eq!(lines[0], "t_s,event,agent,col,row,detail");
        assert_eq!(lines[1], "0.000000000,start-moved,unimog/0,,,from_x_m=9; from_y_m=30; from_heading_rad=0");
        assert_eq!(lines[3], "0.000000000,out-of-reach,wumpus/0,,,cells=8:8");
        assert_eq!(lines[6], "10.000000000,ignited,wumpus/0,1,1,cause=lit");
        let plan = "starts_s=12.000000000; ends_s=15.000000000; distance_m=24; cusps=1";
        let expansions = "roadmap_expansions=5; local_expansions=7";
        assert_eq!(
            lines[8],
            format!("10.000000000,planned,unimog/0,1,1,{plan}; {expansions}; by_lattice=false; found_by=roadmap")
        );
        assert_eq!(lines[10], "16.000000000,ignited,,5,2,cause=spread; from=1:1");
        let failure = "reason=disconnected; roadmap_expansions=0; local_expansions=30; until_s=19.000000000";
        assert_eq!(lines[12], "17.000000000,local-minimum,wumpus/0,2,9,x_m=34.5; y_m=-0");
        assert_eq!(lines[13], format!("17.000000000,plan-failed,wumpus/0,2,9,{failure}"));
        assert_eq!(lines[14], "19.000000000,rested,wumpus/0,,,reason=nothing left to light");
        assert_eq!(lines[28], "90.000000000,ended,,,,reason=nothing left");
    }

    #[test]
    fn trucks_that_meet_are_reported() {
        let text = events(&sample::meeting());
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[3], "10.000000000,blocked,unimog/0,1,1,by=unimog/1");
        let way = "starts_s=14.000000000; ends_s=16.000000000; distance_m=16; cusps=0";
        assert_eq!(lines[4], format!("14.000000000,gave-way,unimog/1,,,to=unimog/0; {way}"));
        let trace = trace(&sample::meeting(), 12.0);
        assert!(trace.contains("12.000000000,unimog/0,10,30,0,0,waiting\n"), "{trace}");
    }

    #[test]
    fn searches_are_reported_by_their_sizes() {
        let text = events(&sample::searched());
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[2], "10.000000000,searched,unimog/0,,,phase=roadmap; places=4; edges=3");
        assert_eq!(lines[5], "10.000000000,searched,unimog/0,,,phase=local; places=3; edges=2");
    }

    #[test]
    fn a_trace_reads_back_as_the_states_it_samples() {
        let timeline = sample::random(3, SimTime::from_seconds(60.25));
        let text = trace(&timeline, 0.1);
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let rows: Vec<_> = reader.records().map(|row| row.expect("rows are well formed")).collect();
        let agents = timeline.setting.agents.len();
        assert_eq!(rows.len(), (603 + 1) * agents);
        for (sample, pair) in rows.chunks(agents).enumerate() {
            let time = SimTime::from_nanos(sample as u64 * 100_000_000).min(timeline.end_time());
            for (row, agent) in pair.iter().zip(timeline.state_at(time).agents) {
                let number = |column: usize| row[column].parse::<f64>().expect("a number");
                assert_eq!(number(0), time.as_seconds());
                assert_eq!(row[1], agent.id.to_string());
                assert_eq!([number(2), number(3), number(4)], [agent.pose.x, agent.pose.y, agent.pose.heading]);
                assert_eq!((number(5), &row[6]), (agent.speed_mps, agent.activity.name()));
            }
        }
        assert!(rows.last().expect("there are rows")[0].starts_with("60.25"));
    }

    #[test]
    fn a_trace_of_one_agent_has_its_rows_of_the_whole_one() {
        let timeline = sample::by_hand();
        let mut bytes = Vec::new();
        let sampling = Sampling::new(&timeline, 1.0, &[TRUCK]).expect("it is there");
        write_trace(&timeline, &sampling, &mut bytes).expect("memory takes all");
        let of_truck = String::from_utf8(bytes).expect("it is text");
        let whole = trace(&timeline, 1.0);
        let expected = whole.lines().filter(|line| line.starts_with("t_s") || line.contains("unimog/0"));
        assert!(of_truck.lines().eq(expected));
    }
}
