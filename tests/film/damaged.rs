//! Recordings that say strange things are refused or shown, but stop nobody.

use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use rand::{Rng, RngExt};
use wildfire::picture::film::{CameraTarget, FrameRenderer, FrameRequest, Layer, RunView, Selected, ViewOptions, page};
use wildfire::time::SimTime;
use wildfire::timeline::{Timeline, file};
use wildfire::{rng, scenario, sim};

const HEADER_BYTES: usize = 18;

/// Damaged payloads that are tried: a hundred, or as many as the environment asks for.
fn trials() -> usize {
    std::env::var("WILDFIRE_TRIALS").ok().and_then(|trials| trials.parse().ok()).unwrap_or(100)
}

fn payload(recording: &[u8]) -> Vec<u8> {
    let mut payload = Vec::new();
    DeflateDecoder::new(&recording[HEADER_BYTES..]).read_to_end(&mut payload).expect("a recording's payload inflates");
    payload
}

/// A recording with a right header about any payload.
fn sealed(payload: &[u8]) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(payload).expect("memory takes all");
    let packed = encoder.finish().expect("memory takes all");
    let (length, checksum) = (packed.len() as u32, crc32fast::hash(&packed));
    [&file::MAGIC[..], &file::FORMAT.to_le_bytes(), &length.to_le_bytes(), &checksum.to_le_bytes(), &packed].concat()
}

/// Everything about a run that is shown: all layers, a story of each kind, a camera that goes along.
fn looks(timeline: &Timeline) -> Vec<ViewOptions> {
    let agents = timeline.setting.agents.iter().map(|start| start.id);
    let bush = timeline.setting.bushes.first().map(|&cell| Selected::Bush(cell));
    let all = ViewOptions {
        layers: Layer::ALL.into_iter().collect(),
        selected: bush.map(|bush| (0, bush)),
        ..ViewOptions::default()
    };
    let along = |agent| ViewOptions {
        follows: Some(CameraTarget::Agent(agent)),
        selected: Some((0, Selected::Agent(agent))),
        ..all.clone()
    };
    let fleet = ViewOptions { follows: Some(CameraTarget::Fleet), ..all.clone() };
    agents.take(2).map(along).chain([fleet, all.clone()]).collect()
}

fn show(timeline: Timeline, rng: &mut impl Rng) {
    let run = RunView::new(timeline, None);
    let looks = looks(run.timeline());
    let (options, time) =
        (&looks[rng.random_range(0..looks.len())], SimTime::from_seconds(rng.random_range(0.0..300.0)));
    let request = FrameRequest { runs: &[&run], time, options };
    FrameRenderer::new((320, 240), 1).paint(&request);
    assert!(page(&request).ends_with("</html>\n"));
}

#[test]
fn damaged_recordings_are_refused_or_shown() {
    let smoke = scenario::load("smoke", &[]).expect("it is built in");
    let run = sim::run_recording_searches(&smoke, 7).expect("it takes place");
    let whole = payload(&file::encode(&run.timeline).expect("it can be recorded"));
    let mut rng = rng::stream(1, "damaged films");
    let mut shown = 0;
    for _ in 0..trials() {
        let mut damaged = whole.clone();
        // The setting stands first; what is said there concerns all of the picture.
        let within = if rng.random() { damaged.len() } else { damaged.len().min(400) };
        damaged[rng.random_range(0..within)] = rng.random();
        if let Ok(timeline) = file::decode(&sealed(&damaged)) {
            show(timeline, &mut rng);
            shown += 1;
        }
    }
    assert!(shown * 10 > trials(), "only {shown} could be shown at all");
}
