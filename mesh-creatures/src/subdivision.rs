//! Catmull and Clark's subdivision of closed quad meshes, and the smooth surface that it ends at.

use mesh_core::{Point3, Vector3};

use crate::skin::Skin;

/// One step of subdivision: the new faces, and each new vertex as a weighted mean of old ones.
///
/// New vertices are the old ones (in order), then one for each edge, then one for each face. Face `[a, b, c, d]` becomes
/// `[a, ab, m, da]`, `[b, bc, m, ab]` and so on.
///
/// Source: Catmull and Clark 1978.
pub(crate) struct Refinement {
    pub(crate) faces: Vec<[u32; 4]>,
    stencils: Vec<Vec<(u32, f64)>>,
    n_vertices: usize,
    edges: Vec<[u32; 2]>,
    old_faces: Vec<[u32; 4]>,
}

impl Refinement {
    /// # Panics
    /// If an edge is not shared by exactly two faces.
    pub(crate) fn new(n_vertices: usize, faces: &[[u32; 4]]) -> Self {
        let edges = edges(faces);
        let row = |a: u32, b: u32| {
            let found = edges.binary_search(&[a.min(b), a.max(b)]);
            (n_vertices + found.expect("every side of a face is an edge")) as u32
        };
        let middle = |f: usize| (n_vertices + edges.len() + f) as u32;
        let split = |(f, v): (usize, &[u32; 4])| {
            [0, 1, 2, 3].map(|k| {
                let [at, next, last] = [v[k], v[(k + 1) % 4], v[(k + 3) % 4]];
                [at, row(at, next), middle(f), row(last, at)]
            })
        };
        Self {
            faces: faces.iter().enumerate().flat_map(split).collect(),
            stencils: stencils(n_vertices, &edges, faces),
            n_vertices,
            edges,
            old_faces: faces.to_vec(),
        }
    }

    pub(crate) fn apply(&self, positions: &[Point3]) -> Vec<Point3> {
        let sum = |stencil: &Vec<(u32, f64)>| weighted(positions, stencil);
        self.stencils.iter().map(sum).collect()
    }

    pub(crate) fn blend(&self, skins: &[Skin]) -> Vec<Skin> {
        let mixed = |stencil: &Vec<(u32, f64)>| {
            Skin::mixed(stencil.iter().map(|&(v, w)| (&skins[v as usize], w)))
        };
        self.stencils.iter().map(mixed).collect()
    }

    /// The new vertex of an old vertex, or of the edge or face between old vertices.
    ///
    /// # Panics
    /// If there is no such edge or face.
    pub(crate) fn row_of_middle(&self, element: &[u32]) -> u32 {
        let row = match *element {
            [v] => Some(v as usize),
            [a, b] => {
                let found = self.edges.binary_search(&[a.min(b), a.max(b)]);
                found.ok().map(|e| self.n_vertices + e)
            }
            _ => {
                let is_it = |f: &[u32; 4]| element.iter().all(|v| f.contains(v));
                let found = self.old_faces.iter().position(is_it);
                found.map(|f| self.n_vertices + self.edges.len() + f)
            }
        };
        row.expect("the element is one of the mesh") as u32
    }
}

fn weighted(positions: &[Point3], stencil: &[(u32, f64)]) -> Point3 {
    let terms = stencil
        .iter()
        .map(|&(v, w)| positions[v as usize].coords * w);
    Point3::from(terms.sum::<Vector3>())
}

/// Every edge once, lower vertex first, in order.
fn edges(faces: &[[u32; 4]]) -> Vec<[u32; 2]> {
    let sides = faces.iter().flat_map(|f| {
        (0..4).map(|k| {
            let (a, b) = (f[k], f[(k + 1) % 4]);
            [a.min(b), a.max(b)]
        })
    });
    let mut edges: Vec<[u32; 2]> = sides.collect();
    edges.sort_unstable();
    assert!(
        edges
            .chunks(2)
            .all(|pair| pair.len() == 2 && pair[0] == pair[1]),
        "closed"
    );
    edges.dedup();
    edges
}

/// For each new vertex the old ones it is a mean of.
fn stencils(n_vertices: usize, edges: &[[u32; 2]], faces: &[[u32; 4]]) -> Vec<Vec<(u32, f64)>> {
    let mut valence = vec![0.0; n_vertices];
    edges
        .iter()
        .flatten()
        .for_each(|&v| valence[v as usize] += 1.0);
    let mut of_vertices: Vec<Vec<(u32, f64)>> = (0..n_vertices)
        .map(|v| vec![(v as u32, (valence[v] - 2.0) / valence[v])])
        .collect();
    let mut of_edges: Vec<Vec<(u32, f64)>> = edges
        .iter()
        .map(|e| e.iter().map(|&v| (v, 0.25)).collect())
        .collect();
    for &[a, b] in edges {
        for (v, w) in [(a, b), (b, a)] {
            of_vertices[v as usize].push((w, 1.0 / valence[v as usize].powi(2)));
        }
    }
    for f in faces {
        for k in 0..4 {
            let (a, b) = (f[k], f[(k + 1) % 4]);
            let e = edges.binary_search(&[a.min(b), a.max(b)]).unwrap_or(0);
            of_edges[e].extend(f.iter().map(|&v| (v, 1.0 / 16.0)));
            let share = 0.25 / valence[a as usize].powi(2);
            of_vertices[a as usize].extend(f.iter().map(|&v| (v, share)));
        }
    }
    let of_faces = faces.iter().map(|f| f.iter().map(|&v| (v, 0.25)).collect());
    of_vertices
        .into_iter()
        .chain(of_edges)
        .chain(of_faces)
        .collect()
}

/// Where the vertices of a closed quad mesh end when it is subdivided for ever:
/// `(n² v + 4 Σ eᵢ + Σ fᵢ) / n(n + 5)`, over the `n` neighbours `e` and the `n` vertices `f` across the faces.
///
/// Source: Halstead, Kass and DeRose 1993.
pub(crate) fn limit(positions: &[Point3], faces: &[[u32; 4]]) -> Vec<Point3> {
    let mut valence = vec![0.0; positions.len()];
    let mut sums = vec![Vector3::zeros(); positions.len()];
    for f in faces {
        for k in 0..4 {
            let [next, across, last] = [1, 2, 3].map(|j| positions[f[(k + j) % 4] as usize].coords);
            let v = f[k] as usize;
            valence[v] += 1.0;
            // Every neighbour is met in two faces.
            sums[v] += (next + last) * 2.0 + across;
        }
    }
    let ends = positions.iter().zip(valence.iter().zip(&sums));
    ends.map(|(p, (&n, sum))| Point3::from((p.coords * (n * n) + sum) / (n * (n + 5.0))))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::shapes;

    fn cube() -> (Vec<Point3>, Vec<[u32; 4]>) {
        let soup = shapes::quad_sphere(1);
        let quads = soup.faces.iter().map(|f| [f[0], f[1], f[2], f[3]]);
        (soup.positions, quads.collect())
    }

    #[test]
    fn every_stencil_sums_to_one() {
        let (positions, faces) = cube();
        let refinement = Refinement::new(positions.len(), &faces);
        assert_eq!(refinement.stencils.len(), 8 + 12 + 6);
        for stencil in &refinement.stencils {
            let sum: f64 = stencil.iter().map(|s| s.1).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        }
    }

    // The limit of a vertex is that of the same vertex one level finer.
    #[test]
    fn limits_agree_between_levels() {
        let (positions, faces) = cube();
        let refinement = Refinement::new(positions.len(), &faces);
        let finer = refinement.apply(&positions);
        let [coarse, fine] = [limit(&positions, &faces), limit(&finer, &refinement.faces)];
        for (p, q) in coarse.iter().zip(&fine) {
            assert!((p - q).norm() < 1e-12, "{p} {q}");
        }
    }

    #[test]
    fn middles_are_found() {
        let (positions, faces) = cube();
        let refinement = Refinement::new(positions.len(), &faces);
        let fine = refinement.apply(&positions);
        let f = faces[2];
        let row = refinement.row_of_middle(&f) as usize;
        let mean = f
            .iter()
            .map(|&v| positions[v as usize].coords)
            .sum::<Vector3>()
            / 4.0;
        assert!((fine[row].coords - mean).norm() < 1e-12);
        assert_eq!(refinement.row_of_middle(&[5]), 5);
    }
}
