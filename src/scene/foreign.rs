//! Files that are no scenes, by their names: what they are, and what to do with them instead.

use crate::diag::Diagnostic;
use std::path::Path;

/// Kinds of files that users hand over for a scene: extensions, what they are, what to do.
const KINDS: [(&[&str], &str, &str); 8] = [
    (&["stl", "obj", "off"], "a surface", "name it in a scene: "),
    (
        &["step", "stp", "iges", "igs", "brep", "sat", "x_t", "fcstd", "dxf"],
        "a model of a CAD program",
        "gsm does not read it: export each closed solid as .stl, .obj or .off and name it in a scene: ",
    ),
    (
        &["ply", "3mf", "glb", "gltf", "wrl"],
        "a surface",
        "gsm does not read it: save it as .stl, .obj or .off and name that in a scene: ",
    ),
    (
        &["poly", "smesh"],
        "a complex, which is built already",
        "`gsm check` verifies it, `gsm mesh` meshes it, `gsm convert` converts it",
    ),
    (
        &["node", "ele", "face", "edge", "neigh"],
        "a piece of TetGen's input or output",
        "name the .poly or .smesh that it stands beside",
    ),
    (
        &["msh", "mesh", "vtu", "vtk", "med", "unv", "inp", "bdf", "cgns", "xdmf", "e", "exo"],
        "a mesh",
        "`gsm convert` converts .msh and .mesh; a scene describes solids, and `gsm mesh` makes the mesh",
    ),
    (&["json"], "a manifest or other JSON", "name the .poly or the scene that it belongs to"),
    (&["geo", "geo_unrolled", "scad", "py", "jou"], "a program for another modeler", "`gsm new` writes a scene to start from"),
];

/// The fault of handing over a file of another kind for a scene; `None` for names that may be scenes'.
pub(super) fn told(path: &Path) -> Option<Diagnostic> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    let (_, what, hint) = KINDS.iter().find(|(names, ..)| names.contains(&extension.as_str()))?;
    let mut hint = (*hint).to_owned();
    if hint.ends_with(": ") {
        let file = Path::new(path.file_name()?).with_extension(if ["stl", "obj", "off"].contains(&extension.as_str()) {
            &extension
        } else {
            "stl"
        });
        hint +=
            &format!("Scene(units: \"mm\", parts: [Part(name: \"a\", solid: Import(file: {:?}))])", file.display().to_string());
    }
    Some(Diagnostic::error("no-scene", format!("this is {what}, not a scene")).hint(hint))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_told_by_their_names() {
        for (name, what, hint) in [
            ("rotor.STL", "a surface", "Import(file: \"rotor.stl\")"),
            ("a/b.step", "CAD", "Import(file: \"b.stl\")"),
            ("x.ply", "a surface", "Import(file: \"x.stl\")"),
            ("x.poly", "complex", "gsm check"),
            ("x.node", "TetGen", ".poly"),
            ("x.gsm.json", "manifest", ".poly"),
        ] {
            let fault = told(Path::new(name)).unwrap();
            assert!(fault.message.contains(what) && fault.hints[0].contains(hint), "{fault:?}");
        }
        for name in ["x.ron", "scene.txt", "scene", ".stl"] {
            assert_eq!(told(Path::new(name)), None);
        }
    }
}
