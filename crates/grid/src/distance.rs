//! Exact squared Euclidean distances on integers, in two passes.
//!
//! The first pass finds vertical distances column by column; the second takes, row by row, the lower envelope of the
//! parabolas that stand on them (Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions", Theory of
//! Computing 8, 2012, section 2.1). Time is linear in the size of the result, whatever the map.
//!
//! Unit: steps of the lattice that is asked for. Squares are `i32`, so no side may be longer than [`MAX_STEPS`].

use std::ops::Range;

use super::Grid;

/// The longest side in lattice steps: two squares of it add up within an `i32`.
pub const MAX_STEPS: usize = 32_000;

/// The longest side of a map of cells: squares of two offsets within it add up within an `i32`.
pub const MAX_CELLS_A_SIDE: usize = 32_767;

/// Farther than any vertical distance, as far as an `i32` can hold its square.
const FAR: i32 = 46_340;

/// Computes the squared distance from each cell's centre to the centre of the nearest occupied cell, in cells; `None`
/// if no cell is occupied.
///
/// # Panics
/// If a side is longer than [`MAX_CELLS_A_SIDE`].
pub fn squared_distances(occupied: &Grid<bool>) -> Option<Grid<i32>> {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    assert!(rows.max(cols) <= MAX_CELLS_A_SIDE, "a side of {} cells is too long", rows.max(cols));
    if !occupied.values().contains(&true) {
        return None;
    }
    // Down and up again: the nearest occupied cell of a column lies above or below.
    let mut vertical = Grid::filled(rows, cols, FAR);
    for row in 0..rows {
        step_from_neighbour(&mut vertical, occupied, row, row.checked_sub(1));
    }
    for row in (0..rows).rev() {
        step_from_neighbour(&mut vertical, occupied, row, (row + 1 < rows).then_some(row + 1));
    }
    let mut squares = Grid::filled(rows, cols, i32::MAX);
    let mut envelope = Envelope::default();
    for row in 0..rows {
        envelope.lower(vertical.row(row), 1, squares.row_mut(row));
    }
    Some(squares)
}

/// Computes the Euclidean distance from each cell's centre to the centre of the nearest occupied cell, in cells; `None`
/// if no cell is occupied.
///
/// # Panics
/// As [`squared_distances`].
pub fn euclidean_distances(occupied: &Grid<bool>) -> Option<Grid<f64>> {
    let squares = squared_distances(occupied)?;
    let roots = squares.values().iter().map(|&square| f64::from(square).sqrt()).collect();
    Some(Grid::from_values(squares.rows(), squares.cols(), roots))
}

/// Finds the occupied cell nearest to each cell by the Euclidean distance of centres, as `row * cols + col`; `None` if
/// no cell is occupied.
///
/// Of several, the one in the last column, and there the one in the first row.
///
/// # Panics
/// If a side is longer than 46,339 cells or the map has more cells than 32 bits can number.
pub fn nearest_occupied(occupied: &Grid<bool>) -> Option<Grid<u32>> {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    assert!(rows.max(cols) < FAR as usize && u32::try_from(rows * cols).is_ok(), "{rows} x {cols} cells are too many");
    if !occupied.values().contains(&true) {
        return None;
    }
    // By column, the row of the nearest occupied cell: first the last one above, then the next one below where it is nearer.
    let mut nearest = Grid::filled(rows, cols, None::<usize>);
    // Along rows, although columns are meant: memory is read in the order in which it lies.
    for row in 0..rows {
        for col in 0..cols {
            let above = row.checked_sub(1).and_then(|above| nearest[(above, col)]);
            nearest[(row, col)] = if occupied[(row, col)] { Some(row) } else { above };
        }
    }
    for row in (0..rows.saturating_sub(1)).rev() {
        for col in 0..cols {
            // The nearest of the cell below may lie above, where the first pass has found it for this row too.
            let below = nearest[(row + 1, col)].filter(|&below| below > row);
            if let Some(below) =
                below.filter(|below| nearest[(row, col)].is_none_or(|above| below - row < row.abs_diff(above)))
            {
                nearest[(row, col)] = Some(below);
            }
        }
    }
    let mut cells = Grid::filled(rows, cols, 0);
    let mut envelope = Envelope::default();
    for row in 0..rows {
        let heights: Vec<i32> = nearest
            .row(row)
            .iter()
            .map(|occupied_row| occupied_row.map_or(FAR, |occupied_row| occupied_row.abs_diff(row) as i32))
            .collect();
        // The lower envelope of the columns' arcs gives the nearest of all of them.
        envelope.stand_on(&heights, 1, cols as i64);
        for (site, reach) in envelope.reaches(cols as i64) {
            let site_row = nearest[(row, site as usize)].expect("arcs stand on columns with an occupied cell");
            // The conversions lose nothing: the map was checked to have no more cells than 32 bits can number.
            cells.row_mut(row)[reach].fill((site_row * cols) as u32 + site as u32);
        }
    }
    Some(cells)
}

/// One row of a vertical sweep: an occupied cell is at distance 0, any other one step farther than its neighbour.
fn step_from_neighbour(vertical: &mut Grid<i32>, occupied: &Grid<bool>, row: usize, neighbour: Option<usize>) {
    for col in 0..occupied.cols() {
        // It never exceeds FAR, whose square is the greatest that an i32 can hold.
        let through = neighbour.map_or(FAR, |neighbour| (vertical[(neighbour, col)] + 1).min(FAR));
        let here = if occupied[(row, col)] { 0 } else { vertical[(row, col)] };
        vertical[(row, col)] = here.min(through);
    }
}

/// Computes squared distances from lattice vertices to the nearest occupied cell, as a closed square, row by row.
///
/// The lattice divides each cell side into `factor` steps, so a map of `rows` by `cols` cells has
/// `rows * factor + 1` by `cols * factor + 1` vertices, corners and edges of cells among them. `take` receives each
/// row of vertices, in order, with squared distances in steps; it is not called if no cell is occupied.
///
/// Cells are large against the lattice, so only the vertical distances by cell column are kept, and the parabolas
/// stand on cell corners alone: a square is nearest at a corner or edge, never at a vertex between, unless the vertex
/// lies in the square's own column, where the vertical distance is the answer.
///
/// # Panics
/// If a side is longer than [`MAX_STEPS`] steps, or `factor` is 0.
pub fn squared_vertex_distances(occupied: &Grid<bool>, factor: usize, mut take: impl FnMut(usize, &[i32])) {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    let side = rows.max(cols) * factor;
    assert!(factor > 0 && side <= MAX_STEPS, "a lattice of {side} steps a side is not supported");
    if !occupied.values().contains(&true) {
        return;
    }
    let above = edges_above(occupied, factor as i32);
    // The lower edge of the last occupied cell above, in steps; none was passed yet.
    let mut below = vec![-FAR; cols];
    let mut columns = vec![FAR; cols];
    let mut corners = vec![FAR; cols + 1];
    let mut squares = vec![0; cols * factor + 1];
    let mut envelope = Envelope::default();
    for row in 0..rows {
        // Cells share their edges, so only the lowest row adds the vertices of its lower edge.
        let rows_of_cell = if row + 1 == rows { factor + 1 } else { factor };
        for step in 0..rows_of_cell {
            let vertex_row = row * factor + step;
            let y = vertex_row as i32;
            // Inside an occupied cell nothing is nearer, whatever lies above and below it.
            for (col, column) in columns.iter_mut().enumerate() {
                let gap = (y - below[col]).min(above[(row, col)] - y).min(FAR);
                *column = if occupied[(row, col)] { 0 } else { gap };
            }
            spread_to_corners(&columns, &mut corners);
            fill_columns(&columns, factor, &mut squares);
            envelope.lower(&corners, factor, &mut squares);
            take(vertex_row, &squares);
        }
        // Only now: in the rows above, the cell itself is at distance 0 and hides its lower edge.
        for (col, edge) in below.iter_mut().enumerate() {
            if occupied[(row, col)] {
                *edge = ((row + 1) * factor) as i32;
            }
        }
    }
}

/// Computes for each cell the lattice row of the lower edge of the nearest occupied cell above it; far away if there is
/// none.
fn edges_above(occupied: &Grid<bool>, factor: i32) -> Grid<i32> {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    // Twice as far, so that the gap is no less than FAR from the last row of vertices either.
    let mut edges = Grid::filled(rows, cols, 2 * FAR);
    for row in (1..rows).rev() {
        for col in 0..cols {
            edges[(row - 1, col)] = if occupied[(row, col)] { row as i32 * factor } else { edges[(row, col)] };
        }
    }
    edges
}

/// A corner between two cell columns has the smaller of their vertical distances.
fn spread_to_corners(columns: &[i32], corners: &mut [i32]) {
    let last = columns.len();
    corners[0] = columns[0];
    corners[last] = columns[last - 1];
    for (corner, pair) in corners[1..last].iter_mut().zip(columns.windows(2)) {
        *corner = pair[0].min(pair[1]);
    }
}

/// Every vertex starts with the vertical distance of its own column.
fn fill_columns(columns: &[i32], factor: usize, squares: &mut [i32]) {
    for (vertices, &column) in squares.chunks_mut(factor).zip(columns) {
        vertices.fill(column * column);
    }
    // The last vertex begins no column; only arcs on corners reach it.
    squares[columns.len() * factor] = FAR * FAR;
}

/// Lower envelope of parabolas of one shape, with the memory that it reuses from row to row.
#[derive(Default)]
struct Envelope {
    arcs: Vec<Parabola>,
}

/// The parabola on a site, and the first vertex at which it is the lowest.
#[derive(Clone, Copy)]
struct Parabola {
    site: i64,
    square: i64,
    from: i64,
}

impl Envelope {
    /// Lowers each of `squares` to the least `(vertex - site)^2 + height^2`, where site `k` stands at vertex
    /// `k * spacing` with `heights[k]`; a height of [`FAR`] is no site.
    fn lower(&mut self, heights: &[i32], spacing: usize, squares: &mut [i32]) {
        let end = squares.len() as i64;
        self.stand_on(heights, spacing, end);
        for (index, arc) in self.arcs.iter().enumerate() {
            let until = self.arcs.get(index + 1).map_or(end, |next| next.from);
            let site = arc.site as i32;
            let square = arc.square as i32;
            let first = arc.from as i32 - site;
            // Lowered and not set: a vertex inside a column may have a nearer cell straight above or below it.
            for (offset, value) in (first..).zip(&mut squares[arc.from as usize..until as usize]) {
                *value = (*value).min(offset * offset + square);
            }
        }
    }

    /// The sites of the arcs, each with the vertices at which it is the lowest.
    fn reaches(&self, end: i64) -> impl Iterator<Item = (i64, Range<usize>)> + '_ {
        let until = self.arcs.iter().skip(1).map(|arc| arc.from).chain([end]);
        self.arcs.iter().zip(until).map(|(arc, until)| (arc.site, arc.from as usize..until as usize))
    }

    /// Makes the arcs over the vertices up to `end`.
    fn stand_on(&mut self, heights: &[i32], spacing: usize, end: i64) {
        self.arcs.clear();
        for (index, &height) in heights.iter().enumerate().filter(|(_, height)| **height < FAR) {
            let site = (index * spacing) as i64;
            // In 64 bits: the square of a site and that of a height exceed an i32 together.
            let square = i64::from(height) * i64::from(height);
            // Two parabolas of one shape cross once, so the new one is the lower from some vertex on. Where that is not
            // beyond the beginning of the last arc, it hides all of that arc, which goes for good.
            let from = loop {
                let Some(top) = self.arcs.last() else { break 0 };
                let numerator = (site * site + square) - (top.site * top.site + top.square);
                let denominator = 2 * (site - top.site);
                if numerator > top.from * denominator {
                    break (numerator as u64).div_ceil(denominator as u64) as i64;
                }
                self.arcs.pop();
            };
            // An arc that is the lowest beyond the last vertex only would have no vertices.
            if from < end {
                self.arcs.push(Parabola { site, square, from });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::{Rng, RngExt};

    use super::*;
    use wildfire_base::rng;

    fn random_map(rng: &mut impl Rng) -> Grid<bool> {
        let rows = rng.random_range(1..18);
        let cols = rng.random_range(1..18);
        let density = [0.01, 0.1, 0.5, 0.95][rng.random_range(0..4)];
        Grid::from_values(rows, cols, (0..rows * cols).map(|_| rng.random_bool(density)).collect())
    }

    fn occupied_cells(map: &Grid<bool>) -> Vec<(i32, i32)> {
        let cells = (0..map.rows()).flat_map(|row| (0..map.cols()).map(move |col| (row, col)));
        cells.filter(|&cell| map[cell]).map(|(row, col)| (row as i32, col as i32)).collect()
    }

    #[test]
    fn squared_distances_equal_brute_force() {
        let mut rng = rng::stream(1, "grid/distance");
        for _ in 0..300 {
            let map = random_map(&mut rng);
            let cells = occupied_cells(&map);
            let Some(squares) = squared_distances(&map) else {
                assert!(cells.is_empty());
                continue;
            };
            for row in 0..map.rows() {
                for col in 0..map.cols() {
                    let square = |&(r, c): &(i32, i32)| (r - row as i32).pow(2) + (c - col as i32).pow(2);
                    assert_eq!(Some(squares[(row, col)]), cells.iter().map(square).min(), "at {row}, {col}");
                }
            }
        }
    }

    #[test]
    fn nearest_occupied_cells_are_as_near_as_the_distance_says() {
        let mut rng = rng::stream(4, "grid/distance");
        for _ in 0..300 {
            let map = random_map(&mut rng);
            let nearest = nearest_occupied(&map);
            let squares = squared_distances(&map);
            assert_eq!(nearest.is_some(), squares.is_some());
            let Some((nearest, squares)) = nearest.zip(squares) else { continue };
            for (index, &square) in squares.values().iter().enumerate() {
                let found = nearest.values()[index] as usize;
                let row = index / map.cols();
                let col = index % map.cols();
                let found_row = found / map.cols();
                let found_col = found % map.cols();
                assert!(map[(found_row, found_col)]);
                assert_eq!(row.abs_diff(found_row).pow(2) + col.abs_diff(found_col).pow(2), square as usize);
                let cell = (row as i32, col as i32);
                let as_near = occupied_cells(&map)
                    .into_iter()
                    .filter(|other| (cell.0 - other.0).pow(2) + (cell.1 - other.1).pow(2) == square);
                let expected = as_near.max_by_key(|other| (other.1, -other.0));
                assert_eq!(expected, Some((found_row as i32, found_col as i32)), "for {row}, {col}");
            }
        }
    }

    #[test]
    fn vertex_distances_equal_brute_force_over_closed_squares() {
        let mut rng = rng::stream(2, "grid/distance");
        for _ in 0..200 {
            let map = random_map(&mut rng);
            let cells = occupied_cells(&map);
            let factor = rng.random_range(1..8);
            let gap = |vertex: usize, cell: i32| {
                let (vertex, low) = (vertex as i32, cell * factor);
                (low - vertex).max(vertex - low - factor).max(0)
            };
            let mut rows_seen = 0;
            squared_vertex_distances(&map, factor as usize, |row, squares| {
                assert_eq!(row, rows_seen);
                rows_seen += 1;
                assert_eq!(squares.len(), map.cols() * factor as usize + 1);
                for (col, &found) in squares.iter().enumerate() {
                    let square = |&(r, c): &(i32, i32)| gap(row, r).pow(2) + gap(col, c).pow(2);
                    assert_eq!(Some(found), cells.iter().map(square).min(), "at {row}, {col}");
                }
            });
            let expected = if cells.is_empty() { 0 } else { map.rows() * factor as usize + 1 };
            assert_eq!(rows_seen, expected);
        }
    }

    #[test]
    fn the_two_transforms_agree_where_squares_shrink_to_points() {
        // At factor 1 a square covers its four corners, so the plain transform of the covered corners must agree.
        let mut rng = rng::stream(3, "grid/distance");
        for _ in 0..100 {
            let map = random_map(&mut rng);
            let mut corners = Grid::filled(map.rows() + 1, map.cols() + 1, false);
            for (row, col) in occupied_cells(&map) {
                for (dr, dc) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    corners[(row as usize + dr, col as usize + dc)] = true;
                }
            }
            let expected = squared_distances(&corners);
            squared_vertex_distances(&map, 1, |row, squares| {
                assert_eq!(Some(squares), expected.as_ref().map(|grid| grid.row(row)));
            });
        }
    }

    #[test]
    fn the_longest_side_does_not_overflow() {
        let mut map = Grid::filled(1, MAX_CELLS_A_SIDE, false);
        map[(0, 0)] = true;
        let squares = squared_distances(&map).expect("one cell is occupied");
        assert_eq!(squares[(0, MAX_CELLS_A_SIDE - 1)], (MAX_CELLS_A_SIDE as i32 - 1).pow(2));
    }
}
