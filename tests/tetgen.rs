//! TetGen meshes every valid complex, and what it returns is verified. Needs `tetgen` (apt-get install tetgen).

#![allow(clippy::print_stdout)] // shown by --nocapture

mod common;

use common::{Builder, rings, rotated};
use gsm::geom::Vec3;
use gsm::tetgen::ladder::Options;
use gsm::tetgen::{Input, find, mesh};
use std::path::Path;

#[test]
fn a_cube_of_two_layers() {
    let mut builder = Builder::default();
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    builder.prism(&square, [0.0, 0.4], 1, "lower", true);
    builder.prism(&square, [0.4, 1.0], 2, "upper", true);
    let programs = find::find(None).expect("TetGen is needed: apt-get install tetgen");
    let options = Options { max_volume: Some(0.01), ..Options::default() };
    let meshed = mesh(&builder.finish(), &programs, &options).unwrap();
    assert_eq!(meshed.attempts.len(), 1);
    assert!(meshed.mesh.tets.len() > 100);
    assert!((meshed.mesh.volumes()[&1] - 0.4).abs() < 1e-12);
    let names: Vec<_> = meshed.mesh.markers.values().map(String::as_str).collect();
    assert_eq!(names.len(), 3);
    assert!(names.contains(&"lower|upper"));
}

#[test]
fn rings_in_every_rotation() {
    let programs = find::find(None).expect("TetGen is needed: apt-get install tetgen");
    let straight = mesh(&rings(), &programs, &Options::default()).unwrap();
    for seed in 1..=6 {
        let input = rotated(rings(), seed);
        let meshed = mesh(&input, &programs, &Options::default()).unwrap();
        let story: Vec<_> = meshed.attempts.iter().map(|a| format!("{a}: {} {:.1}s", a.verdict, a.seconds)).collect();
        println!("{seed}: {} of {} tetrahedra; {story:?}", meshed.mesh.tets.len(), straight.mesh.tets.len());
        assert_eq!(meshed.moved, 0.0);
        // The vertices come back bit for bit.
        assert!(input.plc.vertices.iter().all(|p| meshed.mesh.nodes.iter().any(|q| p == q)));
    }
}

#[test]
fn cylinders_turned_against_each_other() {
    let circle: Vec<[f64; 2]> =
        (0..24).map(|k| std::f64::consts::TAU * k as f64 / 24.0).map(|t| [libm::cos(t), libm::sin(t)]).collect();
    let programs = find::find(None).expect("TetGen is needed: apt-get install tetgen");
    for seed in 1..=4 {
        // Five cylinders, apart and each askew in its own way: no frame is good for more than one.
        let mut all = Input::default();
        for k in 0..5u32 {
            let mut builder = Builder::default();
            builder.prism(&circle, [0.0, 1.0], k + 1, &format!("cylinder{k}"), true);
            common::append(
                &mut all,
                rotated(builder.finish(), 5 * seed + u64::from(k)),
                Vec3::new(4.0 * f64::from(k), 0.0, 0.0),
            );
        }
        let meshed = mesh(&all, &programs, &Options::default()).unwrap();
        let story: Vec<_> = meshed.attempts.iter().map(|a| format!("{a}: {} {:.1}s", a.verdict, a.seconds)).collect();
        println!("{seed}: {} tetrahedra; {story:?}", meshed.mesh.tets.len());
        assert_eq!(meshed.moved, 0.0);
        assert_eq!(meshed.mesh.volumes().len(), 5);
    }
}

#[test]
fn an_invalid_complex_is_explained_by_names() {
    let mut builder = Builder::default();
    let square = |x: f64| [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]];
    builder.prism(&square(0.0), [0.0, 1.0], 1, "left", true);
    builder.prism(&square(0.5).map(|[x, y]| [x, y + 0.2]), [0.3, 0.6], 2, "right", true);
    let programs = find::find(None).expect("TetGen is needed: apt-get install tetgen");
    let faults = mesh(&builder.finish(), &programs, &Options::default()).unwrap_err();
    assert_eq!(faults[0].code, "tetgen-failed");
    let finding = faults.iter().find(|f| f.code == "tetgen-facets").expect("no finding");
    assert!(finding.message.contains("`left|outer`") && finding.message.contains("`right|outer`"), "{}", finding.message);
    assert!(!finding.points.is_empty());
}

#[test]
fn a_missing_program_is_a_clear_message() {
    let fault = find::find(Some(Path::new("/nowhere/tetgen"))).unwrap_err();
    assert_eq!(fault.code, "no-tetgen");
}

/// A program that meshes as TetGen does, but for the runs up to the given number ignores the quality and makes small
/// tetrahedra.
#[cfg(unix)]
fn endless(runs: u32) -> std::path::PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("endless{runs}"));
    drop(std::fs::remove_dir_all(&folder));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("tetgen");
    let script = format!(
        "#!/bin/sh\n[ \"$1\" = -h ] && exec tetgen -h\necho run >> {count}\n\
         [ $(wc -l < {count}) -gt {runs} ] && exec tetgen \"$@\"\nexec tetgen -pAa0.001 m.poly\n",
        count = folder.join("count").display(),
    );
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[cfg(unix)]
fn cube() -> Input {
    let mut builder = Builder::default();
    builder.prism(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], [0.0, 1.0], 1, "cube", true);
    builder.finish()
}

#[test]
#[cfg(unix)]
fn after_an_endless_refinement_other_attempts_are_made() {
    let programs = find::find(Some(&endless(2))).unwrap();
    let meshed = mesh(&cube(), &programs, &Options { ratio: 1.2, ..Options::default() }).unwrap();
    let verdicts: Vec<&str> = meshed.attempts.iter().map(|a| a.verdict.as_str()).collect();
    assert_eq!(verdicts.len(), 3, "{verdicts:?}");
    assert!(verdicts[0].contains("without end") && verdicts[1].contains("without end") && verdicts[2] == "good");
    assert!(meshed.mesh.tets.len() < 100 && meshed.warnings.is_empty());
}

#[test]
#[cfg(unix)]
fn if_all_are_refined_without_end_the_smallest_is_given_with_a_warning() {
    let programs = find::find(Some(&endless(1000))).unwrap();
    let meshed = mesh(&cube(), &programs, &Options { ratio: 1.2, ..Options::default() }).unwrap();
    assert_eq!((meshed.moved, meshed.warnings.len()), (0.0, 1));
    assert_eq!(meshed.warnings[0].code, "endless-refinement");
    let count = |verdict: &str| verdict.split_whitespace().find_map(|w| w.parse::<usize>().ok()).unwrap();
    let counts: Vec<usize> = meshed.attempts.iter().map(|a| count(&a.verdict)).collect();
    assert!(counts.len() > 3 && counts.iter().min() == Some(&meshed.mesh.tets.len()), "{counts:?}");
}
