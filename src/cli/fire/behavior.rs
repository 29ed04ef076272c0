//! `wildfire fire behavior`: what a fire does under one set of conditions, or under many from a table.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use clap::builder::ArgPredicate;
use clap::{ArgGroup, Args, ValueEnum};
use serde::{Serialize, Serializer};

use super::conditions::{self, Conditions, DIRECTION_COLUMNS, FIRE_COLUMNS, direction, moisture_text};
use super::crown::{self, TreeArguments};
use super::options::{ChoiceArguments, SlopeArguments, Wind, azimuth, fuel, moisture, wind};
use crate::cli::error::CliError;
use crate::cli::output_files::{Files, Format};
use crate::cli::report::FormArguments;
use crate::cli::terminal;
use wildfire_base::document::number::{count, percent, rounded, short};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::geometry::compass;
use wildfire_base::input_file::is_standard_stream;
use wildfire_base::object;
use wildfire_base::object::Members;
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_fire::fuel::{FUEL_MODELS, FuelModel};
use wildfire_fire::surface::crown::{CrownConditions, CrownFire, CrownUnits, model_10};
use wildfire_fire::surface::{
    FuelBed, FuelMoisture, FuelState, SurfaceFire, SurfaceOptions, flame_length_m, twenty_foot_wind,
    unsheltered_adjustment,
};

/// Where a wind comes from that is given by its speed alone.
const USUAL_WIND_FROM_DEG: f64 = 270.0;

/// The range of the number of azimuths.
const AZIMUTHS: RangeInclusive<usize> = 1..=3600;

#[derive(Debug, Args)]
#[command(
    group = ArgGroup::new("what").args(["fuel", "conditions", "list_fuels"]).required(true),
    after_help = "\
Directions are compass azimuths: degrees clockwise from north. A wind from 270 \
blows to the east; a slope of aspect 180 goes up to the north. Rates are along \
the slope.

IN.csv has the columns number,m_1h,m_10h,m_100h,m_live_herb,m_live_woody,\
wind_midflame_mps,wind_from_deg,slope_rise_run,aspect_deg in any order among others, and optionally wind_limit: 1 for \
rothermel-1972, 0 for none. OUT.csv has all columns of IN.csv, followed by r0_m_min,i0_kw_m,r_m_min,azimuth_deg,\
intensity_kw_m,flame_m,length_to_width,eccentricity; with --azimuths it has a row for each azimuth, with \
azimuth_of_deg,front_normal_m_min,ray_m_min,\
ray_horizontal_m_min.

Examples:
  wildfire fire behavior --fuel GR2 --wind 5@270
  wildfire fire behavior --fuel SH5 --wind 12@200 --wind-height 10m --slope 0.3 --format json
  wildfire fire behavior --fuel 102 --wind 3 --azimuths 0,45,...
  wildfire fire behavior --fuel TU5 --wind 9@270 --canopy-height 20 --canopy-base 1.5 --canopy-density 0.05
  wildfire fire behavior --conditions in.csv --csv out.csv --combine flat
  wildfire fire behavior --list-fuels"
)]
pub struct BehaviorArguments {
    /// Code or number of a fuel model.
    #[arg(long, value_name = "NAME", value_parser = fuel)]
    pub fuel: Option<&'static FuelModel>,
    /// Moistures as fractions of the dry weight: dead 1-h, 10-h and 100-h, live herbaceous, live woody.
    #[arg(
        long,
        value_name = "D1,D10,D100,HERB,WOODY",
        default_value = "0.06,0.07,0.08,0.60,0.90",
        allow_hyphen_values = true,
        value_parser = moisture
    )]
    pub moisture: FuelMoisture,
    /// Wind at mid-flame height, or at --wind-height: speed in m/s and the azimuth it blows from, such as 5@270
    /// [default azimuth: 270].
    #[arg(long, value_name = "M/S@FROM", default_value = "0", allow_hyphen_values = true, value_parser = wind)]
    pub wind: Wind,
    /// Azimuth the wind blows from, if --wind gives only a speed.
    #[arg(long, hide = true, value_name = "AZIMUTH", allow_hyphen_values = true, value_parser = azimuth)]
    pub wind_from: Option<f64>,
    /// Height of --wind; a wind at 20 ft or 10 m is reduced to mid-flame height, for unsheltered ground or below the
    /// trees [default with trees: 20ft].
    #[arg(
        long,
        value_enum,
        value_name = "HEIGHT",
        default_value = "midflame",
        default_value_if("canopy_height", ArgPredicate::IsPresent, "20ft")
    )]
    pub wind_height: WindHeight,
    #[command(flatten)]
    pub slope: SlopeArguments,
    #[command(flatten)]
    pub trees: TreeArguments,
    /// Azimuths to compute rates for, such as 0,90,200; `0,5,...` continues in equal steps to the full circle.
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, value_parser = azimuths)]
    pub azimuths: Option<Azimuths>,
    #[command(flatten)]
    pub choices: ChoiceArguments,
    /// CSV file with the conditions of many fires, for --csv.
    #[arg(
        long,
        value_name = "IN.csv",
        requires = "csv",
        conflicts_with_all = ["report_form", "moisture", "wind", "wind_from", "wind_height", "slope", "aspect", "canopy_height"]
    )]
    pub conditions: Option<PathBuf>,
    /// Write the conditions and the resulting fires.
    #[arg(long, value_name = "OUT.csv", requires = "conditions")]
    pub csv: Option<PathBuf>,
    /// Print the fuel models.
    #[arg(long)]
    pub list_fuels: bool,
    #[command(flatten)]
    pub form: FormArguments,
}

impl BehaviorArguments {
    fn azimuths(&self) -> &[f64] {
        self.azimuths.as_ref().map_or(&[], |azimuths| &azimuths.0)
    }
}

/// Height at which a wind is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WindHeight {
    /// Mid-flame height.
    Midflame,
    /// 20 ft above the vegetation, as fire weather stations measure.
    #[value(name = "20ft")]
    TwentyFeet,
    /// 10 m above the ground, as other weather stations measure.
    #[value(name = "10m")]
    TenMetres,
}

impl WindHeight {
    /// Returns the part of such a wind that the flames feel, by that of a wind at 20 ft.
    fn factor(self, adjustment: f64) -> f64 {
        match self {
            Self::Midflame => 1.0,
            Self::TwentyFeet => adjustment,
            Self::TenMetres => adjustment * twenty_foot_wind(1.0),
        }
    }
}

/// Azimuths in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Azimuths(Vec<f64>);

/// Reads azimuths; `0,5,...` goes on from 5 in steps of 5 until less than 360 are passed.
fn azimuths(text: &str) -> Result<Azimuths, String> {
    let (listed, goes_on) = match text.strip_suffix(",...") {
        Some(listed) => (listed, true),
        None => (text, false),
    };
    let mut degrees = listed.split(',').map(azimuth).collect::<Result<Vec<f64>, String>>()?;
    if goes_on {
        let (first, &[.., before, last]) = (degrees[0], &degrees[..]) else {
            return Err("expected two azimuths before the three points, such as 0,5,...".to_owned());
        };
        let step = last - before;
        // Steps that shrink or repeat would go on forever; below 0.1 degrees the limit of 3600 is passed.
        if step.is_nan() || step < 0.1 {
            return Err("expected azimuths that rise by 0.1 degrees or more before the three points".to_owned());
        }
        let more = (1..=*AZIMUTHS.end()).map(|steps| last + step * steps as f64);
        // A full turn ends before its first azimuth, which would be listed twice; rounding must not let it in.
        degrees.extend(more.take_while(|degrees| degrees - first < 360.0 - 1e-9));
    }
    if !AZIMUTHS.contains(&degrees.len()) {
        return Err(format!("found {} azimuths, expected at most {}", degrees.len(), AZIMUTHS.end()));
    }
    Ok(Azimuths(degrees))
}

pub fn run(arguments: &BehaviorArguments, quiet: bool) -> Result<(), CliError> {
    if let (Some(from_deg), Some(_)) = (arguments.wind.from_deg, arguments.wind_from) {
        let sentence = format!("--wind already gives the azimuth {from_deg}; expected no --wind-from");
        return Err(CliError::bad_input(sentence, None));
    }
    if arguments.trees.canopy_height.is_some() && arguments.wind_height == WindHeight::Midflame {
        let sentence = "--wind-height is midflame; expected 20ft or 10m with --canopy-height: above the trees";
        return Err(CliError::bad_input(sentence, None));
    }
    match (arguments.fuel, &arguments.conditions, &arguments.csv) {
        (_, Some(conditions), Some(csv)) => write_fires(conditions, csv, arguments, quiet),
        (Some(model), ..) => terminal::print(&arguments.form.render(&BehaviorReport::new(model, arguments))),
        _ => terminal::print(&arguments.form.render(&FuelList)),
    }
}

fn write_fires(input: &Path, csv: &Path, arguments: &BehaviorArguments, quiet: bool) -> Result<(), CliError> {
    Files { inputs: vec![input], outputs: vec![(Format::Csv, csv)], ..Files::default() }.check()?;
    let [rows, without_fire] = conditions::write_fires(input, csv, &arguments.choices.options(), arguments.azimuths())?;
    if !quiet && !is_standard_stream(csv) {
        let out = if without_fire == 0 {
            String::new()
        } else {
            format!(
                "; the fire goes out in {without_fire} of \
            them"
            )
        };
        terminal::note(&format!("wrote {}: conditions of {rows} fires{out}", csv.display()));
    }
    Ok(())
}

/// A fire under one set of conditions.
struct BehaviorReport<'a> {
    conditions: Conditions,
    options: SurfaceOptions,
    bed: FuelBed,
    fire: SurfaceFire,
    /// The same below trees, where there are any.
    crown: Option<CrownFire>,
    azimuths: &'a [f64],
}

impl<'a> BehaviorReport<'a> {
    fn new(model: &'static FuelModel, arguments: &'a BehaviorArguments) -> Self {
        let options = arguments.choices.options();
        let canopy = arguments.trees.canopy();
        let wind_factor = canopy
            // Without trees the wind at mid-flame height depends on the depth of the fuel alone.
            .map_or_else(|| unsheltered_adjustment(model.depth_ft), |canopy| canopy.wind_adjustment(model.depth_ft));
        let conditions = Conditions {
            model,
            moisture: arguments.moisture,
            wind_midflame_mps: arguments.wind.speed_mps * arguments.wind_height.factor(wind_factor),
            wind_from_deg: arguments.wind.from_deg.or(arguments.wind_from).unwrap_or(USUAL_WIND_FROM_DEG),
            slope: arguments.slope,
        };
        let bed = conditions.bed(&options);
        let fire = conditions.burn(&options);
        let crown = canopy.map(|canopy| {
            let below = CrownConditions {
                canopy,
                foliar_moisture: arguments.trees.foliar_moisture,
                ground: bed,
                model_10: model_10(&arguments.moisture, options.curing),
                wind_20ft_mps: arguments.wind.speed_mps * arguments.wind_height.factor(1.0),
                toward: compass::unit_from(conditions.wind_from_deg),
                wind_factor,
                gradient: conditions.slope.gradient(),
                options,
                // Units are exact: those of BEHAVE are rounded, for tables that are compared with it.
                units: CrownUnits::Exact,
            };
            below.burn()
        });
        Self { conditions, options, bed, fire, crown, azimuths: arguments.azimuths() }
    }

    fn conditions(&self) -> Vec<String> {
        let Conditions { moisture, wind_midflame_mps, wind_from_deg, slope, .. } = &self.conditions;
        let wind = match *wind_midflame_mps {
            0.0 => "No wind".to_owned(),
            speed => format!("Wind of {} m/s at the flames, from {}", short(speed), short(*wind_from_deg)),
        };
        let uphill_deg = compass::azimuth_deg(slope.gradient());
        let slope = match slope.slope {
            0.0 => "level ground".to_owned(),
            slope => format!("slope of {} %, uphill to {}", short(100.0 * slope), short(uphill_deg)),
        };
        vec![format!("{wind}; {slope}"), moisture_text(moisture)]
    }

    /// Says why nothing burns, or what its numbers leave out.
    fn remarks(&self) -> Vec<String> {
        if !self.conditions.model.burns() {
            return vec!["Nothing burns: there is no fuel".to_owned()];
        }
        let states = [("dead", self.bed.dead), ("live", self.bed.live)];
        let wet = states.iter().filter_map(|&(name, state)| {
            let FuelState { moisture, extinction } = state.filter(|state| state.moisture >= state.extinction)?;
            let [moisture, extinction] = [moisture, extinction].map(percent);
            Some(format!("the {name} fuel has a moisture of {moisture} %; at {extinction} % or more it does not burn"))
        });
        let wet = wet.collect::<Vec<_>>().join("; ");
        let mut remarks = Vec::new();
        match (self.bed.burns(), wet.is_empty()) {
            (false, _) => remarks.push(format!("The fire goes out: {wet}")),
            (true, false) => remarks.push(format!("Part of the fuel is too wet: {wet}")),
            (true, true) => {}
        }
        if self.bed.burns() && self.fire.wind_is_limited {
            let max = short((self.fire.effective_wind_mps * 100.0).round() / 100.0);
            remarks.push(format!(
                "Wind and slope are capped at {max} m/s at mid-flame height, the limit for this \
                fuel"
            ));
        }
        remarks
    }
}

impl From<&BehaviorReport<'_>> for Document {
    fn from(report: &BehaviorReport) -> Self {
        let BehaviorReport { conditions: Conditions { model, .. }, fire, azimuths, .. } = report;
        let title = format!("{} ({}): {}", model.code, model.number, model.name.to_lowercase());
        let mut document = Self::new(title);
        document.add_list(report.conditions());
        document.add_list(report.remarks());
        if !report.bed.burns() {
            // A fire without wind and slope is a circle, and has neither head nor back.
            return document;
        }
        let row = |name: &str, azimuth: Option<f64>, rate_mps: f64| {
            let intensity = fire.intensity_kw_m(rate_mps);
            let azimuth = azimuth.map_or_else(|| "-".to_owned(), |azimuth| rounded(azimuth, 1));
            let numbers = [(rate_mps * 60.0, 2), (intensity, 0), (flame_length_m(intensity), 2)];
            let numbers = numbers.map(|(number, decimals)| rounded(number, decimals));
            [vec![name.to_owned(), azimuth], numbers.to_vec()].concat()
        };
        let head = compass::azimuth_deg(fire.heading.truncate());
        let has_head = fire.length_to_width > 1.0;
        let mut rows = vec![row("Head", Some(head).filter(|_| has_head), fire.rate_mps)];
        if has_head {
            rows.push(row("Back", Some(compass::azimuth_deg(-fire.heading.truncate())), fire.back_rate_mps()));
        }
        rows.push(row("Without wind and slope", None, fire.r0_mps));
        document.add(Table::new(&["Fire", "To\nazimuth", "Rate\nm/min", "Intensity\nkW/m", "Flames\nm"], rows));
        document.add_list(vec![
            format!(
                "{} times as long as wide, eccentricity {}",
                rounded(fire.length_to_width, 2),
                rounded(fire.eccentricity, 3)
            ),
            format!(
                "Each point flames for {} s and releases {} kJ/m2",
                rounded(fire.residence_s, 1),
                rounded(fire.heat_kj_m2(), 0)
            ),
        ]);
        if let Some(crown) = &report.crown {
            document.add(crown::heads_table(crown));
            document.add_list(crown::sentences(crown));
        }
        if !azimuths.is_empty() {
            document.add(Block::Table(directions_table(fire, azimuths)));
            document.add(Block::Text(
                "Front: the rate of the part of the front that faces this azimuth. Ray: the rate along a line from \
                 the ignition, on the slope and on the map."
                    .to_owned(),
            ));
        }
        document
    }
}

fn directions_table(fire: &SurfaceFire, azimuths: &[f64]) -> Table {
    let rows = azimuths.iter().map(|&azimuth| {
        let [_, rates @ ..] = DIRECTION_COLUMNS.map(|(_, value)| rounded(value(fire, azimuth), 3));
        [vec![short(azimuth)], rates.to_vec()].concat()
    });
    let headings = ["Azimuth", "Front\nm/min", "Ray\nm/min", "On the map\nm/min"];
    Table { text_columns: 0, ..Table::new(&headings, rows.collect()) }
}

impl Serialize for BehaviorReport<'_> {
    /// Serialises the members in their order; the names are those of the columns of tables.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { conditions: Conditions { model, moisture, wind_midflame_mps, wind_from_deg, slope }, fire, .. } =
            self;
        let state = |FuelState { moisture, extinction }| object!(State { moisture, extinction });
        let report = object!(Behavior {
            program_version: PROGRAM_VERSION,
            fuel: &model.code,
            number: model.number,
            m_1h: moisture.d1,
            m_10h: moisture.d10,
            m_100h: moisture.d100,
            m_live_herb: moisture.herb,
            m_live_woody: moisture.woody,
            wind_midflame_mps,
            wind_from_deg,
            slope_rise_run: slope.slope,
            aspect_deg: slope.aspect,
            options: self.options,
            // If not, all rates are zero.
            burns: self.bed.burns(),
            #[serde(flatten)]
            fire: Members(FIRE_COLUMNS.map(|(name, value)| (name, value(fire))).into()),
            back_m_min: fire.back_rate_mps() * 60.0,
            effective_wind_mps: fire.effective_wind_mps,
            wind_is_limited: fire.wind_is_limited,
            reaction_intensity_kw_m2: fire.reaction_intensity_kw_m2,
            residence_s: fire.residence_s,
            heat_kj_m2: fire.heat_kj_m2(),
            dead: self.bed.dead.map(state),
            live: self.bed.live.map(state),
            remarks: self.remarks(),
            // Only below trees.
            #[serde(flatten)]
            crown: Members(self.crown.iter().map(|fire| ("crown", crown::object(fire))).collect()),
            directions: self.azimuths.iter().map(|&azimuth| direction(fire, azimuth)).collect::<Vec<_>>(),
        });
        report.serialize(serializer)
    }
}

/// All fuel models, as a table.
struct FuelList;

/// Tons per acre in lb/ft2.
const TONS_PER_ACRE: f64 = 43560.0 / 2000.0;

impl From<&FuelList> for Document {
    fn from(_: &FuelList) -> Self {
        let headings =
            ["Number", "Code", "Fuel", "1-h", "10-h", "100-h", "Live\ngrass", "Live\nwood", "Depth\nft", "Out at\n%"];
        let rows = FUEL_MODELS.iter().map(|model| {
            let names = vec![model.number.to_string(), model.code.to_string(), model.name.to_string()];
            let loads =
                model.loads.map(|load| if load > 0.0 { rounded(load * TONS_PER_ACRE, 2) } else { "-".to_owned() });
            let bed = match model.burns() {
                true => [rounded(model.depth_ft, 1), rounded(100.0 * model.dead_extinction, 0)],
                false => ["-", "-"].map(str::to_owned),
            };
            [names, loads.to_vec(), bed.to_vec()].concat()
        });
        Self::new(count(FUEL_MODELS.len(), "fuel model"))
            .with([Block::Table(Table { text_columns: 3, ..Table::new(&headings, rows.collect()) })])
            .with([Block::Text(
                "Loads are in short tons per acre. Out at: the moisture at and above which dead fuel does not burn. 1 \
                 to 13: \
                 Anderson, 1982; 91 to 99, without fuel, and 101 to 204: Scott and Burgan, 2005."
                    .to_owned(),
            )])
    }
}

impl Serialize for FuelList {
    /// Loads are in lb/ft2, of dead 1-h, 10-h and 100-h, live herbaceous and live woody fuel; surface to volume in 1/ft.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(FUEL_MODELS.iter().map(|model| {
            object!(Fuel {
                number: model.number,
                code: &model.code,
                name: &model.name,
                loads_lb_ft2: model.loads,
                savs_per_ft: model.savs,
                depth_ft: model.depth_ft,
                dead_extinction: model.dead_extinction,
                heat_btu_lb: model.heat_btu_lb,
                dynamic: model.is_dynamic(),
            })
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_go_on_to_a_whole_turn() {
        let read = |text: &str| azimuths(text).map(|azimuths| azimuths.0);
        assert_eq!(read("0,200, 90"), Ok(vec![0.0, 200.0, 90.0]));
        assert_eq!(read("0,90,..."), Ok(vec![0.0, 90.0, 180.0, 270.0]));
        assert_eq!(read("10,15,...").map(|all| (all.len(), all[71])), Ok((72, 365.0)));
        assert_eq!(read("-360,-359.9,...").map(|all| all.len()), Ok(3600));
        for wrong in ["", "0,...", "5,5,...", "5,4,...", "0,0.01,...", "a", "0,,1", "400", "...", "0..."] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
