//! What the tests of the whole program share: running it, its scenes, folders to write to.
#![allow(dead_code)]

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Scenes of the measurements with the parameters that they are built with.
pub const SCENES: [(&str, &[&str]); 11] = [
    ("prism_holes", &[]),
    ("cone", &[]),
    ("union_two_differences", &[]),
    ("cylinders_union_difference", &[]),
    ("three_cylinders", &[]),
    ("transformer3", &[]),
    ("machine", &[]),
    ("team07", &[]),
    ("sphere_grid", &["--set", "n=2"]),
    ("sphere_grid", &["--set", "n=3"]),
    ("tour", &[]),
];

/// Name of a scene with its parameters, good for a file.
pub fn label(name: &str, arguments: &[&str]) -> String {
    arguments.get(1).map_or(name.to_owned(), |set| format!("{name}_{}", set.replace('=', "")))
}

/// A file of this repository.
pub fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The file of a scene.
pub fn scene(name: &str) -> PathBuf {
    root("scenes").join(name).with_extension("ron")
}

/// An empty folder for one test.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    drop(fs::remove_dir_all(&folder));
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs gsm in a folder.
pub fn gsm<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>, folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gsm")).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs `gsm build --json` on a scene, with more arguments; it has to succeed.
pub fn build(scene: &Path, arguments: &[&str], folder: &Path) -> Value {
    let run = gsm(["build", text(scene), "--json"].iter().chain(arguments), folder);
    let said = String::from_utf8_lossy(&run.stdout);
    assert_eq!(run.status.code(), Some(0), "{}: {said}\n{}", scene.display(), String::from_utf8_lossy(&run.stderr));
    serde_json::from_str(&said).unwrap()
}

/// A path as text.
pub fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Names of the files in a folder, sorted.
pub fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Runs a Python program of the repository, with the Python of `GSM_PYTHON` or of tools/setup-tests.sh, and gives its output.
pub fn python(program: &str, arguments: &[&str]) -> String {
    let own = root("target/clients/bin/python");
    let python = std::env::var_os("GSM_PYTHON").map_or(own, PathBuf::from);
    let hint = "tools/setup-tests.sh installs the Python that the tests need";
    let run = Command::new(&python).arg(root(program)).args(arguments).output();
    let run = run.unwrap_or_else(|e| panic!("{}: {e}; {hint}", python.display()));
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(run.status.success(), "{program} ({hint}):\n{said}\n{}", String::from_utf8_lossy(&run.stderr));
    said
}
