//! How few bushes a run could have lost: the best that was found by dispatchers who know what the arsonists will do.
//!
//! The search goes through the decisions of the trucks by time, plays each with other choices to the end of the run, as its
//! policies go on, and keeps what loses less (rollout with a known future: Bertsekas, Tsitsiklis, Wu, "Rollout algorithms for
//! combinatorial optimization", Journal of Heuristics 3, 1997). It begins again with the improved run until nothing improves
//! or its budget of runs is spent. Whatever it finds is a run that takes place, by the rules that all runs keep: an attainable
//! loss, from above. How far the best possible loss is below that, it does not say.

use std::collections::BTreeMap;
use std::ops::Bound;

use rayon::prelude::*;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_scenario::Scenario;
use wildfire_sim::policies::{Action, Decision};
use wildfire_sim::{RunError, RunOptions, Simulation};
use wildfire_timeline::{AgentId, Timeline};

use super::futures::nearest_options;

/// A run with other answers, which loses less.
#[derive(Clone, Debug)]
pub struct HindsightBound {
    /// The bushes that the run lost by its own policies.
    pub lost: usize,
    /// The bushes that it loses with these answers.
    pub attainable: usize,
    /// Where trucks go instead of where their policies send them.
    pub answers: Answers,
    /// The runs that were played.
    pub runs: u32,
    /// True if all sequences of choices were played: none loses less. In these a truck that has fires to choose from goes to one
    /// of them.
    pub is_exact: bool,
    pub timeline: Timeline,
}

/// The cells of trucks that decide at a time; one for each instant.
pub type Answers = BTreeMap<SimTime, (AgentId, Cell)>;

/// Runs that a search may play.
#[derive(Clone, Copy, Debug)]
pub struct HindsightBudget {
    /// Choices that are tried at each decision, the nearest first.
    pub choices: usize,
    pub runs: u32,
}

/// Searches for answers with which a run loses less.
///
/// All sequences of choices of a single truck are played if the budget is enough for them.
///
/// # Errors
/// If the run cannot take place or cannot be forked.
pub fn attain(
    scenario: &Scenario,
    seed: u64,
    options: &RunOptions,
    budget: HindsightBudget,
) -> Result<HindsightBound, RunError> {
    let start = Simulation::with(scenario, seed, options)?;
    if scenario.unimog.len() == 1
        && let Some(best) = exhaust(&start, budget)?
    {
        return Ok(best);
    }
    improve(&start, budget)
}

/// Plays all sequences of choices of a single truck; `None` if the budget is too small for them.
fn exhaust(start: &Simulation, budget: HindsightBudget) -> Result<Option<HindsightBound>, RunError> {
    let mut tree = DecisionTree { choices: budget.choices, left: budget.runs, best: None, is_whole: true };
    // A tree that is played in part is no bound; the budget is then better spent on the search.
    if !tree.descend(start, &mut Answers::new())? {
        return Ok(None);
    }
    let first_lost = played(start, false)?.lost();
    let (best, answers) = tree.best.expect("the run itself was played");
    let attainable = best.lost();
    let runs = budget.runs - tree.left;
    Ok(Some(HindsightBound {
        lost: first_lost,
        attainable,
        answers,
        runs,
        is_exact: tree.is_whole,
        timeline: best.finish().timeline,
    }))
}

/// Plays a copy of a run to its end.
fn played(run: &Simulation, records: bool) -> Result<Simulation, RunError> {
    let mut copy = run.fork()?;
    if records {
        copy.record_decisions();
    }
    copy.advance_to(SimTime::MAX);
    copy.expect_within_memory()?;
    Ok(copy)
}

struct DecisionTree {
    choices: usize,
    left: u32,
    best: Option<(Simulation, Answers)>,
    /// False if a decision had more options than choices are tried.
    is_whole: bool,
}

impl DecisionTree {
    /// Plays all that may follow; false if the budget ends before.
    fn descend(&mut self, before: &Simulation, answers: &mut Answers) -> Result<bool, RunError> {
        // The budget is in runs and not in seconds, so that the result is the same on every machine.
        if self.left == 0 {
            return Ok(false);
        }
        self.left -= 1;
        let run = played(before, true)?;
        let next = run
            .decisions()
            .iter()
            .find(|decision| {
                // Decisions until now are settled by the answers that led here; a truck with one option has nothing to choose.
                decision.agent.id.role.suppresses() && decision.options.len() > 1 && decision.time > before.now()
            })
            .cloned();
        // It must be strictly less: a run that no choice improves is reported without answers, as it is itself played first.
        if self.best.as_ref().is_none_or(|(best, _)| run.lost() < best.lost()) {
            self.best = Some((run, answers.clone()));
        }
        let Some(decision) = next else { return Ok(true) };
        self.is_whole &= decision.options.len() <= self.choices;
        let mut node = before.fork()?;
        // The run stops one nanosecond before, as an answer must be forced before the policy is asked.
        node.advance_to(decision.time - SimTime::from_nanos(1));
        for cell in nearest_options(&decision, node.fires().frame(), None).into_iter().take(self.choices) {
            let mut child = node.fork()?;
            child.force(decision.agent.id, Action::Go(cell));
            child.advance_to(decision.time);
            answers.insert(decision.time, (decision.agent.id, cell));
            let is_whole = self.descend(&child, answers)?;
            // The next branch must not inherit this answer.
            answers.remove(&decision.time);
            if !is_whole {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Goes through decisions by time, and keeps every answer that loses less.
fn improve(start: &Simulation, budget: HindsightBudget) -> Result<HindsightBound, RunError> {
    // One simulation stays before the decision, the other plays on: no run is played from its beginning twice.
    let mut search = HindsightSearch {
        before: start.fork()?,
        fork: start.fork()?,
        answers: Answers::new(),
        answered: None,
        left: budget.runs,
    };
    let mut decisions = search.play(None)?;
    let lost = search.fork.lost();
    let mut attainable = lost;
    // Until a pass over all decisions improves nothing: a later answer may make an earlier one worth changing.
    loop {
        let before = attainable;
        search.restart(start)?;
        let mut next = 0;
        while let Some(decision) = decisions.get(next).cloned() {
            next += 1;
            let Decision { time, agent, .. } = &decision;
            search.go_to(*time);
            let taken = search.answers.get(time).copied();
            // At one time one agent's answer can be changed.
            if taken.is_some_and(|(other, _)| other != agent.id) {
                continue;
            }
            for cell in nearest_options(&decision, search.before.fires().frame(), None).into_iter().take(budget.choices)
            {
                // The first two would play a run that is known; without budget the rest of the pass only goes through.
                if Some((agent.id, cell)) == taken || Action::Go(cell) == decision.choice || search.left == 0 {
                    continue;
                }
                let answer = (*time, (agent.id, cell));
                let played = search.play(Some(answer))?;
                if search.fork.lost() < attainable {
                    attainable = search.fork.lost();
                    // Later answers belonged to the run before this improvement.
                    search.answers.split_off(time);
                    search.answers.insert(answer.0, answer.1);
                    // It goes on behind the decision that was changed, in the run that followed from it. The decisions before, which
                    // that run does not list again, stay for the next pass.
                    decisions.truncate(decisions.partition_point(|other| other.time <= *time));
                    decisions.extend(played.into_iter().filter(|later| later.time > *time));
                }
            }
        }
        if attainable == before || search.left == 0 {
            break;
        }
    }
    // The search stopped somewhere within a pass, so the best answers are played once more from the start.
    search.restart(start)?;
    search.go_to(SimTime::MAX);
    search.before.expect_within_memory()?;
    let HindsightSearch { before, answers, left, .. } = search;
    debug_assert_eq!(before.lost(), attainable);
    // The loss of the run that is returned, whatever the search believed.
    Ok(HindsightBound {
        lost,
        attainable: before.lost(),
        answers,
        runs: budget.runs - left,
        is_exact: false,
        timeline: before.finish().timeline,
    })
}

/// Searches likewise for each of some seeds, in their order, and calls `on_seed` after each.
///
/// # Errors
/// As [`attain`].
pub fn attain_all(
    scenario: &Scenario,
    seeds: &[u64],
    options: &RunOptions,
    budget: HindsightBudget,
    on_seed: impl Fn() + Sync,
) -> Result<Vec<HindsightBound>, RunError> {
    seeds
        .par_iter()
        .map(|&seed| {
            // Results are collected in the order of the seeds, whichever ends first.
            let attained = attain(scenario, seed, options, budget)?;
            on_seed();
            Ok(attained)
        })
        .collect()
}

struct HindsightSearch {
    /// The run with the answers so far, just before a decision.
    before: Simulation,
    /// A copy of it that is played to the end.
    fork: Simulation,
    answers: Answers,
    /// The time of the last answer that `before` was given.
    answered: Option<SimTime>,
    left: u32,
}

impl HindsightSearch {
    fn restart(&mut self, start: &Simulation) -> Result<(), RunError> {
        self.answered = None;
        Ok(self.before.become_fork_of(start)?)
    }

    /// Advances the run to just before a time.
    fn go_to(&mut self, time: SimTime) {
        // An answer has to be forced before the instant at which the policy would decide.
        let instant = SimTime::from_nanos(1);
        let answered = self.answered.map_or(Bound::Unbounded, Bound::Excluded);
        for (&at, &(agent, cell)) in self.answers.range((answered, Bound::Excluded(time))) {
            if at > SimTime::ZERO {
                self.before.advance_to(at - instant);
            }
            self.before.force(agent, Action::Go(cell));
            self.answered = Some(at);
        }
        if time > SimTime::ZERO {
            self.before.advance_to(if time == SimTime::MAX { time } else { time - instant });
        }
    }

    /// Plays the run to its end, with another answer now if there is one. Returns the decisions of trucks.
    fn play(&mut self, answer: Option<(SimTime, (AgentId, Cell))>) -> Result<Vec<Decision>, RunError> {
        self.left = self.left.saturating_sub(1);
        self.fork.become_fork_of(&self.before)?;
        self.fork.record_decisions();
        if let Some((_, (agent, cell))) = answer {
            self.fork.force(agent, Action::Go(cell));
        }
        self.fork.advance_to(SimTime::MAX);
        self.fork.expect_within_memory()?;
        let of_trucks = self.fork.decisions().iter().filter(|decision| decision.agent.id.role.suppresses());
        Ok(of_trucks.cloned().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_scenario as scenario;
    use wildfire_timeline::Outcome;

    /// One truck and some fires that begin in a row, without an arsonist.
    fn fires_in_a_row(seed: u64) -> Simulation {
        let mut changes =
            ["duration_s=150", "wumpus=[]", "fire.burn_out_s=40", "fire.spread_radius_m=1"].map(str::to_owned).to_vec();
        let scenario = scenario::load("contest", &changes).expect("it loads");
        let bushes = Simulation::new(&scenario, seed).expect("it takes place").setting().bushes.clone();
        let ignited = bushes.iter().step_by(bushes.len() / 5).take(5).enumerate();
        let ignition = |(number, cell): (usize, &Cell)| {
            format!("{{cells=[[{}, {}]], at_s={}}}", cell.col, cell.row, 1 + 4 * number)
        };
        changes.push(format!("ignition=[{}]", ignited.map(ignition).collect::<Vec<_>>().join(", ")));
        let scenario = scenario::load("contest", &changes).expect("it loads");
        Simulation::new(&scenario, seed).expect("it takes place")
    }

    #[test]
    fn the_search_finds_nearly_what_all_sequences_of_choices_attain() {
        let (mut of_search, mut of_all, mut lost) = (0, 0, 0);
        for seed in 1..=8 {
            let start = fires_in_a_row(seed);
            let all = exhaust(&start, HindsightBudget { choices: 8, runs: 100_000 })
                .expect("it is played")
                .expect("the tree is small");
            let found = improve(&start, HindsightBudget { choices: 8, runs: 300 }).expect("it is played");
            assert!(
                all.is_exact && all.attainable <= found.attainable && found.attainable <= found.lost,
                "seed {seed}"
            );
            assert_eq!((all.lost, all.attainable as u32), (found.lost, Outcome::new(&all.timeline).burned()));
            let few = HindsightBudget { choices: 2, runs: 100_000 };
            let few = exhaust(&start, few).expect("it is played").expect("the tree is smaller");
            assert!(!few.is_exact && few.runs < all.runs, "of three fires or more, two were tried");
            let one_less = HindsightBudget { choices: 8, runs: all.runs - 1 };
            assert!(exhaust(&start, one_less).expect("it is played").is_none(), "one run less is too few");
            (lost, of_search, of_all) = (lost + all.lost, of_search + found.attainable, of_all + all.attainable);
        }
        assert!(of_all < lost, "there is something to gain: {of_all} of {lost}");
        assert!(of_search - of_all <= (lost - of_all) / 4, "{lost} lost, {of_search} by the search, {of_all} at least");
    }

    #[test]
    fn what_is_attained_is_a_run_by_the_rules_that_loses_less() {
        for changes in [vec![], vec!["dispatch.policy=auction".to_owned()]] {
            let changes = [vec!["duration_s=200".to_owned()], changes].concat();
            let scenario = scenario::load("fleet", &changes).expect("the preset loads");
            let options = RunOptions::default();
            let attained =
                attain(&scenario, 3, &options, HindsightBudget { choices: 3, runs: 60 }).expect("it takes place");
            let played_run = wildfire_sim::run(&scenario, 3).expect("it takes place").timeline;
            assert_eq!(attained.lost as u32, Outcome::new(&played_run).burned());
            assert_eq!(attained.attainable as u32, Outcome::new(&attained.timeline).burned());
            assert!(attained.attainable < attained.lost && attained.runs <= 60 && !attained.answers.is_empty());
            assert!(wildfire_audit::audit_timeline(&attained.timeline, Default::default()).violation.is_none());
            let again =
                attain(&scenario, 3, &options, HindsightBudget { choices: 3, runs: 60 }).expect("it takes place");
            assert_eq!(again.timeline, attained.timeline);
            // Fewer runs find no better one.
            let fewer =
                attain(&scenario, 3, &options, HindsightBudget { choices: 3, runs: 20 }).expect("it takes place");
            assert!(fewer.attainable >= attained.attainable);
        }
    }
}
