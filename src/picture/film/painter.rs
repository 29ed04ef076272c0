//! Whole frames.

use super::field::{FieldPainter, Moment};
use super::hud::HudPainter;
use super::{Film, FilmId, Layout, Look};
use crate::picture::Picture;
use crate::picture::canvas::Canvas;
use crate::picture::colours::PAPER;
use crate::time::SimTime;
use crate::timeline::State;

/// One moment of one run, or of two.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    /// One or two.
    pub films: &'a [&'a Film],
    pub time: SimTime,
    pub look: &'a Look,
}

/// Draws frames of one size, one after the other.
pub struct Painter {
    layout: Layout,
    sheet: Canvas,
    /// What is on the sheet.
    shown: Option<Shown>,
    fields: Vec<FieldPainter>,
    hud: HudPainter,
}

impl Painter {
    /// For frames of that width and height in pixels, of one run or two.
    pub fn new((width, height): (u32, u32), runs: usize) -> Self {
        Self {
            layout: Layout::new((width, height), runs),
            sheet: Canvas::new(width, height, PAPER),
            shown: None,
            fields: (0..runs).map(|_| FieldPainter::default()).collect(),
            hud: HudPainter::default(),
        }
    }

    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Whether the frame that was drawn last is this one.
    pub fn shows(&self, shot: &Shot) -> bool {
        self.shown.as_ref().is_some_and(|shown| shown.is(shot))
    }

    /// Red, green, blue and opacity of every pixel of the frame, row by row. What is shown follows from the shot alone,
    /// whatever was drawn before.
    pub fn paint(&mut self, shot: &Shot) -> &[u8] {
        if !self.shows(shot) {
            self.draw(shot);
            self.shown = Some(Shown::of(shot));
        }
        self.sheet.bytes()
    }

    fn draw(&mut self, shot: &Shot) {
        let states: Vec<State> = shot.films.iter().map(|film| film.state_at(shot.time)).collect();
        for (run, &film) in shot.films.iter().enumerate() {
            let pane = self.layout.fields[run];
            let rival = (shot.films.len() == 2).then(|| (shot.films[1 - run], &states[1 - run]));
            let moment = Moment { film, state: &states[run], rival, run, look: shot.look };
            let painted = self.fields[run].paint(&moment, (pane.width, pane.height));
            self.sheet.copy_from(painted, (pane.left, pane.top));
        }
        self.hud.paint(&mut self.sheet, &self.layout, shot, &states);
    }
}

/// A shot without its runs.
struct Shown {
    films: Vec<FilmId>,
    time: SimTime,
    look: Look,
}

impl Shown {
    fn of(shot: &Shot) -> Self {
        Self { films: shot.films.iter().map(|film| film.id()).collect(), time: shot.time, look: shot.look.clone() }
    }

    fn is(&self, shot: &Shot) -> bool {
        self.time == shot.time
            && self.look == *shot.look
            && self.films.iter().copied().eq(shot.films.iter().map(|film| film.id()))
    }
}

/// One frame as a picture.
pub fn still(shot: &Shot, size: (u32, u32)) -> Picture {
    let mut painter = Painter::new(size, shot.films.len());
    painter.paint(shot);
    painter.sheet.finish()
}
