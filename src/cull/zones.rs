//! Boxes in which it is known what the result is, found by halving space; facets are cut along them.

use super::Fate;
use super::inside::{Status, contains, owner};
use super::pieces::{Halves, Settled, Shape, Shapes};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::LeafId;
use crate::primitive::solid::Solid;
use crate::scene::model::Scene;

/// Halvings of a box at most.
const MAX_DEPTH: u32 = 24;
/// Leaves in a box that are intersected faster than it is halved.
const FEW: usize = 6;
/// Power of the slenderness of a box that weighs as much as the facets that are cut (0.2 was faster than 0.5 for 200 turned
/// cubes).
const STRETCH: f64 = 0.2;
/// Where a box is halved. Corners must not lie near, hence several; not at round parts, where facets lie.
const HALVES: [f64; 6] = [0.5137, 0.4719, 0.5491, 0.4423, 0.5773, 0.4117];
/// Distance of corners from the planes of boxes, in the model's size: no feature comes near the tolerance.
const CLEAR: f64 = 1e-7;
/// Part of the tolerance within which corners of a facet lie in the plane of another: contact makes one sheet of them surely.
const LEVEL: f64 = 0.25;
/// Part of a box's section that a facet may miss and still cover it: rounding.
const COVERED: f64 = 1.0 - 1e-10;

/// A box, and what is known of the leaves there; `Unknown` where the boundary may pass.
struct Zone {
    bounds: Aabb,
    leaves: Vec<Status>,
    /// Boxes of facets that cannot be cut.
    uncut: Vec<Aabb>,
    depth: u32,
}

/// Where the pieces of a facet are after its box was halved; with what to put in their place if they have one fate.
enum Source {
    Below,
    Above,
    Both(Shape),
}

/// Pieces of one facet with their fates.
type Fated = Vec<(Shape, Fate)>;

/// Cuts all facets into pieces with fates.
pub(super) fn settle(scene: &Scene, solids: &[Solid], tolerance: f64) -> Settled {
    let (shapes, convex, uncut) = Shapes::new(solids);
    let bounds = Aabb::around(shapes.points.iter());
    let size = bounds.diagonal();
    let zone = Zone {
        bounds: bounds.inflated(0.01 * size),
        leaves: vec![Status::Unknown; solids.len()],
        uncut: uncut.iter().map(|s| shapes.bounds(s)).collect(),
        depth: 0,
    };
    let mut solver = Solver { scene, solids, shapes, clear: CLEAR * size, level: LEVEL * tolerance };
    let found = solver.solve(zone, convex);
    let live = uncut.into_iter().map(|s| (s, Fate::Live));
    solver.shapes.settled(found.into_iter().flatten().chain(live).collect())
}

struct Solver<'a> {
    scene: &'a Scene,
    solids: &'a [Solid],
    shapes: Shapes,
    clear: f64,
    level: f64,
}

impl Solver<'_> {
    /// For each facet in a box its pieces.
    fn solve(&mut self, mut zone: Zone, facets: Vec<Shape>) -> Vec<Fated> {
        if zone.uncut.is_empty() {
            let crossing = self.look_around(&mut zone, &facets);
            if let Some(fates) = self.fates(&zone, &facets) {
                return facets.into_iter().zip(fates).map(|f| vec![f]).collect();
            }
            if crossing <= FEW {
                return live(facets);
            }
        }
        match (zone.depth < MAX_DEPTH).then(|| self.plane(&zone, &facets)).flatten() {
            Some((axis, at)) => self.halve(zone, facets, axis, at),
            None => live(facets),
        }
    }

    /// Leaves whose boundary does not pass through the box contain it or not; the number of the others.
    fn look_around(&self, zone: &mut Zone, facets: &[Shape]) -> usize {
        let mut is_here = vec![false; zone.leaves.len()];
        facets.iter().for_each(|f| is_here[f.leaf as usize] = true);
        for (leaf, status) in zone.leaves.iter_mut().enumerate().filter(|l| !is_here[l.0]) {
            if *status == Status::Unknown {
                *status = contains(&self.solids[leaf], &zone.bounds.center());
            }
        }
        is_here.into_iter().filter(|&h| h).count()
    }

    /// What becomes of the facets in a box, if that is known of all.
    fn fates(&self, zone: &Zone, facets: &[Shape]) -> Option<Vec<Fate>> {
        if owner(self.scene, |l: LeafId| zone.leaves[l.0 as usize]).is_some() {
            return Some(vec![Fate::Hidden; facets.len()]);
        }
        let largest = facets.iter().max_by(|a, b| a.area.total_cmp(&b.area))?;
        let (origin, normal) = self.shapes.plane(largest);
        // The status of the leaves in front of the plane and behind it.
        let mut sides = [zone.leaves.clone(), zone.leaves.clone()];
        let mut reached = [vec![false; zone.leaves.len()], vec![false; zone.leaves.len()]];
        let mut level: Vec<Option<bool>> = Vec::with_capacity(facets.len());
        for facet in facets {
            let heights = facet.corners.iter().map(|&v| (self.shapes.points[v as usize] - origin).dot(&normal));
            let (lo, hi) = heights.fold((0.0, 0.0), |(lo, hi): (f64, f64), h| (lo.min(h), hi.max(h)));
            let leaf = facet.leaf as usize;
            match (hi > self.level, lo < -self.level) {
                (false, false) => {
                    let is_along = self.shapes.plane(facet).1.dot(&normal) > 0.0;
                    let above = if is_along { Status::Out } else { Status::In };
                    let below = if is_along { Status::In } else { Status::Out };
                    (sides[0][leaf], sides[1][leaf]) = (above, below);
                    level.push(Some(is_along));
                }
                // It would lie on both sides.
                (true, true) => return None,
                (is_above, _) => {
                    reached[usize::from(!is_above)][leaf] = true;
                    level.push(None);
                }
            }
        }
        let claim = |k: usize| {
            let status = |l: LeafId| if reached[k][l.0 as usize] { Status::Unknown } else { sides[k][l.0 as usize] };
            owner(self.scene, status)
        };
        let parts = [claim(0)?, claim(1)?];
        if parts[0] == parts[1] {
            return Some(vec![Fate::Hidden; facets.len()]);
        }
        let whole = COVERED * section(&zone.bounds, &origin, &normal);
        let chosen = (0..facets.len()).find(|&k| level[k].is_some() && facets[k].area >= whole)?;
        let face = if level[chosen] == Some(true) { Fate::Face(parts) } else { Fate::Face(parts).turned() };
        let fate = |k: usize| match level[k] {
            _ if k == chosen => face,
            Some(_) => Fate::Copy,
            None => Fate::Hidden,
        };
        Some((0..facets.len()).map(fate).collect())
    }

    /// Where to halve a box, clear of all corners: where few facets are cut, and across a long side.
    fn plane(&self, zone: &Zone, facets: &[Shape]) -> Option<(usize, f64)> {
        let Aabb { lo, hi } = zone.bounds;
        let longest = (hi - lo).max();
        let on_axis = |axis: usize| {
            let length = hi[axis] - lo[axis];
            let (at, cut) = HALVES.iter().find_map(|part| {
                let at = lo[axis] + part * length;
                Some((at, self.cut_by(facets, axis, at)?))
            })?;
            Some(((cut + 1) as f64 * libm::pow(longest / length, STRETCH), axis, at))
        };
        let best = (0..3).filter_map(on_axis).min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((best.1, best.2))
    }

    /// How many facets a plane cuts, unless a corner is near.
    fn cut_by(&self, facets: &[Shape], axis: usize, at: f64) -> Option<usize> {
        let mut count = 0;
        for facet in facets {
            let heights = || facet.corners.iter().map(|&v| self.shapes.points[v as usize][axis] - at);
            if heights().any(|h| h.abs() <= self.clear) {
                return None;
            }
            count += usize::from(heights().any(|h| h < 0.0) && heights().any(|h| h > 0.0));
        }
        Some(count)
    }

    /// Solves both halves; pieces with one fate are one again.
    fn halve(&mut self, zone: Zone, facets: Vec<Shape>, axis: usize, at: f64) -> Vec<Fated> {
        let (mut below, mut above) = (Vec::new(), Vec::new());
        let mut sources: Vec<Source> = Vec::with_capacity(facets.len());
        for facet in facets {
            sources.push(match self.shapes.cut(facet, axis, at) {
                Halves::Below(facet) => {
                    below.push(facet);
                    Source::Below
                }
                Halves::Above(facet) => {
                    above.push(facet);
                    Source::Above
                }
                Halves::Both { whole, parts: [lower, upper] } => {
                    below.push(lower);
                    above.push(upper);
                    Source::Both(whole)
                }
            });
        }
        let [mut below, mut above] = [(false, below), (true, above)].map(|(is_above, pieces)| {
            let mut bounds = zone.bounds;
            if is_above {
                bounds.lo[axis] = at
            } else {
                bounds.hi[axis] = at
            }
            let uncut = zone.uncut.iter().filter(|b| b.overlaps(&bounds)).copied().collect();
            let part = Zone { bounds, leaves: zone.leaves.clone(), uncut, depth: zone.depth + 1 };
            self.solve(part, pieces).into_iter()
        });
        let mut join = |source| match source {
            Source::Below => below.next().unwrap_or_default(),
            Source::Above => above.next().unwrap_or_default(),
            Source::Both(whole) => match [&mut below, &mut above].map(|half| half.next().unwrap_or_default()) {
                [lower, upper] if lower.len() == 1 && upper.len() == 1 && lower[0].1 == upper[0].1 => vec![(whole, lower[0].1)],
                [lower, upper] => [lower, upper].concat(),
            },
        };
        sources.into_iter().map(&mut join).collect()
    }
}

fn live(facets: Vec<Shape>) -> Vec<Fated> {
    facets.into_iter().map(|f| vec![(f, Fate::Live)]).collect()
}

/// Area of the part of a plane in a box.
fn section(bounds: &Aabb, origin: &Vec3, normal: &Vec3) -> f64 {
    let center = bounds.center();
    let foot = center - normal * (center - origin).dot(normal);
    let mut axis = Vec3::zeros();
    axis[normal.iamin()] = bounds.diagonal();
    let u = normal.cross(&axis);
    let v = normal.cross(&u);
    let mut polygon =
        vec![foot + u * 2.0 + v * 2.0, foot - u * 2.0 + v * 2.0, foot - u * 2.0 - v * 2.0, foot + u * 2.0 - v * 2.0];
    for (axis, limit, sign) in (0..3).flat_map(|k| [(k, bounds.lo[k], 1.0), (k, bounds.hi[k], -1.0)]) {
        let height = |p: &Vec3| sign * (p[axis] - limit);
        let mut rest = Vec::with_capacity(polygon.len() + 1);
        for (k, a) in polygon.iter().enumerate() {
            let b = &polygon[(k + 1) % polygon.len()];
            let (ha, hb) = (height(a), height(b));
            if ha >= 0.0 {
                rest.push(*a);
            }
            if (ha < 0.0) != (hb < 0.0) {
                rest.push(a + (b - a) * (ha / (ha - hb)));
            }
        }
        polygon = rest;
    }
    let Some(first) = polygon.first() else { return 0.0 };
    (2..polygon.len()).map(|k| (polygon[k - 1] - first).cross(&(polygon[k] - first))).sum::<Vec3>().norm() * 0.5
}
