//! The rules of dispatch, compared in an abstract contest without roads and bodies: the fire rules of the contest, straight ways
//! longer by a factor, no traffic, planning for nothing. Wumpuses go for random intact bushes.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec2;
use rand::RngExt;
use rand::seq::SliceRandom;

use wildfire::geometry::{Cell, FieldFrame};
use wildfire::rng;
use wildfire::sim::policies::dispatch::{
    Assignment, Auction, Centroids, Fire, Hungarian, Intact, NearestByNumber, NearestSavable, Regions, RegionsFirst,
    Rollout, StagingRule, Stay, Team, TeamRules, TeamTruck, ThreatFirst, WAY_FACTOR,
};
use wildfire::time::SimTime;
use wildfire::timeline::AgentId;

const COVERAGE: f64 = 0.1;
const RADIUS_M: f64 = 30.0;
const SPREAD_DELAY: SimTime = SimTime::from_nanos(10_000_000_000);
const BURN_OUT: SimTime = SimTime::from_nanos(60_000_000_000);
const DWELL: SimTime = SimTime::from_nanos(5_000_000_000);
const REACH_M: f64 = 10.0;
const TRUCK_MPS: f64 = 8.0;
const WUMPUS_MPS: f64 = 2.0;
const WUMPUS_REACH_M: f64 = 6.25;

/// What is played.
#[derive(Clone, Copy, Debug)]
struct Contest {
    field_m: f64,
    trucks: u16,
    wumpuses: u16,
    duration: SimTime,
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    /// Bushes that burned out or burn at the end, in thousandths of all.
    lost: f64,
    /// Drives that ended at no extinction.
    wasted: u32,
    driven_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Bush {
    Intact,
    Burning { since: SimTime, ignited: bool },
    Gone,
    Out,
}

#[derive(Debug)]
struct Field {
    frame: FieldFrame,
    cells: Arc<[Cell]>,
    /// By cell index.
    bushes: Vec<Option<Bush>>,
}

impl Intact for Field {
    fn is_intact(&self, cell: Cell) -> bool {
        self.bushes[self.frame.index(cell)] == Some(Bush::Intact)
    }

    fn bushes(&self) -> Arc<[Cell]> {
        Arc::clone(&self.cells)
    }
}

#[derive(Debug)]
struct Arsonist {
    /// Bushes in the order in which it goes for them.
    targets: Vec<Cell>,
    next: usize,
    walk: Way,
}

#[derive(Debug)]
struct Truck {
    way: Way,
    goal: Option<Cell>,
    staging_point: Option<DVec2>,
    stops_until: Option<SimTime>,
    start: DVec2,
}

#[derive(Clone, Copy, Debug)]
struct Way {
    from: DVec2,
    to: DVec2,
    departs: SimTime,
    arrives: SimTime,
}

impl Way {
    fn stand(place: DVec2) -> Self {
        Self { from: place, to: place, departs: SimTime::ZERO, arrives: SimTime::ZERO }
    }

    /// A straight way to within `reach_m` of a place.
    fn new(now: SimTime, from: DVec2, target: DVec2, (reach_m, mps): (f64, f64)) -> Self {
        let metres = (target - from).length();
        let to = if metres > reach_m { target + (from - target) * (reach_m / metres) } else { from };
        let arrives = now + SimTime::from_seconds_up(WAY_FACTOR * (to - from).length() / mps);
        Self { from, to, departs: now, arrives }
    }

    fn place_at(&self, time: SimTime) -> DVec2 {
        let (done, all) = (time.since(self.departs).as_seconds(), self.arrives.since(self.departs).as_seconds());
        if done >= all { self.to } else { self.from.lerp(self.to, done / all) }
    }

    fn driven_m(&self, time: SimTime) -> f64 {
        WAY_FACTOR * (self.place_at(time) - self.from).length()
    }
}

/// Plays one contest to its end.
fn play(contest: Contest, seed: u64, assignment: &mut dyn Assignment, positioning: &mut dyn StagingRule) -> Score {
    let mut world = World::new(contest, seed);
    world.dispatch(true, assignment, positioning);
    while let Some(now) = world.next_event() {
        world.now = now;
        let (changed, freed) = world.happen();
        if changed || freed {
            world.dispatch(changed, assignment, positioning);
        }
    }
    let lost = world.field.cells.iter().filter(|&&cell| {
        matches!(world.field.bushes[world.field.frame.index(cell)], Some(Bush::Gone | Bush::Burning { .. }))
    });
    world.score.lost = 1000.0 * lost.count() as f64 / world.field.cells.len() as f64;
    world.score
}

#[derive(Debug)]
struct World {
    now: SimTime,
    end: SimTime,
    field: Field,
    /// Cell indices.
    burning: BTreeSet<usize>,
    arsonists: Vec<Arsonist>,
    trucks: Vec<Truck>,
    score: Score,
}

impl World {
    fn new(contest: Contest, seed: u64) -> Self {
        let side = (contest.field_m / 5.0) as u16;
        let frame = FieldFrame { cols: side, rows: side, cell_m: 5.0 };
        let mut rng = rng::stream(seed, "model");
        let mut bushes = vec![None; frame.cell_count()];
        // Pieces of four cells in a row or in a square, as the fields of the contest are made of.
        let shapes =
            [[(0, 0), (1, 0), (2, 0), (3, 0)], [(0, 0), (0, 1), (0, 2), (0, 3)], [(0, 0), (0, 1), (1, 0), (1, 1)]];
        let mut left = (COVERAGE * frame.cell_count() as f64) as usize / 4;
        while left > 0 {
            let (at, shape) = (frame.cell(rng.random_range(0..frame.cell_count())), shapes[rng.random_range(0..3)]);
            let cells: Vec<Cell> = shape.iter().filter_map(|&(cols, rows)| frame.offset(at, cols, rows)).collect();
            if cells.len() == 4 && cells.iter().all(|&cell| bushes[frame.index(cell)].is_none()) {
                cells.iter().for_each(|&cell| bushes[frame.index(cell)] = Some(Bush::Intact));
                left -= 1;
            }
        }
        let cells: Arc<[Cell]> =
            (0..frame.cell_count()).filter(|&index| bushes[index].is_some()).map(|index| frame.cell(index)).collect();
        let mut place = || DVec2::new(rng.random_range(0.0..contest.field_m), rng.random_range(0.0..contest.field_m));
        let starts: Vec<DVec2> = (0..contest.trucks).map(|_| place()).collect();
        let stands: Vec<DVec2> = (0..contest.wumpuses).map(|_| place()).collect();
        let arsonist = |(number, &stand): (usize, &DVec2)| {
            let mut targets = cells.to_vec();
            targets.shuffle(&mut rng::stream(seed, &format!("wumpus/{number}")));
            Arsonist { targets, next: 0, walk: Way::stand(stand) }
        };
        let truck = |&start: &DVec2| Truck {
            way: Way::stand(start),
            goal: None,
            staging_point: None,
            stops_until: None,
            start,
        };
        let mut world = Self {
            now: SimTime::ZERO,
            end: contest.duration,
            arsonists: stands.iter().enumerate().map(arsonist).collect(),
            trucks: starts.iter().map(truck).collect(),
            field: Field { frame, cells: Arc::clone(&cells), bushes },
            burning: BTreeSet::new(),
            score: Score::default(),
        };
        world.arsonists_choose();
        world
    }

    /// Wumpuses whose goal is no longer intact go for the next that is.
    fn arsonists_choose(&mut self) {
        let (field, now) = (&self.field, self.now);
        for wumpus in &mut self.arsonists {
            if wumpus.targets.get(wumpus.next).is_some_and(|&cell| field.is_intact(cell)) && wumpus.walk.arrives > now {
                continue;
            }
            while wumpus.targets.get(wumpus.next).is_some_and(|&cell| !field.is_intact(cell)) {
                wumpus.next += 1;
            }
            if let Some(&cell) = wumpus.targets.get(wumpus.next) {
                let place = wumpus.walk.place_at(now);
                wumpus.walk = Way::new(now, place, field.frame.centre(cell), (WUMPUS_REACH_M, WUMPUS_MPS));
            }
        }
    }

    fn since(&self, index: usize) -> (SimTime, bool) {
        let Some(Bush::Burning { since, ignited }) = self.field.bushes[index] else { panic!("it burns") };
        (since, ignited)
    }

    fn next_event(&self) -> Option<SimTime> {
        let fires = self.burning.iter().flat_map(|&index| {
            let (since, ignited) = self.since(index);
            [Some(since + BURN_OUT), ignited.then_some(since + SPREAD_DELAY)].into_iter().flatten()
        });
        let wumpuses = self.arsonists.iter().filter(|wumpus| wumpus.next < wumpus.targets.len());
        let wumpuses = wumpuses.map(|wumpus| wumpus.walk.arrives);
        let trucks = self.trucks.iter().filter_map(|truck| match (truck.stops_until, truck.goal) {
            (Some(until), _) => Some(until),
            (None, Some(_)) => Some(truck.way.arrives),
            (None, None) => None,
        });
        fires.chain(wumpuses).chain(trucks).filter(|&time| time > self.now && time <= self.end).min()
    }

    /// Lets all happen that is due now; says whether fires changed and whether a truck became free.
    fn happen(&mut self) -> (bool, bool) {
        let now = self.now;
        let (mut changed, mut freed) = (false, false);
        for truck in &mut self.trucks {
            if truck.stops_until.is_some_and(|until| until <= now) {
                let goal = self.field.frame.index(truck.goal.expect("who stops has a goal"));
                if self.burning.remove(&goal) {
                    self.field.bushes[goal] = Some(Bush::Out);
                    changed = true;
                } else {
                    self.score.wasted += 1;
                }
                (truck.stops_until, truck.goal, freed) = (None, None, true);
                self.score.driven_m += truck.way.driven_m(now);
                truck.way = Way::stand(truck.way.to);
            }
        }
        let burning: Vec<usize> = self.burning.iter().copied().collect();
        for &index in &burning {
            if self.since(index).0 + BURN_OUT <= now {
                self.field.bushes[index] = Some(Bush::Gone);
                self.burning.remove(&index);
                changed = true;
            }
        }
        for index in burning.into_iter().filter(|index| self.burning.contains(index)).collect::<Vec<_>>() {
            let (since, ignited) = self.since(index);
            if ignited && since + SPREAD_DELAY == now {
                let centre = self.field.frame.centre(self.field.frame.cell(index));
                let near = |cell: &&Cell| (self.field.frame.centre(**cell) - centre).length() <= RADIUS_M;
                let caught: Vec<Cell> =
                    self.field.cells.iter().filter(near).copied().filter(|&cell| self.field.is_intact(cell)).collect();
                caught.into_iter().for_each(|cell| self.ignite(cell, false));
                changed = true;
            }
        }
        for number in 0..self.arsonists.len() {
            let wumpus = &self.arsonists[number];
            if let Some(&cell) = wumpus.targets.get(wumpus.next).filter(|_| wumpus.walk.arrives <= now)
                && self.field.is_intact(cell)
            {
                self.ignite(cell, true);
                changed = true;
            }
        }
        self.arsonists_choose();
        for truck in &mut self.trucks {
            let Some(goal) = truck.goal else { continue };
            if !self.burning.contains(&self.field.frame.index(goal)) {
                // It has burned out or another truck has put it out.
                self.score.wasted += 1;
                self.score.driven_m += truck.way.driven_m(now);
                truck.way = Way::stand(truck.way.place_at(now));
                (truck.goal, truck.stops_until, freed) = (None, None, true);
            } else if truck.stops_until.is_none() && truck.way.arrives <= now {
                truck.stops_until = Some(now + DWELL);
            }
        }
        (changed, freed)
    }

    fn ignite(&mut self, cell: Cell, ignited: bool) {
        let index = self.field.frame.index(cell);
        self.field.bushes[index] = Some(Bush::Burning { since: self.now, ignited });
        self.burning.insert(index);
    }

    fn dispatch(&mut self, changed: bool, assignment: &mut dyn Assignment, positioning: &mut dyn StagingRule) {
        let now = self.now;
        let replans = changed && assignment.replans();
        let stopped: Vec<Cell> =
            self.trucks.iter().filter(|truck| truck.stops_until.is_some()).filter_map(|truck| truck.goal).collect();
        let fires = self.burning.iter().map(|&index| (self.field.frame.cell(index), self.since(index)));
        let fires = fires.filter(|(cell, _)| !stopped.contains(cell)).map(|(cell, (since, ignited))| Fire {
            cell,
            place: self.field.frame.centre(cell),
            since,
            burns_out: since + BURN_OUT,
            spreads_at: if ignited && since + SPREAD_DELAY > now { since + SPREAD_DELAY } else { SimTime::MAX },
        });
        let trucks = self.trucks.iter().zip(0..).map(|(truck, number)| {
            let is_queried = truck.goal.is_none() || (replans && truck.stops_until.is_none());
            let free_at = truck.stops_until.unwrap_or(truck.way.arrives + DWELL);
            TeamTruck {
                id: AgentId::unimog(number),
                place: if is_queried { truck.way.place_at(now) } else { truck.way.to },
                free_at: if is_queried { now } else { free_at },
                speed_mps: TRUCK_MPS,
                goal: truck.goal,
                staging_point: truck.staging_point,
                start: truck.start,
                is_queried,
                stops_left: u32::MAX,
            }
        });
        let team = Team {
            now,
            end: self.end,
            frame: self.field.frame,
            rules: TeamRules {
                reach_m: Some(REACH_M),
                dwell: DWELL,
                extinguishes_all: false,
                spread: Some((RADIUS_M, SPREAD_DELAY)),
                caught_spreads: false,
                burn_out: Some(BURN_OUT),
            },
            fires: fires.collect(),
            trucks: trucks.collect(),
            intact: &self.field,
            wumpuses: Vec::new(),
            water: None,
        };
        if team.queried().next().is_none() {
            return;
        }
        let goals = assignment.assign(&team, &mut 0);
        let goal_of = |id: AgentId| goals.iter().find(|(queried, _)| *queried == id).map(|&(_, cell)| cell);
        let idle: Vec<AgentId> = team.queried().map(|truck| truck.id).filter(|&id| goal_of(id).is_none()).collect();
        let posts = positioning.staging_points(&team, &idle);
        let queried: Vec<AgentId> = team.queried().map(|truck| truck.id).collect();
        let mut orders = Vec::new();
        for id in queried {
            let staging_point = posts.iter().find(|(posted, _)| *posted == id).map(|&(_, staging_point)| staging_point);
            orders.push((usize::from(id.number), goal_of(id), staging_point));
        }
        for (number, goal, staging_point) in orders {
            let truck = &mut self.trucks[number];
            let place = truck.way.place_at(now);
            if goal != truck.goal {
                self.score.wasted += u32::from(truck.goal.is_some());
                truck.goal = goal;
                self.score.driven_m += truck.way.driven_m(now);
                truck.way = Way::stand(place);
                truck.staging_point = None;
                if let Some(goal) = goal {
                    truck.way = Way::new(now, place, self.field.frame.centre(goal), (REACH_M, TRUCK_MPS));
                    if truck.way.arrives <= now {
                        truck.stops_until = Some(now + DWELL);
                    }
                }
            }
            if let Some(staging_point) = staging_point {
                self.score.driven_m += truck.way.driven_m(now);
                truck.staging_point = Some(staging_point);
                truck.way = Way::new(now, place, staging_point, (0.0, TRUCK_MPS));
            }
        }
    }
}

/// Eight trucks against four Wumpuses: fires outnumber trucks.
const DUEL: Contest =
    Contest { field_m: 500.0, trucks: 8, wumpuses: 4, duration: SimTime::from_nanos(1_500_000_000_000) };

fn mean(seeds: std::ops::Range<u64>, assignment: &dyn Fn() -> Box<dyn Assignment>, waits: bool) -> Score {
    let count = seeds.end - seeds.start;
    let mut mean = Score::default();
    for seed in seeds {
        let mut idle: Box<dyn StagingRule> = if waits { Box::new(Centroids::default()) } else { Box::new(Stay) };
        let score = play(DUEL, seed, &mut *assignment(), &mut *idle);
        mean.lost += score.lost / count as f64;
        mean.driven_m += score.driven_m / count as f64;
        mean.wasted += score.wasted;
    }
    mean
}

/// Losses in the order that fleets were measured to have: what leaves hopeless fires alone loses less than what does not,
/// routes with deadlines lose less than single fires, and who waits in a good place loses less again.
#[test]
fn policies_rank_as_they_should() {
    let seeds = || 1..21;
    let nearest = mean(seeds(), &|| Box::new(NearestByNumber), false);
    let savable = mean(seeds(), &|| Box::new(NearestSavable), false);
    let auction = mean(seeds(), &|| Box::new(Auction), false);
    let both = mean(seeds(), &|| Box::new(Auction), true);
    println!("{nearest:?}\n{savable:?}\n{auction:?}\n{both:?}");
    assert!(savable.lost < 0.85 * nearest.lost, "{savable:?}, {nearest:?}");
    assert!(auction.lost < 0.5 * savable.lost, "{auction:?}, {savable:?}");
    assert!(both.lost < 0.5 * auction.lost, "{both:?}, {auction:?}");
    assert!(savable.driven_m < 0.9 * nearest.driven_m, "{savable:?}, {nearest:?}");
    assert_eq!(savable.wasted, 0, "in a world without roads no drive to a savable fire is in vain");
}

#[test]
fn the_same_seed_is_the_same_contest() {
    for rule in 0..6 {
        let make = || -> Box<dyn Assignment> {
            match rule {
                0 => Box::new(NearestSavable),
                1 => Box::new(Hungarian),
                2 => Box::new(ThreatFirst),
                3 => Box::new(Auction),
                4 => Box::new(RegionsFirst(Box::new(NearestSavable))),
                _ => Box::new(Rollout { rollouts: 5 }),
            }
        };
        let short = Contest { duration: SimTime::from_nanos(300_000_000_000), ..DUEL };
        let play = || play(short, 3, &mut *make(), &mut Regions::default());
        assert_eq!((play().lost, play().driven_m), (play().lost, play().driven_m));
    }
}
