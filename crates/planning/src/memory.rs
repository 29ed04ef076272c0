//! Memory that grows during a run, counted against a limit before it is allocated.
//!
//! The memory of a search, a flood or a roadmap's curves is known only as they grow; a bound from the scenario alone
//! would be far above what nearly all runs take. Each holder of such memory asks its [`MemoryMeter`] before it grows,
//! and stops if the meter refuses. A planner's answer must not be used then: the owner of the meter asks
//! [`MemoryMeter::overrun`] and lets the run fail. So a limit decides whether a run takes place, and never how it goes.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use wildfire_grid::open_list::{OpenList, Ranked};

/// The kinds of memory that grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryKind {
    /// Nodes, open lists and closed sets of searches over poses.
    Searches,
    /// Floods over lattices of poses.
    Floods,
    /// Curves between milestones, which are computed when they are first needed.
    Curves,
    /// The record of the run's facts.
    Timeline,
}

wildfire_base::names! { MemoryKind {
    Searches: "searches", Floods: "floods", Curves: "curves of the roadmaps", Timeline: "the timeline",
} }

/// The memory that all holders of a kind have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReservedMemory {
    pub kind: MemoryKind,
    pub bytes: u64,
}

/// Counts the memory of everything that grows in one run, and refuses what exceeds the limit.
#[derive(Clone, Debug)]
pub struct MemoryMeter(Arc<Counters>);

#[derive(Debug)]
struct Counters {
    limit: u64,
    /// Bytes by kind, in the order of [`MemoryKind::ALL`].
    reserved: [AtomicU64; MemoryKind::ALL.len()],
    is_overrun: AtomicBool,
}

impl MemoryMeter {
    /// Creates a meter; `limit` is in bytes, for everything together.
    pub fn new(limit: u64) -> Self {
        Self(Arc::new(Counters { limit, reserved: Default::default(), is_overrun: AtomicBool::new(false) }))
    }

    /// Creates a meter that counts and never refuses.
    pub fn unlimited() -> Self {
        Self::new(u64::MAX)
    }

    /// Creates a holder that holds nothing yet.
    pub fn holder(&self, kind: MemoryKind) -> MemoryShare {
        MemoryShare { meter: self.clone(), kind, bytes: 0 }
    }

    /// Returns the sum of the bytes that are held.
    pub fn reserved(&self) -> u64 {
        MemoryKind::ALL.into_iter().map(|kind| self.reserved_by(kind)).sum()
    }

    fn reserved_by(&self, kind: MemoryKind) -> u64 {
        self.0.reserved[kind as usize].load(Ordering::Relaxed)
    }

    /// Returns the kind that holds the most if memory was refused to a holder.
    pub fn overrun(&self) -> Option<ReservedMemory> {
        let by_size = MemoryKind::ALL.into_iter().map(|kind| ReservedMemory { kind, bytes: self.reserved_by(kind) });
        self.0.is_overrun.load(Ordering::Relaxed).then(|| by_size.max_by_key(|reserved| reserved.bytes)).flatten()
    }
}

/// One holder's share of what a [`MemoryMeter`] counts. It is returned when the holder is dropped.
#[derive(Debug)]
pub struct MemoryShare {
    meter: MemoryMeter,
    kind: MemoryKind,
    bytes: u64,
}

impl MemoryShare {
    /// Requests this many bytes for the holder in place of what it held; returns whether they were granted, and counts
    /// them if so.
    ///
    /// Once a holder of the run was refused, none gets more.
    pub fn cover(&mut self, bytes: usize) -> bool {
        let bytes = bytes as u64;
        // A grant is kept, even if less is needed now.
        if bytes <= self.bytes {
            return !self.meter.0.is_overrun.load(Ordering::Relaxed);
        }
        let counters = &self.meter.0;
        let others = self.meter.reserved() - self.bytes;
        if others.saturating_add(bytes) > counters.limit {
            counters.is_overrun.store(true, Ordering::Relaxed);
        }
        if counters.is_overrun.load(Ordering::Relaxed) {
            return false;
        }
        // One run is one thread's: nobody counts in between.
        counters.reserved[self.kind as usize].fetch_add(bytes - self.bytes, Ordering::Relaxed);
        self.bytes = bytes;
        true
    }

    /// Creates another holder of the same kind, for temporary memory.
    pub fn beside(&self) -> Self {
        self.meter.holder(self.kind)
    }
}

impl Clone for MemoryShare {
    /// Creates a holder that asks for as many bytes.
    fn clone(&self) -> Self {
        let mut other = self.beside();
        // A refusal marks the meter as overrun, and the run fails by that.
        other.cover(self.bytes as usize);
        other
    }
}

impl Drop for MemoryShare {
    fn drop(&mut self) {
        self.meter.0.reserved[self.kind as usize].fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// Collections whose size in memory is known before they grow.
pub trait CapacityBytes {
    /// Returns the bytes that the collection takes once it has `more` elements more: its capacity, which doubles where
    /// it does not suffice.
    fn bytes_after(&self, more: usize) -> usize;
}

impl<T> CapacityBytes for Vec<T> {
    fn bytes_after(&self, more: usize) -> usize {
        size_of::<T>() * capacity_after(self.len(), self.capacity(), more)
    }
}

impl<T> CapacityBytes for VecDeque<T> {
    fn bytes_after(&self, more: usize) -> usize {
        size_of::<T>() * capacity_after(self.len(), self.capacity(), more)
    }
}

impl<T: Ranked> CapacityBytes for OpenList<T> {
    fn bytes_after(&self, more: usize) -> usize {
        size_of::<T>() * capacity_after(self.waiting(), self.capacity(), more)
    }
}

fn capacity_after(len: usize, capacity: usize, more: usize) -> usize {
    if len + more <= capacity { capacity } else { (2 * capacity).max(len + more) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reserved_memory_is_counted_until_its_holder_is_dropped() {
        let meter = MemoryMeter::new(100);
        let mut flood = meter.holder(MemoryKind::Floods);
        let mut search = meter.holder(MemoryKind::Searches);
        assert!(flood.cover(60) && search.cover(40) && flood.cover(50));
        assert_eq!((meter.reserved(), meter.overrun()), (100, None), "what shrinks keeps its memory");
        drop(flood);
        assert!(search.cover(100));
        assert_eq!((meter.reserved(), meter.overrun()), (100, None));
    }

    #[test]
    fn one_byte_too_many_is_refused_and_so_is_all_that_follows() {
        let meter = MemoryMeter::new(100);
        let mut flood = meter.holder(MemoryKind::Floods);
        let mut search = meter.holder(MemoryKind::Searches);
        assert!(flood.cover(70) && search.cover(20));
        assert!(!search.cover(31));
        assert_eq!(
            (meter.reserved(), meter.overrun()),
            (90, Some(ReservedMemory { kind: MemoryKind::Floods, bytes: 70 }))
        );
        assert!(!search.cover(1) && !flood.cover(71));
    }

    #[test]
    fn the_growth_of_a_list_is_counted_before_it_grows() {
        let mut list: Vec<u64> = Vec::new();
        for _ in 0..10_000 {
            let foretold = list.bytes_after(3);
            list.extend([1, 2, 3]);
            assert!(8 * list.capacity() <= foretold.max(32), "a first allocation takes four elements");
        }
    }
}
