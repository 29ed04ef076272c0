//! `wildfire cite`: what a paper says about the program and the runs that it used.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::cli::error::CliError;
use crate::cli::terminal;
use wildfire_batch::execute::BatchError;
use wildfire_batch::plan::{BatchPlan, COMMIT, PROGRAM_VERSION, PlanWriter, planner_of};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire cite > wildfire.bib
  wildfire cite runs/contest >> paper.bib
  wildfire cite runs/contest --format json")]
pub struct CiteArguments {
    /// Batch folder; the entry gives the SHA-256 of its plan, which determines all outcomes.
    #[arg(value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// Format of the entry [default: bibtex].
    #[arg(long, value_enum, value_name = "FORMAT", conflicts_with = "json")]
    pub format: Option<CitationFormat>,
    #[arg(long, hide = true)]
    pub json: bool,
}

/// The formats of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CitationFormat {
    Bibtex,
    Json,
}

/// Prints an entry for BibTeX, or what it says as an object.
pub fn run(arguments: &CiteArguments) -> Result<ExitCode, CliError> {
    let batch = arguments.folder.as_deref().map(CitedBatch::read).transpose()?;
    let commit = batch.as_ref().map_or(COMMIT.map(str::to_owned), |batch| batch.commit.clone());
    let citation = Citation { author: AUTHOR, title: TITLE, version: PROGRAM_VERSION, year: YEAR, commit, batch };
    terminal::print(&if arguments.json || arguments.format == Some(CitationFormat::Json) {
        serde_json::to_string(&citation).expect("names and numbers are JSON") + "\n"
    } else {
        entry(&citation.note())
    })?;
    Ok(ExitCode::SUCCESS)
}

const AUTHOR: &str = "The wildfire authors";
const TITLE: &str = "wildfire: a multi-agent wildfire simulation and motion-planning contest";

/// What is cited; the members in their order.
#[derive(Serialize)]
struct Citation {
    author: &'static str,
    title: &'static str,
    version: &'static str,
    year: u16,
    /// The commit of the program that began the batch, else of this one; none where it is not known.
    commit: Option<String>,
    batch: Option<CitedBatch>,
}

/// The runs that there were.
#[derive(Serialize)]
struct CitedBatch {
    scenarios: Vec<String>,
    /// Those of the trucks, with `;` between those of one run.
    planners: Vec<String>,
    /// The keys that take several values.
    swept: Vec<String>,
    seeds: String,
    runs: u64,
    content_sha256: String,
    #[serde(skip)]
    commit: Option<String>,
    compiler: Option<String>,
}

impl CitedBatch {
    fn read(folder: &Path) -> Result<Self, CliError> {
        let plan = BatchPlan::read(folder).map_err(BatchError::from)?;
        let PlanWriter { commit, compiler, .. } = BatchPlan::read_writer(folder).map_err(BatchError::from)?;
        let mut scenarios: Vec<String> = plan.variants.iter().map(|variant| variant.scenario.name.clone()).collect();
        scenarios.dedup();
        let mut planners: Vec<String> = plan.variants.iter().map(|variant| planner_of(&variant.scenario)).collect();
        planners.sort();
        planners.dedup();
        let swept = plan.swept_keys.clone();
        let seeds = plan.seeds.to_string();
        let runs = plan.count();
        let content_sha256 = plan.content_sha256();
        Ok(Self { scenarios, planners, swept, seeds, runs, content_sha256, commit, compiler })
    }
}

impl Citation {
    /// Says which commit it was and which runs there were, as far as there is something to say.
    fn note(&self) -> String {
        let commit = self.commit.iter().map(|commit| format!("Commit {}", in_bibtex(commit)));
        let batch = self.batch.iter().flat_map(|batch| {
            let CitedBatch { scenarios, planners, swept, seeds, runs, content_sha256, .. } = batch;
            let mut parts = vec![format!("Scenarios: {}", list(scenarios)), format!("planners: {}", list(planners))];
            parts.extend((!swept.is_empty()).then(|| format!("swept: {}", list(swept))));
            parts.extend([format!("seeds {seeds}"), format!("{runs} runs"), format!("plan {content_sha256}")]);
            parts
        });
        commit.chain(batch).collect::<Vec<_>>().join("; ")
    }
}

fn list(names: &[String]) -> String {
    names.iter().map(|name| in_bibtex(name)).collect::<Vec<_>>().join(", ")
}

/// An entry that classic styles know as well as those of biblatex, which print the version by itself.
fn entry(note: &str) -> String {
    let note = if note.is_empty() { String::new() } else { format!("  note         = {{{note}}},\n") };
    format!(
        "@misc{{wildfire,\n  \
           author       = {{{{{AUTHOR}}}}},\n  \
           title        = {{{TITLE}}},\n  \
           howpublished = {{Computer program, version {PROGRAM_VERSION}}},\n  \
           version      = {{{PROGRAM_VERSION}}},\n  \
           year         = {{{YEAR}}},\n\
         {note}}}\n"
    )
}

/// The year of this version.
const YEAR: u16 = 2026;

/// Escapes what acts in BibTeX and in LaTeX.
fn in_bibtex(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        match letter {
            '\\' => text.push_str("\\textbackslash{}"),
            '~' => text.push_str("\\textasciitilde{}"),
            '^' => text.push_str("\\textasciicircum{}"),
            '{' | '}' | '$' | '&' | '%' | '#' | '_' => text.extend(['\\', letter]),
            '"' | '@' => text.extend(['{', letter, '}']),
            _ => text.push(letter),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_citation_is_that_of_the_citation_file() {
        let file = include_str!("../../CITATION.cff");
        let says = |line: &str| assert!(file.lines().any(|found| found == line), "{line}");
        says(&format!("version: {PROGRAM_VERSION}"));
        says(&format!("title: \"{TITLE}\""));
        says(&format!("  - name: \"{AUTHOR}\""));
        assert!(file.lines().any(|line| line.starts_with(&format!("date-released: \"{YEAR}-"))));
    }

    #[test]
    fn an_entry_has_as_many_closing_braces_as_opening_ones() {
        for name in ["contest", "{a", "100 % of \\cell_m", "~^\"@#"] {
            let entry = entry(&format!("Scenarios: {}", in_bibtex(name)));
            let count = |brace: char, escaped: &str| entry.matches(brace).count() - entry.matches(escaped).count();
            assert_eq!(count('{', "\\{"), count('}', "\\}"), "{entry}");
            assert!(entry.starts_with("@misc{wildfire,\n") && entry.ends_with("}\n"), "{entry}");
        }
    }
}
