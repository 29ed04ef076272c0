//! `wildfire batch --slurm`: the script that runs a batch as an array of tasks on a cluster.
//!
//! Slurm is asked for nothing here: the script is printed, and whoever has read it submits it. Its array has a task for
//! each slice; a task that is stopped before its end, for its time is up or somebody needs its place, goes on later from
//! its journal; and a job that waits for the array puts the slices together.

use std::env;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::args::{BatchArguments, RUNS_FOLDER, SeedsArgument, SlurmArguments};
use crate::cli::args::{NamedCommand, NamedModule};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::terminal;
use wildfire_batch::execute::{OutputFolder, Pilot, file_name_of};
use wildfire_batch::plan::{BatchPlan, shell_word};

/// The tasks that a batch is cut into.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tasks {
    count: u64,
    /// The time that a task is expected to take.
    minutes: f64,
    /// The time after which Slurm ends it.
    limit_minutes: u64,
}

/// Time that a task is given beyond what is expected: to be started, and to read its plan.
const SPARE_MINUTES: f64 = 5.0;

impl Tasks {
    /// Cuts runs into at most as many tasks as are wanted, each with so many threads.
    fn new(runs: u64, pilot: &Pilot, jobs: u64, arguments: &SlurmArguments) -> Self {
        let all_minutes = pilot.mean_s() * runs as f64 / jobs as f64 / 60.0;
        // A task that is alone would be a batch as a whole, which is not begun twice; two slices are gone on with.
        let count = (all_minutes / arguments.target_minutes).ceil().clamp(2.0, arguments.max_tasks as f64);
        let minutes = all_minutes / count;
        // A machine may be half as fast as this one, and runs are of different lengths; who is stopped goes on anyway.
        let limit = 3.0 * minutes + 3.0 * pilot.longest.as_secs_f64() / 60.0 + SPARE_MINUTES;
        Self { count: count as u64, minutes, limit_minutes: limit.ceil() as u64 }
    }
}

/// Writes the script of a batch, whose runs the pilot has measured.
pub fn script(arguments: &BatchArguments, plan: &BatchPlan, context: &CommandContext) -> Result<String, CliError> {
    if !context.quiet {
        terminal::note("sizing the tasks with a pilot of at most one minute or one run");
    }
    let pilot = Pilot::run(plan, &context.registry);
    let jobs = arguments.jobs.map_or(1, |jobs| jobs.get() as u64);
    let tasks = Tasks::new(plan.count(), &pilot, jobs, &arguments.slurm);
    let name = &plan.variants[0].scenario.name;
    let folder = match &arguments.out {
        Some(path) => path.clone(),
        None => OutputFolder::next_free_path(Path::new(RUNS_FOLDER), name),
    };
    let environment = |error| CliError::environment(format_args!("cannot determine the current folder: {error}"));
    let script = Script {
        name: file_name_of(name),
        // The path is absolute, as a task does not have the shell's PATH for certain.
        program: env::current_exe().map_err(environment)?,
        works_in: env::current_dir().map_err(environment)?,
        folder,
        jobs,
        tasks,
    };
    Ok(script.text(arguments, plan, &pilot))
}

/// Refuses what only this process can read; to be called before it is read.
pub fn refuse_pipes(arguments: &BatchArguments) -> Result<(), CliError> {
    let seeds = arguments.seeds.as_ref().is_some_and(|seeds| match seeds {
        SeedsArgument::File(path) => path.as_os_str() == "-",
        SeedsArgument::Listed(_) => false,
    });
    if seeds || arguments.sources.iter().any(|source| source == "-") {
        return Err(CliError::bad_input(
            "- is the stdin of this process; expected a file that every task can read",
            None,
        ));
    }
    Ok(())
}

/// What a script is made of besides the batch's own arguments.
struct Script {
    name: String,
    program: PathBuf,
    works_in: PathBuf,
    folder: PathBuf,
    jobs: u64,
    tasks: Tasks,
}

impl Script {
    fn text(&self, arguments: &BatchArguments, plan: &BatchPlan, pilot: &Pilot) -> String {
        let Self { name, jobs, .. } = self;
        let Tasks { count, minutes, limit_minutes } = self.tasks;
        let program = path_word(&self.program);
        let works_in = path_word(&self.works_in);
        let folder = path_word(&self.folder);
        // Lines for Slurm are no shell's: a blank in a path is escaped there by quotes all the same.
        let logs = path_word(&self.folder.join("slurm"));
        let batch = batch_args(arguments);
        let keeping = self.keeping_args(arguments);
        let lock = arguments.keeping.lock.args();
        let hours = pilot.mean_s() * plan.count() as f64 / 3600.0;
        let estimate = format!(
            "{} runs, of which {} took {:.1} ms each on this machine: {hours:.1} hours of one processor, {minutes:.1} \
             minutes per task",
            plan.count(),
            pilot.runs,
            1e3 * pilot.mean_s(),
        );
        let mut text = String::new();
        write!(
            text,
            r#"#!/bin/bash
# {estimate}.
# Start it with `bash THIS_FILE`: it submits itself as an array, followed by a job that merges the slices.
#SBATCH --job-name={name}
#SBATCH --array=1-{count}
#SBATCH --cpus-per-task={jobs}
#SBATCH --time={limit_minutes}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:TERM@90
#SBATCH --chdir={works_in}
#SBATCH --output={logs}/%a.log
# Add what your cluster requires, such as a partition, an account or memory; a run may use {memory}.

program={program}
folder={folder}

if [ -z "${{SLURM_ARRAY_TASK_ID:-}}" ]; then
    script=$(realpath "$0")
    cd {works_in} && mkdir -p "$folder/slurm" || exit 3
    array=$(sbatch --parsable "$script") || exit 3
    merge=$(printf '%q ' "$program" --quiet merge "$folder" --wait{lock})
    sbatch --job-name={name}-merge --dependency="afterany:${{array%%;*}}" --cpus-per-task={jobs} \
        --time={merge_minutes} --requeue --open-mode=append --output="$folder/slurm/merge.log" --wrap="$merge" || exit 3
    echo "array ${{array%%;*}}; see: $program status $folder{lock}"
    exit
fi

# The task resumes where an earlier one stopped. Before its time is up it gets a signal, saves its runs and exits
# with 75; then it is queued again.
task=${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID
"$program" --quiet batch{batch} --out "$folder" \
    --shard "$SLURM_ARRAY_TASK_ID/{count}" --jobs "${{SLURM_CPUS_PER_TASK:-{jobs}}}"{keeping} &
child=$!
trap 'kill -TERM "$child" 2> /dev/null' TERM
wait "$child"
code=$?
# The signal interrupts the first wait.
while [ "$code" -eq 143 ] && kill -0 "$child" 2> /dev/null; do
    wait "$child"
    code=$?
done
# A cancelled task gets the same signal but is no longer running: it stays cancelled.
if [ "$code" -eq 75 ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt 100 ] &&
    [ "$(squeue --noheader --jobs="$task" --format=%T)" = RUNNING ]; then
    scontrol requeue "$task" && sleep 60
fi
# Code 1 means that a run failed, as its row explains; the slice is still complete.
[ "$code" -eq 1 ] && code=0
exit "$code"
"#,
            memory = plan.memory,
            merge_minutes = merge_minutes(plan.count()),
        )
        .expect("a string takes any text");
        text
    }

    /// Writes the options of journals. A variable in the name of the local folder is one of the task's.
    fn keeping_args(&self, arguments: &BatchArguments) -> String {
        let args = arguments.keeping.args();
        match &arguments.keeping.journal_dir {
            Some(path) if path.to_string_lossy().starts_with('$') => {
                let path = path.display().to_string();
                args.replace(&shell_word(&path), &format!("\"{}\"", path.replace(['"', '`', '\\'], "")))
            }
            _ => args,
        }
    }
}

fn path_word(path: &Path) -> String {
    shell_word(&path.display().to_string())
}

/// The time limit of the job that merges: an hour, and a minute for each ten thousand runs.
fn merge_minutes(runs: u64) -> u64 {
    60 + runs / 10_000
}

/// Writes the arguments that say which batch it is, each with a blank before it.
fn batch_args(arguments: &BatchArguments) -> String {
    let mut args: Vec<String> = arguments.sources.clone();
    for change in &arguments.set {
        args.extend(["--set".to_owned(), change.clone()]);
    }
    for NamedCommand { name, args: command } in &arguments.programs.commands {
        let command: Vec<String> = command.iter().map(|word| shell_word(word)).collect();
        args.extend(["--command".to_owned(), format!("{name}={}", command.join(" "))]);
    }
    for NamedModule { name, file } in &arguments.programs.modules {
        args.extend(["--module".to_owned(), format!("{name}={file}")]);
    }
    if arguments.programs.trust {
        args.push("--trust".to_owned());
    }
    if !arguments.planner.is_empty() {
        args.extend(["--planner".to_owned(), arguments.planner.join(",")]);
    }
    match &arguments.seeds {
        Some(SeedsArgument::Listed(seeds)) => args.extend(["--seeds".to_owned(), seeds.to_string()]),
        Some(SeedsArgument::File(path)) => args.extend(["--seeds".to_owned(), format!("@{}", path.display())]),
        None => {}
    }
    if let Some(memory) = arguments.memory {
        args.extend(["--memory".to_owned(), format!("{}B", memory.bytes)]);
    }
    if let Some(record) = arguments.record {
        let which = serde_json::to_value(record).expect("it is a word");
        args.extend(["--record".to_owned(), which.as_str().unwrap_or_default().to_owned()]);
    }
    if arguments.force {
        args.push("--force".to_owned());
    }
    args.iter().map(|word| format!(" {}", shell_word(word))).collect()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn tasks(runs: u64, run_ms: u64, jobs: u64, max_tasks: u64) -> Tasks {
        let run = Duration::from_millis(run_ms);
        let pilot = Pilot { runs: 20, total: run * 20, longest: run };
        Tasks::new(runs, &pilot, jobs, &SlurmArguments { slurm: true, target_minutes: 30.0, max_tasks })
    }

    #[test]
    fn tasks_take_the_time_that_is_asked_for_unless_they_would_be_too_many_or_too_few() {
        // A million runs of 49 ms are 13.6 hours: 28 tasks of 29 minutes, or 14 with two threads each.
        let million = tasks(1_000_000, 49, 1, 200);
        assert_eq!(million.count, 28);
        assert!((29.0..30.0).contains(&million.minutes), "{million:?}");
        assert!((90..=95).contains(&million.limit_minutes), "{million:?}");
        assert_eq!(tasks(1_000_000, 49, 2, 200).count, 14);
        let few = tasks(1_000_000, 49, 1, 10);
        assert_eq!(few.count, 10);
        assert!((81.0..82.0).contains(&few.minutes), "{few:?}");
        assert_eq!(tasks(3, 49, 1, 200).count, 2, "one slice alone could not be gone on with");
    }
}
