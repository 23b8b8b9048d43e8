use super::*;
use crate::brep::model::Brep;
use crate::diag::Span;
use crate::geom::{Affine, Vec3};
use crate::ids::{Id, IdVec};
use crate::primitive::solid::{Freedom, Shape, SolidSurface, SolidVertex};
use crate::scene::model::*;

fn block(lo: [f64; 3], hi: [f64; 3]) -> Solid {
    let vertices = (0..8)
        .map(|k| {
            let pick = |a: usize| if k >> a & 1 == 1 { hi[a] } else { lo[a] };
            SolidVertex { point: Vec3::new(pick(0), pick(1), pick(2)), freedom: Freedom::Fixed }
        })
        .collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let sides = ["z-", "z+", "y-", "y+", "x-", "x+"];
    Solid {
        vertices,
        facets: quads.iter().enumerate().map(|(k, q)| ([q.to_vec()], k as u32)).collect(),
        surfaces: sides.iter().map(|s| SolidSurface { side: (*s).to_string(), shape: Shape::Plane }).collect(),
    }
}

fn scene(parts: Vec<(&str, Node)>, leaves: usize) -> Scene {
    let leaf = Leaf {
        primitive: Primitive::Block { lo: Vec3::zeros(), hi: Vec3::repeat(1.0) },
        transform: Affine::identity(),
        division: Division { segments: None, max_angle: None, max_chord_error: None },
        tolerance: None,
        is_triangulated: false,
        name: None,
        span: Span::default(),
    };
    let part = |(name, solid): (&str, Node)| Part {
        name: name.to_string(),
        copy_of: None,
        material: None,
        solid,
        max_edge: None,
        max_volume: None,
        span: Span::default(),
    };
    Scene {
        name: "test".into(),
        unit: "mm".into(),
        hash: String::new(),
        tolerance: 1e-9,
        overlap: Policy::Allow,
        gaps: Policy::Allow,
        remesh: Default::default(),
        mesh: Default::default(),
        leaves: (0..leaves).map(|_| leaf.clone()).collect(),
        parts: parts.into_iter().map(part).collect(),
        boundaries: IdVec::new(),
        interfaces: Default::default(),
    }
}

fn leaf(k: u32) -> Node {
    Node::Leaf(LeafId(k))
}

fn run(parts: Vec<(&str, Node)>, solids: &[Solid]) -> Complex {
    let scene = scene(parts, solids.len());
    let complex = evaluate(&scene, solids, &mut Timings::default()).unwrap_or_else(|e| panic!("{e:?}")).complex;
    // V - E + F - L = 2 (R + S - H), and every other invariant of the kernel.
    let brep = Brep::from_complex(complex.clone()).unwrap_or_else(|e| panic!("{e:?}"));
    assert!(brep.check().is_empty(), "{:?}", brep.check());
    complex
}

fn volumes(complex: &Complex) -> Vec<f64> {
    let mut out = vec![0.0; complex.regions.len()];
    for facet in &complex.facets {
        for t in &facet.triangles {
            let [a, b, c] = t.map(|v| complex.vertices[v].point);
            let six = a.dot(&b.cross(&c));
            // Sixfold volumes are integers here, so their sum is exact.
            out[facet.sides[0].index()] -= six;
            out[facet.sides[1].index()] += six;
        }
    }
    out.into_iter().map(|v| v / 6.0).collect()
}

#[test]
fn prism_with_two_holes_has_fourteen_facets() {
    let solids = [
        block([0., 0., 0.], [250., 150., 50.]),
        block([50., 50., -10.], [100., 100., 60.]),
        block([150., 50., -10.], [200., 100., 60.]),
    ];
    let body = Node::Boolean(Operation::Difference, vec![leaf(0), leaf(1), leaf(2)]);
    let complex = run(vec![("body", body)], &solids);
    assert_eq!(complex.facets.len(), 14);
    assert_eq!(complex.vertices.len(), 24);
    assert_eq!(volumes(&complex)[1], 1_625_000.0);
    assert_eq!(complex.facets.iter().filter(|f| f.loops.len() == 3).count(), 2);
    assert_eq!(complex.markers.len(), 1);
    assert_eq!(complex.markers.as_slice()[0].name, "body|outer");
}

#[test]
fn later_part_takes_the_space_and_contact_is_one_surface() {
    // A box in air, standing on another one: air 10^3, lower 4x4x4, upper 2x2x1 on top.
    let solids = [block([-3., -3., -3.], [7., 7., 7.]), block([0., 0., 0.], [4., 4., 4.]), block([1., 1., 4.], [3., 3., 5.])];
    let complex = run(vec![("air", leaf(0)), ("lower", leaf(1)), ("upper", leaf(2))], &solids);
    let names: Vec<&str> = complex.markers.iter().map(|m| &m.name[..]).collect();
    assert_eq!(names, ["air|lower", "air|upper", "air|outer", "lower|upper"]);
    assert_eq!(complex.facets.len(), 6 + 6 + 5 + 1);
    let v = volumes(&complex);
    assert_eq!(v, vec![-1000.0, 1000.0 - 64.0 - 4.0, 64.0, 4.0]);
}

#[test]
fn a_cavity_is_a_void_and_what_floats_in_it_is_found() {
    let solids = [block([0., 0., 0.], [9., 9., 9.]), block([1., 1., 1.], [8., 8., 8.]), block([3., 3., 3.], [5., 5., 5.])];
    let shell = Node::Boolean(Operation::Difference, vec![leaf(0), leaf(1)]);
    let complex = run(vec![("shell", shell), ("core", leaf(2))], &solids);
    let v = volumes(&complex);
    assert_eq!(complex.regions.len(), 4);
    assert_eq!(v, vec![-729.0, 729.0 - 343.0, 8.0, 343.0 - 8.0]);
    assert_eq!(complex.regions.as_slice()[3].part, None);
}

#[test]
fn two_pieces_of_one_part_are_two_regions() {
    let solids = [block([0., 0., 0.], [9., 3., 3.]), block([3., -1., -1.], [6., 4., 4.])];
    let complex = run(vec![("split", Node::Boolean(Operation::Difference, vec![leaf(0), leaf(1)]))], &solids);
    assert_eq!(volumes(&complex), vec![-54.0, 27.0, 27.0]);
    assert_eq!(complex.facets.len(), 12);
}

#[test]
fn coplanar_faces_in_every_operation() {
    let solids = [block([0., 0., 0.], [4., 4., 4.]), block([2., 0., 0.], [6., 4., 4.])];
    for (operation, volume) in
        [(Operation::Union, 96.0), (Operation::Intersection, 32.0), (Operation::Difference, 32.0), (Operation::Xor, 64.0)]
    {
        let complex = run(vec![("p", Node::Boolean(operation, vec![leaf(0), leaf(1)]))], &solids);
        assert_eq!(-volumes(&complex)[0], volume, "{operation:?}");
    }
}

/// Squares that turn over each other are not cut where they cross inside the star: that must not join inside and outside.
#[test]
fn pairs_of_equal_turned_squares_make_a_star_without_starting_again() {
    const DISTINCT: usize = 17;
    let turned = |k: usize| {
        let angle = 180.0 * k as f64 / DISTINCT as f64;
        format!("Rotate(axis: Z, angle: {angle:?}, solid: Block(size: (2, 2, 1), center: (0, 0, 0)))")
    };
    let squares: Vec<String> = (0..2 * DISTINCT).map(turned).collect();
    let text =
        format!("Scene(units: \"mm\", remesh: Off, parts: [Part(name: \"it\", solid: Union([{}]))])", squares.join(", "));
    let limits = crate::scene::Limits::default();
    let (scene, _) = crate::scene::parse("pile", std::path::Path::new("."), &text, &[], &limits).unwrap();
    let solids = crate::primitive::build(&scene).unwrap();
    let extent = size::of(&scene, &solids);
    let culled = cull::cull(&scene, &solids, scene.tolerance * extent.size).unwrap();
    let complex = evaluate_pieces(&scene, &solids, Some(&culled), extent, &mut Timings::default()).unwrap().complex;
    // The outline is a side of a square from every corner halfway to the next.
    let half = std::f64::consts::FRAC_PI_4 / DISTINCT as f64;
    let area = 4.0 * DISTINCT as f64 * (1.0 - libm::tan(std::f64::consts::FRAC_PI_4 - half));
    let volume = crate::plc::measure::measure(&complex).volumes[crate::ids::RegionId(1)];
    assert!((volume - area).abs() < 1e-9, "{volume} {area}");
    assert_eq!(complex.regions.len(), 2);
}

/// What is said if overlaps are forbidden.
fn forbidden(solids: &[Solid]) -> Vec<String> {
    let names = ["a", "b", "c"];
    let parts = (0..solids.len()).map(|k| (names[k], leaf(k as u32))).collect();
    let scene = Scene { overlap: Policy::Forbid, ..scene(parts, solids.len()) };
    match evaluate(&scene, solids, &mut Timings::default()) {
        Ok(_) => Vec::new(),
        Err(errors) => errors.into_iter().map(|e| e.message).collect(),
    }
}

#[test]
fn parts_that_touch_do_not_overlap() {
    let solids = [block([0., 0., 0.], [1., 1., 1.]), block([1., 0., 0.], [2., 1., 1.]), block([0., 0., 1.], [2., 0.5, 2.])];
    assert_eq!(forbidden(&solids), Vec::<String>::new());
}

#[test]
fn overlaps_of_three_parts_are_those_of_the_pairs() {
    let solids = [block([0., 0., 0.], [2., 2., 2.]), block([1., 1., 1.], [3., 3., 3.]), block([1.5, 0., 0.], [4., 2., 2.])];
    let told = forbidden(&solids);
    for (pair, volume) in [("`a` and `b`", 1.0), ("`a` and `c`", 2.0), ("`b` and `c`", 1.5)] {
        assert!(told.iter().any(|m| m.contains(pair) && m.ends_with(&format!("overlap in {volume} mm^3"))), "{pair}: {told:?}");
    }
}
