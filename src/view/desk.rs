//! Does what keys and mouse ask for.

use bevy::app::AppExit;
use bevy::ecs::system::SystemParam;
use bevy::prelude::{MessageWriter, ResMut};
use glam::DVec2;

use super::mouse::Gesture;
use super::reels::Step;
use super::saved::save_still;
use super::{Command, Player, Reels, Sheet, Viewer};
use crate::geometry::{FieldFrame, ops};
use crate::picture::film::{Camera, Projection, Shot, pick};
use crate::time::SimTime;

/// How many times larger a notch of the wheel shows the field, as a logarithm.
const NOTCH: f64 = 0.2;

/// All that keys and mouse change.
#[derive(SystemParam)]
pub struct Desk<'w> {
    player: ResMut<'w, Player>,
    viewer: ResMut<'w, Viewer>,
    reels: ResMut<'w, Reels>,
    pub sheet: ResMut<'w, Sheet>,
    exit: MessageWriter<'w, AppExit>,
}

impl Desk<'_> {
    pub fn obey(&mut self, command: Command) {
        if !self.reels.is_waiting() {
            self.viewer.message = None;
        }
        match command {
            Command::TogglePause => self.player.toggle_pause(),
            Command::NextEvent => self.step_to(self.reels.next_event(self.player.clock())),
            Command::PreviousEvent => self.step_to(self.reels.previous_event(self.player.clock())),
            Command::Seek(seconds) => self.player.seek_by(seconds),
            Command::Faster => self.player.faster(),
            Command::Slower => self.player.slower(),
            Command::ToStart => self.player.seek(SimTime::ZERO),
            Command::ToEnd => self.player.seek(SimTime::MAX),
            Command::WholeField => self.viewer.look.camera = Camera::WHOLE,
            Command::FollowNext => self.viewer.follow_next(self.reels.films()[0]),
            Command::Deselect => self.deselect(),
            Command::Rerun => self.send_for(Step::Rerun),
            Command::NextSeed => self.send_for(Step::Next),
            Command::PreviousSeed => self.send_for(Step::Previous),
            Command::SaveStill => self.save(),
            Command::Toggle(layer) => self.viewer.look.layers.toggle(layer),
            Command::ToggleHelp => self.viewer.look.shows_help ^= true,
            Command::Quit => _ = self.exit.write(AppExit::Success),
        }
    }

    /// One sees an event by standing still at it.
    fn step_to(&mut self, event: Option<SimTime>) {
        if let Some(time) = event {
            self.player.pause();
            self.player.seek(time);
        }
    }

    fn deselect(&mut self) {
        self.viewer.look.selected = None;
        self.viewer.look.shows_help = false;
    }

    fn send_for(&mut self, step: Step) {
        let said = self.reels.send_for(step).unwrap_or_else(|refusal| refusal);
        self.viewer.message = Some(said);
    }

    fn save(&mut self) {
        let shot = Shot { films: &self.reels.films(), time: self.player.clock(), look: &self.viewer.look };
        self.viewer.message = Some(save_still(&shot, self.sheet.size()));
    }

    pub fn follow(&mut self, gesture: Gesture) {
        match gesture {
            Gesture::Scrub(share) => self.player.seek_share(share),
            Gesture::Pan(by) => self.pan(by),
            Gesture::Click { run, at } => self.select(run, at),
            Gesture::Zoom { run, at, notches } => self.zoom(run, at, ops::exp(NOTCH * notches)),
        }
    }

    /// An agent that was followed is let go.
    fn pan(&mut self, by: (f64, f64)) {
        self.viewer.look.camera = self.camera().panned(&self.frame(0), size_of(self.pane(0)), by);
        self.viewer.look.follows = None;
    }

    fn zoom(&mut self, run: usize, at: (f64, f64), factor: f64) {
        self.viewer.look.camera = self.camera().zoomed(&self.frame(run), size_of(self.pane(run)), factor, at);
    }

    /// The camera that shows what is seen now, even where an agent is followed.
    fn camera(&self) -> Camera {
        if self.viewer.look.follows.is_none() {
            return self.viewer.look.camera;
        }
        let (film, frame, pane) = (self.reels.films()[0], self.frame(0), self.pane(0));
        let seen = Projection::of(film, &film.state_at(self.player.clock()), &self.viewer.look, pane);
        let (width, height) = size_of(pane);
        let centre = seen.world((0.5 * width, 0.5 * height)) / DVec2::new(frame.width_m(), frame.height_m());
        let whole = Projection::new(&frame, Camera::WHOLE, (width, height));
        Camera { centre, zoom: seen.pixels_per_metre / whole.pixels_per_metre }
    }

    fn select(&mut self, run: usize, at: (f64, f64)) {
        let film = self.reels.films()[run];
        let state = film.state_at(self.player.clock());
        let picked = pick(film, &state, &self.viewer.look, self.pane(run), at);
        self.viewer.look.selected = picked.map(|picked| (run, picked));
    }

    fn frame(&self, run: usize) -> FieldFrame {
        self.reels.films()[run].timeline().setting.frame
    }

    /// Width and height of the pane of a run.
    fn pane(&self, run: usize) -> (u32, u32) {
        let pane = self.sheet.layout().fields[run];
        (pane.width, pane.height)
    }
}

fn size_of((width, height): (u32, u32)) -> (f64, f64) {
    (f64::from(width), f64::from(height))
}
