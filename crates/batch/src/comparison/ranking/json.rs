//! A ranking as one JSON object.

use serde::{Serialize, Serializer};

use crate::comparison::{Better, Contrast, EntryAudit, RankedEntry, RankedPair, Ranking};
use crate::stats::CONFIDENCE;
use crate::{PROGRAM_VERSION, QueryTally};

/// The members in their order.
#[derive(Serialize)]
struct RankingObject<'a> {
    program_version: &'static str,
    confidence: f64,
    metric: &'a str,
    better: &'static str,
    runs: usize,
    seeds: &'a str,
    mean_over: &'a [String],
    /// What stands for a run without a value; null if all have one.
    worst: Option<f64>,
    entries: Vec<EntryObject<'a>>,
    pairs: Vec<PairObject<'a>>,
}

#[derive(Serialize)]
struct EntryObject<'a> {
    entry: &'a str,
    description: &'a str,
    planner: &'a str,
    rank_from: usize,
    rank_to: usize,
    groups: Option<&'a str>,
    mean: f64,
    less_first: Option<Difference>,
    failed: usize,
    without_value: usize,
    queries: QueryTally,
    /// That a limit of time or memory changed an outcome; null if none did.
    depends_on_machine: Option<String>,
    audit: Option<&'a EntryAudit>,
}

#[derive(Serialize)]
struct Difference {
    difference: f64,
    interval: Option<[f64; 2]>,
}

/// The difference is the second entry's mean less the first one's.
#[derive(Serialize)]
struct PairObject<'a> {
    first: &'a str,
    second: &'a str,
    #[serde(flatten)]
    difference: Difference,
    method: &'static str,
    p_value: Option<f64>,
    p_method: &'static str,
    p_adjusted: f64,
    told_apart: bool,
    cohens_dz: Option<f64>,
}

impl Serialize for Ranking {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let object = RankingObject {
            program_version: PROGRAM_VERSION,
            confidence: CONFIDENCE,
            metric: &self.metric.name,
            better: match self.better {
                Better::Higher => "higher",
                Better::Lower => "lower",
            },
            runs: self.runs,
            seeds: &self.seeds,
            mean_over: &self.columns,
            worst: self.worst,
            entries: self.entries.iter().enumerate().map(|(place, it)| entry(self, place, it)).collect(),
            pairs: self.pairs.iter().map(|it| pair(self, it)).collect(),
        };
        object.serialize(serializer)
    }
}

fn difference(contrast: &Contrast) -> Difference {
    let interval = contrast.interval.map(|interval| [interval.low, interval.high]);
    Difference { difference: contrast.difference, interval }
}

fn entry<'a>(ranking: &'a Ranking, place: usize, entry: &'a RankedEntry) -> EntryObject<'a> {
    EntryObject {
        entry: &entry.name,
        description: &entry.description,
        planner: &entry.planner,
        rank_from: entry.ranks[0],
        rank_to: entry.ranks[1],
        groups: entry.groups.as_deref(),
        mean: entry.mean,
        less_first: ranking.pair(0, place).map(|pair| difference(&pair.contrast)),
        failed: entry.failed,
        without_value: entry.without_value,
        queries: entry.queries,
        depends_on_machine: entry.queries.machine_sentence(&entry.name),
        audit: entry.audit.as_ref(),
    }
}

fn pair<'a>(ranking: &'a Ranking, pair: &RankedPair) -> PairObject<'a> {
    let [first, second] = pair.places.map(|place| ranking.entries[place].name.as_str());
    PairObject {
        first,
        second,
        difference: difference(&pair.contrast),
        method: pair.contrast.method.name(),
        p_value: pair.contrast.p_value,
        p_method: pair.contrast.p_method.name(),
        p_adjusted: pair.p_adjusted,
        told_apart: pair.is_told_apart(),
        cohens_dz: pair.contrast.effect_dz,
    }
}
