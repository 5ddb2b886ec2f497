//! Dense sources: a coarse stand-in is deformed and draped first, and carries the source.

use mesh_core::{Landmark, MeshPoint, Positions, Proxy, Vector3, VertexData, VertexId, Weld};
use neural_drape::{ParametrizationConfig, Regions};

use crate::{Error, InitialMethod, Pair, Preset, Source};

/// Sources with more vertices than this are dense.
const DENSE: usize = 15_000;
/// Vertices of a stand-in.
const N_VERTICES: usize = 3000;

/// A coarse mesh in the place of a dense source.
pub(crate) struct StandIn {
    proxy: Proxy,
    /// The source that it stands for, at rest.
    rest: std::sync::Arc<Positions>,
    /// The pair with it as the source.
    pub(crate) pair: Pair,
}

impl StandIn {
    /// Whether the source of a pair is draped by a stand-in: where it is dense, and the settings move vertices: the
    /// paper's network is a map of space, whatever the mesh.
    pub(crate) fn is_needed(pair: &Pair, preset: &Preset) -> bool {
        let moves_vertices = matches!(
            preset.drape.parametrization,
            ParametrizationConfig::Vertices(_)
        );
        pair.source.rest().len() > DENSE
            && moves_vertices
            && matches!(
                preset.initial,
                InitialMethod::Tried | InitialMethod::TriedByVertices | InitialMethod::Standard
            )
    }

    /// The stand-in that a dense source is draped by.
    pub(crate) fn new(pair: &Pair) -> Result<Self, Error> {
        Self::with_vertices(pair, N_VERTICES)
    }

    /// A stand-in of about `n` vertices; of all of them where the source has no more.
    pub(crate) fn with_vertices(pair: &Pair, n: usize) -> Result<Self, Error> {
        let source = &pair.source;
        let marked = Landmark::marked(&pair.landmarks).flat_map(|l| l.source.vertices);
        let marked: Vec<VertexId> = marked.collect();
        let proxy = Proxy::new(source.triangulation(), source.rest(), n, &marked);
        let rows = 0..proxy.vertices().len() as u32;
        let weld = Weld {
            soup: proxy.soup().clone(),
            row_of: rows.collect(),
        };
        let mut stand_in = Self {
            pair: Pair {
                source: Source::of_weld(weld)?,
                target: pair.target.clone(),
                landmarks: Vec::new(),
            },
            rest: source.rest().clone(),
            proxy,
        };
        stand_in.pair.landmarks = stand_in.landmarks(&pair.landmarks);
        Ok(stand_in)
    }

    /// How many vertices it has.
    pub(crate) fn n_vertices(&self) -> usize {
        self.proxy.vertices().len()
    }

    /// Landmarks of the source on the stand-in. Their vertices are kept as long as the stand-in was made for them; of
    /// others, and along curves, the nearest place that is left is taken.
    pub(crate) fn landmarks(&self, landmarks: &[Landmark]) -> Vec<Landmark> {
        let landmark = |l: &Landmark| Landmark {
            source: self.place(&l.source),
            ..l.clone()
        };
        landmarks.iter().map(landmark).collect()
    }

    fn place(&self, at: &MeshPoint) -> MeshPoint {
        let rows = at.vertices.map(|v| self.proxy.row_of(v));
        match rows {
            [Some(a), Some(b), Some(c)] => MeshPoint {
                vertices: [a, b, c],
                ..*at
            },
            _ => {
                let point = at.position(&self.rest);
                let place = self.pair.source.closest_place(&point);
                place.unwrap_or_else(|| MeshPoint::vertex(VertexId::new(0)))
            }
        }
    }

    /// Regions of the source on the stand-in.
    pub(crate) fn regions(&self, regions: &Regions) -> Regions {
        let vertices = self.proxy.vertices();
        Regions {
            attraction: vertices.iter().map(|&v| regions.attraction[v]).collect(),
            rigid: vertices
                .iter()
                .map(|&v| regions.rigid[v])
                .collect::<VertexData<bool>>(),
        }
    }

    /// Where the vertices of the stand-in are in a shape of the source.
    pub(crate) fn pick(&self, x: &Positions) -> Positions {
        self.proxy.vertices().iter().map(|&v| x[v]).collect()
    }

    /// The moves of the vertices of the stand-in among those of the source.
    pub(crate) fn moves(&self, moves: &VertexData<Vector3>) -> VertexData<Vector3> {
        self.proxy.vertices().iter().map(|&v| moves[v]).collect()
    }

    /// The source as the stand-in at `x` carries it.
    pub(crate) fn carry(&self, x: &Positions) -> Positions {
        self.proxy.carry(&self.rest, x)
    }

    /// The same of two shapes, which may be one.
    pub(crate) fn carry_both(&self, a: Positions, b: Positions) -> (Positions, Positions) {
        let carried = self.carry(&a);
        match a == b {
            true => (carried.clone(), carried),
            false => (carried, self.carry(&b)),
        }
    }
}
