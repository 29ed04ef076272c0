//! The visible part of a field, and the positions of its points on the sheet.

use glam::DVec2;

use super::fleet_view::{FieldBox, fleet_box};
use super::{CameraTarget, RunView, ViewOptions};
use crate::canvas::Point;
use crate::marks::to_f32;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_timeline::State;

/// Which part of a field is seen. The same camera serves panes of every size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point in the middle of the pane, as shares of the field's width and height from its south-west corner.
    pub centre: DVec2,
    /// How many times larger than where the whole field just fits its pane; from [`Camera::MIN_ZOOM`] to
    /// [`Camera::MAX_ZOOM`].
    pub zoom: f64,
}

impl Camera {
    pub const WHOLE: Self = Self { centre: DVec2::new(0.5, 0.5), zoom: 1.0 };
    pub const MIN_ZOOM: f64 = 0.5;
    pub const MAX_ZOOM: f64 = 200.0;

    /// The most that is seen about an agent that is followed, along the field's longer side.
    const FOLLOWED_M: f64 = 100.0;

    /// Zoomed in by a factor (out, if below 1) in a pane of that size; the point at a place of the pane stays there.
    #[must_use]
    pub fn zoomed(self, frame: &FieldFrame, pane: (f64, f64), factor: f64, at: (f64, f64)) -> Self {
        let under = Projection::new(frame, self, pane).world(at);
        let zoomed = Self { zoom: (self.zoom * factor).clamp(Self::MIN_ZOOM, Self::MAX_ZOOM), ..self };
        zoomed.moved(frame, under - Projection::new(frame, zoomed, pane).world(at))
    }

    /// Moves the camera so that what is seen moves by that many pixels to the right and down. The middle of the pane
    /// always shows a point of the field.
    #[must_use]
    pub fn panned(self, frame: &FieldFrame, pane: (f64, f64), (right, down): (f64, f64)) -> Self {
        let pixels_per_metre = Projection::new(frame, self, pane).pixels_per_metre;
        self.moved(frame, DVec2::new(-right, down) / pixels_per_metre)
    }

    fn moved(self, frame: &FieldFrame, by_m: DVec2) -> Self {
        let centre = self.centre + by_m / DVec2::new(frame.width_m(), frame.height_m());
        Self { centre: centre.clamp(DVec2::ZERO, DVec2::ONE), ..self }
    }

    /// Returns the camera about a point, near enough to see an agent there.
    pub(super) fn following(self, frame: &FieldFrame, point: DVec2) -> Self {
        let near = frame.width_m().max(frame.height_m()) / Self::FOLLOWED_M;
        Self {
            centre: (point / DVec2::new(frame.width_m(), frame.height_m())).clamp(DVec2::ZERO, DVec2::ONE),
            zoom: self.zoom.max(near).min(Self::MAX_ZOOM),
        }
    }

    /// Returns the camera that holds a part of a field in a pane of that size, as near as that goes, and no more of what is
    /// around the field than must be.
    fn holding(frame: &FieldFrame, part: FieldBox, (width, height): (f64, f64)) -> Self {
        let whole = Projection::new(frame, Self::WHOLE, (width, height)).pixels_per_metre;
        let side = part.high - part.low;
        let fitting = (Projection::room(width) / side.x).min(Projection::room(height) / side.y) / whole;
        let near = frame.width_m().max(frame.height_m()) / Self::FOLLOWED_M;
        let zoom = fitting.min(near).clamp(1.0, Self::MAX_ZOOM);
        let field = DVec2::new(frame.width_m(), frame.height_m());
        // The share of the field that is seen; where that is all of it, the middle of the field is in the middle.
        let seen = (DVec2::new(width, height) / (whole * zoom * field)).min(DVec2::ONE);
        let centre = (0.5 * (part.low + part.high) / field).max(0.5 * seen).min(1.0 - 0.5 * seen);
        Self { centre, zoom }
    }
}

impl Default for Camera {
    fn default() -> Self {
        Self::WHOLE
    }
}

/// A map from points of a field to places in a pane, in pixels to the right and down from the pane's upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    pub pixels_per_metre: f64,
    /// The world's origin in the pane.
    origin: DVec2,
}

impl Projection {
    /// The margin in pixels around a field that just fits its pane.
    const MARGIN: f64 = 8.0;

    /// Computes the projection to a pane of that width and height in pixels.
    pub fn new(frame: &FieldFrame, camera: Camera, (width, height): (f64, f64)) -> Self {
        let fitting = (Self::room(width) / frame.width_m()).min(Self::room(height) / frame.height_m());
        let pixels_per_metre = fitting * camera.zoom;
        let centre = camera.centre * DVec2::new(frame.width_m(), frame.height_m());
        let origin = DVec2::new(0.5 * width - centre.x * pixels_per_metre, 0.5 * height + centre.y * pixels_per_metre);
        Self { pixels_per_metre, origin }
    }

    /// Returns the pixels of a pane's side that a field may take.
    fn room(side: f64) -> f64 {
        (side - 2.0 * Self::MARGIN).max(1.0)
    }

    /// Computes the projection to a pane of that width and height in pixels for a run seen with those options: about
    /// whom the camera follows, if they are there, else as the camera says.
    pub fn from_options(run: &RunView, state: &State, options: &ViewOptions, (width, height): (u32, u32)) -> Self {
        let setting = &run.timeline().setting;
        let pane = (f64::from(width), f64::from(height));
        let following = options.follows.and_then(|followed| match followed {
            CameraTarget::Agent(agent) => setting.agent_index(agent).map(|index| {
                let centre = setting.agents[index].body.centre(state.agents[index].pose);
                options.camera.following(&setting.frame, centre)
            }),
            CameraTarget::Fleet => fleet_box(run, state.time).map(|part| Camera::holding(&setting.frame, part, pane)),
        });
        Self::new(&setting.frame, following.unwrap_or(options.camera), pane)
    }

    /// The pixels of a cell: the first ones, and those after the last. Cells side by side leave no gap between them,
    /// and each has one pixel at least.
    pub fn cell(&self, frame: &FieldFrame, cell: Cell) -> ((i32, i32), (i32, i32)) {
        let corner = |col: u16, row: u16| {
            let place = self.place(DVec2::new(f64::from(col), f64::from(row)) * frame.cell_m);
            (place.x.round() as i32, place.y.round() as i32)
        };
        let (left, bottom) = corner(cell.col, cell.row);
        let (right, top) = corner(cell.col + 1, cell.row + 1);
        ((left, top), (right.max(left + 1), bottom.max(top + 1)))
    }

    pub fn at(&self, point: DVec2) -> Point {
        self.place(point).as_vec2().into()
    }

    /// The same in double precision, for what lies far outside the pane.
    pub fn place(&self, point: DVec2) -> DVec2 {
        self.origin + DVec2::new(point.x, -point.y) * self.pixels_per_metre
    }

    /// A length in pixels.
    pub fn length(&self, metres: f64) -> f32 {
        to_f32(metres * self.pixels_per_metre)
    }

    /// The point of the world at a place in the pane.
    pub fn world(&self, (x, y): (f64, f64)) -> DVec2 {
        DVec2::new((x - self.origin.x) / self.pixels_per_metre, (self.origin.y - y) / self.pixels_per_metre)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: FieldFrame = FieldFrame { cols: 40, rows: 30, cell_m: 2.5 };
    const PANE: (f64, f64) = (640.0, 500.0);

    fn cameras() -> impl Iterator<Item = Camera> {
        let centres = [(0.5, 0.5), (0.2, 0.7), (0.9, 0.4)].map(|(x, y)| DVec2::new(x, y));
        centres.into_iter().flat_map(|centre| [0.5, 1.0, 7.3, 150.0].map(|zoom| Camera { centre, zoom }))
    }

    #[test]
    fn a_place_in_the_pane_is_where_its_point_is_shown() {
        for camera in cameras() {
            let projection = Projection::new(&FRAME, camera, PANE);
            for point in [DVec2::ZERO, DVec2::new(31.0, 74.0), DVec2::new(100.0, 0.5)] {
                let (x, y) = projection.at(point);
                let back = projection.world((f64::from(x), f64::from(y)));
                assert!((back - point).length() * projection.pixels_per_metre < 0.01, "{point} became {back}");
            }
        }
    }

    #[test]
    fn north_is_up_and_the_whole_field_fits() {
        let projection = Projection::new(&FRAME, Camera::WHOLE, PANE);
        let (left, bottom) = projection.at(DVec2::ZERO);
        let (right, top) = projection.at(DVec2::new(FRAME.width_m(), FRAME.height_m()));
        assert!(top < bottom && left < right);
        assert!(left >= 0.0 && top >= 0.0 && right <= 640.0 && bottom <= 500.0);
    }

    #[test]
    fn zooming_keeps_the_point_under_the_mouse() {
        for camera in cameras() {
            for factor in [0.8, 1.25, 3.0] {
                let at = (350.0, 230.0);
                let zoomed = camera.zoomed(&FRAME, PANE, factor, at);
                let [before, after] = [camera, zoomed].map(|camera| Projection::new(&FRAME, camera, PANE).world(at));
                let is_at_border = [zoomed.centre.x, zoomed.centre.y].iter().any(|&at| at == 0.0 || at == 1.0);
                assert!(is_at_border || (before - after).length() < 1e-9, "{camera:?} by {factor}");
                assert!((Camera::MIN_ZOOM..=Camera::MAX_ZOOM).contains(&zoomed.zoom));
            }
        }
    }

    #[test]
    fn panning_moves_what_is_seen_and_never_loses_the_field() {
        for camera in cameras() {
            let shown = |camera| Projection::new(&FRAME, camera, PANE).at(DVec2::new(40.0, 40.0));
            let before = shown(camera);
            let after = shown(camera.panned(&FRAME, PANE, (3.0, -2.0)));
            assert!((after.0 - before.0 - 3.0).abs() < 0.01 && (after.1 - before.1 + 2.0).abs() < 0.01);
            let lost = camera.panned(&FRAME, PANE, (1e9, -1e9));
            assert_eq!(lost.centre, DVec2::ZERO);
        }
    }

    #[test]
    fn cells_tile_the_field() {
        for camera in cameras() {
            let projection = Projection::new(&FRAME, camera, PANE);
            let cell = Cell { col: 7, row: 5 };
            let ((left, top), (right, bottom)) = projection.cell(&FRAME, cell);
            let ((next_left, _), _) = projection.cell(&FRAME, Cell { col: 8, row: 5 });
            let (_, (_, above)) = projection.cell(&FRAME, Cell { col: 7, row: 6 });
            assert_eq!((right, top), (next_left, above));
            let (x, y) = projection.at(FRAME.centre(cell));
            assert!((left as f32..=right as f32).contains(&x) && (top as f32..=bottom as f32).contains(&y));
        }
    }
}
