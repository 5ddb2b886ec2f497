//! `drape batch`

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{bail, ensure, Context as _};
use mesh_draping::Preset;

use super::evaluate::tell;
use crate::args::{is_pipe, MorphArgs, SettingsArgs, WeldArgs};
use crate::output::{check_distinct, check_mesh, say};
use crate::suite::{self, stem, Frames, Method, Pair, Pool, Shard, Task};
use crate::FAILED;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Mesh to drape over every target
    source: PathBuf,
    /// Meshes or point clouds to drape it over
    #[arg(required_unless_present = "targets_from")]
    targets: Vec<PathBuf>,
    /// File that names more of them, one on each line, for lists that are too long for a command line
    #[arg(long, value_name = "FILE")]
    targets_from: Option<PathBuf>,
    /// Landmark file of each target; {target} is its name, {folder} that of its folder, {source} that of the source
    #[arg(short, long, value_name = "PATTERN")]
    landmarks: Option<String>,
    /// File to write for each target, with the same names in braces
    #[arg(short, long, value_name = "PATTERN")]
    output: String,
    /// Folder for the tables and for what is done already
    #[arg(long, value_name = "FOLDER", default_value = "drape-batch")]
    summary: PathBuf,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    weld: WeldArgs,
    #[command(flatten)]
    morphs: MorphArgs,
    /// Runs at a time
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
    /// Only the K-th of N parts of the targets, for one machine of many; when all parts are done, the same line without
    /// this writes the tables
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Drape nothing, and print the numbers of the targets that are not done yet, counted from 1: of N targets, K is
    /// what --shard K/N drapes
    #[arg(long, conflicts_with_all = ["shard", "sequence"])]
    left: bool,
    /// The targets are the frames of a motion, in order: each drape starts from the result of the one before, and holds to
    /// the angles and areas of the first. Landmarks may lack from the second frame on
    #[arg(long, conflicts_with_all = ["shard", "jobs"])]
    sequence: bool,
    /// Weight of an even change along the surface from frame to frame: less trembling, and limbs that lag behind. 50 is a
    /// good value
    #[arg(long, value_name = "WEIGHT", requires = "sequence")]
    smooth_change: Option<f64>,
    /// Expect shapes like the results in this folder, as `transfer` does; not a folder that this batch writes to
    #[arg(long, value_name = "FOLDER", conflicts_with = "sequence")]
    prior: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    ensure!(
        args.settings.preset.is_none() || args.settings.config.is_none(),
        "give --preset or --config; a config file may name its preset"
    );
    let places = places(args)?;
    let mut files = places.iter().map(|place| &place.target);
    ensure!(
        !is_pipe(&args.source) && !files.any(|path| is_pipe(path)),
        "a batch reads files; standard input holds one mesh only"
    );
    args.settings.preset()?;
    let pool = Pool::new(args.jobs)?;
    if args.left {
        let left = suite::left(&tasks(args, &places)?, &args.summary, &pool)?;
        let lines = left.iter().map(|k| format!("{}\n", k + 1));
        say(&lines.collect::<String>())?;
        return Ok(ExitCode::SUCCESS);
    }
    let n_failed = match args.shard {
        None => tell(
            &suite::run(&tasks(args, &places)?, &args.summary, &pool)?,
            &args.summary,
        )?,
        Some(shard) => {
            let tasks = tasks(args, &shard.of(places))?;
            let rows = suite::run_shard(shard, &tasks, &args.summary, &pool)?;
            tell_shard(&rows)?
        }
    };
    // What was asked for is not all there: bad input, as with one target.
    Ok(ExitCode::from(if n_failed > 0 { FAILED } else { 0 }))
}

/// Says how many runs of a shard are done; how many failed.
fn tell_shard(rows: &[suite::Row]) -> anyhow::Result<usize> {
    let n_failed = rows.iter().filter(|row| row.error.is_some()).count();
    say(&format!(
        "{} of {} runs of this part done; without --shard, the same line writes the tables\n",
        rows.len() - n_failed,
        rows.len()
    ))?;
    Ok(n_failed)
}

/// A target, and the file that its result goes to.
struct Place {
    target: PathBuf,
    output: PathBuf,
}

/// All targets of the batch, no two of them with one result.
fn places(args: &Args) -> anyhow::Result<Vec<Place>> {
    for pattern in args.landmarks.iter().chain([&args.output]) {
        check_pattern(pattern)?;
    }
    let mut targets = args.targets.clone();
    if let Some(file) = &args.targets_from {
        targets.extend(listed(file)?);
    }
    let mut taken: HashMap<PathBuf, PathBuf> = HashMap::new();
    let mut places = Vec::with_capacity(targets.len());
    for target in targets {
        let output = PathBuf::from(fill(&args.output, &args.source, &target));
        if let Some(other) = taken.insert(output.clone(), target.clone()) {
            bail!(
                "{}: {} and {} would both be written here; use {{target}} or {{folder}} in --output",
                output.display(),
                other.display(),
                target.display()
            );
        }
        places.push(Place { target, output });
    }
    Ok(places)
}

/// The targets that a file names, one on each line.
fn listed(file: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let text = std::fs::read_to_string(file)
        .with_context(|| format!("{}: cannot be read", file.display()))?;
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    let targets: Vec<PathBuf> = lines.map(PathBuf::from).collect();
    ensure!(!targets.is_empty(), "{}: names no target", file.display());
    Ok(targets)
}

/// The runs of these targets; the folders of their results are made.
fn tasks(args: &Args, places: &[Place]) -> anyhow::Result<Vec<Task>> {
    let options = options(args);
    let mut tasks = Vec::with_capacity(places.len());
    for place in places {
        make_ready(args, place)?;
        let motion = if args.sequence { &tasks[..] } else { &[] };
        tasks.push(task(args, &options, place, motion));
    }
    Ok(tasks)
}

/// The options of every run.
fn options(args: &Args) -> Vec<String> {
    let mut options = vec![
        format!("--weld={}", args.weld.weld),
        format!("--morphs={}", args.morphs.morphs),
    ];
    options.extend(option("initial", args.settings.initial));
    options.extend(option("overlap", args.settings.overlap));
    let prior = args.prior.iter();
    options.extend(prior.map(|p| format!("--prior={}", p.display())));
    options
}

/// Refuses a result that cannot be written, and makes its folder.
fn make_ready(args: &Args, Place { target, output }: &Place) -> anyhow::Result<()> {
    if let Some(folder) = output.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
    }
    check_mesh(output)?;
    check_not_prior(output, args.prior.as_deref())?;
    check_distinct(output, &[&args.source, target])
}

/// The run of a target, after those of the frames of its motion so far.
fn task(args: &Args, options: &[String], place: &Place, motion: &[Task]) -> Task {
    let Place { target, output } = place;
    let method = match (&args.settings.config, &args.settings.preset) {
        (Some(path), _) => Method::Config(path.clone()),
        (None, preset) => Method::Preset(preset.clone().unwrap_or_else(|| Preset::standard().name)),
    };
    let landmarks = args.landmarks.as_deref();
    let landmarks = landmarks.map(|pattern| PathBuf::from(fill(pattern, &args.source, target)));
    let (first, before) = (motion.first(), motion.last());
    Task {
        pair: Pair {
            name: stem(output),
            source: args.source.clone(),
            target: target.clone(),
            // They may lack from the second frame on.
            landmarks: landmarks.filter(|path| before.is_none() || path.is_file()),
            truth: None,
            judge: None,
        },
        frames: first.zip(before).map(|(first, before)| Frames {
            first: first.output.clone(),
            before: before.output.clone(),
        }),
        method,
        options: options_of(args, options, before.is_none()),
        seed: args.settings.seed.unwrap_or(0),
        picture: output.with_extension("png"),
        output: output.clone(),
    }
}

/// The options of a task: those of all, and for the frames of a motion after the first how evenly they change.
fn options_of(args: &Args, options: &[String], is_first: bool) -> Vec<String> {
    let smooth_change = args.smooth_change.filter(|_| !is_first);
    let smooth_change = smooth_change.map(|weight| format!("--smooth-change={weight}"));
    options.iter().cloned().chain(smooth_change).collect()
}

/// Refuses a prior that would grow while the batch runs: results would depend on their order.
fn check_not_prior(output: &Path, prior: Option<&Path>) -> anyhow::Result<()> {
    let (Some(folder), Some(prior)) = (output.parent(), prior) else {
        return Ok(());
    };
    let is_same = match (folder.canonicalize(), prior.canonicalize()) {
        (Ok(folder), Ok(prior)) => folder == prior,
        _ => false,
    };
    ensure!(
        !is_same,
        "{}: the results of this batch cannot be their own prior; name another folder",
        prior.display()
    );
    Ok(())
}

/// An option of the command line with the name of its value, where it is given.
fn option(name: &str, value: Option<impl clap::ValueEnum>) -> Option<String> {
    let value = value?.to_possible_value()?;
    Some(format!("--{name}={}", value.get_name()))
}

/// Refuses a name in braces that stands for nothing, and a brace that is not closed.
fn check_pattern(pattern: &str) -> anyhow::Result<()> {
    for opened in pattern.split('{').skip(1) {
        let (name, _) = opened
            .split_once('}')
            .with_context(|| format!("{pattern}: a {{ is not closed"))?;
        ensure!(
            ["source", "target", "folder"].contains(&name),
            "{pattern}: {{{name}}} stands for nothing; there are {{source}}, {{target}} and {{folder}}"
        );
    }
    Ok(())
}

/// The pattern with its names in braces replaced.
fn fill(pattern: &str, source: &Path, target: &Path) -> String {
    let folder = target
        .parent()
        .and_then(Path::file_name)
        .unwrap_or_default();
    pattern
        .replace("{source}", &stem(source))
        .replace("{target}", &stem(target))
        .replace("{folder}", &folder.to_string_lossy())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_of_the_command_line_go_to_every_run() {
        use clap::Args as _;
        let command = Args::augment_args(clap::Command::new("batch"));
        let line = "batch a.obj b.obj -o {target}.obj --initial paper --overlap source-partial";
        let matches = command.try_get_matches_from(line.split(' ')).unwrap();
        let args = <Args as clap::FromArgMatches>::from_arg_matches(&matches).unwrap();
        for option in ["--initial=paper", "--overlap=source-partial"] {
            let tasks = tasks(&args, &places(&args).unwrap()).unwrap();
            assert!(tasks[0].options.iter().any(|o| o == option), "{option}");
        }
    }

    #[test]
    fn unknown_names_in_braces_are_refused() {
        assert!(check_pattern("out/{folder}-{target}-{source}.obj").is_ok());
        let open = check_pattern("out/{target.obj").unwrap_err().to_string();
        assert!(open.contains("not closed"), "{open}");
        let told = check_pattern("{targets}.obj").unwrap_err().to_string();
        assert!(told.contains("{targets} stands for nothing"), "{told}");
    }

    #[test]
    fn names_in_braces_are_replaced() {
        let filled = fill(
            "out/{folder}-{target}-{source}.obj",
            Path::new("a/horse.obj"),
            Path::new("b/wolf/target.ply"),
        );
        assert_eq!(filled, "out/wolf-target-horse.obj");
    }
}
