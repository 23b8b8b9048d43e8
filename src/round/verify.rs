//! Whether rounded facets are a complex: they meet in whole shared vertices and edges only, and around every edge the sides
//! that face each other belong to one part.
//!
//! The first does not follow from the second nor the second from the first: a triangle one unit in the last place wide, turned
//! over about an edge that it shares, meets nothing that it must not, but faces the wrong part.

use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::geom::embedding;
use crate::geom::lists::Lists;
use crate::geom::radial::Axis;
use crate::geom::union_find::UnionFind;
use crate::ids::{FacetId, Id, PartId, VertexId};

/// Faults listed before giving up counting.
pub const LIMIT: usize = 64;

/// What two facets do where a complex is broken.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Breach {
    /// One is on the other side of the other at their edge.
    TurnedOver,
    /// They meet.
    #[serde(untagged)]
    Meeting(embedding::Kind),
}

/// A place where a complex is broken.
#[derive(Clone, PartialEq, Debug)]
pub struct Fault {
    /// The facets.
    pub facets: [FacetId; 2],
    /// What they do there.
    pub what: Breach,
    /// A point of it, to rounding.
    pub point: Vec3,
}

/// What facets enclose: sides that face each other across an edge have one volume.
#[derive(Debug)]
pub struct Volumes {
    /// Volumes in front of and behind every facet.
    pub sides: Vec<[u32; 2]>,
    /// Number of volumes.
    pub count: usize,
    /// Edges of other facets that lie in a facet, from rim to rim, without being listed by it: rounding moved them there. The
    /// facet may have several volumes on one side.
    pub unlisted: Vec<(FacetId, [VertexId; 2])>,
}

/// What the facets enclose; `parts` are those of their sides. O(n log n).
///
/// # Errors
/// Some of the faults, if it is no complex.
pub fn check(complex: &Complex, parts: &[Option<PartId>]) -> Result<Volumes, Vec<Fault>> {
    let met = contacts(complex);
    if met.is_empty() { enclosed(complex, parts) } else { Err(met) }
}

/// Facets that meet where they must not.
fn contacts(complex: &Complex) -> Vec<Fault> {
    let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
    let found = embedding::violations(&points, &complex.triangles(), LIMIT);
    let mut ends = Vec::new();
    if !found.is_empty() {
        ends.extend(complex.facets.iter().scan(0, |end, f| {
            *end += f.triangles.len();
            Some(*end)
        }));
    }
    let facet = |t: u32| FacetId::new(ends.partition_point(|&end| end <= t as usize));
    let fault =
        |v: &embedding::Violation| Fault { facets: v.triangles.map(facet), what: Breach::Meeting(v.kind), point: v.point };
    found.iter().map(fault).collect()
}

/// A triangle at an edge.
#[derive(Clone, Copy)]
struct Use {
    facet: FacetId,
    /// The larger end of the edge.
    upper: VertexId,
    /// The third corner.
    apex: VertexId,
    /// Whether the triangle's rim runs from the smaller to the larger end.
    is_forward: bool,
}

impl Default for Use {
    fn default() -> Self {
        Self { facet: FacetId(0), upper: VertexId(0), apex: VertexId(0), is_forward: false }
    }
}

impl Use {
    /// The sides that look clockwise and counter-clockwise about the edge: twice the facet, plus one for its back.
    fn sides(&self) -> [u32; 2] {
        let front = 2 * self.facet.0;
        if self.is_forward { [front + 1, front] } else { [front, front + 1] }
    }
    /// The parts there.
    fn parts(&self, complex: &Complex, parts: &[Option<PartId>]) -> [Option<PartId>; 2] {
        self.sides().map(|s| parts[complex.facets[FacetId(s / 2)].sides[s as usize % 2].index()])
    }
}

/// Joins the sides of facets around every edge; an error where they are not of one part.
fn enclosed(complex: &Complex, parts: &[Option<PartId>]) -> Result<Volumes, Vec<Fault>> {
    let facets = complex.facets.as_slice().iter().zip(0..);
    let triangles = facets.flat_map(|(data, facet)| data.triangles.iter().map(move |t| (FacetId(facet), *t)));
    let uses = triangles.flat_map(|(facet, [a, b, c])| {
        let side = move |a: VertexId, b: VertexId, apex| (a.min(b).0, Use { facet, upper: a.max(b), apex, is_forward: a < b });
        [side(a, b, c), side(b, c, a), side(c, a, b)]
    });
    let mut at_lower = Lists::from_iter(complex.vertices.len(), uses);
    let (mut faults, mut unlisted) = (Vec::new(), Vec::new());
    let mut sides = UnionFind::new(2 * complex.facets.len());
    for lower in complex.vertices.ids() {
        let around = at_lower.of_mut(lower.0);
        around.sort_by_key(|u| u.upper);
        for same in around.chunk_by_mut(|x, y| x.upper == y.upper) {
            // The order of two is known.
            if same.len() > 2 {
                sort_around(complex, [lower, same[0].upper], same);
                unlisted.extend(diagonals(complex, [lower, same[0].upper], same));
            }
            faults.extend(first_mismatch(complex, parts, lower, same));
            for (k, one) in same.iter().enumerate() {
                sides.join(one.sides()[1], same[(k + 1) % same.len()].sides()[0]);
            }
        }
        if faults.len() >= LIMIT {
            break;
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let (of_side, count) = sides.number();
    Ok(Volumes { sides: of_side.chunks_exact(2).map(|s| [s[0], s[1]]).collect(), count, unlisted })
}

/// Facets that have the edge inside and do not list it.
fn diagonals<'a>(
    complex: &'a Complex,
    edge: [VertexId; 2],
    uses: &'a [Use],
) -> impl Iterator<Item = (FacetId, [VertexId; 2])> + 'a {
    let lists = move |walk: &Vec<VertexId>| walk.len() == 2 && edge.iter().all(|v| walk.contains(v));
    let is_again = |k: usize| uses[..k].iter().any(|u| u.facet == uses[k].facet);
    let inner = (1..uses.len()).filter(move |&k| is_again(k)).map(|k| uses[k].facet);
    inner.filter(move |&f| !complex.facets[f].loops.iter().any(lists)).map(move |f| (f, edge))
}

/// Sorts counter-clockwise about an edge, exactly.
fn sort_around(complex: &Complex, edge: [VertexId; 2], uses: &mut [Use]) {
    let at = |v: VertexId| &complex.vertices[v].point;
    let (axis, reference) = (Axis { from: at(edge[0]), to: at(edge[1]) }, at(uses[0].apex));
    uses.sort_by(|x, y| axis.compare(reference, at(x.apex), at(y.apex)));
}

fn first_mismatch(complex: &Complex, parts: &[Option<PartId>], lower: VertexId, uses: &[Use]) -> Option<Fault> {
    let (n, of) = (uses.len(), |k: usize| uses[k].parts(complex, parts));
    let k = (0..n).find(|&k| of(k)[1] != of((k + 1) % n)[0])?;
    let [a, b] = [lower, uses[k].upper].map(|v| complex.vertices[v].point);
    let facets = [uses[k].facet, uses[(k + 1) % n].facet];
    Some(Fault { facets, what: Breach::TurnedOver, point: (a + b) * 0.5 })
}
