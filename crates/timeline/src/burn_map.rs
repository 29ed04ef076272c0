//! The traces of a run on every cell: when fire arrived, from where, and how it burned there.
//!
//! All vectors are by cell index, with NaN where nothing burned or nothing is known. Where a cell burned more than once, the
//! first time counts.
//!
//! How fire burned follows from the setting and from where its front faced. The front faces along the gradient of the
//! arrival times, taken to the neighbours that burned earlier (upwind differences, as in Sethian, "Level Set Methods and Fast
//! Marching Methods", 1999, section 8.2), or, where no neighbour did, away from the cell that the fire came from. That
//! direction enters the rate normal to the front (Catchpole and others, 1982), from which Byram's intensity follows. The rate
//! along the ray from the parent is not used: near the head of a narrow ellipse an error of 7 degrees halves it, and
//! parents lie in one of 32 directions only.

use std::collections::BTreeSet;

use wildfire_base::geometry::{Cell, DVec2, FieldFrame, compass};
use wildfire_base::time::SimTime;
use wildfire_fire::models::RothermelRules;
use wildfire_fire::surface::crown::{FireType, SpreadingFire, spreading_fire};
use wildfire_fire::surface::{FuelBed, SurfaceFire, flame_length_m, twenty_foot_wind, unsheltered_adjustment};
use wildfire_fire::{Landscape, Relief, Weather};

use super::{Cause, Fact, FireFact, GroundFact, Setting, SpreadSetting, Timeline};

/// The burned cells of a run.
#[derive(Clone, Debug)]
pub struct BurnMap<'a> {
    setting: &'a Setting,
    /// When and why each cell caught fire first.
    ignitions: Vec<Option<(SimTime, Cause)>>,
    lost_bushes: usize,
}

/// The fire behaviour on each cell.
#[derive(Clone, Debug, PartialEq)]
pub struct FireBehavior {
    /// The compass azimuth of the front's normal.
    pub direction_deg: Vec<f64>,
    /// The rate of spread normal to the front, along the slope.
    pub rate_m_min: Vec<f64>,
    pub intensity_kw_m: Vec<f64>,
    pub flame_length_m: Vec<f64>,
    /// The number of the [`FireType`] by the head of the fire there, also on cells without a front.
    pub fire_type: Vec<f64>,
}

impl<'a> BurnMap<'a> {
    pub fn new(timeline: &'a Timeline) -> Self {
        let setting = &timeline.setting;
        let mut ignitions: Vec<Option<(SimTime, Cause)>> = vec![None; setting.frame.cell_count()];
        let mut burn = |time, cell, cause| {
            let first = &mut ignitions[setting.frame.index(cell)];
            // The first ignition counts: a map shows when fire came.
            *first = Some(first.unwrap_or((time, cause)));
        };
        let mut lost = BTreeSet::new();
        for event in &timeline.events {
            match event.fact {
                Fact::Fire(FireFact::Ignited { cell, cause }) => {
                    burn(event.time, cell, cause);
                    lost.insert(setting.frame.index(cell));
                }
                // A bush that was put out counts as saved.
                Fact::Fire(FireFact::Extinguished { cell, .. }) => {
                    lost.remove(&setting.frame.index(cell));
                }
                _ => {}
            }
        }
        // A cell has a bush or is ground, never both, so that no ignition of the one list precedes one of the other.
        for event in &timeline.ground {
            if let GroundFact::Ignited(cause) = event.fact {
                burn(event.time, event.cell, cause);
            }
        }
        Self { setting, ignitions, lost_bushes: lost.len() }
    }

    pub fn frame(&self) -> FieldFrame {
        self.setting.frame
    }

    /// Returns the number of cells that burned.
    pub fn burned(&self) -> usize {
        self.ignitions.iter().flatten().count()
    }

    /// Returns the number of bushes that burned.
    pub fn burned_bushes(&self) -> usize {
        let bushes = self.setting.bushes.iter();
        bushes.filter(|&&bush| self.ignitions[self.setting.frame.index(bush)].is_some()).count()
    }

    /// Returns the number of bushes that burned out, or were still burning at the end.
    pub fn lost_bushes(&self) -> usize {
        self.lost_bushes
    }

    /// Iterates over cells that an agent or the scenario lit, by cell index.
    pub fn sources(&self) -> impl Iterator<Item = Cell> + '_ {
        let cells = self.ignitions.iter().enumerate();
        let sources = cells.filter(|(_, ignition)| ignition.is_some_and(|(_, cause)| cause.parent().is_none()));
        sources.map(|(index, _)| self.setting.frame.cell(index))
    }

    /// Returns the arrival time of fire at each cell, in seconds from the start of the run.
    pub fn arrival_s(&self) -> Vec<f64> {
        self.ignitions.iter().map(|ignition| ignition.map_or(f64::NAN, |(time, _)| time.as_seconds())).collect()
    }

    /// Computes the fire behaviour on each cell; `None` where only bushes burn, without a rate. Cells that were lit or
    /// ignited by an ember were not reached by a front and have no values.
    pub fn behavior(&self) -> Option<FireBehavior> {
        let SpreadSetting::Rothermel { landscape, weather, rules } = self.setting.spread.as_ref()? else { return None };
        Some(FireBehavior::new(landscape, weather, rules, &self.ignitions))
    }
}

impl FireBehavior {
    /// Computes the behaviour from when and why each cell caught fire, by cell index.
    pub fn new(
        landscape: &Landscape,
        weather: &Weather,
        rules: &RothermelRules,
        ignitions: &[Option<(SimTime, Cause)>],
    ) -> Self {
        let mut fires = LocalFires::new(landscape, weather, rules);
        // NaN stays where no fire came, and where what came has no such figure.
        let [direction_deg, rate_m_min, intensity_kw_m, flame_length, fire_type] =
            [(); 5].map(|()| vec![f64::NAN; ignitions.len()]);
        let mut behavior = Self { direction_deg, rate_m_min, intensity_kw_m, flame_length_m: flame_length, fire_type };
        for (index, ignition) in ignitions.iter().enumerate() {
            let &Some((time, cause)) = ignition else { continue };
            let cell = landscape.frame.cell(index);
            let fire = fires.at(cell, time);
            behavior.fire_type[index] = fire.map_or(f64::NAN, |found| f64::from(found.fire_type as u8));
            // Lighters and embers bring no front, so there is no direction or rate.
            let Cause::Spread(parent) = cause else { continue };
            let direction = front_direction(&landscape.frame, cell, time, parent, |near| {
                Some(ignitions[landscape.frame.index(near)]?.0)
            });
            behavior.direction_deg[index] = compass::azimuth_deg(direction);
            let Some(SpreadingFire { fire, .. }) = fire else { continue };
            let rate_mps = fire.front_normal_rate_mps(direction);
            let intensity = fire.intensity_kw_m(rate_mps);
            behavior.rate_m_min[index] = 60.0 * rate_mps * landscape.rate_factor(index);
            behavior.intensity_kw_m[index] = intensity;
            behavior.flame_length_m[index] = flame_length_m(intensity);
        }
        behavior
    }
}

/// A front that comes to a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Front {
    /// Byram's intensity.
    pub intensity_kw_m: f64,
    /// The heat that a square metre gives off as it flames.
    pub heat_kj_m2: f64,
}

impl SpreadSetting {
    /// Computes the front by which a cell caught fire at a time; that of the head where no front came. `None` where fire has no
    /// rate. See [`front_direction`].
    pub fn front(
        &self,
        cell: Cell,
        time: SimTime,
        cause: Cause,
        ignited_at: impl Fn(Cell) -> Option<SimTime>,
    ) -> Option<Front> {
        let Self::Rothermel { landscape, weather, rules } = self else { return None };
        let fire = spreading_fire(landscape, weather, &rules.options, rules.crowns, cell, time)?.fire;
        let rate_mps = match cause {
            Cause::Spread(parent) => {
                fire.front_normal_rate_mps(front_direction(&landscape.frame, cell, time, parent, ignited_at))
            }
            Cause::Spotted(_) | Cause::Agent(_) | Cause::Scheduled => fire.rate_mps,
        };
        Some(Front { intensity_kw_m: fire.intensity_kw_m(rate_mps), heat_kj_m2: fire.heat_kj_m2() })
    }
}

/// Returns the horizontal direction that the front faced in a cell that it reached at a time from its parent, by the neighbours
/// that caught fire before.
pub fn front_direction(
    frame: &FieldFrame,
    cell: Cell,
    time: SimTime,
    parent: Cell,
    ignited_at: impl Fn(Cell) -> Option<SimTime>,
) -> DVec2 {
    // Seconds by which the neighbour burned earlier; nothing of later ones.
    let lead_s = |cols, rows| {
        let earlier = ignited_at(frame.offset(cell, cols, rows)?)?;
        (earlier < time).then(|| (time - earlier).as_seconds())
    };
    let gradient = DVec2::new(slope(lead_s(-1, 0), lead_s(1, 0)), slope(lead_s(0, -1), lead_s(0, 1)));
    if gradient == DVec2::ZERO { frame.centre(cell) - frame.centre(parent) } else { gradient }
}

// Fronts that meet come from both sides: the one that came first counts.
fn slope(behind: Option<f64>, ahead: Option<f64>) -> f64 {
    match (behind, ahead) {
        (Some(behind), Some(ahead)) if ahead > behind => -ahead,
        (Some(behind), _) => behind,
        (None, Some(ahead)) => -ahead,
        (None, None) => 0.0,
    }
}

/// Fires of each fuel in each interval of the weather; on ground with one slope they are the same everywhere.
struct LocalFires<'a> {
    landscape: &'a Landscape,
    weather: &'a Weather,
    rules: &'a RothermelRules,
    beds: Vec<Option<(FuelBed, DVec2)>>,
    level: Vec<Option<SurfaceFire>>,
}

const FUELS: usize = 256;

impl<'a> LocalFires<'a> {
    fn new(landscape: &'a Landscape, weather: &'a Weather, rules: &'a RothermelRules) -> Self {
        let mut beds = Vec::new();
        for interval in weather.intervals() {
            beds.extend((0..=u8::MAX).map(|number| {
                let model = landscape.fuel_model(number).filter(|model| model.burns())?;
                let wind = interval.wind_mps * (twenty_foot_wind(1.0) * unsheltered_adjustment(model.depth_ft));
                Some((FuelBed::new(model, &interval.moisture, rules.options.curing), wind))
            }));
        }
        let level = vec![None; beds.len()];
        Self { landscape, weather, rules, beds, level }
    }

    /// Returns the fire of a cell that the front reaches at a time; `None` where nothing can burn.
    fn at(&mut self, cell: Cell, time: SimTime) -> Option<SpreadingFire> {
        let Self { landscape, weather, rules, .. } = *self;
        let interval = weather.interval_at(time);
        let place = interval * FUELS + usize::from(landscape.fuel_number(cell));
        // Where wind or trees differ from cell to cell, no result can be shared.
        if weather.is_local() || rules.crowns.is_some() && landscape.canopy(cell).is_some() {
            return spreading_fire(landscape, weather, &rules.options, rules.crowns, cell, time);
        }
        // On a plane, all cells with one fuel burn alike during an interval of the weather.
        let is_plane = matches!(landscape.relief, Relief::Plane(_));
        if let Some(fire) = self.level[place].filter(|_| is_plane) {
            return Some(SpreadingFire { fire, fire_type: FireType::Surface });
        }
        let (bed, wind) = self.beds[place].as_ref()?;
        let fire = bed.behavior(*wind, landscape.gradient(cell), &rules.options);
        self.level[place] = is_plane.then_some(fire);
        Some(SpreadingFire { fire, fire_type: FireType::Surface })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::GroundEvent;
    use crate::sample;
    use wildfire_fire::surface::FuelMoisture;

    const FRAME: FieldFrame = FieldFrame { cols: 61, rows: 41, cell_m: 5.0 };
    const START: Cell = Cell { col: 15, row: 20 };

    /// Grass under a wind from the west, burned as the ellipse of its fire says.
    fn burned_grass() -> (Timeline, SurfaceFire) {
        let landscape = Landscape::uniform(FRAME, 102);
        let weather = Weather::constant(DVec2::new(4.0, 0.0), FuelMoisture::default());
        let rules = RothermelRules::default();
        let fire = LocalFires::new(&landscape, &weather, &rules).at(START, SimTime::ZERO).expect("grass burns").fire;
        let spread = SpreadSetting::Rothermel { landscape: Arc::new(landscape), weather: Arc::new(weather), rules };
        let mut setting = sample::small_setting(&[]);
        setting.frame = FRAME;
        setting.bushes.clear();
        setting.spread = Some(spread);
        let mut ground: Vec<GroundEvent> = (0..FRAME.cell_count())
            .map(|index| {
                let cell = FRAME.cell(index);
                let way = FRAME.centre(cell) - FRAME.centre(START);
                let cause = if cell == START { Cause::Scheduled } else { Cause::Spread(START) };
                let time = SimTime::from_seconds(fire.ellipse().travel_s(way));
                GroundEvent { time, cell, fact: GroundFact::Ignited(cause) }
            })
            .collect();
        ground.sort_by_key(|event| event.time);
        (Timeline { setting, events: Vec::new(), ground }, fire)
    }

    #[test]
    fn an_ellipse_has_its_head_its_back_and_its_flanks() {
        let (timeline, fire) = burned_grass();
        let map = BurnMap::new(&timeline);
        let behavior = map.behavior().expect("there is ground");
        let at = |values: &[f64], col, row| values[FRAME.index(Cell { col, row })];
        assert_eq!(map.burned(), FRAME.cell_count());
        assert_eq!(map.sources().collect::<Vec<_>>(), [START]);
        assert!(at(&behavior.intensity_kw_m, 15, 20).is_nan(), "the first cell was lit");
        assert!(behavior.fire_type.iter().all(|&kind| kind == 0.0), "there are no trees");
        let head = fire.intensity_kw_m(fire.rate_mps);
        assert!((at(&behavior.intensity_kw_m, 50, 20) / head - 1.0).abs() < 1e-9);
        assert!((at(&behavior.direction_deg, 50, 20) - 90.0).abs() < 1e-9);
        assert!((at(&behavior.direction_deg, 5, 20) - 270.0).abs() < 1e-9);
        let back = fire.intensity_kw_m(fire.back_rate_mps());
        assert!((at(&behavior.intensity_kw_m, 5, 20) / back - 1.0).abs() < 1e-9);
        // In between, the exact rate normal to an ellipse that grows is the inverse of the length of the gradient of its
        // travel time, here by differences that are a hundred times finer than cells.
        let (mut worst, mut checked) = (0.0_f64, 0);
        for index in 0..FRAME.cell_count() {
            let cell = FRAME.cell(index);
            let way = FRAME.centre(cell) - FRAME.centre(START);
            if way.length() > 40.0 {
                let time = |right: f64, up: f64| fire.ellipse().travel_s(way + DVec2::new(right, up));
                let slope = DVec2::new(time(0.05, 0.0) - time(-0.05, 0.0), time(0.0, 0.05) - time(0.0, -0.05)) / 0.1;
                let exact = 60.0 / slope.length();
                worst = worst.max((behavior.rate_m_min[index] / exact - 1.0).abs());
                checked += 1;
            }
        }
        assert!(checked > 2000 && worst < 0.12, "{worst}");
        let lengths = behavior.flame_length_m.iter().zip(&behavior.intensity_kw_m);
        assert!(
            lengths.filter(|(length, _)| length.is_finite()).all(|(&length, &heat)| length == flame_length_m(heat))
        );
    }

    #[test]
    fn bushes_alone_have_times_and_no_intensity() {
        let timeline = sample::spreading();
        let map = BurnMap::new(&timeline);
        assert!(map.behavior().is_none());
        assert_eq!(map.burned(), map.burned_bushes());
        assert!(map.lost_bushes() <= map.burned_bushes());
        let times = map.arrival_s();
        let first = timeline.setting.frame.index(sample::A);
        assert!(times[first].is_finite());
        assert_eq!(times.iter().filter(|time| time.is_finite()).count(), map.burned());
    }
}
