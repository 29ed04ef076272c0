//! Short names of variants for charts, made of their differences.

use std::collections::BTreeMap;

use crate::plan::{BatchPlan, planner_of};

/// The place of planners in a label, between scenarios and swept keys.
const PLANNERS: usize = 1;

/// The names of a plan's variants, made of their differences.
#[derive(Clone, Debug)]
pub struct Labels {
    /// The name of all scenarios where nothing differs.
    scenario: String,
    /// Planners first: they are what most charts compare.
    dimensions: Vec<Dimension>,
}

/// A dimension in which variants differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// The index of the swept key, if it is one.
    key: Option<usize>,
    /// The word of each variant, as a chart shows it: `prm-rs`, `field.coverage 0.1`.
    texts: Vec<String>,
    /// Its place in a label.
    place: usize,
}

impl Labels {
    pub fn new(plan: &BatchPlan) -> Self {
        let names: Vec<String> = plan.variants.iter().map(|variant| variant.scenario.name.clone()).collect();
        let sources: Vec<String> = plan.variants.iter().map(|variant| variant.source.clone()).collect();
        // Two files may hold scenarios of one name.
        let scenarios = if follows(&names, &sources) { names } else { sources };
        let planners = plan.variants.iter().map(|variant| planner_of(&variant.scenario)).collect();
        let swept = plan.swept_keys.iter().enumerate().map(|(index, key)| {
            let texts = plan.variants.iter().map(|variant| format!("{key} {}", variant.swept[index])).collect();
            Dimension { key: Some(index), texts, place: index + 2 }
        });
        let all = [
            Dimension { key: None, texts: planners, place: PLANNERS },
            Dimension { key: None, texts: scenarios, place: 0 },
        ];
        let dimensions = all.into_iter().chain(swept).filter(Dimension::differs).collect();
        let mut labels = Self { scenario: plan.variants[0].scenario.name.clone(), dimensions };
        // Two variants with equal labels would be one series in every chart.
        labels.tell_all_apart(plan.variants.len());
        labels
    }

    /// Creates names from lists of words, each of which has a word for each thing.
    pub fn from_texts(lists: Vec<Vec<String>>) -> Self {
        let alone = lists.first().and_then(|texts| texts.first()).cloned().unwrap_or_default();
        let dimensions = lists
            .into_iter()
            .enumerate()
            .map(|(place, texts)| Dimension { key: Some(place), texts, place })
            .filter(Dimension::differs)
            .collect();
        Self { scenario: alone, dimensions }
    }

    /// Numbers the variants if the same one is asked for twice.
    fn tell_all_apart(&mut self, variants: usize) {
        let all: Vec<usize> = (0..self.dimensions.len()).collect();
        if self.distinct(&all).len() < variants {
            let texts = (0..variants).map(|index| format!("variant {}", index + 1)).collect();
            self.dimensions.push(Dimension { key: None, texts, place: usize::MAX });
        }
    }

    /// Returns the same without a swept key, and without those that vary together with it.
    pub fn without(mut self, key: usize) -> Self {
        if let Some(left_out) = self.dimensions.iter().find(|dimension| dimension.key == Some(key)).cloned() {
            self.dimensions.retain(|other| other.key.is_none() || !follows(&left_out.texts, &other.texts));
        }
        self
    }

    /// Returns the dimensions by index; those that vary together, such as keys of one sweep, are grouped.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (index, dimension) in self.dimensions.iter().enumerate() {
            // They vary together if either follows from the other.
            let alike = groups.iter_mut().find(|group| {
                let other = &self.dimensions[group[0]].texts;
                follows(other, &dimension.texts) && follows(&dimension.texts, other)
            });
            match alike {
                Some(group) => group.push(index),
                None => groups.push(vec![index]),
            }
        }
        groups
    }

    /// Returns the planners, with everything that varies with them, as dimensions; `None` unless they differ and each
    /// occurs with every combination of the rest.
    pub fn crossed_planners(&self) -> Option<Vec<usize>> {
        let planner_name =
            self.dimensions.iter().position(|dimension| dimension.key.is_none() && dimension.place == PLANNERS)?;
        let planners = self.groups().into_iter().find(|group| group.contains(&planner_name))?;
        let all: Vec<usize> = (0..self.dimensions.len()).collect();
        (self.distinct(&planners).len() * self.distinct(&self.besides(&planners)).len() == self.distinct(&all).len())
            .then_some(planners)
    }

    /// Returns all other dimensions.
    pub fn besides(&self, dimensions: &[usize]) -> Vec<usize> {
        (0..self.dimensions.len()).filter(|index| !dimensions.contains(index)).collect()
    }

    /// Returns the headings of dimensions: a swept key, or `scenario`, `planner`, `variant`.
    pub fn heads(&self, dimensions: &[usize], plan: &BatchPlan) -> Vec<String> {
        let mut parts: Vec<&Dimension> = dimensions.iter().map(|&index| &self.dimensions[index]).collect();
        parts.sort_by_key(|dimension| dimension.place);
        let heads = parts.into_iter().map(|dimension| match (dimension.key, dimension.place) {
            (Some(key), _) => plan.swept_keys[key].clone(),
            (None, 0) => "scenario".into(),
            (None, PLANNERS) => "planner".into(),
            _ => "variant".into(),
        });
        heads.collect()
    }

    /// Returns the name of a variant by these dimensions, or its scenario's name if there are none.
    pub fn label(&self, variant: usize, dimensions: &[usize]) -> String {
        let mut parts: Vec<&Dimension> = dimensions.iter().map(|&index| &self.dimensions[index]).collect();
        parts.sort_by_key(|dimension| dimension.place);
        let texts: Vec<&str> = parts.iter().map(|dimension| dimension.texts[variant].as_str()).collect();
        if texts.is_empty() { self.scenario.clone() } else { texts.join(", ") }
    }

    /// Returns the distinct names by these dimensions, in the order of the variants.
    pub fn distinct(&self, dimensions: &[usize]) -> Vec<String> {
        let variants = self.dimensions.first().map_or(1, |dimension| dimension.texts.len());
        let mut seen = BTreeMap::new();
        for variant in 0..variants {
            seen.entry(self.label(variant, dimensions)).or_insert(variant);
        }
        let mut labels: Vec<(usize, String)> = seen.into_iter().map(|(label, first)| (first, label)).collect();
        labels.sort_unstable();
        labels.into_iter().map(|(_, label)| label).collect()
    }
}

impl Dimension {
    fn differs(&self) -> bool {
        self.texts.iter().any(|word| *word != self.texts[0])
    }
}

/// Returns whether the word of a variant in `one` determines that in `other`.
fn follows(one: &[String], other: &[String]) -> bool {
    let mut partners = BTreeMap::new();
    one.iter().zip(other).all(|(word, other)| *partners.entry(word).or_insert(other) == other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{BatchRequest, Sweep};

    fn plan(scenarios: &[&str], sweeps: Vec<Sweep>) -> BatchPlan {
        let request = BatchRequest {
            scenarios: scenarios.iter().map(|&name| name.to_owned()).collect(),
            sweeps,
            seeds: "1".parse().ok(),
            ..BatchRequest::default()
        };
        request.resolve(false).expect("a small batch")
    }

    fn sweep(key: &str, values: &str) -> Sweep {
        Sweep::parse(key, values).expect("values")
    }

    fn all(labels: &Labels) -> Vec<String> {
        labels.distinct(&(0..labels.dimensions.len()).collect::<Vec<_>>())
    }

    #[test]
    fn label_is_what_differs() {
        let plan = plan(&["smoke"], vec![sweep("field.coverage", "0.05,0.1"), sweep("duration_s", "60")]);
        let labels = Labels::new(&plan);
        assert_eq!(all(&labels), ["field.coverage 0.05", "field.coverage 0.1"]);
        assert_eq!(all(&labels.without(0)), ["smoke"]);
    }

    #[test]
    fn keys_that_are_multiplied_do_not_follow_each_other() {
        let plan = plan(&["smoke"], vec![sweep("field.coverage", "0.05,0.1"), sweep("duration_s", "60,90")]);
        let labels = Labels::new(&plan);
        assert_eq!(all(&labels)[3], "field.coverage 0.1, duration_s 90");
        assert_eq!(labels.groups().len(), 2);
        assert_eq!(all(&labels.without(0)), ["duration_s 60", "duration_s 90"]);
    }

    #[test]
    fn keys_that_take_their_values_together_are_one_group() {
        let settings = |text: &str| text.split(',').map(crate::plan::Setting::parse).collect::<Vec<_>>();
        let columns = vec![("field.coverage".into(), settings("0.05,0.1")), ("duration_s".into(), settings("60,90"))];
        let plan = plan(&["smoke"], vec![Sweep::together(columns).expect("pairs")]);
        let labels = Labels::new(&plan);
        assert_eq!(labels.groups().len(), 1);
        assert_eq!(all(&labels.without(0)), ["smoke"]);
    }

    #[test]
    fn no_two_variants_have_one_label() {
        let mut plan = plan(&["smoke", "contest"], Vec::new());
        plan.variants[1].scenario.name = "smoke".into();
        assert_eq!(all(&Labels::new(&plan)), ["smoke", "contest"], "sources where names are equal");
        plan.variants[1] = plan.variants[0].clone();
        assert_eq!(all(&Labels::new(&plan)), ["variant 1", "variant 2"]);
    }
}
