//! Lists of points: one a line, columns between blanks, commas or semicolons. Written back, only the first three
//! columns differ.

use std::path::Path;

use super::contents::{Contents, Morphs};
use super::document::{Codec, Document, Geometry, Parsed};
use super::fault::Fault;
use super::text::{integer, number, push_text, Cursor, Field, Splice};
use crate::{Point3, PolygonSoup, Vector3};

pub(super) const CODEC: Codec = Codec {
    name: "XYZ",
    extensions: &["xyz", "xyzn", "pts", "asc", "csv", "txt"],
    is_text: true,
    geometry: Geometry::Points,
    has_uvs: false,
    has_mark: |_| false,
    has_statement: is_points,
    read,
    write: |soup, _| Ok(write(&soup.positions)),
};

/// A list of points as it was read.
#[derive(Debug)]
struct PointList {
    bytes: Vec<u8>,
}

/// How far the length of a row of three columns may be from 1 for them to be normals: text is rounded.
const UNIT_TOLERANCE: f64 = 0.02;

/// Whether the first line reads as a point.
fn is_points(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new(bytes);
    let Some(first) = cursor.word() else {
        return false;
    };
    let columns = columns(&mut Cursor::starting_at(bytes, first.at));
    columns.len() >= 3 && columns.iter().all(|c| number(c.text).is_some())
}

/// The columns of the line that the cursor stands in.
fn columns<'a>(cursor: &mut Cursor<'a>) -> Vec<Field<'a>> {
    let mut columns = Vec::new();
    while let Some(field) = cursor.field() {
        let mut at = field.at;
        for text in field.text.split(|b| matches!(b, b',' | b';')) {
            if !text.is_empty() {
                columns.push(Field { text, at });
            }
            at += text.len() + 1;
        }
    }
    columns
}

/// Calls `visit` with the columns of each point; a heading and a leading count are none.
fn each_point<'a>(
    bytes: &'a [u8],
    mut visit: impl FnMut(&Cursor<'a>, &[Field<'a>]) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let mut cursor = Cursor::new(bytes);
    let mut is_first = true;
    while cursor.left() > 0 {
        let columns = columns(&mut cursor);
        let is_skipped = columns.is_empty() || is_first && is_heading(&columns);
        if !is_skipped {
            visit(&cursor, &columns)?;
        }
        is_first &= columns.is_empty();
        cursor.next_line();
    }
    Ok(())
}

fn is_heading(columns: &[Field<'_>]) -> bool {
    let is_count = columns.len() == 1 && integer(columns[0].text).is_some();
    is_count || columns.iter().all(|c| number(c.text).is_none())
}

/// Reads a file: points in their order.
fn read(bytes: Vec<u8>, _: &Path) -> Result<Parsed, Fault> {
    let mut soup = PolygonSoup::default();
    each_point(&bytes, |cursor, columns| {
        let mut p = Point3::origin();
        for axis in 0..3 {
            p[axis] = cursor.coordinate(columns.get(axis).copied())?;
        }
        soup.positions.push(p);
        Ok(())
    })?;
    let n_normals = normals(&bytes).map_or(0, |n| n.len());
    Ok(Parsed {
        soup,
        contents: Contents {
            n_normals,
            ..Contents::default()
        },
        document: Box::new(PointList { bytes }),
    })
}

/// The last three of six or more columns, if they have length 1 in every row.
fn normals(bytes: &[u8]) -> Option<Vec<Vector3>> {
    let mut normals = Vec::new();
    let mut are_unit = true;
    let walked = each_point(bytes, |_, columns| {
        if !are_unit {
            return Ok(());
        }
        let n = columns.iter().skip(3.max(columns.len().saturating_sub(3)));
        let n: Vec<f64> = n.filter_map(|c| number(c.text)).collect();
        let n = <[f64; 3]>::try_from(n).map_or_else(|_| Vector3::zeros(), Vector3::from);
        are_unit = (n.norm() - 1.0).abs() <= UNIT_TOLERANCE;
        normals.push(n);
        Ok(())
    });
    (walked.is_ok() && are_unit && !normals.is_empty()).then_some(normals)
}

impl Document for PointList {
    fn vertex_normals(&self, _: &PolygonSoup) -> Option<Vec<Vector3>> {
        normals(&self.bytes)
    }

    /// Coordinates that did not change keep their text.
    fn rewrite(&self, rest: &PolygonSoup, moved: &[Point3], _: Morphs) -> Result<Vec<u8>, Fault> {
        let mut splice = Splice::new(&self.bytes);
        let mut row = 0;
        each_point(&self.bytes, |_, columns| {
            let (from, to) = (rest.positions[row], moved[row]);
            for (axis, column) in columns.iter().take(3).enumerate() {
                if from[axis].to_bits() != to[axis].to_bits() {
                    splice.replace_text(column.range(), to[axis]);
                }
            }
            row += 1;
            Ok(())
        })?;
        Ok(splice.finish())
    }
}

/// A new file of points.
fn write(points: &[Point3]) -> Vec<u8> {
    let mut out = Vec::with_capacity(48 * points.len());
    for p in points {
        push_text(&mut out, format_args!("{} {} {}\n", p.x, p.y, p.z));
    }
    out
}
