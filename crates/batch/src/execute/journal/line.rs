//! A line of a journal: a checksum and JSON.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek, SeekFrom};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::JournalError;
use crate::execute::{RunRow, Status};
use crate::plan::{Record, Slice};

/// Version of the format of journals.
const FORMAT: u32 = 1;

/// The first line, which identifies the journal.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    format: u32,
    pub plan_sha256: String,
    slice: String,
}

impl Head {
    pub fn new(plan_sha256: &str, slice: Slice) -> Self {
        Self { format: FORMAT, plan_sha256: plan_sha256.to_owned(), slice: slice.to_string() }
    }
}

/// The part of a line that identifies its run.
#[derive(Deserialize)]
pub struct Entry {
    pub label: EntryLabel,
    pub status: Status,
    #[serde(default)]
    pub message: String,
    result: Option<EntryResult>,
}

#[derive(Deserialize)]
struct EntryResult {
    outcome: StuckTimes,
}

#[derive(Deserialize)]
struct StuckTimes {
    truck_stuck_s: f64,
    wumpus_stuck_s: f64,
}

#[derive(Deserialize)]
pub struct EntryLabel {
    pub run: u64,
    pub seed: u64,
}

impl Entry {
    /// Returns whether the run leaves a recording.
    pub fn is_recorded(&self, record: Record) -> bool {
        let outcome = self.result.as_ref().map(|result| &result.outcome);
        outcome.is_some_and(|outcome| record.keeps(outcome.truck_stuck_s, outcome.wumpus_stuck_s))
    }
}

/// Returns the line of a finished run.
pub fn encode_row(row: &RunRow) -> Vec<u8> {
    encode(row)
}

/// Returns any line, with its newline.
pub fn encode(content: &impl Serialize) -> Vec<u8> {
    const CHECKSUM: &[u8] = b"00000000 ";
    let mut line = CHECKSUM.to_vec();
    serde_json::to_writer(&mut line, content).expect("journals hold names, numbers and lists only");
    let checksum = format!("{:08x}", crc32fast::hash(&line[CHECKSUM.len()..]));
    line[..checksum.len()].copy_from_slice(checksum.as_bytes());
    line.push(b'\n');
    line
}

/// Returns the run number of a line with a valid checksum, and reads no more of the line than necessary.
pub fn run_of(line: &[u8]) -> Result<u64, String> {
    /// The beginning of a line that this program wrote.
    const START: &[u8] = b"{\"label\":{\"run\":";
    let json = checked(line)?;
    let digits = json.strip_prefix(START).and_then(|rest| {
        let end = rest.iter().position(|byte| !byte.is_ascii_digit())?;
        std::str::from_utf8(&rest[..end]).ok()?.parse().ok()
    });
    match digits {
        Some(run) => Ok(run),
        None => from_json::<Entry>(json).map(|entry| entry.label.run),
    }
}

/// Reads a line, without its newline, or returns what is wrong with it.
pub fn decode<'a, T: Deserialize<'a>>(line: &'a [u8]) -> Result<T, String> {
    from_json(checked(line)?)
}

fn from_json<'a, T: Deserialize<'a>>(json: &'a [u8]) -> Result<T, String> {
    serde_json::from_slice(json).map_err(|error| format!("its contents do not belong in a journal: {error}"))
}

/// The line's JSON, if the checksum is right.
fn checked(line: &[u8]) -> Result<&[u8], String> {
    let parts = line.split_at_checked(8).filter(|(_, rest)| rest.first() == Some(&b' '));
    let found = parts.and_then(|(digits, rest)| {
        let digits = std::str::from_utf8(digits).ok()?;
        Some((u32::from_str_radix(digits, 16).ok()?, &rest[1..]))
    });
    let Some((checksum, json)) = found else { return Err("it does not begin with a checksum".into()) };
    if crc32fast::hash(json) == checksum { Ok(json) } else { Err("its checksum is wrong".into()) }
}

/// Returns the error on the line that begins at a byte: lines are in the order in which runs ended, so their numbers must be
/// counted.
pub fn damaged_at(path: &Path, offset: u64, reason: String) -> JournalError {
    match (count_lines(path, 0), count_lines(path, offset)) {
        (Ok(all), Ok(from_here)) => {
            JournalError::Damaged { path: path.to_owned(), line: all.lines - from_here.lines + 1, reason }
        }
        (Err(error), _) | (_, Err(error)) => error,
    }
}

/// Complete lines of a journal, and the first byte behind them.
pub struct LineCount {
    pub lines: u64,
    pub end: u64,
}

/// Counts the complete lines of a journal from a byte on: a very cheap look at its progress. Contents of lines are not
/// read.
pub fn count_lines(path: &Path, from: u64) -> Result<LineCount, JournalError> {
    count_lines_from(path, from).map_err(|source| JournalError::unreadable(path, source))
}

fn count_lines_from(path: &Path, from: u64) -> io::Result<LineCount> {
    let mut file = File::open(path)?;
    file.seek(SeekFrom::Start(from))?;
    let mut reader = BufReader::with_capacity(1 << 18, file);
    let (mut lines, mut read, mut end) = (0, from, from);
    loop {
        let part = reader.fill_buf()?;
        if part.is_empty() {
            return Ok(LineCount { lines, end });
        }
        for (at, _) in part.iter().enumerate().filter(|(_, byte)| **byte == b'\n') {
            // Only whole lines count: the last one may be written just now.
            lines += 1;
            end = read + at as u64 + 1;
        }
        let bytes = part.len();
        read += bytes as u64;
        reader.consume(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_reads_back() {
        let head = Head::new("abc", Slice::WHOLE);
        let line = encode(&head);
        assert_eq!(decode::<Head>(&line[..line.len() - 1]), Ok(head));
    }

    #[test]
    fn every_changed_byte_is_noticed() {
        let line = encode(&Head::new("abc", Slice::WHOLE));
        let line = &line[..line.len() - 1];
        for at in 0..line.len() {
            let mut changed = line.to_vec();
            // Another letter of the same kind, so that the line stays a checksum and JSON where it can.
            changed[at] ^= 1;
            assert!(decode::<Head>(&changed).is_err(), "byte {at}");
            assert!(decode::<Head>(&line[..at]).is_err(), "cut at {at}");
        }
    }

    #[test]
    fn run_of_a_line_is_found_wherever_it_is_named() {
        for json in [
            serde_json::json!({ "label": { "run": 12, "seed": 7 }, "status": "done" }),
            serde_json::json!({ "status": "failed", "label": { "seed": 7, "run": 12 } }),
        ] {
            let line = encode(&json);
            assert_eq!(run_of(&line[..line.len() - 1]), Ok(12));
            assert!(run_of(&line[..line.len() - 2]).is_err(), "the checksum is wrong");
        }
        let nameless = encode(&serde_json::json!({ "label": {}, "status": "done" }));
        assert!(run_of(&nameless[..nameless.len() - 1]).is_err());
    }

    #[test]
    fn runs_are_recorded_by_what_their_lines_say() {
        let entry = |truck_stuck_s: f64, wumpus_stuck_s: f64| {
            let outcome = serde_json::json!({ "truck_stuck_s": truck_stuck_s, "wumpus_stuck_s": wumpus_stuck_s });
            let label = serde_json::json!({ "run": 1, "seed": 7 });
            let line = encode(
                &serde_json::json!({ "label": label, "status": "done", "result": { "outcome": outcome, "cost": 3 } }),
            );
            decode::<Entry>(&line[..line.len() - 1]).expect("it is a line")
        };
        for (stuck, expected) in [((0.0, 0.0), false), ((0.5, 0.0), true), ((0.0, 9.0), true)] {
            assert!(entry(stuck.0, stuck.1).is_recorded(Record::All));
            assert_eq!(entry(stuck.0, stuck.1).is_recorded(Record::Failed), expected, "{stuck:?}");
            assert!(!entry(stuck.0, stuck.1).is_recorded(Record::None));
        }
        let line = encode(&serde_json::json!({ "label": { "run": 1, "seed": 7 }, "status": "failed", "result": null }));
        let failed: Entry = decode(&line[..line.len() - 1]).expect("it is a line");
        assert!(!failed.is_recorded(Record::All), "there is nothing to record");
    }
}
