//! What a landmark is called.

use std::fmt;

use mesh_core::io::printable;

/// A landmark by its row and, if it has one, its name: `landmark 3 (nose)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Its row in the list, counted from 0. An application that numbers otherwise changes it.
    pub index: usize,
    /// Its name.
    pub name: Option<String>,
}

impl Label {
    /// The label of the landmark in row `index`.
    pub fn new(index: usize, name: Option<&str>) -> Self {
        let name = name.filter(|name| !name.is_empty());
        Self {
            index,
            name: name.map(str::to_owned),
        }
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "landmark {}", self.index)?;
        match &self.name {
            Some(name) => write!(f, " ({})", printable(name)),
            None => Ok(()),
        }
    }
}
