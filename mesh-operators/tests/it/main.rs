//! Operators and solvers on whole shapes.

mod fields;
mod operators;
mod shapes;
mod solvers;
