//! Opening and serving a studio.

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{anyhow, ensure, Context as _, Result};
use mesh_draping::{landmarks, Preset};

use crate::address::listen;
use crate::broadcast::Broadcast;
use crate::controller::{Controller, ControllerParts};
use crate::displayed::{DisplayedSource, DisplayedTarget};
use crate::server::{serve, App, Guard};
use crate::session::{self, InputRecord, Mark, Session};

/// What to open.
#[derive(Clone, Debug)]
pub struct Options {
    /// The mesh to deform; what the session has, or nothing yet, where there is none.
    pub source: Option<PathBuf>,
    /// The shape to drape over; likewise.
    pub target: Option<PathBuf>,
    /// Landmarks to begin with; they replace those of the session.
    pub landmarks: Option<PathBuf>,
    /// Settings to begin with; they replace those of the session.
    pub preset: Option<Preset>,
    /// The file that keeps the session, made where it is not there.
    pub session: PathBuf,
    /// Whether a session that is kept there is dropped.
    pub is_fresh: bool,
    /// Port of the server; where it is 0 the one that the session had, or a free one.
    pub port: u16,
}

/// A studio that is ready to be served.
pub struct Studio {
    listener: TcpListener,
    guard: Guard,
    app: App,
    url: String,
}

/// Inputs in memory.
struct Inputs {
    source: Option<Arc<DisplayedSource>>,
    target: Option<Arc<DisplayedTarget>>,
}

impl Studio {
    /// Opens the session and its inputs, and takes a port on this computer that others cannot reach.
    ///
    /// # Errors
    /// A file cannot be read or does not belong to the session, or the port is taken.
    pub fn open(options: &Options) -> Result<Self> {
        let (mut session, mut notice) = kept_session(options)?;
        let inputs = open_inputs(options, &mut session, &mut notice)?;
        if let Some(preset) = &options.preset {
            let settings = preset.to_toml();
            session.edit(|d| d.settings = settings);
        }
        if let Some(path) = &options.landmarks {
            adopt_landmarks(path, &mut session, &inputs)?;
        }
        let folder = options.session.parent().unwrap_or(Path::new(""));
        if !folder.as_os_str().is_empty() {
            fs::create_dir_all(folder)
                .with_context(|| format!("{}: cannot be made", folder.display()))?;
        }
        session.write(&options.session)?;

        let (listener, guard) = listen(&options.session, options.port)?;
        let url = format!("http://{}/{}/", listener.local_addr()?, guard.token());
        let broadcast = Arc::new(Broadcast::new());
        let controller = Controller::start(ControllerParts {
            broadcast: Arc::clone(&broadcast),
            session,
            source: inputs.source,
            target: inputs.target,
            session_path: options.session.clone(),
            notice,
        })?;
        Ok(Self {
            app: App::new(controller, broadcast, &options.session),
            listener,
            guard,
            url,
        })
    }

    /// The address of the page. Whoever knows it may use the studio.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Serves until the process ends.
    ///
    /// # Errors
    /// The system refuses to serve.
    pub fn serve(self) -> Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        runtime.block_on(async {
            self.listener.set_nonblocking(true)?;
            let listener = tokio::net::TcpListener::from_std(self.listener)?;
            serve(listener, self.guard, self.app).await
        })?;
        Ok(())
    }
}

/// The session in its file, or a new one; what is there and cannot be used is kept under another name.
fn kept_session(options: &Options) -> Result<(Session, Option<String>)> {
    let fresh = || Session::new(Preset::standard().to_toml());
    if options.is_fresh || !options.session.exists() {
        return Ok((fresh(), None));
    }
    let kept = session::read(&options.session).and_then(|session| {
        Preset::from_toml(&session.document.settings)?;
        Ok(session)
    });
    match kept {
        Ok(session) => Ok((session, None)),
        Err(error) => {
            let aside = options.session.with_extension("unreadable");
            fs::rename(&options.session, &aside)
                .with_context(|| format!("{}: cannot be put aside", options.session.display()))?;
            let notice = format!(
                "the session was put aside as {}: {error:#}",
                aside.display()
            );
            Ok((fresh(), Some(notice)))
        }
    }
}

/// Opens what is asked for, else what the session has. A session of other inputs is not touched.
fn open_inputs(
    options: &Options,
    session: &mut Session,
    notice: &mut Option<String>,
) -> Result<Inputs> {
    let asked = [&options.source, &options.target];
    let mut records = [session.source.clone(), session.target.clone()];
    for (path, record) in asked.into_iter().zip(&mut records) {
        let Some(path) = path else { continue };
        let new = InputRecord::of(path)?;
        if record.as_ref().is_some_and(|known| *known != new) {
            ensure!(
                record.as_ref().is_some_and(|known| known.path == new.path),
                "the session is of {}; name another session file, or start with --fresh",
                record
                    .as_ref()
                    .map_or(String::new(), |r| r.path.display().to_string())
            );
            *notice = Some(format!(
                "{} changed since; its landmarks and drape are gone",
                path.display()
            ));
            session.forget_places();
        }
        *record = Some(new);
    }
    let [source_record, target_record] = records;
    let (source, target) = std::thread::scope(|scope| {
        let source = source_record.as_ref().map(|record| {
            scope.spawn(|| read_or_forget(record, options.source.is_some(), DisplayedSource::read))
        });
        let target = target_record
            .as_ref()
            .map(|record| read_or_forget(record, options.target.is_some(), DisplayedTarget::read));
        let source = source.map(|thread| {
            thread
                .join()
                .map_err(|_| anyhow!("the source cannot be read"))?
        });
        Ok::<_, anyhow::Error>((source.transpose()?, target.transpose()?))
    })?;
    let (source, target) = (source.unwrap_or_default(), target.unwrap_or_default());
    if let Some(gone) = source.gone.or(target.gone) {
        *notice = Some(gone);
    }
    let (source, target) = (source.input, target.input);
    (session.source, session.target) = (
        source_record.filter(|_| source.is_some()),
        target_record.filter(|_| target.is_some()),
    );
    let fits = source
        .as_ref()
        .is_none_or(|s| session.check_places(s.source.rest().len()).is_ok());
    if !fits {
        session.forget_places();
    }
    Ok(Inputs { source, target })
}

/// An input, or why it is not there.
struct MaybeRead<T> {
    input: Option<Arc<T>>,
    gone: Option<String>,
}

impl<T> Default for MaybeRead<T> {
    fn default() -> Self {
        Self {
            input: None,
            gone: None,
        }
    }
}

/// An input that was asked for must be there; one that the session names may be gone.
fn read_or_forget<T>(
    record: &InputRecord,
    is_asked: bool,
    read: impl FnOnce(&Path) -> Result<T>,
) -> Result<MaybeRead<T>> {
    let unchanged = if is_asked { Ok(()) } else { record.check() };
    match unchanged.and_then(|()| read(&record.path)) {
        Ok(input) => Ok(MaybeRead {
            input: Some(Arc::new(input)),
            gone: None,
        }),
        Err(error) if is_asked => Err(error),
        Err(error) => Ok(MaybeRead {
            input: None,
            gone: Some(format!("{error:#}")),
        }),
    }
}

fn adopt_landmarks(path: &Path, session: &mut Session, inputs: &Inputs) -> Result<()> {
    let (source, target) = inputs
        .source
        .clone()
        .zip(inputs.target.clone())
        .context("landmarks need a source and a target")?;
    let landmarks = landmarks::read(path, &source.source, &target.target)?;
    let marks: Vec<Mark> = landmarks
        .iter()
        .map(|l| Mark::of(session.fresh_id(), l))
        .collect();
    session.edit(|d| d.marks = marks);
    Ok(())
}
