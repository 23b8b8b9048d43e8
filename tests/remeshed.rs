//! Scenes whose remeshing once took minutes or left needles, through the command line.

mod support;

use support::{build, folder, gsm};

/// Smallest angle in degrees, share of triangles below 30, number of triangles.
fn shape(name: &str, mode: &str, scene: &str) -> (f64, f64, u64) {
    let folder = folder(&format!("remeshed-{name}-{mode}"));
    let file = folder.join("scene.ron");
    std::fs::write(&file, scene).unwrap();
    let quality = &build(&file, &["--remesh", mode], &folder)["quality"];
    let check = gsm(["check", "scene.poly"], &folder);
    assert_eq!(check.status.code(), Some(0), "{name} {mode}: {}", String::from_utf8_lossy(&check.stdout));
    let number = |key: &str| quality[key].as_f64().unwrap_or_else(|| panic!("{name} {mode}: {key} in {quality}"));
    (number("min_angle"), number("below_30"), number("triangles") as u64)
}

/// The rim lies on the sphere, 6² + 8² = 10²: on the facets the rim and the intersection are two curves, in truth one. The
/// facets between stay as evaluated, where the smallest angle is 30.4 degrees. In Full whole strips stay, and at their short
/// edges at the other crossing triangles are narrow.
#[test]
fn a_rim_on_a_sphere_stays() {
    let scene = r#"Scene(units: "mm", parts: [
        Part(name: "ball", solid: Sphere(radius: 10)),
        Part(name: "rod", solid: Cylinder(radius: 6, height: 23, base: (0, 0, -15))),
    ])"#;
    for (mode, least) in [("interfaces", 30.0), ("full", 1.0)] {
        let (found, _, count) = shape("rim", mode, scene);
        assert!(found > least && count < 1000, "{mode}: {found} {count}");
    }
}

/// A shell of a thousandth of its radius does not ask for triangles as small as it is thin.
#[test]
fn a_thin_shell_gets_no_million_triangles() {
    let scene = r#"Scene(units: "mm", parts: [
        Part(name: "shell", solid: Difference([Sphere(radius: 50), Sphere(radius: 49.95)])),
    ])"#;
    let (least, _, count) = shape("shell", "full", scene);
    assert!(least > 25.0 && count < 100_000, "{least} {count}");
}

/// The rim of a sheet of 35 micrometres stays the strips that it is, 0.035 by 5.2 mm: as triangles they had angles of 1.7 degrees,
/// a fifth of them below 30. Where a given deviation is finer than that of the strips (0.17), they are treated.
#[test]
fn the_rim_of_a_sheet_stays_strips() {
    let disc = r#"Part(name: "disc", solid: Cylinder(radius: 20, height: 0.035))"#;
    let via = r#"Part(name: "via", solid: Cylinder(radius: 1, height: 5, base: (10, 3, -2)))"#;
    let (least, below, _) = shape("sheet", "full", &format!(r#"Scene(units: "mm", parts: [{disc}, {via}])"#));
    assert!(least > 38.0 && below == 0.0, "{least} {below}");
    let triangles = |deviation: f64| {
        let folder = folder(&format!("remeshed-sheet-{deviation}"));
        let file = folder.join("scene.ron");
        std::fs::write(&file, format!(r#"Scene(units: "mm", max_deviation: {deviation}, parts: [{disc}])"#)).unwrap();
        build(&file, &["--remesh", "full"], &folder)["quality"]["triangles"].as_u64().unwrap_or(0)
    };
    assert_eq!(triangles(0.2), 0);
    assert!(triangles(0.1) > 100);
}

/// At 36 segments a vertex was slid along the edge of a slot until it met the next one, to bring two triangles into one plane;
/// for that needle the strips around were given up, and the smallest angle was 9 degrees.
#[test]
fn no_needle_is_made_to_straighten_a_bend() {
    let machine = std::fs::read_to_string("scenes/machine.ron").unwrap();
    let (least, below, _) = shape("machine", "full", &machine.replace("segments: 24", "segments: 36"));
    assert!(least > 38.0 && below == 0.0, "{least} {below}");
}

/// Chords of 24 segments sag by 0.77, five times the shield's thickness; asked for less, they become triangles. Those that were
/// brought into one plane met the other side, and all was given up: 50 facets stayed as evaluated.
#[test]
fn a_shield_thinner_than_its_chords_sag_is_remeshed() {
    let scene = r#"Scene(units: "mm", max_deviation: 0.5, parts: [
        Part(name: "shield", solid: Tube(outer_radius: 90.15, inner_radius: 90, height: 50)),
    ])"#;
    let (least, below, count) = shape("shield", "full", scene);
    assert!(least > 35.0 && below == 0.0 && count > 5000, "{least} {below} {count}");
}

/// Chords of 24 segments sag by 0.56 outside, 0.44 inside. Triangles that deviate by 1 would be 20 long, longer than the wall is
/// thick: the strips stay. Where the wall is thicker, the deviation finer, or short edges are asked for, they do not.
#[test]
fn strips_beside_a_thin_wall_stay_where_they_may() {
    let triangles = |wall: u32, deviation: f64, part: &str| {
        let folder = folder(&format!("remeshed-wall-{wall}-{deviation}-{}", part.len()));
        let file = folder.join("scene.ron");
        let tube = format!("Tube(outer_radius: 65, inner_radius: {}, height: 160)", 65 - wall);
        let scene =
            format!(r#"Scene(units: "mm", max_deviation: {deviation}, parts: [Part(name: "coil"{part}, solid: {tube})])"#);
        std::fs::write(&file, scene).unwrap();
        build(&file, &["--remesh", "full"], &folder)["quality"]["triangles"].as_u64().unwrap_or(0)
    };
    assert_eq!(triangles(13, 1.0, ""), 0);
    assert!(triangles(40, 1.0, "") > 200);
    assert!(triangles(13, 0.4, "") > 500);
    assert!(triangles(13, 1.0, r#", max_edge: "10 mm""#) > 500);
}

/// The rulings of parts that face each other across a gap are in different places, and some are nearly at a part's end, where
/// strips are as narrow as 0.005: these are treated like their neighbours, or needles are left.
#[test]
fn strips_of_a_surface_stay_together() {
    let scene = r#"Scene(units: "mm", parts: [
        Part(name: "core", solid: Tube(outer_radius: 50, inner_radius: 41, height: 30)),
        Part(name: "magnet", copies: Polar(count: 44),
            solid: Revolve(profile: Rectangle(min: (51, 0), max: (56, 30)), angle: "360/44", start: 1.3)),
        Part(name: "yoke", solid: Tube(outer_radius: 68, inner_radius: 56, height: 30)),
    ])"#;
    let (least, below, _) = shape("gear", "full", scene);
    assert!(least > 35.0 && below == 0.0, "{least} {below}");
}
