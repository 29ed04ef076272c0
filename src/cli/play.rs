//! `wildfire play`.

use std::process::ExitCode;

use clap::Args;

use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::show::{Moment, ShowArguments, parse_moment, parse_speed};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire play
  wildfire play contest --seed 7 --speed 50
  wildfire play run.wildfire --at 600 --paused
  wildfire play --seed 7 --with-seed 8
  wildfire play --with-set unimog.planner=hybrid-astar

Recordings play at once; scenarios are simulated first. In the window, ? shows all keys.")]
pub struct PlayArguments {
    #[command(flatten)]
    pub show: ShowArguments,
    /// Playback speed in simulated seconds per second, from 0.1 to 1000.
    #[arg(long, value_name = "X", default_value_t = 10.0, allow_hyphen_values = true, value_parser = parse_speed)]
    speed: f64,
    /// Start at this simulated time: seconds, `h:mm:ss`, or a share of the run as `50%`.
    #[arg(long, value_name = "TIME", default_value = "0", allow_hyphen_values = true, value_parser = parse_moment)]
    at: Moment,
    /// Start paused.
    #[arg(long)]
    paused: bool,
}

#[cfg(feature = "view")]
pub fn run(arguments: &PlayArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    use crate::cli::show::{Searches, look, shown_runs, time_within};
    use wildfire_picture::film::RunView;
    use wildfire_view::{RunLoader, ViewerConfig, play};

    let shown = shown_runs(&arguments.show, Searches::Recorded, context)?;
    let runs = shown.into_iter().map(|shown| {
        let run = shown.run.into_view();
        let loader: Option<Box<dyn RunLoader>> = match shown.source {
            source if source.has_one_run() => None,
            source => Some(Box::new(source)),
        };
        (run, loader)
    });
    let runs: Vec<_> = runs.collect();
    let seen: Vec<&RunView> = runs.iter().map(|(run, _)| run).collect();
    let config = ViewerConfig {
        options: look(&arguments.show, &seen)?,
        start: time_within("--at", arguments.at, &seen, context.quiet),
        speed: arguments.speed,
        is_paused: arguments.paused,
        size: arguments.show.size.into(),
        runs,
    };
    play(config).map_err(CliError::environment)?;
    Ok(ExitCode::SUCCESS)
}

/// Says how to build the program with its window.
#[cfg(not(feature = "view"))]
pub fn run(_: &PlayArguments, _: &CommandContext) -> Result<ExitCode, CliError> {
    use crate::cli::error::exit;
    use crate::cli::terminal;
    use wildfire_batch::plan::shell_word;

    let args = std::env::args_os().skip(1).map(|word| shell_word(&word.to_string_lossy())).collect::<Vec<_>>();
    let args = args.join(" ");
    terminal::note(&format!(
        "built without the window; to build with it: cargo run --release --features view -- \
        {args}"
    ));
    Ok(ExitCode::from(exit::ENVIRONMENT))
}
