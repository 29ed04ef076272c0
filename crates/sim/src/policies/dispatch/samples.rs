//! Teams for tests: random, or assembled by hand.

use std::sync::Arc;

use glam::DVec2;
use rand::RngExt;

use super::open_fires::OpenFires;
use super::team::{Fire, Intact, Team, TeamRules, TeamTruck};
use super::{Assignment, Auction, Hungarian, NearestSavable, RegionsFirst, ThreatFirst};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_timeline::{AgentId, WaterRules};

const FRAME: FieldFrame = FieldFrame { cols: 50, rows: 50, cell_m: 5.0 };
const SPREAD: (f64, SimTime) = (30.0, SimTime::from_nanos(10_000_000_000));
const BURN_OUT: SimTime = SimTime::from_nanos(60_000_000_000);

/// A field of 250 m under the rules of the contest, its fires and its trucks at one instant.
#[derive(Clone, Debug)]
pub struct Sample {
    pub now_s: f64,
    pub trucks: Vec<TeamTruck>,
    pub fires: Vec<Fire>,
    /// By cell index.
    intact: Vec<bool>,
    pub water: Option<WaterRules>,
}

impl Sample {
    /// Creates up to eight random trucks and fifteen fires.
    pub fn new(seed: u64) -> Self {
        Self::drawn(seed, 8, 15)
    }

    /// Creates so few random trucks and fires that all assignments can be tried.
    pub fn small(seed: u64) -> Self {
        Self::drawn(seed, 4, 6)
    }

    /// Creates random trucks and fires up to these numbers; some trucks are busy, some are driving.
    pub fn drawn(seed: u64, max_trucks: u16, max_fires: usize) -> Self {
        let mut rng = rng::stream(seed, "team");
        let mut sample = Self::with_trucks(&[]);
        sample.now_s = 100.0;
        sample.intact = (0..FRAME.cell_count()).map(|_| rng.random_bool(0.1)).collect();
        // Half of them in one corner, so that some threaten the same bushes.
        for number in 0..rng.random_range(1..=max_fires) {
            let side = if number % 2 == 0 { 50 } else { 15 };
            let cell = Cell { col: rng.random_range(0..side), row: rng.random_range(0..side) };
            sample.burn_since(cell, 100.0 - rng.random_range(0.0..60.0));
        }
        for number in 0..rng.random_range(1..=max_trucks) {
            let place = DVec2::new(rng.random_range(5.0..245.0), rng.random_range(5.0..245.0));
            let mut truck = truck_at(number, place);
            let goal = sample.fires[rng.random_range(0..sample.fires.len())].cell;
            match rng.random_range(0..5) {
                0 if sample.trucks.iter().all(|other| other.goal != Some(goal)) => truck.goal = Some(goal),
                1 if sample.trucks.iter().all(|other| other.goal != Some(goal)) => {
                    (truck.goal, truck.is_queried) = (Some(goal), false);
                    truck.free_at = SimTime::from_seconds(100.0 + rng.random_range(0.0..20.0));
                }
                _ => {}
            }
            sample.trucks.push(truck);
        }
        sample
    }

    /// Puts free trucks on a bare field.
    pub fn with_trucks(places: &[(f64, f64)]) -> Self {
        let trucks = places.iter().zip(0..).map(|(&(x, y), number)| truck_at(number, DVec2::new(x, y)));
        Self {
            now_s: 0.0,
            trucks: trucks.collect(),
            fires: Vec::new(),
            intact: vec![false; FRAME.cell_count()],
            water: None,
        }
    }

    /// Lets intact bushes grow.
    pub fn grow(&mut self, cells: &[(u16, u16)]) {
        cells.iter().for_each(|&cell| self.intact[FRAME.index(cell.into())] = true);
    }

    /// Lights a cell now.
    pub fn burn(&mut self, cell: (u16, u16)) {
        self.burn_since(cell.into(), self.now_s);
    }

    fn burn_since(&mut self, cell: Cell, since_s: f64) {
        if self.fires.iter().any(|fire| fire.cell == cell) {
            return;
        }
        self.intact[FRAME.index(cell)] = false;
        let since = SimTime::from_seconds(since_s);
        let now = SimTime::from_seconds(self.now_s);
        let spreads_at = if since + SPREAD.1 > now { since + SPREAD.1 } else { SimTime::MAX };
        let place = FRAME.centre(cell);
        self.fires.push(Fire { cell, place, since, burns_out: since + BURN_OUT, spreads_at });
        self.fires.sort_unstable_by_key(|fire| FRAME.index(fire.cell));
    }

    pub fn team(&self) -> Team<'_> {
        Team {
            now: SimTime::from_seconds(self.now_s),
            end: SimTime::from_seconds(3600.0),
            frame: FRAME,
            rules: TeamRules {
                reach_m: Some(10.0),
                dwell: SimTime::from_seconds(5.0),
                extinguishes_all: false,
                spread: Some(SPREAD),
                caught_spreads: false,
                burn_out: Some(BURN_OUT),
            },
            fires: self.fires.clone(),
            trucks: self.trucks.clone(),
            intact: self,
            wumpuses: Vec::new(),
            water: self.water.as_ref(),
        }
    }

    /// Fails unless goals belong to asked trucks, come by number, are open and savable, and are distinct.
    pub fn assert_sound(&self, goals: &[(AgentId, Cell)]) {
        let team = self.team();
        let open = OpenFires::new(&team);
        assert!(goals.is_sorted_by(|one, next| one.0 < next.0), "trucks come by number, each once: {goals:?}");
        for (number, (id, cell)) in goals.iter().enumerate() {
            let truck = team.queried().find(|truck| truck.id == *id).expect("only trucks that are asked get goals");
            let fire = open.fires.iter().position(|fire| fire.cell == *cell).expect("only open fires are given");
            assert!(open.prospect(truck, fire).is_some(), "{id} comes too late");
            assert!(goals[..number].iter().all(|(_, other)| other != cell), "{cell} is given twice");
        }
    }
}

impl Intact for Sample {
    fn is_intact(&self, cell: Cell) -> bool {
        self.intact[FRAME.index(cell)]
    }

    fn bushes(&self) -> Arc<[Cell]> {
        (0..FRAME.cell_count()).filter(|&index| self.intact[index]).map(|index| FRAME.cell(index)).collect()
    }
}

fn truck_at(number: u16, place: DVec2) -> TeamTruck {
    TeamTruck {
        id: AgentId::unimog(number),
        place,
        free_at: SimTime::ZERO,
        speed_mps: 8.0,
        goal: None,
        staging_point: None,
        start: place,
        is_queried: true,
        stops_left: u32::MAX,
    }
}

#[test]
fn goals_are_savable_open_and_assigned_once() {
    let mut regions = RegionsFirst(Box::new(NearestSavable));
    let mut rules: [&mut dyn Assignment; 5] =
        [&mut NearestSavable, &mut Hungarian, &mut ThreatFirst, &mut Auction, &mut regions];
    for seed in 0..60 {
        let sample = Sample::new(seed);
        for rule in &mut rules {
            sample.assert_sound(&rule.assign(&sample.team(), &mut 0));
        }
    }
}
