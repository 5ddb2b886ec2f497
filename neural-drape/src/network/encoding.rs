//! The positional encoding γ(x) of a point: its coordinates and waves of them.

/// The waves of an encoding: functions of a point, in order of frequency.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Waves {
    /// One frequency vector for each row.
    pub(crate) rows: Vec<[f32; 3]>,
    /// Factor between `row · x` and the phase, in radians.
    pub(crate) gain: f32,
    /// What is taken of a phase.
    pub(crate) kind: WaveKind,
}

/// What is taken of a phase.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum WaveKind {
    /// Its sine: one feature.
    Sine,
    /// Its sine, then its cosine: two features.
    SineCosine,
}

impl WaveKind {
    /// How many features a phase gives.
    pub(crate) const fn n_features(self) -> usize {
        match self {
            Self::Sine => 1,
            Self::SineCosine => 2,
        }
    }
}

impl Waves {
    /// No waves: the features of a point are its coordinates.
    #[cfg(feature = "network")]
    pub(super) const NONE: Self = Self {
        rows: Vec::new(),
        gain: 1.0,
        kind: WaveKind::Sine,
    };

    /// How many features a point has: its coordinates and its waves.
    pub(crate) fn n_features(&self) -> usize {
        3 + self.rows.len() * self.kind.n_features()
    }

    /// The first `features.len()` features of `point`, and with `slopes` the derivative of each by its phase.
    pub(super) fn encode(
        &self,
        point: &[f32; 3],
        features: &mut [f32],
        mut slopes: Option<&mut [f32]>,
    ) {
        let (coordinates, waves) = features.split_at_mut(3);
        coordinates.copy_from_slice(point);
        let per_row = self.kind.n_features();
        for (k, (values, row)) in waves.chunks_mut(per_row).zip(&self.rows).enumerate() {
            let (sin, cos) = (self.gain * dot(row, point)).sin_cos();
            values.copy_from_slice(&[sin, cos][..values.len()]);
            if let Some(slopes) = &mut slopes {
                let start = 3 + k * per_row;
                slopes[start..start + values.len()].copy_from_slice(&[cos, -sin][..values.len()]);
            }
        }
    }
}

pub(super) fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_encoded_as_itself_and_its_waves() {
        let waves = Waves {
            rows: vec![[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            gain: 1.0,
            kind: WaveKind::SineCosine,
        };
        let mut features = [0.0; 7];
        let mut slopes = [0.0; 7];
        waves.encode(&[0.5, 0.25, -1.0], &mut features, Some(&mut slopes));
        let (sin, cos) = 0.5f32.sin_cos();
        assert_eq!(features, [0.5, 0.25, -1.0, sin, cos, sin, cos]);
        assert_eq!(slopes[3..], [cos, -sin, cos, -sin]);
    }
}
