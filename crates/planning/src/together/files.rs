//! Instances and solutions in the benchmark's YAML.
//!
//! Its yaw is clockwise: a vehicle faces (cos yaw, -sin yaw), so headings change their sign here. A file is read by events
//! into a small tree, whose size is bounded by the file's: aliases, which could make more of it, are refused.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::ops::RangeInclusive;

use glam::DVec2;
use saphyr_parser::{Event, Parser};
use thiserror::Error;

use super::judge::Schedule;
use super::{Instance, Route, Vehicle};
use wildfire_base::geometry::Pose;
use wildfire_base::untrusted::visible_start;

/// Most bytes of a file.
pub const MAX_BYTES: u64 = 32 << 20;
const MAX_VEHICLES: usize = 500;
const MAX_OBSTACLES: usize = 2000;
const SIDE_M: RangeInclusive<f64> = 1.0..=2000.0;
/// Most states of all vehicles of a solution.
const MAX_STATES: usize = 200_000;
/// Lists and mappings inside each other.
const DEEPEST: usize = 8;

/// A fault of a file: a sentence to follow its path.
#[derive(Debug, Error, PartialEq)]
#[error("line {line}: {message}")]
pub struct FileFault {
    pub line: usize,
    pub message: String,
}

/// A value with the line that it begins in.
struct YamlNode {
    line: usize,
    content: NodeContent,
}

enum NodeContent {
    Word(String),
    List(Vec<YamlNode>),
    /// Keys with their values, in their order.
    Mapping(Vec<(String, YamlNode)>),
}

impl YamlNode {
    fn parse(text: &str) -> Result<Self, FileFault> {
        // Values that are open, each with the key that waits for its value.
        let mut open: Vec<(Self, Option<String>)> = Vec::new();
        for event in Parser::new_from_str(text) {
            let (event, span) = event.map_err(|error| fault(error.marker().line(), error.info()))?;
            let line = span.start.line();
            let mut done = match event {
                Event::MappingStart(..) => {
                    open.push((Self { line, content: NodeContent::Mapping(Vec::new()) }, None));
                    None
                }
                Event::SequenceStart(..) => {
                    open.push((Self { line, content: NodeContent::List(Vec::new()) }, None));
                    None
                }
                Event::Scalar(word, ..) => Some(Self { line, content: NodeContent::Word(word.into_owned()) }),
                Event::MappingEnd | Event::SequenceEnd => open.pop().map(|(value, _)| value.checked()).transpose()?,
                Event::Alias(_) => return Err(fault(line, "aliases are not read here; expected plain values")),
                // Beginnings and ends of streams and documents hold no value.
                _ => None,
            };
            // Nested without end a small file would take all of the stack.
            if open.len() > DEEPEST {
                return Err(fault(line, "lists and mappings are nested too deep for an instance or a solution"));
            }
            if let Some(value) = done.take() {
                match open.last_mut() {
                    // The outermost value is complete, and what follows it is not read.
                    None => return Ok(value),
                    Some((Self { content: NodeContent::List(items), .. }, _)) => items.push(value),
                    Some((Self { content: NodeContent::Mapping(members), .. }, key)) => {
                        match (key.take(), value.content) {
                            (Some(key), content) => members.push((key, Self { line: value.line, content })),
                            (None, NodeContent::Word(word)) => *key = Some(word),
                            (None, _) => return Err(fault(line, "a key is a list or a mapping; expected a word")),
                        }
                    }
                    Some((Self { content: NodeContent::Word(_), .. }, _)) => unreachable!("words are never open"),
                }
            }
        }
        Err(fault(1, "the file is empty; expected an instance or a solution"))
    }

    /// YAML forbids keys that stand twice, and readers differ in which of both they take.
    fn checked(self) -> Result<Self, FileFault> {
        let mut seen = BTreeSet::new();
        if let NodeContent::Mapping(members) = &self.content
            && let Some((key, _)) = members.iter().find(|(key, _)| !seen.insert(key))
        {
            return Err(fault(self.line, &format!("`{}` stands twice; expected it once", visible_start(key))));
        }
        Ok(self)
    }

    fn unlike(&self, name: &str, expected: &str) -> FileFault {
        let found = match &self.content {
            NodeContent::Word(word) if word.is_empty() => "empty".to_owned(),
            NodeContent::Word(word) => visible_start(word),
            NodeContent::List(items) => format!("a list of {}", items.len()),
            NodeContent::Mapping(_) => "a mapping".to_owned(),
        };
        FileFault { line: self.line, message: format!("`{name}` is {found}; expected {expected}") }
    }

    fn member(&self, key: &str) -> Result<&Self, FileFault> {
        let NodeContent::Mapping(members) = &self.content else {
            return Err(fault(self.line, &format!("expected a mapping with `{key}`")));
        };
        let found = members.iter().find(|(name, _)| name == key).map(|(_, value)| value);
        found.ok_or_else(|| fault(self.line, &format!("there is no `{key}` here")))
    }

    fn list(&self, name: &str, max: usize) -> Result<&[Self], FileFault> {
        match &self.content {
            NodeContent::List(items) if items.len() <= max => Ok(items),
            // A key without a value.
            NodeContent::Word(word) if word.is_empty() => Ok(&[]),
            _ => Err(self.unlike(name, &format!("a list of at most {max}"))),
        }
    }

    fn number(&self, name: &str, range: &RangeInclusive<f64>) -> Result<f64, FileFault> {
        let word = if let NodeContent::Word(word) = &self.content { word.as_str() } else { "" };
        let number = word.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| self.unlike(name, &format!("a number from {} to {}", range.start(), range.end())))
    }

    fn numbers<const N: usize>(&self, name: &str, range: &RangeInclusive<f64>) -> Result<[f64; N], FileFault> {
        let mut numbers = [0.0; N];
        match self.list(name, N)? {
            items if items.len() == N => {
                for (number, item) in numbers.iter_mut().zip(items) {
                    *number = item.number(name, range)?;
                }
                Ok(numbers)
            }
            _ => Err(self.unlike(name, &format!("a list of {N} numbers"))),
        }
    }
}

fn fault(line: usize, message: &str) -> FileFault {
    FileFault { line, message: message.to_owned() }
}

/// The range of all numbers in a file; the planner and the judge check places against the map.
const ANY: RangeInclusive<f64> = -1e6..=1e6;

/// Reads an instance: `agents` with `name`, `start` and `goal`, and `map` with `dimensions` and `obstacles`.
pub fn read_instance(text: &str) -> Result<Instance, FileFault> {
    let file = YamlNode::parse(text)?;
    let map = file.member("map")?;
    let [width_m, height_m] = map.member("dimensions")?.numbers("dimensions", &SIDE_M)?;
    let mut obstacles = Vec::new();
    for obstacle in map.member("obstacles")?.list("obstacles", MAX_OBSTACLES)? {
        let [x, y] = obstacle.numbers("obstacles", &ANY)?;
        // Instances without obstacles list one outside the map.
        if (x, y) != (-1.0, -1.0) {
            obstacles.push(DVec2::new(x, y));
        }
    }
    let agents = file.member("agents")?;
    let mut vehicles: Vec<Vehicle> = Vec::new();
    for agent in agents.list("agents", MAX_VEHICLES)? {
        let pose = |key: &str| -> Result<Pose, FileFault> {
            let value = agent.member(key)?;
            let [x, y, yaw] = value.numbers(key, &ANY)?;
            // Here, where the line of the file can still be named.
            if !(0.0..=width_m).contains(&x) || !(0.0..=height_m).contains(&y) {
                return Err(value.unlike(key, "a place on the map"));
            }
            // The benchmark counts yaw clockwise.
            Ok(Pose::new(x, y, -yaw))
        };
        let name = agent.member("name")?;
        let NodeContent::Word(word) = &name.content else { return Err(name.unlike("name", "a word")) };
        // Solutions and messages hold the name as it is, so it must need no quotes.
        if word.is_empty()
            || word.len() > 60
            || !word.chars().all(|letter| letter.is_ascii_alphanumeric() || "_-.".contains(letter))
        {
            return Err(name.unlike("name", "at most 60 letters, digits, and `_`, `-` or `.`"));
        }
        // Solutions name vehicles.
        if vehicles.iter().any(|vehicle| vehicle.name == *word) {
            return Err(name.unlike("name", "another name for each vehicle"));
        }
        vehicles.push(Vehicle { name: word.clone(), start: pose("start")?, goal: pose("goal")? });
    }
    if vehicles.is_empty() {
        return Err(agents.unlike("agents", "at least one vehicle"));
    }
    Ok(Instance { size_m: DVec2::new(width_m, height_m), obstacles, vehicles })
}

/// Reads a solution: `schedule` with a list of `x`, `y`, `yaw` and `t` for every vehicle; `t` counts 0, 1, 2, ...
pub fn read_solution(text: &str) -> Result<Vec<Schedule>, FileFault> {
    let file = YamlNode::parse(text)?;
    let schedule = file.member("schedule")?;
    let NodeContent::Mapping(members) = &schedule.content else {
        return Err(schedule.unlike("schedule", "a list of states for each vehicle"));
    };
    let mut left = MAX_STATES;
    let mut schedules = Vec::new();
    for (name, states) in members {
        let mut poses = Vec::new();
        for (step, state) in states.list(name, left)?.iter().enumerate() {
            let number = |key: &str| state.member(key)?.number(key, &ANY);
            let time = state.member("t")?;
            // Times of a solution are its steps; a gap would be a jump.
            if time.number("t", &ANY)? != step as f64 {
                return Err(time.unlike("t", &format!("{step}, since steps count 0, 1, 2 and so on")));
            }
            poses.push(Pose::new(number("x")?, number("y")?, -number("yaw")?));
        }
        // One bound for all vehicles, as memory is taken by their sum.
        left -= poses.len();
        schedules.push(Schedule { name: name.clone(), poses });
    }
    Ok(schedules)
}

/// Writes a solution as the benchmark's program does, with all digits; the runtime is in seconds.
pub fn write_solution(instance: &Instance, routes: &[Route], cpu_s: f64) -> String {
    let cost: f64 = routes.iter().map(Route::cost).sum();
    let makespan = routes.iter().map(Route::flowtime_m).fold(0.0, f64::max);
    let flowtime = routes.iter().map(Route::flowtime_m).sum::<f64>();
    let mut text = format!(
        "statistics:\n  cost: {cost}\n  makespan: {makespan}\n  flowtime: {flowtime}\n  runtime: {cpu_s}\nschedule:\n"
    );
    for (vehicle, route) in instance.vehicles.iter().zip(routes) {
        text += &format!("  {}:\n", vehicle.name);
        for (step, pose) in route.poses().enumerate() {
            // 0 without a sign.
            let yaw = 0.0 - pose.heading;
            writeln!(text, "    - x: {}\n      y: {}\n      yaw: {yaw}\n      t: {step}", pose.x, pose.y)
                .expect("strings take all text");
        }
    }
    text
}
