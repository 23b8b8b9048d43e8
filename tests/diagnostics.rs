//! Scenes that must fail: each file in `scenes/bad` says in comments `// expect: CODE at LINE:COLUMN` what is reported.

use gsm::diag::{Diagnostic, Severity};
use gsm::pipeline::{self, Overrides};
use gsm::remesh::forecast::forecast;
use gsm::report::timing::Timings;
use gsm::scene::{Limits, load};
use std::collections::BTreeMap;
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

#[test]
fn each_of_many_named_sides_is_found() {
    // A thousand cubes, each with a name for its top: all get their facet, none that of another one.
    let cube = |k: u32| format!("Block(name: \"b{k}\", size: (1, 1, 1), at: ({}, {}, 0))", 2 * (k % 40), 2 * (k / 40));
    let side = |k: u32| format!("Side(name: \"t{k}\", of: \"b{k}\", side: \"top\")");
    let list = |one: &dyn Fn(u32) -> String| (0..1000).map(one).collect::<Vec<_>>().join(", ");
    let text = format!(
        "Scene(units: \"mm\", parts: [Part(name: \"p\", solid: Union([{}]), boundaries: [{}])])",
        list(&cube),
        list(&side)
    );
    assert_eq!(warnings("boundary_many.ron", &text), [""; 0]);
    // Two parts of one and the same solid, a body and what is left around it: the part that is listed first names their
    // contact.
    let shared = r#"Scene(units: "mm", parts: [
        Part(name: "body", solid: Block(name: "box", size: (2, 2, 2), center: (0, 0, 0)), boundaries: [Side(name: "own", of: "box")]),
        Part(name: "mould", solid: Difference([Block(size: (4, 4, 4), center: (0, 0, 0)),
             Block(name: "box", size: (2, 2, 2), center: (0, 0, 0))]),
             boundaries: [Side(name: "cap", of: "box", side: "top"), Outer(name: "wall"), Side(name: "rim", of: "box")])])"#;
    let found = warnings("boundary_shared.ron", shared);
    assert!(found.len() == 2 && found[0].contains("`cap`") && found[1].contains("`rim`"), "{found:?}");
    assert!(found.iter().all(|w| w.starts_with("taken-boundary") && w.contains("`own`")), "{found:?}");
}

#[test]
fn interfaces_that_are_none_are_told() {
    let text = r#"Scene(units: "mm", interfaces: {
        "air|a": (max_edge: 1), "a|b": (max_edge: 1), "b|outer": (max_edge: 1)}, parts: [
        Part(name: "air", solid: Block(size: (9, 9, 9), center: (0, 0, 0))),
        Part(name: "a", solid: Sphere(radius: 1)), Part(name: "b", solid: Sphere(radius: 1, center: (2.5, 0, 0)))])"#;
    let found = warnings("interface_none.ron", text);
    let told: Vec<&str> = found.iter().filter_map(|w| w.strip_prefix("empty-interface: the interface ")).collect();
    assert_eq!(
        told,
        ["`a|b` has no facet: `a` and `b` do not touch", "`b|outer` has no facet: nothing of `b` faces the outside"]
    );
}

#[test]
fn volumes_that_remeshing_changes_much_are_told() {
    let scene = |deviation: &str| {
        format!(
            r#"Scene(units: "mm", remesh: Full, {deviation} parts: [
            Part(name: "ball", solid: Sphere(radius: 20), copies: Linear(count: 2, step: (50, 0, 0))),
            Part(name: "ring", solid: Torus(major_radius: 8, minor_radius: 2, center: (0, 50, 0)))])"#
        )
    };
    let found = warnings("volume_coarse.ron", &scene("max_deviation: 0.7,"));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].starts_with("changed-volume: remeshing changed the volume of `ring` from 6") && found[0].contains(", by -")
    );
    assert_eq!(warnings("volume_fine.ron", &scene("max_deviation: 0.05,")), [""; 0]);
    assert_eq!(warnings("volume_default.ron", &scene("")), [""; 0]);
    // What copies share is told once.
    let found = warnings("volume_copies.ron", &scene("max_deviation: 2,"));
    assert!(found.len() == 2 && found[0].contains("`ball1`") && found[0].ends_with("(the first of 2 places)"), "{found:?}");
}

/// Longest edge of the facets of each curved interface.
fn longest_edges(name: &str, settings: &str) -> BTreeMap<String, f64> {
    let text = format!(
        r#"Scene(units: "mm", remesh: Full, {settings} parts: [
        Part(name: "air", solid: Cylinder(radius: 20, height: 30)),
        Part(name: "rotor", solid: Cylinder(radius: 10, height: 30), max_edge: "0.4 cm"),
        Part(name: "shaft", solid: Cylinder(radius: 5, height: 30))])"#
    );
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).unwrap();
    let complex = pipeline::run(&path, Overrides::default(), Timings::default()).unwrap().complex;
    let mut longest = BTreeMap::new();
    for facet in complex.facets.iter().filter(|f| complex.surfaces[f.surface].side == "side") {
        let place = |k: usize| complex.vertices[facet.loops[0][k % facet.loops[0].len()]].point;
        let edge = (0..facet.loops[0].len()).map(|k| (place(k + 1) - place(k)).norm()).fold(0.0, f64::max);
        let entry = longest.entry(complex.markers[facet.marker].name.clone()).or_insert(0.0);
        *entry = f64::max(*entry, edge);
    }
    longest
}

#[test]
fn the_largest_edge_of_parts_and_interfaces_is_kept_where_it_is_asked_for() {
    let plain = longest_edges("edges_plain.ron", "");
    // A tenth more is what the language allows itself.
    assert!(plain["air|rotor"] <= 4.4 && plain["rotor|shaft"] <= 4.4 && plain["air|outer"] > 5.0, "{plain:?}");
    let fine = longest_edges("edges_fine.ron", "interfaces: {\"shaft|rotor\": (max_edge: \"1 mm\")},");
    assert!(fine["rotor|shaft"] <= 1.1 && fine["air|rotor"] > 2.0 && fine["air|outer"] > 5.0, "{fine:?}");
    let outside = longest_edges("edges_outside.ron", "interfaces: {\"air|outer\": (max_edge: 3)},");
    assert!(outside["air|outer"] <= 3.3, "{outside:?}");
}

#[test]
fn much_work_is_told_before_it_is_done_or_refused() {
    let text = |settings: &str| {
        format!("Scene(units: \"mm\", {settings} parts: [Part(name: \"a\", solid: Cylinder(radius: 10, height: 20))])")
    };
    let forecast_of = |name: &str, settings: &str| {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        fs::write(&path, text(settings)).unwrap();
        let scene = load(&path, &[], &Limits::default()).unwrap().scene;
        let solids = gsm::primitive::build(&scene).unwrap();
        let complex = gsm::evaluate::evaluate(&scene, &solids, &mut Timings::default()).unwrap().complex;
        forecast(&complex, &scene, Limits::default().memory)
    };
    // Equilateral triangles on a cylinder: 2 pi r h sqrt(3) / (6 r d), for d = 1e-4 about 363000; less on 24 chords.
    let warning = forecast_of("many.ron", "remesh: Full, max_deviation: 1e-4,").unwrap().unwrap();
    assert_eq!((warning.code, warning.severity), ("many-triangles", Severity::Warning));
    assert!(warning.message.contains("about 360000 triangles") && warning.message.contains("`a|outer`"), "{warning:?}");
    assert!(warning.span.is_some() && warning.hints[0].contains("1.8e-4"), "{warning:?}");
    let refused = forecast_of("too_many.ron", "remesh: Full, max_deviation: 1e-6,").unwrap_err();
    assert!(refused[0].code == "too-many-triangles" && refused[0].message.contains("36 million"), "{refused:?}");
    // No intersection, nothing remeshed; few triangles; a small `max_edge` alone.
    assert_eq!(forecast_of("few.ron", "remesh: Interfaces, max_deviation: 1e-6,").unwrap(), None);
    assert_eq!(forecast_of("fewer.ron", "remesh: Full, max_deviation: 1e-2,").unwrap(), None);
    assert_eq!(forecast_of("off.ron", "remesh: Off, max_deviation: 1e-6,").unwrap(), None);
    let small = forecast_of("small.ron", "remesh: Full, interfaces: {\"a|outer\": (max_edge: 0.05)},").unwrap().unwrap();
    assert_eq!(small.code, "many-triangles");
    // Facets before there are any.
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("many_facets.ron");
    let sphere = "Scene(units: \"mm\", parts: [Part(name: \"a\", solid: Sphere(radius: 1, discretization: (segments: 3000)))])";
    fs::write(&path, sphere).unwrap();
    let warnings = load(&path, &[], &Limits::default()).unwrap().warnings;
    assert!(warnings.len() == 1 && warnings[0].code == "many-facets" && warnings[0].span.is_some(), "{warnings:?}");
    // Surfaces count by their files: 2e6 facets once, or ten times in different places.
    let file = fs::File::create(path.with_file_name("many.stl")).unwrap();
    let count = 2_000_000u32;
    let header = [&[b' '; 80][..], &count.to_le_bytes()].concat();
    std::io::Write::write_all(&mut &file, &header).unwrap();
    file.set_len(84 + 50 * u64::from(count)).unwrap();
    let scene = |copies: u32| {
        format!(
            "Scene(units: \"mm\", parts: [Part(name: \"a\", solid: Linear(count: {copies}, step: (9, 0, 0), \
             solid: Import(file: \"many.stl\")))])"
        )
    };
    fs::write(&path, scene(2)).unwrap();
    let warnings = load(&path, &[], &Limits::default()).unwrap().warnings;
    assert!(warnings.len() == 1 && warnings[0].message.contains("4.00e6"), "{warnings:?}");
    fs::write(&path, scene(10)).unwrap();
    let refused = load(&path, &[], &Limits::default()).unwrap_err();
    assert!(refused[0].code == "too-many-facets" && refused[0].hints[0].contains("reduce"), "{refused:?}");
    assert!(refused[0].message.contains("10 copies of this solid") && refused[0].hints[0].contains("`count`"), "{refused:?}");
    // Patterns in patterns multiply: it is they that are told, not the few segments of each copy.
    let pattern = |count: u32, step: &str, solid: &str| format!("Linear(count: {count}, step: {step}, solid: {solid})");
    let spheres = |count: u32| {
        let solid = pattern(count, "(0, 0, 9)", &pattern(20, "(0, 9, 0)", &pattern(10, "(9, 0, 0)", "Sphere(radius: 1)")));
        format!("Scene(units: \"mm\", parts: [Part(name: \"a\", solid: {solid})])")
    };
    let other = path.with_file_name("many_copies.ron");
    fs::write(&other, spheres(30)).unwrap();
    let warnings = load(&other, &[], &Limits::default()).unwrap().warnings;
    assert!(warnings.len() == 1 && warnings[0].message.contains("6000 copies (30 x 20 x 10)"), "{warnings:?}");
    assert!(warnings[0].hints[0].starts_with("make fewer copies"), "{warnings:?}");
    fs::write(&other, spheres(400)).unwrap();
    let refused = load(&other, &[], &Limits::default()).unwrap_err();
    assert_eq!(refused[0].code, "too-many-facets");
    assert!(refused[0].message.starts_with("80000 copies (400 x 20 x 10) of this solid with 288 facets each"), "{refused:?}");
    // As text, the same file would have fewer.
    file.set_len(83 + 50 * u64::from(count)).unwrap();
    assert!(load(&path, &[], &Limits::default()).unwrap().warnings.len() == 1);
}
