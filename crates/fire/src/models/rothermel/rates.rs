//! The rates of spread of every cell in every interval of the weather.
//!
//! Fuel beds are computed once for each fuel and interval. On a plane that gives all ellipses; where every cell has a slope
//! or a wind of its own, ellipses are computed as the fire comes to them and kept for a while, in a table of bounded size. So
//! are fuel beds where moisture differs from place to place.

use std::sync::Arc;

use super::directions::{DirectionSet, sampled_cells};
use super::rules::RothermelRules;
use super::template::Edge;
use crate::fuel::FuelModel;
use crate::surface::crown::{CrownConditions, CrownFire, GroundFuel, model_10};
use crate::surface::{Ellipse, FuelBed, SurfaceFire, twenty_foot_wind, unsheltered_adjustment};
use crate::{Landscape, Relief, Weather};
use wildfire_base::geometry::{Cell, DVec2};
use wildfire_base::time::SimTime;

/// The number in place of a fuel of cells that do not burn.
pub const BARRIER: u8 = u8::MAX;

/// Cells for each ellipse that is kept, where every cell has its own: most cells are far from the front.
const CELLS_PER_KEPT: usize = 8;
const CELLS_PER_KEPT_IN_WIND: usize = 4;
const MIN_KEPT: usize = 4096;

/// Fuel beds that are kept where moisture differs from place to place.
const KEPT_BEDS: usize = 4096;

/// The ellipse of a fire's spread in horizontal metres: `s |v'| - b.v` seconds along v, where v' is v lifted onto the
/// slope, `s = 1 / (R (1 - e))` and b is `s e` times the heading, as it acts on horizontal vectors.
#[derive(Clone, Copy, Debug)]
pub struct Spreading {
    /// Infinity where nothing spreads.
    pub slowness: f64,
    pub drift: DVec2,
    pub gradient: DVec2,
}

impl Spreading {
    /// Creates the ellipse of a fire whose rates are multiplied by a factor.
    fn new(fire: &SurfaceFire, rate_factor: f64) -> Self {
        let gradient = fire.gradient;
        let slowness = 1.0 / (rate_factor * fire.rate_mps * (1.0 - fire.eccentricity));
        if !slowness.is_finite() {
            return Self { slowness: f64::INFINITY, drift: DVec2::ZERO, gradient };
        }
        let drift = (fire.heading.truncate() + gradient * fire.heading.z) * (slowness * fire.eccentricity);
        Self { slowness, drift, gradient }
    }

    /// Returns the seconds along a horizontal vector whose length on the slope is known.
    #[inline]
    pub fn seconds_over(&self, length: f64, v: DVec2) -> f64 {
        self.slowness * length - self.drift_seconds(v)
    }

    fn ellipse(&self) -> Ellipse {
        Ellipse::with_drift(self.slowness, self.drift, self.gradient)
    }

    /// Returns the seconds along a horizontal vector; infinity where nothing spreads.
    #[inline]
    pub fn seconds(&self, v: DVec2) -> f64 {
        self.seconds_over(length_on(self.gradient, v), v)
    }

    /// Returns the seconds that wind and slope take off along a horizontal vector.
    #[inline]
    pub fn drift_seconds(&self, v: DVec2) -> f64 {
        self.drift.x * v.x + self.drift.y * v.y
    }
}

/// The length on a slope of what is above a horizontal vector.
#[inline]
pub fn length_on(gradient: DVec2, v: DVec2) -> f64 {
    let rise = gradient.x * v.x + gradient.y * v.y;
    (v.x * v.x + v.y * v.y + rise * rise).sqrt()
}

/// Two ways that are neighbours in direction, on a slope: where between two burned cells the fire comes from that is first
/// at a third one.
///
/// Both ways end in that cell; w is b - a, the line from a's beginning to b's turned round. Time is taken to be linear on
/// that line, and the earliest arrival over all of its points then has a closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// |w|^2 on the slope.
    square: f64,
    /// Distance of the cell from the line, as a part of |w|.
    height: f64,
    /// From a's beginning to the point of the line that is nearest to the cell, as a part of |w|, with its sign turned.
    foot: f64,
    /// Bounds of the difference in time between which the first fire comes from between both cells, for slowness 1.
    min: f64,
    max: f64,
}

impl Pair {
    pub fn new(gradient: DVec2, a: DVec2, b: DVec2) -> Self {
        let rise = |v: DVec2| gradient.x * v.x + gradient.y * v.y;
        let dot = |v: DVec2, w: DVec2| v.x * w.x + v.y * w.y + rise(v) * rise(w);
        let w = b - a;
        let (square, along) = (dot(w, w), dot(a, w));
        // By Lagrange's identity this is |a|^2 |w|^2 - (a.w)^2, without cancellation.
        let area = (1.0 + gradient.x * gradient.x + gradient.y * gradient.y).sqrt() * (a.x * b.y - a.y * b.x).abs();
        Self {
            square,
            height: area / square,
            foot: along / square,
            min: -(along + square) / length_on(gradient, b),
            max: -along / length_on(gradient, a),
        }
    }

    /// Says whether the first fire comes from between both cells, if b's time less a's, each with the drift on the way
    /// taken off, is `later`.
    #[inline]
    pub fn is_between(&self, slowness: f64, later: f64) -> bool {
        slowness * self.min < later && later < slowness * self.max
    }

    /// Returns the seconds that the fire needs from a's time on, with a's drift taken off, if it comes from between.
    #[inline]
    pub fn seconds(&self, slowness: f64, later: f64) -> f64 {
        self.height * (slowness * slowness * self.square - later * later).sqrt() - self.foot * later
    }

    /// Returns the part of the way from a to b at which that fire starts.
    pub fn part(&self, slowness: f64, later: f64) -> f64 {
        -self.height * later / (slowness * slowness * self.square - later * later).sqrt() - self.foot
    }
}

/// Rates on one landscape in one weather.
#[derive(Clone, Debug)]
pub struct Rates {
    landscape: Arc<Landscape>,
    weather: Arc<Weather>,
    rules: RothermelRules,
    /// The fuels of the landscape that burn, by the numbers that stand for them here.
    models: Vec<FuelModel>,
    /// By fuel, what makes wind at midflame height of wind at 10 m: a logarithm, too costly for every cell.
    adjustments: Vec<f64>,
    /// By interval of the weather, then by fuel; computed when they are asked for.
    beds: Vec<Option<Box<[FuelBed]>>>,
    /// The same on a plane.
    plane: Vec<Option<Box<[Spreading]>>>,
    /// Fuel model 10 by interval, where there are crowns, and the rate of fire in these once it is known.
    crown_beds: Vec<(FuelBed, Option<f64>)>,
    /// By a part of cell and interval, where every cell has its own gradient, trees or weather.
    kept: Vec<(u64, Spreading)>,
    /// By a part of zone and fuel, [`BARRIER`] for fuel model 10, where moisture differs from place to place.
    zone_beds: Vec<(u32, FuelBed)>,
    /// By fuel, a cell that stands for all of them on a plane.
    examples: Vec<usize>,
    smooth_gradient: Option<DVec2>,
}

/// Returns a cell of each fuel if all cells of a fuel have the same moisture and the same factor on the rate of spread.
fn examples(landscape: &Landscape, weather: &Weather, models: &[FuelModel]) -> Option<Vec<usize>> {
    let zones = weather.moisture_zones();
    if zones.is_none() && landscape.rate_factors.is_empty() {
        return Some(vec![0; models.len()]);
    }
    let mut first = [None; 256];
    for (index, &number) in landscape.fuel.iter().enumerate() {
        let example = *first[usize::from(number)].get_or_insert(index);
        let is_alike = zones.is_none_or(|zones| zones.of_cell[example] == zones.of_cell[index])
            && landscape.rate_factors.get(example) == landscape.rate_factors.get(index);
        if !is_alike && landscape.fuel_model(number).is_some_and(FuelModel::burns) {
            return None;
        }
    }
    Some(models.iter().map(|model| first[usize::from(model.number)].unwrap_or(0)).collect())
}

impl Rates {
    pub fn new(landscape: Arc<Landscape>, weather: Arc<Weather>, rules: RothermelRules) -> Self {
        // Only fuels of this landscape get beds: each bed is computed per interval.
        let models = landscape.burning_models();
        let depths = models.iter().map(|model| model.depth_ft);
        let adjustments = depths.map(|depth_ft| twenty_foot_wind(1.0) * unsheltered_adjustment(depth_ft)).collect();
        let intervals = weather.intervals().len();
        let nothing = Spreading { slowness: f64::INFINITY, drift: DVec2::ZERO, gradient: DVec2::ZERO };
        let has_crowns = landscape.canopy.is_some() && rules.crowns.is_some();
        let with_crowns = weather.intervals().iter().filter(|_| has_crowns);
        let crown_beds =
            with_crowns.map(|interval| (model_10(&interval.moisture, rules.options.curing), None)).collect();
        let examples = examples(&landscape, &weather, &models);
        let has_local_wind = !weather.wind_fields().is_empty();
        let smooth_gradient = match landscape.relief {
            Relief::Plane(gradient) if !has_crowns && has_local_wind && examples.is_some() => Some(gradient),
            _ => None,
        };
        let kept = match landscape.relief {
            Relief::Plane(_) if !has_crowns && !has_local_wind && examples.is_some() => 0,
            // A power of two, so that a place in the cache is found by masking.
            // A field without relief has room for more of them.
            Relief::Plane(_) if has_local_wind => {
                (landscape.fuel.len() / CELLS_PER_KEPT_IN_WIND).next_power_of_two().max(MIN_KEPT)
            }
            _ => (landscape.fuel.len() / CELLS_PER_KEPT).next_power_of_two().max(MIN_KEPT),
        };
        let kept = vec![(u64::MAX, nothing); kept];
        let beds = vec![None; intervals];
        let plane = vec![None; intervals];
        let zone_beds = Vec::new();
        let examples = examples.unwrap_or_default();
        Self {
            landscape,
            weather,
            rules,
            models,
            adjustments,
            beds,
            plane,
            crown_beds,
            kept,
            zone_beds,
            examples,
            smooth_gradient,
        }
    }

    pub fn weather(&self) -> &Weather {
        &self.weather
    }

    /// Returns the number that stands for the fuel of a number on the landscape, [`BARRIER`] if it does not burn.
    pub fn fuel(&self, number: u8) -> u8 {
        self.models.iter().position(|model| model.number == number).map_or(BARRIER, |fuel| fuel as u8)
    }

    /// Says whether all cells of a fuel burn alike: on a plane, without trees, in one moisture and with one factor.
    pub fn is_plane(&self) -> bool {
        // `new` makes a cache everywhere else.
        self.kept.is_empty()
    }

    /// Returns the gradient of a plane without trees on which only wind differs from place to place among the cells of a fuel:
    /// what burns there changes little from cell to cell. `None` elsewhere.
    #[inline]
    pub fn smooth_gradient(&self) -> Option<DVec2> {
        self.smooth_gradient
    }

    /// Returns the fire of a cell with trees; `None` where there are none.
    pub fn crown_fire(&mut self, interval: usize, fuel: u8, cell: Cell) -> Option<CrownFire> {
        let (mut model_10, rate_mps) = *self.crown_beds.get(interval)?;
        let canopy = self.landscape.canopy(cell)?;
        let crowns = self.rules.crowns?;
        let options = self.rules.options;
        let gradient = self.landscape.gradient(cell);
        let index = self.landscape.frame.index(cell);
        let wind = self.weather.in_cell(interval, index).wind_mps;
        let bed = self.bed(interval, fuel, index);
        let ground = GroundFuel { bed, depth_ft: self.models[usize::from(fuel)].depth_ft };
        if self.weather.moisture_zones().is_some() {
            model_10 = self.bed(interval, BARRIER, index);
        }
        let below = CrownConditions::in_weather(ground, model_10, canopy, wind, gradient, options, crowns);
        let rate_mps = rate_mps.unwrap_or_else(|| below.crown_rate_mps());
        // Under weather by place it is another one in the next cell.
        if !self.weather.is_local() {
            self.crown_beds[interval].1 = Some(rate_mps);
        }
        Some(below.burn_at(rate_mps))
    }

    fn beds(&mut self, interval: usize) -> &[FuelBed] {
        let Self { beds, models, weather, rules, .. } = self;
        beds[interval].get_or_insert_with(|| {
            let moisture = &weather.intervals()[interval].moisture;
            models.iter().map(|model| FuelBed::new(model, moisture, rules.options.curing)).collect()
        })
    }

    /// Returns the fuel bed of a cell by its index on the field.
    fn bed(&mut self, interval: usize, fuel: u8, index: usize) -> FuelBed {
        let Some(zones) = self.weather.moisture_zones() else { return self.beds(interval)[usize::from(fuel)] };
        let key = u32::from(zones.of_cell[index]) << 8 | u32::from(fuel);
        // By a multiple of the golden ratio, as neither zones nor fuels alone are spread evenly.
        let place = (key.wrapping_mul(0x9E37_79B1) >> 20) as usize % KEPT_BEDS;
        if let Some(&(cached_key, bed)) = self.zone_beds.get(place)
            && cached_key == key
        {
            return bed;
        }
        let moisture = zones.at(index);
        let curing = self.rules.options.curing;
        let model = self.models.get(usize::from(fuel));
        let bed = model.map_or_else(|| model_10(&moisture, curing), |model| FuelBed::new(model, &moisture, curing));
        if self.zone_beds.is_empty() {
            self.zone_beds = vec![(u32::MAX, bed); KEPT_BEDS];
        }
        self.zone_beds[place] = (key, bed);
        bed
    }

    /// Returns how long a fuel flames in a cell that catches fire in an interval; `None` forever.
    pub fn flaming(&mut self, interval: usize, fuel: u8, cell: Cell) -> Option<SimTime> {
        let min = self.rules.burn_out?;
        let index = self.landscape.frame.index(cell);
        Some(min.max(SimTime::from_seconds(self.bed(interval, fuel, index).residence_s())))
    }

    /// Returns the ellipses of all fuels on a plane.
    pub fn on_plane(&mut self, interval: usize) -> &[Spreading] {
        if self.plane[interval].is_none() {
            let Relief::Plane(gradient) = self.landscape.relief else {
                unreachable!("cells have gradients of their own")
            };
            let wind = self.weather.intervals()[interval].wind_mps;
            let mut spreading = Vec::with_capacity(self.models.len());
            for fuel in 0..self.models.len() {
                let index = self.examples[fuel];
                let midflame = self.adjustments[fuel] * wind;
                let fire = self.bed(interval, fuel as u8, index).behavior(midflame, gradient, &self.rules.options);
                spreading.push(Spreading::new(&fire, self.landscape.rate_factor(index)));
            }
            self.plane[interval] = Some(spreading.into());
        }
        self.plane[interval].as_ref().expect("it was just computed")
    }

    /// Returns the ellipse of a cell with this fuel; `index` is a number of the cell, near for cells near each other.
    #[inline]
    pub fn spreading(&mut self, interval: usize, fuel: u8, index: usize, cell: impl FnOnce() -> Cell) -> Spreading {
        if self.kept.is_empty() {
            return self.on_plane(interval)[usize::from(fuel)];
        }
        let key = (interval as u64) << 32 | index as u64;
        // Shifted by the interval: a way across a change of weather asks for one cell in both intervals.
        let place = (index + 61 * interval) & (self.kept.len() - 1);
        let (cached_key, spreading) = self.kept[place];
        if cached_key == key {
            return spreading;
        }
        let spreading = self.cell_spreading(interval, fuel, cell());
        self.kept[place] = (key, spreading);
        spreading
    }

    fn cell_spreading(&mut self, interval: usize, fuel: u8, cell: Cell) -> Spreading {
        let rules = self.rules;
        let index = self.landscape.frame.index(cell);
        let crown = self.crown_fire(interval, fuel, cell).zip(rules.crowns);
        let fire = if let Some((fire, crowns)) = crown {
            fire.spreading(crowns.method)
        } else {
            let gradient = self.landscape.gradient(cell);
            let midflame = self.adjustments[usize::from(fuel)] * self.weather.in_cell(interval, index).wind_mps;
            self.bed(interval, fuel, index).behavior(midflame, gradient, &rules.options)
        };
        Spreading::new(&fire, self.landscape.rate_factor(index))
    }

    /// Returns the directions of every interval of the weather.
    pub fn directions(&mut self) -> Vec<DirectionSet> {
        (0..self.weather.intervals().len()).map(|interval| self.directions_in(interval)).collect()
    }

    fn directions_in(&mut self, interval: usize) -> DirectionSet {
        let neighbours = self.rules.neighbours;
        // Without refinement directions do not depend on ellipses.
        if !self.rules.refined {
            return DirectionSet::new(neighbours, &[]);
        }
        if self.is_plane() {
            let ellipses: Vec<Ellipse> = self.on_plane(interval).iter().map(Spreading::ellipse).collect();
            return DirectionSet::new(neighbours, &ellipses);
        }
        let frame = self.landscape.frame;
        let mut ellipses = Vec::new();
        // A sample, as the ellipses of all cells of a large field would take long.
        for index in sampled_cells(frame.cell_count()) {
            let fuel = self.fuel(self.landscape.fuel[index]);
            if fuel != BARRIER {
                ellipses.push(self.cell_spreading(interval, fuel, frame.cell(index)).ellipse());
            }
        }
        DirectionSet::new(neighbours, &ellipses)
    }
}

/// The vector of a way in metres.
pub fn vector(way: &Edge, cell_m: f64) -> DVec2 {
    DVec2::new(f64::from(way.cols), f64::from(way.rows)) * cell_m
}
