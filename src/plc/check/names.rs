//! The manifest tells the truth: the parts on the sides of each marker, volumes, areas and numbers are those of the complex.

use super::Subject;
use crate::diag::{Diagnostic, Tally};
use crate::geom::Vec3;
use crate::geom::cast::Caster;
use crate::geom::polygon::vector_area;
use crate::io::manifest::{Counts, Manifest, MarkerEntry};
use crate::plc::measure::enclosed_volumes;
use crate::plc::volumes::Volumes;
use std::collections::BTreeMap;

/// Largest relative difference of a volume or an area: what meshes of the complex are held to.
const MAX_DIFFERENCE: f64 = 1e-9;
/// Distance in units in the last place of the size by which a polygon's triangulation may leave its plane: polygons are planar
/// to 4 of them, on both sides of a body.
const FLATNESS_ULPS: f64 = 8.0;

/// What the manifest says and the complex does not.
pub(super) fn differing(subject: &Subject, manifest: &Manifest, volumes: &Volumes, caster: &Caster) -> Vec<Diagnostic> {
    let mut numbers: Vec<Option<i64>> = vec![None; volumes.count as usize];
    for seed in &subject.plc.seeds {
        if let Ok(volume) = volumes.at(&seed.point, caster) {
            numbers[volume as usize] = Some(seed.region);
        }
    }
    let mut findings = wrong_sides(subject, manifest, volumes, &numbers);
    findings.extend(wrong_volumes(subject, manifest, volumes, &numbers));
    findings.extend(wrong_interfaces(subject, manifest));
    findings.extend(wrong_counts(subject, manifest));
    findings
}

/// Whether a size is what the manifest says; what is no number is not.
fn agree(found: f64, said: f64, slack: f64) -> bool {
    (found - said).abs() <= MAX_DIFFERENCE * found + slack
}

const REBUILD: &str = "the .poly and its manifest are of different runs, or one of them was edited; build them again";

/// Markers whose parts are not the ones on the sides of a facet.
fn wrong_sides(subject: &Subject, manifest: &Manifest, volumes: &Volumes, numbers: &[Option<i64>]) -> Vec<Diagnostic> {
    let entries: BTreeMap<i64, &MarkerEntry> = manifest.markers.iter().map(|m| (m.marker, m)).collect();
    let names: Vec<Option<&str>> = numbers.iter().map(|n| n.and_then(|region| manifest.part_name(region))).collect();
    let name = |side: usize| names[volumes.of_side[side] as usize];
    let mut tally = Tally::default();
    let mut last = u32::MAX;
    for (t, &facet) in subject.facet_of.iter().enumerate() {
        let marker = subject.plc.facets[facet as usize].marker;
        let Some(entry) = entries.get(&marker) else { continue };
        let [a, b] = [0, 1].map(|k| entry.parts[k].as_deref());
        let (front, back) = match (name(2 * t), name(2 * t + 1)) {
            (None, back) => (back, None),
            sides => sides,
        };
        // One triangle tells it for its facet.
        if [(a, b), (b, a)].contains(&(front, back)) || std::mem::replace(&mut last, facet) == facet {
            continue;
        }
        let shown = |part: Option<&str>| part.map_or("no part".to_owned(), |p| format!("`{p}`"));
        tally.add((marker, front.min(back), front.max(back)), || {
            let message = format!(
                "{} lies between {} and {}; its marker {marker} is of a facet between {} and {}",
                subject.facet_name(facet),
                shown(front),
                shown(back),
                shown(a),
                shown(b)
            );
            Diagnostic::error("wrong-marker", message)
                .near(subject.triangles[t].iter().map(|&v| subject.point(v)).sum::<Vec3>() / 3.0)
                .hint(format!("correct the marker, or the numbers of the region points; {REBUILD}"))
        });
    }
    tally.finish()
}

/// Regions whose volume is not that of the manifest.
fn wrong_volumes(subject: &Subject, manifest: &Manifest, volumes: &Volumes, numbers: &[Option<i64>]) -> Vec<Diagnostic> {
    let corners = |t: usize| subject.triangles[t].map(|v| subject.point(v));
    let walls = || (0..subject.triangles.len()).map(|t| (corners(t), [volumes.of_side[2 * t], volumes.of_side[2 * t + 1]]));
    let contents = enclosed_volumes(volumes.count as usize, walls);
    let mut surfaces = vec![0.0; volumes.count as usize];
    for ([a, b, c], sides) in walls() {
        sides.iter().for_each(|&s| surfaces[s as usize] += 0.5 * (b - a).cross(&(c - a)).norm());
    }
    let mut found: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
    for (volume, number) in numbers.iter().enumerate().skip(1) {
        let sum = found.entry(number.unwrap_or(i64::MIN)).or_default();
        *sum = (sum.0 + contents[volume], sum.1 + surfaces[volume]);
    }
    let differs = |entry: &&crate::io::manifest::RegionEntry| {
        let (volume, surface) = found.get(&entry.region).copied().unwrap_or_default();
        let slack = surface * FLATNESS_ULPS * f64::EPSILON * subject.scale();
        !agree(volume, entry.volume, slack)
    };
    let told = |entry: &crate::io::manifest::RegionEntry| {
        let volume = found.get(&entry.region).map_or(0.0, |f| f.0);
        let name = subject.region_name(entry.region);
        let message = format!("{name} has the volume {volume}; the manifest says {}", entry.volume);
        Diagnostic::error("wrong-volume", message).hint(REBUILD)
    };
    manifest.regions.iter().filter(differs).map(told).collect()
}

/// Markers whose area or number of facets is not that of the manifest.
fn wrong_interfaces(subject: &Subject, manifest: &Manifest) -> Vec<Diagnostic> {
    let mut found: BTreeMap<i64, (f64, f64, usize)> = BTreeMap::new();
    let mut last = u32::MAX;
    for (triangle, &facet) in subject.triangles.iter().zip(&subject.facet_of) {
        let [a, b, c] = triangle.map(|v| subject.point(v));
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let sum = found.entry(subject.plc.facets[facet as usize].marker).or_default();
        sum.0 += vector_area([&triangle[..]], &subject.plc.vertices).norm();
        sum.1 += longest;
        sum.2 += usize::from(std::mem::replace(&mut last, facet) != facet);
    }
    let mut findings = Vec::new();
    for entry in &manifest.markers {
        let (area, lengths, facets) = found.get(&entry.marker).copied().unwrap_or_default();
        let slack = lengths * FLATNESS_ULPS * f64::EPSILON * subject.scale();
        let name = format!("marker {} ({})", entry.marker, entry.name);
        if !agree(area, entry.area, slack) {
            let message = format!("{name} has the area {area}; the manifest says {}", entry.area);
            findings.push(Diagnostic::error("wrong-area", message).hint(REBUILD));
        }
        if facets != entry.facets {
            let message = format!("{name} has {facets} facets; the manifest says {}", entry.facets);
            findings.push(Diagnostic::error("wrong-count", message).hint(REBUILD));
        }
    }
    findings
}

/// Numbers of vertices, facets and the rest that are not those of the manifest.
fn wrong_counts(subject: &Subject, manifest: &Manifest) -> Option<Diagnostic> {
    let (c, m) = (Counts::of(subject.plc), manifest.counts);
    let pairs = [
        ("vertices", c.vertices, m.vertices),
        ("facets", c.facets, m.facets),
        ("polygons", c.polygons, m.polygons),
        ("region points", c.seeds, m.seeds),
        ("holes", c.holes, m.holes),
    ];
    let differing: Vec<String> = pairs
        .iter()
        .filter(|(_, found, said)| found != said)
        .map(|(what, found, said)| format!("{found} {what} instead of {said}"))
        .collect();
    if differing.is_empty() {
        return None;
    }
    let message = format!("the file has {}, which the manifest says", differing.join(", "));
    Some(Diagnostic::error("wrong-count", message).hint(REBUILD))
}
