//! Text in two bytes a character, as some editors save it: read as UTF-8, written back as it was.

use super::error::ReadProblem;
use super::fault::Fault;

/// How the text of a file is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// As it is read: UTF-8 or ASCII, or no text at all.
    Plain,
    /// UTF-16 behind its byte-order mark, least significant byte first or last.
    Utf16 {
        /// Whether the most significant byte is first.
        is_big: bool,
    },
}

/// The content as UTF-8 where its byte-order mark says UTF-16; untouched otherwise.
pub(super) fn decode(bytes: Vec<u8>) -> Result<(Vec<u8>, Encoding), Fault> {
    let is_big = match bytes[..] {
        [0xFF, 0xFE, low, 0, ..] if low != 0 => false,
        [0xFE, 0xFF, 0, low, ..] if low != 0 => true,
        _ => return Ok((bytes, Encoding::Plain)),
    };
    let (pairs, rest) = bytes[2..].as_chunks();
    let units = pairs.iter().map(|&pair| match is_big {
        true => u16::from_be_bytes(pair),
        false => u16::from_le_bytes(pair),
    });
    let text: Result<String, _> = char::decode_utf16(units).collect();
    match text {
        Ok(text) if rest.is_empty() => Ok((text.into_bytes(), Encoding::Utf16 { is_big })),
        _ => Err(Fault::whole(ReadProblem::Encoding)),
    }
}

impl Encoding {
    /// Text in UTF-8 as it is in the file.
    pub(super) fn encode(self, text: Vec<u8>) -> Vec<u8> {
        let Self::Utf16 { is_big } = self else {
            return text;
        };
        let text = String::from_utf8_lossy(&text);
        let units = std::iter::once(0xFEFF).chain(text.encode_utf16());
        units
            .flat_map(|unit: u16| match is_big {
                true => unit.to_be_bytes(),
                false => unit.to_le_bytes(),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_in_two_bytes_comes_back_the_same() {
        for is_big in [false, true] {
            let encoding = Encoding::Utf16 { is_big };
            let bytes = encoding.encode("v 0 0 0 # \u{1F40E}\n".into());
            let (text, found) = decode(bytes.clone()).unwrap();
            assert_eq!(
                (text.as_slice(), found),
                ("v 0 0 0 # \u{1F40E}\n".as_bytes(), encoding)
            );
            assert_eq!(encoding.encode(text), bytes);
            let cut = bytes[..bytes.len() - 1].to_vec();
            assert!(decode(cut).is_err());
        }
        assert_eq!(decode(vec![0xFF, 0xFE]).unwrap().1, Encoding::Plain);
    }
}
