//! Text to [`Scene`]: reads RON, binds names, parameters and units, and reports every fault with its place.
//!
//! Gives [`model::Scene`] to `primitive`: numbers only, in one unit; all names resolved; CSG trees over leaf solids.

pub mod model;
