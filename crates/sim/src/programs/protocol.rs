//! The messages between the simulation and a program that plans or decides: JSON objects, one a line.
//!
//! Metres, radians counter-clockwise from east, world frame; poses are `[x, y, heading]` of the middle of the rear axle.
//! Numbers are written so that they read back to the same f64. Members of other names are ignored on both sides.

use std::fmt;
use std::marker::PhantomData;
use std::ops::RangeInclusive;

use schemars::{JsonSchema, Schema, schema_for};
use serde::de::{IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use crate::policies::{FirelineContext, MAX_LINE_POINTS, Observation};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::input_file::list_of_at_most;
use wildfire_fire::BushState;
use wildfire_planning::MAX_SEARCH_EDGES;
use wildfire_planning::judge::MAX_SEGMENTS;
use wildfire_scenario::Crew;
use wildfire_timeline::AgentId;

/// The version of the protocol, which both sides say in their first message.
pub const VERSION: u32 = 1;

/// What is kept of the segments, or poses, of a path: one more than may pass the gate.
const KEPT_SEGMENTS: usize = MAX_SEGMENTS + 1;

/// The most choices of an answer: as many as a scenario has agents.
const MAX_CHOICES: usize = 10_000;

/// The most squares of a forecast along a side of the field.
const MAX_SQUARES: u16 = 100;

/// The largest coordinate or heading of a pose that curves are laid through.
const POSES: RangeInclusive<f64> = -1e6..=1e6;

/// A message to a program.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "kebab-case")]
pub enum ToProgram<'a> {
    /// The first message.
    Hello {
        /// The version of the protocol.
        protocol: u32,
        /// Name and version of the program that asks.
        program: String,
    },
    /// The field on which it is asked from now on.
    Field(FieldMessage<'a>),
    /// A query: how to get from here to there?
    Plan(PlanQuery),
    /// A query: who is to go where, or where do crews build line?
    Ask(AskQuery<'a>),
    /// The last message; stdin closes after it.
    End,
}

/// The field, and who drives on it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FieldMessage<'a> {
    /// The name of the scenario. The seed of the run stays secret: a program that has it could have looked at the field
    /// before.
    pub run: String,
    /// The number of the truck that it plans for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truck: Option<u16>,
    /// Seed for the program's random numbers: below 2^53, different for each run.
    pub seed: u64,
    /// Cells from west to east.
    pub cols: u16,
    /// Cells from south to north.
    pub rows: u16,
    /// The side of a cell.
    pub cell_m: f64,
    /// Column and row of each bush, from the south-west corner.
    pub cells_cr: &'a [[u16; 2]],
    /// The truck's body, or that of the first truck that the program decides for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<VehicleMessage>,
    /// The limits of the truck's speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitsMessage>,
    /// What a body keeps from bushes and from the border.
    pub least_clearance: f64,
    /// What the scenario's table of the program says as `settings`.
    pub settings: &'a Value,
    /// All agents of the run, if the program is a policy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agents: Option<Vec<String>>,
    /// The agents that it decides for, if the program is a policy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plays: Option<Vec<String>>,
}

/// A truck's body in metres, and its speeds in metres a second.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct VehicleMessage {
    /// Bumper to bumper.
    pub length: f64,
    /// Overall width.
    pub width: f64,
    /// Between the axles.
    pub wheelbase: f64,
    /// From the rear axle to the rear bumper.
    pub rear_overhang: f64,
    /// The smallest circle of the middle of the rear axle.
    pub min_turn_radius: f64,
    /// Forward.
    pub v_max: f64,
    /// In reverse.
    pub v_max_reverse: f64,
}

/// Limits of acceleration in m/s², and of steering in rad/s; null where there is none.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct LimitsMessage {
    /// Gain of speed.
    pub acceleration: Option<f64>,
    /// Loss of speed.
    pub braking: Option<f64>,
    /// Lateral acceleration in turns.
    pub lateral: Option<f64>,
    /// Turning rate of the front wheels. The truck stops where a path needs more than they turn in 0.1 s.
    pub steering: Option<f64>,
}

/// A planner's query.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct PlanQuery {
    /// Counts queries; the answer repeats it.
    pub id: u64,
    /// The pose of the truck.
    pub start: [f64; 3],
    /// The goal.
    pub goal: GoalMessage,
}

/// A goal: one of the two.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GoalMessage {
    /// The body's centre, which is `length / 2 - rear_overhang` ahead of the rear axle, in this disc: x, y, radius.
    Disc([f64; 3]),
    /// The rear axle in this pose: x, y, heading.
    Pose([f64; 3]),
}

/// A policy's query, which shows the state of the run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AskQuery<'a> {
    /// Counts queries; the answer repeats it.
    pub id: u64,
    /// Seconds since the start of the contest.
    pub t_s: f64,
    /// The agents that need a choice.
    pub agents: Vec<String>,
    /// Column and row of each cell that burns, bush or ground, and the seconds since it began.
    pub burning: &'a [(u16, u16, f64)],
    /// Column and row of cells with fuel that nothing has happened to.
    pub intact: &'a [[u16; 2]],
    /// Those that were put out.
    pub extinguished: &'a [[u16; 2]],
    /// Those that burned out.
    pub burned_out: &'a [[u16; 2]],
    /// All agents.
    pub state: Vec<AgentMessage>,
    /// The knowledge of crews that are to build line; the answer is of the type `line` then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<LineMessage<'a>>,
}

/// The knowledge of crews.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LineMessage<'a> {
    /// The crews, as in the scenario.
    pub crews: &'a [Crew],
    /// The velocity of the wind to the east and to the north, metres a second.
    pub wind_mps: [f64; 2],
    /// Cells from west to east.
    pub cols: u16,
    /// Cells from south to north.
    pub rows: u16,
    /// The side of a cell.
    pub cell_m: f64,
    /// The side of a square of `forecast_s`, a whole number of cells; the last ones may be cut off by the border.
    pub square_m: f64,
    /// Times at which fire that nobody fights first comes to squares, null where it does not: rows from south to north, each
    /// from west to east.
    pub forecast_s: Vec<Vec<Option<f64>>>,
}

/// An agent at the instant of a query.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AgentMessage {
    /// Its name, such as `unimog/0`.
    pub agent: String,
    /// Where it is.
    pub pose: [f64; 3],
    /// What it does.
    pub activity: String,
    /// Column and row of the bush that it goes for.
    pub goal: Option<[u16; 2]>,
    /// Column and row of its options, if it needs a choice.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub options: Option<Vec<[u16; 2]>>,
}

/// A message of a program.
#[derive(Clone, Debug, PartialEq, JsonSchema)]
#[schemars(tag = "type", rename_all = "kebab-case")]
pub enum FromProgram {
    /// The answer to `hello`.
    Hello(HelloAnswer),
    /// The answer to `field`: it may be asked now.
    Ready,
    /// The answer to `field` if it cannot plan there.
    Error(ErrorAnswer),
    /// The answer to `plan`: a path.
    Path(PathAnswer),
    /// The answer to `plan`: there is no path.
    None(NoneAnswer),
    /// The answer to `ask`.
    Answer(PolicyAnswer),
    /// The answer to `ask` with a `line`: where crews build.
    Line(LineAnswer),
}

#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
pub struct HelloAnswer {
    /// The version of the protocol.
    pub protocol: u32,
    /// The program's own name.
    #[serde(default)]
    pub name: Option<String>,
    /// The program's own version.
    #[serde(default)]
    pub version: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
pub struct ErrorAnswer {
    /// The reason, for people.
    pub message: String,
}

/// A path, as exactly one of `segments` and `poses`; an empty list lets the truck stay where it is.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
pub struct PathAnswer {
    /// That of the query.
    pub id: u64,
    /// Curvature in 1/m, positive to the left, and length in metres, negative in reverse: of each segment from the start
    /// on.
    #[serde(default, deserialize_with = "first_of::<KEPT_SEGMENTS, _, _>")]
    pub segments: Option<Vec<[f64; 2]>>,
    /// Poses after the start, joined by shortest Reeds-Shepp curves.
    #[serde(default, deserialize_with = "first_of::<KEPT_SEGMENTS, _, _>")]
    pub poses: Option<Vec<[f64; 3]>>,
    /// Nodes that were expanded: charged as simulated time if the scenario says so, and a column of tables.
    #[serde(default, deserialize_with = "non_null")]
    pub expansions: Option<u32>,
    /// CPU seconds that it took, for programs that plan elsewhere; it counts if it is more than what is measured.
    #[serde(default, deserialize_with = "non_null")]
    pub cpu_s: Option<f64>,
    /// Lines that the search looked at, x0, y0, x1, y1, to be drawn.
    #[serde(default, deserialize_with = "first_of::<MAX_SEARCH_EDGES, _, _>")]
    pub searched: Option<Vec<[f64; 4]>>,
}

#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
pub struct NoneAnswer {
    /// That of the query.
    pub id: u64,
    /// The reason why there is no path.
    pub reason: Reason,
    /// Nodes that were expanded.
    #[serde(default, deserialize_with = "non_null")]
    pub expansions: Option<u32>,
    /// CPU seconds that it took.
    #[serde(default, deserialize_with = "non_null")]
    pub cpu_s: Option<f64>,
    /// Lines that the search looked at.
    #[serde(default, deserialize_with = "first_of::<MAX_SEARCH_EDGES, _, _>")]
    pub searched: Option<Vec<[f64; 4]>>,
}

/// The reasons that a planner may give for having no path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Reason {
    /// The goal cannot be reached, or the search does not connect it.
    Disconnected,
    /// The truck's own pose is not free.
    StartBlocked,
    /// No free pose is in the goal.
    GoalBlocked,
    /// The planner's own budget is exhausted.
    BudgetSpent,
}

#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
pub struct PolicyAnswer {
    /// That of the query.
    pub id: u64,
    /// The choices; an agent that is left out waits for the next change.
    #[serde(deserialize_with = "list_of_at_most::<MAX_CHOICES, _, _>")]
    pub choices: Vec<ChoiceMessage>,
}

#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
pub struct LineAnswer {
    /// That of the query.
    pub id: u64,
    /// East and north of 2 to 10,000 points, in metres from the south-west corner, in the order in which crews build.
    #[serde(deserialize_with = "list_of_at_most::<MAX_LINE_POINTS, _, _>")]
    pub points: Vec<[f64; 2]>,
}

#[derive(Clone, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
pub struct ChoiceMessage {
    /// The agent's name.
    pub agent: String,
    /// Column and row of the bush to go for; null lets it wait.
    pub cell: Option<[u16; 2]>,
}

/// Reads a member that may be left out, and may not be null.
fn non_null<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

/// Reads a list that may be left out, and may not be null, and passes over what comes after its first `KEPT` items.
fn first_of<'de, const KEPT: usize, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Vec<T>>, D::Error> {
    struct FirstOf<const KEPT: usize, T>(PhantomData<T>);

    impl<'de, const KEPT: usize, T: Deserialize<'de>> Visitor<'de> for FirstOf<KEPT, T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a list")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<T>, A::Error> {
            let mut items = Vec::new();
            // The list may be as long as a program likes; only its beginning takes memory.
            while items.len() < KEPT {
                match seq.next_element()? {
                    Some(item) => items.push(item),
                    None => return Ok(items),
                }
            }
            // Read to its end, so that what follows it can be parsed.
            while seq.next_element::<IgnoredAny>()?.is_some() {}
            Ok(items)
        }
    }
    deserializer.deserialize_seq(FirstOf::<KEPT, T>(PhantomData)).map(Some)
}

impl ToProgram<'_> {
    /// Writes the message as a line.
    ///
    /// # Panics
    /// If a number is not finite, which JSON has no word for.
    pub fn line(&self) -> Vec<u8> {
        let mut line = serde_json::to_vec(self).expect("names of members are text");
        line.push(b'\n');
        line
    }
}

impl FromProgram {
    /// Returns the number of the query that it answers.
    pub fn id(&self) -> Option<u64> {
        match self {
            Self::Path(PathAnswer { id, .. })
            | Self::None(NoneAnswer { id, .. })
            | Self::Answer(PolicyAnswer { id, .. })
            | Self::Line(LineAnswer { id, .. }) => Some(*id),
            Self::Hello(_) | Self::Ready | Self::Error(_) => None,
        }
    }

    /// Reads a line. The error says in words what is wrong with it, and reads well after what the line says.
    pub fn parse(line: &[u8]) -> Result<Self, String> {
        #[derive(Deserialize)]
        struct MessageHead {
            #[serde(rename = "type")]
            kind: Option<MessageType>,
        }
        #[derive(Deserialize)]
        #[serde(rename_all = "kebab-case")]
        enum MessageType {
            Hello,
            Ready,
            Error,
            Path,
            None,
            Answer,
            Line,
        }
        let text = str::from_utf8(line).map_err(|_| "it is no UTF-8 text".to_owned())?;
        // The usual mistake: a program prints to stdout for people.
        if !text.trim_start().starts_with('{') {
            return Err("it is no JSON object; what is meant for people goes to stderr".to_owned());
        }
        // What is passed over costs little, so that the type may stand anywhere and nothing is kept of other members.
        let MessageHead { kind } = read(text)?;
        match kind.ok_or_else(|| "it has no member `type`".to_owned())? {
            MessageType::Hello => read(text).map(Self::Hello),
            MessageType::Ready => Ok(Self::Ready),
            MessageType::Error => read(text).map(Self::Error),
            MessageType::Path => {
                let path: PathAnswer = read(text)?;
                // serde has no way to say that exactly one of two members is required.
                match (&path.segments, &path.poses) {
                    (None, None) => Err("a path has `segments` or `poses`".to_owned()),
                    (Some(_), Some(_)) => Err("a path has either `segments` or `poses`, not both".to_owned()),
                    // Segments are left to the gate, but poses become curves before it sees them.
                    _ => check_cpu(path.cpu_s)
                        .and_then(|()| check_poses(path.poses.as_deref()))
                        .map(|()| Self::Path(path)),
                }
            }
            MessageType::None => {
                let none: NoneAnswer = read(text)?;
                check_cpu(none.cpu_s).map(|()| Self::None(none))
            }
            MessageType::Answer => read(text).map(Self::Answer),
            MessageType::Line => read(text).map(Self::Line),
        }
    }
}

fn check_cpu(cpu_s: Option<f64>) -> Result<(), String> {
    match cpu_s {
        Some(found) if !(0.0..=1e6).contains(&found) => Err(format!("`cpu_s` is {found}; expected 0 to 1000000")),
        _ => Ok(()),
    }
}

/// Curves are laid through poses before anybody looks at them, so their numbers must not be out of all proportion.
fn check_poses(poses: Option<&[[f64; 3]]>) -> Result<(), String> {
    let mut numbers = poses.unwrap_or_default().iter().flatten();
    match numbers.find(|number| !POSES.contains(number)) {
        Some(found) => Err(format!("a pose has the number {found}; expected -1000000 to 1000000")),
        None => Ok(()),
    }
}

/// Reads a JSON object, or says which member is wrong and why.
fn read<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, String> {
    serde_json::from_str(text).map_err(|error| {
        if !error.is_data() {
            let hint = if has_word_for_no_number(text) { "; NaN and Infinity are no numbers of JSON" } else { "" };
            return format!("it is no JSON: {}{hint}", sentence(&error));
        }
        // Following the path to each member takes time, so it is done only where somebody reads it.
        let mut json = serde_json::Deserializer::from_str(text);
        match serde_path_to_error::deserialize::<_, T>(&mut json) {
            Err(error) if error.path().iter().next().is_some() => {
                format!("`{}`: {}", error.path(), sentence(error.inner()))
            }
            _ => sentence(&error),
        }
    })
}

fn has_word_for_no_number(text: &str) -> bool {
    ["NaN", "Infinity", "nan", "inf"].iter().any(|word| text.contains(word))
}

/// Words an error with the character at which it is, since there is one line only.
fn sentence(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let text = message.rsplit_once(" at line ").map_or(message.as_str(), |(text, _)| text);
    let text = text.replace("f64", "a number").replace("u32", "a whole number").replace("u64", "a whole number");
    format!("{text} (at character {})", error.column())
}

/// The messages of both sides.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "its schema is what is wanted")]
struct Protocol {
    /// To the program, on its stdin.
    to_program: ToProgram<'static>,
    /// From the program, on its stdout.
    from_program: FromProgram,
}

/// Returns the JSON Schema of the messages of both sides.
pub fn schema() -> Schema {
    schema_for!(Protocol)
}

/// Writes the state that a policy sees, and what it is asked, as a line of text.
pub fn question(
    id: u64,
    seen: &Observation<'_>,
    options: &[(AgentId, Vec<Cell>)],
    line: Option<&FirelineContext<'_>>,
) -> Vec<u8> {
    let mut burning = Vec::new();
    let mut intact = Vec::new();
    let mut extinguished = Vec::new();
    let mut burned_out = Vec::new();
    for cell in seen.fires.with_fuel() {
        let place = [cell.col, cell.row];
        match seen.fires.state(cell) {
            Some(BushState::Burning { since }) => {
                burning.push((cell.col, cell.row, seen.now.since(since).as_seconds()));
            }
            Some(BushState::Intact) => intact.push(place),
            Some(BushState::Extinguished) => extinguished.push(place),
            Some(BushState::BurnedOut) => burned_out.push(place),
            None => {}
        }
    }
    let pair = |cell: &Cell| [cell.col, cell.row];
    let state = seen.agents.iter().map(|agent| AgentMessage {
        agent: agent.id.to_string(),
        pose: [agent.pose.x, agent.pose.y, agent.pose.heading],
        activity: agent.activity.name().to_owned(),
        goal: agent.goal.as_ref().map(pair),
        // Only those that have to decide now have options.
        options: options
            .iter()
            .find(|(queried, _)| *queried == agent.id)
            .map(|(_, cells)| cells.iter().map(pair).collect()),
    });
    let ask = AskQuery {
        id,
        t_s: seen.now.as_seconds(),
        agents: options.iter().map(|(agent, _)| agent.to_string()).collect(),
        burning: &burning,
        intact: &intact,
        extinguished: &extinguished,
        burned_out: &burned_out,
        state: state.collect(),
        line: line.map(LineMessage::from),
    };
    ToProgram::Ask(ask).line()
}

impl<'a> From<&FirelineContext<'a>> for LineMessage<'a> {
    fn from(&FirelineContext { crews, wind_mps, forecast }: &FirelineContext<'a>) -> Self {
        let FieldFrame { cols, rows, cell_m } = forecast.frame;
        let side = cols.max(rows).div_ceil(MAX_SQUARES);
        let first = |row: u16, col: u16| {
            let cells = (row..rows.min(row + side))
                .flat_map(|row| (col..cols.min(col + side)).map(move |col| Cell { col, row }));
            let times = cells.map(|cell| forecast.seconds[forecast.frame.index(cell)]);
            times.min_by(f64::total_cmp).filter(|time| time.is_finite())
        };
        let starts = |cells: u16| (0..cells).step_by(side.into());
        let forecast_s = starts(rows).map(|row| starts(cols).map(|col| first(row, col)).collect()).collect();
        let square_m = f64::from(side) * cell_m;
        Self { crews, wind_mps: wind_mps.into(), cols, rows, cell_m, square_m, forecast_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_they_were() {
        let numbers = [0.1, -0.0, 1.0 / 3.0, 5e-324, f64::MAX, 123_456_789.123_456_79, f64::EPSILON];
        for &number in &numbers {
            let plan = PlanQuery { id: 1, start: [number, 0.0, -number], goal: GoalMessage::Disc([number; 3]) };
            let line = ToProgram::Plan(plan).line();
            let value: Value = serde_json::from_slice(&line).expect("it is JSON");
            let read = value["start"][0].as_f64().expect("it is a number");
            assert_eq!(read.to_bits(), number.to_bits(), "{number}");
            assert_eq!(line.iter().filter(|&&byte| byte == b'\n').count(), 1);
        }
    }

    #[test]
    fn members_of_other_names_are_passed_over_and_the_type_may_stand_anywhere() {
        let line = br#"{"note":{"type":"none","a":[1,null]},"id":3,"segments":[[0.05,2],[0,-1.5]],"type":"path"}"#;
        let Ok(FromProgram::Path(path)) = FromProgram::parse(line) else { panic!("it is a path") };
        assert_eq!((path.id, path.segments), (3, Some(vec![[0.05, 2.0], [0.0, -1.5]])));
        assert_eq!(FromProgram::parse(b"{\"type\":\"ready\",\"more\":NaN}").map_err(|_| ()), Err(()));
        assert_eq!(FromProgram::parse(b" {\"type\":\"ready\",\"more\":1}\r\n"), Ok(FromProgram::Ready));
    }

    #[test]
    fn what_is_wrong_is_reported() {
        for (line, expected) in [
            (&b"hello"[..], "it is no JSON object"),
            (b"[1]", "it is no JSON object"),
            (b"\xff{}", "no UTF-8"),
            (b"{\"type\":\"path\",\"id\":1", "it is no JSON: EOF"),
            (b"{\"id\":1}", "no member `type`"),
            (b"{\"type\":\"track\"}", "`type`: unknown variant `track`"),
            (b"{\"type\":\"path\",\"id\":1}", "`segments` or `poses`"),
            (b"{\"type\":\"path\",\"id\":1,\"segments\":[],\"poses\":[]}", "not both"),
            (b"{\"type\":\"path\",\"segments\":[]}", "missing field `id`"),
            (b"{\"type\":\"path\",\"id\":\"1\",\"segments\":[]}", "`id`: invalid type: string"),
            (
                b"{\"type\":\"path\",\"id\":1,\"segments\":[[null,1]]}",
                "`segments[0][0]`: invalid type: null, expected a number",
            ),
            (b"{\"type\":\"path\",\"id\":1,\"segments\":[[NaN,1]]}", "NaN and Infinity are no numbers"),
            (b"{\"type\":\"path\",\"id\":1,\"segments\":[[1e999,1]]}", "number out of range"),
            (b"{\"type\":\"path\",\"id\":1,\"segments\":[[1]]}", "`segments[0]`: invalid length 1"),
            (b"{\"type\":\"path\",\"id\":1,\"segments\":null}", "`segments`: invalid type: null"),
            (b"{\"type\":\"path\",\"id\":1,\"segments\":[],\"cpu_s\":-1}", "`cpu_s` is -1"),
            (b"{\"type\":\"path\",\"id\":1,\"segments\":[],\"expansions\":null}", "`expansions`: invalid type: null"),
            (b"{\"type\":\"path\",\"id\":1,\"poses\":[[1,2,1e200]]}", "expected -1000000 to"),
            (b"{\"type\":\"none\",\"id\":1,\"reason\":\"tired\"}", "`reason`: unknown variant `tired`"),
            (b"{\"type\":\"answer\",\"id\":1,\"choices\":[{\"agent\":\"unimog/0\",\"cell\":[1]}]}", "choices[0].cell"),
            (b"{\"type\":\"line\",\"id\":1,\"points\":[[1,2],[3]]}", "`points[1]`: invalid length 1"),
        ] {
            let message = FromProgram::parse(line).expect_err("it is wrong");
            assert!(message.contains(expected), "{}: {message}", String::from_utf8_lossy(line));
        }
    }

    #[test]
    fn of_long_lists_the_beginning_is_kept() {
        let pairs = vec!["[0,1]"; 2 * MAX_SEGMENTS].join(",");
        let line = format!("{{\"type\":\"path\",\"id\":1,\"segments\":[{pairs}]}}");
        let Ok(FromProgram::Path(path)) = FromProgram::parse(line.as_bytes()) else { panic!("it is a path") };
        assert_eq!(path.segments.map(|segments| segments.len()), Some(KEPT_SEGMENTS), "which the gate refuses");
    }

    #[test]
    fn schema_names_every_message() {
        let text = schema().to_value().to_string();
        for kind in ["hello", "field", "plan", "ask", "end", "ready", "error", "path", "none", "answer", "line"] {
            assert!(text.contains(&format!("\"const\":\"{kind}\"")), "{kind} is missing");
        }
    }
}
