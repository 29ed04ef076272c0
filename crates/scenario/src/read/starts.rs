//! Starts that a scenario with a map leaves out.
//!
//! The default starts lie in the default field, of 250 m. Where a map is too small for one of them, the agent starts at the
//! same share of the map's width and height, as far inside as its body needs; a Wumpus in the middle of that cell. If a
//! bush is there, the run moves it to the nearest free place, as it does with every start.

use crate::{Field, StartPose, Unimog, Wumpus};
use wildfire_base::geometry::{DVec2, FieldFrame, Pose};

/// The room between a body and the edge of the field where it is moved inside, metres.
const ROOM_M: f64 = 0.01;

/// An agent whose start can be placed.
pub(crate) trait Starting {
    /// Says whether its body is inside the field at its start.
    fn start_fits(&self, frame: &FieldFrame) -> bool;

    /// Starts it at the default place, or at the same share of a field that is too small for that.
    fn start_within(&mut self, frame: &FieldFrame);
}

impl Starting for Unimog {
    fn start_fits(&self, frame: &FieldFrame) -> bool {
        fits(DVec2::ZERO, &self.vehicle.footprint(self.start.pose()).corners(), frame)
    }

    fn start_within(&mut self, frame: &FieldFrame) {
        let default = StartPose::default();
        let corners = self.vehicle.footprint(Pose::new(0.0, 0.0, default.heading_deg.to_radians())).corners();
        let [x_m, y_m] = placed([default.x_m, default.y_m], &corners, frame).to_array();
        self.start = StartPose { x_m, y_m, ..default };
    }
}

impl Starting for Wumpus {
    fn start_fits(&self, frame: &FieldFrame) -> bool {
        let half = DVec2::splat(0.5 * self.size_m);
        fits(self.start_centre(), &[-half, half], frame)
    }

    fn start_within(&mut self, frame: &FieldFrame) {
        let half = 0.5 * self.size_m;
        let corners = [DVec2::splat(-half), DVec2::splat(half)];
        let default = Self::default().start_m;
        let place = placed(default, &corners, frame);
        let centre =
            frame.cell_at(place).map(|cell| frame.centre(cell)).filter(|&centre| fits(centre, &corners, frame));
        let is_moved = place != DVec2::from(default);
        self.start_m = centre.filter(|_| is_moved).unwrap_or(place).to_array();
    }
}

fn fits(place: DVec2, corners: &[DVec2], frame: &FieldFrame) -> bool {
    let size = DVec2::new(frame.width_m(), frame.height_m());
    corners.iter().all(|&corner| (place + corner).cmpge(DVec2::ZERO).all() && (place + corner).cmple(size).all())
}

/// The default place if a body with these corners about it fits there, else the same share of the field.
fn placed(default: [f64; 2], corners: &[DVec2], frame: &FieldFrame) -> DVec2 {
    let default = DVec2::from(default);
    if fits(default, corners, frame) {
        return default;
    }
    let size = DVec2::new(frame.width_m(), frame.height_m());
    let low = corners.iter().copied().fold(DVec2::ZERO, DVec2::min);
    let high = corners.iter().copied().fold(DVec2::ZERO, DVec2::max);
    let share = default / Field::default().size_m;
    // Of a body that is larger than the field nothing can be said here: it is refused where all starts are checked.
    (share * size).min(size - high - ROOM_M).max(ROOM_M - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(cols: u16, rows: u16, cell_m: f64) -> FieldFrame {
        FieldFrame { cols, rows, cell_m }
    }

    #[test]
    fn default_starts_stay_where_they_fit() {
        for frame in [frame(50, 50, 5.0), frame(900, 300, 1.0)] {
            let mut truck = Unimog::default();
            let mut wumpus = Wumpus::default();
            truck.start_within(&frame);
            wumpus.start_within(&frame);
            assert_eq!((truck.start, wumpus.start_m), (StartPose::default(), Wumpus::default().start_m));
        }
    }

    #[test]
    fn on_small_maps_bodies_start_inside_at_the_same_share() {
        for (cols, rows, cell_m) in [(20, 20, 5.0), (30, 4, 5.0), (200, 90, 0.3), (13, 77, 1.0), (2, 8, 5.0)] {
            let frame = frame(cols, rows, cell_m);
            let mut truck = Unimog::default();
            let mut wumpus = Wumpus::default();
            truck.start_within(&frame);
            wumpus.start_within(&frame);
            assert!(truck.start_fits(&frame), "{frame:?}: {:?}", truck.start);
            assert!(wumpus.start_fits(&frame), "{frame:?}: {:?}", wumpus.start_m);
        }
        let mut wumpus = Wumpus::default();
        wumpus.start_within(&frame(20, 20, 5.0));
        assert_eq!(wumpus.start_m, [82.5, 82.5]);
    }
}
