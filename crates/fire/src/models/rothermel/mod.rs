//! Fire that spreads by Rothermel's equations: when its front reaches which cell.
//!
//! Every cell has one time of arrival, the least over all candidates. A one-point candidate is a burned cell's time plus
//! that of the straight way from it (`template.rs`), over the cells that it crosses, each with its own ellipse and by its
//! part of the length. A two-point candidate is the first fire from the line between two burned cells whose ways to the
//! cell are neighbours in direction; it needs one fuel on all cells that both ways cross, and has a closed form, exact for
//! fronts that are straight. Without these a front would keep the corners of the template. Round a cell that did not
//! catch fire from a front, all cells within three cells, along ways of one fuel, have the exact time of the ellipse.
//!
//! - A way is blocked by a cell that does not burn or that is extinguished for good, and where it passes between two such
//!   cells that touch at a corner.
//! - The weather is known in advance. A way takes as long as it takes until the integral of dt / (its time in the weather
//!   at t) is 1, so that nothing is to be computed again when the wind turns.
//! - A cell that is wet, or that was extinguished and can burn again, lets fire pass from a time on: ways over it begin
//!   then, if the cell that they begin in still flames, and have no part in two-point candidates.
//! - Where only the wind differs from place to place, a way of up to three columns and rows over one fuel takes the mean of
//!   what its two ends would make it take.
//! - Embers, where the rules have any, set cells on fire beside the front; from there it is as if they had been lit.
//! - A candidate is not earlier than the later of the cells that it comes from. Where slopes differ, the ellipse of a
//!   two-point candidate is that of the cell; what both ways need beyond that ellipse moves the times of their beginnings.
//!
//! Candidates depend on states and times only, so that neither the order of events nor the moment of a repair matters. When
//! a cell is extinguished or wetted, plans near it are marked and computed again when they come due, as they can only become
//! later. What fire comes to first is known to a queue inside; outside one arrival at a time is expected.
//!
//! Sources: Rothermel, INT-115, 1972, for the rates; Dijkstra, 1959, for the order; the two-point update solves the
//! eikonal equation on a triangle as Sethian and Vladimirsky, "Ordered upwind methods for static Hamilton-Jacobi
//! equations", 2003, do, for the norm with drift that an ellipse with its focus at the origin is.

mod directions;
mod front;
mod queue;
mod rates;
mod rules;
mod sparks;
mod template;

pub use directions::{DirectionSet, sampled_cells};
pub use rules::{Neighbours, RothermelRules};

use std::sync::Arc;

use crate::surface::crown::FireType;
use crate::{Arrival, FireChange, FireEvent, FireEvents, FireField, FireModel, Landscape, Spread, SpreadBy, Weather};
use front::Front;
use sparks::Sparks;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;

/// The model on one landscape in one weather.
#[derive(Clone, Debug)]
pub struct Rothermel {
    front: Front,
    /// Where the rules have embers: what they are about to set on fire.
    sparks: Option<Sparks>,
    /// The time of the arrival that is expected outside, which has the last revision.
    announced: Option<SimTime>,
    revision: u32,
}

impl Rothermel {
    pub fn new(landscape: Arc<Landscape>, weather: Arc<Weather>, rules: RothermelRules) -> Self {
        let sparks = rules.embers.map(|embers| Sparks::new(embers, &landscape, &weather, rules.options));
        Self { front: Front::new(landscape, weather, rules), sparks, announced: None, revision: 0 }
    }

    /// Returns the time of the next arrival, if nothing changes by then.
    pub fn next_arrival(&mut self) -> Option<SimTime> {
        self.next().map(|(time, _)| time)
    }

    /// Returns when a front that is near comes to a cell that has not burned, by all that has.
    pub fn planned_arrival(&self, cell: Cell) -> Option<SimTime> {
        self.front.planned(cell)
    }

    /// Returns the next arrival, and the cell that it is at.
    fn next(&mut self) -> Option<(SimTime, Cell)> {
        let front = self.front.next().map(|(time, cell)| (SimTime::from_nanos(time), cell));
        let spark = self.sparks.as_ref().and_then(Sparks::next);
        // Of equal times `min_by_key` keeps the front's, so that a tie is the same in every run.
        front.into_iter().chain(spark).min_by_key(|&(time, _)| time)
    }

    /// Adds to `spreads`, by cell index, what catches fire at that time or before.
    pub fn take_due(&mut self, now: SimTime, spreads: &mut Vec<Spread>) {
        let first = spreads.len();
        self.front.take_due(now.as_nanos(), |cell, from| spreads.push(Spread { cell, from, by: SpreadBy::Front }));
        if let Some(sparks) = &mut self.sparks {
            let before = spreads.len();
            sparks.take_due(now, spreads);
            if spreads.len() > before {
                // A front that is there at the same instant comes first.
                spreads[first..].sort_by_key(|spread| (spread.cell.row, spread.cell.col));
            }
        }
    }

    /// Returns the kind of fire that a cell with trees has at a time; `None` where there are none.
    pub fn fire_type(&mut self, cell: Cell, time: SimTime) -> Option<FireType> {
        self.front.fire_type(cell, time.as_nanos())
    }

    /// Takes in a change without a word on what follows from it.
    pub fn apply(&mut self, fires: &FireField, now: SimTime, change: FireChange) {
        let nanos = now.as_nanos();
        match change {
            FireChange::Ignited { cell, .. } => {
                // Before the front takes it in and forgets by which way it came.
                if let Some(sparks) = &mut self.sparks {
                    sparks.fly_from(cell, self.front.way_to(cell, nanos), fires.episode(cell), now);
                }
                self.front.ignite(cell, nanos);
            }
            FireChange::Extinguished { cell } => self.front.extinguish(cell, nanos, fires.allows_reignition()),
            FireChange::Wetted { cell, until } => self.front.delay(cell, until.as_nanos()),
            // Fire goes on from what has burned out, and what dries was planned for when it became wet.
            FireChange::BurnedOut { .. } | FireChange::Dried { .. } => {}
        }
    }

    fn announce(&mut self, expected: &mut FireEvents) {
        let Some((time, cell)) = self.next() else { return };
        // An arrival that comes too early finds nothing due and announces the next, so only an earlier one is news.
        if self.announced.is_none_or(|announced| time < announced) {
            self.revision += 1;
            self.announced = Some(time);
            expected.push((time, FireEvent::Arrival(Arrival { cell, revision: self.revision })));
        }
    }
}

impl FireModel for Rothermel {
    fn reseed(&mut self, seed: u64) {
        if let Some(sparks) = &mut self.sparks {
            sparks.reseed(seed);
        }
    }

    fn follow(&mut self, fires: &FireField, now: SimTime, change: FireChange, expected: &mut FireEvents) {
        self.apply(fires, now, change);
        match change {
            FireChange::Ignited { cell, .. } => {
                let flaming = self.front.flaming(cell, now.as_nanos());
                let burn_out = FireEvent::BurnOut { cell, episode: fires.episode(cell) };
                expected.extend(flaming.map(|span| (now + span, burn_out)));
            }
            // A cell that is cleared never dries.
            FireChange::Wetted { cell, until } if until < SimTime::MAX => {
                expected.push((until, FireEvent::Dry { cell }));
            }
            _ => {}
        }
        self.announce(expected);
    }

    fn arrive(&mut self, _fires: &FireField, now: SimTime, arrival: Arrival, expected: &mut FireEvents) -> Vec<Spread> {
        let mut spreads = Vec::new();
        // Announcements before the last change are out of date.
        if arrival.revision == self.revision {
            self.announced = None;
            self.take_due(now, &mut spreads);
            self.announce(expected);
        }
        spreads
    }

    fn is_under_way(&self) -> bool {
        self.announced.is_some()
    }
}
