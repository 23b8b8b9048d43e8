//! The language as a whole, on small scenes whose results are known.

use super::model::*;
use super::*;
use crate::diag::Severity;
use crate::geom::Vec3;
use crate::ids::{LeafId, PartId};
use proptest::prelude::*;

fn read(text: &str) -> Outcome<Scene> {
    parse("test", Path::new(""), text, &[], &Limits::default()).map(|(scene, _)| scene)
}

fn scene(text: &str) -> Scene {
    read(text).unwrap_or_else(|faults| panic!("{faults:#?}\n{text}"))
}

fn codes(text: &str) -> Vec<&'static str> {
    read(text).err().unwrap_or_default().iter().map(|fault| fault.code).collect()
}

/// A scene in mm of one part per solid.
fn of_solids(settings: &str, solids: &[&str]) -> String {
    let parts: Vec<String> = solids.iter().enumerate().map(|(k, s)| format!("Part(name: \"p{k}\", solid: {s})")).collect();
    format!("Scene(units: \"mm\", {settings} parts: [{}])", parts.join(",\n"))
}

fn bundled(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    std::fs::read_to_string(path).unwrap()
}

/// The number that an expression gives where a length is expected, in mm.
fn length(params: &str, expression: &str) -> Result<f64, Vec<&'static str>> {
    let sphere = format!("Sphere(radius: 1, center: ({expression}, 0, 0))");
    match read(&of_solids(&format!("params: {{{params}}},"), &[&sphere])) {
        Ok(scene) => match &scene.leaves[LeafId(0)].primitive {
            Primitive::Ellipsoid { center, .. } => Ok(center.x),
            other => panic!("{other:?}"),
        },
        Err(faults) => Err(faults.iter().map(|fault| fault.code).collect()),
    }
}

#[test]
fn numbers_and_expressions() {
    let params = r#""gap": "0.8mm", "n": 12, "wide": "2 * gap + n", "turn": "90 deg""#;
    for (expression, expected) in [
        ("3", 3.0),
        ("-2.5e1", -25.0),
        ("1_000", 1000.0),
        (r#""0.1in""#, 2.54),
        (r#""gap/2 + 3 mm""#, 3.4),
        (r#""wide""#, 13.6),
        (r#""sin(30)""#, 0.5),
        (r#""sin((pi/6) rad) * 4 cm""#, 20.0),
        (r#""cos(turn)""#, 0.0),
        (r#""2^3^2""#, 512.0),
        (r#""-2^2""#, -4.0),
        (r#""(2 + 3) * -4""#, -20.0),
        (r#""10 - 3 - 2""#, 5.0),
        (r#""sqrt(16 mm^2)""#, 4.0),
        (r#""5 mm^3 / 1 cm^2""#, 0.05),
        (r#""max(1cm, 3)""#, 10.0),
        (r#""mod(-1, 12)""#, 11.0),
        (r#""atan2(1, 1) / 1deg""#, 45.0),
    ] {
        assert_eq!(length(params, expression), Ok(expected), "{expression}");
    }
    for (expression, code) in [
        (r#""1 +""#, "expression"),
        (r#""2 3""#, "expression"),
        (r#""sin(1, 2)""#, "expression"),
        (r#""sinus(1)""#, "expression"),
        (r#""""#, "expression"),
        (r#""turn""#, "wrong-unit"),
        (r#""gap * turn""#, "wrong-unit"),
        (r#""gap ^ 2""#, "wrong-unit"),
        (r#""sin(gap)""#, "wrong-unit"),
        (r#""1e999""#, "not-finite"),
        (r#""0/0""#, "not-finite"),
        (r#""nn""#, "unknown-parameter"),
        ("true", "wrong-type"),
    ] {
        assert_eq!(length(params, expression), Err(vec![code]), "{expression}");
    }
}

#[test]
fn parameters_are_set_from_outside() {
    let text = of_solids("params: {\"gap\": 1, \"r\": \"2 * gap\"},", &["Sphere(radius: \"r\")"]);
    let set = |name: &str, value: &str| {
        let overrides = [(name.to_owned(), value.to_owned())];
        parse("t", Path::new(""), &text, &overrides, &Limits::default())
    };
    let (with, _) = set("gap", "0.4 cm").unwrap();
    assert_eq!(with.leaves[LeafId(0)].primitive, Primitive::Ellipsoid { center: Vec3::zeros(), radii: Vec3::repeat(8.0) });
    assert_ne!(with.hash, scene(&text).hash);
    assert_eq!(set("gapp", "1").unwrap_err()[0].code, "unknown-parameter");
    assert_eq!(set("gap", "r").unwrap_err()[0].code, "cyclic-reference");
}

#[test]
fn the_same_solid_in_the_same_place_is_one_leaf() {
    // Written, translated, translated twice, scaled, in another unit, used by name.
    let settings = r#"solids: {"b": Block(min: (1, 2, 3), max: (2, 4, 6))},"#;
    let same = scene(&of_solids(
        settings,
        &[
            "Block(min: (1, 2, 3), max: (2, 4, 6))",
            "Translate(by: (1, 2, 3), solid: Block(size: (1, 2, 3)))",
            "Translate(by: (1, 0, 0), solid: Translate(by: (0, 2, 3), solid: Block(size: (1, 2, 3))))",
            "Scale(by: 0.5, solid: Block(min: (2, 4, 6), max: (4, 8, 12)))",
            r#"Block(size: ("0.1 cm", 2, "0.003 m"), center: (1.5, 3, 4.5))"#,
            r#"Use("b")"#,
        ],
    ));
    assert_eq!(same.leaves.len(), 1);
    let other = scene(&of_solids("", &["Sphere(radius: 1)", "Sphere(radius: 1, discretization: (segments: 8))"]));
    assert_eq!(other.leaves.len(), 2);
}

#[test]
fn a_body_of_revolution_turned_about_its_axis_is_itself() {
    let turned = |solid: &str| {
        let inner = format!("Polar(count: 5, center: (3, 0, 0), solid: {solid})");
        scene(&of_solids("", &[&inner])).leaves.len()
    };
    assert_eq!(turned("Cylinder(radius: 1, height: 2, base: (3, 0, 7))"), 1);
    assert_eq!(turned("Tube(outer_radius: 2, inner_radius: 1, height: 2, base: (3, 0, 7))"), 1);
    assert_eq!(turned("Cylinder(radius: 1, height: 2, base: (0, 0, 7))"), 5);
    assert_eq!(turned("Prism(sides: 6, radius: 1, height: 2, base: (3, 0, 7))"), 5);
    // A stator minus its slots, and the coils in them: one ring, and a wedge for each slot.
    let machine = scene(&bundled("machine.ron"));
    assert_eq!((machine.parts.len(), machine.leaves.len()), (21, 6 + 1 + 12 + 4));
    let slots = scene(&of_solids(
        r#"solids: {"slot": Block(min: (5, -1, 0), max: (9, 1, 4))},"#,
        &[
            r#"Difference([Cylinder(radius: 8, height: 4), Polar(count: 12, solid: Use("slot"))])"#,
            r#"Polar(count: 12, solid: Use("slot"))"#,
        ],
    ));
    assert_eq!(slots.leaves.len(), 13);
}

#[test]
fn motions_act_from_the_inside_out_and_exactly() {
    let at = |solid: &str| match scene(&of_solids("", &[solid])).leaves[LeafId(0)].clone() {
        Leaf { primitive: Primitive::Cone { frame, .. }, transform, .. } => {
            assert_eq!(transform, crate::geom::Affine::identity());
            frame
        }
        other => panic!("{other:?}"),
    };
    let cone = "Cone(radius: 1, height: 2, base: (1, 0, 0))";
    let moved = at(&format!("Translate(by: (0, 0, 5), solid: Rotate(axis: Z, angle: 90, solid: {cone}))"));
    assert_eq!((moved.origin, moved.x, moved.z), (Vec3::new(0.0, 1.0, 5.0), Vec3::y(), Vec3::z()));
    let mirrored = at(&format!("Mirror(normal: Z, center: (0, 0, 1), solid: {cone})"));
    assert_eq!((mirrored.origin, mirrored.z), (Vec3::new(1.0, 0.0, 2.0), -Vec3::z()));
    assert_eq!(mirrored.x.cross(&mirrored.y), mirrored.z);
    let turned = at(&format!("Rotate(axis: Y, angle: 90, center: (1, 0, 0), solid: {cone})"));
    assert_eq!((turned.origin, turned.z), (Vec3::new(1.0, 0.0, 0.0), Vec3::x()));
    // What numbers cannot carry is left to the matrix.
    let block = scene(&of_solids("", &["Rotate(axis: Z, angle: 90, solid: Block(size: (1, 2, 3)))"]));
    let image = block.leaves[LeafId(0)].transform * nalgebra::Point3::new(1.0, 2.0, 3.0);
    assert_eq!(image, nalgebra::Point3::new(-2.0, 1.0, 3.0));
}

#[test]
fn settings_of_the_inside_win() {
    let text = r#"Scene(units: "mm", discretization: (segments: 8), triangulated: true, max_deviation: "0.1 cm", remesh: Full,
        patches: BSpline, mesh: (ratio: 1.4, min_dihedral: 3, max_ratio: "2*2"), parts: [
        Part(name: "a", solid: Sphere(radius: 1)),
        Part(name: "b", solid: Sphere(radius: 2), discretization: (max_angle: 30), triangulated: false, max_volume: "1 mm^3"),
        Part(name: "c", solid: Sphere(radius: 3, discretization: (segments: 40)), discretization: (segments: 9)),
    ])"#;
    let scene = scene(text);
    let divisions: Vec<_> =
        scene.leaves.iter().map(|l| (l.division.segments, l.division.max_angle, l.is_triangulated)).collect();
    let thirty = Some(std::f64::consts::PI / 6.0);
    assert_eq!(divisions, [(Some(8), None, true), (None, thirty, false), (Some(40), None, true)]);
    assert_eq!(scene.parts[PartId(1)].max_volume, Some(1.0));
    assert_eq!(scene.remesh, RemeshOptions { mode: RemeshMode::Full, patches: PatchMode::BSpline, max_deviation: Some(1.0) });
    let thresholds = Thresholds { min_dihedral: Some(3.0), max_ratio: Some(4.0), ..Thresholds::default() };
    assert_eq!(scene.mesh, MeshOptions { ratio: 1.4, dihedral: None, thresholds });
}

#[test]
fn boundaries_select_sides_of_leaves() {
    let tour = scene(&bundled("tour.ron"));
    let side = |name: &str| tour.boundaries.iter().find(|b| b.name == name).map(|b| b.selection.clone()).unwrap();
    assert_eq!(side("ceiling"), BoundarySelection::Sides(vec![(LeafId(0), Some("z+".into()))]));
    assert_eq!(side("face6"), BoundarySelection::Sides(vec![(LeafId(6), Some("x+".into()))]));
    let faults = read(&bundled("tour.ron").replace("side: \"yoke\"", "side: \"joke\"")).unwrap_err();
    assert_eq!(faults[0].code, "unknown-side");
    assert!(faults[0].hints[0].contains("yoke"), "{:?}", faults[0].hints);
    assert!(faults[0].hints[1].contains("hole1_side1"), "{:?}", faults[0].hints);
}

#[test]
fn hostile_scenes_end_with_an_error() {
    let deep = |n: usize| of_solids("", &[&format!("{}Sphere(radius: 1){}", "Union([".repeat(n), "])".repeat(n))]);
    assert_eq!(codes(&deep(100)), Vec::<&str>::new());
    assert_eq!(codes(&deep(100_000)), ["too-deep"]);
    // As deep as solids go, and one more; work grows with the square of the depth at most, on a few kilobytes.
    assert_eq!(codes(&deep(999)), Vec::<&str>::new());
    let faults = read(&deep(1000)).unwrap_err();
    assert!(faults[0].code == "too-deep" && faults[0].message.contains("1000"), "{faults:?}");
    let brackets = of_solids("", &[&"(".repeat(100_000)]);
    assert_eq!(codes(&brackets), ["too-deep"]);
    let sphere = format!("Sphere(radius: \"{}1\")", "(".repeat(100_000));
    assert_eq!(codes(&of_solids("", &[&sphere])), ["expression"]);
    // Names that multiply: 10^9 spheres in 30 lines.
    let lines: Vec<String> =
        (1..=9).map(|k| format!("\"s{k}\": Linear(count: 10, step: ({k}, 1, 0), solid: Use(\"s{}\"))", k - 1)).collect();
    let solids = format!("solids: {{\"s0\": Sphere(radius: 1), {}}},", lines.join(", "));
    assert_eq!(codes(&of_solids(&solids, &["Use(\"s9\")"])), ["scene-too-large"]);
    let chain: Vec<String> = (1..2000).map(|k| format!("\"s{k}\": Union([Use(\"s{}\")])", k - 1)).collect();
    let solids = format!("solids: {{\"s0\": Sphere(radius: 1), {}}},", chain.join(", "));
    let faults = codes(&of_solids(&solids, &["Use(\"s1999\")"]));
    assert!(!faults.is_empty() && faults.iter().all(|code| *code == "too-deep"), "{faults:?}");
    let chain: Vec<String> = (1..5000).map(|k| format!("\"p{k:04}\": \"p{:04}\"", 5000 - k)).collect();
    assert!(!codes(&of_solids(&format!("params: {{{}}},", chain.join(",")), &["Sphere(radius: 1)"])).is_empty());
    for bad in ["", "Scene", "Scene(", "{}", "[1, 2]", "\u{feff}", "Scene(units: 5)", "Scene(units: \"mm\", parts: 3)"] {
        assert!(read(bad).is_err(), "{bad}");
    }
}

#[test]
fn faults_from_the_command_line_say_so() {
    let text = of_solids("params: {\"gap\": 1, \"w\": \"gap * 2\"},", &["Sphere(radius: \"w\")"]);
    for (name, value, code, said) in [
        ("gap", "0/0", "not-finite", "--set gap=0/0: `gap`"),
        ("gap", "1 foo", "wrong-unit", "--set gap=1 foo: "),
        ("gap", "(", "expression", "--set gap=(: "),
        ("gapp", "1", "unknown-parameter", "--set gapp=1: "),
    ] {
        let set = [(name.to_owned(), value.to_owned())];
        let faults = parse("test", Path::new(""), &text, &set, &Limits::default()).unwrap_err();
        assert!(faults[0].code == code && faults[0].message.starts_with(said) && faults.len() == 1, "{faults:?}");
        assert!(!faults[0].hints.is_empty());
    }
}

#[test]
fn a_parameter_that_is_called_like_a_unit_is_a_warning() {
    let text = of_solids("params: {\"mm\": 5},", &["Sphere(radius: \"mm\")"]);
    let (_, warnings) = parse("test", Path::new(""), &text, &[], &Limits::default()).unwrap();
    assert_eq!(warnings.iter().map(|w| w.code).collect::<Vec<_>>(), ["parameter-like-unit"]);
}

#[test]
fn sides_of_a_block_have_all_their_names() {
    let boundary = "Part(name: \"a\", solid: Block(size: (1, 1, 1)), boundaries: [Side(name: \"t\", side: \"upper\")])";
    let faults = read(&format!("Scene(units: \"mm\", parts: [{boundary}])")).unwrap_err();
    assert_eq!(faults[0].code, "unknown-side");
    assert!(faults[0].hints.iter().any(|h| h.contains("bottom, top, x+")), "{:?}", faults[0].hints);
}

#[test]
fn a_side_is_found_by_the_name_that_each_solid_has_for_it() {
    let solid = "Union([Block(size: (1, 1, 1)), Cylinder(radius: 1, height: 2, base: (5, 0, 0)), Sphere(radius: 1, center: (9, 0, 0))])";
    let boundary = "Side(name: \"t\", side: \"top\"), Side(name: \"z\", side: \"z+\"), Side(name: \"all\")";
    let scene = scene(&format!("Scene(units: \"mm\", parts: [Part(name: \"a\", solid: {solid}, boundaries: [{boundary}])])"));
    let sides = |k: u32| match &scene.boundaries[BoundaryId(k)].selection {
        BoundarySelection::Sides(sides) => sides.iter().map(|(leaf, side)| (leaf.0, side.as_deref())).collect::<Vec<_>>(),
        BoundarySelection::Outer => panic!(),
    };
    assert_eq!(sides(0), [(0, Some("z+")), (1, Some("top"))]);
    assert_eq!(sides(1), [(0, Some("z+"))]);
    assert_eq!(sides(2), [(0, None), (1, None), (2, None)]);
}

#[test]
fn very_many_wrong_names_are_told_in_time() {
    // All pairs of names would be 36 million comparisons.
    let n = 6000;
    let list = |entry: &dyn Fn(usize) -> String| (0..n).map(entry).collect::<Vec<_>>().join(",");
    let params = list(&|k| format!("\"param{k}\": 1"));
    let parts = list(&|k| format!("Part(name: \"p{k}\", solid: Sphere(radius: \"parm{k}\"))"));
    let start = std::time::Instant::now();
    let faults = codes(&format!("Scene(units: \"mm\", params: {{{params}}}, parts: [{parts}])"));
    assert!(faults.len() == 200 && faults.iter().all(|code| *code == "unknown-parameter"));
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

#[test]
fn holes_lie_in_the_outer_loop_and_in_no_other_hole() {
    let faults = |holes: &str| {
        let solid = format!("Extrude(profile: Rectangle(min: (0, 0), max: (10, 10)), holes: [{holes}], height: 1)");
        read(&of_solids("", &[&solid])).err().unwrap_or_default().into_iter().map(|f| f.message).collect::<Vec<_>>()
    };
    let square = "Rectangle(min: (2, 2), max: (6, 6))";
    assert_eq!(faults(&format!("{square}, Circle(radius: 1, center: (8, 8)), Circle(radius: 1, center: (8, 2))")), [""; 0]);
    for (other, said) in [
        ("Circle(radius: 1, center: (4, 4))", "a hole lies in another hole"),
        ("Rectangle(min: (12, 2), max: (14, 4))", "a hole lies outside of the outer loop"),
    ] {
        for holes in [format!("{square}, {other}"), format!("{other}, {square}")] {
            let found = faults(&holes);
            assert!(found.len() == 1 && found[0].contains(said), "{holes}: {found:?}");
        }
    }
}

#[test]
fn scales_are_limited_all_together() {
    let scaled = |factors: &[&str]| {
        let open: String = factors.iter().map(|f| format!("Scale(by: {f}, solid: ")).collect();
        of_solids("", &[&format!("{open}Sphere(radius: 1){}", ")".repeat(factors.len()))])
    };
    assert_eq!(codes(&scaled(&["1e6", "1e6"])), ["out-of-range"]);
    assert_eq!(codes(&scaled(&["1e-6", "(1, 1e-3, 1)"])), ["out-of-range"]);
    assert_eq!(scene(&scaled(&["1e6", "1e-6", "(1, -1e-6, 1e6)"])).leaves.len(), 1);
}

#[test]
fn interfaces_are_named_by_their_parts_in_either_order() {
    let with = |entries: &str| {
        format!(
            "Scene(units: \"mm\", params: {{\"fine\": \"0.1 cm\"}}, interfaces: {{{entries}}}, parts: [
               Part(name: \"air\", solid: Block(size: (9, 9, 9))),
               Part(name: \"pole\", copies: Linear(count: 2, step: (3, 0, 0)), solid: Sphere(radius: 1, center: (3, 3, 3)))])"
        )
    };
    let scene = scene(&with(
        "\"pole2 | air\": (max_edge: \"fine / 2\"), \"air|pole\": (max_edge: \"fine\"), \"outer|air\": (max_edge: 3), \"pole|pole\": (max_edge: 4)",
    ));
    let part = |k: u32| Some(PartId(k));
    let sizes = |parts: [Option<PartId>; 2]| scene.interfaces_between(parts).map(|(_, i)| i.max_edge).collect::<Vec<_>>();
    assert_eq!(sizes([part(0), part(1)]), [1.0]);
    assert_eq!(sizes([part(2), part(0)]), [0.5, 1.0]);
    assert_eq!(sizes([part(0), None]), [3.0]);
    assert_eq!(sizes([part(1), part(2)]), [4.0]);
    assert_eq!(sizes([part(1), None]), [0.0; 0]);
    for (entries, code) in [
        ("\"air\": (max_edge: 1)", "bad-name"),
        ("\"air|air\": (max_edge: 1)", "bad-name"),
        ("\"outer|outer\": (max_edge: 1)", "bad-name"),
        ("\"air|poles\": (max_edge: 1)", "unknown-part"),
        ("\"air|pole3\": (max_edge: 1)", "unknown-part"),
        ("\"air|pole\": (max_edge: 1), \"pole|air\": (max_edge: 1)", "duplicate-name"),
        ("\"air|pole\": (max_edge: \"1 deg\")", "wrong-unit"),
        ("\"air|pole\": (max_edge: 0)", "not-positive"),
        ("\"air|pole\": (max_edg: 1)", "unknown-field"),
        ("\"air|pole\": ()", "missing-field"),
        ("\"air|pole\": 3", "wrong-type"),
    ] {
        assert_eq!(codes(&with(entries)), [code], "{entries}");
    }
}

#[test]
fn all_reference_scenes_have_the_parts_of_the_peers() {
    for (name, parts, leaves) in [
        ("prism_holes", 1, 3),
        ("cone", 1, 1),
        ("union_two_differences", 1, 4),
        ("cylinders_union_difference", 1, 3),
        ("three_cylinders", 1, 3),
        ("transformer3", 9, 14),
        ("machine", 21, 23),
        ("team07", 3, 4),
        ("sphere_grid", 2, 28),
    ] {
        let scene = scene(&bundled(&format!("{name}.ron")));
        assert_eq!((scene.parts.len(), scene.leaves.len()), (parts, leaves), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// Damaged scenes give a scene or errors, never a panic (which would be an internal error here).
    #[test]
    fn damaged_scenes_never_panic(cuts in prop::collection::vec((0usize..9000, 0usize..40, 0usize..9000, 0usize..40), 1..6)) {
        let mut text: Vec<char> = bundled("tour.ron").chars().collect();
        for (at, drop, from, take) in cuts {
            let n = text.len();
            let piece: Vec<char> = text[from.min(n)..(from + take).min(n)].to_vec();
            text.splice(at.min(n)..(at + drop).min(n), piece);
        }
        let text: String = text.into_iter().collect();
        if let Err(faults) = read(&text) {
            prop_assert!(!faults.is_empty());
            prop_assert!(faults.iter().all(|fault| fault.severity == Severity::Error), "{faults:?}");
        }
    }

    /// Damaged expressions likewise, and a fault is always inside of the text.
    #[test]
    fn any_expression_ends(text in "[-+*/^() 0-9.,a-zµ_]{0,40}") {
        let _ = length("\"a\": 1", &format!("{text:?}"));
    }
}

#[test]
fn parameters_that_refer_to_earlier_ones_need_no_depth() {
    // z0 = 1 mm, z1 = z0 + 1 mm, ..: layers as programs write them. The other way round each waits for the next.
    let layer = |k: usize| format!("\"z{k}\": \"z{} + 1 mm\"", k - 1);
    let rising: Vec<String> = std::iter::once("\"z0\": 1".to_owned()).chain((1..1000).map(layer)).collect();
    assert_eq!(length(&rising.join(", "), "\"z999\""), Ok(1000.0));
    let falling: Vec<String> = rising.into_iter().rev().collect();
    let codes = length(&falling.join(", "), "1").unwrap_err();
    assert!(!codes.is_empty() && codes.iter().all(|code| *code == "too-deep"), "{codes:?}");
}

#[test]
fn only_parts_and_boundaries_are_not_called_outer() {
    let solids = "solids: {\"outer\": Sphere(radius: 1, name: \"outer\")},";
    assert_eq!(codes(&of_solids(solids, &["Use(\"outer\")"])), Vec::<&str>::new());
    let part = "Scene(units: \"mm\", parts: [Part(name: \"outer\", solid: Sphere(radius: 1))])";
    let faults = read(part).unwrap_err();
    assert!(faults[0].code == "bad-name" && faults[0].hints[0].contains("outside of all parts"), "{faults:?}");
}

#[test]
fn arcs_that_turn_back_or_are_too_small_say_how_to_write_them() {
    let sweep = |arc: &str| {
        let path = format!("Path(start: (0, 0), segments: [Line(to: (10, 0)), {arc}], closed: false)");
        of_solids("", &[&format!("Sweep(profile: Circle(radius: 1), path: {path})")])
    };
    let hint = |arc: &str| read(&sweep(arc)).unwrap_err()[0].hints[0].clone();
    // A quarter about (10, -5) from (10, 0) runs on to the right and down clockwise, and back counter-clockwise.
    assert_eq!(codes(&sweep("Arc(to: (15, -5), center: (10, -5), ccw: false)")), Vec::<&str>::new());
    assert!(hint("Arc(to: (15, -5), center: (10, -5))").contains("`ccw: false`"));
    assert!(hint("Arc(to: (20, 0), center: (15, 0))").contains("right angle"));
    // From (10, 0) to (13, 4) are 5: the radius is 2.5 at least.
    assert!(hint("Arc(to: (13, 4), radius: 2)").contains("at least, 2.5,"));
}

#[test]
fn faults_of_many_copies_hide_no_other() {
    let text = "Scene(units: \"mm\", parts: [Part(name: \"a\", solid: Block(size: (1, 1, 1)), copies: Linear(count: 300, \
                step: (2, 0, 0)), boundaries: [Side(name: \"t\", side: \"tpo\")]), Part(name: \"b\", solid: Sphere(radius: 0))])";
    assert_eq!(codes(text), ["unknown-side", "not-positive"]);
}
