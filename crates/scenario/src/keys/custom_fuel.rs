//! Custom fuel models as scenarios write them: `[[fuel]]`, in the units of scenarios.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Scenario;
use crate::faults::check::{TablePath, ValidationError};
use crate::site::fuel_file::{BTU_LB_KJ_KG, FOOT_M, LB_FT2_KG_M2, printable};
use wildfire_base::ranges;
use wildfire_base::ranges::OutOfRange;
use wildfire_fire::fuel::{CustomFuels, FuelModel, SAV_10H, SAV_100H, custom_number};

/// A fuel model beside the built-in ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CustomFuel {
    /// 14 to 89 or 257 to 307.
    pub number: u16,
    /// By default its number.
    #[serde(default)]
    pub code: String,
    #[serde(default)]
    pub name: String,
    /// Dry loads: dead fuel of 1, 10 and 100 hours, live grass, live wood.
    pub loads_kg_m2: [f64; 5],
    /// Ratios of surface to volume: dead fuel of 1 hour, live grass, live wood.
    pub savs_per_m: [f64; 3],
    pub depth_m: f64,
    /// Moisture, as a fraction, above which the dead fuel alone does not burn.
    pub extinction: f64,
    /// Heat content of dead fuel, and of live fuel if that differs.
    #[serde(default = "usual_heat")]
    pub heat_kj_kg: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub live_heat_kj_kg: Option<f64>,
    /// Whether live grass of low moisture counts as dead.
    #[serde(default)]
    pub cures: bool,
}

fn usual_heat() -> f64 {
    8000.0 * BTU_LB_KJ_KG
}

ranges! { CustomFuel {
    depth_m: 0.004..=9.0, extinction: 0.05..=4.0, heat_kj_kg: 9500.0..=37_000.0, live_heat_kj_kg: 9500.0..=37_000.0,
} and |fuel, _| fuel.check_lists() }

impl CustomFuel {
    fn check_lists(&self) -> Result<(), OutOfRange> {
        if custom_number(self.number.into()).is_none() {
            return Err(OutOfRange::new("number", self.number.into(), "14 to 89 or 257 to 307".into()));
        }
        if let Some(&load) = self.loads_kg_m2.iter().find(|load| !(0.0..=24.0).contains(*load)) {
            return Err(OutOfRange::new("loads_kg_m2", load, "loads of 0 to 24 kg/m2".into()));
        }
        // Thicker dead fuel has ratios that are the same in all models.
        let [dead, _, _, herb, woody] = self.loads_kg_m2;
        let without = [dead, herb, woody].into_iter().zip(self.savs_per_m);
        let wrong = without.filter(|&(load, _)| load > 0.0).find(|(_, sav)| !(170.0..=19_600.0).contains(sav));
        match wrong {
            Some((_, sav)) => {
                Err(OutOfRange::new("savs_per_m", sav, "ratios of 170 to 19600 1/m for all loads".into()))
            }
            None => Ok(()),
        }
    }

    /// Returns the model in the units of the equations.
    fn model(&self) -> FuelModel {
        let [sav, sav_herb, sav_woody] = self.savs_per_m.map(|sav| sav * FOOT_M);
        let heat_btu_lb = self.heat_kj_kg / BTU_LB_KJ_KG;
        let code = if self.code.is_empty() { self.number.to_string() } else { self.code.clone() };
        FuelModel {
            number: custom_number(self.number.into()).unwrap_or(0),
            name: if self.name.is_empty() { "custom".into() } else { printable(&self.name).into() },
            code: printable(&code).into(),
            loads: self.loads_kg_m2.map(|load| load / LB_FT2_KG_M2),
            savs: [sav, SAV_10H, SAV_100H, sav_herb, sav_woody],
            depth_ft: self.depth_m / FOOT_M,
            dead_extinction: self.extinction,
            heat_btu_lb,
            live_heat_btu_lb: self.live_heat_kj_kg.map_or(heat_btu_lb, |heat| heat / BTU_LB_KJ_KG),
            cures: self.cures,
        }
    }
}

impl Scenario {
    /// Returns the custom fuel models, those of a file and those of `[[fuel]]`; none if they are not sound.
    pub fn custom_fuels(&self) -> CustomFuels {
        self.all_custom_fuels().unwrap_or_default()
    }

    fn all_custom_fuels(&self) -> Result<CustomFuels, String> {
        CustomFuels::new(self.imported_fuel.iter().cloned().chain(self.fuel.iter().map(CustomFuel::model)).collect())
    }

    /// Checks the custom fuel models, and that all that are named exist.
    pub(crate) fn check_fuels(&self) -> Result<CustomFuels, Box<ValidationError>> {
        let top = TablePath::named("");
        let fuels = match self.all_custom_fuels() {
            Ok(fuels) => fuels,
            Err(message) => {
                top.refuse("fuel", message, "possible models, each with a number of its own".into())?;
                // Never reached: `refuse` is always an error, but its type does not say so.
                CustomFuels::default()
            }
        };
        // Each with its table and key, at which a fuel that does not exist is reported.
        let mut named = Vec::new();
        if let Some(settings) = &self.fire.rothermel {
            for (key, fuel) in [("ground", settings.ground), ("bushes", settings.bushes)] {
                named.push((TablePath::named("fire.rothermel"), key.into(), fuel));
            }
        }
        if let Some(settings) = &self.landscape {
            let legend = settings.legend.iter();
            named.extend(legend.map(|(colour, &fuel)| (TablePath::named("landscape.legend"), colour.clone(), fuel)));
            for (number, patches) in settings.patches.iter().enumerate() {
                named.push((TablePath::named("landscape.patches").item(number), "fuel".into(), patches.fuel));
            }
        }
        for (number, barrier) in self.barrier.iter().enumerate() {
            let fuel = barrier.fuel.iter();
            named.extend(fuel.map(|&fuel| (TablePath::entry("barrier", number), "fuel".into(), fuel)));
        }
        for (table, key, fuel) in named {
            if fuel.is_custom() && fuels.model(fuel.number()).is_none() {
                let expected = "a built-in fuel model, or one of `[[fuel]]` or `fuel_file`";
                table.refuse(&key, fuel.to_string(), expected.into())?;
            }
        }
        Ok(fuels)
    }
}
