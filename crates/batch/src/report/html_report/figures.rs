//! The charts of a report.

use super::chart_files::ChartData;
use super::collected::{Collected, Values};
use super::compared::Compared;
use super::facets::{Facet, FacetSeries, MAX_PANELS, variant_facets};
use super::labels::Labels;
use super::over_time::StateCurves;
use super::quantities::{
    BURNED_AREA, CPU_PARTS, CPU_TOTALS, SAVED, SHARE_OF_OBSTACLES, STATES, SelectedQuantities, is_of_custom_planners,
};
use super::sweeps::{SweepChart, interval_note, main_curves, main_differences, sweep_charts};
use crate::comparison::Metric;
use crate::plan::BatchPlan;
use crate::stats::quantile;
use wildfire_base::document::number::short;
use wildfire_picture::charts::{
    BarChart, BarPanel, BarSeries, Curve, CurveChart, CurvePanel, Drawing, STYLES, Spread, Strip, StripChart,
    StripPanel, Style, Titles,
};

/// The section of the report to which a chart belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// The picture below the answer.
    Answer,
    Means,
    Distributions,
    OverTime,
    Sweeps,
}

/// A sheet of a chart, with its file name without an extension.
#[derive(Debug)]
pub struct Figure {
    pub section: Section,
    pub file: String,
    /// The name of the chart's data file, which all of its sheets share.
    pub data: String,
    pub drawing: Drawing,
}

/// The figures of a report.
#[derive(Debug, Default)]
pub struct Figures {
    /// The sheets, in the order of the report.
    pub drawn: Vec<Figure>,
    /// The data of the charts.
    pub data: Vec<ChartData>,
    /// A sentence for each chart that is not drawn because it would have too many panels.
    pub refused: Vec<String>,
    /// A sentence for each distribution that is not drawn because all values are equal.
    pub constant: Vec<String>,
}

/// The data from which the figures of a batch are drawn.
pub struct FigureSource<'a> {
    pub plan: &'a BatchPlan,
    pub collected: &'a Collected,
    /// The states of each variant, if the batch has them.
    pub states: Option<&'a [StateCurves]>,
}

impl FigureSource<'_> {
    /// Draws the figures of all variants on sheets of this width, in units. The picture below the answer is omitted if
    /// columns were requested.
    pub fn draw(&self, selected: &SelectedQuantities, width: f32) -> Figures {
        let Self { plan, collected, states } = *self;
        let mut figures = Figures::default();
        let panels = variant_facets(plan);
        // Columns that were requested are what the reader looks for; the answer is about others.
        if plan.variants.len() > 1 && selected.requested().is_empty() {
            self.add_answer(&mut figures, &panels, width);
        }
        if figures.admits("states, CPU time and distributions of the variants", panels.len()) {
            for shown in means(selected) {
                let chart = shown.bars(&panels, &collected.variants);
                figures.add(Section::Means, chart.draw(width), ChartData::new(&shown.file, chart.rows()));
            }
            for quantity in selected.of_runs() {
                match distribution(quantity, &panels, &collected.variants) {
                    Ok(chart) => {
                        let file = format!("distribution-{}", quantity.name);
                        figures.add(Section::Distributions, chart.draw(width), ChartData::new(&file, chart.rows()));
                    }
                    // A distribution that is one bar says in a sentence what it would say in a chart.
                    Err(sentence) => figures.constant.push(sentence),
                }
            }
        }
        figures.add_over_time(plan, states.unwrap_or(&[]), selected, width);
        for SweepChart { file, what, chart } in sweep_charts(plan, &collected.variants, selected) {
            if figures.admits(&what, chart.panels.len()) {
                figures.add(Section::Sweeps, chart.draw(width), ChartData::new(&file, chart.rows()));
            }
        }
        figures
    }

    /// Adds what the answer says: the differences of planners from the best, over a key that is swept over numbers, or of
    /// whatever is compared. Where variants are the values of such a key, their means over it.
    fn add_answer(&self, figures: &mut Figures, panels: &[Facet], width: f32) {
        let variants = &self.collected.variants;
        let quantity = main_quantity(variants);
        let compared = Compared::new(quantity, self.plan, variants);
        let differences = compared.as_ref().and_then(|it| main_differences(self.plan, it));
        let are_planners = compared.as_ref().is_some_and(|it| it.are_planners);
        let chart =
            differences.or_else(|| if are_planners { None } else { main_curves(self.plan, variants, quantity) });
        if let Some(chart) = chart {
            if figures.admits("the answer", chart.panels.len()) {
                figures.add(Section::Answer, chart.draw(width), ChartData::new("answer", chart.rows()));
            }
        // Without a key that is swept over numbers there is no curve, and differences are shown one by one.
        } else if let Some(compared) = compared {
            let chart = compared.forest();
            figures.add(Section::Answer, vec![chart.draw(width)], ChartData::new("answer", chart.rows()));
        } else if figures.admits("the answer", panels.len()) {
            let (drawn, data) = match distribution(quantity, panels, variants) {
                Ok(chart) => (chart.draw(width), ChartData::new("answer", chart.rows())),
                Err(_) => {
                    let shown = MeansChart::new("answer", quantity.title(), vec![quantity]);
                    let chart = shown.bars(panels, variants);
                    (chart.draw(width), ChartData::new("answer", chart.rows()))
                }
            };
            figures.add(Section::Answer, drawn, data);
        }
    }
}

impl Figures {
    /// Returns whether a chart has few enough panels; if not, notes in a sentence that it is not drawn.
    fn admits(&mut self, what: &str, panels: usize) -> bool {
        if panels > MAX_PANELS {
            let sentence =
                format!("No charts of {what}: they would need {panels} panels; at most {MAX_PANELS} are drawn.");
            self.refused.extend((!self.refused.contains(&sentence)).then_some(sentence));
        }
        panels <= MAX_PANELS
    }

    /// Adds the sheets of a chart, of which those after the first have a number, and what it shows.
    fn add(&mut self, section: Section, sheets: Vec<Drawing>, data: ChartData) {
        let name = data.file().to_owned();
        for (index, drawing) in sheets.into_iter().enumerate() {
            let file = if index == 0 { name.clone() } else { format!("{name}-{}", index + 1) };
            self.drawn.push(Figure { section, file, data: name.clone(), drawing });
        }
        self.data.push(data);
    }

    /// Adds the states of each variant over time: a chart for each of a few variants, a panel for each of many.
    fn add_over_time(&mut self, plan: &BatchPlan, states: &[StateCurves], selected: &SelectedQuantities, width: f32) {
        let shown = selected.among(&STATES);
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
                // Panels of variants without a run stay, so no variant is missing from the page without a word.
                let name = if curves.is_there() { label } else { format!("{label} (no finished run)") };
                CurvePanel { name, curves: state_curves(curves, &shown) }
            })
            .collect();
        // A page has room for as many charts as there are styles to distinguish them; beyond that, panels save room.
        if panels.len() <= STYLES.len() {
            for (index, panel) in panels.into_iter().enumerate() {
                let title = format!(": {}", panel.name);
                let file = format!("over-time-{}", index + 1);
                let alone = CurvePanel { name: String::new(), ..panel };
                let chart = over_time(&title, vec![alone]);
                self.add(Section::OverTime, chart.draw(width), ChartData::new(&file, chart.rows()));
            }
        } else if self.admits("states over time", panels.len()) {
            let chart = over_time("", panels);
            self.add(Section::OverTime, chart.draw(width), ChartData::new("over-time", chart.rows()));
        }
    }
}

/// What the totals of CPU time are called, in their order.
const SIDES: [&str; CPU_TOTALS.len()] = ["Trucks", "Trucks, roadmaps only", "Wumpuses"];

/// A chart of means.
struct MeansChart {
    /// The name of its file, without an ending.
    file: String,
    title: String,
    /// Its groups of bars, which have one unit.
    quantities: Vec<&'static Metric>,
    /// Whether bars are sums over all runs instead.
    are_sums: bool,
}

/// Lists the charts of means. A quantity that was asked for and goes with no other has a chart of its own.
fn means(selected: &SelectedQuantities) -> Vec<MeansChart> {
    let together = [
        MeansChart::new("states", "Obstacle states at the end".into(), selected.among(&STATES)),
        MeansChart::new("cpu-time", "CPU time of a run by part".into(), selected.among(&CPU_PARTS)),
    ];
    let totals = if selected.requested().is_empty() { CPU_TOTALS.iter().collect() } else { Vec::new() };
    let sums = MeansChart {
        are_sums: true,
        ..MeansChart::new("cpu-sums", "CPU time of all runs together, by side".into(), totals)
    };
    let alone = selected
        .requested()
        .iter()
        .filter(|quantity| !STATES.contains(quantity) && !CPU_PARTS.contains(quantity))
        .map(|&quantity| MeansChart::new(&format!("mean-{}", quantity.name), quantity.title(), vec![quantity]));
    together.into_iter().chain([sums]).chain(alone).filter(|chart| !chart.quantities.is_empty()).collect()
}

impl MeansChart {
    fn new(file: &str, title: String, quantities: Vec<&'static Metric>) -> Self {
        Self { file: file.to_owned(), title, quantities, are_sums: false }
    }

    fn bars(&self, panels: &[Facet], values: &[Values]) -> BarChart {
        let quantities = self.quantities.iter().copied().filter(|quantity| {
            let mut series = panels.iter().flat_map(|panel| &panel.series);
            // Most batches have no custom planner, and their bars would be empty.
            !is_of_custom_planners(quantity)
                || series.any(|it| values[it.variants[0]].mean(quantity).is_some_and(|mean| mean.value > 0.0))
        });
        let quantities: Vec<&'static Metric> = quantities.collect();
        BarChart {
            titles: Titles {
                title: self.title.clone(),
                note: if self.are_sums {
                    "Bars: sums over all finished runs. The trucks' total includes their roadmaps'.".into()
                } else {
                    interval_note("Bars")
                },
                x: String::new(),
                y: quantities.first().map_or("", |quantity| quantity.axis()).into(),
            },
            groups: match self.are_sums {
                true => SIDES.map(str::to_owned).to_vec(),
                false => quantities.iter().map(|quantity| quantity.label().to_owned()).collect(),
            },
            panels: panels
                .iter()
                .map(|panel| {
                    let series = panel.series.iter().map(|series| {
                        // Every variant is a series of these panels, and the only one in it.
                        let values = &values[series.variants[0]];
                        let bars = quantities.iter().map(|&quantity| match self.are_sums {
                            true => values.sum(quantity),
                            false => values.mean(quantity),
                        });
                        let bars = bars.collect();
                        BarSeries { name: series.name.clone(), style: series.style, bars }
                    });
                    BarPanel { name: panel.name.clone(), series: series.collect() }
                })
                .collect(),
        }
    }
}

/// Returns the quantity by which variants are compared primarily.
pub fn main_quantity(variants: &[Values]) -> &'static Metric {
    if !has_values(variants, &SAVED) && has_values(variants, &BURNED_AREA) { &BURNED_AREA } else { &SAVED }
}

fn has_values(variants: &[Values], quantity: &Metric) -> bool {
    variants.iter().any(|values| values.of_seeds(quantity).iter().any(|number| !number.is_nan()))
}

/// The share of its runs that a variant has at one value whose distribution says no more than that value.
const ALMOST_ALL: f64 = 0.95;

/// Returns the distributions; where each of them is one value, or nearly, a sentence of the page that says so.
fn distribution(quantity: &'static Metric, panels: &[Facet], values: &[Values]) -> Result<StripChart, String> {
    let panels = panels.iter().map(|panel| StripPanel {
        name: panel.name.clone(),
        strips: panel.series.iter().map(|series| strip(series, values[series.variants[0]].numbers(quantity))).collect(),
    });
    let panels: Vec<StripPanel> = panels.collect();
    let strips: Vec<&Strip> = panels.iter().flat_map(|panel| &panel.strips).collect();
    let commonest = strips.iter().map(|strip| commonest(&strip.values)).collect::<Vec<_>>();
    let say_nothing = strips
        // A chart is left out only if no variant needs it, since variants are compared in one chart.
        .iter()
        .zip(&commonest)
        .all(|(strip, (_, count))| strip.values.is_empty() || *count as f64 >= ALMOST_ALL * strip.values.len() as f64);
    if say_nothing {
        return Err(constant_text(quantity, &strips, &commonest));
    }
    Ok(StripChart {
        titles: Titles {
            title: quantity.title(),
            note: "Bars count runs; the highest is labelled. Below: median, middle half, middle 90 %.".into(),
            x: quantity.axis().into(),
            y: "number of runs".into(),
        },
        panels,
    })
}

/// Returns the value that most of the ascending numbers have, and how many; the least of several such.
fn commonest(ascending: &[f64]) -> (f64, usize) {
    let equal = ascending.chunk_by(|one, next| one == next);
    equal.fold((f64::NAN, 0), |best, chunk| if chunk.len() > best.1 { (chunk[0], chunk.len()) } else { best })
}

fn constant_text(quantity: &'static Metric, strips: &[&Strip], commonest: &[(f64, usize)]) -> String {
    let title = quantity.title();
    let unit = quantity.unit();
    let with_runs = || strips.iter().zip(commonest).filter(|(strip, _)| !strip.values.is_empty());
    let all: usize = with_runs().map(|(strip, _)| strip.values.len()).sum();
    let Some((_, &(value, _))) = with_runs().next() else {
        return format!("{title}: no run has a value.");
    };
    if with_runs().any(|(_, (other, _))| *other != value) {
        return format!("{title}: no distributions, since (almost) all runs of a variant have the same value.");
    }
    let value = format!("{} {unit}", short(value));
    let same: usize = with_runs().map(|(_, (_, count))| count).sum();
    match all - same {
        0 => format!("{title}: no distribution, since it is {value} in all {all} runs."),
        _ => format!("{title}: no distribution, since it is {value} in {same} of {all} runs."),
    }
}

fn strip(series: &FacetSeries, mut values: Vec<f64>) -> Strip {
    values.sort_by(f64::total_cmp);
    let quantiles = [0.05, 0.25, 0.5, 0.75, 0.95].map(|share| quantile(&values, share));
    let quantiles = quantiles.iter().all(Option::is_some).then(|| quantiles.map(Option::unwrap_or_default));
    Strip { name: series.name.clone(), style: series.style, values, quantiles }
}

/// Looks of the states: bluish green, vermilion, black, blue.
fn state_styles() -> [Style; STATES.len()] {
    [STYLES[2], STYLES[1], STYLES[6], STYLES[0]]
}

fn state_curves(curves: &StateCurves, shown: &[&'static Metric]) -> Vec<Curve> {
    let all = STATES.iter().zip(state_styles()).zip(&curves.0);
    all.filter(|((state, _), _)| shown.contains(state))
        .map(|((state, style), points)| Curve { name: state.label().into(), style, points: points.clone() })
        .collect()
}

/// The curves of intact obstacles are left out where no other curve or band is higher than this.
const MIN_OF_HEIGHT: f64 = 0.2;

fn over_time(of: &str, mut panels: Vec<CurvePanel>) -> CurveChart {
    let intact = STATES[0].label();
    let others = panels.iter().flat_map(|panel| &panel.curves).filter(|curve| curve.name != intact);
    let ends = others
        .flat_map(|curve| &curve.points)
        .map(|(_, share)| share.interval.map_or(share.value, |(_, high)| high.max(share.value)));
    let highest = ends.fold(0.0, f64::max);
    let is_dwarfed = highest > 0.0 && highest <= MIN_OF_HEIGHT;
    let has_left_out = is_dwarfed && panels.iter().flat_map(|panel| &panel.curves).any(|curve| curve.name == intact);
    // Where hardly anything burns, the curve of intact bushes near 1 leaves all others flat at 0.
    if has_left_out {
        panels.iter_mut().for_each(|panel| panel.curves.retain(|curve| curve.name != intact));
    }
    CurveChart {
        titles: Titles {
            title: format!("Obstacle states over time{of}"),
            note: "Lines are means, bands the middle 80 % of runs.".into(),
            x: "simulated time (s)".into(),
            y: format!("{SHARE_OF_OBSTACLES}{}", if has_left_out { ", intact left out" } else { "" }),
        },
        spread: Spread::Bands,
        panels,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html_report::quantities::MEASURES;
    use wildfire_picture::charts::Estimate;

    /// A panel of curves whose states have those shares all the time, and bands of a tenth of that to either side.
    fn panel(shares: [f64; STATES.len()]) -> CurvePanel {
        let estimate = |value: f64| Estimate { value, interval: Some((0.9 * value, 1.1 * value)) };
        let curves = shares.map(|share| vec![(0.0, estimate(share)), (60.0, estimate(share))]);
        CurvePanel { name: String::new(), curves: state_curves(&StateCurves(curves), &STATES.each_ref()) }
    }

    #[test]
    fn distribution_of_one_value_is_a_sentence() {
        let strip = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            Strip { name: String::new(), style: STYLES[0], values, quantiles: None }
        };
        let sentence = |strips: &[Strip]| {
            let strips: Vec<&Strip> = strips.iter().collect();
            let commonest: Vec<_> = strips.iter().map(|strip| commonest(&strip.values)).collect();
            constant_text(&MEASURES[2], &strips, &commonest)
        };
        let title = MEASURES[2].title();
        assert_eq!(
            sentence(&[strip(vec![0.0; 4])]),
            format!("{title}: no distribution, since it is 0 s in all 4 runs.")
        );
        let nearly = strip([vec![0.0; 20], vec![7.5]].concat());
        assert_eq!(
            sentence(&[nearly, strip(vec![])]),
            format!("{title}: no distribution, since it is 0 s in 20 of 21 runs.")
        );
        assert!(sentence(&[strip(vec![1.0]), strip(vec![2.0])]).contains("of a variant have the same value"));
        assert_eq!(sentence(&[strip(vec![])]), format!("{title}: no run has a value."));
        assert_eq!(commonest(&[1.0, 2.0, 2.0, 3.0, 3.0]), (2.0, 2));
    }

    #[test]
    fn curves_of_intact_obstacles_are_left_out_where_these_dwarf_the_others() {
        let calm = [0.8, 0.01, 0.18, 0.01];
        let wild = [0.7, 0.05, 0.24, 0.01];
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
