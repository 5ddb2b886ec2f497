//! A part of a list of runs, for a machine of its own.

use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Where the rows of shards are, beside those of whole lists.
const FOLDER: &str = "shards";

/// The K-th of N parts of a list: every N-th run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// Counted from 1.
    k: usize,
    n: usize,
}

/// `K/N`.
impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers = text.split_once('/');
        let numbers = numbers.and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((k, n)) if (1..=n).contains(&k) => Ok(Self { k, n }),
            _ => Err("use K/N, K from 1 to N".to_owned()),
        }
    }
}

impl Shard {
    /// Those that are in this part.
    pub(crate) fn of<T>(self, list: Vec<T>) -> Vec<T> {
        let mine = list.into_iter().skip(self.k - 1);
        mine.step_by(self.n).collect()
    }

    /// The file of the rows of this part: no other machine writes there.
    pub(super) fn store(self, folder: &Path) -> PathBuf {
        let Self { k, n } = self;
        folder.join(FOLDER).join(format!("{k}-of-{n}.jsonl"))
    }
}

/// The files of rows in a folder that are worth reading: of the whole list, then of shards by name. To a shard, the others
/// of its own cut have nothing to tell.
pub(super) fn stores(folder: &Path, own: Option<Shard>) -> Vec<PathBuf> {
    let listed = std::fs::read_dir(folder.join(FOLDER)).into_iter().flatten();
    let files = listed.flatten().map(|entry| entry.path());
    let is_told = |path: &PathBuf| match (rows_of(path), own) {
        (None, _) => false,
        (Some(of), Some(own)) => of.n != own.n || of.k == own.k,
        (Some(_), None) => true,
    };
    let mut shards: Vec<PathBuf> = files.filter(is_told).collect();
    shards.sort();
    std::iter::once(folder.join(super::STORE))
        .chain(shards)
        .collect()
}

/// Whose rows a file has, by its name.
fn rows_of(path: &Path) -> Option<Shard> {
    let name = path.file_name()?.to_str()?.strip_suffix(".jsonl")?;
    name.replacen("-of-", "/", 1).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_is_in_one_part() {
        let list: Vec<u32> = (0..10).collect();
        let parts = (1..=4).map(|k| Shard { k, n: 4 }.of(list.clone()));
        let mut all: Vec<u32> = parts.flatten().collect();
        all.sort_unstable();
        assert_eq!(all, list);
    }

    #[test]
    fn a_part_is_named_by_two_numbers() {
        assert_eq!("3/40".parse(), Ok(Shard { k: 3, n: 40 }));
        for wrong in ["0/4", "5/4", "3", "a/b", "1/0", ""] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_part_does_not_read_the_others_of_its_cut() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join(FOLDER)).unwrap();
        for (k, n) in [(1, 3), (2, 3), (3, 3), (1, 2)] {
            std::fs::write(Shard { k, n }.store(folder.path()), "").unwrap();
        }
        let read = |own| {
            let stores = stores(folder.path(), own);
            let names = stores.iter().skip(1).map(|path| super::super::stem(path));
            names.collect::<Vec<String>>()
        };
        assert_eq!(read(Some(Shard { k: 2, n: 3 })), ["1-of-2", "2-of-3"]);
        assert_eq!(read(None), ["1-of-2", "1-of-3", "2-of-3", "3-of-3"]);
    }
}
