//! Every scene under random rotations and a far translation: the same regions, interfaces and topology, and a volume mesh.
//! Needs `tetgen` (apt-get install tetgen).

#![allow(clippy::print_stdout)] // shown by --nocapture

use gsm::brep::complex::Complex;
use gsm::brep::model::Brep;
use gsm::evaluate::evaluate;
use gsm::geom::aabb::Aabb;
use gsm::geom::embedding::violations;
use gsm::geom::{Affine, Vec3};
use gsm::ids::{Id, PartId};
use gsm::plc;
use gsm::primitive;
use gsm::remesh::remesh;
use gsm::report::timing::Timings;
use gsm::scene::model::{RemeshMode, RemeshOptions, Scene};
use gsm::scene::{self, Limits};
use gsm::tetgen::{self, Input, Meshed, Options, Program, find};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Rotations per scene; the larger number of issue 3 is reached by setting GSM_ROTATIONS.
const ROTATIONS: u64 = 3;

/// Rotations of each scene up to the volume mesh; with the far place three, so that one that meshes worse is not the median.
const MESHED_ROTATIONS: u64 = 2;

const SCENES: [(&str, &str); 9] = [
    ("prism_holes", ""),
    ("cone", ""),
    ("union_two_differences", ""),
    ("cylinders_union_difference", ""),
    ("three_cylinders", ""),
    ("transformer3", ""),
    ("machine", ""),
    ("team07", ""),
    ("sphere_grid", "n=2"),
];

fn scene_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("ron")
}

fn load(name: &str, set: &str) -> Scene {
    let path = scene_path(name);
    let sets: Vec<(String, String)> = set.split_once('=').map(|(a, b)| (a.to_string(), b.to_string())).into_iter().collect();
    scene::load(&path, &sets, &Limits::default()).unwrap_or_else(|e| panic!("{name}: {e:?}")).scene
}

fn build(scene: &Scene) -> Result<Complex, String> {
    let solids = primitive::build(scene).map_err(|e| format!("{e:?}"))?;
    evaluate(scene, &solids, &mut Timings::default()).map(|e| e.complex).map_err(|e| format!("{e:?}"))
}

fn moved(scene: &Scene, map: &Affine) -> Scene {
    let mut out = scene.clone();
    for leaf in out.leaves.iter_mut() {
        leaf.transform = map * leaf.transform;
    }
    out
}

/// A rotation about a pseudo-random axis.
fn rotation(seed: u64) -> Affine {
    let f = |k: u64| {
        let x = (seed * 8 + k).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let x = (x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((x ^ (x >> 32)) % 1_000_003) as f64 / 1_000_003.0 - 0.5
    };
    let axis = nalgebra::Unit::new_normalize(Vec3::new(f(1), f(2), f(3)));
    nalgebra::convert(nalgebra::Rotation3::from_axis_angle(&axis, 6.0 * f(4)))
}

/// The three exact rotations that take axes to axes in a cycle.
fn cyclic() -> [Affine; 3] {
    let cycle = nalgebra::Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    [0, 1, 2].map(|n| Affine::from_matrix_unchecked(cycle.pow(n).to_homogeneous()))
}

/// The middle one, the larger of two.
fn median(counts: &[usize]) -> usize {
    let mut sorted = counts.to_vec();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).copied().unwrap_or(0)
}

fn translation(by: Vec3) -> Affine {
    Affine::from_matrix_unchecked(nalgebra::Matrix4::new_translation(&by))
}

/// A translation by 1000 times the size.
fn far_away(complex: &Complex) -> Affine {
    translation(Vec3::new(0.48, -0.6, 0.64) * (1000.0 * size(complex)))
}

fn size(complex: &Complex) -> f64 {
    Aabb::around(complex.vertices.iter().map(|v| &v.point)).diagonal()
}

/// Places in which the axes of a scene are those of space: which is which TetGen's count depends on by some per cent, and as
/// much on rounding, as what the remesher does depends on it where lengths or angles are equal. So all but the first are moved,
/// by no round number: without that, a symmetrical scene would be one sample (straight sphere grids take 10100 to 12300
/// tetrahedra, moved like this; turned ones 10400 to 13700, and one of seven 17000).
fn straight(count: u64, size: f64) -> impl Iterator<Item = Affine> {
    let by = move |k: u64| Vec3::new(0.0317, -0.0541, 0.0713) * (k as f64 * size);
    (0..count).map(move |k| translation(by(k)) * cyclic()[k as usize % 3])
}

/// What must not change: counts per interface, and measures.
#[derive(Debug, PartialEq)]
struct Topology {
    vertices: usize,
    facets: usize,
    regions: usize,
    interfaces: BTreeMap<String, usize>,
}

fn topology(complex: &Complex) -> Topology {
    let mut interfaces = BTreeMap::new();
    for facet in &complex.facets {
        *interfaces.entry(complex.markers[facet.marker].name.clone()).or_default() += 1;
    }
    Topology { vertices: complex.vertices.len(), facets: complex.facets.len(), regions: complex.regions.len(), interfaces }
}

fn volumes(complex: &Complex) -> Vec<f64> {
    let mut out = vec![0.0; complex.regions.len()];
    let origin = complex.vertices.as_slice()[0].point;
    for facet in &complex.facets {
        for t in &facet.triangles {
            let [a, b, c] = t.map(|v| complex.vertices[v].point - origin);
            let volume = a.dot(&b.cross(&c)) / 6.0;
            out[facet.sides[0].index()] -= volume;
            out[facet.sides[1].index()] += volume;
        }
    }
    out
}

fn assert_alike(name: &str, what: &str, reference: &Complex, other: &Complex, tolerance: f64) {
    assert_eq!(topology(reference), topology(other), "{name} {what}");
    for (a, b) in volumes(reference).iter().zip(volumes(other)) {
        assert!((a - b).abs() <= tolerance * a.abs(), "{name} {what}: volume {a} became {b}");
    }
}

fn rotations(usual: u64) -> u64 {
    std::env::var("GSM_ROTATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

/// Part of the names of the scenes to run, for looking into one.
fn only() -> String {
    std::env::var("GSM_SCENE").unwrap_or_default()
}

#[test]
fn rotated_scenes_are_alike() {
    let count = rotations(ROTATIONS);
    let only = only();
    let mut failures = Vec::new();
    for (name, set) in SCENES.iter().filter(|s| s.0.contains(&only)) {
        let scene = load(name, set);
        let reference = build(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let brep = Brep::from_complex(reference.clone()).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        assert!(brep.check().is_empty(), "{name}: {:?}", brep.check());
        for seed in 0..count {
            let turned = moved(&scene, &rotation(seed));
            match build(&turned) {
                Err(e) => failures.push(format!("{name} rotation {seed}: {e}")),
                Ok(complex) => {
                    let check = std::panic::catch_unwind(|| {
                        assert_alike(name, &format!("rotation {seed}"), &reference, &complex, 1e-9)
                    });
                    if check.is_err() {
                        failures.push(format!("{name} rotation {seed}: differs"));
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Parts of the pieces, and the interfaces.
fn pieces(complex: &Complex) -> (Vec<Option<PartId>>, BTreeSet<String>) {
    (complex.regions.iter().map(|r| r.part).collect(), topology(complex).interfaces.into_keys().collect())
}

/// Curved faces that coincide are cut alike also as triangles: no piece of air is left between them.
#[test]
fn triangulated_scenes_have_the_same_pieces() {
    for (name, set) in SCENES {
        let scene = load(name, set);
        let expected = pieces(&build(&scene).unwrap());
        let mut cut = scene.clone();
        cut.leaves.iter_mut().for_each(|leaf| leaf.is_triangulated = true);
        for (place, mode) in
            [(Affine::identity(), RemeshMode::Full), (rotation(11), RemeshMode::Off), (rotation(12), RemeshMode::Interfaces)]
        {
            let complex = build(&moved(&cut, &place)).unwrap_or_else(|e| panic!("{name} {mode:?}: {e}"));
            let options = RemeshOptions { mode, ..scene.remesh };
            let complex = remesh(complex, &options, &scene.parts).unwrap_or_else(|e| panic!("{name} {mode:?}: {e:?}"));
            assert_eq!(pieces(&complex), expected, "{name} {mode:?}");
        }
    }
}

#[test]
fn far_scenes_are_alike() {
    for (name, set) in SCENES {
        let scene = load(name, set);
        let reference = build(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let complex = build(&moved(&scene, &far_away(&reference))).unwrap_or_else(|e| panic!("{name} far: {e}"));
        assert_alike(name, "far away", &reference, &complex, 1e-6);
    }
}

/// Scene to volume mesh.
fn mesh(scene: &Scene, programs: &[Program]) -> Result<Meshed, String> {
    let complex = build(scene)?;
    let complex = remesh(complex, &scene.remesh, &scene.parts).map_err(|e| format!("{e:?}"))?;
    let plc = plc::build::build(&complex, &scene.parts).map_err(|e| format!("{e:?}"))?;
    tetgen::mesh(&Input::new(plc, &complex, &scene.parts), programs, &Options::default()).map_err(|e| format!("{e:?}"))
}

/// Issue 5, point 1: no failure; the ladder itself compares volumes to 1e-9. The rungs are shown by `--nocapture`.
#[test]
fn rotated_scenes_are_meshed() {
    let programs = find::find(None).expect("TetGen is needed: apt-get install tetgen");
    let mut failures = Vec::new();
    for (name, set) in SCENES.iter().filter(|s| s.0.contains(&only())) {
        let scene = load(name, set);
        let complex = build(&scene).unwrap();
        let turns = rotations(MESHED_ROTATIONS);
        let plain: Vec<usize> = straight(turns + 1, size(&complex))
            .map(|place| mesh(&moved(&scene, &place), &programs).unwrap_or_else(|e| panic!("{name}: {e}")).mesh.tets.len())
            .collect();
        let plain = median(&plain);
        let places = (0..turns).map(rotation).chain([far_away(&complex)]);
        let mut counts = Vec::new();
        let mut rungs: BTreeMap<String, usize> = BTreeMap::new();
        for (k, place) in places.enumerate() {
            match mesh(&moved(&scene, &place), &programs) {
                Err(e) => failures.push(format!("{name} place {k}: {e}")),
                Ok(meshed) => {
                    counts.push(meshed.mesh.tets.len());
                    *rungs.entry(meshed.attempts.last().map(ToString::to_string).unwrap_or_default()).or_default() += 1;
                    if meshed.moved > 0.0 {
                        failures.push(format!("{name} place {k}: vertices were moved by {}", meshed.moved));
                    }
                }
            }
        }
        let turned = median(&counts);
        println!("{name}: {plain} tetrahedra, median of {} places {turned}; {rungs:?}", counts.len());
        if turned as f64 > 1.1 * plain as f64 {
            failures.push(format!("{name}: median of {turned} tetrahedra instead of {plain}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// TetGen 1.5 aborts on the tour as it is when its frustum lies askew, and when bent merges facets of the torus to another
/// volume.
#[test]
fn an_askew_frustum_is_meshed() {
    let text = fs::read_to_string(scene_path("tour")).unwrap();
    let askew = text.replace("base: (85, -30, 0), axis: Y", "base: (85, -30, 0), axis: (0, 1, 2)");
    assert_ne!(text, askew);
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("askew_tour.ron");
    fs::write(&path, askew).unwrap();
    let scene = scene::load(&path, &[], &Limits::default()).unwrap().scene;
    let meshed = mesh(&scene, &find::find(None).unwrap()).unwrap();
    assert_eq!(meshed.moved, 0.0);
}

fn mesh_evaluated(name: &str, mode: RemeshMode) -> Meshed {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/evaluated/{name}.ron"));
    let mut scene = scene::load(&path, &[], &Limits::default()).unwrap().scene;
    scene.remesh.mode = mode;
    mesh(&scene, &find::find(None).unwrap()).unwrap()
}

/// Without remeshing TetGen aborts in every exact attempt. The triangles of a polygon whose corners were moved are nearly
/// coplanar; TetGen must not merge them to another volume.
#[test]
fn an_askew_machine_is_meshed() {
    let meshed = mesh_evaluated("askew_machine", RemeshMode::Off);
    assert!(meshed.moved <= 1e-7, "vertices were moved by {}", meshed.moved);
}

/// Remeshing it leaves no needles, of which TetGen dies too.
#[test]
fn an_askew_machine_is_remeshed_and_meshed() {
    let meshed = mesh_evaluated("askew_machine", RemeshMode::Interfaces);
    assert_eq!(meshed.moved, 0.0);
}

/// A finished mesh whose regions have other volumes is made again in another way before anything else is changed.
#[test]
fn askew_magnets_are_meshed() {
    for mode in [RemeshMode::Off, RemeshMode::Interfaces] {
        let meshed = mesh_evaluated("askew_magnets", mode);
        assert_eq!(meshed.moved, 0.0, "{mode:?}");
    }
}

/// Remeshed at interfaces: nothing meets anything, the kernel accepts it, regions and interfaces stay, volumes nearly.
#[test]
fn remeshed_scenes_are_valid_when_rotated() {
    for (name, set) in SCENES {
        let scene = moved(&load(name, set), &rotation(7));
        let evaluated = build(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let options = RemeshOptions { mode: RemeshMode::Interfaces, ..scene.remesh };
        let done = remesh(evaluated.clone(), &options, &scene.parts).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        let points: Vec<Vec3> = done.vertices.iter().map(|v| v.point).collect();
        let triangles: Vec<[u32; 3]> = done.facets.iter().flat_map(|f| f.triangles.iter().map(|t| t.map(|v| v.0))).collect();
        assert_eq!(violations(&points, &triangles, 9).len(), 0, "{name}");
        let (before, after) = (topology(&evaluated), topology(&done));
        assert_eq!(before.regions, after.regions, "{name}");
        assert!(before.interfaces.keys().eq(after.interfaces.keys()), "{name}");
        // A circle's 24 chords take 1.1 % of its area.
        for (a, b) in volumes(&evaluated).iter().zip(volumes(&done)) {
            assert!((a - b).abs() <= 0.012 * a.abs(), "{name}: volume {a} became {b}");
        }
        let brep = Brep::from_complex(done).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        assert!(brep.check().is_empty(), "{name}: {:?}", brep.check());
    }
}
