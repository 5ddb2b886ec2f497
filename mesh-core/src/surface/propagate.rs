//! Signs for the normals of a point cloud.
//!
//! Neighbours are turned alike along a spanning tree of the graph of neighbours, the flattest places first (Hoppe et
//! al. 1992, "Surface reconstruction from unorganized points"). Each connected patch is then turned so that the volume
//! it encloses is positive.

use rayon::prelude::*;

use super::neighbourhood::{Neighbourhood, NONE};
use super::NormalSign;
use crate::{Point3, UnionFind, Vector3};

/// Neighbours steeper than this to each other say nothing about signs.
const STEEP: f64 = 0.7;
/// Share of neighbours that must agree, for signs to be taken from a file, and to be trusted at all.
const AGREEING: f64 = 0.98;
/// Outwardness of a patch needed to overrule a file whose signs agree.
const OVERRULING: f64 = 0.2;
/// Share of the points that must lie on the outer side of the rest, for signs to be trusted.
const OUTWARD: f64 = 0.95;
/// Points where that is measured, and points that are taken for the rest.
const N_PROBES: usize = 1 << 10;
const N_SOURCES: usize = 1 << 14;

/// Turns the normals of `around` outwards; `are_given` if they come with signs from a file.
pub(super) fn orient(
    points: &[Point3],
    around: &mut [Neighbourhood],
    are_given: bool,
) -> NormalSign {
    let keeps_signs = are_given && agreement(points, around) >= AGREEING;
    let mut patches = UnionFind::new(around.len());
    for [a, b] in flattest_first(points, around) {
        let is_opposed = around[a as usize].normal.dot(&around[b as usize].normal) < 0.0;
        patches.union_signed(a as usize, b as usize, !keeps_signs && is_opposed);
    }

    let turned: Vec<(usize, bool)> = (0..around.len())
        .map(|row| patches.find_signed(row))
        .collect();
    for (n, &(_, is_flipped)) in around.iter_mut().zip(&turned) {
        if is_flipped {
            n.normal = -n.normal;
        }
    }
    turn_outwards(points, around, &turned, keeps_signs);

    let is_trusted = keeps_signs
        || (agreement(points, around) >= AGREEING && outward_share(points, around) >= OUTWARD);
    if is_trusted {
        NormalSign::Oriented
    } else {
        NormalSign::Unoriented
    }
}

/// Share of points that lie where the cloud, seen as a surface of outward normals, winds around by a positive share.
///
/// `w(p) = Σ A n·(q − p) / (4π |q − p|³)` over the other points q; ½ on a closed surface turned outwards, −½ where a
/// part is turned inwards, 0 on a flat sheet (after Barill et al. 2018). Measured on a few points only.
fn outward_share(points: &[Point3], around: &[Neighbourhood]) -> f64 {
    let every = |n: usize| (0..points.len()).step_by(points.len().div_ceil(n));
    let winding = |p: &Point3| {
        let sources = every(N_SOURCES).map(|row| {
            let arm = points[row] - p;
            let volume = around[row].area * arm.dot(&around[row].normal);
            let cube = arm.norm_squared().powf(1.5);
            if cube > 0.0 {
                volume / cube
            } else {
                0.0
            }
        });
        sources.sum::<f64>()
    };
    let probes: Vec<usize> = every(N_PROBES).collect();
    let is_outside = |&&row: &&usize| winding(&points[row]) > 0.0;
    let n_outside = probes.par_iter().filter(is_outside).count();
    n_outside as f64 / probes.len() as f64
}

/// Share of the pairs of neighbours on one sheet whose normals point to the same side.
fn agreement(points: &[Point3], around: &[Neighbourhood]) -> f64 {
    let (agree, all) = pairs(around)
        .filter(|&pair| steepness(points, around, pair) < STEEP)
        .map(|[a, b]| around[a as usize].normal.dot(&around[b as usize].normal))
        .fold((0u32, 0u32), |(agree, all), cosine| {
            (agree + u32::from(cosine > 0.0), all + 1)
        });
    f64::from(agree) / f64::from(all.max(1))
}

/// Each point with each of its nearest.
fn pairs(around: &[Neighbourhood]) -> impl Iterator<Item = [u32; 2]> + '_ {
    (0u32..).zip(around).flat_map(|(a, n)| {
        let nearest = n.nearest.iter().filter(|&&b| b != NONE);
        nearest.map(move |&b| [a, b])
    })
}

/// How far two neighbours are from lying on one flat sheet: 0 if they do, 1 and more across an edge or a thin gap.
///
/// `1 − |m·n| + max(|d·m|, |d·n|) / |d|` with the normals m, n and the offset d.
fn steepness(points: &[Point3], around: &[Neighbourhood], [a, b]: [u32; 2]) -> f64 {
    let [m, n] = [a, b].map(|row| around[row as usize].normal);
    let d = points[b as usize] - points[a as usize];
    let offset = d.dot(&m).abs().max(d.dot(&n).abs());
    let length = d.norm();
    let slope = if length > 0.0 { offset / length } else { 0.0 };
    1.0 - m.dot(&n).abs() + slope
}

/// Pairs of neighbours, the least steep first.
fn flattest_first(points: &[Point3], around: &[Neighbourhood]) -> Vec<[u32; 2]> {
    let weighted = pairs(around).map(|[a, b]| {
        let pair = [a.min(b), a.max(b)];
        (steepness(points, around, pair) as f32, pair)
    });
    let mut weighted: Vec<(f32, [u32; 2])> = weighted.collect();
    weighted.par_sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    weighted.into_iter().map(|(_, pair)| pair).collect()
}

/// Turns patches so that `Σ A (p − c)·n`, three times the volume over the center c of the patch, is positive.
fn turn_outwards(
    points: &[Point3],
    around: &mut [Neighbourhood],
    turned: &[(usize, bool)],
    keeps_signs: bool,
) {
    let mut sums = vec![Sums::default(); points.len()];
    for ((p, n), &(patch, _)) in points.iter().zip(around.iter()).zip(turned) {
        let sums = &mut sums[patch];
        sums.area += n.area;
        sums.position += p.coords * n.area;
    }
    for ((p, n), &(patch, _)) in points.iter().zip(around.iter()).zip(turned) {
        let sums = &mut sums[patch];
        let arm = p.coords - sums.position / sums.area;
        sums.volume += arm.dot(&n.normal) * n.area;
        sums.reach += arm.norm() * n.area;
    }

    let needed = if keeps_signs { OVERRULING } else { 0.0 };
    for (n, &(patch, _)) in around.iter_mut().zip(turned) {
        let sums = &sums[patch];
        if sums.volume < -needed * sums.reach {
            n.normal = -n.normal;
        }
    }
}

/// Over one patch.
#[derive(Clone, Default)]
struct Sums {
    area: f64,
    /// Integral of the position.
    position: Vector3,
    /// Three times the volume towards the center.
    volume: f64,
    /// Integral of the distance from the center.
    reach: f64,
}
