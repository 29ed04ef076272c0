//! A truck on an empty field whose planner is a shell script.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tempfile::TempDir;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{DVec2, Pose};
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::{Goal, GoalDisc, Plan, Planners, TruckPlanner};
use wildfire::programs::{ProgramPool, Trust, supervisor};
use wildfire::scenario::{Scenario, Terrain, TruckPlannerContext, load};

use crate::children::{self, wait_until};

/// The first messages of a program that is ready.
pub const GREETING: &str = r#"
read -r hello; echo '{"type":"hello","protocol":1,"name":"test","version":"0"}'
read -r field; echo '{"type":"ready"}'
"#;

/// The answer to the query of this number, as a line of a script: ten metres straight ahead.
pub const AHEAD: &str = r#"echo "{\"type\":\"path\",\"id\":$id,\"segments\":[[0,10]]}""#;

/// A script that does `body` for each query, whose number is `$id`.
pub fn script(body: &str) -> String {
    format!(
        "{GREETING}\nid=0\nwhile read -r line; do\ncase $line in *'\"type\":\"end\"'*) exit 0;; esac\nid=$((id+1))\n{body}\ndone\n"
    )
}

/// A scratch folder with a script and a scenario that names it.
pub struct Stage {
    folder: TempDir,
    scenario: Scenario,
    pub pool: ProgramPool,
}

impl Stage {
    /// Writes the script; `settings` are lines of its table.
    pub fn new(script: &str, settings: &str) -> Self {
        // Where a test sets no limit, none is to end a query on a machine that is busy elsewhere.
        let unset = ["start_limit_s", "query_limit_s"].into_iter().filter(|limit| !settings.contains(limit));
        let limits: String = unset.map(|limit| format!("{limit} = 600\n")).collect();
        // The absolute path marks all processes of the script that are not of other programs.
        Self::with_file("script.sh", script.as_bytes(), |path| {
            format!("command = [\"sh\", \"{path}\"]\n{limits}{settings}")
        })
    }

    /// The same with a module.
    pub fn of_module(module: &[u8], settings: &str) -> Self {
        Self::with_file("own.wasm", module, |path| format!("module = \"{path}\"\n{settings}"))
    }

    /// Writes a file; `table` gives lines of the planner's table by its absolute path.
    fn with_file(name: &str, contents: &[u8], table: impl Fn(&str) -> String) -> Self {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join(name);
        fs::write(&path, contents).expect("the scratch folder is writable");
        let table = table(&path.display().to_string());
        let text = format!(
            "duration_s = 60.0\nwumpus = []\n[field]\nsize_m = 100.0\ncoverage = 0.0\n[[unimog]]\nplanner = \"own\"\n\
             [planner.own]\n{table}\n"
        );
        Self::in_folder(folder, &text)
    }

    /// Takes the text of a scenario.
    pub fn from_text(text: &str) -> Self {
        Self::in_folder(tempfile::tempdir().expect("a scratch folder"), text)
    }

    fn in_folder(folder: TempDir, text: &str) -> Self {
        children::restore_signals();
        supervisor::set_command(vec![env!("CARGO_BIN_EXE_wildfire").into()]);
        let file = folder.path().join("stage.toml");
        fs::write(&file, text).expect("the scratch folder is writable");
        let scenario = load(&file.display().to_string(), &[]).expect("it is a scenario");
        Self { folder, scenario, pool: ProgramPool::new(Trust::All) }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Starts the script as the planner of the truck, or says why it does not start.
    pub fn planner(&self) -> Result<Box<dyn TruckPlanner>, String> {
        let (scenario, seed) = (&self.scenario, 7);
        let planners = self.pool.planners_of(scenario, Planners::default()).expect("its name is free");
        let terrain = Terrain::from_scenario(scenario, seed).expect("it is empty");
        let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
        let truck = &scenario.unimog[0];
        let context = TruckPlannerContext {
            truck: 0,
            seed,
            ground: None,
            checker: &CollisionChecker::new(field, truck.vehicle),
            memory: &MemoryMeter::unlimited(),
            planners: &planners,
            programs: &scenario.planner,
        };
        truck.make_planner(&context).map_err(|error| error.to_string())
    }

    /// Numbers of the processes that run in the scratch folder, or name it.
    pub fn processes(&self) -> Vec<u32> {
        processes_in(self.path())
    }

    /// Waits until none is left.
    pub fn expect_nobody(&self) {
        wait_until("no process is left", || self.processes().is_empty());
    }
}

/// Numbers of the processes that run in a folder, or name it; of dead ones nothing is known.
pub fn processes_in(folder: &Path) -> Vec<u32> {
    let is_marked = |process: &PathBuf| {
        let command = fs::read(process.join("cmdline")).unwrap_or_default();
        let works_in = fs::read_link(process.join("cwd")).unwrap_or_default();
        works_in == folder || String::from_utf8_lossy(&command).contains(&folder.display().to_string())
    };
    let found = fs::read_dir("/proc").expect("this is Linux").flatten().map(|entry| entry.path()).filter(is_marked);
    found.filter_map(|process| process.file_name()?.to_str()?.parse().ok()).collect()
}

/// Asks for ten metres straight ahead.
pub fn ask(planner: &mut dyn TruckPlanner) -> Plan {
    let start = Pose::new(40.0, 50.0, 0.0);
    planner.plan(start, Goal::Disc(GoalDisc { centre: DVec2::new(51.5, 50.0), radius_m: 2.0 }))
}
