//! An index of places by buckets of the field, which finds the nearest of thousands by examining a few.

use glam::DVec2;

use wildfire_base::geometry::FieldFrame;

/// Buckets a side at most: more would cost more to build than they save.
const MAX_BUCKETS: f64 = 64.0;

/// Places on a field, by bucket. They are named by their numbers in the list that the index was built from.
#[derive(Clone, Debug)]
pub struct PlaceIndex {
    places: Vec<DVec2>,
    bucket_m: f64,
    cols: i64,
    rows: i64,
    /// Where each bucket begins in `order`, and the end of the last one.
    begins: Vec<u32>,
    /// Numbers of places, bucket by bucket, ascending in each.
    order: Vec<u32>,
}

impl PlaceIndex {
    /// Builds the index, in time linear in the number of places.
    pub fn new(frame: &FieldFrame, places: Vec<DVec2>) -> Self {
        // About one place a bucket if they are spread evenly; fires are not, and a bucket of many is searched in a line.
        let across = (places.len() as f64).sqrt().ceil().clamp(1.0, MAX_BUCKETS);
        let bucket_m = frame.width_m().max(frame.height_m()) / across;
        let cols = (frame.width_m() / bucket_m).ceil() as i64;
        let rows = (frame.height_m() / bucket_m).ceil() as i64;
        let mut index = Self { places, bucket_m, cols, rows, begins: Vec::new(), order: Vec::new() };
        let buckets: Vec<usize> = index.places.iter().map(|&place| index.bucket_at(place)).collect();
        // A counting sort: buckets lie one after the other in one list.
        index.begins = vec![0; (cols * rows) as usize + 1];
        buckets.iter().for_each(|&bucket| index.begins[bucket + 1] += 1);
        (1..index.begins.len()).for_each(|bucket| index.begins[bucket] += index.begins[bucket - 1]);
        let mut next = index.begins.clone();
        index.order = vec![0; buckets.len()];
        for (number, &bucket) in buckets.iter().enumerate() {
            index.order[next[bucket] as usize] = number as u32;
            next[bucket] += 1;
        }
        index
    }

    /// Finds the `count` nearest accepted places at most `max_m` away: distances and numbers, nearest first; ties go
    /// to the smaller number.
    pub fn nearest(
        &self,
        from: DVec2,
        count: usize,
        max_m: f64,
        mut accept: impl FnMut(usize) -> bool,
    ) -> Vec<(f64, usize)> {
        let mut found: Vec<(f64, usize)> = Vec::new();
        let (col, row) = self.bucket_of(from);
        // Outwards, so that far buckets are never looked at.
        for ring in 0..self.cols.max(self.rows) {
            // Nothing in this ring or beyond is nearer than that; places as far as the last one found may still win by number.
            let min_m = (ring - 1) as f64 * self.bucket_m;
            let is_full = found.len() == count && found.last().is_some_and(|&(last_m, _)| last_m < min_m);
            if min_m > max_m || is_full {
                break;
            }
            for across in row - ring..=row + ring {
                // The first and the last row of a ring are whole, of the others only the ends belong to it.
                let is_whole = across == row - ring || across == row + ring;
                let step = if is_whole { 1 } else { 2 * ring };
                for along in (col - ring..=col + ring).step_by(step as usize) {
                    if !(0..self.cols).contains(&along) || !(0..self.rows).contains(&across) {
                        continue;
                    }
                    let bucket = (across * self.cols + along) as usize;
                    for &number in &self.order[self.begins[bucket] as usize..self.begins[bucket + 1] as usize] {
                        let metres = (self.places[number as usize] - from).length();
                        let number = number as usize;
                        let at = found.partition_point(|&other| other < (metres, number));
                        // The caller's test is last, as it may estimate a whole drive.
                        if metres <= max_m && at < count && accept(number) {
                            found.truncate(count - 1);
                            found.insert(at, (metres, number));
                        }
                    }
                }
            }
        }
        found
    }

    /// The bucket of a place; of one outside the field, the nearest.
    fn bucket_of(&self, place: DVec2) -> (i64, i64) {
        let bucket = (place / self.bucket_m).floor();
        ((bucket.x as i64).clamp(0, self.cols - 1), (bucket.y as i64).clamp(0, self.rows - 1))
    }

    fn bucket_at(&self, place: DVec2) -> usize {
        let (col, row) = self.bucket_of(place);
        (row * self.cols + col) as usize
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    #[test]
    fn the_nearest_are_those_of_a_search_through_all() {
        let frame = FieldFrame { cols: 40, rows: 25, cell_m: 5.0 };
        let mut rng = rng::stream(1, "places");
        for size in [0, 1, 7, 60, 900] {
            // Cell centres, many of them shared: ties by number matter.
            let cell = |index: usize| frame.centre(frame.cell(index));
            let places: Vec<DVec2> = (0..size).map(|_| cell(rng.random_range(0..frame.cell_count()))).collect();
            let index = PlaceIndex::new(&frame, places.clone());
            for _ in 0..60 {
                let from = DVec2::new(rng.random_range(-20.0..220.0), rng.random_range(-20.0..150.0));
                let count = rng.random_range(1..6);
                let max_m = rng.random_range(1.0..250.0);
                let accept = |number: usize| number % 3 != 1;
                let metres = |number: usize| (places[number] - from).length();
                let mut all: Vec<_> = (0..size).filter(|&number| accept(number)).map(|n| (metres(n), n)).collect();
                all.retain(|&(metres, _)| metres <= max_m);
                all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                all.truncate(count);
                assert_eq!(index.nearest(from, count, max_m, accept), all, "{size} places, from {from}");
            }
        }
    }
}
