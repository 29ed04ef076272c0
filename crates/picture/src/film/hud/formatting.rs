//! The written form of times, shares and names.

use std::time::Duration;

use crate::film::field::compass_word;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, compass};
use wildfire_base::time::SimTime;
use wildfire_timeline::{Activity, AgentId};

const NANOS_PER_TENTH: u64 = 100_000_000;

/// Hours, minutes, seconds and tenths that have passed, as `h:mm:ss.t`.
pub fn format_clock(time: SimTime) -> String {
    let tenths = time.as_nanos() / NANOS_PER_TENTH;
    let seconds = tenths / 10;
    format!("{}:{:02}:{:02}.{}", seconds / 3600, seconds / 60 % 60, seconds % 60, tenths % 10)
}

/// A share of a whole as per cent with one decimal; of nothing, 0.
pub fn format_percent(part: u32, whole: u32) -> String {
    format!("{:.1} %", 100.0 * f64::from(part) / f64::from(whole.max(1)))
}

/// Milliseconds below a second, seconds above.
pub fn format_cpu(time: Duration) -> String {
    if time < Duration::from_secs(1) {
        format!("{} ms", time.as_millis())
    } else {
        format!("{:.2} s", time.as_secs_f64())
    }
}

/// Hectares with two decimals, or whole ones from a hundred on.
pub fn format_hectares(hectares: f64) -> String {
    if hectares < 100.0 { format!("{hectares:.2} ha") } else { format!("{hectares:.0} ha") }
}

/// Whole metres, or kilometres with two decimals.
pub fn format_length(metres: f64) -> String {
    if metres < 1000.0 { format!("{metres:.0} m") } else { format!("{:.2} km", metres / 1000.0) }
}

/// How far the middle of a cell lies from an agent, and in which direction.
pub fn format_way(frame: &FieldFrame, from: DVec2, to: Cell) -> String {
    let way = frame.centre(to) - from;
    format!("{:.0} m {}", way.length(), compass_word(compass::azimuth_deg(way)))
}

/// Returns the name of what an agent is doing; one without wheels walks.
pub fn activity_name(agent: AgentId, activity: Activity) -> &'static str {
    if activity == Activity::Driving && !agent.role.drives() { "walking" } else { activity.name() }
}

/// A run of a comparison.
pub fn run_name(run_index: usize) -> &'static str {
    if run_index == 0 { "A" } else { "B" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_show_what_has_passed() {
        assert_eq!(format_clock(SimTime::ZERO), "0:00:00.0");
        assert_eq!(format_clock(SimTime::from_nanos(59_999_999_999)), "0:00:59.9");
        assert_eq!(format_clock(SimTime::from_seconds(3600.0)), "1:00:00.0");
        assert_eq!(format_clock(SimTime::from_seconds(45296.7)), "12:34:56.7");
    }

    #[test]
    fn shares_of_nothing_are_nothing() {
        assert_eq!(format_percent(0, 0), "0.0 %");
        assert_eq!(format_percent(1, 3), "33.3 %");
    }
}
