//! Landmarks: read and written in every form, looked at, mirrored, and where one more would help.
//!
//! | to | call |
//! |---|---|
//! | read a landmark file of any form | [`read`], [`parse`] |
//! | write one | [`write()`] |
//! | read and write the two point files of Faceform Wrap | [`read_wrap`], [`write_wrap`] |
//! | cut a curve into landmarks | [`cut`] |
//! | find what is probably wrong | [`Pair::findings`](crate::Pair::findings), [`leave_one_out_residuals`] |
//! | mark the other half of a symmetric source | [`mirror()`]; for one landmark, [`counterpart()`] |
//! | find how symmetric a shape is | [`source_symmetry()`], [`target_symmetry()`] |
//! | find where one more would help most | [`suggest()`] |

mod curve;
mod doctor;
mod entry;
mod error;
mod finding;
mod json;
mod label;
mod lines;
mod mirror;
mod suggest;
mod ways;
mod wrap;
mod write;

pub use curve::cut;
pub use doctor::leave_one_out_residuals;
pub use error::{LandmarkError, LandmarkPlace, LandmarkProblem};
pub use finding::{Finding, Shared};
pub use label::{Label, Labelled};
pub use mirror::{
    counterpart, mirror, source_symmetry, target_symmetry, MirrorError, MirrorPlanes, Mirrored,
    Plane, Symmetry,
};
pub use suggest::{suggest, Suggestion};
pub use wrap::{read_wrap, write_wrap, WrapPoints};
pub use write::{write, Form, Lost, WrittenLandmarks};

pub(crate) use doctor::examine;
pub(crate) use mirror::symmetry_plane;

use std::fs;
use std::path::Path;

use mesh_core::{Landmark, Point3};

use crate::{Source, Target};
use entry::Entries;

/// What holds the names of the form of two lists, one a line, beside its file.
const NAMES_BESIDE: &str = "landmark_names.txt";
/// No landmark counts more.
pub const MAX_WEIGHT: f64 = 100.0;

/// Reads a landmark file of any form: JSON with named places, JSON of two lists, or lines of numbers. Curves come after the
/// landmarks, [cut] into landmarks.
///
/// # Errors
/// The first thing that is wrong with the file, or a place that source or target does not have.
pub fn read(
    path: impl AsRef<Path>,
    source: &Source,
    target: &Target,
) -> Result<Vec<Landmark>, LandmarkError> {
    let path = path.as_ref();
    let of_file = |error| LandmarkError {
        path: Some(path.to_owned()),
        ..error
    };
    let text = fs::read_to_string(path)
        .map_err(|error| of_file(LandmarkProblem::Io(error).at(LandmarkPlace::File)))?;
    let names = fs::read_to_string(path.with_file_name(NAMES_BESIDE)).ok();
    parse(&text, names.as_deref(), source, target.vertices()).map_err(of_file)
}

/// The landmarks in the text of a landmark file of any form, on a source and a target given by the vertices of its
/// file. `names` has a name per line, for the form of two lists.
///
/// # Errors
/// As [`read`].
///
/// ```
/// use mesh_core::{shapes, Point3};
/// use mesh_draping::{landmarks, Seams, Source};
/// let source = Source::of_soup(shapes::tetrahedron(), Seams::EXACT)?;
/// let text = r#"{"landmarks": [{"name": "tip", "source": {"vertex": 3}, "target": {"point": [0, 0, 1]}}]}"#;
/// let landmarks = landmarks::parse(text, None, &source, &[])?;
/// assert_eq!(landmarks[0].target, Point3::new(0.0, 0.0, 1.0));
/// # Ok::<(), mesh_draping::Error>(())
/// ```
pub fn parse(
    text: &str,
    names: Option<&str>,
    source: &Source,
    target: &[Point3],
) -> Result<Vec<Landmark>, LandmarkError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let entries = if lines::is_lines(text) {
        Entries::of(lines::parse(text)?)
    } else {
        json::parse(text, names)?
    };
    let mut landmarks = Vec::with_capacity(entries.landmarks.len());
    for (k, entry) in entries.landmarks.iter().enumerate() {
        let place = || LandmarkPlace::Entry(Label::new(k, entry.name.as_deref()));
        let landmark = entry.resolve(source, target);
        landmarks.push(landmark.map_err(|problem| problem.at(place()))?);
    }
    for (k, curve) in entries.curves.iter().enumerate() {
        let place = || LandmarkPlace::Entry(Label::of_curve(k, curve.name.as_deref()));
        let cut = curve.resolve(source, target);
        landmarks.extend(cut.map_err(|problem| problem.at(place()))?);
    }
    Ok(landmarks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seams;
    use mesh_core::{shapes, LandmarkKind};

    fn source() -> Source {
        Source::of_soup(shapes::open_grid(2, 2), Seams::EXACT).unwrap()
    }

    fn resolve(text: &str) -> Result<Vec<Landmark>, LandmarkError> {
        parse(text, None, &source(), &[Point3::new(5.0, 6.0, 7.0)])
    }

    fn error(text: &str) -> String {
        resolve(text).unwrap_err().to_string()
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
        let source = source();
        let at = |k: usize| landmarks[k].source.position(source.rest());
        assert_eq!(landmarks[0].kind, LandmarkKind::Rigid);
        assert_eq!(at(0), Point3::new(1.0, 1.0, 0.0));
        assert_eq!(landmarks[0].target, Point3::new(5.0, 6.0, 7.0));
        assert!((at(1) - Point3::new(0.5, 0.5, 0.0)).norm() < 1e-12);
        assert!((at(2) - Point3::new(1.5, 0.25, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn the_form_of_lists_takes_names_of_the_same_count() {
        let text = r#"{"source_vertices": [0, 8], "target_points": [[0,0,0],[1,1,1]], "source": "by hand"}"#;
        let name = |names| {
            parse(text, Some(names), &source(), &[]).unwrap()[1]
                .name
                .clone()
        };
        assert_eq!(name("a\nb\n").as_deref(), Some("b"));
        assert_eq!(name("a\nb\nc\n"), None);
    }

    #[test]
    fn errors_name_file_and_landmark() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lm.json");
        let text = r#"{"landmarks": [{"name": "nose", "source": {"vertex": 99}, "target": {"point": [0,0,0]}}]}"#;
        fs::write(&path, text).unwrap();
        let target = Target::of_soup(shapes::tetrahedron()).unwrap();
        let told = read(&path, &source(), &target).unwrap_err().to_string();
        let expected = "lm.json: landmark 0 (nose): source vertex 99 does not exist: the source has 9 vertices, \
                        counted from 0";
        assert!(told.ends_with(expected), "{told}");
        let missing = read(folder.path().join("no.json"), &source(), &target).unwrap_err();
        assert!(missing.to_string().contains("no.json: cannot be read: "));
    }

    #[test]
    fn every_mistake_is_named() {
        let one = |source: &str, target: &str| {
            format!(r#"{{"landmarks": [{{"source": {source}, "target": {target}}}]}}"#)
        };
        let at = r#"{"vertex": 0}"#;
        let cases = [
            ("{".to_owned(), "is not JSON"),
            (r#"{"points": []}"#.to_owned(), "needs \"landmarks\""),
            (one(at, r#"{"vertex": 4}"#), "target vertex 4"),
            (one(r#"{"face": 7, "barycentric": [1]}"#, at), "face 7"),
            (
                one(r#"{"face": 0, "barycentric": [1, 0, 0]}"#, at),
                "4 corners",
            ),
            (one(r#"{"vertx": 0}"#, at), "unknown field `vertx`"),
            (
                one(r#"{"vertex": -1}"#, at),
                "landmark 0: vertex must be the number of a row",
            ),
            (
                one(at, r#"{"point": [0, 0, 1e300]}"#),
                "target point is not finite",
            ),
            (
                r#"{"landmarks": [{"name": "hem", "curve": {"source": [0, 9], "target": [[0,0,0],[1,0,0]]}}]}"#
                    .to_owned(),
                "curve 0 (hem): source vertex 9 does not exist",
            ),
            (
                r#"{"landmarks": [{"curve": {"source": [0, 2], "target": [[0,0,0],[0,0,0]]}}]}"#.to_owned(),
                "curve 0: has no length on the target",
            ),
            (
                r#"{"landmarks": [{"curve": {"source": [0, 2]}}]}"#.to_owned(),
                "curve must be an object of two lists",
            ),
            (
                r#"{"landmarks": [{"source": {"vertex": 0}, "target": {"vertex": 0}, "weight": -1}]}"#.to_owned(),
                "landmark 0: weight must be a number from 0 to 100",
            ),
            (
                r#"{"source_vertices": [0], "target_points": []}"#.to_owned(),
                "1 source_vertices but 0",
            ),
        ];
        for (text, expected) in cases {
            let told = error(&text);
            assert!(told.contains(expected), "{told} lacks {expected}");
        }
    }
}
