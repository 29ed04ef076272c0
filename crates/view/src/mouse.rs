//! Gestures of the mouse, with positions and distances in pixels of the frame.

use bevy::prelude::Resource;

use wildfire_picture::film::{FrameLayout, FramePart};

/// The distance in pixels from which a pressed mouse drags instead of clicking.
const CLICK: f64 = 4.0;

type At = (f64, f64);

/// The gestures of the mouse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gesture {
    /// To a share of the whole time, 0 to 1.
    Scrub(f64),
    /// Shifts the fields by that many pixels.
    Pan(At),
    /// A click in the pane of a run, at a place in that pane.
    Click { run_index: usize, at: At },
    /// Notches towards a place in the pane of a run, away from it where they are negative.
    Zoom { run_index: usize, at: At, notches: f64 },
}

/// The mouse: its place, and what it holds.
#[derive(Debug, Default, Resource)]
pub struct Mouse {
    at: At,
    grab: Option<Grab>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Grab {
    /// The timeline, at this height of the frame.
    Timeline { y: f64 },
    /// A field, pressed at a place of the frame.
    Field { pressed: At, is_dragged: bool },
}

impl Mouse {
    /// Returns whether it has hold of the timeline, so that the clock is held.
    pub fn scrubs(&self) -> bool {
        matches!(self.grab, Some(Grab::Timeline { .. }))
    }

    pub fn go_to(&mut self, at: At, layout: &FrameLayout) -> Option<Gesture> {
        let before = std::mem::replace(&mut self.at, at);
        match &mut self.grab {
            None => None,
            // With the height of the press the timeline keeps hold of a mouse that strays above or below it.
            Some(Grab::Timeline { y }) => scrub((at.0, *y), layout),
            Some(Grab::Field { is_dragged: true, .. }) => Some(Gesture::Pan(between(before, at))),
            Some(Grab::Field { pressed, is_dragged }) => {
                *is_dragged = !is_near(*pressed, at);
                // The way counts from the press and not from the last place, so the field stays under the mouse.
                is_dragged.then(|| Gesture::Pan(between(*pressed, at)))
            }
        }
    }

    pub fn press(&mut self, layout: &FrameLayout) -> Option<Gesture> {
        match layout.place_at(self.at) {
            FramePart::Timeline { share } => {
                self.grab = Some(Grab::Timeline { y: self.at.1 });
                Some(Gesture::Scrub(share))
            }
            FramePart::Field { .. } => {
                self.grab = Some(Grab::Field { pressed: self.at, is_dragged: false });
                None
            }
            FramePart::Elsewhere => None,
        }
    }

    pub fn release(&mut self, layout: &FrameLayout) -> Option<Gesture> {
        let Some(Grab::Field { is_dragged: false, .. }) = self.grab.take() else { return None };
        match layout.place_at(self.at) {
            FramePart::Field { run_index, at } => Some(Gesture::Click { run_index, at }),
            _ => None,
        }
    }

    pub fn wheel(&self, notches: f64, layout: &FrameLayout) -> Option<Gesture> {
        match layout.place_at(self.at) {
            FramePart::Field { run_index, at } => Some(Gesture::Zoom { run_index, at, notches }),
            _ => None,
        }
    }
}

/// Beyond the ends of the timeline is its nearer end.
fn scrub((x, y): At, layout: &FrameLayout) -> Option<Gesture> {
    let left = f64::from(layout.chart.left);
    let right = f64::from(layout.chart.right());
    // The right edge itself is outside of the chart.
    match layout.place_at((x.clamp(left, right - 1.0), y)) {
        FramePart::Timeline { share } => Some(Gesture::Scrub(share)),
        _ => None,
    }
}

fn between(from: At, to: At) -> At {
    (to.0 - from.0, to.1 - from.1)
}

fn is_near(one: At, other: At) -> bool {
    let (x, y) = between(one, other);
    x * x + y * y < CLICK * CLICK
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout() -> FrameLayout {
        FrameLayout::new((1000, 800), 1)
    }

    /// The middle of the only field, and that place in its pane.
    fn middle(layout: &FrameLayout) -> (At, At) {
        let pane = layout.fields[0];
        let inside = (f64::from(pane.width / 2), f64::from(pane.height / 2));
        ((f64::from(pane.left) + inside.0, f64::from(pane.top) + inside.1), inside)
    }

    #[test]
    fn press_and_release_in_place_is_a_click_there() {
        let layout = layout();
        let (at, inside) = middle(&layout);
        let mut mouse = Mouse::default();
        assert_eq!(mouse.go_to(at, &layout), None);
        assert_eq!(mouse.press(&layout), None);
        assert_eq!(mouse.go_to((at.0 + 2.0, at.1 + 2.0), &layout), None);
        assert_eq!(mouse.go_to(at, &layout), None);
        assert_eq!(mouse.release(&layout), Some(Gesture::Click { run_index: 0, at: inside }));
        assert_eq!(mouse.release(&layout), None);
    }

    #[test]
    fn drag_pans_by_all_of_its_way_and_is_no_click() {
        let layout = layout();
        let (at, _) = middle(&layout);
        let mut mouse = Mouse::default();
        mouse.go_to(at, &layout);
        mouse.press(&layout);
        let mut sum = (0.0, 0.0);
        for step in 1..=10 {
            if let Some(Gesture::Pan((x, y))) =
                mouse.go_to((at.0 + f64::from(step), at.1 - 2.0 * f64::from(step)), &layout)
            {
                sum = (sum.0 + x, sum.1 + y);
            }
        }
        assert_eq!(sum, (10.0, -20.0));
        assert_eq!(mouse.release(&layout), None);
    }

    #[test]
    fn timeline_is_scrubbed_from_end_to_end_wherever_the_mouse_goes() {
        let layout = layout();
        let chart = layout.chart;
        let mut mouse = Mouse::default();
        mouse.go_to((f64::from(chart.left + chart.width / 2), f64::from(chart.top + chart.height / 2)), &layout);
        let Some(Gesture::Scrub(share)) = mouse.press(&layout) else { panic!("the press is on the timeline") };
        assert!((0.4..0.6).contains(&share), "{share}");
        assert!(mouse.scrubs());
        assert_eq!(mouse.go_to((-50.0, 0.0), &layout), Some(Gesture::Scrub(0.0)));
        let Some(Gesture::Scrub(share)) = mouse.go_to((5000.0, 0.0), &layout) else { panic!("it is still held") };
        assert!(share > 0.99, "{share}");
        mouse.release(&layout);
        assert_eq!(mouse.go_to((0.0, 0.0), &layout), None);
    }

    #[test]
    fn wheel_zooms_about_its_place_in_a_field_and_nowhere_else() {
        let layout = layout();
        let (at, inside) = middle(&layout);
        let mut mouse = Mouse::default();
        mouse.go_to(at, &layout);
        assert_eq!(mouse.wheel(2.0, &layout), Some(Gesture::Zoom { run_index: 0, at: inside, notches: 2.0 }));
        mouse.go_to((f64::from(layout.chart.left + 5), f64::from(layout.chart.top + 5)), &layout);
        assert_eq!(mouse.wheel(2.0, &layout), None);
    }
}
