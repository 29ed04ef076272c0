//! The changes of the ground as recordings store them.
//!
//! A fire that runs over a landscape is a million ignitions, and nearly all of them are of one kind: fire comes for the
//! first time to a cell, from a cell near by. Those are told by cell index and not by time, because times of neighbours
//! are alike: which cells there are, as lengths of stretches; for each the direction of its parent; and its time as the
//! difference from a prediction ([`PlanePredictor`]). All else is one record after the other, with its place in the log.
//! So the log is put together again by sorting, in the order in which it was.

use serde::{Deserialize, Serialize};

use super::columns::{DifferenceColumns, DifferenceReader, DifferenceWriter, PlanePredictor};
use super::facts::{NO_SUCH_AGENT, NO_SUCH_TIME, NO_SUCH_WORD};
use super::{FileError, append, check, take};
use crate::{AgentId, Cause, GroundEvent, GroundFact, Setting};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;

/// Cells along either axis up to which a parent is told by its direction.
const FARTHEST: i32 = 4;
const DIRECTIONS: i32 = 2 * FARTHEST + 1;

const NO_SUCH_CELL: FileError = FileError::Damaged("it refers to a cell beyond the field");
const MISCOUNTED: FileError = FileError::Damaged("its ground log has a different number of facts than declared");

/// Kinds of records of what is not an ordinary ignition; never given twice.
mod kind {
    pub const SPREAD: u32 = 0;
    pub const SPOTTED: u32 = 1;
    pub const IGNITED_BY_AGENT: u32 = 2;
    pub const SCHEDULED: u32 = 3;
    pub const EXTINGUISHED: u32 = 4;
    pub const WETTED: u32 = 5;
    pub const CLEARED: u32 = 6;
}

/// The log of the ground.
#[derive(Serialize, Deserialize)]
pub struct GroundRecord<'a> {
    facts: u32,
    /// Numbers of cells, by cell index, that no ordinary ignition tells of and that one does, in turn.
    stretches: &'a [u8],
    /// By ordinary ignition, in the order of cell indices: the way to its parent.
    directions: &'a [u8],
    time_lengths: &'a [u8],
    time_bits: &'a [u8],
    records: &'a [u8],
}

/// The columns of a log.
#[derive(Debug, Default)]
pub struct GroundWriter {
    facts: u32,
    stretches: Vec<u8>,
    directions: Vec<u8>,
    time_lengths: Vec<u8>,
    time_bits: Vec<u8>,
    records: Vec<u8>,
}

/// The number of the way from a cell to its parent, if that is near.
fn direction(cell: Cell, parent: Cell) -> Option<u8> {
    let [cols, rows] =
        [(parent.col, cell.col), (parent.row, cell.row)].map(|(to, from)| i32::from(to) - i32::from(from));
    let is_near = cols.abs() <= FARTHEST && rows.abs() <= FARTHEST;
    is_near.then(|| ((rows + FARTHEST) * DIRECTIONS + cols + FARTHEST) as u8)
}

impl GroundWriter {
    /// Writes a log that has passed [`check::check`].
    pub fn new(setting: &Setting, log: &[GroundEvent]) -> Self {
        let frame = setting.frame;
        let mut writer = Self { facts: log.len() as u32, ..Self::default() };
        let mut ordinary: Vec<Option<(SimTime, u8)>> = vec![None; frame.cell_count()];
        let mut last = None;
        let mut base = RecordBase::default();
        for (place, event) in log.iter().enumerate() {
            let index = frame.index(event.cell);
            let towards = match event.fact {
                GroundFact::Ignited(Cause::Spread(from)) => direction(event.cell, from),
                _ => None,
            };
            // Ordinary ignitions are sorted by time and cell index when they are read: what is out of that order is none.
            let key = Some((event.time, index));
            match towards.filter(|_| ordinary[index].is_none() && key > last) {
                Some(towards) => {
                    ordinary[index] = Some((event.time, towards));
                    last = key;
                }
                None => writer.record(setting, event, place as u32, &mut base),
            }
        }
        writer.write_ordinary(frame.cols.into(), &ordinary);
        writer
    }

    fn write_ordinary(&mut self, cols: usize, ordinary: &[Option<(SimTime, u8)>]) {
        let mut plane = PlanePredictor::new(cols, ordinary.len());
        let mut times = DifferenceWriter::default();
        let (mut stretch, mut is_ordinary) = (0_u32, false);
        for (index, ignition) in ordinary.iter().enumerate() {
            if ignition.is_some() != is_ordinary {
                append(&mut self.stretches, &stretch);
                (stretch, is_ordinary) = (0, !is_ordinary);
            }
            stretch += 1;
            if let Some((time, towards)) = *ignition {
                self.directions.push(towards);
                times.push(time.as_nanos(), plane.predict(index));
                plane.learn(index, time.as_nanos());
            }
        }
        // What follows the last ordinary ignition needs no length: the field ends there.
        if is_ordinary {
            append(&mut self.stretches, &stretch);
        }
        DifferenceColumns { lengths: self.time_lengths, bits: self.time_bits } = times.finish();
    }

    fn record(&mut self, setting: &Setting, event: &GroundEvent, place: u32, base: &mut RecordBase) {
        let index = |cell: Cell| setting.frame.index(cell) as u32;
        let agent = |id: AgentId| setting.agent_index(id).expect("the timeline was checked") as u32;
        let (kind, other) = match event.fact {
            GroundFact::Ignited(Cause::Spread(from)) => (kind::SPREAD, Some(index(from))),
            GroundFact::Ignited(Cause::Spotted(from)) => (kind::SPOTTED, Some(index(from))),
            GroundFact::Ignited(Cause::Agent(by)) => (kind::IGNITED_BY_AGENT, Some(agent(by))),
            GroundFact::Ignited(Cause::Scheduled) => (kind::SCHEDULED, None),
            GroundFact::Extinguished { by } => (kind::EXTINGUISHED, Some(agent(by))),
            GroundFact::Wetted { by, .. } => (kind::WETTED, Some(agent(by))),
            GroundFact::Cleared { .. } => (kind::CLEARED, None),
        };
        append(&mut self.records, &(place - base.place));
        append(&mut self.records, &(event.time - base.time).as_nanos());
        append(&mut self.records, &kind);
        // A field has fewer cells than half of what 32 bits count, so that no difference overflows.
        append(&mut self.records, &(index(event.cell).cast_signed() - base.index.cast_signed()));
        other.into_iter().for_each(|number| append(&mut self.records, &number));
        if let GroundFact::Wetted { until, .. } = event.fact {
            append(&mut self.records, &(until - event.time).as_nanos());
        }
        if let GroundFact::Cleared { flank, along_mm, holds } = event.fact {
            append(&mut self.records, &(flank, along_mm, holds));
        }
        *base = RecordBase { place, time: event.time, index: index(event.cell) };
    }

    pub fn record_of_all(&self) -> GroundRecord<'_> {
        GroundRecord {
            facts: self.facts,
            stretches: &self.stretches,
            directions: &self.directions,
            time_lengths: &self.time_lengths,
            time_bits: &self.time_bits,
            records: &self.records,
        }
    }
}

/// What the next record is told by its differences from.
#[derive(Clone, Copy, Debug, Default)]
struct RecordBase {
    place: u32,
    time: SimTime,
    index: u32,
}

impl GroundRecord<'_> {
    /// Returns the log; its values have not been checked yet.
    pub fn read(&self, setting: &Setting) -> Result<Vec<GroundEvent>, FileError> {
        let count = self.facts as usize;
        check::limit("facts about the ground", count, check::MAX_GROUND_FACTS)?;
        // Every ordinary ignition has its direction, so that their number is known before there is room for them.
        let ordinary_count = self.directions.len();
        if ordinary_count > count || ordinary_count > setting.frame.cell_count() {
            return Err(MISCOUNTED);
        }
        let mut ordinary = self.read_ordinary(setting)?.into_iter();
        let mut log = Vec::new();
        let mut records = self.records;
        let mut base = RecordBase::default();
        for _ in 0..count - ordinary_count {
            let (place, event) = take_record(&mut records, setting, base)?;
            // Ordinary ignitions take the places that the records leave.
            while log.len() < place as usize {
                log.push(ordinary.next().ok_or(MISCOUNTED)?);
            }
            // The first may have the place 0, all others come after the one before them.
            if log.len() != place as usize {
                return Err(MISCOUNTED);
            }
            base = RecordBase { place, time: event.time, index: setting.frame.index(event.cell) as u32 };
            log.push(event);
        }
        log.extend(ordinary);
        if records.is_empty() { Ok(log) } else { Err(MISCOUNTED) }
    }

    /// Returns the ordinary ignitions in order of time and cell index.
    fn read_ordinary(&self, setting: &Setting) -> Result<Vec<GroundEvent>, FileError> {
        let frame = setting.frame;
        let mut plane = PlanePredictor::new(frame.cols.into(), frame.cell_count());
        let mut times = DifferenceReader::new(self.time_lengths, self.time_bits);
        let mut directions = self.directions.iter();
        let mut stretches = self.stretches;
        let mut index = 0;
        // Stretches with and without ordinary ignitions alternate; the first is one without.
        let mut is_ordinary = false;
        let mut ignitions = Vec::with_capacity(self.directions.len());
        while !stretches.is_empty() {
            let stretch = take::<u32>(&mut stretches)? as usize;
            if stretch > frame.cell_count() - index {
                return Err(NO_SUCH_CELL);
            }
            for index in (index..index + stretch).take_while(|_| is_ordinary) {
                let time = times.next(plane.predict(index))?;
                plane.learn(index, time);
                let cell = frame.cell(index);
                // Two digits to the base `DIRECTIONS`, each shifted by `FARTHEST` so that it has no sign.
                let towards = i32::from(*directions.next().ok_or(MISCOUNTED)?);
                let cols = towards % DIRECTIONS - FARTHEST;
                let rows = towards / DIRECTIONS - FARTHEST;
                let parent = frame.offset(cell, cols, rows).ok_or(NO_SUCH_CELL)?;
                let fact = GroundFact::Ignited(Cause::Spread(parent));
                ignitions.push(GroundEvent { time: SimTime::from_nanos(time), cell, fact });
            }
            index += stretch;
            is_ordinary = !is_ordinary;
        }
        if directions.next().is_some() || !times.is_finished() {
            return Err(MISCOUNTED);
        }
        // They come by cell index, and the sort is stable.
        ignitions.sort_by_key(|ignition| ignition.time);
        Ok(ignitions)
    }
}

/// Takes a record from the front of others, with its place in the log.
fn take_record(records: &mut &[u8], setting: &Setting, base: RecordBase) -> Result<(u32, GroundEvent), FileError> {
    let frame = setting.frame;
    let cell = |index: u32| {
        let is_inside = (index as usize) < frame.cell_count();
        is_inside.then(|| frame.cell(index as usize)).ok_or(NO_SUCH_CELL)
    };
    let agent = |place: u32| setting.agents.get(place as usize).map(|agent| agent.id).ok_or(NO_SUCH_AGENT);
    let place = base.place.checked_add(take(records)?).ok_or(MISCOUNTED)?;
    let time = later(base.time, take(records)?)?;
    let kind: u32 = take(records)?;
    let changed = cell(base.index.checked_add_signed(take(records)?).ok_or(NO_SUCH_CELL)?)?;
    let fact = match kind {
        kind::SPREAD => GroundFact::Ignited(Cause::Spread(cell(take(records)?)?)),
        kind::SPOTTED => GroundFact::Ignited(Cause::Spotted(cell(take(records)?)?)),
        kind::IGNITED_BY_AGENT => GroundFact::Ignited(Cause::Agent(agent(take(records)?)?)),
        kind::SCHEDULED => GroundFact::Ignited(Cause::Scheduled),
        kind::EXTINGUISHED => GroundFact::Extinguished { by: agent(take(records)?)? },
        kind::WETTED => {
            let by = agent(take(records)?)?;
            GroundFact::Wetted { until: later(time, take(records)?)?, by }
        }
        kind::CLEARED => {
            let (flank, along_mm, holds) = take(records)?;
            GroundFact::Cleared { flank, along_mm, holds }
        }
        _ => return Err(NO_SUCH_WORD),
    };
    Ok((place, GroundEvent { time, cell: changed, fact }))
}

fn later(time: SimTime, nanos: u64) -> Result<SimTime, FileError> {
    time.as_nanos().checked_add(nanos).map(SimTime::from_nanos).ok_or(NO_SUCH_TIME)
}
