//! Where the parts of a chart lie, in rows of its canvas.

use super::super::super::Layout;

/// Rows of the chart: the first, and how many.
pub type Rows = (u32, u32);

/// Where one run's counts lie.
#[derive(Clone, Debug)]
pub struct Strip {
    /// For marks of events; left out where there is too little room.
    pub lanes: Option<Rows>,
    pub area: Rows,
}

/// Where the parts of a chart lie.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Height of ordinary text.
    pub text: u32,
    /// The columns of the canvas between the start and the end of time: the first, and how many.
    pub columns: (u32, u32),
    pub strips: Vec<Strip>,
    /// For the difference of two runs; left out where there is too little room.
    pub difference: Option<Rows>,
    /// From where to where the cursor reaches.
    pub cursor: (u32, u32),
    /// The base line of the words under the time axis.
    pub axis_base: u32,
}

impl Plan {
    pub fn new(layout: &Layout, runs: usize) -> Self {
        let text = layout.text;
        let part = |tenths: u32| tenths * text / 10;
        // Where there is no panel, a line above the strips tells the most important of it.
        let header = if layout.panel.is_none() { part(22) } else { 0 };
        let (top, bottom) = (header + part(9), layout.chart.height - part(24));
        let room = bottom.saturating_sub(top);
        let (strips_room, difference) = if runs > 1 && room > part(150) {
            let height = 3 * room / 10;
            (room - height - part(22), Some((bottom - height, height)))
        } else {
            (room, None)
        };
        let (each, gap) = (strips_room / runs as u32, part(5));
        let lanes_height = if runs == 1 { part(36) } else { part(24) };
        let strips = (0..runs as u32).map(|run_index| {
            let (top, height) =
                (top + run_index * each, if run_index + 1 == runs as u32 { each } else { each - gap.min(each) });
            if height >= lanes_height + part(30) {
                let area = (top + lanes_height, height - lanes_height);
                Strip { lanes: Some((top, lanes_height - part(6))), area }
            } else {
                Strip { lanes: None, area: (top, height) }
            }
        });
        Self {
            text,
            columns: (layout.timeline.left - layout.chart.left, layout.timeline.width),
            strips: strips.collect(),
            difference,
            cursor: (header + part(2), bottom + part(3)),
            axis_base: bottom + part(17),
        }
    }

    pub fn length(&self, texts: f32) -> f32 {
        (texts * self.text as f32).round()
    }
}
