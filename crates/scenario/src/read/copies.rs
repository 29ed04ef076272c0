//! Agents by number: an entry of `[[unimog]]` or `[[wumpus]]` with `count = 20` is twenty agents.
//!
//! The first of them starts where the entry says, the others at places of the stream `starts/unimog/0`, after the kind and
//! the number of the entry. The places are the same in every run, so runs of different seeds differ in the field and in what
//! happens on it; and a fleet of ten starts where one of five does, and at five places more. Each is the farthest from all
//! earlier starts of its kind among a few that are drawn (Mitchell, "Spectrally optimal sampling for distribution ray
//! tracing", SIGGRAPH 1991, section 4: the best candidate), so they lie evenly over the field at any number.

use rand::{Rng, RngExt};
use toml::Value;

use crate::faults::check::{Check, TablePath, ValidationError};
use crate::faults::path::{FieldPath, PathStep};
use crate::faults::wording::shortened;
use crate::keys::agents::SHOWN_SEED;
use crate::{Scenario, StartPose, Terrain, Unimog, Wumpus};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, ops};
use wildfire_base::rng;

/// The kinds of agents that may be given by number.
pub(crate) const KINDS: [&str; 2] = ["wumpus", "unimog"];

/// The most agents of a kind that entries ask for together.
pub(crate) const MAX_COPIES: usize = 1000;

/// Places that are drawn for a start, of which the best is taken.
const CANDIDATES: usize = 12;

/// Draws after which no more places are looked for.
const MAX_DRAWS: usize = 4000;

/// The least room between the circles round two bodies at their starts, metres.
const MIN_GAP_M: f64 = 1.0;

/// The seed of the stream of starts, which are the same in every run.
const SEED: u64 = 0;

/// The entries that the agents of each kind are written in, by the agents' numbers; in the order of [`KINDS`].
#[derive(Clone, Debug, Default)]
pub(crate) struct AgentExpansion([Vec<usize>; 2]);

impl AgentExpansion {
    /// Takes the `count` out of all entries and repeats them as often.
    pub fn expand(root: &mut Value) -> Result<Self, Box<ValidationError>> {
        let mut copies = Self::default();
        for (kind, entries_of) in KINDS.into_iter().zip(&mut copies.0) {
            let Some(Value::Array(entries)) = root.get_mut(kind) else { continue };
            let mut expanded = Vec::with_capacity(entries.len());
            for (number, mut entry) in entries.drain(..).enumerate() {
                let count = match entry.as_table_mut().and_then(|entry| entry.remove("count")) {
                    None => 1,
                    // `MAX_COPIES` as a literal, since a pattern cannot convert a constant.
                    Some(Value::Integer(count @ 0..=1000)) => count as usize,
                    Some(other) => {
                        let expected = format!("a whole number from 0 to {MAX_COPIES}");
                        return Err(refusal(kind, number, shortened(&other.to_string()), expected));
                    }
                };
                // Entries without a count stay as many as they are; what is too many of them is refused with the other limits.
                if count > 1 && expanded.len() + count > MAX_COPIES {
                    let expected = format!("at most {MAX_COPIES} agents of this kind in all entries");
                    return Err(refusal(kind, number, count.to_string(), expected));
                }
                entries_of.extend(std::iter::repeat_n(number, count));
                expanded.extend(std::iter::repeat_n(entry, count));
            }
            *entries = expanded;
        }
        Ok(copies)
    }

    /// Returns the entry of the file that an agent is written in.
    pub fn entry(&self, kind: &str, agent: usize) -> Option<usize> {
        let place = KINDS.iter().position(|other| *other == kind)?;
        self.0[place].get(agent).copied()
    }

    /// Says whether an agent is a further one of its entry, with a start of its own.
    pub fn is_copy(&self, kind: &str, agent: usize) -> bool {
        agent > 0 && self.entry(kind, agent).is_some_and(|entry| self.entry(kind, agent - 1) == Some(entry))
    }

    /// Returns the path in the file of a value of an agent.
    pub fn written(&self, path: &FieldPath) -> FieldPath {
        let mut written = path.clone();
        if let [PathStep::Key(kind), PathStep::Index(agent), ..] = &mut written.0[..]
            && let Some(entry) = self.entry(kind, *agent)
        {
            *agent = entry;
        }
        written
    }

    /// Says whether a value is the start of an agent that is a further one of its entry.
    pub fn is_drawn(&self, path: &FieldPath) -> bool {
        let [PathStep::Key(kind), PathStep::Index(agent), PathStep::Key(name), ..] = &path.0[..] else { return false };
        (name == "start" || name == "start_m") && self.is_copy(kind, *agent)
    }

    /// Gives all further agents of entries their starts, in a scenario whose values were checked.
    pub fn place(&self, scenario: &mut Scenario) -> Check {
        if !KINDS.iter().zip(&self.0).any(|(kind, agents)| (0..agents.len()).any(|agent| self.is_copy(kind, agent))) {
            return Ok(());
        }
        let frame = scenario.field.frame();
        // Where the bushes are drawn they keep off the starts; where they are given the starts keep off them.
        let has_map = scenario.field.imported.is_some() || scenario.layers().is_some();
        let terrain = has_map.then(|| Terrain::from_scenario(scenario, SHOWN_SEED).ok()).flatten();
        let field = OpenField { frame, terrain };
        self.place_kind("wumpus", &field, &mut scenario.wumpus)?;
        self.place_kind("unimog", &field, &mut scenario.unimog)
    }

    fn place_kind<A: Placed>(&self, kind: &'static str, field: &OpenField, agents: &mut [A]) -> Check {
        // The written starts first: they hold, wherever their entries are in the list.
        let written = (0..agents.len()).filter(|&agent| !self.is_copy(kind, agent));
        let mut taken: Vec<(DVec2, f64)> = written.map(|agent| agents[agent].circle()).collect();
        let mut stream = None;
        for (number, agent) in agents.iter_mut().enumerate() {
            let entry = self.entry(kind, number).unwrap_or(number);
            if !self.is_copy(kind, number) {
                // Each entry has a stream, so one truck more in it moves no start of another entry.
                stream = Some(rng::stream(SEED, &format!("starts/{kind}/{entry}")));
                continue;
            }
            let stream = stream.as_mut().expect("the first agent of an entry comes before its copies");
            let Some(placed) = best_candidate(agent, field, &taken, stream) else {
                let found = self.0.iter().zip(KINDS).find(|(_, other)| *other == kind);
                let count = found.map_or(0, |(entries, _)| entries.iter().filter(|&&other| other == entry).count());
                let expected = "no more agents than find a free place to start".to_owned();
                return Err(refusal(kind, entry, count.to_string(), expected));
            };
            taken.push(placed.circle());
            *agent = placed;
        }
        Ok(())
    }
}

fn refusal(kind: &str, entry: usize, found: String, expected: String) -> Box<ValidationError> {
    let refused = TablePath::entry(kind, entry).refuse("count", found, expected);
    refused.expect_err("a refusal is an error")
}

/// The field as far as starts have to keep off it.
struct OpenField {
    frame: FieldFrame,
    terrain: Option<Terrain>,
}

impl OpenField {
    /// Says whether a circle lies inside the field and off all that is known to be occupied.
    fn is_open(&self, (centre, radius_m): (DVec2, f64)) -> bool {
        // The cheap test comes first; only places that pass it look at cells.
        if self.frame.border_distance(centre) < radius_m {
            return false;
        }
        let Some(terrain) = &self.terrain else { return true };
        let cell_m = self.frame.cell_m;
        let low = self.frame.cell_at(centre - radius_m);
        let high = self.frame.cell_at(centre + radius_m);
        let (Some(low), Some(high)) = (low, high) else { return false };
        let mut near = (low.row..=high.row).flat_map(|row| (low.col..=high.col).map(move |col| Cell { col, row }));
        near.all(|cell| {
            let offset = (centre - self.frame.centre(cell)).abs() - DVec2::splat(0.5 * cell_m);
            let is_near = offset.max(DVec2::ZERO).length_squared() <= radius_m * radius_m;
            !is_near || !terrain.occupied[(cell.row.into(), cell.col.into())]
        })
    }
}

/// An agent that can start elsewhere.
trait Placed: Sized {
    /// Returns the circle about its body at the start: its middle, and its radius in metres.
    fn circle(&self) -> (DVec2, f64);

    /// Returns the same agent with a start drawn from all of the field.
    fn elsewhere(&self, frame: &FieldFrame, rng: &mut impl Rng) -> Self;
}

impl Placed for Unimog {
    fn circle(&self) -> (DVec2, f64) {
        (self.start_centre(), 0.5 * ops::hypot(self.vehicle.length_m, self.vehicle.width_m))
    }

    /// Draws places in half metres and headings in degrees: they are easily copied.
    fn elsewhere(&self, frame: &FieldFrame, rng: &mut impl Rng) -> Self {
        let mut half_metres = |side_m: f64| 0.5 * (2.0 * side_m * rng.random::<f64>()).floor();
        let x_m = half_metres(frame.width_m());
        let y_m = half_metres(frame.height_m());
        let heading_deg = f64::from(rng.random_range(-179..=180));
        Self { start: StartPose { x_m, y_m, heading_deg }, ..self.clone() }
    }
}

impl Placed for Wumpus {
    fn circle(&self) -> (DVec2, f64) {
        (self.start_centre(), self.size_m * std::f64::consts::FRAC_1_SQRT_2)
    }

    /// Draws places a whole number of steps of its lattice away from the written start, so that all walk on one lattice.
    fn elsewhere(&self, frame: &FieldFrame, rng: &mut impl Rng) -> Self {
        let step_m = self.lattice_m.unwrap_or(frame.cell_m);
        let mut moved = |from_m: f64, side_m: f64| {
            let drawn_m = side_m * rng.random::<f64>();
            from_m + ((drawn_m - from_m) / step_m).round() * step_m
        };
        let start_m = [moved(self.start_m[0], frame.width_m()), moved(self.start_m[1], frame.height_m())];
        Self { start_m, ..self.clone() }
    }
}

/// Draws a few open places for an agent, and takes the farthest from those that are taken.
fn best_candidate<A: Placed>(agent: &A, field: &OpenField, taken: &[(DVec2, f64)], rng: &mut impl Rng) -> Option<A> {
    let mut best: Option<(f64, A)> = None;
    let mut candidates = 0;
    for _ in 0..MAX_DRAWS {
        let candidate = agent.elsewhere(&field.frame, rng);
        let (centre, radius_m) = candidate.circle();
        if !field.is_open((centre, radius_m)) {
            continue;
        }
        let gaps = taken.iter().map(|&(other, other_m)| (centre - other).length() - radius_m - other_m);
        let gap_m = gaps.fold(f64::INFINITY, f64::min);
        if gap_m < MIN_GAP_M {
            continue;
        }
        // It must be strictly farther: of equal gaps the first draw stays.
        if best.as_ref().is_none_or(|(max_m, _)| gap_m > *max_m) {
            best = Some((gap_m, candidate));
        }
        candidates += 1;
        // Candidates and not draws are counted, so a dense field spreads its agents as evenly as an open one.
        if candidates == CANDIDATES {
            break;
        }
    }
    best.map(|(_, agent)| agent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadedScenario, explain, load};

    fn loaded(source: &str, changes: &[&str]) -> Scenario {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        load(source, &changes).expect("it loads")
    }

    fn refused(changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        load("contest", &changes).expect_err("it is refused").to_string()
    }

    #[test]
    fn a_larger_fleet_starts_where_a_smaller_one_does_and_at_further_places() {
        let starts = |count: usize| {
            let scenario = loaded("contest", &[&format!("unimog.count={count}")]);
            scenario.unimog.iter().map(|truck| truck.start).collect::<Vec<_>>()
        };
        assert_eq!(starts(1), [StartPose::default()]);
        let (five, ten) = (starts(5), starts(10));
        assert_eq!(ten[..5], five);
        assert_eq!(ten.len(), 10);
        assert!(starts(0).is_empty());
    }

    #[test]
    fn bodies_start_apart_inside_the_field_and_evenly() {
        let scenario = loaded("contest", &["field.size_m=1000", "unimog.count=100", "wumpus.count=100"]);
        let frame = scenario.field.frame();
        let trucks: Vec<(DVec2, f64)> = scenario.unimog.iter().map(Placed::circle).collect();
        let wumpuses: Vec<(DVec2, f64)> = scenario.wumpus.iter().map(Placed::circle).collect();
        for kind in [&trucks, &wumpuses] {
            for (number, &(centre, radius_m)) in kind.iter().enumerate() {
                assert!(frame.border_distance(centre) >= radius_m, "{centre}");
                let gaps =
                    kind[..number].iter().map(|&(other, other_m)| (centre - other).length() - radius_m - other_m);
                // Of a hundred places drawn without a choice, some pair is nearly always less than 10 m apart.
                assert!(gaps.fold(f64::INFINITY, f64::min) > 25.0, "{number} is too near");
            }
        }
        // All walk on the lattice of the first, that of the cell centres.
        for (centre, _) in wumpuses {
            assert_eq!(centre, frame.centre(frame.cell_at(centre).expect("inside")));
        }
    }

    #[test]
    fn starts_keep_off_the_bushes_of_a_map() {
        let folder = tempfile::tempdir().expect("a folder");
        let rows: Vec<String> =
            (0..40).map(|row| (0..40).map(|col| if (row + col) % 9 < 3 { '#' } else { '.' }).collect()).collect();
        let map = folder.path().join("map.txt");
        std::fs::write(&map, rows.join("\n") + "\n").expect("it can be written");
        let map = format!("field.map={}", map.display());
        let scenario = loaded(
            "contest",
            &[
                &map,
                "unimog.count=8",
                "wumpus.count=8",
                "unimog.start.x_m=20",
                "unimog.start.y_m=50",
                "wumpus.start_m=[102.5,17.5]",
            ],
        );
        let occupied = &scenario.field.imported.as_ref().expect("it has a map").occupied;
        let frame = scenario.field.frame();
        for truck in &scenario.unimog[1..] {
            for corner in truck.vehicle.footprint(truck.start.pose()).corners() {
                let cell = frame.cell_at(corner).expect("inside");
                assert!(!occupied[(cell.row.into(), cell.col.into())], "{:?}", truck.start);
            }
        }
    }

    #[test]
    fn counts_that_cannot_be_are_refused_with_their_place() {
        assert!(refused(&["unimog.count=-1"]).contains("a whole number from 0 to 1000"));
        assert!(refused(&["unimog.count=2.5"]).contains("`unimog.count`"));
        assert!(refused(&["wumpus.count=1001"]).contains("`wumpus.count`"));
        let crowded = refused(&[
            "unimog.count=90",
            "field.size_m=60",
            "unimog.start.x_m=20",
            "unimog.start.y_m=20",
            "wumpus.start_m=[42.5,42.5]",
        ]);
        assert!(crowded.contains("free place to start"), "{crowded}");
        // What is wrong with all agents of an entry is wrong in the entry.
        let text = "[[wumpus]]\ncount = 3\n\n[[wumpus]]\nspeed_mps = -1.0\ncount = 2\n\n[[unimog]]\n";
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("two.toml");
        std::fs::write(&path, text).expect("it can be written");
        let error = load(path.to_str().expect("plain"), &[]).expect_err("no speed is negative");
        assert!(error.to_string().contains("wumpus.3.speed_mps"), "{error}");
        assert_eq!(error.location.as_ref().map(|location| location.line_and_column().0), Some(5));
    }

    #[test]
    fn agents_of_an_entry_are_described_once() {
        let changes = ["unimog.count=30".to_owned(), "wumpus.count=3".to_owned(), "field.size_m=500".to_owned()];
        let loaded = LoadedScenario::open("smoke", &changes).expect("it loads");
        let text = explain(&loaded, crate::MemoryLimit::default()).to_text();
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains("1 to 29: like 0, at random places from the stream `starts/unimog/0`."), "{text}");
        assert_eq!(text.matches("turning_radius_m=").count(), 1, "{text}");
        assert!(loaded.is_set("unimog.17.start.x_m") && !loaded.is_set("unimog.17.rescue"));
    }
}
