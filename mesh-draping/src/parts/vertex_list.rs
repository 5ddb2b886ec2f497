//! Files of vertex numbers, and of vertices with weights.

use std::fs;
use std::path::Path;

use mesh_core::{VertexData, VertexId};

use super::error::{LineProblem, PartProblem};
use crate::Source;

/// The vertices that a file lists by their rows.
pub(super) fn read_vertices(path: &Path, source: &Source) -> Result<VertexData<bool>, PartProblem> {
    let text = fs::read_to_string(path).map_err(PartProblem::Io)?;
    let mut part = VertexData::new(source.rest().len(), false);
    for (line, words) in numbered_lines(&text) {
        for word in words {
            let vertex = vertex(word, source);
            part[vertex.map_err(|problem| PartProblem::Line { line, problem })?] = true;
        }
    }
    Ok(part)
}

/// One weight per vertex from lines "vertex weight"; those that the file does not name are 1.
pub(super) fn read_weights(path: &Path, source: &Source) -> Result<VertexData<f64>, PartProblem> {
    let text = fs::read_to_string(path).map_err(PartProblem::Io)?;
    let mut weights = VertexData::new(source.rest().len(), 1.0);
    for (line, words) in numbered_lines(&text) {
        let pair = weighted(&words, source);
        let (v, weight) = pair.map_err(|problem| PartProblem::Line { line, problem })?;
        weights[v] = weight;
    }
    Ok(weights)
}

fn weighted(words: &[&str], source: &Source) -> Result<(VertexId, f64), LineProblem> {
    let [v, weight] = words[..] else {
        return Err(LineProblem::NotPair);
    };
    let v = vertex(v, source)?;
    let number = weight.parse();
    Ok((
        v,
        number.map_err(|_| LineProblem::NotNumber(weight.to_owned()))?,
    ))
}

/// A vertex by its row in the file.
fn vertex(word: &str, source: &Source) -> Result<VertexId, LineProblem> {
    let row = word.parse::<usize>();
    let row = row.map_err(|_| LineProblem::NotVertex(word.to_owned()))?;
    let n = source.n_file_vertices();
    source
        .vertex_at(row)
        .ok_or(LineProblem::NoVertex { row, n })
}

/// The words of each line that says something, and its number from 1; `#` begins a comment.
fn numbered_lines(text: &str) -> impl Iterator<Item = (usize, Vec<&str>)> {
    let lines = text.lines().enumerate().map(|(row, line)| {
        let line = line.split('#').next().unwrap_or_default();
        let words = line.split(|c: char| c.is_whitespace() || c == ',');
        (row + 1, words.filter(|w| !w.is_empty()).collect::<Vec<_>>())
    });
    lines.filter(|(_, words)| !words.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_split_and_comments_dropped() {
        let lines: Vec<_> = numbered_lines("# a\n1, 0.5\n\n2 0 # b\n").collect();
        assert_eq!(lines, [(2, vec!["1", "0.5"]), (4, vec!["2", "0"])]);
    }
}
