//! Imports point downwards: this reads the sources and fails on a forbidden one, with the reason.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The layers, lowest first, with the external crates that are at home in each.
///
/// A layer may use itself and those before it, but for the exceptions below.
const LAYERS: &[(&str, &[&str])] = &[
    ("time", &["cpu_time"]),
    ("geometry", &["glam", "libm"]),
    ("rng", &["rand"]),
    ("event_queue", &[]),
    ("input_file", &[]),
    ("or_none", &["serde_json"]),
    ("ranges", &[]),
    ("untrusted", &[]),
    ("whole_file", &[]),
    ("document", &["data_encoding"]),
    ("grid", &[]),
    ("map_files", &["crc32fast", "gif", "image", "miniz_oxide", "ruzstd", "saphyr_parser", "tiff"]),
    ("vehicle", &["glam"]),
    ("trajectory", &["glam"]),
    ("collision", &["glam"]),
    // Settings of planners that are not built in are handed on as JSON.
    ("planning", &["glam", "kiddo", "petgraph", "serde_json"]),
    ("fire", &["glam"]),
    // A scenario's errors know their place in the file and show it.
    (
        "scenario",
        &[
            "data_encoding",
            "glam",
            "miniz_oxide",
            "toml",
            "toml_parser",
            "serde_json",
            "serde_path_to_error",
            "sha2",
            "strsim",
            "annotate_snippets",
        ],
    ),
    ("timeline", &["glam", "csv", "crc32fast", "miniz_oxide", "postcard", "serde_json"]),
    (
        "picture",
        &[
            "colorous",
            "crc32fast",
            "data_encoding",
            "gif",
            "glam",
            "image",
            "lz4_flex",
            "miniz_oxide",
            "pdf_writer",
            "serde_json",
            "skrifa",
            "tiny_skia",
        ],
    ),
    ("audit", &["glam", "rapier2d"]),
    ("sim", &["glam", "bevy", "serde_json"]),
    // Processes and what they cost are the system's to tell.
    ("programs", &["glam", "nix", "serde_json", "serde_path_to_error", "sha2", "signal_hook"]),
    ("stats", &["statrs"]),
    // What a batch worked on is the system's to tell.
    ("batch", &["crc32fast", "csv", "nix", "parquet", "rayon", "serde_json", "sha2", "toml"]),
    ("view", &["bevy", "glam"]),
    (
        "cli",
        &[
            "annotate_snippets",
            "anstream",
            "chrono",
            "clap",
            "clap_complete",
            "clap_mangen",
            "csv",
            "glam",
            "indicatif",
            "serde_json",
            "signal_hook",
            "terminal_size",
            "toml",
        ],
    ),
];

/// Layers that stand lower and may not be used all the same.
const EXCEPTIONS: &[(&str, &[&str], &str)] = &[
    ("view", &["sim", "batch"], "a window reads timelines; nothing in it can change an outcome"),
    ("audit", &["collision", "planning"], "a second opinion shares no code with what it judges"),
];

/// Rooms of a layer, which import each other one way: the layer, the room, the rooms that it may use, and why no others.
const ROOMS: &[(&str, &str, &[&str], &str)] = &[
    ("batch", "plan", &[], "which runs there are is known before the first of them"),
    ("batch", "execute", &["plan"], "a run leaves its numbers in a journal, whatever is made of them later"),
    ("batch", "table", &["plan", "execute"], "tables are read by other tools too, which have no use for reports"),
    (
        "batch",
        "report",
        &["plan", "execute", "table", "comparison"],
        "what a report says of one batch has the differences of a comparison, by the same engine",
    ),
    ("batch", "maps", &["plan", "execute", "table"], "maps are of runs, which are read or made again, not of reports"),
    (
        "batch",
        "drives",
        &["plan", "table", "comparison"],
        "drives are planned outside of runs; their rows are written and compared like those of runs",
    ),
    (
        "batch",
        "comparison",
        &["plan", "execute", "table"],
        "it reads batches of any version of the program, a report those of this one",
    ),
];

/// Layers whose names are all in rooms, so that files in them are imported by their room.
const LAYERS_OF_ROOMS: &[&str] = &["batch"];

/// Crates that are at home anywhere: derives and traits of the vocabulary.
const ANYWHERE: &[&str] = &["rand", "schemars", "serde", "thiserror"];

/// A path in the sources: where it stands and what it names.
struct Import {
    place: String,
    layer: String,
    target: String,
    /// Whether it serves the tests at the end of the file only.
    in_tests: bool,
}

fn rank(layer: &str) -> Option<usize> {
    LAYERS.iter().position(|(name, _)| *name == layer)
}

/// Why `layer` may not use the layer `target`.
fn objection_to_layer(layer: &str, target: &str) -> Option<String> {
    let Some(target_rank) = rank(target) else {
        return Some(format!("`{target}` is no layer; give it a place in the table of layers"));
    };
    let own_rank = rank(layer).expect("files of unknown layers are refused before");
    if target_rank > own_rank {
        return Some(format!("`{target}` stands above `{layer}`: imports point downwards only"));
    }
    let (_, _, reason) = EXCEPTIONS.iter().find(|(user, used, _)| *user == layer && used.contains(&target))?;
    Some((*reason).to_owned())
}

/// Why `layer` may not use the external crate `target`.
fn objection_to_crate(layer: &str, target: &str) -> Option<String> {
    let (_, at_home) = LAYERS.iter().find(|(name, _)| *name == layer)?;
    if at_home.contains(&target) || ANYWHERE.contains(&target) {
        return None;
    }
    let homes: Vec<_> = LAYERS.iter().filter(|(_, crates)| crates.contains(&target)).map(|(name, _)| *name).collect();
    Some(match homes.as_slice() {
        [] => format!("the crate `{target}` has no home; give it one in the table of layers"),
        homes => format!("the crate `{target}` is at home in {} only", homes.join(", ")),
    })
}

/// Why a room of a layer may not use what is called `target` in this layer.
fn objection_to_room(layer: &str, room: &str, target: &str) -> Option<String> {
    let (_, _, used, reason) = ROOMS.iter().find(|(name, own, ..)| *name == layer && *own == room)?;
    let is_room = ROOMS.iter().any(|(name, other, ..)| *name == layer && *other == target);
    if is_room {
        let is_open = target == room || used.contains(&target);
        return (!is_open).then(|| format!("the room `{target}` is not open to `{room}`: {reason}"));
    }
    let is_file = root().join("src").join(layer).join(target).with_extension("rs").exists();
    let hides_its_room = LAYERS_OF_ROOMS.contains(&layer) && !is_file;
    hides_its_room.then(|| format!("`{target}` is imported without its room, which hides the direction"))
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn source_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("src is readable").map(|entry| entry.expect("src is readable").path());
    let mut files = Vec::new();
    for path in entries {
        if path.is_dir() {
            files.extend(source_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// The layer that a file belongs to; `None` of the crate's own two roots, which only bind the layers together.
fn layer_of(file: &Path) -> Option<String> {
    let inside = file.strip_prefix(root().join("src")).expect("the file is under src");
    let first = inside.components().next().expect("a file has a name").as_os_str().to_string_lossy();
    let layer = first.trim_end_matches(".rs").to_owned();
    (layer != "lib" && layer != "main").then_some(layer)
}

/// How often `super::` leads from the top of a file to the root of the crate.
fn depth_of(file: &Path) -> usize {
    let inside = file.strip_prefix(root().join("src")).expect("the file is under src");
    let is_folder_root = inside.file_name().is_some_and(|name| name == "mod.rs");
    inside.components().count() - usize::from(is_folder_root)
}

/// The code of a file without comments, so that links in documentation are no imports.
fn code_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(index, line)| (index + 1, line.split("//").next().unwrap_or_default()))
}

/// Names that follow `start` in `line`, braces of a group included: `crate::{a::B, c}` names `a` and `c`.
fn names_after(line: &str, start: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut rest = line;
    while let Some(at) = rest.find(start) {
        let before = rest[..at].chars().next_back();
        rest = &rest[at + start.len()..];
        if before.is_some_and(|letter| letter.is_alphanumeric() || letter == '_' || letter == '$') {
            continue;
        }
        match rest.strip_prefix('{') {
            Some(group) => names.extend(group_members(group)),
            None => names.push(leading_name(rest)),
        }
    }
    names
}

fn group_members(group: &str) -> Vec<String> {
    let mut depth = 0;
    let mut members = vec![String::new()];
    for letter in group.chars() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => members.push(String::new()),
            _ => {}
        }
        members.last_mut().expect("there is one always").push(letter);
    }
    let names = members.iter().map(|member| leading_name(member.trim_start_matches([',', ' '])));
    names.filter(|name| !name.is_empty()).collect()
}

fn leading_name(text: &str) -> String {
    text.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect()
}

/// Every `use` spread over several lines, joined to the line it begins on.
fn joined_lines(text: &str) -> Vec<(usize, String)> {
    let mut joined: Vec<(usize, String)> = Vec::new();
    for (number, line) in code_lines(text) {
        match joined.last_mut() {
            Some((_, open)) if is_open_use(open) => open.push_str(line.trim()),
            _ => joined.push((number, line.to_owned())),
        }
    }
    joined
}

fn is_open_use(line: &str) -> bool {
    let start = line.trim_start();
    let is_use = ["use ", "pub use ", "pub(crate) use ", "pub(super) use "].iter().any(|word| start.starts_with(word));
    is_use && !line.contains(';')
}

/// What a file in a room names of its layer, with the names of layer and room.
fn room_imports_of(file: &Path) -> Vec<(Import, String)> {
    let Some(layer) = layer_of(file) else { return Vec::new() };
    let inside = file.strip_prefix(root().join("src").join(&layer)).unwrap_or(Path::new(""));
    let Some(room) = inside.parent().and_then(|folder| folder.components().next()) else { return Vec::new() };
    let room = room.as_os_str().to_string_lossy().into_owned();
    let text = fs::read_to_string(file).expect("sources are readable text");
    let shown = file.strip_prefix(root()).expect("the file is in the package").display().to_string();
    let to_the_layer = ["super::".repeat(depth_of(file) - 1), format!("crate::{layer}::")];
    let mut imports = Vec::new();
    for (number, line) in joined_lines(&text) {
        let targets = to_the_layer.iter().flat_map(|start| names_after(&line, start));
        for target in targets.filter(|target| !target.is_empty() && target != "super") {
            let import = Import { place: format!("{shown}:{number}"), layer: layer.clone(), target, in_tests: false };
            imports.push((import, room.clone()));
        }
    }
    imports
}

fn imports_of(file: &Path, starts: &[String]) -> Vec<Import> {
    let Some(layer) = layer_of(file) else { return Vec::new() };
    let text = fs::read_to_string(file).expect("sources are readable text");
    let shown = file.strip_prefix(root()).expect("the file is in the package").display().to_string();
    let to_the_root = "super::".repeat(depth_of(file));
    let mut imports = Vec::new();
    let mut in_tests = false;
    for (number, line) in joined_lines(&text) {
        in_tests |= line.starts_with("#[cfg(test)]");
        let line = match line.strip_prefix("use ").and_then(|path| path.strip_prefix(&to_the_root)) {
            Some(rest) => format!("use crate::{rest}"),
            None => line,
        };
        for start in starts {
            let import = |target| Import { place: format!("{shown}:{number}"), layer: layer.clone(), target, in_tests };
            match start.strip_suffix("::") {
                Some("crate") => imports.extend(names_after(&line, start).into_iter().map(import)),
                Some(name) if !names_after(&line, start).is_empty() => imports.push(import(name.to_owned())),
                _ => {}
            }
        }
    }
    imports
}

fn dependencies() -> Vec<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("the package has a manifest");
    let mut section = "";
    let mut names = Vec::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            section = line;
        } else if section.ends_with("dependencies]") && line.contains('=') {
            let name = line.split(['=', '.']).next().unwrap_or_default().trim();
            names.push(name.replace('-', "_"));
        }
    }
    names
}

fn assert_none(objections: &[String]) {
    assert!(objections.is_empty(), "forbidden imports:\n{}", objections.join("\n"));
}

#[test]
fn every_file_belongs_to_a_layer() {
    let files = source_files(&root().join("src"));
    assert!(files.len() > 10, "the sources were not found");
    let homeless = files.iter().filter(|file| layer_of(file).is_some_and(|layer| rank(&layer).is_none()));
    assert_none(&homeless.map(|file| format!("{}: no layer of this name", file.display())).collect::<Vec<_>>());
}

#[test]
fn layers_use_only_what_stands_below_them() {
    let imports = source_files(&root().join("src")).into_iter().flat_map(|file| imports_of(&file, &["crate::".into()]));
    let objections = imports.filter_map(|import| {
        let reason = objection_to_layer(&import.layer, &import.target)?;
        Some(format!("{}: crate::{}: {reason}", import.place, import.target))
    });
    assert_none(&objections.collect::<Vec<_>>());
}

#[test]
fn rooms_of_a_layer_use_each_other_one_way() {
    let imports = source_files(&root().join("src")).into_iter().flat_map(|file| room_imports_of(&file));
    let objections = imports.filter_map(|(import, room)| {
        let reason = objection_to_room(&import.layer, &room, &import.target)?;
        Some(format!("{}: crate::{}::{}: {reason}", import.place, import.layer, import.target))
    });
    assert_none(&objections.collect::<Vec<_>>());
    for (layer, room, ..) in ROOMS {
        assert!(root().join("src").join(layer).join(room).is_dir(), "{layer} has no room {room}");
    }
}

#[test]
fn external_crates_stay_where_they_are_at_home() {
    let starts: Vec<_> = dependencies().iter().map(|name| format!("{name}::")).collect();
    assert!(starts.len() > 10, "the dependencies were not found");
    let imports = source_files(&root().join("src")).into_iter().flat_map(|file| imports_of(&file, &starts));
    // Tests may compare with whatever gives an independent answer.
    let objections = imports.filter(|import| !import.in_tests).filter_map(|import| {
        let reason = objection_to_crate(&import.layer, &import.target)?;
        Some(format!("{}: {}", import.place, reason))
    });
    assert_none(&objections.collect::<Vec<_>>());
}

#[test]
fn reader_of_imports_sees_every_form_of_them() {
    let text = "use crate::time::SimTime;\nuse crate::{\n    grid::{Grid, flood},\n    sim,\n};\n\
                // use crate::cli;\nlet x = crate::rng::stream(1, \"a\");\nlet y = mycrate::other::f();\n";
    let names: Vec<_> = joined_lines(text).iter().flat_map(|(_, line)| names_after(line, "crate::")).collect();
    assert_eq!(names, ["time", "grid", "sim", "rng"]);
}

#[test]
fn forbidden_imports_are_refused_with_their_reason() {
    assert_eq!(objection_to_layer("sim", "planning"), None);
    assert!(objection_to_layer("planning", "scenario").is_some_and(|reason| reason.contains("downwards")));
    assert!(objection_to_layer("audit", "collision").is_some_and(|reason| reason.contains("second opinion")));
    assert!(objection_to_layer("view", "sim").is_some_and(|reason| reason.contains("timelines")));
    assert_eq!(objection_to_room("batch", "report", "table"), None);
    assert!(objection_to_room("batch", "table", "report").is_some_and(|reason| reason.contains("not open")));
    assert!(objection_to_room("batch", "table", "RunRow").is_some_and(|reason| reason.contains("without its room")));
    assert_eq!(objection_to_crate("sim", "bevy"), None);
    assert_eq!(objection_to_crate("grid", "serde"), None);
    assert!(objection_to_crate("planning", "bevy").is_some_and(|reason| reason.contains("sim, view")));
}

/// The code of a file that is not for its tests.
fn production_code(file: &Path) -> String {
    let text = fs::read_to_string(file).expect("sources are readable text");
    let end = text.find("\n#[cfg(test)]\nmod tests").unwrap_or(text.len());
    text[..end].to_owned()
}

/// The path of a module below `src`, such as `["planning", "kit", "ends"]`.
fn module_of(file: &Path) -> Vec<String> {
    let inside = file.strip_prefix(root().join("src")).expect("the file is under src").with_extension("");
    let mut names: Vec<String> =
        inside.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|name| name == "mod") {
        names.pop();
    }
    names
}

/// Every path of a `use` tree, braces taken apart.
fn paths_of_tree(tree: &str) -> Vec<Vec<String>> {
    let Some(open) = tree.find('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        return vec![path.split("::").map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()];
    };
    let (start, inner) = (&tree[..open], tree[open + 1..].trim_end().trim_end_matches('}'));
    let mut depth = 0;
    let mut members = vec![String::new()];
    for letter in inner.chars() {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        match letter {
            ',' if depth == 0 => members.push(String::new()),
            _ => members.last_mut().expect("there is one always").push(letter),
        }
    }
    let members = members.iter().map(|member| member.trim()).filter(|member| !member.is_empty());
    members.flat_map(|member| paths_of_tree(&format!("{start}{member}"))).collect()
}

/// A path that a file imports, and whether it passes it on to others.
struct UsedPath {
    path: Vec<String>,
    is_reexport: bool,
}

fn used_paths(file: &Path) -> Vec<UsedPath> {
    let text = production_code(file);
    let mut used = Vec::new();
    for (_, line) in joined_lines(&text) {
        let is_reexport = line.starts_with("pub use ");
        let tree = line.strip_prefix("pub use ").or_else(|| line.strip_prefix("use "));
        let Some(tree) = tree.and_then(|tree| tree.trim_end().strip_suffix(';')) else { continue };
        used.extend(paths_of_tree(tree).into_iter().map(|path| UsedPath { path, is_reexport }));
    }
    used
}

/// The files of a layer and what they import of each other.
struct ModuleGraph {
    files: BTreeMap<Vec<String>, PathBuf>,
}

impl ModuleGraph {
    fn of_layer(layer: &str) -> Self {
        let folder = root().join("src").join(layer);
        Self { files: source_files(&folder).into_iter().map(|file| (module_of(&file), file)).collect() }
    }

    /// A path as seen from the root of the crate; `None` if it leads to another crate.
    fn absolute(&self, module: &[String], path: &[String]) -> Option<Vec<String>> {
        let mut base = module.to_vec();
        let mut rest = path;
        match rest.first()?.as_str() {
            "crate" => (base, rest) = (Vec::new(), &rest[1..]),
            "self" => rest = &rest[1..],
            "super" => {
                while rest.first().is_some_and(|name| name == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            child => {
                base.push(child.to_owned());
                if !self.files.contains_key(&base) {
                    return None;
                }
                rest = &rest[1..];
            }
        }
        base.extend(rest.iter().cloned());
        Some(base)
    }

    /// The file of the layer in which what a path names is written down, re-exports followed.
    fn home_of(&self, path: &[String]) -> Option<&Vec<String>> {
        let (module, _) = (0..=path.len()).rev().find_map(|end| self.files.get_key_value(&path[..end]))?;
        let Some(name) = path.get(module.len()) else { return Some(module) };
        let reexport =
            used_paths(&self.files[module]).into_iter().find(|used| used.is_reexport && used.path.last() == Some(name));
        match reexport.and_then(|used| self.absolute(module, &used.path)) {
            Some(absolute) if absolute != path => self.home_of(&absolute).or(Some(module)),
            _ => Some(module),
        }
    }

    /// Which files a file imports something of, re-exports not counted: they are how a folder shows what is in it.
    fn imports(&self, module: &Vec<String>) -> BTreeSet<&Vec<String>> {
        let used = used_paths(&self.files[module]).into_iter().filter(|used| !used.is_reexport);
        let homes = used.filter_map(|used| self.home_of(&self.absolute(module, &used.path)?));
        homes.filter(|home| *home != module).collect()
    }

    /// A circle of imports, if there is one that leads over none of the files in `left_out`.
    fn circle(&self, left_out: &[&str]) -> Option<Vec<String>> {
        let mut done = BTreeSet::new();
        let mut way = Vec::new();
        self.files.keys().find_map(|module| self.circle_from(module, left_out, &mut way, &mut done))
    }

    fn circle_from<'a>(
        &'a self,
        module: &'a Vec<String>,
        left_out: &[&str],
        way: &mut Vec<&'a Vec<String>>,
        done: &mut BTreeSet<&'a Vec<String>>,
    ) -> Option<Vec<String>> {
        if done.contains(module) || left_out.contains(&module.join("::").as_str()) {
            return None;
        }
        if let Some(first) = way.iter().position(|known| *known == module) {
            return Some(way[first..].iter().chain([&module]).map(|module| module.join("::")).collect());
        }
        way.push(module);
        let circle = self.imports(module).into_iter().find_map(|next| self.circle_from(next, left_out, way, done));
        way.pop();
        done.insert(module);
        circle
    }
}

/// Why a file of `planning` may not import another one of it.
fn objection_inside_planning(module: &[String], imported: &[String]) -> Option<String> {
    let names = |path: &[String]| path.iter().skip(1).take(2).cloned().collect::<Vec<_>>();
    let (own, other) = (names(module), names(imported));
    let [room, ..] = own.as_slice() else { return None };
    let [other_room, ..] = other.as_slice() else { return None };
    match (room.as_str(), other_room.as_str()) {
        ("planners", "planners") if own.get(1).is_some() && own.get(1) != other.get(1) => Some(
            "a planner imports the kit and never a sibling: what two planners use belongs into `planning/kit`"
                .to_owned(),
        ),
        ("planners", "reachability" | "traffic" | "walk") => {
            Some("a planner is made of the kit; what stands beside planners is for those who call them".to_owned())
        }
        ("kit", "planners" | "registry" | "reachability" | "traffic" | "walk") => {
            Some("the kit knows none of those who are made of it".to_owned())
        }
        _ => None,
    }
}

#[test]
fn planners_import_the_kit_and_no_sibling() {
    let graph = ModuleGraph::of_layer("planning");
    assert!(graph.files.len() > 20, "the sources were not found");
    let objections = graph.files.keys().flat_map(|module| {
        let of_file = graph.imports(module).into_iter().filter_map(move |imported| {
            let reason = objection_inside_planning(module, imported)?;
            Some(format!("{} imports {}: {reason}", module.join("::"), imported.join("::")))
        });
        of_file.collect::<Vec<_>>()
    });
    assert_none(&objections.collect::<Vec<_>>());
}

#[test]
fn files_of_a_layer_do_not_import_each_other_in_circles() {
    // Planners implement the trait of the registry, and the registry lists planners: that is what it is for.
    let left_out = ["planning::registry", "scenario"];
    let layers = ["document", "geometry", "vehicle", "trajectory", "collision", "planning", "fire", "scenario", "cli"];
    for layer in layers {
        if let Some(circle) = ModuleGraph::of_layer(layer).circle(&left_out) {
            panic!("files import each other in a circle; move what they share into a file below both: {circle:?}");
        }
    }
}

#[test]
fn imports_are_followed_to_the_file_in_which_things_are_written_down() {
    let graph = ModuleGraph::of_layer("planning");
    let path = |text: &str| text.split("::").map(str::to_owned).collect::<Vec<_>>();
    let home = |text: &str| graph.home_of(&path(text)).map(|module| module.join("::"));
    assert_eq!(home("planning::Goal").as_deref(), Some("planning"));
    assert_eq!(home("planning::HybridSettings").as_deref(), Some("planning::planners::hybrid_astar::settings"));
    assert_eq!(home("planning::kit::floods::FloodSearch").as_deref(), Some("planning::kit::floods::search"));
    assert_eq!(home("rng::stream"), None);
    let inside = |own: &str, other: &str| objection_inside_planning(&path(own), &path(other));
    let sibling = inside("planning::planners::prm_rs::search", "planning::planners::hybrid_astar::settings");
    assert!(sibling.is_some_and(|reason| reason.contains("sibling")));
    assert!(inside("planning::kit::ends", "planning::planners::lattice").is_some());
    assert_eq!(inside("planning::planners::prm_rs::search", "planning::planners::prm_rs::roadmap"), None);
    assert_eq!(inside("planning::planners::prm_rs", "planning::kit::ends"), None);
    assert_eq!(
        paths_of_tree("super::{a::{B, c}, d}").iter().map(|path| path.join("::")).collect::<Vec<_>>(),
        ["super::a::B", "super::a::c", "super::d"]
    );
}
