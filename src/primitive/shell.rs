//! A solid under construction.

use super::solid::{Freedom, Shape, Solid, SolidFacet, SolidSurface, SolidVertex};
use crate::geom::Vec3;
use std::collections::HashMap;

/// Collects vertices, surfaces and facets; facets are given as if nothing were mirrored.
#[derive(Debug)]
pub(crate) struct Shell {
    solid: Solid,
    is_reversed: bool,
    /// Vertices inside edges, from the lower number to the higher.
    cuts: HashMap<[u32; 2], Vec<u32>>,
}

impl Shell {
    /// An empty shell; `is_reversed` turns every facet over.
    pub fn new(is_reversed: bool) -> Self {
        Self { solid: Solid::default(), is_reversed, cuts: HashMap::new() }
    }
    pub fn vertex(&mut self, point: Vec3, freedom: Freedom) -> u32 {
        self.solid.vertices.push(SolidVertex { point, freedom });
        self.solid.vertices.len() as u32 - 1
    }
    pub fn point(&self, vertex: u32) -> Vec3 {
        self.solid.vertices[vertex as usize].point
    }
    pub fn surface(&mut self, side: &str, shape: Shape) -> u32 {
        self.solid.surfaces.push(SolidSurface { side: side.into(), shape });
        self.solid.surfaces.len() as u32 - 1
    }
    /// Adds a facet. Vertices repeated in a row (collapsed on an axis) are one; loops of fewer than three vanish, and the facet
    /// with its outer loop.
    pub fn facet(&mut self, surface: u32, loops: Vec<Vec<u32>>) {
        let mut kept = Vec::with_capacity(loops.len());
        for (k, mut walk) in loops.into_iter().enumerate() {
            walk.dedup();
            while walk.len() > 1 && walk.first() == walk.last() {
                walk.pop();
            }
            if walk.len() >= 3 {
                if self.is_reversed {
                    walk.reverse();
                }
                kept.push(walk);
            } else if k == 0 {
                return;
            }
        }
        self.solid.facets.push(kept, surface);
    }
    /// Puts vertices into the edge from one vertex to another, in that order, in all facets.
    pub fn cut(&mut self, [from, to]: [u32; 2], mut inner: Vec<u32>) {
        if inner.is_empty() {
            return;
        }
        if from > to {
            inner.reverse();
        }
        self.cuts.insert([from.min(to), from.max(to)], inner);
    }
    /// The vertices inside the edge from one vertex to another, in that order, if it was cut.
    pub fn cuts(&self, [from, to]: [u32; 2]) -> Option<Vec<u32>> {
        let mut inner = self.cuts.get(&[from.min(to), from.max(to)])?.clone();
        if from > to {
            inner.reverse();
        }
        Some(inner)
    }
    fn with_cuts(&self, walk: &[u32]) -> Vec<u32> {
        let next = |k: usize| walk[(k + 1) % walk.len()];
        let edge = |k: usize| std::iter::once(walk[k]).chain(self.cuts([walk[k], next(k)]).into_iter().flatten());
        (0..walk.len()).flat_map(edge).collect()
    }
    /// The solid; vertices that no facet uses (centres of discs) are dropped.
    pub fn finish(mut self) -> Solid {
        if !self.cuts.is_empty() {
            let with_cuts = |f: SolidFacet| (f.loops.iter().map(|walk| self.with_cuts(walk)).collect::<Vec<_>>(), f.surface);
            self.solid.facets = self.solid.facets.iter().map(with_cuts).collect();
        }
        let mut number = vec![None; self.solid.vertices.len()];
        for &v in self.solid.facets.corners() {
            number[v as usize] = Some(0);
        }
        for (next, slot) in number.iter_mut().flatten().enumerate() {
            *slot = next as u32;
        }
        let mut is_used = number.iter().map(Option::is_some);
        self.solid.vertices.retain(|_| is_used.next().unwrap_or(true));
        for v in self.solid.facets.corners_mut() {
            *v = number[*v as usize].unwrap_or(*v);
        }
        self.solid
    }
}
