//! Places spread over the intact bushes, so that one is near wherever a fire begins next.
//!
//! Lloyd's iteration ("Least squares quantization in PCM", IEEE Trans. Information Theory 28(2), 1982) moves every site to
//! the centroid of the bushes to which it is the nearest, again and again; for vehicles see Cortes, Martinez, Karatas and
//! Bullo, "Coverage control for mobile sensing networks" (IEEE Trans. Robotics and Automation 20(2), 2004). Bushes are taken
//! together in blocks, so that a field of 400,000 costs what one of a thousand does.

use std::collections::BTreeMap;

use glam::DVec2;

use super::super::team::Team;
use wildfire_base::time::SimTime;

/// Blocks a side of the field at most.
const BLOCKS: f64 = 32.0;
/// Bushes are counted again after this time at the earliest: in so few seconds centroids hardly move.
const COUNT_EVERY: SimTime = SimTime::from_nanos(20_000_000_000);
const MAX_ROUNDS: usize = 50;
/// Sites that move no farther than this have come to rest.
const REST_M: f64 = 1.0;

/// The intact bushes of a part of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BushBlock {
    /// The mean of their positions.
    pub place: DVec2,
    /// The number of bushes.
    pub bushes: f64,
}

/// The intact bushes in blocks, counted at intervals.
#[derive(Clone, Debug, Default)]
pub struct BushDensity {
    counted: Option<(SimTime, Vec<BushBlock>)>,
}

impl BushDensity {
    /// Returns the blocks with intact bushes, as of the last count.
    pub fn blocks(&mut self, team: &Team<'_>) -> &[BushBlock] {
        let is_old = self.counted.as_ref().is_none_or(|(at, _)| team.now >= *at + COUNT_EVERY);
        if is_old {
            self.counted = Some((team.now, count(team)));
        }
        self.counted.as_ref().map_or(&[], |(_, blocks)| blocks)
    }
}

/// Counts the intact bushes by block, row by row.
fn count(team: &Team<'_>) -> Vec<BushBlock> {
    let block_m = team.frame.cell_m.max(team.frame.width_m().max(team.frame.height_m()) / BLOCKS);
    let mut sums: BTreeMap<(u32, u32), (DVec2, f64)> = BTreeMap::new();
    for &cell in team.intact.bushes().iter().filter(|&&cell| team.intact.is_intact(cell)) {
        let place = team.frame.centre(cell);
        let block = ((place.y / block_m).floor() as u32, (place.x / block_m).floor() as u32);
        let (sum, bushes) = sums.entry(block).or_insert((DVec2::ZERO, 0.0));
        (*sum, *bushes) = (*sum + place, *bushes + 1.0);
    }
    sums.into_values().map(|(sum, bushes)| BushBlock { place: sum / bushes, bushes }).collect()
}

/// Moves sites until each is at the centroid of the blocks to which it is nearest; ties go to the first site. A site
/// that is nearest to no block moves to the worst-served block; without blocks all sites stay.
pub fn spread_out(blocks: &[BushBlock], sites: &mut [DVec2]) {
    if sites.is_empty() || blocks.is_empty() {
        return;
    }
    for _ in 0..MAX_ROUNDS {
        let mut sums = vec![(DVec2::ZERO, 0.0); sites.len()];
        let mut worst_first: Vec<(f64, usize)> = Vec::with_capacity(blocks.len());
        for (number, block) in blocks.iter().enumerate() {
            let (site, squared) = nearest(sites, block.place);
            sums[site].0 += block.bushes * block.place;
            sums[site].1 += block.bushes;
            // Bushes times squared distance: what Lloyd's iteration makes smaller.
            worst_first.push((block.bushes * squared, number));
        }
        // Ties by number, so that runs are reproducible.
        worst_first.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut worst = worst_first.into_iter().map(|(_, number)| blocks[number].place);
        let mut farthest_m: f64 = 0.0;
        for (site, (sum, bushes)) in sites.iter_mut().zip(sums) {
            // Two trucks side by side share a site's bushes; one of them would otherwise never get any.
            let to = if bushes > 0.0 { sum / bushes } else { worst.next().unwrap_or(*site) };
            farthest_m = farthest_m.max((to - *site).length());
            *site = to;
        }
        if farthest_m <= REST_M {
            break;
        }
    }
}

/// The nearest site and the square of its distance.
fn nearest(sites: &[DVec2], place: DVec2) -> (usize, f64) {
    let squared = sites.iter().map(|&site| (site - place).length_squared()).enumerate();
    squared.min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are sites")
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    fn cost(blocks: &[BushBlock], sites: &[DVec2]) -> f64 {
        blocks.iter().map(|block| block.bushes * nearest(sites, block.place).1).sum()
    }

    fn random_blocks(seed: u64) -> Vec<BushBlock> {
        let mut rng = rng::stream(seed, "blocks");
        let mut place = || DVec2::new(rng.random_range(0.0..500.0), rng.random_range(0.0..500.0));
        let places: Vec<DVec2> = (0..80).map(|_| place()).collect();
        places
            .into_iter()
            .zip(0..)
            .map(|(place, number)| BushBlock { place, bushes: f64::from(1 + number % 7) })
            .collect()
    }

    #[test]
    fn sites_that_spread_out_are_centroids_and_nearer_to_the_bushes_than_before() {
        for seed in 0..20 {
            let blocks = random_blocks(seed);
            for count in [1, 2, 5, 9] {
                // All trucks begin side by side.
                let start: Vec<DVec2> = (0..count).map(|_| DVec2::new(20.0, 20.0)).collect();
                let mut sites = start.clone();
                spread_out(&blocks, &mut sites);
                assert!(cost(&blocks, &sites) < cost(&blocks, &start), "seed {seed}, {count} sites");
                for (number, site) in sites.iter().enumerate() {
                    let nearby = blocks.iter().filter(|block| nearest(&sites, block.place).0 == number);
                    let (sum, bushes) = nearby.fold((DVec2::ZERO, 0.0), |(sum, all), block| {
                        (sum + block.bushes * block.place, all + block.bushes)
                    });
                    assert!(bushes > 0.0, "seed {seed}: every site has bushes of its own");
                    assert!((sum / bushes - *site).length() < 25.0, "seed {seed}, {count} sites: {site}");
                }
            }
        }
    }

    #[test]
    fn one_site_goes_to_the_mean_of_all_bushes() {
        let blocks = random_blocks(3);
        let mut sites = [DVec2::ZERO];
        spread_out(&blocks, &mut sites);
        let bushes: f64 = blocks.iter().map(|block| block.bushes).sum();
        let mean = blocks.iter().map(|block| block.bushes * block.place).sum::<DVec2>() / bushes;
        assert!((sites[0] - mean).length() < 1e-9);
    }
}
