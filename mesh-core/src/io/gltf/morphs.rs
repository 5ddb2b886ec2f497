//! Morph targets (blend shapes) carried to the new shape, so that a rigged head keeps its expressions.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use gltf::json::mesh::Primitive;
use nalgebra::Matrix3;

use super::accessor::{Layout, Layouts};
use super::container::{Bounds, Container};
use super::scene::{Block, Scene};
use crate::io::contents::unit;
use crate::io::error::{Fault, Place, ReadProblem};
use crate::{Point3, Vector3};

/// What a morph target displaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Displaced {
    Position,
    Normal,
    Tangent,
}

/// The accessors in which the morph targets of a primitive keep displacements.
pub(super) fn displacements(
    primitive: &Primitive,
) -> impl Iterator<Item = (Displaced, usize)> + '_ {
    primitive.targets.iter().flatten().flat_map(|target| {
        [
            (Displaced::Position, target.positions),
            (Displaced::Normal, target.normals),
            (Displaced::Tangent, target.tangents),
        ]
        .into_iter()
        .filter_map(|(displaced, accessor)| Some((displaced, accessor?.value())))
    })
}

/// The block, the row in it and what is displaced there.
type Use = (usize, usize, Displaced);

/// What keeps the morph targets from being carried, and what to do about it.
pub(super) fn find_uncarriable(
    container: &Container<'_>,
    scene: &Scene,
) -> Result<Option<(&'static str, &'static str)>, Fault> {
    let mut taken: HashMap<(usize, usize), Option<Use>> = HashMap::new();
    for block in &scene.blocks {
        let own = [
            Some(&block.positions),
            block.normals.as_ref(),
            block.tangents.as_ref(),
        ];
        for layout in own.into_iter().flatten() {
            for row in 0..layout.count {
                taken.extend(layout.slot(row).map(|slot| (slot, None)));
            }
        }
    }
    let mut layouts = Layouts::default();
    for (k, block) in scene.blocks.iter().enumerate() {
        let mut seen = HashSet::new();
        for &(displaced, accessor) in &block.displacements {
            let (layout, layout_row) = layouts.of(container, accessor)?;
            if !seen.insert((displaced, layout_row)) {
                continue;
            }
            if !layout.is_float() || !layout.has_components(3) || layout.count != block.rows.len() {
                return Ok(Some((
                    "a mesh with quantised or incomplete morph targets",
                    "export them as plain floats, or use --morphs keep",
                )));
            }
            for row in layout.rows() {
                let Some(slot) = layout.slot(row) else {
                    continue;
                };
                let use_here = Some((k, row, displaced));
                if *taken.entry(slot).or_insert(use_here) != use_here {
                    return Ok(Some((
                        "a morph target that shares its numbers with another mesh",
                        "export each mesh with its own, or use --morphs keep",
                    )));
                }
            }
        }
    }
    Ok(None)
}

/// Takes every displacement to the new shape, `δ' = J δ`; gives the new bounds of the accessors that changed.
///
/// J is the gradient of the map at the vertex: `Σ |A_f| F_f / Σ |A_f|` over the triangles around its place, all copies
/// of a vertex that is split along a seam together. `F_f` takes two edges of the triangle at rest and their normal of
/// length `√(2 |A|)` to those of the moved one, so that it is exact where the map turns, scales or shifts the triangle
/// (the fourth corner of Sumner and Popović 2004, Eq. 1). A normal's displacement is the difference of the two normals,
/// morphed and not, each sent through `J⁻ᵀ`; a tangent's likewise through J. Where nothing moved, bytes stay.
pub(super) fn carry(
    buffers: &mut [Vec<u8>],
    container: &Container<'_>,
    scene: &Scene,
    moved: &[Point3],
) -> Result<Vec<Bounds>, Fault> {
    let maps = maps(scene, moved);
    let mut bounds = Vec::new();
    let mut layouts = Layouts::default();
    for block in &scene.blocks {
        let mut has_changed = HashMap::new();
        for &(displaced, accessor) in &block.displacements {
            let (layout, layout_row) = layouts.of(container, accessor)?;
            let has_changed = match has_changed.entry((displaced, layout_row)) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(unknown) => {
                    let carry = |row: usize, displacement| {
                        let map = maps[block.rows.start + row]?;
                        carried(container, block, row, displaced, map, displacement)
                    };
                    let put = put_each(buffers, container, &layout, carry);
                    *unknown.insert(put.map_err(|to| not_finite(accessor, to))?)
                }
            };
            if has_changed && displaced == Displaced::Position {
                bounds.push(Bounds::of(accessor, &layout, buffers));
            }
        }
    }
    Ok(bounds)
}

/// Puts the new vector of each row that has one; whether any has. A vector too large for its place is given back.
fn put_each(
    buffers: &mut [Vec<u8>],
    container: &Container<'_>,
    layout: &Layout,
    new: impl Fn(usize, Vector3) -> Option<Vector3>,
) -> Result<bool, Vector3> {
    let mut any = false;
    for row in layout.rows() {
        let Some(to) = new(row, layout.get::<3>(container, row).into()) else {
            continue;
        };
        if !to.iter().all(|&c| (c as f32).is_finite()) {
            return Err(to);
        }
        layout.put(buffers, row, to.as_slice());
        any = true;
    }
    Ok(any)
}

fn not_finite(accessor: usize, displacement: Vector3) -> Fault {
    Fault {
        place: Place::Row {
            element: "accessor".to_owned(),
            row: accessor,
        },
        problem: ReadProblem::NotFinite {
            text: format!("{} {} {}", displacement.x, displacement.y, displacement.z),
        },
    }
}

/// One displacement in the frame of its mesh, sent through `map`, which is in that of the scene; none where it is zero.
fn carried(
    container: &Container<'_>,
    block: &Block,
    row: usize,
    displaced: Displaced,
    map: Matrix3<f64>,
    displacement: Vector3,
) -> Option<Vector3> {
    if displacement == Vector3::zeros() {
        return None;
    }
    let map = match block.to_scene {
        None => map,
        Some(m) => {
            let linear = m.fixed_view::<3, 3>(0, 0).into_owned();
            linear.try_inverse()? * map * linear
        }
    };
    let difference = |base: Vector3, map: Matrix3<f64>| {
        let to_unit = |v: Vector3| unit(map * v);
        Some(to_unit(base + displacement)? - to_unit(base)?)
    };
    match displaced {
        Displaced::Position => Some(map * displacement),
        Displaced::Normal => {
            let normal = block.normals.as_ref()?.get::<3>(container, row);
            difference(Vector3::from(normal), map.try_inverse()?.transpose())
        }
        Displaced::Tangent => {
            let [x, y, z, _] = block.tangents.as_ref()?.get::<4>(container, row);
            difference(Vector3::new(x, y, z), map)
        }
    }
}

/// The gradient of the map at each vertex, in the frame of the scene; none where nothing around it moved.
fn maps(scene: &Scene, moved: &[Point3]) -> Vec<Option<Matrix3<f64>>> {
    let rest = &scene.soup.positions;
    let place_of = places(moved);
    let mut sums = vec![(Matrix3::zeros(), 0.0, false); moved.len()];
    let mut total = (Matrix3::zeros(), 0.0);
    for corners in &scene.soup.faces {
        let Some((map, weight)) = face_map(rest, moved, corners) else {
            continue;
        };
        let has_moved = corners
            .iter()
            .any(|&v| rest[v as usize] != moved[v as usize]);
        total = (total.0 + map * weight, total.1 + weight);
        for &v in corners {
            let (sum, weights, any) = &mut sums[place_of[v as usize]];
            *sum += map * weight;
            *weights += weight;
            *any |= has_moved;
        }
    }
    let mean = (total.1 > 0.0).then(|| total.0 / total.1);
    let map_of = |row: usize| match sums[place_of[row]] {
        // A vertex that no face with an area uses follows the shape as a whole.
        (_, weights, _) if weights <= 0.0 => mean.filter(|_| rest[row] != moved[row]),
        (sum, weights, has_moved) => has_moved.then(|| sum / weights),
    };
    (0..moved.len()).map(map_of).collect()
}

/// For each vertex the first of those that are where it is.
fn places(moved: &[Point3]) -> Vec<usize> {
    let mut first_at = HashMap::with_capacity(moved.len());
    let key = |p: &Point3| [p.x, p.y, p.z].map(|c| (c + 0.0).to_bits());
    moved
        .iter()
        .enumerate()
        .map(|(row, p)| *first_at.entry(key(p)).or_insert(row))
        .collect()
}

/// The linear map of a triangle, and its area at rest, doubled.
fn face_map(rest: &[Point3], moved: &[Point3], corners: &[u32]) -> Option<(Matrix3<f64>, f64)> {
    let &[a, b, c] = corners else {
        return None;
    };
    let frame = |x: &[Point3]| {
        let [a, b, c] = [a, b, c].map(|v| x[v as usize]);
        let area = (b - a).cross(&(c - a));
        let normal = unit(area)? * area.norm().sqrt();
        Some((Matrix3::from_columns(&[b - a, c - a, normal]), area.norm()))
    };
    let ((from, area), (to, _)) = (frame(rest)?, frame(moved)?);
    Some((to * from.try_inverse()?, area))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PolygonSoup;
    use nalgebra::Rotation3;

    fn scene(soup: PolygonSoup) -> Scene {
        Scene {
            blocks: Vec::new(),
            soup,
            contents: Default::default(),
        }
    }

    #[test]
    fn a_similarity_is_its_own_gradient_at_every_vertex() {
        let soup = crate::shapes::icosphere(1);
        let similar = Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner() * 92.0;
        let moved: Vec<Point3> = soup
            .positions
            .iter()
            .map(|p| Point3::from(similar * p.coords) + Vector3::new(5.0, -1.0, 3.0))
            .collect();
        for map in maps(&scene(soup), &moved) {
            assert!((map.unwrap() - similar).norm() < 1e-10);
        }
    }

    #[test]
    fn where_nothing_moved_there_is_no_map_and_loose_vertices_follow_the_whole() {
        let mut soup = crate::shapes::open_grid(3, 1);
        soup.faces = soup
            .faces
            .iter()
            .flat_map(|f| [vec![f[0], f[1], f[2]], vec![f[0], f[2], f[3]]])
            .collect();
        soup.positions.push(Point3::new(9.0, 9.0, 9.0));
        let mut moved = soup.positions.clone();
        assert!(maps(&scene(soup.clone()), &moved)
            .iter()
            .all(Option::is_none));
        moved[0].x -= 1.0;
        moved[8].x -= 1.0;
        let maps = maps(&scene(soup), &moved);
        assert!(maps[0].is_some() && maps[3].is_none() && maps[8].is_some());
    }

    #[test]
    fn copies_of_a_vertex_share_their_map() {
        let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let soup = PolygonSoup {
            positions: vec![
                p(0., 0.),
                p(1., 0.),
                p(1., 1.),
                p(0., 0.),
                p(1., 1.),
                p(0., 1.),
            ],
            faces: vec![vec![0, 1, 2], vec![3, 4, 5]],
        };
        let mut moved = soup.positions.clone();
        moved[1].z = 1.0;
        moved[5].z = -2.0;
        let maps = maps(&scene(soup), &moved);
        assert_eq!((maps[0], maps[2]), (maps[3], maps[4]));
        assert_ne!(maps[1], maps[5]);
    }
}
