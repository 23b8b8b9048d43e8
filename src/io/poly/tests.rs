use super::*;
use crate::geom::Vec3;
use crate::plc::{Plc, PlcFacet, Seed};

fn sample() -> Plc {
    Plc {
        vertices: vec![Vec3::new(0.1, -0.0, 1e-300), Vec3::new(1.0 / 3.0, 1e22, 5.0), Vec3::new(0.0, 1.0, 2.0)],
        facets: vec![PlcFacet { polygons: vec![vec![0, 1, 2], vec![1]], holes: vec![Vec3::new(1.0, 2.0, 3.0)], marker: 7 }],
        seeds: vec![
            Seed { point: Vec3::new(0.1, 0.2, 0.3), region: 3, max_volume: Some(0.5) },
            Seed { point: Vec3::x(), region: 4, max_volume: None },
        ],
        holes: vec![Vec3::z()],
    }
}

#[test]
fn what_is_written_reads_back_to_the_same_bits() {
    let text = to_text(&sample(), None);
    assert_eq!(parse(&text, None, false).unwrap(), sample());
    assert_eq!(to_text(&parse(&text, None, false).unwrap(), None), text);
}

#[test]
fn numbers_from_zero_comments_and_split_polygons() {
    let text = "# c\n3 3 0 0\n0 0 0 0 # first\n1 1 0 0\n2 0 1 0\n\n1 0\n1\n3 0\n1 2\n0\n";
    let plc = parse(text, None, false).unwrap();
    assert_eq!(plc.facets[0].polygons, [vec![0, 1, 2]]);
    let smesh = parse("0 3\n1 1\n3 1 2 3 9\n", Some(("a.node", "3 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n")), true).unwrap();
    assert_eq!((smesh.facets[0].marker, smesh.vertices.len()), (9, 3));
    let fault = parse("0 3\n1 1\n3 1 2 3 9\n", Some(("a.node", "3 3\n1 0 0 0\n2 1 x 0\n")), true).unwrap_err();
    assert!(fault.message.starts_with("a.node:3:5: ") && fault.span.is_none(), "{fault:?}");
}

#[test]
fn bad_files_are_refused_with_their_line() {
    let line_and_column = |text: &str| {
        let fault = parse(text, None, false).unwrap_err();
        let span = fault.span.unwrap();
        (span.line, span.column, fault.message)
    };
    for (text, line, column, part) in [
        ("", 0, 1, "ends"),
        ("4000000000 3\n1 0 0 0\n", 2, 1, "ends"),
        ("1 3\n1 0 nan 0\n0\n", 2, 5, "finite"),
        ("1 3\n1 0 0 1e999\n0\n", 2, 7, "finite"),
        ("1 2\n", 1, 3, "dimension"),
        ("1 3\n7 0 0 0\n", 2, 1, "numbered"),
        ("1 3\n1 0 0\n", 2, 6, "z is missing"),
        ("1 3\n1 0 0 0\n1 1\n1\n3 1 1 2\n", 5, 7, "no vertex 2"),
        ("1 3\n1 0 0 0\n1 1\n1\n-3 1 1 2\n", 5, 1, "cannot be -3"),
        ("x", 1, 1, "integer"),
        ("1 3\n1 0 0 1e101\n", 2, 7, "up to 1e100"),
        ("1 3\n1 0 0 0\n0\n0\n1\n1 0 0 0 1.5\n", 6, 9, "whole number, not 1.5"),
        ("1 3\n1 0 0 0\n0\n0\n1\n1 0 0 0 1e30\n", 6, 9, "whole number"),
    ] {
        let (l, c, message) = line_and_column(text);
        assert!((l, c) == (line, column) && message.contains(part), "{text:?}: {l}:{c}: {message}");
    }
}
