//! The low-discrepancy sequence of the milestones.
//!
//! J. H. Halton, "On the efficiency of certain quasi-random sequences of points in evaluating multi-dimensional
//! integrals", Numerische Mathematik 2, 1960.

/// The digits of `index` in a base, mirrored at the point: in [0, 1).
pub fn radical_inverse(base: u32, index: u32) -> f64 {
    let mut rest = index;
    // In whole numbers only the last division rounds, so the sequence has the same bits everywhere.
    let mut mirrored = 0u64;
    let mut scale = 1u64;
    while rest > 0 {
        mirrored = mirrored * u64::from(base) + u64::from(rest % base);
        scale *= u64::from(base);
        rest /= base;
    }
    mirrored as f64 / scale as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radical_inverses_are_mirrored_digits() {
        assert_eq!([1, 2, 3, 4, 6].map(|i| radical_inverse(2, i)), [0.5, 0.25, 0.75, 0.125, 0.375]);
        assert_eq!([1, 2, 3, 5].map(|i| radical_inverse(3, i)), [1.0 / 3.0, 2.0 / 3.0, 1.0 / 9.0, 7.0 / 9.0]);
        assert!(radical_inverse(3, u32::MAX) < 1.0);
    }
}
