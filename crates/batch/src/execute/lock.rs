//! The locks by which two processes do not work on one slice of a batch, also where file systems are shared and some of
//! them refuse the system's own.
//!
//! `flock` is the system's lock on an open file: it ends with its process, however that ends. Lustre without the mount
//! option `flock`, NFS without a lock daemon and some others refuse it, and others again keep it on each machine by
//! itself. A lock that is a file works wherever a file can be made once only. It names its process, which writes it anew
//! every some seconds; a file whose process is gone, or that stays the same for long, is nobody's and is taken over. Neither
//! compares clocks of machines.

use std::fmt;
use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::str::FromStr;
use std::thread;
use std::time::Duration;

use wildfire_base::time::wall::WallStopwatch;

/// The time after which the process that has a lock file writes it anew.
const BEAT: Duration = Duration::from_secs(5);

/// The time for which a lock file of another machine must stay the same before it is taken over.
const PATIENCE: Duration = Duration::from_secs(40);

/// The time between two looks at somebody else's lock file.
const LOOK: Duration = Duration::from_millis(250);

/// A way to keep two processes from working on one slice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lock {
    /// The lock of the operating system.
    #[default]
    Flock,
    /// A file beside the journal, of the same name with `.lock` behind it.
    File,
    /// Nothing: whoever asks for it sees to it that nobody else works there.
    None,
}

impl FromStr for Lock {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "flock" => Ok(Self::Flock),
            "file" => Ok(Self::File),
            "none" => Ok(Self::None),
            _ => Err("expected `flock`, `file` or `none`".into()),
        }
    }
}

impl fmt::Display for Lock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Flock => "flock",
            Self::File => "file",
            Self::None => "none",
        })
    }
}

/// A reason for which a lock file is not taken, or not kept.
#[derive(Debug)]
pub enum LockFileError {
    /// A process has it; in words, which one.
    Held(String),
    Io(io::Error),
}

/// A lock file that this process has; it is removed in the end.
#[derive(Debug)]
pub struct LockFile {
    path: PathBuf,
    owner: String,
    beats: u64,
    /// None if it is time for the next.
    last_beat: Option<WallStopwatch>,
}

impl LockFile {
    /// Makes the lock file of a journal.
    ///
    /// If there is one already, the answer may take [`PATIENCE`]: the time for which it is watched.
    pub fn take(journal: &Path) -> Result<Self, LockFileError> {
        Self::take_with(journal, PATIENCE)
    }

    fn take_with(journal: &Path, patience: Duration) -> Result<Self, LockFileError> {
        let (path, owner) = (path_of(journal), own_name());
        loop {
            let made = OpenOptions::new().write(true).create_new(true).open(&path);
            let written = made.and_then(|mut file| {
                file.write_all(text_with(&owner, 0).as_bytes())?;
                file.sync_all()
            });
            match written {
                Ok(()) => return Ok(Self { path, owner, beats: 0, last_beat: Some(WallStopwatch::start()) }),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(LockFileError::Io(error)),
            }
            let Some(text) = text_of(&path).map_err(LockFileError::Io)? else { continue };
            if !is_given_up(&path, &text, patience) {
                return Err(LockFileError::Held(owner_in(&text)));
            }
            remove_given_up(&path, &text).map_err(LockFileError::Io)?;
        }
    }

    /// Writes the file anew if it is time; to be called every now and then.
    ///
    /// # Errors
    /// [`LockFileError::Held`] if another process has taken it over.
    pub fn beat(&mut self) -> Result<(), LockFileError> {
        if self.last_beat.is_some_and(|since| since.elapsed() < BEAT) {
            return Ok(());
        }
        match text_of(&self.path).map_err(LockFileError::Io)? {
            Some(text) if text == self.text() => {}
            found => return Err(LockFileError::Held(found.map_or("nobody".into(), |text| owner_in(&text)))),
        }
        self.beats += 1;
        self.last_beat = Some(WallStopwatch::start());
        fs::write(&self.path, self.text()).map_err(LockFileError::Io)
    }

    fn text(&self) -> String {
        text_with(&self.owner, self.beats)
    }
}

fn text_with(owner: &str, beats: u64) -> String {
    format!("{owner} {beats}\n")
}

/// Removes a lock file with this text, unless somebody else has taken it over meanwhile.
fn remove_given_up(path: &Path, text: &str) -> io::Result<()> {
    let aside = path.with_extension(format!("lock.{}.part", process::id()));
    match fs::rename(path, &aside) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        renamed => renamed?,
    }
    // Another process may have been faster, and what was moved be its new lock: it goes back to its place.
    if text_of(&aside)?.as_deref() == Some(text) { fs::remove_file(&aside) } else { fs::rename(&aside, path) }
}

impl Drop for LockFile {
    fn drop(&mut self) {
        if text_of(&self.path).is_ok_and(|text| text == Some(self.text())) {
            // One that stays is taken over by whoever comes next.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Says whether a process seems to be at work on a journal with a lock file: it is there, and its process is not known to
/// be gone.
pub fn has_live_lock_file(journal: &Path) -> io::Result<bool> {
    let path = path_of(journal);
    let Some(text) = text_of(&path)? else { return Ok(false) };
    if let Some(is_alive) = is_alive_here(&text) {
        return Ok(is_alive);
    }
    // Another machine's clock and this one's may differ, so the age counts only where it is far beyond the patience.
    let age = fs::metadata(&path).and_then(|found| found.modified()).map(|time| time.elapsed());
    Ok(!matches!(age, Ok(Ok(age)) if age > 10 * PATIENCE))
}

/// Watches a lock file: true if its process is gone or, as far as anybody can see, does nothing any more.
fn is_given_up(path: &Path, text: &str, patience: Duration) -> bool {
    if let Some(is_alive) = is_alive_here(text) {
        return !is_alive;
    }
    let watched = WallStopwatch::start();
    while watched.elapsed() < patience {
        #[expect(clippy::disallowed_methods, reason = "another machine's process beats in real time")]
        thread::sleep(LOOK.min(patience));
        // A file that is empty is being written.
        if !matches!(text_of(path), Ok(Some(now)) if now == text) {
            return false;
        }
    }
    true
}

fn path_of(journal: &Path) -> PathBuf {
    let mut name = journal.file_name().unwrap_or_default().to_owned();
    name.push(".lock");
    journal.with_file_name(name)
}

fn text_of(path: &Path) -> io::Result<Option<String>> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// The words that name this process: machine, number, and the time at which it began, as the system counts it.
fn own_name() -> String {
    let number = process::id();
    format!("{} {number} {}", machine(), began_at(number).unwrap_or_default())
}

/// Names the process of a lock file in words.
fn owner_in(text: &str) -> String {
    match text.split_ascii_whitespace().collect::<Vec<_>>()[..] {
        [machine, number, ..] => format!("process {number} on {machine}"),
        _ => "a process that is just beginning".into(),
    }
}

/// Says whether the process of a lock file is alive; `None` if it is another machine's, or nothing is known of it.
fn is_alive_here(text: &str) -> Option<bool> {
    let mut words = text.split_ascii_whitespace();
    let (found, number, began) = (words.next()?, words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    let own = machine();
    // Where the system says nothing of processes, this one has no beginning either.
    if found != own || own == UNKNOWN_MACHINE || began_at(process::id()).is_none() {
        return None;
    }
    Some(began_at(number) == Some(began))
}

const UNKNOWN_MACHINE: &str = "unknown";

fn machine() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let name = name.split_ascii_whitespace().next().unwrap_or(UNKNOWN_MACHINE);
    name.to_owned()
}

/// Returns when a process began, in the system's ticks since it was started; `None` if there is none of this number.
fn began_at(process: u32) -> Option<u64> {
    let line = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The second field is the program's name, in parentheses, and may hold anything.
    line.rsplit_once(')')?.1.split_ascii_whitespace().nth(19)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOMENT: Duration = Duration::from_millis(20);

    fn journal(scratch: &tempfile::TempDir) -> PathBuf {
        scratch.path().join("runs-1-of-2.journal")
    }

    #[test]
    fn lock_file_is_had_by_one_and_goes_with_it() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let journal = journal(&scratch);
        assert!(!has_live_lock_file(&journal).expect("readable"));
        let lock = LockFile::take(&journal).expect("it is free");
        assert!(has_live_lock_file(&journal).expect("readable"));
        match LockFile::take(&journal) {
            Err(LockFileError::Held(owner)) => assert!(owner.contains(&process::id().to_string()), "{owner}"),
            other => panic!("{other:?}"),
        }
        drop(lock);
        assert!(!path_of(&journal).exists());
        LockFile::take(&journal).expect("it is free again");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn lock_file_of_a_process_that_is_gone_is_taken_over_at_once() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let journal = journal(&scratch);
        // This process began at another time than the one that wrote the file and had the same number.
        fs::write(path_of(&journal), format!("{} {} 1 7\n", machine(), process::id())).expect("writable");
        assert!(!has_live_lock_file(&journal).expect("readable"));
        LockFile::take_with(&journal, Duration::from_secs(3600)).expect("nobody has it");
    }

    #[test]
    fn lock_file_of_another_machine_is_taken_over_once_it_stays_the_same() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let journal = journal(&scratch);
        fs::write(path_of(&journal), "elsewhere 1 2 3\n").expect("writable");
        assert!(has_live_lock_file(&journal).expect("readable"));
        let lock = LockFile::take_with(&journal, MOMENT).expect("it was given up");
        assert_eq!(text_of(&path_of(&journal)).expect("readable"), Some(lock.text()));
    }

    #[test]
    fn lock_file_that_another_machine_writes_anew_is_not_taken() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let journal = journal(&scratch);
        let path = path_of(&journal);
        fs::write(&path, "elsewhere 1 2 0\n").expect("writable");
        let beating = thread::spawn(move || {
            let watched = WallStopwatch::start();
            while watched.elapsed() < 2 * LOOK {
                thread::yield_now();
            }
            fs::write(&path, "elsewhere 1 2 1\n").expect("writable");
        });
        assert!(matches!(LockFile::take(&journal), Err(LockFileError::Held(_))));
        beating.join().expect("it ends");
    }

    #[test]
    fn process_whose_lock_was_taken_over_finds_it_and_leaves_the_new_one() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let journal = journal(&scratch);
        let mut lock = LockFile::take(&journal).expect("it is free");
        lock.beat().expect("it is its own");
        fs::write(path_of(&journal), "elsewhere 1 2 3\n").expect("writable");
        lock.last_beat = None;
        assert!(matches!(lock.beat(), Err(LockFileError::Held(owner)) if owner == "process 1 on elsewhere"));
        drop(lock);
        assert!(path_of(&journal).exists(), "it is another's");
    }
}
