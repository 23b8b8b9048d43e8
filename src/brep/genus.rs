//! The number of handles of a shell, found without Euler's formula.
//!
//! Bridges join the loops of each face use into one. A tree of face uses, joined across edge uses, unfolds the shell into one
//! disk; the edge uses left over form a graph, of which a spanning tree shrinks to a point. What then remains are closed loops,
//! and walking once round the disk meets each of them twice. Two loops cross iff they alternate on that walk; the rank of this
//! alternation matrix over the integers modulo 2 is twice the number of handles. On a closed surface the matrix is regular, so
//! loops that cross nothing betray a surface that is not one: uses glued or told apart wrongly.

use super::store::{FaceUseId, HalfEdgeId, ShellId, Topology};

/// Beyond this many loops the alternation matrix (bits: loops squared) and its elimination (loops cubed / 64) cost too much;
/// the count is then refused.
const MAX_LOOPS: usize = 1 << 13;

/// Marks per half-edge, for all shells.
pub(super) struct Surface {
    is_marked: Vec<bool>,
    number: Vec<u32>,
}

impl Surface {
    pub fn new(topology: &Topology) -> Self {
        let halves = 2 * topology.fins.bound();
        Self { is_marked: vec![false; halves], number: vec![u32::MAX; halves] }
    }
    /// Marks a half-edge; whether it was unmarked.
    pub fn mark(&mut self, half: HalfEdgeId) -> bool {
        !std::mem::replace(&mut self.is_marked[half.0 as usize], true)
    }
}

/// A closed surface as a map: darts with successor in the face and partner across the edge, by local number.
#[derive(Default)]
struct Map {
    next: Vec<u32>,
    mate: Vec<u32>,
    face: Vec<u32>,
    faces: u32,
}

/// Number of handles of a shell, or why it is not a closed connected surface.
pub(super) fn genus(topology: &Topology, shell: ShellId, surface: &mut Surface) -> Result<i64, &'static str> {
    let map = Map::of(topology, shell, surface);
    if map.next.is_empty() {
        return if map.faces == 1 { Ok(0) } else { Err("is not connected") };
    }
    let is_folded = map.unfold()?;
    let is_loop = map.shrink(&is_folded);
    let word = map.walk_round(&is_folded, &is_loop)?;
    let loops = word.len() / 2;
    if loops > MAX_LOOPS {
        return Err("has too many handles to count");
    }
    let rank = rank_mod_2(alternations(&word));
    if rank != loops {
        return Err("is not a closed surface");
    }
    Ok(rank as i64 / 2)
}

impl Map {
    fn of(topology: &Topology, shell: ShellId, surface: &mut Surface) -> Self {
        let mut map = Map::default();
        let mut halves = Vec::new();
        for (face, face_use) in topology.face_uses(shell).enumerate() {
            halves.extend(topology.half_edges_of(face_use));
            map.face.resize(halves.len(), face as u32);
            map.faces += 1;
        }
        for (k, half) in halves.iter().enumerate() {
            surface.number[half.0 as usize] = k as u32;
        }
        let number = |half: HalfEdgeId| surface.number[half.0 as usize];
        for &half in &halves {
            map.next.push(number(topology.next(half)));
            map.mate.push(number(topology.mate(half)));
        }
        for (face, face_use) in topology.face_uses(shell).enumerate() {
            map.bridge(topology, face_use, face as u32, &number);
        }
        map
    }

    /// Joins the loops of a face use: one edge from the first loop to each other, both ways.
    fn bridge(&mut self, topology: &Topology, face_use: FaceUseId, face: u32, number: &impl Fn(HalfEdgeId) -> u32) {
        let dart = |walk| {
            let fin = topology.fins_of(walk).next()?;
            topology.edge_of(fin).map(|_| number(fin.on(face_use.side())))
        };
        let mut walks = topology.loops(face_use.facet());
        let mut anchor = walks.next().and_then(dart);
        for walk in walks {
            let [out, home] = [self.next.len() as u32, self.next.len() as u32 + 1];
            self.mate.extend([home, out]);
            self.face.extend([face, face]);
            // After `anchor` the walk goes out, round the other loop and home. A lone vertex is the dead end of its bridge.
            let after = anchor.map_or(out, |a| self.next[a as usize]);
            let target = dart(walk);
            self.next.extend([target.map_or(home, |t| self.next[t as usize]), after]);
            if let Some(target) = target {
                self.next[target as usize] = home;
            }
            match anchor {
                Some(a) => self.next[a as usize] = out,
                None => anchor = Some(home),
            }
        }
    }

    /// A tree of faces: the darts across which it goes. Each face is one cycle of darts.
    fn unfold(&self) -> Result<Vec<bool>, &'static str> {
        let mut is_folded = vec![false; self.next.len()];
        let mut is_met = vec![false; self.faces as usize];
        is_met[self.face[0] as usize] = true;
        let mut stack = vec![0u32];
        let mut met = 1;
        while let Some(first) = stack.pop() {
            let mut dart = first;
            loop {
                let mate = self.mate[dart as usize];
                if !std::mem::replace(&mut is_met[self.face[mate as usize] as usize], true) {
                    is_folded[dart as usize] = true;
                    is_folded[mate as usize] = true;
                    stack.push(mate);
                    met += 1;
                }
                dart = self.next[dart as usize];
                if dart == first {
                    break;
                }
            }
        }
        if met == self.faces { Ok(is_folded) } else { Err("is not connected") }
    }

    /// Of the darts that are not folded: those outside a spanning tree of the vertices.
    fn shrink(&self, is_folded: &[bool]) -> Vec<bool> {
        let vertex = self.vertices();
        let count = vertex.iter().max().map_or(0, |&v| v as usize + 1);
        let mut root: Vec<u32> = (0..count as u32).collect();
        let mut is_loop = vec![false; self.next.len()];
        for dart in 0..self.next.len() {
            let mate = self.mate[dart] as usize;
            if is_folded[dart] || mate < dart {
                continue;
            }
            let [a, b] = [find(&mut root, vertex[dart]), find(&mut root, vertex[mate])];
            root[a as usize] = b;
            is_loop[dart] = a == b;
            is_loop[mate] = a == b;
        }
        is_loop
    }

    /// The vertex (orbit) from which each dart starts.
    fn vertices(&self) -> Vec<u32> {
        let mut vertex = vec![u32::MAX; self.next.len()];
        let mut count = 0;
        for seed in 0..self.next.len() {
            let mut at = seed;
            if vertex[at] != u32::MAX {
                continue;
            }
            while vertex[at] == u32::MAX {
                vertex[at] = count;
                at = self.next[self.mate[at] as usize] as usize;
            }
            count += 1;
        }
        vertex
    }

    /// Walks once round the unfolded disk; the loops met, by the smaller dart.
    fn walk_round(&self, is_folded: &[bool], is_loop: &[bool]) -> Result<Vec<u32>, &'static str> {
        let rim = is_folded.iter().filter(|&&folded| !folded).count();
        let Some(first) = is_folded.iter().position(|&folded| !folded) else { return Ok(Vec::new()) };
        let mut word = Vec::new();
        let mut at = first;
        let mut met = 0;
        loop {
            met += 1;
            if is_loop[at] {
                word.push((at as u32).min(self.mate[at]));
            }
            at = self.next[at] as usize;
            let mut steps = 0;
            while is_folded[at] {
                at = self.next[self.mate[at] as usize] as usize;
                steps += 1;
                if steps > self.next.len() {
                    return Err("is badly linked");
                }
            }
            if at == first {
                break;
            }
            if met > rim {
                return Err("is badly linked");
            }
        }
        if met == rim { Ok(word) } else { Err("does not unfold into one disk") }
    }
}

fn find(root: &mut [u32], mut at: u32) -> u32 {
    while root[at as usize] != at {
        root[at as usize] = root[root[at as usize] as usize];
        at = root[at as usize];
    }
    at
}

/// Rows of bits: which letters of a cyclic word, each there twice, alternate with which.
fn alternations(word: &[u32]) -> Vec<Vec<u64>> {
    let mut letters: Vec<u32> = word.to_vec();
    letters.sort_unstable();
    letters.dedup();
    let letter: Vec<usize> = word.iter().map(|w| letters.partition_point(|l| l < w)).collect();
    let mut place = vec![[usize::MAX; 2]; letters.len()];
    for (k, &l) in letter.iter().enumerate() {
        let which = usize::from(place[l][0] != usize::MAX);
        place[l][which] = k;
    }
    let mut rows = vec![vec![0u64; letters.len().div_ceil(64)]; letters.len()];
    for (l, &[from, to]) in place.iter().enumerate() {
        // Letters met once between the two places alternate; those met twice cancel.
        for &other in &letter[from + 1..to] {
            rows[l][other / 64] ^= 1 << (other % 64);
        }
    }
    rows
}

fn rank_mod_2(mut rows: Vec<Vec<u64>>) -> usize {
    let mut rank = 0;
    for column in 0..rows.len() {
        let bit = |row: &[u64]| row[column / 64] >> (column % 64) & 1 == 1;
        let Some(pivot) = (rank..rows.len()).find(|&k| bit(&rows[k])) else { continue };
        rows.swap(rank, pivot);
        let (above, below) = rows.split_at_mut(rank + 1);
        for row in below.iter_mut().filter(|row| bit(row)) {
            row.iter_mut().zip(&above[rank]).for_each(|(a, b)| *a ^= b);
        }
        rank += 1;
    }
    rank
}
