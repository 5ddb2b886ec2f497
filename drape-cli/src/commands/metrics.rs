//! `drape metrics`

use std::path::PathBuf;
use std::process::ExitCode;

use mesh_draping::mesh_core::{Point3, Positions};
use mesh_draping::mesh_metrics::Report;
use mesh_draping::Pair;
use mesh_render::{Gallery, Image, View, DISTANCE_AT_TOP};

use crate::args::{read_truth, Inputs, PipeArgs, ViewArgs, WeldArgs};
use crate::output::{check_writable, say};
use crate::requirement::Requirements;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh before the drape; - for standard input
    source: PathBuf,
    /// Mesh after it, with the same vertices in the same order
    result: PathBuf,
    /// Mesh or point cloud it should lie on; - for standard input
    target: PathBuf,
    /// Landmarks that the result should meet
    #[arg(short, long, value_name = "FILE")]
    landmarks: Option<PathBuf>,
    /// Mesh whose vertices are where those of the result belong
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    #[command(flatten)]
    weld: WeldArgs,
    #[command(flatten)]
    pipe: PipeArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Draw target, result and distances, with dots where it runs through itself, into a PNG file
    #[arg(long, value_name = "PNG")]
    render: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    /// Conditions such as 'q>=0.85,folds=0'; the exit code is 1 where one does not hold
    #[arg(long, value_name = "CONDITIONS")]
    require: Option<Requirements>,
}

/// Pixels along the side of a picture.
const PICTURE_SIZE: usize = 480;

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    args.pipe.check(&[&args.source, &args.target], None)?;
    if let Some(path) = &args.render {
        check_writable(path)?;
    }
    let inputs = Inputs {
        source: &args.source,
        target: &args.target,
        landmarks: args.landmarks.as_deref(),
        seams: args.weld.weld,
        output: None,
        pipe: args.pipe,
    };
    let pair = inputs.read()?;
    let draped = read_truth(&args.result, &pair.source)?;
    let truth = args.truth.as_deref();
    let truth = truth
        .map(|path| read_truth(path, &pair.source))
        .transpose()?;
    let report = pair.judge(&draped, truth.as_ref())?;
    if args.json {
        let figures = report
            .figures()
            .into_iter()
            .collect::<std::collections::BTreeMap<_, _>>();
        let json = serde_json::json!({ "figures": figures, "report": report });
        say(&format!("{json:#}\n"))?;
    } else {
        say(&report.to_string())?;
    }
    if let Some(path) = &args.render {
        let gallery = Gallery::new(&pair, &draped, args.view.up, PICTURE_SIZE)?;
        let distances = &report.vertex_distances;
        let marks = crossing_places(&pair, &draped, &report);
        let row = |view| {
            Image::row(&[
                gallery.target(view),
                gallery.result(&draped, view),
                gallery.marked_heat(&draped, distances, DISTANCE_AT_TOP, &marks, view),
            ])
        };
        let rows: Vec<Image> = args
            .view
            .views_or(&[View::FRONT_QUARTER])
            .into_iter()
            .map(row)
            .collect();
        Image::column(&rows).save(path)?;
    }
    Ok(args
        .require
        .as_ref()
        .map_or(ExitCode::SUCCESS, |r| r.verdict(&report.figures())))
}

/// A corner of each face that runs through another and did not at rest.
fn crossing_places(pair: &Pair, draped: &Positions, report: &Report) -> Vec<Point3> {
    let faces = report.places.self_intersecting_new.iter();
    let corner = |&face| pair.source.mesh().face_vertices(face).first();
    faces.filter_map(corner).map(|&v| draped[v]).collect()
}
