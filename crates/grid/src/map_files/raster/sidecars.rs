//! Files beside a raster that say what its own bytes do not: the coordinate system in `.prj`, and what GDAL keeps in
//! `.aux.xml` and `.msk`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::RasterFault;
use super::crs::{Coordinates, SpatialReference};
use wildfire_base::input_file;

/// The most bytes of such a file that are read.
const MAX_BYTES: u64 = 1 << 20;

/// Reads the coordinate system from the `.prj` file of a raster.
pub(super) fn projection(path: &Path) -> SpatialReference {
    let texts = ["prj", "PRJ"].map(|ending| input_file::read_text(&path.with_extension(ending), MAX_BYTES));
    let text = texts.into_iter().find_map(Result::ok);
    text.map_or(SpatialReference::default(), |text| Coordinates::of_text(&text))
}

/// Refuses a raster whose numbers a file beside it changes.
pub(super) fn refuse_changes(path: &Path) -> Result<(), RasterFault> {
    // GDAL appends these endings to the whole name, whereas `.prj` replaces the ending.
    let beside = |ending: &str| PathBuf::from([path.as_os_str(), ending.as_ref()].into_iter().collect::<OsString>());
    let mask = beside(".msk");
    if mask.is_file() {
        return Err(RasterFault::Sidecar { path: mask, says: "contains its mask" });
    }
    let more = beside(".aux.xml");
    let Ok(text) = input_file::read_text(&more, MAX_BYTES) else { return Ok(()) };
    let value = |tag: &str| Some(text.split_once(tag)?.1.split('<').next()?.trim());
    // What cannot be read counts as a factor too.
    let is_factor = |tag: &str, none: f64| value(tag).is_some_and(|value| value.parse() != Ok(none));
    if is_factor("<Scale>", 1.0) || is_factor("<Offset>", 0.0) {
        return Err(RasterFault::Sidecar { path: more, says: "gives its values a scale" });
    }
    if value("<UnitType>").is_some_and(|unit| !unit.is_empty()) {
        return Err(RasterFault::Sidecar { path: more, says: "gives the unit of its values" });
    }
    if text.contains("<NoDataValue") {
        return Err(RasterFault::Sidecar { path: more, says: "gives its value for no data" });
    }
    Ok(())
}
