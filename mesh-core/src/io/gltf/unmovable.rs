//! Files in which not every vertex has a place of its own.

use std::collections::HashSet;

use super::file::GltfFile;
use super::morphs::find_uncarriable;
use super::scene::Block;
use crate::io::contents::Morphs;
use crate::io::document::Unmovable;
use crate::io::fault::Fault;

/// What keeps the vertices from being moved one by one in their places.
pub(super) fn find_unmovable(file: &GltfFile, morphs: Morphs) -> Result<Option<Unmovable>, Fault> {
    let mut taken = HashSet::new();
    let found = file.blocks.iter().find_map(|b| unmovable(b, &mut taken));
    match (found, morphs) {
        (None, Morphs::Carry) => find_uncarriable(&file.container, &file.blocks),
        _ => Ok(found),
    }
}

fn unmovable(block: &Block, taken: &mut HashSet<(usize, usize)>) -> Option<Unmovable> {
    let because = |feature, advice| Some(Unmovable { feature, advice });
    if !block.positions.is_float() {
        return because(
            "a mesh with quantised positions",
            "export positions as plain floats",
        );
    }
    if block.has_others {
        return because(
            "a mesh whose parts share positions but not normals or tangents",
            "export it with positions of its own for each part",
        );
    }
    if !block.frame.is_invertible() {
        return because(
            "a node or joint flattened to nothing",
            "apply its transform to the mesh",
        );
    }
    for row in 0..block.positions.count {
        match block.positions.slot(row) {
            None => {
                return because(
                    "a sparse mesh with implied positions",
                    "export it without sparse accessors",
                )
            }
            Some(slot) if !taken.insert(slot) => {
                return because(
                    "a mesh that the scene shows more than once",
                    "give each of its nodes its own mesh",
                );
            }
            Some(_) => {}
        }
    }
    None
}
