//! `wildfire fire behavior`, and `wildfire fire spread` of the automaton: fires without agents.

use serde_json::Value;
use wildfire::map_files::raster;

use crate::story::{Story, refuse, widest};

const HEADER: &str = "number,m_1h,m_10h,m_100h,m_live_herb,m_live_woody,wind_midflame_mps,wind_from_deg,\
                      slope_rise_run,aspect_deg";

fn object(arguments: &[&str]) -> Value {
    object_of(&Story::begin(), arguments)
}

fn object_of(story: &Story, arguments: &[&str]) -> Value {
    let answer = story.tell(arguments).expect_code(0);
    serde_json::from_str(&answer.stdout).expect("it is JSON")
}

#[test]
fn one_fire_is_the_same_in_every_form() {
    let arguments = ["fire", "behavior", "--fuel", "GR2", "--wind", "5@270", "--slope", "0.3"];
    let text = Story::begin().tell(&arguments).expect_code(0).stdout;
    assert!(text.starts_with("GR2 (102): low load, dry climate grass") && widest(&text) <= 80, "{text}");
    let fire = object(&[&arguments[..], &["--json"]].concat());
    let number = |name: &str| fire[name].as_f64().unwrap_or_else(|| panic!("no {name}"));
    assert!(text.contains(&format!("{:.2}", number("r_m_min"))), "{text}");
    assert_eq!((number("wind_midflame_mps"), number("m_live_herb"), number("aspect_deg")), (5.0, 0.6, 180.0));
    assert_eq!(fire["burns"], true);
    // The table of one row says the same, to the last digit.
    let story = Story::begin();
    story.file("in.csv", &format!("name,{HEADER}\na fire,102,0.06,0.07,0.08,0.6,0.9,5,270,0.3,180\n"));
    story.tell(&["fire", "behavior", "--conditions", "in.csv", "--csv", "out.csv"]).expect_code(0);
    let written = story.read("out.csv");
    let rows: Vec<Vec<&str>> = written.lines().map(|line| line.split(',').collect()).collect();
    for (name, value) in rows[0].iter().zip(&rows[1]).skip(1) {
        assert_eq!(value.parse(), Ok(number(name)), "{name}");
    }
    assert_eq!(rows[1][0], "a fire");
}

#[test]
fn azimuths_make_a_row_each() {
    let fire = object(&["fire", "behavior", "--fuel", "102", "--wind", "3", "--azimuths", "0,90,...", "--json"]);
    let directions = fire["directions"].as_array().expect("a list");
    let rates = |name: &str| directions.iter().map(|one| one[name].as_f64().expect("a number")).collect::<Vec<_>>();
    assert_eq!(rates("azimuth_of_deg"), [0.0, 90.0, 180.0, 270.0]);
    // The wind blows to the east: head and back have one rate each, the flanks two.
    let [front, ray] = ["front_normal_m_min", "ray_m_min"].map(rates);
    assert!((front[1] - ray[1]).abs() < 1e-9 && (front[3] - ray[3]).abs() < 1e-9 && front[0] > 1.5 * ray[0]);
    assert_eq!((front[0], ray[0]), (front[2], ray[2]));
    let story = Story::begin();
    story.file("in.csv", &format!("{HEADER},wind_limit\n102,0.06,0.07,0.08,0.6,0.9,3,270,0,0,0\n"));
    let arguments = ["fire", "behavior", "--conditions", "in.csv", "--csv", "out.csv", "--azimuths", "0,5,..."];
    story.tell(&arguments).expect_code(0);
    let written = story.read("out.csv");
    assert_eq!(written.lines().count(), 1 + 72);
    assert!(
        written
            .lines()
            .next()
            .expect("a header")
            .ends_with(",eccentricity,azimuth_of_deg,front_normal_m_min,ray_m_min,ray_horizontal_m_min")
    );
}

#[test]
fn wind_at_another_height_is_brought_down() {
    let wind = |height: &str| {
        let fire = object(&["fire", "behavior", "--fuel", "GR2", "--wind", "10", "--wind-height", height, "--json"]);
        fire["wind_midflame_mps"].as_f64().expect("a number")
    };
    // A foot of grass that nothing shelters.
    let factor = 1.83 / wildfire::geometry::ops::ln(20.36 / 0.13);
    assert_eq!(wind("midflame"), 10.0);
    assert!((wind("20ft") - 10.0 * factor).abs() < 1e-9 && (wind("10m") - 10.0 * factor / 1.15).abs() < 1e-9);
}

#[test]
fn winds_and_slopes_are_written_in_one_way_and_the_old_ways_are_read_still() {
    let same = |one: &[&str], other: &[&str]| {
        let [one, other] = [one, other].map(|args| object(&[&["fire"], args, &["--json"]].concat()));
        assert_eq!(one, other);
    };
    let behavior = ["behavior", "--fuel", "GR2", "--wind"];
    same(&[&behavior[..], &["5@200"]].concat(), &[&behavior[..], &["5", "--wind-from", "200"]].concat());
    let refused = Story::begin().tell(&["fire", "behavior", "--fuel", "GR2", "--wind", "5@200", "--wind-from", "90"]);
    assert!(refused.expect_code(2).stderr.contains("expected no --wind-from"));
    let spread = ["spread", "--model", "alexandridis", "--rows", "31", "--cols", "31", "--p0", "0.05"];
    let areas = |args: &[&str]| {
        let fire = object(&[&["fire"], &spread[..], args, &["--json"]].concat());
        let number = |name: &str| fire[name].as_f64().expect("a number");
        (number("area_mean"), number("slope_deg").round(), number("uphill_deg").round())
    };
    // A slope of 1 is one of 45 degrees, and the way up is opposite to where it faces.
    let (old, new) = (areas(&["--slope-deg", "45", "--uphill-deg", "90"]), areas(&["--slope", "1", "--aspect", "270"]));
    assert_eq!(old, new);
    assert_eq!((new.1, new.2), (45.0, 90.0));
    assert!(areas(&[]).0 < new.0, "a fire on a slope burns more than on level ground");
    let help = Story::begin().tell(&["fire", "spread", "--help"]).expect_code(0).stdout;
    assert!(!help.contains("--slope-deg") && !help.contains("--uphill-deg"), "{help}");
}

/// Grass with some cells of water.
fn grass_with_water(cols: usize, rows: usize, is_water: impl Fn(usize, usize) -> bool) -> String {
    let cell = |row: usize, col: usize| if is_water(row, col) { "98" } else { "102" };
    let line = |row: usize| (0..cols).map(|col| cell(row, col)).collect::<Vec<_>>().join(" ");
    let lines = (0..rows).map(line).collect::<Vec<_>>().join("\n");
    format!("ncols {cols}\nnrows {rows}\nxllcorner 0\nyllcorner 0\ncellsize 10\n{lines}\n")
}

#[test]
fn long_rasters_are_read_and_what_limits_them_is_memory() {
    let story = Story::begin();
    story.file("long.asc", &grass_with_water(5000, 5, |_, _| false));
    let args = ["fire", "spread", "--fuel", "long.asc", "--duration", "300"];
    let report = story.tell(&args).expect_code(0).stdout;
    assert!(report.contains("5 rows and 5000 columns of 10 m"), "{report}");
    let refused = story.tell(&[&args[..], &["--memory", "1MB"]].concat()).expect_code(2).stderr;
    assert!(refused.contains("would take up to 1.2 MB of memory; the limit is 1 MB"), "{refused}");
    story.file("mine.toml", "wumpus = []\nunimog = []\n[fire]\nmodel = \"rothermel\"\n[fire.rothermel]\nfuel_map = \"long.asc\"\n[field]\ncoverage = 0\n");
    story.tell(&["check", "mine.toml"]).expect_code(0);
}

/// The bytes of a landscape file of FARSITE: a header of 7316 bytes with sizes and units, then the layers of each cell.
fn landscape_file(cols: i32, rows: i32, layers: impl Fn(i32, i32) -> [i16; 8]) -> Vec<u8> {
    let mut bytes = vec![0; 7316];
    let mut put = |at: usize, word: &[u8]| bytes[at..at + word.len()].copy_from_slice(word);
    put(0, &21_i32.to_le_bytes());
    put(4, &20_i32.to_le_bytes());
    put(4164, &cols.to_le_bytes());
    put(4168, &rows.to_le_bytes());
    for (at, number) in [(4180, 500_000.0), (4196, 4_000_000.0), (4208, 30.0), (4216, 30.0_f64)] {
        put(at, &number.to_le_bytes());
    }
    for (at, unit) in [(4228, 2_i16), (4232, 1), (4234, 3), (4236, 3), (4238, 3)] {
        put(at, &unit.to_le_bytes());
    }
    let cells = (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col)));
    bytes.extend(cells.flat_map(|(row, col)| layers(row, col)).flat_map(i16::to_le_bytes));
    bytes
}

#[test]
fn layers_are_taken_from_the_bands_of_one_file_and_a_rim_without_data_does_not_burn() {
    let story = Story::begin();
    let rim = |row: i32, col: i32| row < 2 || col == 0;
    let layers = |row: i32, col: i32| {
        let inside = [1200 + i16::try_from(row).expect("few rows"), 10, 180, 165, 60, 150, 12, 11];
        if rim(row, col) { [1190, -9999, -9999, -9999, -9999, -9999, -9999, -9999] } else { inside }
    };
    let file = |name: &str, bytes: &[u8]| std::fs::write(story.path(name), bytes).expect("writable");
    file("valley.lcp", &landscape_file(40, 30, layers));
    let scenario = "wumpus = []\nunimog = []\n[field]\ncoverage = 0\n[fire]\nmodel = \"rothermel\"\n\
         [fire.rothermel]\nfuel_map = \"valley.lcp\"\nslope = \"valley.lcp\"\naspect = \"valley.lcp\"\n\
         [fire.crowns]\nheight_map = \"valley.lcp\"\nbase_map = \"valley.lcp\"\ndensity_map = \"valley.lcp\"\n\
         [[ignition]]\nat_s = 0\ncells = [[20, 10]]\n";
    story.file("valley.toml", scenario);
    let checked = story.tell(&["check", "valley.toml", "--all"]).expect_code(0).stdout.replace("\n  ", " ");
    for fragment in [
        "fuel models from band 4 of valley.lcp (FBFM); slope from band 2 of valley.lcp (SLPD)",
        "height of trees from band 6 of valley.lcp (CH)",
        "bulk density of crowns from band 8 of valley.lcp (CBD)",
        "nothing 9 %",
        "Trees on 91 % of the cells.",
    ] {
        assert!(checked.contains(fragment), "{fragment}: {checked}");
    }
    // Heights make slopes beside a rim, so they are wanted everywhere; other gaps are named with band, row and column.
    let spread =
        ["fire", "spread", "--fuel", "valley.lcp", "--wind", "3@270", "--ignite", "20,10", "--duration", "600"];
    story.tell(&[&spread[..], &["--elevation", "valley.lcp"]].concat()).expect_code(0);
    let hole =
        |row: i32, col: i32| if (row, col) == (5, 7) { [0, 0, 0, 165, 0, -9999, 0, 0] } else { layers(row, col) };
    file("valley.lcp", &landscape_file(40, 30, hole));
    let expected = "valley.lcp, band 6: row 5, column 7: found NODATA, expected a value in every cell";
    refuse(&story, &["check", "valley.toml"], &[expected]);
    refuse(&story, &["map", "brushfire", "valley.lcp"], &["valley.lcp"]);
}

#[test]
fn bands_hold_what_rasters_of_one_quantity_hold() {
    let story = Story::begin();
    let fire = ["fire", "spread", "--fuel", "TU5", "--rows", "41", "--cols", "61", "--cell", "10", "--wind", "9@270"];
    let trees = [
        "--ignite",
        "20,10",
        "--duration",
        "900",
        "--canopy-height",
        "20",
        "--canopy-base",
        "1.5",
        "--canopy-density",
        "0.05",
        "--canopy-cover",
        "0.6",
    ];
    let files = ["--arrival", "arrival.tif", "--fire-type", "type.asc", "--bands", "bands.tif"];
    story.tell(&[&fire[..], &trees, &files].concat()).expect_code(0);
    let run = ["map-of", "windy", "--set", "duration_s=600", "--intensity", "--asc", "intensity.asc"];
    story.tell(&[&run[..], &["--bands", "run.tif"]].concat()).expect_code(0);
    let [bands, of_run] =
        ["bands.tif", "run.tif"].map(|name| raster::read_bands(&story.path(name)).expect("they were written"));
    let names: Vec<_> = bands.iter().filter_map(|band| band.name.as_deref()).collect();
    assert!(names[1].starts_with("Fire type (0 surface,"), "{names:?}");
    for (band, name) in [(&bands[0], "arrival.tif"), (&bands[1], "type.asc"), (&of_run[3], "intensity.asc")] {
        let alone = raster::read(&story.path(name)).expect("it was written");
        assert!(alone.values == band.raster.values && alone.nodata == band.raster.nodata, "{name}");
        assert!(alone.range().is_some_and(|(_, max)| max > 0.0), "{name}");
    }
    // The head's intensity, as `fire behavior --wind-height 10m` has it, and its flames by Byram: 0.0775 I^0.46.
    for (band, expected) in [(2, 2.779), (3, 2398.0)] {
        let greatest = bands[band].raster.range().expect("it burned").1;
        assert!((greatest / expected - 1.0).abs() < 1e-3, "{greatest} and {expected}");
    }
    refuse(&story, &["fire", "spread", "--model", "alexandridis", "--bands", "a.tif"], &["--bands is an option of"]);
    refuse(&story, &["map-of", "smoke", "--arrival", "--bands", "a.tif"], &["only bushes burn"]);
}

#[test]
fn perimeters_by_the_hour_enclose_what_burned() {
    let story = Story::begin();
    let fire = ["fire", "spread", "--fuel", "GR2", "--wind", "3@270", "--duration", "2000", "--json"];
    let more = ["--perimeters", "hours.geojson", "--every", "900"];
    let report = object_of(&story, &[&fire[..], &more].concat());
    let written: Value = serde_json::from_str(&story.read("hours.geojson")).expect("it is JSON");
    let features = written["features"].as_array().expect("a list");
    let number = |feature: &Value, name: &str| feature["properties"][name].as_f64().expect("a number");
    let times: Vec<f64> = features.iter().map(|feature| number(feature, "time_s")).collect();
    assert_eq!(times, [900.0, 1800.0, 2000.0]);
    assert!(features.is_sorted_by_key(|feature| number(feature, "area_ha")));
    let last = features.last().expect("there are three");
    for (actual, reported) in [("area_ha", "burned_ha"), ("perimeter_m", "perimeter_m")] {
        let (actual, reported) = (number(last, actual), report[reported].as_f64().expect("a number"));
        assert!((actual - reported).abs() < 1e-9 * reported, "{actual} and {reported}");
    }
    assert_eq!(last["geometry"]["type"], "MultiPolygon");
    let often = ["fire", "spread", "--fuel", "GR2", "--perimeters", "hours.geojson", "--every", "1"];
    refuse(&story, &often, &["--every is 1 s; expected at least 3.6 s"]);
}

#[test]
fn a_fire_that_is_enclosed_is_named() {
    let story = Story::begin();
    let is_rim = |row: usize, col: usize| row.abs_diff(20).max(col.abs_diff(20)) == 2;
    story.file("fuel.asc", &grass_with_water(41, 41, is_rim));
    let args = ["fire", "spread", "--fuel", "fuel.asc", "--ignite", "20,20"];
    let sentence = "The fire ended after 9 cells of 1665 that can burn";
    let report = story.tell(&args).expect_code(0).stdout;
    assert!(report.contains(sentence), "{report}");
    let fire = object_of(&story, &[&args[..], &["--json"]].concat());
    assert_eq!((&fire["has_ended"], fire["burnable_cells"].as_u64()), (&Value::Bool(true), Some(1665)));
    for args in [
        ["fire", "spread", "--fuel", "fuel.asc", "--ignite", "5,5"],
        ["fire", "spread", "--fuel", "GR2", "--ignite", "20,20"],
    ] {
        let report = story.tell(&args).expect_code(0).stdout;
        assert!(!report.contains("The fire ended"), "{report}");
    }
}

#[test]
fn fire_that_goes_out_is_an_answer_and_says_why() {
    let arguments = ["fire", "behavior", "--fuel", "1", "--moisture", "0.13,0.1,0.1,1,1"];
    let answer = Story::begin().tell(&arguments).expect_code(0);
    assert!(answer.stdout.contains("The fire goes out: the dead fuel has a moisture of 13.0 %"), "{}", answer.stdout);
    let fire = object(&[&arguments[..], &["--json"]].concat());
    assert_eq!((&fire["burns"], fire["r_m_min"].as_f64()), (&Value::Bool(false), Some(0.0)));
    let answer = Story::begin().tell(&["fire", "behavior", "--fuel", "NB8"]).expect_code(0);
    assert!(answer.stdout.contains("Nothing burns: there is no fuel"), "{}", answer.stdout);
}

#[test]
fn all_fuels_are_listed() {
    let text = Story::begin().tell(&["fire", "behavior", "--list-fuels"]).expect_code(0).stdout;
    assert!(["R01", "GR2", "SB4", "NB9"].iter().all(|code| text.contains(code)), "{text}");
    assert_eq!(object(&["fire", "behavior", "--list-fuels", "--json"]).as_array().map(Vec::len), Some(58));
}

#[test]
fn conditions_that_cannot_be_are_refused() {
    let story = Story::begin();
    for (wrong, fragment) in [
        (&["--fuel", "GR10"][..], "the nearest is GR9 (109)"),
        (&["--fuel", "14"], "the nearest is R13 (13) or NB1 (91)"),
        (&["--fuel", "grass"], "--list-fuels prints all"),
        (&["--fuel", "1", "--slope", "30"], "30 percent is 0.3"),
        (&["--fuel", "1", "--moisture", "6,7,8,60,90"], "6 percent is 0.06"),
        (&["--fuel", "1", "--moisture", "0.06,0.07,0.08,0.6"], "expected D1,D10,D100,HERB,WOODY"),
        (&["--fuel", "1", "--wind", "-1"], "metres per second from 0 to 100"),
        (&["--fuel", "1", "--wind-from", "west"], "degrees clockwise from north"),
        (&["--fuel", "1", "--azimuths", "0,..."], "two azimuths before the three points"),
        (&[], "--list-fuels"),
        (&["--conditions", "in.csv"], "--csv"),
    ] {
        refuse(&story, &[&["fire", "behavior"], wrong].concat(), &[fragment]);
    }
}

#[test]
fn broken_tables_of_conditions_are_refused_with_line_and_column() {
    let story = Story::begin();
    let row = "102,0.06,0.07,0.08,0.6,0.9,5,270,0.3,180";
    for (text, fragment) in [
        (String::new(), "the file is empty; expected a header with the columns number,m_1h"),
        ("number\n102\n".to_owned(), "line 1: the column m_1h is missing"),
        (format!("{HEADER},number\n"), "line 1: the column number appears twice"),
        (format!("{HEADER},flame_m\n"), "line 1: the column flame_m already exists"),
        (format!("{HEADER}\n{row}\n{row},1\n"), "line 3: found 11 columns, expected 10"),
        (format!("{HEADER}\n100{}\n", &row[3..]), "line 2, column number: found \"100\", expected the code or number"),
        (format!("{HEADER}\n102.5{}\n", &row[3..]), "line 2, column number: found \"102.5\""),
        (format!("{HEADER}\n102,6{}\n", &row[8..]), "line 2, column m_1h: found \"6\", expected a number from 0 to 1"),
        (format!("{HEADER}\n{}30,180\n", &row[..33]), "line 2, column slope_rise_run: found \"30\""),
        (format!("{HEADER},wind_limit\n{row},0.5\n"), "line 2, column wind_limit: found \"0.5\", expected 1"),
        (format!("{HEADER}\n{row}\n\n{}\n", row.replace("270", "nan")), "line 4, column wind_from_deg: found \"nan\""),
    ] {
        story.file("in.csv", &text);
        let arguments = ["fire", "behavior", "--conditions", "in.csv", "--csv", "out.csv"];
        refuse(&story, &arguments, &["in.csv: ", fragment]);
    }
}

#[test]
fn automaton_burns_the_same_with_any_number_of_threads() {
    let burn = |jobs: &str| {
        let story = Story::begin();
        let field = ["fire", "spread", "--model", "alexandridis", "--rows", "41", "--cols", "31", "--ignite", "20,15"];
        let runs = ["--p0", "0.3", "--wind", "4@225", "--runs", "37", "--seed", "5", "--areas", "areas.csv"];
        let answer = story.tell(&[&field[..], &runs, &["--jobs", jobs, "--json"]].concat()).expect_code(0);
        (answer.stdout, story.read("areas.csv"))
    };
    let (object, areas) = burn("1");
    assert_eq!((object.clone(), areas.clone()), burn("4"));
    assert_eq!((object.clone(), areas.clone()), burn("64"));
    let object: Value = serde_json::from_str(&object).expect("it is JSON");
    let rows: Vec<f64> = areas
        .lines()
        .skip(1)
        .map(|row| row.split(',').nth(1).and_then(|area| area.parse().ok()).expect("an area"))
        .collect();
    assert_eq!((areas.lines().next(), rows.len()), (Some("run,area,last_step"), 37));
    let mean = rows.iter().sum::<f64>() / 37.0;
    assert!((object["area_mean"].as_f64().expect("a mean") - mean).abs() < 1e-9);
    // A run is that of its seed alone.
    let story = Story::begin();
    let field = ["fire", "spread", "--model", "alexandridis", "--rows", "41", "--cols", "31", "--ignite", "20,15"];
    let runs = ["--p0", "0.3", "--wind", "4@225", "--runs", "1", "--seed", "15", "--areas", "areas.csv"];
    story.tell(&[&field[..], &runs].concat()).expect_code(0);
    assert_eq!(
        story.read("areas.csv").lines().nth(1),
        areas.lines().nth(11).map(|row| row.replace("10,", "0,")).as_deref()
    );
}

const CELLS: &str = "table,dry_bulb,relative_humidity,month,shading,aspect,slope,time_of_day,elevation\n";
const ATTACKS: &str = "report_rate_ch_h,report_size_acre,length_to_width,tactic,line_offset_ch,\
                       resources_arrival_min:duration_min:production_ch_h\n";
const BRANDS: &str = "source,location,ridge_to_valley_distance_mi,ridge_to_valley_elevation_ft,\
                      downwind_cover_height_ft,downwind_canopy,wind_20ft_mi_h,flame_ft,torching_trees,dbh_in,\
                      tree_height_ft,species\n";

#[test]
fn calculators_write_answers_behind_the_columns_of_a_table() {
    let story = Story::begin();
    story.file("cells.csv", &format!("{CELLS}reference,3,4,,,,,,\ncorrection,,,0,1,2,0,3,1\n"));
    let table = story.tell(&["fire", "moisture", "--csv", "cells.csv"]).expect_code(0).stdout;
    let answers: Vec<&str> = table.lines().filter_map(|line| line.rsplit(',').next()).collect();
    assert_eq!(answers, ["fine_moisture_pct", "3", "3"]);
    story.file("attacks.csv", &format!("{ATTACKS}5,1,3,head,0,120:480:20\n20,1,3,rear,1,30:60:6|40:50:6\n"));
    let hours = "air_temperature_c,relative_humidity_fraction,solar_w_m2,rain_in_hour_cm\n3,0.2,0,0\n3,0.2,0,0\n";
    story.file("hours.csv", hours);
    let sticks = story.tell(&["fire", "sticks", "--csv", "hours.csv"]).expect_code(0).stdout;
    // The sky is as warm as the air, and so are the sticks.
    assert!(sticks.lines().nth(2).is_some_and(|row| row.split(',').nth(5) == Some("3")), "{sticks}");
    let steps = ["fire", "contain", "--csv", "attacks.csv", "--min-steps", "250", "--out", "contained.csv"];
    assert!(story.tell(&steps).expect_code(0).stderr.contains("wrote contained.csv: answers to 2 rows"));
    let contained = story.read("contained.csv");
    assert!(contained.contains("120:480:20,contained,238.75,39.5398"), "{contained}");
    assert!(contained.contains("40:50:6,exhausted,90,"), "{contained}");
    let pile = "burning_pile,ridge_top,1,2000,30,closed,5,5,,,,";
    story.file("brands.csv", &format!("{BRANDS}{pile}\nactive_crown,ridge_top,1,2000,,closed,5,20,,,30,\n"));
    let brands = story.tell(&["fire", "spotting", "--csv", "brands.csv"]).expect_code(0).stdout;
    assert!(brands.contains(",0,0,61,30,0,0.01706") && brands.ends_with(",30,,,,,,,,\n"), "{brands}");
}

#[test]
fn calculators_refuse_rows_by_line_and_column() {
    let story = Story::begin();
    let tree = "torching_trees,ridge_top,1,2000,30,closed,5,,15,20,30";
    for (command, table, sentence) in [
        ("moisture", format!("{CELLS}both,3,4,,,,,,\n"), "line 2, column table: found \"both\", expected reference or"),
        ("moisture", format!("{CELLS}reference,3,,,,,,,\n"), "line 2, column relative_humidity: found \"\", expected"),
        ("moisture", format!("{CELLS}correction,,,0,0,1.5,0,0,0\n"), "column aspect: found \"1.5\", expected a whole"),
        ("contain", format!("{ATTACKS}5,1,3,flank,0,1:2:3\n"), "column tactic: found \"flank\", expected head or rear"),
        ("contain", format!("{ATTACKS}5,1,3,head,0,1:2:3|4:5\n"), "found \"1:2:3|4:5\", expected ARRIVAL:DURATION"),
        ("spotting", format!("{BRANDS}{tree},\n"), "column species: found \"\", expected a number for this kind"),
        ("spotting", format!("{BRANDS}{tree},0.5\n"), "column species: found \"0.5\", expected a whole number"),
        ("spotting", "source\n".to_owned(), "line 1: the column location is missing"),
    ] {
        story.file("in.csv", &table);
        let refused = story.tell(&["fire", command, "--csv", "in.csv", "--out", "out.csv"]).expect_code(2).stderr;
        assert!(refused.contains(sentence), "{sentence}: {refused}");
        assert!(!story.path("out.csv").exists(), "{sentence}");
    }
}

#[test]
fn custom_fuels_of_a_file_burn_like_built_in_ones_of_the_same_numbers() {
    let story = Story::begin();
    story.file("mine.fmd", "ENGLISH\n14 MINE 0.10 0 0 1.00 0 dynamic 2000 1800 0 1.0 15 8000 8000 Low grass\n");
    let burn = |fuel: &[&str]| {
        let usual = ["fire", "spread", "--rows", "41", "--cols", "41", "--wind", "3@250", "--arrival", "times.asc"];
        story.tell(&[&usual[..], fuel].concat()).expect_code(0);
        story.read("times.asc")
    };
    let built_in = burn(&["--fuel", "GR2"]);
    assert_eq!(burn(&["--fuel", "14", "--fuel-models", "mine.fmd"]), built_in);
    story
        .file("fuel.asc", &format!("ncols 41\nnrows 41\nxllcorner 0\nyllcorner 0\ncellsize 5\n{}", "14 ".repeat(1681)));
    assert_eq!(burn(&["--fuel", "fuel.asc", "--fuel-models", "mine.fmd"]), built_in);
    let refused = story.tell(&["fire", "spread", "--fuel", "fuel.asc"]).expect_code(2).stderr;
    assert!(refused.contains("fuel.asc: row 0, column 0: found 14, expected the number of a fuel model"), "{refused}");
    let scenario = "name = \"mine\"\nduration_s = 1200\nwumpus = []\nunimog = []\nfuel_file = \"mine.fmd\"\n\
        [[fuel]]\nnumber = 300\nloads_kg_m2 = [0.4, 0, 0, 0, 0.6]\nsavs_per_m = [6000, 0, 5000]\ndepth_m = 0.7\n\
        extinction = 0.2\n[field]\nsize_m = 200\n[fire]\nmodel = \"rothermel\"\n\
        [fire.rothermel]\nground = 14\nbushes = 300\n[[wind]]\nspeed_mps = 3\ntoward_deg = 20\n\
        [[ignition]]\nat_s = 0\ncells = [[20, 20]]\n";
    story.file("mine.toml", scenario);
    let checked = story.tell(&["check", "mine.toml", "--all"]).expect_code(0).stdout;
    assert!(checked.contains("Custom fuel models (file mine.fmd): 14 MINE, 300 300."), "{checked}");
    assert!(checked.contains("MINE (Low grass) 90 %"), "{checked}");
    story.tell(&["run", "mine.toml", "--out", "mine.wildfire"]).expect_code(0);
    story.tell(&["audit", "mine.wildfire"]).expect_code(0);
    story.tell(&["batch", "mine.toml", "--seeds", "1..2", "--out", "mine"]).expect_code(0);
    for (wrong, expected) in [
        ("--set=fire.rothermel.ground=15", "expected a built-in fuel model, or one of `[[fuel]]` or `fuel_file`"),
        ("--set=fuel.0.number=14", "there are two fuel models 14"),
        ("--set=fuel.0.depth_m=0", "depth_m"),
        ("--set=fuel_file=none.fmd", "none.fmd: "),
    ] {
        let refused = story.tell(&["check", "mine.toml", wrong]).expect_code(2).stderr;
        assert!(refused.contains(expected), "{refused}");
    }
}

/// A grid of 20 x 20 cells of 20 m, a value by row from the north and column.
fn grid(value: impl Fn(usize, usize) -> String) -> String {
    let rows = (0..20).map(|row| (0..20).map(|col| value(row, col)).collect::<Vec<_>>().join(" "));
    let head = "ncols 20\nnrows 20\nxllcorner 1000\nyllcorner 2000\ncellsize 20\nNODATA_value -9999\n";
    head.to_owned() + &rows.collect::<Vec<_>>().join("\n")
}

const LOCAL: &str = "name = \"local\"\nduration_s = 3000\nwumpus = []\nunimog = []\n[field]\ncoverage = 0\n\
    [fire]\nmodel = \"rothermel\"\n[fire.rothermel]\nfuel_map = \"fuel.asc\"\n\
    [[wind]]\nspeed = \"speed.asc\"\nfrom = \"from.asc\"\n[[wind]]\nat_s = 1500\nspeed_mps = 2\ntoward_deg = 90\n";

fn local_story(rest: &str) -> Story {
    let story = Story::begin();
    story.file("fuel.asc", &grid(|row, _| if row == 0 { "91".into() } else { "102".into() }));
    story.file("speed.asc", &grid(|row, _| (1 + row / 4).to_string()));
    story.file("from.asc", &grid(|_, col| (250 + col).to_string()));
    story.file("local.toml", &format!("{LOCAL}{rest}"));
    story
}

#[test]
fn wind_by_place_is_checked_recorded_audited_and_the_same_in_spread_and_runs() {
    let story = local_story("[[ignition]]\nat_s = 0\npoints_m = [[1090, 2110]]\n");
    let checked = story.tell(&["check", "local.toml", "--all"]).expect_code(0).stdout;
    assert!(checked.contains("From 0 s: by place, 0.995 to 5.006 m/s, on average 2.985 m/s"), "{checked}");
    story.tell(&["run", "local.toml", "--out", "local.wildfire"]).expect_code(0);
    story.tell(&["audit", "local.wildfire"]).expect_code(0);
    story.tell(&["map-of", "local.wildfire", "--arrival", "--asc", "run.asc"]).expect_code(0);
    story.tell(&["render", "local.toml", "--at", "600", "--out", "local.png"]).expect_code(0);
    let winds = ["--wind-speed", "speed.asc", "--wind-from", "from.asc"];
    let usual =
        ["fire", "spread", "--fuel", "fuel.asc", "--ignite", "5,4", "--duration", "1500", "--arrival", "alone.asc"];
    let answer = story.tell(&[&usual[..], &winds].concat()).expect_code(0).stdout;
    assert!(answer.contains("Wind at 10 m: by place 1.0 to 5.0 m/s, on average 2.98 m/s from"), "{answer}");
    let times = |file| -> Vec<f64> {
        story
            .read(file)
            .lines()
            .skip(6)
            .flat_map(str::split_whitespace)
            .map(|it| it.parse().expect("a number"))
            .collect()
    };
    let run = times("run.asc");
    let alone = times("alone.asc");
    assert_eq!(run.len(), 400);
    let early = run.iter().zip(&alone).filter(|(run, _)| (0.0..1500.0).contains(*run));
    assert!(early.clone().count() > 20 && early.clone().all(|(run, alone)| run == alone));
    story.file(
        "winds.atm",
        "WINDS_AND_CLOUDS\nMETRIC\n7 14 1200 speed.asc from.asc clouds.asc\n7 14 1230 none.asc from.asc\n",
    );
    let listed = story.tell(&[&usual[..], &["--wind-list", "winds.atm"]].concat()).expect_code(0).stdout;
    assert!(listed.contains("by place 0.3 to 1.4 m/s"), "{listed}");
    let refused = story.tell(&["fire", "spread", "--fuel", "fuel.asc", "--wind-list", "winds.atm"]).expect_code(2);
    assert!(refused.stderr.contains("none.asc"), "{}", refused.stderr);
    for (wrong, expected) in [
        ("--set=wind.0.from=fuel.toml", "fuel.toml"),
        ("--set=wind.0.toward=from.asc", "expected `speed` and `from`, `speed` and `toward`, or `east` and `north`"),
        ("--set=wind.0.speed_mps=3", "expected no `speed_mps`"),
    ] {
        let refused = story.tell(&["check", "local.toml", wrong]).expect_code(2).stderr;
        assert!(refused.contains(expected), "{refused}");
    }
}

#[test]
fn fires_that_exist_begin_as_perimeters_and_stop_at_barriers() {
    let square = |west: u32, south: u32, east: u32, north: u32| {
        format!("[[{west}, {south}], [{east}, {south}], [{east}, {north}], [{west}, {north}], [{west}, {south}]]")
    };
    let polygon = |rings: &str| format!("{{\"type\": \"Polygon\", \"coordinates\": [{rings}]}}");
    let rest = "[[ignition]]\nat_s = 60\nperimeter = \"fire.geojson\"\n[[barrier]]\nfile = \"line.geojson\"\n";
    let story = local_story(rest);
    story.file("fire.geojson", &polygon(&square(1100, 2100, 1160, 2160)));
    story.file("line.geojson", "{\"type\": \"LineString\", \"coordinates\": [[1210, 2000], [1210, 2399]]}");
    story.tell(&["run", "local.toml", "--out", "local.wildfire"]).expect_code(0);
    story.tell(&["audit", "local.wildfire"]).expect_code(0);
    story.tell(&["map-of", "local.wildfire", "--arrival", "--asc", "times.asc"]).expect_code(0);
    let times: Vec<f64> = story
        .read("times.asc")
        .lines()
        .skip(6)
        .flat_map(str::split_whitespace)
        .map(|it| it.parse().expect("one"))
        .collect();
    assert_eq!(times.iter().filter(|&&time| time == 60.0).count(), 9, "three by three cells burn from then on");
    let is_burned: Vec<bool> = times.iter().map(|&time| time > 60.0).collect();
    let [west, east] =
        [0..10, 10..20].map(|cols| (0..400).filter(|index| is_burned[*index] && cols.contains(&(index % 20))).count());
    assert!(west > 20 && east == 0, "{west} cells burn west of the line, {east} beyond it");
    story.tell(&["batch", "local.toml", "--seeds", "1..2", "--record", "all", "--out", "fires"]).expect_code(0);
    let table = story.read("fires/runs.csv");
    assert!(table.contains("contained_at_s,contained_ha,escaped"), "{table}");
    story.tell(&["map-of", "fires", "--flame-class", "1", "--asc", "class.asc"]).expect_code(0);
    for (file, shape, expected) in [
        ("fire.geojson", polygon(&square(0, 0, 60, 60)), "fire.geojson: its polygons reach from (0, 0) to (60, 60)"),
        (
            "fire.geojson",
            polygon("[[1100, 2100], [1160, 2160], [1160, 2100], [1100, 2160], [1100, 2100]]"),
            "fire.geojson: a ring crosses itself at (1130, 2130)",
        ),
        ("fire.geojson", "{\"type\": \"Polygon\"".to_owned(), "fire.geojson:1:"),
        ("line.geojson", "{\"type\": \"Point\", \"coordinates\": [0, 0]}".to_owned(), "line.geojson: it has no line"),
    ] {
        let before = story.read(file);
        story.file(file, &shape);
        let refused = story.tell(&["check", "local.toml"]).expect_code(2).stderr;
        assert!(refused.contains(expected), "{refused}");
        story.file(file, &before);
    }
    let refused =
        story.tell(&["check", "local.toml", "--set=ignition.0={at_s=0,points_m=[[0,0]]}"]).expect_code(2).stderr;
    assert!(refused.contains("there is no cell at (0, 0)"), "{refused}");
}
