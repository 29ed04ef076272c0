//! A sheet with a title, a part of the world, and a key beside it.

use super::frame::Frame;
use crate::picture::canvas::Canvas;
use crate::picture::colours::{INK, PAPER};
use crate::picture::legend::{Legend, Symbol};
use crate::picture::text::{self, Align};

const TITLE: f32 = 13.0;
const MARGIN: f32 = 24.0;

pub struct Sheet {
    pub canvas: Canvas,
    /// Where the part of the world lies on it.
    pub frame: Frame,
}

impl Sheet {
    /// Everything but what lies in the frame.
    pub fn new(title: &str, frame: Frame, key: Vec<(Symbol, &str)>) -> Self {
        let legend = Legend { values: None, key };
        let room = frame.room();
        let corner = (MARGIN + room.left, MARGIN + TITLE + room.above);
        let frame = frame.moved(corner);
        let (width, height) = frame.size();
        let legend_at = (corner.0 + width + MARGIN, corner.1);
        let right = (corner.0 + text::measure(title, TITLE)).max(legend_at.0 + legend.width(1.0)) + MARGIN;
        let bottom = corner.1 + (height + room.below).max(legend.height(height, 1.0)) + MARGIN;

        let mut canvas = Canvas::sized(right, bottom, PAPER);
        text::draw(&mut canvas, title, (corner.0, MARGIN + TITLE), Align::Left, TITLE, INK);
        legend.draw(&mut canvas, legend_at, height, 1.0);
        frame.draw(&mut canvas);
        Self { canvas, frame }
    }
}
