//! Planning problems for a truck as files: a field, a truck on it, and its goals.
//!
//! A problem is a JSON map (see [`ImportedField`]) with more members: `start` and `goals` as `[x, y, heading]` of the rear
//! axle, in metres and radians, and the `vehicle`, in metres. Members of other names are ignored, so that other
//! programs may keep theirs. The format is described in `scenarios/README.md`.

use std::fmt;
use std::ops::Range;
use std::path::Path;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::error::Category;

use super::source::{MAX_MAP_BYTES, read_text};
use crate::faults::check::{self, Check, TablePath};
use crate::faults::error::{Fault, ScenarioError, SourceLocation};
use crate::faults::json_location::{character_at, locate, offset};
use crate::faults::path::{FieldPath, PathStep};
use crate::faults::wording;
use crate::keys::unimog::check_planners;
use crate::{Field, ImportedField, Scenario, Terrain, TerrainError, Unimog};
use wildfire_base::geometry::{DVec2, FieldFrame, Pose};
use wildfire_base::input_file::list_of_at_most;
use wildfire_base::vehicle::Dimensions;
use wildfire_planning::{Goal, GoalDisc};

/// The most goals of a problem.
pub const MAX_GOALS: usize = 10_000;

/// The most goals, and numbers of one place, that are kept of a file before it is refused for having too many.
const MAX_GOAL_MEMBERS: usize = 10 * MAX_GOALS;
const MAX_NUMBERS: usize = 100;

/// The largest coordinates, radii and angles that are read.
const LARGEST: f64 = 1e6;

/// Smallest and largest side of a cell, metres.
const CELLS_M: [f64; 2] = [0.01, 1000.0];

/// Lowest and highest speed, m/s.
const SPEEDS_MPS: [f64; 2] = [0.001, 1000.0];

/// The tolerance between the two ways to state the place of the front bumper, metres.
const ROUNDING_M: f64 = 1e-6;

/// A planning problem: a field, a truck on it, and its goals.
#[derive(Clone, Debug)]
pub struct Problem {
    pub name: String,
    pub terrain: Terrain,
    /// Body, speeds and planner settings.
    pub truck: Unimog,
    /// Like a goal, it may be blocked or NaN: planners report that.
    pub start: Pose,
    pub goals: Vec<Goal>,
}

impl Problem {
    /// Reads a file. What it does not say about the truck is taken from `truck`; limits of acceleration and settings of
    /// planners always are.
    ///
    /// # Errors
    /// Returns the first fault with its location: not such a file, a cell outside the field, an impossible vehicle,
    /// more than [`MAX_GOALS`] goals, a field that is too large for the planners' settings.
    pub fn open(path: &Path, truck: &Unimog) -> Result<Self, Box<ScenarioError>> {
        let text = read_text(path, MAX_MAP_BYTES).map_err(Fault::nowhere)?;
        let file = ProblemFile { name: path.display().to_string(), text: &text };
        let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        file.problem(stem, truck)
    }

    /// Takes the field of a scenario's run with this seed, and its first truck at its start; no goals. Returns `None`
    /// if there is no truck.
    ///
    /// # Errors
    /// Fails as [`Terrain::from_scenario`] does.
    pub fn from_scenario(scenario: &Scenario, seed: u64) -> Result<Option<Self>, TerrainError> {
        let Some(truck) = scenario.unimog.first() else { return Ok(None) };
        let terrain = Terrain::from_scenario(scenario, seed)?;
        let start = truck.start.pose();
        Ok(Some(Self { name: scenario.name.clone(), terrain, truck: truck.clone(), start, goals: Vec::new() }))
    }
}

/// The members that are read beside those of the map.
#[derive(Deserialize)]
struct ProblemMembers {
    field: Option<Name>,
    vehicle: Option<VehicleMembers>,
    #[serde(deserialize_with = "list_of_at_most::<MAX_NUMBERS, _, _>")]
    start: Vec<Option<f64>>,
    #[serde(default, deserialize_with = "list_of_at_most::<MAX_GOAL_MEMBERS, _, _>")]
    goals: Vec<GoalMembers>,
}

/// The name of a problem: a number or a text.
struct Name(String);

impl<'de> Deserialize<'de> for Name {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameVisitor;

        impl Visitor<'_> for NameVisitor {
            type Value = Name;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number or a string in quotes")
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<Name, E> {
                Ok(Name(number.to_string()))
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Name, E> {
                Ok(Name(text.to_owned()))
            }
        }
        deserializer.deserialize_any(NameVisitor)
    }
}

#[derive(Deserialize)]
struct VehicleMembers {
    length: f64,
    width: f64,
    wheelbase: f64,
    rear_overhang: f64,
    front_from_rear_axle: Option<f64>,
    min_turn_radius: f64,
    v_max: Option<f64>,
}

/// A goal as it is written: one of the two.
#[derive(Deserialize)]
struct GoalMembers {
    /// x, y, heading.
    pose: Option<NumberList>,
    /// x, y, radius.
    disc: Option<NumberList>,
}

#[derive(Deserialize)]
#[serde(transparent)]
struct NumberList(#[serde(deserialize_with = "list_of_at_most::<MAX_NUMBERS, _, _>")] Vec<Option<f64>>);

type ReadResult<T> = Result<T, Box<ScenarioError>>;

/// A file's name and text, to locate what is wrong with it.
struct ProblemFile<'a> {
    name: String,
    text: &'a str,
}

impl ProblemFile<'_> {
    fn problem(&self, stem: String, truck: &Unimog) -> ReadResult<Problem> {
        let members = self.members()?;
        let terrain = self.terrain()?;
        let mut truck = truck.clone();
        if let Some(vehicle) = &members.vehicle {
            self.located(check_vehicle(vehicle, &terrain.frame))?;
            truck.vehicle = vehicle.body();
            (truck.speed_mps, truck.reverse_speed_mps) = match vehicle.v_max {
                Some(speed_mps) => (speed_mps, speed_mps),
                None => (truck.speed_mps, truck.reverse_speed_mps),
            };
        }
        // Settings are checked against this field: lattices and clearances have bounds that depend on its cells.
        check_planners(&truck, &terrain.frame)
            .map_err(|refusal| refusal.fault().at(self.at(locate(self.text, &FieldPath::parse("cell_m")))))?;
        let [x, y, heading] = self.three_numbers(&FieldPath::parse("start"), &members.start)?;
        Ok(Problem {
            name: self.problem_name(members.field, stem)?,
            terrain,
            truck,
            start: Pose::new(x, y, heading),
            goals: self.goals(&members.goals)?,
        })
    }

    fn members(&self) -> ReadResult<ProblemMembers> {
        // A list would be read as the members in their order.
        let start = self.text.len() - self.text.trim_start().len();
        if !self.text[start..].starts_with('{') {
            let message = "a field file is one JSON object, with `cells_cr`, `start` and `goals`".to_owned();
            return Err(Fault::Rule { message }.at(self.at(character_at(self.text, start))));
        }
        let mut json = serde_json::Deserializer::from_str(self.text);
        let members = serde_path_to_error::deserialize(&mut json)
            .map_err(|error| self.unreadable(error.inner(), FieldPath::from_serde(error.path())))?;
        // What follows the object would be passed over.
        json.end().map_err(|error| self.unreadable(&error, FieldPath::default()))?;
        Ok(members)
    }

    fn unreadable(&self, error: &serde_json::Error, path: FieldPath) -> Box<ScenarioError> {
        let at = offset(self.text, error.line(), error.column());
        let message = error.to_string();
        let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(sentence, _)| sentence);
        let fault = match error.classify() {
            Category::Data => wording::fault_from_message(message, path).fault,
            Category::Io | Category::Syntax | Category::Eof => Fault::NotJson { message: message.to_owned() },
        };
        fault.at(self.at(character_at(self.text, at)))
    }

    fn terrain(&self) -> ReadResult<Terrain> {
        let field = ImportedField::parse(self.text, Field::default().cell_m)
            .map_err(|error| Fault::from(error.fault).at(self.at(error.span)))?;
        self.located(TablePath::named("").number("cell_m", field.frame.cell_m, CELLS_M[0]..=CELLS_M[1]))?;
        Ok(Terrain::from_occupied(field.frame, field.occupied))
    }

    fn goals(&self, goals: &[GoalMembers]) -> ReadResult<Vec<Goal>> {
        self.located(TablePath::named("").count("goals", goals.len(), MAX_GOALS))?;
        let list = FieldPath::parse("goals");
        goals.iter().enumerate().map(|(number, goal)| self.goal(&list.join(PathStep::Index(number)), goal)).collect()
    }

    fn goal(&self, path: &FieldPath, goal: &GoalMembers) -> ReadResult<Goal> {
        match (&goal.pose, &goal.disc) {
            (Some(NumberList(pose)), None) => {
                let [x, y, heading] = self.three_numbers(&path.join(PathStep::key("pose")), pose)?;
                Ok(Goal::Pose(Pose::new(x, y, heading)))
            }
            (None, Some(NumberList(disc))) => {
                let path = path.join(PathStep::key("disc"));
                let [x, y, radius_m] = self.three_numbers(&path, disc)?;
                self.located(check::check_number(path.join(PathStep::Index(2)), radius_m, 0.0..=LARGEST))?;
                Ok(Goal::Disc(GoalDisc { centre: DVec2::new(x, y), radius_m }))
            }
            (pose, _) => {
                let found = if pose.is_some() { "both" } else { "neither" };
                self.refuse(path, found.into(), "either a `pose` or a `disc`")
            }
        }
    }

    /// Takes three numbers; null, which JSON writes for what is not a number, becomes NaN, and -0 becomes 0.
    fn three_numbers(&self, path: &FieldPath, numbers: &[Option<f64>]) -> ReadResult<[f64; 3]> {
        let Ok(three) = <[Option<f64>; 3]>::try_from(numbers) else {
            return self.refuse(path, format!("a list of {}", numbers.len()), "a list of three numbers");
        };
        for (index, number) in three.iter().enumerate() {
            let number = number.unwrap_or_default();
            self.located(check::check_number(path.join(PathStep::Index(index)), number, -LARGEST..=LARGEST))?;
        }
        Ok(three.map(|number| number.unwrap_or(f64::NAN) + 0.0))
    }

    fn problem_name(&self, name: Option<Name>, stem: String) -> ReadResult<String> {
        let name = name.map_or(stem, |Name(text)| text);
        self.located(check::check_name("field", &name))?;
        Ok(name)
    }

    fn refuse<T>(&self, path: &FieldPath, found: String, expected: &str) -> ReadResult<T> {
        let fault = Fault::Value { field: path.to_string(), found, expected: expected.to_owned() };
        Err(fault.at(self.at(locate(self.text, path))))
    }

    /// Adds the location of what is refused.
    fn located(&self, check: Check) -> ReadResult<()> {
        check.map_err(|refusal| refusal.fault().at(self.at(locate(self.text, &refusal.path))))
    }

    fn at(&self, span: Range<usize>) -> SourceLocation {
        SourceLocation::new(&self.name, self.text, span)
    }
}

impl VehicleMembers {
    fn body(&self) -> Dimensions {
        Dimensions {
            length_m: self.length,
            width_m: self.width,
            wheelbase_m: self.wheelbase,
            // Its range holds -0, which is 0.
            rear_overhang_m: self.rear_overhang + 0.0,
            turning_radius_m: self.min_turn_radius,
            ..Dimensions::default()
        }
    }
}

fn check_vehicle(vehicle: &VehicleMembers, frame: &FieldFrame) -> Check {
    let table = TablePath::named("vehicle");
    table.settings(&vehicle.body(), frame).map_err(|mut refusal| {
        refusal.path = in_names_of_field_files(&refusal.path);
        refusal
    })?;
    if let Some(v_max) = vehicle.v_max {
        table.number("v_max", v_max, SPEEDS_MPS[0]..=SPEEDS_MPS[1])?;
    }
    let front_m = vehicle.length - vehicle.rear_overhang;
    match vehicle.front_from_rear_axle {
        Some(found) if (found - front_m).abs() > ROUNDING_M => {
            let expected = format!("at most the length ahead of the rear axle, {front_m}");
            table.refuse("front_from_rear_axle", found.to_string(), expected)
        }
        _ => Ok(()),
    }
}

/// Translates a path to a value of the vehicle from the names of scenarios to those of field files.
fn in_names_of_field_files(path: &FieldPath) -> FieldPath {
    let name = |step: &PathStep| match step {
        PathStep::Key(name) if name == "turning_radius_m" => PathStep::key("min_turn_radius"),
        PathStep::Key(name) => PathStep::key(name.trim_end_matches("_m")),
        PathStep::Index(_) => step.clone(),
    };
    FieldPath(path.0.iter().map(name).collect())
}
