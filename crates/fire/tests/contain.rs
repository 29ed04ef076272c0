//! Crews that build line on a lattice, beside Contain, which knows ellipses in closed form: [`wildfire_fire::contain`].

use std::f64::consts::PI;
use std::sync::Arc;

use rand::RngExt;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, ops};
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_fire::contain::{Attack, Resource, Status, Tactic};
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::line::{Forecast, LineTask};
use wildfire_fire::lone::LoneFire;
use wildfire_fire::models::RothermelRules;
use wildfire_fire::surface::{FuelBed, FuelMoisture, SurfaceOptions, twenty_foot_wind, unsheltered_adjustment};
use wildfire_fire::{Landscape, Weather};

const CHAIN_M: f64 = 20.1168;
const ACRE_M2: f64 = 10.0 * CHAIN_M * CHAIN_M;

/// A fire in uniform grass, Contain's answer, and that of a simulated fire that ends at the line.
struct Compared {
    tactic: Tactic,
    is_contained: [bool; 2],
    area_acre: [f64; 2],
}

/// Draws a case: short grass or GR1, wind, size at the report, one to three crews, tactic and offset. The larger side of the
/// free fire at the end has this many cells.
fn compare(case: u64, cells: f64, offset_share: f64) -> Compared {
    let mut rng = rng::stream(case, "contain");
    let fuel = if rng.random_bool(0.5) { 1 } else { 101 };
    let (sin, cos) = ops::sin_cos(rng.random_range(0.0..2.0 * PI));
    let (downwind, speed) = (DVec2::new(cos, sin), rng.random_range(0.0..12.0));
    let model = FuelModel::by_number(fuel).expect("it is a standard model");
    let (moisture, options) = (FuelMoisture::default(), SurfaceOptions::default());
    let midflame = twenty_foot_wind(1.0) * unsheltered_adjustment(model.depth_ft) * speed * downwind;
    let fire = FuelBed::new(model, &moisture, options.curing).behavior(midflame, DVec2::ZERO, &options);
    let rate_ch_h = fire.rate_mps * 3600.0 / CHAIN_M;
    let size_acre = rng.random_range(0.5..20.0_f64);
    let tactic = if rng.random_bool(0.5) { Tactic::Head } else { Tactic::Rear };
    // The head outruns what builds less than twice its rate on both flanks; from the rear less is enough.
    let least = if tactic == Tactic::Head { 2.0 } else { 1.0 };
    let crews = rng.random_range(1..=3);
    let resources: Vec<Resource> = (0..crews)
        .map(|number| Resource {
            arrival_min: rng.random_range(0.0..30.0_f64) + 10.0 * f64::from(number),
            duration_min: 3000.0,
            production_ch_h: least * rate_ch_h * rng.random_range(0.8..4.0) / if number > 0 { 3.0 } else { 1.0 },
        })
        .collect();
    let length_to_width = fire.length_to_width;
    let eccentricity = fire.eccentricity;
    let head_ch = |acre: f64| (acre * 10.0 * length_to_width / PI).sqrt() * (1.0 + eccentricity);
    let offset_ch = offset_share * head_ch(size_acre);
    let attack = Attack { rate_ch_h, size_acre, length_to_width, tactic, offset_ch, resources, min_steps: 2500 };
    let expected = attack.run();

    let report_s = head_ch(size_acre) / rate_ch_h * 3600.0;
    let end_s = report_s + 60.0 * expected.time_min;
    let length_m = 2.0 / (1.0 + eccentricity) * fire.rate_mps * end_s;
    let side = (1.5 * cells) as u16;
    let frame = FieldFrame { cols: side, rows: side, cell_m: length_m / cells };
    let middle = frame.centre(Cell { col: side / 2, row: side / 2 });
    let origin = frame.cell_at(middle - 0.5 * eccentricity * length_m * downwind).expect("it is inside");
    let free = LoneFire::new(
        Arc::new(Landscape::uniform(frame, fuel)),
        Arc::new(Weather::constant(speed * downwind, moisture)),
        RothermelRules::default(),
        &[(SimTime::ZERO, origin)],
    );
    let burned_until = |mut fire: LoneFire, until_s: f64| -> Vec<f64> {
        fire.burn_until(SimTime::from_seconds(until_s));
        let arrivals = (0..frame.cell_count()).map(|index| fire.arrival(frame.cell(index)));
        arrivals.map(|time| time.map_or(f64::INFINITY, SimTime::as_seconds)).collect()
    };
    let forecast = Forecast { frame, seconds: burned_until(free.clone(), 1.4 * end_s) };
    let arrivals_s = attack.resources.iter().map(|resource| report_s + 60.0 * resource.arrival_min);
    let crews: Vec<(f64, f64)> =
        arrivals_s.zip(&attack.resources).map(|(at_s, crew)| (at_s, crew.production_ch_h * CHAIN_M / 3600.0)).collect();
    let rate_mps = |time_s: f64, _: DVec2| crews.iter().filter(|crew| crew.0 <= time_s).map(|crew| crew.1).sum();
    let start_s = crews.iter().map(|crew| crew.0).fold(f64::INFINITY, f64::min);
    // Contain gives up after 18 hours, and beyond 1000 acres.
    let most_mps = crews.iter().map(|crew| crew.1).sum();
    let task = LineTask { start_s, most_mps, rate_mps: &rate_mps, until_s: report_s + 60.0 * 1080.0 };
    let line = task.along_front(&forecast, tactic, offset_ch * CHAIN_M);
    let mut fought = free;
    for line in line.cells(&forecast) {
        fought.clear(SimTime::from_seconds(line.time_s), line.cell);
    }
    let is_burned = |time_s: &&f64| time_s.is_finite();
    let burned = burned_until(fought, 2.0 * end_s).iter().filter(is_burned).count();
    let burned_acre = burned as f64 * frame.cell_m * frame.cell_m / ACRE_M2;
    // Fire does not come to an offset line all along while that is built, and Contain counts all within it.
    let area_acre = if offset_share > 0.0 { line.area_m2() / ACRE_M2 } else { burned_acre };
    let is_contained = [
        expected.status == Status::Contained,
        line.is_closed && burned_acre < 1.1 * line.area_m2() / ACRE_M2 && area_acre < 1000.0,
    ];
    Compared { tactic, is_contained, area_acre: [expected.area_acre, area_acre] }
}

/// Median, 95th percentile and greatest of the relative differences of area where both contain the fire, and how many agree
/// on that.
fn figures(compared: &[Compared]) -> ([f64; 3], usize) {
    let both = compared.iter().filter(|one| one.is_contained == [true; 2]);
    let mut off: Vec<f64> = both.map(|one| (one.area_acre[1] / one.area_acre[0] - 1.0).abs()).collect();
    off.sort_by(f64::total_cmp);
    let at = |share: f64| off[((off.len() - 1) as f64 * share).round() as usize];
    ([at(0.5), at(0.95), at(1.0)], compared.iter().filter(|one| one.is_contained[0] == one.is_contained[1]).count())
}

#[test]
fn crews_contain_fires_as_contain_says() {
    let compared: Vec<Compared> = (0..24).map(|case| compare(case, 100.0, 0.0)).collect();
    let ([median, _, worst], agreed) = figures(&compared);
    assert!(median < 0.01 && worst < 0.02 && agreed == 24, "{median} {worst} {agreed}");
    assert!(compared.iter().any(|one| !one.is_contained[0]), "some are lost");
}

#[test]
#[ignore = "takes minutes; it prints the figures of docs/line.md"]
fn two_hundred_cases() {
    for (offset_share, cells) in [(0.0, 100.0), (0.0, 200.0), (0.0, 400.0), (0.1, 200.0)] {
        let compared: Vec<Compared> = (0..200).map(|case| compare(case, cells, offset_share)).collect();
        let ([median, most, worst], agreed) = figures(&compared);
        let contained = compared.iter().filter(|one| one.is_contained[0]).count();
        println!(
            "offset {offset_share}, {cells} cells: {contained} contained, {agreed} agree; area off by {:.2} % in the median, \
             {:.2} % in 95 of 100, {:.2} % at most",
            100.0 * median,
            100.0 * most,
            100.0 * worst
        );
        if (offset_share, cells) == (0.0, 200.0) && std::env::var_os("WILDFIRE_REWRITE_DOCS").is_some() {
            let picture = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/pictures/contain.svg");
            std::fs::write(picture, scatter(&compared)).expect("the picture can be written");
        }
    }
}

/// Draws the areas of both, in acres on logarithmic axes.
fn scatter(compared: &[Compared]) -> String {
    let at = |acre: f64| 60.0 + 100.0 * ops::ln(acre) / ops::ln(10.0);
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 380 380\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"380\" height=\"380\" fill=\"#fff\"/><path d=\"M60 320H360V20H60Z M60 320L360 20\" fill=\"none\" \
         stroke=\"#888\"/>\n<text x=\"210\" y=\"365\" text-anchor=\"middle\">area by Contain (acres)</text>\n\
         <text transform=\"translate(20 170) rotate(-90)\" text-anchor=\"middle\">area by simulation (acres)</text>\n",
    );
    for acre in [1.0, 10.0, 100.0, 1000.0] {
        let (x, y) = (at(acre), 380.0 - at(acre));
        svg += &format!("<text x=\"{x}\" y=\"338\" text-anchor=\"middle\">{acre}</text>\n");
        svg += &format!("<text x=\"54\" y=\"{}\" text-anchor=\"end\">{acre}</text>\n", y + 4.0);
    }
    for one in compared.iter().filter(|one| one.is_contained == [true; 2]) {
        let [x, y] = one.area_acre.map(at);
        let colour = if one.tactic == Tactic::Head { "#d55e00" } else { "#0072b2" };
        svg += &format!("<circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{colour}\"/>\n", 380.0 - y);
    }
    svg + "</svg>\n"
}
