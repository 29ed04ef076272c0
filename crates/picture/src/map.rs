//! Maps from above, by themselves or laid over their input, with title, numbers of rows and columns, and legend.
//!
//! Sizes follow from the texts, so that nothing overlaps or is cut off whatever the shape of the map; where the map is
//! drawn more than 1000 pixels long, texts and marks grow with it.

use crate::canvas::{Canvas, Ink, Point};
use crate::colours::{EDGE, FAINT_INK, INK, OBSTACLE, PAPER, Rgb, SWEPT, WITHOUT_VALUE, ZONES, blend, lightness};
use crate::legend::{Bar, Legend, Symbol, TEXT};
use crate::marks;
use crate::marks::{scene_marks, to_f32};
use crate::png::Picture;
use crate::scene::{MapScene, Spot, Zones};
use crate::text::{Align, draw_text, draw_text_on, measure_text};
use crate::thin_line::draw_line;
use crate::ticks::indices;
use crate::values::ValueScale;
use crate::zoom::{BlockFace, DrawnBlock, Zoom};
use wildfire_grid::Grid;

/// The map from above: colours, obstacles, path, start and goal, with title, legend and numbers of rows and columns.
///
/// Colours span the finite values of free cells. Small maps are drawn larger by a whole factor, to about 800 pixels;
/// maps of more than 4096 cells a side smaller by a whole factor: a pixel is then an obstacle if any of its cells is
/// one, else it shows their highest value. A picture takes up to about 100 MB of memory while it is drawn. Where cells have
/// texts, they are large enough to be read.
pub fn draw_map(scene: &MapScene) -> Picture {
    let zoom = Zoom::fit(scene.occupied.rows(), scene.occupied.cols());
    let min = if scene.texts.is_some() { SMALLEST_WRITTEN } else { 1 };
    draw_map_with(scene, Zoom { pixels: zoom.pixels.max(min), ..zoom })
}

/// The same with the map drawn at about 480 pixels, at most 1000, for pages with many maps.
pub fn draw_small_map(scene: &MapScene) -> Picture {
    draw_map_with(scene, Zoom::small(scene.occupied.rows(), scene.occupied.cols()))
}

fn draw_map_with(scene: &MapScene, zoom: Zoom) -> Picture {
    let scale = scene.scale();
    let legend = Legend { values: bar(scene, scale.as_ref()), key: key(scene) };
    let mut plate = Plate::with_zoom(scene, &legend, zoom);
    plate.paint(&|block| block_colour(scene, block, block.face(scene), scale.as_ref()));
    plate.enlarge_jumps(scale.as_ref());
    plate.draw_edges(scene.edges.len());
    plate.draw_path();
    plate.write_texts(&|block| block_colour(scene, block, block.face(scene), scale.as_ref()));
    plate.draw_marks();
    plate.finish()
}

pub fn bar<'a>(scene: &MapScene<'a>, scale: Option<&'a ValueScale>) -> Option<Bar<'a>> {
    scale.map(|scale| Bar { name: scene.value_name, scale })
}

pub fn face_colour(face: BlockFace, scale: Option<&ValueScale>) -> Rgb {
    match (face, scale) {
        (BlockFace::Obstacle, _) => OBSTACLE,
        (BlockFace::Value(value), Some(scale)) => scale.colour(value),
        _ => WITHOUT_VALUE,
    }
}

/// The colour of a block, in which cells that were jumped through differ from others without a value.
fn block_colour(scene: &MapScene, block: &DrawnBlock, face: BlockFace, scale: Option<&ValueScale>) -> Rgb {
    let is_swept = face == BlockFace::WithoutValue && block.places().any(|place| scene.is_swept(place));
    if is_swept { SWEPT } else { face_colour(face, scale) }
}

/// Lists what has no value and what is marked, as far as it is present.
pub fn key<'a>(scene: &MapScene<'a>) -> Vec<(Symbol, &'a str)> {
    let obstacle = scene.has_obstacles().then_some((Symbol::Cell(OBSTACLE), "obstacle"));
    let colourless = scene.colourless_name().map(|name| (Symbol::Cell(WITHOUT_VALUE), name));
    obstacle.into_iter().chain(colourless).chain(swept_key(scene, SWEPT)).chain(marks_key(scene)).collect()
}

/// Names the cells that were jumped through, where there are any, in a colour.
fn swept_key<'a>(scene: &MapScene, colour: Rgb) -> Option<(Symbol, &'a str)> {
    scene.swept.map(|_| (Symbol::Cell(colour), "jumped through"))
}

fn marks_key<'a>(scene: &MapScene<'a>) -> impl Iterator<Item = (Symbol, &'a str)> {
    let path = (scene.path.len().max(scene.track.len()) > 1).then_some((Symbol::Path, "path"));
    let edges = (!scene.edges.is_empty()).then_some((Symbol::Edge, "edge"));
    let marks = scene_marks(scene).map(|(mark, _)| (Symbol::Mark(mark), mark.name()));
    path.into_iter().chain(edges).chain(marks)
}

const TITLE: f32 = 13.0;
/// The distance of the lines of a subtitle.
pub const SUBTITLE_LINE: f32 = 17.0;
/// The names of the axes.
const ROWS: &str = "row";
const COLUMNS: &str = "column, in cells";
const MARGIN: f32 = 24.0;
const GAP: f32 = 12.0;
/// The distance by which marks may reach beyond the map, and which texts keep from it.
const OVERHANG: f32 = 10.0;
/// The side of a cell at which a jump ended, at least, in pixels.
const SMALLEST_JUMP: f32 = 4.0;
/// The side of a cell in which a text is written, at least, in pixels.
const SMALLEST_WRITTEN: usize = 26;
/// More edges than these hide the map.
const MANY_EDGES: usize = 1000;
/// The lightness above which a cell has dark letters.
const LIGHT: f64 = 120.0;
/// The longer side of a map from which on texts grow with it, in pixels.
const USUAL_LENGTH: f32 = 1000.0;

#[derive(Clone)]
pub struct Plate<'a> {
    scene: &'a MapScene<'a>,
    zoom: Zoom,
    /// The factor by which texts and marks are larger than usual.
    unit: f32,
    /// The place of the map's upper left corner.
    corner: Point,
    canvas: Canvas,
}

impl<'a> Plate<'a> {
    /// Everything but the map itself.
    pub fn around(scene: &'a MapScene<'a>, legend: &Legend) -> Self {
        Self::with_zoom(scene, legend, Zoom::fit(scene.occupied.rows(), scene.occupied.cols()))
    }

    /// The same with the map at another size.
    pub fn with_zoom(scene: &'a MapScene<'a>, legend: &Legend, zoom: Zoom) -> Self {
        let rows = scene.occupied.rows();
        let cols = scene.occupied.cols();
        let width = zoom.length(cols) as f32;
        let height = zoom.length(rows) as f32;
        let unit = (width.max(height) / USUAL_LENGTH).max(1.0);
        let numbers = |count: usize| measure_text(&count.saturating_sub(1).to_string(), TEXT) * unit;
        let row_name = measure_text(ROWS, TEXT * unit);
        // Numbers of columns are centred on their cells, so half of the widest may stick out at the sides.
        let row_room = numbers(rows).max(0.5 * numbers(cols)).max(row_name - OVERHANG * unit);
        let left = (MARGIN * unit + row_room + OVERHANG * unit).ceil();
        let legend_at = (left + width + (OVERHANG + GAP) * unit + 0.5 * numbers(cols)).ceil();
        let title_ends = left + measure_text(scene.title, TITLE * unit);
        let right = title_ends.max(legend_at + legend.width(unit)) + MARGIN * unit;
        let subtitle = lines_within(scene.subtitle, right - MARGIN * unit - left, TEXT * unit);
        let subtitle_height = subtitle.len() as f32 * SUBTITLE_LINE * unit;
        // The name of the rows has a line of its own above the map.
        let top = ((MARGIN + TITLE + 2.0 * GAP + TEXT + OVERHANG) * unit + subtitle_height).ceil();
        let below = height + (OVERHANG + 2.0 * TEXT + GAP) * unit;
        let bottom = top + below.max(legend.height(height, unit)) + MARGIN * unit;
        let mut canvas = Canvas::sized(right, bottom, PAPER);
        draw_text(&mut canvas, scene.title, (left, (MARGIN + TITLE) * unit), Align::Left, TITLE * unit, INK);
        let mut base = (MARGIN + TITLE) * unit;
        for line in subtitle {
            base += SUBTITLE_LINE * unit;
            draw_text(&mut canvas, line, (left, base), Align::Left, TEXT * unit, INK);
        }
        legend.draw(&mut canvas, (legend_at, top), height, unit);
        canvas.fill_rect(left - 1.0, top - 1.0, width + 2.0, height + 2.0, FAINT_INK);
        let mut plate = Self { scene, zoom, unit, corner: (left, top), canvas };
        plate.draw_numbers(width, height);
        plate
    }

    /// The map alone, with the room that its marks take, on a sheet of its own.
    pub fn alone(scene: &'a MapScene<'a>, zoom: Zoom) -> Self {
        let width = zoom.length(scene.occupied.cols()) as f32;
        let height = zoom.length(scene.occupied.rows()) as f32;
        let mut canvas = Canvas::sized(width + 2.0 * OVERHANG, height + 2.0 * OVERHANG, PAPER);
        canvas.fill_rect(OVERHANG - 1.0, OVERHANG - 1.0, width + 2.0, height + 2.0, FAINT_INK);
        Self { scene, zoom, unit: 1.0, corner: (OVERHANG, OVERHANG), canvas }
    }

    /// Copies the sheet to a place of another one, in pixels.
    pub fn copy_onto(&self, canvas: &mut Canvas, (left, top): Point) {
        canvas.copy_from(&self.canvas, (whole(left) as u32, whole(top) as u32));
    }

    fn draw_numbers(&mut self, width: f32, height: f32) {
        let (left, top) = self.corner;
        let rows = self.scene.occupied.rows();
        let cols = self.scene.occupied.cols();
        let size = TEXT * self.unit;
        let away = OVERHANG * self.unit;
        let cell = f64::from(self.zoom.cell());
        let wide = measure_text(&cols.to_string(), size) + 2.0 * size;
        let rows_at = (left - away, top - away - size);
        draw_text(&mut self.canvas, ROWS, rows_at, Align::Right, size, INK);
        let cols_at = (left + 0.5 * width, top + height + away + 2.0 * size + GAP * self.unit);
        draw_text(&mut self.canvas, COLUMNS, cols_at, Align::Centre, size, INK);
        for row in indices(rows, f64::from(2.6 * size).max(f64::from(height) / 16.0) / cell) {
            let at = (left - away, top + self.zoom.centre(row) + 0.5 * size);
            draw_text(&mut self.canvas, &row.to_string(), at, Align::Right, size, INK);
        }
        for col in indices(cols, f64::from(wide).max(f64::from(width) / 16.0) / cell) {
            let at = (left + self.zoom.centre(col), top + height + away + size);
            draw_text(&mut self.canvas, &col.to_string(), at, Align::Centre, size, INK);
        }
    }

    /// Colours every block of cells.
    pub fn paint(&mut self, colour: &dyn Fn(&DrawnBlock) -> Rgb) {
        let size = (self.scene.occupied.rows(), self.scene.occupied.cols());
        let pixels = self.zoom.pixels;
        let left = whole(self.corner.0);
        let top = whole(self.corner.1);
        let mut line = vec![[255; 4]; self.zoom.length(size.1)];
        for row in 0..self.zoom.blocks(size.0) {
            for (col, block) in line.chunks_exact_mut(pixels).enumerate() {
                let [red, green, blue] = colour(&self.zoom.block(row, col, size));
                block.fill([red, green, blue, 255]);
            }
            // A block is coloured once; the other rows of its pixels are copies.
            for copy in 0..pixels {
                let below = row * pixels + copy;
                self.canvas.row_from(left, top + below)[..line.len()].copy_from_slice(&line);
            }
        }
    }

    /// Draws edges, path, start, goal and local minimum.
    pub fn mark(&mut self) {
        self.draw_edges(self.scene.edges.len());
        self.draw_path();
        self.draw_marks();
    }

    /// Draws cells at which jumps ended as large as can be seen, where cells are smaller than that.
    fn enlarge_jumps(&mut self, scale: Option<&ValueScale>) {
        let side = SMALLEST_JUMP * self.unit;
        let (Some(_), Some(scale)) = (self.scene.swept, scale) else { return };
        if self.zoom.cell() >= side {
            return;
        }
        for place in self.scene.places() {
            let Some(value) = self.scene.value_at(place) else { continue };
            let (x, y) = self.centre(place);
            self.canvas.fill_rect(x - 0.5 * side, y - 0.5 * side, side, side, scale.colour(value));
        }
    }

    /// Draws the first edges of a tree or a roadmap, those of many thinner.
    pub fn draw_edges(&mut self, count: usize) {
        let min = if self.scene.edges.len() > MANY_EDGES { 0.5 } else { 1.0 };
        let width = (0.08 * self.zoom.cell()).clamp(min * self.unit, 1.6 * min * self.unit);
        for &[from, to] in &self.scene.edges[..count] {
            let ends = [self.spot(from), self.spot(to)];
            draw_line(&mut self.canvas, ends[0], ends[1], width, Ink::opaque(EDGE));
        }
    }

    pub fn draw_path(&mut self) {
        if self.scene.track.is_empty() {
            let corners = marks::corners(self.scene.path);
            let path: Vec<Point> = corners.into_iter().map(|place| self.centre(place)).collect();
            self.draw_path_over(&path);
        } else {
            self.draw_track(self.scene.track);
        }
    }

    /// Draws a path through points.
    pub fn draw_track(&mut self, track: &[Spot]) {
        let path: Vec<Point> = track.iter().map(|&spot| self.spot(spot)).collect();
        self.draw_path_over(&path);
    }

    fn draw_path_over(&mut self, path: &[Point]) {
        let width = (0.2 * self.zoom.cell()).clamp(1.8 * self.unit, 5.0 * self.unit);
        marks::draw_path(&mut self.canvas, path, width);
    }

    /// Writes the texts of cells, all in the size that the widest of them allows, with an edge of the cell's colour that lifts
    /// them off a path; a cell with a mark has none.
    fn write_texts(&mut self, colour: &dyn Fn(&DrawnBlock) -> Rgb) {
        let Some(texts) = self.scene.texts else { return };
        let marked: Vec<_> = scene_marks(self.scene).map(|(_, place)| place).collect();
        let places = self.scene.places().filter(|place| !marked.contains(place));
        let written: Vec<_> = places.filter_map(|place| Some((place, texts(place)?))).collect();
        let widest = written.iter().map(|(_, text)| measure_text(text, 1.0)).fold(1.0, f32::max);
        let cell = self.zoom.cell();
        let height = (0.84 * cell / widest).min(0.34 * cell);
        for (place, text) in &written {
            let (x, y) = self.centre(*place);
            let size = (self.scene.occupied.rows(), self.scene.occupied.cols());
            let ground = colour(&self.zoom.block(place.0, place.1, size));
            let ink = if lightness(ground) > LIGHT { INK } else { PAPER };
            draw_text_on(&mut self.canvas, text, (x, y + 0.5 * height), Align::Centre, height, ink, ground);
        }
    }

    pub fn draw_marks(&mut self) {
        let cell = self.zoom.cell();
        let radius = (0.32 * cell).clamp(5.5 * self.unit, 11.0 * self.unit);
        // They go in reverse, so that where marks share a cell, the start and the goal lie over the local minimum.
        for (mark, place) in scene_marks(self.scene).rev() {
            let at = self.centre(place);
            mark.draw(&mut self.canvas, at, radius);
        }
    }

    fn spot(&self, (row, col): Spot) -> Point {
        let cell = self.zoom.cell();
        (self.corner.0 + (to_f32(col) + 0.5) * cell, self.corner.1 + (to_f32(row) + 0.5) * cell)
    }

    fn centre(&self, (row, col): (usize, usize)) -> Point {
        (self.corner.0 + self.zoom.centre(col), self.corner.1 + self.zoom.centre(row))
    }

    /// Width and height of the sheet in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.canvas.width(), self.canvas.height())
    }

    /// The sheet as it is: red, green, blue and opacity of every pixel, row by row.
    pub fn bytes(&self) -> &[u8] {
        self.canvas.bytes()
    }

    pub fn finish(self) -> Picture {
        self.canvas.finish()
    }
}

/// Breaks a text at its spaces into lines of at most a width, but for words that are longer.
pub fn lines_within(text: &str, width: f32, height: f32) -> Vec<&str> {
    let mut lines: Vec<&str> = Vec::new();
    let mut begin = 0;
    for (end, _) in text.match_indices(' ').chain([(text.len(), "")]) {
        let line = text[begin..end].trim_start();
        match lines.last_mut() {
            Some(last) if measure_text(line, height) <= width => *last = line,
            _ => {
                // The line so far stays as it is, and the last word begins another.
                let word = line.rfind(' ').map_or(0, |space| space + 1);
                begin = end - (line.len() - word);
                lines.push(&text[begin..end]);
            }
        }
    }
    lines.retain(|line| !line.is_empty());
    lines
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "corners lie on whole pixels of the sheet")]
fn whole(length: f32) -> usize {
    length as usize
}

/// The share of the map in the colour of a free cell; the rest is the input's.
const OPACITY: f64 = 0.6;
/// The same of obstacles, which in grey input are dark already.
const OBSTACLE_OPACITY: f64 = 0.8;

/// The map's zones, or its values if it has none, in translucent colours over the input: over its grey values where it
/// was an image, else over white.
///
/// Size and memory are those of [`super::draw_map`]; where a pixel stands for several cells, it shows the first zone
/// among them and the darkest grey.
pub fn draw_overlay(scene: &MapScene, grey: Option<&Grid<u8>>) -> Picture {
    match scene.zones {
        Some(zones) => draw_overlaid_zones(scene, &zones, grey),
        None => draw_overlaid_values(scene, grey),
    }
}

fn draw_overlaid_zones(scene: &MapScene, zones: &Zones, grey: Option<&Grid<u8>>) -> Picture {
    let present = present_zones(scene, zones);
    let colour = |zone: usize| ZONES[zone % ZONES.len()];
    let names = zones.names.iter().enumerate().filter(|&(zone, _)| present[zone]);
    // Colours are blended as on the map, or the key would show some that the map does not have.
    let names = names.map(|(zone, name)| (Symbol::Cell(blend(PAPER, colour(zone), OPACITY)), *name));
    let legend = Legend { values: None, key: obstacle_key(scene).chain(names).chain(marks_key(scene)).collect() };
    paint_over(scene, &legend, grey, &|block, _| {
        block.places().map(|place| zones.zone_at(place)).min().map_or(WITHOUT_VALUE, colour)
    })
}

fn draw_overlaid_values(scene: &MapScene, grey: Option<&Grid<u8>>) -> Picture {
    let scale = scene.scale();
    let shown = scale.as_ref().map(|scale| scale.on(PAPER, OPACITY));
    let colourless = scene.colourless_name().map(|name| (Symbol::Cell(blend(PAPER, WITHOUT_VALUE, OPACITY)), name));
    let swept = swept_key(scene, blend(PAPER, SWEPT, OPACITY));
    let key = obstacle_key(scene).chain(colourless).chain(swept).chain(marks_key(scene)).collect();
    let legend = Legend { values: bar(scene, shown.as_ref()), key };
    paint_over(scene, &legend, grey, &|block, face| block_colour(scene, block, face, scale.as_ref()))
}

/// Lays the colours of blocks without obstacles over the input.
fn paint_over(
    scene: &MapScene,
    legend: &Legend,
    grey: Option<&Grid<u8>>,
    colour: &dyn Fn(&DrawnBlock, BlockFace) -> Rgb,
) -> Picture {
    let mut plate = Plate::around(scene, legend);
    plate.paint(&|block| {
        let ground = grey.map_or(PAPER, |grey| darkest(grey, block));
        match block.face(scene) {
            BlockFace::Obstacle => blend(ground, OBSTACLE, if grey.is_some() { OBSTACLE_OPACITY } else { 1.0 }),
            face => blend(ground, colour(block, face), OPACITY),
        }
    });
    plate.mark();
    plate.finish()
}

fn darkest(grey: &Grid<u8>, block: &DrawnBlock) -> Rgb {
    let values = block.places().filter_map(|(row, col)| grey.get(row, col));
    [*values.min().unwrap_or(&255); 3]
}

fn obstacle_key<'a>(scene: &MapScene) -> impl Iterator<Item = (Symbol, &'a str)> + use<'a> {
    scene.has_obstacles().then_some((Symbol::Cell(OBSTACLE), "obstacle")).into_iter()
}

fn present_zones(scene: &MapScene, zones: &Zones) -> Vec<bool> {
    let mut present = vec![false; zones.names.len()];
    for place in scene.places().filter(|&place| !scene.occupied[place]) {
        if let Some(zone) = present.get_mut(zones.zone_at(place)) {
            *zone = true;
        }
    }
    present
}
