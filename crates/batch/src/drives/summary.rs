//! The summary of a planner's drives of one variant: how many are solved, and means and quantiles of their figures.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use crate::drives::query::DriveQuery;
use crate::drives::table::DriveTable;
use crate::plan::Value;
use crate::stats::{Series, quantile, quantile_interval, wilson_interval};
use wildfire_picture::charts::Estimate;

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
    value: fn(&DriveQuery) -> Option<f64>,
}

impl Measure {
    /// Returns the number of a query; `None` where it has none.
    pub fn number(&self, query: &DriveQuery) -> Option<f64> {
        (self.value)(query)
    }
}

pub static LOWER_BOUND_RATIO: Measure = Measure {
    column: "lower_bound_ratio",
    title: "Length over the shortest that could be",
    axis: "length / bound",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| query.solved()?.lower_bound_ratio,
};

pub static CPU_QUERY: Measure = Measure {
    column: "cpu_query_s",
    title: "CPU time of a query",
    axis: "milliseconds",
    scale: 1e3,
    is_logarithmic: true,
    value: |query| Some(query.cost?.cpu_query_s),
};

pub static CLEARANCE: Measure = Measure {
    column: "min_clearance_m",
    title: "Least clearance of a drive",
    axis: "metres",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| Some(query.solved()?.min_clearance_m),
};

pub static CPU_BUILD: Measure = Measure {
    column: "cpu_build_s",
    title: "CPU time of clearance field and preparation",
    axis: "milliseconds",
    scale: 1e3,
    is_logarithmic: true,
    // All goals of a field share it.
    value: |query| query.cost.filter(|_| query.goal == 0).map(|cost| cost.cpu_build_s),
};

pub static LENGTH: Measure = Measure {
    column: "length_m",
    title: "Length of a drive",
    axis: "metres",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| Some(query.solved()?.length_m),
};

pub static DRIVE_TIME: Measure = Measure {
    column: "drive_s",
    title: "Duration of a drive",
    axis: "seconds",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| Some(query.solved()?.drive_s),
};

pub static CUSPS: Measure = Measure {
    column: "cusps",
    title: "Changes between forward and reverse",
    axis: "cusps of a drive",
    scale: 1.0,
    is_logarithmic: false,
    value: |query| Some(query.solved()?.cusps.into()),
};

static EXPANSIONS: Measure = Measure {
    column: "expansions",
    title: "Nodes that a query expanded",
    axis: "nodes",
    scale: 1.0,
    is_logarithmic: true,
    value: |query| Some(query.cost?.expansions as f64),
};

/// All of them, in the order of the charts.
pub static MEASURES: [&Measure; 8] =
    [&LOWER_BOUND_RATIO, &CPU_QUERY, &CLEARANCE, &LENGTH, &DRIVE_TIME, &CUSPS, &EXPANSIONS, &CPU_BUILD];

/// The drives of a planner in a variant.
#[derive(Debug)]
pub struct PlannerSummary {
    pub variant: usize,
    pub planner: Arc<str>,
    pub queries: u64,
    pub solved: u64,
    /// Paths that the audit rejects.
    pub violations: u64,
    /// By the column of the measure, ascending.
    values: BTreeMap<&'static str, Vec<f64>>,
}

impl PlannerSummary {
    /// Summarises a table variant by variant, planner by planner.
    pub fn all(table: &DriveTable) -> Vec<Self> {
        let planners = table.planners();
        let places: BTreeMap<&str, usize> = planners.iter().enumerate().map(|(place, name)| (&**name, place)).collect();
        let mut summaries: BTreeMap<(usize, usize), Self> = BTreeMap::new();
        for query in &table.rows {
            let own = summaries.entry((query.variant, places[&*query.planner])).or_insert_with(|| Self {
                variant: query.variant,
                planner: Arc::clone(&query.planner),
                queries: 0,
                solved: 0,
                violations: 0,
                values: BTreeMap::new(),
            });
            own.queries += 1;
            own.solved += u64::from(query.solved().is_some());
            own.violations += u64::from(query.violation.is_some());
            for measure in MEASURES {
                own.values.entry(measure.column).or_default().extend(measure.number(query));
            }
        }
        let mut summaries: Vec<Self> = summaries.into_values().collect();
        let lists = summaries.iter_mut().flat_map(|own| own.values.values_mut());
        lists.for_each(|values| values.sort_by(f64::total_cmp));
        summaries
    }

    /// Returns the numbers of the queries that have one, ascending, in the unit of the column.
    pub fn values(&self, measure: &Measure) -> &[f64] {
        self.values.get(measure.column).map_or(&[], Vec::as_slice)
    }

    /// Returns the share of queries that are solved, with Wilson's interval.
    pub fn solved_share(&self) -> Estimate {
        let interval = wilson_interval(self.solved, self.queries).map(|interval| (interval.low, interval.high));
        Estimate { value: self.solved as f64 / self.queries as f64, interval }
    }

    /// Returns the mean; `None` without numbers.
    pub fn mean(&self, measure: &Measure) -> Option<f64> {
        Series::from_values(self.values(measure)).mean()
    }

    /// Returns the quantile at `share`, from 0 to 1; `None` without numbers.
    pub fn quantile(&self, measure: &Measure, share: f64) -> Option<f64> {
        quantile(self.values(measure), share)
    }

    /// Returns the median with the interval of the order statistics; `None` without numbers.
    pub fn median(&self, measure: &Measure) -> Option<Estimate> {
        let interval = quantile_interval(self.values(measure), 0.5).map(|interval| (interval.low, interval.high));
        Some(Estimate { value: self.quantile(measure, 0.5)?, interval })
    }

    /// Returns the quartiles; `None` without numbers.
    pub fn quartiles(&self, measure: &Measure) -> Option<[f64; 3]> {
        let values = self.values(measure);
        Some([quantile(values, 0.25)?, quantile(values, 0.5)?, quantile(values, 0.75)?])
    }
}

/// A summary as JSON has it.
#[derive(Serialize)]
pub struct SummaryMember<'a> {
    /// The values of its variant, by key.
    #[serde(flatten)]
    swept: BTreeMap<&'a str, &'a Value>,
    planner: &'a str,
    queries: u64,
    solved: u64,
    solved_ratio: EstimateMember,
    violations: u64,
    /// By column; only of those with numbers.
    figures: BTreeMap<&'static str, FigureMember>,
}

/// Statistics of the numbers of a column.
#[derive(Serialize)]
struct FigureMember {
    count: usize,
    mean: Option<f64>,
    median: f64,
    median_low: Option<f64>,
    median_high: Option<f64>,
    p95: Option<f64>,
    max: Option<f64>,
}

#[derive(Serialize)]
struct EstimateMember {
    value: f64,
    low: Option<f64>,
    high: Option<f64>,
}

impl<'a> SummaryMember<'a> {
    pub fn new(table: &'a DriveTable, summary: &'a PlannerSummary) -> Self {
        let share = summary.solved_share();
        let figure = |measure: &&Measure| {
            let median = summary.median(measure)?;
            let member = FigureMember {
                count: summary.values(measure).len(),
                mean: summary.mean(measure),
                median: median.value,
                median_low: median.interval.map(|(low, _)| low),
                median_high: median.interval.map(|(_, high)| high),
                p95: summary.quantile(measure, 0.95),
                max: summary.quantile(measure, 1.0),
            };
            Some((measure.column, member))
        };
        Self {
            swept: table.keys.iter().map(String::as_str).zip(&table.variants[summary.variant]).collect(),
            planner: &summary.planner,
            queries: summary.queries,
            solved: summary.solved,
            solved_ratio: EstimateMember {
                value: share.value,
                low: share.interval.map(|(low, _)| low),
                high: share.interval.map(|(_, high)| high),
            },
            violations: summary.violations,
            figures: MEASURES.iter().filter_map(figure).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::made_up_drives;

    #[test]
    fn summaries_hold_each_query_once() {
        let queries = made_up_drives();
        let groups = PlannerSummary::all(&queries);
        let names: Vec<_> =
            groups.iter().map(|group| (group.variant, &*group.planner, group.queries, group.solved)).collect();
        let expected: Vec<_> =
            (0..3).flat_map(|variant| [(variant, "prm-rs", 40, 39), (variant, "own", 40, 30)]).collect();
        assert_eq!(names, expected);
        assert_eq!(groups[0].values(&LOWER_BOUND_RATIO).len(), 38, "one has no bound, one a violation");
        assert_eq!(groups[1].values(&LOWER_BOUND_RATIO).len(), 29, "those without a drive have none");
        assert_eq!(groups[1].values(&CPU_QUERY).len(), 40, "they took time all the same");
    }

    #[test]
    fn medians_and_shares_are_those_that_one_can_reckon() {
        let groups = PlannerSummary::all(&made_up_drives());
        // 40 numbers from 0 to 39 in steps of 1: the interval is the 14th and the 27th of them.
        let cpu = groups[0].median(&CPU_QUERY).expect("there are numbers");
        assert!((cpu.value - 19.5e-3).abs() < 1e-12);
        assert_eq!(cpu.interval, Some((1e-3 * 13.0, 1e-3 * 26.0)));
        assert_eq!([0.95, 1.0].map(|share| groups[0].quantile(&EXPANSIONS, share)), [37.05, 39.0].map(Some));
        assert_eq!((groups[0].mean(&EXPANSIONS), groups[0].values(&CPU_BUILD).len()), (Some(19.5), 20));
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
        let queries = made_up_drives();
        queries.write(&path).expect("writable");
        let read = DriveTable::read(&path).expect("it was just written");
        assert_eq!((&read.keys, &read.variants), (&queries.keys, &queries.variants));
        // Messages of planners are no column.
        let without_message = |row: &DriveQuery| DriveQuery { message: None, ..row.clone() };
        assert_eq!(queries.rows.iter().map(without_message).collect::<Vec<_>>(), read.rows);
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
