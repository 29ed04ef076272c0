//! Values that contradict each other: a file with both is refused, and a change of the command line replaces the other.

use toml::Value;

use super::change::SettingChanges;
use crate::faults::error::Fault;
use crate::faults::path::FieldPath;
use wildfire_planning::registry::ALTERNATIVES;

/// Options of `[field]` that say how to generate one.
pub(crate) const GENERATED_ONLY: [&str; 6] =
    ["field.size_m", "field.coverage", "field.pieces", "field.shapes", "field.overlaps", "field.start_clearance_m"];

const ELEVATION: &str = "fire.rothermel.elevation";
const FUEL_MAP: &str = "fire.rothermel.fuel_map";
const SLOPE: &str = "fire.rothermel.slope";
const ASPECT: &str = "fire.rothermel.aspect";
const SLOPE_DEG: &str = "fire.rothermel.slope_deg";
const MOISTURE_FILE: &str = "fire.rothermel.moisture_file";
const MOISTURE_RASTERS: &str = "fire.rothermel.moisture_rasters";

const STEEPNESS: &str = "each sets the slope of the ground";

/// Values of which a file gives one, and why; `*` stands for any number in a list. A change of one replaces the other.
const EITHER: [(&[&str], &[&str], &str); 16] = [
    (&["planner.*.module"], &["planner.*.command"], "each says what plans"),
    (&["policy.*.module"], &["policy.*.command"], "each says what decides"),
    (&["field.pieces"], &["field.coverage"], "each sets the number of bushes"),
    (&["unimog.*.goal"], &["dispatch"], "each chooses where trucks go"),
    (&[FUEL_MAP], &["landscape.image"], "each sets what grows where"),
    (&[ELEVATION], &[SLOPE, ASPECT], STEEPNESS),
    (&[SLOPE_DEG], &[ELEVATION, SLOPE, ASPECT], STEEPNESS),
    (&["landscape.hills"], &[ELEVATION, SLOPE, ASPECT, SLOPE_DEG], STEEPNESS),
    (&["wind"], &["wind_file"], "each sets the changes of the wind"),
    (
        &["weather.samples"],
        &["weather.speed_sd_mps", "weather.toward_sd_deg", "weather.moisture_sd"],
        "each sets the uncertainty of the weather",
    ),
    (&["weather.samples"], &["weather.moisture"], "one of its rows holds for the whole run"),
    (&["weather.file"], &["wind", "wind_file"], "each sets the changes of the wind"),
    (&["weather.file"], &["weather.samples"], "each sets the weather of a run"),
    (&["weather.dead_moisture"], &["weather.moisture"], "each sets the moisture of dead fuel"),
    (&[MOISTURE_FILE], &[MOISTURE_RASTERS], "each sets the moisture of places"),
    (
        &[MOISTURE_FILE, MOISTURE_RASTERS],
        &["weather.moisture", "weather.dead_moisture"],
        "moisture by place stays the same throughout a run",
    ),
];

/// Values that files beside them decide, and why. A change of a file replaces them; a change of them is refused, as it
/// would lose a map.
const DECIDED: [(&[&str], &[&str], &str); 5] = [
    (&GENERATED_ONLY, &["field.map"], "a map sets the bushes itself"),
    (&["fire.rothermel.ground"], &[FUEL_MAP], "a fuel map sets the vegetation itself"),
    (&["fire.rothermel.ground"], &["landscape.image"], "an image sets the vegetation itself"),
    (&["field.size_m"], &["landscape.image"], "an image has a pixel for each cell"),
    (
        &["field.size_m", "field.cell_m"],
        &[
            FUEL_MAP,
            ELEVATION,
            SLOPE,
            "fire.crowns.height_map",
            "fire.crowns.base_map",
            "fire.crowns.density_map",
            "fire.crowns.cover_map",
        ],
        "a raster sets the size of the field and its cells itself",
    ),
];

/// Values that need another one beside them.
const NEEDS: [(&str, &str); 9] = [
    ("weather.dead_moisture", "weather.file"),
    ("weather.start_h", "weather.file"),
    ("weather.latitude_deg", "weather.file"),
    ("weather.utc_offset_h", "weather.file"),
    ("field.map_tolerance", "field.map"),
    ("field.map_invert", "field.map"),
    (SLOPE, ASPECT),
    (ASPECT, SLOPE),
    ("landscape.image", "landscape.legend"),
];

/// Two values that cannot go together.
struct Contradiction {
    one: FieldPath,
    other: FieldPath,
    reason: &'static str,
    /// False if a change of `one` does not replace `other`.
    is_mutual: bool,
}

fn found_in(written: &Value) -> Vec<Contradiction> {
    let mut found = Vec::new();
    let mut look = |one: &str, other: &str, reason, is_mutual| {
        let other = FieldPath::parse(other);
        let pairs = FieldPath::parse(one).all_in(written).into_iter().map(|one| (other.beside(&one), one));
        // The other value is looked for beside this one: two planners may each have one of the pair.
        let pairs = pairs.filter(|(other, _)| other.leads_to(written));
        found.extend(pairs.map(|(other, one)| Contradiction { one, other, reason, is_mutual }));
    };
    for (table, is_mutual) in [(&EITHER[..], true), (&DECIDED, false)] {
        for (ones, others, reason) in table {
            ones.iter().for_each(|one| others.iter().for_each(|other| look(one, other, *reason, is_mutual)));
        }
    }
    for (one, other, reason) in ALTERNATIVES {
        look(&format!("unimog.*.{one}"), &format!("unimog.*.{other}"), reason, true);
    }
    found
}

/// Removes the values of a file that a change of another value contradicts.
pub(crate) fn drop_overruled(written: &mut Value, changes: &SettingChanges) {
    for Contradiction { one, other, is_mutual, .. } in found_in(written) {
        match (changes.touch(&one), changes.touch(&other)) {
            (true, false) if is_mutual => other.remove_from(written),
            (false, true) => one.remove_from(written),
            _ => {}
        }
    }
}

/// Returns the first contradiction that is written, or value without the one that it needs, with its path.
pub(crate) fn first(written: &Value) -> Option<(FieldPath, Fault)> {
    if let Some(Contradiction { one, other, reason, .. }) = found_in(written).into_iter().next() {
        let fault = Fault::Conflict { one: one.to_string(), other: other.to_string(), reason };
        return Some((one, fault));
    }
    let is_set = |dotted: &str| FieldPath::parse(dotted).leads_to(written);
    let (one, other) = NEEDS.into_iter().find(|(one, other)| is_set(one) && !is_set(other))?;
    Some((FieldPath::parse(one), Fault::Rule { message: format!("`{one}` also needs `{other}`") }))
}
