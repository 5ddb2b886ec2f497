//! What each stage of a run takes.

use mesh_core::{Clock, Profile};

/// The stage of the iterations, whose parts are told one by one.
pub const DRAPING: &str = "drape";
/// The stage of the iterations on a dense source itself.
pub const REFINING: &str = "drape, refined";

/// Time of each stage of a run by two clocks, and of the parts of its iterations. Clocks are the application's: a library
/// reads none by itself.
#[derive(Clone, Debug, Default)]
pub struct Stages {
    wall: Profile,
    cpu: Profile,
    parts: Profile,
}

impl Stages {
    /// Nothing is measured.
    pub const fn off() -> Self {
        Self {
            wall: Profile::off(),
            cpu: Profile::off(),
            parts: Profile::off(),
        }
    }

    /// Stages by both clocks: of the wall, and of all processors together.
    pub const fn on(wall: Clock, cpu: Clock) -> Self {
        Self {
            wall: Profile::on(wall),
            cpu: Profile::on(cpu),
            parts: Profile::off(),
        }
    }

    /// The parts of the iterations, too, by this clock.
    #[must_use]
    pub fn with_parts(self, clock: Clock) -> Self {
        Self {
            parts: Profile::on(clock),
            ..self
        }
    }

    /// Does the work of a stage.
    pub fn time<R>(&mut self, name: &'static str, work: impl FnOnce() -> R) -> R {
        self.wall.time(name, || self.cpu.time(name, work))
    }

    /// Does the work of a stage whose parts are measured.
    pub(crate) fn time_with_parts<R>(
        &mut self,
        name: &'static str,
        work: impl FnOnce(&mut Profile) -> R,
    ) -> R {
        let mut parts = self.parts.fresh();
        let done = self.time(name, || work(&mut parts));
        self.parts.extend(&parts);
        done
    }

    /// Adds what a drape measured of its parts.
    pub(crate) fn add_parts(&mut self, parts: &Profile) {
        self.parts.extend(parts);
    }

    /// A stopwatch for the parts of the iterations, at zero.
    pub(crate) fn fresh_parts(&self) -> Profile {
        self.parts.fresh()
    }

    /// The stages on the clock of the wall.
    pub fn wall(&self) -> &Profile {
        &self.wall
    }

    /// The stages in time of all processors.
    pub fn cpu(&self) -> &Profile {
        &self.cpu
    }

    /// The parts of the iterations, in time of all processors.
    pub fn parts(&self) -> &Profile {
        &self.parts
    }
}
