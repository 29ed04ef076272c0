//! The ground and the weather of a scenario in sentences, for `wildfire check`: what grows, how steep it is, how fast it
//! would burn, and what looks odd.

use crate::keys::agents::SHOWN_SEED;
use crate::keys::field::percent;
use crate::site::weather::{DeadMoisture, describe_wind, thousandths};
use crate::{FireModelName, LandscapeSettings, Scenario, Terrain, weather_on};
use wildfire_base::geometry::{DVec2, ops};
use wildfire_fire::fuel::{FuelModel, written_number};
use wildfire_fire::surface::{
    FuelBed, FuelMoisture, SurfaceFire, SurfaceOptions, twenty_foot_wind, unsheltered_adjustment,
};
use wildfire_fire::{Landscape, RATE_PARTS, Relief, Weather};

/// Fuels that are described one by one; the rest is summed up.
const SHOWN_FUELS: usize = 6;

/// Fuels whose fire is described.
const SHOWN_FIRES: usize = 4;

/// Changes of the weather that are listed.
const SHOWN_CHANGES: usize = 6;

/// The steepest ground that a landscape has more than a few cells of, degrees.
const STEEP_DEG: f64 = 50.0;

/// A fuel that covers less of the field than this is not worth a warning.
const RARE: f64 = 0.01;

/// A fuel and the cells that it covers.
struct FuelShare {
    model: FuelModel,
    cells: usize,
}

/// Counts the cells of each fuel, the most common one first.
fn fuel_shares(landscape: &Landscape) -> Vec<FuelShare> {
    let mut counts = [0_usize; 256];
    landscape.fuel.iter().for_each(|&number| counts[usize::from(number)] += 1);
    let there = (0..=u8::MAX).zip(counts).filter(|&(_, cells)| cells > 0);
    let mut shares: Vec<_> = there
        .filter_map(|(number, cells)| Some(FuelShare { model: landscape.fuel_model(number)?.clone(), cells }))
        .collect();
    shares.sort_by_key(|share| (std::cmp::Reverse(share.cells), share.model.number));
    shares
}

/// Describes what the landscape of a field is: fuels by their share, slopes, what blocks the way, where it is.
pub fn describe_ground(scenario: &Scenario, terrain: &Terrain) -> Vec<String> {
    let Some(landscape) = &terrain.landscape else { return Vec::new() };
    let cells = landscape.fuel.len() as f64;
    let shares = fuel_shares(landscape);
    let mut listed: Vec<String> = shares
        .iter()
        .take(SHOWN_FUELS)
        .map(|FuelShare { model, cells: count }| {
            let burns = if model.burns() { "" } else { ", does not burn" };
            format!("{} ({}{burns}) {} %", model.code, model.name, percent(*count as f64 / cells))
        })
        .collect();
    if shares.len() > SHOWN_FUELS {
        // The rest has one line, since a raster of real land often has twenty fuels.
        let rest: usize = shares[SHOWN_FUELS..].iter().map(|share| share.cells).sum();
        listed.push(format!("{} others {} %", shares.len() - SHOWN_FUELS, percent(rest as f64 / cells)));
    }
    // No fuel has the number 0, so the shares above leave such cells out.
    let empty = landscape.fuel.iter().filter(|&&number| number == 0).count();
    if empty > 0 {
        listed.push(format!("nothing {} %", percent(empty as f64 / cells)));
    }
    let mut lines = vec![format!("Fuels by share: {}.", listed.join(", ")), describe_relief(landscape)];
    let factors = landscape.rate_factors.iter().map(|&parts| f64::from(parts) / RATE_PARTS);
    if let Some((min, max)) = factors.clone().reduce(f64::min).zip(factors.reduce(f64::max)) {
        lines.push(format!("Factors on the rate of spread from {min} to {max}."));
    }
    let custom = landscape.custom_fuels.models().iter();
    let custom: Vec<String> = custom.map(|model| format!("{} {}", written_number(model.number), model.code)).collect();
    if !custom.is_empty() {
        let file = scenario.fuel_file.as_ref().map_or(String::new(), |file| format!(" (file {})", file.display()));
        lines.push(format!("Custom fuel models{file}: {}.", custom.join(", ")));
    }
    if landscape.canopy.is_some() {
        let trees = (0..landscape.fuel.len()).filter(|&index| landscape.canopy(landscape.frame.cell(index)).is_some());
        lines.push(format!("Trees on {} % of the cells.", percent(trees.count() as f64 / cells)));
    }
    let blocked = terrain.blocked.len();
    if blocked > 0 {
        let usual = LandscapeSettings::default();
        let blocks = &scenario.landscape.as_ref().unwrap_or(&usual).blocks;
        let codes: Vec<String> = blocks.iter().map(ToString::to_string).collect();
        let share = percent(blocked as f64 / cells);
        lines.push(format!(
            "{blocked} cells, {share} %, contain {}: trucks and Wumpuses cannot cross them.",
            codes.join(" or ")
        ));
    }
    if let Some(settings) = &scenario.landscape
        && let (Some(file), Some(roads)) = (&settings.roads_file, &settings.imported_roads)
    {
        let roads =
            roads.bytes(landscape.fuel.len()).map_or(0, |cells| cells.iter().filter(|&&road| road == 1).count());
        lines.push(format!("Roads from {}: {roads} cells, {} %.", file.display(), percent(roads as f64 / cells)));
    }
    if let Some(layers) = scenario.layers().filter(|layers| layers.gives_ground()) {
        let system = if layers.crs.is_some() { "the coordinate system of its files" } else { "metres" };
        if !layers.bands.is_empty() {
            lines.push(format!("Layers: {}.", layers.bands.join("; ")));
        }
        lines.push(format!("Its south-west corner is at ({}, {}) in {system}.", layers.west_m, layers.south_m));
    }
    lines
}

fn slope_deg(landscape: &Landscape, index: usize) -> f64 {
    ops::atan(landscape.gradient(landscape.frame.cell(index)).length()).to_degrees()
}

fn describe_relief(landscape: &Landscape) -> String {
    let heights = match &landscape.relief {
        Relief::Plane(gradient) if *gradient == DVec2::ZERO => return "The ground is level.".into(),
        Relief::Plane(gradient) => {
            // Adding 0 turns a -0 into 0, which would be printed with its sign.
            let toward = ops::atan2(gradient.y, gradient.x).to_degrees().round() + 0.0;
            let slope = tenths(ops::atan(gradient.length()).to_degrees());
            return format!("The ground is a plane that rises by {slope} degrees toward {toward} deg.");
        }
        Relief::Elevation(heights) => {
            let (min, max) =
                heights.iter().fold((f32::MAX, f32::MIN), |(l, m), &height| (l.min(height), m.max(height)));
            format!("Elevations from {} to {} m; slopes", tenths(min.into()), tenths(max.into()))
        }
        Relief::Gradient(_) => "Slopes".into(),
    };
    let count = landscape.fuel.len();
    let (mut max, mut sum) = (0.0_f64, 0.0);
    for index in 0..count {
        let slope = slope_deg(landscape, index);
        max = max.max(slope);
        sum += slope;
    }
    format!("{heights} up to {} degrees, {} on average.", tenths(max), tenths(sum / count as f64))
}

fn tenths(number: f64) -> f64 {
    (10.0 * number).round() / 10.0
}

/// Describes the weather of a scenario, wind in both conventions.
pub fn describe_weather(scenario: &Scenario) -> Vec<String> {
    let mut lines: Vec<String> = scenario
        .wind
        .iter()
        .take(SHOWN_CHANGES)
        .map(|it| {
            let wind = describe_wind(it.speed_mps, it.toward_deg);
            let field = it.imported.as_ref().and_then(|packed| packed.field(scenario.field.frame().cell_count()));
            let by_place = field.map_or(String::new(), |field| {
                let [min, max] = field.speeds().map(thousandths);
                format!("by place, {min} to {max} m/s, on average ")
            });
            format!("From {} s: {by_place}{wind}.", thousandths(it.at_s))
        })
        .collect();
    if scenario.wind.len() > SHOWN_CHANGES {
        lines.push(format!("and {} more changes of the wind.", scenario.wind.len() - SHOWN_CHANGES));
    }
    // Wind of a later time leaves the air calm until then, which no entry says.
    if scenario.wind.first().is_none_or(|change| change.at_s > 0.0) {
        lines.insert(0, "From 0 s: calm.".into());
    }
    if let Some(settings) = &scenario.fire.rothermel {
        lines.push(format!("Moisture: {}.", describe_moisture(&settings.moisture)));
        if let Some(imported) = &settings.imported_moisture {
            lines.extend(imported.describe(scenario.field.frame().cell_count()));
        }
    }
    let Some(settings) = &scenario.weather else { return lines };
    if let Some(file) = &settings.file {
        let dead = match settings.dead_moisture {
            DeadMoisture::Fixed => "is not changed",
            DeadMoisture::Tables => "follows it by Rothermel's tables",
            DeadMoisture::Nelson => "follows it by Nelson's sticks",
        };
        let file = file.display();
        let start_h = settings.start_h;
        lines.push(format!("The wind is that of `{file}`, from its hour {start_h} on; dead-fuel moisture {dead}."));
        // Notes say what was assumed about a file, such as units that it does not state.
        lines.extend(settings.notes.iter().cloned());
    }
    for change in settings.moisture.iter().take(SHOWN_CHANGES) {
        let moisture =
            FuelMoisture { d1: change.d1, d10: change.d10, d100: change.d100, herb: change.herb, woody: change.woody };
        lines.push(format!("Moisture from {} s: {}.", thousandths(change.at_s), describe_moisture(&moisture)));
    }
    if !settings.rows.is_empty() {
        lines.push(format!(
            "Instead, each run picks one of {} rows of weather at random, the same for a seed.",
            settings.rows.len()
        ));
    } else if settings.is_uncertain() {
        lines.push(format!(
            "Each run varies them at random, the same for a seed; standard deviations: speed {} m/s, direction {} \
             deg, dead moisture {} %.",
            settings.speed_sd_mps,
            settings.toward_sd_deg,
            percent(settings.moisture_sd)
        ));
    }
    lines
}

fn describe_moisture(moisture: &FuelMoisture) -> String {
    let FuelMoisture { d1, d10, d100, herb, woody } = *moisture;
    let [d1, d10, d100, herb, woody] = [d1, d10, d100, herb, woody].map(percent);
    format!("dead fuel {d1}, {d10}, {d100} % (1, 10, 100 h), live herbs {herb} %, live wood {woody} %")
}

/// The fire of a fuel on level ground in one interval of the weather, with a moisture of its own where it has one.
fn fire_of(
    model: &FuelModel,
    weather: &Weather,
    interval: usize,
    moisture: Option<FuelMoisture>,
    options: &SurfaceOptions,
) -> SurfaceFire {
    let interval = &weather.intervals()[interval];
    let bed = FuelBed::new(model, &moisture.unwrap_or(interval.moisture), options.curing);
    let speed = interval.wind_mps.length();
    let adjusted =
        if speed > 0.0 { twenty_foot_wind(speed) / speed * unsheltered_adjustment(model.depth_ft) } else { 0.0 };
    bed.behavior(interval.wind_mps * adjusted, DVec2::ZERO, options)
}

/// Returns the moistures by place of a fuel, that of its first cell first; none where moisture is not by place.
fn moistures_of(landscape: &Landscape, weather: &Weather, number: u8) -> Vec<FuelMoisture> {
    weather.moistures_of((0..landscape.fuel.len()).filter(|&index| landscape.fuel[index] == number))
}

/// Describes how fast the main fuels burn on level ground in the first weather of a run.
pub fn describe_fires(scenario: &Scenario, terrain: &Terrain, weather: &Weather) -> Vec<String> {
    let Some((landscape, settings)) = terrain.landscape.as_ref().zip(scenario.fire.rothermel.as_ref()) else {
        return Vec::new();
    };
    // Other models do not use these rates, so numbers of metres a minute would be wrong.
    if scenario.fire.model != FireModelName::Rothermel {
        return Vec::new();
    }
    let options = settings.options();
    // From 9.95 on, one decimal would be rounded to three digits.
    let digits = |number: f64| if number < 9.95 { format!("{number:.1}") } else { format!("{number:.0}") };
    let burning = fuel_shares(landscape).into_iter().filter(|share| share.model.burns());
    burning
        .take(SHOWN_FIRES)
        .map(|share: FuelShare| {
            let number = share.model.number;
            let moistures = moistures_of(landscape, weather, number);
            let fire = fire_of(&share.model, weather, 0, moistures.first().copied(), &options);
            let first = if moistures.len() > 1 { " in its first cell" } else { "" };
            if fire.rate_mps == 0.0 {
                return format!("{}{first}: too moist to burn.", share.model.code);
            }
            let intensity = fire.intensity_kw_m(fire.rate_mps);
            let factor = landscape.fuel.iter().position(|&fuel| fuel == number).map_or(1.0, |it| landscape.rate_factor(it));
            format!(
                "{}{first}: the head spreads at {} m/min with flames of {} m ({intensity:.0} kW/m), the back at {} m/min.",
                share.model.code,
                digits(60.0 * factor * fire.rate_mps),
                digits(wildfire_fire::surface::flame_length_m(intensity)),
                digits(60.0 * factor * fire.back_rate_mps())
            )
        })
        .collect()
}

/// Adds warnings about a ground and its weather.
pub fn warn_of_ground(scenario: &Scenario, terrain: &Terrain, found: &mut Vec<String>) {
    let Some(landscape) = &terrain.landscape else { return };
    let cells = landscape.fuel.len();
    if let Some(settings) = &scenario.fire.rothermel
        && scenario.fire.model == FireModelName::Rothermel
    {
        let weather = weather_on(scenario, SHOWN_SEED, landscape);
        warn_of_moisture(landscape, &weather, &settings.options(), found);
    }
    let steep = (0..cells).filter(|&index| slope_deg(landscape, index) > STEEP_DEG).count();
    if steep as f64 > RARE * cells as f64 {
        let share = percent(steep as f64 / cells as f64);
        found.push(format!(
            "{share} % of the cells are steeper than {STEEP_DEG} degrees: elevations may be in feet, or slopes in percent."
        ));
    }
    let burns = landscape.burning_numbers();
    let burning = landscape.fuel.iter().filter(|&&number| burns[usize::from(number)]);
    let between = burning.count().saturating_sub(terrain.bushes.len());
    if between == 0 {
        found.push("Nothing burns between the bushes: fire spreads only among bushes that touch.".into());
    }
    let Some(features) = &scenario.landscape else { return };
    let cell_m = landscape.frame.cell_m;
    // A road is drawn at least one cell wide, or it would have gaps that fire crosses.
    let narrow_roads = features.roads.iter().filter(|road| road.width_m < cell_m).count();
    if narrow_roads > 0 {
        let roads = if narrow_roads == 1 { "A road is".to_owned() } else { format!("{narrow_roads} roads are") };
        found.push(format!("{roads} narrower than a cell of {cell_m} m, and drawn one cell wide, the least possible."));
    }
    if features.river.as_ref().is_some_and(|river| river.width_m < cell_m) {
        found.push(format!("The river is narrower than a cell of {cell_m} m, and drawn one cell wide."));
    }
}

/// Adds a warning for each fuel that is too moist to burn, and since when.
fn warn_of_moisture(landscape: &Landscape, weather: &Weather, options: &SurfaceOptions, found: &mut Vec<String>) {
    let burning = fuel_shares(landscape).into_iter().filter(|share| share.model.burns());
    for share in burning.filter(|share| share.cells as f64 > RARE * landscape.fuel.len() as f64) {
        let intervals = weather.intervals();
        let moistures = moistures_of(landscape, weather, share.model.number);
        let moist = if moistures.is_empty() {
            (0..intervals.len()).find(|&at| fire_of(&share.model, weather, at, None, options).rate_mps == 0.0)
        } else {
            let mut fires = moistures.iter().map(|it| fire_of(&share.model, weather, 0, Some(*it), options));
            fires.all(|fire| fire.rate_mps == 0.0).then_some(0)
        };
        if let Some(at) = moist {
            let since = thousandths(intervals[at].from.as_seconds());
            let code = &share.model.code;
            found.push(format!(
                "{code} does not burn from {since} s on: its moisture exceeds the moisture of extinction, and fire in \
                 it goes out."
            ));
        }
    }
}
