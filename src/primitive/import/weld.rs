//! Points that are one: those of equal coordinates always, those within a tolerance where that closes or mends a surface.

use super::Surface;
use super::sides::Sides;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::hash::IndexMap;
use crate::geom::lists::Lists;
use crate::geom::polygon::vector_area;
use crate::geom::union_find::UnionFind;
use crate::io::PolygonMesh;

/// Cell of the grid that finds points within reach, in reaches: most points lie further from the border of their cell.
const CELL: f64 = 8.0;

/// The surface of a file over these points, one for all that have equal coordinates. O(n).
pub(super) fn identified(mesh: &PolygonMesh, points: &[Vec3]) -> Surface {
    let mut kept: Vec<Vec3> = Vec::with_capacity(points.len());
    let mut known: IndexMap<[u64; 3], u32> = IndexMap::with_capacity_and_hasher(points.len(), Default::default());
    let mut number = |p: &Vec3| {
        // Minus zero is zero.
        let bits: [u64; 3] = std::array::from_fn(|i| (p[i] + 0.0).to_bits());
        *known.entry(bits).or_insert_with(|| {
            kept.push(*p);
            kept.len() as u32 - 1
        })
    };
    let number: Vec<u32> = points.iter().map(&mut number).collect();
    let (polygons, source) = renumbered(&mesh.polygons, &number);
    let group_of = source.iter().map(|&k| mesh.group_of[k as usize]).collect();
    Surface { points: kept, polygons, group_of }
}

/// A surface after points within a tolerance became one.
pub(super) struct Merged {
    pub surface: Surface,
    /// The polygon that each was before; others collapsed.
    source: Vec<u32>,
}

/// One point for all that an earlier one is within reach of, a fraction `tolerance` of the size; `None` if all lie further
/// apart. O(n).
pub(super) fn merged(surface: &Surface, tolerance: f64) -> Option<Merged> {
    let reach = tolerance * Aabb::around(&surface.points).diagonal();
    let (kept, number) = clusters(&surface.points, reach);
    if kept.len() == surface.points.len() {
        return None;
    }
    let (polygons, source) = renumbered(&surface.polygons, &number);
    let group_of = source.iter().map(|&k| surface.group_of[k as usize]).collect();
    Some(Merged { surface: Surface { points: kept, polygons, group_of }, source })
}

impl Merged {
    /// Whether a shell of the closed surface `before` is left without any facet: it was smaller than the tolerance, but not
    /// noise. Of shells that share edges each counts. O(n log n).
    pub fn lost_a_shell(&self, before: &Surface) -> bool {
        let mut sets = UnionFind::new(before.polygons.count());
        for (_, sides) in Sides::new(before).edges() {
            if let [a, b] = sides {
                sets.join(a.polygon(), b.polygon());
            }
        }
        let (shell_of, count) = sets.number();
        let mut is_kept = vec![false; count];
        self.source.iter().for_each(|&k| is_kept[shell_of[k as usize] as usize] = true);
        // A facet without area may be a set of its own, but is no shell.
        let is_lost =
            |(walk, &shell): (&[u32], &u32)| !is_kept[shell as usize] && vector_area([walk], &before.points) != Vec3::zeros();
        before.polygons.iter().zip(&shell_of).any(is_lost)
    }
}

/// The points that stay, and the number among them of each.
fn clusters(points: &[Vec3], reach: f64) -> (Vec<Vec3>, Vec<u32>) {
    // Counted from here, numbers of cells fit however far from the origin the surface lies.
    let origin = Aabb::around(points).center();
    let mut kept: Vec<Vec3> = Vec::with_capacity(points.len());
    let mut near: IndexMap<[i64; 3], Vec<u32>> = IndexMap::default();
    let mut number = Vec::with_capacity(points.len());
    for p in points {
        let slot = |by: f64| -> [i64; 3] { std::array::from_fn(|i| ((p[i] - origin[i] + by) / (CELL * reach)).floor() as i64) };
        let (lo, hi) = (slot(-reach), slot(reach));
        let cells = (lo[0]..=hi[0]).flat_map(|x| (lo[1]..=hi[1]).flat_map(move |y| (lo[2]..=hi[2]).map(move |z| [x, y, z])));
        let found = cells.filter_map(|cell| near.get(&cell)).flatten().copied();
        let first = found.filter(|&v| (kept[v as usize] - p).norm() <= reach).min();
        number.push(first.unwrap_or_else(|| {
            near.entry(slot(0.0)).or_default().push(kept.len() as u32);
            kept.push(*p);
            kept.len() as u32 - 1
        }));
    }
    (kept, number)
}

/// The polygons over other numbers of their points without those that collapse, and which each was.
fn renumbered(polygons: &Lists, number: &[u32]) -> (Lists, Vec<u32>) {
    let mut found = Lists::with_capacity(polygons.count(), polygons.items().len());
    let mut source = Vec::with_capacity(polygons.count());
    let mut walk: Vec<u32> = Vec::new();
    for (polygon, k) in polygons.iter().zip(0u32..) {
        walk.clear();
        walk.extend(polygon.iter().map(|v| number[*v as usize]));
        walk.dedup();
        while walk.len() > 1 && walk.first() == walk.last() {
            walk.pop();
        }
        if walk.len() >= 3 {
            found.push(walk.iter().copied());
            source.push(k);
        }
    }
    (found, source)
}
