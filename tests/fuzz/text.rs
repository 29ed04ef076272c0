//! Inputs made of other inputs: bytes flipped, lines moved, numbers replaced by those at the edges of types.

use arbitrary::Unstructured;

use super::{below, chance, one_of};

/// The most bytes of an input that is made of others.
const MAX_BYTES: usize = 1 << 16;

/// Spellings of numbers at which readers differ or go wrong.
pub const NUMBERS: &[&str] = &[
    "0",
    "1",
    "-1",
    "-0",
    "-0.0",
    "0.5",
    "2",
    "10",
    "100",
    "1000",
    "1e3",
    "1e-3",
    "1e6",
    "1000000.0001",
    "0.1",
    "0.30000000000000004",
    "nan",
    "-nan",
    "inf",
    "+inf",
    "-inf",
    "NaN",
    "Infinity",
    "null",
    "none",
    "1e308",
    "-1e308",
    "1.7976931348623157e308",
    "1e309",
    "1e999999999999",
    "1e-308",
    "5e-324",
    "1e-999",
    "127",
    "128",
    "255",
    "256",
    "-128",
    "32767",
    "32768",
    "65535",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "340282366920938463463374607431768211456",
    "00012",
    "1_000",
    "+7",
    "0x1F",
    "0b11",
    ".5",
    "5.",
    "1e",
    "--1",
    "1,5",
    "٣",
    "1 000",
    "",
];

/// Scraps that may be anywhere: ends, marks, quotes, letters of several bytes, controls.
pub const SCRAPS: &[&[u8]] = &[
    b"\n",
    b"\r\n",
    b"\r",
    b"\t",
    b"\0",
    b" ",
    b",",
    b"=",
    b".",
    b"..",
    b"\"",
    b"'",
    b"\"\"\"",
    b"'''",
    b"[",
    b"]",
    b"[[",
    b"]]",
    b"{",
    b"}",
    b"{}",
    b"[]",
    b":",
    b"#",
    b"/",
    b"\\",
    b"\\u0000",
    b"\\uD800",
    b"\x1b[31m",
    b"\x7f",
    b"\xFF",
    b"\xC3",
    b"\xEF\xBB\xBF",
    b"\xFF\xFE",
    "é".as_bytes(),
    "\u{202E}".as_bytes(),
    "\u{1F525}".as_bytes(),
    b"true",
    b"false",
    b"null",
    b"none",
];

/// Draws one of the samples with some changes, and now and then none; `tokens` may be put in anywhere.
pub fn mutated<S: AsRef<[u8]>>(dice: &mut Unstructured<'_>, samples: &[S], tokens: &[&str]) -> Vec<u8> {
    let mut bytes = one_of(dice, samples).as_ref().to_vec();
    for _ in 0..below(dice, 5) {
        mutate(dice, &mut bytes, samples, tokens);
        bytes.truncate(MAX_BYTES);
    }
    bytes
}

fn mutate<S: AsRef<[u8]>>(dice: &mut Unstructured<'_>, bytes: &mut Vec<u8>, samples: &[S], tokens: &[&str]) {
    match below(dice, 12) {
        0..=2 => replace_number(dice, bytes),
        3 => {
            let stretch = stretch(dice, bytes.len());
            bytes.drain(stretch);
        }
        4 => {
            let copied = bytes[stretch(dice, bytes.len())].to_vec();
            let times = if chance(dice, 5) { below(dice, 2000) } else { 1 };
            let times = times.min(MAX_BYTES / (1 + copied.len()));
            insert(dice, bytes, &copied.repeat(times));
        }
        5 => {
            let other = one_of(dice, samples).as_ref();
            let copied = other[stretch(dice, other.len())].to_vec();
            insert(dice, bytes, &copied);
        }
        6 => {
            let scrap = *one_of(dice, SCRAPS);
            insert(dice, bytes, scrap);
        }
        7 if !tokens.is_empty() => {
            let word = *one_of(dice, tokens);
            insert(dice, bytes, word.as_bytes());
        }
        8 => move_line(dice, bytes),
        9 => {
            let length = below(dice, bytes.len() + 1);
            bytes.truncate(length);
        }
        10 if !bytes.is_empty() => {
            let at = below(dice, bytes.len());
            bytes[at] ^= 1 << below(dice, 8);
        }
        _ if !bytes.is_empty() => {
            let at = below(dice, bytes.len());
            bytes[at] = dice.arbitrary().unwrap_or_default();
        }
        _ => {}
    }
}

fn insert(dice: &mut Unstructured<'_>, bytes: &mut Vec<u8>, new: &[u8]) {
    let at = below(dice, bytes.len() + 1);
    bytes.splice(at..at, new.iter().copied());
}

/// Draws a stretch, mostly a short one.
fn stretch(dice: &mut Unstructured<'_>, length: usize) -> std::ops::Range<usize> {
    let start = below(dice, length + 1);
    let longest = if chance(dice, 80) { 16 } else { length };
    start..start + below(dice, (length - start).min(longest) + 1)
}

/// Puts another number in the place of one, or of its last digit.
fn replace_number(dice: &mut Unstructured<'_>, bytes: &mut Vec<u8>) {
    let digits: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
    if digits.is_empty() {
        return;
    }
    let is_of_number = |byte: &u8| byte.is_ascii_digit() || b"+-._eE".contains(byte);
    let at = *one_of(dice, &digits);
    let start = bytes[..at].iter().rposition(|byte| !is_of_number(byte)).map_or(0, |before| before + 1);
    let end = bytes[at..].iter().position(|byte| !is_of_number(byte)).map_or(bytes.len(), |length| at + length);
    if chance(dice, 40) {
        bytes[at] = b'0' + below(dice, 10) as u8;
    } else {
        let number = *one_of(dice, NUMBERS);
        bytes.splice(start..end, number.bytes());
    }
}

/// Moves a line elsewhere, or repeats it there.
fn move_line(dice: &mut Unstructured<'_>, bytes: &mut Vec<u8>) {
    let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
    if lines.is_empty() {
        return;
    }
    let from = below(dice, lines.len());
    let line = if chance(dice, 50) { lines[from].clone() } else { lines.remove(from) };
    lines.insert(below(dice, lines.len() + 1), line);
    *bytes = lines.concat();
}
