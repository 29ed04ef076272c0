//! Layers of a landscape that files give: fuel, elevation or slope, each a raster, all of one shape at one place.
//!
//! A resolved scenario holds them packed, so that it is complete without its files and yet short enough for the plan of a
//! batch. Row 0 is the south edge.

mod kind;
mod packed;
mod reader;
mod rim;
mod slopes;
#[cfg(test)]
mod tests;
mod units;
mod weights;

use serde::{Deserialize, Serialize};

use wildfire_base::geometry::FieldFrame;
use wildfire_fire::fuel::CustomFuels;
use wildfire_fire::{CanopyLayers, Relief};
use wildfire_grid::map_files::raster::{GeoKeys, MAX_RASTER_CELLS, MAX_RASTER_SIDE};

pub use kind::LayerKind;
pub use packed::PackedLayer;
pub use reader::LayerReader;
pub use weights::Weights;

/// What files say of a landscape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportedLayers {
    pub frame: FieldFrame,
    /// Where the south-west corner of the field is in the coordinate system of the files, metres.
    pub west_m: f64,
    pub south_m: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crs: Option<GeoKeys>,
    /// Numbers of fuel models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fuel: Option<PackedLayer>,
    /// Metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    elevation: Option<PackedLayer>,
    /// Rise over run to the east and to the north.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gradient: Option<[PackedLayer; 2]>,
    /// 1 for the cells of the rim, of which files without fuel say nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    outside: Option<PackedLayer>,
    /// The bands that were taken from files with several, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<String>,
    /// What of the files may have been misread or was left out, in sentences.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<String>,
    /// Those of [`CanopyLayers`].
    #[serde(default, skip_serializing_if = "is_without_trees")]
    canopy: [Option<PackedLayer>; 4],
}

fn is_without_trees(canopy: &[Option<PackedLayer>; 4]) -> bool {
    canopy.iter().all(Option::is_none)
}

impl ImportedLayers {
    /// Returns the numbers of fuel models by cell index: those of a file, or this one everywhere; 0 in the rim.
    pub fn fuel_or(&self, everywhere: u8) -> Vec<u8> {
        let cells = self.frame.cell_count();
        let bytes = |layer: &PackedLayer| layer.bytes(cells).expect("it was checked");
        let mut fuel = self.fuel.as_ref().map_or_else(|| vec![everywhere; cells], bytes);
        let outside = self.outside.as_ref().map(bytes).unwrap_or_default();
        fuel.iter_mut().zip(outside).filter(|&(_, is_outside)| is_outside == 1).for_each(|(fuel, _)| *fuel = 0);
        fuel
    }

    /// Returns how steep the ground is, if files say so.
    pub fn relief(&self) -> Option<Relief> {
        let numbers = |layer: &PackedLayer| layer.numbers(self.frame.cell_count()).expect("it was checked");
        if let Some(layer) = &self.elevation {
            return Some(Relief::Elevation(numbers(layer)));
        }
        let [east, north] = self.gradient.as_ref()?.each_ref().map(numbers);
        Some(Relief::Gradient(east.into_iter().zip(north).map(|(east, north)| [east, north]).collect()))
    }

    /// Puts the trees that files give in place of others.
    pub fn plant(&self, trees: &mut CanopyLayers) {
        for (layer, numbers) in self.canopy.iter().zip(&mut trees.0) {
            if let Some(layer) = layer {
                let imported = layer.numbers(self.frame.cell_count()).expect("it was checked");
                *numbers = imported.into_iter().map(|number| number as u16).collect();
            }
        }
    }

    /// Says whether files give the fuel or the relief.
    pub fn gives_ground(&self) -> bool {
        self.fuel.is_some() || self.elevation.is_some() || self.gradient.is_some()
    }

    /// Checks layers that were not read from rasters but from a plan.
    pub(crate) fn is_sound(&self, fuels: &CustomFuels) -> bool {
        let FieldFrame { cols, rows, cell_m } = self.frame;
        let sides_fit = [cols, rows].map(usize::from).iter().all(|side| (1..=MAX_RASTER_SIDE).contains(side));
        let is_whole = sides_fit && self.frame.cell_count() <= MAX_RASTER_CELLS;
        if !(is_whole && cell_m.is_finite() && cell_m > 0.0) {
            return false;
        }
        let cells = self.frame.cell_count();
        let numbers_fit =
            |layer: &PackedLayer| layer.numbers(cells).is_some_and(|numbers| numbers.iter().all(|n| n.is_finite()));
        self.fuel.as_ref().is_none_or(|layer| {
            layer
                .bytes(cells)
                .is_some_and(|fuel| fuel.iter().all(|number| *number == 0 || fuels.model(*number).is_some()))
        }) && self.outside.as_ref().is_none_or(|layer| layer.bytes(cells).is_some())
            && self.elevation.iter().chain(self.gradient.iter().flatten()).all(numbers_fit)
            && self.canopy.iter().flatten().all(numbers_fit)
    }

    /// Returns the same with fuel that no raster gives.
    pub(crate) fn with_fuel(self, fuel: &[u8]) -> Self {
        Self { fuel: Some(PackedLayer::from_bytes(fuel)), ..self }
    }

    /// Creates layers of fuel alone, such as an image gives.
    pub(crate) fn from_fuel(frame: FieldFrame, fuel: &[u8]) -> Self {
        let fuel = Some(PackedLayer::from_bytes(fuel));
        Self {
            frame,
            west_m: 0.0,
            south_m: 0.0,
            crs: None,
            fuel,
            elevation: None,
            gradient: None,
            canopy: [const { None }; 4],
            outside: None,
            bands: Vec::new(),
            doubts: Vec::new(),
        }
    }
}
