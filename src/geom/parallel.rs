//! Threads where they are worth it.

/// Both results, on two threads at once if there is much to do: waking another one takes as long as little work.
pub fn both<A: Send, B: Send>(is_much: bool, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    if is_much { rayon::join(a, b) } else { (a(), b()) }
}
