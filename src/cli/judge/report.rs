//! The report on judged paths: an object, a table and a document, with differences to planners that were asked too.

use serde::{Serialize, Serializer};

use wildfire_base::document::{Block, Document};
use wildfire_base::object;
use wildfire_base::untrusted::visible_start;
use wildfire_batch::drives::{
    COMPARED, DRIVE_LEGEND, DriveContrast, DriveQuery, DriveTable, PlannerSummary, SHOWN_ROWS, contrast_table,
    failure_sentences, rows_table, summary_table, violation_sentences,
};
use wildfire_batch::plan::PROGRAM_VERSION;

/// All paths, and what was found.
pub struct JudgeReport {
    /// What the paths are of.
    title: String,
    pub drives: DriveTable,
    summaries: Vec<PlannerSummary>,
    contrasts: Vec<DriveContrast>,
}

impl JudgeReport {
    /// `judged` are those who computed the paths, `against` those that they are set beside.
    pub fn new(title: String, judged: &[String], against: &[String], rows: Vec<DriveQuery>) -> Self {
        let contrasts = DriveContrast::all(judged, against, &rows);
        let drives = DriveTable::of_one_variant(rows);
        Self { title, summaries: PlannerSummary::all(&drives), drives, contrasts }
    }

    pub fn has_violations(&self) -> bool {
        self.summaries.iter().any(|summary| summary.violations > 0)
    }
}

impl Serialize for JudgeReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let report = object!(Report {
            program_version: PROGRAM_VERSION,
            rows: self.drives.members(),
            summary: self.drives.summary_members(&self.summaries),
            comparisons: &self.contrasts,
        });
        report.serialize(serializer)
    }
}

impl From<&JudgeReport> for Document {
    /// A row for each goal if they are not too many, a row for each planner, what is wrong, and differences.
    fn from(report: &JudgeReport) -> Self {
        let mut document = Self::new(report.title.clone());
        // A table of thousands of goals would push the summary off the screen.
        if report.drives.rows.len() <= SHOWN_ROWS {
            document.add(rows_table(&report.drives.rows));
        }
        document.add(summary_table(&report.summaries));
        let failures = failure_sentences(&report.drives).into_iter();
        document.add_list(failures.chain(violation_sentences(&report.drives)).collect());
        document.add(Block::List(DRIVE_LEGEND.map(str::to_owned).to_vec()));
        for pair in report.contrasts.chunk_by(|a, b| (&a.planner, &a.against) == (&b.planner, &b.against)) {
            let planner = visible_start(&pair[0].planner);
            let against = visible_start(&pair[0].against);
            document.add(Block::Heading(format!("{planner} against {against}")));
            document.add(contrast_table(pair));
        }
        if !report.contrasts.is_empty() {
            document.add(Block::Text(COMPARED.into()));
        }
        document
    }
}
