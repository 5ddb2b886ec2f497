//! A thread that works on the newest job and passes over older ones.

use std::sync::mpsc::{channel, Sender};
use std::thread;

/// Asks for jobs; the thread ends with it.
pub(crate) struct Latest<J>(Sender<J>);

impl<J: Send + 'static> Latest<J> {
    /// Starts the thread.
    pub(crate) fn start(mut work: impl FnMut(J) + Send + 'static) -> Self {
        let (sender, jobs) = channel::<J>();
        thread::spawn(move || {
            while let Ok(mut job) = jobs.recv() {
                while let Ok(newer) = jobs.try_recv() {
                    job = newer;
                }
                work(job);
            }
        });
        Self(sender)
    }

    /// Asks for a job; one that was asked for before and not begun is dropped.
    pub(crate) fn ask(&self, job: J) {
        // The thread is gone only where a job panicked; there is then nobody to ask.
        drop(self.0.send(job));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn the_newest_job_wins() {
        let (gate, pass) = sync_channel::<()>(0);
        let (done, results) = channel();
        let latest = Latest::start(move |job: u32| {
            pass.recv().expect("the gate opens");
            done.send(job).expect("somebody listens");
        });
        latest.ask(1);
        gate.send(()).expect("the first job waits");
        assert_eq!(results.recv(), Ok(1));
        latest.ask(2);
        gate.send(()).expect("the second job waits");
        assert_eq!(results.recv(), Ok(2));
        (3..9).for_each(|job| latest.ask(job));
        let mut last = 0;
        while last != 8 {
            gate.send(()).expect("a job waits");
            last = results.recv().expect("a job is done");
        }
        assert_eq!(last, 8);
    }
}
