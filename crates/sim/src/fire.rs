//! Ignition, spread, burn-out and extinction.
//!
//! Whatever is to become of a bush, or of the ground, goes through the queue as a [`CellEvent`]. [`change_cells`] carries
//! them out until one concerns an agent, who then acts before the next cell changes.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;

use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_fire::{BushStateKind, FireChange, FireEvent, FireField, FireModel, Spread, SpreadBy};
use wildfire_timeline::{Cause, FireFact, GroundEvent, GroundFact};

use super::line::plan_line;
use super::queue::{CellEvent, Due, Rank, SimClock, SimQueue};
use super::recorder::Recorder;
use super::schedule::{Pass, SimSystems};
use super::wake::WakeTargets;
use super::water::WaterNeeds;

/// The plugin in which bushes and ground burn.
#[derive(Debug)]
pub struct FirePlugin;

impl Plugin for FirePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Pass,
            // In the order of ranks: at one instant fires end before others spread.
            (burn_out, dry, spread, light_scheduled, plan_line, change_cells).chain().in_set(SimSystems::Fire),
        );
    }
}

/// Everything that can burn, with the fire model.
#[derive(Resource, Clone, Debug)]
pub struct Fires {
    pub field: FireField,
    pub model: Box<dyn FireModel>,
    /// The bushes that catch fire and go out together; nothing where each does by itself.
    pub pieces: Pieces,
}

/// Bushes by the pieces that they belong to. All bushes of a piece are in one state whenever an instant is over.
#[derive(Clone, Debug, Default)]
pub struct Pieces {
    cells: Arc<BTreeMap<u32, Vec<Cell>>>,
    /// The number of each bush's piece, by cell index.
    numbers: Arc<BTreeMap<usize, u32>>,
}

impl Pieces {
    /// Sorts bushes by the numbers of their pieces, which are as many, or none.
    pub fn new(frame: &FieldFrame, bushes: &[Cell], numbers: &[u32]) -> Self {
        let mut cells: BTreeMap<u32, Vec<Cell>> = BTreeMap::new();
        for (&bush, &number) in bushes.iter().zip(numbers) {
            cells.entry(number).or_default().push(bush);
        }
        let numbers = bushes.iter().map(|&bush| frame.index(bush)).zip(numbers.iter().copied()).collect();
        Self { cells: Arc::new(cells), numbers: Arc::new(numbers) }
    }

    /// Returns the other cells of a piece that is now to follow one of them into a state; none if they are on their way
    /// already, since another has come there.
    fn followers(&self, field: &FireField, cell: Cell, state: BushStateKind) -> Vec<Cell> {
        let number = self.numbers.get(&field.frame().index(cell));
        let mut others = number.and_then(|number| self.cells.get(number)).cloned().unwrap_or_default();
        others.retain(|&other| other != cell);
        if others.iter().any(|&other| field.kind(other) == Some(state)) { Vec::new() } else { others }
    }
}

/// The ignitions that the scenario schedules.
#[derive(Resource, Clone, Debug)]
pub struct Ignitions {
    pub entries: Vec<ScheduledIgnition>,
    /// For each entry the time after which it repeats, if it does.
    pub every: Vec<Option<SimTime>>,
    /// The number of entries that light something still; one that repeats does to the end.
    pub pending: usize,
    /// No ignition repeats after this time.
    pub end: SimTime,
}

/// The cells of a scheduled ignition.
#[derive(Clone, Debug)]
pub enum ScheduledIgnition {
    /// The given cells.
    Named(Vec<Cell>),
    /// The first `count` cells of an order that can burn at that time.
    FirstOf { order: Arc<[Cell]>, count: u32 },
}

impl Ignitions {
    /// Returns when an ignition that is due now is due again, if it is within the run.
    fn next_time(&self, number: usize, now: SimTime) -> Option<SimTime> {
        self.every[number].map(|every| now + every).filter(|&next| next <= self.end)
    }

    /// Returns the cells that an ignition lights.
    fn cells(&self, number: usize, fires: &FireField) -> Vec<Cell> {
        match &self.entries[number] {
            ScheduledIgnition::Named(cells) => cells.clone(),
            ScheduledIgnition::FirstOf { order, count } => {
                order.iter().copied().filter(|&cell| fires.can_burn(cell)).take(*count as usize).collect()
            }
        }
    }
}

/// Ends fires that burned for long enough.
fn burn_out(clock: Res<SimClock>, mut queue: ResMut<SimQueue>, fires: Res<Fires>) {
    while let Some(Due::Fire(FireEvent::BurnOut { cell, episode })) = queue.take(clock.0, Rank::BurnOut) {
        // The event of a fire that was put out meanwhile is void.
        if fires.field.goes_on(cell, episode) {
            queue.push(clock.0, Due::Cell(CellEvent::BurnOut { cell }));
        }
    }
}

/// Lets cells dry whose time has come.
fn dry(clock: Res<SimClock>, mut queue: ResMut<SimQueue>) {
    while let Some(Due::Fire(FireEvent::Dry { cell })) = queue.take(clock.0, Rank::Drying) {
        queue.push(clock.0, Due::Cell(CellEvent::Dry { cell }));
    }
}

/// Sets on fire what the model says that the fire has come to.
fn spread(clock: Res<SimClock>, mut queue: ResMut<SimQueue>, mut fires: ResMut<Fires>) {
    let Fires { field, model, .. } = &mut *fires;
    while let Some(Due::Fire(FireEvent::Arrival(arrival))) = queue.take(clock.0, Rank::Spread) {
        let mut expected = Vec::new();
        for Spread { cell, from, by } in model.arrive(field, clock.0, arrival, &mut expected) {
            let cause = match by {
                SpreadBy::Front => Cause::Spread(from),
                SpreadBy::Ember => Cause::Spotted(from),
            };
            queue.push(clock.0, Due::Cell(CellEvent::Ignite { cell, cause }));
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
        match scheduled.next_time(number, clock.0) {
            Some(next) => queue.push(next, Due::Scheduled(number)),
            None => scheduled.pending -= 1,
        }
        for cell in scheduled.cells(number, &fires.field) {
            queue.push(clock.0, Due::Cell(CellEvent::Ignite { cell, cause: Cause::Scheduled }));
        }
    }
}

/// Changes cells, if they can be changed so, and lets the model of the fire say what follows, until an agent is woken.
fn change_cells(
    clock: Res<SimClock>,
    mut queue: ResMut<SimQueue>,
    mut fires: ResMut<Fires>,
    mut recorder: ResMut<Recorder>,
    mut needs: Option<ResMut<WaterNeeds>>,
    listeners: WakeTargets,
) {
    let now = clock.0;
    let Fires { field, model, pieces } = &mut *fires;
    while let Some(Due::Cell(event)) = queue.take(now, Rank::Change) {
        let change = change_cell(field, now, event);
        // Line that does not hold leaves the cell as it is, but the crew has built it.
        if change.is_some() || matches!(event, CellEvent::Clear { holds: false, .. }) {
            record(&mut recorder, now, event, field);
        }
        let Some(change) = change else { continue };
        take_whole_piece(&mut queue, now, event, field, pieces);
        needs.iter_mut().for_each(|needs| needs.follow(event, now, field));
        let mut expected = Vec::new();
        model.follow(field, now, change, &mut expected);
        expect(&mut queue, expected);
        // The rest waits in the queue until the agent has acted.
        if listeners.notify(change, now, field, &mut queue) {
            return;
        }
    }
}

/// Has the rest of a piece catch fire, or go out, with a bush that just did.
fn take_whole_piece(queue: &mut SimQueue, now: SimTime, event: CellEvent, field: &FireField, pieces: &Pieces) {
    match event {
        CellEvent::Ignite { cell, cause } => {
            for cell in pieces.followers(field, cell, BushStateKind::Burning) {
                queue.push(now, Due::Cell(CellEvent::Ignite { cell, cause }));
            }
        }
        CellEvent::Extinguish { cell, by } => {
            for cell in pieces.followers(field, cell, BushStateKind::Extinguished) {
                queue.push(now, Due::Cell(CellEvent::Extinguish { cell, by }));
            }
        }
        // The bushes of a piece that caught fire together burn out together.
        CellEvent::BurnOut { .. } | CellEvent::Wet { .. } | CellEvent::Dry { .. } | CellEvent::Clear { .. } => {}
    }
}

/// Changes a cell, if it can be changed so.
fn change_cell(field: &mut FireField, now: SimTime, event: CellEvent) -> Option<FireChange> {
    match event {
        // What nobody passed on is a source, and the rules may let sources spread and others not.
        CellEvent::Ignite { cell, cause } => field.ignite(cell, now, cause.parent().is_none()),
        // Of two stops that end together, one may have been faster.
        CellEvent::Extinguish { cell, .. } | CellEvent::BurnOut { cell } if !field.is_burning(cell) => None,
        CellEvent::Extinguish { cell, .. } => Some(field.extinguish(cell)),
        CellEvent::BurnOut { cell } => Some(field.burn_out(cell)),
        CellEvent::Wet { cell, until, .. } => field.wet(cell, until),
        CellEvent::Dry { cell } => field.dry(cell, now),
        CellEvent::Clear { cell, holds, .. } => holds.then(|| field.clear(cell)).flatten(),
    }
}

/// Records a change that was made, if it is one that a timeline holds: see [`GroundEvent`].
fn record(recorder: &mut Recorder, now: SimTime, event: CellEvent, field: &FireField) {
    let ground = |cell, fact| GroundEvent { time: now, cell, fact };
    match event {
        CellEvent::Ignite { cell, cause } if field.is_bush(cell) => {
            recorder.record_fire(now, FireFact::Ignited { cell, cause });
        }
        CellEvent::Extinguish { cell, by } if field.is_bush(cell) => {
            recorder.record_fire(now, FireFact::Extinguished { cell, by });
        }
        CellEvent::BurnOut { cell } if field.is_bush(cell) => recorder.record_fire(now, FireFact::BurnedOut { cell }),
        CellEvent::Ignite { cell, cause } => recorder.record_ground(ground(cell, GroundFact::Ignited(cause))),
        CellEvent::Extinguish { cell, by } => recorder.record_ground(ground(cell, GroundFact::Extinguished { by })),
        CellEvent::Wet { cell, until, by } => recorder.record_ground(ground(cell, GroundFact::Wetted { until, by })),
        CellEvent::Clear { cell, flank, along_mm, holds } => {
            recorder.record_ground(ground(cell, GroundFact::Cleared { flank, along_mm, holds }));
        }
        CellEvent::BurnOut { .. } | CellEvent::Dry { .. } => {}
    }
}

fn expect(queue: &mut SimQueue, expected: Vec<(SimTime, FireEvent)>) {
    for (time, event) in expected {
        queue.push(time, Due::Fire(event));
    }
}
