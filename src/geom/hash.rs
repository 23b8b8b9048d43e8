//! A fast, fixed hash for small keys (multiply and rotate, as in the Rust compiler's own tables).
//!
//! The standard hasher is keyed at random and several times slower; maps here hold index keys that no outsider chooses. Maps
//! are looked up, never iterated into results.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};

/// Hasher state.
#[derive(Clone, Copy, Default, Debug)]
pub struct IndexHasher(u64);

/// Odd constant with well mixed bits (2^64 divided by the golden ratio).
const MIX: u64 = 0x9E37_79B9_7F4A_7C15;

impl Hasher for IndexHasher {
    fn finish(&self) -> u64 {
        // The table uses the top bits and the bottom bits: fold them.
        self.0 ^ (self.0 >> 32)
    }
    fn write(&mut self, bytes: &[u8]) {
        // Arrays of numbers come as bytes.
        let (words, rest) = bytes.as_chunks::<8>();
        words.iter().for_each(|w| self.write_u64(u64::from_le_bytes(*w)));
        rest.iter().for_each(|&b| self.write_u64(u64::from(b)));
    }
    fn write_u32(&mut self, x: u32) {
        self.write_u64(u64::from(x));
    }
    fn write_u64(&mut self, x: u64) {
        self.0 = (self.0.rotate_left(23) ^ x).wrapping_mul(MIX);
    }
    fn write_i64(&mut self, x: i64) {
        self.write_u64(x as u64);
    }
    fn write_usize(&mut self, x: usize) {
        self.write_u64(x as u64);
    }
}

/// A map with the fixed hash.
pub type IndexMap<K, V> = HashMap<K, V, BuildHasherDefault<IndexHasher>>;
/// A set with the fixed hash.
pub type IndexSet<K> = HashSet<K, BuildHasherDefault<IndexHasher>>;
