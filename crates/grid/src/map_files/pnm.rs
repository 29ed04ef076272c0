//! Netpbm images as grey values: bitmaps (P1, P4), grey maps (P2, P5), pixel maps (P3, P6) and maps of any tuples (P7).
//!
//! Source: Jef Poskanzer and others, "Netpbm file formats", pages "pbm", "pgm", "ppm" and "pam".

use std::io;
use std::io::{BufRead, Read};

use crate::map_files::Fault;
use crate::map_files::decoded::GreyImage;
use crate::map_files::error::{check_size, shown_letter};
use crate::map_files::pixel::{PixelLayout, Pixels, Transparency};
use wildfire_base::untrusted::visible_start;

/// A bit of a packed bitmap is the smallest pixel.
const PIXELS_PER_BYTE: usize = 8;

/// Most lines of the header of a P7, and most bytes of one.
const MAX_HEADER_LINES: usize = 1000;
const MAX_LINE: u64 = 1000;

/// Reads a Netpbm image from a file of `bytes` bytes, and says how it was converted to 8-bit grey.
///
/// The file ends with the image, apart from white space.
pub(super) fn read(mut source: impl BufRead, bytes: u64, transparency: Transparency) -> Result<GreyImage, Fault> {
    let header = PnmHeader::read(&mut source, transparency)?;
    let PnmHeader { rows, cols, layout, .. } = header;
    // No more room than the bytes of the file can fill, whatever its header claims.
    let possible = usize::try_from(bytes).unwrap_or(usize::MAX).saturating_mul(PIXELS_PER_BYTE);
    let mut pixels = Pixels::with_room(layout, possible.min(rows * cols))?;
    let mut raster = PnmPixels { source, header, bytes: Vec::new(), samples: Vec::new() };
    for row in 0..rows {
        raster.read_row(row)?;
        pixels.append(&raster.samples);
    }
    raster.check_end()?;
    Ok(pixels.into_image(rows, cols, Vec::from_iter(layout.note(header.kind))))
}

/// Returns whether a file begins as a Netpbm image does: a P, a digit from 1 to 7, white space. Behind P7 that
/// is a line feed: other programs have other files of this start.
pub(super) fn is_start(start: &[u8]) -> bool {
    matches!(start, [b'P', b'1'..=b'6', next, ..] if next.is_ascii_whitespace() || *next == b'#')
        || start.starts_with(b"P7\n")
        || start.starts_with(b"P7\r\n")
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Plain,
    Binary,
    Bits,
}

#[derive(Clone, Copy)]
struct PnmHeader {
    rows: usize,
    cols: usize,
    layout: PixelLayout,
    kind: &'static str,
    is_bitmap: bool,
    encoding: Encoding,
}

impl PnmHeader {
    fn read(source: &mut impl BufRead, transparency: Transparency) -> Result<Self, Fault> {
        let mut magic = [0; 2];
        source.read_exact(&mut magic)?;
        // Only the digits 1 to 7 pass `is_start`.
        let kind = magic[1] - b'0';
        if kind == 7 {
            return Self::read_tuples(source, transparency);
        }
        let is_bitmap = kind == 1 || kind == 4;
        let cols = header_number(source, "width")? as usize;
        let rows = header_number(source, "height")? as usize;
        check_size(rows, cols)?;
        // Bitmaps do not state the largest value: theirs is always 1.
        let max = if is_bitmap { 1 } else { header_number(source, "largest value")? };
        let max = largest_value(max)?;
        let encoding = match kind {
            1..=3 => Encoding::Plain,
            4 => Encoding::Bits,
            _ => Encoding::Binary,
        };
        let layout = PixelLayout { colour: kind == 3 || kind == 6, alpha: None, max };
        let kind = match (is_bitmap, layout.colour) {
            (true, _) => "black and white",
            (_, true) => "RGB",
            _ => "grey",
        };
        Ok(Self { rows, cols, layout, kind, is_bitmap, encoding })
    }

    /// Reads the lines behind P7, up to `ENDHDR`. Without a tuple type the depth decides, as in Netpbm's programs.
    fn read_tuples(source: &mut impl BufRead, transparency: Transparency) -> Result<Self, Fault> {
        const NUMBERS: [&str; 4] = ["HEIGHT", "WIDTH", "DEPTH", "MAXVAL"];
        let mut numbers = [None; 4];
        let mut tuple_type = String::new();
        for at in 0.. {
            let mut line = Vec::new();
            // Bounded, as a file that is none of this kind may have no line ends.
            source.by_ref().take(MAX_LINE).read_until(b'\n', &mut line)?;
            if !line.ends_with(b"\n") || at > MAX_HEADER_LINES {
                return Err(bad_header("its header has no line ENDHDR"));
            }
            let line = String::from_utf8_lossy(&line);
            let line = line.trim();
            let (name, value) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            match name {
                "ENDHDR" => break,
                "TUPLTYPE" if tuple_type.is_empty() => value.trim().clone_into(&mut tuple_type),
                // The format has several such lines joined with a blank.
                "TUPLTYPE" => tuple_type = format!("{tuple_type} {}", value.trim()),
                _ if name.is_empty() || name.starts_with('#') => {}
                _ => {
                    let number = NUMBERS
                        .iter()
                        .position(|number_name| *number_name == name)
                        .zip(value.trim().parse::<u32>().ok());
                    let Some((place, number)) = number.filter(|&(place, _)| numbers[place].is_none()) else {
                        let message = format!("its header has `{}`; expected one number each for", visible_start(line));
                        return Err(bad_header(&format!("{message} {}", NUMBERS.join(", "))));
                    };
                    numbers[place] = Some(number);
                }
            }
        }
        if let Some(missing) = numbers.iter().position(Option::is_none) {
            return Err(bad_header(&format!("its header has no {}", NUMBERS[missing])));
        }
        let [rows, cols, depth, max] = numbers.map(Option::unwrap_or_default);
        let max = largest_value(max)?;
        check_size(rows as usize, cols as usize)?;
        // Files without a type are read by their depth, as other programs do.
        let (kind, colour, has_alpha) = match (tuple_type.as_str(), depth) {
            ("BLACKANDWHITE", 1) => ("black and white", false, false),
            ("BLACKANDWHITE_ALPHA", 2) => ("black and white with alpha", false, true),
            ("GRAYSCALE" | "", 1) => ("grey", false, false),
            ("GRAYSCALE_ALPHA" | "", 2) => ("grey with alpha", false, true),
            ("RGB" | "", 3) => ("RGB", true, false),
            ("RGB_ALPHA" | "", 4) => ("RGB with alpha", true, true),
            (other, depth) => {
                let reason = format!(
                    "its tuples are of type `{}` and depth {depth}; expected BLACKANDWHITE or GRAYSCALE of depth 1, RGB \
                     of depth 3, or one of these with _ALPHA and a depth of one more",
                    visible_start(other)
                );
                return Err(Fault::Unread { format: "PAM", reason });
            }
        };
        let layout = PixelLayout { colour, alpha: has_alpha.then_some(transparency), max };
        let (rows, cols) = (rows as usize, cols as usize);
        Ok(Self { rows, cols, layout, kind, is_bitmap: false, encoding: Encoding::Binary })
    }

    fn bytes_per_row(&self) -> usize {
        match self.encoding {
            Encoding::Bits => self.cols.div_ceil(PIXELS_PER_BYTE),
            _ => self.cols * self.bytes_per_pixel(),
        }
    }

    fn bytes_per_pixel(&self) -> usize {
        self.layout.channels() * if self.layout.max > 255 { 2 } else { 1 }
    }
}

/// The pixels after the header, of which one row at a time is kept.
struct PnmPixels<R> {
    source: R,
    header: PnmHeader,
    bytes: Vec<u8>,
    samples: Vec<u16>,
}

impl<R: BufRead> PnmPixels<R> {
    fn read_row(&mut self, row: usize) -> Result<(), Fault> {
        self.samples.clear();
        match self.header.encoding {
            Encoding::Plain => self.read_plain(row)?,
            Encoding::Binary | Encoding::Bits => self.read_bytes(row)?,
        }
        let max = self.header.layout.max;
        if let Some(at) = self.samples.iter().position(|&sample| sample > max) {
            let col = at / self.header.layout.channels();
            let found = self.samples[at].to_string();
            return Err(Fault::Cell { row, col, found, expected: format!("at most {max}, as the header declares") });
        }
        Ok(())
    }

    fn read_plain(&mut self, row: usize) -> Result<(), Fault> {
        let PnmHeader { rows, cols, layout, is_bitmap, .. } = self.header;
        for at in 0..cols * layout.channels() {
            let col = at / layout.channels();
            let token = if is_bitmap { read_bit(&mut self.source) } else { read_number(&mut self.source) };
            let number = match token? {
                Token::Number(number) => number,
                Token::End => return Err(Fault::Ends { row, col, rows, cols }),
                Token::Other(byte) => {
                    let expected = if is_bitmap { "0 or 1" } else { "a whole number" }.to_owned();
                    return Err(Fault::Cell { row, col, found: shown_letter(&[byte]), expected });
                }
            };
            // Beyond 65,535 it is beyond any maximum value, which the caller checks.
            let Ok(sample) = u16::try_from(number) else {
                let expected = "a whole number up to the maximum of the header".to_owned();
                return Err(Fault::Cell { row, col, found: number.to_string(), expected });
            };
            // In a bitmap 1 is black.
            self.samples.push(if is_bitmap { 1 - sample } else { sample });
        }
        Ok(())
    }

    fn read_bytes(&mut self, row: usize) -> Result<(), Fault> {
        let PnmHeader { rows, cols, layout, encoding, .. } = self.header;
        let expected = self.header.bytes_per_row();
        self.bytes.clear();
        let found = self.source.by_ref().take(expected as u64).read_to_end(&mut self.bytes)?;
        let bytes = &self.bytes;
        if found < expected {
            // The column of the first pixel that is missing: in packed bitmaps one byte holds eight of them.
            let col = match encoding {
                Encoding::Bits => found * PIXELS_PER_BYTE,
                _ => found / self.header.bytes_per_pixel(),
            };
            return Err(Fault::Ends { row, col, rows, cols });
        }
        if encoding == Encoding::Bits {
            // The leftmost pixel is the highest bit, and 1 is black.
            self.samples.extend((0..cols).map(|col| {
                let bit = bytes[col / PIXELS_PER_BYTE] >> (7 - col % PIXELS_PER_BYTE) & 1;
                u16::from(1 - bit)
            }));
        } else if layout.max > 255 {
            // Netpbm puts the more significant byte first.
            self.samples.extend(bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])));
        } else {
            self.samples.extend(bytes.iter().map(|&byte| u16::from(byte)));
        }
        Ok(())
    }

    fn check_end(mut self) -> Result<(), Fault> {
        match next_solid(&mut self.source)? {
            None => Ok(()),
            Some(_) => Err(Fault::GoesOn { rows: self.header.rows }),
        }
    }
}

enum Token {
    Number(u32),
    End,
    Other(u8),
}

/// The next number of a plain raster or a header, and the one byte of white space after it.
fn read_number(source: &mut impl BufRead) -> io::Result<Token> {
    let mut number = 0u32;
    let mut next = next_solid(source)?;
    if next.is_none() {
        return Ok(Token::End);
    }
    while let Some(byte) = next.filter(|byte| !byte.is_ascii_whitespace()) {
        if !byte.is_ascii_digit() {
            return Ok(Token::Other(byte));
        }
        // Saturating: a number that does not fit is as wrong as any that is too large.
        number = number.saturating_mul(10).saturating_add(u32::from(byte - b'0'));
        next = next_byte(source)?;
    }
    Ok(Token::Number(number))
}

/// The next bit of a plain bitmap, whose bits need no white space between them.
fn read_bit(source: &mut impl BufRead) -> io::Result<Token> {
    Ok(match next_solid(source)? {
        None => Token::End,
        Some(bit @ (b'0' | b'1')) => Token::Number(u32::from(bit - b'0')),
        Some(other) => Token::Other(other),
    })
}

fn header_number(source: &mut impl BufRead, name: &str) -> Result<u32, Fault> {
    match read_number(source)? {
        Token::Number(number) => Ok(number),
        Token::End => Err(bad_header(&format!("the file ends before the {name}"))),
        Token::Other(byte) => {
            Err(bad_header(&format!("the {name} must be a whole number, found {}", shown_letter(&[byte]))))
        }
    }
}

fn largest_value(max: u32) -> Result<u16, Fault> {
    let max = u16::try_from(max).ok().filter(|&max| max > 0);
    max.ok_or_else(|| bad_header("the largest value must be 1 to 65535"))
}

fn bad_header(message: &str) -> Fault {
    Fault::Image { message: message.to_owned() }
}

/// The next byte that is neither white space nor in a comment.
fn next_solid(source: &mut impl BufRead) -> io::Result<Option<u8>> {
    loop {
        match next_byte(source)? {
            Some(byte) if byte.is_ascii_whitespace() => {}
            Some(b'#') => {
                source.skip_until(b'\n')?;
            }
            next => return Ok(next),
        }
    }
}

fn next_byte(source: &mut impl BufRead) -> io::Result<Option<u8>> {
    let next = source.fill_buf()?.first().copied();
    source.consume(usize::from(next.is_some()));
    Ok(next)
}
