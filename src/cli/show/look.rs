//! The view that the arguments ask for, checked against the runs.

use glam::DVec2;

use crate::cli::error::CliError;
use crate::cli::show::ShowArguments;
use crate::picture::film::{Camera, RunView, Selected, ViewOptions};
use crate::timeline::{AgentId, Setting};

/// The look at some runs that the arguments ask for.
///
/// # Errors
/// If an agent, a bush or a point is not in the first run.
pub fn look(arguments: &ShowArguments, films: &[&RunView]) -> Result<ViewOptions, CliError> {
    let setting = &films[0].timeline().setting;
    if let Some(agent) = arguments.follow {
        check_agent("--follow", agent, setting)?;
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
        selected: arguments.select.map(|selected| (0, selected)),
        ..ViewOptions::default()
    })
}

fn check_agent(option: &str, agent: AgentId, setting: &Setting) -> Result<(), CliError> {
    if setting.agent_index(agent).is_some() {
        return Ok(());
    }
    let known = setting.agents.iter().map(|start| start.id.to_string()).collect::<Vec<_>>();
    let known = if known.is_empty() { "nobody".into() } else { known.join(", ") };
    Err(CliError::bad_input(format_args!("{option}: there is no {agent} in this run, only {known}"), None))
}

fn share_of_field(point: DVec2, setting: &Setting) -> Result<DVec2, CliError> {
    let (width, height) = (setting.frame.width_m(), setting.frame.height_m());
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
