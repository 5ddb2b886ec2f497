//! What finished runs are held against, and the page they are written to.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{bail, Context as _};
use mesh_core::io::write_atomic;

use crate::output::{check_writable, say};
use crate::suite::{Bounds, Marks, Page, Row, RunList, Verdict};

/// What finished runs are held against, and the page they are written to.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct GateArgs {
    /// TOML file of what each run has reached; the exit code is 1 where one falls behind by more than a small slack
    #[arg(long, value_name = "FILE")]
    bounds: Option<PathBuf>,
    /// Write what was gained into the file of bounds; none is loosened, and nothing is written where one is broken
    #[arg(long, requires = "bounds")]
    tighten: bool,
    /// Markdown page with marks between which the figures are written
    #[arg(long, value_name = "MD", requires = "commit")]
    page: Option<PathBuf>,
    /// What the page says of the program's sources, such as the output of `git describe --always --dirty`
    #[arg(long, value_name = "TEXT")]
    commit: Option<String>,
}

impl GateArgs {
    /// The page that a study is written to, and what it says of the program's sources.
    ///
    /// # Errors
    /// Bounds, which studies have none of.
    pub(crate) fn page_of_study(&self) -> anyhow::Result<Option<(&Path, &str)>> {
        if self.bounds.is_some() {
            bail!("--bounds: a study is held against none");
        }
        Ok(self.page.as_deref().zip(self.commit.as_deref()))
    }

    /// Refuses what cannot be done, before any run.
    pub(crate) fn check(&self, list: &RunList) -> anyhow::Result<()> {
        if let Some(path) = self.bounds.as_ref().filter(|_| self.tighten) {
            check_writable(path)?;
        }
        if let Some(page) = &self.page {
            write_between(&Marks::figures(), page, None)?;
            let absent = list.absent();
            if !absent.is_empty() {
                bail!(
                    "{}: a page needs all pairs, and there are no files of {}",
                    page.display(),
                    absent.join(", ")
                );
            }
        }
        self.known()?;
        Ok(())
    }

    /// Compares the rows with the bounds, says how that went, and writes bounds and page; whether all bounds hold.
    pub(crate) fn judge(&self, list: &RunList, rows: &[Row]) -> anyhow::Result<bool> {
        let mut holds = true;
        if let Some(path) = &self.bounds {
            let bounds = self.known()?;
            let verdict = bounds.compare(rows);
            tell(&verdict, rows.len())?;
            holds = verdict.broken.is_empty();
            if self.tighten && holds {
                let tightened = bounds.tightened(rows, |pair| list.is_partial(pair));
                write_atomic(path, tightened.to_toml().as_bytes())?;
                say(&format!("wrote {}\n", path.display()))?;
            }
        }
        if let (Some(path), Some(commit)) = (&self.page, &self.commit) {
            let page = Page { list, rows, commit };
            let text = page.written_into(&read_page(path)?);
            let text = text.with_context(|| path.display().to_string())?;
            write_atomic(path, text.as_bytes())?;
            say(&format!("wrote {}\n", path.display()))?;
        }
        Ok(holds)
    }

    /// The bounds of the file; none yet where one is to be written that is not there.
    fn known(&self) -> anyhow::Result<Bounds> {
        match &self.bounds {
            Some(path) if !self.tighten || path.exists() => Bounds::read(path),
            _ => Ok(Bounds::default()),
        }
    }
}

/// Writes `text` between the marks of a page; without it, sees only whether the marks are there.
///
/// # Errors
/// A page that cannot be read or written, or lacks the marks.
pub(crate) fn write_between(marks: &Marks, path: &Path, text: Option<&str>) -> anyhow::Result<()> {
    let page = read_page(path)?;
    let filled = marks.fill(&page, text.unwrap_or_default());
    let filled = filled.with_context(|| path.display().to_string())?;
    if text.is_some() {
        write_atomic(path, filled.as_bytes())?;
        say(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

fn read_page(path: &Path) -> anyhow::Result<String> {
    fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))
}

fn tell(verdict: &Verdict, n_rows: usize) -> anyhow::Result<()> {
    for broken in &verdict.broken {
        eprintln!("behind its bound: {broken}");
    }
    let n_held = n_rows - verdict.n_unbounded;
    say(&format!(
        "{n_held} runs held against their bounds, {} bounds broken; {} runs have no bound, {} bounds were not run\n",
        verdict.broken.len(),
        verdict.n_unbounded,
        verdict.n_not_run
    ))?;
    Ok(())
}
