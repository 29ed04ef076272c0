//! Observations of a policy as arrays, and its actions as numbers.
//!
//! Row 0 of the field is the southernmost. Action 0 waits. An action of 1 or more selects a cell, counted row by row, or a
//! candidate if the policy chooses among the nearest.

use wildfire::fire::BushState;
use wildfire::fire::FireField;
use wildfire::geometry::{Cell, FieldFrame};
use wildfire::sim::policies::dispatch::TeamSight;
use wildfire::sim::policies::{Action, AgentView, cluster_sizes};
use wildfire::time::SimTime;
use wildfire::timeline::{Activity, AgentId};

/// Numbers of an agent: x, y, sine and cosine of the heading, x and y of the goal, activity, asked.
pub const AGENT_NUMBERS: usize = 8;

/// Numbers of a candidate: dx, dy, distance, seconds since ignition, size of its cluster, free.
pub const CANDIDATE_NUMBERS: usize = 6;

/// The shapes of a contest's arrays.
#[derive(Clone, Debug)]
pub struct Layout {
    pub frame: FieldFrame,
    pub agents: usize,
    /// The number of nearest cells that a policy chooses from, if not from all.
    pub nearest: Option<usize>,
    /// The longest wait of an agent.
    pub wait: SimTime,
    pub duration: SimTime,
}

impl Layout {
    /// Returns the number of actions.
    pub fn actions(&self) -> usize {
        1 + self.nearest.unwrap_or(self.frame.cell_count())
    }

    pub fn candidate_numbers(&self) -> usize {
        self.nearest.unwrap_or(0) * CANDIDATE_NUMBERS
    }
}

/// The state at one instant.
pub struct Sight<'a> {
    pub now: SimTime,
    pub fires: &'a FireField,
    /// All agents in the order of their names.
    pub agents: &'a [AgentView],
    /// What the team of trucks sees, if observers see no more.
    pub team: Option<TeamSight<'a>>,
}

/// The arrays shared by all observers of a contest.
pub struct SharedArrays<'a> {
    pub cells: &'a mut [u8],
    pub burning_s: &'a mut [f32],
    pub agents: &'a mut [f32],
    pub time_s: &'a mut [f32],
}

/// The arrays of one agent.
pub struct AgentArrays<'a> {
    pub action_mask: &'a mut [i8],
    /// Empty if the choice is among all cells.
    pub candidates: &'a mut [f32],
}

impl Sight<'_> {
    /// Writes the states of all cells with fuel and of all agents. Other cells keep their value of 0.
    pub fn write(&self, layout: &Layout, is_queried: impl Fn(AgentId) -> bool, arrays: &mut SharedArrays<'_>) {
        for cell in self.fires.with_fuel() {
            let index = layout.frame.index(cell);
            let (code, burning_s) = match self.fires.state(cell) {
                None => (0, 0.0),
                Some(BushState::Intact) => (1, 0.0),
                Some(BushState::Burning { since }) => (2, self.now.since(since).as_seconds() as f32),
                Some(BushState::Extinguished) => (3, 0.0),
                Some(BushState::BurnedOut) => (4, 0.0),
            };
            // The positions of bushes are known from the map.
            let is_shown = code == 0 || (if code == 2 { self.knows(cell) } else { !self.takes_for_intact(cell) });
            let (code, burning_s) = if is_shown { (code, burning_s) } else { (1, 0.0) };
            (arrays.cells[index], arrays.burning_s[index]) = (code, burning_s);
        }
        for (agent, numbers) in self.agents.iter().zip(arrays.agents.chunks_exact_mut(AGENT_NUMBERS)) {
            let sin = agent.pose.direction().y;
            let cos = agent.pose.direction().x;
            let goal = agent.goal.map_or([-1.0, -1.0], |cell| layout.frame.centre(cell).to_array());
            let activity = match agent.activity {
                Activity::Standing => 0.0,
                Activity::Planning => 1.0,
                Activity::Driving => 2.0,
                Activity::Suppressing => 3.0,
                Activity::Waiting => 4.0,
                Activity::Refilling => 5.0,
            };
            let queried = f64::from(u8::from(is_queried(agent.id)));
            let mut all = [agent.place.x, agent.place.y, sin, cos, goal[0], goal[1], activity, queried];
            if self.team.as_ref().is_some_and(|team| !team.sees_agent(agent)) {
                all = [-1.0, -1.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0];
            } else if self.team.is_some() && agent.id.role.lights() {
                // What a Wumpus is going to light nobody sees.
                [all[4], all[5]] = [-1.0, -1.0];
            }
            for (number, value) in numbers.iter_mut().zip(all) {
                *number = value as f32;
            }
        }
        let left = layout.duration.since(self.now);
        arrays.time_s.copy_from_slice(&[self.now, left].map(|time| time.as_seconds() as f32));
    }

    /// Returns true if observers know the state of a burning cell.
    pub fn knows(&self, cell: Cell) -> bool {
        self.team.as_ref().is_none_or(|team| team.knows(cell))
    }

    /// Lists the options of an agent that observers know: a cell that burns unseen is none.
    pub fn visible_options(&self, options: &[Cell]) -> Vec<Cell> {
        options.iter().copied().filter(|&cell| !self.fires.is_burning(cell) || self.knows(cell)).collect()
    }

    fn takes_for_intact(&self, cell: Cell) -> bool {
        self.team.as_ref().map_or_else(|| self.fires.can_burn(cell), |team| team.takes_for_intact(cell))
    }

    /// Writes the choices of an agent; if none is asked, the only choice is to wait. Returns the cells of the candidates if
    /// the agent chooses among the nearest.
    pub fn write_agent(
        &self,
        layout: &Layout,
        queried: Option<(AgentId, &[Cell])>,
        arrays: &mut AgentArrays<'_>,
    ) -> Vec<Cell> {
        arrays.candidates.fill(0.0);
        if let Some(max) = layout.nearest {
            arrays.action_mask.fill(0);
            arrays.action_mask[0] = 1;
            let viewer = queried.and_then(|(id, _)| self.agents.iter().find(|agent| agent.id == id));
            let (Some(agent), Some((_, options))) = (viewer, queried) else { return Vec::new() };
            return self.write_candidates(layout, max, agent, options, arrays);
        }
        // Options are cells with fuel, so no other cell was ever allowed: on a sparse field that saves most of the work.
        for cell in self.fires.with_fuel() {
            arrays.action_mask[1 + layout.frame.index(cell)] = 0;
        }
        arrays.action_mask[0] = 1;
        for &cell in queried.map_or(&[][..], |(_, options)| options) {
            arrays.action_mask[1 + layout.frame.index(cell)] = 1;
        }
        Vec::new()
    }

    fn write_candidates(
        &self,
        layout: &Layout,
        max: usize,
        agent: &AgentView,
        options: &[Cell],
        arrays: &mut AgentArrays<'_>,
    ) -> Vec<Cell> {
        let frame = &layout.frame;
        let suppresses = agent.id.role.suppresses();
        let distance_m = |cell: Cell| (frame.centre(cell) - agent.place).length();
        let mut nearest: Vec<(f64, usize, Cell)> = if suppresses {
            let visible = self.fires.burning().filter(|&cell| self.knows(cell));
            visible.map(|cell| (distance_m(cell), frame.index(cell), cell)).collect()
        } else {
            self.fires.flammable().map(|cell| (distance_m(cell), frame.index(cell), cell)).collect()
        };
        // With equal distances the index decides: an unstable sort alone need not give the same order for the same contest.
        nearest.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.truncate(max);
        // Clusters join fires that a team may not see.
        // What a Wumpus chooses among does not burn, so it belongs to no cluster.
        let sizes = if suppresses && self.team.is_none() { cluster_sizes(self.fires) } else { Vec::new() };
        for (place, &(distance_m, index, cell)) in nearest.iter().enumerate() {
            let is_free = options.binary_search_by_key(&index, |&option| frame.index(option)).is_ok();
            arrays.action_mask[1 + place] = i8::from(is_free);
            let away = frame.centre(cell) - agent.place;
            let burning_s = match self.fires.state(cell) {
                Some(BushState::Burning { since }) => self.now.since(since).as_seconds(),
                _ => 0.0,
            };
            let cluster = f64::from(sizes.get(index).copied().unwrap_or(0));
            let all = [away.x, away.y, distance_m, burning_s, cluster, f64::from(u8::from(is_free))];
            let numbers = &mut arrays.candidates[place * CANDIDATE_NUMBERS..(place + 1) * CANDIDATE_NUMBERS];
            for (number, value) in numbers.iter_mut().zip(all) {
                *number = value as f32;
            }
        }
        nearest.into_iter().map(|(.., cell)| cell).collect()
    }
}

impl Layout {
    /// Returns the choice that an action below [`Self::actions`] stands for, given an agent's options, or `None` if it is
    /// not allowed. `candidates` are the cells that [`Sight::write_agent`] returned.
    pub fn choice(&self, action: usize, now: SimTime, options: &[Cell], candidates: &[Cell]) -> Option<Action> {
        let Some(index) = action.checked_sub(1) else { return Some(self.waiting(now)) };
        let cell = match self.nearest {
            Some(_) => *candidates.get(index)?,
            None => self.frame.cell(index),
        };
        let index = self.frame.index(cell);
        let is_option = options.binary_search_by_key(&index, |&option| self.frame.index(option)).is_ok();
        is_option.then_some(Action::Go(cell))
    }

    /// Returns the choice to wait.
    pub fn waiting(&self, now: SimTime) -> Action {
        Action::WaitUntil(now + self.wait)
    }
}
