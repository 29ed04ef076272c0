//! One map with its annotations: title above; scale bar, north arrow, colour bar and key below.

use crate::canvas::{Canvas, Point};
use crate::colours::{FAINT_INK, INK, PAPER, Rgb, WITHOUT_VALUE};
use crate::contours::{ContourLine, contour_lines};
use crate::field_map::{FieldMap, MapQuantity, MapScale};
use crate::ground::{GroundCover, hillshade};
use crate::marks::{Mark, to_f32};
use crate::text::{Align, draw_text, draw_text_on, measure_text};
use crate::ticks::{Tick, round_step};
use crate::zoom::Zoom;
use wildfire_base::geometry::{Cell, DVec2, compass};
use wildfire_grid::Grid;

/// All in pixels where capitals are [`TEXT`] pixels high; larger maps scale all of them.
const TITLE: f32 = 12.0;
const TEXT: f32 = 9.0;
const LINE: f32 = 21.0;
const GAP: f32 = 12.0;
const BAR: f32 = 14.0;
const TICK: f32 = 4.0;
const SYMBOL: f32 = 22.0;
const MIN_WIDTH: f32 = 300.0;
const LINE_WIDTH: f32 = 1.2;
/// Lines of fewer pixels have no label.
const MIN_LABELLED: f32 = 80.0;
/// The longer side of a map from which on texts grow with it.
const USUAL_LENGTH: f32 = 1000.0;
/// More ignitions than this are marked by small dots.
const MANY_IGNITIONS: usize = 30;
/// Arrows of direction are at least this far apart.
const BETWEEN_ARROWS: f32 = 26.0;

const NOTHING: Rgb = [246, 245, 241];
const BARE: Rgb = [158, 148, 137];

/// A map and the places of its parts.
pub struct Panel<'a> {
    map: &'a FieldMap<'a>,
    scale: Option<MapScale>,
    zoom: Zoom,
    unit: f32,
    /// Entries of the key, and those that begin a new line.
    key: Vec<(KeySymbol, String)>,
    lines: Vec<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum KeySymbol {
    Cell(Rgb),
    Contour(Rgb),
    Ignition,
    Arrow,
}

impl<'a> Panel<'a> {
    /// `side` is the usual length of the longer side in pixels, `longest` its most.
    pub fn new(map: &'a FieldMap<'a>, scale: Option<MapScale>, side: usize, longest: usize) -> Self {
        let rows = usize::from(map.frame.rows);
        let cols = usize::from(map.frame.cols);
        let zoom = Zoom::fit_to(rows, cols, side, longest);
        let unit = (zoom.length(rows.max(cols)) as f32 / USUAL_LENGTH).max(1.0);
        let mut panel = Self { map, scale, zoom, unit, key: Vec::new(), lines: Vec::new() };
        panel.key = panel.key_entries();
        panel.lines = panel.break_lines();
        panel
    }

    /// The factor by which texts and marks are larger than usual.
    pub fn unit(&self) -> f32 {
        self.unit
    }

    fn map_size(&self) -> (f32, f32) {
        let frame = &self.map.frame;
        (self.zoom.length(frame.cols.into()) as f32, self.zoom.length(frame.rows.into()) as f32)
    }

    pub fn width(&self) -> f32 {
        self.map_size().0.max(MIN_WIDTH * self.unit).max(measure_text(self.map.title, TITLE * self.unit))
    }

    pub fn height(&self) -> f32 {
        let bar = if self.scale.is_some() { 2.0 * LINE + BAR + 2.0 * TICK } else { 0.0 };
        let key = self.lines.len() as f32 * LINE;
        self.map_size().1 + (TITLE + GAP + GAP + LINE + bar + key) * self.unit
    }

    pub fn draw(&self, canvas: &mut Canvas, (left, top): Point) {
        let unit = self.unit;
        draw_text(canvas, self.map.title, (left, top + TITLE * unit), Align::Left, TITLE * unit, INK);
        let corner = (left, (top + (TITLE + GAP) * unit).round());
        let (width, height) = self.map_size();
        canvas.fill_rect(corner.0 - 1.0, corner.1 - 1.0, width + 2.0, height + 2.0, FAINT_INK);
        self.paint(canvas, corner);
        if self.map.quantity == MapQuantity::Direction {
            self.draw_arrows(canvas, corner);
        }
        self.draw_contours(canvas, corner);
        self.mark_ignitions(canvas, corner);
        let mut y = corner.1 + height + GAP * unit;
        self.draw_length_bar(canvas, (left, y));
        draw_north(canvas, (left + width - 10.0 * unit, y), unit);
        y += LINE * unit;
        if let Some(scale) = &self.scale {
            draw_text(canvas, &scale.name, (left, y + 14.0 * unit), Align::Left, TEXT * unit, INK);
            y += LINE * unit;
            draw_bar(canvas, scale, ((left, y), self.width()), unit);
            y += (BAR + LINE + 2.0 * TICK) * unit;
        }
        self.draw_key(canvas, (left, y));
    }

    fn paint(&self, canvas: &mut Canvas, (left, top): Point) {
        let frame = &self.map.frame;
        let rows = usize::from(frame.rows);
        let cols = usize::from(frame.cols);
        let pixels = self.zoom.pixels;
        let mut line = vec![[255; 4]; self.zoom.length(cols)];
        for block_row in 0..self.zoom.blocks(rows) {
            let row = rows - 1 - self.zoom.middle(block_row, rows);
            for (block_col, block) in line.chunks_exact_mut(pixels).enumerate() {
                let cell = Cell { col: self.zoom.middle(block_col, cols) as u16, row: row as u16 };
                let [red, green, blue] = self.colour(cell);
                block.fill([red, green, blue, 255]);
            }
            // One line of pixels is made and copied, since all pixels of a cell's row are equal.
            for copy in 0..pixels {
                let below = block_row * pixels + copy;
                canvas.row_from(left as usize, top as usize + below)[..line.len()].copy_from_slice(&line);
            }
        }
    }

    fn colour(&self, cell: Cell) -> Rgb {
        let index = self.map.frame.index(cell);
        let value = self.map.values[index];
        if let Some(scale) = self.scale.as_ref().filter(|_| value.is_finite()) {
            return scale.colour(value);
        }
        let cover = self.map.covers[index];
        let ground = self.map.landscape.filter(|_| cover != GroundCover::Water);
        hillshade(ground_colour(cover), ground.map_or(DVec2::ZERO, |ground| ground.gradient(cell)))
    }

    /// A place among the centres of cells, columns and rows from the south, on the sheet.
    fn place(&self, (left, top): Point, (col, row): (f64, f64)) -> Point {
        let cell = f64::from(self.zoom.cell());
        let rows = f64::from(self.map.frame.rows);
        (left + to_f32((col + 0.5) * cell), top + to_f32((rows - 0.5 - row) * cell))
    }

    fn levels(&self) -> &[Tick] {
        match &self.scale {
            Some(scale) if self.map.has_contours => &scale.ticks,
            _ => &[],
        }
    }

    fn draw_contours(&self, canvas: &mut Canvas, corner: Point) {
        let levels = self.levels();
        let Some(scale) = self.scale.as_ref().filter(|_| !levels.is_empty()) else { return };
        let frame = &self.map.frame;
        let values = Grid::from_values(frame.rows.into(), frame.cols.into(), self.map.values.to_vec());
        let mut labels: Vec<(Point, &str, Rgb)> = Vec::new();
        for tick in levels {
            let colour = line_colour(scale.colour(tick.value));
            let lines = contour_lines(&values, tick.value);
            for line in &lines {
                let points: Vec<Point> = line.points.iter().map(|&at| self.place(corner, at)).collect();
                canvas.polyline(&points, LINE_WIDTH * self.unit, colour);
            }
            // A level may have many lines, and the longest is the one that a reader follows.
            let longest = lines.iter().max_by(|a, b| a.length().total_cmp(&b.length()));
            let label = longest.and_then(|line| self.label_place(corner, line, &tick.label, &labels));
            labels.extend(label.map(|at| (at, tick.label.as_str(), colour)));
        }
        // Labels come after all lines, so that none runs through one.
        for (at, label, colour) in labels {
            let halo = if colour == PAPER { INK } else { PAPER };
            draw_text_on(canvas, label, at, Align::Centre, TEXT * self.unit, colour, halo);
        }
    }

    /// The place of a label on a line: inside the map and away from other labels; `None` if there is none.
    fn label_place(
        &self,
        corner: Point,
        line: &ContourLine,
        label: &str,
        others: &[(Point, &str, Rgb)],
    ) -> Option<Point> {
        if to_f32(line.length()) * self.zoom.cell() < MIN_LABELLED * self.unit {
            return None;
        }
        let (width, height) = self.map_size();
        let size = TEXT * self.unit;
        let half = 0.5 * measure_text(label, size) + size;
        let count = line.points.len();
        // The middle first, then places that halve what is left.
        let shares = [(1, 2), (1, 4), (3, 4), (1, 8), (3, 8), (5, 8), (7, 8)];
        let places = shares.map(|(part, of)| self.place(corner, line.points[count * part / of]));
        let places = places.map(|(x, y)| (x, y + 0.5 * size));
        places.into_iter().find(|&(x, base)| {
            let (right, down) = (x - corner.0, base - corner.1);
            let is_inside = right > half && right < width - half && down > 2.0 * size && down < height - size;
            let is_free = others.iter().all(|&((other_x, other_base), other, _)| {
                let apart = half + 0.5 * measure_text(other, size) + size;
                (x - other_x).abs() > apart || (base - other_base).abs() > 2.5 * size
            });
            is_inside && is_free
        })
    }

    /// Draws arrows on a lattice, each as its cell says: colours of directions alone are not distinguished by everybody.
    fn draw_arrows(&self, canvas: &mut Canvas, corner: Point) {
        let frame = &self.map.frame;
        let step = (BETWEEN_ARROWS * self.unit / self.zoom.cell()).ceil().max(1.0) as usize;
        let length = 0.36 * BETWEEN_ARROWS * self.unit;
        for row in (step / 2..usize::from(frame.rows)).step_by(step) {
            for col in (step / 2..usize::from(frame.cols)).step_by(step) {
                let azimuth = self.map.values[frame.index(Cell { col: col as u16, row: row as u16 })];
                if azimuth.is_finite() {
                    draw_arrow(canvas, self.place(corner, (col as f64, row as f64)), azimuth, length, self.unit);
                }
            }
        }
    }

    fn mark_ignitions(&self, canvas: &mut Canvas, corner: Point) {
        let radius = if self.map.ignitions.len() > MANY_IGNITIONS { 2.6 } else { 6.0 } * self.unit;
        for &cell in self.map.ignitions {
            Mark::Start.draw(canvas, self.place(corner, (f64::from(cell.col), f64::from(cell.row))), radius);
        }
    }

    /// A bar of a round length at most a third as long as the map.
    fn draw_length_bar(&self, canvas: &mut Canvas, (left, top): Point) {
        let frame = &self.map.frame;
        let metres_per_pixel = frame.cell_m / f64::from(self.zoom.cell());
        let max = 0.33 * f64::from(self.map_size().0) * metres_per_pixel;
        // The round length above a fifth of the most is no longer than the most.
        let metres = [5.0, 2.5, 2.0, 1.0].map(|part| round_step(max / part)).into_iter().filter(|&step| step <= max);
        let metres = metres.fold(0.0, f64::max);
        let length = to_f32(metres / metres_per_pixel).round();
        let unit = self.unit;
        let label = if metres < 1000.0 { format!("{metres} m") } else { format!("{} km", metres / 1000.0) };
        let (y, thick) = (top + 8.0 * unit, 2.0 * unit);
        canvas.fill_rect(left, y, length, thick, INK);
        for end in [left, left + length - thick] {
            canvas.fill_rect(end, y - 4.0 * unit, thick, 4.0 * unit + thick, INK);
        }
        draw_text(canvas, &label, (left + length + 8.0 * unit, y + 3.0 * unit), Align::Left, TEXT * unit, INK);
    }

    /// Lists what has no value and what is marked, as far as it is present.
    fn key_entries(&self) -> Vec<(KeySymbol, String)> {
        let mut entries = Vec::new();
        // Of each class the number of cells without a value, and the sum of their colours: slopes are lit.
        let mut present = [(0.0, [0.0; 3]); 8];
        for (index, (value, &cover)) in self.map.values.iter().zip(self.map.covers).enumerate() {
            if !value.is_finite() {
                let (count, sums) = &mut present[cover as usize];
                *count += 1.0;
                sums.iter_mut()
                    .zip(self.colour(self.map.frame.cell(index)))
                    .for_each(|(sum, it)| *sum += f64::from(it));
            }
        }
        let mut add = |covers: &[GroundCover], name: &str| {
            let there = || covers.iter().map(|&cover| present[cover as usize]);
            let count: f64 = there().map(|(count, _)| count).sum();
            if count > 0.0 {
                entries.push((
                    KeySymbol::Cell(std::array::from_fn(|channel| {
                        (there().map(|(_, sums)| sums[channel]).sum::<f64>() / count).round() as u8
                    })),
                    name.to_owned(),
                ));
            }
        };
        // All that could burn is one entry: a missing value means the same on each kind of vegetation.
        add(&[GroundCover::Grass, GroundCover::Shrub, GroundCover::Timber, GroundCover::Slash], self.map.without_value);
        for cover in [GroundCover::Water, GroundCover::Road, GroundCover::Bare, GroundCover::Nothing] {
            add(&[cover], cover.name());
        }
        if let [first, second, ..] = self.levels() {
            let unit = self.scale.as_ref().and_then(|scale| scale.name.split_once(", ")).map_or("", |(_, unit)| unit);
            let step = match (first.label.parse::<f64>(), second.label.parse::<f64>()) {
                (Ok(first), Ok(second)) => format!("every {} {unit}", second - first),
                _ => "contour".to_owned(),
            };
            entries.push((KeySymbol::Contour(INK), step.trim_end().to_owned()));
        }
        if !self.map.ignitions.is_empty() {
            entries.push((KeySymbol::Ignition, "ignition".to_owned()));
        }
        if self.map.quantity == MapQuantity::Direction {
            entries.push((KeySymbol::Arrow, "direction of spread".to_owned()));
        }
        entries
    }

    fn entry_width(&self, name: &str) -> f32 {
        (SYMBOL + GAP) * self.unit + measure_text(name, TEXT * self.unit)
    }

    /// Which entries begin a line.
    fn break_lines(&self) -> Vec<usize> {
        let mut lines = Vec::new();
        let mut used = f32::INFINITY;
        for (index, (_, name)) in self.key.iter().enumerate() {
            let width = self.entry_width(name);
            if used + width > self.width() + GAP * self.unit {
                lines.push(index);
                used = 0.0;
            }
            used += width;
        }
        lines
    }

    fn draw_key(&self, canvas: &mut Canvas, (left, top): Point) {
        let unit = self.unit;
        let (mut x, mut y) = (left, top - LINE * unit);
        for (index, (symbol, name)) in self.key.iter().enumerate() {
            if self.lines.contains(&index) {
                (x, y) = (left, y + LINE * unit);
            }
            let right = x + 16.0 * unit;
            let middle = y + 8.0 * unit;
            match *symbol {
                KeySymbol::Cell(colour) => {
                    canvas.fill_rect(x, y + unit, 15.0 * unit, 15.0 * unit, FAINT_INK);
                    canvas.fill_rect(x + unit, y + 2.0 * unit, 13.0 * unit, 13.0 * unit, colour);
                }
                KeySymbol::Contour(colour) => {
                    canvas.polyline(&[(x, middle), (right, middle)], LINE_WIDTH * unit, colour);
                }
                KeySymbol::Ignition => Mark::Start.draw(canvas, (x + 8.0 * unit, middle), 6.0 * unit),
                KeySymbol::Arrow => draw_arrow(canvas, (x + 8.0 * unit, middle), 90.0, 8.0 * unit, unit),
            }
            draw_text(canvas, name, (x + SYMBOL * unit, y + 13.0 * unit), Align::Left, TEXT * unit, INK);
            x += self.entry_width(name);
        }
    }
}

/// The colour of ground without a value.
fn ground_colour(cover: GroundCover) -> Rgb {
    match cover {
        GroundCover::Nothing => NOTHING,
        GroundCover::Bare => BARE,
        GroundCover::Water | GroundCover::Road => cover.colour(),
        GroundCover::Grass | GroundCover::Shrub | GroundCover::Timber | GroundCover::Slash => WITHOUT_VALUE,
    }
}

/// Dark on light colours, white on dark ones.
fn line_colour([red, green, blue]: Rgb) -> Rgb {
    // Weights of brightness after ITU-R BT.601.
    let brightness = 0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue);
    if brightness > 110.0 { INK } else { PAPER }
}

fn draw_bar(canvas: &mut Canvas, scale: &MapScale, ((left, top), width): (Point, f32), unit: f32) {
    let height = BAR * unit;
    canvas.fill_rect(left - 1.0, top - 1.0, width + 2.0, height + 2.0, FAINT_INK);
    let columns = width.round();
    let mut column = 0.0;
    while column < columns {
        let colour = scale.shade(f64::from((column + 0.5) / columns));
        canvas.fill_rect(left + column, top, 1.0, height, colour);
        column += 1.0;
    }
    let mut free_from = f32::NEG_INFINITY;
    for tick in &scale.ticks {
        let x = left + width * to_f32(scale.fraction(tick.value));
        canvas.fill_rect(x - 0.5 * unit, top + height + 1.0, unit, TICK * unit, INK);
        let half = 0.5 * measure_text(&tick.label, TEXT * unit);
        // Labels at the ends stay within the panel; where two would touch, the second is left out.
        let middle = x.clamp(left + half, (left + width - half).max(left + half));
        if middle - half > free_from {
            let base = top + height + (2.0 * TICK + TEXT) * unit;
            draw_text(canvas, &tick.label, (middle, base), Align::Centre, TEXT * unit, INK);
            free_from = middle + half + 4.0 * unit;
        }
    }
}

/// An arrow upwards with the letter N beside it.
fn draw_north(canvas: &mut Canvas, (x, top): Point, unit: f32) {
    draw_arrow(canvas, (x + 4.0 * unit, top + 7.0 * unit), 0.0, 9.0 * unit, unit);
    draw_text(canvas, "N", (x - 5.0 * unit, top + 11.0 * unit), Align::Right, TEXT * unit, INK);
}

/// An arrow about a place, towards a compass azimuth; `half` its length.
fn draw_arrow(canvas: &mut Canvas, (x, y): Point, azimuth_deg: f64, half: f32, unit: f32) {
    let towards = compass::unit_toward(azimuth_deg).as_vec2();
    let at = |along: f32, across: f32| {
        (x + along * towards.x + across * towards.y, y - along * towards.y + across * towards.x)
    };
    // A pale line beneath, so that arrows can be seen on dark colours.
    for (width, colour) in [(3.4, PAPER), (1.4, INK)] {
        canvas.polyline(&[at(-half, 0.0), at(half, 0.0)], width * unit, colour);
        canvas.polyline(
            &[at(0.35 * half, -0.5 * half), at(half, 0.0), at(0.35 * half, 0.5 * half)],
            width * unit,
            colour,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::FieldFrame;
    use wildfire_fire::{Landscape, Relief};

    #[test]
    fn the_key_has_the_colour_that_ground_has_on_a_slope() {
        let frame = FieldFrame { cols: 12, rows: 12, cell_m: 10.0 };
        let heights = (0..frame.cell_count()).map(|index| 6.0 * f32::from(frame.cell(index).row));
        let fuel = vec![102; frame.cell_count()];
        let landscape =
            Landscape { fuel, relief: Relief::Elevation(heights.collect()), ..Landscape::uniform(frame, 0) };
        let values = vec![f64::NAN; frame.cell_count()];
        let map = FieldMap {
            title: "",
            frame,
            quantity: MapQuantity::ArrivalTime,
            values: &values,
            without_value: "not burned",
            covers: &vec![GroundCover::Grass; frame.cell_count()],
            landscape: Some(&landscape),
            ignitions: &[],
            has_contours: false,
        };
        let panel = Panel::new(&map, None, 400, 400);
        let KeySymbol::Cell(key) = panel.key[0].0 else { panic!("ground is a cell") };
        let ground = panel.colour(Cell { col: 6, row: 6 });
        assert!(ground != WITHOUT_VALUE && key.iter().zip(ground).all(|(&key, it)| key.abs_diff(it) <= 2), "{key:?}");
    }
}
