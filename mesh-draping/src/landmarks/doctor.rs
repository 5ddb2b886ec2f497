//! Looks at landmarks before a run and finds what is probably wrong with them.
//!
//! Thresholds come from the twelve pairs of `data/pairs`: none of them is warned about, and exchanging a left and a
//! right landmark is found in all but the few cases where the two lie close together.

use mesh_core::{Aabb, Curve, Landmark, Point3, TargetSurface};
use mesh_init::PointPair;

use super::finding::Shared;
use super::ways::Ways;
use super::{Finding, Label};
use crate::{Pair, Similarity};

/// Distance from the target, in longest sides of its box, from which a landmark is off the surface.
const OFF_SURFACE: f64 = 0.02;
/// Distance, likewise, below which two landmarks are one.
const SAME_PLACE: f64 = 1e-6;
/// Share of the misfit that exchanging two landmarks must leave, at most, to suspect that they are exchanged.
const EXCHANGE_GAIN: f64 = 0.97;
/// Share of the misfit that a mirror image must leave, at most, to suspect that left and right are exchanged.
const MIRROR_GAIN: f64 = 0.7;
/// Share of the misfit that exchanging the ends of a curve must leave, at most, to suspect that it runs the other way.
const REVERSED_GAIN: f64 = 0.7;
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
/// So many findings of one kind are told one by one.
const MAX_TOLD: usize = 20;
/// With more landmarks than this, one map of all stands for those of all but one: it is the same but for a thousandth.
const ENOUGH_TO_COUNT_AS_ALL: usize = 1000;
/// No more landmarks are compared with each other, one by one.
const MOST_COMPARED: usize = 10_000;
/// No more exchanged pairs are looked for: a set that needs so many is wrong as a whole.
const MOST_EXCHANGES: usize = 8;
/// With more landmarks than this no exchanged pair is looked for: every pair of them would have to be tried.
const ENOUGH_TO_TRUST: usize = 200;
/// Fewer landmarks say too little about each other.
const ENOUGH_TO_COMPARE: usize = 6;
/// Fewer than this leave the affine map open.
const ENOUGH_FOR_AFFINE: usize = 4;
/// Fewer than this leave large parts without guidance.
const ENOUGH_TO_GUIDE: usize = 5;

/// Everything suspicious about the landmarks of a pair.
pub(crate) fn examine(pair: &Pair) -> Vec<Finding> {
    Case::of(pair).examine()
}

/// How far each landmark is from where the similarity of all others takes it, in longest sides of the target's box. Of
/// more than a thousand landmarks, that of all. Those of curves are no others and have none, nor are those of weight 0.
pub fn leave_one_out_residuals(pair: &Pair) -> Vec<f64> {
    let case = Case::of(pair);
    let map = Similarity::fit(&case.pairs);
    let rest = pair.source.rest();
    let miss = |l: &&Landmark| {
        let pair = PointPair::new(l.source.position(rest), l.target);
        map.miss(&pair) / case.side
    };
    let mut residuals: Vec<f64> = case.landmarks.iter().map(miss).collect();
    for (&row, left_out) in case.rows.iter().zip(case.residuals(&case.pairs)) {
        residuals[row] = left_out;
    }
    residuals
}

struct Case<'a> {
    pair: &'a Pair,
    /// The landmarks that are not of a curve, and the rows among them of those that count.
    landmarks: Vec<&'a Landmark>,
    rows: Vec<usize>,
    pairs: Vec<PointPair>,
    target: &'a dyn TargetSurface,
    /// Longest side of the target's box.
    side: f64,
    source_side: f64,
}

impl<'a> Case<'a> {
    fn of(pair: &'a Pair) -> Self {
        let rest = pair.source.rest();
        let landmarks: Vec<&Landmark> = Landmark::marked(&pair.landmarks).collect();
        let rows = (0..landmarks.len()).filter(|&row| landmarks[row].is_followed());
        let rows: Vec<usize> = rows.collect();
        let place = |&row: &usize| {
            PointPair::new(landmarks[row].source.position(rest), landmarks[row].target)
        };
        let target = pair.target.judged().as_ref();
        Self {
            pair,
            pairs: rows.iter().map(place).collect(),
            landmarks,
            rows,
            target,
            side: target.bounds().longest_side(),
            source_side: Aabb::of(rest.iter()).longest_side(),
        }
    }

    fn examine(&self) -> Vec<Finding> {
        let mut findings: Vec<Finding> = self.too_few().into_iter().collect();
        findings.extend(self.off_surface());
        findings.extend(self.same_places());
        findings.extend(self.inconsistent());
        findings.extend(self.curves());
        findings
    }

    fn label(&self, k: usize) -> Label {
        let row = self.rows[k];
        Label::new(row, self.landmarks[row].name.as_deref())
    }

    /// Curves that are off the target, or probably run the other way.
    fn curves(&self) -> Vec<Finding> {
        let runs = Curve::runs(&self.pair.landmarks).enumerate();
        let followed = runs.filter(|(_, (curve, _))| curve.weight > 0.0);
        let findings = followed.flat_map(|(k, (curve, cut))| {
            let label = Label::of_curve(k, curve.name.as_deref());
            let points: Vec<Point3> = cut.iter().map(|l| l.target).collect();
            let far = self.target.closest_points(&points).into_iter();
            let far = far
                .map(|hit| hit.distance_squared.sqrt())
                .fold(0.0, f64::max)
                / self.side;
            let off = (far > OFF_SURFACE).then(|| Finding::OffSurface {
                landmark: label.clone(),
                distance: far,
            });
            let reversed = self.is_reversed(cut);
            off.into_iter()
                .chain(reversed.then_some(Finding::CurveReversed { curve: label }))
        });
        findings.collect()
    }

    /// Whether the landmarks of the pair expect the ends of a curve exchanged.
    fn is_reversed(&self, cut: &[Landmark]) -> bool {
        if self.pairs.len() < ENOUGH_FOR_AFFINE {
            return false;
        }
        let map = Similarity::fit(&self.pairs);
        let rest = self.pair.source.rest();
        let rms = |targets: &mut dyn Iterator<Item = &Landmark>| {
            let pairs = cut.iter().zip(targets);
            let pairs = pairs.map(|(l, to)| PointPair::new(l.source.position(rest), to.target));
            map.rms(&pairs.collect::<Vec<_>>())
        };
        rms(&mut cut.iter().rev()) < REVERSED_GAIN * rms(&mut cut.iter())
    }

    /// Whether there are fewer than it takes. Without any, the pose is searched, and that says what was assumed.
    fn too_few(&self) -> Option<Finding> {
        // A curve leads as some landmarks do.
        let is_led = Curve::runs(&self.pair.landmarks).next().is_some();
        match self.pairs.len() {
            _ if is_led => None,
            0 => None,
            n if n < ENOUGH_FOR_AFFINE => Some(Finding::TooFew {
                n,
                least: ENOUGH_FOR_AFFINE,
            }),
            n if n < ENOUGH_TO_GUIDE => Some(Finding::Few { n }),
            _ => None,
        }
    }

    fn off_surface(&self) -> Vec<Finding> {
        let targets: Vec<Point3> = self.pairs.iter().map(|p| p.target).collect();
        let closest = self.target.closest_points(&targets);
        let far = closest
            .iter()
            .map(|c| c.distance_squared.sqrt())
            .enumerate();
        let far: Vec<(usize, f64)> = far
            .filter(|(_, distance)| *distance > OFF_SURFACE * self.side)
            .collect();
        let told = far.iter().take(MAX_TOLD);
        let mut findings: Vec<Finding> = told
            .map(|&(k, distance)| Finding::OffSurface {
                landmark: self.label(k),
                distance: distance / self.side,
            })
            .collect();
        let n = far.len().saturating_sub(MAX_TOLD);
        findings.extend((n > 0).then_some(Finding::MoreOffSurface { n }));
        findings
    }

    fn same_places(&self) -> Vec<Finding> {
        let (mut findings, mut n_more) = (Vec::new(), 0);
        for (j, b) in self.pairs.iter().enumerate().take(MOST_COMPARED) {
            for (i, a) in self.pairs[..j].iter().enumerate() {
                let same_source = (a.source - b.source).norm() <= SAME_PLACE * self.source_side;
                let same_target = (a.target - b.target).norm() <= SAME_PLACE * self.side;
                let on = match (same_source, same_target) {
                    (true, true) => Shared::Both,
                    (true, false) => Shared::SourceOnly,
                    (false, true) => Shared::TargetOnly,
                    (false, false) => continue,
                };
                if findings.len() < MAX_TOLD {
                    findings.push(Finding::SamePlace {
                        a: self.label(i),
                        b: self.label(j),
                        on,
                    });
                } else {
                    n_more += 1;
                }
            }
        }
        findings.extend((n_more > 0).then_some(Finding::MoreSamePlaces { n: n_more }));
        findings
    }

    /// Mirror images first, then exchanged pairs, then single landmarks that the others contradict.
    fn inconsistent(&self) -> Vec<Finding> {
        if self.pairs.len() < ENOUGH_FOR_AFFINE {
            return Vec::new();
        }
        let straight = Similarity::fit(&self.pairs);
        let mirrored = Similarity::fit_or_mirror(&self.pairs);
        if mirrored.is_mirror()
            && mirrored.rms(&self.pairs) < MIRROR_GAIN * straight.rms(&self.pairs)
        {
            return vec![Finding::Mirrored];
        }
        let mut pairs = self.pairs.clone();
        let mut findings = self.exchanges(&mut pairs);
        findings.extend(self.outlier(&pairs));
        findings
    }

    /// Exchanges landmarks of `pairs` as long as that makes them fit. Where one would fit better in space, the ways along
    /// the shapes decide, which no pose changes; where no ways join the landmarks, it is a question.
    fn exchanges(&self, pairs: &mut [PointPair]) -> Vec<Finding> {
        let mut findings = Vec::new();
        let most = MOST_EXCHANGES.min(pairs.len() / 2);
        let mut ways = None;
        while findings.len() < most {
            let Some(suspects) = exchanged(pairs) else {
                break;
            };
            let ways = ways.get_or_insert_with(|| Ways::of(self.pair));
            let Some([i, j]) = ways.as_ref().map_or(Some(suspects), Ways::exchanged) else {
                break;
            };
            let before = Similarity::fit(pairs).rms(pairs);
            exchange(pairs, [i, j]);
            if Similarity::fit(pairs).rms(pairs) >= before {
                exchange(pairs, [i, j]);
                break;
            }
            let (a, b) = (self.label(i), self.label(j));
            findings.push(match ways {
                Some(ways) => {
                    ways.exchange([i, j]);
                    Finding::Exchanged { a, b }
                }
                None => Finding::PerhapsExchanged { a, b },
            });
        }
        findings
    }

    /// The landmark without which the others fit best, if they then fit far better.
    fn outlier(&self, pairs: &[PointPair]) -> Option<Finding> {
        if pairs.len() < ENOUGH_TO_COMPARE {
            return None;
        }
        let unexpected = || self.unexpected(pairs);
        let (k, distance) = self.spoiler(pairs).or_else(unexpected)?;
        Some(Finding::Unexpected {
            landmark: self.label(k),
            distance,
        })
    }

    /// The landmark without which the others fit far better, and how far it is from where they expect it.
    fn spoiler(&self, pairs: &[PointPair]) -> Option<(usize, f64)> {
        if pairs.len() > ENOUGH_TO_COUNT_AS_ALL {
            return None;
        }
        let without = (0..pairs.len()).map(|k| {
            let (one, others) = leave_out(pairs, k);
            let map = Similarity::fit(&others);
            (map.rms(&others), k, map.miss(&one))
        });
        let (rms, k, miss) = without.min_by(|a, b| a.0.total_cmp(&b.0))?;
        // Where all fit exactly, one of them is the worst by rounding alone.
        let is_off = miss > SAME_PLACE * self.side;
        let is_far_better = is_off && rms < OUTLIER_GAIN * Similarity::fit(pairs).rms(pairs);
        is_far_better.then_some((k, miss / self.side))
    }

    /// The landmark that the others, agreeing well among themselves, expect elsewhere.
    fn unexpected(&self, pairs: &[PointPair]) -> Option<(usize, f64)> {
        let residuals = self.residuals(pairs);
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
        is_wrong.then_some((k, worst))
    }

    /// Distance of each pair from where the similarity of all others takes it, in longest sides.
    fn residuals(&self, pairs: &[PointPair]) -> Vec<f64> {
        if pairs.len() > ENOUGH_TO_COUNT_AS_ALL {
            let map = Similarity::fit(pairs);
            return pairs.iter().map(|p| map.miss(p) / self.side).collect();
        }
        let residual = |k| {
            let (one, others) = leave_out(pairs, k);
            Similarity::fit(&others).miss(&one) / self.side
        };
        (0..pairs.len()).map(residual).collect()
    }
}

/// Pair `k`, and the others.
fn leave_out(pairs: &[PointPair], k: usize) -> (PointPair, Vec<PointPair>) {
    let mut others = pairs.to_vec();
    let one = others.remove(k);
    (one, others)
}

/// Whether the similarity of all others wants both targets exchanged.
fn others_agree(pairs: &[PointPair], i: usize, j: usize) -> bool {
    let others = pairs.iter().enumerate().filter(|&(k, _)| k != i && k != j);
    let map = Similarity::fit(&others.map(|(_, p)| *p).collect::<Vec<_>>());
    let (a, b) = (pairs[i], pairs[j]);
    let exchanged = [
        PointPair {
            target: b.target,
            ..a
        },
        PointPair {
            target: a.target,
            ..b
        },
    ];
    [a, b]
        .iter()
        .zip(&exchanged)
        .all(|(before, after)| map.miss(after) < map.miss(before))
}

/// Exchanges the targets of two pairs.
fn exchange(pairs: &mut [PointPair], [i, j]: [usize; 2]) {
    (pairs[i].target, pairs[j].target) = (pairs[j].target, pairs[i].target);
}

/// The two pairs whose exchange lowers the misfit most, if it does so by enough.
fn exchanged(pairs: &[PointPair]) -> Option<[usize; 2]> {
    if !(ENOUGH_FOR_AFFINE + 1..=ENOUGH_TO_TRUST).contains(&pairs.len()) {
        return None;
    }
    let before = Similarity::fit(pairs).rms(pairs);
    let mut trial = pairs.to_vec();
    let mut best = (EXCHANGE_GAIN * before, None);
    for j in 1..pairs.len() {
        for i in 0..j {
            exchange(&mut trial, [i, j]);
            let after = Similarity::fit(&trial).rms(&trial);
            if after < best.0 && others_agree(pairs, i, j) {
                best = (after, Some([i, j]));
            }
            exchange(&mut trial, [i, j]);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::super::cut;
    use super::*;
    use crate::{Seams, Source, Target};
    use mesh_core::{shapes, MeshPoint, VertexId};

    /// Eight corners of a lopsided box on the target `2 x`, each marked.
    fn corners() -> Pair {
        let mut soup = shapes::quad_sphere(1);
        for p in &mut soup.positions {
            *p = Point3::new(p.x * (1.5 + 0.3 * p.y), p.y, p.z * (0.7 + 0.1 * p.x));
        }
        let source = Source::of_soup(soup.clone(), Seams::EXACT).unwrap();
        soup.positions.iter_mut().for_each(|p| *p *= 2.0);
        let rest = source.rest();
        let landmark = |v: VertexId| Landmark::new(v, rest[v] * 2.0);
        Pair {
            landmarks: rest.ids().map(landmark).collect(),
            source,
            target: Target::of_soup(soup).unwrap(),
        }
    }

    fn findings(change: impl Fn(&mut Vec<Landmark>)) -> Vec<Finding> {
        let mut pair = corners();
        change(&mut pair.landmarks);
        examine(&pair)
    }

    fn label(index: usize) -> Label {
        Label::new(index, None)
    }

    #[test]
    fn good_landmarks_are_left_alone() {
        assert!(findings(|_| ()).is_empty());
    }

    #[test]
    fn each_mistake_is_named() {
        let swapped = findings(|l| (l[1].target, l[6].target) = (l[6].target, l[1].target));
        let (a, b) = (label(1), label(6));
        assert_eq!(swapped, [Finding::Exchanged { a, b }]);
        assert_eq!(
            swapped[0].to_string(),
            "landmark 1 and landmark 6 are probably exchanged"
        );

        let mirrored = findings(|l| l.iter_mut().for_each(|l| l.target.x = -l.target.x));
        assert!(mirrored.contains(&Finding::Mirrored));

        let off = findings(|l| l[3].target *= 1.5);
        assert!(off
            .iter()
            .any(|f| matches!(f, Finding::OffSurface { landmark, .. } if *landmark == label(3))));

        let twice = findings(|l| l.push(l[0].clone()));
        let (a, b, on) = (label(0), label(8), Shared::Both);
        assert_eq!(twice, [Finding::SamePlace { a, b, on }]);

        let curve = |ends: [usize; 2]| {
            let mut pair = corners();
            let target = ends.map(|v| pair.source.rest()[VertexId::new(v)] * 2.0);
            let brow = Curve {
                name: Some("brow".to_owned()),
                source: [0, 1].map(|v| MeshPoint::vertex(VertexId::new(v))).into(),
                target: target.into(),
                weight: 1.0,
            };
            let cut = cut(brow, &pair.source).unwrap();
            pair.landmarks.extend(cut);
            examine(&pair)
        };
        assert!(curve([0, 1]).is_empty());
        let told = curve([1, 0])[0].to_string();
        assert!(
            told.starts_with("curve 0 (brow) probably runs the other way"),
            "{told}"
        );

        let few = findings(|l| l.truncate(3));
        assert_eq!(few[0], Finding::TooFew { n: 3, least: 4 });
        assert!(findings(Vec::clear).is_empty());
    }

    #[test]
    fn a_thousand_landmarks_on_eight_vertices_are_told_in_few_lines() {
        let many = findings(|l| {
            let eight = l.clone();
            (0..124).for_each(|_| l.extend(eight.clone()));
        });
        assert_eq!(many.len(), MAX_TOLD + 1, "{:?}", many.last());
        assert!(matches!(many.last(), Some(Finding::MoreSamePlaces { .. })));
    }

    #[test]
    fn a_contradicting_landmark_is_unexpected() {
        let wrong = findings(|l| l[2].target = Point3::from(-l[2].target.coords));
        let is_it =
            |f: &Finding| matches!(f, Finding::Unexpected { landmark, .. } if landmark.index == 2);
        assert!(wrong.iter().any(is_it), "{wrong:?}");
    }

    #[test]
    fn an_application_may_number_from_one() {
        let mut found = findings(|l| (l[1].target, l[6].target) = (l[6].target, l[1].target));
        found[0].labels_mut().for_each(|label| label.index += 1);
        assert_eq!(
            found[0].to_string(),
            "landmark 2 and landmark 7 are probably exchanged"
        );
    }
}
