//! The weather of a run: wind that changes at given times, the moisture of the fuel, and how uncertain both are.
//!
//! What is uncertain is drawn once for a run, from the stream `weather` of its seed and nothing else: the same for a seed
//! with and without trucks, by whatever planner, so that pairs of runs share their weather.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;

use rand::{Rng, RngExt};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::moisture::MoistureShift;
use super::weather_csv::WeatherSample;
use super::wind::{MAX_WIND_MPS, WindChange};
use crate::Scenario;
use crate::faults::check::{Check, MAX_CHANGES, TablePath};
use wildfire_base::geometry::{DVec2, FieldFrame, compass, ops};
use wildfire_base::input_file::list_of_at_most;
use wildfire_base::ranges;
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_fire::surface::FuelMoisture;
use wildfire_fire::{Landscape, Weather, WeatherInterval, WindField};

/// The driest that dead fuel gets by chance.
const MIN_MOISTURE: f64 = 0.01;

/// Moisture in the course of a run, and how uncertain the weather is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WeatherSettings {
    /// Changes of the moisture, in order of time; until the first one it is that of `[fire.rothermel]`.
    #[serde(deserialize_with = "list_of_at_most::<100_000, _, _>", skip_serializing_if = "Vec::is_empty")]
    pub moisture: Vec<MoistureChange>,
    /// A weather stream by the hour that sets the wind, and the moisture of dead fuel if `dead_moisture` says so: a CSV file,
    /// FW21, or `.wxs` as FARSITE reads it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// How the moisture of dead fuel follows from the stream.
    #[serde(skip_serializing_if = "DeadMoisture::is_fixed")]
    pub dead_moisture: DeadMoisture,
    /// Hours from the first row of the stream to the start of the run; sticks take the weather of those before it.
    #[serde(skip_serializing_if = "is_zero")]
    pub start_h: f64,
    /// Latitude, for the sun over a stream that has cloud cover and no radiation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latitude_deg: Option<f64>,
    /// Hours by which clocks at the station are ahead of UTC, for a stream whose times have a zone. Moisture follows the
    /// local hour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub utc_offset_h: Option<f64>,
    /// Standard deviation of the wind's speed: one draw for a run is added to all speeds, which stay at 0 or above.
    pub speed_sd_mps: f64,
    /// Standard deviation of the wind's direction: one draw for a run turns all directions.
    pub toward_sd_deg: f64,
    /// Standard deviation of the moisture of dead fuel, a fraction: one draw for a run is added to `d1`, `d10` and `d100`,
    /// which stay at 0.01 or above.
    pub moisture_sd: f64,
    /// A CSV file with one weather per row; each run uses one row throughout: `speed_mps,from_deg` (compass), `d1, d10,
    /// d100, herb, woody`, or all seven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<PathBuf>,
    /// The rows of `samples`. Loading fills them in, so that a resolved scenario is complete without the file.
    #[serde(deserialize_with = "list_of_at_most::<100_000, _, _>", skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip)]
    pub rows: Vec<WeatherSample>,
    /// How `file` was read, in sentences; a plan of a batch does not keep them.
    #[serde(skip)]
    pub notes: Vec<String>,
}

/// Ways in which the moisture of dead fuel follows from a weather stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DeadMoisture {
    /// It does not: it stays that of `[fire.rothermel]`.
    #[default]
    Fixed,
    /// Rothermel's tables for fine dead fuel; one percent more for 10 hours, two for 100.
    Tables,
    /// Nelson's sticks of 1, 10 and 100 hours.
    Nelson,
}

impl DeadMoisture {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
    fn is_fixed(&self) -> bool {
        *self == Self::Fixed
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// Moisture from a time on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MoistureChange {
    pub at_s: f64,
    pub d1: f64,
    pub d10: f64,
    pub d100: f64,
    pub herb: f64,
    pub woody: f64,
}

impl MoistureChange {
    fn moisture(&self) -> FuelMoisture {
        let Self { d1, d10, d100, herb, woody, .. } = *self;
        FuelMoisture { d1, d10, d100, herb, woody }
    }
}

ranges! { WeatherSettings {
    start_h: 0.0..=100_000.0, latitude_deg: -90.0..=90.0, utc_offset_h: -12.0..=14.0, speed_sd_mps: 0.0..=50.0, toward_sd_deg: 0.0..=360.0,
    moisture_sd: 0.0..=0.5; moisture
} }
ranges! { MoistureChange { at_s: 0.0..=1e6 } and |change, frame| change.moisture().check(frame) }

impl WeatherSettings {
    pub(crate) fn check(&self, table: &TablePath, frame: &FieldFrame) -> Check {
        table.ascending("moisture", self.moisture.iter().map(|change| change.at_s))?;
        table.count("rows", self.rows.len(), MAX_CHANGES)?;
        self.rows.iter().enumerate().try_for_each(|(number, row)| {
            let table = table.inner("rows").item(number);
            table.settings(&row.moisture, frame)?;
            let wind = row.wind.map(|[speed_mps, toward_deg]| WindChange::uniform(0.0, speed_mps, toward_deg));
            table.settings(&wind, frame)
        })
    }

    /// Says whether runs differ in their weather.
    pub fn is_uncertain(&self) -> bool {
        self.rows.len() > 1 || self.speed_sd_mps + self.toward_sd_deg + self.moisture_sd > 0.0
    }
}

/// Returns the weather of the run with this seed on its landscape: the same with moisture by place, where files say so.
pub fn weather_on(scenario: &Scenario, seed: u64, landscape: &Landscape) -> Weather {
    let weather = weather(scenario, seed);
    let Some((settings, imported)) = scenario.local_moisture() else { return weather };
    let shift = scenario.weather.as_ref().map_or(MoistureShift::NONE, |settings| {
        let mut rng = rng::stream(seed, "weather");
        settings.draw_row(&mut rng);
        let [_, _, moister] = [(); 3].map(|()| draw_normal(&mut rng));
        settings.moisture_shift(moister)
    });
    match imported.zones(landscape, settings.moisture, shift) {
        Some(zones) => weather.with_moisture_zones(zones),
        None => weather,
    }
}

/// Returns the weather of the run with this seed, moisture by place aside. Before the first entry of `[[wind]]` the air is calm.
pub fn weather(scenario: &Scenario, seed: u64) -> Weather {
    let mut winds = scenario.wind.clone();
    let usual = scenario.fire.rothermel.as_ref().map_or_else(FuelMoisture::default, |settings| settings.moisture);
    // From 0 s on there is a moisture, whatever the first change says.
    let mut moistures = vec![(0.0, usual)];
    let mut change = FieldChange::default();
    if let Some(settings) = &scenario.weather {
        moistures.extend(settings.moisture.iter().map(|change| (change.at_s, change.moisture())));
        let mut rng = rng::stream(seed, "weather");
        // A drawn day replaces what the scenario says, as far as it has columns.
        if let Some(row) = settings.draw_row(&mut rng) {
            if let Some([speed_mps, toward_deg]) = row.wind {
                winds = vec![WindChange::uniform(0.0, speed_mps, toward_deg)];
            }
            if let Some(moisture) = row.moisture {
                moistures = vec![(0.0, moisture)];
            }
        }
        // Always three draws, so that a deviation that is set to zero moves no other draw.
        let [faster, turned, moister] = [(); 3].map(|()| draw_normal(&mut rng));
        for wind in &mut winds {
            wind.speed_mps = (wind.speed_mps + settings.speed_sd_mps * faster).clamp(0.0, MAX_WIND_MPS);
            wind.toward_deg += settings.toward_sd_deg * turned;
        }
        change =
            FieldChange { faster_mps: settings.speed_sd_mps * faster, turned_deg: settings.toward_sd_deg * turned };
        let shift = settings.moisture_shift(moister);
        moistures.iter_mut().for_each(|(_, moisture)| *moisture = shift.applied_to(*moisture));
    }
    let weather = table(&winds, &moistures);
    if winds.iter().all(|wind| wind.imported.is_none()) {
        return weather;
    }
    let cells = scenario.field.frame().cell_count();
    let fields: Vec<Option<Arc<WindField>>> =
        winds.iter().map(|wind| Some(Arc::new(change.applied_to(wind.imported.as_ref()?.field(cells)?)))).collect();
    // An interval may begin with a change of the moisture: it goes on with the wind of before.
    let of_intervals = weather.intervals().iter().map(|interval| {
        let wind = winds.iter().rposition(|wind| SimTime::from_seconds(wind.at_s) <= interval.from)?;
        fields[wind].clone()
    });
    let of_intervals = of_intervals.collect();
    weather.with_wind_fields(of_intervals)
}

/// What chance does to the winds of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct FieldChange {
    faster_mps: f64,
    turned_deg: f64,
}

impl FieldChange {
    /// Changes all winds by place as it changes one that is everywhere the same.
    fn applied_to(self, field: WindField) -> WindField {
        if self == Self::default() {
            return field;
        }
        let turn = compass::unit_toward(90.0 - self.turned_deg);
        WindField::new((0..field.east.len()).map(|index| {
            let wind = field.at(index);
            let speed = ops::hypot(wind.x, wind.y);
            let faster = (speed + self.faster_mps).clamp(0.0, MAX_WIND_MPS);
            // Calm air has no direction that it could blow along.
            if speed > 0.0 { turn.rotate(wind) * (faster / speed) } else { DVec2::ZERO }
        }))
    }
}

impl WeatherSettings {
    fn moisture_shift(&self, moister: f64) -> MoistureShift {
        if self.moisture_sd > 0.0 {
            MoistureShift { moister: self.moisture_sd * moister, min: MIN_MOISTURE }
        } else {
            MoistureShift::NONE
        }
    }

    fn draw_row(&self, rng: &mut impl Rng) -> Option<&WeatherSample> {
        if self.rows.is_empty() { None } else { Some(&self.rows[rng.random_range(0..self.rows.len() as u32) as usize]) }
    }
}

/// Draws from the normal distribution of mean 0 and deviation 1 (Box and Muller, "A note on the generation of random normal
/// deviates", Annals of Mathematical Statistics 29, 1958).
fn draw_normal(rng: &mut impl Rng) -> f64 {
    let [share, turn] = [rng.random::<f64>(), rng.random::<f64>()];
    // In (0, 1], as zero has no logarithm.
    (-2.0 * ops::ln(1.0 - share)).sqrt() * ops::cos(TAU * turn)
}

/// Joins winds and moistures, each in order of time, to one table.
fn table(winds: &[WindChange], moistures: &[(f64, FuelMoisture)]) -> Weather {
    let seconds = winds.iter().map(|wind| wind.at_s).chain(moistures.iter().map(|it| it.0)).chain([0.0]);
    let mut times: Vec<SimTime> = seconds.map(SimTime::from_seconds).collect();
    times.sort_unstable();
    times.dedup();
    let interval = |from: SimTime| {
        let wind = winds.iter().rev().find(|wind| SimTime::from_seconds(wind.at_s) <= from);
        let moisture = moistures.iter().rev().find(|it| SimTime::from_seconds(it.0) <= from);
        let moisture = moisture.expect("the first begins at zero").1;
        WeatherInterval { from, wind_mps: wind.map_or(DVec2::ZERO, WindChange::vector), moisture }
    };
    Weather::new(times.into_iter().map(interval).collect()).expect("times ascend from zero")
}

/// Returns the point of the compass that is nearest to an azimuth.
fn compass_point(azimuth_deg: f64) -> &'static str {
    const POINTS: [&str; 8] =
        ["north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west"];
    POINTS[(azimuth_deg / 45.0).round() as usize % POINTS.len()]
}

/// Rounds a number for people: what is computed, as from miles per hour, has more decimals than anybody reads.
pub(crate) fn thousandths(number: f64) -> f64 {
    (number * 1e3).round() / 1e3 + 0.0
}

/// Puts a wind into words, in the angles of scenarios and in those of maps.
pub(crate) fn describe_wind(speed_mps: f64, toward_deg: f64) -> String {
    if speed_mps == 0.0 {
        return "calm".into();
    }
    let from_deg = (270.0 - toward_deg).rem_euclid(360.0);
    let point = compass_point(from_deg);
    let [speed_mps, toward_deg, from_deg] = [speed_mps, toward_deg, from_deg].map(thousandths);
    format!("{speed_mps} m/s at 10 m toward {toward_deg} deg, that is from the {point} ({from_deg})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load;

    fn scenario() -> Scenario {
        load("contest", &["fire.model=rothermel".into()]).expect("contest is right")
    }

    fn wind(at_s: f64, speed_mps: f64, toward_deg: f64) -> WindChange {
        WindChange::uniform(at_s, speed_mps, toward_deg)
    }

    fn moisture(at_s: f64, d1: f64) -> MoistureChange {
        MoistureChange { at_s, d1, d10: 0.1, d100: 0.1, herb: 0.6, woody: 0.9 }
    }

    #[test]
    fn winds_and_moistures_make_one_table() {
        let mut scenario = scenario();
        scenario.wind = vec![wind(0.0, 5.0, 0.0), wind(1200.0, 8.0, 90.0)];
        let steps = vec![moisture(600.0, 0.08), moisture(1200.0, 0.12)];
        scenario.weather = Some(WeatherSettings { moisture: steps, ..WeatherSettings::default() });
        let weather = weather(&scenario, 1);
        let found: Vec<_> =
            weather.intervals().iter().map(|it| (it.from.as_seconds(), it.wind_mps, it.moisture.d1)).collect();
        let east = DVec2::new(5.0, 0.0);
        let north = DVec2::new(0.0, 8.0);
        assert_eq!(found, [(0.0, east, 0.06), (600.0, east, 0.08), (1200.0, north, 0.12)]);
    }

    #[test]
    fn certain_weather_is_the_same_for_every_seed_and_draws_have_their_moments() {
        let mut scenario = scenario();
        scenario.wind = vec![wind(0.0, 8.0, 30.0)];
        scenario.weather = Some(WeatherSettings::default());
        assert_eq!(weather(&scenario, 1), weather(&scenario, 2));
        let uncertain =
            WeatherSettings { speed_sd_mps: 1.0, toward_sd_deg: 10.0, moisture_sd: 0.005, ..Default::default() };
        scenario.weather = Some(uncertain);
        assert_eq!(weather(&scenario, 1), weather(&scenario, 1));
        let drawn: Vec<_> = (0..1000)
            .map(|seed| {
                let first = weather(&scenario, seed).intervals()[0];
                let toward_deg = ops::atan2(first.wind_mps.y, first.wind_mps.x).to_degrees();
                [first.wind_mps.length() - 8.0, (toward_deg - 30.0) / 10.0, (first.moisture.d1 - 0.06) / 0.005]
            })
            .collect();
        for axis in 0..3 {
            let mean = drawn.iter().map(|draw| draw[axis]).sum::<f64>() / 1000.0;
            let square = drawn.iter().map(|draw| draw[axis] * draw[axis]).sum::<f64>() / 1000.0;
            assert!(mean.abs() < 0.13 && (square - 1.0).abs() < 0.2, "axis {axis}: mean {mean}, square {square}");
        }
    }

    #[test]
    fn rows_are_drawn_equally_often_and_replace_what_they_name() {
        let mut scenario = scenario();
        scenario.wind = vec![wind(0.0, 8.0, 30.0), wind(60.0, 1.0, 0.0)];
        let row = |speed_mps| WeatherSample { wind: Some([speed_mps, 90.0]), moisture: None };
        let rows = vec![row(1.0), row(2.0), row(3.0)];
        scenario.weather = Some(WeatherSettings { rows, ..WeatherSettings::default() });
        let mut counts = [0_u32; 3];
        for seed in 0..600 {
            let weather = weather(&scenario, seed);
            let [interval] = weather.intervals() else { panic!("a row holds for the whole run") };
            assert_eq!(interval.moisture, FuelMoisture::default());
            counts[interval.wind_mps.y as usize - 1] += 1;
        }
        // 200 each, standard deviation 11.5.
        assert!(counts.iter().all(|count| count.abs_diff(200) < 58), "{counts:?}");
    }

    #[test]
    fn winds_are_reported_in_both_conventions() {
        assert_eq!(describe_wind(5.0, 0.0), "5 m/s at 10 m toward 0 deg, that is from the west (270)");
        assert_eq!(describe_wind(5.0, 90.0), "5 m/s at 10 m toward 90 deg, that is from the south (180)");
        assert_eq!(describe_wind(2.5, -45.0), "2.5 m/s at 10 m toward -45 deg, that is from the north-west (315)");
        assert_eq!(describe_wind(0.0, 12.0), "calm");
        let of_miles = describe_wind(10.7187 * 0.44704, 270.0 - 1.0 / 3.0);
        assert_eq!(of_miles, "4.792 m/s at 10 m toward 269.667 deg, that is from the north (0.333)");
    }
}
