//! `drape landmarks`

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::ensure;
use clap::Subcommand;
use mesh_core::io::write_atomic;
use mesh_core::{Curve, Landmark};
use mesh_draping::landmarks::{
    self, leave_one_out_residuals, Finding, Form, Label, Lost, WrapPoints,
};
use mesh_draping::{Pair, Seams};

use crate::args::{Inputs, PipeArgs};
use crate::output::{check_distinct, check_writable, say, warn};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Tell how far each landmark is from where the others expect it, and what looks wrong; exit code 1 if anything does
    Check(Files),
    /// Tell where one more landmark would help most
    Suggest(Suggest),
    /// Add the landmarks of the other half of a symmetric source
    Mirror(Output),
    /// Write landmarks in another form
    Convert(Convert),
}

#[derive(Debug, clap::Args)]
struct Convert {
    #[command(flatten)]
    output: Output,
    /// LANDMARKS is a point file of Faceform Wrap on the source, [[triangle, u, v], …], and this the one on the target
    #[arg(long, value_name = "FILE")]
    target_points: Option<PathBuf>,
    /// Write point files of Faceform Wrap: -o on the source, and this on the target
    #[arg(long, value_name = "OUT", conflicts_with = "to")]
    target_output: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
struct Files {
    /// Mesh to deform
    source: PathBuf,
    /// Mesh or point cloud to drape it over
    target: PathBuf,
    /// Places that belong together: JSON, or lines of numbers
    landmarks: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, clap::Args)]
struct Suggest {
    #[command(flatten)]
    files: Files,
    /// How many
    #[arg(short, long, value_name = "N", default_value_t = 3)]
    number: usize,
}

#[derive(Debug, clap::Args)]
struct Output {
    #[command(flatten)]
    files: Files,
    /// File to write
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// How to write it; where not given, the extension tells: json, else lines of source vertex, target x y z, name
    #[arg(long, value_name = "FORM")]
    to: Option<FormArg>,
}

/// [`Form`] on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum FormArg {
    /// JSON with names, places in faces, kinds, weights and curves: nothing is lost
    Json,
    /// JSON of two lists, source_vertices and target_points, and weights where any is not 1
    Lists,
    /// Lines of source vertex, target x y z, name
    Text,
    /// Lines of source vertex, target vertex, name
    Ids,
    /// Lines of source x y z, target x y z, name
    Points,
}

impl From<FormArg> for Form {
    fn from(arg: FormArg) -> Self {
        match arg {
            FormArg::Json => Self::Json,
            FormArg::Lists => Self::Lists,
            FormArg::Text => Self::Text,
            FormArg::Ids => Self::Ids,
            FormArg::Points => Self::Points,
        }
    }
}

impl Files {
    fn read(&self) -> anyhow::Result<Pair> {
        self.read_with(Some(&self.landmarks))
    }

    fn read_with(&self, landmarks: Option<&Path>) -> anyhow::Result<Pair> {
        let inputs = Inputs {
            source: &self.source,
            target: &self.target,
            landmarks,
            seams: Seams::EXACT,
            output: None,
            pipe: PipeArgs::default(),
        };
        inputs.read()
    }
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    match &args.task {
        Task::Check(files) => check(files),
        Task::Suggest(args) => next(args),
        Task::Mirror(args) => add_mirrored(args),
        Task::Convert(args) => args.run(),
    }
}

fn check(files: &Files) -> anyhow::Result<ExitCode> {
    let pair = files.read()?;
    let residuals = leave_one_out_residuals(&pair);
    let findings = pair.findings();
    let findings: Vec<String> = findings.iter().map(Finding::to_string).collect();
    if files.json {
        let list: Vec<_> = Landmark::marked(&pair.landmarks)
            .zip(&residuals)
            .map(|(l, r)| serde_json::json!({ "name": l.name, "left_out_residual": r }))
            .collect();
        let json = serde_json::json!({ "landmarks": list, "findings": findings });
        say(&format!("{json:#}\n"))?;
    } else {
        let mut text = String::from(
            "distance from where the other landmarks expect each, in % of the target's longest side\n",
        );
        let marked = Landmark::marked(&pair.landmarks);
        for (k, (l, residual)) in marked.zip(&residuals).enumerate() {
            let _ = writeln!(
                text,
                "{:>8.2}  {}",
                100.0 * residual,
                Label::new(k, l.name.as_deref())
            );
        }
        for finding in &findings {
            let _ = writeln!(text, "look at this: {finding}");
        }
        if findings.is_empty() {
            text += "nothing looks wrong\n";
        }
        say(&text)?;
    }
    Ok(ExitCode::from(u8::from(!findings.is_empty())))
}

fn next(args: &Suggest) -> anyhow::Result<ExitCode> {
    let pair = args.files.read()?;
    let suggestions = landmarks::suggest(&pair, args.number)?;
    if args.files.json {
        let list: Vec<_> = suggestions
            .iter()
            .map(|s| {
                let target: [f64; 3] = s.target.coords.into();
                serde_json::json!({
                    "source": { "vertex": pair.source.file_row(s.vertex) },
                    "target": { "point": target },
                    "distance_to_landmarks": s.alone.is_finite().then_some(s.alone),
                    "initial_miss": s.missed,
                })
            })
            .collect();
        say(&format!(
            "{:#}\n",
            serde_json::json!({ "suggestions": list })
        ))?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut text = String::new();
    for s in &suggestions {
        let at = pair.source.rest()[s.vertex];
        let alone = if s.alone.is_finite() {
            format!(
                "{:.0} % of the source's longest side from the nearest landmark",
                100.0 * s.alone
            )
        } else {
            "on a piece without a landmark".to_owned()
        };
        let _ = writeln!(
            text,
            "source vertex {} at ({:.4}, {:.4}, {:.4}): {alone}; the landmarks so far bring it {:.1} % of the \
             target's longest side away from the target, nearest at ({:.4}, {:.4}, {:.4})",
            pair.source.file_row(s.vertex),
            at.x,
            at.y,
            at.z,
            100.0 * s.missed,
            s.target.x,
            s.target.y,
            s.target.z
        );
    }
    say(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn add_mirrored(args: &Output) -> anyhow::Result<ExitCode> {
    args.check()?;
    let pair = args.files.read()?;
    let landmarks::Mirrored { added, plane } = landmarks::mirror(&pair)?;
    let n = plane.normal;
    let mut text = format!(
        "mirrored across the plane through ({:.4}, {:.4}, {:.4}) with normal ({}, {}, {}); {} added\n",
        plane.point.x,
        plane.point.y,
        plane.point.z,
        n.x,
        n.y,
        n.z,
        Landmark::marked(&added).count() + Curve::runs(&added).count()
    );
    for l in Landmark::marked(&added) {
        let _ = writeln!(text, "  {}", l.name.as_deref().unwrap_or_default());
    }
    for (curve, _) in Curve::runs(&added) {
        let _ = writeln!(text, "  {}", curve.name.as_deref().unwrap_or_default());
    }
    say(&text)?;
    let all: Vec<Landmark> = pair.landmarks.iter().chain(&added).cloned().collect();
    args.write(&pair, &all)
}

impl Convert {
    fn run(&self) -> anyhow::Result<ExitCode> {
        let output = &self.output;
        output.check()?;
        let pair = self.read()?;
        let Some(path) = &self.target_output else {
            return output.write(&pair, &pair.landmarks);
        };
        check_writable(path)?;
        let files = &output.files;
        check_distinct(path, &[&files.source, &files.target, &files.landmarks])?;
        ensure!(
            *path != output.output,
            "--target-output is the same file as -o"
        );
        let written = landmarks::write_wrap(&pair.landmarks, &pair.source, &pair.target)?;
        warn_lost(&Lost::without_both(&pair.landmarks));
        write_atomic(&output.output, written.source.as_bytes())?;
        write_atomic(path, written.target.as_bytes())?;
        say(&format!(
            "wrote {} and {}\n",
            output.output.display(),
            path.display()
        ))?;
        Ok(ExitCode::SUCCESS)
    }

    fn read(&self) -> anyhow::Result<Pair> {
        let files = &self.output.files;
        let Some(target) = &self.target_points else {
            return files.read();
        };
        let shapes = files.read_with(None)?;
        let points = WrapPoints {
            source: files.landmarks.as_path(),
            target: target.as_path(),
        };
        let landmarks = landmarks::read_wrap(points, &shapes.source, &shapes.target)?;
        Ok(Pair {
            landmarks,
            ..shapes
        })
    }
}

/// Says what a form of landmark file leaves out.
fn warn_lost(lost: &[Lost]) {
    let words = lost.iter();
    let words = words.map(|lost| format!("{lost}: this form has no place for it; json does"));
    warn(&words.collect::<Vec<_>>());
}

impl Output {
    fn check(&self) -> anyhow::Result<()> {
        let files = &self.files;
        ensure!(!files.json, "--json goes with check and suggest");
        check_writable(&self.output)?;
        let inputs: [&Path; 3] = [&files.source, &files.target, &files.landmarks];
        check_distinct(&self.output, &inputs)
    }

    fn form(&self) -> Form {
        let is_json = self
            .output
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("json"));
        match self.to {
            Some(form) => form.into(),
            None if is_json => Form::Json,
            None => Form::Text,
        }
    }

    fn write(&self, pair: &Pair, list: &[Landmark]) -> anyhow::Result<ExitCode> {
        let written = landmarks::write(list, &pair.source, &pair.target, self.form());
        if written.moved > 1e-6 * pair.source.bounds().longest_side() {
            warn(&[format!(
                "this form holds vertices only: places moved to the nearest one, by up to {:.4}",
                written.moved
            )]);
        }
        warn_lost(&written.lost);
        write_atomic(&self.output, written.text.as_bytes())?;
        say(&format!("wrote {}\n", self.output.display()))?;
        Ok(ExitCode::SUCCESS)
    }
}
