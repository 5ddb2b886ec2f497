//! Landmarks as lines of numbers.
//!
//! | numbers on a line | mean |
//! |---|---|
//! | 2 | source vertex, target vertex |
//! | 4 | source vertex, target x y z |
//! | 6 | source x y z, target x y z |
//!
//! Blanks, commas or semicolons stand between them; what follows is the name; `#` begins a comment.

use mesh_core::{LandmarkKind, Point3};

use super::entry::{Entry, SourcePlace, TargetPlace};
use super::{LandmarkError, LandmarkPlace, LandmarkProblem};

/// Whether the first line that says something begins as a number does.
pub(super) fn is_lines(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with('#'));
    first.is_some_and(|line| line.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '.'))
}

/// Reads lines of numbers.
pub(super) fn parse(text: &str) -> Result<Vec<Entry>, LandmarkError> {
    let mut entries = Vec::new();
    for (row, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if !line.is_empty() {
            let place = LandmarkPlace::Line(row + 1);
            entries.push(entry(line).map_err(|problem| problem.at(place))?);
        }
    }
    if entries.is_empty() {
        return Err(LandmarkProblem::Empty.at(LandmarkPlace::File));
    }
    Ok(entries)
}

fn entry(line: &str) -> Result<Entry, LandmarkProblem> {
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
        n => return Err(LandmarkProblem::NumberCount { n }),
    };
    Ok(Entry {
        name: (!name.is_empty()).then_some(name),
        source,
        target,
        kind: LandmarkKind::Soft,
        weight: 1.0,
    })
}

fn vertex(word: &str) -> Result<usize, LandmarkProblem> {
    let word_of = || LandmarkProblem::NotVertex {
        word: word.to_owned(),
    };
    word.parse().map_err(|_| word_of())
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let error = |text: &str| parse(text).unwrap_err().to_string();
        assert!(error("1 2\n1 2 3\n").starts_with("line 2: has 3 numbers"));
        assert!(error("1.5 2").contains("'1.5' is no vertex"));
        assert!(error("# nothing\n").contains("no landmark"));
    }
}
