//! A drape on a thread of its own.

use std::time::{Duration, Instant};

use mesh_draping::{Background, BackgroundStatus, Transfer};

use crate::support::{ball_and_ellipsoid, same_bits, short};

/// Whatever is waited for comes within this time on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);

fn start(n_iterations: usize) -> Background {
    let pair = ball_and_ellipsoid(6);
    let transfer = Transfer::of_pair(pair, short(n_iterations));
    transfer.start().expect("the drape starts").spawn()
}

fn wait_for(background: &Background, is_there: impl Fn(&BackgroundStatus) -> bool) {
    let began = Instant::now();
    while !is_there(&background.status()) {
        assert!(began.elapsed() < PATIENCE, "{:?}", background.status());
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn it_is_polled_paused_and_resumed() {
    let background = start(60);
    wait_for(&background, |s| s.iteration > 2 && s.last_step.is_some());
    background.pause();
    wait_for(&background, |s| s.is_paused);
    let at = background.positions().unwrap();
    let iteration = background.status().iteration;
    std::thread::sleep(Duration::from_millis(50));
    assert_eq!(background.status().iteration, iteration);
    assert!(same_bits(&background.positions().unwrap(), &at));
    background.resume();
    let outcome = background.wait().unwrap();
    assert_eq!(outcome.history.curves[0].points.len(), 120);
}

#[test]
fn it_takes_other_landmarks_and_refuses_wrong_ones() {
    let background = start(60);
    background.pause();
    let mut landmarks = ball_and_ellipsoid(6).landmarks;
    landmarks[0].target.x += 1.0;
    background.set_landmarks(landmarks.clone());
    let at = landmarks[0]
        .source
        .position(&background.positions().unwrap());
    assert!((at - landmarks[0].target).norm() < 1e-6);
    assert_eq!(background.status().refused, None);

    landmarks[0].target.x = f64::NAN;
    background.set_landmarks(landmarks);
    wait_for(&background, |s| s.refused.is_some());
    background.cancel();
}

#[test]
fn dropping_it_ends_the_thread() {
    let background = start(60_000);
    wait_for(&background, |s| s.iteration > 0);
    drop(background);
}

#[test]
fn it_can_move_to_another_thread() {
    fn is_movable<T: Send + 'static>(_: &T) {}
    let background = start(3);
    is_movable(&background);
    let outcome = std::thread::spawn(move || background.wait()).join();
    assert!(outcome.unwrap().is_ok());
}
