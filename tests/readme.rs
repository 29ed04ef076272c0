//! What the README says is so.

use wildfire::batch::{AGENT_COLUMNS, RUN_COLUMNS};
use wildfire::picture::film::{BINDINGS, Layer};
use wildfire::scenario::BUILT_IN;

const README: &str = include_str!("../README.md");

#[test]
fn every_column_is_explained() {
    let runs = RUN_COLUMNS.iter().map(|column| column.name);
    let agents = AGENT_COLUMNS.iter().map(|column| column.name);
    let missing: Vec<_> = runs.chain(agents).filter(|name| !README.contains(&format!("`{name}`"))).collect();
    assert!(missing.is_empty(), "the README does not explain {missing:?}");
}

#[test]
fn every_built_in_scenario_is_named() {
    let missing: Vec<_> = BUILT_IN.iter().filter(|(name, _)| !README.contains(&format!("`{name}`"))).collect();
    assert!(missing.is_empty(), "the README does not name {missing:?}");
}

#[test]
fn citation_names_this_version() {
    let citation = include_str!("../CITATION.cff");
    assert!(citation.contains(concat!("\nversion: ", env!("CARGO_PKG_VERSION"), "\n")));
}

#[test]
fn every_key_and_layer_is_explained() {
    let keys = BINDINGS.iter().map(|binding| format!("| `{}` | {} |", binding.keys, binding.does));
    let layers = Layer::ALL.into_iter().map(|layer| format!("| `{}` | `{}` |", layer.name(), layer.key()));
    let missing: Vec<_> = keys.chain(layers).filter(|row| !README.contains(row)).collect();
    assert!(missing.is_empty(), "the README does not have the rows {missing:?}");
}
