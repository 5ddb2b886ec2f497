//! What the library found, in the words of the command line: its sentences, and the options that decide otherwise.

use std::fmt::Write as _;

use mesh_draping::landmarks::Finding;
use mesh_draping::parts::{PartError, PartList};
use mesh_draping::{Advice, Explanation, Note, Pair, Source};

/// Everything about the inputs that deserves attention.
pub(crate) fn about_inputs(pair: &Pair) -> Vec<String> {
    let findings = pair.findings();
    let findings = findings.iter().map(Finding::to_string);
    findings.chain(notes(&pair.notes())).collect()
}

/// Notes, each with the options that decide otherwise.
pub(crate) fn notes(notes: &[Note]) -> impl Iterator<Item = String> + '_ {
    notes.iter().map(|note| match option_for(note) {
        Some(option) => format!("{note} ({option})"),
        None => note.to_string(),
    })
}

fn option_for(note: &Note) -> Option<&'static str> {
    match note {
        Note::InnerPartsFreed { .. } => {
            Some("--free, --rigid and --draped decide otherwise, --no-hidden turns this off")
        }
        Note::LeftOut { .. } => Some("--overlap decides otherwise"),
        Note::Repaired { .. } | Note::Uncrossed { .. } => Some("setting repair"),
        _ => None,
    }
}

/// A part that was not found, by the option that named it.
pub(crate) fn part_error(error: &PartError) -> String {
    let PartError::Part {
        list,
        name,
        problem,
    } = error
    else {
        return error.to_string();
    };
    let option = match list {
        PartList::Free => "--free",
        PartList::Rigid => "--rigid",
        PartList::Draped => "--draped",
        PartList::Weights => "--weights",
    };
    format!("{option} {name}: {problem}")
}

/// That vertices of the source move as one, where they do.
pub(crate) fn seams(source: &Source) -> Option<String> {
    let (n_file, n) = (source.n_file_vertices(), source.rest().len());
    (n < n_file).then(|| {
        format!("{n_file} vertices at {n} places: those at one place move as one (--weld)")
    })
}

/// What to try, with the options and commands that do it.
pub(crate) fn advice(advice: Advice) -> String {
    match advice {
        Advice::SayWhatIsPartial => {
            "one shape reaches far beyond the other: try --overlap source-partial, target-partial or both".to_owned()
        }
        Advice::AddLandmark => {
            "drape landmarks suggest tells where one more landmark would help most".to_owned()
        }
        other => other.to_string(),
    }
}

/// An explanation for people: distances part by part, the worst places and crossings, what to try.
pub(crate) fn explanation(explanation: &Explanation) -> String {
    let mut text = String::new();
    if !explanation.regions.is_empty() {
        text += "distance of the vertices to the target, % of its longest side\n";
        text += "      mean    half   90 %   99 %    all\n";
    }
    for r in &explanation.regions {
        let [mean, p50, p90, p99, max] = [r.mean, r.p50, r.p90, r.p99, r.max].map(|d| 100.0 * d);
        let _ = writeln!(
            text,
            "    {mean:>6.3}  {p50:>6.3} {p90:>6.3} {p99:>6.3} {max:>6.3}  {} ({} vertices)",
            r.name, r.n_vertices
        );
    }
    if !explanation.places.is_empty() {
        text += "worst places\n";
    }
    for (k, place) in explanation.places.iter().enumerate() {
        let _ = writeln!(text, "  {}. {place}", k + 1);
    }
    if !explanation.crossings.is_empty() {
        text += "where the surface runs through itself\n";
    }
    for (k, place) in explanation.crossings.iter().enumerate() {
        let _ = writeln!(text, "  {}. {place}", k + 1);
    }
    for &tip in &explanation.advice {
        let _ = writeln!(text, "  try: {}", advice(tip));
    }
    text
}

/// An explanation as JSON.
pub(crate) fn explanation_json(explanation: &Explanation) -> serde_json::Value {
    let tips: Vec<String> = explanation.advice.iter().map(|&a| advice(a)).collect();
    serde_json::json!({
        "places": explanation.places,
        "crossings": explanation.crossings,
        "regions": explanation.regions,
        "advice": tips,
    })
}
