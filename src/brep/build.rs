//! From the plain complex to the model and back.
//!
//! `Brep::from_complex` links fins by loops, groups them by edge (counting sort on the smaller vertex), orders the rings with
//! more than two fins by exact signs of the triangles kept beside the facets, and collects shells across mates. That the sides
//! a facet claims agree along every shell is checked here: it proves radial order and labels against each other. Ids of
//! vertices, facets and regions are those of the complex. `Brep::to_complex` numbers what lives anew, in id order; for an
//! unchanged model it gives back the complex. Cost: linear, up to sorting around vertices.

use super::complex::{Complex, ComplexFacet};
use super::model::{Brep, FacetData};
use super::store::{Arena, Region as RegionLinks};
use super::store::{EdgeId, FaceUseId, Fin, FinId, HalfEdgeId, Loop, LoopId, Nil, ShellId, Side, Topology};
use crate::diag::{Diagnostic, Outcome};
use crate::geom::Vec3;
use crate::geom::radial::Axis;
use crate::ids::{FacetId, Id, IdVec, RegionId, VertexId};
use std::cmp::Ordering;
use std::collections::HashSet;

impl Brep {
    /// Builds the model.
    ///
    /// # Errors
    /// Internal ones (`brep-input`, `brep-radial`, `brep-sides`, `brep-region`), if the complex breaks its invariants: ids out
    /// of range, empty loops, facets that coincide around an edge, sides that do not agree along a shell.
    pub fn from_complex(complex: Complex) -> Outcome<Brep> {
        let findings = check_input(&complex);
        if !findings.is_empty() {
            return Err(findings);
        }
        let mut topology = Topology::default();
        add_loops(&mut topology, &complex);
        add_edges(&mut topology);
        order_rings(&mut topology, &complex)?;
        add_shells(&mut topology, &complex)?;
        let Complex { vertices, mut facets, regions, surfaces, markers, killed } = complex;
        let facets = facets.iter_mut().map(facet_data).collect();
        let mut brep = Brep { topology, vertices, facets, regions, surfaces, markers, killed };
        brep.find_outer_shells()?;
        Ok(brep)
    }

    /// The model as plain data; regions, surfaces and markers keep their numbers.
    pub fn to_complex(&self) -> Complex {
        let topology = &self.topology;
        let mut number = vec![VertexId::NONE; topology.vertices.bound()];
        let mut vertices = IdVec::new();
        for vertex in topology.vertices() {
            number[vertex.index()] = vertices.push(self.vertices[vertex]);
        }
        let renumber = |v: VertexId| number[v.index()];
        let facets = topology
            .facets()
            .map(|facet| {
                let data = &self.facets[facet];
                ComplexFacet {
                    loops: topology.loops(facet).flat_map(|w| segments(topology.corners(w).map(renumber).collect())).collect(),
                    triangles: self.triangles(facet).map(|t| t.map(renumber)).collect(),
                    sides: topology.sides(facet),
                    surface: data.surface,
                    source: data.source,
                    marker: data.marker,
                    is_modified: data.is_modified,
                }
            })
            .collect();
        Complex {
            vertices,
            facets,
            regions: self.regions.clone(),
            surfaces: self.surfaces.clone(),
            markers: self.markers.clone(),
            killed: self.killed.clone(),
        }
    }

    /// Six times the volume that a shell encloses, as its region lies inside it; negative for an inner shell.
    pub fn shell_volume6(&self, shell: ShellId) -> f64 {
        let origin = self.vertices.iter().next().map_or_else(Vec3::zeros, |v| v.point);
        let mut sum = 0.0;
        for face_use in self.topology.face_uses(shell) {
            // The normal points into the region in front, that is, inwards for a front use.
            let sense = if face_use.side() == Side::Front { -1.0 } else { 1.0 };
            for triangle in self.triangles(face_use.facet()) {
                let [a, b, c] = triangle.map(|v| self.point(v) - origin);
                sum += sense * a.dot(&b.cross(&c));
            }
        }
        sum
    }

    /// Each bounded region has one shell around it: the one of greatest volume.
    fn find_outer_shells(&mut self) -> Outcome<()> {
        let mut findings = Vec::new();
        for region in self.regions.ids().skip(1) {
            let shells: Vec<ShellId> = self.topology.shells_of(region).collect();
            let volumes: Vec<f64> = match shells.len() {
                1 => vec![1.0],
                _ => shells.iter().map(|&shell| self.shell_volume6(shell)).collect(),
            };
            let largest = (0..shells.len()).max_by(|&a, &b| volumes[a].total_cmp(&volumes[b]).then(b.cmp(&a)));
            match largest {
                Some(k) if volumes[k] > 0.0 => self.topology.shells[shells[k]].is_outer = true,
                _ => findings.push(Diagnostic::internal("brep-region", format!("region {} has no shell around it", region.0))),
            }
        }
        if findings.is_empty() { Ok(()) } else { Err(findings) }
    }
}

fn facet_data(facet: &mut ComplexFacet) -> FacetData {
    let &mut ComplexFacet { ref loops, ref mut triangles, surface, source, marker, is_modified, .. } = facet;
    let is_triangle = loops.len() == 1 && loops[0].len() == 3 && triangles.len() == 1;
    let tiles = if is_triangle { Vec::new() } else { std::mem::take(triangles) };
    FacetData { surface, source, marker, is_modified, tiles }
}

/// A loop; one that only goes out and back again, as loops about loose segments do that have been split, as its segments.
fn segments(walk: Vec<VertexId>) -> Vec<Vec<VertexId>> {
    let at = |k: usize| walk[k % walk.len()];
    let turns_back = walk.len() > 2 && (0..walk.len()).any(|k| at(k) == at(k + 2));
    if turns_back {
        let edges: HashSet<[VertexId; 2]> = (0..walk.len()).map(|k| [at(k), at(k + 1)]).collect();
        if edges.iter().all(|&[a, b]| edges.contains(&[b, a])) {
            let once = (0..walk.len()).map(|k| [at(k), at(k + 1)]).filter(|[a, b]| a < b);
            return once.map(|e| e.to_vec()).collect();
        }
    }
    vec![walk]
}

/// All ids in range, no empty loop, no edge from a vertex to itself.
fn check_input(complex: &Complex) -> Vec<Diagnostic> {
    let n = complex.vertices.len();
    let mut findings = Vec::new();
    for (id, facet) in complex.facets.enumerate() {
        let in_range = |w: &[VertexId]| w.iter().all(|v| v.index() < n);
        let stays = |w: &[VertexId]| w.len() > 1 && (0..w.len()).any(|k| w[k] == w[(k + 1) % w.len()]);
        let problem = if facet.loops.is_empty() || facet.loops.iter().any(Vec::is_empty) {
            "has an empty loop"
        } else if !facet.loops.iter().all(|w| in_range(w)) || !facet.triangles.iter().all(|t| in_range(t)) {
            "lists a vertex that does not exist"
        } else if facet.loops.iter().any(|w| stays(w)) {
            "lists a vertex twice in a row"
        } else if facet.sides.iter().any(|r| r.index() >= complex.regions.len()) {
            "lies at a region that does not exist"
        } else {
            continue;
        };
        findings.push(Diagnostic::internal("brep-input", format!("facet {} {problem}", id.0)));
    }
    findings
}

/// Vertices, facets, loops, fins; no edges yet.
fn add_loops(topology: &mut Topology, complex: &Complex) {
    let fins: usize = complex.facets.iter().flat_map(|f| &f.loops).map(Vec::len).sum();
    let loops: usize = complex.facets.iter().map(|f| f.loops.len()).sum();
    topology.vertices = Arena::with_capacity(complex.vertices.len());
    topology.facets = Arena::with_capacity(complex.facets.len());
    topology.loops = Arena::with_capacity(loops);
    topology.fins = Arena::with_capacity(fins);
    for _ in complex.vertices.iter() {
        topology.new_vertex();
    }
    for data in &complex.facets {
        let facet = topology.new_facet();
        let mut last = LoopId::NONE;
        for walk in &data.loops {
            let id = topology.loops.insert(Loop { facet, fin: FinId::NONE, next: LoopId::NONE });
            if last.is_some() {
                topology.loops[last].next = id;
            } else {
                topology.facets[facet].outer = id;
            }
            last = id;
            add_fins(topology, walk, id);
        }
    }
}

fn add_fins(topology: &mut Topology, walk: &[VertexId], owner: LoopId) {
    if let &[vertex] = walk {
        topology.make_lone(vertex, owner);
        return;
    }
    let first = topology.fins.bound() as u32;
    let n = walk.len() as u32;
    for (k, &vertex) in walk.iter().enumerate() {
        let k = k as u32;
        let (next, prev) = (FinId(first + (k + 1) % n), FinId(first + (k + n - 1) % n));
        let (edge, none) = (EdgeId::NONE, FinId::NONE);
        topology.fins.insert(Fin { vertex, edge, owner, next, prev, around_next: none, around_prev: none });
    }
    topology.loops[owner].fin = FinId(first);
}

/// Groups fins by their pair of vertices. Edges come in order of (smaller, larger) vertex and run from the smaller one.
fn add_edges(topology: &mut Topology) {
    let ends = |topology: &Topology, fin: FinId| {
        let [a, b] = topology.fin_ends(fin);
        if a < b { [a, b] } else { [b, a] }
    };
    let count = topology.fins.bound();
    let mut start = vec![0u32; topology.vertices.bound() + 1];
    let is_lone = |topology: &Topology, fin: FinId| topology.fins[fin].next == fin;
    let with_edge =
        |topology: &Topology| (0..count as u32).map(FinId).filter(|&fin| !is_lone(topology, fin)).collect::<Vec<_>>();
    let fins = with_edge(topology);
    for &fin in &fins {
        start[ends(topology, fin)[0].index() + 1] += 1;
    }
    for k in 1..start.len() {
        start[k] += start[k - 1];
    }
    // Bucket of the smaller vertex: (larger vertex, fin).
    let mut slots = vec![(VertexId::NONE, FinId::NONE); fins.len()];
    let mut fill = start.clone();
    for &fin in &fins {
        let [a, b] = ends(topology, fin);
        slots[fill[a.index()] as usize] = (b, fin);
        fill[a.index()] += 1;
    }
    topology.edges = Arena::with_capacity(fins.len() / 2);
    let mut ring = Vec::new();
    for a in 0..topology.vertices.bound() {
        let bucket = &mut slots[start[a] as usize..start[a + 1] as usize];
        bucket.sort_unstable();
        for group in bucket.chunk_by(|x, y| x.0 == y.0) {
            let edge = topology.new_edge(VertexId::new(a), group[0].0);
            ring.clear();
            ring.extend(group.iter().map(|&(_, fin)| fin));
            topology.set_ring(edge, &ring);
        }
    }
}

/// Puts the rings of edges with more than two fins into radial order.
fn order_rings(topology: &mut Topology, complex: &Complex) -> Outcome<()> {
    let mut apexes = Apexes { topology, complex, facet: FacetId::NONE, directed: Vec::new() };
    // By facet, so that a polygon's triangles are sorted once however many of its edges need them.
    let crowded = |topology: &Topology, fin: &FinId| {
        let Fin { edge, around_next, around_prev, .. } = topology.fins[*fin];
        edge.is_some() && around_next != around_prev
    };
    let fins: Vec<FinId> = apexes.topology.fins().filter(|fin| crowded(apexes.topology, fin)).collect();
    let mut wanted: Vec<(EdgeId, FinId, VertexId)> = Vec::with_capacity(fins.len());
    let mut findings = Vec::new();
    for fin in fins {
        match apexes.of(fin) {
            Some(apex) => wanted.push((topology_edge(apexes.topology, fin), fin, apex)),
            None => findings.push(radial_problem(complex, apexes.topology, fin, "has no triangle at its edge")),
        }
    }
    if !findings.is_empty() {
        return Err(findings);
    }
    wanted.sort_unstable();
    for group in wanted.chunk_by_mut(|x, y| x.0 == y.0) {
        let edge = group[0].0;
        let [from, to] = topology.ends(edge).map(|v| &complex.vertices[v].point);
        let axis = Axis { from, to };
        let place = |v: VertexId| &complex.vertices[v].point;
        let reference = place(group[0].2);
        group.sort_by(|x, y| axis.compare(reference, place(x.2), place(y.2)).then(x.1.cmp(&y.1)));
        for pair in group.windows(2) {
            if axis.compare(reference, place(pair[0].2), place(pair[1].2)) == Ordering::Equal {
                findings.push(radial_problem(complex, topology, pair[1].1, "coincides with another at its edge"));
            }
        }
        let ring: Vec<FinId> = group.iter().map(|&(_, fin, _)| fin).collect();
        topology.set_ring(edge, &ring);
    }
    if findings.is_empty() { Ok(()) } else { Err(findings) }
}

fn topology_edge(topology: &Topology, fin: FinId) -> EdgeId {
    topology.fins[fin].edge
}

fn radial_problem(complex: &Complex, topology: &Topology, fin: FinId, what: &str) -> Diagnostic {
    let facet = topology.facet_of(fin);
    let [a, b] = topology.fin_ends(fin).map(|v| complex.vertices[v].point);
    Diagnostic::internal("brep-radial", format!("facet {} {what}", facet.0)).near(a).near(b)
}

/// Finds the third corner of the triangle at a fin; remembers the sorted triangle edges of the last facet.
struct Apexes<'a> {
    topology: &'a Topology,
    complex: &'a Complex,
    facet: FacetId,
    directed: Vec<([VertexId; 2], VertexId)>,
}

impl Apexes<'_> {
    fn of(&mut self, fin: FinId) -> Option<VertexId> {
        let facet = self.topology.facet_of(fin);
        if facet != self.facet {
            self.facet = facet;
            self.directed.clear();
            for &[a, b, c] in &self.complex.facets[facet].triangles {
                self.directed.extend([([a, b], c), ([b, c], a), ([c, a], b)]);
            }
            self.directed.sort_unstable();
        }
        let ends = self.topology.fin_ends(fin);
        self.directed.binary_search_by(|probe| probe.0.cmp(&ends)).ok().map(|k| self.directed[k].1)
    }
}

/// Collects face uses into shells across mates; shells come in order of their first use.
fn add_shells(topology: &mut Topology, complex: &Complex) -> Outcome<()> {
    topology.regions = Arena::with_capacity(complex.regions.len());
    for _ in complex.regions.iter() {
        topology.regions.insert(RegionLinks { first: ShellId::NONE });
    }
    let uses = 2 * topology.facets.bound() as u32;
    let mut lists: Vec<ShellId> = vec![ShellId::NONE; uses as usize];
    let mut findings = Vec::new();
    let mut stack = Vec::new();
    let side = |face_use: FaceUseId| complex.facets[face_use.facet()].sides[face_use.side() as usize];
    for seed in (0..uses).map(FaceUseId) {
        if lists[seed.0 as usize].is_some() {
            continue;
        }
        let shell = topology.new_shell(side(seed), false);
        lists[seed.0 as usize] = shell;
        stack.push(seed);
        while let Some(face_use) = stack.pop() {
            for half in topology.half_edges_of(face_use) {
                let beyond = topology.face_use(topology.mate(half));
                if lists[beyond.0 as usize].is_some() {
                    continue;
                }
                if side(beyond) != side(face_use) {
                    findings.push(side_problem(topology, complex, half, [side(face_use), side(beyond)]));
                }
                lists[beyond.0 as usize] = shell;
                stack.push(beyond);
            }
        }
    }
    // Backwards, since lists grow at the front.
    for face_use in (0..uses).rev().map(FaceUseId) {
        topology.list_use(face_use, lists[face_use.0 as usize]);
    }
    if findings.is_empty() { Ok(()) } else { Err(findings) }
}

fn side_problem(topology: &Topology, complex: &Complex, half: HalfEdgeId, sides: [RegionId; 2]) -> Diagnostic {
    let [a, b] = [half, topology.next(half)].map(|h| complex.vertices[topology.start(h)].point);
    let message = format!("facets that meet at an edge claim regions {} and {} in one sector", sides[0].0, sides[1].0);
    Diagnostic::internal("brep-sides", message).near(a).near(b)
}
