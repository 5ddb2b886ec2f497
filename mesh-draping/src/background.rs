//! A drape on a thread of its own.

use std::sync::mpsc::{channel, Receiver, Sender, TryRecvError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use mesh_core::{Landmark, Positions};
use neural_drape::{Regions, StepReport};

use crate::{Draping, Error, Outcome};

/// A drape that goes on on its own thread: what a window or an interactive session holds. It never blocks its holder but
/// in [`Self::positions`], for at most an iteration, and in [`Self::wait`]. Dropping it cancels the drape.
///
/// ```
/// use mesh_core::shapes;
/// use mesh_draping::{Preset, Seams, Source, Target, Transfer};
/// let source = Source::of_soup(shapes::quad_sphere(4), Seams::EXACT)?;
/// let target = Target::of_soup(shapes::icosphere(2))?;
/// let mut preset = Preset::quick();
/// preset.drape.stages.iter_mut().for_each(|stage| stage.n_iterations = 5);
/// let running = Transfer::new(&source, &target, &[], preset).start()?.spawn();
/// running.pause();
/// let so_far = running.positions().expect("the drape has not failed");
/// running.resume();
/// let outcome = running.wait()?;
/// assert_eq!(so_far.len(), outcome.draped.len());
/// # Ok::<(), mesh_draping::Error>(())
/// ```
pub struct Background {
    orders: Sender<Order>,
    status: Arc<Mutex<BackgroundStatus>>,
    thread: JoinHandle<Result<Draping, Error>>,
}

/// How far a drape on its own thread is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BackgroundStatus {
    /// How many iterations are done.
    pub iteration: usize,
    /// How many the run has.
    pub n_iterations: usize,
    /// The newest step; none before the first.
    pub last_step: Option<StepReport>,
    /// Whether it stands still because it was asked to.
    pub is_paused: bool,
    /// Whether it is over or has failed; [`Background::wait`] tells which.
    pub is_over: bool,
    /// Why a change that was asked for was refused; the drape goes on as before.
    pub refused: Option<String>,
}

enum Order {
    Pause,
    Resume,
    Landmarks(Vec<Landmark>),
    Regions(Regions),
    Extend(usize),
    Positions(Sender<Positions>),
    /// Whoever waits wants it to end: a pause ends, too.
    End,
    Cancel,
}

impl Draping {
    /// Goes on on a thread of its own.
    pub fn spawn(self) -> Background {
        let (sender, orders) = channel();
        let status = Arc::new(Mutex::new(BackgroundStatus {
            iteration: self.iteration(),
            n_iterations: self.n_iterations(),
            ..BackgroundStatus::default()
        }));
        let told = Arc::clone(&status);
        Background {
            orders: sender,
            status,
            thread: thread::spawn(move || {
                let end = Worker {
                    draping: self,
                    orders,
                    status: Arc::clone(&told),
                    is_ending: false,
                }
                .work();
                lock(&told).is_over = true;
                end
            }),
        }
    }
}

impl Background {
    /// How far it is.
    pub fn status(&self) -> BackgroundStatus {
        lock(&self.status).clone()
    }

    /// Stands still after the iteration that goes on.
    pub fn pause(&self) {
        self.order(Order::Pause);
    }

    /// Goes on after a pause.
    pub fn resume(&self) {
        self.order(Order::Resume);
    }

    /// Goes on with other landmarks ([`Draping::set_landmarks`]).
    pub fn set_landmarks(&self, landmarks: Vec<Landmark>) {
        self.order(Order::Landmarks(landmarks));
    }

    /// Goes on with other regions ([`Draping::set_regions`]).
    pub fn set_regions(&self, regions: Regions) {
        self.order(Order::Regions(regions));
    }

    /// Gives the run more iterations.
    pub fn extend(&self, n_iterations: usize) {
        self.order(Order::Extend(n_iterations));
    }

    /// Where the vertices are now, in the target's coordinates; none where the drape has failed or is over.
    pub fn positions(&self) -> Option<Positions> {
        let (sender, positions) = channel();
        self.orders.send(Order::Positions(sender)).ok()?;
        positions.recv().ok()
    }

    /// Ends it at once; nothing is left of it.
    pub fn cancel(self) {
        self.order(Order::Cancel);
    }

    /// Waits until the drape is over, and judges it. A drape that is paused goes on.
    ///
    /// # Errors
    /// As [`Draping::step`] and [`Draping::finish`].
    ///
    /// # Panics
    /// If the drape panicked on its thread, which is a defect.
    pub fn wait(self) -> Result<Outcome, Error> {
        self.order(Order::End);
        match self.thread.join() {
            Ok(draping) => draping?.finish(),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }

    fn order(&self, order: Order) {
        // A thread that ended takes no more orders; `wait` tells why it did.
        drop(self.orders.send(order));
    }
}

struct Worker {
    draping: Draping,
    orders: Receiver<Order>,
    status: Arc<Mutex<BackgroundStatus>>,
    is_ending: bool,
}

impl Worker {
    /// Steps and follows orders until the end that was asked for, or until nobody holds the drape any more.
    fn work(mut self) -> Result<Draping, Error> {
        loop {
            let is_waiting = lock(&self.status).is_paused || self.draping.is_over();
            let order = match self.orders.try_recv() {
                Ok(order) => Some(order),
                Err(TryRecvError::Disconnected) => return Ok(self.draping),
                Err(TryRecvError::Empty) if is_waiting && self.is_ending => return Ok(self.draping),
                Err(TryRecvError::Empty) if is_waiting => match self.orders.recv() {
                    Ok(order) => Some(order),
                    Err(_) => return Ok(self.draping),
                },
                Err(TryRecvError::Empty) => None,
            };
            match order {
                Some(Order::Cancel) => return Ok(self.draping),
                Some(order) => self.obey(order),
                None => {
                    let step = self.draping.step()?;
                    self.tell(step);
                }
            }
        }
    }

    fn obey(&mut self, order: Order) {
        let done = match order {
            Order::Pause => {
                lock(&self.status).is_paused = true;
                Ok(())
            }
            Order::Resume => {
                lock(&self.status).is_paused = false;
                Ok(())
            }
            Order::End | Order::Cancel => {
                lock(&self.status).is_paused = false;
                self.is_ending = true;
                Ok(())
            }
            Order::Landmarks(landmarks) => self.draping.set_landmarks(landmarks),
            Order::Regions(regions) => self.draping.set_regions(regions),
            Order::Extend(n_iterations) => {
                self.draping.extend(n_iterations);
                Ok(())
            }
            Order::Positions(reply) => {
                // Whoever asked may be gone.
                drop(reply.send(self.draping.positions()));
                Ok(())
            }
        };
        lock(&self.status).refused = done.err().map(|error| error.to_string());
        self.tell(None);
    }

    fn tell(&self, step: Option<StepReport>) {
        let mut status = lock(&self.status);
        status.iteration = self.draping.iteration();
        status.n_iterations = self.draping.n_iterations();
        if step.is_some() {
            status.last_step = step;
        }
    }
}

fn lock(status: &Mutex<BackgroundStatus>) -> MutexGuard<'_, BackgroundStatus> {
    status.lock().unwrap_or_else(PoisonError::into_inner)
}
