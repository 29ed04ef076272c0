//! How often intervals that promise 95 % hold the truth, and how often a batch differs from itself.
//!
//! `cargo bench --bench coverage` draws 4000 samples of each size from normal and skewed distributions and from outcomes
//! of this program's own contests, and counts. `cargo bench --bench coverage -- 500` draws as many as it is told. After
//! each percentage stands its simulation error, one standard deviation.

mod alarms;
mod classes;
mod means;
mod others;
mod outcomes;
mod rivals;
mod stopping;

use std::process::ExitCode;

use rayon::prelude::*;
use wildfire::rng::{self, Xoshiro256PlusPlus};

const REPLICATIONS: u64 = 4000;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "a benchmark prints its figures")]
fn main() -> ExitCode {
    let replications = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(REPLICATIONS);
    match outcomes::contests() {
        Ok(contests) => {
            println!("{replications} samples for each figure\n");
            println!("{}", means::coverage(&contests, replications));
            println!("{}", others::coverage(&contests, replications));
            println!("{}", alarms::rates(&contests, replications));
            println!("{}", stopping::rates(&contests, replications));
            match classes::rates() {
                Ok(text) => {
                    println!("{text}");
                    ExitCode::SUCCESS
                }
                Err(error) => {
                    eprintln!("{error}");
                    ExitCode::FAILURE
                }
            }
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// How many of `replications` independent trials count, each with a stream of its own.
fn count(replications: u64, name: &str, counts: impl Fn(&mut Xoshiro256PlusPlus) -> bool + Sync) -> u64 {
    let counted = (0..replications).into_par_iter().filter(|&trial| counts(&mut rng::stream(trial, name)));
    counted.count() as u64
}

/// A share in percent with its simulation error.
fn percent(hits: u64, trials: u64) -> String {
    let share = hits as f64 / trials as f64;
    let error = (share * (1.0 - share) / trials as f64).sqrt();
    format!("{:5.1} ±{:.1}", 100.0 * share, 100.0 * error)
}
