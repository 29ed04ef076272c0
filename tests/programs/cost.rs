//! What programs cost is known: their own time, that of their children, and what they say themselves.

use std::time::Duration;

use wildfire::planning::{CpuSource, QueryCpu};

use crate::stage::{AHEAD, Stage, ask, script};

/// A loop that takes some CPU time.
const WORK: &str = "i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done";

fn cpu(body: &str) -> QueryCpu {
    let stage = Stage::new(&script(body), "");
    let mut planner = stage.planner().expect("it starts");
    let plan = ask(planner.as_mut());
    assert!(plan.path.is_ok(), "{:?}", plan.message);
    plan.cpu.expect("it is known")
}

#[test]
fn time_of_a_program_counts_with_that_of_its_children() {
    let idle = cpu(AHEAD);
    let own = cpu(&format!("{WORK}; {AHEAD}"));
    let ended = cpu(&format!("sh -c '{WORK}'; {AHEAD}"));
    assert_eq!([idle, own, ended].map(|cpu| cpu.source), [CpuSource::Process; 3]);
    // A tick of the system is all that a child's time is rounded by.
    let tick = Duration::from_millis(10);
    assert!(own.time > 2 * idle.time && own.time > tick, "{idle:?} {own:?}");
    assert!(ended.time + 2 * tick > own.time / 3, "{own:?} {ended:?}");
    assert!(ended.time > tick, "{ended:?}");
}

#[test]
fn thinking_between_queries_counts_for_the_next() {
    let stage = Stage::new(&script(&format!("{AHEAD}; {WORK}")), "");
    let mut planner = stage.planner().expect("it starts");
    let times: Vec<Duration> = (0..3).map(|_| ask(planner.as_mut()).cpu.expect("it is known").time).collect();
    assert!(times[1] > times[0] && times[2] > times[0], "{times:?}");
}

#[test]
fn what_it_says_counts_if_it_is_more() {
    let says = |cpu_s: &str| {
        format!("echo \"{{\\\"type\\\":\\\"path\\\",\\\"id\\\":$id,\\\"segments\\\":[[0,10]],\\\"cpu_s\\\":{cpu_s}}}\"")
    };
    assert_eq!(cpu(&says("1000.5")), QueryCpu { time: Duration::from_millis(1_000_500), source: CpuSource::Reported });
    assert_eq!(cpu(&says("0")).source, CpuSource::Process);
}

#[test]
fn building_counts_up_to_ready() {
    let stage = Stage::new(&format!("{WORK}\n{}", script(AHEAD)), "");
    let planner = stage.planner().expect("it starts");
    assert!(planner.build_report().connecting > Duration::from_millis(10), "{:?}", planner.build_report());
}
