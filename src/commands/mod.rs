//! One command each, no geometry: read arguments, run the pipeline, write what was asked.

pub mod build;
pub mod check;
pub mod convert;
pub mod mesh;
pub mod new;
pub mod session;
pub mod usage;
