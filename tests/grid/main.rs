//! Grid maps, landscapes and fire on them, and curves: laws, and the answers of other programs.

#[path = "../shared/reference.rs"]
mod answers;
#[path = "../shared/children.rs"]
#[cfg_attr(unix, expect(dead_code, reason = "the tests here only run programs to their ends"))]
mod children;

mod curves;
mod example_maps;
mod fire_reference;
mod fire_spread;
mod laws;
mod map_files;
mod rasters;
mod reference;
