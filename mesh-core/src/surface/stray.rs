//! Parts of a triangle soup that do not belong to its outer surface: slivers, fins, crumbs and inner walls.
//!
//! Slivers have no area, so nothing is lost without them; but they can be long, and a closest point on one that sticks
//! out is on no surface. The rest of a soup falls into patches, joined within by edges that exactly two triangles share.
//! One patch is usually the shape; what hangs on it at edges of three or more triangles, floats beside it, or is closed
//! in by it is not.

use super::orientation::escaping_share;
use super::welded::{is_degenerate, WeldedTriangles};
use crate::measure::{smallest_height, triangle_area, triangle_quality};
use crate::{Point3, TriangleBvh, UnionFind};

/// Nothing is called stray unless one patch holds at least this share of the area.
const MAIN_SHARE: f64 = 0.5;
/// Patches up to this share of the largest one's area are crumbs or, where they hang on others, fins.
const SMALL: f64 = 5e-3;
/// A patch from which fewer than this share of rays escapes, to either side, is hidden.
const SEEN: f64 = 0.02;
/// Slivers are lower than this share of the box's longest side: what single precision leaves of three points on a line.
const FLAT: f64 = 1e-6;
/// Slivers have a quality ([`triangle_quality`]) below this, however small they are.
const THIN: f64 = 1e-2;

/// Triangles that do not belong to the outer surface, by row, ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Strays {
    /// Without area, three corners on a line, and with a side that no other triangle shares.
    pub slivers: Vec<u32>,
    /// Of small sheets that hang on an edge of the surface or float beside it.
    pub crumbs: Vec<u32>,
    /// Of larger patches that no ray from outside reaches.
    pub hidden: Vec<u32>,
}

impl Strays {
    /// Whether everything belongs to the surface.
    pub fn is_empty(&self) -> bool {
        self.rows().next().is_none()
    }

    /// All of them.
    pub fn rows(&self) -> impl Iterator<Item = u32> + '_ {
        [&self.slivers, &self.crumbs, &self.hidden]
            .into_iter()
            .flatten()
            .copied()
    }

    /// The strays among the triangles of `bvh`.
    pub(super) fn of(bvh: &TriangleBvh) -> Self {
        let corners: Vec<_> = (0..bvh.len() as u32).map(|t| bvh.triangle(t)).collect();
        let positions: Vec<_> = corners.iter().flatten().copied().collect();
        let rows: Vec<[u32; 3]> = (0..corners.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
        let welded = WeldedTriangles::new(&positions, &rows);
        let mut strays = Self {
            slivers: slivers(&welded, &corners, FLAT * bvh.bounds().longest_side()),
            ..Self::default()
        };
        let patches = patches(&welded);
        let areas: Vec<f64> = patches
            .iter()
            .map(|patch| {
                patch
                    .iter()
                    .map(|&t| triangle_area(corners[t as usize]))
                    .sum()
            })
            .collect();
        let (total, largest) = areas
            .iter()
            .fold((0.0, 0.0f64), |(sum, most), &a| (sum + a, most.max(a)));
        if patches.len() < 2 || largest < MAIN_SHARE * total {
            strays.add_doubles(&welded);
            return strays;
        }
        for (patch, &area) in patches.iter().zip(&areas) {
            if area <= SMALL * largest {
                let is_new = |t: &&u32| strays.slivers.binary_search(t).is_err();
                strays.crumbs.extend(patch.iter().filter(is_new));
            } else if area < largest && is_hidden(bvh, patch) {
                strays.hidden.extend(patch);
            }
        }
        strays.add_doubles(&welded);
        strays
    }

    /// A double goes with its original.
    fn add_doubles(&mut self, welded: &WeldedTriangles) {
        for rows in [&mut self.slivers, &mut self.crumbs, &mut self.hidden] {
            rows.sort_unstable();
            let doubles: Vec<u32> = (0u32..)
                .zip(&welded.originals)
                .filter(|&(row, first)| row != *first && rows.binary_search(first).is_ok())
                .map(|(row, _)| row)
                .collect();
            rows.extend(doubles);
            rows.sort_unstable();
        }
    }
}

/// Triangles without area that hang free at a side, ascending; the others lie between their neighbours and do no harm.
fn slivers(welded: &WeldedTriangles, corners: &[[Point3; 3]], flat: f64) -> Vec<u32> {
    let is_flat = |t: u32| {
        let corners = corners[t as usize];
        smallest_height(corners) <= flat && triangle_quality(corners) < THIN
    };
    let free_sides = welded.edges().filter(|edge| edge.len() == 1).map(|e| e[0]);
    let mut slivers: Vec<u32> = free_sides
        .map(|side| side.face)
        .filter(|&t| is_flat(t))
        .collect();
    slivers.sort_unstable();
    slivers.dedup();
    slivers
}

/// Whether no ray leaves a patch to infinity, on either side.
fn is_hidden(bvh: &TriangleBvh, patch: &[u32]) -> bool {
    const N_RAYS: usize = 512;
    escaping_share(bvh, patch, N_RAYS) < SEEN
}

/// Triangles joined by edges that exactly two of them share, lowest first; doubles and degenerate ones left out.
fn patches(welded: &WeldedTriangles) -> Vec<Vec<u32>> {
    let mut sets = UnionFind::new(welded.triangles.len());
    for edge in welded.edges() {
        if let [a, b] = edge {
            sets.union(a.face as usize, b.face as usize);
        }
    }
    let is_proper =
        |t: usize| welded.originals[t] as usize == t && !is_degenerate(&welded.triangles[t]);
    let rows = |set: Vec<usize>| set.into_iter().map(|t| t as u32).collect();
    sets.sets(is_proper).into_iter().map(rows).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{shapes, Point3, PolygonSoup, TriangleSoup};

    /// `more` after the faces of `soup`, with its own vertices.
    fn joined(mut soup: PolygonSoup, more: PolygonSoup) -> PolygonSoup {
        soup.append(more);
        soup
    }

    fn scaled(mut soup: PolygonSoup, factor: f64) -> PolygonSoup {
        soup.positions.iter_mut().for_each(|p| *p *= factor);
        soup
    }

    fn strays(soup: PolygonSoup) -> Strays {
        TriangleSoup::new(soup).unwrap().strays()
    }

    #[test]
    fn whole_open_and_shattered_surfaces_have_none() {
        assert!(strays(shapes::icosphere(2)).is_empty());
        assert!(strays(shapes::open_grid(4, 4)).is_empty());
        let ball = shapes::icosphere(2);
        let mut shattered = PolygonSoup {
            positions: Vec::new(),
            faces: Vec::new(),
        };
        for face in &ball.faces {
            let n = shattered.positions.len() as u32;
            shattered
                .positions
                .extend(face.iter().map(|&v| ball.positions[v as usize] * 0.9));
            shattered.faces.push(vec![n, n + 1, n + 2]);
        }
        for (k, p) in shattered.positions.iter_mut().enumerate() {
            p.x += 1e-6 * k as f64;
        }
        assert!(strays(shattered).is_empty());
    }

    #[test]
    fn fins_crumbs_and_inner_walls_are_found() {
        let ball = shapes::icosphere(3);
        let n = ball.faces.len() as u32;
        let inner = scaled(shapes::icosphere(1), 0.5);
        let found = strays(joined(ball.clone(), inner));
        assert_eq!(found.hidden, (n..n + 80).collect::<Vec<_>>());
        assert!(found.crumbs.is_empty());

        let mut finned = ball.clone();
        finned.positions.push(Point3::from(
            ball.positions[ball.faces[0][0] as usize].coords * 1.05,
        ));
        let tip = finned.positions.len() as u32 - 1;
        let edge = [ball.faces[0][0], ball.faces[0][1]];
        finned.faces.push(vec![edge[0], edge[1], tip]);
        finned.faces.push(vec![tip, edge[1], edge[0]]);
        assert_eq!(strays(finned).crumbs, [n, n + 1]);

        let mut crumb = scaled(shapes::tetrahedron(), 0.03);
        crumb.positions.iter_mut().for_each(|p| p.x += 2.0);
        assert_eq!(
            strays(joined(ball, crumb)).crumbs,
            (n..n + 4).collect::<Vec<_>>()
        );
    }

    #[test]
    fn slivers_are_found_where_they_hang_free() {
        // Between two triangles, a third one closes the gap at a corner on its neighbour's side.
        let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.0, 0.0]].map(Point3::from);
        let [up, down, out] =
            [[0.5, 1.0, 0.0], [0.5, -1.0, 0.0], [0.5, 0.5, 1.0]].map(Point3::from);
        let faces = [[0, 1, 3], [0, 2, 1], [0, 4, 2], [2, 4, 1]];
        let mut soup = PolygonSoup {
            positions: vec![a, b, c, up, down],
            faces: faces.map(|f| f.to_vec()).to_vec(),
        };
        assert!(strays(soup.clone()).is_empty());
        // One that sticks out, and its double.
        soup.positions
            .extend([up, out, nalgebra::center(&up, &out)]);
        soup.faces.extend([vec![5, 6, 7], vec![7, 6, 5]]);
        assert_eq!(strays(soup).slivers, [4, 5]);
    }

    #[test]
    fn a_visible_second_piece_stays() {
        let mut beside = shapes::icosphere(2);
        beside.positions.iter_mut().for_each(|p| p.x += 2.5);
        assert!(strays(joined(shapes::icosphere(3), scaled(beside, 0.9))).is_empty());
    }
}
