//! `drape inspect`

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use mesh_core::io;

use crate::gallery::ViewArgs;
use crate::input::read_target;
use crate::inspection::Inspection;
use crate::output::{check_writable, say};
use crate::render::{color, draw, Axes, Image, Look, Model, Shot, View};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh or point cloud
    file: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Draw it into a PNG file, from in front and from behind
    #[arg(long, value_name = "PNG")]
    render: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
}

/// Pixels along the side of a picture.
const PICTURE_SIZE: usize = 560;

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    if let Some(path) = &args.render {
        check_writable(path)?;
    }
    let file = io::read_mesh(&args.file)?;
    let inspection = Inspection::of(&file).with_context(|| args.file.display().to_string())?;
    if args.json {
        say(&format!("{}\n", serde_json::to_string_pretty(&inspection)?))?;
    } else {
        say(&inspection.to_string())?;
    }
    if let Some(path) = &args.render {
        let is_cloud = file.soup().faces.is_empty();
        let model = if is_cloud {
            read_target(&args.file)?.model
        } else {
            Model::of_soup(file.soup())?
        };
        let views = args
            .view
            .views_or(&[View::FRONT_QUARTER, View::BACK_QUARTER]);
        let shot = |view: &View| Shot {
            axes: Axes::new(*view, args.view.up),
            size: PICTURE_SIZE,
        };
        let pictures = views
            .iter()
            .map(|view| draw(&model, &Look::outlined(color::SOURCE), &[], &[], shot(view)));
        Image::row(&pictures.collect::<Vec<_>>()).save(path)?;
    }
    Ok(ExitCode::SUCCESS)
}
