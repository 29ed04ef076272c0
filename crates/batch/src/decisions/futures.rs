//! Plays the choices of decisions over the same futures.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_scenario::Scenario;
use wildfire_sim::policies::{Action, Decision};
use wildfire_sim::{RunError, RunOptions, Simulation};
use wildfire_timeline::{AgentFact, AgentId, Fact};

use super::why::WhyReport;
use crate::stats::{CONFIDENCE, Interval, Series, t_quantile_above, t_two_sided};

/// The parts of all futures after which a decision may be settled.
const ROUNDS: [f64; 3] = [0.2, 0.5, 1.0];

/// The fewest futures that a round begins with: fewer leave their spread unknown.
const FEWEST_FUTURES: u32 = 4;

/// A difference that surely is below this, in bushes, is settled.
const NOTHING: f64 = 0.5;

/// The distance of bushes that count as near, in metres: as far as fire spreads in the contest.
const NEAR_M: f64 = 30.0;

/// Pieces of work for each thread, so that none waits long for the others.
const PIECES_A_THREAD: usize = 4;

/// The decisions that are looked at, and how closely.
#[derive(Clone, Debug)]
pub struct SelectedDecisions {
    /// All trucks if there are none.
    pub agents: Vec<AgentId>,
    pub from: SimTime,
    pub to: SimTime,
    /// The most decisions, a sample at equal intervals of their order.
    pub sample: Option<usize>,
    /// The most choices of one decision, including what was chosen.
    pub choices: usize,
    /// The most futures in which each is played.
    pub futures: u32,
}

/// The surroundings of a cell just before a decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellFeatures {
    /// Seconds since it caught fire; 0 if it does not burn yet.
    pub burning_s: f64,
    /// Bushes within [`NEAR_M`] that can burn, and that do, itself left out.
    pub intact_near: u64,
    pub burning_near: u64,
    /// From the nearest truck other than the one that decides to the cell, in metres; `None` without another truck.
    pub other_truck_m: Option<f64>,
}

/// A choice that an agent had and did not take.
#[derive(Clone, Debug, PartialEq)]
pub struct AlternativeAction {
    pub cell: Cell,
    /// Known once it has been played.
    pub features: Option<CellFeatures>,
    /// By how many bushes the agent's side would have done better, by future.
    pub gains: Vec<f64>,
    /// Their mean and its interval, over all rounds; without an interval all are equal.
    pub mean: f64,
    pub interval: Option<Interval>,
    pub p_value: f64,
    /// The same after adjustment for all choices of the run.
    pub p_adjusted: f64,
}

/// A decision and the worth of its choices.
#[derive(Clone, Debug)]
pub struct DecisionValue {
    pub decision: Decision,
    /// Where the agent set out for; `None` if it stayed.
    pub selected: Option<Cell>,
    pub selected_features: Option<CellFeatures>,
    /// Bushes that are lost with the agent's own choice, by future.
    pub losses: Vec<f64>,
    /// By mean, the best first.
    pub others: Vec<AlternativeAction>,
}

impl DecisionValue {
    /// Returns true if more futures can hardly change the verdict, among this number of decisions.
    fn is_settled(&self, decisions: usize) -> bool {
        self.others.iter().all(|other| other.is_settled(decisions))
    }

    /// Returns the best of the other choices if it is significantly better than what was chosen.
    pub fn better(&self) -> Option<&AlternativeAction> {
        self.others.first().filter(|best| best.p_adjusted < 1.0 - CONFIDENCE && best.mean > 0.0)
    }

    /// Returns the best of the other choices if all of them are significantly worse than what was chosen.
    pub fn all_worse(&self) -> Option<&AlternativeAction> {
        self.others
            .first()
            .filter(|_| self.others.iter().all(|other| other.p_adjusted < 1.0 - CONFIDENCE && other.mean < 0.0))
    }
}

/// The progress of a judgement.
#[derive(Clone, Copy, Debug)]
pub enum JudgeProgress<'a> {
    /// A round begins in which the choices of this number of decisions are played.
    Begins { decisions: usize },
    /// Those of one more decision have been played.
    Played,
    /// A round is over, but not the last: the report after this number of futures.
    Interim { futures: u32, report: &'a WhyReport },
}

impl SelectedDecisions {
    /// The choices of a decision that are played unless others are asked for.
    pub const CHOICES: usize = 5;

    /// The futures in which each is played unless others are asked for.
    pub const FUTURES: u32 = 20;

    /// Chooses decisions of trucks over the whole run, up to a number.
    pub fn sample(decisions: usize) -> Self {
        let from = SimTime::ZERO;
        let to = SimTime::MAX;
        let sample = Some(decisions);
        Self { agents: Vec::new(), from, to, sample, choices: Self::CHOICES, futures: Self::FUTURES }
    }

    /// Plays the choices of decisions of a run, in rounds: after each, decisions that are settled are left out.
    ///
    /// # Errors
    /// If the run cannot take place or cannot be forked.
    pub fn judge(
        &self,
        scenario: &Scenario,
        seed: u64,
        options: &RunOptions,
        tell: impl Fn(JudgeProgress<'_>) + Sync,
    ) -> Result<WhyReport, RunError> {
        let mut run = Simulation::with(scenario, seed, options)?;
        run.record_decisions();
        // Whether it can be forked at all is known before anything is played.
        run.fork()?;
        run.advance_to(SimTime::MAX);
        run.expect_within_memory()?;
        let worths = self.of_run(&run);
        let scenario_name = scenario.name.clone();
        let lost = run.lost();
        let bushes = run.setting().bushes.len();
        let mut report = WhyReport { scenario: scenario_name, seed, lost, bushes, worths };
        let count = report.worths.len();
        let mut played = 0;
        // In rounds: most decisions are settled by few futures, and only the others get all.
        for part in ROUNDS {
            // The spread needs four futures, even where a fifth of those asked for is less.
            let until = ((f64::from(self.futures) * part).round() as u32).clamp(FEWEST_FUTURES, self.futures);
            let mut open: Vec<&mut DecisionValue> =
                // In the first round nothing has been played, and a decision without gains is not settled.
                report.worths.iter_mut().filter(|worth| played == 0 || !worth.is_settled(count)).collect();
            if until == played || open.is_empty() {
                continue;
            }
            tell(JudgeProgress::Begins { decisions: open.len() });
            // Some pieces a thread, as decisions early in a run take longer to play on.
            let piece = open.len().div_ceil(PIECES_A_THREAD * rayon::current_num_threads());
            open.par_chunks_mut(piece).try_for_each(|piece| {
                // Each piece has a runner of its own: its decisions are by time, so the runner goes on from one to the next.
                let mut bench = CounterfactualRunner::new(scenario, seed, options)?;
                piece.iter_mut().try_for_each(|worth| {
                    bench.play_round(worth, played..until)?;
                    tell(JudgeProgress::Played);
                    Ok::<(), RunError>(())
                })
            })?;
            played = until;
            // After each round, as p-values of all decisions are adjusted together.
            report.adjust();
            if played < self.futures {
                tell(JudgeProgress::Interim { futures: played, report: &report });
            }
        }
        Ok(report)
    }

    /// Lists the decisions of a run that are looked at, with choices that have not been played.
    fn of_run(&self, run: &Simulation) -> Vec<DecisionValue> {
        // By agent and time: a plan does not name the decision from which it follows.
        let mut set_out: BTreeMap<(AgentId, SimTime), Cell> = BTreeMap::new();
        for event in run.facts() {
            if let Fact::Agent(agent, AgentFact::Planned { goal, .. }) = event.fact {
                set_out.insert((agent, event.time), goal);
            }
        }
        let is_meant =
            |agent: AgentId| self.agents.contains(&agent) || self.agents.is_empty() && agent.role.suppresses();
        let mut decisions: Vec<DecisionValue> = Vec::new();
        for decision in run.decisions() {
            let (agent, time) = (decision.agent.id, decision.time);
            if !is_meant(agent) || time < self.from || time > self.to {
                continue;
            }
            let selected = set_out.get(&(agent, time)).copied();
            let cells = nearest_options(decision, run.fires().frame(), selected).into_iter();
            // The choice that was taken is one of those played.
            let others = cells.take(self.choices.saturating_sub(1)).map(AlternativeAction::new).collect();
            decisions.push(DecisionValue {
                decision: decision.clone(),
                selected,
                selected_features: None,
                losses: Vec::new(),
                others,
            });
        }
        let count = decisions.len();
        match self.sample {
            Some(sample) if sample < count => {
                // Samples lie at the middles of equal parts, so early and late decisions are represented alike.
                (0..sample).map(|number| decisions[(2 * number + 1) * count / (2 * sample)].clone()).collect()
            }
            _ => decisions,
        }
    }
}

/// Lists the options of a decision but one, the nearest to the agent first.
pub fn nearest_options(decision: &Decision, frame: &FieldFrame, except: Option<Cell>) -> Vec<Cell> {
    let mut cells: Vec<Cell> = decision.options.iter().copied().filter(|&cell| Some(cell) != except).collect();
    cells.sort_by(frame.by_distance(decision.agent.place));
    cells
}

/// A run before a decision, and a copy of it that is played on.
struct CounterfactualRunner {
    before: Simulation,
    fork: Simulation,
}

impl CounterfactualRunner {
    fn new(scenario: &Scenario, seed: u64, options: &RunOptions) -> Result<Self, RunError> {
        let before = Simulation::with(scenario, seed, options)?;
        let fork = before.fork()?;
        Ok(Self { before, fork })
    }

    /// Plays the choices of a decision, which is not earlier than the last, in some futures.
    fn play_round(&mut self, worth: &mut DecisionValue, futures: Range<u32>) -> Result<(), RunError> {
        let DecisionValue { decision, selected, selected_features, losses, others } = worth;
        if decision.time > SimTime::ZERO {
            self.before.advance_to(decision.time - SimTime::from_nanos(1));
        }
        *selected_features = selected.map(|cell| self.features(decision, cell));
        others.iter_mut().for_each(|other| other.features = Some(self.features(decision, other.cell)));
        // The decision of a random policy was drawn before the future begins.
        let kept = match decision.choice {
            Action::Go(cell) => Some(cell),
            _ => None,
        };
        // A loss of the trucks is a gain of the arsonist.
        let sign = if decision.agent.id.role.suppresses() { 1.0 } else { -1.0 };
        for future in futures {
            // Choices are compared in one future, so that their difference is theirs and not that of the luck in it.
            let lost = self.play(decision, kept, future)?;
            losses.push(lost);
            for other in others.iter_mut() {
                other.gains.push(sign * (lost - self.play(decision, Some(other.cell), future)?));
            }
        }
        others.iter_mut().for_each(AlternativeAction::sum_up);
        others.sort_by(|a, b| b.mean.total_cmp(&a.mean));
        Ok(())
    }

    /// Looks at a cell that the agent may go for, in the run before the decision.
    fn features(&self, decision: &Decision, cell: Cell) -> CellFeatures {
        let fires = self.before.fires();
        let frame = fires.frame();
        let place = frame.centre(cell);
        // Cells of a square around the place; the test of the distance below cuts its corners off.
        let reach = (NEAR_M / frame.cell_m) as u16;
        let mut near = [0, 0];
        for row in cell.row.saturating_sub(reach)..=(cell.row + reach).min(frame.rows - 1) {
            for col in cell.col.saturating_sub(reach)..=(cell.col + reach).min(frame.cols - 1) {
                let other = Cell { col, row };
                if other != cell && fires.is_bush(other) && (frame.centre(other) - place).length() <= NEAR_M {
                    near[0] += u64::from(fires.can_burn(other));
                    near[1] += u64::from(fires.is_burning(other));
                }
            }
        }
        let trucks = self.before.agents().into_iter();
        let others = trucks.filter(|agent| agent.id.role.suppresses() && agent.id != decision.agent.id);
        CellFeatures {
            burning_s: fires.ignited_at(cell).map_or(0.0, |ignited| (decision.time - ignited).as_seconds()),
            intact_near: near[0],
            burning_near: near[1],
            other_truck_m: others.map(|agent| (agent.place - place).length()).reduce(f64::min),
        }
    }

    /// Plays one future, in which the agent goes for a cell if one is named, and returns what is lost.
    fn play(&mut self, decision: &Decision, cell: Option<Cell>, future: u32) -> Result<f64, RunError> {
        self.fork.become_fork_of(&self.before)?;
        self.fork.reseed(future);
        if let Some(cell) = cell {
            self.fork.force(decision.agent.id, Action::Go(cell));
        }
        self.fork.advance_to(SimTime::MAX);
        self.fork.expect_within_memory()?;
        Ok(self.fork.lost() as f64)
    }
}

impl AlternativeAction {
    fn new(cell: Cell) -> Self {
        Self { cell, features: None, gains: Vec::new(), mean: 0.0, interval: None, p_value: 1.0, p_adjusted: 1.0 }
    }

    /// Computes mean, interval and p-value of the gains so far, for one of the [`ROUNDS`].
    fn sum_up(&mut self) {
        let series = Series::from_values(&self.gains);
        // Bonferroni's correction over the rounds, since a decision may be settled after any of them.
        let rounds = ROUNDS.len() as f64;
        self.mean = series.mean().unwrap_or(0.0);
        let degrees = self.gains.len() as f64 - 1.0;
        let error = series.standard_error().filter(|&error| error > 0.0);
        let reach = t_quantile_above(0.5 * (1.0 - CONFIDENCE) / rounds, degrees);
        self.interval = error.map(|error| Interval::about(self.mean, reach * error));
        self.p_value = match error {
            Some(error) => rounds * t_two_sided(self.mean / error, degrees),
            None if self.mean == 0.0 => 1.0,
            None => self.p_of_equal_gains(),
        };
        self.p_value = self.p_value.min(1.0);
    }

    /// Returns the probability that this many equal signs come about by chance, over all rounds.
    fn p_of_equal_gains(&self) -> f64 {
        self.gains.iter().fold(2.0 * ROUNDS.len() as f64, |p, _| 0.5 * p)
    }

    /// Returns whether more futures can hardly change the verdict on it; significance is asked for among so many decisions.
    fn is_settled(&self, decisions: usize) -> bool {
        let is_significant = self.p_value * (decisions as f64) < 1.0 - CONFIDENCE;
        is_significant
            || match self.interval {
                Some(Interval { low, high }) => high < 0.0 || low > -NOTHING && high < NOTHING,
                // A few equal gains do not show that others are equal too.
                None => self.mean < NOTHING && self.p_of_equal_gains() < 1.0 - CONFIDENCE,
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_equal_gains_settle_nothing() {
        let is_settled = |gains: &[f64]| {
            let mut choice =
                AlternativeAction { gains: gains.to_vec(), ..AlternativeAction::new(Cell { col: 0, row: 0 }) };
            choice.sum_up();
            (choice.is_settled(10), choice.interval.is_some())
        };
        assert_eq!([is_settled(&[0.0; 4]), is_settled(&[-3.0; 4])], [(false, false); 2]);
        // 6 / 2^7 is below 0.05; a gain has to be significant among ten decisions.
        assert_eq!(
            [is_settled(&[0.0; 6]), is_settled(&[0.0; 7]), is_settled(&[-3.0; 7])].map(|it| it.0),
            [false, true, true]
        );
        assert_eq!([is_settled(&[3.0; 7]), is_settled(&[3.0; 11])].map(|it| it.0), [false, true]);
        assert_eq!(is_settled(&[-3.0, -3.1, -3.0, -2.9]), (true, true));
    }
}
