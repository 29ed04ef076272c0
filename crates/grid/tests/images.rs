//! Images have the pixels that the crate `image` finds in them, which only tests use.

use std::io::Cursor;
use std::path::Path;

use image::codecs::bmp::BmpEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::codecs::webp::WebPEncoder;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader};
use rand::RngExt;
use wildfire_base::rng;
use wildfire_grid::map_files::{self, MapFile};

/// Small images by Pillow 12, of kinds that `image` cannot encode.
const STORED: [&[u8]; 8] = [
    include_bytes!("images/animation.webp"),
    include_bytes!("images/cmyk.jpg"),
    include_bytes!("images/lossy.webp"),
    include_bytes!("images/lossy_alpha.webp"),
    include_bytes!("images/progressive.jpg"),
    include_bytes!("images/restarts.jpg"),
    include_bytes!("images/rgb.jpg"),
    include_bytes!("images/ycck.jpg"),
];

const SIZES: [(u32, u32); 4] = [(1, 1), (3, 5), (17, 9), (40, 33)];

fn read(bytes: &[u8]) -> Option<MapFile> {
    map_files::read_bytes(Path::new("map"), bytes.to_vec(), 127).ok()
}

/// The grey values of an image as the crate `image` decodes it: luma over white.
fn expected(bytes: &[u8]) -> Option<Vec<u8>> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
    let is_png = reader.format() == Some(ImageFormat::Png);
    let mut decoder = reader.into_decoder().ok()?;
    let orientation = decoder.orientation().ok()?;
    let mut image = DynamicImage::from_decoder(decoder).ok()?;
    if !is_png {
        image.apply_orientation(orientation);
    }
    // Samples of 8 bits become words without a loss.
    let image = image.into_rgba16();
    let grey = image.pixels().map(|pixel| {
        let [red, green, blue, alpha] = pixel.0.map(u64::from);
        let whole = 1000 * 65_535 * 65_535;
        let luma = (299 * red + 587 * green + 114 * blue) * alpha + 1000 * 65_535 * (65_535 - alpha);
        ((luma * 255 + whole / 2) / whole) as u8
    });
    Some(grey.collect())
}

fn random_bytes(count: usize, name: &str) -> Vec<u8> {
    let mut rng = rng::stream(1, name);
    (0..count).map(|_| rng.random()).collect()
}

/// Images by the encoders of `image`, with random pixels.
fn encoded() -> Vec<Vec<u8>> {
    use ExtendedColorType::{L8, L16, La8, La16, Rgb8, Rgb16, Rgba8, Rgba16};
    let mut files = Vec::new();
    for (cols, rows) in SIZES {
        for kind in [L8, La8, Rgb8, Rgba8, L16, La16, Rgb16, Rgba16] {
            let pixels =
                random_bytes((cols * rows * u32::from(kind.bits_per_pixel()) / 8) as usize, &format!("{kind:?}"));
            let mut add = |encode: &dyn Fn(&mut Vec<u8>) -> image::ImageResult<()>| {
                let mut file = Vec::new();
                encode(&mut file).expect("it can be encoded");
                files.push(file);
            };
            add(&|file| PngEncoder::new(file).write_image(&pixels, cols, rows, kind));
            if matches!(kind, L8 | La8 | Rgb8 | Rgba8) {
                add(&|file| WebPEncoder::new_lossless(file).write_image(&pixels, cols, rows, kind));
                add(&|file| BmpEncoder::new(file).write_image(&pixels, cols, rows, kind));
            }
            if !matches!(kind, L8 | Rgb8) {
                continue;
            }
            for quality in [10, 75, 100] {
                add(&|file| JpegEncoder::new_with_quality(file, quality).write_image(&pixels, cols, rows, kind));
            }
            for orientation in 0..10 {
                add(&|file| {
                    let mut encoder = JpegEncoder::new(file);
                    encoder.set_exif_metadata(exif(orientation)).expect("JPEG has Exif data");
                    encoder.write_image(&pixels, cols, rows, kind)
                });
                add(&|file| {
                    let mut encoder = WebPEncoder::new_lossless(file);
                    encoder.set_exif_metadata(exif(orientation)).expect("WebP has Exif data");
                    encoder.write_image(&pixels, cols, rows, kind)
                });
            }
        }
    }
    files
}

/// Exif data with two tags, the second of which is an orientation; odd ones are little-endian.
fn exif(orientation: u8) -> Vec<u8> {
    if orientation % 2 == 1 {
        let tags = b"\x02\0\x0F\x01\x02\0\x01\0\0\0a\0\0\0\x12\x01\x03\0\x01\0\0\0";
        [b"II*\0\x08\0\0\0", &tags[..], &[orientation, 0, 0, 0, 0, 0, 0, 0]].concat()
    } else {
        let tags = b"\0\x02\x01\x0F\0\x02\0\0\0\x01a\0\0\0\x01\x12\0\x03\0\0\0\x01";
        [b"MM\0*\0\0\0\x08", &tags[..], &[0, orientation, 0, 0, 0, 0, 0, 0]].concat()
    }
}

/// PNG images of all depths, interlaced and not, with transparent colours and without.
fn made_pngs() -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    let kinds =
        [(0, 1), (0, 2), (0, 4), (0, 8), (0, 16), (2, 8), (2, 16), (3, 1), (3, 2), (3, 4), (3, 8), (4, 8), (6, 16)];
    for ((cols, rows), (colours, depth)) in SIZES.into_iter().flat_map(|size| kinds.map(|kind| (size, kind))) {
        let channels = [1, 0, 3, 1, 2, 0, 4][colours];
        let transparent: &[&[u8]] = match colours {
            0 => &[&[], &[0, 1]],
            2 => &[&[], &[0, 1, 0, 2, 0, 3]],
            3 => &[&[], &[0, 130]],
            _ => &[&[]],
        };
        for (is_interlaced, transparent) in [0, 1].into_iter().flat_map(|is| transparent.iter().map(move |it| (is, it)))
        {
            // The first pixel of a pass, and the steps to the next in a row and to the next row.
            let passes: &[[u32; 4]] = if is_interlaced == 1 {
                &[[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]]
            } else {
                &[[0, 0, 1, 1]]
            };
            let mut raw = Vec::new();
            for [left, top, step, row_step] in passes {
                let pass_cols = cols.saturating_sub(*left).div_ceil(*step);
                let pass_rows = rows.saturating_sub(*top).div_ceil(*row_step);
                for row in 0..if pass_cols == 0 { 0 } else { pass_rows } {
                    raw.push((row % 5) as u8);
                    raw.extend(random_bytes((pass_cols * channels * depth).div_ceil(8) as usize, &format!("{row}")));
                }
            }
            let size = [cols.to_be_bytes(), rows.to_be_bytes()].concat();
            let header = [&size[..], &[depth as u8, colours as u8, 0, 0, is_interlaced]].concat();
            let palette = random_bytes(3 << depth.min(8), "palette");
            let packed = miniz_oxide::deflate::compress_to_vec_zlib(&raw, 6);
            let chunks: [(&[u8; 4], &[u8]); 5] =
                [(b"IHDR", &header), (b"PLTE", &palette), (b"tRNS", transparent), (b"IDAT", &packed), (b"IEND", &[])];
            let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
            for (name, data) in chunks {
                let is_left_out = name == b"PLTE" && colours != 3 || name == b"tRNS" && data.is_empty();
                if !is_left_out {
                    let body = [name, data].concat();
                    file.extend((data.len() as u32).to_be_bytes());
                    file.extend(&body);
                    file.extend(crc32fast::hash(&body).to_be_bytes());
                }
            }
            files.push(file);
        }
    }
    files
}

/// GIF images whose first frame is and is not as large as the canvas, and lies within it, or beyond.
fn made_gifs() -> Vec<Vec<u8>> {
    let places = [[0, 0, 9, 7], [1, 2, 4, 3], [0, 2, 9, 2], [3, 0, 9, 7], [0, 3, 9, 9], [0, 0, 12, 9], [10, 8, 3, 3]];
    let mut files = Vec::new();
    for ([left, top, width, height], transparent) in places.into_iter().flat_map(|it| [(it, None), (it, Some(2))]) {
        let mut file = Vec::new();
        let mut encoder = gif::Encoder::new(&mut file, 9, 7, &random_bytes(12, "palette")).expect("it can be encoded");
        for interlaced in [width == 9, false] {
            let pixels: Vec<u8> = (0..width * height).map(|at| (at * at / 3 % 4) as u8).collect();
            let frame = gif::Frame { left, top, interlaced, transparent, ..gif::Frame::default() };
            let frame = gif::Frame { width, height, buffer: pixels.into(), ..frame };
            encoder.write_frame(&frame).expect("it can be encoded");
        }
        drop(encoder);
        files.push(file);
    }
    files
}

/// BMP images of all depths, headers and ways of packing, from the upper row down and from the lower one up.
fn made_bmps() -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    let masks: [[u32; 4]; 6] = [
        [0x7C00, 0x3E0, 0x1F, 0],
        [0xF800, 0x7E0, 0x1F, 0],
        [0xF00, 0xF0, 0xF, 0xF000],
        [0xFF_0000, 0xFF00, 0xFF, 0xFF00_0000],
        [0x3FF, 0xF_FC00, 0x3FF0_0000, 0xC000_0000],
        [7, 0x18, 0x20, 0x7FC0],
    ];
    for (cols, rows) in SIZES {
        for (bits, packing) in [(1, 0), (2, 0), (4, 0), (8, 0), (16, 0), (24, 0), (32, 0), (8, 1), (4, 2)] {
            for is_down in [false, packing == 0] {
                files.push(bmp([cols, rows], bits, packing, 40, &[], is_down));
            }
        }
        for (bits, masks) in [16, 32].into_iter().flat_map(|bits| masks.map(|masks| (bits, masks))) {
            let headers =
                [40, 52, 56, 108, 124].into_iter().filter(|_| bits == 32 || masks.iter().max() < Some(&65_536));
            files.extend(headers.map(|header| bmp([cols, rows], bits, 3, header, &masks, header == 108)));
        }
        for bits in [1, 4, 8, 24] {
            files.push(bmp([cols, rows], bits, 0, 12, &[], false));
        }
    }
    files
}

fn bmp([cols, rows]: [u32; 2], bits: u32, packing: u32, header_bytes: usize, masks: &[u32], is_down: bool) -> Vec<u8> {
    let mut header = Vec::new();
    if header_bytes == 12 {
        header.extend([12, rows << 16 | cols, bits << 16 | 1].map(u32::to_le_bytes).concat());
    } else {
        let rows = if is_down { rows.wrapping_neg() } else { rows };
        let fields = [header_bytes as u32, cols, rows, bits << 16 | 1, packing, 0, 0, 0, 0, 0];
        let masks = masks.iter().take(if header_bytes == 40 { 3 } else { 4 });
        header.extend(fields.iter().chain(masks).flat_map(|field| field.to_le_bytes()));
        header.resize(header_bytes.max(header.len().min(header_bytes + 12)), 0);
    }
    if bits <= 8 {
        header.extend(random_bytes(if header_bytes == 12 { 3 } else { 4 } << bits, "palette"));
    }
    let mut pixels = random_bytes(((bits * cols).div_ceil(32) * 4 * rows) as usize, "pixels");
    if packing == 1 || packing == 2 {
        // A run and single pixels, cut at the end of the row by a step to the next, now and then over a row.
        pixels.clear();
        for row in 0..rows {
            let run = cols.min(5) as u8;
            pixels.extend([run, (row * 0x3A) as u8]);
            if cols >= 12 {
                pixels.extend(b"\0\x05\x12\x30\x4F\x11\x0D\0");
                pixels.truncate(pixels.len() - if bits == 4 { 2 } else { 0 });
                pixels.extend([0, 2, 1, u8::from(row == 2), 1, 0x77]);
            }
            pixels.extend([0, 0]);
        }
        pixels.extend([0, 1]);
    }
    let start = 14 + header.len() as u32;
    [b"BM", &[0; 8][..], &start.to_le_bytes(), &header, &pixels].concat()
}

fn all_images() -> Vec<Vec<u8>> {
    let stored = STORED.map(<[u8]>::to_vec).to_vec();
    [stored, encoded(), made_pngs(), made_gifs(), made_bmps()].concat()
}

#[test]
fn images_have_the_pixels_that_another_reader_finds() {
    let images = all_images();
    assert!(images.len() > 500, "{}", images.len());
    for (index, bytes) in images.iter().enumerate() {
        let name = format!("image {index}: {:02x?}", &bytes[..bytes.len().min(60)]);
        let map = map_files::read_bytes(Path::new("map"), bytes.clone(), 127)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let expected = expected(bytes).expect(&name);
        assert!(map.grey.as_ref().is_some_and(|grey| grey.values() == expected), "{name}");
    }
}

#[test]
fn damaged_images_are_refused_or_read_as_another_reader_does() {
    let images = all_images();
    let mut rng = rng::stream(2, "damaged images");
    let mut read_images = 0;
    for _ in 0..3000 {
        let mut bytes = images[rng.random_range(0..images.len())].clone();
        // Headers are hit as often as everything behind them.
        let end = if rng.random() { bytes.len().min(100) } else { bytes.len() };
        for _ in 0..rng.random_range(0..4) {
            bytes[rng.random_range(0..end)] = rng.random();
        }
        if rng.random() {
            bytes.truncate(rng.random_range(1..=bytes.len()));
        }
        if let Some(grey) = read(&bytes).and_then(|map| map.grey) {
            read_images += 1;
            let name = format!("{:02x?}", &bytes[..bytes.len().min(200)]);
            assert!(expected(&bytes).expect(&name) == grey.values(), "{name}");
        }
    }
    assert!(read_images > 500, "{read_images}");
}

#[test]
fn frame_of_another_size_than_its_alpha_is_refused() {
    let bytes = include_bytes!("images/unlike_alpha.webp");
    let refusal = map_files::read_bytes(Path::new("map"), bytes.to_vec(), 127).expect_err("it is damaged").to_string();
    assert_eq!(refusal, "map: the image is damaged: its first frame has another size than its pixels");
}
