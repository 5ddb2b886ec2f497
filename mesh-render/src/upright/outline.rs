//! A shape as points that know their neighbours on it.

use mesh_core::sampling::{SeededRng, TriangleSampler};
use mesh_core::{measure, Aabb, Point3, Positions, Rows, Triangulation};
use mesh_draping::Target;

/// A piece with this share of the area or more stands for a mesh of several pieces.
const MAIN_PIECE: f64 = 0.9;
/// Points on a mesh whose pieces are brought together by cells.
const N_SAMPLES: usize = 40_000;
/// Cells along the longest side, the finest first.
const N_CELLS: [i32; 6] = [48, 36, 28, 20, 14, 10];
/// Points in a cell, on the mean, at least: fewer leave gaps.
const POINTS_IN_CELL: usize = 4;

/// Points of a shape, and for each the rows of its neighbours.
pub(super) struct Outline {
    pub(super) points: Vec<Point3>,
    pub(super) neighbours: Rows<u32>,
    /// Whether each lies on the rim of an opening; unknown, no, for cells.
    pub(super) is_rim: Vec<bool>,
}

impl Outline {
    /// The vertices and edges of a mesh, if nearly all of it is one piece; else its pieces brought together by cells.
    pub(super) fn of_mesh(triangulation: &Triangulation, positions: &Positions) -> Self {
        let areas = measure::triangle_areas(triangulation, positions);
        let pieces = triangulation.pieces();
        let mut piece_areas = vec![0.0; pieces.n];
        for (corners, area) in triangulation.triangles().iter().zip(&areas) {
            piece_areas[pieces.of_vertex[corners[0].index()] as usize] += area;
        }
        let larger = |a: usize, b: usize| {
            if piece_areas[b] > piece_areas[a] {
                b
            } else {
                a
            }
        };
        let main = (0..pieces.n).fold(0, larger);
        let is_main = |v: usize| pieces.of_vertex[v] as usize == main;
        if piece_areas
            .get(main)
            .is_some_and(|&a| a >= MAIN_PIECE * areas.iter().sum::<f64>())
        {
            return Self::of_piece(triangulation, positions, is_main);
        }
        let corners: Vec<[Point3; 3]> = triangulation.corners(positions).collect();
        let places = TriangleSampler::new(areas).sample(N_SAMPLES, &mut SeededRng::new(0));
        let points: Vec<Point3> = places
            .iter()
            .map(|&(t, weights)| {
                let terms = corners[t].iter().zip(weights).map(|(p, w)| p.coords * w);
                Point3::from(terms.sum::<mesh_core::Vector3>())
            })
            .collect();
        Self::of_points(&points)
    }

    /// A target: its faces as a mesh, or the points of its cloud that were kept.
    pub(super) fn of_target(target: &Target) -> Self {
        let points = target.kept_points();
        if !points.is_empty() {
            return Self::of_points(&points.into_iter().map(|(p, _)| p).collect::<Vec<_>>());
        }
        // A target holds no face that names a vertex that is not there, so that this never fails.
        let Ok((mesh, positions)) = target.soup().weld(0.0).soup.into_halfedge() else {
            return Self::of_points(&[]);
        };
        Self::of_mesh(&Triangulation::new(&mesh, &positions), &positions)
    }

    /// The vertices of one piece.
    fn of_piece(
        triangulation: &Triangulation,
        positions: &Positions,
        is_main: impl Fn(usize) -> bool,
    ) -> Self {
        let mut rows = vec![0u32; positions.len()];
        let (mut points, mut is_rim) = (Vec::new(), Vec::new());
        for v in triangulation.used_vertices().filter(|v| is_main(v.index())) {
            rows[v.index()] = points.len() as u32;
            points.push(positions[v]);
            is_rim.push(triangulation.is_boundary_vertex(v));
        }
        let ends = triangulation
            .edges()
            .iter()
            .filter(|[a, _]| is_main(a.index()));
        let pairs = ends.flat_map(|&[a, b]| {
            let [a, b] = [a, b].map(|v| rows[v.index()]);
            [(a as usize, b), (b as usize, a)]
        });
        Self {
            neighbours: Rows::from_pairs(points.len(), pairs),
            points,
            is_rim,
        }
    }

    /// The middles of the cells that hold points, neighbours where cells touch.
    fn of_points(points: &[Point3]) -> Self {
        let bounds = Aabb::of(points);
        let cells_of = |n: i32| {
            let size = bounds.longest_side() / f64::from(n);
            let row = |x: f64| ((x / size) as i32).min(n - 1);
            let mut cells: Vec<[i32; 3]> = points
                .iter()
                .map(|p| p - bounds.min)
                .map(|d| [row(d.x), row(d.y), row(d.z)])
                .collect();
            cells.sort_unstable();
            cells.dedup();
            cells
        };
        let is_filled = |cells: &Vec<[i32; 3]>| cells.len() * POINTS_IN_CELL <= points.len();
        let cells = N_CELLS.iter().map(|&n| cells_of(n)).find(is_filled);
        let cells = cells.unwrap_or_default();
        let neighbours = Rows::from_lists(cells.iter().map(|cell| touching(cell, &cells)));
        let middles = cells.iter().map(|c| c.map(f64::from).into());
        Self {
            points: middles.collect(),
            neighbours,
            is_rim: vec![false; cells.len()],
        }
    }
}

/// The rows of the cells that touch `cell`, among cells in order.
fn touching(cell: &[i32; 3], cells: &[[i32; 3]]) -> Vec<u32> {
    let steps = (0..27).map(|k| [k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1]);
    steps
        .filter(|step| *step != [0; 3])
        .filter_map(|step| {
            let other = [0, 1, 2].map(|k| cell[k] + step[k]);
            cells.binary_search(&other).ok().map(|row| row as u32)
        })
        .collect()
}
