//! Integration tests.

mod bake;
