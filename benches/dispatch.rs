//! What decisions of dispatch policies cost: `cargo bench --bench dispatch`.
//!
//! One decision for trucks and fires that are drawn at random: spread over 10 km, where hardly any fire is in reach, and
//! crowded on 1 km, where all are. Trucks are free, fires at all ages. CPU time of this thread, the mean of several decisions.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::sync::Arc;

use rand::{Rng, RngExt};

use wildfire::geometry::{Cell, DVec2, FieldFrame};
use wildfire::rng;
use wildfire::scenario::{Dispatch, DispatchPolicy, IdleRule};
use wildfire::sim::policies::dispatch::{DispatchRules, Fire, Intact, Team, TeamRules, TeamTruck};
use wildfire::sim::policies::learned::Networks;
use wildfire::time::SimTime;
use wildfire::time::cpu::CpuStopwatch;
use wildfire::timeline::AgentId;

const DECISIONS: u32 = 5;
const BURN_OUT_S: f64 = 60.0;
const DELAY_S: f64 = 10.0;
const NOW_S: f64 = 600.0;

/// One bush in ten cells.
struct Bushes {
    frame: FieldFrame,
    cells: Arc<[Cell]>,
    intact: Vec<bool>,
}

impl Intact for Bushes {
    fn is_intact(&self, cell: Cell) -> bool {
        self.intact[self.frame.index(cell)]
    }

    fn bushes(&self) -> Arc<[Cell]> {
        Arc::clone(&self.cells)
    }
}

fn bushes(side: u16) -> Bushes {
    let frame = FieldFrame { cols: side, rows: side, cell_m: 5.0 };
    let mut rng = rng::stream(1, "bushes");
    let intact: Vec<bool> = (0..frame.cell_count()).map(|_| rng.random_bool(0.1)).collect();
    let cells = (0..frame.cell_count()).filter(|&index| intact[index]).map(|index| frame.cell(index)).collect();
    Bushes { frame, cells, intact }
}

fn team<'a>(bushes: &'a Bushes, trucks: u16, fires: usize, rng: &mut impl Rng) -> Team<'a> {
    let mut burning: Vec<Cell> = (0..fires).map(|_| bushes.cells[rng.random_range(0..bushes.cells.len())]).collect();
    burning.sort_unstable_by_key(|&cell| bushes.frame.index(cell));
    burning.dedup();
    let fire = |cell: Cell| {
        let since_s = NOW_S - rng.random_range(0.0..BURN_OUT_S);
        let spreads_s = since_s + DELAY_S;
        Fire {
            cell,
            place: bushes.frame.centre(cell),
            since: SimTime::from_seconds(since_s),
            burns_out: SimTime::from_seconds(since_s + BURN_OUT_S),
            spreads_at: if spreads_s > NOW_S { SimTime::from_seconds(spreads_s) } else { SimTime::MAX },
        }
    };
    let fires = burning.into_iter().map(fire).collect();
    let truck = |number| {
        let side_m = bushes.frame.width_m();
        let place = DVec2::new(rng.random_range(0.0..side_m), rng.random_range(0.0..side_m));
        TeamTruck {
            id: AgentId::unimog(number),
            place,
            free_at: SimTime::ZERO,
            speed_mps: 8.0,
            goal: None,
            staging_point: None,
            start: place,
            is_queried: true,
            stops_left: u32::MAX,
        }
    };
    Team {
        now: SimTime::from_seconds(NOW_S),
        end: SimTime::from_seconds(3600.0),
        frame: bushes.frame,
        rules: TeamRules {
            reach_m: Some(10.0),
            dwell: SimTime::from_seconds(5.0),
            extinguishes_all: false,
            spread: Some((30.0, SimTime::from_seconds(DELAY_S))),
            caught_spreads: false,
            burn_out: Some(SimTime::from_seconds(BURN_OUT_S)),
        },
        fires,
        trucks: (0..trucks).map(truck).collect(),
        intact: bushes,
        wumpuses: Vec::new(),
        water: None,
    }
}

fn main() {
    let rules = [
        ("nearest-savable", DispatchPolicy::NearestSavable),
        ("hungarian", DispatchPolicy::Hungarian),
        ("threat-first", DispatchPolicy::ThreatFirst),
        ("auction", DispatchPolicy::Auction),
        ("rollout of 40", DispatchPolicy::Rollout),
    ];
    let (county, town) = (bushes(2000), bushes(200));
    let networks = Networks::new(None);
    println!("milliseconds of CPU a decision, and pairs of a truck and a fire, or rollouts");
    for (field, name) in [(&county, "10 km"), (&town, "1 km")] {
        for (trucks, fires) in [(10, 100), (100, 100), (100, 1000), (100, 4000)] {
            print!("{name:>5}, {trucks:3} trucks, {fires:4} fires:");
            for (rule_name, policy) in rules {
                let mut rng = rng::stream(1, "teams");
                let (mut effort, mut spent_ms) = (0, 0.0);
                for _ in 0..DECISIONS {
                    let team = team(field, trucks, fires, &mut rng);
                    let dispatch = Dispatch { policy, ..Dispatch::default() };
                    let mut assignment = DispatchRules::new(&dispatch, &networks).assignment;
                    let mut watch = CpuStopwatch::start();
                    assignment.assign(&team, &mut effort);
                    spent_ms += watch.elapsed_since_last().as_secs_f64() * 1e3;
                }
                print!("  {rule_name} {:.2} ({})", spent_ms / f64::from(DECISIONS), effort / u64::from(DECISIONS));
            }
            println!();
        }
        for trucks in [10, 100] {
            let team = team(field, trucks, 100, &mut rng::stream(2, "teams"));
            let idle: Vec<AgentId> = team.trucks.iter().map(|truck| truck.id).collect();
            let dispatch = Dispatch { idle: IdleRule::Centroids, ..Dispatch::default() };
            let mut staging = DispatchRules::new(&dispatch, &networks).staging.expect("idle trucks spread out");
            let mut watch = CpuStopwatch::start();
            let posts = staging.staging_points(&team, &idle);
            let first_ms = watch.elapsed_since_last().as_secs_f64() * 1e3;
            let mut settled = team;
            for (id, staging_point) in posts {
                settled.trucks[usize::from(id.number)].staging_point = Some(staging_point);
            }
            let mut watch = CpuStopwatch::start();
            staging.staging_points(&settled, &idle);
            let next_ms = watch.elapsed_since_last().as_secs_f64() * 1e3;
            println!("{name:>5}, {trucks:3} idle trucks: centroids {first_ms:.2} first, {next_ms:.2} then");
        }
    }
}
