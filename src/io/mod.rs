//! Files: one module per format, and safe writing.

pub mod atomic;
pub mod manifest;
pub mod poly;
