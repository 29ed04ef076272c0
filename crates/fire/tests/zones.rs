//! Fire where moisture and factors on the rate of spread differ from place to place.

use std::sync::Arc;

use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::lone::LoneFire;
use wildfire_fire::models::RothermelRules;
use wildfire_fire::surface::{FuelBed, FuelMoisture, SurfaceOptions, twenty_foot_wind, unsheltered_adjustment};
use wildfire_fire::{Landscape, MoistureZones, Relief, Weather, WindField};

const FRAME: FieldFrame = FieldFrame { cols: 120, rows: 61, cell_m: 5.0 };
const START: Cell = Cell { col: 20, row: 30 };
const WIND: DVec2 = DVec2::new(3.0, 0.0);
const DRY: FuelMoisture = FuelMoisture { d1: 0.06, d10: 0.07, d100: 0.08, herb: 0.60, woody: 0.90 };
const MOIST: FuelMoisture = FuelMoisture { d1: 0.10, herb: 0.80, ..DRY };

fn weather() -> Weather {
    Weather::constant(WIND, DRY)
}

fn zoned(moisture: impl Fn(Cell) -> FuelMoisture) -> Weather {
    let cells = (0..FRAME.cell_count()).map(|index| moisture(FRAME.cell(index)));
    weather().with_moisture_zones(MoistureZones::new(cells).expect("they are few"))
}

fn with_factors(parts: impl Fn(Cell) -> u16, landscape: Landscape) -> Landscape {
    Landscape { rate_factors: (0..FRAME.cell_count()).map(|index| parts(FRAME.cell(index))).collect(), ..landscape }
}

/// Grass with a stand of shrub.
fn ground(relief: Relief) -> Landscape {
    let fuel = (0..FRAME.cell_count()).map(|index| if FRAME.cell(index).col / 15 % 3 == 2 { 142 } else { 102 });
    Landscape { fuel: fuel.collect(), relief, ..Landscape::uniform(FRAME, 0) }
}

fn burn(landscape: Landscape, weather: Weather) -> Vec<Option<u64>> {
    let start = [(SimTime::ZERO, START)];
    let mut fire = LoneFire::new(Arc::new(landscape), Arc::new(weather), RothermelRules::default(), &start);
    fire.burn_until(SimTime::from_seconds(1e6));
    (0..FRAME.cell_count()).map(|index| fire.arrival(FRAME.cell(index)).map(SimTime::as_nanos)).collect()
}

/// Says whether times are this multiple of others, up to rounding.
fn are_times(found: &[Option<u64>], times: u64, others: &[Option<u64>]) -> bool {
    let pairs = found.iter().zip(others);
    pairs.into_iter().all(|(one, other)| {
        one.zip(*other).map_or(one == other, |(one, other)| one.abs_diff(times * other) < 1000 * times)
    })
}

fn reliefs() -> [Relief; 2] {
    [Relief::Plane(DVec2::new(0.1, 0.2)), Relief::Gradient(vec![[0.1, 0.2]; FRAME.cell_count()])]
}

#[test]
fn zones_of_one_moisture_are_the_uniform_moisture() {
    assert_eq!(zoned(|_| MOIST), Weather::constant(WIND, MOIST));
    assert_eq!(MoistureZones::new((0..4097).map(|part| FuelMoisture { d1: f64::from(part), ..DRY })), None);
    let mut zones = MoistureZones { of_cell: vec![0; FRAME.cell_count()], moistures: vec![MOIST, DRY] };
    zones.of_cell[0] = 1;
    for relief in reliefs() {
        let uniform = burn(ground(relief.clone()), Weather::constant(WIND, MOIST));
        // Every cell but that in a corner, which alone keeps the zones apart.
        let by_place = burn(ground(relief), weather().with_moisture_zones(zones.clone()));
        assert!(uniform.iter().flatten().count() > 5000 && are_times(&by_place[200..], 1, &uniform[200..]));
    }
}

#[test]
fn moisture_by_fuel_is_as_exact_as_one_moisture() {
    for relief in reliefs() {
        let landscape = ground(relief);
        let by_fuel = |cell| if landscape.fuel_number(cell) == 102 { MOIST } else { DRY };
        let found = burn(landscape.clone(), zoned(by_fuel));
        // Cells that stand for all of their fuel give the times of moistures that are looked up in each cell.
        let corner = |cell| if FRAME.index(cell) + 1 == FRAME.cell_count() { DRY } else { by_fuel(cell) };
        let last = FRAME.cell_count() - 200;
        assert!(are_times(&found[..last], 1, &burn(landscape.clone(), zoned(corner))[..last]));
        assert!(!are_times(&found, 1, &burn(landscape, weather())));
    }
}

#[test]
fn heads_cross_strips_in_the_time_of_each() {
    let strip = |cell: Cell| cell.col / 10 % 4;
    let moisture = |cell| if strip(cell) % 2 == 0 { DRY } else { MOIST };
    let parts = |cell| if strip(cell) < 2 { 400 } else { 1500 };
    let found = burn(with_factors(parts, Landscape::uniform(FRAME, 102)), zoned(moisture));
    let model = FuelModel::by_number(102).expect("it is one");
    let midflame = WIND * (twenty_foot_wind(1.0) * unsheltered_adjustment(model.depth_ft));
    let options = SurfaceOptions::default();
    let seconds_in = |col: u16| {
        let cell = Cell { col, row: START.row };
        let bed = FuelBed::new(model, &moisture(cell), options.curing);
        let rate_mps = bed.behavior(midflame, DVec2::ZERO, &options).rate_mps * f64::from(parts(cell)) / 1000.0;
        FRAME.cell_m / rate_mps
    };
    let mut expected_s = 0.0;
    for col in START.col..119 {
        expected_s += 0.5 * (seconds_in(col) + seconds_in(col + 1));
        let found = found[FRAME.index(Cell { col: col + 1, row: START.row })].expect("it burned");
        // From between two cells a front may be early by a part of the cell that it comes to.
        assert!((found as f64 * 1e-9 / expected_s - 1.0).abs() < 0.001, "column {}", col + 1);
    }
}

#[test]
fn factors_divide_all_times() {
    let field = WindField::new((0..FRAME.cell_count()).map(|index| WIND + DVec2::Y * (index % 7) as f64 / 10.0));
    let windy = weather().with_wind_fields(vec![Some(Arc::new(field))]);
    for weather in [weather(), windy] {
        for relief in reliefs() {
            let plain = burn(ground(relief.clone()), weather.clone());
            let burn_at = |parts| burn(with_factors(|_| parts, ground(relief.clone())), weather.clone());
            assert_eq!(burn_at(1000), plain);
            assert!(are_times(&burn_at(500), 2, &plain) && are_times(&burn_at(100), 10, &plain));
        }
    }
}
