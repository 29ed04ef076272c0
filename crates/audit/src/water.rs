//! Water by the heat of fire: a stop takes at least what the cells that it puts out need, for as long as its pump needs, and
//! none of them is too hot for the pump. Fronts are those of [`SpreadSetting::front`](wildfire_timeline::SpreadSetting::front);
//! the equations of Van Wagner and Taylor, 2022, are computed here in their own units, kcal and seconds.

use std::collections::BTreeMap;

use super::cell_log::{CellLog, ChangeKind, changes_in_order};
use super::{Violation, ViolationKind};
use wildfire_base::geometry::{Cell, ops};
use wildfire_base::time::SimTime;
use wildfire_timeline::{AgentFact, AgentId, Event, Fact, Front, Timeline, WaterEnergy};

/// A part of the water by which sums of needs may be larger than what was taken, for rounding.
const ROUNDING: f64 = 1e-9;

/// Holds the water of all stops against the fires that they put out; returns the first violation.
pub fn audit_water(timeline: &Timeline) -> Result<(), Violation> {
    let setting = &timeline.setting;
    let Some((energy, spread)) = setting.water.as_ref().and_then(|water| water.energy).zip(setting.spread.as_ref())
    else {
        return Ok(());
    };
    let changes = changes_in_order(timeline);
    let log = CellLog::new(setting, &changes);
    let ignition = |cell: Cell, before: SimTime| {
        log.of_cell(cell).iter().rev().filter(|change| change.time < before).find_map(|change| match change.what {
            ChangeKind::Ignited(cause) => Some((cell, change.time, cause)),
            _ => None,
        })
    };
    // By agent, its stops in order of time: beginning, water taken, litres that fires have needed so far.
    let mut stops = BTreeMap::<AgentId, Vec<(SimTime, u32, f64)>>::new();
    for Event { time, fact } in &timeline.events {
        if let &Fact::Agent(id, AgentFact::Suppressing { water_units, .. }) = fact {
            stops.entry(id).or_default().push((*time, water_units, 0.0));
        }
    }
    for change in &changes {
        let ChangeKind::Extinguished { by } = change.what else { continue };
        // The stop under way is the last that began before; one that begins at this instant is the next.
        let stop = stops.get_mut(&by).and_then(|stops| stops.iter_mut().rfind(|(begins, ..)| *begins < change.time));
        let ignited = ignition(change.cell, change.time);
        let front = ignited
            .and_then(|(cell, time, cause)| spread.front(cell, time, cause, |near| Some(ignition(near, time)?.1)));
        // Water without a stop, an ignition or a front is wrong too.
        let is_right = stop.zip(ignited).zip(front).is_some_and(|(((begins, water_units, litres), ignited), front)| {
            *litres += litres_of(front, energy, setting.frame.cell_m);
            let taken_l = f64::from(*water_units) * energy.portion_l;
            let sprayed = SimTime::from_seconds(taken_l / energy.pump_lps);
            // Water is measured out when the stop begins, so only what burned by then has a share.
            ignited.1 <= *begins
                && *litres <= taken_l * (1.0 + ROUNDING)
                // The dwell comes first, and then the pump runs for as long as the water lasts.
                && change.time == *begins + setting.rules.suppression_dwell + sprayed
        });
        if !is_right {
            return Err(change.violation(setting, ViolationKind::TooLittleWater { cell: change.cell }));
        }
    }
    Ok(())
}

/// Computes the litres for a front on the width of a cell; infinite above what the pump gives.
fn litres_of(front: Front, energy: WaterEnergy, cell_m: f64) -> f64 {
    let kcal = front.intensity_kw_m / 4.184;
    // From air of 20 degrees to steam of 100.
    if kcal * energy.jet_m > energy.pump_lps * 620.0 * (1.0 + ROUNDING) {
        return f64::INFINITY;
    }
    let thirds = ops::pow(kcal, 2.0 / 3.0);
    let water_mm = 3.84e-4 * thirds + 0.226 * front.heat_kj_m2 / 18_608.0;
    energy.applied * cell_m * 0.5 * 0.0792 * thirds * water_mm
}
