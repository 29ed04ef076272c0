//! A kept recording of the current format is read, written again as the same bytes, computed again, and audited.

use std::fs;

use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::scenario;
use wildfire::sim;
use wildfire::timeline::{Outcome, RunIndex, file};

#[test]
fn the_kept_recording_is_read_written_computed_and_audited_alike() {
    let path = format!("{}/tests/data/recordings/format-{}.wildfire", env!("CARGO_MANIFEST_DIR"), file::FORMAT);
    let recorded = file::read(path.as_ref()).expect("it is kept with the tests");
    let changes = ["duration_s=300", "dispatch.policy=auction", "dispatch.idle=regions"].map(str::to_owned);
    let scenario = scenario::load("fleet", &changes).expect("it is built in");
    let again = sim::run(&scenario, recorded.setting.seed).expect("it takes place").timeline;
    assert!(recorded == again, "another run");
    assert_eq!(Outcome::new(&recorded), *RunIndex::new(&again).outcome());
    // Equal runs have equal files: tests compare processors and threads by them. Only a new compressor may change the bytes of
    // a run; then this recording is written again.
    let bytes = fs::read(&path).expect("it was just read");
    assert!(file::encode(&recorded).expect("it was read") == bytes, "other bytes");
    let verdict = audit_timeline(&recorded, SampleStep::default());
    assert!(verdict.knows_limits && verdict.violation.is_none(), "{:?}", verdict.violation);
}
