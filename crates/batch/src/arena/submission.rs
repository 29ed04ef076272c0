//! The check of an entry before it is submitted.

use serde::{Serialize, Serializer};

use super::entry::ArenaEntry;
use super::play::Played;
use super::track::Track;
use crate::plan::{BatchPlan, planner_of};
use crate::report::Failures;
use wildfire_base::document::number::rounded;
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::object;

/// The result of an entry's first seeds on a track.
#[derive(Debug, Serialize)]
pub struct TrackCheck {
    track: &'static str,
    runs: usize,
    failed: usize,
    score: f64,
    effort: f64,
    failed_queries: u64,
    queries: u64,
    /// The reasons for which queries failed.
    reasons: Vec<String>,
    /// The reasons for which the entry is refused.
    refusals: Vec<String>,
    wall_all_seeds_s: f64,
    message: Option<String>,
}

impl TrackCheck {
    /// Judges the runs of a plan that were played: all, or those of the first seed if they `cut_short` the rest. All seeds
    /// of the track would take `wall_all_seeds_s`.
    pub fn new(
        track: &Track,
        plan: &BatchPlan,
        played: &[Played],
        cut_short: Option<String>,
        wall_all_seeds_s: f64,
    ) -> Self {
        let scores: Vec<f64> = played.iter().filter_map(|played| played.row.score).collect();
        let failed = played.len() - scores.len();
        let queries = total(played.iter().map(|run| &run.failed_queries));
        let policy_queries = total(played.iter().map(|run| &run.failed_policy_queries));
        let of_planner = queries.of_planner(&planner_of(&plan.variants[0].scenario));
        let message = played.iter().find(|it| !it.message.is_empty()).map(|it| it.message.clone());
        let mut refusals: Vec<String> = played
            .iter()
            .filter_map(|it| Some(format!("{}, seed {}: {}", track.name, it.row.seed, it.violation.as_ref()?)))
            .collect();
        let cut_short = cut_short.map(|it| format!("{it} on the first seed; the other seeds were not played"));
        refusals.extend(cut_short.or_else(|| total_failure(played)).map(|it| format!("{}: {it}", track.name)));
        // Runs that finish have messages too, as planners comment on failed queries; these are no reason to refuse an entry.
        let of_failed = message.as_ref().filter(|_| failed > 0);
        refusals.extend(of_failed.map(|message| format!("{}: {message}", track.name)));
        Self {
            track: track.name,
            runs: played.len(),
            failed,
            // Without any score the mean is 0 and not NaN, which JSON cannot express.
            score: scores.iter().sum::<f64>() / scores.len().max(1) as f64,
            effort: played.iter().map(|it| it.row.effort as f64).sum::<f64>() / played.len().max(1) as f64,
            failed_queries: queries.failed(),
            queries: queries.total(),
            reasons: of_planner.into_iter().chain(policy_queries.of_policies(None)).collect(),
            refusals,
            wall_all_seeds_s,
            message,
        }
    }

    fn cells(&self) -> Vec<String> {
        vec![
            self.track.to_owned(),
            self.runs.to_string(),
            self.failed.to_string(),
            rounded(self.score, 2),
            rounded(self.effort, 0),
            format!("{}/{}", self.failed_queries, self.queries),
            rounded(self.wall_all_seeds_s / 60.0, 1),
        ]
    }
}

/// The failures of all these together.
fn total<'a>(failures: impl Iterator<Item = &'a Failures>) -> Failures {
    failures.fold(Failures::default(), |mut total, failures| {
        total += failures.clone();
        total
    })
}

/// Says what failed in runs in which everything did.
pub fn total_failure(played: &[Played]) -> Option<String> {
    if played.iter().all(|run| run.row.score.is_none()) {
        return Some("every run failed".to_owned());
    }
    let queries = all_failed(&total(played.iter().map(|run| &run.failed_queries)));
    let policy_queries = all_failed(&total(played.iter().map(|run| &run.failed_policy_queries)));
    let queries = queries.map(|total| format!("all {total} queries failed"));
    queries.or_else(|| policy_queries.map(|total| format!("all {total} asks of policies failed")))
}

/// Returns the number of queries if there were some and all failed.
fn all_failed(failures: &Failures) -> Option<u64> {
    Some(failures.total()).filter(|&total| 0 < total && total <= failures.failed())
}

/// An entry, checked on its tracks.
#[derive(Debug)]
pub struct SubmissionCheck {
    pub entry: ArenaEntry,
    pub tracks: Vec<TrackCheck>,
}

impl SubmissionCheck {
    /// Returns whether the entry can be submitted.
    pub fn is_accepted(&self) -> bool {
        self.tracks.iter().all(|track| track.refusals.is_empty())
    }
}

impl Serialize for SubmissionCheck {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        object!(Check { entry: &self.entry.card.name, tracks: &self.tracks }).serialize(serializer)
    }
}

impl From<&SubmissionCheck> for Document {
    fn from(check: &SubmissionCheck) -> Self {
        let verdict = if check.is_accepted() { "can be submitted" } else { "cannot be submitted" };
        let mut document = Self::new(format!("{} {verdict}", check.entry.card.name));
        let headings = ["Track", "Runs", "Failed", "Score", "Effort", "Failed\nqueries", "All seeds\nmin"];
        document.add(Table::new(&headings, check.tracks.iter().map(TrackCheck::cells).collect()));
        document.add_list(check.tracks.iter().flat_map(|track| track.refusals.clone()).collect());
        let reasons =
            check.tracks.iter().flat_map(|it| it.reasons.iter().map(|reason| format!("{}: {reason}", it.track)));
        document.add_list(reasons.collect());
        document.with([Block::Text(format!("Files: SHA-256 {}", check.entry.hash))])
    }
}
