//! Weather by the hour, as stations record it: what a run takes from it as wind and as moisture of dead fuel.
//!
//! Three formats are read, each with the units and heights that its manual gives:
//!
//! - CSV: `time` (local, or with a zone), `temperature_c`, `humidity_pct`, `speed_mps` (at 10 m), `from_deg`, `rain_mm`, and
//!   `solar_w_m2` or `cloud_pct`.
//! - FW21, of FireFamilyPlus and NFDRS4: columns named with their units, wind in mph at 20 ft or in km/h at 10 m; times in
//!   ISO 8601, with the local offset or in UTC (the reader of the Missoula Fire Sciences Laboratory, NFDRS4, `fw21.cpp`).
//! - `.wxs`, of FARSITE and FlamMap: Fahrenheit, inches and mph at 20 ft, or Celsius, mm and km/h at 10 m; local times (help
//!   of FlamMap 6.2, "Weather Stream (.WXS) File" and "Wind (.WND) File"; without `RAWS_UNITS` FARSITE reads English units).
//!
//! A row holds from its time on, the last one to the end of the run; its rain fell in the hour before. Rows that a run does
//! not need are not looked at, nor are columns.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::path::Path;

use crate::faults::check::MAX_CHANGES;
use crate::site::weather::{DeadMoisture, MoistureChange, WeatherSettings};
use crate::site::weather_csv::{CsvRow, CsvTable, house_angle, read_text};
use crate::site::wind::{MAX_WIND_MPS, WindChange};
use wildfire_base::document::number::short;
use wildfire_base::geometry::ops;
use wildfire_base::untrusted::visible_start;
use wildfire_fire::fine_moisture::fine_dead_moisture;
use wildfire_fire::nelson::{Air, SIZES, Stick};
use wildfire_fire::surface::{FuelMoisture, twenty_foot_wind};

const MPS_PER_MPH: f64 = 0.447_04;
const DAY_S: i64 = 86_400;

/// What a run takes from a stream.
pub struct StreamWeather {
    pub winds: Vec<WindChange>,
    /// Empty if the moisture of dead fuel does not follow the stream.
    pub moistures: Vec<MoistureChange>,
    /// How the stream was read, in sentences.
    pub notes: Vec<String>,
}

/// Reads what a run of this duration takes from a stream; live fuel keeps its usual moisture.
///
/// # Errors
/// Returns a sentence with the path and the line of what is wrong.
pub fn read_stream(
    path: &Path,
    settings: &WeatherSettings,
    usual: &FuelMoisture,
    duration_s: f64,
) -> Result<StreamWeather, String> {
    let text = read_text(path)?;
    let stream = WeatherStream::parse(path, &text, settings, duration_s)?;
    let start_s = start_s(settings);
    let dead = match settings.dead_moisture {
        DeadMoisture::Fixed => Vec::new(),
        DeadMoisture::Tables => stream.by_tables()?,
        DeadMoisture::Nelson => stream.by_sticks(settings.latitude_deg)?,
    };
    let moistures = stream.rows.iter().skip(stream.first).zip(dead).map(|(row, [d1, d10, d100])| {
        let at_s = (row.at_s - start_s).max(0.0);
        MoistureChange { at_s, d1, d10, d100, herb: usual.herb, woody: usual.woody }
    });
    Ok(StreamWeather { winds: stream.winds(start_s)?, moistures: moistures.collect(), notes: stream.format.notes })
}

/// Returns the second of the stream at which a run starts. A scenario's ranges are checked after its files are read, so
/// numbers outside of them come this far, and no further.
fn start_s(settings: &WeatherSettings) -> f64 {
    3600.0 * settings.start_h.max(0.0)
}

/// What a column of a stream measures.
#[derive(Clone, Copy, PartialEq, Eq)]
enum StreamQuantity {
    Speed,
    From,
    Temperature,
    Humidity,
    Rain,
    Solar,
    Cloud,
}

/// Lists what a run needs, the sun last: from radiation or else from clouds.
fn needed_quantities(dead_moisture: DeadMoisture) -> &'static [StreamQuantity] {
    use StreamQuantity::{From, Humidity, Rain, Solar, Speed, Temperature};
    match dead_moisture {
        DeadMoisture::Fixed => &[Speed, From],
        DeadMoisture::Tables => &[Speed, From, Temperature, Humidity],
        DeadMoisture::Nelson => &[Speed, From, Temperature, Humidity, Rain, Solar],
    }
}

/// How the numbers of a unit become those that runs use: degrees Celsius, percent, m/s at 10 m, mm, W/m2, degrees.
#[derive(Clone, Copy)]
enum UnitScale {
    Times(f64),
    Fahrenheit,
    Kelvin,
    /// Miles per hour at 20 ft.
    TwentyFootMph,
}

impl UnitScale {
    fn convert(self, number: f64) -> f64 {
        match self {
            Self::Times(factor) => number * factor,
            Self::Fahrenheit => (number - 32.0) / 1.8,
            Self::Kelvin => number - 273.15,
            Self::TwentyFootMph => number * (1.0 / twenty_foot_wind(1.0) * MPS_PER_MPH),
        }
    }
}

/// A unit and how programs write it, without blanks, brackets and capitals.
struct StreamUnit {
    name: &'static str,
    spellings: &'static [&'static str],
    scale: UnitScale,
}

/// A quantity in the three formats.
struct QuantityFormat {
    csv: &'static str,
    fw21: &'static str,
    /// The units of FW21; the first one is taken where none is written.
    units: &'static [StreamUnit],
    /// The column of `.wxs`.
    wxs: Option<usize>,
    /// What its numbers can be, in the units of runs.
    range: [f64; 2],
    unit: &'static str,
}

const fn unit(name: &'static str, spellings: &'static [&'static str], scale: UnitScale) -> StreamUnit {
    StreamUnit { name, spellings, scale }
}

const PERCENT: StreamUnit = unit("%", &["%", "percent", "pct"], UnitScale::Times(1.0));
const DEGREES: StreamUnit =
    unit("degrees", &["degrees", "degree", "deg", "degt", "degreestrue"], UnitScale::Times(1.0));

/// All quantities, in their order. NFDRS4 gives the bounds of temperature from above and of rain: 140 F, 20 inches an hour.
static QUANTITIES: [QuantityFormat; 7] = [
    QuantityFormat {
        csv: "speed_mps",
        fw21: "WindSpeed",
        units: &[
            unit(
                "mph (at 20 ft)",
                &["mph", "mi/h", "mi/hr", "miles/h", "miles/hour", "milesperhour"],
                UnitScale::TwentyFootMph,
            ),
            unit(
                "km/h (at 10 m)",
                &["km/h", "kph", "kmh", "kmph", "km/hr", "kmhr", "km/hour", "kilometersperhour", "kilometresperhour"],
                UnitScale::Times(1.0 / 3.6),
            ),
        ],
        wxs: Some(7),
        range: [0.0, MAX_WIND_MPS],
        unit: "m/s at 10 m",
    },
    QuantityFormat {
        csv: "from_deg",
        fw21: "WindAzimuth",
        units: &[DEGREES],
        wxs: Some(8),
        range: [0.0, 360.0],
        unit: "degrees",
    },
    QuantityFormat {
        csv: "temperature_c",
        fw21: "Temperature",
        units: &[
            unit("F", &["f", "degf", "degreesf", "fahrenheit", "degreesfahrenheit"], UnitScale::Fahrenheit),
            unit("C", &["c", "degc", "degreesc", "celsius", "degreescelsius", "centigrade"], UnitScale::Times(1.0)),
            unit("K", &["k", "degk", "kelvin"], UnitScale::Kelvin),
        ],
        wxs: Some(4),
        range: [-80.0, 60.0],
        unit: "C",
    },
    QuantityFormat {
        csv: "humidity_pct",
        fw21: "RelativeHumidity",
        units: &[PERCENT],
        wxs: Some(5),
        range: [0.0, 100.0],
        unit: "%",
    },
    QuantityFormat {
        csv: "rain_mm",
        fw21: "Precipitation",
        units: &[
            unit("in", &["in", "inch", "inches"], UnitScale::Times(25.4)),
            unit("mm", &["mm", "millimeter", "millimeters", "millimetre", "millimetres"], UnitScale::Times(1.0)),
            unit("cm", &["cm", "centimeter", "centimeters", "centimetre", "centimetres"], UnitScale::Times(10.0)),
        ],
        wxs: Some(6),
        range: [0.0, 508.0],
        unit: "mm",
    },
    QuantityFormat {
        csv: "solar_w_m2",
        fw21: "SolarRadiation",
        units: &[unit(
            "W/m2",
            &["w/m2", "w/m^2", "wm2", "wm-2", "w/sqm", "watts/m2", "watts/m^2"],
            UnitScale::Times(1.0),
        )],
        wxs: None,
        range: [0.0, 2000.0],
        unit: "W/m2",
    },
    QuantityFormat {
        csv: "cloud_pct",
        fw21: "CloudCover",
        units: &[PERCENT],
        wxs: Some(9),
        range: [0.0, 100.0],
        unit: "%",
    },
];

/// The columns of `.wxs`.
const WXS: [&str; 10] = ["year", "month", "day", "time", "temperature", "humidity", "rain", "speed", "from", "cloud"];

/// Where the time of a row is.
#[derive(Clone, Copy)]
enum TimeFormat {
    /// In a column, as ISO 8601 has it; in UTC where nothing else is written, or local.
    Iso { column: usize, is_utc: bool },
    /// In four columns: year, month, day, `hhmm`.
    Wxs,
}

/// A table, and what its columns are.
struct StreamFormat<'a> {
    table: CsvTable<'a>,
    time: TimeFormat,
    /// The column of each quantity, and its scale.
    columns: [Option<(usize, UnitScale)>; 7],
    /// The column that names the station.
    station: Option<usize>,
    notes: Vec<String>,
}

impl<'a> StreamFormat<'a> {
    fn detect(path: &Path, text: &'a str, needed: &[StreamQuantity]) -> Result<Self, String> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let is_start = |word: &str| text.trim_start().get(..word.len()).is_some_and(|it| it.eq_ignore_ascii_case(word));
        // The extension decides first, since `.wxs` has no line that identifies it beyond doubt.
        let other = match extension.as_str() {
            "wxs" | "raws" => return Self::wxs(path, text),
            "wtr" | "wnd" => {
                Some("of a day or of the wind only; FlamMap writes both as one .wxs: Utilities, WND and WTR to WXS")
            }
            _ if is_start("W98") || is_start("W13") => {
                Some("FW9 or FW13; FireFamilyPlus and NFDRS4's FireWxConverter write it as FW21")
            }
            _ => None,
        };
        if let Some(other) = other {
            return Err(format!("{}: expected a CSV file, FW21 or .wxs; this is {other}", path.display()));
        }
        if is_start("RAWS") {
            return Self::wxs(path, text);
        }
        let table = CsvTable::new(path, text)?;
        // Its columns decide too: an FW21 file is CSV, and may be named so.
        let is_fw21 =
            table.column("time").is_none() && table.names.iter().any(|name| bare(name).starts_with("datetime"));
        if is_fw21 || extension == "fw21" { Self::fw21(table, needed) } else { Self::csv(table, needed) }
    }

    fn csv(table: CsvTable<'a>, needed: &[StreamQuantity]) -> Result<Self, String> {
        let column = |it: &QuantityFormat| Some((table.column(it.csv)?, UnitScale::Times(1.0)));
        let columns = QUANTITIES.each_ref().map(column);
        let time = table.column("time").ok_or("time");
        let column = require(&table, time, &columns, needed, |it| it.csv)?;
        let time = TimeFormat::Iso { column, is_utc: false };
        Ok(Self { time, columns, station: None, notes: Vec::new(), table })
    }

    fn fw21(table: CsvTable<'a>, needed: &[StreamQuantity]) -> Result<Self, String> {
        let rest_of = |index: usize, start: &str| bare(table.names[index]).strip_prefix(start).map(str::to_owned);
        let indices = 0..table.names.len();
        let mut notes = Vec::new();
        let mut columns = [None; 7];
        for (quantity, column) in QUANTITIES.iter().zip(&mut columns) {
            let start = quantity.fw21.to_ascii_lowercase();
            // `Precip` is in use too.
            let short_start = start.trim_end_matches("itation");
            let unit_of = |index| rest_of(index, &start).or_else(|| rest_of(index, short_start));
            // A column of the right name and a unit of the format comes first: others may begin alike.
            *column = indices.clone().find_map(|index| {
                let spelling = unit_of(index)?;
                let unit = quantity.units.iter().find(|unit| unit.spellings.contains(&spelling.as_str()))?;
                Some((index, unit.scale))
            });
            let Some(index) = indices.clone().find(|&index| column.is_none() && unit_of(index).is_some()) else {
                continue;
            };
            let name = visible_start(table.names[index]);
            // A wrong unit would be off by a factor, so it is refused and not guessed.
            let units: Vec<&str> = quantity.units.iter().map(|unit| unit.name).collect();
            if unit_of(index).is_some_and(|unit| !unit.is_empty()) {
                let expected = format!("expected {}, or a CSV file with `{}`", units.join(" or "), quantity.csv);
                return Err(format!("{}: line 1: the unit of `{name}` is not one of FW21; {expected}", table.name));
            }
            notes.push(format!("`{name}` has no unit; it is taken as {}.", units[0]));
            *column = Some((index, quantity.units[0].scale));
        }
        let column = indices.clone().find(|&index| rest_of(index, "datetime").is_some());
        let column = require(&table, column.ok_or("DateTime"), &columns, needed, |it| it.fw21)?;
        let is_utc = match rest_of(column, "datetime").unwrap_or_default().as_str() {
            "" | "local" | "lst" | "iso8601" => false,
            "utc" | "gmt" | "z" => true,
            _ => {
                let column = visible_start(table.names[column]);
                return Err(format!("{}: line 1: the zone of `{column}` is not UTC or local", table.name));
            }
        };
        let station = indices.clone().find(|&index| bare(table.names[index]) == "stationid");
        let time = TimeFormat::Iso { column, is_utc };
        Ok(Self { time, columns, station, notes, table })
    }

    fn wxs(path: &Path, text: &'a str) -> Result<Self, String> {
        let is_row = |line: &str| line.trim_start().starts_with(|first: char| first.is_ascii_digit());
        let mut is_metric = None;
        let mut notes = Vec::new();
        let header = text.lines().enumerate().take_while(|(_, line)| !is_row(line));
        for (index, line) in header.clone() {
            // A line without a colon may be the bare name of the units.
            let (key, value) = line.split_once(':').unwrap_or(("RAWS_UNITS", line));
            match [key, value].map(|word| word.trim().to_ascii_lowercase()).each_ref().map(String::as_str) {
                ["raws_units", "english"] => is_metric = Some(false),
                ["raws_units", "metric"] => is_metric = Some(true),
                // Without a colon, it may as well be the names of the columns.
                ["raws_units", _] if line.contains(':') => {
                    let name = path.display();
                    return Err(format!("{name}: line {}: expected the units English or Metric", index + 1));
                }
                ["raws_winds", "gust"] => notes.push("Its winds are those of gusts (RAWS_WINDS).".to_owned()),
                _ => {}
            }
        }
        let table = CsvTable::with_names(path, WXS.to_vec(), None, text, header.count())?;
        // In the order of quantities; the last two need none.
        let [speed, temperature, rain] = match is_metric {
            Some(true) => [UnitScale::Times(1.0 / 3.6), UnitScale::Times(1.0), UnitScale::Times(1.0)],
            _ => [UnitScale::TwentyFootMph, UnitScale::Fahrenheit, UnitScale::Times(25.4)],
        };
        let scales = [speed, UnitScale::Times(1.0), temperature, UnitScale::Times(1.0), rain];
        notes.push(match is_metric {
            Some(true) => "Its units are metric: Celsius, mm, km/h at 10 m.".to_owned(),
            Some(false) => "Its units are English: Fahrenheit, inches, mph at 20 ft.".to_owned(),
            None => "It has no RAWS_UNITS; English units are taken: Fahrenheit, inches, mph at 20 ft.".to_owned(),
        });
        let mut columns = QUANTITIES.each_ref().map(|it| it.wxs.map(|index| (index, UnitScale::Times(1.0))));
        for (column, scale) in columns.iter_mut().zip(scales) {
            *column = column.map(|(index, _)| (index, scale));
        }
        Ok(Self { time: TimeFormat::Wxs, columns, station: None, notes, table })
    }

    fn has(&self, quantity: StreamQuantity) -> bool {
        self.columns[quantity as usize].is_some()
    }

    /// Returns a number of a row in the unit of runs.
    fn number(&self, row: &CsvRow<'_>, quantity: StreamQuantity) -> Result<f64, String> {
        let (column, scale) = self.columns[quantity as usize].expect("columns are required before");
        let QuantityFormat { range: [mut min, max], unit, .. } = QUANTITIES[quantity as usize];
        // Azimuths of CSV files may go the other way around.
        if quantity == StreamQuantity::From && self.table.column("from_deg").is_some() {
            min = -max;
        }
        let number = row.cell(column).parse::<f64>().ok().map(|number| scale.convert(number + 0.0));
        number
            .filter(|number| (min..=max).contains(number))
            .ok_or_else(|| self.table.wrong(row, column, &format!("a number from {min} to {max} {unit}")))
    }

    /// Reads the time of a row.
    fn time(&self, row: &CsvRow<'_>) -> Result<RowTime, String> {
        let table = &self.table;
        match self.time {
            TimeFormat::Iso { column, is_utc } => {
                let mut time = RowTime::parse(row.cell(column)).ok_or_else(|| {
                    table.wrong(row, column, "a time such as 2026-07-14 13:00 or 2026-07-14T13:00:00-07:00")
                })?;
                // Without a zone in the value, the name of the column states it.
                time.zone = time.zone.or(is_utc.then_some(Zone::Utc));
                Ok(time)
            }
            TimeFormat::Wxs => {
                let mut numbers = [0; 4];
                for (column, max) in [2200.0, 12.0, 31.0, 2400.0].into_iter().enumerate() {
                    numbers[column] = table.number(row, column, 0.0, max)? as u32;
                }
                let [year, month, day, time] = numbers;
                let local_s = seconds_of([year, month, day], [time / 100, time % 100, 0]);
                let local_s = local_s.ok_or_else(|| table.wrong(row, 3, "a time of a day that exists, as hhmm"))?;
                Ok(RowTime { utc_s: local_s, zone: None })
            }
        }
    }

    /// Reads the rows that a run needs: from the last one up to its start, or from those before that sticks remember, to
    /// the last one before its end.
    fn read_rows(&self, start_s: f64, duration_s: f64, dead: DeadMoisture) -> Result<Vec<StreamRow<'a>>, String> {
        let history = if dead == DeadMoisture::Nelson { STICK_HISTORY } else { 1 };
        let table = &self.table;
        // In `.wxs` the time of day follows year, month and day.
        let time_column = if let TimeFormat::Iso { column, .. } = self.time { column } else { 3 };
        let mut rows: VecDeque<StreamRow<'_>> = VecDeque::new();
        let mut first: Option<(RowTime, &str)> = None;
        for row in table.rows() {
            let row = row?;
            let time = self.time(&row)?;
            let station = self.station.map_or("", |column| row.cell(column));
            let (first_time, first_station) = *first.get_or_insert((time, station));
            // Rows of two stations would be read as one weather that jumps back and forth.
            if station != first_station {
                let expected = format!("{}, the station of the first row", visible_start(first_station));
                return Err(table.wrong(&row, self.station.unwrap_or_default(), &expected));
            }
            // Local times and those of a zone have no common order.
            if time.zone.is_some() != first_time.zone.is_some() {
                let expected = if time.zone.is_some() { "no zone" } else { "a zone" };
                return Err(table.wrong(&row, time_column, &format!("a time with {expected}, as in the first row")));
            }
            let at_s = (time.utc_s - first_time.utc_s) as f64;
            // Two rows of one time would leave open which of them holds.
            if rows.back().is_some_and(|before| at_s <= before.at_s) {
                return Err(table.wrong(&row, time_column, "a time after that of the previous row"));
            }
            if at_s > start_s + duration_s {
                break;
            }
            // Only the rows that are needed stay, so a century by the hour is read in bounded memory.
            if at_s <= start_s && rows.len() == history {
                rows.pop_front();
            }
            table.check_count(rows.len().saturating_sub(history))?;
            rows.push_back(StreamRow { row, time, at_s, local_s: time.utc_s });
        }
        Ok(rows.into())
    }
}

/// Returns the column of the time, or names all columns that a run needs and a table lacks.
fn require(
    table: &CsvTable<'_>,
    time: Result<usize, &str>,
    columns: &[Option<(usize, UnitScale)>; 7],
    needed: &[StreamQuantity],
    name: fn(&QuantityFormat) -> &'static str,
) -> Result<usize, String> {
    // Clouds replace radiation.
    let is_there = |it: StreamQuantity| {
        columns[it as usize].is_some()
            || it == StreamQuantity::Solar && columns[StreamQuantity::Cloud as usize].is_some()
    };
    let missing = needed.iter().filter(|it| !is_there(**it)).map(|it| name(&QUANTITIES[*it as usize]));
    // All missing columns are named at once, so that a table is mended in one go.
    let missing: Vec<&str> = time.err().into_iter().chain(missing).collect();
    time.ok().filter(|_| missing.is_empty()).ok_or_else(|| table.lacks(&missing))
}

/// The hours before a run that sticks go through; after a tenth of them the thickest one has forgotten how it began.
const STICK_HISTORY: usize = MAX_CHANGES;

/// The weather of a station around a run.
struct WeatherStream<'a> {
    format: StreamFormat<'a>,
    rows: Vec<StreamRow<'a>>,
    /// The row that holds at the start of the run.
    first: usize,
}

struct StreamRow<'a> {
    row: CsvRow<'a>,
    time: RowTime,
    /// Seconds since the first row of the stream.
    at_s: f64,
    /// Local seconds since the beginning of the year 1.
    local_s: i64,
}

/// A zone that is written with a time.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Zone {
    Utc,
    /// Seconds ahead of UTC.
    Offset(i64),
}

/// The time of a row.
#[derive(Clone, Copy)]
struct RowTime {
    /// Seconds since the beginning of the year 1: in UTC where a zone is written, or else local.
    utc_s: i64,
    zone: Option<Zone>,
}

/// Returns the seconds from the beginning of the year 1 to a time of the calendar, if that exists.
fn seconds_of([year, month, day]: [u32; 3], [hour, minute, second]: [u32; 3]) -> Option<i64> {
    let days = *days_of_months(year).get(month.checked_sub(1)? as usize)?;
    let is_time = hour < 24 && minute < 60 && second < 60 || [hour, minute, second] == [24, 0, 0];
    if !(1900..=2200).contains(&year) || !(1..=days).contains(&day) || !is_time {
        return None;
    }
    let before = days_of_months(year)[..month as usize - 1].iter().sum::<u32>() + day - 1;
    Some(DAY_S * (days_before(year) + i64::from(before)) + i64::from(3600 * hour + 60 * minute + second))
}

fn days_of_months(year: u32) -> [u32; 12] {
    let is_leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    [31, if is_leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31]
}

/// Counts the days from the beginning of the year 1 to that of a year.
fn days_before(year: u32) -> i64 {
    let years = i64::from(year) - 1;
    365 * years + years / 4 - years / 100 + years / 400
}

impl RowTime {
    /// Reads a time of ISO 8601 in its extended or its basic form: `2026-07-14T13:00:00-07:00`, `20260714T200000Z`; with a
    /// blank instead of the `T`, without seconds, and without a zone.
    fn parse(text: &str) -> Option<Self> {
        let (date, time) = text.split_once(['T', 't', ' '])?;
        let time = time.trim().to_ascii_uppercase();
        let utc = ["Z", "UTC", "GMT"].into_iter().find_map(|zone| time.strip_suffix(zone));
        let (time, zone) = match (utc, time.rfind(['+', '-'])) {
            (Some(time), _) => (time, Some(Zone::Utc)),
            (None, Some(at)) => (&time[..at], Some(Zone::Offset(parse_offset(&time[at..])?))),
            (None, None) => (time.as_str(), None),
        };
        let date = parse_parts(date, ['-', '/'], [4, 2, 2], 3)?;
        // Fractions of a second do not matter.
        let time = parse_parts(time.split('.').next()?.trim(), [':', ':'], [2, 2, 2], 2)?;
        let offset_s = if let Some(Zone::Offset(offset_s)) = zone { offset_s } else { 0 };
        Some(Self { utc_s: seconds_of(date, time)? - offset_s, zone })
    }
}

/// Reads three numbers, the last of which may be missing, that signs separate or that have a number of digits each.
fn parse_parts(text: &str, separators: [char; 2], digits: [usize; 3], min_count: usize) -> Option<[u32; 3]> {
    let is_extended = text.contains(separators);
    let mut numbers = [0; 3];
    let mut rest = text;
    for (position, number) in numbers.iter_mut().enumerate() {
        if rest.is_empty() {
            return (position >= min_count).then_some(numbers);
        }
        let end = if is_extended { rest.find(separators).unwrap_or(rest.len()) } else { digits[position] };
        let part = rest.get(..end)?.trim();
        *number = if part.bytes().all(|byte| byte.is_ascii_digit()) { part.parse().ok()? } else { return None };
        rest = rest[end..].trim_start_matches(separators);
    }
    rest.is_empty().then_some(numbers)
}

/// Reads the seconds of `+hh:mm`, `-hhmm` or `-hh`.
fn parse_offset(text: &str) -> Option<i64> {
    let sign = if text.starts_with('-') { -1 } else { 1 };
    let digits = text[1..].replace(':', "");
    let [hours, minutes, _] = parse_parts(&digits, [':', ':'], [2, 2, 2], 1)?;
    (digits.len() <= 4 && hours <= 14 && minutes < 60).then(|| sign * i64::from(3600 * hours + 60 * minutes))
}

impl StreamRow<'_> {
    fn day(&self) -> i64 {
        self.local_s.div_euclid(DAY_S)
    }

    fn hour(&self) -> f64 {
        self.local_s.rem_euclid(DAY_S) as f64 / 3600.0
    }

    /// Returns the year and the day of the year, counted from 0.
    fn year_and_day(&self) -> (u32, u32) {
        let mut year = (self.day() / 366) as u32 + 1;
        while days_before(year + 1) <= self.day() {
            year += 1;
        }
        (year, (self.day() - days_before(year)) as u32)
    }

    fn month(&self) -> u32 {
        let (year, mut day) = self.year_and_day();
        let mut month = 1;
        for days in days_of_months(year) {
            if day < days {
                break;
            }
            day -= days;
            month += 1;
        }
        month
    }

    /// Returns the radiation of a clear sky (Haurwitz 1945), the sun's height from its declination (Cooper 1969).
    fn clear_sky_w_m2(&self, latitude_deg: f64) -> f64 {
        let declination = 23.45_f64.to_radians() * ops::sin(TAU * f64::from(285 + self.year_and_day().1) / 365.0);
        let minute = self.local_s.rem_euclid(DAY_S) / 60;
        let hour_angle = TAU * (minute as f64 / 1440.0 - 0.5);
        let (sin, cos) = ops::sin_cos(latitude_deg.to_radians());
        let height = sin * ops::sin(declination) + cos * ops::cos(declination) * ops::cos(hour_angle);
        if height > 0.0 { 1098.0 * height * ops::exp(-0.057 / height) } else { 0.0 }
    }
}

/// Returns the part of the sun that comes through clouds (Kasten and Czeplak 1980).
fn through(cloud: f64) -> f64 {
    1.0 - 0.75 * ops::pow(cloud, 3.4)
}

/// Returns a name or unit in small letters, without blanks and brackets.
fn bare(name: &str) -> String {
    name.chars()
        .filter(|sign| sign.is_ascii_alphanumeric() || "/%^-\u{b2}".contains(*sign))
        .map(|sign| if sign == '\u{b2}' { '2' } else { sign.to_ascii_lowercase() })
        .collect()
}

impl<'a> WeatherStream<'a> {
    fn parse(path: &Path, text: &'a str, settings: &WeatherSettings, duration_s: f64) -> Result<Self, String> {
        let dead = settings.dead_moisture;
        let format = StreamFormat::detect(path, text, needed_quantities(dead))?;
        let start_s = start_s(settings);
        let duration_s = duration_s.max(0.0);
        let rows = format.read_rows(start_s, duration_s, dead)?;
        let mut stream = Self { format, first: rows.partition_point(|row| row.at_s <= start_s) - 1, rows };
        stream.format.table.check_count(stream.rows.len() - stream.first)?;
        let is_sun_computed = dead == DeadMoisture::Nelson && !stream.format.has(StreamQuantity::Solar);
        stream.set_local_times(settings.utc_offset_h, is_sun_computed || dead == DeadMoisture::Tables)?;
        stream.note_end(start_s + duration_s);
        Ok(stream)
    }

    /// Sets the local times of the rows, which decide how the sun stands. An offset is that of the station's clock, as in
    /// NFDRS4, unless all are zero: programs write UTC so.
    fn set_local_times(&mut self, utc_offset_h: Option<f64>, is_needed: bool) -> Result<(), String> {
        let zones = || self.rows.iter().filter_map(|row| row.time.zone);
        let is_utc = zones().any(|zone| zone == Zone::Utc) || zones().all(|zone| zone == Zone::Offset(0));
        let has_zone = zones().next().is_some();
        let name = &self.format.table.name;
        match utc_offset_h {
            Some(_) if !has_zone => {
                self.format.notes.push("Its times have no zone and are local: `utc_offset_h` has no effect.".into());
            }
            Some(hours) => {
                // Values of the scenario are checked only after its files are read, so this one may be anything.
                self.rows.iter_mut().for_each(|row| row.local_s += (3600.0 * hours.clamp(-24.0, 24.0)).round() as i64);
                self.format.notes.push(format!("Its times are converted to a clock {} h ahead of UTC.", short(hours)));
            }
            None if has_zone && is_utc && is_needed => {
                let expected =
                    "expected `weather.utc_offset_h`, the hours by which clocks there are ahead of UTC (-7 for -07:00)";
                return Err(format!("{name}: its times are UTC, and moisture follows the local hour; {expected}"));
            }
            None => {
                for row in &mut self.rows {
                    row.local_s += if let Some(Zone::Offset(offset_s)) = row.time.zone { offset_s } else { 0 };
                }
            }
        }
        Ok(())
    }

    /// Notes that the last row holds for longer than an hour.
    fn note_end(&mut self, end_s: f64) {
        let last_s = self.rows.last().map_or(0.0, |row| row.at_s);
        if end_s - last_s > 3600.0 {
            let hour = short(last_s / 3600.0);
            self.format.notes.push(format!("Its last row, of hour {hour}, holds to the end of the run."));
        }
    }

    /// Returns the changes of the wind in a run that starts so many seconds after the first row.
    fn winds(&self, start_s: f64) -> Result<Vec<WindChange>, String> {
        let mut from_deg = 0.0;
        let mut winds = Vec::with_capacity(self.rows.len() - self.first);
        for row in &self.rows[self.first..] {
            let speed_mps = self.format.number(&row.row, StreamQuantity::Speed)?;
            match self.format.number(&row.row, StreamQuantity::From) {
                Ok(found) => from_deg = found,
                // Stations give calm air no direction.
                Err(_) if speed_mps == 0.0 => {}
                Err(error) => return Err(error),
            }
            winds.push(WindChange::uniform((row.at_s - start_s).max(0.0), speed_mps, house_angle(from_deg)));
        }
        Ok(winds)
    }

    fn by_tables(&self) -> Result<Vec<[f64; 3]>, String> {
        self.rows[self.first..]
            .iter()
            .map(|row: &StreamRow<'_>| -> Result<[f64; 3], String> {
                let temperature_c = self.format.number(&row.row, StreamQuantity::Temperature)?;
                let humidity = self.format.number(&row.row, StreamQuantity::Humidity)? / 100.0;
                let fine = fine_dead_moisture(temperature_c, humidity, row.month(), row.hour() as u32);
                Ok([fine, fine + 0.01, fine + 0.02])
            })
            .collect()
    }

    fn by_sticks(&self, latitude_deg: Option<f64>) -> Result<Vec<[f64; 3]>, String> {
        let format = &self.format;
        let mut sticks = [0, 1, 2].map(|class| Stick::new(SIZES[class]));
        let mut moistures = Vec::with_capacity(self.rows.len());
        for (number, row) in self.rows.iter().enumerate() {
            // A stick advances by exactly one hour, and a gap would leave out its drying.
            let is_hourly = number == 0 || row.at_s - self.rows[number - 1].at_s == 3600.0;
            let name = &format.table.name;
            let line = row.row.line;
            if !is_hourly {
                return Err(format!("{name}: line {line}: expected an hour after the previous row, for sticks"));
            }
            // Measured radiation is better than what clouds let through by estimate.
            let solar_w_m2 = if format.has(StreamQuantity::Solar) {
                format.number(&row.row, StreamQuantity::Solar)?
            } else {
                let expected = "expected `weather.latitude_deg`, for the sun above them";
                let latitude_deg =
                    latitude_deg.ok_or_else(|| format!("{name}: it has clouds and no radiation; {expected}"))?;
                row.clear_sky_w_m2(latitude_deg) * through(format.number(&row.row, StreamQuantity::Cloud)? / 100.0)
            };
            let air = Air {
                temperature_c: format.number(&row.row, StreamQuantity::Temperature)?,
                humidity: (format.number(&row.row, StreamQuantity::Humidity)? / 100.0).max(0.01),
                solar_w_m2,
                rain_cm: format.number(&row.row, StreamQuantity::Rain)? / 10.0,
            };
            moistures.push(sticks.each_mut().map(|stick| {
                stick.advance_hour(&air);
                stick.median_moisture()
            }));
        }
        // The hours before the run only brought the sticks to their state.
        Ok(moistures.split_off(self.first))
    }
}

#[cfg(test)]
mod tests;
