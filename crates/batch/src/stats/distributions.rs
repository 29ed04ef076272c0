//! Quantiles and tails of the distributions behind intervals and tests.

use statrs::distribution::{Binomial, Continuous, ContinuousCDF, DiscreteCDF, Normal, StudentsT};
use std::f64::consts::PI;

use statrs::function::beta::beta_reg;
use statrs::function::gamma::ln_gamma;

use crate::stats::CONFIDENCE;
use wildfire_base::geometry::ops;

/// Returns the distance, in standard errors, from the centre of a normal interval to either end.
pub fn normal_reach() -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * CONFIDENCE)
}

/// Returns the same distance for Student's t, for a positive number of degrees of freedom that need not be an integer.
pub fn t_reach(degrees: f64) -> f64 {
    t_quantile_above(0.5 * (1.0 - CONFIDENCE), degrees)
}

/// Returns the value that Student's t exceeds with this probability, which is below a half.
///
/// With many degrees of freedom it is the beginning of a series in their reciprocal (Abramowitz, Stegun, "Handbook of
/// mathematical functions", 1964, 26.7.5); the search of `statrs` may not end there.
pub fn t_quantile_above(probability: f64, degrees: f64) -> f64 {
    if degrees > 1e5 {
        let z = Normal::standard().inverse_cdf(1.0 - probability);
        let square = z * z;
        let first = z * (square + 1.0) / (4.0 * degrees);
        return z + first + z * (3.0 + square * (16.0 + square * 5.0)) / (96.0 * degrees * degrees);
    }
    let t = students_t(degrees);
    let rough = t.inverse_cdf(1.0 - probability);
    // One step of Newton's method: with many degrees of freedom the quantile has six digits, its probability more.
    rough + (t.sf(rough) - probability) / t.pdf(rough)
}

/// Returns the probability that Student's t exceeds a number.
pub fn t_above(t: f64, degrees: f64) -> f64 {
    students_t(degrees).sf(t)
}

/// Returns the probability that a noncentral t lies at least `t` > 0 from zero, on either side; `shift` is the mean of
/// its normal variable.
///
/// Its square is a noncentral F: a Poisson mixture of beta distributions (Johnson, Kotz, Balakrishnan, "Continuous
/// Univariate Distributions" 2, 1995, section 30.3). With every incomplete beta function written as its series, the
/// probability of less than `t` is a single sum of positive terms, so that no digits cancel.
pub fn noncentral_t_two_sided(t: f64, degrees: f64, shift: f64) -> f64 {
    /// Beyond this mean of the Poisson distribution there is no probability left within reach of a test at 5 %.
    const LARGEST_RATE: f64 = 1e5;
    let rate = 0.5 * shift * shift;
    if rate > LARGEST_RATE {
        return 1.0;
    }
    let b = 0.5 * degrees;
    let share = t * t / (degrees + t * t);
    let chance = |count: f64| match rate {
        // The logarithm of a rate of 0 is infinite, although its distribution is that of a certain 0.
        0.0 => f64::from(u8::from(count == 0.0)),
        _ => ops::exp(count * ops::ln(rate) - rate - ln_gamma(count + 1.0)),
    };
    // x^(k + 1/2) (1 - x)^b / ((k + 1/2) B(k + 1/2, b)) for k = 0; Γ(3/2) is half the root of π.
    let remainder = ops::exp(-b * ops::ln_1p(t * t / degrees));
    let mut term = 2.0 / PI.sqrt() * gamma_half_step(b) * share.sqrt() * remainder;
    let mut at_most = 0.0;
    let mut below = 0.0;
    let mut count = 0.0;
    loop {
        at_most += chance(count);
        // Rounding may bring the sum of all chances just above 1.
        let added = term * f64::min(at_most, 1.0);
        below += added;
        let ratio = share * (count + 0.5 + b) / (count + 1.5);
        // From here on ratios fall to `share`, or rise to it: the rest is less than a geometric series.
        let largest = ratio.max(share);
        // Below the mean of the Poisson distribution terms still grow, and a small one is no sign of the end.
        if count > rate && largest < 1.0 && term * largest <= 1e-17 * (1.0 - largest) {
            // Rounding may leave a probability just outside of its range.
            return (1.0 - below).clamp(0.0, 1.0);
        }
        term *= ratio;
        count += 1.0;
    }
}

/// Returns Γ(b + 1/2) / Γ(b), for b > 0: of large ones by the expansion of Tricomi and Erdélyi (Pacific Journal of
/// Mathematics 1, 1951), as differences of their logarithms lose digits.
fn gamma_half_step(b: f64) -> f64 {
    if b < 100.0 {
        return ops::exp(ln_gamma(b + 0.5) - ln_gamma(b));
    }
    let terms = [-1.0 / 8.0, 1.0 / 128.0, 5.0 / 1024.0, -21.0 / 32_768.0];
    b.sqrt() * (1.0 + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / b))
}

/// Returns the probability that a normal variable lies at least `z` from zero, on either side.
pub fn normal_two_sided(z: f64) -> f64 {
    2.0 * Normal::standard().sf(z.abs())
}

/// Returns the same probability for Student's t.
pub fn t_two_sided(t: f64, degrees: f64) -> f64 {
    2.0 * students_t(degrees).sf(t.abs())
}

/// Returns the probability of at most `hits` hits in `trials` trials, of which each hits with probability `rate`.
pub fn binomial_at_most(hits: u64, trials: u64, rate: f64) -> f64 {
    Binomial::new(rate, trials).expect("a rate lies from 0 to 1").cdf(hits)
}

/// Returns the probability that Fisher's F with these positive degrees of freedom, which need not be integers, is at
/// least `f`.
pub fn f_at_least(f: f64, [above, below]: [f64; 2]) -> f64 {
    // The incomplete beta function from the far end, where small probabilities keep their digits.
    beta_reg(0.5 * below, 0.5 * above, below / (below + above * f))
}

fn students_t(degrees: f64) -> StudentsT {
    StudentsT::new(0.0, 1.0, degrees).expect("degrees of freedom are positive")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::assert_close;

    const NORMAL_975: f64 = 1.959963984540054;
    const T_975: [(f64, f64); 8] = [
        (1.0, 12.706204736174694),
        (2.0, 4.302652729749462),
        (4.0, 2.7764451051977934),
        (7.25, 2.348194849105371),
        (29.0, 2.045229642132703),
        (199.0, 1.9719565442517533),
        (1999.0, 1.9611514201705613),
        (100000.0, 1.9599877075346095),
    ];
    const NORMAL_TAILS: [(f64, f64); 4] =
        [(0.0, 1.0), (0.5, 0.6170750774519738), (1.96, 0.04999579029644087), (6.0, 1.973175290075389e-09)];
    const T_TAILS: [(f64, f64, f64); 4] = [
        (0.3, 4.0, 0.7791214282774598),
        (2.5, 29.0, 0.018325344338426086),
        (7.0, 199.0, 3.834069798555969e-11),
        (3.0, 12.5, 0.010632811509896659),
    ];
    const BINOMIAL: [(u64, u64, f64, f64); 4] = [
        (3, 10, 0.5, 0.171875),
        (9, 30, 0.5, 0.021386972628533847),
        (80, 200, 0.5, 0.002842577998375153),
        (4950, 10000, 0.5, 0.16108709989765543),
    ];

    /// Where SciPy has no number, or few digits, the integral of the definition over the chi variable by
    /// `scipy.integrate.quad`.
    const NONCENTRAL_T: [(f64, f64, f64, f64); 8] = [
        (12.706204736174694, 1.0, 0.5, 0.05609625683084652),
        (12.706204736174694, 1.0, 45.0, 0.9995854746950021),
        (2.7764451051977934, 4.0, 2.0, 0.3359651039111674),
        (2.045229642132703, 29.0, 0.0, 0.05),
        (2.045229642132703, 29.0, 2.8, 0.7722536333919405),
        (1.9719565442517533, 199.0, 2.0, 0.5121567595235923),
        (1.9719565442517533, 199.0, 6.5, 0.9999967344100854),
        (1.96, 100000.0, 2.8, 0.7995458870220757),
    ];
    const F_TAILS: [(f64, [f64; 2], f64); 6] = [
        (0.0, [2.0, 5.0], 1.0),
        (1.0, [2.0, 10.0], 0.4018775720164609),
        (3.7, [1.29, 6.46], 0.09469655814260129),
        (25.0, [2.0, 998.0], 2.5460097425602167e-11),
        (4.2, [11.0, 219.0], 1.1943361901811708e-05),
        (60.0, [1.5, 1400.5], 3.6458253433815223e-20),
    ];

    #[test]
    fn reaches_are_those_of_scipy() {
        assert_close(normal_reach(), NORMAL_975);
        // `scipy.stats.t.ppf(0.975, n)`
        for (degrees, expected) in T_975 {
            assert_close(t_reach(degrees), expected);
        }
    }

    #[test]
    fn reach_falls_towards_the_normal_one() {
        let mut last = f64::INFINITY;
        for degrees in (1..200).chain([500, 1000, 1999, 2000, 2001, 100_000]) {
            let reach = t_reach(f64::from(degrees));
            assert!(reach < last && reach > normal_reach(), "{degrees}");
            last = reach;
        }
    }

    #[test]
    fn tails_are_those_of_scipy() {
        // `2 * scipy.stats.norm.sf(z)`
        for (z, expected) in NORMAL_TAILS {
            assert_close(normal_two_sided(z), expected);
            assert_close(normal_two_sided(-z), expected);
        }
        // `2 * scipy.stats.t.sf(t, n)`
        for (t, degrees, expected) in T_TAILS {
            assert_close(t_two_sided(t, degrees), expected);
        }
        // `scipy.stats.f.sf(f, m, n)`
        for (f, degrees, expected) in F_TAILS {
            assert_close(f_at_least(f, degrees), expected);
        }
        // `scipy.stats.nct.sf(t, n, s) + scipy.stats.nct.cdf(-t, n, s)` of SciPy 1.17
        for (t, degrees, shift, expected) in NONCENTRAL_T {
            assert_close(noncentral_t_two_sided(t, degrees, shift), expected);
        }
        // `scipy.stats.binom.cdf(k, n, p)`
        for (hits, trials, rate, expected) in BINOMIAL {
            assert_close(binomial_at_most(hits, trials, rate), expected);
        }
    }
}
