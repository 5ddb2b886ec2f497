//! Wavefront OBJ, statement by statement. Written back, only `v` and `vn` lines differ from the source.

use std::collections::BTreeSet;
use std::path::Path;

use super::contents::{polygon_area_vector, CarriedNormals, Contents, Morphs, NameRuns};
use super::document::{Codec, Document, Geometry, Parsed};
use super::error::ReadProblem;
use super::fault::{excerpt, Fault};
use super::looks::{of_libraries, NamedPicture, Rgb};
use super::text::{integer, number, push_text, Cursor, Field, Splice};
use super::uvs::CornerUvs;
use crate::{Point3, PolygonSoup, Vector3};

pub(super) const CODEC: Codec = Codec {
    name: "OBJ",
    extensions: &["obj"],
    is_text: true,
    geometry: Geometry::Polygons,
    has_uvs: true,
    has_mark,
    is_always_marked: false,
    has_statement,
    read,
    write: |soup, uvs| Ok(write(soup, uvs)),
};

/// An OBJ file as it was read.
#[derive(Debug)]
struct ObjFile {
    bytes: Vec<u8>,
}

/// Whether the first statements are all of this format, and one of them a vertex.
fn has_mark(bytes: &[u8]) -> bool {
    const FIRST: usize = 100;
    let mut cursor = Cursor::new(bytes);
    for _ in 0..FIRST {
        let Some(keyword) = next_statement(&mut cursor, || ()) else {
            return false;
        };
        let mut numbers = std::iter::from_fn(|| cursor.field()).map_while(|f| number(f.text));
        match keyword.text {
            b"v" => return numbers.by_ref().take(3).count() == 3,
            b"vn" | b"vt" | b"vp" if numbers.next().is_some() => {}
            b"mtllib" | b"usemtl" | b"o" | b"g" | b"s" | b"f" => {}
            _ => return false,
        }
        cursor.next_line();
    }
    false
}

fn has_statement(bytes: &[u8]) -> bool {
    let mut line = Cursor::new(bytes);
    let keyword = line.word().map(|word| word.text);
    match keyword {
        Some(b"v") => (0..3).all(|_| line.field().is_some_and(|f| number(f.text).is_some())),
        Some(b"mtllib" | b"usemtl" | b"o" | b"g" | b"s" | b"vn" | b"vt") => true,
        _ => false,
    }
}

/// A statement: its keyword, with the cursor standing behind it.
fn next_statement<'a>(cursor: &mut Cursor<'a>, mut on_comment: impl FnMut()) -> Option<Field<'a>> {
    while cursor.left() > 0 {
        if let Some(keyword) = cursor.field() {
            return Some(keyword);
        }
        if cursor.is_at_comment() {
            on_comment();
        }
        cursor.next_line();
    }
    None
}

/// Calls `visit` with each statement's keyword, the cursor standing behind it.
fn each_statement<'a>(bytes: &'a [u8], mut visit: impl FnMut(&[u8], &mut Cursor<'a>)) {
    let mut cursor = Cursor::new(bytes);
    while let Some(keyword) = next_statement(&mut cursor, || ()) {
        visit(keyword.text, &mut cursor);
        cursor.next_line();
    }
}

/// Reads a file: vertices and faces in their order, everything else counted.
fn read(bytes: Vec<u8>, _: &Path) -> Result<Parsed, Fault> {
    let mut reader = Reader::default();
    let mut cursor = Cursor::new(&bytes);
    let mut n_comments = 0;
    while let Some(keyword) = next_statement(&mut cursor, || n_comments += 1) {
        reader.statement(keyword, &mut cursor)?;
        cursor.next_line();
    }
    reader.contents.n_comments = n_comments;
    reader.finish(bytes)
}

#[derive(Default)]
struct Reader {
    soup: PolygonSoup,
    contents: Contents,
    objects: NameRuns,
    groups: NameRuns,
    materials: NameRuns,
    smoothing: BTreeSet<Vec<u8>>,
    /// The largest vertex row a face names, and where in the file.
    highest: Option<(usize, usize)>,
    corners: Vec<u32>,
}

impl Reader {
    fn statement(&mut self, keyword: Field<'_>, cursor: &mut Cursor<'_>) -> Result<(), Fault> {
        let n_faces = self.soup.faces.len();
        match keyword.text {
            b"v" => self.vertex(cursor)?,
            b"f" | b"fo" => self.face(cursor)?,
            b"vt" => self.contents.n_uvs += 1,
            b"vn" => self.contents.n_normals += 1,
            b"l" | b"p" => self.contents.n_lines_and_points += 1,
            b"g" => {
                let names = std::iter::from_fn(|| cursor.field()).map(|f| f.text);
                self.groups.start(names, n_faces);
            }
            b"o" => self
                .objects
                .start(std::iter::once(cursor.rest_of_line()), n_faces),
            b"usemtl" => self
                .materials
                .start(std::iter::once(cursor.rest_of_line()), n_faces),
            b"s" => self.smoothing_group(cursor.rest_of_line()),
            b"mtllib" => {
                let name = String::from_utf8_lossy(cursor.rest_of_line()).into_owned();
                self.contents.references.push(name);
            }
            _ => {}
        }
        Ok(())
    }

    fn vertex(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Fault> {
        let mut p = Point3::origin();
        for axis in 0..3 {
            let field = cursor.field();
            p[axis] = cursor.coordinate(field)?;
        }
        self.soup.positions.push(p);

        let n_more = std::iter::from_fn(|| cursor.field()).take(4).count();
        self.contents.n_colors += usize::from(n_more >= 3);
        Ok(())
    }

    fn face(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Fault> {
        self.corners.clear();
        while let Some(field) = cursor.field() {
            let row = self.corner(field, cursor)?;
            if self
                .highest
                .is_none_or(|(highest, _)| row as usize > highest)
            {
                self.highest = Some((row as usize, field.at));
            }
            self.corners.push(row);
        }
        self.soup.faces.push(self.corners.clone());
        Ok(())
    }

    /// The vertex row that a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` names.
    fn corner(&self, field: Field<'_>, cursor: &Cursor<'_>) -> Result<u32, Fault> {
        let unexpected = || {
            let expected = "a corner like 1, 1/2, 1//3 or 1/2/3";
            let text = excerpt(field.text);
            cursor.fault_at(field, ReadProblem::Unexpected { expected, text })
        };
        let index = Corner::parse(field.text).ok_or_else(unexpected)?.vertex;
        let n_vertices = self.soup.positions.len();
        row(index, n_vertices)
            .and_then(|row| u32::try_from(row).ok())
            .ok_or_else(|| cursor.fault_at(field, out_of_range(index, n_vertices)))
    }

    fn smoothing_group(&mut self, name: &[u8]) {
        if name != b"off" && name != b"0" && !self.smoothing.contains(name) {
            self.smoothing.insert(name.to_vec());
        }
    }

    fn finish(mut self, bytes: Vec<u8>) -> Result<Parsed, Fault> {
        let n_vertices = self.soup.positions.len();
        if let Some((highest, at)) = self.highest.filter(|&(highest, _)| highest >= n_vertices) {
            let problem = out_of_range(highest as i64 + 1, n_vertices);
            return Err(Fault::in_text(&bytes, at, problem));
        }
        let n_faces = self.soup.faces.len();
        self.contents.objects = self.objects.finish(n_faces);
        self.contents.groups = self.groups.finish(n_faces);
        self.contents.materials = self.materials.finish(n_faces);
        self.contents.n_smoothing_groups = self.smoothing.len();
        Ok(Parsed {
            soup: self.soup,
            contents: self.contents,
            findings: Vec::new(),
            document: Box::new(ObjFile { bytes }),
        })
    }
}

fn out_of_range(index: i64, n_vertices: usize) -> ReadProblem {
    ReadProblem::IndexOutOfRange {
        index,
        n_vertices,
        first: 1,
    }
}

/// The row that a 1-based index names; negative ones count back from the last of the `n` seen so far.
fn row(index: i64, n: usize) -> Option<usize> {
    match index {
        0 => None,
        1.. => usize::try_from(index - 1).ok(),
        _ => n.checked_sub(usize::try_from(index.unsigned_abs()).ok()?),
    }
}

/// A corner of a face, as the file counts.
struct Corner {
    vertex: i64,
    uv: Option<i64>,
    normal: Option<i64>,
}

impl Corner {
    fn parse(text: &[u8]) -> Option<Self> {
        let slash = text.iter().position(|&b| b == b'/');
        let vertex = integer(&text[..slash.unwrap_or(text.len())])?;
        let Some(slash) = slash else {
            return Some(Self {
                vertex,
                uv: None,
                normal: None,
            });
        };
        let mut others = text[slash + 1..].split(|&b| b == b'/');
        let mut other = || match others.next() {
            None | Some(b"") => Some(None),
            Some(text) => integer(text).map(Some),
        };
        let (uv, normal, nothing) = (other()?, other()?, other()?);
        nothing.is_none().then_some(Self { vertex, uv, normal })
    }
}

impl Document for ObjFile {
    /// The mean of those a vertex's corners name, or row by row in a file of as many normals as vertices and no face.
    /// Zero where a vertex has none.
    fn vertex_normals(&self, soup: &PolygonSoup) -> Option<Vec<Vector3>> {
        let rows = normal_rows(&self.bytes);
        if soup.faces.is_empty() {
            return (rows.len() == soup.positions.len()).then_some(rows);
        }
        let mut sums = vec![Vector3::zeros(); soup.positions.len()];
        let mut any = false;
        each_normal_corner(&self.bytes, |face, corner, normal| {
            if let Some(n) = rows.get(normal) {
                sums[soup.faces[face][corner] as usize] += n;
                any = true;
            }
        });
        any.then_some(sums)
    }

    fn corner_uvs(&self, _: &PolygonSoup) -> Option<CornerUvs> {
        corner_uvs(&self.bytes)
    }

    fn vertex_colors(&self, n_vertices: usize) -> Option<Vec<Rgb>> {
        vertex_colors(&self.bytes).filter(|colors| colors.len() == n_vertices)
    }

    fn pictures(&self, contents: &Contents, _: usize, folder: &Path) -> Vec<NamedPicture> {
        of_libraries(contents, folder)
    }

    /// Coordinates that did not change keep their text.
    fn rewrite(&self, rest: &PolygonSoup, moved: &[Point3], _: Morphs) -> Result<Vec<u8>, Fault> {
        let normals = carried_normals(&self.bytes, rest, moved);
        let mut splice = Splice::new(&self.bytes);
        let (mut vertex, mut normal) = (0, 0);
        each_statement(&self.bytes, |keyword, cursor| match keyword {
            b"v" => {
                let (from, to) = (rest.positions[vertex], moved[vertex]);
                for axis in 0..3 {
                    let has_changed = from[axis].to_bits() != to[axis].to_bits();
                    if let Some(field) = cursor.field().filter(|_| has_changed) {
                        splice.replace_text(field.range(), to[axis]);
                    }
                }
                vertex += 1;
            }
            b"vn" => {
                if let Some(n) = normals.as_ref().and_then(|n| n.changed(normal)) {
                    replace_vector(&mut splice, cursor, n);
                }
                normal += 1;
            }
            _ => {}
        });
        Ok(splice.finish())
    }
}

fn replace_vector(splice: &mut Splice<'_>, cursor: &mut Cursor<'_>, vector: Vector3) {
    for &coordinate in &vector {
        if let Some(field) = cursor.field() {
            splice.replace_text(field.range(), coordinate);
        }
    }
}

/// The normals of the file on the new shape; none where it has none.
fn carried_normals(bytes: &[u8], rest: &PolygonSoup, moved: &[Point3]) -> Option<CarriedNormals> {
    let rows = normal_rows(bytes);
    if rows.is_empty() {
        return None;
    }
    let mut carried = CarriedNormals::new(rows);
    each_normal_corner(bytes, |face, _, normal| {
        let corners = &rest.faces[face];
        let areas = [&rest.positions[..], moved].map(|x| polygon_area_vector(x, corners));
        carried.add_corner(normal, areas);
    });
    Some(carried)
}

/// The values of the `vn` lines; zero where one does not read as three numbers.
fn normal_rows(bytes: &[u8]) -> Vec<Vector3> {
    let mut rows = Vec::new();
    each_statement(bytes, |keyword, cursor| {
        if keyword == b"vn" {
            let mut coordinate = || number(cursor.field()?.text).filter(|x| x.is_finite());
            let [x, y, z] = [coordinate(), coordinate(), coordinate()];
            rows.push(
                x.zip(y)
                    .zip(z)
                    .map_or_else(Vector3::zeros, |((x, y), z)| Vector3::new(x, y, z)),
            );
        }
    });
    rows
}

/// Calls `visit` with the face, the corner within it, and the normal's row of each corner that names a normal.
fn each_normal_corner(bytes: &[u8], mut visit: impl FnMut(usize, usize, usize)) {
    let (mut face, mut n_normals) = (0, 0);
    each_statement(bytes, |keyword, cursor| match keyword {
        b"vn" => n_normals += 1,
        b"f" | b"fo" => {
            let fields = std::iter::from_fn(|| cursor.field());
            for (corner, field) in fields.enumerate() {
                let normal = Corner::parse(field.text).and_then(|c| c.normal);
                if let Some(normal) = normal.and_then(|index| row(index, n_normals)) {
                    visit(face, corner, normal);
                }
            }
            face += 1;
        }
        _ => {}
    });
}

/// The texture coordinates that corners name; none where no corner does.
fn corner_uvs(bytes: &[u8]) -> Option<CornerUvs> {
    let mut uvs = CornerUvs {
        rows: Vec::new(),
        faces: Vec::new(),
    };
    each_statement(bytes, |keyword, cursor| match keyword {
        b"vt" => {
            let mut coordinate = || number(cursor.field()?.text).filter(|x| x.is_finite());
            uvs.rows.push([(); 2].map(|()| coordinate().unwrap_or(0.0)));
        }
        b"f" | b"fo" => {
            let n = uvs.rows.len();
            let corner = |field: Field<'_>| {
                let index = Corner::parse(field.text)?.uv?;
                u32::try_from(row(index, n)?).ok()
            };
            let corners = std::iter::from_fn(|| cursor.field()).map(corner);
            uvs.faces.push(corners.collect());
        }
        _ => {}
    });
    let any = uvs.faces.iter().flatten().any(Option::is_some);
    any.then_some(uvs)
}

/// The three numbers behind the coordinates of each vertex, white where there are none; brought to 0..=1 where they are
/// bytes.
fn vertex_colors(bytes: &[u8]) -> Option<Vec<Rgb>> {
    let (mut colors, mut any) = (Vec::new(), false);
    each_statement(bytes, |keyword, cursor| {
        if keyword == b"v" {
            let fields = std::iter::from_fn(|| cursor.field()).skip(3).take(4);
            let numbers: Vec<f64> = fields.filter_map(|field| number(field.text)).collect();
            any |= numbers.len() >= 3;
            colors.push(match numbers[..] {
                [r, g, b, ..] => [r, g, b].map(|c| c as f32),
                _ => [1.0; 3],
            });
        }
    });
    let are_bytes = colors.iter().flatten().any(|&c: &f32| c > 1.0);
    let scale = if are_bytes { 1.0 / 255.0 } else { 1.0 };
    any.then(|| colors.iter().map(|c| c.map(|x| x * scale)).collect())
}

/// A new file of `soup`.
fn write(soup: &PolygonSoup, uvs: Option<&CornerUvs>) -> Vec<u8> {
    let mut out = Vec::with_capacity(64 * soup.positions.len());
    for p in &soup.positions {
        push_text(&mut out, format_args!("v {} {} {}\n", p.x, p.y, p.z));
    }
    for [u, v] in uvs.iter().flat_map(|uvs| &uvs.rows) {
        push_text(&mut out, format_args!("vt {u} {v}\n"));
    }
    for (face, corners) in soup.faces.iter().enumerate() {
        out.push(b'f');
        for (corner, &v) in corners.iter().enumerate() {
            push_text(&mut out, format_args!(" {}", u64::from(v) + 1));
            if let Some(row) = uvs.and_then(|uvs| uvs.row(face, corner)) {
                push_text(&mut out, format_args!("/{}", u64::from(row) + 1));
            }
        }
        out.push(b'\n');
    }
    out
}
