//! Maps of values over a field, north up: arrival times with contour lines, intensities, burn probabilities, differences;
//! with title, scale of lengths, north arrow, bar of colours and key. Several are drawn side by side.
//!
//! Sizes follow from the texts, so that nothing overlaps or is cut off whatever the shape of the field; where maps are
//! drawn more than 1000 pixels long, texts and marks grow with them.

mod panel;
mod scale;

pub use scale::{MapQuantity, MapScale};

use crate::Picture;
use crate::canvas::Canvas;
use crate::colours::{INK, PAPER};
use crate::ground::GroundCover;
use crate::text::{Align, draw_text, measure_text};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_fire::Landscape;

use panel::Panel;

/// A map of values over a field.
#[derive(Clone, Copy)]
pub struct FieldMap<'a> {
    pub title: &'a str,
    pub frame: FieldFrame,
    pub quantity: MapQuantity,
    /// By cell index; not a number where there is none.
    pub values: &'a [f64],
    /// The name of the colour of ground that could have a value and has none, such as "not burned".
    pub without_value: &'a str,
    /// By cell index.
    pub covers: &'a [GroundCover],
    /// The ground whose relief is shown where there are no values.
    pub landscape: Option<&'a Landscape>,
    pub ignitions: &'a [Cell],
    /// Whether lines go along round values, with these written on them.
    pub has_contours: bool,
}

/// The longer side of a map that is alone, of one beside others, and the longest, in pixels.
const ALONE: usize = 800;
const BESIDE: usize = 480;
const LONGEST: usize = 4096;
const MARGIN: f32 = 24.0;
const HEADING: f32 = 15.0;
const GAP: f32 = 30.0;

/// Draws maps side by side, in this order, with a heading above all of them if it is not empty. A pixel that stands for
/// several cells shows one of them.
///
/// # Panics
/// If there are no maps.
pub fn draw_field_maps(heading: &str, maps: &[FieldMap]) -> Picture {
    assert!(!maps.is_empty(), "there is a map to draw");
    let side = if maps.len() == 1 { ALONE } else { BESIDE };
    // Maps of one quantity have one scale, so that their colours can be compared.
    let scale = |quantity: MapQuantity| {
        quantity.scale(maps.iter().filter(|map| map.quantity == quantity).flat_map(|map| map.values).copied())
    };
    let panels: Vec<Panel> = maps.iter().map(|map| Panel::new(map, scale(map.quantity), side, LONGEST)).collect();
    // All take the largest unit, so texts of maps side by side have one size.
    let unit = panels.iter().map(Panel::unit).fold(1.0, f32::max);
    let heading_height = if heading.is_empty() { 0.0 } else { (HEADING + GAP) * unit };
    let width = panels.iter().map(|panel| panel.width() + GAP * unit).sum::<f32>() - GAP * unit;
    let width = width.max(measure_text(heading, HEADING * unit)) + 2.0 * MARGIN * unit;
    let height = panels.iter().map(Panel::height).fold(0.0, f32::max) + heading_height + 2.0 * MARGIN * unit;
    let mut canvas = Canvas::sized(width, height, PAPER);
    draw_text(&mut canvas, heading, (MARGIN * unit, (MARGIN + HEADING) * unit), Align::Left, HEADING * unit, INK);
    let mut left = MARGIN * unit;
    for panel in panels {
        // Maps lie on whole pixels: between two of them they would be blurred.
        panel.draw(&mut canvas, (left.round(), (MARGIN * unit + heading_height).round()));
        left += panel.width() + GAP * unit;
    }
    canvas.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::{Rgb, WITHOUT_VALUE};
    use crate::ground::ground_covers;
    use wildfire_fire::Relief;

    const FRAME: FieldFrame = FieldFrame { cols: 120, rows: 100, cell_m: 10.0 };

    fn hilly() -> Landscape {
        let place = |index: usize| FRAME.centre(FRAME.cell(index)) * 0.01;
        let heights = (0..FRAME.cell_count()).map(|index| {
            let x = place(index).x - 7.0;
            let y = place(index).y - 6.0;
            (120.0 / (1.0 + 0.2 * (x * x + y * y))) as f32
        });
        let fuel = (0..FRAME.cell_count()).map(|index| {
            let Cell { col, row } = FRAME.cell(index);
            match (col, row) {
                (80..=83, _) => 98,
                (_, 40) => 91,
                (_, 70..) => 183,
                _ => 102,
            }
        });
        Landscape { fuel: fuel.collect(), relief: Relief::Elevation(heights.collect()), ..Landscape::uniform(FRAME, 0) }
    }

    fn arrivals() -> Vec<f64> {
        let landscape = hilly();
        let time = |index: usize| {
            let to = FRAME.centre(FRAME.cell(index)) - FRAME.centre(Cell { col: 30, row: 30 });
            let time = 30.0 * (to.length() - 0.7 * to.x);
            if time < 6600.0 && GroundCover::from_fuel(landscape.fuel[index]).burns() { time } else { f64::NAN }
        };
        (0..FRAME.cell_count()).map(time).collect()
    }

    /// The pixel in the middle of a cell of a map that is alone: cells are 7 pixels wide, and the map lies below its title.
    fn colour_at(picture: &Picture, cell: Cell) -> Rgb {
        let pixels = 7;
        let above = picture.height() - 24 - (12 + 21 + 2 * 21 + 14 + 8 + 21) - pixels * u32::from(FRAME.rows);
        let col = u32::from(cell.col);
        let row = u32::from(FRAME.rows - 1 - cell.row);
        picture.pixel(24 + pixels * col + 3, above + pixels * row + 3)
    }

    #[test]
    fn cells_have_the_colour_of_their_value_or_of_their_ground() {
        let (landscape, values) = (hilly(), arrivals());
        let covers = ground_covers(&landscape);
        let map = FieldMap {
            title: "arrival",
            frame: FRAME,
            quantity: MapQuantity::ArrivalTime,
            values: &values,
            without_value: "not burned",
            covers: &covers,
            landscape: None,
            ignitions: &[],
            has_contours: false,
        };
        let picture = draw_field_maps("", &[map]);
        let scale = MapQuantity::ArrivalTime.scale(values.iter().copied()).expect("cells have burned");
        let burned = Cell { col: 50, row: 35 };
        assert_eq!(colour_at(&picture, burned), scale.colour(values[FRAME.index(burned)]));
        assert_eq!(colour_at(&picture, Cell { col: 5, row: 5 }), WITHOUT_VALUE);
        assert_eq!(colour_at(&picture, Cell { col: 82, row: 95 }), GroundCover::Water.colour());
        assert_eq!(colour_at(&picture, Cell { col: 5, row: 40 }), GroundCover::Road.colour());
        // Water is level, whatever the heights beside it are; other ground is lit.
        let relief = draw_field_maps("", &[FieldMap { landscape: Some(&landscape), ..map }]);
        assert_eq!(colour_at(&relief, Cell { col: 82, row: 95 }), GroundCover::Water.colour());
        assert!(colour_at(&relief, Cell { col: 90, row: 50 })[0] < WITHOUT_VALUE[0]);
        // Lines, their labels and marks are drawn over cells.
        let with_lines = draw_field_maps("", &[FieldMap { has_contours: true, ignitions: &[burned], ..map }]);
        assert_ne!(colour_at(&with_lines, burned), colour_at(&picture, burned));
        assert!(draw_field_maps("", &[map, map, map]).height() < picture.height());
    }

    #[test]
    fn maps_without_values_and_of_one_cell_are_drawn() {
        use MapQuantity::{ArrivalTime, Direction, FlameLength, Intensity, Probability, ProbabilityDifference};
        let frame = FieldFrame { cols: 1, rows: 1, cell_m: 0.3 };
        let map = FieldMap {
            title: "",
            frame,
            quantity: ArrivalTime,
            values: &[f64::NAN],
            without_value: "not burned",
            covers: &[GroundCover::Grass],
            landscape: None,
            ignitions: &[Cell { col: 0, row: 0 }],
            has_contours: true,
        };
        for quantity in [ArrivalTime, Intensity, FlameLength, Direction, Probability, ProbabilityDifference] {
            for value in [f64::NAN, 0.0, 1e-300, 1e300, -5.0] {
                draw_field_maps("one cell", &[FieldMap { quantity, values: &[value], ..map }]);
            }
        }
    }
}
