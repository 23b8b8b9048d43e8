//! Names of the sides of primitives, as `primitive` gives them to surfaces.

use super::model::{Path2, Primitive, Profile};

/// Other names of the sides of a block: its lower and upper side may be called as those of all other primitives.
const OF_BLOCK: [(&str, &str); 2] = [("bottom", "z-"), ("top", "z+")];

impl Primitive {
    /// The side that is called so in a scene; an import has what is in its file.
    pub(super) fn side_called(&self, written: &str) -> Option<String> {
        let is_block = matches!(self, Primitive::Block { .. });
        let own = OF_BLOCK.iter().find(|(name, _)| is_block && *name == written).map_or(written, |(_, own)| own);
        self.sides().is_none_or(|sides| sides.iter().any(|s| s == own)).then(|| own.to_owned())
    }

    /// All names that its sides can be called by in a scene.
    pub(super) fn names_of_sides(&self) -> Vec<String> {
        let others = OF_BLOCK.iter().filter(|_| matches!(self, Primitive::Block { .. })).map(|(name, _)| (*name).to_owned());
        self.sides().into_iter().flatten().chain(others).collect()
    }

    /// The names of its sides in order; `None` for an import, whose sides are in its file.
    pub fn sides(&self) -> Option<Vec<String>> {
        let owned = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect::<Vec<_>>();
        Some(match self {
            Primitive::Block { .. } => owned(&["x-", "x+", "y-", "y+", "z-", "z+"]),
            Primitive::Pyramid { base, .. } => {
                owned(&["bottom"]).into_iter().chain((1..=base.len()).map(|k| format!("side{k}"))).collect()
            }
            Primitive::Cone { bottom_radius, top_radius, .. } => {
                let has = [(*bottom_radius > 0.0, "bottom"), (*top_radius > 0.0, "top"), (true, "side")];
                has.iter().filter(|(is_there, _)| *is_there).map(|(_, name)| (*name).to_owned()).collect()
            }
            Primitive::Ellipsoid { .. } | Primitive::Torus { .. } => owned(&["side"]),
            Primitive::Extrusion { profile, .. } => owned(&["bottom", "top"]).into_iter().chain(profile.sides()).collect(),
            Primitive::Revolution { profile, angle, .. } => with_ends(profile, *angle < std::f64::consts::TAU),
            Primitive::PathSweep { profile, path, .. } => with_ends(profile, !path.is_closed),
            Primitive::Import { .. } => return None,
        })
    }
}

fn with_ends(profile: &Profile, has_ends: bool) -> Vec<String> {
    let mut sides = profile.sides();
    if has_ends {
        sides.extend(["start".to_owned(), "end".to_owned()]);
    }
    sides
}

impl Profile {
    /// The names of the sides that the segments sweep: those of the outer loop, then of the holes.
    pub fn sides(&self) -> Vec<String> {
        let named = |path: &Path2, prefix: &str| -> Vec<String> {
            let name =
                |(k, s): (usize, &super::model::Segment2)| s.name.clone().unwrap_or_else(|| format!("{prefix}side{}", k + 1));
            path.segments.iter().enumerate().map(name).collect()
        };
        let holes = self.holes.iter().enumerate().flat_map(|(h, hole)| named(hole, &format!("hole{}_", h + 1)));
        named(&self.outer, "").into_iter().chain(holes).collect()
    }
}
