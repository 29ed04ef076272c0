//! Asks every planner for every drive of a benchmark: of each variant with each seed, all of them the same.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::plan::arguments::PlanArguments;
use crate::cli::terminal::Progress;
use wildfire_base::input_file::is_standard_stream;
use wildfire_batch::drives::{
    AttemptSettings, DriveQuery, DriveTable, MAX_QUERIES, ask_all, expect_planners_exist, requested_planners,
};
use wildfire_batch::plan::{BatchPlan, BatchRequest, PLANNER_KEY, RequestError, Seeds, Sweep, Value, Variant};
use wildfire_planning::PlannerName;
use wildfire_scenario::{Problem, ScenarioText};

/// The variants, seeds and planners of a benchmark.
pub struct Benchmark<'a> {
    arguments: &'a PlanArguments,
    context: &'a CommandContext,
    pub text: ScenarioText,
    pub plan: BatchPlan,
    /// By variant.
    pub planners: Vec<Vec<PlannerName>>,
    /// Different values of what is swept, and which of them each variant has: variants may differ in the planner alone.
    values: Vec<Vec<Value>>,
    places: Vec<usize>,
}

/// A field with a start and goals that planners were asked for.
#[derive(Debug)]
pub struct BenchmarkProblem {
    /// Its place in the plan.
    pub variant: usize,
    pub seed: u64,
    pub field: String,
    pub goals: usize,
}

/// All answers.
#[derive(Debug, Default)]
pub struct BenchmarkAnswers {
    pub drives: DriveTable,
    /// In the order of the queries.
    pub problems: Vec<BenchmarkProblem>,
}

/// The answers of one variant with one seed.
#[derive(Default)]
struct QueryPart {
    rows: Vec<DriveQuery>,
    problems: Vec<BenchmarkProblem>,
}

impl<'a> Benchmark<'a> {
    pub fn new(arguments: &'a PlanArguments, context: &'a CommandContext) -> Result<Self, CliError> {
        if arguments.problems.fields.iter().any(|path| is_standard_stream(path)) {
            let sentence =
                "- is stdin, which can be read only once; a benchmark reads its fields for every variant and seed";
            return Err(CliError::bad_input(sentence, Some("save the field to a file first")));
        }
        // The text is read once and kept, as every variant is made of it.
        let text = ScenarioText::open(&arguments.scenario)?;
        let mut request = BatchRequest {
            scenarios: vec![arguments.scenario.clone()],
            texts: vec![text.clone()],
            changes: context.with_custom_names(&[]),
            seeds: Some(seeds(arguments)?),
            memory: Some(arguments.memory.limit()),
            ..BatchRequest::default()
        };
        arguments.overrides.iter().try_for_each(|option| request.add_option(option)).map_err(RequestError::from)?;
        let sweeps_planners = request.sweeps.iter().flat_map(Sweep::keys).any(|key| key == PLANNER_KEY);
        if sweeps_planners && !arguments.planners.is_empty() {
            let sentence = format!("--planner and --set {PLANNER_KEY}= both name planners; expected one of them");
            return Err(CliError::bad_input(
                sentence,
                Some(
                    "--planner gives all planners that it names the same \
                drives",
                ),
            ));
        }
        let plan = request.resolve(true)?;
        let planners: Vec<_> =
            plan.variants.iter().map(|variant| requested_planners(&arguments.planners, &variant.scenario)).collect();
        for (variant, names) in plan.variants.iter().zip(&planners) {
            expect_planners_exist(&context.registry, &variant.scenario, names)?;
            context.expect_trusted_planners(&variant.scenario, names)?;
        }
        let mut values: Vec<Vec<Value>> = Vec::new();
        // Variants that differ in their planners only share a place: they are rows of one table.
        let places = plan.variants.iter().map(|variant| {
            let place = values.iter().position(|existing| *existing == variant.swept).unwrap_or(values.len());
            if place == values.len() {
                values.push(variant.swept.clone());
            }
            place
        });
        let places = places.collect();
        Ok(Self { arguments, context, text, plan, planners, values, places })
    }

    /// Asks everybody for everything.
    ///
    /// # Errors
    /// If a field cannot be made, before anybody is asked.
    pub fn ask(&self) -> Result<BenchmarkAnswers, CliError> {
        self.check_size()?;
        let parts = self.parts(self.arguments.jobs.map_or(1, NonZeroUsize::get))?;
        let drives = DriveTable { keys: self.plan.swept_keys.clone(), variants: self.values.clone(), rows: Vec::new() };
        let mut answers = BenchmarkAnswers { drives, ..BenchmarkAnswers::default() };
        for part in parts {
            answers.drives.rows.extend(part.rows);
            answers.problems.extend(part.problems);
        }
        Ok(answers)
    }

    /// Makes every problem once, so that one that cannot be made is known before hours of work, and counts the queries.
    fn check_size(&self) -> Result<(), CliError> {
        let planner_count = self.planners.iter().map(Vec::len).sum::<usize>() as u64;
        let min = self.arguments.problems.problems().min_goals() as u64;
        // These are the fewest goals that a problem can have; only if they are few enough is each problem made and counted.
        let mut queries = planner_count.saturating_mul(self.plan.seeds.count()).saturating_mul(min);
        if queries <= MAX_QUERIES {
            queries = 0;
            for number in 1..=self.plan.count() {
                if queries > MAX_QUERIES {
                    break;
                }
                let goals: usize = self.problems(number)?.iter().map(|problem| problem.goals.len()).sum();
                queries += goals as u64 * self.planners[self.variant(number)].len() as u64;
            }
        }
        if queries > MAX_QUERIES {
            let sentence = format!("{queries} queries or more are too many: a benchmark takes at most {MAX_QUERIES}");
            return Err(CliError::bad_input(sentence, Some("use fewer seeds, variants, goals or planners")));
        }
        Ok(())
    }

    /// The index of the variant of a run of the plan.
    fn variant(&self, number: u64) -> usize {
        usize::try_from((number - 1) / self.plan.seeds.count()).expect("variants fit into memory")
    }

    fn problems(&self, number: u64) -> Result<Vec<Problem>, CliError> {
        let run = self.plan.run(number);
        let Variant { scenario, .. } = run.variant;
        let problems = self.arguments.problems.problems().load(scenario, run.seed);
        problems.map_err(|error| CliError::from(error).about(&self.name(number)))
    }

    fn name(&self, number: u64) -> String {
        let run = self.plan.run(number);
        format!("{}, seed {}", self.plan.title(run.variant), run.seed)
    }

    /// The answers in the order of the plan, whatever the number of threads.
    fn parts(&self, jobs: usize) -> Result<Vec<QueryPart>, CliError> {
        let count = self.plan.count();
        let next = AtomicU64::new(1);
        let has_failed = AtomicBool::new(false);
        let done = Mutex::new(Vec::new());
        let progress = Progress::new(count, "sets of drives", self.context.quiet);
        let work = || {
            loop {
                // Threads take sets one by one, as these differ in how long they take.
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number > count || has_failed.load(Ordering::Relaxed) {
                    return;
                }
                let part = self.part(number);
                // The others stop at their next part, since the command fails whatever they find.
                has_failed.fetch_or(part.is_err(), Ordering::Relaxed);
                done.lock().unwrap_or_else(PoisonError::into_inner).push((number, part));
                progress.advance();
            }
        };
        thread::scope(|scope| (0..jobs).for_each(|_| drop(scope.spawn(work))));
        progress.end();
        let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
        // Threads end in any order, and the table must not depend on it.
        done.sort_by_key(|(number, _)| *number);
        done.into_iter().map(|(_, part)| part).collect()
    }

    fn part(&self, number: u64) -> Result<QueryPart, CliError> {
        let run = self.plan.run(number);
        let index = self.variant(number);
        let Variant { scenario, .. } = run.variant;
        // Programs start again for each, as they would in a run.
        let makers = self.context.planners_of(scenario)?;
        let planners = &self.planners[index];
        let limit = self.plan.memory;
        let question =
            AttemptSettings { planners, makers: &makers, programs: &scenario.planner, seed: run.seed, limit };
        let problems = self.problems(number)?;
        let attempts = ask_all(&problems, &question);
        let attempts = attempts.map_err(|error| CliError::from(error).about(&self.name(number)))?;
        let rows = attempts.iter().map(|attempt| attempt.query(Some(run.seed), self.places[index])).collect();
        Ok(QueryPart {
            rows,
            problems: problems
                .into_iter()
                .map(|Problem { name, goals, .. }| BenchmarkProblem {
                    variant: index,
                    seed: run.seed,
                    field: name,
                    goals: goals.len(),
                })
                .collect(),
        })
    }
}

fn seeds(arguments: &PlanArguments) -> Result<Seeds, CliError> {
    match &arguments.seeds {
        Some(seeds) => seeds.seeds(),
        None => {
            Ok(Seeds::from_parts([arguments.problems.seed.to_string().as_str()].into_iter()).expect("a seed is one"))
        }
    }
}
