//! Arguments that name the runs to show and the view of them, which is checked against the runs.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use glam::DVec2;

use crate::cli::args::{MemoryArguments, ProgramArguments, parse_seed};
use crate::cli::error::CliError;
use crate::cli::numbers;
use wildfire_base::geometry::Cell;
use wildfire_picture::film::{Camera, CameraTarget, FrameLayout, Layer, Layers, RunView, Selected, ViewOptions};
use wildfire_timeline::{AgentId, Setting};

/// Options that name the runs to show and the view of them.
#[derive(Debug, Args)]
pub struct ShowArguments {
    /// A scenario file, the name of a built-in scenario, a recording, or the folder of a batch.
    #[arg(value_name = "SCENARIO|RECORDING|DIR", default_value = "contest")]
    pub source: String,
    /// Change a value of the scenario, such as `unimog.planner=hybrid-astar`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    #[command(flatten)]
    pub programs: ProgramArguments,
    #[command(flatten)]
    pub memory: MemoryArguments,
    /// The seed of the run [default: 1, or the first of the batch].
    #[arg(short, long, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: Option<u64>,
    /// Second run to show side by side [default: the same source, if --with-seed or --with-set is given].
    #[arg(long, value_name = "SCENARIO|RECORDING|DIR")]
    pub with: Option<String>,
    /// Seed of the second run [default: that of the first].
    #[arg(long, value_name = "SEED", allow_hyphen_values = true, value_parser = parse_seed)]
    pub with_seed: Option<u64>,
    /// Change a value of the second run's scenario; may be repeated.
    #[arg(long = "with-set", value_name = "KEY=VALUE")]
    pub with_overrides: Vec<String>,
    /// Mark decisions of the first run by their verdicts, from the JSON of `wildfire why`.
    #[arg(long = "verdicts", alias = "why", value_name = "FILE")]
    pub why: Option<PathBuf>,
    /// Additional layers to show; `-NAME` hides a layer, `none` hides all.
    #[arg(long, value_name = "NAME[,NAME...]", value_delimiter = ',', allow_hyphen_values = true)]
    layers: Vec<LayerChange>,
    /// Width and height of the picture in pixels.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1000x1000")]
    pub size: PixelSize,
    /// Centre on an agent, such as `unimog/0`; `fleet` keeps all active trucks in view.
    #[arg(long, value_name = "AGENT|fleet", value_parser = parse_followed, conflicts_with = "centre")]
    pub follow: Option<CameraTarget>,
    /// Magnification; 1 shows the whole field.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_hyphen_values = true, value_parser = parse_zoom)]
    pub zoom: f64,
    /// Point of the field to centre on, in metres.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse_point)]
    pub centre: Option<DVec2>,
    /// Show the history of an agent, or of the bush in a cell.
    #[arg(long, value_name = "AGENT|COL,ROW", value_parser = parse_selected)]
    pub select: Option<Selected>,
}

impl ShowArguments {
    pub fn layers(&self) -> Layers {
        self.layers.iter().fold(Layers::default(), |layers, &change| match change {
            LayerChange::None => Layers::NONE,
            LayerChange::With(layer) => layers.with(layer),
            LayerChange::Without(layer) => layers.without(layer),
        })
    }
}

/// The look at some runs that the arguments ask for.
///
/// # Errors
/// If an agent, a bush or a point is not in the first run.
pub fn look(arguments: &ShowArguments, films: &[&RunView]) -> Result<ViewOptions, CliError> {
    // Two runs side by side show the same scene, so what is selected must be in the first.
    let setting = &films[0].timeline().setting;
    match arguments.follow {
        Some(CameraTarget::Agent(agent)) => check_agent("--follow", agent, setting)?,
        Some(CameraTarget::Fleet) => check_fleet(arguments.zoom, setting)?,
        None => {}
    }
    match arguments.select {
        Some(Selected::Agent(agent)) => check_agent("--select", agent, setting)?,
        Some(Selected::Bush(cell)) if setting.bush_index(cell).is_none() => {
            return Err(CliError::bad_input(format_args!("--select: nothing grows in cell {cell}"), None));
        }
        _ => {}
    }
    let centre = arguments.centre.map_or(Ok(Camera::WHOLE.centre), |point| share_of_field(point, setting))?;
    Ok(ViewOptions {
        camera: Camera { centre, zoom: arguments.zoom },
        follows: arguments.follow,
        layers: arguments.layers(),
        // The selection is that of the left picture.
        selected: arguments.select.map(|selected| (0, selected)),
        ..ViewOptions::default()
    })
}

fn check_agent(option: &str, agent: AgentId, setting: &Setting) -> Result<(), CliError> {
    if setting.agent_index(agent).is_some() {
        return Ok(());
    }
    let agents = setting.agents.iter().map(|start| start.id.to_string()).collect::<Vec<_>>();
    let agents = if agents.is_empty() { "nobody".into() } else { agents.join(", ") };
    Err(CliError::bad_input(format_args!("{option}: there is no {agent} in this run, only {agents}"), None))
}

/// The camera on a fleet needs a truck, and finds its zoom.
fn check_fleet(zoom: f64, setting: &Setting) -> Result<(), CliError> {
    if !setting.agents.iter().any(|start| start.id.role.suppresses()) {
        return Err(CliError::bad_input("--follow fleet: expected a run with a truck, and this one has none", None));
    }
    if zoom != Camera::WHOLE.zoom {
        let message =
            format_args!("--zoom is {zoom}; expected none with --follow fleet, which fits all trucks into view");
        return Err(CliError::bad_input(message, None));
    }
    Ok(())
}

fn share_of_field(point: DVec2, setting: &Setting) -> Result<DVec2, CliError> {
    let width = setting.frame.width_m();
    let height = setting.frame.height_m();
    let share = DVec2::new(point.x / width, point.y / height);
    if DVec2::ZERO.cmple(share).all() && share.cmple(DVec2::ONE).all() {
        return Ok(share);
    }
    let (x, y) = (point.x, point.y);
    Err(CliError::bad_input(
        format_args!("--centre is {x},{y}; expected a point of the field, up to {width},{height}"),
        None,
    ))
}

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSize {
    pub width: u32,
    pub height: u32,
}

impl From<PixelSize> for (u32, u32) {
    fn from(size: PixelSize) -> Self {
        (size.width, size.height)
    }
}

impl FromStr for PixelSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', 'X']).and_then(|(width, height)| {
            let width = width.trim().parse().ok()?;
            let height = height.trim().parse().ok()?;
            let max = FrameLayout::MAX_SIDE;
            let fits =
                (FrameLayout::MIN_WIDTH..=max).contains(&width) && (FrameLayout::MIN_HEIGHT..=max).contains(&height);
            fits.then_some(Self { width, height })
        });
        sides.ok_or_else(|| {
            let width = FrameLayout::MIN_WIDTH;
            let height = FrameLayout::MIN_HEIGHT;
            let max = FrameLayout::MAX_SIDE;
            format!("expected width and height in pixels from {width}x{height} to {max}x{max}")
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LayerChange {
    None,
    With(Layer),
    Without(Layer),
}

impl FromStr for LayerChange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let change = match text.strip_prefix('-') {
            _ if text == "none" => Some(Self::None),
            Some(name) => layer(name).map(Self::Without),
            None => layer(text).map(Self::With),
        };
        change.ok_or_else(|| {
            let names = Layer::ALL.map(Layer::name).join(", ");
            format!("the layers are {names}; -NAME hides a layer, none hides all")
        })
    }
}

fn layer(name: &str) -> Option<Layer> {
    Layer::ALL.into_iter().find(|layer| layer.name() == name)
}

/// The name of an agent.
pub fn parse_agent(text: &str) -> Result<AgentId, String> {
    let (kind, number) = text.split_once('/').unwrap_or((text, "0"));
    let agent = match (kind, number.parse()) {
        ("wumpus", Ok(number)) => Some(AgentId::wumpus(number)),
        ("unimog" | "truck", Ok(number)) => Some(AgentId::unimog(number)),
        _ => None,
    };
    agent.ok_or_else(|| "expected an agent, such as unimog/0 or wumpus/0".into())
}

fn parse_followed(text: &str) -> Result<CameraTarget, String> {
    if text == "fleet" {
        return Ok(CameraTarget::Fleet);
    }
    let agent = parse_agent(text).map(CameraTarget::Agent);
    agent.map_err(|_| "expected an agent, such as unimog/0 or wumpus/0, or fleet".into())
}

fn parse_selected(text: &str) -> Result<Selected, String> {
    let cell = text.split_once(',').and_then(|(col, row)| {
        let col = numbers::parse(col.trim())?;
        let row = numbers::parse(row.trim())?;
        Some(Selected::Bush(Cell { col, row }))
    });
    let selected = cell.or_else(|| parse_agent(text).ok().map(Selected::Agent));
    selected.ok_or_else(|| "expected an agent, such as unimog/0, or column and row of a bush, such as 7,31".into())
}

fn parse_point(text: &str) -> Result<DVec2, String> {
    let point = text.split_once(',').and_then(|(x, y)| Some(DVec2::new(metre(x)?, metre(y)?)));
    point.ok_or_else(|| "expected metres east and north of the field's south-west corner, such as 120,80".into())
}

fn metre(word: &str) -> Option<f64> {
    numbers::parse(word.trim()).filter(|metre: &f64| metre.is_finite())
}

fn parse_zoom(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(Camera::MIN_ZOOM..=Camera::MAX_ZOOM), "a number")
}

/// A moment of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// Simulated seconds since the beginning.
    Seconds(f64),
    /// A share of the run, from 0 to 1.
    Share(f64),
    /// An event of the first run.
    Event(RunEvent),
}

/// An event that a moment may be named after.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunEvent {
    FirstFire,
    FirstFailure,
    LargestSearch,
    End,
}

wildfire_base::names! { RunEvent {
    FirstFire: "first-fire", FirstFailure: "first-failure", LargestSearch: "largest-search", End: "end",
} }

/// Reads seconds, `h:mm:ss`, a share of the run as `50%`, or the name of an event.
pub fn parse_moment(text: &str) -> Result<Moment, String> {
    if let Some(event) = RunEvent::ALL.into_iter().find(|event| event.name() == text.trim()) {
        return Ok(Moment::Event(event));
    }
    let moment = match text.trim().strip_suffix('%') {
        Some(percent) => numbers::within(percent, &(0.0..=100.0)).map(|percent| Moment::Share(percent / 100.0)),
        None => numbers::parse_time(text).filter(|time| time.is_finite() && *time >= 0.0).map(Moment::Seconds),
    };
    moment.ok_or_else(|| {
        let events = RunEvent::ALL.map(RunEvent::name).join(", ");
        format!("expected seconds, at least 0, h:mm:ss, a share of the run such as 50%, or one of {events}")
    })
}

/// Simulated seconds for a second.
pub fn parse_speed(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(0.1..=1000.0), "a number")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_keep_to_the_limits_of_a_frame() {
        assert_eq!("640x480".parse(), Ok(PixelSize { width: 640, height: 480 }));
        assert_eq!("8192X8192".parse(), Ok(PixelSize { width: 8192, height: 8192 }));
        for text in ["", "640", "640x", "x480", "-640x480", "0x0", "319x240", "320x239", "8193x8192", "99999999999x300"]
        {
            assert!(text.parse::<PixelSize>().expect_err(text).contains("8192x8192"), "{text}");
        }
    }

    #[test]
    fn moments_are_times_or_shares_of_the_run() {
        assert_eq!(parse_moment("10:00"), Ok(Moment::Seconds(600.0)));
        assert_eq!(parse_moment("50%"), Ok(Moment::Share(0.5)));
        assert_eq!(parse_moment("first-fire"), Ok(Moment::Event(RunEvent::FirstFire)));
        for text in ["", "%", "101%", "-1%", "-1", "nan", "inf", "1:00%"] {
            assert!(parse_moment(text).is_err(), "{text}");
        }
    }

    #[test]
    fn every_layer_can_be_named_and_taken_away() {
        for layer in Layer::ALL {
            assert_eq!(layer.name().parse(), Ok(LayerChange::With(layer)));
            assert_eq!(format!("-{}", layer.name()).parse(), Ok(LayerChange::Without(layer)));
        }
        assert_eq!("none".parse(), Ok(LayerChange::None));
        assert!("roads".parse::<LayerChange>().expect_err("no layer").contains("roadmap, prm-query"));
    }

    #[test]
    fn agents_and_bushes_are_distinguished() {
        assert_eq!(parse_selected("unimog/2"), Ok(Selected::Agent(AgentId::unimog(2))));
        assert_eq!(parse_selected("wumpus"), Ok(Selected::Agent(AgentId::wumpus(0))));
        assert_eq!(parse_selected("7, 31"), Ok(Selected::Bush(Cell { col: 7, row: 31 })));
        for text in ["", "bush", "7", "7,-1", "unimog/x", "unimog/70000", "7,31,2"] {
            assert!(parse_selected(text).is_err(), "{text}");
        }
    }
}
