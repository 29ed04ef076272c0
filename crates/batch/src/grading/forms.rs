//! Grades in the forms that course platforms read, and as a document.
//!
//! Sources: Gradescope, "Autograder Specifications", section "Output format"; Classroom 50, wiki page "Advanced Autograding",
//! section "The result.json contract".

use serde_json::{Value, json};

use super::Grade;
use wildfire_base::document::number::short;
use wildfire_base::document::{Block, Document, Table};

/// The schema that a result of Classroom 50 names.
const CLASSROOM50_SCHEMA: &str = "classroom50/result/v1";

impl Grade {
    /// Returns the text for the author: the points, a line for each test, and the remarks.
    pub fn text(&self) -> String {
        Document::from(self).to_text()
    }

    /// Returns the content of Gradescope's `results.json`.
    pub fn gradescope(&self) -> Value {
        let tests = self.tests.iter().map(|test| {
            json!({
                "name": test.name,
                "score": test.points,
                "max_score": test.max_points,
                "status": if test.is_passed { "passed" } else { "failed" },
                "output": test.output,
                "visibility": "visible",
            })
        });
        // Without a score an entry is not on the leaderboard.
        let scores = self.score.filter(|_| !self.has_violation).map(|score| {
            let order = if self.better == "higher" { "desc" } else { "asc" };
            json!({ "name": self.metric, "value": (score * 100.0).round() / 100.0, "order": order })
        });
        json!({
            "score": self.points,
            "output": self.remarks.join("\n"),
            "visibility": "visible",
            "stdout_visibility": "hidden",
            "tests": tests.collect::<Vec<Value>>(),
            "leaderboard": scores.into_iter().collect::<Vec<Value>>(),
        })
    }

    /// Returns what grading adds to Classroom 50's `result.json`. The members that identify the submission are known to the
    /// script that calls: `classroom`, `assignment`, `submission`, links and times. Points are whole numbers there.
    pub fn classroom50(&self) -> Value {
        let tests: Vec<Value> = self
            .tests
            .iter()
            .map(|test| {
                json!({
                    "test-name": test.name,
                    "passed": test.is_passed,
                    "score": test.points.round() as i64,
                    "max-score": test.max_points.round() as i64,
                    "output": test.output,
                })
            })
            .collect();
        json!({
            "schema": CLASSROOM50_SCHEMA,
            "score": sum_of(&tests, "score"),
            "max-score": sum_of(&tests, "max-score"),
            "tests": tests,
        })
    }
}

fn sum_of(tests: &[Value], member: &str) -> i64 {
    tests.iter().filter_map(|test| test[member].as_i64()).sum()
}

fn points_text(points: f64) -> String {
    short((points * 100.0).round() / 100.0)
}

impl From<&Grade> for Document {
    fn from(grade: &Grade) -> Self {
        let title =
            format!("{}: {} of {} points", grade.entry, points_text(grade.points), points_text(grade.max_points));
        let rows = grade.tests.iter().map(|test| {
            let passed = if test.is_passed { "yes" } else { "no" };
            vec![test.name.clone(), passed.into(), points_text(test.points), points_text(test.max_points)]
        });
        let table = Table { text_columns: 2, ..Table::new(&["Test", "Passed", "Points", "Of"], rows.collect()) };
        let reasons = grade.tests.iter().map(|test| format!("{}: {}", test.name, test.output));
        let lines = reasons.chain(grade.remarks.iter().cloned()).collect();
        Self::new(title).with([Block::Table(table), Block::List(lines)])
    }
}
