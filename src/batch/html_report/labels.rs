//! Short names of variants for charts: only what differs between them.

use std::collections::BTreeMap;

use crate::batch::plan::planner_of;
use crate::batch::{BatchPlan, Variant};

/// What tells the variants of a plan from each other.
#[derive(Clone, Debug)]
pub struct Labels<'a> {
    plan: &'a BatchPlan,
    scenario: bool,
    planner: bool,
    /// Of swept keys, ascending.
    keys: Vec<usize>,
}

impl<'a> Labels<'a> {
    pub fn of(plan: &'a BatchPlan) -> Self {
        Self {
            plan,
            scenario: differs(plan, |variant| variant.scenario.name.clone()),
            planner: differs(plan, |variant| planner_of(&variant.scenario)),
            keys: (0..plan.swept_keys.len()).filter(|&key| differs(plan, value_of(key))).collect(),
        }
    }

    /// The same without a swept key, and without those that take their values together with it.
    pub fn without(mut self, key: usize) -> Self {
        self.keys.retain(|&other| !follows(self.plan, key, other));
        self
    }

    /// What tells a variant from the others; its scenario's name if nothing does.
    pub fn label(&self, variant: &Variant) -> String {
        let scenario = self.scenario.then(|| variant.scenario.name.clone());
        let planner = self.planner.then(|| planner_of(&variant.scenario));
        let keys = self.keys.iter().map(|&key| format!("{} {}", self.plan.swept_keys[key], variant.swept[key]));
        let parts: Vec<String> = scenario.into_iter().chain(planner).chain(keys).collect();
        if parts.is_empty() { variant.scenario.name.clone() } else { parts.join(", ") }
    }
}

fn value_of(key: usize) -> impl Fn(&Variant) -> String {
    move |variant| variant.swept[key].to_string()
}

fn differs(plan: &BatchPlan, part: impl Fn(&Variant) -> String) -> bool {
    let mut parts = plan.variants.iter().map(part);
    let first = parts.next();
    parts.any(|part| Some(part) != first)
}

/// Whether the value of `key` says what that of `other` is.
fn follows(plan: &BatchPlan, key: usize, other: usize) -> bool {
    let mut known = BTreeMap::new();
    plan.variants.iter().all(|variant| {
        let value = value_of(other)(variant);
        *known.entry(value_of(key)(variant)).or_insert_with(|| value.clone()) == value
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::{BatchRequest, Sweep};

    fn plan(sweeps: Vec<Sweep>) -> BatchPlan {
        let request = BatchRequest {
            scenarios: vec!["smoke".into()],
            sweeps,
            seeds: "1".parse().ok(),
            ..BatchRequest::default()
        };
        request.resolve(false).expect("a small batch")
    }

    fn sweep(key: &str, values: &str) -> Sweep {
        Sweep::parse(key, values).expect("values")
    }

    #[test]
    fn label_is_what_differs() {
        let plan = plan(vec![sweep("field.coverage", "0.05,0.1"), sweep("duration_s", "60")]);
        let labels = Labels::of(&plan);
        assert_eq!(labels.label(&plan.variants[1]), "field.coverage 0.1");
        assert_eq!(labels.without(0).label(&plan.variants[1]), "smoke");
    }

    #[test]
    fn keys_that_are_multiplied_do_not_follow_each_other() {
        let plan = plan(vec![sweep("field.coverage", "0.05,0.1"), sweep("duration_s", "60,90")]);
        let (first, last) = (&plan.variants[0], &plan.variants[3]);
        assert_eq!(Labels::of(&plan).label(last), "field.coverage 0.1, duration_s 90");
        assert_eq!(Labels::of(&plan).without(0).label(last), "duration_s 90");
        assert_ne!(Labels::of(&plan).without(0).label(first), Labels::of(&plan).without(0).label(last));
    }
}
