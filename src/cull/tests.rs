//! Piles of solids.
