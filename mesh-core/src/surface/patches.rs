//! A surface divided among places on it: which parts of it hang together.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::SurfaceSample;
use crate::{Point3, Rows, TriangleFans, VertexId};

/// The patch of triangles that no place reaches.
const NONE: u32 = u32::MAX;

/// A surface divided into patches of triangles, one around each triangle with a place on it; places on one triangle share
/// their patch. Patches are neighbours where they share a corner, so that parts which only pass each other are far apart,
/// however near in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Patches {
    of_place: Vec<u32>,
    /// The patches at each corner that more than one has.
    at_corner: Rows<u32>,
    /// Such corners of each patch.
    corners: Rows<u32>,
    ends_openly: Vec<bool>,
}

impl Patches {
    /// Divides triangles among places: each joins the patch that comes nearest to it along shared edges, in the order of
    /// the straight distances between its middle and the places. Every place must name a row of a triangle.
    pub(super) fn new(
        fans: &TriangleFans,
        corners: impl Fn(u32) -> [Point3; 3],
        places: &[SurfaceSample],
    ) -> Self {
        let mut growth = Growth::new(fans.triangles().len());
        let of_place = places.iter().map(|place| growth.seed(place)).collect();
        growth.fill(fans, corners);
        let n_vertices = fans.triangles().iter().flatten();
        let n_vertices = n_vertices.map(|v| v.index() + 1).max().unwrap_or(0);
        let meeting = (0..n_vertices).map(|v| {
            let around = fans.at_vertex(VertexId::new(v)).iter();
            let mut patches: Vec<u32> = around.map(|&row| growth.patch_at[row as usize]).collect();
            patches.sort_unstable();
            patches.dedup();
            patches.retain(|&patch| patch != NONE);
            patches
        });
        let at_corner: Vec<Vec<u32>> = meeting.filter(|patches| patches.len() > 1).collect();
        let pairs = (0u32..).zip(&at_corner);
        let pairs = pairs.flat_map(|(corner, all)| all.iter().map(move |&p| (p as usize, corner)));
        Self {
            of_place,
            corners: Rows::from_pairs(growth.seeds.len(), pairs),
            at_corner: Rows::from_lists(at_corner),
            ends_openly: growth.ends_openly,
        }
    }

    /// The patch of a place, in the order of the places it was made for.
    pub fn of_place(&self, place: usize) -> u32 {
        self.of_place[place]
    }

    /// The patches within `n_steps` steps over shared corners from `patch`, itself among them, ascending.
    pub fn within(&self, patch: u32, n_steps: usize) -> Vec<u32> {
        let mut is_found = vec![false; self.corners.len()];
        let mut is_passed = vec![false; self.at_corner.len()];
        is_found[patch as usize] = true;
        let mut found = vec![patch];
        let mut done = 0;
        for _ in 0..n_steps {
            let end = found.len();
            for k in done..end {
                for &corner in &self.corners[found[k] as usize] {
                    if !std::mem::replace(&mut is_passed[corner as usize], true) {
                        let around = self.at_corner[corner as usize].iter().copied();
                        found.extend(
                            around.filter(|&p| !std::mem::replace(&mut is_found[p as usize], true)),
                        );
                    }
                }
            }
            done = end;
        }
        found.sort_unstable();
        found
    }

    /// Whether an edge of a single triangle lies in `patch`: the surface may go on behind it, as behind a crack.
    pub fn ends_openly(&self, patch: u32) -> bool {
        self.ends_openly[patch as usize]
    }
}

/// Patches as they grow.
struct Growth {
    patch_at: Vec<u32>,
    seeds: Vec<Point3>,
    ends_openly: Vec<bool>,
    /// Triangles to be reached, the nearest first: distance as bits, row, patch.
    queue: BinaryHeap<Reverse<(u64, u32, u32)>>,
}

impl Growth {
    fn new(n_triangles: usize) -> Self {
        Self {
            patch_at: vec![NONE; n_triangles],
            seeds: Vec::new(),
            ends_openly: Vec::new(),
            queue: BinaryHeap::new(),
        }
    }

    /// The patch of a place: a new one where its triangle has none.
    fn seed(&mut self, place: &SurfaceSample) -> u32 {
        let row = place.location.row();
        let patch = &mut self.patch_at[row as usize];
        if *patch == NONE {
            *patch = self.seeds.len() as u32;
            self.seeds.push(place.point);
            self.ends_openly.push(false);
            self.queue.push(Reverse((0, row, *patch)));
        }
        *patch
    }

    /// Gives every triangle that edges lead to its patch, and tells which patches end openly.
    fn fill(&mut self, fans: &TriangleFans, corners: impl Fn(u32) -> [Point3; 3]) {
        let middle = |row: u32| {
            let [a, b, c] = corners(row);
            Point3::from((a.coords + b.coords + c.coords) / 3.0)
        };
        let mut is_done = vec![false; self.patch_at.len()];
        while let Some(Reverse((_, row, patch))) = self.queue.pop() {
            if std::mem::replace(&mut is_done[row as usize], true) {
                continue;
            }
            self.patch_at[row as usize] = patch;
            for edge in 0..3 {
                let mut is_open = true;
                for other in across(fans, row, edge) {
                    is_open = false;
                    if self.patch_at[other as usize] == NONE {
                        // Distances are ≥ 0, and the bits of such numbers are ordered as the numbers are.
                        let distance = (middle(other) - self.seeds[patch as usize]).norm();
                        self.queue.push(Reverse((distance.to_bits(), other, patch)));
                    }
                }
                self.ends_openly[patch as usize] |= is_open;
            }
        }
    }
}

/// The other triangles at the edge of triangle `row` that runs from corner `edge` to the next.
fn across(fans: &TriangleFans, row: u32, edge: usize) -> impl Iterator<Item = u32> + '_ {
    let corners = fans.triangles()[row as usize];
    let (tail, head) = (corners[edge], corners[(edge + 1) % 3]);
    let others = fans.at_vertex(tail).iter().copied();
    others.filter(move |&other| other != row && fans.triangles()[other as usize].contains(&head))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::SeededRng;
    use crate::{shapes, TargetSurface, TriangleSoup, Vector3};

    fn patches(target: &TriangleSoup) -> (Vec<SurfaceSample>, Patches) {
        let places = target.sample(300, &mut SeededRng::new(0));
        let patches = target.patches(&places).unwrap();
        (places, patches)
    }

    #[test]
    fn from_any_patch_of_a_ball_all_are_reached_and_none_ends_openly() {
        let target = TriangleSoup::new(shapes::icosphere(4)).unwrap();
        let (places, patches) = patches(&target);
        for place in [0, 150, 299] {
            let near = patches.within(patches.of_place(place), 1);
            assert!((4..20).contains(&near.len()), "{}", near.len());
            let all = patches.within(patches.of_place(place), 100);
            assert!((0..places.len()).all(|p| all.contains(&patches.of_place(p))));
            assert!(!patches.ends_openly(patches.of_place(place)));
        }
    }

    /// Two sheets that nearly touch; their rims are open.
    #[test]
    fn parts_that_only_touch_are_no_neighbours() {
        let mut soup = shapes::open_grid(20, 20);
        let mut above = soup.clone();
        let lift = Vector3::z() * 1e-3;
        above.positions.iter_mut().for_each(|p| *p += lift);
        soup.append(above);
        let (places, patches) = patches(&TriangleSoup::new(soup).unwrap());
        let is_above = |p: usize| places[p].point.z > 5e-4;
        let all = patches.within(patches.of_place(0), 100);
        for p in 0..places.len() {
            let is_reached = all.contains(&patches.of_place(p));
            assert_eq!(is_reached, is_above(p) == is_above(0));
        }
        let n_open = (0..places.len()).filter(|&p| patches.ends_openly(patches.of_place(p)));
        assert!((40..250).contains(&n_open.count()));
    }

    /// Of a soup of single triangles every patch is one, open all around.
    #[test]
    fn single_triangles_end_openly() {
        let ball = shapes::icosphere(3);
        let corners = ball.faces.iter().flatten();
        let mut soup = crate::PolygonSoup {
            positions: corners.map(|&v| ball.positions[v as usize]).collect(),
            faces: (0..ball.faces.len() as u32)
                .map(|f| vec![3 * f, 3 * f + 1, 3 * f + 2])
                .collect(),
        };
        for (k, p) in soup.positions.iter_mut().enumerate() {
            *p += Vector3::x() * 1e-6 * (k / 3) as f64;
        }
        let (_, patches) = patches(&TriangleSoup::new(soup).unwrap());
        for place in [0, 150, 299] {
            let patch = patches.of_place(place);
            assert!(patches.ends_openly(patch));
            assert_eq!(patches.within(patch, 5), [patch]);
        }
    }
}
