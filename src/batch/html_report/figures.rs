//! The charts of a report.

use super::collected::{Collected, Values};
use super::labels::Labels;
use super::over_time::StateCurves;
use super::quantities::{CPU_PARTS, MEASURES, Quantity, STATES, Unit};
use super::sweeps::sweep_figures;
use crate::batch::BatchPlan;
use crate::picture::charts::{
    BarChart, BarSeries, Curve, CurveChart, Drawing, STYLES, Spread, Strip, StripChart, Style, Titles,
};
use crate::stats::quantile;

/// The most variants that a chart shows, which is how many can be told apart.
pub const SHOWN_VARIANTS: usize = STYLES.len();

/// What a chart belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    Means,
    Distributions,
    OverTime,
    Sweeps,
}

/// A chart and the name of its files, without an ending.
#[derive(Debug)]
pub struct Figure {
    pub section: Section,
    pub file: String,
    pub drawing: Drawing,
}

/// All charts, in the order of the report; of many variants the first are shown.
pub fn figures(plan: &BatchPlan, collected: &Collected, states: Option<&[StateCurves]>) -> Vec<Figure> {
    let labels = Labels::of(plan);
    let labels: Vec<String> = plan.variants.iter().take(SHOWN_VARIANTS).map(|variant| labels.label(variant)).collect();
    let shown: Vec<(&str, &Values)> = labels.iter().map(String::as_str).zip(&collected.variants).collect();
    let mut figures = vec![
        bars("states", "Obstacle states at the end", &STATES, &shown),
        bars("cpu-time", "CPU time of a run by part", &CPU_PARTS, &shown),
    ];
    figures.extend(STATES.iter().chain(&MEASURES).filter_map(|quantity| distribution(quantity, &shown)));
    let curves = states.into_iter().flatten().zip(&labels).enumerate();
    figures.extend(curves.filter_map(|(index, (curves, label))| over_time(index, label, curves)));
    figures.extend(sweep_figures(plan, &collected.variants));
    figures
}

fn bars(file: &str, title: &str, quantities: &[Quantity], shown: &[(&str, &Values)]) -> Figure {
    let chart = BarChart {
        titles: Titles {
            title: title.into(),
            note: "Bars are means, whiskers their 95 % intervals.".into(),
            x: String::new(),
            y: quantities.first().map_or("", |quantity| quantity.unit.of_axis()).into(),
        },
        groups: quantities.iter().map(|quantity| quantity.name.to_owned()).collect(),
        series: shown
            .iter()
            .map(|(name, values)| BarSeries {
                name: (*name).to_owned(),
                bars: quantities.iter().map(|quantity| values.mean(quantity)).collect(),
            })
            .collect(),
    };
    Figure { section: Section::Means, file: file.into(), drawing: chart.draw() }
}

/// `None` where all runs have the same.
fn distribution(quantity: &Quantity, shown: &[(&str, &Values)]) -> Option<Figure> {
    let strips: Vec<Strip> = shown.iter().filter_map(|(name, values)| strip(name, values.of(quantity))).collect();
    let least = strips.iter().map(|strip| strip.values[0]).fold(f64::INFINITY, f64::min);
    if !strips.iter().any(|strip| strip.values.last().is_some_and(|&most| most > least)) {
        return None;
    }
    let chart = StripChart {
        titles: Titles {
            title: quantity.title(),
            note: "Columns count runs; the highest has its number. Below: median, middle half, middle 90 %.".into(),
            x: quantity.unit.of_axis().into(),
            y: String::new(),
        },
        strips,
    };
    let file = format!("distribution-{}", quantity.column);
    Some(Figure { section: Section::Distributions, file, drawing: chart.draw() })
}

fn strip(name: &str, values: &[f64]) -> Option<Strip> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let [p5, p25, p50, p75, p95] = [0.05, 0.25, 0.5, 0.75, 0.95].map(|share| quantile(&values, share));
    let quantiles = [p5?, p25?, p50?, p75?, p95?];
    Some(Strip { name: name.into(), values, quantiles })
}

/// Looks of the states: bluish green, vermilion, black, blue.
fn state_styles() -> [Style; STATES.len()] {
    [STYLES[2], STYLES[1], STYLES[6], STYLES[0]]
}

fn over_time(index: usize, label: &str, curves: &StateCurves) -> Option<Figure> {
    if curves.0[0].len() < 2 {
        return None;
    }
    let curve = |((state, style), points): ((&Quantity, Style), &Vec<_>)| Curve {
        name: state.name.into(),
        style,
        points: points.clone(),
    };
    let chart = CurveChart {
        titles: Titles {
            title: format!("Obstacle states over time: {label}"),
            note: "Lines are means, bands the middle 80 % of runs.".into(),
            x: "simulated seconds".into(),
            y: Unit::Share.of_axis().into(),
        },
        spread: Spread::Bands,
        curves: STATES.iter().zip(state_styles()).zip(&curves.0).map(curve).collect(),
    };
    let file = format!("over-time-{}", index + 1);
    Some(Figure { section: Section::OverTime, file, drawing: chart.draw() })
}
