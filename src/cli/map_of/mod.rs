//! `wildfire map-of`: what runs leave on every cell of their field, as rasters and pictures.

mod files;
mod report;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use crate::cli::args::{MemoryArguments, ProgramArguments, jobs_or_all, parse_jobs, parse_seed};
use crate::cli::compare::parse_where;
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::output_files::{Files, Format, write_all};
use crate::cli::report::FormArguments;
use crate::cli::show::{Searches, ShownRun, source_of_runs};
use crate::cli::terminal::{self, Progress};
use wildfire_batch::maps::{BatchQuantity, MapSource, MapsError, MapsOptions, map_batches};
use wildfire_batch::plan::Record;
use wildfire_fire::surface::crown::FireType;
use wildfire_timeline::BurnMap;

pub use files::{EarthPlace, array, raster};
use files::{MapFiles, MapOfFiles, Panel};
use report::{BatchMapReport, RunMapReport, RunQuantity};

const NOTES: &str = "\
Examples:
  wildfire map-of windy --seed 7 --arrival --png arrival.png --tif arrival.tif
  wildfire map-of run.wildfire --intensity --asc intensity.asc --bands fire.tif
  wildfire map-of runs/trucks --burn-probability --png probability.png
  wildfire map-of runs/trucks --burn-probability --minus runs/alone --png worth.png
  wildfire map-of runs/sweep --mean-arrival --where planner=prm-rs --npy arrival.npy

Of a batch, runs that were not recorded (`wildfire batch --record all`) are simulated
again from its plan: the same seed gives the same run.

Intensity, flame length and direction are those of the front, by its rate normal to
itself; cells that were lit, or set on fire by an ember, have none.

With --minus, runs are paired by seed, and files hold the mean difference; files with
-lower and -upper in their names hold the ends of its 95 % interval in each cell. A
picture then shows both maps and the difference side by side.

The first line of a file is the north edge, the first row of an array too. Cells
without a value are -9999 in rasters and NaN in arrays.";

#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub struct MapOfArguments {
    /// A scenario or a recording, for a map of one run; or the folder of a batch.
    #[arg(value_name = "RUN|BATCH")]
    pub source: String,
    #[command(flatten)]
    pub what: WhatArguments,
    /// Subtract the map of another batch, in pairs by seed.
    #[arg(long, value_name = "BATCH")]
    pub minus: Option<PathBuf>,
    /// The seed of the run [default: 1, of a batch its first].
    #[arg(short, long, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: Option<u64>,
    /// Change a value of the scenario; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    /// Take the runs of a batch with this value in this column, such as `planner=prm-rs`; may be repeated.
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = parse_where)]
    pub only: Vec<(String, String)>,
    /// The same for the batch that is subtracted [default: as --where].
    #[arg(long, value_name = "COLUMN=VALUE", value_parser = parse_where, requires = "minus")]
    pub minus_where: Vec<(String, String)>,
    /// Threads [default: as many as the machine runs at once].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    pub memory: MemoryArguments,
    #[command(flatten)]
    pub programs: ProgramArguments,
    #[command(flatten)]
    pub files: MapOfFiles,
    #[command(flatten)]
    pub form: FormArguments,
}

/// The quantity of the map.
#[derive(Clone, Copy, Debug, Args)]
#[group(id = "quantity", required = true, multiple = false)]
pub struct WhatArguments {
    /// When fire came, in seconds.
    #[arg(help_heading = "Map of one run", long)]
    pub arrival: bool,
    /// Fireline intensity, in kW/m.
    #[arg(help_heading = "Map of one run", long)]
    pub intensity: bool,
    /// Flame length, in metres.
    #[arg(help_heading = "Map of one run", long)]
    pub flame_length: bool,
    /// Compass azimuth that the front faced, in degrees.
    #[arg(help_heading = "Map of one run", long)]
    pub direction: bool,
    /// The share of runs in which the cell burned.
    #[arg(help_heading = "Map over a batch", long)]
    pub burn_probability: bool,
    /// The mean of the seconds until fire came, over the runs in which it did.
    #[arg(help_heading = "Map over a batch", long)]
    pub mean_arrival: bool,
    /// The mean of the fireline intensity in kW/m, over the runs in which a front came.
    #[arg(help_heading = "Map over a batch", long)]
    pub mean_intensity: bool,
    /// The share of runs with flames of a class, among those in which a front came: 1 to 6, up to 0.6, 1.2, 1.8, 2.4,
    /// 3.7 m and more.
    #[arg(help_heading = "Map over a batch", long, value_name = "CLASS", value_parser = clap::value_parser!(u8).range(1..=6))]
    pub flame_class: Option<u8>,
}

impl WhatArguments {
    /// The quantity over a batch, if it is one.
    fn of_batch(self) -> Option<BatchQuantity> {
        match self {
            Self { burn_probability: true, .. } => Some(BatchQuantity::BurnProbability),
            Self { mean_arrival: true, .. } => Some(BatchQuantity::MeanArrival),
            Self { mean_intensity: true, .. } => Some(BatchQuantity::MeanIntensity),
            Self { flame_class: Some(class), .. } => Some(BatchQuantity::FlameClass(class)),
            _ => None,
        }
    }

    fn of_run(self) -> RunQuantity {
        match self {
            Self { intensity: true, .. } => RunQuantity::Intensity,
            Self { flame_length: true, .. } => RunQuantity::FlameLength,
            Self { direction: true, .. } => RunQuantity::Direction,
            _ => RunQuantity::Arrival,
        }
    }
}

pub fn run(arguments: &MapOfArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let files = MapFiles::new(&arguments.files, arguments.minus.is_some());
    // This lists all paths, with the endings of lower and upper bounds, as each of these files could overwrite an input.
    let every = files.every_path();
    let outputs = every.iter().map(|(format, path)| (*format, path.as_path())).collect::<Vec<(Format, &Path)>>();
    let files_of_all = Files { outputs, form: arguments.form, ..Files::default() };
    let stream = files_of_all.writing([(Format::Tif, &arguments.files.bands)]).check()?;
    let printed = match arguments.what.of_batch() {
        Some(quantity) => {
            let (report, panels) = over_batch(quantity, arguments, context)?;
            files.write(&panels, context.quiet)?;
            arguments.form.render(&report)
        }
        None => {
            let (report, panel) = of_run(arguments.what.of_run(), arguments, context)?;
            files.write(&[panel], context.quiet)?;
            arguments.form.render(&report)
        }
    };
    stream.print(&printed)?;
    Ok(ExitCode::SUCCESS)
}

/// Maps one run of a scenario, of a recording or of a batch.
fn of_run(
    quantity: RunQuantity,
    arguments: &MapOfArguments,
    context: &CommandContext,
) -> Result<(RunMapReport, Panel), CliError> {
    if arguments.minus.is_some() {
        let help = "--burn-probability, --mean-arrival, --mean-intensity and --flame-class are maps over batches";
        return Err(CliError::bad_input("--minus takes off a batch; expected a map over a batch", Some(help)));
    }
    let (run, place) = shown_run(arguments, context)?;
    let map = BurnMap::new(&run.timeline);
    let arrival_s = map.arrival_s();
    let setting = &run.timeline.setting;
    let trees = setting.spread.as_ref().is_some_and(|spread| spread.landscape().canopy.is_some());
    // Behaviour costs a fire per cell; arrival alone does not need it.
    let is_needed = quantity != RunQuantity::Arrival || arguments.files.bands.is_some();
    let behavior = if is_needed || trees { map.behavior() } else { None };
    if is_needed && behavior.is_none() {
        let sentence = format!("only bushes burn in {}, without a rate, so that fire has no intensity", run.title);
        return Err(CliError::bad_input(sentence, Some("expected ground and `fire.model = \"rothermel\"`")));
    }
    if let Some(behavior) = &behavior {
        let bands = arguments.files.bands.as_deref();
        write_all(&[(bands, &|path| place.write_bands(path, setting.frame, &arrival_s, behavior))], context.quiet)?;
    }
    let fire_types = behavior.as_ref().filter(|_| trees).map(|it| FireType::tally(&it.fire_type));
    let values = match (quantity, behavior) {
        (RunQuantity::Arrival, _) | (_, None) => arrival_s,
        (RunQuantity::Intensity, Some(behavior)) => behavior.intensity_kw_m,
        (RunQuantity::FlameLength, Some(behavior)) => behavior.flame_length_m,
        (RunQuantity::Direction, Some(behavior)) => behavior.direction_deg,
    };
    let mut report = RunMapReport::new(&run.title, quantity, &map, setting, &values);
    report.fire_types = fire_types;
    let title = format!("{}, seed {}", run.title, setting.seed);
    let panel = Panel {
        title,
        quantity: quantity.in_picture(),
        values: vec![(String::new(), values)],
        shown: Vec::new(),
        without_value: "not burned",
        ignitions: map.sources().collect(),
        burnable: None,
        setting: setting.clone(),
        place,
    };
    Ok((report, panel))
}

/// The run that is asked for, and where its field lies.
fn shown_run(arguments: &MapOfArguments, context: &CommandContext) -> Result<(ShownRun, EarthPlace), CliError> {
    let folder = Path::new(&arguments.source);
    // Changed values make another run than those of the folder.
    if folder.is_dir() && arguments.overrides.is_empty() {
        let source = open_batch(folder, &arguments.only, context)?;
        let run = source.run(arguments.seed)?;
        let found = source.timeline(&run, &context.registry)?;
        let (timeline, _) = found.ok_or_else(|| CliError::run_failed(format_args!("{} failed", source.title())))?;
        let run = ShownRun { title: source.title(), timeline, cpu_samples: None, verdicts: Vec::new() };
        return Ok((run, EarthPlace::new(Some(source.scenario()))));
    }
    if !arguments.only.is_empty() {
        return Err(CliError::bad_input("--where chooses among the runs of a batch; expected the folder of one", None));
    }
    let source = source_of_runs(&arguments.source, &arguments.overrides, arguments.memory.memory, context)?;
    // Maps show where fire went, and searches would take memory for nothing.
    let run = source.run(arguments.seed, Searches::LeftOut)?;
    if source.scenario().is_none() && run.timeline.setting.spread.is_some() && !context.quiet {
        terminal::note(
            "a recording does not say where its field lies, so rasters begin at (0, 0); its scenario or batch does",
        );
    }
    Ok((run, EarthPlace::new(source.scenario())))
}

/// Maps a batch, or the difference of two.
fn over_batch(
    quantity: BatchQuantity,
    arguments: &MapOfArguments,
    context: &CommandContext,
) -> Result<(BatchMapReport, Vec<Panel>), CliError> {
    let folder = Path::new(&arguments.source);
    if !folder.is_dir() {
        let sentence = format!("{} is no folder of a batch; expected one for a map over runs", arguments.source);
        return Err(CliError::bad_input(sentence, Some("`wildfire batch SCENARIO --seeds 1..200` makes one")));
    }
    // Either option would suggest that a single run was mapped.
    if arguments.seed.is_some() || !arguments.overrides.is_empty() {
        let sentence =
            "a map over a batch is over all its seeds and what they were run with; expected no --seed and no --set";
        return Err(CliError::bad_input(sentence, None));
    }
    let batch = open_batch(folder, &arguments.only, context)?;
    // Both sides are usually variants of one plan, and then need the same choice once.
    let minus_only = if arguments.minus_where.is_empty() { &arguments.only } else { &arguments.minus_where };
    let minus = arguments.minus.as_deref().map(|folder| open_batch(folder, minus_only, context)).transpose()?;
    let jobs = jobs_or_all(arguments.jobs);
    let count = batch.count() + minus.as_ref().map_or(0, MapSource::count);
    let progress = Progress::new(count, "runs", context.quiet);
    let options = MapsOptions { quantity, jobs, registry: &context.registry };
    let maps = map_batches(&batch, minus.as_ref(), &options, || progress.advance());
    progress.end();
    let maps = maps?;
    let report = BatchMapReport::new(quantity, &maps);
    Ok((report, Panel::over_batch(quantity, maps, &EarthPlace::new(Some(batch.scenario())))))
}

fn open_batch(folder: &Path, only: &[(String, String)], context: &CommandContext) -> Result<MapSource, CliError> {
    let source = MapSource::open(folder, only)?;
    source.batch().expect_registry(&context.registry)?;
    if source.batch().plan().record != Record::All {
        context.expect_trusted_plan(source.batch().plan())?;
    }
    Ok(source)
}

impl From<MapsError> for CliError {
    fn from(error: MapsError) -> Self {
        match error {
            MapsError::Finished(error) => error.into(),
            MapsError::Batch(error) => error.into(),
            MapsError::Unreadable { ref source, .. } => {
                let kind = source.kind();
                Self::from_input_error(error, kind)
            }
            MapsError::NoRuns => Self::run_failed(error),
            MapsError::OtherGround { .. } => {
                let help = "fields keep free where trucks start: leave trucks in and let them do nothing, with \
                            `--set suppression.dwell_s=100000`";
                Self::bad_input(error, Some(help))
            }
            MapsError::WhichVariant { .. } => Self::bad_input(error, Some("choose it with --where COLUMN=VALUE")),
            error => Self::bad_input(error, None),
        }
    }
}
