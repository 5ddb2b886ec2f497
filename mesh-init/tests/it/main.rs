//! Initial deformations of whole shapes.

mod affine;
mod arap;
mod biharmonic;
mod initialize;
mod shapes;
mod similar;
