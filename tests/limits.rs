//! What breaks Boolean engines, by name, with numbers that can be computed by hand; as written and turned about odd axes.

mod evaluated;

use evaluated::{Built, build, build_in};
use gsm::geom::Vec3;
use gsm::geom::predicates::orient3d;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

/// Turns about axes that make no coordinate round.
const TURNS: [&str; 4] = [
    "axis: Z, angle: 0",
    "axis: (0.31, -0.74, 0.59), angle: 37.3",
    "axis: (-1, 0.2, 0.05), angle: 161.9",
    "axis: (0.577, 0.578, 0.576), angle: 119.7",
];

/// Builds parts (name, solid) under every turn.
fn all(parts: &[(&str, String)], check: impl Fn(&Built, &str)) {
    for turn in TURNS {
        let turned: Vec<(String, String)> =
            parts.iter().map(|(name, solid)| (name.to_string(), format!("Rotate({turn}, solid: {solid})"))).collect();
        check(&build(&turned).unwrap_or_else(|e| panic!("{turn}: {e}")), turn);
    }
}

fn assert_near(found: f64, right: f64, what: &str) {
    assert!((found - right).abs() <= 1e-8 * right.abs(), "{what}: {found} is not {right}");
}

/// Area of a regular polygon.
fn polygon(sides: u32, radius: f64) -> f64 {
    0.5 * f64::from(sides) * radius * radius * (2.0 * PI / f64::from(sides)).sin()
}

#[test]
fn the_138_crossings_of_generator_lines_are_found_as_122_points() {
    // Lines a of one cylinder and b of the next cross where sin a = cos b: 46 times per pair, 138 times in all. In 8 places
    // three lines meet, which are counted three times. With the 144 corners of the caps these are the vertices, since an
    // exclusive union keeps every surface.
    let tube = |axis: &str, base: &str| {
        format!("Cylinder(radius: 50, height: 300, base: {base}, axis: {axis}, discretization: (segments: 24))")
    };
    let solid = format!("Xor([{}, {}, {}])", tube("X", "(-150, 0, 0)"), tube("Y", "(0, -150, 0)"), tube("Z", "(0, 0, -150)"));
    all(&[("cross", solid)], |built, turn| assert_eq!(built.counts()[0], 144 + 138 - 16, "{turn}"));
}

#[test]
fn corners_of_a_turned_contact_lie_on_mixed_sides_and_share_one_facet() {
    let parts = [
        ("plate", "Block(min: (-3, -3, -1), max: (3, 3, 0))".to_string()),
        ("foot", "Block(min: (-1, -1, 0), max: (1, 1, 2))".into()),
    ];
    all(&parts, |built, turn| {
        assert_eq!((built.volumes[0], built.volumes[1]).0.round(), 36.0, "{turn}");
        assert_near(built.area("plate|foot"), 4.0, turn);
        let complex = &built.evaluation.as_ref().unwrap().complex;
        assert_eq!(complex.facets.iter().filter(|f| complex.markers[f.marker].name == "plate|foot").count(), 1, "{turn}");
    });
    // That they do lie on mixed sides: of the plane through three corners of the plate, turned as gsm turns them.
    let turn = nalgebra::Rotation3::new(Vec3::new(0.3, -1.1, 0.7));
    let [a, b, c] = [[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0]].map(|p| turn * Vec3::new(p[0], p[1], 0.0));
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|p| turn * Vec3::new(p[0], p[1], 0.0));
    let signs = corners.map(|p| orient3d(&a, &b, &c, &p));
    assert!(signs.iter().any(|s| *s != signs[0]), "{signs:?}");
}

/// Half-space blocks whose walls all hold the z axis, cut to a prism of 12 sides and volume 54 with no corner on any wall.
fn half(k: u32) -> String {
    let block = format!("Rotate(axis: Z, angle: {}, solid: Block(min: (0, -9, -2), max: (9, 9, 2)))", 30 * k);
    format!("Intersection([{block}, Prism(sides: 12, radius: 3, height: 2, base: (0, 0, -1), start: 15)])")
}

#[test]
fn half_spaces_about_an_axis_leave_slices() {
    // Each takes its half; the next one, 30 degrees further, leaves it a twelfth. The last keeps the half.
    let names: Vec<String> = (5..12).map(|k| format!("half{k}")).collect();
    let parts: Vec<(&str, String)> = names.iter().map(|n| &n[..]).zip((5..12).map(half)).collect();
    all(&parts, |built, turn| {
        for (k, volume) in built.volumes.iter().enumerate() {
            assert_near(*volume, if k == 6 { 27.0 } else { 4.5 }, turn);
        }
        // Corners of the prism, ends of 7 walls, ends of the axis; 14 pieces of caps, 7 walls, 12 sides of which 7 are cut.
        assert_eq!(built.counts(), [24 + 14 + 2, 14 + 7 + 19, 8], "{turn}");
    });
}

#[test]
fn eleven_half_spaces_about_an_axis_cancel_without_a_trace() {
    // All twelve would cover every place six times. Without the first, its own half is left.
    let blocks: Vec<String> = (1..12).map(half).collect();
    all(&[("half", format!("Xor([{}])", blocks.join(", ")))], |built, turn| {
        assert_near(built.volumes[0], 27.0, turn);
        assert_eq!(built.counts(), [16, 10, 2], "{turn}");
    });
}

#[test]
fn twelve_wedges_meet_on_an_axis() {
    // Each is a half without the next one: 30 degrees, a twelfth of 54.
    let wedge = |k: u32| format!("Difference([{}, {}])", half(k), half(k + 1));
    let names: Vec<String> = (0..12).map(|k| format!("wedge{k}")).collect();
    let parts: Vec<(&str, String)> = names.iter().map(|n| &n[..]).zip((0..12).map(wedge)).collect();
    all(&parts, |built, turn| {
        built.volumes.iter().for_each(|v| assert_near(*v, 4.5, turn));
        // Corners of the prism, ends of the walls and of the axis; each wedge has two caps and two pieces of sides.
        assert_eq!(built.counts(), [24 + 24 + 2, 24 + 12 + 24, 13], "{turn}");
    });
}

#[test]
fn six_slices_of_a_pie_meet_on_its_axis() {
    let slice = |k: u32| {
        format!(
            "Rotate(axis: Z, angle: {}, solid: Prism(polygon: [(0, 0), (2, 0), (1, {:?})], height: 3))",
            60 * k,
            3f64.sqrt()
        )
    };
    let names: Vec<String> = (0..6).map(|k| format!("slice{k}")).collect();
    let parts: Vec<(&str, String)> = names.iter().map(|n| &n[..]).zip((0..6).map(slice)).collect();
    all(&parts, |built, turn| {
        built.volumes.iter().for_each(|v| assert_near(*v, 3.0 * 3f64.sqrt(), turn));
        assert_eq!(built.counts(), [14, 12 + 6 + 6, 7], "{turn}");
    });
}

#[test]
fn a_tilted_foot_touches_where_it_is_near() {
    // Tilted about the edge on which it stands, in degrees: flat within the tolerance, partly within it, on an edge only.
    for angle in [1e-9, 1e-8, 5e-8, 1.1e-7, 2e-7, 1e-6, 1e-5, 1e-3, 1.0] {
        let foot = format!("Rotate(axis: X, angle: {angle:?}, solid: Block(min: (0.5, 0, 0), max: (1.5, 1, 1)))");
        let parts = [("plate", "Block(min: (0, -1, -1), max: (2, 2, 0))".to_string()), ("foot", foot)];
        all(&parts, |built, turn| {
            assert_near(built.volumes[0], 6.0, turn);
            assert_near(built.volumes[1], 1.0, turn);
            let area = built.area("plate|foot");
            assert!(area == 0.0 || (area - 1.0).abs() < 1e-7, "{angle} {turn}: {area}");
        });
    }
}

#[test]
fn a_chain_of_contacts_is_told_and_resolved_apart() {
    // Three plates, each standing in the one below by less than the tolerance; the first and the last are further apart.
    let plate = |k: f64, w: f64| format!("Block(min: (-{w:?}, -{w:?}, {:?}), max: ({w:?}, {w:?}, {:?}))", 3.9e-9 * k, 1.0 + k);
    let parts = [("first", plate(0.0, 1.0)), ("second", plate(1.0, 1.0)), ("third", plate(2.0, 1.0))];
    all(&parts, |built, turn| {
        // Each is inside the next but for its foot.
        assert_near(built.volumes[2], 12.0, turn);
        assert!(built.volumes[..2].iter().all(|&v| v > 0.0 && v < 2e-8), "{turn}");
        let warnings = &built.evaluation.as_ref().unwrap().warnings;
        let chains: Vec<_> = warnings.iter().filter(|w| w.code == "contact-chain").collect();
        assert!(
            !chains.is_empty() && chains.iter().all(|w| w.span.is_some_and(|s| s.line > 1 && s.column > 1)),
            "{warnings:?}"
        );
    });
}

#[test]
fn round_things_stand_on_each_other() {
    let cylinder = |z: i32| format!("Cylinder(radius: 2, height: 3, base: (0, 0, {z}), discretization: (segments: 24))");
    let cap = polygon(24, 2.0);
    for (top, volume) in [
        (cylinder(3), 3.0 * cap),
        ("Cone(radius: 2, height: 3, base: (0, 0, 3), discretization: (segments: 24))".to_string(), cap),
    ] {
        all(&[("below", cylinder(0)), ("above", top)], |built, turn| {
            assert_near(built.volumes[0], 3.0 * cap, turn);
            assert_near(built.volumes[1], volume, turn);
            assert_near(built.area("below|above"), cap, turn);
        });
    }
    // Caps of other divisions: a pentagon inside, and a square whose corners are on the rim of an octagon.
    for (sides, radius) in [(5, 1.0), (4, 2.0)] {
        let below = "Prism(sides: 8, radius: 2, height: 3)".to_string();
        let above = format!("Prism(sides: {sides}, radius: {radius:?}, height: 1, base: (0, 0, 3))");
        all(&[("below", below), ("above", above)], |built, turn| {
            assert_near(built.volumes[0], 3.0 * polygon(8, 2.0), turn);
            assert_near(built.area("below|above"), polygon(sides, radius), turn);
        });
    }
    // Two hexagons, half a side turned, share a regular polygon of 12 sides with the same inner radius.
    let prism = |z: i32, start: i32| format!("Prism(sides: 6, radius: 2, height: 1, base: (0, 0, {z}), start: {start})");
    let inner = 2.0 * (PI / 6.0).cos();
    all(&[("below", prism(0, 0)), ("above", prism(1, 30))], |built, turn| {
        assert_near(built.area("below|above"), 12.0 * inner * inner * (PI / 12.0).tan(), turn);
    });
}

#[test]
fn a_sphere_in_a_sphere_leaves_seven_eighths() {
    let ball = |r: f64| format!("Sphere(radius: {r:?}, discretization: (segments: 16))");
    let parts = [("shell", ball(2.0)), ("core", ball(1.0))];
    all(&parts, |built, turn| {
        assert_near(built.volumes[0], 7.0 * built.volumes[1], turn);
        assert_eq!(built.counts()[2], 3, "{turn}");
    });
}

#[test]
fn shells_of_a_millionth_of_the_size_are_kept() {
    let thin = 1e-6;
    let ball = |r: f64| format!("Sphere(radius: {r:?}, discretization: (segments: 16))");
    all(&[("shell", ball(1.0 + thin)), ("core", ball(1.0))], |built, turn| {
        let growth = (1.0 + thin).powi(3) - 1.0;
        assert!((built.volumes[0] / built.volumes[1] - growth).abs() < 1e-9, "{turn}: {:?}", built.volumes);
    });
    let block = |r: f64| format!("Block(size: ({0:?}, {0:?}, {0:?}), center: (0, 0, 0))", 2.0 * r);
    all(&[("shell", format!("Difference([{}, {}])", block(1.0), block(1.0 - thin)))], |built, turn| {
        let right = 8.0 * (1.0 - (1.0 - thin).powi(3));
        assert!((built.volumes[0] - right).abs() < 1e-9, "{turn}: {:?}, {right}", built.volumes);
    });
}

#[test]
fn a_tool_much_larger_than_the_model_changes_no_tolerance() {
    // A foil of 1e-7, cut at a quarter by a block of the largest size that a scene may have.
    let foil = "Block(min: (0, 0, 0), max: (1, 1, 1e-7))";
    let tool = "Block(min: (-1e9, -1e9, -1e9), max: (0.25, 1e9, 1e9))";
    for (operation, right) in [("Difference", 0.75e-7), ("Intersection", 0.25e-7)] {
        let built = build(&[("it", &format!("{operation}([{foil}, {tool}])")[..])]).unwrap();
        assert_near(built.volumes[0], right, operation);
    }
}

#[test]
fn half_spaces_as_large_as_single_numbers_allow_cut_at_their_planes() {
    // Files have them instead of half-spaces, such as the peers' Cray.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let corners = |a: f64, b: f64, z: f64| format!("{a:?} {b:?} {z:?}\n");
    let m = f64::from(f32::MAX);
    let rims = [-m, -0.375].map(|z| [[-m, -m], [m, -m], [m, m], [-m, m]].map(|[a, b]| corners(a, b, z)).concat());
    let facets = "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
    fs::write(folder.join("half_space.off"), format!("OFF\n8 6 0\n{}{facets}", rims.concat())).unwrap();
    let below = "Import(file: \"half_space.off\")";
    let block = "Block(size: (2, 2, 2), center: (0, 0, 0))";
    // The tilted edges of a pyramid cross the plane where nothing is round: at 5/16 of its height.
    let pyramid = "Pyramid(sides: 4, radius: 2, height: 2, base: (0, 0, -1))";
    let left = (11.0f64 / 16.0).powi(3);
    for (solid, whole, above) in [(block, 8.0, 11.0 / 16.0), (pyramid, 16.0 / 3.0, left)] {
        for (operation, share) in [("Difference", above), ("Intersection", 1.0 - above)] {
            let text = format!("{operation}([{solid}, {below}])");
            let built = build_in(folder, &[("it", &text[..])]).unwrap_or_else(|e| panic!("{e}"));
            assert_near(built.volumes[0], share * whole, &text);
        }
    }
}
