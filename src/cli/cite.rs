//! `wildfire cite`: what a paper says about the program and the runs that it used.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use crate::batch::{BatchError, BatchPlan, PROGRAM_VERSION};
use crate::cli::error::CliError;
use crate::cli::terminal;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire cite > wildfire.bib
  wildfire cite runs/contest >> paper.bib")]
pub struct CiteArguments {
    /// The folder of a batch, whose plan is named with its SHA-256: it decides all outcomes.
    #[arg(value_name = "DIR")]
    pub folder: Option<PathBuf>,
}

/// Prints an entry for BibTeX.
pub fn run(arguments: &CiteArguments) -> Result<ExitCode, CliError> {
    let plan = arguments.folder.as_deref().map(BatchPlan::read).transpose().map_err(BatchError::from)?;
    let note = plan.as_ref().map(note);
    terminal::print(&entry(note.as_deref()))?;
    Ok(ExitCode::SUCCESS)
}

/// Says which runs there were.
fn note(plan: &BatchPlan) -> String {
    let mut scenarios: Vec<&str> = plan.variants.iter().map(|variant| variant.scenario.name.as_str()).collect();
    scenarios.dedup();
    let scenarios = scenarios.into_iter().map(in_bibtex).collect::<Vec<_>>().join(", ");
    format!("Scenarios: {scenarios}; seeds {}; {} runs; plan {}", plan.seeds, plan.count(), plan.content_sha256())
}

fn entry(note: Option<&str>) -> String {
    let note = note.map_or(String::new(), |note| format!("  note         = {{{note}}},\n"));
    format!(
        "@software{{wildfire,\n  \
           author       = {{{{The wildfire authors}}}},\n  \
           title        = {{wildfire: a multi-agent wildfire simulation and motion-planning contest}},\n  \
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
        says("title: \"wildfire: a multi-agent wildfire simulation and motion-planning contest\"");
        says("  - name: \"The wildfire authors\"");
        assert!(file.lines().any(|line| line.starts_with(&format!("date-released: \"{YEAR}-"))));
    }

    #[test]
    fn an_entry_has_as_many_closing_braces_as_opening_ones() {
        for name in ["contest", "{a", "100 % of \\cell_m", "~^\"@#"] {
            let entry = entry(Some(&format!("Scenarios: {}", in_bibtex(name))));
            let count = |brace: char, escaped: &str| entry.matches(brace).count() - entry.matches(escaped).count();
            assert_eq!(count('{', "\\{"), count('}', "\\}"), "{entry}");
            assert!(entry.starts_with("@software{wildfire,\n") && entry.ends_with("}\n"), "{entry}");
        }
    }
}
