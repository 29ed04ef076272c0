//! Fire under winds that change from place to place, against an exact solution by characteristics.
//!
//! The fire at a point spreads as an ellipse with semi-axes a along the unit vector d and w across it, whose centre moves at
//! a e d: `H(x, p) = a e d.p + sqrt((a d.p)^2 + (w n.p)^2)` is the rate at which a front with the normal p moves, times |p|.
//! Arrival times solve `H(x, grad T) = 1` (the eikonal equation), whose characteristics are the rays
//! `dx/dt = dH/dp, dp/dt = -dH/dx` (Courant and Hilbert, "Methods of mathematical physics", volume II, 1962, chapter II). They
//! start from the ignition in all directions; their ends at a time are the front, as long as none has crossed another. The
//! model knows nothing of rays.

use std::f64::consts::TAU;
use std::sync::Arc;

use wildfire_base::geometry::{Cell, DVec2, FieldFrame, ops};
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::lone::LoneFire;
use wildfire_fire::models::RothermelRules;
use wildfire_fire::surface::{
    FuelBed, FuelMoisture, SurfaceFire, SurfaceOptions, twenty_foot_wind, unsheltered_adjustment,
};
use wildfire_fire::{Landscape, Weather, WindField};

const FUEL: u8 = 102;

type Wind = fn(DVec2) -> DVec2;

/// East, and faster to the north: 1 m/s in the south, 6 m/s 1 km farther.
fn shear(at: DVec2) -> DVec2 {
    DVec2::new(1.0 + 0.005 * at.y, 0.0)
}

/// Turning from east to north over a kilometre.
fn turning(at: DVec2) -> DVec2 {
    let (sin, cos) = ops::sin_cos(at.x / 1000.0 * TAU / 4.0);
    DVec2::new(cos, sin) * 3.5
}

fn fire_at(bed: &FuelBed, wind_mps: DVec2) -> SurfaceFire {
    let model = FuelModel::by_number(FUEL).expect("it is one");
    let midflame = wind_mps * (twenty_foot_wind(1.0) * unsheltered_adjustment(model.depth_ft));
    bed.behavior(midflame, DVec2::ZERO, &SurfaceOptions::default())
}

/// Returns H and its gradient by p.
fn hamiltonian(bed: &FuelBed, wind: Wind, at: DVec2, p: DVec2) -> (f64, DVec2) {
    let fire = fire_at(bed, wind(at));
    let e = fire.eccentricity;
    let d = fire.heading.truncate();
    let n = DVec2::new(-d.y, d.x);
    let a = fire.rate_mps / (1.0 + e);
    let w = a * (1.0 - e * e).sqrt();
    let along = a * d.dot(p);
    let across = w * n.dot(p);
    let norm = ops::hypot(along, across);
    (e * along + norm, a * e * d + (a * along * d + w * across * n) / norm)
}

/// The place of a ray and the gradient of time there, or their rates.
type RayState = (DVec2, DVec2);

fn add((x, p): RayState, (dx, dp): RayState, step: f64) -> RayState {
    (x + step * dx, p + step * dp)
}

/// Returns the rates of a ray; H is differenced by place, where only its wind differs.
fn rate(bed: &FuelBed, wind: Wind, (x, p): RayState) -> RayState {
    const SMALL_M: f64 = 0.01;
    let by_x = [DVec2::X, DVec2::Y].map(|axis| {
        let [ahead, behind] = [x + axis * SMALL_M, x - axis * SMALL_M].map(|at| hamiltonian(bed, wind, at, p).0);
        (ahead - behind) / (2.0 * SMALL_M)
    });
    (hamiltonian(bed, wind, x, p).1, -DVec2::from_array(by_x))
}

/// Returns where the ray that starts with a normal is after a time, by the classical method of Runge and Kutta.
fn ray(bed: &FuelBed, wind: Wind, start: DVec2, normal: DVec2, seconds: f64) -> DVec2 {
    const STEPS: usize = 200;
    let mut state = (start, normal / hamiltonian(bed, wind, start, normal).0);
    let step = seconds / STEPS as f64;
    for _ in 0..STEPS {
        let first = rate(bed, wind, state);
        let second = rate(bed, wind, add(state, first, step / 2.0));
        let third = rate(bed, wind, add(state, second, step / 2.0));
        let fourth = rate(bed, wind, add(state, third, step));
        for (share, slope) in [(1.0, first), (2.0, second), (2.0, third), (1.0, fourth)] {
            state = add(state, slope, share * step / 6.0);
        }
    }
    state.0
}

/// Says whether a point is inside a polygon.
fn is_inside(polygon: &[DVec2], at: DVec2) -> bool {
    let next = polygon.iter().cycle().skip(1);
    let crossed = polygon.iter().zip(next).filter(|(one, other)| {
        (one.y > at.y) != (other.y > at.y) && at.x < one.x + (at.y - one.y) / (other.y - one.y) * (other.x - one.x)
    });
    crossed.count() % 2 == 1
}

fn burned(frame: FieldFrame, wind: Wind, start: Cell, seconds: f64) -> LoneFire {
    let winds = (0..frame.cell_count()).map(|index| wind(frame.centre(frame.cell(index))));
    let field = WindField::new(winds);
    let weather =
        Weather::constant(field.mean(), FuelMoisture::default()).with_wind_fields(vec![Some(Arc::new(field))]);
    let landscape = Arc::new(Landscape::uniform(frame, FUEL));
    let mut fire = LoneFire::new(landscape, Arc::new(weather), RothermelRules::default(), &[(SimTime::ZERO, start)]);
    fire.burn_until(SimTime::from_seconds(seconds));
    fire
}

#[test]
fn fires_in_winds_by_place_are_those_of_characteristics() {
    let frame = FieldFrame { cols: 200, rows: 200, cell_m: 5.0 };
    let start = Cell { col: 40, row: 70 };
    let model = FuelModel::by_number(FUEL).expect("it is one");
    let bed = FuelBed::new(model, &FuelMoisture::default(), SurfaceOptions::default().curing);
    for (name, wind, seconds) in [("shear", shear as Wind, 5400.0), ("turning", turning, 6000.0)] {
        let fire = burned(frame, wind, start, seconds);
        let normals = (0..1440).map(|part| ops::sin_cos(TAU * f64::from(part) / 1440.0));
        let ends = normals.map(|(sin, cos)| ray(&bed, wind, frame.centre(start), DVec2::new(cos, sin), seconds));
        let front: Vec<DVec2> = ends.collect();
        let [mut both, mut either] = [0, 0];
        for index in 0..frame.cell_count() {
            let cell = frame.cell(index);
            let exact = is_inside(&front, frame.centre(cell));
            let found = fire.arrival(cell).is_some();
            both += u32::from(exact && found);
            either += u32::from(exact || found);
        }
        let share = f64::from(both) / f64::from(either);
        println!("{name}: {both} cells of both, {either} of either, {share:.4}");
        assert!(both > 4000 && share >= 0.99, "{name}: {share}");
    }
}

#[test]
fn wind_that_is_everywhere_the_same_is_the_uniform_wind() {
    let frame = FieldFrame { cols: 80, rows: 60, cell_m: 5.0 };
    let start = Cell { col: 20, row: 30 };
    let local = burned(frame, |_| DVec2::new(3.0, 1.0), start, 3600.0);
    let weather = Weather::constant(DVec2::new(3.0, 1.0), FuelMoisture::default());
    let landscape = Arc::new(Landscape::uniform(frame, FUEL));
    let rules = RothermelRules::default();
    let mut uniform = LoneFire::new(landscape, Arc::new(weather), rules, &[(SimTime::ZERO, start)]);
    uniform.burn_until(SimTime::from_seconds(3600.0));
    for index in 0..frame.cell_count() {
        let [one, other] = [&local, &uniform].map(|fire| fire.arrival(frame.cell(index)).map(SimTime::as_nanos));
        let is_near = one.zip(other).map_or(one == other, |(one, other)| one.abs_diff(other) < 1000);
        assert!(is_near, "{:?}: {one:?} {other:?}", frame.cell(index));
    }
}

#[test]
#[ignore = "tier 2: a measurement"]
fn cost_of_wind_by_place() {
    let frame = FieldFrame { cols: 400, rows: 400, cell_m: 5.0 };
    let start = Cell { col: 133, row: 200 };
    let landscape = Arc::new(Landscape::uniform(frame, FUEL));
    let winds = (0..frame.cell_count()).map(|index| shear(frame.centre(frame.cell(index))));
    let field = vec![Some(Arc::new(WindField::new(winds)))];
    for _ in 0..5 {
        let weather = Weather::constant(DVec2::X, FuelMoisture::default()).with_wind_fields(field.clone());
        let mut stopwatch = CpuStopwatch::start();
        let rules = RothermelRules::default();
        let mut fire = LoneFire::new(Arc::clone(&landscape), Arc::new(weather), rules, &[(SimTime::ZERO, start)]);
        fire.burn_until(SimTime::from_seconds(1e9));
        let local = stopwatch.elapsed_since_last().as_secs_f64();
        let weather = Arc::new(Weather::constant(DVec2::new(3.5, 0.0), FuelMoisture::default()));
        let rules = RothermelRules::default();
        let mut fire = LoneFire::new(Arc::clone(&landscape), weather, rules, &[(SimTime::ZERO, start)]);
        fire.burn_until(SimTime::from_seconds(1e9));
        let uniform = stopwatch.elapsed_since_last().as_secs_f64();
        println!("by place {local:.3} s, uniform {uniform:.3} s, {:.2} times", local / uniform);
    }
}
