//! Files that a page sends.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{bail, ensure, Context as _, Result};
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use mesh_core::io::write_atomic;
use mesh_draping::landmarks;
use tokio::sync::oneshot;
use tokio::task::spawn_blocking;

use super::{snapshot, App};
use crate::controller::{Inbox, Opened, OpenedSession, Snapshot, OPEN_FIRST};
use crate::displayed::{DisplayedSource, DisplayedTarget};
use crate::session::{InputRecord, Session};

/// Longest file name kept, in characters.
const MAX_NAME: usize = 100;

/// What a page asks to open.
struct Asked<'a> {
    role: &'a str,
    name: &'a str,
    bytes: &'a [u8],
}

/// Takes a source, a target, landmarks, a session, or pictures that lie beside a mesh.
pub(super) async fn open(
    State(app): State<Arc<App>>,
    Path((role, name)): Path<(String, String)>,
    bytes: Bytes,
) -> Response {
    let Some(snapshot) = snapshot(&app).await else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let reader = Arc::clone(&app);
    let read = spawn_blocking(move || {
        let asked = Asked {
            role: &role,
            name: &name,
            bytes: &bytes,
        };
        read(&reader, &snapshot, &asked)
    });
    let read = read.await;
    let outcome = match read {
        Ok(Ok(Opened::Beside)) => Ok(()),
        Ok(Ok(opened)) => {
            let (sender, answer) = oneshot::channel();
            app.controller.send(Inbox::Opened(opened, sender));
            answer.await.unwrap_or(Ok(()))
        }
        Ok(Err(error)) => Err(format!("{error:#}")),
        Err(_) => Err("the file could not be read".to_owned()),
    };
    match outcome {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(error) => (StatusCode::UNPROCESSABLE_ENTITY, error).into_response(),
    }
}

/// What a file, or a file that is known already, is opened as.
fn read(app: &App, snapshot: &Snapshot, asked: &Asked<'_>) -> Result<Opened> {
    match asked.role {
        "next" => {
            let next = snapshot.session.queue.first();
            let record = next.context("no target waits")?.clone();
            record.check()?;
            read_target(&record.path, record.clone())
        }
        "aside" => {
            let is_known = app.files.aside_names().iter().any(|n| n == asked.name);
            ensure!(is_known, "there is no session '{}'", asked.name);
            let run = fs::read(app.files.aside_run(asked.name)).ok();
            read_session(
                &fs::read_to_string(app.files.aside_session(asked.name))?,
                run,
            )
        }
        "session" => {
            let text = std::str::from_utf8(asked.bytes);
            read_session(text.context("is not a session file")?, None)
        }
        _ => read_file(app, asked),
    }
}

/// A file that a page sent.
fn read_file(app: &App, asked: &Asked<'_>) -> Result<Opened> {
    let Asked { role, name, bytes } = *asked;
    let folder = match role {
        "source" | "target" | "landmarks" => role,
        "queue" => "target",
        "beside-source" => "source",
        "beside-target" => "target",
        _ => bail!("a file is opened as source, target or landmarks"),
    };
    let path = keep(app, folder, name, bytes)?;
    let show = |error: anyhow::Error| {
        // The user knows the file by its name.
        let text = format!("{error:#}").replace(&path.display().to_string(), name);
        anyhow::anyhow!(text)
    };
    match role {
        "source" => {
            let source = DisplayedSource::read(&path).map_err(show)?;
            Ok(Opened::Source(Arc::new(source), InputRecord::of(&path)?))
        }
        "target" => read_target(&path, InputRecord::of(&path)?).map_err(show),
        "queue" => Ok(Opened::Queued(InputRecord::of(&path)?)),
        "landmarks" => {
            let shapes = app.broadcast.displayed().context(OPEN_FIRST)?.shapes;
            let read = landmarks::read(&path, &shapes.source, &shapes.target);
            Ok(Opened::Landmarks(read.map_err(|e| show(e.into()))?))
        }
        _ => Ok(Opened::Beside),
    }
}

fn read_target(path: &std::path::Path, record: InputRecord) -> Result<Opened> {
    let target = DisplayedTarget::read(path)?;
    Ok(Opened::Target(Arc::new(target), record))
}

/// A session with its inputs, which must be where it says, as they were.
fn read_session(text: &str, run: Option<Vec<u8>>) -> Result<Opened> {
    let session = Session::of_json(text)?;
    let input = |record: &Option<InputRecord>| {
        let record = record
            .clone()
            .context("the session has no source or no target")?;
        record.check()?;
        Ok::<_, anyhow::Error>(record)
    };
    let (source, target) = (input(&session.source)?, input(&session.target)?);
    let source = DisplayedSource::read(&source.path)?;
    session.check_places(source.source.rest().len())?;
    let target = DisplayedTarget::read(&target.path)?;
    Ok(Opened::Session(Box::new(OpenedSession {
        session,
        source: Arc::new(source),
        target: Arc::new(target),
        run,
    })))
}

/// Writes the file into the folder of this session's files, under a name that cannot lead out of it.
fn keep(app: &App, role: &str, name: &str, bytes: &[u8]) -> Result<PathBuf> {
    let folder = app.uploads.join(role);
    fs::create_dir_all(&folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
    let path = folder.join(safe_name(name));
    write_atomic(&path, bytes)?;
    Ok(path)
}

/// The last part of a name, without what means something to a file system.
fn safe_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let is_plain = |c: char| c.is_alphanumeric() || "._- ()+".contains(c);
    let plain: String = last
        .chars()
        .map(|c| if is_plain(c) { c } else { '_' })
        .collect();
    let n = plain.chars().count();
    let end: String = plain.chars().skip(n.saturating_sub(MAX_NAME)).collect();
    let name = end.trim_start_matches(['.', ' ']);
    if name.is_empty() {
        "file".to_owned()
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leads_out_of_the_folder() {
        for (name, safe) in [
            ("horse.obj", "horse.obj"),
            ("../../etc/passwd", "passwd"),
            ("..", "file"),
            ("a/..", "file"),
            ("c:\\x\\y.ply", "y.ply"),
            ("\u{0}<&>.obj", "____.obj"),
            ("", "file"),
            (".bashrc", "bashrc"),
        ] {
            assert_eq!(safe_name(name), safe, "{name:?}");
        }
        assert!(safe_name(&"x".repeat(5000)).len() <= MAX_NAME);
    }
}
