//! [`Plc`] to text.

use crate::geom::Vec3;
use crate::io::manifest::Manifest;
use crate::plc::{Plc, PlcFacet, Seed};
use rayon::prelude::*;
use std::fmt::{self, Write};

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

fn write_all(out: &mut String, plc: &Plc, manifest: Option<&Manifest>) -> fmt::Result {
    if let Some(m) = manifest {
        legend(out, m)?;
    }
    writeln!(out, "# vertices: number x y z\n{} 3 0 0", plc.vertices.len())?;
    each(out, &plc.vertices, numbered)?;
    writeln!(out, "# facets: polygons holes marker; vertex count and vertices of each polygon; points in holes")?;
    writeln!(out, "{} 1", plc.facets.len())?;
    each(out, &plc.facets, |out, _, f| facet(out, f))?;
    volumes(out, &plc.holes, &plc.seeds)
}

/// The last two lists of a .poly or .smesh.
pub(in crate::io) fn volumes(out: &mut String, holes: &[Vec3], seeds: &[Seed]) -> fmt::Result {
    writeln!(out, "# voids: number x y z\n{}", holes.len())?;
    for (k, p) in holes.iter().enumerate() {
        numbered(out, k, p)?;
    }
    writeln!(out, "# regions: number x y z region max_volume\n{}", seeds.len())?;
    for (k, s) in seeds.iter().enumerate() {
        let [x, y, z]: [f64; 3] = s.point.into();
        let limit = s.max_volume.unwrap_or(NO_LIMIT);
        writeln!(out, "{} {x:?} {y:?} {z:?} {} {limit:?}", k + 1, s.region)?;
    }
    Ok(())
}

/// Bytes of an item, a little more than of most.
const BYTES: usize = 80;
/// Items that one thread writes at a time, and chunks of them that are there at a time beside the text of the file.
const CHUNK: usize = 1 << 12;
const CHUNKS: usize = 64;

/// Writes all items, each with its number from 0; many of them on all threads.
fn each<T: Sync>(out: &mut String, items: &[T], write: impl Fn(&mut String, usize, &T) -> fmt::Result + Sync) -> fmt::Result {
    let write_all = |out: &mut String, first: usize, items: &[T]| {
        items.iter().enumerate().try_for_each(|(k, item)| write(out, first + k, item))
    };
    if items.len() <= CHUNK {
        return write_all(out, 0, items);
    }
    for (batch, number) in items.chunks(CHUNK * CHUNKS).zip(0..) {
        let text = |(k, chunk): (usize, &[T])| {
            let mut text = String::with_capacity(BYTES * chunk.len());
            write_all(&mut text, (number * CHUNKS + k) * CHUNK, chunk).map(|()| text)
        };
        let texts: Vec<_> = batch.par_chunks(CHUNK).enumerate().map(text).collect();
        for text in texts {
            out.push_str(&text?);
        }
    }
    Ok(())
}

fn numbered(out: &mut String, index: usize, p: &Vec3) -> fmt::Result {
    writeln!(out, "{} {:?} {:?} {:?}", index + 1, p.x, p.y, p.z)
}

fn facet(out: &mut String, f: &PlcFacet) -> fmt::Result {
    integer(out, f.polygons.len());
    out.push(' ');
    integer(out, f.holes.len());
    writeln!(out, " {}", f.marker)?;
    for polygon in &f.polygons {
        integer(out, polygon.len());
        for &v in polygon {
            out.push(' ');
            integer(out, v as usize + 1);
        }
        out.push('\n');
    }
    for (k, p) in f.holes.iter().enumerate() {
        numbered(out, k, p)?;
    }
    Ok(())
}

/// Adds a number: most of the file are these, and formatting takes several times as long.
fn integer(out: &mut String, number: usize) {
    if number >= 10 {
        integer(out, number / 10);
    }
    out.push(char::from(b'0' + (number % 10) as u8));
}

fn legend(out: &mut String, m: &Manifest) -> fmt::Result {
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
