//! What changed when: so that nothing is tried again where nothing has changed since it failed.

use crate::ids::{FacetId, Id, VertexId};

/// Counts changes; every entry is the count at which something happened last.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    now: u32,
    /// By vertex: a change of a facet there.
    changed: Vec<u32>,
    /// By vertex: no better place was found for it.
    searched: Vec<u32>,
    /// By facet: nothing was found to mend it.
    tried: Vec<u32>,
    /// All that changed before was looked at in a polish.
    polished: u32,
}

impl History {
    /// Everything may have changed.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// What has changed so far is about to be polished.
    pub fn start_polish(&mut self) {
        self.polished = self.now + 1;
    }

    /// Something changed at some vertices.
    pub fn change(&mut self, vertices: impl Iterator<Item = VertexId>) {
        self.now += 1;
        for v in vertices {
            set(&mut self.changed, v.index(), self.now);
        }
    }

    /// Whether a vertex is to be looked at in this polish.
    pub fn is_new(&self, vertex: VertexId) -> bool {
        get(&self.changed, vertex.index()) >= self.polished
    }

    /// No better place was found for a vertex.
    pub fn keep(&mut self, vertex: VertexId) {
        set(&mut self.searched, vertex.index(), self.now + 1);
    }

    /// Whether that was found since anything changed around it.
    pub fn is_kept(&self, vertex: VertexId) -> bool {
        get(&self.searched, vertex.index()) > get(&self.changed, vertex.index())
    }

    /// Nothing was found to mend a facet.
    pub fn give_up(&mut self, facet: FacetId) {
        set(&mut self.tried, facet.index(), self.now + 1);
    }

    /// Whether that was found since anything changed around its corners.
    pub fn is_hopeless(&self, facet: FacetId, corners: [VertexId; 3]) -> bool {
        let tried = get(&self.tried, facet.index());
        corners.iter().all(|v| tried > get(&self.changed, v.index()))
    }
}

fn get(list: &[u32], index: usize) -> u32 {
    list.get(index).copied().unwrap_or(0)
}

fn set(list: &mut Vec<u32>, index: usize, value: u32) {
    if list.len() <= index {
        list.resize(index + 1, 0);
    }
    list[index] = value;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_tried_twice_unless_something_changed() {
        let mut history = History::default();
        let [a, b, c] = [0, 1, 2].map(VertexId);
        assert!(history.is_new(a) && !history.is_kept(a) && !history.is_hopeless(FacetId(7), [a, b, c]));
        history.start_polish();
        assert!(!history.is_new(a));
        history.keep(a);
        history.give_up(FacetId(7));
        assert!(history.is_kept(a) && history.is_hopeless(FacetId(7), [a, b, c]));
        history.change([b].into_iter());
        assert!(history.is_kept(a) && !history.is_kept(b) && !history.is_hopeless(FacetId(7), [a, b, c]));
        assert!(history.is_new(b) && !history.is_new(a));
        history.forget();
        assert!(history.is_new(a) && !history.is_kept(a));
    }
}
