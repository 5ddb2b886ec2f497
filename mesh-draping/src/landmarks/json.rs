//! Landmarks in JSON: the form with named places, and the form of two lists.
//!
//! ```json
//! {"landmarks": [{"name": "nose", "source": {"vertex": 12}, "target": {"point": [0.1, 2.0, 0.3]}, "kind": "soft"}]}
//! {"landmarks": [{"name": "lips", "curve": {"source": [7, 8, 12], "target": [[0.1, 1.8, 0.3], [0.2, 1.8, 0.3]]}}]}
//! {"source_vertices": [12], "target_points": [[0.1, 2.0, 0.3]], "weights": [0.5]}
//! ```
//! A source is `{"vertex": v}`, `{"face": f, "barycentric": [..]}` with one weight per corner, or `{"point": [..]}`
//! (the closest place of the source's surface); a target is `{"vertex": v}` or `{"point": [..]}`. All numbers count
//! from 0. A `weight` from 0 to 100 says what a landmark counts; it is 1 where it is not given. A curve has two places and more
//! on either shape, in order; there a number alone is a vertex, and three in a list are a point. A landmark that a detector
//! found may say its `confidence`, which is not read.

use mesh_core::{LandmarkKind, Point3};
use serde_json::{Map, Value};

use super::entry::{CurveEntry, Entries, Entry, SourcePlace, TargetPlace};
use super::{Label, LandmarkError, LandmarkPlace, LandmarkProblem, MAX_WEIGHT};
use crate::Shape;

const ROW: &str = "the number of a row: a whole number from 0";
const POINT: &str = "a list of three numbers";
const CURVE: &str = "an object of two lists of places, \"source\" and \"target\"";
const SOURCE_FORMS: &str = "\"vertex\", or \"face\" and \"barycentric\", or \"point\"";
const TARGET_FORMS: &str = "\"vertex\" or \"point\"";

type Object = Map<String, Value>;

/// The entries of a JSON text; `names` has a name per line, for the form of two lists.
pub(super) fn parse(text: &str, names: Option<&str>) -> Result<Entries, LandmarkError> {
    let whole = |problem: LandmarkProblem| problem.at(LandmarkPlace::File);
    let json: Value = serde_json::from_str(text)
        .map_err(|error| whole(LandmarkProblem::NotJson(error.to_string())))?;
    match json.get("landmarks") {
        Some(Value::Array(list)) => entries(list),
        Some(_) => Err(whole(wrong("\"landmarks\"", "a list"))),
        None => Ok(Entries::of(lists(&json, names).map_err(whole)?)),
    }
}

fn wrong(key: &'static str, expected: &'static str) -> LandmarkProblem {
    LandmarkProblem::Value { key, expected }
}

/// Landmarks and curves, each numbered among its kind.
fn entries(list: &[Value]) -> Result<Entries, LandmarkError> {
    let mut entries = Entries::default();
    for item in list {
        let name = item.get("name").and_then(Value::as_str);
        if item.get("curve").is_some() {
            let label = Label::of_curve(entries.curves.len(), name);
            let curve = read_curve(item);
            let curve = curve.map_err(|problem| problem.at(LandmarkPlace::Entry(label)));
            entries.curves.push(curve?);
        } else {
            let label = Label::new(entries.landmarks.len(), name);
            let entry = read_entry(item);
            let entry = entry.map_err(|problem| problem.at(LandmarkPlace::Entry(label)));
            entries.landmarks.push(entry?);
        }
    }
    Ok(entries)
}

fn name(item: &Object) -> Result<Option<String>, LandmarkProblem> {
    match item.get("name") {
        None | Some(Value::Null) => Ok(None),
        Some(Value::String(name)) => Ok(Some(name.clone())),
        Some(_) => Err(wrong("name", "text")),
    }
}

fn weight(value: Option<&Value>) -> Result<f64, LandmarkProblem> {
    match value {
        None | Some(Value::Null) => Ok(1.0),
        Some(value) => {
            let weight = value.as_f64().filter(|w| (0.0..=MAX_WEIGHT).contains(w));
            weight.ok_or(LandmarkProblem::Weight { most: MAX_WEIGHT })
        }
    }
}

fn read_curve(item: &Value) -> Result<CurveEntry, LandmarkProblem> {
    let item = object(item, "a curve", "name, curve, weight")?;
    let curve = item.get("curve").ok_or(wrong("curve", CURVE))?;
    let curve = object(curve, "curve", "source, target")?;
    let list = |key| {
        let list = curve.get(key).and_then(Value::as_array);
        list.ok_or(wrong("curve", CURVE))
    };
    let source = list("source")?.iter().map(|value| match value {
        Value::Number(_) => Ok(SourcePlace::Vertex(row("vertex", value)?)),
        Value::Array(_) => Ok(SourcePlace::Point(point("point", value)?)),
        _ => source_place(value),
    });
    let target = list("target")?.iter().map(|value| match value {
        Value::Number(_) => Ok(TargetPlace::Vertex(row("vertex", value)?)),
        Value::Array(_) => Ok(TargetPlace::Point(point("point", value)?)),
        _ => target_place(value),
    });
    Ok(CurveEntry {
        name: name(item)?,
        source: source.collect::<Result<_, _>>()?,
        target: target.collect::<Result<_, _>>()?,
        weight: weight(item.get("weight"))?,
    })
}

fn read_entry(item: &Value) -> Result<Entry, LandmarkProblem> {
    let item = object(
        item,
        "a landmark",
        "name, source, target, kind, weight, confidence",
    )?;
    let needed = |key: &str, shape, forms| {
        let place = item.get(key);
        place.ok_or(LandmarkProblem::Place { shape, forms })
    };
    Ok(Entry {
        name: name(item)?,
        weight: weight(item.get("weight"))?,
        source: source_place(needed("source", Shape::Source, SOURCE_FORMS)?)?,
        target: target_place(needed("target", Shape::Target, TARGET_FORMS)?)?,
        kind: match item.get("kind").map(Value::as_str) {
            None | Some(Some("soft")) => LandmarkKind::Soft,
            Some(Some("rigid")) => LandmarkKind::Rigid,
            Some(_) => return Err(wrong("kind", "\"soft\" or \"rigid\"")),
        },
    })
}

/// An object that has none but the known keys.
fn object<'v>(
    value: &'v Value,
    key: &'static str,
    known: &'static str,
) -> Result<&'v Object, LandmarkProblem> {
    let object = value.as_object().ok_or(wrong(key, "an object"))?;
    match object
        .keys()
        .find(|key| !known.split(", ").any(|known| known == *key))
    {
        Some(key) => Err(LandmarkProblem::UnknownKey {
            key: key.clone(),
            known,
        }),
        None => Ok(object),
    }
}

fn source_place(value: &Value) -> Result<SourcePlace, LandmarkProblem> {
    let place = object(value, "source", "vertex, face, barycentric, point")?;
    let part = |key: &str| place.get(key).filter(|value| !value.is_null());
    match ["vertex", "face", "barycentric", "point"].map(part) {
        [Some(v), None, None, None] => Ok(SourcePlace::Vertex(row("vertex", v)?)),
        [None, Some(face), Some(weights), None] => Ok(SourcePlace::Face {
            face: row("face", face)?,
            weights: numbers(weights).ok_or(wrong("barycentric", "a list of numbers"))?,
        }),
        [None, None, None, Some(p)] => Ok(SourcePlace::Point(point("point", p)?)),
        _ => Err(LandmarkProblem::Place {
            shape: Shape::Source,
            forms: SOURCE_FORMS,
        }),
    }
}

fn target_place(value: &Value) -> Result<TargetPlace, LandmarkProblem> {
    let place = object(value, "target", "vertex, point")?;
    let part = |key: &str| place.get(key).filter(|value| !value.is_null());
    match ["vertex", "point"].map(part) {
        [Some(v), None] => Ok(TargetPlace::Vertex(row("vertex", v)?)),
        [None, Some(p)] => Ok(TargetPlace::Point(point("point", p)?)),
        _ => Err(LandmarkProblem::Place {
            shape: Shape::Target,
            forms: TARGET_FORMS,
        }),
    }
}

fn row(key: &'static str, value: &Value) -> Result<usize, LandmarkProblem> {
    let row = value.as_u64().and_then(|row| usize::try_from(row).ok());
    row.ok_or(wrong(key, ROW))
}

fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

fn point(key: &'static str, value: &Value) -> Result<Point3, LandmarkProblem> {
    match numbers(value).as_deref() {
        Some(&[x, y, z]) => Ok(Point3::new(x, y, z)),
        _ => Err(wrong(key, POINT)),
    }
}

/// The two lists. Other keys say where the data come from and are passed over.
fn lists(json: &Value, names: Option<&str>) -> Result<Vec<Entry>, LandmarkProblem> {
    let list = |key: &str| json.get(key).and_then(Value::as_array);
    let (Some(vertices), Some(points)) = (list("source_vertices"), list("target_points")) else {
        return Err(LandmarkProblem::NoLists);
    };
    if vertices.len() != points.len() {
        return Err(LandmarkProblem::ListLengths {
            n_vertices: vertices.len(),
            n_points: points.len(),
        });
    }
    let weights = json.get("weights").map(|weights| {
        let weights = weights.as_array().filter(|w| w.len() == points.len());
        weights.ok_or(wrong("weights", "a list of one number for each landmark"))
    });
    let weights = weights.transpose()?;
    // Names of another count belong to another file of the folder.
    let names: Vec<&str> = names.map(|text| text.lines().collect()).unwrap_or_default();
    let has_names = names.len() == vertices.len();
    let pairs = vertices.iter().zip(points).enumerate();
    pairs
        .map(|(k, (vertex, target))| {
            Ok(Entry {
                name: has_names.then(|| names[k].trim().to_owned()),
                source: SourcePlace::Vertex(row("source_vertices", vertex)?),
                target: TargetPlace::Point(point("target_points", target)?),
                kind: LandmarkKind::Soft,
                weight: weight(weights.map(|weights| &weights[k]))?,
            })
        })
        .collect()
}
