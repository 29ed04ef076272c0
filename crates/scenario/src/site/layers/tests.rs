//! Layers of small rasters.

use std::path::{Path, PathBuf};

use super::kind::FLAT;
use super::slopes::gradient;
use super::units::doubt_of_trees;
use super::*;
use wildfire_base::geometry::ops;
use wildfire_grid::map_files::raster::{self, Band, Raster};

/// Writes a raster of 2 rows and 3 columns, the south row first.
fn file(folder: &Path, name: &str, values: [f32; 6], change: impl FnOnce(&mut Raster)) -> PathBuf {
    let west_m = 500_000.0;
    let south_m = 4_000_000.0;
    let cell_m = 30.0;
    let nodata = Some(-9999.0);
    let mut raster = Raster { rows: 2, cols: 3, west_m, south_m, cell_m, values: values.to_vec(), nodata, crs: None };
    change(&mut raster);
    let path = folder.join(name);
    raster::write_asc(&path, &raster).expect("the scratch folder takes files");
    path
}

const FUELS: [f32; 6] = [102.0, 102.0, 98.0, 145.0, 99.0, 1.0];

#[test]
fn layers_survive_being_packed() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let heights = [1.5, -2.25, 300.0, 1e-3, 0.0, 8848.5];
    let mut reader = LayerReader::default();
    reader.read(LayerKind::Fuel, &file(folder.path(), "fuel.asc", FUELS, |_| ())).expect("it is right");
    reader.read(LayerKind::Elevation, &file(folder.path(), "dem.asc", heights, |_| ())).expect("it fits");
    let layers = reader.finish().expect("two were read");
    assert_eq!((layers.frame.cols, layers.frame.rows, layers.frame.cell_m), (3, 2, 30.0));
    assert_eq!(layers.fuel_or(0), FUELS.map(|number| number as u8));
    assert_eq!(layers.relief(), Some(Relief::Elevation(heights.to_vec())));
    let written = serde_json::to_string(&layers).expect("it is text and numbers");
    let read: ImportedLayers = serde_json::from_str(&written).expect("it was written so");
    assert!(read == layers && read.is_sound(&CustomFuels::default()));
    let broken = written.replacen("\"fuel\":\"", "\"fuel\":\"AAAA", 1);
    assert!(!serde_json::from_str::<ImportedLayers>(&broken).expect("it is text").is_sound(&CustomFuels::default()));
}

#[test]
fn slopes_face_downhill_and_gradients_point_uphill() {
    let [east, north] = gradient(45.0, 180.0);
    assert!(east == 0.0 && (north - 1.0).abs() < 1e-6, "a slope that faces south rises to the north");
    assert_eq!(gradient(30.0, -1.0), [0.0, 0.0]);
}

#[test]
fn ignitions_are_drawn_in_proportion_to_their_weights() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let file = file(folder.path(), "weights.asc", [0.0, 3.0, 0.0, 0.0, -9999.0, 1.0], |_| ());
    let frame = FieldFrame { cols: 3, rows: 2, cell_m: 30.0 };
    let weights = Some(Weights::read(&file, &frame, None).expect("it fits"));
    let density = crate::IgnitionDensity { file, count: 1, weights };
    let [heavy, light] = [(1, 0), (2, 1)].map(wildfire_base::geometry::Cell::from);
    let mut heavy_first = 0_u32;
    for seed in 0..1000 {
        let order = density.order(&frame, seed, 0);
        assert!(order == [heavy, light] || order == [light, heavy], "{order:?}");
        heavy_first += u32::from(order[0] == heavy);
    }
    // Three of four, standard deviation 14.
    assert!(heavy_first.abs_diff(750) < 70, "{heavy_first}");
}

#[test]
fn layers_that_do_not_fit_are_refused_with_file_row_and_column() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let fuel = file(folder.path(), "fuel.asc", FUELS, |_| ());
    let mut wrong = 0;
    let mut refusal = |kind, values, change: &dyn Fn(&mut Raster)| {
        wrong += 1;
        let path = file(folder.path(), &format!("{wrong}.asc"), values, change);
        let mut reader = LayerReader::default();
        reader.read(LayerKind::Fuel, &fuel).expect("it is right");
        reader.read(kind, &path).expect_err("it does not fit")
    };
    let mut with = |kind, value: f32| {
        let mut values = [1.0; 6];
        values[1] = value;
        refusal(kind, values, &|_| ())
    };
    for (kind, value, expected) in [
        (LayerKind::Fuel, 14.0, "row 1, column 1: found 14, expected the number of a fuel model"),
        (LayerKind::Fuel, 102.5, "found 102.5"),
        (LayerKind::Elevation, 12_000.0, "are these feet?"),
        (LayerKind::Slope, 110.0, "is this percent?"),
        (LayerKind::Aspect, 361.0, "a compass azimuth"),
    ] {
        let found = with(kind, value);
        assert!(found.contains(expected) && found.contains(".asc: row"), "{found}");
    }
    let flat = |change: &dyn Fn(&mut Raster)| {
        let path = file(folder.path(), "other.asc", [1.0; 6], change);
        let mut reader = LayerReader::default();
        reader.read(LayerKind::Fuel, &fuel).expect("it is right");
        reader.read(LayerKind::Elevation, &path).expect_err("it does not fit")
    };
    let shape = flat(&|raster| (raster.rows, raster.cols) = (3, 2));
    assert!(shape.contains("it has 3 rows and 2 columns, expected 2 and 3 as in"), "{shape}");
    assert!(flat(&|raster| raster.cell_m = 10.0).contains("its cells are of 10 m, expected 30 m"));
    assert!(flat(&|raster| raster.west_m += 1.0).contains("its south-west corner is at (500001, 4000000), expected"));
}

/// A raster of 20 rows and 24 columns of a function of east and north in metres, without data where it is NaN.
fn layer(value: impl Fn(f32, f32) -> f32) -> Raster {
    let place = |index: usize| (30.0 * (index % 24) as f32, 30.0 * (index / 24) as f32);
    let values = (0..480).map(|index| value(place(index).0, place(index).1)).collect();
    let west_m = 500_000.0;
    let south_m = 4_000_000.0;
    let cell_m = 30.0;
    Raster { rows: 20, cols: 24, west_m, south_m, cell_m, values, nodata: None, crs: None }
}

fn band(name: &str, raster: Raster) -> Band {
    Band { name: Some(name.to_owned()), unit: None, height_unit: None, raster }
}

#[test]
fn a_rim_without_data_burns_nothing_and_leaves_the_slopes_beside_it() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let is_rim = |east: f32, north: f32| east + north < 150.0 || north > 500.0;
    let plane = |east: f32, north: f32| if is_rim(east, north) { f32::NAN } else { 1000.0 + 0.3 * east - 0.1 * north };
    let file = |name: &str, raster: &Raster| {
        let path = folder.path().join(name);
        raster::write_asc(&path, raster).expect("the scratch folder takes files");
        path
    };
    let dem = file("dem.asc", &layer(plane));
    let mut reader = LayerReader::default();
    reader.read(LayerKind::Elevation, &dem).expect("only its rim is without data");
    let layers = reader.finish().expect("one was read");
    let fuel = layers.fuel_or(102);
    let relief = layers.relief().expect("there are heights");
    let landscape = wildfire_fire::Landscape { fuel, relief, ..wildfire_fire::Landscape::uniform(layers.frame, 0) };
    for index in 0..480 {
        let cell = layers.frame.cell(index);
        let outside = is_rim(30.0 * f32::from(cell.col), 30.0 * f32::from(cell.row));
        assert_eq!(landscape.fuel_number(cell), if outside { 0 } else { 102 });
        let apart = landscape.gradient(cell) - wildfire_base::geometry::DVec2::new(0.3, -0.1);
        assert!(outside || apart.length() < 1e-4, "{cell:?}: {apart}");
    }
    assert!(
        layers.doubts[0].contains("cells at the rim of") && layers.is_sound(&CustomFuels::default()),
        "{:?}",
        layers.doubts
    );
    // The rim of the first raster holds for all; a gap within it is named, and so is a raster of nothing else.
    let fuel = file("fuel.asc", &layer(|east, north| if is_rim(east, north) { f32::NAN } else { 102.0 }));
    let gap = |east: f32, north: f32| if (east, north) == (300.0, 300.0) { f32::NAN } else { plane(east, north) };
    let with_gap = file("gap.asc", &layer(gap));
    let without_border = |east: f32, north: f32| if east == 690.0 { f32::NAN } else { plane(east, north) };
    let bordered = file("border.asc", &layer(without_border));
    for (path, expected) in [(&with_gap, Some("row 9, column 10: found NODATA")), (&bordered, None), (&dem, None)] {
        let mut reader = LayerReader::default();
        reader.read(LayerKind::Fuel, &fuel).expect("only its rim is without data");
        let read = reader.read(LayerKind::Elevation, path);
        assert_eq!(read.is_ok(), expected.is_none());
        assert!(read.err().unwrap_or_default().contains(expected.unwrap_or_default()));
    }
}

#[test]
fn units_that_files_state_are_applied_or_refused() {
    use LayerKind::{Aspect, Canopy, Elevation, Slope};
    let value = |kind: LayerKind, unit: &str, value: f32| {
        let band = Band { unit: Some(unit.to_owned()), ..band("CC", layer(|_, _| value)) };
        kind.converted(&band).map(|raster| raster.values[7])
    };
    for (kind, unit, stated, expected) in [
        (Elevation, "metre", 300.0, 300.0),
        (Elevation, "foot", 1000.0, 304.8),
        (Elevation, "US survey foot", 3937.0, 1200.0),
        (Elevation, "dm", 300.0, 30.0),
        (Slope, "Percent", 100.0, 45.0),
        (Slope, "degree", 30.0, 30.0),
        (Aspect, "Grass degrees", 90.0, 0.0),
        (Aspect, "Grass degrees", 0.0, FLAT),
        (Canopy(0), "m", 19.04, 190.0),
        (Canopy(0), "Feet x 10", 1000.0, 305.0),
        (Canopy(1), "Meters x 10", 12.0, 12.0),
        (Canopy(2), "kg/m^3", 0.12, 12.0),
        (Canopy(2), "lb/ft^3 x 1000", 10.0, 16.0),
        (Canopy(3), "fraction", 0.45, 45.0),
    ] {
        let found = value(kind, unit, stated).expect("the unit is known");
        assert!((found - expected).abs() < 1e-3, "{unit}: {found}");
    }
    for (kind, unit) in [(Elevation, "fathom"), (Slope, "m"), (Aspect, "Grass categories"), (Canopy(3), "Categories")] {
        let refused = value(kind, unit, 1.0).expect_err("the unit is not known");
        assert!(refused.contains(unit) && refused.contains("gdal_edit.py -units"), "{refused}");
    }
    let of_system = Band { height_unit: Some("US survey feet".into()), ..band("DEM", layer(|_, _| 3937.0)) };
    assert_eq!(Elevation.converted(&of_system).map(|raster| raster.values[0]), Ok(1200.0));
    assert_eq!(Slope.converted(&of_system).map(|raster| raster.values[0]), Ok(3937.0), "it is no height");
}

#[test]
fn bands_are_recognised_by_the_names_of_every_version_and_the_choice_has_a_reason() {
    use LayerKind::{Aspect, Canopy, Elevation, Fuel, Slope};
    for (kind, names) in [
        (Fuel, &["LC22_F40_230", "US_105FBFM40", "LC24_FBFM13_250", "200F13_20", "Fuel models"][..]),
        (Elevation, &["LC20_Elev_220", "US_DEM2010", "ELEV2020", "Elevation"]),
        (Slope, &["LC20_SlpD_220", "US_SLP2010", "SLPP2020", "Slope"]),
        (Aspect, &["LC20_Asp_220", "ASP2020", "Aspect"]),
        (Canopy(0), &["LC23_CH_240", "230CH_22", "Canopy height"]),
        (Canopy(1), &["LC22_CBH_230", "Canopy base height"]),
        (Canopy(2), &["US_200CBD", "Canopy bulk density"]),
        (Canopy(3), &["LC22_CC_230", "Canopy cover"]),
    ] {
        for name in names {
            let stack = [band("Band x", layer(|_, _| 0.0)), band(name, layer(|_, _| 0.0))];
            let meant: Vec<_> = LayerKind::ALL.into_iter().filter(|kind| kind.band(&stack).is_some()).collect();
            assert_eq!(meant, [kind], "{name}");
        }
    }
    let stack =
        ["LC20_F13_200", "LC22_F40_230", "LC22_CC_230", "LC20_CC_200"].map(|name| band(name, layer(|_, _| 0.0)));
    let taken = |kind: LayerKind| kind.band(&stack).map(|band| (band.number, band.reason)).expect("there are some");
    assert_eq!(taken(Fuel), (1, ", preferred as F40 (not band 1)".to_owned()));
    assert_eq!(taken(Canopy(3)), (2, ", the first of several (also band 4)".to_owned()));
    let percent = band("LC20_SlpP_220", layer(|_, _| 100.0));
    assert_eq!(Slope.converted(&percent).map(|raster| raster.values[0]), Ok(45.0));
}

#[test]
fn slopes_and_aspects_in_other_units_than_the_elevations_say_are_refused() {
    let hill = |east: f32, north: f32| {
        let square = f64::from((east - 300.0) * (east - 300.0) + (north - 330.0) * (north - 330.0));
        (400.0 * ops::exp(-square / 9e4)) as f32
    };
    // By the derivatives, not by differences of neighbours.
    let rise = |east: f32, north: f32| {
        let slope = hill(east, north) * 2.0 / 9e4;
        [-(east - 300.0) * slope, -(north - 330.0) * slope].map(f64::from)
    };
    let steepness = |east: f32, north: f32| ops::hypot(rise(east, north)[0], rise(east, north)[1]) as f32;
    let against_the_clock = |east: f32, north: f32| {
        let [east, north] = rise(east, north);
        ops::atan2(-north, -east).to_degrees().rem_euclid(360.0) as f32
    };
    let degrees = |east: f32, north: f32| ops::atan(steepness(east, north).into()).to_degrees() as f32;
    let azimuth = |east: f32, north: f32| (450.0 - against_the_clock(east, north)) % 360.0;
    let refusal = |heights: Raster, slopes: Raster, aspects: Raster| {
        let stack = [band("ELEV", heights), band("SLPD", slopes), band("ASP", aspects)];
        LayerKind::Slope.contradiction(&stack).unwrap_or_default()
    };
    assert_eq!(refusal(layer(hill), layer(degrees), layer(azimuth)), "");
    let percent = layer(|east, north| 100.0 * steepness(east, north));
    assert!(refusal(layer(hill), percent, layer(azimuth)).contains("the slopes of band 2 are in percent"));
    let feet = layer(|east, north| hill(east, north) / 0.3048);
    assert!(refusal(feet, layer(degrees), layer(azimuth)).contains("-b 1 -a_scale 0.3048"));
    assert!(refusal(layer(hill), layer(degrees), layer(against_the_clock)).contains("against the clock"));
}

#[test]
fn trees_of_an_unlikely_size_are_doubted() {
    let doubt = |place, value| doubt_of_trees(place, &[0.0, value], "a.tif").unwrap_or_default();
    assert!(
        doubt(0, 19.0).contains("the greatest height of trees is 1.9 m, as the raster was read in tenths of metres")
    );
    assert!(doubt(0, 19.0).contains("gdal_translate -a_scale 10 in.tif out.tif converts metres"));
    assert!(doubt(1, 2.0).contains("0.2 m") && doubt(2, 1.0).contains("0.01 kg/m3") && doubt(3, 1.0).contains("1 %"));
    assert!(doubt(0, 1200.0).contains("120 m"));
    for (place, value) in [(0, 190.0), (0, 0.0), (1, 20.0), (2, 12.0), (3, 45.0)] {
        assert_eq!(doubt(place, value), "");
    }
}
