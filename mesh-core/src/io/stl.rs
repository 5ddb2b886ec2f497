//! STL, text and binary: triangles with their own corners, welded where they are equal. Written back triangle by
//! triangle; only corners and facet normals differ.

use std::path::Path;

use super::contents::{polygon_area_vector, unit, Contents, Morphs, NameRuns};
use super::document::{Codec, Document, Geometry, Parsed};
use super::error::{Place, ReadProblem};
use super::fault::{excerpt, Fault, Unwritable};
use super::finding::Finding;
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
    is_always_marked: true,
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

/// Whether this begins like a text file: `solid`, and soon a facet or the end.
fn is_text(bytes: &[u8]) -> bool {
    const SOON: usize = 200;
    let mut cursor = Cursor::new(bytes);
    let mut words = std::iter::from_fn(|| cursor.word());
    let is_solid = words.next().is_some_and(|w| is_word(w, &["solid"]));
    let is_begun = |w| is_word(w, &["facet", "endsolid"]);
    is_solid && words.take(SOON).any(is_begun) && !bytes.contains(&0)
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
    let mut findings = Vec::new();
    let corners = match is_text(&bytes) && !is_binary(&bytes) {
        true => text_corners(&bytes, &mut solids, &mut findings)?,
        false => binary_corners(&bytes, &mut findings)?,
    };
    let n_faces = corners.faces.len();
    let (soup, row_of_corner) = corners.welded();
    Ok(Parsed {
        soup,
        contents: Contents {
            objects: solids.finish(n_faces),
            ..Contents::default()
        },
        findings,
        document: Box::new(StlFile {
            bytes,
            row_of_corner,
        }),
    })
}

fn text_corners(
    bytes: &[u8],
    solids: &mut NameRuns,
    findings: &mut Vec<Finding>,
) -> Result<Corners, Fault> {
    let mut corners = Corners::default();
    let mut is_open = false;
    each_statement(bytes, |statement, cursor| {
        is_open = statement != Statement::EndSolid;
        match statement {
            Statement::Solid(name) => solids.start(std::iter::once(name), corners.faces.len()),
            Statement::Vertex(fields) => {
                let mut p = Point3::origin();
                for (axis, field) in fields.into_iter().enumerate() {
                    p[axis] = cursor.coordinate(field)?;
                }
                corners.points.push(p);
            }
            Statement::EndFacet => corners.close_face(),
            Statement::Normal(_) | Statement::EndSolid => {}
        }
        Ok(())
    })?;
    if corners.points.len() > corners.n_closed as usize {
        let expected = "the rest of a facet, up to `endfacet`,";
        return Err(Fault::in_text(
            bytes,
            bytes.len(),
            ReadProblem::EndsEarly { expected },
        ));
    }
    findings.extend(is_open.then_some(Finding::NoEnd));
    Ok(corners)
}

/// What a text file says, as far as it matters here.
#[derive(PartialEq)]
enum Statement<'a> {
    Solid(&'a [u8]),
    /// A facet begins, with the fields of its normal, if it has one.
    Normal([Option<Field<'a>>; 3]),
    Vertex([Option<Field<'a>>; 3]),
    EndFacet,
    EndSolid,
}

/// Calls `visit` with each statement; lines are as good as blanks, but for names, comments and colours. What follows a
/// statement on its line and is none is passed over.
fn each_statement<'a>(
    bytes: &'a [u8],
    mut visit: impl FnMut(Statement<'a>, &Cursor<'a>) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let mut cursor = Cursor::new(bytes);
    let mut is_begun = false;
    while let Some(word) = next_word(&mut cursor, &mut is_begun) {
        let statement = if is_word(word, &["solid"]) {
            Statement::Solid(solid_name(&mut cursor))
        } else if is_word(word, &["facet"]) {
            Statement::Normal(normal_fields(&mut cursor))
        } else if is_word(word, &["vertex"]) {
            Statement::Vertex([(); 3].map(|()| cursor.word()))
        } else if is_word(word, &["endfacet"]) {
            Statement::EndFacet
        } else if is_word(word, &["endsolid"]) {
            solid_name(&mut cursor);
            Statement::EndSolid
        } else if is_word(word, &["outer", "loop", "endloop"]) {
            continue;
        } else if is_begun || is_remark(word) {
            while cursor.field().is_some() {}
            continue;
        } else {
            let (expected, text) = ("a word of an STL file", excerpt(word.text));
            return Err(cursor.fault_at(word, ReadProblem::Unexpected { expected, text }));
        };
        is_begun = true;
        visit(statement, &cursor)?;
    }
    Ok(())
}

/// The next word; `is_begun` becomes false where it is the first of its line.
fn next_word<'a>(cursor: &mut Cursor<'a>, is_begun: &mut bool) -> Option<Field<'a>> {
    cursor.field().or_else(|| {
        *is_begun = false;
        cursor.word()
    })
}

/// Lines that some programs put between the others: comments, and colours of facets, which are not read.
fn is_remark(word: Field<'_>) -> bool {
    let is_comment = |mark: &&str| word.text.starts_with(mark.as_bytes());
    ["//", ";"].iter().any(is_comment) || is_word(word, &["color", "colour", "comment"])
}

/// The name behind `solid` or `endsolid`: the rest of the line, where all is on one line up to the next statement.
fn solid_name<'a>(cursor: &mut Cursor<'a>) -> &'a [u8] {
    let mut behind = cursor.clone();
    let mut start = None;
    while let Some(field) = behind.field() {
        let start = *start.get_or_insert(field.at);
        let mut next = behind.clone();
        let is_facet = is_word(field, &["facet"])
            && next
                .field()
                .is_some_and(|f| is_word(f, &["normal", "outer"]))
            && next
                .field()
                .is_some_and(|f| is_word(f, &["loop"]) || number(f.text).is_some());
        let is_end = is_word(field, &["endsolid", "solid"]) && field.at > start;
        if is_facet || is_end {
            *cursor = Cursor::starting_at(cursor.bytes(), field.at);
            return cursor.bytes()[start..field.at].trim_ascii_end();
        }
    }
    cursor.rest_of_line()
}

/// The three numbers behind `facet normal`.
fn normal_fields<'a>(cursor: &mut Cursor<'a>) -> [Option<Field<'a>>; 3] {
    let mut ahead = cursor.clone();
    if !ahead.word().is_some_and(|word| is_word(word, &["normal"])) {
        return [None; 3];
    }
    *cursor = ahead.clone();
    let mut fields = [None; 3];
    for field in &mut fields {
        *field = ahead.word().filter(|f| number(f.text).is_some());
        if field.is_none() {
            break;
        }
        *cursor = ahead.clone();
    }
    fields
}

fn binary_corners(bytes: &[u8], findings: &mut Vec<Finding>) -> Result<Corners, Fault> {
    let n = checked_facets(bytes)?;
    let stated = n_binary_facets(bytes).unwrap_or(0);
    let n_behind = bytes.len() - BINARY_HEADER - n * BINARY_FACET;
    if stated != n as u64 {
        let found = n as u64;
        findings.push(Finding::WrongCount { stated, found });
    } else if n_behind >= BINARY_FACET {
        findings.push(Finding::BytesBehind { n_bytes: n_behind });
    }
    let mut corners = Corners::default();
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

/// How many triangles a binary file holds: as many as its header states, or all there are where no byte is left over.
fn checked_facets(bytes: &[u8]) -> Result<usize, Fault> {
    if bytes
        .iter()
        .all(|b| b.is_ascii_graphic() || b.is_ascii_whitespace())
    {
        let (expected, text) = ("`solid` or a binary STL file", excerpt(bytes.trim_ascii()));
        return Err(Fault::in_text(
            bytes,
            0,
            ReadProblem::Unexpected { expected, text },
        ));
    }
    let expected = "the number of triangles of a binary STL, at byte 80";
    let count =
        n_binary_facets(bytes).ok_or_else(|| Fault::whole(ReadProblem::EndsEarly { expected }))?;
    let left = bytes.len() - BINARY_HEADER;
    if left > 0 && left.is_multiple_of(BINARY_FACET) {
        return Ok(left / BINARY_FACET);
    }
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
    each_statement(bytes, |statement, _| {
        match statement {
            Statement::Normal(fields) => {
                let normal = new.normal(face);
                let numbers = normal.iter().flatten().zip(fields.into_iter().flatten());
                for (&coordinate, field) in numbers {
                    splice.replace_text(field.range(), coordinate);
                }
            }
            Statement::Vertex(fields) => {
                for (axis, field) in fields.into_iter().enumerate() {
                    if let Some((field, x)) = field.zip(new.coordinate(corner, axis)) {
                        splice.replace_text(field.range(), x);
                    }
                }
                corner += 1;
            }
            Statement::EndFacet => face += 1,
            Statement::Solid(_) | Statement::EndSolid => {}
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
