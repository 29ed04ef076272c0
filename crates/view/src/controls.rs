//! Executes the commands of keys and mouse; stills are saved to the current folder.

use std::path::{Path, PathBuf};

use bevy::app::AppExit;
use bevy::ecs::system::SystemParam;
use bevy::prelude::{MessageWriter, ResMut};
use glam::DVec2;

use crate::mouse::Gesture;
use crate::run_set::SeedStep;
use crate::{FrameBuffer, KeyCommand, Player, RunSet, Viewer};
use wildfire_base::geometry::{FieldFrame, ops};
use wildfire_base::time::SimTime;
use wildfire_picture::film::{Camera, CameraTarget, FrameRequest, Projection, RunView, pick, still};

/// The logarithm of the factor by which a notch of the wheel magnifies the field.
const NOTCH: f64 = 0.2;

/// The resources that keys and mouse change.
#[derive(SystemParam)]
pub struct Controls<'w> {
    player: ResMut<'w, Player>,
    viewer: ResMut<'w, Viewer>,
    runs: ResMut<'w, RunSet>,
    pub frame_buffer: ResMut<'w, FrameBuffer>,
    exit: MessageWriter<'w, AppExit>,
}

impl Controls<'_> {
    pub fn apply_command(&mut self, command: KeyCommand) {
        // A viewer who plays on while runs are simulated still reads that they are on their way.
        if !self.runs.is_waiting() {
            self.viewer.message = None;
        }
        match command {
            KeyCommand::TogglePause => self.player.toggle_pause(),
            KeyCommand::NextEvent => self.step_to(self.runs.next_event(self.player.clock())),
            KeyCommand::PreviousEvent => self.step_to(self.runs.previous_event(self.player.clock())),
            KeyCommand::Seek(seconds) => self.player.seek_by(seconds),
            KeyCommand::Faster => self.player.faster(),
            KeyCommand::Slower => self.player.slower(),
            KeyCommand::ToStart => self.player.seek(SimTime::ZERO),
            KeyCommand::ToEnd => self.player.seek(SimTime::MAX),
            KeyCommand::WholeField => self.viewer.options.camera = Camera::WHOLE,
            KeyCommand::FollowNext => self.viewer.follow_next(self.runs.runs()[0]),
            KeyCommand::Deselect => self.deselect(),
            KeyCommand::Rerun => self.request(SeedStep::Rerun),
            KeyCommand::NextSeed => self.request(SeedStep::Next),
            KeyCommand::PreviousSeed => self.request(SeedStep::Previous),
            KeyCommand::SaveStill => self.save(),
            KeyCommand::Toggle(layer) => self.viewer.options.layers.toggle(layer),
            KeyCommand::ToggleHelp => self.viewer.options.shows_help ^= true,
            KeyCommand::Quit => _ = self.exit.write(AppExit::Success),
        }
    }

    /// Pauses at an event, so that it can be seen.
    fn step_to(&mut self, event: Option<SimTime>) {
        if let Some(time) = event {
            self.player.pause();
            self.player.seek(time);
        }
    }

    fn deselect(&mut self) {
        self.viewer.options.selected = None;
        self.viewer.options.shows_help = false;
    }

    fn request(&mut self, step: SeedStep) {
        let message = self.runs.request(step).unwrap_or_else(|refusal| refusal);
        self.viewer.message = Some(message);
    }

    fn save(&mut self) {
        let request =
            FrameRequest { runs: &self.runs.runs(), time: self.player.clock(), options: &self.viewer.options };
        self.viewer.message = Some(save_still(&request, self.frame_buffer.size()));
    }

    pub fn follow(&mut self, gesture: Gesture) {
        match gesture {
            Gesture::Scrub(share) => self.player.seek_share(share),
            Gesture::Pan(by) => self.pan(by),
            Gesture::Click { run_index, at } => self.select(run_index, at),
            Gesture::Zoom { run_index, at, notches } => self.zoom(run_index, at, ops::exp(NOTCH * notches)),
        }
    }

    /// Stops following an agent.
    fn pan(&mut self, by: (f64, f64)) {
        self.viewer.options.camera = self.camera().panned(&self.frame(0), size_of(self.pane(0)), by);
        self.viewer.options.follows = None;
    }

    fn zoom(&mut self, run_index: usize, at: (f64, f64), factor: f64) {
        self.viewer.options.camera =
            self.camera().zoomed(&self.frame(run_index), size_of(self.pane(run_index)), factor, at);
        // A camera on the fleet has a zoom of its own.
        self.viewer.options.follows.take_if(|followed| *followed == CameraTarget::Fleet);
    }

    /// Returns the camera of the current view, regardless of who is followed.
    fn camera(&self) -> Camera {
        if self.viewer.options.follows.is_none() {
            return self.viewer.options.camera;
        }
        // What follows an agent is worked out for each frame, so it is read back; a drag would else jump to the old camera.
        let run = self.runs.runs()[0];
        let frame = self.frame(0);
        let pane = self.pane(0);
        let seen = Projection::from_options(run, &run.state_at(self.player.clock()), &self.viewer.options, pane);
        let (width, height) = size_of(pane);
        let centre = seen.world((0.5 * width, 0.5 * height)) / DVec2::new(frame.width_m(), frame.height_m());
        let whole = Projection::new(&frame, Camera::WHOLE, (width, height));
        Camera { centre, zoom: seen.pixels_per_metre / whole.pixels_per_metre }
    }

    fn select(&mut self, run_index: usize, at: (f64, f64)) {
        let run = self.runs.runs()[run_index];
        let state = run.state_at(self.player.clock());
        let picked = pick(run, &state, &self.viewer.options, self.pane(run_index), at);
        self.viewer.options.selected = picked.map(|picked| (run_index, picked));
    }

    fn frame(&self, run_index: usize) -> FieldFrame {
        self.runs.runs()[run_index].timeline().setting.frame
    }

    /// Width and height of the pane of a run.
    fn pane(&self, run_index: usize) -> (u32, u32) {
        let pane = self.frame_buffer.layout().fields[run_index];
        (pane.width, pane.height)
    }
}

fn size_of((width, height): (u32, u32)) -> (f64, f64) {
    (f64::from(width), f64::from(height))
}

/// Writes a still and returns a message with its path or the error.
pub fn save_still(request: &FrameRequest, size: (u32, u32)) -> String {
    let path = free_name(&base_name(request.runs, request.time));
    match still(request, size).write_png(&path) {
        Ok(()) => format!("saved {}", path.display()),
        Err(error) => format!("cannot write {}: {error}", path.display()),
    }
}

/// Returns the first unused name.
fn free_name(base: &str) -> PathBuf {
    let names = std::iter::once(format!("{base}.png")).chain((2..).map(|number| format!("{base}-{number}.png")));
    let free = names.map(PathBuf::from).find(|name| !is_taken(name));
    free.expect("numbers do not end")
}

/// Returns whether a name is in use, also by a dangling link.
fn is_taken(name: &Path) -> bool {
    name.symlink_metadata().is_ok()
}

fn base_name(runs: &[&RunView], time: SimTime) -> String {
    let runs: Vec<String> = runs.iter().map(|run| run_name(run)).collect();
    format!("{}-{:.1}s", runs.join("-and-"), time.as_seconds())
}

fn run_name(run: &RunView) -> String {
    let setting = &run.timeline().setting;
    let scenario = setting.scenario.chars();
    let scenario = scenario.map(|letter| if letter.is_alphanumeric() || letter == '-' { letter } else { '_' });
    // Long names are cut, so that the whole fits a file name.
    format!("{}-seed-{}", scenario.take(40).collect::<String>(), setting.seed)
}
