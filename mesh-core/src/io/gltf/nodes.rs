//! Which meshes a glTF scene shows, and where its nodes put them.

use nalgebra::{Matrix4, Quaternion, UnitQuaternion};

use super::root::{Node, Root};
use crate::Vector3;

/// A mesh in the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShownMesh {
    /// The node that shows it; none in a document whose scene shows no mesh.
    pub(super) node: Option<usize>,
    pub(super) mesh: usize,
    /// From the mesh's frame into the scene; none where they are the same.
    pub(super) to_scene: Option<Matrix4<f64>>,
}

/// Every mesh that the scene shows, in the order of the nodes; every mesh of a file that shows none. `transforms` are
/// those of [`scene_transforms`]. A skinned mesh ignores its node's transform, as the format says.
pub(super) fn shown_meshes(root: &Root, transforms: &[Option<Matrix4<f64>>]) -> Vec<ShownMesh> {
    let nodes = root.nodes.iter().zip(transforms).enumerate();
    let shown: Vec<ShownMesh> = nodes
        .filter_map(|(k, (node, transform))| {
            let (mesh, transform) = (node.mesh?, (*transform)?);
            let is_fixed = node.skin.is_some() || transform == Matrix4::identity();
            Some(ShownMesh {
                node: Some(k),
                mesh,
                to_scene: (!is_fixed).then_some(transform),
            })
        })
        .collect();
    if !shown.is_empty() {
        return shown;
    }
    let all = 0..root.meshes.len();
    all.map(|mesh| ShownMesh {
        node: None,
        mesh,
        to_scene: None,
    })
    .collect()
}

/// From each node's frame into the scene; none for nodes that the scene does not hold.
pub(super) fn scene_transforms(root: &Root) -> Vec<Option<Matrix4<f64>>> {
    let tops = root.scene.clone().unwrap_or_else(|| tops(&root.nodes));
    let mut transforms = vec![None; root.nodes.len()];
    let mut open: Vec<(usize, Matrix4<f64>)> =
        tops.into_iter().map(|k| (k, Matrix4::identity())).collect();
    while let Some((k, above)) = open.pop() {
        let Some(node) = root.nodes.get(k).filter(|_| transforms[k].is_none()) else {
            continue;
        };
        let transform = above * local_transform(node);
        transforms[k] = Some(transform);
        open.extend(node.children.iter().map(|&child| (child, transform)));
    }
    transforms
}

/// The nodes that are no other's child.
fn tops(nodes: &[Node]) -> Vec<usize> {
    let mut is_child = vec![false; nodes.len()];
    for &child in nodes.iter().flat_map(|n| &n.children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    (0..nodes.len()).filter(|&k| !is_child[k]).collect()
}

fn local_transform(node: &Node) -> Matrix4<f64> {
    if let Some(matrix) = node.matrix {
        return Matrix4::from_column_slice(&matrix.map(f64::from));
    }
    let translation = Vector3::from(node.translation.unwrap_or_default().map(f64::from));
    let scale = Vector3::from(node.scale.unwrap_or([1.0; 3]).map(f64::from));
    let turn = match node.rotation {
        None => Matrix4::identity(),
        Some(rotation) => {
            let [x, y, z, w] = rotation.map(f64::from);
            UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_homogeneous()
        }
    };
    Matrix4::new_translation(&translation) * turn * Matrix4::new_nonuniform_scaling(&scale)
}
