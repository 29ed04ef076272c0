//! Bushes by state: sprites, which are drawn once and stamped from then on, or flat cells where they are small.

use crate::canvas::{Canvas, Point};
use crate::colours::{FIELD, blend, bush_colour};
use crate::film::field::Pane;
use crate::film::field::fires::draw_tongues;
use crate::film::field::heat_map::HeatMap;
use crate::film::field::sprite::{BURNED_SPRITE, BUSH_SPRITE, EMBERS_SPRITE, Placement, Sprite, WET_SPRITE};
use wildfire_base::geometry::Cell;
use wildfire_fire::BushStateKind;

/// Cells with shorter sides than this, in pixels, are flat.
pub const MIN_SPRITE: f32 = 8.0;

/// Burning cells with shorter sides than this, in pixels, are drawn a pixel larger to all sides, so that one finds
/// them.
const MIN_FIRE: f32 = 3.0;

/// The share of its state's colour in the square of a bush, the area that bodies may not touch.
const TINT: f64 = 0.45;

/// Differently turned drawings of a bush.
const VARIANTS: usize = 6;

fn sprite(kind: BushStateKind) -> &'static Sprite {
    match kind {
        BushStateKind::Intact => &BUSH_SPRITE,
        BushStateKind::Burning => &EMBERS_SPRITE,
        BushStateKind::BurnedOut => &BURNED_SPRITE,
        BushStateKind::Extinguished => &WET_SPRITE,
    }
}

/// Draws bushes, given in the order of the setting.
pub fn draw_bushes(canvas: &mut Canvas, pane: &Pane, kinds: &[BushStateKind], stamps: &mut Stamps) {
    if pane.is_heat_map() {
        HeatMap::new(pane).draw(canvas, kinds);
    } else if pane.cell_side() < MIN_SPRITE {
        draw_flat_cells(canvas, pane, kinds);
    } else {
        draw_bush_squares(canvas, pane, kinds);
        draw_bush_sprites(canvas, pane, kinds, stamps);
    }
}

/// Draws bushes as flat cells. Where several cells share a pixel, burning ones win and are some pixels wide at least.
fn draw_flat_cells(canvas: &mut Canvas, pane: &Pane, kinds: &[BushStateKind]) {
    for is_burning in [false, true] {
        let bushes = pane.setting().bushes.iter().zip(kinds);
        for (&cell, kind) in bushes.filter(|(_, kind)| (**kind == BushStateKind::Burning) == is_burning) {
            let (from, to) = pane.projection.cell(pane.frame(), cell);
            let beyond = i32::from(is_burning && pane.cell_side() < MIN_FIRE);
            canvas.fill_pixels((from.0 - beyond, from.1 - beyond), (to.0 + beyond, to.1 + beyond), bush_colour(*kind));
        }
    }
}

fn draw_bush_squares(canvas: &mut Canvas, pane: &Pane, kinds: &[BushStateKind]) {
    for (&cell, kind) in pane.setting().bushes.iter().zip(kinds) {
        let (from, to) = pane.projection.cell(pane.frame(), cell);
        canvas.fill_pixels(from, to, blend(FIELD, bush_colour(*kind), TINT));
    }
}

/// Draws sprites from north to south, so that what sticks out of a cell lies over what is behind it.
fn draw_bush_sprites(canvas: &mut Canvas, pane: &Pane, kinds: &[BushStateKind], stamps: &mut Stamps) {
    let side = pane.cell_side();
    for (&cell, &kind) in pane.setting().bushes.iter().zip(kinds).rev() {
        let at = pane.cell_centre(cell);
        if pane.is_near(at, side) {
            // The place of the cell decides, so a bush looks the same in every frame and in every run.
            let variant = scatter(cell) as usize % VARIANTS;
            let number = kind as usize * VARIANTS + variant;
            stamps.lay(canvas, at, number, |canvas, at, side| draw_bush(canvas, kind, variant, at, side));
        }
    }
}

pub fn draw_bush(canvas: &mut Canvas, kind: BushStateKind, variant: usize, at: Point, side: f32) {
    let mirrored = if variant.is_multiple_of(2) { side } else { -side };
    let lean = (variant / 2) as f32 * 0.12 - 0.12;
    sprite(kind).draw(canvas, Placement::leaning(at, (mirrored, side), lean));
}

/// The first number of stamps that do not show bushes.
pub const BUSH_STAMPS: usize = 4 * VARIANTS;

/// A number that tells a cell from its neighbours: the mixing step of MurmurHash3 (Austin Appleby, 2011) on its place.
pub fn scatter(cell: Cell) -> u32 {
    let mut bits = (u32::from(cell.row) << 16) | u32::from(cell.col);
    bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
    bits ^ (bits >> 16)
}

/// Cells with longer sides than this, in pixels, are few: their sprites are drawn where they are.
const MAX_STAMP_SIDE: f32 = 96.0;

/// The width of a stamp in sides of a cell, so that what sticks out of its cell is on it.
const STAMP_WIDTH: f32 = 1.8;

/// Drawings on small sheets, all for cells of one size.
#[derive(Default)]
pub struct Stamps {
    side: f32,
    drawn: Vec<Option<Canvas>>,
}

impl Stamps {
    /// Forgets what was drawn for cells of another size.
    pub fn begin(&mut self, side: f32) {
        if self.side != side {
            *self = Self { side, drawn: Vec::new() };
        }
    }

    /// Lays down what `draw` draws about a place, for cells of the present side; `number` tells one drawing from
    /// others.
    pub fn lay(&mut self, canvas: &mut Canvas, (x, y): Point, number: usize, draw: impl Fn(&mut Canvas, Point, f32)) {
        if self.side > MAX_STAMP_SIDE {
            return draw(canvas, (x, y), self.side);
        }
        let half = (0.5 * STAMP_WIDTH * self.side).ceil() as u32 + 1;
        if self.drawn.len() <= number {
            self.drawn.resize_with(number + 1, || None);
        }
        let stamp = self.drawn[number].get_or_insert_with(|| {
            let mut stamp = Canvas::transparent(2 * half, 2 * half);
            draw(&mut stamp, (half as f32, half as f32), self.side);
            stamp
        });
        // To whole pixels, between which a stamp would be blurred.
        canvas.lay_over(stamp, (x.round() as i32 - half as i32, y.round() as i32 - half as i32));
    }
}

/// Draws a bush about a place, as large as in a cell of that side in pixels.
pub fn draw_sign(canvas: &mut Canvas, kind: BushStateKind, at: Point, side: f32) {
    draw_bush(canvas, kind, 0, at, side);
    if kind == BushStateKind::Burning {
        draw_tongues(canvas, at, (side, side), 0);
    }
}
