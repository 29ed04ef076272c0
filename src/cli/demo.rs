//! `wildfire demo`: a first minute with the program, in commands that can be typed again.

use std::ffi::OsString;
use std::fs;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::terminal;
use wildfire_base::document::{Block, Document};
use wildfire_base::untrusted::visible;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::plan::shell_word;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire demo
  wildfire demo --out first-look")]
pub struct DemoArguments {
    /// Output folder for pictures, pages and tables; must not exist or must be empty.
    #[arg(short, long, value_name = "DIR", default_value = "demo")]
    pub out: PathBuf,
}

/// A command of the demonstration, and what is said before it.
struct DemoStep {
    why: &'static str,
    /// Words after `wildfire`; `DIR` stands for the folder.
    command: &'static str,
}

const STEPS: [DemoStep; 9] = [
    DemoStep {
        why: "An arsonist and a fire truck, for an hour. Who wins, and what did planning cost?",
        command: "run contest --seed 7 --record-searches --out DIR/run.wildfire",
    },
    DemoStep {
        why: "The same run to watch: a page for any browser, and a picture after ten minutes.",
        command: "render DIR/run.wildfire --page DIR/run.html --out DIR/run.png --at 600",
    },
    DemoStep {
        why: "How do they find their paths? The truck's roadmap, and the largest search of the run.",
        command: "render DIR/run.wildfire --at largest-search --layers roadmap,wumpus-search --out DIR/search.png",
    },
    DemoStep {
        why: "Play it yourself: a page on which you send the truck.",
        command: "page contest --seed 7 --side unimog --out DIR/play.html",
    },
    DemoStep {
        why: "Did anyone cheat? Independent code checks every leg, every 2 cm.",
        command: "audit DIR/run.wildfire",
    },
    DemoStep {
        why: "One run proves little. Two planners, thirty fields each.",
        command: "batch contest --seeds 1..30 --planner hybrid-astar,prm+primitives --out DIR/batch",
    },
    DemoStep {
        why: "Which is better? A paired comparison on the same fields, with an interval.",
        command: "compare DIR/batch --metric saved,truck_distance_m",
    },
    DemoStep { why: "All of this as a page with charts, to pass on.", command: "report DIR/batch --pages" },
    DemoStep {
        why: "Single drives between bushes, two planners side by side.",
        command: "plan --goals 8 --planner hybrid-astar,prm-rs --png DIR/drives.png",
    },
];

/// What the demonstration made, as its page lists it.
const MADE: [(&str, &str); 7] = [
    ("Play the game: you send the truck", "play.html"),
    ("Watch the run", "run.html"),
    ("The report of thirty runs of two planners, with charts", "batch/report.html"),
    ("A search: the truck's roadmap and the nodes that the Wumpus expanded", "search.png"),
    ("The run after ten minutes", "run.png"),
    ("Single drives of two planners", "drives.png"),
    ("The table of all runs", "batch/runs.csv"),
];

const NEXT: &str = "\
Open in a browser: DIR/index.html, which links all of this.

Then try
  wildfire scenarios                              other contests: wind, hills, fleets
  wildfire run contest --set unimog.speed_mps=12  any value can be changed, and
  wildfire check contest                          explains them
  wildfire new planner mine.py                    a custom planner, in any language
  wildfire map report --help                      the classical grid maps and searches
";

/// What runs a command from its words.
type RunCommand<'a> = dyn Fn(Vec<OsString>, &CommandContext) -> Result<ExitCode, CliError> + 'a;

/// Does the steps one after the other.
pub fn run(
    arguments: &DemoArguments,
    context: &CommandContext,
    run_command: &RunCommand<'_>,
) -> Result<ExitCode, CliError> {
    // A name that begins with a hyphen would be read as an option.
    let begins_with_hyphen = arguments.out.as_os_str().as_encoded_bytes().starts_with(b"-");
    let folder = &if begins_with_hyphen { Path::new(".").join(&arguments.out) } else { arguments.out.clone() };
    expect_empty(folder)?;
    fs::create_dir_all(folder).map_err(|error| {
        CliError::environment(format_args!("cannot create the folder {}: {error}", folder.display()))
    })?;
    let shown = folder.display().to_string();
    let quiet = CommandContext::new(true, context.registry.clone());
    for (index, DemoStep { why, command }) in STEPS.iter().enumerate() {
        let gap = if index == 0 { "" } else { "\n" };
        let typed = command.replace("DIR", &shell_word(&shown));
        // The command is printed before it is run, so a reader sees what takes so long.
        terminal::print(&format!("{gap}{}/{}  {why}\n\n$ wildfire {typed}\n\n", index + 1, STEPS.len()))?;
        let args = command.split(' ').map(|word| in_folder(word, folder));
        let code = run_command(std::iter::once(OsString::from("wildfire")).chain(args).collect(), &quiet)?;
        if code != ExitCode::SUCCESS {
            return Ok(code);
        }
    }
    let links = MADE.map(|(sentence, file)| (sentence.to_owned(), file.to_owned()));
    let page = Document::new("A tour of wildfire").with([Block::Links(links.to_vec())]).to_html();
    let index = folder.join("index.html");
    write_whole(&index, page.as_bytes()).map_err(|error| CliError::unwritable(&index, &error))?;
    // Where the output is read by a program, nobody looks at a screen.
    if io::stdout().is_terminal() && !context.quiet {
        terminal::open_in_browser(&index);
    }
    terminal::print(&format!("\n{}", NEXT.replace("DIR", &visible(&shown))))?;
    Ok(ExitCode::SUCCESS)
}

/// Refuses a folder that holds something, which would be written over.
pub fn expect_empty(folder: &Path) -> Result<(), CliError> {
    let is_empty = match fs::read_dir(folder) {
        Ok(mut entries) => entries.next().is_none(),
        Err(_) => !folder.exists(),
    };
    if is_empty {
        return Ok(());
    }
    let sentence = format!("{} already exists; expected a new or an empty folder", folder.display());
    Err(CliError::bad_input(sentence, Some("name another folder, or remove it")))
}

/// Returns a word of a command with the folder's own name, which need not be text.
fn in_folder(word: &str, folder: &Path) -> OsString {
    match word.strip_prefix("DIR/") {
        Some(file) => folder.join(file).into_os_string(),
        None => word.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::parse;

    #[test]
    fn the_commands_of_the_demonstration_are_commands() {
        for DemoStep { command, .. } in STEPS {
            let args = command.split(' ').map(|word| in_folder(word, Path::new("folder")));
            let args: Vec<OsString> = std::iter::once(OsString::from("wildfire")).chain(args).collect();
            parse(&args).expect(command);
        }
    }
}
