//! `wildfire page`: a page that computes runs itself, to watch and to play, in one file; or pages for a course.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use crate::cli::args::parse_seed;
use crate::cli::error::CliError;
use crate::cli::lessons;
use crate::cli::output_files::{Files, Format, write_all};
use wildfire_base::input_file;
use wildfire_base::time::SimTime;
use wildfire_base::whole_file::write_whole;
use wildfire_picture::film::{FrameRequest, PackedModule, RunView, ViewOptions, play_page};
use wildfire_scenario::{BUILT_IN, ScenarioText, load};
use wildfire_sim::game::{Game, GameScenario, MAX_GAME_BYTES, Side};

/// The page that comes with the program, for its module. What this computes is compared with what the program computes.
const SHIPPED_PAGE: &str = include_str!("../../assets/play.html");

/// The run that a page plays until its reader has chosen a game: from when on, when fires burn, and its changed values.
const OPENING: &str = "contest";
const OPENING_SEED: u64 = 7;
const OPENING_FROM_S: f64 = 120.0;
const OPENING_CHANGES: [&str; 1] = ["duration_s=400"];

/// The largest module that is taken, in bytes.
const MAX_MODULE_BYTES: u64 = 64_000_000;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire page -o play.html
  wildfire page fleet --seed 7 --side unimog -o dispatcher.html
  wildfire page --game game.json -o game.html

The page contains the program as a WebAssembly module. To build the module from changed sources:
  rustup target add wasm32-unknown-unknown
  cargo build -p wildfire-web --profile web --target wasm32-unknown-unknown")]
pub struct PageArguments {
    /// Scenario that the page opens with: a built-in one, or a file that uses no map files.
    #[arg(value_name = "SCENARIO", default_value = "contest", conflicts_with = "game")]
    pub scenario: String,
    /// Seed that the page opens with.
    #[arg(short, long, default_value_t = 1, value_parser = parse_seed, conflicts_with = "game")]
    pub seed: u64,
    /// Side that the reader plays; may be repeated.
    #[arg(long = "side", value_enum, value_name = "SIDE", conflicts_with = "game")]
    pub sides: Vec<PlayedSide>,
    /// Continue this saved game.
    #[arg(long, value_name = "FILE.json")]
    pub game: Option<PathBuf>,
    /// Another WebAssembly module than the one that comes with the program.
    #[arg(long, value_name = "FILE.wasm")]
    pub module: Option<PathBuf>,
    /// Output file.
    #[arg(short, long, value_name = "FILE.html", required_unless_present = "lessons")]
    pub out: Option<PathBuf>,
    /// Write seven lessons and their index to this folder instead, as `wildfire lessons` does.
    #[arg(long, hide = true, value_name = "FOLDER", conflicts_with_all = ["out", "scenario", "seed", "sides", "game", "module"])]
    pub lessons: Option<PathBuf>,
}

/// A side of the contest, as options name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PlayedSide {
    /// The arsonist.
    Wumpus,
    /// The dispatcher of the fire trucks.
    Unimog,
}

impl From<PlayedSide> for Side {
    fn from(side: PlayedSide) -> Self {
        match side {
            PlayedSide::Wumpus => Self::Wumpus,
            PlayedSide::Unimog => Self::Unimog,
        }
    }
}

pub fn run(arguments: &PageArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let Some(out) = &arguments.out else {
        let folder = arguments.lessons.as_deref().expect("the arguments require --out or --lessons");
        lessons::write(folder, quiet)?;
        return Ok(ExitCode::SUCCESS);
    };
    let game = match &arguments.game {
        Some(path) => read_game(path)?,
        None => first_game(arguments)?,
    };
    // The game is loaded once, so that a page is not written for one that no browser can begin.
    game.load()?;
    let inputs = arguments.game.iter().chain(&arguments.module).map(PathBuf::as_path).collect();
    Files { inputs, outputs: vec![(Format::Html, out)], ..Files::default() }.check()?;
    let module = match &arguments.module {
        Some(path) => PackedModule::new(&read_module(path)?),
        None => PackedModule::from_page(SHIPPED_PAGE).expect("tests look for the module"),
    };
    let setup = serde_json::to_string(&game).expect("names and numbers are JSON");
    // The run is simulated now, so the page has something to show before its reader has chosen a game.
    let opening = load(OPENING, &OPENING_CHANGES.map(str::to_owned))?;
    let opening =
        wildfire_sim::run(&opening, OPENING_SEED).map_err(|error| CliError::run_failed(error.to_string()))?.timeline;
    let request = FrameRequest {
        runs: &[&RunView::new(opening, None)],
        time: SimTime::from_seconds(OPENING_FROM_S),
        options: &ViewOptions::default(),
    };
    let page = play_page(&module, &request, &setup);
    write_all(&[(Some(out), &|path| write_whole(path, page.as_bytes()))], quiet)?;
    Ok(ExitCode::SUCCESS)
}

fn first_game(arguments: &PageArguments) -> Result<Game, CliError> {
    let name = &arguments.scenario;
    let scenario = if BUILT_IN.iter().any(|(existing, _)| existing == name) {
        GameScenario::Name(name.clone())
    } else {
        GameScenario::Text(ScenarioText::open(name)?.text)
    };
    let mut plays: Vec<Side> = Vec::new();
    for side in arguments.sides.iter().copied().map(Side::from) {
        if !plays.contains(&side) {
            plays.push(side);
        }
    }
    Ok(Game::new(scenario, Vec::new(), arguments.seed, plays))
}

/// Reads a game that was saved from a page.
pub fn read_game(path: &Path) -> Result<Game, CliError> {
    let refuse = |reason: String| CliError::bad_input(format_args!("{}: {reason}", path.display()), None);
    let text = input_file::read(path, MAX_GAME_BYTES).and_then(input_file::text);
    let text = text.map_err(|error| refuse(format!("it cannot be read: {error}")))?;
    Game::from_json(&text).map_err(|error| refuse(error.to_string()))
}

fn read_module(path: &Path) -> Result<Vec<u8>, CliError> {
    let refuse = |reason: String| CliError::bad_input(format_args!("{}: {reason}", path.display()), None);
    let module =
        input_file::read(path, MAX_MODULE_BYTES).map_err(|error| refuse(format!("it cannot be read: {error}")))?;
    if module.starts_with(b"\0asm") { Ok(module) } else { Err(refuse("it is no WebAssembly module".to_owned())) }
}
