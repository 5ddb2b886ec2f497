//! What the studio borrows from the command line.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use anyhow::Context as _;
use drape_studio::{Deformed, Finished, InnerPart, Parts, Scene, Settings, TargetParts, Toolbox};
use mesh_core::io::MeshFile;
use mesh_core::Landmark;
use neural_drape::{DrapeConfig, Regions};

use crate::gallery::Gallery;
use crate::initial::deform;
use crate::input::{read_target, Pair, Source, Target};
use crate::landmarks;
use crate::regions::hidden::Hidden;
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

#[derive(Clone, Default)]
struct Held {
    source: Option<HeldSource>,
    target: Option<Arc<Target>>,
    /// The inner surfaces of these two, once they are asked for.
    hidden: Arc<OnceLock<Hidden>>,
}

/// The source of a scene as the other commands have it.
#[derive(Clone)]
struct HeldSource {
    of: Arc<drape_studio::Source>,
    file: Arc<MeshFile>,
    source: Arc<Source>,
}

/// The pair of a scene.
struct Known {
    pair: Pair,
    hidden: Arc<OnceLock<Hidden>>,
}

impl CommandLine {
    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The pair of a scene, made where it is not held. Several threads may work on it at once.
    fn know(&self, scene: &Scene, landmarks: &[Landmark]) -> anyhow::Result<Known> {
        let mut held = self.held();
        if !held
            .source
            .as_ref()
            .is_some_and(|s| Arc::ptr_eq(&s.of, &scene.source))
        {
            held.source = Some(HeldSource::of(scene)?);
            held.hidden = Arc::default();
        }
        let is_held =
            |target: &Arc<Target>| Arc::ptr_eq(&target.surface, &scene.target.parts.judged);
        if !held.target.as_ref().is_some_and(is_held) {
            held.target = Some(Arc::new(read_target(&scene.target.path)?));
            held.hidden = Arc::default();
        }
        let Held {
            source,
            target,
            hidden,
        } = held.clone();
        let (source, target) = source.zip(target).context("nothing is open")?;
        Ok(Known {
            pair: Pair {
                file: source.file,
                source: source.source,
                target,
                landmarks: landmarks.to_vec(),
            },
            hidden,
        })
    }
}

impl HeldSource {
    fn of(scene: &Scene) -> anyhow::Result<Self> {
        let file = scene.source.file.clone();
        let source = Source::new(file.soup().clone(), Seams::EXACT)
            .with_context(|| file.path().display().to_string())?;
        Ok(Self {
            of: Arc::clone(&scene.source),
            file: Arc::new(file),
            source: Arc::new(source),
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
            live: read.start.config(),
            preset: read.preset,
            config: read.config,
        })
    }

    fn read_target(&self, path: &Path) -> anyhow::Result<TargetParts> {
        let target = Arc::new(read_target(path)?);
        let mut held = self.held();
        held.target = Some(Arc::clone(&target));
        held.hidden = Arc::default();
        Ok(TargetParts {
            over: Arc::clone(&target.over),
            judged: Arc::clone(&target.surface),
        })
    }

    fn deform(
        &self,
        scene: &Scene,
        landmarks: &[Landmark],
        settings: &Settings,
    ) -> anyhow::Result<Deformed> {
        let start = settings::from_text(&settings.toml)?.start;
        let initial = deform(&self.know(scene, landmarks)?.pair, start)?;
        Ok(Deformed {
            positions: initial.positions,
            assumed: initial.assumed,
        })
    }

    fn regions(&self, scene: &Scene, parts: &Parts) -> anyhow::Result<(Regions, Vec<String>)> {
        let Known { pair, hidden } = self.know(scene, &[])?;
        let chosen = RegionArgs::named(parts).resolve_knowing(&pair, &hidden)?;
        Ok((chosen.regions, chosen.notes))
    }

    fn inner_parts(&self, scene: &Scene) -> anyhow::Result<Vec<InnerPart>> {
        let Known { pair, hidden } = self.know(scene, &[])?;
        let hidden = hidden.get_or_init(|| Hidden::of(&pair));
        let parts = hidden
            .inner
            .iter()
            .enumerate()
            .map(|(row, part)| InnerPart {
                name: format!("hidden:{}", row + 1),
                label: format!("{}, {:.1} %", part.kind_in_short(), 100.0 * part.share),
                about: format!(
                    "{}, {} vertices, {:.1} % of the area",
                    part.kind(),
                    part.vertices.len(),
                    100.0 * part.share
                ),
                vertices: part.vertices.clone(),
                proposed: part.proposed(),
                unasked: hidden.unasked(part),
            });
        Ok(parts.collect())
    }

    fn examine(&self, scene: &Scene, landmarks: &[Landmark]) -> Vec<String> {
        match self.know(scene, landmarks) {
            Ok(known) => known.pair.warnings(),
            Err(error) => vec![format!("{error:#}")],
        }
    }

    fn read_landmarks(&self, scene: &Scene, path: &Path) -> anyhow::Result<Vec<Landmark>> {
        let pair = self.know(scene, &[])?.pair;
        landmarks::read(path)?.resolve(&pair.source, &pair.target.vertices)
    }

    fn report(&self, finished: Finished<'_>) -> anyhow::Result<String> {
        let shapes = Shapes {
            initial: finished.initial.clone(),
            draped: finished.draped.clone(),
        };
        let settings = settings::from_text(&finished.settings.toml)?;
        let pair = &self.know(finished.scene, finished.landmarks)?.pair;
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
    }
}
