//! A glTF document without its morph targets.

use std::ops::Range;

use super::json_spans::{entry, items, member, root, Edit};

/// What to change for the document to have no morph targets: those of the meshes go, the weights of meshes and nodes,
/// and the channels that animate them. Accessors and buffers stay, so that every number in the document stays right.
pub(super) fn without_morphs(json: &[u8]) -> Vec<Edit> {
    let list = |object: Range<usize>, key: &str| {
        member(json, object, key).map_or_else(Vec::new, |array| items(json, array))
    };
    let document = root(json);
    let mut edits = Vec::new();
    let mut remove = |object: Range<usize>, key| {
        edits.extend(entry(json, object, key).map(|span| (span, String::new())));
    };
    for mesh in list(document.clone(), "meshes") {
        for primitive in list(mesh.clone(), "primitives") {
            remove(primitive, "targets");
        }
        remove(mesh, "weights");
    }
    for node in list(document.clone(), "nodes") {
        remove(node, "weights");
    }
    edits.extend(animation_edits(json, document));
    edits
}

/// An animation of weights alone goes as a whole, for none may be without a channel.
fn animation_edits(json: &[u8], document: Range<usize>) -> Option<Edit> {
    let all = member(json, document.clone(), "animations")?;
    let animations = items(json, all.clone());
    let pruned: Vec<Pruned> = animations.iter().map(|a| pruned(json, a.clone())).collect();
    if pruned.iter().all(|p| matches!(p, Pruned::Same)) {
        return None;
    }
    let texts = animations.into_iter().zip(pruned);
    let texts: Vec<String> = texts
        .filter_map(|(span, pruned)| match pruned {
            Pruned::Same => Some(text(json, span)),
            Pruned::Less(text) => Some(text),
            Pruned::Nothing => None,
        })
        .collect();
    if texts.is_empty() {
        return Some((entry(json, document, "animations")?, String::new()));
    }
    Some((all, format!("[{}]", texts.join(","))))
}

/// What is left of an animation.
enum Pruned {
    Same,
    Less(String),
    Nothing,
}

fn pruned(json: &[u8], animation: Range<usize>) -> Pruned {
    let Some(list) = member(json, animation.clone(), "channels") else {
        return Pruned::Same;
    };
    let channels = items(json, list.clone());
    let others = channels.iter().filter(|c| !moves_weights(json, c));
    let others: Vec<String> = others.map(|c| text(json, c.clone())).collect();
    match others.len() {
        n if n == channels.len() => Pruned::Same,
        0 => Pruned::Nothing,
        _ => Pruned::Less(format!(
            "{}[{}]{}",
            text(json, animation.start..list.start),
            others.join(","),
            text(json, list.end..animation.end)
        )),
    }
}

fn moves_weights(json: &[u8], channel: &Range<usize>) -> bool {
    let path =
        member(json, channel.clone(), "target").and_then(|target| member(json, target, "path"));
    path.is_some_and(|path| &json[path] == b"\"weights\"")
}

fn text(json: &[u8], span: Range<usize>) -> String {
    String::from_utf8_lossy(&json[span]).into_owned()
}

#[cfg(test)]
mod tests {
    use super::super::json_spans::edited;
    use super::*;

    fn pruned(json: &str) -> String {
        let edits = without_morphs(json.as_bytes());
        String::from_utf8(edited(json.as_bytes(), edits)).unwrap()
    }

    #[test]
    fn targets_and_weights_go_and_nothing_else() {
        let json = r#"{"meshes": [{"primitives": [{"attributes": {}, "targets": [{"POSITION": 1}], "mode": 4},
            {"targets": []}], "weights": [0, 1], "extras": {"weights": [2]}}], "nodes": [{"mesh": 0, "weights": [1]}]}"#;
        assert_eq!(
            pruned(json),
            r#"{"meshes": [{"primitives": [{"attributes": {}, "mode": 4},
            {}], "extras": {"weights": [2]}}], "nodes": [{"mesh": 0}]}"#
        );
    }

    #[test]
    fn animations_lose_the_channels_of_weights() {
        let weights = r#"{"sampler": 0, "target": {"node": 0, "path": "weights"}}"#;
        let turn = r#"{"sampler": 1, "target": {"node": 0, "path": "rotation"}}"#;
        let json = |list: &str| format!(r#"{{"a": 1, "animations": [{list}]}}"#);
        let animation = |channels: &str| format!(r#"{{"channels": [{channels}], "name": "x"}}"#);
        assert_eq!(pruned(&json(&animation(turn))), json(&animation(turn)));
        assert_eq!(
            pruned(&json(&animation(&format!("{weights}, {turn}")))),
            json(&animation(turn))
        );
        assert_eq!(pruned(&json(&animation(weights))), r#"{"a": 1}"#);
        let two = format!(
            "{}, {}",
            animation(weights),
            animation(&format!("{turn}, {weights}"))
        );
        assert_eq!(pruned(&json(&two)), json(&animation(turn)));
    }
}
