//! Fireline: where crews build it, and when, so that a growing fire ends there.
//!
//! A crew builds on both flanks of the fire at once, each with half of its rate, from the head or from the rear of the fire
//! to where the flanks meet, as in Fried and Fried 1996, "Simulating wildfire containment with realistic tactics". A builder
//! is at some distance from the front, along its normal: it moves with the front, and along it with what its rate leaves. The
//! front is that of a forecast, the time at which fire comes to each cell if nobody fights it; between the centres of cells
//! times are interpolated. As a builder is never behind the front, fire that comes to the line is behind it, and the front
//! ahead of it is that of the forecast.
//!
//! Fried and Fried know ellipses and need no forecast: the same tactic is [`contain`](super::contain) there.

use crate::contain::Tactic;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};

/// Steps of a builder in a cell's width.
const STEPS_A_CELL: f64 = 4.0;

/// The most steps of a flank for each cell of the field: enough for a line that passes all of them.
const STEPS_OF_A_CELL: usize = 8;

/// Halvings of a builder's step, for a thousandth of a millimetre.
const BISECTIONS: u32 = 24;

/// Quarters of a cell outwards that are tried for a cell that has not burned.
const LOOKS_OUTWARDS: u32 = 8;

/// Times in seconds at which a fire comes to the centres of cells, infinite where it does not.
#[derive(Clone, Debug)]
pub struct Forecast {
    pub frame: FieldFrame,
    pub seconds: Vec<f64>,
}

impl Forecast {
    fn at_node(&self, col: i64, row: i64) -> f64 {
        let (cols, rows) = (i64::from(self.frame.cols), i64::from(self.frame.rows));
        let is_inside = (0..cols).contains(&col) && (0..rows).contains(&row);
        if is_inside { self.seconds[(row * cols + col) as usize] } else { f64::INFINITY }
    }

    /// Returns the time at a place and its gradient, in seconds per metre; `None` beside cells that do not burn.
    fn at(&self, place: DVec2) -> Option<(f64, DVec2)> {
        let scaled = place / self.frame.cell_m - DVec2::splat(0.5);
        let low = scaled.floor();
        let part = scaled - low;
        let (col, row) = (low.x as i64, low.y as i64);
        let (mut weights, mut time, mut slope) = (0.0, 0.0, DVec2::ZERO);
        for (cols, rows) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let node = |across: i64, up: i64| self.at_node(col + cols + across, row + rows + up);
            let here = node(0, 0);
            if here.is_finite() {
                let weight =
                    (if cols == 1 { part.x } else { 1.0 - part.x }) * (if rows == 1 { part.y } else { 1.0 - part.y });
                // One-sided beside cells that do not burn.
                let rise = |before: f64, after: f64| match (before.is_finite(), after.is_finite()) {
                    (true, true) => 0.5 * (after - before),
                    (true, false) => here - before,
                    (false, true) => after - here,
                    (false, false) => 0.0,
                };
                weights += weight;
                time += weight * here;
                slope += weight * DVec2::new(rise(node(-1, 0), node(1, 0)), rise(node(0, -1), node(0, 1)));
            }
        }
        let (time, slope) = (time / weights, slope / weights / self.frame.cell_m);
        (time.is_finite() && slope.length_squared() > 0.0).then_some((time, slope))
    }

    /// Moves a place along the gradient to where fire comes at a time; returns the outward normal too.
    fn on_front(&self, mut place: DVec2, time: f64) -> Option<(DVec2, DVec2)> {
        for _ in 0..4 {
            let (found, slope) = self.at(place)?;
            place += (time - found) / slope.length_squared() * slope;
        }
        let (_, slope) = self.at(place)?;
        Some((place, slope.normalize()))
    }

    /// Finds the head of the fire at a time, its point farthest from where it began, or the rear, the nearest.
    pub fn end_of_fire(&self, time: f64, tactic: Tactic) -> Option<DVec2> {
        let cells = || (0..self.seconds.len()).filter(|&index| self.seconds[index] <= time);
        let centre = |index: usize| self.frame.centre(self.frame.cell(index));
        let first = cells().min_by(|&a, &b| self.seconds[a].total_cmp(&self.seconds[b]))?;
        let origin = centre(first);
        let away = |place: &DVec2| (*place - origin).length();
        let is_at_edge = |index: usize| {
            let Cell { col, row } = self.frame.cell(index);
            let (col, row) = (i64::from(col), i64::from(row));
            let near = [(1, 0), (-1, 0), (0, 1), (0, -1)];
            near.into_iter().any(|(cols, rows)| self.at_node(col + cols, row + rows) > time)
        };
        let edge = cells().filter(|&index| is_at_edge(index)).filter_map(|index| self.on_front(centre(index), time));
        let places = edge.map(|(place, _)| place);
        match tactic {
            Tactic::Head => places.max_by(|a, b| away(a).total_cmp(&away(b))),
            Tactic::Rear => places.min_by(|a, b| away(a).total_cmp(&away(b))),
        }
    }
}

/// Builders of line, and their order.
#[derive(Clone, Copy)]
pub struct LineTask<'a> {
    /// When they begin.
    pub start_s: f64,
    /// The length that both flanks together build in a second at a time and place.
    pub rate_mps: &'a dyn Fn(f64, DVec2) -> f64,
    /// The greatest of these rates.
    pub most_mps: f64,
    /// No line is built from then on.
    pub until_s: f64,
}

/// A place of a builder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePoint {
    pub time_s: f64,
    pub place: DVec2,
    /// The normal of the front, or the direction away from what is protected.
    pub outwards: DVec2,
}

/// The way of the builders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Counter-clockwise from where the line begins, and clockwise.
    pub flanks: [Vec<LinePoint>; 2],
    /// True if the flanks meet.
    pub is_closed: bool,
}

/// A cell of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCell {
    pub cell: Cell,
    pub flank: usize,
    /// When it is finished.
    pub time_s: f64,
    /// The length of the flank up to there.
    pub along_m: f64,
}

/// A builder on a front: its place there, and the outward normal.
type OnFront = (DVec2, DVec2);

impl LineTask<'_> {
    /// Computes the line at a distance from the front. A flank ends where the builders meet, or where the front ends. Where
    /// the front outruns a builder, fire gets behind the line: all that is built is given up, and both builders begin again
    /// where the line began, by then farther out.
    pub fn along_front(&self, forecast: &Forecast, tactic: Tactic, offset_m: f64) -> Line {
        let start = forecast.end_of_fire(self.start_s, tactic);
        let mut anchor = start.and_then(|place| forecast.on_front(place, self.start_s));
        let mut builders = [anchor; 2];
        let mut is_closed = false;
        let point = |time_s: f64, (front, outwards): OnFront| {
            let place = front + offset_m * outwards;
            LinePoint { time_s, place, outwards }
        };
        let flanks = self.build(forecast, anchor.map(|at| point(self.start_s, at)), |time_s, lengths_m, flanks| {
            anchor = anchor.and_then(|(front, _)| forecast.on_front(front, time_s));
            for (flank, side) in [(0, 1.0), (1, -1.0)] {
                let Some(at) = builders[flank] else { continue };
                let next = step(forecast, offset_m, at, side, time_s, lengths_m[flank]);
                if next == Some(Step::Outrun) {
                    builders = [anchor; 2];
                    *flanks = [anchor; 2].map(|anchor| anchor.map(|at| point(time_s, at)).into_iter().collect());
                    return anchor.is_none();
                }
                builders[flank] = next.and_then(|next| if let Step::To(at) = next { Some(at) } else { None });
                flanks[flank].extend(builders[flank].map(|at| point(time_s, at)));
            }
            if let [Some(one), Some(other)] = builders {
                let between = point(time_s, other).place - point(time_s, one).place;
                let is_ahead = (other.0 - one.0).dot(one.1.perp()) > 0.0;
                is_closed = is_ahead && between.length() <= 1.5 * (lengths_m[0] + lengths_m[1]);
            }
            is_closed || builders == [None, None]
        });
        Line { flanks, is_closed }
    }

    /// Computes the line round a square about a place, half of its width away from it; it begins at the corner nearest to
    /// the builders.
    pub fn around(&self, forecast: &Forecast, centre: DVec2, half_m: f64, from: DVec2) -> Line {
        let corner = DVec2::new(half_m.copysign(from.x - centre.x), half_m.copysign(from.y - centre.y));
        let (mut passed, mut is_closed) = ([0.0; 2], false);
        let point = |time_s: f64, along_m: f64, side: f64| {
            let ways = if corner.x * corner.y * side > 0.0 {
                [corner.with_x(-corner.x), -corner]
            } else {
                [corner.with_y(-corner.y), -corner]
            };
            let (first, second) = (along_m.min(2.0 * half_m), (along_m - 2.0 * half_m).clamp(0.0, 2.0 * half_m));
            let outwards = corner + ((ways[0] - corner) * first + (ways[1] - ways[0]) * second) / (2.0 * half_m);
            LinePoint { time_s, place: centre + outwards, outwards: outwards.normalize() }
        };
        let flanks = self.build(forecast, Some(point(self.start_s, 0.0, 1.0)), |time_s, lengths_m, flanks| {
            for (flank, side) in [(0, 1.0), (1, -1.0)] {
                passed[flank] += lengths_m[flank];
                flanks[flank].push(point(time_s, passed[flank], side));
            }
            is_closed = passed.iter().all(|&passed| passed >= 4.0 * half_m);
            is_closed
        });
        Line { flanks, is_closed }
    }

    /// Lets both flanks advance in steps of a part of a cell: `advance` takes the time, their lengths, and the flanks to add
    /// to, and returns true when the line is finished.
    fn build(
        &self,
        forecast: &Forecast,
        start: Option<LinePoint>,
        mut advance: impl FnMut(f64, [f64; 2], &mut [Vec<LinePoint>; 2]) -> bool,
    ) -> [Vec<LinePoint>; 2] {
        let mut flanks = [start, start].map(|start| start.into_iter().collect::<Vec<_>>());
        let mut time_s = self.start_s;
        let step_s = forecast.frame.cell_m / STEPS_A_CELL / (self.most_mps / 2.0);
        for _ in 0..STEPS_OF_A_CELL * forecast.seconds.len() {
            let [Some(one), Some(other)] = [flanks[0].last(), flanks[1].last()] else { break };
            let rates = [one, other].map(|at| (self.rate_mps)(time_s, at.place) / 2.0);
            time_s += step_s;
            // Without a rate a step is infinite.
            if !time_s.is_finite() || time_s > self.until_s {
                break;
            }
            if advance(time_s, rates.map(|rate| rate * step_s), &mut flanks) {
                break;
            }
        }
        if flanks.iter().all(|flank| flank.len() < 2) { Default::default() } else { flanks }
    }
}

/// The end of a builder's step.
#[derive(Clone, Copy, PartialEq)]
enum Step {
    To(OnFront),
    /// Already the front moves farther than the builder can.
    Outrun,
}

/// Moves a builder with the front to a time, and along it so far that its own way has a length; `None` where the front ends.
fn step(forecast: &Forecast, offset_m: f64, at: OnFront, side: f64, time_s: f64, length_m: f64) -> Option<Step> {
    let (front, normal) = at;
    let from = front + offset_m * normal;
    let after = |passed: f64| {
        let (front, normal) = forecast.on_front(front + passed * side * normal.perp(), time_s)?;
        Some(((front, normal), (front + offset_m * normal - from).length()))
    };
    let (mut low, mut high) = (0.0, 2.0 * length_m);
    if after(low)?.1 > length_m {
        return Some(Step::Outrun);
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if after(middle)?.1 > length_m { high = middle } else { low = middle }
    }
    Some(Step::To(after(low)?.0))
}

impl Line {
    /// Returns the area within a closed line.
    pub fn area_m2(&self) -> f64 {
        let [one, other] = &self.flanks;
        let places: Vec<DVec2> = one.iter().chain(other.iter().rev()).map(|point| point.place).collect();
        let next = places.iter().cycle().skip(1);
        0.5 * places.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>().abs()
    }

    /// Returns the length of both flanks.
    pub fn length_m(&self) -> f64 {
        let pieces = self.flanks.iter().flat_map(|flank| flank.windows(2));
        pieces.map(|piece| (piece[1].place - piece[0].place).length()).sum()
    }

    /// Returns the cells to clear, by cell index: from every place of a builder the first cell outwards that fire has not
    /// come to by the time at which the builder is a cell ahead, which is when the cell is finished. One touches the next,
    /// at a side or at a corner, so that no front can step over them.
    pub fn cells(&self, forecast: &Forecast) -> Vec<LineCell> {
        let frame = &forecast.frame;
        let mut cells = Vec::new();
        for (flank, points) in self.flanks.iter().enumerate() {
            let (mut along_m, mut ahead) = (0.0, 0);
            for (number, point) in points.iter().enumerate() {
                along_m += (point.place - points[number.saturating_sub(1)].place).length();
                let is_near = |ahead: &LinePoint| (ahead.place - point.place).length() < frame.cell_m;
                while ahead + 1 < points.len() && (ahead < number || is_near(&points[ahead])) {
                    ahead += 1;
                }
                let time_s = points[ahead].time_s;
                let cell = (0..LOOKS_OUTWARDS).find_map(|look| {
                    let away_m = f64::from(look) * frame.cell_m / STEPS_A_CELL;
                    let cell = frame.cell_at(point.place + away_m * point.outwards)?;
                    (forecast.seconds[frame.index(cell)] > time_s).then_some(cell)
                });
                cells.extend(cell.map(|cell| LineCell { cell, flank, time_s, along_m }));
            }
        }
        cells.sort_by(|a, b| frame.index(a.cell).cmp(&frame.index(b.cell)).then(a.time_s.total_cmp(&b.time_s)));
        cells.dedup_by_key(|line| line.cell);
        cells
    }
}
