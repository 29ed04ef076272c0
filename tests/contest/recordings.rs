//! A recording that an earlier build wrote is read, says what the program computes again, and passes the audit.

use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::scenario;
use wildfire::sim;
use wildfire::timeline::{Outcome, RunIndex, file};

#[test]
fn a_recording_of_the_format_says_what_the_program_computes_anew() {
    let path = format!("{}/tests/data/recordings/format-{}.wildfire", env!("CARGO_MANIFEST_DIR"), file::FORMAT);
    let recorded = file::read(path.as_ref()).expect("it is kept with the tests");
    let changes = ["duration_s=300", "dispatch.policy=auction", "dispatch.idle=regions"].map(str::to_owned);
    let scenario = scenario::load("fleet", &changes).expect("it is built in");
    let again = sim::run(&scenario, recorded.setting.seed).expect("it takes place").timeline;
    assert!(recorded == again, "another run");
    assert_eq!(Outcome::new(&recorded), *RunIndex::new(&again).outcome());
    let verdict = audit_timeline(&recorded, SampleStep::default());
    assert!(verdict.knows_limits && verdict.violation.is_none(), "{:?}", verdict.violation);
}
