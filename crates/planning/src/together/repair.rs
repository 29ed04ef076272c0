//! Routes for all vehicles: one after the other, then repair by large neighbourhoods.
//!
//! Each vehicle in turn takes its cheapest route among those before it. Where conflicts are left, a few vehicles around
//! one of them lose their routes and plan again in a random order, and the new routes are kept if no more pairs conflict
//! (J. Li, Z. Chen, D. Harabor, P. Stuckey, S. Koenig, "MAPF-LNS2: fast repairing for multi-agent path finding via large
//! neighborhood search", AAAI 2022). Then the same, without conflicts, makes routes cheaper (J. Li et al., "Anytime
//! multi-agent path finding via large neighborhood search", IJCAI 2021).

use std::fmt;

use rand::RngExt;
use rand::seq::SliceRandom;
use serde::Serialize;

use super::route::{Others, Query, Search, StaticDrive, drives, keep, shortened, wait_along};
use super::world::{Motion, StaticMap, Traffic};
use super::{Instance, Mode, Route};
use wildfire_base::geometry::Pose;
use wildfire_base::rng::{self, Xoshiro256PlusPlus};

/// Metres of a conflict that is not allowed.
const FORBIDDEN_M: f64 = 1e9;
/// Metres of a conflict at first, and its growth when repair gets stuck.
const PENALTY_M: f64 = 12.0;

/// Expansions of the search past the standing obstacles, and of a second one where the first finds nothing.
const DRIVE_EXPANSIONS: [u32; 2] = [4000, 200_000];

/// What is done about conflicts that planning one after the other leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RepairMethod {
    /// Other random orders.
    Prioritised,
    /// Repair by large neighbourhoods.
    Repair,
}

wildfire_base::names! { RepairMethod { Prioritised: "prioritised", Repair: "repair" } }

/// A plan's settings.
#[derive(Clone, Copy, Debug)]
pub struct PlanTogether {
    pub mode: Mode,
    pub method: RepairMethod,
    pub seed: u64,
    /// Most rounds of repair, of random orders a tenth; a limit on CPU time is usually reached before.
    pub rounds: u32,
    /// Rounds that make routes cheaper, for each vehicle.
    pub polish: u32,
}

impl Default for PlanTogether {
    fn default() -> Self {
        Self { mode: Mode::Exact, method: RepairMethod::Repair, seed: 1, rounds: 5000, polish: 0 }
    }
}

/// What a plan took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RepairEffort {
    pub expansions: u64,
    pub rounds: u32,
}

/// The reasons for which there are no routes.
#[derive(Clone, Debug, PartialEq)]
pub enum Unsolved {
    /// A start or a goal where the vehicle may not stand.
    Blocked { vehicle: String, is_goal: bool },
    /// Two starts, or two goals, whose vehicles touch.
    Crowded { vehicles: [String; 2], is_goal: bool },
    /// No drive past the standing obstacles was found for this vehicle alone.
    NoDrive { vehicle: String },
    /// Conflicts were left when all rounds were used.
    Conflicts { pairs: usize },
    /// The caller's limit ended the search.
    Stopped,
}

impl fmt::Display for Unsolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = |is_goal: &bool| if *is_goal { "goal" } else { "start" };
        match self {
            Self::Blocked { vehicle, is_goal } => {
                write!(f, "the {} of {vehicle} is blocked: an obstacle or the border is too near", end(is_goal))
            }
            Self::Crowded { vehicles: [one, other], is_goal } => {
                write!(f, "the {}s of {one} and {other} are too near to each other", end(is_goal))
            }
            Self::NoDrive { vehicle } => {
                write!(f, "no drive of {vehicle} past the obstacles was found, even without the other vehicles")
            }
            Self::Conflicts { pairs: 1 } => write!(f, "1 pair of vehicles still conflicts after all rounds"),
            Self::Conflicts { pairs } => write!(f, "{pairs} pairs of vehicles still conflict after all rounds"),
            Self::Stopped => write!(f, "the limit on CPU time ended the search"),
        }
    }
}

/// Finds a route for every vehicle, and says what that took. `is_stopped`, which is asked every few expansions, can only end the search without
/// routes, or its last part, which makes them cheaper.
///
/// # Errors
/// The reason, if there are no routes free of conflicts.
pub fn plan(
    instance: &Instance,
    settings: &PlanTogether,
    is_stopped: &mut dyn FnMut() -> bool,
    effort: &mut RepairEffort,
) -> Result<Vec<Route>, Unsolved> {
    let mut team = RepairTeam::new(instance, settings, is_stopped);
    let found = team.solve();
    *effort = RepairEffort { expansions: team.search.expanded, rounds: team.rounds };
    found.map(|()| team.routes.into_iter().map(|route| route.expect("all have routes")).collect())
}

struct RepairTeam<'a> {
    instance: &'a Instance,
    settings: &'a PlanTogether,
    /// The map for each vehicle.
    grounds: Vec<StaticMap<'a>>,
    drives: Vec<Vec<StaticDrive>>,
    traffic: Traffic,
    routes: Vec<Option<Route>>,
    /// For every vehicle those that it conflicts with, in order.
    conflicts: Vec<Vec<usize>>,
    search: Search,
    random: Xoshiro256PlusPlus,
    rounds: u32,
    is_stopped: &'a mut dyn FnMut() -> bool,
}

/// How thoroughly a vehicle plans.
#[derive(Clone, Copy)]
struct SearchBudget {
    penalty_m: f64,
    expansions: u32,
}

impl<'a> RepairTeam<'a> {
    fn new(instance: &'a Instance, settings: &'a PlanTogether, is_stopped: &'a mut dyn FnMut() -> bool) -> Self {
        let vehicles = instance.vehicles.len();
        Self {
            instance,
            settings,
            grounds: Vec::new(),
            drives: Vec::new(),
            traffic: Traffic::new(settings.mode, vehicles),
            routes: vec![None; vehicles],
            conflicts: vec![Vec::new(); vehicles],
            search: Search::default(),
            random: rng::stream(settings.seed, "together"),
            rounds: 0,
            is_stopped,
        }
    }

    fn solve(&mut self) -> Result<(), Unsolved> {
        self.check_ends()?;
        let instance = self.instance;
        for (index, vehicle) in instance.vehicles.iter().enumerate() {
            let mut found = Vec::new();
            // Few expansions first: most vehicles have an easy drive.
            for expansions in DRIVE_EXPANSIONS {
                if found.is_empty() {
                    self.continue_unless_stopped()?;
                    found = drives(&self.grounds[index], vehicle, &mut self.search, expansions, self.is_stopped);
                }
            }
            self.continue_unless_stopped()?;
            if found.is_empty() {
                return Err(Unsolved::NoDrive { vehicle: vehicle.name.clone() });
            }
            self.drives.push(found);
        }
        // The longest first: they meet the most others and end the last.
        let mut order: Vec<usize> = (0..self.routes.len()).collect();
        order.sort_by(|&a, &b| self.min_m(b).total_cmp(&self.min_m(a)));
        match self.settings.method {
            RepairMethod::Prioritised => self.try_orders(order)?,
            RepairMethod::Repair => {
                // A first plan with conflicts is quick, and repairing it is where the time goes.
                self.replan(&order, SearchBudget { penalty_m: PENALTY_M, expansions: 1000 })?;
                self.repair()?;
            }
        }
        // The routes are free already: a limit ends here without harm.
        match self.polish() {
            Ok(()) | Err(Unsolved::Stopped) => Ok(()),
            Err(other) => Err(other),
        }
    }

    fn continue_unless_stopped(&mut self) -> Result<(), Unsolved> {
        if (self.is_stopped)() { Err(Unsolved::Stopped) } else { Ok(()) }
    }

    fn check_ends(&mut self) -> Result<(), Unsolved> {
        let vehicles = &self.instance.vehicles;
        for vehicle in vehicles {
            let blocked = |is_goal| Unsolved::Blocked { vehicle: vehicle.name.clone(), is_goal };
            self.grounds.push(StaticMap::new(self.instance, self.settings.mode, vehicle).map_err(blocked)?);
        }
        // Starts and goals apart: a start may be another's goal.
        for is_goal in [false, true] {
            let ends = vehicles.iter().map(|vehicle| if is_goal { vehicle.goal } else { vehicle.start });
            let ends: Vec<Pose> = ends.collect();
            self.traffic.make_room_for(&ends);
            // A copy, as routes are added only for this test.
            let mut traffic = self.traffic.clone();
            for (index, (vehicle, &start)) in vehicles.iter().zip(&ends).enumerate() {
                let standing = Route { start, steps: Vec::new() };
                let mut touched = None;
                traffic.for_each_conflict_of(&standing, |other| touched = touched.or(Some(other)));
                if let Some(other) = touched {
                    let vehicles = [vehicles[other].name.clone(), vehicle.name.clone()];
                    return Err(Unsolved::Crowded { vehicles, is_goal });
                }
                traffic.insert(index, &standing);
            }
        }
        Ok(())
    }

    fn min_m(&self, vehicle: usize) -> f64 {
        self.drives[vehicle].first().map_or(0.0, |drive| drive.length_m)
    }

    fn pairs(&self) -> usize {
        self.conflicts.iter().map(Vec::len).sum::<usize>() / 2
    }

    fn metres(&self, vehicles: &[usize]) -> f64 {
        vehicles.iter().filter_map(|&vehicle| self.routes[vehicle].as_ref()).map(Route::flowtime_m).sum()
    }

    /// Takes the routes of some vehicles away and plans them again, one after the other.
    fn replan(&mut self, vehicles: &[usize], care: SearchBudget) -> Result<(), Unsolved> {
        for &vehicle in vehicles {
            self.set_route(vehicle, None);
        }
        for &vehicle in vehicles {
            self.continue_unless_stopped()?;
            let route = self.plan_one(vehicle, care);
            self.set_route(vehicle, Some(route));
        }
        Ok(())
    }

    fn set_route(&mut self, vehicle: usize, route: Option<Route>) {
        // Conflicts are kept on both sides, so both change.
        for other in std::mem::take(&mut self.conflicts[vehicle]) {
            self.conflicts[other].retain(|&index| index != vehicle);
        }
        // Before the new route is tested: it must not conflict with the old one.
        self.traffic.remove(vehicle);
        if let Some(route) = &route {
            let met = &mut self.conflicts[vehicle];
            self.traffic.for_each_conflict_of(route, |other| {
                if let Err(place) = met.binary_search(&other) {
                    met.insert(place, other);
                }
            });
            for other in met.clone() {
                let theirs = &mut self.conflicts[other];
                let place = theirs.partition_point(|&index| index < vehicle);
                theirs.insert(place, vehicle);
            }
            self.traffic.insert(vehicle, route);
        }
        self.routes[vehicle] = route;
    }

    fn plan_one(&mut self, vehicle: usize, care: SearchBudget) -> Route {
        let spec = &self.instance.vehicles[vehicle];
        let at_goal = self.traffic.conflicts_of_standing(spec.goal);
        let may_wait_at_start = self.grounds[vehicle].allows(&Motion::standing(spec.start));
        let others = Others { traffic: &self.traffic, at_goal, may_wait_at_start, penalty_m: care.penalty_m };
        let mut best_m = f64::INFINITY;
        let mut best = None;
        for drive in &self.drives[vehicle] {
            // Drives are in order of length, and waiting only adds to it.
            if drive.length_m >= best_m {
                break;
            }
            if let Some(found) = wait_along(drive, &others, best_m) {
                (best_m, best) = (found.price_m, Some(found.route));
            }
        }
        let min_m = self.min_m(vehicle);
        // Within rounding of the shortest drive nothing is left to gain.
        if best_m > min_m + 0.05 {
            // What only waits costs little, and a search for less ends early.
            let expansions = if best_m < min_m + care.penalty_m { care.expansions / 4 } else { care.expansions };
            let query = Query {
                ground: &self.grounds[vehicle],
                vehicle: spec,
                others: Some(&others),
                bound_m: best_m,
                expansions,
            };
            if let Some(found) = self.search.find(&query, self.is_stopped) {
                let drive = shortened(&self.grounds[vehicle], found.route.clone(), self.is_stopped);
                // Shortening disregards the others, so it counts only if waits make it cheaper.
                let shorter = wait_along(&drive, &others, found.price_m);
                best = Some(shorter.map_or(found.route, |shorter| shorter.route));
                keep(&mut self.drives[vehicle], drive);
            }
        }
        best.unwrap_or_else(|| Route { start: spec.start, steps: Vec::new() })
    }

    /// Plans in one order after the other until nobody conflicts.
    fn try_orders(&mut self, mut order: Vec<usize>) -> Result<(), Unsolved> {
        let mut min = usize::MAX;
        for round in 0..self.settings.rounds.div_ceil(10) {
            self.rounds = round;
            self.replan(&order, SearchBudget { penalty_m: FORBIDDEN_M, expansions: 2000 })?;
            if self.pairs() == 0 {
                return Ok(());
            }
            min = min.min(self.pairs());
            order.shuffle(&mut self.random);
        }
        Err(Unsolved::Conflicts { pairs: min })
    }

    fn repair(&mut self) -> Result<(), Unsolved> {
        let mut since_progress = 0;
        while self.pairs() > 0 {
            if self.rounds == self.settings.rounds {
                return Err(Unsolved::Conflicts { pairs: self.pairs() });
            }
            self.rounds += 1;
            let in_conflict: Vec<usize> =
                (0..self.routes.len()).filter(|&vehicle| !self.conflicts[vehicle].is_empty()).collect();
            // At random: a fixed choice would try the same group again and again.
            let seed = in_conflict[self.random.random_range(0..in_conflict.len())];
            let group = self.group_around(seed);
            let before = self.pairs();
            // The longer without progress, the dearer conflicts and the larger the searches.
            let stuck = f64::from(since_progress / 10);
            let care =
                SearchBudget { penalty_m: PENALTY_M * (1.0 + stuck), expansions: 2000 * (1 + since_progress / 20) };
            // As many conflicts as before are accepted, so that a search can leave a plateau.
            self.try_again(group, care, |team, _| team.pairs() <= before)?;
            since_progress = if self.pairs() < before { 0 } else { since_progress + 1 };
        }
        Ok(())
    }

    /// Makes routes cheaper: those that are farthest from their shortest drives, with those in their way.
    fn polish(&mut self) -> Result<(), Unsolved> {
        let vehicles = self.routes.len();
        for _ in 0..self.settings.polish as usize * vehicles {
            // Vehicles are drawn by what they could save.
            let excess: Vec<f64> =
                (0..vehicles).map(|vehicle| (self.metres(&[vehicle]) - self.min_m(vehicle) - 0.05).max(0.0)).collect();
            let sum: f64 = excess.iter().sum();
            if sum <= 0.0 {
                break;
            }
            let mut drawn = self.random.random_range(0.0..sum);
            let seed = excess.iter().position(|&share| {
                drawn -= share;
                drawn < 0.0
            });
            let group = self.group_around(seed.unwrap_or(0));
            // From here on routes are free, and stay so.
            let care = SearchBudget { penalty_m: FORBIDDEN_M, expansions: 1000 };
            self.try_again(group, care, |team, saved_m| team.pairs() == 0 && saved_m > 1e-6)?;
        }
        Ok(())
    }

    /// Plans a group again in a random order, and takes it back unless it is accepted, given the metres that it saves.
    fn try_again(
        &mut self,
        mut group: Vec<usize>,
        care: SearchBudget,
        is_accepted: impl Fn(&Self, f64) -> bool,
    ) -> Result<(), Unsolved> {
        // The order decides who makes way; another one may find what the last did not.
        group.shuffle(&mut self.random);
        let before_m = self.metres(&group);
        let kept: Vec<Option<Route>> = group.iter().map(|&vehicle| self.routes[vehicle].clone()).collect();
        let planned = self.replan(&group, care);
        if planned.is_err() || !is_accepted(self, before_m - self.metres(&group)) {
            // All are taken out first: half of the old routes would conflict with half of the new.
            for &vehicle in &group {
                self.set_route(vehicle, None);
            }
            for (&vehicle, route) in group.iter().zip(kept) {
                self.set_route(vehicle, route);
            }
        }
        planned
    }

    /// Chooses vehicles to plan again with one: those that conflict with it, those on its shortest drive, and some beside it.
    fn group_around(&mut self, seed: usize) -> Vec<usize> {
        // Small groups are quick, large ones can untangle more.
        let max = self.random.random_range(2..=8).min(self.routes.len());
        let mut group = vec![seed];
        let mut near = self.conflicts[seed].clone();
        // Vehicles in the way of its shortest drive keep it from driving that.
        if let Some(drive) = self.drives[seed].first() {
            let route = drive.route();
            self.traffic.for_each_conflict_of(&route, |other| near.push(other));
        }
        near.shuffle(&mut self.random);
        for other in near {
            if group.len() < max && !group.contains(&other) {
                group.push(other);
            }
        }
        let mut tries = 0;
        // Bounded, as all that are in conflict may be in the group already.
        while group.len() < max && tries < 16 {
            tries += 1;
            let member = group[self.random.random_range(0..group.len())];
            let next = match &self.conflicts[member][..] {
                [] => self.random.random_range(0..self.routes.len()),
                theirs => theirs[self.random.random_range(0..theirs.len())],
            };
            if !group.contains(&next) {
                group.push(next);
            }
        }
        group
    }
}
