//! The charts of a report.

use super::chart_files::ChartData;
use super::collected::{Collected, Values};
use super::facets::{Facet, FacetSeries, MOST_PANELS, variant_facets};
use super::labels::Labels;
use super::over_time::StateCurves;
use super::quantities::{CPU_PARTS, MEASURES, Quantity, SHARE_AXIS, STATES};
use super::sweeps::{SweepChart, sweep_charts};
use crate::batch::plan::BatchPlan;
use crate::picture::charts::{
    BarChart, BarPanel, BarSeries, ChartRow, Curve, CurveChart, CurvePanel, Drawing, STYLES, Spread, Strip, StripChart,
    StripPanel, Style, Titles,
};
use crate::stats::quantile;

/// The part of the report that a chart belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    Means,
    Distributions,
    OverTime,
    Sweeps,
}

/// A sheet of a chart and the name of its files, without an ending.
#[derive(Debug)]
pub struct Figure {
    pub section: Section,
    pub file: String,
    pub drawing: Drawing,
}

/// The figures of a report.
#[derive(Debug, Default)]
pub struct Figures {
    /// The sheets, in the order of the report.
    pub drawn: Vec<Figure>,
    /// What they show: one for each chart.
    pub data: Vec<ChartData>,
    /// Charts that are not drawn, since they would have too many panels: a sentence for each.
    pub refused: Vec<String>,
}

impl Figures {
    /// Draws the figures of all variants on sheets of this width, in units.
    pub fn new(plan: &BatchPlan, collected: &Collected, states: Option<&[StateCurves]>, width: f32) -> Self {
        let mut figures = Self::default();
        let panels = variant_facets(plan);
        if figures.admits("states, CPU time and distributions of the variants", panels.len()) {
            let means = [
                ("states", bars("Obstacle states at the end", &STATES, &panels, &collected.variants)),
                ("cpu-time", bars("CPU time of a run by part", &CPU_PARTS, &panels, &collected.variants)),
            ];
            for (file, chart) in means {
                figures.add(Section::Means, file, chart.draw(width), chart.rows());
            }
            for &quantity in STATES.iter().chain(&MEASURES) {
                if let Some(chart) = distribution(quantity, &panels, &collected.variants) {
                    let file = format!("distribution-{}", quantity.column());
                    figures.add(Section::Distributions, &file, chart.draw(width), chart.rows());
                }
            }
        }
        figures.add_over_time(plan, states.unwrap_or(&[]), width);
        for SweepChart { file, what, chart } in sweep_charts(plan, &collected.variants) {
            if figures.admits(&what, chart.panels.len()) {
                figures.add(Section::Sweeps, &file, chart.draw(width), chart.rows());
            }
        }
        figures
    }

    /// Says whether a chart has few enough panels; if not, notes in a sentence that it is not drawn.
    fn admits(&mut self, what: &str, panels: usize) -> bool {
        if panels > MOST_PANELS {
            let sentence =
                format!("No charts of {what}: they would have {panels} panels, at most {MOST_PANELS} are drawn.");
            self.refused.extend((!self.refused.contains(&sentence)).then_some(sentence));
        }
        panels <= MOST_PANELS
    }

    /// Adds the sheets of a chart, of which those after the first have a number, and what it shows.
    fn add<'a>(
        &mut self,
        section: Section,
        file: &str,
        sheets: Vec<Drawing>,
        rows: impl Iterator<Item = ChartRow<'a>>,
    ) {
        self.data.push(ChartData::new(file, rows));
        for (index, drawing) in sheets.into_iter().enumerate() {
            let file = if index == 0 { file.to_owned() } else { format!("{file}-{}", index + 1) };
            self.drawn.push(Figure { section, file, drawing });
        }
    }

    /// Adds the states of each variant over time: a chart for each of a few variants, a panel for each of many.
    fn add_over_time(&mut self, plan: &BatchPlan, states: &[StateCurves], width: f32) {
        if !states.iter().any(StateCurves::is_there) {
            return;
        }
        let labels = Labels::new(plan);
        let all = labels.groups().concat();
        let panels: Vec<CurvePanel> = states
            .iter()
            .enumerate()
            .map(|(variant, curves)| {
                let note = if curves.is_there() { "" } else { " (no run is done)" };
                CurvePanel { name: labels.label(variant, &all) + note, curves: state_curves(curves) }
            })
            .collect();
        if panels.len() <= STYLES.len() {
            for (index, panel) in panels.into_iter().enumerate() {
                let (title, file) = (format!(": {}", panel.name), format!("over-time-{}", index + 1));
                let alone = CurvePanel { name: String::new(), ..panel };
                let chart = over_time(&title, vec![alone]);
                self.add(Section::OverTime, &file, chart.draw(width), chart.rows());
            }
        } else if self.admits("states over time", panels.len()) {
            let chart = over_time("", panels);
            self.add(Section::OverTime, "over-time", chart.draw(width), chart.rows());
        }
    }
}

fn bars(title: &str, quantities: &[Quantity], panels: &[Facet], values: &[Values]) -> BarChart {
    let of_series = |series: &FacetSeries| {
        let values = &values[series.variants[0]];
        let bars = quantities.iter().map(|&quantity| values.mean(quantity)).collect();
        BarSeries { name: series.name.clone(), style: series.style, bars }
    };
    BarChart {
        titles: Titles {
            title: title.into(),
            note: "Bars are means, whiskers their 95 % intervals.".into(),
            x: String::new(),
            y: quantities.first().map_or("", |quantity| quantity.axis()).into(),
        },
        groups: quantities.iter().map(|quantity| quantity.label().to_owned()).collect(),
        panels: panels
            .iter()
            .map(|panel| BarPanel { name: panel.name.clone(), series: panel.series.iter().map(of_series).collect() })
            .collect(),
    }
}

/// `None` where all runs have the same.
fn distribution(quantity: Quantity, panels: &[Facet], values: &[Values]) -> Option<StripChart> {
    let strip = |series: &FacetSeries| strip(series, values[series.variants[0]].numbers(quantity));
    let panels: Vec<StripPanel> = panels
        .iter()
        .map(|panel| StripPanel { name: panel.name.clone(), strips: panel.series.iter().map(strip).collect() })
        .collect();
    let ends = panels.iter().flat_map(|panel| &panel.strips);
    let ends = ends.flat_map(|strip| strip.values.first().into_iter().chain(strip.values.last()));
    let (least, most) =
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &end| (least.min(end), most.max(end)));
    (most > least).then(|| StripChart {
        titles: Titles {
            title: quantity.title(),
            note: "Columns count runs; the highest has its number. Below: median, middle half, middle 90 %.".into(),
            x: quantity.axis().into(),
            y: String::new(),
        },
        panels,
    })
}

fn strip(series: &FacetSeries, values: &[f64]) -> Strip {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let quantiles = [0.05, 0.25, 0.5, 0.75, 0.95].map(|share| quantile(&values, share));
    let quantiles = quantiles.iter().all(Option::is_some).then(|| quantiles.map(Option::unwrap_or_default));
    Strip { name: series.name.clone(), style: series.style, values, quantiles }
}

/// Looks of the states: bluish green, vermilion, black, blue.
fn state_styles() -> [Style; STATES.len()] {
    [STYLES[2], STYLES[1], STYLES[6], STYLES[0]]
}

fn state_curves(curves: &StateCurves) -> Vec<Curve> {
    let curve = |((state, style), points): ((&Quantity, Style), &Vec<_>)| Curve {
        name: state.label().into(),
        style,
        points: points.clone(),
    };
    STATES.iter().zip(state_styles()).zip(&curves.0).map(curve).collect()
}

/// The curves of intact obstacles are left out where no other curve or band is higher than this.
const LEAST_OF_HEIGHT: f64 = 0.2;

fn over_time(of: &str, mut panels: Vec<CurvePanel>) -> CurveChart {
    let intact = Quantity::label(STATES[0]);
    let others = panels.iter().flat_map(|panel| &panel.curves).filter(|curve| curve.name != intact);
    let ends = others
        .flat_map(|curve| &curve.points)
        .map(|(_, share)| share.interval.map_or(share.value, |(_, high)| high.max(share.value)));
    let highest = ends.fold(0.0, f64::max);
    let is_dwarfed = highest > 0.0 && highest <= LEAST_OF_HEIGHT;
    if is_dwarfed {
        panels.iter_mut().for_each(|panel| panel.curves.retain(|curve| curve.name != intact));
    }
    CurveChart {
        titles: Titles {
            title: format!("Obstacle states over time{of}"),
            note: "Lines are means, bands the middle 80 % of runs.".into(),
            x: "simulated seconds".into(),
            y: if is_dwarfed { format!("{SHARE_AXIS} (intact left out)") } else { SHARE_AXIS.into() },
        },
        spread: Spread::Bands,
        panels,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::charts::Estimate;

    /// A panel of curves whose states have those shares all the time, and bands of a tenth of that to either side.
    fn panel(shares: [f64; STATES.len()]) -> CurvePanel {
        let estimate = |value: f64| Estimate { value, interval: Some((0.9 * value, 1.1 * value)) };
        let curves = shares.map(|share| vec![(0.0, estimate(share)), (60.0, estimate(share))]);
        CurvePanel { name: String::new(), curves: state_curves(&StateCurves(curves)) }
    }

    #[test]
    fn curves_of_intact_obstacles_are_left_out_where_these_dwarf_the_others() {
        let (calm, wild) = ([0.8, 0.01, 0.18, 0.01], [0.7, 0.05, 0.24, 0.01]);
        for (panels, expected) in [
            (vec![panel(calm)], 3),
            (vec![panel(wild)], 4),
            (vec![panel(calm), panel(wild)], 4),
            (vec![panel([1.0, 0.0, 0.0, 0.0])], 4),
        ] {
            let chart = over_time("", panels);
            assert!(chart.panels.iter().all(|panel| panel.curves.len() == expected), "{:?}", chart.panels);
            assert_eq!(chart.titles.y.contains("intact left out"), expected == 3);
        }
    }
}
