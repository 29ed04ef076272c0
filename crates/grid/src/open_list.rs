//! The open list of a best-first search, with deliberate tie-breaking.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// An entry of an open list.
pub trait Ranked {
    type Tie: Ord;

    /// Estimated cost of the whole way; the smallest comes first.
    fn priority(&self) -> f64;

    /// Cost so far; of equal priorities the largest comes first, because it is nearer to the goal.
    fn cost(&self) -> f64;

    /// Decides between equals, the smallest first.
    fn tie(&self) -> Self::Tie;
}

/// A priority queue that returns the best entry first.
#[derive(Debug)]
pub struct OpenList<T>(BinaryHeap<BestFirst<T>>);

impl<T: Ranked> Default for OpenList<T> {
    fn default() -> Self {
        Self(BinaryHeap::new())
    }
}

impl<T: Ranked> OpenList<T> {
    pub fn push(&mut self, entry: T) {
        self.0.push(BestFirst(entry));
    }

    pub fn pop(&mut self) -> Option<T> {
        self.0.pop().map(|BestFirst(entry)| entry)
    }

    /// Returns whether an entry that is not in the list comes before all that are.
    pub fn is_next(&self, entry: &T) -> bool {
        self.0.peek().is_none_or(|BestFirst(first)| best_first(entry, first).is_gt())
    }

    /// Returns the number of entries.
    pub fn waiting(&self) -> usize {
        self.0.len()
    }

    /// Returns the number of entries that fit without another allocation.
    pub fn capacity(&self) -> usize {
        self.0.capacity()
    }

    /// Removes all entries and keeps their memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

impl<T: Ranked> Extend<T> for OpenList<T> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, entries: I) {
        entries.into_iter().for_each(|entry| self.push(entry));
    }
}

/// The greatest is what a max-heap hands out first.
#[derive(Debug)]
struct BestFirst<T>(T);

impl<T: Ranked> Ord for BestFirst<T> {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        best_first(&self.0, &other.0)
    }
}

/// Compares entries; the greater comes first.
#[inline]
fn best_first<T: Ranked>(a: &T, b: &T) -> Ordering {
    let by_priority = b.priority().total_cmp(&a.priority());
    by_priority.then_with(|| a.cost().total_cmp(&b.cost())).then_with(|| b.tie().cmp(&a.tie()))
}

impl<T: Ranked> PartialOrd for BestFirst<T> {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }

    /// What heaps ask for. Priorities mostly differ, and then one comparison of numbers is enough.
    #[inline]
    fn le(&self, other: &Self) -> bool {
        let priority = self.0.priority();
        let of_other = other.0.priority();
        if priority > of_other {
            return true;
        }
        if priority < of_other {
            return false;
        }
        self.cmp(other).is_le()
    }
}

impl<T: Ranked> PartialEq for BestFirst<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<T: Ranked> Eq for BestFirst<T> {}

#[cfg(test)]
mod tests {
    use super::*;

    impl Ranked for (f64, f64, u32) {
        type Tie = u32;

        fn priority(&self) -> f64 {
            self.0
        }

        fn cost(&self) -> f64 {
            self.1
        }

        fn tie(&self) -> u32 {
            self.2
        }
    }

    #[test]
    fn the_best_comes_first_then_the_deepest_then_the_smallest_number() {
        let mut open = OpenList::default();
        let order = [(1.0, 0.0, 9), (2.0, 5.0, 1), (2.0, 5.0, 4), (2.0, 3.0, 0), (7.0, 9.0, 2)];
        for index in [3, 1, 4, 0, 2] {
            open.push(order[index]);
        }
        assert!(open.is_next(&(1.0, 0.0, 8)) && open.is_next(&(1.0, 0.5, 10)) && !open.is_next(&(1.0, 0.0, 10)));
        let popped: Vec<_> = std::iter::from_fn(|| open.pop()).collect();
        assert_eq!(popped, order);
        assert!(open.is_next(&(7.0, 0.0, 0)));
    }

    #[test]
    fn entries_come_in_the_order_of_a_sort_whatever_their_numbers() {
        let priorities = [f64::NAN, f64::INFINITY, -0.0, 0.0, 1.5, 1.5, -2.0, f64::NEG_INFINITY, f64::MIN_POSITIVE];
        let mut entries = Vec::new();
        for number in 0..400_u32 {
            let priority = priorities[(number * 7 % 9) as usize];
            entries.push((priority, f64::from(number * 5 % 11), number * 31 % 400));
        }
        let mut open = OpenList::default();
        entries.iter().for_each(|&entry| open.push(entry));
        entries.sort_by(|a, b| best_first(b, a));
        for entry in entries {
            // Compared in their order, as nothing equals what is not a number.
            assert!(open.pop().is_some_and(|popped| best_first(&popped, &entry).is_eq()), "{entry:?}");
        }
    }
}
