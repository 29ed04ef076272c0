//! Distances from points to bushes and border.

use glam::DVec2;

use super::sweep;
use wildfire_base::geometry::FieldFrame;
use wildfire_grid::Grid;
use wildfire_grid::distance::{MAX_STEPS, squared_vertex_distances};

/// Vertices of a fine lattice are no farther apart than this, in metres.
const SPACING_M: f64 = 0.5;

/// The most vertices of a fine lattice (4 bytes each); a field that would need more has a coarse one.
const MAX_VERTICES: usize = 1 << 23;

/// Stored where there is no bush at all: farther than any field is wide, and its square is still exact enough.
const NO_BUSH_M: f32 = 1e9;

/// Taken off a distance before it is stored, as a share of it: more than single precision can add by rounding the
/// integer (which the root halves), the root, the spacing and two products, each by at most 2^-24.
const ROUNDED_DOWN: f64 = 1.0 / (1 << 20) as f64;

/// No less than what a stored distance can lack, as a share of it.
const LACKING: f64 = 2.0 * ROUNDED_DOWN;

/// The room that [`ClearanceField::line_is_free`] may demand beyond the radius, in metres.
const LINE_SLACK_M: f64 = 0.02;

/// A lower bound of the distance from any point to the nearest bush or to the field's border.
///
/// Exact distances to the closed squares of the bushes are stored at the vertices of a lattice that divides every cell
/// side into equal steps of at most 0.5 m, as single-precision numbers rounded down. The border needs no table.
///
/// A field on which these would be more than some eight million, such as one of 5 km, has a coarse lattice instead: the
/// corners of cells. There the nine cells about a point are looked at as well. A bush among them has its exact distance,
/// and all others are farther away than the nearest edge of the nine: so close to bushes, where bodies pass, the bound
/// is better than that of a fine lattice, and it takes neither memory nor time in advance.
///
/// # Why the bound holds
/// Let `p` lie in a lattice square of side `h`, at the fractions `t` and `u` of its sides, and let `w_v` be the
/// bilinear weights of its vertices `v`. The weights reproduce the point: `sum w_v v = p`. Let `s` be the point of a
/// bush nearest to `p`. Every vertex has `d(v) <= |v - s|`, and by Jensen's inequality
/// ```text
/// B = sum w_v d(v) <= sum w_v |v - s| <= sqrt(sum w_v |v - s|^2) = sqrt(|p - s|^2 + V),
/// V = sum w_v |v - p|^2 = h^2 (t (1 - t) + u (1 - u)) <= h^2 / 2,
/// ```
/// so `d(p) >= sqrt(B^2 - V)`. At 2 m from a bush and `h` = 0.5 m this gives away 3 cm at most on open ground (more
/// on ridges between bushes, where interpolation falls short). Since `d` changes by no more than the way,
/// `B >= d(p) - sum w_v |v - p| >= d(p) - sqrt(V)`, which bounds it from above: `d(p) <= B + sqrt(V)`.
#[derive(Debug)]
pub struct ClearanceField {
    frame: FieldFrame,
    occupied: Grid<bool>,
    lattice: Grid<f32>,
    /// Column and row of the last square of the lattice.
    last_cell: (u32, u32),
    spacing_m: f64,
    steps_per_m: f64,
    /// True if the lattice is coarse, so that cells about a point are looked at.
    looks_at_cells: bool,
}

/// Knowledge of the distance from a point to the nearest bush: `B` and `V` of [`ClearanceField`], and what the cells
/// about the point say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interpolated {
    distance_m: f64,
    spread_m2: f64,
    /// Another lower bound of the squared distance.
    min_m2: f64,
}

impl Interpolated {
    /// A lower bound of the squared distance; it may be negative.
    #[inline]
    pub fn min_squared(self) -> f64 {
        let by_lattice = self.distance_m * self.distance_m - self.spread_m2;
        if by_lattice > self.min_m2 { by_lattice } else { self.min_m2 }
    }

    /// Metres by interpolation, from which the distance differs by no more than [`ClearanceField::max_spread_m`].
    pub fn distance_m(self) -> f64 {
        self.distance_m
    }

    /// An upper bound of the distance.
    pub fn max(self) -> f64 {
        self.distance_m * (1.0 + LACKING) + self.spread_m2.sqrt()
    }

    /// Returns whether the true distance is certainly less than `limit` metres: whether [`Interpolated::max`] is,
    /// without its root.
    #[inline]
    pub fn is_surely_below(self, limit: f64) -> bool {
        let missing = limit - self.distance_m * (1.0 + LACKING);
        missing > 0.0 && missing * missing > self.spread_m2
    }
}

impl ClearanceField {
    /// `occupied` has a value per cell, row 0 at the south edge.
    ///
    /// # Panics
    /// If `occupied` has another size than the frame.
    pub fn new(frame: FieldFrame, occupied: &Grid<bool>) -> Self {
        let size = (usize::from(frame.rows), usize::from(frame.cols));
        assert_eq!((occupied.rows(), occupied.cols()), size, "a value per cell");
        let factor = steps_per_cell(&frame);
        let spacing_m = frame.cell_m / factor as f64;
        let rows = usize::from(frame.rows) * factor + 1;
        let cols = usize::from(frame.cols) * factor + 1;
        let mut lattice = Grid::filled(rows, cols, NO_BUSH_M);
        let scale = (spacing_m * (1.0 - ROUNDED_DOWN)) as f32;
        squared_vertex_distances(occupied, factor, |row, squares| {
            for (metres, &square) in lattice.row_mut(row).iter_mut().zip(squares) {
                *metres = (square as f32).sqrt() * scale;
            }
        });
        let steps_per_m = 1.0 / spacing_m;
        let looks_at_cells = spacing_m > SPACING_M;
        // Two columns and two rows at least, as a field has a cell.
        let last_cell = (cols as u32 - 2, rows as u32 - 2);
        Self { frame, occupied: occupied.clone(), lattice, last_cell, spacing_m, steps_per_m, looks_at_cells }
    }

    /// Returns the bytes that it takes on a field, and those needed additionally while it is computed.
    pub fn bytes(frame: &FieldFrame) -> [u64; 2] {
        let steps = steps_per_cell(frame) as u64;
        let vertices = (u64::from(frame.cols) * steps + 1) * (u64::from(frame.rows) * steps + 1);
        let cells = frame.cell_count() as u64;
        [vertices * size_of::<f32>() as u64 + cells, cells * size_of::<i32>() as u64]
    }

    /// Returns the size of the field and of its cells.
    pub fn frame(&self) -> &FieldFrame {
        &self.frame
    }

    /// Returns which cells hold a bush, row 0 at the south edge.
    pub fn occupied(&self) -> &Grid<bool> {
        &self.occupied
    }

    /// Returns a lower bound of the distance in metres to the nearest bush or border; zero or less inside a bush or
    /// outside.
    #[inline]
    pub fn lower_bound(&self, point: DVec2) -> f64 {
        let border = self.frame.border_distance(point);
        if border > 0.0 { self.interpolate(point).min_squared().max(0.0).sqrt().min(border) } else { border }
    }

    /// Returns the exact distance in metres to the nearest bush or border; zero or less inside a bush or outside.
    pub fn distance(&self, point: DVec2) -> f64 {
        let border = self.frame.border_distance(point);
        if border <= 0.0 {
            return border;
        }
        // Beyond rounding, so that the box about a point on a bush's edge meets the bush from every side.
        let reach = (self.interpolate(point).max() + LACKING * self.spacing_m).min(border);
        let half = DVec2::splat(0.5 * self.frame.cell_m);
        let squared_gap = |centre: DVec2| ((point - centre).abs() - half).max(DVec2::ZERO).length_squared();
        let nearest = self.bushes_near(point, DVec2::splat(reach)).map(squared_gap).fold(f64::INFINITY, f64::min);
        nearest.sqrt().min(border)
    }

    /// Returns whether a disc of this radius fits everywhere on the straight line between two points.
    ///
    /// A yes holds for every point of the line. A line that keeps less than 2 cm more than the radius may be refused.
    pub fn line_is_free(&self, from: DVec2, to: DVec2, radius: f64) -> bool {
        let along = to - from;
        let length = along.length();
        let direction = if length > 0.0 { along / length } else { DVec2::ZERO };
        let needed = radius.max(0.0) + LINE_SLACK_M;
        sweep::holds_everywhere(length, 1.0, LINE_SLACK_M, |travelled: f64, _| {
            let point = from + direction * travelled;
            let bound = self.lower_bound(point);
            // On ridges between bushes the lattice falls short, and a line along one would be refused for no reason.
            let distance = if bound < needed { self.distance(point) } else { bound };
            (distance >= needed).then_some(distance - needed)
        })
    }

    /// Reads the lattice at a point of the field; beyond it, at the nearest lattice square. Of a coarse lattice it looks at
    /// the cells about the point too.
    // A pose is a handful of these and little else: as calls they took a third longer.
    #[inline(always)]
    pub(super) fn interpolate(&self, point: DVec2) -> Interpolated {
        let interpolated = self.read_lattice(point);
        if self.looks_at_cells { self.look_at_cells(point, interpolated) } else { interpolated }
    }

    /// Returns whether the cells about a point say more than the lattice.
    pub(super) fn is_coarse(&self) -> bool {
        self.looks_at_cells
    }

    /// Returns by how many metres the distance from a point near a bush may exceed the interpolated one.
    pub(super) fn max_spread_m(&self) -> f64 {
        // V is at most half the square of the spacing; what stored distances lack is far less than the rest.
        0.75 * self.spacing_m
    }

    /// Makes what the lattice says of a point better by the cell that holds it and the eight round it; of a point outside,
    /// by what is nearest inside.
    #[inline(never)]
    fn look_at_cells(&self, point: DVec2, by_lattice: Interpolated) -> Interpolated {
        let rows = self.occupied.rows();
        let cols = self.occupied.cols();
        let cell_m = self.frame.cell_m;
        let col = ((point.x / cell_m) as usize).min(cols - 1);
        let row = ((point.y / cell_m) as usize).min(rows - 1);
        let west = point.x - col as f64 * cell_m;
        let south = point.y - row as f64 * cell_m;
        // A point that is outside, or so by rounding, has no distances to the sides of its cell: the lattice will do.
        if west.min(south) < 0.0 || west.max(south) > cell_m {
            return by_lattice;
        }
        // Metres to the columns and rows before, of and after the cell.
        let across = [west, 0.0, cell_m - west];
        let along = [south, 0.0, cell_m - south];
        let beyond = cell_m + across[0].min(across[2]).min(along[0]).min(along[2]);
        let mut min_m2 = beyond * beyond;
        let mut is_exact = false;
        for (step, gap_y) in along.into_iter().enumerate() {
            let Some(line) = (row + step).checked_sub(1).filter(|&row| row < rows).map(|row| self.occupied.row(row))
            else {
                continue;
            };
            for (step, gap_x) in across.into_iter().enumerate() {
                let squared = gap_x * gap_x + gap_y * gap_y;
                if squared < min_m2 && (col + step).checked_sub(1).and_then(|col| line.get(col)) == Some(&true) {
                    (min_m2, is_exact) = (squared, true);
                }
            }
        }
        // Rounded down, as callers rely on it as a lower bound.
        let distance_m = min_m2.sqrt() * (1.0 - ROUNDED_DOWN);
        let min_m2 = distance_m * distance_m;
        if is_exact {
            Interpolated { distance_m, spread_m2: 0.0, min_m2 }
        } else {
            Interpolated { min_m2, ..by_lattice }
        }
    }

    #[inline(always)]
    pub(super) fn read_lattice(&self, point: DVec2) -> Interpolated {
        let x = point.x * self.steps_per_m;
        let y = point.y * self.steps_per_m;
        // A point on the last line belongs to the last cell. Numbers of 32 bits are converted in half the instructions.
        let col = (x as u32).min(self.last_cell.0);
        let row = (y as u32).min(self.last_cell.1);
        let t = x - f64::from(col);
        let u = y - f64::from(row);
        let first = row as usize * self.lattice.cols() + col as usize;
        let values = self.lattice.values();
        let south = &values[first..first + 2];
        let north = &values[first + self.lattice.cols()..first + self.lattice.cols() + 2];
        let mix = |pair: &[f32]| f64::from(pair[0]) + t * (f64::from(pair[1]) - f64::from(pair[0]));
        let (low, high) = (mix(south), mix(north));
        Interpolated {
            distance_m: low + u * (high - low),
            spread_m2: self.spacing_m * self.spacing_m * (t * (1.0 - t) + u * (1.0 - u)),
            min_m2: f64::NEG_INFINITY,
        }
    }

    /// Centres of the bushes whose squares meet the box of half extents `reach` about `point`.
    pub(super) fn bushes_near(&self, point: DVec2, reach: DVec2) -> impl Iterator<Item = DVec2> + '_ {
        let cell = self.frame.cell_m;
        let low = (point - reach) / cell;
        let high = (point + reach) / cell;
        // Casts clamp at 0; the last index is clamped here.
        let beyond = [high.x, high.y].map(|high| (high as u32).saturating_add(1) as usize);
        let cols = low.x as u32 as usize..beyond[0].min(self.occupied.cols());
        let rows = low.y as u32 as usize..beyond[1].min(self.occupied.rows());
        rows.flat_map(move |row| {
            let line = self.occupied.row(row);
            let y = (row as f64 + 0.5) * cell;
            cols.clone().filter(|&col| line[col]).map(move |col| DVec2::new((col as f64 + 0.5) * cell, y))
        })
    }
}

/// Lattice steps per cell side: at most [`SPACING_M`] each, or one where that would be too many.
fn steps_per_cell(frame: &FieldFrame) -> usize {
    let wanted = (frame.cell_m / SPACING_M).ceil().max(1.0);
    let vertices = wanted * wanted * frame.cell_count() as f64;
    let longest = wanted * f64::from(frame.cols.max(frame.rows));
    if vertices <= MAX_VERTICES as f64 && longest <= MAX_STEPS as f64 { wanted as usize } else { 1 }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::brute_force::RandomBushes;
    use super::*;
    use wildfire_base::rng;

    #[test]
    fn the_bound_never_exceeds_the_distance_and_is_tight() {
        let mut rng = rng::stream(1, "collision/field");
        let mut greatest_loss = 0.0f64;
        for round in 0..50 {
            let test = RandomBushes::random(&mut rng, [5.0, 1.3, 0.4][round % 3], [0.0, 0.02, 0.1, 0.4][round % 4]);
            for _ in 0..2000 {
                let point = test.random_point(&mut rng);
                let bound = test.field.lower_bound(point);
                let distance = test.point_distance(point);
                assert!(bound <= distance, "{point}: bound {bound}, distance {distance}");
                assert!((test.field.distance(point) - distance).abs() < 1e-9, "{point}");
                assert!(test.field.interpolate(point).max().min(bound.max(distance)) >= distance - 1e-9);
                greatest_loss = greatest_loss.max(distance - bound);
            }
        }
        assert!(greatest_loss < 0.36, "the bound gives away {greatest_loss} m");
    }

    #[test]
    fn inside_bushes_and_outside_the_field_nothing_is_free() {
        let mut rng = rng::stream(2, "collision/field");
        let test = RandomBushes::random(&mut rng, 5.0, 0.3);
        let frame = *test.field.frame();
        for _ in 0..1000 {
            let beyond = DVec2::new(rng.random_range(0.0..30.0), rng.random_range(-30.0..30.0));
            for point in [-beyond, DVec2::new(frame.width_m(), 0.0) + beyond] {
                assert!(test.field.lower_bound(point) <= 0.0 && test.field.distance(point) <= 0.0);
            }
        }
        for bush in &test.bushes {
            let centre = 0.5 * (bush[0] + bush[2]);
            assert!(bush.iter().all(|&corner| test.field.lower_bound(corner.lerp(centre, 1e-3)) <= 0.0));
        }
    }

    #[test]
    fn on_the_edge_of_a_bush_nothing_is_free() {
        let frame = FieldFrame { cols: 9, rows: 9, cell_m: 5.0 };
        let mut occupied = Grid::filled(9, 9, false);
        occupied[(4, 4)] = true;
        let field = ClearanceField::new(frame, &occupied);
        for step in 0..=20 {
            let along = 20.0 + 0.25 * f64::from(step);
            for point in [(20.0, along), (25.0, along), (along, 20.0), (along, 25.0)].map(DVec2::from) {
                assert_eq!(field.distance(point), 0.0, "{point}");
                assert!(!field.line_is_free(point, point, 1.0), "{point}");
            }
        }
    }

    #[test]
    fn free_lines_are_free_everywhere_and_roomy_ones_are_found_free() {
        let mut rng = rng::stream(3, "collision/field");
        let (mut free, mut refused) = (0, 0);
        for _ in 0..40 {
            let test = RandomBushes::random(&mut rng, 5.0, 0.08);
            for _ in 0..100 {
                let from = test.random_point(&mut rng);
                let to = test.random_point(&mut rng);
                let radius = rng.random_range(0.0..4.0);
                let steps = ((to - from).length() / 0.02).ceil();
                let places = (0..=steps as u32).map(|k| from.lerp(to, f64::from(k) / steps));
                let min = places.map(|place| test.field.distance(place)).fold(f64::INFINITY, f64::min);
                let answer = test.field.line_is_free(from, to, radius);
                assert!(!answer || min >= radius, "{from} to {to}: {min} m, wanted {radius}");
                assert!(answer || min <= radius + LINE_SLACK_M + 0.01, "{from} to {to}: {min} m, wanted {radius}");
                if answer { free += 1 } else { refused += 1 }
            }
        }
        assert!(free > 300 && refused > 300, "{free} free, {refused} refused");
    }

    #[test]
    fn huge_fields_have_a_coarse_lattice_and_stay_sound() {
        let frame = FieldFrame { cols: 1000, rows: 1000, cell_m: 100.0 };
        let mut occupied = Grid::filled(1000, 1000, false);
        occupied[(500, 500)] = true;
        let field = ClearanceField::new(frame, &occupied);
        assert_eq!(field.lattice.values().len(), 1001 * 1001);
        let point = DVec2::new(50_000.0 - 37.0, 50_050.0);
        assert!(field.lower_bound(point) <= 37.0);
        assert!((field.distance(point) - 37.0).abs() < 1e-9);
    }

    #[test]
    fn on_a_coarse_lattice_what_is_within_a_cell_is_exact_and_all_else_is_sound() {
        let mut rng = rng::stream(4, "collision/field");
        let (mut near, mut far) = (0, 0);
        for round in 0..60 {
            // Cells so large that the wanted vertices are too many for a few of them.
            let cell_m = [4000.0, 1700.0][round % 2];
            let test = RandomBushes::random(&mut rng, cell_m, [0.0, 0.02, 0.1, 0.4][round % 4]);
            assert!(test.field.looks_at_cells);
            let frame = *test.field.frame();
            for sample in 0..1000 {
                // Edges and corners of cells too.
                let point = if sample % 10 == 0 {
                    let corner =
                        |cells: u16, rng: &mut rng::Xoshiro256PlusPlus| f64::from(rng.random_range(0..=cells)) * cell_m;
                    let x = corner(frame.cols, &mut rng);
                    let y = corner(frame.rows, &mut rng);
                    DVec2::new(x, if sample % 20 == 0 { y } else { test.random_point(&mut rng).y })
                } else {
                    test.random_point(&mut rng)
                };
                let distance = test.point_distance(point);
                let bound = test.field.lower_bound(point);
                assert!(bound <= distance + 1e-9, "{point}: bound {bound}, distance {distance}");
                let border = frame.border_distance(point);
                if border > 0.0 {
                    let interpolated = test.field.interpolate(point);
                    assert!(interpolated.max().min(border) >= distance - 1e-9, "{point}: {interpolated:?}, {distance}");
                    assert!(
                        !interpolated.is_surely_below(distance) || distance >= border,
                        "{point}: {interpolated:?}, {distance}"
                    );
                    assert!((test.field.distance(point) - distance).abs() < 1e-6, "{point}");
                }
                if distance < cell_m {
                    assert!(bound >= distance * (1.0 - 1e-5), "{point}: bound {bound}, distance {distance}");
                    near += 1;
                } else {
                    far += 1;
                }
            }
        }
        assert!(near > 1000 && far > 1000, "{near} near, {far} far");
    }
}
