//! Command lines that nobody would write, drawn from the arguments as clap knows them, so that new ones are covered.

use std::ffi::OsString;

use clap::Command as ClapCommand;

use super::fuzz::text::mutated;
use super::fuzz::{Case, Fuzzer, Law, below, one_of};
use super::phrases::phrase;
use super::{Command, parse, program};

#[test]
fn command_lines_take_anything() {
    Fuzzer { name: "command_lines", target: "--lib", law: command_line }.run(1000);
}

fn command_line(case: &mut Case<'_>) -> Law {
    let args = drawn_args(case, &[]);
    let name = args.first().cloned().unwrap_or_default();
    parsed(case, &name, args.into_iter().skip(1).collect())?;
    Ok(())
}

/// Parses `wildfire COMMAND WORDS...` with clap; `None` if clap refuses it, which it does with a message.
pub fn parsed(case: &mut Case<'_>, command: &str, args: Vec<String>) -> Result<Option<Command>, String> {
    let line = [vec!["wildfire".to_owned(), command.to_owned()], args].concat();
    case.input = line.join("\n").into_bytes();
    match parse(&line.iter().map(OsString::from).collect::<Vec<_>>()) {
        Ok(arguments) => {
            case.count("command lines accepted");
            Ok(Some(arguments.command))
        }
        Err(refusal) if matches!(refusal.exit_code(), 0 | 2) => {
            check_message(&refusal.render().to_string()).map(|()| None)
        }
        Err(refusal) => Err(format!("it ends with {}: {refusal}", refusal.exit_code())),
    }
}

/// Checks that something is said.
pub fn check_message(text: &str) -> Law {
    if text.trim().is_empty() { Err("it is empty".into()) } else { Ok(()) }
}

/// Draws arguments of some command below these, whose own names are left out.
pub fn drawn_args(case: &mut Case<'_>, names: &[&str]) -> Vec<String> {
    let mut root = program();
    root.build();
    let mut command = &root;
    for name in names {
        command = command.find_subcommand(name).expect("it is a command");
    }
    let mut args = Vec::new();
    // Some commands do something by themselves too.
    while command.has_subcommands() && (command.is_subcommand_required_set() || case.chance(30)) {
        let commands: Vec<&ClapCommand> = command.get_subcommands().collect();
        command = *one_of(&mut case.dice, &commands);
        args.push(command.get_name().to_owned());
    }
    let arguments: Vec<_> = command.get_arguments().collect();
    let needed = arguments.iter().filter(|argument| argument.is_required_set() || argument.is_positional());
    let mut drawn: Vec<_> = if case.chance(80) { needed.copied().collect() } else { Vec::new() };
    let more = if arguments.is_empty() { 0 } else { below(&mut case.dice, 5) };
    for _ in 0..more {
        drawn.push(*one_of(&mut case.dice, &arguments));
    }
    for argument in drawn {
        let takes_value = argument.get_action().takes_values();
        let value = if takes_value { value(case, argument) } else { String::new() };
        match (argument.get_long(), takes_value) {
            (Some(name), true) if case.chance(50) => args.push(format!("--{name}={value}")),
            (Some(name), true) => args.extend([format!("--{name}"), value]),
            (Some(name), false) => args.push(format!("--{name}")),
            (None, _) => args.push(value),
        }
    }
    args
}

fn value(case: &mut Case<'_>, argument: &clap::Arg) -> String {
    let possible: Vec<String> =
        argument.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
    let defaults: Vec<String> =
        argument.get_default_values().iter().map(|value| value.to_string_lossy().into_owned()).collect();
    match below(&mut case.dice, 8) {
        0..=3 if !possible.is_empty() => one_of(&mut case.dice, &possible).clone(),
        0..=2 => (*one_of(&mut case.dice, VALUES)).to_owned(),
        3 | 4 if !defaults.is_empty() => {
            String::from_utf8_lossy(&mutated(&mut case.dice, &defaults, VALUES)).into_owned()
        }
        5 if argument.get_id() == "seeds" => {
            let seeds = mutated(&mut case.dice, &["1..3, 7\n9 8 # two\n"], &["..", ",", "#"]);
            format!("@{}", case.write("seeds", &seeds).display())
        }
        6 => String::from_utf8_lossy(&mutated(&mut case.dice, VALUES, &[])).into_owned(),
        _ => phrase(&mut case.dice, VALUES),
    }
}

const VALUES: &[&str] = &[
    "1",
    "0",
    "2.5",
    "3,4",
    "0,0,0",
    "20,15,180",
    "1000x1000",
    "unimog/0",
    "wumpus",
    "7,31",
    "120,80",
    "roadmap,-ages",
    "none",
    "1..5",
    "2/5",
    "contest",
    "planner=prm-rs,lattice",
    "unimog.prm.samples=100,200",
    "field.coverage",
    "map.png",
    "-",
    "--",
];
