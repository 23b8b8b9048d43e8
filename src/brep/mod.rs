//! The facetted non-manifold boundary representation: topology with uses (thesis 2.2.3).

pub mod complex;
