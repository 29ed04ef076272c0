//! The part that `wildfire play` and `wildfire render` share: the runs to show, one or two side by side, and the view
//! of them.

mod args;
mod page_file;
mod source;
mod verdicts;

pub use args::{Moment, RunEvent, ShowArguments, look, parse_agent, parse_moment, parse_speed};
pub use page_file::{check_grounds, write_page};
pub use source::{Searches, ShownRun, Source, run_of_batch};

use source::Named;

use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::terminal;
use wildfire_base::time::SimTime;
use wildfire_picture::film::{Layer, Layers, RunView};
use wildfire_scenario::MemoryLimit;
use wildfire_timeline::{AgentFact, Fact};

/// A run, and where others like it come from.
pub struct Shown {
    pub source: Source,
    pub run: ShownRun,
}

/// The runs that are asked for, one or two.
pub fn shown_runs(
    arguments: &ShowArguments,
    searches: Searches,
    context: &CommandContext,
) -> Result<Vec<Shown>, CliError> {
    let named = Named::open(&arguments.source)?;
    let source = Source::new(&named, &arguments.overrides, arguments.memory.memory, context)?;
    // Both sources are opened before the first run is simulated, as the second name may be wrong.
    let second = second_source(arguments, &named, context)?;
    let mut run = source.run(arguments.seed, searches)?;
    if let Some(path) = &arguments.why {
        run.verdicts = verdicts::read(path, &run.timeline)?;
    }
    let seed = run.timeline.setting.seed;
    let mut shown = vec![Shown { source, run }];
    if let Some(source) = second {
        // Without a seed of its own the second run has that of the first, which makes both a pair.
        let seed = if source.has_one_run() { arguments.with_seed } else { arguments.with_seed.or(Some(seed)) };
        let run = source.run(seed, searches)?;
        shown.push(Shown { source, run });
        tell_apart(&mut shown, arguments);
    }
    if !context.quiet {
        shown.iter().flat_map(|shown| shown.notes(arguments.layers())).for_each(|note| terminal::note(&note));
    }
    terminal::note_unknown_letters(shown.iter().map(|shown| shown.run.title.as_str()), context.quiet);
    Ok(shown)
}

/// Runs of one title and seed are called by the names that they were asked for by, recordings above all.
fn tell_apart(shown: &mut [Shown], arguments: &ShowArguments) {
    if let ([first, second], Some(with)) = (shown, &arguments.with)
        && title_and_seed(first) == title_and_seed(second)
    {
        first.rename(&arguments.source);
        second.rename(with);
    }
}

fn title_and_seed(shown: &Shown) -> (String, u64) {
    (shown.run.title.clone(), shown.run.timeline.setting.seed)
}

/// Opens a scenario or a recording, or the folder of a batch, by its name.
pub fn source_of_runs(
    name: &str,
    overrides: &[String],
    memory: Option<MemoryLimit>,
    context: &CommandContext,
) -> Result<Source, CliError> {
    Source::new(&Named::open(name)?, overrides, memory, context)
}

fn second_source(
    arguments: &ShowArguments,
    first: &Named,
    context: &CommandContext,
) -> Result<Option<Source>, CliError> {
    let changes = &arguments.with_overrides;
    let memory = arguments.memory.memory;
    match &arguments.with {
        Some(name) => Source::new(&Named::open(name)?, changes, memory, context).map(Some),
        None if changes.is_empty() && arguments.with_seed.is_none() => Ok(None),
        None => {
            // Changes of the second run come after those of both, and win over them.
            let all = arguments.overrides.iter().chain(changes).cloned().collect::<Vec<_>>();
            Source::new(first, &all, memory, context).map(Some)
        }
    }
}

impl Shown {
    fn rename(&mut self, title: &str) {
        title.clone_into(&mut self.run.title);
        self.source.rename(title);
    }

    /// Lists what a viewer may miss, with the reason.
    fn notes(&self, layers: Layers) -> impl Iterator<Item = String> {
        [self.source.note(), self.note_on_searches(layers)].into_iter().flatten()
    }

    fn note_on_searches(&self, layers: Layers) -> Option<String> {
        let mut of_searches = Layer::ALL.into_iter().filter(|&layer| layer.needs_searches() && layers.contains(layer));
        let missed = of_searches.next()?.name();
        let is_searched = self
            .run
            .timeline
            .events
            .iter()
            .any(|event| matches!(event.fact, Fact::Agent(_, AgentFact::Searched { .. })));
        let how = "record with `wildfire run --record-searches --out FILE`";
        (!is_searched).then(|| format!("the layer {missed} stays empty, as no searches were recorded: {how}"))
    }
}

/// The time of a moment that the option `name` asks for; shares are of the longest run, events of the first. One beyond the
/// end of the last run is its end, which a note says.
///
/// # Errors
/// If the first run does not have the event.
pub fn time_within(name: &str, moment: Moment, films: &[&RunView], quiet: bool) -> Result<SimTime, CliError> {
    let end = RunView::last_end(films);
    let time = match moment {
        Moment::Seconds(seconds) => SimTime::from_seconds(seconds),
        Moment::Share(share) => SimTime::from_seconds(share * end.as_seconds()).min(end),
        Moment::Event(event) => time_of_event(name, event, films)?,
    };
    if time > end && !quiet {
        terminal::note(&note_beyond_end(name, time, end));
    }
    Ok(time.min(end))
}

/// Returns when an event of the first run happened.
fn time_of_event(option: &str, event: RunEvent, films: &[&RunView]) -> Result<SimTime, CliError> {
    let index = films[0].index();
    let (time, reason) = match event {
        RunEvent::End => return Ok(RunView::last_end(films)),
        RunEvent::FirstFire => (index.first_ignition(), "nothing burns in this run"),
        RunEvent::FirstFailure => (index.first_failure(), "every plan of this run succeeds"),
        RunEvent::LargestSearch if index.has_searches() => {
            (index.largest_search().map(|search| search.time), "no agent of this run searches for a path")
        }
        RunEvent::LargestSearch => {
            (None, "the recording has no searches; expected one of `wildfire run --record-searches`")
        }
    };
    time.ok_or_else(|| CliError::bad_input(format_args!("{option} {}: {reason}", event.name()), None))
}

/// Says that the end of a run takes the place of a time beyond it.
pub fn note_beyond_end(option: &str, time: SimTime, end: SimTime) -> String {
    format!("{option} is {time}, but the run ends at {end}: the end is taken")
}

#[cfg(test)]
mod tests {
    use std::fs;

    use clap::Parser;

    use super::*;
    use wildfire_scenario::BUILT_IN;
    use wildfire_sim::CustomRegistry;

    #[derive(Parser)]
    struct ShowCommand {
        #[command(flatten)]
        show: ShowArguments,
    }

    fn titles(args: &str) -> Vec<String> {
        let command = ShowCommand::parse_from(["show"].into_iter().chain(args.split(' ')));
        let shown = shown_runs(&command.show, Searches::LeftOut, &CommandContext::new(true, CustomRegistry::default()))
            .expect("both runs take place");
        shown.into_iter().map(|shown| shown.run.title).collect()
    }

    #[test]
    fn two_runs_are_distinguished_by_their_titles() {
        assert_eq!(titles("smoke --with-set fire.burn_out_s=20"), ["smoke", "smoke, fire.burn_out_s=20"]);
        assert_eq!(titles("smoke --with-seed 2"), ["smoke", "smoke"]);
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let copy = scratch.path().join("mine.toml").display().to_string();
        let (_, smoke) = BUILT_IN.iter().find(|(name, _)| *name == "smoke").expect("it is built in");
        fs::write(&copy, smoke).expect("writable");
        assert_eq!(titles(&format!("smoke --with {copy}")), ["smoke", &copy]);
    }
}
