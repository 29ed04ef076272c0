//! Generated landscapes: patches of fuel, hills, a river with bridges, roads.
//!
//! Every feature draws from a stream of its own, `landscape/river` for instance, so that a road more or less moves nothing
//! else. What comes later lies on top: patches, the river, roads, bridges. Nothing here costs more than a look at each
//! cell for each feature.

use std::f64::consts::TAU;

use rand::{Rng, RngExt};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fuel_name::FuelName;
use crate::faults::check::{Check, TablePath};
use crate::faults::path::PathStep;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, ops};
use wildfire_base::ranges;
use wildfire_base::rng;

/// Numbers of the fuel models of water and of bare ground.
const WATER: u8 = 98;
pub(crate) const BARE: u8 = 99;

/// The most entries of each list of features.
const MAX_FEATURES: usize = 100;

/// The most patches of an entry, beyond which its share is out of reach.
const MAX_PATCHES: u32 = 20_000;

/// Attempts to lay the river where no agent starts.
const RIVER_TRIES: u32 = 200;

/// Patches of a fuel on top of the ground: ellipses at random places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patches {
    pub fuel: FuelName,
    /// The share of the field that they cover.
    pub share: f64,
    /// Their mean diameter; each has half of it to one and a half times it.
    #[serde(default = "defaults::patch_m")]
    pub size_m: f64,
}

/// A hill with the profile of a bell: a Gaussian.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hill {
    /// Height of its top above the plain; negative: a hollow.
    pub height_m: f64,
    /// The distance from its top at which it is steepest: one standard deviation.
    pub radius_m: f64,
    /// The place of its top; it is drawn if it is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_m: Option<[f64; 2]>,
}

/// A river from the south edge to the north edge, or from the west edge to the east edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct River {
    pub width_m: f64,
    /// Amplitude of its bends to either side.
    pub swing_m: f64,
    /// The share of the field west (south) of its centre line.
    pub at: f64,
    pub runs: Runs,
    /// Bridges straight across it, at equal distances along it.
    pub bridges: u32,
    /// Width of a bridge, for trucks.
    pub bridge_m: f64,
}

/// The direction of a river.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Runs {
    SouthNorth,
    WestEast,
}

/// A road: bare ground along a line of straight pieces, which is a bridge where it meets the river.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Road {
    #[serde(default = "defaults::road_m")]
    pub width_m: f64,
    /// Its corners, x and y; if they are not given, it goes straight through the field at a random place.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points_m: Vec<[f64; 2]>,
}

mod defaults {
    pub fn patch_m() -> f64 {
        60.0
    }

    pub fn road_m() -> f64 {
        8.0
    }
}

impl Default for River {
    fn default() -> Self {
        Self { width_m: 15.0, swing_m: 30.0, at: 0.5, runs: Runs::SouthNorth, bridges: 2, bridge_m: 15.0 }
    }
}

/// The features of a landscape that are generated.
#[derive(Clone, Copy, Debug)]
pub struct Features<'a> {
    pub patches: &'a [Patches],
    pub river: Option<&'a River>,
    pub roads: &'a [Road],
}

/// Points from which the river keeps away, and how far.
#[derive(Clone, Debug)]
pub struct RiverExclusion {
    pub centres: Vec<DVec2>,
    pub clearance_m: f64,
}

impl Features<'_> {
    /// Lays the features onto the ground, numbers of fuel models by cell index.
    ///
    /// Returns false if the river meets the start of an agent wherever it is tried.
    pub fn lay(&self, ground: &mut [u8], frame: &FieldFrame, seed: u64, free: &RiverExclusion) -> bool {
        // Each feature has a stream of its own: adding one leaves the others where they are.
        for (number, patches) in self.patches.iter().enumerate() {
            patches.lay(ground, frame, &mut rng::stream(seed, &format!("landscape/patches/{number}")));
        }
        let course = match self.river {
            None => None,
            Some(river) => {
                let Some(course) = river.course(frame, &mut rng::stream(seed, "landscape/river"), free) else {
                    return false;
                };
                course.cells.iter().for_each(|&index| ground[index] = WATER);
                Some((river, course))
            }
        };
        // Roads after the river, which they cross.
        for (number, road) in self.roads.iter().enumerate() {
            road.lay(ground, frame, &mut rng::stream(seed, &format!("landscape/roads/{number}")));
        }
        if let Some((river, course)) = course {
            river.bridges(frame, &course).for_each(|index| ground[index] = BARE);
        }
        true
    }

    pub(crate) fn check(&self, table: &TablePath, frame: &FieldFrame) -> Check {
        let longest_m = frame.width_m().max(frame.height_m());
        table.count("patches", self.patches.len(), MAX_FEATURES)?;
        table.count("roads", self.roads.len(), MAX_FEATURES)?;
        for (number, patches) in self.patches.iter().enumerate() {
            let table = table.inner("patches").item(number);
            table.number("size_m", patches.size_m, frame.cell_m.min(longest_m)..=longest_m)?;
        }
        if let Some(river) = self.river {
            let table = table.inner("river");
            table.number("width_m", river.width_m, 0.01..=longest_m)?;
            table.number("swing_m", river.swing_m, 0.0..=longest_m)?;
            table.number("bridge_m", river.bridge_m, 0.01..=longest_m)?;
        }
        for (number, road) in self.roads.iter().enumerate() {
            let table = table.inner("roads").item(number);
            table.number("width_m", road.width_m, 0.01..=longest_m)?;
            table.count("points_m", road.points_m.len(), MAX_FEATURES)?;
            if road.points_m.len() == 1 {
                return table.refuse("points_m", "1 point".into(), "two points or more, or none".into());
            }
            for (place, point) in road.points_m.iter().enumerate() {
                // This is far outside of any field, and small enough that lengths stay finite.
                if point.iter().any(|m| m.abs() > 1e6) {
                    let expected = "metres from -1000000 to 1000000".into();
                    return table.inner("points_m").refuse_step(PathStep::Index(place), format!("{point:?}"), expected);
                }
            }
        }
        Ok(())
    }
}

ranges! { Patches { share: 0.0..=0.9 } }
ranges! { Hill { height_m: -5000.0..=5000.0 } }
ranges! { River { at: 0.0..=1.0, bridges: 0.0..=MAX_FEATURES as f64 } }

/// Checks hills.
pub(crate) fn check_hills(hills: &[Hill], table: &TablePath, frame: &FieldFrame) -> Check {
    table.count("hills", hills.len(), MAX_FEATURES)?;
    for (number, hill) in hills.iter().enumerate() {
        let table = table.inner("hills").item(number);
        table.number("radius_m", hill.radius_m, frame.cell_m..=1e6)?;
        for m in hill.at_m.into_iter().flatten() {
            table.number("at_m", m, -1e6..=1e6)?;
        }
    }
    Ok(())
}

/// Returns the elevations of hills on a plain, by cell index.
pub fn hill_elevations(hills: &[Hill], frame: &FieldFrame, seed: u64) -> Vec<f32> {
    let mut heights = vec![0.0; frame.cell_count()];
    for (number, hill) in hills.iter().enumerate() {
        let mut rng = rng::stream(seed, &format!("landscape/hills/{number}"));
        let drawn = DVec2::new(rng.random::<f64>() * frame.width_m(), rng.random::<f64>() * frame.height_m());
        let top = hill.at_m.map_or(drawn, DVec2::from);
        for (index, height) in heights.iter_mut().enumerate() {
            let distance = (frame.centre(frame.cell(index)) - top) / hill.radius_m;
            *height += hill.height_m * ops::exp(-0.5 * distance.length_squared());
        }
    }
    heights.into_iter().map(|height| height as f32).collect()
}

impl Patches {
    /// Lays ellipses until the share is reached.
    fn lay(&self, ground: &mut [u8], frame: &FieldFrame, rng: &mut impl Rng) {
        let fuel = self.fuel.number();
        // Cells that this entry has covered count once, wherever its patches overlap.
        let wanted = (self.share * frame.cell_count() as f64).round() as usize;
        let mut is_covered = vec![false; frame.cell_count()];
        let mut covered = 0;
        // Patches overlap, so their number is not known; the bound ends a share that is out of reach.
        for _ in 0..MAX_PATCHES {
            if covered >= wanted {
                return;
            }
            let centre = DVec2::new(rng.random::<f64>() * frame.width_m(), rng.random::<f64>() * frame.height_m());
            let mut half = || 0.5 * self.size_m * (0.5 + rng.random::<f64>());
            let axes = DVec2::new(half(), half());
            let (sin, cos) = ops::sin_cos(TAU * rng.random::<f64>());
            for index in cells_near(frame, centre, axes.max_element()) {
                let offset = frame.centre(frame.cell(index)) - centre;
                let along = DVec2::new(offset.x * cos + offset.y * sin, offset.y * cos - offset.x * sin) / axes;
                // The last patch ends where the share is reached, so that the share is exact.
                if along.length_squared() <= 1.0 && !is_covered[index] && covered < wanted {
                    is_covered[index] = true;
                    ground[index] = fuel;
                    covered += 1;
                }
            }
        }
    }
}

/// Lists the cells in the square about a point, by index.
fn cells_near(frame: &FieldFrame, centre: DVec2, reach_m: f64) -> impl Iterator<Item = usize> + use<> {
    let frame = *frame;
    let bound = |m: f64, cells: u16| (m / frame.cell_m).floor().clamp(0.0, f64::from(cells) - 1.0) as u16;
    let (low, high) = (centre - reach_m, centre + reach_m);
    let cols = bound(low.x, frame.cols)..=bound(high.x, frame.cols);
    let rows = bound(low.y, frame.rows)..=bound(high.y, frame.rows);
    rows.flat_map(move |row| cols.clone().map(move |col| frame.index(Cell { col, row })))
}

/// The cells of a river, and the middle of its water in each step along it.
struct RiverCourse {
    cells: Vec<usize>,
}

impl River {
    /// Draws a course that keeps away from starts; `None` if none is found.
    fn course(&self, frame: &FieldFrame, rng: &mut impl Rng, free: &RiverExclusion) -> Option<RiverCourse> {
        let clearance = |cells: &[usize]| {
            let half = 0.5 * frame.cell_m;
            free.centres.iter().all(|&centre| {
                cells.iter().all(|&index| {
                    let offset = (centre - frame.centre(frame.cell(index))).abs() - DVec2::splat(half);
                    offset.max(DVec2::ZERO).length() > free.clearance_m
                })
            })
        };
        (0..RIVER_TRIES).find_map(|_| {
            let phases = [rng.random::<f64>(), rng.random::<f64>()].map(|turns| TAU * turns);
            // A field may hold its starts so that the middle never works: later tries look farther aside.
            let aside = 0.2 * (rng.random::<f64>() - 0.5);
            let cells = self.water(frame, phases, aside);
            clearance(&cells).then_some(RiverCourse { cells })
        })
    }

    /// Returns the cells of water. Neighbouring steps along the river share a place across it, so that no two cells of
    /// the course meet at a corner only and no fire slips through.
    fn water(&self, frame: &FieldFrame, phases: [f64; 2], aside: f64) -> Vec<usize> {
        let (steps, across) = self.sides(frame);
        let length = f64::from(steps) * frame.cell_m;
        let width = f64::from(across) * frame.cell_m;
        let middle = |along: f64| {
            let turn = TAU * along / length;
            // The shares add up to 1, so that no bend goes beyond `swing_m`.
            let swing = 0.7 * ops::sin(1.3 * turn + phases[0]) + 0.3 * ops::sin(3.1 * turn + phases[1]);
            (self.at + aside) * width + self.swing_m * swing
        };
        let mut cells = Vec::new();
        for step in 0..steps {
            let [from, to] = [0.0, 1.0].map(|end| middle((f64::from(step) + end) * frame.cell_m));
            let slant = (to - from) / frame.cell_m;
            // Across a slanting course the width takes more cells along this axis.
            let half = 0.5 * self.width_m * (1.0 + slant * slant).sqrt();
            // The whole stretch between the two ends, and half the width beyond the middle of it.
            let low = from.min(to).min(0.5 * (from + to) - half);
            let high = from.max(to).max(0.5 * (from + to) + half);
            let bound = |m: f64| (m / frame.cell_m).floor();
            let first = bound(low).max(0.0);
            let last = bound(high).min(f64::from(across) - 1.0);
            // In floats: where the course leaves the field, `last` may be below zero.
            let mut place = first;
            while place <= last {
                cells.push(frame.index(self.cell(step, place as u16)));
                place += 1.0;
            }
        }
        cells
    }

    /// Returns the numbers of cells along the river and across it.
    fn sides(&self, frame: &FieldFrame) -> (u16, u16) {
        match self.runs {
            Runs::SouthNorth => (frame.rows, frame.cols),
            Runs::WestEast => (frame.cols, frame.rows),
        }
    }

    fn cell(&self, along: u16, across: u16) -> Cell {
        match self.runs {
            Runs::SouthNorth => Cell { col: across, row: along },
            Runs::WestEast => Cell { col: along, row: across },
        }
    }

    /// Lists the cells of bridges.
    fn bridges<'a>(&self, frame: &'a FieldFrame, course: &'a RiverCourse) -> impl Iterator<Item = usize> + use<'a> {
        let length = f64::from(self.sides(frame).0) * frame.cell_m;
        let count = f64::from(self.bridges);
        let middles: Vec<f64> = (0..self.bridges).map(|number| length * (f64::from(number) + 0.5) / count).collect();
        // A bridge is a cell wide at least.
        let half = (0.5 * self.bridge_m).max(0.5 * frame.cell_m);
        let runs = self.runs;
        course.cells.iter().copied().filter(move |&index| {
            let centre = frame.centre(frame.cell(index));
            let along = if runs == Runs::SouthNorth { centre.y } else { centre.x };
            middles.iter().any(|middle| (along - middle).abs() <= half)
        })
    }
}

impl Road {
    fn lay(&self, ground: &mut [u8], frame: &FieldFrame, rng: &mut impl Rng) {
        let points: Vec<DVec2> = if self.points_m.is_empty() {
            // Drawn before the direction, and always both, so that either direction takes as many numbers.
            let [from, to] = [rng.random::<f64>(), rng.random::<f64>()];
            let width = frame.width_m();
            let height = frame.height_m();
            if rng.random::<bool>() {
                vec![DVec2::new(0.0, from * height), DVec2::new(width, to * height)]
            } else {
                vec![DVec2::new(from * width, 0.0), DVec2::new(to * width, height)]
            }
        } else {
            self.points_m.iter().copied().map(DVec2::from).collect()
        };
        for piece in points.windows(2) {
            let [start, end] = [piece[0], piece[1]];
            let way = end - start;
            // Two equal points have no direction; the piece is then a disc.
            let length = way.length().max(f64::MIN_POSITIVE);
            let direction = way / length;
            // Half of the width, or what makes a line of cells that meet at their sides.
            let thin = 0.5 * frame.cell_m * (direction.x.abs() + direction.y.abs());
            let half = (0.5 * self.width_m).max(thin);
            for (index, fuel) in ground.iter_mut().enumerate() {
                let offset = frame.centre(frame.cell(index)) - start;
                let along = offset.dot(direction).clamp(0.0, length);
                if (offset - direction * along).length() <= half {
                    *fuel = BARE;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: FieldFrame = FieldFrame { cols: 60, rows: 50, cell_m: 5.0 };

    fn free(centres: &[[f64; 2]]) -> RiverExclusion {
        RiverExclusion { centres: centres.iter().copied().map(DVec2::from).collect(), clearance_m: 10.0 }
    }

    fn laid(patches: &[Patches], river: Option<&River>, roads: &[Road], seed: u64) -> Vec<u8> {
        let mut ground = vec![102; FRAME.cell_count()];
        assert!(Features { patches, river, roads }.lay(&mut ground, &FRAME, seed, &free(&[[20.0, 20.0]])));
        ground
    }

    fn count(ground: &[u8], fuel: u8) -> usize {
        ground.iter().filter(|&&found| found == fuel).count()
    }

    /// Says whether a fire that spreads to eight neighbours gets from the west edge to the east edge.
    fn burns_across(ground: &[u8], blocks: impl Fn(u8) -> bool) -> bool {
        let mut reached: Vec<bool> = (0..FRAME.cell_count()).map(|index| FRAME.cell(index).col == 0).collect();
        let mut open: Vec<usize> =
            (0..FRAME.cell_count()).filter(|&index| reached[index] && !blocks(ground[index])).collect();
        while let Some(index) = open.pop() {
            for (cols, rows) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
                let Some(near) = FRAME.offset(FRAME.cell(index), cols, rows).map(|cell| FRAME.index(cell)) else {
                    continue;
                };
                if !reached[near] && !blocks(ground[near]) {
                    reached[near] = true;
                    open.push(near);
                }
            }
        }
        (0..FRAME.cell_count()).any(|index| reached[index] && FRAME.cell(index).col == FRAME.cols - 1)
    }

    #[test]
    fn patches_cover_their_share_and_the_same_for_a_seed() {
        for share in [0.0, 0.1, 0.35, 0.9] {
            let patches = [Patches { fuel: FuelName::from_code("SH5"), share, size_m: 40.0 }];
            let ground = laid(&patches, None, &[], 1);
            assert_eq!(count(&ground, 145), (share * FRAME.cell_count() as f64).round() as usize);
            assert_eq!(ground, laid(&patches, None, &[], 1));
            assert!(share == 0.0 || ground != laid(&patches, None, &[], 2));
        }
    }

    #[test]
    fn rivers_stop_fire_bridges_do_not_burn_and_trucks_cross_them_only() {
        for seed in 0..20 {
            for (runs, width_m) in [(Runs::SouthNorth, 3.0), (Runs::SouthNorth, 20.0)] {
                let dry = River { bridges: 0, runs, width_m, ..River::default() };
                let water = laid(&[], Some(&dry), &[], seed);
                assert!(!burns_across(&water, |fuel| fuel == WATER), "seed {seed}, width {width_m}");
                let river = River { bridges: 2, ..dry };
                let ground = laid(&[], Some(&river), &[], seed);
                assert!(!burns_across(&ground, |fuel| fuel != 102), "bridges do not burn");
                assert!(burns_across(&ground, |fuel| fuel == WATER), "trucks get over");
                assert_eq!(count(&ground, WATER) + count(&ground, BARE), count(&water, WATER));
            }
        }
    }

    #[test]
    fn rivers_keep_away_from_starts_or_are_refused() {
        let river = River::default();
        let features = Features { patches: &[], river: Some(&river), roads: &[] };
        for seed in 0..20 {
            let start = [150.0, 100.0];
            let mut ground = vec![102; FRAME.cell_count()];
            assert!(features.lay(&mut ground, &FRAME, seed, &free(&[start])));
            for index in (0..FRAME.cell_count()).filter(|&index| ground[index] == WATER) {
                assert!((FRAME.centre(FRAME.cell(index)) - DVec2::from(start)).length() > 10.0);
            }
        }
        let everywhere = RiverExclusion { centres: vec![DVec2::new(150.0, 125.0)], clearance_m: 500.0 };
        assert!(!features.lay(&mut vec![102; FRAME.cell_count()], &FRAME, 1, &everywhere));
    }

    #[test]
    fn roads_are_lines_without_gaps_and_bridge_the_river() {
        for seed in 0..20 {
            let road = Road { width_m: 1.0, points_m: vec![[150.0, -10.0], [170.0, 120.0], [120.0, 260.0]] };
            let ground = laid(&[], None, &[road], seed);
            assert!(!burns_across(&ground, |fuel| fuel == BARE));
            let river = River { bridges: 0, ..River::default() };
            let across = Road { width_m: 10.0, points_m: vec![[0.0, 125.0], [300.0, 125.0]] };
            let ground = laid(&[], Some(&river), &[across], seed);
            assert!(burns_across(&ground, |fuel| fuel == WATER));
        }
    }

    #[test]
    fn a_feature_more_moves_no_other() {
        let patches = [Patches { fuel: FuelName::from_code("SH5"), share: 0.2, size_m: 40.0 }];
        let alone = laid(&patches, None, &[], 7);
        let with_river = laid(&patches, Some(&River::default()), &[], 7);
        let moved = alone.iter().zip(&with_river).filter(|(one, other)| one != other && ![WATER, BARE].contains(other));
        assert_eq!(moved.count(), 0);
    }

    #[test]
    fn hills_are_highest_at_their_top() {
        let hill = Hill { height_m: 50.0, radius_m: 40.0, at_m: Some([102.5, 77.5]) };
        let heights = hill_elevations(&[hill], &FRAME, 1);
        let top = FRAME.index(Cell { col: 20, row: 15 });
        assert_eq!(heights[top], 50.0);
        assert!(heights.iter().enumerate().all(|(index, &height)| index == top || height < 50.0));
        let beside = FRAME.index(Cell { col: 28, row: 15 });
        assert!((f64::from(heights[beside]) - 50.0 * ops::exp(-0.5)).abs() < 1e-5, "a standard deviation aside");
    }
}
