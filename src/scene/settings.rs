//! Settings of a scene, a part or a primitive: discretization, policies, remeshing, meshing.

use super::ast;
use super::expr::Kind;
use super::model::{Division, MeshOptions, RemeshOptions, Thresholds};
use super::motion::radians;
use super::reader::{Owner, Reader};
use super::source::{Field, Raw};
use crate::diag::Diagnostic;

/// Chords per circle unless something else is said: 15 degrees each, off the circle by 0.86 % of its radius.
pub(super) const DEFAULT_DIVISION: Division = Division { segments: Some(24), max_angle: None, max_chord_error: None };
/// Segments that can be written; memory limits come before.
const MAX_SEGMENTS: u32 = 1_000_000_000;

impl<'a> Reader<'a> {
    /// A discretization.
    pub fn division(&mut self, raw: Raw<'a>) -> Option<Division> {
        let node: ast::Discretization = self.read(raw)?;
        let segments = self.maybe(node.segments, |r, raw| r.count("segments", raw, 3, MAX_SEGMENTS));
        let max_angle = self.maybe(node.max_angle, |r, raw| match r.positive("max_angle", raw, Kind::Angle)? {
            angle if angle <= 120.0 => Some(radians(angle)),
            angle => {
                let message = format!("`max_angle` is {angle} degrees; a circle needs three chords at least");
                r.fail(raw, "out-of-range", message, "write 120 degrees or less; 15 gives 24 chords")
            }
        });
        let max_chord_error = self.maybe(node.max_chord_error, |r, raw| r.size("max_chord_error", raw));
        let division = Division { segments: segments?, max_angle: max_angle?, max_chord_error: max_chord_error? };
        if division == (Division { segments: None, max_angle: None, max_chord_error: None }) {
            let message = "a discretization needs `segments`, `max_angle` or `max_chord_error`";
            return self.fail(raw, "missing-field", message, "write for instance (segments: 24)");
        }
        Some(division)
    }

    /// How the scene is remeshed.
    pub fn remesh(&mut self, scene: &ast::Scene<'a>) -> Option<RemeshOptions> {
        let default = RemeshOptions::default();
        let mode = self.read_or(scene.remesh, default.mode);
        let patches = self.read_or(scene.patches, default.patches);
        let max_deviation = self.maybe(scene.max_deviation, |r, raw| r.size("max_deviation", raw));
        Some(RemeshOptions { mode: mode?, patches: patches?, max_deviation: max_deviation? })
    }

    /// How the volume is meshed.
    pub fn mesh(&mut self, field: Field<'a>) -> Option<MeshOptions> {
        let Some(raw) = field.0 else { return Some(MeshOptions::default()) };
        let node: ast::Mesh = self.read(raw)?;
        let ratio = self.maybe(node.ratio, |r, raw| match r.plain("ratio", raw)? {
            // Below sqrt(3/8) not even the regular tetrahedron passes; TetGen stops near 1.
            ratio if ratio >= 1.0 => Some(ratio),
            ratio => {
                let hint = "2 is usual, 1.414 is good, near 1 TetGen takes forever";
                r.fail(raw, "out-of-range", format!("`ratio` must be at least 1, it is {ratio}"), hint)
            }
        });
        let dihedral = self.maybe(node.dihedral, |r, raw| match r.degrees("dihedral", raw)? {
            // A regular tetrahedron has 70.5 degrees; no mesher reaches 45 everywhere.
            angle if (0.0..=45.0).contains(&angle) => Some(angle),
            angle => {
                let message = format!("`dihedral` must lie between 0 and 45 degrees, it is {angle}");
                r.fail(raw, "out-of-range", message, "10 to 18 degrees is what TetGen can reach")
            }
        });
        let thresholds = self.thresholds(&node);
        Some(MeshOptions {
            ratio: ratio?.unwrap_or(MeshOptions::default().ratio),
            dihedral: dihedral?,
            thresholds: thresholds?,
        })
    }

    fn thresholds(&mut self, node: &ast::Mesh<'a>) -> Option<Thresholds> {
        let angle = |r: &mut Self, name, field: Field<'a>| {
            r.maybe(field, |r, raw| match r.degrees(name, raw)? {
                angle if (0.0..=180.0).contains(&angle) => Some(angle),
                angle => {
                    let message = format!("`{name}` must lie between 0 and 180 degrees, it is {angle}");
                    r.fail(raw, "out-of-range", message, "write the smallest angle that a good mesh may have")
                }
            })
        };
        let number = |r: &mut Self, name, field: Field<'a>| {
            r.maybe(field, |r, raw| match r.plain(name, raw)? {
                number if number > 0.0 => Some(number),
                number => {
                    let message = format!("`{name}` must be positive, it is {number}");
                    r.fail(raw, "out-of-range", message, "write the largest value that a good mesh may have")
                }
            })
        };
        let min_dihedral = angle(self, "min_dihedral", node.min_dihedral);
        let min_angle = angle(self, "min_angle", node.min_angle);
        let max_ratio = number(self, "max_ratio", node.max_ratio);
        let max_aspect = number(self, "max_aspect", node.max_aspect);
        let max_condition = number(self, "max_condition", node.max_condition);
        Some(Thresholds {
            min_dihedral: min_dihedral?,
            max_ratio: max_ratio?,
            max_aspect: max_aspect?,
            min_angle: min_angle?,
            max_condition: max_condition?,
        })
    }

    /// A tolerance: a fraction of the model's size.
    pub fn tolerance(&mut self, raw: Raw<'a>) -> Option<f64> {
        let value = self.plain("tolerance", raw)?;
        // From the rounding of f64 coordinates to what would weld whole features.
        if (1e-15..=1e-3).contains(&value) {
            return Some(value);
        }
        let diagnostic = Diagnostic::error("out-of-range", format!("`tolerance` is {value:e}"))
            .at(self.span(raw))
            .hint("it is a fraction of the model's size, from 1e-15 to 1e-3 (default 1e-9)");
        self.fault(diagnostic);
        None
    }

    /// The unit of the scene, before anything else is read.
    pub fn scene_unit(&mut self, scene: &ast::Scene<'a>) {
        let owner = Owner { kind: "Scene", raw: self.source.whole() };
        if let Some(unit) = self.need(owner, "units", scene.units).and_then(|raw| self.unit_name(raw)) {
            self.unit = unit;
        }
    }

    /// A length unit by name.
    pub fn unit_name(&mut self, raw: Raw<'a>) -> Option<super::units::Unit> {
        let name: String = self.read(raw)?;
        let unit = super::units::Unit::named(&name);
        if unit.is_none() {
            let diagnostic = Diagnostic::error("wrong-unit", format!("unknown length unit `{name}`")).at(self.span(raw));
            let known = super::units::UNITS.iter().map(|u| u.name);
            self.fault(super::fault::with_names(diagnostic, &name, known));
        }
        unit
    }
}
