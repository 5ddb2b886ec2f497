//! Where values stand in the text of a JSON document, so that single ones can be replaced. The text is known to be
//! valid JSON: these functions only find their way in it.

use std::ops::Range;

use crate::io::text::Splice;

/// A piece of text and what replaces it.
pub(super) type Edit = (Range<usize>, String);

/// The text with `edits`, which do not overlap.
pub(super) fn edited(json: &[u8], mut edits: Vec<Edit>) -> Vec<u8> {
    edits.sort_by_key(|(span, _)| span.start);
    let mut splice = Splice::new(json);
    for (span, text) in edits {
        splice.replace(span, text.as_bytes());
    }
    splice.finish()
}

/// The values of the array that `array` spans.
pub(super) fn items(json: &[u8], array: Range<usize>) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    let mut at = skip_blanks(json, array.start + 1);
    while at + 1 < array.end {
        let end = value_end(json, at);
        spans.push(at..end);
        at = skip_blanks(json, skip_blanks(json, end) + 1);
    }
    spans
}

/// The keys, with their quotes, and values of the object that `object` spans.
pub(super) fn members(json: &[u8], object: Range<usize>) -> Vec<(Range<usize>, Range<usize>)> {
    let mut members = Vec::new();
    let mut at = skip_blanks(json, object.start + 1);
    while at + 1 < object.end {
        let key_end = value_end(json, at);
        let value = skip_blanks(json, skip_blanks(json, key_end) + 1);
        let end = value_end(json, value);
        members.push((at..key_end, value..end));
        at = skip_blanks(json, skip_blanks(json, end) + 1);
    }
    members
}

/// The value under `key` of the object that `object` spans.
pub(super) fn member(json: &[u8], object: Range<usize>, key: &str) -> Option<Range<usize>> {
    let mut at = skip_blanks(json, object.start + 1);
    while at + 1 < object.end {
        let key_end = value_end(json, at);
        let value = skip_blanks(json, skip_blanks(json, key_end) + 1);
        let end = value_end(json, value);
        if is_key(&json[at..key_end], key) {
            return Some(value..end);
        }
        at = skip_blanks(json, skip_blanks(json, end) + 1);
    }
    None
}

/// Whether a key, with its quotes, says `key`.
fn is_key(json: &[u8], key: &str) -> bool {
    if json.contains(&b'\\') {
        return std::str::from_utf8(json).is_ok_and(|json| text(json) == key);
    }
    json.strip_prefix(b"\"")
        .and_then(|rest| rest.strip_suffix(b"\""))
        == Some(key.as_bytes())
}

/// What a JSON text says; as it stands where it is no text.
pub(super) fn text(json: &str) -> String {
    serde_json::from_str(json).unwrap_or_else(|_| json.trim_matches('"').to_owned())
}

/// The key and value under `key` of the object that `object` spans, with one of the commas beside them.
pub(super) fn entry(json: &[u8], object: Range<usize>, key: &str) -> Option<Range<usize>> {
    let value = member(json, object.clone(), key)?;
    let mut before = None;
    let mut at = skip_blanks(json, object.start + 1);
    loop {
        let end = value_end(
            json,
            skip_blanks(json, skip_blanks(json, value_end(json, at)) + 1),
        );
        let next = skip_blanks(json, end);
        if end == value.end {
            let is_last = json.get(next) != Some(&b',');
            return Some(match before {
                _ if !is_last => at..skip_blanks(json, next + 1),
                Some(before) => before..end,
                None => at..end,
            });
        }
        before = Some(end);
        at = skip_blanks(json, next + 1);
    }
}

/// The document's own value.
pub(super) fn root(json: &[u8]) -> Range<usize> {
    let start = skip_blanks(json, 0);
    start..value_end(json, start)
}

fn skip_blanks(json: &[u8], at: usize) -> usize {
    let rest = json.get(at..).unwrap_or_default();
    at + rest.iter().take_while(|b| b.is_ascii_whitespace()).count()
}

/// The end of the value that starts at `at`; always beyond `at`.
fn value_end(json: &[u8], at: usize) -> usize {
    let mut depth = 0usize;
    let mut k = at;
    while let Some(&byte) = json.get(k) {
        match byte {
            b'"' => k = string_end(json, k),
            b'[' | b'{' => {
                depth += 1;
                k += 1;
            }
            b']' | b'}' if depth > 0 => {
                depth -= 1;
                k += 1;
            }
            b',' | b':' | b']' | b'}' | b' ' | b'\t' | b'\r' | b'\n' if depth == 0 => break,
            _ => {
                k += 1;
                continue;
            }
        }
        if depth == 0 {
            break;
        }
    }
    k.max(at + 1)
}

fn string_end(json: &[u8], at: usize) -> usize {
    let mut k = at + 1;
    while let Some(&byte) = json.get(k) {
        match byte {
            b'"' => return k + 1,
            b'\\' => k += 2,
            _ => k += 1,
        }
    }
    json.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_goes_with_one_comma() {
        let json = br#"{ "a": 1, "b" : [2] ,"c":{}  }"#;
        let without = |key: &str| {
            let span = entry(json, root(json), key).unwrap();
            String::from_utf8([&json[..span.start], &json[span.end..]].concat()).unwrap()
        };
        assert_eq!(without("a"), r#"{ "b" : [2] ,"c":{}  }"#);
        assert_eq!(without("b"), r#"{ "a": 1, "c":{}  }"#);
        assert_eq!(without("c"), r#"{ "a": 1, "b" : [2]  }"#);
        assert_eq!(entry(json, root(json), "d"), None);
        assert_eq!(entry(br#"{"a":1}"#, 0..7, "a"), Some(1..6));
    }

    #[test]
    fn values_are_found_among_strings_and_brackets() {
        let json =
            br#" { "a,\"]": [1, {"b": "}"}, [2,3 ] , "x" ], "c" :-1.5e3 , "d":{"min" : [ ] } } "#;
        let text = |span: Range<usize>| std::str::from_utf8(&json[span]).unwrap().to_owned();
        let all = root(json);
        assert_eq!(text(member(json, all.clone(), "c").unwrap()), "-1.5e3");
        let d = member(json, all.clone(), "d").unwrap();
        let min = member(json, d, "min").unwrap();
        assert_eq!(
            (text(min.clone()), items(json, min).len()),
            ("[ ]".to_owned(), 0)
        );
        assert_eq!(member(json, all.clone(), "b"), None);
        let a = member(json, all, "a,\"]").unwrap();
        let values: Vec<String> = items(json, a).into_iter().map(text).collect();
        assert_eq!(values, ["1", r#"{"b": "}"}"#, "[2,3 ]", r#""x""#]);
    }
}
