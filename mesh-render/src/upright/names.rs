//! What the names of landmarks say about which way is up.

use mesh_core::{Aabb, Landmark, Point3, Positions};

use super::Evidence;
use crate::Up;

/// Parts of names of what stands on the ground.
const FEET: [&str; 7] = ["foot", "feet", "toe", "heel", "hoof", "paw", "ankle"];
/// Parts of names of the upper half of a face, and of the lower one.
const UPPER_FACE: [&str; 4] = ["eye", "brow", "nasion", "forehead"];
const LOWER_FACE: [&str; 4] = ["mouth", "chin", "jaw", "lip"];

/// By how much named places lie above those that belong below them, along each axis, in longest sides of the source's box.
///
/// With two named feet or more: the gap between the highest foot and the lowest of all other landmarks. Else the mean of
/// the upper half of a face less that of the lower half. No name, or a gap that is none: 0.
pub(super) fn evidence(landmarks: &[Landmark], rest: &Positions) -> Evidence {
    let places: Vec<(String, Point3)> = landmarks
        .iter()
        .map(|l| {
            (
                l.name.as_deref().unwrap_or_default(),
                l.source.position(rest),
            )
        })
        .map(|(name, p)| (name.to_lowercase(), p))
        .collect();
    let called = |words: &[&str]| -> Vec<Point3> {
        let named = places.iter().filter(|(name, _)| is_any(name, words));
        named.map(|(_, p)| *p).collect()
    };
    let feet = called(&FEET);
    let others = places.iter().filter(|(name, _)| !is_any(name, &FEET));
    let others: Vec<Point3> = others.map(|(_, p)| *p).collect();
    let (upper, lower) = (called(&UPPER_FACE), called(&LOWER_FACE));
    let side = Aabb::of(rest.iter()).longest_side();
    Up::AXES.map(|(up, _)| {
        let heights = |points: &[Point3]| -> Vec<f64> {
            points
                .iter()
                .map(|p| p.coords.dot(&up.direction()))
                .collect()
        };
        let gap = if feet.len() >= 2 {
            gap(&heights(&others), &heights(&feet))
        } else {
            mean(&heights(&upper))
                .zip(mean(&heights(&lower)))
                .map_or(0.0, |(u, l)| u - l)
        };
        (gap / side).max(0.0)
    })
}

fn is_any(name: &str, words: &[&str]) -> bool {
    words.iter().any(|word| name.contains(word))
}

/// How far all of `above` lie above all of `below`; 0 where nothing is above.
fn gap(above: &[f64], below: &[f64]) -> f64 {
    let lowest = above.iter().copied().reduce(f64::min);
    let highest = below.iter().copied().reduce(f64::max);
    lowest.zip(highest).map_or(0.0, |(low, high)| low - high)
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
