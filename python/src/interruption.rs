//! Early termination of work, and supervision of calls to Python code.
//!
//! Python code that a batch calls from one of its threads receives no signals. An exception raised in its thread from
//! outside ends it when it next executes Python: `KeyboardInterrupt` to end everything, `QueryTimedOut` if a query has
//! exceeded its CPU time. If the code does not return to Python, the caller waits and reports it on stderr.

use std::ffi::c_int;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};
use std::thread;
use std::time::Duration;

use pyo3::call::PyCallArgs;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use wildfire::time::cpu::CpuStopwatch;
use wildfire::time::wall::WallStopwatch;

use crate::errors::{QueryTimedOut, error};

/// The polling interval.
const POLL: Duration = Duration::from_millis(50);

/// The time after which an ignored exception is raised again.
const RAISED_AGAIN: Duration = Duration::from_secs(1);

/// The time after which a call is first reported, and the factor to each later report.
const FIRST_WARNING: Duration = Duration::from_secs(10);
const WARNING_FACTOR: u32 = 6;

/// A request to end work early: an exception that ends the program, or an I/O error.
#[derive(Default)]
pub struct Interruption {
    stop: Arc<AtomicBool>,
    exception: Mutex<Option<PyErr>>,
    calls: Mutex<Vec<Call>>,
    /// Locked by each run that may call Python.
    runs: RwLock<()>,
}

/// A call to Python code under way.
struct Call {
    about: String,
    /// Python's identifier of the thread.
    thread: u64,
    since: WallStopwatch,
    /// The thread's CPU clock, if there is a limit, and the time at which it is reached.
    clock: Option<c_int>,
    end: f64,
    raised: Option<WallStopwatch>,
    warning_at: Duration,
}

impl Interruption {
    /// Returns the flag that asks all threads to stop.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    pub fn is_set(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Asks all threads to stop because of this exception. The first exception is kept.
    pub fn set(&self, exception: PyErr) {
        self.exception.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(exception);
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Takes the exception that requested the stop, if there was one.
    pub fn take(&self) -> Option<PyErr> {
        self.exception.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Performs a run that may call Python, unless a stop was requested.
    pub fn run<T>(&self, run: impl FnOnce() -> T) -> Option<T> {
        let _under_way = self.runs.read().unwrap_or_else(PoisonError::into_inner);
        (!self.is_set()).then(run)
    }

    /// Waits until no run is under way: a thread that returned to Python after its shutdown would end the process.
    pub fn wait_for_runs(&self) {
        drop(self.runs.write().unwrap_or_else(PoisonError::into_inner));
    }

    /// Calls Python code under supervision.
    ///
    /// # Errors
    /// A message if the answer took more CPU time than the limit. An exception that ends the program is never late.
    pub fn watched<T>(
        &self,
        py: Python<'_>,
        about: impl FnOnce() -> String,
        limit_s: Option<f64>,
        call: impl FnOnce() -> PyResult<T>,
    ) -> Result<PyResult<T>, String> {
        let here = watch(py, "here", (limit_s,)).and_then(|here| here.extract::<(u64, Option<c_int>, f64)>());
        if let Ok((thread, clock, end)) = here {
            let (about, since) = (about(), WallStopwatch::start());
            self.calls(py).push(Call { about, thread, since, clock, end, raised: None, warning_at: FIRST_WARNING });
        }
        // Some systems have no CPU clocks of other threads: there a late answer is at least found out once it is given.
        let mut stopwatch = CpuStopwatch::start();
        let answer = call();
        let cpu_s = stopwatch.elapsed_since_last().as_secs_f64();
        let mut was_raised = false;
        if let Ok((thread, ..)) = here {
            // The supervisor raises while it holds this lock, so nothing more is raised for a call that was removed under it.
            let mut calls = self.calls(py);
            // Calls of one thread end in the reverse order of their starts.
            let ended = calls.iter().rposition(|call| call.thread == thread).map(|place| calls.remove(place));
            drop(calls);
            was_raised = ended.is_some_and(|ended| ended.raised.is_some());
            if was_raised {
                // A pending exception is raised here or never.
                let _ = watch(py, "raise_in", (thread, py.None()));
            }
        }
        let Some(limit_s) = limit_s else { return Ok(answer) };
        let is_late = match &answer {
            // A planner may raise this class for reasons of its own, such as a timeout of something that it asked.
            Err(raised) if raised.is_instance_of::<QueryTimedOut>(py) => was_raised || cpu_s > limit_s,
            Err(raised) => cpu_s > limit_s && !is_an_end(py, raised),
            Ok(_) => cpu_s > limit_s,
        };
        if is_late { Err(format!("no answer within {limit_s} s of CPU time")) } else { Ok(answer) }
    }

    fn calls(&self, py: Python<'_>) -> MutexGuard<'_, Vec<Call>> {
        self.calls.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// Checks the calls under way.
    fn look(&self, py: Python<'_>) {
        let mut warnings = Vec::new();
        for call in self.calls(py).iter_mut() {
            let is_past = |clock| watch(py, "is_past", (clock, call.end)).and_then(|past| past.extract::<bool>());
            let is_late = call.clock.is_some_and(|clock| is_past(clock).unwrap_or(false));
            let is_due = call.raised.is_none_or(|before| before.elapsed() > RAISED_AGAIN);
            if is_due && (self.is_set() || is_late) {
                let end = py.get_type::<PyKeyboardInterrupt>();
                let class = if self.is_set() { end } else { py.get_type::<QueryTimedOut>() };
                let _ = watch(py, "raise_in", (call.thread, class));
                call.raised = Some(WallStopwatch::start());
            }
            if call.since.elapsed() > call.warning_at {
                call.warning_at *= WARNING_FACTOR;
                let waits = if self.is_set() { "; everything waits until it returns to Python" } else { "" };
                warnings.push(format!("{} has taken {} s so far{waits}", call.about, call.since.elapsed().as_secs()));
            }
        }
        warnings.iter().for_each(|warning| say(py, warning));
    }

    /// Works on this thread while another one supervises calls to Python.
    pub fn work<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
        py.detach(|| {
            thread::scope(|scope| {
                let (is_over, ended) = mpsc::channel::<()>();
                scope.spawn(move || {
                    while ended.recv_timeout(POLL) == Err(RecvTimeoutError::Timeout) {
                        Python::attach(|py| self.look(py));
                    }
                });
                // The work stays on this thread, since Python delivers Ctrl-C to its main thread alone.
                let done = work();
                // The scope waits for the supervisor, which ends when nobody can send any more.
                drop(is_over);
                done
            })
        })
    }

    /// Works on a new thread while this one supervises calls to Python and checks for Ctrl-C.
    pub fn work_aside<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        py.detach(|| {
            thread::scope(|scope| {
                let (sender, ended) = mpsc::channel();
                // The receiver still exists.
                let work = move || drop(sender.send(work()));
                thread::Builder::new().spawn_scoped(scope, work).map_err(error)?;
                loop {
                    match ended.recv_timeout(POLL) {
                        Ok(result) => return Ok(result),
                        Err(RecvTimeoutError::Disconnected) => {
                            return Err(PyRuntimeError::new_err("the work ended without a result"));
                        }
                        Err(RecvTimeoutError::Timeout) => Python::attach(|py| {
                            py.check_signals().unwrap_or_else(|exception| self.set(exception));
                            self.look(py);
                        }),
                    }
                }
            })
        })
    }
}

/// Returns whether an exception ends more than the code that raised it.
pub fn is_an_end(py: Python<'_>, exception: &PyErr) -> bool {
    !exception.is_instance_of::<PyException>(py)
}

/// Writes a line to Python's stderr; errors are ignored, since a closed stderr is intentional.
pub fn say(py: Python<'_>, sentence: &str) {
    let _ = watch(py, "say", (sentence,));
}

/// Calls a function of the package's `watch.py`.
fn watch<'py>(py: Python<'py>, name: &str, arguments: impl PyCallArgs<'py>) -> PyResult<Bound<'py, PyAny>> {
    py.import("wildfire_contest.watch")?.call_method1(name, arguments)
}
