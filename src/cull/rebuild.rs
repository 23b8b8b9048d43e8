//! The solids of the pieces: each closed as before, since a point that one piece has on an edge is one of its neighbour too.
//!
//! Pieces of one facet that are set aside are merged: what nothing is compared with need not be many polygons, and most pieces
//! are set aside. A point at which no outline turns any more is no vertex.

use super::pieces::{Settled, Shape, Shapes};
use super::{Culled, Fate, Piece};
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::geom::polygon::vector_area;
use crate::geom::union_find::UnionFind;
use crate::primitive::solid::{Facets, Freedom, Solid, SolidVertex};

/// A side of an outline, between neighbouring points of a line.
#[derive(Clone, Copy)]
struct Side {
    ends: [u32; 2],
    line: u32,
}

/// A facet of a cut solid: its outer loop and holes.
struct Polygon {
    piece: Piece,
    leaf: u32,
    loops: Vec<Vec<Side>>,
}

/// Makes the solids.
pub(super) fn rebuild(solids: &[Solid], settled: Settled) -> Culled {
    let Settled { shapes, mut pieces } = settled;
    let key = |(shape, fate): &(Shape, Fate)| (shape.leaf, shape.facet, *fate);
    pieces.sort_by_key(key);
    let lines = Lines::new(&shapes, &pieces);
    let mut polygons: Vec<Polygon> = Vec::with_capacity(pieces.len());
    for same in pieces.chunk_by(|a, b| key(a) == key(b)) {
        let (Shape { leaf, facet, .. }, fate) = same[0];
        let mut push = |loops| polygons.push(Polygon { piece: Piece { facet, fate }, leaf, loops });
        if fate.is_aside() {
            merged(same, &shapes, &lines).into_iter().for_each(push);
        } else {
            same.iter().for_each(|(shape, _)| push(vec![lines.outline(shape, &shapes)]));
        }
    }
    let is_vertex = turns(&polygons, shapes.points.len());
    let mut out = Culled { solids: Vec::with_capacity(solids.len()), pieces: Vec::with_capacity(solids.len()) };
    for (old, of_leaf) in solids.iter().zip(polygons.chunk_by(|a, b| a.leaf == b.leaf)) {
        out.solids.push(solid(old, of_leaf, &shapes, &is_vertex));
        out.pieces.push(of_leaf.iter().map(|p| p.piece).collect());
    }
    out
}

/// The points at which an outline changes from one line to another.
fn turns(polygons: &[Polygon], count: usize) -> Vec<bool> {
    let mut is_turn = vec![false; count];
    for walk in polygons.iter().flat_map(|p| &p.loops) {
        for (k, side) in walk.iter().enumerate() {
            is_turn[side.ends[0] as usize] |= side.line != walk[(k + walk.len() - 1) % walk.len()].line;
        }
    }
    is_turn
}

/// A leaf's solid with the polygons for its facets.
fn solid(old: &Solid, polygons: &[Polygon], shapes: &Shapes, is_vertex: &[bool]) -> Solid {
    let mut solid = Solid { vertices: old.vertices.clone(), facets: Facets::default(), surfaces: old.surfaces.clone() };
    let first = polygons.first().map_or(0, |p| shapes.first[p.leaf as usize]);
    let mut number: IndexMap<u32, u32> = (0..old.vertices.len() as u32).map(|v| (first + v, v)).collect();
    let mut own = |v: u32| {
        *number.entry(v).or_insert_with(|| {
            solid.vertices.push(SolidVertex { point: shapes.points[v as usize], freedom: Freedom::Fixed });
            solid.vertices.len() as u32 - 1
        })
    };
    for polygon in polygons {
        let source = old.facets.of(polygon.piece.facet);
        let corners =
            |walk: &Vec<Side>| walk.iter().map(|s| s.ends[0]).filter(|&v| is_vertex[v as usize]).map(&mut own).collect();
        let mut loops: Vec<Vec<u32>> = polygon.loops.iter().map(corners).collect();
        // Facets with holes are not cut.
        loops.extend(source.loops.iter().skip(1).map(<[u32]>::to_vec));
        solid.facets.push(loops, source.surface);
    }
    solid
}

/// The points on all lines that are corners of a piece, in order.
struct Lines {
    /// Points by their places along the line.
    points: Vec<Vec<(f64, u32)>>,
    directions: Vec<Vec3>,
}

impl Lines {
    fn new(shapes: &Shapes, pieces: &[(Shape, Fate)]) -> Self {
        let mut directions = vec![Vec3::zeros(); shapes.on_line.len()];
        let mut is_corner = vec![false; shapes.points.len()];
        for shape in pieces.iter().map(|p| &p.0) {
            for (k, (&a, &line)) in shape.corners.iter().zip(&shape.lines).enumerate() {
                is_corner[a as usize] = true;
                let b = shape.corners[(k + 1) % shape.corners.len()];
                directions[line as usize] = shapes.points[b as usize] - shapes.points[a as usize];
            }
        }
        let sorted = |(line, all): (usize, &Vec<u32>)| {
            let corners = all.iter().filter(|&&v| is_corner[v as usize]);
            let mut points: Vec<(f64, u32)> = corners.map(|&v| (shapes.points[v as usize].dot(&directions[line]), v)).collect();
            points.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            points
        };
        Self { points: shapes.on_line.iter().enumerate().map(sorted).collect(), directions }
    }

    /// The sides of a shape, between all points that its neighbours have on its edges.
    fn outline(&self, shape: &Shape, shapes: &Shapes) -> Vec<Side> {
        let mut out = Vec::with_capacity(shape.corners.len());
        for (k, (&a, &line)) in shape.corners.iter().zip(&shape.lines).enumerate() {
            let b = shape.corners[(k + 1) % shape.corners.len()];
            let at = |v: u32| shapes.points[v as usize].dot(&self.directions[line as usize]);
            let (from, to) = (at(a), at(b));
            let points = &self.points[line as usize];
            let first = points.partition_point(|p| p.0 <= from.min(to));
            let inner = &points[first..first + points[first..].partition_point(|p| p.0 < from.max(to))];
            let mut last = a;
            let mut push = |v: u32| out.push(Side { ends: [std::mem::replace(&mut last, v), v], line });
            if from < to {
                inner.iter().for_each(|p| push(p.1));
            } else {
                inner.iter().rev().for_each(|p| push(p.1));
            }
            push(b);
        }
        out
    }
}

/// The connected unions of some pieces of one facet: for each its outer loop and its holes.
fn merged(pieces: &[(Shape, Fate)], shapes: &Shapes, lines: &Lines) -> Vec<Vec<Vec<Side>>> {
    if let [(shape, _)] = pieces {
        return vec![vec![lines.outline(shape, shapes)]];
    }
    let mut sides: Vec<(Side, u32)> = Vec::new();
    for ((shape, _), k) in pieces.iter().zip(0..) {
        sides.extend(lines.outline(shape, shapes).into_iter().map(|side| (side, k)));
    }
    // Between two pieces runs a side of each.
    let key = |s: &(Side, u32)| [s.0.ends[0].min(s.0.ends[1]), s.0.ends[0].max(s.0.ends[1])];
    sides.sort_unstable_by_key(|s| (key(s), s.1));
    let mut sets = UnionFind::new(pieces.len());
    let mut border: Vec<(Side, u32)> = Vec::new();
    for same in sides.chunk_by(|a, b| key(a) == key(b)) {
        match same {
            &[(_, a), (_, b)] => sets.join(a, b),
            _ => border.extend(same),
        }
    }
    border.iter_mut().for_each(|s| s.1 = sets.find(s.1));
    border.sort_unstable_by_key(|s| (s.1, s.0.ends));
    let normal = shapes.plane(&pieces[0].0).1;
    let union = |border: &[(Side, u32)]| {
        let mut loops = loops(border);
        // What is connected has one outer loop, the only one that is walked counter-clockwise.
        let is_outer = |walk: &Vec<Side>| {
            let corners: Vec<u32> = walk.iter().map(|s| s.ends[0]).collect();
            vector_area([&corners[..]], &shapes.points).dot(&normal) > 0.0
        };
        loops.sort_by_cached_key(|walk| !is_outer(walk));
        loops
    };
    border.chunk_by(|a, b| a.1 == b.1).map(union).collect()
}

/// The closed walks along sides, which are sorted by their first points; none passes a point twice.
fn loops(border: &[(Side, u32)]) -> Vec<Vec<Side>> {
    let mut is_done = vec![false; border.len()];
    let mut loops = Vec::new();
    for start in 0..border.len() {
        let (mut path, mut place_of): (Vec<Side>, IndexMap<u32, usize>) = (Vec::new(), IndexMap::default());
        let mut next = Some(start).filter(|&k| !is_done[k]);
        while let Some(k) = next {
            is_done[k] = true;
            let side = border[k].0;
            place_of.insert(side.ends[0], path.len());
            path.push(side);
            if let Some(&at) = place_of.get(&side.ends[1]) {
                let walk = path.split_off(at);
                for side in &walk {
                    place_of.remove(&side.ends[0]);
                }
                loops.push(walk);
            }
            let first = border.partition_point(|s| s.0.ends[0] < side.ends[1]);
            let leaving = border[first..].iter().zip(first..).take_while(|s| s.0.0.ends[0] == side.ends[1]);
            next = leaving.map(|s| s.1).find(|&k| !is_done[k]);
        }
    }
    loops
}
