//! Line that crews build: no sooner than they can walk to it, no more than their rate allows, in one piece on each flank, with
//! bounds that are wider by some cells, as facts name cells and not places.

use super::{Violation, ViolationKind};
use wildfire_base::geometry::DVec2;
use wildfire_base::time::SimTime;
use wildfire_timeline::{CrewRules, GroundEvent, GroundFact, LineRules, Timeline};

/// Cells by which a cell of line may be beside the way of its builder, and the most cells of line on a cell's width of way.
const BESIDE: f64 = 3.0;
const CELLS_A_WIDTH: f64 = 3.0;

/// A flank as it was followed so far: its first and last cell, its length and the number of its cells.
type Flank = (DVec2, DVec2, f64, f64);

/// Holds the line of a run against the rules of its crews; returns the first violation.
pub fn audit_line(timeline: &Timeline) -> Result<(), Violation> {
    let (setting, frame) = (&timeline.setting, timeline.setting.frame);
    let mut flanks: [Option<Flank>; 2] = [None; 2];
    for &GroundEvent { time, cell, fact } in &timeline.ground {
        let GroundFact::Cleared { flank, along_mm, holds } = fact else { continue };
        let (place, along_m) = (frame.centre(cell), f64::from(along_mm) / 1000.0);
        let rules = setting.line.as_ref().filter(|rules| holds || rules.can_be_lost);
        let flank = flanks.get_mut(usize::from(flank)).zip(rules);
        if !flank.is_some_and(|(flank, rules)| follow(flank, rules, time, place, along_m, frame.cell_m)) {
            return Err(Violation { time, agent: None, place, kind: ViolationKind::WrongLine { cell } });
        }
    }
    Ok(())
}

/// Takes in a finished cell; returns false if crews cannot have built it by then.
fn follow(
    flank: &mut Option<Flank>,
    rules: &LineRules,
    time: SimTime,
    place: DVec2,
    along_m: f64,
    cell_m: f64,
) -> bool {
    let (first, last, before_m, cells) = flank.unwrap_or((place, place, 0.0, 0.0));
    let beside_m = BESIDE * cell_m;
    *flank = Some((first, place, along_m, cells + 1.0));
    let work_m = |crew: &CrewRules| {
        let walk_s = ((first - DVec2::from(crew.start_m)).length() - beside_m).max(0.0) / crew.walking_mps;
        crew.rate_mps * (time.as_seconds() - SimTime::from_nanos(crew.at_ns).as_seconds() - walk_s).max(0.0)
    };
    // Each flank gets half of the rate.
    along_m <= 0.5 * rules.crews.iter().map(work_m).sum::<f64>() + 0.001
        && along_m >= before_m
        && (place - last).length() <= along_m - before_m + 2.0 * beside_m
        && (place - first).length() <= along_m + 2.0 * beside_m
        && cells < CELLS_A_WIDTH * (along_m / cell_m + BESIDE)
}
