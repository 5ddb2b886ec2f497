//! New numbers where those of a file were: positions, their bounds, normals, tangents.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use nalgebra::Matrix3;

use super::accessor::Layout;
use super::bounds::{bounds_edits, Bounds};
use super::container::Container;
use super::file::GltfFile;
use super::morphs;
use super::prune::without_morphs;
use super::scene::{not_finite, Block};
use crate::io::contents::{polygon_area_vector, unit, CarriedNormals, Morphs};
use crate::io::fault::Fault;
use crate::{Point3, PolygonSoup, Vector3};

/// The file with the vertices, which were at those of `rest`, at `moved`: those that did not move keep their bytes.
pub(super) fn rewrite(
    file: &GltfFile,
    rest: &PolygonSoup,
    moved: &[Point3],
    morphs: Morphs,
) -> Result<Vec<u8>, Fault> {
    let (container, blocks) = (&file.container, &file.blocks[..]);
    if moved == rest.positions && morphs != Morphs::Drop {
        return Ok(container.bytes().to_vec());
    }
    let shapes = Shapes::new(file, rest, moved);
    let mut buffers: Vec<Vec<u8>> = container.buffers().map(<[u8]>::to_vec).collect();
    let mut bounds = Vec::new();
    for block in blocks {
        put_positions(&mut buffers, block, &shapes)?;
        bounds.extend(new_bounds(container, block, &buffers));
    }
    put_normals(&mut buffers, file, &shapes);
    put_tangents(&mut buffers, file, &shapes);
    if morphs == Morphs::Carry {
        bounds.extend(morphs::carry(&mut buffers, container, blocks, rest, moved)?);
    }

    let changed = buffers.into_iter().zip(container.buffers());
    let changed: Vec<Option<Vec<u8>>> = changed
        .map(|(new, old)| (new != old).then_some(new))
        .collect();
    bounds.retain(|_| changed.iter().any(Option::is_some));
    let mut edits = bounds_edits(container.json(), &bounds);
    if morphs == Morphs::Drop {
        edits.extend(without_morphs(container.json()));
    }
    check_faces(container.with(&changed, edits), container.path(), rest)
}

/// Numbers that overlap others in the buffer would change these: what was written must still read as the same faces.
fn check_faces(written: Vec<u8>, path: &Path, rest: &PolygonSoup) -> Result<Vec<u8>, Fault> {
    match GltfFile::read(written, path) {
        Ok(again) if again.soup.faces == rest.faces => Ok(again.file.container.into_bytes()),
        _ => Err(Fault::unsupported(
            "a mesh whose positions share bytes with other data".to_owned(),
            "export it again",
        )),
    }
}

/// All vertices as read and moved.
struct Shapes<'a> {
    rest: &'a PolygonSoup,
    /// In the frames of their own meshes, as read.
    local: Vec<Point3>,
    /// There, moved.
    moved: Vec<Point3>,
    /// Whether each moved.
    has_moved: Vec<bool>,
}

impl<'a> Shapes<'a> {
    fn new(file: &GltfFile, rest: &'a PolygonSoup, moved: &[Point3]) -> Self {
        let has_moved = rest
            .positions
            .iter()
            .zip(moved)
            .map(|(from, to)| from != to);
        let mut shapes = Self {
            rest,
            local: Vec::with_capacity(moved.len()),
            moved: Vec::with_capacity(moved.len()),
            has_moved: has_moved.collect(),
        };
        for block in &file.blocks {
            for row in block.rows.clone() {
                let in_block = row - block.rows.start;
                let local = Point3::from(block.positions.get::<3>(&file.container, in_block));
                shapes.local.push(local);
                let frame = block
                    .frame
                    .matrix(in_block)
                    .filter(|_| shapes.has_moved[row]);
                let back = frame.and_then(|matrix| matrix.try_inverse());
                shapes.moved.push(match back {
                    _ if !shapes.has_moved[row] => local,
                    None => moved[row],
                    Some(back) => back.transform_point(&moved[row]),
                });
            }
        }
        shapes
    }
}

fn put_positions(buffers: &mut [Vec<u8>], block: &Block, shapes: &Shapes<'_>) -> Result<(), Fault> {
    for row in block.rows.clone().filter(|&row| shapes.has_moved[row]) {
        let p = shapes.moved[row];
        if !p.iter().all(|&c| (c as f32).is_finite()) {
            return Err(not_finite("vertex", row, p.coords));
        }
        let in_block = row - block.rows.start;
        block.positions.put(buffers, in_block, p.coords.as_slice());
    }
    Ok(())
}

/// The bounds of the positions as they now stand in `buffers`, where they moved.
fn new_bounds(container: &Container, block: &Block, buffers: &[Vec<u8>]) -> Vec<Bounds> {
    let has_moved = (0..block.positions.count).any(|row| {
        block.positions.slot(row).is_some_and(|(buffer, at)| {
            let place = at..at + 12;
            Some(&buffers[buffer][place.clone()]) != container.buffer(buffer).map(|old| &old[place])
        })
    });
    let accessors = block.accessors.iter().filter(|_| has_moved);
    accessors
        .map(|&accessor| Bounds::of(accessor, &block.positions, buffers))
        .collect()
}

/// The blocks that have one of their layouts, and that layout.
fn with_layout<'a>(
    file: &'a GltfFile,
    of: impl Fn(&'a Block) -> Option<&'a Arc<Layout>>,
) -> impl Iterator<Item = (&'a Block, &'a Layout)> {
    let blocks = file.blocks.iter();
    blocks.filter_map(move |block| Some((block, &**of(block)?)))
}

/// Vertices split along a seam of texture coordinates share their normal: rows of equal position and normal are one.
fn put_normals(buffers: &mut [Vec<u8>], file: &GltfFile, shapes: &Shapes<'_>) {
    let mut group_at: HashMap<[u64; 6], usize> = HashMap::new();
    let mut read = Vec::new();
    let mut group_of = vec![usize::MAX; shapes.local.len()];
    for (block, normals) in with_layout(file, |block| block.normals.as_ref()) {
        for row in block.rows.clone() {
            let n = Vector3::from(normals.get::<3>(&file.container, row - block.rows.start));
            let p = shapes.rest.positions[row];
            let key = [p.x, p.y, p.z, n.x, n.y, n.z].map(f64::to_bits);
            group_of[row] = *group_at.entry(key).or_insert_with(|| {
                read.push(n);
                read.len() - 1
            });
        }
    }
    let mut carried = CarriedNormals::new(read);
    for corners in &shapes.rest.faces {
        let areas = [&shapes.local, &shapes.moved].map(|x| polygon_area_vector(x, corners));
        for &v in corners {
            carried.add_corner(group_of[v as usize], areas);
        }
    }
    for (block, normals) in with_layout(file, |block| block.normals.as_ref()) {
        for row in block.rows.clone() {
            if let Some(n) = carried.changed(group_of[row]) {
                normals.put(buffers, row - block.rows.start, n.as_slice());
            }
        }
    }
}

/// A tangent is carried by the faces around it, `t' = Σ |A_f| J_f t` with `J_f` the map of a face's edges and normal, then
/// laid into the plane of the new normal. Its sign of handedness stays.
fn put_tangents(buffers: &mut [Vec<u8>], file: &GltfFile, shapes: &Shapes<'_>) {
    let mut sums = vec![(Vector3::zeros(), Vector3::zeros()); shapes.local.len()];
    let mut tangent_of = vec![None; shapes.local.len()];
    for (block, tangents) in with_layout(file, |block| block.tangents.as_ref()) {
        for row in block.rows.clone() {
            let [x, y, z, _] = tangents.get::<4>(&file.container, row - block.rows.start);
            tangent_of[row] = Some(Vector3::new(x, y, z));
        }
    }
    for corners in &shapes.rest.faces {
        let Some(map) = face_map(shapes, corners) else {
            continue;
        };
        let area = polygon_area_vector(&shapes.moved, corners);
        for &v in corners {
            if let Some(t) = tangent_of[v as usize] {
                let (tangent, normal) = &mut sums[v as usize];
                *tangent += area.norm() * (map * t);
                *normal += area;
            }
        }
    }
    for (block, tangents) in with_layout(file, |block| block.tangents.as_ref()) {
        let has_moved = |row: &usize| shapes.local[*row] != shapes.moved[*row];
        for row in block.rows.clone().filter(has_moved) {
            let (tangent, normal) = sums[row];
            let normal = unit(normal).unwrap_or_default();
            let flat = tangent - normal * normal.dot(&tangent);
            if let Some(t) = unit(flat) {
                tangents.put(buffers, row - block.rows.start, t.as_slice());
            }
        }
    }
}

/// The linear map that takes two edges and the unit normal of a triangle as read to those of the moved one.
fn face_map(shapes: &Shapes<'_>, corners: &[u32]) -> Option<Matrix3<f64>> {
    let &[a, b, c] = corners else {
        return None;
    };
    let frame = |x: &[Point3]| {
        let [a, b, c] = [a, b, c].map(|v| x[v as usize]);
        let normal = unit((b - a).cross(&(c - a)))?;
        Some(Matrix3::from_columns(&[b - a, c - a, normal]))
    };
    Some(frame(&shapes.moved)? * frame(&shapes.local)?.try_inverse()?)
}
