//! Weather in CSV files: a first line of names, then rows of numbers; columns may come in any order among others.
//!
//! Directions are compass azimuths from which the wind blows, as weather stations give them.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::wind::{MAX_WIND_MPS, WindChange};
use crate::faults::check::MAX_CHANGES;
use wildfire_base::input_file;
use wildfire_base::untrusted::visible_start;
use wildfire_fire::surface::FuelMoisture;

/// The most bytes of a file: a century by the hour.
const MAX_BYTES: u64 = 128_000_000;

/// Weather that a run may have for all its time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WeatherSample {
    /// Speed in m/s at 10 m, and where the wind blows to, degrees counter-clockwise from east.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wind: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moisture: Option<FuelMoisture>,
}

/// Reads changes of the wind up to a second of the run, `t_s,speed_mps,from_deg`.
///
/// # Errors
/// Returns a sentence with the path and the line of what is wrong.
pub(crate) fn read_wind(path: &Path, end_s: f64) -> Result<Vec<WindChange>, String> {
    let text = read_text(path)?;
    let table = CsvTable::new(path, &text)?;
    let [at, speed, from] = table.required(["t_s", "speed_mps", "from_deg"])?;
    let mut changes: Vec<WindChange> = Vec::new();
    for row in table.rows() {
        let row = row?;
        let at_s = table.number(&row, at, 0.0, 1e9)?;
        // Two changes at one time would leave open which of them holds.
        if let Some(before) = changes.last().filter(|before| at_s <= before.at_s) {
            return Err(table.wrong(
                &row,
                at,
                &format!("a time after {} s, the time of the previous row", before.at_s),
            ));
        }
        // Rows beyond the run are not read, and may hold anything.
        if at_s > end_s {
            break;
        }
        table.check_count(changes.len() + 1)?;
        let speed_mps = table.number(&row, speed, 0.0, MAX_WIND_MPS)?;
        let toward_deg = house_angle(table.number(&row, from, -360.0, 360.0)?);
        changes.push(WindChange::uniform(at_s, speed_mps, toward_deg));
    }
    Ok(changes)
}

/// Reads weathers of which each run has one.
///
/// # Errors
/// Returns a sentence with the path and the line of what is wrong.
pub(crate) fn read_samples(path: &Path) -> Result<Vec<WeatherSample>, String> {
    let text = read_text(path)?;
    let table = CsvTable::new(path, &text)?;
    let wind = table.together(["speed_mps", "from_deg"])?;
    let moisture = table.together(["d1", "d10", "d100", "herb", "woody"])?;
    if wind.is_none() && moisture.is_none() {
        let expected = "columns speed_mps,from_deg or d1,d10,d100,herb,woody or all of them";
        return Err(format!("{}: line 1: found {}, expected {expected}", table.name, table.names.join(",")));
    }
    let sample = |row: &CsvRow<'_>| -> Result<WeatherSample, String> {
        let wind = match wind {
            None => None,
            Some([speed, from]) => {
                let from_deg = table.number(row, from, -360.0, 360.0)?;
                Some([table.number(row, speed, 0.0, MAX_WIND_MPS)?, house_angle(from_deg)])
            }
        };
        let moisture = match moisture {
            None => None,
            Some([d1, d10, d100, herb, woody]) => Some(FuelMoisture {
                d1: table.number(row, d1, 0.0, 1.0)?,
                d10: table.number(row, d10, 0.0, 1.0)?,
                d100: table.number(row, d100, 0.0, 1.0)?,
                // Living fuel may hold several times its dry weight in water.
                herb: table.number(row, herb, 0.0, 5.0)?,
                woody: table.number(row, woody, 0.0, 5.0)?,
            }),
        };
        Ok(WeatherSample { wind, moisture })
    };
    let mut samples = Vec::new();
    for row in table.rows() {
        samples.push(sample(&row?)?);
        // Refused at the first row too many, and not after the last one.
        table.check_count(samples.len())?;
    }
    Ok(samples)
}

/// Reads the text of a file of weather.
pub(crate) fn read_text(path: &Path) -> Result<String, String> {
    input_file::read_text(path, MAX_BYTES).map_err(|error| format!("{}: {error}", path.display()))
}

/// Returns the angle in [0, 360), counter-clockwise from east, to which a wind from an azimuth blows.
pub(crate) fn house_angle(from_deg: f64) -> f64 {
    (270.0 - from_deg).rem_euclid(360.0)
}

/// A file whose rows are read one by one, as it may be long.
pub(crate) struct CsvTable<'a> {
    pub name: String,
    pub names: Vec<&'a str>,
    /// `None` for any number of blanks and tabs.
    separator: Option<char>,
    /// The lines after the first ones.
    body: &'a str,
    body_line: usize,
}

pub(crate) struct CsvRow<'a> {
    pub line: usize,
    text: &'a str,
    separator: Option<char>,
}

impl<'a> CsvTable<'a> {
    /// Creates the table of a text that begins with a line of names, separated by commas, semicolons or tabs.
    pub fn new(path: &Path, text: &'a str) -> Result<Self, String> {
        let (line, first) = text
            .lines()
            .enumerate()
            .find(|(_, line)| !line.trim().is_empty() && !line.starts_with("sep="))
            .ok_or_else(|| format!("{}: it is empty; expected a line of names and rows", path.display()))?;
        let separator = [',', ';', '\t'].into_iter().find(|&sign| first.contains(sign)).unwrap_or(',');
        Self::with_names(path, cells(first, Some(separator)).collect(), Some(separator), text, line + 1)
    }

    /// Creates the table of the rows after a number of lines.
    pub fn with_names(
        path: &Path,
        names: Vec<&'a str>,
        separator: Option<char>,
        text: &'a str,
        skipped: usize,
    ) -> Result<Self, String> {
        // Line ends are kept, so that lengths of lines add up to a place in the text.
        let body = text.split_inclusive('\n').skip(skipped).map(str::len).sum::<usize>();
        let body = &text[text.len() - body..];
        let name = path.display().to_string();
        if body.trim().is_empty() {
            return Err(format!("{name}: it has no row after its header"));
        }
        Ok(Self { name, names, separator, body, body_line: skipped + 1 })
    }

    /// Returns the rows, or what is wrong with the first line that is none.
    pub fn rows(&self) -> impl Iterator<Item = Result<CsvRow<'a>, String>> {
        let lines = self.body.lines().enumerate().filter(|(_, text)| !text.trim().is_empty());
        lines.map(|(index, text)| {
            let row = CsvRow { line: self.body_line + index, text, separator: self.separator };
            let found = cells(text, self.separator).count();
            let expected = self.names.len();
            if found == expected {
                return Ok(row);
            }
            let place = format!("{}: line {}", self.name, row.line);
            Err(format!("{place}: it has {found} cells, expected {expected} as in the first line"))
        })
    }

    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|&found| found == name)
    }

    /// Finds columns, or names all that are missing.
    pub fn required<const N: usize>(&self, names: [&str; N]) -> Result<[usize; N], String> {
        let missing: Vec<_> = names.into_iter().filter(|name| self.column(name).is_none()).collect();
        if missing.is_empty() {
            Ok(names.map(|name| self.column(name).unwrap_or_default()))
        } else {
            Err(self.lacks(&missing))
        }
    }

    /// Words that columns are missing.
    pub fn lacks(&self, missing: &[&str]) -> String {
        let columns = if missing.len() == 1 { "column" } else { "columns" };
        let missing = missing.join("`, `");
        let found = visible_start(&self.names.join(","));
        format!("{}: line 1: no {columns} `{missing}`; it has {found}", self.name)
    }

    /// Finds columns that are all there or not at all.
    fn together<const N: usize>(&self, names: [&str; N]) -> Result<Option<[usize; N]>, String> {
        if names.iter().all(|name| self.column(name).is_none()) { Ok(None) } else { self.required(names).map(Some) }
    }

    /// Refuses more rows than a run keeps.
    pub fn check_count(&self, kept: usize) -> Result<(), String> {
        let name = &self.name;
        if kept <= MAX_CHANGES {
            Ok(())
        } else {
            Err(format!("{name}: a run would keep more than {MAX_CHANGES} rows of it"))
        }
    }

    pub fn number(&self, row: &CsvRow<'_>, column: usize, min: f64, max: f64) -> Result<f64, String> {
        let number = row.cell(column).parse::<f64>().ok().filter(|number| (min..=max).contains(number));
        // The sign of a zero says nothing.
        number
            .map(|number| number + 0.0)
            .ok_or_else(|| self.wrong(row, column, &format!("a number from {min} to {max}")))
    }

    pub fn wrong(&self, row: &CsvRow<'_>, column: usize, expected: &str) -> String {
        let found = match row.cell(column) {
            "" => "empty".to_owned(),
            cell => visible_start(cell),
        };
        format!("{}: line {}: `{}` is {found}, expected {expected}", self.name, row.line, self.names[column])
    }
}

impl<'a> CsvRow<'a> {
    pub fn cell(&self, column: usize) -> &'a str {
        cells(self.text, self.separator).nth(column).expect("rows have a cell for each name")
    }
}

/// Returns the cells of a line, without the blanks and the quotes around them.
fn cells(line: &str, separator: Option<char>) -> impl Iterator<Item = &str> {
    // Blanks in a row separate only once.
    let line = if separator.is_none() { line.trim() } else { line };
    line.split(move |sign: char| separator.map_or(sign.is_whitespace(), |separator| sign == separator))
        .map(|cell| cell.trim().trim_matches('"').trim())
        .filter(move |cell| separator.is_some() || !cell.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("weather.csv");
        std::fs::write(&path, text).expect("writable");
        (folder, path)
    }

    #[test]
    fn winds_come_from_where_they_blow() {
        let (_folder, path) =
            file("from_deg, t_s ,speed_mps,note\r\n270,0,2.5,west\n\n180,4800,3,south\n0,5000,4,beyond the run\n");
        let changes = read_wind(&path, 4800.0).expect("it is right");
        let found: Vec<_> = changes.iter().map(|it| (it.at_s, it.speed_mps, it.toward_deg)).collect();
        assert_eq!(found, [(0.0, 2.5, 0.0), (4800.0, 3.0, 90.0)]);
    }

    #[test]
    fn wrong_rows_are_reported_with_their_line() {
        for (text, expected) in [
            ("t_s,speed_mps,from_deg\n0,1,2\n0,1,2\n", "line 3: `t_s` is 0, expected a time after 0 s"),
            ("t_s,speed_mps,from_deg\n0,fast,2\n", "line 2: `speed_mps` is fast, expected a number from 0 to 150"),
            ("t_s,speed_mps,from_deg\n0,1\n", "line 2: it has 2 cells, expected 3"),
            ("t_s,speed,from_deg\n0,1,2\n", "line 1: no column `speed_mps`; it has t_s,speed,from_deg"),
            ("t_s,speed,from\n0,1,2\n", "line 1: no columns `speed_mps`, `from_deg`; it has t_s,speed,from"),
            ("t_s;speed_mps;from_deg\n0;;2\n", "line 2: `speed_mps` is empty, expected a number from 0 to 150"),
            ("t_s,speed_mps,from_deg\n", "it has no row"),
            ("", "it is empty"),
        ] {
            let (_folder, path) = file(text);
            let found = read_wind(&path, 3600.0).expect_err("it is wrong");
            assert!(found.contains(expected) && found.contains("weather.csv: "), "{found}");
        }
    }

    #[test]
    fn samples_give_wind_or_moisture_or_both() {
        let (_folder, path) = file("speed_mps,from_deg,d1,d10,d100,herb,woody\n4,90,0.05,0.06,0.07,0.5,0.9\n");
        let [sample] = read_samples(&path).expect("it is right")[..] else { panic!("it has one row") };
        assert_eq!(sample.wind, Some([4.0, 180.0]));
        assert_eq!(sample.moisture.map(|moisture| moisture.d100), Some(0.07));
        let (_folder, path) = file("d1,d10\n0.1,0.1\n");
        assert!(read_samples(&path).expect_err("d100 is missing").contains("no columns `d100`, `herb`, `woody`"));
        let (_folder, path) = file("a,b\n0.1,0.1\n");
        assert!(read_samples(&path).expect_err("nothing is there").contains("expected columns speed_mps,from_deg or"));
        let (_folder, path) = file("d1,d10,d100,herb,woody\n0.1,0.1,0.1,60,90\n");
        assert!(
            read_samples(&path).expect_err("these are percent").contains("`herb` is 60, expected a number from 0 to 5")
        );
    }
}
