//! What the studio borrows from the command line.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Context as _;
use drape_studio::{Deformed, Finished, Parts, Scene, Settings, TargetParts, Toolbox};
use mesh_core::io::MeshFile;
use mesh_core::Landmark;
use neural_drape::{DrapeConfig, Regions};

use crate::gallery::Gallery;
use crate::initial::deform;
use crate::input::{read_target, Pair, Source, Target};
use crate::landmarks;
use crate::regions::RegionArgs;
use crate::render::{Up, View};
use crate::report::Page;
use crate::run::{Run, Shapes};
use crate::seams::Seams;
use crate::settings;
use crate::usage::Stopwatch;

/// Pixels along the side of a picture in the report.
const REPORT_PICTURE: usize = 440;

/// The command line's own ways. It holds the pair that was worked on last.
#[derive(Default)]
pub(crate) struct CommandLine {
    held: Mutex<Held>,
}

#[derive(Default)]
struct Held {
    source: Option<HeldSource>,
    target: Option<Target>,
}

/// The source of a scene as the other commands have it.
struct HeldSource {
    of: Arc<drape_studio::Source>,
    file: MeshFile,
    source: Source,
}

impl CommandLine {
    /// Works on the pair of a scene.
    fn with_pair<T>(
        &self,
        scene: &Scene,
        landmarks: &[Landmark],
        work: impl FnOnce(&Pair) -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let HeldSource { of, file, source } = match held.source.take() {
            Some(known) if Arc::ptr_eq(&known.of, &scene.source) => known,
            _ => HeldSource::of(scene)?,
        };
        let target = match held.target.take() {
            Some(known) if Arc::ptr_eq(&known.surface, &scene.target.parts.judged) => known,
            _ => read_target(&scene.target.path)?,
        };
        let pair = Pair {
            file,
            source,
            target,
            landmarks: landmarks.to_vec(),
        };
        let outcome = work(&pair);
        held.source = Some(HeldSource {
            of,
            file: pair.file,
            source: pair.source,
        });
        held.target = Some(pair.target);
        outcome
    }
}

impl HeldSource {
    fn of(scene: &Scene) -> anyhow::Result<Self> {
        let file = scene.source.file.clone();
        let source = Source::new(file.soup().clone(), Seams::EXACT)
            .with_context(|| file.path().display().to_string())?;
        Ok(Self {
            of: Arc::clone(&scene.source),
            file,
            source,
        })
    }
}

impl Toolbox for CommandLine {
    fn presets(&self) -> Vec<String> {
        DrapeConfig::PRESETS.map(str::to_owned).to_vec()
    }

    fn settings(&self, toml: &str) -> anyhow::Result<Settings> {
        let read = settings::from_text(toml)?;
        Ok(Settings {
            toml: settings::to_toml(&read)?,
            preset: read.preset,
            config: read.config,
        })
    }

    fn read_target(&self, path: &Path) -> anyhow::Result<TargetParts> {
        let target = read_target(path)?;
        let parts = TargetParts {
            over: Arc::clone(&target.over),
            judged: Arc::clone(&target.surface),
        };
        self.held
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .target = Some(target);
        Ok(parts)
    }

    fn deform(
        &self,
        scene: &Scene,
        landmarks: &[Landmark],
        settings: &Settings,
    ) -> anyhow::Result<Deformed> {
        let start = settings::from_text(&settings.toml)?.start;
        self.with_pair(scene, landmarks, |pair| {
            let initial = deform(pair, start)?;
            Ok(Deformed {
                positions: initial.positions,
                assumed: initial.assumed,
            })
        })
    }

    fn regions(&self, scene: &Scene, parts: &Parts) -> anyhow::Result<(Regions, Vec<String>)> {
        let args = RegionArgs::named(&parts.free, &parts.rigid);
        self.with_pair(scene, &[], |pair| {
            let chosen = args.resolve(pair)?;
            Ok((chosen.regions, chosen.notes))
        })
    }

    fn examine(&self, scene: &Scene, landmarks: &[Landmark]) -> Vec<String> {
        self.with_pair(scene, landmarks, |pair| Ok(pair.warnings()))
            .unwrap_or_else(|error| vec![format!("{error:#}")])
    }

    fn read_landmarks(&self, scene: &Scene, path: &Path) -> anyhow::Result<Vec<Landmark>> {
        self.with_pair(scene, &[], |pair| {
            landmarks::read(path)?.resolve(&pair.source, &pair.target.vertices)
        })
    }

    fn report(&self, finished: Finished<'_>) -> anyhow::Result<String> {
        let shapes = Shapes {
            initial: finished.initial.clone(),
            draped: finished.draped.clone(),
        };
        let settings = settings::from_text(&finished.settings.toml)?;
        self.with_pair(finished.scene, finished.landmarks, |pair| {
            let run = Run::of_result(pair, settings, shapes, &Stopwatch::start())?;
            let page = Page {
                title: "A drape made in the studio",
                run: &run,
                gallery: &Gallery::new(pair, &run.initial, Up::Y, REPORT_PICTURE),
                views: &[View::FRONT_QUARTER, View::BACK_QUARTER],
                warnings: &pair.warnings(),
                truth: None,
            };
            page.to_html()
        })
    }
}
