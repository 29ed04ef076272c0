//! `wildfire attain`.

use std::num::NonZeroUsize;
use std::process::ExitCode;

use clap::Args;
use serde::{Serialize, Serializer};

use crate::cli::args::{MemoryArguments, ScenarioArguments, jobs_or_all, parse_jobs};
use crate::cli::batch::{SeedsArgument, parse_seeds};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::report::FormArguments;
use crate::cli::terminal::Progress;
use crate::cli::{numbers, terminal};
use wildfire_base::document::number::{optional, rounded};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::object;
use wildfire_batch::decisions::{HindsightBound, HindsightBudget, attain_all};
use wildfire_batch::execute::limit_threads;
use wildfire_batch::stats::{Interval, Series, UNBOUNDED};
use wildfire_scenario as scenario;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire attain fleet --seeds 1..10
  wildfire attain fleet --set dispatch.policy=auction --runs 1000 --format json

The search knows what the arsonists will do, so no dispatcher needs to be able to do as well;
but every loss that it finds is that of a run by the rules. A better one may exist, except
where all choices of a single truck were played.")]
pub struct AttainArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    #[command(flatten)]
    pub memory: MemoryArguments,
    /// Seeds, such as `7`, `1..5`, `1,5,9` or `@seeds.txt`.
    #[arg(short, long, default_value = "1..5", allow_hyphen_values = true, value_parser = parse_seeds)]
    pub seeds: SeedsArgument,
    /// Alternatives to try for each decision: the cells nearest to the truck.
    #[arg(long, default_value_t = 4, allow_hyphen_values = true, value_parser = parse_choices)]
    pub choices: usize,
    /// The most runs that are played for each seed.
    #[arg(long, default_value_t = 400, allow_hyphen_values = true, value_parser = parse_runs)]
    pub runs: u32,
    /// Number of threads [default: the number of processors].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    pub form: FormArguments,
}

fn parse_choices(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(1..=1000), "a whole number")
}

fn parse_runs(text: &str) -> Result<u32, String> {
    numbers::parse_within(text, &(1..=1_000_000), "a whole number")
}

/// Refuses more: each seed takes seconds to minutes.
const MAX_SEEDS: u64 = 100_000;

pub fn run(arguments: &AttainArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let changes = context.with_custom_names(&arguments.scenario.overrides);
    let scenario = scenario::load(&arguments.scenario.source, &changes)?;
    context.expect_trusted(&scenario)?;
    context.note_doubts([&scenario]);
    let seeds = arguments.seeds.seeds()?;
    // This comes before the list is made, which a mistyped range would fill memory with.
    if seeds.count() > MAX_SEEDS {
        let sentence = format!("--seeds has {} seeds; expected at most {MAX_SEEDS}", seeds.count());
        return Err(CliError::bad_input(sentence, None));
    }
    let seeds: Vec<u64> = seeds.iter().collect();
    limit_threads(jobs_or_all(arguments.jobs));
    let options = context.run_options(false, arguments.memory.limit());
    let progress = Progress::new(seeds.len() as u64, "seeds", context.quiet);
    let budget = HindsightBudget { choices: arguments.choices, runs: arguments.runs };
    let rows = attain_all(&scenario, &seeds, &options, budget, || progress.advance());
    progress.end();
    let report = AttainReport { scenario: scenario.name.clone(), seeds, rows: rows.map_err(CliError::run_failed)? };
    terminal::print(&arguments.form.render(&report))?;
    Ok(ExitCode::SUCCESS)
}

struct AttainReport {
    scenario: String,
    seeds: Vec<u64>,
    rows: Vec<HindsightBound>,
}

/// The most seeds that have a row each.
const LISTED: usize = 20;

impl AttainReport {
    /// Returns losses, attainable losses and their differences.
    fn series(&self) -> [(&'static str, Series); 3] {
        let of =
            |value: fn(&HindsightBound) -> f64| Series::from_values(&self.rows.iter().map(value).collect::<Vec<_>>());
        [
            ("lost", of(|row| row.lost as f64)),
            ("attainable", of(|row| row.attainable as f64)),
            ("regret_attainable", of(|row| (row.lost - row.attainable) as f64)),
        ]
    }
}

impl From<&AttainReport> for Document {
    fn from(report: &AttainReport) -> Self {
        let rows = report.seeds.iter().zip(&report.rows).take(LISTED).map(|(seed, row)| {
            let headroom = row.lost - row.attainable;
            [*seed as usize, row.lost, row.attainable, headroom, row.answers.len(), row.runs as usize]
                .map(|number| number.to_string())
                .to_vec()
        });
        let mut rows: Vec<Vec<String>> = rows.collect();
        let series = report.series();
        let rules_before = vec![rows.len()];
        let line = |name: &str, value: &dyn Fn(&Series) -> Option<f64>| {
            let cells = series.iter().map(|(_, series)| optional(value(series), 1));
            [name.to_owned()].into_iter().chain(cells).chain([String::new(), String::new()]).collect::<Vec<_>>()
        };
        rows.push(line("Mean", &Series::mean));
        rows.push(line("95% low", &|series| {
            series.mean_interval_within(UNBOUNDED).map(|interval: Interval| interval.low)
        }));
        rows.push(line("95% high", &|series| {
            series.mean_interval_within(UNBOUNDED).map(|interval: Interval| interval.high)
        }));
        let headings = ["Seed", "Lost", "Attainable", "Regret", "Answers", "Runs"];
        let [(_, lost), _, (_, headroom)] = &series;
        let mean = headroom.mean().unwrap_or(0.0);
        let lost = lost.mean().unwrap_or(0.0);
        Self::new(format!("{}: what perfect foresight could save", report.scenario)).with([
            Block::Text(format!(
                "Of {} bushes that a run loses, at least {} could be saved, on average over {} seeds.",
                rounded(lost, 1),
                rounded(mean, 1),
                report.rows.len()
            )),
            Table { rules_before, ..Table::new(&headings, rows) }.into(),
            Block::Text(
                "Regret: bushes saved by changing the given number of decisions (answers), all else as the policies have \
                 it; the best of so many runs."
                    .to_owned(),
            ),
        ])
    }
}

impl Serialize for AttainReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rows = self.seeds.iter().zip(&self.rows).map(|(seed, row)| {
            let answers = row.answers.iter().map(|(time, (agent, cell))| {
                object!(Answer { t_s: time.as_seconds(), agent: agent.to_string(), cell: [cell.col, cell.row] })
            });
            let answers = answers.collect::<Vec<_>>();
            object!(Row {
                seed: *seed,
                lost: row.lost,
                attainable: row.attainable,
                regret_attainable: row.lost - row.attainable,
                runs: row.runs,
                is_exact: row.is_exact,
                answers
            })
        });
        let rows = rows.collect::<Vec<_>>();
        let means = self.series().map(|(quantity, series)| {
            object!(Mean { quantity, mean: series.mean(), interval: series.mean_interval_within(UNBOUNDED) })
        });
        object!(Attain { scenario: &self.scenario, means, seeds: rows }).serialize(serializer)
    }
}
