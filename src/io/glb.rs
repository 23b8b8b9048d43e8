//! glTF 2.0, binary (.glb), for viewers: one node per region (a mesh whose primitives are the pieces of its boundary), and, as
//! a second scene, one node per marker. Each interface's triangles are stored once and shared.

use super::mesh::Mesh;
use super::names::name_of;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// glTF constants.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Writes the triangles, `meters` being the length of the scene's unit.
///
/// Coordinates are single precision in glTF: they are stored about the box's centre, and the nodes move them back.
///
/// # Errors
/// What the writer reports; also if the mesh has more data than the format's 4 GiB.
pub fn write(mesh: &Mesh, meters: f64, out: &mut dyn Write) -> io::Result<()> {
    let center = if mesh.nodes.is_empty() { Default::default() } else { mesh.bounds().center() };
    let mut bytes: Vec<u8> = Vec::new();
    let (mut lo, mut hi) = ([f32::MAX; 3], [f32::MIN; 3]);
    for p in &mesh.nodes {
        for k in 0..3 {
            let x = (p[k] - center[k]) as f32;
            (lo[k], hi[k]) = (lo[k].min(x), hi[k].max(x));
            bytes.extend(x.to_le_bytes());
        }
    }
    let mut groups: BTreeMap<(u32, [u32; 2]), Vec<[u32; 3]>> = BTreeMap::new();
    for t in &mesh.triangles {
        groups.entry((t.marker, t.sides)).or_default().push(t.corners.map(|v| v.0));
    }
    let mut views = vec![json!({"buffer": 0, "byteOffset": 0, "byteLength": bytes.len(), "target": ARRAY_BUFFER})];
    let mut accessors = vec![json!({
        "bufferView": 0, "componentType": FLOAT, "count": mesh.nodes.len(), "type": "VEC3", "min": lo, "max": hi
    })];
    let mut by_region: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let mut by_marker: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for ((marker, sides), triangles) in &groups {
        let accessor = accessors.len();
        views.push(json!({
            "buffer": 0, "byteOffset": bytes.len(), "byteLength": 12 * triangles.len(), "target": ELEMENT_ARRAY_BUFFER
        }));
        accessors.push(json!({
            "bufferView": accessor, "componentType": UNSIGNED_INT, "count": 3 * triangles.len(), "type": "SCALAR",
            "name": name_of(&mesh.markers, *marker, "marker")
        }));
        bytes.extend(triangles.iter().flatten().flat_map(|v| v.to_le_bytes()));
        by_marker.entry(*marker).or_default().push(accessor);
        sides.iter().filter(|r| **r != 0).for_each(|r| by_region.entry(*r).or_default().push(accessor));
    }
    let mut document = Document { center: center.into(), meters, meshes: Vec::new(), nodes: Vec::new(), materials: Vec::new() };
    let parts: Vec<usize> =
        by_region.iter().map(|(r, list)| document.add(&name_of(&mesh.regions, *r, "region"), list)).collect();
    let interfaces: Vec<usize> =
        by_marker.iter().map(|(m, list)| document.add(&name_of(&mesh.markers, *m, "marker"), list)).collect();
    let parts = document.group(&parts);
    let interfaces = document.group(&interfaces);
    write_container(&document.finish(parts, interfaces, views, accessors, bytes.len()), &bytes, out)
}

struct Document {
    center: [f64; 3],
    meters: f64,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    materials: Vec<Value>,
}

impl Document {
    /// A named node with one mesh of these index accessors, in a colour of its own.
    fn add(&mut self, name: &str, accessors: &[usize]) -> usize {
        let k = self.materials.len();
        self.materials.push(json!({
            "name": name, "doubleSided": true, "pbrMetallicRoughness": {"baseColorFactor": color(k), "metallicFactor": 0.1}
        }));
        let primitives: Vec<Value> =
            accessors.iter().map(|a| json!({"attributes": {"POSITION": 0}, "indices": a, "material": k})).collect();
        self.meshes.push(json!({"name": name, "primitives": primitives}));
        self.nodes.push(json!({"name": name, "mesh": k, "translation": self.center}));
        self.nodes.len() - 1
    }

    /// A root over the nodes: metres, and the scene's z upwards (glTF has y).
    fn group(&mut self, children: &[usize]) -> Option<usize> {
        if children.is_empty() {
            return None;
        }
        let s = self.meters;
        let matrix = [s, 0.0, 0.0, 0.0, 0.0, 0.0, -s, 0.0, 0.0, s, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        self.nodes.push(json!({"children": children, "matrix": matrix}));
        Some(self.nodes.len() - 1)
    }

    fn finish(
        self,
        parts: Option<usize>,
        interfaces: Option<usize>,
        views: Vec<Value>,
        accessors: Vec<Value>,
        size: usize,
    ) -> Value {
        let scenes: Vec<Value> = [("parts", parts), ("interfaces", interfaces)]
            .into_iter()
            .filter_map(|(name, root)| Some(json!({"name": name, "nodes": [root?]})))
            .collect();
        let generator = concat!("gsm ", env!("CARGO_PKG_VERSION"));
        if scenes.is_empty() {
            return json!({"asset": {"version": "2.0", "generator": generator}});
        }
        json!({
            "asset": {"version": "2.0", "generator": generator}, "scene": 0, "scenes": scenes, "nodes": self.nodes,
            "meshes": self.meshes, "materials": self.materials, "accessors": accessors, "bufferViews": views,
            "buffers": [{"byteLength": size}]
        })
    }
}

/// Colours that stay apart: hues by the golden ratio.
fn color(k: usize) -> [f64; 4] {
    let hue = (k as f64 * 0.618_033_988_75).fract() * 6.0;
    let channel = |shift: f64| 0.35 + 0.5 * (2.0 - ((hue + shift) % 6.0 - 3.0).abs()).clamp(0.0, 1.0);
    [channel(3.0), channel(1.0), channel(5.0), 1.0]
}

/// Header, JSON chunk padded with blanks, binary chunk padded with zeros.
fn write_container(document: &Value, bytes: &[u8], out: &mut dyn Write) -> io::Result<()> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = bytes.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = |n: usize| u32::try_from(n).map_err(|_| io::Error::other("a .glb cannot hold more than 4 GiB"));
    out.write_all(b"glTF")?;
    let binary_chunk = if binary.is_empty() { 0 } else { 8 + binary.len() };
    for word in [2, length(20 + text.len() + binary_chunk)?, length(text.len())?] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    if !binary.is_empty() {
        out.write_all(&length(binary.len())?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(&binary)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::mesh::tests::cube;

    #[test]
    fn container_holds_all_names_and_every_triangle_once() {
        let mut file = Vec::new();
        write(&cube(), 1.0, &mut file).unwrap();
        let word = |k: usize| u32::from_le_bytes(file[k..k + 4].try_into().unwrap()) as usize;
        assert_eq!((&file[..4], word(4), word(8)), (&b"glTF"[..], 2, file.len()));
        let document: Value = serde_json::from_slice(&file[20..20 + word(12)]).unwrap();
        let names: Vec<_> = document["meshes"].as_array().unwrap().iter().map(|m| m["name"].as_str().unwrap()).collect();
        assert_eq!(names, ["iron", "air", "iron|outer", "air|outer", "iron|air"]);
        let size = 8 * 12 + 14 * 12;
        assert_eq!((document["buffers"][0]["byteLength"].as_u64(), word(20 + word(12))), (Some(size), size as usize));
    }
}
