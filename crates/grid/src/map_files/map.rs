//! A map as it was read, and the options of reading.

use crate::map_files::Fault;
use crate::map_files::error::{check_size, with_room};
use crate::map_files::otsu::Histogram;
use crate::map_files::ros::MapPlace;
use crate::{Grid, occupancy};

/// The distance from the tolerance within which grey values are doubtful.
pub const NEAR_TOLERANCE: u8 = 20;

/// More than this share of such pixels, or of occupied cells, is odd for a map.
const MANY_NEAR: f64 = 0.05;
const MANY_OCCUPIED: f64 = 0.60;

/// Dark and light whose means lie this many grey levels apart are not the noise of one colour.
const CLEARLY_APART: f64 = 12.0;

/// Obstacles are more than this share of a map.
const FEW: f64 = 0.01;

/// The rule for occupied pixels of an image: those whose grey value is at most the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tolerance {
    Grey(u8),
    /// The value that separates dark from light best, by Otsu's method.
    Auto,
}

impl Default for Tolerance {
    /// Returns a value between a black drawing and its soft edges.
    fn default() -> Self {
        Self::Grey(50)
    }
}

/// Options of reading a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    pub tolerance: Tolerance,
    /// Read an image as its negative, and swap occupied and free cells.
    pub inverted: bool,
}

impl From<u8> for Reading {
    fn from(tolerance: u8) -> Self {
        Self { tolerance: Tolerance::Grey(tolerance), inverted: false }
    }
}

/// A map and the information in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFile {
    pub occupied: Grid<bool>,
    /// The grey values of an image, 0 black to 255 white; of the negative if requested.
    pub grey: Option<Grid<u8>>,
    /// The grey value up to which the pixels of an image are occupied.
    pub tolerance: Option<u8>,
    /// The options with which it was read.
    pub reading: Reading,
    /// The position of the cells in the world, if the file has one.
    pub place: Option<MapPlace>,
    /// Sentences about changes made on reading.
    pub notes: Vec<String>,
}

impl MapFile {
    /// Returns a map of cells, without notes.
    pub fn from_cells(occupied: Grid<bool>) -> Self {
        let reading = Reading::default();
        Self { occupied, grey: None, tolerance: None, reading, place: None, notes: Vec::new() }
    }

    /// Returns the map that an image shows.
    pub(super) fn from_grey(mut grey: Grid<u8>, mut notes: Vec<String>, reading: Reading) -> Self {
        // Before the threshold is looked for, which has to fit the inverted image.
        if reading.inverted {
            grey.values_mut().iter_mut().for_each(|value| *value = 255 - *value);
        }
        let tolerance = match reading.tolerance {
            Tolerance::Grey(tolerance) => tolerance,
            Tolerance::Auto => {
                let (tolerance, note) = match Histogram::from_grey(grey.values()).threshold() {
                    Some(tolerance) => (tolerance, format!("the tolerance is {tolerance}, by Otsu's method")),
                    None => {
                        let note = "all pixels have the same grey value, so the tolerance stays at 50";
                        (50, note.to_owned())
                    }
                };
                notes.push(note);
                tolerance
            }
        };
        let occupied = occupancy::from_grey(&grey, tolerance);
        Self { occupied, grey: Some(grey), tolerance: Some(tolerance), reading, place: None, notes }
    }

    /// Returns the share of an image's pixels whose grey value is within [`NEAR_TOLERANCE`] of the tolerance; `None`
    /// for a map that is no image.
    pub fn share_near(&self) -> Option<f64> {
        let grey = self.grey.as_ref()?.values();
        let tolerance = self.tolerance?;
        let near = grey.iter().filter(|&&value| value.abs_diff(tolerance) <= NEAR_TOLERANCE).count();
        Some(near as f64 / grey.len() as f64)
    }

    /// Returns sentences on why an image may have been misread: obstacles that are slightly or far too light, or a
    /// drawing that is white on black. None of them suggests what was already done.
    pub fn doubts(&self) -> Vec<String> {
        // Tables and texts have no grey values, and leave nothing to doubt.
        let (Some(near), Some(tolerance)) = (self.share_near(), self.tolerance) else { return Vec::new() };
        let cells = self.occupied.values();
        let occupied = cells.iter().filter(|&&occupied| occupied).count() as f64 / cells.len() as f64;
        let auto = self.share_by_auto();
        let by_auto = auto.map(|ByAuto { tolerance, taken, share }| {
            let [share, taken] = [share, taken].map(|share| 100.0 * share);
            format!(
                "--tolerance auto, {tolerance}, {share:.1} % of the cells would be occupied instead of {taken:.1} %."
            )
        });
        let mut doubts = Vec::new();
        if near > MANY_NEAR {
            let percent = 100.0 * near;
            let advice = match (&by_auto, self.reading.tolerance) {
                (Some(by_auto), _) => format!("; with {by_auto}"),
                (None, Tolerance::Grey(_)) => "; --tolerance auto picks one.".to_owned(),
                (None, Tolerance::Auto) => ".".to_owned(),
            };
            doubts.push(format!(
                "{percent:.1} % of the pixels are within {NEAR_TOLERANCE} grey levels of the tolerance, {tolerance}: \
                 with another --tolerance they may be obstacles, or none{advice}"
            ));
        } else {
            doubts.extend(by_auto.map(|by_auto| format!("With {by_auto}")));
        }
        // Where all is dark, another tolerance is the better advice.
        let is_explained = auto.is_some_and(|auto| auto.share <= MANY_OCCUPIED);
        if occupied > MANY_OCCUPIED && !is_explained {
            let percent = 100.0 * occupied;
            let advice = if self.reading.inverted {
                "--invert took light pixels as obstacles."
            } else {
                "the image may be inverted: dark pixels are obstacles; --invert takes light pixels instead."
            };
            doubts.push(format!("{percent:.1} % of the cells are occupied: {advice}"));
        }
        doubts
    }

    /// What `--tolerance auto` would take of an image that was read with another one, if dark and light are clearly apart
    /// and that differs much.
    fn share_by_auto(&self) -> Option<ByAuto> {
        let grey = self.grey.as_ref()?.values();
        let taken = self.tolerance?;
        if self.reading.tolerance == Tolerance::Auto {
            return None;
        }
        let histogram = Histogram::from_grey(grey);
        // Some pixels are lighter than a threshold, so that a grey value follows it.
        let tolerance = histogram.threshold()?;
        let (dark, dark_sum) = histogram.count_and_sum(0..=tolerance);
        let (light, light_sum) = histogram.count_and_sum(tolerance + 1..=u8::MAX);
        let share = dark / grey.len() as f64;
        let taken = histogram.count_and_sum(0..=taken).0 / grey.len() as f64;
        let is_apart = light_sum / light - dark_sum / dark >= CLEARLY_APART;
        let differs = taken < 0.5 * share || 1.0 - taken < 0.5 * (1.0 - share);
        (is_apart && differs && (FEW..=1.0 - FEW).contains(&share)).then_some(ByAuto { tolerance, taken, share })
    }

    /// Resamples the map to this number of rows and columns: a cell is occupied if any old cell that it overlaps is, so
    /// that no wall is lost. Grey values are the darkest.
    ///
    /// # Errors
    /// If no map has that size.
    pub fn resize(&mut self, rows: usize, cols: usize) -> Result<(), Fault> {
        check_size(rows, cols)?;
        let old_rows = self.occupied.rows();
        let old_cols = self.occupied.cols();
        self.occupied = resized(&self.occupied, (rows, cols), |one, other| one | other)?;
        self.grey = self.grey.as_ref().map(|grey| resized(grey, (rows, cols), u8::min)).transpose()?;
        if let Some(place) = self.place {
            // Cells that are no squares have no side.
            let is_square = old_rows * cols == old_cols * rows;
            let cell_m = place.cell_m * old_cols as f64 / cols as f64;
            self.place = is_square.then_some(MapPlace { cell_m, ..place });
        }
        Ok(())
    }
}

/// What the tolerance took of an image, and what that of `--tolerance auto` would take.
#[derive(Clone, Copy)]
struct ByAuto {
    tolerance: u8,
    taken: f64,
    share: f64,
}

/// Joins the values of all old cells that a new one covers in part.
fn resized<T: Copy>(
    old: &Grid<T>,
    (rows, cols): (usize, usize),
    mut join: impl FnMut(T, T) -> T,
) -> Result<Grid<T>, Fault> {
    // Rounded outwards, so that no obstacle is lost that a new cell merely touches.
    let covered =
        |new: usize, all_new: usize, all_old: usize| new * all_old / all_new..((new + 1) * all_old).div_ceil(all_new);
    let mut values = with_room(rows * cols)?;
    let mut joined_rows = Vec::with_capacity(old.cols());
    for row in 0..rows {
        let mut covered_rows = covered(row, rows, old.rows());
        joined_rows.clear();
        joined_rows.extend_from_slice(old.row(covered_rows.next().expect("a cell covers another")));
        for row in covered_rows {
            joined_rows.iter_mut().zip(old.row(row)).for_each(|(joined, &value)| *joined = join(*joined, value));
        }
        for col in 0..cols {
            let value = joined_rows[covered(col, cols, old.cols())].iter().copied().reduce(&mut join);
            values.push(value.expect("a cell covers another"));
        }
    }
    Ok(Grid::from_values(rows, cols, values))
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::drawn;
    use wildfire_base::rng;

    #[test]
    fn a_new_cell_is_occupied_where_any_old_one_below_it_is() {
        let mut rng = rng::stream(1, "resize");
        for _ in 0..200 {
            let mut side = || rng.random_range(1..20);
            let [rows, cols, new_rows, new_cols] = [side(), side(), side(), side()];
            let old = drawn::random(rows, cols, 0.1, &mut rng);
            let mut map = MapFile::from_cells(old.clone());
            map.resize(new_rows, new_cols).expect("it has a size");
            let overlap = |new: usize, all_new: usize, old: usize, all_old: usize| {
                new * all_old < (old + 1) * all_new && old * all_new < (new + 1) * all_old
            };
            for (row, col) in (0..new_rows).flat_map(|row| (0..new_cols).map(move |col| (row, col))) {
                let expected = (0..rows)
                    .flat_map(|r| (0..cols).map(move |c| (r, c)))
                    .any(|(r, c)| old[(r, c)] && overlap(row, new_rows, r, rows) && overlap(col, new_cols, c, cols));
                assert_eq!(map.occupied[(row, col)], expected, "{rows} x {cols} to {new_rows} x {new_cols}");
            }
        }
    }

    #[test]
    fn resizing_grey_values_and_cells_agrees() {
        let mut rng = rng::stream(2, "resize");
        let grey = Grid::from_values(17, 23, (0..17 * 23).map(|_| rng.random()).collect());
        let mut map = MapFile::from_grey(grey, Vec::new(), Reading::from(9));
        map.resize(5, 8).expect("it has a size");
        let grey = map.grey.as_ref().expect("an image");
        assert_eq!(map.occupied, occupancy::from_grey(grey, 9));
        assert!(map.resize(0, 8).is_err() && map.resize(8, 40_000).is_err());
    }

    /// The doubts about an image of so many pixels of each grey value.
    fn doubts(pixels: &[(usize, u8)], reading: impl Into<Reading>) -> String {
        let values: Vec<u8> = pixels.iter().flat_map(|&(count, value)| vec![value; count]).collect();
        let map = MapFile::from_grey(Grid::from_values(1, values.len(), values), Vec::new(), reading.into());
        map.doubts().join("\n")
    }

    #[test]
    fn obstacles_lighter_than_the_tolerance_are_reported() {
        let auto = Reading { tolerance: Tolerance::Auto, inverted: false };
        let light = [(5, 76), (5, 150), (90, 255)];
        let advice = "With --tolerance auto, 202, 10.0 % of the cells would be occupied instead of 0.0 %.";
        assert_eq!(doubts(&light, 50), advice);
        assert_eq!(doubts(&light, auto), "");
        assert_eq!(doubts(&light, 160), "", "what auto would take is taken");
        // Black walls, soft edges, the noise of white paper, a speck.
        assert_eq!(doubts(&[(10, 0), (4, 150), (86, 255)], 50), "");
        assert_eq!(doubts(&[(30, 250), (70, 255)], 50), "");
        assert_eq!(doubts(&[(1, 150), (199, 255)], 50), "");
    }

    #[test]
    fn what_was_done_is_not_advised() {
        // Values of 12 bits in samples of 16: all is dark.
        let dark = [(20, 0), (80, 16)];
        assert_eq!(
            doubts(&dark, 50),
            "With --tolerance auto, 7, 20.0 % of the cells would be occupied instead of 100.0 %."
        );
        let near = doubts(&dark, Reading { tolerance: Tolerance::Auto, inverted: false });
        assert!(near.contains("they may be obstacles, or none.") && !near.contains("auto"), "{near}");
        let negative = [(80, 0), (20, 255)];
        assert!(doubts(&negative, 50).contains("--invert takes light pixels"));
        let inverted = doubts(&[(80, 255), (20, 0)], Reading { inverted: true, ..Reading::default() });
        assert_eq!(inverted, "80.0 % of the cells are occupied: --invert took light pixels as obstacles.");
    }

    #[test]
    fn a_place_is_kept_while_cells_are_squares() {
        let place = MapPlace { cell_m: 0.1, origin: [1.0, 2.0, 0.0] };
        let mut map = MapFile { place: Some(place), ..MapFile::from_cells(Grid::filled(20, 40, false)) };
        map.resize(10, 20).expect("it has a size");
        assert_eq!(map.place, Some(MapPlace { cell_m: 0.2, ..place }));
        map.resize(10, 10).expect("it has a size");
        assert_eq!(map.place, None);
    }
}
