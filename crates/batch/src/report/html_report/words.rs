//! The words of a report's charts in every language that charts have: one table for all of them.
//!
//! English names of columns are their titles, in the table of columns itself.

use crate::table::RunColumn;
use wildfire_picture::charts::{Language, Words};

pub const STATES_AT_THE_END: Words = Words::new("Obstacle states at the end", "Zustände der Hindernisse am Ende");
pub const CPU_TIME_BY_PART: Words = Words::new("CPU time of a run by part", "CPU-Zeit eines Laufs nach Teilen");
pub const STATES_OVER_TIME: Words = Words::new("Obstacle states over time", "Zustände der Hindernisse über die Zeit");
/// Of a state of obstacles.
pub const AT_THE_END_OF_A_RUN: Words = Words::new("{} at the end of a run", "{} am Ende eines Laufs");
/// Of a quantity, by a key that is swept.
pub const BY_KEY: Words = Words::new("{}, by {}", "{}, nach {}");

/// Of marks.
pub const ARE_MEANS: Words = Words::new(
    "{} are means, whiskers their 95 % intervals.",
    "{} sind Mittelwerte, Fehlerbalken deren 95-%-Intervalle.",
);
pub const ARE_DIFFERENCES: Words = Words::new(
    "Marks are mean differences paired by seed, whiskers their 95 % intervals.",
    "Marken sind mittlere Differenzen gleicher Seeds, Fehlerbalken deren 95-%-Intervalle.",
);
/// Of a quantity and the best in it.
pub const DIFFERENCE_FROM: Words = Words::new("{}, difference from {}", "{}, Differenz zu {}");
/// Of a difference and the ends of its interval.
pub const WITH_INTERVAL: Words = Words::new("{} ({} to {})", "{} ({} bis {})");
pub const BARS: Words = Words::new("Bars", "Balken");
pub const MARKS: Words = Words::new("Marks", "Marken");
pub const LINES_ARE_MEANS: Words = Words::new(
    "Lines are means, bands the middle 80 % of runs.",
    "Linien sind Mittelwerte, Bänder die mittleren 80 % der Läufe.",
);
pub const COLUMNS_COUNT_RUNS: Words = Words::new(
    "Columns count runs; the highest has its number. Below: median, middle half, middle 90 %.",
    "Säulen zählen Läufe; die höchste trägt ihre Zahl. Darunter: Median, mittlere Hälfte, mittlere 90 %.",
);

/// The bushes that did not burn.
pub const SAVED: Words = Words::new("Saved", "Gerettet");

pub const SHARE_OF_OBSTACLES: Words = Words::new("share of obstacles", "Anteil der Hindernisse");
/// Of an axis.
pub const INTACT_LEFT_OUT: Words = Words::new("{}, intact left out", "{}, ohne unversehrte");
/// Of a panel.
pub const NO_RUN_IS_DONE: Words = Words::new("{} (no run is done)", "{} (kein Lauf ist fertig)");
pub const SIMULATED_SECONDS: Words = Words::new("simulated time (s)", "simulierte Zeit (s)");
pub const NUMBER_OF_RUNS: Words = Words::new("number of runs", "Anzahl der Läufe");
pub const SECONDS: Words = Words::new("time (s)", "Zeit (s)");
pub const MILLISECONDS: Words = Words::new("time (ms)", "Zeit (ms)");
pub const CPU_TIME: Words = Words::new("CPU time (ms)", "CPU-Zeit (ms)");
pub const CELL_SECONDS: Words = Words::new("cells \u{d7} time (s)", "Zellen \u{d7} Zeit (s)");
pub const METRES: Words = Words::new("distance (m)", "Strecke (m)");
pub const HECTARES: Words = Words::new("area (ha)", "Fläche (ha)");
pub const BUSHES_PER_RUN: Words = Words::new("bushes per run", "Büsche pro Lauf");
pub const CELLS: Words = Words::new("cells", "Zellen");
pub const POINTS: Words = Words::new("points", "Punkte");
pub const SHARE: Words = Words::new("share", "Anteil");
pub const NUMBER: Words = Words::new("number", "Anzahl");

/// German names of the columns that charts can show.
const GERMAN_COLUMNS: &[(&str, &str)] = &[
    ("obstacles", "Buschzellen"),
    ("intact", "Unversehrt"),
    ("burning", "Brennend"),
    ("burned_out", "Ausgebrannt"),
    ("extinguished", "Gelöscht"),
    ("intact_ratio", "Anteil unversehrt"),
    ("burned_ratio", "Anteil verbrannt"),
    ("extinguished_ratio", "Anteil gelöscht"),
    ("lit_by_wumpus", "Von Wumpussen entzündet"),
    ("caught_by_spread", "Durch Ausbreitung entzündet"),
    ("truck_stuck_s", "Zeit, in der Fahrzeuge festsaßen"),
    ("wumpus_stuck_s", "Zeit, in der Wumpusse festsaßen"),
    ("lit_by_schedule", "Vom Szenario entzündet"),
    ("ended_s", "Ende des Laufs"),
    ("burning_cell_s", "Brennende Zellen über die Zeit"),
    ("peak_burning", "Höchstzahl gleichzeitig brennender Büsche"),
    ("mean_response_s", "Zeit von der Entzündung bis zum Löschen"),
    ("first_fire_s", "Erster Brand"),
    ("all_out_s", "Ende des letzten Brands"),
    ("wumpus_score", "Punkte der Wumpusse"),
    ("truck_score", "Punkte der Fahrzeuge"),
    ("least_burned", "Unvermeidbar verbrannt"),
    ("regret", "Vermeidbar verbrannt"),
    ("truck_plans", "Anfragen der Fahrzeuge"),
    ("truck_failed_start_blocked", "Gescheiterte Anfragen: Start belegt"),
    ("truck_failed_goal_blocked", "Gescheiterte Anfragen: Ziel belegt"),
    ("truck_failed_disconnected", "Gescheiterte Anfragen: nicht verbunden"),
    ("truck_failed_budget_spent", "Gescheiterte Anfragen: Budget verbraucht"),
    ("truck_failed_timed_out", "Gescheiterte Anfragen: Zeit überschritten"),
    ("truck_failed_crashed", "Gescheiterte Anfragen: abgestürzt"),
    ("truck_failed_bad_answer", "Gescheiterte Anfragen: falsche Antwort"),
    ("truck_lattice_plans", "Pläne der Erreichbarkeitsflut"),
    ("truck_roadmap_samples", "Knoten der Roadmaps"),
    ("truck_roadmap_edges", "Kanten der Roadmaps"),
    ("truck_roadmap_components", "Komponenten der Roadmaps"),
    ("truck_roadmap_expansions", "In Roadmaps expandierte Knoten"),
    ("truck_local_expansions", "In lokalen Suchen expandierte Knoten"),
    ("truck_distance_m", "Gefahrene Strecke der Fahrzeuge"),
    ("truck_driving_s", "Fahrzeit der Fahrzeuge"),
    ("truck_planning_s", "Planungszeit der Fahrzeuge"),
    ("truck_suppressing_s", "Löschzeit der Fahrzeuge"),
    ("truck_standing_s", "Standzeit der Fahrzeuge"),
    ("truck_longest_idle_s", "Längster Stillstand eines Fahrzeugs"),
    ("truck_cusps", "Wechsel der Fahrtrichtung"),
    ("truck_wasted_drives", "Vergebliche Fahrten"),
    ("truck_waiting_s", "Wartezeit der Fahrzeuge"),
    ("truck_deadlocks", "Verklemmungen der Fahrzeuge"),
    ("wumpus_plans", "Anfragen der Wumpusse"),
    ("wumpus_failed_plans", "Gescheiterte Anfragen der Wumpusse"),
    ("wumpus_local_minima", "Lokale Minima der Wumpusse"),
    ("wumpus_expansions", "Von Wumpussen expandierte Knoten"),
    ("wumpus_distance_m", "Gelaufene Strecke der Wumpusse"),
    ("wumpus_walking_s", "Laufzeit der Wumpusse"),
    ("wumpus_planning_s", "Planungszeit der Wumpusse"),
    ("wumpus_standing_s", "Standzeit der Wumpusse"),
    ("wumpus_longest_idle_s", "Längster Stillstand eines Wumpus"),
    ("ground_cells", "Bodenzellen"),
    ("ground_burned", "Verbrannter Boden"),
    ("ground_extinguished", "Gelöschter Boden"),
    ("ground_peak_burning", "Höchstzahl gleichzeitig brennender Bodenzellen"),
    ("spotted", "Entzündungen durch Funkenflug"),
    ("burned_ha", "Verbrannte Fläche"),
    ("reached_edge_s", "Zeit, bis das Feuer den Rand erreichte"),
    ("truck_idle_s", "Leerlauf der Fahrzeuge"),
    ("truck_relocations", "Umsetzfahrten der Fahrzeuge"),
    ("truck_refills", "Tankfüllungen"),
    ("truck_refilling_s", "Füllzeit der Tanks"),
    ("truck_hopeless_drives", "Aussichtslose Fahrten"),
    ("truck_goals", "Ziele der Fahrzeuge"),
    ("truck_flock_ratio", "Anteil benachbarter Ziele"),
    ("policy_asked", "Anfragen an eigene Strategien"),
    ("policy_failed_timed_out", "Gescheiterte Strategie-Anfragen: Zeit überschritten"),
    ("policy_failed_crashed", "Gescheiterte Strategie-Anfragen: abgestürzt"),
    ("policy_failed_bad_answer", "Gescheiterte Strategie-Anfragen: falsche Antwort"),
    ("policy_illegal", "Strategie-Anfragen mit unzulässiger Antwort"),
    ("cpu_sampling_s", "Abtasten"),
    ("cpu_map_generation_s", "Verbinden"),
    ("cpu_roadmap_search_s", "Roadmap-Suche"),
    ("cpu_local_search_s", "Lokale Suche"),
    ("cpu_prm_total_s", "CPU-Zeit des Roadmap-Planers"),
    ("cpu_unimog_total_s", "CPU-Zeit der Fahrzeugplanung"),
    ("cpu_wumpus_s", "Wumpus"),
    ("cpu_clearance_field_s", "Abstandsfeld"),
    ("cpu_reachability_s", "Erreichbarkeit"),
    ("cpu_dispatch_s", "Disposition"),
    ("cpu_custom_start_s", "Eigener Planer: Start"),
    ("cpu_custom_queries_s", "Eigener Planer: Anfragen"),
    ("cpu_policy_s", "Eigene Strategien"),
    ("cpu_terrain_s", "Erzeugen des Felds"),
    ("cpu_run_s", "CPU-Zeit des Laufs"),
    ("wall_run_s", "Echtzeit des Laufs"),
];

/// Returns the name that charts give a column.
pub fn name_of(column: &RunColumn, language: Language) -> &'static str {
    let german = || GERMAN_COLUMNS.iter().find(|(name, _)| *name == column.name).map(|(_, german)| *german);
    match language {
        Language::English => column.title,
        Language::German => german().unwrap_or(column.title),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::RUN_COLUMNS;

    #[test]
    fn every_column_of_numbers_has_one_name_in_every_language() {
        let numbers: Vec<&RunColumn> = RUN_COLUMNS.iter().filter(|column| column.holds_numbers()).collect();
        for language in [Language::English, Language::German] {
            let names: Vec<&str> = numbers.iter().map(|column| name_of(column, language)).collect();
            for (index, name) in names.iter().enumerate() {
                assert!(!name.is_empty(), "{}", numbers[index].name);
                assert!(!names[..index].contains(name), "two columns are called {name}");
            }
        }
        let listed: Vec<&str> = GERMAN_COLUMNS.iter().map(|(name, _)| *name).collect();
        assert_eq!(listed, numbers.iter().map(|column| column.name).collect::<Vec<_>>(), "in the order of the columns");
    }

    #[test]
    fn words_have_the_same_places_to_be_filled_in_every_language() {
        let filled = [AT_THE_END_OF_A_RUN, BY_KEY, ARE_MEANS, DIFFERENCE_FROM, WITH_INTERVAL];
        for Words { english, german } in filled.into_iter().chain([INTACT_LEFT_OUT, NO_RUN_IS_DONE]) {
            assert_eq!(english.matches("{}").count(), german.matches("{}").count(), "{english}");
        }
    }
}
