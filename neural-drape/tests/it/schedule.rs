//! The course of a run: λ of Eq. 1, every weight, and the presets in figures.

use neural_drape::{DrapeConfig, Stage, Weights};

/// Every weight in the order of its declaration, named.
fn by_name(w: &Weights) -> [(&'static str, f64); 13] {
    [
        ("chamfer", w.chamfer),
        ("worst_distance", w.worst_distance),
        ("normal_agreement", w.normal_agreement),
        ("landmark", w.landmark),
        ("corner_angle", w.corner_angle),
        ("area_kl", w.area_kl),
        ("triangle_quality", w.triangle_quality),
        ("flip", w.flip),
        ("fold_barrier", w.fold_barrier),
        ("conformal", w.conformal),
        ("local_shape", w.local_shape),
        ("drift", w.drift),
        ("smooth_change", w.smooth_change),
    ]
}

fn assert_weights(found: &Weights, expected: [f64; 13]) {
    for ((name, found), expected) in by_name(found).into_iter().zip(expected) {
        let scale = f64::max(1.0, expected.abs());
        assert!(
            (found - expected).abs() < 1e-12 * scale,
            "{name}: {found}, not {expected}"
        );
    }
}

/// The weight of row k is `base + k`.
fn weights(base: f64) -> Weights {
    Weights {
        chamfer: base,
        worst_distance: base + 1.0,
        normal_agreement: base + 2.0,
        landmark: base + 3.0,
        corner_angle: base + 4.0,
        area_kl: base + 5.0,
        triangle_quality: base + 6.0,
        flip: base + 7.0,
        fold_barrier: base + 8.0,
        conformal: base + 9.0,
        local_shape: base + 10.0,
        drift: base + 11.0,
        smooth_change: base + 12.0,
    }
}

#[test]
fn weights_go_from_the_first_to_the_last_along_a_line() {
    let mut config = DrapeConfig::standard();
    let stage = |n_iterations, from, to| Stage {
        n_iterations,
        from: weights(from),
        to: weights(to),
    };
    config.stages = vec![stage(10, 100.0, 200.0), stage(4, 1000.0, 0.0)];
    let expected = [
        (0, 100.0),
        (1, 110.0),
        (9, 190.0),
        (10, 1000.0),
        (12, 500.0),
        (13, 250.0),
        (14, 0.0),
        (400, 0.0),
    ];
    for (iteration, base) in expected {
        let expected = std::array::from_fn(|k| base + k as f64);
        assert_weights(&config.weights_at(iteration), expected);
    }
    assert_eq!(config.n_iterations(), 14);
}

#[test]
fn lambda_is_what_both_terms_of_eq_3_are_multiplied_with() {
    let w = weights(1.0).with_lambda(0.25);
    assert_eq!(
        (w.corner_angle, w.area_kl, w.lambda()),
        (0.25, 0.25, Some(0.25))
    );
    let others = Weights {
        corner_angle: 5.0,
        area_kl: 6.0,
        ..w
    };
    assert_eq!(others, weights(1.0));
    assert_eq!(others.lambda(), None);
}

#[test]
fn lambda_of_the_paper_is_1_for_1000_iterations_and_0_2_for_500() {
    let lambda = |iteration| DrapeConfig::paper().weights_at(iteration).lambda();
    assert_eq!(DrapeConfig::paper().n_iterations(), 1500);
    assert_eq!([0, 500, 999].map(lambda), [Some(1.0); 3]);
    assert_eq!([1000, 1250, 1499].map(lambda), [Some(0.2); 3]);
}

#[test]
fn lambda_of_the_standard_preset_is_1_while_structure_leads_and_0_3_after() {
    let lambda = |iteration| DrapeConfig::standard().weights_at(iteration).lambda();
    assert_eq!(DrapeConfig::standard().n_iterations(), 1000);
    assert_eq!([0, 329].map(lambda), [Some(1.0); 2]);
    assert_eq!([330, 999].map(lambda), [Some(0.3); 2]);
}

/// Lengths count 20 times and squared lengths 400 times what they do in the authors' frame. There is no term of normals: the
/// paper has none.
#[test]
fn the_weights_of_the_paper_are_these() {
    let stages = DrapeConfig::paper().stages;
    assert_eq!(stages.len(), 2);
    for (stage, landmark, lambda) in [(&stages[0], 100.0, 1.0), (&stages[1], 10.0, 0.2)] {
        let expected = [
            20.0,
            0.0,
            0.0,
            400.0 * landmark,
            lambda,
            lambda,
            0.1,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
        ];
        assert_weights(&stage.from, expected);
        assert_weights(&stage.to, expected);
    }
}

/// Beside the paper's, normals agree by 0.2, and faces keep from flipping by λ, which fades to 0 within each stage of 1000: to
/// a half in the second, of which 500 are run.
#[test]
fn the_weights_of_the_authors_program_are_these() {
    let stages = DrapeConfig::authors().stages;
    let n_iterations: Vec<usize> = stages.iter().map(|s| s.n_iterations).collect();
    assert_eq!(n_iterations, [1000, 500]);
    for (stage, landmark, lambda, flips) in [
        (&stages[0], 100.0, 1.0, [1.0, 0.0]),
        (&stages[1], 10.0, 0.2, [0.2, 0.1]),
    ] {
        for (weights, flip) in [&stage.from, &stage.to].into_iter().zip(flips) {
            let landmark = 400.0 * landmark;
            let expected = [
                20.0, 0.0, 0.2, landmark, lambda, lambda, 0.1, flip, 0.0, 0.0, 0.0, 0.0, 0.0,
            ];
            assert_weights(weights, expected);
        }
    }
}

#[test]
fn the_weights_of_the_standard_preset_are_these() {
    let stages = DrapeConfig::standard().stages;
    assert_eq!(stages.len(), 2);
    let start = [
        20.0, 2.0, 0.2, 4000.0, 1.0, 1.0, 0.3, 1.0, 5.0, 0.0, 0.0, 0.0, 0.0,
    ];
    assert_weights(&stages[0].from, start);
    // The flip term fades.
    let lead = [
        20.0, 2.0, 0.2, 4000.0, 1.0, 1.0, 0.3, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0,
    ];
    assert_weights(&stages[0].to, lead);
    let fit = [
        20.0, 4.0, 0.2, 2000.0, 0.3, 0.3, 0.3, 0.0, 5.0, 0.0, 0.0, 6000.0, 0.0,
    ];
    assert_weights(&stages[1].from, fit);
    let end = [
        20.0, 48.0, 0.2, 18_000.0, 0.3, 0.3, 0.5, 0.0, 10.0, 0.0, 0.0, 3000.0, 0.0,
    ];
    assert_weights(&stages[1].to, end);
}
