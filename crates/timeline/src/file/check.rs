//! The guarantees of every recording: finite values, ordered times, cells of the field, bounded counts.
//!
//! Whether the facts make sense together is not asked here: an audit must be able to read a run that went wrong.

use super::FileError;
use crate::{
    AgentFact, AgentId, AgentStart, Body, Event, Fact, FireFact, GroundEvent, GroundFact, Rules, Setting,
    SpreadSetting, Timeline, WaterEnergy, WaterRules,
};
use wildfire_base::geometry::{Cell, FieldFrame, Pose};
use wildfire_base::ranges::{OutOfRange, SettingsTable};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, SpeedLimits, Trajectory};
use wildfire_fire::surface::FuelMoisture;
use wildfire_fire::{Landscape, MoistureZones, RATE_FACTORS, Relief, WeatherInterval, WindField};

/// The maximum number of cells along a side of the field.
pub const MAX_SIDE: usize = 4096;
/// The maximum number of cells of a field whose ground burns.
pub const MAX_GROUND_CELLS: usize = 1000 * 1000;
pub const MAX_AGENTS: usize = 2000;
/// The longest time in seconds in which a pump empties a tank.
const LONGEST_SPRAYING_S: f64 = 2e9;
pub const MAX_FACTS: usize = 2_000_000;
/// The maximum number of pieces of all legs together.
pub const MAX_PIECES: usize = 2_000_000;
/// The maximum number of cells of all `OutOfReach` facts together.
pub const MAX_CELLS_OUT_OF_REACH: usize = 8_000_000;
/// The maximum number of places of all `Searched` facts together, twice of what a run records.
pub const MAX_SEARCH_PLACES: usize = 8_000_000;
/// The maximum number of edges of all `Searched` facts together.
pub const MAX_SEARCH_EDGES: usize = 8_000_000;
/// The maximum number of facts about the ground: one for every cell of the largest such field, and as many again for
/// cells that burn twice or get wet.
pub const MAX_GROUND_FACTS: usize = 2 * MAX_GROUND_CELLS;
/// The maximum number of weather intervals: a year by the hour.
pub const MAX_WEATHER: usize = 10_000;
pub const MAX_NAME_BYTES: usize = 4096;

pub fn check(timeline: &Timeline) -> Result<(), FileError> {
    // The facts are looked up in the setting, so it is checked before them.
    check_setting(&timeline.setting)?;
    limit("facts", timeline.events.len(), MAX_FACTS)?;
    require(timeline.events.is_sorted_by_key(|event| event.time), || "its facts are not in order of time".into())?;
    check_ground(timeline)?;
    let (mut pieces, mut cells_out_of_reach) = (0, 0);
    let (mut search_places, mut search_edges) = (0, 0);
    for event in &timeline.events {
        check_event(event, &timeline.setting).map_err(|error| at_fact(error, event))?;
        match &event.fact {
            Fact::Agent(_, AgentFact::OutOfReach { cells, .. }) => cells_out_of_reach += cells.len(),
            Fact::Agent(_, AgentFact::Searched { graph, .. }) => {
                search_places += graph.places.len();
                search_edges += graph.edges.len();
            }
            fact => pieces += fact.trajectory().map_or(0, |leg| leg.pieces().len()),
        }
    }
    limit("pieces of legs", pieces, MAX_PIECES)?;
    limit("cells out of reach", cells_out_of_reach, MAX_CELLS_OUT_OF_REACH)?;
    limit("places of searches", search_places, MAX_SEARCH_PLACES)?;
    limit("edges of searches", search_edges, MAX_SEARCH_EDGES)
}

/// Refuses counts beyond a limit.
pub fn limit(what: &'static str, found: usize, limit: usize) -> Result<(), FileError> {
    if found <= limit { Ok(()) } else { Err(FileError::TooLarge { what, limit }) }
}

fn require(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), FileError> {
    if holds { Ok(()) } else { Err(FileError::Impossible(otherwise())) }
}

fn at_fact(error: FileError, event: &Event) -> FileError {
    match error {
        FileError::Impossible(what) => FileError::Impossible(format!("{what} in a fact at {}", event.time)),
        other => other,
    }
}

fn check_setting(setting: &Setting) -> Result<(), FileError> {
    let frame = setting.frame;
    limit("bytes of a name", setting.scenario.len().max(setting.program_version.len()), MAX_NAME_BYTES)?;
    limit("cells along a side", frame.cols.max(frame.rows).into(), MAX_SIDE)?;
    limit("agents", setting.agents.len(), MAX_AGENTS)?;
    // The way from an index to its cell divides by the number of columns.
    require(frame.cols > 0 && frame.rows > 0, || "its field has no cells".into())?;
    require(is_size(frame.cell_m), || format!("its cells measure {} m", frame.cell_m))?;
    // A cell beyond the last column would have the index of another.
    require(setting.bushes.iter().all(|&bush| contains(&frame, bush)), || "a bush stands outside the field".into())?;
    // Recordings keep steps between indices, and [`Setting::bush_index`] halves the list.
    let ascend = setting.bushes.is_sorted_by(|a, b| frame.index(*a) < frame.index(*b));
    require(ascend, || "its bushes are not in the order of their indices".into())?;
    // Strictly, so that no name is there twice and [`Setting::agent_index`] can halve the list.
    require(setting.agents.is_sorted_by(|a, b| a.id < b.id), || "its agents are not in order".into())?;
    setting.agents.iter().try_for_each(check_agent)?;
    require(setting.blocked.iter().all(|&cell| contains(&frame, cell)), || {
        "a cell is blocked outside the field".into()
    })?;
    let ascend = setting.blocked.is_sorted_by(|a, b| frame.index(*a) < frame.index(*b));
    require(ascend, || "its blocked cells are not in the order of their indices".into())?;
    let has_all = setting.pieces.is_empty() || setting.pieces.len() == setting.bushes.len();
    require(has_all, || "its pieces are not as many as its bushes".into())?;
    setting.spread.as_ref().map_or(Ok(()), |spread| check_spread(spread, frame))?;
    setting.water.as_ref().map_or(Ok(()), check_water)?;
    limit("trucks that ground slows", setting.ground_shares.len(), MAX_AGENTS)?;
    require(setting.ground_shares.iter().all(are_shares), || "a truck's speeds by ground are not 256 shares".into())?;
    limit("crews", setting.line.as_ref().map_or(0, |line| line.crews.len()), MAX_AGENTS)?;
    check_rules(&setting.rules)
}

// One for each number that a byte has, and fuel models are numbered by a byte.
fn are_shares((_, shares): &(AgentId, Vec<f64>)) -> bool {
    shares.len() == 256 && shares.iter().all(|share| *share > 0.0 && *share <= 1.0)
}

fn check_water(water: &WaterRules) -> Result<(), FileError> {
    limit("places with water", water.places.len(), MAX_AGENTS)?;
    // [`WaterRules::nearest`] relies on one.
    let are_somewhere = !water.places.is_empty() && water.places.iter().all(|place| place.is_finite());
    require(are_somewhere, || "it has no place with water".into())?;
    let is_tank = water.full_tank > 0 && is_size(water.reach_m);
    require(is_tank, || "its tanks hold nothing, or cannot be filled".into())?;
    let is_pump = |WaterEnergy { portion_l, pump_lps, jet_m, applied }: WaterEnergy| {
        // How long a stop lasts is computed from these and has to fit the clock.
        let spraying_s = f64::from(water.full_tank) * portion_l / pump_lps;
        [portion_l, pump_lps, jet_m, applied].into_iter().all(is_size) && spraying_s <= LONGEST_SPRAYING_S
    };
    require(water.energy.is_none_or(is_pump), || "its pumps are impossible".into())
}

fn check_spread(spread: &SpreadSetting, frame: FieldFrame) -> Result<(), FileError> {
    let landscape = spread.landscape();
    let weather = spread.weather();
    check_landscape(landscape, frame)?;
    limit("intervals of weather", weather.intervals().len(), MAX_WEATHER)?;
    let is_weather =
        |WeatherInterval { wind_mps, moisture, .. }: &WeatherInterval| wind_mps.is_finite() && is_moisture(moisture);
    require(weather.intervals().iter().all(is_weather), || "its weather is not finite".into())?;
    if let Some(zones) = weather.moisture_zones() {
        let count = zones.moistures.len();
        limit("zones of moisture", count, MoistureZones::MAX)?;
        require(zones.moistures.iter().all(is_moisture), || "its moisture by place is not finite".into())?;
        let are_zones = zones.of_cell.iter().all(|&zone| usize::from(zone) < count);
        let fits = are_zones && zones.of_cell.len() == frame.cell_count();
        require(fits, || "its moisture by place does not fit its field".into())?;
    }
    // Winds are looked up by the index of a cell, without another test.
    let is_of_field =
        |field: &WindField| field.east.len() == frame.cell_count() && field.north.len() == field.east.len();
    let fits = weather.wind_fields().iter().flatten().all(|field| is_of_field(field));
    require(fits, || "its winds do not fit its field".into())?;
    match spread {
        SpreadSetting::Rothermel { rules, .. } => {
            // A share of the dry weight. NaN lies in no range, and is refused as well.
            if rules.crowns.is_some_and(|crowns| !(0.0..=5.0).contains(&crowns.foliar_moisture)) {
                return Err(FileError::Impossible("its trees have an impossible foliar moisture".into()));
            }
            let embers = rules.embers.map_or(Ok(()), |embers| embers.settings.check(&frame));
            embers.map_err(|OutOfRange { name, found, expected }| {
                FileError::Impossible(format!("its embers have {name} {found}, expected {expected}"))
            })
        }
        SpreadSetting::Alexandridis { rules, .. } => {
            let numbers = [rules.p0, rules.wind_c1, rules.wind_c2, rules.slope_a];
            // A step of no time would keep the automaton at one instant.
            let is_possible = numbers.iter().all(|number| number.abs() <= 1.0) && rules.step > SimTime::ZERO;
            require(is_possible, || "its automaton has an impossible probability, coefficient or step".into())
        }
    }
}

fn is_moisture(&FuelMoisture { d1, d10, d100, herb, woody }: &FuelMoisture) -> bool {
    [d1, d10, d100, herb, woody].into_iter().all(|part| part.is_finite() && part >= 0.0)
}

fn check_landscape(landscape: &Landscape, frame: FieldFrame) -> Result<(), FileError> {
    let cells = frame.cell_count();
    let (reliefs, is_finite) = match &landscape.relief {
        Relief::Plane(gradient) => (cells, gradient.is_finite()),
        Relief::Elevation(heights) => (heights.len(), heights.iter().all(|height| height.is_finite())),
        Relief::Gradient(gradients) => (gradients.len(), gradients.iter().flatten().all(|part| part.is_finite())),
    };
    let is_of_field = landscape.frame == frame && landscape.fuel.len() == cells && reliefs == cells;
    require(is_of_field, || "its landscape does not fit its field".into())?;
    require(is_finite, || "its landscape is not finite".into())?;
    let factors = &landscape.rate_factors;
    let are_factors = factors.iter().all(|parts| RATE_FACTORS.contains(parts));
    let are_possible = are_factors && (factors.is_empty() || factors.len() == cells);
    require(are_possible, || "its factors on the rate of spread are impossible".into())?;
    // Looked up once for each of 256 numbers, not for each of a million cells.
    let is_valid: Vec<bool> =
        (0..=u8::MAX).map(|number| number == 0 || landscape.fuel_model(number).is_some()).collect();
    let stranger = landscape.fuel.iter().find(|&&number| !is_valid[usize::from(number)]);
    stranger.map_or(Ok(()), |number| require(false, || format!("its landscape has the unknown fuel model {number}")))
}

fn check_ground(timeline: &Timeline) -> Result<(), FileError> {
    let Timeline { setting, ground, .. } = timeline;
    limit("facts about the ground", ground.len(), MAX_GROUND_FACTS)?;
    require(ground.is_empty() || setting.spread.is_some(), || "its ground burns, but it has no ground".into())?;
    let is_in_order = ground.is_sorted_by_key(|event| event.time);
    require(is_in_order, || "its facts about the ground are not in order of time".into())?;
    ground.iter().try_for_each(|event| check_ground_event(event, setting))
}

fn check_ground_event(event: &GroundEvent, setting: &Setting) -> Result<(), FileError> {
    if let Some(by) = event.agent() {
        require(setting.agent_index(by).is_some(), || format!("{by} is unknown in a fact at {}", event.time))?;
    }
    let is_inside = |cell: Cell| {
        require(contains(&setting.frame, cell), || format!("{cell} is outside the field in a fact at {}", event.time))
    };
    is_inside(event.cell)?;
    match event.fact {
        GroundFact::Ignited(cause) => cause.parent().map_or(Ok(()), is_inside),
        GroundFact::Wetted { until, .. } => {
            require(until >= event.time, || format!("{} is dry before it is wet at {}", event.cell, event.time))
        }
        GroundFact::Extinguished { .. } | GroundFact::Cleared { .. } => Ok(()),
    }
}

fn check_agent(agent: &AgentStart) -> Result<(), FileError> {
    let sizes_fit = match agent.body {
        Body::Square { size_m } => is_size(size_m),
        Body::Truck(body) => {
            [body.length_m, body.width_m, body.wheelbase_m, body.turning_radius_m].into_iter().all(is_size)
                && body.steering_rate_deg_s.is_none_or(is_size)
                && body.rear_overhang_m.is_finite()
        }
    };
    require(sizes_fit, || format!("the body of {} has no size", agent.id))?;
    require(agent.limits.is_none_or(are_limits), || format!("the limits of {} allow no motion", agent.id))?;
    require(is_finite(agent.pose), || format!("{} starts nowhere", agent.id))
}

fn are_limits(limits: SpeedLimits) -> bool {
    let speeds = [limits.forward_mps, limits.reverse_mps];
    let accelerations = [limits.acceleration_mps2, limits.braking_mps2, limits.lateral_mps2];
    // A Wumpus has no reverse, so its limit there is 0.
    speeds.into_iter().all(|speed| speed.is_finite() && speed >= 0.0)
        && accelerations.into_iter().flatten().all(is_size)
}

fn check_rules(rules: &Rules) -> Result<(), FileError> {
    let scores = [rules.score_wumpus_ignited, rules.score_wumpus_burned_out, rules.score_truck_extinguished];
    require(scores.into_iter().all(f64::is_finite), || "its scores are not finite".into())?;
    let reach = rules.suppression_reach_m.unwrap_or(0.0);
    require(reach.is_finite() && reach >= 0.0, || format!("suppression reaches {reach} m"))?;
    let spread = rules.fire.map_or(0.0, |fire| fire.spread_radius_m);
    require(spread.is_finite() && spread >= 0.0, || format!("fire spreads over {spread} m"))
}

fn check_event(event: &Event, setting: &Setting) -> Result<(), FileError> {
    let other = match event.fact {
        Fact::Agent(_, AgentFact::Blocked { by: other, .. }) | Fact::Agent(_, AgentFact::GaveWay { to: other, .. }) => {
            Some(other)
        }
        _ => None,
    };
    for agent in event.fact.agent().into_iter().chain(other) {
        require(setting.agent_index(agent).is_some(), || format!("{agent} is unknown"))?;
    }
    match event.fact {
        // These are about bushes alone: the ground has a log of its own.
        Fact::Fire(fact) => check_bush(fact.cell(), setting)?,
        _ => event.fact.cell().map_or(Ok(()), |goal| check_cell(goal, setting))?,
    }
    match &event.fact {
        Fact::Agent(_, AgentFact::Suppressing { water_units, .. }) => {
            // Without tanks a stop is one unit.
            let full_tank = setting.water.as_ref().map_or(1, |water| water.full_tank);
            require(*water_units <= full_tank, || "a stop takes more water than a tank holds".into())
        }
        Fact::Agent(_, AgentFact::OutOfReach { cells, .. }) => {
            cells.iter().try_for_each(|&cell| check_cell(cell, setting))
        }
        Fact::Agent(_, AgentFact::StartMoved { from, .. }) => {
            require(is_finite(*from), || "a start is not finite".into())
        }
        Fact::Fire(FireFact::Ignited { cause, .. }) => cause.parent().map_or(Ok(()), |from| check_cell(from, setting)),
        Fact::Agent(_, AgentFact::Relocated { x_m, y_m, .. } | AgentFact::RelocationFailed { x_m, y_m, .. })
            if !(x_m.is_finite() && y_m.is_finite()) =>
        {
            require(false, || "a truck is sent to an impossible place".into())
        }
        Fact::Agent(_, AgentFact::PlanFailed { until, .. } | AgentFact::RelocationFailed { until, .. }) => {
            require(*until >= event.time, || "planning time ends before it begins".into())
        }
        Fact::Agent(_, AgentFact::Refilling { until }) => {
            require(*until >= event.time, || "a tank is full before it is filled".into())
        }
        Fact::Agent(
            _,
            AgentFact::Planned { trajectory, .. }
            | AgentFact::GaveWay { trajectory, .. }
            | AgentFact::Relocated { trajectory, .. },
        ) => {
            let sets_out_later = trajectory.start_time() >= event.time;
            require(sets_out_later, || "a leg starts before it is planned".into())?;
            check_leg(trajectory)
        }
        // A leg that is cut short began before this fact, so its start is not compared.
        Fact::Agent(_, AgentFact::Dropped { trajectory, .. } | AgentFact::Halted { trajectory }) => {
            check_leg(trajectory)
        }
        Fact::Agent(_, AgentFact::Searched { graph, .. }) => {
            let holds = |place: u32| (place as usize) < graph.places.len();
            let leads_somewhere = graph.edges.iter().all(|&(from, to)| holds(from) && holds(to));
            require(leads_somewhere, || "a search leads to a place that it does not contain".into())
        }
        Fact::Agent(_, AgentFact::LocalMinimum { x_m, y_m, .. }) => {
            require(x_m.is_finite() && y_m.is_finite(), || "a local minimum has no position".into())
        }
        _ => Ok(()),
    }
}

fn check_bush(cell: Cell, setting: &Setting) -> Result<(), FileError> {
    require(setting.bush_index(cell).is_some(), || format!("no bush stands at {cell}"))
}

/// A bush, or a cell of ground.
fn check_cell(cell: Cell, setting: &Setting) -> Result<(), FileError> {
    let is_ground = setting.spread.is_some() && contains(&setting.frame, cell);
    if is_ground { Ok(()) } else { check_bush(cell, setting) }
}

/// A leg's end is finite only if all of its way is.
fn check_leg(leg: &Trajectory) -> Result<(), FileError> {
    require(is_finite(leg.start()), || "a leg has no start".into())?;
    require(leg.pieces().iter().all(is_motion), || "a leg has a piece that is not a motion".into())?;
    require(leg.duration_s().is_finite() && is_finite(leg.end()), || "a leg has no end".into())
}

fn is_motion(piece: &Piece) -> bool {
    let numbers_fit = match *piece {
        Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
            let numbers = [segment.curvature, segment.length_m, speed_mps, acceleration_mps2];
            numbers.into_iter().all(f64::is_finite) && speed_mps >= 0.0
        }
        Piece::Turn { heading } => heading.is_finite(),
        Piece::Wait { seconds } => seconds >= 0.0,
    };
    numbers_fit && piece.duration_s().is_finite()
}

fn contains(frame: &FieldFrame, cell: Cell) -> bool {
    cell.col < frame.cols && cell.row < frame.rows
}

fn is_size(metres: f64) -> bool {
    metres.is_finite() && metres > 0.0
}

fn is_finite(pose: Pose) -> bool {
    [pose.x, pose.y, pose.heading].into_iter().all(f64::is_finite)
}
