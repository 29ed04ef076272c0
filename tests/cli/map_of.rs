//! `wildfire map-of`, from runs and batches to their rasters, arrays and figures.

use std::fs;

use serde_json::Value;
use wildfire::map_files::raster;

use crate::story::{Story, refuse};

/// Values of an array with eight bytes each, after the header of its file.
fn array(story: &Story, name: &str) -> Vec<f64> {
    let bytes = fs::read(story.path(name)).expect("it was written");
    let header = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[10 + header..].as_chunks().0.iter().map(|value| f64::from_le_bytes(*value)).collect()
}

fn object(text: &str) -> Value {
    serde_json::from_str(text).expect("it is JSON")
}

#[test]
fn one_run_is_the_same_in_every_file() {
    let story = Story::begin();
    let map = ["map-of", "smoke", "--seed", "3", "--arrival"];
    let files = ["--asc", "a.asc", "--tif", "a.tif", "--npy", "a.npy", "--png", "a.png", "--json"];
    let report = object(&story.tell(&[&map[..], &files].concat()).expect_code(0).stdout);
    let values = array(&story, "a.npy");
    let burned = values.iter().filter(|value| value.is_finite()).count();
    assert!(burned > 0);
    assert_eq!(report["burned_cells"], burned);
    assert_eq!(report["burned_bushes"], burned, "only bushes burn there");
    for name in ["a.asc", "a.tif"] {
        let raster = raster::read(&story.path(name)).expect("it is a raster");
        assert_eq!(raster.rows * raster.cols, values.len());
        assert_eq!(raster.nodata, Some(-9999.0));
        // The first row of the array is the north row.
        for (index, &value) in values.iter().enumerate() {
            let (row, col) = (raster.rows - 1 - index / raster.cols, index % raster.cols);
            let expected = if value.is_nan() { -9999.0 } else { value as f32 };
            assert_eq!(raster.value(row, col), expected, "{name}, {index}");
        }
    }
    assert!(fs::read(story.path("a.png")).expect("it was drawn").starts_with(b"\x89PNG"));
    // A recording of the run gives the same map.
    story.tell(&["run", "smoke", "--seed", "3", "--out", "run.wildfire"]).expect_code(0);
    story.tell(&["map-of", "run.wildfire", "--arrival", "--npy", "b.npy"]).expect_code(0);
    assert_eq!(fs::read(story.path("a.npy")).expect("read"), fs::read(story.path("b.npy")).expect("read"));
}

#[test]
fn batches_give_one_map_whatever_was_recorded_and_however_many_threads() {
    let story = Story::begin();
    for (folder, record) in [("kept", "all"), ("again", "none")] {
        story.tell(&["batch", "smoke", "--seeds", "1..7", "--record", record, "--out", folder]).expect_code(0);
    }
    let map = |folder: &str, jobs: &str, quantity: &str, file: &str| {
        let args = ["map-of", folder, quantity, "--jobs", jobs, "--npy", file, "--json"];
        object(&story.tell(&args).expect_code(0).stdout)
    };
    for quantity in ["--burn-probability", "--mean-arrival"] {
        let kept = map("kept", "1", quantity, "kept.npy");
        let again = map("again", "3", quantity, "again.npy");
        assert_eq!((&kept["recorded"], &kept["simulated"]), (&7.into(), &0.into()));
        assert_eq!((&again["recorded"], &again["simulated"]), (&0.into(), &7.into()));
        assert_eq!(kept["sides"][0]["burned_cells"], again["sides"][0]["burned_cells"]);
        assert_eq!(fs::read(story.path("kept.npy")).expect("read"), fs::read(story.path("again.npy")).expect("read"));
    }
    // The expected number of burned cells is the sum of the probabilities.
    let report = map("kept", "2", "--burn-probability", "kept.npy");
    let sum: f64 = array(&story, "kept.npy").into_iter().filter(|value| value.is_finite()).sum();
    let mean = report["sides"][0]["burned_cells"]["mean"].as_f64().expect("a number");
    assert!((sum - mean).abs() < 1e-9 * mean, "{sum} and {mean}");
}

#[test]
fn differences_are_paired_and_have_intervals() {
    let story = Story::begin();
    for (folder, change) in [("trucks", "suppression.dwell_s=5"), ("idle", "suppression.dwell_s=100000")] {
        story.tell(&["batch", "smoke", "--seeds", "1..6", "--set", change, "--out", folder]).expect_code(0);
    }
    let minus = |first: &str, second: &str, file: &str| {
        let args = ["map-of", first, "--burn-probability", "--minus", second, "--npy", file, "--json"];
        object(&story.tell(&args).expect_code(0).stdout)
    };
    let nothing = minus("trucks", "trucks", "nothing.npy");
    assert_eq!(nothing["difference"]["burned_cells"]["mean"], 0.0);
    assert!(array(&story, "nothing.npy").iter().all(|value| value.is_nan() || *value == 0.0));
    let report = minus("trucks", "idle", "worth.npy");
    let [mean, lower, upper] = ["worth.npy", "worth-lower.npy", "worth-upper.npy"].map(|name| array(&story, name));
    let ordered = mean.iter().zip(&lower).zip(&upper).filter(|((mean, _), _)| mean.is_finite());
    assert!(ordered.clone().count() > 0);
    for ((mean, lower), upper) in ordered {
        assert!((-1.0..=1.0).contains(mean) && lower <= upper);
    }
    // Sooner or later all bushes are lit there; trucks put some of them out.
    let worth = report["difference"]["lost_bushes"]["mean"].as_f64().expect("a number");
    assert!(worth < 0.0, "trucks put fires out: {worth}");
    // Pictures of three maps, by one command.
    story.tell(&["map-of", "trucks", "--mean-arrival", "--minus", "idle", "--png", "three.png"]).expect_code(0);
    let text = story.tell(&["map-of", "trucks", "--burn-probability", "--minus", "idle"]).expect_code(0).stdout;
    assert!(text.contains("6 pairs") && text.contains("difference"), "{text}");
}

#[test]
fn variants_are_chosen_by_their_columns() {
    let story = Story::begin();
    let planners = ["batch", "smoke", "--seeds", "1..2", "--planner", "lattice,hybrid-astar", "--out", "both"];
    story.tell(&planners).expect_code(0);
    refuse(&story, &["map-of", "both", "--burn-probability"], &["2 variants", "lattice", "planner", "--where"]);
    refuse(&story, &["map-of", "both", "--burn-probability", "--where", "plan=a"], &["no column `plan`", "planner"]);
    refuse(&story, &["map-of", "both", "--burn-probability", "--where", "planner=a"], &["no variants", "lattice"]);
    let lattice = ["map-of", "both", "--burn-probability", "--where", "planner=lattice"];
    story.tell(&lattice).expect_code(0);
    let other = ["--minus", "both", "--minus-where", "planner=hybrid-astar"];
    story.tell(&[&lattice[..], &other].concat()).expect_code(0);
    // One run of a batch, by its seed.
    let one = ["map-of", "both", "--arrival", "--where", "planner=lattice", "--seed"];
    story.tell(&[&one[..], &["2"]].concat()).expect_code(0);
    refuse(&story, &[&one[..], &["9"]].concat(), &["no seed 9", "1..2"]);
}

#[test]
fn what_has_no_map_is_refused() {
    let story = Story::begin();
    for (folder, scenario, seeds) in [("a", "smoke", "1..2"), ("later", "smoke", "7..8"), ("large", "contest", "1..2")]
    {
        let args = ["batch", scenario, "--seeds", seeds, "--set", "duration_s=60", "--out", folder];
        story.tell(&args).expect_code(0);
    }
    story.tell(&["batch", "smoke", "--seeds", "1..2", "--set", "field.coverage=0.05", "--out", "thin"]).expect_code(0);
    refuse(&story, &["map-of", "smoke", "--intensity"], &["only bushes burn", "rothermel"]);
    refuse(&story, &["map-of", "a", "--mean-intensity"], &["only bushes burn", "rothermel"]);
    refuse(&story, &["map-of", "smoke", "--burn-probability"], &["smoke is no folder of a batch"]);
    refuse(&story, &["map-of", "smoke", "--arrival", "--minus", "a"], &["--minus takes off a batch"]);
    refuse(&story, &["map-of", "a", "--burn-probability", "--seed", "1"], &["no --seed"]);
    refuse(&story, &["map-of", "smoke", "--arrival", "--where", "planner=lattice"], &["--where chooses"]);
    let minus = |other: &'static str| ["map-of", "a", "--burn-probability", "--minus", other];
    refuse(&story, &minus("later"), &["seeds", "both"]);
    refuse(&story, &minus("large"), &["field", "50 x 50"]);
    refuse(&story, &minus("thin"), &["seed 1", "different ground"]);
    refuse(&story, &["map-of", "smoke", "--arrival", "--png", "a.gif"], &["a.gif", ".png"]);
    refuse(&story, &["map-of", "smoke", "--arrival", "--asc", "a.tif"], &["a.tif", ".asc"]);
    let twice = ["--minus", "a", "--npy", "x.npy", "--asc", "x-lower.asc", "--tif", "y.tif"];
    story.tell(&[&["map-of", "a", "--burn-probability"][..], &twice].concat()).expect_code(0);
    refuse(&story, &["map-of", "smoke"], &["--arrival"]);
    refuse(&story, &["map-of", "smoke", "--arrival", "--intensity"], &["cannot be used with"]);
}
