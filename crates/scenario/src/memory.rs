//! The memory that a run takes, estimated from its scenario alone, and the memory that it may take.
//!
//! What a run needs in any case is added up before anything is allocated: [`MemoryEstimate`], from cells, bushes, lattice
//! points and milestones by the bytes that each takes. Searches, floods, curves and the timeline grow as the run goes on, in
//! most runs far less than they could; they are counted as they do, by a [`MemoryMeter`] that allows what the limit leaves.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::keys::agents::{AgentList, AgentsMemory, FieldMeasures, MemoryPart};
use crate::{FireModelName, PlannerName, Problem, Scenario, TruckPlannerKind, Unimog};
use wildfire_planning::collision::ClearanceField;
use wildfire_planning::kit::floods::flood_bytes;
use wildfire_planning::kit::safety::SafetyMap;
use wildfire_planning::memory::{MemoryKind, MemoryMeter, ReservedMemory};
use wildfire_planning::registry::{RoadmapSize, TruckPlannerSettings};

/// Bytes that the program takes before it runs anything, and that small things take in every run.
const PROGRAM_BYTES: u64 = 27_000_000;

/// Which cells are occupied, and the bushes in the terrain, in the timeline and in the order in which ignitions light them.
const TERRAIN_BYTES: PerCell = PerCell { cell: 1, bush: 12 };

/// The state of fuel, before and after there is room for more of it, and what one fire spreads to.
const FIRE_BYTES: PerCell = PerCell { cell: 1, bush: 64 };

/// The state of the fuel of a cell whose ground burns, its fuel before and after bushes grow on it, its relief, and heights
/// while they are added up.
const GROUND_BYTES: u64 = 68;

/// A cell of Rothermel's front; the front's tables on top of all cells.
const FRONT_BYTES: u64 = 31;
const FRONT_TABLES_BYTES: u64 = 1 << 20;

/// The zone of moisture and the factor of a cell, and what files say of it while these are made.
const ZONE_BYTES: u64 = 16;

/// The heuristics of a truck's planner before they spread, and its small things.
const PLANNER_BYTES: u64 = 60_000;

/// A milestone of a roadmap and each of its links, while the roadmap is made and searched: 130 and 35 were measured with
/// 100,000 milestones and up to 40 links of each.
const MILESTONE_BYTES: u64 = 300;
const LINK_BYTES: u64 = 60;

/// What a cell of a map of safety costs more, and the map that this is computed from.
const SAFETY_BYTES: u64 = 16;

/// A point of a Wumpus's lattice: its moves, whether it is free, the connected part that it belongs to, and those that wait
/// while what can be reached is computed. A cell in the count of occupied cells comes on top.
const LATTICE_BYTES: u64 = 19;
const COUNT_BYTES: u64 = 4;

/// A point in a Wumpus's planner: its cost, its entries in lists that double, a walk as it is computed and taken.
const WALK_BYTES: u64 = 76;

/// Targets of Wumpuses, and what is walled in, for each bush, in lists that double.
const TARGET_BYTES: u64 = 16;

/// The limit of the memory that a run may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MemoryLimit {
    pub bytes: u64,
}

impl Default for MemoryLimit {
    fn default() -> Self {
        Self { bytes: 2_000_000_000 }
    }
}

impl fmt::Display for MemoryLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&bytes_text(self.bytes))
    }
}

/// Units of sizes and their bytes, without the `B` at their end.
const UNITS: [(&str, u64); 9] = [
    // A number without any unit is refused before: only `500000000B` comes here as this one.
    ("", 1),
    ("k", 1000),
    ("m", 1_000_000),
    ("g", 1_000_000_000),
    ("t", 1_000_000_000_000),
    ("ki", 1 << 10),
    ("mi", 1 << 20),
    ("gi", 1 << 30),
    ("ti", 1 << 40),
];

impl FromStr for MemoryLimit {
    type Err = String;

    /// Reads a number and its unit, such as `2GB`, `1.5 GiB` or `4G`, which is 4 GB.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected a size with its unit, from 1MB to 1000TB, such as 2GB, 512MiB or 4G".to_owned();
        let end = text.find(|letter: char| !letter.is_ascii_digit() && letter != '.').unwrap_or(text.len());
        let (number, unit) = text.split_at(end);
        let unit = unit.trim_start().to_ascii_lowercase();
        if unit.is_empty() {
            return Err(expected());
        }
        // `4G` is 4 GB, and `4Gi` is 4 GiB.
        let unit = unit.strip_suffix('b').unwrap_or(&unit);
        let bytes_of_one =
            UNITS.iter().find(|(name, _)| *name == unit).map(|&(_, bytes)| bytes).ok_or_else(expected)?;
        let number = number.parse::<f64>().map_err(|_| expected())?;
        let bytes = number * bytes_of_one as f64;
        if (1e6..=1e15).contains(&bytes) { Ok(Self { bytes: bytes as u64 }) } else { Err(expected()) }
    }
}

/// Writes a number of bytes for people: three digits and a unit.
pub fn bytes_text(bytes: u64) -> String {
    // From 999,500 on, three digits would read 1000 kB.
    let (divisor, unit) = match bytes {
        0..1_000 => return format!("{bytes} B"),
        1_000..999_500 => (1e3, "kB"),
        999_500..999_500_000 => (1e6, "MB"),
        999_500_000..999_500_000_000 => (1e9, "GB"),
        _ => (1e12, "TB"),
    };
    let number = bytes as f64 / divisor;
    let digits = if number < 9.995 { 2 } else { usize::from(number < 99.95) };
    let text = format!("{number:.digits$}");
    let short = if digits > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{short} {unit}")
}

/// An upper bound of the memory that a run takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryEstimate {
    /// The memory that it needs in any case.
    pub parts: Vec<MemoryPart>,
    /// Bytes of the parts that grow and are counted as they do: floods of trucks that plan by nothing else.
    counted: u64,
    /// Says whether there are trucks, whose searches, floods and curves come on top.
    pub has_trucks: bool,
}

/// Bytes for every cell of a field and for every bush.
struct PerCell {
    cell: u64,
    bush: u64,
}

/// The reason why a run does not take place or ends early: memory.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MemoryExceeded {
    #[error(
        "it would use up to {} of memory, {} of that for {}; the limit is {limit}, and --memory sets another",
        bytes_text(*.needed), bytes_text(.largest.bytes), .largest.name
    )]
    Needed { needed: u64, largest: MemoryPart, limit: MemoryLimit },
    #[error(
        "it reached the memory limit, {limit}: {} for its fixed parts, {} for {kind}; --memory sets another limit",
        bytes_text(*.needed), bytes_text(*.bytes)
    )]
    Grown { needed: u64, kind: MemoryKind, bytes: u64, limit: MemoryLimit },
}

impl MemoryEstimate {
    /// Adds up what a run of a scenario that was checked takes.
    pub fn new(scenario: &Scenario) -> Self {
        let frame = scenario.field.frame();
        let bushes = match &scenario.field.imported {
            Some(imported) => imported.occupied.values().iter().filter(|&&occupied| occupied).count() as u64,
            // A piece has four cells; pieces that find no room make the true number smaller.
            None => 4 * u64::from(scenario.field.wanted_pieces()),
        };
        let field = FieldMeasures { frame, bushes };
        let [terrain, laying] = field.terrain();
        let has_zones =
            scenario.local_moisture().is_some() || scenario.barrier.iter().any(|barrier| barrier.factor.is_some());
        let has_factors = scenario.fire.rothermel.as_ref().is_some_and(|it| !it.imported_factors.is_empty());
        let zones = if has_zones || has_factors { ZONE_BYTES * field.cells() } else { 0 };
        let fires = field.fires(scenario.fire.model) + zones;
        let fixed = [("the program", PROGRAM_BYTES), ("the field and its fires", terrain + fires)];
        let agents = scenario.kinds().map(|agents| agents.memory(&field, scenario.duration_s));
        Self::add_up(fixed, laying, agents)
    }

    /// Adds up what planning the drives of a problem takes, by these planners one after the other.
    pub fn from_problem(problem: &Problem, planners: &[PlannerName]) -> Self {
        let terrain = &problem.terrain;
        let field = FieldMeasures { frame: terrain.frame, bushes: terrain.bushes.len() as u64 };
        let [terrain_bytes, laying] = field.terrain();
        let fixed = [("the program", PROGRAM_BYTES), ("the field", terrain_bytes)];
        let by_planner = planners.iter().map(|planner| {
            let truck = Unimog { planner: planner.clone(), ..problem.truck.clone() };
            Self::add_up(fixed, laying, [vec![truck].memory(&field, 0.0)])
        });
        // Planners are built one after the other, so the largest counts and not the sum.
        by_planner.max_by_key(Self::needed).unwrap_or_else(|| Self::add_up(fixed, laying, []))
    }

    /// Adds up the parts that belong to no agent, and those of agents. `laying` is only needed while the field is made.
    fn add_up(fixed: [(&str, u64); 2], laying: u64, agents: impl IntoIterator<Item = AgentsMemory>) -> Self {
        let mut parts = fixed.map(|(name, bytes)| MemoryPart::new(name, bytes)).to_vec();
        let (mut counted, mut has_trucks) = (0, false);
        for of_kind in agents {
            parts.extend(of_kind.parts);
            counted += of_kind.counted;
            has_trucks |= of_kind.searches;
        }
        parts.push(MemoryPart::new("temporary data while the field is generated", laying));
        parts.retain(|part| part.bytes > 0);
        Self { parts, counted, has_trucks }
    }

    /// Adds up the bytes that the run needs in any case, at most.
    pub fn needed(&self) -> u64 {
        self.parts.iter().map(|part| part.bytes).sum()
    }

    /// Creates a meter for what grows, which allows what is left of the limit.
    ///
    /// # Errors
    /// Fails if not even what the run needs in any case is within the limit.
    pub fn meter(&self, limit: MemoryLimit) -> Result<MemoryMeter, MemoryExceeded> {
        let needed = self.needed();
        if needed <= limit.bytes {
            // The meter counts floods as they grow, so they are not taken off its limit once more.
            return Ok(MemoryMeter::new(limit.bytes - (needed - self.counted)));
        }
        // The largest part is the one that a smaller setting should shrink.
        let largest = self.parts.iter().max_by_key(|part| part.bytes).expect("the program is a part");
        Err(MemoryExceeded::Needed { needed, largest: largest.clone(), limit })
    }

    /// Returns the error of a run in which a meter of this estimate has refused memory.
    pub fn overrun(&self, meter: &MemoryMeter, limit: MemoryLimit) -> Option<MemoryExceeded> {
        let needed = self.needed() - self.counted;
        meter.overrun().map(|ReservedMemory { kind, bytes }| MemoryExceeded::Grown { needed, kind, bytes, limit })
    }
}

impl FieldMeasures {
    fn cells(&self) -> u64 {
        self.frame.cell_count() as u64
    }

    fn bytes(&self, PerCell { cell, bush }: PerCell) -> u64 {
        cell * self.cells() + bush * self.bushes
    }

    /// Returns the bytes of bushes and clearance, and the bytes on top of that while they are computed.
    fn terrain(&self) -> [u64; 2] {
        let [clearance, working_out] = ClearanceField::bytes(&self.frame);
        // While pieces are laid: which cells are closed, beside those that are occupied.
        [self.bytes(TERRAIN_BYTES) + clearance, working_out.max(2 * self.cells())]
    }

    /// Returns the bytes of fires and of the ground that they burn on.
    fn fires(&self, model: FireModelName) -> u64 {
        match model {
            FireModelName::Radius => self.bytes(FIRE_BYTES),
            FireModelName::Rothermel => (GROUND_BYTES + FRONT_BYTES) * self.cells() + FRONT_TABLES_BYTES,
            FireModelName::Alexandridis => GROUND_BYTES * self.cells(),
        }
    }

    /// Returns the bytes of a truck's planner, and those of its floods if it plans by floods alone.
    pub fn truck_planner(&self, planner: TruckPlannerKind, settings: &TruckPlannerSettings<'_>) -> [u64; 2] {
        let maker = planner.maker();
        let of_roadmap =
            |size: RoadmapSize| size.milestones * (MILESTONE_BYTES + LINK_BYTES * u64::from(size.neighbours));
        let roadmap = maker.roadmap_size(settings, &self.frame, self.bushes as usize).map_or(0, of_roadmap);
        // Planners without the table `safety` never build such a map.
        let is_by_map = settings.safety.map != SafetyMap::None && maker.tables().contains(&"safety");
        let surcharges = if is_by_map { SAFETY_BYTES * self.cells() } else { 0 };
        match planner {
            TruckPlannerKind::Lattice => [0, flood_bytes(&self.frame, settings.lattice.max_expansions)],
            _ => [PLANNER_BYTES + roadmap + surcharges, 0],
        }
    }

    /// Returns the bytes of a Wumpus's lattice of this number of points, of its planner and of its targets.
    pub fn walk(&self, points: u64) -> [u64; 3] {
        [LATTICE_BYTES * points + COUNT_BYTES * self.cells(), WALK_BYTES * points, TARGET_BYTES * self.bushes]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BUILT_IN, TruckPlannerKind, load};

    fn estimate(source: &str, changes: &[&str]) -> MemoryEstimate {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        MemoryEstimate::new(&load(source, &changes).expect("this scenario is right"))
    }

    #[test]
    fn sizes_have_units_of_thousands_or_of_1024() {
        let bytes = |text: &str| text.parse::<MemoryLimit>().map(|limit| limit.bytes);
        for (text, expected) in [
            ("2GB", 2_000_000_000),
            ("4G", 4_000_000_000),
            ("1.5 gb", 1_500_000_000),
            ("512MiB", 512 << 20),
            ("4Gi", 4 << 30),
            ("500000001B", 500_000_001),
            ("1000kB", 1_000_000),
            ("2TiB", 2 << 40),
        ] {
            assert_eq!(bytes(text), Ok(expected), "{text}");
        }
        for text in [
            "", "2", "GB", "2XB", "-2GB", "+2GB", "2,5GB", "1..5GB", "0GB", "999kB", "2000TB", "1e3MB", "2GBB", "nanGB",
        ] {
            assert!(bytes(text).expect_err(text).contains("such as 2GB, 512MiB or 4G"), "{text}");
        }
    }

    #[test]
    fn bytes_are_written_with_three_digits() {
        for (bytes, text) in [
            (0, "0 B"),
            (999, "999 B"),
            (1_000, "1 kB"),
            (999_499, "999 kB"),
            (999_500, "1 MB"),
            (12_345_678, "12.3 MB"),
            (2_000_000_000, "2 GB"),
            (1 << 30, "1.07 GB"),
            (3_200_000_000_000, "3.2 TB"),
        ] {
            assert_eq!(bytes_text(bytes), text);
        }
    }

    #[test]
    fn built_in_scenarios_stay_far_below_the_limit() {
        for (name, _) in BUILT_IN {
            let estimate = estimate(name, &[]);
            let max = match *name {
                // Four trucks on 40,000 cells of ground; twenty trucks on 160,000.
                "landscape" | "brigade" => 120_000_000,
                // Four million cells.
                "county" => 600_000_000,
                _ => 60_000_000,
            };
            assert!(estimate.needed() < max, "{name}: {estimate:?}");
            assert!(estimate.meter(MemoryLimit::default()).is_ok(), "{name}");
        }
    }

    #[test]
    fn settings_of_every_used_planner_count_and_no_others() {
        let of =
            |planner: &str, change: &str| estimate("contest", &[&format!("unimog.planner={planner}"), change]).needed();
        let plain = |planner: &str| of(planner, "unimog.speed_mps=8");
        for (change, planner) in
            [("unimog.prm_rs.samples=100000", "prm-rs"), ("unimog.prm.samples=100000", "prm+primitives")]
        {
            for kind in TruckPlannerKind::ALL {
                let grows = of(kind.name(), change) > plain(kind.name()) + 10_000_000;
                assert_eq!(grows, kind.name() == planner, "{change} for {kind}");
            }
        }
    }

    #[test]
    fn what_exceeds_the_limit_is_refused_with_its_largest_part() {
        let estimate = estimate("contest", &["unimog.prm_rs.samples=100000", "unimog.prm_rs.neighbours=100"]);
        let tight = MemoryLimit { bytes: estimate.needed() - 1 };
        let refusal = estimate.meter(tight).expect_err("a byte is missing").to_string();
        assert!(refusal.contains("for the planner of a truck (prm-rs)"), "{refusal}");
        assert!(estimate.meter(MemoryLimit { bytes: estimate.needed() }).is_ok());
    }
}
