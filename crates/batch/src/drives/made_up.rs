//! An invented table of drives for tests.

use super::query::{DriveFailure, DriveQuery, QueryCost};
use super::table::DriveTable;
use crate::plan::Value;
use wildfire_planning::PlanFailure;
use wildfire_planning::judge::DriveFigures;

/// Returns two planners on three values of a key, 40 queries each, of which the second planner fails every fourth; one
/// path of the first has a violation.
pub fn made_up_drives() -> DriveTable {
    let query = |variant: usize, index: u32, planner: usize| {
        let number = f64::from(index + 10 * u32::try_from(variant).expect("a small number"));
        let figures = DriveFigures {
            length_m: 10.0 + number,
            lower_bound_ratio: (index != 7).then_some(1.0 + 0.01 * number),
            min_clearance_m: 0.5 + 0.1 * number,
            cusps: index % 3,
            drive_s: 2.0 + number,
        };
        let fails = planner == 1 && index.is_multiple_of(4);
        DriveQuery {
            seed: Some(u64::from(index / 2)),
            variant,
            field: "=made up, \"two\"".into(),
            goal: (index % 2) as usize,
            planner: ["prm-rs", "own"][planner].into(),
            cost: Some(QueryCost {
                cpu_build_s: [0.25, 0.5][planner],
                cpu_query_s: 1e-3 * number,
                expansions: u64::from(index),
            }),
            figures: (!fails).then_some(figures),
            failure: fails.then_some(DriveFailure::Planner(PlanFailure::BudgetSpent)),
            certified_bound_m: None,
            violation: (planner == 0 && index == 1).then(|| "it ends elsewhere".into()),
            message: fails.then(|| "no more".into()),
        }
    };
    let rows = (0..3).flat_map(|variant| (0..40).flat_map(move |index| [0, 1].map(|one| query(variant, index, one))));
    let values = [Value::Real(0.05), Value::Real(0.1), Value::Count(1)];
    DriveTable {
        keys: vec!["field.coverage".into(), "fire.model".into()],
        variants: values.map(|value| vec![value, Value::Text("-so".into())]).to_vec(),
        rows: rows.collect(),
    }
}
