//! `drape bench`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::ensure;
use mesh_core::io::write_atomic;
use mesh_creatures::{Plan, Variant};
use mesh_draping::Preset;

use super::evaluate::tell;
use crate::creatures::{self, BenchRow, Case, Grid, PairFiles, Table};
use crate::output::say;
use crate::suite::{self, Manifest, Pair, Pool, INITIAL};

// What is draped where nothing is asked for: the middle of the dial.
const ANGLES: [f64; 1] = [60.0];
const RATIOS: [f64; 1] = [1.75];
const LANDMARKS: [usize; 1] = [16];
const N_SEEDS: u64 = 2;
const VARIANTS: [Variant; 1] = [Variant::Mesh];

fn presets() -> [String; 1] {
    [Preset::standard().name]
}

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Kinds of creature: quadruped, person, bird, insect, head [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    plan: Vec<Plan>,
    /// Largest turn of a joint, in degrees, 0 to 120
    #[arg(long, value_name = "DEGREES", value_delimiter = ',', default_values_t = ANGLES)]
    angle: Vec<f64>,
    /// Largest ratio of lengths, 1 to 3
    #[arg(long, value_name = "RATIOS", value_delimiter = ',', default_values_t = RATIOS)]
    ratio: Vec<f64>,
    /// Number of landmarks, 0 to 20
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', default_values_t = LANDMARKS)]
    landmarks: Vec<usize>,
    /// Parts without landmarks, by name, such as 'tail' or 'left ear'
    #[arg(long, value_name = "PARTS", value_delimiter = ',')]
    without: Vec<String>,
    /// Individuals: 0 to N − 1
    #[arg(long, value_name = "N", default_value_t = N_SEEDS)]
    seeds: u64,
    /// State of the target: mesh, cloud, cracked, half-scan
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_values_t = VARIANTS)]
    variant: Vec<Variant>,
    /// Presets, or TOML files of settings
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_values_t = presets())]
    preset: Vec<String>,
    /// Folder for pairs, results, tables and pictures; what is done in it already is not done again
    #[arg(short, long, value_name = "FOLDER", default_value = "drape-bench")]
    output: PathBuf,
    /// Write the pairs as files into this folder, and drape nothing
    #[arg(long, value_name = "FOLDER")]
    write: Option<PathBuf>,
    /// Runs at a time
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
}

/// Largest number of landmarks.
const MOST_LANDMARKS: usize = 20;
/// Where creatures stand on a page of results.
const SECTION: &str = "Creatures";

pub(super) fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let grid = args.grid()?;
    let cases = grid.cases();
    if let Some(folder) = &args.write {
        for case in &cases {
            creatures::write(&folder.join(case.name()), &case.pair(&grid.without))?;
        }
        say(&format!(
            "{} pairs written to {}\n",
            cases.len(),
            folder.display()
        ))?;
        return Ok(ExitCode::SUCCESS);
    }
    let manifest = args.manifest([INITIAL.to_owned()])?;
    let rows = suite::run(
        &manifest.tasks(&args.output)?,
        &args.output,
        &Pool::new(args.jobs)?,
    )?;
    let table = table(&cases, &rows);
    write_atomic(args.output.join("bench.csv"), table.csv().as_bytes())?;
    write_atomic(
        args.output.join("bench.json"),
        serde_json::to_string_pretty(&table.0)?.as_bytes(),
    )?;
    say(&table.text())?;
    let n_failed = tell(&rows, &args.output)?;
    Ok(ExitCode::from(u8::from(n_failed > 0)))
}

impl Args {
    /// What the command does with no more than a folder.
    pub(super) fn with_defaults(output: &Path, jobs: usize) -> Self {
        Self {
            plan: Vec::new(),
            angle: ANGLES.to_vec(),
            ratio: RATIOS.to_vec(),
            landmarks: LANDMARKS.to_vec(),
            without: Vec::new(),
            seeds: N_SEEDS,
            variant: VARIANTS.to_vec(),
            preset: presets().to_vec(),
            output: output.to_owned(),
            write: None,
            jobs,
        }
    }

    /// All cases as pairs of a suite, whose files are written; `also` names presets beside those that are asked for.
    pub(super) fn manifest(
        &self,
        also: impl IntoIterator<Item = String>,
    ) -> anyhow::Result<Manifest> {
        let presets: Vec<String> = self.preset.iter().cloned().chain(also).collect();
        // Checked before any file is written.
        Manifest::of_pairs(&presets, SECTION, Vec::new())?;
        let (grid, folder) = (self.grid()?, self.output.join("pairs"));
        let cases = grid.cases();
        let pairs = cases.iter().map(|case| pair(case, &grid, &folder));
        Manifest::of_pairs(&presets, SECTION, pairs.collect::<anyhow::Result<_>>()?)
    }

    fn grid(&self) -> anyhow::Result<Grid> {
        let is_angle = |a: &f64| (0.0..=120.0).contains(a);
        ensure!(
            self.angle.iter().all(is_angle),
            "--angle: use 0 to 120 degrees"
        );
        let is_ratio = |r: &f64| (1.0..=3.0).contains(r);
        ensure!(self.ratio.iter().all(is_ratio), "--ratio: use 1 to 3");
        let is_number = |n: &usize| *n <= MOST_LANDMARKS;
        ensure!(
            self.landmarks.iter().all(is_number),
            "--landmarks: use 0 to {MOST_LANDMARKS}"
        );
        Ok(Grid {
            plans: if self.plan.is_empty() {
                Plan::ALL.to_vec()
            } else {
                self.plan.clone()
            },
            angles: self.angle.clone(),
            ratios: self.ratio.clone(),
            n_landmarks: self.landmarks.clone(),
            variants: self.variant.clone(),
            seeds: (0..self.seeds).collect(),
            without: self.without.clone(),
        })
    }
}

/// The files of a case as a pair of a suite; a cloud and a scan are judged by the surface that they are of.
fn pair(case: &Case, grid: &Grid, folder: &Path) -> anyhow::Result<Pair> {
    let name = case.name();
    let files = creatures::write(&folder.join(&name), &case.pair(&grid.without))?;
    let PairFiles {
        source,
        target,
        landmarks,
        truth,
        surface,
    } = files;
    Ok(Pair {
        name,
        source,
        target,
        landmarks,
        truth: Some(truth),
        judge: surface,
    })
}

fn table(cases: &[Case], rows: &[suite::Row]) -> Table {
    let row_of = |case: &Case| {
        let of_case: Vec<&suite::Row> = rows.iter().filter(|row| row.pair == case.name()).collect();
        let initial = of_case.iter().copied().find(|row| row.preset == INITIAL);
        let runs = of_case.into_iter().filter(|row| row.preset != INITIAL);
        runs.map(|run| BenchRow::new(case, run, initial))
            .collect::<Vec<_>>()
    };
    Table(cases.iter().flat_map(row_of).collect())
}
