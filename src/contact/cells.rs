//! A sheet to its cells: one constrained triangulation over all its edges, whose pieces are the cells.

use super::body::Body;
use super::conforming::Owner;
use super::cuts;
use super::outline::{Outline, passes, sides};
use super::sheets::Sheet;
use crate::geom::Vec3;
use crate::geom::cdt::{Cdt, HalfEdge, Triangulation, Vertex, slot};
use crate::geom::polygon;
use crate::geom::predicates::Projection;
use spade::handles::{FixedFaceHandle, InnerTag};
use spade::{Intersection, LineIntersectionIterator, Triangulation as _};

/// A cell before it is known which other sheets have it too.
#[derive(Clone, Debug, Default)]
pub(super) struct Draft {
    /// The facets that it is a piece of.
    pub owners: Vec<Owner>,
    /// Outer loop first, counter-clockwise, then holes.
    pub loops: Vec<Vec<u32>>,
    /// Edges inside that divide nothing.
    pub chains: Vec<[u32; 2]>,
    /// Points inside without edges.
    pub lone: Vec<u32>,
    pub triangles: Vec<[u32; 3]>,
}

/// Edges of a sheet that cross although nothing was found to touch there, at this point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangled {
    pub point: u32,
}

/// The cell of a facet, or a piece of one, on which nothing lies.
pub(super) fn plain(facet: u32, loops: Vec<Vec<u32>>, body: &Body) -> Result<Draft, Tangled> {
    let triangles = match &loops[..] {
        _ if body.fate(facet).is_aside() => Ok(spanned(&loops)),
        [walk] => polygon::triangulate(&[walk], &[], &[], &body.points),
        _ => polygon::triangulate(&loops.iter().map(Vec::as_slice).collect::<Vec<_>>(), &[], &[], &body.points),
    };
    match triangles {
        Ok(triangles) => Ok(Draft { owners: vec![body.owner(facet, false)], loops, triangles, ..Draft::default() }),
        Err(_) => Err(Tangled { point: loops.first().and_then(|w| w.first()).copied().unwrap_or(0) }),
    }
}

/// Triangles that span the loops of what is set aside, from one corner to all sides. They may overlap: they serve to sum up
/// volumes and to count how often a ray passes, for which any that end in the loops do.
fn spanned(loops: &[Vec<u32>]) -> Vec<[u32; 3]> {
    let Some(&apex) = loops.first().and_then(|w| w.first()) else { return Vec::new() };
    sides(loops).filter(|side| !side.contains(&apex)).map(|[a, b]| [apex, a, b]).collect()
}

/// The same for a facet of one triangle.
pub(super) fn triangle(facet: u32, body: &Body) -> Result<[u32; 3], Tangled> {
    let corners = body.triangle(facet);
    polygon::triangle(corners, &body.points).map_err(|_| Tangled { point: corners[0] })
}

/// The cells of a sheet, counter-clockwise about the normal of its reference facet. O(n log n) in its edges, plus the owners.
pub(super) fn trace(sheet: &Sheet, outlines: &[Outline], body: &Body, tolerance: f64) -> Result<Vec<Draft>, Tangled> {
    if let Some(drafts) = cuts::cut(sheet, outlines, body, tolerance) {
        return Ok(drafts);
    }
    let points = &body.points;
    let reference = &outlines[sheet.reference as usize];
    let borders = borders(sheet, outlines);
    let mut edges: Vec<[u32; 2]> = borders.iter().map(|b| b.ends).chain(sheet.segments.iter().copied()).collect();
    edges.sort_unstable();
    edges.dedup();
    let mut vertices: Vec<u32> = edges.iter().flatten().chain(sheet.lone).copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut cdt = triangulate(&vertices, &edges, reference.projection, points)?;
    add_chords(&mut cdt, sheet.chords, &vertices, |v, [a, b]| {
        passes(&[a, b].map(|k| points[vertices[k] as usize]), &points[vertices[v] as usize], tolerance)
    });
    let pieces = Pieces::new(&cdt.triangulation);
    let labels = label(&cdt.triangulation, &pieces, &borders, &vertices);
    let mut drafts: Vec<Draft> = labels
        .into_iter()
        .map(|owners| Draft {
            owners: owners.into_iter().map(|m| owner(m, reference, outlines, body)).collect(),
            ..Draft::default()
        })
        .collect();
    let cdt = &cdt.triangulation;
    let name = |v: Vertex| vertices[slot(v)];
    for face in cdt.inner_faces() {
        let piece = pieces.of[face.fix().index()] as usize;
        if !drafts[piece].owners.is_empty() {
            drafts[piece].triangles.push(face.vertices().map(name));
        }
    }
    pieces.loops(cdt, &mut drafts, &name);
    pieces.inner(cdt, &mut drafts, &name);
    drafts.retain(|d| !d.owners.is_empty());
    for draft in &mut drafts {
        draft.loops = in_order(std::mem::take(&mut draft.loops), reference.projection, points);
    }
    Ok(drafts)
}

fn owner(member: u32, reference: &Outline, outlines: &[Outline], body: &Body) -> Owner {
    let outline = &outlines[member as usize];
    body.owner(outline.facet, outline.normal.dot(&reference.normal) < 0.0)
}

/// An edge of a member, lower point first.
struct Border {
    ends: [u32; 2],
    member: u32,
    /// Whether the member lies left of it, seen from above the sheet.
    is_left: bool,
}

fn borders(sheet: &Sheet, outlines: &[Outline]) -> Vec<Border> {
    let mut borders = Vec::new();
    for &member in sheet.members {
        let outline = &outlines[member as usize];
        let is_flipped = outline.normal.dot(&outlines[sheet.reference as usize].normal) < 0.0;
        borders.extend(sides(&outline.loops).map(|[a, b]| Border {
            ends: [a.min(b), a.max(b)],
            member,
            is_left: (a < b) != is_flipped,
        }));
    }
    borders.sort_unstable_by_key(|b| (b.ends, b.member));
    borders
}

/// The triangulation, whose vertices are numbered as in `vertices`. A constraint through a vertex would have been cut there.
fn triangulate(vertices: &[u32], edges: &[[u32; 2]], projection: Projection, points: &[Vec3]) -> Result<Cdt, Tangled> {
    let number = |v: u32| vertices.binary_search(&v).unwrap_or(0);
    let constraints: Vec<[usize; 2]> = edges.iter().map(|e| e.map(number)).collect();
    let places = vertices.iter().map(|&v| projection.apply(&points[v as usize]));
    Cdt::new(places, &constraints).map_err(|k| Tangled { point: vertices[k] })
}

/// Adds the chords that cross nothing; the exact arrangement cuts the others. A chord through a vertex is two, and so is one
/// past a vertex that `is_on` it: beside it, a needle would be left that rounding turns over.
fn add_chords(cdt: &mut Cdt, chords: &[[u32; 2]], vertices: &[u32], is_on: impl Fn(usize, [usize; 2]) -> bool) {
    let mut chords = chords.to_vec();
    chords.sort_unstable();
    chords.dedup();
    let slots = chords.iter().rev().map(|c| c.map(|v| vertices.binary_search(&v)));
    let mut rest: Vec<[usize; 2]> = slots.filter_map(|c| if let [Ok(a), Ok(b)] = c { Some([a, b]) } else { None }).collect();
    while let Some(ends) = rest.pop() {
        let [a, b] = ends.map(|k| cdt.handle(k));
        let cdt = &mut cdt.triangulation;
        if cdt.exists_constraint(a, b) {
            continue;
        }
        let met = LineIntersectionIterator::new_from_handles(cdt, a, b).find_map(|met| match met {
            Intersection::VertexIntersection(v) => Some(slot(v)).filter(|v| !ends.contains(v)),
            _ => None,
        });
        let passed = met.or_else(|| {
            let [new] = cdt.try_add_constraint(a, b)[..] else { return None };
            // Of all vertices on its side, the one nearest to lying on the chord makes a triangle with it.
            let chord = cdt.directed_edge(new);
            let inner = [chord, chord.rev()].into_iter().filter(|e| !e.is_outer_edge());
            let passed = inner.map(|e| slot(e.next().to())).find(|&v| is_on(v, ends));
            if passed.is_some() {
                cdt.remove_constraint_edge(new.as_undirected());
            }
            passed
        });
        if let Some(v) = passed {
            rest.extend([[ends[0], v], [v, ends[1]]]);
        }
    }
}

/// Triangles by the cell that they are in; 0 is the outside.
struct Pieces {
    of: Vec<u32>,
    count: usize,
}

impl Pieces {
    fn new(cdt: &Triangulation) -> Self {
        let mut pieces = Self { of: vec![u32::MAX; cdt.num_all_faces()], count: 1 };
        pieces.of[cdt.outer_face().index()] = 0;
        // The outside continues over hull edges that belong to nobody.
        let hull = cdt.convex_hull().map(|e| if e.is_outer_edge() { e.rev() } else { e });
        let open: Vec<_> = hull.filter(|e| !e.is_constraint_edge()).filter_map(|e| e.face().as_inner()).collect();
        for face in open {
            pieces.flood(cdt, face.fix(), 0);
        }
        for face in cdt.inner_faces() {
            if pieces.flood(cdt, face.fix(), pieces.count as u32) {
                pieces.count += 1;
            }
        }
        pieces
    }
    /// Numbers everything that is reached from a face without crossing a constraint; false if it has a number.
    fn flood(&mut self, cdt: &Triangulation, seed: FixedFaceHandle<InnerTag>, number: u32) -> bool {
        if self.of[seed.index()] != u32::MAX {
            return false;
        }
        self.of[seed.index()] = number;
        let mut stack = vec![seed];
        while let Some(face) = stack.pop() {
            for e in cdt.face(face).adjacent_edges().iter().filter(|e| !e.is_constraint_edge()) {
                if let Some(next) = e.rev().face().as_inner()
                    && self.of[next.index()] == u32::MAX
                {
                    self.of[next.index()] = number;
                    stack.push(next.fix());
                }
            }
        }
        true
    }
    fn left(&self, e: &HalfEdge) -> u32 {
        self.of[e.face().index()]
    }
    fn is_border(&self, e: &HalfEdge) -> bool {
        self.left(e) != self.left(&e.rev())
    }

    /// Boundary walks of all pieces, each piece to the left.
    fn loops(&self, cdt: &Triangulation, drafts: &mut [Draft], name: &impl Fn(Vertex) -> u32) {
        let mut is_done = vec![false; cdt.num_directed_edges()];
        for start in cdt.directed_edges() {
            if is_done[start.fix().index()] || !self.is_border(&start) || drafts[self.left(&start) as usize].owners.is_empty() {
                continue;
            }
            let (mut walk, mut e) = (Vec::new(), start);
            while !is_done[e.fix().index()] {
                is_done[e.fix().index()] = true;
                walk.push(name(e.from()));
                e = e.next();
                while !self.is_border(&e) {
                    e = e.rev().next();
                }
            }
            split_at_repeats(walk, &mut drafts[self.left(&start) as usize].loops);
        }
    }

    /// Edges and points inside pieces.
    fn inner(&self, cdt: &Triangulation, drafts: &mut [Draft], name: &impl Fn(Vertex) -> u32) {
        for e in cdt.undirected_edges().filter(|e| e.is_constraint_edge()).map(|e| e.as_directed()) {
            let draft = &mut drafts[self.left(&e) as usize];
            if !self.is_border(&e) && !draft.owners.is_empty() {
                let [a, b] = [name(e.from()), name(e.to())];
                draft.chains.push([a.min(b), a.max(b)]);
            }
        }
        for v in cdt.vertices().filter(|v| v.out_edges().all(|e| !e.is_constraint_edge())) {
            if let Some(e) = v.out_edge() {
                let draft = &mut drafts[self.left(&e) as usize];
                if !draft.owners.is_empty() {
                    draft.lone.push(name(v));
                }
            }
        }
    }
}

/// The members that cover each piece: crossing a border of a member from its right to its left enters it.
fn label(cdt: &Triangulation, pieces: &Pieces, borders: &[Border], vertices: &[u32]) -> Vec<Vec<u32>> {
    let mut doors: Vec<Vec<u32>> = vec![Vec::new(); pieces.count];
    for e in cdt.directed_edges().filter(|e| pieces.is_border(e)) {
        doors[pieces.left(&e) as usize].push(e.fix().index() as u32);
    }
    let mut labels: Vec<Option<Vec<u32>>> = vec![None; pieces.count];
    labels[0] = Some(Vec::new());
    let mut queue = vec![0usize];
    let edges: Vec<HalfEdge> = cdt.directed_edges().collect();
    while let Some(piece) = queue.pop() {
        for &door in &doors[piece] {
            let e = edges[door as usize];
            let next = pieces.left(&e.rev()) as usize;
            if labels[next].is_some() {
                continue;
            }
            let mut label = labels[piece].clone().unwrap_or_default();
            let [a, b] = [e.from(), e.to()].map(|v| vertices[slot(v)]);
            let key = [a.min(b), a.max(b)];
            let first = borders.partition_point(|x| x.ends < key);
            for border in borders[first..].iter().take_while(|x| x.ends == key) {
                // The next piece lies right of a-b.
                let enters = border.is_left != (a < b);
                match label.binary_search(&border.member) {
                    Err(at) if enters => label.insert(at, border.member),
                    Ok(at) if !enters => drop(label.remove(at)),
                    _ => {}
                }
            }
            labels[next] = Some(label);
            queue.push(next);
        }
    }
    labels.into_iter().map(Option::unwrap_or_default).collect()
}

/// Cuts a closed walk into simple loops at the points that it visits again.
fn split_at_repeats(walk: Vec<u32>, loops: &mut Vec<Vec<u32>>) {
    let mut path: Vec<u32> = Vec::with_capacity(walk.len());
    let mut position = std::collections::BTreeMap::new();
    for v in walk {
        if let Some(&at) = position.get(&v) {
            let cut: Vec<u32> = path.drain(at..).collect();
            for u in &cut {
                position.remove(u);
            }
            loops.push(cut);
        }
        position.insert(v, path.len());
        path.push(v);
    }
    loops.push(path);
}

/// Outer loop, which has the largest area, first.
fn in_order(mut loops: Vec<Vec<u32>>, projection: Projection, points: &[Vec3]) -> Vec<Vec<u32>> {
    if loops.len() > 1 {
        let area = |walk: &[u32]| {
            let origin = projection.apply(&points[walk[0] as usize]);
            let at = |v: u32| {
                let p = projection.apply(&points[v as usize]);
                [p[0] - origin[0], p[1] - origin[1]]
            };
            (1..walk.len()).map(|k| (at(walk[k - 1]), at(walk[k]))).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>()
        };
        loops.sort_by(|a, b| area(b).total_cmp(&area(a)));
    }
    loops
}
