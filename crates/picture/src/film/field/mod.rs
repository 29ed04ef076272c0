//! The pane of a field: bushes, fires, agents, and the layers that are switched on.
//!
//! What seldom changes is kept: the backdrop (ground and layers), and on it the bushes by state. Flames, ways, agents
//! and what fire does are drawn on a copy of these for every frame. In both, later things lie over earlier ones.

mod agents;
mod bushes;
mod clusters;
mod fires;
pub(super) mod ground;
mod heat_map;
mod highlights;
mod labels;
mod lines;
mod scales;
pub(super) mod searches;
pub(super) mod sprite;
mod suppression;
mod value_map;
mod water;
mod ways;
mod wind;

pub use bushes::draw_sign;
pub use clusters::draw_glow;
pub use highlights::pick;
pub use wind::compass_word;

use std::ops::Range;

use agents::draw_agents;
use bushes::{MIN_SPRITE, Stamps, draw_bushes};
use clusters::draw_glows;
use fires::{draw_flames, draw_spreads};
use ground::{GroundView, draw_wet};
use heat_map::{HeatMap, burning_places, draw_fire_cores, draw_fire_marks};
use highlights::{draw_differences, draw_selected};
use labels::draw_labels;
use scales::{ValueBar, draw_length_bar, draw_value_bar};
use searches::{ShownSearch, draw_searches, shown_searches};
use suppression::draw_suppressions;
use value_map::{FieldQuantity, ValueMap};
use water::draw_water;
use ways::draw_ways;
use wind::draw_wind;

use crate::canvas::{Canvas, Point};
use crate::colours::{BORDER, FIELD, INK, OUTSIDE, blend};
use crate::film::camera::Projection;
use crate::film::lettering::Lettering;
use crate::film::{Layer, Layers, RunView, RunViewId, ViewOptions};
use crate::ticks;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_fire::BushStateKind;
use wildfire_timeline::{BushState, Setting, State};

/// Panes whose shorter side has more pixels than this get wider lines and larger letters.
const ORDINARY_SIDE: f32 = 900.0;

/// Fields whose cells have shorter sides than this, in pixels, are shown as heat maps if a side has this many cells: those of
/// smaller fields are as small only on small sheets, where each can still be drawn.
const MIN_CELL: f64 = 3.0;
const MIN_CELLS: u16 = 100;

/// Returns whether a field whose cells have that side in pixels is shown as a heat map.
pub fn is_summed(frame: &FieldFrame, cell_side: f64) -> bool {
    cell_side < MIN_CELL && frame.cols.max(frame.rows) >= MIN_CELLS
}

/// Lines of the grid are at least this many pixels apart; where cells are smaller, some are left out.
const GRID_LINES: f64 = 6.0;

/// A run at one time, and how it is looked at.
#[derive(Clone, Copy)]
pub struct FieldView<'a> {
    pub run: &'a RunView,
    pub state: &'a State,
    /// The other run of a comparison at that time.
    pub rival: Option<(&'a RunView, &'a State)>,
    /// Which of the runs it is.
    pub run_index: usize,
    pub options: &'a ViewOptions,
}

/// A moment, and where it is drawn.
#[derive(Clone, Copy)]
struct Pane<'a> {
    view: &'a FieldView<'a>,
    projection: Projection,
    size: (u32, u32),
}

/// Draws one pane; keeps what seldom changes from frame to frame.
#[derive(Default)]
pub struct FieldRenderer {
    /// The run that all else is of.
    run: Option<RunViewId>,
    values: Option<ValueMap>,
    /// Ground that burns, if the run has some.
    landscape: Option<GroundView>,
    backdrop: Kept<Backdrop>,
    ground: Kept<(Backdrop, Vec<BushStateKind>)>,
    sheet: Option<Canvas>,
    stamps: Stamps,
    lettering: Lettering,
}

/// All that the backdrop follows from, except the run.
#[derive(Clone, PartialEq)]
struct Backdrop {
    projection: Projection,
    size: (u32, u32),
    layers: Layers,
    values: Option<FieldQuantity>,
    /// The facts of the searches that are shown.
    searches: Vec<usize>,
}

impl FieldRenderer {
    /// The pane, `size` in pixels.
    pub fn paint(&mut self, view: &FieldView, size: (u32, u32)) -> &Canvas {
        self.begin(view.run);
        let projection = Projection::from_options(view.run, view.state, view.options, size);
        let pane = Pane { view, projection, size };
        self.find_values(&pane);
        self.stamps.begin(pane.cell_side());
        self.draw_ground(&pane);
        self.draw_view(&pane)
    }

    /// Draws the part of the pane that is kept from frame to frame.
    fn draw_ground(&mut self, pane: &Pane) {
        let searches = shown_searches(pane);
        let key = Backdrop {
            projection: pane.projection,
            size: pane.size,
            layers: pane.view.options.layers,
            values: FieldQuantity::shown(pane),
            searches: searches.iter().map(|search| search.fact).collect(),
        };
        let values = self.values.as_ref();
        let landscape = self.landscape.as_ref();
        let backdrop = self.backdrop.get(key.clone(), |_| draw_backdrop(pane, landscape, values, &searches));
        let kinds = pane.view.state.bushes.iter().copied().map(BushState::kind).collect();
        self.ground.change((key, kinds), |last, (key, kinds)| match last {
            // Only heat maps can be redrawn in part, as sprites stick out into neighbouring rows.
            Some(((last, before), mut ground)) if pane.is_heat_map() && last == *key => {
                HeatMap::new(pane).redraw(&mut ground, backdrop, [&before, kinds]);
                ground
            }
            _ => {
                let mut ground = backdrop.clone();
                draw_bushes(&mut ground, pane, kinds, &mut self.stamps);
                ground
            }
        });
    }

    /// Draws what changes from frame to frame over what is kept.
    fn draw_view(&mut self, pane: &Pane) -> &Canvas {
        let ground = self.ground.last().expect("it was drawn just now");
        // A window may have changed its size.
        self.sheet.take_if(|sheet| (sheet.width(), sheet.height()) != pane.size);
        let sheet = self.sheet.get_or_insert_with(|| ground.clone());
        sheet.copy_from(ground, (0, 0));
        if let Some(landscape) = &self.landscape {
            // Sprites stick out of their cells, so that bushes are drawn once more over what burns beside them; flat ones
            // do not, and fire on the ground leaves them alone.
            let has_sprites = pane.cell_side() >= MIN_SPRITE;
            if let Some(backdrop) = self.backdrop.last().filter(|_| has_sprites) {
                sheet.copy_from(backdrop, (0, 0));
            }
            landscape.draw_fire(sheet, pane);
            if pane.shows(Layer::Wet) {
                draw_wet(sheet, pane);
            }
            if has_sprites {
                let kinds: Vec<BushStateKind> = pane.view.state.bushes.iter().copied().map(BushState::kind).collect();
                draw_bushes(sheet, pane, &kinds, &mut self.stamps);
            }
            if pane.shows(Layer::Arrival) {
                landscape.draw_arrival_lines(sheet, pane);
            }
            if pane.shows(Layer::Embers) {
                landscape.draw_embers(sheet, pane);
            }
        }
        let is_crowded = pane.view.run.is_crowded();
        let fires = if pane.is_heat_map() || is_crowded { burning_places(pane) } else { Vec::new() };
        if pane.is_heat_map() && self.landscape.is_none() {
            draw_glows(sheet, pane);
        }
        if pane.shows(Layer::Paths) {
            draw_ways(sheet, pane);
        }
        if pane.shows(Layer::Spread) {
            draw_spreads(sheet, pane);
        }
        if pane.is_heat_map() {
            draw_fire_marks(sheet, pane, &fires);
        } else {
            draw_flames(sheet, pane, &mut self.stamps);
        }
        draw_differences(sheet, pane);
        if pane.shows(Layer::Suppression) {
            draw_suppressions(sheet, pane);
        }
        draw_agents(sheet, pane, &mut self.lettering);
        if is_crowded {
            draw_labels(sheet, pane, &mut self.lettering, &fires);
        }
        draw_selected(sheet, pane);
        if pane.is_heat_map() {
            draw_fire_cores(sheet, pane, &fires);
        }
        draw_length_bar(sheet, pane);
        if pane.shows(Layer::Wind) {
            draw_wind(sheet, pane);
        }
        if let Some(values) = &self.values {
            draw_value_bar(sheet, pane, &ValueBar::from_values(values));
        } else if let Some(shades) = self.landscape.as_ref().and_then(|landscape| landscape.shades(pane)) {
            draw_value_bar(sheet, pane, &ValueBar::from_scale(&shades.scale));
        }
        sheet
    }

    fn find_values(&mut self, pane: &Pane) {
        let wanted = FieldQuantity::shown(pane);
        if self.values.as_ref().map(|values| values.quantity) != wanted {
            self.values = wanted.and_then(|quantity| ValueMap::new(pane.view.run, quantity));
        }
    }

    /// Forgets what was drawn of another run.
    fn begin(&mut self, run: &RunView) {
        if self.run != Some(run.id()) {
            *self = Self { run: Some(run.id()), landscape: GroundView::new(run), ..Self::default() };
        }
    }
}

fn draw_backdrop(
    pane: &Pane,
    landscape: Option<&GroundView>,
    values: Option<&ValueMap>,
    searches: &[ShownSearch],
) -> Canvas {
    let mut canvas = Canvas::new(pane.size.0, pane.size.1, OUTSIDE);
    let (from, to) = pane.field_box();
    canvas.fill_pixels((from.0 - 2, from.1 - 2), (to.0 + 2, to.1 + 2), BORDER);
    canvas.fill_pixels(from, to, FIELD);
    if let Some(landscape) = landscape.filter(|_| pane.shows(Layer::Ground)) {
        landscape.draw_covers(&mut canvas, pane);
    }
    if let Some(values) = values {
        values.draw(&mut canvas, pane);
    }
    if pane.shows(Layer::GridLines) {
        draw_grid_lines(&mut canvas, pane);
    }
    draw_searches(&mut canvas, pane, searches);
    draw_water(&mut canvas, pane);
    canvas
}

fn draw_grid_lines(canvas: &mut Canvas, pane: &Pane) {
    let frame = pane.frame();
    let colour = blend(FIELD, INK, 0.25);
    let ((left, top), (right, bottom)) = pane.field_box();
    let min = GRID_LINES / f64::from(pane.cell_side());
    // The first line would lie on the border.
    for col in ticks::indices(frame.cols.into(), min).skip(1) {
        let ((x, _), _) = pane.projection.cell(frame, Cell { col: col as u16, row: 0 });
        canvas.fill_pixels((x, top), (x + 1, bottom), colour);
    }
    for row in ticks::indices(frame.rows.into(), min).skip(1) {
        let (_, (_, y)) = pane.projection.cell(frame, Cell { col: 0, row: row as u16 });
        canvas.fill_pixels((left, y - 1), (right, y), colour);
    }
}

impl<'a> Pane<'a> {
    fn setting(&self) -> &'a Setting {
        &self.view.run.timeline().setting
    }

    fn frame(&self) -> &'a FieldFrame {
        &self.setting().frame
    }

    fn shows(&self, layer: Layer) -> bool {
        self.view.options.layers.contains(layer)
    }

    /// The width of a thin line in pixels; all lines, letters and signs grow with it.
    fn unit(&self) -> f32 {
        (self.size.0.min(self.size.1) as f32 / ORDINARY_SIDE).max(1.0)
    }

    /// Returns the side of a cell in pixels.
    fn cell_side(&self) -> f32 {
        self.projection.length(self.frame().cell_m)
    }

    /// Returns whether cells are too small to be seen one by one.
    fn is_heat_map(&self) -> bool {
        is_summed(self.frame(), self.cell_side().into())
    }

    /// Returns whether agents are marks, since bodies large enough to be seen would hide each other and the field.
    fn has_marks(&self) -> bool {
        self.is_heat_map() && self.view.run.is_crowded()
    }

    fn cell_centre(&self, cell: Cell) -> Point {
        self.projection.at(self.frame().centre(cell))
    }

    /// The first pixels of the field, and those after its last.
    fn field_box(&self) -> ((i32, i32), (i32, i32)) {
        let frame = self.frame();
        let (north_west, _) = self.projection.cell(frame, Cell { col: 0, row: frame.rows - 1 });
        let (_, south_east) = self.projection.cell(frame, Cell { col: frame.cols - 1, row: 0 });
        (north_west, south_east)
    }

    /// The columns and rows of pixels of the field that are in the pane.
    fn field_pixels(&self) -> (Range<u32>, Range<u32>) {
        let (from, to) = self.field_box();
        let within = |first: i32, last: i32, side: u32| first.max(0) as u32..(last.max(0) as u32).min(side);
        (within(from.0, to.0, self.size.0), within(from.1, to.1, self.size.1))
    }

    /// Returns whether anything within `reach` pixels about a place is in the pane.
    fn is_near(&self, (x, y): Point, reach: f32) -> bool {
        let within = |at: f32, side: u32| (-reach..=side as f32 + reach).contains(&at);
        within(x, self.size.0) && within(y, self.size.1)
    }

    fn at(&self, point: DVec2) -> Point {
        self.projection.at(point)
    }
}

/// A drawing, and all that it follows from.
pub struct Kept<K> {
    drawn: Option<(K, Canvas)>,
}

impl<K> Default for Kept<K> {
    fn default() -> Self {
        Self { drawn: None }
    }
}

impl<K: PartialEq> Kept<K> {
    /// The drawing of a key, drawn again if it is not the last one.
    pub fn get(&mut self, key: K, draw: impl FnOnce(&K) -> Canvas) -> &Canvas {
        self.change(key, |_, key| draw(key))
    }

    /// The drawing of a key; if it is not the last one, it is made of that one.
    pub fn change(&mut self, key: K, change: impl FnOnce(Option<(K, Canvas)>, &K) -> Canvas) -> &Canvas {
        if self.drawn.as_ref().is_none_or(|(last, _)| *last != key) {
            let canvas = change(self.drawn.take(), &key);
            self.drawn = Some((key, canvas));
        }
        self.last().expect("it was drawn just now")
    }

    pub fn last(&self) -> Option<&Canvas> {
        self.drawn.as_ref().map(|(_, canvas)| canvas)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::film::{Camera, CameraTarget, FrameRenderer, FrameRequest};
    use wildfire_base::geometry::Pose;
    use wildfire_base::query::Effort;
    use wildfire_base::time::SimTime;
    use wildfire_base::trajectory::{Piece, Trajectory};
    use wildfire_base::vehicle::{Dimensions, Segment};
    use wildfire_timeline::{AgentFact, AgentId, AgentStart, Body, Event, Fact, FireFact, Timeline, sample};

    pub fn setting() -> Setting {
        Setting { scenario: "test".into(), bushes: Vec::new(), ..sample::small_setting(&[]) }
    }

    /// A truck that drives and suppresses, and fire that spreads, all lengths multiplied by `scale`.
    fn scaled(scale: f64) -> Timeline {
        let truck = AgentId::unimog(0);
        let goal = Cell { col: 4, row: 4 };
        let mut setting = setting();
        setting.frame.cell_m *= scale;
        setting.bushes = vec![goal];
        setting.rules.suppression_reach_m = Some(10.0 * scale);
        let pose = Pose::new(7.0 * scale, 9.0 * scale, 0.3);
        let body = Body::Truck(Dimensions { length_m: 4.9 * scale, width_m: 2.2 * scale, ..Dimensions::default() });
        setting.agents = vec![AgentStart { id: truck, pose, body, limits: None }];
        let drive = |curvature: f64, length_m: f64| Piece::Drive {
            segment: Segment { curvature, length_m },
            speed_mps: 8.0 * scale,
            acceleration_mps2: 0.0,
        };
        let pieces = vec![drive(0.07 / scale, 40.0 * scale), drive(0.0, -20.0 * scale)];
        let trajectory = Trajectory::new(SimTime::ZERO, pose, pieces);
        let effort = Effort { roadmap_expansions: 1, local_expansions: 1 };
        let at = |seconds: f64, fact: Fact| Event { time: SimTime::from_seconds(seconds), fact };
        let events = vec![
            at(0.0, Fact::Fire(FireFact::Ignited { cell: goal, cause: wildfire_timeline::Cause::Scheduled })),
            at(0.0, Fact::Agent(truck, AgentFact::Planned { goal, trajectory, effort, found_by: None })),
            at(8.0, Fact::Agent(truck, AgentFact::Suppressing { cell: goal, water_units: 1 })),
        ];
        Timeline { setting, events, ground: Vec::new() }
    }

    #[test]
    fn any_recording_can_be_drawn() {
        let layers = Layer::ALL.into_iter().collect();
        for scale in [1.0, 1e-6, 1e6, 1e-290, 1e290] {
            let run = RunView::new(scaled(scale), None);
            for zoom in [Camera::MIN_ZOOM, 1.0, Camera::MAX_ZOOM] {
                let camera = Camera { zoom, ..Camera::WHOLE };
                for follows in [None, Some(CameraTarget::Agent(AgentId::unimog(0))), Some(CameraTarget::Fleet)] {
                    let options = ViewOptions { camera, layers, follows, ..ViewOptions::default() };
                    for time_s in [0.0, 3.0, 10.0] {
                        let time = SimTime::from_seconds(time_s);
                        FrameRenderer::new((400, 300), 1).paint(&FrameRequest {
                            runs: &[&run],
                            time,
                            options: &options,
                        });
                    }
                }
            }
        }
    }
}
