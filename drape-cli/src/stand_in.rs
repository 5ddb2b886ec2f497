//! Dense sources: a coarse stand-in is deformed and draped, the source itself only refined.

use std::sync::Arc;

use mesh_core::{Landmark, MeshPoint, Proxy, VertexData, VertexId, Weld};
use neural_drape::{DrapeConfig, OverlapMode, ParametrizationConfig, Regions};

use crate::draping::{drape, Draped, Task};
use crate::initial::{deform, Initial, Start};
use crate::input::{Pair, Source};
use crate::profile::{Stages, DRAPING};
use crate::progress::Progress;
use crate::run::Course;
use crate::settings::Settings;

/// Sources with more vertices than this are dense.
const DENSE: usize = 15_000;
/// Vertices of a stand-in.
const N_VERTICES: usize = 3000;
/// Iterations on the source itself.
const N_REFINING: usize = 60;

/// A coarse mesh in the place of a dense source.
pub(crate) struct StandIn {
    proxy: Proxy,
    /// The pair with it as the source.
    pair: Pair,
}

impl StandIn {
    /// The stand-in of a dense source; none where the source is not, or the settings move something else than
    /// vertices: the paper's network is a map of space, whatever the mesh.
    pub(crate) fn of(
        pair: &Pair,
        settings: &Settings,
        stages: &mut Stages,
    ) -> anyhow::Result<Option<Self>> {
        let moves_vertices = matches!(
            settings.config.parametrization,
            ParametrizationConfig::Vertices(_)
        );
        if pair.source.rest.len() <= DENSE || !moves_vertices || settings.start != Start::Standard {
            return Ok(None);
        }
        stages.time("stand-in", || Self::new(pair)).map(Some)
    }

    fn new(pair: &Pair) -> anyhow::Result<Self> {
        let source = &pair.source;
        let kept: Vec<VertexId> = pair
            .landmarks
            .iter()
            .flat_map(|l| l.source.vertices)
            .collect();
        let proxy = Proxy::new(&source.triangulation, &source.rest, N_VERTICES, &kept);
        let landmark = |l: &Landmark| Landmark {
            source: MeshPoint {
                vertices: l.source.vertices.map(|v| proxy.row_of(v).unwrap_or(v)),
                ..l.source
            },
            ..l.clone()
        };
        let rows = 0..proxy.vertices().len() as u32;
        let weld = Weld {
            soup: proxy.soup().clone(),
            row_of: rows.collect(),
        };
        Ok(Self {
            pair: Pair {
                file: Arc::clone(&pair.file),
                source: Arc::new(Source::of_weld(weld)?),
                target: Arc::clone(&pair.target),
                landmarks: pair.landmarks.iter().map(landmark).collect(),
            },
            proxy,
        })
    }

    /// Deforms and drapes the stand-in, lets it carry the source of `pair`, and refines that.
    pub(crate) fn drape(
        &self,
        pair: &Pair,
        settings: &Settings,
        regions: &Regions,
        stages: &mut Stages,
    ) -> anyhow::Result<Course> {
        let rest = &pair.source.rest;
        let Initial { positions, assumed } =
            stages.time("initial deformation", || deform(&self.pair, settings.start))?;
        let mut progress = Progress::start(settings.config.n_iterations() + N_REFINING);
        let task = Task {
            pair: &self.pair,
            config: settings.config.clone(),
            regions: &self.regions(regions),
            initial: &positions,
        };
        let coarse = stages.time_with_parts(DRAPING, |parts| drape(task, &mut progress, parts))?;

        let [initial, carried] = [&positions, &coarse.positions].map(|x| self.proxy.carry(rest, x));
        let task = Task {
            pair,
            config: refining(&settings.config, &coarse),
            regions,
            initial: &carried,
        };
        progress.go_on();
        let fine =
            stages.time_with_parts("drape, refined", |parts| drape(task, &mut progress, parts))?;
        let mut notes = assumed;
        notes.push(format!(
            "the source is dense: {} of its {} vertices were draped first and carried the others, then all were refined",
            self.proxy.vertices().len(),
            rest.len()
        ));
        Ok(Course {
            initial,
            drape: Draped {
                left_out: coarse.left_out,
                ..fine
            },
            history: progress.finish(),
            notes,
        })
    }

    fn regions(&self, regions: &Regions) -> Regions {
        let vertices = self.proxy.vertices();
        Regions {
            attraction: vertices.iter().map(|&v| regions.attraction[v]).collect(),
            rigid: vertices
                .iter()
                .map(|&v| regions.rigid[v])
                .collect::<VertexData<bool>>(),
        }
    }
}

/// The settings of the refinement: what lies beyond was decided on the way.
fn refining(config: &DrapeConfig, coarse: &Draped) -> DrapeConfig {
    let overlap = match (coarse.overlap.target_exceeds, coarse.overlap.mesh_exceeds) {
        _ if coarse.is_part_uncovered => config.overlap,
        (false, false) => OverlapMode::Full,
        (true, false) => OverlapMode::SourcePartial,
        (false, true) => OverlapMode::TargetPartial,
        (true, true) => OverlapMode::BothPartial,
    };
    DrapeConfig {
        overlap,
        ..config.refining(N_REFINING)
    }
}
