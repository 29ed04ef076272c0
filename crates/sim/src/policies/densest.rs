//! The arsonist's policy of density: the cell from which fire reaches most, per metre of walk.
//!
//! A cell is worth what can burn within the reach of its fire, per metre of the straight way there. Alone, a Wumpus so goes
//! for the nearest dense thicket. In a team the same rule would send all to one thicket: there a cell is worth less the
//! nearer it is to another Wumpus, to where that one goes, or to a truck.

use glam::DVec2;

use super::nearest_intact::ring_around;
use super::{Action, AgentView, Observation, Policy, first_goes};
use wildfire_base::geometry::{Cell, FieldFrame, ops};
use wildfire_timeline::AgentId;

/// Added to every way, in metres: ten seconds' walk of the usual Wumpus, the time after which a bush spreads its fire. Without
/// it a lone bush at its feet would be worth more than any thicket.
const ADDED_M: f64 = 20.0;

/// The distance to others from which on they do not matter, metres: what a truck drives in some twenty seconds.
const APART_M: f64 = 150.0;

/// The farthest that is counted, metres: where fire goes farther, all of the field is in reach anyway.
const MAX_COUNTED_M: f64 = 100.0;

/// The share of a cell's worth that is left right beside others: where everything is near to them something has to be chosen.
const MIN_SHARE: f64 = 0.05;

/// Chooses the cell with most to burn around it per metre of walk. Ties go to the smaller cell index.
#[derive(Clone, Debug)]
pub struct Densest {
    /// Cells from one whose fire spreads to those it reaches, itself among them: columns and rows.
    reached: Vec<(i32, i32)>,
    keeps_apart: bool,
}

impl Densest {
    /// Creates the rule for a spread radius in metres.
    pub fn new(frame: &FieldFrame, spread_m: f64, keeps_apart: bool) -> Self {
        let spread_m = spread_m.min(MAX_COUNTED_M);
        // Cells farther away than the field is large are in no field.
        let cells = (spread_m / frame.cell_m).floor().min(f64::from(frame.cols.max(frame.rows))) as i32;
        let is_reached =
            |&(cols, rows): &(i32, i32)| ops::hypot(f64::from(cols), f64::from(rows)) * frame.cell_m <= spread_m;
        let square = (-cells..=cells).flat_map(|rows| (-cells..=cells).map(move |cols| (cols, rows)));
        Self { reached: square.filter(is_reached).collect(), keeps_apart }
    }

    /// Counts what can burn in reach of a fire of this cell.
    pub fn thickness(&self, seen: &Observation<'_>, cell: Cell) -> usize {
        let frame = seen.fires.frame();
        let around = self.reached.iter().filter_map(|&(cols, rows)| frame.offset(cell, cols, rows));
        around.filter(|&other| seen.fires.can_burn(other)).count()
    }
}

impl Policy for Densest {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        first_goes(seen, queried, |agent| self.best(seen, agent))
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(self.clone()))
    }
}

impl Densest {
    /// Lists where others are and go, if the agent keeps apart from them.
    pub fn others(&self, seen: &Observation<'_>, agent: &AgentView) -> Vec<DVec2> {
        let frame = seen.fires.frame();
        let others = seen.agents.iter().filter(|other| self.keeps_apart && other.id != agent.id);
        others.flat_map(|other| [Some(other.place), other.goal.map(|goal| frame.centre(goal))]).flatten().collect()
    }

    /// Returns the worth of a place with so many bushes around it to an agent that comes from another.
    pub fn worth(&self, thickness: f64, place: DVec2, from: DVec2, others: &[DVec2]) -> f64 {
        let nearest = others.iter().map(|other| (*other - place).length()).fold(f64::INFINITY, f64::min);
        let share = (nearest / APART_M).clamp(MIN_SHARE, 1.0);
        thickness * share / ((place - from).length() + ADDED_M)
    }

    /// Returns the best of an agent's options. They are most of a field at first, so they are not listed: square rings of
    /// cells about it are looked at, from the inside to the outside.
    fn best(&self, seen: &Observation<'_>, agent: &AgentView) -> Option<Cell> {
        let frame = seen.fires.frame();
        let others = self.others(seen, agent);
        let middle = (agent.place / frame.cell_m).floor();
        let middle = (middle.x as i32, middle.y as i32);
        let mut best: Option<(f64, Cell)> = None;
        for ring in 0..i32::from(frame.cols.max(frame.rows)) {
            // Were all in its reach to burn, no cell from here on would be worth more than this.
            let min_way_m = (f64::from(ring) - 1.0).max(0.0) * frame.cell_m + ADDED_M;
            if best.is_some_and(|(worth, _)| self.reached.len() as f64 / min_way_m < worth) {
                break;
            }
            for cell in ring_around(frame, middle, ring).filter(|&cell| seen.is_option(agent.id, cell)) {
                let place = frame.centre(cell);
                let worth = self.worth(self.thickness(seen, cell) as f64, place, agent.place, &others);
                if best.is_none_or(|(max, so_far)| {
                    worth > max || (worth == max && frame.index(cell) < frame.index(so_far))
                }) {
                    best = Some((worth, cell));
                }
            }
        }
        best.map(|(_, cell)| cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::Pose;
    use wildfire_base::time::SimTime;
    use wildfire_fire::FireField;
    use wildfire_timeline::Activity;

    const FRAME: FieldFrame = FieldFrame { cols: 60, rows: 60, cell_m: 5.0 };

    fn agent(number: u16, place: DVec2) -> AgentView {
        let pose = Pose::new(place.x, place.y, 0.0);
        let id = AgentId::wumpus(number);
        let activity = Activity::Standing;
        let free_at = SimTime::ZERO;
        let free_place = place;
        AgentView { id, place, pose, activity, goal: None, staging_point: None, stops_left: None, free_at, free_place }
    }

    fn select(bushes: &[Cell], agents: &[AgentView], keeps_apart: bool) -> Option<Cell> {
        let fires = FireField::new(FRAME, bushes, false);
        let options = bushes.to_vec();
        let seen = Observation { now: SimTime::ZERO, fires: &fires, agents, options_of: &|_: AgentId| options.clone() };
        Densest::new(&FRAME, 30.0, keeps_apart).best(&seen, &agents[0])
    }

    /// A square of bushes with its south-west corner there, by cell index.
    fn thicket(col: u16, row: u16, side: u16) -> Vec<Cell> {
        (0..side).flat_map(|rows| (0..side).map(move |cols| Cell { col: col + cols, row: row + rows })).collect()
    }

    fn sorted(mut cells: Vec<Cell>) -> Vec<Cell> {
        cells.sort_by_key(|cell| FRAME.index(*cell));
        cells
    }

    #[test]
    fn a_thicket_farther_away_is_worth_more_than_a_bush_nearby() {
        let place = FRAME.centre(Cell { col: 30, row: 30 });
        let bushes = sorted([thicket(31, 30, 1), thicket(40, 30, 6)].concat());
        let goal = select(&bushes, &[agent(0, place)], false).expect("there are options");
        assert!(goal.col >= 40, "{goal}");
        // The same thicket far enough away is not.
        let bushes = sorted([thicket(31, 30, 3), thicket(54, 54, 6)].concat());
        assert!(select(&bushes, &[agent(0, place)], false).expect("there are options").col < 40);
        assert_eq!(select(&[], &[agent(0, place)], false), None);
    }

    #[test]
    fn the_search_that_stops_early_finds_the_best_of_all() {
        for seed in 0..20_u64 {
            let is_bush = |cell: &Cell| wildfire_base::rng::key(seed, &cell.to_string()).is_multiple_of(10);
            let cells = (0..FRAME.cell_count()).map(|index| FRAME.cell(index));
            let bushes: Vec<Cell> = cells.filter(is_bush).collect();
            let agents = [agent(0, DVec2::new(150.0, 120.0)), agent(1, DVec2::new(90.0, 200.0))];
            for keeps_apart in [false, true] {
                let rule = Densest::new(&FRAME, 30.0, keeps_apart);
                let fires = FireField::new(FRAME, &bushes, false);
                let none = |_: AgentId| Vec::new();
                let seen = Observation { now: SimTime::ZERO, fires: &fires, agents: &agents, options_of: &none };
                let worth = |cell: &Cell| {
                    let place = FRAME.centre(*cell);
                    let apart = ((agents[1].place - place).length() / APART_M).clamp(MIN_SHARE, 1.0);
                    let share = if keeps_apart { apart } else { 1.0 };
                    let way_m = (place - agents[0].place).length() + ADDED_M;
                    rule.thickness(&seen, *cell) as f64 * share / way_m
                };
                let max = bushes.iter().map(worth).fold(0.0, f64::max);
                let first = bushes.iter().copied().find(|cell| worth(cell) == max);
                assert_eq!(select(&bushes, &agents, keeps_apart), first);
            }
        }
    }

    #[test]
    fn of_two_thickets_alike_one_takes_that_where_the_other_is_not() {
        let agents = [agent(0, DVec2::new(150.0, 150.0)), agent(1, DVec2::new(100.0, 160.0))];
        let bushes = sorted([thicket(18, 27, 5), thicket(38, 27, 5)].concat());
        assert!(select(&bushes, &agents, true).expect("there are options").col > 30);
    }
}
