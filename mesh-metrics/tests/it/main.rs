//! Tests of the public functions together.

mod cloud;
mod invariance;
mod shifted_copy;
