//! One result, however it is come to.

use mesh_draping::mesh_core::io;
use mesh_draping::{Note, Outcome, Pair, Preset, Transfer};

use crate::support::{ball_and_ellipsoid, same_bits, short};

fn run(pair: &Pair, preset: &Preset) -> Outcome {
    Transfer::of_pair(pair.clone(), preset.clone())
        .run()
        .expect("the pair can be draped")
}

fn run_with_threads(pair: &Pair, preset: &Preset, n: usize) -> Outcome {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
    let pool = pool.expect("threads can be started");
    pool.install(|| run(pair, preset))
}

#[test]
fn a_ball_becomes_an_ellipsoid() {
    let pair = ball_and_ellipsoid(6);
    let outcome = run(&pair, &short(40));
    let before = pair.judge(&outcome.initial, None).unwrap();
    assert!(outcome.report.mean_l2_sum() < before.mean_l2_sum());
    assert_eq!(outcome.report.defects.folds, 0);
    assert_eq!(outcome.history.curves[0].points.len(), 80);
    assert!(outcome.notes.is_empty(), "{:?}", outcome.notes);
}

#[test]
fn the_bits_are_the_same_at_any_thread_count() {
    let (pair, preset) = (ball_and_ellipsoid(6), short(15));
    let one = run_with_threads(&pair, &preset, 1);
    for n in [2, 3] {
        let more = run_with_threads(&pair, &preset, n);
        assert!(same_bits(&one.draped, &more.draped), "{n} threads");
    }
}

#[test]
fn stepping_and_a_thread_of_its_own_come_to_the_bits_of_the_run() {
    let (pair, preset) = (ball_and_ellipsoid(6), short(15));
    let expected = run(&pair, &preset).draped;

    let mut stepped = Transfer::of_pair(pair.clone(), preset.clone())
        .start()
        .unwrap();
    let mut n_steps = 0;
    while let Some(step) = stepped.step().unwrap() {
        assert_eq!((step.iteration, step.n_iterations), (n_steps, 30));
        n_steps += 1;
    }
    assert!(stepped.is_over() && same_bits(&stepped.positions(), &expected));
    assert!(same_bits(&stepped.finish().unwrap().draped, &expected));

    let spawned = Transfer::of_pair(pair, preset).start().unwrap().spawn();
    assert!(same_bits(&spawned.wait().unwrap().draped, &expected));
}

#[test]
fn a_dense_source_is_draped_by_a_stand_in_first() {
    let pair = ball_and_ellipsoid(51);
    assert!(pair.source.rest().len() > 15_000);
    let mut draping = Transfer::of_pair(pair.clone(), short(10)).start().unwrap();
    assert_eq!(draping.n_iterations(), 80);
    let mut shown = Vec::new();
    while let Some(step) = draping.step().unwrap() {
        if step.iteration % 25 == 0 {
            shown.push(draping.positions().len());
        }
    }
    assert_eq!(shown, [pair.source.rest().len(); 4]);
    let outcome = draping.finish().unwrap();
    let is_stand_in = |note: &Note| {
        matches!(
            note,
            Note::StandIn {
                n_vertices: 3000,
                ..
            }
        )
    };
    assert!(outcome.notes.iter().any(is_stand_in), "{:?}", outcome.notes);

    let whole = Transfer::of_pair(pair, short(1)).without_stand_in();
    assert_eq!(whole.start().unwrap().n_iterations(), 2);
}

#[test]
fn the_result_is_the_source_file_with_other_positions() {
    let folder = tempfile::tempdir().unwrap();
    let (source, out) = (folder.path().join("in.obj"), folder.path().join("out.obj"));
    let pair = ball_and_ellipsoid(4);
    io::write_soup(&source, &pair.target.soup().clone()).unwrap();
    let text = std::fs::read_to_string(&source).unwrap();
    std::fs::write(&source, format!("# mine\n{text}g end\n")).unwrap();

    let pair = Pair {
        source: mesh_draping::Source::read(&source).unwrap(),
        landmarks: Vec::new(),
        ..pair
    };
    let outcome = run(&pair, &short(3));
    outcome.write(&out).unwrap();
    let written = std::fs::read_to_string(&out).unwrap();
    assert!(written.starts_with("# mine\n") && written.ends_with("g end\n"));
    let back = io::read_soup(&out).unwrap();
    assert_eq!(back.positions, outcome.draped.as_slice());
    let is_pose = |note: &Note| matches!(note, Note::PoseAssumed { n_landmarks: 0, .. });
    assert!(outcome.notes.iter().any(is_pose), "{:?}", outcome.notes);
}
