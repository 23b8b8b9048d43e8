//! What each scene gives: counts, volumes, areas and interfaces, as short text to review. `GSM_UPDATE=1` writes it anew.

mod support;

use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs;
use support::{SCENES, build, folder, label, root, scene};

/// The report without times and paths; measures to the digits that rounding leaves alone.
fn summary(report: &Value, poly: &[u8]) -> String {
    let mut out = String::new();
    let counts = &report["counts"];
    for key in ["vertices", "facets", "polygons", "seeds", "holes"] {
        writeln!(out, "{key} {}", counts[key]).unwrap();
    }
    writeln!(out, "triangles {}", report["triangles"]).unwrap();
    for part in report["parts"].as_array().unwrap() {
        let (region, name, volume) = (&part["region"], part["part"].as_str().unwrap(), part["volume"].as_f64().unwrap());
        writeln!(out, "part {region} {name}: volume {volume:.9e}, {} pieces", part["seeds"].as_array().unwrap().len()).unwrap();
    }
    for interface in report["interfaces"].as_array().unwrap() {
        let (name, area) = (interface["name"].as_str().unwrap(), interface["area"].as_f64().unwrap());
        writeln!(out, "interface {} {name}: area {area:.9e}, {} facets", interface["marker"], interface["facets"]).unwrap();
    }
    if let Some(angle) = report["quality"]["min_angle"].as_f64() {
        writeln!(out, "smallest angle of triangular facets {angle:.3}").unwrap();
    }
    for warning in report["warnings"].as_array().unwrap() {
        writeln!(out, "warning {}: {}", warning["code"], warning["message"]).unwrap();
    }
    let hash: String = Sha256::digest(poly).iter().map(|byte| format!("{byte:02x}")).collect();
    writeln!(out, "sha256 of the .poly {hash}").unwrap();
    out
}

#[test]
fn scenes_give_what_they_gave() {
    let folder = folder("golden");
    let update = std::env::var_os("GSM_UPDATE").is_some();
    let mut changed = Vec::new();
    for (name, arguments) in SCENES {
        let report = build(&scene(name), arguments, &folder);
        let found = summary(&report, &fs::read(folder.join(name).with_extension("poly")).unwrap());
        let path = root("tests/golden").join(label(name, arguments)).with_extension("txt");
        if update {
            fs::write(&path, &found).unwrap();
            continue;
        }
        let expected = fs::read_to_string(&path).unwrap_or_default();
        let lines: Vec<String> = expected
            .lines()
            .filter(|line| !found.lines().any(|l| l == *line))
            .map(|line| format!("  - {line}"))
            .chain(found.lines().filter(|line| !expected.lines().any(|l| l == *line)).map(|line| format!("  + {line}")))
            .collect();
        if found != expected {
            changed.push(format!("{}\n{}", path.display(), lines.join("\n")));
        }
    }
    let hint = "if this is meant: GSM_UPDATE=1 cargo test --test golden, and review the difference";
    assert!(changed.is_empty(), "{hint}\n{}", changed.join("\n"));
}
