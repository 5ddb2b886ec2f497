//! A study as text for a page, and its curve.

use std::path::{Path, PathBuf};

use anyhow::bail;
use mesh_core::io::write_atomic;

use super::{curve, pairs, tables, Study};
use crate::suite::{origin, Row, RunList};

/// The finished runs of a study.
pub(crate) struct Report<'a> {
    pub(crate) study: Study,
    pub(crate) list: &'a RunList,
    pub(crate) rows: &'a [Row],
}

impl Report<'_> {
    /// The text of a page: where the figures come from, the tables, and the curve at the address `curve`, where there is one.
    /// `commit` is the state of the program's sources, in the caller's words.
    ///
    /// # Errors
    /// A run without a result.
    pub(crate) fn page(&self, commit: &str, curve: Option<&str>) -> anyhow::Result<String> {
        if let Some(row) = self.rows.iter().find(|row| row.error.is_some()) {
            bail!(
                "{}, {} has no result, so that no page is written",
                row.pair,
                row.preset
            );
        }
        let mut text = origin(self.rows, commit);
        text += " Each cell is a mean over pairs and seeds ± the standard deviation over the\n\
                 seeds of the mean over pairs. Distances are in longest sides of the target's box.\n";
        text += &self.tables();
        if let Some(address) = curve {
            text += &format!("\n![Distance to the truth over the angle of limbs]({address})\n");
        }
        Ok(text)
    }

    /// The tables, as Markdown.
    pub(crate) fn tables(&self) -> String {
        let pairs = self.list.names();
        let themes = self.study.themes().iter();
        let mut text: String = themes
            .map(|t| tables::theme(t, &pairs, self.rows))
            .collect();
        match self.study {
            Study::Paper => text += &tables::table_1(self.rows),
            Study::Dial => text += &tables::dial(&pairs::rows_of_cases(self.study), self.rows),
            Study::Encoding | Study::Network => {}
        }
        text
    }

    /// Writes the curve into `folder` and gives its path; none where the pairs are not those of the dial.
    pub(crate) fn write_curve(&self, folder: &Path) -> anyhow::Result<Option<PathBuf>> {
        let settings = pairs::settings(self.study);
        let names: Vec<String> = settings.iter().map(pairs::Setting::name).collect();
        if self.study != Study::Encoding || self.list.names() != names {
            return Ok(None);
        }
        let [theme] = self.study.themes() else {
            return Ok(None);
        };
        let path = folder.join(format!("study-{}.svg", self.study.name()));
        write_atomic(&path, curve::svg(theme, &settings, self.rows).as_bytes())?;
        Ok(Some(path))
    }
}
