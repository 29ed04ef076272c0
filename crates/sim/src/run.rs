//! A finished run: its facts, what it cost, and messages about failures.

use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use wildfire_base::time::SimTime;
use wildfire_planning::{CpuSource, PlanFailure, QueryCpu};
use wildfire_timeline::{AgentId, CpuSample, Timeline};

/// CPU time of one agent's planning in a run. Parts that its kind does not have are zero.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AgentCost {
    pub agent: AgentId,
    /// The truck's roadmap: sampling and connecting.
    pub sampling: Duration,
    pub connecting: Duration,
    pub roadmap_search: Duration,
    /// The truck's local search, or the Wumpus's search.
    pub local_search: Duration,
    /// Reachability floods and the lattice searches that follow them.
    pub reachability: Duration,
    /// A truck's custom planner: making it, including the starts of its program.
    #[serde(default)]
    pub starting: Duration,
    /// Queries to the custom planner.
    #[serde(default)]
    pub queries: Duration,
    /// The part of the above that a planner's own processes used, outside this program.
    #[serde(default)]
    pub elsewhere: Duration,
    /// The source of the times of a truck's queries; of several sources the least trusted.
    #[serde(default)]
    pub source: Option<CpuSource>,
}

impl AgentCost {
    /// Creates the account of an agent that has not planned yet.
    pub fn new(agent: AgentId) -> Self {
        let zero = Duration::ZERO;
        Self {
            agent,
            sampling: zero,
            connecting: zero,
            roadmap_search: zero,
            local_search: zero,
            reachability: zero,
            starting: zero,
            queries: zero,
            elsewhere: zero,
            source: None,
        }
    }

    /// Adds the time of a query to a custom planner.
    pub fn add_query(&mut self, cpu: QueryCpu) {
        self.starting += cpu.starting;
        self.queries += cpu.time.saturating_sub(cpu.starting);
        if cpu.source != CpuSource::Thread {
            self.elsewhere += cpu.time;
        }
        self.source = self.source.max(Some(cpu.source));
    }

    pub fn total(&self) -> Duration {
        let others = self.starting + self.queries;
        self.sampling + self.connecting + self.roadmap_search + self.local_search + self.reachability + others
    }
}

/// CPU time of a run; never part of its outcome.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct RunCost {
    pub terrain: Duration,
    pub clearance_field: Duration,
    /// CPU time of decisions of policies for whole teams of trucks.
    #[serde(default)]
    pub dispatch: Duration,
    /// CPU time of custom policies, including the starts of their programs.
    #[serde(default)]
    pub policies: Duration,
    /// The part of it that other processes used.
    #[serde(default)]
    pub policies_elsewhere: Duration,
    /// The costs of agents, in the order of the timeline's agents.
    pub agents: Vec<AgentCost>,
    pub total: Duration,
}

impl RunCost {
    /// Returns the part that no thread of this program used.
    pub fn elsewhere(&self) -> Duration {
        self.agents.iter().map(|agent| agent.elsewhere).sum::<Duration>() + self.policies_elsewhere
    }
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Run {
    /// The facts of the run.
    pub timeline: Timeline,
    /// CPU time, by part.
    pub cost: RunCost,
    /// CPU time by decision, in order of time: first one entry per agent for building its planner, then one for every
    /// decision that took some.
    pub cpu_samples: Vec<CpuSample>,
    /// The CPU time of each planner query, in the order of the answers in the timeline: the planning time of that agent
    /// since its previous answer.
    pub answer_cpu: Vec<Duration>,
    /// Messages of custom planners and policies about failures, and of the gate about their paths.
    pub messages: FailureMessages,
    /// Counts of questions to custom policies; `None` where all are built in.
    pub asks: Option<PolicyTally>,
}

/// Counts of questions to custom policies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PolicyTally {
    pub asked: u64,
    pub timed_out: u64,
    pub crashed: u64,
    pub bad_answer: u64,
    /// Questions that were answered with an invalid option; the agent then waits.
    pub illegal: u64,
}

/// Messages about failures: the first ones, the total number, and counts by kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FailureMessages {
    pub first: Vec<String>,
    pub count: u64,
    kinds: Vec<MessageKind>,
}

/// Messages that differ in their numbers at most.
#[derive(Clone, Debug, PartialEq, Eq)]
struct MessageKind {
    /// The beginning of the message without digits.
    key: String,
    first: String,
    count: u64,
}

impl FailureMessages {
    /// The messages that are kept, and the kinds.
    const KEPT: usize = 20;

    /// The most characters of a message that are kept, and of the part by which kinds are told.
    const LONGEST: usize = 600;
    const LONGEST_KEY: usize = 60;

    /// Adds a message about `who`, an agent or a policy.
    pub fn add(&mut self, who: &str, time: SimTime, reason: PlanFailure, message: &str) {
        self.add_text(who, time, &format!("{reason}: {message}"));
    }

    /// Adds a message that begins with a reason and a colon.
    pub fn add_text(&mut self, who: &str, time: SimTime, text: &str) {
        let message: String =
            format!("{who} at {:.1} s: {text}", time.as_seconds()).chars().take(Self::LONGEST).collect();
        self.count += 1;
        if self.first.len() < Self::KEPT {
            self.first.push(message.clone());
        }
        let key: String = who
            .chars()
            .chain(text.chars())
            .filter(|letter| !letter.is_ascii_digit() && !"-.".contains(*letter))
            .take(Self::LONGEST_KEY)
            .collect();
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.key == key) {
            kind.count += 1;
        } else if self.kinds.len() < Self::KEPT {
            self.kinds.push(MessageKind { key, first: message, count: 1 });
        }
    }

    /// Adds the messages of others.
    pub fn append(&mut self, others: Self) {
        self.count += others.count;
        self.first.extend(others.first);
        self.first.truncate(Self::KEPT);
        self.kinds.extend(others.kinds);
        self.kinds.truncate(Self::KEPT);
    }
}

impl fmt::Display for FailureMessages {
    /// Writes the first message of each kind with the number of those that it stands for, and how many more there were.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, MessageKind { first, count, .. }) in self.kinds.iter().enumerate() {
            f.write_str(if index > 0 { "; " } else { "" })?;
            match count {
                1 => f.write_str(first)?,
                times => write!(f, "{first} ({times} times)")?,
            }
        }
        match self.count - self.kinds.iter().map(|kind| kind.count).sum::<u64>() {
            0 => Ok(()),
            more => write!(f, "; and {more} more"),
        }
    }
}
