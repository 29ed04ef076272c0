//! `wildfire fire moisture`, `sticks`, `contain` and `spotting`: tables of questions in, the same with the answers out.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;

use crate::cli::error::CliError;
use crate::cli::number_table::{Column, Columns, Content, NumberTable, write_answers};
use crate::cli::numbers;
use crate::cli::output_files::{Files, Format};
use crate::cli::terminal;
use wildfire_base::input_file::is_standard_stream;
use wildfire_fire::contain::{Attack, Outcome, Resource, Status, Tactic};
use wildfire_fire::fine_moisture::{CorrectionClass, reference_pct};
use wildfire_fire::nelson::{Air, SIZES, Stick};
use wildfire_fire::spotting::{Location, SPECIES, Source, SpotDistance, Spotting};

/// A table that is read and one that is written.
#[derive(Debug, Args)]
pub struct TableArguments {
    /// CSV file with the columns below, in any order among others.
    #[arg(long, value_name = "IN.csv")]
    pub csv: PathBuf,
    /// CSV file for the table with its answers; `-` is stdout.
    #[arg(short, long, value_name = "OUT.csv", default_value = "-")]
    pub out: PathBuf,
}

impl TableArguments {
    /// Writes the table with the answers to its rows.
    pub fn answer<const N: usize>(
        &self,
        columns: Columns<N>,
        quiet: bool,
        mut answer: impl FnMut(&NumberTable<N>, &[f64; N]) -> Result<String, CliError>,
    ) -> Result<(), CliError> {
        let Self { csv, out } = self;
        Files { inputs: vec![csv], outputs: vec![(Format::Csv, out)], ..Files::default() }.check()?;
        let rows = write_answers(csv, out, columns, |table, numbers| Ok(vec![answer(table, numbers)?]))?;
        if !quiet && !is_standard_stream(out) {
            terminal::note(&format!("wrote {}: answers to {rows} rows", out.display()));
        }
        Ok(())
    }
}

pub const fn number(name: &'static str, range: RangeInclusive<f64>) -> Column {
    Column { name, content: Content::Number(range), without: None }
}

/// A number, or that of a class, which some rows do without; NaN where it is missing.
const fn optional(name: &'static str, content: Content) -> Column {
    Column { name, content, without: Some(f64::NAN) }
}

const fn word(name: &'static str, allowed: &'static [&'static str]) -> Column {
    Column { name, content: Content::Word(allowed), without: None }
}

/// Refuses a row that does without a number which it needs.
fn check_needed<const N: usize>(table: &NumberTable<N>, numbers: &[f64; N], needed: &[usize]) -> Result<(), CliError> {
    match needed.iter().find(|&&index| numbers[index].is_nan()) {
        Some(&index) => Err(table.refuse(index, "a number for this kind of row".to_owned())),
        None => Ok(()),
    }
}

pub const MOISTURE_TABLE: &str = "\
IN.csv has the column table, with reference or correction. Rows of the reference have dry_bulb (0: 10-29 F, 1: 30-49, \
2: 50-69, 3: 70-89, 4: 90-109, 5: above) and relative_humidity (0: 0-4 %, 1: 5-9, ..., 20: 100). Rows of the \
correction have month (0: May to July, 1: February to April and August to October, 2: November to January), shading (0: \
exposed, 1: shaded), aspect (0: N, 1: E, 2: S, 3: W), slope (0: up to 30 %, 1: steeper), time_of_day (0: 8:00-9:59, 1: \
10:00-11:59, ..., 5: 18:00-19:59) and elevation of the fuel (0: 1000 to 2000 ft below the weather station, 1: level, 2: \
above). OUT.csv adds fine_moisture_pct; the moisture of fine dead fuel is the sum of a reference and a correction.

Example:
  wildfire fire moisture --csv in.csv --out out.csv";

pub fn moisture(table: &TableArguments, quiet: bool) -> Result<(), CliError> {
    let read = [
        word("table", &["reference", "correction"]),
        optional("dry_bulb", Content::Class(5)),
        optional("relative_humidity", Content::Class(20)),
        optional("month", Content::Class(2)),
        optional("shading", Content::Class(1)),
        optional("aspect", Content::Class(3)),
        optional("slope", Content::Class(1)),
        optional("time_of_day", Content::Class(5)),
        optional("elevation", Content::Class(2)),
    ];
    let columns = Columns { read, row: "the conditions of fine dead fuel", added: &["fine_moisture_pct"] };
    table.answer(columns, quiet, |table, numbers| {
        let is_reference = numbers[0] == 0.0;
        check_needed(table, numbers, if is_reference { &[1, 2] } else { &[3, 4, 5, 6, 7, 8] })?;
        let [_, temperature, humidity, season, shade, aspect, slope, time, elevation] =
            numbers.map(|number| number as usize);
        // Both values of `table` have columns of their own, so each is needed for its rows only.
        let site = CorrectionClass { season, shade, aspect, slope, time, elevation };
        let percent = if is_reference { reference_pct(temperature, humidity) } else { site.correction_pct() };
        Ok(percent.expect("the classes are within the tables").to_string())
    })
}

pub const STICKS_TABLE: &str = "\
IN.csv has a row for each hour, with the air at its end and its rain: air_temperature_c, relative_humidity_fraction, \
solar_w_m2 and rain_in_hour_cm. OUT.csv adds, for sticks of 1, 10, 100 and 1000 hours, stick_1h_moisture (a fraction of the \
dry weight, the median from surface to middle) and stick_1h_surface_c, and so on. The sticks begin an hour before the first \
row, at 20 degrees and a moisture of 0.175.

Example:
  wildfire fire sticks --csv in.csv --out out.csv";

pub fn sticks(table: &TableArguments, quiet: bool) -> Result<(), CliError> {
    let read = [
        number("air_temperature_c", -80.0..=80.0),
        number("relative_humidity_fraction", 0.0..=1.0),
        number("solar_w_m2", 0.0..=2000.0),
        number("rain_in_hour_cm", 0.0..=100.0),
    ];
    const ADDED: &str = "stick_1h_moisture,stick_1h_surface_c,stick_10h_moisture,stick_10h_surface_c,\
                         stick_100h_moisture,stick_100h_surface_c,stick_1000h_moisture,stick_1000h_surface_c";
    let added = &ADDED.split(',').collect::<Vec<_>>();
    let columns = Columns { read, row: "the weather of an hour", added };
    let mut sticks = SIZES.map(Stick::new);
    table.answer(columns, quiet, |_, &[temperature_c, humidity, solar_w_m2, rain_cm]| {
        // The sticks' equations take a logarithm of the humidity, and perfectly dry air has none.
        let air = Air { temperature_c, humidity: humidity.max(0.01), solar_w_m2, rain_cm };
        let answers = sticks.each_mut().map(|stick| {
            stick.advance_hour(&air);
            format!("{},{}", stick.median_moisture(), stick.surface_temperature_c())
        });
        Ok(answers.join(","))
    })
}

#[derive(Debug, Args)]
#[command(after_help = "\
IN.csv has the columns report_rate_ch_h (of the head), report_size_acre, length_to_width, tactic (head or rear), \
line_offset_ch and resources_arrival_min:duration_min:production_ch_h, with one or more ARRIVAL:DURATION:PRODUCTION between \
bars. OUT.csv adds contain_status (contained, exhausted, size_limit above 1000 acres, time_limit after 1080 min, attacked \
where the steps ran out), contain_min, contain_line_ch, contain_perimeter_ch (0 where the line is not closed), \
contain_fire_acre, attack_perimeter_ch and attack_fire_acre (of the free fire at the first arrival).

Example:
  wildfire fire contain --csv in.csv --out out.csv")]
pub struct ContainArguments {
    #[command(flatten)]
    pub table: TableArguments,
    /// Steps of time until containment, at least; at most four times as many. BEHAVE takes 250.
    #[arg(long, value_name = "STEPS", default_value_t = 2500, value_parser = clap::value_parser!(u32).range(10..=100_000))]
    pub min_steps: u32,
}

pub fn contain(arguments: &ContainArguments, quiet: bool) -> Result<(), CliError> {
    const RESOURCES: usize = 5;
    let read = [
        number("report_rate_ch_h", 0.001..=1000.0),
        number("report_size_acre", 0.001..=1000.0),
        number("length_to_width", 1.0..=8.0),
        word("tactic", &["head", "rear"]),
        number("line_offset_ch", 0.0..=1000.0),
        Column { name: "resources_arrival_min:duration_min:production_ch_h", content: Content::Text, without: None },
    ];
    let added = "contain_status,contain_min,contain_line_ch,contain_perimeter_ch,contain_fire_acre,\
                 attack_perimeter_ch,attack_fire_acre";
    let added = &added.split(',').collect::<Vec<_>>();
    let columns = Columns { read, row: "a fire and the resources sent to it", added };
    arguments.table.answer(columns, quiet, |table, &[rate_ch_h, size_acre, length_to_width, tactic, offset_ch, _]| {
        let resources = table.text(RESOURCES).split('|').map(resource).collect::<Option<_>>();
        let expected = "ARRIVAL:DURATION:PRODUCTION, numbers up to 10000 in min and ch/h, with bars between several";
        let resources = resources.ok_or_else(|| table.refuse(RESOURCES, expected.to_owned()))?;
        let tactic = if tactic == 0.0 { Tactic::Head } else { Tactic::Rear };
        let min_steps = arguments.min_steps;
        let attack = Attack { rate_ch_h, size_acre, length_to_width, tactic, offset_ch, resources, min_steps };
        let Outcome { status, time_min, line_ch, area_acre } = attack.run();
        // A fire that escapes has no closed line around it.
        let perimeter_ch = if status == Status::Contained { line_ch } else { 0.0 };
        let [free_ch, free_acre] = attack.free_fire();
        Ok(format!("{},{time_min},{line_ch},{perimeter_ch},{area_acre},{free_ch},{free_acre}", status.name()))
    })
}

/// Reads `ARRIVAL:DURATION:PRODUCTION`.
fn resource(text: &str) -> Option<Resource> {
    let parts = text.split(':').map(|part| numbers::within(part, &(0.0..=10_000.0)));
    match parts.collect::<Option<Vec<f64>>>()?[..] {
        [arrival_min, duration_min, production_ch_h] => Some(Resource { arrival_min, duration_min, production_ch_h }),
        _ => None,
    }
}

pub const SPOTTING_TABLE: &str = "\
IN.csv has the columns source (torching_trees, burning_pile, surface_fire, active_crown), location (midslope_windward, \
valley_bottom, midslope_leeward, ridge_top), ridge_to_valley_distance_mi, ridge_to_valley_elevation_ft, \
downwind_cover_height_ft, downwind_canopy (closed or open), wind_20ft_mi_h, flame_ft (of a pile or a surface fire), \
torching_trees, dbh_in, tree_height_ft and species (of torching trees). OUT.csv adds spot_flame_ft, spot_flame_duration, \
spot_firebrand_ft, spot_cover_ft, spot_drift_mi, spot_flat_mi, spot_mountain_mi; what does not belong to a source is 0, and \
the answers for active_crown, which is not computed, are empty.

Species: 0 Engelmann spruce, 1 Douglas-fir, 2 subalpine fir, 3 western hemlock, 4 ponderosa pine, 5 lodgepole pine, 6 \
western white pine, 7 grand fir, 8 balsam fir, 9 slash pine, 10 longleaf pine, 11 pond pine, 12 shortleaf pine, 13 \
loblolly pine.

Example:
  wildfire fire spotting --csv in.csv --out out.csv";

pub fn spotting(table: &TableArguments, quiet: bool) -> Result<(), CliError> {
    const LOCATIONS: [Location; 4] =
        [Location::MidslopeWindward, Location::ValleyBottom, Location::MidslopeLeeward, Location::RidgeTop];
    let read = [
        word("source", &["torching_trees", "burning_pile", "surface_fire", "active_crown"]),
        word("location", &["midslope_windward", "valley_bottom", "midslope_leeward", "ridge_top"]),
        number("ridge_to_valley_distance_mi", 0.0..=100.0),
        number("ridge_to_valley_elevation_ft", 0.0..=30_000.0),
        optional("downwind_cover_height_ft", Content::Number(0.0..=1000.0)),
        word("downwind_canopy", &["closed", "open"]),
        number("wind_20ft_mi_h", 0.0..=200.0),
        optional("flame_ft", Content::Number(0.0..=1000.0)),
        optional("torching_trees", Content::Number(1.0..=100.0)),
        optional("dbh_in", Content::Number(0.1..=200.0)),
        optional("tree_height_ft", Content::Number(0.1..=500.0)),
        optional("species", Content::Class(13)),
    ];
    const ADDED: &str =
        "spot_flame_ft,spot_flame_duration,spot_firebrand_ft,spot_cover_ft,spot_drift_mi,spot_flat_mi,spot_mountain_mi";
    let added = &ADDED.split(',').collect::<Vec<_>>();
    let columns = Columns { read, row: "a source of firebrands", added };
    table.answer(columns, quiet, |table, numbers| {
        let &[source, location, miles, rise_ft, cover_ft, canopy, wind, flame_ft, trees, dbh_in, height_ft, species] =
            numbers;
        let needed: &[usize] = match source {
            0.0 => &[4, 8, 9, 10, 11],
            // Active crown fires are not computed, but keep their row, so that the table goes on as it was.
            3.0 => return Ok(",".repeat(added.len() - 1)),
            _ => &[4, 7],
        };
        check_needed(table, numbers, needed)?;
        let source = match source {
            0.0 => Source::TorchingTrees { trees, species: &SPECIES[species as usize], dbh_in, height_ft },
            1.0 => Source::BurningPile { flame_ft },
            _ => Source::SurfaceFire { flame_ft },
        };
        let location = LOCATIONS[location as usize];
        let open = canopy == 1.0;
        let ridge_to_valley = [miles, rise_ft];
        let spotting = Spotting { source, location, ridge_to_valley, cover_ft, open, wind_20ft_mph: wind };
        let SpotDistance { flame_ft, flame_duration, firebrand_ft, cover_ft, drift_mi, flat_mi, mountain_mi } =
            spotting.distance();
        Ok(format!("{flame_ft},{flame_duration},{firebrand_ft},{cover_ft},{drift_mi},{flat_mi},{mountain_mi}"))
    })
}
