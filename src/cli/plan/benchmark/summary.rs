//! What a planner's queries of a variant come to: how many found a drive, and the medians of what these are like.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use crate::cli::plan::benchmark::queries::Queries;
use crate::cli::plan::query::Query;
use crate::picture::charts::Estimate;
use crate::stats::{quantile, quantile_interval, wilson_interval};

/// A number of a query, and how charts show it.
#[derive(Debug)]
pub struct Measure {
    /// Its name in tables of queries.
    pub column: &'static str,
    pub title: &'static str,
    /// The name of an axis, with its unit.
    pub axis: &'static str,
    /// The factor from the column to the axis.
    pub scale: f64,
    pub is_logarithmic: bool,
    value: fn(&Query) -> Option<f64>,
}

pub static LOWER_BOUND_RATIO: Measure = Measure {
    column: "lower_bound_ratio",
    title: "Length over the shortest that could be",
    axis: "length / bound",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| query.outcome.ok()?.lower_bound_ratio,
};

pub static CPU_QUERY: Measure = Measure {
    column: "cpu_query_s",
    title: "CPU time of a query",
    axis: "milliseconds",
    scale: 1e3,
    is_logarithmic: true,
    value: |query| Some(query.cpu_query_s),
};

pub static CLEARANCE: Measure = Measure {
    column: "min_clearance_m",
    title: "Least clearance of a drive",
    axis: "metres",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| Some(query.outcome.ok()?.min_clearance_m),
};

static LENGTH: Measure = Measure {
    column: "length_m",
    title: "Length of a drive",
    axis: "metres",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| Some(query.outcome.ok()?.length_m),
};

static DRIVE_TIME: Measure = Measure {
    column: "drive_s",
    title: "Duration of a drive",
    axis: "seconds",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| Some(query.outcome.ok()?.drive_s),
};

static CUSPS: Measure = Measure {
    column: "cusps",
    title: "Changes between forward and reverse",
    axis: "cusps of a drive",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| Some(query.outcome.ok()?.cusps.into()),
};

static EXPANSIONS: Measure = Measure {
    column: "expansions",
    title: "Nodes that a query expanded",
    axis: "nodes",
    scale: 1.0,
    is_logarithmic: true,
    value: |query| Some(query.expansions as f64),
};

/// All of them, in the order of the charts.
pub static MEASURES: [&Measure; 7] =
    [&LOWER_BOUND_RATIO, &CPU_QUERY, &CLEARANCE, &LENGTH, &DRIVE_TIME, &CUSPS, &EXPANSIONS];

/// The queries of a planner in a variant.
#[derive(Debug)]
pub struct Group {
    pub variant: usize,
    pub planner: Arc<str>,
    pub queries: u64,
    pub solved: u64,
    /// By the column of the measure, ascending.
    values: BTreeMap<&'static str, Vec<f64>>,
}

impl Group {
    /// Divides queries into groups, variant by variant, and in each planner by planner.
    pub fn all(queries: &Queries) -> Vec<Self> {
        let planners = queries.planners();
        let places: BTreeMap<&str, usize> = planners.iter().enumerate().map(|(place, name)| (&**name, place)).collect();
        let mut groups: BTreeMap<(usize, usize), Self> = BTreeMap::new();
        for query in &queries.rows {
            let group = groups.entry((query.variant, places[&*query.planner])).or_insert_with(|| Self {
                variant: query.variant,
                planner: Arc::clone(&query.planner),
                queries: 0,
                solved: 0,
                values: BTreeMap::new(),
            });
            group.queries += 1;
            group.solved += u64::from(query.outcome.is_ok());
            for measure in MEASURES {
                group.values.entry(measure.column).or_default().extend((measure.value)(query));
            }
        }
        let mut groups: Vec<Self> = groups.into_values().collect();
        groups.iter_mut().flat_map(|group| group.values.values_mut()).for_each(|values| values.sort_by(f64::total_cmp));
        groups
    }

    /// Returns the numbers of the queries that have one, ascending, in the unit of the column.
    pub fn values(&self, measure: &Measure) -> &[f64] {
        self.values.get(measure.column).map_or(&[], Vec::as_slice)
    }

    /// Returns the share of queries that found a drive, with Wilson's interval.
    pub fn solved_share(&self) -> Estimate {
        let interval = wilson_interval(self.solved, self.queries).map(|interval| (interval.low, interval.high));
        Estimate { value: self.solved as f64 / self.queries as f64, interval }
    }

    /// Returns the median with the interval of the order statistics; `None` without numbers.
    pub fn median(&self, measure: &Measure) -> Option<Estimate> {
        let values = self.values(measure);
        let interval = quantile_interval(values, 0.5).map(|interval| (interval.low, interval.high));
        Some(Estimate { value: quantile(values, 0.5)?, interval })
    }

    /// Returns the quartiles; `None` without numbers.
    pub fn quartiles(&self, measure: &Measure) -> Option<[f64; 3]> {
        let values = self.values(measure);
        Some([quantile(values, 0.25)?, quantile(values, 0.5)?, quantile(values, 0.75)?])
    }
}

/// An estimate as JSON has it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EstimateMember {
    value: f64,
    low: Option<f64>,
    high: Option<f64>,
}

impl From<Estimate> for EstimateMember {
    fn from(Estimate { value, interval }: Estimate) -> Self {
        Self { value, low: interval.map(|(low, _)| low), high: interval.map(|(_, high)| high) }
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::batch::Value;
    use crate::planning::PlanFailure;
    use crate::planning::judge::DriveFigures;

    /// Two planners on three values of a key, 40 queries each, of which the second planner fails every fourth.
    pub fn made_up() -> Queries {
        let query = |variant: usize, index: u32, planner: usize| {
            let number = f64::from(index + 10 * u32::try_from(variant).expect("a small number"));
            let figures = DriveFigures {
                length_m: 10.0 + number,
                lower_bound_ratio: (index != 7).then_some(1.0 + 0.01 * number),
                min_clearance_m: 0.5 + 0.1 * number,
                cusps: index % 3,
                drive_s: 2.0 + number,
            };
            let fails = planner == 1 && index.is_multiple_of(4);
            Query {
                seed: Some(u64::from(index / 2)),
                variant,
                field: "=made up, \"two\"".into(),
                goal: (index % 2) as usize,
                planner: ["prm-rs", "own"][planner].into(),
                cpu_build_s: 0.25,
                cpu_query_s: 1e-3 * number,
                expansions: u64::from(index),
                outcome: if fails { Err(PlanFailure::BudgetSpent) } else { Ok(figures) },
            }
        };
        let rows =
            (0..3).flat_map(|variant| (0..40).flat_map(move |index| [0, 1].map(|one| query(variant, index, one))));
        let values = [Value::Real(0.05), Value::Real(0.1), Value::Count(1)];
        Queries {
            keys: vec!["field.coverage".into(), "fire.model".into()],
            variants: values.map(|value| vec![value, Value::Text("-so".into())]).to_vec(),
            rows: rows.collect(),
        }
    }

    #[test]
    fn groups_hold_each_query_once() {
        let queries = made_up();
        let groups = Group::all(&queries);
        let names: Vec<_> =
            groups.iter().map(|group| (group.variant, &*group.planner, group.queries, group.solved)).collect();
        let expected: Vec<_> =
            (0..3).flat_map(|variant| [(variant, "prm-rs", 40, 40), (variant, "own", 40, 30)]).collect();
        assert_eq!(names, expected);
        assert_eq!(groups[0].values(&LOWER_BOUND_RATIO).len(), 39, "one has no bound");
        assert_eq!(groups[1].values(&LOWER_BOUND_RATIO).len(), 29, "those without a drive have none");
        assert_eq!(groups[1].values(&CPU_QUERY).len(), 40, "they took time all the same");
    }

    #[test]
    fn medians_and_shares_are_those_that_one_can_reckon() {
        let groups = Group::all(&made_up());
        // 40 numbers from 0 to 39 in steps of 1: the interval is the 14th and the 27th of them.
        let cpu = groups[0].median(&CPU_QUERY).expect("there are numbers");
        assert!((cpu.value - 19.5e-3).abs() < 1e-12);
        assert_eq!(cpu.interval, Some((1e-3 * 13.0, 1e-3 * 26.0)));
        assert_eq!(groups[0].quartiles(&EXPANSIONS), Some([9.75, 19.5, 29.25]));
        let share = groups[1].solved_share();
        assert_eq!(share.value, 0.75);
        let (low, high) = share.interval.expect("there are queries");
        assert!((low - 0.598).abs() < 1e-3 && (high - 0.858).abs() < 1e-3, "{low} {high}");
    }

    #[test]
    fn table_reads_back_as_it_was() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let (path, again) = (folder.path().join("one.csv"), folder.path().join("two.csv"));
        let queries = made_up();
        queries.write(&path).expect("writable");
        let read = Queries::read(&path).expect("it was just written");
        assert_eq!((&read.keys, &read.variants), (&queries.keys, &queries.variants));
        for (one, other) in queries.rows.iter().zip(&read.rows) {
            assert_eq!(format!("{one:?}"), format!("{other:?}"));
        }
        read.write(&again).expect("writable");
        let [one, two] = [path, again].map(|path| std::fs::read_to_string(path).expect("readable"));
        assert_eq!(one, two);
        assert!(
            one.starts_with("seed,field.coverage,fire.model,field,goal,planner,success,reason,cpu_build_s,"),
            "{one}"
        );
        assert!(one.contains("\n0,0.05,'-so,\"'=made up, \"\"two\"\"\",0,prm-rs,true,,0.25,"), "{one}");
    }
}
