//! Bones and joints, and what a pose does to a control mesh.

use mesh_core::{Point3, Vector3};
use nalgebra::{Isometry3, Translation3, Unit, UnitDualQuaternion, UnitQuaternion};

use crate::skin::Skin;

/// Bones, parents before their children.
#[derive(Clone, Debug, Default)]
pub(crate) struct Skeleton {
    pub(crate) bones: Vec<Bone>,
}

/// A rigid part that turns about one end.
#[derive(Clone, Debug)]
pub(crate) struct Bone {
    pub(crate) parent: Option<usize>,
    /// Where it turns, at rest.
    pub(crate) pivot: Point3,
    /// The turns it is free to make, the last made first.
    pub(crate) freedoms: Vec<Freedom>,
}

/// A turn about an axis, between two angles in degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Freedom {
    pub(crate) axis: Vector3,
    pub(crate) degrees: [f64; 2],
}

pub(crate) fn about(axis: Vector3, from: f64, to: f64) -> Freedom {
    Freedom {
        axis,
        degrees: [from, to],
    }
}

impl Skeleton {
    /// Adds a bone and returns its row.
    pub(crate) fn add(
        &mut self,
        parent: Option<usize>,
        pivot: Point3,
        freedoms: &[Freedom],
    ) -> usize {
        self.bones.push(Bone {
            parent,
            pivot,
            freedoms: freedoms.to_vec(),
        });
        self.bones.len() - 1
    }

    /// Number of angles of a pose.
    pub(crate) fn n_angles(&self) -> usize {
        self.freedoms().count()
    }

    pub(crate) fn freedoms(&self) -> impl Iterator<Item = &Freedom> {
        self.bones.iter().flat_map(|bone| &bone.freedoms)
    }

    /// Positions moved as the bones move: the dual quaternions of the bones, summed by the shares of the skin and made
    /// unit, so that a joint keeps its girth.
    ///
    /// Source: Kavan et al. 2008.
    pub(crate) fn posed(
        &self,
        positions: &[Point3],
        skins: &[Skin],
        degrees: &[f64],
    ) -> Vec<Point3> {
        let motions = self.motions(degrees);
        let moved = |(p, skin): (&Point3, &Skin)| {
            let shares = skin.shares();
            let reference = motions[shares[0].0].real;
            let terms = shares.iter().map(|&(bone, share)| {
                let motion = *motions[bone].dual_quaternion();
                let side = if motion.real.dot(&reference) < 0.0 {
                    -1.0
                } else {
                    1.0
                };
                motion * (side * share)
            });
            let sum = terms.reduce(|a, b| a + b);
            sum.map_or(*p, |sum| {
                UnitDualQuaternion::new_normalize(sum).transform_point(p)
            })
        };
        positions.iter().zip(skins).map(moved).collect()
    }

    fn motions(&self, degrees: &[f64]) -> Vec<UnitDualQuaternion<f64>> {
        let mut angles = degrees.iter();
        let mut motions: Vec<Isometry3<f64>> = Vec::with_capacity(self.bones.len());
        for bone in &self.bones {
            let turn = bone
                .freedoms
                .iter()
                .fold(UnitQuaternion::identity(), |turn, freedom| {
                    let angle = angles.next().copied().unwrap_or(0.0);
                    turn * UnitQuaternion::from_axis_angle(
                        &Unit::new_normalize(freedom.axis),
                        angle.to_radians(),
                    )
                });
            let there = Translation3::from(bone.pivot.coords);
            let own = there * turn * there.inverse();
            motions.push(bone.parent.map_or(own, |parent| motions[parent] * own));
        }
        motions
            .iter()
            .map(UnitDualQuaternion::from_isometry)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_keeps_its_girth() {
        let mut skeleton = Skeleton::default();
        let root = skeleton.add(None, Point3::origin(), &[]);
        let child = skeleton.add(
            Some(root),
            Point3::origin(),
            &[about(Vector3::x(), 0.0, 120.0)],
        );
        let ring = [
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.0, 0.0, 1.0),
            Point3::new(0.0, 0.0, -1.0),
        ];
        let skins = vec![Skin::between(root, child, 0.5); 3];
        for (p, moved) in ring.iter().zip(skeleton.posed(&ring, &skins, &[120.0])) {
            assert!((moved.coords.norm() - 1.0).abs() < 1e-12, "{p} {moved}");
        }
    }

    #[test]
    fn children_follow_their_parents() {
        let mut skeleton = Skeleton::default();
        let z = about(Vector3::z(), -180.0, 180.0);
        let root = skeleton.add(None, Point3::origin(), &[z]);
        let child = skeleton.add(Some(root), Point3::new(1.0, 0.0, 0.0), &[z]);
        let tip = skeleton.posed(
            &[Point3::new(2.0, 0.0, 0.0)],
            &[Skin::of(child)],
            &[90.0, -90.0],
        );
        assert!((tip[0] - Point3::new(1.0, 1.0, 0.0)).norm() < 1e-12);
    }
}
