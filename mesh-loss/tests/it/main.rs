//! Every gradient against central differences, and the values that can be known.

mod finite_differences;
mod overlap;
mod pairs;
mod values;
