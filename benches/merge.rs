//! What it costs to put the slices of a large batch together: CPU time and the most memory of `wildfire merge`, by rows and
//! slices, with one thread and 64 files that may be open.
//!
//! Run with `cargo bench --bench merge`, or with other sizes: `cargo bench --bench merge -- smoke 1000000 1000`, which are
//! the scenario, rows and slices. The journals are made of the lines of forty real runs under other numbers and seeds, 6 KB
//! a row of `smoke` and 20 KB of `contest`.

#![expect(clippy::print_stdout, reason = "a benchmark prints what it measures")]

#[cfg(not(unix))]
fn main() {
    println!("CPU time and memory of another process are measured on Unix only");
}

#[cfg(unix)]
fn main() {
    unix::main();
}

#[cfg(unix)]
mod unix {
    use std::fs::{self, File};
    use std::io::{BufWriter, Write};
    use std::path::Path;
    use std::process::Command;

    use nix::sys::resource::{UsageWho, getrusage};
    use nix::sys::time::TimeValLike;
    use wildfire::batch::plan::BatchRequest;

    const PROGRAM: &str = env!("CARGO_BIN_EXE_wildfire");

    /// Runs whose lines are taken.
    const REAL_RUNS: u64 = 40;

    pub fn main() {
        let args: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
        let number = |at: usize, usual: u64| {
            args.get(at).map_or(usual, |word| word.parse().expect("expected a scenario, rows and slices"))
        };
        let scenario = args.first().map_or("smoke", String::as_str);
        let sizes = match args.len() {
            0 | 1 => vec![(10_000, 1000), (100_000, 1000)],
            _ => vec![(number(1, 100_000), number(2, 1000))],
        };
        println!("{:>10} {:>8} {:>8} {:>10} {:>8} {:>9}", "scenario", "rows", "slices", "journals", "CPU s", "most MB");
        for (rows, slices) in sizes {
            let scratch = tempfile::tempdir().expect("a scratch folder");
            let bytes = write_batch(scratch.path(), scenario, rows, slices);
            let (cpu_s, max_mb) = merge(&scratch.path().join("out"));
            let journals = format!("{} MB", bytes >> 20);
            println!("{scenario:>10} {rows:>8} {slices:>8} {journals:>10} {cpu_s:>8.1} {max_mb:>9.0}");
        }
    }

    /// Merges in a process of its own, and returns its CPU seconds and its most megabytes.
    fn merge(folder: &Path) -> (f64, f64) {
        let before = cpu_s();
        let merged = Command::new("sh")
            .args(["-c", "ulimit -n 64; exec \"$0\" --quiet merge --jobs 1 \"$1\" > /dev/null", PROGRAM])
            .arg(folder)
            .status()
            .expect("there is a shell");
        assert!(merged.success(), "the slices are complete");
        // The largest of all processes that ended so far: those of the real runs are smaller.
        let usage = getrusage(UsageWho::RUSAGE_CHILDREN).expect("the system counts");
        (cpu_s() - before, usage.max_rss() as f64 / 1024.0)
    }

    fn cpu_s() -> f64 {
        let usage = getrusage(UsageWho::RUSAGE_CHILDREN).expect("the system counts");
        (usage.user_time().num_microseconds() + usage.system_time().num_microseconds()) as f64 * 1e-6
    }

    /// Writes the plan and the journals of a batch into a folder `out`; returns the bytes of the journals.
    fn write_batch(scratch: &Path, scenario: &str, rows: u64, slices: u64) -> u64 {
        let (real, out) = (scratch.join("real"), scratch.join("out"));
        let seeds = format!("1..{REAL_RUNS}");
        let batch = ["--quiet", "batch", scenario, "--seeds", &seeds, "--out"];
        let made = Command::new(PROGRAM).args(batch).arg(&real).output().expect("the program can be started");
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let journal = fs::read_to_string(real.join("runs.journal")).expect("it was just written");
        let lines: Vec<&str> = journal.lines().skip(1).map(|line| &line[9..]).collect();

        fs::create_dir(&out).expect("the scratch folder is writable");
        let seeds = format!("1..{rows}").parse().ok();
        let request = BatchRequest { scenarios: vec![scenario.to_owned()], seeds, ..BatchRequest::default() };
        let plan = request.resolve(true).expect("a scenario and seeds");
        fs::write(out.join("plan.json"), plan.to_json()).expect("writable");
        let sha256 = plan.content_sha256();
        let mut bytes = 0;
        for slice in 1..=slices {
            let file = File::create(out.join(format!("runs-{slice}-of-{slices}.journal"))).expect("writable");
            let mut file = BufWriter::new(file);
            let mut write = |json: &str| {
                let line = format!("{:08x} {json}\n", crc32fast::hash(json.as_bytes()));
                file.write_all(line.as_bytes()).expect("there is room");
                bytes += line.len() as u64;
            };
            write(&format!(r#"{{"format":1,"plan_sha256":"{sha256}","slice":"{slice}/{slices}"}}"#));
            for run in (slice..=rows).step_by(usize::try_from(slices).expect("few")) {
                let line = lines[usize::try_from(run).expect("in memory") % lines.len()];
                write(&with_number(&with_number(line, "\"run\":", run), "\"seed\":", run));
            }
        }
        bytes
    }

    /// Puts a number in place of the first one behind a key.
    fn with_number(json: &str, key: &str, number: u64) -> String {
        let (before, after) = json.split_once(key).expect("a row has its run and its seed");
        let rest = after.trim_start_matches(|letter: char| letter.is_ascii_digit());
        format!("{before}{key}{number}{rest}")
    }
}
