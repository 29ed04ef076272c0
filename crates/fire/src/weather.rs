//! Wind and moisture in the course of a run: a table of intervals, known in advance.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use super::surface::FuelMoisture;
use wildfire_base::geometry::DVec2;
use wildfire_base::time::SimTime;

/// Wind and moisture, constant within each of its intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Weather {
    /// The first begins at zero, the others later and later; the last goes on forever.
    intervals: Vec<WeatherInterval>,
    /// By interval, the wind of each cell where it is not everywhere the same; empty if it always is.
    wind_fields: Vec<Option<Arc<WindField>>>,
    /// The moisture of each cell throughout, where it is not everywhere the same.
    moisture_zones: Option<Arc<MoistureZones>>,
}

/// Moistures by place, the same all the time.
#[derive(Clone, Debug, PartialEq)]
pub struct MoistureZones {
    /// By cell index: the place of its moisture among them.
    pub of_cell: Vec<u16>,
    pub moistures: Vec<FuelMoisture>,
}

impl MoistureZones {
    /// The most zones: fuel beds are computed for each.
    pub const MAX: usize = 4096;

    /// Creates the zones of these moistures, by cell index; `None` if they are more than [`Self::MAX`].
    pub fn new(cells: impl Iterator<Item = FuelMoisture>) -> Option<Self> {
        let mut moistures = Vec::new();
        let mut zones = BTreeMap::new();
        let mut of_cell = Vec::with_capacity(cells.size_hint().0);
        for moisture in cells {
            let FuelMoisture { d1, d10, d100, herb, woody } = moisture;
            let zone = *zones.entry([d1, d10, d100, herb, woody].map(f64::to_bits)).or_insert_with(|| {
                moistures.push(moisture);
                moistures.len() - 1
            });
            if zone >= Self::MAX {
                return None;
            }
            of_cell.push(zone as u16);
        }
        Some(Self { of_cell, moistures })
    }

    /// Returns the moisture of a cell.
    pub fn at(&self, index: usize) -> FuelMoisture {
        self.moistures[usize::from(self.of_cell[index])]
    }
}

/// Wind at 10 m by cell index, in whole hundredths of m/s, so that every machine and recording has the same bits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WindField {
    /// Where the wind blows to.
    pub east: Vec<i16>,
    pub north: Vec<i16>,
}

impl WindField {
    /// Parts of a metre per second that are stored.
    const PARTS: f64 = 100.0;

    /// Creates the field of these winds in m/s, by cell index.
    pub fn new(winds: impl Iterator<Item = DVec2>) -> Self {
        let parts = winds.map(|wind| (wind * Self::PARTS).round());
        let (east, north) = parts.map(|wind| (wind.x as i16, wind.y as i16)).unzip();
        Self { east, north }
    }

    /// Returns the wind of a cell in m/s.
    #[inline]
    pub fn at(&self, index: usize) -> DVec2 {
        DVec2::new(f64::from(self.east[index]), f64::from(self.north[index])) / Self::PARTS
    }

    /// Returns the mean of all cells in m/s.
    pub fn mean(&self) -> DVec2 {
        // Whole numbers add up without rounding, in any order.
        let [east, north] =
            [&self.east, &self.north].map(|parts| parts.iter().map(|&part| i64::from(part)).sum::<i64>());
        DVec2::new(east as f64, north as f64) / (Self::PARTS * self.east.len().max(1) as f64)
    }

    /// Returns the least and the greatest speed in m/s.
    pub fn speeds(&self) -> [f64; 2] {
        let squares = (0..self.east.len()).map(|index| self.at(index).length_squared());
        let [min, max] = squares.fold([f64::INFINITY, 0.0], |[min, max], square| [square.min(min), square.max(max)]);
        [min.sqrt(), max.sqrt()]
    }
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
        Ok(Self { intervals, wind_fields: Vec::new(), moisture_zones: None })
    }

    /// Adds the wind by place of each interval that has one, in their order; the intervals' own winds are then only shown.
    #[must_use]
    pub fn with_wind_fields(self, fields: Vec<Option<Arc<WindField>>>) -> Self {
        assert_eq!(fields.len(), self.intervals.len(), "one place for each interval");
        let wind_fields = if fields.iter().any(Option::is_some) { fields } else { Vec::new() };
        Self { wind_fields, ..self }
    }

    /// Sets the moisture by place, in place of those of the intervals. One zone is a moisture that is everywhere the same.
    #[must_use]
    pub fn with_moisture_zones(mut self, zones: MoistureZones) -> Self {
        if let [everywhere] = zones.moistures[..] {
            self.intervals.iter_mut().for_each(|interval| interval.moisture = everywhere);
            return self;
        }
        self.moisture_zones = Some(Arc::new(zones));
        self
    }

    /// Returns the moisture by place; `None` if it is everywhere the same.
    pub fn moisture_zones(&self) -> Option<&Arc<MoistureZones>> {
        self.moisture_zones.as_ref()
    }

    /// Returns the moistures by place of some cells, each once and in their order; none if moisture is everywhere the same.
    pub fn moistures_of(&self, cells: impl Iterator<Item = usize>) -> Vec<FuelMoisture> {
        let Some(zones) = &self.moisture_zones else { return Vec::new() };
        let mut is_listed = vec![false; zones.moistures.len()];
        let of_cells = cells.map(|index| usize::from(zones.of_cell[index]));
        let new = of_cells.filter(|&zone| !std::mem::replace(&mut is_listed[zone], true));
        new.map(|zone| zones.moistures[zone]).collect()
    }

    /// Returns the wind by place of each interval; empty if wind is everywhere the same.
    pub fn wind_fields(&self) -> &[Option<Arc<WindField>>] {
        &self.wind_fields
    }

    /// Returns the wind by place in an interval; `None` if it is everywhere the same.
    pub fn wind_field(&self, interval: usize) -> Option<&WindField> {
        self.wind_fields.get(interval)?.as_deref()
    }

    /// Says whether weather differs from place to place.
    pub fn is_local(&self) -> bool {
        !self.wind_fields.is_empty() || self.moisture_zones.is_some()
    }

    /// Returns the weather of a cell in an interval.
    #[inline]
    pub fn in_cell(&self, interval: usize, index: usize) -> WeatherInterval {
        let mut weather = self.intervals[interval];
        if let Some(field) = self.wind_field(interval) {
            weather.wind_mps = field.at(index);
        }
        if let Some(zones) = &self.moisture_zones {
            weather.moisture = zones.at(index);
        }
        weather
    }

    /// Returns the weather of a cell at a time.
    pub fn at_cell(&self, time: SimTime, index: usize) -> WeatherInterval {
        self.in_cell(self.interval_at(time), index)
    }

    /// Creates weather that never changes.
    pub fn constant(wind_mps: DVec2, moisture: FuelMoisture) -> Self {
        let intervals = vec![WeatherInterval { from: SimTime::ZERO, wind_mps, moisture }];
        Self { intervals, wind_fields: Vec::new(), moisture_zones: None }
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
    fn wind_by_place_is_that_of_its_interval_and_cell() {
        let field = WindField::new([DVec2::new(3.004, -1.5), DVec2::new(-4.0, 0.25)].into_iter());
        assert_eq!((field.at(0), field.at(1)), (DVec2::new(3.0, -1.5), DVec2::new(-4.0, 0.25)));
        assert_eq!((field.mean(), field.speeds()[1]), (DVec2::new(-0.5, -0.625), DVec2::new(-4.0, 0.25).length()));
        let weather = Weather::new(vec![interval(0.0, 1.0), interval(60.0, 2.0)]).expect("it is in order");
        let same = weather.clone().with_wind_fields(vec![None, None]);
        assert!(!same.is_local() && same == weather);
        let local = weather.with_wind_fields(vec![None, Some(Arc::new(field))]);
        let wind = |seconds, index| local.at_cell(SimTime::from_seconds(seconds), index).wind_mps;
        assert_eq!([wind(1.0, 1), wind(60.0, 0)], [DVec2::X, DVec2::new(3.0, -1.5)]);
        assert!(local.is_local() && local.at_cell(SimTime::ZERO, 1).moisture == local.intervals()[0].moisture);
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
