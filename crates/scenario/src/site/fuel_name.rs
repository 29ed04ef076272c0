//! Fuels as scenarios write them: the code of a fuel model, its number, or "none".

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use wildfire_fire::fuel::FuelModel;

/// A fuel model, or no fuel at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuelName(pub Option<&'static FuelModel>);

impl FuelName {
    /// Returns the model of a code, such as `GR2`.
    pub(crate) fn from_code(code: &str) -> Self {
        Self(Some(FuelModel::by_name(code).expect("it is a code of the table")))
    }

    /// Returns the number that landscapes hold: 0 for nothing.
    pub fn number(self) -> u8 {
        self.0.map_or(0, |model| model.number)
    }

    /// Says whether there is anything that burns.
    pub fn burns(self) -> bool {
        self.0.is_some_and(FuelModel::burns)
    }
}

impl fmt::Display for FuelName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.map_or("none", |model| model.code))
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
            return Ok(FuelName(None));
        }
        let model = FuelModel::by_name(name).ok_or_else(|| E::invalid_value(Unexpected::Str(name), &self))?;
        Ok(FuelName(Some(model)))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<FuelName, E> {
        let model = u8::try_from(number).ok().and_then(FuelModel::by_number);
        Ok(FuelName(Some(model.ok_or_else(|| E::invalid_value(Unexpected::Unsigned(number), &self))?)))
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
        json_schema!({ "anyOf": [{ "type": "string" }, { "type": "integer", "minimum": 0, "maximum": 255 }] })
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
        for wrong in ["\"GR22\"", "14", "-1", "100000", "true"] {
            assert!(fuel(wrong).is_err(), "{wrong}");
        }
    }
}
