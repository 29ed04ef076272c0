//! The positions of runs in a journal.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::JournalError;
use super::line::{Entry, Head, damaged_at, decode};
use crate::execute::{RunRow, Status};
use crate::plan::{BatchPlan, Slice};

/// The longest line; that of a run with a hundred agents and thousands of plans has some megabytes.
const MAX_LINE_BYTES: u64 = 1 << 25;

/// Bytes that are read at once: few, since of the journals that are merged each is read some lines at a time.
const BUFFERED_BYTES: usize = 1 << 14;

/// The runs in a journal, sixteen bytes each.
#[derive(Clone, Debug)]
pub struct JournalIndex {
    slice: Slice,
    /// By place in the slice, where the run's line begins; zero, where the first line begins, of a run that is missing.
    offsets: Vec<u64>,
    /// By place in the slice, the digest of the run's line. It is in memory only, so that a program which rewrites lines
    /// of the file cannot rewrite it.
    digests: Vec<u64>,
    stored: u64,
    /// Runs held that are not done.
    not_done: u64,
    /// Runs that were held when the journal was read and that leave recordings.
    recorded: Vec<u64>,
    /// Runs that had failed then: by variant their number, and the first of them with its message.
    failures: BTreeMap<u64, FailedRuns>,
    /// Bytes of all whole lines.
    end: u64,
    /// True if something follows the last whole line.
    torn: bool,
    /// Lines of runs that were there before.
    repeated: u64,
}

/// Failed runs of a variant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedRuns {
    pub count: u64,
    /// The number of the first of them, and its message.
    pub first: u64,
    pub message: String,
}

/// Adds failed runs to those of their variant.
pub fn add_failed(failures: &mut BTreeMap<u64, FailedRuns>, variant: u64, failed: FailedRuns) {
    let Some(existing) = failures.get_mut(&variant) else {
        failures.insert(variant, failed);
        return;
    };
    existing.count += failed.count;
    if failed.first < existing.first {
        (existing.first, existing.message) = (failed.first, failed.message);
    }
}

/// What a line of a run is to an index.
enum LineRole {
    Free(usize),
    /// The run already has a line, which begins here.
    Taken(u64),
}

impl JournalIndex {
    /// The index of a journal without a line.
    fn empty(slice: Slice, runs: u64) -> Self {
        let places = usize::try_from(slice.count(runs)).expect("the runs of a batch are counted in memory");
        Self {
            slice,
            offsets: vec![0; places],
            digests: vec![0; places],
            stored: 0,
            not_done: 0,
            recorded: Vec::new(),
            failures: BTreeMap::new(),
            end: 0,
            torn: false,
            repeated: 0,
        }
    }

    /// Reads the journal of a slice of a plan; without a complete first line it counts as empty.
    ///
    /// # Errors
    /// If a line is damaged, belongs to another plan or slice, or names a run that was named before and ended otherwise.
    pub fn read(path: &Path, file: &File, plan: &BatchPlan, slice: Slice) -> Result<Self, JournalError> {
        let mut index = Self::empty(slice, plan.count());
        let mut lines = Lines::from(path, file, LineStart::default())?;
        while let Some(LineStart { number, offset }) = lines.next()? {
            // The head names plan and slice: lines of another batch are refused before one is read.
            if number == 0 {
                check_head(path, &lines.line, &Head::new(&plan.content_sha256(), slice))?;
                continue;
            }
            // Lines count from 1 in editors, and the head is line 1.
            let damaged = |reason: String| JournalError::Damaged { path: path.to_owned(), line: number + 1, reason };
            let entry: Entry = decode(&lines.line).map_err(damaged)?;
            // A run may be there twice, as two processes without locks may have worked on it.
            match index.place_of(entry.label.run).map_err(damaged)? {
                LineRole::Free(place) => {
                    // Offsets and not rows are kept, as the rows of a million runs would not fit into memory.
                    index.add(place, entry.status, offset, &lines.line);
                    // Whether a run must have a recording follows from its outcome, which only its line has.
                    index.recorded.extend(entry.is_recorded(plan.record).then_some(entry.label.run));
                    if entry.status != Status::Done {
                        let variant = plan.place(entry.label.run).variant as u64;
                        let failed = FailedRuns { count: 1, first: entry.label.run, message: entry.message };
                        add_failed(&mut index.failures, variant, failed);
                    }
                }
                LineRole::Taken(first) => {
                    // The same seed gives the same row; another one would be a fault worth stopping for.
                    expect_same_row(path, first, &lines.line).map_err(damaged)?;
                    index.repeated += 1;
                }
            }
        }
        // Lines come in the order in which runs ended.
        index.recorded.sort_unstable();
        (index.end, index.torn) = (lines.start.offset, lines.torn);
        Ok(index)
    }

    /// Finds the place of a run in the slice.
    fn place_of(&self, run: u64) -> Result<LineRole, String> {
        let place = self.slice.place_of(run).and_then(|place| usize::try_from(place).ok());
        match place.and_then(|place| Some((place, *self.offsets.get(place)?))) {
            Some((place, 0)) => Ok(LineRole::Free(place)),
            Some((_, first)) => Ok(LineRole::Taken(first)),
            None => Err(format!("run {run} is not in slice {}", self.slice)),
        }
    }

    /// Takes a run whose line, here without its newline, begins at `offset`.
    fn add(&mut self, place: usize, status: Status, offset: u64, line: &[u8]) {
        self.offsets[place] = offset;
        self.digests[place] = digest(line);
        self.stored += 1;
        self.not_done += u64::from(status != Status::Done);
    }

    /// Adds the line of a run that was written at the end.
    pub fn append(&mut self, run: u64, status: Status, line: &[u8]) {
        let Ok(LineRole::Free(place)) = self.place_of(run) else { unreachable!("only missing runs are run") };
        self.add(place, status, self.end, line.strip_suffix(b"\n").unwrap_or(line));
        self.end += line.len() as u64;
    }

    /// Notes that a line was torn before the position up to which the journal was read.
    pub fn note_torn(&mut self, was_torn: bool) {
        self.torn |= was_torn;
    }

    /// Adds the first line, which was written.
    pub fn append_head(&mut self, bytes: usize) {
        self.end = bytes as u64;
    }

    pub fn slice(&self) -> Slice {
        self.slice
    }

    /// Returns the number of runs of the slice.
    pub fn count(&self) -> u64 {
        self.offsets.len() as u64
    }

    /// Returns the number of runs in the journal.
    pub fn stored(&self) -> u64 {
        self.stored
    }

    /// Returns the number of runs in the journal that are not done.
    pub fn not_done(&self) -> u64 {
        self.not_done
    }

    pub fn is_complete(&self) -> bool {
        self.stored == self.count()
    }

    /// Iterates over the runs that are wanted and missing from the journal, in order.
    pub fn missing<F: Fn(u64) -> bool + Send + 'static>(
        &self,
        is_wanted: F,
    ) -> impl Iterator<Item = u64> + Send + use<F> {
        let (slice, is_stored): (Slice, Vec<bool>) =
            (self.slice, self.offsets.iter().map(|&offset| offset != 0).collect());
        (0..)
            .zip(is_stored)
            .filter(|(_, is_stored)| !is_stored)
            .map(move |(place, _)| slice.run_at(place))
            .filter(move |&run| is_wanted(run))
    }

    /// Iterates over the runs with recordings that were in the journal when it was read, in order.
    pub fn recorded(&self) -> &[u64] {
        &self.recorded
    }

    /// Returns the runs that had failed when the journal was read, by variant from 0.
    pub fn failures(&self) -> &BTreeMap<u64, FailedRuns> {
        &self.failures
    }

    /// Returns the number of bytes of all complete lines.
    pub fn end(&self) -> u64 {
        self.end
    }

    /// Returns whether part of a line follows them.
    pub fn is_torn(&self) -> bool {
        self.torn
    }

    /// Returns the number of repeated lines, whose rows are equal in everything that is not measured.
    pub fn repeated(&self) -> u64 {
        self.repeated
    }
}

/// Reads the rows of a complete journal.
pub struct RowReader<'a> {
    path: PathBuf,
    reader: BufReader<&'a File>,
    index: &'a JournalIndex,
    line: Vec<u8>,
}

impl<'a> RowReader<'a> {
    pub fn new(path: PathBuf, file: &'a File, index: &'a JournalIndex) -> Result<Self, JournalError> {
        let mut reader = BufReader::new(file);
        reader.rewind().map_err(|source| JournalError::unreadable(&path, source))?;
        Ok(Self { path, reader, index, line: Vec::new() })
    }

    /// Returns the row of a run in the journal.
    ///
    /// # Errors
    /// If its line is not the one that was written, or read when the journal was opened. All lines are dropped then, or
    /// resuming would believe them.
    pub fn row(&mut self, run: u64) -> Result<RunRow, JournalError> {
        let place = self.index.slice.place_of(run).expect("the run is one of this slice");
        let place = usize::try_from(place).expect("it is in memory");
        self.read_unchanged_line(place)?;
        // The line was read before, so what is wrong now is a change of the format.
        decode(&self.line).map_err(|reason| damaged_at(&self.path, self.index.offsets[place], reason))
    }

    /// Refuses a journal with a line that is not the one that was written, as [`Self::row`] does.
    pub fn expect_unchanged_lines(&mut self) -> Result<(), JournalError> {
        let index = self.index;
        let stored = index.offsets.iter().enumerate().filter(|(_, offset)| **offset != 0);
        stored.map(|(place, _)| place).try_for_each(|place| self.read_unchanged_line(place))
    }

    /// Reads the line of the run at a place.
    fn read_unchanged_line(&mut self, place: usize) -> Result<(), JournalError> {
        self.read_line(self.index.offsets[place]).map_err(|source| JournalError::unreadable(&self.path, source))?;
        if digest(&self.line) == self.index.digests[place] {
            return Ok(());
        }
        self.reader.get_ref().set_len(0).map_err(|source| JournalError::unreadable(&self.path, source))?;
        Err(JournalError::Rewritten { path: self.path.clone(), run: self.index.slice.run_at(place as u64) })
    }

    fn read_line(&mut self, offset: u64) -> io::Result<()> {
        let here = self.reader.stream_position()?;
        // Lines are nearly in the order of their runs, so the next one is usually in the buffer.
        self.reader.seek_relative(offset.cast_signed() - here.cast_signed())?;
        self.line.clear();
        self.reader.by_ref().take(MAX_LINE_BYTES).read_until(b'\n', &mut self.line)?;
        self.line.pop();
        Ok(())
    }
}

/// Returns the beginning of a line's SHA-256.
fn digest(line: &[u8]) -> u64 {
    let [a, b, c, d, e, f, g, h, ..] = <[u8; 32]>::from(Sha256::digest(line));
    u64::from_le_bytes([a, b, c, d, e, f, g, h])
}

/// Refuses the line of a run that ended otherwise in the line that begins at `first`.
pub(super) fn expect_same_row(path: &Path, first: u64, line: &[u8]) -> Result<(), String> {
    let row: RunRow = decode(line)?;
    let read = File::open(path).and_then(|file| read_line_at(&file, first));
    let first = read.map_err(|error| format!("its run was read before and can no longer be read: {error}"))?;
    let first: RunRow = decode(&first)?;
    match first.outcome_difference(&row) {
        None => Ok(()),
        Some(difference) => Err(format!("run {} appears twice with different results: {difference}", row.label.run)),
    }
}

/// Reads the line that begins at a byte, without its newline.
pub(super) fn read_line_at(file: &File, offset: u64) -> io::Result<Vec<u8>> {
    let mut reader = BufReader::with_capacity(BUFFERED_BYTES, file);
    reader.seek(SeekFrom::Start(offset))?;
    let mut line = Vec::new();
    reader.take(MAX_LINE_BYTES).read_until(b'\n', &mut line)?;
    line.pop();
    Ok(line)
}

pub(super) fn check_head(path: &Path, line: &[u8], expected: &Head) -> Result<(), JournalError> {
    let damaged = |reason: String| JournalError::Damaged { path: path.to_owned(), line: 1, reason };
    let head: Head = decode(line).map_err(damaged)?;
    if head.plan_sha256 != expected.plan_sha256 {
        let found = head.plan_sha256;
        let expected = expected.plan_sha256.clone();
        return Err(JournalError::OtherPlan { path: path.to_owned(), found, expected });
    }
    if head == *expected { Ok(()) } else { Err(damaged("it is the journal of another slice, or format".into())) }
}

/// Where a line begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LineStart {
    /// The number of lines before it.
    pub number: u64,
    /// The number of bytes before it.
    pub offset: u64,
}

/// The whole lines of a file.
pub(super) struct Lines<'a> {
    path: &'a Path,
    reader: BufReader<&'a File>,
    pub line: Vec<u8>,
    /// The start of the next line.
    pub start: LineStart,
    /// True if an incomplete line follows the last complete one.
    pub torn: bool,
}

impl<'a> Lines<'a> {
    /// Starts reading at a line.
    pub fn from(path: &'a Path, file: &'a File, start: LineStart) -> Result<Self, JournalError> {
        let mut reader = BufReader::with_capacity(BUFFERED_BYTES, file);
        reader.seek(SeekFrom::Start(start.offset)).map_err(|source| JournalError::unreadable(path, source))?;
        Ok(Self { path, reader, line: Vec::new(), start, torn: false })
    }

    /// Reads the next line into `line`, without its newline, and returns its start.
    pub fn next(&mut self) -> Result<Option<LineStart>, JournalError> {
        self.line.clear();
        // Bounded, so that a file of zeros cannot take all memory.
        let read = self.reader.by_ref().take(MAX_LINE_BYTES).read_until(b'\n', &mut self.line);
        let bytes = read.map_err(|source| JournalError::unreadable(self.path, source))? as u64;
        let start = self.start;
        // Only a last line may lack its end: a process was killed while it wrote.
        // A torn line is no damage: it is dropped and its run is made again.
        if self.line.pop() != Some(b'\n') {
            // A line that fills the whole bound is not torn but no line of a journal at all.
            if bytes == MAX_LINE_BYTES {
                let reason = format!("it has more than {} MB", MAX_LINE_BYTES >> 20);
                return Err(JournalError::Damaged { path: self.path.to_owned(), line: start.number + 1, reason });
            }
            self.torn = bytes > 0;
            return Ok(None);
        }
        self.start = LineStart { number: start.number + 1, offset: start.offset + bytes };
        Ok(Some(start))
    }
}
