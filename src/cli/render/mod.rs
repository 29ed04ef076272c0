//! `wildfire render`: stills and films of runs, without a screen.

mod args;
mod film_files;
mod moments;
mod mp4_file;

pub use args::RenderArguments;

use std::path::Path;
use std::process::ExitCode;

use crate::cli::error::CliError;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::show::{Searches, ShownRun, look, shown_runs, time_within};
use crate::picture::film::{FrameRequest, Layer, RunView, ViewOptions, still};
use crate::time::SimTime;
use film_files::write_films;
use moments::{MOST_FRAMES, Moments};

pub fn run(arguments: &RenderArguments, quiet: bool) -> Result<ExitCode, CliError> {
    check(arguments)?;
    let runs: Vec<RunView> = run_views(arguments, quiet)?;
    let runs: Vec<&RunView> = runs.iter().collect();
    let scene = Scene { runs: &runs, options: look(&arguments.show, &runs)?, size: arguments.show.size.into() };
    let (still_time, moments) = (still_time(arguments, &runs)?, moments(arguments, &runs)?);
    if let Some(path) = &arguments.out {
        scene.write_still(still_time, path)?;
        output_files::note_written(path, quiet);
    }
    if arguments.gif.is_some() || arguments.mp4.is_some() {
        write_films(&scene, moments, arguments, quiet)?;
        let films = [&arguments.gif, &arguments.mp4].into_iter().flatten();
        films.for_each(|path| output_files::note_written(path, quiet));
    }
    Ok(ExitCode::SUCCESS)
}

/// The runs and the view of them, without the moment.
struct Scene<'a> {
    runs: &'a [&'a RunView],
    options: ViewOptions,
    size: (u32, u32),
}

impl Scene<'_> {
    fn request(&self, time: SimTime) -> FrameRequest<'_> {
        FrameRequest { runs: self.runs, time, options: &self.options }
    }

    fn write_still(&self, time: SimTime, path: &Path) -> Result<(), CliError> {
        let picture = still(&self.request(time), self.size);
        picture.write_png(path).map_err(|error| CliError::unwritable(path, &error))
    }
}

/// Checks what can be checked before anything is simulated.
fn check(arguments: &RenderArguments) -> Result<(), CliError> {
    let show = &arguments.show;
    let inputs = [Some(&show.source), show.with.as_ref()].into_iter().flatten().map(Path::new).collect();
    let (still, gif, mp4) = (&arguments.out, &arguments.gif, &arguments.mp4);
    let files = Files { inputs, ..Files::default() };
    files.writing([(Format::Png, still), (Format::Gif, gif), (Format::Mp4, mp4)]).check()?;
    let (width, height) = (show.size.width, show.size.height);
    if arguments.mp4.is_some() && (width % 2 == 1 || height % 2 == 1) {
        let sentence = format!("--size is {width}x{height}; expected even numbers of pixels with --mp4");
        return Err(CliError::bad_input(sentence, None));
    }
    Ok(())
}

fn run_views(arguments: &RenderArguments, quiet: bool) -> Result<Vec<RunView>, CliError> {
    let needs_searches = |&layer: &Layer| layer.needs_searches() && arguments.show.layers().contains(layer);
    let searches = if Layer::ALL.iter().any(needs_searches) { Searches::Recorded } else { Searches::LeftOut };
    let shown = shown_runs(&arguments.show, searches, quiet)?;
    let run = |run: ShownRun| if arguments.cpu { run } else { ShownRun { cpu_samples: None, ..run } };
    Ok(shown.into_iter().map(|shown| run(shown.run).into_view()).collect())
}

fn still_time(arguments: &RenderArguments, runs: &[&RunView]) -> Result<SimTime, CliError> {
    arguments.at.map_or_else(|| Ok(RunView::last_end(runs)), |at| time_within("--at", at, runs))
}

fn moments(arguments: &RenderArguments, runs: &[&RunView]) -> Result<Moments, CliError> {
    let from = time_within("--from", arguments.from, runs)?;
    let to = arguments.to.map_or_else(|| Ok(RunView::last_end(runs)), |to| time_within("--to", to, runs))?;
    if from > to {
        let sentence = format!("--from is {}; expected at most --to, {}", from.as_seconds(), to.as_seconds());
        return Err(CliError::bad_input(sentence, None));
    }
    let moments = Moments { from, to, speed: arguments.speed, fps: arguments.fps };
    if moments.count() > MOST_FRAMES {
        let sentence = format!("the film would have {} frames; expected at most {MOST_FRAMES}", moments.count());
        return Err(CliError::bad_input(
            sentence,
            Some("raise --speed, lower --fps, or shorten it with --from and --to"),
        ));
    }
    Ok(moments)
}
