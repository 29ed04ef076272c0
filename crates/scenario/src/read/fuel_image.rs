//! Drawn landscapes: images whose colours are fuels.

use std::collections::BTreeMap;
use std::path::Path;

use crate::site::fuel_name::FuelName;
use crate::site::imported::MAX_CELLS_A_SIDE;
use crate::site::landscape::colour_of;
use crate::site::layers::ImportedLayers;
use wildfire_base::geometry::FieldFrame;
use wildfire_grid::map_files::read_colours;

/// The fuels of an image, row 0 at the south edge.
pub(crate) struct FuelImage {
    name: String,
    cols: u16,
    rows: u16,
    fuel: Vec<u8>,
}

impl FuelImage {
    /// Reads a PNG image with a pixel for each cell, the north row first.
    ///
    /// # Errors
    /// Returns a sentence that begins with the path; a colour that is not in the legend is named with its row and column,
    /// counted from 0 at the north-west corner.
    pub fn read(path: &Path, legend: &BTreeMap<String, FuelName>) -> Result<Self, String> {
        let pixels = read_colours(path, MAX_CELLS_A_SIDE.into()).map_err(|error| error.to_string())?;
        let name = path.display().to_string();
        let fuels: BTreeMap<[u8; 3], u8> =
            legend.iter().filter_map(|(text, fuel)| Some((colour_of(text)?, fuel.number()))).collect();
        let mut fuel = Vec::with_capacity(pixels.values().len());
        // Images have north at the top, fields row 0 in the south.
        for row in (0..pixels.rows()).rev() {
            for (col, colour) in pixels.row(row).iter().enumerate() {
                let Some(&number) = fuels.get(colour) else {
                    let [red, green, blue] = colour;
                    let colours = legend.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
                    return Err(format!(
                        "{name}: row {row}, column {col}: found the colour #{red:02x}{green:02x}{blue:02x}, expected \
                         a colour of the legend: {colours}"
                    ));
                };
                fuel.push(number);
            }
        }
        let side = |cells: usize| u16::try_from(cells).expect("it has at most MAX_CELLS_A_SIDE");
        Ok(Self { name, cols: side(pixels.cols()), rows: side(pixels.rows()), fuel })
    }

    /// Makes it a layer among others, whose shape it must have; alone, its cells have the side `cell_m`.
    ///
    /// # Errors
    /// Returns a sentence if the shapes differ.
    pub fn onto(self, layers: Option<ImportedLayers>, cell_m: f64) -> Result<ImportedLayers, String> {
        let Self { name, cols, rows, fuel } = self;
        let Some(layers) = layers else {
            return Ok(ImportedLayers::from_fuel(FieldFrame { cols, rows, cell_m }, &fuel));
        };
        if (layers.frame.cols, layers.frame.rows) == (cols, rows) {
            return Ok(layers.with_fuel(&fuel));
        }
        let FieldFrame { cols: expected_cols, rows: expected_rows, .. } = layers.frame;
        Err(format!(
            "{name}: it has {rows} rows and {cols} columns, expected {expected_rows} and {expected_cols} as the rasters have"
        ))
    }
}
