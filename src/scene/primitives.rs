//! Primitives other than sweeps, as they are written to [`Primitive`].

use super::ast::{self, Common};
use super::curves::regular_polygon;
use super::frames::FrameFields;
use super::model::{Frame, Primitive, Profile};
use super::reader::{Owner, Reader};
use super::source::{Field, Raw};
use super::tree::{LocalLeaf, Tree};
use crate::geom::Vec3;
use std::rc::Rc;

/// Largest number of sides of a regular polygon; more is a circle.
pub(super) const MAX_SIDES: u32 = 100_000;

macro_rules! frame_fields {
    ($node:expr) => {
        FrameFields { base: $node.base, axis: $node.axis, x_axis: $node.x_axis, start: $node.start }
    };
}

impl<'a> Reader<'a> {
    /// A primitive with its name and settings.
    pub fn leaf(
        &mut self,
        owner: Owner<'a>,
        common: Common<'a>,
        primitive: Option<Primitive>,
        tolerance: Option<f64>,
    ) -> Option<Rc<Tree>> {
        let name = self.maybe(common.name, |r, raw| r.name("name of a solid", raw));
        let division = self.maybe(common.discretization, Self::division);
        let is_triangulated = self.maybe(common.triangulated, |r, raw| r.read(raw));
        let span = self.span(owner.raw);
        Some(Rc::new(Tree::Leaf(Box::new(LocalLeaf {
            primitive: primitive?,
            division: division?,
            is_triangulated: is_triangulated?,
            tolerance,
            name: name?,
            span,
        }))))
    }

    /// Two opposite corners, from `min` and `max`, or `size` with `center` or with the smallest corner `at` (default: origin).
    pub fn block(&mut self, owner: Owner<'a>, node: &ast::Block<'a>) -> Option<Primitive> {
        if node.min.0.is_none() && node.max.0.is_none() && node.size.0.is_none() {
            let hint = "write `min: (x, y, z), max: (x, y, z)`, or `size: (x, y, z)` with `at` (lowest corner) or `center`";
            return self.fail(owner.raw, "missing-field", "Block needs `min` and `max`, or `size`", hint);
        }
        if let Some(raw) = node.size.0 {
            if let Some(other) = node.min.0.or(node.max.0) {
                return self.fail(other, "conflict", "Block has `size` as well as `min` or `max`", "leave out one of them");
            }
            let size = self.sizes("size", raw);
            let lo = self.corner(node.center, node.at, size);
            return lo.zip(size).map(|(lo, size)| Primitive::Block { lo, hi: lo + size });
        }
        let lo = self.need(owner, "min", node.min).and_then(|raw| self.point("min", raw));
        let hi = self.need(owner, "max", node.max).and_then(|raw| self.point("max", raw));
        let (lo, hi) = (lo?, hi?);
        if lo.zip_map(&hi, |l, h| h - l).min() < super::reader::MIN_SIZE {
            let axis = (0..3).find(|&k| hi[k] - lo[k] < super::reader::MIN_SIZE).unwrap_or(0);
            let (name, lo, hi) = (["x", "y", "z"][axis], lo[axis], hi[axis]);
            let message = format!("`max` of the Block must be larger than `min`; in {name} it goes from {lo} to {hi}");
            return self.fail(owner.raw, "not-positive", message, "exchange the coordinates, or check the parameters");
        }
        Some(Primitive::Block { lo, hi })
    }

    fn corner(&mut self, center: Field<'a>, at: Field<'a>, size: Option<Vec3>) -> Option<Vec3> {
        match (center.0, at.0) {
            (Some(_), Some(raw)) => self.fail(
                raw,
                "conflict",
                "Block has both `center` and `at`",
                "leave out one of them: `at` is the lowest corner",
            ),
            (Some(raw), None) => Some(self.point("center", raw)? - size? * 0.5),
            _ => self.point_or_origin("at", at),
        }
    }

    /// A polygon in the plane: regular, or written.
    fn base_polygon(
        &mut self,
        owner: Owner<'a>,
        sides: Field<'a>,
        radius: Field<'a>,
        polygon: Field<'a>,
    ) -> Option<Vec<[f64; 2]>> {
        if let Some(raw) = polygon.0 {
            if let Some(other) = sides.0.or(radius.0) {
                let message = format!("{} has `polygon` as well as `sides` or `radius`", owner.kind);
                return self.fail(other, "conflict", message, "leave out one of them");
            }
            return self.polygon(raw);
        }
        let count = self.need(owner, "sides", sides).and_then(|raw| self.count("sides", raw, 3, MAX_SIDES));
        let radius = self.needed_size(owner, "radius", radius);
        Some(regular_polygon(count?, radius?, [0.0; 2], 0.0))
    }

    /// A prism is an extruded polygon.
    pub fn prism(&mut self, owner: Owner<'a>, node: &ast::Prism<'a>) -> Option<Primitive> {
        let polygon = self.base_polygon(owner, node.sides, node.radius, node.polygon);
        let length = self.needed_size(owner, "height", node.height);
        let frame = self.frame(owner, frame_fields!(node));
        let profile = Profile { outer: super::curves::closed_polyline(&polygon?), holes: Vec::new() };
        self.check_profile(owner, &profile)?;
        Some(Primitive::Extrusion { frame: frame?, profile, length: length? })
    }

    /// A pyramid, its apex above the frame's origin unless said otherwise.
    pub fn pyramid(&mut self, owner: Owner<'a>, node: &ast::Pyramid<'a>) -> Option<Primitive> {
        let base = self.base_polygon(owner, node.sides, node.radius, node.polygon);
        let apex = match (node.apex.0, node.height.0) {
            (Some(_), Some(raw)) => self.fail(raw, "conflict", "Pyramid has both `height` and `apex`", "leave out one of them"),
            (Some(raw), None) => self.point("apex", raw).and_then(|apex| match apex.z {
                z if z >= super::reader::MIN_SIZE => Some(apex),
                _ => {
                    let hint = "the apex is written from the base, along `axis`; to point down, turn the axis";
                    self.fail(raw, "not-positive", "the apex must lie above the base: its z must be positive", hint)
                }
            }),
            _ => self.needed_size(owner, "height", node.height).map(|height| Vec3::new(0.0, 0.0, height)),
        };
        let frame = self.frame(owner, frame_fields!(node));
        let base = base?;
        let profile = Profile { outer: super::curves::closed_polyline(&base), holes: Vec::new() };
        self.check_profile(owner, &profile)?;
        Some(Primitive::Pyramid { frame: frame?, base, apex: apex? })
    }

    /// Cylinder.
    pub fn cylinder(&mut self, owner: Owner<'a>, node: &ast::Cylinder<'a>) -> Option<Primitive> {
        let radius = self.radius(owner, node.radius, node.diameter);
        let height = self.needed_size(owner, "height", node.height);
        let frame = self.frame(owner, frame_fields!(node));
        let radius = radius?;
        Some(Primitive::Cone { frame: frame?, bottom_radius: radius, top_radius: radius, height: height? })
    }

    /// Tube: an extruded ring with sides `outer` and `inner`.
    pub fn tube(&mut self, owner: Owner<'a>, node: &ast::Tube<'a>) -> Option<Primitive> {
        let outer = self.needed_size(owner, "outer_radius", node.outer_radius);
        let inner = self.needed_size(owner, "inner_radius", node.inner_radius);
        let length = self.needed_size(owner, "height", node.height);
        let frame = self.frame(owner, frame_fields!(node));
        let (outer, inner) = (outer?, inner?);
        if inner >= outer {
            let raw = node.inner_radius.0.unwrap_or(owner.raw);
            return self.fail(
                raw,
                "not-positive",
                format!("`inner_radius` {inner} must be smaller than `outer_radius` {outer}"),
                "exchange them, or check the parameters",
            );
        }
        let circle = |radius, name: &str| super::curves::circle([0.0; 2], radius, 0.0, Some(name.to_owned()));
        let profile = Profile { outer: circle(outer, "outer"), holes: vec![circle(inner, "inner")] };
        Some(Primitive::Extrusion { frame: frame?, profile, length: length? })
    }

    /// Cone with its apex at the top.
    pub fn cone(&mut self, owner: Owner<'a>, node: &ast::Cone<'a>) -> Option<Primitive> {
        let radius = self.radius(owner, node.radius, node.diameter);
        let height = self.needed_size(owner, "height", node.height);
        let frame = self.frame(owner, frame_fields!(node));
        Some(Primitive::Cone { frame: frame?, bottom_radius: radius?, top_radius: 0.0, height: height? })
    }

    /// Frustum of a cone; one radius may be 0.
    pub fn frustum(&mut self, owner: Owner<'a>, node: &ast::Frustum<'a>) -> Option<Primitive> {
        let bottom = self.radius_or_zero(owner, "bottom_radius", node.bottom_radius);
        let top = self.radius_or_zero(owner, "top_radius", node.top_radius);
        let height = self.needed_size(owner, "height", node.height);
        let frame: Option<Frame> = self.frame(owner, frame_fields!(node));
        let (bottom_radius, top_radius) = (bottom?, top?);
        if bottom_radius.max(top_radius) == 0.0 {
            let message = "only one radius of a Frustum may be 0";
            return self.fail(owner.raw, "not-positive", message, "write a positive radius at its wide end");
        }
        Some(Primitive::Cone { frame: frame?, bottom_radius, top_radius, height: height? })
    }

    fn radius_or_zero(&mut self, owner: Owner<'a>, label: &str, field: Field<'a>) -> Option<f64> {
        let raw = self.need(owner, label, field)?;
        match self.length(label, raw)? {
            0.0 => Some(0.0),
            _ => self.size(label, raw),
        }
    }

    /// Sphere.
    pub fn sphere(&mut self, owner: Owner<'a>, node: &ast::Sphere<'a>) -> Option<Primitive> {
        let radius = self.radius(owner, node.radius, node.diameter);
        let center = self.point_or_origin("center", node.center);
        Some(Primitive::Ellipsoid { center: center?, radii: Vec3::repeat(radius?) })
    }

    /// Ellipsoid with half axes along x, y, z.
    pub fn ellipsoid(&mut self, owner: Owner<'a>, node: &ast::Ellipsoid<'a>) -> Option<Primitive> {
        let radii = self.need(owner, "radii", node.radii).and_then(|raw| self.sizes("radii", raw));
        let center = self.point_or_origin("center", node.center);
        Some(Primitive::Ellipsoid { center: center?, radii: radii? })
    }

    /// Torus.
    pub fn torus(&mut self, owner: Owner<'a>, node: &ast::Torus<'a>) -> Option<Primitive> {
        let major = self.needed_size(owner, "major_radius", node.major_radius);
        let minor = self.needed_size(owner, "minor_radius", node.minor_radius);
        let fields = FrameFields { base: node.center, axis: node.axis, x_axis: node.x_axis, start: node.start };
        let frame = self.frame(owner, fields);
        let (major_radius, minor_radius) = (major?, minor?);
        if minor_radius >= major_radius {
            let message = format!("`minor_radius` {minor_radius} must be smaller than `major_radius` {major_radius}");
            let at = node.minor_radius.0.unwrap_or(owner.raw);
            return self.fail(
                at,
                "out-of-range",
                message,
                "`major_radius` reaches to the middle of the tube, whose own is `minor_radius`",
            );
        }
        Some(Primitive::Torus { frame: frame?, major_radius, minor_radius })
    }

    /// A list of points.
    pub fn polygon(&mut self, raw: Raw<'a>) -> Option<Vec<[f64; 2]>> {
        let list: Vec<Raw> = self.read(raw)?;
        self.points(raw, &list)
    }

    /// At least three points.
    pub fn points(&mut self, raw: Raw<'a>, list: &[Raw<'a>]) -> Option<Vec<[f64; 2]>> {
        let points: Vec<Option<[f64; 2]>> = list.iter().map(|&point| self.point2("point", point)).collect();
        let points: Vec<[f64; 2]> = points.into_iter().collect::<Option<_>>()?;
        if points.len() < 3 {
            let message = format!("a polygon needs three points at least, here are {}", points.len());
            return self.fail(raw, "wrong-length", message, "write [(x, y), (x, y), (x, y)]; the last one joins the first");
        }
        Some(points)
    }
}
