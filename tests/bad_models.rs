//! Scenes that read well and describe no valid model: what `gsm build` finds, by code and place; see `scenes/bad_models`.

mod support;

use serde_json::Value;
use std::fs;
use support::{files, folder, gsm, root, text};

fn found(fault: &Value) -> String {
    let place = match &fault["span"] {
        Value::Null => "nowhere".to_owned(),
        span => format!("{}:{}", span["line"], span["column"]),
    };
    format!("{} at {place}", fault["code"].as_str().unwrap())
}

#[test]
fn bad_models_are_refused_with_code_place_and_hint() {
    let folder = folder("bad-models");
    let mut failures = Vec::new();
    let mut count = 0;
    for entry in fs::read_dir(root("scenes/bad_models")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "ron") {
            continue;
        }
        count += 1;
        let scene = fs::read_to_string(&path).unwrap();
        let mut expected: Vec<String> =
            scene.lines().filter_map(|line| line.trim().strip_prefix("// expect: ")).map(str::to_owned).collect();
        let names: Vec<&str> = scene.lines().filter_map(|line| line.trim().strip_prefix("// names: ")).collect();
        let run = gsm(["build", text(&path), "--json"], &folder);
        let report: Value = serde_json::from_slice(&run.stdout).unwrap_or_default();
        let errors = report["errors"].as_array().cloned().unwrap_or_default();
        let mut seen: Vec<String> = errors.iter().map(found).collect();
        expected.sort();
        seen.sort();
        let said = errors.iter().map(|e| e["message"].as_str().unwrap_or_default()).collect::<Vec<_>>().join("\n");
        let has_hints = errors.iter().all(|e| e["hints"].as_array().is_some_and(|h| !h.is_empty()));
        assert!(has_hints, "{}: no hint: {errors:?}", path.display());
        let is_named = names.iter().flat_map(|line| line.split_whitespace()).all(|name| said.contains(name));
        if run.status.code() != Some(1) || seen != expected || !is_named || !files(&folder).is_empty() {
            let code = run.status.code();
            failures
                .push(format!("{}: exit {code:?}, expected {expected:?} {names:?}, found {seen:?}\n  {said}", path.display()));
        }
    }
    assert!(count >= 7, "only {count} scenes");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
