//! The distribution of variants over the panels of a chart, so that none is missing.
//!
//! If every planner occurs in all combinations of the other dimensions, planners are the series of every panel, with the
//! same colours in all charts, and each combination of the rest makes a panel. Otherwise a panel holds as many series as
//! can be distinguished: some dimensions make the series, the rest the panels. If no dimension has few enough values, the
//! variants are divided in their order, with a chart for each part.

use super::labels::Labels;
use crate::plan::BatchPlan;
use wildfire_picture::charts::{STYLES, Style};

/// The maximum number of panels of a chart; one with more is not drawn, which the report states.
pub const MAX_PANELS: usize = 120;

/// A panel of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// The name; empty for a single panel.
    pub name: String,
    pub series: Vec<FacetSeries>,
}

/// A series of a chart: variants with the same appearance.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetSeries {
    pub name: String,
    pub style: Style,
    /// The indices of its variants: one, or those along the x axis.
    pub variants: Vec<usize>,
}

/// Returns panels in which every variant is a series.
pub fn variant_facets(plan: &BatchPlan) -> Vec<Facet> {
    facets(plan.variants.len(), &Labels::new(plan))
}

/// Returns panels with the values of a swept key on the x axis; all other differences make series.
pub fn facets_over(plan: &BatchPlan, key: usize) -> Vec<Facet> {
    facets(plan.variants.len(), &Labels::new(plan).without(key))
}

/// Panels of other things than variants. They are named by lists of words, one list for each way in which they may
/// differ, with a word for each thing; what charts compare most comes first. `over` is the list that makes the x axis.
pub fn word_facets(texts: Vec<Vec<String>>, over: Option<usize>) -> Vec<Facet> {
    let count = texts.first().map_or(0, Vec::len);
    let labels = Labels::from_texts(texts);
    facets(count, &over.map_or_else(|| labels.clone(), |list| labels.clone().without(list)))
}

fn facets(variants: usize, labels: &Labels) -> Vec<Facet> {
    let groups = labels.groups();
    let all: Vec<usize> = groups.concat();
    let in_series = series_dimensions(labels, &groups);
    let in_panels: Vec<usize> = all.iter().copied().filter(|index| !in_series.contains(index)).collect();
    let names = labels.distinct(&in_series);
    let mut panels: Vec<Facet> = Vec::new();
    // Nothing takes few enough values.
    if in_series.is_empty() && !all.is_empty() {
        // The variants are divided in their order, as many to a panel as there are styles to distinguish them.
        for (index, name) in labels.distinct(&all).into_iter().enumerate() {
            if index % STYLES.len() == 0 {
                panels.push(Facet { name: String::new(), series: Vec::new() });
            }
            let variants = (0..variants).filter(|&variant| labels.label(variant, &all) == name).collect();
            let series = &mut panels.last_mut().expect("one was just begun").series;
            series.push(FacetSeries { name, style: STYLES[index % STYLES.len()], variants });
        }
        return panels;
    }
    for variant in 0..variants {
        let panel_name = if in_panels.is_empty() { String::new() } else { labels.label(variant, &in_panels) };
        let place = panels.iter().position(|panel| panel.name == panel_name).unwrap_or(panels.len());
        if place == panels.len() {
            panels.push(Facet { name: panel_name, series: Vec::new() });
        }
        let name = labels.label(variant, &in_series);
        let series = &mut panels[place].series;
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.variants.push(variant),
            None => {
                // The style goes by the name and not by the panel, so that a planner has one colour in all of them.
                let style =
                    STYLES[names.iter().position(|other_name| *other_name == name).expect("all names are known")];
                series.push(FacetSeries { name, style, variants: vec![variant] });
            }
        }
    }
    panels
}

/// Chooses dimensions: planners, or all that make no more series together than there are styles.
fn series_dimensions(labels: &Labels, groups: &[Vec<usize>]) -> Vec<usize> {
    if let Some(planners) = labels.crossed_planners().filter(|planners| labels.distinct(planners).len() <= STYLES.len())
    {
        return planners;
    }
    let mut selected: Vec<usize> = Vec::new();
    for group in groups {
        let with_it = [selected.as_slice(), group.as_slice()].concat();
        if labels.distinct(&with_it).len() <= STYLES.len() {
            selected = with_it;
        }
    }
    selected
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{BatchRequest, Sweep};

    fn plan(sweeps: &[(&str, String)]) -> BatchPlan {
        let sweeps = sweeps.iter().map(|(key, values)| Sweep::parse(key, values).expect("values")).collect();
        let request = BatchRequest {
            scenarios: vec!["smoke".into()],
            sweeps,
            seeds: "1".parse().ok(),
            ..BatchRequest::default()
        };
        request.resolve(false).expect("a small batch")
    }

    fn planners(count: usize) -> (&'static str, String) {
        ("unimog.planner", ["prm-rs", "hybrid-astar", "prm+primitives", "lattice"][..count].join(","))
    }

    fn values(key: &'static str, count: u32) -> (&'static str, String) {
        (key, (1..=count).map(|value| (100 + value).to_string()).collect::<Vec<_>>().join(","))
    }

    /// Counts the series of each panel and checks the laws that hold for all: each variant is in one series, series of
    /// a panel differ in name and look, and one look has one name in all panels that share a sheet.
    fn checked(plan: &BatchPlan, panels: &[Facet]) -> Vec<usize> {
        let series = || panels.iter().flat_map(|panel| &panel.series);
        let mut shown: Vec<usize> = series().flat_map(|series| &series.variants).copied().collect();
        shown.sort_unstable();
        assert_eq!(shown, (0..plan.variants.len()).collect::<Vec<_>>(), "a variant is missing, or there twice");
        for panel in panels {
            for (index, one) in panel.series.iter().enumerate() {
                let is_like = |other: &FacetSeries| other.name == one.name || other.style == one.style;
                assert!(!panel.series[..index].iter().any(is_like), "{panel:?}");
            }
        }
        let with_names = || panels.iter().filter(|panel| !panel.name.is_empty()).flat_map(|panel| &panel.series);
        for one in with_names() {
            assert!(with_names().all(|other| (one.name == other.name) == (one.style == other.style)));
        }
        panels.iter().map(|panel| panel.series.len()).collect()
    }

    #[test]
    fn few_variants_share_one_panel() {
        let plan = plan(&[values("duration_s", 2), values("unimog.speed_mps", 3)]);
        let panels = variant_facets(&plan);
        assert_eq!(checked(&plan, &panels), [6]);
        assert_eq!(panels[0].name, "");
    }

    #[test]
    fn no_planner_is_missing_from_a_sweep() {
        for (sweeps, expected) in [
            (vec![planners(2), values("duration_s", 12)], vec![2; 12]),
            (vec![planners(4), values("duration_s", 3), values("unimog.speed_mps", 2)], vec![4; 6]),
            (vec![planners(2), values("duration_s", 3)], vec![2; 3]),
            (vec![planners(2), values("duration_s", 3), values("unimog.speed_mps", 5)], vec![2; 15]),
            (vec![values("duration_s", 3), values("unimog.speed_mps", 5)], vec![3; 5]),
            (vec![values("duration_s", 30)], vec![7, 7, 7, 7, 2]),
            (vec![values("duration_s", 12), values("unimog.speed_mps", 9)], [vec![7; 15], vec![3]].concat()),
            (vec![planners(4), values("duration_s", 2)], vec![4; 2]),
        ] {
            let plan = plan(&sweeps);
            assert_eq!(checked(&plan, &variant_facets(&plan)), expected, "{sweeps:?}");
        }
    }

    #[test]
    fn planner_has_one_colour_in_all_charts() {
        let plan = plan(&[planners(3), values("duration_s", 3), values("unimog.speed_mps", 2)]);
        let panels = [variant_facets(&plan), facets_over(&plan, 1), facets_over(&plan, 2)];
        let mut styles: Vec<(String, Style)> = Vec::new();
        for series in panels.iter().flatten().flat_map(|panel| &panel.series) {
            match styles.iter().find(|(name, _)| *name == series.name) {
                Some((name, style)) => assert_eq!(series.style, *style, "{name}"),
                None => styles.push((series.name.clone(), series.style)),
            }
        }
        assert_eq!(styles.len(), 3);
    }

    #[test]
    fn things_with_words_are_divided_as_variants_are() {
        let planners = ["a", "b", "a", "b"].map(str::to_owned).to_vec();
        let values = ["key 1", "key 1", "key 2", "key 2"].map(str::to_owned).to_vec();
        let panels = word_facets(vec![planners.clone(), values.clone()], None);
        assert_eq!((panels.len(), panels[0].series.len()), (1, 4));
        let over = word_facets(vec![planners.clone(), values], Some(1));
        let series: Vec<_> = over[0].series.iter().map(|series| (series.name.as_str(), &series.variants[..])).collect();
        assert_eq!(series, [("a", &[0, 2][..]), ("b", &[1, 3])]);
        let alone = word_facets(vec![vec!["a".to_owned()]], None);
        assert_eq!((alone.len(), alone[0].series[0].name.as_str()), (1, "a"));
        assert!(word_facets(vec![Vec::new()], None).is_empty());
        assert_eq!(word_facets(vec![planners[..2].to_vec()], None)[0].series.len(), 2);
    }

    #[test]
    fn facets_are_named_by_what_their_series_share() {
        let plan = plan(&[planners(4), values("duration_s", 3), values("unimog.speed_mps", 2)]);
        let panels = variant_facets(&plan);
        assert_eq!(panels[0].name, "duration_s 101, unimog.speed_mps 101");
        let names: Vec<&str> = panels[0].series.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["prm-rs", "hybrid-astar", "prm+primitives", "lattice"]);
    }

    #[test]
    fn curves_over_a_key_hold_all_other_variants() {
        let plan = plan(&[planners(4), values("duration_s", 3), values("unimog.speed_mps", 5)]);
        let over_time = facets_over(&plan, 0);
        assert_eq!(checked(&plan, &over_time), [4; 5]);
        assert!(over_time.iter().flat_map(|panel| &panel.series).all(|series| series.variants.len() == 3));
        let over_speed = facets_over(&plan, 1);
        assert_eq!(checked(&plan, &over_speed), [4; 3]);
    }
}
