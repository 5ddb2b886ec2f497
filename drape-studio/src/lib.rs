//! Mesh draping in the browser: mark places, see what they do, drape, pause, add places, resume.
//!
//! | to | call |
//! |---|---|
//! | serve the studio | [`Studio::open`], [`Studio::url`], [`Studio::serve`] |
//! | do a recorded session again | [`replay`] |
//!
//! The session is changed in one place, a thread with an inbox (`controller`). Drapes, previews and figures have threads of
//! their own; pages are shown the newest of each and pass over older ones (`broadcast`). What is done to a drape is logged
//! with the iteration (`course`), so that [`replay`] comes to the same bits. The program that starts the studio lends
//! it its [`Toolbox`]: settings, landmark files, the initial deformation and the report are those of the command line.

mod broadcast;
mod checkpoint;
mod controller;
mod course;
mod display;
mod figures;
mod landmark_file;
mod latest;
mod pick;
mod preview;
mod replay;
mod runner;
mod scene;
mod server;
mod session;
mod studio;
mod toolbox;

pub use replay::{replay, Replayed};
pub use scene::{Scene, Source, Target};
pub use studio::{Options, Studio};
pub use toolbox::{
    Deformed, Finished, InnerPart, Parts, Settings, TargetParts, Toolbox, Treatment,
};
