//! The facetted non-manifold boundary representation: topology with uses (thesis 2.2.3).

pub mod build;
pub mod check;
mod collapse;
pub mod complex;
pub mod euler;
mod genus;
pub mod local;
pub mod model;
mod splice;
pub mod store;
mod tiles;
pub mod walk;

#[cfg(test)]
mod local_tests;
#[cfg(test)]
mod plate_tests;
#[cfg(test)]
mod samples;
#[cfg(test)]
mod tests;
