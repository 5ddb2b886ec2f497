//! Mesh draping in the browser: mark places, see what they do, drape, pause, add places, resume.
//!
//! | to | call |
//! |---|---|
//! | serve the studio | [`Studio::open`], [`Studio::url`], [`Studio::serve`] |
//! | do a recorded session again | [`replay`] |
//!
//! What is draped and how is [`mesh_draping`]'s; here is what shows it and keeps it. The session is changed in one place,
//! a thread with an inbox (`controller`). Drapes, previews and figures have threads of their own; pages are shown the
//! newest of each and pass over older ones (`broadcast`). What is done to a drape is logged with the iteration
//! (`logged_run`), so that [`replay`] comes to the same bits.

mod address;
mod broadcast;
mod buffers;
mod checkpoint;
mod controller;
mod displayed;
mod figures;
mod heat;
mod kept_files;
mod latest;
mod logged_run;
mod looks;
mod pick;
mod preview;
mod replay;
mod runner;
mod seams;
mod server;
mod session;
mod shapes;
mod studio;

pub use replay::{replay, Replayed};
pub use studio::{Options, Studio};

/// The examples of the README, which are tested as those of the documentation are.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
