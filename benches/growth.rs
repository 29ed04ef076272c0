//! How costs grow with the side of the field and with the number of agents: `cargo bench --bench growth`.
//!
//! `WILDFIRE_GROWTH=short` measures less. `WILDFIRE_BEFORE=PROGRAM` puts the figures of another build of the program
//! beside these, as far as its limits allow. CPU time of one thread. Exponents are those of a power of the side, or of
//! the number of agents, through two figures of a column: from the first field on which drives of 500 m fit, or the first
//! number, to the last.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;

use rand::RngExt;
use serde_json::{Value, json};

use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{DVec2, Pose, ops};
use wildfire::planning::kit::ends::free_poses;
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::{Goal, GoalDisc, Planners, TruckPlanner, TruckPlannerKind};
use wildfire::rng;
use wildfire::scenario::{self, Programs, Scenario, Terrain, TruckPlannerContext};
use wildfire::time::cpu::CpuStopwatch;

/// Sides of fields, metres; the first two have a roadmap of the whole field.
const SIDES_M: [f64; 6] = [250.0, 500.0, 1000.0, 2500.0, 5000.0, 10_000.0];
/// The first side on which the farthest goals fit.
const FITTING: usize = 2;
const PLANNERS: [TruckPlannerKind; 3] =
    [TruckPlannerKind::HybridAstar, TruckPlannerKind::PrmRs, TruckPlannerKind::PrmPrimitives];
/// Trucks on each field, and the drives of each from its start.
const TRUCKS: usize = 4;
const DRIVES: usize = 10;
/// The farthest goal.
const FAR_M: f64 = 500.0;
const REACH_M: f64 = 10.0;
/// As dense as the 500 samples of `contest`.
const SAMPLES_PER_HECTARE: f64 = 80.0;

fn main() {
    let is_short = std::env::var("WILDFIRE_GROWTH").is_ok_and(|value| value == "short");
    let before = std::env::var_os("WILDFIRE_BEFORE").map(PathBuf::from);
    fields(is_short, before.as_deref());
    agents(is_short, before.as_deref());
}

/// The figures of a planner on a field.
#[derive(Clone, Debug, Default)]
struct Figures {
    build_ms: f64,
    queries_ms: Vec<f64>,
    solved: usize,
    /// What its planners came to take, and their queries.
    megabytes: f64,
}

impl Figures {
    fn mean(&self) -> f64 {
        self.queries_ms.iter().sum::<f64>() / self.queries_ms.len().max(1) as f64
    }

    fn quantile(&self, share: f64) -> f64 {
        let mut sorted = self.queries_ms.clone();
        sorted.sort_by(f64::total_cmp);
        let rank = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(rank.clamp(1, sorted.len().max(1)) - 1).copied().unwrap_or(f64::NAN)
    }
}

/// Measures planners on fields of all sides.
fn fields(is_short: bool, before: Option<&Path>) {
    println!("Drives of up to {FAR_M} m, {TRUCKS} trucks with {DRIVES} each from its start; contest, cells of 5 m");
    println!(
        "{:15} {:>7} | {:>9} {:>7} {:>7} {:>7} {:>7} {:>6} | {:>10} {:>7} {:>7} {:>6}",
        "planner",
        "side m",
        "build ms",
        "mean ms",
        "median",
        "p95",
        "max",
        "solved",
        "before: ms",
        "mean ms",
        "median",
        "solved"
    );
    let sides = if is_short { &SIDES_M[..4] } else { &SIDES_M[..] };
    let mut found: Vec<Vec<Figures>> = vec![Vec::new(); PLANNERS.len()];
    for &side_m in sides {
        let problem = Problem::new(side_m);
        let file = before.map(|_| problem.write());
        for (number, &kind) in PLANNERS.iter().enumerate() {
            let figures = problem.measure(kind);
            let mut line = format!(
                "{:15} {side_m:7} | {:9.2} {:7.3} {:7.3} {:7.3} {:7.1} {:3}/{} {:9.1} |",
                kind.name(),
                figures.build_ms,
                figures.mean(),
                figures.quantile(0.5),
                figures.quantile(0.95),
                figures.quantile(1.0),
                figures.solved,
                figures.queries_ms.len(),
                figures.megabytes
            );
            if let (Some(program), Some(files)) = (before, &file) {
                match measure_before(program, files, kind) {
                    Some(old) => {
                        let (build, mean, median) = (old.build_ms, old.mean(), old.quantile(0.5));
                        let _ = write!(
                            line,
                            " {build:10.2} {mean:7.3} {median:7.3} {:3}/{}",
                            old.solved,
                            old.queries_ms.len()
                        );
                    }
                    None => line.push_str("    refused"),
                }
            }
            println!("{line}");
            found[number].push(figures);
        }
    }
    for (kind, figures) in PLANNERS.iter().zip(&found) {
        let exponent = |of: fn(&Figures) -> f64| {
            let (first, last) = (of(&figures[FITTING]), of(&figures[figures.len() - 1]));
            ops::ln(last / first) / ops::ln(sides[sides.len() - 1] / sides[FITTING])
        };
        println!(
            "{kind}: exponents in the side: query mean {:.2}, median {:.2}; build {:.2}",
            exponent(Figures::mean),
            exponent(|figures| figures.quantile(0.5)),
            exponent(|figures| figures.build_ms)
        );
    }
}

/// A field, and drives of some trucks.
struct Problem {
    scenario: Scenario,
    terrain: Terrain,
    field: Arc<ClearanceField>,
    drives: Vec<(Pose, Vec<GoalDisc>)>,
}

impl Problem {
    fn new(side_m: f64) -> Self {
        let mut scenario = scenario::load("contest", &[]).expect("it is built in");
        scenario.field.size_m = side_m;
        let terrain = Terrain::from_scenario(&scenario, 1).expect("the field has room for its bushes");
        let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
        let checker = CollisionChecker::new(Arc::clone(&field), scenario.unimog[0].vehicle);
        let mut rng = rng::stream(1, "growth");
        let starts: Vec<Pose> = free_poses(&checker, 1.0, &mut rng).take(TRUCKS).collect();
        let drives = starts.into_iter().map(|start| {
            let near: Vec<DVec2> = terrain
                .bushes
                .iter()
                .map(|&bush| terrain.frame.centre(bush))
                .filter(|centre| centre.distance(start.position()) < FAR_M)
                .collect();
            let mut goal = || GoalDisc { centre: near[rng.random_range(0..near.len())], radius_m: REACH_M };
            (start, (0..DRIVES).map(|_| goal()).collect())
        });
        let drives = drives.collect();
        Self { scenario, terrain, field, drives }
    }

    fn measure(&self, kind: TruckPlannerKind) -> Figures {
        let mut truck = self.scenario.unimog[0].clone();
        truck.planner = kind.into();
        truck.prm.samples_per_hectare = Some(SAMPLES_PER_HECTARE);
        let checker = CollisionChecker::new(Arc::clone(&self.field), truck.vehicle);
        let before = resident_megabytes("self", "VmRSS");
        let mut figures = Figures::default();
        let mut planners: Vec<Box<dyn TruckPlanner>> = Vec::new();
        let mut watch = CpuStopwatch::start();
        for number in 0..self.drives.len() {
            let context = TruckPlannerContext {
                ground: None,
                truck: number as u16,
                seed: 1,
                checker: &checker,
                memory: &MemoryMeter::unlimited(),
                planners: &Planners::default(),
                programs: &Programs::new(),
            };
            planners.push(truck.make_planner(&context).expect("it is built in"));
        }
        figures.build_ms = watch.elapsed_since_last().as_secs_f64() * 1e3 / self.drives.len() as f64;
        for (planner, (start, goals)) in planners.iter_mut().zip(&self.drives) {
            for &goal in goals {
                watch.elapsed_since_last();
                let plan = planner.plan(*start, Goal::Disc(goal));
                figures.queries_ms.push(watch.elapsed_since_last().as_secs_f64() * 1e3);
                figures.solved += usize::from(plan.path.is_ok());
            }
        }
        figures.megabytes = resident_megabytes("self", "VmRSS") - before;
        figures
    }

    /// Writes the problem of each truck as a file; returns their paths.
    fn write(&self) -> Vec<PathBuf> {
        let folder = std::env::temp_dir().join(format!("wildfire-growth-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("there is a folder for temporary files");
        let cells: Vec<[u16; 2]> = self.terrain.bushes.iter().map(|cell| [cell.col, cell.row]).collect();
        let drives = self.drives.iter().enumerate().map(|(truck, (start, goals))| {
            let goals: Vec<Value> =
                goals.iter().map(|goal| json!({ "disc": [goal.centre.x, goal.centre.y, goal.radius_m] })).collect();
            let problem = json!({
                "n": self.terrain.frame.cols,
                "cell_m": self.terrain.frame.cell_m,
                "cells_cr": cells,
                "start": [start.x, start.y, start.heading],
                "goals": goals,
            });
            let path = folder.join(format!("truck_{truck}.json"));
            std::fs::write(&path, problem.to_string()).expect("the disk has room");
            path
        });
        drives.collect()
    }
}

/// Lets another program plan the drives of some files; `None` if it refuses.
fn measure_before(program: &Path, files: &[PathBuf], kind: TruckPlannerKind) -> Option<Figures> {
    let mut command = Command::new(program);
    command.arg("plan").args(files).args(["--planner", kind.name(), "--json", "--memory", "8GB"]);
    let report: Value = serde_json::from_slice(&command.output().ok()?.stdout).ok()?;
    let rows = report["rows"].as_array()?;
    let milliseconds = |row: &Value, name: &str| row[name].as_f64().unwrap_or(f64::NAN) * 1e3;
    Some(Figures {
        build_ms: rows.iter().map(|row| milliseconds(row, "cpu_build_s")).sum::<f64>() / rows.len() as f64,
        queries_ms: rows.iter().map(|row| milliseconds(row, "cpu_query_s")).collect(),
        solved: rows.iter().filter(|row| row["success"] == true).count(),
        megabytes: f64::NAN,
    })
}

/// Measures runs with more and more trucks, and Wumpuses.
fn agents(is_short: bool, before: Option<&Path>) {
    let counts: &[usize] = if is_short { &[1, 5, 20] } else { &[1, 2, 5, 10, 20, 50, 100] };
    let program = Path::new(env!("CARGO_BIN_EXE_wildfire"));
    type Fleet = fn(usize) -> [usize; 2];
    let fleets: [(&str, Fleet); 2] =
        [("trucks, with 5 Wumpuses", |count| [count, 5]), ("Wumpuses, with 5 trucks", |count| [5, count])];
    for (title, fleet) in fleets {
        println!("\n{title}: 1 km, hybrid-astar, 900 s");
        println!("{:>6} {:>8} {:>8} {:>8} | before: CPU s, MB", "count", "CPU s", "MB", "plans");
        let mut cpu = Vec::new();
        for &count in counts {
            let [trucks, wumpuses] = fleet(count);
            let Some((seconds, megabytes, plans)) = run(program, trucks, wumpuses) else {
                println!("{count:6}  refused");
                continue;
            };
            let old = before.and_then(|program| run(program, trucks, wumpuses));
            let old = old.map_or(String::new(), |(seconds, megabytes, _)| format!("{seconds:8.3} {megabytes:8.1}"));
            println!("{count:6} {seconds:8.3} {megabytes:8.1} {plans:8} | {old}");
            cpu.push((count as f64, seconds));
        }
        if let [(first, min), .., (last, max)] = cpu[..] {
            println!("exponent of CPU in the number: {:.2}", ops::ln(max / min) / ops::ln(last / first));
        }
    }
}

/// Lets a program play a run with so many trucks and Wumpuses; returns CPU seconds, megabytes and the trucks' plans.
fn run(program: &Path, trucks: usize, wumpuses: usize) -> Option<(f64, f64, u64)> {
    const SIDE_M: f64 = 1000.0;
    // On a square lattice, row by row, off the middle of cells so that no two share a place with anybody.
    let place = |number: usize, count: usize, shift: f64| {
        let along = (count as f64).sqrt().ceil();
        let at = |index: usize| ((index as f64 + 0.5) / along * SIDE_M + shift).clamp(20.0, SIDE_M - 20.0);
        [at(number % along as usize), at(number / along as usize)]
    };
    let list = |entries: Vec<String>| format!("[{}]", entries.join(","));
    let truck = |number| {
        let [x, y] = place(number, trucks, 0.0);
        format!("{{start={{x_m={x:.1},y_m={y:.1},heading_deg=0.0}},planner=\"hybrid-astar\"}}")
    };
    let wumpus = |number| {
        let [x, y] = place(number, wumpuses, 15.0);
        format!("{{start_m=[{x:.1},{y:.1}]}}")
    };
    let changes = [
        format!("field.size_m={SIDE_M}"),
        "duration_s=900".to_owned(),
        format!("unimog={}", list((0..trucks).map(truck).collect())),
        format!("wumpus={}", list((0..wumpuses).map(wumpus).collect())),
    ];
    let mut command = Command::new(program);
    command.args(["run", "contest", "--json", "--quiet", "--memory", "8GB"]);
    command.args(changes.iter().flat_map(|change| ["--set", change]));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?;
    let (output, megabytes) = watch(child)?;
    let report: Value = serde_json::from_slice(&output).ok()?;
    let plans = report["run"]["truck_plans"].as_u64().unwrap_or(0);
    Some((report["measured"]["cpu_run_s"].as_f64()?, megabytes, plans))
}

/// Waits for a process; returns what it wrote, and the most memory that it was seen to hold.
fn watch(child: Child) -> Option<(Vec<u8>, f64)> {
    let id = child.id().to_string();
    let reader = std::thread::spawn(move || child.wait_with_output());
    let mut max = 0.0_f64;
    while !reader.is_finished() {
        max = max.max(resident_megabytes(&id, "VmHWM"));
        std::thread::park_timeout(std::time::Duration::from_millis(2));
    }
    Some((reader.join().ok()?.ok()?.stdout, max))
}

/// Reads a figure of a process's memory, where the system tells it; else 0.
fn resident_megabytes(process: &str, name: &str) -> f64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
    line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()).map_or(0.0, |kb| kb / 1e3)
}
