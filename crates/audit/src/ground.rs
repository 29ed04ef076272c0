//! Speeds of trucks that ground slows: no faster than the fastest ground close by allows.

use super::driven::DrivenLegs;
use super::{Violation, ViolationKind};
use wildfire_base::geometry::{DVec2, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, SpeedLimits};
use wildfire_timeline::Setting;

/// Places that are looked at on the length of a cell's side.
const LOOKS_A_CELL: f64 = 10.0;

/// The distance to ground that counts, in cells: where a drive passes from one kind to another it may be a little early or
/// late.
const CLOSE: f64 = 0.5;

/// Share of a limit that is noise.
const NOISE: f64 = 1e-6;

/// Holds the speeds of a truck's drives against the ground, if that slows it; returns the first violation.
pub fn audit_ground(setting: &Setting, driven: &DrivenLegs<'_>, limits: Option<SpeedLimits>) -> Result<(), Violation> {
    // Trucks that no ground slows have no shares, and early recordings no limits.
    let shares = setting.ground_shares.iter().find(|(truck, _)| *truck == driven.id).map(|(_, shares)| shares);
    let (Some(shares), Some(spread), Some(limits)) = (shares, &setting.spread, limits) else { return Ok(()) };
    let frame = setting.frame;
    let landscape = spread.landscape();
    let share_near = |place: DVec2| {
        let [low, high] = [place - CLOSE * frame.cell_m, place + CLOSE * frame.cell_m].map(|at| clamped(&frame, at));
        let cells =
            (low[1]..=high[1]).flat_map(|row| (low[0]..=high[0]).map(move |col| row * usize::from(frame.cols) + col));
        cells.map(|cell| shares[usize::from(landscape.fuel[cell])]).fold(0.0, f64::max)
    };
    for leg in driven.legs() {
        let mut elapsed_s = 0.0;
        for (start, piece) in leg.pieces_with_starts() {
            if let Piece::Drive { segment, speed_mps, acceleration_mps2 } = *piece {
                let limit_mps = if segment.is_reverse() { limits.reverse_mps } else { limits.forward_mps };
                // Some looks a cell, bounded for lengths that no drive has.
                let looks = (segment.length_m.abs() / frame.cell_m * LOOKS_A_CELL).ceil().clamp(1.0, 1e6) as u32;
                for look in 0..=looks {
                    let travelled_m = segment.length_m * f64::from(look) / f64::from(looks);
                    let place = segment.pose_at(start, travelled_m).position();
                    // The square of the speed is linear along the way.
                    let squared = speed_mps * speed_mps + 2.0 * acceleration_mps2 * travelled_m.abs();
                    // Rounding may take it below 0 where the truck comes to a stop.
                    let found_mps = squared.max(0.0).sqrt();
                    // The fastest of the cells nearby, as a pose on their border may count as either.
                    let limit_mps = limit_mps * share_near(place);
                    if found_mps > limit_mps * (1.0 + NOISE) {
                        let time = leg.start_time() + SimTime::from_seconds(elapsed_s);
                        let kind = ViolationKind::Speed { found_mps, limit_mps };
                        return Err(Violation { time, agent: Some(driven.id), place, kind });
                    }
                }
            }
            elapsed_s += piece.duration_s();
        }
    }
    Ok(())
}

/// Returns column and row of the cell under a place, or of the nearest on the field.
fn clamped(frame: &FieldFrame, place: DVec2) -> [usize; 2] {
    let index = |at_m: f64, cells: u16| (at_m / frame.cell_m).floor().clamp(0.0, f64::from(cells) - 1.0) as usize;
    [index(place.x, frame.cols), index(place.y, frame.rows)]
}
