//! What a query to a planner that is a program costs this program: CPU time of the asking thread, without the program's own.
//!
//! Run with `cargo bench --bench programs`.

#![expect(clippy::print_stdout, reason = "a benchmark prints what it measures")]

#[cfg(not(unix))]
fn main() {
    println!("programs run on Unix only");
}

#[cfg(unix)]
fn main() {
    unix::main();
}

#[cfg(unix)]
mod unix {
    use std::sync::Arc;

    use wildfire::collision::{ClearanceField, CollisionChecker};
    use wildfire::geometry::{DVec2, Pose};
    use wildfire::planning::memory::MemoryMeter;
    use wildfire::planning::{Goal, GoalDisc, Planners};
    use wildfire::programs::{ProgramPool, Trust, supervisor};
    use wildfire::scenario::{Terrain, TruckPlannerContext, load};
    use wildfire::time::cpu::CpuStopwatch;

    const QUERIES: u32 = 5000;

    /// A planner that answers as fast as a shell can, with this many segments in all.
    fn script(segments: usize) -> String {
        let segments = vec!["[0.0123456789012345,0.1]"; segments].join(",");
        format!(
            "read -r line; echo '{{\"type\":\"hello\",\"protocol\":1}}'; read -r line; echo '{{\"type\":\"ready\"}}'; id=0; \
             while read -r line; do id=$((id+1)); echo \"{{\\\"type\\\":\\\"path\\\",\\\"id\\\":$id,\\\"segments\\\":[{segments}]}}\"; done"
        )
    }

    pub fn main() {
        supervisor::set_command(vec![env!("CARGO_BIN_EXE_wildfire").into()]);
        println!("CPU time of this program for a query to a process, {QUERIES} queries each; limit 60 us");
        for segments in [0, 10, 100] {
            let command = serde_json::to_string(&["sh", "-c", &script(segments)]).expect("texts are JSON");
            let changes = [format!("planner.own.command={command}"), "unimog.planner=own".to_owned()];
            let scenario = load("contest", &changes).expect("it is a scenario");
            let planners = ProgramPool::new(Trust::All).planners_of(&scenario, Planners::default());
            let planners = planners.expect("its name is free");
            let terrain = Terrain::from_scenario(&scenario, 1).expect("it has a field");
            let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
            let truck = &scenario.unimog[0];
            let context = TruckPlannerContext {
                ground: None,
                truck: 0,
                seed: 1,
                checker: &CollisionChecker::new(field, truck.vehicle),
                memory: &MemoryMeter::unlimited(),
                planners: &planners,
                programs: &scenario.planner,
            };
            let mut planner = truck.make_planner(&context).expect("there is a shell");
            // A start outside of the field: the gate refuses a path that leaves it at once, whatever it is.
            let (start, goal) =
                (Pose::new(-50.0, -50.0, 0.0), GoalDisc { centre: DVec2::new(10.0, 10.0), radius_m: 5.0 });
            for _ in 0..100 {
                planner.plan(start, Goal::Disc(goal));
            }
            let mut stopwatch = CpuStopwatch::start();
            let mut program_s = 0.0;
            for _ in 0..QUERIES {
                let plan = planner.plan(start, Goal::Disc(goal));
                program_s += plan.cpu.map_or(0.0, |cpu| cpu.time.as_secs_f64());
            }
            let (ours, queries) = (stopwatch.elapsed_since_last().as_secs_f64(), f64::from(QUERIES));
            println!(
                "{segments:4} segments: {:6.1} us, the program's own {:6.1} us",
                1e6 * ours / queries,
                1e6 * program_s / queries
            );
        }
    }
}
