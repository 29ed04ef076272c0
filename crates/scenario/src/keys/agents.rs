//! What a scenario asks of every kind of agent. A kind has a file of its own and a place in [`Scenario::kinds`].

use std::sync::Arc;

use crate::faults::check::Check;
use crate::{Scenario, Terrain};
use wildfire_base::geometry::{DVec2, FieldFrame};
use wildfire_planning::collision::ClearanceField;

/// The seed whose field is shown, and looked at for warnings.
pub const SHOWN_SEED: u64 = 1;

/// Agents that differ in their starts alone and are warned of: what holds for these holds for the others.
pub const SHOWN_ALIKE: usize = 3;

/// The agents of one kind in a scenario.
pub trait AgentList {
    /// Returns the name of the list in scenarios.
    fn key(&self) -> &'static str;

    /// Returns the heading of their description.
    fn title(&self) -> &'static str;

    fn len(&self) -> usize;

    fn starts(&self) -> Vec<SketchedStart>;

    /// Checks every value of every agent, and what they all take together.
    fn check(&self, scenario: &Scenario) -> Check;

    /// Names the values of an agent that do nothing in this scenario, as they are those of another planner.
    fn unused(&self, scenario: &Scenario, number: usize) -> Vec<&'static str>;

    /// Lists what follows from the values of an agent, in sentences.
    fn facts(&self, number: usize) -> Vec<String>;

    /// Adds warnings that need no field.
    fn warn(&self, scenario: &Scenario, found: &mut Vec<String>);

    /// Finds the agents that cannot start where they should.
    fn blocked_starts(&self, field: &ScenarioField<'_>) -> BlockedStarts;

    /// Adds warnings about agents on a field, apart from blocked starts.
    fn warn_of_field(&self, field: &ScenarioField<'_>, found: &mut Vec<String>);

    /// Bounds the memory that they take together in a run of this length.
    fn memory(&self, field: &FieldMeasures, duration_s: f64) -> AgentsMemory;
}

/// The agents of a kind that cannot start where they should, by their names.
#[derive(Default)]
pub struct BlockedStarts {
    /// Those that start in a bush, and have a free place near by.
    pub moved: Vec<String>,
    /// The first that has no free place.
    pub without_place: Option<String>,
}

/// The start of an agent, and its letter on the map of `wildfire check`.
pub struct SketchedStart {
    /// The centre of its body.
    pub centre: DVec2,
    /// The place that a scenario gives.
    pub place: DVec2,
    pub letter: char,
}

/// The field of [`SHOWN_SEED`].
pub struct ScenarioField<'a> {
    pub terrain: &'a Terrain,
    pub clearance: Arc<ClearanceField>,
}

/// The measures of a field that memory depends on.
pub struct FieldMeasures {
    pub frame: FieldFrame,
    pub bushes: u64,
}

/// Upper bounds of the memory that the agents of a kind take, in bytes.
#[derive(Default)]
pub struct AgentsMemory {
    /// The memory that they need in any case; parts of no bytes are left out later.
    pub parts: Vec<MemoryPart>,
    /// The part of `parts` that grows and is counted as it does.
    pub counted: u64,
    /// Says whether searches, floods and curves come on top.
    pub searches: bool,
}

/// One part of the memory that a run needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryPart {
    /// The name in the form that goes after "for": "the field".
    pub name: String,
    pub bytes: u64,
}

impl MemoryPart {
    pub(crate) fn new(name: impl Into<String>, bytes: u64) -> Self {
        Self { name: name.into(), bytes }
    }
}
