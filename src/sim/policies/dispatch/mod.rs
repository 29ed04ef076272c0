//! Policies for a whole team of trucks: who goes to which fire, and where those wait who go to none.

mod auction;
mod hungarian;
mod idle;
#[cfg(test)]
mod model;
mod nearest_savable;
mod open_fires;
mod place_index;
#[cfg(test)]
mod samples;
mod team;
mod threat;
mod threat_first;

pub use auction::Auction;
pub use hungarian::Hungarian;
pub use idle::{Centroids, Regions, RegionsFirst, Stay};
pub use nearest_savable::NearestSavable;
pub use team::{Assignment, Fire, Intact, Positioning, Team, TeamRules, TeamTruck, WAY_FACTOR};
pub use threat_first::ThreatFirst;

#[cfg(test)]
mod lab {
    use super::*;
    use super::model::*;
    fn run(name: &str, contest: Contest, seeds: u64, make: impl Fn() -> (Box<dyn Assignment>, Box<dyn Positioning>)) -> f64 {
        let t = std::time::Instant::now();
        let (mut lost, mut wasted, mut dec, mut km) = (0.0, 0, 0, 0.0);
        for seed in 1..=seeds {
            let (mut a, mut p) = make();
            let s = play(contest, seed, &mut *a, &mut *p);
            lost += s.lost / seeds as f64; wasted += s.wasted; dec += s.decisions; km += s.driven_m / 1000.0;
        }
        println!("{name:28} lost {lost:6.1} wasted {:5} km {:6.1} dec {} ms/run {:.1}", wasted / seeds as u32, km / seeds as f64, dec / seeds as u32, t.elapsed().as_secs_f64()*1e3/seeds as f64);
        lost
    }
    #[test]
    fn table() {
        let seeds = std::env::var("SEEDS").ok().and_then(|s| s.parse().ok()).unwrap_or(20);
        for (trucks, wumpuses, field_m) in [(2, 1, 500.0), (4, 2, 500.0), (8, 4, 500.0)] {
            let c = Contest { field_m, trucks, wumpuses };
            println!("{c:?}");
            run("nearest", c, seeds, || (Box::new(Nearest), Box::new(Stay)));
            run("nearest-savable", c, seeds, || (Box::new(NearestSavable), Box::new(Stay)));
            run("hungarian", c, seeds, || (Box::new(Hungarian), Box::new(Stay)));
            run("threat-first", c, seeds, || (Box::new(ThreatFirst), Box::new(Stay)));
            run("regions", c, seeds, || (Box::new(RegionsFirst(Box::new(NearestSavable))), Box::new(Regions::default())));
            run("auction", c, seeds, || (Box::new(Auction), Box::new(Stay)));
            run("nearest+centroids", c, seeds, || (Box::new(Nearest), Box::new(Centroids::default())));
            run("threat+centroids", c, seeds, || (Box::new(ThreatFirst), Box::new(Centroids::default())));
            run("auction+centroids", c, seeds, || (Box::new(Auction), Box::new(Centroids::default())));
            run("auction+regions", c, seeds, || (Box::new(Auction), Box::new(Regions::default())));
        }
    }
}
