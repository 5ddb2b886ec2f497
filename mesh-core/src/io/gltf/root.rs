//! What a glTF document says of meshes, and of where they stand.

use std::collections::HashMap;

use super::json::{document, Object};
use crate::io::error::ReadProblem;
use crate::io::fault::Fault;

/// The parts of a document that decide what its meshes look like.
#[derive(Debug)]
pub(super) struct Root {
    pub(super) accessors: Vec<Accessor>,
    pub(super) views: Vec<View>,
    /// Where each buffer is; none in the file itself.
    pub(super) buffer_uris: Vec<Option<String>>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) nodes: Vec<Node>,
    /// The nodes at the top of the scene that is shown; none where the document has no scene.
    pub(super) scene: Option<Vec<usize>>,
    /// The names of the materials.
    pub(super) materials: Vec<Option<String>>,
    pub(super) image_uris: Vec<String>,
    pub(super) skins: Vec<Skin>,
    pub(super) n_animations: usize,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
}

/// The type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// Bytes of one number.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// Numbers of one type, so many to an element.
#[derive(Debug)]
pub(super) struct Accessor {
    pub(super) component: Component,
    pub(super) n_components: usize,
    pub(super) is_normalized: bool,
    pub(super) count: usize,
    /// The view and the first byte in it; none where all are zero.
    pub(super) dense: Option<Part>,
    pub(super) sparse: Option<Sparse>,
}

/// A place in a view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) view: usize,
    pub(super) offset: usize,
}

/// Elements that stand elsewhere.
#[derive(Debug)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: Part,
    pub(super) index: Component,
    pub(super) values: Part,
}

/// A stretch of a buffer.
#[derive(Debug)]
pub(super) struct View {
    pub(super) buffer: usize,
    pub(super) offset: usize,
    pub(super) length: usize,
    pub(super) stride: Option<usize>,
}

/// Primitives under one name.
#[derive(Debug)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
    /// Whether a morph target is in effect at rest.
    pub(super) has_weights: bool,
}

/// Faces over the vertices of some accessors.
#[derive(Debug)]
pub(super) struct Primitive {
    /// The accessor of each attribute.
    pub(super) attributes: HashMap<String, usize>,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    pub(super) mode: usize,
    /// The same of each morph target.
    pub(super) targets: Vec<HashMap<String, usize>>,
}

/// A place in the scene.
#[derive(Debug)]
pub(super) struct Node {
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) children: Vec<usize>,
    pub(super) matrix: Option<[f32; 16]>,
    pub(super) translation: Option<[f32; 3]>,
    pub(super) rotation: Option<[f32; 4]>,
    pub(super) scale: Option<[f32; 3]>,
    /// Whether a morph target is in effect at rest.
    pub(super) has_weights: Option<bool>,
}

/// Joints that move a mesh.
#[derive(Debug)]
pub(super) struct Skin {
    /// Their nodes.
    pub(super) joints: Vec<usize>,
    /// The accessor of the maps from the mesh's frame to the joints'; none where these are the same.
    pub(super) inverse_bind_matrices: Option<usize>,
}

impl Root {
    /// Reads the text of a document.
    pub(super) fn read(json: &[u8]) -> Result<Self, Fault> {
        let root = document(json)?;
        check_version(&root)?;
        let uri = |object: &Object<'_>| object.text("uri");
        let images = each(&root, "images", "image", uri)?;
        Ok(Self {
            accessors: each(&root, "accessors", "accessor", accessor)?,
            views: each(&root, "bufferViews", "buffer view", view)?,
            buffer_uris: each(&root, "buffers", "buffer", uri)?,
            meshes: each(&root, "meshes", "mesh", mesh)?,
            nodes: each(&root, "nodes", "node", node)?,
            scene: scene(&root)?,
            materials: each(&root, "materials", "material", |object| object.text("name"))?,
            image_uris: images.into_iter().flatten().collect(),
            skins: each(&root, "skins", "skin", skin)?,
            n_animations: root.objects("animations", None)?.len(),
            extensions_used: root.texts("extensionsUsed")?,
            extensions_required: root.texts("extensionsRequired")?,
        })
    }
}

fn each<T>(
    root: &Object<'_>,
    key: &str,
    element: &str,
    read: fn(&Object<'_>) -> Result<T, Fault>,
) -> Result<Vec<T>, Fault> {
    root.objects(key, Some(element))?.iter().map(read).collect()
}

/// Documents of version 1 have other contents under the same names.
fn check_version(root: &Object<'_>) -> Result<(), Fault> {
    let Some(asset) = root.object("asset")? else {
        return Ok(());
    };
    let least = asset.text("minVersion")?.filter(|v| v != "2.0");
    let version = asset.text("version")?.filter(|v| !v.starts_with('2'));
    match least.or(version) {
        None => Ok(()),
        Some(version) => Err(Fault::whole(ReadProblem::Unsupported {
            feature: format!("glTF version {version}"),
            advice: "save it as glTF 2.0",
        })),
    }
}

fn required<T>(object: &Object<'_>, key: &'static str, found: Option<T>) -> Result<T, Fault> {
    found.ok_or_else(|| object.unexpected(key, "nothing"))
}

fn component(object: &Object<'_>) -> Result<Component, Fault> {
    let expected = "a component type between 5120 and 5126";
    let code = required(object, expected, object.count("componentType")?)?;
    Ok(match code {
        5120 => Component::I8,
        5121 => Component::U8,
        5122 => Component::I16,
        5123 => Component::U16,
        5125 => Component::U32,
        5126 => Component::F32,
        _ => return Err(object.unexpected(expected, &code.to_string())),
    })
}

fn part(object: &Object<'_>) -> Result<Option<Part>, Fault> {
    let offset = object.count("byteOffset")?.unwrap_or(0);
    let view = object.count("bufferView")?;
    Ok(view.map(|view| Part { view, offset }))
}

fn accessor(object: &Object<'_>) -> Result<Accessor, Fault> {
    let expected = "a type like SCALAR or VEC3";
    let kind = required(object, expected, object.text("type")?)?;
    let n_components = match kind.as_str() {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return Err(object.unexpected(expected, &kind)),
    };
    let sparse = object.object("sparse")?;
    Ok(Accessor {
        component: component(object)?,
        n_components,
        is_normalized: object.flag("normalized")?,
        count: required(object, "a count", object.count("count")?)?,
        dense: part(object)?,
        sparse: sparse.as_ref().map(self::sparse).transpose()?,
    })
}

fn sparse(object: &Object<'_>) -> Result<Sparse, Fault> {
    let inner = |key: &'static str| required(object, key, object.object(key)?);
    let (indices, values) = (inner("indices")?, inner("values")?);
    let expected = "a buffer view";
    Ok(Sparse {
        count: required(object, "a count", object.count("count")?)?,
        index: component(&indices)?,
        indices: required(&indices, expected, part(&indices)?)?,
        values: required(&values, expected, part(&values)?)?,
    })
}

fn view(object: &Object<'_>) -> Result<View, Fault> {
    Ok(View {
        buffer: required(object, "a buffer", object.count("buffer")?)?,
        offset: object.count("byteOffset")?.unwrap_or(0),
        length: required(object, "a byte length", object.count("byteLength")?)?,
        stride: object.count("byteStride")?,
    })
}

fn mesh(object: &Object<'_>) -> Result<Mesh, Fault> {
    let primitives = object.objects("primitives", None)?;
    Ok(Mesh {
        name: object.text("name")?,
        primitives: primitives.iter().map(primitive).collect::<Result<_, _>>()?,
        has_weights: has_weights(object)?.unwrap_or(false),
    })
}

/// Whether any weight is other than zero; none where there are no weights.
fn has_weights(object: &Object<'_>) -> Result<Option<bool>, Fault> {
    let weights = object.texts("weights")?;
    let is_active = |weight: &String| weight.parse() != Ok(0.0);
    Ok((!weights.is_empty()).then(|| weights.iter().any(is_active)))
}

fn primitive(object: &Object<'_>) -> Result<Primitive, Fault> {
    let attributes = object.object("attributes")?;
    let attributes = attributes.map(|a| a.counts_by_key()).transpose()?;
    let targets = object.objects("targets", None)?;
    let targets = targets.iter().map(Object::counts_by_key);
    Ok(Primitive {
        attributes: attributes.unwrap_or_default(),
        indices: object.count("indices")?,
        material: object.count("material")?,
        mode: object.count("mode")?.unwrap_or(4),
        targets: targets.collect::<Result<_, _>>()?,
    })
}

fn node(object: &Object<'_>) -> Result<Node, Fault> {
    Ok(Node {
        mesh: object.count("mesh")?,
        skin: object.count("skin")?,
        children: object.counts("children")?,
        matrix: object.numbers("matrix")?,
        translation: object.numbers("translation")?,
        rotation: object.numbers("rotation")?,
        scale: object.numbers("scale")?,
        has_weights: has_weights(object)?,
    })
}

fn skin(object: &Object<'_>) -> Result<Skin, Fault> {
    Ok(Skin {
        joints: object.counts("joints")?,
        inverse_bind_matrices: object.count("inverseBindMatrices")?,
    })
}

fn scene(root: &Object<'_>) -> Result<Option<Vec<usize>>, Fault> {
    let shown = root.count("scene")?.unwrap_or(0);
    let scenes = root.objects("scenes", Some("scene"))?;
    scenes
        .get(shown)
        .map(|scene| scene.counts("nodes"))
        .transpose()
}
