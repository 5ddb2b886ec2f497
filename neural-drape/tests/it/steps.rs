//! What one iteration does, seen by a parametrization that writes down what it is asked for.

use std::sync::{Arc, Mutex};

use mesh_core::{shapes, Landmark, Positions, Vector3, VertexData, VertexId};
use neural_drape::{
    AngleReference, Descent, Drape, DrapeConfig, DrapeError, Parametrization, Stage, StateReader,
    StateWriter, StepReport, Weights,
};

use crate::setup::{on_ellipsoid, short, Pair};

/// One call of [`Parametrization::descend`].
#[derive(Clone)]
pub(crate) struct Descended {
    pub(crate) gradient: Vec<Vector3>,
    pub(crate) rate: f64,
    /// What [`Parametrization::set_progress`] said last.
    pub(crate) progress: f64,
}

/// A parametrization that moves by `shift` whenever it is to descend, and remembers the gradients.
struct Recorder {
    positions: Positions,
    shift: Vector3,
    log: Arc<Mutex<Vec<Descended>>>,
    progress: f64,
}

impl Parametrization for Recorder {
    fn positions(&self) -> &Positions {
        &self.positions
    }

    fn descend(
        &mut self,
        gradient: &VertexData<Vector3>,
        learning_rate: f64,
    ) -> Result<(), DrapeError> {
        self.log.lock().expect("nobody panicked").push(Descended {
            gradient: gradient.as_slice().to_vec(),
            rate: learning_rate,
            progress: self.progress,
        });
        self.positions.iter_mut().for_each(|p| *p += self.shift);
        Ok(())
    }

    fn set_progress(&mut self, progress: f64) -> Result<(), DrapeError> {
        self.progress = progress;
        Ok(())
    }

    fn displace(&mut self, displacements: &VertexData<Vector3>) {
        let moved = self.positions.iter_mut().zip(displacements);
        moved.for_each(|(p, d)| *p += d);
    }

    fn save(&mut self, state: &mut StateWriter) {
        state.points(&self.positions);
    }

    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), DrapeError> {
        state.points(self.positions.iter_mut())
    }
}

/// What a whole run asks for, and its reports.
pub(crate) fn recorded(
    pair: &Pair,
    config: DrapeConfig,
    shift: Vector3,
) -> (Vec<Descended>, Vec<StepReport>) {
    let log = Arc::new(Mutex::new(Vec::new()));
    let recorder = |initial: &Positions| {
        Ok(Box::new(Recorder {
            positions: initial.clone(),
            shift,
            log: Arc::clone(&log),
            progress: f64::NAN,
        }) as Box<dyn Parametrization>)
    };
    let mut drape =
        Drape::with_parametrization(pair.input(), config, recorder).expect("sound settings");
    let mut reports = Vec::new();
    while let Some(report) = drape.step().expect("a step") {
        reports.push(report);
    }
    let log = log.lock().expect("nobody panicked").clone();
    (log, reports)
}

pub(crate) fn norm(gradient: &[Vector3]) -> f64 {
    gradient
        .iter()
        .map(Vector3::norm_squared)
        .sum::<f64>()
        .sqrt()
}

/// Only these weights, in one stage.
pub(crate) fn of_weights(weights: Weights, n_iterations: usize) -> DrapeConfig {
    with_only(short("standard", n_iterations), weights, n_iterations)
}

/// A run of one stage with these weights alone.
pub(crate) fn with_only(config: DrapeConfig, weights: Weights, n_iterations: usize) -> DrapeConfig {
    let stage = Stage {
        n_iterations,
        from: weights,
        to: weights,
    };
    DrapeConfig {
        stages: vec![stage],
        ..config
    }
}

#[test]
fn alternating_descends_the_distance_first_and_the_structure_after() {
    // The initial shape is the rest shape scaled, so that its angles and areas are as they were.
    let pair = Pair::new(shapes::icosphere(2));
    let both = Weights {
        chamfer: 1.0,
        ..Weights::ZERO.with_lambda(1.0)
    };
    let mut config = of_weights(both, 3);
    config.descent = Descent::Alternating;
    let (log, reports) = recorded(&pair, config.clone(), Vector3::zeros());
    assert_eq!((log.len(), reports.len()), (6, 3));
    for steps in log.chunks(2) {
        assert!(norm(&steps[0].gradient) > 0.01);
        assert!(norm(&steps[1].gradient) < 1e-9);
    }
    config.descent = Descent::Combined;
    let (log, _) = recorded(&pair, config, Vector3::zeros());
    assert_eq!(log.len(), 3);
    assert!(log.iter().all(|step| norm(&step.gradient) > 0.01));
}

#[test]
fn the_report_names_the_distance_before_the_structure_and_sums_eq_1() {
    let pair = Pair::new(shapes::quad_sphere(4));
    for descent in [Descent::Alternating, Descent::Combined] {
        let config = DrapeConfig {
            descent,
            ..short("standard", 2)
        };
        let (_, reports) = recorded(&pair, config, Vector3::zeros());
        for report in reports {
            let names: Vec<&str> = report.terms.iter().map(|t| t.name).collect();
            let row = |name: &str| names.iter().position(|n| *n == name);
            assert!(row("chamfer") < row("angles") && row("landmarks") < row("areas"));
            let sum: f64 = report.terms.iter().map(|t| t.weight * t.value).sum();
            assert!((report.total - sum).abs() <= 1e-12 * sum.abs());
        }
    }
}

#[test]
fn lambda_multiplies_the_structural_loss_alone() {
    let mut pair = Pair::new(shapes::icosphere(2));
    // Stretched, so that angles and areas have gradients.
    pair.initial = pair.rest.map(on_ellipsoid);
    let of_lambda = |lambda: f64| {
        let weights = Weights {
            chamfer: 3.0,
            ..Weights::ZERO.with_lambda(lambda)
        };
        let mut config = of_weights(weights, 1);
        config.descent = Descent::Alternating;
        config.angle_reference = AngleReference::Rest;
        recorded(&pair, config, Vector3::zeros()).0
    };
    let (one, fifth) = (of_lambda(1.0), of_lambda(0.2));
    assert_eq!(one[0].gradient, fifth[0].gradient);
    for (a, b) in one[1].gradient.iter().zip(&fifth[1].gradient) {
        assert!((a * 0.2 - b).norm() < 1e-12);
    }
    assert!(norm(&one[1].gradient) > 1e-3);
}

#[test]
fn the_optimiser_is_given_the_rate_of_the_iteration_warm_up_and_decay_included() {
    let pair = Pair::new(shapes::icosphere(1));
    let mut config = short("standard", 10);
    config.learning_rate.peak = 0.5;
    config.learning_rate.warm_up = 3;
    config.learning_rate.decay = 0.4;
    let (log, _) = recorded(&pair, config, Vector3::zeros());
    let rates: Vec<f64> = log.iter().map(|step| step.rate).collect();
    // A quarter, a half, three quarters, then the peak; it falls over the last four of ten.
    let expected = [0.125, 0.25, 0.375, 0.5, 0.5, 0.5, 0.5, 0.375, 0.25, 0.125];
    for (rate, expected) in rates.iter().zip(expected) {
        assert!((rate - expected).abs() < 1e-12, "{rates:?}");
    }
}

#[test]
fn vertices_are_anchored_anew_where_each_stage_starts() {
    let pair = Pair::new(shapes::icosphere(2));
    let weights = Weights {
        drift: 1.0,
        ..Weights::ZERO
    };
    let mut config = of_weights(weights, 3);
    config.stages = vec![
        Stage {
            n_iterations: 3,
            from: weights,
            to: weights,
        };
        2
    ];
    let (_, reports) = recorded(&pair, config, Vector3::new(0.01, 0.0, 0.0));
    let drifts: Vec<f64> = reports.iter().map(|r| r.terms[0].value).collect();
    // Once along x, of which two thirds lie along the sphere on the mean; twice is four times that.
    for stage in drifts.chunks(3) {
        assert_eq!(stage[0], 0.0, "{drifts:?}");
        assert!(
            (stage[1] / (2.0 / 3.0 * 1e-4) - 1.0).abs() < 0.05,
            "{drifts:?}"
        );
        assert!((stage[2] / stage[1] - 4.0).abs() < 1e-9, "{drifts:?}");
    }
}

#[test]
fn a_landmark_is_a_term_of_the_distance() {
    let pair = Pair::new(shapes::icosphere(1));
    let v = VertexId::new(5);
    let mut config = of_weights(
        Weights {
            landmark: 1.0,
            ..Weights::ZERO
        },
        1,
    );
    config.descent = Descent::Alternating;
    let log = Arc::new(Mutex::new(Vec::new()));
    let recorder = |initial: &Positions| {
        Ok(Box::new(Recorder {
            positions: initial.clone(),
            shift: Vector3::zeros(),
            log: Arc::clone(&log),
            progress: f64::NAN,
        }) as Box<dyn Parametrization>)
    };
    let mut drape = Drape::with_parametrization(pair.input(), config, recorder).unwrap();
    drape
        .set_landmarks(&[Landmark::new(v, on_ellipsoid(&pair.rest[v]))])
        .unwrap();
    drape.step().unwrap();
    let log = log.lock().unwrap();
    assert!(log[0].gradient[v.index()].norm() > 0.01);
    assert_eq!(norm(&log[1].gradient), 0.0);
}

#[test]
fn a_parametrization_of_another_mesh_is_refused() {
    let pair = Pair::new(shapes::icosphere(1));
    let recorder = |_: &Positions| {
        Ok(Box::new(Recorder {
            positions: Positions::from(shapes::icosphere(0).positions),
            shift: Vector3::zeros(),
            log: Arc::default(),
            progress: f64::NAN,
        }) as Box<dyn Parametrization>)
    };
    let answer = Drape::with_parametrization(pair.input(), short("standard", 1), recorder);
    assert!(matches!(
        answer,
        Err(DrapeError::LengthMismatch {
            found: 12,
            expected: 42,
            ..
        })
    ));
}
