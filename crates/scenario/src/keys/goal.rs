//! Who chooses where agents go, and where crews build: names of policies, as scenarios write them.
//!
//! A built-in rule is of one kind of agents, or of crews; any other name is that of a policy that the scenario has a table
//! `[policy.NAME]` of.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::program::Programs;
use crate::faults::check::{Check, TablePath};
use wildfire_planning::PlannerName;

macro_rules! goals {
    ($(#[$doc:meta])* $Goal:ident; $($(#[doc = $about:literal])* $Rule:ident, $name:literal;)+) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(from = "PlannerName", into = "String")]
        pub enum $Goal {
            $($(#[doc = $about])* $Rule,)+
            /// A policy that is not built in, by its name.
            Policy(PlannerName),
        }

        impl $Goal {
            /// The names of the built-in rules.
            pub const BUILT_IN: [&'static str; [$($name),+].len()] = [$($name),+];

            /// Returns the name that scenarios and tables write.
            pub fn name(&self) -> &str {
                match self {
                    $(Self::$Rule => $name,)+
                    Self::Policy(name) => name.name(),
                }
            }

            /// Says whether a built-in rule has this name.
            pub fn is_built_in(name: &str) -> bool {
                Self::BUILT_IN.contains(&name)
            }

            /// Refuses the name of a policy that has no table.
            pub(crate) fn check(&self, table: &TablePath, key: &str, policies: &Programs) -> Check {
                let Self::Policy(name) = self else { return Ok(()) };
                if policies.contains_key(name) {
                    return Ok(());
                }
                let valid_names = Self::BUILT_IN.into_iter().chain(policies.keys().map(PlannerName::name));
                table.refuse_name(key, "policy", name.name(), valid_names.map(str::to_owned).collect())
            }
        }

        impl From<PlannerName> for $Goal {
            fn from(name: PlannerName) -> Self {
                match name.name() {
                    $($name => Self::$Rule,)+
                    _ => Self::Policy(name),
                }
            }
        }

        impl From<$Goal> for String {
            fn from(goal: $Goal) -> Self {
                goal.name().to_owned()
            }
        }

        impl JsonSchema for $Goal {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($Goal).into()
            }

            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                let rules = [$(json_schema!({ "const": $name, "description": concat!($($about),*).trim() })),+];
                json_schema!({ "anyOf": [{ "oneOf": rules }, PlannerName::json_schema(generator)] })
            }
        }
    };
}

goals! {
    /// Chooses the burning cell that a truck goes for. Distances run from its body's centre to the cell's; ties go to the
    /// lower cell index.
    TruckGoal;
    /// The nearest fire in a straight line.
    NearestBurning, "nearest-burning";
    /// The nearest fire by planned drive.
    NearestByDrive, "nearest-by-drive";
    /// The fire that has burned longest.
    Oldest, "oldest";
    /// The nearest fire of the largest group of burning cells that touch, sides or corners.
    LargestCluster, "largest-cluster";
}

goals! {
    /// Chooses the intact cell that a Wumpus goes for.
    WumpusGoal;
    /// A random intact cell.
    RandomIntact, "random-intact";
    /// The nearest intact cell.
    NearestIntact, "nearest-intact";
    /// The intact cell farthest from all trucks.
    FarthestFromTruck, "farthest-from-truck";
    /// The cell with the most fuel within reach of its fire, per metre of path.
    Densest, "densest";
    /// The same, but away from other Wumpuses, their goals and trucks.
    DensestApart, "densest-apart";
    /// The same, corrected by a small trained network that knows trucks and fires.
    Learned, "learned";
}

goals! {
    /// Chooses where crews build line.
    LinePolicy;
    /// Along the front of the fire.
    Direct, "direct";
    /// At `offset_m` from the front.
    Parallel, "parallel";
    /// Round the places in `protect`.
    PointProtection, "point-protection";
}

/// Says whether a built-in policy has this name, of whatever kind.
pub fn is_built_in_policy(name: &str) -> bool {
    TruckGoal::is_built_in(name) || WumpusGoal::is_built_in(name) || LinePolicy::is_built_in(name)
}
