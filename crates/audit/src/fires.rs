//! The fires of a run: only what can burn catches fire, only what burns goes out, and fire keeps to its rules.

use std::collections::{BTreeMap, BTreeSet};

use super::tolerance::SAME_POSE;
use super::{Violation, ViolationKind};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::FireRules;
use wildfire_timeline::{Cause, Event, Fact, FireFact, Setting, Timeline};

/// Looks at cells around fires that spread which one run may take.
const MAX_LOOKS: u64 = 10_000_000_000;

/// The state of a bush, as this check follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bush {
    Intact,
    Burning { since: SimTime, spreads: bool },
    BurnedOut,
    Extinguished { at: SimTime },
}

/// Follows the fires of a run, fact by fact, to the first that breaks a rule.
///
/// Where a recording does not hold the rules of fire, only what burns and what does not is checked.
pub fn audit_fires(timeline: &Timeline) -> Result<(), Violation> {
    let mut fires = FollowedFires::new(&timeline.setting);
    for event in &timeline.events {
        fires.pass(event.time)?;
        fires.check_pieces(event.time)?;
        fires.record(event)?;
    }
    fires.check_pieces(timeline.end_time() + SimTime::from_nanos(1))?;
    // What is due exactly at the end happens.
    fires.pass(timeline.end_time() + SimTime::from_nanos(1))
}

struct FollowedFires<'a> {
    setting: &'a Setting,
    rules: Option<FireRules>,
    /// In the order of the setting's bushes.
    bushes: Vec<Bush>,
    /// When, which bushes spread or burn out by themselves if they burn still.
    due: BTreeSet<(SimTime, usize)>,
    looks: u64,
    /// The bushes of each piece, where fire takes whole pieces.
    pieces: BTreeMap<u32, Vec<usize>>,
    /// The pieces that changed at the time of the last fact of fire.
    changed: BTreeSet<u32>,
    changed_at: SimTime,
}

impl<'a> FollowedFires<'a> {
    fn new(setting: &'a Setting) -> Self {
        let bushes = vec![Bush::Intact; setting.bushes.len()];
        let mut pieces: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (bush, &piece) in setting.pieces.iter().enumerate() {
            pieces.entry(piece).or_default().push(bush);
        }
        let due = BTreeSet::new();
        let changed = BTreeSet::new();
        Self { setting, rules: setting.rules.fire, bushes, due, looks: 0, pieces, changed, changed_at: SimTime::ZERO }
    }

    fn record(&mut self, event: &Event) -> Result<(), Violation> {
        let Fact::Fire(fact) = event.fact else { return Ok(()) };
        let cell = fact.cell();
        let place = self.setting.frame.centre(cell);
        let violation = |kind| Violation { time: event.time, agent: event.fact.agent(), place, kind };
        let index = self.setting.bush_index(cell).ok_or_else(|| violation(ViolationKind::CannotBurn { cell }))?;
        let change = match (fact, self.bushes[index]) {
            (FireFact::Ignited { cause, .. }, _) => self.caught(index, cause, event.time),
            (_, Bush::Intact | Bush::BurnedOut | Bush::Extinguished { .. }) => Err(ViolationKind::NotBurning { cell }),
            (FireFact::Extinguished { .. }, _) => Ok(Bush::Extinguished { at: event.time }),
            (_, Bush::Burning { since, .. }) => self.burned_out(cell, since, event.time),
        };
        self.bushes[index] = change.map_err(violation)?;
        // The rest of a piece follows in the same instant, so `check_pieces` looks when that is over.
        self.changed.extend(self.setting.pieces.get(index));
        self.changed_at = event.time;
        Ok(())
    }

    /// Before a later time all bushes of a piece are in one state again.
    fn check_pieces(&mut self, until: SimTime) -> Result<(), Violation> {
        if until <= self.changed_at {
            return Ok(());
        }
        for piece in std::mem::take(&mut self.changed) {
            let [first, rest @ ..] = self.pieces[&piece].as_slice() else { continue };
            let state = std::mem::discriminant(&self.bushes[*first]);
            if let Some(&other) = rest.iter().find(|&&bush| std::mem::discriminant(&self.bushes[bush]) != state) {
                let cell = self.setting.bushes[other];
                let place = self.setting.frame.centre(cell);
                let kind = ViolationKind::TornPiece { cell };
                return Err(Violation { time: self.changed_at, agent: None, place, kind });
            }
        }
        Ok(())
    }

    fn caught(&mut self, index: usize, cause: Cause, time: SimTime) -> Result<Bush, ViolationKind> {
        let cell = self.setting.bushes[index];
        let bush = self.bushes[index];
        if !self.can_burn(bush) {
            return Err(ViolationKind::CannotBurn { cell });
        }
        if let Cause::Spread(from) = cause {
            self.check_spread(cell, from, time)?;
        }
        let Some(rules) = self.rules else { return Ok(Bush::Burning { since: time, spreads: false }) };
        let is_source = !matches!(cause, Cause::Spread(_));
        let spreads = if is_source { rules.sources_spread } else { rules.caught_spreads };
        self.due.extend(spreads.then(|| (time + rules.spread_delay, index)));
        self.due.extend(rules.burn_out.map(|burn_out| (time + burn_out, index)));
        Ok(Bush::Burning { since: time, spreads })
    }

    fn can_burn(&self, bush: Bush) -> bool {
        bush == Bush::Intact || self.setting.rules.reignition && matches!(bush, Bush::Extinguished { .. })
    }

    fn check_spread(&self, cell: Cell, from: Cell, time: SimTime) -> Result<(), ViolationKind> {
        let source = self.setting.bush_index(from).map(|index| self.bushes[index]);
        let Some(Bush::Burning { since, spreads }) = source else { return Err(ViolationKind::NoSource { cell, from }) };
        let Some(rules) = self.rules else { return Ok(()) };
        if !spreads || since + rules.spread_delay != time {
            return Err(ViolationKind::NoSource { cell, from });
        }
        // Fire that comes to a bush of a piece takes all of it.
        let piece = self.setting.piece(cell).and_then(|piece| self.pieces.get(&piece));
        let cells = piece.into_iter().flatten().map(|&bush| self.setting.bushes[bush]);
        let metres = cells.map(|other| self.metres(other, from)).fold(self.metres(cell, from), f64::min);
        let radius_m = rules.spread_radius_m;
        let is_near = metres <= radius_m + SAME_POSE;
        if is_near { Ok(()) } else { Err(ViolationKind::TooFarToSpread { cell, from, metres, radius_m }) }
    }

    fn burned_out(&self, cell: Cell, since: SimTime, time: SimTime) -> Result<Bush, ViolationKind> {
        let due = self.rules.map(|rules| rules.burn_out.map(|burn_out| since + burn_out));
        match due {
            Some(due) if due != Some(time) => Err(ViolationKind::WrongBurnOut { cell, due }),
            _ => Ok(Bush::BurnedOut),
        }
    }

    /// All that was due before `until` has happened.
    fn pass(&mut self, until: SimTime) -> Result<(), Violation> {
        while let Some(&(due, index)) = self.due.first().filter(|(due, _)| *due < until) {
            self.due.pop_first();
            self.check_done(due, index)?;
        }
        Ok(())
    }

    fn check_done(&mut self, due: SimTime, index: usize) -> Result<(), Violation> {
        let (Bush::Burning { since, spreads }, Some(rules)) = (self.bushes[index], self.rules) else { return Ok(()) };
        let from = self.setting.bushes[index];
        let frame = self.setting.frame;
        let violation = |cell, kind| Err(Violation { time: due, agent: None, place: frame.centre(cell), kind });
        if rules.burn_out.is_some_and(|burn_out| since + burn_out == due) {
            return violation(from, ViolationKind::WrongBurnOut { cell: from, due: Some(due) });
        }
        if !spreads || since + rules.spread_delay != due {
            return Ok(());
        }
        let reach = self.cells_across(rules.spread_radius_m);
        // A forged radius could make every fire look at the whole field.
        self.looks += u64::from(reach) * u64::from(reach);
        if self.looks > MAX_LOOKS {
            return violation(from, ViolationKind::Endless);
        }
        let mut around = self.cells_around(from, reach.into());
        // At the very edge of the radius rounding decides, so that neither answer is a violation.
        let spared = around
            .find(|&cell| self.metres(cell, from) <= rules.spread_radius_m - SAME_POSE && self.is_spared(cell, due));
        spared.map_or(Ok(()), |cell| violation(cell, ViolationKind::SparedBySpread { cell, from }))
    }

    /// Returns how many cells a radius spans, at most as many as the field has along a side.
    fn cells_across(&self, radius_m: f64) -> u16 {
        let longest = self.setting.frame.cols.max(self.setting.frame.rows);
        (radius_m / self.setting.frame.cell_m).min(longest.into()) as u16
    }

    fn cells_around(&self, from: Cell, reach: i32) -> impl Iterator<Item = Cell> {
        let offsets = (-reach..=reach).flat_map(move |rows| (-reach..=reach).map(move |cols| (cols, rows)));
        offsets.filter_map(move |(cols, rows)| self.setting.frame.offset(from, cols, rows))
    }

    /// Returns true if a cell is a bush that could have caught fire at a time and did not.
    fn is_spared(&self, cell: Cell, time: SimTime) -> bool {
        self.setting.bush_index(cell).is_some_and(|index| match self.bushes[index] {
            // It may still have burned when fire came to it at that instant.
            Bush::Extinguished { at } if at >= time => false,
            bush => self.can_burn(bush),
        })
    }

    fn metres(&self, one: Cell, other: Cell) -> f64 {
        (self.setting.frame.centre(one) - self.setting.frame.centre(other)).length()
    }
}
