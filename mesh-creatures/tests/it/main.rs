//! What holds for every plan, individual and pair.

mod individuals;
mod pairs;
mod templates;
