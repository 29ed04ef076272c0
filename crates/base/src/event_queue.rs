//! A queue of future events, ordered by (time, rank, sequence).
//!
//! Rank says what happens first at one instant; sequence is the order of insertion, so equal events keep it.

use std::collections::BTreeMap;

use crate::time::SimTime;

/// Events of type `E`, whose rank of type `R` orders those of one instant.
#[derive(Clone, Debug)]
pub struct EventQueue<R, E> {
    events: BTreeMap<(SimTime, R, u64), E>,
    next_sequence: u64,
}

impl<R: Ord, E> Default for EventQueue<R, E> {
    fn default() -> Self {
        Self { events: BTreeMap::new(), next_sequence: 0 }
    }
}

impl<R: Ord + Copy, E> EventQueue<R, E> {
    pub fn push(&mut self, time: SimTime, rank: R, event: E) {
        self.events.insert((time, rank, self.next_sequence), event);
        self.next_sequence += 1;
    }

    /// Iterates over all events, in their order.
    pub fn events_mut(&mut self) -> impl Iterator<Item = &mut E> {
        self.events.values_mut()
    }

    /// Returns time and rank of the event that comes next.
    pub fn peek(&self) -> Option<(SimTime, R)> {
        self.events.keys().next().map(|&(time, rank, _)| (time, rank))
    }

    /// Iterates over the events that are due at `time` with this rank, if nothing comes before them.
    pub fn due(&self, time: SimTime, rank: R) -> impl Iterator<Item = &E> {
        let due = self.events.iter().take_while(move |(at, _)| (at.0, at.1) == (time, rank));
        due.map(|(_, event)| event)
    }

    /// Takes the next event if it is due at `time` with this rank.
    pub fn pop_due(&mut self, time: SimTime, rank: R) -> Option<E> {
        let next = self.events.first_entry()?;
        let &(due, its_rank, _) = next.key();
        ((due, its_rank) == (time, rank)).then(|| next.remove())
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
        assert_eq!(queue.peek(), None);
    }

    #[test]
    fn what_is_due_can_be_looked_at_unless_something_comes_first() {
        let now = SimTime::from_nanos(3);
        let mut queue = EventQueue::default();
        for (rank, name) in [(1, 'a'), (2, 'b'), (1, 'c')] {
            queue.push(now, rank, name);
        }
        assert_eq!(queue.due(now, 1).collect::<String>(), "ac");
        assert_eq!(queue.due(now, 2).collect::<String>(), "");
    }
}
