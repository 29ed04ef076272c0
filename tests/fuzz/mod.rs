//! The common part of fuzzers: cases that follow from their number, and the search for a small case that shows a fault.
//!
//! A case is a string of random bytes from which its input is made, see [`Unstructured`]: fewer bytes, and zeros, make
//! simpler inputs. The bytes follow from the fuzzer's name and the case's number alone, so that any case can be
//! repeated by itself. If a case breaks a law or panics, its bytes are cut as long as something still goes wrong; what
//! is left is reported with the command that repeats it.
//!
//! | variable | meaning |
//! |---|---|
//! | `WILDFIRE_FUZZ_CASES` | how many cases; 0: without end |
//! | `WILDFIRE_FUZZ_FIRST` | the number of the first, 0 unless it is given |
//! | `WILDFIRE_FUZZ_CASE` | the number of the only one, whose input is printed |
//! | `WILDFIRE_FUZZ_JOBS` | threads, 1 unless it is given |

pub mod text;

use std::any::Any;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Once};
use std::time::Duration;
use std::{env, fs, thread};

use arbitrary::Unstructured;
use rand::Rng;
use tempfile::TempDir;
use wildfire::rng;
use wildfire::time::cpu::CpuStopwatch;

/// The seed of all cases.
const SEED: u64 = 20_241_211;

/// The most bytes that a case is made of.
const MAX_BYTES: usize = 1 << 12;

/// The time on one case after which a fuzzer gives up: every case is meant to take milliseconds.
const HANG: Duration = Duration::from_mins(3);

/// The time between two reports of progress where cases run without end.
const NEWS: Duration = Duration::from_mins(1);

/// The number of smaller cases that are tried to find a small one.
const SHRINKING_TRIALS: usize = 400;

/// The bytes of an input that are shown with a fault; a file holds all of it.
const SHOWN_BYTES: usize = 4000;

/// Nothing, or the law that a case breaks.
pub type Law = Result<(), String>;

/// A case in the making: what its input is drawn from, and what it leaves behind.
pub struct Case<'a> {
    pub dice: Unstructured<'a>,
    /// A folder for files, the same for many cases.
    pub folder: &'a Path,
    /// The subject of the case; a smaller case has the same.
    pub kind: &'static str,
    /// The input, which is shown if something is wrong with it.
    pub input: Vec<u8>,
    tally: &'a mut Tally,
}

/// Counts of cases by what happened in them.
type Tally = BTreeMap<String, u64>;

impl Case<'_> {
    /// Counts a case of this sort, for the summary.
    pub fn count(&mut self, sort: impl Into<String>) {
        *self.tally.entry(sort.into()).or_default() += 1;
    }

    /// Draws yes with this chance in percent; no if the bytes have run out.
    pub fn chance(&mut self, percent: u8) -> bool {
        chance(&mut self.dice, percent)
    }

    /// Writes a file into the case's folder.
    pub fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.join(name);
        fs::write(&path, bytes).expect("the scratch folder takes files");
        path
    }
}

/// Draws yes with this chance in percent; no if the bytes have run out.
pub fn chance(dice: &mut Unstructured<'_>, percent: u8) -> bool {
    !dice.is_empty() && dice.int_in_range(1..=100).is_ok_and(|draw: u8| draw <= percent)
}

/// Draws a number from 0 to one less than `count`, which is more than 0; 0 if the bytes have run out.
pub fn below(dice: &mut Unstructured<'_>, count: usize) -> usize {
    dice.int_in_range(0..=count - 1).unwrap_or_default()
}

/// Draws one of several; the first if the bytes have run out.
pub fn one_of<'b, T>(dice: &mut Unstructured<'_>, choices: &'b [T]) -> &'b T {
    &choices[below(dice, choices.len())]
}

/// The result of a case.
struct Examined {
    kind: &'static str,
    input: Vec<u8>,
    outcome: Law,
}

/// The cases that are run, and the number of threads.
struct Order {
    first: u64,
    /// One more than the last.
    end: u64,
    jobs: u64,
    /// True if a single case was asked for, to be seen.
    is_one: bool,
}

impl Order {
    fn read(cases: u64) -> Self {
        let number = |name: &str| {
            let text = env::var(name).ok()?;
            Some(text.parse().unwrap_or_else(|_| panic!("{name} is {text:?}; expected a whole number")))
        };
        if let Some(case) = number("WILDFIRE_FUZZ_CASE") {
            return Self { first: case, end: case + 1, jobs: 1, is_one: true };
        }
        let first = number("WILDFIRE_FUZZ_FIRST").unwrap_or_default();
        let end = match number("WILDFIRE_FUZZ_CASES").unwrap_or(cases) {
            0 => u64::MAX,
            cases => first.saturating_add(cases),
        };
        Self { first, end, jobs: number("WILDFIRE_FUZZ_JOBS").unwrap_or(1).max(1), is_one: false }
    }
}

/// A message of a thread.
enum TriggerEvent {
    Done(Summary),
    /// Something is wrong with a case, and a smaller one is being looked for.
    Found(String),
    Broken(String),
}

#[derive(Default)]
struct Summary {
    cases: u64,
    tally: Tally,
    cpu: Duration,
    slowest: (Duration, u64),
}

impl Summary {
    fn add(&mut self, other: Self) {
        self.cases += other.cases;
        self.cpu += other.cpu;
        self.slowest = self.slowest.max(other.slowest);
        for (sort, count) in other.tally {
            *self.tally.entry(sort).or_default() += count;
        }
    }
}

/// A fuzzer: its name, the test that it is, and the law that every case keeps.
#[derive(Clone, Copy)]
pub struct Fuzzer {
    pub name: &'static str,
    /// The program of tests that it is part of, as an option of cargo: `--test contest`.
    pub target: &'static str,
    pub law: fn(&mut Case<'_>) -> Law,
}

impl Fuzzer {
    /// Runs this number of cases, or those that the environment asks for, and counts what happened.
    ///
    /// # Panics
    /// If a case breaks a law, panics, or takes longer than any should.
    pub fn run(self, cases: u64) -> BTreeMap<String, u64> {
        quiet_panics();
        let order = Arc::new(Order::read(cases));
        let (tell, receiver) = mpsc::channel();
        let stop = Arc::new(AtomicBool::new(false));
        let places: Vec<Arc<AtomicU64>> = (0..order.jobs).map(|_| Arc::new(AtomicU64::new(order.first))).collect();
        for (job, place) in (0..).zip(&places) {
            let (order, tell, place, stop) = (order.clone(), tell.clone(), place.clone(), stop.clone());
            // A thread that hangs is left behind: the process ends without it.
            thread::spawn(move || {
                let last = self.work(job, &order, &place, &stop, &tell);
                tell.send(last)
            });
        }
        let mut summary = Summary::default();
        for _ in 0..order.jobs {
            match self.wait(&receiver, &places) {
                TriggerEvent::Done(part) => summary.add(part),
                TriggerEvent::Found(report) | TriggerEvent::Broken(report) => {
                    stop.store(true, Ordering::Relaxed);
                    panic!("{report}");
                }
            }
        }
        let Summary { cases, cpu, slowest: (time, case), .. } = summary;
        println!("{}: {cases} cases in {cpu:.1?} of CPU time, {time:.1?} of it for case {case}", self.name);
        summary.tally.iter().for_each(|(sort, count)| println!("{count:>12} {sort}"));
        summary.tally
    }

    /// Waits for news of a thread; a thread that makes no progress for long is news too.
    fn wait(self, receiver: &mpsc::Receiver<TriggerEvent>, places: &[Arc<AtomicU64>]) -> TriggerEvent {
        let look = || places.iter().map(|place| place.load(Ordering::Relaxed)).collect::<Vec<_>>();
        let mut last: Vec<(u64, Duration)> = look().into_iter().map(|case| (case, Duration::ZERO)).collect();
        let mut found = None;
        loop {
            match receiver.recv_timeout(NEWS) {
                Ok(TriggerEvent::Found(report)) => found = Some(report),
                Ok(news) => return news,
                Err(RecvTimeoutError::Disconnected) => {
                    return TriggerEvent::Broken(format!("{}: a thread died", self.name));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            for (case, (seen, since)) in look().into_iter().zip(&mut last) {
                *since = if case == *seen { *since + NEWS } else { Duration::ZERO };
                *seen = case;
                if case != u64::MAX && *since >= HANG {
                    let endless = || format!("{}, case {case}: it does not end\n{}", self.name, self.again(case));
                    return TriggerEvent::Broken(found.unwrap_or_else(endless));
                }
            }
            match &found {
                Some(_) => println!("{}: something is wrong, a small case is looked for", self.name),
                None => println!("{}: at case {}", self.name, last.iter().map(|(case, _)| case).min().unwrap_or(&0)),
            }
        }
    }

    /// Runs every case of one thread.
    fn work(
        self,
        job: u64,
        order: &Order,
        place: &AtomicU64,
        stop: &AtomicBool,
        tell: &mpsc::Sender<TriggerEvent>,
    ) -> TriggerEvent {
        let scratch = scratch_folder();
        let mut summary = Summary::default();
        let mut clock = CpuStopwatch::start();
        let mut case = order.first + job;
        while case < order.end && !stop.load(Ordering::Relaxed) {
            place.store(case, Ordering::Relaxed);
            let bytes = bytes_of(self.name, case);
            let examined = self.examine(&bytes, scratch.path(), &mut summary.tally);
            if order.is_one {
                println!("{} case {case}, {}:\n{}", self.name, examined.kind, shown(&examined.input));
            }
            if let Err(fault) = &examined.outcome {
                let found = format!("{}, case {case}, {}: {fault}", self.name, examined.kind);
                // If nobody listens any more, another thread was first.
                let _ = tell.send(TriggerEvent::Found(format!(
                    "{found}\n{}\n{}",
                    shown(&examined.input),
                    self.again(case)
                )));
                let small = self.small(&bytes, examined, scratch.path(), place);
                return TriggerEvent::Broken(format!("{found}\n{small}\n{}", self.again(case)));
            }
            summary.cases += 1;
            let cpu = clock.elapsed_since_last();
            summary.cpu += cpu;
            summary.slowest = summary.slowest.max((cpu, case));
            case += order.jobs;
        }
        place.store(u64::MAX, Ordering::Relaxed);
        TriggerEvent::Done(summary)
    }

    /// Makes a case of its bytes and checks the law on it.
    fn examine(self, bytes: &[u8], folder: &Path, tally: &mut Tally) -> Examined {
        let mut case = Case { dice: Unstructured::new(bytes), folder, kind: "", input: Vec::new(), tally };
        let outcome = quietly(|| (self.law)(&mut case)).unwrap_or_else(Err);
        Examined { kind: case.kind, input: case.input, outcome }
    }

    /// Finds the smallest case like this one in which something goes wrong; says what, and shows its input, which a
    /// file keeps.
    fn small(self, bytes: &[u8], examined: Examined, folder: &Path, place: &AtomicU64) -> String {
        let weight = |bytes: &[u8]| bytes.len() + bytes.iter().filter(|&&byte| byte != 0).count();
        let mut small = (bytes.to_vec(), examined);
        for (trial, number) in smaller(bytes.len()).zip(1..) {
            // Every trial is watched like a case.
            place.store(u64::MAX - number, Ordering::Relaxed);
            let bytes = trial(&small.0);
            if weight(&bytes) < weight(&small.0) {
                let examined = self.examine(&bytes, folder, &mut Tally::new());
                if examined.outcome.is_err() && examined.kind == small.1.kind {
                    small = (bytes, examined);
                }
            }
        }
        let Examined { input, outcome, .. } = small.1;
        let path = env::temp_dir().join(format!("wildfire-fuzz-{}", self.name));
        let kept = match fs::write(&path, &input) {
            Ok(()) => format!("the input is in {}", path.display()),
            Err(error) => format!("the input could not be written to {}: {error}", path.display()),
        };
        format!("made smaller: {}\n{}\n{kept}", outcome.err().unwrap_or_default(), shown(&input))
    }

    fn again(self, case: u64) -> String {
        format!("again: WILDFIRE_FUZZ_CASE={case} cargo test {} {} -- --nocapture", self.target, self.name)
    }
}

/// A folder in memory, where the machine has one: files of cases are many, and writing some waits for the disk.
fn scratch_folder() -> TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a scratch folder")
}

/// The bytes of a case: mostly few, at times many.
fn bytes_of(fuzzer: &str, case: u64) -> Vec<u8> {
    let mut stream = rng::stream(SEED.wrapping_add(case), fuzzer);
    let longest = MAX_BYTES >> (stream.next_u32() % 6);
    let mut bytes = vec![0; longest];
    stream.fill_bytes(&mut bytes);
    bytes
}

/// Makes a simpler string of bytes.
type Trial = Box<dyn Fn(&[u8]) -> Vec<u8>>;

/// Ways to make a string of `length` bytes simpler: ends cut off, stretches cut out, stretches zeroed; large ones
/// first.
fn smaller(length: usize) -> impl Iterator<Item = Trial> {
    let sizes = std::iter::successors(Some(length / 2), |size| (*size > 1).then_some(size / 2));
    let trials = sizes.flat_map(move |size| {
        let size = size.max(1);
        let cut = move |bytes: &[u8]| bytes[..bytes.len().saturating_sub(size)].to_vec();
        let stretches = (0..length.div_ceil(size)).take(24).flat_map(move |number| {
            let stretch = move |bytes: &[u8]| {
                let start = (number * size).min(bytes.len());
                start..(start + size).min(bytes.len())
            };
            let without = move |bytes: &[u8]| [&bytes[..stretch(bytes).start], &bytes[stretch(bytes).end..]].concat();
            let zeroed = move |bytes: &[u8]| {
                let mut changed = bytes.to_vec();
                changed[stretch(bytes)].fill(0);
                changed
            };
            [Box::new(without) as Trial, Box::new(zeroed) as Trial]
        });
        std::iter::once(Box::new(cut) as Trial).chain(stretches)
    });
    trials.take(SHRINKING_TRIALS)
}

/// An input as text, other bytes as escapes.
fn shown(input: &[u8]) -> String {
    let shown = &input[..input.len().min(SHOWN_BYTES)];
    let text: String = shown.utf8_chunks().fold(String::new(), |text, chunk| {
        let readable = chunk.valid().replace(|letter: char| letter.is_control() && letter != '\n', "\u{FFFD}");
        text + &readable + &chunk.invalid().iter().map(|byte| format!("\\x{byte:02X}")).collect::<String>()
    });
    let more = if input.len() > shown.len() { format!("\n... of {} bytes", input.len()) } else { String::new() };
    text + &more
}

thread_local! {
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
    static PLACE: Cell<Option<String>> = const { Cell::new(None) };
}

/// Keeps panics of cases off the terminal, of which there are many while a small one is looked for.
fn quiet_panics() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let other = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if IS_QUIET.get() {
                PLACE.set(info.location().map(ToString::to_string));
            } else {
                other(info);
            }
        }));
    });
}

/// Returns what `work` returns, or what it panics with.
fn quietly<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    IS_QUIET.set(true);
    // A case's input stays as it was made; nothing else that is borrowed outlives the panic.
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    IS_QUIET.set(false);
    let place = || PLACE.take().unwrap_or_default();
    result.map_err(|panic| format!("it panics: {} ({})", message(panic.as_ref()), place()))
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message")
}
