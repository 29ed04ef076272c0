//! The planners of trucks by their names in scenarios: the only place that lists them.
//!
//! A planner is a folder of `planners` with its code, its settings and a [`MakePlanner`], and a line in
//! [`TruckPlannerKind`] below. If it has a table of settings of its own, that is a line in [`TruckPlannerSettings`], and
//! a field of `scenario::Unimog`. Scenarios ask the maker for everything else that they say about a planner.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::CollisionChecker;
use crate::geometry::FieldFrame;
use crate::ranges::SettingsTable;
use crate::rng::Xoshiro256PlusPlus;
use crate::vehicle::Dimensions;

use super::TruckPlanner;
use super::kit::local_search::PrimitiveSettings;
use super::kit::safety::SafetySettings;
use super::memory::{MemoryMeter, PlannerMemory};
use super::planners::{hybrid_astar, lattice, prm_primitives, prm_rs};

/// Makes the planners of one name, and knows what scenarios say about them.
pub trait MakePlanner: Sync {
    /// Makes a planner for one truck on one field.
    fn make(&self, site: &Site<'_>) -> Box<dyn TruckPlanner>;

    /// Names the tables of settings that the planner uses.
    fn tables(&self) -> &'static [&'static str];

    /// Bounds the memory that the planner takes on a field whose bushes have up to this number of convex corners.
    fn memory(&self, frame: &FieldFrame, corners: u64, settings: &TruckPlannerSettings<'_>) -> PlannerMemory;

    /// Returns the simulated time that its expansions cost.
    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge;

    /// Describes in sentences how the planner finds its way.
    fn describe(&self, settings: &TruckPlannerSettings<'_>) -> String;

    /// Returns the size of the roadmap that it builds on a field with this number of bushes, if it builds one.
    fn roadmap_size(&self, _settings: &TruckPlannerSettings<'_>, _bushes: usize) -> Option<RoadmapSize> {
        None
    }

    /// Warns of settings that are allowed and yet probably not meant for this body; `truck` names the truck.
    fn warning(&self, _settings: &TruckPlannerSettings<'_>, _body: &Dimensions, _truck: &str) -> Option<String> {
        None
    }
}

/// The truck and the field that a planner is made for.
pub struct Site<'a> {
    /// The field, and the truck's body on it.
    pub checker: &'a CollisionChecker,
    /// The planner reports to it what it holds as it grows.
    pub memory: &'a MemoryMeter,
    pub settings: &'a TruckPlannerSettings<'a>,
    /// Returns the truck's own random stream of a name.
    pub stream: &'a dyn Fn(&str) -> Xoshiro256PlusPlus,
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
    /// The most edges that a milestone brings with it.
    pub neighbours: u32,
    pub max_edge_m: f64,
}

macro_rules! truck_planners {
    ($($(#[$doc:meta])* $kind:ident, $name:literal, $maker:expr;)+) => {
        /// The planner by which a truck finds its way.
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

            /// Returns what makes these planners.
            pub fn maker(self) -> &'static dyn MakePlanner {
                match self {
                    $(Self::$kind => &$maker,)+
                }
            }
        }
    };
}

truck_planners! {
    /// A roadmap, and motion primitives along its waypoints.
    PrmPrimitives, "prm+primitives", prm_primitives::Maker;
    /// A roadmap over poses with Reeds-Shepp curves, and a lattice search where it does not serve.
    PrmRs, "prm-rs", prm_rs::Maker;
    /// A lattice search that looks ahead with Reeds-Shepp curves.
    HybridAstar, "hybrid-astar", hybrid_astar::Maker;
    /// A flood over a lattice of poses: slow, and complete at its resolution.
    Lattice, "lattice", lattice::Maker;
}

impl TruckPlannerKind {
    /// Lists the names of all planners as a sentence does, with commas.
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
        #[cfg(test)]
        #[derive(Default)]
        pub struct OwnedSettings {
            $(pub $name: $Settings,)+
        }

        #[cfg(test)]
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

/// Describes the simulated time that an expansion costs.
pub fn describe_charge(seconds_per_expansion: f64) -> String {
    if seconds_per_expansion == 0.0 {
        "planning takes no simulated time".into()
    } else {
        format!("it stands {seconds_per_expansion} s for every expansion")
    }
}

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
    fn every_table_of_settings_is_used_by_a_planner_and_planners_use_no_other() {
        let settings = OwnedSettings::default();
        let known: Vec<&str> = settings.all().tables().map(|table| table.name).collect();
        let used: Vec<&str> = TruckPlannerKind::ALL.iter().flat_map(|kind| kind.maker().tables()).copied().collect();
        assert!(used.iter().all(|name| known.contains(name)), "{used:?} are used of {known:?}");
        assert!(known.iter().all(|name| used.contains(name)), "{used:?} are used of {known:?}");
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
