//! Lengths and words of many pairs of poses, from one table to another.

use std::io::{self, Write};
use std::path::Path;

use crate::cli::curve::pair_table::{Fault, PairTable};
use crate::cli::error::CliError;
use crate::vehicle::{Dubins, ReedsShepp};
use crate::whole_file::WholeFile;

/// Columns that are written after all that are there.
pub const ADDED: [&str; 4] = ["reeds_shepp_m", "reeds_shepp_word", "dubins_m", "dubins_word"];

/// Writes the rows of a table of pairs, each with the lengths and words of its shortest curves after its own columns,
/// which stay as they are; tells how many rows.
///
/// Numbers are the shortest decimals that read back as the same `f64`. A row is read, written and forgotten before the
/// next.
pub fn write_lengths(input: &Path, output: &Path, radius_m: f64) -> Result<u64, CliError> {
    let bad = |fault: Fault| CliError::from_input_error(format_args!("{}: {fault}", input.display()), fault.kind());
    let unwritable = |error: io::Error| CliError::unwritable(output, &error);
    let (reeds_shepp, dubins) = (ReedsShepp { radius_m }, Dubins { radius_m });
    let mut pairs = PairTable::open(input, &ADDED).map_err(bad)?;
    let mut table = WholeFile::create(output).map_err(unwritable)?;
    write_row(&mut table, pairs.row(), format_args!("{}", ADDED.join(","))).map_err(unwritable)?;
    let mut rows = 0;
    while let Some((from, to)) = pairs.next().map_err(bad)? {
        let (best, forward) = (reeds_shepp.shortest(from, to), dubins.shortest(from, to));
        let added = format_args!("{},{},{},{}", best.length_m, best.word, forward.length_m, forward.word);
        write_row(&mut table, pairs.row(), added).map_err(unwritable)?;
        rows += 1;
    }
    table.finish().map_err(unwritable)?;
    Ok(rows)
}

fn write_row(table: &mut WholeFile, row: &[u8], added: std::fmt::Arguments) -> io::Result<()> {
    table.write_all(row)?;
    writeln!(table, ",{added}")
}
