//! The window: what is shown is what the timeline says, whatever keys and mouse do.
//!
//! Its logic runs without a display, with time driven by hand. The real window is seen and used through `xwd` and
//! `xdotool` where there is an X display; with `WILDFIRE_WINDOW_TEST=required` it fails where something is missing.

mod by_hand;
mod display;
mod expected;
mod refusals;
mod watching;
mod xwd;
