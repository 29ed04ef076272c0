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
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, ops};
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_fire::line::{Forecast, LineTask};
use wildfire_fire::surface::{flame_length_m, surface_fire};
use wildfire_fire::{FireChange, FireEvent, FireField};
use wildfire_timeline::SpreadSetting;

use super::fire::Fires;
use super::queue::{CellEvent, Due, Rank, SimClock, SimQueue};
use super::schedule::{Pass, SimSystems};

/// Crews look again after this time if nothing burns.
const LOOK_AGAIN: SimTime = SimTime::from_nanos(60_000_000_000);

/// The plugin in which crews decide where to build line.
#[derive(Debug)]
pub struct LinePlugin;

impl Plugin for LinePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Pass, plan_line.in_set(SimSystems::Crews));
    }
}

/// The line of a run: who builds it, and its cells.
#[derive(Resource, Clone, Debug, Default)]
pub struct FireLine {
    orders: Option<Arc<Orders>>,
    /// By cell index: the flank, and the number of the section on it.
    sections: BTreeMap<u32, (usize, u64)>,
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
    /// Creates the orders of a run; those of one without crews are empty.
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
        let times = self.orders.as_ref()?.crews.iter().map(|crew| SimTime::from_seconds(crew.at_s));
        times.min()
    }

    /// Lists the cells of line that fire crosses because of a change: one beside it caught fire, or was cleared beside
    /// flames.
    pub fn lost_by(&self, change: FireChange, now: SimTime, fires: &FireField) -> Vec<Cell> {
        let Some(orders) = self.orders.as_ref().filter(|orders| orders.settings.holds == LineHolds::Flame) else {
            return Vec::new();
        };
        let around = |cell: Cell| {
            let steps = (-1..=1).flat_map(|cols| (-1..=1).map(move |rows| (cols, rows)));
            let frame = *fires.frame();
            steps.filter_map(move |(cols, rows)| frame.offset(cell, cols, rows))
        };
        let is_lost = |line: Cell, from: Cell| {
            let section = self.sections.get(&(fires.frame().index(line) as u32));
            section.is_some_and(|&section| orders.is_crossed(section, line, from, now))
        };
        match change {
            FireChange::Ignited { cell, .. } => {
                around(cell).filter(|&line| fires.is_cleared(line) && is_lost(line, cell)).collect()
            }
            FireChange::Wetted { cell, .. } if fires.is_cleared(cell) => {
                let is_crossed = around(cell).any(|near| fires.is_burning(near) && is_lost(cell, near));
                is_crossed.then_some(cell).into_iter().collect()
            }
            _ => Vec::new(),
        }
    }
}

impl Orders {
    /// Draws if line holds against fire that comes from a cell. The chance that it does falls with the flame length as a
    /// logistic function, as Mees, Strauss and Chase, "Modeling wildland fire containment with uncertain flame length and
    /// fireline width", 1993, have it; what is drawn belongs to the section, so that more or smaller cells do not change it.
    fn is_crossed(&self, (flank, section): (usize, u64), line: Cell, from: Cell, now: SimTime) -> bool {
        let SpreadSetting::Rothermel { landscape, weather, rules } = &self.spread else { return false };
        let Some(fire) = surface_fire(landscape, weather, &rules.options, from, now) else { return false };
        let frame = &landscape.frame;
        let way = frame.centre(line) - frame.centre(from);
        let flame_m = flame_length_m(fire.intensity_kw_m(fire.front_normal_rate_mps(way)));
        let LineSettings { flame_half_m, flame_scale_m, .. } = self.settings;
        let holds = 1.0 / (1.0 + ops::exp((flame_m - flame_half_m) / flame_scale_m));
        rng::stream(self.seed, &format!("line/{flank}/{section}")).random::<f64>() >= holds
    }

    /// Computes when which cell is finished, on which flank and after how much line.
    fn line(&self, forecast: &Forecast) -> Option<Vec<wildfire_fire::line::LineCell>> {
        let settings = &self.settings;
        let centre = DVec2::new(settings.x_m, settings.y_m);
        // Where crews go changes while they walk, as the fire grows.
        let mut start_s = self.crews.iter().map(|crew| crew.at_s).fold(f64::INFINITY, f64::min);
        let mut arrivals: Vec<f64> = Vec::new();
        for _ in 0..WALKS {
            let goal = match settings.policy {
                LinePolicy::PointProtection => centre,
                _ => forecast.end_of_fire(start_s, settings.tactic())?,
            };
            let walk_s = |crew: &Crew| (goal - crew.start()).length() / crew.speed_mps;
            arrivals = self.crews.iter().map(|crew| crew.at_s + walk_s(crew)).collect();
            start_s = arrivals.iter().copied().fold(f64::INFINITY, f64::min).max(start_s);
        }
        let landscape = self.spread.landscape();
        let rate_mps = |time_s: f64, place: DVec2| {
            let fuel = landscape.frame.cell_at(place).map_or(0, |cell| landscape.fuel_number(cell));
            let crews = self.crews.iter().zip(&arrivals).filter(|&(_, &arrival_s)| arrival_s <= time_s);
            crews.map(|(crew, _)| crew.rate_mps(fuel)).sum()
        };
        let most_mps = self.crews.iter().map(Crew::most_mps).sum();
        let task = LineTask { start_s, rate_mps: &rate_mps, most_mps, until_s: self.until.as_seconds() };
        let line = match settings.policy {
            LinePolicy::Direct => task.along_front(forecast, settings.tactic(), 0.0),
            LinePolicy::Parallel => task.along_front(forecast, settings.tactic(), settings.offset_m),
            LinePolicy::PointProtection => {
                let first = self.crews.iter().zip(&arrivals).min_by(|a, b| a.1.total_cmp(b.1));
                task.around(forecast, centre, settings.half_m, first.map_or(centre, |(crew, _)| crew.start()))
            }
        };
        Some(line.cells(forecast))
    }
}

/// Rounds of a walk to an end of the fire that moves; it is slower than people, or they do not get there.
const WALKS: u32 = 8;

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
        for cell in orders.line(&forecast).into_iter().flatten() {
            let along_mm = (1000.0 * cell.along_m).round() as u32;
            let clear = CellEvent::Clear { cell: cell.cell, flank: cell.flank as u8, along_mm };
            queue.push(SimTime::from_seconds(cell.time_s).max(clock.0), Due::Cell(clear));
            let section = (cell.along_m / orders.settings.section_m) as u64;
            line.sections.insert(forecast.frame.index(cell.cell) as u32, (cell.flank, section));
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
        for change in changes {
            model.follow(&field, now, change, &mut expected);
        }
        expected.into_iter().for_each(|(time, event)| queue.push(time, Due::Fire(event)));
    }
    let frame: FieldFrame = *field.frame();
    let arrivals = (0..frame.cell_count()).map(|index| field.ignited_at(frame.cell(index)));
    Forecast { frame, seconds: arrivals.map(|time| time.map_or(f64::INFINITY, SimTime::as_seconds)).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::load;
    use wildfire_timeline::{GroundFact, Timeline};

    fn run(changes: &[&str]) -> Timeline {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let scenario = load("line", &changes).expect("the changes are possible");
        crate::run(&scenario, 1).expect("it can be run").timeline
    }

    fn count(timeline: &Timeline, is_counted: impl Fn(GroundFact) -> bool) -> usize {
        timeline.ground.iter().filter(|event| is_counted(event.fact)).count()
    }

    fn burned(timeline: &Timeline) -> usize {
        count(timeline, |fact| matches!(fact, GroundFact::Ignited(_)))
    }

    #[test]
    fn a_line_that_closes_contains_the_fire() {
        let free = run(&["crew.0.count=0"]);
        let changes: [&[&str]; 3] =
            [&[], &["line.policy=\"parallel\"", "line.offset_m=15"], &["line.from=\"head\"", "crew.0.count=8"]];
        for changes in changes {
            let fought = run(&[changes, &["line.holds=\"always\""]].concat());
            assert!(4 * burned(&fought) < burned(&free), "{changes:?}: {} of {}", burned(&fought), burned(&free));
            assert!(fought.end_time() < free.end_time(), "nothing is left to burn");
        }
    }

    #[test]
    fn a_square_is_protected_on_all_sides() {
        let changes = ["line.policy=\"point-protection\"", "line.x_m=400", "line.y_m=350", "line.half_m=40"];
        let timeline = run(&[&changes[..], &["line.holds=\"always\"", "duration_s=30000"]].concat());
        let frame = timeline.setting.frame;
        let within = |cell: Cell| (frame.centre(cell) - DVec2::new(400.0, 350.0)).abs().max_element() < 35.0;
        let is_burned = |fact| matches!(fact, GroundFact::Ignited(_));
        assert!(timeline.ground.iter().all(|event| !is_burned(event.fact) || !within(event.cell)));
        assert!(burned(&timeline) > 10_000, "the fire goes round it");
    }

    #[test]
    fn crews_without_a_rate_change_nothing() {
        let idle = run(&["crew.0.rate_m_h=0"]);
        assert_eq!(idle.ground, run(&["crew.0.count=0"]).ground);
        assert_eq!(count(&idle, |fact| matches!(fact, GroundFact::Cleared { .. })), 0);
    }

    #[test]
    fn line_is_lost_where_flames_are_too_long_and_the_same_in_every_run() {
        let lost = |timeline: &Timeline| count(timeline, |fact| fact == GroundFact::LineLost);
        let longest = ["line.flame_half_m=0.1", "line.policy=\"parallel\""];
        let timeline = run(&longest);
        assert!(lost(&timeline) > 0);
        assert_eq!(timeline, run(&longest));
        assert_eq!(lost(&run(&["line.flame_half_m=50", "line.policy=\"parallel\""])), 0);
        assert!(burned(&timeline) > burned(&run(&["line.policy=\"parallel\"", "line.holds=\"always\""])));
    }

    #[test]
    fn crews_need_a_fire_with_a_front() {
        let refused = load("line", &["fire.model=\"radius\"".to_owned()]).expect_err("it has no front");
        assert!(refused.to_string().contains("crew"), "{refused}");
        let unknown = load("line", &["crew.0.rate_by_fuel.GR22=3".to_owned()]).expect_err("there is no such fuel");
        assert!(unknown.to_string().contains("rate_by_fuel.GR22"), "{unknown}");
    }
}
