//! Arguments that the commands of `wildfire fire` share.

use std::ops::RangeInclusive;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde::de::DeserializeOwned;
use serde::de::value::StrDeserializer;

use crate::cli::numbers;
use wildfire_base::geometry::{Cell, DVec2, compass};
use wildfire_base::time::SimTime;
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::surface::{Combine, Curing, FuelMoisture, LengthToWidth, SurfaceOptions, WindLimit};

pub const AZIMUTHS_DEG: RangeInclusive<f64> = -360.0..=360.0;
pub const SLOPES: RangeInclusive<f64> = 0.0..=5.0;
pub const WINDS_MPS: RangeInclusive<f64> = 0.0..=100.0;
pub const DEAD_MOISTURES: RangeInclusive<f64> = 0.0..=1.0;
pub const LIVE_MOISTURES: RangeInclusive<f64> = 0.0..=5.0;

/// Choices on which programs for fire behavior differ.
#[derive(Clone, Copy, Debug, Args)]
pub struct ChoiceArguments {
    /// Add wind and slope as vectors in the slope's plane, or as horizontal vectors (BEHAVE).
    #[arg(help_heading = "Choices", long, value_name = "NAME", default_value = "plane", value_parser = choice::<Combine>(&["plane", "flat"]))]
    pub combine: Combine,
    /// Formula for the cured share of live grass: exact, or with BEHAVE's rounded numbers.
    #[arg(help_heading = "Choices", long, value_name = "NAME", default_value = "exact", value_parser = choice::<Curing>(&["exact", "behave"]))]
    pub curing: Curing,
    /// Limit beyond which more wind does not speed up the fire.
    #[arg(help_heading = "Choices", long, value_name = "NAME", default_value = "rothermel-1972", value_parser = choice::<WindLimit>(&["rothermel-1972", "andrews-2013", "none"]))]
    pub wind_limit: WindLimit,
    /// Formula for a fire's shape from the wind.
    #[arg(help_heading = "Choices", long, value_name = "NAME", default_value = "anderson-1983", value_parser = choice::<LengthToWidth>(&["anderson-1983", "linear"]))]
    pub length_to_width: LengthToWidth,
}

impl ChoiceArguments {
    pub fn options(&self) -> SurfaceOptions {
        let Self { curing, combine, wind_limit, length_to_width } = *self;
        SurfaceOptions { curing, combine, wind_limit, length_to_width }
    }
}

/// Reads a name that scenarios have for a choice too.
pub fn choice<T: DeserializeOwned + Clone + Send + Sync + 'static>(
    names: &'static [&'static str],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names).map(|name| {
        let name = StrDeserializer::<serde::de::value::Error>::new(&name);
        T::deserialize(name).expect("these names are those of scenarios")
    })
}

/// The slope of the ground.
#[derive(Clone, Copy, Debug, Args)]
pub struct SlopeArguments {
    /// Slope as rise over run: 0.3 is 30 percent.
    #[arg(long, value_name = "RISE/RUN", default_value = "0", allow_hyphen_values = true, value_parser = slope)]
    pub slope: f64,
    /// Azimuth that the slope faces, downhill.
    #[arg(long, value_name = "AZIMUTH", default_value = "180", allow_hyphen_values = true, value_parser = azimuth)]
    pub aspect: f64,
}

impl SlopeArguments {
    /// Returns the gradient of the elevation.
    pub fn gradient(&self) -> DVec2 {
        compass::unit_from(self.aspect) * self.slope
    }
}

pub fn slope(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &SLOPES, "rise over run").map_err(|expected| expected + "; 30 percent is 0.3")
}

pub fn azimuth(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &AZIMUTHS_DEG, "degrees clockwise from north")
}

/// A wind by its speed, and by where it comes from if that is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    pub speed_mps: f64,
    pub from_deg: Option<f64>,
}

/// Reads `SPEED@FROM`, or a speed alone.
pub fn wind(text: &str) -> Result<Wind, String> {
    let (speed, from) = text.split_once('@').map_or((text, None), |(speed, from)| (speed, Some(from)));
    let speed_mps = numbers::parse_within(speed, &WINDS_MPS, "metres per second");
    let speed_mps = speed_mps.map_err(|expected| expected + ", such as 5@270 with the azimuth it blows from")?;
    Ok(Wind { speed_mps, from_deg: from.map(azimuth).transpose()? })
}

/// Reads the code or the number of a fuel model.
pub fn fuel(name: &str) -> Result<&'static FuelModel, String> {
    FuelModel::by_name(name.trim()).ok_or_else(|| format!("expected {}", no_such_fuel(name)))
}

/// Says what was expected instead of a fuel model that does not exist, and which are near to it.
pub fn no_such_fuel(name: &str) -> String {
    let near = FuelModel::nearest(name.trim());
    let names: Vec<String> = near.iter().map(|model| format!("{} ({})", model.code, model.number)).collect();
    match names[..] {
        [] => "a fuel model, such as GR2 or 102; --list-fuels prints all".to_owned(),
        _ => format!("the code or number of a fuel model; the nearest is {}", names.join(" or ")),
    }
}

/// Reads five moistures.
pub fn moisture(text: &str) -> Result<FuelMoisture, String> {
    let numbers: Vec<Option<f64>> = text
        .split(',')
        .enumerate()
        // Live fuel holds several times its own weight in water, and dead fuel at most as much as itself.
        .map(|(place, number)| numbers::within(number, if place < 3 { &DEAD_MOISTURES } else { &LIVE_MOISTURES }))
        .collect();
    match numbers[..] {
        [Some(d1), Some(d10), Some(d100), Some(herb), Some(woody)] => Ok(FuelMoisture { d1, d10, d100, herb, woody }),
        _ => Err(format!(
            "expected D1,D10,D100,HERB,WOODY as fractions of the dry weight, such as 0.06,0.07,0.08,0.60,0.90: dead fuel \
             {}, live {}; 6 percent is 0.06",
            numbers::range_text(&DEAD_MOISTURES),
            numbers::range_text(&LIVE_MOISTURES)
        )),
    }
}

/// A wind from some second on, as it was given: at 10 m above the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindStep {
    pub from: SimTime,
    pub speed_mps: f64,
    pub from_deg: f64,
}

impl WindStep {
    /// Returns the vector along which it blows.
    pub fn wind_mps(self) -> DVec2 {
        compass::unit_from(self.from_deg) * self.speed_mps
    }
}

/// Winds in the order of their times, the first at 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WindSteps(pub Vec<WindStep>);

/// The latest second that may be written.
pub const MAX_SECONDS: f64 = 1e6;

/// Reads `SECONDS:SPEED@FROM,...`; the first may do without its seconds, which are 0.
pub fn wind_steps(text: &str) -> Result<WindSteps, String> {
    let mut steps: Vec<WindStep> = Vec::new();
    for (number, step) in text.split(',').enumerate() {
        let refuse = || {
            format!(
                "found {step:?}, expected SECONDS:SPEED@FROM such as 0:2.5@270: seconds from 0 to {MAX_SECONDS}, metres \
                 per second {}, and the azimuth it blows from",
                numbers::range_text(&WINDS_MPS)
            )
        };
        let (seconds, wind) = match step.rsplit_once(':') {
            Some((time, wind)) => (numbers::parse_time_within(time, &(0.0..=MAX_SECONDS)).ok(), wind),
            None => (Some(0.0).filter(|_| number == 0), step),
        };
        let (speed, from) = wind.split_once('@').ok_or_else(refuse)?;
        let numbers = (seconds, numbers::within(speed, &WINDS_MPS), numbers::within(from, &AZIMUTHS_DEG));
        let (Some(seconds), Some(speed_mps), Some(from_deg)) = numbers else { return Err(refuse()) };
        let from = SimTime::from_seconds(seconds);
        match steps.last() {
            None if from > SimTime::ZERO => return Err("expected the first wind at 0 seconds".to_owned()),
            // Winds at one time would leave open which of them blows.
            Some(before) if before.from >= from => {
                return Err(format!(
                    "the wind {step:?} does not begin after the previous one; expected increasing seconds"
                ));
            }
            _ => steps.push(WindStep { from, speed_mps, from_deg }),
        }
    }
    Ok(WindSteps(steps))
}

/// Reads a cell by its row, counted from the south, and its column.
pub fn cell(text: &str) -> Result<Cell, String> {
    let parts = text.split_once(',').map(|(row, col)| (numbers::parse(row.trim()), numbers::parse(col.trim())));
    match parts {
        Some((Some(row), Some(col))) => Ok(Cell { col, row }),
        _ => Err("expected ROW,COL, whole numbers from the south-west corner, such as 100,40".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn winds_rise_in_time_and_are_named_by_where_they_come_from() {
        let steps = wind_steps("0:2.22@270,4800:3@180").expect("it is a table").0;
        assert_eq!(steps[0].wind_mps(), DVec2::new(2.22, 0.0));
        assert_eq!((steps[1].from, steps[1].wind_mps()), (SimTime::from_seconds(4800.0), DVec2::new(0.0, 3.0)));
        assert_eq!(wind_steps("8@270"), wind_steps("0:8@270"));
        for (wrong, fragment) in [
            ("", "expected SECONDS"),
            ("5", "expected SECONDS"),
            ("0:5", "expected SECONDS"),
            ("0:5@", "expected SECONDS"),
            ("0:-1@0", "expected SECONDS"),
            ("0:5@400", "expected SECONDS"),
            ("0:5@0,6@0", "expected SECONDS"),
            ("1:5@0", "first wind at 0"),
            ("0:5@0,60:5@0,60:5@0", "increasing seconds"),
        ] {
            let message = wind_steps(wrong).expect_err(wrong);
            assert!(message.contains(fragment), "{wrong}: {message}");
        }
    }

    #[test]
    fn a_wind_is_a_speed_with_or_without_where_it_comes_from() {
        assert_eq!(wind("5@200"), Ok(Wind { speed_mps: 5.0, from_deg: Some(200.0) }));
        assert_eq!(wind("2.5"), Ok(Wind { speed_mps: 2.5, from_deg: None }));
        for wrong in ["", "@5", "5@", "5@north", "-1@0", "5@0@0"] {
            assert!(wind(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn cells_are_named_by_row_and_column() {
        assert_eq!(cell("100, 40"), Ok(Cell { row: 100, col: 40 }));
        for wrong in ["", "1", "1,2,3", "-1,2", "1.5,2", "70000,1"] {
            assert!(cell(wrong).is_err(), "{wrong}");
        }
    }
}
