//! Boxes in single precision.

/// A box in the unit frame.
#[derive(Clone, Copy)]
pub(super) struct Box32 {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

impl Box32 {
    /// The box that holds nothing; finite, so that distances to it are numbers.
    pub(super) const EMPTY: Self = Self {
        min: [f32::MAX; 3],
        max: [f32::MIN; 3],
    };
}
