//! Scenes that must fail: each file in `scenes/bad` says in comments `// expect: CODE at LINE:COLUMN` what is reported.

use gsm::diag::{Diagnostic, Severity};
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
