//! Morph targets (blend shapes) carried to the new shape, so that a rigged head keeps its expressions.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use nalgebra::Matrix3;

use super::accessor::{Layout, Layouts};
use super::bounds::Bounds;
use super::container::Container;
use super::scene::{not_finite, Block, Displaced};
use crate::io::contents::unit;
use crate::io::document::Unmovable;
use crate::io::fault::Fault;
use crate::{map_gradients, Point3, PolygonSoup, Vector3};

/// The block, the row in it and what is displaced there.
type Use = (usize, usize, Displaced);

/// What keeps the morph targets from being carried, and what to do about it.
pub(super) fn find_uncarriable(
    container: &Container,
    blocks: &[Block],
) -> Result<Option<Unmovable>, Fault> {
    let mut taken: HashMap<(usize, usize), Option<Use>> = HashMap::new();
    for block in blocks {
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
    for (k, block) in blocks.iter().enumerate() {
        let mut seen = HashSet::new();
        for &(displaced, accessor) in &block.displacements {
            let (layout, layout_row) = layouts.of(container, accessor)?;
            if !seen.insert((displaced, layout_row)) {
                continue;
            }
            if !layout.is_float() || !layout.has_components(3) || layout.count != block.rows.len() {
                return Ok(Some(Unmovable {
                    feature: "a mesh with quantised or incomplete morph targets",
                    advice: "export them as plain floats, or use --morphs keep",
                }));
            }
            for row in layout.rows() {
                let Some(slot) = layout.slot(row) else {
                    continue;
                };
                let use_here = Some((k, row, displaced));
                if *taken.entry(slot).or_insert(use_here) != use_here {
                    return Ok(Some(Unmovable {
                        feature: "a morph target that shares its numbers with another mesh",
                        advice: "export each mesh with its own, or use --morphs keep",
                    }));
                }
            }
        }
    }
    Ok(None)
}

/// Takes every displacement to the new shape, `δ' = J δ`; gives the new bounds of the accessors that changed.
///
/// J is the gradient of the map around the vertex (see [`map_gradients`]). A normal's displacement is the difference of the two normals,
/// morphed and not, each sent through `J⁻ᵀ`; a tangent's likewise through J. Where nothing moved, bytes stay.
pub(super) fn carry(
    buffers: &mut [Vec<u8>],
    container: &Container,
    blocks: &[Block],
    rest: &PolygonSoup,
    moved: &[Point3],
) -> Result<Vec<Bounds>, Fault> {
    let maps = map_gradients(rest, moved);
    let mut bounds = Vec::new();
    let mut layouts = Layouts::default();
    for block in blocks {
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
                    *unknown.insert(put.map_err(|to| not_finite("accessor", accessor, to))?)
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
    container: &Container,
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

/// One displacement in the frame of its mesh, sent through `map`, which is in that of the scene; none where it is zero.
fn carried(
    container: &Container,
    block: &Block,
    row: usize,
    displaced: Displaced,
    map: Matrix3<f64>,
    displacement: Vector3,
) -> Option<Vector3> {
    if displacement == Vector3::zeros() {
        return None;
    }
    let map = match block.frame.linear(row) {
        None => map,
        Some(linear) => linear.try_inverse()? * map * linear,
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
