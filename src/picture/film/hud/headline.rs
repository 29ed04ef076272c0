//! What a sheet without a panel tells in one line above the chart.

use super::moment::Moment;
use super::pen::{Face, Pen};
use super::words;
use crate::fire::BushStateKind;
use crate::picture::film::Layout;
use crate::picture::text::Align;

const CLOCK: Face = Face { size: 1.3, ..Face::TITLE };

/// The clock, and as many of the counts as there is room for; of a comparison both runs'.
pub fn draw(pen: &mut Pen, layout: &Layout, moment: &Moment) {
    let base = layout.chart.top as f32 + pen.length(2.1);
    let mut x = pen.length(1.0);
    pen.write(&words::clock(moment.time), (x, base), Align::Left, CLOCK);
    x += pen.measure(&words::clock(moment.time), CLOCK) + pen.length(1.5);
    let (sign, right) = (pen.length(1.5), layout.width as f32 - pen.length(1.0));
    for kind in [BushStateKind::Burning, BushStateKind::BurnedOut, BushStateKind::Extinguished, BushStateKind::Intact] {
        let counts: Vec<String> = moment.counts.iter().map(|counts| counts.count(kind).to_string()).collect();
        let counts = counts.join(" : ");
        let width = sign + pen.length(0.5) + pen.measure(&counts, Face::STRONG);
        if x + width > right {
            break;
        }
        pen.sign(kind, (x + 0.5 * sign, base - pen.length(0.5)), sign);
        pen.write(&counts, (x + sign + pen.length(0.5), base), Align::Left, Face::STRONG);
        x += width + pen.length(1.2);
    }
}
