//! The ground of a run: what grows in its cells, how steep it is, and which cells trucks cannot cross.
//!
//! It comes from files (rasters named in `[fire.rothermel]`, or a drawn image), is generated (`[landscape]`), or is the
//! same everywhere. Two properties of a cell are kept apart: its fuel, which may be one that does not burn, and if it
//! stands in the way of trucks and Wumpuses, which fuels listed in `blocks` do. A road is bare ground and open, water is
//! water and blocks, and a bridge is bare ground that crosses it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::features::{BARE, Features, Hill, Patches, River, RiverExclusion, Road, check_hills, hill_elevations};
use super::fuel_name::FuelName;
use super::layers::{ImportedLayers, PackedLayer};
use super::moisture::rate_factors;
use crate::faults::check::{Check, TablePath};
use crate::faults::path::PathStep;
use crate::{FireModelName, Scenario};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, compass, ops};
use wildfire_base::ranges;
use wildfire_fire::fuel::{CustomFuels, FuelModel};
use wildfire_fire::{CanopyLayers, Landscape, RATE_PARTS, Relief};
use wildfire_grid::Grid;

/// The most colours of a legend.
const MAX_COLOURS: usize = 256;

/// A drawn or generated landscape, and the fuels that block agents.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LandscapeSettings {
    /// Fuels whose cells trucks and Wumpuses cannot cross.
    pub blocks: Vec<FuelName>,
    /// A PNG image with one pixel per cell, whose colours are fuels: a hand-drawn landscape.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub image: Option<PathBuf>,
    /// The fuel of each colour of the image, `"#RRGGBB"`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub legend: BTreeMap<String, FuelName>,
    /// Patches of other fuels on the ground.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub patches: Vec<Patches>,
    /// Hills; between them the field is level.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hills: Vec<Hill>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub river: Option<River>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub roads: Vec<Road>,
    /// A GeoJSON file whose lines are roads, in metres of the landscape's rasters or, without any, of the field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roads_file: Option<PathBuf>,
    /// Draws ground and bushes from this seed in every run, so that only weather, ignitions and agents differ: what maps of
    /// many fires on one landscape need.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// What the files say. Loading fills it in, so that a resolved scenario is complete without them.
    #[serde(rename = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub imported: Option<ImportedLayers>,
    /// 1 for the cells of roads of a file, 0 for others. Loading fills it in.
    #[serde(rename = "given_roads", skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub imported_roads: Option<PackedLayer>,
}

/// Cells that shapes of a file cover, with a fuel of their own: line that was built, a road, a treated stand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Barrier {
    /// A GeoJSON file of polygons and lines, in metres of the landscape's rasters or, without any, of the field.
    pub file: PathBuf,
    /// The fuel of the cells; without `factor` by default bare ground, over which fire does not spread.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fuel: Option<FuelName>,
    /// A factor on the rate of spread in the cells, which otherwise stay as they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// 1 for the cells, 0 for others. Loading fills it in.
    #[serde(rename = "given", default, skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub covered: Option<PackedLayer>,
}

ranges! { Barrier { factor: 0.001..=10.0 } }

impl Barrier {
    /// Makes it one of bare ground if it is neither of a fuel nor of a factor.
    pub(crate) fn fill_in_fuel(&mut self) {
        if self.factor.is_none() {
            self.fuel.get_or_insert(FuelName::from_code("NB9"));
        }
    }

    /// Says of each cell whether it is covered; empty if the file has not been read.
    fn cells(&self, frame: &FieldFrame) -> Vec<bool> {
        let covered = self.covered.as_ref().and_then(|it| it.bytes(frame.cell_count())).unwrap_or_default();
        covered.into_iter().map(|covered| covered == 1).collect()
    }
}

impl Default for LandscapeSettings {
    fn default() -> Self {
        Self {
            blocks: vec![FuelName::from_code("NB8")],
            image: None,
            legend: BTreeMap::new(),
            patches: Vec::new(),
            hills: Vec::new(),
            river: None,
            roads: Vec::new(),
            roads_file: None,
            seed: None,
            imported: None,
            imported_roads: None,
        }
    }
}

impl LandscapeSettings {
    /// Returns what is generated.
    pub fn features(&self) -> Features<'_> {
        Features { patches: &self.patches, river: self.river.as_ref(), roads: &self.roads }
    }

    /// Says whether trucks cannot cross cells with a fuel of this number.
    fn blocks(&self, fuel: u8) -> bool {
        self.blocks.iter().any(|name| name.number() == fuel)
    }

    pub(crate) fn check(&self, table: &TablePath, frame: &FieldFrame, fuels: &CustomFuels) -> Check {
        if let Some(place) = self.blocks.iter().position(|name| name.number() == 0) {
            let expected = "the code or number of a fuel model".into();
            return table.inner("blocks").refuse_step(PathStep::Index(place), "\"none\"".into(), expected);
        }
        table.count("blocks", self.blocks.len(), MAX_COLOURS)?;
        table.count("legend", self.legend.len(), MAX_COLOURS)?;
        if let Some(colour) = self.legend.keys().find(|colour| colour_of(colour).is_none()) {
            let expected = "a colour as \"#RRGGBB\"".into();
            return table.inner("legend").refuse_step(
                PathStep::key(colour),
                format!("the colour `{colour}`"),
                expected,
            );
        }
        // A resolved scenario holds its layers packed, and may have been edited.
        if self.imported.as_ref().is_some_and(|imported| !imported.is_sound(fuels)) {
            return table.refuse("given", "damaged".into(), "layers that can be unpacked and fit the field".into());
        }
        if self.imported_roads.as_ref().is_some_and(|roads| roads.bytes(frame.cell_count()).is_none()) {
            return table.refuse(
                "given_roads",
                "damaged".into(),
                "cells that can be unpacked and fit the field".into(),
            );
        }
        self.features().check(table, frame)?;
        check_hills(&self.hills, table, frame)
    }
}

ranges! { LandscapeSettings {; patches, hills, river } }

/// Reads a colour, `#RRGGBB`.
pub(crate) fn colour_of(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let part = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).ok();
    Some([part(0)?, part(2)?, part(4)?])
}

/// The ground of a run, and what stands in the way on it besides bushes.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    pub landscape: Landscape,
    /// Cells without a bush that trucks and Wumpuses cannot cross, by index.
    pub blocked: Vec<Cell>,
}

/// No place for the river keeps away from every start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoRiver;

/// Returns what covers the field of the run with this seed before bushes grow on it: numbers of fuel models by cell
/// index; `None` where only bushes burn.
///
/// # Errors
/// Fails if there is no place for the river.
pub fn cover(scenario: &Scenario, seed: u64, frame: &FieldFrame) -> Result<Option<Vec<u8>>, NoRiver> {
    // Under the model `radius` only bushes burn.
    if scenario.fire.model == FireModelName::Radius {
        return Ok(None);
    }
    let everywhere = scenario.fire.rothermel.as_ref().map_or(0, |settings| settings.ground.number());
    let usual = LandscapeSettings::default();
    let settings = scenario.landscape.as_ref().unwrap_or(&usual);
    let ground = settings.imported.as_ref().map(|ground| ground.fuel_or(everywhere));
    let mut fuel = ground.unwrap_or_else(|| vec![everywhere; frame.cell_count()]);
    // The river keeps clear of starts, which it could otherwise flood.
    let free =
        RiverExclusion { centres: scenario.start_centres().collect(), clearance_m: scenario.field.start_clearance_m };
    if !settings.features().lay(&mut fuel, frame, seed, &free) {
        return Err(NoRiver);
    }
    // Roads come after the river, so that those from a file cross it on bridges.
    let roads = settings.imported_roads.as_ref().and_then(|roads| roads.bytes(frame.cell_count())).unwrap_or_default();
    fuel.iter_mut().zip(roads).filter(|&(_, road)| road == 1).for_each(|(fuel, _)| *fuel = BARE);
    for barrier in &scenario.barrier {
        let Some(built) = barrier.fuel else { continue };
        // Where nothing is known of the ground, nothing is built either.
        let covered = fuel.iter_mut().zip(barrier.cells(frame)).filter(|(fuel, is_covered)| *is_covered && **fuel != 0);
        covered.for_each(|(fuel, _)| *fuel = built.number());
    }
    Ok(Some(fuel))
}

/// Says whether no bush can grow on a fuel: on water, roads and other ground that is known not to burn.
pub fn is_bare(fuel: u8) -> bool {
    FuelModel::by_number(fuel).is_some_and(|model| !model.burns())
}

/// Returns the ground of the run with this seed, made of its cover and its bushes.
pub fn ground(scenario: &Scenario, seed: u64, frame: FieldFrame, mut fuel: Vec<u8>, bushes: &Grid<bool>) -> Ground {
    let bush = scenario.fire.rothermel.as_ref().map_or(0, |settings| settings.bushes.number());
    let usual = LandscapeSettings::default();
    let settings = scenario.landscape.as_ref().unwrap_or(&usual);
    let mut blocked = Vec::new();
    for (index, (fuel, &is_bush)) in fuel.iter_mut().zip(bushes.values()).enumerate() {
        // A bush stands in the way by itself; listed twice, it would be counted twice.
        if is_bush {
            *fuel = bush;
        } else if settings.blocks(*fuel) {
            blocked.push(frame.cell(index));
        }
    }
    let canopy = scenario.fire.crowns().map(|crowns| {
        let mut trees = CanopyLayers::uniform(&crowns.canopy(), frame.cell_count());
        if let Some(imported) = &settings.imported {
            imported.plant(&mut trees);
        }
        trees
    });
    let relief = relief(scenario, settings, seed, &frame);
    let custom_fuels = scenario.custom_fuels();
    let rate_factors = factors(scenario, &frame, &fuel);
    Ground { landscape: Landscape { frame, fuel, relief, canopy, custom_fuels, rate_factors }, blocked }
}

/// Returns the factors on the rate of spread, of fuels and of places; of places that lie on each other the last counts.
fn factors(scenario: &Scenario, frame: &FieldFrame, fuel: &[u8]) -> Vec<u16> {
    let Some(settings) = scenario.fire.rothermel.as_ref().filter(|_| scenario.fire.model == FireModelName::Rothermel)
    else {
        return Vec::new();
    };
    let mut of_cell = Vec::new();
    for (barrier, factor) in scenario.barrier.iter().filter_map(|barrier| Some((barrier, barrier.factor?))) {
        of_cell.resize(fuel.len(), RATE_PARTS as u16);
        let covered = of_cell.iter_mut().zip(barrier.cells(frame)).filter(|(_, is_covered)| *is_covered);
        covered.for_each(|(parts, _)| *parts = (RATE_PARTS * factor).round() as u16);
    }
    if of_cell.is_empty() && settings.imported_factors.is_empty() {
        return Vec::new();
    }
    rate_factors(fuel, &settings.imported_factors, &of_cell)
}

fn relief(scenario: &Scenario, settings: &LandscapeSettings, seed: u64, frame: &FieldFrame) -> Relief {
    if let Some(relief) = settings.imported.as_ref().and_then(ImportedLayers::relief) {
        return relief;
    }
    if !settings.hills.is_empty() {
        return Relief::Elevation(hill_elevations(&settings.hills, frame, seed));
    }
    scenario.fire.rothermel.as_ref().map_or(Relief::FLAT, |settings| Relief::Plane(plane_gradient(settings)))
}

fn plane_gradient(settings: &crate::RothermelSettings) -> DVec2 {
    // House angles count from east against the clock, azimuths from north with it.
    compass::unit_toward(90.0 - settings.uphill_deg) * ops::tan(settings.slope_deg.to_radians())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use crate::{LoadedScenario, MemoryLimit, Terrain, explain, load};

    const FIRE: &str = "wumpus = []\nunimog = []\n[fire]\nmodel = \"rothermel\"\n";

    /// Writes a scenario with rasters of 4 rows and 6 columns beside it, and loads it.
    fn loaded(folder: &Path, text: &str) -> Result<Scenario, String> {
        let head = "ncols 6\nnrows 4\nxllcorner 1000\nyllcorner 2000\ncellsize 10\nNODATA_value -9999\n";
        let grid = |cell: &dyn Fn(usize, usize) -> String| {
            let row = |row: usize| (0..6).map(|col| cell(row, col)).collect::<Vec<_>>().join(" ");
            head.to_owned() + &(0..4).map(row).collect::<Vec<_>>().join("\n")
        };
        let file = |name: &str, text: &str| fs::write(folder.join(name), text).expect("writable");
        file("fuel.asc", &grid(&|row, col| if col == 2 { "98".into() } else { (101 + row).to_string() }));
        file("dem.asc", &grid(&|row, _| (300 - 5 * row).to_string()));
        file("hole.asc", &grid(&|row, col| if (row, col) == (2, 3) { "-9999".into() } else { "1".into() }));
        file("other.asc", &grid(&|_, _| "1".into()).replace("cellsize 10", "cellsize 5"));
        file("mine.toml", text);
        let path = folder.join("mine.toml");
        load(path.to_str().expect("plain"), &[])
            .map_err(|error| format!("{error} at {}", error.location.as_ref().expect("a place")))
    }

    #[test]
    fn trees_are_numbers_or_rasters_in_the_units_of_landfire_and_only_there_on_request() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let trees = |text: &str| {
            let text = format!("{FIRE}[fire.rothermel]\nfuel_map = \"fuel.asc\"\n{text}\n[field]\ncoverage = 0\n");
            let scenario = loaded(folder.path(), &text)?;
            let json = serde_json::to_string(&scenario).expect("scenarios are text and numbers");
            let frozen: Scenario = serde_json::from_str(&json).expect("it was written so");
            assert!(frozen == scenario && frozen.check().is_ok());
            let landscape = Terrain::from_scenario(&frozen, 1).expect("it needs no drawing").landscape;
            Ok::<_, String>((landscape.expect("the ground burns"), json))
        };
        let north = Cell { col: 0, row: 3 };
        let (landscape, json) = trees("").expect("it is right");
        assert!(landscape.canopy.is_none() && !json.contains("crowns") && !json.contains("canopy"));
        let (landscape, _) = trees("[fire.crowns]\nheight_map = \"dem.asc\"\nbase_m = 1.5").expect("it is right");
        let canopy = landscape.canopy(north).expect("there are trees");
        assert_eq!((canopy.height_m, canopy.base_m, canopy.bulk_density_kg_m3, canopy.cover), (30.0, 1.5, 0.1, 0.5));
        assert_eq!(landscape.canopy(Cell { row: 0, ..north }).expect("there are trees").height_m, 28.5);
        let refusal = trees("[fire.crowns]\ncover_map = \"dem.asc\"").expect_err("it is no percentage");
        assert!(refusal.contains("row 0, column 0: found 300, expected the cover of crowns in percent"), "{refusal}");
        let refusal = trees("[fire.crowns]\ncover = 50").expect_err("it is no share");
        assert!(refusal.contains("cover"), "{refusal}");
    }

    #[test]
    fn rasters_make_the_field_and_the_ground_the_north_row_first() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let text = format!(
            "{FIRE}[fire.rothermel]\nfuel_map = \"fuel.asc\"\nelevation = \"dem.asc\"\n[field]\ncoverage = 0\n"
        );
        let scenario = loaded(folder.path(), &text).expect("it is right");
        assert_eq!(scenario.field.frame(), FieldFrame { cols: 6, rows: 4, cell_m: 10.0 });
        let layers = scenario.layers().expect("files give some");
        assert_eq!((layers.west_m, layers.south_m), (1000.0, 2000.0));
        // What a plan of a batch holds is the same without the files.
        let json = serde_json::to_string(&scenario).expect("scenarios are text and numbers");
        let frozen: Scenario = serde_json::from_str(&json).expect("it was written so");
        fs::remove_file(folder.path().join("fuel.asc")).expect("it is there");
        assert!(frozen == scenario && frozen.check().is_ok());
        let terrain = Terrain::from_scenario(&frozen, 1).expect("it needs no drawing");
        let landscape = terrain.landscape.expect("the ground burns");
        assert_eq!(landscape.fuel_number(Cell { col: 0, row: 0 }), 104, "the last line of the file is south");
        assert_eq!(landscape.fuel_number(Cell { col: 0, row: 3 }), 101);
        assert_eq!(landscape.gradient(Cell { col: 3, row: 1 }), DVec2::new(0.0, 0.5));
        assert_eq!(terrain.blocked, [0, 1, 2, 3].map(|row| Cell { col: 2, row }));
    }

    #[test]
    fn lines_of_a_file_are_roads_in_the_coordinates_of_the_rasters() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let roads = |text: &str| fs::write(folder.path().join("roads.geojson"), text).expect("writable");
        roads(r#"{"type": "LineString", "coordinates": [[1000, 2015], [1060, 2015]]}"#);
        let text = format!(
            "{FIRE}[fire.rothermel]\nfuel_map = \"fuel.asc\"\n[field]\ncoverage = 0\n\
             [landscape]\nroads_file = \"roads.geojson\"\n"
        );
        let scenario = loaded(folder.path(), &text).expect("it is right");
        let json = serde_json::to_string(&scenario).expect("scenarios are text and numbers");
        let frozen: Scenario = serde_json::from_str(&json).expect("it was written so");
        assert!(frozen == scenario && frozen.check().is_ok());
        let terrain = Terrain::from_scenario(&frozen, 1).expect("it needs no drawing");
        let fuel = &terrain.landscape.as_ref().expect("the ground burns").fuel;
        assert_eq!((&fuel[6..12], fuel[0], fuel[12]), (&[BARE; 6][..], 104, 102), "the second row from the south");
        assert!(terrain.blocked.iter().all(|cell| cell.row != 1), "it crosses the water on a bridge");
        let path = folder.path().join("mine.toml");
        let with_text = LoadedScenario::open(path.to_str().expect("plain"), &[]).expect("it is right");
        let message = explain(&with_text, MemoryLimit::default()).to_text();
        assert!(message.contains("Roads from roads.geojson: 6 cells, 25 %."), "{message}");
        let broken = json.replace("\"given_roads\":\"", "\"given_roads\":\"AAAA");
        assert!(serde_json::from_str::<Scenario>(&broken).expect("it is text").check().is_err());
        for (wrong, expected) in [
            (r#"{"type": "LineString", "coordinates": [[0, 15], [60, 15]]}"#, "roads.geojson: its lines go from"),
            ("{\"type\":\n 7}", "roads.geojson:2:"),
            ("", "roads.geojson:1:"),
        ] {
            roads(wrong);
            let refused = loaded(folder.path(), &text).expect_err(wrong);
            assert!(refused.contains(expected), "{refused}");
        }
    }

    #[test]
    fn layers_that_do_not_go_together_are_refused_at_their_key() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        for (rest, expected) in [
            (
                "fuel_map = \"fuel.asc\"\nelevation = \"hole.asc\"",
                "hole.asc: row 2, column 3: found NODATA, expected a value",
            ),
            ("fuel_map = \"fuel.asc\"\nelevation = \"other.asc\"", "its cells are of 5 m, expected 10 m as in"),
            ("fuel_map = \"dem.asc\"", "row 0, column 0: found 300, expected the number of a fuel model"),
            ("fuel_map = \"nowhere.asc\"", "nowhere.asc: cannot be read"),
            (
                "fuel_map = \"fuel.asc\"\nground = \"GR2\"",
                "`fire.rothermel.ground` cannot be combined with `fire.rothermel.fuel_map`",
            ),
            ("fuel_map = \"fuel.asc\"\n[field]\nsize_m = 250", "`field.size_m` cannot be combined with"),
            ("slope = \"hole.asc\"", "`fire.rothermel.slope` also needs `fire.rothermel.aspect`"),
            ("[landscape]\ngiven = 1", "unknown field `given`"),
            ("[landscape]\nblocks = [\"none\"]", "`landscape.blocks.0` is \"none\"; expected the code"),
            ("[landscape]\nlegend = { red = \"GR2\" }", "a colour as \"#RRGGBB\""),
            ("[landscape]\nriver = { width_m = 900 }", "`landscape.river.width_m` is 900"),
        ] {
            let found = loaded(folder.path(), &format!("{FIRE}[fire.rothermel]\n{rest}\n")).expect_err(rest);
            assert!(found.contains(expected) && found.contains("mine.toml:"), "{found}");
        }
    }

    #[test]
    fn images_are_landscapes_by_their_legend() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let draw = |colours: &[[u8; 3]]| {
            let pixels = colours.concat();
            image::RgbImage::from_raw(2, 2, pixels)
                .expect("four pixels")
                .save(folder.path().join("drawn.png"))
                .expect("writable");
        };
        let text = format!(
            "{FIRE}[field]\ncoverage = 0\ncell_m = 20\n[landscape]\nimage = \"drawn.png\"\n\
             legend = {{ \"#00ff00\" = \"GR2\", \"#0000FF\" = \"NB8\" }}\n"
        );
        let [green, blue] = [[0, 255, 0], [0, 0, 255]];
        draw(&[green, blue, green, green]);
        let scenario = loaded(folder.path(), &text).expect("it is right");
        assert_eq!(scenario.field.frame(), FieldFrame { cols: 2, rows: 2, cell_m: 20.0 });
        let terrain = Terrain::from_scenario(&scenario, 1).expect("it needs no drawing");
        assert_eq!(terrain.landscape.expect("the ground burns").fuel, [102, 102, 102, 98]);
        assert_eq!(terrain.blocked, [Cell { col: 1, row: 1 }]);
        draw(&[green, green, green, [255, 0, 1]]);
        let found = loaded(folder.path(), &text).expect_err("a colour is unknown");
        assert!(
            found.contains("row 1, column 1: found the colour #ff0001, expected a colour of the legend: #0000FF"),
            "{found}"
        );
    }

    #[test]
    fn bushes_keep_off_water_and_roads_and_move_for_nothing_else() {
        let with = |change: &str| {
            let changes = ["fire.model=rothermel".to_owned(), change.to_owned()];
            Terrain::from_scenario(&load("contest", &changes).expect("it is right"), 5).expect("there is room")
        };
        let plain = with("duration_s=3600");
        let hills = with(
            "landscape={ hills = [{ height_m = 30, radius_m = 50 }], patches = [{ fuel = \"SH2\", share = 0.3 }] }",
        );
        assert_eq!(plain.bushes, hills.bushes);
        let river = with("landscape={ river = { width_m = 20 }, roads = [{ width_m = 10 }] }");
        let cover = cover(
            &load(
                "contest",
                &[
                    "fire.model=rothermel".into(),
                    "landscape={ river = { width_m = 20 }, roads = [{ width_m = 10 }] }".into(),
                ],
            )
            .expect("it is right"),
            5,
            &river.frame,
        );
        let cover = cover.expect("there is room").expect("the ground burns");
        assert!(river.bushes.iter().all(|&bush| !is_bare(cover[river.frame.index(bush)])));
        assert!(!river.blocked.is_empty() && river.blocked.iter().all(|&cell| !river.bushes.contains(&cell)));
    }

    #[test]
    fn a_scenario_with_rasters_lists_what_was_written_only() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let text = format!("{FIRE}[fire.rothermel]\nfuel_map = \"fuel.asc\"\n[field]\ncoverage = 0\n");
        loaded(folder.path(), &text).expect("it is right");
        let path = folder.path().join("mine.toml");
        let values = LoadedScenario::open(path.to_str().expect("plain"), &[]).expect("it is right").values();
        assert!(values.iter().all(|(path, _)| !path.contains("given") && !path.contains("raster_frame")), "{values:?}");
    }
}
