//! A map as a surface in space.
//!
//! Tiles are drawn from back to front, so that nearer ones hide what lies behind them (the painter's algorithm; Newell,
//! Newell and Sancha, "A solution to the hidden surface problem", 1972). The sheet is twice as large as the picture in
//! both directions and then halved: smooth edges, and no seams between tiles.

mod axes;
mod camera;
mod relief;
mod track;

use axes::{axes_room, draw_axes};
use camera::{FittedCamera, GROUND, SurfaceCamera};
use relief::Relief;
use track::SurfaceTrack;

use crate::canvas::{Canvas, Point};
use crate::colours::{INK, PAPER, Rgb, blend};
use crate::legend::{Legend, TEXT};
use crate::map::{SUBTITLE_LINE, bar, face_colour, key, lines_within};
use crate::png::Picture;
use crate::scene::MapScene;
use crate::text::{Align, draw_text, measure_text};
use crate::values::ValueScale;

const TITLE: f32 = 13.0;
const MARGIN: f32 = 24.0;
/// The largest width and height of the drawn box.
const BOX: Point = (760.0, 560.0);
const FINER: f32 = 2.0;
/// The part by which the sides of tiles are darker than their tops: towards the lower left, towards the lower right.
const SHADE: (f64, f64) = (0.25, 0.45);
/// Tiles whose sides reach this far, in pixels, are outlined.
const OUTLINED: f32 = 5.0;

/// The map as a surface in space, seen from the south-east at an angle, its height the value.
///
/// Heights span the finite values of all cells, colours those of free cells, as in [`super::draw_map`]. Obstacles are
/// dark and flat at their value (at the top if it is infinite); obstacles and cells without value stand on the ground,
/// a little below the lowest value. Maps of more than 256 cells a side are drawn with square tiles of several cells:
/// an obstacle where at least half of the cells are, else at the mean value. A path is drawn on the surface, dotted
/// where the surface hides it. A picture takes about 20 MB of memory while it is drawn, whatever the size of the map.
pub fn draw_surface(scene: &MapScene) -> Picture {
    // Ground is ground, whatever went over it.
    let scene = &MapScene { swept: None, ..*scene };
    let heights = ValueScale::from_values(scene.places().filter_map(|place| scene.value_at(place)), scene.colours);
    let scale = scene.scale();
    let size = (scene.occupied.rows(), scene.occupied.cols());
    let relief = Relief::new(scene, heights.as_ref());
    let FittedCamera { camera, size: (width, height) } = SurfaceCamera::fit(size, BOX);
    let room = axes_room(size, scene.value_name, heights.as_ref());
    let legend = Legend { values: bar(scene, scale.as_ref()), key: key(scene) };
    let legend_left = MARGIN + room.left + width + room.right + MARGIN;
    let title_ends = MARGIN + measure_text(scene.title, TITLE);
    let right = title_ends.max(legend_left + legend.width(1.0)) + MARGIN;
    let subtitle = lines_within(scene.subtitle, right - 2.0 * MARGIN, TEXT);
    let corner = (MARGIN + room.left, MARGIN + TITLE + 4.0 * TEXT + subtitle.len() as f32 * SUBTITLE_LINE);
    let camera = camera.moved(corner);
    let legend_at = (legend_left, corner.1);
    let bottom = corner.1 + (height + room.below).max(legend.height(height, 1.0)) + MARGIN;

    let mut canvas = draw_relief(&relief, &camera.enlarged(FINER), (right, bottom), heights.as_ref(), scale.as_ref());
    draw_axes(&mut canvas, &camera, size, scene.value_name, heights.as_ref());
    SurfaceTrack { scene, relief: &relief, heights: heights.as_ref(), camera }.draw_track(&mut canvas);
    draw_text(&mut canvas, scene.title, (MARGIN, MARGIN + TITLE), Align::Left, TITLE, INK);
    let mut base = MARGIN + TITLE;
    for line in subtitle {
        base += SUBTITLE_LINE;
        draw_text(&mut canvas, line, (MARGIN, base), Align::Left, TEXT, INK);
    }
    legend.draw(&mut canvas, legend_at, height, 1.0);
    canvas.finish()
}

/// Draws walls and tiles, finer than they are returned.
fn draw_relief(
    relief: &Relief,
    camera: &SurfaceCamera,
    (right, bottom): Point,
    heights: Option<&ValueScale>,
    scale: Option<&ValueScale>,
) -> Canvas {
    let mut canvas = Canvas::sized(right.ceil() * FINER, bottom.ceil() * FINER, PAPER);
    axes::draw_walls(&mut canvas, camera, heights, FINER);
    // From north to south and west to east, which is from back to front for a viewer in the south-east.
    for row in 0..relief.tiles.rows() {
        for col in 0..relief.tiles.cols() {
            let colour = face_colour(relief.tiles[(row, col)].face, scale);
            draw_tile(&mut canvas, camera, relief, (row, col), colour);
        }
    }
    canvas.halved()
}

/// Draws the sides of a tile that the viewer can see, and its top.
fn draw_tile(canvas: &mut Canvas, camera: &SurfaceCamera, relief: &Relief, (row, col): (usize, usize), colour: Rgb) {
    let north = relief.row_edge(row);
    let south = relief.row_edge(row + 1);
    let west = relief.col_edge(col);
    let east = relief.col_edge(col + 1);
    let [nw, ne, se, sw] = relief.corners((row, col));
    let is_last = (row + 1 == relief.tiles.rows(), col + 1 == relief.tiles.cols());
    let below = if is_last.0 { [GROUND; 4] } else { relief.corners((row + 1, col)) };
    let beside = if is_last.1 { [GROUND; 4] } else { relief.corners((row, col + 1)) };

    // Only the sides to the south and the east can be seen, and only as far as they stand out above the next tile.
    if sw > below[0] || se > below[1] {
        let side = [(west, sw), (east, se), (east, below[1]), (west, below[0])];
        canvas.fill_hard(&side.map(|(x, level)| camera.at(x, south, level)), blend(colour, INK, SHADE.0));
    }
    if ne > beside[0] || se > beside[3] {
        let side = [(north, ne), (south, se), (south, beside[3]), (north, beside[0])];
        canvas.fill_hard(&side.map(|(y, level)| camera.at(east, y, level)), blend(colour, INK, SHADE.1));
    }
    let top = [(west, north, nw), (east, north, ne), (east, south, se), (west, south, sw)];
    let top = top.map(|(x, y, level)| camera.at(x, y, level));
    canvas.fill_hard(&top, colour);
    let wide = top[1].0 - top[0].0;
    let long = top[3].1 - top[0].1;
    // The outline of a small tile would cover its colour.
    if wide.min(long.abs()) > OUTLINED * FINER {
        canvas.outline_hard(&top, FINER / 2.0, blend(colour, INK, SHADE.0));
    }
}
