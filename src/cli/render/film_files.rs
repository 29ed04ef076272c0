//! Painting a film frame by frame into its files.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::ProgressBar;

use super::moments::Moments;
use super::mp4_file::Mp4File;
use super::{RenderArguments, Scene};
use crate::cli::error::CliError;
use crate::cli::{interrupt, terminal};
use crate::picture::film::FrameRenderer;
use crate::picture::{ColourCounts, GifFilm, Palette};

/// Frames whose colours make the palette of a GIF.
const SAMPLED_FRAMES: u64 = 32;

/// Writes the films that were asked for; they appear whole, both or none.
pub fn write_films(scene: &Scene, moments: Moments, arguments: &RenderArguments, quiet: bool) -> Result<(), CliError> {
    let watch = interrupt::watch();
    let stop = watch.stop();
    let mut mp4 = arguments.mp4.as_deref().map(|path| Mp4File::create(path, scene.size, moments.fps)).transpose()?;
    let sampled = if arguments.gif.is_some() { moments.sample(SAMPLED_FRAMES).count() as u64 } else { 0 };
    let bar = terminal::progress_bar(sampled + moments.count(), "frames", quiet);
    let mut film = FilmFrames { scene, moments, renderer: FrameRenderer::new(scene.size, scene.runs.len()), bar, stop };
    let mut gif = arguments.gif.as_deref().map(|path| film.begin_gif(path)).transpose()?;
    for frame in 0..moments.count() {
        let pixels = film.paint(frame)?;
        if let Some((path, gif)) = &mut gif {
            gif.add(pixels, moments.hundredths(frame)).map_err(|error| CliError::unwritable(path, &error))?;
        }
        if let Some(mp4) = &mut mp4 {
            // A Ctrl-C reaches ffmpeg too, which then takes no more.
            mp4.add(pixels).map_err(|failure| if is_set(stop) { CliError::stopped() } else { failure })?;
        }
    }
    mp4.map_or(Ok(()), Mp4File::finish)?;
    gif.map_or(Ok(()), |(path, gif)| gif.finish().map_err(|error| CliError::unwritable(path, &error)))?;
    film.bar.finish_and_clear();
    Ok(())
}

/// The frames of a film, painted one after the other.
struct FilmFrames<'a> {
    scene: &'a Scene<'a>,
    moments: Moments,
    renderer: FrameRenderer,
    bar: ProgressBar,
    stop: &'a AtomicBool,
}

impl FilmFrames<'_> {
    fn paint(&mut self, frame: u64) -> Result<&[u8], CliError> {
        if is_set(self.stop) {
            return Err(CliError::stopped());
        }
        self.bar.inc(1);
        Ok(self.renderer.paint(&self.scene.request(self.moments.time(frame))))
    }

    fn begin_gif<'p>(&mut self, path: &'p Path) -> Result<(&'p Path, GifFilm), CliError> {
        let palette = self.palette()?;
        let gif =
            GifFilm::create(path, self.scene.size, palette).map_err(|error| CliError::unwritable(path, &error))?;
        Ok((path, gif))
    }

    fn palette(&mut self) -> Result<Palette, CliError> {
        let mut counts = ColourCounts::default();
        for frame in self.moments.sample(SAMPLED_FRAMES) {
            counts.add(self.paint(frame)?);
        }
        Ok(counts.palette())
    }
}

fn is_set(stop: &AtomicBool) -> bool {
    stop.load(Ordering::Relaxed)
}
