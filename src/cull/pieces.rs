//! Convex facets that are cut by planes.

use super::Fate;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::hash::IndexMap;
use crate::geom::polygon::vector_area;
use crate::geom::predicates::{Projection, orient2d};
use crate::primitive::solid::Solid;

/// A facet or a piece of one.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub leaf: u32,
    pub facet: u32,
    /// Outer loop, as points.
    pub corners: Vec<u32>,
    /// For each corner the line of the edge that begins there.
    pub lines: Vec<u32>,
    pub area: f64,
}

/// What a plane makes of a shape.
pub(super) enum Halves {
    Below(Shape),
    Above(Shape),
    Both { whole: Shape, parts: [Shape; 2] },
}

/// All points and lines of shapes.
pub(super) struct Shapes {
    /// Vertices of all leaves, then those made by cuts.
    pub points: Vec<Vec3>,
    /// First point of every leaf.
    pub first: Vec<u32>,
    /// First facet of every leaf.
    first_facet: Vec<u32>,
    /// Unit normal of every facet.
    normals: Vec<Vec3>,
    /// First corner of every facet.
    origins: Vec<u32>,
    /// Points that cuts made on each line: an edge of a leaf, or where a plane cuts a facet.
    pub on_line: Vec<Vec<u32>>,
    /// Points by line, axis and place of the plane.
    made: IndexMap<(u32, usize, u64), u32>,
}

/// All pieces with their fates.
pub(super) struct Settled {
    pub shapes: Shapes,
    pub pieces: Vec<(Shape, Fate)>,
}

impl Shapes {
    /// Everything uncut: the convex facets, and the others.
    pub fn new(solids: &[Solid]) -> (Self, Vec<Shape>, Vec<Shape>) {
        let mut all = Self {
            points: solids.iter().flat_map(|s| &s.vertices).map(|v| v.point).collect(),
            first: vec![0],
            first_facet: vec![0],
            normals: Vec::new(),
            origins: Vec::new(),
            on_line: Vec::new(),
            made: IndexMap::default(),
        };
        let (mut convex, mut others) = (Vec::new(), Vec::new());
        for (leaf, solid) in solids.iter().enumerate() {
            let start = all.first[leaf];
            let mut line_of: IndexMap<[u32; 2], u32> = IndexMap::default();
            for (number, facet) in solid.facets.iter().enumerate() {
                let loops: Vec<Vec<u32>> = facet.loops.iter().map(|w| w.iter().map(|v| start + v).collect()).collect();
                let vector = vector_area(loops.iter().map(Vec::as_slice), &all.points);
                let is_convex = loops.len() == 1 && all.is_convex(&loops[0], &vector);
                let corners = loops.into_iter().next().unwrap_or_default();
                all.normals.push(vector.try_normalize(0.0).unwrap_or_default());
                all.origins.push(corners.first().copied().unwrap_or(start));
                let mut line = |a: u32, b: u32| {
                    *line_of.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                        all.on_line.push(Vec::new());
                        all.on_line.len() as u32 - 1
                    })
                };
                let lines = (0..corners.len()).map(|k| line(corners[k], corners[(k + 1) % corners.len()])).collect();
                let shape = Shape { leaf: leaf as u32, facet: number as u32, corners, lines, area: vector.norm() };
                if is_convex { convex.push(shape) } else { others.push(shape) }
            }
            all.first.push(start + solid.vertices.len() as u32);
            all.first_facet.push(all.normals.len() as u32);
        }
        (all, convex, others)
    }

    fn is_convex(&self, walk: &[u32], vector: &Vec3) -> bool {
        let projection = Projection::along(vector);
        let (n, flat) = (walk.len(), |k: usize| projection.apply(&self.points[walk[k % walk.len()] as usize]));
        (0..n).all(|k| orient2d(flat(k), flat(k + 1), flat(k + 2)) >= 0)
    }

    /// Box of a shape.
    pub fn bounds(&self, shape: &Shape) -> Aabb {
        Aabb::around(shape.corners.iter().map(|&v| &self.points[v as usize]))
    }

    /// A point of the facet's plane and its unit normal.
    pub fn plane(&self, shape: &Shape) -> (Vec3, Vec3) {
        let facet = (self.first_facet[shape.leaf as usize] + shape.facet) as usize;
        (self.points[self.origins[facet] as usize], self.normals[facet])
    }

    /// A convex shape below or above a plane across an axis, on which no corner lies, or its parts there.
    pub fn cut(&mut self, shape: Shape, axis: usize, at: f64) -> Halves {
        let is_above = |v: u32| self.points[v as usize][axis] > at;
        let sides: Vec<bool> = shape.corners.iter().map(|&v| is_above(v)).collect();
        if sides.iter().all(|&s| s == sides[0]) {
            return if sides[0] { Halves::Above(shape) } else { Halves::Below(shape) };
        }
        let mut parts = [(Vec::new(), Vec::new()), (Vec::new(), Vec::new())];
        let across = self.on_line.len() as u32;
        self.on_line.push(Vec::new());
        let n = shape.corners.len();
        for k in 0..n {
            let (own, next) = (usize::from(sides[k]), usize::from(sides[(k + 1) % n]));
            parts[own].0.push(shape.corners[k]);
            parts[own].1.push(shape.lines[k]);
            if own != next {
                let ends = [shape.corners[k], shape.corners[(k + 1) % n]];
                let point = self.point_on(shape.lines[k], ends, axis, at);
                parts[own].0.push(point);
                parts[own].1.push(across);
                parts[next].0.push(point);
                parts[next].1.push(shape.lines[k]);
            }
        }
        let parts = parts.map(|(corners, lines)| {
            let area = vector_area([&corners[..]], &self.points).norm();
            Shape { leaf: shape.leaf, facet: shape.facet, corners, lines, area }
        });
        Halves::Both { whole: shape, parts }
    }

    /// Where a plane cuts an edge on a line; all facets at it get the same point.
    fn point_on(&mut self, line: u32, [a, b]: [u32; 2], axis: usize, at: f64) -> u32 {
        if let Some(&known) = self.made.get(&(line, axis, at.to_bits())) {
            return known;
        }
        let [p, q] = [a.min(b), a.max(b)].map(|v| self.points[v as usize]);
        let mut place = p + (q - p) * ((at - p[axis]) / (q[axis] - p[axis]));
        place[axis] = at;
        let point = self.points.len() as u32;
        self.points.push(place);
        self.on_line[line as usize].push(point);
        self.made.insert((line, axis, at.to_bits()), point);
        point
    }

    /// The result.
    pub fn settled(self, pieces: Vec<(Shape, Fate)>) -> Settled {
        Settled { shapes: self, pieces }
    }
}
