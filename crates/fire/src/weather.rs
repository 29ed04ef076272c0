//! Wind and moisture in the course of a run: a table of intervals, known in advance.

use std::fmt;

use super::surface::FuelMoisture;
use wildfire_base::geometry::DVec2;
use wildfire_base::time::SimTime;

/// Wind and moisture, constant within each of its intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Weather {
    /// The first begins at zero, the others later and later; the last goes on forever.
    intervals: Vec<WeatherInterval>,
}

/// The weather from one time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeatherInterval {
    pub from: SimTime,
    /// At 10 m above the ground; where the wind blows to, x east, y north.
    pub wind_mps: DVec2,
    pub moisture: FuelMoisture,
}

/// A table of weather that is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeatherTableError {
    Empty,
    /// The first interval begins later than a run.
    NoBeginning {
        from: SimTime,
    },
    /// The interval of this number (from 0) does not begin after the one before.
    OutOfOrder {
        interval: usize,
        from: SimTime,
        before: SimTime,
    },
}

impl fmt::Display for WeatherTableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "no weather is given; expected at least one row, for time 0"),
            Self::NoBeginning { from } => write!(f, "the weather begins at {from}; expected the first row at 0 s"),
            Self::OutOfOrder { interval, from, before } => {
                write!(
                    f,
                    "row {} begins at {from}; expected a time after {before}, the time of the previous row",
                    interval + 1
                )
            }
        }
    }
}

impl std::error::Error for WeatherTableError {}

impl Weather {
    /// Creates the table of these intervals, which begin at zero and ascend in time.
    pub fn new(intervals: Vec<WeatherInterval>) -> Result<Self, WeatherTableError> {
        let Some(first) = intervals.first() else { return Err(WeatherTableError::Empty) };
        if first.from > SimTime::ZERO {
            return Err(WeatherTableError::NoBeginning { from: first.from });
        }
        let falls = intervals.windows(2).position(|pair| pair[1].from <= pair[0].from);
        if let Some(before) = falls {
            let (from, before, interval) = (intervals[before + 1].from, intervals[before].from, before + 1);
            return Err(WeatherTableError::OutOfOrder { interval, from, before });
        }
        Ok(Self { intervals })
    }

    /// Creates weather that never changes.
    pub fn constant(wind_mps: DVec2, moisture: FuelMoisture) -> Self {
        Self { intervals: vec![WeatherInterval { from: SimTime::ZERO, wind_mps, moisture }] }
    }

    /// Returns the intervals, ascending in time.
    pub fn intervals(&self) -> &[WeatherInterval] {
        &self.intervals
    }

    /// Returns the number of the interval that a time falls into; the time at which one begins belongs to it.
    pub fn interval_at(&self, time: SimTime) -> usize {
        self.intervals.partition_point(|interval| interval.from <= time) - 1
    }

    /// Returns the weather at a time.
    pub fn at(&self, time: SimTime) -> &WeatherInterval {
        &self.intervals[self.interval_at(time)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(seconds: f64, east_mps: f64) -> WeatherInterval {
        let moisture = FuelMoisture { d1: 0.06, d10: 0.07, d100: 0.08, herb: 0.6, woody: 0.9 };
        WeatherInterval { from: SimTime::from_seconds(seconds), wind_mps: DVec2::new(east_mps, 0.0), moisture }
    }

    #[test]
    fn an_interval_begins_at_its_time() {
        let weather = Weather::new(vec![interval(0.0, 1.0), interval(60.0, 2.0)]).expect("it is in order");
        let wind = |seconds| weather.at(SimTime::from_seconds(seconds)).wind_mps.x;
        assert_eq!([wind(0.0), wind(59.9), wind(60.0), wind(1e6)], [1.0, 1.0, 2.0, 2.0]);
    }

    #[test]
    fn tables_that_are_no_course_of_weather_are_refused() {
        assert_eq!(Weather::new(Vec::new()), Err(WeatherTableError::Empty));
        assert!(matches!(Weather::new(vec![interval(1.0, 0.0)]), Err(WeatherTableError::NoBeginning { .. })));
        let twice = Weather::new(vec![interval(0.0, 0.0), interval(5.0, 1.0), interval(5.0, 2.0)]);
        let error = twice.expect_err("two rows of one time");
        assert_eq!(
            error.to_string(),
            "row 3 begins at 5.000 s; expected a time after 5.000 s, the time of the \
            previous row"
        );
    }
}
