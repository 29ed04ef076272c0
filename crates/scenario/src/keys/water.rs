//! Water as a rule: each truck has a tank, every stop takes of it, and it is filled where there is water.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::agents::ScenarioField;
use crate::faults::check::{Check, TablePath};
use crate::{FireModelName, Scenario, Unimog};
use wildfire_base::geometry::{DVec2, FieldFrame, Pose};
use wildfire_base::input_file::list_of_at_most;
use wildfire_base::ranges;
use wildfire_base::ranges::{OutOfRange, number_text};
use wildfire_base::time::SimTime;
use wildfire_base::vehicle::Dimensions;
use wildfire_fire::water::max_kw_m;
use wildfire_planning::collision::CollisionChecker;

/// The most places with water.
const MAX_PLACES: usize = 1000;

/// The tanks of trucks, and where they are filled. Defaults: a tank and pumps like those of fire trucks, and a stop that uses
/// a twentieth of the tank.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Water {
    /// Capacity of a tank, litres; it is full at the start.
    pub tank_l: f64,
    /// Water used by a stop at a fire, litres; used when the stop begins. With `energy`, of one of the portions in which the
    /// tank is counted, at least one for each stop.
    pub stop_l: f64,
    /// Filling rate of a tank, litres per second.
    pub fill_lps: f64,
    /// Largest distance from the middle of a truck to the water, metres.
    pub reach_m: f64,
    pub effect: WaterEffect,
    /// With `effect = "energy"`: litres per second that a truck sprays.
    pub pump_lps: f64,
    /// Metres of front that its jet covers at once.
    pub jet_m: f64,
    /// Water applied, as a multiple of the least that suffices in theory.
    pub applied: f64,
    /// Places with water; if empty, the starts of all trucks.
    #[serde(deserialize_with = "list_of_at_most::<2_000, _, _>")]
    pub place: Vec<WaterPlace>,
}

impl Default for Water {
    fn default() -> Self {
        Self {
            tank_l: 2000.0,
            stop_l: 100.0,
            fill_lps: 20.0,
            reach_m: 10.0,
            effect: WaterEffect::Rule,
            pump_lps: 5.0,
            jet_m: 5.0,
            applied: 3.0,
            place: Vec::new(),
        }
    }
}

ranges! { Water {
    tank_l: 0.001..=1e6, stop_l: 0.001..=1e6, fill_lps: 0.001..=1e6, reach_m: 1.0..=1000.0,
    pump_lps: 0.001..=1e6, jet_m: 0.01..=1000.0, applied: 1.0..=1000.0,
} and |water, _| {
    let expected = format!("at most `tank_l`, {}", number_text(water.tank_l));
    let fits = water.stop_l <= water.tank_l;
    if fits { Ok(()) } else { Err(OutOfRange::new("stop_l", water.stop_l, expected)) }
} }

/// Selects the water of a stop: the same each time, or as much as the heat of the fire demands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WaterEffect {
    Rule,
    Energy,
}

/// A place with water: a hydrant, a pond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WaterPlace {
    pub x_m: f64,
    pub y_m: f64,
}

impl Water {
    pub(crate) fn check(&self, table: &TablePath, frame: &FieldFrame, model: FireModelName) -> Check {
        if self.effect == WaterEffect::Energy && model != FireModelName::Rothermel {
            let expected = "`rule`, or the model `rothermel`, as other fires have no heat".into();
            return table.refuse("effect", "energy".into(), expected);
        }
        table.count("place", self.place.len(), MAX_PLACES)?;
        self.place.iter().enumerate().try_for_each(|(number, place)| {
            let entry = table.inner("place").item(number);
            entry.number("x_m", place.x_m, 0.0..=frame.width_m())?;
            entry.number("y_m", place.y_m, 0.0..=frame.height_m())
        })
    }

    /// Returns the stops that a full tank suffices for.
    pub fn full_tank(&self) -> u32 {
        // There is a tolerance, as 4.8 / 1.6 is 2.9999999999999996 in floats.
        let stops = self.tank_l / self.stop_l;
        (stops * (1.0 + 1e-9)) as u32
    }

    /// Returns how long it takes to fill up what one stop takes.
    pub fn fill_per_stop(&self) -> SimTime {
        SimTime::from_seconds(self.stop_l / self.fill_lps)
    }

    /// Lists where there is water, in metres in the frame of the field.
    pub fn places(&self, scenario: &Scenario) -> Vec<DVec2> {
        if self.place.is_empty() {
            return scenario.unimog.iter().map(Unimog::start_centre).collect();
        }
        self.place.iter().map(|place| DVec2::new(place.x_m, place.y_m)).collect()
    }

    pub(crate) fn describe(&self) -> String {
        let fill_s = self.fill_per_stop().as_seconds() * f64::from(self.full_tank());
        let tank =
            format!("A full tank is enough for {} stops; an empty one is filled in {fill_s} s.", self.full_tank());
        if self.effect != WaterEffect::Energy {
            return tank;
        }
        let max_kw_m = max_kw_m(self.pump_lps, self.jet_m);
        let tank = tank.replace("stops", "portions");
        format!(
            "{tank} Stops take as many as the heat of the fire demands; fronts above {max_kw_m:.0} kW/m are too hot."
        )
    }

    /// Warns of places that no truck gets near enough to.
    pub(crate) fn warn(&self, scenario: &Scenario, field: Option<&ScenarioField<'_>>, found: &mut Vec<String>) {
        if scenario.unimog.is_empty() {
            found.push("The table `water` has no effect: there are no trucks.".into());
            return;
        }
        let Some(field) = field else { return };
        // Bodies that are alike are looked at once.
        let mut bodies: Vec<Dimensions> = Vec::new();
        for body in scenario.unimog.iter().map(|truck| truck.vehicle) {
            if !bodies.contains(&body) {
                bodies.push(body);
            }
        }
        for (number, place) in self.place.iter().enumerate() {
            let fits = bodies.iter().any(|body| {
                let checker = CollisionChecker::new(Arc::clone(&field.clearance), *body);
                has_room(&checker, body, DVec2::new(place.x_m, place.y_m), self.reach_m)
            });
            if !fits {
                let WaterPlace { x_m, y_m } = place;
                // Beyond `MAX_SEARCHED_M` nobody looked, and the sentence must not claim more.
                found.push(format!(
                    "`water.place.{number}`: no truck finds room within {} m of ({x_m}, {y_m}).",
                    self.reach_m.min(MAX_SEARCHED_M)
                ));
            }
        }
    }
}

/// How far from a place room is looked for; farther, a field would be all bushes.
const MAX_SEARCHED_M: f64 = 20.0;

/// Says whether a truck can stand with the middle of its body near a place: places a metre apart, sixteen headings.
fn has_room(checker: &CollisionChecker, body: &Dimensions, place: DVec2, reach_m: f64) -> bool {
    const HEADINGS: u32 = 16;
    let steps = reach_m.min(MAX_SEARCHED_M).floor() as i32;
    (0..HEADINGS).any(|turn| {
        let heading = std::f64::consts::TAU * f64::from(turn) / f64::from(HEADINGS);
        // Poses are those of the rear axle, while the reach counts from the middle of the body.
        let offset = body.body_centre(Pose::new(0.0, 0.0, heading));
        (-steps..=steps).any(|east| {
            (-steps..=steps).any(|north| {
                let from_place = DVec2::new(f64::from(east), f64::from(north));
                let axle = place + from_place - offset;
                from_place.length() <= reach_m && checker.pose_is_free(Pose::new(axle.x, axle.y, heading), 0.0)
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadedScenario, MemoryLimit, explain, load};

    fn scenario(changes: &[&str]) -> Result<Scenario, String> {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        load("contest", &changes).map_err(|error| error.to_string())
    }

    #[test]
    fn a_tank_suffices_for_whole_stops() {
        assert_eq!(scenario(&[]).expect("this is right").water, None);
        let changes = ["water.tank_l=500", "water.stop_l=120", "water.fill_lps=10"];
        let scenario = scenario(&changes).expect("this is right");
        let water = scenario.water.as_ref().expect("there is water");
        assert_eq!((water.full_tank(), water.fill_per_stop()), (4, SimTime::from_seconds(12.0)));
        assert_eq!(water.places(&scenario), [scenario.unimog[0].start_centre()]);
    }

    #[test]
    fn values_that_no_tank_has_are_refused() {
        for (change, expected) in [
            ("water.stop_l=2001", "water.stop_l"),
            ("water.fill_lps=0", "water.fill_lps"),
            ("water.effect=energy", "the model `rothermel`"),
            ("water.applied=0.5", "water.applied"),
            ("water.place=[{x_m=-1,y_m=5}]", "water.place.0.x_m"),
            ("water.place=[{x_m=1,y_m=5},{x_m=5,y_m=500}]", "water.place.1.y_m"),
        ] {
            let message = scenario(&[change]).expect_err("this is wrong");
            assert!(message.contains(expected), "{change}: {message}");
        }
    }

    #[test]
    fn water_is_explained_and_warned_of() {
        let text = |changes: &[&str]| {
            let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
            let loaded = LoadedScenario::open("contest", &changes).expect("this scenario is right");
            let text = explain(&loaded, MemoryLimit::default()).to_text();
            text.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        let explained = text(&["water.tank_l=1000"]);
        assert!(explained.contains("enough for 10 stops"), "{explained}");
        assert!(explained.contains("an empty one is filled in 50 s"), "{explained}");
        assert!(!text(&[]).contains("full tank"));
        let hot = text(&["fire.model=rothermel", "water.effect=energy", "water.stop_l=10"]);
        assert!(hot.contains("enough for 200 portions") && hot.contains("fronts above 2594 kW/m are too hot"), "{hot}");
        assert!(text(&["water.tank_l=1000", "unimog=[]"]).contains("The table `water` has no effect"));
        let close = "water.place=[{x_m=0,y_m=0}]";
        assert!(text(&[close, "water.reach_m=1"]).contains("no truck finds room within 1 m of (0, 0)"));
        assert!(!text(&[close]).contains("no truck finds room"));
    }
}
