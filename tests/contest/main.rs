//! Whole runs: the rules that they keep, the planners and policies that play them, and the scenarios that set them.

#[path = "../shared/reference.rs"]
mod reference;

mod arena;
mod audit;
mod audit_damage;
mod clairvoyant;
mod collision;
mod contest_audit;
mod dispatch_rules;
mod fuzzers;
mod gate;
mod learned;
mod line;
mod original;
mod own_planners;
mod pose_planners;
mod problem_files;
mod recordings;
mod roads;
mod safety;
mod same_planner;
mod scenario_bad_input;
mod scenario_presets;
mod scenario_zero;
mod searches;
mod settings_audit;
mod simulation;
mod team;
mod traffic;
mod water;
