//! Plane chains of lines and arcs as vertices: profiles and paths.

use super::angle;
use super::circle::Circle;
use super::division::{self, check_count};
use crate::diag::Diagnostic;
use crate::geom::plane::distance;
use crate::scene::model::{Arc2, Division, Path2};

/// Directions that differ by less (sine of the angle) join smoothly: tangent points are written with rounded numbers.
const SMOOTH: f64 = 1e-4;

/// A vertex of a chain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OutlineVertex {
    /// Position in the plane of the chain.
    pub xy: [f64; 2],
    /// If it is a point made on a shared circle: which, at the axis' degrees, at which radius.
    pub on_circle: Option<OnCircle>,
    /// Whether the direction of the chain jumps there.
    pub is_corner: bool,
    /// Whether an arc about the same centre begins or ends there, in this leaf or another.
    pub is_hard: bool,
}

/// A point of a shared circle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnCircle {
    /// Which of the leaf's circles.
    pub circle: usize,
    /// The axis' degrees.
    pub degrees: f64,
    /// Local radius.
    pub radius: f64,
}

/// The edges of one segment of a chain.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    /// Index of the first vertex.
    pub first: usize,
    /// Number of edges.
    pub count: usize,
    /// Circle, if the segment is an arc.
    pub arc: Option<RunArc>,
    /// Name of the side.
    pub name: String,
}

/// The circle of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunArc {
    /// Centre.
    pub center: [f64; 2],
    /// Radius.
    pub radius: f64,
    /// Whether the run turns counter-clockwise.
    pub is_ccw: bool,
    /// Which of the leaf's circles divides it, if shared.
    pub circle: Option<usize>,
}

/// A divided chain. Closed ones do not repeat their first vertex.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub vertices: Vec<OutlineVertex>,
    pub runs: Vec<Run>,
    pub is_closed: bool,
}

/// How arcs and lines of a chain are divided.
pub(crate) enum Rule<'a> {
    /// Arcs by the leaf's circles, which are taken in order from `next`.
    Shared { circles: &'a [Circle], next: usize },
    /// Arcs on their own; no edge longer than `longest`.
    Own { division: &'a Division, scale: f64, longest: f64 },
}

/// Counter-clockwise range of an arc from `from` to `to`: first angle and sweep in degrees; 360 if the ends coincide.
pub(crate) fn range_of(arc: &Arc2, from: [f64; 2], to: [f64; 2]) -> (f64, f64) {
    let [a, b] = [from, to].map(|p| angle::of_direction(p[0] - arc.center[0], p[1] - arc.center[1]));
    let (a, b) = if arc.is_ccw { (a, b) } else { (b, a) };
    let sweep = angle::tidy(angle::canonical(b - a));
    let is_short = sweep == 0.0 || sweep == 360.0;
    // Ends that differ by less than angles tell are those of an arc as short as its chord.
    let chord = || (distance(from, to) / distance(arc.center, from)).to_degrees();
    (
        a,
        if from == to {
            360.0
        } else if is_short {
            chord()
        } else {
            sweep
        },
    )
}

/// Twice the signed area of a closed chain of points.
pub(crate) fn doubled_area(points: &[[f64; 2]]) -> f64 {
    let Some(&o) = points.first() else { return 0.0 };
    let cross = |a: [f64; 2], b: [f64; 2]| (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    (0..points.len()).map(|k| cross(points[k], points[(k + 1) % points.len()])).sum()
}

impl Outline {
    /// Divides a chain; `name` gives the side of the n-th segment (from 0).
    ///
    /// # Errors
    /// If a segment has no length, a circle is one segment of several, or limits are passed.
    pub fn new(path: &Path2, name: impl Fn(usize) -> String, rule: &mut Rule) -> Result<Self, Diagnostic> {
        let mut outline = Self { vertices: Vec::new(), runs: Vec::new(), is_closed: path.is_closed };
        let mut from = path.start;
        for (k, segment) in path.segments.iter().enumerate() {
            let first = outline.vertices.len();
            outline.push(from);
            let name = segment.name.clone().unwrap_or_else(|| name(k));
            let mut arc = None;
            if let Some(a) = &segment.arc {
                if from == segment.end {
                    if path.segments.len() > 1 || !path.is_closed {
                        return Err(bad("a full circle must be the only segment of a closed chain", from));
                    }
                    outline.vertices.clear();
                }
                arc = Some(outline.push_arc(a, from, segment.end, rule)?);
            }
            outline.runs.push(Run { first, count: outline.vertices.len() - first, arc, name });
            from = segment.end;
        }
        if !path.is_closed {
            outline.push(from);
        }
        outline.check_lengths()?;
        outline.mark_corners();
        Ok(outline)
    }

    fn push(&mut self, xy: [f64; 2]) {
        self.vertices.push(OutlineVertex { xy, on_circle: None, is_corner: false, is_hard: false });
    }

    /// Pushes the inner vertices of an arc (all vertices of a full circle).
    fn push_arc(&mut self, arc: &Arc2, from: [f64; 2], to: [f64; 2], rule: &mut Rule) -> Result<RunArc, Diagnostic> {
        let radius = distance(arc.center, from);
        let (start, sweep) = range_of(arc, from, to);
        let is_full = sweep >= 360.0;
        let mut run = RunArc { center: arc.center, radius, is_ccw: arc.is_ccw, circle: None };
        let mut points: Vec<(f64, Option<f64>, bool)> = Vec::new();
        match rule {
            Rule::Shared { circles, next } => {
                let circle = &circles[*next];
                run.circle = Some(*next);
                *next += 1;
                points.extend(circle.breakpoints.iter().map(|b| (circle.start + b.along, Some(b.degrees), b.is_hard)));
            }
            Rule::Own { division, scale, longest } => {
                let segments = f64::from(division::segments(division, radius * *scale)?);
                let parts = (sweep * segments / 360.0 * (1.0 - 1e-12)).ceil();
                let parts = parts.max((sweep.to_radians() * radius / *longest * (1.0 - 1e-12)).ceil());
                // An even number reads the same from its start either way round.
                let parts = if is_full { 2.0 * (parts * 0.5).ceil() } else { parts };
                check_count(parts)?;
                let last = parts as u32 - u32::from(is_full);
                points.extend((0..=last).map(|k| (start + sweep * f64::from(k) / parts, None, false)));
            }
        }
        if !arc.is_ccw {
            points.reverse();
        }
        let inner = if is_full { &points[..] } else { &points[1..points.len() - 1] };
        for &(local, degrees, is_hard) in inner {
            let (c, s) = angle::cos_sin(local);
            let xy = [arc.center[0] + radius * c, arc.center[1] + radius * s];
            let on_circle = run.circle.zip(degrees).map(|(circle, degrees)| OnCircle { circle, degrees, radius });
            self.vertices.push(OutlineVertex { xy, on_circle, is_corner: false, is_hard });
        }
        Ok(run)
    }

    fn check_lengths(&self) -> Result<(), Diagnostic> {
        let n = self.vertices.len();
        let edges = if self.is_closed { n } else { n.saturating_sub(1) };
        match (0..edges).find(|&k| self.vertices[k].xy == self.vertices[(k + 1) % n].xy) {
            Some(k) => Err(bad("a segment has no length", self.vertices[k].xy)),
            None if edges == 0 || self.is_closed && edges < 3 => {
                Err(bad("the chain is too short", self.vertices.first().map_or([0.0; 2], |v| v.xy)))
            }
            None => Ok(()),
        }
    }

    /// Corners are the joints of segments where the direction jumps; a joint of two lines always is one.
    fn mark_corners(&mut self) {
        let n = self.vertices.len();
        for r in 0..self.runs.len() {
            let run = &self.runs[r];
            let before = match (r, self.is_closed) {
                (0, false) => None,
                (0, true) => self.runs.last(),
                _ => Some(&self.runs[r - 1]),
            };
            let is_circle = run.arc.is_some() && run.count == n;
            let is_smooth = before.is_some_and(|b| {
                let (u, v) = (self.direction(b, run.first), self.direction(run, run.first));
                let is_curved = run.arc.is_some() || b.arc.is_some();
                is_curved && (u[0] * v[1] - u[1] * v[0]).abs() < SMOOTH && u[0] * v[0] + u[1] * v[1] > 0.0
            });
            let first = run.first;
            self.vertices[first].is_corner = !is_circle && !is_smooth;
        }
        if !self.is_closed
            && let Some(last) = self.vertices.last_mut()
        {
            last.is_corner = true;
        }
    }

    /// Unit direction of a run at one of its vertices.
    pub fn direction(&self, run: &Run, vertex: usize) -> [f64; 2] {
        let n = self.vertices.len();
        let p = self.vertices[vertex % n].xy;
        let d = match &run.arc {
            Some(a) if a.is_ccw => [a.center[1] - p[1], p[0] - a.center[0]],
            Some(a) => [p[1] - a.center[1], a.center[0] - p[0]],
            None => {
                let (a, b) = (self.vertices[run.first].xy, self.vertices[(run.first + run.count) % n].xy);
                [b[0] - a[0], b[1] - a[1]]
            }
        };
        let length = libm::hypot(d[0], d[1]);
        [d[0] / length, d[1] / length]
    }

    /// All positions.
    pub fn points(&self) -> Vec<[f64; 2]> {
        self.vertices.iter().map(|v| v.xy).collect()
    }

    /// Turns a closed chain so that it is counter-clockwise, or clockwise.
    pub fn orient(&mut self, is_ccw: bool) {
        if (doubled_area(&self.points()) > 0.0) == is_ccw {
            return;
        }
        let n = self.vertices.len();
        self.vertices.reverse();
        self.runs.reverse();
        for run in &mut self.runs {
            run.first = (2 * n - 1 - run.first - run.count) % n;
            if let Some(arc) = &mut run.arc {
                arc.is_ccw = !arc.is_ccw;
            }
        }
    }
}

fn bad(message: &str, at: [f64; 2]) -> Diagnostic {
    Diagnostic::error("bad-profile", format!("{message} (at {}, {} in its plane)", at[0], at[1]))
        .hint("use more segments, or correct the curve there")
}
