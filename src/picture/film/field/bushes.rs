//! Bushes by state: sprites, or flat cells where they are small.

use super::sprite::{Placement, Sprite};
use super::stamps::Stamps;
use super::{Pane, sprites};
use crate::fire::BushStateKind;
use crate::geometry::Cell;
use crate::picture::canvas::{Canvas, Point};
use crate::picture::colours::{FIELD, blend, bush_colour};

/// Cells with shorter sides than this, in pixels, are flat.
pub const LEAST_SPRITE: f32 = 8.0;

/// Burning cells with shorter sides than this, in pixels, are drawn a pixel larger to all sides, so that one finds them.
const LEAST_FIRE: f32 = 3.0;

/// How much of the colour of its state the square of a bush has, which is what bodies may not touch.
const TINT: f64 = 0.45;

/// Differently turned drawings of a bush.
const VARIANTS: usize = 6;

fn sprite(kind: BushStateKind) -> &'static Sprite {
    match kind {
        BushStateKind::Intact => &sprites::BUSH,
        BushStateKind::Burning => &sprites::EMBERS,
        BushStateKind::BurnedOut => &sprites::BURNED,
        BushStateKind::Extinguished => &sprites::WET,
    }
}

/// Draws bushes, given in the order of the setting.
pub fn draw(canvas: &mut Canvas, pane: &Pane, kinds: &[BushStateKind], stamps: &mut Stamps) {
    if pane.cell_side() < LEAST_SPRITE {
        draw_flat(canvas, pane, kinds);
    } else {
        draw_squares(canvas, pane, kinds);
        draw_sprites(canvas, pane, kinds, stamps);
    }
}

/// Where several cells share a pixel, what burns is seen, some pixels wide at least.
fn draw_flat(canvas: &mut Canvas, pane: &Pane, kinds: &[BushStateKind]) {
    for is_burning in [false, true] {
        let bushes = pane.setting().bushes.iter().zip(kinds);
        for (&cell, kind) in bushes.filter(|(_, kind)| (**kind == BushStateKind::Burning) == is_burning) {
            let (from, to) = pane.projection.cell(pane.frame(), cell);
            let beyond = i32::from(is_burning && pane.cell_side() < LEAST_FIRE);
            canvas.fill_pixels((from.0 - beyond, from.1 - beyond), (to.0 + beyond, to.1 + beyond), bush_colour(*kind));
        }
    }
}

fn draw_squares(canvas: &mut Canvas, pane: &Pane, kinds: &[BushStateKind]) {
    for (&cell, kind) in pane.setting().bushes.iter().zip(kinds) {
        let (from, to) = pane.projection.cell(pane.frame(), cell);
        canvas.fill_pixels(from, to, blend(FIELD, bush_colour(*kind), TINT));
    }
}

/// From north to south, so that what sticks out of a cell lies over what is behind it.
fn draw_sprites(canvas: &mut Canvas, pane: &Pane, kinds: &[BushStateKind], stamps: &mut Stamps) {
    let side = pane.cell_side();
    for (&cell, &kind) in pane.setting().bushes.iter().zip(kinds).rev() {
        let at = pane.cell_centre(cell);
        if pane.is_near(at, side) {
            let variant = scatter(cell) as usize % VARIANTS;
            let number = kind as usize * VARIANTS + variant;
            stamps.lay(canvas, at, number, |canvas, at, side| draw_one(canvas, kind, variant, at, side));
        }
    }
}

pub fn draw_one(canvas: &mut Canvas, kind: BushStateKind, variant: usize, at: Point, side: f32) {
    let mirrored = if variant.is_multiple_of(2) { side } else { -side };
    let lean = (variant / 2) as f32 * 0.12 - 0.12;
    sprite(kind).draw(canvas, Placement::leaning(at, (mirrored, side), lean));
}

/// First number of stamps that are none of bushes.
pub const STAMPS: usize = 4 * VARIANTS;

/// A number that tells a cell from its neighbours: the mixing step of MurmurHash3 (Austin Appleby, 2011) on its place.
pub fn scatter(cell: Cell) -> u32 {
    let mut bits = (u32::from(cell.row) << 16) | u32::from(cell.col);
    bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
    bits ^ (bits >> 16)
}
