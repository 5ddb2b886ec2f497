//! How far landmarks are from each other along either shape.

use mesh_core::{Landmark, VertexData};
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
        let graph = SampleGraph::new(input.target, N_SAMPLES);
        Ways::new(&input, &graph).between(input.landmarks, &graph)
    }
}

/// Lengths of the ways along both shapes from each landmark (row) to everywhere.
pub(super) struct Ways {
    /// To each vertex of the source.
    pub(super) on_source: Vec<VertexData<f64>>,
    /// To each sample of the target.
    pub(super) on_target: Vec<Vec<f64>>,
}

impl Ways {
    pub(super) fn new(input: &GuideInput<'_>, graph: &SampleGraph) -> Self {
        let landmarks = input.landmarks.par_iter();
        let on_source = landmarks.clone().map(|l| {
            let from = l.source.main_vertex();
            geodesic_distance_unfolded(input.triangulation, input.rest, &[from])
        });
        Self {
            on_source: on_source.collect(),
            on_target: landmarks.map(|l| graph.distances(&l.target)).collect(),
        }
    }

    /// Those from each of the landmarks to the others.
    pub(super) fn between(&self, landmarks: &[Landmark], graph: &SampleGraph) -> LandmarkWays {
        let samples = landmarks.iter().map(|l| graph.nearest(&l.target));
        let samples: Vec<Option<usize>> = samples.collect();
        let on_source = self.on_source.iter().map(|distance| {
            let marks = landmarks.iter().map(|l| l.source.main_vertex());
            marks.map(|to| distance[to]).collect()
        });
        let on_target = self.on_target.iter().enumerate().map(|(from, distance)| {
            let length = |(to, sample): (usize, &Option<usize>)| match *sample {
                _ if to == from => 0.0,
                Some(sample) => distance[sample],
                None => f64::INFINITY,
            };
            samples.iter().enumerate().map(length).collect()
        });
        LandmarkWays {
            on_source: on_source.collect(),
            on_target: on_target.collect(),
        }
    }
}
