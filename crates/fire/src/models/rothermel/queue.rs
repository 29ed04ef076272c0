//! The cells that fire is expected at, in order of (time, cell).
//!
//! A timing wheel of several levels (Varghese and Lauck, "Hashed and hierarchical timing wheels", 1987): buckets of
//! about a millisecond, of 256 of them, and so on, and a heap for the bucket whose time has come. A cell goes through at
//! most one bucket of each level, so that the cost of a cell does not grow with the length of the front as that of one
//! heap does. Only cells are kept, as their times are kept by the owner; one that was put there again with an earlier or
//! a later time is recognised by it and left out.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Nanoseconds of the smallest buckets, as a power of two.
const TICK_BITS: u32 = 20;
/// Buckets of a level, as a power of two.
const LEVEL_BITS: u32 = 8;
const BUCKETS: usize = 1 << LEVEL_BITS;
/// Together a span of 2^52 ns, 52 days; what is later waits in one list.
const LEVELS: usize = 4;

/// The time of a cell that fire is not expected at.
pub const NEVER: u64 = u64::MAX;

#[derive(Clone, Debug)]
struct Level {
    buckets: Vec<Vec<u32>>,
    /// A bit for each bucket that has something in it.
    occupied: [u64; BUCKETS / 64],
}

impl Level {
    fn new() -> Self {
        Self { buckets: vec![Vec::new(); BUCKETS], occupied: [0; BUCKETS / 64] }
    }

    fn first_occupied(&self) -> Option<usize> {
        let word = self.occupied.iter().position(|&word| word != 0)?;
        Some(64 * word + self.occupied[word].trailing_zeros() as usize)
    }
}

/// Cells in order of their times.
#[derive(Clone, Debug)]
pub struct ArrivalQueue {
    /// The tick whose bucket is in the heap, with all that is earlier.
    tick: u64,
    due: BinaryHeap<Reverse<(u64, u32)>>,
    /// A level holds what shares all ticks' digits above its own with `tick`.
    levels: [Level; LEVELS],
    far: Vec<u32>,
}

impl Default for ArrivalQueue {
    fn default() -> Self {
        let levels = std::array::from_fn(|_| Level::new());
        Self { tick: 0, due: BinaryHeap::new(), levels, far: Vec::new() }
    }
}

impl ArrivalQueue {
    /// Adds a cell with its time, which is not [`NEVER`].
    #[inline]
    pub fn push(&mut self, time: u64, cell: u32) {
        let tick = time >> TICK_BITS;
        // What is due in the tick under way must not wait for the wheel to come round.
        if tick <= self.tick {
            self.due.push(Reverse((time, cell)));
            return;
        }
        // The highest bits that differ say how far off it is: farther buckets are wider.
        let level = ((63 - (tick ^ self.tick).leading_zeros()) / LEVEL_BITS) as usize;
        // Beyond the last level: sorted in when the wheels have turned that far.
        let Some(level_of_tick) = self.levels.get_mut(level) else {
            self.far.push(cell);
            return;
        };
        let bucket = (tick >> (level as u32 * LEVEL_BITS)) as usize % BUCKETS;
        level_of_tick.buckets[bucket].push(cell);
        level_of_tick.occupied[bucket / 64] |= 1 << (bucket % 64);
    }

    /// Returns the next cell and its time. `times` has the times of all cells, [`NEVER`] for those that are not awaited.
    pub fn peek(&mut self, times: impl Fn(u32) -> u64) -> Option<(u64, u32)> {
        loop {
            if let Some(&Reverse((time, cell))) = self.due.peek() {
                if times(cell) == time {
                    return Some((time, cell));
                }
                self.due.pop();
            } else if !self.advance(&times) {
                return None;
            }
        }
    }

    /// Takes the cell that was peeked at.
    #[inline]
    pub fn pop(&mut self) {
        self.due.pop();
    }

    /// Moves on to the next bucket with something in it. Returns false if there is none.
    fn advance(&mut self, times: &impl Fn(u32) -> u64) -> bool {
        let occupied = self.levels.iter().enumerate().find_map(|(level, of_it)| Some((level, of_it.first_occupied()?)));
        let Some((level, bucket)) = occupied else { return self.advance_far(times) };
        let shift = level as u32 * LEVEL_BITS;
        // The bits above stay, those of this level are the bucket's, those below begin at 0.
        let above = self.tick >> (shift + LEVEL_BITS) << LEVEL_BITS;
        self.tick = (above | bucket as u64) << shift;
        let current = &mut self.levels[level];
        current.occupied[bucket / 64] &= !(1 << (bucket % 64));
        let mut cells = std::mem::take(&mut current.buckets[bucket]);
        for cell in cells.drain(..) {
            let time = times(cell);
            // What has another time by now is in the bucket of that time too.
            if time >> TICK_BITS >> shift == self.tick >> shift {
                self.push(time, cell);
            }
        }
        if level == 0 {
            // Small buckets come round soon and need their memory again; large ones need not hold on to it.
            self.levels[0].buckets[bucket] = cells;
        }
        true
    }

    fn advance_far(&mut self, times: &impl Fn(u32) -> u64) -> bool {
        let cells = std::mem::take(&mut self.far);
        let awaited = cells.into_iter().map(|cell| (times(cell), cell)).filter(|&(time, _)| time != NEVER);
        let mut awaited: Vec<(u64, u32)> = awaited.collect();
        awaited.sort_unstable();
        // A cell that was planned several times is in the list as often.
        awaited.dedup();
        let Some(&(first, _)) = awaited.first() else { return false };
        self.tick = first >> TICK_BITS;
        for (time, cell) in awaited {
            self.push(time, cell);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use rand::RngExt;

    use super::*;

    #[test]
    fn cells_come_in_order_of_time_and_index_whatever_their_times_become() {
        let mut rng = wildfire_base::rng::stream(5, "arrival queue");
        for span in [100, 1 << 22, 1 << 34, 1 << 50, 1 << 58] {
            let mut times = [NEVER; 300];
            let mut queue = ArrivalQueue::default();
            let mut model = BTreeSet::new();
            let mut now = 0;
            for _ in 0..20_000 {
                if rng.random_bool(0.6) {
                    let cell = rng.random_range(0..300_u32);
                    let time = now + rng.random_range(0..span);
                    model.remove(&(times[cell as usize], cell));
                    model.insert((time, cell));
                    times[cell as usize] = time;
                    queue.push(time, cell);
                } else {
                    let next = queue.peek(|cell| times[cell as usize]);
                    assert_eq!(next, model.pop_first());
                    if let Some((time, cell)) = next {
                        queue.pop();
                        now = time;
                        times[cell as usize] = NEVER;
                    }
                }
            }
        }
    }
}
