//! The planners of trucks by their names in scenarios: the only place that lists them.
//!
//! A built-in planner is a folder of `planners` with its code, its settings and a [`BuiltInPlanner`], and a line in
//! [`TruckPlannerKind`] below. If it has a table of settings of its own, that is a line in [`TruckPlannerSettings`], and
//! a field of `scenario::Unimog`. Scenarios ask the maker for everything else that they say about a planner.
//!
//! Other planners come from whoever runs the program: [`Planners`] knows them by name, and puts the
//! [gate](super::gate) round each that it makes.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::collision::CollisionChecker;
use wildfire_base::geometry::FieldFrame;
use wildfire_base::ranges::SettingsTable;
use wildfire_base::rng::{self, Xoshiro256PlusPlus};
use wildfire_base::trajectory::{GroundSpeed, SpeedLimits};
use wildfire_base::vehicle::Dimensions;

use super::TruckPlanner;
use super::gate::ValidatedPlanner;
use super::kit::drive_cost::DriveCost;
use super::kit::local_search::PrimitiveSettings;
use super::kit::safety::SafetySettings;
use super::last_resort::LastResort;
use super::memory::MemoryMeter;
use super::planners::{hybrid_astar, lattice, prm_primitives, prm_rs};
use super::smooth_steering::{CurvatureSmoother, SmoothSteering};

/// Makes the built-in planners of one name, and describes their settings.
pub trait BuiltInPlanner: Sync {
    /// Makes a planner for one truck on one field.
    fn make(&self, context: &PlannerContext<'_>) -> Box<dyn TruckPlanner>;

    /// Names the tables of settings that the planner uses.
    fn tables(&self) -> &'static [&'static str];

    /// Returns whether the planner compares drives by their time where the truck asks for that.
    fn knows_time(&self) -> bool {
        false
    }

    /// Returns the simulated time that its expansions cost.
    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge;

    /// Returns the size of the roadmap that it builds at once on a field with this number of bushes, if it does.
    fn roadmap_size(
        &self,
        _settings: &TruckPlannerSettings<'_>,
        _frame: &FieldFrame,
        _bushes: usize,
    ) -> Option<RoadmapSize> {
        None
    }

    /// Warns of settings that are allowed and yet probably not meant for this body; `truck` names the truck.
    fn warning(&self, _settings: &TruckPlannerSettings<'_>, _body: &Dimensions, _truck: &str) -> Option<String> {
        None
    }
}

/// The truck and the field that a planner is made for.
pub struct PlannerContext<'a> {
    /// The truck's number, from 0.
    pub truck: u16,
    /// The truck's body, which `checker` has too.
    pub body: &'a Dimensions,
    /// The truck's speed limits.
    pub limits: &'a SpeedLimits,
    /// The cost by which drives are compared, where there is a choice.
    pub cost: DriveCost,
    /// The field, and the truck's body on it.
    pub checker: &'a CollisionChecker,
    /// Ground on which the truck is slow; `None` where it is nowhere.
    pub ground: Option<&'a GroundSpeed>,
    /// The `settings` of the scenario's table `[planner.NAME]`, for a planner that is not built in; else null.
    pub custom_settings: &'a serde_json::Value,
    /// Returns the truck's own random stream of a name, which is the same in every run of the seed.
    pub stream: &'a dyn Fn(&str) -> Xoshiro256PlusPlus,
    /// The meter to which built-in planners report their growing memory.
    pub memory: &'a MemoryMeter,
    /// The scenario's tables of settings of the built-in planners.
    pub settings: &'a TruckPlannerSettings<'a>,
}

/// Makes planners of one name. A closure from a [`PlannerContext`] to a planner will do.
pub trait PlannerFactory: Send + Sync {
    /// Makes a planner for one truck on one field.
    ///
    /// # Errors
    /// If it cannot be built; the run does not take place then.
    fn make(&self, context: &PlannerContext<'_>) -> Result<Box<dyn TruckPlanner>, MakeError>;
}

impl<F> PlannerFactory for F
where
    F: Fn(&PlannerContext<'_>) -> Result<Box<dyn TruckPlanner>, MakeError> + Send + Sync,
{
    fn make(&self, context: &PlannerContext<'_>) -> Result<Box<dyn TruckPlanner>, MakeError> {
        self(context)
    }
}

/// Why a planner could not be built, in words that read well after "its planner could not be built: ".
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct MakeError(String);

impl MakeError {
    /// Creates an error with these words.
    pub fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }
}

/// The name of a planner: 1 to 40 of `a-z 0-9 + - _ .`, a letter first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
pub struct PlannerName(String);

impl PlannerName {
    /// The maximum number of characters of a name.
    pub const MAX: usize = 40;

    /// Checks a name.
    ///
    /// # Errors
    /// If it is not of the form above.
    pub fn new(name: &str) -> Result<Self, NameError> {
        let fits = name.len() <= Self::MAX && name.starts_with(|c: char| c.is_ascii_lowercase());
        if fits && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || "+-_.".contains(c)) {
            Ok(Self(name.to_owned()))
        } else {
            Err(NameError::Malformed)
        }
    }

    /// Returns the name.
    pub fn name(&self) -> &str {
        &self.0
    }

    /// Returns the built-in planner of this name, if there is one.
    pub fn built_in(&self) -> Option<TruckPlannerKind> {
        self.0.parse().ok()
    }
}

impl TryFrom<String> for PlannerName {
    type Error = NameError;

    fn try_from(name: String) -> Result<Self, NameError> {
        Self::new(&name)
    }
}

impl FromStr for PlannerName {
    type Err = NameError;

    fn from_str(name: &str) -> Result<Self, NameError> {
        Self::new(name)
    }
}

impl From<PlannerName> for String {
    fn from(name: PlannerName) -> Self {
        name.0
    }
}

impl From<TruckPlannerKind> for PlannerName {
    fn from(kind: TruckPlannerKind) -> Self {
        Self(kind.name().to_owned())
    }
}

impl fmt::Display for PlannerName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

/// Why a planner cannot have a name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NameError {
    /// The name has another form.
    #[error("a name is 1 to 40 of `a-z 0-9 + - _ .`, a letter first")]
    Malformed,
    /// A built-in planner has this name.
    #[error("`{0}` is the name of a built-in planner")]
    BuiltIn(TruckPlannerKind),
    /// Another planner has this name.
    #[error("two planners cannot both be called `{0}`")]
    Taken(String),
}

/// Planners by name: the built-in ones, and those that were registered.
#[derive(Clone, Default)]
pub struct Planners {
    custom: BTreeMap<PlannerName, Arc<dyn PlannerFactory>>,
}

impl Planners {
    /// Adds a planner.
    ///
    /// # Errors
    /// If it cannot have this name.
    pub fn with(mut self, name: &str, maker: impl PlannerFactory + 'static) -> Result<Self, NameError> {
        let name = PlannerName::new(name)?;
        match name.built_in() {
            Some(kind) => Err(NameError::BuiltIn(kind)),
            None if self.custom.contains_key(&name) => Err(NameError::Taken(name.into())),
            None => {
                self.custom.insert(name, Arc::new(maker));
                Ok(self)
            }
        }
    }

    /// Returns whether there is a planner of this name.
    pub fn knows(&self, name: &PlannerName) -> bool {
        name.built_in().is_some() || self.custom.contains_key(name)
    }

    /// Lists the names of the planners that are not built in.
    pub fn custom_names(&self) -> impl Iterator<Item = &PlannerName> {
        self.custom.keys()
    }

    /// Makes a planner: a built-in one, whose paths are smoothed if the truck's wheels turn at a limited rate, or a
    /// custom one behind the gate, whose paths are driven unchanged.
    ///
    /// # Errors
    /// If nobody of this name is known, or it cannot be built.
    pub fn make(&self, name: &PlannerName, context: &PlannerContext<'_>) -> Result<Box<dyn TruckPlanner>, MakeError> {
        if let Some(kind) = name.built_in() {
            let planner = kind.make(context);
            return Ok(match CurvatureSmoother::new(context.checker, context.limits) {
                Some(smoother) => Box::new(SmoothSteering::new(planner, smoother)),
                None => planner,
            });
        }
        let Some(maker) = self.custom.get(name) else {
            let message = format!("`{name}` is neither built in nor registered, nor a program that may be started");
            return Err(MakeError(message));
        };
        Ok(Box::new(ValidatedPlanner::build(maker.as_ref(), context)?))
    }
}

impl fmt::Debug for Planners {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(TruckPlannerKind::ALL).entries(self.custom.keys()).finish()
    }
}

/// Simulated planning time of one expansion, in seconds, during which the truck stands still.
#[derive(Clone, Copy, Debug)]
pub struct Charge {
    pub roadmap_s: f64,
    pub local_s: f64,
}

/// The size of a roadmap before it is built.
pub struct RoadmapSize {
    pub milestones: u64,
    /// The maximum number of edges per milestone.
    pub neighbours: u32,
    pub max_edge_m: f64,
}

macro_rules! truck_planners {
    ($($(#[$doc:meta])* $kind:ident, $name:literal, $maker:expr;)+) => {
        /// The truck's path planner.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
        pub enum TruckPlannerKind {
            $($(#[$doc])* #[serde(rename = $name)] $kind,)+
        }

        impl TruckPlannerKind {
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$kind),+];

            /// Returns the name that scenarios and tables write.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)+
                }
            }

            /// Returns the maker of these planners.
            pub fn maker(self) -> &'static dyn BuiltInPlanner {
                match self {
                    $(Self::$kind => &$maker,)+
                }
            }
        }
    };
}

truck_planners! {
    /// A roadmap, and motion primitives along its waypoints.
    PrmPrimitives, "prm+primitives", prm_primitives::PrmPrimitivesFactory;
    /// A roadmap over poses with Reeds-Shepp curves, with a lattice search as fallback.
    PrmRs, "prm-rs", prm_rs::PrmRsFactory;
    /// A lattice search that looks ahead with Reeds-Shepp curves.
    HybridAstar, "hybrid-astar", hybrid_astar::HybridAstarFactory;
    /// A flood over a lattice of poses: slow, but complete at its resolution.
    Lattice, "lattice", lattice::LatticeFactory;
}

impl TruckPlannerKind {
    /// Makes a planner for one truck on one field, with what all built-in planners try last.
    pub fn make(self, context: &PlannerContext<'_>) -> Box<dyn TruckPlanner> {
        Box::new(LastResort::new(self.maker().make(context), context))
    }

    /// Builds the planner with its default settings, for a truck that drives 8 m/s in both directions. Equal seeds give
    /// equal planners.
    pub fn build(self, checker: &CollisionChecker, seed: u64) -> Box<dyn TruckPlanner> {
        self.make(&PlannerContext {
            truck: 0,
            body: checker.body(),
            limits: &SpeedLimits::new(8.0, 8.0),
            cost: DriveCost::Length,
            ground: None,
            checker,
            custom_settings: &serde_json::Value::Null,
            stream: &|name| rng::stream(seed, name),
            memory: &MemoryMeter::unlimited(),
            settings: &OwnedSettings::default().all(),
        })
    }

    /// Lists the names of all planners, separated by commas.
    pub fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}

impl fmt::Display for TruckPlannerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for TruckPlannerKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| format!("expected one of {}", Self::names()))
    }
}

/// A table of settings of planners.
pub struct PlannerTable<'a> {
    /// The name of the table in a scenario.
    pub name: &'static str,
    pub settings: &'a dyn SettingsTable,
    pub is_default: bool,
}

macro_rules! tables_of_settings {
    ($($name:ident: $Settings:ty,)+) => {
        /// The settings of every planner; each uses its own.
        #[derive(Clone, Copy, Debug)]
        pub struct TruckPlannerSettings<'a> {
            $(pub $name: &'a $Settings,)+
        }

        /// The settings of every planner, by default the default ones, to be lent.
        #[derive(Default)]
        pub struct OwnedSettings {
            $(pub $name: $Settings,)+
        }

        impl OwnedSettings {
            pub fn all(&self) -> TruckPlannerSettings<'_> {
                TruckPlannerSettings { $($name: &self.$name,)+ }
            }
        }

        impl<'a> TruckPlannerSettings<'a> {
            /// Lists the tables, to check them all alike.
            pub fn tables(&self) -> impl Iterator<Item = PlannerTable<'a>> {
                let tables = [$(PlannerTable {
                    name: stringify!($name),
                    settings: self.$name,
                    is_default: *self.$name == <$Settings>::default(),
                }),+];
                tables.into_iter()
            }
        }
    };
}

tables_of_settings! {
    prm: prm_primitives::PrmSettings,
    primitives: PrimitiveSettings,
    prm_rs: prm_rs::PrmRsSettings,
    hybrid: hybrid_astar::HybridSettings,
    lattice: lattice::LatticeSettings,
    safety: SafetySettings,
}

/// Settings of which a scenario sets only one: their paths in the table of a truck, and the meaning of each.
pub const ALTERNATIVES: [(&str, &str, &str); 2] = [
    ("prm.samples_per_hectare", "prm.samples", "each says how many samples there are"),
    ("prm_rs.samples_per_hectare", "prm_rs.samples", "each says how many samples there are"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planner_has_one_name_in_scenarios_tables_and_options() {
        for kind in TruckPlannerKind::ALL {
            assert_eq!(serde_json::to_value(kind).expect("a name is JSON"), kind.name());
            assert_eq!(kind.name().parse(), Ok(kind));
        }
    }

    #[test]
    fn names_are_short_plain_and_nobody_elses() {
        for name in ["a", "rrt", "rrt-connect_2.1+x", &"a".repeat(40)] {
            assert_eq!(PlannerName::new(name).expect("it has the form").name(), name);
        }
        for name in ["", "1a", "-a", "A", "rrt star", "rrt*", "é", &"a".repeat(41)] {
            assert_eq!(PlannerName::new(name), Err(NameError::Malformed), "{name:?}");
        }
        let maker = |_: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> { Err(MakeError::new("no")) };
        let planners = Planners::default().with("mine", maker).expect("it is free");
        assert_eq!(planners.clone().with("mine", maker).err(), Some(NameError::Taken("mine".into())));
        let taken = Planners::default().with("prm-rs", maker).err();
        assert_eq!(taken, Some(NameError::BuiltIn(TruckPlannerKind::PrmRs)));
        let is_registered = |name: &str| planners.knows(&PlannerName::new(name).expect("it has the form"));
        assert!(is_registered("mine") && is_registered("lattice") && !is_registered("other"));
    }

    #[test]
    fn every_table_of_settings_is_used_by_a_planner_and_planners_use_no_other() {
        let settings = OwnedSettings::default();
        let names: Vec<&str> = settings.all().tables().map(|table| table.name).collect();
        let used: Vec<&str> = TruckPlannerKind::ALL.iter().flat_map(|kind| kind.maker().tables()).copied().collect();
        assert!(used.iter().all(|name| names.contains(name)), "{used:?} are used of {names:?}");
        assert!(names.iter().all(|name| used.contains(name)), "{used:?} are used of {names:?}");
    }

    #[test]
    fn defaults_are_within_their_ranges() {
        let settings = OwnedSettings::default();
        for table in settings.all().tables() {
            let frame = FieldFrame { cols: 50, rows: 50, cell_m: 5.0 };
            assert_eq!((table.settings.check(&frame), table.is_default), (Ok(()), true), "{}", table.name);
        }
    }
}
