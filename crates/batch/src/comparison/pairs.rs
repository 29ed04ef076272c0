//! Pairs of runs of two sides: runs of the same seed under the same conditions.

use std::collections::{BTreeMap, BTreeSet};

use crate::comparison::error::ComparisonError;
use crate::comparison::sides::Side;
use crate::comparison::wording::listed;
use wildfire_base::untrusted::visible_start;

/// Pairs of runs, and the runs that were left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pairs {
    /// Indices into the tables of both sides, for runs that both finished; by seed.
    pub runs: Vec<(usize, usize)>,
    /// Runs of both sides that have the same seed and conditions, with the index of their stratum, whether or not they
    /// finished; by seed.
    pub planned: Vec<(usize, usize, usize)>,
    /// The columns that vary within a side and are equal within a pair; differences are means over them.
    pub columns: Vec<String>,
    /// The combinations of their values that occur in pairs, in the order of side A's runs; at most one without
    /// columns.
    pub strata: Vec<Stratum>,
    /// The strata that are planned and have no pair; their indices follow those of the others.
    pub unfinished_strata: Vec<Stratum>,
    /// The index of each pair's stratum.
    pub stratum_of: Vec<usize>,
    /// Runs without a partner, on either side.
    pub without_partner: [usize; 2],
    /// The number of pairs whose first run, second run, or both did not finish.
    pub failed: [usize; 3],
}

/// The conditions that pairs of a stratum share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stratum {
    /// A value for each of [`Pairs::columns`].
    pub levels: Vec<String>,
    pub pairs: usize,
}

/// A seed, and the number of the conditions that vary within a side.
type PairKey = (u64, usize);

impl Pairs {
    pub fn new(first: &Side<'_>, second: &Side<'_>) -> Result<Self, ComparisonError> {
        // Columns that differ between the sides but not within them are what is compared, and must not keep runs from pairing.
        let columns = varying_columns(first, second);
        let mut numbers = BTreeMap::new();
        // The sides share the numbers of conditions, or equal conditions would not have equal keys.
        let [ours, theirs] = [keyed(first, &columns, &mut numbers)?, keyed(second, &columns, &mut numbers)?];
        let mut pairs = Self::default();
        let mut partners = theirs.iter().peekable();
        // Both lists are in the order of their keys, so one pass pairs them without a search for each run.
        for (key, run) in &ours {
            while partners.next_if(|(other, _)| other < key).is_some() {
                pairs.without_partner[1] += 1;
            }
            match partners.next_if(|(other, _)| other == key) {
                Some((_, partner)) => {
                    // Pairs of failed runs count here too: strata without a finished pair are reported, and not silently absent.
                    pairs.planned.push((*run, *partner, key.1));
                    if pairs.add((*run, first.is_done(*run)), (*partner, second.is_done(*partner))) {
                        pairs.stratum_of.push(key.1);
                    }
                }
                None => pairs.without_partner[0] += 1,
            }
        }
        pairs.without_partner[1] += partners.count();
        if pairs.without_partner[0] == ours.len() {
            let varying = columns.iter().map(|column| visible_start(column)).collect();
            return Err(ComparisonError::NoPairs { other: second.letter, varying });
        }
        pairs.columns = columns.into_iter().collect();
        pairs.number_strata(numbers);
        Ok(pairs)
    }

    /// Adds two runs, each with whether it came to its end, and says whether they are a pair.
    fn add(&mut self, (first, first_done): (usize, bool), (second, second_done): (usize, bool)) -> bool {
        match (first_done, second_done) {
            (true, true) => self.runs.push((first, second)),
            (false, true) => self.failed[0] += 1,
            (true, false) => self.failed[1] += 1,
            (false, false) => self.failed[2] += 1,
        }
        first_done && second_done
    }

    /// Returns the columns in which the strata differ, `field.coverage and unimog.speed_mps`; empty for a single
    /// stratum.
    pub fn stratified_by(&self) -> String {
        listed(&self.columns.iter().map(|column| visible_start(column)).collect::<Vec<_>>())
    }

    /// Returns the values of a stratum, one for each of [`Self::columns`].
    pub fn levels(&self, index: usize) -> &[String] {
        &self.strata.get(index).unwrap_or_else(|| &self.unfinished_strata[index - self.strata.len()]).levels
    }

    /// Describes a stratum: `field.coverage 0.05, unimog.speed_mps 8`.
    pub fn stratum_text(&self, index: usize) -> String {
        let levels = self.columns.iter().zip(self.levels(index));
        let texts: Vec<String> =
            levels.map(|(column, level)| format!("{} {}", visible_start(column), visible_start(level))).collect();
        texts.join(", ")
    }

    /// Replaces the numbers of conditions, some of which have no pair, by indices of strata.
    fn number_strata(&mut self, numbers: BTreeMap<Vec<String>, usize>) {
        let mut counts = vec![0; numbers.len()];
        self.stratum_of.iter().for_each(|&number| counts[number] += 1);
        let mut index_of = vec![0; numbers.len()];
        let mut levels_of: Vec<(usize, Vec<String>)> =
            numbers.into_iter().map(|(levels, number)| (number, levels)).collect();
        // Strata keep the order in which the first side met them, which is that of its plan and not that of their text.
        levels_of.sort_unstable();
        let (paired, unpaired): (Vec<_>, Vec<_>) = levels_of.into_iter().partition(|&(number, _)| counts[number] > 0);
        for (number, levels) in paired {
            index_of[number] = self.strata.len();
            self.strata.push(Stratum { levels, pairs: counts[number] });
        }
        let planned: BTreeSet<usize> = self.planned.iter().map(|&(.., number)| number).collect();
        // Conditions that only one side has are no stratum without finished pairs; they had no pairs to begin with.
        for (number, levels) in unpaired.into_iter().filter(|(number, _)| planned.contains(number)) {
            index_of[number] = self.strata.len() + self.unfinished_strata.len();
            self.unfinished_strata.push(Stratum { levels, pairs: 0 });
        }
        self.stratum_of.iter_mut().for_each(|number| *number = index_of[*number]);
        self.planned.iter_mut().for_each(|(.., number)| *number = index_of[*number]);
    }
}

/// Conditions that tell runs of one seed apart, on either side; what divides the sides is none.
fn varying_columns(first: &Side<'_>, second: &Side<'_>) -> BTreeSet<String> {
    let varying = first.varying().into_iter().chain(second.varying());
    let names = varying.map(|condition| condition.name.clone());
    names.filter(|name| ![first, second].iter().any(|side| side.divided_by == Some(name.as_str()))).collect()
}

/// The runs of a side by their keys; every key once.
fn keyed(
    side: &Side<'_>,
    columns: &BTreeSet<String>,
    numbers: &mut BTreeMap<Vec<String>, usize>,
) -> Result<Vec<(PairKey, usize)>, ComparisonError> {
    // In the order of the names: keys may be swept in another order on the other side.
    let conditions: Vec<_> = columns
        .iter()
        .filter_map(|column| side.table.conditions.iter().find(|condition| condition.name == *column))
        .collect();
    let mut index_of: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    let mut keyed: Vec<(PairKey, usize)> = Vec::with_capacity(side.runs.len());
    for &run in &side.runs {
        // Texts of levels are compared once for each combination, not for each run.
        let indices: Vec<u32> = conditions.iter().map(|condition| condition.of_run[run]).collect();
        let number = *index_of.entry(indices).or_insert_with(|| {
            let next = numbers.len();
            let levels = conditions.iter().map(|condition| condition.level_of(run).to_owned()).collect();
            *numbers.entry(levels).or_insert(next)
        });
        keyed.push(((side.table.seeds[run], number), run));
    }
    // By seed and condition, the order in which `new` walks both sides at once.
    keyed.sort_unstable();
    match keyed.windows(2).find(|both| both[0].0 == both[1].0) {
        Some(both) => Err(ComparisonError::SeedTwice { path: side.table.path.clone(), seed: both[0].0.0 }),
        None => Ok(keyed),
    }
}
