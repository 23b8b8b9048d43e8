//! Lists of numbers by a number, without an allocation for each.

/// A numbered list of lists in one allocation.
#[derive(Default)]
pub struct Lists {
    first: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// `count` lists from pairs (list, item); each keeps the order of its pairs.
    pub fn new(count: usize, pairs: &[(u32, u32)]) -> Self {
        let mut first = vec![0; count + 1];
        pairs.iter().for_each(|p| first[p.0 as usize + 1] += 1);
        (0..count).for_each(|k| first[k + 1] += first[k]);
        let (mut next, mut items) = (first.clone(), vec![0; pairs.len()]);
        for &(list, item) in pairs {
            items[next[list as usize] as usize] = item;
            next[list as usize] += 1;
        }
        Self { first, items }
    }
    /// Whether all lists are empty.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }
    /// One list.
    pub fn of(&self, list: u32) -> &[u32] {
        &self.items[self.first[list as usize] as usize..self.first[list as usize + 1] as usize]
    }
}
