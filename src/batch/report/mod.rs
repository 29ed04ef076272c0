//! What a finished batch reports: its tables and figures, who won, what went wrong, and the verdict of the audit.

mod audits;
mod finish;
mod html_report;
mod json;
mod notes;
mod profile;
mod tables;
mod tally;

pub use audits::{AuditReport, AuditSource, AuditsError, TOLD_VIOLATIONS, audit_all};
pub use finish::{Merged, merge};
pub use html_report::{ReportError, WrittenReport, write_report};
pub use json::run_json;
pub use notes::notes;
pub use tables::{SHOWN_RUNS, Tables};
pub use tally::Tally;

use crate::batch::execute::RunRow;
use crate::batch::text_table::TextTable;
use crate::stats::Series;
use profile::Profile;

/// A report of each variant, in the order of the plan.
#[derive(Clone, Debug, Default)]
pub struct BatchReport {
    pub variants: Vec<VariantReport>,
}

/// What is reported of one variant.
#[derive(Clone, Debug, Default)]
pub struct VariantReport {
    pub title: String,
    pub tables: Tables,
    pub tally: Tally,
    means: Means,
    profile: Profile,
}

/// What the overview of several variants shows, of runs that are done.
#[derive(Clone, Debug, Default)]
struct Means {
    intact_ratio: Series,
    burned_ratio: Series,
    extinguished_ratio: Series,
    stuck_s: Series,
    unimog_ms: Series,
}

impl VariantReport {
    pub fn titled(title: String) -> Self {
        Self { title, ..Self::default() }
    }

    pub fn add(&mut self, row: &RunRow) {
        self.tables.add(row);
        self.tally.add(row);
        self.profile.add(row);
        let Some(result) = &row.result else { return };
        let (means, outcome) = (&mut self.means, &result.outcome);
        means.intact_ratio.add(outcome.intact_ratio());
        means.burned_ratio.add(outcome.burned_ratio());
        means.extinguished_ratio.add(outcome.extinguished_ratio());
        means.stuck_s.add(outcome.truck_stuck_s);
        means.unimog_ms.add(result.cpu.unimog_total_s() * 1e3);
    }
}

impl BatchReport {
    /// Runs without a result.
    pub fn not_done(&self) -> u64 {
        self.variants.iter().map(|variant| variant.tally.not_done()).sum()
    }

    /// Tables and tally of each variant, under its title if there are several.
    pub fn to_markdown(&self) -> String {
        let part = |variant: &VariantReport| format!("{}\n{}\n", variant.tables.to_markdown(), variant.tally);
        match self.variants.as_slice() {
            [one] => part(one),
            several => {
                let titled = |variant: &VariantReport| format!("## {}\n\n{}", variant.title, part(variant));
                several.iter().map(titled).collect::<Vec<_>>().join("\n")
            }
        }
    }

    /// For each variant where its CPU time went.
    pub fn profile(&self) -> String {
        let part = |variant: &VariantReport| format!("CPU time of {}\n\n{}", variant.title, variant.profile.to_text());
        self.variants.iter().map(part).collect::<Vec<_>>().join("\n")
    }

    /// A line for each variant: how many runs are done, and means over them; and what there is to note of any.
    pub fn overview(&self) -> String {
        let titles = self.variants.iter().enumerate();
        let titles: String = titles.map(|(index, variant)| format!("{}: {}\n", index + 1, variant.title)).collect();
        let table = self.overview_table().to_text();
        let noted = self.variants.iter().enumerate().map(|(index, variant)| (index + 1, variant.tally.notes()));
        let noted = noted.filter(|(_, notes)| !notes.is_empty());
        let notes: String = noted.map(|(number, notes)| format!("\n{number}: {}", notes.join("\n"))).collect();
        format!("{titles}\n{table}\nMeans of the runs that are done. tables.md has the tables of each variant.{notes}")
    }

    /// The same as a table, in which variants are numbers from 1.
    pub fn overview_table(&self) -> TextTable {
        let heading = |lines: &[&str]| lines.iter().map(|&line| line.to_owned()).collect();
        let headings: [&[&str]; 8] = [
            &["Variant"],
            &["Runs", "done"],
            &["Not", "done"],
            &["Intact", "ratio"],
            &["Burned", "ratio"],
            &["Exting.", "ratio"],
            &["Truck", "stuck s"],
            &["Unimog", "CPU ms"],
        ];
        let rows = self.variants.iter().enumerate().map(|(index, variant)| variant.overview_row(index + 1)).collect();
        TextTable { headings: headings.map(heading).to_vec(), rows, rules_before: Vec::new() }
    }
}

impl VariantReport {
    fn overview_row(&self, number: usize) -> Vec<String> {
        let mean = |series: &Series, decimals: usize| match series.mean() {
            Some(mean) => format!("{mean:.decimals$}"),
            None => "-".into(),
        };
        let Means { intact_ratio, burned_ratio, extinguished_ratio, stuck_s, unimog_ms } = &self.means;
        vec![
            number.to_string(),
            self.tally.done.to_string(),
            self.tally.not_done().to_string(),
            mean(intact_ratio, 3),
            mean(burned_ratio, 3),
            mean(extinguished_ratio, 3),
            mean(stuck_s, 1),
            mean(unimog_ms, 2),
        ]
    }
}
