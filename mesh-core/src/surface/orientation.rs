//! Which side of each triangle is outside.
//!
//! Triangles that share an edge are turned alike; each connected patch then turns the side outwards from which more
//! rays escape (after Takayama et al. 2014, "A simple method for correcting facet orientations in polygon meshes
//! based on ray casting"). The order of corners in the file is trusted where neighbours agree and no ray objects.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::welded::WeldedTriangles;
use super::NormalSign;
use crate::bvh::TriangleBvh;
use crate::measure::{area_vector, triangle_area};
use crate::{Point3, Vector3};

/// No neighbour across a side.
const NONE: u32 = u32::MAX;
/// Rays to each side, for all patches together, and the fewest and most for each.
const N_RAYS: usize = 1 << 17;
const FEWEST_RAYS: usize = 8;
const MOST_RAYS: usize = 1 << 12;
/// Rays start this far off the surface, in diagonals of its box.
pub(super) const LIFT: f64 = 1e-7;
/// Shares of a patch's rays by which one side must win: to be believed, and to overrule a file whose faces agree.
const BELIEVED: f64 = 0.05;
const OVERRULING: f64 = 0.2;
/// Share of the area that must be decided for normals to be trusted, and share of edges that may disagree.
const DECIDED: f64 = 0.9;
const DISAGREEING: f64 = 0.01;
/// Share of the shared sides that must run against each other for a file to be believed.
const AGREEING: f64 = 0.95;

/// Which triangles turn the other way than their corners say, and whether the result can be trusted.
pub(super) struct Orientation {
    pub(super) is_flipped: Vec<bool>,
    pub(super) sign: NormalSign,
}

/// A neighbour across a side, and whether both run the same way around.
#[derive(Clone, Copy)]
struct Neighbour {
    triangle: u32,
    agrees: bool,
}

impl Orientation {
    /// Orients the triangles of `bvh`.
    pub(super) fn new(welded: &WeldedTriangles, bvh: &TriangleBvh) -> Self {
        let neighbours = neighbours(welded);
        let (n_agreeing, n_shared) = agreement(&neighbours);
        let file_agrees =
            n_shared >= welded.triangles.len() && n_agreeing as f64 >= AGREEING * n_shared as f64;
        let mut is_flipped = vec![false; welded.triangles.len()];
        let patches = flood(welded, &neighbours, &mut is_flipped);
        let n_conflicts = conflicts(&neighbours, &is_flipped);

        let areas: Vec<f64> = (0..bvh.len())
            .map(|t| triangle_area(bvh.triangle(t as u32)))
            .collect();
        let total: f64 = areas.iter().sum();
        let verdicts: Vec<(f64, f64)> = patches
            .par_iter()
            .map(|patch| {
                let n = (N_RAYS / patches.len()).clamp(FEWEST_RAYS, MOST_RAYS);
                verdict(bvh, patch, &areas, n, &is_flipped)
            })
            .collect();

        let mut decided = 0.0;
        for (patch, (share, area)) in patches.iter().zip(verdicts) {
            let needed = if file_agrees { OVERRULING } else { BELIEVED };
            if share < -needed {
                patch.iter().for_each(|&t| is_flipped[t as usize] ^= true);
            }
            if file_agrees || share.abs() > needed {
                decided += area;
            }
        }
        copy_to_doubles(welded, &mut is_flipped);
        let is_trusted =
            decided >= DECIDED * total && n_conflicts as f64 <= DISAGREEING * n_shared as f64;
        Self {
            is_flipped,
            sign: if is_trusted {
                NormalSign::Oriented
            } else {
                NormalSign::Unoriented
            },
        }
    }
}

/// The triangle across each side, where exactly two share the edge.
fn neighbours(welded: &WeldedTriangles) -> Vec<[Neighbour; 3]> {
    let none = Neighbour {
        triangle: NONE,
        agrees: true,
    };
    let mut neighbours = vec![[none; 3]; welded.triangles.len()];
    for edge in welded.edges() {
        if let [a, b] = edge {
            let agrees = a.is_forward != b.is_forward;
            for (one, other) in [(a, b), (b, a)] {
                neighbours[one.face as usize][one.corner as usize] = Neighbour {
                    triangle: other.face,
                    agrees,
                };
            }
        }
    }
    neighbours
}

/// How many of the shared sides run as they should, of how many.
fn agreement(neighbours: &[[Neighbour; 3]]) -> (usize, usize) {
    let shared = || neighbours.iter().flatten().filter(|n| n.triangle != NONE);
    (shared().filter(|n| n.agrees).count(), shared().count())
}

/// Patches connected by shared edges, lowest triangle first, turned alike, as most of each are in the file.
fn flood(
    welded: &WeldedTriangles,
    neighbours: &[[Neighbour; 3]],
    is_flipped: &mut [bool],
) -> Vec<Vec<u32>> {
    let mut is_seen: Vec<bool> = (0u32..)
        .zip(&welded.originals)
        .map(|(row, &first)| row != first)
        .collect();
    let mut patches = Vec::new();
    for start in 0..neighbours.len() as u32 {
        if std::mem::replace(&mut is_seen[start as usize], true) {
            continue;
        }
        let mut patch = vec![start];
        let mut next = 0;
        while let Some(&t) = patch.get(next) {
            next += 1;
            for n in neighbours[t as usize].iter().filter(|n| n.triangle != NONE) {
                if !std::mem::replace(&mut is_seen[n.triangle as usize], true) {
                    is_flipped[n.triangle as usize] = is_flipped[t as usize] ^ !n.agrees;
                    patch.push(n.triangle);
                }
            }
        }
        keep_most(&patch, is_flipped);
        patches.push(patch);
    }
    patches
}

/// Turns a patch so that most of it is as in the file.
fn keep_most(patch: &[u32], is_flipped: &mut [bool]) {
    let n_flipped = patch.iter().filter(|&&t| is_flipped[t as usize]).count();
    if 2 * n_flipped > patch.len() {
        patch.iter().for_each(|&t| is_flipped[t as usize] ^= true);
    }
}

/// Shared sides whose triangles cannot be turned alike: a Möbius band has some.
fn conflicts(neighbours: &[[Neighbour; 3]], is_flipped: &[bool]) -> usize {
    let conflicts = |t: usize| {
        let shared = neighbours[t].iter().filter(|n| n.triangle != NONE);
        shared
            .filter(|n| (is_flipped[t] == is_flipped[n.triangle as usize]) != n.agrees)
            .count()
    };
    (0..neighbours.len()).map(conflicts).sum()
}

/// By what share of its rays the outer side of a patch wins, between −1 and 1, and the area of the patch.
fn verdict(
    bvh: &TriangleBvh,
    patch: &[u32],
    areas: &[f64],
    n: usize,
    is_flipped: &[bool],
) -> (f64, f64) {
    let mut cumulative = Vec::with_capacity(patch.len());
    let mut area = 0.0;
    for &t in patch {
        area += areas[t as usize];
        cumulative.push(area);
    }
    if area <= 0.0 {
        return (0.0, 0.0);
    }
    let lift = LIFT * bvh.bounds().diagonal();
    let votes = (0..n).into_par_iter().map(|k| {
        let at = area * (k as f64 + 0.5) / n as f64;
        let t = patch[cumulative.partition_point(|&c| c < at).min(patch.len() - 1)];
        vote(bvh, t, is_flipped[t as usize], lift, k)
    });
    (votes.sum::<i64>() as f64 / n as f64, area)
}

/// Which share of `n` rays from a patch, half of them to each side, escapes to infinity.
pub(super) fn escaping_share(bvh: &TriangleBvh, patch: &[u32], n: usize) -> f64 {
    let areas: Vec<f64> = patch
        .iter()
        .scan(0.0, |sum, &t| {
            *sum += triangle_area(bvh.triangle(t));
            Some(*sum)
        })
        .collect();
    let area = areas.last().copied().unwrap_or(0.0);
    let lift = LIFT * bvh.bounds().diagonal();
    let escaped = (0..n).into_par_iter().filter(|&k| {
        let at = area * (k as f64 + 0.5) / n as f64;
        let t = patch[areas.partition_point(|&c| c < at).min(patch.len() - 1)];
        escapes(bvh, t, if k % 2 == 0 { 1.0 } else { -1.0 }, lift, k)
    });
    escaped.count() as f64 / n.max(1) as f64
}

/// Whether the `k`-th ray from triangle `t` escapes on the side of its corners' order (`side` 1) or the other (−1).
pub(super) fn escapes(bvh: &TriangleBvh, t: u32, side: f64, lift: f64, k: usize) -> bool {
    let corners = bvh.triangle(t);
    let Some(normal) = area_vector(corners).try_normalize(f64::MIN_POSITIVE) else {
        return false;
    };
    let [a, b, c, d] = spread(k);
    let (from, slant) = (
        on_triangle(&corners, a, b),
        slanted(&normal, &corners, c, d),
    );
    bvh.first_hit(&(from + normal * (side * lift)), &(slant * side))
        .is_none()
}

/// 1 if a ray escapes in front only, −1 if behind only.
fn vote(bvh: &TriangleBvh, t: u32, is_flipped: bool, lift: f64, k: usize) -> i64 {
    let corners = bvh.triangle(t);
    let Some(normal) = area_vector(corners).try_normalize(f64::MIN_POSITIVE) else {
        return 0;
    };
    let normal = if is_flipped { -normal } else { normal };
    let [a, b, c, d] = spread(k);
    let from = on_triangle(&corners, a, b);
    let slant = slanted(&normal, &corners, c, d);
    let escapes = |sign: f64| {
        bvh.first_hit(&(from + normal * (sign * lift)), &(slant * sign))
            .is_none()
    };
    i64::from(escapes(1.0)) - i64::from(escapes(-1.0))
}

/// The `k`-th point of a sequence that fills the unit cube of four dimensions evenly.
///
/// Source: Roberts 2018, "The unreasonable effectiveness of quasirandom sequences": multiples of the powers of 1/g,
/// where g⁵ = g + 1.
fn spread(k: usize) -> [f64; 4] {
    const G: f64 = 1.167_303_978_261_418_7;
    [1, 2, 3, 4].map(|power| (0.5 + (k as f64 + 1.0) / G.powi(power)).fract())
}

/// Even over the triangle when `a` and `b` are even over 0..1.
fn on_triangle([p, q, r]: &[Point3; 3], a: f64, b: f64) -> Point3 {
    let root = a.sqrt();
    p + (q - p) * (root * (1.0 - b)) + (r - p) * (root * b)
}

/// A direction on the side of `normal` of a triangle, with density proportional to the cosine; it turns with the triangle.
fn slanted(normal: &Vector3, [p, q, _]: &[Point3; 3], c: f64, d: f64) -> Vector3 {
    // A triangle with a normal has three sides.
    let across = (q - p).try_normalize(0.0).unwrap_or_default();
    let along = normal.cross(&across);
    let (radius, angle) = (c.sqrt(), TAU * d);
    across * (radius * angle.cos()) + along * (radius * angle.sin()) + normal * (1.0 - c).sqrt()
}

/// A double faces the same way as its original.
fn copy_to_doubles(welded: &WeldedTriangles, is_flipped: &mut [bool]) {
    for (row, &original) in welded.originals.iter().enumerate() {
        if original as usize != row {
            let (t, first) = (welded.triangles[row], welded.triangles[original as usize]);
            let runs_alike =
                (0..3).any(|k| [first[k], first[(k + 1) % 3], first[(k + 2) % 3]] == t);
            is_flipped[row] = is_flipped[original as usize] ^ !runs_alike;
        }
    }
}
