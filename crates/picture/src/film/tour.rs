//! A guided tour of a run, as the page has it: its field, its first fire, a truck and how it plans, the largest search, the
//! closest moment, and the end.

use std::collections::BTreeMap;

use super::hud::format_clock;
use super::{Camera, CameraTarget, Layer, RunView, Selected, Status, ViewOptions};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_timeline::{BushState, ChangedBush, Fact, FireFact, Outcome, Winner};

/// How long a stop of the tour plays, and how soon before its moment it begins, in seconds of the viewer.
const STOP_S: f64 = 7.0;
const LEAD_S: f64 = 2.0;
/// A drive that takes a while.
const LONG_DRIVE_M: f64 = 20.0;
/// Simulated seconds for a second of the viewer: of the whole field, of a drive, of a moment, and of a fire on the ground.
const WHOLE: f64 = 10.0;
const DRIVE: f64 = 5.0;
const MOMENT: f64 = 2.0;
const GROUND: f64 = 30.0;

/// A part of a tour: from when to when it plays, how fast, and what is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct TourStop {
    pub from: SimTime,
    pub to: SimTime,
    /// Simulated seconds for a second of the viewer.
    pub speed: f64,
    pub options: ViewOptions,
}

/// Returns the stops that a run has, with the layers of these options and more.
pub fn tour(run: &RunView, options: &ViewOptions) -> Vec<TourStop> {
    let guide = Guide { run, options };
    let stops = [
        Some(guide.opening()),
        guide.first_fire(),
        guide.first_drive(),
        guide.largest_search(),
        guide.closest_moment(),
        Some(guide.ending()),
    ];
    stops.into_iter().flatten().collect()
}

/// A bush that was extinguished before it would have burned out.
struct LastSecond {
    /// The time in which it would have burned out.
    left: SimTime,
    time: SimTime,
    cell: Cell,
}

struct Guide<'a> {
    run: &'a RunView,
    options: &'a ViewOptions,
}

impl Guide<'_> {
    /// Makes a stop about a moment; its camera is that of the whole field.
    fn stop(&self, moment: SimTime, speed: f64, text: String) -> TourStop {
        // The lead is in seconds of the film, so that it grows with the speed.
        let begin_s = (moment.as_seconds() - LEAD_S * speed).max(0.0);
        let end_s = (begin_s + STOP_S * speed).min(self.run.end_time().as_seconds());
        let status = Some(Status { is_paused: false, speed, message: Some(text) });
        TourStop {
            from: SimTime::from_seconds(begin_s),
            to: SimTime::from_seconds(end_s),
            speed,
            options: ViewOptions {
                camera: Camera::WHOLE,
                follows: None,
                selected: None,
                status,
                ..self.options.clone()
            },
        }
    }

    fn near(&self, cell: Cell) -> Camera {
        let frame = &self.run.timeline().setting.frame;
        Camera::WHOLE.following(frame, frame.centre(cell))
    }

    fn opening(&self) -> TourStop {
        let setting = &self.run.timeline().setting;
        let size = format!("{:.0} m by {:.0} m", setting.frame.width_m(), setting.frame.height_m());
        let text = match setting.bushes.len() {
            0 => format!("The whole landscape, {size}"),
            count => format!("The whole field, {size}, with {count} bushes"),
        };
        self.stop(SimTime::ZERO, WHOLE, text)
    }

    fn first_fire(&self) -> Option<TourStop> {
        let time = self.run.index().first_ignition()?;
        let timeline = self.run.timeline();
        let bush = timeline.events.iter().find_map(|event| match event.fact {
            Fact::Fire(FireFact::Ignited { cell, .. }) if event.time == time => Some(cell),
            _ => None,
        });
        let cell = bush.or_else(|| timeline.ground.iter().find(|event| event.time == time).map(|event| event.cell))?;
        let speed = if bush.is_some() { MOMENT } else { GROUND };
        let mut stop = self.stop(time, speed, format!("The first fire, {} after the start", format_clock(time)));
        stop.options.camera = self.near(cell);
        Some(stop)
    }

    /// The first drive of a truck that takes a while.
    fn first_drive(&self) -> Option<TourStop> {
        let index = self.run.index();
        let timeline = self.run.timeline();
        let trucks = timeline.setting.agents.iter().enumerate().filter(|(_, agent)| agent.id.role.suppresses());
        let drives = trucks.filter_map(|(place, agent)| {
            let mut legs = index.legs_of(place).iter();
            let long = legs.find(|leg| leg.trajectory(timeline).distance_m(SimTime::MAX) > LONG_DRIVE_M)?;
            Some((long.from, agent.id))
        });
        let (time, truck) = drives.min_by_key(|(time, _)| *time)?;
        let mut stop = self.stop(time, DRIVE, format!("{truck} sets out"));
        stop.options.follows = Some(CameraTarget::Agent(truck));
        for layer in [Layer::Roadmap, Layer::Query, Layer::LocalSearch].into_iter().filter(|_| index.has_searches()) {
            stop.options.layers = stop.options.layers.with(layer);
        }
        Some(stop)
    }

    fn largest_search(&self) -> Option<TourStop> {
        let search = self.run.index().largest_search()?;
        let layer = Layer::for_phase(search.phase);
        let mut stop =
            self.stop(search.time, MOMENT, format!("The largest search: {}", layer.name().replace('-', " ")));
        stop.options.layers = stop.options.layers.with(layer);
        Some(stop)
    }

    /// The bush that was extinguished last before it would have burned out.
    fn closest_moment(&self) -> Option<TourStop> {
        let timeline = self.run.timeline();
        let burn_out = timeline.setting.rules.fire?.burn_out?;
        let mut ignited: BTreeMap<Cell, SimTime> = BTreeMap::new();
        let mut closest: Option<LastSecond> = None;
        for event in &timeline.events {
            let Some(ChangedBush { cell, state }) = event.bush_change() else { continue };
            match state {
                BushState::Burning { since } => drop(ignited.insert(cell, since)),
                BushState::Extinguished => {
                    let Some(&since) = ignited.get(&cell) else { continue };
                    let left = (since + burn_out).since(event.time);
                    if closest.as_ref().is_none_or(|closest| left < closest.left) {
                        closest = Some(LastSecond { left, time: event.time, cell });
                    }
                }
                _ => {}
            }
        }
        let LastSecond { left, time, cell } = closest?;
        let seconds = left.as_seconds();
        let text = format!("The closest moment: extinguished {seconds:.1} s before it would have burned out");
        let mut stop = self.stop(time, MOMENT, text);
        stop.options.camera = self.near(cell);
        stop.options.selected = Some((0, Selected::Bush(cell)));
        Some(stop)
    }

    fn ending(&self) -> TourStop {
        let end = self.run.end_time();
        let from = SimTime::from_seconds((end.as_seconds() - (STOP_S - LEAD_S) * WHOLE).max(0.0));
        TourStop { from, to: end, ..self.stop(end, WHOLE, ending_text(self.run.index().outcome())) }
    }
}

fn ending_text(outcome: &Outcome) -> String {
    // On a field without bushes, nobody has points, and a share of bushes says nothing.
    if let Some(ground) = outcome.ground.as_ref().filter(|_| outcome.obstacles == 0) {
        return format!("{:.1} ha burned", ground.burned_ha);
    }
    let saved = format!("{} of {} bushes saved", outcome.intact + outcome.extinguished, outcome.obstacles);
    let by = (outcome.truck_score - outcome.wumpus_score).abs();
    match outcome.winner() {
        Winner::Unimog => format!("The trucks won by {by}: {saved}"),
        Winner::Wumpus => format!("The Wumpuses won by {by}: {saved}"),
        Winner::Tie => format!("A tie: {saved}"),
    }
}
