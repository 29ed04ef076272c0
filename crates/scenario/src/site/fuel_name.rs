//! Fuels as scenarios write them: the code of a fuel model, its number, or "none".

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use wildfire_fire::fuel::{FuelModel, custom_number, written_number};

/// A fuel model, by the number that landscapes hold, or no fuel at all: 0. That a custom model exists is checked apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuelName(u8);

impl FuelName {
    /// Returns the model of a code, such as `GR2`.
    pub(crate) fn from_code(code: &str) -> Self {
        Self::parse(code).expect("it is a code of the table")
    }

    /// Returns the model of a code or a number in digits; `None` if it is none.
    pub fn parse(name: &str) -> Option<Self> {
        let built_in = FuelModel::by_name(name).map(|model| model.number);
        built_in.or_else(|| name.parse().ok().and_then(custom_number)).map(Self)
    }

    /// Returns the number that landscapes hold: 0 for nothing.
    pub fn number(self) -> u8 {
        self.0
    }

    /// Says whether there is anything that burns.
    pub fn burns(self) -> bool {
        // All custom models burn.
        self.is_custom() || FuelModel::by_number(self.0).is_some_and(FuelModel::burns)
    }

    pub fn is_custom(self) -> bool {
        custom_number(written_number(self.0).into()).is_some()
    }
}

impl fmt::Display for FuelName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match FuelModel::by_number(self.0) {
            Some(model) => f.write_str(&model.code),
            None if self.0 == 0 => f.write_str("none"),
            None => write!(f, "{}", written_number(self.0)),
        }
    }
}

impl Serialize for FuelName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for FuelName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FuelNameVisitor)
    }
}

struct FuelNameVisitor;

impl Visitor<'_> for FuelNameVisitor {
    type Value = FuelName;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the code of a fuel model such as \"GR2\", its number, or \"none\"")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<FuelName, E> {
        if name == "none" {
            return Ok(FuelName(0));
        }
        FuelName::parse(name).ok_or_else(|| E::invalid_value(Unexpected::Str(name), &self))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<FuelName, E> {
        FuelName::parse(&number.to_string()).ok_or_else(|| E::invalid_value(Unexpected::Unsigned(number), &self))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<FuelName, E> {
        u64::try_from(number)
            .map_or(Err(E::invalid_value(Unexpected::Signed(number), &self)), |number| self.visit_u64(number))
    }
}

impl JsonSchema for FuelName {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "FuelName".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "type": "string" }, { "type": "integer", "minimum": 0, "maximum": 307 }] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fuels_are_named_by_code_by_number_or_none() {
        let read = |text: &str| toml::from_str::<toml::Table>(&format!("fuel = {text}")).expect("it is TOML");
        let fuel = |text: &str| read(text)["fuel"].clone().try_into::<FuelName>();
        assert_eq!(fuel("\"gr2\"").map(FuelName::number), Ok(102));
        assert_eq!(fuel("102").map(|fuel| fuel.to_string()), Ok("GR2".into()));
        assert_eq!(fuel("\"none\"").map(FuelName::number), Ok(0));
        assert_eq!(fuel("257").map(|fuel| (fuel.number(), fuel.to_string())), Ok((205, "257".into())));
        for wrong in ["\"GR22\"", "90", "205", "-1", "100000", "true"] {
            assert!(fuel(wrong).is_err(), "{wrong}");
        }
    }
}
