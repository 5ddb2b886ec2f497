//! The scene of a glTF file as one soup: each mesh where its node puts it.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;
use std::sync::Arc;

use gltf::json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf::json::scene::Node;
use gltf::json::validation::Checked;
use nalgebra::{Matrix4, Quaternion, UnitQuaternion};

use super::accessor::{Layout, Layouts};
use super::container::{unsupported, Container};
use crate::io::contents::{Contents, NamedFaces};
use crate::io::error::{Place, ReadProblem};
use crate::io::fault::Fault;
use crate::{Point3, PolygonSoup, Vector3};

/// What a morph target displaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Displaced {
    Position,
    Normal,
    Tangent,
}

/// The accessors in which the morph targets of a primitive keep displacements.
fn displacements(primitive: &Primitive) -> impl Iterator<Item = (Displaced, usize)> + '_ {
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

/// The positions of one accessor in one node, and all that moves with them.
#[derive(Debug)]
pub(super) struct Block {
    /// Accessors that read these very numbers.
    pub(super) accessors: BTreeSet<usize>,
    pub(super) positions: Arc<Layout>,
    pub(super) normals: Option<Arc<Layout>>,
    pub(super) tangents: Option<Arc<Layout>>,
    pub(super) uvs: Option<Arc<Layout>>,
    /// The accessors with displacements of morph targets.
    pub(super) displacements: BTreeSet<(Displaced, usize)>,
    /// Whether primitives read these positions with other normals or tangents: only one set of them is seen.
    pub(super) has_others: bool,
    /// From the mesh's own frame into the scene; none where they are the same.
    pub(super) to_scene: Option<Matrix4<f64>>,
    /// The vertices, as rows of the soup.
    pub(super) rows: Range<usize>,
}

/// What was found before: layouts, and the block of each node and layout of positions.
#[derive(Default)]
struct Known {
    layouts: Layouts,
    blocks: HashMap<(Option<usize>, usize), usize>,
}

/// All blocks and what they look like together.
#[derive(Default)]
pub(super) struct Scene {
    pub(super) blocks: Vec<Block>,
    pub(super) soup: PolygonSoup,
    pub(super) contents: Contents,
}

impl Scene {
    pub(super) fn read(container: &Container) -> Result<Self, Fault> {
        let mut scene = Self::default();
        let mut known = Known::default();
        let mut names = Names::default();
        for (node, mesh, to_scene) in shown_meshes(container) {
            let first_face = scene.soup.faces.len();
            let Some(shown) = container.root.meshes.get(mesh) else {
                return Err(missing("mesh", mesh));
            };
            for primitive in &shown.primitives {
                let first = scene.soup.faces.len();
                scene.add_primitive(container, primitive, (node, to_scene), &mut known)?;
                let material = primitive.material.and_then(|m| {
                    let name = container.root.materials.get(m.value())?.name.clone();
                    Some((
                        m.value(),
                        name.unwrap_or_else(|| format!("material {}", m.value())),
                    ))
                });
                if let Some((row, name)) = material {
                    names
                        .materials
                        .entry(row)
                        .or_insert((name, Vec::new()))
                        .1
                        .push(first..scene.soup.faces.len());
                }
            }
            scene.contents.n_morph_targets += n_targets(shown);
            let name = shown.name.clone().unwrap_or_else(|| format!("mesh {mesh}"));
            let faces = first_face..scene.soup.faces.len();
            names
                .meshes
                .entry(mesh)
                .or_insert((name, Vec::new()))
                .1
                .push(faces);
        }
        let images = container.root.images.iter().filter_map(|i| i.uri.clone());
        scene.contents.references = images.filter(|uri| !uri.starts_with("data:")).collect();
        scene.contents.n_skins = container.root.skins.len();
        scene.contents.n_animations = container.root.animations.len();
        scene.contents.objects = Names::list(names.meshes);
        scene.contents.materials = Names::list(names.materials);
        Ok(scene)
    }

    fn add_primitive(
        &mut self,
        container: &Container,
        primitive: &Primitive,
        (node, to_scene): (Option<usize>, Option<Matrix4<f64>>),
        known: &mut Known,
    ) -> Result<(), Fault> {
        let attribute = |semantic| {
            primitive
                .attributes
                .get(&Checked::Valid(semantic))
                .map(|i| i.value())
        };
        let Some(accessor) = attribute(Semantic::Positions) else {
            return Ok(());
        };
        let (positions, layout) = known.layouts.of(container, accessor)?;
        let found = known.blocks.get(&(node, layout)).copied();
        let block = match found {
            Some(block) => block,
            None => self.add_block(container, positions, to_scene)?,
        };
        known.blocks.insert((node, layout), block);
        let n_rows = self.blocks[block].rows.len();
        let mut vector = |semantic, n| -> Result<Option<Arc<Layout>>, Fault> {
            let layout = attribute(semantic).map(|a| known.layouts.of(container, a));
            let layout = layout.transpose()?.map(|(layout, _)| layout);
            Ok(layout.filter(|l| l.has_components(n) && l.count == n_rows))
        };
        let (normals, tangents) = (
            vector(Semantic::Normals, 3)?,
            vector(Semantic::Tangents, 4)?,
        );
        let uvs = vector(Semantic::TexCoords(0), 2)?;
        let (has_uvs, has_colors) = (
            attribute(Semantic::TexCoords(0)),
            attribute(Semantic::Colors(0)),
        );

        let block = &mut self.blocks[block];
        let rows = block.rows.clone();
        block.accessors.insert(accessor);
        if found.is_none() {
            let count = |is_there: bool| if is_there { rows.len() } else { 0 };
            self.contents.n_uvs += count(has_uvs.is_some());
            self.contents.n_colors += count(has_colors.is_some());
            self.contents.n_normals += count(normals.is_some());
        }
        let differs = |own: &Option<Arc<Layout>>, new: &Option<Arc<Layout>>| {
            own.as_ref().zip(new.as_ref()).is_some_and(|(a, b)| a != b)
        };
        block.has_others |=
            differs(&block.normals, &normals) || differs(&block.tangents, &tangents);
        block.normals = block.normals.take().or(normals);
        block.tangents = block.tangents.take().or(tangents);
        block.uvs = block.uvs.take().or(uvs);
        block.displacements.extend(displacements(primitive));
        self.add_faces(container, primitive, rows)
    }

    fn add_block(
        &mut self,
        container: &Container,
        positions: Arc<Layout>,
        to_scene: Option<Matrix4<f64>>,
    ) -> Result<usize, Fault> {
        if !positions.has_components(3) {
            return Err(unsupported(
                "a POSITION of other than three components".to_owned(),
                "export it again",
            ));
        }
        self.check_size(container, positions.count)?;
        let first = self.soup.positions.len();
        for row in 0..positions.count {
            let local = Point3::from(positions.get::<3>(container, row));
            let p = to_scene.map_or(local, |m| m.transform_point(&local));
            if !p.iter().all(|c| c.is_finite()) {
                return Err(not_finite("vertex", first + row, p.coords));
            }
            self.soup.positions.push(p);
        }
        self.blocks.push(Block {
            accessors: BTreeSet::new(),
            positions,
            normals: None,
            tangents: None,
            uvs: None,
            displacements: BTreeSet::new(),
            has_others: false,
            to_scene,
            rows: first..self.soup.positions.len(),
        });
        Ok(self.blocks.len() - 1)
    }

    /// A file that shows one mesh many times could ask for any size.
    fn check_size(&self, container: &Container, n_more: usize) -> Result<(), Fault> {
        let most = container.n_bytes().saturating_mul(4).max(1 << 22);
        if self.soup.positions.len() + self.soup.faces.len() + n_more <= most {
            return Ok(());
        }
        let feature = "a scene that shows the same meshes so many times".to_owned();
        Err(unsupported(feature, "save only the mesh that is meant"))
    }

    fn add_faces(
        &mut self,
        container: &Container,
        primitive: &Primitive,
        rows: Range<usize>,
    ) -> Result<(), Fault> {
        let mode = match primitive.mode {
            Checked::Valid(mode) => mode,
            Checked::Invalid => {
                return Err(unsupported(
                    "a primitive of unknown mode".to_owned(),
                    "export it again",
                ))
            }
        };
        if matches!(
            mode,
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip
        ) {
            self.contents.n_lines_and_points += 1;
            return Ok(());
        }
        let corners = match primitive.indices {
            Some(accessor) => indices(container, accessor.value(), &rows)?,
            None => (rows.start as u32..rows.end as u32).collect(),
        };
        self.check_size(container, corners.len())?;
        let faces = &mut self.soup.faces;
        match mode {
            Mode::Triangles => faces.extend(corners.chunks_exact(3).map(<[u32]>::to_vec)),
            Mode::TriangleStrip => {
                faces.extend(corners.windows(3).enumerate().map(|(k, t)| match k % 2 {
                    0 => t.to_vec(),
                    _ => vec![t[1], t[0], t[2]],
                }))
            }
            Mode::TriangleFan => {
                let around = corners.get(1..).unwrap_or_default();
                faces.extend(
                    around
                        .windows(2)
                        .map(|side| vec![corners[0], side[0], side[1]]),
                );
            }
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => {}
        }
        Ok(())
    }
}

/// How many morph targets a mesh has: all its primitives have as many.
fn n_targets(mesh: &Mesh) -> usize {
    let targets = mesh.primitives.iter().filter_map(|p| p.targets.as_ref());
    targets.map(Vec::len).max().unwrap_or(0)
}

/// Names by row in the document, with their faces.
#[derive(Default)]
struct Names {
    meshes: BTreeMap<usize, (String, Vec<Range<usize>>)>,
    materials: BTreeMap<usize, (String, Vec<Range<usize>>)>,
}

impl Names {
    fn list(named: BTreeMap<usize, (String, Vec<Range<usize>>)>) -> Vec<NamedFaces> {
        named
            .into_values()
            .map(|(name, faces)| NamedFaces { name, faces })
            .collect()
    }
}

/// A vector that is not finite, or not in single precision, at row `row` of `element`.
pub(super) fn not_finite(element: &str, row: usize, vector: Vector3) -> Fault {
    Fault {
        place: Place::Row {
            element: element.to_owned(),
            row,
        },
        problem: ReadProblem::NotFinite {
            text: format!("{} {} {}", vector.x, vector.y, vector.z),
        },
    }
}

fn missing(element: &str, row: usize) -> Fault {
    let expected = "an element that another names";
    Fault {
        place: Place::Row {
            element: element.to_owned(),
            row,
        },
        problem: ReadProblem::EndsEarly { expected },
    }
}

fn indices(container: &Container, accessor: usize, rows: &Range<usize>) -> Result<Vec<u32>, Fault> {
    let layout = Layout::of(container, accessor)?;
    let mut corners = Vec::with_capacity(layout.count);
    for k in 0..layout.count {
        let [index] = layout.get(container, k);
        if !(index >= 0.0 && index < rows.len() as f64) {
            return Err(Fault {
                place: Place::Row {
                    element: "accessor".to_owned(),
                    row: accessor,
                },
                problem: ReadProblem::IndexOutOfRange {
                    index: index as i64,
                    n_vertices: rows.len(),
                    first: 0,
                },
            });
        }
        corners.push((rows.start + index as usize) as u32);
    }
    Ok(corners)
}

type ShownMesh = (Option<usize>, usize, Option<Matrix4<f64>>);

/// Node, mesh and transform of every mesh that the scene shows, in the order of the nodes; every mesh of a file that
/// shows none. A skinned mesh ignores its node's transform, as the format says.
fn shown_meshes(container: &Container) -> Vec<ShownMesh> {
    let nodes = &container.root.nodes;
    let transforms = scene_transforms(container);
    let shown: Vec<ShownMesh> = (0..nodes.len())
        .filter_map(|k| {
            let (mesh, transform) = (nodes[k].mesh?, transforms[k]?);
            let is_fixed = nodes[k].skin.is_some() || transform == Matrix4::identity();
            Some((Some(k), mesh.value(), (!is_fixed).then_some(transform)))
        })
        .collect();
    if shown.is_empty() {
        return (0..container.root.meshes.len())
            .map(|mesh| (None, mesh, None))
            .collect();
    }
    shown
}

/// From each node's frame into the scene; none for nodes that the scene does not hold.
fn scene_transforms(container: &Container) -> Vec<Option<Matrix4<f64>>> {
    let root = &container.root;
    let scene = root.scene.map_or(0, |s| s.value());
    let tops: Vec<usize> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.iter().map(|n| n.value()).collect(),
        None => tops(&root.nodes),
    };
    let mut transforms = vec![None; root.nodes.len()];
    let mut open: Vec<(usize, Matrix4<f64>)> =
        tops.into_iter().map(|k| (k, Matrix4::identity())).collect();
    while let Some((k, above)) = open.pop() {
        let Some(node) = root.nodes.get(k).filter(|_| transforms[k].is_none()) else {
            continue;
        };
        let transform = above * local_transform(node);
        transforms[k] = Some(transform);
        let children = node.children.iter().flatten();
        open.extend(children.map(|child| (child.value(), transform)));
    }
    transforms
}

/// The nodes that are no other's child.
fn tops(nodes: &[Node]) -> Vec<usize> {
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|n| n.children.iter().flatten()) {
        if let Some(is_child) = is_child.get_mut(child.value()) {
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
            let [x, y, z, w] = rotation.0.map(f64::from);
            UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_homogeneous()
        }
    };
    Matrix4::new_translation(&translation) * turn * Matrix4::new_nonuniform_scaling(&scale)
}
