//! The scenarios that are part of the program.

/// The built-in scenarios by name, with their text.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("contest", include_str!("../../scenarios/contest.toml")),
    ("contest-1", include_str!("../../scenarios/contest-1.toml")),
    ("report-2024", include_str!("../../scenarios/report-2024.toml")),
    ("coursework-2025", include_str!("../../scenarios/coursework-2025.toml")),
    ("original-2024", include_str!("../../scenarios/original-2024.toml")),
    ("arena", include_str!("../../scenarios/arena.toml")),
    ("dense", include_str!("../../scenarios/dense.toml")),
    ("cautious", include_str!("../../scenarios/cautious.toml")),
    ("wumpus-alone", include_str!("../../scenarios/wumpus-alone.toml")),
    ("local-minima", include_str!("../../scenarios/local-minima.toml")),
    ("unimog-alone", include_str!("../../scenarios/unimog-alone.toml")),
    ("drives", include_str!("../../scenarios/drives.toml")),
    ("fleet", include_str!("../../scenarios/fleet.toml")),
    ("duel", include_str!("../../scenarios/duel.toml")),
    ("brigade", include_str!("../../scenarios/brigade.toml")),
    ("county", include_str!("../../scenarios/county.toml")),
    ("windy", include_str!("../../scenarios/windy.toml")),
    ("hill", include_str!("../../scenarios/hill.toml")),
    ("river", include_str!("../../scenarios/river.toml")),
    ("landscape", include_str!("../../scenarios/landscape.toml")),
    ("initial-attack", include_str!("../../scenarios/initial-attack.toml")),
    ("automaton", include_str!("../../scenarios/automaton.toml")),
    ("line", include_str!("../../scenarios/line.toml")),
    ("smoke", include_str!("../../scenarios/smoke.toml")),
];
