//! `wildfire rank`: entries of a contest, all against all.

mod sheets;
mod table;
mod watch;

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::cli::args::{jobs_or_all, parse_jobs};
use crate::cli::compare::parse_where;
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::output_files::{Files, Format, write_all};
use crate::cli::report::FormArguments;
use crate::cli::terminal::Progress;
use wildfire_audit::SampleStep;
use wildfire_batch::comparison::{Better, EntryAudit, RankedEntry, Ranking, RankingError, RankingRequest, rank};
use wildfire_batch::report::{AuditOptions, AuditSource, audit_all};
use wildfire_batch::table::{FinishedBatch, FinishedError};

const NOTES: &str = "\
Examples:
  wildfire rank runs/planners
  wildfire rank runs/anna runs/ben runs/cem --metric mean_response_s
  wildfire rank runs/course --format html > ranking.html
  wildfire rank runs/course --csv ranking.csv --sheets sheets
  wildfire rank runs/sweep --where field.coverage=0.1
  wildfire rank runs/course --audit 3 --trust
  wildfire rank runs --watch board.html

An entry is the runs of a batch with one planner, one policy or one value of a
free key, or all runs of a batch in which these do not vary. All entries share
seeds and rules; they may differ in the planner, the truck's policy, their
settings, and the keys that --free names.

A failed run counts as the worst value of the metric. Entries that share a letter
or a range of ranks do not differ significantly. The metrics are those of
`wildfire compare`.";

#[derive(Clone, Debug, Args)]
#[command(after_help = NOTES)]
pub struct RankArguments {
    /// Batch folders, or their tables of runs.
    #[arg(value_name = "BATCH", required = true)]
    pub batches: Vec<PathBuf>,
    /// Metric to rank by [default: saved].
    #[arg(long, value_name = "NAME")]
    pub metric: Option<String>,
    /// Better values of the metric, for metrics without a usual direction.
    #[arg(long, value_name = "WHICH", value_parser = better())]
    pub better: Option<Better>,
    /// Additional key in which entries may differ, with all keys below it, such as `wumpus.goal`; may be repeated.
    #[arg(long, value_name = "KEY")]
    pub free: Vec<String>,
    /// Use only runs with this value in this column; may be repeated.
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = parse_where)]
    pub only: Vec<(String, String)>,
    /// Leave out the entry with this name; may be repeated.
    #[arg(long, value_name = "NAME")]
    pub without: Vec<String>,
    /// Repeat and audit this many runs of each entry, including its best; exit with 4 on a violation.
    #[arg(long, value_name = "N")]
    pub audit: Option<NonZeroUsize>,
    /// Allow the entries' programs to run when runs are repeated.
    #[arg(long, requires = "audit")]
    pub trust: bool,
    /// Number of threads of the audit [default: the number of processors].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// Write the table of entries to a CSV file.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Keep a page with the ranking that renews itself, without seeds, until Ctrl-C; batches may be folders of batches, in
    /// which new ones may appear.
    #[arg(long, value_name = "PAGE.html", conflicts_with_all = ["audit", "csv", "sheets", "report_form"])]
    pub watch: Option<PathBuf>,
    /// Write a Markdown sheet for each entry into this folder: rank, failed queries by reason, worst runs; and a sheet for the
    /// instructor, with seeds.
    #[arg(long, value_name = "DIR")]
    pub sheets: Option<PathBuf>,
    #[command(flatten)]
    pub form: FormArguments,
}

fn better() -> impl TypedValueParser<Value = Better> {
    let word = PossibleValuesParser::new([Better::Higher, Better::Lower].map(Better::name));
    word.map(|word| if word == Better::Higher.name() { Better::Higher } else { Better::Lower })
}

impl RankArguments {
    pub fn request(&self) -> RankingRequest {
        let Self { metric, better, free, only, without, .. } = self.clone();
        RankingRequest { metric, better, free, only, without }
    }
}

pub fn run(arguments: &RankArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let form = arguments.form;
    let files = Files { form, ..Files::default() };
    let files = files.writing([(Format::Csv, &arguments.csv), (Format::Html, &arguments.watch)]);
    let stream = files.check()?;
    if let Some(page) = &arguments.watch {
        return watch::keep_page(page, &arguments.batches, &arguments.request(), context.quiet);
    }
    let mut ranking = rank(&arguments.batches, &arguments.request())?;
    if let Some(runs) = arguments.audit {
        audit(&mut ranking, runs.get(), arguments.jobs, context)?;
    }
    stream.print(&form.render(&ranking))?;
    write_all(&[(arguments.csv.as_deref(), &|path| table::write(path, &ranking))], context.quiet)?;
    if let Some(folder) = &arguments.sheets {
        sheets::write(folder, &ranking)?;
    }
    let mut audits = ranking.entries.iter().filter_map(|entry| entry.audit.as_ref());
    let is_violated = audits.any(|audit| audit.violations > 0);
    Ok(if is_violated { ExitCode::from(exit::VIOLATION) } else { ExitCode::SUCCESS })
}

/// Repeats and audits some runs of each entry, whatever recordings there are.
fn audit(
    ranking: &mut Ranking,
    runs: usize,
    jobs: Option<NonZeroUsize>,
    context: &CommandContext,
) -> Result<(), CliError> {
    let jobs = jobs_or_all(jobs);
    // All sources are opened before the first audit: an entry without trust must not cost the audits before it.
    let sources = ranking.entries.iter().map(|entry| source(entry, runs, context)).collect::<Result<Vec<_>, _>>()?;
    let progress = Progress::new(sources.iter().map(AuditSource::count).sum(), "runs", context.quiet);
    let options = AuditOptions { jobs, step: SampleStep::default(), registry: &context.registry, listed: 1 };
    for (entry, source) in ranking.entries.iter_mut().zip(sources) {
        let report = audit_all(&[source], &options, || progress.advance())?;
        let first_violation = report.listed.first().map(ToString::to_string);
        entry.audit =
            Some(EntryAudit { runs: report.runs() + report.not_run, violations: report.violations, first_violation });
    }
    progress.end();
    Ok(())
}

/// Chooses runs of an entry: the best one, and others that divide its order evenly.
fn source(entry: &RankedEntry, runs: usize, context: &CommandContext) -> Result<AuditSource, CliError> {
    let folder = entry.table.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let batch = FinishedBatch::open(folder)?;
    batch.plan().expect_registry(&context.registry, folder).map_err(FinishedError::from)?;
    let count = entry.run_numbers.len();
    let runs = runs.min(count);
    let places = (0..runs).map(|place| (place * (count - 1)).checked_div(runs - 1).unwrap_or(0));
    let numbers: BTreeSet<u64> = places.map(|place| entry.run_numbers[place]).collect();
    for run in batch.runs().filter(|run| numbers.contains(&run.number)) {
        context.expect_trusted(&run.variant.scenario)?;
    }
    Ok(AuditSource::Repeated(Box::new(batch), numbers))
}

impl From<RankingError> for CliError {
    fn from(error: RankingError) -> Self {
        match error {
            RankingError::Comparison(error) => error.into(),
            error => {
                let help = match &error {
                    RankingError::OtherRules { .. } => {
                        Some("--free KEY lets entries differ in a key; --without NAME leaves an entry out")
                    }
                    RankingError::OtherSeeds { .. }
                    | RankingError::OtherConditions { .. }
                    | RankingError::Reuse { .. }
                    | RankingError::Impossible { .. } => Some("--without NAME leaves an entry out"),
                    _ => None,
                };
                Self::bad_input(error, help)
            }
        }
    }
}
