//! Distances along a target that may be no mesh: paths over a graph of neighbouring samples.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use mesh_core::sampling::SeededRng;
use mesh_core::{NormalSign, Patches, Point3, Rows, SurfaceSample, TargetSurface, Vector3};
use rayon::prelude::*;

/// A sample is joined to so many others, the nearest of its own side of the surface.
const N_NEIGHBOURS: usize = 12;
/// Candidates for them; those on the other side of a thin part are passed over.
const N_CANDIDATES: usize = 24;
/// Neighbours are at most this many patches apart along the surface.
const N_PATCHES: usize = 6;
/// A neighbour lies at most this steeply over the tangent plane: sine of the angle.
const STEEPEST: f64 = 0.75;

/// Samples of a target, their normals, and which are neighbours along it.
pub(super) struct SampleGraph {
    pub(super) points: Vec<Point3>,
    pub(super) normals: Vec<Vector3>,
    /// Whether the signs of the normals mean something.
    pub(super) is_oriented: bool,
    /// Row and distance of each neighbour.
    neighbours: Rows<(u32, f64)>,
}

impl SampleGraph {
    /// `n` samples of `target`, fewer where it is degenerate.
    pub(super) fn new(target: &dyn TargetSurface, n: usize) -> Self {
        let samples = target.sample(n, &mut SeededRng::new(0));
        let with_normal = samples
            .into_iter()
            .filter_map(|s| Some((s, target.normal(&s.location)?)));
        let (samples, normals): (Vec<SurfaceSample>, Vec<Vector3>) = with_normal.unzip();
        let points: Vec<Point3> = samples.iter().map(|s| s.point).collect();
        let is_oriented = target.normal_sign() == NormalSign::Oriented;
        let joints = Joints {
            points: &points,
            normals: &normals,
            is_oriented,
            patches: target.patches(&samples),
        };
        Self {
            neighbours: joints.neighbours(),
            points,
            normals,
            is_oriented,
        }
    }

    /// The row of the sample nearest to `p`; none where there is no sample.
    pub(super) fn nearest(&self, p: &Point3) -> Option<usize> {
        let squared = |row: &usize| (self.points[*row] - p).norm_squared();
        (0..self.points.len()).min_by(|a, b| squared(a).total_cmp(&squared(b)))
    }

    /// The length of the shortest path from `start` to each sample; infinite where none leads.
    pub(super) fn distances(&self, start: &Point3) -> Vec<f64> {
        let mut distance = vec![f64::INFINITY; self.points.len()];
        // Distances are ≥ 0, and the bits of such numbers are ordered as the numbers are.
        let mut queue = BinaryHeap::new();
        // The place itself is joined to the nearest sample and to those around it.
        if let Some(nearest) = self.nearest(start) {
            let around = self.neighbours[nearest].iter().map(|&(row, _)| row);
            for row in std::iter::once(nearest as u32).chain(around) {
                let d = (self.points[row as usize] - start).norm();
                distance[row as usize] = d;
                queue.push(Reverse((d.to_bits(), row)));
            }
        }
        while let Some(Reverse((bits, row))) = queue.pop() {
            let d = f64::from_bits(bits);
            if d > distance[row as usize] {
                continue;
            }
            for &(next, length) in &self.neighbours[row as usize] {
                let through = d + length;
                if through < distance[next as usize] {
                    distance[next as usize] = through;
                    queue.push(Reverse((through.to_bits(), next)));
                }
            }
        }
        distance
    }
}

/// What tells which samples are neighbours.
struct Joints<'a> {
    points: &'a [Point3],
    normals: &'a [Vector3],
    is_oriented: bool,
    /// None of a cloud.
    patches: Option<Patches>,
}

impl Joints<'_> {
    /// The neighbours of each sample and their distances; whoever has another for a neighbour is one of its.
    fn neighbours(&self) -> Rows<(u32, f64)> {
        let n = self.points.len();
        let mut lists: Vec<Vec<(u32, f64)>> =
            (0..n).into_par_iter().map(|i| self.nearest(i)).collect();
        for i in 0..n {
            for (j, length) in lists[i].clone() {
                let other = &mut lists[j as usize];
                if other.iter().all(|&(k, _)| k as usize != i) {
                    other.push((i as u32, length));
                }
            }
        }
        Rows::from_lists(lists)
    }

    /// The nearest samples that hang together with sample `i`, on its own side of the surface.
    fn nearest(&self, i: usize) -> Vec<(u32, f64)> {
        let squared = |j: usize| (self.points[j] - self.points[i]).norm_squared();
        let all = 0..self.points.len();
        let mut near: Vec<(f64, u32)> = all.map(|j| (squared(j), j as u32)).collect();
        let order = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        let n = N_CANDIDATES.min(near.len() - 1);
        near.select_nth_unstable_by(n, order);
        near.truncate(n + 1);
        near.sort_unstable_by(order);
        let around = self.around(i);
        let is_neighbour = |&(_, j): &(f64, u32)| {
            let j = j as usize;
            j != i && self.lies_beside(i, j) && self.hangs_together(i, j, &around)
        };
        let kept = near.into_iter().filter(is_neighbour).take(N_NEIGHBOURS);
        kept.map(|(squared, j)| (j, squared.sqrt())).collect()
    }

    /// The patches around that of sample `i`; none of a cloud.
    fn around(&self, i: usize) -> Vec<u32> {
        let around = |p: &Patches| p.within(p.of_place(i), N_PATCHES);
        self.patches.as_ref().map(around).unwrap_or_default()
    }

    /// Whether two samples lie in each other's tangent planes, more or less, and on the same side of the surface.
    fn lies_beside(&self, i: usize, j: usize) -> bool {
        let along = self.points[j] - self.points[i];
        let [n, m] = [self.normals[i], self.normals[j]];
        let is_flat = |n: &Vector3| along.dot(n).abs() <= STEEPEST * along.norm();
        (!self.is_oriented || n.dot(&m) >= 0.0) && is_flat(&n) && is_flat(&m)
    }

    /// Whether a short way along the surface leads from sample `i` to sample `j`, or both lie where it is cut open: such
    /// samples, and those of a cloud, hang together as far as space tells.
    fn hangs_together(&self, i: usize, j: usize, around: &[u32]) -> bool {
        self.patches.as_ref().is_none_or(|patches| {
            let [own, other] = [i, j].map(|place| patches.of_place(place));
            around.binary_search(&other).is_ok()
                || patches.ends_openly(own) && patches.ends_openly(other)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, PointCloud, TriangleSoup};

    /// Two balls pressed into each other: the ways along one do not lead over the other.
    #[test]
    fn no_path_leads_from_one_part_to_another_that_it_runs_through() {
        let mut soup = shapes::icosphere(4);
        let mut beside = soup.clone();
        let aside = Vector3::x() * 1.5;
        beside.positions.iter_mut().for_each(|p| *p += aside);
        soup.append(beside);
        let graph = SampleGraph::new(&TriangleSoup::new(soup).unwrap(), 2000);
        let reached = graph.distances(&Point3::new(-1.0, 0.0, 0.0));
        for (p, d) in graph.points.iter().zip(reached) {
            let is_own = (p.coords.norm() - 1.0).abs() < 5e-3;
            let is_other = ((p - Vector3::x() * 1.5).coords.norm() - 1.0).abs() < 5e-3;
            assert!(is_own == is_other || d.is_finite() == is_own, "{p} {d}");
        }
    }

    /// On the unit sphere the way from pole to pole is π long, over a mesh and over the points of a cloud.
    #[test]
    fn paths_run_along_the_surface() {
        let soup = shapes::icosphere(4);
        let cloud = PointCloud::new(soup.positions.clone(), None).unwrap();
        let mesh = TriangleSoup::new(soup).unwrap();
        let targets: [&dyn TargetSurface; 2] = [&mesh, &cloud];
        for target in targets {
            let graph = SampleGraph::new(target, 2000);
            let pole = Point3::new(0.0, 1.0, 0.0);
            let far = graph.nearest(&Point3::new(0.0, -1.0, 0.0)).unwrap();
            let length = graph.distances(&pole)[far];
            assert!((3.0..3.5).contains(&length), "{length}");
        }
    }

    /// Two sheets that nearly touch are far from each other along the surface.
    #[test]
    fn no_path_leads_through_a_gap() {
        let mut soup = shapes::open_grid(20, 20);
        let mut above = soup.clone();
        let lift = Vector3::z() * 0.02;
        above.positions.iter_mut().for_each(|p| *p += lift);
        above.faces.iter_mut().for_each(|face| face.reverse());
        soup.append(above);
        let graph = SampleGraph::new(&TriangleSoup::new(soup).unwrap(), 2000);
        let start = graph.points[0];
        let is_same = |p: &Point3| (p.z > 0.01) == (start.z > 0.01);
        for (p, d) in graph.points.iter().zip(graph.distances(&start)) {
            assert_eq!(d.is_finite(), is_same(p), "{p}");
        }
    }
}
