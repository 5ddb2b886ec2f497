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

use super::App;
use crate::controller::{Inbox, Opened, OPEN_FIRST};
use crate::displayed::{DisplayedSource, DisplayedTarget};
use crate::session::InputRecord;

/// Longest file name kept, in characters.
const MAX_NAME: usize = 100;

/// Takes a source, a target or landmarks.
pub(super) async fn open(
    State(app): State<Arc<App>>,
    Path((role, name)): Path<(String, String)>,
    bytes: Bytes,
) -> Response {
    let reader = Arc::clone(&app);
    let read = spawn_blocking(move || read(&reader, &role, &name, &bytes)).await;
    let outcome = match read {
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

fn read(app: &App, role: &str, name: &str, bytes: &[u8]) -> Result<Opened> {
    ensure!(
        matches!(role, "source" | "target" | "landmarks"),
        "a file is opened as source, target or landmarks"
    );
    let path = keep(app, role, name, bytes)?;
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
        "target" => {
            let target = DisplayedTarget::read(&path).map_err(show)?;
            Ok(Opened::Target(Arc::new(target), InputRecord::of(&path)?))
        }
        "landmarks" => {
            let shapes = app.broadcast.displayed().context(OPEN_FIRST)?.shapes;
            let read = landmarks::read(&path, &shapes.source, &shapes.target);
            Ok(Opened::Landmarks(read.map_err(|e| show(e.into()))?))
        }
        _ => bail!("a file is opened as source, target or landmarks"),
    }
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
