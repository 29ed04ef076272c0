//! A map from above, its values as colours.

use super::colours::{OBSTACLE, Rgb, WITHOUT_VALUE};
use super::legend::{Bar, Legend, Symbol};
use super::marks::marks;
use super::plate::Plate;
use super::png::Picture;
use super::scene::MapScene;
use super::values::ValueScale;
use super::zoom::Face;

/// The map from above: colours, obstacles, path, start and goal, with title, legend and numbers of rows and columns.
///
/// Colours span the finite values of free cells. Small maps are drawn larger by a whole factor, to about 800 pixels;
/// maps of more than 4096 cells a side smaller by a whole factor: a pixel is then an obstacle if any of its cells is
/// one, else it shows their highest value. A picture takes up to about 100 MB of memory while it is drawn.
pub fn draw_map(scene: &MapScene) -> Picture {
    let scale = scene.scale();
    let legend = Legend { values: bar(scene, scale.as_ref()), key: key(scene) };
    let mut plate = Plate::around(scene, &legend);
    plate.paint(&|block| face_colour(block.face(scene), scale.as_ref()));
    plate.mark();
    plate.finish()
}

pub fn bar<'a>(scene: &MapScene<'a>, scale: Option<&'a ValueScale>) -> Option<Bar<'a>> {
    scale.map(|scale| Bar { name: scene.value_name, scale })
}

pub fn face_colour(face: Face, scale: Option<&ValueScale>) -> Rgb {
    match (face, scale) {
        (Face::Obstacle, _) => OBSTACLE,
        (Face::Value(value), Some(scale)) => scale.colour(value),
        _ => WITHOUT_VALUE,
    }
}

/// What has no value and what is marked, as far as it is present.
pub fn key<'a>(scene: &MapScene<'a>) -> Vec<(Symbol, &'a str)> {
    let obstacle = scene.has_obstacles().then_some((Symbol::Cell(OBSTACLE), "obstacle"));
    let colourless = scene.colourless_name().map(|name| (Symbol::Cell(WITHOUT_VALUE), name));
    obstacle.into_iter().chain(colourless).chain(marks_key(scene)).collect()
}

pub fn marks_key<'a>(scene: &MapScene<'a>) -> impl Iterator<Item = (Symbol, &'a str)> {
    let path = (scene.path.len() > 1).then_some((Symbol::Path, "path"));
    let marks = marks(scene).map(|(mark, _)| (Symbol::Mark(mark), mark.name()));
    path.into_iter().chain(marks)
}
