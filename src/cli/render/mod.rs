//! `wildfire render`: stills, films and pages of runs, without a screen.

mod film;
mod mp4_file;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{ArgGroup, Args};

use film::{FilmFiles, MAX_FRAMES, Moments, Scene, Shot, Shots, write_films};

use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::numbers;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::show::{
    Moment, RunEvent, Searches, ShowArguments, ShownRun, check_grounds, look, parse_moment, parse_speed, shown_runs,
    time_within, write_page,
};
use wildfire_base::time::SimTime;
use wildfire_picture::GifFilm;
use wildfire_picture::film::{Layer, RunView, TourStop, tour};

#[derive(Debug, Args)]
#[command(
    group = ArgGroup::new("film").args(["gif", "mp4"]).multiple(true),
    group = ArgGroup::new("moment").args(["out", "page"]).multiple(true),
    group = ArgGroup::new("outputs").args(["out", "gif", "mp4", "page"]).multiple(true).required(true),
    after_help = "\
Examples:
  wildfire render --seed 7 --at 600 -o still.png
  wildfire render run.wildfire --gif film.gif --size 600x600
  wildfire render --mp4 film.mp4 --from 300 --to 900 --speed 30
  wildfire render --mp4 tour.mp4 --tour
  wildfire render run.wildfire --page run.html
  wildfire render --with-set unimog.planner=hybrid-astar -o two.png --size 1400x900
  wildfire render --at 600 --follow unimog/0 --zoom 6 --layers local-search -o near.png
  wildfire render report-2024 --at largest-search -o search.png

No screen is needed. The same run gives the same pictures on every machine."
)]
pub struct RenderArguments {
    #[command(flatten)]
    pub show: ShowArguments,
    /// Write a still as a PNG file.
    #[arg(short, long, value_name = "FILE.png")]
    pub out: Option<PathBuf>,
    /// Simulated time of the still [default: the end of the run] or of the start of a page [default: 0]: seconds,
    /// `h:mm:ss`, a share of the run as `50%`, `first-fire`, `first-failure`, `largest-search` or `end`.
    #[arg(long, value_name = "TIME", requires = "moment", allow_hyphen_values = true, value_parser = parse_moment)]
    pub at: Option<Moment>,
    /// Write a film as GIF.
    #[arg(long, value_name = "FILE.gif")]
    pub gif: Option<PathBuf>,
    /// Write a film as MP4; needs the program ffmpeg.
    #[arg(long, value_name = "FILE.mp4")]
    pub mp4: Option<PathBuf>,
    /// Write a page that plays the run in a browser, offline; --size has no effect on it.
    #[arg(long, alias = "html", value_name = "FILE.html")]
    pub page: Option<PathBuf>,
    /// Film a guided tour of the run: its field, its first fire, a truck and how it plans, the largest search, the closest
    /// moment, and the end.
    #[arg(long, requires = "film", conflicts_with_all = ["from", "to", "speed", "with", "with_overrides", "with_seed"])]
    pub tour: bool,
    /// Simulated time at which the film begins, as for --at.
    #[arg(long, value_name = "TIME", default_value = "0", requires = "film", allow_hyphen_values = true, value_parser = parse_moment)]
    pub from: Moment,
    /// Simulated time at which the film ends, as for --at [default: the end of the run].
    #[arg(long, value_name = "TIME", requires = "film", allow_hyphen_values = true, value_parser = parse_moment)]
    pub to: Option<Moment>,
    /// Speed of the film in simulated seconds per second, from 0.1 to 1000.
    #[arg(long, value_name = "X", default_value_t = 60.0, requires = "film", allow_hyphen_values = true, value_parser = parse_speed)]
    pub speed: f64,
    /// Frames per second of the film.
    #[arg(long, value_name = "FRAMES", default_value_t = 20.0, requires = "film", allow_hyphen_values = true, value_parser = parse_fps)]
    pub fps: f64,
    /// Also show the CPU time of planners, which is measured and differs every time.
    #[arg(long)]
    pub cpu: bool,
}

fn parse_fps(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(1.0..=100.0 / f64::from(GifFilm::MIN_DELAY)), "a number")
}

pub fn run(arguments: &RenderArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let quiet = context.quiet;
    check(arguments)?;
    let runs: Vec<RunView> = run_views(arguments, context)?;
    let runs: Vec<&RunView> = runs.iter().collect();
    let mut options = look(&arguments.show, &runs)?;
    // The instant of a search is of no use to a picture that does not show it.
    if arguments.at == Some(Moment::Event(RunEvent::LargestSearch))
        && let Some(search) = runs[0].index().largest_search()
    {
        options.layers = options.layers.with(Layer::for_phase(search.phase));
    }
    let scene = Scene { runs: &runs, options, size: arguments.show.size.into() };
    if arguments.page.is_some() {
        check_grounds(&runs)?;
    }
    let at = arguments.at.map(|at| time_within("--at", at, &runs, quiet)).transpose()?;
    let shots = shots(arguments, &scene, quiet)?;
    if let Some(path) = &arguments.out {
        scene.write_still(at.unwrap_or(RunView::last_end(&runs)), path)?;
        output_files::note_written(path, quiet);
    }
    if let Some(path) = &arguments.page {
        write_page(&scene.request(at.unwrap_or(SimTime::ZERO)), path)?;
        output_files::note_written(path, quiet);
    }
    if arguments.gif.is_some() || arguments.mp4.is_some() {
        let files = FilmFiles { gif: arguments.gif.as_deref(), mp4: arguments.mp4.as_deref() };
        write_films(&scene, &shots, files, quiet)?;
        [files.gif, files.mp4].into_iter().flatten().for_each(|path| output_files::note_written(path, quiet));
    }
    Ok(ExitCode::SUCCESS)
}

/// Checks what can be checked before anything is simulated.
fn check(arguments: &RenderArguments) -> Result<(), CliError> {
    let show = &arguments.show;
    let inputs = [Some(&show.source), show.with.as_ref()].into_iter().flatten().map(Path::new).collect();
    let still = &arguments.out;
    let gif = &arguments.gif;
    let mp4 = &arguments.mp4;
    let page = &arguments.page;
    let files = Files { inputs, ..Files::default() };
    files.writing([(Format::Png, still), (Format::Gif, gif), (Format::Mp4, mp4), (Format::Html, page)]).check()?;
    let width = show.size.width;
    let height = show.size.height;
    // H.264 halves the colours in both directions, which takes even sides.
    if arguments.mp4.is_some() && (width % 2 == 1 || height % 2 == 1) {
        let sentence = format!("--size is {width}x{height}; expected even numbers of pixels with --mp4");
        return Err(CliError::bad_input(sentence, None));
    }
    Ok(())
}

fn run_views(arguments: &RenderArguments, context: &CommandContext) -> Result<Vec<RunView>, CliError> {
    let moments = [arguments.at, Some(arguments.from), arguments.to];
    // A page has the layers of searches to switch on, as the window has.
    let searches = if arguments.page.is_some()
        || arguments.tour
        || moments.contains(&Some(Moment::Event(RunEvent::LargestSearch)))
        || Layer::ALL.iter().any(|&layer| layer.needs_searches() && arguments.show.layers().contains(layer))
    {
        Searches::Recorded
    } else {
        Searches::LeftOut
    };
    let shown = shown_runs(&arguments.show, searches, context)?;
    // CPU times differ from machine to machine, and pictures of one seed should be equal.
    let run = |run: ShownRun| if arguments.cpu { run } else { ShownRun { cpu_samples: None, ..run } };
    Ok(shown.into_iter().map(|shown| run(shown.run).into_view()).collect())
}

/// Returns the shots of a film: one from beginning to end, or the stops of a tour.
fn shots(arguments: &RenderArguments, scene: &Scene, quiet: bool) -> Result<Shots, CliError> {
    let shots = if arguments.tour {
        let mut shots = Vec::new();
        for TourStop { from, to, speed, options } in tour(scene.runs[0], &scene.options) {
            shots.push(Shot { moments: Moments { from, to, speed, fps: arguments.fps }, options });
        }
        shots
    } else {
        vec![Shot { moments: moments(arguments, scene.runs, quiet)?, options: scene.options.clone() }]
    };
    let shots = Shots(shots);
    // The length is checked before the first frame, as a mistyped speed makes films of days.
    if shots.count() > MAX_FRAMES {
        let sentence = format!("the film would have {} frames; expected at most {MAX_FRAMES}", shots.count());
        return Err(CliError::bad_input(
            sentence,
            Some("raise --speed, lower --fps, or shorten it with --from and --to"),
        ));
    }
    Ok(shots)
}

fn moments(arguments: &RenderArguments, runs: &[&RunView], quiet: bool) -> Result<Moments, CliError> {
    let from = time_within("--from", arguments.from, runs, quiet)?;
    let to = arguments.to.unwrap_or(Moment::Event(RunEvent::End));
    let to = time_within("--to", to, runs, quiet)?;
    if from > to {
        let sentence = format!("--from is {from}; expected at most --to, {to}");
        return Err(CliError::bad_input(sentence, None));
    }
    Ok(Moments { from, to, speed: arguments.speed, fps: arguments.fps })
}
