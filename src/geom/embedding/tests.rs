use super::*;
use crate::geom::aabb::Aabb;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

fn kinds(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Kind> {
    violations(points, triangles, 100).iter().map(|v| v.kind).collect()
}

/// The next float above.
fn up(x: f64) -> f64 {
    f64::from_bits(x.to_bits() + 1)
}

#[test]
fn neighbours_over_edges_and_vertices_are_fine() {
    let points = [v(0., 0., 0.), v(1., 0., 0.), v(0., 1., 0.), v(1., 1., 0.), v(0., 0., 1.), v(2., 2., 1.), v(2., 2., 0.)];
    let triangles = [[0, 1, 2], [2, 1, 3], [0, 4, 1], [1, 4, 5], [3, 5, 6], [0, 2, 4]];
    assert_eq!(kinds(&points, &triangles), []);
}

#[test]
fn fold_over_a_shared_edge_is_an_overlap_only_in_one_plane() {
    let fold = |z| [v(0., 0., 0.), v(3., 0., 0.), v(0., 3., 0.), v(1., 1., z)];
    let triangles = [[0, 1, 2], [1, 0, 3]];
    assert_eq!(kinds(&fold(0.0), &triangles), [Kind::Overlap]);
    assert_eq!(kinds(&fold(f64::MIN_POSITIVE), &triangles), []);
}

#[test]
fn penetration_by_one_unit_in_the_last_place() {
    let over = |z| [v(0., 0., 1.), v(4., 0., 1.), v(0., 4., 1.), v(1., 1., z), v(1., 2., 3.), v(2., 1., 3.)];
    let triangles = [[0, 1, 2], [3, 4, 5]];
    assert_eq!(kinds(&over(up(1.0)), &triangles), []);
    assert_eq!(kinds(&over(1.0), &triangles), [Kind::VertexOnFacet]);
    assert_eq!(kinds(&over(1.0 - f64::EPSILON / 2.0), &triangles), [Kind::Penetration]);
}

#[test]
fn a_vertex_on_an_edge_is_found_in_the_plane_and_out_of_it() {
    let points = |z| [v(0., 0., 0.), v(2., 0., 0.), v(1., 2., 0.), v(1., 0., 0.), v(0., -1., z), v(2., -1., z)];
    let triangles = [[0, 1, 2], [3, 4, 5]];
    for z in [0.0, 1.0] {
        assert_eq!(kinds(&points(z), &triangles), [Kind::VertexOnEdge]);
        // The T-junction of two neighbours: three triangles about the middle of an edge.
        assert_eq!(kinds(&points(z), &[[0, 1, 2], [0, 4, 3], [3, 5, 1]]), [Kind::VertexOnEdge, Kind::VertexOnEdge]);
    }
}

#[test]
fn coincident_vertices_crossing_edges_and_collinear_edges() {
    let points = [v(0., 0., 0.), v(2., 0., 0.), v(0., 2., 0.), v(0., 0., 0.), v(-1., 0., 1.), v(0., -1., 1.)];
    assert_eq!(kinds(&points, &[[0, 1, 2], [3, 4, 5]]), [Kind::CoincidentVertices]);
    let points = [v(0., 0., 0.), v(2., 0., 0.), v(1., 2., 0.), v(1., 0., -1.), v(1., 0., 1.), v(1., -2., 0.)];
    assert_eq!(kinds(&points, &[[0, 1, 2], [3, 4, 5]]), [Kind::EdgesCross]);
    let points = [v(0., 0., 0.), v(2., 0., 0.), v(1., 2., 0.), v(1., 0., 0.), v(3., 0., 0.), v(2., -1., 1.)];
    assert_eq!(kinds(&points, &[[0, 1, 2], [3, 4, 5]]), [Kind::VertexOnEdge]);
}

#[test]
fn overlap_in_one_plane_with_and_without_a_shared_vertex() {
    let points = [v(0., 0., 0.), v(4., 0., 0.), v(0., 4., 0.), v(1., 1., 0.), v(2., 1., 0.), v(1., 2., 0.), v(5., 5., 0.)];
    assert_eq!(kinds(&points, &[[0, 1, 2], [3, 4, 5]]), [Kind::Overlap]);
    assert_eq!(kinds(&points, &[[0, 1, 2], [0, 4, 5]]), [Kind::Overlap]);
    assert_eq!(kinds(&points, &[[0, 1, 2], [0, 6, 5]]), [Kind::Overlap]);
}

#[test]
fn a_cone_through_a_shared_vertex() {
    let points = |z: f64| [v(0., 0., 0.), v(4., 0., 0.), v(0., 4., 0.), v(1., 1., z), v(1., 1., -z), v(-1., -2., -1.)];
    assert_eq!(kinds(&points(1.0), &[[0, 1, 2], [0, 3, 4]]), [Kind::Penetration]);
    // The other triangle leaves on the far side of the shared vertex.
    assert_eq!(kinds(&points(1.0), &[[0, 1, 2], [0, 3, 5]]), []);
}

#[test]
fn duplicates_and_degenerate_triangles_count_once() {
    let points = [v(0., 0., 0.), v(1., 0., 0.), v(0., 1., 0.), v(2., 0., 0.)];
    assert_eq!(kinds(&points, &[[0, 1, 2], [1, 0, 2]]), [Kind::Duplicate]);
    assert_eq!(kinds(&points, &[[0, 1, 3], [0, 1, 2], [0, 0, 2]]), [Kind::Degenerate, Kind::Degenerate]);
}

#[test]
fn the_limit_is_kept_and_the_order_is_by_number() {
    let points: Vec<Vec3> = (0..300).map(|k| v((k * k % 7) as f64, (k * 5 % 11) as f64, (k % 13) as f64)).collect();
    let triangles: Vec<[u32; 3]> = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let all = violations(&points, &triangles, usize::MAX);
    assert!(all.len() > 50 && all.is_sorted_by_key(|v| v.triangles));
    assert_eq!(violations(&points, &triangles, 7).len(), 7);
}

/// Compares with separating axes in integers on a small grid, where coincidences of every kind are frequent.
#[test]
fn agrees_with_separating_axes_on_a_small_grid() {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as i64
    };
    let mut hits = 0;
    for _ in 0..4000 {
        let grid: Vec<[i64; 3]> = (0..6).map(|_| [next() % 4, next() % 4, next() % 3]).collect();
        let points: Vec<Vec3> = grid.iter().map(|p| v(p[0] as f64, p[1] as f64, p[2] as f64)).collect();
        let found = violations(&points, &[[0, 1, 2], [3, 4, 5]], 10);
        if found.iter().any(|v| v.kind == Kind::Degenerate) {
            continue;
        }
        let meets = exact_distance_is_zero(&grid);
        hits += usize::from(meets);
        assert_eq!(!found.is_empty(), meets, "{grid:?} {found:?}");
    }
    assert!(hits > 500);
}

/// Whether two integer triangles share a point: none of the candidate axes (normals, products of edges, normals of edges in the
/// planes) separates them.
fn exact_distance_is_zero(p: &[[i64; 3]]) -> bool {
    let sub = |a: [i64; 3], b: [i64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross = |a: [i64; 3], b: [i64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot = |a: [i64; 3], b: [i64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let edges = |k: usize| [sub(p[k + 1], p[k]), sub(p[k + 2], p[k + 1]), sub(p[k], p[k + 2])];
    let (e, f) = (edges(0), edges(3));
    let (n, m) = (cross(e[0], e[1]), cross(f[0], f[1]));
    let mut axes = vec![n, m];
    for a in e {
        axes.extend(f.map(|b| cross(a, b)));
        axes.push(cross(n, a));
    }
    axes.extend(f.map(|b| cross(m, b)));
    let is_separated = |axis: &[i64; 3]| {
        let span = |k: usize| {
            let d = [0, 1, 2].map(|i| dot(*axis, p[k + i]));
            (d.into_iter().min(), d.into_iter().max())
        };
        let ((lo, hi), (lo2, hi2)) = (span(0), span(3));
        hi < lo2 || hi2 < lo
    };
    !axes.iter().any(is_separated)
}

#[test]
fn a_fan_of_many_triangles_is_searched_whole() {
    // A fluted disc of 400 triangles about vertex 0, with vertices of other triangles at odd places.
    let n = 400u32;
    let rim = |k: u32, r: f64| {
        let a = f64::from(k) * std::f64::consts::TAU / f64::from(n);
        v(r * a.cos(), r * a.sin(), 0.3 * r * (3.0 * a).cos())
    };
    let mut points: Vec<Vec3> = std::iter::once(v(0., 0., 0.)).chain((0..n).map(|k| rim(k, 1.0))).collect();
    let mut triangles: Vec<[u32; 3]> = (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect();
    assert_eq!(kinds(&points, &triangles), []);
    // One through the fan from the side, one more of its own that cuts two others, and one that is there twice.
    let add = |points: &mut Vec<Vec3>, p: Vec3| {
        points.push(p);
        points.len() as u32 - 1
    };
    let stray = [v(0.5, 0.01, -1.0), v(0.5, 0.01, 1.0), v(0.5, 0.9, 1.0)].map(|p| add(&mut points, p));
    let [low, high] = [rim(100, 0.8) - v(0., 0., 0.4), rim(100, 0.8) + v(0.01, 0.0, 0.4)].map(|p| add(&mut points, p));
    for (extra, least) in [(stray, 3), ([0, low, high], 1), ([0, 51, 52], 1)] {
        let all: Vec<[u32; 3]> = triangles.iter().copied().chain([extra]).collect();
        let found = violations(&points, &all, 10_000);
        assert!(found.len() >= least && found.iter().all(|f| f.triangles[1] == n), "{extra:?}: {found:?}");
        let alone: Vec<Violation> = (0..n)
            .flat_map(|k| {
                violations(&points, &[triangles[k as usize], extra], 9)
                    .into_iter()
                    .map(move |f| Violation { triangles: [k, n], ..f })
            })
            .collect();
        assert_eq!(found, alone);
    }
    triangles.push([0, 1, 1]);
    assert_eq!(kinds(&points, &triangles), [Kind::Degenerate]);
}

/// A closed rolled carpet of `n` by `n` squares on both sides, whose layers come near each other; some vertices are moved.
fn carpet(n: u32, moved: &[(u32, Vec3)]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let at = |side: u32, i: u32, j: u32| {
        let angle = 9.0 * f64::from(i) / f64::from(n);
        let radius = 0.3 + 0.1 * angle + 0.2 * f64::from(side) + 0.01 * libm::sin(f64::from(7 * j));
        v(radius * libm::cos(angle), 2.0 * f64::from(j) / f64::from(n), radius * libm::sin(angle))
    };
    let size = n + 1;
    let number = |side: u32, i: u32, j: u32| side * size * size + i * size + j;
    let places = (0..2).flat_map(|s| (0..size).flat_map(move |i| (0..size).map(move |j| at(s, i, j))));
    let mut points: Vec<Vec3> = places.collect();
    moved.iter().for_each(|(k, by)| points[*k as usize] += by);
    let mut triangles = Vec::new();
    let mut square = |[a, b, c, d]: [u32; 4]| triangles.extend([[a, b, c], [a, c, d]]);
    for k in 0..n {
        for j in 0..n {
            let inner = [number(0, k, j), number(0, k + 1, j), number(0, k + 1, j + 1), number(0, k, j + 1)];
            square(inner);
            square(inner.map(|v| v + size * size).into_iter().rev().collect::<Vec<_>>().try_into().unwrap());
        }
        let mut wall = |a: u32, b: u32| square([b, a, a + size * size, b + size * size]);
        wall(number(0, k, 0), number(0, k + 1, 0));
        wall(number(0, k + 1, n), number(0, k, n));
        wall(number(0, 0, k + 1), number(0, 0, k));
        wall(number(0, n, k), number(0, n, k + 1));
    }
    (points, triangles)
}

/// All pairs, one by one.
fn one_by_one(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let corners = |t: usize| triangles[t].map(|v| points[v as usize]);
    let mut found = Vec::new();
    for t in 0..triangles.len() {
        for s in 0..t {
            if !Aabb::around(&corners(s)).overlaps(&Aabb::around(&corners(t))) {
                continue;
            }
            let (Some(p), Some(q)) = (projection_of(corners(s)), projection_of(corners(t))) else { continue };
            let pair = contact::Pair { points, triangles: [triangles[s], triangles[t]], projections: [p, q] };
            if pair.forbidden_contact().is_some() {
                found.push([s as u32, t as u32]);
            }
        }
    }
    found.sort_unstable();
    found
}

#[test]
fn terrains_hide_no_contact() {
    let n = 14;
    let (middle, count) = (n * n / 2 + n, (n + 1) * (n + 1));
    let mut state = 7u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as u32
    };
    let (mut proven, mut hits, mut clean) = (0, 0, 0);
    for round in 0..40 {
        // Vertices pushed over neighbours, out of the surface, through other layers; the first carpet is flawless.
        let mut push = || f64::from(next() % 1000) * 1e-3 - 0.5;
        let dents: Vec<Vec3> = (0..round % 5).map(|_| v(push(), push(), push())).collect();
        let dents: Vec<(u32, Vec3)> = dents.into_iter().map(|by| (next() % (2 * count), by)).collect();
        let (points, mut triangles) = carpet(n, &dents);
        // A fin, one that touches more, and a triangle turned over.
        match round % 4 {
            1 => triangles.push([middle, middle + 1, count + middle]),
            2 => triangles.push([5, n + 6, 2 * n + 9]),
            3 => triangles[77].swap(0, 1),
            _ => {}
        }
        let found: Vec<[u32; 2]> = violations(&points, &triangles, usize::MAX).iter().map(|v| v.triangles).collect();
        assert_eq!(found, one_by_one(&points, &triangles), "{round}");
        let projections: Vec<_> = triangles.iter().map(|t| projection_of(t.map(|v| points[v as usize]))).collect();
        let twins = twins(points.len(), &triangles);
        let terrains =
            Terrains::new(&Mesh { points: &points, triangles: &triangles, projections: &projections, twins: &twins });
        proven += terrains.of.iter().filter(|t| **t != NONE).count();
        hits += found.len();
        clean += usize::from(found.is_empty());
    }
    assert!(proven > 40 * 600 && hits > 40 * 5 && clean > 0, "{proven} {hits} {clean}");
}

/// A random number below 1, from a state.
fn chance(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as f64 / f64::from(1u32 << 31)
}

fn live(points: &[Vec3], triangles: &[[u32; 3]]) -> Live {
    let projections: Vec<_> = triangles.iter().map(|t| projection_of(t.map(|v| points[v as usize]))).collect();
    Live::new(points, triangles, &projections, &twins(points.len(), triangles))
}

#[test]
fn thin_things_hide_no_contact() {
    // Needles, plates in stacks and fans, turned anyhow; some share a vertex, some meet.
    let mut state = 11u64;
    let (mut hits, mut clean) = (0, 0);
    for round in 0..60 {
        let mut any = || v(chance(&mut state), chance(&mut state), chance(&mut state)) * 2.0 - v(1.0, 1.0, 1.0);
        let (along, across, step) = (any() * 5.0, any() * if round % 2 == 0 { 0.02 } else { 4.0 }, any() * 0.05);
        let hub = any() * 9.0;
        let (mut points, mut triangles) = (vec![hub], Vec::new());
        for k in 0..120 {
            let from = if round % 3 == 0 { hub } else { step * f64::from(k) };
            let slip = any() * if k % 10 == 0 { 0.2 } else { 0.001 };
            let first = if round % 3 == 0 { 0 } else { points.len() as u32 };
            if first > 0 {
                points.push(from);
            }
            let next = points.len() as u32;
            points.extend([hub + along + step * f64::from(k) * 3.0 + slip, hub + along + across + step * f64::from(k) * 3.0]);
            triangles.push([first, next, next + 1]);
        }
        let live = live(&points, &triangles);
        let expected = one_by_one(&points, &triangles);
        let sorted = |mut found: Vec<Violation>| {
            found.sort_unstable_by_key(|v| v.triangles);
            found.into_iter().map(|v| v.triangles).collect::<Vec<_>>()
        };
        assert_eq!(sorted(live.meeting_by_hulls(&points, usize::MAX)), expected, "{round}");
        assert_eq!(live.meeting_by_boxes(&points, usize::MAX).map(sorted), Some(expected.clone()), "{round}");
        hits += expected.len();
        clean += usize::from(expected.is_empty());
    }
    assert!(hits > 1000 && clean > 3, "{hits} {clean}");
}

/// A comb of so many teeth, extruded: caps in fans of needles, walls in stacks.
fn comb(teeth: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let tooth = |k: u32| [(0.9, 10.0), (0.5, 10.0), (0.5, 1.0), (0.1, 1.0)].map(|(x, y)| (f64::from(k) + x, y));
    let rim = [(0.0, 0.0), (f64::from(teeth), 0.0)].into_iter().chain((0..teeth).rev().flat_map(tooth));
    let flat: Vec<Vec3> = rim.map(|(x, y)| v(x, y, 0.0)).collect();
    let n = flat.len() as u32;
    let points: Vec<Vec3> = flat.iter().copied().chain(flat.iter().map(|p| p + v(0.0, 0.0, 3.0))).collect();
    let walk: Vec<u32> = (0..n).collect();
    let cap = crate::geom::polygon::triangulate(&[&walk], &[], &[], &flat).unwrap();
    let mut triangles: Vec<[u32; 3]> = cap.iter().map(|&[a, b, c]| [a, c, b]).collect();
    triangles.extend(cap.iter().map(|t| t.map(|v| v + n)));
    for (a, b) in (0..n).map(|k| (k, (k + 1) % n)) {
        triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
    }
    (points, triangles)
}

#[test]
fn of_a_comb_few_pairs_are_looked_at() {
    let pairs = |teeth: u32| {
        let (points, triangles) = comb(teeth);
        assert_eq!(violations(&points, &triangles, 9), []);
        let live = live(&points, &triangles);
        assert!(live.meeting_by_boxes(&points, 9).is_none());
        let hulls = live.hulls(&points);
        let mut count = 0;
        for task in hulls.tasks(1) {
            hulls.pairs(task, |_, _| {
                count += 1;
                ControlFlow::Continue(())
            });
        }
        count as f64 / triangles.len() as f64
    };
    let [few, many] = [pairs(200), pairs(2000)];
    assert!(few < 30.0 && many < 1.5 * few, "{few} {many}");
}
