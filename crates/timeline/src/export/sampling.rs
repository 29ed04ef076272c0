//! The sampled times and agents of a run.

use super::ExportError;
use crate::{AgentId, Setting, Timeline};
use wildfire_base::time::SimTime;

/// The shortest step between samples, in seconds.
pub const FINEST_STEP_S: f64 = 1e-3;

/// The maximum number of samples, of all agents together, that are kept in memory or in one file.
pub const MAX_SAMPLES: u64 = 5_000_000;

/// Samples at 0, at multiples of a step, and at the end of the run, of all or some agents.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampling {
    step_s: f64,
    end: SimTime,
    agents: Vec<usize>,
}

impl Sampling {
    /// Samples the agents of these names, or all agents if none are named.
    ///
    /// # Errors
    /// If the step is shorter than [`FINEST_STEP_S`], or the run has no such agent.
    pub fn new(timeline: &Timeline, step_s: f64, names: &[AgentId]) -> Result<Self, ExportError> {
        // As what is allowed, so that NaN is refused as well.
        if !(step_s.is_finite() && step_s >= FINEST_STEP_S) {
            return Err(ExportError::Step { found: step_s });
        }
        let setting = &timeline.setting;
        let mut agents = names
            .iter()
            .map(|&name| setting.agent_index(name).ok_or_else(|| no_such_agent(name, setting)))
            .collect::<Result<Vec<_>, _>>()?;
        // Rows go by agents, in whichever order and however often the names are given.
        agents.sort_unstable();
        agents.dedup();
        if names.is_empty() {
            agents = (0..setting.agents.len()).collect();
        }
        Ok(Self { step_s, end: timeline.end_time(), agents })
    }

    /// Refuses more than [`MAX_SAMPLES`].
    pub fn check_count(&self) -> Result<(), ExportError> {
        let moments = (self.end.as_seconds() / self.step_s).ceil() as u64;
        let moments = moments.saturating_add(1);
        let found = moments.saturating_mul(self.agents.len().max(1) as u64);
        if found <= MAX_SAMPLES { Ok(()) } else { Err(ExportError::TooManySamples { found }) }
    }

    /// Iterates over multiples of the step, each rounded to the nanosecond, and the end of the run.
    pub fn times(&self) -> impl Iterator<Item = SimTime> + use<> {
        let (step_s, end) = (self.step_s, self.end);
        // Multiplied and not added up, so that rounding does not grow with the number of samples.
        let multiples = (0_u64..).map(move |k| SimTime::from_seconds(k as f64 * step_s));
        multiples.take_while(move |&time| time < end).chain([end])
    }

    /// Returns the places of the sampled agents in [`Setting::agents`], ascending.
    pub fn agents(&self) -> &[usize] {
        &self.agents
    }

    pub fn step_s(&self) -> f64 {
        self.step_s
    }
}

fn no_such_agent(found: AgentId, setting: &Setting) -> ExportError {
    let existing = setting.agents.iter().map(|start| start.id.to_string()).collect::<Vec<_>>();
    let existing = if existing.is_empty() { "nobody".into() } else { existing.join(", ") };
    ExportError::NoSuchAgent { found, existing }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{self, TRUCK};

    #[test]
    fn steps_that_lead_nowhere_are_refused() {
        for step_s in [0.0, -1.0, 1e-9, f64::NAN, f64::INFINITY] {
            let refused = Sampling::new(&sample::by_hand(), step_s, &[]);
            assert!(matches!(refused, Err(ExportError::Step { .. })), "{step_s}");
        }
    }

    #[test]
    fn a_step_that_divides_the_run_samples_the_end_once() {
        let times =
            |step_s| Sampling::new(&sample::by_hand(), step_s, &[]).expect("a step").times().collect::<Vec<_>>();
        assert_eq!(times(45.0), [0.0, 45.0, 90.0].map(SimTime::from_seconds));
        assert_eq!(times(1e9), [0.0, 90.0].map(SimTime::from_seconds));
    }

    #[test]
    fn agents_are_those_that_are_named_each_once() {
        let timeline = sample::by_hand();
        let agents = |names: &[AgentId]| Sampling::new(&timeline, 1.0, names).map(|sampling| sampling.agents);
        assert_eq!(agents(&[]).expect("all"), [0, 1]);
        assert_eq!(agents(&[TRUCK, TRUCK]).expect("one"), [1]);
        let refusal = agents(&[AgentId::unimog(7)]).expect_err("there is none").to_string();
        assert_eq!(refusal, "there is no unimog/7 in this run, only wumpus/0, unimog/0");
    }

    #[test]
    fn samples_beyond_the_limit_are_refused() {
        let timeline = sample::random(1, SimTime::from_seconds(3600.0));
        let sampling = |step_s| Sampling::new(&timeline, step_s, &[]).expect("a step");
        assert!(sampling(0.1).check_count().is_ok());
        let agents = timeline.setting.agents.len() as u64;
        let moments = (timeline.end_time().as_seconds() / FINEST_STEP_S).ceil() as u64 + 1;
        assert_eq!(sampling(FINEST_STEP_S).check_count().is_ok(), moments * agents <= MAX_SAMPLES);
    }
}
