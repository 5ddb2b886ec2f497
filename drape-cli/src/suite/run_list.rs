//! The runs of one manifest or several.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::bail;

use super::{Manifest, Method, Task};

/// Manifests one after the other, no two pairs of one name.
#[derive(Debug)]
pub(crate) struct RunList(Vec<Manifest>);

impl RunList {
    /// Reads all of them.
    ///
    /// # Errors
    /// A manifest that cannot be read, or a pair whose name another manifest has too.
    pub(crate) fn read(paths: &[PathBuf]) -> anyhow::Result<Self> {
        let manifests = paths.iter().map(|path| Manifest::read(path));
        Self::new(manifests.collect::<anyhow::Result<_>>()?)
    }

    pub(super) fn new(manifests: Vec<Manifest>) -> anyhow::Result<Self> {
        let mut names = BTreeSet::new();
        for name in manifests.iter().flat_map(Manifest::names) {
            if !names.insert(name) {
                bail!("two manifests have a pair '{name}'; give each its own `name`");
            }
        }
        Ok(Self(manifests))
    }

    /// One more manifest, behind the others.
    ///
    /// # Errors
    /// It has a pair whose name another has.
    pub(crate) fn push(&mut self, manifest: Manifest) -> anyhow::Result<()> {
        let mut manifests = std::mem::take(&mut self.0);
        manifests.push(manifest);
        *self = Self::new(manifests)?;
        Ok(())
    }

    /// The same pairs with these settings and seeds in place of those that the manifests name.
    pub(crate) fn with_methods(self, methods: &[Method], seeds: &[u64]) -> Self {
        let manifests = self.0.into_iter();
        Self(manifests.map(|m| m.with_methods(methods, seeds)).collect())
    }

    /// The names of the pairs that are there, in order.
    pub(crate) fn names(&self) -> Vec<&str> {
        self.0.iter().flat_map(Manifest::names).collect()
    }

    /// The runs, manifest by manifest and pair by pair; their files go into a folder for each pair.
    pub(crate) fn tasks(&self, folder: &Path) -> anyhow::Result<Vec<Task>> {
        let tasks = self.0.iter().map(|manifest| manifest.tasks(folder));
        Ok(tasks.collect::<anyhow::Result<Vec<_>>>()?.concat())
    }

    /// The pairs that are left out because their data is not there.
    pub(crate) fn absent(&self) -> Vec<&str> {
        let absent = self.0.iter().flat_map(Manifest::absent);
        absent.map(String::as_str).collect()
    }

    /// Whether one shape of a pair has parts that the other lacks.
    pub(crate) fn is_partial(&self, pair: &str) -> bool {
        self.0.iter().any(|manifest| manifest.is_partial(pair))
    }

    /// The section of a pair on a page of results; none for a pair that is not listed.
    pub(crate) fn section(&self, pair: &str) -> Option<&str> {
        self.0.iter().find_map(|manifest| manifest.section(pair))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(pair: &str) -> Manifest {
        let text = format!("[[pair]]\nname = '{pair}'\nsource = 's.obj'\ntarget = 't.obj'\n");
        Manifest::parse(&text, Path::new(""), None).unwrap()
    }

    #[test]
    fn manifests_follow_each_other_and_share_no_name() {
        let folder = tempfile::tempdir().unwrap();
        let list = RunList::new(vec![manifest("b"), manifest("a")]).unwrap();
        let tasks = list.tasks(folder.path()).unwrap();
        let names: Vec<&str> = tasks.iter().map(|task| task.pair.name.as_str()).collect();
        assert_eq!(names, ["b", "a"]);
        let error = RunList::new(vec![manifest("a"), manifest("a")]).unwrap_err();
        assert!(error.to_string().contains("'a'"));
    }
}
