//! How the network is built: depth, width, encoding and the schedule that reveals it.

use serde::{Deserialize, Serialize};

use crate::setting::Setting;

/// Shape of the network that moves initial positions to draped ones.
///
/// Positions enter in the frame where the longest side of the shape that is seen is 2, so a coordinate lies in ±1.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetworkConfig {
    /// How many hidden layers, ≥ 1. Paper, "Implementation Details": 4.
    pub n_hidden_layers: usize,
    /// Neurons of each hidden layer, ≥ 1. Paper: 256.
    pub width: usize,
    /// Which position of a vertex the network sees.
    pub input: NetworkInput,
    /// What the first layer sees of it.
    pub encoding: Encoding,
    /// Length, in half longest sides, of the offset for which the last layer puts out 1. It sets how far an Adam step
    /// moves a vertex.
    pub output_scale: f64,
}

/// Which position of a vertex a network sees.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NetworkInput {
    /// Where it starts: the network is a map of space (the paper).
    Initial,
    /// Where it is in the source: parts that start laid on each other, and places of a part that starts crumpled, are apart
    /// to the network. It is a map of the surface alone.
    Rest,
}

/// What the first layer sees of a position x.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Encoding {
    /// x itself: the network's spectral bias unaltered.
    None,
    /// x and waves of x, all from the start.
    Static(Frequencies),
    /// x and waves of x, low frequencies first (Paper, "Progressive Positional Encoding").
    Progressive {
        /// The waves, sorted by frequency.
        frequencies: Frequencies,
        /// Into how many blocks they are divided, ≥ 1; the first is there from the start. Paper: 6.
        n_blocks: usize,
        /// When the other blocks come in.
        reveal: Reveal,
        /// What the blocks go into.
        networks: Networks,
    },
}

/// The waves of an encoding, drawn from the seed and sorted so that the row is the rank of the frequency.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Frequencies {
    /// `sin(30 W x)`, each entry of W uniform in ±`max`/30, each column sorted by magnitude (the authors' program).
    Uniform {
        /// Rows of W. The authors: 253.
        count: usize,
        /// Highest frequency along one axis, in radians per unit. The authors: 10.
        max: f64,
        /// Whether the optimiser moves W. The authors: yes.
        trainable: bool,
    },
    /// `sin(b·x), cos(b·x)`, each entry of b normal, sorted by |b| (random Fourier features, Tancik et al. 2020).
    Gaussian {
        /// How many b.
        count: usize,
        /// Standard deviation of an entry of b, in radians per unit: smaller is smoother.
        deviation: f64,
    },
}

/// What the blocks of a progressive encoding go into.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Networks {
    /// One network, which sees all blocks through the mask α (the paper).
    One,
    /// A network for each block, which sees that block and those before it: their outputs are summed, each times the α of its
    /// block (the authors' program). One that is hidden does not train, and its optimiser begins when it comes in.
    OnePerBlock,
}

/// When the blocks of a progressive encoding come in, as the run goes from 0 to 1.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Reveal {
    /// Twice as many phases as blocks, of equal length: even ones hold, odd ones fade the next block in (the authors' program).
    HoldAndFade {
        /// Part of the run that the phases take, above 0; the run ends before them where it is above 1.
        until: f64,
    },
    /// One block after the other, all there when the run reaches `until`.
    Even {
        /// Part of the run, in (0, 1].
        until: f64,
    },
}

impl NetworkConfig {
    /// The paper's network: 4 hidden layers of 256 on a progressive encoding in 6 blocks.
    ///
    /// The waves, their training and the schedule are the authors' program's; the paper names none. A residual output starts
    /// at the identity, where the program is trained to it first.
    pub fn paper() -> Self {
        Self {
            n_hidden_layers: 4,
            width: 256,
            input: NetworkInput::Initial,
            encoding: Encoding::Progressive {
                frequencies: Frequencies::Uniform {
                    count: 253,
                    max: 10.0,
                    trainable: true,
                },
                n_blocks: 6,
                reveal: Reveal::HoldAndFade { until: 1.0 },
                networks: Networks::One,
            },
            output_scale: 1.0,
        }
    }

    /// The network of the authors' program at 1500 of its 2000 iterations: six on prefixes of the encoding, summed, the last of
    /// which hardly comes in.
    ///
    /// 10 units of its output are half the longest side. Departure: a residual output, see [`Self::paper`].
    pub fn authors() -> Self {
        let paper = Self::paper();
        let encoding = match paper.encoding {
            Encoding::Progressive {
                frequencies,
                n_blocks,
                ..
            } => Encoding::Progressive {
                frequencies,
                n_blocks,
                reveal: Reveal::HoldAndFade {
                    until: 2000.0 / 1500.0,
                },
                networks: Networks::OnePerBlock,
            },
            other => other,
        };
        Self {
            encoding,
            output_scale: 0.1,
            ..paper
        }
    }

    /// Half as wide, on fixed random Fourier features of higher frequency, all revealed at 40 % of the run.
    ///
    /// The features are computed once, and a step costs a third of the paper's. It fits closer than the paper's
    /// waves in the same number of steps; 256 neurons fit a little closer still, at twice the cost.
    pub fn standard() -> Self {
        Self {
            width: 128,
            encoding: Encoding::Progressive {
                frequencies: Frequencies::Gaussian {
                    count: 126,
                    deviation: 8.0,
                },
                n_blocks: 6,
                reveal: Reveal::Even { until: 0.4 },
                networks: Networks::One,
            },
            ..Self::paper()
        }
    }

    /// [`Self::standard`] over the positions of the source: the smooth map that leads a start ([`crate::DrapeConfig::guide`]).
    pub fn guide() -> Self {
        Self {
            input: NetworkInput::Rest,
            ..Self::standard()
        }
    }

    /// Each setting with its range.
    pub(crate) fn settings(&self) -> Vec<Setting> {
        let mut settings = vec![
            Setting::count("n_hidden_layers", self.n_hidden_layers),
            Setting::count("width", self.width),
            Setting::positive("output_scale", self.output_scale),
        ];
        match self.encoding.frequencies() {
            Some(Frequencies::Uniform { count, max, .. }) => {
                settings.push(Setting::count_or_none("count", count));
                settings.push(Setting::not_negative("max", max));
            }
            Some(Frequencies::Gaussian { count, deviation }) => {
                settings.push(Setting::count_or_none("count", count));
                settings.push(Setting::not_negative("deviation", deviation));
            }
            None => {}
        }
        if let Encoding::Progressive {
            n_blocks,
            reveal,
            networks,
            ..
        } = self.encoding
        {
            settings.push(match networks {
                Networks::One => Setting::count("n_blocks", n_blocks),
                Networks::OnePerBlock => Setting::few("n_blocks", n_blocks),
            });
            settings.push(match reveal {
                Reveal::HoldAndFade { until } => Setting::positive("until", until),
                Reveal::Even { until } => Setting::positive_share("until", until),
            });
        }
        settings
    }
}

impl Encoding {
    /// The waves' description, if there are any.
    pub(super) fn frequencies(&self) -> Option<Frequencies> {
        match *self {
            Self::None => None,
            Self::Static(frequencies) | Self::Progressive { frequencies, .. } => Some(frequencies),
        }
    }

    /// How many networks are summed.
    pub(crate) fn n_networks(&self) -> usize {
        match *self {
            Self::Progressive {
                n_blocks,
                networks: Networks::OnePerBlock,
                ..
            } => n_blocks,
            _ => 1,
        }
    }

    /// How many features a point has: its coordinates and its waves.
    pub(crate) fn n_features(&self) -> usize {
        match self.frequencies() {
            None => 3,
            Some(Frequencies::Uniform { count, .. }) => count.saturating_add(3),
            Some(Frequencies::Gaussian { count, .. }) => count.saturating_mul(2).saturating_add(3),
        }
    }
}
