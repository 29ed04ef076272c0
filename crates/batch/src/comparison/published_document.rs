//! The comparison with published tables as an object and as a document.

use serde::{Serialize, Serializer};
use serde_json::json;

use crate::comparison::{PublishedComparison, PublishedState};
use crate::plan::PROGRAM_VERSION;
use wildfire_base::document::number::{optional, probability, rounded, two_digits};
use wildfire_base::document::{Block, Document, Table};

const SOURCE: &str = "Published: five runs, A. Shaikh, \"RBE 550: Wildfire Assignment\", 2024, Tables I and II.";

impl From<&PublishedComparison> for Document {
    fn from(beside: &PublishedComparison) -> Self {
        let batch = &beside.batch;
        let failed = if batch.failed == 0 { String::new() } else { format!(", {} of them failed", batch.failed) };
        let blocks = vec![
        Block::List(vec![SOURCE.into(), format!("Batch: {}: {} runs{failed}", batch.description, batch.runs)]),
        Block::Heading("Ratios of obstacles at the end".into()),
        means(&beside.states).into(),
        Block::Text("Differences are the batch's mean less the published one, with Welch's 95 % interval.".into()),
        Block::Heading("What five runs can come to".into()),
        five_runs(&beside.states).into(),
        Block::Text(
            "95 % of the means of five runs drawn from the batch lie between low and high; as far: the share of them \
             that are at least as far from the batch's mean as the published one."
                .into(),
        ),
        Block::List(beside.states.iter().map(verdict).collect()),
        Block::Heading("CPU seconds of a run, in the mean".into()),
        times(beside).into(),
        Block::Text(
            "The published times were taken on another machine by a clock of 1/64 s, in Python; they show the share of \
             each part, not which program is better."
                .into(),
        ),
    ];
        Self::new("A batch beside five published runs").with(blocks)
    }
}

fn means(states: &[PublishedState]) -> Table {
    let headings = ["State", "Published", "sd", "Batch", "sd", "Difference", "95% low", "95% high"];
    let rows = states.iter().map(|state| {
        let numbers = [
            state.published.mean(),
            state.published.standard_deviation(),
            state.batch.mean(),
            state.batch.standard_deviation(),
            state.batch.mean().zip(state.published.mean()).map(|(batch, published)| batch - published),
            state.difference.map(|interval| interval.low),
            state.difference.map(|interval| interval.high),
        ];
        [state.name.to_owned()].into_iter().chain(numbers.map(|number| optional(number, 3))).collect()
    });
    Table::new(&headings, rows.collect())
}

fn five_runs(states: &[PublishedState]) -> Table {
    let headings = ["State", "Published", "95% low", "95% high", "As far"];
    let rows = states.iter().map(|state| {
        let published = optional(state.published.mean(), 3);
        let [low, high] = [state.five_runs.low, state.five_runs.high].map(|end| rounded(end, 3));
        vec![state.name.into(), published, low, high, probability(state.as_far)]
    });
    Table::new(&headings, rows.collect())
}

fn verdict(state: &PublishedState) -> String {
    let is_usual = state.published.mean().is_some_and(|mean| state.five_runs.contains(mean));
    let verdict =
        if is_usual { "five runs of this batch can well come to it" } else { "unusual for five runs of this batch" };
    format!("{}: {verdict}", state.name)
}

fn times(beside: &PublishedComparison) -> Table {
    let rows = beside.times.iter().map(|time| {
        let ratio = time.published_s / time.batch_s;
        let ratio = if ratio.is_finite() && ratio > 0.0 { rounded(ratio, two_digits(ratio)) } else { "-".into() };
        vec![time.name.into(), rounded(time.published_s, 3), rounded(time.batch_s, 6), ratio]
    });
    Table::new(&["Part", "Published", "Batch", "Ratio"], rows.collect())
}

impl Serialize for PublishedComparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let states = self.states.iter().map(|state| {
            json!({
                "state": state.name,
                "published_mean": state.published.mean(),
                "published_sd": state.published.standard_deviation(),
                "batch_mean": state.batch.mean(),
                "batch_sd": state.batch.standard_deviation(),
                "difference_95": state.difference.map(|interval| [interval.low, interval.high]),
                "five_runs_95": [state.five_runs.low, state.five_runs.high],
                "five_runs_as_far": state.as_far,
            })
        });
        let times = self.times.iter();
        let object = json!({
            "program_version": PROGRAM_VERSION,
            "batch": { "description": self.batch.description, "runs": self.batch.runs, "failed": self.batch.failed },
            "states": states.collect::<Vec<_>>(),
            "cpu": times
                .map(|time| json!({ "part": time.name, "published_s": time.published_s, "batch_s": time.batch_s }))
                .collect::<Vec<_>>(),
        });
        object.serialize(serializer)
    }
}
