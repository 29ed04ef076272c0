//! The closed set of searches over poses.

use std::f64::consts::{PI, TAU};

use wildfire_base::geometry::{FieldFrame, Pose};
use wildfire_base::ranges::OutOfRange;

/// The closed set of a search: the least cost known for every bin of (x, y, heading, driving direction).
///
/// A table with open addressing in place of an array over the field, so that its memory follows the search and not
/// the field. Clearing it is free: entries carry the generation they belong to.
#[derive(Debug)]
pub struct ClosedSet {
    bin_m: f64,
    headings: f64,
    slots: Vec<Slot>,
    generation: u32,
    used: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    key: u64,
    cost: f64,
    generation: u32,
}

/// Power of two, because a slot is found by the top bits of a product.
const FIRST_CAPACITY: usize = 1 << 10;
/// Odd, about 2^64 divided by the golden ratio: Knuth, "The Art of Computer Programming" 3, section 6.4.
const FIBONACCI: u64 = 0x9e37_79b9_7f4a_7c15;
// Two axes, the heading and a bit for the direction fill the 64 bits of a key.
const AXIS_BITS: u32 = 24;
const HEADING_BITS: u32 = 15;

impl ClosedSet {
    pub fn new(bin_m: f64, headings: u32) -> Self {
        let slots = vec![Slot::default(); FIRST_CAPACITY];
        Self { bin_m, headings: f64::from(headings), slots, generation: 1, used: 0 }
    }

    /// Returns the bytes in use while the table grows by `more` bins.
    pub fn bytes_after(&self, more: usize) -> usize {
        let doubles = 2 * (self.used + more) >= self.slots.len();
        // Both tables are there while the entries move.
        size_of::<Slot>() * self.slots.len() * if doubles { 3 } else { 1 }
    }

    pub fn clear(&mut self) {
        self.used = 0;
        self.generation = self.generation.wrapping_add(1);
        // After 2^32 searches the entries of the first would count as those of this one.
        if self.generation == 0 {
            self.slots.fill(Slot::default());
            self.generation = 1;
        }
    }

    /// Records a cost for the bin of a pose, unless the bin has one at least as good.
    pub fn improve(&mut self, pose: Pose, reverse: bool, cost: f64) -> bool {
        // Half full at most, so that probes stay short.
        if 2 * self.used >= self.slots.len() {
            self.grow();
        }
        let key = self.key(pose, reverse);
        let slot = find(&self.slots, self.generation, key);
        let slot = &mut self.slots[slot];
        // Left by an earlier search: nothing is cleared between searches.
        if slot.generation != self.generation {
            *slot = Slot { key, cost, generation: self.generation };
            self.used += 1;
            return true;
        }
        let better = cost < slot.cost;
        if better {
            slot.cost = cost;
        }
        better
    }

    /// Returns whether the bin of a pose has a cost at least as good.
    pub fn dominates(&self, pose: Pose, reverse: bool, cost: f64) -> bool {
        let slot = &self.slots[find(&self.slots, self.generation, self.key(pose, reverse))];
        slot.generation == self.generation && slot.cost <= cost
    }

    #[inline]
    fn key(&self, pose: Pose, reverse: bool) -> u64 {
        // A pose west or south of the field has negative numbers, which a cast to u64 alone would clamp to bin 0.
        let axis = |metres: f64| (metres / self.bin_m).floor() as i64 as u64 & ((1 << AXIS_BITS) - 1);
        let heading = ((pose.heading + PI) / TAU * self.headings) as u64 & ((1 << HEADING_BITS) - 1);
        ((axis(pose.x) << AXIS_BITS | axis(pose.y)) << HEADING_BITS | heading) << 1 | u64::from(reverse)
    }

    fn grow(&mut self) {
        let mut slots = vec![Slot::default(); 2 * self.slots.len()];
        for old in self.slots.iter().filter(|slot| slot.generation == self.generation) {
            let free = find(&slots, self.generation, old.key);
            slots[free] = *old;
        }
        self.slots = slots;
    }
}

/// The slot that holds a key, or the one where it belongs.
fn find(slots: &[Slot], generation: u32, key: u64) -> usize {
    let mask = slots.len() - 1;
    let mut index = (key.wrapping_mul(FIBONACCI) >> (64 - slots.len().trailing_zeros())) as usize;
    while slots[index].generation == generation && slots[index].key != key {
        index = (index + 1) & mask;
    }
    index
}

/// The most bins along a side of a field: their numbers have to fit into a key. The memory of a search follows what it
/// reaches, not the field, and is counted as it grows.
const MAX_BINS_A_SIDE: f64 = (1 << AXIS_BITS) as f64;

/// Checks the size of the bins that a scenario asks for.
///
/// # Errors
/// Refuses `bin_m` if a field of this size would have too many bins along a side.
pub fn check_bins(bin_m: f64, frame: &FieldFrame) -> Result<(), OutOfRange> {
    let bins = frame.width_m().max(frame.height_m()) / bin_m;
    if bins < MAX_BINS_A_SIDE {
        return Ok(());
    }
    let expected = format!("fewer than {MAX_BINS_A_SIDE} bins along a side of the field; it has {bins:.0}");
    Err(OutOfRange::new("bin_m", bin_m, expected))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    #[test]
    fn the_table_remembers_like_a_map() {
        let mut rng = rng::stream(1, "bins");
        let mut bins = ClosedSet::new(2.0, 24);
        for _ in 0..3 {
            bins.clear();
            let mut map = BTreeMap::new();
            for _ in 0..5_000 {
                let pose =
                    Pose::new(rng.random_range(0.0..90.0), rng.random_range(0.0..90.0), rng.random_range(-3.0..3.0));
                let reverse = rng.random_bool(0.5);
                let cost = rng.random_range(0.0..100.0);
                let best = map.entry(bins.key(pose, reverse)).or_insert(f64::INFINITY);
                assert_eq!(bins.dominates(pose, reverse, cost), *best <= cost);
                assert_eq!(bins.improve(pose, reverse, cost), cost < *best);
                *best = best.min(cost);
            }
            assert_eq!(bins.used, map.len());
        }
    }
}
