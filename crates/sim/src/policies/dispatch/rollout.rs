//! One step of lookahead: candidates are tried in forecasts, and the one with the least loss is carried out.
//!
//! Rollout improves on a base policy by simulating it from each state to which a decision leads (Bertsekas, Tsitsiklis and
//! Wu, "Rollout algorithms for combinatorial optimization", Journal of Heuristics 3, 1997). The base policy is the nearest
//! fire that can be saved. Candidates are what trucks do already and what the other rules say; then, while the budget lasts,
//! each truck in turn tries another of its nearest fires, or to wait, with the others' goals as they are.

use super::auction::Auction;
use super::forecast::{Loss, TeamForecast};
use super::hungarian::Hungarian;
use super::nearest_savable::{NearestSavable, nearest_first};
use super::open_fires::OpenFires;
use super::team::{Assignment, Team};
use super::threat_first::ThreatFirst;
use wildfire_base::geometry::Cell;
use wildfire_timeline::AgentId;

/// Other fires that a truck tries.
const TRIED: usize = 4;

/// What trucks do already stays unless another plan saves a bush, or has fires burn less long by so much in all: forecasts are
/// not that good, and every turn costs time that they know nothing of.
const KEPT_S: f64 = 20.0;

/// Tries assignments in forecasts.
#[derive(Clone, Copy, Debug)]
pub struct Rollout {
    /// The maximum number of forecasts per decision; the first is always made.
    pub rollouts: u32,
}

/// The goals of trucks that are asked, by their places in the team, as numbers of open fires.
type GoalAssignment = Vec<(usize, Option<usize>)>;

impl Assignment for Rollout {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        let open = OpenFires::new(team);
        if open.fires.is_empty() || team.queried().next().is_none() {
            return Vec::new();
        }
        let mut search = RolloutSearch {
            forecast: TeamForecast::new(team),
            open: &open,
            left: self.rollouts.max(1),
            best: None,
            tried: Vec::new(),
        };
        // First, so that at equal loss trucks keep what they are going for.
        search.consider(kept(&open));
        // Every cheap rule's plan is a start; improving one is better than starting from nothing.
        for rule in [&mut Auction as &mut dyn Assignment, &mut NearestSavable, &mut Hungarian, &mut ThreatFirst] {
            // Their pairs do not count: this rule is charged by its rollouts.
            let plan = plan_of(&open, &rule.assign(team, &mut 0));
            search.consider(plan);
        }
        search.improve();
        *effort += u64::from(self.rollouts.max(1) - search.left);
        let (_, plan) = search.best.expect("one forecast at least was made");
        let goals = plan.into_iter().filter_map(|(truck, fire)| Some((truck, fire?)));
        goals.map(|(truck, fire)| (team.trucks[truck].id, open.fires[fire].cell)).collect()
    }

    fn replans(&self) -> bool {
        true
    }
}

/// The plan that trucks keep the goals that they can still save, and the others go for the nearest that is left.
fn kept(open: &OpenFires<'_>) -> GoalAssignment {
    let mut taken = vec![false; open.fires.len()];
    let mut plan = plan_of(open, &[]);
    for (truck, goal) in &mut plan {
        let truck = &open.team.trucks[*truck];
        let fire = open.fires.iter().position(|fire| Some(fire.cell) == truck.goal);
        *goal = fire.filter(|&fire| !taken[fire] && open.prospect(truck, fire).is_some());
        goal.iter().for_each(|&fire| taken[fire] = true);
    }
    let free: Vec<usize> = plan.iter().filter(|(_, goal)| goal.is_none()).map(|&(truck, _)| truck).collect();
    for (truck, fire) in nearest_first(open, &free, &mut taken, &mut 0) {
        let entry = plan.iter_mut().find(|(other, _)| *other == truck).expect("the plan has all trucks that are asked");
        entry.1 = Some(fire);
    }
    plan
}

fn plan_of(open: &OpenFires<'_>, goals: &[(AgentId, Cell)]) -> GoalAssignment {
    let queried = (0..open.team.trucks.len()).filter(|&truck| open.team.trucks[truck].is_queried);
    let goal_of = |truck: usize| {
        let (_, cell) = goals.iter().find(|(id, _)| *id == open.team.trucks[truck].id)?;
        open.fires.iter().position(|fire| fire.cell == *cell)
    };
    queried.map(|truck| (truck, goal_of(truck))).collect()
}

struct RolloutSearch<'a> {
    forecast: TeamForecast<'a>,
    open: &'a OpenFires<'a>,
    /// Forecasts that may still be made.
    left: u32,
    best: Option<(Loss, GoalAssignment)>,
    tried: Vec<GoalAssignment>,
}

impl RolloutSearch<'_> {
    /// Plays a plan, unless that was done before, and keeps it if it loses less than the best so far. The first has a head start.
    fn consider(&mut self, plan: GoalAssignment) -> bool {
        if self.left == 0 || self.tried.contains(&plan) {
            return false;
        }
        self.left -= 1;
        let goals = plan.iter().filter_map(|&(truck, fire)| Some((truck, self.open.fires[fire?].cell)));
        let mut loss = self.forecast.play(&goals.collect::<Vec<_>>());
        if self.tried.is_empty() {
            loss.burning_s -= KEPT_S;
        }
        self.tried.push(plan.clone());
        let is_better = self.best.as_ref().is_none_or(|(best, _)| loss.cmp(best).is_lt());
        if is_better {
            self.best = Some((loss, plan));
        }
        is_better
    }

    /// Returns the plan that loses least so far.
    fn best_plan(&self) -> &GoalAssignment {
        &self.best.as_ref().expect("a plan was played").1
    }

    /// Changes one truck's goal after the other's until nothing is gained by it, or the budget is spent.
    fn improve(&mut self) {
        let mut gained = true;
        while gained && self.left > 0 {
            gained = false;
            for place in 0..self.best_plan().len() {
                let (truck, old) = self.best_plan()[place];
                let near = self.open.nearest_savable(&self.open.team.trucks[truck], TRIED, |fire| Some(fire) != old);
                let others = near.into_iter().map(|prospect| Some(prospect.fire)).chain([None]);
                for fire in others {
                    let mut plan = self.best_plan().clone();
                    let previous = std::mem::replace(&mut plan[place].1, fire);
                    let holds = |other: usize| other != place && fire.is_some() && plan[other].1 == fire;
                    if let Some(other) = (0..plan.len()).find(|&other| holds(other)) {
                        // Who had it takes what this truck leaves, if that is not too late.
                        let truck = &self.open.team.trucks[plan[other].0];
                        plan[other].1 = previous.filter(|&left| self.open.prospect(truck, left).is_some());
                    }
                    gained |= self.consider(plan);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::Sample;
    use super::*;

    fn loss(team: &Team<'_>, goals: &[(AgentId, Cell)]) -> Loss {
        let goals: Vec<(usize, Cell)> = goals.iter().map(|&(id, cell)| (usize::from(id.number), cell)).collect();
        TeamForecast::new(team).play(&goals)
    }

    #[test]
    fn goals_are_savable_open_and_assigned_once() {
        for seed in 0..60 {
            let sample = Sample::new(seed);
            let mut spent = 0;
            sample.assert_sound(&Rollout { rollouts: 12 }.assign(&sample.team(), &mut spent));
            assert!(spent <= 12, "{spent} rollouts");
        }
    }

    /// Returns whether one loss is so much less than another that the lead of what trucks do already does not explain
    /// it.
    fn beats(one: Loss, other: Loss) -> bool {
        one.cmp(&Loss { burning_s: other.burning_s - KEPT_S, ..other }).is_lt()
    }

    #[test]
    fn no_rule_does_better_in_a_forecast_and_more_rollouts_never_do_worse() {
        let mut gained = 0;
        for seed in 0..40 {
            let sample = Sample::new(seed);
            let team = sample.team();
            let of_rollout = loss(&team, &Rollout { rollouts: 10 }.assign(&team, &mut 0));
            for rule in [&mut NearestSavable as &mut dyn Assignment, &mut Hungarian, &mut ThreatFirst, &mut Auction] {
                let of_rule = loss(&team, &rule.assign(&team, &mut 0));
                assert!(!beats(of_rule, of_rollout), "seed {seed}: {of_rule:?} is less than {of_rollout:?}");
                gained += usize::from(of_rollout.cmp(&of_rule).is_lt());
            }
            let of_more = loss(&team, &Rollout { rollouts: 200 }.assign(&team, &mut 0));
            assert!(!beats(of_rollout, of_more), "seed {seed}");
        }
        assert!(gained > 20, "forecasts tell decisions apart");
    }

    #[test]
    fn of_few_candidates_the_best_of_all_is_found() {
        for seed in 0..30 {
            let sample = Sample::drawn(seed, 1, TRIED);
            let team = sample.team();
            if team.queried().next().is_none() {
                continue;
            }
            let found = loss(&team, &Rollout { rollouts: 100 }.assign(&team, &mut 0));
            let open = OpenFires::new(&team);
            let all = (0..open.fires.len()).filter(|&fire| open.prospect(&team.trucks[0], fire).is_some());
            let all = all.map(|fire| loss(&team, &[(team.trucks[0].id, open.fires[fire].cell)]));
            let min = all.chain([loss(&team, &[])]).min_by(Loss::cmp).expect("to wait is one");
            assert!(!beats(min, found), "seed {seed}: {min:?} is less than {found:?}");
        }
    }
}
