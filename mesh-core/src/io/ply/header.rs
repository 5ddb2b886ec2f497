//! The header of a PLY file: which elements follow, in which types.

use std::ops::Range;

use crate::io::error::ReadProblem;
use crate::io::fault::{excerpt, Fault};
use crate::io::text::{Cursor, Field};

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"int64" => Self::I64,
            b"uint64" => Self::U64,
            b"float16" => Self::F16,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in a binary body.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Whether a coordinate can be put where one of this type was.
    pub(super) fn holds_coordinates(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::F64)
    }
}

/// One number, or a count and so many numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A column of an element.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// Where the header names the type.
    pub(super) type_name: Range<usize>,
}

/// A table of the body.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The fewest bytes a row takes.
    pub(super) fn least_row(&self, encoding: Encoding) -> usize {
        let least = |p: &Property| match (encoding, p.kind) {
            (Encoding::Ascii, _) => 2,
            (_, Kind::Scalar(scalar)) => scalar.size(),
            (_, Kind::List { count, .. }) => count.size(),
        };
        self.properties.iter().map(least).sum()
    }

    /// Whether there is a column called one of `names`.
    pub(super) fn has_any(&self, names: &[&str]) -> bool {
        self.properties
            .iter()
            .any(|p| names.contains(&p.name.as_str()))
    }
}

/// All of the header.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    pub(super) n_comments: usize,
    /// Where the body starts.
    pub(super) body: usize,
    /// Whether a text body has a line at least for each row, so that rows end where lines end.
    pub(super) has_lines: bool,
}

impl Header {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let newline = newline_of(bytes);
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut n_comments = 0;
        let mut at = Cursor::new(bytes).at();
        loop {
            let end = line_end(bytes, at, newline)?;
            let mut line = Cursor::starting_at(&bytes[..end], at);
            let keyword = line.field();
            match keyword.map(|k| k.text) {
                None | Some(b"ply" | b"PLY" | b"obj_info") => {}
                Some(b"comment") => n_comments += 1,
                Some(b"format") => encoding = Some(read_encoding(&mut line)?),
                Some(b"element") => elements.push(read_element(&mut line)?),
                Some(b"property") => {
                    let property = read_property(&mut line)?;
                    let element = elements.last_mut();
                    let expected = "an `element` line before the first `property`";
                    element
                        .ok_or_else(|| unexpected(&line, keyword, expected))?
                        .properties
                        .push(property);
                }
                Some(b"end_header") => {
                    let expected = "a `format` line in the header";
                    let encoding = encoding.ok_or_else(|| unexpected(&line, keyword, expected))?;
                    let body = end + newline.len();
                    return Ok(Self {
                        has_lines: encoding == Encoding::Ascii
                            && has_lines(&bytes[body..], &elements),
                        encoding,
                        elements,
                        n_comments,
                        body,
                    });
                }
                Some(_) => return Err(unexpected(&line, keyword, "a line of a PLY header")),
            }
            at = end + newline.len();
        }
    }
}

/// Whether there are at least as many lines with something on them as rows.
fn has_lines(body: &[u8], elements: &[Element]) -> bool {
    let n_rows = elements.iter().fold(0u64, |n, e| n.saturating_add(e.count));
    let lines = body.split(|b| matches!(b, b'\n' | b'\r'));
    let n_lines = lines.filter(|line| !line.trim_ascii().is_empty()).count();
    n_lines as u64 >= n_rows
}

/// The line end that the first line uses: in a binary file, bytes of the body could pass for another.
fn newline_of(bytes: &[u8]) -> &'static [u8] {
    match bytes.iter().position(|b| matches!(b, b'\n' | b'\r')) {
        Some(k) if bytes[k..].starts_with(b"\r\n") => b"\r\n",
        Some(k) if bytes[k] == b'\r' => b"\r",
        _ => b"\n",
    }
}

fn line_end(bytes: &[u8], at: usize, newline: &[u8]) -> Result<usize, Fault> {
    let rest = bytes.get(at..).unwrap_or_default();
    let length = rest.windows(newline.len()).position(|w| w == newline);
    length.map(|n| at + n).ok_or_else(|| {
        let expected = "`end_header`";
        Fault::in_text(bytes, bytes.len(), ReadProblem::EndsEarly { expected })
    })
}

fn unexpected(line: &Cursor<'_>, field: Option<Field<'_>>, expected: &'static str) -> Fault {
    match field {
        None => line.fault(ReadProblem::EndsEarly { expected }),
        Some(field) => {
            let text = excerpt(field.text);
            line.fault_at(field, ReadProblem::Unexpected { expected, text })
        }
    }
}

fn read_encoding(line: &mut Cursor<'_>) -> Result<Encoding, Fault> {
    let field = line.field();
    match field.map(|f| f.text) {
        Some(b"ascii") => Ok(Encoding::Ascii),
        Some(b"binary_little_endian") => Ok(Encoding::LittleEndian),
        Some(b"binary_big_endian") => Ok(Encoding::BigEndian),
        _ => {
            let expected = "ascii, binary_little_endian or binary_big_endian";
            Err(unexpected(line, field, expected))
        }
    }
}

fn read_element(line: &mut Cursor<'_>) -> Result<Element, Fault> {
    let name = read_name(line, "the name of an element")?;
    let count = line.field();
    Ok(Element {
        name,
        count: line.count(count, "the number of rows of an element")?,
        properties: Vec::new(),
    })
}

fn read_property(line: &mut Cursor<'_>) -> Result<Property, Fault> {
    let first = line.field();
    let type_name = first.map(|f| f.range()).unwrap_or_default();
    let kind = if first.is_some_and(|f| f.text == b"list") {
        let count = line.field();
        let item = line.field();
        Kind::List {
            count: read_scalar(line, count)?,
            item: read_scalar(line, item)?,
        }
    } else {
        Kind::Scalar(read_scalar(line, first)?)
    };
    Ok(Property {
        name: read_name(line, "the name of a property")?,
        kind,
        type_name,
    })
}

fn read_scalar(line: &Cursor<'_>, field: Option<Field<'_>>) -> Result<Scalar, Fault> {
    let expected = "a type like uchar, int or float";
    field
        .and_then(|f| Scalar::named(f.text))
        .ok_or_else(|| unexpected(line, field, expected))
}

fn read_name(line: &mut Cursor<'_>, expected: &'static str) -> Result<String, Fault> {
    let field = line
        .field()
        .ok_or_else(|| unexpected(line, None, expected))?;
    Ok(String::from_utf8_lossy(field.text).into_owned())
}
