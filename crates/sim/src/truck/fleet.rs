//! The trucks together: the data of their systems, and how a change of one affects the others.

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use glam::DVec2;

use super::{Drive, Truck};
use crate::agent::{Activity, Agent, AgentOrder};
use crate::fire::Fires;
use crate::queue::{AgentEvent, CellEvent, Due, SimClock, SimQueue, Wake};
use crate::recorder::Recorder;
use crate::traffic::{Reservation, Traffic};
use crate::water::WaterNeeds;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Trajectory;
use wildfire_fire::FireField;
use wildfire_timeline::{AgentFact, AgentId};

/// The trucks among the agents.
#[derive(SystemParam)]
pub struct Trucks<'w, 's>(Query<'w, 's, (&'static mut Agent, &'static mut Truck)>);

impl Trucks<'_, '_> {
    pub fn contains(&self, agent: Entity) -> bool {
        self.0.contains(agent)
    }

    pub fn count(&self) -> usize {
        self.0.iter().len()
    }

    pub fn agents(&self) -> impl Iterator<Item = &Agent> {
        self.0.iter().map(|(agent, _)| agent)
    }

    /// Returns a truck by its entity. An entity that is no truck is a bug.
    pub fn one(&self, truck: Entity) -> (&Agent, &Truck) {
        self.0.get(truck).expect("the entity is a truck")
    }

    pub fn one_mut(&mut self, truck: Entity) -> (Mut<'_, Agent>, Mut<'_, Truck>) {
        self.0.get_mut(truck).expect("the entity is a truck")
    }
}

/// All trucks, and the records that they write.
#[derive(SystemParam)]
pub struct Fleet<'w, 's> {
    clock: Res<'w, SimClock>,
    roster: Res<'w, AgentOrder>,
    pub queue: ResMut<'w, SimQueue>,
    pub recorder: ResMut<'w, Recorder>,
    pub trucks: Trucks<'w, 's>,
    /// The water that fires take, where their heat matters.
    pub needs: Option<Res<'w, WaterNeeds>>,
}

impl Fleet<'_, '_> {
    pub fn now(&self) -> SimTime {
        self.clock.0
    }

    /// Takes the next entry if it is due now, is this event, and is for a truck.
    pub fn take(&mut self, event: AgentEvent) -> Option<Wake> {
        self.queue.take_for(self.clock.0, event, |entity| self.trucks.contains(entity))
    }

    /// All trucks, in the order of the agents.
    fn entities(&self) -> impl Iterator<Item = Entity> {
        self.roster.0.iter().copied().filter(|&agent| self.trucks.contains(agent))
    }

    pub fn id_of(&self, entity: Entity) -> AgentId {
        self.trucks.one(entity).0.id
    }

    /// Lists the goals of all trucks but some.
    pub fn claimed(&self, except: &[Entity]) -> Vec<Cell> {
        let others = self.entities().filter(|entity| !except.contains(entity));
        others.filter_map(|entity| self.trucks.one(entity).0.goal).collect()
    }

    /// Lists the present and future positions of all trucks; empty for a single truck, which concerns nobody.
    pub fn reservations(&self) -> Vec<Reservation> {
        let trucks = self.entities().map(|entity| {
            let (agent, truck) = self.trucks.one(entity);
            let is_idle = matches!(agent.activity, Activity::Resting(_) | Activity::Blocked);
            Reservation::new(entity, agent.id, truck.body, agent.trajectory.clone(), is_idle)
        });
        if self.trucks.count() > 1 { trucks.collect() } else { Vec::new() }
    }

    /// Wakes trucks that rest or are blocked, because a fire has become free.
    pub fn wake_resting(&mut self, except: Entity) {
        self.wake_trucks(except, |activity| matches!(activity, Activity::Resting(_) | Activity::Blocked));
    }

    /// Wakes trucks that are blocked, because a truck has changed its path or stands longer.
    pub fn wake_blocked(&mut self, except: Entity) {
        self.wake_trucks(except, |activity| activity == Activity::Blocked);
    }

    fn wake_trucks(&mut self, except: Entity, are_woken: impl Fn(Activity) -> bool) {
        let others: Vec<Entity> = self.entities().filter(|&entity| entity != except).collect();
        for entity in others {
            let (mut agent, _) = self.trucks.one_mut(entity);
            if are_woken(agent.activity) {
                agent.reconsider(entity, self.clock.0, &mut self.queue);
            }
        }
    }

    /// Sends a truck on a drive.
    pub fn set_out(&mut self, entity: Entity, drive: Drive, leg: Trajectory) {
        let (mut agent, mut truck) = self.trucks.one_mut(entity);
        let Drive { goal, effort, back_m, found_by, .. } = drive;
        truck.tracks.set_out(back_m);
        let found_by = Some(found_by);
        let fact = AgentFact::Planned { goal, trajectory: leg.clone(), effort, found_by };
        agent.answer(self.clock.0, fact, &mut self.recorder);
        agent.set_out(entity, self.clock.0, goal, leg, AgentEvent::Arrival, &mut self.queue);
    }

    /// Lets a truck without a goal move aside for another truck.
    pub fn give_way(&mut self, entity: Entity, to: AgentId, way: Trajectory) {
        let (mut agent, mut truck) = self.trucks.one_mut(entity);
        // The drives that it kept begin where it no longer stands.
        truck.blocked.clear();
        let fact = AgentFact::GaveWay { to, trajectory: way.clone() };
        self.recorder.record_agent(self.clock.0, agent.id, fact);
        (agent.activity, agent.staging_point) = (Activity::Moving, None);
        agent.trajectory = way;
        let arrives = agent.trajectory.end_time();
        agent.reconsider(entity, arrives, &mut self.queue);
    }

    /// Lets a truck that drives to a place to wait stop where it blocks nobody.
    pub fn halt(&mut self, entity: Entity) {
        let reservations = self.reservations();
        let (mut agent, truck) = self.trucks.one_mut(entity);
        let traffic = Traffic::new(&reservations, entity);
        let cut = traffic.stopping(&truck.body, &agent.trajectory, self.clock.0, &truck.speed);
        agent.halt(entity, self.clock.0, cut, &mut self.queue, &mut self.recorder);
    }

    /// Lets a truck drop its goal and stop where it blocks nobody.
    pub fn drop_goal(&mut self, entity: Entity) {
        let reservations = self.reservations();
        let (mut agent, truck) = self.trucks.one_mut(entity);
        let traffic = Traffic::new(&reservations, entity);
        let cut = traffic.stopping(&truck.body, &agent.trajectory, self.clock.0, &truck.speed);
        agent.drop_goal(entity, self.clock.0, cut, &mut self.queue, &mut self.recorder);
    }
}

/// Lets trucks whose fire is over decide again: where they stand, or where they come to stand.
pub fn lose_goal(mut fleet: Fleet) {
    while let Some(wake) = fleet.take(AgentEvent::GoalLost) {
        let (mut agent, _) = fleet.trucks.one_mut(wake.agent);
        if agent.activity != Activity::Suppressing {
            fleet.drop_goal(wake.agent);
            fleet.wake_blocked(wake.agent);
        } else if let Some(cell) = agent.goal.take() {
            fleet.recorder.record_agent(fleet.clock.0, agent.id, AgentFact::SuppressionEnded { cell });
            agent.activity = Activity::Idle;
            agent.reconsider(wake.agent, fleet.clock.0, &mut fleet.queue);
        }
    }
}

/// A stop at a fire.
struct FireStop {
    by: AgentId,
    goal: Cell,
    /// Where the truck's body centre is, and how far it reaches around it.
    centre: DVec2,
    reach_m: f64,
    extinguishes_all: bool,
    wets: Option<SimTime>,
}

impl FireStop {
    fn new(agent: &Agent, truck: &Truck, goal: Cell) -> Self {
        let centre = truck.body.body_centre(agent.trajectory.end());
        let &Truck { reach_m, extinguishes_all, wets, .. } = truck;
        Self { by: agent.id, goal, centre, reach_m, extinguishes_all, wets }
    }

    /// Lists what burns in reach besides its goal, by index, if it puts that out too.
    fn others<'a>(&'a self, fires: &'a FireField) -> impl Iterator<Item = Cell> + 'a {
        let burning = fires.burning().filter(|_| self.extinguishes_all);
        burning.filter(|&cell| cell != self.goal && self.is_in_reach(fires.frame(), cell))
    }

    fn is_in_reach(&self, frame: &FieldFrame, cell: Cell) -> bool {
        (frame.centre(cell) - self.centre).length() <= self.reach_m
    }

    /// Iterates by index over the cells in reach, at most the whole field.
    fn cells_in_reach<'a>(&'a self, frame: &'a FieldFrame) -> impl Iterator<Item = Cell> + 'a {
        // An infinite reach ends at the border of the field.
        let index = |m: f64, cells: u16| (m / frame.cell_m).clamp(0.0, f64::from(cells) - 1.0) as u16;
        let low = self.centre - self.reach_m;
        let high = self.centre + self.reach_m;
        let rows = index(low.y, frame.rows)..=index(high.y, frame.rows);
        let cols = index(low.x, frame.cols)..=index(high.x, frame.cols);
        let cells = rows.flat_map(move |row| cols.clone().map(move |col| Cell { col, row }));
        cells.filter(|&cell| self.is_in_reach(frame, cell))
    }
}

/// Extinguishes the fires of dwells that end. All that end at one instant count, even if one of them takes another's
/// fire.
pub fn end_dwell(mut fleet: Fleet, fires: Res<Fires>) {
    let now = fleet.now();
    let mut stops = Vec::new();
    while let Some(wake) = fleet.take(AgentEvent::DwellEnd) {
        let (mut agent, mut truck) = fleet.trucks.one_mut(wake.agent);
        // Its stop was ended before, for instance by a lost goal.
        if agent.revision != wake.revision {
            continue;
        }
        let goal = agent.goal.take().expect("a truck that suppresses has a goal");
        agent.activity = Activity::Idle;
        agent.reconsider(wake.agent, now, &mut fleet.queue);
        stops.push((FireStop::new(&agent, &truck, goal), truck.extinguish_set.take()));
    }
    let field = &fires.field;
    let frame = fires.field.frame();
    for (stop, extinguish_set) in &stops {
        let put_out: Vec<Cell> = match extinguish_set {
            Some(cells) => {
                // What burned out and began again meanwhile is another fire, which the water was not for.
                cells.iter().filter(|&&(cell, time)| field.goes_on(cell, time)).map(|&(cell, _)| cell).collect()
            }
            None => std::iter::once(stop.goal).chain(stop.others(field)).collect(),
        };
        for cell in put_out {
            fleet.queue.push(now, Due::Cell(CellEvent::Extinguish { cell, by: stop.by }));
        }
    }
    // What was burning when the water came is put out at best, and what is put out is wet for good.
    for (stop, _) in &stops {
        let Some(wets) = stop.wets else { continue };
        for cell in stop.cells_in_reach(frame).filter(|&cell| !field.is_burning(cell)) {
            fleet.queue.push(now, Due::Cell(CellEvent::Wet { cell, until: now + wets, by: stop.by }));
        }
    }
}

/// Lets trucks that arrived begin to suppress.
pub fn arrive(mut fleet: Fleet, fires: Res<Fires>) {
    let (now, field) = (fleet.now(), &fires.field);
    while let Some(wake) = fleet.take(AgentEvent::Arrival) {
        let (mut agent, mut truck) = fleet.trucks.one_mut(wake.agent);
        if agent.revision != wake.revision {
            continue;
        }
        agent.activity = Activity::Suppressing;
        let cell = agent.goal.expect("a truck drives to a goal");
        let mut water_units = 1;
        if let (Some(needs), Some(left)) = (&fleet.needs, agent.stops_left) {
            // Planned with what burns now: what catches fire during the stop gets no water.
            let stop = FireStop::new(&agent, &truck, cell);
            let mut others: Vec<Cell> = stop.others(field).collect();
            // Nearest first: water that does not last for all goes to them.
            others.sort_by(field.frame().by_distance(stop.centre));
            let plan = needs.plan_stop(cell, others, left);
            truck.extinguish_set = Some(plan.cells.into_iter().map(|cell| (cell, field.episode(cell))).collect());
            water_units = plan.water_units;
        }
        fleet.recorder.record_agent(now, agent.id, AgentFact::Suppressing { cell, water_units });
        let spraying = truck.water.as_ref().map_or(SimTime::ZERO, |water| water.spraying(water_units));
        agent.busy_until = now + truck.dwell + spraying;
        // Taken when the stop begins, so that a stop that is broken off has used its water.
        agent.stops_left = agent.stops_left.map(|stops| stops.saturating_sub(water_units));
        fleet.queue.push_for(agent.busy_until, AgentEvent::DwellEnd, agent.wake(wake.agent));
    }
}
