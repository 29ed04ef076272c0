//! Learned policies: rules that small networks correct.

use wildfire::scenario::{self, Learned, Scenario};
use wildfire::sim;
use wildfire::timeline::Outcome;

fn scenario(changes: &[&str]) -> Scenario {
    let usual = ["field.size_m=500", "duration_s=900", "unimog.planner=hybrid-astar", "unimog.count=2"];
    let changes: Vec<String> = usual.iter().chain(changes).map(|&change| change.to_owned()).collect();
    scenario::load("contest-1", &changes).expect("it loads")
}

fn burned(scenario: &Scenario, seeds: std::ops::Range<u64>) -> u32 {
    let burned = |seed| Outcome::new(&sim::run(scenario, seed).expect("it takes place").timeline).burned();
    seeds.map(burned).sum()
}

#[test]
fn networks_of_zeros_change_nothing() {
    let zeros = |inputs: usize| vec![0.0; scenario::HIDDEN * (inputs + 2) + 1];
    let learned = Learned { posts: zeros(Learned::STAGING_INPUTS.len()), lights: zeros(Learned::LIGHT_INPUTS.len()) };
    let rules = scenario(&["dispatch.policy=auction", "dispatch.idle=centroids", "duration_s=300"]);
    let rules = Scenario { learned: Some(learned.clone()), ..rules };
    let events = |scenario: &Scenario| sim::run(scenario, 3).expect("it takes place").timeline.events;
    for goals in [["random-intact", "random-intact"], ["densest-apart", "learned"]] {
        let with = |dispatch: [&str; 2], goal: &str| {
            let goal = format!("wumpus.goal={goal}");
            let [policy, idle] = dispatch;
            let dispatch = [format!("dispatch.policy={policy}"), format!("dispatch.idle={idle}")];
            let other = scenario(&[&dispatch[0], &dispatch[1], &goal, "duration_s=300"]);
            Scenario { learned: Some(learned.clone()), ..other }
        };
        let by_rules = events(&with(["auction", "centroids"], goals[0]));
        assert!(events(&with(["auction", "learned"], goals[1])) == by_rules, "{goals:?}");
    }
    assert!(rules.check().is_ok());
}

#[test]
fn trucks_that_learned_where_to_wait_lose_less() {
    let with = |idle: &str| burned(&scenario(&["dispatch.policy=auction", &format!("dispatch.idle={idle}")]), 501..513);
    let (centroids, learned) = (with("centroids"), with("learned"));
    assert!(learned < centroids, "{learned} by learned posts, {centroids} by centroids");
}

#[test]
fn an_arsonist_that_learned_burns_more() {
    let with = |goal: &str| {
        let goal = format!("wumpus.goal={goal}");
        burned(&scenario(&["dispatch.policy=auction", "dispatch.idle=centroids", &goal]), 501..507)
    };
    let (densest, learned) = (with("densest-apart"), with("learned"));
    assert!(learned > densest, "{learned} by the learned arsonist, {densest} by the densest cells");
}

#[test]
fn weights_of_another_number_or_size_are_refused_where_they_stand() {
    for (change, fragment) in [
        ("learned.posts=[1, 2]", "`learned.posts` is a list of 2; expected 41 weights"),
        ("learned.lights=[1e9]", "`learned.lights` is a list of 1; expected 73 weights"),
    ] {
        let error = scenario::load("contest-1", &[change.to_owned()]).expect_err("it is refused").to_string();
        assert!(error.contains(fragment), "{error}");
    }
    let many = format!("learned.posts=[{}]", ["1e9"; 41].join(", "));
    let error = scenario::load("contest-1", &[many]).expect_err("it is refused").to_string();
    assert!(error.contains("expected weights from -1e6 to 1e6"), "{error}");
}
