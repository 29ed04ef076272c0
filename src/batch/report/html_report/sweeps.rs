//! Means over what a batch sweeps.

use super::collected::Values;
use super::facets::{FacetSeries, facets_over};
use super::quantities::ChartChoice;
use super::words;
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
pub fn sweep_charts(plan: &BatchPlan, values: &[Values], choice: &ChartChoice) -> Vec<SweepChart> {
    let language = choice.language;
    let mut charts = Vec::new();
    for (key, name) in plan.swept_keys.iter().enumerate() {
        // An axis needs a number from every variant, and two that differ.
        let places: Option<Vec<f64>> = plan.variants.iter().map(|variant| number(&variant.swept[key])).collect();
        let Some(places) = places.filter(|places| places.iter().any(|place| *place != places[0])) else { continue };
        for quantity in choice.quantities.of_runs() {
            let curve = |series: FacetSeries| {
                let point = |&variant: &usize| Some((places[variant], values[variant].mean(quantity)?));
                let mut points: Vec<_> = series.variants.iter().filter_map(point).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                Curve { name: series.name, style: series.style, points }
            };
            let panels: Vec<CurvePanel> = facets_over(plan, key)
                .into_iter()
                .map(|panel| CurvePanel { name: panel.name, curves: panel.series.into_iter().map(curve).collect() })
                .collect();
            // Where nothing ever happened, such as agents that were never stuck, there is nothing to see.
            let mut points = panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points);
            if !points.any(|(_, estimate)| estimate.value != 0.0) {
                continue;
            }
            let titles = Titles {
                title: words::BY_KEY.filled(language, &[&quantity.title(language), name]),
                note: words::MARKS_ARE_MEANS.in_language(language).into(),
                x: name.into(),
                y: quantity.axis().in_language(language).into(),
                language,
            };
            charts.push(SweepChart {
                file: format!("sweep-{}-{}", file_name_of(name), quantity.column()),
                what: format!("means by {name}"),
                chart: CurveChart { titles, spread: Spread::Whiskers, panels },
            });
        }
    }
    charts
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Count(count) => Some(*count as f64),
        Value::Real(number) => Some(*number),
        Value::Missing | Value::Text(_) | Value::Flag(_) => None,
    }
}
