//! Warnings: values of a scenario that are allowed and yet probably not meant.

use std::sync::Arc;

use super::ground_report::warn_of_ground;
use crate::keys::agents::{BlockedStarts, SHOWN_SEED, ScenarioField};
use crate::keys::dispatch::warn_of_team;
use crate::{FireModelName, IgnitionCells, Scenario, Terrain};
use wildfire_base::geometry::Cell;
use wildfire_planning::collision::ClearanceField;

/// Collects the warnings about a scenario, and about the field of the seed that is shown if it has one.
pub fn warnings(scenario: &Scenario, terrain: Option<&Terrain>) -> Vec<String> {
    let mut found = doubts_of_files(scenario);
    warn_of_rules(scenario, &mut found);
    warn_of_team(scenario, &mut found);
    warn_of_ignitions(scenario, terrain, &mut found);
    for agents in scenario.kinds() {
        agents.warn(scenario, &mut found);
    }
    let of_water = |field: Option<&ScenarioField<'_>>, found: &mut Vec<String>| {
        scenario.water.iter().for_each(|water| water.warn(scenario, field, found));
    };
    // Without a field of the seed that is shown, only what the file itself says can be doubted.
    if let Some(terrain) = terrain {
        warn_of_ground(scenario, terrain, &mut found);
        let clearance = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
        let field = ScenarioField { terrain, clearance };
        // A start that every run has to move is no error, but hardly what the author meant.
        let starts = blocked_starts(scenario, &field);
        if !starts.moved.is_empty() {
            found.push(format!("Starts in a bush, moved to the nearest free place: {}.", starts.moved.join(", ")));
        }
        found.extend(grave_warnings(&field, starts.without_place));
        for agents in scenario.kinds() {
            agents.warn_of_field(&field, &mut found);
        }
        of_water(Some(&field), &mut found);
    } else {
        of_water(None, &mut found);
    }
    found
}

/// Returns what of the files of a scenario may have been misread or was left out, and which of its ignitions light nothing
/// whatever the seed.
pub fn doubts_of_files(scenario: &Scenario) -> Vec<String> {
    let of_map = scenario.field.imported.iter().flat_map(|imported| &imported.doubts);
    let of_layers = scenario.layers().into_iter().flat_map(|layers| &layers.doubts);
    let mut found: Vec<String> = of_map.chain(of_layers).cloned().collect();
    if has_fixed_ground(scenario) && !scenario.ignition.is_empty() {
        // A field that cannot be made is told of by the run.
        if let Ok(terrain) = Terrain::from_scenario(scenario, SHOWN_SEED) {
            warn_of_cells(scenario, &terrain, &mut found);
        }
    }
    found
}

/// Collects the warnings about a scenario with a map without which nobody should begin: that nothing can burn, and that an
/// agent has no place.
pub fn warnings_of_map(scenario: &Scenario) -> Vec<String> {
    let Ok(terrain) = Terrain::from_scenario(scenario, SHOWN_SEED) else { return Vec::new() };
    let clearance = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
    let field = ScenarioField { terrain: &terrain, clearance };
    grave_warnings(&field, blocked_starts(scenario, &field).without_place)
}

fn grave_warnings(field: &ScenarioField<'_>, without_place: Option<String>) -> Vec<String> {
    let is_bare = field.terrain.bushes.is_empty() && field.terrain.landscape.is_none();
    let bare = is_bare.then(|| "Nothing can burn: the field has no bushes.".to_owned());
    let without_place = without_place.map(|agent| {
        format!("{agent} cannot start: no free place was found for it on this field, so no run can start.")
    });
    bare.into_iter().chain(without_place).collect()
}

/// The agents of all kinds that cannot start where they should, trucks first.
fn blocked_starts(scenario: &Scenario, field: &ScenarioField<'_>) -> BlockedStarts {
    let mut all = BlockedStarts::default();
    for agents in scenario.kinds().iter().rev() {
        let BlockedStarts { moved, without_place } = agents.blocked_starts(field);
        all.moved.extend(moved);
        // Wumpuses are the first that a run puts on the field.
        all.without_place = without_place.or(all.without_place);
    }
    all
}

fn warn_of_rules(scenario: &Scenario, found: &mut Vec<String>) {
    if scenario.wumpus.is_empty() && scenario.ignition.is_empty() {
        found.push("Nothing ever burns: there is no Wumpus and no [[ignition]].".into());
    }
    scenario.fire.warn(&scenario.field.frame(), found);
    if scenario.fire.model == FireModelName::Radius {
        let tables = [("landscape", scenario.landscape.is_some()), ("weather", scenario.weather.is_some())];
        for (table, _) in tables.iter().filter(|(_, is_present)| *is_present) {
            found.push(format!("The table `{table}` has no effect: the fire model `radius` burns only bushes."));
        }
        if !scenario.wind.is_empty() {
            found.push("The wind has no effect: the fire model `radius` ignores it.".into());
        }
    }
}

fn warn_of_ignitions(scenario: &Scenario, terrain: Option<&Terrain>, found: &mut Vec<String>) {
    let late = scenario.ignition.iter().filter(|ignition| ignition.at_s > scenario.duration_s).count();
    if late > 0 {
        found.push(format!("Ignitions after the end of the run: {late}."));
    }
    if let Some(terrain) = terrain.filter(|_| !has_fixed_ground(scenario)) {
        warn_of_cells(scenario, terrain, found);
    }
}

/// Returns whether what covers the field is the same for every seed.
fn has_fixed_ground(scenario: &Scenario) -> bool {
    let field = &scenario.field;
    let has_pieces = field.imported.is_none() && field.pieces.map_or(field.coverage > 0.0, |pieces| pieces > 0);
    !has_pieces
        && !scenario
            .landscape
            .as_ref()
            .is_some_and(|it| it.seed.is_none() && !(it.patches.is_empty() && it.river.is_none()))
}

/// Adds a warning for ignitions of which nothing can burn on a field.
fn warn_of_cells(scenario: &Scenario, terrain: &Terrain, found: &mut Vec<String>) {
    // Bushes of a generated field that alone burn are elsewhere in every run.
    if terrain.landscape.is_none() && scenario.field.imported.is_none() {
        return;
    }
    let mut burns = vec![false; terrain.frame.cell_count()];
    // Under the model `radius` bushes burn without fuel, so both lists are needed.
    terrain.with_fuel().chain(terrain.bushes.iter().copied()).for_each(|cell| burns[terrain.frame.index(cell)] = true);
    let named = scenario.ignition.iter().filter_map(|ignition| match &ignition.cells {
        IgnitionCells::Cells(cells) => Some(cells),
        _ => None,
    });
    let bare: Vec<&Cell> = named.flatten().filter(|&&cell| !burns[terrain.frame.index(cell)]).collect();
    match (&terrain.landscape, bare.first()) {
        (_, None) => {}
        (None, Some(_)) => found.push(format!("Cells of ignitions that are not bushes of the map: {}.", bare.len())),
        (Some(landscape), Some(&&cell)) => {
            let holds = match landscape.fuel_model(landscape.fuel_number(cell)) {
                Some(model) => format!("{}, {}", model.code, model.name),
                None => "nothing".to_owned(),
            };
            let (count, Cell { col, row }) = (bare.len(), cell);
            found.push(format!("Cells of ignitions that cannot burn: {count}, the first [{col}, {row}] with {holds}."));
        }
    }
    for ignition in &scenario.ignition {
        let is_void = match &ignition.cells {
            IgnitionCells::Cells(_) | IgnitionCells::Points(_) => false,
            IgnitionCells::Area(area) => {
                let mut inside = area.by_cell(&terrain.frame).into_iter().zip(&burns);
                !inside.any(|(is_inside, &burns)| is_inside && burns)
            }
            IgnitionCells::Random(_) => {
                // Where there are no bushes at all, random ignitions light the ground.
                let has_ground = scenario.fire.lights_ground() || terrain.bushes.is_empty();
                terrain.lightable(has_ground).is_empty()
            }
            IgnitionCells::Density(density) => {
                let weights = density.weights.as_ref().and_then(|weights| weights.by_cell(&terrain.frame));
                let mut weighted = weights.iter().flatten().zip(&burns);
                weights.is_some() && !weighted.any(|(&weight, &burns)| weight > 0.0 && burns)
            }
        };
        if is_void {
            found.push(format!("The ignition at {} s lights nothing: none of its cells can burn.", ignition.at_s));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::agents::SHOWN_ALIKE;
    use crate::{ImportedField, ImportedLayers, StartPose, load};

    fn warned(source: &str, changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let scenario = load(source, &changes).expect("this scenario is right");
        let terrain = Terrain::from_scenario(&scenario, 1).ok();
        warnings(&scenario, terrain.as_ref()).join("\n")
    }

    #[test]
    fn what_is_probably_not_meant_is_reported() {
        for (source, changes, expected) in [
            ("contest", vec![], "8 m/s on its circle of 13 m: 4.9 m/s2 to the side"),
            ("contest", vec!["fire.burn_out_s=10"], "burns out after 10 s, before it would spread at 10 s"),
            ("contest", vec!["fire.spread_radius_m=4.9"], "no two cells are within 4.9 m"),
            ("contest", vec!["wumpus=[]"], "Nothing ever burns"),
            ("unimog-alone", vec!["duration_s=3400"], "Ignitions after the end of the run: 1."),
            ("fleet", vec!["unimog.start.x_m=100", "unimog.start.y_m=100"], "Trucks 0 and 1 start on top"),
            ("report-2024", vec!["unimog.prm.clearance_m=1"], "has a clearance of 1 m"),
            (
                "contest",
                vec!["wumpus.planner=wavefront", "wumpus.heuristic_weight=2"],
                "The `heuristic` and `heuristic_weight` of Wumpus 0 have no effect",
            ),
            ("report-2024", vec!["unimog.hybrid.step_m=2"], "The `hybrid` of truck 0 has no effect"),
            (
                "contest",
                vec!["unimog.planner=hybrid-astar", "unimog.safety.map=cost"],
                "The `safety` of truck 0 has no effect",
            ),
            ("local-minima", vec!["wumpus.safety.map=cost"], "The `safety` of Wumpus 0 has no effect"),
            ("fleet", vec!["wumpus.1.potential.q=3"], "The `potential` of Wumpus 1 has no effect"),
            (
                "report-2024",
                vec!["field.size_m=2500", "unimog.prm.samples=500"],
                "truck 0 is hardly connected: 500 milestones in 499 components. They are about 112 m apart",
            ),
            (
                "report-2024",
                vec!["field.size_m=2500", "unimog.prm.samples=25000", "unimog.prm.max_edge_m=10"],
                "The roadmap of truck 0 will be disconnected: a milestone has on average 1.3 others within \
                 `max_edge_m`, 10 m",
            ),
            ("contest", vec!["unimog.prm_rs.samples=0", "unimog.prm_rs.corner_places=0"], "truck 0 has no milestones"),
            (
                "contest",
                vec!["wumpus.reach_m=4.9"],
                "Wumpus 0 can light none of the 248 bushes: no bush's centre is within `reach_m`, 4.9 m, of a place \
                 that it can reach; the nearest is 5.000 m away.",
            ),
            (
                "contest",
                vec!["wumpus.lattice_m=1", "wumpus.reach_m=2.4"],
                "`reach_m`, 2.4 m, of a place that it can reach; the nearest is 4.000 m away.",
            ),
            ("fleet", vec!["suppression.reach_m=none"], "Truck 2 extinguishes fires from its start and never drives"),
        ] {
            let found = warned(source, &changes);
            assert!(found.contains(expected), "{source} {changes:?}: {found}");
        }
    }

    #[test]
    fn starts_in_a_bush_and_ignitions_beside_one_are_reported() {
        let mut scenario = load("smoke", &["ignition=[{ at_s = 1, cells = [[4, 0], [5, 0]] }]".into()]).unwrap();
        let south_edge = format!("{}\n{}", ".".repeat(20), "....#.".to_owned() + &"#".repeat(14));
        let map = ImportedField::parse(&south_edge, 5.0).unwrap();
        scenario.field.imported = Some(map);
        scenario.unimog[0].start = StartPose { x_m: 60.0, y_m: 4.0, heading_deg: 0.0 };
        scenario.wumpus[0].start_m = [18.5, 2.5];
        let of = |scenario: &Scenario| warnings(scenario, Terrain::from_scenario(scenario, 1).ok().as_ref()).join("\n");
        let found = of(&scenario);
        assert!(found.contains("moved to the nearest free place: truck 0."), "{found}");
        assert!(found.contains("Cells of ignitions that are not bushes of the map: 1."), "{found}");
        scenario.wumpus[0].start_m = [18.6, 2.5];
        assert!(of(&scenario).contains("truck 0, Wumpus 0"));
    }

    #[test]
    fn ignitions_that_light_nothing_are_doubted_before_a_run() {
        let mut scenario = load(
            "smoke",
            &[
                "fire.model=rothermel".into(),
                "field.coverage=0".into(),
                "ignition=[{ at_s = 1, cells = [[4, 0], [5, 0]] }]".into(),
            ],
        )
        .expect("it is right");
        assert_eq!(doubts_of_files(&scenario), [""; 0]);
        let frame = scenario.field.frame();
        let mut fuel = vec![102; frame.cell_count()];
        fuel[5] = 98;
        scenario.landscape.get_or_insert_default().imported = Some(ImportedLayers::from_fuel(frame, &fuel));
        let found = doubts_of_files(&scenario);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            found[0].starts_with("Cells of ignitions that cannot burn: 1, the first [5, 0] with NB8, "),
            "{found:?}"
        );
        fuel.fill(99);
        scenario.landscape.get_or_insert_default().imported = Some(ImportedLayers::from_fuel(frame, &fuel));
        scenario.ignition[0].cells = IgnitionCells::Random(3);
        assert_eq!(doubts_of_files(&scenario), ["The ignition at 1 s lights nothing: none of its cells can burn."]);
    }

    #[test]
    fn bare_fields_and_agents_without_a_place_are_reported() {
        let of = |rows: [&str; 20], cell_m: f64| {
            let mut scenario = load("smoke", &[]).unwrap();
            scenario.field.imported = Some(ImportedField::parse(&rows.join("\n"), cell_m).unwrap());
            scenario.unimog[0].start = StartPose { x_m: 20.0, y_m: 20.0, heading_deg: 0.0 };
            (scenario.wumpus[0].start_m, scenario.wumpus[0].size_m) = ([12.5, 12.5], 1.0);
            let found = warnings(&scenario, Terrain::from_scenario(&scenario, 1).ok().as_ref()).join("\n");
            assert!(warnings_of_map(&scenario).iter().all(|warning| found.contains(warning)), "{found}");
            found
        };
        assert!(of(["...................."; 20], 5.0).contains("Nothing can burn: the field has no bushes."));
        let stripes = of(["#.#.#.#.#.#.#.#.#.#."; 20], 2.0);
        assert!(stripes.contains("Truck 0 cannot start: no free place was found for it on this field"), "{stripes}");
        assert!(!stripes.contains("moved to the nearest free place: truck 0"), "{stripes}");
        let full = of(["####################"; 20], 5.0);
        assert!(full.contains("Wumpus 0 cannot start"), "{full}");
    }

    #[test]
    fn of_agents_that_are_alike_the_first_few_are_warned_of() {
        let sparse = ["field.size_m=2500", "unimog.prm.samples=100", "unimog.count=5"];
        let found = warned("report-2024", &sparse);
        assert_eq!(found.matches("is hardly connected").count(), SHOWN_ALIKE, "{found}");
        assert_eq!(found.matches("to the side").count(), SHOWN_ALIKE, "{found}");
    }

    #[test]
    fn a_scenario_without_oddities_has_no_warnings() {
        assert_eq!(warned("wumpus-alone", &[]), "");
        assert_eq!(warned("fleet", &[]), "");
        assert!(!warned("original-2024", &[]).contains("never drives"), "there trucks drive to the nearest milestone");
        let dense = ["field.size_m=2500", "unimog.planner=prm+primitives", "unimog.prm.samples_per_hectare=80"];
        assert!(!warned("contest", &dense).contains("roadmap"), "it is as dense as on a small field");
    }
}
