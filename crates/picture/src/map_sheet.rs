//! A sheet of small maps in rows and columns, such as those of a sweep over parameters: one range of colours, one key.

use crate::canvas::{Canvas, Point};
use crate::colours::{INK, PAPER};
use crate::legend::{Legend, TEXT};
use crate::map::{Plate, face_colour, key, lines_within};
use crate::png::Picture;
use crate::scene::MapScene;
use crate::text::{Align, draw_text, measure_text};
use crate::values::ValueScale;
use crate::zoom::Zoom;

/// A small map with a line of text below it.
pub struct SheetPanel<'a> {
    pub caption: &'a str,
    pub scene: MapScene<'a>,
}

/// Small maps of one size with what is said about all of them.
pub struct MapSheet<'a> {
    pub title: &'a str,
    /// Under the title in smaller letters, on as many lines as it needs.
    pub subtitle: &'a str,
    /// The panels of a row.
    pub columns: usize,
    /// Row by row; at least one.
    pub panels: &'a [SheetPanel<'a>],
}

/// The usual and the greatest length of a panel's longer side, in pixels.
const PANEL: usize = 200;
const LONGEST_PANEL: usize = 320;
const TITLE: f32 = 13.0;
const MARGIN: f32 = 24.0;
const GAP: f32 = 14.0;
const LINE: f32 = 17.0;

/// Draws the panels without numbers of rows and columns; colours span the values of all of them.
///
/// # Panics
/// If there is no panel.
pub fn draw_map_sheet(sheet: &MapSheet) -> Picture {
    let first = &sheet.panels[0].scene;
    let zoom = Zoom::fit_to(first.occupied.rows(), first.occupied.cols(), PANEL, LONGEST_PANEL);
    let values = sheet.panels.iter().flat_map(|panel| panel.scene.free_values());
    // All panels share one scale, or equal colours would mean different values.
    let scale = ValueScale::from_values(values, first.colours);
    let mut entries = Vec::new();
    // Panels may lack marks that others have; the key has each once.
    for entry in sheet.panels.iter().flat_map(|panel| key(&panel.scene)) {
        if !entries.contains(&entry) {
            entries.push(entry);
        }
    }
    let legend = Legend { values: None, key: entries };
    let plates: Vec<Plate> = sheet.panels.iter().map(|panel| draw_panel(&panel.scene, zoom, scale.as_ref())).collect();
    // All maps have one size, so the first panel gives the room of each.
    let panel = plates[0].size();
    let captions = sheet.panels.iter().map(|panel| measure_text(panel.caption, TEXT));
    let column = captions.fold(panel.0 as f32, f32::max).ceil() + GAP;
    let row = panel.1 as f32 + LINE + GAP;
    let columns = sheet.columns.min(plates.len()) as f32;
    let rows = plates.len().div_ceil(sheet.columns) as f32;
    let legend_at = MARGIN + columns * column;
    let right = (legend_at + legend.width(1.0)).max(MARGIN + measure_text(sheet.title, TITLE)) + MARGIN;
    let subtitle = lines_within(sheet.subtitle, right - 2.0 * MARGIN, TEXT);
    let top = MARGIN + TITLE + subtitle.len() as f32 * LINE + GAP;
    let mut canvas = Canvas::sized(right, top + (rows * row).max(legend.height(0.0, 1.0)) + MARGIN - GAP, PAPER);
    draw_text(&mut canvas, sheet.title, (MARGIN, MARGIN + TITLE), Align::Left, TITLE, INK);
    for (line, index) in subtitle.iter().zip(1_u8..) {
        let base = MARGIN + TITLE + f32::from(index) * LINE;
        draw_text(&mut canvas, line, (MARGIN, base), Align::Left, TEXT, INK);
    }
    legend.draw(&mut canvas, (legend_at, top), 0.0, 1.0);
    for (index, (plate, panel)) in plates.iter().zip(sheet.panels).enumerate() {
        let corner: Point =
            (MARGIN + (index % sheet.columns) as f32 * column, top + (index / sheet.columns) as f32 * row);
        plate.copy_onto(&mut canvas, corner);
        let base = corner.1 + plate.size().1 as f32 + TEXT + 3.0;
        draw_text(&mut canvas, panel.caption, (corner.0, base), Align::Left, TEXT, INK);
    }
    canvas.finish()
}

fn draw_panel<'a>(scene: &'a MapScene<'a>, zoom: Zoom, scale: Option<&ValueScale>) -> Plate<'a> {
    let mut plate = Plate::alone(scene, zoom);
    plate.paint(&|block| face_colour(block.face(scene), scale));
    plate.mark();
    plate
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_grid::Grid;

    #[test]
    fn a_sheet_grows_by_whole_rows_of_panels() {
        let occupied = Grid::filled(4, 5, false);
        let value = |(row, col)| Some((row * col) as f64);
        let panel = || SheetPanel { caption: "q 5", scene: MapScene::new("", "potential", &occupied, &value) };
        let panels: Vec<_> = (0..5).map(|_| panel()).collect();
        let height = |count: usize| {
            let sheet = MapSheet { title: "t", subtitle: "", columns: 2, panels: &panels[..count] };
            draw_map_sheet(&sheet).height()
        };
        assert_eq!(height(1), height(2));
        assert_eq!(height(3), height(4));
        assert_eq!(height(3) - height(2), height(5) - height(4));
    }
}
