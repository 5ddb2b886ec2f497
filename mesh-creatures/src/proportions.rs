//! How an individual is built.

use mesh_core::sampling::SeededRng;

/// Lengths and girths of an individual, each as a ratio to the template's: 1 throughout is the template.
///
/// A plan leaves out what it has no use for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proportions {
    /// Length of the trunk; of the skull for the plan that is a head alone.
    pub trunk_length: f64,
    /// Girth of the trunk, and with it of all that grows from it.
    pub trunk_girth: f64,
    /// Girth of the belly or abdomen over that of the trunk; of the cheeks for a head.
    pub belly: f64,
    /// Length of the neck.
    pub neck_length: f64,
    /// Size of the head.
    pub head_size: f64,
    /// Length of muzzle, beak or nose.
    pub face_length: f64,
    /// Length of the ears or antennae.
    pub ear_length: f64,
    /// Length of arms and legs.
    pub limb_length: f64,
    /// Girth of arms and legs over that of the trunk; of the neck for a head.
    pub limb_girth: f64,
    /// Length of paws, or of fingers, toes and feet.
    pub foot_length: f64,
    /// Length of tail or tail feathers.
    pub tail_length: f64,
    /// Span of the wings.
    pub wing_span: f64,
}

impl Proportions {
    /// Those of the template.
    pub const TEMPLATE: Self = Self::from_array([1.0; 12]);

    const fn from_array(values: [f64; 12]) -> Self {
        let [trunk_length, trunk_girth, belly, neck_length, head_size, face_length, ear_length, limb_length, limb_girth, foot_length, tail_length, wing_span] =
            values;
        Self {
            trunk_length,
            trunk_girth,
            belly,
            neck_length,
            head_size,
            face_length,
            ear_length,
            limb_length,
            limb_girth,
            foot_length,
            tail_length,
            wing_span,
        }
    }

    /// In the order of the fields.
    pub(crate) const fn to_array(self) -> [f64; 12] {
        [
            self.trunk_length,
            self.trunk_girth,
            self.belly,
            self.neck_length,
            self.head_size,
            self.face_length,
            self.ear_length,
            self.limb_length,
            self.limb_girth,
            self.foot_length,
            self.tail_length,
            self.wing_span,
        ]
    }

    /// Part of the logarithm of a ratio of lengths that each measure may take: girths differ less than lengths.
    const SHARES: [f64; 12] = [0.5, 0.3, 0.25, 1.0, 0.4, 0.5, 0.7, 1.0, 0.25, 0.5, 1.0, 0.7];

    /// Draws each measure evenly in the logarithm, lengths between `1 / ratio` and `ratio`.
    pub(crate) fn drawn(ratio: f64, rng: &mut SeededRng) -> Self {
        let share = |k: usize, rng: &mut SeededRng| {
            let u = 2.0 * rng.uniform() - 1.0;
            (u * Self::SHARES[k] * ratio.ln()).exp()
        };
        let mut values = [1.0; 12];
        for (k, value) in values.iter_mut().enumerate() {
            *value = share(k, rng);
        }
        Self::from_array(values)
    }

    /// Girth of limbs over the template's: short ones are not as stout as long ones.
    pub(crate) fn limb_stoutness(&self) -> f64 {
        self.trunk_girth * self.limb_girth * slimmed(self.limb_length)
    }

    /// Each measure to the power of `share`: the template at 0, itself at 1.
    pub(crate) fn tempered(self, share: f64) -> Self {
        Self::from_array(self.to_array().map(|value| value.powf(share)))
    }
}

/// Girth of a part of this length over its girth at length 1: what is shorter is slimmer, what is longer is stouter.
pub(crate) fn slimmed(length: f64) -> f64 {
    length.powf(if length < 1.0 { 0.7 } else { 0.35 })
}
