//! Each facet is planar and simple, and none is there twice.

use super::Subject;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::polygon::PolygonError;
use crate::geom::union_find::UnionFind;
use crate::plc::PlcFacet;
use crate::plc::facet::{Area, is_once_each, normal_of, segments_of};
use std::collections::{BTreeMap, BTreeSet};

/// Largest distance of a polygon's vertices from its plane, in units in the last place of the model's size: what rounding the
/// coordinates of an oblique polygon leaves, and a little for measuring it.
const PLANARITY_ULPS: f64 = 4.0;

/// Facets without an outline, or with polygons that list a vertex twice in a row.
pub fn malformed(subject: &Subject) -> Vec<Diagnostic> {
    let mut findings = Vec::new();
    for (k, f) in subject.plc.facets.iter().enumerate() {
        if !has_outline(f) {
            let message = format!("{} has no outline, only segments and vertices", subject.facet_name(k as u32));
            let corner = f.polygons.iter().flatten().next();
            let finding = Diagnostic::warning("bad-polygon", message)
                .hint("TetGen keeps them as constraints of the mesh; take the facet out if it bounds nothing");
            findings.push(corner.map_or(finding.clone(), |&v| finding.near(subject.point(v))));
        }
        for polygon in f.polygons.iter().filter(|p| p.len() > 1) {
            let repeated = (0..polygon.len()).find(|&i| polygon[i] == polygon[(i + 1) % polygon.len()]);
            if let Some(i) = repeated {
                let message = format!("{} lists vertex {} twice in a row", subject.facet_name(k as u32), polygon[i] + 1);
                let finding = Diagnostic::error("bad-polygon", message).near(subject.point(polygon[i]));
                findings.push(finding.hint("list it once"));
            }
        }
    }
    findings
}

/// Whether segments of a facet close a loop.
pub fn has_outline(f: &PlcFacet) -> bool {
    if f.polygons.iter().any(|p| p.len() > 2 && is_once_each(p)) {
        return true;
    }
    // Segments without a loop join what no others have joined.
    let segments: BTreeSet<[u32; 2]> = f.polygons.iter().flat_map(|p| segments_of(p)).collect();
    let vertices: BTreeSet<u32> = segments.iter().flatten().copied().collect();
    let vertices: Vec<u32> = vertices.into_iter().collect();
    let slot = |v: u32| vertices.binary_search(&v).unwrap_or(0) as u32;
    let mut union = UnionFind::new(vertices.len());
    segments.iter().any(|&[a, b]| {
        let [a, b] = [a, b].map(slot);
        let is_closing = union.find(a) == union.find(b);
        union.join(a, b);
        is_closing
    })
}

/// Hole points of a facet that do nothing, and those that lie on its segments.
pub fn wrong_holes(subject: &Subject, facet: u32, area: &Area) -> Vec<Diagnostic> {
    let name = || subject.facet_name(facet);
    let idle = area.idle_holes.iter().map(|&p| {
        Diagnostic::warning("idle-hole", format!("{}: a hole point lies outside of it and takes nothing away", name()))
            .near(p)
            .hint("move it into the hole, or take it out")
    });
    let unclear = area.unclear_holes.iter().map(|&p| {
        Diagnostic::error("hole-on-edge", format!("{}: a hole point lies on an edge, so that its hole is not clear", name()))
            .near(p)
            .hint("move it strictly inside the hole")
    });
    idle.chain(unclear).collect()
}

/// A facet that has no triangulation.
pub fn no_triangulation(subject: &Subject, facet: u32, why: PolygonError) -> Diagnostic {
    let has_holes = !subject.plc.facets[facet as usize].holes.is_empty();
    let (what, hint) = match why {
        PolygonError::NotSimple => (
            "its edges cross, overlap or pass through a vertex",
            "divide edges where they meet, and list the vertices in order around the facet",
        ),
        PolygonError::Flat if has_holes => ("its hole points leave nothing of it", "move them into the holes"),
        PolygonError::Flat => ("it has no area", "take it out, or correct its vertices"),
    };
    let message = format!("{} is no simple polygon: {what}", subject.facet_name(facet));
    let corner = subject.plc.facets[facet as usize].polygons.first().and_then(|p| p.first());
    let finding = Diagnostic::error("not-simple", message).hint(hint);
    corner.map_or(finding.clone(), |&v| finding.near(subject.point(v)))
}

/// Facets whose vertices are not in one plane.
pub fn bent(subject: &Subject) -> Vec<Diagnostic> {
    let limit = PLANARITY_ULPS * f64::EPSILON * subject.scale();
    let mut findings = Vec::new();
    for (k, f) in subject.plc.facets.iter().enumerate() {
        if f.polygons.iter().map(Vec::len).sum::<usize>() <= 3 {
            continue;
        }
        let normal = normal_of(f, &subject.plc.vertices);
        let points: Vec<Vec3> = f.polygons.iter().flatten().map(|&v| subject.point(v)).collect();
        let (distance, worst) = distance_from_plane(&points, normal);
        if distance > limit {
            let message = format!("{} is not planar: a vertex is {distance:e} from its plane", subject.facet_name(k as u32));
            let finding = Diagnostic::error("not-planar", message).near(worst);
            findings.push(finding.hint("divide it into triangles, or move the vertex into the plane"));
        }
    }
    findings
}

/// Half the thickness of the points across the plane that fits them best, and the point farthest out.
///
/// The given normal of a needle is only good to rounding over its width; one step of least squares makes it good over its
/// length.
fn distance_from_plane(points: &[Vec3], normal: Vec3) -> (f64, Vec3) {
    let Some(n) = normal.try_normalize(0.0) else { return (0.0, Vec3::zeros()) };
    let center = points.iter().sum::<Vec3>() / points.len() as f64;
    let along = points.iter().map(|p| p - center).max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    let Some(u) = along.and_then(|d| (d - n * n.dot(&d)).try_normalize(0.0)) else { return (0.0, center) };
    let v = n.cross(&u);
    let local: Vec<Vec3> = points.iter().map(|p| p - center).map(|d| Vec3::new(d.dot(&u), d.dot(&v), d.dot(&n))).collect();
    let sum = |i: usize, j: usize| local.iter().map(|d| d[i] * d[j]).sum::<f64>();
    let (uu, uv, vv, uh, vh) = (sum(0, 0), sum(0, 1), sum(1, 1), sum(0, 2), sum(1, 2));
    let det = uu * vv - uv * uv;
    let (a, b) = if det > 0.0 { ((uh * vv - vh * uv) / det, (vh * uu - uh * uv) / det) } else { (0.0, 0.0) };
    let heights: Vec<f64> = local.iter().map(|d| d[2] - a * d[0] - b * d[1]).collect();
    let lo = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let hi = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let middle = 0.5 * (lo + hi);
    let farthest = (0..points.len()).max_by(|&i, &j| (heights[i] - middle).abs().total_cmp(&(heights[j] - middle).abs()));
    (0.5 * (hi - lo), farthest.map_or(center, |i| points[i]))
}

/// Facets over the same vertices as an earlier one.
pub fn doubled(subject: &Subject) -> Vec<Diagnostic> {
    let mut first: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    let mut findings = Vec::new();
    for (k, f) in subject.plc.facets.iter().enumerate() {
        let mut key: Vec<u32> = f.polygons.iter().flatten().copied().collect();
        key.sort_unstable();
        key.dedup();
        let earlier = *first.entry(key).or_insert(k as u32);
        if earlier != k as u32 && has_same_outline(&subject.plc.facets[earlier as usize].polygons, &f.polygons) {
            let [a, b] = [earlier, k as u32].map(|x| subject.facet_name(x));
            let message = format!("{a} and {b} are the same polygon");
            let at = f.polygons.first().and_then(|p| p.first()).map_or(Vec3::zeros(), |&v| subject.point(v));
            findings
                .push(Diagnostic::error("duplicate-facet", message).near(at).hint("one facet is enough between two volumes"));
        }
    }
    findings
}

/// Whether two lists of polygons have the same edges.
fn has_same_outline(s: &[Vec<u32>], t: &[Vec<u32>]) -> bool {
    let edges = |polygons: &[Vec<u32>]| {
        let each = |p: &Vec<u32>| {
            (0..p.len()).map(|k| [p[k], p[(k + 1) % p.len()]]).map(|[a, b]| [a.min(b), a.max(b)]).collect::<Vec<_>>()
        };
        let mut all: Vec<[u32; 2]> = polygons.iter().flat_map(each).collect();
        all.sort_unstable();
        all
    };
    edges(s) == edges(t)
}
