//! Timelines for this layer's tests: one written by hand, and random ones of any length.

use rand::RngExt;

use std::sync::Arc;

use super::{
    AgentFact, AgentId, AgentStart, Body, BushState, Cause, EndReason, Event, Fact, FireFact, GroundEvent, GroundFact,
    RestReason, Rules, Setting, SpreadSetting, Timeline,
};
use wildfire_base::event_queue::EventQueue;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, Pose};
use wildfire_base::query::{Effort, FoundBy, PlanFailure, SearchGraph, SearchPhase};
use wildfire_base::rng::{self, Xoshiro256PlusPlus};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, SpeedLimits, Trajectory};
use wildfire_base::vehicle::{Dimensions, Path, Segment};
use wildfire_fire::models::RothermelRules;
use wildfire_fire::surface::FuelMoisture;
use wildfire_fire::{FireRules, Landscape, Relief, Weather, WeatherInterval};

pub const WUMPUS: AgentId = AgentId::wumpus(0);
pub const TRUCK: AgentId = AgentId::unimog(0);
pub const SECOND_TRUCK: AgentId = AgentId::unimog(1);

/// The bushes of the small field, in their order.
pub const A: Cell = Cell { col: 1, row: 1 };
pub const B: Cell = Cell { col: 5, row: 2 };
pub const C: Cell = Cell { col: 8, row: 8 };
pub const D: Cell = Cell { col: 2, row: 9 };

pub const LIMITS: SpeedLimits = SpeedLimits {
    forward_mps: 8.0,
    reverse_mps: 8.0,
    acceleration_mps2: Some(2.0),
    braking_mps2: None,
    lateral_mps2: Some(3.0),
    steering: None,
};

const FIRE: FireRules = FireRules {
    spread_delay: SimTime::from_nanos(10_000_000_000),
    spread_radius_m: 30.0,
    sources_spread: true,
    caught_spreads: false,
    burn_out: Some(SimTime::from_nanos(60_000_000_000)),
    reignition: false,
};

pub fn seconds(seconds: f64) -> SimTime {
    SimTime::from_seconds(seconds)
}

pub fn at(time_s: f64, fact: Fact) -> Event {
    Event { time: seconds(time_s), fact }
}

pub fn effort(roadmap_expansions: u32, local_expansions: u32) -> Effort {
    Effort { roadmap_expansions, local_expansions }
}

/// Straight pieces, negative lengths in reverse, at one speed.
pub fn leg(start_s: f64, start: Pose, speed_mps: f64, lengths_m: &[f64]) -> Trajectory {
    let piece = |&length_m: &f64| {
        let segment = Segment { curvature: 0.0, length_m };
        Piece::Drive { segment, speed_mps, acceleration_mps2: 0.0 }
    };
    Trajectory::new(seconds(start_s), start, lengths_m.iter().map(piece).collect())
}

pub fn planned(agent: AgentId, goal: Cell, trajectory: Trajectory) -> Fact {
    Fact::Agent(agent, AgentFact::Planned { goal, trajectory, effort: effort(5, 7), found_by: Some(FoundBy::Roadmap) })
}

pub fn ignited(cell: Cell) -> Fact {
    Fact::Fire(FireFact::Ignited { cell, cause: Cause::Scheduled })
}

pub fn small_setting(agents: &[AgentId]) -> Setting {
    let start = |&id: &AgentId| {
        let (pose, body) = if id.role.drives() {
            (Pose::new(10.0, 30.0, 0.0), Body::Truck(Dimensions::default()))
        } else {
            (Pose::new(22.5, 22.5, 0.0), Body::Square { size_m: 3.0 })
        };
        AgentStart { id, pose, body, limits: Some(LIMITS) }
    };
    Setting {
        scenario: "small".into(),
        seed: 7,
        program_version: "0.1.0".into(),
        frame: FieldFrame { cols: 10, rows: 10, cell_m: 5.0 },
        bushes: vec![A, B, C, D],
        blocked: Vec::new(),
        spread: None,
        water: None,
        ground_shares: Vec::new(),
        line: None,
        pieces: Vec::new(),
        agents: agents.iter().map(start).collect(),
        rules: Rules {
            duration: seconds(100.0),
            suppression_reach_m: Some(10.0),
            suppression_dwell: seconds(5.0),
            extinguishes_all: Some(false),
            fire: Some(FIRE),
            reignition: false,
            score_wumpus_ignited: 1.0,
            score_wumpus_burned_out: 1.0,
            score_truck_extinguished: 2.0,
        },
    }
}

/// A run of 90 s in which everything happens once; `outcome` tests tell its story in numbers.
pub fn by_hand() -> Timeline {
    let setting = small_setting(&[WUMPUS, TRUCK]);
    let [wumpus, truck] = [setting.agents[0].pose, setting.agents[1].pose];
    let first_walk = leg(0.0, wumpus, 2.0, &[20.0]);
    let cut_walk = leg(10.0, first_walk.end(), 2.0, &[14.0]);
    let first_drive = leg(12.0, truck, 8.0, &[16.0, -8.0]);
    let cut_drive = leg(20.0, first_drive.end(), 8.0, &[32.0]);
    let last_drive = leg(82.0, cut_drive.end(), 8.0, &[8.0]);
    let by_lattice = Fact::Agent(
        TRUCK,
        AgentFact::Planned {
            goal: C,
            trajectory: last_drive,
            effort: effort(0, 900),
            found_by: Some(FoundBy::Reachability),
        },
    );
    let failed = |agent, goal, reason, effort, until_s| {
        let until = seconds(until_s);
        Fact::Agent(agent, AgentFact::PlanFailed { goal, reason, effort, until })
    };
    let events = vec![
        at(0.0, Fact::Agent(TRUCK, AgentFact::StartMoved { from: Pose::new(9.0, 30.0, 0.0) })),
        at(0.0, Fact::Agent(TRUCK, AgentFact::RoadmapBuilt { samples: 500, edges: 2100, components: 2 })),
        at(0.0, Fact::Agent(WUMPUS, AgentFact::OutOfReach { cells: vec![C] })),
        at(0.0, planned(WUMPUS, A, first_walk.clone())),
        at(0.0, Fact::Agent(TRUCK, AgentFact::Rested { reason: RestReason::NothingBurns })),
        at(10.0, Fact::Fire(FireFact::Ignited { cell: A, cause: Cause::Agent(WUMPUS) })),
        at(10.0, planned(WUMPUS, B, leg(10.0, first_walk.end(), 2.0, &[20.0]))),
        at(10.0, planned(TRUCK, A, first_drive.clone())),
        at(15.0, Fact::Agent(TRUCK, AgentFact::Suppressing { cell: A, water_units: 1 })),
        at(16.0, Fact::Fire(FireFact::Ignited { cell: B, cause: Cause::Spread(A) })),
        at(16.0, Fact::Agent(WUMPUS, AgentFact::Dropped { goal: B, trajectory: cut_walk })),
        at(17.0, Fact::Agent(WUMPUS, AgentFact::LocalMinimum { goal: D, x_m: 34.5, y_m: -0.0 })),
        at(17.0, failed(WUMPUS, D, PlanFailure::Disconnected, effort(0, 30), 19.0)),
        at(19.0, Fact::Agent(WUMPUS, AgentFact::Rested { reason: RestReason::NothingLeftToLight })),
        at(20.0, Fact::Fire(FireFact::Extinguished { cell: A, by: TRUCK })),
        at(20.0, planned(TRUCK, B, leg(20.0, first_drive.end(), 8.0, &[40.0]))),
        at(23.0, Fact::Agent(TRUCK, AgentFact::Dropped { goal: B, trajectory: cut_drive })),
        at(26.0, failed(TRUCK, B, PlanFailure::BudgetSpent, effort(3, 20), 27.0)),
        at(27.0, Fact::Agent(TRUCK, AgentFact::OutOfReach { cells: vec![B] })),
        at(27.0, Fact::Agent(TRUCK, AgentFact::Rested { reason: RestReason::NothingReachable })),
        at(29.0, Fact::Agent(WUMPUS, AgentFact::OutOfReach { cells: vec![D] })),
        at(76.0, Fact::Fire(FireFact::BurnedOut { cell: B })),
        at(80.0, ignited(C)),
        at(82.0, by_lattice),
        at(83.0, Fact::Agent(TRUCK, AgentFact::Suppressing { cell: C, water_units: 1 })),
        at(85.0, Fact::Fire(FireFact::BurnedOut { cell: C })),
        at(85.0, Fact::Agent(TRUCK, AgentFact::SuppressionEnded { cell: C })),
        at(90.0, Fact::Ended { reason: EndReason::NothingLeft }),
    ];
    Timeline { setting, events, ground: Vec::new() }
}

/// A run of 30 s in which one truck waits for another, which gives way; `outcome` tests tell it in numbers.
pub fn meeting() -> Timeline {
    let setting = small_setting(&[TRUCK, SECOND_TRUCK]);
    let start = setting.agents[0].pose;
    let drive = leg(14.0, start, 8.0, &[8.0]).after_waiting(3.0);
    let aside = leg(14.0, start, 8.0, &[-16.0]);
    let events = vec![
        at(0.0, Fact::Agent(SECOND_TRUCK, AgentFact::OutOfReach { cells: vec![A] })),
        at(10.0, ignited(A)),
        at(10.0, Fact::Agent(TRUCK, AgentFact::Blocked { goal: A, by: SECOND_TRUCK })),
        at(14.0, Fact::Agent(SECOND_TRUCK, AgentFact::GaveWay { to: TRUCK, trajectory: aside })),
        at(14.0, planned(TRUCK, A, drive)),
        at(18.0, Fact::Agent(TRUCK, AgentFact::Suppressing { cell: A, water_units: 1 })),
        at(23.0, Fact::Fire(FireFact::Extinguished { cell: A, by: TRUCK })),
        at(30.0, Fact::Ended { reason: EndReason::Duration }),
    ];
    Timeline { setting, events, ground: Vec::new() }
}

/// A fire that spreads to two cells at one instant, and to a third one from another fire.
pub fn spreading() -> Timeline {
    let spread = |cell, from| Fact::Fire(FireFact::Ignited { cell, cause: Cause::Spread(from) });
    let events = vec![
        at(1.0, ignited(A)),
        at(1.0, ignited(B)),
        at(11.0, spread(D, A)),
        at(11.0, spread(C, A)),
        at(11.0, Fact::Fire(FireFact::BurnedOut { cell: A })),
        at(21.0, spread(A, D)),
    ];
    Timeline { setting: small_setting(&[WUMPUS, TRUCK]), events, ground: Vec::new() }
}

/// Grass on all cells of a field but those in its last column, on a slope; what burns does so for 20 s.
pub fn grass(frame: FieldFrame) -> SpreadSetting {
    let fuel = (0..frame.cell_count()).map(|index| if frame.cell(index).col + 1 == frame.cols { 0 } else { 102 });
    let heights = (0..frame.cell_count()).map(|index| 300.0 + 0.25 * f32::from(frame.cell(index).row));
    let landscape = Landscape {
        fuel: fuel.collect(),
        relief: Relief::Elevation(heights.collect()),
        ..Landscape::uniform(frame, 0)
    };
    let interval =
        |from_s, wind_mps| WeatherInterval { from: seconds(from_s), wind_mps, moisture: FuelMoisture::default() };
    let weather = vec![interval(0.0, DVec2::new(3.0, 0.0)), interval(50.0, DVec2::new(0.0, -2.5))];
    SpreadSetting::Rothermel {
        landscape: Arc::new(landscape),
        weather: Arc::new(Weather::new(weather).expect("it is in order")),
        rules: RothermelRules { burn_out: Some(seconds(20.0)), ..RothermelRules::default() },
    }
}

/// A run of 100 s on grass in which everything happens once that can happen to ground.
pub fn on_ground() -> Timeline {
    let mut setting = small_setting(&[WUMPUS, TRUCK]);
    setting.spread = Some(grass(setting.frame));
    setting.blocked = vec![Cell { col: 9, row: 3 }, Cell { col: 9, row: 4 }];
    let pose = setting.agents[1].pose;
    let cell = |col, row| Cell { col, row };
    let fact = |time_s, cell, fact| GroundEvent { time: seconds(time_s), cell, fact };
    let spread = |time_s, cell, from| fact(time_s, cell, GroundFact::Ignited(Cause::Spread(from)));
    let (first, goal) = (cell(4, 4), cell(6, 4));
    let ground = vec![
        fact(1.0, first, GroundFact::Ignited(Cause::Scheduled)),
        spread(11.25, cell(5, 4), first),
        spread(12.5, goal, first),
        spread(12.5, cell(7, 5), first),
        spread(18.0, cell(4, 3), first),
        spread(20.0, cell(4, 2), first),
        fact(30.0, goal, GroundFact::Extinguished { by: TRUCK }),
        fact(30.0, cell(6, 3), GroundFact::Wetted { until: seconds(60.0), by: TRUCK }),
        fact(30.0, B, GroundFact::Wetted { until: seconds(60.0), by: TRUCK }),
        fact(40.0, cell(0, 9), GroundFact::Ignited(Cause::Agent(WUMPUS))),
        fact(44.0, cell(5, 9), GroundFact::Ignited(Cause::Spotted(cell(0, 9)))),
        spread(50.0, goal, cell(7, 5)),
        // Farther than directions reach, and out of the order of cell indices.
        spread(60.0, cell(8, 9), cell(0, 9)),
        spread(60.0, cell(1, 8), cell(0, 9)),
    ];
    let events = vec![
        at(2.0, Fact::Agent(TRUCK, AgentFact::OutOfReach { cells: vec![A, cell(0, 9), first] })),
        at(13.0, Fact::Fire(FireFact::Ignited { cell: B, cause: Cause::Spread(first) })),
        at(13.0, planned(TRUCK, goal, leg(13.0, pose, 8.0, &[80.0]))),
        at(25.0, Fact::Agent(TRUCK, AgentFact::Suppressing { cell: goal, water_units: 1 })),
        at(30.0, Fact::Agent(TRUCK, AgentFact::Rested { reason: RestReason::NothingReachable })),
        at(33.0, Fact::Fire(FireFact::BurnedOut { cell: B })),
        at(45.0, Fact::Fire(FireFact::Ignited { cell: D, cause: Cause::Spotted(cell(0, 9)) })),
    ];
    Timeline { setting, events, ground }
}

/// The same ground without bushes and with other agents, who do nothing.
pub fn ground_alone(agents: &[AgentId]) -> Timeline {
    let Timeline { setting, ground, .. } = on_ground();
    let mut alone = small_setting(agents);
    alone.spread = setting.spread;
    alone.bushes.clear();
    Timeline { setting: alone, events: Vec::new(), ground }
}

/// The same contest as [`random`], with ground that catches fire here and there, goes out and burns again, and of which
/// some cannot be reached.
pub fn random_on_ground(seed: u64, duration: SimTime) -> Timeline {
    let mut timeline = random(seed, duration);
    let mut rng = rng::stream(seed, "timeline/sample/ground");
    let frame = timeline.setting.frame;
    timeline.setting.spread = Some(grass(frame));
    let spread = timeline.setting.spread.clone().expect("it was just set").flaming_times();
    let mut out: Vec<Option<SimTime>> = vec![Some(SimTime::ZERO); frame.cell_count()];
    for _ in 0..duration.as_nanos() / 8_000_000_000 {
        let cell = frame.cell(rng.random_range(0..frame.cell_count()));
        let time = rng.random_range(0..duration.as_nanos());
        let time = SimTime::from_nanos(time);
        if !timeline.setting.is_ground(cell) || out[frame.index(cell)].is_none_or(|out| time <= out) {
            continue;
        }
        let from = frame.offset(cell, rng.random_range(-3..=3), rng.random_range(-3..=3)).unwrap_or(cell);
        timeline.ground.push(GroundEvent { time, cell, fact: GroundFact::Ignited(Cause::Spread(from)) });
        let burned_out = spread.burns_out_at(cell, time).expect("it burns for 20 s");
        let extinguished = time + seconds(rng.random_range(0.0..40.0));
        // Ground that was put out may burn again later; what burned out never does.
        out[frame.index(cell)] = (extinguished < burned_out).then_some(extinguished);
        if extinguished < burned_out {
            timeline.ground.push(GroundEvent {
                time: extinguished,
                cell,
                fact: GroundFact::Extinguished { by: TRUCK },
            });
        }
        if rng.random_bool(0.3) {
            let fact = Fact::Agent(TRUCK, AgentFact::OutOfReach { cells: vec![cell] });
            timeline.events.push(Event { time: SimTime::from_nanos(rng.random_range(0..=time.as_nanos())), fact });
        }
    }
    timeline.ground.sort_by_key(|event| event.time);
    let end = timeline.end_time();
    timeline.events.retain(|event| event.time <= end);
    timeline.events.sort_by_key(|event| event.time);
    timeline
}

/// A truck that builds a roadmap and plans once, and tells what it looked at.
pub fn searched() -> Timeline {
    let setting = small_setting(&[TRUCK]);
    let start = setting.agents[0].pose;
    let searched = |phase, places: &[(i32, i32)], edges: &[(u32, u32)]| {
        let graph = SearchGraph { places: places.to_vec(), edges: edges.to_vec() };
        at(10.0, Fact::Agent(TRUCK, AgentFact::Searched { phase, graph }))
    };
    let milestones = [(1200, 3000), (2400, 3100), (1250, 700), (2600, 900)];
    let events = vec![
        at(10.0, Fact::Agent(TRUCK, AgentFact::RoadmapBuilt { samples: 4, edges: 3, components: 1 })),
        searched(SearchPhase::Roadmap, &milestones, &[(0, 1), (1, 3), (0, 2)]),
        at(10.0, ignited(A)),
        searched(SearchPhase::Query, &[(1000, 3000), (1200, 3000), (1250, 700)], &[(0, 1), (1, 2)]),
        searched(SearchPhase::Local, &[(1000, 3000), (600, 3000), (1391, 2938)], &[(0, 2), (0, 1)]),
        searched(SearchPhase::Local, &[(-1, i32::MAX)], &[]),
        at(10.0, planned(TRUCK, A, leg(10.0, start, 8.0, &[16.0]))),
        at(30.0, Fact::Ended { reason: EndReason::Duration }),
    ];
    Timeline { setting, events, ground: Vec::new() }
}

/// A contest of this length on a field of 50 x 50 cells between one Wumpus and one truck that drive at random and
/// through everything; its facts are consistent, its legs as long as real ones. With an odd seed, the truck's
/// acceleration is limited.
pub fn random(seed: u64, duration: SimTime) -> Timeline {
    let mut world = World::new(seed, duration);
    world.run();
    world.timeline
}

#[derive(Clone, Copy, Debug)]
enum SampleEvent {
    BurnOut(Cell),
    Spread(Cell),
    WumpusArrives,
    TruckArrives,
    TruckDone,
    TruckDecides,
}

struct World {
    timeline: Timeline,
    vegetation: Vec<BushState>,
    queue: EventQueue<u8, (u32, SampleEvent)>,
    rng: Xoshiro256PlusPlus,
    limits: SpeedLimits,
    now: SimTime,
    /// Goal and last leg of the Wumpus, then of the truck.
    goals: [Option<Cell>; 2],
    legs: [Option<Trajectory>; 2],
    /// Events of the truck that carry an older revision are void.
    revision: u32,
}

impl World {
    fn new(seed: u64, duration: SimTime) -> Self {
        let mut rng = rng::stream(seed, "timeline/sample");
        let frame = FieldFrame { cols: 50, rows: 50, cell_m: 5.0 };
        let mut setting = small_setting(&[WUMPUS, TRUCK]);
        setting.bushes =
            (0..frame.cell_count()).filter(|_| rng.random_bool(0.2)).map(|index| frame.cell(index)).collect();
        setting.frame = frame;
        setting.rules.duration = duration;
        let vegetation = vec![BushState::Intact; setting.bushes.len()];
        let timeline = Timeline { setting, events: Vec::new(), ground: Vec::new() };
        let queue = EventQueue::default();
        let now = SimTime::ZERO;
        let mut limits = SpeedLimits::new(8.0, 8.0);
        if seed % 2 == 1 {
            limits.acceleration_mps2 = Some(2.0);
            limits.braking_mps2 = Some(4.0);
        }
        Self { timeline, vegetation, queue, rng, limits, now, goals: [None; 2], legs: [None, None], revision: 0 }
    }

    fn run(&mut self) {
        self.timeline
            .events
            .push(at(0.0, Fact::Agent(WUMPUS, AgentFact::OutOfReach { cells: vec![self.timeline.setting.bushes[0]] })));
        self.wumpus_decides();
        self.truck_decides();
        while let Some((time, rank)) =
            self.queue.peek().filter(|&(time, _)| time <= self.timeline.setting.rules.duration)
        {
            self.now = time;
            let (revision, due) = self.queue.pop_due(time, rank).expect("it was just seen");
            self.handle(revision, due);
        }
        self.now = self.timeline.setting.rules.duration;
        self.tell(Fact::Ended { reason: EndReason::Duration });
    }

    fn handle(&mut self, revision: u32, due: SampleEvent) {
        let outdated = revision != self.revision;
        match due {
            SampleEvent::BurnOut(cell) if self.bush(cell).burns() => self.burn_out(cell),
            SampleEvent::Spread(cell) if self.bush(cell).burns() => {
                for _ in 0..self.rng.random_range(0..12) {
                    if let Some(other) = self.pick(|bush| bush == BushState::Intact) {
                        self.ignite(other, Cause::Spread(cell));
                    }
                }
            }
            SampleEvent::WumpusArrives => {
                let goal = self.goals[0].take().expect("it walked to a goal");
                if self.bush(goal) == BushState::Intact {
                    self.ignite(goal, Cause::Agent(WUMPUS));
                    self.queue.push(self.now + seconds(10.0), 2, (0, SampleEvent::Spread(goal)));
                }
                self.wumpus_decides();
            }
            SampleEvent::TruckArrives if !outdated => {
                let cell = self.goals[1].expect("it drove to a goal");
                self.tell(Fact::Agent(TRUCK, AgentFact::Suppressing { cell, water_units: 1 }));
                self.queue.push(self.now + seconds(5.0), 0, (revision, SampleEvent::TruckDone));
            }
            SampleEvent::TruckDone if !outdated => {
                let cell = self.goals[1].take().expect("it suppressed a goal");
                self.change(cell, BushState::Extinguished);
                self.tell(Fact::Fire(FireFact::Extinguished { cell, by: TRUCK }));
                self.truck_decides();
            }
            SampleEvent::TruckDecides => self.truck_decides(),
            _ => {}
        }
    }

    fn burn_out(&mut self, cell: Cell) {
        self.change(cell, BushState::BurnedOut);
        self.tell(Fact::Fire(FireFact::BurnedOut { cell }));
        if self.goals[1] != Some(cell) {
            return;
        }
        self.goals[1] = None;
        self.revision += 1;
        let leg = self.legs[1].clone().expect("it has a goal, so it has a leg");
        if leg.end_time() <= self.now {
            self.tell(Fact::Agent(TRUCK, AgentFact::SuppressionEnded { cell }));
            self.queue.push(self.now, 6, (0, SampleEvent::TruckDecides));
        } else {
            let trajectory = leg.stopping(self.now, &self.limits);
            self.queue.push(trajectory.end_time(), 6, (0, SampleEvent::TruckDecides));
            self.legs[1] = Some(trajectory.clone());
            self.tell(Fact::Agent(TRUCK, AgentFact::Dropped { goal: cell, trajectory }));
        }
    }

    fn truck_decides(&mut self) {
        let Some(goal) = self.pick(BushState::burns) else {
            self.tell(Fact::Agent(TRUCK, AgentFact::Rested { reason: RestReason::NothingBurns }));
            self.queue.push(self.now + seconds(7.0), 6, (0, SampleEvent::TruckDecides));
            return;
        };
        let effort = effort(self.rng.random_range(3..60), self.rng.random_range(5..400));
        if self.rng.random_bool(0.05) {
            let reason = PlanFailure::Disconnected;
            let until = self.now + seconds(0.3);
            self.tell(Fact::Agent(TRUCK, AgentFact::PlanFailed { goal, reason, effort, until }));
            self.queue.push(until, 6, (0, SampleEvent::TruckDecides));
            return;
        }
        let segments = (0..self.rng.random_range(3..=12)).map(|_| self.segment()).collect();
        let path = Path { start: self.stands(1), segments };
        let trajectory = self.set_out(1, goal, Trajectory::from_path(&path, self.now, self.limits));
        self.queue.push(trajectory.end_time(), 4, (self.revision, SampleEvent::TruckArrives));
        self.tell(Fact::Agent(TRUCK, AgentFact::Planned { goal, trajectory, effort, found_by: Some(FoundBy::Search) }));
    }

    fn wumpus_decides(&mut self) {
        let Some(goal) = self.pick(|bush| bush == BushState::Intact) else {
            return self.tell(Fact::Agent(WUMPUS, AgentFact::Rested { reason: RestReason::NothingLeftToLight }));
        };
        let mut pieces = Vec::new();
        let mut eighth = 9;
        for _ in 0..self.rng.random_range(30..=60) {
            if eighth == 9 || self.rng.random_bool(0.3) {
                eighth = self.rng.random_range(-3..=4);
                pieces.push(Piece::Turn { heading: f64::from(eighth) * std::f64::consts::FRAC_PI_4 });
            }
            let length_m = if eighth % 2 == 0 { 5.0 } else { 50.0_f64.sqrt() };
            let segment = Segment { curvature: 0.0, length_m };
            pieces.push(Piece::Drive { segment, speed_mps: 5.0, acceleration_mps2: 0.0 });
        }
        let trajectory = self.set_out(0, goal, Trajectory::new(self.now, self.stands(0), pieces));
        self.queue.push(trajectory.end_time(), 4, (0, SampleEvent::WumpusArrives));
        self.tell(Fact::Agent(WUMPUS, AgentFact::Planned { goal, trajectory, effort: effort(0, 300), found_by: None }));
    }

    fn stands(&self, agent: usize) -> Pose {
        self.legs[agent].as_ref().map_or(self.timeline.setting.agents[agent].pose, Trajectory::end)
    }

    fn set_out(&mut self, agent: usize, goal: Cell, trajectory: Trajectory) -> Trajectory {
        self.goals[agent] = Some(goal);
        self.legs[agent] = Some(trajectory.clone());
        trajectory
    }

    fn segment(&mut self) -> Segment {
        let curvature = f64::from(self.rng.random_range(-1..=1)) / 13.0;
        let length = if self.rng.random_bool(0.3) { 4.0 } else { self.rng.random_range(0.5..12.0) };
        Segment { curvature, length_m: if self.rng.random_bool(0.2) { -length } else { length } }
    }

    fn ignite(&mut self, cell: Cell, cause: Cause) {
        self.change(cell, BushState::Burning { since: self.now });
        self.tell(Fact::Fire(FireFact::Ignited { cell, cause }));
        self.queue.push(self.now + seconds(60.0), 1, (0, SampleEvent::BurnOut(cell)));
    }

    fn bush(&self, cell: Cell) -> BushState {
        self.vegetation[self.timeline.setting.bush_index(cell).expect("fires burn bushes")]
    }

    fn change(&mut self, cell: Cell, to: BushState) {
        let index = self.timeline.setting.bush_index(cell).expect("fires burn bushes");
        self.vegetation[index] = to;
    }

    fn pick(&mut self, is: impl Fn(BushState) -> bool) -> Option<Cell> {
        let fit: Vec<_> = (0..self.vegetation.len()).filter(|&index| is(self.vegetation[index])).collect();
        (!fit.is_empty()).then(|| self.timeline.setting.bushes[fit[self.rng.random_range(0..fit.len())]])
    }

    fn tell(&mut self, fact: Fact) {
        self.timeline.events.push(Event { time: self.now, fact });
    }
}
