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

Recordings play at once; scenarios are simulated first. In the window, ? shows all keys.
A program that was built without its window writes a page that plays the run, and opens
it in the browser if there is a display.")]
pub struct PlayArguments {
    #[command(flatten)]
    pub show: ShowArguments,
    /// Playback speed in simulated seconds per second, from 0.1 to 1000.
    #[arg(long, value_name = "X", default_value_t = 10.0, allow_hyphen_values = true, value_parser = parse_speed)]
    speed: f64,
    /// Start at this simulated time: seconds, `h:mm:ss`, a share of the run as `50%`, `first-fire`, `first-failure`,
    /// `largest-search` or `end`.
    #[arg(long, value_name = "TIME", default_value = "0", allow_hyphen_values = true, value_parser = parse_moment)]
    at: Moment,
    /// Start paused.
    #[arg(long)]
    paused: bool,
    /// Insist on the window, also where the program was built without it.
    #[arg(long)]
    window: bool,
}

#[cfg(feature = "view")]
pub fn run(arguments: &PlayArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    use crate::cli::show::{Searches, look, shown_runs, time_within};
    use wildfire_picture::film::RunView;
    use wildfire_view::{RunLoader, ViewerConfig, play};

    let shown = shown_runs(&arguments.show, Searches::Recorded, context)?;
    let runs = shown.into_iter().map(|shown| {
        let run = shown.run.into_view();
        // A source of one run has nothing else to load, and the window then shows no choice of seeds.
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
        start: time_within("--at", arguments.at, &seen, context.quiet)?,
        speed: arguments.speed,
        is_paused: arguments.paused,
        size: arguments.show.size.into(),
        runs,
    };
    play(config).map_err(CliError::environment)?;
    Ok(ExitCode::SUCCESS)
}

/// Writes a page of the runs and opens it.
#[cfg(not(feature = "view"))]
pub fn run(arguments: &PlayArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    use crate::cli::show::{Searches, check_grounds, look, shown_runs, time_within, write_page};
    use crate::cli::terminal;
    use wildfire_batch::execute::file_name_of;
    use wildfire_picture::film::{FrameRequest, RunView};

    if arguments.window {
        let command = "cargo run --release --features view -- play";
        let sentence = format_args!(
            "built without the window; `wildfire play` without --window opens a page in the browser; to build with the \
             window: {command}"
        );
        return Err(CliError::environment(sentence));
    }
    let runs: Vec<RunView> = shown_runs(&arguments.show, Searches::Recorded, context)?
        .into_iter()
        .map(|shown| shown.run.into_view())
        .collect();
    let runs: Vec<&RunView> = runs.iter().collect();
    check_grounds(&runs)?;
    let setting = &runs[0].timeline().setting;
    let name = format!("wildfire-{}-seed-{}.html", file_name_of(runs[0].title()), setting.seed);
    // It lies in the folder for temporary files, under a name of its own: the same run replaces its own page only.
    let path = std::env::temp_dir().join(name);
    let options = look(&arguments.show, &runs)?;
    let time = time_within("--at", arguments.at, &runs, context.quiet)?;
    write_page(&FrameRequest { runs: &runs, time, options: &options }, &path)?;
    terminal::print(&format!("{}\n", path.display()))?;
    if !terminal::open_in_browser(&path) && !context.quiet {
        terminal::note("open that file in a browser; `wildfire play --help` says how to play in a window");
    }
    Ok(ExitCode::SUCCESS)
}
