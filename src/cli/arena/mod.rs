//! `wildfire arena`: frozen tracks, entries, and boards whose every number anybody recomputes.

use std::collections::BTreeMap;
use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Subcommand};

use crate::cli::args::{ProgramArguments, jobs_or_all, parse_jobs};
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::report::FormArguments;
use crate::cli::terminal::{self, Progress};
use wildfire_base::document::number::count;
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::input_file;
use wildfire_base::object;
use wildfire_base::time::wall::WallStopwatch;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::arena::{
    ARENA_VERSION, ArenaEntry, ArenaError, ArenaRow, Board, Played, Players, SubmissionCheck, TRACKS, Track,
    TrackBoard, TrackCheck, play, total_failure,
};
use wildfire_batch::plan::{BatchPlan, CourseRefusal, MAX_SEEDS_BYTES, Seeds};
use wildfire_scenario::Scenario;
use wildfire_sim::programs::ProgramPool;

/// The folder of a board, unless another is named.
const BOARD: &str = "board";

/// Seeds of each track that `submit-check` plays, and rows that differ which are listed.
const CHECKED_SEEDS: usize = 3;
const MAX_LISTED: usize = 20;

#[derive(Debug, Subcommand)]
pub enum ArenaCommand {
    /// List the tracks, or write their files: rules, scenario, seeds, reference entries.
    Tracks(TracksArguments),
    /// Check an entry before it is submitted: its rules, three seeds of each track, and what all seeds would cost.
    SubmitCheck(SubmitArguments),
    /// Play entries on a track and add their rows to a board.
    Run(ArenaRunArguments),
    /// Rank the entries of a board; write the ranking beside its rows as JSON, Markdown and a page, and a data card.
    Rank(ArenaRankArguments),
    /// Play a board's runs again and name rows that differ; exit with 4 if there are any.
    Recompute(RecomputeArguments),
    /// Play the reference entries and compare them with the frozen rows; exit with 4 if any row differs.
    Verify(VerifyArguments),
}

#[derive(Debug, Args)]
pub struct TracksArguments {
    /// Write the files of the tracks into this folder, a folder for each.
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub form: FormArguments,
}

/// How runs are played.
#[derive(Clone, Debug, Args)]
pub struct ArenaPlayArguments {
    /// Number of threads [default: the number of processors].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// Allow programs named in entries to run; modules need no trust.
    #[arg(long)]
    pub trust: bool,
}

#[derive(Debug, Args)]
pub struct SubmitArguments {
    /// The entry: a folder with entry.toml, or that file.
    #[arg(value_name = "ENTRY")]
    pub entry: PathBuf,
    /// Check only this track; may be repeated [default: all that the entry names].
    #[arg(long, value_name = "NAME")]
    pub track: Vec<String>,
    #[command(flatten)]
    pub play: ArenaPlayArguments,
    #[command(flatten)]
    pub form: FormArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Rows of an entry that the board has already are replaced.

Examples:
  wildfire arena tracks
  wildfire arena submit-check entries/mine
  wildfire arena run entries/mine entries/yours --track contest
  wildfire arena rank")]
pub struct ArenaRunArguments {
    /// Entries: folders with entry.toml, or such files.
    #[arg(value_name = "ENTRY", required = true)]
    pub entries: Vec<PathBuf>,
    /// Play only this track; may be repeated [default: all that an entry names].
    #[arg(long, value_name = "NAME")]
    pub track: Vec<String>,
    /// Seeds: `public`, `hidden`, or a file with the list to which the track committed itself.
    #[arg(long, value_name = "WHICH", default_value = "public")]
    pub seeds: String,
    /// Folder of the board.
    #[arg(short = 'o', long = "out", alias = "board", value_name = "DIR", default_value = BOARD)]
    pub board: PathBuf,
    #[command(flatten)]
    pub play: ArenaPlayArguments,
}

#[derive(Debug, Args)]
pub struct ArenaRankArguments {
    /// Folder of the board.
    #[arg(value_name = "BOARD", default_value = BOARD)]
    pub board: PathBuf,
    /// Rank only this track; may be repeated.
    #[arg(long, value_name = "NAME")]
    pub track: Vec<String>,
    #[command(flatten)]
    pub form: FormArguments,
}

#[derive(Debug, Args)]
pub struct RecomputeArguments {
    /// Folder of the board.
    #[arg(value_name = "BOARD", default_value = BOARD)]
    pub board: PathBuf,
    /// Share of the rows to recompute, such as 5%; they are spread evenly over entries, conditions and seeds.
    #[arg(long, value_name = "SHARE", default_value = "100%", value_parser = parse_share)]
    pub sample: f64,
    /// Recompute only this track; may be repeated.
    #[arg(long, value_name = "NAME")]
    pub track: Vec<String>,
    #[command(flatten)]
    pub play: ArenaPlayArguments,
}

#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// Verify only this track; may be repeated.
    #[arg(long, value_name = "NAME")]
    pub track: Vec<String>,
    /// Number of seeds of each track, from the first [default: all].
    #[arg(long, value_name = "N")]
    pub seeds: Option<NonZeroUsize>,
    #[command(flatten)]
    pub play: ArenaPlayArguments,
}

fn parse_share(text: &str) -> Result<f64, String> {
    let percent = text.strip_suffix('%').unwrap_or(text).trim().parse::<f64>();
    let share = percent.ok().map(|percent| percent / 100.0).filter(|share| *share > 0.0 && *share <= 1.0);
    share.ok_or_else(|| "expected a share above 0 and up to 100%, such as 5%".to_owned())
}

pub fn run(command: &ArenaCommand, context: &CommandContext) -> Result<ExitCode, CliError> {
    match command {
        ArenaCommand::Tracks(arguments) => tracks(arguments, context),
        ArenaCommand::SubmitCheck(arguments) => submit_check(arguments, &ArenaStage::new(&arguments.play, context)),
        ArenaCommand::Run(arguments) => add_to_board(arguments, &ArenaStage::new(&arguments.play, context)),
        ArenaCommand::Rank(arguments) => rank(arguments),
        ArenaCommand::Recompute(arguments) => recompute(arguments, &ArenaStage::new(&arguments.play, context)),
        ArenaCommand::Verify(arguments) => verify(arguments, &ArenaStage::new(&arguments.play, context)),
    }
}

/// The tracks of these names; all of them if there are no names.
fn selected_tracks(names: &[String]) -> Result<Vec<&'static Track>, CliError> {
    if names.is_empty() {
        return Ok(TRACKS.iter().collect());
    }
    Ok(names.iter().map(|name| Track::named(name)).collect::<Result<Vec<_>, _>>()?)
}

/// Those of these tracks that an entry enters.
fn tracks_of(entry: &ArenaEntry, selected: &[&'static Track]) -> Result<Vec<&'static Track>, CliError> {
    let tracks: Vec<&'static Track> =
        selected.iter().copied().filter(|track| entry.card.tracks.iter().any(|name| name == track.name)).collect();
    if tracks.is_empty() {
        let name = &entry.card.name;
        let its = entry.card.tracks.join(", ");
        return Err(CliError::bad_input(format!("{name} enters none of these tracks; its `tracks` are {its}"), None));
    }
    Ok(tracks)
}

fn tracks(arguments: &TracksArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    if let Some(folder) = &arguments.out {
        for track in &TRACKS {
            let folder = folder.join(track.name);
            fs::create_dir_all(&folder).map_err(|error| CliError::unwritable(&folder, &error))?;
            for (name, text) in track.files() {
                let path = folder.join(name);
                write_whole(&path, text.as_bytes()).map_err(|error| CliError::unwritable(&path, &error))?;
            }
        }
        if !context.quiet {
            terminal::note(&format!("wrote {} tracks to {}", TRACKS.len(), folder.display()));
        }
        return Ok(ExitCode::SUCCESS);
    }
    let object = |track: &'static Track| {
        object!(TrackObject {
            track: track.name,
            metric: track.metric().name,
            better: track.better.name(),
            conditions: track.conditions(),
            seeds: track.public_seeds().to_string(),
            runs: runs(track),
            hidden_sha256: track.hidden_hash(),
        })
    };
    let objects: Vec<_> = TRACKS.iter().map(object).collect();
    let row = |track: &Track| {
        let about = track.readme.lines().find(|line| !line.is_empty() && !line.starts_with('#')).unwrap_or_default();
        vec![track.name.to_owned(), about.to_owned(), runs(track).to_string()]
    };
    let table =
        Table { text_columns: 2, ..Table::new(&["Track", "Measures", "Runs"], TRACKS.iter().map(row).collect()) };
    terminal::print(&arguments.form.render_either(&objects, || {
        let runs =
            "Runs: those of an entry with the public seeds. --out DIR writes all files of the tracks.".to_owned();
        Document::new(format!("Arena {ARENA_VERSION}")).with([Block::Table(table), Block::Text(runs)])
    }))?;
    Ok(ExitCode::SUCCESS)
}

/// Returns the number of runs of a track.
fn runs(track: &Track) -> u64 {
    track.conditions().len() as u64 * track.public_seeds().count()
}

/// Where entries are played: threads, and trust.
struct ArenaStage {
    context: CommandContext,
    jobs: usize,
}

impl ArenaStage {
    fn new(arguments: &ArenaPlayArguments, context: &CommandContext) -> Self {
        let programs = ProgramArguments { trust: arguments.trust, ..ProgramArguments::default() };
        Self { context: context.with_programs(&programs), jobs: jobs_or_all(arguments.jobs) }
    }

    /// Plays the runs with these numbers.
    fn play(
        &self,
        track: &Track,
        plan: &BatchPlan,
        numbers: &[u64],
        progress: &Progress,
    ) -> Result<Vec<Played>, CliError> {
        // A plan of somebody else's entry may start programs, which needs the user's consent before the first run.
        self.context.expect_trusted_plan(plan)?;
        // One pool for all runs, so that a module is compiled once.
        let pool = ProgramPool::new(self.context.trust());
        let planners_of = |scenario: &Scenario| {
            let planners = self.context.registry.planners.clone();
            pool.planners_of(scenario, planners).map_err(|error| error.to_string())
        };
        let players = Players { registry: &self.context.registry, planners_of: &planners_of, jobs: self.jobs };
        Ok(play(track, plan, numbers, &players, || progress.advance())?)
    }

    fn progress(&self, runs: u64) -> Progress {
        Progress::new(runs, "runs", self.context.quiet)
    }
}

/// The public seeds of a track, its hidden ones, or those of a file that are the hidden ones.
fn seeds_of(track: &Track, which: &str) -> Result<Seeds, CliError> {
    let text = match which {
        "public" => return Ok(track.public_seeds()),
        "hidden" => track.hidden.to_owned(),
        file => input_file::read_text(Path::new(file), MAX_SEEDS_BYTES)
            .map_err(|error| CliError::unreadable(Path::new(file), &error))?,
    };
    // The hash was published before the season: any other list may have been chosen after the results were known.
    if !track.is_hidden_list(&text) {
        let sentence = format!(
            "{which} is not the list to which the track `{}` committed itself: expected SHA-256 {}",
            track.name,
            track.hidden_hash()
        );
        return Err(CliError::bad_input(sentence, Some("--seeds public plays the seeds that everybody has")));
    }
    Seeds::from_file_text(&text).map_err(|error| CliError::bad_input(format_args!("{which}: {error}"), None))
}

fn add_to_board(arguments: &ArenaRunArguments, stage: &ArenaStage) -> Result<ExitCode, CliError> {
    let entries = arguments.entries.iter().map(|path| ArenaEntry::read(path)).collect::<Result<Vec<_>, _>>()?;
    let selected = selected_tracks(&arguments.track)?;
    let board = Board::new(&arguments.board);
    // All entries are checked before one plays: a run of hours must not end with a name.
    board.expect_distinct(&entries)?;
    fs::create_dir_all(&arguments.board).map_err(|error| CliError::unwritable(&arguments.board, &error))?;
    let mut work = Vec::new();
    for entry in &entries {
        for track in tracks_of(entry, &selected)? {
            let plan = ArenaEntry::plan(std::slice::from_ref(entry), track, seeds_of(track, &arguments.seeds)?)?;
            // Consent is asked for before any run, so a board is not left half played for want of `--trust`.
            stage.context.expect_trusted_plan(&plan)?;
            work.push((entry, track, plan));
        }
    }
    let progress = stage.progress(work.iter().map(|(_, _, plan)| plan.count()).sum());
    let mut has_violation = false;
    for (entry, track, plan) in work {
        let numbers: Vec<u64> = (1..=plan.count()).collect();
        let played = stage.play(track, &plan, &numbers, &progress)?;
        if let Some(first) = played.iter().find(|played| played.violation.is_some()) {
            has_violation = true;
            progress.note(&format!(
                "{} was not added to `{}`: seed {}: {}",
                entry.card.name,
                track.name,
                first.row.seed,
                first.violation.as_deref().unwrap_or_default()
            ));
            // An entry that breaks a rule stays off this track only.
            continue;
        }
        board.add(entry, track, played.into_iter().map(|played| played.row).collect())?;
    }
    progress.end();
    if !stage.context.quiet {
        terminal::note(&format!(
            "rank them: wildfire arena rank {}",
            wildfire_batch::plan::shell_word(&arguments.board.display().to_string())
        ));
    }
    Ok(if has_violation { ExitCode::from(exit::VIOLATION) } else { ExitCode::SUCCESS })
}

fn rank(arguments: &ArenaRankArguments) -> Result<ExitCode, CliError> {
    let board = Board::new(&arguments.board);
    let mut boards: Vec<TrackBoard> = Vec::new();
    for track in selected_tracks(&arguments.track)? {
        boards.extend(board.ranked(track)?);
    }
    if boards.is_empty() {
        let sentence = format!("{} has no rows; expected the folder of a board", arguments.board.display());
        return Err(CliError::bad_input(sentence, Some("wildfire arena run ENTRY adds the rows of an entry")));
    }
    // The board is published only after all tracks were ranked, so an error leaves the old one whole.
    boards.iter().try_for_each(|it| board.publish(it))?;
    board.publish_card()?;
    let all = || {
        let mut documents = boards.iter().map(Document::from);
        let first = documents.next().expect("there is one");
        documents.fold(first, |all, next| all.with([Block::Heading(next.title)]).with(next.blocks))
    };
    terminal::print(&arguments.form.render_either(&boards, all))?;
    Ok(ExitCode::SUCCESS)
}

/// What came of rows that were played again.
#[derive(Default)]
struct ReplayReport {
    /// Those that differ, in words.
    differences: Vec<String>,
    /// By entry, why its programs were not started in some runs, and the number of these.
    not_started: BTreeMap<String, (String, usize)>,
}

/// Plays rows again. Programs may lack something on this machine, so a run in which one does not start is no difference.
fn replay(
    stage: &ArenaStage,
    track: &'static Track,
    plan: &BatchPlan,
    rows: &[&ArenaRow],
    progress: &Progress,
    replayed: &mut ReplayReport,
) -> Result<(), CliError> {
    let seeds: BTreeMap<u64, u64> = plan.seeds.iter().zip(1..).collect();
    let mut numbers = BTreeMap::new();
    for row in rows {
        let is_it = |swept: &[wildfire_batch::plan::Value]| {
            swept[0].to_string() == row.entry
                && swept.get(1).map_or(String::new(), ToString::to_string) == row.condition
        };
        let variant = plan.variants.iter().position(|variant| is_it(&variant.swept));
        let (Some(variant), Some(seed)) = (variant, seeds.get(&row.seed)) else {
            replayed.differences.push(format!(
                "{}, {}, seed {}: there is no such run on the track `{}`",
                row.entry, row.condition, row.seed, track.name
            ));
            continue;
        };
        // Runs of a plan are numbered from 1, all seeds of a variant after one another.
        numbers.insert(variant as u64 * plan.seeds.count() + seed, *row);
    }
    let played = stage.play(track, plan, &numbers.keys().copied().collect::<Vec<_>>(), progress)?;
    let is_timed = plan.variants.iter().any(|variant| variant.scenario.needs_trust());
    // The map is in the order of run numbers, which is that of `played`.
    for (row, Played { row: again, violation, message, is_not_started, .. }) in numbers.values().zip(played) {
        let difference = row.difference(&again);
        // Only programs depend on the machine; a module that does not start is a difference.
        if is_timed && is_not_started && difference.is_some() {
            replayed.not_started.entry(again.entry).or_insert((message, 0)).1 += 1;
            continue;
        }
        let violation = violation.map(|it| format!("{}, seed {}: it violates a rule: {it}", again.entry, again.seed));
        replayed.differences.extend(difference.into_iter().chain(violation));
    }
    Ok(())
}

/// Prints rows that differ from their runs, and published files that differ from what follows from the rows.
fn report_differences(what: &str, runs: usize, found: &[String], files: &[String]) -> Result<ExitCode, CliError> {
    let mut verdict = match found.len() {
        0 => format!("{}: all of {what}", count(runs, "run")),
        differing => format!("{differing} of {} differ from {what}", count(runs, "run")),
    };
    if !files.is_empty() {
        let differ = if files.len() == 1 { "differs" } else { "differ" };
        verdict += &format!("; {} {differ} from what follows from the rows", count(files.len(), "file"));
    }
    let mut lines: Vec<String> = found.iter().take(MAX_LISTED).cloned().collect();
    lines.extend((found.len() > MAX_LISTED).then(|| format!("and {} more", found.len() - MAX_LISTED)));
    lines.extend_from_slice(files);
    let mut document = Document::new(verdict);
    document.add_list(lines);
    terminal::print(&document.to_text())?;
    Ok(if found.is_empty() && files.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) })
}

fn recompute(arguments: &RecomputeArguments, stage: &ArenaStage) -> Result<ExitCode, CliError> {
    let board = Board::new(&arguments.board);
    let tracks = selected_tracks(&arguments.track)?;
    let mut work = Vec::new();
    let mut left_out = Vec::new();
    for track in &tracks {
        let rows = board.whole_rows(track)?;
        // Rows are sampled at equal distances and not at random, so that two people check the same ones.
        let step = 1.0 / arguments.sample;
        let sampled: Vec<ArenaRow> = (0..)
            .map(|place| (f64::from(place) * step) as usize)
            .take_while(|place| *place < rows.len())
            .map(|place| rows[place].clone())
            .collect();
        let mut by_entry: BTreeMap<String, Vec<ArenaRow>> = BTreeMap::new();
        // By entry, as each plays with its own planners and programs.
        sampled.into_iter().for_each(|row| by_entry.entry(row.entry.clone()).or_default().push(row));
        for (name, rows) in by_entry {
            let seeds = rows.iter().map(|row| row.seed).collect::<std::collections::BTreeSet<_>>();
            let seeds = Seeds::from_file_text(&seeds.iter().map(|seed| format!("{seed}\n")).collect::<String>());
            let plan = ArenaEntry::plan(&[board.entry(&name)?], track, seeds.expect("there is a row"))?;
            match stage.context.expect_trusted_plan(&plan) {
                Ok(()) => work.push((track, plan, rows)),
                // Without trust the rows of programs are left out and named, and the rest is still checked.
                Err(error) => left_out.push((name, error)),
            }
        }
    }
    let runs: usize = work.iter().map(|(_, _, rows)| rows.len()).sum();
    if runs == 0 {
        if let Some((_, error)) = left_out.pop() {
            return Err(error);
        }
        let sentence = format!("{} has no rows; expected the folder of a board", arguments.board.display());
        return Err(CliError::bad_input(sentence, None));
    }
    let progress = stage.progress(runs as u64);
    let mut replayed = ReplayReport::default();
    for (track, plan, rows) in work {
        replay(stage, track, &plan, &rows.iter().collect::<Vec<_>>(), &progress, &mut replayed)?;
    }
    progress.end();
    let not_started = replayed
        .not_started
        .iter()
        .map(|(name, (message, runs))| format!("{name} could not be started in {}: {message}", count(*runs, "run")))
        .collect::<Vec<_>>()
        .join("\n");
    let left: usize = replayed.not_started.values().map(|(_, runs)| runs).sum();
    // If nothing could be played, nothing was confirmed.
    if left == runs {
        return Err(CliError::bad_input(format_args!("nothing could be recomputed: {not_started}"), None));
    }
    if left > 0 && !stage.context.quiet {
        terminal::note(&format!("left out: {not_started}"));
    }
    if !left_out.is_empty() && !stage.context.quiet {
        let names: Vec<&str> = left_out.iter().map(|(name, _)| &name[..]).collect();
        terminal::note(&format!("left out, because they are programs: {}; --trust plays them", names.join(", ")));
    }
    let files = board.ranking_differences(&tracks)?;
    report_differences("what the board says", runs - left, &replayed.differences, &files)
}

fn verify(arguments: &VerifyArguments, stage: &ArenaStage) -> Result<ExitCode, CliError> {
    let mut work = Vec::new();
    for track in selected_tracks(&arguments.track)? {
        let seeds = track.public_seeds();
        let max = arguments.seeds.map_or(usize::MAX, NonZeroUsize::get);
        let first: Vec<String> = seeds.iter().take(max).map(|seed| seed.to_string()).collect();
        let seeds = Seeds::from_file_text(&first.join("\n")).expect("some of a list");
        // There must be as many rows as runs: a frozen table with a row missing would otherwise pass unseen.
        let plan = track.golden_plan(seeds)?;
        let played: std::collections::BTreeSet<u64> = plan.seeds.iter().collect();
        let rows: Vec<ArenaRow> = track.golden().into_iter().filter(|row| played.contains(&row.seed)).collect();
        work.push((track, plan, rows));
    }
    let runs: usize = work.iter().map(|(_, _, rows)| rows.len()).sum();
    let progress = stage.progress(runs as u64);
    let mut replayed = ReplayReport::default();
    for (track, plan, rows) in work {
        if rows.len() as u64 != plan.count() {
            replayed.differences.push(format!("{}: {} golden rows, {} runs", track.name, rows.len(), plan.count()));
        }
        replay(stage, track, &plan, &rows.iter().collect::<Vec<_>>(), &progress, &mut replayed)?;
    }
    progress.end();
    report_differences("the rows that were frozen", runs, &replayed.differences, &[])
}

fn submit_check(arguments: &SubmitArguments, stage: &ArenaStage) -> Result<ExitCode, CliError> {
    let entry = ArenaEntry::read(&arguments.entry)?;
    let mut tracks = Vec::new();
    for track in tracks_of(&entry, &selected_tracks(&arguments.track)?)? {
        let public = track.public_seeds();
        let first: Vec<String> = public.iter().take(CHECKED_SEEDS).map(|seed| seed.to_string()).collect();
        let seeds = Seeds::from_file_text(&first.join("\n")).expect("some of a list");
        let plan = ArenaEntry::plan(std::slice::from_ref(&entry), track, seeds)?;
        let progress = stage.progress(plan.count());
        // All other seeds of an entry that cannot answer would take as long as its first one.
        // One seed is tried under every condition, since an entry may fail under one of them only.
        let (of_first, others): (Vec<u64>, Vec<u64>) =
            (1..=plan.count()).partition(|number| (number - 1).is_multiple_of(plan.seeds.count()));
        let mut stopwatch = WallStopwatch::start();
        let mut played = stage.play(track, &plan, &of_first, &progress)?;
        let mut timed = of_first.len();
        let cut_short = total_failure(&played);
        if cut_short.is_none() {
            // Runs of the first seed also compile modules, so they are left out of the estimate.
            (stopwatch, timed) = (WallStopwatch::start(), others.len());
            played.extend(stage.play(track, &plan, &others, &progress)?);
        }
        let all_s = stopwatch.elapsed().as_secs_f64() / timed as f64 * (public.count() * of_first.len() as u64) as f64;
        progress.end();
        tracks.push(TrackCheck::new(track, &plan, &played, cut_short, all_s));
    }
    let check = SubmissionCheck { entry, tracks };
    terminal::print(&arguments.form.render(&check))?;
    Ok(if check.is_accepted() { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) })
}

impl From<ArenaError> for CliError {
    fn from(error: ArenaError) -> Self {
        match error {
            ArenaError::Unreadable { path, source } => Self::unreadable(&path, &source),
            ArenaError::Batch(error) => error.into(),
            ArenaError::Drive(error) => error.into(),
            ArenaError::Refused(CourseRefusal::Entries(faults)) => {
                let [first, others @ ..] = &faults[..] else { unreachable!("an entry is refused for something") };
                others.iter().rev().for_each(|fault| terminal::note(&fault.to_string()));
                Self::bad_input(first, None)
            }
            error => Self::bad_input(error, None),
        }
    }
}
