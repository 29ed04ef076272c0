//! The projection from places above a map to places in the picture.

use crate::canvas::Point;
use crate::marks::to_f32;
use wildfire_base::geometry::ops;

/// The angle of the view from looking north, in degrees: the viewer stands south-east of the map.
const TURN_DEG: f64 = 30.0;
/// The angle at which the viewer looks down, in degrees.
const PITCH_DEG: f64 = 42.0;
/// The height of the highest value, for a longer side of 1.
const RELIEF: f32 = 0.36;
/// A map's shorter side is drawn at least this long, for a longer side of 1.
const NARROWEST: f32 = 0.25;
/// The level of the ground under the map; the lowest value is at 0, the highest at 1.
pub const GROUND: f32 = -0.06;

/// A place in space: along the columns and along the rows, 0 to 1 from edge to edge of the map, and its level, 0 to 1
/// from the lowest value to the highest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpacePoint {
    pub x: f32,
    pub y: f32,
    pub level: f32,
}

/// A parallel projection: lines that are parallel in space are so in the picture, and what is nearer to the viewer is
/// the same for the whole map, so that rows and columns can be drawn from back to front.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceCamera {
    /// Lengths of the map's sides along columns and rows, the longer one 1.
    sides: Point,
    turn: Point,
    pitch: Point,
    /// Pixels for a length of 1.
    scale: f32,
    /// The place of the origin in the picture.
    origin: Point,
}

/// A camera, and the size of the part of the box that it uses.
pub struct FittedCamera {
    pub camera: SurfaceCamera,
    pub size: Point,
}

impl SurfaceCamera {
    /// Fits a map of that many rows and columns into a box.
    pub fn fit((rows, cols): (usize, usize), (width, height): Point) -> FittedCamera {
        let longer = rows.max(cols).max(1) as f32;
        let mut camera = Self {
            sides: ((cols as f32 / longer).max(NARROWEST), (rows as f32 / longer).max(NARROWEST)),
            turn: sin_cos(TURN_DEG),
            pitch: sin_cos(PITCH_DEG),
            scale: 1.0,
            origin: (0.0, 0.0),
        };
        // The four corners that are farthest left, right, up and down.
        let left = camera.at(0.0, 1.0, 0.0).0;
        let right = camera.at(1.0, 0.0, 0.0).0;
        let top = camera.at(0.0, 0.0, 1.0).1;
        let bottom = camera.at(1.0, 1.0, GROUND).1;
        camera.scale = (width / (right - left)).min(height / (bottom - top));
        camera.origin = (-left * camera.scale, -top * camera.scale);
        let size = ((right - left) * camera.scale, (bottom - top) * camera.scale);
        FittedCamera { camera, size }
    }

    /// The same view, shifted in the picture.
    pub fn moved(self, (right, down): Point) -> Self {
        Self { origin: (self.origin.0 + right, self.origin.1 + down), ..self }
    }

    /// The same view, all lengths in the picture multiplied.
    pub fn enlarged(self, factor: f32) -> Self {
        let origin = (self.origin.0 * factor, self.origin.1 * factor);
        Self { origin, scale: self.scale * factor, ..self }
    }

    pub fn at(&self, x: f32, y: f32, level: f32) -> Point {
        let (x, y) = (x * self.sides.0, y * self.sides.1);
        let (sin_turn, cos_turn) = self.turn;
        let (sin_pitch, cos_pitch) = self.pitch;
        let right = x * cos_turn - y * sin_turn;
        let nearer = x * sin_turn + y * cos_turn;
        let down = nearer * sin_pitch - level * RELIEF * cos_pitch;
        (self.origin.0 + right * self.scale, self.origin.1 + down * self.scale)
    }

    pub fn spot(&self, spot: SpacePoint) -> Point {
        self.at(spot.x, spot.y, spot.level)
    }

    /// The spots on the way from a spot to the viewer, until they are above everything or off the map, `step` apart
    /// where the longer side is 1.
    pub fn towards_viewer(&self, from: SpacePoint, step: f32) -> impl Iterator<Item = SpacePoint> {
        let (sin_turn, cos_turn) = self.turn;
        let rise = step * self.pitch.0 / self.pitch.1 / RELIEF;
        let right = step * sin_turn / self.sides.0;
        let down = step * cos_turn / self.sides.1;
        let spot = move |steps: u16| {
            let steps = f32::from(steps);
            SpacePoint { x: from.x + steps * right, y: from.y + steps * down, level: from.level + steps * rise }
        };
        (1..u16::MAX).map(spot).take_while(|spot| spot.x < 1.0 && spot.y < 1.0 && spot.level < 1.0)
    }
}

fn sin_cos(degrees: f64) -> (f32, f32) {
    let (sin, cos) = ops::sin_cos(degrees.to_radians());
    (to_f32(sin), to_f32(cos))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_box_fits() {
        for size in [(14, 20), (1, 500), (500, 1), (1, 1), (242, 242)] {
            let FittedCamera { camera, size: (width, height) } = SurfaceCamera::fit(size, (800.0, 600.0));
            assert!(width <= 800.1 && height <= 600.1);
            for (x, y) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
                for level in [GROUND, 1.0] {
                    let (right, down) = camera.at(x, y, level);
                    assert!((-0.1..=width + 0.1).contains(&right) && (-0.1..=height + 0.1).contains(&down), "{size:?}");
                }
            }
        }
    }

    #[test]
    fn spots_towards_the_viewer_fall_on_one_pixel() {
        let camera = SurfaceCamera::fit((30, 50), (800.0, 600.0)).camera;
        let from = SpacePoint { x: 0.1, y: 0.2, level: 0.0 };
        let at = camera.spot(from);
        let mut count = 0;
        for spot in camera.towards_viewer(from, 0.01) {
            let seen = camera.spot(spot);
            assert!((seen.0 - at.0).abs() < 0.01 && (seen.1 - at.1).abs() < 0.01);
            count += 1;
        }
        assert!(count > 10);
    }
}
