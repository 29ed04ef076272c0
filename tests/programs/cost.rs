//! What programs cost is known: their own time, that of their children, and what they say themselves.

use std::time::Duration;

use wildfire::planning::{CpuSource, QueryCpu};

use crate::shell::Shell;
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
    let busy = cpu(&format!("{WORK}; {AHEAD}"));
    let ended = cpu(&format!("sh -c '{WORK}'; {AHEAD}"));
    assert_eq!([idle, busy, ended].map(|cpu| cpu.source), [CpuSource::Process; 3]);
    // A tick of the system is all that a child's time is rounded by.
    let tick = Duration::from_millis(10);
    assert!(busy.time > 2 * idle.time && busy.time > tick, "{idle:?} {busy:?}");
    assert!(ended.time + 2 * tick > busy.time / 3, "{busy:?} {ended:?}");
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
    assert_eq!(
        cpu(&says("1000.5")),
        QueryCpu { time: Duration::from_millis(1_000_500), starting: Duration::ZERO, source: CpuSource::Reported }
    );
    assert_eq!(cpu(&says("0")).source, CpuSource::Process);
}

#[test]
fn building_counts_up_to_ready() {
    let stage = Stage::new(&format!("{WORK}\n{}", script(AHEAD)), "");
    let planner = stage.planner().expect("it starts");
    let report = planner.build_report();
    assert!(report.starting >= report.elsewhere && report.elsewhere > Duration::from_millis(10), "{report:?}");
}

#[test]
fn parts_of_a_run_add_up_to_the_whole_and_have_names_of_their_own() {
    let shell = Shell::new();
    shell.file("own.sh", &format!("{WORK}\n{}", script(AHEAD)));
    let goal = "{\\\"type\\\":\\\"answer\\\",\\\"id\\\":$id,\\\"choices\\\":[]}";
    shell.file("goal.sh", &format!("{WORK}\n{}", script(&format!("echo \"{goal}\""))));
    let planner = ["run", "smoke", "--command", "own=sh own.sh", "--set", "unimog.planner=own"];
    let policy = ["run", "smoke", "--command", "own=sh goal.sh", "--set", "unimog.goal=own"];
    for (arguments, of_roadmaps) in [(planner, 0.0), (policy, f64::INFINITY)] {
        let json = shell.run(&[&arguments[..], &["--json"]].concat(), &[0]).stdout;
        let value: serde_json::Value = serde_json::from_slice(&json).expect("it is JSON");
        let seconds = |name: &str| value["measured"][name].as_f64().expect("it is a number");
        let custom = seconds("cpu_custom_start_s") + seconds("cpu_custom_queries_s");
        let (policy, planners) = (seconds("cpu_policy_s"), seconds("cpu_unimog_total_s") + seconds("cpu_wumpus_s"));
        assert!(custom + policy > 0.02 && (custom == 0.0 || policy == 0.0), "{value}");
        assert!(policy + planners + seconds("cpu_terrain_s") <= seconds("cpu_run_s"), "{value}");
        let roadmaps = ["cpu_sampling_s", "cpu_map_generation_s", "cpu_roadmap_search_s"].map(seconds);
        assert!(roadmaps.iter().sum::<f64>() <= of_roadmaps && (custom == 0.0 || seconds("cpu_local_search_s") == 0.0));
    }
    let text = shell.run(&planner, &[0]).stdout;
    let text = String::from_utf8_lossy(&text);
    let shares =
        text.lines().skip_while(|line| !line.starts_with("Phase")).skip(2).take_while(|line| !line.starts_with('-'));
    let shares: Vec<f64> = shares.filter_map(|line| line.split(' ').next_back()?.parse().ok()).collect();
    assert!((shares.iter().sum::<f64>() - 100.0).abs() < 0.5, "{text}");
    assert!(text.contains("custom planner: start") && !text.contains("PRM map generation"), "{text}");
}
