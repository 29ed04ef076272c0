//! Quantiles and tails of the distributions that intervals and tests are made of.

use statrs::distribution::{Binomial, Continuous, ContinuousCDF, DiscreteCDF, Normal, StudentsT};
use statrs::function::beta::beta_reg;

use crate::stats::CONFIDENCE;

/// Returns the distance, in standard errors, from the centre of a normal interval to either end.
pub fn normal_reach() -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * CONFIDENCE)
}

/// Returns the same distance for Student's t, of a positive number of degrees of freedom that need not be whole.
pub fn t_reach(degrees: f64) -> f64 {
    let t = students_t(degrees);
    let rough = t.inverse_cdf(0.5 + 0.5 * CONFIDENCE);
    // One step of Newton's method: with many degrees of freedom the quantile has six digits, its probability more.
    rough + (t.sf(rough) - 0.5 * (1.0 - CONFIDENCE)) / t.pdf(rough)
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

/// Returns the probability that Fisher's F with these positive degrees of freedom, which need not be whole, is at least
/// `f`.
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
        // `scipy.stats.binom.cdf(k, n, p)`
        for (hits, trials, rate, expected) in BINOMIAL {
            assert_close(binomial_at_most(hits, trials, rate), expected);
        }
    }
}
