//! Weather in CSV files: a first line of names, then rows of numbers; columns may come in any order among others.
//!
//! Directions are compass azimuths from which the wind blows, as weather stations give them.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::check::MAX_CHANGES;
use super::wind::{MAX_WIND_MPS, WindChange};
use wildfire_base::input_file;
use wildfire_base::untrusted::visible_start;
use wildfire_fire::surface::FuelMoisture;

/// The most bytes of a file.
const MAX_BYTES: u64 = 4_000_000;

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

/// Reads changes of the wind, `t_s,speed_mps,from_deg`.
///
/// # Errors
/// Returns a sentence with the path and the line of what is wrong.
pub(super) fn read_wind(path: &Path) -> Result<Vec<WindChange>, String> {
    let table = CsvTable::read(path)?;
    let columns = ["t_s", "speed_mps", "from_deg"].map(|name| table.required(name));
    let [at, speed, from] = columns;
    let (at, speed, from) = (at?, speed?, from?);
    let mut changes: Vec<WindChange> = Vec::with_capacity(table.rows.len());
    for row in &table.rows {
        let at_s = table.number(row, at, 0.0, 1e6)?;
        if let Some(before) = changes.last().filter(|before| at_s <= before.at_s) {
            return Err(table.wrong(row, at, &format!("a time after {} s, the time of the previous row", before.at_s)));
        }
        let speed_mps = table.number(row, speed, 0.0, MAX_WIND_MPS)?;
        let toward_deg = house_angle(table.number(row, from, -360.0, 360.0)?);
        changes.push(WindChange { at_s, speed_mps, toward_deg });
    }
    Ok(changes)
}

/// Reads weathers of which each run has one.
///
/// # Errors
/// Returns a sentence with the path and the line of what is wrong.
pub(super) fn read_samples(path: &Path) -> Result<Vec<WeatherSample>, String> {
    let table = CsvTable::read(path)?;
    let wind = table.together(["speed_mps", "from_deg"])?;
    let moisture = table.together(["d1", "d10", "d100", "herb", "woody"])?;
    if wind.is_none() && moisture.is_none() {
        let expected = "columns speed_mps,from_deg or d1,d10,d100,herb,woody or all of them";
        return Err(format!("{}: line 1: found {}, expected {expected}", table.name, table.names.join(",")));
    }
    let sample = |row: &CsvRow| -> Result<WeatherSample, String> {
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
                herb: table.number(row, herb, 0.0, 5.0)?,
                woody: table.number(row, woody, 0.0, 5.0)?,
            }),
        };
        Ok(WeatherSample { wind, moisture })
    };
    table.rows.iter().map(sample).collect()
}

/// Reads the text of a file of weather.
pub(super) fn read_text(path: &Path) -> Result<String, String> {
    input_file::read_text(path, MAX_BYTES).map_err(|error| format!("{}: {error}", path.display()))
}

/// Returns the angle in [0, 360), counter-clockwise from east, to which a wind from an azimuth blows.
pub(super) fn house_angle(from_deg: f64) -> f64 {
    (270.0 - from_deg).rem_euclid(360.0)
}

/// A file, line by line.
pub(super) struct CsvTable {
    pub name: String,
    pub names: Vec<String>,
    pub rows: Vec<CsvRow>,
}

pub(super) struct CsvRow {
    pub line: usize,
    cells: Vec<String>,
}

impl CsvTable {
    pub fn read(path: &Path) -> Result<Self, String> {
        let name = path.display().to_string();
        let text = read_text(path)?;
        let cells = |line: &str| line.split(',').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let (_, first) =
            lines.next().ok_or_else(|| format!("{name}: it is empty; expected a line of names and rows"))?;
        let names = cells(first);
        Self::from_rows(name, names, lines.map(|(index, line)| (index + 1, cells(line))))
    }

    /// Creates the table of the rows with these lines and cells.
    pub fn from_rows(
        name: String,
        names: Vec<String>,
        lines: impl Iterator<Item = (usize, Vec<String>)>,
    ) -> Result<Self, String> {
        let mut rows = Vec::new();
        for (line, cells) in lines {
            if cells.len() != names.len() {
                let (found, expected) = (cells.len(), names.len());
                return Err(format!(
                    "{name}: line {line}: it has {found} cells, expected {expected} as in the first line"
                ));
            }
            if rows.len() == MAX_CHANGES {
                return Err(format!("{name}: line {line}: more than {MAX_CHANGES} rows"));
            }
            rows.push(CsvRow { line, cells });
        }
        if rows.is_empty() {
            Err(format!("{name}: it has no row after its header"))
        } else {
            Ok(Self { name, names, rows })
        }
    }

    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|found| found == name)
    }

    pub fn required(&self, name: &str) -> Result<usize, String> {
        let missing =
            || format!("{}: line 1: no column `{name}`; it has {}", self.name, visible_start(&self.names.join(",")));
        self.column(name).ok_or_else(missing)
    }

    /// Finds columns that are all there or not at all.
    fn together<const N: usize>(&self, names: [&str; N]) -> Result<Option<[usize; N]>, String> {
        if names.iter().all(|name| self.column(name).is_none()) {
            return Ok(None);
        }
        let mut columns = [0; N];
        for (column, name) in columns.iter_mut().zip(names) {
            *column = self.required(name)?;
        }
        Ok(Some(columns))
    }

    pub fn number(&self, row: &CsvRow, column: usize, least: f64, most: f64) -> Result<f64, String> {
        let number = row.cells[column].parse::<f64>().ok().filter(|number| (least..=most).contains(number));
        // The sign of a zero says nothing.
        number
            .map(|number| number + 0.0)
            .ok_or_else(|| self.wrong(row, column, &format!("a number from {least} to {most}")))
    }

    pub fn cell<'a>(&self, row: &'a CsvRow, column: usize) -> &'a str {
        &row.cells[column]
    }

    pub fn wrong(&self, row: &CsvRow, column: usize, expected: &str) -> String {
        let found = visible_start(&row.cells[column]);
        format!("{}: line {}: `{}` is {found}, expected {expected}", self.name, row.line, self.names[column])
    }
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
        let (_folder, path) = file("from_deg, t_s ,speed_mps,note\r\n270,0,2.5,west\n\n180,4800,3,south\n");
        let changes = read_wind(&path).expect("it is right");
        let found: Vec<_> = changes.iter().map(|it| (it.at_s, it.speed_mps, it.toward_deg)).collect();
        assert_eq!(found, [(0.0, 2.5, 0.0), (4800.0, 3.0, 90.0)]);
    }

    #[test]
    fn wrong_rows_are_told_with_their_line() {
        for (text, expected) in [
            ("t_s,speed_mps,from_deg\n0,1,2\n0,1,2\n", "line 3: `t_s` is 0, expected a time after 0 s"),
            ("t_s,speed_mps,from_deg\n0,fast,2\n", "line 2: `speed_mps` is fast, expected a number from 0 to 150"),
            ("t_s,speed_mps,from_deg\n0,1\n", "line 2: it has 2 cells, expected 3"),
            ("t_s,speed,from_deg\n0,1,2\n", "line 1: no column `speed_mps`; it has t_s,speed,from_deg"),
            ("t_s,speed_mps,from_deg\n", "it has no row"),
            ("", "it is empty"),
        ] {
            let (_folder, path) = file(text);
            let found = read_wind(&path).expect_err("it is wrong");
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
        assert!(read_samples(&path).expect_err("d100 is missing").contains("no column `d100`"));
        let (_folder, path) = file("a,b\n0.1,0.1\n");
        assert!(read_samples(&path).expect_err("nothing is there").contains("expected columns speed_mps,from_deg or"));
        let (_folder, path) = file("d1,d10,d100,herb,woody\n0.1,0.1,0.1,60,90\n");
        assert!(
            read_samples(&path).expect_err("these are percent").contains("`herb` is 60, expected a number from 0 to 5")
        );
    }
}
