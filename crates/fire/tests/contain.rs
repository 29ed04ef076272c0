//! Crews that build line on a lattice, beside Contain, which knows ellipses in closed form: [`wildfire_fire::contain`].

use std::f64::consts::PI;
use std::sync::Arc;

use rand::RngExt;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, ops};
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_fire::contain::{Attack, Resource, Status, Tactic};
use wildfire_fire::line::{Forecast, LineTask};
use wildfire_fire::lone::LoneFire;
use wildfire_fire::models::RothermelRules;
use wildfire_fire::surface::{FuelMoisture, surface_fire};
use wildfire_fire::{Landscape, Weather};

const CHAIN_M: f64 = 20.1168;
const ACRE_M2: f64 = 10.0 * CHAIN_M * CHAIN_M;

/// Contain's answer and that of a simulated fire that ends at the line: contained or not, and acres.
struct Compared {
    is_contained: [bool; 2],
    area_acre: [f64; 2],
}

/// Draws a fire in grass, crews and a tactic. The length of the free fire at the end has this many cells.
fn compare(case: u64, cells: f64) -> Compared {
    let mut rng = rng::stream(case, "contain");
    let fuel = if rng.random_bool(0.5) { 1 } else { 101 };
    let (sin, cos) = ops::sin_cos(rng.random_range(0.0..2.0 * PI));
    let (downwind, speed) = (DVec2::new(cos, sin), rng.random_range(0.0..12.0));
    let weather = Arc::new(Weather::constant(speed * downwind, FuelMoisture::default()));
    let (first, rules) = (Cell { col: 0, row: 0 }, RothermelRules::default());
    let plot = Landscape::uniform(FieldFrame { cols: 1, rows: 1, cell_m: 1.0 }, fuel);
    let fire = surface_fire(&plot, &weather, &rules.options, first, SimTime::ZERO).expect("grass burns");
    let (length_to_width, eccentricity) = (fire.length_to_width, fire.eccentricity);
    let rate_ch_h = fire.rate_mps * 3600.0 / CHAIN_M;
    let size_acre = rng.random_range(0.5..20.0_f64);
    let tactic = if rng.random_bool(0.5) { Tactic::Head } else { Tactic::Rear };
    let min = if tactic == Tactic::Head { 2.0 } else { 1.0 };
    let crews = rng.random_range(1..=3);
    let crew = |number: i32| Resource {
        arrival_min: rng.random_range(0.0..30.0_f64) + 10.0 * f64::from(number),
        duration_min: 3000.0,
        production_ch_h: min * rate_ch_h * rng.random_range(0.8..4.0) / if number > 0 { 3.0 } else { 1.0 },
    };
    let resources: Vec<Resource> = (0..crews).map(crew).collect();
    let attack = Attack { rate_ch_h, size_acre, length_to_width, tactic, offset_ch: 0.0, resources, min_steps: 2500 };
    let expected = attack.run();

    let report_s = (size_acre * 10.0 * length_to_width / PI).sqrt() * (1.0 + eccentricity) / rate_ch_h * 3600.0;
    let end_s = report_s + 60.0 * expected.time_min;
    let length_m = 2.0 / (1.0 + eccentricity) * fire.rate_mps * end_s;
    let side = (1.5 * cells) as u16;
    let frame = FieldFrame { cols: side, rows: side, cell_m: length_m / cells };
    let middle = frame.centre(Cell { col: side / 2, row: side / 2 });
    let origin = frame.cell_at(middle - 0.5 * eccentricity * length_m * downwind).expect("it is inside");
    let landscape = Arc::new(Landscape::uniform(frame, fuel));
    let mut fought = LoneFire::new(landscape, weather, rules, &[(SimTime::ZERO, origin)]);
    let mut free = fought.clone();
    free.burn_until(SimTime::from_seconds(1.4 * end_s));
    let arrivals = (0..frame.cell_count()).map(|index| free.arrival(frame.cell(index)));
    let seconds = arrivals.map(|time| time.map_or(f64::INFINITY, SimTime::as_seconds)).collect();
    let forecast = Forecast { frame, seconds };
    let crew = |crew: &Resource| (report_s + 60.0 * crew.arrival_min, crew.production_ch_h * CHAIN_M / 3600.0);
    let crews: Vec<(f64, f64)> = attack.resources.iter().map(crew).collect();
    let rate_mps = |time_s: f64, _: DVec2| crews.iter().filter(|crew| crew.0 <= time_s).map(|crew| crew.1).sum();
    let start_s = crews.iter().map(|crew| crew.0).fold(f64::INFINITY, f64::min);
    let max_mps = crews.iter().map(|crew| crew.1).sum();
    // Contain gives up after 18 hours, and beyond 1000 acres.
    let task = LineTask { start_s, rate_mps: &rate_mps, max_mps, until_s: report_s + 60.0 * 1080.0 };
    let line = task.along_front(&forecast, tactic, 0.0);
    for line in line.cells(&forecast) {
        let time = SimTime::from_seconds(line.time_s);
        fought.burn_until(time);
        fought.clear(time, line.cell);
    }
    let acres = |until_s: f64, fire: &mut LoneFire| {
        fire.burn_until(SimTime::from_seconds(until_s));
        let burned = (0..frame.cell_count()).filter(|&index| fire.arrival(frame.cell(index)).is_some()).count();
        burned as f64 * frame.cell_m * frame.cell_m / ACRE_M2
    };
    let [area, later] = [1.2, 2.0].map(|share| acres(share * end_s, &mut fought));
    let is_contained = line.is_closed && later < 1.001 * area && area < 1000.0;
    Compared {
        is_contained: [expected.status == Status::Contained, is_contained],
        area_acre: [expected.area_acre, area],
    }
}

/// Says how many agree, and where both contain the fire how many areas are within 2 %, and percentiles of their differences.
fn figures(compared: &[Compared]) -> (usize, usize, [f64; 3]) {
    let both = compared.iter().filter(|one| one.is_contained == [true; 2]);
    let mut off: Vec<f64> = both.map(|one| (one.area_acre[1] / one.area_acre[0] - 1.0).abs()).collect();
    off.sort_by(f64::total_cmp);
    let at = |share: f64| off[((off.len() - 1) as f64 * share).round() as usize];
    let agreed = compared.iter().filter(|one| one.is_contained[0] == one.is_contained[1]).count();
    (agreed, off.partition_point(|&off| off <= 0.02), [0.5, 0.95, 1.0].map(at))
}

#[test]
fn crews_contain_fires_as_contain_says() {
    let compared: Vec<Compared> = (0..24).map(|case| compare(case, 100.0)).collect();
    let (agreed, _, [median, _, worst]) = figures(&compared);
    assert!(median < 0.01 && worst < 0.02 && agreed == 24, "{median} {worst} {agreed}");
}

#[test]
#[ignore = "takes minutes; it prints the figures of docs/fire-spread.md and draws its picture"]
fn two_hundred_cases() {
    for cells in [100.0, 200.0, 400.0] {
        let compared: Vec<Compared> = (0..200).map(|case| compare(case, cells)).collect();
        let (agreed, close, off) = figures(&compared);
        let contained = compared.iter().filter(|one| one.is_contained[0]).count();
        println!("{cells} cells: {contained} contained, {agreed} agree, {close} areas within 2 %; off by {off:.4?}");
        if std::env::var_os("WILDFIRE_REWRITE_DOCS").is_some() {
            let picture = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/pictures/contain.svg");
            std::fs::write(picture, scatter(&compared)).expect("the picture can be written");
        }
    }
}

/// Draws the areas of both, in acres on logarithmic axes from 1 to 1000.
fn scatter(compared: &[Compared]) -> String {
    let at = |acre: f64| 60.0 + 100.0 * ops::ln(acre) / ops::ln(10.0);
    let mut svg = String::from(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 380 380' font-family='sans-serif' font-size='12' \
         text-anchor='middle'><rect width='380' height='380' fill='#fff'/><path d='M60 320H360V20H60ZL360 20' fill='none' \
         stroke='#888'/><text x='210' y='365'>acres by Contain</text><text transform='translate(20 170) rotate(-90)'>\
         acres by simulation</text><text x='60' y='338'>1</text><text x='360' y='338'>1000</text>",
    );
    for one in compared.iter().filter(|one| one.is_contained == [true; 2]) {
        let [x, y] = one.area_acre.map(at);
        svg += &format!("<circle cx='{x:.1}' cy='{:.1}' r='3' fill='#0072b2' fill-opacity='.6'/>", 380.0 - y);
    }
    svg + "</svg>\n"
}
