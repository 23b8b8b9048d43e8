//! Swept profiles and imported surfaces, as they are written to [`Primitive`].

use super::ast;
use super::frames::FrameFields;
use super::model::{Path2, Primitive, Profile};
use super::motion::radians;
use super::polyline::{bounds, is_swept_clear, tangent_fault};
use super::reader::{Owner, Reader};
use super::source::{Field, Raw};
use std::path::{Component, Path, PathBuf};

macro_rules! frame_fields {
    ($node:expr) => {
        FrameFields { base: $node.base, axis: $node.axis, x_axis: $node.x_axis, start: Field(None) }
    };
}

impl<'a> Reader<'a> {
    /// An outer loop and holes, closed, simple and disjoint.
    fn profile(&mut self, owner: Owner<'a>, outer: Field<'a>, holes: Field<'a>) -> Option<Profile> {
        let outer = self.need(owner, "profile", outer).and_then(|raw| self.closed_curve(raw));
        let list = self.read_or::<Vec<Raw>>(holes, Vec::new());
        let holes: Vec<Option<Path2>> = list?.into_iter().map(|raw| self.closed_curve(raw)).collect();
        let profile = Profile { outer: outer?, holes: holes.into_iter().collect::<Option<_>>()? };
        self.check_profile(owner, &profile)?;
        Some(profile)
    }

    fn closed_curve(&mut self, raw: Raw<'a>) -> Option<Path2> {
        let curve = self.curve(raw)?;
        if curve.is_closed {
            return Some(curve);
        }
        self.fail(raw, "open-profile", "a profile must be closed", "leave out `closed: false`: its end then joins its start")
    }

    /// Reports a profile that crosses itself, or holes that are not inside.
    pub fn check_profile(&mut self, owner: Owner<'a>, profile: &Profile) -> Option<()> {
        let Some((message, [x, y])) = super::polyline::profile_fault(profile) else { return Some(()) };
        let message = format!("the profile of the {}: {message} near ({x}, {y}) of its plane", owner.kind);
        self.fail(owner.raw, "self-crossing", message, "list the points in order around it, and holes inside of it and apart")
    }

    /// Translation of a profile.
    pub fn extrude(&mut self, owner: Owner<'a>, node: &ast::Extrude<'a>) -> Option<Primitive> {
        let profile = self.profile(owner, node.profile, node.holes);
        let length = self.needed_size(owner, "height", node.height);
        let frame = self.frame(owner, frame_fields!(node));
        Some(Primitive::Extrusion { frame: frame?, profile: profile?, length: length? })
    }

    /// Rotation of a profile; its x is the distance from the axis.
    pub fn revolve(&mut self, owner: Owner<'a>, node: &ast::Revolve<'a>) -> Option<Primitive> {
        let profile = self.profile(owner, node.profile, node.holes);
        let angle = node.angle.0.map_or(Some(360.0), |raw| match self.degrees("angle", raw)? {
            angle if 0.0 < angle && angle <= 360.0 => Some(angle),
            angle => {
                let message = format!("`angle` must lie above 0 and up to 360 degrees, it is {angle}");
                self.fail(raw, "out-of-range", message, "turn the other way by means of `start`; leave it out for a full turn")
            }
        });
        let start = node.start.0.map_or(Some(0.0), |raw| self.degrees("start", raw));
        let frame = self.frame(owner, frame_fields!(node));
        let profile = profile?;
        if bounds(&profile.outer)[0][0] < 0.0 {
            let raw = node.profile.0.unwrap_or(owner.raw);
            let message = "the profile of a Revolve must not cross its axis: x must not be negative";
            return self.fail(
                raw,
                "self-crossing",
                message,
                "its first coordinate is the distance from the axis: move it to x >= 0",
            );
        }
        Some(Primitive::Revolution { frame: frame?, profile, start: radians(start?), angle: radians(angle?) })
    }

    /// Sweep of a profile along a path.
    pub fn sweep(&mut self, owner: Owner<'a>, node: &ast::Sweep<'a>) -> Option<Primitive> {
        let profile = self.profile(owner, node.profile, node.holes);
        let path = self.need(owner, "path", node.path).and_then(|raw| self.curve(raw));
        let frame = self.frame(owner, frame_fields!(node));
        let (profile, path) = (profile?, path?);
        let at = node.path.0.unwrap_or(owner.raw);
        if let Some((message, [x, y])) = super::polyline::path_fault(&path) {
            let message = format!("the path: {message} near ({x}, {y}) of its plane");
            return self.fail(at, "self-crossing", message, "move its points so that it neither crosses nor touches itself");
        }
        if let Some(([x, y], is_back)) = tangent_fault(&path) {
            let message = format!("an arc of the path does not continue its neighbour smoothly at ({x}, {y})");
            let hint = if is_back {
                "it turns right back there: let the arc run the other way round by `ccw: false` or `ccw: true`, or correct `via`"
            } else {
                "let the arc begin in the direction of the segment before it: its centre lies at a right angle to that"
            };
            return self.fail(at, "bad-arc", message, hint);
        }
        let [lo, hi] = bounds(&profile.outer);
        if let Some([x, y]) = is_swept_clear(&path, lo[0], hi[0]) {
            let message = format!("the profile is wider than the bend of the path near ({x}, {y}): the sweep crosses itself");
            return self.fail(at, "self-crossing", message, "widen the bend, or make the profile narrower");
        }
        Some(Primitive::PathSweep { frame: frame?, profile, path })
    }

    /// A surface from a file, beside or below the scene.
    pub fn import(&mut self, owner: Owner<'a>, node: &ast::Import<'a>, folder: &Path, is_free: bool) -> Option<Primitive> {
        let path = self.need(owner, "file", node.file).and_then(|raw| self.import_path(raw, folder, is_free));
        let unit = node.unit.0.map_or(Some(self.unit), |raw| self.unit_name(raw));
        let factor = node.scale.0.map_or(Some(1.0), |raw| self.positive("scale", raw, super::expr::Kind::Plain));
        let scale = unit?.convert("1", 1, self.unit)? * factor?;
        Some(Primitive::Import { path: path?, scale })
    }

    fn import_path(&mut self, raw: Raw<'a>, folder: &Path, is_free: bool) -> Option<PathBuf> {
        let file: String = self.read(raw)?;
        let relative = Path::new(&file);
        let is_inside = relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
        if !is_inside && !is_free {
            let hint = "put the file beside the scene or into a folder below it";
            return self.fail(raw, "path-outside", format!("`{file}` leaves the folder of the scene"), hint);
        }
        let extension = relative.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        if !["obj", "off", "stl"].contains(&extension.as_str()) {
            let hint = "convert it: gsm imports closed surfaces of these formats";
            return self.fail(raw, "unknown-format", format!("`{file}` is not .obj, .off or .stl"), hint);
        }
        let path = folder.join(relative);
        if !path.is_file() {
            let message = match path.exists() {
                true => format!("`{}` is no regular file", path.display()),
                false => format!("there is no file `{}`", path.display()),
            };
            return self.fail(
                raw,
                "missing-file",
                message,
                "names of files start from the folder of the scene; capitals count",
            );
        }
        Some(path)
    }
}
