//! Recordings: one finished run in one file, small enough to keep thousands.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `WILDFIRE` |
//! | 2 | version of the format |
//! | 4 | length of the payload in bytes |
//! | 4 | CRC-32 (ISO-HDLC) of the payload |
//! | .. | payload: a compact form of the timeline, deflated (RFC 1951) |
//!
//! Numbers in the header are unsigned and little-endian. What is read back equals what was written bit for bit. The
//! payload is the setting, the streams that the facts are written to, and a second part of the setting. It
//! leaves out what the closed forms of [`wildfire_base::trajectory`] give again, the start of a leg that begins where the last
//! one ended above all: a change of their arithmetic is a new version of the format.
//!
//! The program's own types are converted here, at the border: nothing outside of this module decides what bytes mean.
//!
//! An hour of the contest takes 9 to 10 KB. With what searches looked at it takes 38 to 44 KB (seeds 1 to 3: some 7,000
//! edges of the roadmap and 8,000 of 170 searches, two bytes each), with the planner `lattice` 215 KB.

mod check;
mod columns;
mod facts;
mod graphs;
mod ground;
mod numbers;
mod setting;
mod spread;

use std::io::{self, ErrorKind, Read};
use std::path::Path;

use miniz_oxide::{deflate, inflate};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use facts::{FactReader, FactWriter};
use ground::{GroundRecord, GroundWriter};
use numbers::NumberReader;
use setting::{GroundSharesRecord, SettingRecord, SettingTail, WaterRecord};
use spread::GroundSetting;

use super::{LineRules, Timeline, WaterEnergy, WaterRules};
use wildfire_base::input_file;
use wildfire_base::whole_file::write_whole;

/// The version of the format. Any change of the meaning of bytes gets a new number.
///
/// Only this one is read: before the first release nobody is promised more, and the same scenario and seed give the same
/// run again.
pub const FORMAT: u16 = 9;

/// The first bytes of every recording.
pub const MAGIC: &[u8; 8] = b"WILDFIRE";
// The magic, the version in 2 bytes, then the length and the checksum of the payload in 4 bytes each.
const HEADER_BYTES: usize = 18;
/// The maximum size of a recording, in bytes.
pub const MAX_BYTES: u64 = (HEADER_BYTES + MAX_PAYLOAD_BYTES) as u64;
/// Largest payload, deflated or not: 32 MiB for facts, and for each cell of the largest field whose ground burns a fuel
/// of its own, a gradient and two facts about it. With the limits on counts in [`check`] it keeps the memory of reading
/// below a gigabyte, whatever the bytes say.
const MAX_PAYLOAD_BYTES: usize = (32 << 20) + 32 * check::MAX_GROUND_CELLS;
/// The level of deflation up to which an hour's recording takes less than a millisecond; beyond it files shrink by 4 %.
const DEFLATE_LEVEL: u8 = 3;

/// The reason why a recording could not be written or read. Messages read well after a file name.
#[derive(Debug, Error)]
pub enum FileError {
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error("not a wildfire recording")]
    NotARecording,
    #[error("written by a newer wildfire: format {found}, this program reads format {FORMAT}")]
    Newer { found: u16 },
    #[error(
        "written by an older wildfire: format {found}, this program reads format {FORMAT}; \
         simulate its scenario and seed again"
    )]
    Older { found: u16 },
    #[error("truncated: {found} of {expected} bytes found")]
    Truncated { expected: u64, found: u64 },
    #[error("damaged: {0}")]
    Damaged(&'static str),
    #[error("too large to record: {what} beyond the limit of {limit}")]
    TooLarge { what: &'static str, limit: usize },
    #[error("not a possible run: {0}")]
    Impossible(String),
}

impl FileError {
    /// Returns the kind of error of an unreadable input.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Io(error) => error.kind(),
            _ => ErrorKind::InvalidData,
        }
    }
}

/// Writes a recording. The file appears whole or not at all: see [`WholeFile`](wildfire_base::whole_file::WholeFile).
///
/// # Errors
/// Besides the disk's: a timeline that could not be read back, because of its size or of values that no run has.
pub fn write(timeline: &Timeline, path: &Path) -> Result<(), FileError> {
    Ok(write_whole(path, &encode(timeline)?)?)
}

/// Reads a recording.
pub fn read(path: &Path) -> Result<Timeline, FileError> {
    decode(&read_bytes(path)?)
}

/// Checks length and checksum of a recording, which is much faster than reading it.
pub fn verify(path: &Path) -> Result<(), FileError> {
    checked_payload(&read_bytes(path)?).map(drop)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    // One byte more than the longest recording is enough to see that a file is longer.
    input_file::open(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Returns the bytes of a recording.
pub fn encode(timeline: &Timeline) -> Result<Vec<u8>, FileError> {
    check::check(timeline)?;
    let compact = encode_payload(timeline);
    check::limit("bytes", compact.len(), MAX_PAYLOAD_BYTES)?;
    let payload = deflate::compress_to_vec(&compact, DEFLATE_LEVEL);
    // Deflated bytes may be more than there were.
    check::limit("bytes", payload.len(), MAX_PAYLOAD_BYTES)?;
    let mut bytes = Vec::with_capacity(HEADER_BYTES + payload.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&FORMAT.to_le_bytes());
    bytes.extend_from_slice(&(payload.len() as u32).to_le_bytes());
    bytes.extend_from_slice(&crc32fast::hash(&payload).to_le_bytes());
    bytes.extend_from_slice(&payload);
    Ok(bytes)
}

/// Returns the timeline of a recording's bytes.
pub fn decode(bytes: &[u8]) -> Result<Timeline, FileError> {
    let payload = checked_payload(bytes)?;
    let compact = inflate::decompress_to_vec_with_limit(payload, MAX_PAYLOAD_BYTES)
        .map_err(|_| FileError::Damaged("its payload does not inflate"))?;
    let timeline = decode_payload(&compact)?;
    check::check(&timeline)?;
    Ok(timeline)
}

/// The facts in the payload, between the setting and its supplement.
#[derive(Serialize, Deserialize)]
struct Streams<'a> {
    facts: u32,
    delays: &'a [u8],
    records: &'a [u8],
    recurring_numbers: Vec<f64>,
    single_numbers: Vec<f64>,
    number_references: &'a [u8],
}

/// The payload of a timeline that has passed [`check::check`], before deflation.
fn encode_payload(timeline: &Timeline) -> Vec<u8> {
    let mut writer = FactWriter::new(&timeline.setting);
    writer.write(&timeline.events);
    let numbers = writer.numbers.coded();
    let streams = Streams {
        facts: timeline.events.len() as u32,
        delays: &writer.delays,
        records: &writer.records,
        recurring_numbers: numbers.recurring,
        single_numbers: numbers.single,
        number_references: &numbers.references,
    };
    let mut bytes = Vec::new();
    append(&mut bytes, &SettingRecord::from(&timeline.setting));
    append(&mut bytes, &streams);
    append(&mut bytes, &SettingTail::from(&timeline.setting));
    GroundSetting::from(&timeline.setting).append_to(&mut bytes);
    let log = (!timeline.ground.is_empty()).then(|| GroundWriter::new(&timeline.setting, &timeline.ground));
    append(&mut bytes, &log.as_ref().map(GroundWriter::record_of_all));
    append(&mut bytes, &timeline.setting.water.as_ref().map(WaterRecord::from));
    // Nothing follows in runs without slow ground, line and heat, so that their bytes stay as they were.
    let shares: Vec<_> = timeline.setting.ground_shares.iter().map(GroundSharesRecord::from).collect();
    let line = &timeline.setting.line;
    let energy = timeline.setting.water.as_ref().and_then(|water| water.energy);
    if !shares.is_empty() || line.is_some() || energy.is_some() {
        append(&mut bytes, &(shares, line));
        energy.iter().for_each(|energy| append(&mut bytes, energy));
    }
    bytes
}

/// The timeline of an inflated payload; its values are still to be checked.
fn decode_payload(mut bytes: &[u8]) -> Result<Timeline, FileError> {
    let setting: SettingRecord = take(&mut bytes)?;
    let streams: Streams<'_> = take(&mut bytes)?;
    let count = streams.facts as usize;
    check::limit("facts", count, check::MAX_FACTS)?;
    let supplement: SettingTail = take(&mut bytes)?;
    let ground_setting = GroundSetting::take_from(&mut bytes)?;
    let log: Option<GroundRecord<'_>> = take(&mut bytes)?;
    let water: Option<WaterRecord> = take(&mut bytes)?;
    // The payload ends here unless ground slows trucks, crews build line, or water meets heat.
    let (shares, line): (Vec<GroundSharesRecord>, Option<LineRules>) =
        if bytes.is_empty() { Default::default() } else { take(&mut bytes)? };
    let energy: Option<WaterEnergy> = if bytes.is_empty() { None } else { Some(take(&mut bytes)?) };
    if !bytes.is_empty() {
        return Err(FileError::Damaged("more follows than its setting and its facts"));
    }
    // Facts come after the whole setting, which says what their numbers mean.
    let mut setting = setting.into_setting(&supplement)?;
    setting.blocked = ground_setting.blocked(setting.frame)?;
    setting.spread = ground_setting.spread(setting.frame)?;
    setting.water = water.map(|water| WaterRules { energy, ..water.into() });
    setting.ground_shares = shares.into_iter().map(Into::into).collect();
    setting.line = line;
    let numbers = NumberReader::new(&streams.recurring_numbers, &streams.single_numbers, streams.number_references);
    let events = FactReader::new(&setting, streams.delays, streams.records, numbers).read(count)?;
    let ground = log.map_or(Ok(Vec::new()), |log| log.read(&setting))?;
    Ok(Timeline { setting, events, ground })
}

/// Adds a value's bytes to others.
fn append(bytes: &mut Vec<u8>, value: &impl Serialize) {
    let taken = std::mem::take(bytes);
    *bytes = postcard::to_extend(value, taken).expect("plain values fit a vector that grows");
}

/// Reads a value from the front of some bytes.
fn take<'a, T: Deserialize<'a>>(bytes: &mut &'a [u8]) -> Result<T, FileError> {
    let (value, rest) =
        postcard::take_from_bytes(bytes).map_err(|_| FileError::Damaged("a record in it cannot be read"))?;
    *bytes = rest;
    Ok(value)
}

/// The payload of a recording, still deflated.
fn checked_payload(bytes: &[u8]) -> Result<&[u8], FileError> {
    // A file that ends within these bytes is a recording cut short.
    let length = bytes.len().min(MAGIC.len());
    if bytes[..length] != MAGIC[..length] {
        return Err(FileError::NotARecording);
    }
    let Some((header, payload)) = bytes.split_at_checked(HEADER_BYTES) else {
        return Err(FileError::Truncated { expected: HEADER_BYTES as u64, found: bytes.len() as u64 });
    };
    // Before the rest of the header, which other versions may lay out otherwise.
    match u16::from_le_bytes([header[8], header[9]]) {
        // No version has this number.
        0 => return Err(FileError::NotARecording),
        found if found > FORMAT => return Err(FileError::Newer { found }),
        found if found < FORMAT => return Err(FileError::Older { found }),
        _ => {}
    }
    let word = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let expected = word(10) as usize;
    // Asked before the checksum, which would call a file that was cut short damaged.
    if payload.len() < expected {
        let [expected, found] = [expected + HEADER_BYTES, bytes.len()].map(|length| length as u64);
        return Err(FileError::Truncated { expected, found });
    }
    if payload.len() > expected {
        return Err(FileError::Damaged("it has more bytes than its header declares"));
    }
    if crc32fast::hash(payload) != word(14) {
        return Err(FileError::Damaged("its checksum does not match its bytes"));
    }
    Ok(payload)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::Arc;

    use rand::{Rng, RngExt};

    use super::super::sample::{self, A, C, TRUCK, WUMPUS, at, leg, planned, seconds};
    use super::*;
    use crate::{AgentFact, Cause, Event, Fact, GroundEvent, GroundFact, Outcome, SpreadSetting};
    use wildfire_base::geometry::{Cell, DVec2, FieldFrame, Pose};
    use wildfire_base::query::{FoundBy, PlanFailure};
    use wildfire_base::rng;
    use wildfire_base::time::SimTime;
    use wildfire_base::time::cpu::CpuStopwatch;
    use wildfire_base::trajectory::{Piece, SpeedLimits, Trajectory};
    use wildfire_base::vehicle::Segment;
    use wildfire_fire::lone::LoneFire;
    use wildfire_fire::models::RothermelRules;
    use wildfire_fire::surface::FuelMoisture;
    use wildfire_fire::surface::crown::{CrownMethod, CrownRules};
    use wildfire_fire::{CanopyLayers, Landscape, MoistureZones, Relief, Weather};

    fn tiny(events: Vec<Event>) -> Timeline {
        Timeline { setting: sample::small_setting(&[WUMPUS, TRUCK]), events, ground: Vec::new() }
    }

    fn assert_comes_back(timeline: &Timeline) {
        let bytes = encode(timeline).expect("it is a possible run");
        let back = decode(&bytes).expect("what was written can be read");
        assert!(&back == timeline, "another timeline came back");
        assert!(encode(&back).expect("it was just read") == bytes, "equal, but not bit for bit");
    }

    #[test]
    fn drives_to_places_come_back() {
        let pose = sample::small_setting(&[TRUCK]).agents[0].pose;
        let x_m = 12.5;
        let y_m = 40.0;
        let effort = sample::effort(3, 9);
        let trajectory = leg(5.0, pose, 8.0, &[24.0]);
        let cut = leg(5.0, pose, 8.0, &[8.0]);
        let failed = |reason| AgentFact::RelocationFailed { x_m, y_m, reason, effort, until: seconds(9.5) };
        let facts = [
            (4.0, AgentFact::Relocated { x_m, y_m, trajectory, effort, found_by: FoundBy::Roadmap }),
            (5.5, AgentFact::Halted { trajectory: cut }),
            (9.0, failed(None)),
            (9.0, failed(Some(PlanFailure::GoalBlocked))),
        ];
        let timeline = tiny(facts.map(|(time_s, fact)| at(time_s, Fact::Agent(TRUCK, fact))).to_vec());
        assert_comes_back(&timeline);
        let mut nowhere = timeline;
        if let Fact::Agent(_, AgentFact::Relocated { x_m, .. }) = &mut nowhere.events[0].fact {
            *x_m = f64::NAN;
        }
        assert!(matches!(encode(&nowhere), Err(FileError::Impossible(_))));
    }

    #[test]
    fn timelines_come_back_bit_for_bit() {
        assert_comes_back(&sample::by_hand());
        assert_comes_back(&sample::meeting());
        assert_comes_back(&sample::searched());
        assert_comes_back(&sample::spreading());
        assert_comes_back(&sample::on_ground());
        assert_comes_back(&tiny(vec![]));
        for seed in 0..10 {
            assert_comes_back(&sample::random(seed, seconds(200.0)));
            assert_comes_back(&sample::random_on_ground(seed, seconds(2000.0)));
        }
    }

    #[test]
    fn legs_that_begin_anywhere_at_any_time_come_back() {
        let segment = Segment { curvature: -1.0 / 13.0, length_m: 3.0 };
        let pieces = vec![
            Piece::Drive { segment, speed_mps: 0.0, acceleration_mps2: 2.0 },
            Piece::Wait { seconds: 1.25 },
            Piece::Turn { heading: -0.0 },
        ];
        let elsewhere = Trajectory::new(seconds(7.0), Pose::new(1.0, -0.0, 3.0), pieces.clone());
        let same_origin = Trajectory::new(seconds(7.0), Pose::new(1.0, -0.0, 3.0), pieces[..1].to_vec());
        let earlier = Trajectory::new(seconds(2.0), Pose::new(1.0, 0.0, 3.0), pieces);
        assert_comes_back(&tiny(vec![
            at(6.0, planned(TRUCK, A, elsewhere)),
            at(8.0, Fact::Agent(TRUCK, AgentFact::Dropped { goal: A, trajectory: same_origin })),
            at(9.0, planned(TRUCK, C, leg(9.0, Pose::new(50.0, 50.0, 0.0), 8.0, &[]))),
            at(9.0, Fact::Agent(TRUCK, AgentFact::Dropped { goal: A, trajectory: earlier })),
        ]));
    }

    #[test]
    fn a_contest_of_an_hour_fits_fifty_kilobytes() {
        for seed in [0, 1] {
            let timeline = sample::random(seed, seconds(3600.0));
            let plans = |of| {
                let facts = timeline.events.iter().map(|event| &event.fact);
                facts
                    .filter(|fact| {
                        fact.agent() == Some(of) && matches!(fact, Fact::Agent(_, AgentFact::Planned { .. }))
                    })
                    .count()
            };
            let (drives, walks) = (plans(TRUCK), plans(WUMPUS));
            assert!(drives >= 150 && walks >= 60, "{drives} drives and {walks} walks are too few");
            let bytes = encode(&timeline).expect("it is a possible run").len();
            println!("{} facts, {drives} drives and {walks} walks take {bytes} bytes", timeline.events.len());
            assert!(bytes <= 50_000, "{bytes} bytes");
        }
    }

    #[test]
    fn the_format_is_frozen() {
        // Another checksum means another format: give it a number.
        let digest = |timeline: &Timeline| {
            let payload = encode_payload(timeline);
            (payload.len(), crc32fast::hash(&payload))
        };
        assert_eq!(digest(&sample::by_hand()), (671, 521_907_210));
    }

    #[test]
    fn a_payload_without_its_supplement_is_no_recording_of_today() {
        let payload = encode_payload(&sample::by_hand());
        let supplement = postcard::to_stdvec(&SettingTail::from(&sample::by_hand().setting)).expect("it is plain data");
        // Three bytes more say that there is no ground.
        let bytes = sealed(&deflate::compress_to_vec(&payload[..payload.len() - 3 - supplement.len()], 1));
        assert!(matches!(decode(&bytes), Err(FileError::Damaged(_))));
    }

    #[test]
    fn every_way_of_finding_a_plan_and_of_failing_comes_back() {
        let found_by = FoundBy::ALL.into_iter().map(Some).chain([None]).map(|found_by| {
            let trajectory = leg(1.0, Pose::default(), 1.0, &[1.0]);
            AgentFact::Planned { goal: A, trajectory, effort: sample::effort(1, 1), found_by }
        });
        let failed = PlanFailure::ALL.into_iter().map(|reason| AgentFact::PlanFailed {
            goal: A,
            reason,
            effort: sample::effort(1, 1),
            until: seconds(1.0),
        });
        let events = found_by.chain(failed).map(|fact| at(1.0, Fact::Agent(TRUCK, fact)));
        assert_comes_back(&tiny(events.collect()));
    }

    #[test]
    fn fires_that_spread_at_one_instant_come_back_in_their_order() {
        let timeline = sample::spreading();
        assert_comes_back(&timeline);
        let payload = encode_payload(&timeline);
        let mut alone = timeline;
        alone.events.retain(|event| event.fact.cell() != Some(C));
        assert_eq!(payload.len(), encode_payload(&alone).len() + 2, "two cells take two bytes more than one");
    }

    #[test]
    fn every_truncation_is_reported_as_such() {
        let bytes = encode(&sample::by_hand()).expect("it is a possible run");
        for length in 0..bytes.len() {
            assert!(matches!(decode(&bytes[..length]), Err(FileError::Truncated { .. })), "{length} bytes");
        }
    }

    #[test]
    fn every_damage_to_one_byte_is_an_error() {
        let bytes = encode(&sample::by_hand()).expect("it is a possible run");
        for at in 0..bytes.len() {
            for change in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= change;
                assert!(decode(&damaged).is_err(), "byte {at} changed by {change:#x}");
            }
        }
    }

    #[test]
    fn random_bytes_are_errors_and_no_panics() {
        let mut rng = rng::stream(1, "timeline/file/tests");
        for length in (0..400).chain([5000]) {
            let mut noise = vec![0; length];
            rng.fill_bytes(&mut noise);
            assert!(matches!(decode(&noise), Err(FileError::NotARecording | FileError::Truncated { .. })));
            assert!(decode(&sealed(&noise)).is_err());
            assert!(decode(&sealed(&deflate::compress_to_vec(&noise, 1))).is_err());
        }
    }

    #[test]
    fn a_payload_damaged_under_a_fitting_checksum_is_no_panic() {
        let payloads =
            [sample::by_hand(), sample::searched(), sample::spreading(), sample::on_ground(), sample::on_ground()]
                .map(|timeline| encode_payload(&timeline));
        let mut rng = rng::stream(2, "timeline/file/tests");
        let mut refused = 0;
        for number in 0..20_000 {
            let mut damaged = payloads[number % payloads.len()].clone();
            for _ in 0..rng.random_range(1..4) {
                let at = rng.random_range(0..damaged.len());
                damaged[at] = rng.random();
            }
            match decode(&sealed(&deflate::compress_to_vec(&damaged, 1))) {
                Ok(other) => {
                    Outcome::new(&other);
                    encode(&other).expect("what was read can be written");
                    other.state_at(seconds(50.0));
                }
                Err(_) => refused += 1,
            }
        }
        assert!(refused > 5_000, "only {refused} were refused");
    }

    #[test]
    fn graphs_beyond_the_limits_are_refused_before_they_are_read() {
        let setting = sample::small_setting(&[WUMPUS, TRUCK]);
        let refusal = |places: u32, edges: u32| {
            let mut records = Vec::new();
            // A search of the first agent, in its third phase.
            [18, 0, 2, places, edges].iter().for_each(|field| append(&mut records, field));
            let (mut payload, delays) = (Vec::new(), &[0][..]);
            append(&mut payload, &SettingRecord::from(&setting));
            let recurring_numbers = Vec::new();
            let single_numbers = Vec::new();
            let facts = 1;
            let records = &records[..];
            let number_references = &[][..];
            let streams = Streams { facts, delays, records, recurring_numbers, single_numbers, number_references };
            append(&mut payload, &streams);
            append(&mut payload, &SettingTail::from(&setting));
            append(&mut payload, &GroundSetting::default());
            append(&mut payload, &None::<GroundRecord<'_>>);
            append(&mut payload, &None::<WaterRecord>);
            decode(&sealed(&deflate::compress_to_vec(&payload, 1))).expect_err("its bytes hold nothing").to_string()
        };
        assert_eq!(refusal(u32::MAX, 0), "too large to record: places of searches beyond the limit of 8000000");
        assert_eq!(refusal(0, u32::MAX), "too large to record: edges of searches beyond the limit of 8000000");
        assert_eq!(refusal(8_000_000, 8_000_000), "damaged: a record in it cannot be read");
    }

    /// A file with a right header about any payload.
    fn sealed(payload: &[u8]) -> Vec<u8> {
        let length = (payload.len() as u32).to_le_bytes();
        let checksum = crc32fast::hash(payload).to_le_bytes();
        [&MAGIC[..], &FORMAT.to_le_bytes(), &length, &checksum, payload].concat()
    }

    #[test]
    fn a_small_file_that_inflates_without_end_is_refused() {
        let zeros = vec![0; MAX_PAYLOAD_BYTES + 1];
        let bytes = sealed(&deflate::compress_to_vec(&zeros, 1));
        assert!(bytes.len() < 1 << 20);
        assert!(matches!(decode(&bytes), Err(FileError::Damaged(_))));
    }

    #[test]
    fn foreign_newer_and_older_files_are_named() {
        let mut bytes = encode(&sample::by_hand()).expect("it is a possible run");
        let mut refusal = |format: u16| {
            bytes[8..10].copy_from_slice(&format.to_le_bytes());
            decode(&bytes).expect_err("the format is unknown").to_string()
        };
        assert_eq!(refusal(FORMAT + 1), "written by a newer wildfire: format 10, this program reads format 9");
        let older = "written by an older wildfire: format 8, this program reads format 9; simulate its scenario and \
            seed again";
        assert_eq!(refusal(FORMAT - 1), older);
        let foreign = decode(b"\x89PNG\r\n\x1a\n and so on").expect_err("it is a picture");
        assert_eq!(foreign.to_string(), "not a wildfire recording");
    }

    #[test]
    fn runs_that_cannot_be_are_not_written() {
        let mut stray_start = sample::by_hand();
        stray_start.setting.agents[0].pose.x = f64::NAN;
        let mut disorder = sample::by_hand();
        disorder.events.swap(0, 20);
        let mut stray_bush = sample::by_hand();
        stray_bush.setting.bushes[3] = Cell { col: 10, row: 9 };
        let unknown_cell = tiny(vec![at(1.0, sample::ignited(Cell { col: 0, row: 0 }))]);
        let unknown_agent =
            tiny(vec![at(1.0, Fact::Agent(sample::SECOND_TRUCK, AgentFact::Suppressing { cell: A, water_units: 1 }))]);
        let endless = tiny(vec![at(1.0, planned(TRUCK, A, leg(1.0, Pose::default(), 0.0, &[1.0])))]);
        let back_in_time = tiny(vec![at(9.0, planned(TRUCK, A, leg(8.0, Pose::default(), 1.0, &[1.0])))]);
        let reason = PlanFailure::GoalBlocked;
        let until = SimTime::ZERO;
        let effort = sample::effort(1, 1);
        let uncharged =
            tiny(vec![at(9.0, Fact::Agent(TRUCK, AgentFact::PlanFailed { goal: A, reason, effort, until }))]);
        let mut immobile = sample::by_hand();
        immobile.setting.agents[1].limits = Some(SpeedLimits { braking_mps2: Some(0.0), ..sample::LIMITS });
        for run in
            [stray_start, disorder, stray_bush, unknown_cell, unknown_agent, endless, back_in_time, uncharged, immobile]
        {
            assert!(matches!(encode(&run), Err(FileError::Impossible(_))));
        }
        let mut astray = sample::searched();
        let Fact::Agent(_, AgentFact::Searched { graph, .. }) = &mut astray.events[3].fact else {
            panic!("it looks at its roadmap")
        };
        graph.edges.push((1, 3));
        let refused = encode(&astray).expect_err("there are three places");
        assert_eq!(
            refused.to_string(),
            "not a possible run: a search leads to a place that it does not contain in a fact at 10.000 s"
        );
        let mut barren = sample::on_ground();
        barren.setting.spread = None;
        let mut disorder = sample::on_ground();
        disorder.ground.swap(0, 5);
        let mut outside = sample::on_ground();
        outside.ground[1].cell.col = 10;
        let mut stranger = sample::on_ground();
        stranger.ground[6].fact = GroundFact::Extinguished { by: sample::SECOND_TRUCK };
        let mut dry_at_once = sample::on_ground();
        dry_at_once.ground[7].fact = GroundFact::Wetted { until: seconds(29.0), by: TRUCK };
        let mut other_field = sample::on_ground();
        other_field.setting.spread = Some(sample::grass(FieldFrame { cols: 9, ..other_field.setting.frame }));
        for run in [barren, disorder, outside, stranger, dry_at_once, other_field] {
            assert!(matches!(encode(&run), Err(FileError::Impossible(_))));
        }
        let mut vast = tiny(vec![]);
        vast.setting.frame.cols = 4097;
        assert!(matches!(encode(&vast), Err(FileError::TooLarge { .. })));
    }

    /// A fire by Rothermel's equations over a thousand by a thousand cells of two fuels in patches on a hill.
    fn burned_over() -> Timeline {
        let frame = FieldFrame { cols: 1000, rows: 1000, cell_m: 5.0 };
        let mut setting = sample::small_setting(&[WUMPUS, TRUCK]);
        (setting.frame, setting.bushes) = (frame, Vec::new());
        let fuel = |index| {
            let Cell { col, row } = frame.cell(index);
            if (col / 37 + row / 23) % 2 == 0 { 102 } else { 101 }
        };
        let height = |index: usize| {
            let [x, y] = [frame.cell(index).col, frame.cell(index).row].map(|at| (f32::from(at) - 500.0) / 200.0);
            80.0 / (1.0 + x * x + y * y)
        };
        let cells = 0..frame.cell_count();
        let relief = Relief::Elevation(cells.clone().map(height).collect());
        let landscape = Arc::new(Landscape { fuel: cells.map(fuel).collect(), relief, ..Landscape::uniform(frame, 0) });
        let weather = Arc::new(Weather::constant(DVec2::new(3.0, 1.0), FuelMoisture::default()));
        let rules = RothermelRules::default();
        let start = (SimTime::ZERO, Cell { col: 300, row: 450 });
        let mut fire = LoneFire::new(Arc::clone(&landscape), Arc::clone(&weather), rules, &[start]);
        setting.rules.duration = seconds(1e6);
        fire.burn_until(setting.rules.duration);
        setting.spread = Some(SpreadSetting::Rothermel { landscape, weather, rules });
        let ignition = |index| {
            let cell = frame.cell(index);
            let parent = fire.parent(cell)?;
            let cause = if parent == cell { Cause::Scheduled } else { Cause::Spread(parent) };
            Some(GroundEvent { time: fire.arrival(cell)?, cell, fact: GroundFact::Ignited(cause) })
        };
        let mut ground: Vec<GroundEvent> = (0..frame.cell_count()).filter_map(ignition).collect();
        ground.sort_by_key(|event| event.time);
        Timeline { setting, events: Vec::new(), ground }
    }

    #[test]
    fn trees_are_kept_and_landscapes_without_any_are_written_as_before() {
        let mut timeline = sample::on_ground();
        let bare = encode(&timeline).expect("it is a possible run");
        let Some(SpreadSetting::Rothermel { landscape, rules, .. }) = &mut timeline.setting.spread else {
            panic!("the sample burns by Rothermel's equations")
        };
        let layer = |min: u16| (0..landscape.fuel.len()).map(|index| min + (index % 7) as u16).collect();
        let canopy = Some(CanopyLayers([150, 20, 9, 50].map(layer)));
        *landscape = Arc::new(Landscape { canopy, ..Landscape::clone(landscape) });
        rules.crowns = Some(CrownRules { method: CrownMethod::Rothermel, foliar_moisture: 0.9 });
        let bytes = encode(&timeline).expect("it is a possible run");
        assert!(decode(&bytes).expect("it was just written") == timeline && bytes.len() > bare.len());
    }

    #[test]
    fn zones_are_kept_and_refused_where_they_are_impossible() {
        let plain = sample::on_ground();
        let cells = plain.setting.frame.cell_count();
        let moisture = |index: usize| FuelMoisture { d1: (index % 5) as f64 / 100.0, ..FuelMoisture::default() };
        let zones = MoistureZones::new((0..cells).map(moisture)).expect("they are few");
        let factors: Vec<u16> = (0..cells).map(|index| 500 + index as u16).collect();
        let with = |zones: Option<MoistureZones>, rate_factors: Vec<u16>| {
            let mut timeline = plain.clone();
            let Some(SpreadSetting::Rothermel { landscape, weather, .. }) = &mut timeline.setting.spread else {
                panic!("the sample burns by Rothermel's equations")
            };
            *landscape = Arc::new(Landscape { rate_factors, ..Landscape::clone(landscape) });
            if let Some(zones) = zones {
                *weather = Arc::new(Weather::clone(weather).with_moisture_zones(zones));
            }
            timeline
        };
        for timeline in [
            with(Some(zones.clone()), factors.clone()),
            with(None, factors.clone()),
            with(Some(zones.clone()), Vec::new()),
        ] {
            let bytes = encode(&timeline).expect("it is a possible run");
            assert!(decode(&bytes).expect("it was just written") == timeline);
        }
        assert!(encode(&with(None, Vec::new())).expect("as before") == encode(&plain).expect("it is a possible run"));
        let moist = |d1| vec![FuelMoisture { d1, ..FuelMoisture::default() }; 4097];
        let wrong = |of_cell: Vec<u16>, moistures| with(Some(MoistureZones { of_cell, moistures }), Vec::new());
        for run in [
            wrong(vec![0; cells - 1], zones.moistures.clone()),
            wrong(vec![5; cells], zones.moistures),
            wrong(vec![0; cells], moist(f64::NAN)[..2].to_vec()),
            wrong(vec![0; cells], moist(0.1)),
            with(None, vec![1000; cells + 1]),
            with(None, vec![0; cells]),
            with(None, vec![10_001; cells]),
        ] {
            assert!(matches!(encode(&run), Err(FileError::Impossible(_) | FileError::TooLarge { .. })));
        }
    }

    #[test]
    fn a_million_ignitions_take_at_most_eight_megabytes() {
        let timeline = burned_over();
        assert_eq!(timeline.ground.len(), 1_000_000);
        let watch = CpuStopwatch::start();
        let bytes = encode(&timeline).expect("it is a possible run");
        let written = {
            let mut watch = watch;
            watch.elapsed_since_last()
        };
        let mut watch = CpuStopwatch::start();
        let back = decode(&bytes).expect("it was just written");
        println!("{} bytes, written in {written:?}, read in {:?} of CPU time", bytes.len(), watch.elapsed_since_last());
        assert!(back == timeline && bytes.len() < 8_000_000, "{} bytes", bytes.len());
    }

    #[test]
    fn a_file_is_written_whole_beside_nothing_else() {
        let folder = std::env::temp_dir().join(format!("wildfire-timeline-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("the temporary folder takes folders");
        let path = folder.join("run.wildfire");
        for timeline in [sample::by_hand(), sample::random(4, seconds(60.0))] {
            write(&timeline, &path).expect("the folder is writable");
            assert!(read(&path).expect("it was just written") == timeline);
        }
        assert_eq!(fs::read_dir(&folder).expect("it was created").count(), 1);
        fs::remove_dir_all(&folder).expect("it was created here");
        assert!(matches!(read(&path), Err(FileError::Io(_))));
        assert!(matches!(write(&sample::by_hand(), &path), Err(FileError::Io(_))));
    }
}
