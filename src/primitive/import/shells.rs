//! Which polygons bound one body: those that meet in an edge, and where several bodies share one, the right two of many.

use super::Surface;
use super::sides::Sides;
use crate::geom::hash::IndexMap;
use crate::geom::radial::Axis;
use crate::geom::union_find::UnionFind;

/// A triangle at an edge that more than two polygons have.
struct Fin {
    /// Its third corner.
    apex: u32,
    polygon: u32,
    /// Whether it runs from the lower to the upper end.
    is_upwards: bool,
}

/// The shell of each polygon, and how many there are. The triangles are those of the polygons, each with its polygon, and meet
/// in whole vertices and edges only; the sides at every edge match.
///
/// Around an edge of several bodies, neighbors that run in opposite directions are joined, as brackets are: shells then nowhere
/// cross, so that each lies wholly inside or outside of every other, and each is oriented in itself, whatever the others are.
/// O(n log n).
pub(super) fn shells(surface: &Surface, sides: &Sides, (triangles, polygon_of): (&[[u32; 3]], &[u32])) -> (Vec<u32>, usize) {
    let mut sets = UnionFind::new(surface.polygons.count());
    let mut shared: Vec<([u32; 2], Vec<Fin>)> = Vec::new();
    let mut number: IndexMap<[u32; 2], usize> = IndexMap::default();
    for (ends, sides) in sides.edges() {
        match sides {
            [a, b] => sets.join(a.polygon(), b.polygon()),
            _ => {
                number.insert(ends, shared.len());
                shared.push((ends, Vec::new()));
            }
        }
    }
    if shared.is_empty() {
        return sets.number();
    }
    for (&[a, b, c], &polygon) in triangles.iter().zip(polygon_of) {
        for (from, to, apex) in [(a, b, c), (b, c, a), (c, a, b)] {
            if let Some(&edge) = number.get(&[from.min(to), from.max(to)]) {
                shared[edge].1.push(Fin { apex, polygon, is_upwards: from < to });
            }
        }
    }
    for (ends, mut fins) in shared {
        let [from, to] = ends.map(|v| &surface.points[v as usize]);
        let axis = Axis { from, to };
        let at = |fin: &Fin| surface.points[fin.apex as usize];
        let Some(reference) = fins.first().map(at) else { continue };
        fins.sort_by(|a, b| axis.compare(&reference, &at(a), &at(b)));
        let mut unmatched: Vec<Fin> = Vec::new();
        for fin in fins {
            match unmatched.pop_if(|last| last.is_upwards != fin.is_upwards) {
                Some(last) => sets.join(last.polygon, fin.polygon),
                None => unmatched.push(fin),
            }
        }
    }
    sets.number()
}
