//! The definition of a column: its name, meaning, unit and kind, and how its value is computed.

use std::borrow::Cow;
use std::cmp::Ordering;

/// The kind of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Signed integers of 64 bits, so that a difference of two columns may be negative.
    Count,
    /// Unsigned integers of 64 bits, for numbers beyond [`i64::MAX`] such as seeds.
    LargeCount,
    Real,
    Text,
    Flag,
}

impl Kind {
    /// Returns the kind of a column of integers up to this number.
    pub fn holding_up_to(largest: u64) -> Self {
        if i64::try_from(largest).is_ok() { Self::Count } else { Self::LargeCount }
    }
}

/// The unit of a column's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Names, identifying numbers, and plain counts.
    None,
    /// Bush cells, and cells of ground in columns of the ground.
    Cells,
    Hectares,
    /// Shares from 0 to 1.
    Share,
    Seconds,
    /// Seconds of planning; charts show them in milliseconds.
    CpuSeconds,
    /// Seconds of real time; charts show them in milliseconds too.
    WallSeconds,
    /// Cell-seconds: burning times in seconds, summed over cells.
    CellSeconds,
    Metres,
    /// Points under a scenario's rules.
    Points,
}

impl Unit {
    /// Returns the unit's symbol in files; empty if there is none.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Cells => "cells",
            Self::Hectares => "ha",
            Self::Share => "1",
            Self::Seconds | Self::CpuSeconds | Self::WallSeconds => "s",
            Self::CellSeconds => "cells s",
            Self::Metres => "m",
            Self::Points => "points",
        }
    }

    /// Returns the title of an axis with such numbers, with the unit in which charts show them.
    pub fn axis(self) -> &'static str {
        match self {
            Self::None => "number",
            Self::Cells => "cells",
            Self::Hectares => "area (ha)",
            Self::Share => "share",
            Self::Seconds => "time (s)",
            Self::CpuSeconds => "CPU time (ms)",
            Self::WallSeconds => "time (ms)",
            Self::CellSeconds => "cells \u{d7} time (s)",
            Self::Metres => "distance (m)",
            Self::Points => "points",
        }
    }

    /// Returns the factor from the numbers of files to those of charts.
    pub fn chart_factor(self) -> f64 {
        if let Self::CpuSeconds | Self::WallSeconds = self { 1e3 } else { 1.0 }
    }
}

/// A column of a table whose values are computed from something by `value`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column<F> {
    pub name: &'static str,
    pub description: &'static str,
    pub unit: Unit,
    pub kind: Kind,
    /// True if every row has a value.
    pub is_required: bool,
    /// The title in charts; empty for a column that they cannot show.
    pub title: &'static str,
    /// The side of the better values, from the trucks' point of view; `None` if it has none.
    pub better: Option<Better>,
    /// The words for a difference between two batches.
    pub phrase: Option<Phrase>,
    /// The words for the best variant, for columns in which reports compare variants.
    pub aim: Option<Aim>,
    pub value: F,
}

impl Column<()> {
    /// A column that the program does not define.
    pub const UNKNOWN: Self = Self {
        name: "",
        description: "",
        unit: Unit::None,
        kind: Kind::Real,
        is_required: false,
        title: "",
        better: None,
        phrase: None,
        aim: None,
        value: (),
    };
}

impl<F: Copy> Column<F> {
    pub(crate) const fn title(self, title: &'static str) -> Self {
        Self { title, ..self }
    }

    pub(crate) const fn better(self, better: Better) -> Self {
        Self { better: Some(better), ..self }
    }

    /// `more` and `less` follow the amount of a difference above zero, and of one below.
    pub(crate) const fn phrase(self, subject: &'static str, more: &'static str, less: &'static str) -> Self {
        Self { phrase: Some(Phrase { subject, more: [more, less], scale: 1.0 }), ..self }
    }

    /// Multiplies the amounts in the phrase by this.
    pub(crate) const fn scaled_by(self, scale: f64) -> Self {
        match self.phrase {
            Some(phrase) => Self { phrase: Some(Phrase { scale, ..phrase }), ..self },
            None => self,
        }
    }

    pub(crate) const fn aim(self, best: &'static str, equal: [&'static str; 2], than: &'static str) -> Self {
        Self { aim: Some(Aim { best, equal, than }), ..self }
    }

    /// Returns the column without the computation of its value.
    pub const fn without_value(&self) -> Column<()> {
        let Self { name, description, unit, kind, is_required, title, better, phrase, aim, .. } = *self;
        Column { name, description, unit, kind, is_required, title, better, phrase, aim, value: () }
    }

    /// Returns whether it holds measured or counted numbers, not words and not names such as seeds.
    pub fn holds_numbers(&self) -> bool {
        self.kind == Kind::Real || self.kind == Kind::Count && !["seed", "run"].contains(&self.name)
    }

    /// Returns the least and the greatest possible value: no share is above one, and only points can be negative.
    pub fn range(&self) -> (f64, f64) {
        match self.unit {
            Unit::Share => (0.0, 1.0),
            Unit::Points => (f64::NEG_INFINITY, f64::INFINITY),
            _ => (0.0, f64::INFINITY),
        }
    }

    /// Returns everything that files contain about the column.
    pub fn described(&self) -> FileColumn {
        FileColumn {
            name: Cow::Borrowed(self.name),
            description: Cow::Borrowed(self.description),
            unit: self.unit,
            kind: self.kind,
            is_required: self.is_required,
        }
    }
}

/// A column of a file, possibly of a swept key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileColumn {
    pub name: Cow<'static, str>,
    pub description: Cow<'static, str>,
    pub unit: Unit,
    pub kind: Kind,
    /// True if every row has a value; otherwise a value may be missing, which is null.
    pub is_required: bool,
}

impl FileColumn {
    /// Returns the column of a swept key.
    pub fn swept(key: &str, kind: Kind) -> Self {
        let description = format!("value of `{key}`").into();
        Self { name: key.to_owned().into(), description, unit: Unit::None, kind, is_required: true }
    }
}

/// Words for a difference of a metric between two batches: `B saves 6.1 more bushes per run`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phrase {
    /// The words before the amount, with `$` for the letter of the side: `$ saves`.
    pub subject: &'static str,
    /// The words after the amount of a positive and of a negative difference.
    pub more: [&'static str; 2],
    /// The factor of the amount.
    pub scale: f64,
}

/// The side of a metric's better values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    Higher,
    Lower,
}

wildfire_base::names! { Better { Higher: "higher", Lower: "lower" } }

impl Better {
    /// Orders numbers, better first.
    pub fn best_first(self, one: f64, other: f64) -> Ordering {
        match self {
            Self::Higher => other.total_cmp(&one),
            Self::Lower => one.total_cmp(&other),
        }
    }
}

/// The words for the best of some variants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// The achievement of the best: `saved the most bushes`.
    pub best: &'static str,
    /// The achievement of equals, before and after the amount.
    pub equal: [&'static str; 2],
    /// The words after the difference of the best from another: `points more`.
    pub than: &'static str,
}
