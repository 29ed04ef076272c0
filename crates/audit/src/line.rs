//! Line that crews build: no sooner than they can walk to it, no more than their rate allows, in one piece on each flank, with
//! bounds that are wider by some cells, as facts name cells and not places.

use super::{Violation, ViolationKind};
use wildfire_base::geometry::DVec2;
use wildfire_base::time::SimTime;
use wildfire_timeline::{CrewRules, GroundEvent, GroundFact, LineRules, Timeline};

/// Cells by which a cell of line may be beside the way of its builder, and the most cells of line on a cell's width of way.
const BESIDE: f64 = 3.0;
const CELLS_A_WIDTH: f64 = 3.0;

/// A flank as it was followed so far.
#[derive(Clone, Copy)]
struct FollowedFlank {
    first: DVec2,
    /// The length up to the first cell, as what burned before it is a gap.
    first_m: f64,
    last: DVec2,
    along_m: f64,
    cells: f64,
}

/// Holds the line of a run against the rules of its crews; returns the first violation.
pub fn audit_line(timeline: &Timeline) -> Result<(), Violation> {
    let setting = &timeline.setting;
    let frame = timeline.setting.frame;
    let mut flanks = Vec::new();
    for &GroundEvent { time, cell, fact } in &timeline.ground {
        let GroundFact::Cleared { flank, along_mm, holds } = fact else { continue };
        let place = frame.centre(cell);
        let number = usize::from(flank);
        let along_m = f64::from(along_mm) / 1000.0;
        // Line that does not hold is a fault where line cannot be lost.
        let rules = setting.line.as_ref().filter(|rules| holds || rules.can_be_lost);
        flanks.resize(flanks.len().max(number + 1), None);
        let built = FollowedFlank { first: place, first_m: along_m, last: place, along_m, cells: 0.0 };
        if !rules.is_some_and(|rules| follow(&mut flanks, number, built, rules, time, frame.cell_m)) {
            return Err(Violation { time, agent: None, place, kind: ViolationKind::WrongLine { cell } });
        }
    }
    Ok(())
}

/// Takes in a finished cell, at which a flank would begin if it had not; returns false if crews cannot have built it by then.
fn follow(
    flanks: &mut [Option<FollowedFlank>],
    number: usize,
    built: FollowedFlank,
    rules: &LineRules,
    time: SimTime,
    cell_m: f64,
) -> bool {
    let FollowedFlank { last: place, along_m, .. } = built;
    let FollowedFlank { first, first_m, last, along_m: before_m, cells } =
        flanks[number].unwrap_or(FollowedFlank { along_m: 0.0, ..built });
    flanks[number] = Some(FollowedFlank { first, first_m, cells: cells + 1.0, ..built });
    let built_m = |flanks: &[Option<FollowedFlank>]| flanks.iter().flatten().map(|flank| flank.along_m).sum::<f64>();
    let beside_m = BESIDE * cell_m;
    // Crews get on while they build: up to the first cell, and along lines before this one, which has two flanks.
    let on_way_m = beside_m + first_m + built_m(&flanks[..number / 2 * 2]);
    let work_m = |crew: &CrewRules| {
        let walk_s = ((first - DVec2::from(crew.start_m)).length() - on_way_m).max(0.0) / crew.walking_mps;
        crew.rate_mps * (time.as_seconds() - SimTime::from_nanos(crew.at_ns).as_seconds() - walk_s).max(0.0)
    };
    // The rate is that of all flanks together.
    built_m(flanks) <= rules.crews.iter().map(work_m).sum::<f64>() + 0.001
        && along_m >= before_m
        && (place - last).length() <= along_m - before_m + 2.0 * beside_m
        && (place - first).length() <= along_m + 2.0 * beside_m
        && cells < CELLS_A_WIDTH * (along_m / cell_m + BESIDE)
}
