//! Looks at landmarks before a run and says in words what is probably wrong with them.
//!
//! Thresholds come from the twelve pairs of `data/pairs`: none of them is warned about, and exchanging a left and a
//! right landmark is found in all but the few cases where the two lie close together.

use mesh_core::{Landmark, Point3, Positions, TargetSurface};

use super::file::label;
use crate::input::Pair;
use crate::similarity::{fit, fit_or_mirror, Match};

/// Distance from the target, in longest sides of its box, from which a landmark is off the surface.
const OFF_SURFACE: f64 = 0.02;
/// Distance, likewise, below which two landmarks are one.
const SAME_PLACE: f64 = 1e-6;
/// Share of the misfit that exchanging two landmarks must leave, at most, to suspect that they are exchanged.
const EXCHANGE_GAIN: f64 = 0.97;
/// Share of the misfit that a mirror image must leave, at most, to suspect that left and right are exchanged.
const MIRROR_GAIN: f64 = 0.7;
/// Share of the misfit that leaving one landmark out must leave, at most, to suspect that it is wrong. Shapes that
/// truly differ come close: without the tip of its tail, the horse fits the wolf with 0.46 of the misfit.
const OUTLIER_GAIN: f64 = 0.42;
/// A landmark is also wrong that is this many times as far from where the others expect it as the others are on the
/// median, and at least this far: on clean sets of shapes that are much alike the ratio stays below 3.4, and landmarks
/// moved by 10 % along the surface come to 5 and more.
const LEFT_OUT_RATIO: f64 = 4.0;
const LEFT_OUT_LEAST: f64 = 0.04;
/// It says something only where the others expect each other this well, on the median, in longest sides.
const MUCH_ALIKE: f64 = 0.03;
/// Fewer landmarks say too little about each other.
const ENOUGH_TO_COMPARE: usize = 6;
/// Fewer than this leave the affine map open.
const ENOUGH_FOR_AFFINE: usize = 4;
/// Fewer than this leave large parts without guidance.
const ENOUGH_TO_GUIDE: usize = 5;

/// Everything suspicious about the landmarks of a pair, in words.
pub(crate) fn examine(pair: &Pair) -> Vec<String> {
    let case = Case::new(
        &pair.landmarks,
        &pair.source.rest,
        pair.target.surface.as_ref(),
    );
    let mut warnings: Vec<String> = case.too_few().into_iter().collect();
    warnings.extend(case.off_surface());
    warnings.extend(case.duplicates());
    warnings.extend(case.inconsistent());
    warnings
}

/// How far each landmark is from where the similarity of all others takes it, in longest sides of the target's box.
pub(crate) fn left_out_residuals(pair: &Pair) -> Vec<f64> {
    let case = Case::new(
        &pair.landmarks,
        &pair.source.rest,
        pair.target.surface.as_ref(),
    );
    case.left_out(&case.matches)
}

struct Case<'a> {
    landmarks: &'a [Landmark],
    matches: Vec<Match>,
    target: &'a dyn TargetSurface,
    /// Longest side of the target's box.
    side: f64,
    source_side: f64,
}

impl<'a> Case<'a> {
    fn new(landmarks: &'a [Landmark], rest: &Positions, target: &'a dyn TargetSurface) -> Self {
        let matched = |l: &Landmark| Match {
            from: l.source.position(rest),
            to: l.target,
        };
        Self {
            landmarks,
            matches: landmarks.iter().map(matched).collect(),
            target,
            side: target.bounds().longest_side(),
            source_side: mesh_core::Aabb::of(rest.iter()).longest_side(),
        }
    }

    fn label(&self, k: usize) -> String {
        label(k, self.landmarks[k].name.as_deref())
    }

    fn percent(&self, length: f64) -> String {
        format!(
            "{:.1} % of the target's longest side",
            100.0 * length / self.side
        )
    }

    fn too_few(&self) -> Option<String> {
        let n = self.landmarks.len();
        let list = if n == 1 {
            "1 landmark".to_owned()
        } else {
            format!("{n} landmarks")
        };
        if n == 0 {
            // What was assumed instead is said where the pose is searched.
            None
        } else if n < ENOUGH_FOR_AFFINE {
            Some(format!(
                "{list}: too few to find how the source is stretched; mark at least {ENOUGH_FOR_AFFINE} places that do \
                 not lie in one plane"
            ))
        } else if n < ENOUGH_TO_GUIDE {
            Some(format!(
                "{list}: few; mark the ends of limbs, ears and other parts that stick out"
            ))
        } else {
            None
        }
    }

    fn off_surface(&self) -> Vec<String> {
        let targets: Vec<Point3> = self.matches.iter().map(|m| m.to).collect();
        let closest = self.target.closest_points(&targets);
        let far = closest
            .iter()
            .map(|c| c.distance_squared.sqrt())
            .enumerate();
        far.filter(|(_, distance)| *distance > OFF_SURFACE * self.side)
            .map(|(k, distance)| {
                format!(
                    "{} is off the target's surface by {}",
                    self.label(k),
                    self.percent(distance)
                )
            })
            .collect()
    }

    fn duplicates(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for (j, b) in self.matches.iter().enumerate() {
            for (i, a) in self.matches[..j].iter().enumerate() {
                let same_source = (a.from - b.from).norm() <= SAME_PLACE * self.source_side;
                let same_target = (a.to - b.to).norm() <= SAME_PLACE * self.side;
                let what = match (same_source, same_target) {
                    (true, true) => "are the same",
                    (true, false) => {
                        "start from one place of the source but belong to two of the target"
                    }
                    (false, true) => {
                        "belong to one place of the target but start from two of the source"
                    }
                    (false, false) => continue,
                };
                warnings.push(format!("{} and {} {what}", self.label(i), self.label(j)));
            }
        }
        warnings
    }

    /// Mirror images first, then exchanged pairs, then single landmarks that the others contradict.
    fn inconsistent(&self) -> Vec<String> {
        if self.matches.len() < ENOUGH_FOR_AFFINE {
            return Vec::new();
        }
        let (straight, mirrored) = (fit(&self.matches), fit_or_mirror(&self.matches));
        if mirrored.is_mirror()
            && mirrored.rms(&self.matches) < MIRROR_GAIN * straight.rms(&self.matches)
        {
            return vec![
                "the landmarks fit a mirror image better: left and right are probably exchanged throughout".to_owned(),
            ];
        }
        let mut matches = self.matches.clone();
        let mut warnings = Vec::new();
        while let Some((i, j)) =
            exchanged(&matches).filter(|_| warnings.len() < self.matches.len() / 2)
        {
            (matches[i].to, matches[j].to) = (matches[j].to, matches[i].to);
            warnings.push(format!(
                "{} and {} are probably exchanged",
                self.label(i),
                self.label(j)
            ));
        }
        warnings.extend(self.outlier(&matches));
        warnings
    }

    /// The landmark without which the others fit best, if they then fit far better.
    fn outlier(&self, matches: &[Match]) -> Option<String> {
        if matches.len() < ENOUGH_TO_COMPARE {
            return None;
        }
        let left_out = (0..matches.len()).map(|k| {
            let mut others = matches.to_vec();
            let one = others.remove(k);
            let map = fit(&others);
            (map.rms(&others), k, map.miss(&one))
        });
        let (rms, k, miss) = left_out.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let is_far_better = rms < OUTLIER_GAIN * fit(matches).rms(matches);
        let (k, miss) = if is_far_better {
            (k, miss)
        } else {
            self.unexpected(matches)?
        };
        Some(format!(
            "{} is {} from where the other landmarks expect it",
            self.label(k),
            self.percent(miss)
        ))
    }

    /// The landmark that the others, agreeing well among themselves, expect elsewhere.
    fn unexpected(&self, matches: &[Match]) -> Option<(usize, f64)> {
        let residuals = self.left_out(matches);
        let mut sorted = residuals.clone();
        sorted.sort_by(f64::total_cmp);
        let median = sorted[sorted.len() / 2];
        let (k, worst) = residuals
            .iter()
            .copied()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        let is_wrong =
            median < MUCH_ALIKE && worst > LEFT_OUT_LEAST && worst > LEFT_OUT_RATIO * median;
        is_wrong.then_some((k, worst * self.side))
    }

    /// Distance of each match from where the similarity of all others takes it, in longest sides.
    fn left_out(&self, matches: &[Match]) -> Vec<f64> {
        (0..matches.len())
            .map(|k| {
                let mut others = matches.to_vec();
                let one = others.remove(k);
                fit(&others).miss(&one) / self.side
            })
            .collect()
    }
}

/// Whether the similarity of all others wants both targets exchanged.
fn others_agree(matches: &[Match], i: usize, j: usize) -> bool {
    let others = matches
        .iter()
        .enumerate()
        .filter(|&(k, _)| k != i && k != j);
    let map = fit(&others.map(|(_, m)| *m).collect::<Vec<_>>());
    let (a, b) = (matches[i], matches[j]);
    let exchanged = [Match { to: b.to, ..a }, Match { to: a.to, ..b }];
    [a, b]
        .iter()
        .zip(&exchanged)
        .all(|(before, after)| map.miss(after) < map.miss(before))
}

/// The two matches whose exchange lowers the misfit most, if it does so by enough.
fn exchanged(matches: &[Match]) -> Option<(usize, usize)> {
    if matches.len() < ENOUGH_FOR_AFFINE + 1 {
        return None;
    }
    let before = fit(matches).rms(matches);
    let mut trial = matches.to_vec();
    let mut best = (EXCHANGE_GAIN * before, None);
    for j in 1..matches.len() {
        for i in 0..j {
            (trial[i].to, trial[j].to) = (matches[j].to, matches[i].to);
            let after = fit(&trial).rms(&trial);
            if after < best.0 && others_agree(matches, i, j) {
                best = (after, Some((i, j)));
            }
            (trial[i].to, trial[j].to) = (matches[i].to, matches[j].to);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, TriangleSoup, VertexId};

    /// Eight corners of a lopsided box on the target `2 x`, each marked.
    fn corners() -> (Positions, TriangleSoup, Vec<Landmark>) {
        let mut soup = shapes::quad_sphere(1);
        for p in &mut soup.positions {
            *p = Point3::new(p.x * (1.5 + 0.3 * p.y), p.y, p.z * (0.7 + 0.1 * p.x));
        }
        let rest: Positions = soup.positions.iter().copied().collect();
        soup.positions.iter_mut().for_each(|p| *p *= 2.0);
        let landmarks = rest
            .ids()
            .map(|v: VertexId| Landmark::new(v, rest[v] * 2.0))
            .collect();
        (rest, TriangleSoup::new(soup).unwrap(), landmarks)
    }

    fn warnings(change: impl Fn(&mut Vec<Landmark>)) -> Vec<String> {
        let (rest, target, mut landmarks) = corners();
        change(&mut landmarks);
        let case = Case::new(&landmarks, &rest, &target);
        let lists = [
            case.too_few().into_iter().collect(),
            case.off_surface(),
            case.duplicates(),
            case.inconsistent(),
        ];
        lists.concat()
    }

    #[test]
    fn good_landmarks_are_left_alone() {
        assert!(warnings(|_| ()).is_empty());
    }

    #[test]
    fn each_mistake_is_named() {
        let swapped = warnings(|l| (l[1].target, l[6].target) = (l[6].target, l[1].target));
        assert_eq!(
            swapped,
            ["landmark 1 and landmark 6 are probably exchanged"]
        );

        let mirrored = warnings(|l| l.iter_mut().for_each(|l| l.target.x = -l.target.x));
        assert!(mirrored.iter().any(|w| w.contains("mirror image")));

        let off = warnings(|l| l[3].target *= 1.5);
        assert!(off
            .iter()
            .any(|w| w.starts_with("landmark 3 is off the target's surface")));

        let twice = warnings(|l| l.push(l[0].clone()));
        assert_eq!(twice, ["landmark 0 and landmark 8 are the same"]);

        let few = warnings(|l| l.truncate(3));
        assert!(few[0].starts_with("3 landmarks: too few"));
        assert!(warnings(Vec::clear).is_empty());
    }

    #[test]
    fn a_contradicting_landmark_is_an_outlier() {
        let wrong = warnings(|l| l[2].target = Point3::from(-l[2].target.coords));
        assert!(
            wrong
                .iter()
                .any(|w| w.contains("landmark 2") && w.contains("expect it")),
            "{wrong:?}"
        );
    }
}
