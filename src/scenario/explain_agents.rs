//! Agents in plain sentences, for `wildfire check`.

use crate::planning::reachability::LATTICES;

use super::{
    Escape, Retarget, RoadmapGoal, RoadmapSearch, SafetyMap, SafetySettings, StepCost, StepTime, TruckGoal,
    TruckPlannerKind, Unimog, Wumpus, WumpusGoal, WumpusHeuristic, WumpusPlanner,
};

/// Describes what a Wumpus is and does.
pub fn describe_wumpus(wumpus: &Wumpus) -> String {
    let goal = match wumpus.goal {
        WumpusGoal::RandomIntact => "a random intact bush",
        WumpusGoal::NearestIntact => "the nearest intact bush",
        WumpusGoal::FarthestFromTruck => "the intact bush farthest from all trucks",
    };
    let keep = if wumpus.keep_goal { "which it never gives up" } else { "which it drops when it is no longer intact" };
    let lattice = wumpus.lattice_m.map_or("cell centres".into(), |m| format!("a lattice of {m} m from its start on"));
    let diagonals = match wumpus.step_time {
        StepTime::Distance => "",
        StepTime::Uniform => " (diagonal steps take no longer)",
    };
    let (method, details) = describe_walking(wumpus);
    format!(
        "starts at ({}, {}) m, a square of {} m, {} m/s{diagonals}. It goes for {goal}, {keep}, and lights it from \
         within {} m of its centre. {} over {lattice}{}; {}.{}",
        wumpus.start_m[0],
        wumpus.start_m[1],
        wumpus.size_m,
        wumpus.speed_mps,
        wumpus.reach_m,
        method,
        details,
        describe_charge(wumpus.seconds_per_expansion),
        describe_safety(&wumpus.safety)
    )
}

/// Describes how a Wumpus finds its way, in words that go before and after those for the lattice that it walks on.
fn describe_walking(wumpus: &Wumpus) -> (&'static str, String) {
    let cost = match wumpus.step_cost {
        StepCost::Metres => "cost in metres",
        StepCost::Moves => "cost in moves",
    };
    let heuristic = match wumpus.heuristic {
        WumpusHeuristic::Octile => "octile distance",
        WumpusHeuristic::ParentEuclidean => "straight line from the parent",
    };
    let potential = &wumpus.potential;
    let escape = match potential.escape {
        Escape::Wavefront => format!("goes on down the exact cost-to-go, {cost}"),
        Escape::None => "gives the goal up".into(),
    };
    match wumpus.planner {
        WumpusPlanner::Astar => {
            ("A*", format!(", {cost}, {} times the {heuristic} as estimate", wumpus.heuristic_weight))
        }
        WumpusPlanner::Wavefront => ("A wavefront's exact cost-to-go", format!(", {cost}")),
        WumpusPlanner::Potential => (
            "Gradient descent on a potential field",
            format!(
                ": attraction {}, repulsion of strength {} within {} steps; in a local minimum it {escape}",
                potential.scale.map_or(format!("by zeta {}", potential.zeta), |scale| format!("up to {scale}")),
                potential.eta,
                potential.q
            ),
        ),
    }
}

/// Describes what a truck is and does.
pub fn describe_truck(truck: &Unimog) -> String {
    let body = &truck.vehicle;
    let goal = match truck.goal {
        TruckGoal::NearestBurning => "the nearest fire",
        TruckGoal::Oldest => "the oldest fire",
        TruckGoal::LargestCluster => "the nearest fire of the largest burning group",
    };
    let retarget = match truck.retarget {
        Retarget::Never => "keeps it until it is out",
        Retarget::OnEvent => "thinks again whenever something ignites",
    };
    format!(
        "starts with its rear axle at ({}, {}) m, heading {} degrees. {} x {} m, wheelbase {} m, turning radius {} m \
         (steering to {:.1} degrees). {} m/s forward, {} m/s in reverse; {}. {} It goes for {goal} and {retarget}. {}",
        truck.start.x_m,
        truck.start.y_m,
        truck.start.heading_deg,
        body.length_m,
        body.width_m,
        body.wheelbase_m,
        body.turning_radius_m,
        body.max_steering_rad().to_degrees(),
        truck.speed_mps,
        truck.reverse_speed_mps,
        describe_limits(truck),
        describe_turning(truck),
        describe_driving(truck)
    )
}

/// Describes how a truck finds its way.
fn describe_driving(truck: &Unimog) -> String {
    match truck.planner {
        TruckPlannerKind::PrmPrimitives => {
            format!("{} {}{}", roadmap(truck), local_search(truck), describe_safety(&truck.safety))
        }
        TruckPlannerKind::PrmRs => pose_roadmap(truck),
        TruckPlannerKind::HybridAstar => hybrid_search(truck),
        TruckPlannerKind::Lattice => lattice_search(truck),
    }
}

fn describe_limits(truck: &Unimog) -> String {
    let limit = |name: &str, limit: Option<f64>| limit.map(|mps2| format!("{name} {mps2} m/s2"));
    let set: Vec<String> = [
        limit("acceleration", truck.limits.acceleration_mps2),
        limit("braking", truck.limits.braking_mps2),
        limit("to the side", truck.limits.lateral_mps2),
    ]
    .into_iter()
    .flatten()
    .collect();
    if set.is_empty() { "speed changes at once".into() } else { set.join(", ") }
}

/// Describes what its speed means in its tightest turns: speed squared over radius.
fn describe_turning(truck: &Unimog) -> String {
    let (speed, radius_m) = (truck.speed_mps.max(truck.reverse_speed_mps), truck.vehicle.turning_radius_m);
    let lateral = speed * speed / radius_m;
    let fact = format!("On its circle of {radius_m} m, {speed} m/s is {lateral:.1} m/s2 to the side");
    match truck.limits.lateral_mps2 {
        Some(limit) if limit < lateral => {
            format!("{fact}; {limit} m/s2 allows {:.1} m/s there.", (limit * radius_m).sqrt())
        }
        _ => format!("{fact}."),
    }
}

fn roadmap(truck: &Unimog) -> String {
    let prm = &truck.prm;
    let search = match prm.search {
        RoadmapSearch::Astar => "A*",
        RoadmapSearch::Dijkstra => "Dijkstra's search",
        RoadmapSearch::Greedy => "greedy search",
    };
    let goal = match prm.goal {
        RoadmapGoal::InReach => "milestones from which the fire is in reach",
        RoadmapGoal::NearestMilestone => "the milestone nearest to the fire, of those from which it is in reach",
    };
    format!(
        "Roadmap of {} samples, {} neighbours each, edges up to {} m, {} m clear; {search} to {goal}; {}.",
        prm.samples,
        prm.neighbours,
        prm.max_edge_m,
        prm.clearance_m,
        describe_charge(prm.seconds_per_expansion)
    )
}

fn local_search(truck: &Unimog) -> String {
    let local = &truck.primitives;
    format!(
        "Local search with motions of {} m, bins of {} m and {} headings, {} m clear, at most {} expansions; {}.",
        local.step_m,
        local.bin_m,
        local.headings,
        local.clearance_m,
        local.max_expansions,
        describe_charge(local.seconds_per_expansion)
    )
}

fn hybrid_search(truck: &Unimog) -> String {
    let hybrid = &truck.hybrid;
    format!(
        "Hybrid A* with motions of {} m, bins of {} m and {} headings, Reeds-Shepp curves into the goal, {} m clear, a \
         change of direction at the price of {} m, at most {} expansions, then {} shortcuts; {}.",
        hybrid.step_m,
        hybrid.bin_m,
        hybrid.headings,
        hybrid.clearance_m,
        hybrid.cusp_cost,
        hybrid.max_expansions,
        hybrid.shortcuts,
        describe_charge(hybrid.seconds_per_expansion)
    )
}

fn pose_roadmap(truck: &Unimog) -> String {
    let prm_rs = &truck.prm_rs;
    format!(
        "Roadmap of {} poses, and {} places at every corner of a bush, each joined to {} others within {} m by \
         Reeds-Shepp curves, {} m clear, a change of direction at the price of {} m, then {} shortcuts; where it does \
         not serve, hybrid A* with at most {} expansions; {}.",
        prm_rs.samples,
        prm_rs.corner_places,
        prm_rs.neighbours,
        prm_rs.max_edge_m,
        prm_rs.clearance_m,
        prm_rs.cusp_cost,
        prm_rs.shortcuts,
        truck.hybrid.max_expansions,
        describe_charge(prm_rs.seconds_per_expansion)
    )
}

fn lattice_search(truck: &Unimog) -> String {
    let [coarse, middle, fine] =
        LATTICES.map(|lattice| format!("{} m and {} headings", lattice.bin_m, lattice.headings));
    format!(
        "Flood over a lattice of poses: one pose in bins of {coarse}, where that fails of {middle}, then of {fine}; a \
         query spreads from at most {} poses; {}.",
        truck.lattice.max_expansions,
        describe_charge(truck.lattice.seconds_per_expansion)
    )
}

/// Describes what nearness to bushes costs, in words that follow a full stop.
fn describe_safety(safety: &SafetySettings) -> String {
    let nearness = match safety.map {
        SafetyMap::None => return String::new(),
        SafetyMap::Brushfire => "1 beside a bush, 1/D at D cells from one".to_owned(),
        SafetyMap::Cost => {
            let cells = safety.safety_distance.max(2);
            let (beside, far) = (safety.nearness(1), safety.nearness(cells));
            format!("{beside:.2} beside a bush, {far:.2} at {cells} cells from one")
        }
    };
    format!(" For safety a metre costs 1 + {} times s, s being {nearness}.", safety.weight)
}

fn describe_charge(seconds_per_expansion: f64) -> String {
    if seconds_per_expansion == 0.0 {
        "planning takes no simulated time".into()
    } else {
        format!("it stands {seconds_per_expansion} s for every expansion")
    }
}
