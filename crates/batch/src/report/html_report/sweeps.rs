//! Charts of means over swept keys.

use super::collected::Values;
use super::compared::Compared;
use super::facets::{Facet, FacetSeries, facets_over};
use super::quantities::{SelectedQuantities, key_axis};
use crate::comparison::Metric;
use crate::execute::file_name_of;
use crate::plan::{BatchPlan, Value};
use wildfire_picture::charts::{Curve, CurveChart, CurvePanel, Spread, Titles};

/// A chart over a swept key, with its file name and its data.
pub struct SweepChart {
    pub file: String,
    pub what: String,
    pub chart: CurveChart,
}

/// Returns a chart for every quantity over each numeric swept key; other differences make curves and panels.
pub fn sweep_charts(plan: &BatchPlan, values: &[Values], selected: &SelectedQuantities) -> Vec<SweepChart> {
    let mut charts = Vec::new();
    for (key, name) in plan.swept_keys.iter().enumerate() {
        let Some(places) = places(plan, key) else { continue };
        for quantity in selected.of_runs() {
            let chart = curves_over(plan, values, (key, &places), quantity);
            // Where nothing ever happened, such as agents that were never stuck, there is nothing to see.
            let mut points = chart.panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points);
            if points.any(|(_, estimate)| estimate.value != 0.0) {
                let file = format!("sweep-{}-{}", file_name_of(name), quantity.name);
                charts.push(SweepChart { file, what: format!("means by {name}"), chart });
            }
        }
    }
    charts
}

/// Returns the means of a quantity over the swept key with the most numbers; `None` without a numeric key.
pub fn main_curves(plan: &BatchPlan, values: &[Values], quantity: &'static Metric) -> Option<CurveChart> {
    let (key, places) = main_key(plan)?;
    Some(curves_over(plan, values, (key, &places), quantity))
}

/// Returns the differences of planners from the best over the same key; `None` without one.
pub fn main_differences(plan: &BatchPlan, compared: &Compared) -> Option<CurveChart> {
    let (key, places) = main_key(plan).filter(|_| compared.are_planners && compared.strata.len() > 1)?;
    let curve = |series: FacetSeries| {
        let mut points: Vec<_> = series
            .variants
            .iter()
            .filter_map(|&variant| Some((places[variant], compared.difference_of(variant)?)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        (!points.is_empty()).then_some(Curve { name: series.name, style: series.style, points })
    };
    let panel =
        |panel: Facet| CurvePanel { name: panel.name, curves: panel.series.into_iter().filter_map(curve).collect() };
    // Points go by value: a sweep may list its values in any order, and a curve must not run back.
    let panels = facets_over(plan, key).into_iter().map(panel).collect();
    let name = &plan.swept_keys[key];
    let titles = compared.titles();
    let titles = Titles { x: key_axis(name), title: format!("{}, by {name}", titles.title), ..titles };
    Some(CurveChart { titles, spread: Spread::Differences, panels })
}

/// Returns the key that takes most numbers, with its value for each variant.
fn main_key(plan: &BatchPlan) -> Option<(usize, Vec<f64>)> {
    let keys = (0..plan.swept_keys.len()).filter_map(|key| Some((key, places(plan, key)?)));
    // Of keys with equally many values the first.
    keys.reduce(|one, next| if count_distinct(&next.1) > count_distinct(&one.1) { next } else { one })
}

fn count_distinct(places: &[f64]) -> usize {
    let mut distinct = places.to_vec();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    distinct.len()
}

/// Returns the values of a swept key, by variant; `None` where they are no numbers, or all are equal: an axis needs a number
/// from every variant, and two that differ.
fn places(plan: &BatchPlan, key: usize) -> Option<Vec<f64>> {
    let places: Vec<f64> = plan.variants.iter().map(|variant| number(&variant.swept[key])).collect::<Option<_>>()?;
    places.iter().any(|place| *place != places[0]).then_some(places)
}

fn curves_over(
    plan: &BatchPlan,
    values: &[Values],
    (key, places): (usize, &[f64]),
    quantity: &'static Metric,
) -> CurveChart {
    let curve = |series: FacetSeries| {
        let mut points: Vec<_> = series
            .variants
            .iter()
            .filter_map(|&variant| Some((places[variant], values[variant].mean(quantity)?)))
            .collect();
        // A line joins neighbours, and a plan may sweep values in any order.
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve { name: series.name, style: series.style, points }
    };
    let panels: Vec<CurvePanel> = facets_over(plan, key)
        .into_iter()
        .map(|panel| CurvePanel { name: panel.name, curves: panel.series.into_iter().map(curve).collect() })
        .collect();
    let name = &plan.swept_keys[key];
    let titles = Titles {
        title: format!("{}, by {name}", quantity.title()),
        note: interval_note("Marks"),
        x: key_axis(name),
        y: quantity.axis().into(),
    };
    CurveChart { titles, spread: Spread::Whiskers, panels }
}

/// Describes marks and whiskers.
pub fn interval_note(marks: &str) -> String {
    format!("{marks} are means, whiskers their 95 % intervals.")
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Count(count) => Some(*count as f64),
        Value::Real(number) => Some(*number),
        Value::Missing | Value::Text(_) | Value::Flag(_) => None,
    }
}
