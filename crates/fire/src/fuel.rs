//! Fuel models: what grows or lies on a cell, as numbers that Rothermel's equations take.
//!
//! Sources: the 13 models of Anderson, "Aids to determining fuel models for estimating fire behavior", USDA Forest
//! Service INT-122, 1982 (after Albini, INT-30, 1976), and the 40 of Scott and Burgan, "Standard fire behavior fuel models",
//! RMRS-GTR-153, 2005, with their five models of what does not burn. The live load of Anderson's 4, 5, 7 and 10 is woody.
//!
//! Units are those that the equations were fitted in: loads lb/ft2, surface-area-to-volume ratios 1/ft, depth ft, heat
//! Btu/lb. Anderson's loads are given in lb/ft2; those of Scott and Burgan, in short tons per acre, are converted exactly,
//! as tables in lb/ft2 are rounded, which changes rates by up to 3 % near extinction.

use std::borrow::Cow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

/// One ton (2000 lb) per acre (43560 ft2), in lb/ft2.
pub const TON_PER_ACRE: f64 = 2000.0 / 43560.0;

/// Surface-area-to-volume ratios of 10-h and 100-h fuel, the same in all models.
pub const SAV_10H: f64 = 109.0;
pub const SAV_100H: f64 = 30.0;

/// The numbers that files give to custom fuel models.
pub const CUSTOM_NUMBERS: &str = "14 to 89 or 257 to 307";

/// The first number of files beyond those of one byte, and the number that stands for it in landscapes.
const FIRST_LONG_NUMBER: u16 = 257;
const FIRST_LONG_STORED: u8 = 205;

/// A fuel model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FuelModel {
    /// As landscapes store it: 1 to 13, 91 to 99, 101 to 204; custom ones have 14 to 89, and 205 to 255 for what files call
    /// 257 to 307.
    pub number: u8,
    pub code: Cow<'static, str>,
    pub name: Cow<'static, str>,
    /// Loads in lb/ft2: dead 1-h, 10-h and 100-h, live herbaceous, live woody.
    pub loads: [f64; 5],
    /// Surface-area-to-volume ratios of the same, in 1/ft.
    pub savs: [f64; 5],
    pub depth_ft: f64,
    /// Moisture, as a fraction, above which the dead fuel alone does not burn.
    pub dead_extinction: f64,
    /// Heat content of dead and of live fuel.
    pub heat_btu_lb: f64,
    pub live_heat_btu_lb: f64,
    /// Whether live grass counts as dead when its moisture is low.
    pub cures: bool,
}

/// Returns the number that landscapes store for the number of a custom fuel model in a file; `None` if it is none.
pub fn custom_number(written: u32) -> Option<u8> {
    let last_long = u32::from(FIRST_LONG_NUMBER) + u32::from(u8::MAX - FIRST_LONG_STORED);
    match written {
        14..=89 => Some(written as u8),
        _ if (FIRST_LONG_NUMBER.into()..=last_long).contains(&written) => {
            Some((written - u32::from(FIRST_LONG_NUMBER)) as u8 + FIRST_LONG_STORED)
        }
        _ => None,
    }
}

/// Returns the number that files have for a number of landscapes.
pub fn written_number(number: u8) -> u16 {
    number.checked_sub(FIRST_LONG_STORED).map_or(number.into(), |above| FIRST_LONG_NUMBER + u16::from(above))
}

/// The custom fuel models of a landscape, beside the built-in ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CustomFuels(Arc<[FuelModel]>);

impl CustomFuels {
    /// Creates the set of these models.
    ///
    /// # Errors
    /// Returns a sentence on the first model that has a wrong number or one that another has, or an impossible value.
    pub fn new(mut models: Vec<FuelModel>) -> Result<Self, String> {
        models.sort_by_key(|model| model.number);
        for model in &models {
            model.check_custom()?;
        }
        match models.windows(2).find(|pair| pair[0].number == pair[1].number) {
            Some(pair) => Err(format!("there are two fuel models {}", written_number(pair[0].number))),
            None => Ok(Self(models.into())),
        }
    }

    pub fn models(&self) -> &[FuelModel] {
        &self.0
    }

    /// Returns the model of a number, a built-in one or one of these; `None` if there is none.
    pub fn model(&self, number: u8) -> Option<&FuelModel> {
        let is_built_in = FuelModel::by_number(number);
        is_built_in.or_else(|| self.0.iter().find(|model| model.number == number))
    }
}

impl FuelModel {
    /// Returns the model with a number, `None` if there is none.
    pub fn by_number(number: u8) -> Option<&'static Self> {
        let place = FUEL_MODELS.binary_search_by_key(&number, |model| model.number).ok()?;
        Some(&FUEL_MODELS[place])
    }

    /// Returns the model with a code in capitals or not, such as `GR2`, or a number in digits, such as `102`.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        let by_number = name.parse().ok().and_then(Self::by_number);
        by_number.or_else(|| FUEL_MODELS.iter().find(|model| model.code.eq_ignore_ascii_case(name)))
    }

    /// Returns the models that are nearest to a name that no model has: the numbers below and above it, or the code of the
    /// same letters with the nearest digits; none for a name that is like no code.
    pub fn nearest(name: &str) -> Vec<&'static Self> {
        if let Ok(number) = name.parse::<i64>() {
            let above = FUEL_MODELS.partition_point(|model| i64::from(model.number) < number);
            let below = above.checked_sub(1).map(|place| &FUEL_MODELS[place]);
            return below.into_iter().chain(FUEL_MODELS.get(above)).collect();
        }
        let (letters, digits) = name.split_at(name.trim_end_matches(|letter: char| letter.is_ascii_digit()).len());
        // Bare letters mean the first word of their family.
        let wanted: u64 = digits.parse().unwrap_or(1);
        let family = FUEL_MODELS.iter().filter_map(|model| {
            let number: u64 = model.code.get(letters.len()..)?.parse().ok()?;
            let is_of_it = model.code.get(..letters.len())?.eq_ignore_ascii_case(letters);
            is_of_it.then_some((number.abs_diff(wanted), model))
        });
        family.min_by_key(|(distance, _)| *distance).map(|(_, model)| model).into_iter().collect()
    }

    /// Says whether it has any fuel; roads, water and bare ground have none.
    pub fn burns(&self) -> bool {
        self.depth_ft > 0.0
    }

    /// Says whether part of the live herbaceous load counts as dead when its moisture is low.
    pub fn is_dynamic(&self) -> bool {
        self.cures && self.loads[3] > 0.0
    }

    /// Refuses a custom model that the equations cannot take.
    fn check_custom(&self) -> Result<(), String> {
        /// The densest bed, as the share of it that is wood.
        const MAX_PACKING: f64 = 0.5;
        let number = written_number(self.number);
        if custom_number(number.into()) != Some(self.number) {
            return Err(format!(
                "fuel model {number}: its number is that of no custom model; expected {CUSTOM_NUMBERS}"
            ));
        }
        let [dead, dead_10h, dead_100h, herb, woody] = self.loads;
        // 10-h and 100-h fuel has the same ratios in all models, so files give none.
        let [sav, _, _, sav_herb, sav_woody] = self.savs;
        let mut values = vec![
            ("1-h load in lb/ft2", dead, 0.0, 5.0),
            ("10-h load in lb/ft2", dead_10h, 0.0, 5.0),
            ("100-h load in lb/ft2", dead_100h, 0.0, 5.0),
            ("herbaceous load in lb/ft2", herb, 0.0, 5.0),
            ("woody load in lb/ft2", woody, 0.0, 5.0),
            ("depth in ft", self.depth_ft, 0.01, 30.0),
            ("moisture of extinction as a fraction", self.dead_extinction, 0.05, 4.0),
            ("heat content of dead fuel in Btu/lb", self.heat_btu_lb, 4000.0, 16_000.0),
            ("heat content of live fuel in Btu/lb", self.live_heat_btu_lb, 4000.0, 16_000.0),
        ];
        for (name, load, sav) in [
            ("ratio of surface to volume of 1-h fuel in 1/ft", dead, sav),
            ("ratio of surface to volume of herbaceous fuel in 1/ft", herb, sav_herb),
            ("ratio of surface to volume of woody fuel in 1/ft", woody, sav_woody),
        ] {
            // Without load a ratio means nothing, and files fill it in with all kinds of numbers.
            values.extend((load > 0.0).then_some((name, sav, 50.0, 6000.0)));
        }
        for (name, found, min, max) in values {
            if !(min..=max).contains(&found) {
                return Err(format!("fuel model {number}: its {name} is {found}; expected {min} to {max}"));
            }
        }
        let load: f64 = self.loads.iter().sum();
        if load == 0.0 {
            return Err(format!("fuel model {number}: it has no load; expected some that burns"));
        }
        // Over the 32 lb/ft3 of dry wood.
        let packing = load / self.depth_ft / 32.0;
        if packing > MAX_PACKING {
            return Err(format!(
                "fuel model {number}: wood fills {:.0} % of its bed; expected at most 50 %, by less load or more depth",
                100.0 * packing
            ));
        }
        Ok(())
    }
}

const fn anderson(
    number: u8,
    [code, name]: [&'static str; 2],
    loads: [f64; 5],
    [sav_1h, sav_herb, sav_woody]: [f64; 3],
    [depth_ft, extinction_percent]: [f64; 2],
) -> FuelModel {
    let savs = [sav_1h, SAV_10H, SAV_100H, sav_herb, sav_woody];
    let dead_extinction = extinction_percent / 100.0;
    // GR6 is the one whose heat content differs, and only models of Scott and Burgan cure.
    let heat_btu_lb = if number == 106 { 9000.0 } else { 8000.0 };
    FuelModel {
        number,
        code: Cow::Borrowed(code),
        name: Cow::Borrowed(name),
        loads,
        savs,
        depth_ft,
        dead_extinction,
        heat_btu_lb,
        live_heat_btu_lb: heat_btu_lb,
        cures: number > 100,
    }
}

const fn scott_burgan(
    number: u8,
    names: [&'static str; 2],
    tons_per_acre: [f64; 5],
    savs: [f64; 3],
    bed: [f64; 2],
) -> FuelModel {
    let mut loads = tons_per_acre;
    let mut class = 0;
    while class < loads.len() {
        loads[class] *= TON_PER_ACRE;
        class += 1;
    }
    anderson(number, names, loads, savs, bed)
}

const fn no_fuel(number: u8, names: [&'static str; 2]) -> FuelModel {
    anderson(number, names, [0.0; 5], [0.0; 3], [0.0; 2])
}

/// All fuel models, by number.
///
/// The columns of a row: number, code and name; loads; ratios of 1-h, live herbaceous and live woody fuel; depth and
/// extinction in percent.
#[rustfmt::skip]
pub static FUEL_MODELS: [FuelModel; 58] = [
    anderson(1, ["R01", "Short grass"], [0.034, 0.0, 0.0, 0.0, 0.0], [3500.0, 0.0, 0.0], [1.0, 12.0]),
    anderson(2, ["R02", "Timber grass and understory"], [0.092, 0.046, 0.023, 0.023, 0.0], [3000.0, 1500.0, 0.0], [1.0, 15.0]),
    anderson(3, ["R03", "Tall grass"], [0.138, 0.0, 0.0, 0.0, 0.0], [1500.0, 0.0, 0.0], [2.5, 25.0]),
    anderson(4, ["R04", "Chaparral"], [0.23, 0.184, 0.092, 0.0, 0.23], [2000.0, 0.0, 1500.0], [6.0, 20.0]),
    anderson(5, ["R05", "Brush"], [0.046, 0.023, 0.0, 0.0, 0.092], [2000.0, 0.0, 1500.0], [2.0, 20.0]),
    anderson(6, ["R06", "Dormant brush, hardwood slash"], [0.069, 0.115, 0.092, 0.0, 0.0], [1750.0, 0.0, 0.0], [2.5, 25.0]),
    anderson(7, ["R07", "Southern rough"], [0.052, 0.086, 0.069, 0.0, 0.017], [1750.0, 0.0, 1550.0], [2.5, 40.0]),
    anderson(8, ["R08", "Short needle litter"], [0.069, 0.046, 0.115, 0.0, 0.0], [2000.0, 0.0, 0.0], [0.2, 30.0]),
    anderson(9, ["R09", "Long needle or hardwood litter"], [0.134, 0.019, 0.007, 0.0, 0.0], [2500.0, 0.0, 0.0], [0.2, 25.0]),
    anderson(10, ["R10", "Timber litter and understory"], [0.138, 0.092, 0.23, 0.0, 0.092], [2000.0, 0.0, 1500.0], [1.0, 25.0]),
    anderson(11, ["R11", "Light logging slash"], [0.069, 0.207, 0.253, 0.0, 0.0], [1500.0, 0.0, 0.0], [1.0, 15.0]),
    anderson(12, ["R12", "Medium logging slash"], [0.184, 0.644, 0.759, 0.0, 0.0], [1500.0, 0.0, 0.0], [2.3, 20.0]),
    anderson(13, ["R13", "Heavy logging slash"], [0.322, 1.058, 1.288, 0.0, 0.0], [1500.0, 0.0, 0.0], [3.0, 25.0]),
    no_fuel(91, ["NB1", "Urban or suburban"]),
    no_fuel(92, ["NB2", "Snow or ice"]),
    no_fuel(93, ["NB3", "Farmland"]),
    no_fuel(98, ["NB8", "Open water"]),
    no_fuel(99, ["NB9", "Bare ground"]),
    scott_burgan(101, ["GR1", "Short, sparse, dry climate grass"], [0.1, 0.0, 0.0, 0.3, 0.0], [2200.0, 2000.0, 0.0], [0.4, 15.0]),
    scott_burgan(102, ["GR2", "Low load, dry climate grass"], [0.1, 0.0, 0.0, 1.0, 0.0], [2000.0, 1800.0, 0.0], [1.0, 15.0]),
    scott_burgan(103, ["GR3", "Low load, very coarse, humid climate grass"], [0.1, 0.4, 0.0, 1.5, 0.0], [1500.0, 1300.0, 0.0], [2.0, 30.0]),
    scott_burgan(104, ["GR4", "Moderate load, dry climate grass"], [0.25, 0.0, 0.0, 1.9, 0.0], [2000.0, 1800.0, 0.0], [2.0, 15.0]),
    scott_burgan(105, ["GR5", "Low load, humid climate grass"], [0.4, 0.0, 0.0, 2.5, 0.0], [1800.0, 1600.0, 0.0], [1.5, 40.0]),
    scott_burgan(106, ["GR6", "Moderate load, humid climate grass"], [0.1, 0.0, 0.0, 3.4, 0.0], [2200.0, 2000.0, 0.0], [1.5, 40.0]),
    scott_burgan(107, ["GR7", "High load, dry climate grass"], [1.0, 0.0, 0.0, 5.4, 0.0], [2000.0, 1800.0, 0.0], [3.0, 15.0]),
    scott_burgan(108, ["GR8", "High load, very coarse, humid climate grass"], [0.5, 1.0, 0.0, 7.3, 0.0], [1500.0, 1300.0, 0.0], [4.0, 30.0]),
    scott_burgan(109, ["GR9", "Very high load, humid climate grass"], [1.0, 1.0, 0.0, 9.0, 0.0], [1800.0, 1600.0, 0.0], [5.0, 40.0]),
    scott_burgan(121, ["GS1", "Low load, dry climate grass-shrub"], [0.2, 0.0, 0.0, 0.5, 0.65], [2000.0, 1800.0, 1800.0], [0.9, 15.0]),
    scott_burgan(122, ["GS2", "Moderate load, dry climate grass-shrub"], [0.5, 0.5, 0.0, 0.6, 1.0], [2000.0, 1800.0, 1800.0], [1.5, 15.0]),
    scott_burgan(123, ["GS3", "Moderate load, humid climate grass-shrub"], [0.3, 0.25, 0.0, 1.45, 1.25], [1800.0, 1600.0, 1600.0], [1.8, 40.0]),
    scott_burgan(124, ["GS4", "High load, humid climate grass-shrub"], [1.9, 0.3, 0.1, 3.4, 7.1], [1800.0, 1600.0, 1600.0], [2.1, 40.0]),
    scott_burgan(141, ["SH1", "Low load, dry climate shrub"], [0.25, 0.25, 0.0, 0.15, 1.3], [2000.0, 1800.0, 1600.0], [1.0, 15.0]),
    scott_burgan(142, ["SH2", "Moderate load, dry climate shrub"], [1.35, 2.4, 0.75, 0.0, 3.85], [2000.0, 0.0, 1600.0], [1.0, 15.0]),
    scott_burgan(143, ["SH3", "Moderate load, humid climate shrub"], [0.45, 3.0, 0.0, 0.0, 6.2], [1600.0, 0.0, 1400.0], [2.4, 40.0]),
    scott_burgan(144, ["SH4", "Low load, humid climate timber-shrub"], [0.85, 1.15, 0.2, 0.0, 2.55], [2000.0, 0.0, 1600.0], [3.0, 30.0]),
    scott_burgan(145, ["SH5", "High load, dry climate shrub"], [3.6, 2.1, 0.0, 0.0, 2.9], [750.0, 0.0, 1600.0], [6.0, 15.0]),
    scott_burgan(146, ["SH6", "Low load, humid climate shrub"], [2.9, 1.45, 0.0, 0.0, 1.4], [750.0, 0.0, 1600.0], [2.0, 30.0]),
    scott_burgan(147, ["SH7", "Very high load, dry climate shrub"], [3.5, 5.3, 2.2, 0.0, 3.4], [750.0, 0.0, 1600.0], [6.0, 15.0]),
    scott_burgan(148, ["SH8", "High load, humid climate shrub"], [2.05, 3.4, 0.85, 0.0, 4.35], [750.0, 0.0, 1600.0], [3.0, 40.0]),
    scott_burgan(149, ["SH9", "Very high load, humid climate shrub"], [4.5, 2.45, 0.0, 1.55, 7.0], [750.0, 1800.0, 1500.0], [4.4, 40.0]),
    scott_burgan(161, ["TU1", "Low load, dry climate timber-grass-shrub"], [0.2, 0.9, 1.5, 0.2, 0.9], [2000.0, 1800.0, 1600.0], [0.6, 20.0]),
    scott_burgan(162, ["TU2", "Moderate load, humid climate timber-shrub"], [0.95, 1.8, 1.25, 0.0, 0.2], [2000.0, 0.0, 1600.0], [1.0, 30.0]),
    scott_burgan(163, ["TU3", "Moderate load, humid climate timber-grass-shrub"], [1.1, 0.15, 0.25, 0.65, 1.1], [1800.0, 1600.0, 1400.0], [1.3, 30.0]),
    scott_burgan(164, ["TU4", "Dwarf conifer with understory"], [4.5, 0.0, 0.0, 0.0, 2.0], [2300.0, 0.0, 2000.0], [0.5, 12.0]),
    scott_burgan(165, ["TU5", "Very high load, dry climate timber-shrub"], [4.0, 4.0, 3.0, 0.0, 3.0], [1500.0, 0.0, 750.0], [1.0, 25.0]),
    scott_burgan(181, ["TL1", "Low load, compact conifer litter"], [1.0, 2.2, 3.6, 0.0, 0.0], [2000.0, 0.0, 0.0], [0.2, 30.0]),
    scott_burgan(182, ["TL2", "Low load broadleaf litter"], [1.4, 2.3, 2.2, 0.0, 0.0], [2000.0, 0.0, 0.0], [0.2, 25.0]),
    scott_burgan(183, ["TL3", "Moderate load conifer litter"], [0.5, 2.2, 2.8, 0.0, 0.0], [2000.0, 0.0, 0.0], [0.3, 20.0]),
    scott_burgan(184, ["TL4", "Small downed logs"], [0.5, 1.5, 4.2, 0.0, 0.0], [2000.0, 0.0, 0.0], [0.4, 25.0]),
    scott_burgan(185, ["TL5", "High load conifer litter"], [1.15, 2.5, 4.4, 0.0, 0.0], [2000.0, 0.0, 0.0], [0.6, 25.0]),
    scott_burgan(186, ["TL6", "Moderate load broadleaf litter"], [2.4, 1.2, 1.2, 0.0, 0.0], [2000.0, 0.0, 0.0], [0.3, 25.0]),
    scott_burgan(187, ["TL7", "Large downed logs"], [0.3, 1.4, 8.1, 0.0, 0.0], [2000.0, 0.0, 0.0], [0.4, 25.0]),
    scott_burgan(188, ["TL8", "Long needle litter"], [5.8, 1.4, 1.1, 0.0, 0.0], [1800.0, 0.0, 0.0], [0.3, 35.0]),
    scott_burgan(189, ["TL9", "Very high load broadleaf litter"], [6.65, 3.3, 4.15, 0.0, 0.0], [1800.0, 0.0, 0.0], [0.6, 35.0]),
    scott_burgan(201, ["SB1", "Low load activity fuel"], [1.5, 3.0, 11.0, 0.0, 0.0], [2000.0, 0.0, 0.0], [1.0, 25.0]),
    scott_burgan(202, ["SB2", "Moderate load activity fuel or low load blowdown"], [4.5, 4.25, 4.0, 0.0, 0.0], [2000.0, 0.0, 0.0], [1.0, 25.0]),
    scott_burgan(203, ["SB3", "High load activity fuel or moderate load blowdown"], [5.5, 2.75, 3.0, 0.0, 0.0], [2000.0, 0.0, 0.0], [1.2, 25.0]),
    scott_burgan(204, ["SB4", "High load blowdown"], [5.25, 3.5, 5.25, 0.0, 0.0], [2000.0, 0.0, 0.0], [2.7, 25.0]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_found_by_number_and_by_name() {
        for model in &FUEL_MODELS {
            for found in [
                FuelModel::by_number(model.number),
                FuelModel::by_name(&model.code),
                FuelModel::by_name(&model.code.to_lowercase()),
                FuelModel::by_name(&model.number.to_string()),
            ] {
                assert_eq!(found, Some(model));
            }
        }
        for name in ["", "0", "14", "GR10", "GR", "1020", "-1", "102.0"] {
            assert_eq!(FuelModel::by_name(name), None, "{name}");
        }
    }

    #[test]
    fn names_that_no_model_has_are_near_to_others() {
        let codes = |name| FuelModel::nearest(name).iter().map(|model| &*model.code).collect::<Vec<_>>();
        assert_eq!((codes("14"), codes("100")), (vec!["R13", "NB1"], vec!["NB9", "GR1"]));
        assert_eq!((codes("-5"), codes("99999")), (vec!["R01"], vec!["SB4"]));
        assert_eq!((codes("gr10"), codes("SH"), codes("R00")), (vec!["GR9"], vec!["SH1"], vec!["R01"]));
        for name in ["", "XX1", "grass", "ä", "GR2x"] {
            assert_eq!(codes(name), [""; 0], "{name}");
        }
    }

    #[test]
    fn custom_models_have_their_numbers_and_possible_values() {
        let gr2 = FuelModel { number: 14, ..FuelModel::by_number(102).expect("it is one").clone() };
        let long = FuelModel { number: 255, ..gr2.clone() };
        let fuels = CustomFuels::new(vec![long.clone(), gr2.clone()]).expect("both are right");
        assert_eq!((fuels.model(255), fuels.model(14), fuels.model(15)), (Some(&long), Some(&gr2), None));
        assert_eq!(fuels.model(102), FuelModel::by_number(102));
        for written in (0..400).filter(|&written| custom_number(written).is_some()) {
            let number = custom_number(written).expect("it was found");
            assert!(u32::from(written_number(number)) == written && FuelModel::by_number(number).is_none());
        }
        assert_eq!([13, 90, 256, 308].map(custom_number), [None; 4]);
        for (wrong, expected) in [
            (FuelModel { number: 102, ..gr2.clone() }, "fuel model 102: its number"),
            (FuelModel { number: 90, ..gr2.clone() }, "fuel model 90: its number"),
            (FuelModel { depth_ft: 0.0, ..gr2.clone() }, "fuel model 14: its depth in ft is 0; expected 0.01 to 30"),
            (FuelModel { depth_ft: f64::NAN, ..gr2.clone() }, "its depth in ft is NaN"),
            (FuelModel { loads: [0.0; 5], ..gr2.clone() }, "it has no load"),
            (FuelModel { savs: [0.0; 5], ..gr2.clone() }, "ratio of surface to volume of 1-h fuel in 1/ft is 0"),
            (FuelModel { loads: [4.0; 5], depth_ft: 1.0, savs: [2000.0; 5], ..gr2.clone() }, "wood fills 62 %"),
        ] {
            let error = CustomFuels::new(vec![wrong]).expect_err(expected);
            assert!(error.contains(expected), "{error}");
        }
        assert_eq!(CustomFuels::new(vec![gr2.clone(), gr2]), Err("there are two fuel models 14".into()));
    }

    #[test]
    fn there_are_53_models_that_burn_in_order_of_number() {
        assert!(FUEL_MODELS.is_sorted_by(|a, b| a.number < b.number));
        assert_eq!(FUEL_MODELS.iter().filter(|model| model.burns()).count(), 53);
        assert_eq!(FUEL_MODELS.iter().filter(|model| model.is_dynamic()).count(), 17);
    }

    #[test]
    fn loads_have_ratios_and_fuel_beds_room_for_them() {
        for model in FUEL_MODELS.iter().filter(|model| model.burns()) {
            for (load, sav) in model.loads.into_iter().zip(model.savs) {
                assert!(load >= 0.0 && (load == 0.0 || sav > 0.0), "{}", model.code);
            }
            assert!(model.loads[0] > 0.0 && model.dead_extinction > 0.1, "{}", model.code);
            // Wood of 32 lb/ft3 fills a small part of the bed.
            let packing = model.loads.iter().sum::<f64>() / model.depth_ft / 32.0;
            assert!((1e-4..0.2).contains(&packing), "{}: {packing}", model.code);
        }
    }
}
