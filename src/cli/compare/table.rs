//! A comparison as a CSV file: a row for each metric of each side.

use std::io;
use std::path::Path;

use wildfire_base::object;
use wildfire_base::untrusted::spreadsheet_cell;
use wildfire_base::whole_file::WholeFile;
use wildfire_batch::comparison::Comparison;
use wildfire_batch::stats::Interval;

/// Writes the columns in their order; a difference without an interval or a test has these empty, and so are the last
/// ones where they were not asked for.
pub fn write(path: &Path, comparison: &Comparison) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(WholeFile::create(path)?);
    for against in &comparison.against_a {
        for judged in &against.judged {
            let contrast = &judged.contrast;
            let [mean_a, mean] = contrast.means;
            let [low, high] = Interval::ends(contrast.interval);
            let power = judged.power;
            let equivalence = judged.equivalence;
            let [equivalence_low, equivalence_high] = Interval::ends(equivalence.map(|found| found.interval));
            writer.serialize(object!(Difference {
                side: against.letter,
                against: 'A',
                metric: spreadsheet_cell(&contrast.metric.name),
                unit: contrast.metric.about.unit.symbol(),
                pairs: contrast.pairs,
                mean_a,
                mean,
                difference: contrast.difference,
                low,
                high,
                // It is a share of the size, so that the sign is that of the difference even where A's mean is negative.
                percent_of_a: (mean_a != 0.0).then(|| 100.0 * contrast.difference / mean_a.abs()),
                p_adjusted: judged.p_adjusted,
                p_method: contrast.p_method.name(),
                power_difference: power.map(|answer| answer.difference),
                power: power.map(|answer| answer.power),
                seeds_needed: power.and_then(|answer| answer.seeds_needed),
                detectable: power.map(|answer| answer.detectable),
                margin: equivalence.map(|found| found.margin),
                equivalence_low,
                equivalence_high,
                equivalence_p: equivalence.map(|found| found.p_value),
            }))?;
        }
    }
    writer.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
}
