//! When fire comes to a cell by Rothermel's equations, found again from when it came to the cells around.
//!
//! All that the fire model decides is decided here again, by a code of its own and without a queue: for one cell, and the
//! recorded times of those around it, the earliest of its candidates. Rates, ellipses and flaming times are those of
//! [`wildfire_fire::surface`]; which cells are neighbours, what lies on the straight line from one to the other, and the
//! first fire from between two of them are found here.
//!
//! - A straight line from a burned neighbour takes the sum, over the cells that it crosses, of each one's time for it by
//!   its part of the length. What cannot burn blocks it, and so do two such cells at a corner that it goes through.
//! - Between two neighbours whose directions are next to each other time is taken to be linear. The least of its value and
//!   of the way from there is on the wave through both, at right angles to it in the metric of the ellipse.
//! - Where only the wind differs from place to place among the cells of a fuel, a line of up to three columns and rows over one
//!   fuel takes the mean of the times that the weather at its two ends gives.
//! - Moistures and factors on the rate of spread that differ from place to place are those of each cell.
//! - A cell that did not catch fire from another one sends fire straight to all cells within three, over one fuel.
//! - Over a cell that is wet, or was put out and may burn again, a way begins when that is over, and only if the cell
//!   where it begins flames still; it takes no part in what comes from between.
//!
//! World frame, metres; times are nanoseconds inside, as sums of them are what is compared.

use std::collections::BTreeMap;

use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::models::{DirectionSet, RothermelRules, sampled_cells};
use wildfire_fire::surface::crown::model_10;
use wildfire_fire::surface::{Ellipse, FuelBed, twenty_foot_wind, unsheltered_adjustment};
use wildfire_fire::{Landscape, Relief, Weather};

use crate::crown::{self, UnderCanopy};

/// Later than any time.
pub const NEVER: u64 = u64::MAX;

const NANOS: f64 = 1e9;

/// The longest line, in columns or rows, for which its ends stand.
const MAX_SMOOTH: i32 = 3;

/// Ellipses that are kept at least, where every cell has its own.
const MIN_KEPT: usize = 1 << 12;

/// A change of a cell that its state follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CellChange {
    /// It catches fire; a source does not catch it from a front.
    Ignited {
        is_source: bool,
    },
    Extinguished,
    Wetted {
        until: SimTime,
    },
}

/// The changes of all cells.
#[derive(Debug)]
pub struct FireHistory {
    reignition: bool,
    /// Cells, in columns or rows, beyond which nothing concerns a cell but a source.
    reach: i32,
    /// The same of sources.
    source_reach: i32,
    /// By cell index: when it first caught fire.
    first: Vec<u64>,
    /// By cell index: whether that was from a front.
    is_source: Vec<bool>,
    /// All changes of cells that do not just catch fire once, in order of time.
    more: BTreeMap<u32, Vec<(u64, CellChange)>>,
    /// By cell index: whether it is one of those, and whether one of those is in reach.
    has_more: Vec<bool>,
    is_near_more: Vec<bool>,
    /// By cell index: whether a source is in reach.
    is_near_source: Vec<bool>,
}

/// A cell just before some time.
#[derive(Clone, Copy, Debug)]
struct CellBefore {
    /// When it caught fire, if that counts.
    ignited: u64,
    is_source: bool,
    /// From when on fire may pass over it; [`NEVER`] if it may not.
    open_from: u64,
}

impl FireHistory {
    /// Creates the history of cells of which none burns yet.
    pub fn new(cells: usize, reignition: bool, [reach, source_reach]: [i32; 2]) -> Self {
        let no = vec![false; cells];
        Self {
            reignition,
            reach,
            source_reach,
            first: vec![NEVER; cells],
            is_source: no.clone(),
            more: BTreeMap::new(),
            has_more: no.clone(),
            is_near_more: no.clone(),
            is_near_source: no,
        }
    }

    /// Adds a change, not before those that were added before.
    pub fn add(&mut self, index: usize, time: SimTime, change: CellChange) {
        let nanos = time.as_nanos();
        // Nearly all cells burn once: their lists would take most of the memory, so these have none.
        if let CellChange::Ignited { is_source } = change
            && !self.has_more[index]
            && self.first[index] == NEVER
        {
            (self.first[index], self.is_source[index]) = (nanos, is_source);
            return;
        }
        let first = self.first[index];
        let is_source = self.is_source[index];
        let list = self.more.entry(index as u32).or_insert_with(|| {
            (first != NEVER).then_some((first, CellChange::Ignited { is_source })).into_iter().collect()
        });
        list.push((nanos, change));
        self.has_more[index] = true;
    }

    /// Marks what has a source in reach, or a cell that does not just catch fire once; after the last change.
    pub fn mark_surroundings(&mut self, frame: FieldFrame) {
        let sources = self.is_source.iter().enumerate().filter(|&(_, &is_source)| is_source).map(|(index, _)| index);
        for near in sources.flat_map(|index| cells_within(self.source_reach, frame, frame.cell(index))) {
            self.is_near_source[frame.index(near)] = true;
        }
        for (&index, changes) in &self.more {
            let is_source = changes.iter().any(|(_, change)| *change == CellChange::Ignited { is_source: true });
            for near in cells_within(self.reach, frame, frame.cell(index as usize)) {
                self.is_near_more[frame.index(near)] = true;
            }
            for near in cells_within(self.source_reach, frame, frame.cell(index as usize)).filter(|_| is_source) {
                self.is_near_source[frame.index(near)] = true;
            }
        }
    }

    /// Says whether something happened in reach of a cell besides cells that caught fire once.
    pub fn is_eventful_near(&self, index: usize) -> bool {
        self.is_near_more[index]
    }

    /// Returns when a front came to a cell that did nothing else than burn; `None` if it did not.
    pub fn first_front(&self, index: usize) -> Option<u64> {
        (self.first[index] != NEVER && !self.is_source[index]).then_some(self.first[index])
    }

    /// Says whether nothing happened to a cell but that a front may have come to it.
    pub fn is_front_or_unburned(&self, index: usize) -> bool {
        !self.has_more[index] && !self.is_source[index]
    }

    /// Iterates over the cells that may concern a cell, itself among them.
    pub fn cells_in_reach(&self, frame: FieldFrame, cell: Cell) -> impl Iterator<Item = Cell> + use<> {
        cells_within(self.reach, frame, cell)
    }

    /// The changes of a cell that does not just catch fire once.
    pub fn changes(&self, index: usize) -> &[(u64, CellChange)] {
        if self.has_more[index] { &self.more[&(index as u32)] } else { &[] }
    }

    /// Returns a cell as it is after all its changes before a time.
    fn cell_before(&self, index: usize, before: u64) -> CellBefore {
        // The state of such a cell needs no list to be replayed.
        if !self.has_more[index] {
            let ignited = if self.first[index] < before { self.first[index] } else { NEVER };
            return CellBefore { ignited, is_source: self.is_source[index], open_from: 0 };
        }
        let mut state = CellBefore { ignited: NEVER, is_source: false, open_from: 0 };
        for &(time, change) in self.changes(index).iter().take_while(|(time, _)| *time < before) {
            match change {
                CellChange::Ignited { is_source } => (state.ignited, state.is_source) = (time, is_source),
                // A later wetting never shortens an earlier one.
                CellChange::Wetted { until } => state.open_from = state.open_from.max(until.as_nanos()),
                CellChange::Extinguished => {
                    state.ignited = NEVER;
                    // Without reignition what was put out never burns again.
                    state.open_from = if self.reignition { state.open_from.max(time) } else { NEVER };
                }
            }
        }
        state
    }
}

/// Cells within `reach` columns and rows of a cell, itself included.
pub fn cells_within(reach: i32, frame: FieldFrame, cell: Cell) -> impl Iterator<Item = Cell> {
    let offsets = (-reach..=reach).flat_map(move |rows| (-reach..=reach).map(move |cols| (cols, rows)));
    offsets.filter_map(move |(cols, rows)| frame.offset(cell, cols, rows))
}

/// The straight line from a neighbour to a cell, whose offset is zero.
#[derive(Clone, Debug)]
struct StraightLine {
    /// From the cell to where the line begins.
    cols: i32,
    rows: i32,
    /// Along the line, in metres.
    v: DVec2,
    /// The offsets of all cells on it, with their parts of its length.
    crossed: Vec<((i32, i32), f64)>,
    /// The offsets of the two cells beside each corner that it goes through.
    corners: Vec<[(i32, i32); 2]>,
}

impl StraightLine {
    fn new(cols: i32, rows: i32, cell_m: f64) -> Self {
        // It leaves columns (rows) at odd parts of twice their number; written in parts of all of them.
        let whole = 2 * cols.abs().max(1) * rows.abs().max(1);
        let mut cuts = vec![0, whole];
        let leaves = |count: i32| (0..count).map(move |number| (2 * number + 1) * whole / (2 * count));
        cuts.extend(leaves(cols.abs()).chain(leaves(rows.abs())));
        cuts.sort_unstable();
        let at = |part: f64| (f64::from(cols) * (1.0 - part), f64::from(rows) * (1.0 - part));
        let corners = cuts.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| {
            let (x, y) = at(f64::from(pair[0]) / f64::from(whole));
            let [west, east] = [x.floor() as i32, x.floor() as i32 + 1];
            let [south, north] = [y.floor() as i32, y.floor() as i32 + 1];
            // A line that rises goes from the south-west to the north-east of the corner, or back.
            if cols * rows > 0 { [(west, north), (east, south)] } else { [(west, south), (east, north)] }
        });
        let corners = corners.collect();
        // A corner cuts twice at one place: between such cuts there is no stretch of a cell.
        cuts.dedup();
        let crossed = cuts.windows(2).map(|pair| {
            let (x, y) = at(f64::from(pair[0] + pair[1]) / f64::from(2 * whole));
            let cell = ((x + 0.5).floor() as i32, (y + 0.5).floor() as i32);
            (cell, f64::from(pair[1] - pair[0]) / f64::from(whole))
        });
        let v = DVec2::new(-f64::from(cols), -f64::from(rows)) * cell_m;
        Self { cols, rows, v, crossed: crossed.collect(), corners }
    }
}

/// The kinds of ground on a line to a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
enum GroundAlong {
    Barrier,
    /// Several fuels.
    Mixed,
    /// The fuel of the cell alone.
    OneFuel,
}

/// A line from a cell that burned, as it counts for another.
#[derive(Clone, Copy, Debug)]
struct EdgeArrival {
    line: usize,
    index: usize,
    time: u64,
}

/// The earliest arrival at a cell, and the earliest from one neighbour; [`NEVER`] if there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarliestArrival {
    pub time: u64,
    pub from_parent: u64,
}

/// The lines of some intervals of the weather.
#[derive(Debug)]
struct LineSet {
    directions: DirectionSet,
    /// Numbers of lines; neighbours in this list are neighbours in direction.
    lines: Vec<usize>,
    /// By number of a line, whether it is one of them.
    is_taken: Vec<bool>,
    /// By number of a line round a cell, whether it is one of them.
    is_of_disc: Vec<bool>,
}

/// Finds arrivals on one landscape in one weather.
#[derive(Debug)]
pub struct Arrivals<'a> {
    frame: FieldFrame,
    landscape: &'a Landscape,
    weather: &'a Weather,
    rules: RothermelRules,
    models: Vec<FuelModel>,
    /// By cell index: the place of its fuel among the models.
    fuel: Vec<Option<u8>>,
    /// By cell index: whether all cells in reach have its fuel.
    is_alike: Vec<bool>,
    /// In all directions that any weather asks for, and round the cell.
    lines: Vec<StraightLine>,
    disc: Vec<StraightLine>,
    /// By interval of the weather: the place of its lines among all that there are.
    set_of: Vec<usize>,
    sets: Vec<LineSet>,
    /// By interval of the weather and by fuel, where moisture is everywhere the same.
    beds: Vec<Vec<FuelBed>>,
    /// Fuel model 10 by interval, where there are trees.
    crown_beds: Vec<FuelBed>,
    /// By fuel: a cell of it.
    cell_of: Vec<usize>,
    /// On a plane without trees: by interval, fuel and line, the disc after the others.
    plane: Vec<Vec<(Ellipse, Vec<f64>)>>,
    /// True if only the wind differs from place to place among the cells of a fuel: on a plane without trees.
    is_smooth: bool,
    /// Elsewhere, for a part of the cells and intervals: which, and its ellipse.
    kept: Vec<(u64, Ellipse)>,
}

impl<'a> Arrivals<'a> {
    pub fn new(landscape: &'a Landscape, weather: &'a Weather, rules: RothermelRules) -> Self {
        let frame = landscape.frame;
        // Tables are by the fuels of this field, not by all 256 numbers: there is one per interval.
        let models = landscape.burning_models();
        let places: Vec<Option<u8>> = (0..=u8::MAX)
            .map(|number| models.iter().position(|model| model.number == number).map(|place| place as u8))
            .collect();
        let fuel: Vec<Option<u8>> = landscape.fuel.iter().map(|&number| places[usize::from(number)]).collect();
        let beds: Vec<Vec<FuelBed>> = weather
            .intervals()
            .iter()
            .map(|interval| {
                models.iter().map(|model| FuelBed::new(model, &interval.moisture, rules.options.curing)).collect()
            })
            .collect();
        let has_trees = landscape.canopy.is_some() && rules.crowns.is_some();
        let with_trees = weather.intervals().iter().filter(|_| has_trees);
        let mut cell_of = vec![0; models.len()];
        for (index, fuel) in fuel.iter().enumerate() {
            fuel.iter().for_each(|&fuel| cell_of[usize::from(fuel)] = index);
        }
        let is_by_fuel = weather.moisture_zones().is_none() && landscape.rate_factors.is_empty()
            || (fuel.iter().enumerate()).all(|(index, fuel)| {
                fuel.is_none_or(|fuel| is_alike([index, cell_of[usize::from(fuel)]], landscape, weather))
            });
        let has_local_wind = weather.wind_fields().iter().any(Option::is_some);
        let mut arrivals = Self {
            frame,
            landscape,
            weather,
            rules,
            models,
            is_alike: Vec::new(),
            fuel,
            lines: Vec::new(),
            disc: Vec::new(),
            set_of: Vec::new(),
            sets: Vec::new(),
            beds,
            crown_beds: with_trees.map(|interval| model_10(&interval.moisture, rules.options.curing)).collect(),
            cell_of,
            plane: Vec::new(),
            is_smooth: has_local_wind && is_by_fuel && matches!(landscape.relief, Relief::Plane(_)) && !has_trees,
            kept: Vec::new(),
        };
        let plane = if let Relief::Plane(gradient) = landscape.relief { Some(gradient) } else { None };
        // Trees and weather by place differ from cell to cell, so no table by fuel holds on a plane with them.
        let plane = plane.filter(|_| !has_trees && !has_local_wind && is_by_fuel);
        if plane.is_none() {
            // A power of two, so that a place is found by masking.
            let kept = (frame.cell_count() / 4).next_power_of_two().max(MIN_KEPT);
            arrivals.kept = vec![(NEVER, Ellipse::NEVER); kept];
        }
        // After `kept` is made, as directions on relief follow from ellipses that are kept there.
        arrivals.draw_lines(plane);
        // As far as the longest line reaches: nearer lines then need not look at the fuel of each cell.
        arrivals.is_alike = alike(frame, &arrivals.fuel, arrivals.reach()[0].max(3));
        // After the lines, whose times it holds.
        if let Some(gradient) = plane {
            arrivals.plane = arrivals.on_plane(gradient);
        }
        arrivals
    }

    /// Finds the directions of each interval of the weather, and the lines to a cell along them.
    fn draw_lines(&mut self, plane: Option<DVec2>) {
        for interval in 0..self.beds.len() {
            let ellipses: Vec<Ellipse> = match plane {
                // Without refinement no ellipse matters.
                _ if !self.rules.refined => Vec::new(),
                Some(gradient) => {
                    let cells = self.cell_of.iter().enumerate();
                    cells.map(|(fuel, &index)| self.new_ellipse(interval, fuel, index, gradient)).collect()
                }
                // On relief each cell has its own ellipse; a sample decides which directions are worth a line.
                None => sampled_cells(self.fuel.len()).map(|index| self.ellipse(interval, index)).collect(),
            };
            let directions = DirectionSet::new(self.rules.neighbours, &ellipses);
            // Weather that changes little keeps its directions, and lines are the costly part.
            let existing = self.sets.iter().position(|set| set.directions == directions);
            self.set_of.push(existing.unwrap_or(self.sets.len()));
            if existing.is_some() {
                continue;
            }
            let cell_m = self.frame.cell_m;
            let mut lines = Vec::new();
            for &(cols, rows) in directions.steps() {
                // Lines lead to the cell, steps away from it.
                let existing = self.lines.iter().position(|line| (line.cols, line.rows) == (-cols, -rows));
                lines.push(existing.unwrap_or(self.lines.len()));
                if existing.is_none() {
                    self.lines.push(StraightLine::new(-cols, -rows, cell_m));
                }
            }
            let disc = directions.exact_offsets();
            for &(cols, rows) in &disc {
                if !self.disc.iter().any(|line| (line.cols, line.rows) == (-cols, -rows)) {
                    self.disc.push(StraightLine::new(-cols, -rows, cell_m));
                }
            }
            // Those that later sets add lie beyond the end, which counts as absent.
            let is_of_disc = self.disc.iter().map(|line| disc.contains(&(-line.cols, -line.rows))).collect();
            let is_taken = (0..self.lines.len()).map(|line| lines.contains(&line)).collect();
            self.sets.push(LineSet { directions, lines, is_taken, is_of_disc });
        }
    }

    /// Returns how many columns or rows away things may concern a cell, and sources.
    pub fn reach(&self) -> [i32; 2] {
        [DirectionSet::reach, DirectionSet::exact_reach]
            .map(|reach| self.sets.iter().map(|set| reach(&set.directions)).max().unwrap_or(0))
    }

    /// Returns the place of the lines of the weather at a time among [`Self::sets`].
    fn set_at(&self, time: u64) -> usize {
        self.set_of[self.weather.interval_at(SimTime::from_nanos(time))]
    }

    fn on_plane(&self, gradient: DVec2) -> Vec<Vec<(Ellipse, Vec<f64>)>> {
        let of_fuel = |interval: usize, fuel: usize| {
            let ellipse = self.new_ellipse(interval, fuel, self.cell_of[fuel], gradient);
            let seconds = self.lines.iter().chain(&self.disc).map(|line| ellipse.travel_s(line.v)).collect();
            (ellipse, seconds)
        };
        (0..self.beds.len())
            .map(|interval| (0..self.models.len()).map(|fuel| of_fuel(interval, fuel)).collect())
            .collect()
    }

    /// Returns the fuel bed of a cell.
    fn bed(&self, interval: usize, fuel: usize, index: usize) -> FuelBed {
        match self.weather.moisture_zones() {
            Some(zones) => FuelBed::new(&self.models[fuel], &zones.at(index), self.rules.options.curing),
            None => self.beds[interval][fuel],
        }
    }

    /// Computes the ellipse of a fuel in the weather of a cell; any cell of the fuel stands for all on a plane.
    fn new_ellipse(&self, interval: usize, fuel: usize, index: usize, gradient: DVec2) -> Ellipse {
        let wind_mps = self.weather.in_cell(interval, index).wind_mps;
        let midflame = twenty_foot_wind(1.0) * unsheltered_adjustment(self.models[fuel].depth_ft) * wind_mps;
        let fire = self.bed(interval, fuel, index).behavior(midflame, gradient, &self.rules.options);
        let rate_mps = fire.rate_mps * self.landscape.rate_factor(index);
        Ellipse::new(rate_mps, fire.eccentricity, fire.heading, gradient)
    }

    /// Returns the ellipse of a cell with trees; `None` where there are none.
    fn below_trees(&self, interval: usize, fuel: usize, cell: Cell, gradient: DVec2) -> Option<Ellipse> {
        let mut ten = *self.crown_beds.get(interval)?;
        let trees = self.landscape.canopy(cell)?;
        let index = self.frame.index(cell);
        if let Some(zones) = self.weather.moisture_zones() {
            ten = model_10(&zones.at(index), self.rules.options.curing);
        }
        let below = UnderCanopy {
            ground: &self.bed(interval, fuel, index),
            depth_ft: self.models[fuel].depth_ft,
            model_10: &ten,
            wind_10m_mps: self.weather.in_cell(interval, index).wind_mps,
            gradient,
            rate_factor: self.landscape.rate_factor(index),
        };
        Some(crown::ellipse(&trees, &below, &self.rules.options, self.rules.crowns?))
    }

    fn ellipse(&mut self, interval: usize, index: usize) -> Ellipse {
        let Some(fuel) = self.fuel[index].map(usize::from) else { return Ellipse::NEVER };
        if let Some(table) = self.plane.get(interval) {
            return table[fuel].0;
        }
        let key = (interval as u64) << 32 | index as u64;
        // Neighbouring cells keep apart, and so do two intervals of one cell.
        let place = (index + 97 * interval) & (self.kept.len() - 1);
        if self.kept[place].0 != key {
            let cell = self.frame.cell(index);
            let gradient = self.landscape.gradient(cell);
            let below_trees = self.below_trees(interval, fuel, cell, gradient);
            let ellipse = below_trees.unwrap_or_else(|| self.new_ellipse(interval, fuel, index, gradient));
            self.kept[place] = (key, ellipse);
        }
        self.kept[place].1
    }

    /// Says whether directions suit narrow fires; otherwise these need not come straight.
    pub fn is_refined(&self) -> bool {
        self.rules.refined
    }

    pub fn frame(&self) -> FieldFrame {
        self.frame
    }

    /// Returns the place of a cell's fuel among those of the landscape; `None` where nothing burns.
    pub fn fuel_at(&self, index: usize) -> Option<u8> {
        self.fuel[index]
    }

    /// Returns the ellipse of all cells of a cell's fuel from one time to another; `None` where it is not one.
    pub fn plane_ellipse(&self, index: usize, from: SimTime, until: SimTime) -> Option<Ellipse> {
        let interval = self.weather.interval_at(from);
        if self.weather.interval_at(until) != interval {
            return None;
        }
        Some(self.plane.get(interval)?[usize::from(self.fuel[index]?)].0)
    }

    /// Returns true if a cell can burn by its fuel.
    pub fn has_fuel(&self, index: usize) -> bool {
        self.fuel[index].is_some()
    }

    /// Returns the cell at an offset that is inside the field.
    fn near(&self, cell: Cell, (cols, rows): (i32, i32)) -> usize {
        self.frame.offset(cell, cols, rows).map_or(usize::MAX, |near| self.frame.index(near))
    }

    /// Returns the earliest arrival at a cell that does not burn, as things are just before a time.
    pub fn earliest(
        &mut self,
        history: &FireHistory,
        cell: Cell,
        before: SimTime,
        parent: Option<Cell>,
    ) -> EarliestArrival {
        let to = self.frame.index(cell);
        let before = before.as_nanos();
        let parent = parent.map_or(usize::MAX, |parent| self.frame.index(parent));
        let mut earliest = EarliestArrival { time: NEVER, from_parent: NEVER };
        let Some(fuel) = self.fuel[to] else { return earliest };
        // The time from the recorded parent is kept apart: it may tie with another within rounding.
        let consider = |earliest: &mut EarliestArrival, time: u64, from: usize| {
            earliest.time = earliest.time.min(time);
            if from == parent {
                earliest.from_parent = earliest.from_parent.min(time);
            }
        };
        // Lines over one fuel, without a delay, that may be part of a pair; by direction.
        let count = self.lines.len();
        let mut plain: Vec<Option<EdgeArrival>> = vec![None; count];
        // Exact lines in all directions hold only near a source, where the front is a disc and not yet faceted.
        let all = count + if history.is_near_source[to] { self.disc.len() } else { 0 };
        for number in 0..all {
            let line = self.line(number);
            let Some(from) = self.frame.offset(cell, line.cols, line.rows) else { continue };
            let from = self.frame.index(from);
            let mut source = history.cell_before(from, before);
            if from == parent && source.ignited == NEVER {
                // Where the front would pass a pair before the later one of it burned, it comes at that very instant.
                let at_once = history.cell_before(from, before.saturating_add(1));
                if at_once.ignited == before {
                    source = at_once;
                }
            }
            let CellBefore { ignited, is_source, .. } = source;
            let is_of_disc = number >= count;
            // What burned later than fire comes anyway cannot be earlier.
            let is_late = ignited >= earliest.time && from != parent;
            if ignited == NEVER || is_late || (is_of_disc && !is_source) {
                continue;
            }
            let (lies, opens) = self.on_line(history, cell, number, before, fuel);
            // A line of the disc stands for undisturbed spread from a source; over other ground the set's lines hold.
            if lies == GroundAlong::Barrier || (is_of_disc && (lies != GroundAlong::OneFuel || opens > ignited)) {
                continue;
            }
            let start = opens.max(ignited);
            // The ground opened later: fire comes from a source only while that still flames.
            if start > ignited && !self.flames_at(from, ignited, start) {
                continue;
            }
            let is_one_fuel = lies == GroundAlong::OneFuel;
            let set = &self.sets[self.set_at(start)];
            let is_of_set = match number.checked_sub(count) {
                Some(of_disc) => set.is_of_disc.get(of_disc) == Some(&true),
                None => set.is_taken.get(number) == Some(&true),
            };
            if is_of_set {
                let time = self.straight_arrival(cell, number, start, is_one_fuel);
                consider(&mut earliest, time, from);
            }
            // A front between two points is only defined where both send fire over the same open ground.
            let is_plain = !is_of_disc && is_one_fuel && start == ignited;
            if let Some(place) = plain.get_mut(number).filter(|_| is_plain) {
                *place = Some(EdgeArrival { line: number, index: from, time: ignited });
            }
        }
        for set in 0..self.sets.len() {
            for place in 0..self.sets[set].lines.len() {
                let lines = &self.sets[set].lines;
                // Directions are in order of angle, so neighbours in the list span the gap between them.
                let pair = [lines[place], lines[(place + 1) % lines.len()]];
                let [Some(one), Some(other)] = pair.map(|line| plain[line]) else { continue };
                // A pair is of the weather in which both of it burn.
                if self.set_at(one.time.max(other.time)) != set {
                    continue;
                }
                let is_of_parent = one.index == parent || other.index == parent;
                // The front between them cannot arrive before both burn.
                if one.time.max(other.time) >= earliest.time && !is_of_parent {
                    continue;
                }
                let time = self.arrival_between(cell, one, other);
                // Its parent is the one that burned later: before that there was nothing between.
                if one.time >= other.time {
                    consider(&mut earliest, time, one.index);
                }
                if other.time >= one.time {
                    consider(&mut earliest, time, other.index);
                }
            }
        }
        earliest
    }

    /// A line by its number, those of the disc after the others.
    fn line(&self, number: usize) -> &StraightLine {
        self.lines.get(number).unwrap_or_else(|| &self.disc[number - self.lines.len()])
    }

    /// Returns what lies on a line, and from when on fire may pass all of it.
    fn on_line(&self, history: &FireHistory, cell: Cell, number: usize, before: u64, fuel: u8) -> (GroundAlong, u64) {
        let line = self.line(number);
        let to = self.frame.index(cell);
        // Marks of disturbance reach only so far; for longer lines any change anywhere counts.
        let is_far = line.cols.abs().max(line.rows.abs()) > history.reach;
        let is_undisturbed = !history.is_near_more[to] && (!is_far || history.more.is_empty());
        if is_undisturbed && !is_far && self.is_alike[to] {
            return (GroundAlong::OneFuel, 0);
        }
        let opens_at = |index: usize| {
            // Cells outside the field are barriers too.
            if self.fuel.get(index).is_none_or(Option::is_none) {
                NEVER
            } else if is_undisturbed {
                0
            } else {
                history.cell_before(index, before).open_from
            }
        };
        let (mut opens, mut is_one_fuel) = (0, true);
        for &(offset, _) in &line.crossed {
            let index = self.near(cell, offset);
            opens = opens.max(opens_at(index));
            is_one_fuel &= self.fuel.get(index).is_some_and(|&crossed| crossed == Some(fuel));
        }
        // Of the two cells at a corner the one that opens first lets the front by.
        for &[one, other] in &line.corners {
            opens = opens.max(opens_at(self.near(cell, one)).min(opens_at(self.near(cell, other))));
        }
        let lies = match (opens == NEVER, is_one_fuel) {
            (true, _) => GroundAlong::Barrier,
            (false, true) => GroundAlong::OneFuel,
            (false, false) => GroundAlong::Mixed,
        };
        (lies, opens)
    }

    /// Returns the seconds along a line to a cell in an interval of the weather.
    fn line_seconds(&mut self, cell: Cell, number: usize, interval: usize, is_one_fuel: bool) -> f64 {
        if let Some(table) = self.plane.get(interval)
            && is_one_fuel
        {
            let fuel = self.fuel[self.frame.index(cell)].expect("fire comes only where there is fuel");
            return table[usize::from(fuel)].1[number];
        }
        let line = self.line(number);
        // Where only the wind differs from place to place, the two ends of a short line stand for all of it.
        if self.is_smooth && is_one_fuel && line.cols.abs().max(line.rows.abs()) <= MAX_SMOOTH {
            let v = line.v;
            let ends = [self.near(cell, (line.cols, line.rows)), self.frame.index(cell)];
            return ends.into_iter().map(|index| self.ellipse(interval, index).travel_s(v)).sum::<f64>() / 2.0;
        }
        let mut seconds = 0.0;
        // By index, as `ellipse` borrows all of `self`.
        for place in 0..self.line(number).crossed.len() {
            let (offset, part) = self.line(number).crossed[place];
            let index = self.near(cell, offset);
            // Cells are summed in the order of the line, as the sum's rounding depends on it.
            seconds += part
                * match self.plane.get(interval) {
                    Some(table) => self.fuel[index].map_or(f64::INFINITY, |fuel| table[usize::from(fuel)].1[number]),
                    None => {
                        let v = self.line(number).v;
                        self.ellipse(interval, index).travel_s(v)
                    }
                };
        }
        seconds
    }

    fn straight_arrival(&mut self, cell: Cell, number: usize, start: u64, is_one_fuel: bool) -> u64 {
        self.arrival(start, |arrivals, interval| arrivals.line_seconds(cell, number, interval, is_one_fuel))
    }

    /// Returns when something ends that begins at a time and would take that many seconds in each interval alone: when
    /// the parts that were done of it add up to one.
    fn arrival(&mut self, start: u64, mut seconds: impl FnMut(&mut Self, usize) -> f64) -> u64 {
        let weather = self.weather;
        let mut interval = weather.interval_at(SimTime::from_nanos(start));
        let (mut now, mut done) = (start, 0.0_f64);
        loop {
            let whole = seconds(self, interval);
            let arrival = later(now, (1.0 - done).max(0.0) * whole);
            let Some(next) = weather.intervals().get(interval + 1).map(|next| next.from.as_nanos()) else {
                return arrival;
            };
            if arrival <= next {
                return arrival;
            }
            // The share of the way that was made, as the next interval has another speed on the same way.
            done += (next - now) as f64 / NANOS / whole;
            (now, interval) = (next, interval + 1);
        }
    }

    /// Returns the first arrival from strictly between the beginnings of two lines, if there the fire is first.
    fn arrival_between(&mut self, cell: Cell, one: EdgeArrival, other: EdgeArrival) -> u64 {
        let to = self.frame.index(cell);
        let latest = one.time.max(other.time);
        let interval = self.weather.interval_at(SimTime::from_nanos(latest));
        let ellipse = self.ellipse(interval, to);
        if !ellipse.burns() {
            return NEVER;
        }
        let v1 = self.lines[one.line].v;
        let v2 = self.lines[other.line].v;
        let [beyond1, beyond2] = self.beyond(cell, [one, other], interval);
        let between_s = (other.time as f64 - one.time as f64) / NANOS;
        // Times of the two beginnings without the drift on the way from them, which is linear along the line between.
        let t1 = beyond1 - ellipse.drift_s(v1);
        // Both in seconds after the first ignition, so that differences of nanoseconds stay exact.
        let t2 = between_s + beyond2 - ellipse.drift_s(v2);
        let w = v2 - v1;
        // Lengths from here on are in the metric of the ellipse, in which fire covers one unit a second.
        let length = ellipse.product(w, w).sqrt();
        let along = ellipse.product(v1, w) / length;
        let height = (ellipse.product(v1, v1) - along * along).max(0.0).sqrt();
        let rise = (t2 - t1) / length;
        // The ends burn farther apart in time than fire takes from one to the other: no front spans them.
        if rise * rise >= 1.0 {
            return NEVER;
        }
        let stretch = 1.0 / (1.0 - rise * rise).sqrt();
        // In that metric the ray to the cell is at a right angle to the front, which fixes where it starts.
        let part = (-rise * height * stretch - along) / length;
        // Written so that a part that is not a number is refused too.
        if !(0.0 < part && part < 1.0) {
            return NEVER;
        }
        // Never before both burn, which rounding could make it.
        let time = later(one.time, t1 + part * (t2 - t1) + height * stretch).max(latest);
        let ends = self.weather.intervals().get(interval + 1).map_or(NEVER, |next| next.from.as_nanos());
        // The closed form holds in one interval of the weather; else the same point between is followed through all.
        if one.time.min(other.time) >= self.weather.intervals()[interval].from.as_nanos() && time <= ends {
            return time;
        }
        let start = one.time as f64 + part * (other.time as f64 - one.time as f64);
        let v = v1 + part * w;
        let arrival = self.arrival(start as u64, |arrivals, interval| {
            let straight = arrivals.ellipse(interval, to).travel_s(v);
            let [beyond1, beyond2] = arrivals.beyond(cell, [one, other], interval);
            straight + (1.0 - part) * beyond1 + part * beyond2
        });
        arrival.max(latest)
    }

    /// Returns the seconds that two lines need beyond the ellipse of the cell that they lead to, where slopes differ.
    fn beyond(&mut self, cell: Cell, lines: [EdgeArrival; 2], interval: usize) -> [f64; 2] {
        if !self.plane.is_empty() {
            return [0.0; 2];
        }
        let ellipse = self.ellipse(interval, self.frame.index(cell));
        lines.map(|arrival| {
            let along = ellipse.travel_s(self.lines[arrival.line].v);
            if along == f64::INFINITY { 0.0 } else { self.line_seconds(cell, arrival.line, interval, true) - along }
        })
    }

    /// Says whether a cell that caught fire at a time flames longer than until another.
    fn flames_at(&self, index: usize, ignited: u64, time: u64) -> bool {
        let (Some(min), Some(fuel)) = (self.rules.burn_out, self.fuel[index]) else { return true };
        let interval = self.weather.interval_at(SimTime::from_nanos(ignited));
        let residence = SimTime::from_seconds(self.bed(interval, usize::from(fuel), index).residence_s());
        ignited.saturating_add(min.max(residence).as_nanos()) > time
    }
}

/// Says whether two cells have the same moisture and the same factor on the rate of spread.
fn is_alike([one, other]: [usize; 2], landscape: &Landscape, weather: &Weather) -> bool {
    weather.in_cell(0, one).moisture == weather.in_cell(0, other).moisture
        && landscape.rate_factor(one) == landscape.rate_factor(other)
}

/// A time some seconds after another, to the nearest nanosecond.
fn later(time: u64, seconds: f64) -> u64 {
    time.saturating_add((seconds * NANOS + 0.5) as u64)
}

/// Says of each cell whether all cells in reach are inside the field and have its fuel.
fn alike(frame: FieldFrame, fuel: &[Option<u8>], reach: i32) -> Vec<bool> {
    let cols = usize::from(frame.cols);
    let rows = usize::from(frame.rows);
    let reach = reach as usize;
    // Along rows first: how many cells up to this one have its fuel.
    let is_row = |index: usize| {
        let col = index % cols;
        let is_inside = col >= reach && col + reach < cols;
        is_inside && fuel[index - reach..=index + reach].iter().all(|near| *near == fuel[index])
    };
    let in_row: Vec<bool> = (0..fuel.len()).map(is_row).collect();
    (0..fuel.len())
        .map(|index: usize| {
            let row = index / cols;
            let is_inside = row >= reach && row + reach < rows;
            is_inside
                && (row - reach..=row + reach).all(|near| {
                    let near = near * cols + index % cols;
                    in_row[near] && fuel[near] == fuel[index]
                })
        })
        .collect()
}
