//! A circle or arc of a leaf, divided as its axis says (see [`super::axis`]).

use super::angle;
use super::place::Place;
use crate::geom::Vec3;

/// A circle or arc that a leaf wants divided. It lies about the local line through `center`, parallel to the place's z axis;
/// what is swept along or about it may have any radius.
#[derive(Clone, Debug)]
pub(crate) struct CircleRequest {
    /// Where the leaf's frame lies.
    pub place: Place,
    /// Centre in the place's x, y.
    pub center: [f64; 2],
    /// Local angle at which it begins, degrees.
    pub start: f64,
    /// Degrees swept counter-clockwise, in (0, 360].
    pub sweep: f64,
    /// Whether somebody chose where a full circle begins.
    pub is_start_chosen: bool,
    /// Chords per full circle.
    pub segments: u32,
    /// Largest local distance from the axis.
    pub radius: f64,
    /// Local z where the surface begins and ends.
    pub heights: [f64; 2],
}

impl CircleRequest {
    /// Whether it goes all round.
    pub fn is_full(&self) -> bool {
        self.sweep >= 360.0
    }
    /// The ends of the piece of the axis that it uses, in the scene.
    pub fn axis_ends(&self) -> [Vec3; 2] {
        self.heights.map(|z| self.place.point(self.center[0], self.center[1], z))
    }
}

/// A direction about an axis.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Breakpoint {
    /// In the axis' own degrees, canonical: equal for all leaves that have it.
    pub degrees: f64,
    /// Degrees since the start of the circle or arc at hand, counter-clockwise in the leaf.
    pub along: f64,
    /// Whether a surface begins or ends there, in this leaf or another about the same axis.
    pub is_hard: bool,
}

/// The line that coaxial leaves agree on, and its angles.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// A point of it.
    pub origin: Vec3,
    /// Its direction, unit.
    pub z: Vec3,
    /// Direction of angle 0; unit unless the transform made ellipses.
    pub x: Vec3,
    /// Direction of angle 90 degrees.
    pub y: Vec3,
}

/// A circle or arc with its division.
#[derive(Clone, Debug)]
pub(crate) struct Circle {
    /// Where the leaf's frame lies.
    pub place: Place,
    /// Centre in the place's x, y.
    pub center: [f64; 2],
    /// The common axis.
    pub axis: Axis,
    /// Its number: circles with the same have their breakpoints in common.
    pub group: usize,
    /// From local radii to lengths along `axis.x`.
    pub scale: f64,
    /// Whether the leaf's own axis is the common one bit for bit.
    pub is_own_axis: bool,
    /// +1 if the leaf turns as the axis does, else -1.
    pub sense: f64,
    /// Division in the leaf's order; of a full circle, the first is not repeated.
    pub breakpoints: Vec<Breakpoint>,
    /// Whether it goes all round.
    pub is_full: bool,
    /// Local degrees of the first breakpoint.
    pub start: f64,
    /// Chords per full circle that were wanted (finest of all about this axis).
    pub segments: u32,
}

impl Circle {
    /// The point at `degrees` (the axis') and `radius` (local) about the axis, at local height `z`.
    ///
    /// Its offset from the axis has the same bits for every leaf with the same angle and radius, and its place on the axis
    /// is the leaf's own height: where radius and height agree, so do the points.
    pub fn point(&self, degrees: f64, radius: f64, z: f64) -> Vec3 {
        let own = self.place.point(self.center[0], self.center[1], z);
        if radius == 0.0 {
            return self.on_axis(own);
        }
        let (c, s) = angle::cos_sin(degrees);
        let r = radius * self.scale;
        self.on_axis(own) + (self.axis.x * (r * c) + self.axis.y * (r * s))
    }

    /// The point of the common axis at local height `z`.
    pub fn axis_point(&self, z: f64) -> Vec3 {
        self.on_axis(self.place.point(self.center[0], self.center[1], z))
    }

    /// From local radii to lengths in the scene; a mean of them for an ellipse.
    pub fn length(&self) -> f64 {
        self.scale * (self.axis.x.norm() * self.axis.y.norm()).sqrt()
    }

    /// The nearest point of the common axis.
    fn on_axis(&self, own: Vec3) -> Vec3 {
        if self.is_own_axis {
            return own;
        }
        let away = own - self.axis.origin;
        own - (away - self.axis.z * away.dot(&self.axis.z))
    }
}
