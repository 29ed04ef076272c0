//! Ranges of settings: what a scenario may say is decided beside the code that the settings are for, and a scenario asks.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::ops::RangeInclusive;

use schemars::JsonSchema;

pub use schemars::Schema;

use crate::geometry::FieldFrame;

/// A value of a table of settings that is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutOfRange {
    /// The setting's path in the table, such as `limits.braking_mps2`.
    pub name: String,
    pub found: String,
    pub expected: String,
}

impl OutOfRange {
    pub fn new(name: &str, found: f64, expected: String) -> Self {
        Self { name: name.to_owned(), found: number_text(found), expected }
    }

    fn within(self, table: impl Display) -> Self {
        Self { name: format!("{table}.{}", self.name), ..self }
    }
}

/// A table of settings that a scenario may hold, or a list of them; [`ranges!`](crate::ranges!) makes it one.
pub trait SettingsTable {
    /// Checks every number, and the tables within; some are bounded by other settings, or by the size of the field that
    /// they are used on.
    ///
    /// # Errors
    /// Returns the first setting that is out of its range.
    fn check(&self, frame: &FieldFrame) -> Result<(), OutOfRange>;

    /// Writes the ranges into the schema of a file that may hold such a table.
    fn write_ranges(schema: &mut Schema)
    where
        Self: Sized;
}

impl<T: SettingsTable> SettingsTable for Option<T> {
    fn check(&self, frame: &FieldFrame) -> Result<(), OutOfRange> {
        self.as_ref().map_or(Ok(()), |settings| settings.check(frame))
    }

    fn write_ranges(schema: &mut Schema) {
        T::write_ranges(schema);
    }
}

impl<T: SettingsTable> SettingsTable for Vec<T> {
    fn check(&self, frame: &FieldFrame) -> Result<(), OutOfRange> {
        let mut entries = self.iter().enumerate();
        entries.try_for_each(|(number, entry)| entry.check(frame).map_err(|wrong| wrong.within(number)))
    }

    fn write_ranges(schema: &mut Schema) {
        T::write_ranges(schema);
    }
}

impl<K: Display, T: SettingsTable> SettingsTable for BTreeMap<K, T> {
    fn check(&self, frame: &FieldFrame) -> Result<(), OutOfRange> {
        let mut tables = self.iter();
        tables
            .try_for_each(|(name, table)| table.check(frame).map_err(|wrong| wrong.within(format_args!("\"{name}\""))))
    }

    fn write_ranges(schema: &mut Schema) {
        T::write_ranges(schema);
    }
}

/// A number, or a setting that may be left out.
pub trait Number: Copy {
    fn number(self) -> Option<f64>;
}

impl Number for Option<f64> {
    fn number(self) -> Option<f64> {
        self
    }
}

impl Number for Option<u64> {
    fn number(self) -> Option<f64> {
        self.map(|count| count as f64)
    }
}

macro_rules! numbers {
    ($($Number:ty)+) => {
        $(impl Number for $Number {
            fn number(self) -> Option<f64> {
                Some(self.into())
            }
        })+
    };
}

numbers! { f64 u32 u16 }

/// Gives the numbers of a table of settings their ranges, for its check and for the schema, and names the tables within.
/// What depends on other settings or on the field is checked after that, by what stands behind `and`.
///
/// ```
/// # use wildfire_base::ranges::SettingsTable;
/// #[derive(schemars::JsonSchema)]
/// struct Truck {
///     speed_mps: f64,
///     engine: Engine,
/// }
///
/// #[derive(schemars::JsonSchema)]
/// struct Engine {
///     gears: u32,
/// }
///
/// wildfire_base::ranges! { Truck { speed_mps: 0.1..=30.0; engine } }
/// wildfire_base::ranges! { Engine { gears: 1.0..=12.0 } }
///
/// let truck = Truck { speed_mps: 8.0, engine: Engine { gears: 0 } };
/// let refusal = truck.check(&wildfire_base::geometry::FieldFrame { cols: 1, rows: 1, cell_m: 1.0 }).unwrap_err();
/// assert_eq!((refusal.name.as_str(), refusal.expected.as_str()), ("engine.gears", "a number from 1 to 12"));
/// ```
#[macro_export]
macro_rules! ranges {
    ($Settings:ty {
        $($name:ident: $range:expr),* $(,)? $(; $($table:ident),+ $(,)?)?
    } $(and $check:expr)?) => {
        impl $crate::ranges::SettingsTable for $Settings {
            fn check(&self, frame: &$crate::geometry::FieldFrame) -> Result<(), $crate::ranges::OutOfRange> {
                $($crate::ranges::check_range(stringify!($name), self.$name, $range)?;)*
                $($($crate::ranges::check_within(stringify!($table), &self.$table, frame)?;)+)?
                let others: &[fn(&Self, &$crate::geometry::FieldFrame) -> Result<(), $crate::ranges::OutOfRange>] =
                    &[$($check)?];
                others.iter().try_for_each(|check| check(self, frame))
            }

            fn write_ranges(schema: &mut $crate::ranges::Schema) {
                $($crate::ranges::write_range::<Self>(schema, stringify!($name), &$range);)*
                $($($crate::ranges::write_within(schema, |settings: &Self| &settings.$table);)+)?
            }
        }
    };
}

/// Checks that a number is in a range, if there is one.
///
/// # Errors
/// Returns the number and its range, in the words of messages.
pub fn check_range(name: &str, number: impl Number, range: RangeInclusive<f64>) -> Result<(), OutOfRange> {
    // NaN is in no range, so it is refused too.
    let Some(number) = number.number().filter(|number| !range.contains(number)) else { return Ok(()) };
    Err(OutOfRange::new(name, number, format!("a number from {} to {}", range.start(), range.end())))
}

/// Checks a table of another one.
///
/// # Errors
/// Returns the first setting that is out of its range, by its path in the outer table.
pub fn check_within(name: &str, table: &impl SettingsTable, frame: &FieldFrame) -> Result<(), OutOfRange> {
    table.check(frame).map_err(|wrong| wrong.within(name))
}

/// Writes the range of a setting into the schema of a file, which is that of the table or defines it.
pub fn write_range<T: JsonSchema>(schema: &mut Schema, name: &str, range: &RangeInclusive<f64>) {
    let whole = |bound: f64| if bound.fract() == 0.0 { (bound as i64).into() } else { bound.into() };
    let definition = format!("/$defs/{}", T::schema_name());
    let table = if schema.pointer(&definition).is_some() { definition } else { String::new() };
    let setting = schema.pointer_mut(&format!("{table}/properties/{name}")).expect("ranges are those of fields");
    (setting["minimum"], setting["maximum"]) = (whole(*range.start()), whole(*range.end()));
}

/// Writes the ranges of a table within another one.
pub fn write_within<T, U: SettingsTable>(schema: &mut Schema, _: fn(&T) -> &U) {
    U::write_ranges(schema);
}

/// Writes a number, with an exponent where it would be too long to read.
pub fn number_text(number: f64) -> String {
    let is_long = number != 0.0 && !(1e-6..1e15).contains(&number.abs());
    if is_long { format!("{number:e}") } else { number.to_string() }
}
