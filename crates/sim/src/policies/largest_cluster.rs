//! The policy of the largest cluster of fires.

use super::{AgentView, Observation, Rule};
use wildfire_base::geometry::Cell;
use wildfire_fire::FireField;

/// Chooses the nearest cell of the largest cluster of burning cells, also among clusters of equal size.
#[derive(Clone, Copy, Debug)]
pub struct LargestCluster;

impl Rule for LargestCluster {
    fn best(&mut self, seen: &Observation<'_>, agent: &AgentView, options: &[Cell]) -> Option<Cell> {
        let sizes = cluster_sizes(seen.fires);
        let size = |cell: &Cell| sizes[seen.fires.frame().index(*cell)];
        let nearest = seen.fires.frame().by_distance(agent.place);
        options.iter().copied().min_by(|a, b| size(b).cmp(&size(a)).then_with(|| nearest(a, b)))
    }
}

/// Counts, by cell index, the burning cells that are connected to a burning cell over sides and corners.
pub fn cluster_sizes(fires: &FireField) -> Vec<u32> {
    let frame = fires.frame();
    let mut sizes = vec![0; frame.cell_count()];
    for seed in fires.burning() {
        if sizes[frame.index(seed)] != 0 {
            continue;
        }
        // A flood from the first cell of a cluster; it is marked with 1 until its size is known.
        let mut cluster = vec![seed];
        sizes[frame.index(seed)] = 1;
        let mut next = 0;
        while let Some(&cell) = cluster.get(next) {
            next += 1;
            for (cols, rows) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                let Some(other) = frame.offset(cell, cols, rows) else { continue };
                if fires.is_burning(other) && sizes[frame.index(other)] == 0 {
                    sizes[frame.index(other)] = 1;
                    cluster.push(other);
                }
            }
        }
        for cell in &cluster {
            sizes[frame.index(*cell)] = cluster.len() as u32;
        }
    }
    sizes
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::FieldFrame;
    use wildfire_base::time::SimTime;

    #[test]
    fn cells_that_touch_at_a_corner_are_one_cluster() {
        let frame = FieldFrame { cols: 6, rows: 3, cell_m: 5.0 };
        let cells = [(0, 0), (1, 1), (2, 1), (4, 0), (5, 2)].map(|(col, row)| Cell { col, row });
        let mut fires = FireField::new(frame, &cells, false);
        for cell in cells {
            fires.ignite(cell, SimTime::ZERO, true);
        }
        let sizes = cluster_sizes(&fires);
        assert_eq!(cells.map(|cell| sizes[frame.index(cell)]), [3, 3, 3, 1, 1]);
    }
}
