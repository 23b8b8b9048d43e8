//! Points that round to one place become one vertex.

use crate::geom::Vec3;
use crate::geom::hash::IndexMap;

/// Facets' loops over rounded vertices.
pub type Loops = Vec<Vec<Vec<u32>>>;

/// Numbers the used places in order of first use; equal places get one number, and what collapses is dropped: repeated vertices,
/// loops that become lines. A facet whose outer loop collapses keeps no loop.
pub fn weld(facets: Loops, places: &[Vec3]) -> (Vec<Vec3>, Loops) {
    let mut number_of_place: IndexMap<[u64; 3], u32> = IndexMap::default();
    let mut points = Vec::new();
    let mut number = vec![u32::MAX; places.len()];
    let mut vertex = |p: u32| {
        if number[p as usize] == u32::MAX {
            // Adding zero turns -0 into 0, so that both are one place.
            let at = places[p as usize].map(|x| x + 0.0);
            let key = [at.x.to_bits(), at.y.to_bits(), at.z.to_bits()];
            number[p as usize] = *number_of_place.entry(key).or_insert_with(|| {
                points.push(at);
                points.len() as u32 - 1
            });
        }
        number[p as usize]
    };
    let renamed: Loops = facets.iter().map(|f| f.iter().map(|w| w.iter().map(|&p| vertex(p)).collect()).collect()).collect();
    let tidy = |facet: Vec<Vec<u32>>| {
        let mut loops: Vec<Vec<u32>> = Vec::with_capacity(facet.len());
        for (k, walk) in facet.into_iter().enumerate() {
            let was = walk.len();
            let walk = without_spikes(walk);
            if k == 0 && walk.len() < 3 {
                return Vec::new();
            }
            // A hole that collapsed is still a place where something touches, and is found as such by the exact test.
            if walk.len() >= 3 || was <= 2 {
                loops.push(walk);
            }
        }
        loops
    };
    (points, renamed.into_iter().map(tidy).collect())
}

/// Drops repeated neighbours and steps back and forth.
fn without_spikes(walk: Vec<u32>) -> Vec<u32> {
    if walk.len() <= 2 {
        return walk;
    }
    let mut out: Vec<u32> = Vec::with_capacity(walk.len());
    for v in walk {
        if out.last() == Some(&v) {
            continue;
        }
        if out.len() >= 2 && out[out.len() - 2] == v {
            out.pop();
            continue;
        }
        out.push(v);
    }
    loop {
        let n = out.len();
        if n > 1 && out[0] == out[n - 1] {
            out.pop();
        } else if n > 2 && (out[1] == out[n - 1] || out[0] == out[n - 2]) {
            if out[1] == out[n - 1] {
                out.remove(0);
                out.pop();
            } else {
                out.pop();
                out.pop();
            }
        } else {
            return out;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_are_one_vertex() {
        let places = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::x(), Vec3::new(-0.0, 0.0, 0.0)];
        let (points, loops) = weld(vec![vec![vec![0, 1, 2]], vec![vec![3, 4, 2]], vec![vec![0, 1, 3]]], &places);
        assert_eq!(points.len(), 3);
        assert_eq!(loops, vec![vec![vec![0, 1, 2]], vec![vec![1, 0, 2]], vec![]]);
    }

    #[test]
    fn spikes_go() {
        assert_eq!(without_spikes(vec![0, 1, 2, 1, 3]), vec![0, 1, 3]);
        assert!(without_spikes(vec![0, 1, 0, 1]).len() < 3);
    }
}
