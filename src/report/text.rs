//! The report as text for a terminal.

use super::Report;
use crate::io::manifest;
use std::fmt::{self, Display, Write};
use std::path::Path;

/// Rows of a table, the first one its heading.
struct Table {
    rows: Vec<Vec<String>>,
    /// Columns that hold numbers and are aligned to the right.
    numeric: &'static [usize],
}

impl Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let cell_width = |row: &Vec<String>, k: usize| row.get(k).map_or(0, |c| c.chars().count());
        let widths: Vec<usize> = (0..columns).map(|k| self.rows.iter().map(|r| cell_width(r, k)).max().unwrap_or(0)).collect();
        for row in &self.rows {
            let mut line = String::new();
            for (k, cell) in row.iter().enumerate() {
                let width = widths[k];
                if self.numeric.contains(&k) { write!(line, "  {cell:>width$}")? } else { write!(line, "  {cell:<width$}")? }
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// Parts, interfaces, quality and times.
pub fn render(report: &Report) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_all(&mut out, report);
    out
}

fn write_all(out: &mut String, r: &Report) -> fmt::Result {
    let c = r.counts;
    writeln!(
        out,
        "{}: {} vertices, {} facets, {} triangles, {} pieces, {} voids",
        r.scene, c.vertices, c.facets, r.triangles, c.seeds, c.holes
    )?;
    writeln!(out, "\nparts")?;
    write!(out, "{}", parts(r))?;
    writeln!(out, "\ninterfaces")?;
    write!(out, "{}", interfaces(r))?;
    match &r.quality {
        Some(q) => {
            writeln!(out, "\nquality of {} triangular facets", q.triangles)?;
            writeln!(
                out,
                "  angles {:.2} to {:.2} degrees; {:.1} % below 30, {:.1} % above 40; worst R/r {:.3}, mean distortion {:.3}",
                q.min_angle,
                q.max_angle,
                100.0 * q.below_30,
                100.0 * q.above_40,
                q.max_aspect_ratio,
                q.mean_distortion
            )?;
        }
        None => writeln!(out, "\nno triangular facets: all are polygons, which TetGen divides")?,
    }
    if let Some(sharpest) = r.sharp_angles.first() {
        let forced = r.sharp_angles.iter().filter(|s| s.is_forced).count();
        let [x, y, z] = sharpest.at.map(significant);
        let (count, interface) = (r.sharp_angles.len(), &sharpest.interface);
        writeln!(
            out,
            "  {count} sharp angles, {forced} forced by the model; sharpest at ({x}, {y}, {z}) on {interface}; all with --json"
        )?;
    }
    writeln!(out, "\ntime")?;
    write!(out, "{}", times(r))?;
    if let Some(path) = &r.output {
        let manifest = manifest::path_beside(Path::new(path));
        writeln!(out, "\nwritten: {path}, {}", manifest.display())?;
    }
    Ok(())
}

fn parts(r: &Report) -> Table {
    let heading = ["region", "part", "material", "volume", "pieces"].map(String::from).to_vec();
    let rows = r.parts.iter().map(|p| {
        let volume = format!("{} {}^3", significant(p.volume), r.unit);
        vec![
            p.region.to_string(),
            p.part.clone(),
            p.material.clone().unwrap_or_else(|| "-".to_owned()),
            volume,
            p.seeds.len().to_string(),
        ]
    });
    Table { rows: std::iter::once(heading).chain(rows).collect(), numeric: &[0, 3, 4] }
}

fn interfaces(r: &Report) -> Table {
    let heading = ["marker", "name", "between", "area", "facets"].map(String::from).to_vec();
    // Where boundaries cover all of an interface, its own number stands on no facet.
    let rows = r.interfaces.iter().filter(|i| i.facets > 0).map(|i| {
        let side = |k: usize| i.parts[k].as_deref().unwrap_or("outside");
        let area = format!("{} {}^2", significant(i.area), r.unit);
        vec![i.marker.to_string(), i.name.clone(), format!("{} | {}", side(0), side(1)), area, i.facets.to_string()]
    });
    Table { rows: std::iter::once(heading).chain(rows).collect(), numeric: &[0, 3, 4] }
}

fn times(r: &Report) -> Table {
    let milliseconds = |s: f64| format!("{:.2} ms", 1e3 * s);
    let heading = ["stage", "wall", "processor"].map(String::from).to_vec();
    let rows = r.timings.iter().chain(std::iter::once(&r.total)).map(|t| {
        let cpu = t.cpu.map_or_else(|| "-".to_owned(), milliseconds);
        vec![t.stage.to_owned(), milliseconds(t.wall), cpu]
    });
    Table { rows: std::iter::once(heading).chain(rows).collect(), numeric: &[1, 2] }
}

/// Seven significant digits, without an exponent where that is short.
fn significant(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let magnitude = libm::floor(libm::log10(x.abs()));
    if (-4.0..9.0).contains(&magnitude) {
        let decimals = (6.0 - magnitude).max(0.0) as usize;
        let text = format!("{x:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{x:.6e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_seven_digits() {
        for (x, text) in [(24.0, "24"), (0.1 + 0.2, "0.3"), (1234.56789, "1234.568"), (1e-12, "1.000000e-12")] {
            assert_eq!(significant(x), text);
        }
    }
}
