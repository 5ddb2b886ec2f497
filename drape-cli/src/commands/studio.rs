//! `drape studio`

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use anyhow::Context as _;
use drape_studio::{Options, Studio};

use crate::args::SettingsArgs;
use crate::output::say;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh to deform; may be opened in the browser instead
    #[arg(requires = "target")]
    source: Option<PathBuf>,
    /// Mesh or point cloud to drape it over
    target: Option<PathBuf>,
    /// Landmarks to begin with, as JSON; they replace those of the session
    #[arg(short, long, value_name = "FILE", requires = "target")]
    landmarks: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingsArgs,
    /// File that keeps the session; one of these two inputs, in your folder of program data, where not given
    #[arg(long, value_name = "FILE")]
    session: Option<PathBuf>,
    /// Begin anew, and drop the session that was kept
    #[arg(long)]
    fresh: bool,
    /// Port of this computer to serve at; a free one where not given
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Print the address and open no browser
    #[arg(long)]
    no_browser: bool,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let session = match &args.session {
        Some(path) => path.clone(),
        None => kept_session(args)?,
    };
    let options = Options {
        source: args.source.clone(),
        target: args.target.clone(),
        landmarks: args.landmarks.clone(),
        preset: args
            .settings
            .is_given()
            .then(|| args.settings.preset())
            .transpose()?,
        session,
        is_fresh: args.fresh,
        port: args.port,
    };
    let studio = Studio::open(&options)?;
    say(&format!(
        "studio at {}\nsession kept in {}\nCtrl-C ends it; the same command comes back to it\n",
        studio.url(),
        options.session.display()
    ))?;
    if !args.no_browser {
        open_browser(studio.url());
    }
    studio.serve()?;
    Ok(ExitCode::SUCCESS)
}

/// Where the session of these inputs is kept: by their names, and a hash of where they are.
fn kept_session(args: &Args) -> anyhow::Result<PathBuf> {
    let folder =
        data_folder().context("no folder for the session is known; name a file with --session")?;
    let inputs = args.source.iter().chain(&args.target);
    let places: Vec<PathBuf> = inputs
        .map(|path| path.canonicalize().unwrap_or_else(|_| path.clone()))
        .collect();
    let stems: Vec<String> = places.iter().map(|path| stem(path)).collect();
    let name = if stems.is_empty() {
        "studio".to_owned()
    } else {
        let bytes = places
            .iter()
            .flat_map(|p| p.as_os_str().as_encoded_bytes().iter().chain(&[0]));
        let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        format!("{}-{:08x}", stems.join("-"), hash as u32)
    };
    Ok(folder.join(format!("{name}.json")))
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// The user's folder for what programs keep.
fn data_folder() -> Option<PathBuf> {
    let set = |name: &str| {
        env::var_os(name)
            .filter(|v| !v.is_empty())
            .map(PathBuf::from)
    };
    set("XDG_STATE_HOME")
        .or_else(|| set("LOCALAPPDATA"))
        .or_else(|| set("HOME").map(|home| home.join(".local").join("state")))
        .map(|folder| folder.join("drape"))
}

/// Asks the system to show a page; where it cannot, the user has the printed address.
fn open_browser(url: &str) {
    let mut command = if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        let mut command = Command::new("rundll32");
        command.arg("url.dll,FileProtocolHandler");
        command
    } else {
        Command::new("xdg-open")
    };
    let quiet = command.arg(url).stdin(Stdio::null()).stdout(Stdio::null());
    drop(quiet.stderr(Stdio::null()).spawn());
}
