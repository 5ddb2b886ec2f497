//! Geomview OFF and its kin: COFF, NOFF, STOFF and their combinations. Written back, only coordinates and normals differ.

use super::contents::{polygon_area_vector, CarriedNormals, Contents, Parsed};
use super::error::{excerpt, Fault, ReadProblem};
use super::text::{number, push_text, Cursor, Field, Splice};
use crate::{Point3, PolygonSoup, Vector3};

/// What the first line promises.
struct Header {
    has_normals: bool,
    has_colors: bool,
    has_uvs: bool,
    n_vertices: u64,
    n_faces: u64,
}

/// The letters before `OFF` that a file may start with.
pub(super) fn keyword_prefix(word: &[u8]) -> Option<&[u8]> {
    let at = word.windows(3).position(|w| w == b"OFF")?;
    let letters = &word[..at];
    let known = |b: &u8| matches!(b, b'S' | b'T' | b'C' | b'N' | b'4' | b'n');
    let behind = &word[at + 3..];
    (letters.iter().all(known) && behind.iter().all(u8::is_ascii_digit)).then_some(letters)
}

/// Reads a file: vertices and faces in their order.
pub(super) fn read(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut cursor = Cursor::new(bytes);
    let header = header(bytes, &mut cursor)?;
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
        contents: contents(bytes, &header),
        soup,
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
    let index = super::text::integer(field.text).ok_or_else(|| {
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

/// Calls `visit` with each vertex's row, the cursor standing before its coordinates.
fn each_vertex<'a>(
    bytes: &'a [u8],
    mut visit: impl FnMut(usize, &mut Cursor<'a>),
) -> Result<(), Fault> {
    let mut cursor = Cursor::new(bytes);
    let header = header(bytes, &mut cursor)?;
    for row in 0..header.n_vertices as usize {
        visit(row, &mut cursor);
        cursor.next_line();
    }
    Ok(())
}

/// The file with the vertices at `moved`: coordinates that did not change keep their text.
pub(super) fn rewrite(
    bytes: &[u8],
    contents: &Contents,
    rest: &PolygonSoup,
    moved: &[Point3],
) -> Result<Vec<u8>, Fault> {
    let normals = match contents.n_normals {
        0 => None,
        _ => Some(carried_normals(bytes, rest, moved)?),
    };
    let mut splice = Splice::new(bytes);
    each_vertex(bytes, |row, cursor| {
        let (from, to) = (rest.positions[row], moved[row]);
        for axis in 0..3 {
            let field = cursor
                .word()
                .filter(|_| from[axis].to_bits() != to[axis].to_bits());
            if let Some(field) = field {
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
    })?;
    Ok(splice.finish())
}

fn carried_normals(
    bytes: &[u8],
    rest: &PolygonSoup,
    moved: &[Point3],
) -> Result<CarriedNormals, Fault> {
    let mut carried = CarriedNormals::new(normal_rows(bytes)?);
    for corners in &rest.faces {
        let areas = [&rest.positions[..], moved].map(|x| polygon_area_vector(x, corners));
        for &v in corners {
            carried.add_corner(v as usize, areas);
        }
    }
    Ok(carried)
}

fn normal_rows(bytes: &[u8]) -> Result<Vec<Vector3>, Fault> {
    let mut rows = Vec::new();
    each_vertex(bytes, |_, cursor| {
        for _ in 0..3 {
            cursor.word();
        }
        let mut n = Vector3::zeros();
        for coordinate in &mut n {
            *coordinate = cursor
                .field()
                .and_then(|f| number(f.text))
                .filter(|x| x.is_finite())
                .unwrap_or(0.0);
        }
        rows.push(n);
    })?;
    Ok(rows)
}

/// The normals of a NOFF file.
pub(super) fn vertex_normals(bytes: &[u8], contents: &Contents) -> Option<Vec<Vector3>> {
    (contents.n_normals > 0).then(|| normal_rows(bytes).ok())?
}

/// A new file of `soup`.
pub(super) fn write(soup: &PolygonSoup) -> Vec<u8> {
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
