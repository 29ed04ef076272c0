//! Catches panics inside runs, so that they become rows of the batch instead of its end.

use std::cell::{Cell, RefCell};
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static CATCHING: Cell<bool> = const { Cell::new(false) };
    static REPORT: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs `work`; if it panics, returns the message and the location on one line.
///
/// Nothing is printed for such a panic. The first call installs a panic hook for the whole process; panics elsewhere
/// still go to the hook that was there before.
pub fn catch<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    install_hook();
    CATCHING.set(true);
    // What `work` borrowed may be left half changed by a panic; callers hand in nothing that outlives it.
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    CATCHING.set(false);
    result.map_err(|_| REPORT.take().unwrap_or_else(|| "without a message".into()))
}

fn install_hook() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let other_hook = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if CATCHING.get() {
                REPORT.set(Some(describe(info)));
            } else {
                other_hook(info);
            }
        }));
    });
}

fn describe(info: &panic::PanicHookInfo<'_>) -> String {
    let message = info.payload_as_str().unwrap_or("without a message");
    let one_line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    match info.location() {
        Some(place) => format!("{one_line} ({}:{})", place.file(), place.line()),
        None => one_line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panic_becomes_its_message_and_place_on_one_line() {
        let report = catch(|| -> u32 { panic!("first line\n  second {}", 2) }).expect_err("it panicked");
        assert!(report.starts_with("first line second 2 ("), "{report}");
        assert!(report.contains("src/execute/panics.rs:"), "{report}");
    }

    #[test]
    fn quiet_work_returns_its_value_and_old_reports_do_not_leak() {
        assert!(catch(|| panic!("once")).is_err());
        assert_eq!(catch(|| 7), Ok(7));
        let report = catch(|| -> () { panic!("twice") }).expect_err("it panicked");
        assert!(report.starts_with("twice"), "{report}");
    }
}
