//! Contour lines of values on a grid, by marching squares: each square between four neighbouring values is crossed by none, one
//! or two straight pieces, which are joined into lines.
//!
//! The squares are those of Lorensen and Cline, "Marching Cubes: A High Resolution 3D Surface Construction Algorithm", SIGGRAPH
//! 1987, in two dimensions. Where two corners across a square lie above the level and the other two below, the mean of the four
//! decides which pair is joined.

use wildfire_grid::Grid;

/// A line along which values have one level.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourLine {
    /// Places as (column, row), where values are at whole numbers. A closed line ends where it begins.
    pub points: Vec<(f64, f64)>,
}

impl ContourLine {
    pub fn is_closed(&self) -> bool {
        self.points.first() == self.points.last()
    }

    /// The sum of its pieces, in cells.
    pub fn length(&self) -> f64 {
        let pieces = self.points.windows(2).map(|pair| {
            let right = pair[1].0 - pair[0].0;
            let up = pair[1].1 - pair[0].1;
            (right * right + up * up).sqrt()
        });
        pieces.sum()
    }
}

/// Returns the lines along which values reach `level`, open ones first; there are none beside a value that is not finite.
///
/// Order and direction of lines follow from the values alone.
pub fn contour_lines(values: &Grid<f64>, level: f64) -> Vec<ContourLine> {
    let mut pieces = Vec::new();
    for row in 1..values.rows() {
        for col in 1..values.cols() {
            cross_square(values, (row - 1, col - 1), level, &mut |from, to| pieces.push((from, to)));
        }
    }
    join(&pieces).into_iter().map(|sides| ContourLine { points: sides_at(values, &sides, level) }).collect()
}

/// A side of a square, by its first corner's place among the values: twice that, and one more if it goes on to the next row in
/// place of the next column.
type SquareSide = usize;

/// Finds the pieces of line within the square whose first corner is given.
fn cross_square(
    values: &Grid<f64>,
    (row, col): (usize, usize),
    level: f64,
    piece: &mut impl FnMut(SquareSide, SquareSide),
) {
    let corners = [(row, col), (row, col + 1), (row + 1, col + 1), (row + 1, col)].map(|place| values[place]);
    // Where fire never came there is no value to interpolate, and the line ends at that square.
    if !corners.iter().all(|corner| corner.is_finite()) {
        return;
    }
    let is_high = corners.map(|corner| corner >= level);
    let first = row * values.cols() + col;
    // In the order of corners: from each to the next one.
    let sides = [2 * first, 2 * (first + 1) + 1, 2 * (first + values.cols()), 2 * first + 1];
    let crossed = (0..4).filter(|&corner| is_high[corner] != is_high[(corner + 1) % 4]).map(|corner| sides[corner]);
    match crossed.collect::<Vec<SquareSide>>()[..] {
        [from, to] => piece(from, to),
        [_, _, _, _] => {
            let mean = corners.iter().map(|corner| 0.25 * corner).sum::<f64>();
            // A pair of corners that the middle joins is cut off from by one piece around each of the other two.
            let lone = usize::from((mean >= level) == is_high[0]);
            for corner in [lone, lone + 2] {
                piece(sides[(corner + 3) % 4], sides[corner]);
            }
        }
        _ => {}
    }
}

/// Joins pieces at sides that they share: at most two pieces meet at a side.
fn join(pieces: &[(SquareSide, SquareSide)]) -> Vec<Vec<SquareSide>> {
    let mut ends: Vec<(SquareSide, usize)> =
        pieces.iter().enumerate().flat_map(|(piece, &(from, to))| [(from, piece), (to, piece)]).collect();
    ends.sort_unstable();
    let pieces_at = |side: SquareSide| {
        let first = ends.partition_point(|&(other, _)| other < side);
        ends[first..].iter().take_while(move |&&(other, _)| other == side).map(|&(_, piece)| piece)
    };
    let mut is_used = vec![false; pieces.len()];
    let mut lines = Vec::new();
    // Lines with ends begin at their lower one; what is left goes round.
    let lone = ends.iter().map(|&(side, _)| side).filter(|&side| pieces_at(side).count() == 1);
    for start in lone.chain(ends.iter().map(|&(side, _)| side)) {
        let mut line = vec![start];
        while let Some(piece) = pieces_at(line[line.len() - 1]).find(|&piece| !is_used[piece]) {
            is_used[piece] = true;
            let (from, to) = pieces[piece];
            line.push(if from == line[line.len() - 1] { to } else { from });
        }
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

fn sides_at(values: &Grid<f64>, sides: &[SquareSide], level: f64) -> Vec<(f64, f64)> {
    sides
        .iter()
        .map(|&side: &SquareSide| {
            let row = side / 2 / values.cols();
            let col = side / 2 % values.cols();
            let goes_up = side % 2 == 1;
            let from = values[(row, col)];
            let to = if goes_up { values[(row + 1, col)] } else { values[(row, col + 1)] };
            // The two differ, as the line crosses this side.
            let share = (level - from) / (to - from);
            let (col, row) = (col as f64, row as f64);
            if goes_up { (col, row + share) } else { (col + share, row) }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(rows: usize, cols: usize, value: impl Fn(f64, f64) -> f64) -> Grid<f64> {
        let values = (0..rows * cols).map(|index| value((index % cols) as f64, (index / cols) as f64));
        Grid::from_values(rows, cols, values.collect())
    }

    #[test]
    fn planes_have_straight_lines_where_they_reach_the_level() {
        let lines = contour_lines(&grid(7, 9, |x, y| x + 0.5 * y), 4.25);
        assert_eq!(lines.len(), 1);
        assert!(!lines[0].is_closed());
        assert!(lines[0].points.iter().all(|&(x, y)| (x + 0.5 * y - 4.25).abs() < 1e-12));
        assert!((lines[0].length() - (36.0_f64 + 9.0).sqrt()).abs() < 1e-9, "{}", lines[0].length());
    }

    #[test]
    fn cones_have_one_closed_line_as_long_as_the_circle() {
        let cone = grid(81, 81, |x, y| ((x - 40.0) * (x - 40.0) + (y - 40.0) * (y - 40.0)).sqrt());
        let lines = contour_lines(&cone, 30.0);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].is_closed());
        let circle = 2.0 * std::f64::consts::PI * 30.0;
        assert!((lines[0].length() / circle - 1.0).abs() < 0.002, "{} for {circle}", lines[0].length());
    }

    #[test]
    fn saddles_join_the_pair_that_the_middle_belongs_to() {
        let saddle = |high: f64| Grid::from_values(2, 2, vec![high, 0.0, 0.0, high]);
        for (high, joins_high) in [(3.0, true), (1.5, false)] {
            let lines = contour_lines(&saddle(high), 1.0);
            assert_eq!(lines.len(), 2);
            // A line about a low corner stays on its side of the diagonal between the high ones.
            let about_low = lines.iter().all(|line| line.points.iter().all(|&(x, y)| (x - y) * line_side(line) > 0.0));
            assert_eq!(about_low, joins_high, "{lines:?}");
        }
    }

    fn line_side(line: &ContourLine) -> f64 {
        line.points.iter().map(|&(x, y)| x - y).sum::<f64>()
    }

    #[test]
    fn lines_end_where_values_end() {
        let mut plane = grid(5, 5, |x, _| x);
        plane[(2, 2)] = f64::NAN;
        let lines = contour_lines(&plane, 1.5);
        assert_eq!(
            lines.iter().map(|line| line.points.clone()).collect::<Vec<_>>(),
            [vec![(1.5, 0.0), (1.5, 1.0)], vec![(1.5, 3.0), (1.5, 4.0)]]
        );
        assert_eq!(contour_lines(&grid(1, 5, |x, _| x), 1.5), []);
        assert_eq!(contour_lines(&grid(5, 5, |_, _| f64::INFINITY), 1.0), []);
    }

    #[test]
    fn every_level_is_crossed_in_every_way_once() {
        // Values without any order: each crossed side belongs to one line only, at one place of it.
        let values =
            grid(30, 40, |x, y| f64::from(((x * 7919.0 + y * 104_729.0) as u32).wrapping_mul(2_654_435_761) >> 24));
        let lines = contour_lines(&values, 127.5);
        let crossings = (0..30).flat_map(|row| (0..40).map(move |col| (row, col))).map(|(row, col)| {
            let high = |place: (usize, usize)| values[place] > 127.5;
            usize::from(col + 1 < 40 && high((row, col)) != high((row, col + 1)))
                + usize::from(row + 1 < 30 && high((row, col)) != high((row + 1, col)))
        });
        let points = lines.iter().map(|line| line.points.len() - usize::from(line.is_closed())).sum::<usize>();
        assert_eq!(points, crossings.sum::<usize>());
    }
}
