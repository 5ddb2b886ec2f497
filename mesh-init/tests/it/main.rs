//! Initial deformations of whole shapes.

mod adjust;
mod affine;
mod arap;
mod biharmonic;
mod initialize;
mod shapes;
mod similar;
