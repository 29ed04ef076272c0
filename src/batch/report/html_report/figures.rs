//! The charts of a report.

use serde::Serialize;

use super::collected::{Collected, Values};
use super::facets::{Facet, FacetSeries, MOST_PANELS, variant_facets};
use super::labels::Labels;
use super::over_time::StateCurves;
use super::quantities::{CPU_PARTS, ChartChoice, Quantity, STATES};
use super::sweeps::{SweepChart, sweep_charts};
use super::words;
use crate::batch::plan::BatchPlan;
use crate::picture::charts::{
    BarChart, BarPanel, BarSeries, ChartRow, Curve, CurveChart, CurvePanel, Drawing, Language, STYLES, Spread, Strip,
    StripChart, StripPanel, Style, Titles, Words,
};
use crate::stats::quantile;
use crate::untrusted::spreadsheet_cell;

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

/// What a chart shows, whatever sheets it takes, and the name of its file, without an ending.
#[derive(Debug)]
pub struct ChartData {
    pub file: String,
    pub rows: Vec<ChartValues>,
}

/// A row of such a file.
#[derive(Debug, Serialize)]
pub struct ChartValues {
    panel: String,
    series: String,
    x: String,
    value: f64,
    low: Option<f64>,
    high: Option<f64>,
}

impl From<ChartRow<'_>> for ChartValues {
    fn from(row: ChartRow<'_>) -> Self {
        let cell = |name: &str| spreadsheet_cell(name).into_owned();
        Self {
            panel: cell(row.panel),
            series: cell(row.series),
            x: cell(&row.x),
            value: row.value,
            low: row.interval.map(|(low, _)| low),
            high: row.interval.map(|(_, high)| high),
        }
    }
}

fn values<'a>(rows: impl Iterator<Item = ChartRow<'a>>) -> Vec<ChartValues> {
    rows.map(ChartValues::from).collect()
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

/// What the figures of a batch are drawn from.
pub struct FigureSource<'a> {
    pub plan: &'a BatchPlan,
    pub collected: &'a Collected,
    /// For each variant, where the batch has them.
    pub states: Option<&'a [StateCurves]>,
}

impl FigureSource<'_> {
    /// Draws the figures of all variants on sheets of this width, in units.
    pub fn draw(&self, choice: &ChartChoice, width: f32) -> Figures {
        let Self { plan, collected, states } = *self;
        let mut figures = Figures::default();
        let panels = variant_facets(plan);
        if figures.admits("states, CPU time and distributions of the variants", panels.len()) {
            for shown in means(choice) {
                let chart = shown.bars(choice.language, &panels, &collected.variants);
                figures.add(Section::Means, &shown.file, chart.draw(width), values(chart.rows()));
            }
            for quantity in choice.quantities.of_runs() {
                if let Some(chart) = distribution(quantity, choice.language, &panels, &collected.variants) {
                    let file = format!("distribution-{}", quantity.column());
                    figures.add(Section::Distributions, &file, chart.draw(width), values(chart.rows()));
                }
            }
        }
        figures.add_over_time(plan, states.unwrap_or(&[]), choice, width);
        for SweepChart { file, what, chart } in sweep_charts(plan, &collected.variants, choice) {
            if figures.admits(&what, chart.panels.len()) {
                figures.add(Section::Sweeps, &file, chart.draw(width), values(chart.rows()));
            }
        }
        figures
    }
}

impl Figures {
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
    fn add(&mut self, section: Section, file: &str, sheets: Vec<Drawing>, rows: Vec<ChartValues>) {
        self.data.push(ChartData { file: file.to_owned(), rows });
        for (index, drawing) in sheets.into_iter().enumerate() {
            let file = if index == 0 { file.to_owned() } else { format!("{file}-{}", index + 1) };
            self.drawn.push(Figure { section, file, drawing });
        }
    }

    /// Adds the states of each variant over time: a chart for each of a few variants, a panel for each of many.
    fn add_over_time(&mut self, plan: &BatchPlan, states: &[StateCurves], choice: &ChartChoice, width: f32) {
        let (shown, language) = (choice.quantities.among(&STATES), choice.language);
        if shown.is_empty() || !states.iter().any(StateCurves::is_there) {
            return;
        }
        let labels = Labels::new(plan);
        let all = labels.groups().concat();
        let panels: Vec<CurvePanel> = states
            .iter()
            .enumerate()
            .map(|(variant, curves)| {
                let label = labels.label(variant, &all);
                let name = if curves.is_there() { label } else { words::NO_RUN_IS_DONE.filled(language, &[&label]) };
                CurvePanel { name, curves: state_curves(curves, &shown, language) }
            })
            .collect();
        if panels.len() <= STYLES.len() {
            for (index, panel) in panels.into_iter().enumerate() {
                let (title, file) = (format!(": {}", panel.name), format!("over-time-{}", index + 1));
                let alone = CurvePanel { name: String::new(), ..panel };
                let chart = over_time(&title, vec![alone], language);
                self.add(Section::OverTime, &file, chart.draw(width), values(chart.rows()));
            }
        } else if self.admits("states over time", panels.len()) {
            let chart = over_time("", panels, language);
            self.add(Section::OverTime, "over-time", chart.draw(width), values(chart.rows()));
        }
    }
}

/// A chart of means.
struct MeansChart {
    /// The name of its file, without an ending.
    file: String,
    title: String,
    /// Its groups of bars, which have one unit.
    quantities: Vec<Quantity>,
}

/// Lists the charts of means. A quantity that was asked for and goes with no other has a chart of its own.
fn means(choice: &ChartChoice) -> Vec<MeansChart> {
    let language = choice.language;
    let together: [(&str, Words, &[Quantity]); 2] =
        [("states", words::STATES_AT_THE_END, &STATES), ("cpu-time", words::CPU_TIME_BY_PART, &CPU_PARTS)];
    let together = together.into_iter().map(|(file, title, all)| MeansChart {
        file: file.to_owned(),
        title: title.in_language(language).to_owned(),
        quantities: choice.quantities.among(all),
    });
    let is_alone = |quantity: &&Quantity| !STATES.contains(quantity) && !CPU_PARTS.contains(quantity);
    let alone = choice.quantities.asked().iter().filter(is_alone).map(|&quantity| MeansChart {
        file: format!("mean-{}", quantity.column()),
        title: quantity.title(language),
        quantities: vec![quantity],
    });
    together.chain(alone).filter(|chart| !chart.quantities.is_empty()).collect()
}

impl MeansChart {
    fn bars(&self, language: Language, panels: &[Facet], values: &[Values]) -> BarChart {
        let quantities = &self.quantities;
        let of_series = |series: &FacetSeries| {
            let values = &values[series.variants[0]];
            let bars = quantities.iter().map(|&quantity| values.mean(quantity)).collect();
            BarSeries { name: series.name.clone(), style: series.style, bars }
        };
        BarChart {
            titles: Titles {
                title: self.title.clone(),
                note: words::BARS_ARE_MEANS.in_language(language).into(),
                x: String::new(),
                y: quantities.first().map_or("", |quantity| quantity.axis().in_language(language)).into(),
                language,
            },
            groups: quantities.iter().map(|quantity| quantity.label(language).to_owned()).collect(),
            panels: panels
                .iter()
                .map(|panel| BarPanel {
                    name: panel.name.clone(),
                    series: panel.series.iter().map(of_series).collect(),
                })
                .collect(),
        }
    }
}

/// `None` where all runs have the same.
fn distribution(quantity: Quantity, language: Language, panels: &[Facet], values: &[Values]) -> Option<StripChart> {
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
            title: quantity.title(language),
            note: words::COLUMNS_COUNT_RUNS.in_language(language).into(),
            x: quantity.axis().in_language(language).into(),
            y: String::new(),
            language,
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

fn state_curves(curves: &StateCurves, shown: &[Quantity], language: Language) -> Vec<Curve> {
    let curve = |((state, style), points): ((&Quantity, Style), &Vec<_>)| Curve {
        name: state.label(language).into(),
        style,
        points: points.clone(),
    };
    let all = STATES.iter().zip(state_styles()).zip(&curves.0);
    all.filter(|((state, _), _)| shown.contains(state)).map(curve).collect()
}

/// The curves of intact obstacles are left out where no other curve or band is higher than this.
const LEAST_OF_HEIGHT: f64 = 0.2;

fn over_time(of: &str, mut panels: Vec<CurvePanel>, language: Language) -> CurveChart {
    let intact = STATES[0].label(language);
    let others = panels.iter().flat_map(|panel| &panel.curves).filter(|curve| curve.name != intact);
    let ends = others
        .flat_map(|curve| &curve.points)
        .map(|(_, share)| share.interval.map_or(share.value, |(_, high)| high.max(share.value)));
    let highest = ends.fold(0.0, f64::max);
    let is_dwarfed = highest > 0.0 && highest <= LEAST_OF_HEIGHT;
    let has_left_out = is_dwarfed && panels.iter().flat_map(|panel| &panel.curves).any(|curve| curve.name == intact);
    let share = words::SHARE_OF_OBSTACLES.in_language(language);
    if has_left_out {
        panels.iter_mut().for_each(|panel| panel.curves.retain(|curve| curve.name != intact));
    }
    CurveChart {
        titles: Titles {
            title: format!("{}{of}", words::STATES_OVER_TIME.in_language(language)),
            note: words::LINES_ARE_MEANS.in_language(language).into(),
            x: words::SIMULATED_SECONDS.in_language(language).into(),
            y: if has_left_out { words::INTACT_LEFT_OUT.filled(language, &[share]) } else { share.into() },
            language,
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
        CurvePanel { name: String::new(), curves: state_curves(&StateCurves(curves), &STATES, Language::English) }
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
            let chart = over_time("", panels, Language::English);
            assert!(chart.panels.iter().all(|panel| panel.curves.len() == expected), "{:?}", chart.panels);
            assert_eq!(chart.titles.y.contains("intact left out"), expected == 3);
        }
    }
}
