//! Crews that build line: where, from a forecast of the fire, and where it does not hold.
//!
//! When the first crew sets out, the fire is forecast from its state by its own model, as if nobody fought it, with other
//! embers than those that will fly; a custom policy is shown that forecast and answers points. The line follows from that at
//! once ([`wildfire_fire::line`]), and its cells become unburnable one by one as they are finished. What burns by then, as the
//! forecast was wrong, stays a gap.

use std::f64::consts::PI;
use std::sync::Arc;

use bevy_ecs::prelude::*;
use rand::RngExt;

use wildfire_base::geometry::{DVec2, ops};
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_fire::line::{Forecast, LineCell, LineTask, places_along};
use wildfire_fire::surface::{flame_length_m, surface_fire};
use wildfire_fire::{FireChange, FireEvent, FireField};
use wildfire_scenario::{Crew, LineHolds, LinePolicy, LineSettings, ProtectedPlace, Scenario};
use wildfire_timeline::SpreadSetting;

use super::agent::Agent;
use super::fire::Fires;
use super::policies::{AgentView, FirelineContext, Observation, PolicySet};
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

/// A line to build through points, on two flanks from one place.
struct Planned {
    flanks: [Vec<DVec2>; 2],
    /// Nobody begins it later than this.
    latest_s: f64,
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
    /// Draws if line holds against the fire that is expected there. The chance of a kilometre falls with the flame length
    /// as a logistic function, after Mees, Strauss and Chase, "Modeling wildland fire containment with uncertain flame
    /// length and fireline width", 1993; sections hold independently, so that of a shorter one is the higher. What is drawn
    /// belongs to a section, so that more or smaller cells do not change it.
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
        let kilometre = 1.0 / (1.0 + ops::exp((flame_m - flame_half_m) / flame_scale_m));
        let chance = ops::pow(kilometre, section_m / 1000.0);
        let section = (line.along_m / section_m) as u64;
        rng::stream(self.seed, &format!("line/{}/{section}", line.flank)).random::<f64>() < chance
    }

    /// Computes when which cell is finished.
    fn cells(&self, forecast: &Forecast, seen: &Observation<'_>, following: &mut PolicySet) -> Vec<LineCell> {
        let LineSettings { policy, offset_m, protect, .. } = &self.settings;
        let lines = match policy {
            LinePolicy::Direct => return self.along_front(forecast, seen.now, 0.0),
            LinePolicy::Parallel => return self.along_front(forecast, seen.now, *offset_m),
            LinePolicy::PointProtection => {
                let mut lines: Vec<Planned> = protect.iter().filter_map(|place| round(forecast, place)).collect();
                // Where the fire comes first the line has to be there first.
                lines.sort_by(|one, other| one.latest_s.total_cmp(&other.latest_s));
                lines
            }
            LinePolicy::Policy(_) => {
                let wind_mps = self.spread.weather().at(seen.now).wind_mps;
                let points = following.ask_for_line(seen, &FirelineContext { crews: &self.crews, wind_mps, forecast });
                let flanks = [from_fuel(points, seen.fires), Vec::new()];
                vec![Planned { flanks, latest_s: f64::INFINITY }]
            }
        };
        self.along_points(forecast, seen, &lines)
    }

    /// Computes the line beside the front; nothing if the fire has no end to begin at.
    fn along_front(&self, forecast: &Forecast, now: SimTime, offset_m: f64) -> Vec<LineCell> {
        let from = self.settings.from;
        // Crews that were there before the fire wait for it.
        let set_out = |crew: &Crew| crew.at_s.max(now.as_seconds());
        let mut arrivals: Vec<f64> = self.crews.iter().map(set_out).collect();
        let first = |arrivals: &[f64]| arrivals.iter().copied().fold(f64::INFINITY, f64::min);
        // Where crews go changes while they walk, as the fire grows, but is slower than they are.
        for _ in 0..8 {
            let Some(goal) = forecast.end_of_fire(first(&arrivals), from) else { return Vec::new() };
            let arrives = |crew: &Crew| {
                let walk_m = (goal - DVec2::new(crew.x_m, crew.y_m)).length();
                set_out(crew) + walk_m / crew.speed_mps
            };
            arrivals = self.crews.iter().map(arrives).collect();
        }
        let rate_mps = |time_s: f64, place: DVec2| self.rate_mps(&arrivals, time_s, place);
        self.task(first(&arrivals), &rate_mps).along_front(forecast, from, offset_m).cells(forecast)
    }

    /// Computes lines that crews build one after the other. Who would come after a line's end goes to the next at once.
    fn along_points(&self, forecast: &Forecast, seen: &Observation<'_>, lines: &[Planned]) -> Vec<LineCell> {
        let frame = &forecast.frame;
        let now_s = seen.now.as_seconds();
        // When crews are free, and where.
        let mut crews: Vec<(f64, DVec2)> =
            self.crews.iter().map(|crew| (crew.at_s.max(now_s), DVec2::new(crew.x_m, crew.y_m))).collect();
        let mut cells = Vec::new();
        for (number, Planned { flanks: [one, other], latest_s }) in lines.iter().enumerate() {
            let Some(&begin) = one.first() else { continue };
            let walk_s = |place: DVec2, crew: &Crew| (begin - place).length() / crew.speed_mps;
            let arrivals: Vec<f64> =
                crews.iter().zip(&self.crews).map(|(&(free_s, place), crew)| free_s + walk_s(place, crew)).collect();
            // A crew that builds nothing on any ground does not begin a line.
            let builders = arrivals.iter().zip(&self.crews).filter(|(_, crew)| crew.max_mps() > 0.0);
            let start_s = builders.fold(f64::INFINITY, |first, (&arrival_s, _)| first.min(arrival_s));
            // Crews would come when the line is no longer of use: they stay free for the next one.
            if start_s >= *latest_s {
                continue;
            }
            let rate_mps =
                |time_s, place| if has_fuel(seen.fires, place) { self.rate_mps(&arrivals, time_s, place) } else { 0.0 };
            let line = self.task(start_s, &rate_mps).along_points([one, other], frame);
            let ends = line.flanks.iter().filter_map(|flank| flank.last());
            let Some(&(end_s, end, _)) = ends.max_by(|one, other| one.0.total_cmp(&other.0)) else { continue };
            // Who arrives after the end has not moved.
            let builders = crews.iter_mut().zip(&arrivals).filter(|(_, arrival_s)| **arrival_s <= end_s);
            builders.for_each(|(crew, _)| *crew = (end_s, end));
            cells.extend(
                line.cells(forecast).into_iter().map(|cell| LineCell { flank: cell.flank + 2 * number, ..cell }),
            );
        }
        cells
    }

    /// Returns the length of line that those who have arrived by a time build in a second.
    fn rate_mps(&self, arrivals: &[f64], time_s: f64, place: DVec2) -> f64 {
        let landscape = self.spread.landscape();
        let fuel = landscape.frame.cell_at(place).map_or(0, |cell| landscape.fuel_number(cell));
        let crews = self.crews.iter().zip(arrivals).filter(|&(_, &arrival_s)| arrival_s <= time_s);
        crews.map(|(crew, _)| crew.rate_mps(fuel)).sum()
    }

    fn task<'a>(&self, start_s: f64, rate_mps: &'a dyn Fn(f64, DVec2) -> f64) -> LineTask<'a> {
        let max_mps = self.crews.iter().map(Crew::max_mps).sum();
        LineTask { start_s, rate_mps, max_mps, until_s: self.until.as_seconds() }
    }
}

/// Plans a line round a place from where the fire comes first, to both sides; `None` where it never comes.
fn round(forecast: &Forecast, place: &ProtectedPlace) -> Option<Planned> {
    let frame = &forecast.frame;
    // Bounded, as cells may be tiny.
    let half = (PI * place.radius_m / frame.cell_m).ceil().clamp(4.0, 20_000.0) as usize;
    let corner = |number: usize| {
        let (sin, cos) = ops::sin_cos(PI * number as f64 / half as f64);
        DVec2::new(place.x_m, place.y_m) + place.radius_m * DVec2::new(cos, sin)
    };
    let comes_s =
        |number: usize| frame.cell_at(corner(number)).map_or(f64::INFINITY, |cell| forecast.seconds[frame.index(cell)]);
    let first = (0..2 * half).min_by(|&one, &other| comes_s(one).total_cmp(&comes_s(other)))?;
    let flanks =
        [(first..=first + half).map(corner).collect(), (first + half..=first + 2 * half).rev().map(corner).collect()];
    let latest_s = comes_s(first);
    latest_s.is_finite().then_some(Planned { flanks, latest_s })
}

fn has_fuel(fires: &FireField, place: DVec2) -> bool {
    fires.frame().cell_at(place).is_some_and(|cell| fires.kind(cell).is_some())
}

/// Leaves out the beginning of a polyline that is on ground without fuel, such as a road from which it starts.
fn from_fuel(points: Vec<DVec2>, fires: &FireField) -> Vec<DVec2> {
    let (frame, burns) = (fires.frame(), |place: &DVec2| has_fuel(fires, *place));
    let on_leg = |leg: usize| places_along(&points[leg..points.len().min(leg + 2)], frame.cell_m / 4.0).find(burns);
    let begin = (0..points.len()).find_map(|leg| Some((leg, on_leg(leg)?)));
    begin.map_or(Vec::new(), |(leg, place)| [&[place], &points[leg + 1..]].concat())
}

/// Decides where the line is when the first crew sets out, and schedules its cells.
pub fn plan_line(
    clock: Res<SimClock>,
    mut queue: ResMut<SimQueue>,
    fires: Res<Fires>,
    orders: Option<Res<CrewOrders>>,
    mut following: ResMut<PolicySet>,
    agents: Query<&Agent>,
) {
    let Some(orders) = orders else { return };
    while queue.take(clock.0, Rank::Line).is_some() {
        // Without a fire there is no front to build along.
        if !fires.model.is_under_way() && fires.field.burning().len() == 0 {
            queue.push(clock.0 + LOOK_AGAIN, Due::Line);
            continue;
        }
        let forecast = forecast(&fires, &queue, orders.0.until, orders.0.seed);
        let mut agents: Vec<AgentView> = agents.iter().map(|agent| agent.view(clock.0)).collect();
        // Queries promise no order, and policies are shown agents by name.
        agents.sort_by_key(|agent| agent.id);
        let seen = Observation { now: clock.0, fires: &fires.field, agents: &agents, options_of: &|_| Vec::new() };
        for line in orders.0.cells(&forecast, &seen, &mut following) {
            let along_mm = (1000.0 * line.along_m).round() as u32;
            let holds = orders.0.holds(&line);
            // A cell that burns before it is finished is a gap, and does not count as lost line.
            if !holds && forecast.seconds[forecast.frame.index(line.cell)] <= line.time_s {
                continue;
            }
            let clear = CellEvent::Clear { cell: line.cell, flank: line.flank as u8, along_mm, holds };
            queue.push(SimTime::from_seconds(line.time_s).max(clock.0), Due::Cell(clear));
        }
    }
}

/// Lets a copy of the fire burn on by itself.
fn forecast(fires: &Fires, queue: &SimQueue, until: SimTime, seed: u64) -> Forecast {
    let Fires { mut field, mut model, .. } = fires.clone();
    let mut queue = queue.clone();
    // Crews must not know where embers will fall: the forecast draws other numbers.
    model.reseed(rng::key(seed, "line/forecast"));
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
            // Agents and crews are left out: it is the fire's future without them.
            _ => Vec::new(),
        };
        changes.into_iter().for_each(|change| model.follow(&field, now, change, &mut expected));
        expected.into_iter().for_each(|(time, event)| queue.push(time, Due::Fire(event)));
    }
    let frame = *field.frame();
    let arrivals = (0..frame.cell_count()).map(|index| field.ignited_at(frame.cell(index)));
    Forecast { frame, seconds: arrivals.map(|time| time.map_or(f64::INFINITY, SimTime::as_seconds)).collect() }
}
