//! Policies: they decide where the agents that follow them go.
//!
//! A [`Policy`] is asked about agents that are free, or that may think better of where they go, at one instant, and sees
//! the state of that instant. It may choose for all of them together, for some, whose choices are carried out before the
//! rest is asked again, or for nobody: then the world stands still until the choices are
//! [given](crate::Simulation::answer). Planning and driving are not its business; when an agent fails to plan
//! its way to what was chosen, the policy is asked again without that option. Rules that know one agent at a time are
//! policies by [`PerAgentPolicy`]. A policy may also be asked, once in a run, where crews build line.
//!
//! Policies have names, which scenarios give their agents. [`Policies`] knows them: the built-in rules, and what
//! whoever runs the program hands in.

mod densest;
pub mod dispatch;
mod largest_cluster;
pub mod learned;
mod nearest;
mod nearest_intact;
mod policy_set;
mod random_intact;
mod registry;

use std::fmt;
use std::time::Duration;

use glam::DVec2;

use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::time::SimTime;
use wildfire_fire::FireField;
use wildfire_fire::line::Forecast;
use wildfire_planning::PlanFailure;
use wildfire_scenario::Crew;
use wildfire_timeline::{Activity, AgentId};

pub use largest_cluster::cluster_sizes;
pub use policy_set::{
    ActionOverride, CustomPolicyStats, Decision, MAX_LINE_POINTS, PendingDecision, PolicyId, PolicyQuery, PolicySet,
};
pub use registry::{BuiltIn, MakePolicy, NamedPolicy, Policies, PolicyContext, PolicyNameError, RuleContext};

/// A choice for an agent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// The agent goes for this cell, which is one of its options.
    Go(Cell),
    /// A truck goes for the option that its planner finds to be nearest by drive. A truck with a goal keeps it, and a
    /// Wumpus waits.
    GoToNearest,
    /// A truck of a [team](PolicyScope::Team) drives to this place, in metres in the frame of the field, and waits there; it
    /// may be redirected while driving. A truck with a goal drops it. Any other agent waits.
    Move(DVec2),
    /// A truck fills its tank, or drives to water. A truck with a goal drops it. Where water does not matter, and for
    /// any other agent, this is [`Self::Wait`].
    Refill,
    /// The agent stays where it is, or keeps its goal, until something wakes it.
    Wait,
    /// The agent does the same, but decides again at this time at the latest; an agent with a goal waits until
    /// something wakes it. An instant less than a tenth of a second ahead is postponed to there.
    WaitUntil(SimTime),
}

impl Action {
    /// Returns true if an agent with these options goes for one of them.
    pub fn is_one_of(self, options: &[Cell]) -> bool {
        match self {
            Self::Go(cell) => options.contains(&cell),
            Self::GoToNearest => !options.is_empty(),
            Self::Move(_) | Self::Refill | Self::Wait | Self::WaitUntil(_) => false,
        }
    }

    /// Returns when a waiting agent decides again if nothing wakes it before.
    pub fn until(self) -> Option<SimTime> {
        match self {
            Self::WaitUntil(time) => Some(time),
            Self::Go(_) | Self::GoToNearest | Self::Move(_) | Self::Refill | Self::Wait => None,
        }
    }
}

/// An agent as policies see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgentView {
    pub id: AgentId,
    /// The centre of its body, in metres.
    pub place: DVec2,
    /// The pose of a truck's rear axle, or of a Wumpus's centre with the direction that it faces.
    pub pose: Pose,
    pub activity: Activity,
    /// The cell that it goes for.
    pub goal: Option<Cell>,
    /// The place that it was sent to, if it is driving there or waits there.
    pub staging_point: Option<DVec2>,
    /// The number of stops that the water in its tank lasts for; `None` where water does not matter.
    pub stops_left: Option<u32>,
    /// The time at which it can set out for something else: now, unless it has to finish something first.
    pub free_at: SimTime,
    /// The centre of its body at that time.
    pub free_place: DVec2,
}

/// What a policy may look at: the state at one instant.
pub struct Observation<'a> {
    pub now: SimTime,
    pub fires: &'a FireField,
    /// All agents of the run, by name.
    pub agents: &'a [AgentView],
    /// The options of the agents that are asked.
    pub options_of: &'a dyn ActionMask<AgentId>,
}

/// The knowledge of a policy that is asked where crews build line.
#[derive(Clone, Copy, Debug)]
pub struct FirelineContext<'a> {
    pub crews: &'a [Crew],
    /// The velocity of the wind, metres a second.
    pub wind_mps: DVec2,
    /// When fire comes to which cell if nobody fights it.
    pub forecast: &'a Forecast,
}

/// Lists the options of agents. A closure that lists them will do.
pub trait ActionMask<Id> {
    /// Lists the options of an agent by cell index.
    fn list(&self, agent: Id) -> Vec<Cell>;

    /// Returns whether a cell is one of them, without listing the others where there may be many.
    fn contains(&self, agent: Id, cell: Cell) -> bool {
        self.list(agent).contains(&cell)
    }
}

impl<Id, List: Fn(Id) -> Vec<Cell>> ActionMask<Id> for List {
    fn list(&self, agent: Id) -> Vec<Cell> {
        self(agent)
    }
}

impl fmt::Debug for Observation<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observation").field("now", &self.now).field("agents", &self.agents).finish_non_exhaustive()
    }
}

impl Observation<'_> {
    /// Returns the cells that an asked agent may go for, by cell index: for a truck, fires that are not another truck's
    /// goal and not known to be unreachable; for a Wumpus, what it can approach and light.
    pub fn options(&self, agent: AgentId) -> Vec<Cell> {
        self.options_of.list(agent)
    }

    /// Returns true if an asked agent may go for a cell of the field. If it may go for most of a large field, this is
    /// much faster than listing its options.
    pub fn is_option(&self, agent: AgentId, cell: Cell) -> bool {
        self.options_of.contains(agent, cell)
    }
}

/// The agents that a policy is asked about, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolicyScope {
    /// Agents that have options, as soon as one of them is free.
    Each,
    /// All trucks of a team that are free or driving to a place to wait, whenever a fire begins or ends, even if
    /// nothing is left to go for. Goals of asked trucks count as options, those that other trucks keep do not.
    Team {
        /// True if trucks that are under way to a fire are asked too.
        replans: bool,
    },
}

/// Notes on a question to a policy that is not built in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct QueryReport {
    /// The reason for a missing answer, with a message. The agents then wait.
    pub failure: Option<(PlanFailure, String)>,
    /// A message about an answer that nobody could carry out.
    pub illegal: Option<String>,
    /// CPU time of other processes.
    pub elsewhere: Duration,
}

/// Chooses where agents go.
pub trait Policy: Send + Sync {
    /// Chooses for some or all of the agents that are `queried`, or for none if the answer comes later.
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)>;

    /// Says whom it is asked about.
    fn asking(&self) -> PolicyScope {
        PolicyScope::Each
    }

    /// Returns the simulated time that its last choice costs the trucks of a team which set out because of it.
    fn charge(&self) -> SimTime {
        SimTime::ZERO
    }

    /// Answers where crews build line: along these points, in metres in the frame of the field, which are crossed in order.
    /// Without points crews build nothing, which counts as a bad answer.
    fn line(&mut self, _seen: &Observation<'_>, _line: &FirelineContext<'_>) -> Vec<DVec2> {
        Vec::new()
    }

    /// Takes notes on its last choice, or, before the first, of how it was made.
    fn take_report(&mut self) -> QueryReport {
        QueryReport::default()
    }

    /// Returns a copy with all that it knows, for a [fork](crate::Simulation::fork) of its run; `None` if it cannot be
    /// copied.
    fn fork(&self) -> Option<Box<dyn Policy>> {
        None
    }

    /// Draws what it leaves to chance from now on by another seed.
    fn reseed(&mut self, _seed: u64) {}
}

/// Chooses for one agent at a time.
pub trait Rule: Send + Sync {
    /// Returns the best of its options, which come by cell index; `None` lets it wait.
    fn best(&mut self, seen: &Observation<'_>, agent: &AgentView, options: &[Cell]) -> Option<Cell>;
}

/// Sends the first of those that are asked to its best cell; without one it waits.
fn first_goes(
    seen: &Observation<'_>,
    queried: &[AgentId],
    best: impl FnOnce(&AgentView) -> Option<Cell>,
) -> Vec<(AgentId, Action)> {
    let first = queried.iter().find_map(|&id| seen.agents.iter().find(|agent| agent.id == id));
    first.map(|agent| (agent.id, best(agent).map_or(Action::Wait, Action::Go))).into_iter().collect()
}

/// A rule for one agent as a policy: each agent chooses after those before it have acted.
#[derive(Clone, Copy, Debug)]
pub struct PerAgentPolicy<R>(pub R);

impl<R: Rule + Clone + 'static> Policy for PerAgentPolicy<R> {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        first_goes(seen, queried, |agent| self.0.best(seen, agent, &seen.options(agent.id)))
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(self.clone()))
    }
}
