//! Warnings: values of a scenario that are allowed and yet probably not meant.

use std::iter;
use std::sync::Arc;

use super::explain::SHOWN_SEED;
use super::{
    Escape, IgnitionCells, RoadmapGoal, SafetyMap, Scenario, SpreadFrom, Terrain, Unimog, Wumpus, WumpusPlanner,
    WumpusPotential,
};
use crate::collision::{ClearanceField, CollisionChecker};
use crate::geometry::DVec2;
use crate::planning::memory::MemoryMeter;
use crate::planning::registry::RoadmapSize;
use crate::planning::walk::WalkLattice;
use crate::planning::{BuildReport, is_hardly_connected};

/// Sideways acceleration that a laden truck can take on loose ground, m/s2; about 0.4 g.
const LATERAL_GRIP_MPS2: f64 = 4.0;

/// The most points of all lattices on which [`warn_of_idle_wumpuses`] looks for what can be lit: a tenth of a second.
const MAX_POINTS_LOOKED_AT: f64 = 1e6;

/// The most pairs of a bush and a place near it that the search for the nearest place looks at.
const MAX_LOOKS: f64 = 1e7;

/// The most milestones times neighbours, over all roadmaps, that [`warn_of_roadmaps`] builds: a tenth of a second.
const MAX_EDGES_TRIED: f64 = 2e5;

/// Collects the warnings about a scenario, and about its field of [`SHOWN_SEED`] if there is one.
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
        let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
        warn_of_blocked_starts(scenario, terrain, &field, &mut found);
        warn_of_idle_wumpuses(scenario, terrain, &mut found);
        warn_of_roadmaps(scenario, terrain, &field, &mut found);
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

/// Warns of settings of planners that the Wumpus does not use.
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
    let (planner, settings) = (unimog.planner.maker(), unimog.planner_settings());
    for table in settings.tables().filter(|table| !table.is_default && !planner.tables().contains(&table.name)) {
        found.push(format!("The `{}` of truck {number} does nothing: its planner does not use it.", table.name));
    }
    found.extend(planner.warning(&settings, &unimog.vehicle, &format!("truck {number}")));
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

fn warn_of_blocked_starts(
    scenario: &Scenario,
    terrain: &Terrain,
    field: &Arc<ClearanceField>,
    found: &mut Vec<String>,
) {
    let mut blocked = Vec::new();
    for (number, unimog) in scenario.unimog.iter().enumerate() {
        let checker = CollisionChecker::new(Arc::clone(field), unimog.vehicle);
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

/// Warns of Wumpuses that can come nowhere within reach of a bush's centre.
fn warn_of_idle_wumpuses(scenario: &Scenario, terrain: &Terrain, found: &mut Vec<String>) {
    let mut points = 0.0;
    for (number, wumpus) in scenario.wumpus.iter().enumerate() {
        let shape = wumpus.lattice_shape(&terrain.frame);
        points += WalkLattice::point_count(&terrain.frame, &shape);
        if points > MAX_POINTS_LOOKED_AT {
            return;
        }
        let lattice = WalkLattice::new(terrain.frame, &terrain.occupied, shape);
        let Some(start) = lattice.nearest_free(wumpus.start_centre()) else { continue };
        let reached = lattice.reachable_from(start);
        let bushes = &terrain.bushes;
        let stands = |cell, reach_m| lattice.points_of_reach(cell, reach_m).filter(|&point| reached[point]);
        if bushes.is_empty() || bushes.iter().any(|&cell| stands(cell, wumpus.reach_m).next().is_some()) {
            continue;
        }
        let nearest = |within_m: f64| {
            let metres = |cell| {
                let centre = lattice.centre(cell);
                stands(cell, within_m).map(|point| lattice.position(point).distance(centre)).reduce(f64::min)
            };
            bushes.iter().filter_map(|&cell| metres(cell)).reduce(f64::min)
        };
        // Farther and farther away, as long as that is quick: most often the nearest place is a cell or two away.
        let is_quick = |within_m: &f64| {
            let across = 2.0 * within_m / lattice.step_m() + 1.0;
            bushes.len() as f64 * across * across <= MAX_LOOKS
        };
        let farther = iter::successors(Some(terrain.frame.cell_m), |metres| Some(2.0 * metres));
        let least_m = farther.take_while(is_quick).find_map(nearest);
        found.push(format!(
            "On the field of seed {SHOWN_SEED} Wumpus {number} can light none of the {} bushes: no bush's centre is within \
             `reach_m`, {} m, of a place to which its own can walk{}.",
            bushes.len(),
            wumpus.reach_m,
            least_m.map_or(String::new(), |least_m| format!("; the nearest is {least_m:.3} m away"))
        ));
    }
}

/// Warns of roadmaps that lead almost nowhere, among those that are quickly built.
fn warn_of_roadmaps(scenario: &Scenario, terrain: &Terrain, field: &Arc<ClearanceField>, found: &mut Vec<String>) {
    let mut edges = 0.0;
    for (number, unimog) in scenario.unimog.iter().enumerate() {
        let size = unimog.planner.maker().roadmap_size(&unimog.planner_settings(), terrain.bushes.len());
        let Some(RoadmapSize { milestones, neighbours, max_edge_m }) = size else { continue };
        edges += milestones as f64 * f64::from(neighbours);
        if edges > MAX_EDGES_TRIED {
            return;
        }
        let checker = CollisionChecker::new(Arc::clone(field), unimog.vehicle);
        let planner = unimog.build_planner(&checker, &MemoryMeter::unlimited(), SHOWN_SEED, number);
        let BuildReport { samples, components, .. } = planner.build_report();
        if samples == 0 {
            found.push(format!("On the field of seed {SHOWN_SEED} the roadmap of truck {number} has no milestones."));
        } else if is_hardly_connected(samples, components) {
            let apart_m = (terrain.frame.width_m() * terrain.frame.height_m() / f64::from(samples)).sqrt();
            found.push(format!(
                "On the field of seed {SHOWN_SEED} the roadmap of truck {number} is hardly connected: {samples} milestones \
                 in {components} components. They are some {apart_m:.0} m apart, and no edge is longer than \
                 `max_edge_m`, {max_edge_m} m."
            ));
        }
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

    fn warned(source: &str, changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let scenario = load(source, &changes).expect("this scenario is right");
        let terrain = Terrain::from_scenario(&scenario, 1).ok();
        warnings(&scenario, terrain.as_ref()).join("\n")
    }

    #[test]
    fn what_is_probably_not_meant_is_reported() {
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
            (
                "report-2024",
                vec!["field.size_m=2500", "unimog.prm.samples=500"],
                "truck 0 is hardly connected: 500 milestones in 499 components. They are some 112 m apart",
            ),
            ("contest", vec!["unimog.prm_rs.samples=0", "unimog.prm_rs.corner_places=0"], "truck 0 has no milestones"),
            (
                "contest",
                vec!["wumpus.reach_m=4.9"],
                "Wumpus 0 can light none of the 248 bushes: no bush's centre is within `reach_m`, 4.9 m, of a place to \
                 which its own can walk; the nearest is 5.000 m away.",
            ),
            (
                "contest",
                vec!["wumpus.lattice_m=1", "wumpus.reach_m=2.4"],
                "`reach_m`, 2.4 m, of a place to which its own can walk; the nearest is 4.000 m away.",
            ),
            ("fleet", vec!["suppression.reach_m=none"], "Truck 2 extinguishes from where it stands and never drives"),
        ] {
            let found = warned(source, &changes);
            assert!(found.contains(words), "{source} {changes:?}: {found}");
        }
    }

    #[test]
    fn starts_in_a_bush_and_ignitions_beside_one_are_reported() {
        let mut scenario = load("smoke", &["ignition=[{ at_s = 1, cells = [[4, 0], [5, 0]] }]".into()]).unwrap();
        let south_edge = format!("{}\n{}", ".".repeat(20), "....#.".to_owned() + &"#".repeat(14));
        let given = GivenField::parse(&south_edge, 5.0).unwrap();
        scenario.field.given = Some(given);
        scenario.unimog[0].start = StartPose { x_m: 60.0, y_m: 4.0, heading_deg: 0.0 };
        scenario.wumpus[0].start_m = [18.5, 2.5];
        let of = |scenario: &Scenario| warnings(scenario, Terrain::from_scenario(scenario, 1).ok().as_ref()).join("\n");
        let found = of(&scenario);
        assert!(found.contains("moved to the nearest free place: truck 0."), "{found}");
        assert!(found.contains("1 of the cells that an ignition names are no bushes"), "{found}");
        scenario.wumpus[0].start_m = [18.6, 2.5];
        assert!(of(&scenario).contains("truck 0, Wumpus 0"));
    }

    #[test]
    fn a_scenario_without_oddities_has_no_warnings() {
        assert_eq!(warned("wumpus-alone", &[]), "");
        assert_eq!(warned("fleet", &[]), "");
        assert!(!warned("original-2024", &[]).contains("never drives"), "there trucks drive to the nearest milestone");
    }
}
