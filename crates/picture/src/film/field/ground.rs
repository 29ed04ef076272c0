//! Ground under the bushes: what grows there and how steep it is, and how fire has gone over it; wet ground, embers, lines of
//! equal arrival.
//!
//! What a frame needs of each cell lies in arrays by cell index, so that a pixel costs a look-up however many cells there are.
//! Cells smaller than pixels are sampled in the pixels' middles, as values are; those that burn are then drawn once more, each as
//! a few pixels, so that none is passed over.

use std::sync::OnceLock;

use crate::canvas::{Canvas, Ink, Pen};
use crate::colours::{EXTINGUISHED, INK, PAPER, Rgb, blend};
use crate::contours::{ContourLine, contour_lines};
use crate::field_map::{MapQuantity, MapScale};
use crate::film::RunView;
use crate::film::field::lines::draw_visible_line;
use crate::film::field::{Layer, Pane};
use crate::ground::{GroundCover, hillshade};
use crate::text::{Align, draw_text_on};
use crate::thin_line::draw_line;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_fire::Landscape;
use wildfire_grid::Grid;
use wildfire_timeline::{BurnMap, BushState, Cause, GroundFact, GroundIndex};

/// Fire on the ground is bright at first, then burns darker; what is left goes from red to dark.
pub const YOUNG: Rgb = [255, 240, 150];
pub const FLAMING: Rgb = [246, 132, 24];
pub const OLD: Rgb = [206, 64, 8];
pub const EMBERS: Rgb = [150, 52, 24];
pub const CHAR: Rgb = [78, 71, 66];
/// Seconds until flames are no longer young, until they are old, and until what burned out is dark.
pub const YOUNG_FOR_S: f32 = 20.0;
pub const OLD_AFTER_S: f32 = 90.0;
pub const GLOWS_FOR_S: f32 = 240.0;
/// The share of the colour of burned ground; through the rest one sees what grew there.
pub const BURNED_OPACITY: f64 = 0.86;

pub const WET: Rgb = [40, 120, 200];
pub const WET_OPACITY: f32 = 0.45;
/// Line of crews that holds, and line that the fire reached before them.
pub const LINE: Rgb = [110, 66, 30];
pub const LOST_LINE: Rgb = [232, 160, 140];

pub const EMBER: Rgb = [255, 90, 160];
/// The time for which the flight of an ember is shown after it has lit something.
const FLIGHT_LASTS: SimTime = SimTime::from_nanos(60_000_000_000);

/// The ground of a run, and how fire went over it.
pub struct GroundView {
    /// The colour of each cell without fire, lit by the sun.
    covers: Vec<Rgb>,
    /// Seconds until each cell of ground first burns, infinite if it never does, and until that fire ends.
    ignited_s: Vec<f32>,
    ends_s: Vec<f32>,
    /// Cells that a truck put out, which can burn more than once.
    is_special: Vec<bool>,
    /// What embers lit, in order of time: when, which cell, and where from.
    spotted: Vec<(SimTime, DVec2, DVec2)>,
    arrival: OnceLock<ArrivalLines>,
    /// By [`CellShades::LAYERS`].
    shades: [OnceLock<Option<CellShades>>; 2],
    burnings: OnceLock<BurningTimes>,
}

/// When which cells of ground burn.
struct BurningTimes {
    /// When the fire begins and ends, in seconds, and the cell, in order of time.
    spans: Vec<(f32, f32, usize)>,
    longest_s: f32,
}

/// Lines of equal arrival, each with its label.
pub struct ArrivalLines {
    pub levels: Vec<(f64, String, Vec<ContourLine>)>,
}

/// Colours by how each cell burns.
pub struct CellShades {
    pub scale: MapScale,
    pub by_cell: Vec<Option<Rgb>>,
}

impl GroundView {
    /// `None` of a run in which only bushes burn.
    pub fn new(run: &RunView) -> Option<Self> {
        let timeline = run.timeline();
        let ground = run.index().ground()?;
        let setting = &timeline.setting;
        let frame = setting.frame;
        let covers = cover_colours(setting.spread.as_ref()?.landscape());
        let mut view = Self {
            covers,
            // Infinite where fire never comes, so that no time of the run is past it.
            ignited_s: vec![f32::INFINITY; frame.cell_count()],
            ends_s: vec![f32::INFINITY; frame.cell_count()],
            is_special: vec![false; frame.cell_count()],
            spotted: Vec::new(),
            arrival: OnceLock::new(),
            shades: Default::default(),
            burnings: OnceLock::new(),
        };
        for index in 0..frame.cell_count() {
            if let burnings @ [first, ..] = ground.burnings_of(frame.cell(index)) {
                view.ignited_s[index] = seconds(first.ignited);
                view.ends_s[index] = seconds(first.ends);
                // A cell that burned once and was left alone needs two numbers; only the others are looked up by time.
                view.is_special[index] = burnings.len() > 1 || first.is_extinguished;
            }
        }
        let on_ground = timeline.ground.iter().filter_map(|event| match event.fact {
            GroundFact::Ignited(cause) => Some((event.time, event.cell, cause)),
            _ => None,
        });
        let on_bushes = timeline.events.iter().filter_map(|event| {
            let ignition = event.fact.ignition()?;
            Some((event.time, ignition.cell, ignition.cause))
        });
        for (time, cell, cause) in on_ground.chain(on_bushes) {
            if let Cause::Spotted(from) = cause {
                view.spotted.push((time, frame.centre(cell), frame.centre(from)));
            }
        }
        // Facts on bushes and on ground come from two lists.
        view.spotted.sort_by_key(|&(time, ..)| time);
        Some(view)
    }

    /// The colour of each cell without fire, by its index.
    pub fn covers(&self) -> &[Rgb] {
        &self.covers
    }

    /// What embers lit, in order of time: when, which cell, and where from.
    pub fn spotted(&self) -> &[(SimTime, DVec2, DVec2)] {
        &self.spotted
    }

    /// Draws what grows where, before any fire.
    pub(super) fn draw_covers(&self, canvas: &mut Canvas, pane: &Pane) {
        each_pixel(canvas, pane, |index, pixel| *pixel = opaque(self.covers[index]));
    }

    /// Draws what burns and has burned on the ground; pixels of bushes stay.
    pub(super) fn draw_fire(&self, canvas: &mut Canvas, pane: &Pane) {
        let now = pane.view.state.time;
        let now_s = seconds(now);
        let Some(index) = pane.view.run.index().ground() else { return };
        let shades = self.shades(pane);
        each_pixel(canvas, pane, |cell, pixel| {
            // Nearly all cells of most frames are done with by this comparison.
            if self.ignited_s[cell] > now_s {
                return;
            }
            let colour = if self.is_special[cell] {
                special_colour(pane, index, cell, now)
            } else {
                Some(fire_colour(now_s - self.ignited_s[cell], now_s - self.ends_s[cell]))
            };
            let Some(colour) = colour else { return };
            let shade = shades.and_then(|shades| shades.by_cell[cell]);
            *pixel = opaque(shade.unwrap_or(over([pixel[0], pixel[1], pixel[2]], colour)));
        });
        if pane.cell_side() < 1.0 {
            self.draw_small_fires(canvas, pane, index);
        }
    }

    /// Draws every cell that burns as four pixels, the youngest fire last.
    fn draw_small_fires(&self, canvas: &mut Canvas, pane: &Pane, index: &GroundIndex) {
        let now_s = seconds(pane.view.state.time);
        let BurningTimes { spans, longest_s } = self.burnings.get_or_init(|| BurningTimes::new(index, pane.frame()));
        let first = spans.partition_point(|&(ignited_s, ..)| ignited_s < now_s - longest_s);
        for &(ignited_s, ends_s, cell) in spans[first..].iter().take_while(|(ignited_s, ..)| *ignited_s <= now_s) {
            if now_s < ends_s {
                let (x, y) = pane.cell_centre(pane.frame().cell(cell));
                let left = x.round() as i32 - 1;
                let top = y.round() as i32 - 1;
                canvas.fill_pixels((left, top), (left + 2, top + 2), fire_colour(now_s - ignited_s, now_s - ends_s));
            }
        }
    }

    /// Returns how cells burn, where that is shown.
    pub(super) fn shades(&self, pane: &Pane) -> Option<&CellShades> {
        let shown = CellShades::LAYERS.iter().zip(&self.shades).filter(|((layer, _), _)| pane.shows(*layer));
        let mut found = shown
            .map(|(&(_, quantity), shades)| shades.get_or_init(|| CellShades::new(pane.view.run, quantity)).as_ref());
        found.find_map(|shades| shades)
    }

    /// Draws the lines that the fire has reached so far, at round times.
    pub(super) fn draw_arrival_lines(&self, canvas: &mut Canvas, pane: &Pane) {
        let now_s = pane.view.state.time.as_seconds();
        let lines = self.arrival.get_or_init(|| ArrivalLines::new(pane.view.run));
        let cell_m = pane.frame().cell_m;
        let unit = pane.unit();
        let place = |&(col, row): &(f64, f64)| pane.projection.place(DVec2::new(col + 0.5, row + 0.5) * cell_m);
        for (_, label, lines) in lines.levels.iter().filter(|(level, ..)| *level <= now_s) {
            for line in lines {
                let points: Vec<DVec2> = line.points.iter().map(place).collect();
                // A dark line below a light one is seen on ground of any colour.
                let edge = Pen { ink: Ink { colour: INK, opacity: 0.5 }, width: 2.6 * unit };
                draw_visible_line(canvas, pane, &points, edge, None);
                draw_visible_line(canvas, pane, &points, Pen::opaque(PAPER, 1.3 * unit), None);
            }
            let longest = lines.iter().max_by(|a, b| a.length().total_cmp(&b.length()));
            // A label on a short line would hide it.
            let long = longest.filter(|line| pane.projection.length(line.length() * cell_m) > 90.0 * unit);
            let middle = long.map(|line| place(&line.points[line.points.len() / 2]).as_vec2());
            if let Some(at) = middle.filter(|at| pane.is_near((at.x, at.y), 0.0)) {
                let size = 8.0 * unit;
                draw_text_on(canvas, label, (at.x, at.y + 0.5 * size), Align::Centre, size, PAPER, INK);
            }
        }
    }

    /// Marks what embers have lit, and for a while where they came from.
    pub(super) fn draw_embers(&self, canvas: &mut Canvas, pane: &Pane) {
        let (now, unit) = (pane.view.state.time, pane.unit());
        let started = self.spotted.partition_point(|&(time, ..)| time <= now);
        for &(time, cell, from) in &self.spotted[..started] {
            let (at, from) = (pane.at(cell), pane.at(from));
            let age = now.since(time);
            if age < FLIGHT_LASTS {
                let left = 1.0 - (age.as_seconds() / FLIGHT_LASTS.as_seconds()) as f32;
                draw_line(canvas, from, at, 1.4 * unit, Ink { colour: EMBER, opacity: 0.8 * left });
            }
            if pane.is_near(at, 8.0 * unit) {
                let radius = (0.6 * pane.cell_side()).clamp(3.0 * unit, 9.0 * unit);
                canvas.ring(at, radius, &Pen::opaque(INK, 2.6 * unit));
                canvas.ring(at, radius, &Pen::opaque(EMBER, 1.5 * unit));
            }
        }
    }
}

/// Draws cells, bushes and ground, that are wet, and the line of crews.
pub(super) fn draw_wet(canvas: &mut Canvas, pane: &Pane) {
    let now = pane.view.state.time;
    let Some(ground) = pane.view.run.index().ground() else { return };
    // Line is wet for good, and has colours of its own.
    let wet = ground.wettings().iter().filter(|wet| wet.from <= now && now < wet.until && wet.until < SimTime::MAX);
    let mut wet: Vec<Cell> = wet.map(|wet| wet.cell).collect();
    // By cell index, so that a cell that was wetted twice is painted once.
    wet.dedup();
    for cell in wet {
        fill_cell(canvas, pane, cell, WET, WET_OPACITY);
    }
    let built = ground.line_cells().iter().take_while(|line| line.from <= now);
    for line in built {
        fill_cell(canvas, pane, line.cell, if line.holds { LINE } else { LOST_LINE }, 1.0);
    }
}

fn fill_cell(canvas: &mut Canvas, pane: &Pane, cell: Cell, colour: Rgb, opacity: f32) {
    let ((left, top), (right, bottom)) = pane.projection.cell(pane.frame(), cell);
    let [left, top, right, bottom] = [left, top, right, bottom].map(|at| at as f32);
    canvas.fill_through(&[(left, top), (right, top), (right, bottom), (left, bottom)], colour, opacity);
}

impl BurningTimes {
    fn new(index: &GroundIndex, frame: &FieldFrame) -> Self {
        let mut spans: Vec<(f32, f32, usize)> = (0..frame.cell_count())
            .flat_map(|number| {
                let burnings = index.burnings_of(frame.cell(number)).iter();
                burnings.map(move |burning| (seconds(burning.ignited), seconds(burning.ends), number))
            })
            .collect();
        spans.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.2.cmp(&other.2)));
        let longest_s = spans.iter().map(|(ignited_s, ends_s, _)| ends_s - ignited_s).fold(0.0, f32::max);
        Self { spans, longest_s }
    }
}

impl CellShades {
    /// The layers that show them, the first of which counts.
    pub const LAYERS: [(Layer, MapQuantity); 2] =
        [(Layer::FireType, MapQuantity::FireType), (Layer::Intensity, MapQuantity::Intensity)];

    /// `None` of a run of which it is not known; where there are no trees, all fires are of one kind.
    pub fn new(run: &RunView, quantity: MapQuantity) -> Option<Self> {
        let setting = &run.timeline().setting;
        let has_trees = setting.spread.as_ref().is_some_and(|spread| spread.landscape().canopy.is_some());
        let behavior =
            (has_trees || quantity != MapQuantity::FireType).then(|| BurnMap::new(run.timeline()).behavior())??;
        let values = if quantity == MapQuantity::FireType { behavior.fire_type } else { behavior.intensity_kw_m };
        let scale = quantity.scale(values.iter().copied())?;
        Some(Self {
            by_cell: values.iter().map(|&value| value.is_finite().then(|| scale.colour(value))).collect(),
            scale,
        })
    }
}

impl ArrivalLines {
    pub fn new(run: &RunView) -> Self {
        let timeline = run.timeline();
        let frame = timeline.setting.frame;
        let arrival = BurnMap::new(timeline).arrival_s();
        let scale = MapQuantity::ArrivalTime.scale(arrival.iter().copied());
        let ticks = scale.as_ref().map_or(&[][..], |scale| &scale.ticks);
        let unit = scale.as_ref().and_then(|scale| scale.name.split_once(", ")).map_or("", |(_, unit)| unit);
        let values = Grid::from_values(frame.rows.into(), frame.cols.into(), arrival);
        Self {
            levels: ticks
                .iter()
                .map(|tick| (tick.value, format!("{} {unit}", tick.label), contour_lines(&values, tick.value)))
                .collect(),
        }
    }
}

fn cover_colours(landscape: &Landscape) -> Vec<Rgb> {
    let colour = |(index, &number): (usize, &u8)| {
        let cover = GroundCover::from_fuel(number);
        let is_level = cover == GroundCover::Water;
        let gradient = if is_level { DVec2::ZERO } else { landscape.gradient(landscape.frame.cell(index)) };
        hillshade(cover.colour(), gradient)
    };
    landscape.fuel.iter().enumerate().map(colour).collect()
}

/// The colour of ground whose fire began and ended so many seconds ago; it goes on if its end is yet to come.
fn fire_colour(age_s: f32, since_end_s: f32) -> Rgb {
    let share = |part: f32, whole: f32| f64::from((part / whole).clamp(0.0, 1.0));
    if since_end_s >= 0.0 {
        blend(EMBERS, CHAR, share(since_end_s, GLOWS_FOR_S))
    } else if age_s < YOUNG_FOR_S {
        blend(YOUNG, FLAMING, share(age_s, YOUNG_FOR_S))
    } else {
        blend(FLAMING, OLD, share(age_s - YOUNG_FOR_S, OLD_AFTER_S))
    }
}

/// The colour of a cell that was put out, or that burned more than once; `None` if nothing burned so far.
fn special_colour(pane: &Pane, ground: &GroundIndex, index: usize, now: SimTime) -> Option<Rgb> {
    let cell = pane.frame().cell(index);
    let last = ground.burnings_of(cell).iter().rev().find(|burning| burning.ignited <= now)?;
    match ground.state_at(cell, now)? {
        BushState::Intact => None,
        BushState::Extinguished => Some(blend(CHAR, EXTINGUISHED, 0.6)),
        _ => Some(fire_colour(seconds(now) - seconds(last.ignited), seconds(now) - seconds(last.ends))),
    }
}

fn over(under: Rgb, colour: Rgb) -> Rgb {
    const WEIGHT: u32 = (256.0 * BURNED_OPACITY) as u32;
    std::array::from_fn(|channel| {
        let under = u32::from(under[channel]);
        let colour = u32::from(colour[channel]);
        ((under * (256 - WEIGHT) + colour * WEIGHT) >> 8) as u8
    })
}

#[expect(clippy::cast_possible_truncation, reason = "colours change by seconds, and runs last some hours")]
fn seconds(time: SimTime) -> f32 {
    time.as_seconds() as f32
}

fn opaque([red, green, blue]: Rgb) -> [u8; 4] {
    [red, green, blue, 255]
}

/// Calls `paint` for every pixel of the field with the index of the cell in its middle.
fn each_pixel(canvas: &mut Canvas, pane: &Pane, mut paint: impl FnMut(usize, &mut [u8; 4])) {
    let frame = pane.frame();
    let (columns, rows) = pane.field_pixels();
    let middle = |x: u32, y: u32| pane.projection.world((f64::from(x) + 0.5, f64::from(y) + 0.5));
    // The index is clamped, as the middle of the last pixel may lie on the border through rounding.
    let place = |at_m: f64, count: u16| ((at_m / frame.cell_m) as usize).min(usize::from(count) - 1);
    // Columns are computed once and not for each row, as no pixel's column depends on its row.
    let cols: Vec<usize> = columns.clone().map(|x| place(middle(x, 0).x, frame.cols)).collect();
    for y in rows {
        let first = place(middle(0, y).y, frame.rows) * usize::from(frame.cols);
        let pixels = canvas.row_from(columns.start as usize, y as usize);
        for (&col, pixel) in cols.iter().zip(pixels) {
            paint(first + col, pixel);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::field::FieldView;
    use crate::film::field::tests::setting;
    use crate::film::{Camera, FrameRenderer, FrameRequest, Layers, Projection, ViewOptions};
    use std::sync::Arc;
    use wildfire_fire::CanopyLayers;
    use wildfire_fire::surface::crown::{Canopy, CrownMethod, CrownRules};
    use wildfire_timeline::{GroundEvent, SpreadSetting, Timeline, sample};

    const SIZE: (u32, u32) = (640, 480);

    fn frame(run: &RunView, time_s: f64, layers: Layers) -> Vec<u8> {
        let options = ViewOptions { layers, ..ViewOptions::default() };
        let request = FrameRequest { runs: &[run], time: SimTime::from_seconds(time_s), options: &options };
        FrameRenderer::new(SIZE, 1).paint(&request).to_vec()
    }

    fn ground_layers() -> impl Iterator<Item = Layer> {
        Layer::ALL.into_iter().filter(|layer| layer.needs_ground())
    }

    #[test]
    fn every_layer_of_the_ground_shows_something_there_and_nothing_elsewhere() {
        let on_ground = RunView::new(sample::on_ground(), None);
        let elsewhere = RunView::new(Timeline { setting: setting(), events: Vec::new(), ground: Vec::new() }, None);
        let mut wooded = sample::on_ground();
        let Some(SpreadSetting::Rothermel { landscape, rules, .. }) = &mut wooded.setting.spread else {
            unreachable!("its ground is grass")
        };
        let trees = Canopy { height_m: 15.0, base_m: 0.5, bulk_density_kg_m3: 0.1, cover: 0.5 };
        let cells = landscape.frame.cell_count();
        Arc::make_mut(landscape).canopy = Some(CanopyLayers::uniform(&trees, cells));
        rules.crowns = Some(CrownRules { method: CrownMethod::ScottReinhardt, foliar_moisture: 1.0 });
        let wooded = RunView::new(wooded, None);
        for layer in ground_layers() {
            // The few cells of the sample burn one by one, without the squares of four that lines need.
            let differs = |run: &RunView, time_s: f64| {
                frame(run, time_s, Layers::NONE.with(layer)) != frame(run, time_s, Layers::NONE)
            };
            assert_eq!(differs(&wooded, 45.5), layer != Layer::Arrival, "{layer:?}");
            assert_eq!(differs(&on_ground, 45.5), !matches!(layer, Layer::Arrival | Layer::FireType), "{layer:?}");
            assert!(!differs(&elsewhere, 45.5), "{layer:?} where only bushes burn");
        }
    }

    #[test]
    fn frames_of_ground_follow_from_their_requests_alone() {
        let runs = [1, 2].map(|seed| RunView::new(sample::random_on_ground(seed, SimTime::from_seconds(600.0)), None));
        let all: Layers = Layer::ALL.into_iter().collect();
        let mut renderer = FrameRenderer::new(SIZE, 1);
        for (step, time_s) in [0.0, 100.0, 101.0, 550.0, 30.0, 300.0, 300.5, 599.0, 10.0, 200.0].into_iter().enumerate()
        {
            let camera = Camera { zoom: [1.0, 4.0, 0.5][step / 2 % 3], ..Camera::WHOLE };
            let layers = if step % 3 == 0 { Layers::default() } else { all };
            let options = ViewOptions { layers, camera, ..ViewOptions::default() };
            let time = SimTime::from_seconds(time_s);
            let request = FrameRequest { runs: &[&runs[step % 2]], time, options: &options };
            let fresh = FrameRenderer::new(SIZE, 1).paint(&request).to_vec();
            assert!(renderer.paint(&request) == fresh, "step {step}, {time_s} s");
        }
    }

    #[test]
    fn ground_that_burns_is_seen_however_small_its_cells_are() {
        const SIDE: u32 = 20;
        let mut burning = 0;
        for seed in 1..4 {
            let run = RunView::new(sample::random_on_ground(seed, SimTime::from_seconds(600.0)), None);
            let ground = run.index().ground().expect("it has ground");
            let landscape = GroundView::new(&run).expect("it has ground");
            let options = ViewOptions::default();
            for step in 0..60 {
                let state = run.state_at(SimTime::from_seconds(9.7 * f64::from(step)));
                let frame = run.timeline().setting.frame;
                let view = FieldView { run: &run, state: &state, rival: None, run_index: 0, options: &options };
                let projection = Projection::new(&frame, Camera::WHOLE, (f64::from(SIDE), f64::from(SIDE)));
                let pane = Pane { view: &view, projection, size: (SIDE, SIDE) };
                assert!(pane.cell_side() < 1.0);
                let mut canvas = Canvas::new(SIDE, SIDE, PAPER);
                landscape.draw_fire(&mut canvas, &pane);
                let picture = canvas.finish();
                for cell in (0..frame.cell_count()).map(|index| frame.cell(index)) {
                    if let Some(BushState::Burning { .. }) = ground.state_at(cell, state.time) {
                        let (x, y) = pane.cell_centre(cell);
                        let [red, _, blue] = picture.pixel(x as u32, y as u32);
                        assert!(red > blue + 90, "{cell} at {}", state.time);
                        burning += 1;
                    }
                }
            }
        }
        assert!(burning > 20, "these runs cannot tell: {burning}");
    }

    #[test]
    fn the_front_passes_through_arrival_lines_in_time() {
        // A fire that goes east by a cell a second, over the whole field.
        let mut timeline = sample::on_ground();
        timeline.events.clear();
        timeline.ground.clear();
        let field = timeline.setting.frame;
        for index in 0..field.cell_count() {
            let cell = field.cell(index);
            if timeline.setting.is_ground(cell) {
                let time = SimTime::from_seconds(1.0 + f64::from(cell.col));
                let cause = if cell.col == 0 { Cause::Scheduled } else { Cause::Spread(cell) };
                timeline.ground.push(GroundEvent { time, cell, fact: GroundFact::Ignited(cause) });
            }
        }
        timeline.ground.sort_by_key(|event| event.time);
        let run = RunView::new(timeline, None);
        let lines = ArrivalLines::new(&run);
        assert!(lines.levels.iter().any(|(_, _, lines)| !lines.is_empty()));
        for (level, label, lines) in &lines.levels {
            assert_eq!(*label, format!("{level} s"));
            let expected = level - 1.0;
            assert!(lines.iter().flat_map(|line| &line.points).all(|&(col, _)| (col - expected).abs() < 1e-9));
        }
        let shows_lines = |time_s: f64| {
            let layers = Layers::NONE.with(Layer::Arrival);
            frame(&run, time_s, layers) != frame(&run, time_s, Layers::NONE)
        };
        assert!(!shows_lines(0.5) && shows_lines(8.0));
    }

    #[test]
    fn fire_is_bright_at_first_and_leaves_dark_ground() {
        let brightness = |colour: Rgb| colour.iter().map(|&channel| u32::from(channel)).sum::<u32>();
        let ages = [0.0, 5.0, 19.0, 40.0, 200.0].map(|age_s| brightness(fire_colour(age_s, -1.0)));
        assert!(ages.windows(2).all(|pair| pair[0] > pair[1]), "{ages:?}");
        assert_eq!(fire_colour(500.0, 400.0), CHAR);
        assert!(brightness(fire_colour(500.0, 0.0)) < ages[4]);
    }
}
