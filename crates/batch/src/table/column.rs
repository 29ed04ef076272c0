//! What a column is: its name, what it means, in which unit and of which kind it is, and how its value is found.

use std::borrow::Cow;

/// The kind of values that a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Signed, 64 bits, so that a difference of two columns may be negative.
    Count,
    /// Unsigned, 64 bits: numbers of which some are beyond [`i64::MAX`], such as a seed may be.
    LargeCount,
    Real,
    Text,
    Flag,
}

impl Kind {
    /// Returns the kind of a column of whole numbers that are no larger than this.
    pub fn holding_up_to(largest: u64) -> Self {
        if i64::try_from(largest).is_ok() { Self::Count } else { Self::LargeCount }
    }
}

/// The unit of a column's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Names, numbers that name something, and plain counts.
    None,
    /// Bush cells, and in columns of the ground cells of ground.
    Cells,
    Hectares,
    /// From 0 to 1.
    Share,
    Seconds,
    /// Seconds of a burning cell.
    CellSeconds,
    Metres,
    /// Points of a scenario's rules.
    Points,
}

impl Unit {
    /// Returns the symbol that files give the unit; empty of none.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Cells => "cells",
            Self::Hectares => "ha",
            Self::Share => "1",
            Self::Seconds => "s",
            Self::CellSeconds => "cells s",
            Self::Metres => "m",
            Self::Points => "points",
        }
    }
}

/// A column of a table whose rows are found from something, with `value`.
#[derive(Clone, Copy, Debug)]
pub struct Column<F> {
    pub name: &'static str,
    pub words: &'static str,
    pub unit: Unit,
    pub kind: Kind,
    /// True if every row has a value.
    pub is_required: bool,
    /// The name that charts give it; empty of a column that they cannot show.
    pub title: &'static str,
    /// The words for a difference between two batches.
    pub phrase: Option<Phrase>,
    pub value: F,
}

impl<F: Copy> Column<F> {
    pub(super) const fn with_title(self, title: &'static str) -> Self {
        Self { title, ..self }
    }

    pub(super) const fn with_phrase(self, phrase: Phrase) -> Self {
        Self { phrase: Some(phrase), ..self }
    }

    /// Says whether it holds numbers that are measured or counted, not words and not names such as seeds.
    pub fn holds_numbers(&self) -> bool {
        self.kind == Kind::Real || self.kind == Kind::Count && !["seed", "run"].contains(&self.name)
    }

    /// Returns the least and the greatest value that it can have: no share is above one, and only points can be negative.
    pub fn range(&self) -> (f64, f64) {
        match self.unit {
            Unit::Share => (0.0, 1.0),
            Unit::Points => (f64::NEG_INFINITY, f64::INFINITY),
            _ => (0.0, f64::INFINITY),
        }
    }

    /// Returns all that a file says of the column.
    pub fn described(&self) -> FileColumn {
        FileColumn {
            name: Cow::Borrowed(self.name),
            words: Cow::Borrowed(self.words),
            unit: self.unit,
            kind: self.kind,
            is_required: self.is_required,
        }
    }
}

/// A column of a file, which may be that of a swept key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileColumn {
    pub name: Cow<'static, str>,
    pub words: Cow<'static, str>,
    pub unit: Unit,
    pub kind: Kind,
    /// True if every row has a value; else a value may be missing, which is null.
    pub is_required: bool,
}

impl FileColumn {
    /// Returns the column of a key that a batch sweeps.
    pub fn swept(key: &str, kind: Kind) -> Self {
        let words = format!("value of `{key}`").into();
        Self { name: key.to_owned().into(), words, unit: Unit::None, kind, is_required: true }
    }
}

/// Words for a difference of a metric between two batches: `B saves 6.1 more obstacles per run`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phrase {
    /// The verb for what a batch does: `saves`.
    pub verb: &'static str,
    /// The words after the amount of a difference above zero, and of one below.
    pub more: [&'static str; 2],
    /// The factor of the amount.
    pub scale: f64,
}

impl Phrase {
    pub const fn new(verb: &'static str, more: &'static str, less: &'static str) -> Self {
        Self { verb, more: [more, less], scale: 1.0 }
    }

    /// Gives the amount of a rate as runs of a hundred.
    pub const fn in_hundreds(self) -> Self {
        Self { scale: 100.0, ..self }
    }
}
