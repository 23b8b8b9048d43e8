//! [`Plc`] to text.

use crate::geom::Vec3;
use crate::io::manifest::Manifest;
use crate::plc::{Plc, PlcFacet};
use std::fmt::Write;

/// Volume constraint of a region that has none: TetGen takes the region number for it if the column is missing.
const NO_LIMIT: f64 = -1.0;

/// The text of a .poly file, with the manifest's names as comments if there is one.
pub fn to_text(plc: &Plc, manifest: Option<&Manifest>) -> String {
    // 80 bytes per vertex and 60 per facet are a little more than a typical file needs.
    let mut out = String::with_capacity(80 * plc.vertices.len() + 60 * plc.facets.len() + 4096);
    // Writing to a String cannot fail.
    let _ = write_all(&mut out, plc, manifest);
    out
}

fn write_all(out: &mut String, plc: &Plc, manifest: Option<&Manifest>) -> std::fmt::Result {
    if let Some(m) = manifest {
        legend(out, m)?;
    }
    writeln!(out, "# vertices: number x y z\n{} 3 0 0", plc.vertices.len())?;
    for (k, v) in plc.vertices.iter().enumerate() {
        numbered(out, k, v)?;
    }
    writeln!(out, "# facets: polygons holes marker; vertex count and vertices of each polygon; points in holes")?;
    writeln!(out, "{} 1", plc.facets.len())?;
    for f in &plc.facets {
        facet(out, f)?;
    }
    writeln!(out, "# voids: number x y z\n{}", plc.holes.len())?;
    for (k, p) in plc.holes.iter().enumerate() {
        numbered(out, k, p)?;
    }
    writeln!(out, "# regions: number x y z region max_volume\n{}", plc.seeds.len())?;
    for (k, s) in plc.seeds.iter().enumerate() {
        let [x, y, z]: [f64; 3] = s.point.into();
        let limit = s.max_volume.unwrap_or(NO_LIMIT);
        writeln!(out, "{} {x:?} {y:?} {z:?} {} {limit:?}", k + 1, s.region)?;
    }
    Ok(())
}

fn numbered(out: &mut String, index: usize, p: &Vec3) -> std::fmt::Result {
    writeln!(out, "{} {:?} {:?} {:?}", index + 1, p.x, p.y, p.z)
}

fn facet(out: &mut String, f: &PlcFacet) -> std::fmt::Result {
    writeln!(out, "{} {} {}", f.polygons.len(), f.holes.len(), f.marker)?;
    for polygon in &f.polygons {
        write!(out, "{}", polygon.len())?;
        for v in polygon {
            write!(out, " {}", v + 1)?;
        }
        out.push('\n');
    }
    for (k, p) in f.holes.iter().enumerate() {
        numbered(out, k, p)?;
    }
    Ok(())
}

fn legend(out: &mut String, m: &Manifest) -> std::fmt::Result {
    // A name may hold anything; a line break in it must not end the comment.
    let clean = |name: &str| name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>();
    writeln!(out, "# gsm {}, scene {}, unit {}", clean(&m.gsm), clean(&m.scene), clean(&m.unit))?;
    for r in &m.regions {
        let material = r.material.as_deref().map(|m| format!(" ({})", clean(m))).unwrap_or_default();
        writeln!(out, "# region {}: {}{material}", r.region, clean(&r.part))?;
    }
    for k in &m.markers {
        writeln!(out, "# marker {}: {}", k.marker, clean(&k.name))?;
    }
    Ok(())
}
