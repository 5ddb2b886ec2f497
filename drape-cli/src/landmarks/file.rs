//! Landmark files: the JSON form with named places, the plain form of two lists, and lines of numbers.
//!
//! ```json
//! {"landmarks": [{"name": "nose", "source": {"vertex": 12}, "target": {"point": [0.1, 2.0, 0.3]}, "kind": "soft"}]}
//! {"source_vertices": [12], "target_points": [[0.1, 2.0, 0.3]]}
//! ```
//! A source is `{"vertex": v}`, `{"face": f, "barycentric": [..]}` with one weight per corner, or `{"point": [..]}`
//! (the closest place of the source's surface); a target is `{"vertex": v}` or `{"point": [..]}`. All numbers count
//! from 0. Names of the plain form stand one a line in `landmark_names.txt` beside the file.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail, ensure, Context as _};
use mesh_core::{FaceId, Landmark, LandmarkKind, MeshPoint, Point3, Positions, VertexId};
use serde::Deserialize;

use crate::input::Source;

/// How far the weights of a face may be from a sum of 1.
const WEIGHT_TOLERANCE: f64 = 1e-3;

/// The landmarks of a file, their places not yet looked up.
#[derive(Debug)]
pub(crate) struct LandmarkFile {
    path: PathBuf,
    entries: Vec<Entry>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) name: Option<String>,
    pub(super) source: SourcePlace,
    pub(super) target: TargetPlace,
    pub(super) kind: LandmarkKind,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum SourcePlace {
    Vertex(usize),
    Face { face: usize, weights: Vec<f64> },
    Point(Point3),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum TargetPlace {
    Vertex(usize),
    Point(Point3),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonEntry {
    name: Option<String>,
    source: JsonPlace,
    target: JsonPlace,
    #[serde(default)]
    kind: JsonKind,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "lowercase")]
enum JsonKind {
    #[default]
    Soft,
    Rigid,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonPlace {
    vertex: Option<usize>,
    face: Option<usize>,
    barycentric: Option<Vec<f64>>,
    point: Option<[f64; 3]>,
}

/// The two lists of the plain form. Other keys say where the data come from and are passed over.
#[derive(Deserialize)]
struct PlainForm {
    source_vertices: Vec<usize>,
    target_points: Vec<[f64; 3]>,
}

/// Reads a landmark file of any form.
pub(crate) fn read(path: &Path) -> anyhow::Result<LandmarkFile> {
    let text =
        fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    let names = fs::read_to_string(path.with_file_name("landmark_names.txt")).ok();
    let entries = parse(&text, names.as_deref()).with_context(|| path.display().to_string())?;
    Ok(LandmarkFile {
        path: path.to_owned(),
        entries,
    })
}

/// The landmarks in the text of a landmark file, and their names if they stand beside it.
pub(crate) fn from_text(text: &str, names: Option<&str>) -> anyhow::Result<LandmarkFile> {
    Ok(LandmarkFile {
        path: PathBuf::from("landmarks"),
        entries: parse(text, names)?,
    })
}

fn parse(text: &str, names: Option<&str>) -> anyhow::Result<Vec<Entry>> {
    let first = text
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with('#'));
    if first
        .is_some_and(|line| line.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '.'))
    {
        return super::text::parse(text);
    }
    let json: serde_json::Value = serde_json::from_str(text).context("is not JSON")?;
    if let Some(list) = json.get("landmarks") {
        let list = list
            .as_array()
            .ok_or_else(|| anyhow!("\"landmarks\" must be a list"))?;
        return list
            .iter()
            .enumerate()
            .map(|(k, item)| json_entry(k, item))
            .collect();
    }
    ensure!(
        json.get("source_vertices").is_some(),
        "needs \"landmarks\", or \"source_vertices\" and \"target_points\""
    );
    plain_entries(serde_json::from_value(json)?, names)
}

fn json_entry(index: usize, item: &serde_json::Value) -> anyhow::Result<Entry> {
    let place = || format!("landmark {index}");
    let JsonEntry {
        name,
        source,
        target,
        kind,
    } = JsonEntry::deserialize(item).with_context(place)?;
    let named = || label(index, name.as_deref());
    Ok(Entry {
        source: source.into_source().with_context(named)?,
        target: target.into_target().with_context(named)?,
        kind: match kind {
            JsonKind::Soft => LandmarkKind::Soft,
            JsonKind::Rigid => LandmarkKind::Rigid,
        },
        name,
    })
}

impl JsonPlace {
    fn into_source(self) -> anyhow::Result<SourcePlace> {
        match self {
            Self {
                vertex: Some(v),
                face: None,
                barycentric: None,
                point: None,
            } => Ok(SourcePlace::Vertex(v)),
            Self {
                vertex: None,
                face: Some(face),
                barycentric: Some(weights),
                point: None,
            } => Ok(SourcePlace::Face { face, weights }),
            Self {
                vertex: None,
                face: None,
                barycentric: None,
                point: Some(p),
            } => Ok(SourcePlace::Point(p.into())),
            _ => bail!("source needs \"vertex\", or \"face\" and \"barycentric\", or \"point\""),
        }
    }

    fn into_target(self) -> anyhow::Result<TargetPlace> {
        match self {
            Self {
                vertex: Some(v),
                face: None,
                barycentric: None,
                point: None,
            } => Ok(TargetPlace::Vertex(v)),
            Self {
                vertex: None,
                face: None,
                barycentric: None,
                point: Some(p),
            } => Ok(TargetPlace::Point(p.into())),
            _ => bail!("target needs \"vertex\" or \"point\""),
        }
    }
}

fn plain_entries(form: PlainForm, names: Option<&str>) -> anyhow::Result<Vec<Entry>> {
    let PlainForm {
        source_vertices,
        target_points,
    } = form;
    ensure!(
        source_vertices.len() == target_points.len(),
        "{} source_vertices but {} target_points",
        source_vertices.len(),
        target_points.len()
    );
    // Names of another count belong to another file of the folder.
    let names: Vec<&str> = names.map(|text| text.lines().collect()).unwrap_or_default();
    let has_names = names.len() == source_vertices.len();
    let pairs = source_vertices.into_iter().zip(target_points);
    Ok(pairs
        .enumerate()
        .map(|(k, (vertex, point))| Entry {
            name: has_names.then(|| names[k].trim().to_owned()),
            source: SourcePlace::Vertex(vertex),
            target: TargetPlace::Point(point.into()),
            kind: LandmarkKind::Soft,
        })
        .collect())
}

impl LandmarkFile {
    /// Looks the places up on a source and among the vertices of a target.
    pub(crate) fn resolve(
        &self,
        source: &Source,
        target: &[Point3],
    ) -> anyhow::Result<Vec<Landmark>> {
        let landmarks = self.entries.iter().enumerate().map(|(k, entry)| {
            let place = || {
                format!(
                    "{}: {}",
                    self.path.display(),
                    label(k, entry.name.as_deref())
                )
            };
            Ok(Landmark {
                name: entry.name.clone(),
                source: resolve_source(&entry.source, source).with_context(place)?,
                target: resolve_target(&entry.target, target).with_context(place)?,
                kind: entry.kind,
            })
        });
        landmarks.collect()
    }
}

fn resolve_source(place: &SourcePlace, source: &Source) -> anyhow::Result<MeshPoint> {
    let (mesh, rest) = (&source.mesh, &source.rest);
    match place {
        &SourcePlace::Vertex(v) => {
            let vertex = source.vertex_at(v).ok_or_else(|| {
                anyhow!(
                    "source vertex {v} does not exist: the source has {} vertices, counted from 0",
                    source.n_file_vertices()
                )
            })?;
            Ok(MeshPoint::vertex(vertex))
        }
        SourcePlace::Face { face, weights } => {
            ensure!(
                *face < mesh.n_faces(),
                "source face {face} does not exist: the source has {} faces, counted from 0",
                mesh.n_faces()
            );
            let corners = mesh.face_vertices(FaceId::new(*face));
            let point = weighted_point(corners, weights, rest)
                .with_context(|| format!("source face {face}"))?;
            source.closest_place(&point, Some(FaceId::new(*face)))
        }
        SourcePlace::Point(point) => {
            ensure!(is_finite(point), "source point is not finite");
            source.closest_place(point, None)
        }
    }
}

fn weighted_point(
    corners: &[VertexId],
    weights: &[f64],
    rest: &Positions,
) -> anyhow::Result<Point3> {
    ensure!(
        corners.len() == weights.len(),
        "has {} corners, but {} barycentric weights are given",
        corners.len(),
        weights.len()
    );
    let sum: f64 = weights.iter().sum();
    ensure!(
        weights.iter().all(|&w| w >= -WEIGHT_TOLERANCE) && (sum - 1.0).abs() <= WEIGHT_TOLERANCE,
        "barycentric weights must be at least 0 and sum to 1"
    );
    let terms = corners.iter().zip(weights);
    Ok(Point3::from(
        terms
            .map(|(&v, w)| rest[v].coords * (w / sum))
            .sum::<mesh_core::Vector3>(),
    ))
}

fn resolve_target(place: &TargetPlace, target: &[Point3]) -> anyhow::Result<Point3> {
    let point = match place {
        &TargetPlace::Vertex(v) => *target.get(v).ok_or_else(|| {
            anyhow!(
                "target vertex {v} does not exist: the target has {} vertices, counted from 0",
                target.len()
            )
        })?,
        TargetPlace::Point(point) => *point,
    };
    ensure!(is_finite(&point), "target point is not finite");
    Ok(point)
}

fn is_finite(point: &Point3) -> bool {
    point.coords.iter().all(|c| c.is_finite())
}

/// `landmark 3 (nose)`
pub(crate) fn label(index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("landmark {index} ({name})"),
        _ => format!("landmark {index}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seams::Seams;

    fn source() -> Source {
        Source::new(mesh_core::shapes::open_grid(2, 2), Seams::EXACT).unwrap()
    }

    fn resolve(text: &str) -> anyhow::Result<Vec<Landmark>> {
        let file = LandmarkFile {
            path: "lm.json".into(),
            entries: parse(text, None)?,
        };
        file.resolve(&source(), &[Point3::new(5.0, 6.0, 7.0)])
    }

    fn error(text: &str) -> String {
        format!("{:#}", resolve(text).unwrap_err())
    }

    #[test]
    fn every_form_of_place_is_found() {
        let landmarks = resolve(
            r#"{"landmarks": [
                {"name": "nose", "source": {"vertex": 4}, "target": {"vertex": 0}, "kind": "rigid"},
                {"source": {"face": 0, "barycentric": [0.25, 0.25, 0.25, 0.25]}, "target": {"point": [1, 2, 3]}},
                {"source": {"point": [1.5, 0.25, 9]}, "target": {"point": [1, 2, 3]}}]}"#,
        )
        .unwrap();
        let rest = source().rest;
        assert_eq!(landmarks[0].kind, LandmarkKind::Rigid);
        assert_eq!(
            landmarks[0].source.position(&rest),
            Point3::new(1.0, 1.0, 0.0)
        );
        assert_eq!(landmarks[0].target, Point3::new(5.0, 6.0, 7.0));
        assert!((landmarks[1].source.position(&rest) - Point3::new(0.5, 0.5, 0.0)).norm() < 1e-12);
        assert!((landmarks[2].source.position(&rest) - Point3::new(1.5, 0.25, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn the_plain_form_takes_names_of_the_same_count() {
        let text = r#"{"source_vertices": [0, 8], "target_points": [[0,0,0],[1,1,1]], "source": "by hand"}"#;
        assert_eq!(
            parse(text, Some("a\nb\n")).unwrap()[1].name.as_deref(),
            Some("b")
        );
        assert_eq!(parse(text, Some("a\nb\nc\n")).unwrap()[1].name, None);
    }

    #[test]
    fn errors_name_file_and_entry() {
        let at = r#"{"landmarks": [{"name": "nose", "source": {"vertex": 99}, "target": {"point": [0,0,0]}}]}"#;
        assert_eq!(
            error(at),
            "lm.json: landmark 0 (nose): source vertex 99 does not exist: the source has 9 vertices, counted from 0"
        );
        let cases = [
            ("{", "is not JSON"),
            (r#"{"points": []}"#, "needs \"landmarks\""),
            (
                r#"{"landmarks": [{"source": {"vertex": 0}, "target": {"vertex": 4}}]}"#,
                "target vertex 4",
            ),
            (
                r#"{"landmarks": [{"source": {"face": 7, "barycentric": [1]}, "target": {"vertex": 0}}]}"#,
                "face 7",
            ),
            (
                r#"{"landmarks": [{"source": {"face": 0, "barycentric": [1, 0, 0]}, "target": {"vertex": 0}}]}"#,
                "4 corners",
            ),
            (
                r#"{"landmarks": [{"source": {"vertx": 0}, "target": {"vertex": 0}}]}"#,
                "unknown field `vertx`",
            ),
            (
                r#"{"landmarks": [{"source": {"vertex": -1}, "target": {"vertex": 0}}]}"#,
                "landmark 0",
            ),
            (
                r#"{"source_vertices": [0], "target_points": []}"#,
                "1 source_vertices but 0",
            ),
        ];
        for (text, expected) in cases {
            assert!(
                error(text).contains(expected),
                "{} lacks {expected}",
                error(text)
            );
        }
    }
}
