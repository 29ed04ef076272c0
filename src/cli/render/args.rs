//! The arguments of `wildfire render`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use crate::cli::show::{ShowArguments, parse_seconds, parse_speed, parse_within};
use crate::picture::GifFilm;

#[derive(Debug, Args)]
#[command(
    group = ArgGroup::new("film").args(["gif", "mp4"]).multiple(true),
    group = ArgGroup::new("outputs").args(["out", "gif", "mp4"]).multiple(true).required(true),
    after_help = "\
Examples:
  wildfire render --seed 7 --at 600 -o still.png
  wildfire render run.wildfire --gif film.gif --size 600x600
  wildfire render --mp4 film.mp4 --from 300 --to 900 --speed 30
  wildfire render --with-set unimog.planner=hybrid-astar -o two.png --size 1400x900
  wildfire render --at 600 --follow unimog/0 --zoom 6 --layers local-search -o near.png

It needs no screen. The same run gives the same pictures on every machine."
)]
pub struct RenderArguments {
    #[command(flatten)]
    pub show: ShowArguments,
    /// Write a still, a PNG file.
    #[arg(short, long, value_name = "FILE.png")]
    pub out: Option<PathBuf>,
    /// The simulated time of the still [default: the end of the run].
    #[arg(long, value_name = "SECONDS", requires = "out", allow_hyphen_values = true, value_parser = parse_seconds)]
    pub at: Option<f64>,
    /// Write a film as GIF.
    #[arg(long, value_name = "FILE.gif")]
    pub gif: Option<PathBuf>,
    /// Write a film as MP4; this needs the program ffmpeg.
    #[arg(long, value_name = "FILE.mp4")]
    pub mp4: Option<PathBuf>,
    /// The simulated time at which the film begins.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, requires = "film", allow_hyphen_values = true, value_parser = parse_seconds)]
    pub from: f64,
    /// The simulated time at which the film ends [default: the end of the run].
    #[arg(long, value_name = "SECONDS", requires = "film", allow_hyphen_values = true, value_parser = parse_seconds)]
    pub to: Option<f64>,
    /// Simulated seconds for a second of the film, from 0.1 to 1000.
    #[arg(long, value_name = "X", default_value_t = 60.0, requires = "film", allow_hyphen_values = true, value_parser = parse_speed)]
    pub speed: f64,
    /// Frames for a second of the film.
    #[arg(long, value_name = "FRAMES", default_value_t = 20.0, requires = "film", allow_hyphen_values = true, value_parser = parse_fps)]
    pub fps: f64,
    /// Also show the CPU time of planners, which is measured and so never the same twice.
    #[arg(long)]
    pub cpu: bool,
}

fn parse_fps(text: &str) -> Result<f64, String> {
    parse_within(text, 1.0..=100.0 / f64::from(GifFilm::LEAST_DELAY))
}
