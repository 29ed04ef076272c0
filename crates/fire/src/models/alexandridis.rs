//! The automaton of Alexandridis, Vakalis, Siettos and Bafas, "A cellular automata model for forest fire spread prediction:
//! The case of the wildfire that swept through Spetses Island in 1990", Applied Mathematics and Computation 204, 2008.
//!
//! A cell that burns tries once to set each of its eight neighbours on fire, a step after it caught fire itself, and is
//! burned then. It succeeds with the probability `p0 (1 + vegetation) (1 + density) wind slope`, at most 1, where
//!
//! - `wind = exp(V (c1 + c2 (cos t - 1)))`, V the wind in m/s, t the angle between where it blows and where the fire goes;
//! - `slope = exp(a s)`, s the slope from the one cell to the other in degrees, negative downhill.
//!
//! Every cell keeps the phase in which it caught fire, so that no clock ticks for all; where all is lit at once these are the
//! steps of the paper. Tries are drawn by a hash of the cell, its episode and the direction, see [`Chance`]. A step has no
//! physical length: that is the scenario's to say.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::chance::Chance;
use crate::{
    Arrival, FireChange, FireEvent, FireEvents, FireField, FireModel, Landscape, Relief, Spread, SpreadBy, Weather,
};
use wildfire_base::geometry::{Cell, ops};
use wildfire_base::time::SimTime;

/// The neighbours in the order of cell index. A direction's number is part of what its chance is drawn from.
const DIRECTIONS: [(i32, i32); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];

/// The kinds of vegetation of the paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Vegetation {
    Agricultural,
    #[default]
    Thickets,
    Pine,
}

impl Vegetation {
    /// Returns what it adds to 1.
    pub fn part(self) -> f64 {
        match self {
            Self::Agricultural => -0.3,
            Self::Thickets => 0.0,
            Self::Pine => 0.4,
        }
    }
}

/// The densities of vegetation of the paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Density {
    Sparse,
    #[default]
    Normal,
    Dense,
}

impl Density {
    /// Returns what it adds to 1.
    pub fn part(self) -> f64 {
        match self {
            Self::Sparse => -0.4,
            Self::Normal => 0.0,
            Self::Dense => 0.3,
        }
    }
}

/// The purpose of its chance.
const CHANCE: &str = "spread";

/// The paper's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlexandridisRules {
    /// The probability on level ground without wind.
    pub p0: f64,
    pub wind_c1: f64,
    pub wind_c2: f64,
    pub slope_a: f64,
    pub vegetation: Vegetation,
    pub density: Density,
    pub step: SimTime,
}

impl Default for AlexandridisRules {
    fn default() -> Self {
        let step = SimTime::from_seconds(10.0);
        let vegetation = Vegetation::default();
        let density = Density::default();
        Self { p0: 0.58, wind_c1: 0.045, wind_c2: 0.131, slope_a: 0.078, vegetation, density, step }
    }
}

impl AlexandridisRules {
    /// Returns the factor of a wind on a fire that goes along the unit vector `toward`.
    pub fn wind_factor(&self, wind_mps: DVec2, toward: DVec2) -> f64 {
        let speed = ops::hypot(wind_mps.x, wind_mps.y);
        let along = wind_mps.x * toward.x + wind_mps.y * toward.y;
        ops::exp(self.wind_c1 * speed + self.wind_c2 * (along - speed))
    }

    /// Returns the factor of a slope that rises by `rise_m` over a horizontal distance.
    pub fn slope_factor(&self, rise_m: f64, distance_m: f64) -> f64 {
        ops::exp(self.slope_a * (ops::atan(rise_m / distance_m) * (180.0 / PI)))
    }

    /// Returns the probability that a try succeeds.
    pub fn probability(&self, wind: f64, slope: f64) -> f64 {
        (self.p0 * (1.0 + self.vegetation.part()) * (1.0 + self.density.part()) * wind * slope).clamp(0.0, 1.0)
    }
}

/// The automaton on one landscape, in one weather and one run.
#[derive(Clone, Debug)]
pub struct Alexandridis {
    landscape: Arc<Landscape>,
    weather: Arc<Weather>,
    rules: AlexandridisRules,
    chance: Chance,
    /// By interval of the weather: the factor of the wind in each direction.
    wind_factors: Vec<[f64; 8]>,
    /// The factor of the slope in each direction, where it is the same everywhere.
    slope_factors: Option<[f64; 8]>,
}

impl Alexandridis {
    /// Creates the automaton. Of the landscape it takes the relief, as which cells can burn is the field's to say; of the
    /// weather the wind.
    pub fn new(landscape: Arc<Landscape>, weather: Arc<Weather>, rules: AlexandridisRules, seed: u64) -> Self {
        let factors = |wind_mps: DVec2| {
            DIRECTIONS.map(|(cols, rows)| {
                let toward = DVec2::new(f64::from(cols), f64::from(rows));
                rules.wind_factor(wind_mps, toward / length(toward))
            })
        };
        let wind_factors = weather.intervals().iter().map(|interval| factors(interval.wind_mps)).collect();
        let on_plane = |gradient: DVec2| {
            DIRECTIONS.map(|(cols, rows)| {
                let way = DVec2::new(f64::from(cols), f64::from(rows));
                rules.slope_factor(gradient.x * way.x + gradient.y * way.y, length(way))
            })
        };
        // On a plane they depend on the direction alone.
        let slope_factors = match landscape.relief {
            Relief::Plane(gradient) => Some(on_plane(gradient)),
            Relief::Elevation(_) | Relief::Gradient(_) => None,
        };
        let chance = Chance::new(seed, CHANCE);
        Self { landscape, weather, rules, chance, wind_factors, slope_factors }
    }

    /// Returns the probability that a cell sets its neighbour in a direction on fire at a time.
    pub fn probability(&self, from: Cell, direction: usize, to: Cell, now: SimTime) -> f64 {
        let interval = self.weather.interval_at(now);
        let wind = match self.weather.wind_field(interval) {
            None => self.wind_factors[interval][direction],
            Some(field) => {
                let (cols, rows) = DIRECTIONS[direction];
                let toward = DVec2::new(f64::from(cols), f64::from(rows));
                self.rules.wind_factor(field.at(self.landscape.frame.index(from)), toward / length(toward))
            }
        };
        let slope = self.slope_factors.map_or_else(|| self.slope_factor(from, to), |factors| factors[direction]);
        self.rules.probability(wind, slope)
    }

    fn slope_factor(&self, from: Cell, to: Cell) -> f64 {
        let frame = &self.landscape.frame;
        let way = frame.centre(to) - frame.centre(from);
        let rise_m = match &self.landscape.relief {
            Relief::Elevation(elevations) => {
                f64::from(elevations[frame.index(to)]) - f64::from(elevations[frame.index(from)])
            }
            Relief::Plane(_) | Relief::Gradient(_) => {
                let gradient = (self.landscape.gradient(from) + self.landscape.gradient(to)) / 2.0;
                gradient.x * way.x + gradient.y * way.y
            }
        };
        self.rules.slope_factor(rise_m, length(way))
    }

    /// Returns the neighbours of a cell by cell index, each with the number of its direction.
    pub fn neighbours(&self, cell: Cell) -> impl Iterator<Item = (usize, Cell)> + '_ {
        let frame = self.landscape.frame;
        DIRECTIONS
            .iter()
            .enumerate()
            .filter_map(move |(direction, &(cols, rows))| frame.offset(cell, cols, rows).map(|to| (direction, to)))
    }

    /// Lets a fire burn by itself that begins in these cells, all lit at time 0, for at most this number of steps. Returns
    /// the last step in which a cell caught fire, 0 if none did.
    pub fn burn_alone(&self, fires: &mut FireField, ignited: &[Cell], steps: u32) -> u32 {
        let mut burning: Vec<Cell> = ignited.to_vec();
        burning.retain(|&cell| fires.ignite(cell, SimTime::ZERO, true).is_some());
        let (mut now, mut last_step) = (SimTime::ZERO, 0);
        for step in 1..=steps {
            now += self.rules.step;
            let mut caught = Vec::new();
            for from in burning {
                let episode = fires.episode(from);
                for (direction, to) in self.neighbours(from) {
                    if fires.can_burn(to) && self.succeeds(from, episode, direction, to, now) {
                        fires.ignite(to, now, false);
                        caught.push(to);
                    }
                }
                // A cell burns for one step and tries once.
                fires.burn_out(from);
            }
            if caught.is_empty() {
                break;
            }
            last_step = step;
            burning = caught;
        }
        last_step
    }

    /// Returns the same automaton with the chance of another run.
    pub fn with_seed(&self, seed: u64) -> Self {
        Self { chance: Chance::new(seed, CHANCE), ..self.clone() }
    }

    /// Says whether the try of a cell in a direction succeeds at a time.
    pub fn succeeds(&self, from: Cell, episode: u32, direction: usize, to: Cell, now: SimTime) -> bool {
        self.chance.uniform(from, episode, direction as u32) < self.probability(from, direction, to, now)
    }
}

fn length(v: DVec2) -> f64 {
    ops::hypot(v.x, v.y)
}

impl FireModel for Alexandridis {
    fn reseed(&mut self, seed: u64) {
        self.chance = Chance::new(seed, CHANCE);
    }

    /// An arrival names the cell that tries and its episode.
    fn follow(&mut self, fires: &FireField, now: SimTime, change: FireChange, expected: &mut FireEvents) {
        match change {
            FireChange::Ignited { cell, .. } => {
                let arrival = FireEvent::Arrival(Arrival { cell, revision: fires.episode(cell) });
                expected.push((now + self.rules.step, arrival));
            }
            FireChange::Wetted { cell, until } => expected.push((until, FireEvent::Dry { cell })),
            FireChange::Extinguished { .. } | FireChange::BurnedOut { .. } | FireChange::Dried { .. } => {}
        }
    }

    fn arrive(&mut self, fires: &FireField, now: SimTime, arrival: Arrival, expected: &mut FireEvents) -> Vec<Spread> {
        let Arrival { cell: from, revision: episode } = arrival;
        if !fires.goes_on(from, episode) {
            return Vec::new();
        }
        // It has tried once, and is burned: not before, or what comes first at one instant would matter.
        expected.push((now, FireEvent::BurnOut { cell: from, episode }));
        let tries = self
            .neighbours(from)
            .filter(|&(direction, to)| fires.can_burn(to) && self.succeeds(from, episode, direction, to, now));
        tries.map(|(_, cell)| Spread { cell, from, by: SpreadBy::Front }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::FuelMoisture;
    use wildfire_base::event_queue::EventQueue;
    use wildfire_base::geometry::{FieldFrame, compass};

    const FRAME: FieldFrame = FieldFrame { cols: 41, rows: 41, cell_m: 5.0 };
    const MIDDLE: Cell = Cell { col: 20, row: 20 };

    fn automaton(rules: AlexandridisRules, wind_mps: DVec2, relief: Relief, seed: u64) -> Alexandridis {
        let landscape = Landscape { relief, ..Landscape::uniform(FRAME, 102) };
        let weather = Weather::constant(wind_mps, FuelMoisture::default());
        Alexandridis::new(Arc::new(landscape), Arc::new(weather), rules, seed)
    }

    fn probabilities(automaton: &Alexandridis) -> Vec<f64> {
        let neighbours = automaton.neighbours(MIDDLE);
        neighbours.map(|(direction, to)| automaton.probability(MIDDLE, direction, to, SimTime::ZERO)).collect()
    }

    #[test]
    fn without_wind_and_slope_all_directions_are_alike() {
        let vegetation = Vegetation::Pine;
        let density = Density::Sparse;
        let rules = AlexandridisRules { vegetation, density, ..AlexandridisRules::default() };
        let found = probabilities(&automaton(rules, DVec2::ZERO, Relief::FLAT, 1));
        assert!(found.iter().all(|p| (p - 0.58 * 1.4 * 0.6).abs() < 1e-12), "{found:?}");
    }

    /// Reckoned from the formulas of the paper with angles.
    #[test]
    fn wind_and_slope_favour_their_direction_as_the_paper_says() {
        let rules = AlexandridisRules { p0: 0.2, ..AlexandridisRules::default() };
        let toward = |(cols, rows): (i32, i32)| DVec2::new(f64::from(cols), f64::from(rows));
        for azimuth in [0.0, 45.0, 100.0, 251.0] {
            let wind = compass::unit_toward(azimuth) * 6.0;
            let found = probabilities(&automaton(rules, wind, Relief::FLAT, 1));
            for (direction, p) in found.into_iter().enumerate() {
                let angle = (azimuth - compass::azimuth_deg(toward(DIRECTIONS[direction]))).to_radians();
                let expected = 0.2 * ops::exp(6.0 * (0.045 + 0.131 * (ops::cos(angle) - 1.0)));
                assert!((p - expected).abs() < 1e-12, "{azimuth} {direction}: {p}");
            }
        }
        // Ten degrees uphill to the east double the chance; across it changes nothing; a diagonal is less steep.
        let rise = ops::tan(PI / 18.0);
        let p = probabilities(&automaton(rules, DVec2::ZERO, Relief::Plane(DVec2::X * rise), 1));
        let [east, west, north, north_east] = [4, 3, 6, 7].map(|direction| p[direction] / 0.2);
        assert!((east - ops::exp(0.78)).abs() < 1e-12 && (west - ops::exp(-0.78)).abs() < 1e-12);
        let diagonal = ops::atan(rise / 2.0_f64.sqrt()).to_degrees();
        assert!((north - 1.0).abs() < 1e-12 && (north_east - ops::exp(0.078 * diagonal)).abs() < 1e-12);
    }

    #[test]
    fn one_slope_is_one_slope_whatever_layer_says_it() {
        let gradient = DVec2::new(0.25, -0.5);
        let elevation = |index| {
            let centre = FRAME.centre(FRAME.cell(index));
            (gradient.x * centre.x + gradient.y * centre.y) as f32
        };
        let count = FRAME.cell_count();
        let rules = AlexandridisRules::default();
        let plane = probabilities(&automaton(rules, DVec2::ZERO, Relief::Plane(gradient), 1));
        for relief in
            [Relief::Elevation((0..count).map(elevation).collect()), Relief::Gradient(vec![[0.25, -0.5]; count])]
        {
            let found = probabilities(&automaton(rules, DVec2::ZERO, relief, 1));
            assert!(found.iter().zip(&plane).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        }
    }

    fn field() -> FireField {
        let holes = |cell: &Cell| !(cell.col * 7 + cell.row * 3).is_multiple_of(11) || *cell == MIDDLE;
        FireField::new(FRAME, &[], false)
            .with_ground((0..FRAME.cell_count()).map(|index| FRAME.cell(index)).filter(holes))
    }

    /// Lets it burn by its events; with some the other way round, of those of one instant.
    fn burn_by_events(mut model: Alexandridis, fires: &mut FireField, is_reversed: bool) {
        let mut queue = EventQueue::default();
        let mut changes: Vec<FireChange> = fires.ignite(MIDDLE, SimTime::ZERO, true).into_iter().collect();
        let mut now = SimTime::ZERO;
        let mut number = 0;
        loop {
            let mut expected = Vec::new();
            for change in changes {
                model.follow(fires, now, change, &mut expected);
            }
            for (time, event) in expected {
                number += 1;
                queue.push(time, if is_reversed { -number } else { number }, event);
            }
            let Some((time, rank)) = queue.peek() else { return };
            now = time;
            let mut more = Vec::new();
            changes = match queue.pop_due(time, rank).expect("it was just seen") {
                FireEvent::Arrival(arrival) => {
                    let spreads = model.arrive(fires, now, arrival, &mut more);
                    spreads.into_iter().filter_map(|spread| fires.ignite(spread.cell, now, false)).collect()
                }
                FireEvent::BurnOut { cell, episode } => {
                    assert!(fires.goes_on(cell, episode));
                    vec![fires.burn_out(cell)]
                }
                FireEvent::Dry { .. } => unreachable!("nothing is wet"),
            };
            for (time, event) in more {
                queue.push(time, 0, event);
            }
        }
    }

    #[test]
    fn events_in_any_order_give_the_fire_of_the_steps() {
        for seed in 0..20 {
            let rules = AlexandridisRules { p0: 0.35, ..AlexandridisRules::default() };
            let model = automaton(rules, DVec2::new(3.0, 1.0), Relief::Plane(DVec2::new(0.0, 0.1)), seed);
            let mut by_steps = field();
            let last_step = model.burn_alone(&mut by_steps, &[MIDDLE], u32::MAX);
            for is_reversed in [false, true] {
                let mut by_events = field();
                burn_by_events(model.clone(), &mut by_events, is_reversed);
                let mut last = SimTime::ZERO;
                for index in 0..FRAME.cell_count() {
                    let cell = FRAME.cell(index);
                    assert_eq!(by_events.state(cell), by_steps.state(cell), "{cell}");
                    let arrival = by_events.ignited_at(cell);
                    assert_eq!(arrival, by_steps.ignited_at(cell), "{cell}");
                    last = last.max(arrival.unwrap_or(SimTime::ZERO));
                }
                assert_eq!(last, SimTime::from_seconds(10.0 * f64::from(last_step)));
            }
        }
    }

    fn area(fires: &FireField) -> usize {
        (0..FRAME.cell_count()).filter(|&index| fires.ignited_at(FRAME.cell(index)).is_some()).count()
    }

    #[test]
    fn certain_and_impossible_spread_burn_all_and_nothing() {
        for (p0, steps, expected) in [(0.0, 100, 1), (1.0, 20, 41 * 41), (1.0, 19, 39 * 39), (1.0, 0, 1)] {
            let rules = AlexandridisRules { p0, ..AlexandridisRules::default() };
            let mut fires =
                FireField::new(FRAME, &[], false).with_ground((0..FRAME.cell_count()).map(|index| FRAME.cell(index)));
            automaton(rules, DVec2::ZERO, Relief::FLAT, 3).burn_alone(&mut fires, &[MIDDLE], steps);
            assert_eq!(area(&fires), expected, "p0 {p0}, {steps} steps");
        }
    }

    #[test]
    fn likelier_spread_burns_no_cell_less_with_the_same_luck() {
        for seed in 0..30 {
            let areas: Vec<usize> = [0.15, 0.25, 0.35, 0.5, 0.8]
                .into_iter()
                .map(|p0| {
                    let rules = AlexandridisRules { p0, ..AlexandridisRules::default() };
                    let mut fires = field();
                    automaton(rules, DVec2::ZERO, Relief::FLAT, seed).burn_alone(&mut fires, &[MIDDLE], u32::MAX);
                    area(&fires)
                })
                .collect();
            assert!(areas.is_sorted(), "{seed}: {areas:?}");
        }
    }

    #[test]
    fn another_seed_is_another_fire_and_the_same_one_the_same() {
        let fire = |seed| {
            let mut fires = field();
            let model =
                automaton(AlexandridisRules { p0: 0.3, ..AlexandridisRules::default() }, DVec2::ZERO, Relief::FLAT, 0);
            model.with_seed(seed).burn_alone(&mut fires, &[MIDDLE], u32::MAX);
            (0..FRAME.cell_count()).map(|index| fires.ignited_at(FRAME.cell(index))).collect::<Vec<_>>()
        };
        assert_eq!(fire(1), fire(1));
        assert_ne!(fire(1), fire(2));
    }
}
