//! Extensions of glTF: which a reader of shapes must understand.

use super::root::Root;
use crate::io::fault::Fault;
use crate::io::printable::printable;

/// Compressed data would not be seen, or would be left behind when the mesh moves.
const COMPRESSED: [&str; 3] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

/// Beginnings of the names of extensions that change nothing about shapes or are read: looks, textures, lights,
/// animation, facts about the file; whole-number coordinates are read as any others.
const HARMLESS: [&str; 16] = [
    "KHR_materials_",
    "EXT_materials_",
    "MSFT_packing_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_dds",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_techniques_webgl",
    "KHR_animation_pointer",
    "KHR_xmp",
    "KHR_mesh_quantization",
    "EXT_mesh_features",
    "EXT_instance_features",
    "EXT_structural_metadata",
    "VRM",
];

/// Extensions that change where or how often a mesh is shown.
const SHOWN_OTHERWISE: [&str; 3] = ["EXT_mesh_gpu_instancing", "KHR_node_visibility", "MSFT_lod"];

/// Refuses what would be read wrong: compressed data, and any extension that the file requires and that is not
/// understood here.
pub(super) fn check_extensions(root: &Root) -> Result<(), Fault> {
    let named = root.extensions_required.iter().chain(&root.extensions_used);
    for name in named {
        if COMPRESSED.contains(&name.as_str()) {
            let feature = format!("a glTF compressed with {name}");
            return Err(Fault::unsupported(
                feature,
                "save it without mesh compression",
            ));
        }
    }
    let is_harmless = |name: &&String| HARMLESS.iter().any(|known| name.starts_with(known));
    match root
        .extensions_required
        .iter()
        .find(|name| !is_harmless(name))
    {
        None => Ok(()),
        Some(name) => Err(Fault::unsupported(
            format!("a glTF that requires the extension {}", printable(name)),
            "export it without",
        )),
    }
}

/// The extensions in use that would show other shapes than those that are read.
pub(super) fn ignored(root: &Root) -> impl Iterator<Item = &str> {
    let used = root.extensions_used.iter().map(String::as_str);
    used.filter(|name| SHOWN_OTHERWISE.contains(name))
}
