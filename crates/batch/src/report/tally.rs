//! The tally of a batch: finished and failed runs, the champion, stuck agents.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::execute::Status;
use crate::report::failures::Failures;
use crate::stats::{Interval, wilson_interval};
use crate::table::{QueryTally, RunRecord, run_column};

const PLANNER: usize = run_column("planner");
const WINNER: usize = run_column("winner");
const WUMPUS_SCORE: usize = run_column("wumpus_score");
const TRUCK_SCORE: usize = run_column("truck_score");
const WUMPUS_STUCK_S: usize = run_column("wumpus_stuck_s");
const TRUCK_STUCK_S: usize = run_column("truck_stuck_s");
const ENDED_S: usize = run_column("ended_s");

/// Counts and sums over the runs of a batch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// The numbers of trucks and of Wumpuses in the scenario.
    pub trucks: usize,
    pub wumpuses: usize,
    /// The entry that plays, in a batch of several; its queries are counted under its name rather than its planner's, which
    /// many entries share.
    pub entry: Option<String>,
    /// When runs end at the latest, in seconds, where nobody lights fires and trucks put them out.
    pub deadline_s: Option<f64>,
    /// The finished runs that ended before, as nothing burned any more.
    pub fires_out: u64,
    pub done: u64,
    pub failed: u64,
    pub panicked: u64,
    /// Seed and message of the first run without a result.
    pub first_failure: Option<(u64, String)>,
    /// The finished runs with agents on both sides.
    pub contested: u64,
    pub won_by_wumpus: u64,
    pub won_by_truck: u64,
    pub wumpus_score: f64,
    pub truck_score: f64,
    /// The number of runs in which any agent, a truck, and a Wumpus got stuck, and for how long in total.
    pub stuck_runs: u64,
    pub truck_stuck_runs: u64,
    pub wumpus_stuck_runs: u64,
    pub truck_stuck_s: f64,
    pub wumpus_stuck_s: f64,
    /// The number of runs that have notes.
    pub noted_runs: u64,
    /// Seed and notes of the first of them.
    pub first_notes: Option<(u64, Vec<String>)>,
    /// The queries of runs that are done or that a limit ended, by planner or entry.
    pub queries: BTreeMap<String, QueryTally>,
    /// Their failures by planner or entry, and those of custom policies.
    pub failures: BTreeMap<String, Failures>,
    pub failed_asks: Failures,
}

impl Tally {
    /// Creates a tally without runs, for a scenario with this number of agents on each side.
    pub fn new(trucks: usize, wumpuses: usize) -> Self {
        Self { trucks, wumpuses, ..Self::default() }
    }

    /// Adds a run.
    pub fn add(&mut self, run: &RunRecord) {
        match run.status() {
            Status::Done => self.done += 1,
            Status::Failed => self.failed += 1,
            Status::Panicked => self.panicked += 1,
        }
        if !run.is_done() {
            self.first_failure.get_or_insert_with(|| (run.seed(), run.message().to_owned()));
        }
        let planner = run.text(PLANNER);
        let name = self.entry.as_deref().unwrap_or(planner).to_owned();
        let queries = run.queries();
        // Queries of a failed run count only if a clock ended one: then other figures depend on the machine too.
        if (run.is_done() || queries.depends_on_machine()) && (!planner.is_empty() || queries.asks > 0) {
            *self.queries.entry(name.clone()).or_default() += queries;
        }
        if !run.is_done() {
            return;
        }
        self.failed_asks += Failures::of_asks(run);
        if !planner.is_empty() {
            *self.failures.entry(name).or_default() += Failures::of_queries(run);
        }
        let number = |column| run.number(column).unwrap_or(0.0);
        // Without agents on both sides nobody wins.
        if self.trucks > 0 && self.wumpuses > 0 {
            self.contested += 1;
            self.won_by_wumpus += u64::from(run.text(WINNER) == "wumpus");
            self.won_by_truck += u64::from(run.text(WINNER) == "unimog");
            self.wumpus_score += number(WUMPUS_SCORE);
            self.truck_score += number(TRUCK_SCORE);
        }
        self.fires_out += u64::from(self.deadline_s.is_some_and(|deadline_s| number(ENDED_S) < deadline_s));
        let truck_stuck_s = number(TRUCK_STUCK_S);
        let wumpus_stuck_s = number(WUMPUS_STUCK_S);
        self.stuck_runs += u64::from(truck_stuck_s > 0.0 || wumpus_stuck_s > 0.0);
        self.truck_stuck_runs += u64::from(truck_stuck_s > 0.0);
        self.wumpus_stuck_runs += u64::from(wumpus_stuck_s > 0.0);
        self.truck_stuck_s += truck_stuck_s;
        self.wumpus_stuck_s += wumpus_stuck_s;
    }

    /// Adds the notes on a run, if there are any.
    pub fn add_notes(&mut self, seed: u64, notes: Vec<String>) {
        if !notes.is_empty() {
            self.noted_runs += 1;
            self.first_notes.get_or_insert((seed, notes));
        }
    }

    /// Returns the number of runs without a result.
    pub fn not_done(&self) -> u64 {
        self.failed + self.panicked
    }
}

impl Tally {
    /// Returns a sentence each on who won, which runs failed, in how many fire was out, who was stuck, who had almost no options, and whose
    /// planner was rescued or stopped by a clock.
    pub fn sentences(&self) -> Vec<String> {
        let runs = [self.champion(), Some(self.runs()), self.reason()];
        let sentences = runs.into_iter().flatten().chain(self.failure_sentences());
        let sentences = sentences.chain([self.out(), self.stuck(), self.note()].into_iter().flatten());
        let queries = self.queries.iter().flat_map(|(planner, queries)| queries.sentences(planner));
        sentences.chain(queries).collect()
    }

    /// Describes the failures of each planner, and of custom policies.
    pub fn failure_sentences(&self) -> Vec<String> {
        let planners = self.failures.iter().filter_map(|(planner, failures)| failures.of_planner(planner));
        planners.chain(self.failed_asks.of_policies(self.entry.as_deref())).collect()
    }

    /// Describes for each planner whether a limit of time or memory changed an outcome.
    pub fn machine_sentences(&self) -> impl Iterator<Item = String> {
        self.queries.iter().filter_map(|(planner, queries)| queries.machine_sentence(planner))
    }

    fn runs(&self) -> String {
        let Self { done, failed, panicked, .. } = self;
        match self.not_done() {
            0 => format!("Runs: {done} finished, none failed."),
            _ => format!("Runs: {done} finished, {failed} failed, {panicked} panicked; see runs.csv for the reasons."),
        }
    }

    fn reason(&self) -> Option<String> {
        self.first_failure.as_ref().map(|(seed, message)| format!("The first of these, seed {seed}: {message}"))
    }

    /// Returns the number of failed runs with the reason of the first; `None` without any.
    pub fn reason_of_failures(&self) -> Option<String> {
        let (seed, message) = self.first_failure.as_ref()?;
        let runs = self.done + self.not_done();
        Some(format!("{} of {runs} runs failed; the first, seed {seed}: {message}", self.not_done()))
    }

    /// Says in how many runs all fire was out before the end, where no Wumpus lights more.
    fn out(&self) -> Option<String> {
        self.deadline_s?;
        let Interval { low, high } = wilson_interval(self.fires_out, self.done)?;
        let (out, done) = (self.fires_out, self.done);
        Some(format!("All fires were out before the end in {out} of {done} runs (95 %: {low:.3} to {high:.3})."))
    }

    /// Says who got stuck, in how many of the runs, and for how long.
    fn stuck(&self) -> Option<String> {
        if self.done == 0 {
            return None;
        }
        let [trucks, wumpuses] = [("truck", self.trucks), ("Wumpus", self.wumpuses)];
        let part = |who: (&str, usize), runs: u64, stuck_s: f64| {
            (runs > 0).then(|| format!("{} got stuck in {}, for {stuck_s:.1} s", one_of(who), self.part_of_runs(runs)))
        };
        let parts = [
            part(trucks, self.truck_stuck_runs, self.truck_stuck_s),
            part(wumpuses, self.wumpus_stuck_runs, self.wumpus_stuck_s),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        let in_all = if self.stuck_runs > 1 { " in all" } else { "" };
        Some(if parts.is_empty() { "No agent got stuck.".into() } else { sentence(&parts.join("; ")) + in_all + "." })
    }

    /// Words a part of the runs that are done, at least one: `2 of 50 runs`, `all 5 runs`, `the run`.
    pub(super) fn part_of_runs(&self, part: u64) -> String {
        let finished = if self.not_done() > 0 { "finished " } else { "" };
        match (part, self.done) {
            (_, 1) => format!("the {finished}run"),
            (part, done) if part == done => format!("all {done} {finished}runs"),
            (part, done) => format!("{part} of {done} {finished}runs"),
        }
    }

    /// Names the trucks, or the only one.
    pub(super) fn trucks_name(&self) -> &'static str {
        if self.trucks > 1 { "the trucks" } else { "the Unimog" }
    }

    /// Names the Wumpuses, or the only one.
    pub(super) fn wumpuses_name(&self) -> &'static str {
        if self.wumpuses > 1 { "the Wumpuses" } else { "the Wumpus" }
    }

    /// Returns the notes of the first run that has any, and the number of such runs.
    pub fn note(&self) -> Option<String> {
        let (seed, notes) = self.first_notes.as_ref()?;
        let noted = self.noted_runs;
        let done = self.done;
        let notes = notes.join(" ");
        Some(format!("In {noted} of {done} runs an agent could do almost nothing; seed {seed}: {notes}"))
    }

    /// Who has more points over the batch; `None` without runs that have agents on both sides.
    fn champion(&self) -> Option<String> {
        if self.contested == 0 {
            return None;
        }
        let truck = (self.truck_score, self.won_by_truck);
        let wumpus = (self.wumpus_score, self.won_by_wumpus);
        let (name, first, second) = match self.truck_score.total_cmp(&self.wumpus_score) {
            Ordering::Greater => (self.trucks_name(), truck, wumpus),
            Ordering::Less => (self.wumpuses_name(), wumpus, truck),
            Ordering::Equal => ("none", truck, wumpus),
        };
        let ties = match self.contested - self.won_by_wumpus - self.won_by_truck {
            0 => String::new(),
            ties => format!(", {ties} tied"),
        };
        Some(format!(
            "Champion: {name}, {} points to {}; runs won {} to {}{ties}.",
            first.0, second.0, first.1, second.1
        ))
    }
}

fn one_of((role, count): (&str, usize)) -> String {
    match (role, count) {
        (_, 2..) => format!("a {role}"),
        ("truck", _) => "the Unimog".to_owned(),
        _ => format!("the {role}"),
    }
}

/// Makes a sentence of words: its first letter is large.
pub(super) fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn champion_has_more_points_not_more_runs() {
        let tally = Tally {
            done: 5,
            contested: 5,
            won_by_wumpus: 3,
            won_by_truck: 1,
            wumpus_score: 400.0,
            truck_score: 500.5,
            ..Tally::default()
        };
        let expected = "Champion: the Unimog, 500.5 points to 400; runs won 1 to 3, 1 tied.\n\
                        Runs: 5 finished, none failed.\n\
                        No agent got stuck.";
        assert_eq!(tally.sentences().join("\n"), expected);
    }

    #[test]
    fn equal_points_have_no_champion() {
        let tally = Tally { done: 2, contested: 2, won_by_wumpus: 1, won_by_truck: 1, ..Tally::default() };
        assert!(tally.sentences().join("\n").starts_with("Champion: none, 0 points to 0; runs won 1 to 1."));
    }

    #[test]
    fn runs_that_went_wrong_and_agents_that_were_stuck_are_named() {
        let stuck = Tally { stuck_runs: 1, truck_stuck_runs: 1, truck_stuck_s: 2.25, ..Tally::new(1, 1) };
        let tally = Tally { done: 2, failed: 3, panicked: 1, ..stuck.clone() };
        let text = tally.sentences().join("\n");
        assert!(text.contains("2 finished, 3 failed, 1 panicked"), "{text}");
        assert!(text.contains("The Unimog got stuck in 1 of 2 finished runs, for 2.2 s."), "{text}");
        assert!(!text.contains("Champion"), "{text}");
        let last = |tally: Tally| tally.sentences().pop();
        assert_eq!(last(Tally { done: 1, ..stuck }).as_deref(), Some("The Unimog got stuck in the run, for 2.2 s."));
        let both = Tally { stuck_runs: 5, truck_stuck_runs: 2, wumpus_stuck_runs: 5, ..Tally::new(3, 1) };
        let both = Tally { done: 5, truck_stuck_s: 7.5, wumpus_stuck_s: 30.0, ..both };
        assert_eq!(
            last(both).as_deref(),
            Some("A truck got stuck in 2 of 5 runs, for 7.5 s; the Wumpus got stuck in all 5 runs, for 30.0 s in all.")
        );
    }

    #[test]
    fn agents_that_could_do_nothing_are_told_by_the_first_such_run() {
        let notes = vec!["wumpus/0 can light nothing.".to_owned()];
        let tally = Tally { done: 9, noted_runs: 3, first_notes: Some((7, notes)), ..Tally::default() };
        let expected = "Runs: 9 finished, none failed.\n\
                        No agent got stuck.\n\
                        In 3 of 9 runs an agent could do almost nothing; seed 7: wumpus/0 can light nothing.";
        assert_eq!(tally.sentences().join("\n"), expected);
    }

    #[test]
    fn batch_without_results_says_so_and_nothing_more() {
        let tally = Tally { failed: 2, ..Tally::default() };
        assert_eq!(
            tally.sentences().join("\n"),
            "Runs: 0 finished, 2 failed, 0 panicked; see runs.csv for the reasons."
        );
    }
}
