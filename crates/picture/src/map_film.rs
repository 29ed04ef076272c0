//! A search on a map as a GIF: cells get their colours, and trees their edges, in the order in which the search reached them.

use std::io;
use std::path::Path;

use crate::gif_film::{ColourCounts, GifFilm};
use crate::legend::Legend;
use crate::map::{Plate, bar, face_colour, key};
use crate::scene::{MapScene, Spot};
use crate::zoom::{BlockFace, Zoom};
use wildfire_grid::Place;

/// The order in which a map was filled.
pub struct MapGrowth<'a> {
    /// The number of steps; edges of the scene come one in a step.
    pub steps: usize,
    /// The step in which a cell gets its value, from 0; `None` if it never does.
    pub step_of: &'a dyn Fn(Place) -> Option<usize>,
    /// The paths that were there before the last step, in order; each is shown until the next one.
    pub paths: &'a [GrownPath],
}

/// A path that a growing tree has for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct GrownPath {
    /// The number of steps after which it is there.
    pub steps: usize,
    pub track: Vec<Spot>,
}

/// The most frames before the last one, which shows the path.
const MAX_FRAMES: usize = 100;
/// In hundredths of a second.
const DELAY: u16 = 6;
const LAST_DELAY: u16 = 250;

/// Writes the film of a scene, atomically: at most about 100 frames over all steps, then the path.
pub fn write_map_film(scene: &MapScene, growth: &MapGrowth, path: &Path) -> io::Result<()> {
    // Which jump went through a cell is not known, nor when.
    let scene = &MapScene { swept: None, ..*scene };
    let scale = scene.scale();
    let legend = Legend { values: bar(scene, scale.as_ref()), key: key(scene) };
    let zoom = Zoom::small(scene.occupied.rows(), scene.occupied.cols());
    let bare = Plate::with_zoom(scene, &legend, zoom);
    let last = growth.steps.clamp(1, MAX_FRAMES);
    let paint = |frame: usize| {
        // The numbers are whole, so the last frame has all steps.
        let done = growth.steps * frame / last;
        let mut plate = bare.clone();
        plate.paint(&|block| {
            let face = match block.face(scene) {
                BlockFace::Value(_)
                    if !block.places().any(|place| (growth.step_of)(place).is_some_and(|step| step < done)) =>
                {
                    BlockFace::WithoutValue
                }
                face => face,
            };
            face_colour(face, scale.as_ref())
        });
        plate.draw_edges(done.min(scene.edges.len()));
        if frame == last {
            plate.draw_path();
        } else if let Some(path) = growth.paths.iter().rfind(|path| path.steps <= done) {
            plate.draw_track(&path.track);
        }
        plate.draw_marks();
        plate
    };
    let mut counts = ColourCounts::default();
    // Three frames have nearly all colours; counting those of every frame would draw the film twice.
    [0, last / 2, last].into_iter().for_each(|frame| counts.add(paint(frame).bytes()));
    let mut film = GifFilm::create(path, bare.size(), counts.palette())?;
    for frame in 0..=last {
        film.add(paint(frame).bytes(), if frame == last { LAST_DELAY } else { DELAY })?;
    }
    film.finish()
}
