//! Cubes, as files give them.

use super::*;
use crate::geom::Affine;
use crate::primitive::solid::SolidFacet;
use crate::scene::model::{Division, Primitive};

const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n\
    4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

fn read(name: &str, text: &str) -> Result<Solid, Diagnostic> {
    let path = std::env::temp_dir().join(format!("gsm-import-{}-{name}", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let division = Division { segments: None, max_angle: None, max_chord_error: None };
    let leaf = Leaf {
        primitive: Primitive::Import { path: path.clone(), scale: 2.0 },
        transform: Affine::identity(),
        division,
        tolerance: None,
        is_triangulated: false,
        name: None,
        span: Default::default(),
    };
    let solid = import(&leaf, &path, 2.0);
    std::fs::remove_file(&path).unwrap();
    solid
}

#[test]
fn cube_of_quadrilaterals() {
    let solid = read("a.off", CUBE).unwrap();
    assert_eq!((solid.vertices.len(), solid.facets.len()), (8, 6));
    assert!(solid.vertices.iter().all(|v| v.freedom == Freedom::Fixed));
    assert!(solid.vertices.iter().any(|v| v.point == Vec3::new(2., 2., 2.)));
    let top = solid.facets.iter().find(|f| f.loops.outer().iter().all(|v| solid.vertices[*v as usize].point.z == 2.)).unwrap();
    let points: Vec<Vec3> = solid.vertices.iter().map(|v| v.point).collect();
    assert_eq!(vector_area([top.loops.outer()], &points), Vec3::new(0., 0., 4.));
}

#[test]
fn inside_out_is_turned_and_bent_polygons_are_cut() {
    let mut lines: Vec<String> = CUBE.lines().map(String::from).collect();
    for line in &mut lines[10..] {
        let mut words: Vec<&str> = line.split(' ').collect();
        words[1..].reverse();
        *line = words.join(" ");
    }
    assert_eq!(read("b.off", &lines.join("\n")).unwrap().facets.len(), 6);
    let bent = read("c.off", &CUBE.replace("\n1 1 1\n", "\n1 1 1.5\n")).unwrap();
    assert_eq!(bent.facets.len(), 9 - 2);
}

#[test]
fn faults_are_named() {
    let open = read("d.off", &CUBE.replace("8 6 0", "8 5 0")).unwrap_err();
    assert_eq!((open.code, open.points.len()), ("open-surface", 4));
    assert!(open.hints[0].contains("close its holes"));
    // Two squares with a top corner of their own, 1e-9 apart.
    let near = CUBE.replace("8 6 0", "9 6 0").replace("0 1 1\n", "0 1 1\n0 1 1.000000001\n").replace("4 3 0 4 7", "4 3 0 4 8");
    let fault = read("z.off", &near).unwrap_err();
    assert!(fault.code == "open-surface" && fault.hints[0].contains("`tolerance: 1e-6`"), "{fault:?}");
    let twisted = read("e.off", &CUBE.replace("4 3 0 4 7", "4 7 4 0 3")).unwrap_err();
    assert!(twisted.message.contains("opposite orientation"));
    let doubled = read("i.off", &(CUBE.replace("8 6 0", "8 7 0") + "4 3 0 4 7\n")).unwrap_err();
    assert!(doubled.message.contains("more than two facets"), "{}", doubled.message);
    assert_eq!(read("j.off", &CUBE.replace("1 1 1", "1 1 1e300")).unwrap_err().code, "out-of-range");
    assert_eq!(read("k.off", "OFF\n0 0 0\n").unwrap_err().code, "no-facets");
    let bow = CUBE.replace("4 3 0 4 7", "4 3 4 0 7");
    assert_eq!(read("f.off", &bow).unwrap_err().code, "flat-facet");
    assert_eq!(read("g.off", &CUBE.replace("4 3 0 4 7", "4 3 0 4 8")).unwrap_err().code, "malformed-file");
    assert_eq!(read("h.ply", "").unwrap_err().code, "unknown-format");
}

/// The cube with every side cut into two triangles, and `more` instead of its top.
fn cut(more: &[&str]) -> String {
    let mut lines: Vec<String> = CUBE.lines().take(10).map(String::from).collect();
    for side in CUBE.lines().skip(10) {
        let v: Vec<&str> = side.split(' ').skip(1).collect();
        if side == "4 4 5 6 7" && !more.is_empty() {
            lines.extend(more.iter().map(|m| m.to_string()));
        } else {
            lines.extend([format!("3 {} {} {}", v[0], v[1], v[2]), format!("3 {} {} {}", v[0], v[2], v[3])]);
        }
    }
    lines[1] = format!("9 {} 0", lines.len() - 10);
    lines.insert(10, "0.5 0.5 1".into());
    lines.join("\n") + "\n"
}

#[test]
fn pieces_of_a_plane_become_one_polygon() {
    let corners = |text: &str, name: &str| {
        let solid = read(name, text).unwrap();
        assert!(solid.vertices.iter().all(|v| v.freedom != Freedom::Edge));
        let mut corners: Vec<usize> = solid.facets.iter().map(|f| f.loops.outer().len()).collect();
        corners.sort_unstable();
        corners
    };
    assert_eq!(corners(&cut(&[]), "l.off"), [4; 6]);
    // Turned about an axis, its corners are planar to rounding only.
    let turned = cut(&[]).lines().enumerate().fold(String::new(), |text, (k, line)| match k {
        2..11 => {
            let p: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
            let p = nalgebra::Rotation3::new(Vec3::new(0.3, -1.1, 0.7)) * Vec3::new(p[0], p[1], p[2]);
            text + &format!("{} {} {}\n", p.x, p.y, p.z)
        }
        _ => text + line + "\n",
    });
    assert_eq!(corners(&turned, "m.off"), [4; 6]);
    // A point inside the top must not be lost.
    let star = ["3 4 5 8", "3 5 6 8", "3 6 7 8", "3 7 4 8"];
    assert_eq!(corners(&cut(&star), "n.off"), [3, 3, 3, 3, 4, 4, 4, 4, 4]);
    // A top of two pieces that hang together at a corner only, after one was raised.
    let raised = cut(&star).replace("0.5 0.5 1", "0.5 0.5 1.25");
    assert_eq!(corners(&raised, "o.off"), [3, 3, 3, 3, 4, 4, 4, 4, 4]);
    assert_eq!(read("p.off", &cut(&["3 4 5 6", "3 4 6 7", "3 4 6 5", "3 4 5 6"])).unwrap_err().code, "self-intersection");
}

/// A square plate with a square hole through it, its top, bottom and walls in triangles, turned by this angle.
fn plate_with_hole(angle: f64) -> String {
    let square = |r: f64, z: f64| [[-r, -r, z], [r, -r, z], [r, r, z], [-r, r, z]];
    let turn = nalgebra::Rotation3::new(Vec3::new(0.3, -1.1, 0.7).normalize() * angle);
    let points = [square(3.0, 0.0), square(1.0, 0.0), square(3.0, 1.0), square(1.0, 1.0)].concat();
    let mut lines: Vec<String> =
        points.iter().map(|p| turn * Vec3::from(*p)).map(|p| format!("{} {} {}", p.x, p.y, p.z)).collect();
    let mut quads = Vec::new();
    for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        // Bottom, top, outer wall, wall of the hole.
        quads.extend([
            [a, a + 4, b + 4, b],
            [a + 8, b + 8, b + 12, a + 12],
            [a, b, b + 8, a + 8],
            [b + 4, a + 4, a + 12, b + 12],
        ]);
    }
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    lines.extend(triangles.map(|[a, b, c]| format!("3 {a} {b} {c}")));
    format!("OFF\n16 32 0\n{}\n", lines.join("\n"))
}

#[test]
fn pieces_of_a_plane_around_a_hole_become_one_facet() {
    for angle in [0.0, 0.7, 2.1] {
        let solid = read(&format!("hole{angle}.off"), &plate_with_hole(angle)).unwrap();
        let mut loops: Vec<Vec<usize>> = solid.facets.iter().map(|f| f.loops.iter().map(<[u32]>::len).collect()).collect();
        loops.sort();
        let walls = vec![vec![4]; 8];
        assert_eq!(loops, [walls, vec![vec![4, 4]; 2]].concat(), "turned by {angle}");
        let volume: f64 = solid
            .facets
            .iter()
            .flat_map(|f| triangulate(&f.loops.iter().collect::<Vec<_>>(), &[], &[], &points_of(&solid)).unwrap())
            .map(|t| t.map(|v| solid.vertices[v as usize].point))
            .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
            .sum();
        // Read at twice the size.
        assert!((volume - 8.0 * 32.0).abs() < 1e-9, "{volume}");
    }
}

fn points_of(solid: &Solid) -> Vec<Vec3> {
    solid.vertices.iter().map(|v| v.point).collect()
}

/// The text of an STL of these facets; the size of the cube is 2 sqrt 3 with the scale of 2.
fn stl(facets: &[[[f64; 3]; 3]]) -> String {
    let vertex = |p: &[f64; 3]| format!("vertex {} {} {}\n", p[0], p[1], p[2]);
    let facet = |f: &[[f64; 3]; 3]| {
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", f.iter().map(vertex).collect::<String>())
    };
    format!("solid a\n{}endsolid a\n", facets.iter().map(facet).collect::<String>())
}

/// The tetrahedron (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), whose edge to (1, 0, 0) is cut at `x` by the lower facet alone.
fn with_flat_facet(x: f64) -> String {
    let [o, a, b, c, m] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [x, 0., 0.]];
    stl(&[[o, b, m], [m, b, a], [o, m, a], [o, a, c], [a, b, c], [o, c, b]])
}

#[test]
fn facets_without_area_become_a_part_of_their_neighbor() {
    let solid = read("q.stl", &with_flat_facet(0.25)).unwrap();
    assert_eq!(solid.vertices.len(), 5);
    let mut corners: Vec<usize> = solid.facets.iter().map(|f| f.loops.outer().len()).collect();
    corners.sort_unstable();
    // Below, the two pieces of the plane became one polygon, which keeps the vertex on its border.
    assert_eq!(corners, [3, 3, 4, 4]);
    // One beyond another: the edge is cut at m and n below, and whole above.
    let [o, a, b, c, m, n] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [0.25, 0., 0.], [0.75, 0., 0.]];
    let rest = [[o, b, m], [m, b, n], [n, b, a], [o, a, c], [a, b, c], [o, c, b]];
    for flat in [[[o, m, n], [o, n, a]], [[o, n, a], [o, m, n]], [[m, n, a], [o, m, a]]] {
        let solid = read("r.stl", &stl(&[&rest[..], &flat[..]].concat())).unwrap();
        assert_eq!((solid.vertices.len(), solid.facets.len()), (6, 4));
    }
    // Two that lie on each other beside an edge that is closed without them: three facets beyond it, nobody knows which.
    let doubled = [[o, b, a], [o, a, c], [a, b, c], [o, c, b], [o, a, m], [m, a, o]];
    assert_eq!(read("s.stl", &stl(&doubled)).unwrap_err().code, "flat-facet");
}

#[test]
fn points_within_the_tolerance_become_one_in_closed_surfaces_too() {
    // Facets of 1e-9 at a corner, within 1e-6 of the size.
    let [a, b, c, m, n] = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [0., 0., 1e-9], [0., 1e-9, 0.]];
    let o = [0.; 3];
    let facets = [[o, n, a], [n, b, a], [o, a, m], [m, a, c], [a, b, c], [o, m, n], [m, c, n], [n, c, b]];
    let solid = read("t.stl", &stl(&facets)).unwrap();
    assert_eq!((solid.vertices.len(), solid.facets.len()), (4, 4));
}

/// Cubes of the file's size 1: smallest corner, size, whether inside out.
fn cubes(all: &[(f64, f64, bool)]) -> String {
    let (mut points, mut facets) = (String::new(), String::new());
    for (k, &(at, size, is_turned)) in all.iter().enumerate() {
        for line in CUBE.lines().skip(2).take(8) {
            let p: Vec<f64> = line.split(' ').map(|x| at + size * x.parse::<f64>().unwrap()).collect();
            points += &format!("{} {} {}\n", p[0], p[1], p[2]);
        }
        for line in CUBE.lines().skip(10) {
            let mut v: Vec<usize> = line.split(' ').skip(1).map(|x| 8 * k + x.parse::<usize>().unwrap()).collect();
            if is_turned {
                v.reverse();
            }
            facets += &format!("4 {} {} {} {}\n", v[0], v[1], v[2], v[3]);
        }
    }
    format!("OFF\n{} {} 0\n{points}{facets}", 8 * all.len(), 6 * all.len())
}

/// The volume in units of the file, which is read at a scale of 2.
fn volume_of(solid: &Solid) -> f64 {
    let origin = solid.vertices[0].point;
    let p = |v: u32| solid.vertices[v as usize].point - origin;
    let six = |f: SolidFacet| -> f64 {
        let walk = f.loops.outer();
        (2..walk.len()).map(|k| p(walk[0]).dot(&p(walk[k - 1]).cross(&p(walk[k])))).sum()
    };
    (solid.facets.iter().map(six).sum::<f64>() / 48.0).round()
}

#[test]
fn shells_are_turned_by_what_they_lie_in() {
    let (outer, inner, core) = ((0., 10., false), (1., 8., false), (2., 6., false));
    let turned = |(at, size, _): (f64, f64, bool)| (at, size, true);
    let volume = |all: &[(f64, f64, bool)]| {
        let solid = read("u.off", &cubes(all)).map_err(|fault| fault.code)?;
        Ok(volume_of(&solid))
    };
    // A cavity, however the whole is turned; beside each other, each by itself.
    assert_eq!(volume(&[outer, turned(inner)]), Ok(488.0));
    assert_eq!(volume(&[turned(outer), inner]), Ok(488.0));
    assert_eq!(volume(&[turned(outer), (20., 2., false)]), Ok(1008.0));
    assert_eq!(volume(&[(0., 2., true), (20., 2., false)]), Ok(16.0));
    assert_eq!(volume(&[core, turned(inner), outer]), Ok(704.0));
    assert_eq!(volume(&[turned(core), inner, turned(outer), (20., 2., true)]), Ok(712.0));
    // Nobody knows what is meant.
    assert_eq!(volume(&[outer, inner]), Err("nested-shells"));
    assert_eq!(volume(&[turned(outer), turned(inner)]), Err("nested-shells"));
    assert_eq!(volume(&[outer, turned(inner), turned(core)]), Err("nested-shells"));
}

#[test]
fn shells_that_touch_in_a_vertex_are_turned_each_by_itself() {
    // Two cubes with a common corner, and a tetrahedron at a corner of a cube and inside of it; 8 points are the first cube's.
    let cube = |at: f64, size: f64, is_turned: bool| cubes(&[(0., 10., false), (at, size, is_turned)]);
    let shared = |text: &str| read("v.off", text).map(|solid| volume_of(&solid)).map_err(|fault| fault.code);
    assert_eq!(shared(&cube(10., 4., false)), Ok(1064.0));
    assert_eq!(shared(&cube(10., 4., true)), Ok(1064.0));
    let mut lines: Vec<String> = cubes(&[(0., 10., false)]).lines().map(str::to_owned).collect();
    lines[1] = "11 10 0".into();
    lines.splice(10..10, ["4 3 5", "5 4 3", "3 5 4"].map(str::to_owned));
    let with = |facets: [&str; 4]| lines.join("\n") + "\n" + &facets.join("\n") + "\n";
    // Its edges at (0, 0, 0) have the determinant 36: it encloses 6, and its facets look outwards in the other order.
    assert_eq!(shared(&with(["3 0 8 9", "3 0 9 10", "3 0 10 8", "3 8 10 9"])), Ok(994.0));
    assert_eq!(shared(&with(["3 9 8 0", "3 10 9 0", "3 8 10 0", "3 9 10 8"])), Err("nested-shells"));
}

#[test]
fn only_facets_on_a_line_become_a_part_of_their_neighbor() {
    // Beside a square, first a zigzag whose halves turn against each other, then the same on the line.
    let with = |y: f64| {
        let points = [[0., 0.], [3., 0.], [2., y], [1., -y], [0., -3.], [3., -3.]];
        let mut surface = Surface {
            points: points.iter().map(|p| Vec3::new(p[0], p[1], 0.)).collect(),
            polygons: Lists::default(),
            group_of: vec![0; 2],
        };
        surface.polygons.push([0, 1, 2, 3]);
        surface.polygons.push([1, 0, 4, 5]);
        flat::absorb(&mut surface);
        surface.polygons.iter().map(<[u32]>::to_vec).collect::<Vec<_>>()
    };
    assert_eq!(with(1.), [[0, 1, 2, 3], [1, 0, 4, 5]]);
    assert_eq!(with(0.), [[1, 2, 3, 0, 4, 5]]);
}

/// The triangles of a box.
fn block(min: [f64; 3], max: [f64; 3]) -> Vec<[[f64; 3]; 3]> {
    let corner = |k: usize| [0, 1, 2].map(|i| if CORNERS[k][i] == 0 { min[i] } else { max[i] });
    let side = |v: [usize; 4]| [[v[0], v[1], v[2]], [v[0], v[2], v[3]]].map(|t| t.map(corner));
    SIDES.into_iter().flat_map(side).collect()
}

const CORNERS: [[u8; 3]; 8] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
const SIDES: [[usize; 4]; 6] = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

#[test]
fn what_is_thinner_than_the_tolerance_stays_where_the_file_is_closed() {
    // The tolerance of STL is 1e-6 of the size.
    let counts = |parts: &[Vec<[[f64; 3]; 3]>]| {
        read("w.stl", &stl(&parts.concat())).map(|solid| (solid.vertices.len(), solid.facets.len())).map_err(|fault| fault.code)
    };
    let cube = block([0.; 3], [1.; 3]);
    assert_eq!(counts(&[block([0.; 3], [1., 1., 1e-7])]), Ok((8, 6)));
    // A foil at a distance, one in the distance of its thickness, a gap alone, and what would vanish.
    assert_eq!(counts(&[cube.clone(), block([0., 0., 2.], [1., 1., 2. + 1e-7])]), Ok((16, 12)));
    assert_eq!(counts(&[cube.clone(), block([0., 0., 1. + 1e-7], [1., 1., 1. + 2e-7])]), Ok((16, 12)));
    assert_eq!(counts(&[cube.clone(), block([0., 0., 1. + 1e-7], [1., 1., 2.])]), Ok((16, 12)));
    assert_eq!(counts(&[cube.clone(), block([2.; 3], [2. + 1e-7; 3])]), Ok((16, 12)));
    // A needle on the edge of a cube shares that edge only.
    assert_eq!(counts(&[cube.clone(), block([1., 1., 0.], [1. + 1e-7, 1. + 1e-7, 1.])]), Ok((14, 12)));
    // A cube whose top was rounded has to be welded, and the foil is lost with it: told so.
    let mut rounded = cube.clone();
    rounded[2..4].iter_mut().flatten().for_each(|p| p[2] += 1e-8);
    assert_eq!(counts(&[rounded.clone()]), Ok((8, 6)));
    let fault = read("x.stl", &stl(&[rounded, block([0., 0., 2.], [1., 1., 2. + 1e-7])].concat())).unwrap_err();
    assert_eq!(fault.code, "self-intersection");
    assert!(fault.hints.iter().any(|h| h.contains("smaller `tolerance`")), "{fault:?}");
}

#[test]
fn a_far_point_that_makes_all_others_one_is_told() {
    let mut facets = block([0.0; 3], [1.0; 3]);
    facets[0][0][2] = 1e8;
    let fault = read("far.stl", &stl(&facets)).unwrap_err();
    assert!(fault.code == "no-volume" && fault.hints.iter().any(|h| h.contains("became one")), "{fault:?}");
}

#[test]
fn shells_with_a_common_edge_are_turned_each_by_itself() {
    // Two cubes of volume 8 over an edge along z, and one of them in the wedge of a third: all ways to turn them.
    let at = |x: f64, y: f64| block([x, y, 0.], [x + 2., y + 2., 2.]);
    let volume = |parts: &[Vec<[[f64; 3]; 3]>], turned: usize| {
        let mut facets: Vec<[[f64; 3]; 3]> = Vec::new();
        for (k, part) in parts.iter().enumerate() {
            let is_turned = turned >> k & 1 == 1;
            facets.extend(part.iter().map(|&[a, b, c]| if is_turned { [a, c, b] } else { [a, b, c] }));
        }
        read("y.stl", &stl(&facets)).map(|solid| volume_of(&solid)).map_err(|fault| fault.code)
    };
    for turned in 0..4 {
        assert_eq!(volume(&[at(0., 0.), at(2., 2.)], turned), Ok(16.));
        assert_eq!(volume(&[at(2., 0.), at(0., 2.)], turned), Ok(16.));
    }
    // In an outer prism, a triangle over its edge at the origin: its cavity, or nobody knows.
    let prism = |corners: [[f64; 2]; 3]| {
        let p = |k: usize, z: f64| [corners[k][0], corners[k][1], z];
        let mut facets = vec![[p(2, 0.), p(1, 0.), p(0, 0.)], [p(0, 2.), p(1, 2.), p(2, 2.)]];
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            facets.extend([[p(a, 0.), p(b, 0.), p(b, 2.)], [p(a, 0.), p(b, 2.), p(a, 2.)]]);
        }
        facets
    };
    let (low, high) = ([[0., 0.], [3., 1.], [3., 2.]], [[0., 0.], [-2., 1.], [-2., -1.]]);
    for turned in 0..8 {
        // Areas 1.5 and 2.
        assert_eq!(volume(&[at(0., -2.), prism(low), prism(high)], turned), Ok(15.), "{turned}");
    }
}
