//! Safety costs: a metre near bushes costs more than one far from them.
//!
//! A metre at a place costs `1 + weight * s`, where `s` in [0, 1] says how near the next bush is: 1 beside it or in it,
//! 0 far away. `s` belongs to cells of the field; what lies outside the field, and its border, is no bush. Where the ground
//! slows a truck to a share of its speed, a metre costs `1/share - 1` more.

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::ClearanceField;
use wildfire_base::geometry::FieldFrame;
use wildfire_base::ranges;
use wildfire_base::trajectory::GroundSpeed;
use wildfire_grid::brushfire::brushfire;
use wildfire_grid::cost_map::{Form, TwoZones, cost_map};
use wildfire_grid::{Connectivity, Grid};

/// Along lines and motions `s` is read in the middle of equal pieces, no longer than this share of a cell's side.
const PIECE: f64 = 0.5;
/// But in no more pieces than this.
const MAX_PIECES: f64 = 200.0;

/// The map that says how near bushes are, and its weight.
///
/// The zones of the map `cost` are those of [`TwoZones`]; only their ratios to `max_cost` matter. Their defaults are
/// made for cells of 5 m: on a tenth of bushes hardly a cell is farther than six from one, so that the 12 cells of a
/// pixel map would make all places nearly alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SafetySettings {
    pub map: SafetyMap,
    pub weight: f64,
    pub form: SafetyForm,
    pub max_cost: f64,
    pub safety_max: f64,
    pub safety_min: f64,
    /// Cells.
    pub safety_distance: u16,
    /// Loss for each cell beyond the safety distance.
    pub cost_rate: f64,
}

impl Default for SafetySettings {
    fn default() -> Self {
        Self {
            map: SafetyMap::None,
            weight: 1.0,
            form: SafetyForm::Continuous,
            max_cost: 1000.0,
            safety_max: 800.0,
            safety_min: 500.0,
            safety_distance: 2,
            cost_rate: 125.0,
        }
    }
}

/// The source of `s`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SafetyMap {
    /// All places cost the same.
    None,
    /// 1/D, with D cells to the nearest bush, diagonal ones too.
    Brushfire,
    /// The two-zone cost over its maximum, by cells to the nearest bush along rows and columns.
    Cost,
}

/// The place where the outer zone of the map `cost` begins to fall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SafetyForm {
    Literal,
    Continuous,
}

ranges! { SafetySettings {
    weight: 0.0..=1000.0, max_cost: 0.001..=1e6, safety_distance: 1.0..=1000.0, cost_rate: 0.0..=1e6,
} and |settings, _| {
    ranges::check_range("safety_max", settings.safety_max, 0.0..=settings.max_cost)?;
    ranges::check_range("safety_min", settings.safety_min, 0.0..=settings.safety_max)
} }

impl SafetySettings {
    /// Returns `s` of the map `cost` at this number of cells from the nearest bush.
    pub fn nearness(&self, cells: u16) -> f64 {
        self.zones().cost(cells) / self.max_cost
    }

    fn zones(&self) -> TwoZones {
        TwoZones {
            form: match self.form {
                SafetyForm::Literal => Form::Literal,
                SafetyForm::Continuous => Form::Continuous,
            },
            max_cost: self.max_cost,
            safety_max: self.safety_max,
            safety_min: self.safety_min,
            safety_distance: self.safety_distance,
            cost_rate: self.cost_rate,
        }
    }
}

/// The costs of places on one field.
#[derive(Clone, Debug)]
pub struct Safety {
    frame: FieldFrame,
    /// `weight * s` by cell, row 0 at the south edge, and what slow ground costs.
    surcharge: Grid<f64>,
    pub prices_ground: bool,
}

impl Safety {
    /// Adds the time that slow ground costs to the costs of a safety map, in metres at full speed. `None` where all places
    /// cost the same.
    pub fn on_ground(safety: Option<Self>, field: &ClearanceField, ground: Option<&GroundSpeed>) -> Option<Self> {
        let Some(ground) = ground else { return safety };
        let frame = *field.frame();
        let mut surcharge =
            safety.map_or_else(|| Grid::filled(frame.rows.into(), frame.cols.into(), 0.0), |safety| safety.surcharge);
        surcharge.values_mut().iter_mut().enumerate().for_each(|(cell, cost)| *cost += 1.0 / ground.share(cell) - 1.0);
        Some(Self { frame, surcharge, prices_ground: true })
    }

    /// `None` where all places cost the same: without a map, without weight or without bushes.
    pub fn new(frame: FieldFrame, occupied: &Grid<bool>, settings: &SafetySettings) -> Option<Self> {
        let nearness = match settings.map {
            _ if settings.weight == 0.0 => return None,
            SafetyMap::None => return None,
            SafetyMap::Brushfire => {
                let values = brushfire(occupied, Connectivity::Eight)?;
                // A bush has the value 1 and cells beside it 2: both count as beside.
                let near = values.values().iter().map(|&value| 1.0 / f64::from(value - 1).max(1.0)).collect();
                Grid::from_values(values.rows(), values.cols(), near)
            }
            SafetyMap::Cost => {
                let mut costs = cost_map(&brushfire(occupied, Connectivity::Four)?, &settings.zones());
                costs.values_mut().iter_mut().for_each(|cost| *cost /= settings.max_cost);
                costs
            }
        };
        let mut surcharge = nearness;
        surcharge.values_mut().iter_mut().for_each(|near| *near *= settings.weight);
        Some(Self { frame, surcharge, prices_ground: false })
    }

    /// Returns what a metre at this place costs more than 1; outside the field nothing.
    pub fn surcharge_at(&self, place: DVec2) -> f64 {
        let cell = self.frame.cell_at(place);
        cell.map_or(0.0, |cell| self.surcharge[(cell.row.into(), cell.col.into())])
    }

    /// Returns what a way of this length costs more than that; `at` gives the place after a share of it.
    pub fn surcharge_along(&self, length_m: f64, at: impl Fn(f64) -> DVec2) -> f64 {
        let pieces = (length_m / (PIECE * self.frame.cell_m)).ceil().clamp(1.0, MAX_PIECES);
        let sum: f64 = (0..pieces as u32).map(|k| self.surcharge_at(at((f64::from(k) + 0.5) / pieces))).sum();
        length_m * sum / pieces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: FieldFrame = FieldFrame { cols: 12, rows: 3, cell_m: 5.0 };

    /// A bush in the middle of the west edge.
    fn safety(settings: &SafetySettings) -> Option<Safety> {
        let mut occupied = Grid::filled(3, 12, false);
        occupied[(1, 0)] = true;
        Safety::new(FRAME, &occupied, settings)
    }

    fn in_row(safety: &Safety, row: f64) -> Vec<f64> {
        (0..12).map(|col| safety.surcharge_at(DVec2::new(5.0 * f64::from(col) + 2.5, 5.0 * row + 2.5))).collect()
    }

    #[test]
    fn brushfire_counts_one_over_the_cells_to_the_nearest_bush() {
        let settings = SafetySettings { map: SafetyMap::Brushfire, weight: 2.0, ..SafetySettings::default() };
        let safety = safety(&settings).expect("there is a bush");
        let expected: Vec<f64> = (0..12).map(|col| 2.0 / f64::from(col).max(1.0)).collect();
        assert_eq!(in_row(&safety, 1.0), expected);
        assert_eq!(in_row(&safety, 2.0), expected, "diagonal neighbours are as near");
    }

    #[test]
    fn the_cost_map_counts_by_its_share_of_the_maximum() {
        let settings = SafetySettings { map: SafetyMap::Cost, weight: 10.0, ..SafetySettings::default() };
        let safety = safety(&settings).expect("there is a bush");
        let expected = [10.0, 6.5, 5.0, 3.75, 2.5, 1.25, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(in_row(&safety, 1.0), expected);
        assert_eq!(in_row(&safety, 0.0)[..11], expected[1..]);
        assert_eq!(safety.surcharge_at(DVec2::new(-1.0, 7.0)), 0.0);
    }

    #[test]
    fn without_a_map_a_weight_or_a_bush_there_is_no_safety() {
        let settings = SafetySettings { map: SafetyMap::Brushfire, ..SafetySettings::default() };
        assert!(safety(&SafetySettings::default()).is_none());
        assert!(safety(&SafetySettings { weight: 0.0, ..settings.clone() }).is_none());
        assert!(Safety::new(FRAME, &Grid::filled(3, 12, false), &settings).is_none());
    }

    #[test]
    fn a_way_costs_what_its_pieces_cost() {
        let settings = SafetySettings { map: SafetyMap::Brushfire, ..SafetySettings::default() };
        let safety = safety(&settings).expect("there is a bush");
        let from = DVec2::new(5.0, 7.5);
        let to = DVec2::new(25.0, 7.5);
        let cost = safety.surcharge_along(20.0, |share| from.lerp(to, share));
        assert!((cost - 5.0 * (1.0 + 1.0 / 2.0 + 1.0 / 3.0 + 1.0 / 4.0)).abs() < 1e-9, "{cost}");
        assert_eq!(safety.surcharge_along(0.0, |_| from), 0.0);
    }
}
