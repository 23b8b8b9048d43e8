//! Regions: connected volumes, joined across nested components and numbered.

use crate::brep::complex::{Complex, Region};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::aabb::{Aabb, Segment};
use crate::geom::bvh::Bvh;
use crate::geom::hash::IndexMap;
use crate::geom::predicates::{Sign, orient3d};
use crate::ids::{FacetId, Id, IdVec, PartId, RegionId, VertexId};

/// Directions tried before giving up; each fails only if the ray meets an edge exactly.
const TRIES: u64 = 64;

/// The boundary of one volume, as far as the arrangement knows it.
struct Shell {
    part: Option<PartId>,
    /// Facets, and whether the volume is in front of them.
    sides: Vec<(FacetId, bool)>,
    /// Enclosed volume; negative if the volume lies outside of the shell.
    volume: f64,
    area: f64,
    bounds: Aabb,
    /// Shell of the same volume that encloses it, or itself; `None` is the unbounded outside.
    home: Option<usize>,
}

/// Numbers the regions: 0 outside, then by part and first facet, then voids; the sides of all facets, until now volumes, become
/// regions. Vertices may have been moved by `reach`.
pub fn number(complex: &mut Complex, part_of_volume: &[Option<PartId>], reach: f64) -> Result<(), Diagnostic> {
    let mut shells: Vec<Shell> = Vec::new();
    let mut shell_of_volume = vec![usize::MAX; part_of_volume.len()];
    for (id, facet) in complex.facets.enumerate() {
        for (k, volume) in facet.sides.iter().enumerate() {
            let slot = &mut shell_of_volume[volume.index()];
            if *slot == usize::MAX {
                *slot = shells.len();
                let part = part_of_volume[volume.index()];
                shells.push(Shell { part, sides: Vec::new(), volume: 0.0, area: 0.0, bounds: Aabb::EMPTY, home: None });
            }
            shells[*slot].sides.push((id, k == 0));
        }
    }
    for shell in &mut shells {
        measure(shell, complex);
    }
    let mut outers = Outers::new(complex, &shells);
    let mut home = |s: usize| if shells[s].volume > 0.0 { Ok(Some(s)) } else { outers.enclosing(s, reach) };
    let all: Vec<Option<usize>> = (0..shells.len()).map(&mut home).collect::<Result<_, _>>()?;
    shells.iter_mut().zip(all).for_each(|(shell, home)| shell.home = home);
    let mut homes: Vec<usize> = (0..shells.len()).filter(|&s| shells[s].home == Some(s)).collect();
    homes.sort_by_key(|&s| (shells[s].part.map_or(u32::MAX, |p| p.0), shells[s].sides.first().map(|x| x.0)));
    let mut regions = IdVec::from(vec![Region { part: None }]);
    let mut region_of = vec![RegionId(0); shells.len()];
    for &home in &homes {
        region_of[home] = regions.push(Region { part: shells[home].part });
    }
    for facet in complex.facets.iter_mut() {
        facet.sides = facet.sides.map(|v| match shells[shell_of_volume[v.index()]].home {
            Some(home) => region_of[home],
            None => RegionId(0),
        });
    }
    complex.regions = regions;
    let of_one = complex.facets.iter().find(|f| f.sides[0] == f.sides[1]);
    of_one.map_or(Ok(()), |facet| {
        let at = facet.triangles.first().map_or_else(Vec3::zeros, |t| complex.vertices[t[0]].point);
        Err(Diagnostic::internal("one-sided", "a facet lies inside a region").near(at))
    })
}

fn corners(complex: &Complex, facet: FacetId) -> impl Iterator<Item = [Vec3; 3]> {
    complex.facets[facet].triangles.iter().map(|t| t.map(|v| complex.vertices[v].point))
}

fn measure(shell: &mut Shell, complex: &Complex) {
    let origin = shell.sides.first().and_then(|s| corners(complex, s.0).next()).map_or(Vec3::zeros(), |t| t[0]);
    for &(facet, is_front) in &shell.sides {
        for [a, b, c] in corners(complex, facet) {
            let twice = (b - a).cross(&(c - a));
            let six = (a - origin).dot(&twice);
            shell.area += 0.5 * twice.norm();
            shell.volume += if is_front { -six } else { six } / 6.0;
            shell.bounds = shell.bounds.union(&Aabb::around([&a, &b, &c]));
        }
    }
}

/// The shells that can be outer boundaries.
struct Outers<'a> {
    complex: &'a Complex,
    shells: &'a [Shell],
    /// Their numbers, and a tree over their boxes.
    numbers: Vec<usize>,
    tree: Bvh,
    /// Those that were asked about.
    known: IndexMap<usize, Solid>,
}

impl<'a> Outers<'a> {
    fn new(complex: &'a Complex, shells: &'a [Shell]) -> Self {
        let numbers: Vec<usize> = (0..shells.len()).filter(|&s| shells[s].volume > 0.0).collect();
        let tree = Bvh::new(numbers.iter().map(|&s| shells[s].bounds).collect());
        Self { complex, shells, numbers, tree, known: IndexMap::default() }
    }

    /// The smallest shell of the same part that encloses shell `s`; itself if rounding has hardly left anything of its volume;
    /// `None` if it lies in the outside.
    fn enclosing(&mut self, s: usize, reach: f64) -> Result<Option<usize>, Diagnostic> {
        let (shells, mine) = (self.shells, &self.shells[s]);
        let mut candidates: Vec<usize> = Vec::new();
        self.tree.search(|b| mine.bounds.union(b) == *b, |k| candidates.push(self.numbers[k as usize]));
        candidates.retain(|&c| shells[c].part == mine.part);
        candidates.sort_by(|&a, &b| shells[a].volume.total_cmp(&shells[b].volume).then(a.cmp(&b)));
        for c in candidates {
            if self.encloses(c, mine)? {
                return Ok(Some(c));
            }
        }
        if mine.part.is_none() {
            return Ok(None);
        }
        if mine.volume.abs() <= reach * mine.area {
            return Ok(Some(s));
        }
        let at = mine.sides.first().and_then(|f| corners(self.complex, f.0).next()).map_or(Vec3::zeros(), |t| t[0]);
        Err(Diagnostic::internal("homeless-shell", "a part's volume has no outer boundary").near(at))
    }

    /// Whether a vertex of `inner` that is not on `outer` lies inside `outer`.
    fn encloses(&mut self, outer: usize, inner: &Shell) -> Result<bool, Diagnostic> {
        let (complex, shells) = (self.complex, self.shells);
        let outer = &*self.known.entry(outer).or_insert_with(|| Solid::new(complex, &shells[outer]));
        let mut free = inner.sides.iter().flat_map(|s| complex.facets[s.0].loops.iter().flatten().copied());
        let Some(vertex) = free.find(|v| outer.vertices.binary_search(v).is_err()) else {
            // All vertices touch: decide by the middle of a triangle, which rounding moves by far less than its size.
            let middle = inner.sides.first().and_then(|s| corners(complex, s.0).next()).map(|[a, b, c]| (a + b + c) / 3.0);
            return middle.map_or(Ok(false), |p| outer.has(&p));
        };
        outer.has(&complex.vertices[vertex].point)
    }
}

/// A shell, prepared for rays.
struct Solid {
    /// Ascending.
    vertices: Vec<VertexId>,
    triangles: Vec<[Vec3; 3]>,
    tree: Bvh,
}

impl Solid {
    fn new(complex: &Complex, shell: &Shell) -> Self {
        let facets = || shell.sides.iter().map(|s| &complex.facets[s.0]);
        let mut vertices: Vec<VertexId> = facets().flat_map(|f| f.loops.iter().flatten().copied()).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let triangles: Vec<[Vec3; 3]> = shell.sides.iter().flat_map(|s| corners(complex, s.0)).collect();
        let tree = Bvh::new(triangles.iter().map(Aabb::around).collect());
        Self { vertices, triangles, tree }
    }

    /// Whether a point lies inside.
    fn has(&self, p: &Vec3) -> Result<bool, Diagnostic> {
        let bounds = self.tree.bounds();
        for attempt in 0..TRIES {
            let f = |x: f64| ((attempt + 1) as f64 * x).fract() - 0.5;
            let direction = Vec3::new(f(0.754_877_666_2) + 0.1, f(0.569_840_290_9) + 0.2, 0.6 + f(0.819_172_513_4).abs());
            let far = bounds.center() + direction.normalize() * (2.0 * bounds.diagonal());
            let segment = Segment::new(p, &far, &bounds);
            let mut count = Some(0u32);
            self.tree.search(
                |b| segment.may_meet(b, 1.0),
                |t| count = count.and_then(|n| Some(n + u32::from(crosses(p, &far, &self.triangles[t as usize])?))),
            );
            if let Some(n) = count {
                return Ok(n % 2 == 1);
            }
        }
        Err(Diagnostic::internal("ray", "every ray from a point meets an edge").near(*p))
    }
}

/// Whether the segment crosses the triangle; `None` if it meets its boundary.
fn crosses(p: &Vec3, q: &Vec3, [a, b, c]: &[Vec3; 3]) -> Option<bool> {
    let (above, below) = (orient3d(a, b, c, q), orient3d(a, b, c, p));
    if above == 0 || below == 0 || above == below {
        return Some(false);
    }
    let sides: [Sign; 3] = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    if sides.contains(&0) {
        return if sides.contains(&1) && sides.contains(&-1) { Some(false) } else { None };
    }
    Some(sides[0] == sides[1] && sides[1] == sides[2])
}
