//! Crews that build line: where from a forecast of the fire, and how the line holds.
//!
//! When the first crew sets out, the fire is forecast from its state by its own model, as if nobody fought it, with other
//! embers than those that will fly. The line follows from that at once ([`wildfire_fire::line`]), and its cells become
//! unburnable one by one as they are finished. What burns by then, as the forecast was wrong, stays a gap.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use rand::RngExt;

use crate::scenario::{Crew, LineHolds, LinePolicy, LineSettings, Scenario};
use wildfire_base::geometry::{Cell, DVec2, ops};
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_fire::line::{Forecast, LineCell, LineTask};
use wildfire_fire::surface::{flame_length_m, surface_fire};
use wildfire_fire::{FireChange, FireEvent, FireField};
use wildfire_timeline::SpreadSetting;

use super::fire::Fires;
use super::queue::{CellEvent, Due, Rank, SimClock, SimQueue};
use super::schedule::{Pass, SimSystems};

/// Crews look again after this time if nothing burns.
const LOOK_AGAIN: SimTime = SimTime::from_nanos(60_000_000_000);

/// Rounds of a walk to an end of the fire that moves; it is slower than people, or they do not get there.
const WALKS: u32 = 8;

/// The plugin in which crews decide where to build line.
#[derive(Debug)]
pub struct LinePlugin;

impl Plugin for LinePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Pass, plan_line.in_set(SimSystems::Crews));
    }
}

/// The line of a run: who builds it, if anybody does, and its cells.
#[derive(Resource, Clone, Debug, Default)]
pub struct FireLine {
    orders: Option<Arc<Orders>>,
    /// By cell index: the flank, and the number of the section on it.
    sections: BTreeMap<usize, (usize, u64)>,
}

#[derive(Debug)]
struct Orders {
    settings: LineSettings,
    crews: Vec<Crew>,
    spread: SpreadSetting,
    until: SimTime,
    seed: u64,
}

impl FireLine {
    pub fn new(scenario: &Scenario, seed: u64, spread: Option<&SpreadSetting>) -> Self {
        let orders = spread.filter(|_| !scenario.crew.is_empty()).map(|spread| Orders {
            settings: scenario.line.clone().unwrap_or_default(),
            crews: scenario.crew.clone(),
            spread: spread.clone(),
            until: SimTime::from_seconds(scenario.duration_s),
            seed,
        });
        Self { orders: orders.map(Arc::new), sections: BTreeMap::new() }
    }

    /// Returns when the first crew sets out.
    pub fn begins(&self) -> Option<SimTime> {
        self.orders.as_ref()?.crews.iter().map(|crew| SimTime::from_seconds(crew.at_s)).min()
    }

    /// Lists the cells of line that fire crosses because of a change: one beside it caught fire, or was cleared beside
    /// flames.
    pub fn lost_by(&self, change: FireChange, now: SimTime, fires: &FireField) -> Vec<Cell> {
        let by_flames = |orders: &&Arc<Orders>| orders.settings.holds == LineHolds::Flame;
        let Some(orders) = self.orders.as_ref().filter(by_flames) else { return Vec::new() };
        let frame = *fires.frame();
        let steps = (-1..=1).flat_map(|cols| (-1..=1).map(move |rows| (cols, rows)));
        let around = steps.filter_map(|(cols, rows)| frame.offset(change.cell(), cols, rows));
        let is_crossed = |line: Cell, from: Cell| {
            let section = self.sections.get(&frame.index(line));
            section.is_some_and(|&section| orders.is_crossed(section, line, from, now))
        };
        match change {
            FireChange::Ignited { cell, .. } => {
                around.filter(|&line| fires.is_cleared(line) && is_crossed(line, cell)).collect()
            }
            FireChange::Wetted { cell, .. } if fires.is_cleared(cell) => {
                around.filter(|&near| fires.is_burning(near) && is_crossed(cell, near)).map(|_| cell).take(1).collect()
            }
            _ => Vec::new(),
        }
    }
}

impl Orders {
    /// Draws if fire from a cell crosses line. The chance that line holds falls with the flame length as a logistic function,
    /// after Mees, Strauss and Chase, "Modeling wildland fire containment with uncertain flame length and fireline width",
    /// 1993. What is drawn belongs to the section, so that more or smaller cells do not change it.
    fn is_crossed(&self, (flank, section): (usize, u64), line: Cell, from: Cell, now: SimTime) -> bool {
        let SpreadSetting::Rothermel { landscape, weather, rules } = &self.spread else { return false };
        let Some(fire) = surface_fire(landscape, weather, &rules.options, from, now) else { return false };
        let way = landscape.frame.centre(line) - landscape.frame.centre(from);
        let flame_m = flame_length_m(fire.intensity_kw_m(fire.front_normal_rate_mps(way)));
        let holds = 1.0 / (1.0 + ops::exp((flame_m - self.settings.flame_half_m) / self.settings.flame_scale_m));
        rng::stream(self.seed, &format!("line/{flank}/{section}")).random::<f64>() >= holds
    }

    /// Computes when which cell is finished; nothing if the fire has no end to begin at.
    fn cells(&self, forecast: &Forecast) -> Vec<LineCell> {
        let settings = &self.settings;
        let centre = DVec2::new(settings.x_m, settings.y_m);
        let most_mps = self.crews.iter().map(Crew::most_mps).sum();
        let mut arrivals: Vec<f64> = self.crews.iter().map(|crew| crew.at_s).collect();
        let first = |arrivals: &[f64]| arrivals.iter().copied().fold(f64::INFINITY, f64::min);
        // Where crews go changes while they walk, as the fire grows.
        for _ in 0..WALKS {
            let goal = match settings.policy {
                LinePolicy::PointProtection => Some(centre),
                _ => forecast.end_of_fire(first(&arrivals), settings.from),
            };
            let Some(goal) = goal else { return Vec::new() };
            let arrival = |crew: &Crew| crew.at_s + (goal - crew.start()).length() / crew.speed_mps;
            arrivals = self.crews.iter().map(arrival).collect();
        }
        let landscape = self.spread.landscape();
        let rate_mps = |time_s: f64, place: DVec2| {
            let fuel = landscape.frame.cell_at(place).map_or(0, |cell| landscape.fuel_number(cell));
            let crews = self.crews.iter().zip(&arrivals).filter(|&(_, &arrival_s)| arrival_s <= time_s);
            crews.map(|(crew, _)| crew.rate_mps(fuel)).sum()
        };
        let (start_s, until_s) = (first(&arrivals), self.until.as_seconds());
        let task = LineTask { start_s, rate_mps: &rate_mps, most_mps, until_s };
        let line = match settings.policy {
            LinePolicy::Direct => task.along_front(forecast, settings.from, 0.0),
            LinePolicy::Parallel => task.along_front(forecast, settings.from, settings.offset_m),
            LinePolicy::PointProtection => task.around(forecast, centre, settings.radius_m, self.crews[0].start()),
        };
        line.cells(forecast)
    }
}

/// Decides where the line is when the first crew sets out, and schedules its cells.
fn plan_line(clock: Res<SimClock>, mut queue: ResMut<SimQueue>, fires: Res<Fires>, mut line: ResMut<FireLine>) {
    while queue.take(clock.0, Rank::Line).is_some() {
        let Some(orders) = line.orders.clone() else { continue };
        let protects = orders.settings.policy == LinePolicy::PointProtection;
        if !protects && !fires.model.is_under_way() && fires.field.burning().len() == 0 {
            queue.push(clock.0 + LOOK_AGAIN, Due::Line);
            continue;
        }
        let forecast = forecast(&fires, &queue, orders.until, orders.seed);
        for LineCell { cell, flank, time_s, along_m } in orders.cells(&forecast) {
            let clear = CellEvent::Clear { cell, flank: flank as u8, along_mm: (1000.0 * along_m).round() as u32 };
            queue.push(SimTime::from_seconds(time_s).max(clock.0), Due::Cell(clear));
            line.sections.insert(forecast.frame.index(cell), (flank, (along_m / orders.settings.section_m) as u64));
        }
    }
}

/// Lets a copy of the fire burn on by itself.
fn forecast(fires: &Fires, queue: &SimQueue, until: SimTime, seed: u64) -> Forecast {
    let Fires { mut field, mut model } = fires.clone();
    let mut queue = queue.clone();
    model.redraw(rng::key(seed, "line/forecast"));
    while let Some(now) = queue.next_time().filter(|&now| now <= until) {
        let due = queue.next(now).copied();
        queue.drop_next();
        let mut expected = Vec::new();
        let changes: Vec<FireChange> = match due {
            Some(Due::Fire(FireEvent::Arrival(arrival))) => {
                let spreads = model.arrive(&field, now, arrival, &mut expected);
                spreads.into_iter().filter_map(|spread| field.ignite(spread.cell, now, false)).collect()
            }
            Some(Due::Fire(FireEvent::BurnOut { cell, episode })) if field.goes_on(cell, episode) => {
                vec![field.burn_out(cell)]
            }
            Some(Due::Fire(FireEvent::Dry { cell })) => field.dry(cell, now).into_iter().collect(),
            _ => Vec::new(),
        };
        changes.into_iter().for_each(|change| model.follow(&field, now, change, &mut expected));
        expected.into_iter().for_each(|(time, event)| queue.push(time, Due::Fire(event)));
    }
    let frame = *field.frame();
    let arrivals = (0..frame.cell_count()).map(|index| field.ignited_at(frame.cell(index)));
    Forecast { frame, seconds: arrivals.map(|time| time.map_or(f64::INFINITY, SimTime::as_seconds)).collect() }
}
