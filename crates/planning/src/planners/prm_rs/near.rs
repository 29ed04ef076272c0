//! Neighbour search among positions that are added one by one.

use glam::DVec2;

use wildfire_base::geometry::FieldFrame;

/// Side of a square, unless that makes too many.
const SIDE_M: f64 = 10.0;
/// Squares along a side of the field, at most.
const MAX_SQUARES: f64 = 500.0;

/// Positions in a field, numbered as they are added, in squares for neighbour search.
#[derive(Debug)]
pub struct Places {
    side_m: f64,
    cols: usize,
    rows: usize,
    squares: Vec<Vec<u32>>,
    places: Vec<DVec2>,
}

impl Places {
    pub fn new(frame: &FieldFrame) -> Self {
        let side_m = SIDE_M.max(frame.width_m().max(frame.height_m()) / MAX_SQUARES);
        let cols = (frame.width_m() / side_m) as usize + 1;
        let rows = (frame.height_m() / side_m) as usize + 1;
        Self { side_m, cols, rows, squares: vec![Vec::new(); cols * rows], places: Vec::new() }
    }

    pub fn add(&mut self, place: DVec2) {
        let col = (place.x / self.side_m) as usize;
        let row = (place.y / self.side_m) as usize;
        let square = row.min(self.rows - 1) * self.cols + col.min(self.cols - 1);
        self.squares[square].push(self.places.len() as u32);
        self.places.push(place);
    }

    /// Replaces what `found` holds by the places within `reach_m` of one, with their distances, in no particular order.
    pub fn within(&self, place: DVec2, reach_m: f64, found: &mut Vec<(f64, u32)>) {
        found.clear();
        let range = |middle: f64, count: usize| {
            // Casts clamp at 0.
            let low = (middle - reach_m) / self.side_m;
            let high = (middle + reach_m) / self.side_m;
            low as usize..(high as usize).saturating_add(1).min(count)
        };
        let cols = range(place.x, self.cols);
        for row in range(place.y, self.rows) {
            for square in cols.clone().map(|col| row * self.cols + col) {
                let distances =
                    self.squares[square].iter().map(|&number| (self.places[number as usize].distance(place), number));
                found.extend(distances.filter(|&(distance, _)| distance <= reach_m));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    #[test]
    fn near_places_are_those_of_a_look_at_all() {
        let mut rng = rng::stream(1, "places");
        let frame = FieldFrame { cols: 20, rows: 12, cell_m: 5.0 };
        let mut places = Places::new(&frame);
        let mut all = Vec::new();
        for _ in 0..300 {
            let place = DVec2::new(rng.random_range(0.0..100.0), rng.random_range(0.0..60.0));
            places.add(place);
            all.push(place);
        }
        let mut found = Vec::new();
        for _ in 0..200 {
            let here = DVec2::new(rng.random_range(-20.0..120.0), rng.random_range(-20.0..80.0));
            let reach_m = rng.random_range(0.0..50.0);
            let distances = all.iter().zip(0..).map(|(place, number)| (place.distance(here), number));
            let mut wanted: Vec<(f64, u32)> = distances.filter(|&(distance, _)| distance <= reach_m).collect();
            wanted.sort_by(|a, b| a.0.total_cmp(&b.0));
            places.within(here, reach_m, &mut found);
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert_eq!(found, wanted);
        }
    }
}
