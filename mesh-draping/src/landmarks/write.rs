//! Landmarks written in any form.

use std::fmt::{self, Write as _};

use mesh_core::{Curve, Landmark, LandmarkKind, MeshPoint, Point3};
use serde_json::{json, Value};

use crate::{Source, Target};

/// A form that landmarks are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// JSON with names, places in faces, kinds, weights and curves: nothing is lost.
    Json,
    /// JSON of two lists, `source_vertices` and `target_points`, and `weights` where any is not 1.
    Lists,
    /// Lines of source vertex, target x y z, name.
    Text,
    /// Lines of source vertex, target vertex, name.
    Ids,
    /// Lines of source x y z, target x y z, name.
    Points,
}

/// Landmarks as the text of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenLandmarks {
    /// The text.
    pub text: String,
    /// How far the farthest place had to move to the nearest vertex, in units of its file: forms of vertices hold no
    /// other place.
    pub moved: f64,
    /// What the form cannot hold.
    pub lost: Vec<Lost>,
}

/// What a form of landmark file cannot hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lost {
    /// Weights other than 1.
    Weights {
        /// Of how many landmarks.
        n: usize,
    },
    /// Curves.
    Curves {
        /// How many.
        n: usize,
    },
}

impl Lost {
    /// What of landmarks is lost in a form that holds neither weights nor curves.
    pub fn without_both(landmarks: &[Landmark]) -> Vec<Self> {
        let n = Landmark::marked(landmarks)
            .filter(|l| l.weight != 1.0)
            .count();
        let weights = (n > 0).then_some(Self::Weights { n });
        weights
            .into_iter()
            .chain(Self::without_curves(landmarks))
            .collect()
    }

    /// The same in one that does hold weights.
    fn without_curves(landmarks: &[Landmark]) -> Option<Self> {
        let n = Curve::runs(landmarks).count();
        (n > 0).then_some(Self::Curves { n })
    }
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Weights { n: 1 } => f.write_str("the weight of 1 landmark is left out"),
            Self::Weights { n } => write!(f, "the weights of {n} landmarks are left out"),
            Self::Curves { n: 1 } => f.write_str("1 curve is left out"),
            Self::Curves { n } => write!(f, "{n} curves are left out"),
        }
    }
}

/// The text of a landmark file. Rows are those of the files of source and target.
///
/// ```
/// use mesh_core::{shapes, Landmark, Point3, VertexId};
/// use mesh_draping::landmarks::{parse, write, Form};
/// use mesh_draping::{Seams, Source, Target};
/// let source = Source::of_soup(shapes::quad_sphere(2), Seams::EXACT)?;
/// let target = Target::of_soup(shapes::icosphere(1))?;
/// let landmarks = [Landmark::new(VertexId::new(3), Point3::new(0.0, 0.0, 1.0))];
/// let written = write(&landmarks, &source, &target, Form::Json);
/// assert_eq!(parse(&written.text, None, &source, target.vertices())?, landmarks);
/// # Ok::<(), mesh_draping::Error>(())
/// ```
pub fn write(
    landmarks: &[Landmark],
    source: &Source,
    target: &Target,
    form: Form,
) -> WrittenLandmarks {
    let mut moved = 0.0f64;
    let mut source_vertex = |l: &Landmark| {
        let v = l.source.main_vertex();
        let rest = source.rest();
        moved = moved.max((rest[v] - l.source.position(rest)).norm());
        source.file_row(v)
    };
    let marked = Landmark::marked(landmarks);
    let text = match form {
        Form::Json => {
            let curves = Curve::runs(landmarks).map(|(curve, _)| curve_entry(curve, source));
            let entries = marked.map(|l| entry(l, source)).chain(curves);
            let entries: Vec<Value> = entries.collect();
            format!("{:#}\n", json!({ "landmarks": entries }))
        }
        Form::Lists => {
            let vertices: Vec<usize> = marked.clone().map(&mut source_vertex).collect();
            let points: Vec<[f64; 3]> = marked.clone().map(|l| l.target.coords.into()).collect();
            let mut lists = json!({ "source_vertices": vertices, "target_points": points });
            if marked.clone().any(|l| l.weight != 1.0) {
                lists["weights"] = marked.map(|l| l.weight).collect();
            }
            format!("{lists:#}\n")
        }
        Form::Text => lines(marked, |l| {
            format!("{} {}", source_vertex(l), numbers(&l.target))
        }),
        Form::Ids => {
            let mut farthest = 0.0f64;
            let text = lines(marked, |l| {
                let (row, distance) = nearest(target.vertices(), &l.target);
                farthest = farthest.max(distance);
                format!("{} {row}", source_vertex(l))
            });
            moved = moved.max(farthest);
            text
        }
        Form::Points => lines(marked, |l| {
            let from = l.source.position(source.rest());
            format!("{} {}", numbers(&from), numbers(&l.target))
        }),
    };
    let lost = match form {
        Form::Json => Vec::new(),
        Form::Lists => Lost::without_curves(landmarks).into_iter().collect(),
        Form::Text | Form::Ids | Form::Points => Lost::without_both(landmarks),
    };
    WrittenLandmarks { text, moved, lost }
}

fn entry(l: &Landmark, source: &Source) -> Value {
    let target: [f64; 3] = l.target.coords.into();
    let mut entry = json!({ "source": place(&l.source, source), "target": { "point": target } });
    if let Some(name) = &l.name {
        entry["name"] = json!(name);
    }
    if l.kind == LandmarkKind::Rigid {
        entry["kind"] = json!("rigid");
    }
    if l.weight != 1.0 {
        entry["weight"] = json!(l.weight);
    }
    entry
}

fn curve_entry(curve: &Curve, source: &Source) -> Value {
    let on_source: Vec<Value> = curve.source.iter().map(|at| place(at, source)).collect();
    let on_target: Vec<[f64; 3]> = curve.target.iter().map(|p| p.coords.into()).collect();
    let mut entry = json!({ "curve": { "source": on_source, "target": on_target } });
    if let Some(name) = &curve.name {
        entry["name"] = json!(name);
    }
    if curve.weight != 1.0 {
        entry["weight"] = json!(curve.weight);
    }
    entry
}

/// A vertex where the place is one, else a face and a weight for each of its corners.
fn place(at: &MeshPoint, source: &Source) -> Value {
    let (vertex, point) = (at.main_vertex(), at.position(source.rest()));
    if point == source.rest()[vertex] {
        return json!({ "vertex": source.file_row(vertex) });
    }
    let triangulation = source.triangulation();
    let row = triangulation
        .triangles()
        .iter()
        .position(|t| *t == at.vertices);
    let Some(face) = row.map(|row| triangulation.parent(row)) else {
        return json!({ "point": [point.x, point.y, point.z] });
    };
    let weight_of = |v| {
        let shares = at.vertices.iter().zip(at.weights);
        shares.filter(|(u, _)| **u == v).map(|(_, w)| w).sum()
    };
    let corners = source.mesh().face_vertices(face).iter();
    let weights: Vec<f64> = corners.map(|&v| weight_of(v)).collect();
    json!({ "face": face.index(), "barycentric": weights })
}

fn lines<'l>(
    landmarks: impl Iterator<Item = &'l Landmark>,
    mut places: impl FnMut(&Landmark) -> String,
) -> String {
    let mut text = String::new();
    for l in landmarks {
        let name = l.name.as_deref().unwrap_or_default();
        let line = format!("{} {name}", places(l));
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

fn numbers(p: &Point3) -> String {
    format!("{} {} {}", p.x, p.y, p.z)
}

/// The row of the nearest point, the lowest among equals, and its distance.
fn nearest(points: &[Point3], p: &Point3) -> (usize, f64) {
    let distances = points.iter().map(|q| (q - p).norm()).enumerate();
    distances
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0, f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;
    use crate::Seams;
    use mesh_core::{shapes, VertexId};

    fn shapes_of(soup: &mesh_core::PolygonSoup) -> (Source, Target) {
        let mut larger = soup.clone();
        larger.positions.iter_mut().for_each(|p| *p *= 2.0);
        (
            Source::of_soup(soup.clone(), Seams::EXACT).unwrap(),
            Target::of_soup(larger).unwrap(),
        )
    }

    #[test]
    fn every_form_comes_back() {
        let (source, target) = shapes_of(&shapes::tetrahedron());
        let mut landmark = Landmark::new(VertexId::new(2), target.vertices()[2]);
        landmark.name = Some("left ear".to_owned());
        for form in [Form::Json, Form::Text, Form::Ids, Form::Points] {
            let list = std::slice::from_ref(&landmark);
            let written = write(list, &source, &target, form);
            assert_eq!(written.moved, 0.0);
            let back = parse(&written.text, None, &source, target.vertices()).unwrap();
            assert_eq!(back[0].name, landmark.name, "{form:?}");
            assert_eq!(back[0].target, landmark.target, "{form:?}");
        }
    }

    #[test]
    fn weights_and_curves_come_back_or_are_told_as_lost() {
        let (source, target) = shapes_of(&shapes::quad_sphere(6));
        let text = r#"{"landmarks": [
            {"source": {"vertex": 3}, "target": {"vertex": 3}, "weight": 0.5},
            {"name": "brow", "weight": 2.5, "curve": {
                "source": [0, {"face": 7, "barycentric": [0.4, 0.3, 0.2, 0.1]}, [0.1, 0.2, 1.0]],
                "target": [0, [0.5, 0.5, 2.0], {"vertex": 9}]}},
            {"source": {"vertex": 5}, "target": {"vertex": 5}}]}"#;
        let read = |text: &str| parse(text, None, &source, target.vertices()).unwrap();
        let landmarks = read(text);
        assert_eq!(Landmark::marked(&landmarks).count(), 2);
        let json = write(&landmarks, &source, &target, Form::Json);
        assert_eq!(
            (read(&json.text), json.lost),
            (landmarks.clone(), Vec::new())
        );
        let lists = write(&landmarks, &source, &target, Form::Lists);
        assert_eq!(
            read(&lists.text)
                .iter()
                .map(|l| l.weight)
                .collect::<Vec<_>>(),
            [0.5, 1.0]
        );
        assert_eq!(lists.lost, [Lost::Curves { n: 1 }]);
        let lines = write(&landmarks, &source, &target, Form::Text);
        assert_eq!(read(&lines.text).len(), 2);
        assert_eq!(lines.lost, [Lost::Weights { n: 1 }, Lost::Curves { n: 1 }]);
    }

    #[test]
    fn places_in_faces_come_back_to_the_bit() {
        for soup in [
            shapes::quad_sphere(3),
            shapes::prism(5),
            shapes::icosphere(1),
        ] {
            let (source, target) = shapes_of(&soup);
            let triangles = source.triangulation().triangles();
            let landmarks: Vec<Landmark> = triangles
                .iter()
                .map(|&t| Landmark {
                    source: MeshPoint::barycentric(t, [0.5, 0.3, 0.2]),
                    ..Landmark::new(t[0], Point3::new(0.1, 0.2, 0.3))
                })
                .collect();
            let written = write(&landmarks, &source, &target, Form::Json);
            let back = parse(&written.text, None, &source, target.vertices()).unwrap();
            for (a, b) in landmarks.iter().zip(&back) {
                let rest = source.rest();
                assert_eq!(a.source.position(rest), b.source.position(rest));
            }
        }
    }
}
