//! A film: its moments, and drawing them frame by frame into its files.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::mp4_file::Mp4File;
use crate::cli::error::CliError;
use crate::cli::interrupt;
use crate::cli::terminal::Progress;
use wildfire_base::time::SimTime;
use wildfire_picture::film::{FrameRenderer, FrameRequest, RunView, ViewOptions, still};
use wildfire_picture::{ColourCounts, GifFilm, Palette};

/// Frames whose colours make the palette of a GIF.
const SAMPLED_FRAMES: u64 = 32;

/// The runs and the view of them, without the moment.
pub struct Scene<'a> {
    pub runs: &'a [&'a RunView],
    pub options: ViewOptions,
    pub size: (u32, u32),
}

/// A part of a film: its moments, and the view of them.
pub struct Shot {
    pub moments: Moments,
    pub options: ViewOptions,
}

/// A film, shot after shot.
pub struct Shots(pub Vec<Shot>);

impl Shots {
    /// The delay of the last frame of a loop, in hundredths of a second.
    const LAST_DELAY: u16 = 100;

    pub fn count(&self) -> u64 {
        self.0.iter().map(|shot| shot.moments.count()).sum()
    }

    fn fps(&self) -> f64 {
        self.0.first().map_or(1.0, |shot| shot.moments.fps)
    }

    /// What a frame shows, from 0 on.
    fn request<'a>(&'a self, runs: &'a [&'a RunView], frame: u64) -> FrameRequest<'a> {
        let mut rest = frame;
        for Shot { moments, options } in &self.0 {
            if rest < moments.count() {
                return FrameRequest { runs, time: moments.time(rest), options };
            }
            rest -= moments.count();
        }
        unreachable!("the film has {} frames, and no frame {frame}", self.count())
    }

    /// Returns the delay of a frame, in hundredths of a second, so that rounding errors do not add up.
    fn hundredths(&self, frame: u64) -> u16 {
        if frame + 1 == self.count() {
            return Self::LAST_DELAY;
        }
        let [begin, end] = [frame, frame + 1].map(|frame| (100.0 * frame as f64 / self.fps()).round());
        (end - begin) as u16
    }

    /// Some frames from all over the film, at most `max`, the last among them.
    fn sample(&self, max: u64) -> impl Iterator<Item = u64> + use<> {
        let last = self.count() - 1;
        let stride = last.div_ceil(max - 1).max(1);
        (0..last).step_by(stride as usize).chain([last])
    }
}

impl Scene<'_> {
    pub fn request(&self, time: SimTime) -> FrameRequest<'_> {
        FrameRequest { runs: self.runs, time, options: &self.options }
    }

    pub fn write_still(&self, time: SimTime, path: &Path) -> Result<(), CliError> {
        let picture = still(&self.request(time), self.size);
        picture.write_png(path).map_err(|error| CliError::unwritable(path, &error))
    }
}

/// The most frames of a film: at twenty a second, an hour and a half.
pub const MAX_FRAMES: u64 = 100_000;

/// The moments that a film shows: evenly spaced from a first to a last one, both shown.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    pub from: SimTime,
    pub to: SimTime,
    /// Simulated seconds for a second of the film.
    pub speed: f64,
    /// Frames per second of the film.
    pub fps: f64,
}

impl Moments {
    pub fn count(&self) -> u64 {
        let steps = (self.to.since(self.from).as_seconds() / self.step_s()).ceil();
        steps as u64 + 1
    }

    /// The simulated time of a frame, from 0 on.
    pub fn time(&self, frame: u64) -> SimTime {
        (self.from + SimTime::from_seconds(frame as f64 * self.step_s())).min(self.to)
    }

    fn step_s(&self) -> f64 {
        self.speed / self.fps
    }
}

/// The files that a film goes into.
#[derive(Clone, Copy, Debug)]
pub struct FilmFiles<'a> {
    pub gif: Option<&'a Path>,
    pub mp4: Option<&'a Path>,
}

/// Writes the films that were asked for; they appear whole, both or none.
pub fn write_films(scene: &Scene, shots: &Shots, files: FilmFiles<'_>, quiet: bool) -> Result<(), CliError> {
    // A signal becomes a flag, so that half-written files are removed before the program ends.
    let watch = interrupt::watch(interrupt::USUAL_TIDYING);
    let stop = watch.stop();
    let mut mp4 = files.mp4.map(|path| Mp4File::create(path, scene.size, shots.fps())).transpose()?;
    // The palette of a GIF is made of some frames of the whole film, which are drawn twice.
    let sampled = if files.gif.is_some() { shots.sample(SAMPLED_FRAMES).count() as u64 } else { 0 };
    let progress = Progress::new(sampled + shots.count(), "frames", quiet);
    let mut film =
        FilmFrames { scene, shots, renderer: FrameRenderer::new(scene.size, scene.runs.len()), progress, stop };
    let mut gif = files.gif.map(|path| film.begin_gif(path)).transpose()?;
    for frame in 0..shots.count() {
        let pixels = film.paint(frame)?;
        if let Some((path, gif)) = &mut gif {
            gif.add(pixels, shots.hundredths(frame)).map_err(|error| CliError::unwritable(path, &error))?;
        }
        if let Some(mp4) = &mut mp4 {
            // A Ctrl-C reaches ffmpeg too, which then takes no more.
            mp4.add(pixels).map_err(|failure| if is_set(stop) { CliError::stopped() } else { failure })?;
        }
    }
    // Both are finished only after the last frame, so neither film appears without the other.
    mp4.map_or(Ok(()), Mp4File::finish)?;
    gif.map_or(Ok(()), |(path, gif)| gif.finish().map_err(|error| CliError::unwritable(path, &error)))?;
    film.progress.end();
    Ok(())
}

/// The frames of a film, painted one after the other.
struct FilmFrames<'a> {
    scene: &'a Scene<'a>,
    shots: &'a Shots,
    renderer: FrameRenderer,
    progress: Progress,
    stop: &'a AtomicBool,
}

impl FilmFrames<'_> {
    fn paint(&mut self, frame: u64) -> Result<&[u8], CliError> {
        if is_set(self.stop) {
            return Err(CliError::stopped());
        }
        self.progress.advance();
        Ok(self.renderer.paint(&self.shots.request(self.scene.runs, frame)))
    }

    fn begin_gif<'p>(&mut self, path: &'p Path) -> Result<(&'p Path, GifFilm), CliError> {
        let palette = self.palette()?;
        let gif =
            GifFilm::create(path, self.scene.size, palette).map_err(|error| CliError::unwritable(path, &error))?;
        Ok((path, gif))
    }

    fn palette(&mut self) -> Result<Palette, CliError> {
        let mut counts = ColourCounts::default();
        for frame in self.shots.sample(SAMPLED_FRAMES) {
            counts.add(self.paint(frame)?);
        }
        Ok(counts.palette())
    }
}

fn is_set(stop: &AtomicBool) -> bool {
    stop.load(Ordering::Relaxed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(from: f64, to: f64, speed: f64, fps: f64) -> Moments {
        Moments { from: SimTime::from_seconds(from), to: SimTime::from_seconds(to), speed, fps }
    }

    #[test]
    fn first_and_last_moment_are_shown_and_none_beyond() {
        for (from, to, speed, fps) in
            [(0.0, 3600.0, 60.0, 20.0), (10.0, 10.0, 1.0, 7.0), (0.0, 1.0, 0.1, 30.0), (1.0, 9.3, 0.7, 3.0)]
        {
            let moments = moments(from, to, speed, fps);
            let times: Vec<_> = (0..moments.count()).map(|frame| moments.time(frame)).collect();
            assert_eq!((times[0], times.last()), (moments.from, Some(&moments.to)));
            assert!(times.is_sorted_by(|earlier, later| earlier < later), "{moments:?}");
        }
    }

    #[test]
    fn film_of_ten_seconds_has_two_hundred_steps() {
        let moments = moments(0.0, 600.0, 60.0, 20.0);
        assert_eq!(moments.count(), 201);
        assert_eq!(moments.time(100), SimTime::from_seconds(300.0));
    }

    fn film(all: &[Moments]) -> Shots {
        Shots(all.iter().map(|&moments| Shot { moments, options: ViewOptions::default() }).collect())
    }

    #[test]
    fn delays_add_up_to_the_time_of_the_film() {
        for fps in [1.0, 7.0, 24.0, 30.0, 50.0] {
            let film = film(&[moments(0.0, 420.0, 10.0, fps)]);
            let last = film.count() - 1;
            let sum: u16 = (0..last).map(|frame| film.hundredths(frame)).sum();
            assert_eq!(sum, 4200, "{fps}");
            assert!((0..last).all(|frame| film.hundredths(frame) >= 2), "{fps}");
            assert_eq!(film.hundredths(last), 100);
        }
    }

    #[test]
    fn shots_follow_one_another_with_all_their_moments() {
        let both = [moments(0.0, 3.0, 1.0, 2.0), moments(50.0, 51.0, 0.5, 2.0)];
        let film = film(&both);
        let times: Vec<f64> = (0..film.count()).map(|frame| film.request(&[], frame).time.as_seconds()).collect();
        assert_eq!(times, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 50.0, 50.25, 50.5, 50.75, 51.0]);
    }

    #[test]
    fn sample_has_the_ends_and_no_frame_twice() {
        for seconds in [0.0, 0.1, 3.0, 160.0, 161.0, 3600.0] {
            let film = film(&[moments(0.0, seconds, 1.0, 10.0)]);
            let sample: Vec<_> = film.sample(32).collect();
            assert!(sample.len() <= 32, "{}", sample.len());
            assert!(sample.is_sorted_by(|earlier, later| earlier < later));
            assert_eq!((sample[0], sample.last()), (0, Some(&(film.count() - 1))));
        }
    }
}
