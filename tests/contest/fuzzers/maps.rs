//! Map files of every format, and given fields.

use std::path::Path;
use std::sync::LazyLock;

use arbitrary::Unstructured;
use miniz_oxide::deflate;
use wildfire::grid::Grid;
use wildfire::map_files::raster::{self, Raster};
use wildfire::map_files::{self, MapValue};
use wildfire::scenario::{self, ImportedField, Problem, Unimog};

use super::fuzz::text::{NUMBERS, mutated};
use super::fuzz::{Case, Law, below, chance, one_of};
use super::grammar::refusal_names_its_place;

const TEXTS: &[&str] = &[
    "0101\n0000\n1111\n",
    "0,1,0\n1,0,1\n",
    "type octile\nheight 3\nwidth 4\nmap\n....\n.@T.\nGSW.\n",
    "P1\n# bushes\n4 2\n0 1 1 0\n1001\n",
    "P2 3 2 255\n0 128 255 7 200 3\n",
    "P3\n2 1\n255\n255 0 0 0 0 255\n",
    "P4 8 2\n\x55\x2A",
    "P5 3 2 255\nabcdef",
    "P5 2 1 65535\nabcd",
    "P6 1 2 255\nabcdef",
    "\u{FEFF}01\r\n10\r\n",
    "image: map\nresolution: 0.05\norigin: [-1.5, 2, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: raw\n",
];

const TOKENS: &[&str] =
    &["type octile\n", "height ", "width ", "map\n", "P1 ", "P5 ", "P7\n", "GIF8", "BM", "#", "01", "\u{FEFF}"];

/// Checks that a map file is read or refused, and that its map is the same when it is written and read again.
pub fn map_file(case: &mut Case<'_>) -> Law {
    case.input = match below(&mut case.dice, 4) {
        0 => png(&mut case.dice),
        1 => pnm(&mut case.dice),
        _ => mutated(&mut case.dice, TEXTS, TOKENS),
    };
    let path = case.write("map", &case.input);
    let tolerance = one_of(&mut case.dice, &[0, 127, 254, 255]);
    let map = match map_files::read(&path, *tolerance) {
        Ok(map) => map,
        Err(refusal) => return check_message(&refusal.to_string()),
    };
    case.count("maps accepted");
    if map.grey.as_ref().is_some_and(|grey| (grey.rows(), grey.cols()) != (map.occupied.rows(), map.occupied.cols())) {
        return Err("the grey image has another size than the map".into());
    }
    let again = case.folder.join("again");
    for write in [map_files::write_text, map_files::write_csv::<bool>] {
        write(&again, &map.occupied).map_err(|error| error.to_string())?;
        // A single column has no comma by which it could be told from text, and is the same as text.
        let back = map_files::read(&again, 0).map_err(|error| format!("what was written is refused: {error}"))?;
        if back.occupied != map.occupied {
            return Err("another map comes back".into());
        }
    }
    Ok(())
}

const GRIDS: &[&str] = &[
    "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n102 102 98\n145 -9999 99\n",
    "NCOLS 4 NROWS 3 XLLCENTER 2.5 YLLCENTER 2.5 CELLSIZE 5 1 2 3 4 5 6 7 8 9 10 11 12",
    "ncols 20\nnrows 20\nxllcorner 1\nyllcorner 2\ndx 5\ndy 5\nnan 1e3 -2.5\n",
];

const GRID_TOKENS: &[&str] =
    &["ncols ", "nrows ", "cellsize ", "NODATA_value ", "xllcenter ", "nan ", "1e39 ", "-9999 ", "65536 ", "102 "];

static GEOTIFF: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let (values, crs) = ((0..300).map(|index| 0.25 * index as f32).collect(), None);
    let raster =
        Raster { rows: 15, cols: 20, west_m: 10.0, south_m: 20.0, cell_m: 5.0, values, nodata: Some(-1.0), crs };
    let path = folder.path().join("raster.tif");
    raster::write_geotiff(&path, &raster).expect("the scratch folder takes files");
    std::fs::read(path).expect("it was written")
});

/// Draws a raster, mostly a damaged one.
fn drawn_raster(case: &mut Case<'_>) -> Vec<u8> {
    if case.chance(50) {
        mutated(&mut case.dice, &[GEOTIFF.as_slice()], &["II*\0", "MM\0*", "II+\0"])
    } else {
        mutated(&mut case.dice, GRIDS, GRID_TOKENS)
    }
}

/// Checks that a raster is read or refused, and that its values are the same when they are written and read again.
pub fn raster_file(case: &mut Case<'_>) -> Law {
    case.input = drawn_raster(case);
    let path = case.write("raster", &case.input);
    let read = match raster::read(&path) {
        Ok(read) => read,
        Err(refusal) => return check_message(&refusal.to_string()),
    };
    case.count("rasters accepted");
    let again = case.folder.join("again");
    let bits = |raster: &Raster| raster.values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    // Text has one word for what is no number, and none for what is beyond all numbers.
    let is_plain = read.values.iter().all(|value| value.is_finite());
    for write in [raster::write_asc, raster::write_geotiff] {
        write(&again, &read).map_err(|error| error.to_string())?;
        let back = raster::read(&again);
        if is_plain
            && back.map(|back| bits(&back)).map_err(|error| format!("what was written is refused: {error}"))?
                != bits(&read)
        {
            return Err("other values come back".into());
        }
    }
    Ok(())
}

/// Checks that the files of a landscape and of its weather are taken or refused at a place of the scenario.
pub fn landscape_files(case: &mut Case<'_>) -> Law {
    const WINDS: &[&str] = &["t_s,speed_mps,from_deg\n0,5,270\n600,8.5,180\n", "from_deg,t_s,speed_mps\r\n1,2,3\r\n"];
    const SAMPLES: &[&str] =
        &["speed_mps,from_deg\n5,270\n6,280\n", "d1,d10,d100,herb,woody,speed_mps,from_deg\n.06,.07,.08,.6,.9,5,0\n"];
    const ROADS: &str = r#"{"type":"Feature","geometry":{"type":"MultiLineString","coordinates":[[[0,5],[60,80]]]}}"#;
    const FUELS: &[&str] = &[
        "METRIC\n14 OWN 3.5 1.2 0.4 0 2.5 static 60 50 50 45 22 18000 18000 Own\n",
        "ENGLISH\n15 OWN 1.6 0.5 0 0.3 1.4 dynamic 1900 1700 1500 2 20 8000 8000\n",
        "14,OWN,.TRUE.,0.1,0,0,0.2,0,2000,109,30,1800,1500,1,15,8000\n",
    ];
    const MODELS: &[&str] = &["0 6 7 8 60 90\n142 5.5 7 8 60 90\n", "# model factor\n102 0.5\n145, 2\n"];
    const WIND_LIST: &str = "WINDS_AND_CLOUDS\nMETRIC\n7 1 1200 raster raster\n7 1 1300 raster raster\n";
    const PERIMETER: &str =
        r#"{"type":"Feature","geometry":{"type":"Polygon","coordinates":[[[9,9],[60,9],[60,70],[9,9]]]}}"#;
    let raster = drawn_raster(case);
    let fuels = mutated(&mut case.dice, FUELS, &["METRIC", "static", "1e9", "-1", "nan", "\n"]);
    let models = mutated(&mut case.dice, MODELS, &["0 ", "1e9", "-1", "nan", "102", "\n"]);
    let list = mutated(&mut case.dice, &[WIND_LIST], &["ENGLISH", "raster", "1e9", "-1", "2400", "\n"]);
    let perimeter = mutated(&mut case.dice, &[PERIMETER], &["[", "]", "Point", "1e9", "-1", "Multi"]);
    let wind = mutated(&mut case.dice, WINDS, &["t_s", ",", "1e9", "-1", "nan", "\n"]);
    let samples = mutated(&mut case.dice, SAMPLES, &["d1", ",", "1e9", "-1", "nan", "\n"]);
    let roads = mutated(&mut case.dice, &[ROADS], &["[", "]", "Point", "1e9", "-1", "Line"]);
    let files = [
        ("raster", &raster),
        ("wind.csv", &wind),
        ("samples.csv", &samples),
        ("roads.geojson", &roads),
        ("own.fmd", &fuels),
        ("winds.atm", &list),
        ("perimeter.geojson", &perimeter),
        ("models.fms", &models),
    ];
    let paths = files.map(|(name, bytes)| case.write(name, bytes).display().to_string());
    case.input = files.map(|(_, bytes)| bytes.as_slice()).concat();
    let key = *one_of(&mut case.dice, &["fuel_map", "elevation", "fuel_map"]);
    let mut changes = vec!["fire.model=rothermel".to_owned()];
    match below(&mut case.dice, 14) {
        0 => changes.push(format!("fire.rothermel.{key}={}", paths[0])),
        1 => changes.push(format!("wind_file={}", paths[1])),
        2 => changes.push(format!("weather={{ samples = \"{}\" }}", paths[2])),
        3 => changes.push(format!("landscape={{ roads_file = \"{}\" }}", paths[3])),
        4 => changes.push(format!("fuel_file={}", paths[4])),
        5 => changes.push(format!("wind_file={}", paths[5])),
        6 => changes.push(format!("wind=[{{ speed = \"{}\", from = \"{}\" }}]", paths[0], paths[0])),
        7 => changes.push(format!("ignition=[{{ at_s = 1, perimeter = \"{}\" }}]", paths[6])),
        8 => changes.push(format!("barrier=[{{ file = \"{}\" }}]", paths[6])),
        9 => changes.push(format!("fire.rothermel.moisture_file={}", paths[7])),
        10 => changes.push(format!("fire.rothermel.adjustment_file={}", paths[7])),
        11 => changes.push(format!("fire.rothermel.moisture_rasters={{ d1 = \"{0}\", herb = \"{0}\" }}", paths[0])),
        12 => changes.push(format!("barrier=[{{ file = \"{}\", factor = 0.5 }}]", paths[6])),
        _ => changes.push(format!("ignition=[{{ at_s = 1, random = 2, density = \"{}\" }}]", paths[0])),
    }
    match scenario::load("wumpus-alone", &changes) {
        Ok(_) => {
            case.count("landscapes accepted");
            Ok(())
        }
        Err(refusal) => refusal_names_its_place(&refusal),
    }
}

/// Checks that a refusal says something.
pub fn check_message(refusal: &str) -> Law {
    if refusal.trim().is_empty() { Err("a refusal without a word".into()) } else { Ok(()) }
}

/// Checks that an array of NumPy holds in its header and bytes what was written.
pub fn numpy_array(case: &mut Case<'_>) -> Law {
    let (rows, cols) = (1 + below(&mut case.dice, 9), 1 + below(&mut case.dice, 9));
    let path = case.folder.join("map.npy");
    let mut draw = || case.dice.arbitrary::<u64>().unwrap_or_default();
    let numbers: Vec<u64> = (0..rows * cols).map(|_| draw()).collect();
    let is = |path: &Path, kind: &str, bytes: Vec<u8>| {
        let written = std::fs::read(path).map_err(|error| error.to_string())?;
        let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({rows}, {cols}), }}");
        let length = written.get(8..10).map_or(0, |length| usize::from(u16::from_le_bytes([length[0], length[1]])));
        let dictionary = written.get(10..10 + length).unwrap_or_default();
        let is_right = written.starts_with(b"\x93NUMPY\x01\0")
            && (10 + length) % 64 == 0
            && dictionary.trim_ascii_end() == header.as_bytes()
            && written[10 + length..] == bytes;
        if is_right { Ok(()) } else { Err(format!("an array of {rows} x {cols} {kind} is {written:?}")) }
    };
    fn write<T: MapValue>(path: &Path, rows: usize, cols: usize, values: Vec<T>) -> Law {
        map_files::write_npy(path, &Grid::from_values(rows, cols, values)).map_err(|error| error.to_string())
    }
    let floats: Vec<f64> = numbers.iter().map(|&bits| f64::from_bits(bits)).collect();
    let bytes = floats.iter().flat_map(|number| number.to_le_bytes()).collect();
    write(&path, rows, cols, floats)?;
    is(&path, "<f8", bytes)?;
    let values: Vec<u32> = numbers.iter().map(|&number| number as u32).collect();
    let bytes = values.iter().flat_map(|number| number.to_le_bytes()).collect();
    write(&path, rows, cols, values)?;
    is(&path, "<u4", bytes)
}

/// Draws a PNG image with right checksums, whatever its chunks say.
fn png(dice: &mut Unstructured<'_>) -> Vec<u8> {
    let side = |dice: &mut Unstructured<'_>| match below(dice, 16) {
        15 => *one_of(dice, &[0, 32_767, 32_768, 100_000, u32::MAX, 1 << 31]),
        14 => 1 + below(dice, 300) as u32,
        _ => 1 + below(dice, 20) as u32,
    };
    let (width, height) = (side(dice), side(dice));
    let [depth, colour] = *one_of(
        dice,
        &[[8, 0], [1, 0], [2, 0], [4, 0], [16, 0], [8, 2], [16, 2], [8, 3], [1, 3], [8, 4], [8, 6], [16, 6]],
    );
    let (depth, colour) =
        if chance(dice, 5) { (dice.arbitrary().unwrap_or(8), dice.arbitrary().unwrap_or(0)) } else { (depth, colour) };
    let interlaced = u8::from(chance(dice, 20));
    let channels = [1, 1, 3, 1, 2, 1, 4].get(usize::from(colour)).copied().unwrap_or(1);
    let row_bytes = 1 + (width as usize).saturating_mul(channels * usize::from(depth)).div_ceil(8);
    let wanted = row_bytes.saturating_mul(height as usize).min(1 << 14);
    let pixels: Vec<u8> = (0..wanted)
        .map(|at| if at % row_bytes == 0 { below(dice, 6) as u8 } else { dice.arbitrary().unwrap_or(at as u8) })
        .collect();
    let mut data = deflate::compress_to_vec_zlib(&pixels, 1);
    if chance(dice, 10) {
        data = mutated(dice, &[data], &[]);
    }
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[depth, colour, 0, 0, interlaced]].concat();
    let mut chunks: Vec<(&[u8; 4], Vec<u8>)> = vec![(b"IHDR", header)];
    if colour == 3 || chance(dice, 5) {
        chunks.push((b"PLTE", (0..3 * (1 + below(dice, 256))).map(|byte| byte as u8).collect()));
    }
    if chance(dice, 20) {
        chunks.push((b"tRNS", vec![0, 1, 2, 3, 4, 5][..below(dice, 7)].to_vec()));
    }
    if chance(dice, 10) {
        chunks.push((
            one_of::<&[u8; 4]>(dice, &[b"tEXt", b"gAMA", b"zTXt", b"iCCP", b"acTL", b"quux", b"QUUX"]),
            vec![b'a'; below(dice, 64)],
        ));
    }
    chunks.push((b"IDAT", data));
    chunks.push((b"IEND", Vec::new()));
    if chance(dice, 5) {
        let [one, other] = [below(dice, chunks.len()), below(dice, chunks.len())];
        chunks.swap(one, other);
    }
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, contents) in chunks {
        bytes.extend((contents.len() as u32).to_be_bytes());
        let checked = [&name[..], &contents].concat();
        bytes.extend(&checked);
        bytes.extend(crc32fast::hash(&checked).to_be_bytes());
    }
    if chance(dice, 10) { mutated(dice, &[bytes], &[]) } else { bytes }
}

/// Draws a Netpbm image whose header may say anything, and whose pixels mostly suffice.
fn pnm(dice: &mut Unstructured<'_>) -> Vec<u8> {
    let kind = 1 + below(dice, 6);
    let side = |dice: &mut Unstructured<'_>| match below(dice, 16) {
        15 => (*one_of(dice, NUMBERS)).to_owned(),
        _ => (1 + below(dice, 12)).to_string(),
    };
    let gap = *one_of(dice, &[" ", "\n", "\t", " # words\n", "\r\n"]);
    let (width, height, max) = (side(dice), side(dice), one_of(dice, &["255", "1", "65535", "0", "65536", "100"]));
    let has_most = !matches!(kind, 1 | 4);
    let header =
        format!("P{kind}{gap}{width}{gap}{height}{}\n", if has_most { format!("{gap}{max}") } else { String::new() });
    let count = if chance(dice, 90) { 6 * 144 } else { below(dice, 900) };
    let pixels: Vec<u8> = match kind {
        1 => (0..count).map(|_| if chance(dice, 50) { b'1' } else { b'0' }).collect(),
        2 | 3 => (0..count).flat_map(|at| format!("{} ", (at * 7) % 256).into_bytes()).collect(),
        _ => (0..count).map(|at| dice.arbitrary().unwrap_or(at as u8)).collect(),
    };
    [header.into_bytes(), pixels].concat()
}

const FIELDS: &[&str] = &[
    "..#\n#..\n...\n",
    "010\n001",
    r#"{"n": 3, "cell_m": 2, "size_m": 6, "cells_cr": [[0, 0], [2, 1]], "goals": [1, {"a": []}]}"#,
    r#"{"size_m": 250, "cell_m": 5, "cells_cr": []}"#,
    r#"{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry":
 {"type": "Polygon", "coordinates": [[[0,0],[0.001,0],[0.001,0.001],[0,0]], [[0.0004,0.0001],[0.0006,0.0001],[0.0005,0.0002]]]}}]}"#,
    r#"{"type": "MultiPolygon", "crs": {"properties": {"name": "EPSG:32632"}}, "coordinates": [[[[0,0],[90,0],[5,70]]]]}"#,
];

const MEMBERS: &[&str] = &[
    "\"n\":",
    "\"size_m\":",
    "\"cell_m\":",
    "\"cells_cr\":",
    "\"goals\":",
    "\"start\":",
    "\"vehicle\":",
    "\"field\":",
    "[[",
    "]]",
    "[1,2]",
    "{\"pose\":[1,2,3]}",
    "{\"disc\":[1,2,3]}",
    "null",
    "\u{1F525}",
];

/// Checks that a given field is read or refused with a stretch of its text, and comes back from JSON as it was.
pub fn imported_field(case: &mut Case<'_>) -> Law {
    case.input = mutated(&mut case.dice, FIELDS, MEMBERS);
    let text = String::from_utf8_lossy(&case.input);
    let cell_m = *one_of(&mut case.dice, &[5.0, 0.01, 1000.0, 0.0, -1.0, f64::NAN, f64::INFINITY]);
    let field = match ImportedField::parse(&text, cell_m) {
        Ok(field) => field,
        Err(refusal) if text.get(refusal.span.clone()).is_none() => {
            return Err(format!("{refusal} at {:?}, which is no stretch of the text", refusal.span));
        }
        Err(refusal) => return check_message(&refusal.to_string()),
    };
    case.count("given fields accepted");
    let json = serde_json::to_string(&field).map_err(|error| format!("it cannot be written: {error}"))?;
    let back: ImportedField = serde_json::from_str(&json).map_err(|error| format!("it does not come back: {error}"))?;
    if back == field { Ok(()) } else { Err("another field comes back".into()) }
}

const PROBLEMS: &[&str] = &[
    r#"{"field": "two", "n": 20, "cell_m": 5, "cells_cr": [[8, 6], [8, 7]],
 "vehicle": {"length": 4.9, "width": 2.2, "wheelbase": 3.0, "rear_overhang": 0.95, "min_turn_radius": 13.0, "v_max": 8.0},
 "start": [20, 32, 0],
 "goals": [{"pose": [70, 32, 1.57]}, {"disc": [42.5, 37.5, 10]}]}"#,
    r#"{"field": 7, "size_m": 50, "cells_cr": [], "start": [null, 1, 2]}"#,
];

/// Checks that a problem file is read, or refused with a place.
pub fn problem_file(case: &mut Case<'_>) -> Law {
    case.input = mutated(&mut case.dice, PROBLEMS, MEMBERS);
    let path = case.write("problem.json", &case.input);
    match Problem::open(&path, &Unimog::default()) {
        Ok(_) => {
            case.count("problems accepted");
            Ok(())
        }
        Err(refusal) => refusal_names_its_place(&refusal),
    }
}
