//! `NAME.gsm.json`: what the integers of a .poly mean.

use crate::brep::complex::Complex;
use crate::diag::Diagnostic;
use crate::ids::{Id, PartId};
use crate::plc::Plc;
use crate::plc::measure::Measures;
use crate::scene::model::Scene;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Largest manifest that is read: a thousand times that of the largest reference scene.
const MAX_BYTES: u64 = 1 << 26;

/// The table from the numbers of a .poly back to the names of its scene.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of gsm that wrote it.
    pub gsm: String,
    /// Name of the scene.
    pub scene: String,
    /// SHA-256 of the scene text and of the parameters set from outside.
    pub scene_hash: String,
    /// Unit of length.
    pub unit: String,
    /// Markers in ascending order.
    pub markers: Vec<MarkerEntry>,
    /// Regions in ascending order.
    pub regions: Vec<RegionEntry>,
    /// Sizes of the .poly.
    pub counts: Counts,
}

/// An interface or a named boundary.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct MarkerEntry {
    /// Number in the .poly.
    pub marker: i64,
    /// Name.
    pub name: String,
    /// The parts on its two sides, in file order; null is the outside or a void.
    pub parts: [Option<String>; 2],
    /// Marker of the interface that a named boundary belongs to; its own for an interface.
    pub interface: i64,
    /// Area, in the unit squared.
    pub area: f64,
    /// Largest edge length that the scene asks for on the interface.
    #[serde(default)]
    pub max_edge: Option<f64>,
    /// Number of facets; 0 for an interface that named boundaries cover.
    pub facets: usize,
}

/// A part.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct RegionEntry {
    /// Number in the .poly.
    pub region: i64,
    /// Name of the part.
    pub part: String,
    /// Name of its material.
    pub material: Option<String>,
    /// Volume of all its pieces, in the unit cubed.
    pub volume: f64,
    /// Largest edge length on its curved surfaces.
    pub max_edge: Option<f64>,
    /// Largest wanted volume of a tetrahedron.
    pub max_volume: Option<f64>,
    /// A point inside each piece.
    pub seeds: Vec<[f64; 3]>,
}

/// Sizes of a .poly.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Vertices.
    pub vertices: usize,
    /// Facets.
    pub facets: usize,
    /// Polygons of all facets.
    pub polygons: usize,
    /// Connected volumes of parts.
    pub seeds: usize,
    /// Voids.
    pub holes: usize,
}

impl Manifest {
    /// The manifest of a scene's complex.
    pub fn new(scene: &Scene, complex: &Complex, measures: &Measures, plc: &Plc) -> Self {
        let name = |part: Option<PartId>| part.map(|p| scene.parts[p].name.clone());
        let number = |index: usize| index as i64 + 1;
        let markers = complex.markers.enumerate().map(|(id, marker)| MarkerEntry {
            marker: number(id.index()),
            name: marker.name.clone(),
            parts: marker.parts.map(name),
            interface: number(marker.interface.index()),
            area: measures.areas[id],
            max_edge: marker.max_edge,
            facets: measures.facets[id],
        });
        let volumes = measures.by_part(complex, &scene.parts);
        let regions = scene.parts.enumerate().map(|(id, part)| RegionEntry {
            region: number(id.index()),
            part: part.name.clone(),
            material: part.material.clone(),
            volume: volumes[id],
            max_edge: part.max_edge,
            max_volume: part.max_volume,
            seeds: plc.seeds.iter().filter(|s| s.region == number(id.index())).map(|s| s.point.into()).collect(),
        });
        Self {
            gsm: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            unit: scene.unit.clone(),
            markers: markers.collect(),
            regions: regions.collect(),
            counts: Counts::of(plc),
        }
    }

    /// The manifest of the same complex as another file holds it, its facets in other pieces.
    pub fn recounted(self, plc: &Plc) -> Self {
        let mut facets: BTreeMap<i64, usize> = BTreeMap::new();
        plc.facets.iter().for_each(|f| *facets.entry(f.marker).or_insert(0) += 1);
        let recount = |m: MarkerEntry| MarkerEntry { facets: facets.get(&m.marker).copied().unwrap_or(0), ..m };
        let markers = self.markers.into_iter().map(recount).collect();
        Self { counts: Counts::of(plc), markers, ..self }
    }

    /// The file's text: indented, fields in the order of this type.
    ///
    /// # Errors
    /// An internal error if a number is not finite.
    pub fn to_json(&self) -> Result<String, Diagnostic> {
        serde_json::to_string_pretty(self)
            .map(|text| text + "\n")
            .map_err(|e| Diagnostic::internal("manifest", format!("the manifest cannot be written as JSON: {e}")))
    }

    /// The manifest beside a .poly file, if there is one.
    ///
    /// # Errors
    /// If it is there and cannot be read.
    pub fn beside(poly: &Path) -> Result<Option<Self>, Diagnostic> {
        let path = path_beside(poly);
        let refused = |why: String| {
            Diagnostic::error("bad-manifest", format!("cannot read {}: {why}", path.display()))
                .hint("remove it to check the .poly without names, or write both again with `gsm build`")
        };
        match std::fs::metadata(&path) {
            Err(_) => return Ok(None),
            Ok(m) if m.len() > MAX_BYTES => return Err(refused(format!("more than {MAX_BYTES} bytes"))),
            Ok(_) => {}
        }
        let text = std::fs::read_to_string(&path).map_err(|e| refused(e.to_string()))?;
        serde_json::from_str(&text).map(Some).map_err(|e| refused(e.to_string()))
    }

    /// Name of a marker.
    pub fn marker_name(&self, marker: i64) -> Option<&str> {
        self.markers.iter().find(|m| m.marker == marker).map(|m| m.name.as_str())
    }

    /// Name of the part of a region.
    pub fn part_name(&self, region: i64) -> Option<&str> {
        self.regions.iter().find(|r| r.region == region).map(|r| r.part.as_str())
    }
}

impl Counts {
    /// The sizes of a PLC.
    pub fn of(plc: &Plc) -> Self {
        Self {
            vertices: plc.vertices.len(),
            facets: plc.facets.len(),
            polygons: plc.facets.iter().map(|f| f.polygons.len()).sum(),
            seeds: plc.seeds.len(),
            holes: plc.holes.len(),
        }
    }
}

/// `DIR/NAME.gsm.json` for `DIR/NAME.poly`.
pub fn path_beside(poly: &Path) -> PathBuf {
    poly.with_extension("gsm.json")
}
