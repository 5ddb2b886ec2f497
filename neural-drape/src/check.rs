//! Ranges of the settings, and the memory that they ask for.

use crate::config::Sampling;
use crate::network::NetworkConfig;
use crate::schedule::{LearningRate, Stage, Weights};
use crate::setting::Setting;
use crate::{DrapeConfig, DrapeError, ParametrizationConfig, VerticesConfig};

/// What the settings may ask for at most, in GiB.
const MAX_GIB: f64 = 32.0;
const GIB: f64 = (1u64 << 30) as f64;
/// What a sample on each side takes: two pairs, room for one more, place, point and hints.
const BYTES_PER_SAMPLE: f64 = 400.0;
/// What a corner of each shape that is kept in mind takes: as many are looked at anew.
const BYTES_PER_CORNER: f64 = 1000.0;

impl DrapeConfig {
    /// Every setting lies in its range, and what they ask for fits into memory.
    ///
    /// # Errors
    /// The first that does not, by its name.
    pub fn check(&self) -> Result<(), DrapeError> {
        let mut settings = vec![
            Setting::share("worst_share", self.worst_share),
            Setting::not_negative("worst_tolerance", self.worst_tolerance),
            Setting::share("skinny_threshold", self.skinny_threshold),
            Setting::cosine("fold_limit", self.fold_limit),
        ];
        let contact = self.contact.iter();
        settings.extend(contact.flat_map(|contact| {
            [
                Setting::share("contact.from", contact.from),
                Setting::not_negative("contact.weight", contact.weight),
                Setting::not_negative("contact.gap", contact.gap),
            ]
        }));
        settings.extend(self.learning_rate.settings());
        settings.extend(self.sampling.settings());
        let stages = self.stages.iter().enumerate();
        settings.extend(stages.flat_map(|(row, stage)| stage.settings(row)));
        let n_iterations = self.stages.iter().map(|s| s.n_iterations);
        let n_iterations = n_iterations.fold(0, usize::saturating_add);
        settings.push(Setting::count_or_none(
            "n_iterations of all stages",
            n_iterations,
        ));
        settings.extend(match &self.parametrization {
            ParametrizationConfig::Vertices(vertices) => vertices.settings(),
            ParametrizationConfig::Network(network) => network.settings(),
        });
        Setting::check(settings)?;
        self.check_memory(0)
    }

    /// What a drape of `n_vertices` asks for fits into memory.
    pub(crate) fn check_memory(&self, n_vertices: usize) -> Result<(), DrapeError> {
        let Sampling {
            n_samples, n_hard, ..
        } = self.sampling;
        let most_samples = self.sampling.most();
        let sampling = if most_samples > n_samples {
            "sampling.max_samples"
        } else {
            "sampling.n_samples"
        };
        let mut uses = vec![
            (
                sampling,
                most_samples,
                BYTES_PER_SAMPLE * most_samples as f64,
            ),
            ("sampling.n_hard", n_hard, BYTES_PER_CORNER * n_hard as f64),
        ];
        if let ParametrizationConfig::Network(network) = &self.parametrization {
            uses.push(network.memory(n_vertices));
        }
        match uses.into_iter().find(|use_| use_.2 > MAX_GIB * GIB) {
            Some((name, value, bytes)) => Err(DrapeError::Memory {
                name,
                value,
                gib: bytes / GIB,
                limit_gib: MAX_GIB,
            }),
            None => Ok(()),
        }
    }
}

impl LearningRate {
    fn settings(&self) -> Vec<Setting> {
        vec![
            Setting::not_negative("learning_rate.peak", self.peak),
            Setting::count_or_none("learning_rate.warm_up", self.warm_up),
            Setting::share("learning_rate.decay", self.decay),
        ]
    }
}

impl Sampling {
    fn settings(&self) -> Vec<Setting> {
        let mut settings = vec![
            Setting::count("sampling.n_samples", self.n_samples),
            Setting::count_or_none("sampling.max_samples", self.max_samples),
            Setting::count("sampling.keep_for", self.keep_for),
            Setting::share("sampling.face_uniform", self.face_uniform),
            Setting::count_or_none("sampling.n_hard", self.n_hard),
        ];
        let every = self.double_every;
        settings.extend(every.map(|n| Setting::count("sampling.double_every", n)));
        let bias = self.normal_bias;
        settings.extend(bias.map(|bias| Setting {
            high: 2.0,
            low: -2.0,
            expected: "between -2 and 2",
            ..Setting::share("sampling.normal_bias", bias)
        }));
        settings
    }

    /// The most samples that a side ever has.
    fn most(&self) -> usize {
        match self.double_every {
            Some(_) => self.max_samples.max(self.n_samples),
            None => self.n_samples,
        }
    }
}

impl Stage {
    /// Those of the stage in this row, named by it.
    fn settings(&self, row: usize) -> Vec<Setting> {
        let n_iterations = format!("stages[{row}].n_iterations");
        let mut settings = vec![Setting::count_or_none(&n_iterations, self.n_iterations)];
        for (end, weights) in [("from", &self.from), ("to", &self.to)] {
            let weights = weights.by_name().into_iter();
            settings.extend(weights.map(|(term, weight)| {
                Setting::not_negative(&format!("stages[{row}].{end}.{term}"), weight)
            }));
        }
        settings
    }
}

impl Weights {
    /// Each weight with its name.
    fn by_name(&self) -> [(&'static str, f64); 13] {
        [
            ("chamfer", self.chamfer),
            ("worst_distance", self.worst_distance),
            ("normal_agreement", self.normal_agreement),
            ("landmark", self.landmark),
            ("corner_angle", self.corner_angle),
            ("area_kl", self.area_kl),
            ("triangle_quality", self.triangle_quality),
            ("flip", self.flip),
            ("fold_barrier", self.fold_barrier),
            ("conformal", self.conformal),
            ("local_shape", self.local_shape),
            ("drift", self.drift),
            ("smooth_change", self.smooth_change),
        ]
    }
}

impl VerticesConfig {
    fn settings(&self) -> Vec<Setting> {
        vec![
            Setting::not_negative("smoothing_start", self.smoothing_start),
            Setting::not_negative("smoothing_end", self.smoothing_end),
            Setting::share("adaptivity", self.adaptivity),
            Setting::share("adapt_from", self.adapt_from),
            Setting::count("n_levels", self.n_levels),
            Setting::decay_rate("betas", self.betas[0]),
            Setting::decay_rate("betas", self.betas[1]),
        ]
    }
}

impl NetworkConfig {
    /// The setting that asks for the most memory when `n_vertices` are moved, its value, and how many bytes all take.
    fn memory(&self, n_vertices: usize) -> (&'static str, usize, f64) {
        let n_features = self.encoding.n_features() as f64;
        let (width, n_layers) = (self.width as f64, self.n_hidden_layers as f64);
        let n_networks = self.encoding.n_networks() as f64;
        // Parameters, their gradient in each of 16 lanes, and what Adam and the tape keep of them.
        let n_parameters = (n_features + n_layers * width + 3.0) * width;
        let parameters = n_networks * (24.0 * 4.0 * n_parameters + 1000.0 * n_layers);
        // Features with their slopes and what leaves each layer, twice while they are laid out.
        let of_layers = n_networks * n_layers * width;
        let activations = 8.0 * n_vertices as f64 * (2.0 * n_features + of_layers);
        let settings = [
            ("width", self.width),
            ("n_hidden_layers", self.n_hidden_layers),
            ("count", self.encoding.n_features()),
        ];
        let (name, value) =
            settings.into_iter().fold(
                settings[0],
                |most, other| {
                    if other.1 > most.1 {
                        other
                    } else {
                        most
                    }
                },
            );
        (name, value, parameters + activations)
    }
}
