//! One compiled reader and one compiled writer of scenarios for all formats.
//!
//! The code that serde derives for a scenario and its tables is large and generic over the format. Through `erased_serde` it
//! is compiled once, not once for each format and crate.

use erased_serde::{Deserializer as ErasedDeserializer, Serialize as ErasedSerialize};
use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, Serializer};

use crate::Scenario;

impl<'de> Deserialize<'de> for Scenario {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut erased = <dyn ErasedDeserializer>::erase(deserializer);
        // The derived function, which `remote = "Self"` makes an inherent one.
        Self::deserialize(&mut erased as &mut dyn ErasedDeserializer).map_err(D::Error::custom)
    }
}

impl Serialize for Scenario {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        erased_serde::serialize(&ErasableScenario(self) as &dyn ErasedSerialize, serializer)
    }
}

struct ErasableScenario<'a>(&'a Scenario);

impl Serialize for ErasableScenario<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Scenario::serialize(self.0, serializer)
    }
}
