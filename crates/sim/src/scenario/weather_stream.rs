//! Weather by the hour, as stations record it: what a run takes from it as wind and as moisture of dead fuel.
//!
//! Three forms are read. `weather.csv` has the columns `time`, `temperature_c`, `humidity_pct`, `speed_mps` (at 10 m),
//! `from_deg`, `rain_mm` and `solar_w_m2` or `cloud_pct`. FW21, of FireFamilyPlus, names its columns with their units; `.wxs` is
//! FARSITE's. Both have the wind at 20 ft. A row holds from its time on, its rain fell in the hour before; times are local.

use std::f64::consts::TAU;
use std::path::Path;

use super::weather::{DeadMoisture, MoistureChange, WeatherSettings};
use super::weather_csv::{CsvRow, CsvTable, house_angle, read_text};
use super::wind::{MAX_WIND_MPS, WindChange};
use wildfire_base::geometry::ops;
use wildfire_fire::fine_moisture::fine_dead_moisture;
use wildfire_fire::nelson::{Air, SIZES, Stick};
use wildfire_fire::surface::{FuelMoisture, twenty_foot_wind};

const MPS_PER_MPH: f64 = 0.447_04;

/// The columns of `.wxs`.
const WXS: [&str; 10] = ["year", "month", "day", "time", "temperature", "humidity", "rain", "speed", "from", "cloud"];

/// The weather of a station.
pub struct WeatherStream {
    name: String,
    rows: Vec<StreamRow>,
}

struct StreamRow {
    line: usize,
    at: Clock,
    /// Seconds since the first row.
    at_s: f64,
    temperature_c: f64,
    humidity: f64,
    /// At 10 m.
    speed_mps: f64,
    from_deg: f64,
    rain_mm: f64,
    sun: Sun,
}

#[derive(Clone, Copy)]
enum Sun {
    Radiation(f64),
    /// The part of the sky that clouds cover.
    Cloud(f64),
}

/// A local time.
#[derive(Clone, Copy)]
struct Clock {
    /// From a day long ago.
    day: i64,
    day_of_year: u32,
    month: u32,
    minute: u32,
}

impl Clock {
    fn new([year, month, day, hour, minute]: [u32; 5]) -> Option<Self> {
        let is_leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
        let february = if is_leap { 29 } else { 28 };
        let months = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
        let days = *months.get(month.checked_sub(1)? as usize)?;
        if !(1900..=2200).contains(&year) || !(1..=days).contains(&day) || hour > 24 || minute > 59 {
            return None;
        }
        let day_of_year = months[..month as usize - 1].iter().sum::<u32>() + day;
        let before = i64::from(year) - 1;
        let day = 365 * before + before / 4 - before / 100 + before / 400 + i64::from(day_of_year);
        Some(Self { day, day_of_year, month, minute: 60 * hour + minute })
    }

    /// Reads `2026-07-14 13:00`, with or without a `T`, seconds and a time zone, which is ignored.
    fn parse(text: &str) -> Option<Self> {
        let (date, time) = text.split_once(['T', ' '])?;
        let mut numbers = date.split('-').chain(time.split(':').take(2)).map(|part| part.trim().parse().ok());
        let parts = [(); 5].map(|()| numbers.next().flatten());
        Self::new([parts[0]?, parts[1]?, parts[2]?, parts[3]?, parts[4]?])
    }

    fn seconds_since(self, first: Self) -> f64 {
        (86_400 * (self.day - first.day) + 60 * (i64::from(self.minute) - i64::from(first.minute))) as f64
    }
}

/// The columns of a form, and the factors that take them to SI units.
struct Form {
    time: [usize; 4],
    temperature: usize,
    is_fahrenheit: bool,
    humidity: usize,
    speed: usize,
    mps_at_10_m: f64,
    from: usize,
    rain: usize,
    mm: f64,
    solar: Option<usize>,
    cloud: Option<usize>,
}

impl WeatherStream {
    /// # Errors
    /// Returns a sentence with the path and the line of what is wrong.
    pub fn read(path: &Path) -> Result<Self, String> {
        let from_20_ft = 1.0 / twenty_foot_wind(1.0);
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("wxs")) {
            let (table, is_english) = read_wxs(path)?;
            let form = Form {
                time: [0, 1, 2, 3],
                temperature: 4,
                is_fahrenheit: is_english,
                humidity: 5,
                rain: 6,
                mm: if is_english { 25.4 } else { 1.0 },
                speed: 7,
                mps_at_10_m: from_20_ft * if is_english { MPS_PER_MPH } else { 1.0 / 3.6 },
                from: 8,
                solar: None,
                cloud: Some(9),
            };
            return Self::from_table(table, &form);
        }
        let table = CsvTable::read(path)?;
        let is_fw21 = table.column("time").is_none() && find(&table, "datetime").is_some();
        let form = if is_fw21 {
            let column = |start: &str| {
                find(&table, start).ok_or_else(|| {
                    format!("{}: line 1: no column {start}; it has {}", table.name, table.names.join(","))
                })
            };
            let (temperature, speed, rain) = (column("temperature")?, column("windspeed")?, column("precip")?);
            let unit = |column: usize, unit: &str| bare(&table.names[column]).ends_with(unit);
            Form {
                time: [column("datetime")?; 4],
                temperature,
                is_fahrenheit: !unit(temperature, "c"),
                humidity: column("relativehumidity")?,
                speed,
                mps_at_10_m: from_20_ft
                    * if unit(speed, "kmh") || unit(speed, "kph") { 1.0 / 3.6 } else { MPS_PER_MPH },
                from: column("windazimuth")?,
                rain,
                mm: if unit(rain, "mm") { 1.0 } else { 25.4 },
                solar: Some(column("solarradiation")?),
                cloud: None,
            }
        } else {
            let (solar, cloud) = (table.column("solar_w_m2"), table.column("cloud_pct"));
            let solar = if cloud.is_none() { Some(table.required("solar_w_m2")?) } else { solar };
            Form {
                time: [table.required("time")?; 4],
                temperature: table.required("temperature_c")?,
                is_fahrenheit: false,
                humidity: table.required("humidity_pct")?,
                speed: table.required("speed_mps")?,
                mps_at_10_m: 1.0,
                from: table.required("from_deg")?,
                rain: table.required("rain_mm")?,
                mm: 1.0,
                solar,
                cloud,
            }
        };
        Self::from_table(table, &form)
    }

    fn from_table(table: CsvTable, form: &Form) -> Result<Self, String> {
        let mut rows: Vec<StreamRow> = Vec::with_capacity(table.rows.len());
        for row in &table.rows {
            let at = clock(&table, row, form.time)?;
            let at_s = rows.first().map_or(0.0, |first| at.seconds_since(first.at));
            if rows.last().is_some_and(|before| at_s <= before.at_s) {
                return Err(table.wrong(row, form.time[3], "a time after that of the previous row"));
            }
            let number = |column, least, most| table.number(row, column, least, most);
            let degrees = number(form.temperature, -80.0, 150.0)?;
            let speed_mps = number(form.speed, 0.0, 1000.0)? * form.mps_at_10_m;
            if speed_mps > MAX_WIND_MPS {
                return Err(table.wrong(row, form.speed, &format!("at most {MAX_WIND_MPS} m/s at 10 m")));
            }
            let sun = match (form.solar, form.cloud) {
                (Some(solar), _) => Sun::Radiation(number(solar, 0.0, 2000.0)?),
                (None, Some(cloud)) => Sun::Cloud(number(cloud, 0.0, 100.0)? / 100.0),
                (None, None) => Sun::Radiation(0.0),
            };
            rows.push(StreamRow {
                line: row.line,
                at,
                at_s,
                temperature_c: if form.is_fahrenheit { (degrees - 32.0) / 1.8 } else { degrees },
                humidity: number(form.humidity, 0.0, 100.0)? / 100.0,
                speed_mps,
                from_deg: number(form.from, -360.0, 360.0)?,
                rain_mm: number(form.rain, 0.0, 1000.0)? * form.mm,
                sun,
            });
        }
        Ok(Self { name: table.name, rows })
    }

    /// Returns the rows that hold in a run, and the second of the run from which each does.
    fn in_run(&self, start_h: f64) -> Result<impl Iterator<Item = (usize, f64)>, String> {
        let start_s = 3600.0 * start_h;
        let last_s = self.rows.last().map_or(0.0, |row| row.at_s);
        if start_s > last_s {
            let hours = last_s / 3600.0;
            return Err(format!("{}: it has {hours} hours; expected more than `start_h`, {start_h}", self.name));
        }
        let first = self.rows.partition_point(|row| row.at_s <= start_s) - 1;
        Ok((first..self.rows.len()).map(move |row| (row, (self.rows[row].at_s - start_s).max(0.0))))
    }

    /// Returns the changes of the wind in a run that starts so many hours after the first row.
    pub fn winds(&self, start_h: f64) -> Result<Vec<WindChange>, String> {
        let change = |(row, at_s): (usize, f64)| {
            let StreamRow { speed_mps, from_deg, .. } = self.rows[row];
            WindChange { at_s, speed_mps, toward_deg: house_angle(from_deg) }
        };
        Ok(self.in_run(start_h)?.map(change).collect())
    }

    /// Returns the changes of the moisture in a run; live fuel keeps its own.
    pub fn moistures(&self, settings: &WeatherSettings, usual: &FuelMoisture) -> Result<Vec<MoistureChange>, String> {
        let dead = match settings.dead_moisture {
            DeadMoisture::Fixed => vec![[usual.d1, usual.d10, usual.d100]; self.rows.len()],
            DeadMoisture::Tables => self.rows.iter().map(StreamRow::by_tables).collect(),
            DeadMoisture::Nelson => self.by_sticks(settings.latitude_deg)?,
        };
        let change = |(row, at_s): (usize, f64)| {
            let [d1, d10, d100] = dead[row];
            MoistureChange { at_s, d1, d10, d100, herb: usual.herb, woody: usual.woody }
        };
        Ok(self.in_run(settings.start_h)?.map(change).collect())
    }

    fn by_sticks(&self, latitude_deg: Option<f64>) -> Result<Vec<[f64; 3]>, String> {
        let mut sticks = [0, 1, 2].map(|class| Stick::new(SIZES[class]));
        let mut moistures = Vec::with_capacity(self.rows.len());
        for (number, row) in self.rows.iter().enumerate() {
            let is_hourly = number == 0 || row.at_s - self.rows[number - 1].at_s == 3600.0;
            if !is_hourly {
                let line = row.line;
                return Err(format!("{}: line {line}: expected an hour after the previous row, for sticks", self.name));
            }
            let solar_w_m2 = match (row.sun, latitude_deg) {
                (Sun::Radiation(solar), _) => solar,
                (Sun::Cloud(cloud), Some(latitude_deg)) => row.at.clear_sky_w_m2(latitude_deg) * through(cloud),
                (Sun::Cloud(_), None) => {
                    let expected = "expected `weather.latitude_deg`, for the sun above them";
                    return Err(format!("{}: it has clouds and no radiation; {expected}", self.name));
                }
            };
            let (temperature_c, humidity) = (row.temperature_c, row.humidity.max(0.01));
            let air = Air { temperature_c, humidity, solar_w_m2, rain_cm: row.rain_mm / 10.0 };
            moistures.push(sticks.each_mut().map(|stick| {
                stick.advance_hour(&air);
                stick.median_moisture()
            }));
        }
        Ok(moistures)
    }
}

impl StreamRow {
    fn by_tables(&self) -> [f64; 3] {
        let hour = self.at.minute / 60 % 24;
        let fine = fine_dead_moisture(self.temperature_c, self.humidity, self.at.month, hour);
        [fine, fine + 0.01, fine + 0.02]
    }
}

impl Clock {
    /// Returns the radiation of a clear sky (Haurwitz 1945), the sun's height from its declination (Cooper 1969).
    fn clear_sky_w_m2(self, latitude_deg: f64) -> f64 {
        let declination = 23.45_f64.to_radians() * ops::sin(TAU * f64::from(284 + self.day_of_year) / 365.0);
        let hour_angle = TAU * (f64::from(self.minute) / 1440.0 - 0.5);
        let (sin, cos) = ops::sin_cos(latitude_deg.to_radians());
        let height = sin * ops::sin(declination) + cos * ops::cos(declination) * ops::cos(hour_angle);
        if height > 0.0 { 1098.0 * height * ops::exp(-0.057 / height) } else { 0.0 }
    }
}

/// Returns the part of the sun that comes through clouds (Kasten and Czeplak 1980).
fn through(cloud: f64) -> f64 {
    1.0 - 0.75 * ops::pow(cloud, 3.4)
}

/// Returns a name without what is no letter, in small ones.
fn bare(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphabetic).map(|letter| letter.to_ascii_lowercase()).collect()
}

fn find(table: &CsvTable, start: &str) -> Option<usize> {
    table.names.iter().position(|name| bare(name).starts_with(start))
}

/// Reads the time of a row from one column, or from those of year, month, day and `hhmm`.
fn clock(table: &CsvTable, row: &CsvRow, columns: [usize; 4]) -> Result<Clock, String> {
    if columns[0] == columns[3] {
        let expected = "a time such as 2026-07-14 13:00";
        return Clock::parse(table.cell(row, columns[0])).ok_or_else(|| table.wrong(row, columns[0], expected));
    }
    let mut numbers = [0; 4];
    for (number, (column, most)) in numbers.iter_mut().zip(columns.into_iter().zip([2200.0, 12.0, 31.0, 2400.0])) {
        *number = table.number(row, column, 0.0, most)? as u32;
    }
    let [year, month, day, time] = numbers;
    let clock = Clock::new([year, month, day, time / 100, time % 100]);
    clock.ok_or_else(|| table.wrong(row, columns[3], "a time of a day that exists, as hhmm"))
}

/// Reads the rows of a `.wxs` file, and whether their units are English.
fn read_wxs(path: &Path) -> Result<(CsvTable, bool), String> {
    let (name, text) = (path.display().to_string(), read_text(path)?);
    let mut is_english = true;
    for (index, line) in text.lines().enumerate() {
        if let Some(unit) = line.trim().strip_prefix("RAWS_UNITS:") {
            is_english = match unit.trim().to_ascii_lowercase().as_str() {
                "english" => true,
                "metric" => false,
                _ => return Err(format!("{name}: line {}: expected the units English or Metric", index + 1)),
            };
        }
    }
    let is_row = |line: &str| line.trim_start().starts_with(|first: char| first.is_ascii_digit());
    let cells = |line: &str| line.split_whitespace().map(str::to_owned).collect();
    let rows = text.lines().enumerate().filter(|(_, line)| is_row(line)).map(|(at, line)| (at + 1, cells(line)));
    Ok((CsvTable::from_rows(name, WXS.map(str::to_owned).to_vec(), rows)?, is_english))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: &str, text: &str) -> Result<WeatherStream, String> {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join(file);
        std::fs::write(&path, text).expect("writable");
        WeatherStream::read(&path)
    }

    const CSV: &str = "time,temperature_c,humidity_pct,speed_mps,from_deg,rain_mm,cloud_pct\n\
                       2026-12-31 23:00,10,50,2.3,270,0,0\n2027-01-01T00:00,5,80,1.15,180,2.54,100\n";
    const FW21: &str = "StationID,DateTime,Temperature(F),RelativeHumidity(%),Precipitation(in),WindSpeed(mph),\
                        WindAzimuth(degrees),SolarRadiation(W/m2)\n\
                        1,2026-12-31T23:00:00-07:00,50,50,0,4.4739,270,0\n1,2027-01-01T00:00:00-07:00,41,80,0.1,2.23694,180,0\n";
    const WXS_TEXT: &str = "RAWS_ELEVATION: 500\nRAWS_UNITS: English\nRAWS: 2\nYear Mth Day Time Temp RH Rain Spd Dir Cld\n\
                            2026 12 31 2300 50 50 0.0 4.4739 270 0\n2027 1 1 0000 41 80 0.1 2.23694 180 100\n";

    #[test]
    fn three_forms_say_the_same() {
        for (file, text) in [("weather.csv", CSV), ("weather.fw21", FW21), ("weather.wxs", WXS_TEXT)] {
            let stream = read(file, text).expect("it is right");
            let [first, second] = &stream.rows[..] else { panic!("{file} has two rows") };
            assert_eq!((first.at_s, second.at_s, second.from_deg), (0.0, 3600.0, 180.0), "{file}");
            for (found, expected) in [
                (first.temperature_c, 10.0),
                (second.temperature_c, 5.0),
                (first.humidity, 0.5),
                (first.speed_mps, 2.3),
                (second.speed_mps, 1.15),
                (second.rain_mm, 2.54),
            ] {
                assert!((found - expected).abs() < 1e-4, "{file}: {found}, expected {expected}");
            }
            let winds = stream.winds(0.5).expect("it starts within");
            let found: Vec<_> = winds.iter().map(|wind| (wind.at_s, wind.toward_deg)).collect();
            assert_eq!(found, [(0.0, 0.0), (1800.0, 90.0)]);
            assert!(stream.winds(1.5).expect_err("it ends before").contains("it has 1 hours"));
        }
    }

    #[test]
    fn days_are_dry_and_nights_are_moist_by_tables_and_by_sticks() {
        let row = |hour: u32| {
            let is_day = (8..20).contains(&(hour % 24));
            let [temperature, humidity, solar] = if is_day { [30, 20, 700] } else { [12, 80, 0] };
            format!("2026-07-{:02} {:02}:00,{temperature},{humidity},3,270,0,{solar}\n", 1 + hour / 24, hour % 24)
        };
        let text = "time,temperature_c,humidity_pct,speed_mps,from_deg,rain_mm,solar_w_m2\n".to_owned()
            + &(0..72).map(row).collect::<String>();
        let stream = read("weather.csv", &text).expect("it is right");
        for dead_moisture in [DeadMoisture::Tables, DeadMoisture::Nelson] {
            let settings = WeatherSettings { dead_moisture, start_h: 36.0, ..WeatherSettings::default() };
            let found = stream.moistures(&settings, &FuelMoisture::default()).expect("it is hourly");
            // It starts at noon; the last hour of night is 19 hours later.
            let (noon, night) = (&found[2], &found[19]);
            assert_eq!((found.len(), night.at_s), (36, 19.0 * 3600.0));
            assert!(noon.d1 < 0.08 && night.d1 > 0.12 && noon.d1 < noon.d10, "{dead_moisture:?}: {noon:?} {night:?}");
        }
        let holed = text.replace("2026-07-02 05:00", "2026-07-02 05:30");
        let settings = WeatherSettings { dead_moisture: DeadMoisture::Nelson, ..WeatherSettings::default() };
        let error = read("weather.csv", &holed).expect("it is right").moistures(&settings, &FuelMoisture::default());
        assert!(error.expect_err("it is not hourly").contains("line 31: expected an hour after"));
    }

    #[test]
    fn what_no_stream_says_is_refused_with_its_line() {
        for (file, text, expected) in [
            (
                "a.csv",
                CSV.replace("2027-01-01T00:00", "2026-02-29 12:00"),
                "line 3: `time` is 2026-02-29 12:00, expected",
            ),
            (
                "a.csv",
                CSV.replace("2027-01-01T00:00", "2026-12-31 23:00"),
                "expected a time after that of the previous",
            ),
            ("a.csv", CSV.replace("cloud_pct", "clouds"), "no column `solar_w_m2`"),
            ("a.csv", CSV.replace(",80,", ",180,"), "`humidity_pct` is 180, expected a number from 0 to 100"),
            ("a.fw21", FW21.replace("WindAzimuth", "Azimuth"), "no column windazimuth"),
            ("a.wxs", WXS_TEXT.replace("English", "Feet"), "line 2: expected the units English or Metric"),
            ("a.wxs", WXS_TEXT.replace("2027 1 1", "2027 0 1"), "expected a time of a day that exists"),
            ("a.wxs", "RAWS: 0\n".to_owned(), "it has no row"),
        ] {
            let error = read(file, &text).err().expect("it is wrong");
            assert!(error.contains(expected), "{error}");
        }
        let settings = WeatherSettings { dead_moisture: DeadMoisture::Nelson, ..WeatherSettings::default() };
        let clouds = read("a.csv", CSV).expect("it is right").moistures(&settings, &FuelMoisture::default());
        assert!(clouds.expect_err("it has no latitude").contains("expected `weather.latitude_deg`"));
        // At 40 degrees north on 21 June the sun of noon is 73 degrees high.
        let noon = Clock::parse("2026-06-21 12:00").expect("it is a time").clear_sky_w_m2(40.0);
        assert!((noon - 990.0).abs() < 10.0 && through(1.0) == 0.25, "{noon}");
    }
}
