//! Rasters that this program writes, read by another program: `gdalinfo` of GDAL, where it is installed.
//!
//! With `WILDFIRE_GDAL=required` it must be; elsewhere the test says that it is missing, and passes.

use std::path::Path;
use std::process::Command;

use serde_json::Value as Json;
use wildfire::map_files::raster::{self, Raster};

/// What `gdalinfo` says of a file; `None` if there is no such program.
fn gdalinfo(path: &Path) -> Option<Json> {
    let output = Command::new("gdalinfo").args(["-json", "-mm", "-nomd"]).arg(path).output().ok()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).expect("gdalinfo -json writes JSON"))
}

#[test]
fn gdal_reads_what_was_written() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let (rows, cols) = (300, 517);
    let values = (0..rows * cols).map(|index| if index % 7 == 3 { -9999.0 } else { 0.5 * index as f32 }).collect();
    let (west_m, south_m, cell_m, nodata) = (-1_234_567.5, 2_345_670.0, 30.0, Some(-9999.0));
    let written = Raster { rows, cols, west_m, south_m, cell_m, values, nodata, crs: None };
    let (least, most) = written.range().expect("most cells have a value");
    let (tif, asc) = (folder.path().join("map.tif"), folder.path().join("map.asc"));
    raster::write_geotiff(&tif, &written).expect("the scratch folder takes files");
    raster::write_asc(&asc, &written).expect("the scratch folder takes files");
    for path in [tif, asc] {
        let Some(found) = gdalinfo(&path) else {
            let is_required = std::env::var_os("WILDFIRE_GDAL").is_some_and(|value| value == "required");
            assert!(!is_required, "gdalinfo is missing");
            println!("gdalinfo is not installed: nothing was compared");
            return;
        };
        assert_eq!(found["size"], serde_json::json!([cols, rows]), "{found:#}");
        let north_m = south_m + rows as f64 * cell_m;
        let expected = serde_json::json!([west_m, cell_m, 0.0, north_m, 0.0, -cell_m]);
        assert_eq!(found["geoTransform"], expected, "{found:#}");
        let band = &found["bands"][0];
        assert_eq!(
            (band["type"].as_str(), band["noDataValue"].as_f64()),
            (Some("Float32"), Some(-9999.0)),
            "{found:#}"
        );
        let extremes = [&band["computedMin"], &band["computedMax"]].map(Json::as_f64);
        assert_eq!(extremes, [Some(least.into()), Some(most.into())], "{found:#}");
        println!("{}: gdalinfo finds size, origin, cells, no-data value, least and greatest value", path.display());
    }
}
