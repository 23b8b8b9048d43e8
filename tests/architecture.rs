//! Which module may use which: the stages point one way, from the scene to the files. A new arrow is a decision: it goes here.

mod support;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use support::root;

/// Used by everything, in this order among themselves.
const BASE: [&str; 3] = ["ids", "geom", "diag"];

/// The stages in the order of the flow; each may use those before it.
const STAGES: [&str; 11] =
    ["scene", "primitive", "cull", "contact", "arrangement", "classify", "patch", "select", "round", "remesh", "position"];

/// The B-rep serves the stages from `primitive` on and knows only the degrees of freedom and surfaces of solids.
const BREP: (&str, &[&str]) = ("brep", &["primitive"]);
/// Stages that come before there is a complex.
const WITHOUT_BREP: [&str; 6] = ["scene", "primitive", "cull", "contact", "arrangement", "classify"];

/// The rest: module and what it may use besides the base.
const OTHERS: [(&str, &[&str]); 8] = [
    // Table of contents of the evaluator and of the whole.
    ("evaluate", &["scene", "primitive", "cull", "contact", "arrangement", "classify", "patch", "select", "round", "brep"]),
    (
        "pipeline",
        &[
            "scene",
            "primitive",
            "arrangement",
            "round",
            "evaluate",
            "remesh",
            "position",
            "patch",
            "brep",
            "plc",
            "io",
            "report",
        ],
    ),
    // The check of a complex names what it finds by the manifest, which is a file format.
    ("plc", &["scene", "primitive", "brep", "io"]),
    ("io", &["scene", "brep", "plc"]),
    ("tetgen", &["scene", "brep", "plc", "io"]),
    // It tells what the arrangement and rounding counted.
    ("report", &["scene", "arrangement", "round", "brep", "plc", "io", "pipeline", "tetgen"]),
    ("cli", &[]),
    ("commands", &["cli", "scene", "brep", "plc", "io", "tetgen", "report", "pipeline"]),
];

/// Single arrows against the flow, with the reason.
const EXCEPTIONS: [(&str, &str); 2] = [
    // Imported surfaces are read where the other formats are.
    ("primitive", "io"),
    // The evaluator's steps are timed one by one.
    ("evaluate", "report"),
];

fn allowed() -> BTreeMap<&'static str, BTreeSet<&'static str>> {
    let mut table: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (k, name) in BASE.iter().enumerate() {
        table.insert(name, BASE[..k].iter().copied().collect());
    }
    let base = BASE.into_iter();
    for (k, name) in STAGES.iter().enumerate() {
        let mut uses: BTreeSet<&str> = base.clone().chain(STAGES[..k].iter().copied()).collect();
        if !WITHOUT_BREP.contains(name) {
            uses.insert(BREP.0);
        }
        table.insert(name, uses);
    }
    for (name, uses) in OTHERS.iter().chain([&BREP]) {
        table.insert(name, base.clone().chain(uses.iter().copied()).collect());
    }
    for (from, to) in EXCEPTIONS {
        table.entry(from).or_default().insert(to);
    }
    table
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
}

/// Modules that a source names after `crate::`, outside comments. `declare_ids` is the macro of `ids`.
fn used(text: &str) -> BTreeSet<String> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let after = code.flat_map(|line| line.split("crate::").skip(1));
    after
        .map(|rest| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>())
        .filter(|name| !name.is_empty())
        .map(|name| if name == "declare_ids" { "ids".to_owned() } else { name })
        .collect()
}

/// Files that only tests use may build their samples with anything.
fn is_test(path: &Path) -> bool {
    path.components().any(|part| {
        let name = part.as_os_str().to_string_lossy();
        ["tests", "tests.rs", "samples.rs", "bench.rs"].contains(&name.as_ref()) || name.ends_with("_tests.rs")
    })
}

#[test]
fn modules_use_only_what_comes_before_them() {
    let table = allowed();
    let source = root("src");
    let mut files = Vec::new();
    sources(&source, &mut files);
    assert!(files.len() > 100, "only {} files", files.len());
    let mut wrong = Vec::new();
    for path in files {
        let local = path.strip_prefix(&source).unwrap();
        let module = local.components().next().unwrap().as_os_str().to_string_lossy().trim_end_matches(".rs").to_owned();
        if module == "lib" || module == "main" || is_test(local) {
            continue;
        }
        let Some(uses) = table.get(module.as_str()) else {
            wrong.push(format!("{}: module `{module}` has no place in tests/architecture.rs", local.display()));
            continue;
        };
        let text = fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for name in used(code) {
            if name != module && !uses.contains(name.as_str()) {
                wrong.push(format!("{}: `{module}` uses `{name}`", local.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_scan_sees_uses_and_skips_comments() {
    let text =
        "//! [`crate::plc`]\nuse crate::brep::Complex;\n    crate::declare_ids! { A; }\nlet x = crate::geom::f(crate::io::g);";
    assert_eq!(used(text).into_iter().collect::<Vec<_>>(), ["brep", "geom", "ids", "io"]);
}
