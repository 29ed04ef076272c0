//! Ignition, spread, burn-out and extinction.
//!
//! Whatever is to become of a bush goes through the queue as a [`BushEvent`]. [`change_bushes`] carries them out until one
//! concerns an agent, who then acts before the next bush changes.

use bevy::prelude::*;

use crate::fire::{FireEvent, FireField, FireModel, Spread};
use crate::geometry::Cell;
use crate::scenario::IgnitionCells;
use crate::time::SimTime;
use crate::timeline::{Cause, FireFact};

use super::queue::{BushEvent, Due, Rank, SimClock, SimQueue};
use super::recorder::Recorder;
use super::schedule::{Pass, SimSystems};
use super::wake::Listeners;

/// Bushes burn.
#[derive(Debug)]
pub struct FirePlugin;

impl Plugin for FirePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Pass, (burn_out, spread, light_scheduled, change_bushes).chain().in_set(SimSystems::Fire));
    }
}

/// The bushes, and the model by which they burn.
#[derive(Resource, Debug)]
pub struct Fires {
    pub field: FireField,
    pub model: Box<dyn FireModel>,
}

/// The scenario's own ignitions.
#[derive(Resource, Debug)]
pub struct Ignitions {
    pub entries: Vec<IgnitionCells>,
    /// All bushes in the order in which random ignitions take them.
    pub permutation: Vec<Cell>,
    /// How many are still to come.
    pub pending: usize,
}

impl Ignitions {
    /// Returns the cells that an ignition lights: those it names, or the first of the permutation that can burn.
    fn cells(&self, number: usize, fires: &FireField) -> Vec<Cell> {
        match &self.entries[number] {
            IgnitionCells::Cells(cells) => cells.clone(),
            IgnitionCells::Random(count) => {
                self.permutation.iter().copied().filter(|&cell| fires.can_burn(cell)).take(*count as usize).collect()
            }
        }
    }
}

/// Ends fires that burned for long enough.
fn burn_out(clock: Res<SimClock>, mut queue: ResMut<SimQueue>, fires: Res<Fires>) {
    while let Some(Due::Fire(FireEvent::BurnOut { cell, episode })) = queue.take(clock.0, Rank::BurnOut) {
        if fires.field.goes_on(cell, episode) {
            queue.push(clock.0, Due::Bush(BushEvent::BurnOut { cell }));
        }
    }
}

/// Sets on fire what the model says that the fire has come to.
fn spread(clock: Res<SimClock>, mut queue: ResMut<SimQueue>, mut fires: ResMut<Fires>) {
    let Fires { field, model } = &mut *fires;
    while let Some(Due::Fire(FireEvent::Arrival(arrival))) = queue.take(clock.0, Rank::Spread) {
        let mut expected = Vec::new();
        for Spread { cell, from } in model.arrive(field, clock.0, arrival, &mut expected) {
            queue.push(clock.0, Due::Bush(BushEvent::Ignite { cell, cause: Cause::Spread(from) }));
        }
        expect(&mut queue, expected);
    }
}

/// Lights what the scenario says.
fn light_scheduled(
    clock: Res<SimClock>,
    mut queue: ResMut<SimQueue>,
    fires: Res<Fires>,
    mut scheduled: ResMut<Ignitions>,
) {
    while let Some(&Due::Scheduled(number)) = queue.next(clock.0) {
        queue.drop_next();
        scheduled.pending -= 1;
        for cell in scheduled.cells(number, &fires.field) {
            queue.push(clock.0, Due::Bush(BushEvent::Ignite { cell, cause: Cause::Scheduled }));
        }
    }
}

/// Changes bushes, if they can be changed so, and lets the model of the fire say what follows, until an agent is woken.
fn change_bushes(
    clock: Res<SimClock>,
    mut queue: ResMut<SimQueue>,
    mut fires: ResMut<Fires>,
    mut recorder: ResMut<Recorder>,
    listeners: Listeners,
) {
    let now = clock.0;
    let Fires { field, model } = &mut *fires;
    while let Some(Due::Bush(event)) = queue.take(now, Rank::Change) {
        let (change, fact) = match event {
            BushEvent::Ignite { cell, cause } => {
                let lit = !matches!(cause, Cause::Spread(_));
                let Some(change) = field.ignite(cell, now, lit) else { continue };
                (change, FireFact::Ignited { cell, cause })
            }
            // Of two stops that end together, one may have been faster.
            BushEvent::Extinguish { cell, .. } | BushEvent::BurnOut { cell } if !field.is_burning(cell) => continue,
            BushEvent::Extinguish { cell, by } => (field.extinguish(cell), FireFact::Extinguished { cell, by }),
            BushEvent::BurnOut { cell } => (field.burn_out(cell), FireFact::BurnedOut { cell }),
        };
        recorder.record_fire(now, fact);
        let mut expected = Vec::new();
        model.follow(field, now, change, &mut expected);
        expect(&mut queue, expected);
        if listeners.hear_of(change, now, field, &mut queue) {
            return;
        }
    }
}

fn expect(queue: &mut SimQueue, expected: Vec<(SimTime, FireEvent)>) {
    for (time, event) in expected {
        queue.push(time, Due::Fire(event));
    }
}
