use gsm::brep::complex::Complex;
use gsm::geom::Vec3;
use gsm::ids::Id;
use gsm::primitive::solid::Shape;
use gsm::remesh::remesh;
use gsm::scene::model::{RemeshMode as Mode, RemeshOptions as Options};
fn write_poly(complex: &Complex, name: &str) {
    let Ok(folder) = std::env::var("GSM_TEST_POLYS") else { return };
    let mut text = format!("{} 3 0 0\n", complex.vertices.len());
    for (id, v) in complex.vertices.enumerate() {
        text += &format!("{} {} {} {}\n", id.0, v.point.x, v.point.y, v.point.z);
    }
    text += &format!("{} 1\n", complex.facets.len());
    for f in complex.facets.iter() {
        text += &format!("{} {} {}\n", f.loops.len(), f.loops.len() - 1, f.surface.0 + 1);
        for walk in &f.loops {
            let ids: Vec<String> = walk.iter().map(|v| v.0.to_string()).collect();
            text += &format!("{} {}\n", walk.len(), ids.join(" "));
        }
        for (k, walk) in f.loops.iter().skip(1).enumerate() {
            let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
            let back: Vec<u32> = walk.iter().rev().map(|v| v.0).collect();
            let tiles = gsm::geom::polygon::triangulate(&[&back], &[], &[], &points).unwrap();
            let c = tiles[0].iter().map(|&v| points[v as usize]).sum::<Vec3>() / 3.0;
            text += &format!("{} {} {} {}\n", k + 1, c.x, c.y, c.z);
        }
    }
    std::fs::write(format!("{folder}/{name}.poly"), text + "0\n0\n").unwrap();
}

fn main() {
    let path = std::env::var("GSM_TEST_SCENE").unwrap();
    let path = std::path::Path::new(&path);
    let sets = std::env::var("GSM_SET").ok().map(|s| s.split_once('=').map(|(a, b)| (a.to_string(), b.to_string())).unwrap());
    let sets: Vec<(String, String)> = sets.into_iter().collect();
    let scene = gsm::scene::load(path, &sets, &Default::default()).unwrap().scene;
    let solids = gsm::primitive::build(&scene).unwrap();
    let made = gsm::evaluate::evaluate(&scene, &solids).unwrap().complex;
    let deviation = std::env::var("GSM_DEV").ok().map(|d| d.parse().unwrap());
    let name = path.file_stem().unwrap().to_str().unwrap().to_string();
    write_poly(&made, &format!("{name}_before"));
    let start = std::time::Instant::now();
    let mode = if std::env::var("GSM_LEAN").is_ok() { Mode::Interfaces } else { Mode::Full };
    let after = remesh(made, &Options { mode, max_deviation: deviation, ..Options::default() }, &scene.parts).unwrap();
    println!("{name} {:?}", start.elapsed());
    write_poly(&after, &name);
    let mut sides = String::new();
    for (id, s) in after.surfaces.enumerate() {
        let radius = match &s.shape {
            Shape::Cone { radius, .. } => *radius,
            Shape::Ellipsoid { radii, .. } => radii.x,
            _ => 0.0,
        };
        sides += &format!("{} {radius}\n", id.0 + 1);
    }
    if let Ok(folder) = std::env::var("GSM_TEST_POLYS") {
        std::fs::write(format!("{folder}/{name}.radii"), sides).unwrap();
    }
}
