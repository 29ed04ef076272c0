//! Laws of rasters: what is written is read back bit for bit, and damage is reported in a sentence.

use std::io::Cursor;

use rand::RngExt;
use tiff::encoder::TiffEncoder;
use tiff::encoder::colortype;
use tiff::tags::Tag;

use super::*;
use wildfire_base::rng;

fn raster(rows: usize, cols: usize) -> Raster {
    let mut rng = rng::stream(1, "raster");
    let mut values = Vec::new();
    while values.len() < rows * cols {
        let value = f32::from_bits(rng.random());
        if value.is_finite() {
            values.push(value);
        }
    }
    Raster { rows, cols, west_m: 4_500_012.5, south_m: -3000.25, cell_m: 30.0, values, nodata: None, crs: None }
}

fn bits(raster: &Raster) -> Vec<u32> {
    raster.values.iter().map(|value| value.to_bits()).collect()
}

fn fault(bytes: impl Into<Vec<u8>>) -> String {
    parse(bytes.into()).expect_err("this is no good raster").to_string()
}

fn grid(head: &str, values: &str) -> String {
    format!("ncols 3\nnrows 2\n{head}\n{values}\n")
}

const PLACED: &str = "xllcorner 0\nyllcorner 0\ncellsize 5";

/// A TIFF image made tag by tag; numbers of more than four bytes follow the tags.
struct Image {
    is_little: bool,
    tags: Vec<(u16, u16, u32, Vec<u8>)>,
}

impl Image {
    fn new(is_little: bool) -> Self {
        Self { is_little, tags: Vec::new() }
    }

    fn word(&self, number: u64, size: usize) -> Vec<u8> {
        if self.is_little { number.to_le_bytes()[..size].to_vec() } else { number.to_be_bytes()[8 - size..].to_vec() }
    }

    fn short(mut self, tag: u16, numbers: &[u16]) -> Self {
        let bytes = numbers.iter().flat_map(|&number| self.word(number.into(), 2)).collect();
        self.tags.push((tag, 3, numbers.len() as u32, bytes));
        self
    }

    fn long(mut self, tag: u16, numbers: &[u32]) -> Self {
        let bytes = numbers.iter().flat_map(|&number| self.word(number.into(), 4)).collect();
        self.tags.push((tag, 4, numbers.len() as u32, bytes));
        self
    }

    fn double(mut self, tag: u16, numbers: &[f64]) -> Self {
        let bytes = numbers.iter().flat_map(|&number| self.word(number.to_bits(), 8)).collect();
        self.tags.push((tag, 12, numbers.len() as u32, bytes));
        self
    }

    /// The place of cells of 10 m whose north-west corner is at (1000, 2000).
    fn placed(self) -> Self {
        self.double(33_550, &[10.0, 10.0, 0.0]).double(33_922, &[0.0, 0.0, 0.0, 1000.0, 2000.0, 0.0])
    }

    /// The file, with data at byte 8, where strips or tiles may say that they begin.
    fn bytes(mut self, data: &[u8]) -> Vec<u8> {
        self.tags.sort_by_key(|(tag, ..)| *tag);
        let first = (8 + data.len()).next_multiple_of(2);
        let mut file = if self.is_little { b"II*\0".to_vec() } else { b"MM\0*".to_vec() };
        file.extend(self.word(first as u64, 4));
        file.extend(data);
        file.resize(first, 0);
        file.extend(self.word(self.tags.len() as u64, 2));
        let mut after = first + 2 + 12 * self.tags.len() + 4;
        let mut rest: Vec<u8> = Vec::new();
        for (tag, kind, count, bytes) in &self.tags {
            file.extend(self.word((*tag).into(), 2));
            file.extend(self.word((*kind).into(), 2));
            file.extend(self.word((*count).into(), 4));
            if bytes.len() <= 4 {
                let mut bytes = bytes.clone();
                bytes.resize(4, 0);
                file.extend(bytes);
            } else {
                file.extend(self.word(after as u64, 4));
                after += bytes.len();
                rest.extend(bytes);
            }
        }
        file.extend([0; 4]);
        file.extend(rest);
        file
    }
}

/// Two tiles of 16 x 16 bytes side by side, of which an image of 3 rows and 20 columns needs a part.
fn tiled(is_little: bool) -> Vec<u8> {
    let data: Vec<u8> = (0..512).map(|at| ((at / 256) * 100 + at % 16) as u8).collect();
    Image::new(is_little)
        .short(256, &[20])
        .short(257, &[3])
        .short(258, &[8])
        .short(259, &[1])
        .short(262, &[3])
        .short(277, &[1])
        .short(322, &[16])
        .short(323, &[16])
        .long(324, &[8, 264])
        .long(325, &[256, 256])
        .placed()
        .bytes(&data)
}

/// An image of one row of bytes in a strip that is packed in a way by its number.
fn packed(cols: u16, packing: u16, data: &[u8]) -> Image {
    Image::new(true)
        .short(256, &[cols])
        .short(257, &[1])
        .short(258, &[8])
        .short(259, &[packing])
        .short(262, &[1])
        .short(277, &[1])
        .long(273, &[8])
        .long(279, &[data.len() as u32])
}

/// The first codes of a strip as LZW packs them, high bits first, without an end code.
fn lzw(codes: &[u32]) -> Vec<u8> {
    let mut bits: Vec<u32> = Vec::new();
    for (place, &code) in codes.iter().enumerate() {
        // After the clear code and the first string there is a string more for each code.
        let width = match 256 + place {
            ..511 => 9,
            511..1023 => 10,
            _ => 11,
        };
        bits.extend((0..width).rev().map(|bit| code >> bit & 1));
    }
    bits.chunks(8).map(|byte| (0..8).fold(0, |sum, bit| sum << 1 | *byte.get(bit).unwrap_or(&0) as u8)).collect()
}

#[test]
fn every_value_survives_being_written() {
    for (rows, cols) in [(1, 1), (3, 7), (200, 333)] {
        let mut raster = raster(rows, cols);
        for nodata in [None, Some(-9999.0), Some(f32::MIN), Some(raster.values[0])] {
            raster.nodata = nodata;
            let text = parse(ascii::to_text(&raster).into_bytes()).expect("this program wrote it");
            assert_eq!(bits(&text), bits(&raster));
            assert_eq!(text, raster);
            let image = parse(geotiff::to_bytes(&[(None, &raster)]).expect("it fits")).expect("this program wrote it");
            assert_eq!(bits(&image), bits(&raster));
            assert!(image.crs.is_some(), "it says that it is a map");
            assert_eq!(Raster { crs: None, ..image }, raster);
        }
    }
}

#[test]
fn bands_are_read_as_they_were_written() {
    let first = raster(300, 333);
    let mut second = raster(300, 333);
    second.values.reverse();
    let bytes =
        geotiff::to_bytes(&[(Some("Time (s)"), &first), (None, &second), (Some("b"), &first)]).expect("it fits");
    let read = geotiff::parse_bands(bytes).expect("this program wrote it");
    let names: Vec<_> = read.iter().map(|band| band.name.as_deref()).collect();
    assert_eq!(names, [Some("Time (s)"), None, Some("b")]);
    for (band, written) in read.iter().zip([&first, &second, &first]) {
        assert_eq!(bits(&band.raster), bits(written));
    }
}

#[test]
fn what_is_not_a_number_is_no_data_and_survives() {
    let mut raster = raster(2, 2);
    raster.values[1] = f32::NAN;
    raster.nodata = Some(f32::NAN);
    for written in [ascii::to_text(&raster).into_bytes(), geotiff::to_bytes(&[(None, &raster)]).expect("it fits")] {
        let read = parse(written).expect("this program wrote it");
        assert!(read.nodata.is_some_and(f32::is_nan) && read.is_nodata(read.value(0, 1)));
        assert_eq!((read.value(0, 0), read.value(1, 1)), (raster.value(0, 0), raster.value(1, 1)));
    }
}

#[test]
fn coordinate_systems_are_handed_on_and_points_become_areas() {
    let mut raster = raster(4, 5);
    let directory = vec![1, 1, 0, 4, 1024, 0, 1, 1, 1025, 0, 1, 1, 1026, 34_737, 5, 0, 3072, 0, 1, 32_610];
    raster.crs = Some(GeoKeys { directory, doubles: vec![6_378_137.0, 298.25], ascii: "UTM |".into() });
    let bytes = geotiff::to_bytes(&[(None, &raster)]).expect("it fits");
    assert_eq!(parse(bytes).expect("this program wrote it"), raster);
    let keys = raster.crs.as_mut().expect("it has some");
    keys.directory[11] = 2;
    assert_eq!(keys.of_areas()[11], 1);
}

#[test]
fn grids_are_tokens_whatever_their_lines_and_the_north_row_comes_first() {
    let expected = [4.0, 5.0, 6.0, 1.0, 2.0, 3.0];
    for (head, values) in [
        (PLACED, "1 2 3\n4 5 6"),
        ("XLLCORNER 0\r\nYllCorner 0 CELLSIZE\t5", "1\n2 3 4\r\n\n5   6"),
        ("xllcenter 2.5 yllcenter 2.5\ncellsize 5.0 NODATA_VALUE -1", "1e0 2.0 +3 4 5.00 6"),
        ("xllcorner 0 yllcorner 0 dx 5 dy 5 nodata_value nan", "1 2 3 4 5 6"),
    ] {
        let raster = parse(grid(head, values).into_bytes()).expect("this grid is right");
        assert_eq!((raster.rows, raster.cols, raster.cell_m), (2, 3, 5.0));
        assert_eq!((raster.west_m, raster.south_m, raster.north_m()), (0.0, 0.0, 10.0));
        assert_eq!(raster.values, expected, "{head}");
    }
}

#[test]
fn faults_in_grids_are_reported_with_their_place() {
    for (text, expected) in [
        (grid(PLACED, "1 2 3 4 x 6"), "row 1, column 1: found `x`, expected a number"),
        (grid(PLACED, "1 2 3 4,500,1 5 6"), "row 1, column 0: found `4,500,1`, expected a number"),
        (grid(PLACED, "1 2 inf 4 5 6"), "row 0, column 2: found `inf`"),
        (grid(PLACED, "1 2 3 4 5"), "row 1, column 2: the file ends; its header declares 2 rows and 3 columns"),
        (grid(PLACED, ""), "row 0, column 0: the file ends"),
        (grid(PLACED, "1 2 3 4 5 6 7"), "after row 1, column 2: the file continues"),
        (grid("xllcorner 0\nyllcorner 0", "1 2 3 4 5 6"), "the header lacks `cellsize`"),
        (grid("xllcorner 0\ncellsize 5", "1 2 3 4 5 6"), "the header lacks `yllcorner`"),
        (grid("xllcorner 0\nncols 4", ""), "line 4: `ncols` is given twice"),
        (grid("xllcorner west", ""), "line 3: `xllcorner` is `west`, expected a number"),
        (grid("cellsise 5", ""), "line 3: found `cellsise`, expected one of ncols"),
        (grid("xllcorner 0 yllcorner 0 dx 5 dy 6", "1"), "cells of 5 by 6 are not square"),
        (grid("xllcorner 0 yllcorner 0 cellsize -5", "1"), "the cell size is -5"),
        ("ncols 2.5\nnrows 2\n".into(), "`nrows` is"),
        ("ncols 40000\nnrows 25000\nxllcorner 0\nyllcorner 0\ncellsize 5\n1".into(), "25000 rows and 40000 columns"),
        ("ncols 8000\nnrows 8000\nxllcorner 0\nyllcorner 0\ncellsize 5\n1".into(), "the file ends"),
        ("hello".into(), "this is not a supported raster"),
        (String::new(), "the file is empty"),
    ] {
        let found = fault(text.clone());
        let is_so = found.contains(expected) || expected == "`nrows` is" && found.contains("`ncols` is 2.5");
        assert!(is_so, "{text}: {found}");
    }
}

#[test]
fn samples_of_all_usual_kinds_are_read() {
    fn written<C: colortype::ColorType>(data: &[C::Inner]) -> Vec<u8>
    where
        [C::Inner]: tiff::encoder::TiffValue,
    {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file).expect("memory takes it");
        let mut image = encoder.new_image::<C>(2, 2).expect("it fits");
        image.encoder().write_tag(Tag::ModelPixelScaleTag, &[10.0, 10.0, 0.0][..]).expect("memory takes it");
        let tie = [0.0, 0.0, 0.0, 5.0, 7.0, 0.0];
        image.encoder().write_tag(Tag::ModelTiepointTag, &tie[..]).expect("memory takes it");
        image.encoder().write_tag(Tag::GdalNodata, "-32768").expect("memory takes it");
        image.write_data(data).expect("memory takes it");
        file.into_inner()
    }
    for bytes in [
        written::<colortype::Gray8>(&[3, 4, 1, 2]),
        written::<colortype::Gray16>(&[3, 4, 1, 2]),
        written::<colortype::GrayI16>(&[3, 4, 1, 2]),
        written::<colortype::GrayI32>(&[3, 4, 1, 2]),
        written::<colortype::Gray32>(&[3, 4, 1, 2]),
        written::<colortype::Gray32Float>(&[3.0, 4.0, 1.0, 2.0]),
        written::<colortype::Gray64Float>(&[3.0, 4.0, 1.0, 2.0]),
    ] {
        let raster = parse(bytes).expect("this image is right");
        assert_eq!((raster.values, raster.nodata), (vec![1.0, 2.0, 3.0, 4.0], Some(-32768.0)));
        assert_eq!((raster.west_m, raster.south_m, raster.cell_m), (5.0, -13.0, 10.0));
    }
    assert!(fault(written::<colortype::RGB8>(&[0; 12])).contains("it has 3 bands, expected one"));
    assert!(fault(written::<colortype::Gray64>(&[0; 4])).contains("64-bit integers"));
}

#[test]
fn tiles_and_palettes_are_read_in_either_order_of_bytes() {
    for is_little in [true, false] {
        let raster = parse(tiled(is_little)).expect("this image is right");
        assert_eq!((raster.rows, raster.cols, raster.south_m), (3, 20, 1970.0));
        let expected: Vec<f32> =
            (0..20).map(|col| f32::from(if col < 16 { col as u8 } else { 84 + col as u8 })).collect();
        assert!(raster.values.chunks_exact(20).all(|row| row == expected), "{:?}", raster.values);
    }
}

#[test]
fn strips_packed_by_lzw_are_read_without_an_end_code_and_by_zstandard() {
    let many: Vec<u32> = (0..1000).map(|at| at * at % 251).collect();
    let bytes_of_many = many.iter().map(|&value| value as u8).collect::<Vec<_>>();
    // A code that stands for the string that ends with the byte that it begins with, the second time for three bytes.
    let strings: (&[u32], &[u8]) = (&[256, 7, 258, 259, 8, 258], &[7, 7, 7, 7, 7, 7, 8, 7, 7]);
    for (codes, expected) in [strings, (&[&[256], &many[..]].concat()[..], &bytes_of_many[..])] {
        let data = lzw(codes);
        let cols = expected.len() as u16;
        let values: Vec<f32> = expected.iter().map(|&byte| byte.into()).collect();
        let read = |cols| parse(packed(cols, 5, &data).placed().bytes(&data));
        assert_eq!(read(cols).expect("all its values are there").values, values);
        assert_eq!(read(3).expect("it may go on").values, values[..3]);
        let found = read(cols + 1).expect_err("one is missing").to_string();
        assert!(found.contains("row 0, column 0: its compressed cells end early"), "{found}");
    }
    // A frame of one block of two bytes as they are.
    let frame = [0x28, 0xB5, 0x2F, 0xFD, 0x20, 2, 0x11, 0, 0, 8, 9];
    assert_eq!(parse(packed(2, 50_000, &frame).placed().bytes(&frame)).expect("it is whole").values, [8.0, 9.0]);
    let found = fault(packed(2, 50_000, &frame[..9]).placed().bytes(&frame[..9]));
    assert!(found.contains("row 0, column 0"), "{found}");
    let found = fault(packed(2, 34_925, &frame).placed().bytes(&frame));
    assert!(found.contains("compressed by LZMA") && found.contains("-co COMPRESS=DEFLATE in.tif out.tif"), "{found}");
}

#[test]
fn images_that_are_no_map_in_metres_are_refused_with_the_reason() {
    let image = || {
        Image::new(true)
            .short(256, &[2])
            .short(257, &[1])
            .short(258, &[8])
            .short(259, &[1])
            .short(262, &[1])
            .short(277, &[1])
            .long(273, &[8])
            .long(279, &[2])
    };
    let keys = |key: u16, value: u16| [1, 1, 0, 1, key, 0, 1, value];
    assert_eq!(parse(image().placed().bytes(&[8, 9])).expect("this one is right").values, [8.0, 9.0]);
    let points = parse(image().placed().short(34_735, &keys(1025, 2)).bytes(&[8, 9])).expect("this one is right");
    assert_eq!((points.west_m, points.north_m()), (995.0, 2005.0));
    let matrix = [10.0, 0.0, 0.0, 1000.0, 0.0, -10.0, 0.0, 2000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let by_matrix = parse(image().double(34_264, &matrix).bytes(&[8, 9])).expect("this one is right");
    assert_eq!((by_matrix.west_m, by_matrix.north_m(), by_matrix.cell_m), (1000.0, 2000.0, 10.0));
    let turned = matrix.map(|number| if number == -10.0 { -9.0 } else { number });
    let south_first = Image::new(true)
        .short(256, &[1])
        .short(257, &[2])
        .short(258, &[8])
        .short(262, &[1])
        .long(273, &[8])
        .long(279, &[2])
        .short(34_735, &keys(1025, 2))
        .double(34_264, &matrix.map(f64::abs));
    let south_first = parse(south_first.bytes(&[8, 9])).expect("it is only turned over");
    assert_eq!((south_first.values, south_first.south_m, south_first.west_m), (vec![8.0, 9.0], 1995.0, 995.0));
    let mut skewed = matrix;
    skewed[1] = 0.5;
    for (image, expected) in [
        (image().double(33_550, &[10.0, -10.0, 0.0]).double(33_922, &[0.0; 6]), "its scale is below 0"),
        (image().placed().short(34_735, &keys(1024, 2)), "measured in degrees"),
        (image().placed().short(34_735, &keys(3076, 9003)), "not measured in metres but in US survey feet"),
        (image(), "does not give the position of its cells"),
        (image().double(34_264, &turned), "cells of 10 by 9 are not square"),
        (image().double(34_264, &skewed), "do not run from west to east"),
        (image().double(33_550, &[f64::NAN; 3]).double(33_922, &[0.0; 6]), "the cell size is NaN"),
        (image().double(33_550, &[1.0; 3]).double(33_922, &[1e300; 6]), "not a position in metres"),
        (image().placed().short(42_113, &[7]), "damaged"),
    ] {
        let found = fault(image.bytes(&[8, 9]));
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn absurd_sizes_are_refused_before_memory_is_taken() {
    let image = |width, height, tile: Option<[u32; 2]>, rows_per_strip: u32| {
        let image = Image::new(true).long(256, &[width]).long(257, &[height]).short(258, &[64]).short(262, &[1]);
        match tile {
            Some([width, height]) => {
                image.long(322, &[width]).long(323, &[height]).long(324, &[8]).long(325, &[8]).placed().bytes(&[0; 8])
            }
            None => image.long(273, &[8]).long(279, &[8]).long(278, &[rows_per_strip]).placed().bytes(&[0; 8]),
        }
    };
    for (bytes, expected) in [
        (image(31_623, 31_623, None, 31_623), "31623 rows and 31623 columns"),
        (image(u32::MAX, u32::MAX, None, 1), "rows and"),
        (image(u32::MAX, u32::MAX, Some([1, 1]), 1), "rows and"),
        (image(8000, 8000, None, 8000), "bytes cannot hold"),
        (image(60, 60, None, u32::MAX), "damaged"),
        (image(60, 60, None, 0), "an unknown layout"),
        (image(1, 1, Some([u32::MAX, u32::MAX]), 1), "side of its tiles"),
        (image(1, 1, Some([16_384, 16_384]), 1), "are too large"),
        (image(0, 5, None, 1), "5 rows and 0 columns"),
    ] {
        let found = fault(bytes);
        assert!(found.contains(expected), "{found}");
    }
}

/// Cuts a file at every byte and changes every byte; what comes out is a raster or a sentence, never a panic.
#[test]
fn damage_anywhere_is_a_sentence() {
    let mut small = raster(5, 4);
    small.nodata = Some(-1.0);
    let written = geotiff::to_bytes(&[(None, &small)]).expect("it fits");
    let codes = lzw(&[256, 7, 258, 259, 8, 258]);
    let by_lzw = packed(9, 5, &codes).placed().bytes(&codes);
    for file in [ascii::to_text(&small).into_bytes(), written, tiled(true), tiled(false), by_lzw] {
        for end in 0..file.len() {
            if let Err(fault) = parse(file[..end].to_vec()) {
                assert!(fault.to_string().len() > 10);
            }
        }
        for at in 0..file.len() {
            for change in [0x01, 0x80, 0xFF] {
                let mut changed = file.clone();
                changed[at] ^= change;
                if let Ok(raster) = parse(changed) {
                    assert_eq!(raster.values.len(), raster.rows * raster.cols);
                }
            }
        }
    }
}
