//! Bushes whose cells are smaller than a few pixels: every pixel has the colour of what it covers, by shares, and what burns is
//! marked, so that the fire of one cell is seen on a field of millions.
//!
//! A row of pixels follows from the states of the bushes below it alone. So a picture whose bushes change is brought up to date
//! by the rows where something changed, and is the same as one that is drawn again.

use std::ops::Range;

use crate::canvas::{Canvas, Point};
use crate::colours::{BURNING, INK, Rgb, bush_colour};
use crate::film::field::Pane;
use wildfire_base::geometry::{Cell, DVec2};
use wildfire_fire::BushStateKind;

/// Areas are counted in this part of a pixel's side, in whole numbers, which add up to the same in every order.
const PARTS: i32 = 256;
/// The parts of a whole pixel.
const WHOLE: u32 = (PARTS * PARTS) as u32;

/// Bushes that fire has changed count this many times, since they are few and what one looks for.
const EMPHASIS: u32 = 4;

/// A mark of fire from its middle to its edge, and its dark edge, in thin lines.
const HALF_MARK: f32 = 2.5;
const EDGE: f32 = 1.0;
/// The part of a mark that lies over agents too, so that none hides a fire.
const HALF_CORE: f32 = 1.0;

/// Where the edges of cells lie in a pane, in parts of a pixel, and which bushes there are.
pub struct HeatMap<'a> {
    bushes: &'a [Cell],
    /// The west edge of each column, and the east edge of the last.
    columns: Vec<i32>,
    /// The south edge of each row, and the north edge of the last; they get smaller.
    rows: Vec<i32>,
    /// Pixels from the first to the one after the last that the field has in the pane.
    across: Range<usize>,
    down: Range<usize>,
}

impl<'a> HeatMap<'a> {
    pub fn new(pane: &Pane<'a>) -> Self {
        let frame = pane.frame();
        let (width, height) = pane.size;
        let place =
            |col: u16, row: u16| pane.projection.place(DVec2::new(f64::from(col), f64::from(row)) * frame.cell_m);
        let columns: Vec<i32> = (0..=frame.cols).map(|col| in_parts(place(col, 0).x, width)).collect();
        let rows: Vec<i32> = (0..=frame.rows).map(|row| in_parts(place(0, row).y, height)).collect();
        let across = pixels(columns[0], columns[columns.len() - 1], width);
        let down = pixels(rows[rows.len() - 1], rows[0], height);
        Self { bushes: &pane.setting().bushes, columns, rows, across, down }
    }

    /// Draws all bushes on a canvas that has nothing but what is below them.
    pub fn draw(&self, canvas: &mut Canvas, kinds: &[BushStateKind]) {
        let mut shares = vec![[0; 4]; canvas.width() as usize];
        for row in self.down.clone() {
            self.draw_row(canvas, row, kinds, &mut shares);
        }
    }

    /// Brings a drawing of other states up to date; `below` is what lies below the bushes.
    pub fn redraw(&self, canvas: &mut Canvas, below: &Canvas, [before, now]: [&[BushStateKind]; 2]) {
        let changed = before.iter().zip(now).zip(self.bushes).filter(|((before, now), _)| before != now);
        let mut shares = vec![[0; 4]; canvas.width() as usize];
        let mut next = self.down.start;
        // Bushes are in order of rows, so that this goes down from the north, and no row of pixels is drawn twice.
        for (_, cell) in changed.rev() {
            let row = usize::from(cell.row);
            let last = pixel_of(self.rows[row] + PARTS - 1).min(self.down.end);
            for row in pixel_of(self.rows[row + 1]).max(next)..last {
                canvas.copy_row(below, row);
                self.draw_row(canvas, row, now, &mut shares);
            }
            next = next.max(last);
        }
    }

    /// Lays the bushes of a row of pixels over what is there. `shares` has room for them, and is zero before and after.
    fn draw_row(&self, canvas: &mut Canvas, pixel_row: usize, kinds: &[BushStateKind], shares: &mut [[u32; 4]]) {
        let top = pixel_row as i32 * PARTS;
        // Rows of bushes have one edge more than there are rows.
        let count = self.rows.len() - 1;
        // Only rows of bushes that the row of pixels touches are gone through, found by bisection.
        let first = self.rows[1..].partition_point(|&north| north >= top + PARTS);
        let end = self.rows[..count].partition_point(|&south| south > top);
        for row in first..end {
            let height = self.rows[row].min(top + PARTS) - self.rows[row + 1].max(top);
            let begins = self.bushes.partition_point(|bush| usize::from(bush.row) < row);
            let in_row = self.bushes[begins..].iter().zip(&kinds[begins..]);
            for (bush, &kind) in in_row.take_while(|(bush, _)| usize::from(bush.row) == row) {
                let [west, east] = [0, 1].map(|side| self.columns[usize::from(bush.col) + side]);
                let first = pixel_of(west).min(self.across.end);
                let end = pixel_of(east + PARTS - 1).min(self.across.end);
                for (pixel, shares) in (first..).zip(&mut shares[first..end]) {
                    let left = pixel as i32 * PARTS;
                    let width = east.min(left + PARTS) - west.max(left);
                    shares[kind as usize] += (width * height).unsigned_abs();
                }
            }
        }
        let pixels = &mut canvas.row_from(self.across.start, pixel_row)[..self.across.len()];
        // Taken and not copied: the next row of pixels needs shares of zero.
        for (pixel, shares) in pixels.iter_mut().zip(&mut shares[self.across.clone()]) {
            lay_shares(pixel, std::mem::take(shares));
        }
    }
}

/// Returns the pixels of a stretch of the map that lie within a side of the picture.
fn pixels(from: i32, to: i32, side: u32) -> Range<usize> {
    let end = pixel_of(to + PARTS - 1).min(side as usize);
    pixel_of(from).min(end)..end
}

/// A place along a side of the pane in parts of a pixel; what lies beyond the pane lies just beyond it.
fn in_parts(place: f64, side: u32) -> i32 {
    let parts = f64::from(PARTS);
    (place * parts).round().clamp(-parts, parts * (f64::from(side) + 1.0)) as i32
}

/// The pixel that a place in parts lies in, the first one if it lies before it.
fn pixel_of(parts: i32) -> usize {
    usize::try_from(parts.div_euclid(PARTS)).unwrap_or(0)
}

/// Mixes the colours of bushes into a pixel, by the parts of its area that bushes of each state cover.
fn lay_shares(pixel: &mut [u8; 4], shares: [u32; 4]) {
    let intact = BushStateKind::Intact as usize;
    let weights: [u32; 4] =
        std::array::from_fn(|kind| if kind == intact { shares[kind] } else { EMPHASIS * shares[kind] });
    let all: u32 = weights.iter().sum();
    if all == 0 {
        return;
    }
    // Signed, as the mixed colour may be darker than what lies below.
    let opacity = i64::from(all.min(WHOLE));
    let colours = BushStateKind::ALL.map(bush_colour);
    for (channel, under) in pixel[..3].iter_mut().enumerate() {
        let mixed: u32 = weights.iter().zip(&colours).map(|(weight, colour)| weight * u32::from(colour[channel])).sum();
        let mixed = i64::from(mixed / all);
        let was = i64::from(*under);
        *under = (was + (mixed - was) * opacity / i64::from(WHOLE)) as u8;
    }
}

/// Marks what burns at those places, under agents.
pub fn draw_fire_marks(canvas: &mut Canvas, pane: &Pane, fires: &[Point]) {
    for (beyond, colour) in [(EDGE, INK), (0.0, BURNING)] {
        draw_squares(canvas, pane, (HALF_MARK + beyond, colour), fires);
    }
}

/// Draws the middle of every mark of fire once more, over agents.
pub fn draw_fire_cores(canvas: &mut Canvas, pane: &Pane, fires: &[Point]) {
    draw_squares(canvas, pane, (HALF_CORE, BURNING), fires);
}

/// Draws squares of a colour about places, that many thin lines from the middle to the sides, and as large as a cell at least.
fn draw_squares(canvas: &mut Canvas, pane: &Pane, (half, colour): (f32, Rgb), places: &[Point]) {
    let half = (half * pane.unit()).max(0.5 * pane.cell_side());
    for &(x, y) in places {
        let [left, top, right, bottom] = [x - half, y - half, x + half, y + half].map(|at| at.round() as i32);
        canvas.fill_pixels((left, top), (right, bottom), colour);
    }
}

/// Returns the places in the pane of all bushes that burn and are not far beyond its edges.
pub fn burning_places(pane: &Pane) -> Vec<Point> {
    let bushes = pane.setting().bushes.iter().zip(&pane.view.state.bushes);
    let burning = bushes.filter(|(_, bush)| bush.burns()).map(|(&cell, _)| pane.cell_centre(cell));
    burning.filter(|&at| pane.is_near(at, pane.cell_side() + 4.0 * pane.unit())).collect()
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::Picture;
    use crate::colours::{FIELD, PAPER};
    use crate::film::field::FieldView;
    use crate::film::field::tests::setting;
    use crate::film::{Camera, Projection, RunView, ViewOptions};
    use wildfire_base::rng::{self, Xoshiro256PlusPlus};
    use wildfire_base::time::SimTime;
    use wildfire_timeline::Timeline;

    const SIZE: (u32, u32) = (120, 90);

    /// A square field of that many columns, every third cell of which has a bush.
    fn run(cols: u16, rng: &mut Xoshiro256PlusPlus) -> RunView {
        let mut setting = setting();
        (setting.frame.cols, setting.frame.rows) = (cols, cols);
        let cells = (0..setting.frame.cell_count()).map(|index| setting.frame.cell(index));
        setting.bushes = cells.filter(|_| rng.random_bool(0.3)).collect();
        RunView::new(Timeline { setting, events: Vec::new(), ground: Vec::new() }, None)
    }

    fn kinds(run: &RunView, rng: &mut Xoshiro256PlusPlus) -> Vec<BushStateKind> {
        run.timeline().setting.bushes.iter().map(|_| BushStateKind::ALL[rng.random_range(0..4)]).collect()
    }

    fn with_pane<T>(run: &RunView, camera: Camera, look: impl FnOnce(&Pane) -> T) -> T {
        let state = run.state_at(SimTime::ZERO);
        let options = ViewOptions::default();
        let view = FieldView { run, state: &state, rival: None, run_index: 0, options: &options };
        let size = (f64::from(SIZE.0), f64::from(SIZE.1));
        let projection = Projection::new(&run.timeline().setting.frame, camera, size);
        look(&Pane { view: &view, projection, size: SIZE })
    }

    /// The last one sees little of the field.
    fn cameras() -> [Camera; 4] {
        let camera = |x: f64, y: f64, zoom: f64| Camera { centre: DVec2::new(x, y), zoom };
        [Camera::WHOLE, camera(0.5, 0.5, 0.5), camera(0.1, 0.9, 2.3), camera(1.2, 0.0, 1.7)]
    }

    /// The colour of a pixel by looking which cells lie below a lattice of points in it.
    fn colour_by_points(pane: &Pane, kinds: &[BushStateKind], (x, y): (u32, u32)) -> [f64; 3] {
        const POINTS: u32 = 40;
        let mut weights = [0.0; 4];
        for point in 0..POINTS * POINTS {
            let part = |index: u32| (f64::from(index) + 0.5) / f64::from(POINTS);
            let right = part(point % POINTS);
            let down = part(point / POINTS);
            let at = pane.projection.world((f64::from(x) + right, f64::from(y) + down));
            let bush = pane.frame().cell_at(at).and_then(|cell| pane.setting().bush_index(cell));
            if let Some(kind) = bush.map(|bush| kinds[bush]) {
                weights[kind as usize] += if kind == BushStateKind::Intact { 1.0 } else { f64::from(EMPHASIS) };
            }
        }
        let all: f64 = weights.iter().sum();
        let opacity = (all / f64::from(POINTS * POINTS)).min(1.0);
        std::array::from_fn(|channel| {
            let colour = |kind: BushStateKind| f64::from(bush_colour(kind)[channel]);
            let mixed: f64 = BushStateKind::ALL.iter().zip(weights).map(|(&kind, weight)| weight * colour(kind)).sum();
            let under = f64::from(FIELD[channel]);
            under + (mixed / all.max(1.0) - under) * opacity
        })
    }

    fn drawn(pane: &Pane, kinds: &[BushStateKind]) -> Canvas {
        let mut canvas = Canvas::new(SIZE.0, SIZE.1, FIELD);
        HeatMap::new(pane).draw(&mut canvas, kinds);
        canvas
    }

    #[test]
    fn pixels_have_the_shares_of_what_they_cover() {
        let mut rng = rng::stream(1, "picture/heat_map/shares");
        for cols in [31, 70, 150, 400] {
            let run = run(cols, &mut rng);
            let kinds = kinds(&run, &mut rng);
            for camera in cameras() {
                with_pane(&run, camera, |pane| {
                    let picture: Picture = drawn(pane, &kinds).finish();
                    for _ in 0..60 {
                        let at = (rng.random_range(0..SIZE.0), rng.random_range(0..SIZE.1));
                        let seen = picture.pixel(at.0, at.1);
                        let expected = colour_by_points(pane, &kinds, at);
                        let is_near = seen.iter().zip(expected).all(|(&seen, is)| (f64::from(seen) - is).abs() < 14.0);
                        assert!(is_near, "{cols} columns, {camera:?}, {at:?}: {seen:?} is not {expected:?}");
                    }
                });
            }
        }
    }

    #[test]
    fn a_drawing_that_is_brought_up_to_date_is_one_drawn_again() {
        let mut rng = rng::stream(2, "picture/heat_map/redraw");
        let run = run(150, &mut rng);
        for camera in cameras() {
            with_pane(&run, camera, |pane| {
                let below = Canvas::new(SIZE.0, SIZE.1, PAPER);
                let mut before = kinds(&run, &mut rng);
                let mut kept = below.clone();
                HeatMap::new(pane).draw(&mut kept, &before);
                for changes in [0, 1, 2, 40, 5000] {
                    let mut now = before.clone();
                    for _ in 0..changes {
                        let bush = rng.random_range(0..now.len());
                        now[bush] = BushStateKind::ALL[rng.random_range(0..4)];
                    }
                    HeatMap::new(pane).redraw(&mut kept, &below, [&before, &now]);
                    let mut again = below.clone();
                    HeatMap::new(pane).draw(&mut again, &now);
                    assert!(kept.bytes() == again.bytes(), "{changes} changes, {camera:?}");
                    before = now;
                }
            });
        }
    }

    #[test]
    fn one_bush_that_burned_out_is_seen_among_intact_ones() {
        let mut rng = rng::stream(3, "picture/heat_map/one");
        let run = run(1000, &mut rng);
        let mut kinds = vec![BushStateKind::Intact; run.timeline().setting.bushes.len()];
        with_pane(&run, Camera::WHOLE, |pane| {
            let intact = drawn(pane, &kinds);
            for _ in 0..20 {
                let bush = rng.random_range(0..kinds.len());
                kinds[bush] = BushStateKind::BurnedOut;
                assert!(drawn(pane, &kinds).bytes() != intact.bytes(), "bush {bush}");
                kinds[bush] = BushStateKind::Intact;
            }
        });
    }
}
