//! What the commands print that need no simulation.

use crate::children::output_of;
use crate::story::{Answer, LARGE, Story, widest};
use wildfire::scenario::BUILT_IN;

#[test]
fn help_has_examples_and_exit_codes() {
    let answer = Story::begin().tell(&["--help"]).expect_code(0);
    for word in ["wildfire batch contest --seeds 1..1000", "Exit codes", "--quiet", "--version"] {
        assert!(answer.stdout.contains(word), "`{word}` is missing:\n{}", answer.stdout);
    }
    for command in ["run", "batch"] {
        let answer = Story::begin().tell(&[command, "--help"]).expect_code(0);
        assert!(answer.stdout.contains("Examples:"), "{}", answer.stdout);
    }
}

#[test]
fn help_fills_eighty_columns_and_breaks_no_example() {
    let story = Story::begin();
    let help = |arguments: &[&str]| {
        let output = output_of(story.command(&[arguments, &["--help"]].concat()).env("COLUMNS", "80"));
        Answer::of(&output).expect_code(0).stdout
    };
    let commands = ["occupancy", "brushfire", "cost", "wavefront", "attraction", "repulsion", "total", "descend"];
    for command in commands.into_iter().chain(["timing"]) {
        let text = help(&["map", command]);
        let (_, explained) = text.split_once("\nArguments:").expect("a map is an argument");
        assert!(widest(explained) <= 80, "{text}");
        let (prose, examples) = text.split_once("\nExample").expect("there are examples");
        let is_whole = |line: &str| line.starts_with("  wildfire map ") || line.starts_with("    --");
        assert!(examples.lines().skip(1).all(is_whole), "{text}");
        let explanation: Vec<_> = prose.lines().skip_while(|line| *line != "Output:").collect();
        for pair in explanation.windows(2).filter(|pair| pair.iter().all(|line| line.starts_with(|c| c != ' '))) {
            let next = pair[1].split(' ').next().expect("the line is not empty");
            assert!(pair[0].len() + 1 + next.len() > 80, "`{}` is broken too early", pair[0]);
        }
    }
}

#[test]
fn version_is_the_package_version() {
    let answer = Story::begin().tell(&["-V"]).expect_code(0);
    assert_eq!(answer.stdout, concat!("wildfire ", env!("CARGO_PKG_VERSION"), "\n"));
    let long = Story::begin().tell(&["--version"]).expect_code(0).stdout;
    assert!(long.starts_with(answer.stdout.as_str()), "{long}");
    let begins: Vec<&str> =
        long.lines().skip(1).filter_map(|line| line.split_once(": ")).map(|(name, _)| name).collect();
    assert_eq!(begins, ["commit", "compiler", "target"], "{long}");
}

#[test]
fn no_command_is_bad_input_that_shows_the_commands() {
    Story::begin().tell(&[]).expect_code(2).expect_complaint(&["run", "batch", "check", "scenarios"]);
}

#[test]
fn built_in_scenarios_are_listed_with_their_purpose() {
    let answer = Story::begin().tell(&["scenarios"]).expect_code(0);
    let named = |line: &&str| !line.starts_with(' ');
    let purposes: Vec<_> = answer.stdout.lines().filter(named).map(|line| line.split_once("  ")).collect();
    assert_eq!(purposes.len(), BUILT_IN.len());
    for (purpose, (name, _)) in purposes.into_iter().zip(BUILT_IN) {
        let (listed, purpose) = purpose.unwrap_or_else(|| panic!("{name} does not say what it is for"));
        assert_eq!(listed, *name);
        assert!(!purpose.trim().is_empty(), "{name} does not say what it is for");
    }
    assert!(widest(&answer.stdout) <= 80, "{}", answer.stdout);
}

#[test]
fn a_scenario_fits_on_a_screen_and_names_the_command_that_prints_all() {
    let story = Story::begin();
    for (name, _) in BUILT_IN.iter().filter(|(name, _)| !LARGE.contains(name)) {
        for (command, all) in
            [(["scenarios", "--show", name].as_slice(), "--all > my.toml"), (&["check", name], "--all")]
        {
            let shown = story.tell(command).expect_code(0).stdout;
            assert!(shown.contains("duration_s=") && shown.contains(all), "{shown}");
            assert!(shown.lines().count() <= 50, "{name}: {} lines\n{shown}", shown.lines().count());
        }
    }
    story.tell(&["new", "scenario", "mine.toml"]).expect_code(0);
    assert!(story.read("mine.toml").lines().count() <= 26);
    story.tell(&["scenarios", "--all"]).expect_code(2).expect_complaint(&["--show"]);
}

/// Checks the headings on the pages of a command and of those within it.
fn check_headings(command: &mut clap::Command, seen: &mut usize) {
    const ORDER: [&str; 7] = ["Input:", "Selection:", "Limits:", "Programs:", "Output:", "Papers:", "General:"];
    let help = command.render_help().to_string();
    let places: Vec<_> = ORDER.iter().filter_map(|name| help.find(&format!("\n{name}\n"))).collect();
    assert!(places.is_sorted(), "{help}");
    let (_, last) = help.rsplit_once("\nGeneral:\n").expect("every command has help");
    let last: Vec<&str> = last
        .lines()
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  -")?.get(..1))
        .collect();
    assert!(last == ["q", "h"] || last == ["j", "q", "h"], "{help}");
    *seen += 1;
    let parts = command.get_subcommands_mut().filter(|part| part.get_name() != "help");
    parts.for_each(|part| check_headings(part, seen));
}

#[test]
fn pages_of_help_have_the_same_headings_in_the_same_order() {
    let mut program = wildfire::cli::program();
    program.build();
    let mut seen = 0;
    let parts = program.get_subcommands_mut().filter(|part| part.get_name() != "help");
    parts.for_each(|part| check_headings(part, &mut seen));
    assert!(seen > 60, "{seen} commands");
}

#[test]
fn a_format_has_one_option_and_an_earlier_flag() {
    let story = Story::begin();
    for format in ["json", "md", "html", "tex"] {
        let [one, other] =
            [["--format", format].map(str::to_owned).to_vec(), vec![format!("--{format}")]].map(|option| {
                let option: Vec<&str> = option.iter().map(String::as_str).collect();
                story.tell(&[&["scenarios"], &option[..]].concat()).expect_code(0).stdout
            });
        assert_eq!(one, other, "{format}");
    }
    assert_eq!(story.tell(&["scenarios", "--format", "text"]).stdout, story.tell(&["scenarios"]).stdout);
    for (wrong, fragments) in [
        (&["scenarios", "--format", "csv"][..], &["text, json, md, html, tex"][..]),
        (&["scenarios", "--format", "md", "--json"], &["--format", "--json", "cannot be used with"]),
        (&["cite", "--format", "md"], &["bibtex, json"]),
        (&["batch", "smoke", "--profile", "--format", "json"], &["--profile", "json"]),
    ] {
        story.tell(wrong).expect_code(2).expect_complaint(fragments);
    }
}

#[test]
fn mistakes_of_beginners_are_answered_with_what_to_do() {
    let story = Story::begin();
    story.file("plan.toml", "scenarios = [\"smoke\"]\n");
    for (line, advice) in [
        ("simulate", "`wildfire run`"),
        ("lesson", "`wildfire lessons`"),
        ("game", "`wildfire page`"),
        ("rnu", "`wildfire run`"),
        ("run --duration 10m", "--set duration_s=600"),
        ("run -v", "wildfire --version"),
        ("-v", "wildfire --version"),
        ("run --planner prm-rs", "--set unimog.planner=NAME"),
        ("map brushfire map.png --threshold 40", "--tolerance"),
        ("batch smoke -n 100", "--seeds 1..20"),
        ("plan --planner astar", "did you mean `hybrid-astar`?"),
        ("run --set unimog.planner=astar", "did you mean `hybrid-astar`?"),
        ("run --seed 1..5", "`wildfire batch --seeds"),
        ("run --seeds 1..5", "`wildfire batch --seeds"),
        ("check plan.toml", "`wildfire batch FILE`"),
        ("scenarios contest", "`wildfire scenarios --show NAME`"),
        ("report nowhere", "`wildfire batch` makes such a folder"),
    ] {
        let args: Vec<&str> = line.split(' ').collect();
        story.tell(&args).expect_code(2).expect_complaint(&[advice]);
    }
    assert!(story.tell(&["run", "smoke", "--seeds", "7"]).expect_code(0).stdout.starts_with("smoke, seed 7: "));
    assert!(story.tell(&["help", "why"]).expect_code(0).stdout.contains("wildfire why"));
}

#[test]
fn shown_scenario_is_its_file_and_passes_the_check_as_one() {
    check_shown(|name| !LARGE.contains(&name));
}

#[test]
#[ignore = "tier 2: what a check of a large preset measures takes long"]
fn shown_large_scenario_is_its_file_and_passes_the_check_as_one() {
    check_shown(|name| LARGE.contains(&name));
}

fn check_shown(is_selected: fn(&str) -> bool) {
    let story = Story::begin();
    for (name, text) in BUILT_IN.iter().filter(|(name, _)| is_selected(name)) {
        let shown = story.tell(&["scenarios", "--show", name, "--all"]).expect_code(0).stdout;
        assert_eq!(shown, *text);
        story.file("mine.toml", &shown);
        let checked = story.tell(&["check", "mine.toml"]).expect_code(0);
        assert!(!checked.stdout.is_empty());
    }
}

#[test]
fn check_takes_changes_and_fits_a_terminal() {
    let story = Story::begin();
    let answer = story.tell(&["check", "contest", "--set", "fire.burn_out_s=33"]).expect_code(0);
    assert!(answer.stdout.contains("33"), "{}", answer.stdout);
    assert!(widest(&answer.stdout) <= 100, "{}", answer.stdout);
}

#[test]
fn check_draws_the_first_truck_with_its_dimensions() {
    let story = Story::begin();
    let longer = ["check", "contest", "--set", "unimog.vehicle.length_m=6.5", "--sketch", "truck.svg"];
    story.tell(&longer).expect_code(0);
    let svg = story.read("truck.svg");
    assert!(svg.starts_with("<svg") && svg.contains("length = 6.5 m") && svg.contains("turning centre"), "{svg}");
    story.tell(&["check", "contest", "--sketch", "truck.png"]).expect_code(0);
    assert!(std::fs::read(story.path("truck.png")).expect("it was written").starts_with(b"\x89PNG"));
    story
        .tell(&["check", "wumpus-alone", "--sketch", "x.svg"])
        .expect_code(2)
        .expect_complaint(&["a scenario with a truck"]);
    story.tell(&["check", "contest", "--sketch", "x.pdf"]).expect_code(2).expect_complaint(&[".svg or .png"]);
}

#[test]
fn completions_are_scripts_of_their_shells() {
    let story = Story::begin();
    for (shell, mark) in
        [("bash", "complete -F _wildfire"), ("zsh", "#compdef wildfire"), ("fish", "complete -c wildfire")]
    {
        let script = story.tell(&["completions", shell]).expect_code(0).stdout;
        assert!(script.contains(mark), "{shell}");
    }
    story.tell(&["completions", "cmd"]).expect_code(2).expect_complaint(&["bash"]);
}
