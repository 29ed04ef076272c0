//! Errors that prevent a window.
//!
//! Bevy's plugins panic without a display or an adapter. This module converts such a panic to an error message and prints
//! nothing of it.

use std::env;
use std::panic::{self, AssertUnwindSafe};

use thiserror::Error;

/// The libraries that the window loads when it starts (Debian's names).
const LIBRARIES: &str = "libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0";

/// The reason for the missing window.
#[derive(Debug, Error)]
pub enum ViewError {
    #[error(
        "there is no display: DISPLAY is not set; start the program on a desktop, or on a virtual one with xvfb-run (Debian: apt-get install xvfb)"
    )]
    NoDisplay,
    #[error("there is no X display, only a Wayland one: install XWayland (Debian: apt-get install xwayland)")]
    OnlyWayland,
    #[error("the display {display} does not answer; DISPLAY must name a running display")]
    DeadDisplay { display: String },
    #[error("X libraries are missing: install them (Debian: apt-get install {LIBRARIES})")]
    NoLibraries,
    #[error(
        "there is no graphics adapter with a Vulkan driver: install one (Debian: apt-get install mesa-vulkan-drivers, which also draws on the processor)"
    )]
    NoAdapter,
    #[error("the window cannot be opened: {reason}")]
    NoWindow { reason: String },
    #[error("the graphics adapter failed: {reason}")]
    AdapterLost { reason: String },
}

/// Returns the display named by the environment.
pub fn display() -> Result<String, ViewError> {
    let named = |variable| env::var(variable).ok().filter(|value| !value.is_empty());
    match (named("DISPLAY"), named("WAYLAND_DISPLAY")) {
        (Some(display), _) => Ok(display),
        (None, Some(_)) => Err(ViewError::OnlyWayland),
        (None, None) => Err(ViewError::NoDisplay),
    }
}

impl ViewError {
    /// Converts a panic of bevy's windows to an error.
    pub fn from_window_panic(report: String, display: String) -> Self {
        if report.contains("XOpenDisplay") || report.contains("ConnectionRefused") {
            Self::DeadDisplay { display }
        } else if report.contains("LibraryOpen") || report.contains("could not be loaded") {
            Self::NoLibraries
        } else {
            Self::NoWindow { reason: report }
        }
    }
}

/// Runs `work`; if it panics, returns the panic's message and prints nothing.
pub fn quietly<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    // What `work` leaves half done is dropped with it.
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    panic::set_hook(hook);
    result.map_err(|payload| {
        let text = payload.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| payload.downcast_ref::<&str>().copied());
        text.unwrap_or("without a message").split_whitespace().collect::<Vec<_>>().join(" ")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panic_becomes_its_message_on_one_line() {
        assert_eq!(quietly(|| -> u32 { panic!("no\n  {}", "adapter") }), Err("no adapter".into()));
        assert_eq!(quietly(|| 7), Ok(7));
    }
}
