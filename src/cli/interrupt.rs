//! Signals: an exit code for each that asks the program to end, at any moment from its first statement on.
//!
//! Such a signal ends the program at once, in the handler itself, so that no wait outlives it: neither one for a pipe,
//! nor one for a reader of the results. While something is under way that has to be tidied up, [`watch`] turns the
//! first signal into a flag instead; the second ends the program then.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::cli::error::exit;

/// True if the next signal ends the program with the code 130.
static ENDS_INTERRUPTED: AtomicBool = AtomicBool::new(true);

/// True if the next signal ends the program with the code 75.
static ENDS_RESUMABLE: AtomicBool = AtomicBool::new(false);

/// The flag that is set by the first signal that does not end the program.
static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Gives all signals that ask for an end an exit code. It is called once, before anything else.
pub fn install() {
    let caught = "these signals may be caught";
    let signals = ending_signals().map(|signal| (signal, Arc::new(AtomicBool::new(false)))).collect::<Vec<_>>();
    for &(signal, ref is_here) in &signals {
        // Handlers act in the order in which they are registered: a signal that does not end the program makes the
        // next one end it.
        flag::register_conditional_shutdown(signal, exit::INTERRUPTED.into(), &ENDS_INTERRUPTED).expect(caught);
        flag::register_conditional_shutdown(signal, exit::RESUMABLE.into(), &ENDS_RESUMABLE).expect(caught);
        // Two may come here at once, on two threads: each says that it is here before it looks for the other.
        flag::register(signal, Arc::clone(is_here)).expect(caught);
        for (_, other) in signals.iter().filter(|(other, _)| *other != signal) {
            flag::register_conditional_shutdown(signal, exit::INTERRUPTED.into(), Arc::clone(other)).expect(caught);
        }
        flag::register(signal, Arc::clone(&STOP)).expect(caught);
        flag::register(signal, &ENDS_INTERRUPTED).expect(caught);
    }
    #[cfg(unix)]
    {
        /// A flag that nobody reads: a write beyond the limit fails then, which is reported like a full disk.
        static BEYOND_FILE_SIZE_LIMIT: AtomicBool = AtomicBool::new(false);
        flag::register(signal_hook::consts::SIGXFSZ, &BEYOND_FILE_SIZE_LIMIT).expect(caught);
    }
}

/// Lists Ctrl-C, the system's request to end and, unless `nohup` keeps it off, the end of the terminal.
fn ending_signals() -> impl Iterator<Item = i32> {
    #[cfg(unix)]
    let hangup = (!is_hangup_ignored()).then_some(signal_hook::consts::SIGHUP);
    #[cfg(not(unix))]
    let hangup = None;
    [SIGINT, SIGTERM].into_iter().chain(hangup)
}

/// Says whether the program was started by something like `nohup`, as far as the system shows it.
#[cfg(unix)]
fn is_hangup_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal_hook::consts::SIGHUP - 1) & 1 == 1)
}

/// Makes signals end the program with the code of what can be resumed from now on.
pub fn set_resumable() {
    ENDS_RESUMABLE.store(true, Ordering::SeqCst);
    ENDS_INTERRUPTED.store(false, Ordering::SeqCst);
}

/// A guard: while it lives, the first signal sets a flag and is announced, and only the second ends the program.
///
/// Its holder looks at the flag often. Where that fails, because a write or a wait never returns, the program
/// ends some seconds after the first signal.
pub struct Watch {
    stop: Arc<AtomicBool>,
    is_resumable: bool,
}

/// The longest time that the program may tidy up: a batch needs less than two seconds.
pub const USUAL_TIDYING: Duration = Duration::from_secs(5);

/// Begins to watch for the first signal, after which tidying up may take some time.
pub fn watch(longest_tidying: Duration) -> Watch {
    let is_resumable = ENDS_RESUMABLE.load(Ordering::SeqCst);
    #[cfg(not(unix))]
    let _ = longest_tidying;
    #[cfg(unix)]
    announcer::start(if is_resumable { exit::RESUMABLE } else { exit::INTERRUPTED }, longest_tidying);
    ENDS_RESUMABLE.store(false, Ordering::SeqCst);
    ENDS_INTERRUPTED.store(false, Ordering::SeqCst);
    Watch { stop: Arc::clone(&STOP), is_resumable }
}

impl Watch {
    /// The flag that the first signal sets.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        // After a first signal the second is on its way to end the program already.
        if self.stop.load(Ordering::SeqCst) {
            #[cfg(unix)]
            announcer::wait();
            return;
        }
        if self.is_resumable {
            set_resumable();
        } else {
            ENDS_INTERRUPTED.store(true, Ordering::SeqCst);
        }
    }
}

/// A thread that waits for the first signal.
#[cfg(unix)]
mod announcer {
    use std::sync::{Condvar, Mutex, PoisonError};
    use std::thread;
    use std::time::Duration;

    use signal_hook::iterator::Signals;
    use signal_hook::low_level;

    use super::ending_signals;
    use crate::cli::terminal;

    /// Whether the first signal was announced.
    static ANNOUNCED: (Mutex<bool>, Condvar) = (Mutex::new(false), Condvar::new());

    /// The longest time that the end of the program waits for the announcement, which a busy machine may delay.
    const LONGEST_WAIT: Duration = Duration::from_secs(1);

    /// Waits until the first signal was announced.
    pub fn wait() {
        let (announced, changed) = &ANNOUNCED;
        let announced = announced.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = changed.wait_timeout_while(announced, LONGEST_WAIT, |announced| !*announced);
    }

    fn announce() {
        terminal::note("stopping; press Ctrl-C again to stop at once");
        let (announced, changed) = &ANNOUNCED;
        *announced.lock().unwrap_or_else(PoisonError::into_inner) = true;
        changed.notify_all();
    }

    /// Starts the thread; if the system gives none, only the announcement is missing.
    pub fn start(code: u8, longest_tidying: Duration) {
        let Ok(mut signals) = Signals::new(ending_signals()) else { return };
        let _ = thread::Builder::new().spawn(move || {
            if signals.forever().next().is_some() {
                // On a thread of its own: stderr may be the very thing that is stuck.
                let _ = thread::Builder::new().spawn(announce);
                #[expect(clippy::disallowed_methods, reason = "a program that is stuck is stuck in real time")]
                thread::sleep(longest_tidying);
                low_level::exit(code.into());
            }
        });
    }
}
