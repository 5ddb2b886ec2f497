//! `drape inspect`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use mesh_core::io::{write_atomic, Format};
use mesh_draping::parts::inner_surfaces;
use mesh_draping::{Seams, Source, Target, Treatment};
use mesh_render::{color, draw, Axes, Image, Look, Model, Shot, Upright, View};

use crate::args::{PipeArgs, ViewArgs};
use crate::inspection::Inspection;
use crate::output::{check_writable, findings, say, warn};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh or point cloud; - for standard input
    file: PathBuf,
    #[command(flatten)]
    pipe: PipeArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Draw it into a PNG file, from in front and from behind
    #[arg(long, value_name = "PNG")]
    render: Option<PathBuf>,
    /// Propose inner surfaces that no ray from outside reaches, for --free and --rigid; their vertices are written to FILE
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = NO_FILE)]
    hidden: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
}

/// The list of inner surfaces is not written.
const NO_FILE: &str = "-";
/// Pixels along the side of a picture.
const PICTURE_SIZE: usize = 560;

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    args.pipe.check(&[&args.file], None)?;
    let is_file = |path: &&PathBuf| path.as_os_str() != NO_FILE;
    for path in [&args.render, &args.hidden]
        .into_iter()
        .flatten()
        .filter(is_file)
    {
        check_writable(path)?;
    }
    if let Some(path) = &args.hidden {
        check_is_no_mesh(path)?;
    }
    let file = args.pipe.read(&args.file, None)?;
    warn(&findings(&file));
    let inspection = Inspection::of(&file).with_context(|| args.file.display().to_string())?;
    let inner = match &args.hidden {
        Some(_) => {
            let source = Source::of_file(file.clone(), Seams::EXACT)?;
            Some(proposals(&source))
        }
        None => None,
    };
    if args.json {
        say(&format!("{}\n", serde_json::to_string_pretty(&inspection)?))?;
    } else {
        say(&inspection.to_string())?;
    }
    if let (Some((text, list)), Some(path)) = (&inner, &args.hidden) {
        if !args.json {
            say(text)?;
        }
        if path.as_os_str() != NO_FILE {
            write_atomic(path, list.as_bytes())?;
        }
    }
    if let Some(path) = &args.render {
        let shape = Target::of_file(file)?;
        let model = Model::of_target(&shape)?;
        let up = args.view.up.unwrap_or_else(|| Upright::of_shape(&shape).up);
        let views = args
            .view
            .views_or(&[View::FRONT_QUARTER, View::BACK_QUARTER]);
        let shot = |view: &View| Shot {
            axes: Axes::new(*view, up),
            size: PICTURE_SIZE,
        };
        let pictures = views
            .iter()
            .map(|view| draw(&model, &Look::outlined(color::SOURCE), &[], &[], shot(view)));
        Image::row(&pictures.collect::<Vec<_>>()).save(path)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// What follows `--hidden` is written, so a mesh there was meant to be read.
fn check_is_no_mesh(path: &Path) -> anyhow::Result<()> {
    anyhow::ensure!(
        Format::of_extension(path).is_none_or(|format| format == Format::Xyz),
        "{}: the list of inner surfaces would replace a mesh; put the mesh before --hidden, and after it nothing or the \
         name of a text file",
        path.display()
    );
    Ok(())
}

/// The inner surfaces in words, and a list of their vertices as `--free` and `--rigid` read it.
fn proposals(source: &Source) -> (String, String) {
    let (mut text, mut list) = (String::new(), String::new());
    let inner = inner_surfaces(source);
    if inner.is_empty() {
        text += "no inner surface: rays from outside reach everything\n";
    }
    for (row, part) in inner.iter().enumerate() {
        let middle = part.vertices.iter().map(|&v| source.rest()[v].coords);
        let middle = middle.sum::<mesh_core::Vector3>() / part.vertices.len() as f64;
        let how = match part.proposed() {
            Treatment::Rigid => "--rigid",
            _ => "--free",
        };
        let line = format!(
            "{}: {} vertices around ({:.4}, {:.4}, {:.4}), {:.1} % of the area; propose {how} hidden:{}",
            part.kind,
            part.vertices.len(),
            middle.x,
            middle.y,
            middle.z,
            100.0 * part.share,
            row + 1
        );
        text += &format!("{line}\n");
        list += &format!("# {line}\n");
        for row in part.vertices.chunks(16) {
            let numbers: Vec<String> = row
                .iter()
                .map(|&v| source.file_row(v).to_string())
                .collect();
            list += &format!("{}\n", numbers.join(" "));
        }
    }
    (text, list)
}
