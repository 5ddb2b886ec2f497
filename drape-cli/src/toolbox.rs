//! What the studio borrows from the command line.

use std::path::Path;

use drape_studio::{Finished, Scene, Settings, Toolbox};
use mesh_core::{Landmark, Positions};
use mesh_init::InitInput;
use neural_drape::DrapeConfig;

use crate::gallery::Gallery;
use crate::initial::deform_input;
use crate::input::Pair;
use crate::landmarks::doctor;
use crate::render::{Up, View};
use crate::report::Page;
use crate::run::{Run, Shapes};
use crate::seams::Seams;
use crate::settings;
use crate::usage::Stopwatch;

/// Pixels along the side of a picture in the report.
const REPORT_PICTURE: usize = 440;

/// The command line's own ways.
pub(crate) struct CommandLine;

impl Toolbox for CommandLine {
    fn presets(&self) -> Vec<String> {
        DrapeConfig::PRESETS.map(str::to_owned).to_vec()
    }

    fn settings(&self, toml: &str) -> anyhow::Result<Settings> {
        let read = settings::of_text(toml)?;
        Ok(Settings {
            toml: settings::to_toml(&read)?,
            preset: read.preset,
            config: read.config,
        })
    }

    fn deform(
        &self,
        scene: &Scene,
        landmarks: &[Landmark],
        settings: &Settings,
    ) -> anyhow::Result<Positions> {
        let input = InitInput {
            mesh: &scene.source.mesh,
            rest: &scene.source.rest,
            landmarks,
            target_bounds: scene.target.surface().bounds(),
        };
        deform_input(input, settings::of_text(&settings.toml)?.start)
    }

    fn examine(&self, scene: &Scene, landmarks: &[Landmark]) -> Vec<String> {
        doctor::examine_landmarks(landmarks, &scene.source.rest, scene.target.surface())
    }

    fn read_landmarks(&self, scene: &Scene, path: &Path) -> anyhow::Result<Vec<Landmark>> {
        Ok(pair(scene, Some(path))?.landmarks)
    }

    fn report(&self, finished: Finished<'_>) -> anyhow::Result<String> {
        let mut pair = pair(finished.scene, None)?;
        pair.landmarks = finished.landmarks.to_vec();
        let shapes = Shapes {
            initial: finished.initial.clone(),
            draped: finished.draped.clone(),
        };
        let settings = settings::of_text(&finished.settings.toml)?;
        let run = Run::of_result(&pair, settings, shapes, &Stopwatch::start())?;
        let page = Page {
            title: "A drape made in the studio",
            run: &run,
            gallery: &Gallery::new(&pair, &run.initial, Up::Y, REPORT_PICTURE),
            views: &[View::FRONT_QUARTER, View::BACK_QUARTER],
            warnings: &doctor::examine(&pair),
            truth: None,
        };
        page.to_html()
    }
}

/// The files of a scene as the other commands read them.
fn pair(scene: &Scene, landmarks: Option<&Path>) -> anyhow::Result<Pair> {
    let (source, target) = (scene.source.file.path(), &scene.target.path);
    Pair::read(source, target, landmarks, Seams::EXACT)
}
