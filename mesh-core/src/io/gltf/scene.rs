//! The scene of a glTF file as one soup: each mesh where its node puts it.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;
use std::sync::Arc;

use nalgebra::Matrix4;

use super::accessor::{Layout, Layouts};
use super::container::Container;
use super::extensions;
use super::frame::Frame;
use super::nodes::{scene_transforms, shown_meshes, ShownMesh};
use super::root::{Mesh, Primitive};
use crate::io::contents::{Contents, NamedFaces};
use crate::io::error::{Place, ReadProblem};
use crate::io::fault::{checked_coordinate, Fault};
use crate::io::finding::Finding;
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
    const NAMES: [(Displaced, &str); 3] = [
        (Displaced::Position, "POSITION"),
        (Displaced::Normal, "NORMAL"),
        (Displaced::Tangent, "TANGENT"),
    ];
    primitive.targets.iter().flat_map(|target| {
        NAMES
            .iter()
            .filter_map(|(displaced, name)| Some((*displaced, *target.get(*name)?)))
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
    pub(super) colors: Option<Arc<Layout>>,
    /// The accessors with displacements of morph targets.
    pub(super) displacements: BTreeSet<(Displaced, usize)>,
    /// Whether primitives read these positions with other normals or tangents: only one set of them is seen.
    pub(super) has_others: bool,
    /// From the mesh's own frame into the scene.
    pub(super) frame: Frame,
    /// The vertices, as rows of the soup.
    pub(super) rows: Range<usize>,
}

/// Positions in a node, by the rows of their layout and those of their joints and weights.
type BlockKey = (Option<usize>, usize, Vec<usize>);

/// What was found before: layouts, and the block of each node and layout of positions.
#[derive(Default)]
struct Known {
    transforms: Vec<Option<Matrix4<f64>>>,
    layouts: Layouts,
    blocks: HashMap<BlockKey, usize>,
}

/// All blocks and what they look like together.
#[derive(Default)]
pub(super) struct Scene {
    pub(super) blocks: Vec<Block>,
    pub(super) soup: PolygonSoup,
    pub(super) contents: Contents,
    pub(super) findings: Vec<Finding>,
}

impl Scene {
    pub(super) fn read(container: &Container) -> Result<Self, Fault> {
        let root = &container.root;
        let mut scene = Self::default();
        let mut known = Known {
            transforms: scene_transforms(root),
            ..Known::default()
        };
        let mut names = Names::default();
        for shown in shown_meshes(root, &known.transforms) {
            scene.add_mesh(container, shown, &mut known, &mut names)?;
        }
        let images = root.image_uris.iter();
        let references = images.filter(|uri| !uri.starts_with("data:"));
        scene.contents.references = references.cloned().collect();
        scene.contents.n_skins = root.skins.len();
        scene.contents.n_animations = root.n_animations;
        scene.contents.objects = Names::list(names.meshes);
        scene.contents.materials = Names::list(names.materials);
        let ignored = extensions::ignored(root).map(str::to_owned);
        let ignored = ignored.map(|name| Finding::ExtensionPassedOver { name });
        scene.findings.extend(ignored);
        Ok(scene)
    }

    fn add_mesh(
        &mut self,
        container: &Container,
        shown: ShownMesh,
        known: &mut Known,
        names: &mut Names,
    ) -> Result<(), Fault> {
        let root = &container.root;
        let first_face = self.soup.faces.len();
        let Some(mesh) = root.meshes.get(shown.mesh) else {
            return Err(missing("mesh", shown.mesh));
        };
        for primitive in &mesh.primitives {
            let first = self.soup.faces.len();
            self.add_primitive(container, primitive, shown, known)?;
            let material = primitive.material;
            if let Some((row, name)) = material.and_then(|m| Some((m, root.materials.get(m)?))) {
                let name = || (or_row(name.as_ref(), "material", row), Vec::new());
                let faces = first..self.soup.faces.len();
                names
                    .materials
                    .entry(row)
                    .or_insert_with(name)
                    .1
                    .push(faces);
            }
        }
        let targets = mesh.primitives.iter().map(|p| p.targets.len());
        self.contents.n_morph_targets += targets.max().unwrap_or(0);
        let name = or_row(mesh.name.as_ref(), "mesh", shown.mesh);
        self.note_unfollowed(container, mesh, shown, &name);
        let faces = first_face..self.soup.faces.len();
        let named = names.meshes.entry(shown.mesh);
        named.or_insert((name, Vec::new())).1.push(faces);
        Ok(())
    }

    /// Morph targets in effect at rest are not applied.
    fn note_unfollowed(
        &mut self,
        container: &Container,
        mesh: &Mesh,
        shown: ShownMesh,
        name: &str,
    ) {
        let node = shown.node.and_then(|node| container.root.nodes.get(node));
        let of_node = node.and_then(|node| node.has_weights);
        let has_targets = mesh.primitives.iter().any(|p| !p.targets.is_empty());
        if has_targets && of_node.unwrap_or(mesh.has_weights) {
            let mesh = name.to_owned();
            self.findings.push(Finding::MorphsNotApplied { mesh });
        }
    }

    fn add_primitive(
        &mut self,
        container: &Container,
        primitive: &Primitive,
        shown: ShownMesh,
        known: &mut Known,
    ) -> Result<(), Fault> {
        let attribute = |name| primitive.attributes.get(name).copied();
        let Some(accessor) = attribute("POSITION") else {
            return Ok(());
        };
        let (positions, layout) = known.layouts.of(container, accessor)?;
        let key = (
            shown.node,
            layout,
            influences(container, primitive, &mut known.layouts)?,
        );
        let found = known.blocks.get(&key).copied();
        let block = match found {
            Some(block) => block,
            None => {
                let frame = self.frame(container, primitive, shown, known)?;
                self.add_block(container, positions, frame)?
            }
        };
        known.blocks.insert(key, block);
        let n_rows = self.blocks[block].rows.len();
        let mut vector = |name, n| -> Result<Option<Arc<Layout>>, Fault> {
            let layout = attribute(name).map(|a| known.layouts.of(container, a));
            let layout = layout.transpose()?.map(|(layout, _)| layout);
            Ok(layout.filter(|l| l.has_components(n) && l.count == n_rows))
        };
        let (normals, tangents) = (vector("NORMAL", 3)?, vector("TANGENT", 4)?);
        let uvs = vector("TEXCOORD_0", 2)?;
        let colors = vector("COLOR_0", 3)?.or(vector("COLOR_0", 4)?);

        let block = &mut self.blocks[block];
        let rows = block.rows.clone();
        block.accessors.insert(accessor);
        if found.is_none() {
            let count = |is_there: bool| if is_there { rows.len() } else { 0 };
            self.contents.n_uvs += count(attribute("TEXCOORD_0").is_some());
            self.contents.n_colors += count(attribute("COLOR_0").is_some());
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
        block.colors = block.colors.take().or(colors);
        block.displacements.extend(displacements(primitive));
        self.add_faces(container, primitive, rows)
    }

    /// Where a primitive is shown: by its skin where it has one that can be followed, or else by its node.
    fn frame(
        &mut self,
        container: &Container,
        primitive: &Primitive,
        shown: ShownMesh,
        known: &mut Known,
    ) -> Result<Frame, Fault> {
        let root = &container.root;
        let node = shown.node.and_then(|node| root.nodes.get(node));
        if let Some(skin) = node.and_then(|node| node.skin) {
            let skin = root.skins.get(skin).ok_or_else(|| missing("skin", skin))?;
            let (layouts, transforms) = (&mut known.layouts, &known.transforms);
            let frame = Frame::of_skin(skin, primitive, container, layouts, transforms)?;
            if let Some(frame) = frame {
                return Ok(frame);
            }
            let mesh = root.meshes.get(shown.mesh).and_then(|m| m.name.as_ref());
            let mesh = or_row(mesh, "mesh", shown.mesh);
            self.findings.push(Finding::SkinNotApplied { mesh });
        }
        Ok(shown.to_scene.map_or(Frame::Scene, Frame::Node))
    }

    fn add_block(
        &mut self,
        container: &Container,
        positions: Arc<Layout>,
        frame: Frame,
    ) -> Result<usize, Fault> {
        if !positions.has_components(3) {
            return Err(Fault::unsupported(
                "a POSITION of other than three components".to_owned(),
                "export it again",
            ));
        }
        self.check_size(container, positions.count)?;
        let first = self.soup.positions.len();
        for row in 0..positions.count {
            let local = Point3::from(positions.get::<3>(container, row));
            let p = frame
                .matrix(row)
                .map_or(local, |m| m.transform_point(&local));
            for &c in &p.coords {
                let text = || format!("{:?} {:?} {:?}", p.x, p.y, p.z);
                checked_coordinate(c, text).map_err(|problem| Fault {
                    place: Place::Row {
                        element: "vertex".to_owned(),
                        row: first + row,
                    },
                    problem,
                })?;
            }
            self.soup.positions.push(p);
        }
        self.blocks.push(Block {
            accessors: BTreeSet::new(),
            positions,
            normals: None,
            tangents: None,
            uvs: None,
            colors: None,
            displacements: BTreeSet::new(),
            has_others: false,
            frame,
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
        Err(Fault::unsupported(
            feature,
            "save only the mesh that is meant",
        ))
    }

    fn add_faces(
        &mut self,
        container: &Container,
        primitive: &Primitive,
        rows: Range<usize>,
    ) -> Result<(), Fault> {
        let mode = Mode::of(primitive.mode).ok_or_else(|| {
            let feature = format!("a primitive of mode {}", primitive.mode);
            Fault::unsupported(feature, "export it as triangles")
        })?;
        if mode == Mode::PointsOrLines {
            self.contents.n_lines_and_points += 1;
            return Ok(());
        }
        let corners = match primitive.indices {
            Some(accessor) => indices(container, accessor, &rows)?,
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
            Mode::PointsOrLines => {}
        }
        Ok(())
    }
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

/// What the corners of a primitive make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    PointsOrLines,
    Triangles,
    TriangleStrip,
    TriangleFan,
}

impl Mode {
    fn of(code: usize) -> Option<Self> {
        Some(match code {
            0..=3 => Self::PointsOrLines,
            4 => Self::Triangles,
            5 => Self::TriangleStrip,
            6 => Self::TriangleFan,
            _ => return None,
        })
    }
}

/// The name, or `element` and the row where there is none.
fn or_row(name: Option<&String>, element: &str, row: usize) -> String {
    name.cloned().unwrap_or_else(|| format!("{element} {row}"))
}

/// The layouts of a primitive's joints and weights.
fn influences(
    container: &Container,
    primitive: &Primitive,
    layouts: &mut Layouts,
) -> Result<Vec<usize>, Fault> {
    let mut rows = Vec::new();
    for set in 0.. {
        let before = rows.len();
        for name in ["JOINTS", "WEIGHTS"] {
            if let Some(&accessor) = primitive.attributes.get(&format!("{name}_{set}")) {
                rows.push(layouts.of(container, accessor)?.1);
            }
        }
        if rows.len() == before {
            break;
        }
    }
    Ok(rows)
}

fn not_rows(accessor: usize) -> Fault {
    Fault {
        place: Place::Row {
            element: "accessor".to_owned(),
            row: accessor,
        },
        problem: ReadProblem::Unsupported {
            feature: "a list of corners that are no whole numbers".to_owned(),
            advice: "export it with whole-number indices",
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
    if !layout.is_rows() {
        return Err(not_rows(accessor));
    }
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
