//! The threat of a fire: the intact bushes that it ignites if nobody extinguishes it before, and that no other fire
//! would ignite anyway. Bushes in reach of two fires are saved by extinguishing neither of them alone, so they count
//! for none.

use super::team::{Fire, Team};
use wildfire_base::geometry::Cell;

/// Pairs of a fire and a cell at most; where a radius reaches over whole fields nothing tells fires apart.
const MAX_PAIRS: usize = 1 << 22;

/// Distances between cell centres are exact multiples of the cell size; this absorbs the rounding of their product.
const RADIUS_TOLERANCE: f64 = 1e-9;

/// Counts the bushes that each of some fires of the team threatens; 0 for those that have spread. All fires of the team
/// count as others, including those that have a truck.
pub fn threats(team: &Team<'_>, fires: &[Fire]) -> Vec<u32> {
    let offsets = match team.rules.spread {
        Some((radius_m, _)) => cells_within(radius_m, team),
        None => Vec::new(),
    };
    let spreading: Vec<&Fire> = team
        .fires
        .iter()
        // At one instant fires burn out before they spread.
        .filter(|fire| fire.spreads_at > team.now && fire.spreads_at < fire.burns_out.min(team.end))
        .collect();
    if spreading.len().saturating_mul(offsets.len()) > MAX_PAIRS {
        return vec![0; fires.len()];
    }
    let mut pairs: Vec<(Cell, usize)> = (0..spreading.len())
        .flat_map(|fire| {
            let from = spreading[fire].cell;
            let cells = offsets.iter().filter_map(move |&(cols, rows)| team.frame.offset(from, cols, rows));
            cells.filter(|&cell| team.intact.is_intact(cell)).map(move |cell| (cell, fire))
        })
        .collect();
    // Sorted, so that fires that reach the same cell stand side by side.
    pairs.sort_unstable();
    let mut of_spreading = vec![0; spreading.len()];
    for same_cell in pairs.chunk_by(|one, next| one.0 == next.0) {
        // A cell in reach of two fires is saved by stopping neither of them alone.
        if let &[(_, fire)] = same_cell {
            of_spreading[fire] += 1;
        }
    }
    let index = |cell: Cell| team.frame.index(cell);
    // By cell index on both sides, so that a search by halves finds it.
    debug_assert!(spreading.is_sorted_by_key(|fire| index(fire.cell)), "a team's fires come by cell index");
    let place = |fire: &Fire| spreading.binary_search_by_key(&index(fire.cell), |other| index(other.cell)).ok();
    fires.iter().map(|fire| place(fire).map_or(0, |place| of_spreading[place])).collect()
}

/// Lists the offsets, in columns and rows, of the cells whose centres lie within a radius of a cell's centre, without
/// the cell itself and within the size of the field.
pub fn cells_within(radius_m: f64, team: &Team<'_>) -> Vec<(i32, i32)> {
    let across = radius_m / team.frame.cell_m;
    let limit = across * across * (1.0 + RADIUS_TOLERANCE);
    let cols = limit.sqrt().floor().min(f64::from(team.frame.cols) - 1.0) as i32;
    let rows = limit.sqrt().floor().min(f64::from(team.frame.rows) - 1.0) as i32;
    let all = (-rows..=rows).flat_map(|row| (-cols..=cols).map(move |col| (col, row)));
    all.filter(|&(col, row)| (col, row) != (0, 0) && f64::from(col * col + row * row) <= limit).collect()
}

#[cfg(test)]
mod tests {
    use super::super::samples::Sample;
    use super::*;

    #[test]
    fn threats_are_those_of_a_search_through_all_bushes() {
        let mut fires_that_threaten = 0;
        for seed in 0..40 {
            let sample = Sample::new(seed);
            let team = sample.team();
            let (radius_m, _) = team.rules.spread.expect("the sample spreads");
            let burns = |fire: &&Fire| fire.spreads_at > team.now && fire.spreads_at < team.due(fire);
            let expected: Vec<u32> = team
                .fires
                .iter()
                .map(|fire| {
                    let lights =
                        |by: &Fire, bush: Cell| (team.frame.centre(bush) - by.place).length() <= radius_m && burns(&by);
                    let alone = |bush: &&Cell| {
                        let others = team.fires.iter().filter(|other| other.cell != fire.cell);
                        team.intact.is_intact(**bush)
                            && lights(fire, **bush)
                            && !others.clone().any(|o| lights(o, **bush))
                    };
                    team.intact.bushes().iter().filter(alone).count() as u32
                })
                .collect();
            assert_eq!(threats(&team, &team.fires), expected, "seed {seed}");
            fires_that_threaten += expected.iter().filter(|&&count| count > 0).count();
        }
        assert!(fires_that_threaten > 20, "the samples tell fires apart");
    }
}
