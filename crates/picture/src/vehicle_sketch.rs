//! The kinematic model of a vehicle with Ackermann steering, drawn with its dimensions.
//!
//! The model is S. LaValle, "Planning Algorithms" (2006), section 13.1.2.1: the middle of the rear axle at (x, y), the
//! heading, the speed v, and the steering angle of a wheel in the middle of the front axle.

use glam::DVec2;

use crate::canvas::Point;
use crate::charts::Drawing;
use crate::colours::{FAINT_INK, INK, NOTE_INK, PATH, Rgb, UNIMOG};
use crate::marks::to_f32;
use crate::text::Align;
use wildfire_base::document::number::short;
use wildfire_base::geometry::ops;
use wildfire_base::vehicle::Dimensions;

const WIDTH: f32 = 640.0;
const MARGIN: f32 = 24.0;
/// The room for the vehicle and its turning centre, in units; equations stand to the right of it.
const ROOM: f32 = 440.0;
const EQUATIONS: f32 = 440.0;
/// Heights of capitals.
const TITLE: f32 = 13.0;
const TEXT: f32 = 10.0;
/// The heading that is drawn, in radians.
const HEADING: f64 = std::f64::consts::PI / 9.0;
/// A turning centre that is farther away than this many lengths of the body is left out.
const FARTHEST_CENTRE: f64 = 4.0;
/// Wheels, in widths of the body.
const WHEEL_LENGTH: f64 = 0.4;
const WHEEL_WIDTH: f64 = 0.13;

/// A sketch in metres, on a sheet in units.
struct VehicleSketch {
    drawing: Drawing,
    /// The place of the middle of the rear axle on the sheet.
    origin: Point,
    /// Units of a metre.
    scale: f64,
}

/// Draws the vehicle at full steering to the left, its turning centre and dimensions, and the equations of its motion.
pub fn draw_vehicle(title: &str, vehicle: &Dimensions) -> Drawing {
    let &Dimensions { length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m, .. } = vehicle;
    // A centre that is far away would leave hardly any room for the vehicle, as all is to scale.
    let has_centre = turning_radius_m <= FARTHEST_CENTRE * length_m;
    let radius_m = if has_centre { turning_radius_m } else { 0.6 * FARTHEST_CENTRE * length_m };
    let steering = vehicle.max_steering_rad();
    let front_m = length_m - rear_overhang_m;
    let step = 0.27 * length_m;
    let below_m = 0.5 * width_m + 2.4 * step;
    let centre = along(0.0, radius_m);
    let corners = [along(-rear_overhang_m, -below_m), along(front_m + 0.5 * length_m, -below_m), centre];
    let ends = [along(front_m + 0.6 * length_m, 0.0), along(-rear_overhang_m - 0.45 * length_m, 0.0)];
    let corners = corners.into_iter().chain(ends);
    let low = corners.clone().reduce(DVec2::min).unwrap_or_default();
    let high = corners.reduce(DVec2::max).unwrap_or_default();
    let scale = f64::from(ROOM) / (high - low).max_element();
    let top = MARGIN + TITLE + MARGIN;
    let origin = (2.0 * MARGIN + to_f32(-low.x * scale), top + to_f32(high.y * scale));
    let height = (top + to_f32((high.y - low.y) * scale) + MARGIN).max(top + 240.0);
    let mut sketch = VehicleSketch { drawing: Drawing::new(WIDTH, height, title), origin, scale };
    sketch.drawing.text(title, (MARGIN, MARGIN + TITLE), Align::Left, TITLE, INK);

    sketch.draw_turn(centre, has_centre, vehicle);
    sketch.draw_body(steering, vehicle);
    sketch.draw_angles(steering, vehicle);
    let side = 0.5 * width_m;
    sketch.dimension([(0.0, -side), (wheelbase_m, -side)], step, &metres("L", wheelbase_m));
    sketch.dimension([(-rear_overhang_m, -side), (0.0, -side)], step, &metres("", rear_overhang_m));
    sketch.dimension([(-rear_overhang_m, -side), (front_m, -side)], 2.0 * step, &metres("length", length_m));
    sketch.dimension([(front_m, -side), (front_m, side)], 0.2 * step, &metres("width", width_m));
    sketch.write_equations(top, steering, vehicle);
    sketch.drawing
}

/// Returns the place so far ahead of the middle of the rear axle and so far to its left, in metres east and north of it.
fn along(ahead_m: f64, left_m: f64) -> DVec2 {
    let (sin, cos) = ops::sin_cos(HEADING);
    DVec2::new(ahead_m * cos - left_m * sin, ahead_m * sin + left_m * cos)
}

/// Returns the place on a circle in a direction, in radians from east.
fn on_circle(centre: DVec2, radius_m: f64, direction: f64) -> DVec2 {
    let (sin, cos) = ops::sin_cos(direction);
    centre + radius_m * DVec2::new(cos, sin)
}

fn metres(name: &str, length_m: f64) -> String {
    if name.is_empty() { format!("{} m", short(length_m)) } else { format!("{name} = {} m", short(length_m)) }
}

impl VehicleSketch {
    fn at(&self, place: DVec2) -> Point {
        (self.origin.0 + to_f32(place.x * self.scale), self.origin.1 - to_f32(place.y * self.scale))
    }

    fn line(&mut self, places: &[DVec2], width: f32, colour: Rgb, dashes: &[f32]) {
        let points = places.iter().map(|&place| self.at(place)).collect();
        self.drawing.dashed(points, width, colour, dashes);
    }

    /// Draws the lines from the axles to the turning centre.
    fn draw_turn(&mut self, centre: DVec2, has_centre: bool, vehicle: &Dimensions) {
        let radius = format!("\u{3c1} = {} m", short(vehicle.turning_radius_m));
        self.line(&[DVec2::ZERO, centre], 1.4, PATH, &[]);
        if has_centre {
            self.line(&[along(vehicle.wheelbase_m, 0.0), centre], 1.0, PATH, &[5.0, 4.0]);
            let (x, y) = self.at(centre);
            self.drawing.rect((x - 3.0, y - 3.0), (x + 3.0, y + 3.0), PATH);
            self.drawing.text("turning centre", (x + 10.0, y + 4.0), Align::Left, TEXT, INK);
        }
        let (x, y) = self.at(0.5 * centre);
        self.drawing.text(&radius, (x - 10.0, y), Align::Right, TEXT, INK);
    }

    /// Draws the outline, both axles, and the wheels, of which the front ones are turned.
    fn draw_body(&mut self, steering: f64, vehicle: &Dimensions) {
        let &Dimensions { length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m, .. } = vehicle;
        let side = 0.5 * width_m;
        let back = -rear_overhang_m;
        let front = length_m - rear_overhang_m;
        let outline = [(back, side), (front, side), (front, -side), (back, -side), (back, side)];
        self.line(&outline.map(|(ahead, left)| along(ahead, left)), 2.0, UNIMOG, &[]);
        let track = side - 0.5 * WHEEL_WIDTH * width_m;
        for ahead in [0.0, wheelbase_m] {
            self.line(&[along(ahead, -track), along(ahead, track)], 1.4, INK, &[]);
        }
        for left in [-track, track] {
            self.draw_wheel(along(0.0, left), 0.0, width_m, INK);
            // Each wheel is square to the line to the turning centre.
            let angle = ops::atan2(wheelbase_m, turning_radius_m - left);
            self.draw_wheel(along(wheelbase_m, left), angle, width_m, INK);
        }
        self.draw_wheel(along(wheelbase_m, 0.0), steering, width_m, NOTE_INK);
        let (x, y) = self.at(DVec2::ZERO);
        self.drawing.rect((x - 3.0, y - 3.0), (x + 3.0, y + 3.0), INK);
        let behind = along(-rear_overhang_m - 0.2 * length_m, 0.0);
        self.line(&[DVec2::ZERO, behind], 1.0, NOTE_INK, &[2.0, 3.0]);
        let (x, y) = self.at(behind);
        self.drawing.text("(x, y)", (x - 4.0, y + 0.5 * TEXT), Align::Right, TEXT, INK);
    }

    /// Draws a wheel, turned to the left by an angle.
    fn draw_wheel(&mut self, middle: DVec2, turned: f64, width_m: f64, colour: Rgb) {
        let (sin, cos) = ops::sin_cos(HEADING + turned);
        let ahead = 0.5 * WHEEL_LENGTH * width_m * DVec2::new(cos, sin);
        let left = 0.5 * WHEEL_WIDTH * width_m * DVec2::new(-sin, cos);
        let corners = [middle + ahead + left, middle + ahead - left, middle - ahead - left, middle - ahead + left];
        let corners = corners.iter().map(|&corner| self.at(corner)).collect();
        self.drawing.area(corners, colour, 1.0);
    }

    /// Draws the heading at the rear axle and the steering angle at the front axle.
    fn draw_angles(&mut self, steering: f64, vehicle: &Dimensions) {
        let reach = 0.55 * vehicle.length_m;
        let front = along(vehicle.wheelbase_m, 0.0);
        let east = DVec2::new(vehicle.wheelbase_m, 0.0);
        self.line(&[DVec2::ZERO, east], 1.0, NOTE_INK, &[2.0, 3.0]);
        self.line(&[DVec2::ZERO, along(vehicle.wheelbase_m + 1.6 * reach, 0.0)], 1.0, NOTE_INK, &[2.0, 3.0]);
        let (sin, cos) = ops::sin_cos(HEADING + steering);
        self.line(&[front, front + 1.5 * reach * DVec2::new(cos, sin)], 1.2, INK, &[]);
        self.draw_arc(DVec2::ZERO, 0.6 * east.x, [0.0, HEADING], "\u{3b8}");
        self.draw_arc(front, 1.35 * reach, [HEADING, HEADING + steering], "\u{3c6}");
    }

    fn draw_arc(&mut self, centre: DVec2, radius_m: f64, [from, to]: [f64; 2], name: &str) {
        let arc: Vec<DVec2> =
            (0..=16).map(|step| on_circle(centre, radius_m, from + f64::from(step) / 16.0 * (to - from))).collect();
        let (x, y) = self.at(on_circle(centre, radius_m + 12.0 / self.scale, 0.5 * (from + to)));
        self.line(&arc, 1.2, INK, &[]);
        self.drawing.text(name, (x, y + 0.5 * TEXT), Align::Centre, TEXT, INK);
    }

    /// Draws a length between two places beside the body, moved away from it to the right, or ahead of the front.
    fn dimension(&mut self, ends: [(f64, f64); 2], away_m: f64, text: &str) {
        let is_across = ends[0].0 == ends[1].0;
        let moved =
            ends.map(|(ahead, left)| if is_across { along(ahead + away_m, left) } else { along(ahead, left - away_m) });
        for ((ahead, left), end) in ends.into_iter().zip(moved) {
            self.line(&[along(ahead, left), end], 0.8, FAINT_INK, &[]);
        }
        self.line(&moved, 1.0, INK, &[]);
        for (end, other) in [(moved[0], moved[1]), (moved[1], moved[0])] {
            let back = (other - end).normalize() * (7.0 / self.scale);
            let tip = [end, end + back + 0.35 * back.perp(), end + back - 0.35 * back.perp()];
            let tip = tip.iter().map(|&corner| self.at(corner)).collect();
            self.drawing.area(tip, INK, 1.0);
        }
        // A length across is named at its end, where nothing else is drawn.
        let (x, y) = self.at(if is_across { moved[0] } else { 0.5 * (moved[0] + moved[1]) });
        self.drawing.text(text, (x + 8.0, y + 1.4 * TEXT), Align::Left, TEXT, INK);
    }

    fn write_equations(&mut self, top: f32, steering: f64, vehicle: &Dimensions) {
        let angle_deg = (steering.to_degrees() * 100.0).round() / 100.0;
        let mut lines = vec![
            "dx/dt = v cos \u{3b8}".to_owned(),
            "dy/dt = v sin \u{3b8}".to_owned(),
            "d\u{3b8}/dt = (v / L) tan \u{3c6}".to_owned(),
            String::new(),
            "tan \u{3c6} = L / \u{3c1} at full steering:".to_owned(),
            format!("\u{3c6} = {}\u{b0}", short(angle_deg)),
        ];
        lines.extend(vehicle.steering_rate_deg_s.map(|rate| format!("d\u{3c6}/dt up to {}\u{b0}/s", short(rate))));
        let mut y = top + TEXT;
        for line in lines {
            self.drawing.text(&line, (EQUATIONS, y), Align::Left, TEXT, INK);
            y += 2.0 * TEXT;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dimension_is_written_and_all_lies_on_the_sheet() {
        let long = Dimensions { turning_radius_m: 500.0, ..Dimensions::default() };
        for vehicle in [Dimensions::default(), long] {
            let drawing = draw_vehicle("truck", &vehicle);
            let texts = drawing.texts().collect::<Vec<_>>().join("|");
            for length_m in [vehicle.wheelbase_m, vehicle.length_m, vehicle.width_m, vehicle.turning_radius_m] {
                assert!(texts.contains(&format!("= {} m", short(length_m))), "{length_m} in {texts}");
            }
            let is_on = |(x, y): Point| (0.0..=drawing.width).contains(&x) && (0.0..=drawing.height).contains(&y);
            assert!(drawing.points().all(is_on), "{:?}", drawing.points().find(|&point| !is_on(point)));
        }
    }
}
