//! Charts: bars, curves, distributions, box plots and differences, each with its uncertainty.
//!
//! A chart becomes a [`Drawing`], a list of marks, which is written as SVG, PDF and PGF or painted as a picture, with the
//! same geometry in all formats. Series differ in colour and also in hatching, dashes or marks, so that charts are readable
//! in grey print; the colours are those of Okabe and Ito ("Color Universal Design", 2008), chosen for the colour-blind.
//! Data that do not fit into one pair of axes are shown as small multiples of one scale, on as many sheets as needed.

mod bars;
mod boxes;
mod curves;
mod drawing;
mod forest;
mod paper;
mod sheet;
mod strips;
mod style;

pub use bars::{BarChart, BarPanel, BarSeries};
pub use boxes::{BoxChart, BoxPanel, BoxSeries};
pub use curves::{Curve, CurveChart, CurvePanel, Spread};
pub use drawing::Drawing;
pub use forest::{ForestChart, ForestRow};
pub use paper::PaperSize;
pub use sheet::SCREEN_WIDTH;
pub use strips::{Strip, StripChart, StripPanel};
pub use style::{STYLES, Style};

/// The words around a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Titles {
    pub title: String,
    /// One line on how to read the chart.
    pub note: String,
    /// Names of the axes, with units.
    pub x: String,
    pub y: String,
}

/// A value and the interval about it, in the units of its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    /// `None` where it is not known.
    pub interval: Option<(f64, f64)>,
}

impl Estimate {
    /// The least and the greatest value that it shows.
    fn range(&self) -> (f64, f64) {
        let (low, high) = self.interval.unwrap_or((self.value, self.value));
        (low.min(self.value), high.max(self.value))
    }
}

/// A value that a chart shows.
#[derive(Clone, Debug, PartialEq)]
pub struct ChartRow<'a> {
    pub panel: &'a str,
    pub series: &'a str,
    /// The name of a bar's group, or the number that a point of a curve stands at; nothing in distributions.
    pub x: String,
    pub value: f64,
    pub interval: Option<(f64, f64)>,
}
