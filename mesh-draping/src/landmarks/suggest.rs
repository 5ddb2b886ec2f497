//! Where one more landmark would help most.

use mesh_core::{Landmark, Point3, VertexData, VertexId};
use mesh_operators::geodesic_distance_unfolded;

use crate::initial::{initial_deformation, InitialMethod};
use crate::{Error, Pair};

/// A place to mark next.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// On the source.
    pub vertex: VertexId,
    /// The place of the target nearest to where the landmarks so far bring the vertex: a first guess.
    pub target: Point3,
    /// Distance along the source to the nearest landmark, in longest sides of its box; infinite on a piece without.
    pub alone: f64,
    /// How far the initial deformation misses the target there, in longest sides of the target's box.
    pub missed: f64,
}

/// A place as far from all landmarks as this counts as much as one that is missed by the same share.
const MISS_WEIGHT: f64 = 2.0;

/// The `n` most useful places, the first for the landmarks as they are, each next one as if those before were marked.
///
/// A vertex is worth its geodesic distance to the nearest landmark and twice the distance by which the initial
/// deformation misses the target, each as a share of the longest side of its box.
///
/// # Errors
/// The initial deformation cannot be found.
pub fn suggest(pair: &Pair, n: usize) -> Result<Vec<Suggestion>, Error> {
    let (source, target) = (&pair.source, pair.target.judged());
    let initial = initial_deformation(pair, InitialMethod::Standard)?.positions;
    let side = target.bounds().longest_side();
    let hits = target.closest_points(initial.as_slice());
    let missed: VertexData<f64> = hits
        .iter()
        .map(|h| h.distance_squared.sqrt() / side)
        .collect();
    let source_side = source.bounds().longest_side();

    let mut marked: Vec<VertexId> = pair
        .landmarks
        .iter()
        .filter(|l| l.is_followed())
        .map(|l: &Landmark| l.source.main_vertex())
        .collect();
    let mut suggestions = Vec::new();
    for _ in 0..n {
        let along = geodesic_distance_unfolded(source.triangulation(), source.rest(), &marked);
        // Where no path leads to a landmark, a whole box counts.
        let worth = |v: VertexId| (along[v] / source_side).min(1.0) + MISS_WEIGHT * missed[v];
        let mesh = source.mesh();
        let used = mesh.vertices().filter(|&v| !mesh.outgoing(v).is_empty());
        let best = used.max_by(|&a, &b| worth(a).total_cmp(&worth(b)).then(b.cmp(&a)));
        let Some(vertex) = best.filter(|v| !marked.contains(v)) else {
            break;
        };
        suggestions.push(Suggestion {
            vertex,
            target: hits[vertex.index()].point,
            alone: along[vertex] / source_side,
            missed: missed[vertex],
        });
        marked.push(vertex);
    }
    Ok(suggestions)
}
