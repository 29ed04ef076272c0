//! Names that arguments take, for shells that complete them: scenarios, planners, policies, columns.
//!
//! `clap` knows the options of a command, and the values of those that take no others. An argument that takes a name or
//! anything else, such as a scenario or the file of one, has no such list, since it would refuse the rest. So the scripts
//! that `clap` writes are extended: they offer the names, and every other value is still taken.

use std::fmt::{Display, Write};

use clap::{Arg, Command, ValueHint};
use clap_complete::Shell;

use wildfire_batch::comparison::NAMED_METRICS;
use wildfire_batch::table::RUN_COLUMNS;
use wildfire_planning::TruckPlannerKind;
use wildfire_scenario::{BUILT_IN, DispatchPolicy, IdleRule, TruckGoal, WumpusGoal};

/// The kinds of names that arguments take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Names {
    /// A built-in scenario, or a file.
    Scenarios,
    Planners,
    /// Columns of numbers of `runs.csv`.
    Columns,
    /// Those, and what is compared besides.
    Metrics,
    /// Keys of a scenario that take a name, with all names.
    Settings,
    /// Columns by which runs are chosen, with the names in them.
    Choices,
    /// Columns by which runs are compared.
    Divisions,
}

impl Names {
    const ALL: [Self; 7] =
        [Self::Scenarios, Self::Planners, Self::Columns, Self::Metrics, Self::Settings, Self::Choices, Self::Divisions];

    /// Returns the names that an argument of a command takes, if it takes any that are not known to `clap`.
    fn of_argument(command: &str, argument: &Arg) -> Option<Self> {
        if !argument.get_possible_values().is_empty() {
            return None;
        }
        match (argument.get_long(), argument.get_id().as_str()) {
            (None, "source" | "sources") | (Some("scenario" | "with" | "show"), _) => Some(Self::Scenarios),
            (Some("planner" | "against"), _) => Some(Self::Planners),
            (Some("metric"), _) if command == "report" => Some(Self::Columns),
            (Some("metric"), _) => Some(Self::Metrics),
            (Some("set" | "with-set"), _) => Some(Self::Settings),
            (Some("where" | "minus-where"), _) => Some(Self::Choices),
            (Some("by"), _) => Some(Self::Divisions),
            _ => None,
        }
    }

    fn candidates(self) -> Vec<String> {
        let columns = RUN_COLUMNS.iter().filter(|column| column.holds_numbers()).map(|column| column.name.to_owned());
        match self {
            Self::Scenarios => scenario_names(),
            Self::Planners => planner_names(),
            Self::Columns => columns.collect(),
            Self::Metrics => NAMED_METRICS.iter().map(|metric| metric.name.to_owned()).chain(columns).collect(),
            Self::Settings => [
                with_key("unimog.planner", &planner_names()),
                with_key("unimog.goal", &TruckGoal::BUILT_IN),
                with_key("wumpus.goal", &WumpusGoal::BUILT_IN),
                with_key("dispatch.policy", &DispatchPolicy::ALL.map(DispatchPolicy::name)),
                with_key("dispatch.idle", &IdleRule::ALL.map(IdleRule::name)),
            ]
            .concat(),
            Self::Choices => [with_key("scenario", &scenario_names()), with_key("planner", &planner_names())].concat(),
            Self::Divisions => ["scenario", "planner", "policy"].map(str::to_owned).to_vec(),
        }
    }

    /// Says whether a file may stand in their place.
    fn or_files(self) -> bool {
        self == Self::Scenarios
    }

    /// The name of a shell's function for them.
    fn function(self) -> &'static str {
        match self {
            Self::Scenarios => "_wildfire_scenarios",
            Self::Planners => "_wildfire_planners",
            Self::Columns => "_wildfire_columns",
            Self::Metrics => "_wildfire_metrics",
            Self::Settings => "_wildfire_settings",
            Self::Choices => "_wildfire_choices",
            Self::Divisions => "_wildfire_divisions",
        }
    }

    /// A hint that no argument has, and what the script for zsh makes of it: a mark for where the function goes.
    fn mark(self) -> (ValueHint, &'static str) {
        match self {
            Self::Scenarios => (ValueHint::Hostname, ":_hosts"),
            Self::Planners => (ValueHint::Username, ":_users"),
            Self::Columns => (ValueHint::Url, ":_urls"),
            Self::Metrics => (ValueHint::EmailAddress, ":_email_addresses"),
            Self::Settings => (ValueHint::CommandName, ":_command_names -e"),
            Self::Choices => (ValueHint::CommandString, ":_cmdstring"),
            Self::Divisions => (ValueHint::ExecutablePath, ":_absolute_command_paths"),
        }
    }
}

fn planner_names() -> Vec<String> {
    TruckPlannerKind::ALL.map(|kind| kind.name().to_owned()).to_vec()
}

fn with_key(key: &str, names: &[impl Display]) -> Vec<String> {
    names.iter().map(|name| format!("{key}={name}")).collect()
}

fn scenario_names() -> Vec<String> {
    BUILT_IN.iter().map(|(name, _)| (*name).to_owned()).collect::<Vec<_>>()
}

/// Returns the script that completes the program's arguments in a shell.
pub fn script(shell: Shell, program: Command) -> String {
    match shell {
        Shell::Bash => bash(program),
        Shell::Zsh => zsh(program),
        Shell::Fish => fish(program),
        _ => generated(shell, program),
    }
}

fn generated(shell: Shell, mut program: Command) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut program, "wildfire", &mut script);
    String::from_utf8(script).expect("scripts are text")
}

/// Lists the arguments of each command that take names.
fn takers(program: &Command) -> Vec<(&str, &Arg, Names)> {
    let commands = program.get_subcommands();
    let of_one = commands.flat_map(|command| {
        let name = command.get_name();
        command.get_arguments().filter_map(move |argument| Some((name, argument, Names::of_argument(name, argument)?)))
    });
    of_one.collect()
}

/// Joins the ways to write an option of a command: `batch,--seeds|batch,-s`.
fn patterns(command: &str, option: &Arg) -> String {
    let long = option.get_long().map(|long| format!("{command},--{long}"));
    let short = option.get_short().map(|short| format!("{command},-{short}"));
    long.into_iter().chain(short).collect::<Vec<_>>().join("|")
}

/// The script of `clap` behind a function that is asked first, and takes what it has names for.
fn bash(program: Command) -> String {
    let mut cases = String::new();
    for (command, argument, names) in takers(&program).into_iter().filter(|(_, argument, _)| !argument.is_positional())
    {
        let list = if argument.get_value_delimiter() == Some(',') { " is_list=1" } else { "" };
        let files = if names.or_files() { " has_files=1" } else { "" };
        let candidates = names.candidates().join(" ");
        let patterns = patterns(command, argument);
        writeln!(cases, "        {patterns}) names=\"{candidates}\"{list}{files} ;;").expect("a string takes any text");
    }
    for (command, _, names) in takers(&program).into_iter().filter(|(_, argument, _)| argument.is_positional()) {
        let subcommand = program.find_subcommand(command).expect("it was listed");
        let options = subcommand.get_opts().filter(|option| option.get_action().takes_values());
        let options = options.map(|option| patterns(command, option)).collect::<Vec<_>>().join("|");
        let candidates = names.candidates().join(" ");
        // These come before the positional argument, or the value of an option would be completed as one.
        writeln!(cases, "        {options}) return 1 ;;").expect("a string takes any text");
        writeln!(cases, "        {command},*) [[ $value == -* ]] && return 1; names=\"{candidates}\" has_files=1 ;;")
            .expect("a string takes any text");
    }
    let functions = BASH.replace("CASES", cases.trim_end());
    let script = generated(Shell::Bash, program);
    let registered = "complete -F _wildfire ";
    // If clap names its function differently one day, completion would be lost without a word.
    assert!(script.contains(registered), "the script registers its function");
    functions + &script.replace(registered, "complete -F _wildfire_with_names ")
}

/// Where `=` parts words, as it does unless somebody changed that, the shell replaces what is behind it only.
const BASH: &str = r#"_wildfire_names() {
    local line="${COMP_LINE:0:COMP_POINT}" command= option value kept= before_value broken= word names= is_list= has_files=
    local typed="${line##*[[:space:]]}"
    local -a before
    read -ra before <<< "${line%"$typed"}"
    for word in "${before[@]:1}"; do
        if [[ $word != -* ]]; then
            command="$word"
            break
        fi
    done
    [[ -z $command ]] && return 1
    option="${before[${#before[@]}-1]}" value="$typed"
    if [[ $typed == --*=* ]]; then
        option="${typed%%=*}" value="${typed#*=}"
    fi
    before_value="${typed%"$value"}"
    case "$command,$option" in
CASES
        *) return 1 ;;
    esac
    if [[ -n $is_list && $value == *,* ]]; then
        kept="${value%,*}," value="${value##*,}"
    fi
    if [[ $COMP_WORDBREAKS == *=* && $typed == *=* ]]; then
        broken="${typed%=*}="
    fi
    COMPREPLY=()
    while IFS= read -r word; do
        word="$before_value$kept$word"
        COMPREPLY+=("${word#"$broken"}")
    done < <(compgen -W "$names" -- "$value"; [[ -n $has_files ]] && compgen -f -- "$value")
    return 0
}

_wildfire_with_names() {
    _wildfire_names || _wildfire "$@"
}

"#;

/// The script of `clap` with functions of ours where an argument takes names.
fn zsh(program: Command) -> String {
    let commands: Vec<String> = program.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    let program = commands.iter().fold(program, |program, name| program.mut_subcommand(name, marked));
    let mut script = generated(Shell::Zsh, program);
    let mut functions = String::new();
    for names in Names::ALL {
        script = script.replace(names.mark().1, &format!(":{}", names.function()));
        let files = if names.or_files() { "    _files\n" } else { "" };
        let candidates = names.candidates().join(" ");
        write!(functions, "{}() {{\n    compset -P '*,'\n    compadd -- {candidates}\n{files}}}\n\n", names.function())
            .expect("a string takes any text");
    }
    // Functions must be defined before the script calls its own at its end.
    let end = script.find("if [ \"$funcstack[1]\"").expect("the script registers its function at its end");
    script.insert_str(end, &functions);
    script
}

fn marked(command: Command) -> Command {
    let name = command.get_name().to_owned();
    command.mut_args(|argument| match Names::of_argument(&name, &argument) {
        Some(names) => argument.value_hint(names.mark().0),
        None => argument,
    })
}

/// The script of `clap`, and more lines for arguments that take names.
fn fish(program: Command) -> String {
    let mut lines = String::new();
    for names in Names::ALL {
        let candidates = names.candidates().join(" ");
        write!(lines, "\nfunction {}\n    printf '%s\\n' {candidates}\nend\n", names.function())
            .expect("a string takes any text");
    }
    lines.push('\n');
    for (command, argument, names) in takers(&program) {
        let of = argument.get_long().map_or_else(String::new, |long| format!(" -l {long} -r"));
        let files = if names.or_files() { " -F" } else { "" };
        let list = if argument.get_value_delimiter() == Some(',') { "__fish_complete_list , " } else { "" };
        let function = names.function();
        writeln!(
            lines,
            "complete -c wildfire -n \"__fish_wildfire_using_subcommand {command}\"{of}{files} -a \"({list}{function})\""
        )
        .expect("a string takes any text");
    }
    generated(Shell::Fish, program) + &lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli;

    #[test]
    fn names_of_every_kind_are_taken_somewhere_and_need_no_quotes() {
        let program = cli::program();
        let takers = takers(&program);
        for names in Names::ALL {
            assert!(takers.iter().any(|(_, _, taken)| *taken == names), "{names:?}");
            let candidates = names.candidates();
            assert!(candidates.len() > 2, "{candidates:?}");
            let is_plain = |word: &String| word.chars().all(|c| c.is_ascii_alphanumeric() || "-_+.=".contains(c));
            assert!(candidates.iter().all(is_plain), "{candidates:?}");
        }
        for (command, option) in [("batch", "planner"), ("plan", "planner"), ("judge", "against"), ("plan", "scenario")]
        {
            let takes = |taker: &&(&str, &Arg, Names)| taker.0 == command && taker.1.get_long() == Some(option);
            assert!(takers.iter().any(|taker| takes(&taker)), "{command} --{option}");
        }
    }

    #[test]
    fn marks_are_hints_that_no_argument_has() {
        let plain = generated(Shell::Zsh, cli::program());
        let script = script(Shell::Zsh, cli::program());
        for names in Names::ALL {
            assert!(!plain.contains(names.mark().1), "{}", names.mark().1);
            assert!(!script.contains(names.mark().1), "{}", names.mark().1);
            assert!(script.contains(&format!(":{}'", names.function())), "{names:?}");
        }
    }
}
