//! A report as a few lines for people, with the values themselves where they fit on a terminal.

use std::time::Duration;

use crate::cli::map::report::MapReport;
use crate::cli::map::values::Value;
use crate::map_files::NEAR_TOLERANCE;

/// The size of a terminal that shows all values.
const MAX_WIDTH: usize = 80;
const MAX_ROWS: usize = 40;

/// Size, sentences, the largest value, CPU time.
pub fn to_text(report: &MapReport) -> String {
    let mut lines = vec![size(report)];
    lines.extend(near_tolerance(report));
    lines.push(value(report));
    lines.extend(report.sentences());
    lines.push(cpu(report));
    lines.join("\n") + "\n"
}

fn size(report: &MapReport) -> String {
    let (path, map) = (report.path.display(), &report.map.occupied);
    let (cells, occupied) = (report.cells(), report.occupied_cells);
    let share = 100.0 * occupied as f64 / cells as f64;
    format!("{path}: {} rows x {} columns, {cells} cells, {occupied} occupied ({share:.1} %)", map.rows(), map.cols())
}

/// Says how much of an image the tolerance hardly separates.
fn near_tolerance(report: &MapReport) -> Option<String> {
    let (percent, tolerance) = (100.0 * report.near_tolerance()?, report.tolerance()?);
    Some(format!("Tolerance {tolerance}: {percent:.1} % of the pixels within {NEAR_TOLERANCE} grey levels of it"))
}

fn value(report: &MapReport) -> String {
    let computed = report.computed;
    let max = computed.values.max().map_or("none".to_owned(), Value::to_text);
    let unreached = computed.unreached.map(|cells| format!(", free cells unreached {cells}"));
    format!("{}: maximum {max}{}", computed.title, unreached.unwrap_or_default())
}

fn cpu(report: &MapReport) -> String {
    let ms = |cpu: Duration| format!("{:.3} ms", cpu.as_secs_f64() * 1e3);
    let path = report.computed.cpu_path.map(|cpu| format!(", path {}", ms(cpu)));
    format!("CPU: reading {}, map {}{}", ms(report.cpu_read), ms(report.computed.cpu_map), path.unwrap_or_default())
}

/// All values in rows and columns, those on the way with a star before them; `None` if they would not fit.
pub fn values(report: &MapReport) -> Option<String> {
    let (rows, cols) = (report.map.occupied.rows(), report.map.occupied.cols());
    if rows > MAX_ROWS || cols > MAX_WIDTH {
        return None;
    }
    let places = (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col)));
    let mut texts: Vec<_> = places.map(|place| report.computed.values.at(place).to_short_text()).collect();
    let width = 1 + texts.iter().map(String::len).max().unwrap_or(0);
    for &(row, col) in report.way().unwrap_or_default() {
        let text = &mut texts[row * cols + col];
        if !text.starts_with('*') {
            text.insert(0, '*');
        }
    }
    let line = |row: &[String]| row.iter().map(|text| format!("{text:>width$}")).collect::<String>() + "\n";
    (width * cols <= MAX_WIDTH).then(|| texts.chunks(cols).map(line).collect())
}
