//! Means over what a batch sweeps.

use super::collected::Values;
use super::figures::{Figure, SHOWN_VARIANTS, Section};
use super::labels::Labels;
use super::quantities::{MEASURES, Quantity, STATES};
use crate::batch::{BatchPlan, Value, file_name_of};
use crate::picture::charts::{Curve, CurveChart, STYLES, Spread, Titles};

/// For each key that is swept over numbers, a chart for every quantity; what else differs makes the curves.
pub fn sweep_figures(plan: &BatchPlan, values: &[Values]) -> Vec<Figure> {
    let keys = plan.swept_keys.iter().enumerate().filter(|(index, _)| is_over_numbers(plan, *index));
    let quantities = || STATES.iter().chain(&MEASURES);
    keys.flat_map(|(index, key)| quantities().filter_map(move |quantity| figure(plan, values, index, key, quantity)))
        .collect()
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Count(count) => Some(*count as f64),
        Value::Real(number) => Some(*number),
        Value::Missing | Value::Text(_) => None,
    }
}

fn is_over_numbers(plan: &BatchPlan, key: usize) -> bool {
    let numbers: Option<Vec<f64>> = plan.variants.iter().map(|variant| number(&variant.swept[key])).collect();
    numbers.is_some_and(|numbers| numbers.iter().any(|number| *number != numbers[0]))
}

fn figure(plan: &BatchPlan, values: &[Values], key: usize, name: &str, quantity: &Quantity) -> Option<Figure> {
    let curves = curves(plan, values, key, quantity);
    if !curves.iter().any(|curve| curve.points.iter().any(|(_, estimate)| estimate.value != 0.0)) {
        return None;
    }
    let chart = CurveChart {
        titles: Titles {
            title: format!("{}, by {name}", quantity.title()),
            note: "Marks are means, whiskers their 95 % intervals.".into(),
            x: name.into(),
            y: quantity.unit.of_axis().into(),
        },
        spread: Spread::Whiskers,
        curves,
    };
    let file = format!("sweep-{}-{}", file_name_of(name), quantity.column);
    Some(Figure { section: Section::Sweeps, file, drawing: chart.draw() })
}

/// A curve for each combination of all that differs besides the key.
fn curves(plan: &BatchPlan, values: &[Values], key: usize, quantity: &Quantity) -> Vec<Curve> {
    let labels = Labels::of(plan).without(key);
    let mut curves: Vec<Curve> = Vec::new();
    for (variant, values) in plan.variants.iter().zip(values) {
        let name = labels.label(variant);
        let place = curves.iter().position(|curve| curve.name == name);
        let place = place.unwrap_or(curves.len());
        if place == SHOWN_VARIANTS {
            continue;
        }
        if place == curves.len() {
            curves.push(Curve { name, style: STYLES[place], points: Vec::new() });
        }
        if let (Some(x), Some(estimate)) = (number(&variant.swept[key]), values.mean(quantity)) {
            curves[place].points.push((x, estimate));
        }
    }
    for curve in &mut curves {
        curve.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    curves
}
