//! Smooth supports: from facets to the true surfaces and curves that they stand for (thesis 2.6, 4.2.1).
//!
//! Reads [`crate::brep::complex::Complex`] (surfaces, facets, and the facets that the selection killed, which still shape the
//! patches) and gives `remesh` one [`support::Support`] per source surface, and [`curve::Curve`]s for its feature edges.
//!
//! | file | what |
//! |---|---|
//! | `support` | the one interface: closest point, normal and bending, distance |
//! | `plane`, `analytic`, `ellipsoid` | exact surfaces of primitives |
//! | `bspline` | bicubic least-squares patch with thin-plate or membrane term |
//! | `fit` | surfaces known by their facets: a patch for each |
//! | `sample` | the facets of a surface, and what lies beside what |
//! | `surroundings` | which points shape the patch of which facet; the 2 % rule |
//! | `curve` | lines, circles, polylines, and curves between surfaces |
//!
//! ```text
//! facet born from a cylinder  -> its exact cylinder
//! facet of an import          -> a B-spline patch over its neighbourhood, or its plane if the patch errs by over 2 %
//! rim of a cylinder           -> an exact circle; cylinder on cylinder -> Newton's method on both at once
//! ```

pub mod analytic;
pub mod bspline;
pub mod curve;
mod ellipsoid;
pub mod fit;
pub mod plane;
mod sample;
pub mod support;
mod surroundings;
