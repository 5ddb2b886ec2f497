//! Where vertices of a glTF mesh are in the scene: as they are, moved by their node, or each moved by its joints.

use nalgebra::{Matrix3, Matrix4};

use super::accessor::{Layout, Layouts};
use super::container::Container;
use super::root::{Primitive, Skin};
use crate::io::fault::Fault;
use crate::Point3;

/// How far a joint's matrix may be from the identity and count as such: files hold both of its factors in single
/// precision. Shifts are measured in the largest coordinate of the mesh.
const ROUNDING: f64 = 1e-5;

/// The map from a mesh's own frame into the scene.
#[derive(Clone, Debug)]
pub(super) enum Frame {
    /// They are the same.
    Scene,
    /// One for all vertices.
    Node(Matrix4<f64>),
    /// One for each vertex.
    Joints(Vec<Matrix4<f64>>),
}

impl Frame {
    /// The map of vertex `row` of the mesh; none where it is the identity.
    pub(super) fn matrix(&self, row: usize) -> Option<&Matrix4<f64>> {
        match self {
            Self::Scene => None,
            Self::Node(matrix) => Some(matrix),
            Self::Joints(matrices) => matrices.get(row),
        }
    }

    /// Its linear part.
    pub(super) fn linear(&self, row: usize) -> Option<Matrix3<f64>> {
        let matrix = self.matrix(row)?;
        Some(matrix.fixed_view::<3, 3>(0, 0).into_owned())
    }

    /// Whether there is a way back for each vertex.
    pub(super) fn is_invertible(&self) -> bool {
        match self {
            Self::Scene => true,
            Self::Node(matrix) => matrix.is_invertible(),
            Self::Joints(matrices) => matrices.iter().all(Matrix4::is_invertible),
        }
    }

    /// The frame of a primitive whose node has `skin`; none where that cannot be followed: a joint outside the scene, a
    /// vertex without joints.
    ///
    /// Vertex v is at `Σ w_j J_j B_j v / Σ w_j`, with `J_j` the transform of joint j in the scene and `B_j` its inverse
    /// bind matrix.
    pub(super) fn of_skin(
        skin: &Skin,
        primitive: &Primitive,
        container: &Container,
        layouts: &mut Layouts,
        transforms: &[Option<Matrix4<f64>>],
    ) -> Result<Option<Self>, Fault> {
        let Some(&positions) = primitive.attributes.get("POSITION") else {
            return Ok(None);
        };
        let (positions, _) = layouts.of(container, positions)?;
        let size = (0..positions.count)
            .map(|row| {
                Point3::from(positions.get::<3>(container, row))
                    .coords
                    .amax()
            })
            .fold(0.0, f64::max);
        let Some(joints) = joint_matrices(skin, container, transforms, size)? else {
            return Ok(None);
        };
        let mut sums = vec![(Matrix4::zeros(), 0.0); positions.count];
        for set in 0.. {
            let attribute = |name| primitive.attributes.get(&format!("{name}_{set}"));
            let Some((&j, &w)) = attribute("JOINTS").zip(attribute("WEIGHTS")) else {
                break;
            };
            let (j, w) = (layouts.of(container, j)?.0, layouts.of(container, w)?.0);
            if !add_influences(&mut sums, container, &joints, [&j, &w]) {
                return Ok(None);
            }
        }
        let matrices: Option<Vec<Matrix4<f64>>> = sums
            .into_iter()
            .map(|(sum, weight)| (weight > 0.0).then(|| sum / weight))
            .collect();
        Ok(matrices.map(|matrices| {
            match matrices.iter().all(|matrix| *matrix == Matrix4::identity()) {
                true => Self::Scene,
                false => Self::Joints(matrices),
            }
        }))
    }
}

/// `J_j B_j` of each joint; the identity itself where it is that but for rounding.
fn joint_matrices(
    skin: &Skin,
    container: &Container,
    transforms: &[Option<Matrix4<f64>>],
    size: f64,
) -> Result<Option<Vec<Matrix4<f64>>>, Fault> {
    let bind = skin.inverse_bind_matrices;
    let bind = bind
        .map(|accessor| Layout::of(container, accessor))
        .transpose()?;
    let fits = |bind: &Layout| bind.has_components(16) && bind.count >= skin.joints.len();
    if !bind.as_ref().is_none_or(fits) {
        return Ok(None);
    }
    let matrix = |(row, &joint): (usize, &usize)| {
        let transform = (*transforms.get(joint)?)?;
        let bind = bind.as_ref().map_or_else(Matrix4::identity, |bind| {
            Matrix4::from_column_slice(&bind.get::<16>(container, row))
        });
        let matrix = transform * bind;
        let difference = matrix - Matrix4::identity();
        let is_identity = difference.fixed_view::<3, 3>(0, 0).amax() <= ROUNDING
            && difference.fixed_view::<3, 1>(0, 3).amax() <= ROUNDING * size;
        Some(if is_identity {
            Matrix4::identity()
        } else {
            matrix
        })
    };
    Ok(skin.joints.iter().enumerate().map(matrix).collect())
}

/// Adds four influences to each vertex; whether all of their joints are there.
fn add_influences(
    sums: &mut [(Matrix4<f64>, f64)],
    container: &Container,
    matrices: &[Matrix4<f64>],
    [joints, weights]: [&Layout; 2],
) -> bool {
    let fits = |layout: &Layout| layout.has_components(4) && layout.count == sums.len();
    if !fits(joints) || !fits(weights) {
        return false;
    }
    for (row, (sum, total)) in sums.iter_mut().enumerate() {
        let joints = joints.get::<4>(container, row);
        let weights = weights.get::<4>(container, row);
        for (joint, weight) in joints.into_iter().zip(weights) {
            if weight == 0.0 {
                continue;
            }
            let Some(matrix) = matrices.get(joint as usize) else {
                return false;
            };
            *sum += matrix * weight;
            *total += weight;
        }
    }
    true
}
