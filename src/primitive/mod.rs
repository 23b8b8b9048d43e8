//! Scene leaves to closed polygonal [`solid::Solid`]s: each facet knows its surface, each vertex its freedom.
//!
//! Reads [`Scene`], gives one solid per leaf to `contact`. Steps:
//! 1. every leaf says which circles and ellipsoids it wants divided, and how finely;
//! 2. those about one axis are divided alike ([`axis`]), arcs of profiles that are turned about it likewise, ellipsoids written
//!    twice become one ([`ellipsoid`]);
//! 3. cylinders and cones that are to be triangles are cut alike where they are one surface ([`levels`]);
//! 4. every leaf is built on its own: planar solids ([`block`]), sweeps of profiles ([`sweep`] for extrusions, revolutions and
//!    paths; curved panels in [`panel`] and [`ruled`]), octahedra ([`ellipsoid`]), files ([`import`]).
//!
//! Example: `Cone { bottom_radius: 45, top_radius: 45, height: 100 }` at 24 segments becomes two 24-gons (`bottom`, `top`) and
//! 24 rectangles of the one surface `side`.

mod angle;
mod axis;
mod block;
mod circle;
mod division;
mod ellipsoid;
mod extrude;
mod import;
mod levels;
mod outline;
mod panel;
mod path_sweep;
mod place;
mod profile;
mod revolve;
mod rows;
mod ruled;
mod rulings;
mod shell;
pub mod solid;
mod sweep;

use crate::diag::{Diagnostic, Outcome};
use crate::scene::model::{Leaf, Primitive, Scene};
use circle::{Circle, CircleRequest};
use ellipsoid::EllipsoidRequest;
use extrude::Extrusion;
use path_sweep::PathSweep;
use rayon::prelude::*;
use revolve::Revolution;
use solid::Solid;
use std::collections::BTreeMap;
use sweep::Sweep;

/// What a leaf wants divided.
enum Request {
    Circles(Vec<CircleRequest>),
    Ellipsoid(Box<EllipsoidRequest>),
}

/// The divided circles of a leaf, or its ellipsoid.
enum Divided {
    Circles(Vec<Circle>),
    Ellipsoid(Box<EllipsoidRequest>),
}

/// The solids of all leaves of a scene, in leaf order, in scene coordinates. The result does not depend on the number of
/// threads. Cost: linear in the facets, n log n where profiles are not convex.
///
/// # Errors
/// For every leaf at fault: files that cannot be read or are not closed surfaces (`open-surface`, ...), profiles and paths that
/// cross themselves once divided (`bad-profile`, `bad-path`), divisions beyond the limits (`too-many-segments`,
/// `too-many-facets`).
pub fn build(scene: &Scene) -> Outcome<Vec<Solid>> {
    let requests = collect(scene.leaves.as_slice().iter().map(|leaf| request(leaf).map_err(|e| named(e, leaf))))?;
    let circles = requests.iter().flat_map(|r| if let Request::Circles(circles) = r { &circles[..] } else { &[] });
    let size = axis::bounds(circles).diagonal();
    let divided = divide(requests, scene.tolerance, size);
    let leaves: Vec<(&Leaf, Divided)> = scene.leaves.iter().zip(divided).collect();
    let meridians = meridians(&leaves, scene.tolerance, size)?;
    let ready: Vec<((&Leaf, Divided), Vec<Circle>)> = leaves.into_iter().zip(meridians).collect();
    let drafts: Vec<Result<Draft, Diagnostic>> =
        ready.into_par_iter().map(|((leaf, divided), arcs)| draft(leaf, divided, &arcs).map_err(|e| named(e, leaf))).collect();
    let mut drafts = collect(drafts.into_iter())?;
    let mut sweeps: Vec<&mut Sweep> = drafts.iter_mut().filter_map(Draft::sweep).collect();
    levels::divide(&mut sweeps, scene.tolerance * size);
    let leaves: Vec<(&Leaf, Draft)> = scene.leaves.iter().zip(drafts).collect();
    let solids: Vec<Result<Solid, Diagnostic>> =
        leaves.into_par_iter().map(|(leaf, draft)| draft.build().map_err(|e| named(e, leaf))).collect();
    collect(solids.into_iter())
}

/// A leaf that is ready to be built.
enum Draft {
    Sweep(Box<Sweep>),
    Solid(Solid),
}

impl Draft {
    fn sweep(&mut self) -> Option<&mut Sweep> {
        match self {
            Self::Sweep(sweep) => Some(sweep),
            Self::Solid(_) => None,
        }
    }
    fn build(self) -> Result<Solid, Diagnostic> {
        match self {
            Self::Sweep(sweep) => sweep.build(),
            Self::Solid(solid) => Ok(solid),
        }
    }
}

fn collect<T>(results: impl Iterator<Item = Result<T, Diagnostic>>) -> Outcome<Vec<T>> {
    let (mut items, mut faults) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(item) => items.push(item),
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() { Ok(items) } else { Err(faults) }
}

/// Says which leaf a fault belongs to.
fn named(mut fault: Diagnostic, leaf: &Leaf) -> Diagnostic {
    if let Some(name) = &leaf.name {
        fault.message = format!("solid '{name}': {}", fault.message);
    }
    fault.at(leaf.span)
}

fn revolution(leaf: &Leaf) -> Option<Revolution<'_>> {
    let full = |frame, profile| Revolution { leaf, frame, profile, start: 0.0, sweep: 360.0 };
    match &leaf.primitive {
        Primitive::Cone { frame, bottom_radius, top_radius, height } => {
            Some(full(frame, revolve::cone_profile(*bottom_radius, *top_radius, *height)))
        }
        Primitive::Torus { frame, major_radius, minor_radius } => {
            Some(full(frame, revolve::torus_profile(*major_radius, *minor_radius)))
        }
        Primitive::Revolution { frame, profile, start, angle } => {
            let (start, sweep) = revolve::range(*start, *angle);
            Some(Revolution { leaf, frame, profile: profile.clone(), start, sweep })
        }
        _ => None,
    }
}

fn request(leaf: &Leaf) -> Result<Request, Diagnostic> {
    if let Some(revolution) = revolution(leaf) {
        return Ok(Request::Circles(vec![revolution.request()?]));
    }
    match &leaf.primitive {
        Primitive::Extrusion { frame, profile, length } => {
            Ok(Request::Circles(Extrusion { leaf, frame, profile, length: *length }.requests()?))
        }
        Primitive::PathSweep { frame, profile, path } => {
            Ok(Request::Circles(PathSweep { leaf, frame, profile, path }.requests()?))
        }
        Primitive::Ellipsoid { center, radii } => Ok(Request::Ellipsoid(Box::new(EllipsoidRequest::new(center, radii, leaf)?))),
        _ => Ok(Request::Circles(Vec::new())),
    }
}

/// Divides all circles and ellipsoids of the scene and gives them back to their leaves.
fn divide(requests: Vec<Request>, tolerance: f64, size: f64) -> Vec<Divided> {
    let (mut circles, mut ellipsoids, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    for request in requests {
        match request {
            Request::Circles(c) => {
                counts.push(Some(c.len()));
                circles.extend(c);
            }
            Request::Ellipsoid(e) => {
                counts.push(None);
                ellipsoids.push(*e);
            }
        }
    }
    ellipsoid::unify(&mut ellipsoids, tolerance);
    let mut circles = axis::divide(&circles, tolerance, size).into_iter();
    let mut ellipsoids = ellipsoids.into_iter();
    let give = |count: Option<usize>| match count {
        Some(n) => Some(Divided::Circles(circles.by_ref().take(n).collect())),
        None => ellipsoids.next().map(|e| Divided::Ellipsoid(Box::new(e))),
    };
    counts.into_iter().filter_map(give).collect()
}

/// The arcs of the profiles of revolutions, divided: those about one axis with the same centre in its half plane alike.
fn meridians(leaves: &[(&Leaf, Divided)], tolerance: f64, size: f64) -> Outcome<Vec<Vec<Circle>>> {
    let arcs = |(leaf, divided): &(&Leaf, Divided)| match (revolution(leaf), divided) {
        (Some(revolution), Divided::Circles(circles)) => match &circles[..] {
            [circle] => Ok(revolution.meridians(circle)?.into_iter().map(|arc| (circle.group, arc)).collect()),
            _ => Ok(Vec::new()),
        },
        _ => Ok(Vec::new()),
    };
    let requests: Vec<Vec<(usize, CircleRequest)>> = collect(leaves.iter().map(|l| arcs(l).map_err(|e| named(e, l.0))))?;
    let mut by_axis: BTreeMap<usize, Vec<(usize, CircleRequest)>> = BTreeMap::new();
    for (leaf, (axis, arc)) in requests.into_iter().enumerate().flat_map(|(k, arcs)| arcs.into_iter().map(move |a| (k, a))) {
        by_axis.entry(axis).or_default().push((leaf, arc));
    }
    let mut divided: Vec<Vec<Circle>> = leaves.iter().map(|_| Vec::new()).collect();
    for arcs in by_axis.into_values() {
        let (owners, arcs): (Vec<usize>, Vec<CircleRequest>) = arcs.into_iter().unzip();
        for (leaf, circle) in owners.into_iter().zip(axis::divide(&arcs, tolerance, size)) {
            divided[leaf].push(circle);
        }
    }
    Ok(divided)
}

fn draft(leaf: &Leaf, divided: Divided, meridians: &[Circle]) -> Result<Draft, Diagnostic> {
    let mut circles = match divided {
        Divided::Ellipsoid(ellipsoid) => return Ok(Draft::Solid(ellipsoid.build())),
        Divided::Circles(circles) => circles,
    };
    let sweep = |sweep| Draft::Sweep(Box::new(sweep));
    if let Some(revolution) = revolution(leaf) {
        let circle = circles.pop().ok_or_else(|| Diagnostic::internal("no-circle", "a revolution lost its circle"))?;
        return revolution.sweep(circle, meridians).map(sweep);
    }
    match &leaf.primitive {
        Primitive::Block { lo, hi } => Ok(Draft::Solid(block::block(lo, hi, &leaf.transform))),
        Primitive::Pyramid { frame, base, apex } => block::pyramid(frame, base, apex, &leaf.transform).map(Draft::Solid),
        Primitive::Extrusion { frame, profile, length } => {
            Extrusion { leaf, frame, profile, length: *length }.sweep(circles).map(sweep)
        }
        Primitive::PathSweep { frame, profile, path } => PathSweep { leaf, frame, profile, path }.sweep(circles).map(sweep),
        Primitive::Import { path, scale } => import::import(leaf, path, *scale).map(Draft::Solid),
        _ => Err(Diagnostic::internal("unbuilt-primitive", "a primitive has no builder")),
    }
}

#[cfg(test)]
mod levels_tests;
#[cfg(test)]
mod tests;
