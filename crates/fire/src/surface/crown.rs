//! Fire in the crowns of trees above a surface fire: whether it gets there, whether it runs from crown to crown, and how
//! fast and how hot the fire then is.
//!
//! A surface fire reaches the crowns where its intensity is that of Van Wagner's first criterion; it runs through them if
//! it is fast enough for a flow of fuel of 3 kg/m2 a minute, the second. A crown fire is 3.34 times as fast as one in fuel
//! model 10 on level ground under 0.4 of the wind at 20 ft, whatever grows and however steep it is there, and without a
//! wind limit.
//!
//! Sources: Van Wagner, "Conditions for the start and spread of crown fire", Canadian Journal of Forest Research 7, 1977;
//! Rothermel, "Predicting behavior and size of crown fires in the northern Rocky Mountains", INT-438, 1991; Scott and
//! Reinhardt, "Assessing crown fire potential by linking models of surface and crown fire behavior", RMRS-RP-29, 2001;
//! Thomas, "The size of flames from natural fires", 1963, for the flames of crowns.

use std::f64::consts::PI;
use std::path::PathBuf;

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::behavior::{MILE_PER_HOUR, lift, unit};
use super::{
    BTU_J, Curing, FOOT_M, FOOT_PER_MINUTE, FuelBed, FuelMoisture, SurfaceFire, SurfaceOptions, WindLimit,
    flame_length_m, sheltered_adjustment, surface_fire, twenty_foot_wind, unsheltered_adjustment,
};
use crate::fuel::FuelModel;
use crate::{Landscape, Weather, WeatherInterval};
use wildfire_base::geometry::{Cell, ops};
use wildfire_base::object::Members;
use wildfire_base::ranges;
use wildfire_base::time::SimTime;

/// The rate of a crown fire as a multiple of that of model 10, and the part of the wind at 20 ft that drives the latter
/// (Rothermel, 1991).
const RATE_FACTOR: f64 = 3.34;
const CROWN_WIND_FACTOR: f64 = 0.4;
/// The least flow of fuel into the front of a fire that runs through crowns, in kg/m2/min (Van Wagner, 1977).
const CRITICAL_FLOW: f64 = 3.0;
/// Heat of the fuel of crowns, Btu/lb.
const HEAT: f64 = 8000.0;
/// The lowest values with which Van Wagner's first criterion is computed.
const MIN_FOLIAR_MOISTURE: f64 = 0.3;
const MIN_BASE_M: f64 = 0.1;
/// Kilograms in a pound.
const POUND_KG: f64 = 0.453_592_37;

/// Joules per metre in a Btu per foot.
const BTU_PER_FOOT: f64 = BTU_J / FOOT_M;

/// Returns fuel model 10, whose rate that of crowns follows from.
pub fn model_10(moisture: &FuelMoisture, curing: Curing) -> FuelBed {
    FuelBed::new(FuelModel::by_number(10).expect("it is a standard model"), moisture, curing)
}

/// Trees above a surface fire.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Canopy {
    /// Of the trees.
    pub height_m: f64,
    /// Height above the ground at which crowns begin that can burn.
    pub base_m: f64,
    /// Mass of what burns in the crowns by their volume.
    pub bulk_density_kg_m3: f64,
    /// The part of the ground below crowns, in [0, 1].
    pub cover: f64,
}

impl Canopy {
    /// Returns the wind at the middle of the flames, as a part of that at 20 ft above the trees, over fuel of this depth.
    /// Trees shelter it by the part of the space below their tops that crowns fill: the cover times the part of the
    /// height that they take up, by a third. Few or low trees shelter nothing.
    pub fn wind_adjustment(&self, depth_ft: f64) -> f64 {
        let filled = if self.height_m > 0.0 { self.cover * self.depth_m() / self.height_m } else { 0.0 };
        sheltered_adjustment(self.height_m / FOOT_M, filled).unwrap_or_else(|| unsheltered_adjustment(depth_ft))
    }

    /// The height of the crowns from their base to their tops.
    fn depth_m(&self) -> f64 {
        (self.height_m - self.base_m).max(0.0)
    }

    /// Returns the mass of what burns in the crowns by the ground below.
    pub fn load_kg_m2(&self) -> f64 {
        self.bulk_density_kg_m3 * self.depth_m()
    }

    /// Returns the heat that the crowns over a square metre of ground give off.
    pub fn heat_kj_m2(&self) -> f64 {
        self.load_kg_m2() * HEAT * BTU_J / POUND_KG / 1000.0
    }
}

/// Selects the unit factors in Van Wagner's criteria, which are published in kilowatts, metres and kilograms.
#[derive(Clone, Copy, Debug)]
pub enum CrownUnits {
    Exact,
    /// Those of BEHAVE: a Btu/ft/s is 0.08 % more kilowatts per metre.
    Behave,
}

impl CrownUnits {
    /// The kW/m in one as it is computed with, and the like for m/min over kg/m3.
    fn scales(self) -> [f64; 2] {
        const EXACT_POUNDS: f64 = FOOT_M * FOOT_M * FOOT_M / POUND_KG;
        match self {
            Self::Exact => [1.0, 1.0],
            // It has 0.2886719 Btu/ft/s in a kW/m, 3.28084 ft in a metre and 16.0185 kg/m3 in a lb/ft3.
            Self::Behave => [0.288_671_9 * BTU_PER_FOOT / 1000.0, 3.280_84 * FOOT_M / (16.018_5 * EXACT_POUNDS)],
        }
    }
}

/// Selects how fast and how hot a fire is that is in the crowns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CrownMethod {
    /// Fires that torch single trees are as much of a crown fire as of the crowns they burn (2001).
    #[default]
    ScottReinhardt,
    /// Fires that torch single trees are as fast as the surface fire, with the heat of a crown fire (1991).
    Rothermel,
}

/// How fire spreads in crowns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CrownRules {
    pub method: CrownMethod,
    /// Moisture of leaves and needles, as a fraction of the dry weight.
    pub foliar_moisture: f64,
}

/// The trees of a landscape and how fire spreads in their crowns. Numbers are for cells without a raster.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CrownSettings {
    /// How fast fires are that torch single trees.
    pub method: CrownMethod,
    /// Moisture of leaves and needles as a fraction of the dry weight.
    pub foliar_moisture: f64,
    /// Height of the trees.
    pub height_m: f64,
    /// Height at which crowns begin.
    pub base_m: f64,
    /// Mass of fuel in the crowns by volume.
    pub density_kg_m3: f64,
    /// The part of the ground below crowns.
    pub cover: f64,
    /// Rasters of the same in the units of LANDFIRE: tenths of metres, hundredths of kg/m3, percent.
    pub height_map: Option<PathBuf>,
    pub base_map: Option<PathBuf>,
    pub density_map: Option<PathBuf>,
    pub cover_map: Option<PathBuf>,
}

impl Default for CrownSettings {
    fn default() -> Self {
        Self {
            method: CrownMethod::default(),
            foliar_moisture: 1.0,
            height_m: 20.0,
            base_m: 2.0,
            density_kg_m3: 0.1,
            cover: 0.5,
            height_map: None,
            base_map: None,
            density_map: None,
            cover_map: None,
        }
    }
}

impl CrownSettings {
    /// Returns the rules without the trees.
    pub fn rules(&self) -> CrownRules {
        CrownRules { method: self.method, foliar_moisture: self.foliar_moisture }
    }

    /// Returns the trees where no raster has others.
    pub fn canopy(&self) -> Canopy {
        let Self { height_m, base_m, density_kg_m3, cover, .. } = *self;
        Canopy { height_m, base_m, bulk_density_kg_m3: density_kg_m3, cover }
    }
}

ranges! { CrownSettings {
    foliar_moisture: 0.3..=5.0, height_m: 0.0..=150.0, base_m: 0.0..=150.0, density_kg_m3: 0.0..=10.0, cover: 0.0..=1.0,
} }

/// The kinds of fire under trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FireType {
    /// It does not reach the crowns.
    Surface,
    /// It reaches them but is too slow to run through them: it torches single trees or groups.
    Passive,
    /// It would run through crowns but does not reach them from below: a surface fire unless it comes through crowns.
    Conditional,
    /// It runs through the crowns.
    Active,
}

wildfire_base::names! { FireType {
    Surface: "surface", Passive: "passive", Conditional: "conditional", Active: "active",
} }

impl FireType {
    /// Counts the cells of each type among numbers of types.
    pub fn tally(found: &[f64]) -> Members<&'static str, usize> {
        let count = |kind: Self| found.iter().filter(|&&number| number == f64::from(kind as u8)).count();
        Members(Self::ALL.map(|kind| (kind.name(), count(kind))).into())
    }
}

/// A surface fire and the trees above it.
#[derive(Clone, Copy, Debug)]
pub struct CrownConditions {
    pub canopy: Canopy,
    /// Moisture of leaves and needles as a fraction of the dry weight; below 0.3 it counts as 0.3.
    pub foliar_moisture: f64,
    /// The fuel on the ground, and fuel model 10 with the same moistures.
    pub ground: FuelBed,
    pub model_10: FuelBed,
    /// Of the wind at 20 ft above the trees.
    pub wind_20ft_mps: f64,
    /// Unit vector along which the wind blows.
    pub toward: DVec2,
    /// The part of that wind that the flames on the ground feel.
    pub wind_factor: f64,
    pub gradient: DVec2,
    pub options: SurfaceOptions,
    pub units: CrownUnits,
}

/// The fuel on the ground under trees.
#[derive(Clone, Copy, Debug)]
pub struct GroundFuel {
    pub bed: FuelBed,
    pub depth_ft: f64,
}

impl GroundFuel {
    pub fn new(model: &FuelModel, moisture: &FuelMoisture, curing: Curing) -> Self {
        Self { bed: FuelBed::new(model, moisture, curing), depth_ft: model.depth_ft }
    }
}

impl CrownConditions {
    /// Returns the conditions of a cell with trees in the wind at 10 m of a weather.
    pub fn in_weather(
        ground: GroundFuel,
        model_10: FuelBed,
        canopy: Canopy,
        wind_10m_mps: DVec2,
        gradient: DVec2,
        options: SurfaceOptions,
        rules: CrownRules,
    ) -> Self {
        let speed = (wind_10m_mps.x * wind_10m_mps.x + wind_10m_mps.y * wind_10m_mps.y).sqrt();
        Self {
            canopy,
            foliar_moisture: rules.foliar_moisture,
            ground: ground.bed,
            model_10,
            wind_20ft_mps: twenty_foot_wind(speed),
            toward: if speed > 0.0 { wind_10m_mps / speed } else { DVec2::ZERO },
            wind_factor: canopy.wind_adjustment(ground.depth_ft),
            gradient,
            options,
            units: CrownUnits::Exact,
        }
    }

    /// Returns the rate of the surface fire under a wind at 20 ft.
    fn surface(&self, wind_20ft_mps: f64) -> SurfaceFire {
        self.ground.behavior(self.toward * (wind_20ft_mps * self.wind_factor), self.gradient, &self.options)
    }

    /// Returns the rate of a fire that runs through the crowns: it depends on the weather alone.
    pub fn crown_rate_mps(&self) -> f64 {
        let unlimited = SurfaceOptions { wind_limit: WindLimit::None, ..self.options };
        let wind = self.toward * (CROWN_WIND_FACTOR * self.wind_20ft_mps);
        RATE_FACTOR * self.model_10.behavior(wind, DVec2::ZERO, &unlimited).rate_mps
    }

    /// Computes the surface fire, and what it would be in the crowns.
    pub fn burn(self) -> CrownFire {
        self.burn_at(self.crown_rate_mps())
    }

    /// Computes the same where the rate in the crowns is known.
    pub fn burn_at(self, rate_mps: f64) -> CrownFire {
        CrownFire { surface: self.surface(self.wind_20ft_mps), rate_mps, conditions: self }
    }
}

/// A fire as it spreads, and its type.
#[derive(Clone, Copy, Debug)]
pub struct SpreadingFire {
    pub fire: SurfaceFire,
    pub fire_type: FireType,
}

/// Computes the fire of a cell at a time as it spreads, in the crowns too where there are trees; `None` where nothing burns.
pub fn spreading_fire(
    landscape: &Landscape,
    weather: &Weather,
    options: &SurfaceOptions,
    crowns: Option<CrownRules>,
    cell: Cell,
    time: SimTime,
) -> Option<SpreadingFire> {
    let Some((rules, canopy)) = crowns.zip(landscape.canopy(cell)) else {
        let fire = surface_fire(landscape, weather, options, cell, time)?;
        return Some(SpreadingFire { fire, fire_type: FireType::Surface });
    };
    let model = landscape.burning_model(cell)?;
    let WeatherInterval { moisture, wind_mps, .. } = weather.at_cell(time, landscape.frame.index(cell));
    let ground = GroundFuel::new(model, &moisture, options.curing);
    let ten = model_10(&moisture, options.curing);
    let gradient = landscape.gradient(cell);
    let fire = CrownConditions::in_weather(ground, ten, canopy, wind_mps, gradient, *options, rules).burn();
    Some(SpreadingFire { fire: fire.spreading(rules.method), fire_type: fire.fire_type() })
}

/// How fast and how hot a fire is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FireHead {
    pub rate_mps: f64,
    /// Heat given off by a square metre.
    pub heat_kj_m2: f64,
    /// Power of a metre of front.
    pub intensity_kw_m: f64,
    /// Whether its flames are those of crowns.
    is_crown: bool,
}

impl FireHead {
    fn new(rate_mps: f64, heat_kj_m2: f64, is_crown: bool) -> Self {
        Self { rate_mps, heat_kj_m2, intensity_kw_m: rate_mps * heat_kj_m2, is_crown }
    }

    /// Returns the length of the flames: by Byram on the ground; in crowns 0.2 ft times the Btu/ft/s to the power of two
    /// thirds (Thomas, 1963).
    pub fn flame_m(&self) -> f64 {
        if self.is_crown {
            return 0.2 * FOOT_M * ops::pow(self.intensity_kw_m * 1000.0 / BTU_PER_FOOT, 2.0 / 3.0);
        }
        flame_length_m(self.intensity_kw_m)
    }
}

/// A surface fire below trees, and the crown fire that it may become. Rates of crown fires are on level ground.
#[derive(Clone, Copy, Debug)]
pub struct CrownFire {
    pub surface: SurfaceFire,
    /// The rate of a fire that runs through the crowns (Rothermel, 1991), whether this one does or not.
    pub rate_mps: f64,
    pub conditions: CrownConditions,
}

impl CrownFire {
    /// Returns the surface fire as it is without the crowns.
    pub fn surface_head(&self) -> FireHead {
        FireHead::new(self.surface.rate_mps, self.surface.heat_kj_m2(), false)
    }

    /// Returns the fire that runs through all crowns, whether this one does or not.
    pub fn crown_head(&self) -> FireHead {
        FireHead::new(self.rate_mps, self.surface.heat_kj_m2() + self.conditions.canopy.heat_kj_m2(), true)
    }

    /// Returns the least intensity of a surface fire that reaches the crowns: (0.010 z (460 + 25.9 m))^1.5 kW/m, z
    /// metres from the ground to the crowns, m foliar moisture in percent (Van Wagner, 1977).
    pub fn critical_intensity_kw_m(&self) -> f64 {
        let CrownConditions { canopy, foliar_moisture, units, .. } = &self.conditions;
        let moisture = 100.0 * foliar_moisture.max(MIN_FOLIAR_MOISTURE);
        let heat = 0.010 * canopy.base_m.max(MIN_BASE_M) * (460.0 + 25.9 * moisture);
        heat * heat.sqrt() * units.scales()[0]
    }

    /// Returns the least rate of a fire that runs through the crowns: infinite where there are none (Van Wagner, 1977).
    pub fn critical_rate_mps(&self) -> f64 {
        let CrownConditions { canopy, units, .. } = &self.conditions;
        CRITICAL_FLOW / 60.0 / canopy.bulk_density_kg_m3 * units.scales()[1]
    }

    /// Returns the intensity of the surface fire as a multiple of the one from which on it reaches the crowns.
    pub fn transition_ratio(&self) -> f64 {
        self.surface_head().intensity_kw_m / self.critical_intensity_kw_m()
    }

    /// Returns the rate in crowns as a multiple of the one from which on fire runs through them.
    pub fn active_ratio(&self) -> f64 {
        self.rate_mps / self.critical_rate_mps()
    }

    pub fn fire_type(&self) -> FireType {
        match (self.transition_ratio() >= 1.0, self.active_ratio() >= 1.0) {
            (false, false) => FireType::Surface,
            (true, false) => FireType::Passive,
            (false, true) => FireType::Conditional,
            (true, true) => FireType::Active,
        }
    }

    /// Returns the length of a crown fire by its width: one, plus an eighth for each mile per hour at 20 ft (Rothermel,
    /// 1991).
    pub fn length_to_width(&self) -> f64 {
        1.0 + 0.125 * (self.conditions.wind_20ft_mps / FOOT_PER_MINUTE / MILE_PER_HOUR)
    }

    /// Returns the area in m2 of a crown fire from a point after some seconds: an ellipse as long as the head came
    /// (Rothermel, 1991).
    pub fn area_m2(&self, seconds: f64) -> f64 {
        let length = self.rate_mps * seconds;
        PI * length * length / (4.0 * self.length_to_width())
    }

    /// Returns the length in metres of the edge of the same ellipse, as Rothermel approximates it.
    pub fn perimeter_m(&self, seconds: f64) -> f64 {
        0.5 * PI * self.rate_mps * seconds * (1.0 + 1.0 / self.length_to_width())
    }

    /// Returns the least wind at 20 ft with which fire runs through these crowns (Scott and Reinhardt, 2001); infinite
    /// where model 10 does not burn.
    pub fn crowning_wind_mps(&self) -> f64 {
        let bed = self.conditions.model_10;
        let factor = self.critical_rate_mps() / RATE_FACTOR / bed.r0_mps() - 1.0;
        // Crowns that burn faster than they need to in calm air ask for no wind, and a power of less than 0 is no number.
        bed.wind_of_factor(factor.max(0.0)) / CROWN_WIND_FACTOR
    }

    /// Returns the rate from which on the surface fire reaches the crowns; infinite where nothing burns on the ground.
    pub fn critical_surface_rate_mps(&self) -> f64 {
        self.critical_intensity_kw_m() / self.surface.heat_kj_m2()
    }

    /// Returns the rate of the surface fire in the crowning wind; infinite where that is.
    pub fn crowning_surface_rate_mps(&self) -> f64 {
        let wind = self.crowning_wind_mps();
        if wind.is_finite() { self.conditions.surface(wind).rate_mps } else { f64::INFINITY }
    }

    /// Returns the part of the crowns that burns, in [0, 1]: how far the surface rate has come from the one at which fire
    /// reaches the crowns to the one at which it runs through them (Scott and Reinhardt, 2001).
    pub fn fraction_burned(&self) -> f64 {
        let critical = self.critical_surface_rate_mps();
        let span = self.crowning_surface_rate_mps() - critical;
        if span > 0.0 && span.is_finite() { ((self.surface.rate_mps - critical) / span).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Returns the fire that burns a part of the crowns (Scott and Reinhardt, 2001), whether this one does or not.
    pub fn passive_head(&self) -> FireHead {
        let ground = self.surface_head();
        let fraction = self.fraction_burned();
        let rate = ground.rate_mps + fraction * (self.rate_mps - ground.rate_mps);
        FireHead::new(rate, ground.heat_kj_m2 + fraction * self.conditions.canopy.heat_kj_m2(), true)
    }

    /// Returns the fire as it spreads, with the heat of the crowns that burn. Below the rate of active crown fires it has the
    /// shape and the heading of the surface fire; those run with the wind, in the shape of crown fires, along the slope.
    pub fn spreading(&self, method: CrownMethod) -> SurfaceFire {
        let surface = self.surface;
        let toward = self.conditions.toward;
        let kind = self.fire_type();
        if matches!(kind, FireType::Surface | FireType::Conditional) {
            return surface;
        }
        let FireHead { rate_mps, heat_kj_m2, .. } = self.head(method);
        // So that `heat_kj_m2`, the product with the residence time, is the heat of the whole fire.
        let fire = SurfaceFire { rate_mps, reaction_intensity_kw_m2: heat_kj_m2 / surface.residence_s, ..surface };
        // Without wind a crown fire has no direction of its own.
        if kind == FireType::Passive || toward == DVec2::ZERO {
            return fire;
        }
        let length_to_width = self.length_to_width();
        let eccentricity = (length_to_width * length_to_width - 1.0).sqrt() / length_to_width;
        SurfaceFire { heading: unit(lift(toward, surface.gradient)), length_to_width, eccentricity, ..fire }
    }

    /// Returns the fire as it is, by one of both methods.
    pub fn head(&self, method: CrownMethod) -> FireHead {
        match (self.fire_type(), method) {
            (FireType::Surface | FireType::Conditional, _) => self.surface_head(),
            (FireType::Passive, CrownMethod::ScottReinhardt) => self.passive_head(),
            (FireType::Passive, CrownMethod::Rothermel) => {
                FireHead { rate_mps: self.surface.rate_mps, ..self.crown_head() }
            }
            (FireType::Active, _) => self.crown_head(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Combine;

    const PINES: Canopy = Canopy { height_m: 20.0, base_m: 1.5, bulk_density_kg_m3: 0.2, cover: 0.6 };

    fn conditions(fuel: &str, canopy: Canopy, wind_20ft_mps: f64) -> CrownConditions {
        let model = FuelModel::by_name(fuel).expect("it is one");
        let moisture = FuelMoisture::default();
        CrownConditions {
            canopy,
            foliar_moisture: 1.0,
            ground: FuelBed::new(model, &moisture, Curing::Behave),
            model_10: model_10(&moisture, Curing::Behave),
            wind_20ft_mps,
            toward: DVec2::X,
            wind_factor: canopy.wind_adjustment(1.0),
            gradient: DVec2::X * 0.1,
            options: SurfaceOptions { combine: Combine::Flat, ..SurfaceOptions::default() },
            units: CrownUnits::Exact,
        }
    }

    fn is_near(found: f64, expected: f64) -> bool {
        (found / expected - 1.0).abs() < 1e-9
    }

    #[test]
    fn criteria_and_heat_are_as_computed_by_hand() {
        let fire = conditions("TU5", PINES, 8.0).burn();
        // (0.010 x 1.5 x (460 + 2590))^1.5, and 3 / 0.2 m/min.
        assert!(is_near(fire.critical_intensity_kw_m(), 309.447_264_287_471_1));
        assert!(is_near(fire.critical_rate_mps() * 60.0, 15.0));
        // 0.2 x 18.5 kg/m2 with 8000 Btu/lb.
        assert!(is_near(fire.conditions.canopy.heat_kj_m2(), 3.7 * 18_608.0));
        // 8 m/s are 17.9 mph; the area is pi / 4 of the length times the width.
        let length = fire.rate_mps * 60.0;
        let ratio = 1.0 + 0.125 * 8.0 / 0.44704;
        assert!(
            is_near(fire.length_to_width(), ratio) && is_near(fire.area_m2(60.0), PI / 4.0 * length * length / ratio)
        );
        // 1000 Btu/ft/s have flames of 20 ft.
        assert!(is_near(FireHead::new(BTU_PER_FOOT, 1.0, true).flame_m(), 20.0 * FOOT_M));
        // Nothing is drier or lower than the least: (0.010 x 0.1 x (460 + 777))^1.5.
        let canopy = Canopy { base_m: 0.0, ..PINES };
        let low = CrownConditions { foliar_moisture: 0.1, canopy, ..fire.conditions };
        assert!(is_near(low.burn().critical_intensity_kw_m(), 1.375_797_606_117_993));
    }

    #[test]
    fn crowns_burn_as_fast_as_model_10_whatever_the_ground() {
        let unlimited = SurfaceOptions { wind_limit: WindLimit::None, ..SurfaceOptions::default() };
        for fuel in ["TU5", "GR2", "R10"] {
            let fire = conditions(fuel, PINES, 8.0).burn();
            let ten = fire.conditions.model_10.behavior(DVec2::Y * 3.2, DVec2::ZERO, &unlimited);
            assert_eq!(fire.rate_mps, 3.34 * ten.rate_mps, "{fuel}");
            // In the crowning wind they are just fast enough.
            let crowning = CrownConditions { wind_20ft_mps: fire.crowning_wind_mps(), ..fire.conditions }.burn();
            assert!(is_near(crowning.active_ratio(), 1.0), "{fuel}");
            assert!(is_near(crowning.surface.rate_mps, fire.crowning_surface_rate_mps()), "{fuel}");
        }
    }

    #[test]
    fn types_follow_from_both_criteria_and_rates_rise_with_the_wind() {
        let high = Canopy { base_m: 12.0, ..PINES };
        let thin = Canopy { bulk_density_kg_m3: 0.02, ..PINES };
        let types = [("TL8", high, 1.0), ("TU5", thin, 8.0), ("TL8", high, 8.0), ("TU5", PINES, 8.0)]
            .map(|(fuel, canopy, wind)| conditions(fuel, canopy, wind).burn().fire_type());
        assert_eq!(types, FireType::ALL);
        let mut before = [0.0; 2];
        for halves in 0..60 {
            let fire = conditions("TU5", Canopy { base_m: 1.0, ..PINES }, 0.5 * f64::from(halves)).burn();
            let ground = fire.surface_head();
            let crown = fire.crown_head();
            let rates = [CrownMethod::ScottReinhardt, CrownMethod::Rothermel].map(|method| fire.head(method).rate_mps);
            match fire.fire_type() {
                FireType::Surface | FireType::Conditional => assert_eq!(rates, [ground.rate_mps; 2]),
                FireType::Passive => assert_eq!(rates[1], ground.rate_mps),
                FireType::Active => assert_eq!(rates, [crown.rate_mps; 2]),
            }
            assert!(rates[0] >= before[0] && rates[1] >= before[1], "{halves}: {before:?}, {rates:?}");
            before = rates;
        }
    }

    #[test]
    fn trees_shelter_by_the_space_that_crowns_fill() {
        let factor = |canopy: Canopy| canopy.wind_adjustment(1.0);
        assert_eq!(Some(factor(Canopy { base_m: 10.0, ..PINES })), sheltered_adjustment(20.0 / FOOT_M, 0.3));
        for open in [Canopy { cover: 0.1, ..PINES }, Canopy { height_m: 0.0, base_m: 0.0, ..PINES }] {
            assert_eq!(factor(open), unsheltered_adjustment(1.0));
        }
    }

    #[test]
    fn fuel_that_is_too_wet_to_burn_lights_no_crowns() {
        let wet = FuelMoisture { d1: 0.4, d10: 0.4, d100: 0.4, herb: 3.0, woody: 3.0 };
        let wet = model_10(&wet, Curing::Exact);
        let fire = CrownConditions { ground: wet, model_10: wet, ..conditions("R10", PINES, 9.0) }.burn();
        assert_eq!((fire.fire_type(), fire.head(CrownMethod::Rothermel).rate_mps), (FireType::Surface, 0.0));
        assert_eq!((fire.crowning_wind_mps(), fire.fraction_burned()), (f64::INFINITY, 0.0));
        assert_eq!([fire.critical_surface_rate_mps(), fire.crowning_surface_rate_mps()], [f64::INFINITY; 2]);
    }
}
