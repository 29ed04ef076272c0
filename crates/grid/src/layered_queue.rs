//! The open list of a search over lattice points: the order of [`OpenList`](super::open_list::OpenList) in less time.
//!
//! A best-first search takes out far fewer entries than it puts in, and those that it takes out next are much alike. So
//! entries lie unsorted in layers of priorities until it is their layer's turn (Dial, "Algorithm 360: Shortest-path forest
//! with topological ordering", Communications of the ACM 12(11), 1969). Then the layer is sorted, which takes less time
//! than a heap of it. What is put into the lowest layer after that goes to a heap, which stays small: most of it comes out
//! at once.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The most layers; all that lies higher is in the last.
const MAX_LAYERS: usize = 1 << 16;

/// An entry as numbers that compare as the entries do: the priority, the cost upside down, the index.
type Key = Reverse<(u64, u64, u32)>;

/// A point in the queue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waiting {
    /// The estimated cost of the whole path; the smallest comes first. Not negative.
    pub priority: f64,
    /// The cost so far; of equal priorities the largest comes first. Not negative.
    pub cost: f64,
    /// The tie-breaker, smallest first.
    pub index: u32,
}

impl Waiting {
    /// Numbers that are not negative compare as their bits do.
    fn key(self) -> Key {
        Reverse((self.priority.to_bits(), !self.cost.to_bits(), self.index))
    }

    fn from_key(Reverse((priority, cost, index)): Key) -> Self {
        Self { priority: f64::from_bits(priority), cost: f64::from_bits(!cost), index }
    }
}

/// A priority queue of points in layers of priorities.
#[derive(Debug)]
pub struct LayeredQueue {
    /// The height of a layer.
    height: f64,
    /// The number of the lowest layer that may have entries; what is put in below it goes to the heap too.
    lowest: usize,
    /// The entries that were in the lowest layer when its turn came, the best last.
    sorted: Vec<Key>,
    /// Those that were put into it since.
    heap: BinaryHeap<Key>,
    /// By layer; the lowest and those below it are empty.
    above: Vec<Vec<Key>>,
}

impl Default for LayeredQueue {
    fn default() -> Self {
        Self { height: 1.0, lowest: 0, sorted: Vec::new(), heap: BinaryHeap::new(), above: Vec::new() }
    }
}

impl LayeredQueue {
    /// Removes all entries and frees their memory, because the next search has other layers. Layers have this height
    /// from now on; it affects the time, not the order.
    pub fn clear(&mut self, height: f64) {
        self.sorted.clear();
        self.heap.clear();
        self.above.clear();
        self.lowest = 0;
        self.height = if height > 0.0 { height } else { 1.0 };
    }

    pub fn push(&mut self, entry: Waiting) {
        // Adding zero makes a negative zero an ordinary one. The cast ends at the greatest number.
        let entry = Waiting { priority: entry.priority + 0.0, cost: entry.cost + 0.0, ..entry };
        let layer = ((entry.priority / self.height) as usize).min(MAX_LAYERS - 1);
        if layer <= self.lowest {
            self.heap.push(entry.key());
            return;
        }
        if layer >= self.above.len() {
            self.above.resize_with(layer + 1, Vec::new);
        }
        self.above[layer].push(entry.key());
    }

    pub fn pop(&mut self) -> Option<Waiting> {
        while self.sorted.is_empty() && self.heap.is_empty() {
            let next = self.above.iter().skip(self.lowest + 1).position(|layer| !layer.is_empty())?;
            self.lowest += next + 1;
            // The memory goes with the entries: a search that goes on needs it elsewhere.
            self.sorted = std::mem::take(&mut self.above[self.lowest]);
            self.sorted.sort_unstable();
        }
        let is_sorted_better = match (self.sorted.last(), self.heap.peek()) {
            (Some(sorted), Some(since)) => sorted > since,
            (sorted, _) => sorted.is_some(),
        };
        let best = if is_sorted_better { self.sorted.pop() } else { self.heap.pop() };
        best.map(Waiting::from_key)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::open_list::{OpenList, Ranked};
    use wildfire_base::rng;

    impl Ranked for Waiting {
        type Tie = u32;

        fn priority(&self) -> f64 {
            self.priority
        }

        fn cost(&self) -> f64 {
            self.cost
        }

        fn tie(&self) -> u32 {
            self.index
        }
    }

    #[test]
    fn entries_come_in_the_order_of_an_open_list_whatever_the_height_of_layers() {
        let mut rng = rng::stream(1, "layered queue");
        let mut queue = LayeredQueue::default();
        for height in [1.0, 0.0, 1e-9, 0.3, 7.0, 1e9, f64::NAN] {
            queue.clear(height);
            let mut list = OpenList::default();
            let mut floor: f64 = 0.0;
            for _ in 0..20_000 {
                if rng.random_bool(0.6) {
                    // Mostly above what came out last, sometimes below it, and often equal to others.
                    let priority = (floor - 1.0).max(0.0) + f64::from(rng.random_range(0..40_u8)) * 0.25;
                    let cost = f64::from(rng.random_range(0..3_u8));
                    let entry = Waiting { priority, cost, index: rng.random_range(0..50) };
                    queue.push(entry);
                    list.push(entry);
                } else {
                    let popped = queue.pop();
                    assert_eq!(popped, list.pop());
                    floor = popped.map_or(floor, |entry| entry.priority);
                }
            }
            while let Some(expected) = list.pop() {
                assert_eq!(queue.pop(), Some(expected));
            }
            assert_eq!(queue.pop(), None);
        }
    }
}
