//! `wildfire rank`: entries of a contest, all against all.

mod document;
mod json;
mod sheets;
mod table;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use crate::batch::comparison::{Better, RankingError, RankingRequest, rank};
use crate::cli::compare::parse_where;
use crate::cli::error::CliError;
use crate::cli::output_files::{Files, Format, write_all};
use crate::cli::report::FormArguments;

const NOTES: &str = "\
Examples:
  wildfire rank runs/planners
  wildfire rank runs/anna runs/ben runs/cem --metric mean_response_s
  wildfire rank runs/course --html > ranking.html
  wildfire rank runs/course --csv ranking.csv --sheets sheets
  wildfire rank runs/sweep --where field.coverage=0.1

An entry is the runs of a batch with one planner, one policy or one value of a
key that is free; or all runs of a batch in which these do not vary. All entries
have the same seeds and the same rules: what may differ is the planner, the
truck's policy and their settings, and what --free names.

A run that failed counts as the worst value of the metric. Ranges of ranks, and
groups with a letter in common, are those of entries that are not told apart.
Metrics are those of `wildfire compare`.";

#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub struct RankArguments {
    /// Folders of batches, or their tables of runs.
    #[arg(value_name = "BATCH", required = true)]
    pub batches: Vec<PathBuf>,
    /// The metric that gives the order [default: saved].
    #[arg(long, value_name = "NAME")]
    pub metric: Option<String>,
    /// Which values of the metric are better, where it does not say so itself.
    #[arg(long, value_name = "WHICH")]
    pub better: Option<BetterArgument>,
    /// A key besides the usual ones in which entries may differ, such as `wumpus.goal`, and all below it; may be
    /// repeated.
    #[arg(long, value_name = "KEY")]
    pub free: Vec<String>,
    /// Take only runs with this value in this column; may be repeated.
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = parse_where)]
    pub only: Vec<(String, String)>,
    /// Write the table of entries to a CSV file.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Write a sheet for each entry into this folder, as Markdown: its rank, failed queries by reason, its worst runs.
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    pub sheets: Option<PathBuf>,
    #[command(flatten)]
    pub form: FormArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BetterArgument {
    Higher,
    Lower,
}

impl RankArguments {
    pub fn request(&self) -> RankingRequest {
        let better = self.better.map(|better| match better {
            BetterArgument::Higher => Better::Higher,
            BetterArgument::Lower => Better::Lower,
        });
        let Self { metric, free, only, .. } = self;
        RankingRequest { metric: metric.clone(), better, free: free.clone(), only: only.clone() }
    }
}

pub fn run(arguments: &RankArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let form = arguments.form;
    let files = Files { form, ..Files::default() }.writing([(Format::Csv, &arguments.csv)]);
    let words = files.check()?;
    let ranking = rank(&arguments.batches, &arguments.request())?;
    words.print(&form.render(&ranking))?;
    write_all(&[(arguments.csv.as_deref(), &|path| table::write(path, &ranking))], quiet)?;
    if let Some(folder) = &arguments.sheets {
        sheets::write(folder, &ranking)?;
    }
    Ok(ExitCode::SUCCESS)
}

impl From<RankingError> for CliError {
    fn from(error: RankingError) -> Self {
        match error {
            RankingError::Comparison(error) => error.into(),
            error => {
                let help = match &error {
                    RankingError::OtherRules { .. } => Some("--free KEY lets entries differ in a key"),
                    _ => None,
                };
                Self::bad_input(error, help)
            }
        }
    }
}
