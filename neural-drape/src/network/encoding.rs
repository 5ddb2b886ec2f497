//! The positional encoding γ(x) of a point: its coordinates and waves of them.

use super::wave::sin_cos;

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

    /// The waves laid out to encode one point after the other.
    pub(super) fn encoder(&self) -> Encoder {
        Encoder {
            axes: [0, 1, 2].map(|axis| self.rows.iter().map(|row| row[axis]).collect()),
            gain: self.gain,
            kind: self.kind,
            phases: vec![0.0; self.rows.len()],
            sines: vec![0.0; self.rows.len()],
            cosines: vec![0.0; self.rows.len()],
        }
    }
}

/// Waves by axis, with room for those of one point.
pub(super) struct Encoder {
    /// Entry of each row along x, y and z.
    axes: [Vec<f32>; 3],
    gain: f32,
    kind: WaveKind,
    phases: Vec<f32>,
    sines: Vec<f32>,
    cosines: Vec<f32>,
}

impl Encoder {
    /// The first `features.len()` features of `point`, and with `slopes` the derivative of each by its phase.
    pub(super) fn encode(
        &mut self,
        point: &[f32; 3],
        features: &mut [f32],
        slopes: Option<&mut [f32]>,
    ) {
        let (coordinates, waves) = features.split_at_mut(3);
        coordinates.copy_from_slice(point);
        let per_row = self.kind.n_features();
        let n_rows = waves.len() / per_row;
        self.evaluate(point, n_rows);

        let both = self.sines[..n_rows].iter().zip(&self.cosines);
        for (values, (&sin, &cos)) in waves.chunks_mut(per_row).zip(both.clone()) {
            values.copy_from_slice(&[sin, cos][..per_row]);
        }
        let slopes = slopes.into_iter().flat_map(|s| s[3..].chunks_mut(per_row));
        for (values, (&sin, &cos)) in slopes.zip(both) {
            values.copy_from_slice(&[cos, -sin][..per_row]);
        }
    }

    /// Sine and cosine of the first `n_rows` phases at `point`.
    fn evaluate(&mut self, point: &[f32; 3], n_rows: usize) {
        let [along_x, along_y, along_z] = &self.axes;
        let [x, y, z] = *point;
        let rows = along_x.iter().zip(along_y).zip(along_z);
        for (phase, ((&a, &b), &c)) in self.phases[..n_rows].iter_mut().zip(rows) {
            *phase = self.gain * (a * x + b * y + c * z);
        }
        let (sines, cosines) = (&mut self.sines[..n_rows], &mut self.cosines[..n_rows]);
        sin_cos(&self.phases[..n_rows], sines, cosines);
    }
}

#[cfg(feature = "network")]
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
        waves
            .encoder()
            .encode(&[0.5, 0.25, -1.0], &mut features, Some(&mut slopes));
        let (sin, cos) = 0.5f32.sin_cos();
        assert_eq!(features, [0.5, 0.25, -1.0, sin, cos, sin, cos]);
        assert_eq!(slopes[3..], [cos, -sin, cos, -sin]);
    }
}
