//! The values of a JSON document and where they stand, told by element and row where one is not as it should be.
//! A number is whole where its value is: `8.0` is eight.

use std::collections::HashMap;
use std::ops::Range;

use serde::de::IgnoredAny;

use super::json_spans::{items, members, root, text};
use crate::io::error::{Place, ReadProblem};
use crate::io::fault::{excerpt, Fault};

const ONCE: &str = "each key once in an object";

/// An object of the document.
pub(super) struct Object<'a> {
    json: &'a str,
    members: Vec<(String, Range<usize>)>,
    place: Place,
}

/// The outermost object of the text `json`.
pub(super) fn document(json: &[u8]) -> Result<Object<'_>, Fault> {
    let broken = |text: String| Fault::whole(ReadProblem::Json(text));
    let json = std::str::from_utf8(json).map_err(|e| broken(e.to_string()))?;
    serde_json::from_str::<IgnoredAny>(json).map_err(|e| broken(e.to_string()))?;
    Object::at(json, root(json.as_bytes()), Place::File)
}

impl<'a> Object<'a> {
    fn at(json: &'a str, span: Range<usize>, place: Place) -> Result<Self, Fault> {
        if !json[span.clone()].starts_with('{') {
            return Err(unexpected(place, "an object", &json[span]));
        }
        let spans = members(json.as_bytes(), span);
        let members = spans
            .into_iter()
            .map(|(key, value)| (text(&json[key]), value));
        Ok(Self {
            json,
            members: members.collect(),
            place,
        })
    }

    /// A fault in this object: `expected` was, `found` is.
    pub(super) fn unexpected(&self, expected: &'static str, found: &str) -> Fault {
        unexpected(self.place.clone(), expected, found)
    }

    /// The text of the value under `key`; none where there is none, or null.
    fn value(&self, key: &str) -> Result<Option<Range<usize>>, Fault> {
        let mut values = self.members.iter().filter(|(name, _)| name == key);
        let first = values.next().map(|(_, value)| value.clone());
        if values.next().is_some() {
            return Err(self.unexpected(ONCE, key));
        }
        Ok(first.filter(|value| &self.json[value.clone()] != "null"))
    }

    fn read<T>(
        &self,
        key: &str,
        expected: &'static str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<T>, Fault> {
        let Some(value) = self.value(key)? else {
            return Ok(None);
        };
        let value = &self.json[value];
        match parse(value) {
            None => Err(self.unexpected(expected, value)),
            found => Ok(found),
        }
    }

    /// The whole number under `key`, not negative.
    pub(super) fn count(&self, key: &str) -> Result<Option<usize>, Fault> {
        self.read(key, "a whole number", whole)
    }

    /// The text under `key`.
    pub(super) fn text(&self, key: &str) -> Result<Option<String>, Fault> {
        let is_text = |value: &str| value.starts_with('"').then(|| text(value));
        self.read(key, "a text", is_text)
    }

    /// Whether `true` stands under `key`.
    pub(super) fn flag(&self, key: &str) -> Result<bool, Fault> {
        let flag = self.read(key, "true or false", |value| value.parse().ok())?;
        Ok(flag.unwrap_or(false))
    }

    /// The `N` numbers under `key`, in single precision.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f32; N]>, Fault> {
        let Some(values) = self.items(key)? else {
            return Ok(None);
        };
        let numbers: Option<Vec<f32>> = values.iter().map(|v| v.parse().ok()).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        let expected = "a list of as many numbers as a transform has";
        numbers
            .map(Some)
            .ok_or_else(|| self.unexpected(expected, key))
    }

    /// The whole numbers in the list under `key`; none in the list where there is no list.
    pub(super) fn counts(&self, key: &str) -> Result<Vec<usize>, Fault> {
        let values = self.items(key)?.unwrap_or_default().into_iter();
        let count = |v: &str| whole(v).ok_or_else(|| self.unexpected("a whole number", v));
        values.map(count).collect()
    }

    /// The texts in the list under `key`.
    pub(super) fn texts(&self, key: &str) -> Result<Vec<String>, Fault> {
        let values = self.items(key)?.unwrap_or_default();
        Ok(values.into_iter().map(text).collect())
    }

    /// The object under `key`.
    pub(super) fn object(&self, key: &str) -> Result<Option<Self>, Fault> {
        let value = self.value(key)?;
        let object = |value| Self::at(self.json, value, self.place.clone());
        value.map(object).transpose()
    }

    /// The objects in the list under `key`, each called `element`; rows of an inner list keep the place of the outer.
    pub(super) fn objects(&self, key: &str, element: Option<&str>) -> Result<Vec<Self>, Fault> {
        let spans = self.spans(key)?.unwrap_or_default().into_iter();
        let object = |(row, span)| {
            let named = element.map(|element| Place::Row {
                element: element.to_owned(),
                row,
            });
            Self::at(self.json, span, named.unwrap_or_else(|| self.place.clone()))
        };
        spans.enumerate().map(object).collect()
    }

    /// The keys and whole numbers of this object.
    pub(super) fn counts_by_key(&self) -> Result<HashMap<String, usize>, Fault> {
        let mut counts = HashMap::with_capacity(self.members.len());
        for (key, value) in &self.members {
            let value = &self.json[value.clone()];
            let count = whole(value).ok_or_else(|| self.unexpected("a whole number", value))?;
            if counts.insert(key.clone(), count).is_some() {
                return Err(self.unexpected(ONCE, key));
            }
        }
        Ok(counts)
    }

    fn spans(&self, key: &str) -> Result<Option<Vec<Range<usize>>>, Fault> {
        let Some(value) = self.value(key)? else {
            return Ok(None);
        };
        if !self.json[value.clone()].starts_with('[') {
            return Err(self.unexpected("a list", &self.json[value]));
        }
        Ok(Some(items(self.json.as_bytes(), value)))
    }

    fn items(&self, key: &str) -> Result<Option<Vec<&'a str>>, Fault> {
        let texts = |spans: Vec<Range<usize>>| spans.into_iter().map(|span| &self.json[span]);
        Ok(self.spans(key)?.map(|spans| texts(spans).collect()))
    }
}

fn unexpected(place: Place, expected: &'static str, found: &str) -> Fault {
    let text = excerpt(found.as_bytes());
    Fault {
        place,
        problem: ReadProblem::Unexpected { expected, text },
    }
}

/// The whole number that a text like `8`, `8.0` or `8e0` is.
fn whole(value: &str) -> Option<usize> {
    value.parse().ok().or_else(|| {
        let number: f64 = value.parse().ok()?;
        let is_whole = (0.0..=9e15).contains(&number) && number.fract() == 0.0;
        is_whole.then_some(number as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_what_they_mean() {
        let json = r#"{"a": 8.0, "b": 1e1, "\u0063": "x\u0021", "d": [1, 2.0], "e": null, "f": {"g": true}, "h": [{}]}"#;
        let object = document(json.as_bytes()).unwrap();
        assert_eq!(object.count("a").unwrap(), Some(8));
        assert_eq!(object.count("b").unwrap(), Some(10));
        assert_eq!(object.text("c").unwrap().as_deref(), Some("x!"));
        assert_eq!(object.counts("d").unwrap(), [1, 2]);
        assert_eq!(object.numbers("d").unwrap(), Some([1.0, 2.0]));
        assert_eq!(object.count("e").unwrap(), None);
        let inner = object.object("f").unwrap().unwrap();
        assert!(inner.flag("g").unwrap() && !inner.flag("h").unwrap());
        assert_eq!(object.objects("h", Some("thing")).unwrap().len(), 1);
    }

    #[test]
    fn what_is_not_as_it_should_be_is_told_by_place() {
        let json = r#"{"a": [{"b": 1.5}, {"b": -1}, {"b": "x"}, {"b": 1, "b": 2}], "c": 3}"#;
        let object = document(json.as_bytes()).unwrap();
        let rows = object.objects("a", Some("thing")).unwrap();
        for (row, found) in ["1.5", "-1", "\"x\"", "b"].iter().enumerate() {
            let fault = rows[row].count("b").unwrap_err();
            let element = "thing".to_owned();
            assert_eq!(fault.place, Place::Row { element, row });
            let message = fault.problem.to_string();
            assert!(message.ends_with(&format!("found `{found}`")), "{message}");
        }
        assert!(object.objects("c", None).is_err() && object.object("a").is_err());
        assert!(document(b"{\"a\": 1,}").is_err() && document(b"[]").is_err());
        assert!(document(b"{\"\xFF\": 1}").is_err());
    }
}
