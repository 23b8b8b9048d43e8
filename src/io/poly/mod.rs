//! TetGen's .poly and .smesh files.
//!
//! Written: vertices numbered from 1, coordinates in the shortest form that reads back to the same bits, a legend of markers
//! and regions as comments. Read: any .poly or .smesh as TetGen reads it, numbered from 0 or 1, as untrusted input.

mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::{is_plc, parse, read};
pub use write::to_text;
pub(super) use write::volumes;
