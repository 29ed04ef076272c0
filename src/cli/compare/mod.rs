//! `wildfire compare`: batches, or parts of one, in pairs by seed; or a batch beside published tables.

mod table;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use crate::cli::error::CliError;
use crate::cli::next_command::help_on_unfinished;
use crate::cli::output_files::{Files, Format, write_all};
use crate::cli::report::FormArguments;
use wildfire_batch::comparison::{Amount, ComparisonError, PublishedComparison, Questions, Selection, compare};
use wildfire_batch::table::TableError;

const NOTES: &str = "\
Examples:
  wildfire compare runs/contest runs/contest-2
  wildfire compare runs/planners --by planner
  wildfire compare runs/sweep --by field.coverage=0.05,0.1,0.2 --where planner=prm-rs
  wildfire compare runs/contest runs/other --metric saved,truck_won,truck_cusps
  wildfire compare runs/original --published report
  wildfire compare runs/planners --by planner --format html > planners.html
  wildfire compare runs/contest runs/other --csv differences.csv
  wildfire compare runs/contest runs/other --metric saved --power 1
  wildfire compare runs/contest runs/other --metric truck_won --equivalent 5%

Metrics: any column of numbers in runs.csv, and
  saved       obstacles intact or extinguished    truck_won   runs that the truck wins
  burned      obstacles burning or burned out     wumpus_won  runs that the Wumpus wins
  all_out_s   until nothing burns, cut off where a run ended before

A pair is two runs of one seed, with the same values of everything else that
varies within a batch. Differences are differences of means: B - A. The output
begins with the settings in which the sides differ, from their plan.json.

--power and --equivalent take a number in the metric's unit, as in runs.csv, or
with a unit: cells, ha, %, ms, s, min, cells s, m, km, points.";

#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub struct CompareArguments {
    /// Batches or their tables of runs, each compared with the first; or a single one, whose parts are compared.
    #[arg(value_name = "BATCH", required = true)]
    pub batches: Vec<PathBuf>,
    /// Compare runs by this column: scenario, planner or a swept key; all its values or those given with the first
    /// [default: the only column that varies].
    #[arg(long, value_name = "COLUMN[=VALUE,...]", value_parser = parse_by)]
    pub by: Option<(String, Vec<String>)>,
    /// Take only runs with this value in this column; may be repeated.
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = parse_where)]
    pub only: Vec<(String, String)>,
    /// Compare a batch with published tables instead.
    #[arg(long = "published", alias = "with", value_name = "WHAT", conflicts_with_all = ["by", "metric"])]
    pub with: Option<Published>,
    /// The metrics to compare; may be repeated.
    #[arg(long, value_name = "NAME[,NAME...]", value_delimiter = ',')]
    pub metric: Vec<String>,
    /// Print how many seeds detect a difference of this size with 80 % power, and the power of the seeds at hand; `wildfire
    /// batch --until` needs no guess.
    #[arg(long, value_name = "DIFFERENCE", conflicts_with = "with", allow_hyphen_values = true)]
    pub power: Option<Amount>,
    /// Test whether the sides are equal within this margin.
    #[arg(long, value_name = "MARGIN", conflicts_with = "with", allow_hyphen_values = true)]
    pub equivalent: Option<Amount>,
    /// Write the differences to a CSV file, a row for each metric of each side.
    #[arg(long, value_name = "FILE.csv", conflicts_with = "with")]
    pub csv: Option<PathBuf>,
    #[command(flatten)]
    pub form: FormArguments,
}

/// Published tables that a batch can be compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Published {
    /// Tables I and II of the five runs published in 2024, whose rules `original-2024` keeps.
    Report,
}

impl CompareArguments {
    pub fn selection(&self) -> Selection {
        Selection { by: self.by.clone(), only: self.only.clone() }
    }
}

fn parse_by(text: &str) -> Result<(String, Vec<String>), String> {
    let Some((column, values)) = text.split_once('=') else { return Ok((text.to_owned(), Vec::new())) };
    let values: Vec<String> = values.split(',').map(str::to_owned).collect();
    let mut sorted = values.clone();
    sorted.sort();
    // A value that is given twice would be compared with itself.
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("`{}` is given twice; expected values that differ", pair[0])),
        None => Ok((column.to_owned(), values)),
    }
}

/// Reads a column and the value that runs must have in it.
pub fn parse_where(text: &str) -> Result<(String, String), String> {
    let (column, value) = text.split_once('=').ok_or("expected COLUMN=VALUE, such as `planner=prm-rs`")?;
    Ok((column.to_owned(), value.to_owned()))
}

pub fn run(arguments: &CompareArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let form = arguments.form;
    let selection = arguments.selection();
    let files = Files { form, ..Files::default() }.writing([(Format::Csv, &arguments.csv)]);
    // The check comes before the comparison, so a file which cannot be written is refused at once.
    let stream = files.check()?;
    match (arguments.with, &arguments.batches[..]) {
        (None, batches) => {
            let questions = Questions { power: arguments.power.clone(), equivalent: arguments.equivalent.clone() };
            let comparison = compare(batches, &selection, &arguments.metric)?.asking(questions)?;
            stream.print(&form.render(&comparison))?;
            write_all(&[(arguments.csv.as_deref(), &|path| table::write(path, &comparison))], quiet)?;
        }
        (Some(Published::Report), [batch]) => {
            stream.print(&form.render(&PublishedComparison::from_batch(batch, &selection)?))?;
        }
        (Some(_), several) => {
            let sentence = format!("{} batches; expected a single one to compare with the report", several.len());
            return Err(CliError::bad_input(sentence, None));
        }
    }
    Ok(ExitCode::SUCCESS)
}

impl From<ComparisonError> for CliError {
    fn from(error: ComparisonError) -> Self {
        match error {
            ComparisonError::Table(TableError::Unreadable { ref source, .. }) => {
                let kind = source.kind();
                Self::from_input_error(error, kind)
            }
            ComparisonError::Stopped { ref folder } => {
                let help = help_on_unfinished(folder);
                Self::bad_input(error, help.as_deref())
            }
            error => Self::bad_input(error, None),
        }
    }
}
