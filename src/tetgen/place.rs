//! The complex as one attempt sees it, and the way back.

use super::input::Input;
use crate::diag::Severity;
use crate::geom::Vec3;
use crate::geom::polygon::vector_area;
use crate::ids::Id;
use crate::io::mesh::{Mesh, NodeId};
use crate::plc::facet::triangulate_facet;
use crate::plc::{Plc, PlcFacet, check};
use nalgebra::Matrix3;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Coordinates in the turned frame are made equal if they agree to this fraction of the size: some thousand units in the last
/// place, what turning leaves of equal ones; far below the contact tolerance, so that nothing that differs is joined.
const EQUAL: f64 = 1e-12;
/// Normals count as parallel or perpendicular to this angle, in radians: small facets have less exact normals.
const PARALLEL: f64 = 1e-7;
/// Larger facets stay whole where strips are split: their diagonals, kept as segments, would cost tetrahedra, and their needles
/// shape.
const STRIP_CORNERS: usize = 4;

/// A change of the vertices.
#[derive(Clone, PartialEq, Debug)]
pub enum Place {
    /// None.
    AsIs,
    /// Into a frame (rows are its axes) in which most facets are parallel to an axis.
    Turned(Matrix3<f64>),
    /// By a linear map near the identity; a fraction of the size, and which of many.
    Bent(f64, u64),
    /// None; strips fall apart into their two triangles, which TetGen 1.6 does not lose, and no facets are merged (`-M`): 1.6
    /// does so at small angles whatever the markers.
    Split,
    /// Each vertex at random by at most a fraction of the size; facets fall apart into their triangles. Not undone.
    Moved(f64, u64),
}

impl Place {
    /// The frame of the complex, if it has one that is not already that of the coordinates.
    pub fn turned(input: &Input) -> Option<Self> {
        let axes = dominant_axes(input)?;
        let is_trivial = axes.row_iter().all(|r| r.iter().filter(|x| x.abs() > EQUAL).count() == 1);
        (!is_trivial).then_some(Self::Turned(axes))
    }

    /// The complex under this change. Seeds and hole points go along.
    pub fn apply(&self, input: &Input) -> Input {
        let plc = &input.plc;
        let mut changed = input.clone();
        match *self {
            Self::AsIs => {}
            Self::Split => changed = split(&changed, STRIP_CORNERS),
            Self::Turned(axes) => {
                map(&mut changed.plc, &axes, &center(plc));
                equalise(&mut changed.plc.vertices, EQUAL * plc.size());
            }
            Self::Bent(amount, seed) => map(&mut changed.plc, &bend(amount, seed), &center(plc)),
            Self::Moved(amount, seed) => {
                shake(&mut changed.plc.vertices, amount * plc.size(), seed);
                // Where they are now: a corner that was straight but for rounding may have gone to the other side.
                for (facet, triangles) in changed.plc.facets.iter().zip(&mut changed.triangles) {
                    if let Ok(new) = triangulate_facet(facet, &changed.plc.vertices) {
                        *triangles = new;
                    }
                }
                changed = split(&changed, usize::MAX);
            }
        }
        changed
    }

    /// The complex that a result, put back, must be a mesh of.
    pub fn outcome<'a>(&self, input: &'a Input) -> Cow<'a, Input> {
        match self {
            Self::Moved(..) => Cow::Owned(self.apply(input)),
            _ => Cow::Borrowed(input),
        }
    }

    /// Whether the changed complex is still one, exactly.
    pub fn is_valid(&self, input: &Input) -> bool {
        check::check(&self.apply(input).plc, None).iter().all(|f| f.severity == Severity::Warning)
    }

    /// Puts the nodes of a result back. Those that were vertices get their coordinates bit for bit, except when they were
    /// moved.
    pub fn restore(&self, given: &Plc, mesh: &mut Mesh) {
        let inverse = match *self {
            Self::AsIs | Self::Split | Self::Moved(..) => None,
            Self::Turned(axes) => Some(axes.transpose()),
            Self::Bent(amount, seed) => bend(amount, seed).try_inverse(),
        };
        if let Some(inverse) = inverse {
            let center = center(given);
            mesh.nodes.iter_mut().for_each(|p| *p = inverse * *p + center);
        }
        if !matches!(self, Self::Moved(..)) {
            for (k, p) in given.vertices.iter().enumerate().take(mesh.nodes.len()) {
                mesh.nodes[NodeId::new(k)] = *p;
            }
        }
    }

    /// By how much lengths may differ from those of the complex, as a fraction.
    pub fn distortion(&self) -> f64 {
        match *self {
            // Entries are at most `amount`, so singular values at most three times that away from one.
            Self::Bent(amount, _) => 3.0 * amount,
            _ => 0.0,
        }
    }
}

fn center(plc: &Plc) -> Vec3 {
    crate::geom::aabb::Aabb::around(&plc.vertices).center()
}

fn map(plc: &mut Plc, linear: &Matrix3<f64>, center: &Vec3) {
    let seeds = plc.seeds.iter_mut().map(|s| &mut s.point);
    let facet_holes = plc.facets.iter_mut().flat_map(|f| &mut f.holes);
    for p in plc.vertices.iter_mut().chain(seeds).chain(&mut plc.holes).chain(facet_holes) {
        *p = linear * (*p - center);
    }
}

/// The identity and a full matrix of entries up to `amount`: no symmetry is left, so points of a circle or sphere lie on an
/// ellipse or ellipsoid in general position.
fn bend(amount: f64, seed: u64) -> Matrix3<f64> {
    let mut random = Random(seed);
    Matrix3::identity() + Matrix3::from_fn(|_, _| amount * random.symmetric())
}

/// Facets of up to so many corners as their triangles.
fn split(input: &Input, corners: usize) -> Input {
    let mut result = input.clone();
    (result.plc.facets, result.triangles, result.sides) = Default::default();
    for ((facet, triangles), &sides) in input.plc.facets.iter().zip(&input.triangles).zip(&input.sides) {
        let is_whole = facet.polygons.iter().map(Vec::len).sum::<usize>() > corners;
        let mut push = |facet: PlcFacet, triangles: Vec<[u32; 3]>| {
            result.plc.facets.push(facet);
            result.triangles.push(triangles);
            result.sides.push(sides);
        };
        if is_whole {
            push(facet.clone(), triangles.clone());
        } else {
            for t in triangles {
                push(PlcFacet { polygons: vec![t.to_vec()], holes: Vec::new(), marker: facet.marker }, vec![*t]);
            }
        }
    }
    result
}

/// Moves each point at random by at most a distance.
fn shake(points: &mut [Vec3], distance: f64, seed: u64) {
    let mut random = Random(seed);
    // A cube inside the ball of that radius.
    points.iter_mut().for_each(|p| *p += Vec3::from_fn(|_, _| random.symmetric()) * (distance / 3f64.sqrt()));
}

/// Makes coordinates of one axis equal that lie within `tolerance`: each takes the smallest of its cluster.
fn equalise(points: &mut [Vec3], tolerance: f64) {
    for axis in 0..3 {
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&i, &j| points[i][axis].total_cmp(&points[j][axis]));
        let mut start = f64::NEG_INFINITY;
        for k in order {
            if points[k][axis] - start > tolerance {
                start = points[k][axis];
            }
            points[k][axis] = start;
        }
    }
}

/// Directions that most facet corners lie square to: rows of a rotation. `None` without facets or a second direction.
fn dominant_axes(input: &Input) -> Option<Matrix3<f64>> {
    let facets = input.plc.facets.iter().zip(&input.triangles);
    let normals: Vec<(Vec3, f64, usize)> = facets
        .filter_map(|(f, triangles)| {
            let area: Vec3 = triangles.iter().map(|t| vector_area([&t[..]], &input.plc.vertices)).sum();
            let normal = area.try_normalize(0.0)?;
            Some((normal, area.norm(), f.polygons.iter().map(Vec::len).sum()))
        })
        .collect();
    let first = heaviest(normals.iter())?;
    let second = heaviest(normals.iter().filter(|(n, ..)| n.dot(&first).abs() < PARALLEL))?;
    let second = (second - first * first.dot(&second)).normalize();
    Some(Matrix3::from_rows(&[first.transpose(), second.transpose(), first.cross(&second).transpose()]))
}

/// The normal, up to its sign, shared by facets with the most corners: that of the largest of these facets.
fn heaviest<'a>(normals: impl Iterator<Item = &'a (Vec3, f64, usize)>) -> Option<Vec3> {
    let mut bins: BTreeMap<[i64; 3], (usize, f64, Vec3)> = BTreeMap::new();
    for (normal, area, corners) in normals {
        // Upwards by the first coordinate that is not nearly zero.
        let lead = normal.iter().copied().find(|x| x.abs() > PARALLEL).unwrap_or(1.0);
        let normal = normal * lead.signum();
        let key = [0, 1, 2].map(|k| (normal[k] / PARALLEL).round() as i64);
        let bin = bins.entry(key).or_insert((0, 0.0, normal));
        bin.0 += corners;
        if *area > bin.1 {
            (bin.1, bin.2) = (*area, normal);
        }
    }
    bins.into_values().max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))).map(|bin| bin.2)
}

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers everywhere.
struct Random(u64);

impl Random {
    /// Uniform in [-1, 1).
    fn symmetric(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        // 53 bits, as many as a double holds.
        (z >> 11) as f64 * (2.0 / (1u64 << 53) as f64) - 1.0
    }
}
