//! The report on decisions: a sentence, a table, an object.

use serde::{Serialize, Serializer};
use wildfire_base::document::number::{count, probability, rounded};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::geometry::Cell;
use wildfire_base::object;

use super::futures::{AlternativeAction, DecisionValue};
use crate::stats::{Interval, holm};

/// The most decisions that the table lists.
const LISTED: usize = 20;

/// The worth of the decisions of a run.
#[derive(Clone, Debug)]
pub struct WhyReport {
    pub scenario: String,
    pub seed: u64,
    /// Bushes that burned out or burned at the end.
    pub lost: usize,
    pub bushes: usize,
    /// By time.
    pub worths: Vec<DecisionValue>,
}

fn place(cell: Cell) -> String {
    format!("({}, {})", cell.col, cell.row)
}

/// Returns the time of a decision in seconds, rounded down: a run that is forked there has not decided yet.
fn time_before(worth: &DecisionValue) -> String {
    rounded((worth.decision.time.as_seconds() * 10.0).floor() / 10.0, 1)
}

fn went(worth: &DecisionValue) -> String {
    let who = worth.decision.agent.id;
    match worth.selected {
        Some(cell) => format!("{who} went to {}", place(cell)),
        None => format!("{who} stayed"),
    }
}

fn bushes(choice: &AlternativeAction) -> String {
    let sign = if choice.mean < 0.0 { -1.0 } else { 1.0 };
    let about = match choice.interval {
        Some(Interval { low, high }) => {
            let [one, other] = [sign * low, sign * high];
            format!("95 % {} to {}", rounded(one.min(other), 1), rounded(one.max(other), 1))
        }
        None => format!("in each of {} futures", choice.gains.len()),
    };
    format!("{} bushes ({about})", rounded(sign * choice.mean, 1))
}

impl WhyReport {
    /// Adjusts the p-values of all choices for their number.
    pub(super) fn adjust(&mut self) {
        let others = self.worths.iter().flat_map(|worth| &worth.others);
        let adjusted = holm(&others.map(|other| other.p_value).collect::<Vec<f64>>());
        let others = self.worths.iter_mut().flat_map(|worth| &mut worth.others);
        others.zip(adjusted).for_each(|(other, p_adjusted)| other.p_adjusted = p_adjusted);
    }

    /// Lists the decisions that cost something, the worst first.
    pub fn mistakes(&self) -> Vec<&DecisionValue> {
        let mut mistakes: Vec<&DecisionValue> = self.worths.iter().filter(|worth| worth.better().is_some()).collect();
        mistakes.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
        mistakes
    }

    /// Lists the decisions that were better than all other choices.
    pub fn good(&self) -> Vec<&DecisionValue> {
        self.worths.iter().filter(|worth| worth.all_worse().is_some()).collect()
    }

    fn sentences(&self) -> Vec<String> {
        let Self { lost, bushes: all, worths, .. } = self;
        let (mistakes, good) = (self.mistakes(), self.good());
        let mut sentences = vec![format!("{lost} of {all} bushes were lost.")];
        if worths.is_empty() {
            sentences.push("Nobody had several options to choose from in that time.".to_owned());
            return sentences;
        }
        if let Some(worst) = mistakes.first()
            && let Some(better) = worst.better()
        {
            sentences.push(format!(
                "The decision at {} s cost {}: {}, not to {}.",
                time_before(worst),
                bushes(better),
                went(worst),
                place(better.cell)
            ));
        }
        sentences.push(format!(
            "Of {}, {} and {}; for the others no alternative is significantly better or worse.",
            count(worths.len(), "decision"),
            count_that_were(&mistakes, ["a mistake", "mistakes"]),
            count_that_were(&good, ["clearly best", "clearly best"])
        ));
        // Where every other choice is worse, the best one is to stay with what was done, which gains nothing.
        let best = worths.iter().filter_map(|worth| worth.others.first()).map(|best| best.mean.max(0.0)).sum::<f64>();
        let best = best / worths.len() as f64;
        sentences.push(format!(
            "The best other choice of each looks {} bushes better on average, part of which is luck: the best of several \
             means is too high.",
            rounded(best, 2)
        ));
        sentences
    }

    fn table(&self) -> Table {
        // The gain decides and not the time: the table is cut off, and the costliest mistakes must be in it.
        let mut ranked: Vec<&DecisionValue> = self.worths.iter().filter(|worth| !worth.others.is_empty()).collect();
        ranked.sort_by(|a, b| b.others[0].mean.total_cmp(&a.others[0].mean));
        let rows = ranked.iter().take(LISTED).map(|worth| {
            // The filter above leaves decisions with an alternative, and these are sorted by their gain.
            let best = &worth.others[0];
            let verdict = match (worth.better().is_some(), worth.all_worse().is_some()) {
                (true, _) => "mistake",
                (_, true) => "good",
                _ => "",
            };
            vec![
                worth.decision.agent.id.to_string(),
                worth.selected.map_or_else(|| "stayed".to_owned(), place),
                place(best.cell),
                verdict.to_owned(),
                time_before(worth),
                rounded(best.mean, 2),
                best.interval.map_or_else(
                    || "-".to_owned(),
                    |Interval { low, high }| format!("{} to {}", rounded(low, 1), rounded(high, 1)),
                ),
                probability(best.p_adjusted),
                best.gains.len().to_string(),
            ]
        });
        let headings = ["Agent", "Went to", "Best other", "", "t [s]", "Gain", "95 %", "p", "Futures"];
        Table { text_columns: 4, ..Table::new(&headings, rows.collect()) }
    }
}

fn count_that_were(worths: &[&DecisionValue], what: [&str; 2]) -> String {
    match worths.len() {
        0 => format!("none was {}", what[0]),
        1 => format!("1 was {}", what[0]),
        several => format!("{several} were {}", what[1]),
    }
}

fn cost(worth: &DecisionValue) -> f64 {
    worth.better().map_or(0.0, |better| better.mean)
}

impl From<&WhyReport> for Document {
    fn from(report: &WhyReport) -> Self {
        let mut document = Self::new(format!("{}, seed {}: what decisions were worth", report.scenario, report.seed))
            .with([Block::List(report.sentences())]);
        if report.worths.iter().any(|worth| !worth.others.is_empty()) {
            document.add(report.table());
            document.add(Block::Text(
                "Gain: how many bushes more the agent's side would have saved (a truck) or burned (a Wumpus) by going \
                 to the best other cell, averaged over resampled futures. p is adjusted for all choices of the run \
                 (Holm)."
                    .to_owned(),
            ));
        }
        document
    }
}

impl Serialize for WhyReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { scenario, seed, lost, bushes, worths } = self;
        let decisions = worths.iter().map(decision_members).collect::<Vec<_>>();
        object!(Why { scenario, seed, lost, bushes, decisions }).serialize(serializer)
    }
}

fn decision_members(worth: &DecisionValue) -> impl Serialize {
    object!(Decision {
        t_s: worth.decision.time.as_seconds(),
        agent: worth.decision.agent.id.to_string(),
        x_m: worth.decision.agent.place.x,
        y_m: worth.decision.agent.place.y,
        chosen: worth.selected.map(|cell| [cell.col, cell.row]),
        options: worth.decision.options.len(),
        is_mistake: worth.better().is_some(),
        is_good: worth.all_worse().is_some(),
        others: worth.others.iter().map(action_members).collect::<Vec<_>>(),
    })
}

fn action_members(choice: &AlternativeAction) -> impl Serialize {
    let AlternativeAction { mean, interval, p_value, p_adjusted, gains, .. } = choice.clone();
    object!(Action { cell: [choice.cell.col, choice.cell.row], mean, interval, p_value, p_adjusted, gains })
}
