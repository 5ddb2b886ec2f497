//! How far landmarks are from each other along either shape.

use mesh_core::{Point3, VertexId};
use mesh_operators::geodesic_distance_unfolded;
use rayon::prelude::*;

use super::graph::SampleGraph;
use super::{GuideInput, N_SAMPLES};

/// Lengths of the ways along both shapes from each landmark (row) to each other (column): 0 to itself, infinite where no
/// way leads.
#[derive(Clone, Debug, PartialEq)]
pub struct LandmarkWays {
    /// Along the source, by unfolded triangles.
    pub on_source: Vec<Vec<f64>>,
    /// Along the target, over a graph of its samples: between the samples nearest to the landmarks.
    pub on_target: Vec<Vec<f64>>,
}

impl LandmarkWays {
    /// Measures all of them. The work grows with the number of landmarks times that of vertices: it is meant for a
    /// stand-in.
    ///
    /// # Panics
    /// If a landmark names a vertex that is not there.
    pub fn new(input: GuideInput<'_>) -> Self {
        let marks = input.landmarks.iter().map(|l| l.source.main_vertex());
        let marks: Vec<VertexId> = marks.collect();
        let on_source = |&from: &VertexId| {
            let distance = geodesic_distance_unfolded(input.triangulation, input.rest, &[from]);
            marks.iter().map(|&to| distance[to]).collect()
        };
        let graph = SampleGraph::new(input.target, N_SAMPLES);
        let places: Vec<Point3> = input.landmarks.iter().map(|l| l.target).collect();
        let samples: Vec<Option<usize>> = places.iter().map(|p| graph.nearest(p)).collect();
        let on_target = |from: usize| {
            let distance = graph.distances(&places[from]);
            let to = |to: usize| match samples[to] {
                _ if to == from => 0.0,
                Some(sample) => distance[sample],
                None => f64::INFINITY,
            };
            (0..places.len()).map(to).collect()
        };
        Self {
            on_source: marks.par_iter().map(on_source).collect(),
            on_target: (0..places.len()).into_par_iter().map(on_target).collect(),
        }
    }
}
