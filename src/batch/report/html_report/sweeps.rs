//! Means over what a batch sweeps.

use super::collected::Values;
use super::facets::{FacetSeries, facets_over};
use super::quantities::{MEASURES, Quantity, STATES};
use crate::batch::execute::file_name_of;
use crate::batch::plan::{BatchPlan, Value};
use crate::picture::charts::{Curve, CurveChart, CurvePanel, Spread, Titles};

/// A chart over a swept key, with the name of its files, and what it shows.
pub struct SweepChart {
    pub file: String,
    pub what: String,
    pub chart: CurveChart,
}

/// Returns a chart for every quantity over each key that is swept over numbers; other differences make curves and
/// panels.
pub fn sweep_charts(plan: &BatchPlan, values: &[Values]) -> Vec<SweepChart> {
    let keys = plan.swept_keys.iter().enumerate().filter(|(index, _)| is_over_numbers(plan, *index));
    let quantities = || STATES.iter().chain(&MEASURES);
    keys.flat_map(|(index, key)| quantities().filter_map(move |quantity| chart(plan, values, index, key, quantity)))
        .collect()
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Count(count) => Some(*count as f64),
        Value::Real(number) => Some(*number),
        Value::Missing | Value::Text(_) | Value::Flag(_) => None,
    }
}

fn is_over_numbers(plan: &BatchPlan, key: usize) -> bool {
    let numbers: Option<Vec<f64>> = plan.variants.iter().map(|variant| number(&variant.swept[key])).collect();
    numbers.is_some_and(|numbers| numbers.iter().any(|number| *number != numbers[0]))
}

fn chart(plan: &BatchPlan, values: &[Values], key: usize, name: &str, quantity: &Quantity) -> Option<SweepChart> {
    let curve = |series: FacetSeries| {
        let point = |&variant: &usize| number(&plan.variants[variant].swept[key]).zip(values[variant].mean(quantity));
        let mut points: Vec<_> = series.variants.iter().filter_map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve { name: series.name, style: series.style, points }
    };
    let panels: Vec<CurvePanel> = facets_over(plan, key)
        .into_iter()
        .map(|panel| CurvePanel { name: panel.name, curves: panel.series.into_iter().map(curve).collect() })
        .collect();
    let mut points = panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points);
    if !points.any(|(_, estimate)| estimate.value != 0.0) {
        return None;
    }
    let chart = CurveChart {
        titles: Titles {
            title: format!("{}, by {name}", quantity.title()),
            note: "Marks are means, whiskers their 95 % intervals.".into(),
            x: name.into(),
            y: quantity.axis().into(),
        },
        spread: Spread::Whiskers,
        panels,
    };
    let file = format!("sweep-{}-{}", file_name_of(name), quantity.column());
    Some(SweepChart { file, what: format!("means by {name}"), chart })
}
