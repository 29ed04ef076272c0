//! The sides of a comparison: selected runs of tables.

use crate::comparison::error::ComparisonError;
use crate::comparison::runs_table::{RunCondition, RunsTable};
use crate::plan::is_same_value;
use wildfire_base::untrusted::visible_start;
use wildfire_scenario::nearest_name;

/// The maximum number of sides: each has a letter.
pub const MAX_SIDES: usize = 26;

/// The selection of runs, and the column that splits a batch into sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// The column that splits, and its values unless all are used; the first is side A.
    pub by: Option<(String, Vec<String>)>,
    /// Columns, with the value that runs must have in each.
    pub only: Vec<(String, String)>,
}

/// Some runs of a table.
#[derive(Debug)]
pub struct Side<'a> {
    pub letter: char,
    pub table: &'a RunsTable,
    /// The indices of the runs, ascending.
    pub runs: Vec<usize>,
    /// The column that separates it from the other sides of its table.
    pub divided_by: Option<&'a str>,
}

impl<'a> Side<'a> {
    /// Creates one side per table, or the parts of a single one.
    pub fn from_tables(tables: &'a [RunsTable], selection: &Selection) -> Result<Vec<Self>, ComparisonError> {
        let mut sides = match (tables, &selection.by) {
            // A single table is divided by the one condition that varies; with several, choosing one would be a guess.
            ([table], None) => parts(table, the_varying_condition(table, selection)?, &[], selection)?,
            (tables, None) => tables.iter().map(|table| whole(table, selection)).collect::<Result<_, _>>()?,
            (tables, Some((column, levels))) => {
                let divided = tables.iter().map(|table| parts(table, condition(table, column)?, levels, selection));
                divided.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect()
            }
        };
        if sides.len() > MAX_SIDES {
            return Err(ComparisonError::TooManySides { count: sides.len(), limit: MAX_SIDES });
        }
        for (side, letter) in sides.iter_mut().zip('A'..) {
            side.letter = letter;
        }
        Ok(sides)
    }

    /// Returns the conditions that vary among its runs.
    pub fn varying(&self) -> Vec<&'a RunCondition> {
        self.table
            .conditions
            .iter()
            .filter(|condition| {
                let mut levels = self.runs.iter().map(|&run| condition.of_run[run]);
                let first = levels.next();
                levels.any(|level| Some(level) != first)
            })
            .collect()
    }

    /// Returns whether a run of its table finished.
    pub fn is_done(&self, run: usize) -> bool {
        self.table.done[run]
    }

    pub fn failed(&self) -> usize {
        self.runs.iter().filter(|&&run| !self.is_done(run)).count()
    }

    /// Returns what all its runs share, such as `A: runs/contest (scenario contest, planner prm-rs)`.
    pub fn description(&self) -> String {
        let varying: Vec<_> = self.varying().iter().map(|condition| &condition.name).collect();
        let common = self.table.conditions.iter().filter(|condition| !varying.contains(&&condition.name));
        // A batch without trucks has no planner.
        let is_named =
            |condition: &&RunCondition| self.runs.first().is_some_and(|&run| !condition.level_of(run).is_empty());
        let common: Vec<_> = common
            .filter(is_named)
            .map(|condition| {
                let level = self.runs.first().map_or("", |&run| condition.level_of(run));
                format!("{} {}", visible_start(&condition.name), visible_start(level))
            })
            .collect();
        let path = visible_start(&self.table.path.display().to_string());
        if common.is_empty() { path } else { format!("{path} ({})", common.join(", ")) }
    }
}

/// Returns the selected runs of a table as one side.
pub fn whole<'a>(table: &'a RunsTable, selection: &Selection) -> Result<Side<'a>, ComparisonError> {
    let mut runs: Vec<usize> = (0..table.seeds.len()).collect();
    for (column, value) in &selection.only {
        let condition = condition(table, column)?;
        let level = level(table, condition, value)?;
        runs.retain(|&run| condition.of_run[run] == level);
    }
    if runs.is_empty() {
        return Err(ComparisonError::NoRows { path: table.path.clone() });
    }
    Ok(Side { letter: 'A', table, runs, divided_by: None })
}

fn parts<'a>(
    table: &'a RunsTable,
    by: &'a RunCondition,
    levels: &[String],
    selection: &Selection,
) -> Result<Vec<Side<'a>>, ComparisonError> {
    let whole = whole(table, selection)?;
    let levels = if levels.is_empty() {
        // Values keep the order of their first runs, which is that of the plan, so A is the first value that was swept.
        let mut present: Vec<u32> = Vec::new();
        for &run in &whole.runs {
            // One value more than there are letters is enough for the error: a free column has as many values as rows.
            if !present.contains(&by.of_run[run]) && present.len() <= MAX_SIDES {
                present.push(by.of_run[run]);
            }
        }
        present
    } else {
        levels.iter().map(|value| level(table, by, value)).collect::<Result<_, _>>()?
    };
    // A single part has nothing to be compared with.
    if let [only] = levels[..] {
        let column = visible_start(&by.name);
        let value = visible_start(&by.levels[only as usize]);
        return Err(ComparisonError::OneLevel { path: table.path.clone(), column, value });
    }
    let parts = levels.into_iter().map(|level| {
        let runs = whole.runs.iter().copied().filter(|&run| by.of_run[run] == level).collect();
        // Letters follow when all sides are there.
        Side { letter: 'A', table, runs, divided_by: Some(&by.name) }
    });
    Ok(parts.collect())
}

fn the_varying_condition<'a>(table: &'a RunsTable, selection: &Selection) -> Result<&'a RunCondition, ComparisonError> {
    match whole(table, selection)?.varying()[..] {
        [one] => Ok(one),
        ref several => {
            let varying = several.iter().map(|condition| visible_start(&condition.name)).collect();
            Err(ComparisonError::WhatToCompare { path: table.path.clone(), varying })
        }
    }
}

fn condition<'a>(table: &'a RunsTable, column: &str) -> Result<&'a RunCondition, ComparisonError> {
    let names = || table.conditions.iter().map(|condition| condition.name.as_str());
    table.conditions.iter().find(|condition| condition.name == column).ok_or_else(|| {
        ComparisonError::UnknownCondition {
            path: table.path.clone(),
            column: visible_start(column),
            nearest: nearest_name(column, names()).map(|name| visible_start(&name)),
            valid: names().map(visible_start).collect(),
        }
    })
}

fn level(table: &RunsTable, condition: &RunCondition, value: &str) -> Result<u32, ComparisonError> {
    let found = condition.levels.iter().position(|level| is_same_value(level, value));
    found.map(|index| index as u32).ok_or_else(|| ComparisonError::UnknownLevel {
        path: table.path.clone(),
        column: visible_start(&condition.name),
        value: visible_start(value),
        valid: condition.levels.iter().map(|level| visible_start(level)).collect(),
    })
}
