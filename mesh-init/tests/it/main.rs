//! Initial deformations of whole shapes.

mod adjust;
mod affine;
mod arap;
mod biharmonic;
mod guide;
mod initialize;
mod interactive;
mod shapes;
mod similar;
