//! Runs of two sides that belong together: those of the same seed under the same conditions.

use std::collections::{BTreeMap, BTreeSet};

use crate::batch::comparison::error::ComparisonError;
use crate::batch::comparison::sides::Side;
use crate::batch::comparison::words::shown;

/// Pairs of runs, and what had to be left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pairs {
    /// Indices into the tables of both sides, of runs that both came to their end; by seed.
    pub runs: Vec<(usize, usize)>,
    /// Runs without a partner, on either side.
    pub without_partner: [usize; 2],
    /// Pairs of which the first run, the second, or both did not come to an end.
    pub failed: [usize; 3],
}

/// A seed, and the number of the conditions that vary within a side.
type Key = (u64, usize);

impl Pairs {
    pub fn of(first: &Side<'_>, second: &Side<'_>) -> Result<Self, ComparisonError> {
        let columns = varying_columns(first, second);
        let mut numbers = BTreeMap::new();
        let [ours, theirs] = [keyed(first, &columns, &mut numbers)?, keyed(second, &columns, &mut numbers)?];
        let mut pairs = Self::default();
        let mut partners = theirs.iter().peekable();
        for (key, run) in &ours {
            while partners.next_if(|(other, _)| other < key).is_some() {
                pairs.without_partner[1] += 1;
            }
            match partners.next_if(|(other, _)| other == key) {
                Some((_, partner)) => pairs.add((*run, first.is_done(*run)), (*partner, second.is_done(*partner))),
                None => pairs.without_partner[0] += 1,
            }
        }
        pairs.without_partner[1] += partners.count();
        if pairs.without_partner[0] == ours.len() {
            let varying = columns.iter().map(|column| shown(column)).collect();
            return Err(ComparisonError::NoPairs { other: second.letter, varying });
        }
        Ok(pairs)
    }

    /// Either run with whether it came to its end.
    fn add(&mut self, (first, first_done): (usize, bool), (second, second_done): (usize, bool)) {
        match (first_done, second_done) {
            (true, true) => self.runs.push((first, second)),
            (false, true) => self.failed[0] += 1,
            (true, false) => self.failed[1] += 1,
            (false, false) => self.failed[2] += 1,
        }
    }
}

/// Conditions that tell runs of one seed apart, on either side; what divides the sides is none.
fn varying_columns(first: &Side<'_>, second: &Side<'_>) -> BTreeSet<String> {
    let varying = first.varying().into_iter().chain(second.varying());
    let divides = |name: &str| first.divided_by == Some(name) || second.divided_by == Some(name);
    varying.map(|condition| condition.name.clone()).filter(|name| !divides(name)).collect()
}

/// The runs of a side by their keys; every key once.
fn keyed(
    side: &Side<'_>,
    columns: &BTreeSet<String>,
    numbers: &mut BTreeMap<Vec<String>, usize>,
) -> Result<Vec<(Key, usize)>, ComparisonError> {
    let conditions: Vec<_> = side.table.conditions.iter().filter(|it| columns.contains(&it.name)).collect();
    let mut known: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    let mut number = |run: usize| {
        let indices: Vec<u32> = conditions.iter().map(|condition| condition.of_run[run]).collect();
        *known.entry(indices).or_insert_with(|| {
            let next = numbers.len();
            let levels = conditions.iter().map(|condition| condition.level_of(run).to_owned()).collect();
            *numbers.entry(levels).or_insert(next)
        })
    };
    let mut keyed: Vec<(Key, usize)> =
        side.runs.iter().map(|&run| ((side.table.seeds[run], number(run)), run)).collect();
    keyed.sort_unstable();
    match keyed.windows(2).find(|both| both[0].0 == both[1].0) {
        Some(both) => Err(ComparisonError::SeedTwice { path: side.table.path.clone(), seed: both[0].0.0 }),
        None => Ok(keyed),
    }
}
