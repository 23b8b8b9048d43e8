//! The resolved scene: what the rest of the pipeline sees. No expressions, no units, no references are left.

use crate::declare_ids;
use crate::diag::Span;
use crate::geom::{Affine, Vec3};
use crate::ids::{IdVec, LeafId, PartId};
use std::collections::BTreeMap;
use std::path::PathBuf;

declare_ids! {
    /// A named boundary of the scene.
    BoundaryId;
}

/// A whole scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// File name without its extension.
    pub name: String,
    /// Name of the length unit of all numbers, e.g. `mm`.
    pub unit: String,
    /// SHA-256 of the scene text and of the parameters set from outside, in hexadecimal.
    pub hash: String,
    /// Contact tolerance as a fraction of the model's size (1e-9 unless given).
    pub tolerance: f64,
    /// What to do where parts overlap.
    pub overlap: Policy,
    /// What to do about parts that nearly touch.
    pub gaps: Policy,
    /// How interfaces are remeshed.
    pub remesh: RemeshOptions,
    /// How the volume is meshed.
    pub mesh: MeshOptions,
    /// Leaf solids, each in one place; the same solid in the same place is one leaf, however often it is used.
    pub leaves: IdVec<LeafId, Leaf>,
    /// Parts in file order; where they overlap, the later one takes the space.
    pub parts: IdVec<PartId, Part>,
    /// Named boundaries in file order.
    pub boundaries: IdVec<BoundaryId, Boundary>,
    /// What is asked of interfaces: by the names of the two parts, or of what they are copies of, or [`OUTER`]; sorted.
    pub interfaces: BTreeMap<[String; 2], Interface>,
}

/// Name of the outside and of voids, which no part can have.
pub const OUTER: &str = "outer";

/// What is asked of an interface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Interface {
    /// Largest edge length, in the scene's unit.
    pub max_edge: f64,
    /// Where it stands in the scene text.
    pub span: Span,
}

impl Scene {
    /// The entries of `interfaces` that name the interface between two parts (`None` is the outside or a void): at most four,
    /// since a copy goes by its own name and by that of all copies.
    pub fn interfaces_between(&self, parts: [Option<PartId>; 2]) -> impl Iterator<Item = (&[String; 2], &Interface)> {
        let names = parts.map(|part| match part.map(|p| &self.parts[p]) {
            None => [Some(OUTER), None],
            Some(part) => [Some(part.name.as_str()), part.copy_of.as_deref()],
        });
        let pairs =
            [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[i, j]| Some(sorted([names[0][i]?, names[1][j]?].map(str::to_owned))));
        pairs.into_iter().flatten().filter_map(|pair| self.interfaces.get_key_value(&pair))
    }
}

/// A key of [`Scene::interfaces`].
pub(super) fn sorted(mut names: [String; 2]) -> [String; 2] {
    names.sort_unstable();
    names
}

/// What to do about a finding that may be meant.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize, serde::Serialize)]
pub enum Policy {
    /// Take it as meant (overlaps: the later part takes the space; gaps: a warning).
    #[default]
    Allow,
    /// An error.
    Forbid,
}

/// How curved facets are remeshed.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct RemeshOptions {
    /// Which facets.
    pub mode: RemeshMode,
    /// What they stay on.
    pub patches: PatchMode,
    /// Largest distance from the true surface, in the scene's unit; if absent, 1.5 times what the discretization leaves.
    pub max_deviation: Option<f64>,
}

/// Which facets are remeshed.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize, serde::Serialize)]
pub enum RemeshMode {
    /// None.
    Off,
    /// Curved facets near curves that the intersection made; strips are cut there, and what lies further off stays as it is.
    #[default]
    Interfaces,
    /// All curved facets.
    Full,
}

/// The smooth supports that remeshed facets stay on.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize, serde::Serialize)]
pub enum PatchMode {
    /// The analytic surface where there is one, else a fitted patch.
    #[default]
    Analytic,
    /// Fitted bicubic B-spline patches everywhere, as in the thesis.
    BSpline,
}

/// What is asked of the tetrahedra.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeshOptions {
    /// Largest ratio of circumradius to shortest edge, at least 1 (TetGen's `-q`); 2.0 unless given.
    pub ratio: f64,
    /// Smallest dihedral angle in degrees, if given.
    pub dihedral: Option<f64>,
    /// What the finished mesh must reach.
    pub thresholds: Thresholds,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self { ratio: 2.0, dihedral: None, thresholds: Thresholds::default() }
    }
}

/// What a volume mesh must reach; `None` is no demand. Angles in degrees.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Thresholds {
    /// Smallest dihedral angle of any tetrahedron.
    pub min_dihedral: Option<f64>,
    /// Largest radius-edge ratio.
    pub max_ratio: Option<f64>,
    /// Largest aspect ratio R/r.
    pub max_aspect: Option<f64>,
    /// Smallest angle of any triangle.
    pub min_angle: Option<f64>,
    /// Largest condition number of the stiffness matrix.
    pub max_condition: Option<f64>,
}

impl Thresholds {
    /// These, and where they are silent the others.
    #[must_use]
    pub fn or(self, others: Self) -> Self {
        Self {
            min_dihedral: self.min_dihedral.or(others.min_dihedral),
            max_ratio: self.max_ratio.or(others.max_ratio),
            max_aspect: self.max_aspect.or(others.max_aspect),
            min_angle: self.min_angle.or(others.min_angle),
            max_condition: self.max_condition.or(others.max_condition),
        }
    }
}

/// A named solid that becomes one or more regions.
#[derive(Clone, Debug)]
pub struct Part {
    /// Unique name.
    pub name: String,
    /// The name that all its copies share, without their numbers, if it is one of a pattern.
    pub copy_of: Option<String>,
    /// Material name, if given.
    pub material: Option<String>,
    /// Which points it claims.
    pub solid: Node,
    /// Largest edge length on its curved surfaces, where they are remeshed.
    pub max_edge: Option<f64>,
    /// Largest wanted volume of a tetrahedron.
    pub max_volume: Option<f64>,
    /// Where the part stands in the scene text.
    pub span: Span,
}

/// A Boolean expression over leaves.
#[derive(Clone, PartialEq, Debug)]
pub enum Node {
    /// The points inside one leaf solid.
    Leaf(LeafId),
    /// An operation on any number of operands, in order; with none it is empty.
    Boolean(Operation, Vec<Node>),
}

/// A regularised set operation.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, serde::Deserialize, serde::Serialize)]
pub enum Operation {
    /// In any operand.
    Union,
    /// In the first operand and in none of the others.
    Difference,
    /// In all operands.
    Intersection,
    /// In an odd number of operands.
    Xor,
}

/// One primitive in one place.
#[derive(Clone, PartialEq, Debug)]
pub struct Leaf {
    /// Shape in its own coordinates.
    pub primitive: Primitive,
    /// From its own coordinates to the scene's; may mirror.
    pub transform: Affine,
    /// How curves are divided.
    pub division: Division,
    /// Contact tolerance of this leaf as a fraction of the model's size, where it differs from the scene's (imports).
    pub tolerance: Option<f64>,
    /// Whether ruled sides are the thesis' level-curve triangles instead of planar strips.
    pub is_triangulated: bool,
    /// Name given to the solid in the scene, for messages and named boundaries.
    pub name: Option<String>,
    /// Where it stands in the scene text.
    pub span: Span,
}

/// How finely a circle is divided; the finest of the given rules counts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Division {
    /// Chords per full circle.
    pub segments: Option<u32>,
    /// Largest angle of a chord, in radians.
    pub max_angle: Option<f64>,
    /// Largest distance of a chord from its arc, in the scene's unit.
    pub max_chord_error: Option<f64>,
}

/// A place for a primitive that is made about an axis: right-handed, orthonormal columns.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Frame {
    /// Where the local origin lies.
    pub origin: Vec3,
    /// Direction of angle 0 (for an axis z, x, y: +x, +y, +z).
    pub x: Vec3,
    /// Direction of angle 90 degrees.
    pub y: Vec3,
    /// The axis.
    pub z: Vec3,
}

/// A shape in its own coordinates.
#[derive(Clone, PartialEq, Debug)]
pub enum Primitive {
    /// Axis-parallel block, `lo < hi`. Sides: `x-`, `x+`, `y-`, `y+`, `z-`, `z+`.
    Block {
        /// Smallest corner.
        lo: Vec3,
        /// Largest corner.
        hi: Vec3,
    },
    /// Pyramid over a simple polygon in the frame's plane z = 0. Sides: `bottom`, `side1`.. in order of the polygon's edges.
    Pyramid {
        /// Its place.
        frame: Frame,
        /// Base polygon, either orientation.
        base: Vec<[f64; 2]>,
        /// Apex in the frame's coordinates.
        apex: Vec3,
    },
    /// Cylinder, cone or frustum about the frame's z axis, from z = 0 to z = height; a radius may be 0, not both.
    /// Sides: `bottom`, `top`, `side`.
    Cone {
        /// Its place.
        frame: Frame,
        /// Radius at z = 0.
        bottom_radius: f64,
        /// Radius at z = height.
        top_radius: f64,
        /// Height, positive.
        height: f64,
    },
    /// Ellipsoid (sphere) with half axes along the coordinate axes. Side: `side`.
    Ellipsoid {
        /// Centre.
        center: Vec3,
        /// Half axes.
        radii: Vec3,
    },
    /// Torus about the frame's z axis. Side: `side`.
    Torus {
        /// Its place.
        frame: Frame,
        /// Radius of the circle of centres.
        major_radius: f64,
        /// Radius of the tube, smaller than `major_radius`.
        minor_radius: f64,
    },
    /// A profile in the frame's plane z = 0, swept to z = length. Sides: `bottom`, `top`, then by profile segment:
    /// `side1`.. for the outer loop, `hole1_side1`.. for holes, or a segment's own name.
    Extrusion {
        /// Its place.
        frame: Frame,
        /// What is swept.
        profile: Profile,
        /// Length, positive.
        length: f64,
    },
    /// A profile in the frame's half plane (x = distance from the axis >= 0, y = height along z), turned about z from angle
    /// `start` by `angle` (radians, at most a full turn). Sides: by profile segment, and `start`, `end` if partial.
    Revolution {
        /// Its place.
        frame: Frame,
        /// What is turned.
        profile: Profile,
        /// First angle.
        start: f64,
        /// Swept angle, positive, at most 2 pi.
        angle: f64,
    },
    /// A profile swept along a path in the frame's plane z = 0; the profile's x points to the right of the direction of travel
    /// (seen from +z), its y along z. Corners are mitred. Sides: by profile segment, and `start`, `end` if open.
    PathSweep {
        /// Its place.
        frame: Frame,
        /// What is swept.
        profile: Profile,
        /// Where it goes.
        path: Path2,
    },
    /// A closed surface from a file. Sides: `surface`, or one per group of an OBJ file.
    Import {
        /// File to read, already resolved against the scene's folder and checked.
        path: PathBuf,
        /// Factor from the file's unit to the scene's.
        scale: f64,
    },
}

/// A plane figure: one outer loop and holes, all simple and disjoint; either orientation.
#[derive(Clone, PartialEq, Debug)]
pub struct Profile {
    /// Outer loop.
    pub outer: Path2,
    /// Holes.
    pub holes: Vec<Path2>,
}

/// A chain of lines and arcs in the plane.
#[derive(Clone, PartialEq, Debug)]
pub struct Path2 {
    /// First point.
    pub start: [f64; 2],
    /// Segments in order; each begins where the last ended.
    pub segments: Vec<Segment2>,
    /// Whether it ends where it began (its last segment then ends at `start` exactly).
    pub is_closed: bool,
}

/// One segment of a chain.
#[derive(Clone, PartialEq, Debug)]
pub struct Segment2 {
    /// Its end point.
    pub end: [f64; 2],
    /// Centre and turning sense, if it is a circular arc.
    pub arc: Option<Arc2>,
    /// Name of the side that it sweeps, if given.
    pub name: Option<String>,
}

/// A circular arc between the ends of its segment.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Arc2 {
    /// Centre.
    pub center: [f64; 2],
    /// Whether it turns counter-clockwise. Ends that coincide make a full circle.
    pub is_ccw: bool,
}

/// A named piece of a part's boundary.
#[derive(Clone, PartialEq, Debug)]
pub struct Boundary {
    /// Unique name.
    pub name: String,
    /// The part that it bounds.
    pub part: PartId,
    /// Which facets of the part's boundary.
    pub selection: BoundarySelection,
    /// Where it stands in the scene text.
    pub span: Span,
}

/// Which facets of a part's boundary get a name.
#[derive(Clone, PartialEq, Debug)]
pub enum BoundarySelection {
    /// All that face the outside.
    Outer,
    /// Those born from some leaves (several if the named solid is used several times in the part): of each the name of the
    /// side, as listed at [`Primitive`], or `None` for all its sides.
    Sides(Vec<(LeafId, Option<String>)>),
}
