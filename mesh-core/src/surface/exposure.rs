//! Which triangles rays from outside can reach.

use rayon::prelude::*;

use super::orientation::escapes;
use super::orientation::LIFT;
use crate::TriangleBvh;

/// Whether any of `n_rays` rays from the front of each triangle escapes to infinity, in row order; from the back, if
/// that lets more than half of them see the outside where the front does not.
///
/// The rays start at places spread over the triangle, in directions with density proportional to the cosine. What no
/// ray reaches is inside: the lining of a closed mouth, teeth, the back of an eyeball. A surface turned inside out is
/// seen from its back.
pub fn is_exposed(bvh: &TriangleBvh, n_rays: usize) -> Vec<bool> {
    let front = exposed_side(bvh, n_rays, 1.0);
    let n_seen = |side: &[bool]| side.iter().filter(|&&seen| seen).count();
    if 2 * n_seen(&front) >= bvh.len() {
        return front;
    }
    let back = exposed_side(bvh, n_rays, -1.0);
    if n_seen(&back) > n_seen(&front) {
        back
    } else {
        front
    }
}

fn exposed_side(bvh: &TriangleBvh, n_rays: usize, side: f64) -> Vec<bool> {
    let lift = LIFT * bvh.bounds().diagonal();
    (0..bvh.len() as u32)
        .into_par_iter()
        .with_min_len(64)
        .map(|t| (0..n_rays).any(|k| escapes(bvh, t, side, lift, k)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{shapes, PolygonSoup, Triangulation};

    fn exposed(soup: PolygonSoup) -> Vec<bool> {
        let (mesh, x) = soup.into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &x);
        is_exposed(&TriangleBvh::new(triangulation.corners(&x).collect()), 32)
    }

    #[test]
    fn a_ball_in_a_ball_is_hidden_and_the_outer_one_is_seen() {
        let mut soup = shapes::icosphere(2);
        let (n, outer) = (soup.positions.len() as u32, soup.faces.len());
        let inner = shapes::icosphere(1);
        soup.positions
            .extend(inner.positions.iter().map(|p| p * 0.4));
        let moved = inner
            .faces
            .iter()
            .map(|f| f.iter().map(|v| v + n).collect());
        soup.faces.extend(moved);
        let seen = exposed(soup);
        assert!(seen[..outer].iter().all(|&s| s));
        assert!(seen[outer..].iter().all(|&s| !s));
    }

    #[test]
    fn inside_out_and_open_surfaces_are_seen() {
        let mut soup = shapes::icosphere(2);
        soup.faces.iter_mut().for_each(|f| f.reverse());
        assert!(exposed(soup).iter().all(|&s| s));
        assert!(exposed(shapes::open_grid(3, 3)).iter().all(|&s| s));
    }
}
