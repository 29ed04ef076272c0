//! Failures of planners and policies as text: a sentence for each, by reason, with a message.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use crate::table::{RUN_COLUMNS, RunRecord, run_column};
use wildfire_base::document::number::percent;
use wildfire_base::untrusted::{visible, visible_start};

/// The failed queries of a planner, or failed questions to policies, over some runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Failures {
    /// Queries or asks in all.
    total: u64,
    /// By the place of their reason among the columns.
    reasons: BTreeMap<usize, FailureReason>,
    /// The policy that messages name first.
    policy: Option<String>,
}

/// Failures for one reason.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct FailureReason {
    name: String,
    count: u64,
    /// The first message, if there is one.
    detail: Option<String>,
}

/// Returns the reasons that the columns with this beginning count, as messages name them, and the columns' places.
fn reasons(prefix: &str) -> impl Iterator<Item = (String, usize)> {
    let columns = RUN_COLUMNS.iter().enumerate();
    columns.filter_map(move |(place, column)| Some((column.name.strip_prefix(prefix)?.replace('_', " "), place)))
}

/// The most characters of a message; those of runs are no longer.
const LONGEST: usize = 600;

/// A message fit for a line: what its end says, such as by how much a path is too close, is the reason.
fn whole(message: &str) -> String {
    visible(&message.chars().take(LONGEST).collect::<String>()).into_owned()
}

/// The beginning of messages about policies, before the name.
const POLICY: &str = "policy ";

impl Failures {
    /// Counts the failed queries of the trucks' planners in a run.
    pub fn of_queries(run: &RunRecord) -> Self {
        Self::new(run, run_column("truck_plans"), reasons("truck_failed_"), |who| !who.starts_with(POLICY))
    }

    /// Counts a single query that failed for a reason, if it did, with a message.
    pub fn of_query(failure: Option<String>, message: Option<&str>) -> Self {
        let reason = failure.map(|name| {
            let column = reasons("truck_failed_").find(|(column_name, _)| *column_name == name);
            let detail = message.map(whole);
            (column.map_or(usize::MAX, |(_, place)| place), FailureReason { name, count: 1, detail })
        });
        Self { total: 1, reasons: reason.into_iter().collect(), policy: None }
    }

    /// Counts the failed questions to policies in a run.
    pub fn of_asks(run: &RunRecord) -> Self {
        let illegal = ("illegal".to_owned(), run_column("policy_illegal"));
        Self::new(run, run_column("policy_asked"), reasons("policy_failed_").chain([illegal]), |who| {
            who.starts_with(POLICY)
        })
    }

    fn new(
        run: &RunRecord,
        total: usize,
        reasons: impl Iterator<Item = (String, usize)>,
        is_meant: impl Fn(&str) -> bool,
    ) -> Self {
        let number = |column| run.number(column).unwrap_or(0.0) as u64;
        let mut failures = Self { total: number(total), ..Self::default() };
        for (name, column) in reasons.filter(|(_, column)| number(*column) > 0) {
            let about = |reason| message_about(run.message(), reason, &is_meant);
            // A policy over its instructions counts as crashed.
            let (who, detail) = about(&name).or_else(|| about("budget spent").filter(|_| name == "crashed")).unzip();
            // Only messages about policies begin so; a planner's name may be any word.
            let policy = who.and_then(|who: &str| who.strip_prefix(POLICY)?.split(' ').next());
            failures.policy = failures.policy.or(policy.map(visible_start));
            let reason = FailureReason { name, count: number(column), detail: detail.map(whole) };
            failures.reasons.insert(column, reason);
        }
        failures
    }

    /// Describes the failed queries of a planner, if there are any.
    pub fn of_planner(&self, planner: &str) -> Option<String> {
        self.sentence(&format!("Failed queries of {planner}"))
    }

    /// Describes the failed questions to the policies of an entry, or of a run without one, if there are any.
    pub fn of_policies(&self, entry: Option<&str>) -> Option<String> {
        let policy = self.policy.as_ref().map_or("custom policies".to_owned(), |name| format!("the policy {name}"));
        self.sentence(&format!("Failed asks of {}", entry.unwrap_or(&policy)))
    }

    /// The number of queries or asks.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// The number of those that failed.
    pub fn failed(&self) -> u64 {
        self.reasons.values().map(|reason| reason.count).sum()
    }

    fn sentence(&self, subject: &str) -> Option<String> {
        let failed = self.failed();
        let mut reasons: Vec<&FailureReason> = self.reasons.values().collect();
        reasons.sort_by_key(|reason| std::cmp::Reverse(reason.count));
        let reasons = reasons.into_iter().map(|FailureReason { name, count, detail }| {
            let detail = detail.as_ref().map_or(String::new(), |detail| format!(" ({detail})"));
            format!("{name} {count}{detail}")
        });
        let total = self.total;
        let reasons = reasons.collect::<Vec<_>>().join(", ");
        let share = percent(failed as f64 / total.max(1) as f64);
        (failed > 0).then(|| format!("{subject}: {failed} of {total} ({share} %): {reasons}."))
    }
}

/// Finds the first message about a reason, of somebody who is meant: who it is about, and its words. Messages are joined as
/// [`FailureMessages`](wildfire_sim::FailureMessages) writes them.
fn message_about<'a>(messages: &'a str, reason: &str, is_meant: impl Fn(&str) -> bool) -> Option<(&'a str, &'a str)> {
    let mark = format!(" s: {reason}: ");
    messages.match_indices(&mark).find_map(|(at, mark)| {
        let who = messages[..at].rsplit("; ").next().filter(|who| is_meant(who))?;
        let rest = &messages[at + mark.len()..];
        let ends = ["; unimog/", "; wumpus/", "; policy ", "; and "].iter().filter_map(|next| rest.find(next));
        let detail = &rest[..ends.min().unwrap_or(rest.len())];
        let counted = detail.rsplit_once(" (").filter(|(_, times)| times.ends_with(" times)"));
        Some((who, counted.map_or(detail, |(detail, _)| detail)))
    })
}

impl AddAssign for Failures {
    fn add_assign(&mut self, other: Self) {
        self.total = self.total.saturating_add(other.total);
        self.policy = self.policy.take().or(other.policy);
        for (column, reason) in other.reasons {
            let sum =
                self.reasons.entry(column).or_insert(FailureReason { name: reason.name, ..FailureReason::default() });
            sum.count = sum.count.saturating_add(reason.count);
            sum.detail = sum.detail.take().or(reason.detail);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::time::SimTime;
    use wildfire_planning::PlanFailure;
    use wildfire_sim::FailureMessages;

    #[test]
    fn messages_are_found_by_their_reason_and_whom_they_are_about() {
        let mut messages = FailureMessages::default();
        let mut add = |who: &str, at_s: f64, reason, detail: &str| {
            messages.add(who, SimTime::from_seconds(at_s), reason, detail);
        };
        add("unimog/0", 1.0, PlanFailure::Crashed, "ended with exit code 3; its last words: no map");
        add("unimog/1", 2.0, PlanFailure::Crashed, "ended with exit code 4; its last words: no map");
        add("policy own", 2.5, PlanFailure::Crashed, "was ended by the signal SIGKILL");
        add("unimog/0", 3.0, PlanFailure::TimedOut, "gave no answer within 5 s");
        let text = messages.to_string();
        assert!(
            text.starts_with("unimog/0 at 1.0 s: crashed: ended with exit code 3; its last words: no map (2 times); ")
        );
        let found = |reason, is_policy| message_about(&text, reason, |who| who.starts_with(POLICY) == is_policy);
        assert_eq!(
            found("crashed", false),
            Some(("unimog/0 at 1.0", "ended with exit code 3; its last words: no map"))
        );
        assert_eq!(found("crashed", true), Some(("policy own at 2.5", "was ended by the signal SIGKILL")));
        assert_eq!(found("timed out", false), Some(("unimog/0 at 3.0", "gave no answer within 5 s")));
        assert_eq!(found("bad answer", false), None);
    }

    #[test]
    fn reason_of_a_failure_is_shown_to_its_end() {
        let message = "segment 2 of 3, 26.05 m along, at (46.05, 22.50): 9 mm from the bush at cell (10, 4), the least \
                       is 10 mm";
        let sentence = Failures::of_query(Some("invalid path".to_owned()), Some(message)).of_planner("own");
        let expected = format!("Failed queries of own: 1 of 1 (100.0 %): invalid path 1 ({message}).");
        assert_eq!(sentence, Some(expected));
        let endless = Failures::of_query(Some("crashed".to_owned()), Some(&"\u{7}".repeat(5000))).of_planner("own");
        assert!(endless.is_some_and(|sentence| sentence.len() < 9000 && !sentence.contains('\u{7}')));
    }

    #[test]
    fn reasons_add_up_over_runs_and_the_most_frequent_comes_first() {
        let of = |total, reasons: &[(usize, &'static str, u64, Option<&str>)]| Failures {
            total,
            reasons: reasons
                .iter()
                .map(|&(place, name, count, detail)| {
                    (place, FailureReason { name: name.to_owned(), count, detail: detail.map(str::to_owned) })
                })
                .collect(),
            policy: None,
        };
        let mut sum = of(10, &[(1, "timed out", 2, None)]);
        sum += of(30, &[(1, "timed out", 1, Some("gave no answer")), (2, "crashed", 5, Some("ended"))]);
        let expected = "Failed queries of rrt: 8 of 40 (20.0 %): crashed 5 (ended), timed out 3 (gave no answer).";
        assert_eq!(sum.of_planner("rrt").as_deref(), Some(expected));
        assert_eq!(of(10, &[]).of_planner("rrt"), None);
    }
}
