//! The outside judge (tools/judge.py, which never calls gsm) passes every scene, as written and turned about an arbitrary axis.

mod support;

use gsm::evaluate::evaluate;
use gsm::geom::{Affine, Vec3};
use gsm::io::manifest::{self, Manifest};
use gsm::io::poly;
use gsm::plc::{self, check, measure};
use gsm::report::timing::Timings;
use gsm::scene::{Limits, load};
use std::fs;
use std::path::Path;
use support::{SCENES, build, folder, label, python, scene, text};

fn judge(files: &[std::path::PathBuf]) {
    let said = python("tools/judge.py", &files.iter().map(|f| text(f)).collect::<Vec<_>>());
    assert_eq!(said.lines().filter(|line| line.contains(": good")).count(), files.len(), "{said}");
}

#[test]
fn scenes_pass_the_outside_judge() {
    let folder = folder("judge");
    let files = SCENES.map(|(name, arguments)| {
        let file = folder.join(label(name, arguments)).with_extension("poly");
        build(&scene(name), &[arguments, &["-o", text(&file)]].concat(), &folder);
        file
    });
    judge(&files);
}

/// Writes a scene that was turned; it has to pass gsm's own check, with the interfaces of the scene as it stands.
fn turned(name: &str, arguments: &[&str], folder: &Path) -> std::path::PathBuf {
    let sets: Vec<(String, String)> =
        arguments.iter().filter_map(|a| a.split_once('=')).map(|(a, b)| (a.to_owned(), b.to_owned())).collect();
    let mut scene = load(&scene(name), &sets, &Limits::default()).unwrap().scene;
    let turn = nalgebra::Rotation3::new(Vec3::new(0.3, -1.1, 0.7));
    let turn: Affine = nalgebra::convert(turn);
    for leaf in scene.leaves.iter_mut() {
        leaf.transform = turn * leaf.transform;
    }
    let solids = gsm::primitive::build(&scene).unwrap();
    let complex = evaluate(&scene, &solids, &mut Timings::default()).unwrap_or_else(|e| panic!("{name}: {e:?}")).complex;
    let plc = plc::build::build(&complex, &scene.parts).unwrap();
    let manifest = Manifest::new(&scene, &complex, &measure::measure(&complex), &plc);
    let findings = [check::check_complex(&complex, &plc, &manifest), check::check(&plc, Some(&manifest))].concat();
    assert!(findings.is_empty(), "{name}: {findings:?}");
    let path = folder.join(label(name, arguments)).with_extension("poly");
    fs::write(&path, poly::to_text(&plc, Some(&manifest))).unwrap();
    fs::write(manifest::path_beside(&path), manifest.to_json().unwrap()).unwrap();
    path
}

#[test]
fn turned_scenes_pass_both_checks() {
    let folder = folder("judge-turned");
    judge(&SCENES.map(|(name, arguments)| turned(name, arguments, &folder)));
}
