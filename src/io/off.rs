//! Geomview's OFF in text form: header, counts, points, polygons; comments from `#`. Colours, normals and texture
//! coordinates are passed over; the comments in which gsm writes names are read.

use super::write_off::{FROM_HERE, MARKER};
use super::{FormatError, Groups, PolygonMesh, coordinates};
use crate::geom::lists::Lists;
use std::collections::BTreeMap;

/// Bytes of a line of three numbers, at least.
const SHORTEST_LINE: usize = 6;

/// Reads the text of an OFF file.
///
/// # Errors
/// With the line: unknown header, missing lines, bad numbers, point numbers out of range.
pub fn read(text: &str) -> Result<PolygonMesh, FormatError> {
    // Looked for once, and not again in each of many lines.
    let has_comments = text.contains('#');
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, if has_comments { without_comment(line) } else { line }.trim_ascii()))
        .filter(|(_, line)| !line.is_empty());
    let mut next =
        |what: &str| lines.next().ok_or_else(|| FormatError::new(0, format!("the file ends where {what} is expected")));
    let (line, header) = next("the header 'OFF'")?;
    let (keyword, rest) = header.split_once(char::is_whitespace).unwrap_or((header, ""));
    // Prefixes: texture coordinates, colours, normals; these follow the coordinates.
    if !matches!(keyword, "OFF" | "COFF" | "NOFF" | "CNOFF" | "STOFF" | "STCOFF" | "STNOFF" | "STCNOFF") {
        return Err(FormatError::new(line, format!("'{keyword}' is not a header of a text OFF file in three dimensions")));
    }
    let (line, counts) = if rest.trim().is_empty() { next("the line of counts")? } else { (line, rest) };
    let counts: Vec<usize> = counts
        .split_whitespace()
        .map(|w| w.parse().map_err(|_| FormatError::new(line, format!("'{w}' is not a count"))))
        .collect::<Result<_, _>>()?;
    let [points, polygons, ..] = counts[..] else {
        return Err(FormatError::new(line, "the numbers of points and polygons are expected"));
    };
    // What the file says is believed as far as it is long enough for it.
    let room = |count: usize| count.min(text.len() / SHORTEST_LINE);
    let mut mesh = PolygonMesh {
        points: Vec::with_capacity(room(points)),
        polygons: Lists::with_capacity(room(polygons), 3 * room(polygons)),
        group_of: Vec::with_capacity(room(polygons)),
        groups: Vec::new(),
    };
    let mut comments = if has_comments { Comments::of(text) } else { Comments::default() };
    for _ in 0..points {
        let (line, words) = next("a point")?;
        mesh.points.push(coordinates(words.split_ascii_whitespace(), line)?);
    }
    let (mut plain, mut groups) = (Vec::new(), Groups::default());
    for _ in 0..polygons {
        let (line, words) = next("a polygon")?;
        mesh.group_of.push(groups.called(comments.name_at(line)));
        if plain_numbers(words, &mut plain)
            && let [size, walk @ ..] = &plain[..]
            && walk.len() == *size as usize
            && walk.len() >= 3
            && walk.iter().all(|&v| (v as usize) < points)
        {
            mesh.polygons.push(walk.iter().copied());
            continue;
        }
        let mut numbers = words
            .split_ascii_whitespace()
            .map(|w| w.parse::<usize>().map_err(|_| FormatError::new(line, format!("'{w}' is not a point number"))));
        let size = numbers.next().unwrap_or(Ok(0))?;
        let polygon = numbers
            .take(size)
            .map(|v| match v {
                Ok(v) if v < points => Ok(v as u32),
                Ok(v) => Err(FormatError::new(line, format!("point {v} does not exist: there are {points}, from 0"))),
                Err(e) => Err(e),
            })
            .collect::<Result<Vec<u32>, _>>()?;
        if polygon.len() < size || size < 3 {
            return Err(FormatError::new(line, "a polygon needs as many point numbers as it says, at least three"));
        }
        mesh.polygons.push(polygon);
    }
    mesh.groups = groups.names;
    Ok(mesh)
}

/// Names of the markers, and the lines from which on polygons have one, as [`super::write_off`] writes them.
#[derive(Default)]
struct Comments<'t> {
    names: BTreeMap<&'t str, &'t str>,
    /// In the order of the lines, the next one last.
    starts: Vec<(usize, &'t str)>,
    marker: Option<&'t str>,
}

impl<'t> Comments<'t> {
    fn of(text: &'t str) -> Self {
        let mut comments = Self::default();
        for (k, line) in text.lines().enumerate().filter(|(_, line)| line.starts_with('#')) {
            if let Some(marker) = line.strip_prefix(FROM_HERE) {
                comments.starts.push((k + 1, marker.trim()));
            } else if let Some((marker, name)) = line.strip_prefix(MARKER).and_then(|rest| rest.trim().split_once(' ')) {
                comments.names.insert(marker, name.trim());
            }
        }
        comments.starts.reverse();
        comments
    }

    /// The name of the polygon on a line; the lines are asked in their order.
    fn name_at(&mut self, line: usize) -> &'t str {
        while let Some((_, marker)) = self.starts.pop_if(|(start, _)| *start < line) {
            self.marker = Some(marker);
        }
        self.marker.and_then(|marker| self.names.get(marker).copied()).unwrap_or("surface")
    }
}

fn without_comment(line: &str) -> &str {
    line.split_once('#').map_or(line, |parts| parts.0)
}

/// The numbers of a line, if it has nothing but short ones and spaces: most lines are so, and are read in a third of the time.
fn plain_numbers(words: &str, numbers: &mut Vec<u32>) -> bool {
    const DIGITS: usize = 9;
    numbers.clear();
    let (mut number, mut digits) = (0, 0);
    for &byte in words.as_bytes() {
        match byte {
            b'0'..=b'9' if digits < DIGITS => (number, digits) = (10 * number + u32::from(byte - b'0'), digits + 1),
            b' ' if digits > 0 => {
                numbers.push(number);
                (number, digits) = (0, 0);
            }
            b' ' => {}
            _ => return false,
        }
    }
    if digits > 0 {
        numbers.push(number);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: &str =
        "# by hand\nOFF 4 4 0\n0 0 0 # origin\n1 0 0\n\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2\n3 1 2 3\n";

    #[test]
    fn counts_beside_the_header_comments_and_colours() {
        let mesh = read(TETRAHEDRON).unwrap();
        assert_eq!((mesh.points.len(), mesh.polygons.of(1)), (4, &[0, 1, 3][..]));
    }

    #[test]
    fn names_are_read_back() {
        let mut text = Vec::new();
        let cube = crate::io::mesh::tests::cube();
        crate::io::write_off::write(&cube, &mut text).unwrap();
        let mesh = read(&String::from_utf8(text).unwrap()).unwrap();
        assert_eq!(mesh.groups, ["iron|outer", "air|outer", "iron|air"]);
        assert_eq!([0, 1, 2].map(|g| mesh.group_of.iter().filter(|of| **of == g).count()), [6, 6, 2]);
    }

    /// Looked for one by one, so many names would take a minute.
    #[test]
    fn as_many_groups_as_polygons_are_read_at_once() {
        let count = 300_000;
        let mut text = format!("OFF\n3 {count} 0\n0 0 0\n1 0 0\n0 1 0\n");
        for k in 0..count {
            text += &format!("# marker {k} name{k}\n# from here marker {k}\n3 0 1 2\n");
        }
        let start = std::time::Instant::now();
        let mesh = read(&text).unwrap();
        assert!(mesh.groups.len() == count && mesh.group_of.last() == Some(&(count as u32 - 1)));
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    }

    #[test]
    fn faults_name_their_line() {
        let fault = |from: &str, to: &str| read(&TETRAHEDRON.replace(from, to)).unwrap_err();
        assert_eq!(fault("3 0 3 2", "3 0 7 2").line, 10);
        assert_eq!(fault("1 0 0", "1 nan 0").line, 4);
        assert_eq!(fault("0 1 0", "0 1").line, 6);
        assert_eq!(fault("OFF 4 4", "4OFF 4 4").line, 2);
        assert!(fault("OFF 4 4", "OFF 4 4000000000000").message.contains("ends where a polygon"));
        assert!(fault("OFF 4 4", "OFF 4000000000000 4").message.contains("ends where a point"));
    }
}
