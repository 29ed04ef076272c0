//! How likely cells are to catch fire by themselves, by a raster.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::ImportedLayers;
use super::packed::PackedLayer;
use super::reader::check_same_place;
use wildfire_base::geometry::FieldFrame;
use wildfire_grid::map_files::raster::{self, Raster};

/// How likely each cell is to catch fire by itself, beside the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Weights(PackedLayer);

impl Weights {
    /// Reads weights from a raster that lies on the field; a cell without a value has the weight 0.
    ///
    /// # Errors
    /// Returns a sentence that begins with the path, and names row and column where a value is wrong.
    pub(crate) fn read(path: &Path, frame: &FieldFrame, layers: Option<&ImportedLayers>) -> Result<Self, String> {
        let mut raster = raster::read(path).map_err(|error| error.to_string())?;
        let name = path.display().to_string();
        // Without a landscape there is no place to compare with, so only size and shape must fit.
        let [west_m, south_m] = layers.map_or([raster.west_m, raster.south_m], |it| [it.west_m, it.south_m]);
        let rows = frame.rows.into();
        let cols = frame.cols.into();
        let cell_m = frame.cell_m;
        let crs = layers.and_then(|it| it.crs.clone());
        // The field as a raster without values, so that one comparison serves layers and weights.
        let field = Raster { rows, cols, west_m, south_m, cell_m, values: Vec::new(), nodata: None, crs };
        check_same_place(&raster, &field, &name, "the field")?;
        for index in 0..raster.values.len() {
            let value = raster.values[index];
            // Without data nothing is ignited there.
            if raster.is_nodata(value) {
                raster.values[index] = 0.0;
            } else if !(0.0..=f32::MAX).contains(&value) {
                let row = raster.file_row(index / raster.cols);
                let col = index % raster.cols;
                return Err(format!("{name}: row {row}, column {col}: found {value}, expected a weight of 0 or more"));
            }
        }
        // Weights that are all 0 would leave no cell to choose.
        let is_any = raster.values.iter().any(|&weight| weight > 0.0);
        if is_any {
            Ok(Self(PackedLayer::from_numbers(&raster.values)))
        } else {
            Err(format!("{name}: all weights are 0"))
        }
    }

    /// Returns the weights by cell index; `None` if they were made for a field of another size.
    pub fn by_cell(&self, frame: &FieldFrame) -> Option<Vec<f32>> {
        self.0.numbers(frame.cell_count()).filter(|weights| weights.iter().all(|weight| *weight >= 0.0))
    }
}
