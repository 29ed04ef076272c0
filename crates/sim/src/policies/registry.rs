//! Policies by name: the built-in rules, and those that are registered.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use thiserror::Error;

use super::densest::Densest;
use super::dispatch::NearestByDrive;
use super::largest_cluster::LargestCluster;
use super::learned::{LearnedArsonist, Networks};
use super::nearest::{FarthestFromTruck, Nearest, Oldest};
use super::nearest_intact::NearestIntact;
use super::random_intact::RandomIntact;
use super::{PerAgentPolicy, Policy};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::rng::Xoshiro256PlusPlus;
use wildfire_base::time::SimTime;
use wildfire_planning::{MakeError, PlannerName};
use wildfire_scenario::{Learned, TruckGoal, WumpusGoal, is_built_in_policy};
use wildfire_timeline::AgentId;

/// The context for which a policy is made: the agents that follow it in one run.
pub struct PolicyContext<'a> {
    pub name: &'a PlannerName,
    /// The scenario's name.
    pub scenario: &'a str,
    pub seed: u64,
    /// The latest end of the run.
    pub duration: SimTime,
    pub frame: FieldFrame,
    /// The cells on which a bush grows, by cell index.
    pub bushes: &'a [Cell],
    /// All agents of the run, by name.
    pub agents: &'a [AgentId],
    /// The agents that follow the policy, by name.
    pub plays: &'a [AgentId],
    /// The `settings` of the scenario's table `[policy.NAME]`, or null.
    pub custom_settings: &'a serde_json::Value,
    /// Returns the policy's own random stream of a name, which is the same in every run of the seed.
    pub stream: &'a dyn Fn(&str) -> Xoshiro256PlusPlus,
}

/// Makes policies of one name. A closure from a [`PolicyContext`] to a policy will do.
pub trait MakePolicy: Send + Sync {
    /// Makes a policy for one run.
    ///
    /// # Errors
    /// If it cannot be made; the run does not take place then.
    fn make(&self, site: &PolicyContext<'_>) -> Result<Box<dyn Policy>, MakeError>;
}

impl<F> MakePolicy for F
where
    F: Fn(&PolicyContext<'_>) -> Result<Box<dyn Policy>, MakeError> + Send + Sync,
{
    fn make(&self, site: &PolicyContext<'_>) -> Result<Box<dyn Policy>, MakeError> {
        self(site)
    }
}

/// The context for which built-in policies are made.
#[derive(Clone, Copy, Debug)]
pub struct RuleContext<'a> {
    pub frame: &'a FieldFrame,
    /// The cells that Wumpuses may light, by cell index.
    pub lightable: &'a [Cell],
    /// The spread radius of a bush, in metres.
    pub spread_m: f64,
    pub seed: u64,
    /// Weights of the scenario for learned policies.
    pub learned: Option<&'a Learned>,
}

/// The built-in policies, by their names in scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuiltIn {
    NearestBurning,
    NearestByDrive,
    Oldest,
    LargestCluster,
    RandomIntact,
    NearestIntact,
    FarthestFromTruck,
    Densest,
    DensestApart,
    Learned,
}

/// The policy that a scenario names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedPolicy<'a> {
    BuiltIn(BuiltIn),
    Custom(&'a PlannerName),
}

impl<'a> From<&'a TruckGoal> for NamedPolicy<'a> {
    fn from(goal: &'a TruckGoal) -> Self {
        match goal {
            TruckGoal::NearestBurning => Self::BuiltIn(BuiltIn::NearestBurning),
            TruckGoal::NearestByDrive => Self::BuiltIn(BuiltIn::NearestByDrive),
            TruckGoal::Oldest => Self::BuiltIn(BuiltIn::Oldest),
            TruckGoal::LargestCluster => Self::BuiltIn(BuiltIn::LargestCluster),
            TruckGoal::Policy(name) => Self::Custom(name),
        }
    }
}

impl<'a> From<&'a WumpusGoal> for NamedPolicy<'a> {
    fn from(goal: &'a WumpusGoal) -> Self {
        match goal {
            WumpusGoal::RandomIntact => Self::BuiltIn(BuiltIn::RandomIntact),
            WumpusGoal::NearestIntact => Self::BuiltIn(BuiltIn::NearestIntact),
            WumpusGoal::FarthestFromTruck => Self::BuiltIn(BuiltIn::FarthestFromTruck),
            WumpusGoal::Densest => Self::BuiltIn(BuiltIn::Densest),
            WumpusGoal::DensestApart => Self::BuiltIn(BuiltIn::DensestApart),
            WumpusGoal::Learned => Self::BuiltIn(BuiltIn::Learned),
            WumpusGoal::Policy(name) => Self::Custom(name),
        }
    }
}

impl BuiltIn {
    /// Makes the policy for a run.
    pub fn make(self, site: &RuleContext<'_>) -> Box<dyn Policy> {
        let &RuleContext { frame, lightable, spread_m, seed, learned } = site;
        match self {
            Self::NearestBurning => Box::new(PerAgentPolicy(Nearest)),
            Self::NearestByDrive => Box::new(NearestByDrive),
            Self::NearestIntact => Box::new(NearestIntact),
            Self::Oldest => Box::new(PerAgentPolicy(Oldest)),
            Self::LargestCluster => Box::new(PerAgentPolicy(LargestCluster)),
            Self::RandomIntact => Box::new(RandomIntact::new(lightable.to_vec(), seed)),
            Self::FarthestFromTruck => Box::new(PerAgentPolicy(FarthestFromTruck)),
            Self::Densest => Box::new(Densest::new(frame, spread_m, false)),
            Self::DensestApart => Box::new(Densest::new(frame, spread_m, true)),
            Self::Learned => Box::new(LearnedArsonist::new(frame, spread_m, Networks::new(learned).lights)),
        }
    }
}

/// The reason why a policy cannot have a name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PolicyNameError {
    /// The name has another form.
    #[error("a name is 1 to 40 of `a-z 0-9 + - _ .`, a letter first")]
    Malformed,
    /// A built-in policy of trucks, of Wumpuses or of crews has this name.
    #[error("`{0}` is the name of a built-in policy")]
    BuiltIn(String),
    /// Another policy has this name.
    #[error("two policies cannot both be called `{0}`")]
    Taken(String),
}

/// Policies by name, besides the built-in ones, which are always known.
#[derive(Clone, Default)]
pub struct Policies {
    custom: BTreeMap<PlannerName, Arc<dyn MakePolicy>>,
}

impl Policies {
    /// Adds a policy.
    ///
    /// # Errors
    /// If it cannot have this name.
    pub fn with(mut self, name: &str, maker: impl MakePolicy + 'static) -> Result<Self, PolicyNameError> {
        let name = PlannerName::new(name).map_err(|_| PolicyNameError::Malformed)?;
        if is_built_in_policy(name.name()) {
            return Err(PolicyNameError::BuiltIn(name.into()));
        }
        if self.custom.contains_key(&name) {
            return Err(PolicyNameError::Taken(name.into()));
        }
        self.custom.insert(name, Arc::new(maker));
        Ok(self)
    }

    /// Lists the names of the policies that are not built in.
    pub fn custom_names(&self) -> impl Iterator<Item = &PlannerName> {
        self.custom.keys()
    }

    /// Makes a policy that is not built in.
    ///
    /// # Errors
    /// If nobody of this name is known, or it cannot be made.
    pub fn make(&self, site: &PolicyContext<'_>) -> Result<Box<dyn Policy>, MakeError> {
        let name = site.name;
        self.custom
            .get(name)
            .ok_or_else(|| {
                MakeError::new(format!(
                    "`{name}` is neither built in nor registered, nor a program that may be started"
                ))
            })?
            .make(site)
    }
}

impl fmt::Debug for Policies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(TruckGoal::BUILT_IN).entries(WumpusGoal::BUILT_IN).entries(self.custom.keys()).finish()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::policies::{Action, Observation};
    use crate::{RunError, RunOptions};
    use wildfire_scenario::{self as scenario, Scenario, ScenarioError};

    fn load(name: &str, changes: &[&str]) -> Result<Scenario, Box<ScenarioError>> {
        scenario::load(name, &changes.iter().map(|&change| change.to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn all_agents_of_a_name_follow_one_policy_and_play_as_it_does() {
        let sites = Arc::new(Mutex::new(Vec::new()));
        let seen = Arc::clone(&sites);
        let maker = move |site: &PolicyContext<'_>| -> Result<Box<dyn Policy>, MakeError> {
            seen.lock().expect("nobody panicked").push((
                site.plays.to_vec(),
                site.custom_settings.to_string(),
                site.agents.len(),
            ));
            Ok(Box::new(PerAgentPolicy(Nearest)))
        };
        let policies = Policies::default().with("mine", maker).expect("it is free");
        let options = RunOptions { policies, ..RunOptions::default() };
        let short = "duration_s=300";
        let rule = load("fleet", &[short, "wumpus.0.goal=nearest-intact"]).expect("it loads");
        let fleet =
            ["policy.mine.settings={ depth = 3 }", "wumpus.0.goal=mine", "unimog.0.goal=mine", "unimog.2.goal=mine"];
        let fleet = load("fleet", &[&fleet[..], &[short]].concat()).expect("it loads");
        let played = crate::run_with_options(&fleet, 4, &options).expect("it takes place").timeline;
        assert_eq!(played, crate::run(&rule, 4).expect("it takes place").timeline);
        let plays = vec![AgentId::wumpus(0), AgentId::unimog(0), AgentId::unimog(2)];
        assert_eq!(*sites.lock().expect("nobody panicked"), [(plays, "{\"depth\":3}".to_owned(), 5)]);
        let missing = crate::run(&fleet, 4).map(drop);
        assert!(matches!(&missing, Err(RunError::NoPolicy { name, .. }) if name.name() == "mine"), "{missing:?}");
    }

    #[test]
    fn a_policy_that_nobody_answers_for_waits() {
        struct Silent;
        impl Policy for Silent {
            fn choose(&mut self, _: &Observation<'_>, _: &[AgentId]) -> Vec<(AgentId, Action)> {
                Vec::new()
            }
        }
        let maker = |_: &PolicyContext<'_>| -> Result<Box<dyn Policy>, MakeError> { Ok(Box::new(Silent)) };
        let options = RunOptions {
            policies: Policies::default().with("silent", maker).expect("it is free"),
            ..RunOptions::default()
        };
        let scenario = load("smoke", &["policy.silent.command=[]", "unimog.goal=silent"]).expect("it loads");
        let timeline = crate::run_with_options(&scenario, 1, &options).expect("it takes place").timeline;
        assert_eq!(timeline.end_time(), SimTime::from_seconds(scenario.duration_s));
        let outcome = wildfire_timeline::Outcome::new(&timeline);
        assert_eq!((outcome.extinguished, outcome.truck_stuck_s), (0, 0.0));
    }

    #[test]
    fn names_that_nobody_has_and_rules_of_the_other_kind_are_refused_with_their_place() {
        let refusal = |changes: &[&str]| load("smoke", changes).expect_err("nobody knows it").to_string();
        let message = refusal(&["unimog.goal=oldes"]);
        assert!(message.contains("unimog.goal") && message.contains("no policy of this name is known"), "{message}");
        assert!(refusal(&["unimog.goal=random-intact"]).contains("random-intact"));
        assert!(refusal(&["wumpus.goal=oldest"]).contains("wumpus.goal"));
        assert!(refusal(&["policy.oldest.command=['x']"]).contains("policy"));
    }

    #[test]
    fn names_are_short_plain_and_nobody_elses() {
        let maker = |_: &PolicyContext<'_>| -> Result<Box<dyn Policy>, MakeError> { Err(MakeError::new("no")) };
        let mine = Policies::default().with("mine", maker).expect("it is free");
        assert_eq!(mine.custom_names().map(PlannerName::name).collect::<Vec<_>>(), ["mine"]);
        let refusal = |name: &str| mine.clone().with(name, maker).err().map(|error| error.to_string());
        assert_eq!(refusal("other"), None);
        assert_eq!(refusal("mine").as_deref(), Some("two policies cannot both be called `mine`"));
        for name in ["oldest", "random-intact"] {
            assert_eq!(refusal(name), Some(format!("`{name}` is the name of a built-in policy")));
        }
        assert_eq!(refusal("Über"), Some(PolicyNameError::Malformed.to_string()));
    }
}
