//! Agents in plain sentences, for `wildfire check`.

use super::{
    Escape, Retarget, StepCost, StepTime, TruckGoal, Unimog, Wumpus, WumpusGoal, WumpusHeuristic, WumpusPlanner,
};
use crate::planning::registry::describe_charge;

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
        wumpus.safety.describe()
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
        truck.planner.maker().describe(&truck.planner_settings())
    )
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
