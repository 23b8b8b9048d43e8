//! Lists by a number, without an allocation for each.

use std::ops::Range;

/// A numbered list of lists in one allocation.
#[derive(Clone, PartialEq, Debug)]
pub struct Lists<T = u32> {
    first: Vec<u32>,
    items: Vec<T>,
}

impl<T> Default for Lists<T> {
    fn default() -> Self {
        Self { first: vec![0], items: Vec::new() }
    }
}

impl<T: Copy + Default> Lists<T> {
    /// No lists yet, but room for so many and for so many items in all.
    pub fn with_capacity(lists: usize, items: usize) -> Self {
        let mut first = Vec::with_capacity(lists + 1);
        first.push(0);
        Self { first, items: Vec::with_capacity(items) }
    }
    /// `count` lists from pairs (list, item); each keeps the order of its pairs.
    pub fn new(count: usize, pairs: &[(u32, T)]) -> Self {
        Self::from_iter(count, pairs.iter().copied())
    }
    /// The same from pairs that are made twice.
    pub fn from_iter(count: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        // First and then next place of each list, one further up.
        let mut first = vec![0u32; count + 2];
        pairs.clone().for_each(|p| first[p.0 as usize + 2] += 1);
        (2..count + 2).for_each(|k| first[k] += first[k - 1]);
        let mut items = vec![T::default(); first[count + 1] as usize];
        for (list, item) in pairs {
            let next = &mut first[list as usize + 1];
            items[*next as usize] = item;
            *next += 1;
        }
        first.pop();
        Self { first, items }
    }
    /// Adds a list behind the others.
    pub fn push(&mut self, list: impl IntoIterator<Item = T>) {
        self.items.extend(list);
        self.first.push(self.items.len() as u32);
    }
    /// All lists in order.
    pub fn iter(&self) -> impl Iterator<Item = &[T]> + Clone {
        self.first.windows(2).map(|ends| &self.items[ends[0] as usize..ends[1] as usize])
    }
    /// The items of all lists, one list after the other.
    pub fn items(&self) -> &[T] {
        &self.items
    }
    /// The same, to be changed.
    pub fn items_mut(&mut self) -> &mut [T] {
        &mut self.items
    }
    /// Whether all lists are empty.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }
    /// Number of lists.
    pub fn count(&self) -> usize {
        self.first.len() - 1
    }
    /// Where one list begins and ends among all items.
    pub fn range(&self, list: u32) -> Range<usize> {
        self.first[list as usize] as usize..self.first[list as usize + 1] as usize
    }
    /// One list.
    pub fn of(&self, list: u32) -> &[T] {
        &self.items[self.range(list)]
    }
    /// One list, to be sorted.
    pub fn of_mut(&mut self, list: u32) -> &mut [T] {
        let range = self.range(list);
        &mut self.items[range]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_list_keeps_its_order() {
        let lists = Lists::new(4, &[(2, 'a'), (0, 'b'), (2, 'c'), (3, 'd')]);
        assert_eq!([0, 1, 2, 3].map(|k| lists.of(k).iter().collect::<String>()), ["b", "", "ac", "d"]);
        assert_eq!(lists.iter().map(<[char]>::len).collect::<Vec<_>>(), [1, 0, 2, 1]);
        let mut more = lists.clone();
        more.push("ef".chars());
        assert_eq!((more.count(), more.of(4), more.items().len()), (5, &['e', 'f'][..], 6));
        assert!(!lists.is_empty() && Lists::<u32>::new(2, &[]).of(1).is_empty());
    }
}
