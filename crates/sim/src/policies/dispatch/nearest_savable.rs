//! The nearest fire that can still be saved.
//!
//! Of all pairs of a free truck and a fire that it puts out in time, the one that is out first is taken, then the next
//! among the rest: the greedy algorithm of multi-robot task assignment (Gerkey and Mataric, "A formal analysis and
//! taxonomy of task allocation in multi-robot systems", IJRR 23(9), 2004, section 5.1), with deadlines. Nobody is first by
//! number, and nobody drives to ashes.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::open_fires::{OpenFires, SavableFire};
use super::team::{Assignment, Team};
use wildfire_base::geometry::Cell;
use wildfire_timeline::AgentId;

/// Assigns the pair that extinguishes a fire first; the rest of the team takes what is left.
#[derive(Clone, Copy, Debug)]
pub struct NearestSavable;

impl Assignment for NearestSavable {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        let open = OpenFires::new(team);
        let queried: Vec<usize> = (0..team.trucks.len()).filter(|&truck| team.trucks[truck].is_queried).collect();
        let goals = nearest_first(&open, &queried, &mut vec![false; open.fires.len()], effort);
        goals.into_iter().map(|(truck, fire)| (team.trucks[truck].id, open.fires[fire].cell)).collect()
    }

    fn replans(&self) -> bool {
        false
    }
}

/// Pairs trucks with fires that are not taken, always the pair that extinguishes its fire first, and takes these fires.
/// Both are numbers, of the team's trucks and of open fires; pairs come by truck. Ties go to the nearer fire, then to
/// the smaller cell index, then to the smaller number of the truck.
pub fn nearest_first(
    open: &OpenFires<'_>,
    trucks: &[usize],
    taken: &mut [bool],
    effort: &mut u64,
) -> Vec<(usize, usize)> {
    let mut best_of = |truck: usize, taken: &[bool]| {
        let best = open.nearest_savable(&open.team.trucks[truck], 1, |fire| {
            *effort += 1;
            !taken[fire]
        });
        best.first().map(|&prospect| Reverse(Bid { prospect, truck }))
    };
    // Of each truck its best fire is in the queue; it is looked for again only when another truck has taken that.
    let mut bids: BinaryHeap<Reverse<Bid>> = trucks.iter().filter_map(|&truck| best_of(truck, taken)).collect();
    let mut pairs = Vec::new();
    while let Some(Reverse(Bid { prospect, truck })) = bids.pop() {
        if taken[prospect.fire] {
            bids.extend(best_of(truck, taken));
        } else {
            taken[prospect.fire] = true;
            pairs.push((truck, prospect.fire));
        }
    }
    // By truck, whatever order they won in.
    pairs.sort_unstable();
    pairs
}

/// A truck and the best fire for it.
#[derive(Clone, Copy, Debug)]
struct Bid {
    prospect: SavableFire,
    truck: usize,
}

impl Ord for Bid {
    fn cmp(&self, other: &Self) -> Ordering {
        let (one, two) = (&self.prospect, &other.prospect);
        let by_time = one.out_at.cmp(&two.out_at).then(one.metres.total_cmp(&two.metres));
        by_time.then(one.fire.cmp(&two.fire)).then(self.truck.cmp(&other.truck))
    }
}

impl PartialOrd for Bid {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Bid {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Bid {}

#[cfg(test)]
mod tests {
    use super::super::samples::Sample;
    use super::*;

    /// The same by looking at all pairs, again and again.
    fn brute_force(team: &Team<'_>) -> Vec<(AgentId, Cell)> {
        let open = OpenFires::new(team);
        let mut pairs: Vec<(AgentId, Cell)> = Vec::new();
        loop {
            let trucks = team.queried().filter(|truck| pairs.iter().all(|&(id, _)| id != truck.id));
            let bids = trucks.flat_map(|truck| {
                let free = (0..open.fires.len()).filter(|&fire| pairs.iter().all(|p| p.1 != open.fires[fire].cell));
                let open = &open;
                let number = usize::from(truck.id.number);
                free.filter_map(move |fire| Some(Bid { prospect: open.prospect(truck, fire)?, truck: number }))
            });
            let Some(best) = bids.min() else { break };
            pairs.push((team.trucks[best.truck].id, open.fires[best.prospect.fire].cell));
        }
        pairs.sort_unstable();
        pairs
    }

    #[test]
    fn pairs_are_those_of_a_search_through_all() {
        for seed in 0..60 {
            let sample = Sample::new(seed);
            let goals = NearestSavable.assign(&sample.team(), &mut 0);
            assert_eq!(goals, brute_force(&sample.team()), "seed {seed}");
        }
    }

    #[test]
    fn the_truck_that_is_nearer_goes_though_its_number_is_higher() {
        let mut sample = Sample::with_trucks(&[(100.0, 100.0), (30.0, 30.0)]);
        sample.burn((4, 4));
        let goals = NearestSavable.assign(&sample.team(), &mut 0);
        assert_eq!(goals, [(AgentId::unimog(1), (4, 4).into())]);
    }

    #[test]
    fn hopeless_fires_are_left_alone() {
        let mut sample = Sample::with_trucks(&[(245.0, 245.0)]);
        sample.burn((1, 1));
        assert_eq!(NearestSavable.assign(&sample.team(), &mut 0).len(), 1);
        // 336 m at 8 m/s, less the reach and by a crooked way, take 45.6 s, and the dwell 5 s.
        sample.now_s = 10.0;
        assert_eq!(NearestSavable.assign(&sample.team(), &mut 0), []);
    }
}
