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
//! Each decision auctions all again; only the first fire of a route becomes a goal. A route on which a tank runs dry leads to
//! the nearest water before it goes on.

use super::hungarian::bushes_saved;
use super::open_fires::OpenFires;
use super::team::{Assignment, RouteStart, Team, TeamTruck};
use super::threat::threats;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_timeline::AgentId;

/// Fires in a route at most: by the time of a tenth all has changed.
const MAX_STOPS: usize = 10;

/// Fires near the start of a route, and near each stop in it, that a truck looks at.
const EXAMINED: usize = 8;

/// A goal that a truck already has counts as so much nearer in time, so that nobody turns back and forth between two that are
/// equally good. Without it trucks turn round three times as often.
const KEPT_S: f64 = 8.0;

/// What it costs that a fire is out a second later, in seconds of a truck: little beside them, but of a truck that is free
/// and one that has to end something first, it lets the free one go.
const LATER_S: f64 = 0.1;

/// Auctions all fires among all trucks.
#[derive(Clone, Copy, Debug)]
pub struct Auction;

impl Assignment for Auction {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        let open = OpenFires::new(team);
        let routes = routes(&open, effort);
        let goals = routes.iter().filter(|route| route.truck.is_queried).filter_map(|route| {
            let first = route.stops.first()?;
            Some((route.truck.id, open.fires[first.fire].cell))
        });
        goals.collect()
    }

    fn replans(&self) -> bool {
        true
    }
}

/// A stop of a route: a fire.
#[derive(Clone, Copy, Debug)]
pub struct RouteStop {
    /// Its number among the open fires.
    pub fire: usize,
    /// The time at which it is extinguished.
    pub out_at: SimTime,
    /// When it has to be out at the latest for what was counted on when it was won.
    due: SimTime,
}

/// The stops of a truck, in order.
#[derive(Clone, Debug)]
pub struct TruckRoute<'a> {
    pub truck: &'a TeamTruck,
    pub stops: Vec<RouteStop>,
    /// What the truck bids for its route as it is, the best last.
    bids: Vec<Insertion>,
}

/// The best place for a fire in a truck's route.
#[derive(Clone, Copy, Debug)]
struct Insertion {
    bushes: u32,
    /// The time from setting out until the fire is out, the delay of what comes after it, and a little of the time from now
    /// until then. To count all of that time instead, and the delay of each stop that comes after, saves far less: trucks then
    /// cross the field for what lies on another's way. To leave the first part out where something comes after has trucks turn
    /// round three times as often.
    cost_s: f64,
    fire: usize,
    at: usize,
}

impl Insertion {
    /// Returns whether this one is better: more bushes, then less time, then the smaller cell index.
    fn beats(&self, other: &Self) -> bool {
        let by_cost = other.cost_s.total_cmp(&self.cost_s);
        self.bushes.cmp(&other.bushes).then(by_cost).then(other.fire.cmp(&self.fire)).is_gt()
    }
}

/// Auctions the fires and returns the routes of all trucks by number.
pub fn routes<'a>(open: &OpenFires<'a>, effort: &mut u64) -> Vec<TruckRoute<'a>> {
    let auctioneer = Auctioneer { open, threats: threats(open.team, &open.fires) };
    // By number, as fires are looked up for every bid.
    let mut won = vec![false; open.fires.len()];
    let trucks = open.team.trucks.iter();
    let mut routes: Vec<TruckRoute<'_>> =
        trucks.map(|truck| TruckRoute { truck, stops: Vec::new(), bids: Vec::new() }).collect();
    for route in &mut routes {
        route.bids = auctioneer.bids(route, &won, effort);
    }
    loop {
        let mut best: Option<(usize, Insertion)> = None;
        for (number, route) in routes.iter_mut().enumerate() {
            // What others have won meanwhile is off the list; the rest of it stays as it was. A list that ends before the fires
            // do is drawn up again.
            while route.bids.last().is_some_and(|bid| won[bid.fire]) {
                route.bids.pop();
                if route.bids.is_empty() {
                    route.bids = auctioneer.bids(route, &won, effort);
                }
            }
            if let Some(&bid) = route.bids.last()
                // The best is last in each list, so popping it is cheap.
                && best.is_none_or(|(_, best)| bid.beats(&best))
            {
                best = Some((number, bid));
            }
        }
        let Some((number, bid)) = best else { return routes };
        won[bid.fire] = true;
        auctioneer.insert(&mut routes[number], bid);
        // Only the winner's route has changed: other trucks' bids stay as they were.
        routes[number].bids = auctioneer.bids(&routes[number], &won, effort);
    }
}

struct Auctioneer<'a> {
    open: &'a OpenFires<'a>,
    threats: Vec<u32>,
}

impl Auctioneer<'_> {
    /// Draws up a truck's bids for fires that nobody has won, the best last.
    fn bids(&self, route: &TruckRoute<'_>, won: &[bool], effort: &mut u64) -> Vec<Insertion> {
        // Far ahead everything is a guess, and insertions grow with the square of the stops.
        if route.stops.len() >= MAX_STOPS {
            return Vec::new();
        }
        let (team, truck) = (self.open.team, route.truck);
        let places =
            std::iter::once(truck.place).chain(route.stops.iter().map(|stop| self.open.fires[stop.fire].place));
        // From where the truck is, and a little less far from later stops; what is out of its range would be refused below.
        let range_m = team.range_m(truck.speed_mps, self.open.last_due.since(team.sets_out_at(truck)));
        let mut near: Vec<usize> = Vec::new();
        for place in places {
            let is_free = |fire: usize| {
                !won[fire] && {
                    let drive = team.stop_time(truck.speed_mps, truck.place, self.open.fires[fire].place);
                    team.sets_out_at(truck) + drive <= team.due(&self.open.fires[fire])
                }
            };
            near.extend(self.open.index.nearest(place, EXAMINED, range_m, is_free).into_iter().map(|(_, fire)| fire));
        }
        // Fires are near more than one stop.
        near.sort_unstable();
        near.dedup();
        let mut bids: Vec<Insertion> = Vec::new();
        for fire in near {
            let mut best: Option<Insertion> = None;
            // All places of the route: a fire on the way to a later one costs little.
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
    fn bid(&self, route: &TruckRoute<'_>, fire: usize, at: usize) -> Option<Insertion> {
        let (team, truck) = (self.open.team, route.truck);
        let RouteStart { place: from, time: departs } = self.before(route, at);
        let place = self.open.fires[fire].place;
        let out_at = departs + team.stop_time(truck.speed_mps, from, place);
        // Too late itself; whether it makes later stops late costs more to find.
        if out_at > team.due(&self.open.fires[fire]) {
            return None;
        }
        let delay = self.delay_of_rest(route, at, RouteStart { place, time: out_at })?;
        // Keeps trucks from turning round for a gain within the estimates' error.
        let kept_s = if at == 0 && truck.goal == Some(self.open.fires[fire].cell) { KEPT_S } else { 0.0 };
        let bushes = bushes_saved(self.open, &self.threats, fire, out_at);
        let later_s = LATER_S * (out_at - team.now).as_seconds();
        Some(Insertion { bushes, cost_s: (out_at - departs + delay).as_seconds() + later_s - kept_s, fire, at })
    }

    /// Reckons by how much later the last stop of a route is over if another one, at this place and over at this time, comes
    /// in between; `None` if that makes the truck late for one of them.
    fn delay_of_rest(&self, route: &TruckRoute<'_>, at: usize, stop: RouteStart) -> Option<SimTime> {
        let (team, truck) = (self.open.team, route.truck);
        let mut delay = SimTime::ZERO;
        let mut start = stop;
        for (number, stop) in (at + 1..).zip(&route.stops[at..]) {
            // Without water to fetch the delay is the same for all later stops, so it need not be driven through.
            if team.water.is_none() && number > at + 1 {
                // What comes later is late by the same time.
                if stop.out_at + delay > stop.due {
                    return None;
                }
                continue;
            }
            let RouteStart { place: from, time: departs } = self.with_water(truck, number, start);
            let place = self.open.fires[stop.fire].place;
            start = RouteStart { place, time: departs + team.stop_time(truck.speed_mps, from, place) };
            if start.time > stop.due {
                return None;
            }
            delay = start.time.since(stop.out_at);
        }
        Some(delay)
    }

    /// From where, and when, a truck sets out for a place in its route.
    fn before(&self, route: &TruckRoute<'_>, at: usize) -> RouteStart {
        let from = match at.checked_sub(1).map(|before| route.stops[before]) {
            Some(stop) => RouteStart { place: self.open.fires[stop.fire].place, time: stop.out_at },
            None => RouteStart { place: route.truck.place, time: self.open.team.sets_out_at(route.truck) },
        };
        self.with_water(route.truck, at, from)
    }

    /// From where, and when, a truck goes on to a stop of this number that comes from here, by way of water if its tank is
    /// empty by then.
    fn with_water(&self, truck: &TeamTruck, number: usize, from: RouteStart) -> RouteStart {
        let Some(water) = self.open.team.water else { return from };
        let left = truck.stops_left as usize;
        let full = water.full_tank as usize;
        let is_dry = number >= left && (number - left).is_multiple_of(full);
        if is_dry { self.open.team.refilled(truck.speed_mps, from.place, from.time, 0) } else { from }
    }

    fn insert(&self, route: &mut TruckRoute<'_>, bid: Insertion) {
        let fire = &self.open.fires[bid.fire];
        route.stops.insert(bid.at, RouteStop { fire: bid.fire, out_at: SimTime::ZERO, due: self.open.team.due(fire) });
        // Stops before it keep their times.
        for at in bid.at..route.stops.len() {
            let RouteStart { place: from, time: departs } = self.before(route, at);
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

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::samples::Sample;
    use super::*;
    use wildfire_timeline::WaterRules;

    /// The times at which the fires of a route are out, and the bushes that are saved; `None` if one is late.
    fn drive(open: &OpenFires<'_>, threats: &[u32], truck: &TeamTruck, fires: &[usize]) -> Option<(Vec<SimTime>, u32)> {
        let mut place = truck.place;
        let mut time = open.team.sets_out_at(truck);
        let (mut times, mut bushes) = (Vec::new(), 0);
        for &fire in fires {
            time += open.team.stop_time(truck.speed_mps, place, open.fires[fire].place);
            place = open.fires[fire].place;
            if time > open.team.due(&open.fires[fire]) {
                return None;
            }
            bushes += bushes_saved(open, threats, fire, time);
            times.push(time);
        }
        Some((times, bushes))
    }

    #[test]
    fn routes_are_driven_in_time_and_no_fire_is_on_two_of_them() {
        for seed in 0..60 {
            let sample = Sample::new(seed);
            let team = sample.team();
            let open = OpenFires::new(&team);
            let threats = threats(&team, &open.fires);
            let mut seen = Vec::new();
            for route in routes(&open, &mut 0) {
                let fires: Vec<usize> = route.stops.iter().map(|stop| stop.fire).collect();
                let (times, _) = drive(&open, &threats, route.truck, &fires).expect("nobody is late");
                assert_eq!(times, route.stops.iter().map(|stop| stop.out_at).collect::<Vec<_>>(), "seed {seed}");
                assert!(fires.iter().all(|fire| !seen.contains(fire)), "seed {seed}");
                seen.extend(fires);
            }
        }
    }

    /// The auction by its definition: in each round all fires at all places of all routes.
    fn by_definition(open: &OpenFires<'_>) -> Vec<Vec<usize>> {
        let auctioneer = Auctioneer { open, threats: threats(open.team, &open.fires) };
        let trucks = open.team.trucks.iter();
        let mut routes: Vec<TruckRoute<'_>> =
            trucks.map(|truck| TruckRoute { truck, stops: Vec::new(), bids: Vec::new() }).collect();
        loop {
            let free = |fire: &usize| routes.iter().all(|route| route.stops.iter().all(|stop| stop.fire != *fire));
            let mut best: Option<(usize, Insertion)> = None;
            for (number, route) in routes.iter().enumerate() {
                for fire in (0..open.fires.len()).filter(free) {
                    for at in 0..=route.stops.len() {
                        let bid = auctioneer.bid(route, fire, at);
                        if let Some(bid) = bid.filter(|bid| best.is_none_or(|(_, best)| bid.beats(&best))) {
                            best = Some((number, bid));
                        }
                    }
                }
            }
            let Some((number, bid)) = best else { break };
            auctioneer.insert(&mut routes[number], bid);
        }
        routes.iter().map(|route| route.stops.iter().map(|stop| stop.fire).collect()).collect()
    }

    #[test]
    fn lists_of_bids_lead_to_the_routes_of_a_search_through_all() {
        for seed in 0..60 {
            let sample = Sample::drawn(seed, 5, EXAMINED);
            let team = sample.team();
            let open = OpenFires::new(&team);
            let found: Vec<Vec<usize>> =
                routes(&open, &mut 0).iter().map(|route| route.stops.iter().map(|stop| stop.fire).collect()).collect();
            assert_eq!(found, by_definition(&open), "seed {seed}");
        }
    }

    /// The most bushes that the trucks can save, by trying all routes.
    fn max_saved(
        open: &OpenFires<'_>,
        threats: &[u32],
        trucks: &[TeamTruck],
        taken: &mut Vec<usize>,
        count: usize,
    ) -> u32 {
        let Some((truck, others)) = trucks.split_first() else { return 0 };
        // The last `count` of what is taken is this truck's route.
        let Some((_, saved)) = drive(open, threats, truck, &taken[taken.len() - count..]) else { return 0 };
        let mut max = saved + max_saved(open, threats, others, taken, 0);
        for fire in 0..open.fires.len() {
            if !taken.contains(&fire) {
                taken.push(fire);
                max = max.max(max_saved(open, threats, trucks, taken, count + 1));
                taken.pop();
            }
        }
        max
    }

    #[test]
    fn an_auction_saves_nearly_what_the_best_routes_save() {
        let (mut saved, mut max) = (0, 0);
        for seed in 0..60 {
            let sample = Sample::drawn(seed, 2, 5);
            let team = sample.team();
            let open = OpenFires::new(&team);
            let threats = threats(&team, &open.fires);
            let of_auction: u32 = routes(&open, &mut 0)
                .iter()
                .map(|route| {
                    let fires: Vec<usize> = route.stops.iter().map(|stop| stop.fire).collect();
                    drive(&open, &threats, route.truck, &fires).expect("nobody is late").1
                })
                .sum();
            let of_best = max_saved(&open, &threats, &team.trucks, &mut Vec::new(), 0);
            assert!(of_auction <= of_best, "seed {seed}: {of_auction} bushes, {of_best} at most");
            saved += of_auction;
            max += of_best;
        }
        assert!(saved * 20 >= max * 19, "{saved} of {max}");
    }

    #[test]
    fn a_tank_that_runs_dry_is_filled_on_the_way() {
        let drive = |stops_left: u32| {
            let mut sample = Sample::with_trucks(&[(20.0, 52.5)]);
            sample.trucks[0].stops_left = stops_left;
            for col in [10, 15, 20] {
                sample.burn((col, 10));
            }
            let fill_per_stop = SimTime::from_seconds(2.0);
            let places = vec![DVec2::new(80.0, 62.5)];
            sample.water = Some(WaterRules { full_tank: 2, fill_per_stop, reach_m: 10.0, places, energy: None });
            let team = sample.team();
            let open = OpenFires::new(&team);
            let stops = routes(&open, &mut 0).remove(0).stops;
            stops.iter().map(|stop| (stop.fire, stop.out_at.as_seconds())).collect::<Vec<_>>()
        };
        // 22.5 m to within reach of the first fire, 15 m to the next ones; 4 s to fill a tank.
        let to_first = 1.12 * 22.5 / 8.0 + 5.0;
        let from_water = |col: f64| 1.12 * (DVec2::new(80.0 - col, 10.0).length() - 10.0) / 8.0 + 5.0;
        let to_water = |col: f64| 1.12 * (DVec2::new(80.0 - col, 10.0).length() - 10.0) / 8.0 + 4.0;
        let assert_near = |found: &[(usize, f64)], times: [f64; 3]| {
            assert_eq!(found.iter().map(|(fire, _)| *fire).collect::<Vec<_>>(), [0, 1, 2]);
            for ((_, found), time) in found.iter().zip(times) {
                assert!((found - time).abs() < 1e-6, "{found} s instead of {time} s");
            }
        };
        let next = 1.12 * 15.0 / 8.0 + 5.0;
        let second = to_first + next;
        assert_near(&drive(9), [to_first, second, second + next]);
        assert_near(&drive(2), [to_first, second, second + to_water(77.5) + from_water(102.5)]);
        let after = to_first + to_water(52.5) + from_water(77.5);
        assert_near(&drive(1), [to_first, after, after + next]);
    }

    #[test]
    fn nobody_turns_round_for_a_fire_that_is_hardly_nearer() {
        let mut sample = Sample::with_trucks(&[(100.0, 102.5)]);
        sample.burn((10, 20));
        sample.burn((30, 20));
        let goal = |sample: &Sample| Auction.assign(&sample.team(), &mut 0)[0].1;
        sample.trucks[0].place.x += 5.0;
        sample.trucks[0].goal = Some((10, 20).into());
        assert_eq!(goal(&sample), (10, 20).into());
        sample.trucks[0].place.x += 30.0;
        assert_eq!(goal(&sample), (30, 20).into());
    }

    #[test]
    fn what_a_truck_does_next_that_stands_at_a_fire_is_left_to_it() {
        let mut sample = Sample::with_trucks(&[(55.0, 52.5), (80.0, 52.5)]);
        sample.burn((12, 10));
        let goals = |sample: &Sample| Auction.assign(&sample.team(), &mut 0);
        assert_eq!(goals(&sample), [(AgentId::unimog(0), (12, 10).into())]);
        sample.trucks[0].is_queried = false;
        sample.trucks[0].free_at = SimTime::from_seconds(2.0);
        assert_eq!(goals(&sample), []);
        sample.trucks[0].free_at = SimTime::from_seconds(30.0);
        assert_eq!(goals(&sample), [(AgentId::unimog(1), (12, 10).into())]);
    }
}
