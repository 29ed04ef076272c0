//! Grid maps, landscapes and fire on them, and curves: laws, and the answers of other programs.

mod curves;
mod example_maps;
mod fire_reference;
mod fire_spread;
mod laws;
mod map_files;
mod rasters;
mod reference;
