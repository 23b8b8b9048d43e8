//! Where two triangles with explicit vertices meet, exactly decided.
//!
//! Every contact of an edge of one with the other is found with its place on both; the caller interns the points and makes
//! segments of them. All signs are of explicit points.

use crate::geom::Vec3;
use crate::geom::predicates::{Projection, Sign, clear_side, orient2d, orient3d, sign};

/// Where a point lies on a triangle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Spot {
    /// At corner k.
    Corner(u8),
    /// Inside edge k, from corner k to corner k + 1.
    Edge(u8),
    /// Inside.
    Face,
}

impl Spot {
    /// Whether it lies on edge `k`, ends included.
    pub fn is_on_edge(self, k: u8) -> bool {
        match self {
            Spot::Corner(c) => c == k || c == (k + 1) % 3,
            Spot::Edge(e) => e == k,
            Spot::Face => false,
        }
    }
}

/// Which point it is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Meeting {
    /// A corner of one triangle.
    Vertex(u32),
    /// Edge k of the first with the plane of the second.
    EdgeOfFirst(u8),
    /// Edge k of the second with the plane of the first.
    EdgeOfSecond(u8),
    /// Edge k of the first with edge l of the second, in a common plane.
    EdgeEdge(u8, u8),
}

/// One common point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Hit {
    /// Which point.
    pub meeting: Meeting,
    /// Its places on the first and the second triangle.
    pub spots: [Spot; 2],
}

/// A triangle with its corners' numbers and a projection in which it turns counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub struct Corners<'a> {
    /// Vertex numbers.
    pub ids: [u32; 3],
    /// Positions.
    pub at: [&'a Vec3; 3],
    /// Projection with positive orientation.
    pub projection: Projection,
}

impl Corners<'_> {
    fn index_of(&self, id: u32) -> Option<u8> {
        self.ids.iter().position(|&v| v == id).map(|k| k as u8)
    }

    /// Where a point of the triangle's plane lies; `None` outside.
    fn locate(&self, p: &Vec3) -> Option<Spot> {
        let q = self.projection.apply(p);
        let corner = |k: usize| self.projection.apply(self.at[k]);
        spot_from_signs([0, 1, 2].map(|k| orient2d(corner(k), corner((k + 1) % 3), q)))
    }
}

/// The place that signs relative to the three edges (positive inside) tell.
fn spot_from_signs(s: [Sign; 3]) -> Option<Spot> {
    if s.contains(&-1) {
        return None;
    }
    let zero = |k: usize| s[k] == 0;
    match (zero(0), zero(1), zero(2)) {
        (false, false, false) => Some(Spot::Face),
        (true, false, false) => Some(Spot::Edge(0)),
        (false, true, false) => Some(Spot::Edge(1)),
        (false, false, true) => Some(Spot::Edge(2)),
        (true, _, true) => Some(Spot::Corner(0)),
        (true, true, false) => Some(Spot::Corner(1)),
        (false, true, true) => Some(Spot::Corner(2)),
    }
}

/// Sides of the corners of `of` about the plane of `plane`; common corners are 0 without computation. `None` if nothing but
/// common corners and edges reaches the plane.
fn sides(of: &Corners, plane: &Corners, is_common: [bool; 3]) -> Option<[Sign; 3]> {
    let [a, b, c] = plane.at;
    // The axis along which the projection looks, and whether it looks against the normal.
    let (u, v) = (plane.projection.u as usize, plane.projection.v as usize);
    let axis = 3 - u - v;
    let is_parallel = a[axis] == b[axis] && b[axis] == c[axis];
    let side = |k: usize| {
        if is_common[k] {
            return 0;
        }
        if !is_parallel {
            return orient3d(a, b, c, of.at[k]);
        }
        // Planes parallel to the coordinate planes are frequent and full of contact: a comparison decides, exactly.
        let above = sign(of.at[k][axis] - a[axis]);
        if (u + 1) % 3 == v { above } else { -above }
    };
    let s = [0, 1, 2].map(side);
    let is_apart = |turn: Sign| is_common != [true; 3] && (0..3).all(|k| s[k] == turn || is_common[k]);
    if is_apart(1) || is_apart(-1) { None } else { Some(s) }
}

/// Common points of two triangles that are not the same; corners shared by number are among them only where they matter (as
/// ends of a common segment).
#[derive(Clone, Debug, Default)]
pub struct Contact {
    /// The points.
    pub hits: Vec<Hit>,
    /// Whether the triangles lie in one plane.
    pub is_coplanar: bool,
}

/// Intersects two triangles; `None` if they share nothing but, perhaps, one vertex or one edge by number.
pub fn intersect(t: &Corners, u: &Corners) -> Option<Contact> {
    let common_of_t = t.ids.map(|id| u.ids.contains(&id));
    let common_of_u = u.ids.map(|id| t.ids.contains(&id));
    if is_clearly_beside(u, t, common_of_u) || is_clearly_beside(t, u, common_of_t) {
        return None;
    }
    if is_beyond_an_edge(t, u, common_of_t, common_of_u) || is_beyond_an_edge(u, t, common_of_u, common_of_t) {
        return None;
    }
    let su = sides(u, t, common_of_u)?;
    let st = sides(t, u, common_of_t)?;
    let mut hits = Vec::new();
    let is_coplanar = su == [0; 3] && st == [0; 3];
    if is_coplanar {
        coplanar_hits(t, u, &mut hits);
    } else {
        edge_hits(u, &su, t, false, &mut hits);
        edge_hits(t, &st, u, true, &mut hits);
    }
    let shared = common_of_u.iter().filter(|&&is_common| is_common).count();
    (hits.len() > shared || (is_coplanar && shared == 3)).then_some(Contact { hits, is_coplanar })
}

/// Whether all corners of `of` but common ones lie on one side of the plane of `plane`, so far that rounding leaves no doubt:
/// the cheapest reason to have nothing else in common.
fn is_clearly_beside(of: &Corners, plane: &Corners, is_common: [bool; 3]) -> bool {
    let [a, b, c] = plane.at;
    let mut sides = (0..3).filter(|&k| !is_common[k]).map(|k| clear_side(a, b, c, of.at[k]));
    sides.next().is_some_and(|first| first != 0 && sides.all(|side| side == first))
}

/// Whether, seen in the projection of `t`, one edge of it has all corners of `u` beyond, other than those of the edge: they
/// then share nothing else. Many candidates are neighbours over what contact has made common, and this settles them without the
/// signs of volumes, which for points of a common wall all need long numbers.
fn is_beyond_an_edge(t: &Corners, u: &Corners, common_of_t: [bool; 3], common_of_u: [bool; 3]) -> bool {
    let flat = |p: &Vec3| t.projection.apply(p);
    let [of_t, of_u] = [t.at.map(flat), u.at.map(flat)];
    let is_beyond = |k: usize| (0..3).all(|j| common_of_u[j] || orient2d(of_t[k], of_t[(k + 1) % 3], of_u[j]) < 0);
    // A common corner that is not one of the edge lies within.
    (0..3).any(|k| !common_of_t[(k + 2) % 3] && is_beyond(k))
}

/// Adds where the corners and edges of `of` meet `face`; `of_is_first` tells which one is the first triangle of the pair.
fn edge_hits(of: &Corners, s: &[Sign; 3], face: &Corners, of_is_first: bool, hits: &mut Vec<Hit>) {
    let pair = |on_of: Spot, on_face: Spot| if of_is_first { [on_of, on_face] } else { [on_face, on_of] };
    for k in 0..3u8 {
        let (i, j) = (k as usize, (k as usize + 1) % 3);
        if s[i] == 0 {
            let id = of.ids[i];
            let spot = match face.index_of(id) {
                Some(c) => Some(Spot::Corner(c)),
                None => face.locate(of.at[i]),
            };
            if let Some(spot) = spot {
                add(hits, Hit { meeting: Meeting::Vertex(id), spots: pair(Spot::Corner(k), spot) });
            }
        }
        if s[i] * s[j] >= 0 {
            continue;
        }
        let (p, q) = (of.at[i], of.at[j]);
        let turn = |a: usize, b: usize| {
            if face.ids[a] == of.ids[i] || face.ids[a] == of.ids[j] || face.ids[b] == of.ids[i] || face.ids[b] == of.ids[j] {
                0
            } else {
                // Positive inside when the edge runs along the face's normal, so turned by the direction in which it crosses.
                orient3d(p, q, face.at[a], face.at[b]) * s[j]
            }
        };
        let Some(spot) = spot_from_signs([turn(0, 1), turn(1, 2), turn(2, 0)]) else { continue };
        let meeting = match spot {
            Spot::Corner(c) => Meeting::Vertex(face.ids[c as usize]),
            _ if of_is_first => Meeting::EdgeOfFirst(k),
            _ => Meeting::EdgeOfSecond(k),
        };
        add(hits, Hit { meeting, spots: pair(Spot::Edge(k), spot) });
    }
}

/// Adds a hit unless the same point is there already (a vertex is found from both triangles).
fn add(hits: &mut Vec<Hit>, hit: Hit) {
    let same = |h: &Hit| match (h.meeting, hit.meeting) {
        (Meeting::Vertex(a), Meeting::Vertex(b)) => a == b,
        _ => false,
    };
    if !hits.iter().any(same) {
        hits.push(hit);
    }
}

/// Corners of each in the other, and proper crossings of edges, in the common plane.
fn coplanar_hits(t: &Corners, u: &Corners, hits: &mut Vec<Hit>) {
    let flat = |p: &Vec3| t.projection.apply(p);
    for (of, face, of_is_first) in [(u, t, false), (t, u, true)] {
        for k in 0..3u8 {
            let id = of.ids[k as usize];
            let spot = match face.index_of(id) {
                Some(c) => Some(Spot::Corner(c)),
                None => face.locate(of.at[k as usize]),
            };
            if let Some(spot) = spot {
                let own = Spot::Corner(k);
                add(hits, Hit { meeting: Meeting::Vertex(id), spots: if of_is_first { [own, spot] } else { [spot, own] } });
            }
        }
    }
    for k in 0..3u8 {
        for l in 0..3u8 {
            let (k1, l1) = ((k as usize + 1) % 3, (l as usize + 1) % 3);
            let (a, b) = (t.ids[k as usize], t.ids[k1]);
            let (c, d) = (u.ids[l as usize], u.ids[l1]);
            if a == c || a == d || b == c || b == d {
                continue;
            }
            let [pa, pb, pc, pd] = [t.at[k as usize], t.at[k1], u.at[l as usize], u.at[l1]].map(flat);
            let crosses = orient2d(pa, pb, pc) * orient2d(pa, pb, pd) < 0 && orient2d(pc, pd, pa) * orient2d(pc, pd, pb) < 0;
            if crosses {
                hits.push(Hit { meeting: Meeting::EdgeEdge(k, l), spots: [Spot::Edge(k), Spot::Edge(l)] });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::embedding::projection_of;

    fn hits(t: [[f64; 3]; 3], u: [[f64; 3]; 3], ids: [u32; 3]) -> Option<Contact> {
        let (t, u) = (t.map(Vec3::from), u.map(Vec3::from));
        let corners = |p: &'static [Vec3; 3], ids| {
            let projection = projection_of(*p).unwrap();
            Corners { ids, at: [&p[0], &p[1], &p[2]], projection }
        };
        let (t, u) = (Box::leak(Box::new(t)), Box::leak(Box::new(u)));
        intersect(&corners(t, [0, 1, 2]), &corners(u, ids))
    }

    #[test]
    fn crossing_triangles_meet_in_two_points() {
        let c =
            hits([[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]], [[1., 1., -1.], [1., 1., 1.], [9., 9., 0.]], [3, 4, 5]).unwrap();
        assert_eq!(c.hits.len(), 2);
        assert!(c.hits.iter().any(|h| h.meeting == Meeting::EdgeOfSecond(0) && h.spots == [Spot::Face, Spot::Edge(0)]));
        // The other end is where the hypotenuse meets the second triangle's plane.
        assert!(c.hits.iter().any(|h| h.meeting == Meeting::EdgeOfFirst(1)));
    }

    #[test]
    fn a_corner_on_a_face_is_one_hit() {
        let c =
            hits([[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]], [[1., 1., 0.], [1., 2., 3.], [2., 1., 3.]], [3, 4, 5]).unwrap();
        assert_eq!(c.hits, vec![Hit { meeting: Meeting::Vertex(3), spots: [Spot::Face, Spot::Corner(0)] }]);
    }

    #[test]
    fn neighbours_that_share_an_edge_do_not_count() {
        assert!(
            hits([[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]], [[4., 0., 0.], [0., 0., 0.], [0., 0., 4.]], [1, 0, 3]).is_none()
        );
        assert!(
            hits([[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]], [[4., 0., 0.], [0., 0., 0.], [0., -4., 0.]], [1, 0, 3]).is_none()
        );
    }

    #[test]
    fn coplanar_star_has_six_crossings() {
        let c =
            hits([[0., 0., 0.], [6., 0., 0.], [3., 5., 0.]], [[0., 3., 0.], [3., -2., 0.], [6., 3., 0.]], [3, 4, 5]).unwrap();
        assert!(c.is_coplanar);
        assert_eq!(c.hits.len(), 6);
    }
}
