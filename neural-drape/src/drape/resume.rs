//! A drape in progress is kept, and gone on with later.

use mesh_loss::HardCorners;

use super::Drape;
use crate::setting::MAX_COUNT;
use crate::{DrapeError, DrapeState};

impl Drape {
    /// What the drape has come to, to go on from later with [`Self::restore`].
    pub fn state(&mut self) -> DrapeState {
        DrapeState::write(|state| {
            state.count(self.iteration);
            state.count(self.n_iterations);
            state.word_position(self.rng.word_position());
            let hard = self.matcher.hard_corners();
            state.counts(&hard.of_mesh);
            state.counts(&hard.of_target);
            state.points(self.structure.anchored_at());
            self.guidance.save(state);
            self.parametrization.save(state);
            if let Some(apart) = &self.apart {
                apart.save(state);
            }
        })
    }

    /// Goes on where a drape of the same inputs and settings had come to. Landmarks stay those of this drape.
    ///
    /// # Errors
    /// The state is that of another drape, or damaged; this drape is then of no more use.
    pub fn restore(&mut self, state: &DrapeState) -> Result<(), DrapeError> {
        let mut reader = state.reader();
        let (iteration, n_iterations) = (reader.count()?, reader.count()?);
        let possible = self.n_iterations..=MAX_COUNT;
        if iteration > n_iterations || !possible.contains(&n_iterations) {
            return Err(DrapeError::ForeignState);
        }
        self.extend(n_iterations - self.n_iterations);
        self.iteration = iteration;
        self.rng.set_word_position(reader.word_position()?);
        let hard = HardCorners {
            of_mesh: reader.counts()?,
            of_target: reader.counts()?,
        };
        if !self.matcher.set_hard_corners(hard) {
            return Err(DrapeError::ForeignState);
        }
        let mut anchor = self.structure.anchored_at().clone();
        reader.points(anchor.iter_mut())?;
        self.structure.anchor(&self.triangulation, &anchor);
        self.guidance.restore(&mut reader)?;
        self.parametrization.restore(&mut reader)?;
        if let Some(apart) = &mut self.apart {
            apart.restore(self.gradient.len(), &mut reader)?;
        }
        reader.finish()
    }
}
