//! Every edge has at least two facets, and every facet two different volumes on its sides.

use super::Subject;
use super::faces::Faces;
use crate::diag::Diagnostic;
use crate::geom::union_find::UnionFind;
use crate::plc::volumes::Volumes;
use std::collections::{BTreeMap, BTreeSet};

/// Facets named in one finding.
const MAX_NAMES: usize = 4;

/// Edges that only one facet has, one finding per connected chain of them.
pub fn open_edges(subject: &Subject, volumes: &Volumes) -> Vec<Diagnostic> {
    if volumes.open_edges.is_empty() {
        return Vec::new();
    }
    let is_open: BTreeSet<[u32; 2]> = volumes.open_edges.iter().copied().collect();
    let mut facets_at: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (t, w) in subject.triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (w[k], w[(k + 1) % 3]);
            if is_open.contains(&[a.min(b), a.max(b)]) {
                facets_at.insert([a.min(b), a.max(b)], subject.facet_of[t]);
            }
        }
    }
    let mut chains = UnionFind::new(subject.plc.vertices.len());
    volumes.open_edges.iter().for_each(|&[a, b]| chains.join(a, b));
    let mut members: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
    for &edge in &volumes.open_edges {
        members.entry(chains.find(edge[0])).or_default().push(edge);
    }
    let describe = |edges: &Vec<[u32; 2]>| {
        let facets: BTreeSet<u32> = edges.iter().filter_map(|e| facets_at.get(e).copied()).collect();
        let mut names: Vec<String> = facets.iter().take(MAX_NAMES).map(|&f| subject.facet_name(f)).collect();
        if facets.len() > MAX_NAMES {
            names.push("...".to_owned());
        }
        let count = match edges.len() {
            1 => "1 edge belongs".to_owned(),
            n => format!("{n} edges belong"),
        };
        let [a, b] = edges[0].map(|v| subject.point(v));
        Diagnostic::error("open-edge", format!("{count} to one facet only: {}", names.join(", ")))
            .near((a + b) * 0.5)
            .hint("a facet is missing there, or its neighbours do not share its vertices")
    };
    members.values().map(describe).collect()
}

/// Facets with one volume on both sides, or with several on one side.
pub fn sheets(subject: &Subject, volumes: &Volumes, faces: &Faces) -> Vec<Diagnostic> {
    let mut sides: Vec<BTreeSet<[u32; 2]>> = vec![BTreeSet::new(); faces.facet_of.len()];
    for (t, &f) in faces.of_triangle.iter().enumerate() {
        sides[f as usize].insert([volumes.of_side[2 * t], volumes.of_side[2 * t + 1]]);
    }
    let mut findings = Vec::new();
    for facet in (0..sides.len()).collect::<Vec<_>>().chunk_by(|&a, &b| faces.facet_of[a] == faces.facet_of[b]) {
        let number = faces.facet_of[facet[0]];
        let name = subject.facet_name(number);
        let is_sheet = |&f: &usize| sides[f].iter().any(|[front, back]| front == back);
        let finding = if facet.iter().any(is_sheet) {
            Diagnostic::error("sheet", format!("{name} has the same volume on both sides"))
                .hint("take it out, or add what is missing of the wall that it belongs to")
        } else if facet.iter().any(|&f| sides[f].len() > 1) {
            Diagnostic::error("several-volumes", format!("{name} has several volumes on one side"))
                .hint("divide it where the wall between the volumes meets it")
        } else if facet.iter().any(|&f| sides[f] != sides[facet[0]]) {
            Diagnostic::warning("several-volumes", format!("the pieces of {name} have different volumes on their sides"))
                .hint("make a facet of each piece, so that each has a marker of its own")
        } else {
            continue;
        };
        let corner = subject.plc.facets[number as usize].polygons.first().and_then(|p| p.first());
        findings.push(corner.map_or(finding.clone(), |&v| finding.near(subject.point(v))));
    }
    findings
}
