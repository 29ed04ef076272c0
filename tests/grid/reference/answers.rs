//! Our answers to the questions of a case, by the name of the file that holds the reference's.

use serde_json::Value;
use wildfire::grid::brushfire::brushfire;
use wildfire::grid::cost_map::{Form, TwoZones, cost_map};
use wildfire::grid::descent::{Descent, descend};
use wildfire::grid::octile::shortest_path;
use wildfire::grid::place::octile_length;
use wildfire::grid::potential::{Attraction, Repulsion, attraction, repulsion, total};
use wildfire::grid::wavefront::{UNREACHED, descend_wavefront, wavefront};
use wildfire::grid::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, TieOrder};

use super::case::Case;
use super::compare::is_close;

pub enum Answer {
    Integers(Grid<u32>),
    Reals(Grid<f64>),
    Path(Vec<Place>),
    /// The goal lies in an obstacle. The reports go on from there; we refuse.
    Refused,
}

/// Our answer; `None` if the name stands for nothing.
pub fn answer(case: &Case, name: &str) -> Option<Answer> {
    let connectivity = if name.contains('4') { Connectivity::Four } else { Connectivity::Eight };
    let squared = Attraction::Squared { zeta: 1.0 };
    Some(match name {
        "brushfire4.csv" | "brushfire8.csv" => {
            Answer::Integers(widened(&brushfire_or_zeros(&case.occupied, connectivity)))
        }
        "wavefront4.csv" | "wavefront8.csv" => {
            wave(case, connectivity).map_or_else(|refusal| refused(case, &refusal), Answer::Integers)
        }
        "path8_daudt.csv" => path(case, connectivity, TieOrder::CrossFirst),
        "path4_girona.csv" | "path8_girona.csv" => path(case, connectivity, TieOrder::WestFirst),
        "cost_literal.csv" => cost(case, Form::Literal),
        "cost_continuous.csv" => cost(case, Form::Continuous),
        "attraction_d2_raw.csv" => Answer::Reals(attract(case, squared, None)),
        "attraction_d2_scaled10.csv" => Answer::Reals(attract(case, squared, Some(10.0))),
        "attraction_mht_raw.csv" => Answer::Reals(attract(case, Attraction::Manhattan, None)),
        "repulsive4_Q5_eta15.csv" | "repulsive8_Q5_eta15.csv" => Answer::Reals(repel(case, connectivity)),
        "total4.csv" | "total8.csv" => Answer::Reals(sum(case, connectivity)),
        "gd4_path.csv" | "gd8_path.csv" => match descent(case, connectivity) {
            Ok(Descent::Reached(path) | Descent::Stuck(path)) => Answer::Path(path),
            Ok(Descent::StartOccupied) => panic!("{}/{name}: a path from an occupied start", case.name()),
            Err(refusal) => refused(case, &refusal),
        },
        _ => return None,
    })
}

fn refused(case: &Case, refusal: &BadPlace) -> Answer {
    assert_eq!(Some(refusal), case.refusal().as_ref(), "{}", case.name());
    Answer::Refused
}

fn brushfire_or_zeros(occupied: &Grid<bool>, connectivity: Connectivity) -> Grid<u16> {
    brushfire(occupied, connectivity).unwrap_or_else(|| Grid::filled(occupied.rows(), occupied.cols(), 0))
}

fn widened(values: &Grid<u16>) -> Grid<u32> {
    Grid::from_values(values.rows(), values.cols(), values.values().iter().map(|&value| value.into()).collect())
}

fn wave(case: &Case, connectivity: Connectivity) -> Result<Grid<u32>, BadPlace> {
    wavefront(&case.occupied, case.goal, connectivity, CornerCutting::Allowed)
}

fn route(case: &Case, connectivity: Connectivity, order: TieOrder) -> Result<Route, BadPlace> {
    let values = wave(case, connectivity)?;
    Ok(descend_wavefront(&values, case.start, connectivity, CornerCutting::Allowed, order))
}

fn path(case: &Case, connectivity: Connectivity, order: TieOrder) -> Answer {
    match route(case, connectivity, order) {
        Ok(Route::Found(path)) => Answer::Path(path),
        Ok(other) => panic!("{}: there is a path, not {other:?}", case.name()),
        Err(refusal) => refused(case, &refusal),
    }
}

fn cost(case: &Case, form: Form) -> Answer {
    let brushfire = brushfire_or_zeros(&case.occupied_for_cost, Connectivity::Four);
    let costs = cost_map(&brushfire, &TwoZones { form, ..TwoZones::default() });
    let whole = costs.values().iter().map(|&cost| {
        assert_eq!(cost.fract(), 0.0, "{}: costs of the default zones are whole", case.name());
        cost as u32
    });
    Answer::Integers(Grid::from_values(costs.rows(), costs.cols(), whole.collect()))
}

fn attract(case: &Case, kind: Attraction, scale: Option<f64>) -> Grid<f64> {
    attraction(case.occupied.rows(), case.occupied.cols(), case.goal, kind, scale)
}

fn repel(case: &Case, connectivity: Connectivity) -> Grid<f64> {
    repulsion(&brushfire_or_zeros(&case.occupied, connectivity), &Repulsion::default())
}

fn sum(case: &Case, connectivity: Connectivity) -> Grid<f64> {
    let brushfire = brushfire_or_zeros(&case.occupied, connectivity);
    total(attract(case, Attraction::default(), Some(10.0)), &brushfire, &Repulsion::default())
}

fn descent(case: &Case, connectivity: Connectivity) -> Result<Descent, BadPlace> {
    let potential = sum(case, connectivity);
    descend(&potential, &case.occupied, case.start, case.goal, connectivity, CornerCutting::Allowed)
}

/// Compares what the facts of a case say beyond its files.
pub fn compare_facts(case: &Case) {
    let (name, facts) = (case.name(), &case.facts);
    assert_eq!(
        (&facts["rows"], &facts["cols"]),
        (&case.occupied.rows().into(), &case.occupied.cols().into()),
        "{name}"
    );
    assert_eq!(facts["start_free"], !case.occupied[case.start], "{name}");
    assert_eq!(facts["goal_free"], !case.occupied[case.goal], "{name}");
    for (count, connectivity) in [(4, Connectivity::Four), (8, Connectivity::Eight)] {
        compare_reach(case, &facts[format!("wavefront{count}")], connectivity);
        if let Some(expected) = facts.get(format!("gradient_descent{count}")) {
            compare_descent(case, &expected["blocked"], connectivity);
        }
    }
    compare_optimum(case, &facts["octile_cut_allowed"], CornerCutting::Allowed);
    compare_optimum(case, &facts["octile_no_corner_cut"], CornerCutting::Forbidden);
    if let Some(expected) = facts.get("path8_daudt_euclid_len")
        && let Answer::Path(path) = path(case, Connectivity::Eight, TieOrder::CrossFirst)
    {
        assert!(is_close(octile_length(&path), expected.as_f64().expect("a length")), "{name}: length of the path");
    }
    if let Some(columns) = facts.get("field_sample_columns").and_then(Value::as_array) {
        compare_samples(case, columns);
    }
}

fn compare_reach(case: &Case, expected: &Value, connectivity: Connectivity) {
    let name = format!("{}, {connectivity:?}", case.name());
    let Ok(values) = wave(case, connectivity) else { return };
    let unreached = values.values().iter().filter(|&&value| value == UNREACHED).count();
    assert_eq!(expected["unreached_free"], unreached, "{name}");
    match route(case, connectivity, TieOrder::CrossFirst) {
        Ok(Route::Found(path)) => {
            assert_eq!(expected["reachable"], true, "{name}");
            assert_eq!(expected["value_at_start"], values[case.start], "{name}");
            assert_eq!(expected["path_cells"], path.len(), "{name}");
            assert_eq!(expected["path_steps"], path.len() - 1, "{name}");
        }
        _ => assert_eq!(expected["reachable"], false, "{name}"),
    }
}

fn compare_descent(case: &Case, expected: &Value, connectivity: Connectivity) {
    let name = format!("{}, {connectivity:?}", case.name());
    let (result, path) = match descent(case, connectivity) {
        Ok(Descent::Reached(path)) => ("reached", path),
        Ok(Descent::Stuck(path)) => ("stuck", path),
        Ok(Descent::StartOccupied) => return assert_eq!(expected["result"], "invalid_start", "{name}"),
        Err(refusal) => return assert_eq!(Some(refusal), case.refusal(), "{name}"),
    };
    assert_eq!(expected["result"], result, "{name}");
    assert_eq!(expected["cells"], path.len(), "{name}");
    let end = path[path.len() - 1];
    assert_eq!(expected["final"], serde_json::json!([end.0, end.1]), "{name}");
}

fn compare_optimum(case: &Case, expected: &Value, corners: CornerCutting) {
    let name = format!("{}, corner cutting {corners:?}", case.name());
    match shortest_path(&case.occupied, case.start, case.goal, Connectivity::Eight, corners) {
        Ok(Route::Found(path)) => {
            let expected = expected.as_f64().unwrap_or_else(|| panic!("{name}: there is no way, yet one was found"));
            let length = octile_length(&path);
            assert!(is_close(length, expected), "{name}: {length}, not {expected}");
        }
        Ok(Route::StartOccupied | Route::Unreachable) => assert!(expected.is_null(), "{name}"),
        Err(refusal) => assert_eq!(Some(refusal), case.refusal(), "{name}"),
    }
}

/// A line of `field_samples` holds a place, and the values there of the fields that `columns` names.
fn compare_samples(case: &Case, columns: &[Value]) {
    let number = |value: &Value| value.as_f64().expect("samples are numbers");
    let samples = case.facts["field_samples"].as_array().expect("columns have samples");
    for (index, column) in columns.iter().enumerate().skip(2) {
        let field = column.as_str().expect("columns have names");
        let Some(Answer::Reals(values)) = answer(case, &format!("{field}.csv")) else { panic!("no field {field}") };
        for sample in samples {
            let place = (number(&sample[0]) as usize, number(&sample[1]) as usize);
            let (found, expected) = (values[place], number(&sample[index]));
            assert!(is_close(found, expected), "{}: {field} at {place:?}: {found}, not {expected}", case.name());
        }
    }
}
