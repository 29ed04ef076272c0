//! Fireline: where crews build it, and when, so that a growing fire ends there.
//!
//! Builders go along both flanks of the fire at once, each with half of the rate, from its head or rear to where they meet,
//! as in Fried and Fried 1996, "Simulating wildfire containment with realistic tactics". A builder is at some distance from
//! the front, along its normal: it moves with the front, and along it with what its rate leaves. The front is that of a
//! forecast for cells. For ellipses the same tactic has a closed form: [`contain`](super::contain). Line may also go through
//! given points, wherever the front is.

use crate::contain::Tactic;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};

/// Steps of a builder in a cell's width.
const STEPS_A_CELL: f64 = 4.0;

/// Halvings of a builder's step, for a thousandth of a millimetre, and steps outwards for a cell that has not burned.
const BISECTIONS: u32 = 24;
const LOOKS_OUTWARDS: u32 = 8;

/// Times in seconds at which a fire comes to the centres of cells, infinite where it does not.
#[derive(Clone, Debug)]
pub struct Forecast {
    pub frame: FieldFrame,
    pub seconds: Vec<f64>,
}

impl Forecast {
    /// Returns the time at a place and its gradient, in seconds per metre; `None` among cells that do not burn.
    fn at(&self, place: DVec2) -> Option<(f64, DVec2)> {
        // Times belong to centres of cells, which lie half a cell from their corners.
        let scaled = place / self.frame.cell_m - DVec2::splat(0.5);
        let low = scaled.floor();
        let part = scaled - scaled.floor();
        let mut weights = 0.0;
        let mut time = 0.0;
        let mut slope = DVec2::ZERO;
        for corner in [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE] {
            let node = |east: f64, north: f64| {
                let centre = (low + corner + DVec2::new(east, north) + DVec2::splat(0.5)) * self.frame.cell_m;
                self.frame
                    .cell_at(centre)
                    .map(|cell| self.seconds[self.frame.index(cell)])
                    .filter(|time| time.is_finite())
            };
            // Such a corner has no weight, which the division by the weights below makes up for.
            let Some(here) = node(0.0, 0.0) else { continue };
            // One-sided beside cells that do not burn.
            let rise = |before: Option<f64>, after: Option<f64>| {
                // A cell with neither side has no rise, and must not divide 0 by 0.
                let sides = f64::from(u8::from(before.is_some()) + u8::from(after.is_some())).max(1.0);
                (after.unwrap_or(here) - before.unwrap_or(here)) / sides
            };
            let near = DVec2::ONE - (corner - part).abs();
            weights += near.x * near.y;
            time += near.x * near.y * here;
            slope += near.x
                * near.y
                * DVec2::new(rise(node(-1.0, 0.0), node(1.0, 0.0)), rise(node(0.0, -1.0), node(0.0, 1.0)));
        }
        let time = time / weights;
        let slope = slope / weights / self.frame.cell_m;
        // Among cells that do not burn all weights are 0 and the time is NaN; on a plateau there is no normal.
        (time.is_finite() && slope.length_squared() > 0.0).then_some((time, slope))
    }

    /// Moves a place along the gradient to where fire comes at a time; returns the outward normal too.
    fn on_front(&self, mut place: DVec2, time: f64) -> Option<OnFront> {
        for _ in 0..4 {
            let (found, slope) = self.at(place)?;
            place += (time - found) / slope.length_squared() * slope;
        }
        Some((place, self.at(place)?.1.normalize()))
    }

    /// Finds the head of the fire at a time, its point farthest from where it began, or the rear, the nearest that it has
    /// not passed.
    pub fn end_of_fire(&self, time: f64, tactic: Tactic) -> Option<DVec2> {
        let centre = |index: usize| self.frame.centre(self.frame.cell(index));
        let cells = || (0..self.seconds.len()).filter(|index| self.seconds[*index].is_finite());
        let first = cells().min_by(|&a, &b| self.seconds[a].total_cmp(&self.seconds[b]));
        let origin = centre(first.filter(|&first| self.seconds[first] <= time)?);
        let away = |&a: &usize, &b: &usize| (centre(a) - origin).length().total_cmp(&(centre(b) - origin).length());
        let end = match tactic {
            Tactic::Head => cells().filter(|&index| self.seconds[index] <= time).max_by(away),
            Tactic::Rear => cells().filter(|&index| self.seconds[index] > time).min_by(away),
        };
        Some(self.on_front(centre(end?), time)?.0)
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
    pub max_mps: f64,
    /// No line is built from then on.
    pub until_s: f64,
}

/// The way of the builders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Times in seconds, places and normals of the front, counter-clockwise from where the line begins, and clockwise. Line
    /// through given points has normals of length zero.
    pub flanks: [Vec<(f64, DVec2, DVec2)>; 2],
    /// True if the flanks meet at a front.
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
    /// When a fire that nobody fights comes there, and in which direction.
    pub front: Option<(f64, DVec2)>,
}

/// A builder on a front: its place there, and the outward normal.
type OnFront = (DVec2, DVec2);

impl LineTask<'_> {
    /// Computes the line at a distance from the front. A flank ends where the builders meet, or where the front ends. Where
    /// the front outruns a builder, fire gets behind the line: all that is built is given up, and both builders begin again
    /// where the line began, by then farther out.
    pub fn along_front(&self, forecast: &Forecast, tactic: Tactic, offset_m: f64) -> Line {
        let mut line = Line::default();
        let start = forecast.end_of_fire(self.start_s, tactic);
        let Some(mut anchor) = start.and_then(|place| forecast.on_front(place, self.start_s)) else { return line };
        // A flank has half of the greatest rate, so no builder passes a cell between two steps.
        let step_s = forecast.frame.cell_m / STEPS_A_CELL / (self.max_mps / 2.0);
        let place = |(front, outwards): OnFront| front + offset_m * outwards;
        let mut time_s = self.start_s;
        let mut builders = [Some(anchor); 2];
        // Enough for a line that passes all cells.
        for _ in 0..8 * forecast.seconds.len() {
            // Without a rate a step is infinite.
            if line.is_closed || builders == [None, None] || time_s + step_s > self.until_s {
                break;
            }
            let mut lengths_m = [0.0; 2];
            // The place where both would begin again moves with the front too.
            let Some(with_front) = forecast.on_front(anchor.0, time_s + step_s) else { break };
            anchor = with_front;
            for (flank, side) in [(0, 1.0), (1, -1.0)] {
                let Some(at) = builders[flank] else { continue };
                lengths_m[flank] = (self.rate_mps)(time_s, place(at)) / 2.0 * step_s;
                let (next, is_outrun) = step(forecast, offset_m, at, side, time_s + step_s, lengths_m[flank]);
                if is_outrun {
                    builders = [Some(anchor); 2];
                    line.flanks = Default::default();
                    break;
                }
                builders[flank] = next;
                line.flanks[flank].extend(next.map(|at| (time_s + step_s, place(at), at.1)));
            }
            time_s += step_s;
            if let [Some(one), Some(other)] = builders {
                let between = place(other) - place(one);
                // At the start they are as near to each other, but have the fire still before them.
                let is_ahead = (other.0 - one.0).dot(one.1.perp()) > 0.0;
                line.is_closed = is_ahead && between.length() <= 1.5 * (lengths_m[0] + lengths_m[1]);
            }
        }
        line
    }

    /// Computes the line along two polylines at once, each with half of the rate, or along one with all of it if the other is
    /// empty. A flank ends where nobody builds.
    pub fn along_points(&self, flanks: [&[DVec2]; 2], frame: &FieldFrame) -> Line {
        let share = 1.0 / flanks.iter().filter(|points| !points.is_empty()).count() as f64;
        let build = |points: &[DVec2]| {
            let mut time_s = self.start_s;
            let mut built: Vec<(f64, DVec2, DVec2)> = Vec::new();
            // Enough for line in all cells.
            for place in places_along(points, frame.cell_m / STEPS_A_CELL).take(4 * frame.cell_count()) {
                let rate_mps = share * (self.rate_mps)(time_s, place);
                if rate_mps <= 0.0 {
                    break;
                }
                time_s += built.last().map_or(0.0, |&(_, before, _)| (place - before).length()) / rate_mps;
                if time_s > self.until_s {
                    break;
                }
                built.push((time_s, place, DVec2::ZERO));
            }
            built
        };
        Line { flanks: flanks.map(build), is_closed: false }
    }
}

/// Lists places along a polyline, its corners among them, that are at most `step_m` apart.
pub fn places_along(points: &[DVec2], step_m: f64) -> impl Iterator<Item = DVec2> {
    points.first().copied().into_iter().chain(points.windows(2).flat_map(move |ends| {
        let (from, way) = (ends[0], ends[1] - ends[0]);
        let steps = (way.length() / step_m).ceil() as u32;
        (1..=steps).map(move |step| from + f64::from(step) / f64::from(steps) * way)
    }))
}

/// Moves a builder with the front to a time, and along it so far that its own way has a length; `None` where the front ends,
/// and true where already the front moves farther.
fn step(
    forecast: &Forecast,
    offset_m: f64,
    (front, normal): OnFront,
    side: f64,
    time_s: f64,
    length_m: f64,
) -> (Option<OnFront>, bool) {
    let from = front + offset_m * normal;
    let after = |passed: f64| forecast.on_front(front + passed * side * normal.perp(), time_s);
    let is_too_far =
        |at: Option<OnFront>| at.is_some_and(|(front, normal)| (front + offset_m * normal - from).length() > length_m);
    let (mut low, mut high) = (0.0, 2.0 * length_m);
    if is_too_far(after(low)) {
        return (None, true);
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if is_too_far(after(middle)) { high = middle } else { low = middle }
    }
    (after(low), false)
}

impl Line {
    /// Returns the cells to clear, in order of time: from every place of a builder the first cell outwards that fire has not
    /// come to by the time at which the builder is a cell ahead, which is when the cell is finished; of line through given
    /// points the cell there, burned or not. One touches the next, at a side or at a corner, so that no front can step over
    /// them.
    pub fn cells(&self, forecast: &Forecast) -> Vec<LineCell> {
        let frame = &forecast.frame;
        let mut cells = Vec::new();
        for (flank, points) in self.flanks.iter().enumerate() {
            let (mut along_m, mut ahead) = (0.0, 0);
            for (number, &(_, place, outwards)) in points.iter().enumerate() {
                let away_m = |other: usize| (points[other].1 - place).length();
                along_m += away_m(number.saturating_sub(1));
                while ahead + 1 < points.len() && (ahead < number || away_m(ahead) < frame.cell_m) {
                    ahead += 1;
                }
                let time_s = points[ahead].0;
                let cell = (0..LOOKS_OUTWARDS).find_map(|look| {
                    let away_m = f64::from(look) * frame.cell_m / STEPS_A_CELL;
                    let cell = frame.cell_at(place + away_m * outwards)?;
                    (outwards == DVec2::ZERO || forecast.seconds[frame.index(cell)] > time_s).then_some(cell)
                });
                let front = forecast.at(place);
                cells.extend(cell.map(|cell| LineCell { cell, flank, time_s, along_m, front }));
            }
        }
        // By cell first, so that of the builders that come to a cell the earliest stays.
        cells.sort_by(|a, b| frame.index(a.cell).cmp(&frame.index(b.cell)).then(a.time_s.total_cmp(&b.time_s)));
        // The first crew to arrive clears the cell; later ones find it done.
        cells.dedup_by_key(|line| line.cell);
        cells.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.along_m.total_cmp(&b.along_m)));
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_goes_through_points_at_the_rate_of_its_builders_and_ends_where_nobody_builds() {
        let frame = FieldFrame { cols: 40, rows: 40, cell_m: 5.0 };
        let forecast = Forecast { frame, seconds: vec![0.0; frame.cell_count()] };
        let corners = [(12.0, 12.0), (150.0, 40.0), (150.0, 120.0), (30.0, 180.0)].map(|(x, y)| DVec2::new(x, y));
        let length_m: f64 = corners.windows(2).map(|ends| (ends[1] - ends[0]).length()).sum();
        let build = |until_s: f64, rate_mps: &dyn Fn(f64, DVec2) -> f64, other: &[DVec2]| {
            let task = LineTask { start_s: 100.0, rate_mps, max_mps: 0.5, until_s };
            task.along_points([&corners, other], &frame)
        };
        let line = build(1e6, &|_, _| 0.5, &[]);
        let &(end_s, end, _) = line.flanks[0].last().expect("it is built");
        assert!((end_s - 100.0 - length_m / 0.5).abs() < 1e-6 && end == corners[3], "{end_s} {end}");
        let cells = line.cells(&forecast);
        let gap = |pair: &[LineCell]| {
            let [one, other] = [pair[0].cell, pair[1].cell];
            one.col.abs_diff(other.col).max(one.row.abs_diff(other.row))
        };
        assert!(cells.windows(2).all(|pair| gap(pair) == 1), "each cell touches the next");
        assert!(cells.windows(2).all(|pair| pair[0].time_s <= pair[1].time_s && pair[0].along_m < pair[1].along_m));
        assert!((cells.last().expect("it has cells").along_m - length_m).abs() < 5.0, "burned ground is no gap yet");
        let both = build(1e6, &|_, _| 0.5, &corners);
        assert!((both.flanks[1].last().expect("it is built").0 - 100.0 - length_m / 0.25).abs() < 1e-6);
        let road = build(1e6, &|_, place| if place.y > 100.0 { 0.0 } else { 0.5 }, &[]);
        assert!((95.0..=100.0).contains(&road.flanks[0].last().expect("it is built").1.y));
        assert!(build(150.0, &|_, _| 0.5, &[]).flanks[0].last().expect("it is built").0 <= 150.0);
        assert_eq!(build(1e6, &|_, _| 0.0, &[]), Line::default());
    }
}
