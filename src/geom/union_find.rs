//! Disjoint sets of numbers.

/// Disjoint sets of the numbers below its length; the smallest member represents.
#[derive(Clone, Debug)]
pub struct UnionFind {
    parent: Vec<u32>,
}

impl UnionFind {
    /// Every number on its own.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }
    /// The smallest number of the set; nearly constant cost (path halving).
    pub fn find(&mut self, mut x: u32) -> u32 {
        while self.parent[x as usize] != x {
            let up = self.parent[self.parent[x as usize] as usize];
            self.parent[x as usize] = up;
            x = up;
        }
        x
    }
    /// Joins two sets.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
    /// Numbers the sets from 0 in order of their smallest members: the set of each number, and how many there are.
    pub fn number(mut self) -> (Vec<u32>, usize) {
        let mut set = vec![0; self.parent.len()];
        let mut count = 0;
        for x in 0..self.parent.len() {
            let root = self.find(x as u32) as usize;
            set[x] = if root == x {
                count += 1;
                count - 1
            } else {
                set[root]
            };
        }
        (set, count as usize)
    }
}
