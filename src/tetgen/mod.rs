//! Volume meshes by TetGen, run as a child: [`Input`] to [`Meshed`].
//!
//! ```text
//! find    which programs there are, and of what version
//! ladder  which attempts are made, cheapest in tetrahedra first
//! place   the complex as an attempt sees it (turned, bent, moved), and the way back
//! apart   which facets TetGen must not merge
//! child   one run: own folder, limits on time and memory, its messages kept
//! read    .node, .ele, .face
//! runaway whether a result is refined without end
//! thin    parts that would take very many tetrahedra
//! verify  what a result must satisfy to count; TetGen's exit code is not to be trusted
//! explain its messages as diagnostics with names and coordinates
//! ```
//!
//! TetGen 1.5.0 dies on valid complexes whose vertices are nearly cocircular, that is, on most rotated cylinders: assertion,
//! segmentation fault or endless loop. Two attempts that change nothing cure it. *Turned*: in the frame in which most facets
//! are parallel to an axis, with coordinates made equal that differ by rounding, TetGen's exact predicates see exact
//! coincidences. *Bent*: under a linear map that differs from the identity by 1e-4, facets stay planar and straight edges
//! straight, but no four vertices are cocircular any more. In both the vertices are put back afterwards, bit for bit. (24-gon
//! and 48-gon prisms and coaxial rings in 8 random rotations each: 5 of 24 as they are, 22 of 24 under a map of 1e-5, 24 of 24
//! under 1e-4.)
//!
//! Where it ends well, the mesh may still be wrong: see [`apart`] and, for points of facets that leave their facet, [`ladder`].

pub mod apart;
pub mod child;
pub mod explain;
pub mod find;
pub mod input;
pub mod ladder;
pub mod place;
pub mod read;
mod runaway;
pub mod thin;
pub mod verify;

pub use find::Program;
pub use input::Input;
pub use ladder::{Meshed, Options, mesh};
