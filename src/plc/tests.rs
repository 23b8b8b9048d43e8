//! Hand-made complexes through [`build`], [`check`] and TetGen.

use super::samples::{self, Sample};
use super::{Plc, build, check, measure};
use crate::io::manifest::Manifest;
use crate::io::poly;
use std::collections::BTreeMap;
use std::process::Command;

fn all() -> Vec<(&'static str, Sample)> {
    let plain = [
        ("cube", samples::cube()),
        ("two cubes", samples::two_cubes()),
        ("hole", samples::through_hole(false)),
        ("ring with plug", samples::through_hole(true)),
        ("box in box", samples::shell(0.25, false)),
        ("void", samples::shell(0.25, true)),
        ("thin shell", samples::shell(1e-6, true)),
        ("touching", samples::touching()),
    ];
    plain.iter().cloned().chain(plain.iter().map(|(n, s)| (*n, s.clone().rotated()))).collect()
}

fn built(sample: &Sample) -> (Plc, Manifest, Vec<f64>) {
    let complex = sample.complex();
    let scene = sample.scene();
    let plc = build::build(&complex, &scene.parts).unwrap();
    let measures = measure::measure(&complex);
    let manifest = Manifest::new(&scene, &complex, &measures, &plc);
    (plc, manifest, measures.volumes.iter().copied().collect())
}

#[test]
fn every_sample_is_valid_and_has_its_seeds() {
    for (name, sample) in all() {
        let (plc, manifest, _) = built(&sample);
        assert_eq!(check::check(&plc, Some(&manifest)), [], "{name}");
        assert_eq!(check::check_complex(&sample.complex(), &plc, &manifest), [], "{name}");
        let text = poly::to_text(&plc, Some(&manifest));
        assert_eq!(poly::parse(&text, None, false).unwrap(), plc, "{name}");
    }
}

#[test]
fn volumes_and_areas_are_those_of_the_blocks() {
    let (_, manifest, volumes) = built(&samples::through_hole(true));
    assert_eq!(volumes, [0.0, 24.0, 3.0]);
    let wall = manifest.markers.iter().find(|m| m.name == "p1|p0").unwrap();
    assert_eq!((wall.area, wall.facets, wall.interface), (12.0, 4, wall.marker));
    let ring = &manifest.regions[0];
    assert_eq!((ring.volume, ring.seeds.len(), ring.part.as_str()), (24.0, 1, "p0"));
}

#[test]
fn manifest_reads_back() {
    let (_, manifest, _) = built(&samples::two_cubes());
    let text = manifest.to_json().unwrap();
    assert_eq!(serde_json::from_str::<Manifest>(&text).unwrap(), manifest);
    let order: Vec<usize> =
        ["\"gsm\"", "\"scene\"", "\"unit\"", "\"markers\"", "\"regions\"", "\"counts\""].map(|k| text.find(k).unwrap()).into();
    assert!(order.is_sorted());
}

/// Volumes by region number in TetGen's mesh, and how often each marker is among its boundary triangles.
fn tetgen(text: &str, switches: &str, name: &str) -> (BTreeMap<i64, f64>, BTreeMap<i64, usize>) {
    let folder = std::env::temp_dir().join(format!("gsm-plc-{}-{}", std::process::id(), name.replace(' ', "-")));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("m.poly"), text).unwrap();
    let output = Command::new("tetgen").arg(switches).arg("m.poly").current_dir(&folder).output();
    let output = output.expect("tests need TetGen: apt-get install tetgen");
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stdout));
    let rows = |ending: &str| -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(folder.join(format!("m.1.{ending}"))).unwrap();
        let lines = text.lines().filter(|l| !l.trim_start().starts_with('#')).skip(1);
        lines.map(|l| l.split_whitespace().map(|w| w.parse().unwrap()).collect()).collect()
    };
    let nodes = rows("node");
    let mut volumes = BTreeMap::new();
    for e in rows("ele") {
        let p = |k: usize| crate::geom::Vec3::from_column_slice(&nodes[e[k] as usize - 1][1..4]);
        let volume = (p(2) - p(1)).cross(&(p(3) - p(1))).dot(&(p(4) - p(1))).abs() / 6.0;
        *volumes.entry(e[5] as i64).or_insert(0.0) += volume;
    }
    let mut markers = BTreeMap::new();
    for f in rows("face") {
        *markers.entry(f[4] as i64).or_insert(0) += 1;
    }
    std::fs::remove_dir_all(&folder).unwrap();
    (volumes, markers)
}

#[test]
fn tetgen_meshes_every_sample_with_its_volumes_and_markers() {
    for (k, (name, sample)) in all().into_iter().enumerate() {
        let (plc, manifest, _) = built(&sample);
        // Good tetrahedra in a wall of 1e-6 would be 1e12.
        let switches = if name == "thin shell" { "-pA" } else { "-pAq2.0" };
        let text = poly::to_text(&plc, Some(&manifest));
        let (volumes, markers) = tetgen(&text, switches, &format!("{name} {k}"));
        let expected: Vec<i64> = manifest.regions.iter().filter(|r| !r.seeds.is_empty()).map(|r| r.region).collect();
        assert_eq!(volumes.keys().copied().collect::<Vec<_>>(), expected, "{name}");
        for region in manifest.regions.iter().filter(|r| !r.seeds.is_empty()) {
            let relative = volumes[&region.region] / region.volume - 1.0;
            assert!(relative.abs() < 1e-9, "{name}: region {} differs by {relative:e}", region.region);
        }
        let listed = manifest.markers.iter().map(|m| m.marker).collect::<Vec<_>>();
        assert_eq!(markers.keys().copied().collect::<Vec<_>>(), listed, "{name}");
    }
}
