//! Random solids as scene text, the same for a seed everywhere.

/// Nothing reaches further from the origin along an axis.
pub const REACH: f64 = 16.0;
/// Side of the grid that boxes lie on.
const GRID: usize = 6;

/// A sequence of numbers from a seed (SplitMix64: Steele, Lea, Flood 2014).
///
/// All round solids of a scene have as many segments, since coaxial ones are divided alike and would change with the company.
pub struct Generator {
    state: u64,
    segments: u64,
}

impl Generator {
    pub fn new(seed: u64) -> Self {
        let mut new = Self { state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15), segments: 6 };
        new.segments = [6, 8, 12, 16][new.below(4) as usize];
        new
    }
    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// Below `n`.
    pub fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }
    /// At least `lo`, below `hi`.
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
    /// A multiple of a half: what is made of such numbers touches often.
    pub fn round(&mut self, lo: i64, hi: i64) -> f64 {
        lo as f64 + self.below(2 * (hi - lo) as u64 + 1) as f64 / 2.0
    }

    /// As finely as all round solids of the scene.
    pub fn division(&self) -> String {
        format!("discretization: (segments: {})", self.segments)
    }

    /// A solid turned about an arbitrary axis through the origin.
    pub fn turned(&mut self, solid: &str) -> String {
        let [x, y, z] = [0; 3].map(|_| self.between(-1.0, 1.0));
        let angle = self.between(0.0, 360.0);
        format!("Rotate(axis: ({x:?}, {y:?}, {z:?}), angle: {angle:?}, solid: {solid})")
    }

    /// A tree over all primitives; some turned, some on round coordinates; it may be turned as a whole.
    pub fn tree(&mut self, depth: u64) -> String {
        if depth == 0 {
            return self.leaf();
        }
        let operation = ["Union", "Difference", "Intersection", "Xor"][self.below(4) as usize];
        let operands: Vec<String> = (0..2 + self.below(2))
            .map(|_| {
                let below = self.below(depth);
                self.tree(below)
            })
            .collect();
        let whole = format!("{operation}([{}])", operands.join(", "));
        if self.below(4) == 0 { self.turned(&whole) } else { whole }
    }

    /// Many solids over one place, all added or some of them taken away.
    pub fn pile(&mut self, count: usize) -> String {
        let solids: Vec<String> = (0..count).map(|_| self.leaf()).collect();
        let all = |list: &[String]| format!("Union([{}])", list.join(", "));
        match self.below(2) {
            0 => all(&solids),
            _ => format!("Difference([{}, {}])", all(&solids[..count / 2]), all(&solids[count / 2..])),
        }
    }

    fn leaf(&mut self) -> String {
        let primitive = self.primitive();
        let [x, y, z] = [0; 3].map(|_| self.round(-2, 2));
        let turned = match self.below(4) {
            0 => self.turned(&primitive),
            1 => format!(
                "Rotate(axis: {}, angle: {}, solid: {primitive})",
                ["X", "Y", "Z"][self.below(3) as usize],
                30 * self.below(12)
            ),
            _ => primitive,
        };
        format!("Translate(by: ({x:?}, {y:?}, {z:?}), solid: {turned})")
    }

    fn primitive(&mut self) -> String {
        let (r, h) = (self.round(1, 2), self.round(1, 3));
        let round = self.division();
        match self.below(11) {
            0 | 1 => format!("Block(size: ({:?}, {:?}, {h:?}), center: (0, 0, 0))", self.round(1, 3), self.round(1, 3)),
            2 => format!("Prism(sides: {}, radius: {r:?}, height: {h:?})", 3 + self.below(5)),
            3 => format!("Cylinder(radius: {r:?}, height: {h:?}, {round})"),
            4 => format!("Sphere(radius: {r:?}, {round})"),
            5 => format!("Cone(radius: {r:?}, height: {h:?}, {round})"),
            6 => format!("Frustum(bottom_radius: {r:?}, top_radius: {:?}, height: {h:?}, {round})", self.round(1, 2)),
            7 => format!("Torus(major_radius: {:?}, minor_radius: 0.5, {round})", self.round(1, 2)),
            8 => format!("Tube(outer_radius: {:?}, inner_radius: {r:?}, height: {h:?}, {round})", r + 0.5),
            9 => format!("Pyramid(sides: {}, radius: {r:?}, height: {h:?})", 3 + self.below(4)),
            _ => {
                let path = format!("Path(start: (0, 0), segments: [Line(to: (2, 0)), Line(to: (2, {h:?}))])");
                format!("Sweep(profile: Rectangle(size: (0.5, 1), center: (0, 0)), path: {path})")
            }
        }
    }

    /// A tree over boxes on the grid, and the voxels that it is.
    pub fn grid_tree(&mut self, depth: u64) -> (String, Voxels) {
        if depth == 0 {
            let pairs = [0; 3].map(|_| {
                let (a, b) = (self.below(GRID as u64), self.below(GRID as u64));
                [a.min(b), a.max(b) + 1]
            });
            let [x, y, z] = pairs;
            let text = format!("Block(min: ({}, {}, {}), max: ({}, {}, {}))", x[0], y[0], z[0], x[1], y[1], z[1]);
            let inside = |v: u64, p: [u64; 2]| p[0] <= v && v < p[1];
            let is_in = |k: usize| {
                let (i, j, l) = (k % GRID, k / GRID % GRID, k / GRID / GRID);
                inside(i as u64, x) && inside(j as u64, y) && inside(l as u64, z)
            };
            return (text, Voxels((0..GRID * GRID * GRID).map(is_in).collect()));
        }
        let operation = ["Union", "Difference", "Intersection", "Xor"][[0, 0, 1, 1, 2, 3][self.below(6) as usize]];
        let below = self.below(depth);
        let (mut texts, mut all) = (Vec::new(), None);
        for _ in 0..2 + self.below(3) {
            let (text, voxels) = self.grid_tree(below);
            texts.push(text);
            all = Some(match all {
                None => voxels,
                Some(before) => voxels.joined(before, operation),
            });
        }
        (format!("{operation}([{}])", texts.join(", ")), all.unwrap_or(Voxels(Vec::new())))
    }
}

/// Which cells of the grid are filled.
pub struct Voxels(Vec<bool>);

impl Voxels {
    fn joined(self, before: Voxels, operation: &str) -> Voxels {
        let pairs = before.0.into_iter().zip(self.0);
        Voxels(match operation {
            "Union" => pairs.map(|(a, b)| a || b).collect(),
            "Intersection" => pairs.map(|(a, b)| a && b).collect(),
            "Difference" => pairs.map(|(a, b)| a && !b).collect(),
            _ => pairs.map(|(a, b)| a != b).collect(),
        })
    }
    /// Number of filled cells.
    pub fn count(&self) -> u32 {
        self.0.iter().map(|&b| u32::from(b)).sum()
    }
}
