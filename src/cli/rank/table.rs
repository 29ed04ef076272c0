//! A ranking as a CSV file: a row for each entry.

use std::io;
use std::path::Path;

use wildfire_base::object;
use wildfire_base::untrusted::spreadsheet_cell;
use wildfire_base::whole_file::WholeFile;
use wildfire_batch::comparison::Ranking;
use wildfire_batch::stats::Interval;

/// Writes the columns in their order; those of the difference from the first are empty in its own row.
pub fn write(path: &Path, ranking: &Ranking) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(WholeFile::create(path)?);
    for (place, entry) in ranking.entries.iter().enumerate() {
        let pair = ranking.pair(0, place);
        let [less_first_low, less_first_high] = Interval::ends(pair.and_then(|pair| pair.contrast.interval));
        writer.serialize(object!(Entry {
            place: place + 1,
            entry: spreadsheet_cell(&entry.name),
            planner: spreadsheet_cell(&entry.planner),
            rank_from: entry.ranks[0],
            rank_to: entry.ranks[1],
            groups: entry.groups.as_deref().unwrap_or_default(),
            metric: spreadsheet_cell(&ranking.metric.name),
            mean: entry.mean,
            less_first: pair.map(|pair| pair.contrast.difference),
            less_first_low,
            less_first_high,
            p_adjusted: pair.and_then(|pair| pair.p_adjusted),
            p_method: pair.map(|pair| pair.contrast.p_method.name()),
            runs: entry.runs,
            failed_runs: entry.failed,
            runs_without_value: entry.without_value,
            drives: entry.queries.drives,
            failed_queries: entry.queries.failed,
            rescued_drives: entry.queries.rescued,
            timed_out_queries: entry.queries.timed_out,
            depends_on_machine: entry.queries.depends_on_machine(),
            policy_asks: entry.queries.asks,
            failed_asks: entry.queries.failed_asks,
        }))?;
    }
    writer.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
}
