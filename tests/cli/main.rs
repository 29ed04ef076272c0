//! The program told to do things from outside, as small stories.

#[path = "../shared/children.rs"]
mod children;
#[path = "../shared/reference.rs"]
mod reference;

mod arena;
mod audit;
#[cfg(unix)]
mod batch_cluster;
mod batch_folder;
mod batch_kill;
mod batch_plans;
mod commands;
mod compare;
mod completion;
mod contest;
mod course;
mod curve;
mod curve_pairs;
mod decisions;
mod demo;
mod english;
mod errors;
mod export;
mod files_named;
mod fire;
mod front_page;
mod grade;
mod judge;
mod layers;
mod map_answers;
mod map_errors;
mod map_files;
mod map_of;
mod memory;
mod minus_zero;
mod page;
mod paper;
mod pipes;
mod plan;
mod plan_benchmark;
mod plan_ompl;
mod rank;
mod readme;
mod render;
mod report;
#[cfg(target_os = "linux")]
mod signals;
mod stability;
mod story;
mod together;
mod untrusted;
