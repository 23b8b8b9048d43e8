//! gsm: from a scene of parts to one valid piecewise linear complex.
//!
//! ```text
//! scene.ron -- scene ------> parts as CSG trees with resolved numbers
//!           -- primitive --> leaf solids: closed shells of facets, each with its surface
//!           -- cull -------> where many leaves lie over one place, what cannot reach the result is set aside
//!           -- contact ----> what is meant to touch shares vertices; the one place with a tolerance
//!           -- arrangement > leaves cut against each other, exactly; conforming cells
//!           -- classify ---> labels: in or out of every leaf
//!           -- patch ------> smooth support of facets, while everything is still alive
//!           -- select -----> kill, retain or flip by the decision table
//!           -- round ------> f64 coordinates, verified -> B-rep with uses and regions
//!           -- remesh -----> collapse, swap, split, relocate
//!           -- position ---> what lies askew is moved by a trace, of which TetGen would die
//!           -- plc --------> .poly and manifest
//!           -- tetgen -----> volume mesh, verified -- io --> files for solvers -- report --> statistics
//! ```

// Nothing that a user gives may end the program.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

pub mod arrangement;
pub mod brep;
pub mod classify;
pub mod cli;
pub mod commands;
pub mod contact;
pub mod cull;
pub mod diag;
pub mod evaluate;
pub mod geom;
pub mod ids;
pub mod io;
pub mod patch;
pub mod pipeline;
pub mod plc;
pub mod position;
pub mod primitive;
pub mod remesh;
pub mod report;
pub mod round;
pub mod scene;
pub mod select;
pub mod tetgen;
