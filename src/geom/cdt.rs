//! Constrained Delaunay triangulations by spade, the same for the same input.
//!
//! spade's bulk loading with constraints puts off what it cannot insert at once and takes that up again in the order of a hash
//! set with a random seed: of triangulations that are equally good, and of the numbers of faces, chance would decide. Its
//! loading of places alone does not; constraints follow here, in order.

use spade::handles::{DirectedEdgeHandle, FaceHandle, FixedVertexHandle, InnerTag, VertexHandle};
use spade::{CdtEdge, ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation as _};

/// A place and its number in the input.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    at: Point2<f64>,
    slot: usize,
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.at
    }
}

/// A triangulation whose vertices know their numbers in the input.
pub(crate) type Triangulation = ConstrainedDelaunayTriangulation<Site>;
/// A directed edge of a triangulation.
pub(crate) type HalfEdge<'a> = DirectedEdgeHandle<'a, Site, (), CdtEdge<()>, ()>;
/// A triangle.
pub(crate) type Face<'a> = FaceHandle<'a, InnerTag, Site, (), CdtEdge<()>, ()>;
/// A vertex.
pub(crate) type Vertex<'a> = VertexHandle<'a, Site, (), CdtEdge<()>, ()>;

/// A triangulation, and its vertices by their numbers.
pub(crate) struct Cdt {
    pub triangulation: Triangulation,
    /// By number in the input.
    handles: Vec<FixedVertexHandle>,
}

/// The number of a vertex in the input.
pub(crate) fn slot(vertex: Vertex) -> usize {
    vertex.data().slot
}

impl Cdt {
    /// Of places, with the edges between some of them. An edge may be given several times.
    ///
    /// # Errors
    /// The number of a place that cannot stay: two places are the same, a coordinate is none, or an edge from there crosses
    /// another one or passes through a place.
    pub fn new(at: impl IntoIterator<Item = [f64; 2]>, edges: &[[usize; 2]]) -> Result<Self, usize> {
        let sites: Vec<Site> = at.into_iter().map(place).enumerate().map(|(slot, at)| Site { at, slot }).collect();
        let count = sites.len();
        if let Some(wrong) = sites.iter().position(|s| [s.at.x, s.at.y].iter().any(|x| spade::validate_coordinate(*x).is_err()))
        {
            return Err(wrong);
        }
        let triangulation = Triangulation::bulk_load(sites).map_err(|_| 0usize)?;
        let mut handles = vec![None; count];
        triangulation.vertices().for_each(|v| handles[slot(v)] = Some(v.fix()));
        if let Some(twin) = handles.iter().position(Option::is_none) {
            return Err(twin);
        }
        let mut cdt = Self { triangulation, handles: handles.into_iter().flatten().collect() };
        // From the end with fewer edges: the search goes round it.
        let mut busy = vec![0u32; count];
        edges.iter().flatten().for_each(|&slot| busy[slot] += 1);
        for [a, b] in scattered(edges.len()).map(|k| edges[k]) {
            let [from, to] = if busy[a] <= busy[b] { [a, b] } else { [b, a] };
            if cdt.triangulation.try_add_constraint(cdt.handle(from), cdt.handle(to)).len() != 1 {
                return Err(from);
            }
        }
        Ok(cdt)
    }

    /// The vertex with a number.
    pub fn handle(&self, slot: usize) -> FixedVertexHandle {
        self.handles[slot]
    }
}

/// The numbers below `count`, each once, far from the one before: by their bits in reverse. Of long edges side by side, as a
/// comb has, each one that is inserted after its neighbour would have to be crossed by all edges that this one left.
fn scattered(count: usize) -> impl Iterator<Item = usize> {
    let bits = usize::BITS - count.saturating_sub(1).leading_zeros();
    let reversed = move |k: usize| k.reverse_bits().checked_shr(usize::BITS - bits).unwrap_or(0);
    (0..1 << bits).map(reversed).filter(move |&k| k < count)
}

/// Flushes what spade would refuse as too small; whoever needs exact signs asks the true coordinates.
pub(crate) fn place([x, y]: [f64; 2]) -> Point2<f64> {
    let tidy = |x: f64| if x.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { x };
    Point2::new(tidy(x), tidy(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of places, many of them on one line and on one circle.
    fn grid(n: usize) -> Vec<[f64; 2]> {
        (0..n * n).map(|k| [(k % n) as f64, (k / n) as f64]).collect()
    }

    #[test]
    fn equally_good_triangulations_are_not_drawn_by_lot() {
        let edges: Vec<[usize; 2]> = (0..7).map(|k| [k, k + 9]).collect();
        let triangles = || -> Vec<[usize; 3]> {
            let cdt = Cdt::new(grid(8), &edges).unwrap();
            cdt.triangulation.inner_faces().map(|f| f.vertices().map(slot)).collect()
        };
        let first = triangles();
        assert_eq!(first.len(), 2 * 49);
        assert!((0..20).all(|_| triangles() == first));
    }

    #[test]
    fn scattered_numbers_come_once() {
        for count in [0, 1, 2, 3, 7, 8, 9, 100] {
            let mut all: Vec<usize> = scattered(count).collect();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..count));
        }
        assert_eq!(scattered(8).collect::<Vec<_>>(), [0, 4, 2, 6, 1, 5, 3, 7]);
    }

    #[test]
    fn what_cannot_stay_is_named() {
        let square = || [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]];
        assert!(Cdt::new(square(), &[[0, 1], [1, 0], [0, 4]]).is_ok());
        // Through the middle.
        assert_eq!(Cdt::new(square(), &[[0, 2]]).err(), Some(0));
        assert_eq!(Cdt::new(grid(2), &[[0, 3], [1, 2]]).err(), Some(1));
        assert_eq!(Cdt::new([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]], &[]).err().map(|k| k % 2), Some(0));
        assert_eq!(Cdt::new([[0.0, 1.0], [0.0, f64::NAN]], &[]).err(), Some(1));
    }
}
