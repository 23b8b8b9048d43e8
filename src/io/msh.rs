//! Gmsh MSH 2.2 and 4.1, ASCII. Version 2.2 is what GetDP, NGSolve, MFEM, scikit-fem and Gmsh all read, so it is the default.
//!
//! What the solvers need (measured, 2026): both tags of an element equal, since GetDP takes the first and NGSolve the second;
//! a name for every tag; one triangle per interface face, also inside; disjoint numbers for volumes and surfaces.

use super::mesh::{Mesh, NodeId, Tet, Triangle};
use super::names::Tags;
use super::words::Words;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Write};

/// Element type numbers of the format, with their count of nodes.
const TRIANGLE: u32 = 2;
const TETRAHEDRON: u32 = 4;

/// Writes version 2.2. Triangles with marker 0 are left out: they carry no condition.
///
/// # Errors
/// What the writer reports.
pub fn write_22(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let tags = Tags::new(mesh);
    write_head("2.2", &tags, out)?;
    writeln!(out, "$Nodes\n{}", mesh.nodes.len())?;
    for (v, p) in mesh.nodes.enumerate() {
        writeln!(out, "{} {:?} {:?} {:?}", v.0 + 1, p.x, p.y, p.z)?;
    }
    let surface: Vec<_> = mesh.triangles.iter().filter_map(|t| Some((tags.surface(t.marker)?, t))).collect();
    writeln!(out, "$EndNodes\n$Elements\n{}", surface.len() + mesh.tets.len())?;
    let mut number = 0;
    for (tag, t) in surface {
        number += 1;
        let [a, b, c] = t.corners.map(|v| v.0 + 1);
        writeln!(out, "{number} {TRIANGLE} 2 {tag} {tag} {a} {b} {c}")?;
    }
    for t in &mesh.tets {
        number += 1;
        let ([a, b, c, d], r) = (t.corners.map(|v| v.0 + 1), t.region);
        writeln!(out, "{number} {TETRAHEDRON} 2 {r} {r} {a} {b} {c} {d}")?;
    }
    writeln!(out, "$EndElements")
}

/// Writes version 4.1: one entity per region and per marker, each its own physical group.
///
/// # Errors
/// What the writer reports.
pub fn write_41(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let tags = Tags::new(mesh);
    write_head("4.1", &tags, out)?;
    let bounds = mesh.bounds();
    let corner = |p: Vec3| format!("{:?} {:?} {:?}", p.x, p.y, p.z);
    let bounds = format!("{} {}", corner(bounds.lo), corner(bounds.hi));
    writeln!(out, "$Entities\n0 0 {} {}", tags.surfaces.len(), tags.volumes.len())?;
    for tag in tags.surfaces.keys().chain(tags.volumes.keys()) {
        writeln!(out, "{tag} {bounds} 1 {tag} 0")?;
    }
    writeln!(out, "$EndEntities")?;
    let mut blocks: BTreeMap<(u32, u32), Vec<Vec<u32>>> = BTreeMap::new();
    for t in &mesh.triangles {
        if let Some(tag) = tags.surface(t.marker) {
            blocks.entry((2, tag)).or_default().push(t.corners.map(|v| v.0 + 1).to_vec());
        }
    }
    for t in &mesh.tets {
        blocks.entry((3, t.region)).or_default().push(t.corners.map(|v| v.0 + 1).to_vec());
    }
    // All nodes stand in one block of one entity: which entity a node lies on carries nothing here.
    let (dimension, tag) = blocks.last_key_value().map_or((3, 1), |(key, _)| *key);
    let count = mesh.nodes.len();
    writeln!(out, "$Nodes\n1 {count} 1 {count}\n{dimension} {tag} 0 {count}")?;
    for v in mesh.nodes.ids() {
        writeln!(out, "{}", v.0 + 1)?;
    }
    for p in &mesh.nodes {
        writeln!(out, "{}", corner(*p))?;
    }
    let count: usize = blocks.values().map(Vec::len).sum();
    writeln!(out, "$EndNodes\n$Elements\n{} {count} 1 {count}", blocks.len())?;
    let mut number = 0;
    for ((dimension, tag), elements) in &blocks {
        let kind = if *dimension == 2 { TRIANGLE } else { TETRAHEDRON };
        writeln!(out, "{dimension} {tag} {kind} {}", elements.len())?;
        for corners in elements {
            number += 1;
            write!(out, "{number}")?;
            corners.iter().try_for_each(|v| write!(out, " {v}"))?;
            writeln!(out)?;
        }
    }
    writeln!(out, "$EndElements")
}

fn write_head(version: &str, tags: &Tags, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "$MeshFormat\n{version} 0 8\n$EndMeshFormat")?;
    writeln!(out, "$PhysicalNames\n{}", tags.surfaces.len() + tags.volumes.len())?;
    for (tag, name) in &tags.surfaces {
        writeln!(out, "2 {tag} \"{name}\"")?;
    }
    for (tag, name) in &tags.volumes {
        writeln!(out, "3 {tag} \"{name}\"")?;
    }
    writeln!(out, "$EndPhysicalNames")
}

/// Reads version 2.x or 4.1, ASCII: triangles and tetrahedra of first order with their physical groups; other elements are
/// passed over.
///
/// # Errors
/// A [`Diagnostic`] with file and line if the text is none of these.
pub fn read(file: &str, text: &str) -> Result<Mesh, Diagnostic> {
    let mut reader = Reader { words: Words::new(file, text, None), mesh: Mesh::default(), node: HashMap::new() };
    let mut version = 0.0;
    let mut physical = BTreeMap::new();
    while let Some(word) = reader.words.next_word() {
        match word {
            "$MeshFormat" => {
                version = reader.words.real("a version")?;
                if !(2.0..3.0).contains(&version) && version != 4.1 {
                    return Err(reader.words.fault(format!("version {version} is neither 2.x nor 4.1")));
                }
                if reader.words.number::<u32>("a file type")? != 0 {
                    return Err(reader.words.fault("is binary; write it as ASCII"));
                }
            }
            "$PhysicalNames" => reader.read_names()?,
            "$Entities" => physical = reader.read_entities()?,
            "$Nodes" if version < 4.0 => reader.read_nodes_2()?,
            "$Nodes" => reader.read_nodes_4()?,
            "$Elements" if version < 4.0 => reader.read_elements_2()?,
            "$Elements" => reader.read_elements_4(&physical)?,
            _ => {}
        }
    }
    if version == 0.0 {
        return Err(reader.words.fault("is no MSH file: $MeshFormat is missing"));
    }
    let mut mesh = reader.mesh;
    mesh.drop_unused_nodes();
    mesh.orient();
    Ok(mesh)
}

struct Reader<'t> {
    words: Words<'t>,
    mesh: Mesh,
    node: HashMap<u64, NodeId>,
}

impl Reader<'_> {
    fn read_names(&mut self) -> Result<(), Diagnostic> {
        let count: u64 = self.words.number("a count of names")?;
        for _ in 0..count {
            let Some(line) = self.words.next_line() else { return Err(self.words.fault("ends within the names")) };
            let mut parts = line.splitn(3, char::is_whitespace);
            let (dimension, tag, name) = (parts.next(), parts.next().and_then(|w| w.parse().ok()), parts.next());
            let (Some(tag), Some(name)) = (tag, name) else { return Err(self.words.fault("is no `dimension tag \"name\"`")) };
            let name = name.trim().trim_matches('"').to_string();
            match dimension {
                Some("2") => self.mesh.markers.insert(tag, name),
                Some("3") => self.mesh.regions.insert(tag, name),
                _ => None,
            };
        }
        Ok(())
    }

    /// Physical group of each surface and volume entity.
    fn read_entities(&mut self) -> Result<BTreeMap<(u32, i64), u32>, Diagnostic> {
        let mut counts = [0u64; 4];
        for c in &mut counts {
            *c = self.words.number("a count of entities")?;
        }
        let mut physical = BTreeMap::new();
        for (dimension, count) in (0u32..).zip(counts) {
            for _ in 0..count {
                let tag: i64 = self.words.number("an entity")?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    self.words.real("a bound")?;
                }
                let groups: u64 = self.words.number("a count of physical groups")?;
                for k in 0..groups {
                    let group: i64 = self.words.number("a physical group")?;
                    if k == 0 {
                        physical.insert((dimension, tag), u32::try_from(group.abs()).unwrap_or(0));
                    }
                }
                // The bounding entities are not needed.
                self.words.rest_of_line();
            }
        }
        Ok(physical)
    }

    fn add_node(&mut self, number: u64) -> Result<(), Diagnostic> {
        let point = self.words.point()?;
        self.node.insert(number, self.mesh.nodes.push(point));
        Ok(())
    }

    fn read_nodes_2(&mut self) -> Result<(), Diagnostic> {
        let count: u64 = self.words.number("a count of nodes")?;
        for _ in 0..count {
            let number = self.words.number("a node number")?;
            self.add_node(number)?;
        }
        Ok(())
    }

    fn read_nodes_4(&mut self) -> Result<(), Diagnostic> {
        let blocks: u64 = self.words.number("a count of blocks")?;
        self.words.rest_of_line();
        for _ in 0..blocks {
            self.words.number::<u32>("a dimension")?;
            self.words.number::<i64>("an entity")?;
            if self.words.number::<u32>("0")? != 0 {
                return Err(self.words.fault("has parametric nodes, which are not read"));
            }
            let count: u64 = self.words.number("a count of nodes")?;
            let mut numbers = Vec::new();
            for _ in 0..count {
                numbers.push(self.words.number("a node number")?);
            }
            numbers.into_iter().try_for_each(|n| self.add_node(n))?;
        }
        Ok(())
    }

    fn corners<const N: usize>(&mut self) -> Result<[NodeId; N], Diagnostic> {
        let mut corners = [NodeId(0); N];
        for c in &mut corners {
            let number: u64 = self.words.number("a node number")?;
            *c = *self.node.get(&number).ok_or_else(|| self.words.fault(format!("node {number} does not exist")))?;
        }
        Ok(corners)
    }

    fn add_element(&mut self, kind: u32, tag: u32) -> Result<(), Diagnostic> {
        match kind {
            TRIANGLE => {
                let corners = self.corners()?;
                self.mesh.triangles.push(Triangle { corners, marker: tag, sides: [0, 0] });
            }
            TETRAHEDRON => {
                let corners = self.corners()?;
                self.mesh.tets.push(Tet { corners, region: tag });
            }
            _ => {
                self.words.rest_of_line();
            }
        }
        Ok(())
    }

    fn read_elements_2(&mut self) -> Result<(), Diagnostic> {
        let count: u64 = self.words.number("a count of elements")?;
        for _ in 0..count {
            self.words.number::<u64>("an element number")?;
            let kind = self.words.number("an element type")?;
            let tags: u32 = self.words.number("a count of tags")?;
            let mut physical = 0;
            for k in 0..tags {
                let tag: i64 = self.words.number("a tag")?;
                if k == 0 {
                    physical = u32::try_from(tag).unwrap_or(0);
                }
            }
            self.add_element(kind, physical)?;
        }
        Ok(())
    }

    fn read_elements_4(&mut self, physical: &BTreeMap<(u32, i64), u32>) -> Result<(), Diagnostic> {
        let blocks: u64 = self.words.number("a count of blocks")?;
        self.words.rest_of_line();
        for _ in 0..blocks {
            let dimension = self.words.number("a dimension")?;
            let entity = self.words.number("an entity")?;
            let kind = self.words.number("an element type")?;
            let count: u64 = self.words.number("a count of elements")?;
            let tag = physical.get(&(dimension, entity)).copied().unwrap_or(0);
            for _ in 0..count {
                self.words.number::<u64>("an element number")?;
                self.add_element(kind, tag)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::mesh::tests::cube;

    #[test]
    fn both_versions_come_back_whole() {
        let mesh = cube();
        for write in [write_22, write_41] {
            let mut text = Vec::new();
            write(&mesh, &mut text).unwrap();
            let mut back = read("x.msh", std::str::from_utf8(&text).unwrap()).unwrap();
            let key = |t: &Triangle| (t.marker, t.corners);
            back.triangles.sort_by_key(key);
            let mut expected = mesh.clone();
            expected.triangles.sort_by_key(key);
            back.tets.sort_by_key(|t| t.corners);
            expected.tets.sort_by_key(|t| t.corners);
            assert_eq!(back, expected);
        }
    }

    #[test]
    fn faults_name_the_line_and_take_no_memory() {
        let fault = |text| read("x.msh", text).unwrap_err().message;
        assert!(fault("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n999999999999\n1 0 0 0\n").contains("x.msh:6"));
        assert!(fault("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 nan 0\n").contains("not finite"));
        assert!(fault("solid\n").contains("no MSH file"));
        assert!(fault("$MeshFormat\n2.2 1 8\n").contains("binary"));
    }
}
