//! A planner is the same planner inside this program and as a program of its own.

use wildfire::geometry::Pose;
use wildfire::planning::{Effort, Goal, MakeError, Plan, PlannerContext, Planners, TruckPlanner};
use wildfire::programs::{ProgramPool, Trust, supervisor};
use wildfire::scenario::load;
use wildfire::sim;
use wildfire::vehicle::ReedsShepp;

use crate::shell::{Shell, has};

/// Drives by the shortest curve to where the body's centre is seven metres west of the goal's. Often that is not free: then
/// the gate refuses it.
struct FromTheWest {
    to_centre_m: f64,
    curves: ReedsShepp,
}

impl TruckPlanner for FromTheWest {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let Goal::Disc(disc) = goal else { unreachable!("goals of a contest are discs") };
        let end = Pose::new(disc.centre.x - 7.0 - self.to_centre_m, disc.centre.y, 0.0);
        let path = self.curves.shortest(start, end).path(start);
        Plan { effort: Effort { local_expansions: 3, ..Effort::default() }, ..Plan::from(Ok(path)) }
    }
}

const SAME_IN_PYTHON: &str = r#"
import json, sys
for line in sys.stdin:
    message = json.loads(line)
    if message["type"] == "hello":
        answer = {"type": "hello", "protocol": 1}
    elif message["type"] == "field":
        to_centre = 0.5 * message["vehicle"]["length"] - message["vehicle"]["rear_overhang"]
        answer = {"type": "ready"}
    elif message["type"] == "plan":
        x, y, radius = message["goal"]["disc"]
        answer = {"type": "path", "id": message["id"], "poses": [[x - 7.0 - to_centre, y, 0]], "expansions": 3}
    else:
        break
    print(json.dumps(answer), flush=True)
"#;

#[test]
fn planner_in_rust_and_as_a_program_give_the_same_runs() {
    if !has("python3", &["--version"]) {
        return;
    }
    supervisor::set_command(vec![env!("CARGO_BIN_EXE_wildfire").into()]);
    let shell = Shell::new();
    shell.file("west.py", SAME_IN_PYTHON);
    let change = |command: &str| ["duration_s=600", "unimog.planner=west", command].map(str::to_owned);
    let inside = load("smoke", &change("planner.west.command=[]")).expect("it is a scenario");
    let script = shell.path("west.py");
    let command = format!("planner.west.command=[\"python3\", \"{}\"]", script.display());
    let outside = load("smoke", &change(&command)).expect("it is a scenario");
    let make = |site: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> {
        let curves = ReedsShepp { radius_m: site.body.turning_radius_m };
        Ok(Box::new(FromTheWest { to_centre_m: site.body.centre_offset_m(), curves }))
    };
    let planners = Planners::default().with("west", make).expect("its name is free");
    let pool = ProgramPool::new(Trust::All);
    let mut drives = 0;
    for seed in 1..=20 {
        let registered = sim::run_with(&inside, seed, &planners).expect("it takes place");
        let programs = pool.planners_of(&outside, Planners::default()).expect("its name is free");
        let other = sim::run_with(&outside, seed, &programs).expect("it takes place");
        assert_eq!(registered.timeline, other.timeline, "seed {seed}");
        assert_eq!(registered.messages, other.messages, "seed {seed}");
        drives += wildfire::Outcome::new(&registered.timeline).extinguished;
    }
    assert!(drives > 0, "it drives somewhere");
}
