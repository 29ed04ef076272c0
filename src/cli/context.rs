//! What commands have besides their arguments: whether to be quiet, and the planners and policies that were registered.

use std::collections::BTreeSet;

use crate::cli::args::ProgramArguments;
use crate::cli::error::CliError;
use crate::cli::terminal;
use wildfire_batch::drives::custom_names;
use wildfire_batch::plan::BatchPlan;
use wildfire_planning::{PlannerName, Planners};
use wildfire_scenario::{MemoryLimit, Scenario, UsedProgram, doubts_of_files, is_built_in_policy};
#[cfg(not(unix))]
use wildfire_sim::programs::ONLY_ON_UNIX;
#[cfg(unix)]
use wildfire_sim::programs::sandbox;
use wildfire_sim::programs::{ProgramPool, Trust};
use wildfire_sim::{CustomRegistry, RunOptions};

/// What commands have besides their arguments.
#[derive(Clone, Debug, Default)]
pub struct CommandContext {
    pub quiet: bool,
    /// Planners and policies by name.
    pub registry: CustomRegistry,
    /// The programs of the command line, and whether those of files are trusted.
    programs: ProgramArguments,
}

impl CommandContext {
    pub fn new(quiet: bool, registry: CustomRegistry) -> Self {
        Self { quiet, registry, programs: ProgramArguments::default() }
    }

    /// Returns the same with the programs that the arguments of a command name or trust.
    pub fn with_programs(&self, programs: &ProgramArguments) -> Self {
        let mut context = Self { programs: programs.clone(), ..self.clone() };
        if context.registry.programs.is_none() {
            context.registry.programs = Some(std::sync::Arc::new(ProgramPool::new(context.trust())));
        }
        context
    }

    /// Returns the same, with or without trust in the programs of files.
    pub fn with_trust(&self, trust: bool) -> Self {
        self.with_programs(&ProgramArguments { trust, ..ProgramArguments::default() })
    }

    /// Adds to the changes of a scenario that the planners and policies that were registered are known, and the programs of
    /// the command line.
    pub fn with_custom_names(&self, changes: &[String]) -> Vec<String> {
        // A text, and a list of texts, is the same in JSON and in TOML.
        let ProgramArguments { commands, modules, .. } = &self.programs;
        let commands = commands.iter().map(|program| (&program.name, "command", serde_json::json!(program.args)));
        let modules = modules.iter().map(|program| (&program.name, "module", serde_json::json!(program.file)));
        let programs = commands.chain(modules).flat_map(|(name, key, value)| {
            // A program may be a policy too, unless a built-in one has its name.
            let kinds = if is_built_in_policy(name.name()) { &["planner"][..] } else { &["planner", "policy"] };
            kinds.iter().map(move |kind| format!("{kind}.\"{name}\".{key}={value}")).collect::<Vec<_>>()
        });
        custom_names(&self.registry).chain(programs).chain(changes.iter().cloned()).collect()
    }

    /// Returns the options of a run.
    pub fn run_options(&self, records_searches: bool, memory: MemoryLimit) -> RunOptions {
        RunOptions { records_searches, memory, ..self.registry.clone().into() }
    }

    /// Notes, once each, what of the files of scenarios may have been misread or was left out, and which ignitions light nothing.
    pub fn note_doubts<'a>(&self, scenarios: impl IntoIterator<Item = &'a Scenario>) {
        if !self.quiet {
            let doubts: BTreeSet<String> = scenarios.into_iter().flat_map(doubts_of_files).collect();
            doubts.iter().for_each(|doubt| terminal::note(doubt));
        }
    }

    /// Refuses a scenario whose runs would start a program that is not trusted.
    pub fn expect_trusted(&self, scenario: &Scenario) -> Result<(), CliError> {
        scenario.used_programs().iter().try_for_each(|used| self.expect_trusted_program(used))
    }

    /// Refuses a plan with such a scenario.
    pub fn expect_trusted_plan(&self, plan: &BatchPlan) -> Result<(), CliError> {
        plan.variants.iter().try_for_each(|variant| self.expect_trusted(&variant.scenario))?;
        #[cfg(unix)]
        if !self.quiet && plan.variants.iter().any(|variant| has_sandbox(&variant.scenario)) {
            sandbox::missing_note().iter().for_each(|note| terminal::note(note));
        }
        Ok(())
    }

    /// Refuses planners that are programs which are not trusted.
    pub fn expect_trusted_planners(&self, scenario: &Scenario, requested: &[PlannerName]) -> Result<(), CliError> {
        let tables = requested.iter().filter_map(|name| Some((name, scenario.planner.get(name)?)));
        let programs = tables.filter(|(_, table)| table.is_external());
        let mut used = programs.map(|(name, table)| UsedProgram { kind: "planner", name, table });
        used.try_for_each(|used| self.expect_trusted_program(&used))
    }

    fn expect_trusted_program(&self, used: &UsedProgram<'_>) -> Result<(), CliError> {
        let UsedProgram { kind, name, table } = used;
        #[cfg(not(unix))]
        if table.module.is_none() {
            return Err(CliError::environment(format_args!("the {kind} `{name}` is a program, and {ONLY_ON_UNIX}")));
        }
        // A module can reach nothing outside of it, see `needs_trust`; only programs come so far without trust.
        if self.trust().includes(kind, name, table) {
            return Ok(());
        }
        let folder =
            if table.works_in.as_os_str().is_empty() { ".".into() } else { table.works_in.display().to_string() };
        let command = table.command_line();
        let sentence = format!(
            "the {kind} `{name}` is a program named in a file and was not started; it would have run in {folder}: \
             {command}"
        );
        Err(CliError::bad_input(sentence, Some("if you trust the author of the file, pass --trust")))
    }

    /// Returns the planners that are known on a field of this scenario's run.
    pub fn planners_of(&self, scenario: &Scenario) -> Result<Planners, CliError> {
        ProgramPool::new(self.trust())
            .planners_of(scenario, self.registry.planners.clone())
            .map_err(|error| CliError::bad_input(error, None))
    }

    pub fn trust(&self) -> Trust {
        match self.programs.trust {
            true => Trust::All,
            false => Trust::Only(
                self.programs
                    .commands
                    .iter()
                    .flat_map(|program| ["planner", "policy"].map(|kind| (kind, program.name.clone())))
                    .collect(),
            ),
        }
    }
}

/// Says whether a run starts a program that is to run behind walls.
#[cfg(unix)]
fn has_sandbox(scenario: &Scenario) -> bool {
    scenario.used_programs().iter().any(|used| used.table.sandbox)
}
