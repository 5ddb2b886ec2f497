//! Landmarks as lines of numbers, and landmarks written in any form.
//!
//! | numbers on a line | mean |
//! |---|---|
//! | 2 | source vertex, target vertex |
//! | 4 | source vertex, target x y z |
//! | 6 | source x y z, target x y z |
//!
//! Blanks, commas or semicolons stand between them; what follows is the name; `#` begins a comment.

use std::fmt::Write as _;

use anyhow::{bail, ensure, Context as _};
use mesh_core::{Landmark, LandmarkKind, Point3};
use serde_json::{json, Value};

use crate::input::Source;

use super::file::{Entry, SourcePlace, TargetPlace};

/// A way to write landmarks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Form {
    /// JSON with names, places in faces and kinds: nothing is lost
    Json,
    /// JSON of two lists, source_vertices and target_points
    Lists,
    /// Lines of source vertex, target x y z, name
    Text,
    /// Lines of source vertex, target vertex, name
    Ids,
    /// Lines of source x y z, target x y z, name
    Points,
}

/// Reads lines of numbers.
pub(super) fn parse(text: &str) -> anyhow::Result<Vec<Entry>> {
    let mut entries = Vec::new();
    for (row, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if !line.is_empty() {
            entries.push(entry(line).with_context(|| format!("line {}", row + 1))?);
        }
    }
    ensure!(!entries.is_empty(), "holds no landmark");
    Ok(entries)
}

fn entry(line: &str) -> anyhow::Result<Entry> {
    let words: Vec<&str> = line
        .split(|c: char| c.is_whitespace() || c == ',' || c == ';')
        .filter(|w| !w.is_empty())
        .collect();
    let numbers: Vec<f64> = words.iter().map_while(|w| w.parse().ok()).collect();
    let name = words[numbers.len()..].join(" ");
    let point = |at: usize| Point3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
    let (source, target) = match numbers.len() {
        2 => (
            SourcePlace::Vertex(vertex(words[0])?),
            TargetPlace::Vertex(vertex(words[1])?),
        ),
        4 => (
            SourcePlace::Vertex(vertex(words[0])?),
            TargetPlace::Point(point(1)),
        ),
        6 => (SourcePlace::Point(point(0)), TargetPlace::Point(point(3))),
        n => bail!(
            "has {n} numbers; give 2 (source vertex, target vertex), 4 (source vertex, target x y z) or 6 (source \
             x y z, target x y z), and then perhaps a name"
        ),
    };
    Ok(Entry {
        name: (!name.is_empty()).then_some(name),
        source,
        target,
        kind: LandmarkKind::Soft,
    })
}

fn vertex(word: &str) -> anyhow::Result<usize> {
    word.parse()
        .with_context(|| format!("'{word}' is no vertex: rows count from 0"))
}

/// The shapes that landmarks lie on.
pub(crate) struct Places<'a> {
    pub(crate) source: &'a Source,
    /// Vertices of the target's file.
    pub(crate) target: &'a [Point3],
}

/// The landmarks in a form, and how far the farthest place had to move to the nearest vertex, on either side, in units
/// of its file: forms of vertices can hold no other place.
pub(crate) fn write(landmarks: &[Landmark], places: &Places<'_>, form: Form) -> (String, f64) {
    let mut moved = 0.0f64;
    let mut source_vertex = |l: &Landmark| {
        let v = l.source.main_vertex();
        let rest = &places.source.rest;
        moved = moved.max((rest[v] - l.source.position(rest)).norm());
        places.source.file_row(v)
    };
    let text = match form {
        Form::Json => {
            let entries: Vec<Value> = landmarks.iter().map(|l| json_entry(l, places)).collect();
            format!("{:#}\n", json!({ "landmarks": entries }))
        }
        Form::Lists => {
            let vertices: Vec<usize> = landmarks.iter().map(&mut source_vertex).collect();
            let points: Vec<[f64; 3]> = landmarks.iter().map(|l| l.target.coords.into()).collect();
            format!(
                "{:#}\n",
                json!({ "source_vertices": vertices, "target_points": points })
            )
        }
        Form::Text => lines(landmarks, |l| {
            format!("{} {}", source_vertex(l), numbers(&l.target))
        }),
        Form::Ids => {
            let mut off = 0.0f64;
            let text = lines(landmarks, |l| {
                let (row, distance) = nearest(places.target, &l.target);
                off = off.max(distance);
                format!("{} {row}", source_vertex(l))
            });
            return (text, moved.max(off));
        }
        Form::Points => lines(landmarks, |l| {
            let from = l.source.position(&places.source.rest);
            format!("{} {}", numbers(&from), numbers(&l.target))
        }),
    };
    (text, moved)
}

fn json_entry(l: &Landmark, places: &Places<'_>) -> Value {
    let vertex = l.source.main_vertex();
    let at = l.source.position(&places.source.rest);
    let source = if at == places.source.rest[vertex] {
        json!({ "vertex": places.source.file_row(vertex) })
    } else {
        json!({ "point": [at.x, at.y, at.z] })
    };
    let target: [f64; 3] = l.target.coords.into();
    let mut entry = json!({ "source": source, "target": { "point": target } });
    if let Some(name) = &l.name {
        entry["name"] = json!(name);
    }
    if l.kind == LandmarkKind::Rigid {
        entry["kind"] = json!("rigid");
    }
    entry
}

fn lines(landmarks: &[Landmark], mut places: impl FnMut(&Landmark) -> String) -> String {
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
    use super::*;
    use crate::seams::Seams;
    use mesh_core::VertexId;

    #[test]
    fn lines_are_understood_and_mistakes_named() {
        let entries = parse("# mine\n3 7 nose tip\n\n4, 1.5; 2 -3 # eye\n0 0 0 1 1 1\n").unwrap();
        assert_eq!(entries[0].name.as_deref(), Some("nose tip"));
        assert_eq!(entries[0].target, TargetPlace::Vertex(7));
        assert_eq!(
            entries[1].target,
            TargetPlace::Point(Point3::new(1.5, 2.0, -3.0))
        );
        assert_eq!(entries[2].source, SourcePlace::Point(Point3::origin()));
        let error = |text: &str| format!("{:#}", parse(text).unwrap_err());
        assert!(error("1 2\n1 2 3\n").starts_with("line 2: has 3 numbers"));
        assert!(error("1.5 2").contains("'1.5' is no vertex"));
        assert!(error("# nothing\n").contains("no landmark"));
    }

    #[test]
    fn every_line_form_comes_back() {
        let source = Source::new(mesh_core::shapes::tetrahedron(), Seams::EXACT).unwrap();
        let target: Vec<Point3> = source.rest.iter().map(|p| p * 2.0).collect();
        let mut landmark = Landmark::new(VertexId::new(2), target[2]);
        landmark.name = Some("left ear".to_owned());
        let places = Places {
            source: &source,
            target: &target,
        };
        for form in [Form::Text, Form::Ids, Form::Points] {
            let (text, moved) = write(std::slice::from_ref(&landmark), &places, form);
            assert_eq!(moved, 0.0);
            let back = &parse(&text).unwrap()[0];
            assert_eq!(back.name, landmark.name, "{form:?}");
            match form {
                Form::Ids => assert_eq!(back.target, TargetPlace::Vertex(2)),
                _ => assert_eq!(back.target, TargetPlace::Point(target[2])),
            }
        }
    }
}
