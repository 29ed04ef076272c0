//! Survival analysis: times until an event, some of them censored.

use crate::stats::Interval;
use crate::stats::distributions::normal_reach;
use wildfire_base::geometry::ops;

/// A non-negative time: until the event, or until the observation ended without it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lifetime {
    pub time: f64,
    /// True if the observation ended before the event.
    pub is_cut_off: bool,
}

/// A step of the curve: the survival from this time to the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurvivalStep {
    pub time: f64,
    /// The number of lifetimes of at least this time.
    pub at_risk: u64,
    /// The number of events at this time.
    pub events: u64,
    /// The estimated probability that the event comes later than this.
    pub survival: f64,
    /// The interval; `None` where nothing survives.
    pub interval: Option<Interval>,
}

/// The product-limit estimate of the distribution of partly censored times.
///
/// Kaplan, Meier, "Nonparametric estimation from incomplete observations", JASA 53, 1958. Intervals are pointwise: from
/// Greenwood's variance, symmetric for ln(-ln(survival)), so that they stay within 0 to 1 (Kalbfleisch, Prentice, "The
/// statistical analysis of failure time data", 2002, section 1.4). What is cut off at the time of an event counts as at
/// risk of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SurvivalCurve {
    /// The steps, one for every time with an event, ascending.
    pub steps: Vec<SurvivalStep>,
}

impl SurvivalCurve {
    pub fn from_lifetimes(lifetimes: &[Lifetime]) -> Self {
        let mut sorted = lifetimes.to_vec();
        sorted.sort_by(|a, b| a.time.total_cmp(&b.time));
        let mut at_risk = sorted.len() as u64;
        let mut survival = 1.0;
        let mut variance = 0.0;
        let mut steps = Vec::new();
        for together in sorted.chunk_by(|a, b| a.time == b.time) {
            let events = together.iter().filter(|lifetime| !lifetime.is_cut_off).count() as u64;
            if events > 0 {
                let (n, d) = (at_risk as f64, events as f64);
                survival *= (n - d) / n;
                variance += d / (n * (n - d));
                let interval = log_log_interval(survival, variance);
                steps.push(SurvivalStep { time: together[0].time, at_risk, events, survival, interval });
            }
            // They leave only after the step: what is censored at the time of an event was still at risk of it.
            at_risk -= together.len() as u64;
        }
        Self { steps }
    }

    /// Returns the estimated probability that the event comes later than `time`. Beyond the last time it stays at the
    /// last value.
    pub fn at(&self, time: f64) -> f64 {
        let passed = self.steps.partition_point(|step| step.time <= time);
        passed.checked_sub(1).map_or(1.0, |last| self.steps[last].survival)
    }

    /// Returns the first time by which at least half have had the event; `None` if fewer ever do.
    pub fn median(&self) -> Option<f64> {
        self.first_time_where(|step| step.survival <= 0.5)
    }

    /// Returns the interval of the median: the times at which the curve's interval contains one half. A censored end is
    /// `None`.
    ///
    /// Brookmeyer, Crowley, "A confidence interval for the median survival time", Biometrics 38, 1982.
    pub fn median_interval(&self) -> [Option<f64>; 2] {
        let low = self.first_time_where(|step| step.interval.is_none_or(|interval| interval.low <= 0.5));
        let high = self.first_time_where(|step| step.interval.is_some_and(|interval| interval.high <= 0.5));
        [low, high]
    }

    fn first_time_where(&self, holds: impl Fn(&SurvivalStep) -> bool) -> Option<f64> {
        self.steps.iter().find(|step| holds(step)).map(|step| step.time)
    }
}

/// `variance` is Greenwood's sum, that of ln(survival).
fn log_log_interval(survival: f64, variance: f64) -> Option<Interval> {
    if survival <= 0.0 {
        return None;
    }
    let log = ops::ln(survival);
    let reach = normal_reach() * variance.sqrt() / log.abs();
    Some(Interval { low: ops::exp(log * ops::exp(reach)), high: ops::exp(log * ops::exp(-reach)) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::{assert_close, assert_interval};

    const SURVIVAL: [(f64, f64, f64, f64); 7] = [
        (6.0, 0.8571428571428571, 0.6197179552659838, 0.951551747646997),
        (7.0, 0.8067226890756302, 0.5631465646222333, 0.9228090192028804),
        (10.0, 0.7529411764705881, 0.5031995107999564, 0.8893618351692655),
        (13.0, 0.6901960784313724, 0.43161022248618397, 0.8490659633494507),
        (16.0, 0.6274509803921567, 0.36751085598750205, 0.8049121894718412),
        (22.0, 0.53781512605042, 0.26777893676713505, 0.7467907176353944),
        (23.0, 0.4481792717086834, 0.18805200595923235, 0.6801426284952414),
    ];

    /// Remission times in weeks of the 6-MP group of Freireich et al., "The effect of 6-mercaptopurine on the duration
    /// of steroid-induced remissions in acute leukemia", Blood 21, 1963.
    const EVENTS: [f64; 9] = [6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0];
    const CUT_OFF: [f64; 12] = [6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0, 25.0, 32.0, 32.0, 34.0, 35.0];

    fn lifetimes(events: &[f64], cut_off: &[f64]) -> Vec<Lifetime> {
        let of =
            |times: &[f64], is_cut_off| times.iter().map(|&time| Lifetime { time, is_cut_off }).collect::<Vec<_>>();
        [of(events, false), of(cut_off, true)].concat()
    }

    #[test]
    fn curve_and_intervals_are_those_of_scipy() {
        let curve = SurvivalCurve::from_lifetimes(&lifetimes(&EVENTS, &CUT_OFF));
        // `e = scipy.stats.ecdf(scipy.stats.CensoredData(uncensored=events, right=cut_off)).sf`, its `quantiles`,
        // `probabilities` and `confidence_interval(0.95, method="log-log")`
        let expected = SURVIVAL;
        assert_eq!(curve.steps.len(), expected.len());
        for (step, (time, survival, low, high)) in curve.steps.iter().zip(expected) {
            assert_eq!(step.time, time);
            assert_close(step.survival, survival);
            assert_interval(step.interval, low, high);
        }
    }

    #[test]
    fn median_is_the_published_one() {
        let curve = SurvivalCurve::from_lifetimes(&lifetimes(&EVENTS, &CUT_OFF));
        assert_eq!(curve.median(), Some(23.0));
        assert_eq!(curve.median_interval(), [Some(13.0), None]);
        assert_eq!((curve.at(5.9), curve.at(1e9)), (1.0, curve.steps[6].survival));
    }

    #[test]
    fn without_cut_off_times_the_curve_counts() {
        let times: Vec<f64> = (1..=40).map(f64::from).collect();
        let curve = SurvivalCurve::from_lifetimes(&lifetimes(&times, &[]));
        for time in 0..=40 {
            assert_close(curve.at(f64::from(time)), f64::from(40 - time) / 40.0);
        }
        assert_eq!(curve.median(), Some(20.0));
        let [low, high] = curve.median_interval();
        assert!(low.is_some_and(|low| low < 20.0) && high.is_some_and(|high| high > 20.0));
        assert_eq!(curve.steps[39].interval, None);
    }

    #[test]
    fn times_that_are_all_cut_off_tell_no_median() {
        let curve = SurvivalCurve::from_lifetimes(&lifetimes(&[], &CUT_OFF));
        assert!(curve.steps.is_empty());
        assert_eq!((curve.median(), curve.at(100.0)), (None, 1.0));
        assert_eq!(SurvivalCurve::from_lifetimes(&[]).median(), None);
    }
}
