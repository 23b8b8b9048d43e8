//! Scene leaves to closed polygonal [`solid::Solid`]s: each facet knows its surface, each vertex its freedom.

pub mod solid;
