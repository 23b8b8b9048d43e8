//! Planar polygons with holes: normal, area, triangulation.

use super::Vec3;
use super::cdt::{Cdt, Face, HalfEdge, slot};
use super::hash::IndexMap;
use super::predicates::{Projection, orient2d};
use spade::Triangulation as _;

/// Vector area of a polygon given by its loops (outer counter-clockwise about the result, holes clockwise): half the sum of
/// the cross products, taken about the first vertex so that far-away polygons lose no digits. (Thesis 4.3: the normal of a
/// non-convex polygon.)
pub fn vector_area<'a>(loops: impl IntoIterator<Item = &'a [u32]>, points: &[Vec3]) -> Vec3 {
    let mut sum = Vec3::zeros();
    let mut origin = None;
    for walk in loops {
        let Some(&last) = walk.last() else { continue };
        let mut a = points[last as usize];
        let o = *origin.get_or_insert(a);
        for &b in walk {
            let b = points[b as usize];
            sum += (a - o).cross(&(b - o));
            a = b;
        }
    }
    sum * 0.5
}

/// Whether all vertices lie within `flatness` of a plane: that of the polygon's area, or, since the area of a thin ring is
/// small and its direction uncertain, that of three vertices far apart, by the two shorter sides of their triangle: the product
/// of the longer ones, nearly parallel in a thin strip, is uncertain by more than `flatness`.
pub fn is_planar(loops: &[&[u32]], points: &[Vec3], flatness: f64) -> bool {
    let all = || loops.iter().flat_map(|l| l.iter()).map(|&v| points[v as usize]);
    let Some(first) = all().next() else { return true };
    let is_along = |normal: Vec3| {
        let unit = normal / normal.norm();
        let (lo, hi) = all().map(|p| unit.dot(&(p - first))).fold((0.0, 0.0), |(l, h): (f64, f64), d| (l.min(d), h.max(d)));
        hi - lo <= 2.0 * flatness
    };
    let farthest = |size: &dyn Fn(&Vec3) -> f64| all().fold(first, |far, p| if size(&p) > size(&far) { p } else { far });
    let across = || {
        let second = farthest(&|p| (p - first).norm_squared());
        let third = farthest(&|p| (second - first).cross(&(p - first)).norm_squared());
        let mut sides = [second - first, third - second, first - third];
        sides.sort_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
        sides[0].cross(&sides[1])
    };
    is_along(vector_area(loops.iter().copied(), points)) || is_along(across())
}

/// Why a polygon has no triangulation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PolygonError {
    /// Two of its edges cross or overlap in the projection.
    NotSimple,
    /// It has no area.
    Flat,
}

/// Constrained Delaunay triangulation of a planar polygon in the projection along the dominant axis of its normal.
///
/// `loops`: vertex numbers, outer loop first and counter-clockwise about the polygon's normal, holes clockwise; a vertex may be
/// listed by several loops. `chains`: further vertex pairs that must be edges. `lone`: further vertices inside.
/// Yields triangles of the same orientation as the outer loop; no new vertices. The result depends only on the arguments.
///
/// # Errors
/// If edges cross or overlap, or the area is zero.
pub fn triangulate(
    loops: &[&[u32]],
    chains: &[[u32; 2]],
    lone: &[u32],
    points: &[Vec3],
) -> Result<Vec<[u32; 3]>, PolygonError> {
    if let ([walk], [], []) = (loops, chains, lone)
        && let &[a, b, c] = *walk
    {
        return triangle([a, b, c], points).map(|t| vec![t]);
    }
    let normal = vector_area(loops.iter().copied(), points);
    if normal == Vec3::zeros() {
        return Err(PolygonError::Flat);
    }
    let projection = Projection::along(&normal);
    let flat = |v: u32| projection.apply(&points[v as usize]);
    if let ([quad], [], []) = (loops, chains, lone)
        && let &[a, b, c, d] = *quad
        && let Some(pair) = split_quad([a, b, c, d], flat)
    {
        return Ok(pair.to_vec());
    }
    if let ([walk], [], []) = (loops, chains, lone)
        && walk.len() <= SMALL
        && let Some(triangles) = triangulate_convex(walk, flat)
    {
        return Ok(triangles);
    }
    triangulate_general(loops, chains, lone, flat)
}

/// The same for a polygon of three corners.
///
/// # Errors
/// If the area is zero.
pub fn triangle(corners: [u32; 3], points: &[Vec3]) -> Result<[u32; 3], PolygonError> {
    let normal = vector_area([&corners[..]], points);
    let projection = Projection::along(&normal);
    let [a, b, c] = corners.map(|v| projection.apply(&points[v as usize]));
    if normal != Vec3::zeros() && orient2d(a, b, c) > 0 { Ok(corners) } else { Err(PolygonError::Flat) }
}

/// Corners up to which a convex polygon is triangulated in quadratic time, which is then less than setting up the general way
/// costs.
const SMALL: usize = 32;

/// Delaunay triangulation of a convex polygon, which may go straight on at corners: beyond each edge that is reached the corner
/// that sees it under the largest angle. `None` if it is not convex.
fn triangulate_convex(walk: &[u32], flat: impl Fn(u32) -> [f64; 2]) -> Option<Vec<[u32; 3]>> {
    let at: Vec<[f64; 2]> = walk.iter().map(|&v| flat(v)).collect();
    let n = at.len();
    // Left turns only, and only once round: one step goes from descending to ascending.
    let is_rising = |k: usize| at[k % n] < at[(k + 1) % n];
    let is_left = |k: usize| match orient2d(at[k], at[(k + 1) % n], at[(k + 2) % n]) {
        0 => is_rising(k) == is_rising(k + 1),
        turn => turn > 0,
    };
    let rounds = (0..n).filter(|&k| !is_rising(k) && is_rising(k + 1)).count();
    if rounds != 1 || !(0..n).all(is_left) {
        return None;
    }
    let mut triangles = Vec::with_capacity(n - 2);
    let mut edges = vec![[0, n - 1]];
    while let Some([i, j]) = edges.pop() {
        let cotangent = |k: usize| {
            let [p, q] = [i, j].map(|e| [at[e][0] - at[k][0], at[e][1] - at[k][1]]);
            (p[0] * q[0] + p[1] * q[1]) / (p[0] * q[1] - p[1] * q[0]).abs()
        };
        // Ties (points of a circle) go by vertex number.
        let beyond = (i + 1..j).filter(|&k| orient2d(at[i], at[k], at[j]) > 0);
        let seen = beyond.map(|k| (cotangent(k), k));
        let (_, k) = seen.min_by(|a, b| a.0.total_cmp(&b.0).then(walk[a.1].cmp(&walk[b.1])))?;
        triangles.push([walk[i], walk[k], walk[j]]);
        edges.extend([[i, k], [k, j]].into_iter().filter(|e| e[1] - e[0] > 1));
    }
    Some(triangles)
}

/// A corner of a quadrilateral is nearly straight if its triangle has less than this part of the area.
const STRAIGHT: f64 = 1e-6;

/// A convex quadrilateral, by far the most frequent polygon (strips), cut along its shorter diagonal; at a corner that is
/// nearly straight, since a needle there would stand on the plane in any way that rounding likes.
fn split_quad([a, b, c, d]: [u32; 4], flat: impl Fn(u32) -> [f64; 2]) -> Option<[[u32; 3]; 2]> {
    let turn = |i, j, k| orient2d(flat(i), flat(j), flat(k));
    if turn(a, b, c) <= 0 || turn(b, c, d) <= 0 || turn(c, d, a) <= 0 || turn(d, a, b) <= 0 {
        return None;
    }
    let length = |i, j| {
        let (p, q) = (flat(i), flat(j));
        (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
    };
    // Ties (rectangles) go by vertex number, so that both owners of a shared facet cut it alike.
    let (ac, bd) = (length(a, c), length(b, d));
    let area = |i, j, k| {
        let [p, q, r] = [i, j, k].map(&flat);
        ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).abs()
    };
    let straightest = |one: [u32; 3], other: [u32; 3]| area(one[0], one[1], one[2]).min(area(other[0], other[1], other[2]));
    let (at_ac, at_bd) = (straightest([d, a, b], [b, c, d]), straightest([a, b, c], [c, d, a]));
    let along_ac = match at_ac.min(at_bd) < STRAIGHT * at_ac.max(at_bd) {
        true => at_ac < at_bd,
        false if ac == bd => a.min(c) < b.min(d),
        false => ac < bd,
    };
    Some(if along_ac { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] })
}

fn triangulate_general(
    loops: &[&[u32]],
    chains: &[[u32; 2]],
    lone: &[u32],
    flat: impl Fn(u32) -> [f64; 2],
) -> Result<Vec<[u32; 3]>, PolygonError> {
    let mut vertices: Vec<u32> = loops
        .iter()
        .flat_map(|w| w.iter().copied())
        .chain(chains.iter().flatten().copied())
        .chain(lone.iter().copied())
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    let number = |v: u32| vertices.binary_search(&v).unwrap_or(0);
    let boundary: Vec<[usize; 2]> =
        loops.iter().flat_map(|w| (0..w.len()).map(move |k| [w[k], w[(k + 1) % w.len()]].map(number))).collect();
    let edges: Vec<[usize; 2]> =
        boundary.iter().copied().chain(chains.iter().map(|c| c.map(number))).filter(|[a, b]| a != b).collect();
    let at: Vec<[f64; 2]> = vertices.iter().map(|&v| flat(v)).collect();
    let cdt = match Cdt::new(on_grid(&at), &edges).ok().filter(|cdt| is_embedded(cdt, &at)) {
        Some(cdt) => cdt,
        None => Cdt::new(at, &edges).map_err(|_| PolygonError::NotSimple)?,
    };
    let inside = inside(&cdt, &boundary);
    let faces = cdt.triangulation.inner_faces().filter(|f| inside[f.index()]);
    let triangles: Vec<[u32; 3]> = faces.map(|f| f.vertices().map(|v| vertices[slot(v)])).collect();
    if triangles.is_empty() { Err(PolygonError::Flat) } else { Ok(triangles) }
}

/// Steps of a grid over a figure: so few that a place moved by half a step is clearly off the circle through three others. The
/// determinant is then some 2^75, its rounding error in `f64` 2^54; only what is nearer needs long numbers.
const GRID_STEPS: f64 = (1u64 << 25) as f64;

/// Places moved onto a coarse grid. Corners of round parts lie on one circle to rounding, where signs need long numbers; here
/// chance decides among triangulations that are equally good, and much faster.
fn on_grid(at: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let Some(&origin) = at.first() else { return Vec::new() };
    let extent = at.iter().fold(0.0, |m: f64, p| m.max((p[0] - origin[0]).abs()).max((p[1] - origin[1]).abs()));
    // A power of two, so that nothing else is rounded.
    let step = libm::exp2(libm::floor(libm::log2(extent)) + 1.0) / GRID_STEPS;
    at.iter().map(|p| [0, 1].map(|k| ((p[k] - origin[k]) / step).round())).collect()
}

/// Whether a triangulation of other places is one of these too: all triangles turn left, and so does the hull.
fn is_embedded(cdt: &Cdt, at: &[[f64; 2]]) -> bool {
    let turn = |ends: [usize; 3]| orient2d(at[ends[0]], at[ends[1]], at[ends[2]]);
    let is_left = |f: Face| turn(f.vertices().map(slot)) > 0;
    // The hull runs clockwise about the outer face.
    let is_convex = |e: HalfEdge| turn([e.from(), e.to(), e.next().to()].map(slot)) <= 0;
    cdt.triangulation.inner_faces().all(is_left) && cdt.triangulation.convex_hull().all(is_convex)
}

/// For each face whether the boundary winds round it.
fn inside(cdt: &Cdt, boundary: &[[usize; 2]]) -> Vec<bool> {
    // Winding number of each triangle: cross from the outside, adding what each boundary edge turns.
    let mut winding: IndexMap<(usize, usize), i32> = IndexMap::default();
    winding.reserve(2 * boundary.len());
    for &[a, b] in boundary {
        *winding.entry((a, b)).or_insert(0) += 1;
        *winding.entry((b, a)).or_insert(0) -= 1;
    }
    let cdt = &cdt.triangulation;
    let mut number = vec![None; cdt.num_all_faces()];
    number[cdt.outer_face().index()] = Some(0i32);
    let mut stack: Vec<_> = cdt.convex_hull().map(|e| if e.is_outer_edge() { e.rev() } else { e }).collect();
    while let Some(e) = stack.pop() {
        let Some(face) = e.face().as_inner() else { continue };
        if number[face.index()].is_some() {
            continue;
        }
        let from = number[e.rev().face().index()].unwrap_or(0);
        let step = winding.get(&(slot(e.from()), slot(e.to()))).copied().unwrap_or(0);
        number[face.index()] = Some(from + step);
        stack.extend(face.adjacent_edges().iter().map(|e| e.rev()));
    }
    number.into_iter().map(|n| n.is_some_and(|n| n > 0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(triangles: &[[u32; 3]], points: &[Vec3]) -> f64 {
        triangles.iter().map(|t| vector_area([&t[..]], points).norm()).sum()
    }

    #[test]
    fn a_thin_ring_is_planar_as_far_as_its_corners_are() {
        // Two squares about one place, turned by some angle: with a wall of 1e-3 rounding tilts the plane of the area.
        let (c, s) = (0.6, 0.8);
        let corner = |r: f64, k: usize| {
            let (x, y) = [(r, r), (-r, r), (-r, -r), (r, -r)][k];
            Vec3::new(x, c * y + 7.1, s * y - 3.3)
        };
        let points: Vec<Vec3> = (0..8).map(|k| corner(if k < 4 { 50.0 } else { 49.999 }, k % 4)).collect();
        let loops: [&[u32]; 2] = [&[0, 1, 2, 3], &[7, 6, 5, 4]];
        assert!(is_planar(&loops, &points, 4.0 * f64::EPSILON * 100.0));
        let mut bent = points.clone();
        bent[6].x += 1e-3;
        bent[6].z += 1e-9;
        assert!(!is_planar(&loops, &bent, 4.0 * f64::EPSILON * 100.0));
    }

    /// A strip of a thin strut, turned and cut, became two needles: the product of two vectors along it was uncertain.
    #[test]
    fn a_thin_strip_is_planar_as_far_as_its_corners_are() {
        let points = [
            Vec3::new(-0.03604427527632857, 0.07657265172433077, 1.0457669047150178),
            Vec3::new(-0.036550548941123584, 0.07548263639073328, 1.0452505896231452),
            Vec3::new(-0.3663535714960995, 0.6467182279457359, 0.16267912081405486),
            Vec3::new(-0.3659164174638821, 0.6479279619947584, 0.16301046787508575),
        ];
        let flatness = 4.0 * f64::EPSILON;
        assert!(is_planar(&[&[0, 1, 2, 3]], &points, flatness));
        let mut bent = points;
        bent[3].z += 1e-13;
        assert!(!is_planar(&[&[0, 1, 2, 3]], &bent, flatness));
    }

    #[test]
    fn square_with_square_hole() {
        let p = |x: f64, y: f64| Vec3::new(2.0, x, y);
        let points = [p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.), p(1., 1.), p(1., 3.), p(3., 3.), p(3., 1.)];
        let triangles = triangulate(&[&[0, 1, 2, 3], &[4, 5, 6, 7]], &[], &[], &points).unwrap();
        assert_eq!(triangles.len(), 8);
        assert!((area(&triangles, &points) - 12.0).abs() < 1e-12);
        assert!(triangles.iter().all(|t| vector_area([&t[..]], &points).x > 0.0));
    }

    #[test]
    fn hole_that_touches_the_outer_loop_in_a_vertex() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = [p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.), p(1., 2.), p(2., 1.)];
        let triangles = triangulate(&[&[0, 1, 2, 3], &[0, 4, 5]], &[], &[], &points).unwrap();
        assert!((area(&triangles, &points) - 14.5).abs() < 1e-12);
    }

    #[test]
    fn inner_chain_and_vertex_are_kept() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = [p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.), p(1., 1.), p(3., 1.), p(2., 3.)];
        let triangles = triangulate(&[&[0, 1, 2, 3]], &[[4, 5]], &[6], &points).unwrap();
        let has = |a, b| triangles.iter().any(|t| t.contains(&a) && t.contains(&b));
        assert!(has(4, 5) && triangles.iter().any(|t| t.contains(&6)));
        assert_eq!(triangles.len(), 8);
    }

    #[test]
    fn a_convex_polygon_is_delaunay() {
        // A pentagon with one corner nearly straight: no triangle stands on it alone.
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = [p(0., 0.), p(2., -1e-9), p(4., 0.), p(4., 3.), p(0., 3.)];
        let triangles = triangulate(&[&[0, 1, 2, 3, 4]], &[], &[], &points).unwrap();
        assert_eq!(triangles, [[0, 1, 4], [1, 3, 4], [1, 2, 3]]);
        // The corner in the middle of a side is one of a triangle.
        let walk = [0, 1, 2, 3, 4];
        let square = [[0., 0.], [2., 0.], [4., 0.], [4., 4.], [0., 4.]];
        let triangles = triangulate_convex(&walk, |v| square[v as usize]).unwrap();
        assert_eq!(triangles, [[0, 1, 4], [1, 3, 4], [1, 2, 3]]);
        // A pentagram turns left at every corner, but twice round.
        let star = [0, 2, 4, 1, 3].map(|k| f64::from(k) * 0.4 * std::f64::consts::PI).map(|a| p(libm::cos(a), libm::sin(a)));
        assert!(triangulate_convex(&[0, 1, 2, 3, 4], |v| [star[v as usize].x, star[v as usize].y]).is_none());
    }

    #[test]
    fn an_edge_through_a_vertex_is_refused() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = [p(0., 4.), p(0., 0.), p(0., 3.), p(5., 2.), p(5., 4.)];
        assert_eq!(triangulate(&[&[0, 1, 2, 3, 4]], &[], &[], &points), Err(PolygonError::NotSimple));
    }

    #[test]
    fn what_is_finer_than_the_grid_counts() {
        // A hole whose corner is a little inside of an edge, and a little outside.
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let with = |x: f64| [p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.), p(x, 2.), p(2., 3.), p(2., 1.)];
        let loops: [&[u32]; 2] = [&[0, 1, 2, 3], &[4, 5, 6]];
        let inside = with(1e-12);
        let triangles = triangulate(&loops, &[], &[], &inside).unwrap();
        assert_eq!(triangles.len(), 7);
        assert!((area(&triangles, &inside) - 14.0).abs() < 1e-9);
        assert!(triangles.iter().all(|t| triangle(*t, &inside).is_ok()));
        assert_eq!(triangulate(&loops, &[], &[], &with(-1e-12)), Err(PolygonError::NotSimple));
    }

    #[test]
    fn crossing_edges_are_refused() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = [p(0., 0.), p(4., 4.), p(4., 0.), p(0., 5.)];
        assert_eq!(triangulate(&[&[0, 1, 2, 3]], &[], &[], &points), Err(PolygonError::NotSimple));
    }
}
