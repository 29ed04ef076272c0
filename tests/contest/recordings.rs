//! Recordings of every format are read, and say what the program computes anew.

use wildfire::scenario;
use wildfire::sim;
use wildfire::timeline::{AgentFact, Event, Fact, Outcome, RunIndex, file};

/// A kept recording of seed 1: its format, the scenario with what was changed, and whether it holds searches.
struct Kept {
    format: u8,
    scenario: &'static str,
    changes: &'static [&'static str],
    searches: bool,
}

const KEPT: [Kept; 8] = [
    Kept { format: 1, scenario: "smoke", changes: &["duration_s=120"], searches: false },
    Kept { format: 2, scenario: "local-minima", changes: &["duration_s=300"], searches: false },
    Kept { format: 3, scenario: "fleet", changes: &["duration_s=300", "unimog.cost=length"], searches: false },
    Kept { format: 4, scenario: "smoke", changes: &["duration_s=120", "unimog.prm_rs.samples=40"], searches: true },
    Kept { format: 5, scenario: "fleet", changes: &["duration_s=300", "unimog.cost=length"], searches: false },
    Kept { format: 6, scenario: "fleet", changes: &["duration_s=300", "unimog.cost=length"], searches: false },
    Kept { format: 7, scenario: "windy", changes: &["duration_s=300"], searches: false },
    Kept {
        format: 8,
        scenario: "fleet",
        changes: &["duration_s=300", "unimog.cost=length", "dispatch.policy=auction", "dispatch.idle=regions"],
        searches: false,
    },
];

/// The facts without what found the plans, which formats up to 4 do not say.
fn facts(events: &[Event]) -> Vec<Event> {
    let mut events = events.to_vec();
    for event in &mut events {
        if let Fact::Agent(_, AgentFact::Planned { found_by, .. }) = &mut event.fact {
            *found_by = None;
        }
    }
    events
}

#[test]
fn recordings_of_every_format_say_what_the_program_computes_anew() {
    for Kept { format, scenario, changes, searches } in KEPT {
        let path = format!("{}/tests/data/recordings/format-{format}.wildfire", env!("CARGO_MANIFEST_DIR"));
        let bytes = std::fs::read(&path).expect("it is kept with the tests");
        assert_eq!(bytes[8..10], [format, 0], "{path}");
        let recorded = file::decode(&bytes).expect("every format is read");
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let scenario = scenario::load(scenario, &changes).expect("it is built in");
        let run = if searches { sim::run_recording_searches } else { sim::run };
        let anew = run(&scenario, recorded.setting.seed).expect("it takes place").timeline;
        let mut expected = RunIndex::new(&anew).outcome().clone();
        if recorded.setting.rules != anew.setting.rules {
            // Formats that do not say how long bushes burn leave open what could have been saved.
            expected.least_burned = None;
            for agent in &mut expected.agents {
                agent.hopeless_drives = 0;
            }
        }
        assert_eq!(Outcome::new(&recorded), expected, "format {format}");
        assert!(facts(&recorded.events) == facts(&anew.events), "the facts of format {format} are others");
        assert!(format < 5 || recorded.events == anew.events, "format 5 says what found each plan");
    }
}
