//! Runs tasks in processes of their own, several at a time.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use anyhow::{anyhow, Context as _};
use serde::Deserialize;

use super::row::{append, Row};
use super::{Frames, Method, Task, INITIAL};
use crate::Program;

/// How to run.
#[derive(Clone, Debug)]
pub(crate) struct Pool {
    /// This very program.
    program: Program,
    /// Runs at a time.
    jobs: usize,
    /// Threads for each run, where limited.
    threads: Option<usize>,
}

/// The part of a run's JSON that is kept.
#[derive(Deserialize)]
struct Outcome {
    figures: std::collections::BTreeMap<String, f64>,
    #[serde(default)]
    warnings: Vec<String>,
}

impl Pool {
    pub(crate) fn new(jobs: usize) -> anyhow::Result<Self> {
        Ok(Self {
            program: Program::present().context("cannot find this program to run it again")?,
            jobs: jobs.max(1),
            threads: (jobs > 1).then(|| (rayon::current_num_threads() / jobs).max(1)),
        })
    }

    /// The rows of all tasks, in order: those that are known and still right, the others run now and added to `store`.
    pub(super) fn run(
        &self,
        tasks: &[Task],
        known: &[Row],
        store: &Path,
    ) -> anyhow::Result<Vec<Row>> {
        let done = self.done(tasks, known);
        let n_done = done.iter().flatten().count();
        eprintln!("{} runs, {n_done} done before", tasks.len());

        let rows = Mutex::new((done, n_done));
        let next = AtomicUsize::new(0);
        let work = || -> anyhow::Result<()> {
            loop {
                let k = next.fetch_add(1, Ordering::Relaxed);
                let Some(task) = tasks.get(k) else {
                    return Ok(());
                };
                if lock(&rows).0[k].is_some() {
                    continue;
                }
                let row = self.run_one(task);
                let (rows, n_done) = &mut *lock(&rows);
                append(store, &row)?;
                *n_done += 1;
                eprintln!("{}", progress(&row, *n_done, tasks.len()));
                rows[k] = Some(row);
            }
        };
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..self.jobs).map(|_| scope.spawn(work)).collect();
            workers.into_iter().try_for_each(|w| {
                w.join()
                    .unwrap_or_else(|_| Err(anyhow!("a worker stopped")))
            })
        })?;
        Ok(rows
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
            .0
            .into_iter()
            .flatten()
            .collect())
    }

    /// The rows of tasks that are known and still right.
    pub(super) fn done(&self, tasks: &[Task], known: &[Row]) -> Vec<Option<Row>> {
        let by_command = known.iter().map(|row| (&row.command[..], row));
        let by_command: HashMap<&[String], &Row> = by_command.collect();
        tasks
            .iter()
            .map(|task| self.still_right(task, by_command.get(&self.arguments(task)[..])?))
            .collect()
    }

    /// The last row of a task's command, if it succeeded, its files are there, and nothing it came from is newer.
    fn still_right(&self, task: &Task, row: &Row) -> Option<Row> {
        let finished = UNIX_EPOCH + Duration::from_secs(row.finished + 1);
        let is_older = |path: &Path| {
            path.metadata()
                .and_then(|m| m.modified())
                .is_ok_and(|t| t <= finished)
        };
        let is_right =
            row.error.is_none() && task.inputs().all(is_older) && is_older(&self.program.file);
        (is_right && task.output.is_file() && task.picture.is_file()).then(|| row.clone())
    }

    fn run_one(&self, task: &Task) -> Row {
        let outcome = self.outcome(task);
        let (error, outcome) = match outcome {
            Ok(outcome) => (None, outcome),
            Err(error) => {
                let nothing = Outcome {
                    figures: Default::default(),
                    warnings: Vec::new(),
                };
                (Some(format!("{error:#}")), nothing)
            }
        };
        let now = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        Row {
            pair: task.pair.name.clone(),
            preset: task.method.label(),
            seed: task.seed,
            error,
            figures: outcome.figures,
            warnings: outcome.warnings,
            output: task.output.clone(),
            picture: task.picture.clone(),
            command: self.arguments(task),
            finished: now.as_secs(),
        }
    }

    fn outcome(&self, task: &Task) -> anyhow::Result<Outcome> {
        let mut outcome = self.child(&self.arguments(task))?;
        if let Some(judge) = &task.pair.judge {
            let judged = self.child(&task.judge_arguments(judge))?;
            outcome.figures.extend(judged.figures);
        }
        Ok(outcome)
    }

    fn child(&self, arguments: &[String]) -> anyhow::Result<Outcome> {
        let mut command = self.program.command();
        if let Some(threads) = self.threads {
            command.arg("--threads").arg(threads.to_string());
        }
        let output = command
            .args(arguments)
            .output()
            .context("cannot start a run")?;
        if !output.status.success() {
            let stderr = String::from_utf8_lossy(&output.stderr);
            let last = stderr
                .lines()
                .rev()
                .find(|line| !line.trim().is_empty())
                .unwrap_or("no message");
            return Err(anyhow!("{}", last.trim_start_matches("error: ")));
        }
        serde_json::from_slice(&output.stdout).context("the run printed no figures")
    }

    fn arguments(&self, task: &Task) -> Vec<String> {
        let is_initial = task.method == Method::Preset(INITIAL.to_owned());
        let command = if is_initial { "init" } else { "transfer" };
        let mut arguments = vec![
            command.to_owned(),
            text(&task.pair.source),
            text(&task.pair.target),
        ];
        let mut option = |name: &str, value: String| arguments.extend([name.to_owned(), value]);
        if let Some(landmarks) = &task.pair.landmarks {
            option("--landmarks", text(landmarks));
        }
        if let Some(truth) = &task.pair.truth {
            option("--truth", text(truth));
        }
        if let Some(Frames { first, before }) = &task.frames {
            option("--from", text(before));
            option("--first-frame", text(first));
        }
        match &task.method {
            _ if is_initial => (),
            Method::Preset(name) => option("--preset", name.clone()),
            Method::Config(path) => option("--config", text(path)),
        }
        if !is_initial {
            option("--seed", task.seed.to_string());
        }
        option("--output", text(&task.output));
        option("--render", text(&task.picture));
        arguments.extend(task.options.iter().cloned());
        arguments.push("--json".to_owned());
        arguments
    }
}

impl Task {
    /// The files that the run reads.
    fn inputs(&self) -> impl Iterator<Item = &Path> {
        let pair = &self.pair;
        let config = match &self.method {
            Method::Config(path) => Some(path),
            Method::Preset(_) => None,
        };
        let optional = [
            pair.landmarks.as_ref(),
            pair.truth.as_ref(),
            pair.judge.as_ref(),
            config,
            self.frames.as_ref().map(|frames| &frames.first),
            self.frames.as_ref().map(|frames| &frames.before),
        ];
        [Some(&pair.source), Some(&pair.target)]
            .into_iter()
            .chain(optional)
            .flatten()
            .map(PathBuf::as_path)
    }

    fn judge_arguments(&self, judge: &Path) -> Vec<String> {
        let mut arguments = vec![
            "metrics".to_owned(),
            text(&self.pair.source),
            text(&self.output),
            text(judge),
        ];
        if let Some(landmarks) = &self.pair.landmarks {
            arguments.extend(["--landmarks".to_owned(), text(landmarks)]);
        }
        if let Some(truth) = &self.pair.truth {
            arguments.extend(["--truth".to_owned(), text(truth)]);
        }
        arguments.push("--json".to_owned());
        arguments
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// The line about a run that has just ended, the `n_done`-th of `n`.
fn progress(row: &Row, n_done: usize, n: usize) -> String {
    let result = match (&row.error, row.figure("q_transfer")) {
        (Some(error), _) => format!("failed: {error}"),
        (None, Some(q)) => format!(
            "Q {q:.4}, {:.1} CPU-seconds",
            row.figure("cpu_seconds").unwrap_or(0.0)
        ),
        (None, None) => "done".to_owned(),
    };
    format!(
        "{n_done}/{n}  {} {} seed {}: {result}",
        row.pair, row.preset, row.seed
    )
}
