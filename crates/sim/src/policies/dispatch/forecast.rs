//! A forecast of the fires that burn now and of a team's response: a simulation without roads and bodies.
//!
//! Fire goes on by the rule of the radius. Trucks drive straight, at the speed and by the factor by which decisions estimate
//! drives; who has put out a fire, or has none, goes for the nearest that it can save. Nothing is lit: what Wumpuses will do is
//! the same whatever is decided now, so to leave it out is one way to give all decisions the same future.

use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeSet, BinaryHeap};

use glam::DVec2;

use super::place_index::PlaceIndex;
use super::team::Team;
use super::threat::cells_within;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;

/// How far a forecast looks ahead: two fires after each other, from ignition to burn-out, under the rules of the contest.
const HORIZON: SimTime = SimTime::from_nanos(180_000_000_000);
/// A fire that spreads without end is followed up to so many bushes.
const MAX_FIRES: usize = 4000;

/// The loss in a forecast: bushes first, then the time in which bushes burn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    pub bushes: u32,
    pub burning_s: f64,
}

impl Loss {
    /// Compares by bushes, then by time.
    pub fn cmp(&self, other: &Self) -> Ordering {
        self.bushes.cmp(&other.bushes).then(self.burning_s.total_cmp(&other.burning_s))
    }
}

/// A team from which forecasts begin.
#[derive(Clone, Debug)]
pub struct TeamForecast<'a> {
    team: &'a Team<'a>,
    /// Offsets of cells that a fire reaches.
    near: Vec<(i32, i32)>,
    fires: Vec<FutureFire>,
    /// Of these fires, not of those that catch fire later.
    index: PlaceIndex,
    end: SimTime,
}

#[derive(Clone, Copy, Debug)]
struct FutureFire {
    cell: Cell,
    place: DVec2,
    burns_out: SimTime,
    spreads_at: SimTime,
    is_claimed: bool,
    burns: bool,
}

#[derive(Clone, Copy, Debug)]
struct FutureTruck {
    place: DVec2,
    speed_mps: f64,
    is_free: bool,
    /// It has found nothing to go for; what burned then only becomes less savable.
    is_idle: bool,
    /// Its number among the fires.
    goal: Option<usize>,
}

/// What comes due, in the order in which it happens at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ForecastEvent {
    TruckFree(usize),
    BurnOut(usize),
    Spread(usize),
}

impl<'a> TeamForecast<'a> {
    pub fn new(team: &'a Team<'a>) -> Self {
        let near = team.rules.spread.map_or(Vec::new(), |(radius_m, _)| cells_within(radius_m, team));
        let fires = team.fires.iter().map(|fire| FutureFire {
            cell: fire.cell,
            place: fire.place,
            burns_out: fire.burns_out,
            spreads_at: fire.spreads_at,
            is_claimed: false,
            burns: true,
        });
        let index = PlaceIndex::new(&team.frame, team.fires.iter().map(|fire| fire.place).collect());
        Self { team, near, fires: fires.collect(), index, end: team.end.min(team.now + HORIZON) }
    }

    /// Simulates from now on with these cells as goals of trucks that are asked, which are named by their places in the
    /// team. An asked truck without a goal waits until something happens.
    pub fn play(&self, goals: &[(usize, Cell)]) -> Loss {
        let mut future = Future {
            of: self,
            now: self.team.now,
            burning: self.fires.len(),
            seen: 0,
            fires: self.fires.clone(),
            trucks: Vec::with_capacity(self.team.trucks.len()),
            ignited: BTreeSet::new(),
            due: BinaryHeap::new(),
            loss: Loss { bushes: 0, burning_s: 0.0 },
        };
        (0..future.fires.len()).for_each(|fire| future.expect(fire));
        let index = |cell: Cell| self.team.frame.index(cell);
        // Fires are in order of cell index.
        let number = |cell: Cell| self.fires.binary_search_by_key(&index(cell), |fire| index(fire.cell)).ok();
        for (truck, seen) in self.team.trucks.iter().enumerate() {
            let place = seen.place;
            let speed_mps = seen.speed_mps;
            future.trucks.push(FutureTruck { place, speed_mps, is_free: seen.is_queried, is_idle: false, goal: None });
            if !seen.is_queried {
                // It is free when it has put out what it goes for, or stands at.
                let goal = seen.goal.and_then(number);
                future.trucks[truck].goal = goal;
                goal.into_iter().for_each(|goal| future.fires[goal].is_claimed = true);
                future.due.push(Reverse((self.team.sets_out_at(seen), ForecastEvent::TruckFree(truck))));
            }
        }
        // After all trucks are there, as sending one needs its place only.
        for &(truck, cell) in goals {
            if let Some(fire) = number(cell) {
                future.send(truck, fire);
            }
        }
        future.play()
    }
}

struct Future<'a> {
    of: &'a TeamForecast<'a>,
    now: SimTime,
    fires: Vec<FutureFire>,
    /// How many of them burn.
    burning: usize,
    /// How many of them idle trucks have looked at.
    seen: usize,
    trucks: Vec<FutureTruck>,
    /// What has caught fire since the forecast began.
    ignited: BTreeSet<Cell>,
    due: BinaryHeap<Reverse<(SimTime, ForecastEvent)>>,
    loss: Loss,
}

impl Future<'_> {
    fn play(mut self) -> Loss {
        while let Some(&Reverse((time, due))) = self.due.peek()
            // What ends later is burning at the end, and counted there.
            && time <= self.of.end
        {
            self.due.pop();
            self.wait_until(time);
            match due {
                ForecastEvent::TruckFree(truck) => {
                    if let Some(goal) = self.trucks[truck].goal.take() {
                        self.end_fire(goal);
                    }
                    self.trucks[truck].is_free = true;
                }
                ForecastEvent::BurnOut(fire) => self.loss.bushes += u32::from(self.end_fire(fire)),
                ForecastEvent::Spread(fire) if self.fires[fire].burns => self.spread(self.fires[fire].cell),
                ForecastEvent::Spread(_) => {}
            }
            // Who is free chooses when all of this instant has happened.
            if self.due.peek().is_none_or(|&Reverse((next, _))| next > time) {
                self.send_all();
            }
        }
        self.wait_until(self.of.end);
        // A fire that a truck is on its way to counts as stopped.
        self.loss.bushes += self.fires.iter().filter(|fire| fire.burns && !fire.is_claimed).count() as u32;
        self.loss
    }

    fn wait_until(&mut self, time: SimTime) {
        self.loss.burning_s += time.since(self.now).as_seconds() * self.burning as f64;
        self.now = time;
    }

    /// Ends a fire and says whether it burned.
    fn end_fire(&mut self, fire: usize) -> bool {
        let burned = std::mem::replace(&mut self.fires[fire].burns, false);
        self.burning -= usize::from(burned);
        burned
    }

    /// Puts what follows on an ignition into the queue.
    fn expect(&mut self, fire: usize) {
        let FutureFire { burns_out, spreads_at, .. } = self.fires[fire];
        let events = [(burns_out, ForecastEvent::BurnOut(fire)), (spreads_at, ForecastEvent::Spread(fire))];
        self.due.extend(events.into_iter().filter(|&(time, _)| time <= self.of.end).map(Reverse));
    }

    fn spread(&mut self, from: Cell) {
        let team = self.of.team;
        for &(cols, rows) in &self.of.near {
            let Some(cell) = team.frame.offset(from, cols, rows) else { continue };
            // The bound keeps a rollout cheap where everything burns; the order of tests puts the set's insertion last.
            if self.fires.len() >= MAX_FIRES || !team.intact.is_intact(cell) || !self.ignited.insert(cell) {
                continue;
            }
            let delay = team.rules.spread.filter(|_| team.rules.caught_spreads).map(|(_, delay)| delay);
            self.fires.push(FutureFire {
                cell,
                place: team.frame.centre(cell),
                burns_out: team.rules.burn_out.map_or(SimTime::MAX, |span| self.now + span),
                spreads_at: delay.map_or(SimTime::MAX, |delay| self.now + delay),
                is_claimed: false,
                burns: true,
            });
            self.burning += 1;
            self.expect(self.fires.len() - 1);
        }
    }

    fn send(&mut self, truck: usize, fire: usize) {
        let FutureTruck { place, speed_mps, .. } = self.trucks[truck];
        let out_at = self.now + self.of.team.stop_time(speed_mps, place, self.fires[fire].place);
        self.fires[fire].is_claimed = true;
        self.trucks[truck] =
            FutureTruck { place: self.fires[fire].place, speed_mps, is_free: false, is_idle: false, goal: Some(fire) };
        self.due.push(Reverse((out_at, ForecastEvent::TruckFree(truck))));
    }

    /// Sends free trucks to the nearest fires that they can save, always the truck first whose fire is out first.
    fn send_all(&mut self) {
        // Each free truck's best fire waits here; it bids again only if another truck has taken that.
        let mut bids: BinaryHeap<Reverse<(SimTime, usize, usize)>> = BinaryHeap::new();
        for truck in (0..self.trucks.len()).filter(|&truck| self.trucks[truck].is_free) {
            bids.extend(self.best_for(truck).map(Reverse));
        }
        while let Some(Reverse((_, fire, truck))) = bids.pop() {
            if self.fires[fire].is_claimed {
                bids.extend(self.best_for(truck).map(Reverse));
            } else {
                self.send(truck, fire);
            }
        }
        // An idle truck has seen all fires of now: later it looks only at new ones.
        self.trucks.iter_mut().for_each(|truck| truck.is_idle = truck.is_free);
        self.seen = self.fires.len();
    }

    /// Finds the fire that a truck has out first, when, and names the truck.
    fn best_for(&self, truck: usize) -> Option<(SimTime, usize, usize)> {
        let FutureTruck { place, speed_mps, is_idle, .. } = self.trucks[truck];
        let team = self.of.team;
        let out_at = |fire: usize| {
            let FutureFire { place: goal, burns_out, is_claimed, burns, .. } = self.fires[fire];
            let out_at = self.now + team.stop_time(speed_mps, place, goal);
            // What is put out after the end of the run is not saved.
            (burns && !is_claimed && out_at <= burns_out.min(team.end)).then_some(out_at)
        };
        let existing = self.of.fires.len();
        let old = if is_idle {
            None
        } else {
            // Nothing that burns at the start burns longer than this, if anything burns out at all.
            let time = team.rules.burn_out.map_or(SimTime::MAX, |span| (team.now + span).since(self.now));
            let found = self.of.index.nearest(place, 1, team.range_m(speed_mps, time), |fire| out_at(fire).is_some());
            found.first().and_then(|&(_, fire)| Some((out_at(fire)?, fire, truck)))
        };
        let from = if is_idle { self.seen.max(existing) } else { existing };
        let new = (from..self.fires.len()).filter_map(|fire| Some((out_at(fire)?, fire, truck)));
        old.into_iter().chain(new).min()
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::Sample;
    use super::*;

    fn loss(sample: &Sample, goals: &[(usize, (u16, u16))]) -> Loss {
        let goals: Vec<(usize, Cell)> = goals.iter().map(|&(truck, cell)| (truck, cell.into())).collect();
        TeamForecast::new(&sample.team()).play(&goals)
    }

    #[test]
    fn a_forecast_written_by_hand_has_these_numbers() {
        let mut sample = Sample::with_trucks(&[(62.5, 50.0)]);
        sample.burn((12, 10));
        sample.grow(&[(13, 10), (14, 10), (30, 30)]);
        // In reach at once: out after the dwell, before it spreads.
        assert_eq!(loss(&sample, &[(0, (12, 10))]), Loss { bushes: 0, burning_s: 5.0 });
        // It spreads after 10 s to two of the three; then the truck begins: 5 s for what is in reach, three times.
        let waits = loss(&sample, &[]);
        assert_eq!(waits.bushes, 0);
        assert!(waits.burning_s > 10.0 + 5.0 + 10.0 + 15.0 - 1e-9 && waits.burning_s < 42.0, "{waits:?}");
        // Nobody there: three bushes burn for a minute each.
        sample.trucks.clear();
        assert_eq!(loss(&sample, &[]), Loss { bushes: 3, burning_s: 180.0 });
    }

    #[test]
    fn a_second_truck_never_loses_more_when_nothing_spreads() {
        for seed in 0..40 {
            let mut sample = Sample::drawn(seed, 1, 8);
            sample.fires.iter_mut().for_each(|fire| fire.spreads_at = SimTime::MAX);
            let one = loss(&sample, &[]);
            sample.trucks.clear();
            let none = loss(&sample, &[]);
            assert!(one.bushes <= none.bushes, "seed {seed}: {one:?}, {none:?}");
            assert_eq!(none.bushes as usize, sample.fires.len(), "without trucks all burn out");
        }
    }
}
