//! `machines.json`: the machines that worked on a batch, beside the plan and excluded from comparisons of results.
//!
//! Outcomes do not depend on the machine; CPU times do, so a table of them names it. Every process writes down, before its
//! first run, on what it works: of a slice into a file of its own, which nobody else writes, and `wildfire merge` puts these
//! files together. Names of hosts are left out, as they are nobody's business who reads a paper: machines that are alike
//! count as one, with the number of their processes.

use std::ffi::OsStr;
use std::io::ErrorKind;
use std::num::NonZeroUsize;
use std::path::Path;
#[cfg(target_os = "macos")]
use std::process::Command;
use std::{env, thread};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::execute::entries::{MACHINES, named};
use crate::execute::{BatchError, Disk, OutputFolder, write_whole};
use crate::plan::{COMMIT, COMPILER, PROGRAM_VERSION, Slice};
use wildfire_base::document::number::count;
use wildfire_base::input_file::{self, list_of_at_most};

/// The longest file of machines that is read, and the most machines in one.
const MAX_BYTES: u64 = 1 << 20;
const MAX_MACHINES: usize = 4096;
/// The most letters of a name that the system gives.
const MAX_NAME: usize = 200;

/// A machine that worked on a batch, and the program that it worked with.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Machine {
    /// The model of its processor, if known.
    pub cpu: Option<String>,
    /// The number of processors that the process could use.
    pub processors: usize,
    /// The memory of the machine, if known.
    pub memory_bytes: Option<u64>,
    /// The operating system with its version, such as `Linux 6.1.0`.
    pub system: String,
    /// The architecture, such as `x86_64`.
    pub architecture: String,
    /// The number of threads that executed runs.
    pub threads: usize,
    pub program_version: String,
    /// The commit and the compiler of the program.
    pub commit: Option<String>,
    pub compiler: String,
    /// The number of such processes that worked on the batch.
    pub processes: u64,
}

/// The contents of `machines.json`.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Machines {
    /// The machines, in the order in which they began.
    #[serde(deserialize_with = "list_of_at_most::<MAX_MACHINES, _, _>")]
    pub machines: Vec<Machine>,
}

impl Machine {
    /// Returns the machine of this process, which executes runs on `threads` threads.
    pub fn here(threads: usize) -> Self {
        Self {
            cpu: cpu_model().map(|name| shortened(&name)).filter(|name| !name.is_empty()),
            processors: thread::available_parallelism().map_or(1, NonZeroUsize::get),
            memory_bytes: memory_bytes(),
            system: shortened(&system()),
            architecture: env::consts::ARCH.to_owned(),
            threads,
            program_version: PROGRAM_VERSION.to_owned(),
            commit: COMMIT.map(str::to_owned),
            compiler: COMPILER.to_owned(),
            processes: 1,
        }
    }

    /// Describes the machine in words.
    pub fn description(&self) -> String {
        let cpu = self.cpu.as_deref().unwrap_or("unknown processor");
        let memory = self.memory_bytes.map(|bytes| format!(", {:.1} GB of memory", bytes as f64 / 1e9));
        let Self { processors, threads, system, architecture, processes, .. } = self;
        let [processors, threads] =
            [(*processors, "processor"), (*threads, "thread")].map(|(number, thing)| count(number, thing));
        let processes = if *processes == 1 { "1 process".to_owned() } else { format!("{processes} processes") };
        let memory = memory.unwrap_or_default();
        format!("{cpu} ({architecture}), {processors}{memory}, {system}; {processes} with {threads}")
    }
}

impl Machines {
    /// Reads the machines of a batch's folder; empty if there is no such file.
    ///
    /// # Errors
    /// If the file cannot be read, or is not a list of machines.
    pub fn read(folder: &Path) -> Result<Self, BatchError> {
        Self::from_file(&folder.join(MACHINES.name(Slice::WHOLE)))
    }

    fn from_file(path: &Path) -> Result<Self, BatchError> {
        let bytes = match input_file::read(path, MAX_BYTES) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::default()),
            Err(source) => return Err(BatchError::Unreadable { path: path.to_owned(), source }),
            Ok(bytes) => bytes,
        };
        serde_json::from_slice(&bytes)
            .map_err(|error| BatchError::NoMachines { path: path.to_owned(), reason: error.to_string() })
    }

    /// Counts a machine: with one that is like it, if there is one.
    fn add(&mut self, machine: Machine) {
        // Machines are alike if all but their numbers of processes are equal.
        match self
            .machines
            .iter()
            .position(|existing| Machine { processes: machine.processes, ..existing.clone() } == machine)
        {
            Some(place) => {
                let processes = &mut self.machines[place].processes;
                *processes = processes.saturating_add(machine.processes);
            }
            None if self.machines.len() < MAX_MACHINES => self.machines.push(machine),
            None => {}
        }
    }

    fn write(&self, path: &Path, disk: &dyn Disk) -> Result<(), BatchError> {
        let json = serde_json::to_string_pretty(self).expect("machines are names and numbers") + "\n";
        write_whole(disk, path, json.as_bytes())
    }
}

/// Records that this process works on a slice, on this number of threads. No other process may do so at the same time.
pub fn note_machine(folder: &OutputFolder, slice: Slice, threads: usize, disk: &dyn Disk) -> Result<(), BatchError> {
    let path = folder.path().join(MACHINES.name(slice));
    let mut machines = Machines::from_file(&path)?;
    machines.add(Machine::here(threads));
    machines.write(&path, disk)
}

/// Merges the machines of all slices. Without slices it does nothing.
pub fn merge_machines(folder: &OutputFolder, disk: &dyn Disk) -> Result<(), BatchError> {
    let is_of_slice =
        |name: &OsStr| name.to_str().and_then(|name| MACHINES.slice(name)).is_some_and(|slice| !slice.is_whole());
    let mut files: Vec<_> = named(folder.path(), is_of_slice).collect();
    // By slice, as folders list their files in any order.
    files.sort_by_key(|path| path.file_name().and_then(OsStr::to_str).and_then(|name| MACHINES.slice(name)));
    if files.is_empty() {
        return Ok(());
    }
    let mut all = Machines::default();
    for path in files {
        Machines::from_file(&path)?.machines.into_iter().for_each(|machine| all.add(machine));
    }
    all.write(&folder.path().join(MACHINES.name(Slice::WHOLE)), disk)
}

/// The name in one line, without what acts on a terminal.
fn shortened(name: &str) -> String {
    let parts =
        name.split(|letter: char| letter.is_whitespace() || letter.is_control()).filter(|word| !word.is_empty());
    parts.collect::<Vec<_>>().join(" ").chars().take(MAX_NAME).collect()
}

#[cfg(any(target_os = "linux", target_os = "android"))]
fn cpu_model() -> Option<String> {
    model_in(&std::fs::read_to_string("/proc/cpuinfo").ok()?)
}

#[cfg(target_os = "macos")]
fn cpu_model() -> Option<String> {
    sysctl("machdep.cpu.brand_string")
}

#[cfg(not(any(target_os = "linux", target_os = "android", target_os = "macos")))]
fn cpu_model() -> Option<String> {
    env::var("PROCESSOR_IDENTIFIER").ok()
}

/// The model that `/proc/cpuinfo` names, under a key that depends on the architecture.
#[cfg(any(target_os = "linux", target_os = "android", test))]
fn model_in(cpuinfo: &str) -> Option<String> {
    ["model name", "cpu model", "Processor", "Model", "Hardware", "cpu", "uarch"].iter().find_map(|key| {
        let mut lines = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        let value = lines.find(|(name, _)| name.trim() == *key).map(|(_, value)| value.trim().to_owned());
        value.filter(|value| !value.is_empty())
    })
}

#[cfg(any(target_os = "linux", target_os = "android"))]
fn memory_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(target_os = "macos")]
fn memory_bytes() -> Option<u64> {
    sysctl("hw.memsize")?.trim().parse().ok()
}

#[cfg(not(any(target_os = "linux", target_os = "android", target_os = "macos")))]
fn memory_bytes() -> Option<u64> {
    None
}

#[cfg(target_os = "macos")]
fn sysctl(name: &str) -> Option<String> {
    let output = Command::new("/usr/sbin/sysctl").args(["-n", name]).output().ok()?;
    String::from_utf8(output.stdout).ok()
}

#[cfg(unix)]
fn system() -> String {
    match nix::sys::utsname::uname() {
        Ok(found) => format!("{} {}", found.sysname().to_string_lossy(), found.release().to_string_lossy()),
        Err(_) => env::consts::OS.to_owned(),
    }
}

#[cfg(not(unix))]
fn system() -> String {
    env::consts::OS.to_owned()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::execute::RealDisk;

    fn slice(number: u64) -> Slice {
        Slice::new(number, 3).expect("it is one of three")
    }

    #[test]
    fn machine_of_this_process_is_written_down_and_counted() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let folder = OutputFolder::named(scratch.path(), false).expect("it is empty");
        for threads in [2, 2, 1] {
            note_machine(&folder, Slice::WHOLE, threads, &RealDisk).expect("writable");
        }
        let machines = Machines::read(scratch.path()).expect("it was written").machines;
        assert_eq!(machines.iter().map(|one| (one.threads, one.processes)).collect::<Vec<_>>(), [(2, 2), (1, 1)]);
        let here = &machines[0];
        assert_eq!((here.program_version.as_str(), here.compiler.as_str()), (PROGRAM_VERSION, COMPILER));
        assert!(here.processors >= 1 && !here.system.is_empty(), "{here:?}");
        assert!(here.description().ends_with("2 processes with 2 threads"), "{}", here.description());
        #[cfg(target_os = "linux")]
        assert!(
            here.system.starts_with("Linux ") && here.memory_bytes.is_some_and(|bytes| bytes > 1 << 20),
            "{here:?}"
        );
    }

    #[test]
    fn slices_have_files_of_their_own_which_are_put_together() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let folder = OutputFolder::named(scratch.path(), false).expect("it is empty");
        merge_machines(&folder, &RealDisk).expect("there is nothing to do");
        assert!(Machines::read(scratch.path()).expect("there is none").machines.is_empty());
        for number in [2, 1, 3, 1] {
            note_machine(&folder, slice(number), 1, &RealDisk).expect("writable");
        }
        for _ in 0..2 {
            merge_machines(&folder, &RealDisk).expect("writable");
            let machines = Machines::read(scratch.path()).expect("it was written").machines;
            assert_eq!(machines.iter().map(|one| one.processes).collect::<Vec<_>>(), [4], "again it is the same");
        }
        fs::write(scratch.path().join(MACHINES.name(slice(2))), "{\"machines\": 7}").expect("writable");
        let refusal = merge_machines(&folder, &RealDisk).expect_err("it is damaged").to_string();
        assert!(refusal.contains("machines-2-of-3.json is not a list of machines"), "{refusal}");
    }

    #[test]
    fn models_are_found_whatever_the_architecture_calls_them() {
        for (text, model) in [
            (
                "processor\t: 0\nmodel\t\t: 85\nmodel name\t: Intel(R) Xeon(R) CPU\nflags: a b\n",
                Some("Intel(R) Xeon(R) CPU"),
            ),
            ("processor : 0\nBogoMIPS : 108\n\nModel : Raspberry Pi 4\n", Some("Raspberry Pi 4")),
            ("processor : 0\nmodel name :\n", None),
            ("", None),
        ] {
            assert_eq!(model_in(text).as_deref(), model, "{text}");
        }
        assert_eq!(shortened(" A\t\u{1b}[2J  CPU \n"), "A [2J CPU");
    }
}
