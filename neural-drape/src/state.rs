//! A drape in progress as bytes, to go on from later.

use mesh_core::{Point3, Vector3};

use crate::DrapeError;

/// What a drape in progress has come to: parameters, optimiser, position in the random draws, iteration.
///
/// Inputs and settings are not in it: [`crate::Drape::restore`] puts it into a drape made of the same ones. All numbers
/// are kept exactly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrapeState {
    bytes: Vec<u8>,
}

impl DrapeState {
    /// The state as bytes, little-endian.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The state of [`Self::as_bytes`]; what does not fit is found when it is restored.
    pub fn from_bytes(bytes: Vec<u8>) -> Self {
        Self { bytes }
    }

    pub(crate) fn write(write: impl FnOnce(&mut StateWriter)) -> Self {
        let mut writer = StateWriter { bytes: Vec::new() };
        write(&mut writer);
        Self {
            bytes: writer.bytes,
        }
    }

    pub(crate) fn reader(&self) -> StateReader<'_> {
        StateReader { rest: &self.bytes }
    }
}

/// Appends numbers to a state.
#[derive(Debug)]
pub struct StateWriter {
    bytes: Vec<u8>,
}

impl StateWriter {
    /// A whole number.
    pub fn count(&mut self, n: usize) {
        self.bytes.extend((n as u64).to_le_bytes());
    }

    /// Whole numbers and how many they are.
    pub fn counts(&mut self, entries: &[usize]) {
        self.count(entries.len());
        entries.iter().for_each(|&n| self.count(n));
    }

    /// A position in a stream of random words.
    pub fn word_position(&mut self, n: u128) {
        self.bytes.extend(n.to_le_bytes());
    }

    /// A number.
    pub fn real(&mut self, x: f64) {
        self.bytes.extend(x.to_le_bytes());
    }

    /// Numbers whose count the reader knows.
    pub fn singles<'a>(&mut self, entries: impl IntoIterator<Item = &'a f32>) {
        for x in entries {
            self.bytes.extend(x.to_le_bytes());
        }
    }

    /// Vectors whose count the reader knows.
    pub fn vectors<'a>(&mut self, entries: impl IntoIterator<Item = &'a Vector3>) {
        for v in entries {
            v.iter().for_each(|&x| self.real(x));
        }
    }

    /// Points whose count the reader knows.
    pub fn points<'a>(&mut self, entries: impl IntoIterator<Item = &'a Point3>) {
        for p in entries {
            p.iter().for_each(|&x| self.real(x));
        }
    }
}

/// Takes numbers off a state, in the order in which they were written.
#[derive(Debug)]
pub struct StateReader<'a> {
    rest: &'a [u8],
}

impl StateReader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], DrapeError> {
        let (first, rest) = self
            .rest
            .split_first_chunk::<N>()
            .ok_or(DrapeError::ForeignState)?;
        self.rest = rest;
        Ok(*first)
    }

    /// Nothing is left over.
    pub(crate) fn finish(self) -> Result<(), DrapeError> {
        if self.rest.is_empty() {
            Ok(())
        } else {
            Err(DrapeError::ForeignState)
        }
    }

    /// What [`StateWriter::count`] wrote.
    ///
    /// # Errors
    /// The state ends here; so for all that follow.
    pub fn count(&mut self) -> Result<usize, DrapeError> {
        let n = u64::from_le_bytes(self.take()?);
        usize::try_from(n).map_err(|_| DrapeError::ForeignState)
    }

    /// What [`StateWriter::counts`] wrote.
    ///
    /// # Errors
    /// See [`Self::count`].
    pub fn counts(&mut self) -> Result<Vec<usize>, DrapeError> {
        let n = self.count()?;
        if n > self.rest.len() / size_of::<u64>() {
            return Err(DrapeError::ForeignState);
        }
        (0..n).map(|_| self.count()).collect()
    }

    /// What [`StateWriter::word_position`] wrote.
    ///
    /// # Errors
    /// See [`Self::count`].
    pub fn word_position(&mut self) -> Result<u128, DrapeError> {
        Ok(u128::from_le_bytes(self.take()?))
    }

    /// What [`StateWriter::real`] wrote.
    ///
    /// # Errors
    /// See [`Self::count`].
    pub fn real(&mut self) -> Result<f64, DrapeError> {
        Ok(f64::from_le_bytes(self.take()?))
    }

    /// What [`StateWriter::singles`] wrote.
    ///
    /// # Errors
    /// See [`Self::count`].
    pub fn singles<'a>(
        &mut self,
        entries: impl IntoIterator<Item = &'a mut f32>,
    ) -> Result<(), DrapeError> {
        for x in entries {
            *x = f32::from_le_bytes(self.take()?);
        }
        Ok(())
    }

    /// What [`StateWriter::vectors`] wrote.
    ///
    /// # Errors
    /// See [`Self::count`].
    pub fn vectors<'a>(
        &mut self,
        entries: impl IntoIterator<Item = &'a mut Vector3>,
    ) -> Result<(), DrapeError> {
        for v in entries {
            for x in v.iter_mut() {
                *x = self.real()?;
            }
        }
        Ok(())
    }

    /// What [`StateWriter::points`] wrote.
    ///
    /// # Errors
    /// See [`Self::count`].
    pub fn points<'a>(
        &mut self,
        entries: impl IntoIterator<Item = &'a mut Point3>,
    ) -> Result<(), DrapeError> {
        for p in entries {
            for x in p.iter_mut() {
                *x = self.real()?;
            }
        }
        Ok(())
    }
}
