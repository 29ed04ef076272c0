//! Values over the field that planners use: clearance, cost, cost to go. One is shown at a time.

use crate::canvas::Canvas;
use crate::colours::{ColourMap, FIELD};
use crate::film::field::{Layer, Pane};
use crate::film::{RunView, Selected};
use crate::values::ValueScale;
use wildfire_base::geometry::Cell;
use wildfire_grid::brushfire::brushfire;
use wildfire_grid::cost_map::{TwoZones, cost_map};
use wildfire_grid::distance::squared_vertex_distances;
use wildfire_grid::wavefront::{GOAL, wavefront};
use wildfire_grid::{Connectivity, CornerCutting, Grid};
use wildfire_timeline::Setting;

const OPACITY: f64 = 0.7;

/// Clearance is computed at this many points along a side, at least one a cell and at most [`MAX_STEPS`].
const POINTS: usize = 800;
const MAX_STEPS: usize = 16;

/// Which values are shown, and all that they follow from beside the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldQuantity {
    Clearance,
    CostMap,
    /// To a cell.
    Wavefront(Cell),
}

/// Values on a lattice.
pub struct ValueMap {
    pub quantity: FieldQuantity,
    pub scale: ValueScale,
    /// Not a number where there is no value.
    values: Grid<f64>,
    /// The side of a square with one value.
    side_m: f64,
    /// East and north of the field's corner, of the first square's corner.
    corner_m: f64,
}

impl FieldQuantity {
    /// Returns the last one in the order of the layers that is shown and known.
    pub fn shown(pane: &Pane) -> Option<Self> {
        if pane.shows(Layer::Wavefront)
            && let Some(goal) = truck(pane).and_then(|index| pane.view.state.agents[index].goal)
        {
            return Some(Self::Wavefront(goal));
        }
        if pane.shows(Layer::CostMap) {
            return Some(Self::CostMap);
        }
        pane.shows(Layer::Clearance).then_some(Self::Clearance)
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Clearance => "clearance, m",
            Self::CostMap => "cost map",
            Self::Wavefront(_) => "steps to goal",
        }
    }
}

/// The truck whose goal matters: the one that is followed, or selected, or the first.
fn truck(pane: &Pane) -> Option<usize> {
    let options = pane.view.options;
    let selected =
        options.selected.filter(|(run_index, _)| *run_index == pane.view.run_index).and_then(|(_, selected)| {
            match selected {
                Selected::Agent(agent) => Some(agent),
                Selected::Bush(_) => None,
            }
        });
    let agents = &pane.setting().agents;
    let preferred = [options.followed_agent(), selected].into_iter().flatten().find(|agent| agent.role.suppresses());
    let preferred = preferred.and_then(|agent| pane.setting().agent_index(agent));
    preferred.or_else(|| agents.iter().position(|agent| agent.id.role.suppresses()))
}

impl ValueMap {
    /// `None` if no place has a value.
    pub fn new(run: &RunView, quantity: FieldQuantity) -> Option<Self> {
        let setting = &run.timeline().setting;
        let cell_m = setting.frame.cell_m;
        let (values, side_m, corner_m) = match quantity {
            FieldQuantity::Clearance => {
                let (values, step_m) = clearances(setting);
                (values, step_m, -0.5 * step_m)
            }
            FieldQuantity::CostMap => (costs(setting), cell_m, 0.0),
            FieldQuantity::Wavefront(goal) => (steps_to(setting, goal)?, cell_m, 0.0),
        };
        let scale = ValueScale::from_values(values.values().iter().copied(), ColourMap::Viridis)?;
        Some(Self { quantity, scale: scale.on(FIELD, OPACITY), values, side_m, corner_m })
    }

    /// Gives every pixel of the field the colour of the value at its middle.
    pub fn draw(&self, canvas: &mut Canvas, pane: &Pane) {
        let (columns, rows) = pane.field_pixels();
        let middle = |x: u32, y: u32| pane.projection.world((f64::from(x) + 0.5, f64::from(y) + 0.5));
        let squares: Vec<usize> = columns.clone().map(|x| self.square(middle(x, 0).x, self.values.cols())).collect();
        for y in rows {
            let values = self.values.row(self.square(middle(0, y).y, self.values.rows()));
            let pixels = canvas.row_from(columns.start as usize, y as usize);
            for (&square, pixel) in squares.iter().zip(pixels).filter(|(square, _)| !values[**square].is_nan()) {
                let [red, green, blue] = self.scale.colour(values[square]);
                *pixel = [red, green, blue, 255];
            }
        }
    }

    /// The place of the square that holds a coordinate, or of the nearest of `count`.
    fn square(&self, at_m: f64, count: usize) -> usize {
        (((at_m - self.corner_m) / self.side_m) as usize).min(count - 1)
    }
}

fn occupied(setting: &Setting) -> Grid<bool> {
    let mut occupied = Grid::filled(setting.frame.rows.into(), setting.frame.cols.into(), false);
    for &bush in &setting.bushes {
        occupied.values_mut()[setting.frame.index(bush)] = true;
    }
    occupied
}

/// Exact metres to the nearest bush or the field's edge, at the vertices of a lattice; and its spacing.
fn clearances(setting: &Setting) -> (Grid<f64>, f64) {
    let frame = &setting.frame;
    // Samples are finer than cells on small fields, where a step between two values would be seen.
    let steps = (POINTS / usize::from(frame.cols.max(frame.rows))).clamp(1, MAX_STEPS);
    let step_m = frame.cell_m / steps as f64;
    let rows = usize::from(frame.rows) * steps + 1;
    let cols = usize::from(frame.cols) * steps + 1;
    let mut values = Grid::filled(rows, cols, f64::INFINITY);
    squared_vertex_distances(&occupied(setting), steps, |row, squares| {
        for (value, &square) in values.row_mut(row).iter_mut().zip(squares) {
            *value = f64::from(square).sqrt() * step_m;
        }
    });
    for row in 0..rows {
        for (col, value) in values.row_mut(row).iter_mut().enumerate() {
            // The edge of the field blocks bodies as a bush does.
            let from_edge = row.min(rows - 1 - row).min(col).min(cols - 1 - col);
            *value = value.min(from_edge as f64 * step_m);
        }
    }
    (values, step_m)
}

/// Computes the costs of the two zones' default, without any in bushes; 0 everywhere on a field without bushes.
fn costs(setting: &Setting) -> Grid<f64> {
    let occupied = occupied(setting);
    let distances = brushfire(&occupied, Connectivity::Four);
    let distances = distances.unwrap_or_else(|| Grid::filled(occupied.rows(), occupied.cols(), 0));
    let mut costs = cost_map(&distances, &TwoZones::default());
    for (cost, _) in costs.values_mut().iter_mut().zip(occupied.values()).filter(|(_, occupied)| **occupied) {
        *cost = f64::NAN;
    }
    costs
}

/// Fewest steps between cell centres, diagonal ones too but around corners; the goal itself is a bush, which counts as
/// free.
fn steps_to(setting: &Setting, goal: Cell) -> Option<Grid<f64>> {
    let mut occupied = occupied(setting);
    let place = (usize::from(goal.row), usize::from(goal.col));
    occupied[place] = false;
    let wave = wavefront(&occupied, place, Connectivity::Eight, CornerCutting::Forbidden).ok()?;
    let steps = wave.values().iter().map(|&value| value.checked_sub(GOAL).map_or(f64::NAN, f64::from));
    Some(Grid::from_values(wave.rows(), wave.cols(), steps.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::{DVec2, FieldFrame};

    fn setting() -> Setting {
        let frame = FieldFrame { cols: 12, rows: 9, cell_m: 4.0 };
        let bushes = [(3, 2), (4, 2), (9, 5), (0, 8)].map(Cell::from).to_vec();
        Setting { frame, bushes, ..crate::film::field::tests::setting() }
    }

    #[test]
    fn clearances_are_distances_to_bushes_and_border() {
        let setting = setting();
        let (values, step_m) = clearances(&setting);
        let half = DVec2::splat(0.5 * setting.frame.cell_m);
        let gap = |point: DVec2, bush: &Cell| ((point - setting.frame.centre(*bush)).abs() - half).max(DVec2::ZERO);
        for row in 0..values.rows() {
            for col in 0..values.cols() {
                let point = DVec2::new(col as f64, row as f64) * step_m;
                let to_bushes = setting.bushes.iter().map(|bush| gap(point, bush).length());
                let expected = to_bushes.fold(setting.frame.border_distance(point), f64::min);
                assert!((values[(row, col)] - expected).abs() < 1e-9, "{point}");
            }
        }
    }

    #[test]
    fn the_goal_is_no_step_away_and_bushes_have_no_steps() {
        let setting = setting();
        let steps = steps_to(&setting, Cell { col: 3, row: 2 }).expect("the goal is on the field");
        assert_eq!(steps[(2, 3)], 0.0);
        assert_eq!([steps[(2, 2)], steps[(3, 2)], steps[(1, 4)]], [1.0, 1.0, 2.0], "no step cuts a corner");
        assert!(steps[(2, 4)].is_nan() && steps[(5, 9)].is_nan());
    }
}
