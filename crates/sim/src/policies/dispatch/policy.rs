//! A dispatch rule as a policy: what the trucks see becomes a [`Team`], and its goals and posts become choices.

use std::sync::Arc;

use glam::DVec2;

use super::of_scenario::DispatchRules;
use super::sight::TeamSight;
use super::team::{Assignment, Fire, Intact, RouteStart, Team, TeamRules, TeamTruck};
use crate::policies::{Action, AgentView, Observation, Policy, PolicyScope};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_fire::{BushState, FireField};
use wildfire_scenario::Sight;
use wildfire_timeline::{Activity, AgentId, WaterRules};

/// The members of a team and what it knows throughout a run.
#[derive(Clone, Debug)]
pub struct FleetContext {
    /// The latest end of the run.
    pub end: SimTime,
    pub frame: FieldFrame,
    pub rules: TeamRules,
    pub sight: Sight,
    pub water: Option<WaterRules>,
    /// The cells on which a bush grows, by cell index.
    pub bushes: Arc<[Cell]>,
    /// The trucks by number.
    pub trucks: Vec<TruckContext>,
}

/// What a team knows about one of its trucks throughout a run.
#[derive(Clone, Copy, Debug)]
pub struct TruckContext {
    pub id: AgentId,
    pub speed_mps: f64,
    /// The centre of its body before the run.
    pub start: DVec2,
}

/// A rule that assigns fires to trucks, and another that places the idle ones.
#[derive(Clone)]
pub struct DispatchPolicy {
    site: FleetContext,
    rules: DispatchRules,
    /// Simulated time for each pair of a truck and a fire that is looked at, or for each rollout.
    seconds_per_evaluation: f64,
    charge: SimTime,
}

impl DispatchPolicy {
    pub fn new(site: FleetContext, rules: DispatchRules, seconds_per_evaluation: f64) -> Self {
        Self { site, rules, seconds_per_evaluation, charge: SimTime::ZERO }
    }
}

impl Policy for DispatchPolicy {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        // Counted, not timed: planning time must be the same on every machine.
        let mut effort = 0;
        let knowledge = FleetKnowledge::new(&self.site, seen);
        let team = knowledge.team(queried);
        let goals = assign(self.rules.assignment.as_mut(), &team, seen, &mut effort);
        let goal_of = |id: AgentId| goals.iter().find(|&&(truck, _)| truck == id).map(|&(_, cell)| cell);
        let free = team.trucks.iter().filter(|truck| truck.is_queried && goal_of(truck.id).is_none());
        // Trucks without a goal refill first.
        let full_tank = self.site.water.as_ref().map_or(u32::MAX, |water| water.full_tank);
        let (full, to_refill): (Vec<&TeamTruck>, Vec<&TeamTruck>) =
            free.partition(|truck| truck.stops_left >= full_tank);
        let idle: Vec<AgentId> = full.iter().map(|truck| truck.id).collect();
        let posts = match &mut self.rules.staging {
            Some(staging) if !idle.is_empty() => staging.staging_points(&team, &idle),
            _ => Vec::new(),
        };
        let choice = |id: AgentId| {
            let truck = team.trucks.iter().find(|truck| truck.id == id)?;
            let staging_point = posts.iter().find(|(idle, _)| *idle == id).map(|&(_, place)| place);
            // A truck that is asked and still may not take a fire is out of water.
            let refills = !truck.is_queried || to_refill.iter().any(|other| other.id == id);
            let choice = match (goal_of(id), staging_point, truck.goal) {
                (None, ..) if refills => Action::Refill,
                (Some(_), _, _) if self.rules.assignment.is_by_drive() => Action::GoToNearest,
                (Some(cell), _, _) => Action::Go(cell),
                (None, Some(place), _) => Action::Move(place),
                // What it went for is not worth it any more.
                (None, None, Some(_)) => Action::Move(truck.place),
                // A report changes no cell, so nothing would wake the team when it comes.
                (None, None, None) => knowledge.sight.next_report().map_or(Action::Wait, Action::WaitUntil),
            };
            Some((id, choice))
        };
        let choices = queried.iter().filter_map(|&id| choice(id)).collect();
        self.charge = SimTime::from_seconds(self.seconds_per_evaluation * effort as f64);
        choices
    }

    fn asking(&self) -> PolicyScope {
        PolicyScope::Team { replans: self.rules.assignment.replans() }
    }

    fn charge(&self) -> SimTime {
        self.charge
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(self.clone()))
    }
}

/// Returns goals of trucks that are asked: fires that they may go for, and each fire for one truck.
fn assign(
    assignment: &mut dyn Assignment,
    team: &Team<'_>,
    seen: &Observation<'_>,
    effort: &mut u64,
) -> Vec<(AgentId, Cell)> {
    let kept: Vec<Cell> = team.trucks.iter().filter(|truck| !truck.is_queried).filter_map(|truck| truck.goal).collect();
    let mut goals: Vec<(AgentId, Cell)> = Vec::new();
    let mut barred = Vec::new();
    for (truck, cell) in assignment.assign(team, effort) {
        let is_taken = kept.contains(&cell) || goals.iter().any(|&(_, other)| other == cell);
        let is_queried = team.trucks.iter().any(|other| other.id == truck && other.is_queried);
        // Rules may be custom: what they assign twice or to others is passed over.
        if !is_queried || is_taken {
            continue;
        }
        if seen.options(truck).contains(&cell) { goals.push((truck, cell)) } else { barred.push(truck) }
    }
    // A truck that cannot get to the fire that was meant for it takes one that it can get to, of those that are left.
    for truck in barred {
        let options = seen.options(truck);
        let is_left = |fire: &Fire| {
            let is_taken = kept.contains(&fire.cell) || goals.iter().any(|&(_, other)| other == fire.cell);
            options.contains(&fire.cell) && !is_taken
        };
        let rest = Team {
            fires: team.fires.iter().copied().filter(is_left).collect(),
            trucks: team.trucks.iter().map(|other| TeamTruck { is_queried: other.id == truck, ..*other }).collect(),
            ..team.clone()
        };
        // The same rule for this truck alone, so that it chooses as the team would.
        let found = assignment.assign(&rest, effort).into_iter();
        goals.extend(found.filter(|&(id, cell)| id == truck && rest.fires.iter().any(|fire| fire.cell == cell)));
    }
    goals
}

/// What the team knows at one instant. Rules of dispatch get nothing else of the state of the field.
struct FleetKnowledge<'a> {
    site: &'a FleetContext,
    now: SimTime,
    fires: &'a FireField,
    agents: &'a [AgentView],
    sight: TeamSight<'a>,
}

impl<'a> FleetKnowledge<'a> {
    fn new(site: &'a FleetContext, seen: &Observation<'a>) -> Self {
        let sight = TeamSight::new(&site.sight, &site.frame, seen.now, seen.fires, seen.agents);
        Self { site, now: seen.now, fires: seen.fires, agents: seen.agents, sight }
    }

    fn team(&self, queried: &[AgentId]) -> Team<'_> {
        let FleetContext { end, frame, rules, water, trucks, .. } = self.site;
        let wumpuses = self.agents.iter().filter(|agent| agent.id.role.lights() && self.sight.sees_agent(agent));
        let trucks = trucks.iter().filter_map(|truck| {
            let view = self.agents.iter().find(|agent| agent.id == truck.id)?;
            Some(TeamTruck {
                id: truck.id,
                place: view.free_place,
                free_at: view.free_at,
                speed_mps: truck.speed_mps,
                goal: view.goal,
                staging_point: view.staging_point,
                start: truck.start,
                // Without water it cannot take a fire, only be free after a refill.
                is_queried: queried.contains(&truck.id) && view.stops_left != Some(0),
                stops_left: view.stops_left.unwrap_or(u32::MAX),
            })
        });
        let mut team = Team {
            now: self.now,
            end: *end,
            frame: *frame,
            rules: *rules,
            fires: self.seen_fires(),
            trucks: trucks.collect(),
            intact: self,
            wumpuses: wumpuses.map(|wumpus| wumpus.place).collect(),
            water: water.as_ref(),
        };
        // A truck that is out of water is one that will be free when it has filled its tank.
        for number in 0..team.trucks.len() {
            let TeamTruck { speed_mps, place, free_at, stops_left, goal, .. } = team.trucks[number];
            if stops_left == 0 && goal.is_none() {
                let RouteStart { place, time: free_at } = team.refilled(speed_mps, place, free_at, stops_left);
                let stops_left = water.as_ref().map_or(u32::MAX, |water| water.full_tank);
                team.trucks[number] = TeamTruck { place, free_at, stops_left, ..team.trucks[number] };
            }
        }
        team
    }

    /// Lists what burns, is seen, and has no truck that puts it out.
    fn seen_fires(&self) -> Vec<Fire> {
        let stops = self.agents.iter().filter(|agent| agent.activity == Activity::Suppressing);
        let stops: Vec<Cell> = stops.filter_map(|agent| agent.goal).collect();
        let fire = |cell: Cell| {
            let place = self.site.frame.centre(cell);
            let Some(BushState::Burning { since }) = self.fires.state(cell) else { return None };
            // How long ground burns is not a rule of the team's.
            let burn_out = self.site.rules.burn_out.filter(|_| self.fires.is_bush(cell));
            let burns_out = burn_out.map_or(SimTime::MAX, |burn_out| since + burn_out);
            let rules = &self.site.rules;
            let spreads = rules.spread.filter(|_| rules.caught_spreads || self.fires.is_source(cell));
            // A fire that has spread already threatens nothing more.
            let spreads_at = spreads.map(|(_, delay)| since + delay).filter(|&time| time > self.now);
            let spreads_at = spreads_at.unwrap_or(SimTime::MAX);
            (self.sight.knows(cell) && !stops.contains(&cell)).then_some(Fire {
                cell,
                place,
                since,
                burns_out,
                spreads_at,
            })
        };
        self.fires.burning().filter_map(fire).collect()
    }
}

impl Intact for FleetKnowledge<'_> {
    fn is_intact(&self, cell: Cell) -> bool {
        self.sight.takes_for_intact(cell)
    }

    fn bushes(&self) -> Arc<[Cell]> {
        Arc::clone(&self.site.bushes)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use wildfire_base::geometry::Pose;
    use wildfire_scenario::SightOfField;

    const FRAME: FieldFrame = FieldFrame { cols: 40, rows: 10, cell_m: 5.0 };
    const NEAR: Cell = Cell { col: 2, row: 2 };
    const MIDDLE: Cell = Cell { col: 20, row: 2 };
    const FAR: Cell = Cell { col: 38, row: 2 };

    fn site(sight: Sight) -> FleetContext {
        let burn_out = Some(SimTime::from_seconds(60.0));
        let spread = Some((30.0, SimTime::from_seconds(10.0)));
        let dwell = SimTime::from_seconds(5.0);
        let rules =
            TeamRules { reach_m: Some(10.0), dwell, extinguishes_all: false, spread, caught_spreads: false, burn_out };
        let truck =
            |number, x: f64| TruckContext { id: AgentId::unimog(number), speed_mps: 8.0, start: DVec2::new(x, 12.0) };
        FleetContext {
            end: SimTime::from_seconds(600.0),
            frame: FRAME,
            rules,
            sight,
            water: None,
            bushes: [NEAR, MIDDLE, FAR].into(),
            trucks: vec![truck(0, 12.0), truck(1, 30.0)],
        }
    }

    fn agent(id: AgentId, x: f64) -> AgentView {
        let place = DVec2::new(x, 12.0);
        let pose = Pose::new(x, 12.0, 0.0);
        let activity = Activity::Standing;
        let free_at = SimTime::from_seconds(20.0);
        AgentView {
            id,
            place,
            pose,
            activity,
            goal: None,
            staging_point: None,
            stops_left: None,
            free_at,
            free_place: place,
        }
    }

    /// The cells that burn, which bushes are intact, and the number of Wumpuses that a team saw.
    type Seen = (Vec<Cell>, Vec<bool>, usize);

    /// Keeps what it is shown, and sends every truck that is asked to the first fire.
    #[derive(Clone, Default)]
    struct Recording(Arc<Mutex<Vec<Seen>>>);

    impl Assignment for Recording {
        fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
            *effort += 3;
            let intact = team.intact.bushes().iter().map(|&cell| team.intact.is_intact(cell)).collect();
            let fires: Vec<Cell> = team.fires.iter().map(|fire| fire.cell).collect();
            self.0.lock().expect("nobody panicked").push((fires.clone(), intact, team.wumpuses.len()));
            let queried = team.trucks.iter().filter(|truck| truck.is_queried);
            fires.first().map_or_else(Vec::new, |&fire| queried.map(|truck| (truck.id, fire)).collect())
        }

        fn replans(&self) -> bool {
            true
        }
    }

    /// Fires at the near and the far bush, and a Wumpus at 100 m.
    fn choose(sight: Sight, options: impl Fn(AgentId) -> Vec<Cell>) -> (Vec<(AgentId, Action)>, Recording, SimTime) {
        let mut fires = FireField::new(FRAME, &[NEAR, MIDDLE, FAR], false);
        for cell in [NEAR, FAR] {
            fires.ignite(cell, SimTime::from_seconds(15.0), true).expect("it can burn");
        }
        let trucks = [AgentId::unimog(0), AgentId::unimog(1)];
        let agents = [agent(AgentId::wumpus(0), 100.0), agent(trucks[0], 12.0), agent(trucks[1], 30.0)];
        let recording = Recording::default();
        let rules = DispatchRules { assignment: Box::new(recording.clone()), staging: None };
        let mut policy = DispatchPolicy::new(site(sight), rules, 0.5);
        let now = SimTime::from_seconds(20.0);
        let seen = Observation { now, fires: &fires, agents: &agents, options_of: &options };
        let choices = policy.choose(&seen, &trucks);
        let charge = policy.charge();
        (choices, recording, charge)
    }

    #[test]
    fn a_team_knows_what_it_sees_and_nothing_else() {
        let shown = |field, radius_m, wumpuses| {
            let (_, recording, _) = choose(Sight { field, radius_m, wumpuses, report_s: None }, |_| vec![NEAR, FAR]);
            let shown = recording.0.lock().expect("nobody panicked");
            shown[0].clone()
        };
        use SightOfField::{Burning, Everything, Radius};
        assert_eq!(shown(Everything, 1.0, false), (vec![NEAR, FAR], vec![false, true, false], 0));
        assert_eq!(shown(Everything, 1.0, true).2, 1);
        assert_eq!(shown(Burning, 1.0, false), (vec![NEAR, FAR], vec![false, true, false], 0));
        // The far bush is on the map.
        assert_eq!(shown(Radius, 50.0, true), (vec![NEAR], vec![false, true, true], 0));
        assert_eq!(shown(Radius, 75.0, true).2, 1);
        assert_eq!(shown(Radius, 0.0, false).0, []);
    }

    #[test]
    fn fires_out_of_sight_count_when_they_are_reported() {
        let with = |report_s| Sight { field: SightOfField::Radius, radius_m: 0.0, report_s, wumpuses: false };
        let choices = |report_s| choose(with(report_s), |_| vec![NEAR, FAR]).0.into_iter().map(|(_, choice)| choice);
        // They began five seconds ago.
        assert!(choices(Some(5.0)).eq([Action::Go(NEAR), Action::Wait]));
        let later = Action::WaitUntil(SimTime::from_seconds(21.0));
        assert!(choices(Some(6.0)).eq([later, later]));
        assert!(choices(None).eq([Action::Wait, Action::Wait]));
    }

    #[test]
    fn what_burned_once_is_intact_to_those_who_see_fires_only() {
        let mut fires = FireField::new(FRAME, &[NEAR, MIDDLE, FAR], false);
        fires.ignite(NEAR, SimTime::ZERO, true).expect("it can burn");
        fires.burn_out(NEAR);
        let site = |field| site(Sight { field, ..Sight::default() });
        let knows = |field| {
            let site = site(field);
            let agents = [agent(AgentId::unimog(0), 12.0)];
            let seen = Observation { now: SimTime::ZERO, fires: &fires, agents: &agents, options_of: &|_| Vec::new() };
            FleetKnowledge::new(&site, &seen).is_intact(NEAR)
        };
        assert_eq!(
            [SightOfField::Everything, SightOfField::Burning, SightOfField::Radius].map(knows),
            [false, true, false]
        );
    }

    #[test]
    fn a_fire_goes_to_one_truck_and_who_cannot_get_there_takes_another() {
        let everything = Sight::default();
        let (choices, _, charge) = choose(everything.clone(), |_| vec![NEAR, FAR]);
        assert_eq!(choices, [(AgentId::unimog(0), Action::Go(NEAR)), (AgentId::unimog(1), Action::Wait)]);
        assert_eq!(charge, SimTime::from_seconds(1.5));
        let cannot = |id: AgentId| if id.number == 0 { vec![FAR] } else { vec![NEAR, FAR] };
        let (choices, _, charge) = choose(everything, cannot);
        assert_eq!(choices, [(AgentId::unimog(0), Action::Go(FAR)), (AgentId::unimog(1), Action::Go(NEAR))]);
        assert_eq!(charge, SimTime::from_seconds(3.0), "the second look costs too");
    }
}
