//! Losses of mesh draping, each a value and an analytic gradient in f64.
