//! The trees of a landscape: alike everywhere, or from rasters.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::fire::crown::{DENSITIES_KG_M3, HEIGHTS_M, SHARES, within};
use crate::cli::fire::options::{LIVE_MOISTURES, choice};
use crate::cli::numbers;
use wildfire_fire::CanopyLayers;
use wildfire_fire::surface::crown::{CrownMethod, CrownRules, CrownSettings};
use wildfire_scenario::{ImportedLayers, LayerKind};

/// Trees above the fuel, with which fire gets into crowns.
#[derive(Clone, Debug, Args)]
pub struct CanopyArguments {
    /// Height of the trees in metres, or a raster of tenths of metres (LANDFIRE CH) [default: no trees].
    #[arg(help_heading = "Trees", long, value_name = "METRES|FILE", value_parser = |text: &str| TreeLayer::read(text, &HEIGHTS_M))]
    pub canopy_height: Option<TreeLayer>,
    /// Height at which crowns begin in metres, or a raster of tenths (LANDFIRE CBH) [default: 2].
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "METRES|FILE", value_parser = |text: &str| TreeLayer::read(text, &HEIGHTS_M))]
    pub canopy_base: Option<TreeLayer>,
    /// Mass of fuel in the crowns by volume, or a raster of hundredths (LANDFIRE CBD) [default: 0.1].
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "KG/M3|FILE", value_parser = |text: &str| TreeLayer::read(text, &DENSITIES_KG_M3))]
    pub canopy_density: Option<TreeLayer>,
    /// Part of the ground below crowns, or a raster of percent (LANDFIRE CC) [default: 0.5].
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "SHARE|FILE", value_parser = |text: &str| TreeLayer::read(text, &SHARES))]
    pub canopy_cover: Option<TreeLayer>,
    /// Moisture of leaves and needles as a fraction of the dry weight; less than 0.3 counts as 0.3.
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "SHARE", default_value = "1", value_parser = within(LIVE_MOISTURES, "a fraction"))]
    pub foliar_moisture: f64,
    /// Rate of fires that torch single trees.
    #[arg(help_heading = "Trees", long, requires = "canopy_height", value_name = "NAME", default_value = "scott-reinhardt", value_parser = choice::<CrownMethod>(&["scott-reinhardt", "rothermel"]))]
    pub crown_method: CrownMethod,
    /// Write the kind of fire of each cell: 0 surface, 1 passive, 2 conditional, 3 active, -9999 where nothing burned;
    /// the name ends in .asc or .tif.
    #[arg(long, requires = "canopy_height", value_name = "FILE")]
    pub fire_type: Option<PathBuf>,
}

/// A number that holds everywhere, or a raster.
#[derive(Clone, Debug)]
pub enum TreeLayer {
    Number(f64),
    File(PathBuf),
}

impl TreeLayer {
    fn read(text: &str, range: &RangeInclusive<f64>) -> Result<Self, String> {
        let path = Path::new(text);
        if numbers::parse::<f64>(text).is_none() && (path.extension().is_some() || path.exists()) {
            return Ok(Self::File(path.to_owned()));
        }
        let number = numbers::within(text, range).map(Self::Number);
        number.ok_or_else(|| format!("expected a number {}, or a raster (.asc, .tif)", numbers::range_text(range)))
    }
}

impl CanopyArguments {
    fn layers(&self) -> [Option<&TreeLayer>; 4] {
        [&self.canopy_height, &self.canopy_base, &self.canopy_density, &self.canopy_cover].map(Option::as_ref)
    }

    pub fn rasters(&self) -> impl Iterator<Item = (LayerKind, &Path)> {
        self.layers().into_iter().enumerate().filter_map(|(place, layer)| match layer {
            Some(TreeLayer::File(path)) => Some((LayerKind::Canopy(place), path.as_path())),
            _ => None,
        })
    }

    /// Returns the trees of all cells; `None` if there are none.
    pub fn trees(&self, cells: usize, imported: Option<&ImportedLayers>) -> Option<CanopyLayers> {
        self.canopy_height.as_ref()?;
        let mut settings = CrownSettings::default();
        let numbers = [&mut settings.height_m, &mut settings.base_m, &mut settings.density_kg_m3, &mut settings.cover];
        for (number, layer) in numbers.into_iter().zip(self.layers()) {
            if let Some(TreeLayer::Number(uniform)) = layer {
                *number = *uniform;
            }
        }
        let mut trees = CanopyLayers::uniform(&settings.canopy(), cells);
        imported.inspect(|imported| imported.plant(&mut trees));
        Some(trees)
    }

    pub fn rules(&self) -> Option<CrownRules> {
        let rules = CrownRules { method: self.crown_method, foliar_moisture: self.foliar_moisture };
        self.canopy_height.as_ref().map(|_| rules)
    }
}
