//! A run as one JSON object, and the JSON Schema of it.
//!
//! The types of this module fix names and units of what is written, whatever the program's own types become. Times are whole
//! nanoseconds, cells are `[column, row]`, agents have the names of tables, and numbers are the shortest decimals that
//! read back as the same `f64`. Lists are written as they are gone through, so that a run of millions of facts takes no
//! more memory than it does anyway.

mod happenings;
mod legs;
mod setting;

use std::borrow::Cow;
use std::fmt;
use std::io::Write;

use schemars::{JsonSchema, Schema, SchemaGenerator, schema_for};
use serde::ser::Error;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value as Json};

use happenings::{EventObject, FireObject, LineObject, WettingObject, fires, line, wettings};
use legs::{LegObject, LegTable};
use setting::SettingObject;

use super::ExportError;
use crate::{AgentId, Event, Outcome, RunIndex, Timeline, Winner};
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::query::PlanFailure;

/// The version of the object: it changes when something is renamed, removed or comes to mean something else.
const FORMAT: u32 = 1;

/// Writes a run as one JSON object on one line.
pub fn write_json(timeline: &Timeline, mut to: impl Write) -> Result<(), ExportError> {
    let index = RunIndex::new(timeline);
    let legs = LegTable::new(&index);
    serde_json::to_writer(&mut to, &RunObject::new(&index, &legs))?;
    Ok(to.write_all(b"\n")?)
}

/// Returns the JSON Schema of the object.
pub fn schema() -> Schema {
    schema_for!(RunObject<'static>)
}

/// A run: where it took place and between whom, what happened, and what came of it.
///
/// Times are whole nanoseconds since the beginning. Places are metres east and north of the field's south-west corner,
/// headings radians counter-clockwise from east, cells [column, row] with (0, 0) at the south-west corner.
#[derive(Serialize, JsonSchema)]
#[schemars(title = "A run")]
struct RunObject<'a> {
    /// The version of this form.
    format: u32,
    /// The program that simulated the run.
    program_version: &'a str,
    scenario: &'a str,
    seed: u64,
    /// When the run ended.
    ended_ns: u64,
    /// Who has the higher score.
    #[schemars(with = "WinnerName")]
    winner: Winner,
    setting: SettingObject<'a>,
    /// Events of agents and bushes, in order of time. Events of ground are among the fires, the wettings and the line.
    #[schemars(with = "Vec<EventObject<'static>>")]
    events: Events<'a>,
    /// The paths that agents followed, agent by agent, each in order of time.
    #[schemars(with = "Vec<LegObject>")]
    legs: Legs<'a>,
    /// Every time that a bush or a cell of ground burned, in order of time.
    fires: Vec<FireObject>,
    /// Cells that trucks wetted so that they could not burn for a while, in order of time.
    wettings: Vec<WettingObject>,
    /// Cells of line that crews built, in order of time.
    line: Vec<LineObject>,
    /// The outcome in numbers, as in the tables of batches.
    outcome: OutcomeObject<'a>,
}

impl<'a> RunObject<'a> {
    fn new(index: &'a RunIndex<'a>, legs: &'a LegTable) -> Self {
        let timeline = index.timeline();
        Self {
            format: FORMAT,
            program_version: &timeline.setting.program_version,
            scenario: &timeline.setting.scenario,
            seed: timeline.setting.seed,
            ended_ns: index.end_time().as_nanos(),
            winner: index.outcome().winner(),
            setting: SettingObject::from(&timeline.setting),
            events: Events { events: &timeline.events, legs },
            legs: Legs { timeline, legs },
            fires: fires(index),
            wettings: wettings(index),
            line: line(index),
            outcome: OutcomeObject(index.outcome()),
        }
    }
}

#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
#[expect(dead_code, reason = "its schema is what is wanted")]
enum WinnerName {
    Wumpus,
    Unimog,
    Tie,
}

/// The events, made one by one.
struct Events<'a> {
    events: &'a [Event],
    legs: &'a LegTable,
}

impl Serialize for Events<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let events = self.events.iter().enumerate();
        serializer.collect_seq(events.map(|(place, event)| EventObject::new(event, self.legs.leg_of(place))))
    }
}

/// The legs, made one by one.
struct Legs<'a> {
    timeline: &'a Timeline,
    legs: &'a LegTable,
}

impl Serialize for Legs<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.legs.iter().map(|leg| LegObject::new(leg, self.timeline)))
    }
}

/// The name of an agent, such as `unimog/0`.
#[derive(Clone, Copy, Debug)]
struct AgentLabel(AgentId);

impl Serialize for AgentLabel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl JsonSchema for AgentLabel {
    fn schema_name() -> Cow<'static, str> {
        "AgentName".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "type": "string",
            "description": "An agent: wumpus/N or unimog/N, N from 0 on.",
            "pattern": "^(wumpus|unimog)/[0-9]+$",
        })
    }
}

/// A word that the program prints too.
struct PrintedWord<T>(T);

impl<T: fmt::Display> Serialize for PrintedWord<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

/// A column and a row.
fn pair(cell: Cell) -> [u16; 2] {
    [cell.col, cell.row]
}

/// A place and a heading; of a truck, the place is the middle of its rear axle.
#[derive(Serialize, JsonSchema)]
struct PoseObject {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
}

impl From<Pose> for PoseObject {
    fn from(Pose { x, y, heading }: Pose) -> Self {
        Self { x_m: x, y_m: y, heading_rad: heading }
    }
}

/// The outcome with the names of tables: agents as `unimog/0`, failures by their reasons.
struct OutcomeObject<'a>(&'a Outcome);

impl Serialize for OutcomeObject<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut outcome = serde_json::to_value(self.0).map_err(S::Error::custom)?;
        let agents = outcome.get_mut("agents").and_then(Json::as_array_mut).into_iter().flatten();
        for (object, agent) in agents.zip(&self.0.agents) {
            object["agent"] = agent.agent.to_string().into();
            let counts = PlanFailure::ALL.map(|reason| (reason.to_string(), Json::from(agent.failures[reason])));
            object["failures"] = counts.into_iter().collect();
        }
        outcome.serialize(serializer)
    }
}

impl JsonSchema for OutcomeObject<'_> {
    fn schema_name() -> Cow<'static, str> {
        "Outcome".into()
    }

    /// The numbers are those of the run that has them all, one that is not there being left out or null.
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let number = || Json::from(schemars::json_schema!({ "type": ["number", "null"] }));
        let counts: Map<String, Json> = PlanFailure::ALL
            .into_iter()
            .map(|reason| (reason.to_string(), schemars::json_schema!({ "type": "integer", "minimum": 0 }).into()))
            .collect();
        let agent = generator.subschema_for::<AgentLabel>();
        schemars::json_schema!({
            "type": "object",
            "description": "Counts, times in seconds and scores; the columns of the same names in tables say what each means.",
            "properties": {
                "agents": {
                    "type": "array",
                    "items": {
                        "type": "object",
                        "properties": {
                            "agent": agent,
                            "failures": { "type": "object", "properties": counts },
                        },
                        "additionalProperties": number(),
                        "required": ["agent", "failures"],
                    },
                },
                "ground": { "type": "object", "additionalProperties": number() },
            },
            "additionalProperties": number(),
            "required": ["agents"],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GroundFact, sample};
    use wildfire_base::time::SimTime;

    fn object(timeline: &Timeline) -> Json {
        let mut bytes = Vec::new();
        write_json(timeline, &mut bytes).expect("memory takes all");
        serde_json::from_slice(&bytes).expect("it is JSON")
    }

    #[test]
    fn a_run_written_by_hand_has_these_members() {
        let timeline = sample::by_hand();
        let run = object(&timeline);
        assert_eq!(run["ended_ns"], 90_000_000_000_u64);
        assert_eq!(run["events"].as_array().expect("a list").len(), timeline.events.len());
        assert_eq!(run["setting"]["agents"][1]["agent"], "unimog/0");
        let ignition = &run["events"][5];
        assert_eq!(
            (&ignition["event"], &ignition["cause"], &ignition["agent"]),
            (&"ignited".into(), &"lit".into(), &"wumpus/0".into())
        );
        assert_eq!((&ignition["t_ns"], &ignition["cell"]), (&10_000_000_000_u64.into(), &serde_json::json!([1, 1])));
        let planned = &run["events"][7];
        let leg = &run["legs"][planned["leg"].as_u64().expect("it has a leg") as usize];
        assert_eq!((&leg["agent"], &leg["event"]), (&"unimog/0".into(), &7.into()));
        assert_eq!(run["winner"], "wumpus");
        assert_eq!(run["outcome"]["agents"][1]["failures"]["budget spent"], 1);
    }

    #[test]
    fn legs_are_where_their_agents_are() {
        let timeline = sample::random(7, SimTime::from_seconds(400.0));
        let run = object(&timeline);
        let index = RunIndex::new(&timeline);
        let legs = run["legs"].as_array().expect("a list");
        assert!(legs.len() > 3, "{} legs", legs.len());
        for leg in legs {
            let agent = timeline.setting.agents.iter().position(|start| leg["agent"] == start.id.to_string());
            let time = SimTime::from_nanos(leg["from_ns"].as_u64().expect("a time"));
            let leg_then = index.leg_at(agent.expect("it takes part"), time).expect("it follows one");
            let trajectory = leg_then.trajectory(&timeline);
            if leg["event"] == leg_then.fact() {
                assert_eq!(leg["start"]["x_m"].as_f64(), Some(trajectory.start().x));
                assert_eq!(leg["pieces"].as_array().expect("a list").len(), trajectory.pieces().len());
            }
        }
    }

    #[test]
    fn fires_are_as_many_as_ignitions_and_end_as_states_say() {
        for timeline in [sample::by_hand(), sample::random(2, SimTime::from_seconds(300.0)), sample::on_ground()] {
            let run = object(&timeline);
            let index = RunIndex::new(&timeline);
            let outcome = index.outcome();
            let fires = run["fires"].as_array().expect("a list");
            let of_bushes = fires.iter().filter(|fire| fire["ground"] == false);
            let ignitions = outcome.lit_by_wumpus + outcome.caught_by_spread + outcome.lit_by_schedule;
            assert_eq!(of_bushes.count(), ignitions as usize);
            let burning = fires.iter().filter(|fire| fire["ground"] == false && fire["ended_ns"].is_null()).count();
            assert_eq!(burning, outcome.burning as usize);
        }
    }

    #[test]
    fn line_that_crews_built_is_listed() {
        let mut timeline = sample::on_ground();
        let mut cleared = *timeline.ground.last().expect("ground burns");
        cleared.fact = GroundFact::Cleared { flank: 1, along_mm: 12_500, holds: true };
        timeline.ground.push(cleared);
        let cell = pair(cleared.cell);
        let built_ns = cleared.time.as_nanos();
        let line = serde_json::json!([{
            "cell": cell, "built_ns": built_ns, "flank": 1, "along_m": 12.5, "holds": true
        }]);
        assert_eq!(object(&timeline)["line"], line);
    }

    #[test]
    fn every_member_is_in_the_schema() {
        let schema = schema().to_value();
        let run = object(&sample::on_ground());
        for name in run.as_object().expect("it is an object").keys() {
            assert!(schema["properties"].get(name).is_some(), "{name}");
        }
    }
}
