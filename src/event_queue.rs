//! A queue of future events, ordered by (time, rank, sequence).
//!
//! Rank says what happens first at one instant; sequence is the order of insertion, so equal events keep it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::time::SimTime;

/// Events of type `E`, whose rank of type `R` orders those of one instant.
#[derive(Debug)]
pub struct EventQueue<R, E> {
    heap: BinaryHeap<Reverse<Entry<R, E>>>,
    next_sequence: u64,
}

#[derive(Debug)]
struct Entry<R, E> {
    time: SimTime,
    rank: R,
    sequence: u64,
    event: E,
}

impl<R: Ord, E> PartialEq for Entry<R, E> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<R: Ord, E> Eq for Entry<R, E> {}

impl<R: Ord, E> PartialOrd for Entry<R, E> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<R: Ord, E> Ord for Entry<R, E> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.time, &self.rank, self.sequence).cmp(&(other.time, &other.rank, other.sequence))
    }
}

impl<R: Ord, E> Default for EventQueue<R, E> {
    fn default() -> Self {
        Self { heap: BinaryHeap::new(), next_sequence: 0 }
    }
}

impl<R: Ord + Copy, E> EventQueue<R, E> {
    pub fn push(&mut self, time: SimTime, rank: R, event: E) {
        let sequence = self.next_sequence;
        self.next_sequence += 1;
        self.heap.push(Reverse(Entry { time, rank, sequence, event }));
    }

    /// Time and rank of the event that comes next.
    pub fn peek(&self) -> Option<(SimTime, R)> {
        self.heap.peek().map(|Reverse(entry)| (entry.time, entry.rank))
    }

    /// Takes the next event if it is due at `time` with this rank.
    pub fn pop_due(&mut self, time: SimTime, rank: R) -> Option<E> {
        if self.peek() != Some((time, rank)) {
            return None;
        }
        self.heap.pop().map(|Reverse(entry)| entry.event)
    }

    pub fn is_empty(&self) -> bool {
        self.heap.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_come_by_time_then_rank_then_insertion() {
        let at = SimTime::from_nanos;
        let mut queue = EventQueue::default();
        for (time, rank, name) in [(5, 1, 'd'), (3, 2, 'b'), (5, 0, 'c'), (3, 1, 'a'), (5, 1, 'e')] {
            queue.push(at(time), rank, name);
        }
        let mut order = String::new();
        while let Some((time, rank)) = queue.peek() {
            order.push(queue.pop_due(time, rank).expect("it was just seen"));
        }
        assert_eq!(order, "abcde");
    }

    #[test]
    fn only_what_is_due_is_taken() {
        let mut queue = EventQueue::default();
        queue.push(SimTime::from_nanos(3), 1, ());
        assert_eq!(queue.pop_due(SimTime::from_nanos(2), 1), None);
        assert_eq!(queue.pop_due(SimTime::from_nanos(3), 0), None);
        assert_eq!(queue.pop_due(SimTime::from_nanos(3), 1), Some(()));
        assert!(queue.is_empty());
    }
}
