//! Files of custom fuel models: `.fmd` of FARSITE and FlamMap, and tables of ELMFIRE.
//!
//! A line of `.fmd` has a number, a code, five loads, `static` or `dynamic`, three ratios of surface to volume, the depth, the
//! moisture of extinction in percent, the heat contents of dead and live fuel, and a name; before the first stands `ENGLISH`
//! (tons per acre, 1/ft, ft, Btu/lb) or `METRIC` (t/ha, 1/cm, cm, kJ/kg). A row of ELMFIRE's CSV has a number, a name,
//! `.TRUE.` or `.FALSE.`, the loads in lb/ft2, the ratios, the depth, the moisture and one heat content.

use std::path::Path;

use wildfire_base::input_file;
use wildfire_base::untrusted::visible_start;
use wildfire_fire::fuel::{CUSTOM_NUMBERS, CustomFuels, FuelModel, SAV_10H, SAV_100H, TON_PER_ACRE, custom_number};

/// Of a pound per square foot, in kg/m2; of a foot, in metres; of a Btu per pound, in kJ/kg.
pub const LB_FT2_KG_M2: f64 = 0.453_592_37 / (FOOT_M * FOOT_M);
pub const FOOT_M: f64 = 0.3048;
pub const BTU_LB_KJ_KG: f64 = 2.326;

/// The most bytes of a file of fuel models.
const MAX_BYTES: u64 = 1_000_000;

/// How far a row with the number of a built-in model may be from it: tables in lb/ft2 are rounded.
const SAME: f64 = 0.02;
const SAME_LB_FT2: f64 = 1e-4;

/// What numbers are multiplied by to be in the units of the equations: loads, ratios, depths, heat contents.
struct Units([f64; 4]);

const ENGLISH: Units = Units([TON_PER_ACRE, 1.0, 1.0, 1.0]);
const METRIC: Units = Units([0.1 / LB_FT2_KG_M2, 100.0 * FOOT_M, 0.01 / FOOT_M, 1.0 / BTU_LB_KJ_KG]);
const ELMFIRE: Units = Units([1.0; 4]);

/// Reads the custom fuel models of a file. Rows that repeat a built-in model are left out.
///
/// # Errors
/// Returns a sentence that begins with the path and names the line.
pub fn read_fuels(path: &Path) -> Result<Vec<FuelModel>, String> {
    let name = path.display().to_string();
    let text = input_file::read_text(path, MAX_BYTES).map_err(|error| format!("{name}: {error}"))?;
    let lines = text.lines().zip(1_usize..).map(|(line, number)| (line.trim(), number));
    let mut units = None;
    let mut models: Vec<FuelModel> = Vec::new();
    for (line, number) in lines.filter(|(line, _)| !line.is_empty() && !line.starts_with('#')) {
        let at = format!("{name}: line {number}");
        match line.to_ascii_uppercase().as_str() {
            "ENGLISH" => units = Some(ENGLISH),
            "METRIC" => units = Some(METRIC),
            _ => {
                let is_csv = line.contains(',');
                let cells: Vec<&str> = if is_csv {
                    line.split(',').map(|cell| cell.trim().trim_matches(['"', '\''])).collect()
                } else {
                    line.split_whitespace().collect()
                };
                // A line of names may come first.
                if is_csv && models.is_empty() && cells[0].parse::<f64>().is_err() {
                    continue;
                }
                let model = match &units {
                    _ if is_csv => csv_model(&cells),
                    Some(units) => fmd_model(&cells, units),
                    None => Err(format!(
                        "found `{}`, expected ENGLISH or METRIC before the first model",
                        visible_start(line)
                    )),
                };
                if let Some(model) = model.and_then(custom_only).map_err(|sentence| format!("{at}: {sentence}"))? {
                    let twice = models.iter().any(|other| other.number == model.number);
                    // Checked one by one, so that an error names its line.
                    CustomFuels::new(vec![model.clone()]).map_err(|sentence| format!("{at}: {sentence}"))?;
                    if twice {
                        return Err(format!("{at}: its number is that of a model before"));
                    }
                    models.push(model);
                }
            }
        }
    }
    if models.is_empty() {
        Err(format!("{name}: it has no custom fuel model; expected one with a number {CUSTOM_NUMBERS}"))
    } else {
        Ok(models)
    }
}

/// Returns a name as it may be printed.
pub fn printable(name: &str) -> String {
    name.chars().filter(|letter| !letter.is_control()).take(60).collect()
}

/// A row with its written number.
struct Row {
    written: u32,
    model: FuelModel,
}

/// Returns the model, with its number in landscapes; `None` if it is a built-in one.
fn custom_only(row: Row) -> Result<Option<FuelModel>, String> {
    let Row { written, model } = row;
    if let Some(number) = custom_number(written) {
        return Ok(Some(FuelModel { number, ..model }));
    }
    let built_in = u8::try_from(written).ok().and_then(FuelModel::by_number);
    match built_in {
        Some(built_in) if is_same(&model, built_in) => Ok(None),
        Some(built_in) => Err(format!(
            "fuel model {written} is not the built-in {}; expected a number {CUSTOM_NUMBERS} for a custom model",
            built_in.code
        )),
        None => Err(format!("found the number {written}, expected {CUSTOM_NUMBERS}")),
    }
}

/// Says whether a row repeats a built-in model, whose loads may be rounded.
fn is_same(model: &FuelModel, built_in: &FuelModel) -> bool {
    let is_bare = !built_in.burns() && model.loads.iter().sum::<f64>() == 0.0;
    let mut pairs = model.loads.iter().zip(built_in.loads).chain([(&model.depth_ft, built_in.depth_ft)]);
    is_bare || pairs.all(|(found, expected)| (found - expected).abs() <= SAME * expected + SAME_LB_FT2)
}

fn fmd_model(cells: &[&str], units: &Units) -> Result<Row, String> {
    if cells.len() < 15 {
        return Err(format!(
            "found {} columns, expected 15: number, code, five loads, static or dynamic, three ratios of surface to volume, \
             depth, moisture of extinction, two heat contents",
            cells.len()
        ));
    }
    let cures = match cells[7].to_ascii_lowercase().as_str() {
        "dynamic" => true,
        "static" => false,
        _ => return Err(format!("found `{}`, expected static or dynamic in column 8", visible_start(cells[7]))),
    };
    let name = if cells.len() > 15 { cells[15..].join(" ") } else { cells[1].to_owned() };
    row(cells, [cells[1], &name], cures, [2, 8, 11, 12, 13, 14], units)
}

fn csv_model(cells: &[&str]) -> Result<Row, String> {
    if cells.len() < 14 {
        return Err(format!(
            "found {} columns, expected 14: number, name, .TRUE. or .FALSE., five loads, three ratios of surface to volume, \
             depth, moisture of extinction, heat content",
            cells.len()
        ));
    }
    let cures = match cells[2].trim_matches('.').to_ascii_lowercase().as_str() {
        "true" | "t" => true,
        "false" | "f" => false,
        _ => return Err(format!("found `{}`, expected .TRUE. or .FALSE. in column 3", visible_start(cells[2]))),
    };
    row(cells, [cells[1]; 2], cures, [3, 8, 11, 12, 13, 13], &ELMFIRE)
}

/// Reads the numbers of a row; `places` are the columns of the first load and of the first ratio, of the depth, the moisture and
/// the heat contents.
fn row(cells: &[&str], names: [&str; 2], cures: bool, places: [usize; 6], units: &Units) -> Result<Row, String> {
    let written = number(cells, 0)?;
    if !(written.fract() == 0.0 && (0.0..1e9).contains(&written)) {
        return Err(format!("found the number {written}, expected {CUSTOM_NUMBERS}"));
    }
    let [load, ratio, depth, extinction, heat, live_heat] = places;
    let Units([of_loads, of_ratios, of_depths, of_heats]) = *units;
    let mut loads = [0.0; 5];
    for (place, of_class) in loads.iter_mut().enumerate() {
        *of_class = number(cells, load + place)? * of_loads;
    }
    // Files give ratios of 1-hour, herbaceous and woody fuel; those of thicker dead fuel are constants of all models.
    let mut savs = [0.0, SAV_10H, SAV_100H, 0.0, 0.0];
    for (place, class) in [0, 3, 4].into_iter().enumerate() {
        savs[class] = number(cells, ratio + place)? * of_ratios;
    }
    let [code, name] = names.map(printable);
    let model = FuelModel {
        number: 0,
        code: code.into(),
        name: name.into(),
        loads,
        savs,
        depth_ft: number(cells, depth)? * of_depths,
        // Percent in files, a fraction in models.
        dead_extinction: number(cells, extinction)? / 100.0,
        heat_btu_lb: number(cells, heat)? * of_heats,
        live_heat_btu_lb: number(cells, live_heat)? * of_heats,
        cures,
    };
    Ok(Row { written: written as u32, model })
}

fn number(cells: &[&str], place: usize) -> Result<f64, String> {
    let found = cells[place].parse::<f64>().ok().filter(|number| number.is_finite());
    found.ok_or_else(|| format!("found `{}`, expected a number in column {}", visible_start(cells[place]), place + 1))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use wildfire_fire::surface::{Curing, FuelBed, FuelMoisture};

    const GR2: &str = "0.10 0 0 1.00 0 dynamic 2000 1800 0 1.0 15 8000 8000";

    fn read(text: &str) -> Result<Vec<FuelModel>, String> {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("mine.fmd");
        fs::write(&path, text).expect("the scratch folder takes files");
        read_fuels(&path)
    }

    fn bed(model: &FuelModel) -> FuelBed {
        FuelBed::new(model, &FuelMoisture::default(), Curing::Exact)
    }

    #[test]
    fn a_built_in_model_in_english_units_is_the_same_to_the_bit_and_in_others_nearly() {
        let built_in = bed(FuelModel::by_number(102).expect("it is one"));
        let models = read(&format!("ENGLISH\n14 MINE {GR2} My low grass\n257 MORE {GR2}\n")).expect("it is right");
        assert_eq!(models.iter().map(|model| model.number).collect::<Vec<_>>(), [14, 205]);
        assert_eq!((&*models[0].code, &*models[0].name, &*models[1].name), ("MINE", "My low grass", "MORE"));
        assert!(models.iter().all(|model| bed(model) == built_in));
        let tons = 2000.0 * 0.453_592_37 / 4_046.856_422_4 * 10.0;
        let metric = format!(
            "metric\n\n14 MINE {} 0 0 {tons} 0 dynamic {} {} 0 30.48 15 18608 18608\n",
            0.1 * tons,
            2000.0 / 30.48,
            1800.0 / 30.48
        );
        let csv = format!(
            "num,name,dynamic\n 14, \"MINE\", .TRUE., {}, 0, 0, {}, 0, 2000, 1800, 9999, 1.0, 15, 8000\n",
            0.1 * TON_PER_ACRE,
            TON_PER_ACRE
        );
        for text in [metric, csv] {
            let models = read(&text).expect("it is right");
            let near = bed(&models[0]).r0_mps() / built_in.r0_mps() - 1.0;
            assert!(near.abs() < 1e-12, "{text}: {near}");
        }
    }

    #[test]
    fn rows_of_built_in_models_are_left_out_if_they_are_those() {
        let table = "4,FBFM04,.FALSE.,0.23,0.184,0.092,0,0.23,2000,9999,1500,6,20,8000\n98,NB8,.FALSE.,0,0,0,0,0,1,1,1,0,10,0\n";
        let custom = "14,OWN,F,0.03,0,0,0,0,3500,9999,9999,1.0,12,8000\n";
        assert_eq!(read(&format!("{table}{custom}")).expect("it is right").len(), 1);
        let refused = read(&format!("{custom}{}", table.replace("0.184", "0.2"))).expect_err("it is another");
        assert!(refused.contains("line 2: fuel model 4 is not the built-in R04"), "{refused}");
    }

    #[test]
    fn what_is_no_fuel_model_is_refused_with_its_line() {
        for (text, expected) in [
            ("", "it has no custom fuel model"),
            (&*format!("14 MINE {GR2}"), "line 1: found `14 MINE"),
            ("ENGLISH\n14 MINE 0.1", "line 2: found 3 columns, expected 15"),
            (&format!("ENGLISH\n90 MINE {GR2}"), "line 2: found the number 90, expected 14 to 89 or 257 to 307"),
            (&format!("ENGLISH\n14.5 MINE {GR2}"), "line 2: found the number 14.5"),
            (
                &format!("ENGLISH\n14 MINE {}", GR2.replace("dynamic", "often")),
                "expected static or dynamic in column 8",
            ),
            (
                &format!("ENGLISH\n14 MINE {}", GR2.replace("2000", "x")),
                "line 2: found `x`, expected a number in column 9",
            ),
            (&format!("ENGLISH\n14 MINE {}", GR2.replace("2000", "nan")), "expected a number in column 9"),
            (&format!("METRIC\n14 MINE {GR2}"), "line 2: fuel model 14: its heat content of dead fuel in Btu/lb"),
            (&format!("ENGLISH\n14 A {GR2}\n14 B {GR2}"), "line 3: its number is that of a model before"),
            ("14,A,.TRUE.,1", "line 1: found 4 columns, expected 14"),
        ] {
            let refused = read(text).expect_err(expected);
            assert!(refused.contains("mine.fmd: ") && refused.contains(expected), "{text}: {refused}");
        }
    }
}
