//! The descendants of a process, as `/proc` shows them: who they are, what memory they take, what CPU time they took.
//!
//! On other systems than Linux nothing is found.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::os::unix::fs::FileExt;
use std::time::Duration;

use nix::unistd::{Pid, SysconfVar, sysconf};

/// Looks between two at all processes; the others are at new ones only.
const LOOKS: u32 = 40;

/// A program's processes, beside the one that was started: all descendants of this process.
#[derive(Debug)]
pub struct ProcessTree {
    /// This process, to which those come that lose their parent.
    this_process: i32,
    leader: i32,
    others: BTreeSet<i32>,
    /// The process that was started last when somebody looked, if the system says which that is.
    newest: Option<i32>,
    looks: u32,
    page_bytes: u64,
}

impl ProcessTree {
    pub fn new(leader: i32) -> Self {
        let page_bytes = sysconf(SysconfVar::PAGE_SIZE).ok().flatten().map_or(4096, i64::unsigned_abs);
        Self { this_process: Pid::this().as_raw(), leader, others: BTreeSet::new(), newest: None, looks: 0, page_bytes }
    }

    /// Lists the processes beside the leader.
    pub fn others(&self) -> impl Iterator<Item = i32> + '_ {
        self.others.iter().copied()
    }

    /// Looks who is there; says whether that has changed.
    pub fn look(&mut self) -> bool {
        let before = self.others.clone();
        self.others.retain(|&pid| Stat::of(pid).is_some_and(|stat| stat.is_alive));
        let newest = newest_process();
        self.looks += 1;
        // Numbers are given in rising order, so that most looks need not go through all processes of the machine. One in a
        // while does: a process may be numbered some moments before it can be seen.
        let is_whole = self.looks % LOOKS == 1 || newest.is_none();
        if is_whole || newest != self.newest {
            let from = self.newest.filter(|&from| !is_whole && newest.is_some_and(|newest| newest > from)).unwrap_or(0);
            self.adopt(numbers_of_processes().filter(|&pid| pid > from).collect());
        }
        self.newest = newest;
        self.others != before
    }

    /// Takes in those of these processes that descend from this one.
    fn adopt(&mut self, pids: Vec<i32>) {
        let mut strangers: Vec<(i32, i32)> = pids
            .into_iter()
            .filter(|pid| *pid != self.leader && *pid != self.this_process && !self.others.contains(pid))
            .filter_map(|pid| Stat::of(pid).filter(|stat| stat.is_alive).map(|stat| (pid, stat.parent)))
            .collect();
        // A process may be listed before its parent, which takes another round.
        loop {
            let count = strangers.len();
            strangers.retain(|&(pid, parent)| {
                let is_ours = parent == self.this_process || parent == self.leader || self.others.contains(&parent);
                if is_ours {
                    self.others.insert(pid);
                }
                !is_ours
            });
            if strangers.len() == count {
                return;
            }
        }
    }

    /// Adds up the memory of all. Where that comes to more than `limit`, what they share is counted once.
    pub fn memory_bytes(&self, limit: u64) -> u64 {
        let all = || self.others().chain([self.leader]);
        let resident: u64 = all().map(|pid| self.resident_bytes(pid)).sum();
        // Resident memory first, as the shares of pages take the system far longer to add up.
        if resident <= limit || self.others.is_empty() {
            return resident;
        }
        all().map(|pid| proportional_bytes(pid).unwrap_or_else(|| self.resident_bytes(pid))).sum()
    }

    fn resident_bytes(&self, pid: i32) -> u64 {
        let text = fs::read_to_string(format!("/proc/{pid}/statm")).unwrap_or_default();
        let pages = text.split(' ').nth(1).and_then(|pages| pages.parse::<u64>().ok());
        pages.unwrap_or(0).saturating_mul(self.page_bytes)
    }
}

/// Returns the memory of a process in which a page that several share counts for each of them in part.
fn proportional_bytes(pid: i32) -> Option<u64> {
    let text = fs::read_to_string(format!("/proc/{pid}/smaps_rollup")).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("Pss:"))?;
    Some(line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok()?.saturating_mul(1024))
}

/// Returns the number that the system gave to a process last.
fn newest_process() -> Option<i32> {
    let text = fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().last()?.parse().ok()
}

fn numbers_of_processes() -> impl Iterator<Item = i32> {
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok())
}

/// What the system says about a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stat {
    is_alive: bool,
    parent: i32,
    /// CPU time of children that have ended and were waited for, in ticks of the system.
    ended_ticks: u64,
}

impl Stat {
    fn of(pid: i32) -> Option<Self> {
        Self::parse(&fs::read(format!("/proc/{pid}/stat")).ok()?)
    }

    /// Reads a line of `/proc/PID/stat`.
    fn parse(line: &[u8]) -> Option<Self> {
        // The name of the process is in brackets and may hold any bytes.
        let behind_name = line.iter().rposition(|&byte| byte == b')')? + 1;
        let mut fields = str::from_utf8(&line[behind_name..]).ok()?.split_ascii_whitespace();
        let is_alive = !matches!(fields.next()?, "Z" | "X" | "x");
        let parent = fields.next()?.parse().ok()?;
        // Fields 16 and 17 of proc_pid_stat(5); the name was the second.
        let mut ended = fields.skip(11).map(|field| field.parse::<u64>().ok());
        Some(Self { is_alive, parent, ended_ticks: ended.next()?? + ended.next()?? })
    }
}

/// A clock of the CPU time of a process and its descendants, seen from outside.
///
/// The process's own time is exact to the nanosecond, that of its children that have ended to the system's tick, which is
/// mostly 10 ms. A child that is alive counts from when the supervisor has seen it, with all that it took before.
#[derive(Debug)]
#[cfg_attr(not(target_os = "linux"), expect(dead_code, reason = "only Linux tells what others took"))]
pub struct GroupClock {
    #[cfg(target_os = "linux")]
    clock: Option<nix::time::ClockId>,
    stat: Option<File>,
    tick: Duration,
    /// The other processes that are there.
    pub others: Vec<i32>,
    /// What those took that have ended and were waited for by the supervisor.
    pub reaped: Duration,
    /// The most that was ever read: a time never runs back.
    total: Duration,
}

impl GroupClock {
    pub fn new(pid: i32) -> Self {
        let ticks_a_second = sysconf(SysconfVar::CLK_TCK).ok().flatten().and_then(|ticks| u32::try_from(ticks).ok());
        Self {
            #[cfg(target_os = "linux")]
            clock: nix::time::ClockId::pid_cpu_clock_id(Pid::from_raw(pid)).ok(),
            stat: File::open(format!("/proc/{pid}/stat")).ok(),
            tick: Duration::from_secs(1) / ticks_a_second.unwrap_or(100).max(1),
            others: Vec::new(),
            reaped: Duration::ZERO,
            total: Duration::ZERO,
        }
    }

    /// Reads the time that all have taken so far; `None` where the system does not tell.
    #[cfg(target_os = "linux")]
    pub fn total(&mut self) -> Option<Duration> {
        use nix::time::{ClockId, clock_gettime};

        let of_ended = |stat: Stat| self.tick * u32::try_from(stat.ended_ticks).unwrap_or(u32::MAX);
        // A process that has ended has no clock, and one that ended at once never had; what it took is among what was reaped.
        let time = self.clock.and_then(|clock: ClockId| clock_gettime(clock).ok().map(Duration::from));
        let leader = time.map_or(Duration::ZERO, |time| time + self.leader_stat().map_or(Duration::ZERO, of_ended));
        let others = self.others.iter().filter_map(|&pid| {
            let time = clock_gettime(ClockId::pid_cpu_clock_id(Pid::from_raw(pid)).ok()?).ok().map(Duration::from)?;
            Some(time + Stat::of(pid).map_or(Duration::ZERO, of_ended))
        });
        self.total = self.total.max(leader + others.sum::<Duration>() + self.reaped);
        Some(self.total)
    }

    /// Reads the time that all have taken so far; `None` where the system does not tell.
    #[cfg(not(target_os = "linux"))]
    pub fn total(&mut self) -> Option<Duration> {
        None
    }

    #[cfg_attr(not(target_os = "linux"), expect(dead_code, reason = "only Linux tells what others took"))]
    fn leader_stat(&self) -> Option<Stat> {
        let mut line = [0; 1024];
        let count = self.stat.as_ref()?.read_at(&mut line, 0).ok()?;
        Stat::parse(&line[..count])
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn line_of_a_process_is_read_whatever_its_name() {
        let line = b"12 (a) R) b) S 7 12 12 0 -1 4194304 99 0 0 0 1 2 30 40 20 0 1 0 2471562 0 0\n";
        assert_eq!(Stat::parse(line), Some(Stat { is_alive: true, parent: 7, ended_ticks: 70 }));
        assert_eq!(Stat::parse(b"12 (a) Z 7"), None);
        assert_eq!(Stat::parse(b""), None);
    }

    #[test]
    fn this_process_has_a_parent_memory_and_a_time_that_never_runs_back() {
        let this_process = Pid::this().as_raw();
        assert_eq!(Stat::of(this_process).map(|stat| stat.parent), Some(Pid::parent().as_raw()));
        assert!(ProcessTree::new(this_process).memory_bytes(0) > 100_000);
        let mut clock = GroupClock::new(this_process);
        let mut before = Duration::ZERO;
        for _ in 0..100 {
            let now = clock.total().expect("this is Linux");
            assert!(now >= before);
            before = now;
        }
        assert!(before > Duration::ZERO);
    }
}
