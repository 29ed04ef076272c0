//! The report on a benchmark: an object of all queries, and a document of what they come to.

use serde::{Serialize, Serializer};

use crate::cli::plan::benchmark::ask::BenchmarkProblem;
use wildfire_base::document::number::count;
use wildfire_base::document::{Block, Document};
use wildfire_base::object;
use wildfire_batch::drives::{
    DriveTable, INTERVAL_LEGEND, PlannerSummary, failure_sentences, interval_tables, queries_text, violation_sentences,
};
use wildfire_batch::plan::PROGRAM_VERSION;

/// The question and all answers.
pub struct BenchmarkReport<'a> {
    /// The name of the scenario.
    pub scenario: String,
    /// Changed and swept values, as on the command line.
    pub changes: &'a [String],
    pub seeds: String,
    pub drives: DriveTable,
    pub summaries: Vec<PlannerSummary>,
    pub problems: Vec<BenchmarkProblem>,
}

impl Serialize for BenchmarkReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let report = object!(Report {
            program_version: PROGRAM_VERSION,
            scenario: &self.scenario,
            changes: self.changes,
            seeds: &self.seeds,
            keys: &self.drives.keys,
            rows: self.drives.members(),
            summary: self.drives.summary_members(&self.summaries),
        });
        report.serialize(serializer)
    }
}

impl From<&BenchmarkReport<'_>> for Document {
    /// The settings, a table for each variant, and what went wrong.
    fn from(report: &BenchmarkReport<'_>) -> Self {
        let planners = count(report.drives.planners().len(), "planner");
        let queries = queries_text(report.drives.rows.len() as u64);
        let title = format!("Benchmark of {planners}, seeds {}: {queries}", report.seeds);
        let changes: String = report.changes.iter().map(|change| format!(", {change}")).collect();
        let settings = format!("Settings of the scenario `{}`{changes}.", report.scenario);
        let tables = interval_tables(&report.drives, &report.summaries);
        let mut document = Self::new(title).with([Block::List(vec![settings])]).with(tables);
        let failures = failure_sentences(&report.drives).into_iter();
        document.add_list(failures.chain(violation_sentences(&report.drives)).collect());
        document.with([Block::List(INTERVAL_LEGEND.map(str::to_owned).to_vec())])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_batch::drives::made_up_drives;

    #[test]
    fn answer_fits_eighty_columns_and_says_what_failed() {
        let drives = made_up_drives();
        let report = BenchmarkReport {
            scenario: "drives".into(),
            changes: &["field.coverage=0.05,0.1,1".to_owned()],
            seeds: "0..19".into(),
            summaries: PlannerSummary::all(&drives),
            drives,
            problems: Vec::new(),
        };
        let text = Document::from(&report).to_text();
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        assert!(text.starts_with("Benchmark of 2 planners, seeds 0..19: 240 queries\n"), "{text}");
        for fragment in [
            "field.coverage 0.05, fire.model -so: 40 queries of each planner",
            "own: budget spent 30 times, first on field =made up,~, goal 0 (field.coverage 0.05",
            "prm-rs: violation on field =made up,~, goal 1",
        ] {
            assert!(text.replace("\n  ", " ").contains(fragment), "{fragment}: {text}");
        }
        let object = serde_json::to_value(&report).expect("it is JSON");
        let row = &object["rows"][1];
        assert_eq!((&row["seed"], &row["field.coverage"], &row["planner"]), (&0.into(), &0.05.into(), &"own".into()));
        assert_eq!(object["rows"].as_array().map(Vec::len), Some(240));
        let [first, second] = [0, 1].map(|index| &object["summary"][index]);
        assert_eq!((&first["solved"], &first["violations"]), (&39.into(), &1.into()));
        assert_eq!((&second["planner"], &second["solved"]), (&"own".into(), &30.into()));
        assert_eq!(second["figures"]["expansions"]["median"], 19.5);
    }
}
