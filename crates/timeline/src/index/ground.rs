//! The ground in the course of a run: when each cell burned, in a form that answers for any time directly.
//!
//! Ground burns in far greater numbers than bushes, so no state of all of it is kept. Each burning is a span of time, and
//! those of a cell are found by its index: a state is a look-up, a count at a time is a binary search. When ground burns
//! out follows from when it caught fire (see [`FlamingTimes`](crate::FlamingTimes)), when it dries from the fact
//! that wetted it; so neither is a fact.

use std::f64::consts::PI;
use std::sync::OnceLock;

use crate::{BushIgnition, BushState, Cause, GroundEvent, GroundFact, GroundOutcome, LineOutcome, Setting, Timeline};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;

/// The ground cells by state at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GroundCounts {
    /// The cells of ground that can burn or could.
    pub cells: u32,
    pub burning: u32,
    pub burned_out: u32,
    pub extinguished: u32,
}

impl GroundCounts {
    /// Returns the number of cells that have not caught fire so far.
    pub fn intact(&self) -> u32 {
        self.cells.saturating_sub(self.burning + self.burned_out + self.extinguished)
    }
}

/// A fire on a ground cell, from ignition to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Burning {
    pub ignited: SimTime,
    /// The end of the fire; [`SimTime::MAX`] if it never ends.
    pub ends: SimTime,
    /// True if a truck extinguished it; false if it burned out.
    pub is_extinguished: bool,
    /// The place of the ignition in [`Timeline::ground`].
    pub event: u32,
}

/// A cell, bush or ground, for as long as a truck's water lasts on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wetting {
    pub cell: Cell,
    pub from: SimTime,
    pub until: SimTime,
}

/// A cell of line that crews have cleared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearedCell {
    pub cell: Cell,
    pub from: SimTime,
    /// False if the fire was there before the crew.
    pub holds: bool,
}

/// The ground of a run at all times.
#[derive(Debug)]
pub struct GroundIndex {
    frame: FieldFrame,
    end: SimTime,
    /// By cell index: whether it is ground that burns.
    is_ground: Vec<bool>,
    /// By cell index: the place of its first burning, with one more at the end.
    first: Vec<u32>,
    /// By cell index, then time.
    burnings: Vec<Burning>,
    /// By cell index, then time.
    wettings: Vec<Wetting>,
    /// In order of time.
    line_cells: Vec<ClearedCell>,
    line: Option<LineOutcome>,
    cells: u32,
    /// Times, ascending: of ignitions, of ignitions of what had been extinguished, of both kinds of ends.
    ignited: Vec<SimTime>,
    relit: Vec<SimTime>,
    burned_out: Vec<SimTime>,
    extinguished: Vec<SimTime>,
    /// Counted when it is first asked for: batches never ask.
    front: OnceLock<Vec<FrontLength>>,
}

/// From a cell to those that it shares a side with: columns and rows.
const SIDES: [[i32; 2]; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

/// The front after a cell caught fire for the first time.
#[derive(Clone, Copy, Debug)]
struct FrontLength {
    from: SimTime,
    /// Sides of cells between ground that has burned or burns and other ground.
    sides: u32,
}

impl GroundIndex {
    /// Reads the ground of a run; `None` where only bushes burn. Takes some tens of nanoseconds per cell and fact.
    pub fn new(timeline: &Timeline) -> Option<Self> {
        let Timeline { setting, ground: log, .. } = timeline;
        let spread = setting.spread.as_ref()?;
        let frame = setting.frame;
        let end = timeline.end_time();
        let log = &log[..log.partition_point(|event| event.time <= end)];
        let is_ground = ground_cells(setting);
        let (first, mut burnings) = ignitions_by_cell(frame, log);
        let flaming = spread.flaming_times();
        // As if nothing were put out; facts below end some of these fires earlier.
        for (index, cell) in first.windows(2).enumerate() {
            for burning in &mut burnings[cell[0] as usize..cell[1] as usize] {
                burning.ends = flaming.burns_out_at(frame.cell(index), burning.ignited).unwrap_or(SimTime::MAX);
            }
        }
        let mut wettings = Vec::new();
        // A recording may name any flank that fits a byte.
        let mut along_mm = [0; 256];
        let mut line_cells = Vec::new();
        for event in log {
            match event.fact {
                GroundFact::Extinguished { .. } => {
                    let index = frame.index(event.cell);
                    let of_cell = &mut burnings[first[index] as usize..first[index + 1] as usize];
                    let started = of_cell.partition_point(|burning| burning.ignited <= event.time);
                    // What would burn out at this very instant is put out first.
                    if let Some(burning) = of_cell[..started].last_mut().filter(|burning| burning.ends >= event.time) {
                        (burning.ends, burning.is_extinguished) = (event.time, true);
                    }
                }
                GroundFact::Wetted { until, .. } => {
                    wettings.push(Wetting { cell: event.cell, from: event.time, until });
                }
                GroundFact::Cleared { flank, along_mm: so_far, holds } => {
                    let along = &mut along_mm[usize::from(flank)];
                    *along = so_far.max(*along);
                    line_cells.push(ClearedCell { cell: event.cell, from: event.time, holds });
                    let wetting = Wetting { cell: event.cell, from: event.time, until: SimTime::MAX };
                    wettings.extend(holds.then_some(wetting));
                }
                GroundFact::Ignited(_) => {}
            }
        }
        let built_m = along_mm.iter().map(|&along| f64::from(along) / 1000.0).sum::<f64>();
        // A cell counts as an average one.
        let lost_cells = line_cells.iter().filter(|cell| !cell.holds).count() as f64;
        // A line without cells has lost nothing, and 0 must not be divided by 0.
        let lost_m = built_m * lost_cells / (line_cells.len() as f64).max(1.0);
        let line = setting.line.as_ref().map(|_| LineOutcome { built_m, lost_m });
        // The log is in order of time, and the sort is stable.
        wettings.sort_by_key(|wetting| frame.index(wetting.cell));
        let times = |which: &dyn Fn(&Burning) -> Option<SimTime>| {
            // What still burns at the end of the run has not ended.
            let mut times: Vec<SimTime> = burnings.iter().filter_map(which).filter(|&time| time <= end).collect();
            times.sort_unstable();
            times
        };
        let relit = |cell: &[u32]| {
            let of_cell = &burnings[cell[0] as usize..cell[1] as usize];
            of_cell.windows(2).filter(|pair| pair[0].is_extinguished).map(|pair| pair[1].ignited)
        };
        let mut relit: Vec<SimTime> = first.windows(2).flat_map(relit).collect();
        relit.sort_unstable();
        Some(Self {
            frame,
            end,
            cells: is_ground.iter().filter(|&&is_ground| is_ground).count() as u32,
            is_ground,
            ignited: times(&|burning| Some(burning.ignited)),
            relit,
            burned_out: times(&|burning| (!burning.is_extinguished).then_some(burning.ends)),
            extinguished: times(&|burning| burning.is_extinguished.then_some(burning.ends)),
            first,
            burnings,
            wettings,
            line_cells,
            line,
            front: OnceLock::new(),
        })
    }

    /// Returns true if the cell is ground that burns or burned.
    pub fn is_ground(&self, cell: Cell) -> bool {
        self.is_ground[self.frame.index(cell)]
    }

    /// Returns the fires on a ground cell, in order of time.
    pub fn burnings_of(&self, cell: Cell) -> &[Burning] {
        let index = self.frame.index(cell);
        &self.burnings[self.first[index] as usize..self.first[index + 1] as usize]
    }

    /// Returns the state of a ground cell after all events at a time; `None` where no ground burns.
    pub fn state_at(&self, cell: Cell, time: SimTime) -> Option<BushState> {
        if !self.is_ground(cell) {
            return None;
        }
        let time = time.min(self.end);
        let started = self.burnings_of(cell).iter().rev().find(|burning| burning.ignited <= time);
        Some(match started {
            None => BushState::Intact,
            Some(burning) if burning.ends > time => BushState::Burning { since: burning.ignited },
            Some(Burning { is_extinguished: true, .. }) => BushState::Extinguished,
            Some(_) => BushState::BurnedOut,
        })
    }

    /// Returns the time until which a cell, bush or ground, stays wet, if it is wet at a time.
    pub fn wet_until(&self, cell: Cell, time: SimTime) -> Option<SimTime> {
        let index = self.frame.index(cell);
        let first = self.wettings.partition_point(|wetting| self.frame.index(wetting.cell) < index);
        let of_cell = self.wettings[first..].iter().take_while(|wetting| wetting.cell == cell);
        let started = of_cell.take_while(|wetting| wetting.from <= time.min(self.end));
        // A later wetting may end earlier, as line never dries.
        started.map(|wetting| wetting.until).max().filter(|&until| until > time)
    }

    /// Returns all wetting by trucks, and the line of crews, until [`SimTime::MAX`], by cell index and then time.
    pub fn wettings(&self) -> &[Wetting] {
        &self.wettings
    }

    /// Returns the cells of line that crews have cleared, in order of time.
    pub fn line_cells(&self) -> &[ClearedCell] {
        &self.line_cells
    }

    /// Counts the ground cells after all events at a time.
    pub fn counts_at(&self, time: SimTime) -> GroundCounts {
        let [ignited, relit, burned_out, extinguished] =
            [&self.ignited, &self.relit, &self.burned_out, &self.extinguished]
                .map(|times| times.partition_point(|&happened| happened <= time) as u32);
        GroundCounts {
            cells: self.cells,
            burning: ignited - burned_out - extinguished,
            burned_out,
            extinguished: extinguished.saturating_sub(relit),
        }
    }

    /// Returns the length of the edge of what has burned and burns, in metres, that of islands and of the field's edge included. A
    /// straight front across square cells is a staircase, 4 / pi times as long on average over its directions.
    pub fn perimeter_m_at(&self, time: SimTime) -> f64 {
        let front = self.front.get_or_init(|| self.measure_front());
        let so_far = front.partition_point(|length| length.from <= time);
        let sides = front[..so_far].last().map_or(0, |length| length.sides);
        0.25 * PI * self.frame.cell_m * f64::from(sides)
    }

    fn measure_front(&self) -> Vec<FrontLength> {
        let starts = self.first.windows(2).enumerate().filter(|(_, cell)| cell[0] < cell[1]);
        let mut starts: Vec<(SimTime, usize)> =
            starts.map(|(index, cell)| (self.burnings[cell[0] as usize].ignited, index)).collect();
        starts.sort_unstable();
        let mut has_burned = vec![false; self.frame.cell_count()];
        let mut sides = 0;
        let mut front = Vec::with_capacity(starts.len());
        for (from, index) in starts {
            let cell = self.frame.cell(index);
            let beside = SIDES.iter().filter_map(|&[cols, rows]| self.frame.offset(cell, cols, rows));
            let shared = beside.filter(|&other| has_burned[self.frame.index(other)]).count() as u32;
            // A new cell brings four sides; each that it shares is no front any more, for both cells.
            sides = sides + 4 - 2 * shared;
            has_burned[index] = true;
            front.push(FrontLength { from, sides });
        }
        front
    }

    /// Goes through all times at which the number of burning cells changes, with the number from then on.
    pub(super) fn burning_counts(&self) -> impl Iterator<Item = (SimTime, u32)> + '_ {
        let mut ignitions = &self.ignited[..];
        let mut out = FireEnds { first: &self.burned_out, second: &self.extinguished };
        let mut burning = 0_u32;
        std::iter::from_fn(move || {
            let now = [ignitions.first().copied(), out.next_time()].into_iter().flatten().min()?;
            let caught = ignitions.partition_point(|&time| time <= now);
            ignitions = &ignitions[caught..];
            burning = burning + caught as u32 - out.take_until(now);
            Some((now, burning))
        })
    }

    /// What the outcome of a run says of its ground.
    pub(super) fn outcome(&self, timeline: &Timeline) -> GroundOutcome {
        let end = self.counts_at(self.end);
        let causes_of_bushes = timeline.events.iter().take_while(|event| event.time <= self.end);
        let causes_of_bushes = causes_of_bushes.filter_map(|event| event.fact.ignition());
        let ground = timeline.ground.iter().take_while(|event| event.time <= self.end);
        let mut burned = vec![false; self.frame.cell_count()];
        let mut spotted = 0;
        let mut bushes_burned = 0_u32;
        for BushIgnition { cell, cause } in causes_of_bushes {
            // A bush that is lit again does not burn its area twice.
            bushes_burned += u32::from(!std::mem::replace(&mut burned[self.frame.index(cell)], true));
            spotted += u32::from(matches!(cause, Cause::Spotted(_)));
        }
        let is_spotted = |event: &&GroundEvent| matches!(event.fact, GroundFact::Ignited(Cause::Spotted(_)));
        spotted += ground.filter(is_spotted).count() as u32;
        let cells_burned = self.first.windows(2).filter(|cell| cell[0] < cell[1]).count() as u32;
        let reached_edge = self.reached_edge(timeline);
        let last_ignition = self.last_ignition(timeline);
        // A front between two cells leaves no fact: only a run that ended early has none left.
        let is_contained = self.end < timeline.setting.rules.duration && reached_edge.is_none();
        GroundOutcome {
            cells: self.cells,
            burned: cells_burned,
            extinguished: end.extinguished,
            spotted,
            burned_ha: f64::from(cells_burned + bushes_burned) * self.frame.cell_m * self.frame.cell_m / 1e4,
            peak_burning: self.burning_counts().map(|(_, burning)| burning).max().unwrap_or(0),
            reached_edge_s: reached_edge.map(SimTime::as_seconds),
            contained_at_s: last_ignition.filter(|_| is_contained).map(SimTime::as_seconds),
            escaped: last_ignition.map(|_| !is_contained),
            line: self.line,
        }
    }

    /// Returns when a cell last caught fire; `None` if none did, or if agents light fires.
    fn last_ignition(&self, timeline: &Timeline) -> Option<SimTime> {
        if timeline.setting.agents.iter().any(|agent| agent.id.role.lights()) {
            return None;
        }
        let ground = timeline.ground.iter().rev().find(|event| matches!(event.fact, GroundFact::Ignited(_)));
        let bush = timeline.events.iter().rev().find(|event| event.fact.ignition().is_some());
        ground.map(|event| event.time).max(bush.map(|event| event.time)).filter(|&time| time <= self.end)
    }

    /// Returns when a cell at the border of the field first caught fire.
    fn reached_edge(&self, timeline: &Timeline) -> Option<SimTime> {
        let FieldFrame { cols, rows, .. } = self.frame;
        let is_border = |cell: Cell| cell.col == 0 || cell.row == 0 || cell.col + 1 == cols || cell.row + 1 == rows;
        let ground = timeline.ground.iter().find(|event| {
            let is_ignition = matches!(event.fact, GroundFact::Ignited(_));
            is_ignition && is_border(event.cell)
        });
        let bush = timeline.events.iter().find(|event| event.fact.ignition().is_some_and(|it| is_border(it.cell)));
        let times = [ground.map(|event| event.time), bush.map(|event| event.time)];
        times.into_iter().flatten().min().filter(|&time| time <= self.end)
    }
}

/// The ends of fires, of both kinds.
struct FireEnds<'a> {
    first: &'a [SimTime],
    second: &'a [SimTime],
}

impl FireEnds<'_> {
    fn next_time(&self) -> Option<SimTime> {
        [self.first.first(), self.second.first()].into_iter().flatten().min().copied()
    }

    fn take_until(&mut self, now: SimTime) -> u32 {
        let first = self.first.partition_point(|&time| time <= now);
        let second = self.second.partition_point(|&time| time <= now);
        (self.first, self.second) = (&self.first[first..], &self.second[second..]);
        (first + second) as u32
    }
}

/// Says of each cell, by index, whether it is ground that burns.
fn ground_cells(setting: &Setting) -> Vec<bool> {
    let mut is_ground = Vec::new();
    if let Some(spread) = &setting.spread {
        let burns = spread.landscape().burning_numbers();
        is_ground.extend(spread.landscape().fuel.iter().map(|&number| burns[usize::from(number)]));
    }
    for &bush in &setting.bushes {
        is_ground[setting.frame.index(bush)] = false;
    }
    is_ground
}

/// Sorts the ignitions by cell index and time, with the place of each cell's first; their ends are not known yet.
fn ignitions_by_cell(frame: FieldFrame, log: &[GroundEvent]) -> (Vec<u32>, Vec<Burning>) {
    let mut first = vec![0_u32; frame.cell_count() + 1];
    let ignitions = || {
        let numbered = log.iter().enumerate();
        numbered.filter(|(_, event)| matches!(event.fact, GroundFact::Ignited(_)))
    };
    for (_, event) in ignitions() {
        first[frame.index(event.cell) + 1] += 1;
    }
    for index in 1..first.len() {
        first[index] += first[index - 1];
    }
    let nothing = Burning { ignited: SimTime::ZERO, ends: SimTime::MAX, is_extinguished: false, event: 0 };
    let mut burnings = vec![nothing; first[frame.cell_count()] as usize];
    // The log is in order of time, so the fires of each cell are as well.
    let mut next = first.clone();
    for (place, event) in ignitions() {
        let at = &mut next[frame.index(event.cell)];
        burnings[*at as usize] = Burning { ignited: event.time, event: place as u32, ..nothing };
        *at += 1;
    }
    (first, burnings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{self, B, seconds};
    use crate::{EndReason, Event, Fact};

    /// Finds what the log says of every cell, without an index.
    fn by_scanning(timeline: &Timeline, time: SimTime) -> Vec<Option<BushState>> {
        let frame = timeline.setting.frame;
        let flaming = timeline.setting.spread.as_ref().expect("it has ground").flaming_times();
        let cells = (0..frame.cell_count()).map(|index| frame.cell(index));
        let mut states: Vec<_> =
            cells.map(|cell| timeline.setting.is_ground(cell).then_some(BushState::Intact)).collect();
        for event in timeline.ground.iter().filter(|event| event.time <= time) {
            let Some(state) = &mut states[frame.index(event.cell)] else { continue };
            match event.fact {
                GroundFact::Ignited(_) => *state = BushState::Burning { since: event.time },
                GroundFact::Extinguished { .. } => *state = BushState::Extinguished,
                GroundFact::Wetted { .. } | GroundFact::Cleared { .. } => {}
            }
        }
        for (index, state) in states.iter_mut().enumerate() {
            if let Some(BushState::Burning { since }) = *state
                && flaming.burns_out_at(frame.cell(index), since).is_some_and(|end| end <= time)
            {
                *state = Some(BushState::BurnedOut);
            }
        }
        states
    }

    #[test]
    fn states_and_counts_are_what_a_scan_of_the_log_says() {
        for timeline in (0..3).map(|seed| sample::random_on_ground(seed, seconds(1500.0))).chain([sample::on_ground()])
        {
            let ground = GroundIndex::new(&timeline).expect("it has ground");
            let frame = timeline.setting.frame;
            let end = timeline.end_time();
            for time in (0..20).map(|part| SimTime::from_nanos(end.as_nanos() / 19 * part)).chain([end]) {
                let mut counts = GroundCounts::default();
                for (index, state) in by_scanning(&timeline, time).into_iter().enumerate() {
                    let cell = frame.cell(index);
                    assert_eq!(ground.state_at(cell, time), state, "{cell} at {time}");
                    counts.cells += u32::from(state.is_some());
                    counts.burning += u32::from(state.is_some_and(BushState::burns));
                    counts.burned_out += u32::from(state == Some(BushState::BurnedOut));
                    counts.extinguished += u32::from(state == Some(BushState::Extinguished));
                }
                assert_eq!(ground.counts_at(time), counts, "at {time}");
                let states = by_scanning(&timeline, time);
                let has_burned = |cell: Cell| !matches!(states[frame.index(cell)], None | Some(BushState::Intact));
                let burned = (0..states.len()).map(|index| frame.cell(index)).filter(|&cell| has_burned(cell));
                let is_front = |cell, [cols, rows]: [i32; 2]| !frame.offset(cell, cols, rows).is_some_and(has_burned);
                let sides: usize =
                    burned.map(|cell| SIDES.into_iter().filter(|&side| is_front(cell, side)).count()).sum();
                assert_eq!(ground.perimeter_m_at(time), 0.25 * PI * frame.cell_m * sides as f64, "at {time}");
            }
        }
    }

    #[test]
    fn every_change_of_what_burns_is_counted_once() {
        let timeline = sample::random_on_ground(7, seconds(1500.0));
        let ground = GroundIndex::new(&timeline).expect("it has ground");
        let counts: Vec<_> = ground.burning_counts().collect();
        assert!(counts.len() > 100 && counts.is_sorted_by(|a, b| a.0 < b.0));
        assert!(counts.iter().all(|&(time, burning)| ground.counts_at(time).burning == burning));
    }

    #[test]
    fn fire_is_contained_if_all_is_out_before_the_end_and_none_reached_the_border() {
        let mut timeline = sample::on_ground();
        timeline.setting.agents.retain(|agent| !agent.id.role.lights());
        let outcome = |timeline: &Timeline| GroundIndex::new(timeline).expect("it has ground").outcome(timeline);
        let last_s = timeline.ground.iter().rfind(|event| matches!(event.fact, GroundFact::Ignited(_)));
        let last_s = last_s.expect("ground burns").time.as_seconds();
        let time = timeline.end_time();
        timeline.events.retain(|event| !matches!(event.fact, Fact::Ended { .. }));
        timeline.events.push(Event { time, fact: Fact::Ended { reason: EndReason::NothingLeft } });
        timeline.setting.rules.duration = time + seconds(1.0);
        assert_eq!(
            (outcome(&timeline).contained_at_s, outcome(&timeline).escaped),
            (None, Some(true)),
            "at the border"
        );
        let frame = timeline.setting.frame;
        let is_inside =
            |cell: Cell| cell.col > 0 && cell.row > 0 && cell.col + 1 < frame.cols && cell.row + 1 < frame.rows;
        timeline.ground.retain(|event| is_inside(event.cell));
        timeline.events.retain(|event| event.fact.ignition().is_none_or(|it| is_inside(it.cell)));
        let found = outcome(&timeline);
        assert!(found.contained_at_s.is_some_and(|at_s| at_s <= last_s) && found.escaped == Some(false), "{found:?}");
        timeline.setting.rules.duration = time;
        assert_eq!((outcome(&timeline).contained_at_s, outcome(&timeline).escaped), (None, Some(true)), "at the end");
        timeline.setting.agents = sample::on_ground().setting.agents;
        let has_lighters = timeline.setting.agents.iter().any(|agent| agent.id.role.lights());
        assert_eq!(outcome(&timeline).escaped.is_none(), has_lighters);
    }

    #[test]
    fn a_run_written_by_hand_has_this_ground() {
        let timeline = sample::on_ground();
        let ground = GroundIndex::new(&timeline).expect("it has ground");
        let outcome = ground.outcome(&timeline);
        let expected = GroundOutcome {
            cells: 86,
            burned: 10,
            extinguished: 0,
            spotted: 2,
            burned_ha: 12.0 * 25.0 / 1e4,
            peak_burning: 6,
            reached_edge_s: Some(40.0),
            contained_at_s: None,
            escaped: outcome.escaped,
            line: None,
        };
        assert_eq!(outcome, expected);
        assert_eq!(ground.wet_until(B, seconds(29.0)), None);
        assert_eq!(ground.wet_until(B, seconds(30.0)), Some(seconds(60.0)));
        assert_eq!(ground.wet_until(B, seconds(60.0)), None);
        assert_eq!(ground.counts_at(seconds(31.0)).extinguished, 1);
        assert_eq!(ground.burnings_of(Cell { col: 6, row: 4 }).len(), 2);
    }
}
