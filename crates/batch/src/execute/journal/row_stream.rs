//! The rows of a slice's journal in the order of the plan, of which each line is read once and the file need not stay open.
//!
//! Lines are nearly in the order of their runs: each is as early or late as its run was on one of some threads. What comes
//! before its turn waits in memory, or, where that would be too much, is read once more when its turn comes.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::PathBuf;

use super::JournalError;
use super::index::{LineStart, Lines, check_head, expect_same_row, read_line_at};
use super::line::{Head, damaged_at, decode, run_of};
use super::lock::open_to_read;
use crate::execute::{BatchError, Lock, OutputFolder, RunRow};
use crate::plan::Slice;

/// Reads rows from a journal, a few at a time.
pub struct RowStream {
    path: PathBuf,
    lock: Lock,
    head: Head,
    slice: Slice,
    /// Bytes of the file when it was first opened.
    bytes: u64,
    /// The first line that is not read.
    next: LineStart,
    /// By place in the slice, where the run's line begins; zero, where the first line begins, of a run not met yet.
    offsets: Vec<u64>,
    /// Lines that came before their turn, by place.
    early: BTreeMap<u64, Vec<u8>>,
    /// Bytes that these may take yet.
    room: usize,
    met: u64,
    repeated: u64,
}

/// The limits and the identity of a stream, besides its slice.
#[derive(Clone, Copy, Debug)]
pub struct StreamBudget<'a> {
    /// The hash of the plan, which the first line must contain.
    pub plan_sha256: &'a str,
    /// The number of runs of the plan.
    pub runs: u64,
    /// The maximum number of bytes of lines that wait for their turn.
    pub early_bytes: usize,
}

impl RowStream {
    /// Opens the journal of a slice, which no process may be writing, and reads its first line.
    ///
    /// # Errors
    /// [`BatchError::SliceNotStarted`] if there is none, [`BatchError::Incomplete`] if it has no whole line.
    pub fn open(folder: &OutputFolder, slice: Slice, budget: StreamBudget<'_>) -> Result<Self, BatchError> {
        let path = folder.journal(slice);
        let lock = folder.keeping().lock;
        // A slice without a journal is no fault of the disk: nobody has begun it.
        let file = open_to_read(&path, lock).map_err(|error| match error {
            JournalError::Unreadable { source, .. } if source.kind() == ErrorKind::NotFound => {
                BatchError::SliceNotStarted { path: folder.path().to_owned(), slice }
            }
            other => other.into(),
        })?;
        let bytes = file.metadata().map_err(|source| JournalError::unreadable(&path, source))?.len();
        // Only an offset per run is kept: rows of a whole batch need not fit into memory.
        let places = usize::try_from(slice.count(budget.runs)).expect("the runs of a batch are counted in memory");
        let mut stream = Self {
            head: Head::new(budget.plan_sha256, slice),
            path,
            lock,
            slice,
            bytes,
            next: LineStart::default(),
            offsets: vec![0; places],
            early: BTreeMap::new(),
            room: budget.early_bytes,
            met: 0,
            repeated: 0,
        };
        let mut lines = Lines::from(&stream.path, &file, stream.next)?;
        if lines.next()?.is_some() {
            // A journal of another plan is refused before its rows are mixed into this batch's table.
            check_head(&stream.path, &lines.line, &stream.head)?;
            stream.next = lines.start;
        }
        Ok(stream)
    }

    /// Returns the size of the journal in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the number of repeated lines.
    pub fn repeated(&self) -> u64 {
        self.repeated
    }

    /// Reads the rows of the runs at these places of the slice, in order; each place is requested once, and the last
    /// ones make it read to the end.
    ///
    /// # Errors
    /// [`BatchError::Incomplete`] if the journal ends before; else those of the disk, and of damaged lines.
    pub fn rows(&mut self, places: Range<u64>) -> Result<Vec<RunRow>, BatchError> {
        let file = open_to_read(&self.path, self.lock)?;
        let found = file.metadata().map_err(|source| JournalError::unreadable(&self.path, source))?.len();
        // Offsets are those of the file as it was opened.
        if found != self.bytes {
            let change = format!("it has {found} bytes, expected {} as before", self.bytes);
            return Err(JournalError::Changed { path: self.path.clone(), change }.into());
        }
        let count = self.offsets.len() as u64;
        // The last range may reach beyond the end, as all slices are read in steps of the same size.
        let places = places.start..places.end.min(count);
        let mut rows: Vec<Option<RunRow>> = Vec::new();
        // Rows that were passed on the way to earlier ones.
        for place in places.clone() {
            rows.push(self.take_early(&file, place)?);
        }
        let mut lacking = rows.iter().filter(|row| row.is_none()).count();
        let path = self.path.clone();
        let mut lines = Lines::from(&path, &file, self.next)?;
        // The last rows are read to the end of the file, so that every line was checked once.
        while lacking > 0 || places.end == count {
            let Some(LineStart { number, offset }) = lines.next()? else { break };
            self.next = lines.start;
            let damaged = |reason| JournalError::Damaged { path: path.clone(), line: number + 1, reason };
            // A repeated line was compared with the first one in `meet`, and has no place of its own.
            let Some(place) = self.meet(&lines.line, offset).map_err(damaged)? else { continue };
            if places.contains(&place) {
                rows[in_memory(place - places.start)] = Some(decode(&lines.line).map_err(damaged)?);
                lacking -= 1;
            // Kept if there is room; else it is read again from its offset when its turn comes.
            } else if lines.line.len() <= self.room {
                self.room -= lines.line.len();
                self.early.insert(place, lines.line.clone());
            }
        }
        match rows.into_iter().collect() {
            Some(rows) => Ok(rows),
            None => {
                let missing = count - self.met;
                Err(BatchError::Incomplete { slice: self.slice, missing, of: count })
            }
        }
    }

    /// Takes note of a line, and returns the place of its run; none of a run that was there before.
    fn meet(&mut self, line: &[u8], offset: u64) -> Result<Option<u64>, String> {
        let run = run_of(line)?;
        let place = self.slice.place_of(run).filter(|&place| place < self.offsets.len() as u64);
        let Some(place) = place else { return Err(format!("run {run} is not in slice {}", self.slice)) };
        match &mut self.offsets[in_memory(place)] {
            // No row is at 0, where the head is.
            entry @ 0 => {
                *entry = offset;
                self.met += 1;
                Ok(Some(place))
            }
            first => {
                expect_same_row(&self.path, *first, line)?;
                // They are counted and reported: two processes at one slice are a waste that the user should know of.
                self.repeated += 1;
                Ok(None)
            }
        }
    }

    /// Returns the row of a place whose line came before its turn.
    fn take_early(&mut self, file: &File, place: u64) -> Result<Option<RunRow>, JournalError> {
        let line = match (self.early.remove(&place), self.offsets[in_memory(place)]) {
            (Some(line), _) => {
                self.room += line.len();
                line
            }
            (None, 0) => return Ok(None),
            (None, offset) => {
                read_line_at(file, offset).map_err(|source| JournalError::unreadable(&self.path, source))?
            }
        };
        let offset = self.offsets[in_memory(place)];
        decode(&line).map(Some).map_err(|reason| damaged_at(&self.path, offset, reason))
    }
}

fn in_memory(place: u64) -> usize {
    usize::try_from(place).expect("the runs of a slice are counted in memory")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::line::{encode, encode_row};
    use super::*;
    use crate::execute::Status;
    use crate::plan::{BatchPlan, BatchRequest};

    /// Rows that failed, of the first of two slices of nine runs, in this order of their places.
    fn journal(folder: &OutputFolder, plan: &BatchPlan, places: &[u64]) {
        let slice = Slice::new(1, 2).expect("a slice");
        let mut bytes = encode(&Head::new(&plan.content_sha256(), slice));
        for &place in places {
            let label = plan.run(slice.run_at(place)).label();
            bytes.extend(encode_row(&RunRow::not_done(label, Status::Failed, "why".into(), Duration::ZERO)));
        }
        std::fs::write(folder.journal(slice), bytes).expect("writable");
    }

    #[test]
    fn lines_in_any_order_are_read_in_that_of_the_plan_with_room_for_early_ones_or_without() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let folder = OutputFolder::shared(scratch.path()).expect("a scratch folder");
        let request =
            BatchRequest { scenarios: vec!["smoke".into()], seeds: "1..9".parse().ok(), ..Default::default() };
        let plan = request.resolve(false).expect("a small batch");
        let sha256 = plan.content_sha256();
        for places in [[0, 1, 2, 3, 4], [4, 3, 2, 1, 0], [2, 0, 4, 1, 3], [1, 0, 3, 2, 4]] {
            journal(&folder, &plan, &places);
            for early_bytes in [0, 500, 1_000_000] {
                for at_once in 1..=6 {
                    let budget = StreamBudget { plan_sha256: &sha256, runs: 9, early_bytes };
                    let mut stream =
                        RowStream::open(&folder, Slice::new(1, 2).expect("a slice"), budget).expect("it is whole");
                    let mut runs = Vec::new();
                    for begin in (0..5).step_by(at_once) {
                        let rows = stream.rows(begin..begin + at_once as u64).expect("all are there");
                        runs.extend(rows.iter().map(|row| row.label.run));
                    }
                    assert_eq!(runs, [1, 3, 5, 7, 9], "{places:?}, {early_bytes} bytes, {at_once} at once");
                    assert_eq!(stream.room, early_bytes, "what waited was given back");
                }
            }
        }
        journal(&folder, &plan, &[4, 0, 2]);
        let budget = StreamBudget { plan_sha256: &sha256, runs: 9, early_bytes: 0 };
        let mut stream = RowStream::open(&folder, Slice::new(1, 2).expect("a slice"), budget).expect("it is whole");
        assert_eq!(stream.rows(0..1).expect("it is there").len(), 1);
        let refusal = stream.rows(1..2).expect_err("it is missing");
        assert!(matches!(refusal, BatchError::Incomplete { missing: 2, of: 5, .. }), "{refusal}");
    }
}
