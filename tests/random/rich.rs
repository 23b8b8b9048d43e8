//! Random solids of everything that the scene language has: imports, sweeps along arcs, patterns, scales and mirrors, nests.

use super::generator::Generator;
use gsm::geom::Vec3;
use gsm::geom::predicates::orient3d;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Surfaces that imports read, each as .off, .obj and .stl.
const FILES: u64 = 24;

/// The folder with the surfaces that imports read; they are written when it is asked for first.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("random-imports");
        fs::create_dir_all(&folder).unwrap();
        for k in 0..FILES {
            let (points, triangles) = star(&mut Generator::new(1_000_000 + k));
            let text = match k % 3 {
                0 => off(&points, &triangles),
                1 => obj(&points, &triangles),
                _ => stl(&points, &triangles),
            };
            fs::write(folder.join(file(k)), text).unwrap();
        }
        folder
    })
}

fn file(k: u64) -> String {
    format!("star{k}.{}", ["off", "obj", "stl"][(k % 3) as usize])
}

type Triangles = Vec<[usize; 3]>;

/// An octahedron whose triangles are divided once or twice, each vertex moved along its ray or to a round place near: a surface
/// that every ray from the origin meets once.
fn star(random: &mut Generator) -> (Vec<Vec3>, Triangles) {
    let mut points: Vec<Vec3> = [Vec3::x(), Vec3::y(), Vec3::z(), -Vec3::x(), -Vec3::y(), -Vec3::z()].to_vec();
    let mut triangles: Triangles = Vec::new();
    for k in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| axis + 3 * (k >> axis & 1));
        triangles.push(if [0, 3, 5, 6].contains(&k) { [x, y, z] } else { [x, z, y] });
    }
    for _ in 0..1 + random.below(2) {
        triangles = divided(&mut points, &triangles);
    }
    let is_star = |points: &[Vec3]| {
        let at = |v: usize| &points[v];
        triangles.iter().all(|&[a, b, c]| orient3d(at(a), at(b), at(c), &Vec3::zeros()) < 0)
    };
    let is_round = random.below(2) == 0;
    for v in 0..points.len() {
        let before = points[v];
        points[v] *= random.between(0.6, 1.6);
        if is_round {
            points[v] = points[v].map(|x| (4.0 * x).round() / 4.0);
        }
        if !is_star(&points) {
            points[v] = before;
        }
    }
    (points, triangles)
}

/// Every triangle in four, the new vertices on the unit sphere.
fn divided(points: &mut Vec<Vec3>, triangles: &Triangles) -> Triangles {
    let mut middles = BTreeMap::new();
    let mut middle = |a: usize, b: usize| {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            points.push((points[a] + points[b]).normalize());
            points.len() - 1
        })
    };
    let mut out = Triangles::new();
    for &[a, b, c] in triangles {
        let [d, e, f] = [middle(b, c), middle(c, a), middle(a, b)];
        out.extend([[a, f, e], [f, b, d], [e, d, c], [d, e, f]]);
    }
    out
}

fn lines(head: &str, points: &[Vec3], triangles: &Triangles, [vertex, facet]: [&str; 2], first: usize) -> String {
    let mut text = head.to_owned();
    points.iter().for_each(|p| writeln!(text, "{vertex}{:?} {:?} {:?}", p.x, p.y, p.z).unwrap());
    triangles.iter().for_each(|[a, b, c]| writeln!(text, "{facet}{} {} {}", a + first, b + first, c + first).unwrap());
    text
}

fn off(points: &[Vec3], triangles: &Triangles) -> String {
    lines(&format!("OFF\n{} {} 0\n", points.len(), triangles.len()), points, triangles, ["", "3 "], 0)
}

fn obj(points: &[Vec3], triangles: &Triangles) -> String {
    lines("", points, triangles, ["v ", "f "], 1)
}

fn stl(points: &[Vec3], triangles: &Triangles) -> String {
    let mut text = "solid star\n".to_owned();
    for corners in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for p in corners.map(|v| points[v]) {
            writeln!(text, "vertex {} {} {}", p.x as f32, p.y as f32, p.z as f32).unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid star\n"
}

impl Generator {
    /// A tree over solids of all kinds; it may be repeated, mirrored, scaled or turned as a whole.
    pub fn rich_tree(&mut self, depth: u64) -> String {
        if depth == 0 {
            return self.rich_leaf();
        }
        let operation = ["Union", "Difference", "Intersection", "Xor"][self.below(4) as usize];
        let operands: Vec<String> = (0..2 + self.below(2))
            .map(|_| {
                let below = self.below(depth);
                self.rich_tree(below)
            })
            .collect();
        let whole = format!("{operation}([{}])", operands.join(", "));
        self.moved(&whole)
    }

    /// A solid moved as a whole, or not.
    fn moved(&mut self, solid: &str) -> String {
        let axis = ["X", "Y", "Z"][self.below(3) as usize];
        match self.below(8) {
            0 => self.turned(solid),
            1 => format!("Mirror(normal: {axis}, center: (0, 0, {:?}), solid: {solid})", self.round(-1, 1)),
            2 => format!("Scale(by: (1, {:?}, 0.75), solid: {solid})", self.round(1, 2)),
            3 => format!("Rotate(axis: {axis}, angle: {}, solid: {solid})", 30 * self.below(12)),
            _ => solid.to_owned(),
        }
    }

    fn rich_leaf(&mut self) -> String {
        let solid = match self.below(4) {
            0 => self.pattern(),
            _ => self.rich_solid(),
        };
        let moved = self.moved(&solid);
        let [x, y, z] = [0; 3].map(|_| self.round(-2, 2));
        format!("Translate(by: ({x:?}, {y:?}, {z:?}), solid: {moved})")
    }

    /// The beginning of an import. The tolerance of an STL file would change volumes by more than is asked here.
    fn import(&mut self) -> String {
        format!("Import(file: \"{}\", tolerance: 1e-9", file(self.below(FILES)))
    }

    /// Copies that touch, overlap or stand apart.
    fn pattern(&mut self) -> String {
        let solid = self.rich_solid();
        if self.below(2) == 0 {
            let [x, y] = [0; 2].map(|_| self.round(0, 2));
            format!("Linear(count: {}, step: ({x:?}, {y:?}, 0.5), solid: {solid})", 2 + self.below(3))
        } else {
            let at = self.round(0, 2);
            format!("Polar(count: {}, solid: Translate(by: ({at:?}, 0, 0), solid: {solid}))", 2 + self.below(4))
        }
    }

    fn rich_solid(&mut self) -> String {
        let (r, h) = (self.round(1, 2), self.round(1, 3));
        let round = self.division();
        match self.below(9) {
            0..=2 => format!("{}, scale: {:?})", self.import(), self.round(1, 2)),
            3 => format!("Ellipsoid(radii: ({r:?}, {:?}, 1), {round})", self.round(1, 2)),
            4 => format!(
                "Extrude(profile: RoundedRectangle(size: (3, {:?}), center: (0, 0), radius: 0.5), \
                 holes: [RegularPolygon(sides: {}, radius: 0.5)], height: {h:?}, {round})",
                r + 1.0,
                3 + self.below(4)
            ),
            5 => format!(
                "Revolve(profile: Rectangle(min: ({:?}, 0), max: (2, {h:?})), angle: {}, start: {}, {round})",
                0.5 * self.below(3) as f64,
                60 * (1 + self.below(5)),
                30 * self.below(4)
            ),
            6 => format!(
                "Sweep(profile: Rectangle(size: (0.5, 1), center: (0, 0)), path: Path(start: (1, 0), \
                 segments: [Arc(to: (0, 1), center: (0, 0)), Line(to: ({:?}, 1))], closed: false), {round})",
                -h
            ),
            7 => format!("Prism(polygon: [(0, 0), (2, 0), (2, {r:?}), (1, 0.5), (0, {r:?})], height: {h:?})"),
            _ => format!("Cylinder(radius: {r:?}, height: {h:?}, triangulated: true, {round})"),
        }
    }

    /// Shells in one another, outermost first: a solid that every ray from the origin leaves once, in falling sizes; and the
    /// share of its volume that each keeps.
    pub fn nest(&mut self) -> Vec<(String, f64)> {
        let round = self.division();
        let core = match self.below(5) {
            0 => "Block(size: (2, 3, 1.5), center: (0, 0, 0))".to_owned(),
            1 => format!("Sphere(radius: 1, {round})"),
            2 => format!("Cylinder(radius: 1, height: 2, base: (0, 0, -1), {round})"),
            3 => format!("Ellipsoid(radii: (1, 2, 1.5), {round})"),
            _ => format!("{})", self.import()),
        };
        let core = self.turned(&core);
        let mut sizes = vec![2f64];
        for _ in 0..1 + self.below(4) {
            let thin = [0.5, 0.1, 1e-3, 1e-6][self.below(4) as usize];
            sizes.push(sizes[sizes.len() - 1] * (1.0 - thin));
        }
        let share = |k: usize| sizes[k].powi(3) - sizes.get(k + 1).map_or(0.0, |s: &f64| s.powi(3));
        (0..sizes.len()).map(|k| (format!("Scale(by: {:?}, solid: {core})", sizes[k]), share(k))).collect()
    }
}
