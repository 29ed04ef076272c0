//! The result of a run in numbers, computed from its facts alone.

use serde::{Deserialize, Serialize};

use super::{AgentId, RunIndex, Timeline};
use wildfire_base::query::FailureCounts;

/// The counts, times and scores of a run.
///
/// Where something holds "during" a stretch of time, it is what holds after all facts at the stretch's first instant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The bushes of the field; each is intact, burning, burned out or extinguished when the run ends.
    pub obstacles: u32,
    /// Bushes that never caught fire.
    pub intact: u32,
    /// Bushes on fire when the run ends.
    pub burning: u32,
    /// Bushes whose fire ended by itself.
    pub burned_out: u32,
    /// Bushes extinguished by a truck that do not burn again.
    pub extinguished: u32,
    /// Ignitions by Wumpuses; a cell that is lit again counts again.
    pub lit_by_wumpus: u32,
    /// Ignitions by spreading fire.
    pub caught_by_spread: u32,
    /// Ignitions scheduled by the scenario.
    pub lit_by_schedule: u32,
    /// Sum of [`AgentOutcome::stuck_s`] over the trucks.
    pub truck_stuck_s: f64,
    /// Sum of [`AgentOutcome::stuck_s`] over the Wumpuses.
    pub wumpus_stuck_s: f64,
    /// The end of the run.
    pub ended_s: f64,
    /// Integral of the number of burning cells over time.
    pub burning_cell_s: f64,
    /// The maximum number of cells that burned at once, after all facts of an instant.
    pub peak_burning: u32,
    /// The mean time from ignition to extinction, over the extinctions; `None` without any.
    pub mean_response_s: Option<f64>,
    /// The time at which a bush first caught fire; `None` if none ever did.
    pub first_fire_s: Option<f64>,
    /// The time at which the last fire of a bush ended; `None` if a bush burned at the end, or none ever did.
    pub all_out_s: Option<f64>,
    /// The points for ignitions, including spread and schedule, and for burn-outs.
    pub wumpus_score: f64,
    /// The points for extinctions.
    pub truck_score: f64,
    /// The agents' results, in the order of the timeline's agents.
    pub agents: Vec<AgentOutcome>,
    /// The least that could have burned or been burning at the end, had the trucks known from the start where and when
    /// everything would be lit: a bound, below what the best could do. `None` where the rules of fire are others than that of
    /// the radius, or let what was put out burn again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_burned: Option<u32>,
    /// The ground between the bushes; `None` where only bushes burn. All other fields count bushes only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground: Option<GroundOutcome>,
}

/// The result on the ground, and on bushes and ground together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroundOutcome {
    /// Cells of ground that can burn.
    pub cells: u32,
    /// Cells of ground that caught fire.
    pub burned: u32,
    /// Cells of ground that trucks extinguished and that do not burn again.
    pub extinguished: u32,
    /// Ignitions by embers, of bushes and of ground.
    pub spotted: u32,
    /// The area of all bushes and ground that caught fire, in hectares.
    pub burned_ha: f64,
    /// The maximum number of ground cells that burned at once, after all facts of an instant.
    pub peak_burning: u32,
    /// The time at which a cell at the border of the field, bush or ground, first caught fire; `None` if none did.
    pub reached_edge_s: Option<f64>,
    /// The time of the last ignition, if all fire was out before the latest end of the run and none reached the border; `None`
    /// too where agents light fires.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contained_at_s: Option<f64>,
    /// Whether fire was not contained so; `None` where nothing burned, or agents light fires.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escaped: Option<bool>,
    /// `None` without crews.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<LineOutcome>,
}

/// The line that crews built in a run, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LineOutcome {
    pub built_m: f64,
    /// The part that does not hold.
    pub lost_m: f64,
}

/// The result of one agent in numbers. Fields that do not concern its role are zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AgentOutcome {
    pub agent: AgentId,
    /// Cells lit or extinguished by this agent.
    pub cells: u32,
    /// Planner queries, including failed ones.
    pub plans: u32,
    /// Failed queries by reason.
    pub failures: FailureCounts,
    /// Plans for goals on which the planner had failed, and that the reachability flood found reachable.
    pub lattice_plans: u32,
    /// Local minima in a Wumpus's descents, whether it escaped from them or gave its goal up there.
    pub local_minima: u32,
    pub roadmap_samples: u32,
    pub roadmap_edges: u32,
    pub roadmap_components: u32,
    pub roadmap_expansions: u64,
    pub local_expansions: u64,
    /// The distance driven or walked until the end of the run, in metres.
    pub distance_m: f64,
    /// Time by what it was spent on; the six add up to `ended_s`. A leg is driving from its start time to its end
    /// time, the braking after a dropped goal included, a wait at its beginning not; planning is charged time only.
    pub driving_s: f64,
    pub planning_s: f64,
    pub suppressing_s: f64,
    pub standing_s: f64,
    /// Waiting for another truck that is in the way.
    pub waiting_s: f64,
    /// The part of the standing time in which the agent had options.
    ///
    /// For a truck: some cell, bush or ground, burned that is neither in an `OutOfReach` fact of this truck so far nor another truck's
    /// goal. For a Wumpus: some cell could be lit (intact, or extinguished where the rules relight) that is not in an
    /// `OutOfReach` fact of this Wumpus so far. Having given up, `Rested`, counts.
    pub stuck_s: f64,
    /// The longest uninterrupted standing while something burned that was not another truck's goal (for a Wumpus: could
    /// be lit), whether the agent could reach it or not.
    pub longest_idle_s: f64,
    /// Changes between forward and reverse while driving.
    pub cusps: u32,
    /// A truck's drives that did not end with extinguishing the goal: cancelled, without success, or unfinished when
    /// the run ended. A drive that never started does not count.
    pub wasted_drives: u32,
    /// The number of times that a truck moved aside for another one that could not set out otherwise.
    pub deadlocks: u32,
    /// The wasted drives of a truck to fires that, when the drive was planned, would burn out before the truck could
    /// extinguish them.
    #[serde(default)]
    pub hopeless_drives: u32,
    /// Plans of a truck that led to a drive to a fire, or to a stop in place.
    #[serde(default)]
    pub goals: u32,
    /// Those with another truck's goal within [`FLOCK_M`] at that time.
    #[serde(default)]
    pub flocked_goals: u32,
    /// The time in which a truck had no option, or its policy wanted it to wait or to be elsewhere: from coming to rest
    /// for one of these reasons, or setting out for a place to wait, until it is sent to a fire.
    #[serde(default)]
    pub idle_s: f64,
    /// Drives of a truck to places where its policy wants it to wait.
    #[serde(default)]
    pub relocations: u32,
    /// The number of times that a truck filled its tank.
    #[serde(default)]
    pub refills: u32,
    /// The time spent on that, a part of [`Self::idle_s`].
    #[serde(default)]
    pub refilling_s: f64,
    /// Cells in its `OutOfReach` facts, bushes and ground: those that it cannot light, or cannot extinguish to its
    /// knowledge.
    #[serde(default)]
    pub out_of_reach: u32,
}

/// The distance between goals, in metres between the cells' centres, below which their trucks are a flock.
pub const FLOCK_M: f64 = 60.0;

impl AgentOutcome {
    /// Returns the outcome of an agent that has not acted yet.
    pub fn idle(agent: AgentId) -> Self {
        Self {
            agent,
            cells: 0,
            plans: 0,
            failures: FailureCounts::default(),
            lattice_plans: 0,
            local_minima: 0,
            roadmap_samples: 0,
            roadmap_edges: 0,
            roadmap_components: 0,
            roadmap_expansions: 0,
            local_expansions: 0,
            distance_m: 0.0,
            driving_s: 0.0,
            planning_s: 0.0,
            suppressing_s: 0.0,
            standing_s: 0.0,
            waiting_s: 0.0,
            stuck_s: 0.0,
            longest_idle_s: 0.0,
            cusps: 0,
            wasted_drives: 0,
            deadlocks: 0,
            hopeless_drives: 0,
            goals: 0,
            flocked_goals: 0,
            idle_s: 0.0,
            relocations: 0,
            refills: 0,
            refilling_s: 0.0,
            out_of_reach: 0,
        }
    }
}

/// The side with the higher score.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Winner {
    Wumpus,
    Unimog,
    Tie,
}

impl Outcome {
    /// Computes the outcome of a run from its facts, until its end. A [`RunIndex`] contains it together with more.
    pub fn new(timeline: &Timeline) -> Self {
        RunIndex::new(timeline).into_outcome()
    }

    /// Returns the number of bushes that burn or have burned out.
    pub fn burned(&self) -> u32 {
        self.burning + self.burned_out
    }

    /// Returns the bushes burned beyond [`Outcome::least_burned`]: an upper bound on what another dispatcher could have
    /// saved, seldom near to what one can.
    pub fn burned_beyond_bound(&self) -> Option<u32> {
        self.least_burned.map(|min| self.burned().saturating_sub(min))
    }

    /// Returns the share of the bushes that never burned; like the other ratios 0 where nothing grows.
    pub fn intact_ratio(&self) -> f64 {
        self.ratio(self.intact)
    }

    /// Returns the share of all bushes that burn or have burned out.
    pub fn burned_ratio(&self) -> f64 {
        self.ratio(self.burned())
    }

    /// Returns the share of all bushes that were extinguished.
    pub fn extinguished_ratio(&self) -> f64 {
        self.ratio(self.extinguished)
    }

    /// Returns the side with the higher score; equal scores are a tie.
    pub fn winner(&self) -> Winner {
        if self.wumpus_score > self.truck_score {
            Winner::Wumpus
        } else if self.truck_score > self.wumpus_score {
            Winner::Unimog
        } else {
            Winner::Tie
        }
    }

    fn ratio(&self, cells: u32) -> f64 {
        f64::from(cells) / f64::from(self.obstacles.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample::{self, A, B, C, SECOND_TRUCK, TRUCK, WUMPUS, at, ignited, leg, planned};
    use super::*;
    use crate::{AgentFact, EndReason, Event, Fact, FireFact, RestReason};
    use wildfire_base::query::PlanFailure;

    fn run(agents: &[AgentId], events: Vec<Event>) -> Timeline {
        Timeline { setting: sample::small_setting(agents), events, ground: Vec::new() }
    }

    fn truck_rests(agent: AgentId) -> Fact {
        Fact::Agent(agent, AgentFact::Rested { reason: RestReason::NothingBurns })
    }

    #[test]
    fn a_run_written_by_hand_has_these_numbers() {
        let outcome = Outcome::new(&sample::by_hand());
        assert_eq!((outcome.obstacles, outcome.intact, outcome.burning), (4, 1, 0));
        assert_eq!((outcome.burned_out, outcome.extinguished, outcome.burned()), (2, 1, 2));
        assert_eq!((outcome.lit_by_wumpus, outcome.caught_by_spread, outcome.lit_by_schedule), (1, 1, 1));
        assert_eq!((outcome.intact_ratio(), outcome.burned_ratio(), outcome.extinguished_ratio()), (0.25, 0.5, 0.25));
        // A burned from 10 to 20 s, B from 16 to 76 s, C from 80 to 85 s.
        assert_eq!(outcome.burning_cell_s, 10.0 + 60.0 + 5.0);
        assert_eq!(outcome.peak_burning, 2);
        assert_eq!(outcome.mean_response_s, Some(10.0));
        assert_eq!((outcome.first_fire_s, outcome.all_out_s), (Some(10.0), Some(85.0)));
        assert_eq!((outcome.wumpus_score, outcome.truck_score, outcome.winner()), (5.0, 2.0, Winner::Wumpus));
        assert_eq!((outcome.truck_stuck_s, outcome.wumpus_stuck_s, outcome.ended_s), (4.0, 10.0, 90.0));
    }

    #[test]
    fn a_wumpus_written_by_hand_has_these_numbers() {
        let expected = AgentOutcome {
            cells: 1,
            plans: 3,
            failures: FailureCounts::from_iter([PlanFailure::Disconnected]),
            local_minima: 1,
            roadmap_expansions: 10,
            local_expansions: 44,
            distance_m: 20.0 + 14.0,
            driving_s: 17.0,
            planning_s: 2.0,
            standing_s: 71.0,
            // From giving up at 19 s until D, the last bush that could be lit, was ruled out at 29 s.
            stuck_s: 10.0,
            longest_idle_s: 71.0,
            out_of_reach: 2,
            ..AgentOutcome::idle(WUMPUS)
        };
        assert_eq!(Outcome::new(&sample::by_hand()).agents[0], expected);
    }

    #[test]
    fn a_truck_written_by_hand_has_these_numbers() {
        let expected = AgentOutcome {
            cells: 1,
            plans: 4,
            failures: FailureCounts::from_iter([PlanFailure::BudgetSpent]),
            lattice_plans: 1,
            roadmap_samples: 500,
            roadmap_edges: 2100,
            roadmap_components: 2,
            roadmap_expansions: 5 + 5 + 3,
            local_expansions: 7 + 7 + 20 + 900,
            distance_m: 24.0 + 32.0 + 8.0,
            driving_s: 3.0 + 4.0 + 1.0,
            planning_s: 2.0 + 1.0,
            suppressing_s: 5.0 + 2.0,
            standing_s: 10.0 + 2.0 + 55.0 + 5.0,
            // From 24 to 26 s B burned, from 80 to 82 s C did.
            stuck_s: 2.0 + 2.0,
            // From 27 s, when it gave B up, until B burned out at 76 s.
            longest_idle_s: 49.0,
            cusps: 1,
            wasted_drives: 2,
            goals: 3,
            // Until the first fire.
            idle_s: 10.0,
            out_of_reach: 1,
            ..AgentOutcome::idle(TRUCK)
        };
        assert_eq!(Outcome::new(&sample::by_hand()).agents[1], expected);
    }

    #[test]
    fn trucks_that_wait_for_each_other_have_these_numbers() {
        let outcome = Outcome::new(&sample::meeting());
        let waiter = AgentOutcome {
            cells: 1,
            plans: 1,
            roadmap_expansions: 5,
            local_expansions: 7,
            distance_m: 8.0,
            driving_s: 1.0,
            suppressing_s: 5.0,
            // From 10 s until the other gives way at 14 s, and 3 s until that one is gone.
            waiting_s: 4.0 + 3.0,
            standing_s: 10.0 + 7.0,
            goals: 1,
            ..AgentOutcome::idle(TRUCK)
        };
        assert_eq!(outcome.agents[0], waiter);
        let other = &outcome.agents[1];
        assert_eq!((other.deadlocks, other.distance_m, other.driving_s, other.waiting_s), (1, 16.0, 2.0, 0.0));
        assert_eq!(outcome.truck_stuck_s, 0.0);
    }

    #[test]
    fn a_drive_dropped_while_it_waits_is_no_drive() {
        let mut timeline = sample::meeting();
        let stand = leg(16.0, timeline.setting.agents[0].pose, 8.0, &[]);
        timeline.events.truncate(5);
        timeline.events.push(at(16.0, Fact::Agent(TRUCK, AgentFact::Dropped { goal: A, trajectory: stand })));
        let outcome = &Outcome::new(&timeline).agents[0];
        assert_eq!((outcome.wasted_drives, outcome.waiting_s, outcome.driving_s), (0, 6.0, 0.0));
    }

    #[test]
    fn a_run_without_facts_is_all_standing() {
        let outcome = Outcome::new(&run(&[WUMPUS, TRUCK], vec![]));
        assert_eq!((outcome.ended_s, outcome.intact, outcome.winner()), (100.0, 4, Winner::Tie));
        assert_eq!((outcome.first_fire_s, outcome.all_out_s, outcome.mean_response_s), (None, None, None));
        assert_eq!((outcome.agents[0].standing_s, outcome.wumpus_stuck_s), (100.0, 100.0));
        assert_eq!((outcome.agents[1].standing_s, outcome.truck_stuck_s), (100.0, 0.0));
    }

    #[test]
    fn a_field_without_bushes_and_agents_has_ratios() {
        let mut timeline = run(&[], vec![]);
        timeline.setting.bushes.clear();
        let outcome = Outcome::new(&timeline);
        assert_eq!(outcome.intact_ratio(), 0.0);
        assert_eq!((outcome.truck_stuck_s.to_string(), outcome.wumpus_stuck_s.to_string()), ("0".into(), "0".into()));
    }

    #[test]
    fn another_trucks_fire_makes_no_truck_stuck() {
        let pose = sample::small_setting(&[TRUCK]).agents[0].pose;
        let events = vec![
            at(10.0, ignited(A)),
            at(10.0, planned(TRUCK, A, leg(10.0, pose, 8.0, &[80.0]))),
            at(10.0, truck_rests(SECOND_TRUCK)),
            at(14.0, ignited(B)),
            at(20.0, Fact::Agent(TRUCK, AgentFact::Suppressing { cell: A, water_units: 1 })),
            at(25.0, Fact::Fire(FireFact::Extinguished { cell: A, by: TRUCK })),
            at(25.0, planned(TRUCK, B, leg(25.0, pose, 8.0, &[8.0]))),
            at(26.0, Fact::Agent(TRUCK, AgentFact::Suppressing { cell: B, water_units: 1 })),
            at(31.0, Fact::Fire(FireFact::Extinguished { cell: B, by: TRUCK })),
        ];
        let outcome = Outcome::new(&run(&[TRUCK, SECOND_TRUCK], events));
        // B was nobody's from 14 to 25 s.
        assert_eq!((outcome.agents[1].stuck_s, outcome.agents[1].longest_idle_s), (11.0, 11.0));
        assert_eq!((outcome.agents[0].stuck_s, outcome.agents[0].wasted_drives), (0.0, 0));
        assert_eq!((outcome.mean_response_s, outcome.truck_score), (Some((15.0 + 17.0) / 2.0), 4.0));
    }

    #[test]
    fn a_fire_ruled_out_before_it_burns_makes_no_truck_stuck() {
        let events =
            vec![at(0.0, Fact::Agent(TRUCK, AgentFact::OutOfReach { cells: vec![A, A] })), at(10.0, ignited(A))];
        let outcome = Outcome::new(&run(&[TRUCK], events));
        assert_eq!((outcome.truck_stuck_s, outcome.agents[0].longest_idle_s), (0.0, 90.0));
        assert_eq!((outcome.burning, outcome.all_out_s), (1, None));
    }

    #[test]
    fn extinguished_bushes_keep_a_wumpus_busy_only_where_they_can_ignite_again() {
        let mut events: Vec<_> = [A, B, C, sample::D].map(|cell| at(0.0, ignited(cell))).into();
        events.push(at(40.0, Fact::Fire(FireFact::Extinguished { cell: A, by: TRUCK })));
        let mut timeline = run(&[WUMPUS, TRUCK], events);
        assert_eq!(Outcome::new(&timeline).wumpus_stuck_s, 0.0);
        timeline.setting.rules.reignition = true;
        assert_eq!(Outcome::new(&timeline).wumpus_stuck_s, 60.0);
    }

    #[test]
    fn a_truck_that_is_sent_elsewhere_is_idle_until_it_is_sent_to_a_fire() {
        let pose = sample::small_setting(&[TRUCK]).agents[0].pose;
        let x_m = 42.0;
        let y_m = 30.0;
        let found_by = wildfire_base::query::FoundBy::Straight;
        let trajectory = leg(0.0, pose, 8.0, &[32.0]);
        let halt = leg(0.0, pose, 8.0, &[16.0]);
        let relocated = AgentFact::Relocated { x_m, y_m, trajectory, effort: sample::effort(1, 2), found_by };
        let events = vec![
            at(0.0, Fact::Agent(TRUCK, relocated)),
            at(1.0, ignited(A)),
            at(2.0, Fact::Agent(TRUCK, AgentFact::Halted { trajectory: halt.clone() })),
            at(2.0, planned(TRUCK, A, leg(2.0, halt.end(), 8.0, &[-16.0]))),
            at(4.0, Fact::Agent(TRUCK, AgentFact::Suppressing { cell: A, water_units: 1 })),
            at(9.0, Fact::Fire(FireFact::Extinguished { cell: A, by: TRUCK })),
            at(9.0, ignited(B)),
            at(9.0, Fact::Agent(TRUCK, AgentFact::Rested { reason: RestReason::PolicyWait })),
            at(20.0, Fact::Ended { reason: EndReason::Duration }),
        ];
        let truck = &Outcome::new(&run(&[TRUCK], events)).agents[0];
        assert_eq!((truck.idle_s, truck.stuck_s, truck.longest_idle_s), (2.0 + 11.0, 0.0, 11.0));
        assert_eq!((truck.relocations, truck.goals, truck.plans, truck.wasted_drives), (1, 1, 2, 0));
        assert_eq!((truck.driving_s, truck.distance_m), (4.0, 32.0));
    }

    #[test]
    fn drives_that_come_too_late_are_hopeless_and_goals_near_each_other_a_flock() {
        let pose = sample::small_setting(&[TRUCK]).agents[0].pose;
        let drive = |time_s: f64, metres: f64| leg(time_s, pose, 1.0, &[metres]);
        // Both burn until 60 s, and a stop takes five.
        let events = vec![
            at(0.0, ignited(A)),
            at(0.0, ignited(B)),
            at(10.0, planned(TRUCK, A, drive(10.0, 45.0))),
            at(10.0, planned(SECOND_TRUCK, B, drive(10.0, 45.1))),
            at(60.0, Fact::Fire(FireFact::BurnedOut { cell: A })),
            at(60.0, Fact::Fire(FireFact::BurnedOut { cell: B })),
        ];
        let outcome = Outcome::new(&run(&[TRUCK, SECOND_TRUCK], events));
        let of_trucks = |of: fn(&AgentOutcome) -> u32| [of(&outcome.agents[0]), of(&outcome.agents[1])];
        assert_eq!(of_trucks(|truck| truck.wasted_drives), [1, 1]);
        assert_eq!(of_trucks(|truck| truck.hopeless_drives), [0, 1]);
        assert_eq!(of_trucks(|truck| truck.flocked_goals), [0, 1]);
    }

    #[test]
    fn the_end_cuts_a_leg_short() {
        let pose = sample::small_setting(&[TRUCK]).agents[0].pose;
        let events = vec![
            at(90.0, ignited(A)),
            at(90.0, planned(TRUCK, A, leg(90.0, pose, 2.0, &[10.0, -6.0, 10.0, -6.0]))),
            at(100.0, Fact::Ended { reason: EndReason::Duration }),
        ];
        let outcome = &Outcome::new(&run(&[TRUCK], events)).agents[0];
        assert_eq!((outcome.distance_m, outcome.cusps, outcome.driving_s), (20.0, 2, 10.0));
        assert_eq!(outcome.wasted_drives, 1);
    }

    #[test]
    fn a_plan_dropped_before_it_sets_out_is_no_drive() {
        let pose = sample::small_setting(&[TRUCK]).agents[0].pose;
        let events = vec![
            at(10.0, ignited(A)),
            at(10.0, planned(TRUCK, A, leg(20.0, pose, 8.0, &[80.0]))),
            at(15.0, Fact::Fire(FireFact::BurnedOut { cell: A })),
            at(15.0, Fact::Agent(TRUCK, AgentFact::Dropped { goal: A, trajectory: leg(15.0, pose, 8.0, &[]) })),
        ];
        let outcome = &Outcome::new(&run(&[TRUCK], events)).agents[0];
        assert_eq!((outcome.distance_m, outcome.wasted_drives), (0.0, 0));
        assert_eq!((outcome.planning_s, outcome.driving_s, outcome.standing_s), (5.0, 0.0, 95.0));
    }

    #[test]
    fn what_happens_at_the_end_counts_and_what_comes_later_does_not() {
        let events = vec![
            at(50.0, ignited(A)),
            at(60.0, ignited(B)),
            at(60.0, Fact::Ended { reason: EndReason::Duration }),
            at(70.0, ignited(C)),
        ];
        let outcome = Outcome::new(&run(&[], events));
        assert_eq!((outcome.burning, outcome.peak_burning, outcome.burning_cell_s), (2, 2, 10.0));
    }

    #[test]
    fn a_stop_that_extinguishes_all_in_reach_is_one_drive_well_spent() {
        let pose = sample::small_setting(&[TRUCK]).agents[0].pose;
        let events = vec![
            at(0.0, ignited(A)),
            at(0.0, ignited(B)),
            at(0.0, planned(TRUCK, B, leg(0.0, pose, 8.0, &[80.0]))),
            at(10.0, Fact::Agent(TRUCK, AgentFact::Suppressing { cell: B, water_units: 1 })),
            at(15.0, Fact::Fire(FireFact::Extinguished { cell: A, by: TRUCK })),
            at(15.0, Fact::Fire(FireFact::Extinguished { cell: B, by: TRUCK })),
        ];
        let outcome = Outcome::new(&run(&[TRUCK], events));
        assert_eq!((outcome.agents[0].cells, outcome.agents[0].wasted_drives), (2, 0));
        assert_eq!((outcome.agents[0].suppressing_s, outcome.agents[0].standing_s), (5.0, 85.0));
        assert_eq!((outcome.winner(), outcome.truck_score), (Winner::Unimog, 4.0));
    }
}
