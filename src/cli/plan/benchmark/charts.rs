//! The charts of a benchmark: a box of every planner's numbers, and medians over each number that is swept.

use wildfire_batch::drives::{DriveTable, MEASURES, Measure, PlannerSummary};
use wildfire_batch::execute::file_name_of;
use wildfire_batch::plan::Value;
use wildfire_batch::report::{ChartData, FacetSeries, MAX_PANELS, word_facets};
use wildfire_picture::charts::{
    BoxChart, BoxPanel, BoxSeries, Curve, CurveChart, CurvePanel, Drawing, Estimate, Spread, Titles,
};

/// A sheet of a chart and the name of its files, without an ending.
#[derive(Debug)]
pub struct ChartSheet {
    pub file: String,
    /// The name of the file of the chart's data, which all of its sheets share.
    pub data: String,
    pub drawing: Drawing,
}

/// All charts of a benchmark.
#[derive(Debug, Default)]
pub struct Charts {
    pub boxes: Vec<ChartSheet>,
    pub curves: Vec<ChartSheet>,
    /// What they show: one for each chart.
    pub data: Vec<ChartData>,
    /// Omitted charts, since they would have too many panels: a sentence for each.
    pub refused: Vec<String>,
}

impl Charts {
    /// Draws them on sheets of this width, in units.
    pub fn new(queries: &DriveTable, groups: &[PlannerSummary], width: f32) -> Self {
        let mut charts = Self::default();
        for measure in MEASURES {
            let Some(chart) = boxes(queries, groups, measure) else { continue };
            if charts.admits("the queries of each variant", chart.panels.len()) {
                let file = format!("box-{}", measure.column);
                charts.data.push(ChartData::new(&file, chart.rows()));
                charts.boxes.extend(sheets(&file, chart.draw(width)));
            }
        }
        for key in 0..queries.keys.len() {
            let Some(places) = places(queries, groups, key) else { continue };
            let name = &queries.keys[key];
            let over = Over { queries, groups, key, places };
            for (column, chart) in over.charts() {
                if charts.admits(&format!("medians by {name}"), chart.panels.len()) {
                    let file = format!("sweep-{}-{column}", file_name_of(name));
                    charts.data.push(ChartData::new(&file, chart.rows()));
                    charts.curves.extend(sheets(&file, chart.draw(width)));
                }
            }
        }
        charts
    }

    /// Says whether a chart has few enough panels; if not, notes in a sentence that it is not drawn.
    fn admits(&mut self, what: &str, panels: usize) -> bool {
        if panels > MAX_PANELS {
            let sentence =
                format!("No charts of {what}: they would need {panels} panels; at most {MAX_PANELS} are drawn.");
            self.refused.extend((!self.refused.contains(&sentence)).then_some(sentence));
        }
        panels <= MAX_PANELS
    }
}

/// Names the sheets of a chart, those after the first with a number.
fn sheets(file: &str, drawings: Vec<Drawing>) -> impl Iterator<Item = ChartSheet> {
    let sheets = drawings.into_iter().enumerate().map(|(index, drawing)| {
        let name = if index == 0 { file.to_owned() } else { format!("{file}-{}", index + 1) };
        ChartSheet { file: name, data: file.to_owned(), drawing }
    });
    sheets.collect::<Vec<_>>().into_iter()
}

/// The words that tell groups apart: planners, then the values of each key.
fn group_texts(queries: &DriveTable, groups: &[PlannerSummary]) -> Vec<Vec<String>> {
    let planners = groups.iter().map(|group| group.planner.to_string()).collect();
    let values = queries.keys.iter().enumerate().map(|(index, name)| {
        groups.iter().map(|group| format!("{name} {}", queries.variants[group.variant][index])).collect()
    });
    std::iter::once(planners).chain(values).collect()
}

/// `None` where all queries have the same number.
fn boxes(queries: &DriveTable, groups: &[PlannerSummary], measure: &Measure) -> Option<BoxChart> {
    let facets = word_facets(group_texts(queries, groups), None).into_iter();
    let panels = facets.map(|panel| {
        let boxes = panel.series.into_iter().map(|series| {
            let group = &groups[series.variants[0]];
            BoxSeries {
                name: series.name,
                style: series.style,
                values: group.values(measure).iter().map(|value| measure.scale * value).collect(),
                quartiles: group.quartiles(measure).map(|quartiles| quartiles.map(|value| measure.scale * value)),
            }
        });
        BoxPanel { name: panel.name, boxes: boxes.collect() }
    });
    let panels: Vec<BoxPanel> = panels.collect();
    let mut ends =
        panels.iter().flat_map(|panel| &panel.boxes).filter_map(|it| it.values.first().zip(it.values.last()));
    let (&first, _) = ends.clone().next()?;
    ends.any(|(low, high)| *low != first || *high != first).then(|| BoxChart {
        titles: Titles {
            title: measure.title.into(),
            note: "Boxes: the middle half, with the median; whiskers: values within 1.5 boxes; points: \
                outliers."
                .into(),
            x: measure.axis.into(),
            y: String::new(),
        },
        is_logarithmic: measure.is_logarithmic,
        panels,
    })
}

/// Returns the place of each group along an axis of a key; `None` unless all values are numbers, and two differ.
fn places(queries: &DriveTable, groups: &[PlannerSummary], key: usize) -> Option<Vec<f64>> {
    let places = groups.iter().map(|group| match queries.variants[group.variant][key] {
        Value::Count(count) => Some(count as f64),
        Value::Real(number) if number.is_finite() => Some(number),
        _ => None,
    });
    let places: Option<Vec<f64>> = places.collect();
    places.filter(|places| places.iter().any(|place| *place != places[0]))
}

/// A key whose values are an axis.
struct Over<'a> {
    queries: &'a DriveTable,
    groups: &'a [PlannerSummary],
    key: usize,
    /// By group.
    places: Vec<f64>,
}

impl Over<'_> {
    /// Returns the share of queries that found a drive, and the median of every measure, with the names of their files.
    fn charts(&self) -> Vec<(&'static str, CurveChart)> {
        let key = &self.queries.keys[self.key];
        let titles = |title: &str, note: &str, axis: &str| Titles {
            title: format!("{title}, by {key}"),
            note: note.into(),
            x: key.clone(),
            y: axis.into(),
        };
        let note = "Marks are shares of queries, whiskers Wilson's 95 % intervals.";
        let solved = self.chart(titles("Queries that found a drive", note, "percent"), |group| {
            Some(scaled(group.solved_share(), 100.0))
        });
        let note = "Marks are medians, whiskers their 95 % intervals by order statistics.";
        let medians = MEASURES.into_iter().map(|measure| {
            let titles = titles(measure.title, note, measure.axis);
            (measure.column, self.chart(titles, |group| Some(scaled(group.median(measure)?, measure.scale))))
        });
        let mut charts: Vec<_> = std::iter::once(("solved", solved)).chain(medians).collect();
        // A measure that no query has, such as a length where nothing was solved, is left out.
        charts.retain(|(_, chart)| chart.panels.iter().flat_map(|panel| &panel.curves).any(|it| !it.points.is_empty()));
        charts
    }

    fn chart(&self, titles: Titles, value: impl Fn(&PlannerSummary) -> Option<Estimate>) -> CurveChart {
        let curve = |series: FacetSeries| {
            let mut points: Vec<_> = series
                .variants
                .iter()
                .filter_map(|&group| Some((self.places[group], value(&self.groups[group])?)))
                .collect();
            // Points go by value: keys may be swept in any order, and a curve must not run back.
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            Curve { name: series.name, style: series.style, points }
        };
        // Planners come before the keys.
        let facets = word_facets(group_texts(self.queries, self.groups), Some(self.key + 1)).into_iter();
        let panels = facets
            .map(|panel| CurvePanel { name: panel.name, curves: panel.series.into_iter().map(curve).collect() })
            .collect();
        CurveChart { titles, spread: Spread::Whiskers, panels }
    }
}

fn scaled(Estimate { value, interval }: Estimate, factor: f64) -> Estimate {
    Estimate { value: factor * value, interval: interval.map(|(low, high)| (factor * low, factor * high)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_batch::drives::made_up_drives;
    use wildfire_picture::charts::SCREEN_WIDTH;

    #[test]
    fn every_measure_has_boxes_and_a_curve_over_each_key_of_numbers() {
        let queries = made_up_drives();
        let charts = Charts::new(&queries, &PlannerSummary::all(&queries), SCREEN_WIDTH);
        let files = |sheets: &[ChartSheet]| sheets.iter().map(|sheet| sheet.file.clone()).collect::<Vec<_>>();
        assert_eq!(files(&charts.boxes), MEASURES.map(|measure| format!("box-{}", measure.column)));
        // The other key has texts, and but one of them.
        let mut curves = vec!["sweep-field.coverage-solved".to_owned()];
        curves.extend(MEASURES.map(|measure| format!("sweep-field.coverage-{}", measure.column)));
        assert_eq!(files(&charts.curves), curves);
        assert!(charts.refused.is_empty());
        let texts: Vec<&str> = charts.boxes[1].drawing.texts().collect();
        assert!(texts.contains(&"milliseconds") && texts.contains(&"own, field.coverage 0.05"), "{texts:?}");
    }

    #[test]
    fn curves_have_a_point_for_every_value_of_the_key() {
        let queries = made_up_drives();
        let groups = PlannerSummary::all(&queries);
        let places = places(&queries, &groups, 0).expect("numbers");
        let over = Over { queries: &queries, groups: &groups, key: 0, places };
        for (column, chart) in over.charts() {
            let [panel] = &chart.panels[..] else { panic!("{column} has one panel") };
            assert_eq!(panel.curves.iter().map(|curve| curve.name.as_str()).collect::<Vec<_>>(), ["prm-rs", "own"]);
            for curve in &panel.curves {
                assert_eq!(curve.points.iter().map(|point| point.0).collect::<Vec<_>>(), [0.05, 0.1, 1.0], "{column}");
            }
        }
        assert!(super::places(&queries, &groups, 1).is_none());
    }
}
