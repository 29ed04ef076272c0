//! Fire trucks in a scenario: their settings, ranges, description, warnings and memory.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

use super::agents::{
    AgentList, AgentsMemory, BlockedStarts, FieldMeasures, SHOWN_ALIKE, SHOWN_SEED, ScenarioField, SketchedStart,
};
use super::goal::TruckGoal;
use super::ground_speed::{self, GroundKinds, SpeedByGround};
use super::program::{Program, Programs};
use crate::faults::check::{Check, TablePath};
use crate::site::truck_starts::first_without_place;
use crate::{MemoryPart, Scenario};
use wildfire_base::geometry::{DVec2, FieldFrame, Pose};
use wildfire_base::or_none;
use wildfire_base::ranges;
use wildfire_base::rng;
use wildfire_base::trajectory::{GroundSpeed, SpeedLimits};
use wildfire_base::vehicle::Dimensions;
use wildfire_planning::collision::CollisionChecker;
use wildfire_planning::kit::drive_cost::DriveCost;
use wildfire_planning::kit::local_search::PrimitiveSettings;
use wildfire_planning::kit::safety::SafetySettings;
use wildfire_planning::memory::MemoryMeter;
use wildfire_planning::planners::hybrid_astar::HybridSettings;
use wildfire_planning::planners::lattice::LatticeSettings;
use wildfire_planning::planners::prm_primitives::{PrmSettings, RoadmapGoal};
use wildfire_planning::planners::prm_rs::PrmRsSettings;
use wildfire_planning::registry::{BuiltInPlanner, Charge, RoadmapSize};
use wildfire_planning::{
    BuildReport, MakeError, PlannerContext, PlannerName, Planners, TruckPlanner, TruckPlannerKind,
    TruckPlannerSettings, is_hardly_connected,
};

/// Sideways acceleration that a laden truck can take on loose ground, m/s2; about 0.4 g.
const LATERAL_GRIP_MPS2: f64 = 4.0;

/// The number of neighbours that points of a plane have on average where the largest component of those that are joined
/// begins to span it (M. D. Penrose, "Random geometric graphs", 2003, section 10.6: 4.51). On a field bushes cut lines off
/// besides.
const PERCOLATION_DEGREE: f64 = 4.5;

/// The most milestones times neighbours, over all roadmaps, that [`warn_of_roadmaps`] builds: a tenth of a second.
const MAX_EDGES_TRIED: f64 = 2e5;

/// A fire truck.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Unimog {
    pub start: StartPose,
    pub vehicle: Dimensions,
    pub speed_mps: f64,
    pub reverse_speed_mps: f64,
    pub limits: Limits,
    /// The share of its speed that it keeps on the ground of a fuel, such as `NB9 = 1` for roads, and on all `other`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub speed_by_ground: SpeedByGround,
    /// Time at which it is ready to set out: the report of a fire takes some time, and so does manning it.
    #[serde(skip_serializing_if = "is_zero")]
    pub ready_s: f64,
    /// The cost by which drives are compared: length or time.
    pub cost: DriveCost,
    pub goal: TruckGoal,
    pub retarget: Retarget,
    #[schemars(schema_with = "planner_schema")]
    pub planner: PlannerName,
    pub rescue: FallbackMode,
    /// Least simulated planning time charged per expansion of its planner, whichever planner it is.
    pub seconds_per_expansion: f64,
    pub prm: PrmSettings,
    pub primitives: PrimitiveSettings,
    pub prm_rs: PrmRsSettings,
    pub hybrid: HybridSettings,
    pub lattice: LatticeSettings,
    pub safety: SafetySettings,
}

impl Default for Unimog {
    fn default() -> Self {
        Self {
            start: StartPose::default(),
            vehicle: Dimensions::default(),
            speed_mps: 8.0,
            reverse_speed_mps: 8.0,
            limits: Limits::default(),
            speed_by_ground: SpeedByGround::new(),
            ready_s: 0.0,
            cost: DriveCost::default(),
            goal: TruckGoal::NearestBurning,
            retarget: Retarget::Never,
            planner: TruckPlannerKind::PrmRs.into(),
            rescue: FallbackMode::Auto,
            seconds_per_expansion: 0.0,
            prm: PrmSettings::default(),
            primitives: PrimitiveSettings::default(),
            prm_rs: PrmRsSettings::default(),
            hybrid: HybridSettings::default(),
            lattice: LatticeSettings::default(),
            safety: SafetySettings::default(),
        }
    }
}

impl Unimog {
    /// Makes its planner for a field as the run of a seed does.
    ///
    /// # Errors
    /// If nobody of its name is among the planners of the context, or it cannot be built.
    pub fn make_planner(&self, context: &TruckPlannerContext<'_>) -> Result<Box<dyn TruckPlanner>, MakeError> {
        let &TruckPlannerContext { truck, seed, checker, ground, memory, planners, programs } = context;
        let custom = programs.get(&self.planner).map(|program| Value::Object(program.settings.clone()));
        planners.make(
            &self.planner,
            &PlannerContext {
                truck,
                body: &self.vehicle,
                limits: &self.speed_limits(),
                cost: self.cost,
                checker,
                ground,
                custom_settings: custom.as_ref().unwrap_or(&Value::Null),
                stream: &|name: &str| rng::stream(seed, &format!("truck/{truck}/{name}")),
                memory,
                settings: &self.planner_settings(),
            },
        )
    }

    /// Makes its planner alone, as that of a run's first truck: a built-in one, without a limit of memory.
    ///
    /// # Errors
    /// If it is not built in.
    pub fn build_planner(&self, checker: &CollisionChecker, seed: u64) -> Result<Box<dyn TruckPlanner>, MakeError> {
        self.make_planner(&TruckPlannerContext {
            truck: 0,
            seed,
            checker,
            ground: None,
            memory: &MemoryMeter::unlimited(),
            planners: &Planners::default(),
            programs: &Programs::new(),
        })
    }

    /// Returns the simulated time that its planner's expansions cost: what the planner's own tables ask for, and no less
    /// than the truck's [`Self::seconds_per_expansion`].
    pub fn planning_charge(&self, programs: &Programs) -> Charge {
        let charge = match self.planner.built_in() {
            Some(kind) => Some(kind.maker().charge(&self.planner_settings())),
            None => programs.get(&self.planner).map(Program::charge),
        };
        let min = self.seconds_per_expansion;
        charge.map_or(Charge { roadmap_s: min, local_s: min }, |Charge { roadmap_s, local_s }| Charge {
            roadmap_s: roadmap_s.max(min),
            local_s: local_s.max(min),
        })
    }

    /// Says whether goals that its planner fails on are driven by the reachability flood.
    pub fn is_rescued(&self) -> bool {
        match self.rescue {
            FallbackMode::Auto => self.planner.built_in().is_some(),
            FallbackMode::Always => true,
            FallbackMode::Never => false,
        }
    }

    /// Returns what makes its planner, if that is built in.
    fn built_in(&self) -> Option<&'static dyn BuiltInPlanner> {
        self.planner.built_in().map(TruckPlannerKind::maker)
    }

    /// Returns the tables of planners' settings.
    pub fn planner_settings(&self) -> TruckPlannerSettings<'_> {
        TruckPlannerSettings {
            prm: &self.prm,
            primitives: &self.primitives,
            prm_rs: &self.prm_rs,
            hybrid: &self.hybrid,
            lattice: &self.lattice,
            safety: &self.safety,
        }
    }

    /// Returns its limits of speed and of acceleration.
    pub fn speed_limits(&self) -> SpeedLimits {
        SpeedLimits {
            forward_mps: self.speed_mps,
            reverse_mps: self.reverse_speed_mps,
            acceleration_mps2: self.limits.acceleration_mps2,
            braking_mps2: self.limits.braking_mps2,
            lateral_mps2: self.limits.lateral_mps2,
            steering: self.vehicle.steering_limits(),
        }
    }

    /// Returns the centre of its body at the start.
    pub fn start_centre(&self) -> DVec2 {
        self.vehicle.body_centre(self.start.pose())
    }
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// Describes the names of planners: the built-in ones, or any other that is known.
fn planner_schema(generator: &mut SchemaGenerator) -> Schema {
    let built_in = TruckPlannerKind::json_schema(generator);
    json_schema!({ "anyOf": [built_in, generator.subschema_for::<PlannerName>()] })
}

/// What a truck's planner is made from, besides the truck itself.
#[derive(Clone, Copy)]
pub struct TruckPlannerContext<'a> {
    /// Its number among the trucks.
    pub truck: u16,
    pub seed: u64,
    pub checker: &'a CollisionChecker,
    /// Ground on which the truck is slow.
    pub ground: Option<&'a GroundSpeed>,
    /// Built-in planners report to it what they hold as they grow.
    pub memory: &'a MemoryMeter,
    pub planners: &'a Planners,
    /// The scenario's tables of planners.
    pub programs: &'a Programs,
}

/// Says whether a truck drives by the reachability flood to fires that its planner fails on: `"auto"`, true or false.
/// `"auto"` is true for built-in planners and false for others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FallbackMode {
    #[default]
    Auto,
    Always,
    Never,
}

impl Serialize for FallbackMode {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::Always => serializer.serialize_bool(true),
            Self::Never => serializer.serialize_bool(false),
        }
    }
}

impl<'de> Deserialize<'de> for FallbackMode {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AutoOrBool;

        impl Visitor<'_> for AutoOrBool {
            type Value = FallbackMode;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("\"auto\", true or false")
            }

            fn visit_bool<E: Error>(self, always: bool) -> Result<FallbackMode, E> {
                Ok(if always { FallbackMode::Always } else { FallbackMode::Never })
            }

            fn visit_str<E: Error>(self, word: &str) -> Result<FallbackMode, E> {
                if word == "auto" {
                    Ok(FallbackMode::Auto)
                } else {
                    Err(E::invalid_value(Unexpected::Str(word), &self))
                }
            }
        }
        deserializer.deserialize_any(AutoOrBool)
    }
}

impl JsonSchema for FallbackMode {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Rescue".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "const": "auto" }, { "type": "boolean" }] })
    }
}

/// Pose of the rear axle at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StartPose {
    pub x_m: f64,
    pub y_m: f64,
    pub heading_deg: f64,
}

impl Default for StartPose {
    fn default() -> Self {
        Self { x_m: 50.0, y_m: 50.0, heading_deg: 0.0 }
    }
}

impl StartPose {
    pub fn pose(&self) -> Pose {
        Pose::new(self.x_m, self.y_m, self.heading_deg.to_radians())
    }
}

/// Limits of acceleration in m/s2; `"none"`: speed changes at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub acceleration_mps2: Option<f64>,
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub braking_mps2: Option<f64>,
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub lateral_mps2: Option<f64>,
}

/// Selects when a driving truck reconsiders its goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Retarget {
    Never,
    /// Whenever a bush ignites.
    OnEvent,
}

impl AgentList for Vec<Unimog> {
    fn key(&self) -> &'static str {
        "unimog"
    }

    fn title(&self) -> &'static str {
        "Trucks"
    }

    fn len(&self) -> usize {
        self.len()
    }

    fn starts(&self) -> Vec<SketchedStart> {
        self.iter()
            .map(|truck| {
                let place = truck.start.pose().position();
                SketchedStart { centre: truck.start_centre(), place, letter: 'U' }
            })
            .collect()
    }

    fn check(&self, scenario: &Scenario) -> Check {
        let frame = scenario.field.frame();
        let mut numbered = self.iter().enumerate();
        numbered.try_for_each(|(number, truck)| {
            let table = TablePath::entry(self.key(), number);
            check_planner_name(&table, &truck.planner, &scenario.planner)?;
            truck.goal.check(&table, "goal", &scenario.policy)?;
            ground_speed::check(&table, &truck.speed_by_ground)?;
            // Each fire that begins would cost a plan, only to learn which fire is the nearest.
            if truck.goal == TruckGoal::NearestByDrive && truck.retarget == Retarget::OnEvent {
                return table.refuse("retarget", "on-event".into(), "`never` with the goal `nearest-by-drive`".into());
            }
            table.inside("start", &truck.vehicle.footprint(truck.start.pose()).corners(), &frame)
        })
    }

    fn unused(&self, scenario: &Scenario, number: usize) -> Vec<&'static str> {
        let used = self[number].built_in().map_or(&[][..], BuiltInPlanner::tables);
        let settings = self[number].planner_settings();
        let tables = settings.tables().map(|table| table.name);
        let goal = scenario.dispatch.as_ref().map(|_| "goal");
        tables.filter(|name| !used.contains(name)).chain(goal).collect()
    }

    fn facts(&self, number: usize) -> Vec<String> {
        let truck = &self[number];
        let body = &self[number].vehicle;
        let lock_deg = body.max_steering_rad().to_degrees();
        let turned_s = body.steering_rate_deg_s.map(|rate| format!(", in {:.1} s", lock_deg / rate));
        let wheels = format!("Its front wheels turn to {lock_deg:.1} degrees{}.", turned_s.unwrap_or_default());
        vec![format!("{wheels} {}", describe_turning(truck))]
    }

    fn warn(&self, scenario: &Scenario, found: &mut Vec<String>) {
        for (number, truck) in first_of_their_kind(self) {
            warn_of_truck(number, truck, found);
            if scenario.suppression.reach_m.is_none() && truck.prm.goal == RoadmapGoal::InReach {
                found.push(format!(
                    "Truck {number} extinguishes fires from its start and never drives: with `suppression.reach_m` \
                     \"none\" every fire is in reach; `prm.goal` \"nearest-milestone\" would make it drive."
                ));
            }
        }
        warn_of_shared_starts(self, found);
    }

    fn blocked_starts(&self, field: &ScenarioField<'_>) -> BlockedStarts {
        let is_blocked = |truck: &Unimog| {
            let checker = CollisionChecker::new(Arc::clone(&field.clearance), truck.vehicle);
            !checker.pose_is_free(truck.start.pose(), 0.0)
        };
        let wanted = self.iter().map(|truck| (truck.vehicle, truck.start.pose()));
        let without_place = first_without_place(wanted, &field.clearance);
        let placed = &self[..without_place.unwrap_or(self.len())];
        let moved = placed.iter().enumerate().filter(|(_, truck)| is_blocked(truck));
        BlockedStarts {
            moved: moved.map(|(number, _)| format!("truck {number}")).collect(),
            without_place: without_place.map(|number| format!("Truck {number}")),
        }
    }

    fn warn_of_field(&self, field: &ScenarioField<'_>, found: &mut Vec<String>) {
        warn_of_roadmaps(self, field, found);
        for (number, truck) in first_of_their_kind(self).filter(|(_, truck)| !truck.speed_by_ground.is_empty()) {
            let name = format!("`speed_by_ground` of truck {number}");
            if field.terrain.landscape.is_none() {
                found.push(format!("The {name} has no effect: the field has bushes and no other ground."));
            } else if truck.planner != TruckPlannerKind::PrmPrimitives.into() {
                let planner = TruckPlannerKind::PrmPrimitives;
                found.push(format!("The {name} slows its drives, but only `{planner}` plans round slow ground."));
            }
        }
    }

    /// Adds up what trucks take, those of one planner together.
    fn memory(&self, field: &FieldMeasures, _: f64) -> AgentsMemory {
        // What planners that are not built in take is theirs.
        let memory = |truck: &Unimog| {
            let planner = truck.planner.built_in()?;
            Some((planner, field.truck_planner(planner, &truck.planner_settings())))
        };
        let trucks: Vec<(TruckPlannerKind, [u64; 2])> = self.iter().filter_map(memory).collect();
        let mut parts = Vec::new();
        for kind in TruckPlannerKind::ALL {
            // Trucks of one planner have one line, as a fleet of a thousand is listed on one page.
            let of_kind = || trucks.iter().filter(|(planner, _)| *planner == kind).map(|(_, memory)| memory);
            let name = |what: &str| match of_kind().count() {
                1 => format!("{what} of a truck ({kind})"),
                count => format!("{what}s of {count} trucks ({kind})"),
            };
            parts.push(MemoryPart::new(name("the planner"), of_kind().map(|[planner, _]| planner).sum()));
            parts.push(MemoryPart::new(name("the flood"), of_kind().map(|[_, floods]| floods).sum()));
        }
        // Floods are counted as they grow, and must not count a second time against the limit.
        let counted = trucks.iter().map(|(_, [_, floods])| floods).sum();
        AgentsMemory { parts, counted, searches: !self.is_empty() }
    }
}

ranges! { Unimog {
    speed_mps: 0.001..=1000.0, reverse_speed_mps: 0.001..=1000.0, seconds_per_expansion: 0.0..=1e6, ready_s: 0.0..=1e6;
    start, vehicle, limits, prm, primitives, prm_rs, hybrid, lattice, safety,
} }
ranges! { StartPose { heading_deg: -360.0..=360.0 } }
ranges! { Limits { acceleration_mps2: 0.001..=1000.0, braking_mps2: 0.001..=1000.0, lateral_mps2: 0.001..=1000.0 } }

fn check_planner_name(table: &TablePath, planner: &PlannerName, programs: &Programs) -> Check {
    if planner.built_in().is_some() || programs.contains_key(planner) {
        return Ok(());
    }
    let custom = programs.keys().map(PlannerName::name);
    let valid_names = TruckPlannerKind::ALL.map(TruckPlannerKind::name).into_iter().chain(custom);
    table.refuse_name("planner", "planner", planner.name(), valid_names.map(str::to_owned).collect())
}

/// Checks that the first truck's planners can work on a field that may not be the one of their scenario.
pub fn check_planners(unimog: &Unimog, frame: &FieldFrame) -> Check {
    let table = TablePath::named("unimog");
    unimog.planner_settings().tables().try_for_each(|tables| table.inner(tables.name).settings(tables.settings, frame))
}

/// Describes what its speed means in its tightest turns: speed squared over radius.
fn describe_turning(truck: &Unimog) -> String {
    let speed = truck.speed_mps.max(truck.reverse_speed_mps);
    let radius_m = truck.vehicle.turning_radius_m;
    let lateral = speed * speed / radius_m;
    let fact = format!("On its circle of {radius_m} m, {speed} m/s is {lateral:.1} m/s2 to the side");
    match truck.limits.lateral_mps2 {
        Some(limit) if limit < lateral => {
            format!("{fact}; {limit} m/s2 allows {:.1} m/s there.", (limit * radius_m).sqrt())
        }
        _ => format!("{fact}."),
    }
}

/// Returns the trucks that are warned of, each with its number: of those that differ in their starts alone, the first few.
fn first_of_their_kind(trucks: &[Unimog]) -> impl Iterator<Item = (usize, &Unimog)> {
    trucks.iter().enumerate().filter(|&(number, truck)| {
        trucks[..number].iter().filter(|other| Unimog { start: truck.start, ..(*other).clone() } == *truck).count()
            < SHOWN_ALIKE
    })
}

fn warn_of_truck(number: usize, unimog: &Unimog, found: &mut Vec<String>) {
    let speed = unimog.speed_mps.max(unimog.reverse_speed_mps);
    let radius_m = unimog.vehicle.turning_radius_m;
    // On the tightest circle it is v^2 / r, the most that a curve asks of the ground.
    let lateral = speed * speed / radius_m;
    if unimog.limits.lateral_mps2.is_none() && lateral > LATERAL_GRIP_MPS2 {
        found.push(format!(
            "Truck {number} drives {speed} m/s on its circle of {radius_m} m: {lateral:.1} m/s2 to the side, more than \
             the {LATERAL_GRIP_MPS2} m/s2 that loose ground holds; `limits.lateral_mps2` would slow it in curves."
        ));
    }
    let planner = unimog.built_in();
    let settings = unimog.planner_settings();
    // A custom planner may read any table, so only those of built-in planners can be called unused.
    let used = planner.map_or(&[][..], BuiltInPlanner::tables);
    for table in settings.tables().filter(|table| !table.is_default && !used.contains(&table.name)) {
        found.push(format!("The `{}` of truck {number} has no effect: its planner does not use it.", table.name));
    }
    if unimog.cost == DriveCost::Time && planner.is_some_and(|planner| !planner.knows_time()) {
        found.push(format!(
            "`cost = \"time\"` of truck {number} has no effect: {} compares drives by its own costs.",
            unimog.planner
        ));
    }
    found.extend(planner.and_then(|planner| planner.warning(&settings, &unimog.vehicle, &format!("truck {number}"))));
}

fn warn_of_shared_starts(trucks: &[Unimog], found: &mut Vec<String>) {
    for (second, truck) in trucks.iter().enumerate() {
        for (first, other) in trucks[..second].iter().enumerate() {
            if (truck.start_centre() - other.start_centre()).length() < truck.vehicle.length_m {
                found.push(format!("Trucks {first} and {second} start on top of each other."));
            }
        }
    }
}

/// Warns of roadmaps that lead almost nowhere: those that are quickly built are built, of others it is estimated.
fn warn_of_roadmaps(trucks: &[Unimog], field: &ScenarioField<'_>, found: &mut Vec<String>) {
    let terrain = field.terrain;
    let mut edges = 0.0;
    for (number, unimog) in first_of_their_kind(trucks) {
        let Some(maker) = unimog.built_in() else { continue };
        let size = maker.roadmap_size(&unimog.planner_settings(), &terrain.frame, terrain.bushes.len());
        let Some(RoadmapSize { milestones, neighbours, max_edge_m }) = size else { continue };
        // The work adds up over trucks, so a fleet of many kinds stays quick to check.
        edges += milestones as f64 * f64::from(neighbours);
        if edges > MAX_EDGES_TRIED {
            let area_m2 = terrain.frame.width_m() * terrain.frame.height_m();
            // This is the mean number of milestones in a disc of that radius; bushes cut off some edges besides.
            let others = milestones as f64 / area_m2 * PI * max_edge_m * max_edge_m;
            if others < PERCOLATION_DEGREE {
                found.push(format!(
                    "The roadmap of truck {number} will be disconnected: a milestone has on average {others:.1} \
                     others within `max_edge_m`, {max_edge_m} m, and below {PERCOLATION_DEGREE} no component spans \
                     the field. Increase `samples`, or set `samples_per_hectare`."
                ));
            }
            continue;
        }
        let checker = CollisionChecker::new(Arc::clone(&field.clearance), unimog.vehicle);
        let ground = unimog.ground_speed(GroundKinds::new(terrain).as_ref());
        let context = TruckPlannerContext {
            ground: ground.as_ref(),
            truck: number as u16,
            seed: SHOWN_SEED,
            checker: &checker,
            // `MAX_EDGES_TRIED` bounds the memory of roadmaps as well.
            memory: &MemoryMeter::unlimited(),
            // Only built-in planners come here, so neither the registry nor programs are asked.
            planners: &Planners::default(),
            programs: &Programs::new(),
        };
        let Ok(planner) = unimog.make_planner(&context) else { continue };
        let BuildReport { samples, components, .. } = planner.build_report();
        if samples == 0 {
            found.push(format!("On the field of seed {SHOWN_SEED} the roadmap of truck {number} has no milestones."));
        } else if is_hardly_connected(samples, components) {
            let apart_m = (terrain.frame.width_m() * terrain.frame.height_m() / f64::from(samples)).sqrt();
            found.push(format!(
                "On the field of seed {SHOWN_SEED} the roadmap of truck {number} is hardly connected: {samples} milestones \
                 in {components} components. They are about {apart_m:.0} m apart, and no edge is longer than \
                 `max_edge_m`, {max_edge_m} m."
            ));
        }
    }
}
