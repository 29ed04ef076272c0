//! Crews that build line: where, from a forecast of the fire, and where it does not hold.
//!
//! When the first crew sets out, the fire is forecast from its state by its own model, as if nobody fought it, with other
//! embers than those that will fly. The line follows from that at once ([`wildfire_fire::line`]), and its cells become
//! unburnable one by one as they are finished. What burns by then, as the forecast was wrong, stays a gap.

use std::sync::Arc;

use bevy_ecs::prelude::*;
use rand::RngExt;

use crate::scenario::{Crew, LineHolds, LinePolicy, LineSettings, Scenario};
use wildfire_base::geometry::{DVec2, ops};
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_fire::line::{Forecast, LineCell, LineTask};
use wildfire_fire::surface::{flame_length_m, surface_fire};
use wildfire_fire::{FireChange, FireEvent};
use wildfire_timeline::SpreadSetting;

use super::fire::Fires;
use super::queue::{CellEvent, Due, Rank, SimClock, SimQueue};

/// Crews look again after this time if nothing burns.
const LOOK_AGAIN: SimTime = SimTime::from_nanos(60_000_000_000);

/// The orders of the crews of a run.
#[derive(Resource, Clone, Debug)]
pub struct CrewOrders(Arc<Orders>);

#[derive(Debug)]
struct Orders {
    settings: LineSettings,
    crews: Vec<Crew>,
    spread: SpreadSetting,
    until: SimTime,
    seed: u64,
}

/// Gives crews their orders, and lets the first one set out.
pub fn order(world: &mut World, scenario: &Scenario, seed: u64, spread: Option<&SpreadSetting>) {
    let begins = scenario.crew.iter().map(|crew| SimTime::from_seconds(crew.at_s)).min();
    let (Some(begins), Some(spread)) = (begins, spread) else { return };
    world.insert_resource(CrewOrders(Arc::new(Orders {
        settings: scenario.line.clone().unwrap_or_default(),
        crews: scenario.crew.clone(),
        spread: spread.clone(),
        until: SimTime::from_seconds(scenario.duration_s),
        seed,
    })));
    world.resource_mut::<SimQueue>().push(begins, Due::Line);
}

impl Orders {
    /// Draws if line holds against the fire that is expected there. The chance falls with its flame length as a logistic
    /// function, after Mees, Strauss and Chase, "Modeling wildland fire containment with uncertain flame length and fireline
    /// width", 1993. What is drawn belongs to a section, so that more or smaller cells do not change it.
    fn holds(&self, line: &LineCell) -> bool {
        let LineSettings { holds, flame_half_m, flame_scale_m, section_m, .. } = self.settings;
        let (SpreadSetting::Rothermel { landscape, weather, rules }, Some((time_s, way)), LineHolds::Flame) =
            (&self.spread, line.front, holds)
        else {
            return true;
        };
        let time = SimTime::from_seconds(time_s);
        let Some(fire) = surface_fire(landscape, weather, &rules.options, line.cell, time) else { return true };
        let flame_m = flame_length_m(fire.intensity_kw_m(fire.front_normal_rate_mps(way)));
        let chance = 1.0 / (1.0 + ops::exp((flame_m - flame_half_m) / flame_scale_m));
        let section = (line.along_m / section_m) as u64;
        rng::stream(self.seed, &format!("line/{}/{section}", line.flank)).random::<f64>() < chance
    }

    /// Computes when which cell is finished; nothing if the fire has no end to begin at.
    fn cells(&self, forecast: &Forecast) -> Vec<LineCell> {
        let LineSettings { policy, from, offset_m, .. } = self.settings;
        let mut arrivals: Vec<f64> = self.crews.iter().map(|crew| crew.at_s).collect();
        let first = |arrivals: &[f64]| arrivals.iter().copied().fold(f64::INFINITY, f64::min);
        // Where crews go changes while they walk, as the fire grows, but is slower than they are.
        for _ in 0..8 {
            let Some(goal) = forecast.end_of_fire(first(&arrivals), from) else { return Vec::new() };
            let walk_m = |crew: &Crew| (goal - DVec2::new(crew.x_m, crew.y_m)).length();
            let arrival = |crew: &Crew| crew.at_s + walk_m(crew) / crew.speed_mps;
            arrivals = self.crews.iter().map(arrival).collect();
        }
        let landscape = self.spread.landscape();
        let rate_mps = |time_s: f64, place: DVec2| {
            let fuel = landscape.frame.cell_at(place).map_or(0, |cell| landscape.fuel_number(cell));
            let crews = self.crews.iter().zip(&arrivals).filter(|&(_, &arrival_s)| arrival_s <= time_s);
            crews.map(|(crew, _)| crew.rate_mps(fuel)).sum()
        };
        let most_mps = self.crews.iter().map(Crew::most_mps).sum();
        let (start_s, until_s) = (first(&arrivals), self.until.as_seconds());
        let offset_m = if policy == LinePolicy::Parallel { offset_m } else { 0.0 };
        LineTask { start_s, rate_mps: &rate_mps, most_mps, until_s }
            .along_front(forecast, from, offset_m)
            .cells(forecast)
    }
}

/// Decides where the line is when the first crew sets out, and schedules its cells.
pub fn plan_line(
    clock: Res<SimClock>,
    mut queue: ResMut<SimQueue>,
    fires: Res<Fires>,
    orders: Option<Res<CrewOrders>>,
) {
    let Some(orders) = orders else { return };
    while queue.take(clock.0, Rank::Line).is_some() {
        if !fires.model.is_under_way() && fires.field.burning().len() == 0 {
            queue.push(clock.0 + LOOK_AGAIN, Due::Line);
            continue;
        }
        for line in orders.0.cells(&forecast(&fires, &queue, orders.0.until, orders.0.seed)) {
            let (along_mm, holds) = ((1000.0 * line.along_m).round() as u32, orders.0.holds(&line));
            let clear = CellEvent::Clear { cell: line.cell, flank: line.flank as u8, along_mm, holds };
            queue.push(SimTime::from_seconds(line.time_s).max(clock.0), Due::Cell(clear));
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
