//! The body of a PLY file, number by number, in any encoding.

use std::ops::Range;

use super::header::{Element, Encoding, Header, Kind, Scalar};
use crate::io::error::{Place, ReadProblem};
use crate::io::fault::{checked_coordinate, excerpt, Fault};
use crate::io::text::{number, push_text, Cursor, Splice};

/// A number of the body and the bytes it takes.
pub(super) struct Value {
    pub(super) value: f64,
    pub(super) range: Range<usize>,
}

/// Reads the body front to back.
pub(super) struct Body<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
    /// Whether each row of a text has lines of its own.
    has_lines: bool,
    /// What is being read, for faults.
    element: &'a str,
    row: usize,
}

impl<'a> Body<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self {
            bytes,
            at: header.body,
            encoding: header.encoding,
            has_lines: header.has_lines,
            element: "",
            row: 0,
        }
    }

    fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }

    /// The last number of a text may end with the file instead of a blank.
    fn slack(&self) -> usize {
        usize::from(self.encoding == Encoding::Ascii)
    }

    /// A fault at the row being read.
    pub(super) fn fault(&self, problem: ReadProblem) -> Fault {
        if self.encoding == Encoding::Ascii {
            return Fault::in_text(self.bytes, self.at, problem);
        }
        let place = Place::Row {
            element: self.element.to_owned(),
            row: self.row,
        };
        Fault { place, problem }
    }

    /// Calls `visit` for each row of `element`, which comes next in the file.
    pub(super) fn each_row(
        &mut self,
        element: &'a Element,
        mut visit: impl FnMut(&mut Self, usize) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let n_rows = self.promised(element)?;
        self.element = &element.name;
        for row in 0..n_rows {
            self.row = row;
            visit(self, row)?;
            if self.has_lines {
                self.skip_rest_of_line();
            }
        }
        Ok(())
    }

    /// Columns behind the last that the header names are no part of the next row.
    fn skip_rest_of_line(&mut self) {
        let mut line = Cursor::starting_at(self.bytes, self.at);
        while line.field().is_some() {}
        self.at = line.at();
    }

    /// How many rows `element` has, if what is left of the file can hold them; none where a row takes no byte.
    pub(super) fn promised(&self, element: &Element) -> Result<usize, Fault> {
        let least = element.least_row(self.encoding) as u64;
        if least == 0 {
            return Ok(0);
        }
        let bytes = self.left();
        if element.count.saturating_mul(least) > (bytes + self.slack()) as u64 {
            let count = element.count;
            let element = format!("rows of `{}`", element.name);
            return Err(Fault::whole(ReadProblem::Oversized {
                element,
                count,
                bytes,
            }));
        }
        Ok(element.count as usize)
    }

    /// Skips all rows of `element`.
    pub(super) fn skip_element(&mut self, element: &'a Element) -> Result<(), Fault> {
        self.each_row(element, |body, _| {
            for property in &element.properties {
                body.skip(property.kind)?;
            }
            Ok(())
        })
    }

    /// Skips one property of a row.
    pub(super) fn skip(&mut self, kind: Kind) -> Result<(), Fault> {
        match kind {
            Kind::Scalar(scalar) => self.take(scalar).map(|_| ()),
            Kind::List { count, item } => {
                let n = self.list_length(count, item)?;
                if self.encoding != Encoding::Ascii {
                    self.at += n * item.size();
                    return Ok(());
                }
                (0..n).try_for_each(|_| self.take(item).map(|_| ()))
            }
        }
    }

    /// The length of a list, if what is left of the file can hold so many items.
    pub(super) fn list_length(&mut self, count: Scalar, item: Scalar) -> Result<usize, Fault> {
        let Value { value, range } = self.value(count)?;
        if !(value >= 0.0 && value.fract() == 0.0) {
            let text = value.to_string();
            let expected = "the length of a list";
            return Err(self.fault(ReadProblem::Unexpected { expected, text }));
        }
        let least = match self.encoding {
            Encoding::Ascii => 2,
            _ => item.size(),
        };
        let bytes = self.bytes.len() - range.end;
        if value * least as f64 > (bytes + self.slack()) as f64 {
            let (element, count) = ("items of a list".to_owned(), value as u64);
            return Err(self.fault(ReadProblem::Oversized {
                element,
                count,
                bytes,
            }));
        }
        Ok(value as usize)
    }

    /// The next number.
    #[inline]
    pub(super) fn value(&mut self, scalar: Scalar) -> Result<Value, Fault> {
        let range = self.take(scalar)?;
        self.parse(scalar, range)
    }

    #[inline]
    fn parse(&self, scalar: Scalar, range: Range<usize>) -> Result<Value, Fault> {
        let bytes = &self.bytes[range.clone()];
        let value = match self.encoding {
            Encoding::Ascii => number(bytes).ok_or_else(|| {
                let text = excerpt(bytes);
                Fault::in_text(self.bytes, range.start, ReadProblem::NotANumber { text })
            })?,
            Encoding::LittleEndian => decode(scalar, bytes, false),
            Encoding::BigEndian => decode(scalar, bytes, true),
        };
        Ok(Value { value, range })
    }

    /// The next number as a finite coordinate.
    pub(super) fn coordinate(&mut self, scalar: Scalar) -> Result<Value, Fault> {
        let value = self.value(scalar)?;
        let text = || match self.encoding {
            Encoding::Ascii => excerpt(&self.bytes[value.range.clone()]),
            _ => format!("{:?}", value.value),
        };
        match checked_coordinate(value.value, text) {
            Ok(_) => Ok(value),
            Err(problem) => Err(self.fault(problem)),
        }
    }

    /// The next number; NaN where a text has something else.
    pub(super) fn value_or_nan(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        let range = self.take(scalar)?;
        Ok(self.parse(scalar, range).map_or(f64::NAN, |v| v.value))
    }

    /// The bytes of the next number.
    #[inline]
    pub(super) fn take(&mut self, scalar: Scalar) -> Result<Range<usize>, Fault> {
        let range = if self.encoding == Encoding::Ascii {
            let mut cursor = Cursor::starting_at(self.bytes, self.at);
            cursor.word().map(|field| field.range())
        } else {
            Some(self.at..self.at + scalar.size()).filter(|r| r.end <= self.bytes.len())
        };
        let expected = "another number";
        let range = range.ok_or_else(|| self.fault(ReadProblem::EndsEarly { expected }))?;
        self.at = range.end;
        Ok(range)
    }

    /// Puts `value` where a number of type `scalar` was: `double` where that type holds whole numbers only.
    pub(super) fn put(
        &self,
        splice: &mut Splice<'_>,
        range: Range<usize>,
        scalar: Scalar,
        value: f64,
    ) -> Result<(), Fault> {
        let is_big = self.encoding == Encoding::BigEndian;
        match scalar {
            _ if self.encoding == Encoding::Ascii => splice.replace_text(range, value),
            Scalar::F32 => {
                let single = value as f32;
                if !single.is_finite() {
                    let text = value.to_string();
                    return Err(self.fault(ReadProblem::NotFinite { text }));
                }
                splice.replace(
                    range,
                    &if is_big {
                        single.to_be_bytes()
                    } else {
                        single.to_le_bytes()
                    },
                );
            }
            _ => splice.replace(
                range,
                &if is_big {
                    value.to_be_bytes()
                } else {
                    value.to_le_bytes()
                },
            ),
        }
        Ok(())
    }
}

/// The number in the `scalar.size()` bytes of `bytes`, most significant first if `is_big`.
#[inline]
fn decode(scalar: Scalar, bytes: &[u8], is_big: bool) -> f64 {
    match scalar {
        Scalar::I8 => f64::from(i8::from_le_bytes(number_bytes(bytes, is_big))),
        Scalar::U8 => f64::from(u8::from_le_bytes(number_bytes(bytes, is_big))),
        Scalar::I16 => f64::from(i16::from_le_bytes(number_bytes(bytes, is_big))),
        Scalar::U16 => f64::from(u16::from_le_bytes(number_bytes(bytes, is_big))),
        Scalar::I32 => f64::from(i32::from_le_bytes(number_bytes(bytes, is_big))),
        Scalar::U32 => f64::from(u32::from_le_bytes(number_bytes(bytes, is_big))),
        Scalar::I64 => i64::from_le_bytes(number_bytes(bytes, is_big)) as f64,
        Scalar::U64 => u64::from_le_bytes(number_bytes(bytes, is_big)) as f64,
        Scalar::F16 => half(u16::from_le_bytes(number_bytes(bytes, is_big))),
        Scalar::F32 => f64::from(f32::from_le_bytes(number_bytes(bytes, is_big))),
        Scalar::F64 => f64::from_le_bytes(number_bytes(bytes, is_big)),
    }
}

/// The number that 16 bits are: a sign, five bits of exponent, ten of fraction (IEEE 754, binary16).
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1F), f64::from(bits & 0x3FF));
    sign * match exponent {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    }
}

/// The `N` bytes of a number, least significant first.
#[inline]
fn number_bytes<const N: usize>(bytes: &[u8], is_big: bool) -> [u8; N] {
    let mut number = [0; N];
    number.copy_from_slice(bytes);
    if is_big {
        number.reverse();
    }
    number
}

/// Appends a little-endian body of `values` in double precision.
pub(super) fn push_doubles(out: &mut Vec<u8>, values: impl IntoIterator<Item = f64>) {
    for value in values {
        out.extend_from_slice(&value.to_le_bytes());
    }
}

/// Appends the header of a little-endian file of `n_vertices` and `n_faces`.
pub(super) fn push_header(out: &mut Vec<u8>, n_vertices: usize, n_faces: usize) {
    push_text(
        out,
        format_args!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {n_vertices}\nproperty double x\nproperty double y\n\
             property double z\nelement face {n_faces}\nproperty list int int vertex_indices\nend_header\n"
        ),
    );
}
