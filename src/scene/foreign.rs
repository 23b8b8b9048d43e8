//! Files that are no scenes, by their names: what they are, and what to do with them instead.

use crate::diag::Diagnostic;
use std::path::Path;

/// A kind of files that users hand over for a scene.
struct Kind {
    extensions: &'static [&'static str],
    what: &'static str,
    /// What to do with it.
    hint: &'static str,
    /// What a scene can name of it: the hint then ends with an example.
    surface: Surface,
}

/// What a scene can name of a file.
enum Surface {
    None,
    /// The file itself.
    Itself,
    /// What it is saved as, a .stl for instance.
    Saved,
}

const KINDS: [Kind; 8] = [
    Kind { extensions: &["stl", "obj", "off"], what: "a surface", hint: "name it in a scene", surface: Surface::Itself },
    Kind {
        extensions: &["step", "stp", "iges", "igs", "brep", "sat", "x_t", "fcstd", "dxf"],
        what: "a model of a CAD program",
        hint: "gsm does not read it: export each closed solid as .stl, .obj or .off and name it in a scene",
        surface: Surface::Saved,
    },
    Kind {
        extensions: &["ply", "3mf", "glb", "gltf", "wrl"],
        what: "a surface",
        hint: "gsm does not read it: save it as .stl, .obj or .off and name that in a scene",
        surface: Surface::Saved,
    },
    Kind {
        extensions: &["poly", "smesh"],
        what: "a complex, which is built already",
        hint: "`gsm check` verifies it, `gsm mesh` meshes it, `gsm convert` converts it",
        surface: Surface::None,
    },
    Kind {
        extensions: &["node", "ele", "face", "edge", "neigh"],
        what: "a piece of TetGen's input or output",
        hint: "name the .poly or .smesh that it stands beside",
        surface: Surface::None,
    },
    Kind {
        extensions: &["msh", "mesh", "vtu", "vtk", "med", "unv", "inp", "bdf", "cgns", "xdmf", "e", "exo"],
        what: "a mesh",
        hint: "`gsm convert` converts .msh and .mesh; a scene describes solids, and `gsm mesh` makes the mesh",
        surface: Surface::None,
    },
    Kind {
        extensions: &["json"],
        what: "a manifest or other JSON",
        hint: "name the .poly or the scene that it belongs to",
        surface: Surface::None,
    },
    Kind {
        extensions: &["geo", "geo_unrolled", "scad", "py", "jou"],
        what: "a program for another modeler",
        hint: "`gsm new` writes a scene to start from",
        surface: Surface::None,
    },
];

/// The fault of handing over a file of another kind for a scene; `None` for names that may be scenes'.
pub(super) fn told(path: &Path) -> Option<Diagnostic> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    let kind = KINDS.iter().find(|kind| kind.extensions.contains(&extension.as_str()))?;
    let name = Path::new(path.file_name()?);
    let file = match kind.surface {
        Surface::None => None,
        Surface::Itself => Some(name.display().to_string()),
        Surface::Saved => Some(name.with_extension("stl").display().to_string()),
    };
    let example = |file| format!(": Scene(units: \"mm\", parts: [Part(name: \"a\", solid: Import(file: {file:?}))])");
    let hint = kind.hint.to_owned() + &file.map_or_else(String::new, example);
    Some(Diagnostic::usage("no-scene", format!("this is {}, not a scene", kind.what)).hint(hint))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_told_by_their_names() {
        for (name, what, hint) in [
            (
                "rotor.STL",
                "a surface",
                "in a scene: Scene(units: \"mm\", parts: [Part(name: \"a\", solid: Import(file: \"rotor.STL\"))])",
            ),
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
