//! The faces of the planar graph that is drawn on each triangle.

use super::SubCells;
use super::graph::{Along, Curve, Drawing, Graph, Mesh, StringPiece};
use super::point::Points;
use crate::geom::lists::Lists;
use crate::geom::predicates::{Projection, Sign};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Loops of one piece, outer one first.
type Piece = Vec<Vec<u32>>;

/// Cuts every triangle into its pieces, in triangle order.
pub fn subdivide<'a>(mesh: &Mesh<'a>, graph: &Graph, points: &Points) -> SubCells<'a> {
    let count = mesh.triangles.len();
    let is_touched =
        |t: u32| graph.drawing(t).is_some() || (0..3).any(|k| !graph.edge_points[mesh.edge_of(t, k) as usize].is_empty());
    let touched: Vec<u32> = mesh.near.iter().copied().filter(|&t| is_touched(t)).collect();
    let cut = |&t: &u32| Drawn::new(mesh, graph, points, t).pieces();
    let pieces: Vec<Vec<Piece>> = if touched.len() < 256 {
        touched.iter().map(cut).collect()
    } else {
        touched.par_iter().with_min_len(32).map(cut).collect()
    };
    let mut cells = SubCells::new(mesh.input);
    let mut cut = touched.iter().copied().zip(pieces).peekable();
    for t in 0..count as u32 {
        let owners = mesh.input.cell_of_triangle[t as usize];
        match cut.next_if(|c| c.0 == t) {
            Some((_, pieces)) => {
                for piece in &pieces {
                    cells.push(t, owners, piece.iter().map(|l| &l[..]));
                }
            }
            None => cells.push(t, owners, [&mesh.triangles[t as usize][..]]),
        }
    }
    cells
}

/// The planar graph on one triangle.
struct Drawn<'a> {
    points: &'a Points<'a>,
    projection: Projection,
    /// The triangle's boundary, counter-clockwise.
    boundary: Vec<u32>,
    /// Points, sorted; local numbers index this list.
    nodes: Vec<u32>,
    /// Neighbours of each node in counter-clockwise order.
    around: Lists,
    /// For a point inside a straight string and its neighbour there, the neighbour on the other side: what is known to be
    /// straight need not be computed, which would take big integers every time. Sorted.
    opposite: Vec<([u32; 2], u32)>,
    /// Whether there is anything but the boundary.
    is_plain: bool,
}

impl<'a> Drawn<'a> {
    fn new(mesh: &Mesh, graph: &Graph, points: &'a Points<'a>, t: u32) -> Self {
        let mut boundary = Vec::new();
        for k in 0..3 {
            let start = mesh.triangles[t as usize][k as usize];
            let edge = mesh.edge_of(t, k);
            boundary.push(start);
            let on = graph.edge_points[edge as usize].iter().copied();
            if mesh.edges[edge as usize][0] == start { boundary.extend(on) } else { boundary.extend(on.rev()) }
        }
        let empty = Drawing::default();
        let drawing = graph.drawing(t).unwrap_or(&empty);
        let is_plain = drawing.points.is_empty() && drawing.strings.is_empty();
        let mut drawn = Self {
            points,
            projection: mesh.projection[t as usize],
            boundary,
            nodes: Vec::new(),
            around: Lists::default(),
            opposite: Vec::new(),
            is_plain,
        };
        if !is_plain {
            drawn.draw(mesh, graph, t, drawing);
        }
        drawn
    }

    /// Links the points along the sides and strings.
    fn draw(&mut self, mesh: &Mesh, graph: &Graph, t: u32, drawing: &Drawing) {
        let (mut links, mut opposite) = (Vec::new(), Vec::new());
        let mut add = |chain: &[u32]| {
            links.extend(chain.windows(2).map(|w| [w[0].min(w[1]), w[0].max(w[1])]));
            opposite.extend(chain.windows(3).flat_map(|w| [([w[1], w[0]], w[2]), ([w[1], w[2]], w[0])]));
        };
        let place = |corner: u32| self.boundary.iter().position(|&p| p == corner).unwrap_or(0);
        let [_, second, third] = mesh.triangles[t as usize].map(place);
        let mut chain: Vec<u32> = self.boundary.iter().chain(self.boundary.first()).copied().collect();
        [&chain[..=second], &chain[second..=third], &chain[third..]].into_iter().for_each(&mut add);
        for &string in &drawing.strings {
            chain.clear();
            chain_of(graph, mesh, self.points, string, &mut chain);
            add(&chain);
        }
        opposite.sort_by_key(|o| o.0);
        self.opposite = opposite;
        self.link(links, &drawing.points);
    }

    fn link(&mut self, mut links: Vec<[u32; 2]>, lone: &[u32]) {
        links.sort_unstable();
        links.dedup();
        self.nodes = links.as_flattened().iter().chain(lone).copied().collect();
        self.nodes.sort_unstable();
        self.nodes.dedup();
        links.as_flattened_mut().iter_mut().for_each(|p| *p = self.node(*p));
        let mut around = Lists::from_iter(self.nodes.len(), links.iter().flat_map(|&[i, j]| [(i, j), (j, i)]));
        let mut keyed = Vec::new();
        for node in 0..self.nodes.len() as u32 {
            self.sort_around(node, around.of_mut(node), &mut keyed);
        }
        self.around = around;
    }

    /// Local number of a point that has one.
    fn node(&self, point: u32) -> u32 {
        self.nodes.binary_search(&point).unwrap_or(0) as u32
    }

    /// The neighbour of a point on the other side of one.
    fn opposite_of(&self, key: [u32; 2]) -> Option<u32> {
        let end = self.opposite.partition_point(|o| o.0 <= key);
        self.opposite[..end].last().filter(|o| o.0 == key).map(|o| o.1)
    }

    fn turn(&self, a: u32, b: u32, c: u32) -> Sign {
        let id = |n: u32| self.nodes[n as usize];
        self.points.orient2d(id(a), id(b), id(c), self.projection)
    }

    /// Order by the projected coordinates, first axis first.
    fn compare(&self, a: u32, b: u32) -> Ordering {
        let (a, b) = (self.nodes[a as usize], self.nodes[b as usize]);
        let by = |axis: u8| self.points.compare(a, b, axis as usize);
        by(self.projection.u).then_with(|| by(self.projection.v))
    }

    /// Sorts neighbours counter-clockwise about `node`, beginning with the first in the list. `keyed` is room for them.
    fn sort_around(&self, node: u32, list: &mut [u32], keyed: &mut Vec<(u8, u32)>) {
        if list.len() < 3 {
            return;
        }
        let reference = list[0];
        let name = |n: u32| self.nodes[n as usize];
        let straight = self.opposite_of([name(node), name(reference)]);
        // Half turn in which a neighbour lies, seen from the reference: 0 itself, 1 left, 2 opposite, 3 right.
        let half = |x: u32| match x {
            _ if x == reference => 0,
            _ if straight == Some(name(x)) => 2,
            _ => match self.turn(node, reference, x) {
                1 => 1,
                -1 => 3,
                _ => 2,
            },
        };
        keyed.clear();
        keyed.extend(list.iter().map(|&x| (half(x), x)));
        keyed.sort_by(|a, b| {
            a.0.cmp(&b.0).then_with(|| match self.turn(node, a.1, b.1) {
                1 => Ordering::Less,
                -1 => Ordering::Greater,
                _ => Ordering::Equal,
            })
        });
        list.iter_mut().zip(keyed).for_each(|(slot, k)| *slot = k.1);
    }

    /// The pieces, outer loops first.
    fn pieces(&self) -> Vec<Piece> {
        if self.is_plain {
            return vec![vec![self.boundary.clone()]];
        }
        let loops = self.trace();
        let component = self.components();
        let home = component[self.node(self.boundary[0]) as usize];
        let outer_edges = self.outer_half_edges(&component, home);
        let (mut faces, mut rims): (Vec<Vec<u32>>, Vec<Vec<u32>>) = (Vec::new(), Vec::new());
        for walk in loops {
            let n = walk.len();
            let is_rim =
                (0..n).any(|k| outer_edges[component[walk[0] as usize] as usize] == Some([walk[k], walk[(k + 1) % n]]));
            match (is_rim, component[walk[0] as usize] == home) {
                (false, _) => faces.push(walk),
                (true, false) => rims.push(walk),
                (true, true) => {} // outside of the triangle
            }
        }
        rims.extend((0..self.nodes.len() as u32).filter(|&n| self.around.of(n).is_empty()).map(|n| vec![n]));
        let home_of = |rim: &Vec<u32>| self.face_around(rim[0], component[rim[0] as usize], &faces, &component);
        let homes: Vec<usize> = rims.iter().map(home_of).collect();
        let name = |mut walk: Vec<u32>| {
            walk.iter_mut().for_each(|n| *n = self.nodes[*n as usize]);
            walk
        };
        let mut pieces: Vec<Piece> = faces.into_iter().map(|face| vec![name(face)]).collect();
        rims.into_iter().zip(homes).for_each(|(rim, face)| pieces[face].push(name(rim)));
        pieces
    }

    /// All loops of the graph, each with its face to the left.
    fn trace(&self) -> Vec<Vec<u32>> {
        let count = self.nodes.len() as u32;
        let mut is_used = vec![false; self.around.range(count - 1).end];
        let mut loops = Vec::new();
        for start in 0..count {
            for slot in self.around.range(start) {
                if is_used[slot] {
                    continue;
                }
                let (mut node, mut slot, mut walk) = (start, slot, Vec::new());
                while !std::mem::replace(&mut is_used[slot], true) {
                    walk.push(node);
                    let next = self.around.of(node)[slot - self.around.range(node).start];
                    let ring = self.around.of(next);
                    let back = ring.iter().position(|&x| x == node).unwrap_or(0);
                    // The first edge clockwise from where we came keeps the face to the left.
                    slot = self.around.range(next).start + (back + ring.len() - 1) % ring.len();
                    node = next;
                }
                loops.push(walk);
            }
        }
        loops
    }

    /// Connected component of each node.
    fn components(&self) -> Vec<u32> {
        let mut component = vec![u32::MAX; self.nodes.len()];
        let (mut count, mut stack) = (0, Vec::new());
        for start in 0..self.nodes.len() {
            if component[start] != u32::MAX {
                continue;
            }
            stack.push(start as u32);
            while let Some(n) = stack.pop() {
                if std::mem::replace(&mut component[n as usize], count) == u32::MAX {
                    stack.extend(self.around.of(n).iter().filter(|&&m| component[m as usize] == u32::MAX));
                }
            }
            count += 1;
        }
        component
    }

    /// For each component with edges, a directed edge with the component's outside to its left. That of the triangle's boundary
    /// is known; of others the leftmost node has all neighbours to the right, and the outside begins behind the last one
    /// counter-clockwise.
    fn outer_half_edges(&self, component: &[u32], home: u32) -> Vec<Option<[u32; 2]>> {
        let count = component.iter().max().map_or(0, |m| *m as usize + 1);
        let mut leftmost: Vec<Option<u32>> = vec![None; count];
        for n in (0..self.nodes.len() as u32).filter(|&n| component[n as usize] != home) {
            let best = &mut leftmost[component[n as usize] as usize];
            if best.is_none_or(|m| self.compare(n, m) == Ordering::Less) {
                *best = Some(n);
            }
        }
        leftmost
            .into_iter()
            .enumerate()
            .map(|(c, m)| {
                if c as u32 == home {
                    return Some([self.node(self.boundary[1]), self.node(self.boundary[0])]);
                }
                let m = m?;
                let last = self.around.of(m).iter().copied().reduce(|best, x| if self.turn(m, best, x) > 0 { x } else { best });
                Some([m, last?])
            })
            .collect()
    }

    /// The innermost face of another component around a node.
    fn face_around(&self, node: u32, own: u32, faces: &[Vec<u32>], component: &[u32]) -> usize {
        let around: Vec<usize> = (0..faces.len())
            .filter(|&f| component[faces[f][0] as usize] != own && (faces.len() == 1 || self.is_inside(node, &faces[f])))
            .collect();
        let is_innermost = |f: &usize| {
            around.iter().all(|g| {
                component[faces[*g][0] as usize] == component[faces[*f][0] as usize]
                    || !self.is_inside(faces[*g][0], &faces[*f])
            })
        };
        around.iter().copied().find(is_innermost).or(around.first().copied()).unwrap_or(0)
    }

    /// Whether a node that is not on the loop lies inside it: parity of the edges that a ray along the first axis crosses.
    fn is_inside(&self, node: u32, walk: &[u32]) -> bool {
        let axis = self.projection.v as usize;
        let is_above =
            |n: u32| self.points.compare(self.nodes[n as usize], self.nodes[node as usize], axis) == Ordering::Greater;
        let mut inside = false;
        for (k, &a) in walk.iter().enumerate() {
            let b = walk[(k + 1) % walk.len()];
            let (ua, ub) = (is_above(a), is_above(b));
            if ua != ub {
                let turn = self.turn(a, b, node);
                inside ^= if ub { turn > 0 } else { turn < 0 };
            }
        }
        inside
    }
}

/// Adds the points of a string, from end to end, to `chain`, which is empty.
fn chain_of(graph: &Graph, mesh: &Mesh, points: &Points, string: StringPiece, chain: &mut Vec<u32>) {
    let [first, last] = graph.ends_of(mesh, string.curve);
    chain.push(first);
    chain.extend(graph.points_on(string.curve));
    chain.push(last);
    if let Curve::Segment(_) = string.curve {
        return;
    }
    let order = Along::new([first, last], points);
    let [a, b] = string.ends;
    let [a, b] = if order.compare(a, b, points) == Ordering::Less { [a, b] } else { [b, a] };
    let position = |p: u32| chain.iter().position(|&q| q == p);
    match (position(a), position(b)) {
        (Some(i), Some(j)) if i < j => {
            chain.truncate(j + 1);
            chain.drain(..i);
        }
        _ => *chain = vec![a, b],
    }
}
