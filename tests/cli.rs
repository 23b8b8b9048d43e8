//! The program from outside: exit codes, what is written and when, what is printed.

mod support;

use serde_json::Value;
use std::fs;
use std::process::{Command, Stdio};
use support::{files, folder, gsm, root, scene, text};

const GOOD: &str = r#"Scene(units: "mm", params: {"size": 2}, parts: [Part(name: "a", solid: Block(size: ("size", 1, 1)))])"#;

#[test]
fn a_good_scene_exits_0_and_writes_both_files_to_the_current_folder() {
    let folder = folder("cli-good");
    fs::write(folder.join("good.ron"), GOOD).unwrap();
    let run = gsm(["build", "good.ron"], &folder);
    assert_eq!(run.status.code(), Some(0));
    assert_eq!(files(&folder), ["good.gsm.json", "good.poly", "good.ron"]);
    let said = String::from_utf8(run.stdout).unwrap();
    assert!(said.contains("good.poly") && said.contains("a|outer") && said.contains("2 mm^3"), "{said}");
    assert!(run.stderr.is_empty());
}

#[test]
fn output_goes_where_it_is_asked_for_and_replaces_old_files() {
    let folder = folder("cli-output");
    fs::create_dir(folder.join("below")).unwrap();
    fs::write(folder.join("good.ron"), GOOD).unwrap();
    fs::write(folder.join("below/other.poly"), "old").unwrap();
    let run = gsm(["build", "good.ron", "-o", "below/other.poly", "--quiet"], &folder);
    assert_eq!(run.status.code(), Some(0));
    assert!(run.stdout.is_empty());
    assert_eq!(files(&folder), ["below", "good.ron"]);
    assert_eq!(files(&folder.join("below")), ["other.gsm.json", "other.poly"]);
    assert!(fs::read_to_string(folder.join("below/other.poly")).unwrap().len() > 100);
}

#[test]
fn set_replaces_a_parameter_and_enters_the_hash() {
    let folder = folder("cli-set");
    fs::write(folder.join("good.ron"), GOOD).unwrap();
    let plain = support::build(&folder.join("good.ron"), &[], &folder);
    let set = support::build(&folder.join("good.ron"), &["--set", "size=3mm"], &folder);
    assert_eq!(plain["parts"][0]["volume"], 2.0);
    assert_eq!(set["parts"][0]["volume"], 3.0);
    assert_ne!(plain["scene_hash"], set["scene_hash"]);
}

#[test]
fn json_tells_everything_and_nothing_else_is_printed() {
    let folder = folder("cli-json");
    let report = support::build(&scene("transformer3"), &[], &folder);
    let names: Vec<&str> = report["interfaces"].as_array().unwrap().iter().map(|i| i["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"E|I") && names.contains(&"E|LV2") && names.contains(&"air|outer"), "{names:?}");
    assert_eq!(report["parts"].as_array().unwrap().len(), 9);
    assert!(report["timings"].as_array().unwrap().iter().all(|t| t["wall"].as_f64().unwrap() >= 0.0));
    let manifest: Value = serde_json::from_slice(&fs::read(folder.join("transformer3.gsm.json")).unwrap()).unwrap();
    assert_eq!(manifest["unit"], "mm");
    assert_eq!(manifest["regions"].as_array().unwrap().len(), 9);
}

#[test]
fn wrong_models_exit_1_say_where_and_write_nothing() {
    let folder = folder("cli-wrong");
    for entry in fs::read_dir(root("scenes/bad")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "ron") {
            continue;
        }
        for command in ["build", "check"] {
            let run = gsm([command, text(&path)], &folder);
            assert_eq!(run.status.code(), Some(1), "{command} {}", path.display());
            let said = [run.stdout, run.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
            assert!(said.contains("error["), "{}: {said}", path.display());
        }
        let run = gsm(["build", text(&path), "--json"], &folder);
        let report: Value = serde_json::from_slice(&run.stdout).unwrap();
        assert!(!report["errors"].as_array().unwrap().is_empty());
        assert_eq!(report["file"], text(&path));
        assert!(files(&folder).is_empty(), "{} wrote {:?}", path.display(), files(&folder));
    }
}

#[test]
fn wrong_arguments_exit_2() {
    let folder = folder("cli-usage");
    let cases: [&[&str]; 9] = [
        &["build", "a.ron", "--set", "r=2", "--set", "r=3"],
        &["mesh", "a.ron", "--set", "r=2", "--set", "h=1", "--set", " r = 2"],
        &[],
        &["bild"],
        &["build"],
        &["build", "a.ron", "--set", "gap"],
        &["build", "a.ron", "--threads", "0"],
        &["check"],
        &["mesh", "a.ron", "--ratio", "0.3"],
    ];
    for arguments in cases {
        let run = gsm(arguments, &folder);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}");
        assert!(!run.stderr.is_empty(), "{arguments:?}");
        // For scripts one object like that of other failures, and nothing else.
        let run = gsm(arguments.iter().chain(&["--json"]), &folder);
        let report: Value = serde_json::from_slice(&run.stdout).unwrap();
        assert_eq!((run.status.code(), &report["errors"][0]["code"]), (Some(2), &Value::from("usage")), "{arguments:?}");
        assert!(run.stderr.is_empty() && !report["errors"][0]["hints"].as_array().unwrap().is_empty(), "{report}");
    }
    let twice = gsm(["build", "a.ron", "--set", "r=2", "--set", "r=3"], &folder);
    let said = String::from_utf8(twice.stderr).unwrap();
    assert!(said.contains("'r' is set twice") && said.contains("--set r=3"), "{said}");
    let unknown = gsm(["build", text(&scene("cone")), "--set", "nothing=1"], &folder);
    assert_eq!(unknown.status.code(), Some(1), "an unknown parameter is the model's fault: the scene decides which there are");
    assert!(files(&folder).is_empty());
}

#[test]
fn help_and_version_exit_0() {
    let folder = folder("cli-help");
    for arguments in [&["--help"][..], &["--version"], &["build", "--help"], &["check", "--help"]] {
        let run = gsm(arguments, &folder);
        assert_eq!(run.status.code(), Some(0));
        assert!(!run.stdout.is_empty());
    }
}

#[test]
fn places_that_cannot_be_written_exit_1_and_change_nothing() {
    let folder = folder("cli-place");
    fs::write(folder.join("good.ron"), GOOD).unwrap();
    fs::write(folder.join("file"), "a file").unwrap();
    // A manifest that cannot be renamed into place: the .poly before it must not stay.
    fs::create_dir_all(folder.join("taken.gsm.json/inside")).unwrap();
    fs::write(folder.join("taken.poly"), "old").unwrap();
    let before = files(&folder);
    for place in ["missing/a.poly", "file/a.poly", "taken.poly"] {
        let run = gsm(["build", "good.ron", "-o", place], &folder);
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(1), "{place}: {said}");
        assert!(said.contains("error[cannot-write]"), "{place}: {said}");
        assert_eq!(files(&folder), before, "{place}");
    }
    assert_eq!(fs::read_to_string(folder.join("taken.poly")).unwrap(), "old");
    // Told before the work, which may take an hour, is begun.
    for arguments in [
        &["build", "no.ron", "-o", "missing/a.poly"][..],
        &["mesh", "no.ron", "-o", "missing/a.msh"],
        &["convert", "no.msh", "missing/a.obj"],
        &["new", "team07", "-o", "missing/a.ron"],
    ] {
        let run = gsm(arguments, &folder);
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(run.status.code() == Some(1) && said.contains("error[cannot-write]") && said.contains("create it"), "{said}");
    }
}

/// Nobody may write to /proc, not even the root user that tests in containers run as.
#[cfg(target_os = "linux")]
#[test]
fn a_read_only_folder_exits_1() {
    let folder = folder("cli-read-only");
    fs::write(folder.join("good.ron"), GOOD).unwrap();
    let run = gsm(["build", "good.ron", "-o", "/proc/a.poly"], &folder);
    assert_eq!(run.status.code(), Some(1));
    assert!(String::from_utf8(run.stderr).unwrap().contains("error[cannot-write]"));
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let folder = folder("cli-pipe");
    let mut child = Command::new(env!("CARGO_BIN_EXE_gsm"))
        .args(["build", text(&scene("machine"))])
        .current_dir(&folder)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn check_takes_scenes_and_files_and_writes_nothing() {
    let folder = folder("cli-check");
    let run = gsm(["check", text(&scene("team07"))], &folder);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stdout));
    assert!(files(&folder).is_empty());
    support::build(&scene("team07"), &[], &folder);
    let run = gsm(["check", "team07.poly"], &folder);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stdout));
    let run = gsm(["check", "team07.poly", "--json"], &folder);
    let verdict: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!((&verdict["is_valid"], &verdict["counts"]["seeds"]), (&Value::Bool(true), &Value::from(3)));
    assert_eq!(verdict["errors"], Value::Array(Vec::new()));
    assert_eq!(files(&folder), ["team07.gsm.json", "team07.poly"]);
    assert_eq!(gsm(["check", "nothing.poly"], &folder).status.code(), Some(1));
    assert_eq!(gsm(["check", "nothing.ron"], &folder).status.code(), Some(1));
}

#[test]
fn check_finds_a_vertex_that_was_moved_by_hand() {
    let folder = folder("cli-moved");
    support::build(&scene("prism_holes"), &[], &folder);
    let path = folder.join("prism_holes.poly");
    let poly = fs::read_to_string(&path).unwrap();
    let row = poly.lines().find(|l| l.ends_with("100.0 100.0 50.0")).expect("a corner of a hole");
    let moved = row.replace("100.0 100.0 50.0", "100.0 100.0 50.001");
    fs::write(&path, poly.replace(row, &moved)).unwrap();
    let run = gsm(["check", "prism_holes.poly"], &folder);
    let said = String::from_utf8(run.stdout).unwrap();
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(said.contains("not-planar") && said.contains("body|outer"), "{said}");
}

const TWO: &str = r#"Scene(units: "mm", parts: [
    Part(name: "a", solid: Block(size: (1, 1, 1)), boundaries: [Outer(name: "skin")]),
    Part(name: "b", solid: Block(size: (1, 1, 2), at: (0, 0, 1)))])"#;

#[test]
fn what_is_written_is_listed_and_an_interface_that_boundaries_cover_is_not() {
    let folder = folder("cli-listed");
    fs::write(folder.join("two.ron"), TWO).unwrap();
    let said = String::from_utf8(gsm(["build", "two.ron"], &folder).stdout).unwrap();
    assert!(said.contains("written: two.poly, two.gsm.json\n"), "{said}");
    assert!(
        said.ends_with("now: gsm mesh two.ron (tetrahedra for solvers) or gsm convert two.poly two.glb (for viewers)\n"),
        "{said}"
    );
    assert!(said.contains("skin") && said.contains("b|outer") && !said.contains("a|outer"), "{said}");
}

#[test]
fn check_finds_a_manifest_that_belongs_to_something_else() {
    let folder = folder("cli-manifest");
    fs::write(folder.join("two.ron"), TWO).unwrap();
    assert_eq!(gsm(["build", "two.ron", "-q"], &folder).status.code(), Some(0));
    assert_eq!(gsm(["check", "two.poly"], &folder).status.code(), Some(0));
    // The region points are the last lines: number, x, y, z, region, volume.
    let poly = fs::read_to_string(folder.join("two.poly")).unwrap();
    let swapped: Vec<String> = poly
        .lines()
        .map(|line| match line.split_whitespace().collect::<Vec<_>>()[..] {
            [k, x, y, z, "1", v] => format!("{k} {x} {y} {z} 2 {v}"),
            [k, x, y, z, "2", v] => format!("{k} {x} {y} {z} 1 {v}"),
            _ => line.to_owned(),
        })
        .collect();
    fs::write(folder.join("two.poly"), swapped.join("\n")).unwrap();
    let run = gsm(["check", "two.poly"], &folder);
    let said = String::from_utf8(run.stdout).unwrap();
    assert_eq!(run.status.code(), Some(1), "{said}");
    for part in ["wrong-marker", "wrong-volume", "region 1 (a)", "(skin) lies between `b` and no part"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn nothing_is_written_over_the_file_that_is_read_or_under_a_name_of_another_format() {
    let folder = folder("cli-same");
    for name in ["good.ron", "good.poly"] {
        fs::write(folder.join(name), GOOD).unwrap();
    }
    let tetra = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    fs::write(folder.join("t.off"), tetra).unwrap();
    let before = files(&folder);
    for (arguments, code, exit) in [
        (&["build", "good.poly", "-o", "good.poly"][..], "same-file", 2),
        (&["build", "good.ron", "-o", "good.ron"], "unknown-format", 2),
        (&["build", "good.ron", "-o", "good.stl"], "unknown-format", 2),
        (&["build", "good.ron", "-o", "good"], "unknown-format", 2),
        (&["convert", "t.off", "./t.off"], "same-file", 2),
        (&["mesh", "good.ron", "-o", "a.msh", "-o", "b.msh", "-o", "a.msh"], "same-file", 2),
        (&["convert", "good.ron", "t.obj"], "unknown-format", 2),
        (&["convert", "t.off", "t.foo"], "unknown-format", 2),
        (&["convert", "t.foo", "t.obj"], "unknown-format", 2),
        (&["convert", "t.vtu", "t.obj"], "unreadable-format", 2),
        (&["convert", "t.off", "t.obj", "--unit", "foo"], "unknown-unit", 2),
        (&["build", "t.off"], "no-scene", 2),
    ] {
        let run = gsm(arguments, &folder);
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(said.contains(&format!("error[{code}]")) && said.contains("hint: "), "{arguments:?}: {said}");
        assert_eq!(run.status.code(), Some(exit), "{arguments:?}");
        assert_eq!(files(&folder), before, "{arguments:?}");
    }
    assert_eq!(fs::read_to_string(folder.join("good.ron")).unwrap(), GOOD);
    assert_eq!(fs::read_to_string(folder.join("t.off")).unwrap(), tetra);
}

#[test]
fn files_as_windows_writes_them_are_read() {
    let folder = folder("cli-windows");
    let windows = |text: &str| format!("\u{feff}{}", text.replace('\n', "\r\n"));
    fs::write(folder.join("good.ron"), windows(&format!("// A comment\n{GOOD}\n"))).unwrap();
    assert_eq!(gsm(["build", "good.ron", "-o", "BOX.POLY"], &folder).status.code(), Some(0));
    let complex = fs::read_to_string(folder.join("BOX.POLY")).unwrap();
    fs::write(folder.join("BOX.POLY"), windows(&complex)).unwrap();
    let run = gsm(["check", "BOX.POLY"], &folder);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    // Its manifest is found, too.
    fs::write(folder.join("BOX.gsm.json"), "{}").unwrap();
    assert_eq!(gsm(["check", "BOX.POLY"], &folder).status.code(), Some(1));
}

#[test]
fn lines_that_end_in_carriage_returns_are_counted() {
    let folder = folder("cli-returns");
    let old = |text: &str| text.replace('\n', "\r");
    fs::write(folder.join("good.ron"), old(&format!("// A comment\n{GOOD}\n"))).unwrap();
    assert_eq!(gsm(["build", "good.ron", "-o", "box.poly"], &folder).status.code(), Some(0));
    fs::write(folder.join("box.poly"), old(&fs::read_to_string(folder.join("box.poly")).unwrap())).unwrap();
    assert_eq!(gsm(["check", "box.poly"], &folder).status.code(), Some(0));
    let said = |name: &str, text: &str| {
        fs::write(folder.join(name), old(text)).unwrap();
        let run = gsm(["check", name], &folder);
        assert_eq!(run.status.code(), Some(1));
        String::from_utf8([run.stdout, run.stderr].concat()).unwrap()
    };
    assert!(said("bad.ron", "// A comment\nScene(\n  units: \"mm\",\n  part: [])\n").contains("bad.ron:4:3: "));
    assert!(said("bad.poly", "# A comment\n1 3\n1 0 x 0\n").contains("bad.poly:3:5: "));
}

#[cfg(unix)]
#[test]
fn a_folder_for_temporary_files_that_cannot_be_written_is_named() {
    let folder = folder("cli-temporary");
    fs::write(folder.join("good.ron"), GOOD).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_gsm"));
    // A program that is there: it is not started.
    command.args(["mesh", "good.ron", "--tetgen", "/bin/sh"]).env("TMPDIR", folder.join("missing")).current_dir(&folder);
    let run = command.output().unwrap();
    let said = String::from_utf8(run.stderr).unwrap();
    assert!(said.contains("cannot-write") && said.contains("missing") && said.contains("TMPDIR"), "{said}");
    assert_eq!(run.status.code(), Some(4));
    assert_eq!(files(&folder), ["good.ron"]);
}

#[test]
fn all_commands_tell_scripts_what_is_wrong_alike() {
    let folder = folder("cli-shape");
    let empty = r#"Scene(units: "mm", parts: [Part(name: "a", solid: Union([Block(size: (1, 1, 1)), Union([])]))])"#;
    fs::write(folder.join("good.ron"), GOOD).unwrap();
    fs::write(folder.join("told.ron"), empty).unwrap();
    let report = |arguments: &[&str]| {
        let run = gsm(arguments.iter().chain(&["--json"]), &folder);
        let report: Value = serde_json::from_slice(&run.stdout).unwrap_or_else(|e| panic!("{arguments:?}: {e}"));
        let count = |list: &str| report[list].as_array().unwrap_or_else(|| panic!("{arguments:?}: no {list}")).len();
        assert!(run.stderr.is_empty(), "{arguments:?}");
        assert_eq!(count("errors") == 0, run.status.code() == Some(0), "{arguments:?}");
        assert!(report["errors"].as_array().unwrap().iter().all(|e| e["severity"] == "error" && e["message"].is_string()));
        (run.status.code(), report["file"].as_str().unwrap().to_owned(), count("warnings"))
    };
    let good = |file: &str, warnings| (Some(0), file.to_owned(), warnings);
    let bad = |file: &str, exit| (Some(exit), file.to_owned(), 0);
    assert_eq!(report(&["build", "good.ron", "-o", "a.poly"]), good("good.ron", 0));
    assert_eq!(report(&["build", "told.ron", "-o", "b.poly"]), good("told.ron", 1));
    assert_eq!(report(&["check", "told.ron"]), good("told.ron", 1));
    assert_eq!(report(&["check", "a.poly"]), good("a.poly", 0));
    assert_eq!(report(&["convert", "a.poly", "a.obj"]), good("a.poly", 0));
    assert_eq!(report(&["new", "team07"]), good("team07.ron", 0));
    assert_eq!(report(&["new", "team07"]), bad("team07.ron", 1));
    assert_eq!(report(&["build", "no.ron"]), bad("no.ron", 1));
    assert_eq!(report(&["check", "no.ron"]), bad("no.ron", 1));
    assert_eq!(report(&["check", "no.poly"]), bad("no.poly", 1));
    assert_eq!(report(&["convert", "no.off", "a.obj"]), bad("no.off", 1));
    assert_eq!(report(&["convert", "a.poly", "a.foo"]), bad("a.poly", 2));
}

/// More threads than there is room for break the library that makes them: the one fault of gsm's own that can be had on demand.
#[cfg(target_os = "linux")]
#[test]
fn faults_of_gsm_itself_have_the_shape_of_others() {
    let folder = folder("cli-internal");
    fs::write(folder.join("good.ron"), GOOD).unwrap();
    assert_eq!(gsm(["build", "good.ron", "-q"], &folder).status.code(), Some(0));
    let run = |option: &str| {
        let limited = format!("ulimit -v 600000; exec '{}' check good.poly --threads 1024 {option}", env!("CARGO_BIN_EXE_gsm"));
        Command::new("sh").args(["-c", &limited]).current_dir(&folder).output().unwrap()
    };
    let (text, json) = (run(""), run("--json"));
    assert_eq!((text.status.code(), json.status.code()), (Some(70), Some(70)));
    let said = String::from_utf8(text.stderr).unwrap();
    assert!(text.stdout.is_empty() && said.contains("internal error") && said.contains("please report"), "{said}");
    let report: Value = serde_json::from_slice(&json.stdout).unwrap();
    let fault = &report["errors"][0];
    assert_eq!((&report["file"], &fault["severity"]), (&Value::from("good.poly"), &Value::from("internal")));
    assert!(json.stderr.is_empty() && report["warnings"].is_array() && fault["message"].is_string(), "{report}");
}

#[test]
fn files_that_cannot_be_read_are_told_in_words() {
    let folder = folder("cli-unreadable");
    for name in ["a.ron", "a.poly", "a.msh", "a.off"] {
        fs::create_dir(folder.join(name)).unwrap();
    }
    for arguments in [
        &["build", "no.ron"][..],
        &["build", "a.ron"],
        &["check", "no.poly"],
        &["check", "a.poly"],
        &["convert", "no.msh", "b.obj"],
        &["convert", "a.msh", "b.obj"],
        &["convert", "no.off", "b.obj"],
        &["convert", "a.off", "b.obj"],
    ] {
        let run = gsm(arguments, &folder);
        let said = String::from_utf8([run.stdout, run.stderr].concat()).unwrap();
        let why = if arguments[1].starts_with("no") { "there is no such file" } else { "it is a folder" };
        assert!(said.contains(&format!("cannot read {}: {why}", arguments[1])) && said.contains("hint: "), "{said}");
        assert!(!said.contains("os error"), "{said}");
        assert_eq!(run.status.code(), Some(1), "{arguments:?}");
    }
    let run = gsm(["convert", "a.vtu", "b.obj"], &folder);
    let said = String::from_utf8(run.stderr).unwrap();
    assert!([".msh", ".mesh", ".poly", ".smesh", ".obj", ".off", ".stl"].iter().all(|e| said.contains(e)), "{said}");
}

#[test]
fn conversions_keep_names_and_region_points() {
    let folder = folder("cli-names");
    // With a cavity, a named boundary and a wanted volume.
    let text = r#"Scene(units: "mm", parts: [
        Part(name: "shell", max_volume: 3, solid: Difference([Block(size: (4, 4, 4), center: (0, 0, 0)),
             Block(size: (1, 1, 1), center: (0, 0, 0))]), boundaries: [Side(name: "foot", side: "bottom")]),
        Part(name: "lid", solid: Block(size: (4, 4, 1), at: (-2, -2, 2)))])"#;
    fs::write(folder.join("a.ron"), text).unwrap();
    let good = |arguments: &[&str]| {
        let run = gsm(arguments, &folder);
        let said = String::from_utf8([run.stdout, run.stderr].concat()).unwrap();
        assert_eq!(run.status.code(), Some(0), "{arguments:?}: {said}");
    };
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    good(&["build", "a.ron"]);
    good(&["convert", "a.poly", "b.smesh"]);
    // It has its cavity and regions, and its manifest is that of its triangles.
    good(&["check", "b.smesh"]);
    let lists = |name: &str| read(name).split_once("# voids").unwrap().1.to_owned();
    assert_eq!(lists("b.smesh"), lists("a.poly"));
    // So does the surface of a mesh.
    good(&["mesh", "a.ron", "-o", "h.smesh"]);
    good(&["check", "h.smesh"]);
    // From format to format the names of the markers stay.
    for [from, to] in [["a.poly", "c.obj"], ["c.obj", "d.stl"], ["d.stl", "e.off"], ["e.off", "f.obj"], ["f.obj", "g.msh"]] {
        good(&["convert", from, to]);
    }
    for name in ["shell|lid", "shell|outer", "lid|outer", "foot"] {
        for (file, line) in [("d.stl", "solid "), ("f.obj", "g "), ("g.msh", "2 ")] {
            let is_named = |l: &str| l.starts_with(line) && l.replace('"', "").ends_with(&format!(" {name}"));
            assert_eq!(read(file).lines().filter(|l| is_named(l)).count(), 1, "{file} {name}");
        }
    }
}
