//! Lists of points: one a line, columns between blanks, commas or semicolons. Written back, only the first three
//! columns differ.
//!
//! A comma is a decimal comma where it cannot be anything else: between semicolons, or where each of three or more
//! columns between blanks has one at most. A line that could be read either way is refused.

use std::path::Path;

use super::contents::{Contents, Morphs};
use super::document::{Codec, Document, Geometry, Parsed};
use super::error::ReadProblem;
use super::fault::{checked_coordinate, excerpt, Fault};
use super::text::{integer, number, push_text, Cursor, Field, Splice};
use crate::{Point3, PolygonSoup, Vector3};

pub(super) const CODEC: Codec = Codec {
    name: "XYZ",
    extensions: &["xyz", "xyzn", "pts", "asc", "csv", "txt"],
    is_text: true,
    geometry: Geometry::Points,
    has_uvs: false,
    has_mark: |_| false,
    is_always_marked: false,
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
    columns.is_ok_and(|columns| columns.len() >= 3 && columns.iter().all(|c| c.number().is_some()))
}

/// A column of a line.
#[derive(Clone, Copy)]
struct Column<'a> {
    field: Field<'a>,
    /// Whether a comma in it is a decimal comma.
    has_decimal_comma: bool,
}

impl Column<'_> {
    fn number(&self) -> Option<f64> {
        if !self.has_decimal_comma || !self.field.text.contains(&b',') {
            return number(self.field.text);
        }
        let point = |&byte: &u8| if byte == b',' { b'.' } else { byte };
        let text: Vec<u8> = self.field.text.iter().map(point).collect();
        number(&text)
    }

    /// How a number is written in this column.
    fn text_of(&self, x: f64) -> String {
        let text = x.to_string();
        match self.has_decimal_comma {
            true => text.replace('.', ","),
            false => text,
        }
    }
}

/// The columns of the line that the cursor stands in.
fn columns<'a>(cursor: &mut Cursor<'a>) -> Result<Vec<Column<'a>>, Fault> {
    let fields: Vec<Field<'a>> = std::iter::from_fn(|| cursor.field()).collect();
    let has = |separator| fields.iter().any(|f| f.text.contains(&separator));
    let column = |has_decimal_comma| {
        move |field| Column {
            field,
            has_decimal_comma,
        }
    };
    let (has_semicolons, has_commas) = (has(b';'), has(b','));
    if !has_semicolons && !has_commas {
        return Ok(fields.into_iter().map(column(false)).collect());
    }
    let parts = split(&fields, b';');
    let has_points = parts
        .iter()
        .any(|part| is_numeric(part) && part.text.contains(&b'.'));
    let most_commas = parts.iter().map(n_inner_commas).max().unwrap_or(0);
    let may_be_decimal = most_commas == 1 && parts.len() >= 3;
    if may_be_decimal && !has_points {
        return Ok(parts.into_iter().map(column(true)).collect());
    }
    if may_be_decimal || has_semicolons && most_commas > 0 && parts.len() > 1 {
        return Err(ambiguous(cursor, &parts));
    }
    Ok(split(&parts, b',').into_iter().map(column(false)).collect())
}

/// Commas that are not at an end of the text.
fn n_inner_commas(field: &Field<'_>) -> usize {
    let inner = field.text.strip_suffix(b",").unwrap_or(field.text);
    let inner = inner.strip_prefix(b",").unwrap_or(inner);
    inner.iter().filter(|&&b| b == b',').count()
}

/// Whether all characters are those of numbers.
fn is_numeric(field: &Field<'_>) -> bool {
    let is_part = |b: &u8| b.is_ascii_digit() || b"+-.,eE".contains(b);
    field.text.iter().all(is_part)
}

/// The parts of fields between separators, those with nothing in them left out.
fn split<'a>(fields: &[Field<'a>], separator: u8) -> Vec<Field<'a>> {
    let mut parts = Vec::with_capacity(fields.len());
    for field in fields {
        let mut at = field.at;
        for text in field.text.split(|&b| b == separator) {
            if !text.is_empty() {
                parts.push(Field { text, at });
            }
            at += text.len() + 1;
        }
    }
    parts
}

fn ambiguous(cursor: &Cursor<'_>, fields: &[Field<'_>]) -> Fault {
    let is_odd = |f: &&Field<'_>| f.text.contains(&b',');
    let field = fields.iter().find(is_odd).or(fields.first());
    let expected = "either decimal commas between semicolons or commas between columns";
    let text = field.map_or_else(String::new, |f| excerpt(f.text));
    let problem = ReadProblem::Unexpected { expected, text };
    match field {
        Some(&field) => cursor.fault_at(field, problem),
        None => cursor.fault(problem),
    }
}

/// Calls `visit` with the columns of each point; a heading and a leading count are none.
fn each_point<'a>(
    bytes: &'a [u8],
    mut visit: impl FnMut(&Cursor<'a>, &[Column<'a>]) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let mut cursor = Cursor::new(bytes);
    let mut is_first = true;
    while cursor.left() > 0 {
        let columns = columns(&mut cursor)?;
        let is_skipped = columns.is_empty() || is_first && is_heading(&columns);
        if !is_skipped {
            visit(&cursor, &columns)?;
        }
        is_first &= columns.is_empty();
        cursor.next_line();
    }
    Ok(())
}

fn is_heading(columns: &[Column<'_>]) -> bool {
    let is_count = columns.len() == 1 && integer(columns[0].field.text).is_some();
    is_count || columns.iter().all(|c| c.number().is_none())
}

/// Reads a file: points in their order.
fn read(bytes: Vec<u8>, _: &Path) -> Result<Parsed, Fault> {
    let mut soup = PolygonSoup::default();
    each_point(&bytes, |cursor, columns| {
        let mut p = Point3::origin();
        for axis in 0..3 {
            p[axis] = coordinate(cursor, columns.get(axis))?;
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
        findings: Vec::new(),
        document: Box::new(PointList { bytes }),
    })
}

fn coordinate(cursor: &Cursor<'_>, column: Option<&Column<'_>>) -> Result<f64, Fault> {
    let Some(column) = column else {
        let expected = "a coordinate";
        return Err(cursor.fault(ReadProblem::EndsEarly { expected }));
    };
    let text = || excerpt(column.field.text);
    let checked = match column.number() {
        Some(x) => checked_coordinate(x, text),
        None => Err(ReadProblem::NotANumber { text: text() }),
    };
    checked.map_err(|problem| cursor.fault_at(column.field, problem))
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
        let n: Vec<f64> = n.filter_map(Column::number).collect();
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
                    splice.replace_text(column.field.range(), column.text_of(to[axis]));
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
