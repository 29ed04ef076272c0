//! A map, what was asked of it, and what came of that.

use std::path::Path;
use std::time::Duration;

use crate::cli::map::args::Computation;
use crate::cli::map::compute::Computed;
use crate::cli::map::walk::Walk;
use crate::grid::Place;
use crate::map_files::MapFile;

/// The contents of all outputs of a command.
pub struct MapReport<'a> {
    pub computation: &'a Computation,
    pub path: &'a Path,
    pub map: &'a MapFile,
    pub computed: &'a Computed,
    pub occupied_cells: usize,
    pub cpu_read: Duration,
}

impl<'a> MapReport<'a> {
    pub fn new(computation: &'a Computation, map: &'a MapFile, computed: &'a Computed, cpu_read: Duration) -> Self {
        let occupied_cells = map.occupied.values().iter().filter(|&&occupied| occupied).count();
        Self { computation, path: &computation.files().input.map, map, computed, occupied_cells, cpu_read }
    }

    pub fn cells(&self) -> usize {
        self.map.occupied.values().len()
    }

    /// The grey value up to which pixels are occupied, of an image.
    pub fn tolerance(&self) -> Option<u8> {
        self.map.grey.as_ref().map(|_| self.computation.files().input.reading.tolerance())
    }

    /// Share of the pixels that are near the tolerance, of an image.
    pub fn near_tolerance(&self) -> Option<f64> {
        self.map.share_near(self.computation.files().input.reading.tolerance())
    }

    /// The cells of the way; `None` if there is no way or no start.
    pub fn way(&self) -> Option<&[Place]> {
        self.computed.walk.as_ref().map(|walk| walk.way.cells.as_slice()).filter(|cells| !cells.is_empty())
    }

    /// Lists notes on the map, and the result of the walk.
    pub fn sentences(&self) -> Vec<String> {
        let notes = self.map.notes.iter().map(|note| format!("{}: {note}.", self.path.display()));
        let walk = self.computed.walk.as_ref().map(Walk::sentence);
        notes.chain(self.oddities()).chain(walk).collect()
    }

    /// Lists what is odd about the map or the question.
    fn oddities(&self) -> Vec<String> {
        let mut oddities = self.map.doubts(self.computation.files().input.reading.tolerance());
        if self.occupied_cells == 0 {
            oddities.push("No obstacle: no cell of the map is occupied.".to_owned());
        }
        if self.occupied_cells == self.cells() {
            oddities.push("No free cell: every cell of the map is occupied.".to_owned());
        }
        if let Some(goal) = self.computed.goal.filter(|&goal| self.map.occupied[goal]) {
            oddities.push(format!("The goal, row {}, column {}, lies in an obstacle.", goal.0, goal.1));
        }
        if self.computation.files().input.reading.tolerance.is_some() && self.map.grey.is_none() {
            oddities.push("--tolerance has no effect: the map is no image.".to_owned());
        }
        oddities
    }
}
