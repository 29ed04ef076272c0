//! The cost of a fire without agents, a cell: `cargo bench --bench fire_spread [SIDE...]`.
//!
//! Every line is one fire that burns the whole field, on one thread, with its CPU time by burned cell. `flat` is one fuel
//! and one wind; `full` 16 fuels, drawn for each cell, breaks, a slope and a wind that changes every half hour; `patches`
//! the same with fuels in patches; `hills` the same on elevations, where every cell has its own slope.

#![expect(clippy::print_stdout, reason = "a benchmark prints what it measures")]

use std::sync::Arc;

use rand::RngExt;
use wildfire::fire::lone::LoneFire;
use wildfire::fire::models::{Neighbours, RothermelRules};
use wildfire::fire::surface::FuelMoisture;
use wildfire::fire::{Landscape, Relief, Weather, WeatherInterval};
use wildfire::geometry::{Cell, DVec2, FieldFrame, ops};
use wildfire::time::SimTime;
use wildfire::time::cpu::CpuStopwatch;

const FUELS: [u8; 16] = [101, 102, 104, 121, 122, 141, 142, 145, 161, 165, 183, 188, 189, 201, 2, 10];
const KINDS: [&str; 4] = ["flat", "full", "patches", "hills"];
const PATCH: usize = 20;

fn landscape(side: u16, kind: &str) -> Landscape {
    let frame = FieldFrame { cols: side, rows: side, cell_m: 5.0 };
    let mut landscape = Landscape::uniform(frame, 102);
    if kind == "flat" {
        return landscape;
    }
    let mut rng = wildfire::rng::stream(1, "bench of fire");
    let mut draw = || FUELS[rng.random_range(0..FUELS.len() as u64) as usize];
    let across = usize::from(side) / PATCH + 1;
    let patches: Vec<u8> = (0..across * across).map(|_| draw()).collect();
    for index in 0..frame.cell_count() {
        let (row, col) = (index / usize::from(side), index % usize::from(side));
        let is_break = (row % 60 == 0 && col % 50 != 0) || (col % 70 == 0 && row % 40 != 0);
        let fuel = if kind == "full" { draw() } else { patches[row / PATCH * across + col / PATCH] };
        landscape.fuel[index] = if is_break { 91 } else { fuel };
    }
    landscape.relief = Relief::Plane(DVec2::new(0.1, 0.2));
    if kind == "hills" {
        let heights = (0..frame.cell_count()).map(|index| {
            let place = frame.centre(frame.cell(index)) / 5.0;
            (200.0 * ops::sin(place.x / 60.0) * ops::cos(place.y / 80.0)) as f32
        });
        landscape.relief = Relief::Elevation(heights.collect());
    }
    landscape
}

fn weather(kind: &str) -> Weather {
    let moisture = FuelMoisture::default();
    if kind == "flat" {
        return Weather::constant(DVec2::new(5.0, 0.0), moisture);
    }
    let interval = |number: u32| WeatherInterval {
        from: SimTime::from_seconds(1800.0 * f64::from(number)),
        wind_mps: DVec2::new(5.0 - f64::from(number % 3), f64::from(number % 5) - 2.0),
        moisture,
    };
    Weather::new((0..20).map(interval).collect()).expect("times ascend")
}

fn main() {
    // `cargo bench` and `cargo test` add words of their own.
    let sides: Vec<u16> = std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
    let is_test = std::env::args().any(|word| word == "--test");
    let sides = match (sides.is_empty(), is_test) {
        (false, _) => sides,
        (true, true) => vec![40],
        (true, false) => vec![250, 1000, 4000],
    };
    println!("  side  neighbours  fire        burned  us/cell");
    for side in sides {
        for neighbours in [Neighbours::Eight, Neighbours::Sixteen, Neighbours::ThirtyTwo] {
            for kind in KINDS {
                if side > 1000 && !(neighbours == Neighbours::ThirtyTwo && kind != "patches") {
                    continue;
                }
                let landscape = landscape(side, kind);
                let frame = landscape.frame;
                let ignition = Cell { col: side / 3, row: side / 2 + 1 };
                let rules = RothermelRules { neighbours, ..RothermelRules::default() };
                // A small field is burned several times, so that the clock has something to count.
                let times = (1_000_000 / frame.cell_count()).clamp(1, 10);
                let fires: Vec<LoneFire> = (0..times)
                    .map(|_| {
                        let (landscape, weather) = (Arc::new(landscape.clone()), Arc::new(weather(kind)));
                        LoneFire::new(landscape, weather, rules, &[(SimTime::ZERO, ignition)])
                    })
                    .collect();
                let mut stopwatch = CpuStopwatch::start();
                let burned: usize = fires
                    .into_iter()
                    .map(|mut fire| {
                        fire.burn_until(SimTime::from_seconds(1e9));
                        fire.fires().burning().len()
                    })
                    .sum();
                let micros = stopwatch.elapsed_since_last().as_secs_f64() * 1e6 / burned as f64;
                let count = neighbours.count();
                println!("{side:6}  {count:10}  {kind:8}  {:8}  {micros:7.3}", burned / times);
            }
        }
    }
}
