//! NumPy arrays as files: values as bytes, and what stands before them.

/// A value that an array can hold: `bool` (as 0 and 1), `u8`, `u16`, `u32`, `f64`.
pub trait NpyValue: Copy {
    /// The value's type as NumPy writes it, little-endian.
    const NUMPY_TYPE: &'static str;

    /// Appends the bytes of the value, the lowest first.
    fn append_bytes(self, bytes: &mut Vec<u8>);
}

impl NpyValue for bool {
    const NUMPY_TYPE: &'static str = "|b1";

    fn append_bytes(self, bytes: &mut Vec<u8>) {
        bytes.push(u8::from(self));
    }
}

macro_rules! number {
    ($number:ty, $numpy_type:literal) => {
        impl NpyValue for $number {
            const NUMPY_TYPE: &'static str = $numpy_type;

            fn append_bytes(self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }
        }
    };
}

number!(u8, "|u1");
number!(u16, "<u2");
number!(u32, "<u4");
number!(f64, "<f8");

/// Returns what stands before the values of a NumPy array in C order: magic, version, length and dictionary, padded with
/// spaces to a multiple of 64 bytes.
///
/// Source: "NEP 1 - A Simple File Format for NumPy Arrays", format version 1.0.
pub fn npy_header(numpy_type: &str, shape: &[usize]) -> Vec<u8> {
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    // A tuple of one needs its comma, longer ones end without.
    let shape = if shape.len() > 1 { sides.trim_end_matches(", ") } else { sides.trim_end() };
    let dictionary = format!("{{'descr': '{numpy_type}', 'fortran_order': False, 'shape': ({shape}), }}");
    let before = b"\x93NUMPY\x01\x00".len() + size_of::<u16>();
    let total = (before + dictionary.len() + 1).next_multiple_of(64);
    let length = u16::try_from(total - before).expect("a dictionary is short");
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend_from_slice(&length.to_le_bytes());
    header.extend_from_slice(dictionary.as_bytes());
    header.resize(total - 1, b' ');
    header.push(b'\n');
    header
}
