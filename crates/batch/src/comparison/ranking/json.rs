//! A ranking as one JSON object.

use serde::{Serialize, Serializer};

use crate::comparison::{Contrast, RankedEntry, RankedPair, Ranking};
use crate::plan::PROGRAM_VERSION;
use crate::stats::CONFIDENCE;
use wildfire_base::object;

impl Serialize for Ranking {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let ranking = object!(Object {
            program_version: PROGRAM_VERSION,
            confidence: CONFIDENCE,
            metric: &self.metric.name,
            better: self.better.name(),
            runs: self.runs,
            seeds: &self.seeds,
            stopping_rule: &self.stop,
            mean_over: &self.columns,
            worst: self.worst,
            entries: self.entries.iter().enumerate().map(|(place, it)| entry(self, place, it)).collect::<Vec<_>>(),
            pairs: self.pairs.iter().map(|it| pair(self, it)).collect::<Vec<_>>(),
        });
        ranking.serialize(serializer)
    }
}

fn difference(contrast: &Contrast) -> impl Serialize + use<> {
    object!(Difference { difference: contrast.difference, interval: contrast.interval })
}

fn entry(ranking: &Ranking, place: usize, entry: &RankedEntry) -> impl Serialize {
    object!(Entry {
        entry: &entry.name,
        description: &entry.description,
        planner: &entry.planner,
        rank_from: entry.ranks[0],
        rank_to: entry.ranks[1],
        groups: &entry.groups,
        mean: entry.mean,
        runs: entry.runs,
        less_first: ranking.pair(0, place).map(|pair| difference(&pair.contrast)),
        failed: entry.failed,
        first_failure: &entry.first_failure,
        without_value: entry.without_value,
        queries: entry.queries,
        // That a limit of time or memory changed an outcome.
        depends_on_machine: entry.queries.machine_sentence(&entry.name),
        audit: &entry.audit,
    })
}

/// The difference is the second entry's mean minus that of the first.
fn pair(ranking: &Ranking, pair: &RankedPair) -> impl Serialize {
    let [first, second] = pair.places.map(|place| &ranking.entries[place].name);
    object!(Pair {
        first,
        second,
        #[serde(flatten)]
        difference: difference(&pair.contrast),
        method: pair.contrast.method.name(),
        p_value: pair.contrast.p_value,
        p_method: pair.contrast.p_method.name(),
        p_adjusted: pair.p_adjusted,
        #[serde(rename = "told_apart")]
        significant: pair.is_significant,
        cohens_dz: pair.contrast.effect_dz,
    })
}
