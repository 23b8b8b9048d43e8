//! What is meant to touch shares vertices: leaf solids to one [`conforming::Conforming`] set of cells.

pub mod conforming;
