//! `wildfire fire`: fire on the ground by itself, without agents.
//!
//! Every direction on these command lines and in their files is a compass azimuth, and winds are named by where they come
//! from, as in weather reports.

mod behavior;
mod calculators;
mod conditions;
mod crown;
mod options;
mod spread;

use std::process::ExitCode;

use clap::Subcommand;

use behavior::BehaviorArguments;
use calculators::{ContainArguments, MOISTURE_TABLE, SPOTTING_TABLE, STICKS_TABLE, TableArguments};
use crown::CROWN_TABLE;
use spread::SpreadArguments;

use crate::cli::error::CliError;

#[derive(Debug, Subcommand)]
pub enum FireCommand {
    /// Compute rate, intensity, flame length and shape of a fire, by Rothermel's equations.
    Behavior(BehaviorArguments),
    /// Simulate a fire over a landscape without agents: when it reaches each cell.
    Spread(Box<SpreadArguments>),
    /// Compute whether fires below trees reach their crowns, and how fast and hot they then are.
    #[command(after_help = CROWN_TABLE)]
    Crown(TableArguments),
    /// Look up the moisture of fine dead fuel in Rothermel's tables.
    #[command(after_help = MOISTURE_TABLE)]
    Moisture(TableArguments),
    /// Compute the moisture of dead sticks hour by hour, by Nelson's model.
    #[command(after_help = STICKS_TABLE)]
    Sticks(TableArguments),
    /// Compute when crews contain a fire and how large it is then, by Fried and Fried's model.
    Contain(ContainArguments),
    /// Compute how far firebrands light spot fires, by Albini's models.
    #[command(after_help = SPOTTING_TABLE)]
    Spotting(TableArguments),
}

pub fn run(command: &FireCommand, quiet: bool) -> Result<ExitCode, CliError> {
    match command {
        FireCommand::Behavior(arguments) => behavior::run(arguments, quiet)?,
        FireCommand::Spread(arguments) => spread::run(arguments, quiet)?,
        FireCommand::Crown(arguments) => crown::run(arguments, quiet)?,
        FireCommand::Moisture(arguments) => calculators::moisture(arguments, quiet)?,
        FireCommand::Sticks(arguments) => calculators::sticks(arguments, quiet)?,
        FireCommand::Contain(arguments) => calculators::contain(arguments, quiet)?,
        FireCommand::Spotting(arguments) => calculators::spotting(arguments, quiet)?,
    }
    Ok(ExitCode::SUCCESS)
}
