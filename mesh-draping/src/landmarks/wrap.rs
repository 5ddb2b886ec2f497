//! Points on triangles as Faceform Wrap saves them: a file for each shape.
//!
//! ```json
//! [[42, 0.3, 0.5], [1337, 0.0, 1.0]]
//! {"nose": [42, 0.3, 0.5], "chin": [1337, 0.0, 1.0]}
//! ```
//! `[t, u, v]` is the place `u A + v B + (1 − u − v) C` of triangle t = ABC, where polygons are cut into fans about their first
//! corner and count in the order of the file. Points without names belong together by their order, others by their names.
//!
//! Source: the documentation of Wrap's node `SavePoints`.

use std::fs;
use std::path::Path;

use mesh_core::{Landmark, LandmarkKind, Location, Point3, PolygonSoup, TriangleBvh};
use serde_json::{json, Map, Value};

use super::entry::{Entry, SourcePlace, TargetPlace};
use super::{Label, LandmarkError, LandmarkPlace, LandmarkProblem};
use crate::{Shape, Source, Target};

const FORM: &str = "a list of [triangle, u, v], or an object of these by name";
const POINT: &str = "[triangle, u, v]: a number from 0, and two weights";

/// The two files of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct WrapPoints<P> {
    /// Points on the source.
    pub source: P,
    /// Points on the target.
    pub target: P,
}

/// A point of a file.
struct Point {
    name: Option<String>,
    triangle: usize,
    weights: [f64; 3],
}

/// Reads landmarks from the point files of source and target.
///
/// # Errors
/// The first thing that is wrong with a file, a triangle that its shape does not have, or files of which no two points belong
/// together.
pub fn read_wrap(
    files: WrapPoints<&Path>,
    source: &Source,
    target: &Target,
) -> Result<Vec<Landmark>, LandmarkError> {
    let of_file = |path: &Path, problem: LandmarkProblem| LandmarkError {
        path: Some(path.to_owned()),
        ..problem.at(LandmarkPlace::File)
    };
    let read = |path: &Path| {
        let text = fs::read_to_string(path).map_err(LandmarkProblem::Io);
        text.and_then(|text| parse(&text))
            .map_err(|problem| of_file(path, problem))
    };
    let (on_source, on_target) = (read(files.source)?, read(files.target)?);
    let pairs = paired(on_source, on_target).map_err(|problem| of_file(files.target, problem))?;
    let fans = Fans::of(source, target);
    let landmark = |(index, pair): (usize, (Point, Point))| {
        let place = LandmarkPlace::Entry(Label::new(index, pair.0.name.as_deref()));
        fans.entry(pair)
            .and_then(|entry| entry.resolve(source, target.vertices()))
            .map_err(|problem| problem.at(place))
    };
    pairs.into_iter().enumerate().map(landmark).collect()
}

/// Landmarks as the texts of two point files: by name where all have one of their own, else lists. These files hold neither
/// weights nor curves: see [`Lost`](super::Lost).
///
/// # Errors
/// A shape without triangles.
pub fn write_wrap(
    landmarks: &[Landmark],
    source: &Source,
    target: &Target,
) -> Result<WrapPoints<String>, LandmarkError> {
    let fans = Fans::of(source, target);
    let rest = source.rest();
    let places = Landmark::marked(landmarks).map(|l| (l.source.position(rest), l.target));
    let (on_source, on_target): (Vec<Point3>, Vec<Point3>) = places.unzip();
    let names = names(landmarks);
    let text = |fan: &Fan, points: &[Point3]| {
        let points = fan.nearest(points);
        points
            .map(|points| told(&points, names.as_deref()))
            .map_err(|problem| problem.at(LandmarkPlace::File))
    };
    Ok(WrapPoints {
        source: text(&fans.source, &on_source)?,
        target: text(&fans.target, &on_target)?,
    })
}

fn parse(text: &str) -> Result<Vec<Point>, LandmarkProblem> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let json: Value =
        serde_json::from_str(text).map_err(|error| LandmarkProblem::NotJson(error.to_string()))?;
    match json {
        Value::Array(list) => list.iter().map(|item| point(None, item)).collect(),
        Value::Object(named) => {
            let points = named.iter();
            points
                .map(|(name, item)| point(Some(name.clone()), item))
                .collect()
        }
        _ => Err(LandmarkProblem::Value {
            key: "the file",
            expected: FORM,
        }),
    }
}

fn point(name: Option<String>, item: &Value) -> Result<Point, LandmarkProblem> {
    let numbers: Option<&[Value; 3]> = item
        .as_array()
        .and_then(|list| list.as_slice().try_into().ok());
    let read = numbers.and_then(|[triangle, u, v]| {
        let row = usize::try_from(triangle.as_u64()?).ok()?;
        Some((row, u.as_f64()?, v.as_f64()?))
    });
    let (triangle, u, v) = read.ok_or(LandmarkProblem::Value {
        key: "a point",
        expected: POINT,
    })?;
    Ok(Point {
        name,
        triangle,
        weights: [u, v, 1.0 - u - v],
    })
}

/// Points that belong together, in the order of the source's.
fn paired(
    on_source: Vec<Point>,
    mut on_target: Vec<Point>,
) -> Result<Vec<(Point, Point)>, LandmarkProblem> {
    let is_named = |points: &[Point]| points.iter().all(|p| p.name.is_some());
    let pairs: Vec<(Point, Point)> = if is_named(&on_source) && is_named(&on_target) {
        let mut partner = |name: &Option<String>| {
            let at = on_target.iter().position(|p| p.name == *name)?;
            Some(on_target.swap_remove(at))
        };
        let both = on_source.into_iter();
        both.filter_map(|p| partner(&p.name).map(|q| (p, q)))
            .collect()
    } else if on_source.len() == on_target.len() {
        on_source.into_iter().zip(on_target).collect()
    } else {
        return Err(LandmarkProblem::PointCounts {
            n_source: on_source.len(),
            n_target: on_target.len(),
        });
    };
    if pairs.is_empty() {
        return Err(LandmarkProblem::Empty);
    }
    Ok(pairs)
}

/// The polygons of both shapes, cut into fans.
struct Fans {
    source: Fan,
    target: Fan,
}

/// Polygons of a file, each cut into a fan about its first corner.
struct Fan {
    shape: Shape,
    soup: PolygonSoup,
    /// Face, and the corners of that face.
    triangles: Vec<(usize, [usize; 3])>,
}

impl Fans {
    fn of(source: &Source, target: &Target) -> Self {
        Self {
            source: Fan::new(Shape::Source, source.soup()),
            target: Fan::new(Shape::Target, target.soup().clone()),
        }
    }

    fn entry(&self, (on_source, on_target): (Point, Point)) -> Result<Entry, LandmarkProblem> {
        let (face, corners) = self.source.triangle(on_source.triangle)?;
        let mut weights = vec![0.0; self.source.soup.faces[face].len()];
        for (corner, weight) in corners.into_iter().zip(on_source.weights) {
            weights[corner] += weight;
        }
        Ok(Entry {
            name: on_source.name,
            source: SourcePlace::Face { face, weights },
            target: TargetPlace::Point(self.target.position(&on_target)?),
            kind: LandmarkKind::Soft,
            weight: 1.0,
        })
    }
}

impl Fan {
    fn new(shape: Shape, soup: PolygonSoup) -> Self {
        let faces = soup.faces.iter().enumerate();
        let triangles = faces
            .flat_map(|(f, face)| (2..face.len()).map(move |k| (f, [0, k - 1, k])))
            .collect();
        Self {
            shape,
            soup,
            triangles,
        }
    }

    fn triangle(&self, triangle: usize) -> Result<(usize, [usize; 3]), LandmarkProblem> {
        let found = self.triangles.get(triangle).copied();
        found.ok_or(LandmarkProblem::NoFanTriangle {
            shape: self.shape,
            triangle,
            n: self.triangles.len(),
        })
    }

    fn corners(&self, (face, corners): (usize, [usize; 3])) -> [Point3; 3] {
        corners.map(|k| self.soup.positions[self.soup.faces[face][k] as usize])
    }

    fn position(&self, point: &Point) -> Result<Point3, LandmarkProblem> {
        let corners = self.corners(self.triangle(point.triangle)?);
        let terms = corners.iter().zip(point.weights);
        Ok(Point3::from(
            terms.map(|(p, w)| p.coords * w).sum::<mesh_core::Vector3>(),
        ))
    }

    /// The nearest places of the fans, as `[t, u, v]`.
    fn nearest(&self, points: &[Point3]) -> Result<Vec<Value>, LandmarkProblem> {
        let triangles = self.triangles.iter().map(|&t| self.corners(t));
        let bvh = TriangleBvh::new(triangles.collect());
        let place = |p: &Point3| match bvh.closest_point(p).map(|hit| hit.location) {
            Some(Location::Triangle {
                index,
                barycentric: [u, v, _],
            }) => Ok(json!([index, u, v])),
            _ => Err(LandmarkProblem::NoFanTriangle {
                shape: self.shape,
                triangle: 0,
                n: 0,
            }),
        };
        points.iter().map(place).collect()
    }
}

/// The names, where all landmarks have one of their own.
fn names(landmarks: &[Landmark]) -> Option<Vec<String>> {
    let names: Option<Vec<String>> = landmarks.iter().map(|l| l.name.clone()).collect();
    let names = names?;
    let mut sorted = names.clone();
    sorted.sort();
    sorted.dedup();
    (sorted.len() == names.len()).then_some(names)
}

fn told(points: &[Value], names: Option<&[String]>) -> String {
    let json = match names {
        Some(names) => {
            let named = names.iter().cloned().zip(points.iter().cloned());
            Value::Object(named.collect::<Map<_, _>>())
        }
        None => json!(points),
    };
    format!("{json:#}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seams;
    use mesh_core::{shapes, MeshPoint, VertexId};

    fn shapes_of(soup: PolygonSoup) -> (Source, Target) {
        let source = Source::of_soup(soup.clone(), Seams::EXACT).unwrap();
        (source, Target::of_soup(soup).unwrap())
    }

    fn read(
        source: &str,
        target: &str,
        shapes: &(Source, Target),
    ) -> Result<Vec<Landmark>, String> {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["a.json", "b.json"].map(|name| folder.path().join(name));
        fs::write(&paths[0], source).unwrap();
        fs::write(&paths[1], target).unwrap();
        let files = WrapPoints {
            source: paths[0].as_path(),
            target: paths[1].as_path(),
        };
        read_wrap(files, &shapes.0, &shapes.1).map_err(|error| error.to_string())
    }

    #[test]
    fn polygons_are_fans_about_their_first_corner() {
        // Corners of the first quad: (0, 0), (1, 0), (1, 1), (0, 1).
        let shapes = shapes_of(shapes::open_grid(2, 2));
        let corner = |t: usize, weights: [f64; 2]| {
            let text = format!("[[{t}, {}, {}]]", weights[0], weights[1]);
            read(&text, &text, &shapes).unwrap()[0].target
        };
        let first = shapes.0.mesh().face_vertices(mesh_core::FaceId::new(0));
        let at = |k: usize| shapes.0.rest()[first[k]];
        assert_eq!(corner(0, [1.0, 0.0]), at(0));
        assert_eq!(corner(0, [0.0, 1.0]), at(1));
        assert_eq!(corner(0, [0.0, 0.0]), at(2));
        assert_eq!(corner(1, [0.0, 1.0]), at(2));
        assert_eq!(corner(1, [0.0, 0.0]), at(3));
    }

    #[test]
    fn what_is_written_is_read_again() {
        for soup in [
            shapes::quad_sphere(3),
            shapes::prism(5),
            shapes::icosphere(1),
        ] {
            let both = shapes_of(soup);
            let triangles = both.0.triangulation().triangles().iter().take(9);
            let landmarks: Vec<Landmark> = triangles
                .enumerate()
                .map(|(k, &t)| Landmark {
                    name: (k < 20).then(|| format!("place {k}")),
                    source: MeshPoint::barycentric(t, [0.5, 0.3, 0.2]),
                    ..Landmark::new(VertexId::new(0), both.1.vertices()[k % 4])
                })
                .collect();
            let written = write_wrap(&landmarks, &both.0, &both.1).unwrap();
            let back = read(&written.source, &written.target, &both).unwrap();
            assert_eq!(back.len(), landmarks.len());
            for b in &back {
                let a = landmarks.iter().find(|a| a.name == b.name).unwrap();
                let rest = both.0.rest();
                let moved = a.source.position(rest) - b.source.position(rest);
                assert!(moved.norm() < 0.1 && (a.target - b.target).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn names_decide_and_mistakes_are_told() {
        let shapes = shapes_of(shapes::icosphere(1));
        let pairs = read(
            r#"{"nose": [0, 1, 0], "chin": [3, 0.2, 0.2]}"#,
            r#"{"ear": [2, 0, 0], "chin": [4, 1, 0]}"#,
            &shapes,
        );
        let pairs = pairs.unwrap();
        assert_eq!(pairs.len(), 1);
        assert_eq!(pairs[0].name.as_deref(), Some("chin"));
        for (source, target, expected) in [
            ("{", "[]", "a.json: is not JSON"),
            ("3", "[]", "a.json: the file must be a list"),
            ("[[0, 1]]", "[]", "a point must be [triangle, u, v]"),
            (
                "[[0, 1, 0]]",
                "[]",
                "1 points on the source but 0 on the target",
            ),
            (
                "[[99999, 1, 0]]",
                "[[0, 1, 0]]",
                "source has no triangle 99999",
            ),
            (
                r#"{"a": [0, 1, 0]}"#,
                r#"{"b": [0, 1, 0]}"#,
                "holds no landmark",
            ),
        ] {
            let told = read(source, target, &shapes).unwrap_err();
            assert!(told.contains(expected), "{told} lacks {expected}");
        }
    }
}
