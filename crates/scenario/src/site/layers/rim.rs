//! The rim of a raster: cells without data that are connected to its border, as projected downloads have it.

use std::collections::VecDeque;

use wildfire_grid::map_files::raster::Raster;

/// Marks the cells without data that are connected to the border of a raster, by corners too.
pub(super) fn rim(raster: &Raster) -> Vec<bool> {
    let (rows, cols) = (raster.rows, raster.cols);
    let mut outside = vec![false; rows * cols];
    let sides = (0..rows).flat_map(|row| [row * cols, row * cols + cols - 1]);
    let mut open: Vec<usize> = sides.chain((0..cols).flat_map(|col| [col, (rows - 1) * cols + col])).collect();
    while let Some(index) = open.pop() {
        if !outside[index] && raster.is_nodata(raster.values[index]) {
            outside[index] = true;
            open.extend(around(index, cols, rows));
        }
    }
    outside
}

/// Lists the up to eight cells around one.
fn around(index: usize, cols: usize, rows: usize) -> impl Iterator<Item = usize> {
    let (row, col) = (index / cols, index % cols);
    let near = (row.saturating_sub(1)..=(row + 1).min(rows - 1))
        .flat_map(move |row| (col.saturating_sub(1)..=(col + 1).min(cols - 1)).map(move |col| row * cols + col));
    near.filter(move |&cell| cell != index)
}

/// Gives elevations to cells that have none, from the rim inwards to outwards, so that the cells beside them have the slope
/// that they would have at the border of a field.
pub(super) fn continue_into_rim(elevation: &mut [f32], cols: usize) {
    let rows = elevation.len() / cols;
    let has_value: Vec<bool> = elevation.iter().map(|height| !height.is_nan()).collect();
    if has_value.iter().all(|&is_valid| is_valid) {
        return;
    }
    // Breadth first, so that every cell continues from the nearest ones with data.
    let mut open: VecDeque<usize> = (0..elevation.len()).filter(|&index| has_value[index]).collect();
    while let Some(index) = open.pop_front() {
        for cell in around(index, cols, rows) {
            if !elevation[cell].is_nan() {
                continue;
            }
            // The plane through the known cells beside it; farther out, the height of the cell that it was reached from.
            let beyond = |near: usize| {
                let place = |cell: usize| ((cell % cols) as isize, (cell / cols) as isize);
                let (col, row) = place(cell);
                let (near_col, near_row) = place(near);
                let col = 2 * near_col - col;
                let row = 2 * near_row - row;
                let is_there = (0..cols as isize).contains(&col) && (0..rows as isize).contains(&row);
                let far = is_there.then(|| row as usize * cols + col as usize).filter(|&far| has_value[far])?;
                Some(2.0 * elevation[near] - elevation[far])
            };
            let heights: Vec<f32> =
                around(cell, cols, rows).filter(|&near| has_value[near]).filter_map(beyond).collect();
            let mean = heights.iter().sum::<f32>() / heights.len() as f32;
            elevation[cell] = if heights.is_empty() { elevation[index] } else { mean };
            open.push_back(cell);
        }
    }
}
