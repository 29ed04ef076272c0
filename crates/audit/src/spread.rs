//! Fire that goes over ground and bushes: what can burn does, where fire comes and when it comes there, and ends in time.
//!
//! Facts are followed one after the other as far as they concern the states of cells. When fire spreads to a cell is then
//! found again from when it came to the cells around ([`super::arrival`]): no cell may catch fire earlier or later than
//! that, nor be spared. A truck can only make fire come later. So where trucks put out or wetted something near a cell,
//! what was due at the cell before must have happened before.

use super::arrival::{Arrivals, CellChange, FireHistory};
use super::automaton::audit_automaton;
use super::cell_log::{CellLog, Change, ChangeKind, changes_in_order};
use super::characteristic::{self, straight_arrival};
use super::ember::audit_embers;
use super::violation::first_violation;
use super::{Violation, ViolationKind};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_timeline::{Cause, FlamingTimes, Setting, SpreadSetting, Timeline};

/// Two answers for one time, added up and rounded in other ways.
const SAME_TIME: SimTime = SimTime::from_nanos(20);

/// Looks at changes around cells near which trucks were at work, and at pairs of changes of one cell, which one run may
/// take.
const MAX_LOOKS: u64 = 2_000_000_000;

/// The state of a cell, as this check follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FollowedCell {
    Intact,
    /// It burns out by itself then; [`SimTime::MAX`] if never.
    Burning {
        until: SimTime,
    },
    BurnedOut,
    Extinguished,
}

/// Holds the fires of a run over ground against its rules; returns the first violation.
pub fn audit_spread(timeline: &Timeline) -> Result<(), Violation> {
    let setting = &timeline.setting;
    let Some(spread) = &setting.spread else { return Ok(()) };
    let changes = changes_in_order(timeline);
    let mut states = States::new(setting, spread);
    let followed = changes.iter().try_for_each(|change| states.follow(change));
    // What is still burning at the end must not be overdue.
    let followed = followed.and_then(|()| states.finish(timeline.end_time()));
    let log = CellLog::new(setting, &changes);
    let end = timeline.end_time();
    let busiest = log.cells().max_by_key(|of_cell| of_cell.len()).and_then(<[Change]>::first);
    let pairs: u64 = log.cells().map(|of_cell| (of_cell.len() as u64).pow(2)).sum();
    // Checks below look at pairs of changes of a cell, so a forged recording could make them endless.
    if let Some(busiest) = busiest.filter(|_| pairs > MAX_LOOKS) {
        return Err(busiest.violation(setting, ViolationKind::Endless));
    }
    match spread {
        SpreadSetting::Rothermel { landscape, weather, rules } => {
            let arrivals = Arrivals::new(landscape, weather, *rules);
            let came = ArrivalCheck::new(setting, arrivals, &changes, end).check();
            let flew = audit_embers(setting, landscape, weather, rules, &log, end);
            // All are done before the first is picked, as the violation that came first in time explains the rest.
            first_violation([followed, came, flew].into_iter())
        }
        SpreadSetting::Alexandridis { landscape, weather, rules } => {
            let tried = audit_automaton(setting, landscape, weather, *rules, &log, end);
            first_violation([followed, tried].into_iter())
        }
    }
}

/// Follows all cells through a run.
struct States<'a> {
    setting: &'a Setting,
    flaming: FlamingTimes,
    /// The time for which water lasts, where there is any.
    wet: Option<SimTime>,
    has_embers: bool,
    /// By cell index.
    is_bush: Vec<bool>,
    has_fuel: Vec<bool>,
    states: Vec<FollowedCell>,
    wet_until: Vec<SimTime>,
}

impl<'a> States<'a> {
    fn new(setting: &'a Setting, spread: &SpreadSetting) -> Self {
        let frame = setting.frame;
        let cells = frame.cell_count();
        let mut is_bush = vec![false; cells];
        setting.bushes.iter().for_each(|&bush| is_bush[frame.index(bush)] = true);
        let has_fuel = (0..cells).map(|index| is_bush[index] || setting.is_ground(frame.cell(index))).collect();
        let (wet, has_embers) = match spread {
            SpreadSetting::Rothermel { rules, .. } => (Some(rules.wet), rules.embers.is_some()),
            SpreadSetting::Alexandridis { .. } => (None, false),
        };
        Self {
            setting,
            flaming: spread.flaming_times(),
            wet,
            has_embers,
            is_bush,
            has_fuel,
            states: vec![FollowedCell::Intact; cells],
            wet_until: vec![SimTime::ZERO; cells],
        }
    }

    fn follow(&mut self, change: &Change) -> Result<(), Violation> {
        let index = self.setting.frame.index(change.cell);
        let next = self.next_state(index, change).map_err(|kind| change.violation(self.setting, kind))?;
        self.states[index] = next;
        Ok(())
    }

    /// Ground burns out without a word, a bush with a fact of its own.
    fn state_at(&self, index: usize, time: SimTime) -> FollowedCell {
        match self.states[index] {
            FollowedCell::Burning { until } if until < time && !self.is_bush[index] => FollowedCell::BurnedOut,
            state => state,
        }
    }

    fn next_state(&mut self, index: usize, change: &Change) -> Result<FollowedCell, ViolationKind> {
        let &Change { time, cell, what } = change;
        let reignition = self.setting.rules.reignition;
        match (what, self.state_at(index, time)) {
            // Whatever comes next, the burning out before it is missing.
            (_, FollowedCell::Burning { until }) if until < time => {
                Err(ViolationKind::WrongBurnOut { cell, due: Some(until) })
            }
            (ChangeKind::Ignited(Cause::Spotted(from)), _) if !self.has_embers => {
                Err(ViolationKind::NoSource { cell, from })
            }
            (ChangeKind::Ignited(_), state) => {
                let is_left = state == FollowedCell::Intact || reignition && state == FollowedCell::Extinguished;
                if !is_left || !self.has_fuel[index] || self.wet_until[index] > time {
                    return Err(ViolationKind::CannotBurn { cell });
                }
                // Fuel without a time of flaming burns until it is put out.
                let until = self.flaming.burns_out_at(cell, time).unwrap_or(SimTime::MAX);
                Ok(FollowedCell::Burning { until })
            }
            // Later ones were caught above, so this one is too early, or never due.
            (ChangeKind::BurnedOut, FollowedCell::Burning { until }) if until != time => {
                let due = (until < SimTime::MAX).then_some(until);
                Err(ViolationKind::WrongBurnOut { cell, due })
            }
            (ChangeKind::Cleared { holds }, state) => {
                let is_left = state == FollowedCell::Intact || reignition && state == FollowedCell::Extinguished;
                // A gap in the line may be anywhere, as crews record what they found burning.
                if holds && !(is_left && self.has_fuel[index]) {
                    return Err(ViolationKind::WrongLine { cell });
                }
                // Cleared ground is like ground that never dries.
                self.wet_until[index] = if holds { SimTime::MAX } else { self.wet_until[index] };
                Ok(state)
            }
            (ChangeKind::BurnedOut, FollowedCell::Burning { .. }) => Ok(FollowedCell::BurnedOut),
            (ChangeKind::Extinguished { .. }, FollowedCell::Burning { .. }) => Ok(FollowedCell::Extinguished),
            (ChangeKind::BurnedOut | ChangeKind::Extinguished { .. }, _) => Err(ViolationKind::NotBurning { cell }),
            (ChangeKind::Wetted { until, .. }, state) => {
                let is_left = state == FollowedCell::Intact || reignition && state == FollowedCell::Extinguished;
                if !is_left || !self.has_fuel[index] || self.wet.is_none_or(|wet| until != time + wet) {
                    return Err(ViolationKind::WrongWater { cell });
                }
                // The later of both, as a cleared cell must not dry.
                self.wet_until[index] = self.wet_until[index].max(until);
                Ok(state)
            }
        }
    }

    /// Bushes that should have burned out by the end did.
    fn finish(&self, end: SimTime) -> Result<(), Violation> {
        let frame = self.setting.frame;
        let late = self.setting.bushes.iter().filter_map(|&cell| match self.states[frame.index(cell)] {
            FollowedCell::Burning { until } if until <= end => Some((until, cell)),
            _ => None,
        });
        let Some((due, cell)) = late.min_by_key(|&(due, _)| due) else { return Ok(()) };
        let kind = ViolationKind::WrongBurnOut { cell, due: Some(due) };
        Err(Violation { time: due, agent: None, place: frame.centre(cell), kind })
    }
}

/// A time in which a cell could catch fire.
#[derive(Clone, Copy, Debug)]
struct Wait {
    from: SimTime,
    until: SimTime,
    /// The cause by which the cell caught fire; `None` if the run was over before.
    by: Option<Cause>,
}

/// Checks for all cells that fire came to them when it was due.
struct ArrivalCheck<'a> {
    setting: &'a Setting,
    arrivals: Arrivals<'a>,
    history: FireHistory,
    end: SimTime,
    /// By cell index, the waits that ended with fire; in order of time.
    ignitions: Vec<(u32, SimTime, Cause)>,
    looks: u64,
}

impl<'a> ArrivalCheck<'a> {
    fn new(setting: &'a Setting, arrivals: Arrivals<'a>, changes: &[Change], end: SimTime) -> Self {
        let frame = setting.frame;
        let mut history = FireHistory::new(frame.cell_count(), setting.rules.reignition, arrivals.reach());
        let mut ignitions = Vec::new();
        for change in changes {
            let index = frame.index(change.cell);
            let what = match change.what {
                ChangeKind::Ignited(cause) => {
                    ignitions.push((index as u32, change.time, cause));
                    CellChange::Ignited { is_source: !matches!(cause, Cause::Spread(_)) }
                }
                ChangeKind::Extinguished { .. } => CellChange::Extinguished,
                ChangeKind::Wetted { until, .. } => CellChange::Wetted { until },
                // To a front a line is ground that never dries.
                ChangeKind::Cleared { holds: true } => CellChange::Wetted { until: SimTime::MAX },
                ChangeKind::BurnedOut | ChangeKind::Cleared { .. } => continue,
            };
            history.add(index, change.time, what);
        }
        history.mark_surroundings(frame);
        // They are in order of time, and the sort is stable.
        ignitions.sort_by_key(|ignition| ignition.0);
        Self { setting, arrivals, history, end, ignitions, looks: 0 }
    }

    /// Returns the first violation in time.
    fn check(mut self) -> Result<(), Violation> {
        let ignitions = std::mem::take(&mut self.ignitions);
        let straight = self.check_straight(&ignitions);
        let mut rest = &ignitions[..];
        let cells = 0..self.setting.frame.cell_count();
        let stepped = cells.map(|index| {
            let count = rest.iter().take_while(|ignition| ignition.0 as usize == index).count();
            let (of_cell, others) = rest.split_at(count);
            rest = others;
            self.check_cell(index, of_cell)
        });
        first_violation(stepped.chain([straight]))
    }

    /// Checks a part of the ignitions against fire that runs straight, where it does.
    fn check_straight(&self, ignitions: &[(u32, SimTime, Cause)]) -> Result<(), Violation> {
        let frame = self.setting.frame;
        if !self.arrivals.is_refined() {
            return Ok(());
        }
        let spread: Vec<_> = ignitions.iter().filter(|(_, _, cause)| matches!(cause, Cause::Spread(_))).collect();
        // Evenly spread over the field, and the same ones in every audit.
        let every = spread.len().div_ceil(characteristic::MAX_SAMPLES).max(1);
        first_violation(spread.into_iter().step_by(every).map(|&(index, time, _)| {
            let cell = frame.cell(index as usize);
            match straight_arrival(&self.arrivals, &self.history, cell, time) {
                Some(straight) if !straight.is_kept() => {
                    let kind = ViolationKind::NotStraight { cell, due: straight.due };
                    Err(Violation { time, agent: None, place: frame.centre(cell), kind })
                }
                _ => Ok(()),
            }
        }))
    }

    fn check_cell(&mut self, index: usize, ignitions: &[(u32, SimTime, Cause)]) -> Result<(), Violation> {
        // Most cells of a field with roads and water.
        if !self.arrivals.has_fuel(index) && ignitions.is_empty() {
            return Ok(());
        }
        let cell = self.setting.frame.cell(index);
        let reignition = self.setting.rules.reignition;
        let mut from = Some(SimTime::ZERO);
        for &(_, time, cause) in ignitions {
            // An ignition of what cannot burn is found where states are followed.
            let Some(start) = from.filter(|&start| start <= time) else { return Ok(()) };
            self.check_wait(cell, Wait { from: start, until: time, by: Some(cause) })?;
            let put_out = self
                .history
                .changes(index)
                .iter()
                .find(|&&(put_out, change)| change == CellChange::Extinguished && put_out >= time.as_nanos());
            // From then on the cell waits for fire again.
            from = put_out.filter(|_| reignition).map(|&(put_out, _)| SimTime::from_nanos(put_out));
        }
        let unburned = from.filter(|&start| start <= self.end);
        unburned.map_or(Ok(()), |from| self.check_wait(cell, Wait { from, until: self.end, by: None }))
    }

    fn check_wait(&mut self, cell: Cell, wait: Wait) -> Result<(), Violation> {
        let frame = self.setting.frame;
        let violation = |time, kind| Err(Violation { time, agent: None, place: frame.centre(cell), kind });
        let changes =
            self.history.cells_in_reach(frame, cell).map(|near| self.history.changes(frame.index(near)).len() as u64);
        let around: u64 = if self.history.is_eventful_near(frame.index(cell)) { changes.sum() } else { 0 };
        self.looks += around;
        // Before each change nearby the front must not have been due: afterwards that could no longer be seen.
        for disturbed in self.disturbances(cell, wait) {
            self.looks += around;
            if self.looks > MAX_LOOKS {
                return violation(disturbed, ViolationKind::Endless);
            }
            let due = self.earliest(cell, disturbed, None).0;
            if due + SAME_TIME < disturbed {
                return violation(due, ViolationKind::SparedByFront { cell, due });
            }
        }
        let parent = wait.by.and_then(|cause| if let Cause::Spread(from) = cause { Some(from) } else { None });
        // At the end itself an arrival still counts, so one nanosecond more.
        let before = if wait.by.is_some() { wait.until } else { wait.until + SimTime::from_nanos(1) };
        let (due, from_parent) = self.earliest(cell, before, parent);
        let is_early = wait.until + SAME_TIME < due;
        let is_late = due + SAME_TIME < wait.until;
        match (wait.by, parent) {
            (Some(_), Some(_)) if is_early || is_late => {
                let due = (due < SimTime::MAX).then_some(due);
                violation(wait.until.min(due.unwrap_or(wait.until)), ViolationKind::WrongArrival { cell, due })
            }
            // The time is right, but another cell's front brought it.
            (Some(_), Some(from)) if due + SAME_TIME < from_parent => {
                violation(wait.until, ViolationKind::NoSource { cell, from })
            }
            // An ember or a lighter may be earlier than the front, never later.
            (None, _) | (Some(_), None) if is_late => violation(due, ViolationKind::SparedByFront { cell, due }),
            _ => Ok(()),
        }
    }

    /// Returns when fire is due at a cell, as things are just before a time, and when from one neighbour.
    fn earliest(&mut self, cell: Cell, before: SimTime, parent: Option<Cell>) -> (SimTime, SimTime) {
        let earliest = self.arrivals.earliest(&self.history, cell, before, parent);
        (SimTime::from_nanos(earliest.time), SimTime::from_nanos(earliest.from_parent))
    }

    /// Returns when something in reach of a cell was put out or wetted while it could catch fire; each time once.
    fn disturbances(&self, cell: Cell, wait: Wait) -> Vec<SimTime> {
        let frame = self.setting.frame;
        if !self.history.is_eventful_near(frame.index(cell)) {
            return Vec::new();
        }
        let changes = self.history.cells_in_reach(frame, cell).flat_map(|near| self.history.changes(frame.index(near)));
        let disturbing = changes.filter(|(_, change)| !matches!(change, CellChange::Ignited { .. }));
        let mut times: Vec<SimTime> = disturbing.map(|&(time, _)| SimTime::from_nanos(time)).collect();
        times.retain(|&time| wait.from < time && time < wait.until);
        times.sort_unstable();
        times.dedup();
        times
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rand::{Rng, RngExt};

    use super::super::arrival::cells_within;
    use super::*;
    use wildfire_base::event_queue::EventQueue;
    use wildfire_base::geometry::{DVec2, FieldFrame};
    use wildfire_base::rng;
    use wildfire_base::vehicle::Dimensions;
    use wildfire_fire::embers::{EmberSettings, Embers};
    use wildfire_fire::models::{AlexandridisRules, Neighbours, RothermelRules};
    use wildfire_fire::surface::crown::{CrownMethod, CrownRules};
    use wildfire_fire::surface::{FuelMoisture, WindLimit};
    use wildfire_fire::{
        CanopyLayers, FireChange, FireEvent, FireField, Landscape, MoistureZones, Relief, SpreadBy, Weather,
        WeatherInterval, WindField,
    };
    use wildfire_timeline::{AgentId, AgentStart, Body, Event, Fact, FireFact, GroundEvent, GroundFact, Rules, sample};

    const TRUCK: AgentId = AgentId::unimog(0);
    const FRAME: FieldFrame = FieldFrame { cols: 60, rows: 45, cell_m: 5.0 };

    fn seconds(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds)
    }

    /// Grass with patches of shrubs and of nothing, a few bushes, a road with a gap, and wind that turns.
    fn setting(relief: Relief, neighbours: Neighbours, reignition: bool) -> Setting {
        let fuel = |index: usize| {
            let Cell { col, row } = FRAME.cell(index);
            let is_road = col + row == 62 && row != 30;
            match (col / 9 * 5 + row / 7 * 3) % 11 {
                _ if is_road => 91,
                0 => 145,
                1 if (col + row) % 5 == 0 => 0,
                _ => 104,
            }
        };
        let mut landscape =
            Landscape { fuel: (0..FRAME.cell_count()).map(fuel).collect(), relief, ..Landscape::uniform(FRAME, 0) };
        let bushes: Vec<Cell> = (0..FRAME.cell_count()).step_by(37).map(|index| FRAME.cell(index)).collect();
        bushes.iter().for_each(|&bush| landscape.fuel[FRAME.index(bush)] = 142);
        let weather = (0..6).map(|hour| WeatherInterval {
            from: seconds(400.0 * f64::from(hour)),
            wind_mps: DVec2::new(4.0 - f64::from(hour), f64::from(hour) - 2.0),
            moisture: FuelMoisture { d1: 0.04 + 0.01 * f64::from(hour), ..FuelMoisture::default() },
        });
        let plain = sample::small_setting(&[]);
        Setting {
            scenario: "ground".into(),
            frame: FRAME,
            bushes,
            agents: vec![AgentStart {
                id: TRUCK,
                pose: wildfire_base::geometry::Pose::new(20.0, 20.0, 0.0),
                body: Body::Truck(Dimensions::default()),
                limits: None,
            }],
            rules: Rules {
                duration: seconds(2400.0),
                extinguishes_all: Some(true),
                fire: None,
                reignition,
                ..plain.rules
            },
            spread: Some(SpreadSetting::Rothermel {
                landscape: Arc::new(landscape),
                weather: Arc::new(Weather::new(weather.collect()).expect("it is in order")),
                rules: RothermelRules { neighbours, burn_out: Some(seconds(90.0)), ..RothermelRules::default() },
            }),
            ..plain
        }
    }

    /// The same below trees: groves of all kinds, with clearings between them.
    fn with_trees(mut setting: Setting, method: CrownMethod) -> Setting {
        if let Some(SpreadSetting::Rothermel { landscape, rules, .. }) = &mut setting.spread {
            let cells = FRAME.cell_count();
            let layer = |of: fn(usize) -> u16| (0..cells).map(|index| of(index / 6 % 10)).collect();
            let (height, base): (Vec<u16>, Vec<u16>) =
                (layer(|grove| 20 * grove as u16), layer(|grove| 3 * grove as u16));
            let trees =
                CanopyLayers([height, base, layer(|grove| 4 + 5 * grove as u16), layer(|grove| 10 * grove as u16)]);
            *landscape = Arc::new(Landscape { canopy: Some(trees), ..Landscape::clone(landscape) });
            rules.crowns = Some(CrownRules { method, foliar_moisture: 0.9 });
        }
        setting
    }

    #[test]
    fn fires_in_crowns_are_accepted_and_those_of_other_crowns_are_not() {
        for relief in [Relief::FLAT, hill()] {
            for method in [CrownMethod::ScottReinhardt, CrownMethod::Rothermel] {
                let bare = setting(relief.clone(), Neighbours::ThirtyTwo, false);
                let timeline = burn(with_trees(bare.clone(), method), vec![(0.0, FireAction::Light(cell(25, 12)))]);
                assert!(timeline.ground.len() > 300, "{}", timeline.ground.len());
                assert_eq!(audit_spread(&timeline), Ok(()));
                let other = Timeline { setting: bare, ..timeline };
                assert!(audit_spread(&other).is_err());
            }
        }
    }

    /// The same with a wind of its own in every cell of some intervals.
    fn with_local_wind(mut setting: Setting) -> Setting {
        if let Some(SpreadSetting::Rothermel { weather, .. }) = &mut setting.spread {
            let mut fields = Vec::new();
            for (number, interval) in weather.intervals().iter().enumerate() {
                let winds = (0..FRAME.cell_count()).map(|index| {
                    let Cell { col, row } = FRAME.cell(index);
                    interval.wind_mps + DVec2::new(f64::from(row), -f64::from(col)) / 15.0
                });
                fields.push((number != 2).then(|| Arc::new(WindField::new(winds))));
            }
            *weather = Arc::new(Weather::clone(weather).with_wind_fields(fields));
        }
        setting
    }

    /// The same with moistures and factors on the rate of spread by cell, or by fuel.
    fn with_zones(mut setting: Setting, is_by_fuel: bool) -> Setting {
        if let Some(SpreadSetting::Rothermel { landscape, weather, .. }) = &mut setting.spread {
            let kind = |index: usize| {
                let Cell { col, row } = FRAME.cell(index);
                if is_by_fuel { u16::from(landscape.fuel[index]) } else { col / 5 + row / 8 }
            };
            let moistures = (0..FRAME.cell_count()).map(|index| {
                let moister = f64::from(kind(index) % 4) / 100.0;
                FuelMoisture { d1: 0.03 + moister, herb: 0.4 + 5.0 * moister, ..FuelMoisture::default() }
            });
            let zones = MoistureZones::new(moistures).expect("they are few");
            let rate_factors = (0..FRAME.cell_count()).map(|index| 600 + 300 * (kind(index) % 3)).collect();
            *weather = Arc::new(Weather::clone(weather).with_moisture_zones(zones));
            *landscape = Arc::new(Landscape { rate_factors, ..Landscape::clone(landscape) });
        }
        setting
    }

    #[test]
    fn fires_in_zones_are_accepted_and_those_of_other_zones_are_not() {
        let settings = EmberSettings { per_mj: 0.02, i_min_kw_m: 50.0, p_ign: 1.0, ..EmberSettings::default() };
        for relief in [Relief::FLAT, Relief::Plane(DVec2::new(0.3, -0.2)), hill()] {
            for is_by_fuel in [false, true] {
                let uniform = setting(relief.clone(), Neighbours::ThirtyTwo, true);
                let trees = with_trees(uniform.clone(), CrownMethod::ScottReinhardt);
                let windy = with_local_wind(uniform.clone());
                for other in [uniform, trees, windy] {
                    let timeline = burn(with_zones(other.clone(), is_by_fuel), acts());
                    assert!(timeline.ground.len() > 300, "{}", timeline.ground.len());
                    assert_eq!(audit_spread(&timeline), Ok(()));
                    assert!(audit_spread(&Timeline { setting: other, ..timeline }).is_err());
                }
                let mut spotted = setting(relief.clone(), Neighbours::Eight, false);
                let Some(SpreadSetting::Rothermel { rules, .. }) = &mut spotted.spread else { unreachable!() };
                rules.embers = Some(Embers { settings, seed: spotted.seed });
                assert_eq!(audit_spread(&burn(with_zones(spotted, is_by_fuel), acts())), Ok(()));
            }
        }
    }

    #[test]
    fn fires_in_wind_by_place_are_accepted_and_those_of_other_winds_are_not() {
        for relief in [Relief::FLAT, Relief::Plane(DVec2::new(0.3, -0.2)), hill()] {
            for neighbours in [Neighbours::ThirtyTwo, Neighbours::Eight] {
                let uniform = setting(relief.clone(), neighbours, true);
                let trees = with_trees(uniform.clone(), CrownMethod::ScottReinhardt);
                for uniform in [uniform, trees] {
                    let timeline = burn(with_local_wind(uniform.clone()), acts());
                    assert!(timeline.ground.len() > 300, "{}", timeline.ground.len());
                    assert_eq!(audit_spread(&timeline), Ok(()));
                    assert!(audit_spread(&Timeline { setting: uniform, ..timeline }).is_err());
                }
                let mut spotted = setting(relief.clone(), neighbours, false);
                let Some(SpreadSetting::Rothermel { rules, .. }) = &mut spotted.spread else { unreachable!() };
                let settings = EmberSettings { per_mj: 0.02, i_min_kw_m: 50.0, p_ign: 1.0, ..EmberSettings::default() };
                rules.embers = Some(Embers { settings, seed: spotted.seed });
                assert_eq!(audit_spread(&burn(with_local_wind(spotted), acts())), Ok(()));
            }
        }
    }

    fn hill() -> Relief {
        let height = |index: usize| {
            let x = f64::from(FRAME.cell(index).col) - 25.0;
            let y = f64::from(FRAME.cell(index).row) - 12.0;
            (40.0 / (1.0 + (x * x + y * y) / 150.0)) as f32
        };
        Relief::Elevation((0..FRAME.cell_count()).map(height).collect())
    }

    enum FireAction {
        Light(Cell),
        /// Puts out what burns in reach of one of the burning cells, and wets what does not.
        Stop(usize),
        Forecast(FireEvent),
    }

    /// Lets the fire model burn, with these acts at these seconds.
    fn burn(setting: Setting, acts: Vec<(f64, FireAction)>) -> Timeline {
        let spread = setting.spread.clone().expect("it was set");
        let wet = if let SpreadSetting::Rothermel { rules, .. } = &spread { rules.wet } else { SimTime::ZERO };
        let ground = (0..FRAME.cell_count()).map(|index| FRAME.cell(index)).filter(|&cell| setting.is_ground(cell));
        let mut fires = FireField::new(FRAME, &setting.bushes, setting.rules.reignition).with_ground(ground);
        let mut model = spread.model(setting.seed);
        let mut timeline = Timeline { setting, events: Vec::new(), ground: Vec::new() };
        let mut queue = EventQueue::default();
        for (time_s, act) in acts {
            queue.push(seconds(time_s), 0, act);
        }
        let end = timeline.setting.rules.duration;
        while let Some((now, _)) = queue.peek().filter(|&(now, _)| now <= end) {
            let mut expected = Vec::new();
            let mut changes: Vec<(FireChange, Option<ChangeKind>)> = Vec::new();
            match queue.pop_due(now, 0).expect("it was just seen") {
                FireAction::Light(cell) => {
                    let ignition = fires.ignite(cell, now, true);
                    changes.extend(ignition.map(|change| (change, Some(ChangeKind::Ignited(Cause::Scheduled)))));
                }
                FireAction::Stop(number) => {
                    let burning: Vec<Cell> = fires.burning().collect();
                    let centre = burning.get(number % burning.len().max(1));
                    for cell in centre.into_iter().flat_map(|&centre| cells_within(3, FRAME, centre)) {
                        let until = now + wet;
                        if fires.is_burning(cell) {
                            changes.push((fires.extinguish(cell), Some(ChangeKind::Extinguished { by: TRUCK })));
                        } else if wet > SimTime::ZERO
                            && let Some(change) = fires.wet(cell, until)
                        {
                            changes.push((change, Some(ChangeKind::Wetted { until, by: TRUCK })));
                        }
                    }
                }
                FireAction::Forecast(FireEvent::Arrival(arrival)) => {
                    for spread in model.arrive(&fires, now, arrival, &mut expected) {
                        let caught = fires.ignite(spread.cell, now, false);
                        let what = ChangeKind::Ignited(match spread.by {
                            SpreadBy::Front => Cause::Spread(spread.from),
                            SpreadBy::Ember => Cause::Spotted(spread.from),
                        });
                        changes.extend(caught.map(|change| (change, Some(what))));
                    }
                }
                FireAction::Forecast(FireEvent::BurnOut { cell, episode }) if fires.goes_on(cell, episode) => {
                    changes.push((fires.burn_out(cell), Some(ChangeKind::BurnedOut)));
                }
                FireAction::Forecast(FireEvent::BurnOut { .. }) => {}
                FireAction::Forecast(FireEvent::Dry { cell }) => {
                    changes.extend(fires.dry(cell, now).map(|change| (change, None)));
                }
            }
            for (change, what) in changes {
                model.follow(&fires, now, change, &mut expected);
                let Some(what) = what else { continue };
                record(&mut timeline, now, change.cell(), what);
            }
            for (time, event) in expected {
                queue.push(time, 0, FireAction::Forecast(event));
            }
        }
        timeline
    }

    fn record(timeline: &mut Timeline, time: SimTime, cell: Cell, what: ChangeKind) {
        let mut of_bush = |fact| timeline.events.push(Event { time, fact: Fact::Fire(fact) });
        let mut of_ground = |fact| timeline.ground.push(GroundEvent { time, cell, fact });
        match (timeline.setting.bush_index(cell).is_some(), what) {
            (true, ChangeKind::Ignited(cause)) => of_bush(FireFact::Ignited { cell, cause }),
            (true, ChangeKind::Extinguished { by }) => of_bush(FireFact::Extinguished { cell, by }),
            (true, ChangeKind::BurnedOut) => of_bush(FireFact::BurnedOut { cell }),
            (false, ChangeKind::Ignited(cause)) => of_ground(GroundFact::Ignited(cause)),
            (false, ChangeKind::Extinguished { by }) => of_ground(GroundFact::Extinguished { by }),
            (false, ChangeKind::BurnedOut) => {}
            (_, ChangeKind::Wetted { until, by }) => of_ground(GroundFact::Wetted { until, by }),
            (_, ChangeKind::Cleared { .. }) => unreachable!("there are no crews"),
        }
    }

    fn cell(col: u16, row: u16) -> Cell {
        Cell { col, row }
    }

    /// Two fires, eight stops at them, and a third fire.
    fn fought(relief: Relief, neighbours: Neighbours, reignition: bool) -> Timeline {
        burn(setting(relief, neighbours, reignition), acts())
    }

    fn acts() -> Vec<(f64, FireAction)> {
        let mut acts = vec![(0.0, FireAction::Light(cell(20, 20))), (350.0, FireAction::Light(cell(45, 30)))];
        acts.extend((0..8).map(|number| (300.0 + 150.0 * f64::from(number), FireAction::Stop(7 * number as usize))));
        acts.push((900.0, FireAction::Light(cell(20, 20))));
        acts
    }

    #[test]
    fn fires_of_the_model_keep_the_rules_whoever_fights_them() {
        for (neighbours, reignition) in [
            (Neighbours::ThirtyTwo, false),
            (Neighbours::ThirtyTwo, true),
            (Neighbours::Sixteen, true),
            (Neighbours::Eight, false),
        ] {
            for relief in [Relief::FLAT, Relief::Plane(DVec2::new(0.3, -0.2)), hill()] {
                let timeline = fought(relief, neighbours, reignition);
                let count =
                    |is: fn(&GroundFact) -> bool| timeline.ground.iter().filter(|event| is(&event.fact)).count();
                let ignited = count(|fact| matches!(fact, GroundFact::Ignited(_)));
                let put_out = count(|fact| matches!(fact, GroundFact::Extinguished { .. }));
                let wetted = count(|fact| matches!(fact, GroundFact::Wetted { .. }));
                println!("{neighbours:?} {reignition}: {ignited} caught fire, {put_out} put out, {wetted} wetted");
                assert!(ignited > 500 && put_out > 5 && wetted > 50);
                assert_eq!(audit_spread(&timeline), Ok(()));
            }
        }
    }

    /// Wind in which fires are up to eight times as long as wide, turning every few seconds, with everything that goes on
    /// as much faster.
    fn in_a_gale(mut timeline_setting: Setting) -> Timeline {
        const FASTER: f64 = 8.0;
        if let Some(SpreadSetting::Rothermel { weather, rules, .. }) = &mut timeline_setting.spread {
            let intervals = weather.intervals().iter().map(|interval| WeatherInterval {
                from: seconds(interval.from.as_seconds() / FASTER),
                wind_mps: 7.0 * interval.wind_mps,
                ..*interval
            });
            *weather = Arc::new(Weather::new(intervals.collect()).expect("it is in order"));
            rules.options.wind_limit = WindLimit::None;
            rules.wet = seconds(rules.wet.as_seconds() / FASTER);
        }
        burn(timeline_setting, acts().into_iter().map(|(time_s, act)| (time_s / FASTER, act)).collect())
    }

    #[test]
    fn narrow_fires_keep_the_rules_whoever_fights_them() {
        for neighbours in [Neighbours::ThirtyTwo, Neighbours::Eight] {
            for relief in [Relief::FLAT, Relief::Plane(DVec2::new(0.3, -0.2)), hill()] {
                let bare = setting(relief, neighbours, true);
                for setting in [with_trees(bare.clone(), CrownMethod::ScottReinhardt), bare] {
                    let timeline = in_a_gale(setting);
                    let wetted = timeline.ground.iter().filter(|event| matches!(event.fact, GroundFact::Wetted { .. }));
                    println!("{neighbours:?}: {} facts, {} wetted", timeline.ground.len(), wetted.clone().count());
                    assert!(timeline.ground.len() > 300 && wetted.count() > 20);
                    assert_eq!(audit_spread(&timeline), Ok(()));
                }
            }
        }
    }

    /// The same with embers.
    fn spotted(relief: Relief, reignition: bool) -> (Timeline, Vec<usize>) {
        let mut setting = setting(relief, Neighbours::ThirtyTwo, reignition);
        let Some(SpreadSetting::Rothermel { rules, .. }) = &mut setting.spread else { unreachable!("it was set so") };
        let settings = EmberSettings { per_mj: 0.02, i_min_kw_m: 50.0, p_ign: 1.0, ..EmberSettings::default() };
        rules.embers = Some(Embers { settings, seed: setting.seed });
        let timeline = burn(setting, acts());
        let is_spotted = |event: &GroundEvent| matches!(event.fact, GroundFact::Ignited(Cause::Spotted(_)));
        let places = (0..timeline.ground.len()).filter(|&place| is_spotted(&timeline.ground[place])).collect();
        (timeline, places)
    }

    /// Lets the automaton burn with everything else as it is.
    fn by_automaton(relief: Relief, reignition: bool, p0: f64) -> Timeline {
        let mut setting = setting(relief, Neighbours::ThirtyTwo, reignition);
        let Some(SpreadSetting::Rothermel { landscape, weather, .. }) = setting.spread.take() else {
            unreachable!("it was set so")
        };
        let rules = AlexandridisRules { p0, ..AlexandridisRules::default() };
        setting.spread = Some(SpreadSetting::Alexandridis { landscape, weather, rules });
        // Each a millisecond later than a multiple of the step away from every other: what comes first at one instant is for
        // the simulation to say.
        let acts = acts().into_iter().zip(1..).map(|((time_s, act), n)| (time_s / 5.0 + 0.001 * f64::from(n), act));
        burn(setting, acts.collect())
    }

    #[test]
    fn every_try_of_the_automaton_is_drawn_again() {
        for relief in [Relief::FLAT, hill()] {
            for reignition in [false, true] {
                let timeline = by_automaton(relief.clone(), reignition, 0.8);
                println!("{} facts of ground", timeline.ground.len());
                assert!(timeline.ground.len() > 300);
                assert_eq!(audit_spread(&timeline), Ok(()));
            }
            let proper = by_automaton(relief, false, 0.8);
            let places = caught(&proper);
            for &place in places.iter().step_by(places.len() / 20) {
                let mut without = proper.clone();
                without.ground.remove(place);
                assert!(audit_spread(&without).is_err());
                let mut late = proper.clone();
                late.ground[place].time += SimTime::from_nanos(1000);
                late.ground.sort_by_key(|event| event.time);
                assert!(audit_spread(&late).is_err());
            }
            let mut luckier = proper;
            luckier.setting.seed += 1;
            assert!(audit_spread(&luckier).is_err());
        }
    }

    #[test]
    fn fires_by_embers_are_those_of_the_draws() {
        for relief in [Relief::FLAT, hill()] {
            for reignition in [false, true] {
                let (timeline, places) = spotted(relief.clone(), reignition);
                println!("{} of {} by embers", places.len(), timeline.ground.len());
                assert!(places.len() > 5);
                assert_eq!(audit_spread(&timeline), Ok(()));
            }
            let (proper, places) = spotted(relief, false);
            for &place in &places[..5] {
                let alter = |alter: &dyn Fn(&mut GroundEvent)| {
                    let mut timeline = proper.clone();
                    alter(&mut timeline.ground[place]);
                    timeline.ground.sort_by_key(|event| event.time);
                    audit_spread(&timeline)
                };
                assert_eq!(alter(&|_| {}), Ok(()));
                assert!(alter(&|event| event.time += SimTime::from_nanos(1000)).is_err());
                assert!(alter(&|event| event.fact = GroundFact::Ignited(Cause::Spotted(event.cell))).is_err());
                let mut without = proper.clone();
                without.ground.remove(place);
                assert!(audit_spread(&without).is_err());
            }
        }
    }

    /// The places of ground that fire spread to, well before the end.
    fn caught(timeline: &Timeline) -> Vec<usize> {
        let before_end = timeline.end_time().as_nanos() - 1_000_000;
        let is_caught = |event: &GroundEvent| {
            matches!(event.fact, GroundFact::Ignited(Cause::Spread(_))) && event.time.as_nanos() < before_end
        };
        (0..timeline.ground.len()).filter(|&place| is_caught(&timeline.ground[place])).collect()
    }

    /// Alters some ignition in `tries` copies of a proper run, by chance; each must be found.
    fn assert_found(tries: usize, mut alter: impl FnMut(&mut Timeline, usize, &mut dyn Rng) -> bool) {
        let mut rng = rng::stream(3, "audit/spread/tests");
        for relief in [Relief::FLAT, hill()] {
            let proper = fought(relief, Neighbours::ThirtyTwo, false);
            let caught = caught(&proper);
            let mut altered = 0;
            while altered < tries {
                let mut timeline = proper.clone();
                let place = caught[rng.random_range(0..caught.len())];
                if !alter(&mut timeline, place, &mut rng) {
                    continue;
                }
                timeline.ground.sort_by_key(|event| event.time);
                altered += 1;
                let event = proper.ground[place];
                assert!(audit_spread(&timeline).is_err(), "{event:?} was altered, and nothing is found");
            }
        }
    }

    #[test]
    fn fire_between_two_cells_that_touch_at_a_corner_is_found() {
        for neighbours in [Neighbours::Eight, Neighbours::Sixteen, Neighbours::ThirtyTwo] {
            // A diamond of road about the fire, whose cells touch at corners only.
            let mut setting = Setting { bushes: Vec::new(), ..setting(Relief::FLAT, neighbours, false) };
            let Some(SpreadSetting::Rothermel { landscape, .. }) = &mut setting.spread else { unreachable!() };
            let steps = |cell: Cell| cell.col.abs_diff(20) + cell.row.abs_diff(20);
            let fuel = (0..FRAME.cell_count()).map(|index| if steps(FRAME.cell(index)) == 6 { 91 } else { 104 });
            *landscape = Arc::new(Landscape { fuel: fuel.collect(), ..Landscape::clone(landscape) });
            let proper = burn(setting, vec![(0.0, FireAction::Light(cell(20, 20)))]);
            assert_eq!((audit_spread(&proper), proper.ground.len()), (Ok(()), 61));
            for event in proper.ground.iter().filter(|event| steps(event.cell) == 5) {
                let [col, row] = [event.cell.col, event.cell.row].map(|at| if at >= 20 { at + 1 } else { at - 1 });
                let mut crossed = proper.clone();
                let fact = GroundFact::Ignited(Cause::Spread(event.cell));
                crossed.ground.push(GroundEvent { time: event.time + seconds(20.0), cell: cell(col, row), fact });
                crossed.ground.sort_by_key(|event| event.time);
                assert!(audit_spread(&crossed).is_err(), "{neighbours:?}: {event:?} went on between two corners");
            }
        }
    }

    #[test]
    fn an_ignition_a_microsecond_off_is_found() {
        assert_found(20, |timeline, place, _| {
            let time = &mut timeline.ground[place].time;
            *time += SimTime::from_nanos(1000);
            true
        });
        assert_found(20, |timeline, place, _| {
            let time = &mut timeline.ground[place].time;
            *time = time.since(SimTime::from_nanos(1000));
            true
        });
    }

    #[test]
    fn an_ignition_that_is_left_out_is_found() {
        assert_found(20, |timeline, place, _| {
            timeline.ground.remove(place);
            true
        });
    }

    #[test]
    fn an_ignition_from_nowhere_is_found() {
        assert_found(20, |timeline, place, rng| {
            let burned: Vec<Cell> = timeline.ground.iter().map(|event| event.cell).collect();
            let cell = FRAME.cell(rng.random_range(0..FRAME.cell_count()));
            let GroundEvent { time, cell: near, .. } = timeline.ground[place];
            let fact = GroundFact::Ignited(Cause::Spread(near));
            timeline.ground.push(GroundEvent { time: time + seconds(0.5), cell, fact });
            timeline.setting.is_ground(cell) && !burned.contains(&cell)
        });
    }

    #[test]
    fn an_ignition_from_another_cell_is_found() {
        assert_found(20, |timeline, place, rng| {
            let GroundEvent { time, cell, fact } = timeline.ground[place];
            let near: Vec<Cell> = cells_within(3, FRAME, cell).filter(|&near| near != cell).collect();
            let other = near[rng.random_range(0..near.len())];
            timeline.ground[place].fact = GroundFact::Ignited(Cause::Spread(other));
            let burned = timeline.ground.iter().any(|event| event.cell == other && event.time < time);
            burned && fact != timeline.ground[place].fact
        });
    }

    #[test]
    fn embers_where_none_fly_and_water_that_lasts_otherwise_are_found() {
        let proper = fought(Relief::FLAT, Neighbours::ThirtyTwo, true);
        let place = caught(&proper)[40];
        let mut spotted = proper.clone();
        let GroundFact::Ignited(Cause::Spread(from)) = spotted.ground[place].fact else {
            unreachable!("it was caught")
        };
        spotted.ground[place].fact = GroundFact::Ignited(Cause::Spotted(from));
        assert!(audit_spread(&spotted).is_err());
        let mut water = proper.clone();
        let wetted = water.ground.iter_mut().find_map(|event| match &mut event.fact {
            GroundFact::Wetted { until, .. } => Some(until),
            _ => None,
        });
        let until = wetted.expect("something was wetted");
        *until += SimTime::from_nanos(1);
        assert!(matches!(audit_spread(&water), Err(Violation { kind: ViolationKind::WrongWater { .. }, .. })));
        let mut late = proper;
        let burned_out =
            late.events.iter_mut().find(|event| matches!(event.fact, Fact::Fire(FireFact::BurnedOut { .. })));
        burned_out.expect("a bush burned out").time += SimTime::from_nanos(1);
        late.events.sort_by_key(|event| event.time);
        assert!(matches!(audit_spread(&late), Err(Violation { kind: ViolationKind::WrongBurnOut { .. }, .. })));
    }
}
