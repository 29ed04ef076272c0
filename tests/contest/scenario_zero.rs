//! Zero with a minus in scenarios and field files: it is zero.

use wildfire::scenario::{self, LoadedScenario, Problem};

/// Returns the scenario with a value changed, as a text in which -0 differs from 0; or why it is refused.
fn resolved(name: &str, key: &str, value: &str) -> Result<String, String> {
    let scenario = scenario::load(name, &[format!("{key}={value}")]);
    scenario.map(|scenario| format!("{scenario:?}")).map_err(|error| error.to_string().replace("-0", "0"))
}

#[test]
fn minus_zero_is_zero_in_every_value_of_a_scenario() {
    let mut numbers = 0;
    for name in ["contest", "fleet", "unimog-alone", "local-minima"] {
        let values = LoadedScenario::open(name, &[]).expect("it is built in").values();
        for (key, _) in values {
            for (minus, plus) in [("-0.0", "0.0"), ("-0", "0"), ("[-0.0, -0.0]", "[0.0, 0.0]")] {
                let (found, expected) = (resolved(name, &key, minus), resolved(name, &key, plus));
                assert_eq!(found, expected, "{name}: {key}={minus}");
                numbers += u32::from(expected.is_ok());
            }
        }
    }
    assert!(numbers > 200, "{numbers} zeros are accepted");
}

#[test]
fn minus_zero_in_a_field_file_is_zero() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let truck = scenario::load("contest", &[]).expect("it is built in").unimog.swap_remove(0);
    let problem = |zero: &str| {
        let text = format!(
            "{{\"cells_cr\": [], \"n\": 10, \"cell_m\": 5, \"start\": [{zero}, {zero}, {zero}], \"vehicle\": {{\"length\": 5, \
             \"width\": 2, \"wheelbase\": 3, \"rear_overhang\": {zero}, \"min_turn_radius\": 10}}, \
             \"goals\": [{{\"pose\": [{zero}, {zero}, {zero}]}}, {{\"disc\": [{zero}, {zero}, {zero}]}}]}}"
        );
        let path = scratch.path().join("field.json");
        std::fs::write(&path, text).expect("writable");
        let problem = Problem::open(&path, &truck).unwrap_or_else(|error| panic!("{error}"));
        format!("{:?} {:?} {:?}", problem.start, problem.goals, problem.truck.vehicle)
    };
    assert_eq!(problem("-0.0"), problem("0.0"));
    assert!(!problem("-0").contains("-0"));
}
