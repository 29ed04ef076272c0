//! Export of a run for robotics log viewers such as Foxglove: MCAP, with messages in JSON.
//!
//! | topic | message | when |
//! |---|---|---|
//! | `/cells` | `foxglove.Grid`: state and colour of every cell | when cells change |
//! | `/counts` | `wildfire.Counts` | with them |
//! | `/bodies` | `foxglove.SceneUpdate`: a box in the frame of each agent | at the start |
//! | `/unimog/0/frame` | `foxglove.FrameTransform` | at samples, unless it stands |
//! | `/unimog/0/state` | `wildfire.Agent` | at samples, unless nothing changes |
//! | `/unimog/0/way` | `foxglove.SceneUpdate`: the leg as a line | when a leg begins |
//! | `/unimog/0/search/local` | `foxglove.SceneUpdate`: what searches looked at | where recorded |
//! | `/events` | `foxglove.Log` | when something happens |
//!
//! A viewer that jumps to a time uses the last message of each topic before it. So every message is complete: none has to
//! be combined with others.

mod container;
mod messages;
mod scene;

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;

use container::{ChannelId, McapWriter};
use messages::{AgentMessage, CountsMessage, FrameTransform, Grid, Log, Message, SceneUpdate};
use scene::CellGrid;

use wildfire_base::query::SearchPhase;
use wildfire_base::time::SimTime;
use wildfire_fire::BushStateKind;
use wildfire_timeline::export::{
    EventText, ExportError, ExportedChange, Sampling, cell_changes, event_text, ground_event_text,
};
use wildfire_timeline::{AgentFact, AgentId, AgentState, Event, Fact, FollowedLeg, GroundEvent, RunIndex, Timeline};

/// The most cells of a field whose states are written.
pub const MAX_CELLS_OF_MCAP: usize = 1 << 22;

/// The bytes that the states of cells may take in a file: if they would take more, they are written less often.
const MAX_BYTES_OF_CELLS: usize = 1 << 27;

/// Writes a run as MCAP: agents where they are sampled, all else when it happens.
///
/// # Errors
/// More samples than [`MAX_SAMPLES`](wildfire_timeline::export::MAX_SAMPLES), a field of more cells than
/// [`MAX_CELLS_OF_MCAP`], and those of the disk.
pub fn write_mcap(timeline: &Timeline, sampling: &Sampling, to: impl Write) -> Result<(), ExportError> {
    sampling.check_count()?;
    let found = timeline.setting.frame.cell_count();
    if found > MAX_CELLS_OF_MCAP {
        return Err(ExportError::FieldTooLarge { found, limit: MAX_CELLS_OF_MCAP });
    }
    let index = RunIndex::new(timeline);
    let mut scene = SceneWriter::begin(&index, sampling, to)?;
    for (time, moment) in moments(&index, sampling) {
        scene.write(time, &moment)?;
    }
    Ok(scene.file.finish()?)
}

/// Something to write at a time.
enum McapMoment<'a> {
    Bodies,
    /// The changes of cells since the last ones.
    Cells(Vec<ExportedChange>),
    Event(&'a Event),
    GroundEvent(&'a GroundEvent),
    /// Of the agent at this place.
    Leg(usize, FollowedLeg),
    /// And the time of the next sample.
    Sample(SimTime),
}

/// All that is to be written, in order of time.
fn moments<'a>(index: &'a RunIndex<'a>, sampling: &Sampling) -> Vec<(SimTime, McapMoment<'a>)> {
    let timeline = index.timeline();
    let end = index.end_time();
    let mut moments = vec![(SimTime::ZERO, McapMoment::Bodies)];
    moments.extend(cell_moments(index));
    let ground = timeline.ground.iter().filter(|event| event.agent().is_some());
    moments.extend(ground.map(|event| (event.time, McapMoment::GroundEvent(event))));
    moments.extend(timeline.events.iter().map(|event| (event.time, McapMoment::Event(event))));
    // Legs come after the facts of their instant, since a leg begins because of one of them.
    for &agent in sampling.agents() {
        moments.extend(index.legs_of(agent).iter().map(|&leg| (leg.from, McapMoment::Leg(agent, leg))));
    }
    let times: Vec<SimTime> = sampling.times().collect();
    let next = times.iter().skip(1).chain([&end]);
    moments.extend(times.iter().zip(next).map(|(&time, &next)| (time, McapMoment::Sample(next))));
    moments.retain(|(time, _)| *time <= end);
    // The sort is stable.
    moments.sort_by_key(|(time, _)| *time);
    moments
}

/// When the states of cells are written: at the start, and whenever some change, unless that is too often.
fn cell_moments<'a>(index: &RunIndex<'_>) -> Vec<(SimTime, McapMoment<'a>)> {
    let end = index.end_time();
    let changes = cell_changes(index);
    let instants = changes.chunk_by(|one, other| one.time == other.time).count();
    // It is at least 2, since the gap is divided by one less.
    let max = (MAX_BYTES_OF_CELLS / CellGrid::message_bytes(index.timeline().setting.frame).max(1)).max(2);
    let gap = if instants < max { 0 } else { end.as_nanos() / (max as u64 - 1) };
    let mut moments: Vec<(SimTime, Vec<ExportedChange>)> = vec![(SimTime::ZERO, Vec::new())];
    for change in changes {
        let (last, pending) = moments.last_mut().expect("there is one");
        if change.time <= *last {
            pending.push(change);
        } else {
            let due = SimTime::from_nanos(last.as_nanos().saturating_add(gap)).max(change.time).min(end);
            moments.push((due, vec![change]));
        }
    }
    moments.into_iter().map(|(time, changes)| (time, McapMoment::Cells(changes))).collect()
}

/// The channels of an agent, and what was last written to them.
struct AgentChannels {
    frame: ChannelId,
    state: ChannelId,
    way: ChannelId,
    searches: BTreeMap<SearchPhase, ChannelId>,
    last: Option<AgentState>,
}

/// Writes the messages of a run.
struct SceneWriter<'a, W> {
    index: &'a RunIndex<'a>,
    file: McapWriter<W>,
    grid: CellGrid,
    cells: ChannelId,
    counts: ChannelId,
    bodies: ChannelId,
    events: ChannelId,
    /// By place among the agents.
    agents: BTreeMap<usize, AgentChannels>,
}

impl<'a, W: Write> SceneWriter<'a, W> {
    fn begin(index: &'a RunIndex<'a>, sampling: &Sampling, to: W) -> Result<Self, ExportError> {
        let timeline = index.timeline();
        let setting = &timeline.setting;
        let mut file = McapWriter::begin(to, concat!("wildfire ", env!("CARGO_PKG_VERSION")))?;
        let about = [
            ("scenario", setting.scenario.clone()),
            ("seed", setting.seed.to_string()),
            ("program_version", setting.program_version.clone()),
            ("ended_s", index.end_time().as_seconds().to_string()),
            ("step_s", sampling.step_s().to_string()),
        ];
        file.metadata("wildfire", &about)?;
        // A channel names its schema by number, so the schemas come first.
        let grid = file.schema(Grid::SCHEMA, &Grid::schema_text())?;
        let scene = file.schema(SceneUpdate::SCHEMA, &SceneUpdate::schema_text())?;
        let frame = file.schema(FrameTransform::SCHEMA, &FrameTransform::schema_text())?;
        let log = file.schema(Log::SCHEMA, &Log::schema_text())?;
        let agent_state = file.schema(AgentMessage::SCHEMA, &AgentMessage::schema_text())?;
        let counts = file.schema(CountsMessage::SCHEMA, &CountsMessage::schema_text())?;
        let cells = file.channel(grid, "/cells")?;
        let counts = file.channel(counts, "/counts")?;
        let bodies = file.channel(scene, "/bodies")?;
        let events = file.channel(log, "/events")?;
        let searched = searched(timeline);
        let mut agents = BTreeMap::new();
        for &place in sampling.agents() {
            let id = setting.agents[place].id;
            let mut searches = BTreeMap::new();
            // These are the first and the last phase, so the range has all searches of the agent.
            for &(_, phase) in searched.range((id, SearchPhase::Roadmap)..=(id, SearchPhase::Walk)) {
                searches.insert(phase, file.channel(scene, &format!("/{id}/search/{phase}"))?);
            }
            let channels = AgentChannels {
                frame: file.channel(frame, &format!("/{id}/frame"))?,
                state: file.channel(agent_state, &format!("/{id}/state"))?,
                way: file.channel(scene, &format!("/{id}/way"))?,
                searches,
                last: None,
            };
            agents.insert(place, channels);
        }
        Ok(Self { index, file, grid: CellGrid::new(setting), cells, counts, bodies, events, agents })
    }

    fn write(&mut self, time: SimTime, moment: &McapMoment<'_>) -> Result<(), ExportError> {
        match moment {
            McapMoment::Bodies => {
                let agents = &self.index.timeline().setting.agents;
                let bodies = scene::bodies(self.agents.keys().map(|&place| &agents[place]));
                self.message(self.bodies, time, &bodies)
            }
            McapMoment::Cells(changes) => self.write_cells(time, changes),
            McapMoment::Event(event) => self.write_event(event),
            McapMoment::GroundEvent(event) => {
                let EventText { name, detail } = ground_event_text(event);
                let agent = event.agent().map_or_else(String::new, |agent| agent.to_string());
                self.log(time, agent, &[name, &event.cell.to_string(), &detail])
            }
            McapMoment::Leg(agent, leg) => {
                let timeline = self.index.timeline();
                let way = scene::way(time, &timeline.setting.agents[*agent], leg.trajectory(timeline));
                self.message(self.agents[agent].way, time, &way)
            }
            McapMoment::Sample(next) => self.write_sample(time, *next),
        }
    }

    fn write_cells(&mut self, time: SimTime, changes: &[ExportedChange]) -> Result<(), ExportError> {
        let setting = &self.index.timeline().setting;
        changes.iter().for_each(|change| self.grid.set(setting.frame.index(change.cell), change.state));
        let bushes = self.index.counts_at(time);
        let counts = CountsMessage {
            intact: bushes.count(BushStateKind::Intact),
            burning: bushes.burning(),
            burned_out: bushes.count(BushStateKind::BurnedOut),
            extinguished: bushes.count(BushStateKind::Extinguished),
            ground_burning: self.index.ground().map_or(0, |ground| ground.counts_at(time).burning),
            wumpus_score: bushes.wumpus_score(&setting.rules),
            truck_score: bushes.truck_score(&setting.rules),
        };
        let grid = self.grid.message(time);
        self.message(self.cells, time, &grid)?;
        self.message(self.counts, time, &counts)
    }

    fn write_event(&mut self, event: &Event) -> Result<(), ExportError> {
        let agent = event.fact.agent();
        if let (Fact::Agent(id, AgentFact::Searched { phase, graph }), Some(place)) =
            (&event.fact, agent.and_then(|id| self.index.timeline().setting.agent_index(id)))
            && let Some(&channel) = self.agents.get(&place).and_then(|agent| agent.searches.get(phase))
        {
            self.message(channel, event.time, &scene::search(event.time, format!("{id}/{phase}"), graph))?;
        }
        let EventText { name, detail } = event_text(&event.fact);
        let cell = event.fact.cell().map_or_else(String::new, |cell| cell.to_string());
        self.log(event.time, agent.map_or_else(String::new, |agent| agent.to_string()), &[name, &cell, &detail])
    }

    fn log(&mut self, time: SimTime, name: String, texts: &[&str]) -> Result<(), ExportError> {
        let texts: Vec<&str> = texts.iter().copied().filter(|word| !word.is_empty()).collect();
        self.message(self.events, time, &Log::new(time, name, texts.join(" ")))
    }

    /// Writes where agents are, of those only that are elsewhere than when it was last written, or will be at the next
    /// sample: a viewer draws a straight line from one message to the next.
    fn write_sample(&mut self, time: SimTime, next: SimTime) -> Result<(), ExportError> {
        // Collected first, as writing a message borrows the whole of `self`.
        let places: Vec<usize> = self.agents.keys().copied().collect();
        for place in places {
            let state = self.index.agent_at(place, time);
            let later = self.index.agent_at(place, next);
            let channels = self.agents.get_mut(&place).expect("its place is a key");
            // The last sample is always written, so that the track of an agent that stands reaches to the end.
            let is_needed = channels.last != Some(state) || later != state || time == next;
            if !is_needed {
                continue;
            }
            channels.last = Some(state);
            let frame = channels.frame;
            let channel = channels.state;
            self.message(frame, time, &FrameTransform::new(time, state.id.to_string(), state.pose))?;
            // A field of the schema cannot be absent, so -1 stands for no goal.
            let goal = state.goal.map_or([-1; 2], |goal| [i32::from(goal.col), i32::from(goal.row)]);
            let message = AgentMessage {
                x_m: state.pose.x,
                y_m: state.pose.y,
                heading_rad: state.pose.heading,
                speed_mps: state.speed_mps,
                activity: state.activity.name(),
                goal_col: goal[0],
                goal_row: goal[1],
            };
            self.message(channel, time, &message)?;
        }
        Ok(())
    }

    fn message(&mut self, channel: ChannelId, time: SimTime, message: &impl Message) -> Result<(), ExportError> {
        Ok(self.file.message(channel, time, &serde_json::to_vec(message)?)?)
    }
}

/// The phases of which searches were recorded, by agent.
fn searched(timeline: &Timeline) -> BTreeSet<(AgentId, SearchPhase)> {
    timeline
        .events
        .iter()
        .filter_map(|event| match &event.fact {
            Fact::Agent(id, AgentFact::Searched { phase, .. }) => Some((*id, *phase)),
            _ => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use lz4_flex::frame::FrameDecoder;
    use serde_json::Value as Json;

    use super::*;
    use wildfire_timeline::sample::{self, TRUCK};

    fn written(timeline: &Timeline, step_s: f64, names: &[AgentId]) -> Vec<u8> {
        let mut file = Vec::new();
        let sampling = Sampling::new(timeline, step_s, names).expect("a step");
        write_mcap(timeline, &sampling, &mut file).expect("memory takes all");
        file
    }

    fn number(bytes: &[u8]) -> u64 {
        bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte))
    }

    /// Splits records off some bytes: their kinds and contents.
    fn records(mut bytes: &[u8]) -> Vec<(u8, &[u8])> {
        let mut records = Vec::new();
        while let Some((&kind, rest)) = bytes.split_first() {
            let (length, rest) = rest.split_at(8);
            let (content, rest) = rest.split_at(number(length) as usize);
            records.push((kind, content));
            bytes = rest;
        }
        records
    }

    /// The messages of a file: topic, time and object. Checksums of chunks are checked on the way.
    fn messages(file: &[u8]) -> Vec<(String, u64, Json)> {
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("it is text");
        let body = file.strip_prefix(b"\x89MCAP0\r\n").and_then(|rest| rest.strip_suffix(b"\x89MCAP0\r\n"));
        let mut topics = BTreeMap::new();
        let mut messages = Vec::new();
        for (kind, content) in records(body.expect("it begins and ends with the same bytes")) {
            match kind {
                0x04 => {
                    let length = number(&content[4..8]) as usize;
                    topics.insert(number(&content[..2]), text(&content[8..8 + length]));
                }
                0x06 => {
                    assert_eq!(&content[28..35], b"\x03\0\0\0lz4");
                    let mut inside = Vec::new();
                    let mut frame = FrameDecoder::new(&content[35 + 8..]);
                    frame.read_to_end(&mut inside).expect("it is a frame");
                    assert_eq!(number(&content[16..24]), inside.len() as u64);
                    assert_eq!(number(&content[24..28]), u64::from(crc32fast::hash(&inside)));
                    for (kind, message) in records(&inside) {
                        assert_eq!(kind, 0x05);
                        let object = serde_json::from_slice(&message[22..]).expect("it is JSON");
                        messages.push((topics[&number(&message[..2])].clone(), number(&message[6..14]), object));
                    }
                }
                _ => {}
            }
        }
        messages
    }

    #[test]
    fn messages_are_in_order_of_time_and_channels_are_those_of_the_run() {
        for timeline in [sample::by_hand(), sample::searched(), sample::on_ground()] {
            let messages = messages(&written(&timeline, 0.5, &[]));
            assert!(messages.is_sorted_by_key(|(_, time, _)| *time));
            assert!(messages.iter().all(|(_, time, _)| *time <= timeline.end_time().as_nanos()));
            let events = messages.iter().filter(|(topic, ..)| topic == "/events").count();
            let deeds = timeline.ground.iter().filter(|event| event.agent().is_some()).count();
            assert_eq!(events, timeline.events.len() + deeds);
            let searches = messages.iter().filter(|(topic, ..)| topic.contains("/search/")).count();
            let searched =
                timeline.events.iter().filter(|event| matches!(event.fact, Fact::Agent(_, AgentFact::Searched { .. })));
            assert_eq!(searches, searched.count());
        }
    }

    #[test]
    fn between_two_samples_that_are_written_an_agent_stands_or_they_are_neighbours() {
        let timeline = sample::random(4, SimTime::from_seconds(120.0));
        let messages = messages(&written(&timeline, 0.5, &[]));
        let samples: Vec<SimTime> = Sampling::new(&timeline, 0.5, &[]).expect("a step").times().collect();
        for (place, start) in timeline.setting.agents.iter().enumerate() {
            let topic = format!("/{}/state", start.id);
            let of_agent: BTreeMap<u64, &Json> =
                messages.iter().filter(|(of, ..)| *of == topic).map(|(_, time, state)| (*time, state)).collect();
            let index = RunIndex::new(&timeline);
            for &time in &samples {
                let (_, shown) = of_agent.range(..=time.as_nanos()).next_back().expect("there is one at the start");
                let state = index.agent_at(place, time);
                assert_eq!(shown["x_m"].as_f64(), Some(state.pose.x), "{topic} at {time}");
                assert_eq!(shown["heading_rad"].as_f64(), Some(state.pose.heading), "{topic} at {time}");
                assert_eq!(shown["activity"], state.activity.name(), "{topic} at {time}");
            }
        }
    }

    #[test]
    fn agents_that_are_not_requested_have_no_channels() {
        let messages = messages(&written(&sample::by_hand(), 1.0, &[TRUCK]));
        assert!(messages.iter().any(|(topic, ..)| topic == "/unimog/0/state"));
        assert!(!messages.iter().any(|(topic, ..)| topic.starts_with("/wumpus")));
    }

    #[test]
    fn the_last_cells_are_those_of_the_end() {
        let timeline = sample::random(5, SimTime::from_seconds(300.0));
        let messages = messages(&written(&timeline, 10.0, &[]));
        let (_, _, counts) = messages.iter().rfind(|(topic, ..)| topic == "/counts").expect("they are counted");
        let outcome = wildfire_timeline::Outcome::new(&timeline);
        assert_eq!(counts["extinguished"], outcome.extinguished);
        assert_eq!(counts["burned_out"], outcome.burned_out);
        assert_eq!(counts["truck_score"].as_f64(), Some(outcome.truck_score));
    }
}
