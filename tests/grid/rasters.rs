//! Rasters that this program writes, read by GDAL, and files that GDAL writes, read by this program, where it is installed.
//!
//! With `WILDFIRE_GDAL=required` it must be; elsewhere the tests print that it is missing, and pass.

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

#[expect(clippy::print_stdout, reason = "says why nothing was compared")]
fn without_gdal() {
    let is_required = std::env::var_os("WILDFIRE_GDAL").is_some_and(|value| value == "required");
    assert!(!is_required, "GDAL is missing");
    println!("GDAL is not installed: nothing was compared");
}

/// Lets `gdal_translate` write a file; `None` if there is no such program.
fn translated(from: &Path, to: &Path, options: &str) -> Option<()> {
    let output = Command::new("gdal_translate").arg("-q").args(options.split(' ')).args([from, to]).output().ok()?;
    assert!(output.status.success(), "{options}: {}", String::from_utf8_lossy(&output.stderr));
    Some(())
}

/// Layers as downloads have them, of whole numbers with a rim without data, in all layouts, packings and predictors: tiles
/// beyond the image, files that leave out what has no value, and rows from south to north among them.
#[test]
fn what_gdal_writes_is_read() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let (rows, cols) = (201, 217);
    let value = |index: usize| {
        let (row, col) = (index / cols, index % cols);
        let is_rim = row.min(rows - 1 - row).min(col) < 70 || col > 150 + row % 11;
        if is_rim { 0.0 } else { [101, 102, 122, 98][(index * index / 7 + row) % 4] as f32 }
    };
    let values: Vec<f32> = (0..rows * cols).map(value).collect();
    let (west_m, south_m, cell_m, nodata) = (500_000.0, 4_000_000.0, 30.0, Some(0.0));
    let layer = Raster { rows, cols, west_m, south_m, cell_m, values, nodata, crs: None };
    let (asc, tif) = (folder.path().join("layer.asc"), folder.path().join("layer.tif"));
    raster::write_asc(&asc, &layer).expect("the scratch folder takes files");
    let mut count = 0;
    let layouts = ["TILED=NO", "TILED=YES -co BLOCKXSIZE=64 -co BLOCKYSIZE=64"];
    let more = ["BIGTIFF=NO", "BIGTIFF=YES", "ENDIANNESS=BIG", "SPARSE_OK=TRUE"];
    for (packing, predictors) in [("NONE", 1), ("PACKBITS", 1), ("LZW", 3), ("DEFLATE", 3), ("ZSTD", 3)] {
        for kind in ["Byte", "Int16", "UInt16", "Int32", "Float32", "Float64"] {
            let fits = |predictor: &i32| *predictor < 3 || kind.starts_with("Float");
            for (predictor, layout) in (1..=predictors).filter(fits).flat_map(|it| layouts.map(|layout| (it, layout))) {
                // GDAL 3.6 reads as zeros what it wrote by the predictor of floating-point numbers in the other order of bytes.
                let more = more[count / 2 % if predictor == 3 { 2 } else { 4 }];
                let options =
                    format!("-ot {kind} -co COMPRESS={packing} -co PREDICTOR={predictor} -co {layout} -co {more}");
                if translated(&asc, &tif, &options).is_none() {
                    return without_gdal();
                }
                let found = raster::read(&tif).unwrap_or_else(|error| panic!("{options}: {error}"));
                let place = (found.west_m, found.south_m, found.cell_m, found.nodata);
                assert_eq!(place, (layer.west_m, layer.south_m, layer.cell_m, layer.nodata), "{options}");
                assert!(found.values == layer.values, "{options}: other values");
                count += 1;
            }
        }
    }
    println!("{count} files by gdal_translate are read");
    let [east_m, north_m] = [west_m + cols as f64 * cell_m, layer.north_m()];
    let options = format!("-a_ullr {west_m} {south_m} {east_m} {north_m} -co COMPRESS=LZW");
    translated(&asc, &tif, &options).expect("it was there before");
    let turned = raster::read(&tif).unwrap_or_else(|error| panic!("rows from south to north: {error}"));
    assert_eq!((turned.south_m, turned.north_m()), (south_m, north_m));
    assert!(turned.values.chunks(cols).eq(layer.values.chunks(cols).rev()), "the first row is the south one");
    // What is not read, with the command that helps.
    translated(&asc, &tif, "-co COMPRESS=LZMA").expect("it was there before");
    let refused = raster::read(&tif).expect_err("it is packed by LZMA").to_string();
    assert!(refused.contains("gdal_translate -co COMPRESS=DEFLATE in.tif out.tif"), "{refused}");
    let vrt = folder.path().join("layer.vrt");
    translated(&asc, &vrt, "-of VRT").expect("it was there before");
    let refused = raster::read(&vrt).expect_err("it is no raster").to_string();
    assert!(refused.contains("`gdal_translate in out.tif`"), "{refused}");
}

/// A stack as LANDFIRE's products have it, whose bands have names, by both orders of bands; and as a landscape file of FARSITE.
#[test]
fn all_bands_of_what_gdal_writes_are_read_with_their_names() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let (rows, cols, cell_m, nodata) = (90, 70, 30.0, Some(-9999.0));
    let (west_m, south_m) = (500_000.0, 4_000_000.0);
    let names = ["ELEV", "SLPD", "ASP", "FBFM40", "CC", "CH", "CBH", "CBD"];
    let mut vrt = format!(
        r#"<VRTDataset rasterXSize="{cols}" rasterYSize="{rows}"><SRS>EPSG:32611</SRS>
        <GeoTransform>{west_m}, 30, 0, {}, 0, -30</GeoTransform>"#,
        south_m + cell_m * rows as f64
    );
    let mut layers = Vec::new();
    for (number, name) in names.into_iter().enumerate() {
        let value = |index: usize| if index.is_multiple_of(97) { -9999.0 } else { ((index * 7 + number) % 91) as f32 };
        let values = (0..rows * cols).map(value).collect();
        let layer = Raster { rows, cols, west_m, south_m, cell_m, values, nodata, crs: None };
        raster::write_asc(&folder.path().join(format!("{name}.asc")), &layer).expect("the scratch folder takes files");
        vrt += &format!(
            r#"<VRTRasterBand dataType="Int16" band="{}"><Description>US_240{name}</Description>
            <NoDataValue>-9999</NoDataValue><SimpleSource><SourceFilename relativeToVRT="1">{name}.asc</SourceFilename>
            <SourceBand>1</SourceBand></SimpleSource></VRTRasterBand>"#,
            number + 1
        );
        layers.push(layer);
    }
    let (vrt_path, tif) = (folder.path().join("stack.vrt"), folder.path().join("stack.tif"));
    std::fs::write(&vrt_path, vrt + "</VRTDataset>").expect("the scratch folder takes files");
    let wrong = |path: &Path| raster::read(path).expect_err("it has eight bands").to_string();
    for options in ["", " -co TILED=YES -co BLOCKXSIZE=32 -co BLOCKYSIZE=32"] {
        for (order, packing) in [("PIXEL", "LZW"), ("PIXEL", "NONE"), ("BAND", "DEFLATE"), ("BAND", "LZW")] {
            let options = format!("-co INTERLEAVE={order} -co COMPRESS={packing}{options}");
            if translated(&vrt_path, &tif, &options).is_none() {
                return without_gdal();
            }
            let bands = raster::read_bands(&tif).unwrap_or_else(|error| panic!("{options}: {error}"));
            assert_eq!(bands.len(), 8, "{options}");
            for ((band, layer), name) in bands.iter().zip(&layers).zip(names) {
                assert_eq!(band.name, Some(format!("US_240{name}")), "{options}");
                let found = &band.raster;
                assert_eq!((found.west_m, found.south_m, found.nodata), (west_m, south_m, nodata), "{options}");
                assert!(found.values == layer.values, "{options}, {name}: other values");
            }
            assert!(wrong(&tif).contains("it has 8 bands, expected one"), "{options}");
        }
    }
    let lcp = folder.path().join("stack.lcp");
    let units = "-co HEIGHT_UNIT=METERS_X_10 -co CBH_UNIT=METERS_X_10 -co CBD_UNIT=KG_PER_CUBIC_METER_X_100";
    translated(&vrt_path, &lcp, &format!("-of LCP -co CALCULATE_STATS=NO -co LATITUDE=40 {units}"))
        .expect("it was there");
    let bands = raster::read_bands(&lcp).unwrap_or_else(|error| panic!("{error}"));
    for (band, layer) in bands.iter().zip(&layers) {
        assert_eq!((band.raster.west_m, band.raster.south_m, band.raster.cell_m), (west_m, south_m, cell_m));
        assert!(band.raster.values == layer.values, "{:?}: other values", band.name);
    }
    let found: Vec<_> = bands.iter().filter_map(|band| band.name.as_deref()).collect();
    assert_eq!(found, ["ELEV", "SLPD", "ASP", "FBFM", "CC", "CH", "CBH", "CBD"]);
    assert!(wrong(&lcp).contains("it has 8 bands, expected one"));
    // What is cut off or damaged ends in a sentence.
    let bytes = std::fs::read(&lcp).expect("it was written");
    for (at, number, expected) in [(4164, -5_i32, "0 columns"), (4164, 99, "cannot hold"), (4204, 9, "in unit 9")] {
        let mut damaged = bytes.clone();
        damaged[at..at + 4].copy_from_slice(&number.to_le_bytes());
        std::fs::write(&lcp, damaged).expect("the scratch folder takes files");
        let refused = raster::read_bands(&lcp).expect_err("it is damaged").to_string();
        assert!(refused.contains(expected), "{refused}");
    }
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
        let Some(found) = gdalinfo(&path) else { return without_gdal() };
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
    let bands = folder.path().join("bands.tif");
    raster::write_geotiff_bands(&bands, &[("First (s)", &written), ("Second", &written)]).expect("it fits");
    let found = gdalinfo(&bands).expect("it was there");
    for (band, name) in ["First (s)", "Second"].into_iter().enumerate() {
        let band = &found["bands"][band];
        assert_eq!(
            (&band["description"], &band["noDataValue"]),
            (&Json::from(name), &Json::from(-9999.0)),
            "{found:#}"
        );
        assert_eq!(band["computedMax"].as_f64(), Some(most.into()), "{found:#}");
    }
}
