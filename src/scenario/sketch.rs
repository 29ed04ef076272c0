//! A small map of a field as text.

use super::explain::WIDTH;
use super::{Scenario, Terrain};
use crate::geometry::{Cell, DVec2};

const INDENT: &str = "  ";

/// Draws a map of a field, north above: `.` free, `#` a bush, `W` and `U` where a Wumpus and a truck start.
///
/// On fields that are too wide a character is a square of cells, and is `#` if any of them is a bush.
pub fn draw_sketch(terrain: &Terrain, scenario: &Scenario) -> String {
    let cells_a_character = usize::from(terrain.frame.cols).div_ceil(WIDTH - INDENT.len());
    let side = |cells: u16| usize::from(cells).div_ceil(cells_a_character);
    let mut rows = vec![vec!['.'; side(terrain.frame.cols)]; side(terrain.frame.rows)];
    let mut mark = |cell: Cell, character| {
        rows[usize::from(cell.row) / cells_a_character][usize::from(cell.col) / cells_a_character] = character;
    };
    for &bush in &terrain.bushes {
        mark(bush, '#');
    }
    let trucks = scenario.unimog.iter().map(|truck| (truck.start.pose().position(), 'U'));
    let wumpuses = scenario.wumpus.iter().map(|wumpus| (DVec2::from(wumpus.start_m), 'W'));
    for (place, character) in trucks.chain(wumpuses) {
        if let Some(cell) = terrain.frame.cell_at(place) {
            mark(cell, character);
        }
    }
    let lines = rows.iter().rev().map(|row| format!("{INDENT}{}\n", row.iter().collect::<String>()));
    let scale = match cells_a_character {
        1 => String::new(),
        n => format!("{INDENT}A character stands for {n} x {n} cells.\n"),
    };
    lines.collect::<String>() + &scale
}

#[cfg(test)]
mod tests {
    use crate::scenario::{Field, GivenField, Scenario, Terrain, load};

    use super::draw_sketch;

    fn drawn(map: &str) -> String {
        let wumpus_alone = load("wumpus-alone", &["wumpus.start_m=[2.5, 2.5]".into()]).expect("this scenario is right");
        let given = GivenField::parse(map, 5.0).expect("this map is right");
        let scenario = Scenario { field: Field { given: Some(given), ..Field::default() }, ..wumpus_alone };
        draw_sketch(&Terrain::from_scenario(&scenario, 1).expect("a given field needs no drawing"), &scenario)
    }

    #[test]
    fn a_map_is_drawn_as_it_was_given() {
        assert_eq!(drawn("#..\n.##\n..."), "  #..\n  .##\n  W..\n");
    }

    #[test]
    fn a_wide_field_is_drawn_smaller_and_keeps_its_bushes() {
        let wide = format!("{}#\n{}\n", ".".repeat(99), ".".repeat(100));
        let text = drawn(&wide);
        assert_eq!(text.lines().next(), Some(format!("  W{}#", ".".repeat(48)).as_str()));
        assert!(text.contains("2 x 2 cells"));
    }
}
