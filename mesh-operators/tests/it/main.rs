//! Operators and solvers on whole shapes.

mod operators;
mod shapes;
mod solvers;
