//! What a shell and `man` know of the program: `wildfire completions` and `wildfire man`.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;

use crate::cli::error::CliError;
use crate::cli::{completion, terminal};
use wildfire_base::whole_file::WholeFile;

#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell.
    pub shell: Shell,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire man | man -l -
  wildfire man --out ~/.local/share/man/man1    then `man wildfire-batch`")]
pub struct ManArguments {
    /// Folder for the pages of all commands, created if missing [default: print the page of `wildfire`].
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Prints the script that completes the arguments of a program.
pub fn completions(arguments: &CompletionsArguments, program: Command) -> Result<ExitCode, CliError> {
    terminal::print(&completion::script(arguments.shell, program))?;
    Ok(ExitCode::SUCCESS)
}

/// Prints or writes the pages of a program for `man`.
pub fn man(arguments: &ManArguments, program: Command) -> Result<ExitCode, CliError> {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    match &arguments.out {
        None => terminal::print(&page(&program).map_err(not_written)?)?,
        Some(folder) => {
            fs::create_dir_all(folder).map_err(not_written)?;
            write_pages(&program, folder).map_err(not_written)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn not_written(error: io::Error) -> CliError {
    CliError::environment(format_args!("cannot write the pages: {error}"))
}

/// Writes the page of a command and those of its own commands.
fn write_pages(command: &Command, folder: &Path) -> io::Result<()> {
    let name = command.get_display_name().unwrap_or_else(|| command.get_name());
    let mut file = WholeFile::create(&folder.join(format!("{name}.1")))?;
    file.write_all(page(command)?.as_bytes())?;
    file.finish()?;
    command.get_subcommands().try_for_each(|command| write_pages(command, folder))
}

fn page(command: &Command) -> io::Result<String> {
    let mut page = Vec::new();
    Man::new(command.clone()).render(&mut page)?;
    Ok(String::from_utf8(page).expect("pages are text"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::program;

    #[test]
    fn every_command_has_a_page_that_names_it_and_its_options() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let program = program().disable_help_subcommand(true);
        let mut built = program;
        built.build();
        write_pages(&built, folder.path()).expect("the folder is writable");
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("the page is there");
        assert!(read("wildfire.1").contains("wildfire\\-batch(1)"));
        assert!(read("wildfire-batch.1").contains("\\-\\-seeds"));
        assert!(read("wildfire-map-wavefront.1").contains("\\-\\-goal"));
        let pages = fs::read_dir(folder.path()).expect("readable").count();
        assert!(pages > built.get_subcommands().count(), "{pages} pages");
    }
}
