//! glTF and GLB: the meshes of the scene as one soup. Written back, only POSITION, NORMAL, TANGENT and the bounds of
//! the positions differ; skins, joints, morph targets, texture coordinates, materials and animations stay as they are.

mod accessor;
mod container;
mod gradient;
mod json_spans;
mod morphs;
mod prune;
mod scene;
mod write;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use nalgebra::{Matrix3, Matrix4};

use self::container::{Bounds, Container};
use self::scene::{Block, Scene};
use super::contents::{polygon_area_vector, unit, CarriedNormals, Morphs, Parsed};
use super::error::{Fault, Place, ReadProblem};
use crate::{Point3, Vector3};

pub(in crate::io) use self::container::is_glb;
pub(in crate::io) use self::write::{write_glb, write_gltf};

/// Reads a file: the vertices of each mesh where its node puts them, and their triangles.
pub(super) fn read(bytes: &[u8], path: &Path) -> Result<Parsed, Fault> {
    let container = Container::read(bytes, path)?;
    let Scene { soup, contents, .. } = Scene::read(&container)?;
    Ok(Parsed { soup, contents })
}

/// What keeps the vertices from being moved one by one in their places, and what to do about it.
pub(super) fn find_unmovable(
    bytes: &[u8],
    path: &Path,
    morphs: Morphs,
) -> Result<Option<(&'static str, &'static str)>, Fault> {
    let container = Container::read(bytes, path)?;
    let scene = Scene::read(&container)?;
    let mut taken = HashSet::new();
    let found = scene
        .blocks
        .iter()
        .find_map(|block| unmovable(block, &mut taken));
    match (found, morphs) {
        (None, Morphs::Carry) => morphs::find_uncarriable(&container, &scene),
        _ => Ok(found),
    }
}

fn unmovable(
    block: &Block,
    taken: &mut HashSet<(usize, usize)>,
) -> Option<(&'static str, &'static str)> {
    if !block.positions.is_float() {
        return Some((
            "a mesh with quantised positions",
            "export positions as plain floats",
        ));
    }
    if block.has_others {
        return Some((
            "a mesh whose parts share positions but not normals or tangents",
            "export it with positions of its own for each part",
        ));
    }
    if block.to_scene.is_some_and(|m| !m.is_invertible()) {
        return Some((
            "a node flattened to nothing",
            "apply its transform to the mesh",
        ));
    }
    for row in 0..block.positions.count {
        match block.positions.slot(row) {
            None => {
                return Some((
                    "a sparse mesh with implied positions",
                    "export it without sparse accessors",
                ))
            }
            Some(slot) if !taken.insert(slot) => {
                return Some((
                    "a mesh that the scene shows more than once",
                    "give each of its nodes its own mesh",
                ));
            }
            Some(_) => {}
        }
    }
    None
}

/// The file with the vertices at `moved`: those that did not move keep their bytes.
pub(super) fn rewrite(
    bytes: &[u8],
    path: &Path,
    moved: &[Point3],
    morphs: Morphs,
) -> Result<Vec<u8>, Fault> {
    let container = Container::read(bytes, path)?;
    let scene = Scene::read(&container)?;

    let shapes = Shapes::new(&container, &scene, moved);
    let mut buffers: Vec<Vec<u8>> = container.buffers.iter().map(|b| b.to_vec()).collect();
    let mut bounds = Vec::new();
    for block in &scene.blocks {
        put_positions(&mut buffers, block, &scene, &shapes, moved)?;
        bounds.extend(new_bounds(&container, block, &buffers));
    }
    put_normals(&mut buffers, &container, &scene, &shapes);
    put_tangents(&mut buffers, &container, &scene, &shapes);
    if morphs == Morphs::Carry {
        bounds.extend(morphs::carry(&mut buffers, &container, &scene, moved)?);
    }

    let changed: Vec<Option<Vec<u8>>> = buffers
        .into_iter()
        .zip(&container.buffers)
        .map(|(new, old)| (new != **old).then_some(new))
        .collect();
    let bounds: Vec<Bounds> = bounds
        .into_iter()
        .filter(|_| changed.iter().any(Option::is_some))
        .collect();
    let edits = match morphs {
        Morphs::Drop => prune::without_morphs(container.json()),
        Morphs::Carry | Morphs::Keep => Vec::new(),
    };
    let written = container.with(&changed, &bounds, edits);
    check_faces(&written, path, &scene)?;
    Ok(written)
}

/// Numbers that overlap others in the buffer would change these: what was written must still read as the same faces.
fn check_faces(written: &[u8], path: &Path, scene: &Scene) -> Result<(), Fault> {
    match read(written, path) {
        Ok(again) if again.soup.faces == scene.soup.faces => Ok(()),
        _ => Err(container::unsupported(
            "a mesh whose positions share bytes with other data".to_owned(),
            "export it again",
        )),
    }
}

/// All vertices in the frames of their own meshes, as read and moved.
struct Shapes {
    rest: Vec<Point3>,
    moved: Vec<Point3>,
}

impl Shapes {
    fn new(container: &Container<'_>, scene: &Scene, moved: &[Point3]) -> Self {
        let mut shapes = Self {
            rest: Vec::new(),
            moved: Vec::new(),
        };
        for block in &scene.blocks {
            let back = block.to_scene.and_then(|m: Matrix4<f64>| m.try_inverse());
            for row in block.rows.clone() {
                let local =
                    Point3::from(block.positions.get::<3>(container, row - block.rows.start));
                shapes.rest.push(local);
                let is_kept = scene.soup.positions[row] == moved[row];
                shapes.moved.push(match back {
                    _ if is_kept => local,
                    None => moved[row],
                    Some(back) => back.transform_point(&moved[row]),
                });
            }
        }
        shapes
    }
}

fn put_positions(
    buffers: &mut [Vec<u8>],
    block: &Block,
    scene: &Scene,
    shapes: &Shapes,
    moved: &[Point3],
) -> Result<(), Fault> {
    for row in block.rows.clone() {
        if scene.soup.positions[row] == moved[row] {
            continue;
        }
        let p = shapes.moved[row];
        if !p.iter().all(|&c| (c as f32).is_finite()) {
            return Err(Fault {
                place: Place::Row {
                    element: "vertex".to_owned(),
                    row,
                },
                problem: ReadProblem::NotFinite {
                    text: format!("{} {} {}", p.x, p.y, p.z),
                },
            });
        }
        block
            .positions
            .put(buffers, row - block.rows.start, p.coords.as_slice());
    }
    Ok(())
}

/// The bounds of the positions as they now stand in `buffers`, where they moved.
fn new_bounds(container: &Container<'_>, block: &Block, buffers: &[Vec<u8>]) -> Vec<Bounds> {
    let has_moved = (0..block.positions.count).any(|row| {
        block.positions.slot(row).is_some_and(|(buffer, at)| {
            buffers[buffer][at..at + 12] != container.buffers[buffer][at..at + 12]
        })
    });
    let accessors = block.accessors.iter().filter(|_| has_moved);
    accessors
        .map(|&accessor| Bounds::of(accessor, &block.positions, buffers))
        .collect()
}

/// Vertices split along a seam of texture coordinates share their normal: rows of equal position and normal are one.
fn put_normals(buffers: &mut [Vec<u8>], container: &Container<'_>, scene: &Scene, shapes: &Shapes) {
    let mut group_at: HashMap<[u64; 6], usize> = HashMap::new();
    let mut read = Vec::new();
    let mut group_of = vec![usize::MAX; scene.soup.positions.len()];
    for (block, normals) in scene
        .blocks
        .iter()
        .filter_map(|b| b.normals.as_ref().map(|n| (b, n)))
    {
        for row in block.rows.clone() {
            let n = Vector3::from(normals.get::<3>(container, row - block.rows.start));
            let p = scene.soup.positions[row];
            let key = [p.x, p.y, p.z, n.x, n.y, n.z].map(f64::to_bits);
            group_of[row] = *group_at.entry(key).or_insert_with(|| {
                read.push(n);
                read.len() - 1
            });
        }
    }
    let mut carried = CarriedNormals::new(read);
    for corners in &scene.soup.faces {
        let areas = [&shapes.rest, &shapes.moved].map(|x| polygon_area_vector(x, corners));
        for &v in corners {
            carried.add_corner(group_of[v as usize], areas);
        }
    }
    for (block, normals) in scene
        .blocks
        .iter()
        .filter_map(|b| b.normals.as_ref().map(|n| (b, n)))
    {
        for row in block.rows.clone() {
            if let Some(n) = carried.changed(group_of[row]) {
                normals.put(buffers, row - block.rows.start, n.as_slice());
            }
        }
    }
}

/// A tangent is carried by the faces around it, `t' = Σ |A_f| J_f t` with `J_f` the map of a face's edges and normal, then
/// laid into the plane of the new normal. Its sign of handedness stays.
fn put_tangents(
    buffers: &mut [Vec<u8>],
    container: &Container<'_>,
    scene: &Scene,
    shapes: &Shapes,
) {
    let mut sums = vec![(Vector3::zeros(), Vector3::zeros()); scene.soup.positions.len()];
    let mut tangent_of = vec![None; scene.soup.positions.len()];
    for (block, tangents) in scene
        .blocks
        .iter()
        .filter_map(|b| b.tangents.as_ref().map(|t| (b, t)))
    {
        for row in block.rows.clone() {
            let [x, y, z, _] = tangents.get::<4>(container, row - block.rows.start);
            tangent_of[row] = Some(Vector3::new(x, y, z));
        }
    }
    for corners in &scene.soup.faces {
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
    for (block, tangents) in scene
        .blocks
        .iter()
        .filter_map(|b| b.tangents.as_ref().map(|t| (b, t)))
    {
        for row in block
            .rows
            .clone()
            .filter(|&row| shapes.rest[row] != shapes.moved[row])
        {
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
fn face_map(shapes: &Shapes, corners: &[u32]) -> Option<Matrix3<f64>> {
    let &[a, b, c] = corners else {
        return None;
    };
    let frame = |x: &[Point3]| {
        let [a, b, c] = [a, b, c].map(|v| x[v as usize]);
        let normal = unit((b - a).cross(&(c - a)))?;
        Some(Matrix3::from_columns(&[b - a, c - a, normal]))
    };
    Some(frame(&shapes.moved)? * frame(&shapes.rest)?.try_inverse()?)
}

/// The normals of the vertices, turned with their nodes.
pub(super) fn vertex_normals(bytes: &[u8], path: &Path) -> Option<Vec<Vector3>> {
    let container = Container::read(bytes, path).ok()?;
    let scene = Scene::read(&container).ok()?;
    let mut out = vec![Vector3::zeros(); scene.soup.positions.len()];
    let mut any = false;
    for (block, normals) in scene
        .blocks
        .iter()
        .filter_map(|b| b.normals.as_ref().map(|n| (b, n)))
    {
        let turn = block.to_scene.map_or_else(
            || Some(Matrix3::identity()),
            |m| Some(m.fixed_view::<3, 3>(0, 0).try_inverse()?.transpose()),
        );
        let turn = turn.unwrap_or_else(Matrix3::zeros);
        for row in block.rows.clone() {
            out[row] = turn * Vector3::from(normals.get::<3>(&container, row - block.rows.start));
            any = true;
        }
    }
    any.then_some(out)
}

/// The texture coordinates of the vertices, the first set; (0, 0) at the lower left, where these files have it above.
pub(super) fn vertex_uvs(bytes: &[u8], path: &Path) -> Option<Vec<[f64; 2]>> {
    let container = Container::read(bytes, path).ok()?;
    let scene = Scene::read(&container).ok()?;
    let mut out = vec![[0.0; 2]; scene.soup.positions.len()];
    let mut any = false;
    for block in &scene.blocks {
        let Some(uvs) = &block.uvs else { continue };
        for row in block.rows.clone() {
            let uv = uvs.get::<2>(&container, row - block.rows.start);
            if uv.iter().all(|c| c.is_finite()) {
                out[row] = [uv[0], 1.0 - uv[1]];
            }
            any = true;
        }
    }
    any.then_some(out)
}
