//! Axes: where values lie on the sheet, with ticks and lines across.

use super::drawing::Drawing;
use super::sheet::{LABEL, Plot};
use crate::picture::colours::{FAINT_INK, INK};
use crate::picture::marks::to_f32;
use crate::picture::text::Align;
use crate::picture::ticks::ticks;

/// What a tick keeps for itself, in units.
const TICK_ROOM: [f32; 2] = [64.0, 40.0];

/// Values along a side of a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    pub low: f64,
    pub high: f64,
}

impl Scale {
    /// All of the values with a little room; those of values that cannot be negative begin at zero.
    pub fn around(ranges: impl Iterator<Item = (f64, f64)>) -> Self {
        let finite = ranges.filter(|(low, high)| low.is_finite() && high.is_finite());
        let (low, high) = finite
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), (low, high)| (least.min(low), most.max(high)));
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        let room = 0.04 * (high - low);
        match () {
            () if low == high && low == 0.0 => Self { low: 0.0, high: 1.0 },
            () if low == high => Self { low: low - 0.1 * low.abs(), high: high + 0.1 * high.abs() },
            () if low >= 0.0 && low - room < 0.0 => Self { low: 0.0, high: high + room },
            () => Self { low: low - room, high: high + room },
        }
    }

    /// The same with zero, where that leaves the values half of the room.
    pub fn with_near_zero(self) -> Self {
        if self.low > 0.5 * self.high { self } else { self.with_zero() }
    }

    /// The same with zero, for what is shown as a length.
    pub fn with_zero(self) -> Self {
        Self { low: self.low.min(0.0), high: self.high.max(0.0) }
    }

    fn share(self, value: f64) -> f32 {
        to_f32(((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0))
    }
}

impl Plot {
    pub fn x(&self, scale: Scale, value: f64) -> f32 {
        self.left + scale.share(value) * (self.right - self.left)
    }

    pub fn y(&self, scale: Scale, value: f64) -> f32 {
        self.bottom - scale.share(value) * (self.bottom - self.top)
    }

    /// Numbers to the left, and a line across at each.
    pub fn draw_y_axis(&self, drawing: &mut Drawing, scale: Scale) {
        for tick in ticks(scale.low, scale.high, room(self.bottom - self.top, TICK_ROOM[1]), 0.0) {
            let y = self.y(scale, tick.value);
            drawing.line(vec![(self.left, y), (self.right, y)], 1.0, FAINT_INK);
            drawing.text(&tick.label, (self.left - 7.0, y + LABEL / 2.0), Align::Right, LABEL, INK);
        }
    }

    /// Numbers below, and a line upwards at each.
    pub fn draw_x_axis(&self, drawing: &mut Drawing, scale: Scale) {
        for tick in ticks(scale.low, scale.high, room(self.right - self.left, TICK_ROOM[0]), 0.0) {
            let x = self.x(scale, tick.value);
            drawing.line(vec![(x, self.top), (x, self.bottom)], 1.0, FAINT_INK);
            drawing.text(&tick.label, (x, self.bottom + 9.0 + LABEL), Align::Centre, LABEL, INK);
        }
    }

    pub fn draw_base(&self, drawing: &mut Drawing) {
        drawing.line(vec![(self.left, self.bottom), (self.right, self.bottom)], 1.2, INK);
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sheet has room for some dozen ticks")]
fn room(length: f32, each: f32) -> usize {
    (length / each).max(2.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_holds_its_values_and_starts_at_zero_where_they_are_near() {
        assert_eq!(Scale::around([(0.0, 10.0), (2.0, 5.0)].into_iter()), Scale { low: 0.0, high: 10.4 });
        assert_eq!(Scale::around([(-10.0, 10.0)].into_iter()), Scale { low: -10.8, high: 10.8 });
        assert_eq!(Scale::around([(f64::NAN, 1.0)].into_iter()), Scale { low: 0.0, high: 1.0 });
        let one = Scale::around([(3.0, 3.0)].into_iter());
        assert!(one.low < 3.0 && one.high > 3.0);
    }
}
