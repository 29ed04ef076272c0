//! The assignment of least total cost, by the Hungarian method.
//!
//! Every free truck gets at most one fire, every fire at most one truck, so that the sum over all is least: the seconds
//! until each fire is out, and for each fire that is left, what is lost with it. So as much as possible is saved first, and
//! of the ways to save that much the fastest is taken. The algorithm is that of Kuhn (1955) and Munkres (1957) by shortest
//! augmenting paths (Jonker and Volgenant, "A shortest augmenting path algorithm for dense and sparse linear assignment
//! problems", Computing 38, 1987), in O(rows squared times columns).

use super::open_fires::OpenFires;
use super::team::{Assignment, Team};
use super::threat::threats;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_timeline::AgentId;

/// A bush that is lost costs as much as this many seconds of a truck: more than any assignment takes, so that a bush is
/// never left for the sake of time.
const BUSH_S: f64 = 1e6;

/// Assigns fires to all free trucks at the least total cost.
#[derive(Clone, Copy, Debug)]
pub struct Hungarian;

impl Assignment for Hungarian {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        let open = OpenFires::new(team);
        let queried: Vec<usize> = (0..team.trucks.len()).filter(|&truck| team.trucks[truck].is_queried).collect();
        let threats = threats(team, &open.fires);
        let mut rows: Vec<Vec<(f64, usize)>> = Vec::new();
        for &truck in &queried {
            let prospects = (0..open.fires.len()).filter_map(|fire| open.prospect(&team.trucks[truck], fire));
            let cost = |out_at: SimTime, fire: usize| {
                // In seconds: a bush that is saved is worth some of them.
                (out_at - team.now).as_seconds() - BUSH_S * f64::from(bushes_saved(&open, &threats, fire, out_at))
            };
            let mut row: Vec<_> = prospects.map(|p| (cost(p.out_at, p.fire), p.fire)).collect();
            *effort += open.fires.len() as u64;
            // As many as there are trucks will do: one of a truck's cheapest is always left by the others.
            row.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            row.truncate(queried.len());
            rows.push(row);
        }
        // Only fires that some truck would take: the method's effort grows with the columns.
        let mut columns: Vec<usize> = rows.iter().flatten().map(|&(_, fire)| fire).collect();
        columns.sort_unstable();
        columns.dedup();
        // Behind the fires each truck has a column of its own: it stays where it is, at no cost.
        let width = columns.len() + queried.len();
        let mut costs = vec![f64::INFINITY; queried.len() * width];
        for (number, row) in rows.iter().enumerate() {
            for &(cost, fire) in row {
                let column = columns.binary_search(&fire).expect("the columns are those of all rows");
                costs[number * width + column] = cost;
            }
            costs[number * width + columns.len() + number] = 0.0;
        }
        let columns_of = min_total(queried.len(), width, |row, column| costs[row * width + column]);
        let goals = columns_of.iter().enumerate().filter_map(|(row, &column)| Some((row, *columns.get(column)?)));
        goals.map(|(row, fire)| (team.trucks[queried[row]].id, open.fires[fire].cell)).collect()
    }

    fn replans(&self) -> bool {
        false
    }
}

/// Counts the bushes that are saved if a fire is extinguished in time: its own, and those that it threatens unless it
/// has ignited them before.
pub fn bushes_saved(open: &OpenFires<'_>, threats: &[u32], fire: usize, out_at: SimTime) -> u32 {
    1 + if out_at <= open.fires[fire].spreads_at { threats[fire] } else { 0 }
}

/// Assigns each row a column of its own at the least total cost, and returns the columns by row. There must be at least
/// as many columns as rows, and a choice of finite costs. Rows are added one by one, and of columns at equal cost the
/// first is preferred, so ties are always broken alike.
pub fn min_total(rows: usize, columns: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    // Rows and columns count from 1: column 0 stands for the row that comes in, row 0 for nobody.
    let mut row_price = vec![0.0; rows + 1];
    let mut column_price = vec![0.0; columns + 1];
    let mut row_of = vec![0; columns + 1];
    for incoming in 1..=rows {
        // Dijkstra's search over columns, by costs less prices, which never are negative; it ends at a free column.
        let mut min = vec![f64::INFINITY; columns + 1];
        let mut before = vec![0; columns + 1];
        let mut is_done = vec![false; columns + 1];
        row_of[0] = incoming;
        let mut column = 0;
        while row_of[column] != 0 {
            is_done[column] = true;
            let row = row_of[column];
            let (mut step, mut next) = (f64::INFINITY, 0);
            for other in (1..=columns).filter(|&other| !is_done[other]) {
                let reduced = cost(row - 1, other - 1) - row_price[row] - column_price[other];
                if reduced < min[other] {
                    (min[other], before[other]) = (reduced, column);
                }
                if min[other] < step {
                    (step, next) = (min[other], other);
                }
            }
            assert!(next != 0, "every row can have a column at a finite cost");
            // Prices move so that what was searched stays tight and nothing else becomes negative.
            for other in 0..=columns {
                if is_done[other] {
                    row_price[row_of[other]] += step;
                    column_price[other] -= step;
                } else {
                    min[other] -= step;
                }
            }
            column = next;
        }
        // Along the path back each column passes to the row before it.
        while column != 0 {
            row_of[column] = row_of[before[column]];
            column = before[column];
        }
    }
    let mut columns_of = vec![0; rows];
    for column in (1..=columns).filter(|&column| row_of[column] != 0) {
        columns_of[row_of[column] - 1] = column - 1;
    }
    columns_of
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::samples::Sample;
    use super::*;
    use wildfire_base::rng;

    /// The least sum over all ways to give rows columns of their own.
    fn brute_force(row: usize, used: u32, table: &[Vec<f64>]) -> f64 {
        let Some(costs) = table.get(row) else { return 0.0 };
        let free = (0..costs.len()).filter(|column| used & (1 << column) == 0);
        free.map(|column| costs[column] + brute_force(row + 1, used | (1 << column), table))
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_total_is_the_least_of_all_permutations() {
        let mut rng = rng::stream(1, "assignment");
        for _ in 0..400 {
            let rows = rng.random_range(1..6);
            let columns = rng.random_range(rows..8);
            // Small whole numbers make ties, and one in five pairs is impossible but on the diagonal.
            let mut cost = |row, column| match rng.random_range(0..5) {
                0 if row != column => f64::INFINITY,
                _ => f64::from(rng.random_range(-4..12)),
            };
            let table: Vec<Vec<f64>> = (0..rows).map(|row| (0..columns).map(|c| cost(row, c)).collect()).collect();
            let columns_of = min_total(rows, columns, |row, column| table[row][column]);
            let mut distinct = columns_of.clone();
            distinct.sort_unstable();
            distinct.dedup();
            assert_eq!(distinct.len(), rows, "each row has a column of its own");
            let total: f64 = columns_of.iter().enumerate().map(|(row, &column)| table[row][column]).sum();
            assert_eq!(total, brute_force(0, 0, &table), "{table:?}");
        }
    }

    /// Bushes saved, and seconds, of the best assignment, by trying all.
    fn best(open: &OpenFires<'_>, threats: &[u32], trucks: &[usize], taken: u64) -> (i64, f64) {
        let Some((&truck, others)) = trucks.split_first() else { return (0, 0.0) };
        let mut best_of_all = best(open, threats, others, taken);
        for fire in (0..open.fires.len()).filter(|fire| taken & (1 << fire) == 0) {
            let Some(prospect) = open.prospect(&open.team.trucks[truck], fire) else { continue };
            let (saved, seconds) = best(open, threats, others, taken | (1 << fire));
            let saved = saved + i64::from(bushes_saved(open, threats, fire, prospect.out_at));
            let seconds = seconds + (prospect.out_at - open.team.now).as_seconds();
            if saved > best_of_all.0 || (saved == best_of_all.0 && seconds < best_of_all.1) {
                best_of_all = (saved, seconds);
            }
        }
        best_of_all
    }

    #[test]
    fn no_other_assignment_saves_more_or_as_much_sooner() {
        for seed in 0..40 {
            let sample = Sample::small(seed);
            let team = sample.team();
            let open = OpenFires::new(&team);
            let threats = threats(&team, &open.fires);
            let goals = Hungarian.assign(&team, &mut 0);
            sample.assert_sound(&goals);
            let (mut saved, mut seconds) = (0, 0.0);
            for (id, cell) in goals {
                let fire = open.fires.iter().position(|fire| fire.cell == cell).expect("it is open");
                let truck = &team.trucks[usize::from(id.number)];
                let out_at = open.prospect(truck, fire).expect("it is savable").out_at;
                saved += i64::from(bushes_saved(&open, &threats, fire, out_at));
                seconds += (out_at - team.now).as_seconds();
            }
            let queried: Vec<usize> = team.queried().map(|truck| usize::from(truck.id.number)).collect();
            let (max, min_s) = best(&open, &threats, &queried, 0);
            assert_eq!(saved, max, "seed {seed}");
            assert!((seconds - min_s).abs() < 1e-6, "seed {seed}: {seconds} s, {min_s} s would do");
        }
    }
}
