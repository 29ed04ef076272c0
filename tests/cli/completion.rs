//! What bash offers with the program's script: names where arguments take names, and files beside them.

use std::process::Command;

use crate::children::{command, output_of};
use crate::story::Story;

/// Says what bash does with a line that ends where the key is pressed.
const ASK: &str = r#"
source ./script
complete -p wildfire >&2
COMP_LINE=$1 COMP_POINT=${#1}
read -ra COMP_WORDS <<< "$1"
[[ $1 == *' ' ]] && COMP_WORDS+=("")
COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
COMP_WORDBREAKS=$' \t\n"\'><=;|&(:'
_wildfire_with_names wildfire "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
printf '%s\n' "${COMPREPLY[@]}"
"#;

/// A folder with the script and some files; none without bash.
fn story() -> Option<Story> {
    Command::new("bash").arg("--version").output().ok()?;
    let story = Story::begin();
    story.file("script", &story.tell(&["completions", "bash"]).expect_code(0).stdout);
    story.file("condition.toml", "");
    Some(story)
}

fn offered(story: &Story, line: &str) -> Vec<String> {
    let output = output_of(command("bash").args(["-c", ASK, "bash", line]).current_dir(story.path("")));
    let complaints = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(complaints.contains("-F _wildfire_with_names wildfire"), "{complaints}");
    assert_eq!(complaints.lines().count(), 1, "{complaints}");
    let offered = String::from_utf8_lossy(&output.stdout).into_owned();
    offered.lines().filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

#[test]
fn bash_offers_names_of_scenarios_planners_policies_and_columns() {
    let Some(story) = story() else { return };
    for (line, expected) in [
        ("wildfire run cont", &["contest", "contest-1"][..]),
        ("wildfire run --seed 3 smo", &["smoke"]),
        ("wildfire plan --scenario smo", &["smoke"]),
        ("wildfire scenarios --show smo", &["smoke"]),
        ("wildfire batch --planner prm", &["prm+primitives", "prm-rs"]),
        ("wildfire batch --planner prm-rs,hyb", &["prm-rs,hybrid-astar"]),
        ("wildfire judge --against hyb", &["hybrid-astar"]),
        ("wildfire -q batch --planner hyb", &["hybrid-astar"]),
        // Behind `=` the shell takes a word of its own, of which alone it replaces what was typed.
        ("wildfire batch --planner=hyb", &["hybrid-astar"]),
        ("wildfire run --set dispatch.policy=hun", &["hungarian"]),
        ("wildfire run --set unimog.goal=old", &["oldest"]),
        ("wildfire run --set dispatch.idle=", &["stay", "centroids", "regions", "learned"]),
        ("wildfire report --metric truck_cu", &["truck_cusps"]),
        ("wildfire compare a b --metric saved,truck_cu", &["saved,truck_cusps"]),
        ("wildfire compare a b --metric sav", &["saved"]),
        ("wildfire rank a --where planner=hyb", &["hybrid-astar"]),
        ("wildfire compare a --by pl", &["planner"]),
    ] {
        let mut offered = offered(&story, line);
        offered.sort();
        let mut expected = expected.to_vec();
        expected.sort_unstable();
        assert_eq!(offered, expected, "{line}");
    }
}

#[test]
fn bash_offers_files_where_a_scenario_may_be_one_and_options_as_before() {
    let Some(story) = story() else { return };
    assert_eq!(offered(&story, "wildfire check cond"), ["condition.toml"]);
    assert_eq!(offered(&story, "wildfire check --set fire.x=1 ./cond"), ["./condition.toml"]);
    let both = offered(&story, "wildfire run con");
    assert!(["contest", "condition.toml"].iter().all(|name| both.iter().any(|word| word == name)), "{both:?}");
    assert_eq!(offered(&story, "wildfire run --rec"), ["--record-searches"]);
    assert!(offered(&story, "wildfire re").contains(&"report".to_owned()));
    assert!(offered(&story, "wildfire run --set nothing.like=").is_empty());
}

#[test]
fn scripts_of_other_shells_have_the_names_too() {
    let story = Story::begin();
    for (shell, calls) in [
        ("zsh", [":_wildfire_planners'", "_wildfire_scenarios() {", "compadd -- saved "]),
        (
            "fish",
            [
                "-l planner -r -a \"(__fish_complete_list , _wildfire_planners)\"",
                "function _wildfire_scenarios",
                "-F -a",
            ],
        ),
    ] {
        let script = story.tell(&["completions", shell]).expect_code(0).stdout;
        for call in calls {
            assert!(script.contains(call), "{shell}: {call}");
        }
        for name in ["brigade", "hybrid-astar", "dispatch.policy=hungarian", "truck_cusps"] {
            assert!(script.contains(name), "{shell}: {name}");
        }
    }
}
