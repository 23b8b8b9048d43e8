//! `gsm convert`: one file format to another.

use super::mesh::with_version;
use super::session::{self, Exit, Session};
use crate::cli::ConvertArgs;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::ids::IdVec;
use crate::io::atomic::{self, NewFile};
use crate::io::format::{self, Format};
use crate::io::manifest::{self, Manifest};
use crate::io::mesh::{Mesh, NodeId, Triangle};
use crate::io::{PolygonMesh, SurfaceFormat, poly, read_surface};
use crate::plc::PlcFacet;
use crate::plc::facet::triangulate_facet;
use crate::scene;
use crate::tetgen::Input;
use std::io;

/// Reads, and writes whole or not at all.
///
/// # Errors
/// Those of standard output.
pub fn run(args: &ConvertArgs, session: &mut Session) -> io::Result<Exit> {
    match convert(args) {
        Ok(mesh) => {
            let counts = [mesh.nodes.len(), mesh.triangles.len(), mesh.tets.len()];
            let names = [mesh.regions.len(), mesh.markers.len()];
            if session.common.json {
                let result = serde_json::json!({
                    "output": args.output.display().to_string(), "nodes": counts[0], "triangles": counts[1], "tets": counts[2],
                    "regions": mesh.regions, "markers": mesh.markers
                });
                session.json(&args.input, &[], &result)?;
            } else if !session.common.quiet {
                let ([nodes, triangles, tets], [regions, markers]) = (counts, names);
                writeln!(
                    session.out,
                    "{}: {nodes} nodes, {triangles} triangles, {tets} tetrahedra, {regions} regions and {markers} markers by name",
                    args.output.display()
                )?;
            }
            Ok(Exit::Good)
        }
        Err(faults) => {
            session.fail(&faults, &args.input, "")?;
            Ok(Exit::of(&faults))
        }
    }
}

fn convert(args: &ConvertArgs) -> Result<Mesh, Vec<Diagnostic>> {
    let one = |fault| vec![fault];
    if args.input.extension().is_some_and(|e| e.eq_ignore_ascii_case("ron")) {
        let fault = Diagnostic::usage("unknown-format", "this is a scene, not a mesh or surface");
        return Err(one(fault.hint("`gsm build` makes a .poly of it, which `gsm convert` reads; `gsm mesh` makes a mesh")));
    }
    let outputs = std::slice::from_ref(&args.output);
    if let Some(fault) = session::overwriting(&args.input, outputs) {
        return Err(one(fault));
    }
    let format = with_version(Format::of(&args.output).map_err(one)?, args.msh);
    if let Some(fault) = session::missing_folder(outputs) {
        return Err(one(fault));
    }
    let manifest = Manifest::beside(&args.input).map_err(one)?;
    let unit = args.unit.clone().or_else(|| manifest.as_ref().map(|m| m.unit.clone()));
    let meters = match &unit {
        Some(unit) => scene::meters(unit).ok_or_else(|| {
            one(Diagnostic::usage("unknown-unit", format!("`{unit}` is no unit of length")).hint("use mm, cm, m, in ..."))
        })?,
        None => 1.0,
    };
    let is_plc = poly::is_plc(&args.input);
    let mesh = if is_plc {
        let plc = poly::read(&args.input).map_err(one)?;
        Input::from_plc(plc, manifest.as_ref())?.surface()
    } else if SurfaceFormat::of(&args.input).is_some() {
        triangulated(read_surface(&args.input).map_err(one)?)?
    } else {
        format::load(&args.input).map_err(one)?
    };
    let content = format::render(&mesh, meters, format, &args.output).map_err(one)?;
    let manifest = manifest.map(|m| format::manifest_of(m, format, &content)).transpose().map_err(one)?;
    let json = manifest.map(|m| m.to_json()).transpose().map_err(one)?;
    let mut files = vec![NewFile { path: args.output.clone(), content: &content }];
    let beside = manifest::path_beside(&args.output);
    if let Some(json) = json.as_ref().filter(|_| beside != manifest::path_beside(&args.input)) {
        files.push(NewFile { path: beside, content: json.as_bytes() });
    }
    atomic::write_all(&files).map_err(one)?;
    Ok(mesh)
}

/// A surface file's polygons as triangles; its groups become markers.
fn triangulated(surface: PolygonMesh) -> Result<Mesh, Vec<Diagnostic>> {
    let points: Vec<Vec3> = surface.points.iter().map(|p| Vec3::from(*p)).collect();
    let mut mesh = Mesh { nodes: IdVec::from(points.clone()), ..Mesh::default() };
    let mut faults = Vec::new();
    for (k, polygon) in surface.polygons.iter().enumerate() {
        let marker = surface.group_of.get(k).map_or(1, |g| g + 1);
        let facet = PlcFacet { polygons: vec![polygon.to_vec()], ..PlcFacet::default() };
        match (polygon.try_into(), triangulate_facet(&facet, &points)) {
            (Ok(corners), _) => mesh.triangles.push(triangle(corners, marker)),
            (_, Ok(list)) => mesh.triangles.extend(list.into_iter().map(|t| triangle(t, marker))),
            (_, Err(_)) => faults.push(
                Diagnostic::error("bad-polygon", format!("polygon {} crosses itself or has no area", k + 1))
                    .near(points[polygon[0] as usize])
                    .hint("divide it into triangles, or take it out"),
            ),
        }
    }
    mesh.markers = surface.groups.iter().enumerate().map(|(k, name)| (k as u32 + 1, name.clone())).collect();
    if faults.is_empty() { Ok(mesh) } else { Err(faults) }
}

fn triangle(corners: [u32; 3], marker: u32) -> Triangle {
    Triangle { corners: corners.map(NodeId), marker, sides: [0, 0] }
}
