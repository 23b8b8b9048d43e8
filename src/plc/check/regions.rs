//! One seed or hole in each bounded volume, and none anywhere else.

use super::{MAX_FINDINGS, Subject};
use crate::diag::{Diagnostic, Severity};
use crate::geom::Vec3;
use crate::geom::cast::{CastError, Caster};
use crate::plc::volumes::Volumes;
use std::collections::BTreeSet;

const SEED_HINT: &str = "add a region point, or a hole point if it is empty";

/// Markers named for a volume without seed.
const MAX_NAMES: usize = 6;

/// Seeds and holes that are outside, on a facet, or in one volume with another; volumes without any.
pub fn misplaced_seeds(subject: &Subject, volumes: &Volumes, caster: &Caster) -> Vec<Diagnostic> {
    let mut findings = Vec::new();
    let mut owner: Vec<Option<String>> = vec![None; volumes.count as usize];
    let plc = subject.plc;
    let seeds = plc.seeds.iter().map(|s| (format!("the seed of {}", subject.region_name(s.region)), s.point));
    let holes = plc.holes.iter().enumerate().map(|(k, p)| (format!("hole {}", k + 1), *p));
    for (name, point) in seeds.chain(holes) {
        match volumes.at(&point, caster) {
            Ok(0) => {
                let message = format!("{name} lies outside of every volume");
                findings.push(
                    Diagnostic::error("seed-outside", message).near(point).hint("move it into its volume, or take it out"),
                )
            }
            Ok(volume) => match &mut owner[volume as usize] {
                Some(other) => findings.push(
                    Diagnostic::error("two-seeds", format!("{name} lies in one volume with {other}"))
                        .near(point)
                        .hint("remove one of them, or close the wall between them"),
                ),
                free => *free = Some(name),
            },
            Err(CastError::On(t)) => {
                let message = format!("{name} lies on {}", subject.facet_of_name(t));
                findings
                    .push(Diagnostic::error("seed-on-facet", message).near(point).hint("move it strictly inside its volume"));
            }
            Err(CastError::Degenerate) => {
                let message = format!("no ray from {name} misses every edge");
                findings.push(Diagnostic::error("seed-unclear", message).near(point).hint("move it a little inside its volume"))
            }
        }
    }
    let without: Vec<u32> = (1..volumes.count).filter(|&v| owner[v as usize].is_none()).collect();
    // A seed that is in no volume was meant for one of them.
    let is_explained = without.len() <= findings.iter().filter(|f| f.code != "two-seeds").count();
    for (k, &volume) in without.iter().enumerate().filter(|_| !is_explained) {
        findings.push(match k {
            // What is around it takes a walk over all triangles: only for those that will be shown.
            0..MAX_FINDINGS => missing(subject, volumes, volume),
            _ => Diagnostic::error("missing-seed", "a volume has no seed").hint(SEED_HINT),
        });
    }
    // A hole point that is needed nowhere does nothing.
    if without.is_empty() {
        let is_hole = |p: &Vec3| plc.holes.contains(p) && !plc.seeds.iter().any(|s| s.point == *p);
        let idle =
            findings.iter_mut().filter(|f| f.code == "seed-outside" && f.points.iter().all(|p| is_hole(&Vec3::from(*p))));
        idle.for_each(|f| f.severity = Severity::Warning);
    }
    findings.extend(unknown_numbers(subject));
    findings
}

fn missing(subject: &Subject, volumes: &Volumes, volume: u32) -> Diagnostic {
    let around = |t: usize| volumes.of_side[2 * t] == volume || volumes.of_side[2 * t + 1] == volume;
    let triangles: Vec<usize> = (0..subject.triangles.len()).filter(|&t| around(t)).collect();
    let name = |marker: i64| {
        let known = subject.manifest.and_then(|m| m.marker_name(marker));
        known.map_or_else(|| format!("marker {marker}"), str::to_owned)
    };
    let markers: BTreeSet<i64> = triangles.iter().map(|&t| subject.plc.facets[subject.facet_of[t] as usize].marker).collect();
    let mut names: Vec<String> = markers.iter().take(MAX_NAMES).map(|&m| name(m)).collect();
    if markers.len() > MAX_NAMES {
        names.push("...".to_owned());
    }
    let message = format!("a volume has no seed; around it: {}", names.join(", "));
    let corner = triangles.first().map_or(Vec3::zeros(), |&t| subject.point(subject.triangles[t][0]));
    Diagnostic::error("missing-seed", message).near(corner).hint(SEED_HINT)
}

/// Regions and markers that the manifest does not list.
fn unknown_numbers(subject: &Subject) -> Vec<Diagnostic> {
    let Some(manifest) = subject.manifest else { return Vec::new() };
    let regions: BTreeSet<i64> = subject.plc.seeds.iter().map(|s| s.region).collect();
    let markers: BTreeSet<i64> = subject.plc.facets.iter().map(|f| f.marker).collect();
    let regions = regions.into_iter().filter(|&r| manifest.part_name(r).is_none()).map(|r| format!("region {r}"));
    let markers = markers.into_iter().filter(|&m| manifest.marker_name(m).is_none()).map(|m| format!("marker {m}"));
    regions
        .chain(markers)
        .map(|what| {
            Diagnostic::error("not-in-manifest", format!("the manifest does not list {what}"))
                .hint("the .poly and its manifest are of different runs; build them again")
        })
        .collect()
}
