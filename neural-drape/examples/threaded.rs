//! A drape on a thread of its own, with progress, pause and cancel: what a window does.
//!
//! `cargo run --release -p neural-drape --example threaded`

use std::error::Error;
use std::sync::mpsc::{channel, Receiver, Sender, TryRecvError};
use std::sync::Arc;
use std::thread;

use neural_drape::mesh_core::{
    shapes, Point3, Positions, TargetSurface, TriangleSoup, Triangulation,
};
use neural_drape::{Drape, DrapeConfig, DrapeError, DrapeInput};

/// What the window asks of the thread.
enum Command {
    Pause,
    Resume,
    Cancel,
}

/// What the thread tells the window.
#[derive(Debug, PartialEq)]
enum Event {
    /// So many iterations of so many are done, with this loss before the last.
    Progress {
        done: usize,
        of: usize,
        loss: f64,
    },
    Paused,
}

fn main() -> Result<(), Box<dyn Error>> {
    // A drape owns what it needs: what it was made of may go.
    let drape = ball_over_ellipsoid()?;
    let n_iterations = drape.n_iterations();
    let (commands, received) = channel();
    let (told, events) = channel();
    let worker = thread::spawn(move || work(drape, &received, &told));

    // Pause after twenty iterations; nothing happens until it is resumed.
    wait_for(&events, 20)?;
    commands.send(Command::Pause)?;
    while events.recv()? != Event::Paused {}
    assert!(events.try_recv().is_err(), "a paused drape stands still");

    // Resume, and stop it long before its end.
    commands.send(Command::Resume)?;
    wait_for(&events, 60)?;
    commands.send(Command::Cancel)?;
    let drape = worker.join().map_err(|_| "the thread panicked")??;

    // A drape that was stopped is as good as any: read it, go on with it, or drop it.
    assert!(!drape.is_finished() && drape.iteration() >= 60);
    assert_eq!(drape.n_iterations(), n_iterations);
    let x: Positions = drape.finish().positions;
    let longest = x.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
    assert!(
        (longest - 1.0).abs() < 0.1,
        "the longest half axis is {longest}"
    );
    Ok(())
}

/// Drapes until it is done or cancelled, and gives the drape back.
fn work(
    mut drape: Drape,
    commands: &Receiver<Command>,
    events: &Sender<Event>,
) -> Result<Drape, DrapeError> {
    let mut is_paused = false;
    loop {
        let command = if is_paused {
            commands.recv().map_err(|_| TryRecvError::Disconnected)
        } else {
            commands.try_recv()
        };
        match command {
            Ok(Command::Pause) => {
                is_paused = true;
                drop(events.send(Event::Paused));
            }
            Ok(Command::Resume) => is_paused = false,
            Ok(Command::Cancel) | Err(TryRecvError::Disconnected) => return Ok(drape),
            Err(TryRecvError::Empty) => {
                let Some(step) = drape.step()? else {
                    return Ok(drape);
                };
                // Whoever does not listen any more need not be told.
                drop(events.send(Event::Progress {
                    done: step.iteration + 1,
                    of: step.n_iterations,
                    loss: step.total,
                }));
            }
        }
    }
}

/// Listens until so many iterations are done.
fn wait_for(events: &Receiver<Event>, iterations: usize) -> Result<(), Box<dyn Error>> {
    loop {
        if let Event::Progress { done, of, loss } = events.recv()? {
            assert!(done <= of && loss.is_finite());
            if done >= iterations {
                return Ok(());
            }
        }
    }
}

fn ball_over_ellipsoid() -> Result<Drape, Box<dyn Error>> {
    let (mesh, rest) = shapes::quad_sphere(12).into_halfedge()?;
    let mut ellipsoid = shapes::icosphere(4);
    for p in &mut ellipsoid.positions {
        *p = Point3::new(p.x, 0.7 * p.y, 0.5 * p.z);
    }
    let target: Arc<dyn TargetSurface> = Arc::new(TriangleSoup::new(ellipsoid)?);
    let input = DrapeInput {
        triangulation: &Arc::new(Triangulation::new(&mesh, &rest)),
        initial: &rest.map(|p| p * 0.8),
        rest: &Arc::new(rest),
        target: &target,
        landmarks: &[],
    };
    Ok(Drape::new(input, DrapeConfig::standard())?)
}
