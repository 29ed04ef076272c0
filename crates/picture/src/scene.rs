//! Scenes: the contents of a picture of a grid map.

use wildfire_grid::{Grid, Place};

use super::colours::ColourMap;
use super::values::ValueScale;

/// A point of a map as (row, column) in cells, whole numbers at the centres of cells.
pub type Spot = (f64, f64);

/// A grid map with its marks; all places lie on the map.
///
/// [`MapScene::new`] marks nothing; set what else is to be shown:
/// `MapScene { goal: Some(goal), ..MapScene::new("Wavefront, 8 neighbours", "steps", &occupied, &value) }`.
#[derive(Clone, Copy)]
pub struct MapScene<'a> {
    /// Such as "maze.txt: Brushfire, 8 neighbours".
    pub title: &'a str,
    /// What else was asked for, under the title in smaller letters, on as many lines as it needs.
    pub subtitle: &'a str,
    /// The name of the values in a word or two, such as "cost"; it is written at the colour bar and at the height axis.
    pub value_name: &'a str,
    pub occupied: &'a Grid<bool>,
    /// The value of a cell; `None` where the map has none: unreached cells, obstacles of a wavefront. Obstacles may
    /// have values: the view from above does not show them, a surface stands that high there. Infinite values are
    /// drawn as the highest or lowest finite one, NaN as none.
    pub value: &'a dyn Fn(Place) -> Option<f64>,
    /// The name of free cells where the map says no more of them: they share a neutral colour then, and the key takes
    /// the place of the bar of colours.
    pub free_name: Option<&'a str>,
    /// The name of free cells without a value.
    pub colourless: &'a str,
    /// Zones that an overlay shows in place of values.
    pub zones: Option<Zones<'a>>,
    pub path: &'a [Place],
    /// A path through points, drawn in place of that through cells in pictures from above.
    pub track: &'a [Spot],
    /// Edges of a tree or a roadmap, drawn in pictures from above.
    pub edges: &'a [[Spot; 2]],
    /// Cells that a search jumped through: those without a value have a colour of their own in pictures from above, and
    /// what has a value, the ends of jumps, is drawn as large as can be seen.
    pub swept: Option<&'a Grid<bool>>,
    /// The text of a cell, of maps that are few cells wide; pictures from above show it.
    pub texts: Option<&'a dyn Fn(Place) -> Option<String>>,
    pub start: Option<Place>,
    pub goal: Option<Place>,
    /// The local minimum that a descent came to a halt in.
    pub stuck: Option<Place>,
    pub colours: ColourMap,
}

/// Named zones of a map, the one to keep away from first: free cells of one zone share a colour.
#[derive(Clone, Copy)]
pub struct Zones<'a> {
    pub names: &'a [&'a str],
    /// Which of `names` a free cell belongs to; beyond the last it counts as the last.
    pub zone: &'a dyn Fn(Place) -> usize,
}

impl Zones<'_> {
    pub(super) fn zone_at(&self, place: Place) -> usize {
        (self.zone)(place).min(self.names.len().saturating_sub(1))
    }
}

impl<'a> MapScene<'a> {
    /// The values of a map in viridis, without zones, path or marks.
    pub fn new(
        title: &'a str,
        value_name: &'a str,
        occupied: &'a Grid<bool>,
        value: &'a dyn Fn(Place) -> Option<f64>,
    ) -> Self {
        Self {
            title,
            subtitle: "",
            value_name,
            occupied,
            value,
            free_name: None,
            colourless: "unreached",
            zones: None,
            path: &[],
            track: &[],
            edges: &[],
            swept: None,
            texts: None,
            start: None,
            goal: None,
            stuck: None,
            colours: ColourMap::Viridis,
        }
    }

    /// The value of a cell, unless it has none or no number.
    pub(super) fn value_at(&self, place: Place) -> Option<f64> {
        (self.value)(place).filter(|value| !value.is_nan())
    }

    pub(super) fn is_swept(&self, place: Place) -> bool {
        self.swept.is_some_and(|swept| swept[place])
    }

    pub(super) fn places(&self) -> impl Iterator<Item = Place> {
        let cols = self.occupied.cols();
        (0..self.occupied.rows()).flat_map(move |row| (0..cols).map(move |col| (row, col)))
    }

    /// Colours over the finite values of free cells, if they have colours.
    pub(super) fn scale(&self) -> Option<ValueScale> {
        if self.free_name.is_some() {
            return None;
        }
        ValueScale::from_values(self.free_values(), self.colours)
    }

    /// Iterates over the values of free cells.
    pub(super) fn free_values(&self) -> impl Iterator<Item = f64> {
        let free = self.places().filter(|&place| !self.occupied[place]);
        free.filter_map(|place| self.value_at(place))
    }

    pub(super) fn has_obstacles(&self) -> bool {
        self.occupied.values().contains(&true)
    }

    /// Returns the name of free cells without the colour of a value; `None` if there are none.
    pub(super) fn colourless_name(&self) -> Option<&'a str> {
        let mut free = self.places().filter(|&place| !self.occupied[place]);
        let is_present =
            free.any(|place| self.free_name.is_some() || (self.value_at(place).is_none() && !self.is_swept(place)));
        is_present.then_some(self.free_name.unwrap_or(self.colourless))
    }
}
