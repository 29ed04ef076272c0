//! A map laid over the input that it was computed from.

use crate::grid::Grid;
use crate::picture::colours::{OBSTACLE, PAPER, Rgb, WITHOUT_VALUE, ZONES, blend};
use crate::picture::legend::{Legend, Symbol};
use crate::picture::map::{Plate, bar, face_colour, marks_key};
use crate::picture::png::Picture;
use crate::picture::scene::{MapScene, Zones};
use crate::picture::zoom::{BlockFace, CellBlock};

/// The share of the map in the colour of a free cell; the rest is the input's.
const OPACITY: f64 = 0.6;
/// The same of obstacles, which in grey input are dark already.
const OBSTACLE_OPACITY: f64 = 0.8;

/// The map's zones, or its values if it has none, in translucent colours over the input: over its grey values where it
/// was an image, else over white.
///
/// Size and memory are those of [`super::draw_map`]; where a pixel stands for several cells, it shows the first zone
/// among them and the darkest grey.
pub fn draw_overlay(scene: &MapScene, grey: Option<&Grid<u8>>) -> Picture {
    match scene.zones {
        Some(zones) => draw_zones(scene, &zones, grey),
        None => draw_values(scene, grey),
    }
}

fn draw_zones(scene: &MapScene, zones: &Zones, grey: Option<&Grid<u8>>) -> Picture {
    let present = present_zones(scene, zones);
    let colour = |zone: usize| ZONES[zone % ZONES.len()];
    let names = zones.names.iter().enumerate().filter(|&(zone, _)| present[zone]);
    let names = names.map(|(zone, name)| (Symbol::Cell(blend(PAPER, colour(zone), OPACITY)), *name));
    let legend = Legend { values: None, key: obstacle_key(scene).chain(names).chain(marks_key(scene)).collect() };
    paint_over(scene, &legend, grey, &|block, _| {
        block.places().map(|place| zones.zone_at(place)).min().map_or(WITHOUT_VALUE, colour)
    })
}

fn draw_values(scene: &MapScene, grey: Option<&Grid<u8>>) -> Picture {
    let scale = scene.scale();
    let shown = scale.as_ref().map(|scale| scale.on(PAPER, OPACITY));
    let colourless = scene.colourless_name().map(|name| (Symbol::Cell(blend(PAPER, WITHOUT_VALUE, OPACITY)), name));
    let key = obstacle_key(scene).chain(colourless).chain(marks_key(scene)).collect();
    let legend = Legend { values: bar(scene, shown.as_ref()), key };
    paint_over(scene, &legend, grey, &|_, face| face_colour(face, scale.as_ref()))
}

/// Lays the colours of blocks without obstacles over the input.
fn paint_over(
    scene: &MapScene,
    legend: &Legend,
    grey: Option<&Grid<u8>>,
    colour: &dyn Fn(&CellBlock, BlockFace) -> Rgb,
) -> Picture {
    let mut plate = Plate::around(scene, legend);
    plate.paint(&|block| {
        let ground = grey.map_or(PAPER, |grey| darkest(grey, block));
        match block.face(scene) {
            BlockFace::Obstacle => blend(ground, OBSTACLE, if grey.is_some() { OBSTACLE_OPACITY } else { 1.0 }),
            face => blend(ground, colour(block, face), OPACITY),
        }
    });
    plate.mark();
    plate.finish()
}

fn darkest(grey: &Grid<u8>, block: &CellBlock) -> Rgb {
    let values = block.places().filter_map(|(row, col)| grey.get(row, col));
    [*values.min().unwrap_or(&255); 3]
}

fn obstacle_key<'a>(scene: &MapScene) -> impl Iterator<Item = (Symbol, &'a str)> + use<'a> {
    scene.has_obstacles().then_some((Symbol::Cell(OBSTACLE), "obstacle")).into_iter()
}

fn present_zones(scene: &MapScene, zones: &Zones) -> Vec<bool> {
    let mut present = vec![false; zones.names.len()];
    for place in scene.places().filter(|&place| !scene.occupied[place]) {
        if let Some(zone) = present.get_mut(zones.zone_at(place)) {
            *zone = true;
        }
    }
    present
}
