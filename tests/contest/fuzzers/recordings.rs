//! Recordings with right checksums about anything.

use std::io;
use std::sync::LazyLock;

use miniz_oxide::{deflate, inflate};
use wildfire::picture::write_mcap;
use wildfire::scenario;
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::export::{ExportError, Sampling};
use wildfire::timeline::{Outcome, Timeline, export, file};

use super::fuzz::text::mutated;
use super::fuzz::{Case, Law, below, chance};
use super::maps::check_message;

const HEADER_BYTES: usize = 18;

/// Payloads of recorded runs, inflated.
static PAYLOADS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let payload = |(name, changes, searches): (&str, &[&str], bool)| {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let scenario = scenario::load(name, &changes).expect("it is built in");
        let run = if searches { sim::run_recording_searches } else { sim::run };
        let bytes = file::encode(&run(&scenario, 1).expect("it takes place").timeline).expect("it can be recorded");
        inflate::decompress_to_vec(&bytes[HEADER_BYTES..]).expect("it was deflated")
    };
    let searched = &["duration_s=20", "unimog.prm_rs.samples=10", "unimog.prm_rs.corner_places=0"];
    [
        ("smoke", &["duration_s=60"][..], false),
        ("fleet", &["duration_s=30", "field.coverage=0.02"], false),
        ("local-minima", &["duration_s=30", "field.coverage=0.02"], false),
        ("smoke", searched, true),
    ]
    .map(payload)
    .to_vec()
});

/// Checks that a recording is read or refused. One that is read is the same when it is written, and has states and an
/// outcome.
pub fn recording(case: &mut Case<'_>) -> Law {
    // Most are stored as they are: deflating takes longer than all the rest.
    let payload = if chance(&mut case.dice, 90) {
        deflate::compress_to_vec(&damaged(case), 0)
    } else {
        mutated(&mut case.dice, &[deflate::compress_to_vec(&PAYLOADS[0], 1)], &[])
    };
    case.input = sealed(case, &payload);
    let timeline = match file::decode(&case.input) {
        Ok(timeline) => timeline,
        Err(refusal) => return check_message(&refusal.to_string()),
    };
    case.count("recordings accepted");
    let bytes = file::encode(&timeline).map_err(|error| format!("what was read cannot be written: {error}"))?;
    let back = file::decode(&bytes).map_err(|error| format!("what was written is refused: {error}"))?;
    if back != timeline {
        return Err("another run comes back".into());
    }
    Outcome::new(&timeline);
    let end = timeline.end_time();
    for time in [SimTime::ZERO, SimTime::from_nanos(end.as_nanos() / 2), end, SimTime::MAX] {
        timeline.state_at(time);
    }
    export::write_events(&timeline, io::sink()).map_err(|error| error.to_string())?;
    // All other forms go through all that there is, too, which takes longer.
    if case.chance(5) { exported(&timeline) } else { Ok(()) }
}

/// Checks that a run is written in every form, or refused as too long or too large.
fn exported(timeline: &Timeline) -> Law {
    let sampling = Sampling::new(timeline, 10.0, &[]).map_err(|error| error.to_string())?;
    for written in [
        export::write_json(timeline, io::sink()),
        export::write_npz(timeline, &sampling, io::sink()),
        write_mcap(timeline, &sampling, io::sink()),
    ] {
        match written {
            Ok(()) | Err(ExportError::TooManySamples { .. } | ExportError::FieldTooLarge { .. }) => {}
            Err(error) => return Err(error.to_string()),
        }
    }
    Ok(())
}

/// Draws a payload in which some bytes were changed, mostly without moving the others.
fn damaged(case: &mut Case<'_>) -> Vec<u8> {
    let dice = &mut case.dice;
    if chance(dice, 20) {
        return mutated(dice, &PAYLOADS, &[]);
    }
    let mut payload = PAYLOADS[below(dice, PAYLOADS.len())].clone();
    for _ in 0..below(dice, 6) {
        // The counts of everything are at the beginning.
        let longest = if chance(dice, 30) { 300 } else { payload.len() };
        let at = below(dice, longest.min(payload.len()));
        payload[at] = match below(dice, 4) {
            0 => payload[at].wrapping_add(1),
            1 => payload[at].wrapping_sub(1),
            2 => payload[at] ^ 0x80,
            _ => dice.arbitrary().unwrap_or_default(),
        };
    }
    payload
}

/// Makes a recording of this payload; a few say another length, format or checksum.
fn sealed(case: &mut Case<'_>, payload: &[u8]) -> Vec<u8> {
    let format = if case.chance(90) { file::FORMAT } else { below(&mut case.dice, 6) as u16 };
    let length = payload.len() as u32;
    let checksum = crc32fast::hash(payload);
    let parts = [&file::MAGIC[..], &format.to_le_bytes(), &length.to_le_bytes(), &checksum.to_le_bytes(), payload];
    let bytes = parts.concat();
    if case.chance(2) { mutated(&mut case.dice, &[bytes], &[]) } else { bytes }
}
