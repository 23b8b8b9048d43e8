//! Text to [`Plc`], as untrusted input: nothing is allocated from a declared count, every number and index is checked.

use crate::diag::{Diagnostic, Span, with_line_feeds};
use crate::geom::Vec3;
use crate::plc::{Plc, PlcFacet, Seed};
use std::path::Path;

/// Largest file that is read; a complex of five million triangles.
const MAX_BYTES: u64 = 1 << 30;
/// Largest magnitude of a coordinate: products of three still have room in `f64`.
const MAX_COORDINATE: f64 = 1e100;

/// Largest region number: up to here every whole number is an `f64`.
const MAX_REGION: f64 = (1u64 << 53) as f64;

/// Where to look up what the lines of a file must hold.
const FORMAT: &str = "the format is that of TetGen's manual, section 5.2; counts at the head of a list must fit what follows";

/// Reads a .poly or, by its extension, a .smesh file; vertices may stand in a .node file beside it.
///
/// # Errors
/// If it cannot be read or is no such file; with the line.
pub fn read(path: &Path) -> Result<Plc, Diagnostic> {
    let is_smesh = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("smesh"));
    let text = load(path)?;
    let has_none = Lines::new(&text).next().and_then(|l| l.words.first().copied()) == Some("0");
    if !has_none {
        return parse(&text, None, is_smesh);
    }
    let beside = path.with_extension("node");
    let nodes = load(&beside).map_err(|mut fault| {
        fault.message = format!("{} leaves its vertices to a .node file: {}", path.display(), fault.message);
        fault
    })?;
    parse(&text, Some((&beside.display().to_string(), &nodes)), is_smesh)
}

/// Whether a file name is that of a .poly or .smesh.
pub fn is_plc(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("poly") || e.eq_ignore_ascii_case("smesh"))
}

fn load(path: &Path) -> Result<String, Diagnostic> {
    let refused = |why: String| {
        Diagnostic::error("cannot-read", format!("cannot read {}: {why}", path.display()))
            .hint("give the path of a .poly, .smesh or scene that can be read; a .node file stands beside its .poly")
    };
    let unreadable = |e| {
        Diagnostic::unreadable("cannot-read", path, &e)
            .hint("give the path of a .poly or .smesh; a .node file stands beside it")
    };
    let size = std::fs::metadata(path).map_err(unreadable)?;
    if !size.is_file() && !size.is_dir() {
        return Err(refused("it is no regular file".to_owned()));
    }
    if size.len() > MAX_BYTES {
        return Err(refused(format!("it is larger than {MAX_BYTES} bytes")));
    }
    let text = with_line_feeds(std::fs::read_to_string(path).map_err(unreadable)?);
    // Some editors begin a file with a byte order mark.
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

/// Parses the text of a .poly or .smesh file, with the name and text of the .node file if the vertices stand there.
///
/// # Errors
/// At the first line that is not what TetGen would expect.
pub fn parse(text: &str, nodes: Option<(&str, &str)>, is_smesh: bool) -> Result<Plc, Diagnostic> {
    let mut lines = Lines::new(text);
    let mut plc = Plc::default();
    let first = match nodes {
        Some((file, nodes)) => {
            lines.expect("the number of vertices")?;
            // Places are those of the file that is read; this is another one.
            let elsewhere = |d: Diagnostic| {
                let Span { line, column } = d.span.unwrap_or_default();
                Diagnostic { message: format!("{file}:{line}:{column}: {}", d.message), span: None, ..d }
            };
            vertices(&mut Lines::new(nodes), &mut plc).map_err(elsewhere)?
        }
        None => vertices(&mut lines, &mut plc)?,
    };
    let numbers = Numbers { first, count: plc.vertices.len() };
    let header = lines.expect("the number of facets")?;
    let count = header.count(0, "the number of facets")?;
    for _ in 0..count {
        plc.facets.push(if is_smesh { smesh_facet(&mut lines, numbers)? } else { poly_facet(&mut lines, numbers)? });
    }
    // Both lists may be missing at the end of the file.
    if let Some(header) = lines.next() {
        for _ in 0..header.count(0, "the number of holes")? {
            plc.holes.push(lines.expect("a hole")?.point(1)?);
        }
    }
    if let Some(header) = lines.next() {
        for _ in 0..header.count(0, "the number of regions")? {
            plc.seeds.push(seed(&lines.expect("a region")?)?);
        }
    }
    Ok(plc)
}

fn vertices(lines: &mut Lines, plc: &mut Plc) -> Result<i64, Diagnostic> {
    let header = lines.expect("the number of vertices")?;
    let count = header.count(0, "the number of vertices")?;
    if header.words.len() > 1 && header.integer(1, "the dimension")? != 3 {
        return Err(header.fault(1, "the dimension must be 3"));
    }
    let mut first = 1;
    for k in 0..count {
        let line = lines.expect("a vertex")?;
        let number = line.integer(0, "the number of the vertex")?;
        if k == 0 {
            first = number;
            if first != 0 && first != 1 {
                return Err(line.fault(0, "vertices are numbered from 0 or 1"));
            }
        } else if number != first + k as i64 {
            return Err(line.fault(0, "vertices must be numbered in order"));
        }
        plc.vertices.push(line.point(1)?);
    }
    Ok(first)
}

/// The vertex numbers that may be used.
#[derive(Clone, Copy)]
struct Numbers {
    first: i64,
    count: usize,
}

fn poly_facet(lines: &mut Lines, numbers: Numbers) -> Result<PlcFacet, Diagnostic> {
    let header = lines.expect("a facet")?;
    let polygons = header.count(0, "the number of polygons")?;
    let holes = if header.words.len() > 1 { header.count(1, "the number of holes")? } else { 0 };
    let marker = if header.words.len() > 2 { header.integer(2, "the marker")? } else { 0 };
    if polygons == 0 {
        return Err(header.fault(0, "a facet needs a polygon"));
    }
    let mut facet = PlcFacet { marker, ..PlcFacet::default() };
    for _ in 0..polygons {
        let line = lines.expect("a polygon")?;
        facet.polygons.push(polygon(lines, line, numbers)?.vertices);
    }
    for _ in 0..holes {
        facet.holes.push(lines.expect("a point in a hole")?.point(1)?);
    }
    Ok(facet)
}

fn smesh_facet(lines: &mut Lines, numbers: Numbers) -> Result<PlcFacet, Diagnostic> {
    let line = lines.expect("a facet")?;
    let polygon = polygon(lines, line, numbers)?;
    let (line, next) = polygon.rest;
    let marker = if next < line.words.len() { line.integer(next, "the marker")? } else { 0 };
    Ok(PlcFacet { polygons: vec![polygon.vertices], marker, ..PlcFacet::default() })
}

struct Polygon<'a> {
    vertices: Vec<u32>,
    /// Its last line and the number of the word after its last vertex.
    rest: (Line<'a>, usize),
}

/// A polygon, which may go on over several lines.
fn polygon<'a>(lines: &mut Lines<'a>, mut line: Line<'a>, numbers: Numbers) -> Result<Polygon<'a>, Diagnostic> {
    let count = line.count(0, "the number of vertices of the polygon")?;
    if count == 0 {
        return Err(line.fault(0, "a polygon needs a vertex"));
    }
    let mut vertices = Vec::new();
    let mut word = 1;
    while vertices.len() < count {
        if word >= line.words.len() {
            line = lines.expect("a vertex of the polygon")?;
            word = 0;
        }
        let number = line.integer(word, "a vertex of the polygon")?;
        let index = number.checked_sub(numbers.first).and_then(|i| u32::try_from(i).ok());
        match index.filter(|&i| (i as usize) < numbers.count) {
            Some(index) => vertices.push(index),
            None => return Err(line.fault(word, format!("there is no vertex {number}"))),
        }
        word += 1;
    }
    Ok(Polygon { vertices, rest: (line, word) })
}

fn seed(line: &Line) -> Result<Seed, Diagnostic> {
    let region = line.real(4, "the region number")?;
    // TetGen takes any real number; two that differ behind the point must not become one region.
    if region != region.trunc() || region.abs() > MAX_REGION {
        return Err(line.fault(4, format!("the region number should be a whole number, not {region}")));
    }
    let max_volume = if line.words.len() > 5 { line.real(5, "the largest volume")? } else { -1.0 };
    Ok(Seed { point: line.point(1)?, region: region as i64, max_volume: Some(max_volume).filter(|&v| v > 0.0) })
}

/// A line with its words, without comment.
struct Line<'a> {
    number: u32,
    text: &'a str,
    words: Vec<&'a str>,
}

impl Line<'_> {
    fn fault(&self, word: usize, message: impl Into<String>) -> Diagnostic {
        // Words are slices of the line: their distance is the column; a missing word is at its end.
        let start = self.words.get(word).map_or(self.text.len(), |w| w.as_ptr() as usize - self.text.as_ptr() as usize);
        let column = self.text.get(..start).map_or(0, |before| before.chars().count()) as u32 + 1;
        Diagnostic::error("bad-poly", message).at(Span { line: self.number, column }).hint(FORMAT)
    }
    fn word(&self, k: usize, what: &str) -> Result<&str, Diagnostic> {
        self.words.get(k).copied().ok_or_else(|| self.fault(k, format!("{what} is missing")))
    }
    fn integer(&self, k: usize, what: &str) -> Result<i64, Diagnostic> {
        let word = self.word(k, what)?;
        word.parse().map_err(|_| self.fault(k, format!("{what} should be an integer, not `{}`", short(word))))
    }
    fn count(&self, k: usize, what: &str) -> Result<usize, Diagnostic> {
        let value = self.integer(k, what)?;
        u32::try_from(value).map(|v| v as usize).map_err(|_| self.fault(k, format!("{what} cannot be {value}")))
    }
    fn real(&self, k: usize, what: &str) -> Result<f64, Diagnostic> {
        let word = self.word(k, what)?;
        let value: Option<f64> = word.parse().ok().filter(|v: &f64| v.abs() <= MAX_COORDINATE);
        value.ok_or_else(|| {
            self.fault(k, format!("{what} should be a finite number up to {MAX_COORDINATE:e}, not `{}`", short(word)))
        })
    }
    fn point(&self, k: usize) -> Result<Vec3, Diagnostic> {
        Ok(Vec3::new(self.real(k, "x")?, self.real(k + 1, "y")?, self.real(k + 2, "z")?))
    }
}

/// The beginning of a word, for a message.
fn short(word: &str) -> String {
    word.chars().take(30).collect()
}

/// Lines that hold something.
struct Lines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    last: u32,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        Self { lines: text.lines().enumerate(), last: 0 }
    }
    fn expect(&mut self, what: &str) -> Result<Line<'a>, Diagnostic> {
        let last = self.last;
        self.next().ok_or_else(|| {
            Diagnostic::error("bad-poly", format!("the file ends where {what} should follow"))
                .at(Span { line: last, column: 1 })
                .hint(FORMAT)
        })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        for (k, line) in self.lines.by_ref() {
            self.last = k as u32 + 1;
            let content = line.split('#').next().unwrap_or_default();
            let words: Vec<&str> = content.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()).collect();
            if !words.is_empty() {
                return Some(Line { number: self.last, text: line, words });
            }
        }
        None
    }
}
