//! What a landmark is called.

use std::fmt;

use mesh_core::io::printable;

/// A landmark or a curve by its number and, if it has one, its name: `landmark 3 (nose)`, `curve 0 (lips)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Which of both.
    pub what: Labelled,
    /// Its place in the list of its kind, counted from 0. An application that numbers otherwise changes it.
    pub index: usize,
    /// Its name.
    pub name: Option<String>,
}

/// What has a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Labelled {
    /// A landmark that was marked by itself.
    Landmark,
    /// A curve.
    Curve,
}

impl Label {
    /// The label of the landmark in row `index`.
    pub fn new(index: usize, name: Option<&str>) -> Self {
        let name = name.filter(|name| !name.is_empty());
        Self {
            what: Labelled::Landmark,
            index,
            name: name.map(str::to_owned),
        }
    }

    /// The label of the curve in row `index` of the curves.
    pub fn of_curve(index: usize, name: Option<&str>) -> Self {
        Self {
            what: Labelled::Curve,
            ..Self::new(index, name)
        }
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.what {
            Labelled::Landmark => "landmark",
            Labelled::Curve => "curve",
        };
        write!(f, "{what} {}", self.index)?;
        match &self.name {
            Some(name) => write!(f, " ({})", printable(name)),
            None => Ok(()),
        }
    }
}
