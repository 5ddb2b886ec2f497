//! Signs for the normals of a point cloud.
//!
//! Neighbours are turned alike along a spanning tree of the graph of neighbours, the flattest places first (Hoppe et
//! al. 1992, "Surface reconstruction from unorganized points"). Each connected patch is then turned so that the volume
//! it encloses is positive.

use rayon::prelude::*;

use super::neighbourhood::{Neighbourhood, NONE};
use super::NormalSign;
use crate::{Point3, Vector3};

/// Normals of neighbours steeper than this to each other (cosine) say nothing about signs.
const STEEP: f64 = 0.5;
/// Share of neighbours that must agree, for signs to be taken from a file, and to be trusted at all.
const AGREEING: f64 = 0.98;
/// Outwardness needed to believe a sign, and to overrule a file whose signs agree.
const BELIEVED: f64 = 0.05;
const OVERRULING: f64 = 0.2;
/// Share of the area that must be decided.
const DECIDED: f64 = 0.9;

/// Turns the normals of `around` outwards; `are_given` if they come with signs from a file.
pub(super) fn orient(
    points: &[Point3],
    around: &mut [Neighbourhood],
    are_given: bool,
) -> NormalSign {
    let keeps_signs = are_given && agreement(around) >= AGREEING;
    let mut patches = Patches::new(around.len());
    for [a, b] in flattest_first(around) {
        let is_opposed = around[a as usize].normal.dot(&around[b as usize].normal) < 0.0;
        patches.join(a, b, !keeps_signs && is_opposed);
    }

    let turned: Vec<(u32, bool)> = (0..around.len() as u32)
        .map(|row| patches.find(row))
        .collect();
    for (n, &(_, is_flipped)) in around.iter_mut().zip(&turned) {
        if is_flipped {
            n.normal = -n.normal;
        }
    }
    let decided = turn_outwards(points, around, &turned, keeps_signs);
    if agreement(around) >= AGREEING && decided >= DECIDED {
        NormalSign::Oriented
    } else {
        NormalSign::Unoriented
    }
}

/// Share of the pairs of neighbours on one sheet whose normals point to the same side.
fn agreement(around: &[Neighbourhood]) -> f64 {
    let cosines = around.iter().flat_map(|n| {
        let nearest = n.nearest.iter().filter(|&&m| m != NONE);
        nearest.map(|&m| n.normal.dot(&around[m as usize].normal))
    });
    let (agree, all) = cosines
        .filter(|c| c.abs() > STEEP)
        .fold((0, 0), |(agree, all), c| {
            (agree + usize::from(c > 0.0), all + 1)
        });
    agree as f64 / all.max(1) as f64
}

/// Pairs of neighbours, the most nearly parallel normals first.
fn flattest_first(around: &[Neighbourhood]) -> Vec<[u32; 2]> {
    let mut pairs: Vec<(f32, [u32; 2])> = (0u32..)
        .zip(around)
        .flat_map(|(a, n)| {
            let nearest = n.nearest.iter().filter(move |&&b| b != NONE);
            nearest.map(move |&b| {
                let steepness = 1.0 - n.normal.dot(&around[b as usize].normal).abs();
                (steepness as f32, [a.min(b), a.max(b)])
            })
        })
        .collect();
    pairs.par_sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    pairs.into_iter().map(|(_, pair)| pair).collect()
}

/// Turns patches by the sign of `Σ A (p − c)·n`, three times the volume over the patch's center; returns the share of
/// the area where that is clear.
fn turn_outwards(
    points: &[Point3],
    around: &mut [Neighbourhood],
    turned: &[(u32, bool)],
    keeps_signs: bool,
) -> f64 {
    let mut sums = vec![Sums::default(); points.len()];
    for ((p, n), &(patch, _)) in points.iter().zip(around.iter()).zip(turned) {
        let sums = &mut sums[patch as usize];
        sums.area += n.area;
        sums.position += p.coords * n.area;
    }
    for ((p, n), &(patch, _)) in points.iter().zip(around.iter()).zip(turned) {
        let sums = &mut sums[patch as usize];
        let arm = p.coords - sums.position / sums.area;
        sums.volume += arm.dot(&n.normal) * n.area;
        sums.reach += arm.norm() * n.area;
    }

    let needed = if keeps_signs { OVERRULING } else { BELIEVED };
    for (n, &(patch, _)) in around.iter_mut().zip(turned) {
        let sums = &sums[patch as usize];
        if sums.volume < -needed * sums.reach {
            n.normal = -n.normal;
        }
    }
    let total: f64 = sums.iter().map(|s| s.area).sum();
    let is_decided = |s: &&Sums| keeps_signs || s.volume.abs() > needed * s.reach;
    sums.iter().filter(is_decided).map(|s| s.area).sum::<f64>() / total
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

/// Disjoint sets of points, each point with a sign relative to its set.
struct Patches {
    /// A parent, and whether the sign differs from the parent's.
    parents: Vec<(u32, bool)>,
    sizes: Vec<u32>,
}

impl Patches {
    fn new(n: usize) -> Self {
        Self {
            parents: (0..n as u32).map(|row| (row, false)).collect(),
            sizes: vec![1; n],
        }
    }

    /// The set of a point, and whether the point is flipped in it.
    fn find(&mut self, row: u32) -> (u32, bool) {
        let (mut root, mut is_flipped) = (row, false);
        while self.parents[root as usize].0 != root {
            let (parent, differs) = self.parents[root as usize];
            is_flipped ^= differs;
            root = parent;
        }
        let (mut at, mut rest) = (row, is_flipped);
        while at != root {
            let (parent, differs) = std::mem::replace(&mut self.parents[at as usize], (root, rest));
            rest ^= differs;
            at = parent;
        }
        (root, is_flipped)
    }

    /// Joins the sets of two points, which end up flipped alike unless they `differ`. One set is left alone.
    fn join(&mut self, a: u32, b: u32, differ: bool) {
        let ((a, a_flipped), (b, b_flipped)) = (self.find(a), self.find(b));
        if a == b {
            return;
        }
        let (small, large) = if self.sizes[a as usize] < self.sizes[b as usize] {
            (a, b)
        } else {
            (b, a)
        };
        self.parents[small as usize] = (large, a_flipped ^ b_flipped ^ differ);
        self.sizes[large as usize] += self.sizes[small as usize];
    }
}
