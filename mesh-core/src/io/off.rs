//! Geomview OFF and its kin: COFF, NOFF, STOFF and their combinations. Written back, only coordinates and normals differ.

use std::path::Path;

use super::contents::{CarriedNormals, Contents, Morphs};
use super::document::{Codec, Document, Geometry, Parsed};
use super::error::ReadProblem;
use super::fault::{excerpt, Fault};
use super::text::{integer, number, push_text, Cursor, Field, Splice};
use crate::{Point3, PolygonSoup, Vector3};

pub(super) const CODEC: Codec = Codec {
    name: "OFF",
    extensions: &["off", "coff", "noff", "cnoff", "stoff"],
    is_text: true,
    geometry: Geometry::Polygons,
    has_uvs: false,
    has_mark,
    is_always_marked: false,
    has_statement: |_| false,
    read,
    write: |soup, _| Ok(write(soup)),
};

/// An OFF file as it was read.
#[derive(Debug)]
struct OffFile {
    bytes: Vec<u8>,
    header: Header,
    /// Where the first vertex may start.
    body: usize,
}

/// What the first line promises.
#[derive(Debug)]
struct Header {
    has_normals: bool,
    has_colors: bool,
    has_uvs: bool,
    n_vertices: u64,
    n_faces: u64,
}

fn has_mark(bytes: &[u8]) -> bool {
    let first = Cursor::new(bytes).word();
    first.is_some_and(|word| keyword_prefix(word.text).is_some())
}

/// The letters before `OFF` that a file may start with.
fn keyword_prefix(word: &[u8]) -> Option<&[u8]> {
    let at = word.windows(3).position(|w| w == b"OFF")?;
    let letters = &word[..at];
    let known = |b: &u8| matches!(b, b'S' | b'T' | b'C' | b'N' | b'4' | b'n');
    let behind = &word[at + 3..];
    (letters.iter().all(known) && behind.iter().all(u8::is_ascii_digit)).then_some(letters)
}

/// Reads a file: vertices and faces in their order.
fn read(bytes: Vec<u8>, _: &Path) -> Result<Parsed, Fault> {
    let mut cursor = Cursor::new(&bytes);
    let header = header(&bytes, &mut cursor)?;
    let body = cursor.at();
    let mut soup = PolygonSoup {
        positions: Vec::with_capacity(promised(&cursor, "vertices", header.n_vertices, 6)?),
        faces: Vec::new(),
    };
    for _ in 0..header.n_vertices {
        let mut p = Point3::origin();
        for axis in 0..3 {
            let field = cursor.word();
            p[axis] = cursor.coordinate(field)?;
        }
        soup.positions.push(p);
        cursor.next_line();
    }
    soup.faces
        .reserve_exact(promised(&cursor, "faces", header.n_faces, 2)?);
    for _ in 0..header.n_faces {
        soup.faces.push(face(&mut cursor, soup.positions.len())?);
        cursor.next_line();
    }
    Ok(Parsed {
        contents: contents(&bytes, &header),
        soup,
        findings: Vec::new(),
        document: Box::new(OffFile {
            bytes,
            header,
            body,
        }),
    })
}

fn header<'a>(bytes: &'a [u8], cursor: &mut Cursor<'a>) -> Result<Header, Fault> {
    let mut letters: &[u8] = b"";
    let mut behind = cursor.clone();
    if let Some(word) = behind.word() {
        if let Some(prefix) = keyword_prefix(word.text) {
            letters = prefix;
            // Some files run the keyword and the first count together: `OFF8 6 0`.
            let counts = word.at + prefix.len() + b"OFF".len();
            *cursor = Cursor::starting_at(bytes, counts);
        }
    }
    if letters.iter().any(|b| matches!(b, b'4' | b'n')) {
        return Err(cursor.fault(unsupported("an OFF file of more than three dimensions")));
    }
    let first = cursor.word();
    if first.is_some_and(|f| f.text == b"BINARY") {
        return Err(cursor.fault(unsupported("binary OFF")));
    }
    let expected = "the number of vertices, faces and edges";
    let n_vertices = cursor.count(first, expected)?;
    let second = cursor.word();
    let n_faces = cursor.count(second, expected)?;
    cursor.next_line();
    Ok(Header {
        has_normals: letters.contains(&b'N'),
        has_colors: letters.contains(&b'C'),
        has_uvs: letters.starts_with(b"ST"),
        n_vertices,
        n_faces,
    })
}

fn unsupported(feature: &str) -> ReadProblem {
    ReadProblem::Unsupported {
        feature: feature.to_owned(),
        advice: "save it as three-dimensional text OFF",
    }
}

/// `count` as a size, if the bytes left can hold so many rows of at least `row_bytes` (the last may lack its line end).
fn promised(
    cursor: &Cursor<'_>,
    element: &str,
    count: u64,
    row_bytes: u64,
) -> Result<usize, Fault> {
    let bytes = cursor.left();
    if count.saturating_mul(row_bytes) > bytes as u64 + 1 {
        let element = element.to_owned();
        return Err(cursor.fault(ReadProblem::Oversized {
            element,
            count,
            bytes,
        }));
    }
    Ok(count as usize)
}

fn face(cursor: &mut Cursor<'_>, n_vertices: usize) -> Result<Vec<u32>, Fault> {
    let field = cursor.word();
    let n = cursor.count(field, "the number of corners of a face")?;
    let mut corners = Vec::with_capacity(promised(cursor, "corners", n, 2)?);
    for _ in 0..n {
        let field = cursor.word();
        corners.push(corner(cursor, field, n_vertices)?);
    }
    Ok(corners)
}

fn corner(cursor: &Cursor<'_>, field: Option<Field<'_>>, n_vertices: usize) -> Result<u32, Fault> {
    let expected = "the row of a vertex";
    let field = field.ok_or_else(|| cursor.fault(ReadProblem::EndsEarly { expected }))?;
    let index = integer(field.text).ok_or_else(|| {
        let text = excerpt(field.text);
        cursor.fault_at(field, ReadProblem::Unexpected { expected, text })
    })?;
    u32::try_from(index)
        .ok()
        .filter(|&row| (row as usize) < n_vertices)
        .ok_or_else(|| {
            let first = 0;
            cursor.fault_at(
                field,
                ReadProblem::IndexOutOfRange {
                    index,
                    n_vertices,
                    first,
                },
            )
        })
}

fn contents(bytes: &[u8], header: &Header) -> Contents {
    let of_vertices = |is_there: bool| {
        if is_there {
            header.n_vertices as usize
        } else {
            0
        }
    };
    Contents {
        n_uvs: of_vertices(header.has_uvs),
        n_normals: of_vertices(header.has_normals),
        n_colors: of_vertices(header.has_colors),
        n_comments: bytes
            .split(|&b| b == b'\n')
            .filter(|l| l.trim_ascii_start().starts_with(b"#"))
            .count(),
        ..Contents::default()
    }
}

impl OffFile {
    /// Calls `visit` with each vertex's row, the cursor standing before its coordinates.
    fn each_vertex<'a>(&'a self, mut visit: impl FnMut(usize, &mut Cursor<'a>)) {
        let mut cursor = Cursor::starting_at(&self.bytes, self.body);
        for row in 0..self.header.n_vertices as usize {
            visit(row, &mut cursor);
            cursor.next_line();
        }
    }

    fn normal_rows(&self) -> Option<Vec<Vector3>> {
        if !self.header.has_normals {
            return None;
        }
        let mut rows = Vec::with_capacity(self.header.n_vertices as usize);
        self.each_vertex(|_, cursor| {
            for _ in 0..3 {
                cursor.word();
            }
            let mut n = Vector3::zeros();
            for coordinate in &mut n {
                let field = cursor.field().and_then(|f| number(f.text));
                *coordinate = field.filter(|x| x.is_finite()).unwrap_or(0.0);
            }
            rows.push(n);
        });
        Some(rows)
    }
}

impl Document for OffFile {
    fn vertex_normals(&self, _: &PolygonSoup) -> Option<Vec<Vector3>> {
        self.normal_rows()
    }

    /// Coordinates that did not change keep their text.
    fn rewrite(&self, rest: &PolygonSoup, moved: &[Point3], _: Morphs) -> Result<Vec<u8>, Fault> {
        let rows = self.normal_rows();
        let normals = rows.map(|rows| CarriedNormals::of_vertices(rows, rest, moved));
        let mut splice = Splice::new(&self.bytes);
        self.each_vertex(|row, cursor| {
            let (from, to) = (rest.positions[row], moved[row]);
            for axis in 0..3 {
                let field = cursor.word();
                let has_changed = from[axis].to_bits() != to[axis].to_bits();
                if let Some(field) = field.filter(|_| has_changed) {
                    splice.replace_text(field.range(), to[axis]);
                }
            }
            let Some(n) = normals.as_ref().and_then(|n| n.changed(row)) else {
                return;
            };
            for &coordinate in &n {
                if let Some(field) = cursor.field() {
                    splice.replace_text(field.range(), coordinate);
                }
            }
        });
        Ok(splice.finish())
    }
}

/// A new file of `soup`.
fn write(soup: &PolygonSoup) -> Vec<u8> {
    let mut out = Vec::with_capacity(64 * soup.positions.len());
    push_text(
        &mut out,
        format_args!("OFF\n{} {} 0\n", soup.positions.len(), soup.faces.len()),
    );
    for p in &soup.positions {
        push_text(&mut out, format_args!("{} {} {}\n", p.x, p.y, p.z));
    }
    for face in &soup.faces {
        push_text(&mut out, face.len());
        for v in face {
            push_text(&mut out, format_args!(" {v}"));
        }
        out.push(b'\n');
    }
    out
}
