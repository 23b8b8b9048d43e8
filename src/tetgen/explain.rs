//! TetGen's messages as diagnostics: parts, coordinates and scene lines instead of vertex numbers.

use super::child::{self, Folder, Limits};
use super::find::Program;
use super::input::Input;
use super::ladder::{Attempt, Options};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::io::poly;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// More findings than this say nothing new.
const MAX_FINDINGS: usize = 10;
/// What the search for intersections may take.
const SEARCH: Duration = Duration::from_secs(60);

/// Why no attempt succeeded: what TetGen said in any of them, and what its own search for intersections (`-d`) finds.
pub fn explain(
    input: &Input,
    programs: &[Program],
    options: &Options,
    attempts: &[Attempt],
    logs: &[String],
) -> Vec<Diagnostic> {
    let mut summary = Diagnostic::error("tetgen-failed", format!("TetGen made no valid mesh in {} attempts", attempts.len()));
    for a in attempts {
        summary = summary.hint(format!("{a} (TetGen {}): {}", a.version, a.verdict));
    }
    let searched = search(input, programs, options).unwrap_or_default();
    let mut findings = findings(input, logs.iter().map(String::as_str).chain([searched.as_str()]));
    if findings.is_empty() {
        summary = summary.hint("TetGen gave no reason; `gsm check` verifies the complex exactly");
    }
    findings.insert(0, summary);
    findings
}

fn search(input: &Input, programs: &[Program], options: &Options) -> std::io::Result<String> {
    let Some(program) = programs.first() else { return Ok(String::new()) };
    let folder = Folder::new()?;
    std::fs::write(folder.path().join("m.poly"), poly::to_text(&input.plc, None))?;
    let limits = Limits { time: SEARCH, stall: SEARCH, memory: options.memory };
    Ok(child::run(&program.path, &["-d", "m.poly"], folder.path(), &limits)?.log)
}

/// One diagnostic per set of names that messages with vertex numbers speak of.
fn findings<'a>(input: &Input, logs: impl Iterator<Item = &'a str>) -> Vec<Diagnostic> {
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for log in logs {
        // A message may go over several lines; the last one without vertices is its head.
        let mut head = "";
        let mut pending: Vec<Vec<u32>> = Vec::new();
        for line in log.lines().map(str::trim) {
            let groups = vertex_groups(line, input.plc.vertices.len());
            if groups.is_empty() {
                report(input, head, &std::mem::take(&mut pending), &mut seen, &mut found);
                head = line;
            } else {
                pending.extend(groups);
                if pending.len() > 1 {
                    report(input, head, &std::mem::take(&mut pending), &mut seen, &mut found);
                }
            }
        }
        report(input, head, &pending, &mut seen, &mut found);
        found.truncate(MAX_FINDINGS);
    }
    found
}

/// Lists in brackets or parentheses of two or three numbers, `[5, 6, 7]` or `(   1,    3,    2)`: TetGen's way to name a
/// segment or triangle by the numbers, from 1, that the vertices have in the .poly.
fn vertex_groups(line: &str, count: usize) -> Vec<Vec<u32>> {
    let mut groups = Vec::new();
    for piece in line.split(['[', '(']).skip(1) {
        let Some((inside, _)) = piece.split_once([']', ')']) else { continue };
        let numbers: Option<Vec<u32>> = inside.split(',').map(|w| w.trim().parse().ok()).collect();
        if let Some(numbers) = numbers
            && (2..=3).contains(&numbers.len())
            && numbers.iter().all(|n| (1..=count).contains(&(*n as usize)))
        {
            groups.push(numbers.iter().map(|n| n - 1).collect());
        }
    }
    groups
}

fn report(input: &Input, head: &str, groups: &[Vec<u32>], seen: &mut BTreeSet<Vec<String>>, found: &mut Vec<Diagnostic>) {
    let named: Vec<(String, Option<u32>)> = groups.iter().map(|g| owner(input, g)).collect();
    let mut names: Vec<String> = named.iter().map(|(name, _)| name.clone()).collect();
    names.sort();
    if names.is_empty() || !seen.insert(names) {
        return;
    }
    let list = named.iter().map(|(name, _)| format!("`{name}`")).collect::<Vec<_>>().join(" and ");
    let head = head.trim_end_matches([':', '.']);
    let head = if head.starts_with("Facet #") || head.is_empty() { "facets intersect" } else { head };
    let mut finding = Diagnostic::error("tetgen-facets", format!("{head}: facets of {list}"));
    for group in groups {
        let center = group.iter().map(|&v| input.plc.vertices[v as usize]).sum::<Vec3>() / group.len() as f64;
        finding = finding.near(center);
    }
    let span = named.iter().filter_map(|(_, r)| input.regions.get(&(*r)?)?.span).max();
    finding.span = span;
    finding = finding.hint("`gsm check` verifies the complex exactly; thin gaps and walls there are hard for TetGen");
    found.push(finding);
}

/// The name of the facets that have these vertices (of most of them, if none has all), and the later part beside them.
fn owner(input: &Input, group: &[u32]) -> (String, Option<u32>) {
    let mut score: BTreeMap<(i64, u32), usize> = BTreeMap::new();
    for (facet, sides) in input.plc.facets.iter().zip(&input.sides) {
        let common = group.iter().filter(|v| facet.polygons.iter().any(|p| p.contains(v))).count();
        let best = score.entry((facet.marker, sides[0].max(sides[1]))).or_default();
        *best = common.max(*best);
    }
    let best = score.into_iter().max_by_key(|(_, common)| *common).map(|(key, _)| key);
    let Some((marker, region)) = best else { return ("?".into(), None) };
    let name = u32::try_from(marker).ok().and_then(|m| input.markers.get(&m)).cloned();
    (name.unwrap_or_else(|| format!("marker {marker}")), (region != 0).then_some(region))
}
