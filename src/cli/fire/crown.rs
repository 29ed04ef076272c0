//! Trees above a fire for `wildfire fire behavior`, and `wildfire fire crown`: a table of surface fires below trees in, the
//! same with what they do in the crowns out.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use clap::Args;
use clap::builder::TypedValueParser;
use serde::Serialize;

use super::calculators::{TableArguments, number};
use super::conditions::fuel_model;
use super::options::{AZIMUTHS_DEG, DEAD_MOISTURES, LIVE_MOISTURES};
use crate::cli::error::CliError;
use crate::cli::number_table::{Column, Columns, Content, NumberTable};
use crate::cli::numbers;
use wildfire_base::document::Table;
use wildfire_base::document::number::{percent, rounded, short};
use wildfire_base::geometry::{DVec2, compass, ops};
use wildfire_base::object;
use wildfire_base::object::Members;
use wildfire_fire::surface::crown::{
    Canopy, CrownConditions, CrownFire, CrownMethod, CrownUnits, FireHead, FireType, model_10,
};
use wildfire_fire::surface::{Combine, Curing, FuelBed, FuelMoisture, SurfaceOptions, WindLimit, flame_length_m};

pub const HEIGHTS_M: RangeInclusive<f64> = 0.0..=150.0;
pub const DENSITIES_KG_M3: RangeInclusive<f64> = 0.0..=10.0;
pub const SHARES: RangeInclusive<f64> = 0.0..=1.0;

/// Trees that are alike everywhere.
#[derive(Clone, Copy, Debug, Args)]
pub struct TreeArguments {
    /// Height of trees above the fuel in metres, for the crown fire [default: no trees].
    #[arg(help_heading = "Trees", long, value_name = "METRES", value_parser = within(HEIGHTS_M, "metres"))]
    pub canopy_height: Option<f64>,
    /// Height in metres at which crowns begin.
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "METRES", default_value = "2", value_parser = within(HEIGHTS_M, "metres"))]
    pub canopy_base: f64,
    /// Mass of fuel in the crowns by volume.
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "KG/M3", default_value = "0.1", value_parser = within(DENSITIES_KG_M3, "kg/m3"))]
    pub canopy_density: f64,
    /// Part of the ground below crowns.
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "SHARE", default_value = "0.5", value_parser = within(SHARES, "a share"))]
    pub canopy_cover: f64,
    /// Moisture of leaves and needles as a fraction of the dry weight; less than 0.3 counts as 0.3.
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "SHARE", default_value = "1", value_parser = within(LIVE_MOISTURES, "a fraction"))]
    pub foliar_moisture: f64,
}

/// Reads a number that lies in a range.
pub fn within(range: RangeInclusive<f64>, what: &'static str) -> impl TypedValueParser<Value = f64> {
    move |text: &str| numbers::parse_within(text, &range, what)
}

impl TreeArguments {
    /// Returns the trees; `None` if there are none.
    pub fn canopy(&self) -> Option<Canopy> {
        let Self { canopy_base: base_m, canopy_density: bulk_density_kg_m3, canopy_cover: cover, .. } = *self;
        Some(Canopy { height_m: self.canopy_height?, base_m, bulk_density_kg_m3, cover })
    }
}

/// Returns the fires of a report, by their names in JSON and in text.
fn heads(fire: &CrownFire) -> [(&'static str, &'static str, FireHead); 4] {
    [
        ("surface", "Surface fire alone", fire.surface_head()),
        ("all_crowns", "In all crowns", fire.crown_head()),
        ("scott_reinhardt", "This fire (Scott and Reinhardt)", fire.head(CrownMethod::ScottReinhardt)),
        ("rothermel", "This fire (Rothermel)", fire.head(CrownMethod::Rothermel)),
    ]
}

/// Returns the fires on the ground and in the crowns.
pub fn heads_table(fire: &CrownFire) -> Table {
    let rows = heads(fire).map(|(_, name, head)| {
        let FireHead { rate_mps, heat_kj_m2, intensity_kw_m, .. } = head;
        let numbers = [(rate_mps * 60.0, 2), (heat_kj_m2, 0), (intensity_kw_m, 0), (head.flame_m(), 2)];
        let numbers = numbers.map(|(number, decimals)| rounded(number, decimals));
        [vec![name.to_owned()], numbers.to_vec()].concat()
    });
    let headings = ["Fire", "Rate\nm/min", "Heat\nkJ/m2", "Intensity\nkW/m", "Flames\nm"];
    Table::new(&headings, rows.into())
}

/// Describes the trees and the kind of fire below them.
pub fn sentences(fire: &CrownFire) -> Vec<String> {
    let CrownConditions { canopy, foliar_moisture, .. } = fire.conditions;
    let [height, base, density] = [canopy.height_m, canopy.base_m, canopy.bulk_density_kg_m3].map(short);
    let [cover, foliar] = [canopy.cover, foliar_moisture].map(|part| short(100.0 * part));
    let kind = match fire.fire_type() {
        FireType::Surface => "Surface fire".to_owned(),
        FireType::Passive => format!("Passive crown fire: {} % of the crowns burn", percent(fire.fraction_burned())),
        FireType::Conditional => "Surface fire, or a crown fire if it comes through crowns".to_owned(),
        FireType::Active => "Active crown fire".to_owned(),
    };
    let [transition, active] = [fire.transition_ratio(), fire.active_ratio()].map(|ratio| rounded(ratio, 2));
    let intensity = rounded(fire.critical_intensity_kw_m(), 0);
    let rate = rounded(fire.critical_rate_mps() * 60.0, 2);
    // It is infinite where model 10 does not burn: no wind is enough then.
    let wind = Some(fire.crowning_wind_mps()).filter(|wind| wind.is_finite());
    let wind = wind.map(|wind| format!("; a wind of {} m/s at 20 ft is enough for that", rounded(wind, 2)));
    vec![
        format!(
            "Trees of {height} m, crowns from {base} m up, {density} kg/m3, over {cover} % of the ground; moisture of \
             foliage {foliar} %"
        ),
        kind,
        format!("The surface fire has {transition} times the intensity that reaches the crowns, {intensity} kW/m"),
        format!(
            "A crown fire has {active} times the rate at which it runs from crown to crown, {rate} m/min{}",
            wind.unwrap_or_default()
        ),
    ]
}

/// Returns the crown fire as an object.
pub fn object(fire: &CrownFire) -> impl Serialize {
    let heads = heads(fire).map(|(name, _, head)| {
        let FireHead { rate_mps, heat_kj_m2, intensity_kw_m, .. } = head;
        (name, object!(Head { r_m_min: rate_mps * 60.0, heat_kj_m2, intensity_kw_m, flame_m: head.flame_m() }))
    });
    object!(Crown {
        canopy: fire.conditions.canopy,
        foliar_moisture: fire.conditions.foliar_moisture,
        wind_20ft_mps: fire.conditions.wind_20ft_mps,
        fire_type: fire.fire_type(),
        critical_intensity_kw_m: fire.critical_intensity_kw_m(),
        critical_crown_m_min: fire.critical_rate_mps() * 60.0,
        // Null where model 10 does not burn.
        crowning_wind_20ft_mps: fire.crowning_wind_mps(),
        crown_fraction_burned: fire.fraction_burned(),
        #[serde(flatten)]
        heads: Members(heads.into()),
    })
}

pub const CROWN_TABLE: &str = "\
IN.csv has the columns fuel_model, moisture_1h_pct, moisture_10h_pct, moisture_100h_pct, moisture_live_herb_pct, \
moisture_live_woody_pct, moisture_foliar_pct, wind_20ft_mi_h, wind_to_deg_from_upslope, slope_deg, canopy_cover_pct, \
canopy_height_ft, canopy_base_height_ft and canopy_bulk_density_lb_ft3, and optionally waf_input: the part of the 20-ft \
wind at the flames, or `computed`. OUT.csv adds 36 columns whose names begin with wildfire_ and end with their units; fire \
types are 0 surface, 1 passive, 2 conditional, 3 active. Choices and unit factors are BEHAVE's.

Example:
  wildfire fire crown --csv in.csv --out out.csv";

/// The place of a column among those that are read.
const FACTOR: usize = 14;

pub fn run(table: &TableArguments, quiet: bool) -> Result<(), CliError> {
    let heights_ft = HEIGHTS_M.start() / FOOT_M..=HEIGHTS_M.end() / FOOT_M;
    let read = [
        number("fuel_model", 0.0..=255.0),
        number("moisture_1h_pct", percents(DEAD_MOISTURES)),
        number("moisture_10h_pct", percents(DEAD_MOISTURES)),
        number("moisture_100h_pct", percents(DEAD_MOISTURES)),
        number("moisture_live_herb_pct", percents(LIVE_MOISTURES)),
        number("moisture_live_woody_pct", percents(LIVE_MOISTURES)),
        number("moisture_foliar_pct", percents(LIVE_MOISTURES)),
        number("wind_20ft_mi_h", 0.0..=200.0),
        number("wind_to_deg_from_upslope", AZIMUTHS_DEG),
        number("slope_deg", 0.0..=STEEPEST_DEG),
        number("canopy_cover_pct", percents(SHARES)),
        number("canopy_height_ft", heights_ft.clone()),
        number("canopy_base_height_ft", heights_ft),
        number("canopy_bulk_density_lb_ft3", 0.0..=1.0),
        Column { name: "waf_input", content: Content::Text, without: Some(f64::NAN) },
    ];
    let added = &ADDED.split(',').collect::<Vec<_>>();
    let columns = Columns { read, row: "the conditions of a fire below trees", added };
    table.answer(columns, quiet, |table, numbers| Ok(answers(&row(table, numbers)?.burn())))
}

fn percents(range: RangeInclusive<f64>) -> RangeInclusive<f64> {
    range.start() * 100.0..=range.end() * 100.0
}

/// Factors of the columns of tables, which are in feet, pounds, Btu and minutes.
const FOOT_M: f64 = 0.3048;
const MILE_M: f64 = 5280.0 * FOOT_M;
const FOOT_PER_MINUTE: f64 = FOOT_M / 60.0;
const POUND_PER_FOOT2: f64 = 0.453_592_37 / (FOOT_M * FOOT_M);
const BTU_PER_FOOT: f64 = 1.055_055_852_62 / FOOT_M;
const BTU_PER_FOOT2: f64 = BTU_PER_FOOT / FOOT_M;
const ACRE_M2: f64 = 43_560.0 * FOOT_M * FOOT_M;
const CHAIN_M: f64 = 66.0 * FOOT_M;
const HOUR_S: f64 = 3600.0;
/// Degrees of the steepest slope, about 5 of rise over run.
const STEEPEST_DEG: f64 = 78.69;

/// The columns that are added, in the order of [`answers`]: four for each of five fires, then the others.
const ADDED: &str = "\
wildfire_surface_ros_ft_min,wildfire_surface_hpua_btu_ft2,wildfire_surface_intensity_btu_ft_s,wildfire_surface_flame_ft,\
wildfire_crown_ros_ft_min,wildfire_crown_hpua_btu_ft2,wildfire_crown_intensity_btu_ft_s,wildfire_crown_flame_ft,\
wildfire_passive_ros_ft_min,wildfire_passive_hpua_btu_ft2,wildfire_passive_intensity_btu_ft_s,wildfire_passive_flame_ft,\
wildfire_rothermel_final_ros_ft_min,wildfire_rothermel_final_hpua_btu_ft2,\
wildfire_rothermel_final_intensity_btu_ft_s,wildfire_rothermel_final_flame_ft,\
wildfire_scott_final_ros_ft_min,wildfire_scott_final_hpua_btu_ft2,\
wildfire_scott_final_intensity_btu_ft_s,wildfire_scott_final_flame_ft,\
wildfire_midflame_wind_ft_min,wildfire_crown_fuel_load_lb_ft2,wildfire_canopy_hpua_btu_ft2,\
wildfire_crown_length_to_width,wildfire_crown_area_1h_acre,wildfire_crown_perimeter_1h_ch,\
wildfire_critical_surface_intensity_btu_ft_s,wildfire_critical_surface_flame_ft,wildfire_critical_crown_ros_ft_min,\
wildfire_transition_ratio,wildfire_active_ratio,wildfire_fire_type,wildfire_crowning_wind_20ft_ft_min,\
wildfire_critical_surface_ros_ft_min,wildfire_crowning_surface_ros_ft_min,wildfire_crown_fraction_burned";

fn answers(fire: &CrownFire) -> String {
    let CrownConditions { canopy, wind_20ft_mps, wind_factor, .. } = fire.conditions;
    let critical = fire.critical_intensity_kw_m();
    let [rothermel, scott] = [CrownMethod::Rothermel, CrownMethod::ScottReinhardt].map(|method| fire.head(method));
    let heads = [fire.surface_head(), fire.crown_head(), fire.passive_head(), rothermel, scott].map(|head| {
        let FireHead { rate_mps, heat_kj_m2, intensity_kw_m, .. } = head;
        let flame_ft = head.flame_m() / FOOT_M;
        [rate_mps / FOOT_PER_MINUTE, heat_kj_m2 / BTU_PER_FOOT2, intensity_kw_m / BTU_PER_FOOT, flame_ft]
    });
    let others = [
        wind_20ft_mps * wind_factor / FOOT_PER_MINUTE,
        canopy.load_kg_m2() / POUND_PER_FOOT2,
        canopy.heat_kj_m2() / BTU_PER_FOOT2,
        fire.length_to_width(),
        fire.area_m2(HOUR_S) / ACRE_M2,
        fire.perimeter_m(HOUR_S) / CHAIN_M,
        critical / BTU_PER_FOOT,
        flame_length_m(critical) / FOOT_M,
        fire.critical_rate_mps() / FOOT_PER_MINUTE,
        fire.transition_ratio(),
        fire.active_ratio(),
        f64::from(fire.fire_type() as u8),
        fire.crowning_wind_mps() / FOOT_PER_MINUTE,
        fire.critical_surface_rate_mps() / FOOT_PER_MINUTE,
        fire.crowning_surface_rate_mps() / FOOT_PER_MINUTE,
        fire.fraction_burned(),
    ];
    [heads.as_flattened(), &others].concat().iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

/// Reads the conditions of a row; north is upslope.
fn row(table: &NumberTable<15>, numbers: &[f64; 15]) -> Result<CrownConditions, CliError> {
    // The last number is that of `waf_input`, which is read as a text.
    let &[number, d1, d10, d100, herb, woody, foliar, wind, toward, slope, cover, height, base, density, _] = numbers;
    let model = fuel_model(table, 0, number)?;
    let [d1, d10, d100, herb, woody] = [d1, d10, d100, herb, woody].map(|percent| percent / 100.0);
    let moisture = FuelMoisture { d1, d10, d100, herb, woody };
    let canopy = Canopy {
        height_m: height * FOOT_M,
        base_m: base * FOOT_M,
        bulk_density_kg_m3: density * POUND_PER_FOOT2 / FOOT_M,
        cover: cover / 100.0,
    };
    let wind_factor = match &*table.text(FACTOR) {
        "" | "computed" => canopy.wind_adjustment(model.depth_ft),
        text => numbers::within(text, &SHARES)
            .ok_or_else(|| table.refuse(FACTOR, "a number from 0 to 1, or `computed`".to_owned()))?,
    };
    let options = SurfaceOptions {
        // These are the options of BEHAVE, whose answers these tables are compared with.
        curing: Curing::Behave,
        combine: Combine::Flat,
        wind_limit: WindLimit::None,
        ..SurfaceOptions::default()
    };
    Ok(CrownConditions {
        canopy,
        foliar_moisture: foliar / 100.0,
        ground: FuelBed::new(model, &moisture, options.curing),
        model_10: model_10(&moisture, options.curing),
        wind_20ft_mps: wind * MILE_M / HOUR_S,
        toward: compass::unit_toward(toward),
        wind_factor,
        gradient: DVec2::Y * ops::tan(slope / 360.0 * TAU),
        options,
        units: CrownUnits::Behave,
    })
}
