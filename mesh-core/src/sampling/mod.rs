//! Random places on triangles, and the random numbers they are drawn with.

mod seeded_rng;
mod triangle_sampler;

pub use seeded_rng::SeededRng;
pub use triangle_sampler::{TrianglePlace, TriangleSampler};
