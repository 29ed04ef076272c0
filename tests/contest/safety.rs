//! Safety costs do what they are for: the more nearness to bushes costs, the farther agents keep from them, on
//! longer ways.

use wildfire::collision::ClearanceField;
use wildfire::planning::kit::safety::{SafetyMap, SafetySettings};
use wildfire::scenario::{self, Scenario, Terrain};
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{AgentFact, Body, Fact};

/// Places on the way are this many seconds apart.
const SAMPLE_S: f64 = 0.25;

fn loaded(name: &str, changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    scenario::load(name, &changes).expect("the built-in loads")
}

fn priced(map: SafetyMap, weight: f64) -> SafetySettings {
    SafetySettings { map, weight, ..SafetySettings::default() }
}

/// Mean clearance of the body's centre along all legs of all agents, by time, and the metres of a leg.
fn mean_clearance(scenario: &Scenario, seeds: std::ops::RangeInclusive<u64>) -> (f64, f64) {
    let (mut sum_m, mut samples, mut length_m, mut legs) = (0.0, 0.0, 0.0, 0.0);
    for seed in seeds {
        let terrain = Terrain::from_scenario(scenario, seed).expect("the field has room");
        let field = ClearanceField::new(terrain.frame, &terrain.occupied);
        let timeline = sim::run(scenario, seed).expect("the scenario can be run").timeline;
        for event in &timeline.events {
            let Fact::Agent(agent, AgentFact::Planned { trajectory, .. }) = &event.fact else { continue };
            let body = timeline.setting.agents.iter().find(|start| start.id == *agent).expect("agents are listed").body;
            length_m += trajectory.distance_m(SimTime::MAX);
            legs += 1.0;
            for k in 0..(trajectory.duration_s() / SAMPLE_S) as u32 {
                let time = trajectory.start_time() + SimTime::from_seconds(SAMPLE_S * f64::from(k));
                let pose = trajectory.pose_at(time);
                let centre = match body {
                    Body::Square { .. } => pose.position(),
                    Body::Truck(body) => body.body_centre(pose),
                };
                sum_m += field.distance(centre);
                samples += 1.0;
            }
        }
    }
    (sum_m / samples, length_m / legs)
}

/// Asserts that clearance and way grow from weight to weight.
#[expect(clippy::print_stdout, reason = "the figures, for those who ask")]
fn assert_pays(name: &str, map: SafetyMap, with: impl Fn(SafetySettings) -> Scenario) {
    let measured = [0.0, 1.0, 4.0].map(|weight| mean_clearance(&with(priced(map, weight)), 1..=3));
    println!("{name}, {map:?}, weights 0, 1, 4: mean clearance and metres a leg {measured:.2?}");
    assert!(measured.is_sorted_by(|a, b| a.0 * 1.02 < b.0), "{name}, {map:?}: clearances {measured:?}");
    assert!(measured[2].1 > measured[0].1, "{name}, {map:?}: {measured:?}");
    assert!(measured[2].1 < 1.35 * measured[0].1, "{name}, {map:?}: the way pays too much: {measured:?}");
}

#[test]
fn trucks_keep_farther_from_bushes_the_more_that_costs() {
    for map in [SafetyMap::Brushfire, SafetyMap::Cost] {
        assert_pays("truck", map, |safety| {
            let mut scenario = loaded("unimog-alone", &["unimog.planner=prm+primitives"]);
            scenario.unimog[0].safety = safety;
            scenario
        });
    }
}

#[test]
fn wumpuses_keep_farther_from_bushes_the_more_that_costs() {
    for map in [SafetyMap::Brushfire, SafetyMap::Cost] {
        for planner in ["wumpus.planner=astar", "wumpus.planner=wavefront"] {
            assert_pays("Wumpus", map, |safety| {
                let mut scenario = loaded("wumpus-alone", &["fire.spread_from=none", planner]);
                scenario.wumpus[0].safety = safety;
                scenario
            });
        }
    }
}
