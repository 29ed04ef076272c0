//! When fire comes to a cell over ground that is all alike, without steps from cell to cell.
//!
//! In one fuel, on a plane and in one weather fire runs straight (its characteristics are lines), and what comes to the
//! middle of a square came through its rim. So the time there is the least, over all points of the rim, of the time there
//! and that of the ellipse for the way to the middle (Bellman's principle). The fire model knows nothing of this: its steps
//! lead over a few cells in a few directions, and where these do not suit the fire, it is late by as much at any cell size.
//! This check shares no directions with it and is bounded both ways. It is as coarse as cells are, so that it finds what is
//! wrong in kind, where [`super::arrival`] finds a nanosecond.

use wildfire_base::geometry::{Cell, DVec2};
use wildfire_base::time::SimTime;

use super::arrival::{Arrivals, FireHistory, NEVER, cells_within};

/// Half the side of a square, in cells.
const HALF_SIDE: i32 = 12;

/// Parts of the rim between two cells.
const PARTS: u32 = 8;

/// Tolerance of arrivals against straight fire, as a fraction of the way's time. Half of it is seen in fires of all
/// shapes; fires eight times as long as wide in 32 directions are late by a third.
const TOLERANCE: f64 = 0.1;

/// Cells of a run that are looked at, at most.
pub const MAX_SAMPLES: usize = 2000;

/// Deviation of a cell's time from straight fire, as fractions of the way's time from the rim; both are negative
/// where it is between the bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightArrival {
    /// The time of straight fire, if times on the rim between cells are linear: the latest that it can be.
    pub due: SimTime,
    pub late: f64,
    pub early: f64,
}

impl StraightArrival {
    pub fn is_kept(&self) -> bool {
        self.late <= TOLERANCE && self.early <= TOLERANCE
    }
}

/// Returns the time of straight fire at a cell that caught fire at a time; `None` where ground, weather or what happened
/// there make fire bend, or where no fire came through the rim.
pub fn straight_arrival(
    arrivals: &Arrivals,
    history: &FireHistory,
    cell: Cell,
    arrived: SimTime,
) -> Option<StraightArrival> {
    let frame = arrivals.frame();
    let rim = rim();
    let time_at = |(cols, rows): (i32, i32)| {
        let near = frame.offset(cell, cols, rows)?;
        Some(history.first_front(frame.index(near)).filter(|&time| time < arrived.as_nanos()))
    };
    // If the corners are on the field, so is all of the rim.
    rim.iter().step_by(2 * HALF_SIDE as usize).try_for_each(|&corner| time_at(corner).map(|_| ()))?;
    let mut first = NEVER;
    for near in cells_within(HALF_SIDE, frame, cell) {
        let index = frame.index(near);
        // The check holds where fire spreads alike all around and nobody interferes.
        if arrivals.fuel_at(index) != arrivals.fuel_at(frame.index(cell)) || !history.is_front_or_unburned(index) {
            return None;
        }
        first = first.min(history.first_front(index).unwrap_or(NEVER));
    }
    let ellipse = arrivals.plane_ellipse(frame.index(cell), SimTime::from_nanos(first), arrived)?;
    // In seconds before the arrival, so that differences of whole nanoseconds are exact.
    let [mut latest, mut soonest] = [Bound::NONE; 2];
    for (place, &one) in rim.iter().enumerate() {
        let other = rim[(place + 1) % rim.len()];
        let ends = [one, other].map(|(cols, rows)| DVec2::new(f64::from(cols), f64::from(rows)) * frame.cell_m);
        let times = [time_at(one)?, time_at(other)?];
        let left = times.map(|time| time.map_or(0.0, |time| (arrived.as_nanos() - time) as f64 * 1e-9));
        for part in 0..=PARTS {
            let share = f64::from(part) / f64::from(PARTS);
            // Points between the rim's cells too, where a front may have come through.
            let point = ends[0] + share * (ends[1] - ends[0]);
            let seconds = ellipse.travel_s(-point);
            // Fire between two cells comes to each of them as it does to any: it was there no sooner than this.
            let at_most = [0, 1].map(|end| left[end] + ellipse.travel_s(ends[end] - point));
            soonest.lower(seconds - at_most[0].min(at_most[1]), seconds);
            if times[0].is_some() && times[1].is_some() {
                latest.lower(seconds - (left[0] + share * (left[1] - left[0])), seconds);
            }
        }
    }
    let due = SimTime::from_seconds((arrived.as_seconds() + latest.after).max(0.0));
    let [late, early] = [-latest.after / latest.seconds, soonest.after / soonest.seconds];
    latest.after.is_finite().then_some(StraightArrival { due, late, early })
}

/// The least time over points of the rim, in seconds after the arrival, and that of the way from there.
#[derive(Clone, Copy)]
struct Bound {
    after: f64,
    seconds: f64,
}

impl Bound {
    const NONE: Self = Self { after: f64::INFINITY, seconds: 1.0 };

    fn lower(&mut self, after: f64, seconds: f64) {
        if after < self.after {
            *self = Self { after, seconds };
        }
    }
}

/// The offsets of the cells on the rim of a square, one beside the other, from a corner on.
fn rim() -> Vec<(i32, i32)> {
    let side = -HALF_SIDE..HALF_SIDE;
    let south = side.clone().map(|along| (along, -HALF_SIDE));
    let east = side.clone().map(|along| (HALF_SIDE, along));
    let north = side.clone().map(|along| (-along, HALF_SIDE));
    let west = side.map(|along| (-HALF_SIDE, -along));
    south.chain(east).chain(north).chain(west).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::arrival::CellChange;
    use super::*;
    use wildfire_base::geometry::{FieldFrame, compass};
    use wildfire_fire::lone::LoneFire;
    use wildfire_fire::models::{Neighbours, RothermelRules};
    use wildfire_fire::surface::{FuelMoisture, SurfaceOptions, WindLimit};
    use wildfire_fire::{Landscape, Relief, Weather};

    const FRAME: FieldFrame = FieldFrame { cols: 110, rows: 90, cell_m: 10.0 };

    /// Burns a field in a wind, and returns the greatest earliness and lateness of its cells if all times are stretched
    /// by each of some factors.
    fn range<const N: usize>(
        neighbours: Neighbours,
        wind_mps: DVec2,
        gradient: DVec2,
        factors: [f64; N],
    ) -> [[f64; 2]; N] {
        let options = SurfaceOptions { wind_limit: WindLimit::None, ..SurfaceOptions::default() };
        let rules = RothermelRules { options, neighbours, ..RothermelRules::default() };
        let landscape = Landscape { relief: Relief::Plane(gradient), ..Landscape::uniform(FRAME, 145) };
        let weather = Weather::constant(wind_mps, FuelMoisture::default());
        let source = Cell { col: 40, row: 45 };
        let ignitions = [(SimTime::ZERO, source)];
        let mut fire = LoneFire::new(Arc::new(landscape.clone()), Arc::new(weather.clone()), rules, &ignitions);
        fire.burn_until(SimTime::from_seconds(1e7));
        let arrivals = Arrivals::new(&landscape, &weather, rules);
        let cells = || (0..FRAME.cell_count()).map(|index| FRAME.cell(index));
        factors.map(|factor| {
            let time = |cell| SimTime::from_seconds(factor * fire.arrival(cell).expect("all burns").as_seconds());
            let mut history = FireHistory::new(FRAME.cell_count(), false, arrivals.reach());
            for cell in cells() {
                history.add(FRAME.index(cell), time(cell), CellChange::Ignited { is_source: cell == source });
            }
            let found: Vec<_> =
                cells().filter_map(|cell| straight_arrival(&arrivals, &history, cell, time(cell))).collect();
            assert!(found.len() > 500, "{}", found.len());
            let greatest = |of: fn(&StraightArrival) -> f64| found.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            [greatest(|straight| straight.early), greatest(|straight| straight.late)]
        })
    }

    #[test]
    fn fires_of_all_shapes_run_straight_and_slower_or_faster_ones_are_found() {
        for neighbours in [Neighbours::ThirtyTwo, Neighbours::Eight] {
            for speed in [0.0, 8.0, 22.0] {
                for (azimuth, gradient) in [(83.0, DVec2::ZERO), (61.0, DVec2::new(0.4, -0.3))] {
                    let wind = compass::unit_toward(azimuth) * speed;
                    let [proper, slow, fast] = range(neighbours, wind, gradient, [1.0, 1.2, 0.8]);
                    println!(
                        "{neighbours:?}, {speed:4.1} m/s to {azimuth}: {proper:.4?}, {:.4}, {:.4}",
                        slow[1], fast[0]
                    );
                    assert!(proper[0].max(proper[1]) < TOLERANCE / 2.0 + 1e-3);
                    assert!(slow[1] > TOLERANCE);
                    // A narrow fire may slip through between two cells, however fast it is.
                    assert!(fast[0] > TOLERANCE || speed > 20.0);
                }
            }
        }
    }
}
