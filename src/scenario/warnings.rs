//! What is allowed and yet probably not meant.

use std::sync::Arc;

use super::{
    Escape, IgnitionCells, RoadmapGoal, SafetyMap, Scenario, SpreadFrom, Terrain, TruckPlannerKind, Unimog, Wumpus,
    WumpusPlanner, WumpusPotential,
};
use crate::collision::{ClearanceField, CollisionChecker};
use crate::geometry::DVec2;

/// Sideways acceleration that a laden truck can take on loose ground, m/s2; about 0.4 g.
const LATERAL_GRIP_MPS2: f64 = 4.0;

/// Sentences about a scenario, and about one of its fields.
pub fn warnings(scenario: &Scenario, terrain: Option<&Terrain>) -> Vec<String> {
    let mut found = Vec::new();
    warn_of_rules(scenario, &mut found);
    warn_of_ignitions(scenario, terrain, &mut found);
    for (number, wumpus) in scenario.wumpus.iter().enumerate() {
        warn_of_wumpus(number, wumpus, &mut found);
    }
    for (number, unimog) in scenario.unimog.iter().enumerate() {
        warn_of_truck(number, unimog, &mut found);
        if scenario.suppression.reach_m.is_none() && unimog.prm.goal == RoadmapGoal::InReach {
            found.push(format!(
                "Truck {number} extinguishes from where it stands and never drives: with `suppression.reach_m` \"none\" \
                 every fire is in reach; `prm.goal` \"nearest-milestone\" would make it drive."
            ));
        }
    }
    warn_of_shared_starts(&scenario.unimog, &mut found);
    if let Some(terrain) = terrain {
        warn_of_blocked_starts(scenario, terrain, &mut found);
    }
    found
}

fn warn_of_rules(scenario: &Scenario, found: &mut Vec<String>) {
    let fire = &scenario.fire;
    if scenario.wumpus.is_empty() && scenario.ignition.is_empty() {
        found.push("Nothing ever burns: there is no Wumpus and no [[ignition]].".into());
    }
    let spreads = fire.spread_from != SpreadFrom::None && fire.spread_radius_m > 0.0;
    if let Some(burn_out_s) = fire.burn_out_s.filter(|&burn_out_s| spreads && burn_out_s <= fire.spread_delay_s) {
        let delay_s = fire.spread_delay_s;
        found.push(format!(
            "No fire spreads: a bush burns out after {burn_out_s} s, before it would spread at {delay_s} s."
        ));
    }
    if spreads && fire.spread_radius_m < scenario.field.cell_m {
        found.push(format!("No fire spreads: no two cells are within {} m of each other.", fire.spread_radius_m));
    }
}

fn warn_of_ignitions(scenario: &Scenario, terrain: Option<&Terrain>, found: &mut Vec<String>) {
    let late = scenario.ignition.iter().filter(|ignition| ignition.at_s > scenario.duration_s).count();
    if late > 0 {
        found.push(format!("{late} of the ignitions come after the end of the run."));
    }
    let (Some(terrain), Some(_)) = (terrain, &scenario.field.given) else { return };
    let named = scenario.ignition.iter().filter_map(|ignition| match &ignition.cells {
        IgnitionCells::Cells(cells) => Some(cells),
        IgnitionCells::Random(_) => None,
    });
    let bare = named.flatten().filter(|cell| !terrain.occupied[(cell.row.into(), cell.col.into())]).count();
    if bare > 0 {
        found.push(format!("{bare} of the cells that an ignition names are no bushes of the map."));
    }
}

/// Settings of a planner that the Wumpus does not use.
fn warn_of_wumpus(number: usize, wumpus: &Wumpus, found: &mut Vec<String>) {
    let usual = Wumpus::default();
    let heuristic = (wumpus.heuristic, wumpus.heuristic_weight) != (usual.heuristic, usual.heuristic_weight);
    if heuristic && wumpus.planner != WumpusPlanner::Astar {
        found.push(format!(
            "The `heuristic` and `heuristic_weight` of Wumpus {number} do nothing: only the planner \"astar\" uses them."
        ));
    }
    let goes_by_cost = wumpus.planner != WumpusPlanner::Potential || wumpus.potential.escape == Escape::Wavefront;
    if wumpus.safety.map != SafetyMap::None && !goes_by_cost {
        found.push(format!(
            "The `safety` of Wumpus {number} does nothing: descent on a potential field goes by no cost but in its escape."
        ));
    }
    if wumpus.potential != WumpusPotential::default() && wumpus.planner != WumpusPlanner::Potential {
        found.push(format!("The `potential` of Wumpus {number} does nothing: only the planner \"potential\" uses it."));
    }
}

fn warn_of_truck(number: usize, unimog: &Unimog, found: &mut Vec<String>) {
    let (speed, radius_m) = (unimog.speed_mps.max(unimog.reverse_speed_mps), unimog.vehicle.turning_radius_m);
    let lateral = speed * speed / radius_m;
    if unimog.limits.lateral_mps2.is_none() && lateral > LATERAL_GRIP_MPS2 {
        found.push(format!(
            "Truck {number} drives {speed} m/s on its circle of {radius_m} m: {lateral:.1} m/s2 to the side, more than \
             the {LATERAL_GRIP_MPS2} m/s2 that loose ground holds; `limits.lateral_mps2` would slow it in curves."
        ));
    }
    let uses_roadmap = unimog.planner == TruckPlannerKind::PrmPrimitives;
    warn_of_unused_planners(number, unimog, found);
    if uses_roadmap && unimog.prm.clearance_m < 0.5 * unimog.vehicle.width_m {
        found.push(format!(
            "The roadmap of truck {number} keeps {} m clear, less than half the truck's width: it may lead where the \
             truck cannot go.",
            unimog.prm.clearance_m
        ));
    }
}

/// Settings of planners that the truck does not use.
fn warn_of_unused_planners(number: usize, unimog: &Unimog, found: &mut Vec<String>) {
    let usual = Unimog::default();
    let by_planner = [
        ("prm", [TruckPlannerKind::PrmPrimitives].as_slice(), unimog.prm != usual.prm),
        ("primitives", &[TruckPlannerKind::PrmPrimitives], unimog.primitives != usual.primitives),
        ("safety", &[TruckPlannerKind::PrmPrimitives], unimog.safety != usual.safety),
        ("prm_rs", &[TruckPlannerKind::PrmRs], unimog.prm_rs != usual.prm_rs),
        ("lattice", &[TruckPlannerKind::Lattice], unimog.lattice != usual.lattice),
        ("hybrid", &[TruckPlannerKind::HybridAstar, TruckPlannerKind::PrmRs], unimog.hybrid != usual.hybrid),
    ];
    for (table, planners, is_set) in by_planner {
        if is_set && !planners.contains(&unimog.planner) {
            found.push(format!("The `{table}` of truck {number} does nothing: its planner does not use it."));
        }
    }
}

fn warn_of_shared_starts(trucks: &[Unimog], found: &mut Vec<String>) {
    for (second, truck) in trucks.iter().enumerate() {
        for (first, other) in trucks[..second].iter().enumerate() {
            if (truck.start_centre() - other.start_centre()).length() < truck.vehicle.length_m {
                found.push(format!("Trucks {first} and {second} start on top of each other."));
            }
        }
    }
}

fn warn_of_blocked_starts(scenario: &Scenario, terrain: &Terrain, found: &mut Vec<String>) {
    let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
    let mut blocked = Vec::new();
    for (number, unimog) in scenario.unimog.iter().enumerate() {
        let checker = CollisionChecker::new(Arc::clone(&field), unimog.vehicle);
        if !checker.pose_is_free(unimog.start.pose(), 0.0) {
            blocked.push(format!("truck {number}"));
        }
    }
    for (number, wumpus) in scenario.wumpus.iter().enumerate() {
        if !square_is_free(terrain, wumpus.start_centre(), wumpus.size_m) {
            blocked.push(format!("Wumpus {number}"));
        }
    }
    if !blocked.is_empty() {
        found.push(format!("Starts in a bush, moved to the nearest free place: {}.", blocked.join(", ")));
    }
}

fn square_is_free(terrain: &Terrain, centre: DVec2, size_m: f64) -> bool {
    let touching = 0.5 * (size_m + terrain.frame.cell_m);
    terrain.bushes.iter().all(|&bush| (terrain.frame.centre(bush) - centre).abs().max_element() >= touching)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{GivenField, StartPose, load};

    fn of(source: &str, changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let scenario = load(source, &changes).expect("this scenario is right");
        let terrain = Terrain::of(&scenario, 1).ok();
        warnings(&scenario, terrain.as_ref()).join("\n")
    }

    #[test]
    fn what_is_probably_not_meant_is_said() {
        for (source, changes, words) in [
            ("contest", vec![], "8 m/s on its circle of 13 m: 4.9 m/s2 to the side"),
            ("contest", vec!["fire.burn_out_s=10"], "burns out after 10 s, before it would spread at 10 s"),
            ("contest", vec!["fire.spread_radius_m=4.9"], "no two cells are within 4.9 m"),
            ("contest", vec!["wumpus=[]"], "Nothing ever burns"),
            ("unimog-alone", vec!["duration_s=3400"], "1 of the ignitions come after"),
            ("fleet", vec!["unimog.start.x_m=100", "unimog.start.y_m=100"], "Trucks 0 and 1 start on top"),
            ("report-2024", vec!["unimog.prm.clearance_m=1"], "keeps 1 m clear"),
            (
                "contest",
                vec!["wumpus.planner=wavefront", "wumpus.heuristic_weight=2"],
                "The `heuristic` and `heuristic_weight` of Wumpus 0 do nothing",
            ),
            ("report-2024", vec!["unimog.hybrid.step_m=2"], "The `hybrid` of truck 0 does nothing"),
            (
                "contest",
                vec!["unimog.planner=hybrid-astar", "unimog.safety.map=cost"],
                "The `safety` of truck 0 does nothing",
            ),
            ("local-minima", vec!["wumpus.safety.map=cost"], "The `safety` of Wumpus 0 does nothing"),
            ("fleet", vec!["wumpus.1.potential.q=3"], "The `potential` of Wumpus 1 does nothing"),
            ("fleet", vec!["suppression.reach_m=none"], "Truck 2 extinguishes from where it stands and never drives"),
        ] {
            let found = of(source, &changes);
            assert!(found.contains(words), "{source} {changes:?}: {found}");
        }
    }

    #[test]
    fn starts_in_a_bush_and_ignitions_beside_one_are_told() {
        let mut scenario = load("smoke", &["ignition=[{ at_s = 1, cells = [[4, 0], [5, 0]] }]".into()]).unwrap();
        let south_edge = format!("{}\n{}", ".".repeat(20), "....#.".to_owned() + &"#".repeat(14));
        let given = GivenField::parse(&south_edge, 5.0).unwrap();
        scenario.field.given = Some(given);
        scenario.unimog[0].start = StartPose { x_m: 60.0, y_m: 4.0, heading_deg: 0.0 };
        scenario.wumpus[0].start_m = [18.5, 2.5];
        let of = |scenario: &Scenario| warnings(scenario, Terrain::of(scenario, 1).ok().as_ref()).join("\n");
        let found = of(&scenario);
        assert!(found.contains("moved to the nearest free place: truck 0."), "{found}");
        assert!(found.contains("1 of the cells that an ignition names are no bushes"), "{found}");
        scenario.wumpus[0].start_m = [18.6, 2.5];
        assert!(of(&scenario).contains("truck 0, Wumpus 0"));
    }

    #[test]
    fn a_scenario_without_oddities_has_no_warnings() {
        assert_eq!(of("wumpus-alone", &[]), "");
        assert_eq!(of("fleet", &[]), "");
        assert!(!of("original-2024", &[]).contains("never drives"), "there trucks drive to the nearest milestone");
    }
}
