//! An auction of fires with deadlines: routes of several fires, built one fire at a time.
//!
//! Every truck has a route, which is empty at first. In each round every truck bids for the fire, and the place for it in its
//! route, that gains most; the best bid of all wins. No insertion may make a truck late for what it has won before. That is
//! the sequential greedy auction, whose allocation the consensus-based bundle algorithm reaches by messages (Choi, Brunet
//! and How, "Consensus-based decentralized auctions for robust task allocation", IEEE T-RO 25(4), 2009); with deadlines as in
//! Johnson, "Planning and control of heterogeneous agents" (MIT, 2012); the test of an insertion by slack is Savelsbergh's
//! ("The vehicle routing problem with time windows: minimizing route duration", ORSA J. on Computing 4(2), 1992).
//!
//! Trucks that cannot be given another goal bid too, from when they are free: what such a truck will do next is left to it.
//! Each decision auctions all anew; only the first fire of a route becomes a goal.

use glam::DVec2;

use super::hungarian::bushes_saved;
use super::open_fires::OpenFires;
use super::team::{Assignment, Team, TeamTruck};
use super::threat::threats;
use crate::geometry::Cell;
use crate::time::SimTime;
use crate::timeline::AgentId;

/// Fires in a route at most: by the time of a tenth all has changed.
const MOST_STOPS: usize = 10;

/// Fires near the start of a route, and near each stop in it, that a truck looks at.
const LOOKED_AT: usize = 8;

/// A goal that a truck already has counts as so much nearer in time, so that nobody turns back and forth between two that are
/// equally good.
const KEPT_S: f64 = 4.0;

/// Auctions all fires among all trucks.
#[derive(Clone, Copy, Debug)]
pub struct Auction;

impl Assignment for Auction {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        let open = OpenFires::new(team);
        let routes = routes(&open, effort);
        let goals = routes.iter().filter(|route| route.truck.is_asked).filter_map(|route| {
            let first = route.stops.first()?;
            Some((route.truck.id, open.fires[first.fire].cell))
        });
        goals.collect()
    }

    fn replans(&self) -> bool {
        true
    }
}

/// A fire on a route.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// Its number among those that are open.
    pub fire: usize,
    /// When it is out.
    pub out_at: SimTime,
    /// When it has to be out at the latest for what was counted on when it was won.
    due: SimTime,
}

/// What a truck is to do, in turn.
#[derive(Clone, Debug)]
pub struct Route<'a> {
    pub truck: &'a TeamTruck,
    pub stops: Vec<Stop>,
    /// What the truck bids for its route as it is, the best last.
    bids: Vec<Bid>,
}

/// The best place for a fire in a truck's route.
#[derive(Clone, Copy, Debug)]
struct Bid {
    bushes: u32,
    /// By how much the times at which the fires of the route are out grow together, its own included.
    cost_s: f64,
    fire: usize,
    at: usize,
}

impl Bid {
    /// Says whether this one is better: more bushes, then less time, then the smaller cell index.
    fn beats(&self, other: &Self) -> bool {
        let by_cost = other.cost_s.total_cmp(&self.cost_s);
        self.bushes.cmp(&other.bushes).then(by_cost).then(other.fire.cmp(&self.fire)).is_gt()
    }
}

/// Auctions the fires, and returns the routes of all trucks by number.
pub fn routes<'a>(open: &OpenFires<'a>, effort: &mut u64) -> Vec<Route<'a>> {
    let auctioneer = Auctioneer { open, threats: threats(open.team, &open.fires) };
    let mut won = vec![false; open.fires.len()];
    let trucks = open.team.trucks.iter();
    let mut routes: Vec<Route<'_>> = trucks.map(|truck| Route { truck, stops: Vec::new(), bids: Vec::new() }).collect();
    for route in &mut routes {
        route.bids = auctioneer.bids(route, &won, effort);
    }
    loop {
        let mut best: Option<(usize, Bid)> = None;
        for (number, route) in routes.iter_mut().enumerate() {
            // What others have won meanwhile is off the list; the rest of it stays as it was. A list that ends before the fires
            // do is drawn up anew.
            while route.bids.last().is_some_and(|bid| won[bid.fire]) {
                route.bids.pop();
                if route.bids.is_empty() {
                    route.bids = auctioneer.bids(route, &won, effort);
                }
            }
            if let Some(&bid) = route.bids.last()
                && best.is_none_or(|(_, best)| bid.beats(&best))
            {
                best = Some((number, bid));
            }
        }
        let Some((number, bid)) = best else { return routes };
        won[bid.fire] = true;
        auctioneer.insert(&mut routes[number], bid);
        routes[number].bids = auctioneer.bids(&routes[number], &won, effort);
    }
}

struct Auctioneer<'a> {
    open: &'a OpenFires<'a>,
    threats: Vec<u32>,
}

impl Auctioneer<'_> {
    /// Draws up a truck's bids for fires that nobody has won, the best last.
    fn bids(&self, route: &Route<'_>, won: &[bool], effort: &mut u64) -> Vec<Bid> {
        if route.stops.len() >= MOST_STOPS {
            return Vec::new();
        }
        let (team, truck) = (self.open.team, route.truck);
        let places = std::iter::once(truck.place).chain(route.stops.iter().map(|stop| self.open.fires[stop.fire].place));
        let mut near: Vec<usize> = Vec::new();
        for place in places {
            let is_free = |fire: usize| {
                !won[fire] && {
                    let drive = team.stop_time(truck.speed_mps, truck.place, self.open.fires[fire].place);
                    team.sets_out_at(truck) + drive <= team.due(&self.open.fires[fire])
                }
            };
            near.extend(self.open.index.nearest(place, LOOKED_AT, f64::INFINITY, is_free).into_iter().map(|(_, fire)| fire));
        }
        near.sort_unstable();
        near.dedup();
        let mut bids: Vec<Bid> = Vec::new();
        for fire in near {
            let mut best: Option<Bid> = None;
            for at in 0..=route.stops.len() {
                *effort += 1;
                let bid = self.bid(route, fire, at);
                if let Some(bid) = bid.filter(|bid| best.is_none_or(|best| bid.beats(&best))) {
                    best = Some(bid);
                }
            }
            bids.extend(best);
        }
        bids.sort_unstable_by(|a, b| if a.beats(b) { std::cmp::Ordering::Greater } else { std::cmp::Ordering::Less });
        bids
    }

    /// Reckons what a fire at a place in a route gains; `None` if it, or what comes after it, would be late.
    fn bid(&self, route: &Route<'_>, fire: usize, at: usize) -> Option<Bid> {
        let (team, truck) = (self.open.team, route.truck);
        let (from, departs) = self.before(route, at);
        let place = self.open.fires[fire].place;
        let out_at = departs + team.stop_time(truck.speed_mps, from, place);
        if out_at > team.due(&self.open.fires[fire]) {
            return None;
        }
        let mut delay_s = 0.0;
        if let Some(next) = route.stops.get(at) {
            let next_out_at = out_at + team.stop_time(truck.speed_mps, place, self.open.fires[next.fire].place);
            let delay = next_out_at.since(next.out_at);
            if route.stops[at..].iter().any(|stop| stop.out_at + delay > stop.due) {
                return None;
            }
            delay_s = delay.as_seconds() * (route.stops.len() - at) as f64;
        }
        let kept_s = if at == 0 && truck.goal == Some(self.open.fires[fire].cell) { KEPT_S } else { 0.0 };
        let cost_s = (out_at - team.now).as_seconds() + delay_s - kept_s;
        Some(Bid { bushes: bushes_saved(self.open, &self.threats, fire, out_at), cost_s, fire, at })
    }

    /// From where, and when, a truck sets out for a place in its route.
    fn before(&self, route: &Route<'_>, at: usize) -> (DVec2, SimTime) {
        match at.checked_sub(1).map(|before| route.stops[before]) {
            Some(stop) => (self.open.fires[stop.fire].place, stop.out_at),
            None => (route.truck.place, self.open.team.sets_out_at(route.truck)),
        }
    }

    fn insert(&self, route: &mut Route<'_>, bid: Bid) {
        let fire = &self.open.fires[bid.fire];
        route.stops.insert(bid.at, Stop { fire: bid.fire, out_at: SimTime::ZERO, due: self.open.team.due(fire) });
        for at in bid.at..route.stops.len() {
            let (from, departs) = self.before(route, at);
            let place = self.open.fires[route.stops[at].fire].place;
            route.stops[at].out_at = departs + self.open.team.stop_time(route.truck.speed_mps, from, place);
        }
        // Who has counted on stopping the fire before it spreads keeps counting on it.
        let stop = &mut route.stops[bid.at];
        if bid.bushes > 1 {
            stop.due = stop.due.min(fire.spreads_at);
        }
    }
}
