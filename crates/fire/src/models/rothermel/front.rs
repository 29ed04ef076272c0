//! The front: what has burned, what is planned, and how a plan is made.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::directions::DirectionSet;
use super::queue::{ArrivalQueue, NEVER};
use super::rates::{BARRIER, Pair, Rates, Spreading, length_on, vector};
use super::rules::RothermelRules;
use super::template::{Edge, EdgeSet, Template};
use crate::surface::crown::FireType;
use crate::{Landscape, Relief, Weather};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_base::time::SimTime;

/// It burns or has burned out: its time is that of its ignition.
const BURNED: u8 = 1;
/// It did not catch fire from the front.
const SOURCE: u8 = 2;
/// Something near it has changed, and its plan may come too early.
const STALE: u8 = 4;
/// Fire passes over some cell near it from a time on only.
const NEAR_DELAY: u8 = 8;
/// It is due, and the caller has been told.
const DUE: u8 = 16;
/// Something near it did not catch fire from the front, so near that its time from there is exact.
const NEAR_SOURCE: u8 = 32;
/// All cells in reach of the ways from it are of its fuel.
const UNIFORM: u8 = 64;
/// The longest way, in columns or rows, along which wind by place is taken from its two ends.
const MAX_SMOOTH: i32 = 3;
/// Flags that stay when a cell changes.
const NEAR: u8 = NEAR_DELAY | NEAR_SOURCE | UNIFORM;

/// A way as it is found.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Crossing {
    Blocked,
    /// Over several fuels.
    Mixed,
    /// Over the fuel of the cell that it leads to.
    Uniform,
}

/// The cells with a margin of cells that do not burn, row by row; the order is that of cell indices.
#[derive(Clone, Debug)]
struct Cells {
    frame: FieldFrame,
    /// Cells beyond each edge of the field, so that no way leads out of the arrays: the reach of ways round an ignition.
    margin: usize,
    /// The reach of the other ways.
    reach: usize,
    stride: usize,
    /// The fuel that burns there, or [`BARRIER`].
    fuel: Vec<u8>,
    state: Vec<u8>,
    /// When it caught fire if it has, and when it will otherwise.
    time: Vec<u64>,
    /// The number of the way by which it did or will.
    way: Vec<u16>,
    /// From when on fire passes over a cell. They stay when it burns, as ways over it that begin before could not pass.
    /// Trucks make few of them.
    delays: BTreeMap<u32, u64>,
}

impl Cells {
    fn new(landscape: &Landscape, [reach, margin]: [usize; 2], fuel: impl Fn(u8) -> u8) -> Self {
        let cols = usize::from(landscape.frame.cols);
        let rows = usize::from(landscape.frame.rows);
        // A margin of barriers around the field: ways that leave it need no test of their own.
        let stride = cols + 2 * margin;
        let count = stride * (rows + 2 * margin);
        u32::try_from(count).expect("sizes of fields are checked before");
        let mut fuels = vec![BARRIER; count];
        // Looked up once for each of the 256 numbers, not for each cell.
        let mut number_of = [BARRIER; 256];
        for number in 0..=u8::MAX {
            number_of[usize::from(number)] = fuel(number);
        }
        for (row, numbers) in landscape.fuel.chunks_exact(cols.max(1)).enumerate() {
            let start = (row + margin) * stride + margin;
            for (fuel, &number) in fuels[start..start + cols].iter_mut().zip(numbers) {
                *fuel = number_of[usize::from(number)];
            }
        }
        let state = vec![0; count];
        let time = vec![NEVER; count];
        let way = vec![0; count];
        let frame = landscape.frame;
        let mut cells = Self { frame, margin, reach, stride, fuel: fuels, state, time, way, delays: BTreeMap::new() };
        cells.mark_uniform();
        cells
    }

    /// Marks the cells in the middle of squares of one fuel, as wide as ways from there reach.
    fn mark_uniform(&mut self) {
        let Self { reach, stride, .. } = *self;
        let width = 2 * reach + 1;
        // By column, the rows above and with this one whose cells in reach are of one fuel, the same in all.
        let mut rows_alike = vec![0; stride];
        for row in 0..self.fuel.len() / stride {
            let mut cols_alike = 0;
            for col in 0..stride {
                let index = row * stride + col;
                // Runs along rows, and runs of such rows: one pass in place of a look at every square.
                let is_as_before = col > 0 && self.fuel[index] == self.fuel[index - 1];
                cols_alike = if is_as_before { cols_alike + 1 } else { 1 };
                let Some(middle) = col.checked_sub(reach) else { continue };
                let index = index - reach;
                let is_as_above = row > 0 && self.fuel[index] == self.fuel[index - stride];
                let is_one_fuel = cols_alike >= width && self.fuel[index] != BARRIER;
                rows_alike[middle] = if !is_one_fuel {
                    0
                } else if is_as_above {
                    rows_alike[middle] + 1
                } else {
                    1
                };
                if rows_alike[middle] >= width {
                    // The square of that width ends here, so its middle lies half of it back.
                    self.state[index - reach * stride] |= UNIFORM;
                }
            }
        }
    }

    fn index(&self, cell: Cell) -> usize {
        (usize::from(cell.row) + self.margin) * self.stride + usize::from(cell.col) + self.margin
    }

    fn cell(&self, index: usize) -> Cell {
        let row = index / self.stride - self.margin;
        let col = index % self.stride - self.margin;
        Cell { col: col as u16, row: row as u16 }
    }

    /// Iterates over the cells within some columns and rows of one, itself among them.
    fn around(&self, cell: Cell, reach: usize) -> impl Iterator<Item = usize> + use<> {
        let Self { frame, margin, stride, .. } = *self;
        let span = |at: u16, size: u16| {
            let last = (usize::from(at) + reach).min(usize::from(size) - 1);
            usize::from(at).saturating_sub(reach) + margin..last + margin + 1
        };
        let cols = span(cell.col, frame.cols);
        span(cell.row, frame.rows).flat_map(move |row| cols.clone().map(move |col| row * stride + col))
    }

    #[inline]
    fn has_burned(&self, index: usize) -> bool {
        self.state[index] & BURNED != 0
    }

    /// Returns when fire is expected at a cell.
    #[inline]
    fn awaited(&self, index: usize) -> u64 {
        if self.state[index] & (BURNED | DUE) == 0 { self.time[index] } else { NEVER }
    }

    /// Returns what is found on a way that ends in a cell of a fuel and is not one of those round an ignition.
    #[inline]
    fn crossing(&self, from: usize, way: &Edge, fuel: u8) -> Crossing {
        if self.state[from] & UNIFORM != 0 { Crossing::Uniform } else { self.crossing_of_any(from, way, fuel) }
    }

    /// Returns the same for a way of any length.
    fn crossing_of_any(&self, from: usize, way: &Edge, fuel: u8) -> Crossing {
        let (mut is_uniform, mut is_blocked) = (true, false);
        for &(place, _) in way.crossed() {
            let crossed = self.fuel[from.wrapping_add_signed(place)];
            is_uniform &= crossed == fuel;
            is_blocked |= crossed == BARRIER;
        }
        for &[one, other] in way.corners() {
            // Fire passes a corner by either of the two cells beside it.
            is_blocked |= self.fuel[from.wrapping_add_signed(one)] == BARRIER
                && self.fuel[from.wrapping_add_signed(other)] == BARRIER;
        }
        match (is_blocked, is_uniform) {
            (true, _) => Crossing::Blocked,
            (false, false) => Crossing::Mixed,
            (false, true) => Crossing::Uniform,
        }
    }

    /// Returns from when on fire may begin a way that is not blocked.
    fn open_from(&self, from: usize, way: &Edge) -> u64 {
        let delay = |place: isize| {
            let index = from.wrapping_add_signed(place);
            let is_barrier = self.fuel[index] == BARRIER;
            if is_barrier { NEVER } else { self.delays.get(&(index as u32)).copied().unwrap_or(0) }
        };
        let crossed = way.crossed().iter().map(|&(place, _)| delay(place)).max();
        let corners = way.corners().iter().map(|&[one, other]| delay(one).min(delay(other))).max();
        crossed.max(corners).unwrap_or(0)
    }
}

/// The rates on a plane in the weather of the moment, for one fuel.
#[derive(Clone, Debug)]
struct FuelTable {
    slowness: f64,
    /// By way of the template, the seconds along it and those that the drift takes off.
    along: Vec<(f64, f64)>,
}

/// The interval of the weather that the front is in.
#[derive(Clone, Debug)]
struct WeatherSpan {
    number: usize,
    from: u64,
    until: u64,
    /// By fuel; empty where every cell has a slope of its own.
    tables: Vec<FuelTable>,
}

/// The beginning of a way that may be part of a two-point candidate.
#[derive(Clone, Copy)]
struct EdgeStart {
    index: usize,
    way: usize,
}

/// What has burned, what is planned, and the queue of the plans.
#[derive(Clone, Debug)]
pub struct Front {
    cells: Cells,
    rates: Rates,
    rules: RothermelRules,
    template: Template,
    /// By way, its length on the slope, where only the wind differs from place to place; else empty.
    lengths: Vec<f64>,
    interval: WeatherSpan,
    queue: ArrivalQueue,
    /// What was due last, and when.
    due: Vec<u32>,
    due_at: u64,
}

impl Front {
    pub fn new(landscape: Arc<Landscape>, weather: Arc<Weather>, rules: RothermelRules) -> Self {
        let mut rates = Rates::new(Arc::clone(&landscape), weather, rules);
        let directions = rates.directions();
        let farthest = |reach: fn(&DirectionSet) -> i32| directions.iter().map(reach).max().unwrap_or(0) as usize;
        let reach = [farthest(DirectionSet::reach), farthest(DirectionSet::exact_reach)];
        let cells = Cells::new(&landscape, reach, |number| rates.fuel(number));
        let plane = if let Relief::Plane(gradient) = landscape.relief { Some(gradient) } else { None };
        let template = Template::new(&directions, cells.stride, landscape.frame.cell_m, plane);
        let gradient = rates.smooth_gradient();
        let lengths = gradient
            .map(|gradient| template.vectors.iter().map(|&v| length_on(gradient, v)).collect())
            .unwrap_or_default();
        // Of no time: it is entered with the first ignition.
        let interval = WeatherSpan { number: 0, from: NEVER, until: 0, tables: Vec::new() };
        let queue = ArrivalQueue::default();
        let due = Vec::new();
        let due_at = 0;
        Self { cells, rates, rules, template, lengths, interval, queue, due, due_at }
    }

    /// Returns the next plan.
    pub fn next(&mut self) -> Option<(u64, Cell)> {
        loop {
            let cells = &self.cells;
            let (time, index) = self.queue.peek(|index| cells.awaited(index as usize))?;
            let index = index as usize;
            if self.cells.state[index] & STALE == 0 {
                return Some((time, self.cells.cell(index)));
            }
            self.queue.pop();
            self.plan_again(index);
        }
    }

    /// Returns the plan of a cell that has not burned.
    pub fn planned(&self, cell: Cell) -> Option<SimTime> {
        let time = self.cells.awaited(self.cells.index(cell));
        (time != NEVER).then(|| SimTime::from_nanos(time))
    }

    /// Tells `spread` what catches fire by a time, and from where, by (time, cell index).
    pub fn take_due(&mut self, now: u64, mut spread: impl FnMut(Cell, Cell)) {
        self.forget_due();
        self.due_at = now;
        while let Some((_, cell)) = self.next().filter(|&(time, _)| time <= now) {
            self.queue.pop();
            let index = self.cells.index(cell);
            self.cells.state[index] |= DUE;
            self.due.push(index as u32);
            spread(cell, self.cells.cell(index.wrapping_add_signed(-self.way_of(index).end)));
        }
    }

    /// What was due and did not catch fire cannot, by what the caller knows; it has no plan until something changes.
    fn forget_due(&mut self) {
        for index in self.due.drain(..) {
            let state = &mut self.cells.state[index as usize];
            if *state & DUE != 0 {
                *state &= !DUE;
                self.cells.time[index as usize] = NEVER;
            }
        }
    }

    fn way_of(&self, index: usize) -> &Edge {
        self.template.way(usize::from(self.cells.way[index]))
    }

    /// Returns the kind of fire that a cell with trees has at a time; `None` where there are none.
    pub fn fire_type(&mut self, cell: Cell, time: u64) -> Option<FireType> {
        let fuel = self.cells.fuel[self.cells.index(cell)];
        let interval = self.rates.weather().interval_at(SimTime::from_nanos(time));
        (fuel != BARRIER).then(|| self.rates.crown_fire(interval, fuel, cell))?.map(|fire| fire.fire_type())
    }

    /// Returns how long a cell flames that catches fire at a time; `None` forever.
    pub fn flaming(&mut self, cell: Cell, time: u64) -> Option<SimTime> {
        let fuel = self.cells.fuel[self.cells.index(cell)];
        if fuel == BARRIER {
            return self.rules.burn_out;
        }
        let interval = self.rates.weather().interval_at(SimTime::from_nanos(time));
        self.rates.flaming(interval, fuel, cell)
    }

    /// Returns the horizontal way by which a front has just come to a cell; `None` if it is set on fire otherwise.
    pub fn way_to(&self, cell: Cell, now: u64) -> Option<DVec2> {
        let index = self.cells.index(cell);
        let is_of_front = self.cells.state[index] & DUE != 0 && self.due_at == now;
        is_of_front.then(|| vector(self.way_of(index), self.cells.frame.cell_m))
    }

    /// Takes in that a cell has caught fire.
    pub fn ignite(&mut self, cell: Cell, now: u64) {
        let index = self.cells.index(cell);
        let state = self.cells.state[index];
        // A cell that this front plans for now was reached by it; any other ignition begins a fire of its own.
        let is_source = state & DUE == 0 || self.due_at != now;
        // Marks of the surroundings stay; what was planned for the cell is over.
        self.cells.state[index] = state & NEAR | BURNED | if is_source { SOURCE } else { 0 };
        self.cells.time[index] = now;
        self.enter_interval(now);
        if is_source {
            self.cells.around(cell, self.cells.margin).for_each(|near| self.cells.state[near] |= NEAR_SOURCE);
        }
        // Ways round an ignition may lead farther than delays are marked.
        let is_far_reaching = is_source && self.cells.margin > 2 * self.cells.reach && !self.cells.delays.is_empty();
        if state & NEAR_DELAY != 0 || is_far_reaching {
            let reach = if is_source { self.cells.margin } else { self.cells.reach };
            let reached: Vec<usize> =
                self.cells.around(cell, reach).filter(|&near| !self.cells.has_burned(near)).collect();
            for near in reached {
                self.plan_again(near);
            }
            // Plans that are made from scratch know this cell too, so it need not spread by itself.
            return;
        }
        if is_source {
            self.spread_exactly_from(index, now);
        }
        let Self { cells, rates, template, lengths, interval, queue, .. } = self;
        let is_plane = rates.is_plane();
        let here = (!is_plane && !lengths.is_empty()).then(|| spreading(rates, cells, interval.number, index));
        let set = template.set(interval.number);
        let mut walk = SpreadWalk { cells, rates, template, set, lengths, interval, queue, from: index, now, here };
        if is_plane { walk.spread::<true>() } else { walk.spread::<false>() }
    }

    /// Takes in that a cell was put out, for good or with `reignition`.
    pub fn extinguish(&mut self, cell: Cell, now: u64, reignition: bool) {
        let index = self.cells.index(cell);
        self.cells.state[index] &= NEAR;
        self.cells.time[index] = NEVER;
        if reignition {
            self.delay(cell, now);
        } else {
            // What never burns again is a barrier, and squares with it are no longer of one fuel.
            self.cells.fuel[index] = BARRIER;
            for near in self.cells.around(cell, self.cells.reach) {
                self.cells.state[near] &= !UNIFORM;
            }
            self.mark_stale_around(cell);
        }
    }

    /// Takes in that fire passes over a cell that does not burn only from a time on.
    pub fn delay(&mut self, cell: Cell, until: u64) {
        let index = self.cells.index(cell);
        let delay = self.cells.delays.entry(index as u32).or_insert(0);
        *delay = until.max(*delay);
        // A cell that ignites there may reach others that have a further way over this cell.
        for near in self.cells.around(cell, 2 * self.cells.reach) {
            self.cells.state[near] |= NEAR_DELAY;
        }
        self.mark_stale_around(cell);
        // It may have a plan now where it had none, or be one that was just due.
        self.cells.state[index] &= !DUE;
        self.plan_again(index);
    }

    /// Marks the plans that ways over a cell may be part of. All of them can only become later.
    fn mark_stale_around(&mut self, cell: Cell) {
        for near in self.cells.around(cell, self.cells.margin) {
            let Cell { col, row } = self.cells.cell(near);
            let distance = usize::from(col.abs_diff(cell.col).max(row.abs_diff(cell.row)));
            let is_reached = distance <= self.cells.reach || self.cells.state[near] & NEAR_SOURCE != 0;
            self.cells.state[near] |= if is_reached { STALE } else { 0 };
        }
    }

    fn enter_interval(&mut self, now: u64) {
        // Nearly always: weather changes by the hour, cells ignite by the second.
        if (self.interval.from..self.interval.until).contains(&now) {
            return;
        }
        let number = self.rates.weather().interval_at(SimTime::from_nanos(now));
        let (from, until) = span(&self.rates, number);
        let vectors = &self.template.vectors;
        let tables = if self.rates.is_plane() { self.rates.on_plane(number) } else { &[] };
        let tables = tables.iter().map(|spreading| FuelTable {
            slowness: spreading.slowness,
            // All ways at once: each is used by every cell that ignites in this weather.
            along: vectors.iter().map(|&v| (spreading.seconds(v), spreading.drift_seconds(v))).collect(),
        });
        self.interval = WeatherSpan { number, from, until, tables: tables.collect() };
    }

    /// Offers exact times to the cells near an ignition, along ways of one fuel.
    fn spread_exactly_from(&mut self, from: usize, now: u64) {
        let Self { cells, rates, template, interval, queue, .. } = self;
        for number in template.disc(interval.number) {
            let way = template.way(number);
            let to = from.wrapping_add_signed(way.end);
            // The cheap test first; most cells around a later source have burned.
            if cells.has_burned(to) || cells.fuel[to] == BARRIER {
                continue;
            }
            // Over other ground the exact way would be a guess: the front goes by the set's ways there.
            if cells.crossing_of_any(from, way, cells.fuel[to]) == Crossing::Uniform {
                let time = arrival_along(rates, cells, from, way, now);
                offer(cells, queue, to, time, number);
            }
        }
    }

    /// Makes the best plan of a cell that does not burn from all that has burned around it.
    fn plan_again(&mut self, to: usize) {
        let (time, way) = self.best_plan(to);
        self.cells.state[to] &= !STALE;
        // Its place in the queue may be gone even where the time is the same.
        self.cells.time[to] = time;
        self.cells.way[to] = way;
        if time != NEVER {
            self.queue.push(time, to as u32);
        }
    }

    fn best_plan(&mut self, to: usize) -> (u64, u16) {
        let fuel = self.cells.fuel[to];
        // Compared in order: time, the source's ignition, and numbers, so that no tie depends on the order of trials.
        let mut best = (NEVER, NEVER, usize::MAX, 0);
        if fuel == BARRIER {
            return (NEVER, 0);
        }
        // Among equal times that of the cell is taken that burned first: so does a front that comes to it.
        let mut consider = |time: u64, cells: &Cells, from: usize, way: usize| {
            if time != NEVER {
                best = best.min((time, cells.time[from], from, way as u16));
            }
        };
        let count = self.template.ways.len();
        // A pair is a front only if both of its ways were open all the time.
        let mut plain = vec![false; count];
        let has_disc = self.cells.state[to] & NEAR_SOURCE != 0;
        #[expect(clippy::needless_range_loop, reason = "the numbers go on where the list of plain ways ends")]
        for number in 0..if has_disc { self.template.count() } else { count } {
            let is_of_disc = number >= count;
            let way = self.template.way(number);
            let from = to.wrapping_add_signed(-way.end);
            let needed = if is_of_disc { BURNED | SOURCE } else { BURNED };
            if self.cells.state[from] & needed != needed {
                continue;
            }
            let crossing = self.cells.crossing_of_any(from, way, fuel);
            if crossing == Crossing::Blocked || (is_of_disc && crossing != Crossing::Uniform) {
                continue;
            }
            let ignited = self.cells.time[from];
            // Over ground that opens later fire starts when it opens, if the source still flames then.
            let start = self.cells.open_from(from, way).max(ignited);
            if !is_of_disc {
                plain[number] = start == ignited && crossing == Crossing::Uniform;
            }
            let interval = self.rates.weather().interval_at(SimTime::from_nanos(start));
            let is_taken = self.template.contains(interval, number);
            if is_taken && (start == ignited || (!is_of_disc && self.flames_at(from, start))) {
                let way = self.template.way(number);
                let time = arrival_along(&mut self.rates, &self.cells, from, way, start);
                consider(time, &self.cells, from, number);
            }
        }
        for set in 0..self.template.sets().len() {
            for place in 0..self.template.sets()[set].ways.len() {
                let pair = self.template.sets()[set].pair(place);
                if !pair.iter().all(|&way| plain[way]) {
                    continue;
                }
                let [first, second] = pair.map(|way| {
                    let index = to.wrapping_add_signed(-self.template.ways[way].end);
                    EdgeStart { index, way }
                });
                // The later end's weather decides, as before it burned there was no front between.
                let later = [first, second].into_iter().max_by_key(|one| (self.cells.time[one.index], one.index));
                let later = later.expect("there are two");
                let ignited = SimTime::from_nanos(self.cells.time[later.index]);
                if self.template.set_number(self.rates.weather().interval_at(ignited)) != set {
                    continue;
                }
                let ends = [first, second];
                if let Some(time) = two_point_arrival(&mut self.rates, &self.cells, &self.template, to, ends) {
                    consider(time, &self.cells, later.index, later.way);
                }
            }
        }
        (best.0, best.3)
    }

    /// Says whether a cell that burned flames longer than until a time.
    fn flames_at(&mut self, index: usize, time: u64) -> bool {
        let ignited = self.cells.time[index];
        let flaming = self.flaming(self.cells.cell(index), ignited);
        flaming.is_none_or(|span| ignited.saturating_add(span.as_nanos()) > time)
    }
}

/// A walk over the ways from a cell that has just caught fire, far from delays.
struct SpreadWalk<'a> {
    cells: &'a mut Cells,
    rates: &'a mut Rates,
    template: &'a Template,
    set: &'a EdgeSet,
    lengths: &'a [f64],
    interval: &'a WeatherSpan,
    queue: &'a mut ArrivalQueue,
    from: usize,
    now: u64,
    /// The spreading at the cell, where only the wind differs from place to place.
    here: Option<Spreading>,
}

/// A way of the walk, over whatever it leads.
#[derive(Clone, Copy)]
struct SpreadStep<'a> {
    number: usize,
    way: &'a Edge,
    to: usize,
    crossing: Crossing,
}

/// A way whose wind is taken from its two ends.
#[derive(Clone, Copy)]
struct SmoothStep {
    seconds: f64,
    there: Spreading,
}

impl SpreadWalk<'_> {
    /// Offers times to all neighbours of the cell: what [`arrival_along`] and [`two_point_arrival`] say, with less work where
    /// there is a table of all ways, or where no cell need be looked at twice.
    fn spread<const ON_PLANE: bool>(&mut self) {
        let Self { template, set, from, .. } = *self;
        let count = set.ways.len();
        for (place, number) in set.numbers().enumerate() {
            let way = &template.ways[number];
            let to = from.wrapping_add_signed(way.end);
            let fuel = self.cells.fuel[to];
            // Most of what a front looks at lies behind it.
            if fuel == BARRIER || self.cells.has_burned(to) {
                continue;
            }
            // Before the time along it, which on relief sums the ellipses of all cells crossed.
            let crossing = self.cells.crossing(from, way, fuel);
            if crossing == Crossing::Blocked {
                continue;
            }
            let step = SpreadStep { number, way, to, crossing };
            let smooth = if ON_PLANE { None } else { self.smooth_step(step) };
            let seconds =
                if ON_PLANE { Some(self.seconds_on_plane(step)) } else { smooth.map(|smooth| smooth.seconds) };
            let time = self.arrival(step, seconds);
            offer(self.cells, self.queue, to, time, number);
            if crossing != Crossing::Uniform {
                continue;
            }
            // A comparison is cheaper here than a division, which the remainder would take.
            let before = if place == 0 { count - 1 } else { place - 1 };
            let after = if place + 1 == count { 0 } else { place + 1 };
            // Each way bounds two gaps: those to the ways on both sides of it.
            for (first_place, other_place) in [(before, before), (place, after)] {
                let other = usize::from(set.ways[other_place]);
                let other_way = &template.ways[other];
                let beside = to.wrapping_add_signed(-other_way.end);
                // The later of two that burn makes the pair, so each is tried once both burn.
                if !self.cells.has_burned(beside) {
                    continue;
                }
                let starts = [EdgeStart { index: from, way: number }, EdgeStart { index: beside, way: other }];
                let starts = if first_place == place { starts } else { [starts[1], starts[0]] };
                let burned = if ON_PLANE {
                    Some(self.burned_on_plane(fuel, starts))
                } else {
                    smooth.filter(|_| is_short(other_way)).map(|smooth| self.burned_in_smooth_wind(smooth, starts))
                };
                let mut two_point = None;
                if let Some(burned) = burned {
                    let Some(found) = burned.first_between(&set.pairs[first_place]) else { continue };
                    // Never before now, which rounding could make it.
                    let time = found.time.max(self.now);
                    // The closed form holds in one weather only.
                    if self.cells.time[beside] >= self.interval.from && time <= self.interval.until {
                        // A time that is no earlier needs no look at the ground on the way.
                        if time >= self.cells.time[to] {
                            continue;
                        }
                        two_point = Some(time);
                    }
                }
                if self.cells.crossing(beside, other_way, fuel) != Crossing::Uniform {
                    continue;
                }
                let exact = || two_point_arrival(self.rates, self.cells, template, to, starts);
                if let Some(time) = two_point.or_else(exact) {
                    offer(self.cells, self.queue, to, time, number);
                }
            }
        }
    }

    /// Returns the seconds of a way in the weather of the walk, from the table.
    #[inline]
    fn seconds_on_plane(&self, SpreadStep { number, way, to, crossing }: SpreadStep<'_>) -> f64 {
        let seconds = |index: usize| self.interval.tables[usize::from(self.cells.fuel[index])].along[number].0;
        if crossing == Crossing::Uniform {
            return seconds(to);
        }
        way.crossed().iter().map(|&(place, part)| part * seconds(self.from.wrapping_add_signed(place))).sum()
    }

    /// Returns the same for a way whose wind is taken from its two ends.
    #[inline]
    fn smooth_step(&mut self, SpreadStep { number, way, to, crossing }: SpreadStep<'_>) -> Option<SmoothStep> {
        let here = self.here.filter(|_| is_short(way) && crossing == Crossing::Uniform)?;
        let there = spreading(self.rates, self.cells, self.interval.number, to);
        let length = self.lengths[number];
        let v = self.template.vectors[number];
        Some(SmoothStep { seconds: 0.5 * (here.seconds_over(length, v) + there.seconds_over(length, v)), there })
    }

    /// Returns when fire arrives along a way that takes this long in the weather of the walk.
    #[inline]
    fn arrival(&mut self, step: SpreadStep<'_>, seconds: Option<f64>) -> u64 {
        let until = self.interval.until;
        // Saturating: what burns too slowly arrives never, not in the past.
        let time = seconds.map(|seconds| self.now.saturating_add(nanos(seconds)));
        // In another weather: then it is not before this interval ends.
        let in_interval = time.filter(|&time| time <= until || self.cells.time[step.to] <= until);
        in_interval.unwrap_or_else(|| arrival_along(self.rates, self.cells, self.from, step.way, self.now))
    }

    /// Returns two burned cells on a plane, with ways over a fuel.
    #[inline]
    fn burned_on_plane(&self, fuel: u8, starts: [EdgeStart; 2]) -> BurnedPair {
        let FuelTable { slowness, along } = &self.interval.tables[usize::from(fuel)];
        let ends = starts.map(|start| BurnedEnd {
            ignited: self.cells.time[start.index],
            drift_s: along[start.way].1,
            // All cells that are crossed have the same ellipse.
            beyond_s: 0.0,
        });
        BurnedPair { slowness: *slowness, ends }
    }

    /// Returns two burned cells from which short ways lead, one of them that of the walk.
    #[inline]
    fn burned_in_smooth_wind(
        &mut self,
        SmoothStep { seconds, there }: SmoothStep,
        starts: [EdgeStart; 2],
    ) -> BurnedPair {
        let ends = starts.map(|EdgeStart { index, way }| {
            let length = self.lengths[way];
            let v = self.template.vectors[way];
            let along = there.seconds_over(length, v);
            let seconds = if index == self.from {
                seconds
            } else {
                let at_start = spreading(self.rates, self.cells, self.interval.number, index);
                0.5 * (at_start.seconds_over(length, v) + along)
            };
            BurnedEnd { ignited: self.cells.time[index], drift_s: there.drift_seconds(v), beyond_s: seconds - along }
        });
        BurnedPair { slowness: there.slowness, ends }
    }
}

/// Two burned cells from which ways lead to a third one, in one weather.
struct BurnedPair {
    /// Of that cell.
    slowness: f64,
    ends: [BurnedEnd; 2],
}

#[derive(Clone, Copy)]
struct BurnedEnd {
    ignited: u64,
    /// Seconds that the drift takes off its way.
    drift_s: f64,
    /// Seconds of its way beyond those of the ellipse of the cell that both ways lead to.
    beyond_s: f64,
}

/// The first fire from between two burned cells: when it comes, and the seconds by which the second counts as the later one.
struct FoundBetween {
    time: u64,
    later_s: f64,
}

impl BurnedPair {
    /// Returns the first fire from between them; `None` where it would come from beyond one of them, whose own way has it
    /// already.
    #[inline]
    fn first_between(self, pair: &Pair) -> Option<FoundBetween> {
        let Self { slowness, ends: [first, second] } = self;
        // Without the drift, which is linear along the line between the ends, the front is a circle's tangent.
        let mut later_s = seconds_between(first.ignited, second.ignited) - (second.drift_s - first.drift_s);
        later_s += second.beyond_s - first.beyond_s;
        pair.is_between(slowness, later_s).then(|| {
            let after_first = pair.seconds(slowness, later_s) - first.drift_s + first.beyond_s;
            FoundBetween { time: first.ignited.saturating_add(nanos(after_first)), later_s }
        })
    }
}

/// Makes it the plan of a cell if it comes before its plan so far.
#[inline]
fn offer(cells: &mut Cells, queue: &mut ArrivalQueue, index: usize, time: u64, way: usize) {
    if time < cells.time[index] {
        cells.time[index] = time;
        cells.way[index] = way as u16;
        queue.push(time, index as u32);
    }
}

/// Returns the two-point candidate of a cell from the beginnings of two ways over its fuel only, the second the
/// neighbour of the first counter-clockwise; `None` where the first fire does not come from between them.
fn two_point_arrival(
    rates: &mut Rates,
    cells: &Cells,
    template: &Template,
    to: usize,
    [first, second]: [EdgeStart; 2],
) -> Option<u64> {
    let first_time = cells.time[first.index];
    let second_time = cells.time[second.index];
    let latest = first_time.max(second_time);
    let number = rates.weather().interval_at(SimTime::from_nanos(latest));
    let ways = [first, second].map(|one| (one.index, &template.ways[one.way], template.vectors[one.way]));
    let is_plane = rates.is_plane();
    let has_pairs = is_plane || rates.smooth_gradient().is_some();
    let here = spreading(rates, cells, number, to);
    // Fuel that does not burn in this weather; in the next one a new plan is made.
    if here.slowness == f64::INFINITY {
        return None;
    }
    // Seconds of each way beyond the ellipse of the cell that both lead to.
    let beyond = |rates: &mut Rates, number: usize| {
        let here = spreading(rates, cells, number, to);
        ways.map(|(from, way, v)| {
            // On a plane all cells that are crossed have the same ellipse.
            if is_plane { 0.0 } else { way_seconds(rates, cells, number, from, way) - here.seconds(v) }
        })
    };
    let ignited = [first_time, second_time];
    let beyond_s = beyond(rates, number);
    let burned = [0, 1].map(|end| BurnedEnd {
        ignited: ignited[end],
        drift_s: here.drift_seconds(ways[end].2),
        beyond_s: beyond_s[end],
    });
    let pair = if has_pairs {
        let set = template.set(number);
        set.pairs[set.place(first.way).expect("the ways are neighbours in this interval")]
    } else {
        Pair::new(here.gradient, ways[0].2, ways[1].2)
    };
    let FoundBetween { time, later_s } = BurnedPair { slowness: here.slowness, ends: burned }.first_between(&pair)?;
    let time = time.max(latest);
    let (from, until) = span(rates, number);
    // All of it in one weather: the closed form is exact.
    if first_time.min(second_time) >= from && time <= until {
        return Some(time);
    }
    // Part of it is in another weather: along the straight line from the point that this weather gives.
    let part = pair.part(here.slowness, later_s);
    let v = ways[0].2 + part * (ways[1].2 - ways[0].2);
    let start = first_time as f64 + part * (second_time as f64 - first_time as f64);
    let time = progress(rates, start as u64, |rates, number| {
        let along = spreading(rates, cells, number, to).seconds(v);
        if is_plane || along == f64::INFINITY {
            return along;
        }
        let [first_beyond, second_beyond] = beyond(rates, number);
        along + (1.0 - part) * first_beyond + part * second_beyond
    });
    // Before both ends burned no front spanned them.
    Some(time.max(latest))
}

/// Whole nanoseconds of a span in seconds, which is not NaN; negative ones are zero, those too long [`NEVER`].
#[inline]
fn nanos(seconds: f64) -> u64 {
    (seconds * 1e9 + 0.5) as u64
}

#[inline]
fn seconds_between(from: u64, to: u64) -> f64 {
    to.wrapping_sub(from) as i64 as f64 * 1e-9
}

/// Returns when an interval of the weather begins and ends.
fn span(rates: &Rates, number: usize) -> (u64, u64) {
    let intervals = rates.weather().intervals();
    (intervals[number].from.as_nanos(), intervals.get(number + 1).map_or(NEVER, |next| next.from.as_nanos()))
}

fn spreading(rates: &mut Rates, cells: &Cells, number: usize, index: usize) -> Spreading {
    rates.spreading(number, cells.fuel[index], index, || cells.cell(index))
}

/// Says whether wind by place is taken from the two ends of a way.
#[inline]
fn is_short(way: &Edge) -> bool {
    way.cols.abs().max(way.rows.abs()) <= MAX_SMOOTH
}

/// Returns the seconds of a way in an interval of the weather.
fn way_seconds(rates: &mut Rates, cells: &Cells, number: usize, from: usize, way: &Edge) -> f64 {
    let v = vector(way, cells.frame.cell_m);
    let to = from.wrapping_add_signed(way.end);
    // In wind that changes little from cell to cell the mean of both ends is as exact as the sum, and much less work.
    if rates.smooth_gradient().is_some()
        && is_short(way)
        && cells.crossing_of_any(from, way, cells.fuel[to]) == Crossing::Uniform
    {
        let ends = [from, to].map(|index| spreading(rates, cells, number, index).seconds(v));
        return 0.5 * (ends[0] + ends[1]);
    }
    if rates.is_plane() && cells.crossing_of_any(from, way, cells.fuel[to]) == Crossing::Uniform {
        return spreading(rates, cells, number, to).seconds(v);
    }
    let crossed = way.crossed().iter();
    crossed
        .map(|&(place, part)| part * spreading(rates, cells, number, from.wrapping_add_signed(place)).seconds(v))
        .sum()
}

/// Returns when fire arrives along a way that it begins at a time.
fn arrival_along(rates: &mut Rates, cells: &Cells, from: usize, way: &Edge, start: u64) -> u64 {
    progress(rates, start, |rates, number| way_seconds(rates, cells, number, from, way))
}

/// Returns when something is done that is begun at a time and takes this many seconds in each interval of the weather.
fn progress(rates: &mut Rates, start: u64, mut seconds: impl FnMut(&mut Rates, usize) -> f64) -> u64 {
    let first = rates.weather().interval_at(SimTime::from_nanos(start));
    let (mut left, mut at) = (1.0, start);
    for number in first..rates.weather().intervals().len() {
        let (_, until) = span(rates, number);
        let whole = seconds(rates, number);
        let time = at.saturating_add(nanos(left * whole));
        if time <= until {
            return time;
        }
        // The share that is left takes another time in the next weather; rounding must not make it negative.
        left = (left - seconds_between(at, until) / whole).max(0.0);
        at = until;
    }
    NEVER
}
