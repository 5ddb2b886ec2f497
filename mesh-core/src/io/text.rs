//! Text as bytes: lines, fields, numbers, and the same text with some fields replaced.

use std::fmt::Display;
use std::io::Write;
use std::ops::Range;

use super::error::ReadProblem;
use super::fault::{checked_coordinate, excerpt, Fault};

/// A run of bytes between blanks, and where it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Field<'a> {
    pub(super) text: &'a [u8],
    pub(super) at: usize,
}

impl Field<'_> {
    pub(super) fn range(&self) -> Range<usize> {
        self.at..self.at + self.text.len()
    }
}

/// Reads text field by field. `#` before a field starts a comment; a backslash that ends a line continues it.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(BYTE_ORDER_MARK) {
            BYTE_ORDER_MARK.len()
        } else {
            0
        };
        Self { bytes, at }
    }

    /// A cursor at byte `at`.
    pub(super) fn starting_at(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// All of the text.
    pub(super) fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The byte it stands before.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// How many bytes are left.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// The next field of this line; none at its end or at a comment.
    #[inline]
    pub(super) fn field(&mut self) -> Option<Field<'a>> {
        self.skip_blanks();
        let start = self.at;
        match self.peek() {
            None | Some(b'\n' | b'\r' | b'#') => return None,
            Some(_) => {}
        }
        loop {
            let rest = &self.bytes[self.at..];
            let length = rest.iter().position(|&b| MAY_END_A_FIELD[usize::from(b)]);
            self.at += length.unwrap_or(rest.len());
            if self.peek() != Some(b'\\') || self.continuation().is_some() {
                break;
            }
            self.at += 1;
        }
        Some(Field {
            text: &self.bytes[start..self.at],
            at: start,
        })
    }

    /// The next field on this line or a later one; none at the end of the file.
    pub(super) fn word(&mut self) -> Option<Field<'a>> {
        loop {
            if let Some(field) = self.field() {
                return Some(field);
            }
            if self.left() == 0 {
                return None;
            }
            self.next_line();
        }
    }

    /// Goes to the start of the next line.
    pub(super) fn next_line(&mut self) {
        while self.field().is_some() {}
        while self.peek().is_some_and(|b| !is_newline(b)) {
            self.at += 1;
        }
        match self.bytes.get(self.at..self.at + 2) {
            Some(b"\r\n") => self.at += 2,
            _ => self.at = self.bytes.len().min(self.at + 1),
        }
    }

    /// What is left of this line before a comment, without blanks around it.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let start = self.at;
        let mut end = start;
        while let Some(field) = self.field() {
            end = field.range().end;
        }
        &self.bytes[start..end]
    }

    /// Whether the cursor stands before a comment.
    pub(super) fn is_at_comment(&self) -> bool {
        self.peek() == Some(b'#')
    }

    #[inline]
    fn skip_blanks(&mut self) {
        while let Some(byte) = self.peek() {
            if is_blank(byte) {
                self.at += 1;
            } else if let (b'\\', Some(length)) = (byte, self.continuation()) {
                self.at += length;
            } else {
                return;
            }
        }
    }

    /// How long the line continuation is that starts here, if one does.
    fn continuation(&self) -> Option<usize> {
        match self.bytes[self.at..] {
            [b'\\', b'\r', b'\n', ..] => Some(3),
            [b'\\', b'\r' | b'\n', ..] => Some(2),
            _ => None,
        }
    }

    /// A fault where this cursor stands.
    pub(super) fn fault(&self, problem: ReadProblem) -> Fault {
        Fault::in_text(self.bytes, self.at, problem)
    }

    /// A fault at `field`.
    pub(super) fn fault_at(&self, field: Field<'_>, problem: ReadProblem) -> Fault {
        Fault::in_text(self.bytes, field.at, problem)
    }

    /// `field` as a finite coordinate.
    pub(super) fn coordinate(&self, field: Option<Field<'a>>) -> Result<f64, Fault> {
        let Some(field) = field else {
            let expected = "a coordinate";
            return Err(self.fault(ReadProblem::EndsEarly { expected }));
        };
        let text = || excerpt(field.text);
        let checked = match number(field.text) {
            Some(x) => checked_coordinate(x, text),
            None => Err(ReadProblem::NotANumber { text: text() }),
        };
        checked.map_err(|problem| self.fault_at(field, problem))
    }

    /// `field` as a count or index from 0.
    pub(super) fn count(
        &self,
        field: Option<Field<'a>>,
        expected: &'static str,
    ) -> Result<u64, Fault> {
        let field = field.ok_or_else(|| self.fault(ReadProblem::EndsEarly { expected }))?;
        let whole = |x: f64| (x.fract() == 0.0 && x.abs() < 1e15).then_some(x as i64);
        integer(field.text)
            .or_else(|| number(field.text).and_then(whole))
            .and_then(|n| u64::try_from(n).ok())
            .ok_or_else(|| {
                let text = excerpt(field.text);
                self.fault_at(field, ReadProblem::Unexpected { expected, text })
            })
    }
}

/// Blanks, line ends, and the backslash that may stand before one.
const MAY_END_A_FIELD: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0;
    while byte < table.len() {
        table[byte] = is_blank(byte as u8) || is_newline(byte as u8) || byte as u8 == b'\\';
        byte += 1;
    }
    table
};

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0B | 0x0C)
}

const fn is_newline(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// The decimal number in `text`, rounded to the nearest `f64`.
#[inline]
pub(super) fn number(text: &[u8]) -> Option<f64> {
    short_decimal(text).or_else(|| std::str::from_utf8(text).ok()?.parse().ok())
}

/// `±m / 10ᵏ` where both are exact in `f64` (m < 2⁵³, k ≤ 22), so that one division rounds correctly.
#[inline]
fn short_decimal(text: &[u8]) -> Option<f64> {
    const POWERS: [f64; 16] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
    ];
    let (sign, digits) = match text {
        [b'-', digits @ ..] => (-1.0, digits),
        digits => (1.0, digits),
    };
    if digits.len() > POWERS.len() {
        return None;
    }
    let mut mantissa = 0u64;
    let mut point = None;
    for (k, &byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => mantissa = 10 * mantissa + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(k),
            _ => return None,
        }
    }
    let n_digits = digits.len() - usize::from(point.is_some());
    let n_decimals = point.map_or(0, |k| digits.len() - 1 - k);
    (1..=15)
        .contains(&n_digits)
        .then(|| sign * (mantissa as f64 / POWERS[n_decimals]))
}

/// The whole number in `text`, with an optional sign.
#[inline]
pub(super) fn integer(text: &[u8]) -> Option<i64> {
    let (sign, digits) = match text {
        [b'-', digits @ ..] => (-1, digits),
        [b'+', digits @ ..] => (1, digits),
        digits => (1, digits),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    digits
        .iter()
        .try_fold(0i64, |n, &byte| {
            byte.is_ascii_digit()
                .then(|| 10 * n + i64::from(byte - b'0'))
        })
        .map(|n| sign * n)
}

/// Copies a file while some of its bytes are replaced, front to back.
pub(super) struct Splice<'a> {
    source: &'a [u8],
    out: Vec<u8>,
    copied: usize,
}

impl<'a> Splice<'a> {
    pub(super) fn new(source: &'a [u8]) -> Self {
        Self {
            source,
            out: Vec::with_capacity(source.len() + source.len() / 4),
            copied: 0,
        }
    }

    /// Puts the bytes of `new` where `range` was. Ranges come in the order of the file.
    pub(super) fn replace(&mut self, range: Range<usize>, new: &[u8]) {
        self.out
            .extend_from_slice(&self.source[self.copied..range.start]);
        self.out.extend_from_slice(new);
        self.copied = range.end;
    }

    /// Puts the text of `new` where `range` was: numbers in the shortest form that reads back the same.
    pub(super) fn replace_text(&mut self, range: Range<usize>, new: impl Display) {
        self.replace(range, b"");
        push_text(&mut self.out, new);
    }

    /// The copy with all that follows the last replacement.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.out.extend_from_slice(&self.source[self.copied..]);
        self.out
    }
}

/// Appends the text of `value`.
pub(super) fn push_text(out: &mut Vec<u8>, value: impl Display) {
    write!(out, "{value}").expect("a vector takes all bytes");
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fields(cursor: &mut Cursor<'_>) -> Vec<String> {
        std::iter::from_fn(|| cursor.field())
            .map(|f| String::from_utf8_lossy(f.text).into_owned())
            .collect()
    }

    #[test]
    fn fields_cross_continuations_and_stop_at_comments() {
        let mut cursor = Cursor::new(b"v 1\t2 \\\r\n 3\\\n4 # 5 \\\nf 1\\2\r6\n");
        assert_eq!(fields(&mut cursor), ["v", "1", "2", "3", "4"]);
        cursor.next_line();
        assert_eq!(fields(&mut cursor), ["f", "1\\2"]);
        cursor.next_line();
        assert_eq!(fields(&mut cursor), ["6"]);
        cursor.next_line();
        assert_eq!((cursor.left(), cursor.field().is_none()), (0, true));
    }

    #[test]
    fn numbers_that_are_none() {
        for text in [
            "", "-", ".", "-.", "1,5", "1.2.3", "0x10", "1f", "--1", "1 ",
        ] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
        assert_eq!(number(b"+1.5e-3"), Some(1.5e-3));
        assert_eq!(number(b"-0.").map(f64::to_bits), Some((-0f64).to_bits()));
        assert_eq!(integer(b"-12"), Some(-12));
        assert_eq!(integer(b"9223372036854775808"), None);
    }

    proptest! {
        #[test]
        fn numbers_are_rounded_as_the_standard_library_does(text in "-?[0-9]{0,17}(\\.[0-9]{0,17})?(e-?[0-9]{1,3})?") {
            let expected: Option<f64> = text.parse().ok();
            prop_assert_eq!(number(text.as_bytes()).map(f64::to_bits), expected.map(f64::to_bits));
        }

        #[test]
        fn any_number_survives_its_text(x in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO) {
            let mut text = Vec::new();
            push_text(&mut text, x);
            prop_assert_eq!(number(&text).map(f64::to_bits), Some(x.to_bits()));
        }
    }
}
