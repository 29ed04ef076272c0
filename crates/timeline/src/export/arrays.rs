//! A run as NumPy arrays in one file, `.npz`: numbers and texts only, so that `numpy.load` reads it without pickles.

use std::io::{self, Write};

use super::zip::ZipWriter;
use super::{ExportError, ExportedChange, Sampling, cell_changes};
use crate::{Activity, AgentFact, Fact, FollowedLeg, Replay, RunIndex, Setting, Timeline};
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::npy::{NpyValue, npy_header};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, Trajectory};
use wildfire_fire::BushStateKind;

/// Column and row where there is no cell.
const NO_CELL: [u16; 2] = [u16::MAX; 2];

/// Numbers of what is in a cell of the array `field`.
mod kind_of_cell {
    pub const FREE: u8 = 0;
    pub const BUSH: u8 = 1;
    pub const BLOCKED: u8 = 2;
    pub const GROUND: u8 = 3;
}

/// Numbers of pieces by what they are.
mod motion {
    pub const DRIVE: u8 = 0;
    pub const TURN: u8 = 1;
    pub const WAIT: u8 = 2;
}

/// Writes a run as arrays: the field, sampled poses, changes of cells, legs. `docs/output-files.md` lists them.
///
/// # Errors
/// More than [`MAX_SAMPLES`](super::MAX_SAMPLES), and those of the disk.
pub fn write_npz(timeline: &Timeline, sampling: &Sampling, to: impl Write) -> Result<(), ExportError> {
    sampling.check_count()?;
    let index = RunIndex::new(timeline);
    let mut arrays = ArrayFile(ZipWriter::new(to));
    write_setting(&mut arrays, &timeline.setting, index.end_time())?;
    write_samples(&mut arrays, timeline, sampling)?;
    write_changes(&mut arrays, &cell_changes(&index))?;
    write_legs(&mut arrays, &index, sampling.agents())?;
    Ok(arrays.0.finish()?)
}

fn write_setting<W: Write>(arrays: &mut ArrayFile<W>, setting: &Setting, end: SimTime) -> io::Result<()> {
    let frame = setting.frame;
    arrays.text("scenario", &setting.scenario)?;
    arrays.text("program_version", &setting.program_version)?;
    arrays.raw("seed", "<u8", &[], &setting.seed.to_le_bytes())?;
    arrays.add("ended_s", &[], [end.as_seconds()])?;
    arrays.add("cell_m", &[], [frame.cell_m])?;
    let shape = [frame.rows.into(), frame.cols.into()];
    let mut field = vec![kind_of_cell::FREE; frame.cell_count()];
    if setting.spread.is_some() {
        for (index, kind) in field.iter_mut().enumerate() {
            if setting.is_ground(frame.cell(index)) {
                *kind = kind_of_cell::GROUND;
            }
        }
    }
    // A cell is what stands on it, so these overwrite the ground below.
    setting.blocked.iter().for_each(|&cell| field[frame.index(cell)] = kind_of_cell::BLOCKED);
    setting.bushes.iter().for_each(|&cell| field[frame.index(cell)] = kind_of_cell::BUSH);
    arrays.add("field", &shape, field)?;
    if let Some(spread) = &setting.spread {
        arrays.add("fuel", &shape, spread.landscape().fuel.iter().copied())?;
    }
    Ok(())
}

fn write_samples<W: Write>(arrays: &mut ArrayFile<W>, timeline: &Timeline, sampling: &Sampling) -> io::Result<()> {
    let agents = sampling.agents();
    let times = sampling.times().collect::<Vec<_>>();
    let names: Vec<String> = agents.iter().map(|&agent| timeline.setting.agents[agent].id.to_string()).collect();
    arrays.texts("agents", &names)?;
    arrays.texts("activity_names", &Activity::ALL.map(Activity::name))?;
    let shape = [agents.len(), times.len()];
    let count = agents.len() * times.len();
    // Agent by agent, as the file has them, although the replay goes from time to time.
    let mut poses = vec![[0.0; 3]; count];
    let mut speeds = vec![0.0; count];
    let mut activities = vec![0_u8; count];
    let mut goals = vec![NO_CELL; count];
    let mut replay = Replay::new(timeline);
    // Times outside and agents inside, so that the replay goes through the run once.
    for (sample, &time) in times.iter().enumerate() {
        replay.seek(time);
        for (row, &agent) in agents.iter().enumerate() {
            let state = replay.agent(agent);
            let at = row * times.len() + sample;
            poses[at] = numbers(state.pose);
            speeds[at] = state.speed_mps;
            activities[at] = state.activity as u8;
            goals[at] = state.goal.map_or(NO_CELL, pair);
        }
    }
    arrays.add("times_s", &[times.len()], times.into_iter().map(SimTime::as_seconds))?;
    arrays.add("poses", &[shape[0], shape[1], 3], poses.into_iter().flatten())?;
    arrays.add("speeds_mps", &shape, speeds)?;
    arrays.add("activities", &shape, activities)?;
    arrays.add("goals", &[shape[0], shape[1], 2], goals.into_iter().flatten())
}

fn write_changes<W: Write>(arrays: &mut ArrayFile<W>, changes: &[ExportedChange]) -> io::Result<()> {
    arrays.texts("state_names", &BushStateKind::ALL.map(BushStateKind::name))?;
    arrays.add("change_times_s", &[changes.len()], changes.iter().map(|change| change.time.as_seconds()))?;
    arrays.add("change_cells", &[changes.len(), 2], changes.iter().flat_map(|change| pair(change.cell)))?;
    arrays.add("change_states", &[changes.len()], changes.iter().map(|change| change.state as u8))
}

fn write_legs<W: Write>(arrays: &mut ArrayFile<W>, index: &RunIndex<'_>, agents: &[usize]) -> io::Result<()> {
    let timeline = index.timeline();
    let legs: Vec<(usize, FollowedLeg)> = agents
        .iter()
        .enumerate()
        .flat_map(|(row, &agent)| index.legs_of(agent).iter().map(move |&leg| (row, leg)))
        .collect();
    let ways = || legs.iter().map(|(_, leg)| leg.trajectory(timeline));
    // The last leg has no end of its own.
    let until = |leg: FollowedLeg| leg.until.min(index.end_time()).as_seconds();
    let goal = |leg: FollowedLeg| match &timeline.events[leg.fact()].fact {
        Fact::Agent(_, AgentFact::Planned { goal, .. }) => pair(*goal),
        _ => NO_CELL,
    };
    // Pieces of all legs stand one behind the other, so a leg is found by the running sum of their numbers.
    let ends = ways().scan(0_u32, |ends, way| {
        *ends += way.pieces().len() as u32;
        Some(*ends)
    });
    arrays.add("leg_agents", &[legs.len()], legs.iter().map(|&(row, _)| row as u32))?;
    arrays.add("leg_from_s", &[legs.len()], legs.iter().map(|(_, leg)| leg.from.as_seconds()))?;
    arrays.add("leg_until_s", &[legs.len()], legs.iter().map(|&(_, leg)| until(leg)))?;
    arrays.add("leg_begins_s", &[legs.len()], ways().map(|way| way.start_time().as_seconds()))?;
    arrays.add("leg_starts", &[legs.len(), 3], ways().flat_map(|way| numbers(way.start())))?;
    arrays.add("leg_goals", &[legs.len(), 2], legs.iter().flat_map(|&(_, leg)| goal(leg)))?;
    // One more than there are legs, so that the last has an end as well.
    arrays.add("leg_first_pieces", &[legs.len() + 1], std::iter::once(0).chain(ends))?;
    let pieces = || ways().flat_map(Trajectory::pieces_with_starts);
    let count = pieces().count();
    let drives = |piece: &Piece| match *piece {
        Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
            [segment.curvature, segment.length_m, speed_mps, acceleration_mps2]
        }
        // Zeros keep the array rectangular, as the other pieces have no such numbers.
        Piece::Turn { .. } | Piece::Wait { .. } => [0.0; 4],
    };
    arrays.add("piece_motions", &[count], pieces().map(|(_, piece)| motion_of(piece)))?;
    arrays.add("piece_starts", &[count, 3], pieces().flat_map(|(start, _)| numbers(start)))?;
    arrays.add("piece_lasts_s", &[count], pieces().map(|(_, piece)| piece.duration_s()))?;
    arrays.add("piece_drives", &[count, 4], pieces().flat_map(|(_, piece)| drives(piece)))
}

fn motion_of(piece: &Piece) -> u8 {
    match piece {
        Piece::Drive { .. } => motion::DRIVE,
        Piece::Turn { .. } => motion::TURN,
        Piece::Wait { .. } => motion::WAIT,
    }
}

fn pair(cell: Cell) -> [u16; 2] {
    [cell.col, cell.row]
}

fn numbers(pose: Pose) -> [f64; 3] {
    [pose.x, pose.y, pose.heading]
}

/// The arrays of a file.
struct ArrayFile<W>(ZipWriter<W>);

impl<W: Write> ArrayFile<W> {
    /// Adds an array of this shape; of no sides it is one value.
    fn add<T: NpyValue>(&mut self, name: &str, shape: &[usize], values: impl IntoIterator<Item = T>) -> io::Result<()> {
        let mut bytes = Vec::new();
        values.into_iter().for_each(|value| value.append_bytes(&mut bytes));
        self.raw(name, T::NUMPY_TYPE, shape, &bytes)
    }

    fn raw(&mut self, name: &str, numpy_type: &str, shape: &[usize], values: &[u8]) -> io::Result<()> {
        let file = [npy_header(numpy_type, shape).as_slice(), values].concat();
        self.0.add(&format!("{name}.npy"), &file)
    }

    fn text(&mut self, name: &str, text: &str) -> io::Result<()> {
        let (numpy_type, letters) = letters(&[text]);
        self.raw(name, &numpy_type, &[], &letters)
    }

    fn texts(&mut self, name: &str, texts: &[impl AsRef<str>]) -> io::Result<()> {
        let (numpy_type, letters) = letters(texts);
        self.raw(name, &numpy_type, &[texts.len()], &letters)
    }
}

/// Texts as NumPy has them, in UTF-32, each as long as the longest: their type, and their bytes.
fn letters(texts: &[impl AsRef<str>]) -> (String, Vec<u8>) {
    let longest = texts.iter().map(|text| text.as_ref().chars().count()).max().unwrap_or(0).max(1);
    let padded = |text: &str| text.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest).collect::<Vec<_>>();
    let bytes = texts.iter().flat_map(|text| padded(text.as_ref())).flat_map(u32::to_le_bytes).collect();
    (format!("<U{longest}"), bytes)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::sample;

    /// The arrays of a file by name: type and shape as written, and the bytes of the values.
    fn arrays(file: &[u8]) -> BTreeMap<String, (String, Vec<u8>)> {
        let number = |at: usize, bytes: usize| {
            file[at..at + bytes].iter().rev().fold(0_usize, |number, &byte| number << 8 | usize::from(byte))
        };
        let end = file.len() - 22;
        assert_eq!(&file[end..end + 4], b"PK\x05\x06");
        let mut at = number(end + 16, 4);
        let mut arrays = BTreeMap::new();
        for _ in 0..number(end + 10, 2) {
            assert_eq!(&file[at..at + 4], b"PK\x01\x02");
            let size = number(at + 20, 4);
            let name_length = number(at + 28, 2);
            let offset = number(at + 42, 4);
            let name = String::from_utf8(file[at + 46..at + 46 + name_length].to_vec()).expect("it is text");
            let content = &file[offset + 30 + name_length..][..size];
            assert_eq!(number(at + 16, 4) as u32, crc32fast::hash(content), "{name}");
            assert_eq!(&content[..8], b"\x93NUMPY\x01\x00");
            let header = 10 + usize::from(u16::from_le_bytes([content[8], content[9]]));
            assert_eq!(header % 64, 0);
            let dictionary = String::from_utf8(content[10..header].to_vec()).expect("it is text");
            arrays.insert(name.trim_end_matches(".npy").to_owned(), (dictionary, content[header..].to_vec()));
            at += 46 + name_length;
        }
        assert_eq!(at, end);
        arrays
    }

    fn floats(bytes: &[u8]) -> Vec<f64> {
        bytes.as_chunks::<8>().0.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect()
    }

    fn written(timeline: &Timeline, step_s: f64) -> BTreeMap<String, (String, Vec<u8>)> {
        let mut file = Vec::new();
        let sampling = Sampling::new(timeline, step_s, &[]).expect("a step");
        write_npz(timeline, &sampling, &mut file).expect("memory takes all");
        arrays(&file)
    }

    #[test]
    fn poses_are_those_of_the_run() {
        let timeline = sample::random(3, SimTime::from_seconds(60.25));
        let arrays = written(&timeline, 0.5);
        let times = floats(&arrays["times_s"].1);
        let poses = floats(&arrays["poses"].1);
        let agents = timeline.setting.agents.len();
        assert!(
            arrays["poses"].0.contains(&format!("'shape': ({agents}, {}, 3)", times.len())),
            "{}",
            arrays["poses"].0
        );
        for (sample, &time) in times.iter().enumerate() {
            let state = timeline.state_at(SimTime::from_seconds(time));
            for (agent, state) in state.agents.iter().enumerate() {
                assert_eq!(poses[3 * (agent * times.len() + sample)..][..3], numbers(state.pose));
            }
        }
    }

    #[test]
    fn arrays_have_as_many_values_as_their_shapes_say() {
        for timeline in [sample::by_hand(), sample::meeting(), sample::on_ground()] {
            for (name, (dictionary, values)) in written(&timeline, 5.0) {
                let shape = dictionary.split_once("'shape': (").expect("it has a shape").1;
                let sides = shape.split_once(')').expect("it ends").0.split(',').map(str::trim);
                let count: usize =
                    sides.filter(|side| !side.is_empty()).map(|side| side.parse::<usize>().expect("a side")).product();
                let kind = dictionary.split('\'').nth(3).expect("a type");
                let width = match kind.split_at(2) {
                    ("<U", letters) => 4 * letters.parse::<usize>().expect("a length"),
                    (_, bytes) => bytes.parse().expect("a width"),
                };
                assert_eq!(values.len(), count * width, "{name}: {dictionary}");
            }
        }
    }

    #[test]
    fn headers_of_any_shape_are_tuples() {
        let shape = |sides: &[usize]| {
            let header = npy_header("<f8", sides);
            let text = String::from_utf8_lossy(&header[10..]).into_owned();
            text.split_once("'shape': ").expect("a shape").1.split_inclusive(')').next().expect("a tuple").to_owned()
        };
        assert_eq!([shape(&[]), shape(&[3]), shape(&[3, 4]), shape(&[0, 2, 1])], ["()", "(3,)", "(3, 4)", "(0, 2, 1)"]);
    }
}
