//! A comparison as a CSV file: a row for each metric of each side.

use std::borrow::Cow;
use std::io;
use std::path::Path;

use serde::Serialize;

use wildfire_base::untrusted::spreadsheet_cell;
use wildfire_base::whole_file::WholeFile;
use wildfire_batch::comparison::Comparison;

/// The columns in their order; a difference without an interval or a test has these empty.
#[derive(Serialize)]
struct DifferenceRow<'a> {
    side: char,
    against: char,
    metric: Cow<'a, str>,
    unit: &'static str,
    pairs: usize,
    mean_a: f64,
    mean: f64,
    difference: f64,
    low: Option<f64>,
    high: Option<f64>,
    percent_of_a: Option<f64>,
    p_adjusted: Option<f64>,
    p_method: &'static str,
}

pub fn write(path: &Path, comparison: &Comparison) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(WholeFile::create(path)?);
    for against in &comparison.against_a {
        for judged in &against.judged {
            let contrast = &judged.contrast;
            let [mean_a, mean] = contrast.means;
            writer.serialize(DifferenceRow {
                side: against.letter,
                against: 'A',
                metric: spreadsheet_cell(&contrast.metric.name),
                unit: contrast.metric.unit.symbol(),
                pairs: contrast.pairs,
                mean_a,
                mean,
                difference: contrast.difference,
                low: contrast.interval.map(|interval| interval.low),
                high: contrast.interval.map(|interval| interval.high),
                percent_of_a: (mean_a != 0.0).then(|| 100.0 * contrast.difference / mean_a.abs()),
                p_adjusted: judged.p_adjusted,
                p_method: contrast.p_method.name(),
            })?;
        }
    }
    writer.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
}
