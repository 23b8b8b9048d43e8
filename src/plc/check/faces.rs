//! The faces that its listed segments divide a facet into: one for most, several where polygons lie side by side or in each
//! other.

use super::Subject;
use crate::geom::union_find::UnionFind;
use crate::plc::facet::segments_of;
use std::collections::{BTreeMap, BTreeSet};

/// Faces of all facets.
pub struct Faces {
    /// The face of each triangle.
    pub of_triangle: Vec<u32>,
    /// The facet of each face.
    pub facet_of: Vec<u32>,
    /// Number of connected pieces of each face's boundary.
    pub boundaries: Vec<u32>,
}

/// Finds the faces.
pub fn find(subject: &Subject) -> Faces {
    let mut faces = Faces { of_triangle: Vec::new(), facet_of: Vec::new(), boundaries: Vec::new() };
    let mut first = 0;
    for chunk in subject.facet_of.chunk_by(|a, b| a == b) {
        let triangles = &subject.triangles[first..first + chunk.len()];
        first += chunk.len();
        let polygons = &subject.plc.facets[chunk[0] as usize].polygons;
        match &polygons[..] {
            // A polygon that encloses as much as one of its size can is one face with one boundary.
            [only] if only.len() == triangles.len() + 2 => faces.push(chunk[0], &vec![0; triangles.len()], &[1]),
            _ => {
                let (face_of, boundaries) = divide(polygons, triangles);
                faces.push(chunk[0], &face_of, &boundaries);
            }
        }
    }
    faces
}

impl Faces {
    fn push(&mut self, facet: u32, face_of: &[u32], boundaries: &[u32]) {
        let first = self.boundaries.len() as u32;
        self.of_triangle.extend(face_of.iter().map(|f| first + f));
        self.facet_of.extend(boundaries.iter().map(|_| facet));
        self.boundaries.extend(boundaries);
    }
}

/// The face of each triangle of a facet, and the boundary pieces of each face. Pieces that share a vertex are one.
fn divide(polygons: &[Vec<u32>], triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let listed: BTreeSet<[u32; 2]> = polygons.iter().flat_map(|p| segments_of(p)).collect();
    let mut union = UnionFind::new(triangles.len());
    let mut over: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (t, triangle) in triangles.iter().enumerate() {
        for edge in segments_of(triangle).filter(|e| !listed.contains(e)) {
            union.join(t as u32, *over.entry(edge).or_insert(t as u32));
        }
    }
    let (face_of, count) = union.number();
    // Each vertex of a facet is listed, and so lies on the boundary of its faces.
    let mut uses: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (triangle, &face) in triangles.iter().zip(&face_of) {
        for &v in triangle {
            let next = uses.len() as u32;
            uses.entry((face, v)).or_insert(next);
        }
    }
    let mut pieces = UnionFind::new(uses.len());
    for (triangle, &face) in triangles.iter().zip(&face_of) {
        for [a, b] in segments_of(triangle).filter(|e| listed.contains(e)) {
            pieces.join(uses[&(face, a)], uses[&(face, b)]);
        }
    }
    let mut boundaries = vec![0; count];
    for (&(face, _), &u) in &uses {
        boundaries[face as usize] += u32::from(pieces.find(u) == u);
    }
    (face_of, boundaries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_in_a_square_is_two_faces_with_three_boundaries() {
        // Square 0..3, square 4..7 inside, divided as a ring and two triangles.
        let ring = [[0, 1, 4], [1, 5, 4], [1, 2, 5], [2, 6, 5], [2, 3, 6], [3, 7, 6], [3, 0, 7], [0, 4, 7]];
        let all = [&ring[..], &[[4, 5, 6], [4, 6, 7]]].concat();
        let polygons = [vec![0, 1, 2, 3], vec![4, 5, 6, 7]];
        let (mut faces, mut boundaries) = divide(&polygons, &all);
        faces.dedup();
        boundaries.sort_unstable();
        assert_eq!((faces.len(), &boundaries[..]), (2, &[1, 2][..]));
        // With a segment between the squares the ring has one boundary.
        assert_eq!(divide(&[&polygons[..], &[vec![0, 4]]].concat(), &all).1, [1, 1]);
        // Two squares apart.
        assert_eq!(divide(&[vec![0, 1, 2], vec![3, 4, 5]], &[[0, 1, 2], [3, 4, 5]]).1, [1, 1]);
    }
}
