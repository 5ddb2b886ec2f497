//! Which vertices a brush reaches, and how strongly.

use mesh_core::{Point3, Positions, Triangulation, VertexData, VertexId};

/// Vertices in order, each with a weight in 0..=1.
pub(super) struct Ball(pub(super) Vec<(VertexId, f64)>);

impl Ball {
    /// The vertices nearer to `at` than `radius` that hang together there with the vertex nearest to it, each with
    /// `(1 − (d/r)²)²`: a finger that only lies beside the brush is not reached.
    pub(super) fn around(t: &Triangulation, x: &Positions, at: Point3, radius: f64) -> Self {
        let share = |v: VertexId| (x[v] - at).norm_squared() / (radius * radius);
        let nearest = x.ids().min_by(|&a, &b| share(a).total_cmp(&share(b)));
        let mut is_known = VertexData::new(x.len(), false);
        let mut reached: Vec<VertexId> = nearest.into_iter().filter(|&v| share(v) < 1.0).collect();
        reached.iter().for_each(|&v| is_known[v] = true);
        let mut next = 0;
        while next < reached.len() {
            for &w in t.vertex_neighbours(reached[next]) {
                if !is_known[w] && share(w) < 1.0 {
                    is_known[w] = true;
                    reached.push(w);
                }
            }
            next += 1;
        }
        reached.sort_unstable();
        let weigh = |v| (v, (1.0 - share(v)).powi(2));
        Self(reached.into_iter().map(weigh).collect())
    }

    /// Those that are not held.
    pub(super) fn without(mut self, held: &VertexData<bool>) -> Self {
        self.0.retain(|&(v, _)| !held[v]);
        self
    }

    /// The same with weights that many times as large.
    pub(super) fn times(mut self, factor: f64) -> Self {
        self.0.iter_mut().for_each(|(_, weight)| *weight *= factor);
        self
    }

    pub(super) fn points(&self, x: &Positions) -> Vec<Point3> {
        self.0.iter().map(|&(v, _)| x[v]).collect()
    }

    /// Puts its vertices at these places, one for each.
    pub(super) fn put(&self, x: &mut Positions, places: Vec<Point3>) {
        for (&(v, _), place) in self.0.iter().zip(places) {
            x[v] = place;
        }
    }
}
