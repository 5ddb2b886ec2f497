//! The affine map that brings landmarks to their places, as far as they determine one.

use mesh_core::{Point3, UnitFrame, Vector3};
use nalgebra::{Matrix3, Rotation3, Unit};

/// Points that spread less than this share of the box along an axis do not determine the map along it.
const MIN_SPREAD: f64 = 1e-6;
/// Priors that leave-one-out chooses from, as squared lengths in boxes of longest side 1.
const PRIORS: [f64; 7] = [0.0, 1e-3, 1e-2, 1e-1, 1.0, 10.0, f64::INFINITY];
/// The strongest prior is taken whose left-out error is within this factor of the least.
const TIE: f64 = 1.02;

/// A place on the source and where it belongs on the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointPair {
    /// In the source's coordinates.
    pub source: Point3,
    /// In the target's coordinates.
    pub target: Point3,
    /// What it counts, in pairs, > 0.
    pub weight: f64,
}

impl PointPair {
    /// A pair that counts as one.
    pub fn new(source: Point3, target: Point3) -> Self {
        Self {
            source,
            target,
            weight: 1.0,
        }
    }
}

/// What lengths are measured in, and what is laid over each other where pairs are too few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePair {
    /// Frame of the source.
    pub source: UnitFrame,
    /// Frame of the target.
    pub target: UnitFrame,
}

/// How an affine map is kept near the best similarity (rotation, uniform scale, translation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SimilarityPrior {
    /// Not at all: least squares over all twelve unknowns, as in the paper.
    None,
    /// As strongly as predicts left-out landmarks best; all the way where an affine map predicts them no better.
    ///
    /// Few or nearly coplanar landmarks leave an axis of the map to their noise, and limbs that turn flatten the body
    /// they belong to: both show in landmarks that the others fail to predict.
    LeaveOneOut,
    /// All the way: the best similarity.
    Full,
}

/// How much of an affine map the landmarks determined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AffineKind {
    /// Four or more landmarks, not in one plane: all twelve unknowns.
    Affine,
    /// Landmarks in one plane: rotation, uniform scale and translation.
    Similarity,
    /// Landmarks on one line: the least rotation that turns it, uniform scale and translation.
    SimilarityOfLine,
    /// Landmarks at one place: translation, with the scale of the boxes.
    Translation,
    /// No landmark: box on box, with one scale.
    Bounds,
}

/// An affine map fitted to landmarks: `p ↦ matrix · p + translation`.
#[derive(Clone, Debug, PartialEq)]
pub struct AffineFit {
    /// The linear part.
    pub matrix: Matrix3<f64>,
    /// Where the origin goes.
    pub translation: Vector3,
    /// How much of it the landmarks determined.
    pub kind: AffineKind,
    /// Distance of each landmark to its place after the map, in the target's units.
    pub residuals: Vec<f64>,
}

impl AffineFit {
    /// Where the map takes `p`.
    pub fn apply(&self, p: &Point3) -> Point3 {
        Point3::from(self.matrix * p.coords + self.translation)
    }

    /// Whether the map turns left into right: landmarks are probably swapped.
    pub fn is_mirroring(&self) -> bool {
        self.matrix.determinant() < 0.0
    }
}

/// Least-squares affine map from `source` to `target` of every pair, or as much of one as the pairs determine.
///
/// `A = (B + μ S)(C + μ I)⁻¹` with `C = Σ w c cᵀ`, `B = Σ w d cᵀ` over the centred pairs and `S` the best similarity
/// (Umeyama 1991), which never mirrors. `μ` is given by `prior`. In boxes of longest side 1, so units do not
/// matter. Fewer or degenerate pairs: see [`AffineKind`]. Source: Mesh Draping, Correspondence Setup. Departures: the
/// prior, and maps for fewer than four landmarks.
pub fn fit_affine(pairs: &[PointPair], frames: FramePair, prior: SimilarityPrior) -> AffineFit {
    let frames = Frames::of(frames);
    let unit = frames.to_unit(pairs);
    let map = match prior {
        SimilarityPrior::None => UnitMap::fit(&Moments::of(&unit), 0.0),
        SimilarityPrior::Full => UnitMap::fit(&Moments::of(&unit), f64::INFINITY),
        SimilarityPrior::LeaveOneOut => UnitMap::fit(&Moments::of(&unit), best_prior(&unit)),
    };
    let (matrix, translation) = frames.with_units(&map);
    let residual =
        |p: &PointPair| (matrix * p.source.coords + translation - p.target.coords).norm();
    AffineFit {
        matrix,
        translation,
        kind: map.kind,
        residuals: pairs.iter().map(residual).collect(),
    }
}

/// A pair that counts as `weight` pairs, in boxes of longest side 1.
pub(crate) struct WeightedPair {
    pub(crate) source: Vector3,
    pub(crate) target: Vector3,
    pub(crate) weight: f64,
}

/// Matrix and translation of the map of least squares, drawn to a similarity by `mu`.
pub(crate) fn least_squares(
    pairs: impl Iterator<Item = WeightedPair>,
    mu: f64,
) -> (Matrix3<f64>, Vector3) {
    let (mut moments, mut total) = (Moments::of(&[]), 0.0);
    for WeightedPair {
        source,
        target,
        weight,
    } in pairs
    {
        let pair = UnitPair {
            source,
            target,
            weight,
        };
        moments = moments.plus(&pair, 1.0);
        total += weight;
    }
    // The prior is a length: it counts against the mean of the pairs, whatever their number.
    let map = UnitMap::fit(&moments, mu * total);
    (map.linear, map.translation)
}

fn best_prior(unit: &[UnitPair]) -> f64 {
    let squared = |mu: f64| {
        left_out_errors(unit, mu)
            .zip(unit)
            .map(|(e, p)| e * e * p.weight)
    };
    let errors = PRIORS.map(|mu| squared(mu).sum::<f64>().sqrt());
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let strongest = PRIORS
        .iter()
        .zip(errors)
        .rev()
        .find(|(_, e)| *e <= TIE * least);
    strongest.map_or(f64::INFINITY, |(&mu, _)| mu)
}

fn left_out_errors(unit: &[UnitPair], mu: f64) -> impl Iterator<Item = f64> + '_ {
    let all = Moments::of(unit);
    unit.iter().map(move |pair| {
        let map = UnitMap::fit(&all.without(pair), mu);
        (map.linear * pair.source + map.translation - pair.target).norm()
    })
}

/// A pair in boxes that are centred at the origin with longest side 1.
struct UnitPair {
    source: Vector3,
    target: Vector3,
    weight: f64,
}

struct Frames {
    source_center: Vector3,
    source_scale: f64,
    target_center: Vector3,
    target_scale: f64,
}

impl Frames {
    fn of(frames: FramePair) -> Self {
        let FramePair { source, target } = frames;
        Self {
            source_center: source.center.coords,
            source_scale: source.scale,
            target_center: target.center.coords,
            target_scale: target.scale,
        }
    }

    fn to_unit(&self, pairs: &[PointPair]) -> Vec<UnitPair> {
        let unit = |p: &PointPair| UnitPair {
            source: (p.source.coords - self.source_center) / self.source_scale,
            target: (p.target.coords - self.target_center) / self.target_scale,
            weight: p.weight,
        };
        pairs.iter().map(unit).collect()
    }

    fn with_units(&self, map: &UnitMap) -> (Matrix3<f64>, Vector3) {
        let matrix = map.linear * (self.target_scale / self.source_scale);
        let moved = map.translation * self.target_scale + self.target_center;
        (matrix, moved - matrix * self.source_center)
    }
}

/// Sums over pairs from which every map here follows; a pair can be taken out again.
#[derive(Clone)]
struct Moments {
    n: f64,
    source: Vector3,
    target: Vector3,
    source_source: Matrix3<f64>,
    target_source: Matrix3<f64>,
    target_target: f64,
}

impl Moments {
    fn of(pairs: &[UnitPair]) -> Self {
        let zero = Self {
            n: 0.0,
            source: Vector3::zeros(),
            target: Vector3::zeros(),
            source_source: Matrix3::zeros(),
            target_source: Matrix3::zeros(),
            target_target: 0.0,
        };
        pairs.iter().fold(zero, |sum, pair| sum.plus(pair, 1.0))
    }

    fn without(&self, pair: &UnitPair) -> Self {
        self.clone().plus(pair, -1.0)
    }

    fn plus(self, pair: &UnitPair, sign: f64) -> Self {
        let (p, q, counted) = (pair.source, pair.target, pair.weight * sign);
        Self {
            n: self.n + counted,
            source: self.source + p * counted,
            target: self.target + q * counted,
            source_source: self.source_source + p * p.transpose() * counted,
            target_source: self.target_source + q * p.transpose() * counted,
            target_target: self.target_target + q.norm_squared() * counted,
        }
    }
}

/// A map between unit boxes.
struct UnitMap {
    linear: Matrix3<f64>,
    translation: Vector3,
    kind: AffineKind,
}

impl UnitMap {
    fn fit(moments: &Moments, mu: f64) -> Self {
        if moments.n <= 0.0 {
            return Self {
                linear: Matrix3::identity(),
                translation: Vector3::zeros(),
                kind: AffineKind::Bounds,
            };
        }
        let (source, target) = (moments.source / moments.n, moments.target / moments.n);
        let c = moments.source_source - source * source.transpose() * moments.n;
        let b = moments.target_source - target * source.transpose() * moments.n;
        let target_spread = moments.target_target - target.norm_squared() * moments.n;
        let (linear, kind) = linear_part(&c, &b, target_spread, mu);
        Self {
            linear,
            translation: target - linear * source,
            kind,
        }
    }
}

/// The linear part from `C = Σ c cᵀ`, `B = Σ d cᵀ`, `Σ |d|²` and the prior.
fn linear_part(
    c: &Matrix3<f64>,
    b: &Matrix3<f64>,
    target_spread: f64,
    mu: f64,
) -> (Matrix3<f64>, AffineKind) {
    let spread = c.symmetric_eigenvalues();
    let floor = MIN_SPREAD * MIN_SPREAD;
    let n_axes = spread.iter().filter(|&&s| s > floor).count();
    if n_axes == 0 || target_spread <= floor {
        return (Matrix3::identity(), AffineKind::Translation);
    }
    if n_axes == 1 {
        return (
            turned_line(b, target_spread, spread.max()),
            AffineKind::SimilarityOfLine,
        );
    }
    let similarity = umeyama(c, b);
    if n_axes == 2 {
        return (similarity, AffineKind::Similarity);
    }
    let regular = if mu.is_finite() {
        (c + Matrix3::identity() * mu).try_inverse()
    } else {
        None
    };
    let linear = regular.map_or(similarity, |inverse| (b + similarity * mu) * inverse);
    (linear, AffineKind::Affine)
}

/// Rotation and scale nearest to the pairs: `R = U diag(1, 1, ±1) Vᵀ`, `s = tr(D Σ) / tr C`.
fn umeyama(c: &Matrix3<f64>, b: &Matrix3<f64>) -> Matrix3<f64> {
    let rotation = mesh_core::nearest_rotation(b);
    let scale = (rotation.transpose() * b).trace() / c.trace();
    rotation * scale.max(MIN_SPREAD)
}

/// The least rotation that turns the line of the sources into that of the targets, with their scale.
fn turned_line(b: &Matrix3<f64>, target_spread: f64, source_spread: f64) -> Matrix3<f64> {
    // B = |c| |d| (target direction)(source direction)ᵀ, the one singular pair it has.
    let svd = b.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Matrix3::identity();
    };
    let largest = svd.singular_values.imax();
    let (to, from) = (u.column(largest).into_owned(), v_t.row(largest).transpose());
    let rotation = Rotation3::rotation_between(&from, &to).unwrap_or_else(|| half_turn(&from));
    rotation.matrix() * (target_spread / source_spread).sqrt()
}

/// A half turn that reverses `direction`.
fn half_turn(direction: &Vector3) -> Rotation3<f64> {
    let axis = if direction.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    Rotation3::from_axis_angle(
        &Unit::new_normalize(direction.cross(&axis)),
        std::f64::consts::PI,
    )
}
