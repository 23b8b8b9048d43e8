//! The scene as it is written: one type per node of the language, read by `ron` through `serde`.
//!
//! All fields are optional here and hold their text; [`super::reader`] says what is missing or wrong, with its place.

use super::fields::{self, Name, Stray, Written};
use super::source::{Field, Raw};
use serde::Deserialize;
use serde::de::{EnumAccess, Error, VariantAccess};

macro_rules! nodes {
    ($($name:ident { $($field:ident),* $(,)? })*) => {$(
        #[derive(Default)]
        pub(super) struct $name<'a> {
            $(pub $field: Field<'a>,)*
            strays: Vec<Stray<'a>>,
        }
        impl<'de: 'a, 'a> Deserialize<'de> for $name<'a> {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let (values, strays) = fields::read(deserializer, stringify!($name), &[$(stringify!($field)),*])?;
                let mut values = values.into_iter();
                Ok(Self { $($field: values.next().unwrap_or_default(),)* strays })
            }
        }
        impl<'a> Written<'a> for $name<'a> {
            fn take_strays(&mut self, _: Raw<'a>) -> Vec<Stray<'a>> {
                std::mem::take(&mut self.strays)
            }
        }
    )*};
}

/// Kinds that hold a node or another value each.
macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident { $($kind:ident($content:ty)),* $(,)? })*) => {$(
        $(#[$doc])*
        pub(super) enum $name<'a> { $($kind($content),)* }
        impl<'a> $name<'a> {
            const KINDS: &'static [&'static str] = &[$(stringify!($kind)),*];
        }
        impl<'de: 'a, 'a> Deserialize<'de> for $name<'a> {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                struct Visitor;
                impl<'de> serde::de::Visitor<'de> for Visitor {
                    type Value = $name<'de>;
                    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                        f.write_str(stringify!($name))
                    }
                    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Self::Value, A::Error> {
                        let (Name(found), content) = data.variant()?;
                        match fields::kind_meant_by(found, $name::KINDS) {
                            $(Some(stringify!($kind)) => content.newtype_variant().map($name::$kind),)*
                            _ => Err(A::Error::unknown_variant(found, $name::KINDS)),
                        }
                    }
                }
                deserializer.deserialize_enum(stringify!($name), Self::KINDS, Visitor)
            }
        }
        impl<'a> Written<'a> for $name<'a> {
            fn take_strays(&mut self, raw: Raw<'a>) -> Vec<Stray<'a>> {
                let (kind, mut strays) = match self {
                    $(Self::$kind(content) => (stringify!($kind), content.take_strays(raw)),)*
                };
                strays.extend(Stray::kind(raw, kind, Self::KINDS));
                strays
            }
        }
    )*};
}

/// Fields that every primitive has.
#[derive(Clone, Copy)]
pub(super) struct Common<'a> {
    pub name: Field<'a>,
    pub discretization: Field<'a>,
    pub triangulated: Field<'a>,
}

macro_rules! primitives {
    ($($name:ident { $($field:ident),* $(,)? })*) => {
        nodes! { $($name { $($field,)* name, discretization, triangulated })* }
        $(impl<'a> $name<'a> {
            pub fn common(&self) -> Common<'a> {
                Common { name: self.name, discretization: self.discretization, triangulated: self.triangulated }
            }
        })*
    };
}

nodes! {
    Scene { units, tolerance, overlap, gaps, params, discretization, triangulated, remesh, max_deviation, patches, mesh, solids, parts, interfaces }
    Part { name, material, solid, copies, max_edge, max_volume, discretization, triangulated, boundaries }
    Discretization { segments, max_angle, max_chord_error }
    Mesh { ratio, dihedral, min_dihedral, max_ratio, max_aspect, min_angle, max_condition }
    Interface { max_edge }
    Outer { name }
    Side { name, of, side }
    Translate { by, solid }
    Rotate { axis, angle, center, solid }
    Scale { by, center, solid }
    Mirror { normal, center, solid }
    Linear { count, step, solid }
    Polar { count, axis, center, step, solid }
    Circle { radius, diameter, center, start }
    Rectangle { min, max, size, center, at }
    RoundedRectangle { min, max, size, center, at, radius }
    RegularPolygon { sides, radius, center, start }
    PathNode { start, segments, closed }
    Line { to, name }
    Arc { to, center, via, radius, angle, ccw, large, name }
}

primitives! {
    Block { min, max, size, center, at }
    Prism { sides, radius, polygon, height, base, axis, x_axis, start }
    Pyramid { sides, radius, polygon, height, apex, base, axis, x_axis, start }
    Cylinder { radius, diameter, height, base, axis, x_axis, start }
    Tube { outer_radius, inner_radius, height, base, axis, x_axis, start }
    Cone { radius, diameter, height, base, axis, x_axis, start }
    Frustum { bottom_radius, top_radius, height, base, axis, x_axis, start }
    Sphere { radius, diameter, center }
    Ellipsoid { radii, center }
    Torus { major_radius, minor_radius, center, axis, x_axis, start }
    Extrude { profile, holes, height, base, axis, x_axis }
    Revolve { profile, holes, angle, start, base, axis, x_axis }
    Sweep { profile, holes, path, base, axis, x_axis }
    Import { file, unit, scale, tolerance }
}

kinds! {
    /// A solid.
    Solid {
        Block(Block<'a>),
        Prism(Prism<'a>),
        Pyramid(Pyramid<'a>),
        Cylinder(Cylinder<'a>),
        Tube(Tube<'a>),
        Cone(Cone<'a>),
        Frustum(Frustum<'a>),
        Sphere(Sphere<'a>),
        Ellipsoid(Ellipsoid<'a>),
        Torus(Torus<'a>),
        Extrude(Extrude<'a>),
        Revolve(Revolve<'a>),
        Sweep(Sweep<'a>),
        Import(Import<'a>),
        Union(Vec<Raw<'a>>),
        Difference(Vec<Raw<'a>>),
        Intersection(Vec<Raw<'a>>),
        Xor(Vec<Raw<'a>>),
        Translate(Translate<'a>),
        Rotate(Rotate<'a>),
        Scale(Scale<'a>),
        Mirror(Mirror<'a>),
        Linear(Linear<'a>),
        Polar(Polar<'a>),
        Use(String),
    }
    /// Copies of a part.
    Copies {
        Linear(Linear<'a>),
        Polar(Polar<'a>),
    }
    /// A named boundary of a part.
    Boundary {
        Outer(Outer<'a>),
        Side(Side<'a>),
    }
    /// A closed or open curve in the plane.
    Curve {
        Circle(Circle<'a>),
        Rectangle(Rectangle<'a>),
        RoundedRectangle(RoundedRectangle<'a>),
        RegularPolygon(RegularPolygon<'a>),
        Polygon(Vec<Raw<'a>>),
        Path(PathNode<'a>),
    }
    /// A piece of a path.
    Segment {
        Line(Line<'a>),
        Arc(Arc<'a>),
    }
}

/// A coordinate axis.
#[derive(Clone, Copy, Deserialize)]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

/// The values between parentheses, however many.
pub(super) struct Values<'a>(pub Vec<Raw<'a>>);

impl<'de: 'a, 'a> Deserialize<'de> for Values<'a> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = Vec<Raw<'de>>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("values in parentheses (x, y, z)")
            }
            fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = seq.next_element()? {
                    values.push(value);
                }
                Ok(values)
            }
        }
        // The reader of RON goes on to the closing parenthesis, whatever number it is told.
        deserializer.deserialize_tuple(3, Visitor).map(Values)
    }
}

/// Entries of a map in the order in which they are written, none lost when keys repeat (serde's own maps keep the last).
pub(super) struct Entries<'a>(pub Vec<(Raw<'a>, Raw<'a>)>);

impl<'de: 'a, 'a> Deserialize<'de> for Entries<'a> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = Vec<(Raw<'de>, Raw<'de>)>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a map {\"name\": value, ..}")
            }
            fn visit_map<A: serde::de::MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(entries)
            }
        }
        deserializer.deserialize_map(Visitor).map(Entries)
    }
}
