//! Options of all commands: their headings and order on a page of help, names that several share, and what to do instead of
//! an option that there is not.

use std::ffi::OsString;

use clap::{Arg, Command};

/// Headings of options that have none of their own, in the order of a page of help. Special headings come before `Limits`,
/// options that are not listed before all headings.
const HEADINGS: [(&str, &str); 7] = [
    (
        "Input",
        "seed seeds set scenario planner rules entry from-map fuel fuel-models elevation rows cols cell tolerance invert \
         remove-edges resize game with with-seed with-set verdicts pairs recording certificate conditions",
    ),
    ("Selection", "where minus-where by metric agent track without from to select against better"),
    ("Limits", "memory decisions choices futures runs samples sample until equivalent wait"),
    ("Programs", "command module trust"),
    (
        "Output",
        "out format csv npy asc tif bands png overlay surface gif mp4 page path paths edges expansions values colormap \
         arrival perimeters fire-type events trace every step-m record record-searches parent sketch sheets watch pages \
         ompl certify title size",
    ),
    ("Papers", "pdf pgf width-mm font-pt"),
    (LAST, "jobs quiet help"),
];

/// The heading of options that nearly all commands have.
const LAST: &str = "General";
const AFTER_ALL: usize = 1000;

/// Options that people look for, an option that a command needs for the advice, and the advice.
const ADVICE: [(&[&str], &str, &str); 8] = [
    (&["--duration"], "set", "`--set duration_s=600` sets the length of a run, in simulated seconds"),
    (&["--planner"], "set", "`--set unimog.planner=NAME` selects the planner"),
    (&["--threshold", "--thresh"], "tolerance", "`--tolerance GREY` is the threshold of an image"),
    (&["--runs", "--repeat", "-n"], "seeds", "`--seeds 1..20` makes twenty runs"),
    (&["--output", "--file"], "out", "`--out` names the output"),
    (&["--threads", "--cores"], "jobs", "`--jobs N` sets the number of threads"),
    (
        &["-v", "--verbose", "--debug"],
        "quiet",
        "messages are on unless `--quiet` is given; `wildfire --version` prints the version",
    ),
    (
        &["--gui", "--window", "--show"],
        "quiet",
        "`wildfire play` shows a run in a window, `wildfire page` in a browser",
    ),
];

/// Gives options of all commands their headings, in their order, and lets `--seed` and `--seeds` stand for each other
/// where there is only one of them.
pub fn arranged(command: Command) -> Command {
    arranged_where(command, &|_| true)
}

/// Does the same for the commands that arguments name: to arrange all of them takes longer than many a run.
pub fn arranged_for(command: Command, args: &[OsString]) -> Command {
    arranged_where(command, &|part| {
        args.iter().any(|arg| arg == part.get_name() || part.get_all_aliases().any(|alias| arg == alias))
    })
}

fn arranged_where(command: Command, is_wanted: &impl Fn(&Command) -> bool) -> Command {
    let wanted = command.get_subcommands().filter(|part| is_wanted(part));
    let names: Vec<String> = wanted.map(|part| part.get_name().to_owned()).collect();
    let command = names
        .iter()
        .fold(command, |command, name| command.mut_subcommand(name, |part| arranged_where(part, is_wanted)));
    let [has_seed, has_seeds] = ["seed", "seeds"].map(|long| has(&command, long));
    let command = command.mut_args(|argument| {
        let argument = match argument.get_long() {
            Some("seed") if !has_seeds => argument.alias("seeds"),
            Some("seeds") if !has_seed => argument.alias("seed"),
            _ => argument,
        };
        match heading_of(&argument) {
            Some((LAST, place)) => argument.help_heading(LAST).display_order(AFTER_ALL + place),
            Some((heading, _)) if argument.get_help_heading().is_none() => argument.help_heading(heading),
            _ => argument,
        }
    });
    let options = command.get_arguments().filter(|argument| !argument.is_positional());
    let mut options: Vec<(usize, String)> = options.map(|option| (rank(option), option.get_id().to_string())).collect();
    options.sort_by_key(|(rank, _)| *rank);
    // A changed option moves to the end, and headings come in the order of their first options.
    options.iter().fold(command, |command, (_, id)| command.mut_arg(id, |argument| argument))
}

fn has(command: &Command, long: &str) -> bool {
    command.get_arguments().any(|argument| argument.get_long() == Some(long))
}

/// The heading of an option that several commands have, and its place there.
fn heading_of(argument: &Arg) -> Option<(&'static str, usize)> {
    let long = argument.get_long()?;
    HEADINGS.iter().find_map(|(heading, names)| Some((*heading, names.split(' ').position(|name| name == long)?)))
}

fn rank(argument: &Arg) -> usize {
    let Some(heading) = argument.get_help_heading() else { return 0 };
    let place = HEADINGS.iter().position(|(existing, _)| *existing == heading);
    // Special headings stand between the selection and the limits.
    place.map_or(3, |place| if place < 2 { place + 1 } else { place + 2 })
}

/// Returns what to do instead of an option that a command has not.
pub fn advice(command: &Command, option: &str) -> Option<&'static str> {
    let mut fitting = ADVICE.iter().filter(|(_, needed, _)| *needed == "quiet" || has(command, needed));
    fitting.find(|(names, ..)| names.contains(&option)).map(|(.., advice)| *advice)
}
