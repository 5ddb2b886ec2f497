//! STL, text and binary: triangles with their own corners, welded where they are equal. Written back triangle by
//! triangle; only corners and facet normals differ.

use std::path::Path;

use super::contents::{polygon_area_vector, unit, Contents, Morphs, NameRuns};
use super::document::{Codec, Document, Geometry, Parsed};
use super::error::{Place, ReadProblem};
use super::fault::{excerpt, Fault, Unwritable};
use super::text::{number, Cursor, Field, Splice};
use super::triangles::Triangles;
use crate::weld::weld_points;
use crate::{Point3, PolygonSoup, Vector3};

pub(super) const CODEC: Codec = Codec {
    name: "STL",
    extensions: &["stl"],
    is_text: false,
    geometry: Geometry::SeparateTriangles,
    has_uvs: false,
    has_mark: |bytes| is_binary(bytes) || is_text(bytes),
    has_statement: |_| false,
    read,
    write: |soup, _| write(soup),
};

/// An STL file as it was read.
#[derive(Debug)]
struct StlFile {
    bytes: Vec<u8>,
    /// The vertex that each corner of the file is, three for each triangle.
    row_of_corner: Vec<u32>,
}

const BINARY_HEADER: usize = 84;
const BINARY_FACET: usize = 50;

/// Whether the length is that of a binary file; even one whose header begins like a text.
fn is_binary(bytes: &[u8]) -> bool {
    n_binary_facets(bytes)
        .is_some_and(|n| BINARY_HEADER as u64 + n * BINARY_FACET as u64 == bytes.len() as u64)
}

/// Whether this begins like a text file.
fn is_text(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new(bytes);
    let is_solid = cursor
        .word()
        .is_some_and(|w| w.text.eq_ignore_ascii_case(b"solid"));
    cursor.next_line();
    is_solid
        && cursor
            .word()
            .is_some_and(|w| is_word(w, &["facet", "endsolid"]))
        && !bytes.contains(&0)
}

fn n_binary_facets(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..84)?.first_chunk()?;
    Some(u64::from(u32::from_le_bytes(*count)))
}

fn is_word(word: Field<'_>, any_of: &[&str]) -> bool {
    any_of
        .iter()
        .any(|known| word.text.eq_ignore_ascii_case(known.as_bytes()))
}

/// The triangles of the file, each with its own corners.
#[derive(Default)]
struct Corners {
    points: Vec<Point3>,
    faces: Vec<Vec<u32>>,
    n_closed: u32,
}

impl Corners {
    fn close_face(&mut self) {
        let n = self.points.len() as u32;
        self.faces.push((self.n_closed..n).collect());
        self.n_closed = n;
    }

    fn welded(self) -> (PolygonSoup, Vec<u32>) {
        let (positions, row_of) = weld_points(&self.points, 0.0);
        let mut faces = self.faces;
        for corner in faces.iter_mut().flatten() {
            *corner = row_of[*corner as usize];
        }
        (PolygonSoup { positions, faces }, row_of)
    }
}

/// Reads a file: triangles in their order, equal corners as one vertex.
fn read(bytes: Vec<u8>, _: &Path) -> Result<Parsed, Fault> {
    let mut solids = NameRuns::default();
    let corners = corners(&bytes, &mut solids)?;
    let n_faces = corners.faces.len();
    let (soup, row_of_corner) = corners.welded();
    Ok(Parsed {
        soup,
        contents: Contents {
            objects: solids.finish(n_faces),
            ..Contents::default()
        },
        document: Box::new(StlFile {
            bytes,
            row_of_corner,
        }),
    })
}

fn corners(bytes: &[u8], solids: &mut NameRuns) -> Result<Corners, Fault> {
    let mut corners = Corners::default();
    if is_text(bytes) && !is_binary(bytes) {
        each_word(bytes, |word, cursor| {
            if is_word(word, &["solid"]) {
                solids.start(std::iter::once(cursor.rest_of_line()), corners.faces.len());
            } else if is_word(word, &["vertex"]) {
                let mut p = Point3::origin();
                for axis in 0..3 {
                    let field = cursor.word();
                    p[axis] = cursor.coordinate(field)?;
                }
                corners.points.push(p);
            } else if is_word(word, &["endfacet"]) {
                corners.close_face();
            }
            Ok(())
        })?;
        return Ok(corners);
    }
    let n = checked_facets(bytes)?;
    corners.points.reserve_exact(3 * n);
    corners.faces.reserve_exact(n);
    for row in 0..n {
        for k in 1..4 {
            corners.points.push(binary_point(bytes, row, k)?);
        }
        corners.close_face();
    }
    Ok(corners)
}

fn each_word<'a>(
    bytes: &'a [u8],
    mut visit: impl FnMut(Field<'a>, &mut Cursor<'a>) -> Result<(), Fault>,
) -> Result<(), Fault> {
    const KNOWN: [&str; 8] = [
        "solid", "facet", "outer", "loop", "vertex", "endloop", "endfacet", "endsolid",
    ];
    let mut cursor = Cursor::new(bytes);
    while let Some(word) = cursor.word() {
        if !is_word(word, &KNOWN) {
            let (expected, text) = ("a word of an STL file", excerpt(word.text));
            return Err(cursor.fault_at(word, ReadProblem::Unexpected { expected, text }));
        }
        visit(word, &mut cursor)?;
        if !is_word(word, &["outer"]) {
            cursor.next_line();
        }
    }
    Ok(())
}

fn checked_facets(bytes: &[u8]) -> Result<usize, Fault> {
    let expected = "the number of triangles of a binary STL, at byte 80";
    let count =
        n_binary_facets(bytes).ok_or_else(|| Fault::whole(ReadProblem::EndsEarly { expected }))?;
    let left = bytes.len() - BINARY_HEADER;
    if count * BINARY_FACET as u64 > left as u64 {
        let element = "triangles".to_owned();
        return Err(Fault::whole(ReadProblem::Oversized {
            element,
            count,
            bytes: left,
        }));
    }
    Ok(count as usize)
}

fn facet_bytes(row: usize, k: usize, axis: usize) -> std::ops::Range<usize> {
    let at = BINARY_HEADER + BINARY_FACET * row + 12 * k + 4 * axis;
    at..at + 4
}

/// Row `k` of a binary facet: its normal, then its three corners.
fn binary_point(bytes: &[u8], row: usize, k: usize) -> Result<Point3, Fault> {
    let mut p = Point3::origin();
    for axis in 0..3 {
        let mut raw = [0; 4];
        raw.copy_from_slice(&bytes[facet_bytes(row, k, axis)]);
        p[axis] = f64::from(f32::from_le_bytes(raw));
        if !p[axis].is_finite() {
            return Err(at_facet(row, p[axis]));
        }
    }
    Ok(p)
}

fn at_facet(row: usize, coordinate: f64) -> Fault {
    let (element, text) = ("triangle".to_owned(), coordinate.to_string());
    Fault {
        place: Place::Row { element, row },
        problem: ReadProblem::NotFinite { text },
    }
}

impl Document for StlFile {
    fn vertex_normals(&self, _: &PolygonSoup) -> Option<Vec<Vector3>> {
        None
    }

    /// Corners that did not change keep their text or bytes.
    fn rewrite(&self, rest: &PolygonSoup, moved: &[Point3], _: Morphs) -> Result<Vec<u8>, Fault> {
        let new = New {
            rest,
            moved,
            row_of_corner: &self.row_of_corner,
        };
        if is_text(&self.bytes) && !is_binary(&self.bytes) {
            rewrite_text(&self.bytes, &new)
        } else {
            rewrite_binary(&self.bytes, &new)
        }
    }
}

/// What changes.
struct New<'a> {
    rest: &'a PolygonSoup,
    moved: &'a [Point3],
    row_of_corner: &'a [u32],
}

impl New<'_> {
    /// Where corner number `corner` of the file is now, along an axis in which it moved.
    fn coordinate(&self, corner: usize, axis: usize) -> Option<f64> {
        let row = self.row_of_corner[corner] as usize;
        let (from, to) = (self.rest.positions[row][axis], self.moved[row][axis]);
        (from.to_bits() != to.to_bits()).then_some(to)
    }

    /// The normal of a face that moved; zero, as is usual in these files, where it has no area.
    fn normal(&self, face: usize) -> Option<Vector3> {
        let corners = self.rest.faces.get(face)?;
        let is_kept = |&v: &u32| self.rest.positions[v as usize] == self.moved[v as usize];
        if corners.iter().all(is_kept) {
            return None;
        }
        let area = polygon_area_vector(self.moved, corners);
        Some(unit(area).unwrap_or_default())
    }
}

fn rewrite_text(bytes: &[u8], new: &New<'_>) -> Result<Vec<u8>, Fault> {
    let mut splice = Splice::new(bytes);
    let (mut corner, mut face) = (0, 0);
    each_word(bytes, |word, cursor| {
        if is_word(word, &["facet"]) {
            let has_normal = cursor.field().is_some_and(|f| is_word(f, &["normal"]));
            for &coordinate in new.normal(face).iter().filter(|_| has_normal).flatten() {
                let field = cursor.field().filter(|f| number(f.text).is_some());
                if let Some(field) = field {
                    splice.replace_text(field.range(), coordinate);
                }
            }
        } else if is_word(word, &["vertex"]) {
            for axis in 0..3 {
                let field = cursor.word();
                if let Some((field, x)) = field.zip(new.coordinate(corner, axis)) {
                    splice.replace_text(field.range(), x);
                }
            }
            corner += 1;
        } else if is_word(word, &["endfacet"]) {
            face += 1;
        }
        Ok(())
    })?;
    Ok(splice.finish())
}

fn rewrite_binary(bytes: &[u8], new: &New<'_>) -> Result<Vec<u8>, Fault> {
    let mut out = bytes.to_vec();
    let mut put = |row: usize, k: usize, axis: usize, x: f64| {
        let single = x as f32;
        out[facet_bytes(row, k, axis)].copy_from_slice(&single.to_le_bytes());
        if single.is_finite() {
            Ok(())
        } else {
            Err(at_facet(row, x))
        }
    };
    for row in 0..checked_facets(bytes)? {
        for axis in 0..3 {
            if let Some(n) = new.normal(row) {
                put(row, 0, axis, n[axis])?;
            }
            for k in 0..3 {
                if let Some(x) = new.coordinate(3 * row + k, axis) {
                    put(row, 1 + k, axis, x)?;
                }
            }
        }
    }
    Ok(out)
}

/// A new binary file of `soup`.
fn write(soup: &PolygonSoup) -> Result<Vec<u8>, Unwritable> {
    let triangles = Triangles::of(soup)?;
    let n = triangles.corners.len();
    let mut out = vec![0; BINARY_HEADER];
    // Not "solid": that is how a text begins.
    out[..10].copy_from_slice(b"binary STL");
    out[80..84].copy_from_slice(&(n as u32).to_le_bytes());
    for (&face, corners) in triangles.faces.iter().zip(&triangles.corners) {
        let vertices = corners.map(|corner| soup.faces[face][corner]);
        let normal = unit(polygon_area_vector(&soup.positions, &vertices)).unwrap_or_default();
        let points = vertices.map(|v| soup.positions[v as usize].coords);
        for vector in std::iter::once(&normal).chain(&points) {
            vector
                .iter()
                .for_each(|&c| out.extend_from_slice(&(c as f32).to_le_bytes()));
        }
        out.extend_from_slice(&[0; 2]);
        if let Some(k) = points
            .iter()
            .position(|p| p.iter().any(|&c| !(c as f32).is_finite()))
        {
            return Err(Unwritable::Vertex(vertices[k] as usize));
        }
    }
    Ok(out)
}
