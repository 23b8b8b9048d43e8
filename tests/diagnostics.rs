//! Scenes that must fail: each file in `scenes/bad` says in comments `// expect: CODE at LINE:COLUMN` what is reported.

use gsm::diag::{Diagnostic, Severity};
use gsm::pipeline::{self, Overrides};
use gsm::report::timing::Timings;
use gsm::scene::{Limits, load};
use std::fs;
use std::path::{Path, PathBuf};

fn scenes(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<PathBuf> = fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "ron"));
    files.sort();
    files
}

fn found(fault: &Diagnostic) -> String {
    let place = fault.span.map_or("nowhere".to_owned(), |s| format!("{}:{}", s.line, s.column));
    format!("{} at {place}", fault.code)
}

#[test]
fn bad_scenes_are_refused_with_code_and_place() {
    let files = scenes("scenes/bad");
    assert!(files.len() >= 40, "only {} bad scenes found", files.len());
    let mut failures = Vec::new();
    for path in files {
        let text = fs::read_to_string(&path).unwrap();
        let mut expected: Vec<&str> = text.lines().filter_map(|line| line.trim().strip_prefix("// expect: ")).collect();
        let faults = load(&path, &[], &Limits::default()).err().unwrap_or_default();
        assert!(faults.iter().all(|f| f.severity == Severity::Error));
        for fault in &faults {
            let is_said = fault.hints.iter().all(|h| !h.is_empty()) && !fault.hints.is_empty() && fault.span.is_some();
            assert!(is_said, "{}: no place or no hint: {fault:?}", path.display());
        }
        let mut found: Vec<String> = faults.iter().map(found).collect();
        expected.sort_unstable();
        found.sort_unstable();
        if found != expected || found.is_empty() {
            failures.push(format!("{}: expected {expected:?}, found {found:?}\n  {faults:?}", path.display()));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn good_scenes_load_without_warnings() {
    for path in scenes("scenes") {
        match load(&path, &[], &Limits::default()) {
            Ok(loaded) => assert!(loaded.warnings.is_empty(), "{}: {:?}", path.display(), loaded.warnings),
            Err(faults) => panic!("{}: {faults:#?}", path.display()),
        }
    }
}

/// Warnings of a scene that is built, as `CODE: MESSAGE`.
fn warnings(name: &str, text: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).unwrap();
    let model = pipeline::run(&path, Overrides::default(), Timings::default()).unwrap_or_else(|f| panic!("{f:?}"));
    assert!(model.warnings.iter().all(|w| !w.hints.is_empty() && w.span.is_some()));
    model.warnings.iter().map(|w| format!("{}: {}", w.code, w.message)).collect()
}

#[test]
fn boundaries_that_lose_their_facets_are_told() {
    let block = |name: &str, z: u32, boundaries: &str| {
        format!("Part(name: \"{name}\", solid: Block(size: (1, 1, 1), at: (0, 0, {z})), boundaries: [{boundaries}])")
    };
    let scene = |parts: &[String]| format!("Scene(units: \"mm\", parts: [{}])", parts.join(", "));
    // An Outer behind a side is the rest.
    let rest = scene(&[block("a", 0, r#"Side(name: "t", side: "top"), Outer(name: "rest")"#)]);
    assert_eq!(warnings("boundary_rest.ron", &rest), [""; 0]);
    // Twice the same side; both sides of a contact; an Outer before a side.
    let twice = scene(&[
        block(
            "a",
            0,
            r#"Side(name: "t", side: "top"), Side(name: "u", side: "z+"), Outer(name: "w"), Side(name: "x", side: "x+")"#,
        ),
        block("b", 1, r#"Side(name: "v", side: "bottom")"#),
    ]);
    let found = warnings("boundary_twice.ron", &twice);
    assert_eq!(found.len(), 3, "{found:?}");
    for (warning, names) in found.iter().zip([["`u`", "`t`"], ["`x`", "`w`"], ["`v`", "`t`"]]) {
        assert!(warning.starts_with("taken-boundary") && names.iter().all(|n| warning.contains(n)), "{warning}");
    }
    // Inside of its own part, and an Outer that nothing of the outside touches.
    let inside = r#"Scene(units: "mm", parts: [
        Part(name: "air", solid: Block(size: (9, 9, 9), center: (0, 0, 0))),
        Part(name: "a", solid: Union([Block(name: "low", size: (1, 1, 1)), Block(size: (1, 1, 1), at: (0, 0, 1))]),
             boundaries: [Side(name: "t", of: "low", side: "top"), Outer(name: "o")])])"#;
    let found = warnings("boundary_inside.ron", inside);
    assert!(found.len() == 2 && found.iter().all(|w| w.starts_with("empty-boundary") && w.contains("`a`")), "{found:?}");
}
