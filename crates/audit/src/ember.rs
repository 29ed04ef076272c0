//! Fires by embers: each flight is drawn again.
//!
//! What a cell throws when it catches fire is a hash of the run's seed, the cell and how often it has caught fire, with the
//! power of the front that came to it: so each cell's embers can be drawn again by themselves. What they set on fire must
//! have caught fire then, if it could burn, and nothing else may have caught fire from an ember.

use std::collections::BTreeSet;

use super::cell_log::{CellLog, Change, ChangeKind};
use super::violation::first_violation;
use super::{Violation, ViolationKind};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::embers::{EmberSource, Embers};
use wildfire_fire::models::RothermelRules;
use wildfire_fire::surface::{FuelBed, twenty_foot_wind, unsheltered_adjustment};
use wildfire_fire::{Landscape, Weather};
use wildfire_timeline::{Cause, Setting};

/// An ember that sets a cell on fire, if that can burn then: the time, and the indices of the cell and of its source.
type Spark = (SimTime, usize, usize);

/// Holds all fires by embers, and all that should have been, against the draws; returns the first violation in time.
pub fn audit_embers(
    setting: &Setting,
    landscape: &Landscape,
    weather: &Weather,
    rules: &RothermelRules,
    log: &CellLog<'_>,
    end: SimTime,
) -> Result<(), Violation> {
    let Some(embers) = rules.embers else { return Ok(()) };
    let frame = setting.frame;
    let mut sparks = BTreeSet::<Spark>::new();
    // All sparks of the run are computed first: an ember may land long after its source is out.
    for changes in log.cells() {
        let ignitions = changes.iter().filter_map(|change| match change.what {
            ChangeKind::Ignited(cause) => Some((change, cause)),
            _ => None,
        });
        // Episodes count from 1, and the embers of each are other draws.
        for ((change, cause), episode) in ignitions.zip(1..) {
            let source = ember_source((landscape, weather, rules), change, cause, episode);
            sparks.extend(source.iter().flat_map(|source| thrown(&embers, source, landscape, weather)));
        }
    }
    let spotted = log.cells().flatten().filter_map(|change| match change.what {
        ChangeKind::Ignited(Cause::Spotted(from)) => Some((change, from)),
        _ => None,
    });
    let unexplained =
        spotted.filter(|&(change, from)| !sparks.contains(&(change.time, frame.index(change.cell), frame.index(from))));
    let unexplained = unexplained
        .map(|(change, from)| Err(change.violation(setting, ViolationKind::NoSource { cell: change.cell, from })));
    // Sparks are in order of time.
    let spared = sparks.iter().take_while(|&&(time, ..)| time < end).filter_map(|&(time, cell, from)| {
        let [cell, from]: [Cell; 2] = [cell, from].map(|index| frame.cell(index));
        let kind = ViolationKind::SparedBySpread { cell, from };
        let is_spared = log.is_spared(cell, time);
        is_spared.then(|| Err(Violation { time, agent: None, place: frame.centre(cell), kind }))
    });
    first_violation(unexplained.chain(spared))
}

/// Returns a cell as it throws embers when it catches fire; `None` of one without fuel. The front is that of the way from
/// its parent, or of the head where it was lit or caught an ember.
fn ember_source(
    (landscape, weather, rules): (&Landscape, &Weather, &RothermelRules),
    change: &Change,
    cause: Cause,
    episode: u32,
) -> Option<EmberSource> {
    let &Change { time, cell, .. } = change;
    let model = landscape.burning_model(cell)?;
    let interval = weather.at_cell(time, landscape.frame.index(cell));
    let bed = FuelBed::new(model, &interval.moisture, rules.options.curing);
    let midflame = twenty_foot_wind(1.0) * unsheltered_adjustment(model.depth_ft) * interval.wind_mps;
    let fire = bed.behavior(midflame, landscape.gradient(cell), &rules.options);
    let frame = &landscape.frame;
    let rate_mps = match cause {
        Cause::Spread(from) => fire.front_normal_rate_mps(frame.centre(cell) - frame.centre(from)),
        Cause::Spotted(_) | Cause::Agent(_) | Cause::Scheduled => fire.rate_mps,
    };
    let intensity_kw_m = fire.intensity_kw_m(rate_mps);
    let heat_kj_m2 = fire.heat_kj_m2();
    Some(EmberSource { cell, episode, time, intensity_kw_m, heat_kj_m2 })
}

fn thrown(embers: &Embers, source: &EmberSource, landscape: &Landscape, weather: &Weather) -> Vec<Spark> {
    let frame = &landscape.frame;
    let landings = embers.landings(source, landscape, weather).into_iter();
    let from = frame.index(source.cell);
    landings.filter_map(|landing| Some((landing.ignites?, frame.index(landing.cell), from))).collect()
}
