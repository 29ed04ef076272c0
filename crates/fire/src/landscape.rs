//! The ground that fire runs over: a fuel model for each cell, and how steep it is there.
//!
//! World frame: x east, y north; a gradient is the rise of the ground per metre of horizontal way in these two directions
//! and points uphill. Gradients from elevations are those of Horn 1981, "Hill shading and the reflectance map": the
//! differences of three rows (columns) with weights 1, 2, 1, one-sided at the border.

use crate::fuel::{CustomFuels, FuelModel};
use crate::surface::crown::Canopy;
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};

/// What lies on the cells of a field, by cell index.
#[derive(Clone, Debug, PartialEq)]
pub struct Landscape {
    pub frame: FieldFrame,
    /// Numbers of fuel models; 0 where nothing grows.
    pub fuel: Vec<u8>,
    pub relief: Relief,
    /// Trees above the fuel on the ground, where any are given.
    pub canopy: Option<CanopyLayers>,
    /// The models of numbers that no built-in one has.
    pub custom_fuels: CustomFuels,
    /// By cell index: the factor on the rate of spread, in thousandths; empty if it is 1 everywhere.
    ///
    /// It makes fire faster or slower in all directions and changes neither its intensity nor its flames nor how long they
    /// last, as in FARSITE: there adjustment factors only modify rates of spread (FlamMap's help, "ROS adjustment file").
    pub rate_factors: Vec<u16>,
}

/// The parts of a factor on the rate of spread that are stored, and the least and the greatest factor in them.
pub const RATE_PARTS: f64 = 1000.0;
pub const RATE_FACTORS: std::ops::RangeInclusive<u16> = 1..=10_000;

/// Trees by cell index, in the units of LANDFIRE's layers CH, CBH, CBD and CC: the heights of the trees and of the
/// beginning of their crowns in tenths of metres, the bulk density of the crowns in hundredths of kg/m3, and how much of the
/// ground they cover in percent.
#[derive(Clone, Debug, PartialEq)]
pub struct CanopyLayers(pub [Vec<u16>; 4]);

impl CanopyLayers {
    /// Stored units in a metre, a kg/m3 and the whole ground.
    const UNITS: [f64; 4] = [10.0, 10.0, 100.0, 100.0];

    /// Creates the same trees everywhere; their numbers are rounded to the units.
    pub fn uniform(canopy: &Canopy, cells: usize) -> Self {
        let Canopy { height_m, base_m, bulk_density_kg_m3, cover } = *canopy;
        let mut units = Self::UNITS.into_iter();
        Self([height_m, base_m, bulk_density_kg_m3, cover].map(|number| {
            let unit = units.next().expect("there are as many");
            vec![(number * unit).round() as u16; cells]
        }))
    }

    /// Returns the trees of a cell; `None` where there are none.
    fn canopy(&self, index: usize) -> Option<Canopy> {
        let [height_m, base_m, bulk_density_kg_m3, cover] =
            [0, 1, 2, 3].map(|layer| f64::from(self.0[layer][index]) / Self::UNITS[layer]);
        (height_m > 0.0 && cover > 0.0).then_some(Canopy { height_m, base_m, bulk_density_kg_m3, cover })
    }
}

/// How steep the ground is.
#[derive(Clone, Debug, PartialEq)]
pub enum Relief {
    /// One gradient everywhere; zero is flat ground.
    Plane(DVec2),
    /// Elevations in metres by cell index.
    Elevation(Vec<f32>),
    /// Gradients by cell index, east and north.
    Gradient(Vec<[f32; 2]>),
}

impl Relief {
    /// Flat ground.
    pub const FLAT: Self = Self::Plane(DVec2::ZERO);
}

impl Landscape {
    /// Creates flat ground with one fuel everywhere.
    pub fn uniform(frame: FieldFrame, fuel: u8) -> Self {
        let fuel = vec![fuel; frame.cell_count()];
        let custom_fuels = CustomFuels::default();
        Self { frame, fuel, relief: Relief::FLAT, canopy: None, custom_fuels, rate_factors: Vec::new() }
    }

    /// Returns the factor on the rate of spread in a cell.
    #[inline]
    pub fn rate_factor(&self, index: usize) -> f64 {
        self.rate_factors.get(index).map_or(1.0, |&parts| f64::from(parts) / RATE_PARTS)
    }

    /// Returns the number of the fuel model of a cell.
    pub fn fuel_number(&self, cell: Cell) -> u8 {
        self.fuel[self.frame.index(cell)]
    }

    /// Returns the fuel model of a number, `None` if there is none.
    pub fn fuel_model(&self, number: u8) -> Option<&FuelModel> {
        self.custom_fuels.model(number)
    }

    /// Returns the fuel model of a cell, `None` where nothing burns.
    pub fn burning_model(&self, cell: Cell) -> Option<&FuelModel> {
        self.fuel_model(self.fuel_number(cell)).filter(|model| model.burns())
    }

    /// Says of every number whether its fuel model burns.
    pub fn burning_numbers(&self) -> Vec<bool> {
        (0..=u8::MAX).map(|number| self.fuel_model(number).is_some_and(FuelModel::burns)).collect()
    }

    /// Returns the models of this landscape that burn, by number.
    pub fn burning_models(&self) -> Vec<FuelModel> {
        let mut is_there = [false; 256];
        self.fuel.iter().for_each(|&number| is_there[usize::from(number)] = true);
        let numbers = (0..=u8::MAX).filter(|&number| is_there[usize::from(number)]);
        numbers.filter_map(|number| self.fuel_model(number)).filter(|model| model.burns()).cloned().collect()
    }

    /// Returns the trees of a cell; `None` where there are none.
    pub fn canopy(&self, cell: Cell) -> Option<Canopy> {
        self.canopy.as_ref()?.canopy(self.frame.index(cell))
    }

    /// Returns the gradient of the ground in a cell: rise per metre to the east and to the north.
    pub fn gradient(&self, cell: Cell) -> DVec2 {
        match &self.relief {
            Relief::Plane(gradient) => *gradient,
            Relief::Gradient(gradients) => {
                let [east, north] = gradients[self.frame.index(cell)];
                DVec2::new(f64::from(east), f64::from(north))
            }
            Relief::Elevation(elevations) => self.horn_gradient(elevations, cell),
        }
    }

    fn horn_gradient(&self, elevations: &[f32], cell: Cell) -> DVec2 {
        let Cell { col, row } = cell;
        let last = (self.frame.cols - 1, self.frame.rows - 1);
        let west = col.saturating_sub(1);
        let east = (col + 1).min(last.0);
        let south = row.saturating_sub(1);
        let north = (row + 1).min(last.1);
        let height = |col, row| f64::from(elevations[self.frame.index(Cell { col, row })]);
        let mut rise = DVec2::ZERO;
        let mut weights = DVec2::ZERO;
        for near in south..=north {
            let weight = if near == row { 2.0 } else { 1.0 };
            rise.x += weight * (height(east, near) - height(west, near));
            weights.x += weight;
        }
        for near in west..=east {
            let weight = if near == col { 2.0 } else { 1.0 };
            rise.y += weight * (height(near, north) - height(near, south));
            weights.y += weight;
        }
        let run = DVec2::new(f64::from(east - west), f64::from(north - south)) * weights * self.frame.cell_m;
        // A field of one column (row) has no slope to the east (north).
        DVec2::new(if run.x > 0.0 { rise.x / run.x } else { 0.0 }, if run.y > 0.0 { rise.y / run.y } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hill(frame: FieldFrame, height: impl Fn(f64, f64) -> f64) -> Landscape {
        let heights = (0..frame.cell_count()).map(|index| {
            let centre = frame.centre(frame.cell(index));
            height(centre.x, centre.y) as f32
        });
        Landscape { relief: Relief::Elevation(heights.collect()), ..Landscape::uniform(frame, 102) }
    }

    #[test]
    fn planes_have_their_gradient_everywhere_and_parabolas_inside() {
        let frame = FieldFrame { cols: 7, rows: 5, cell_m: 4.0 };
        let plane = hill(frame, |x, y| 3.0 + 0.25 * x - 0.5 * y);
        let bowl = hill(frame, |x, y| (x - 14.0) * (x - 14.0) + 0.5 * y);
        for index in 0..frame.cell_count() {
            let cell = frame.cell(index);
            assert!((plane.gradient(cell) - DVec2::new(0.25, -0.5)).length() < 1e-6, "{cell}");
            if (1..6).contains(&cell.col) {
                let exact = DVec2::new(2.0 * (frame.centre(cell).x - 14.0), 0.5);
                assert!((bowl.gradient(cell) - exact).length() < 1e-4, "{cell}");
            }
        }
    }

    #[test]
    fn a_field_of_one_row_has_no_slope_across() {
        let strip = hill(FieldFrame { cols: 4, rows: 1, cell_m: 5.0 }, |x, _| 2.0 * x);
        assert_eq!(strip.gradient(Cell { col: 3, row: 0 }), DVec2::new(2.0, 0.0));
    }
}
