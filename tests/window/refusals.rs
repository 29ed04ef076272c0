//! Where there is no display or nothing to draw with, one sentence says what to install, and the program ends.

use std::process::Command;

use crate::display::{hands, program};

/// What is said on stderr by a program that ends with that code, wrapped lines put together.
fn stderr(command: &mut Command, code: i32) -> String {
    let output = command.output().expect("it starts");
    let stderr = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(!stderr.contains("panic") && !stderr.contains("RUST_BACKTRACE"), "{stderr}");
    stderr
}

fn play(folder: &tempfile::TempDir) -> Command {
    let mut command = program(folder.path());
    command.args(["play", "smoke"]).env_remove("WAYLAND_DISPLAY").env_remove("DISPLAY");
    command
}

#[test]
fn missing_display_is_a_sentence() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let stderr = stderr(&mut play(&folder), 3);
    assert!(stderr.contains("there is no display") && stderr.contains("apt-get install"), "{stderr}");
}

#[test]
fn display_of_another_kind_is_a_sentence() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let stderr = stderr(play(&folder).env("WAYLAND_DISPLAY", "wayland-0"), 3);
    assert!(stderr.contains("XWayland"), "{stderr}");
}

#[test]
fn missing_adapter_is_a_sentence() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let nowhere = folder.path().join("nowhere.json");
    let mut command = play(&folder);
    command.env("DISPLAY", ":0").env("VK_ICD_FILENAMES", &nowhere).env("VK_DRIVER_FILES", &nowhere);
    let stderr = stderr(&mut command, 3);
    assert!(stderr.contains("mesa-vulkan-drivers"), "{stderr}");
}

#[test]
fn display_that_does_not_answer_is_a_sentence() {
    // Without an adapter that would be said first.
    let Some(_hands) = hands() else { return };
    let folder = tempfile::tempdir().expect("a scratch folder");
    let stderr = stderr(play(&folder).env("DISPLAY", ":9731"), 3);
    assert!(stderr.contains("the display :9731 does not answer"), "{stderr}");
}

#[test]
fn no_window_is_opened_for_what_is_no_recording() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    std::fs::write(folder.path().join("torn.wildfire"), "WILDFIRE").expect("writable");
    let mut command = program(folder.path());
    command.args(["play", "torn.wildfire"]).env_remove("DISPLAY");
    assert!(stderr(&mut command, 2).contains("torn.wildfire"));
}
