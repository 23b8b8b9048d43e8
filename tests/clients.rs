//! Real readers and solvers on meshes that gsm wrote. `tools/setup-tests.sh` installs them.

#![allow(clippy::print_stdout)] // shown by --nocapture

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn here(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/clients").join(name)
}

/// An empty folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs gsm and gives its output.
fn gsm(arguments: &[&str], folder: &Path) -> String {
    let run = Command::new(env!("CARGO_BIN_EXE_gsm")).args(arguments).current_dir(folder).output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "gsm {arguments:?}: {:?}\n{said}", run.status.code());
    String::from_utf8(run.stdout).unwrap()
}

/// Runs a client with the Python of `GSM_PYTHON`, or that of tools/setup-tests.sh, or whichever there is.
fn client(arguments: &[&str]) {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/clients/bin/python");
    let python = std::env::var_os("GSM_PYTHON")
        .map(PathBuf::from)
        .unwrap_or_else(|| if own.exists() { own } else { PathBuf::from("python3") });
    let run = Command::new(python).arg(here(arguments[0])).args(&arguments[1..]).output().unwrap();
    println!("{}", String::from_utf8_lossy(&run.stdout));
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{arguments:?} (tools/setup-tests.sh installs the clients)\n{said}");
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn plate_capacitor_is_exact() {
    let folder = folder("plate");
    for scene in ["plate.ron", "plate_cut.ron"] {
        for turn in ["turn=0", "turn=37", "turn=-111.25"] {
            let mesh = folder.join("plate.msh");
            gsm(&["mesh", text(&here(scene)), "--set", turn, "--max-volume", "0.002", "-q", "-o", text(&mesh)], &folder);
            client(&["solvers.py", "plate", text(&mesh), text(&folder)]);
        }
    }
}

#[test]
fn iron_in_a_mitred_coil_agrees() {
    let folder = folder("coil");
    let mesh = folder.join("coil.msh");
    gsm(&["mesh", text(&here("coil.ron")), "--ratio", "1.4", "-q", "-o", text(&mesh)], &folder);
    client(&["solvers.py", "coil", text(&mesh), text(&folder)]);
}

#[test]
fn every_format_is_read_with_all_names() {
    let folder = folder("names");
    let mut arguments = vec!["mesh".to_string(), text(&here("names.ron")).into(), "-q".into()];
    for extension in ["vtu", "mesh", "obj", "stl", "ply", "off", "smesh", "glb", "22.msh"] {
        arguments.extend(["-o".to_string(), format!("names.{extension}")]);
    }
    gsm(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), &folder);
    gsm(&["convert", "names.22.msh", "names.41.msh", "--msh", "4.1", "-q"], &folder);
    client(&["formats.py", text(&folder.join("names"))]);
}

#[test]
fn statistics_equal_those_of_numpy_and_scipy() {
    let folder = folder("statistics");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/sphere_in_box.ron");
    let json = gsm(&["mesh", text(&scene), "--condition", "--json", "--max-volume", "60", "-o", "m.msh"], &folder);
    fs::write(folder.join("m.json"), json).unwrap();
    client(&["statistics.py", text(&folder.join("m.msh")), text(&folder.join("m.json"))]);
}

#[test]
fn what_is_converted_there_and_back_is_the_same() {
    let folder = folder("convert");
    gsm(&["mesh", text(&here("plate.ron")), "-q", "-o", "a.msh"], &folder);
    gsm(&["convert", "a.msh", "b.mesh", "-q"], &folder);
    gsm(&["convert", "b.mesh", "c.msh", "--msh", "4.1", "-q"], &folder);
    gsm(&["convert", "c.msh", "d.mesh", "-q"], &folder);
    gsm(&["convert", "a.msh", "e.msh", "-q"], &folder);
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(read("a.msh"), read("e.msh"));
    assert_eq!(read("b.mesh").lines().count(), read("d.mesh").lines().count());
    // A .poly becomes a surface with the same names.
    gsm(&["build", text(&here("plate.ron")), "-q", "-o", "plate.poly"], &folder);
    let said = gsm(&["convert", "plate.poly", "plate.stl"], &folder);
    assert!(said.contains("2 regions"), "{said}");
    assert_eq!(read("plate.stl").matches("endsolid").count(), 2);
}

#[test]
fn a_missed_threshold_is_exit_code_3_and_a_missing_tetgen_4() {
    let folder = folder("codes");
    let run = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_gsm")).args(arguments).current_dir(&folder).output().unwrap().status.code()
    };
    let scene = here("plate.ron");
    assert_eq!(run(&["mesh", text(&scene), "-q", "--min-dihedral", "89"]), Some(3));
    assert!(folder.join("plate.msh").exists());
    // The same demand in the scene; the command line goes before it.
    let strict = folder.join("strict.ron");
    let with_demand = fs::read_to_string(&scene).unwrap().replacen("units:", "mesh: (min_dihedral: 89), units:", 1);
    fs::write(&strict, with_demand).unwrap();
    assert_eq!(run(&["mesh", text(&strict), "-q"]), Some(3));
    assert_eq!(run(&["mesh", text(&strict), "-q", "--min-dihedral", "0.1"]), Some(0));
    assert_eq!(run(&["mesh", text(&scene), "-q", "--tetgen", "/nowhere", "-o", "x.msh"]), Some(4));
    assert_eq!(run(&["mesh", text(&scene), "-q", "-o", "x.docx"]), Some(2));
    assert!(!folder.join("x.msh").exists());
}

/// A TetGen that dies of more than 400 vertices: union_two_differences has them only when it is remeshed.
#[test]
fn where_tetgen_fails_on_remeshed_surfaces_they_are_left_as_evaluated() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder("fallback");
    let program = folder.join("weak_tetgen");
    let script = "#!/bin/sh\nn=$(grep -v '^#' m.poly 2>/dev/null | head -1 | cut -d' ' -f1)\n\
                  [ \"${n:-0}\" -gt 400 ] && kill -ABRT $$\nexec tetgen \"$@\"\n";
    fs::write(&program, script).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/union_two_differences.ron");
    let report: serde_json::Value =
        serde_json::from_str(&gsm(&["mesh", text(&scene), "--tetgen", text(&program), "--json"], &folder)).unwrap();
    let warnings: Vec<&str> = report["warnings"].as_array().unwrap().iter().filter_map(|w| w["code"].as_str()).collect();
    assert_eq!(warnings, ["not-remeshed"]);
    assert_eq!(report["attempts"].as_array().unwrap().len(), 1);
    let plain = gsm(&["mesh", text(&scene), "--remesh", "off", "--json", "-o", "plain.msh"], &folder);
    let plain: serde_json::Value = serde_json::from_str(&plain).unwrap();
    assert_eq!(plain["warnings"].as_array().unwrap().len(), 0);
    assert_eq!(fs::read(folder.join("plain.msh")).unwrap(), fs::read(folder.join("union_two_differences.msh")).unwrap());
}

#[test]
fn two_commands_from_nothing_to_a_mesh() {
    let folder = folder("new");
    for (name, mesh) in [
        ("machine", "machine.msh"),
        ("transformer", "transformer.msh"),
        ("team07", "team07.msh"),
        ("sphere-in-box", "sphere-in-box.msh"),
    ] {
        gsm(&["new", name], &folder);
        gsm(&["mesh", &format!("{name}.ron"), "-q"], &folder);
        assert!(folder.join(mesh).exists());
    }
}
