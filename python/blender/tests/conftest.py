"""An empty Blender with the add-on, and a pair of creatures with everything that Blender can hang on a mesh."""

import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

import mesh_draping as md

sys.path.insert(0, str(Path(__file__).parents[1]))
import mesh_draping_addon  # noqa: E402

SHORT = {"stages": [{"n_iterations": 12}], "initial": "standard"}


@pytest.fixture(autouse=True)
def scene():
    """An empty scene with the add-on switched on."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh_draping_addon.register()
    yield bpy.context.scene
    mesh_draping_addon.unregister()


@pytest.fixture(autouse=True)
def soon_done(monkeypatch):
    """Drapes of a few steps: what is tested here is the way in and out."""
    whole = md.Drape
    monkeypatch.setattr(md, "Drape", lambda **given: whole(**given, **SHORT))


@pytest.fixture
def pair():
    """A head to be draped over another."""
    return md.bench.pair("head", seed=1, landmarks=10)


def mesh_object(name, vertices, faces):
    """An object of vertices and faces."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], [list(map(int, face)) for face in faces])
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


@pytest.fixture
def rigged(scene, pair):
    """Source and target as objects, and a scene that says what is to be draped."""
    settings = scene.mesh_draping
    settings.source = dressed(mesh_object("head", *pair.source))
    settings.target = mesh_object("scan", *pair.target)
    settings.preset = "quick"
    from mesh_draping_addon import marks

    marks.put_entries(settings, pair.landmarks)
    return settings


def dressed(thing):
    """An object with UVs, groups, materials, modifiers, shape keys, creases, colours and properties."""
    mesh, rng = thing.data, np.random.default_rng(0)
    n, n_loops = len(mesh.vertices), len(mesh.loops)
    for name in ("UVMap", "second"):
        layer = mesh.uv_layers.new(name=name)
        layer.data.foreach_set("uv", rng.random(2 * n_loops, dtype=np.float32))
    colours = mesh.color_attributes.new("paint", "BYTE_COLOR", "CORNER")
    colours.data.foreach_set("color", rng.random(4 * n_loops, dtype=np.float32))
    crease = mesh.attributes.new("crease_edge", "FLOAT", "EDGE")
    crease.data.foreach_set("value", rng.random(len(mesh.edges), dtype=np.float32))
    for name in ("skin", "eyes"):
        mesh.materials.append(bpy.data.materials.new(name))
    mesh.polygons.foreach_set("material_index", rng.integers(0, 2, len(mesh.polygons)).astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))
    for name in ("jaw", "top"):
        group = thing.vertex_groups.new(name=name)
        for row in range(0, n, 7):
            group.add([row], float(rng.random()), "REPLACE")
    modifier = thing.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 3
    thing.modifiers.new("Mirror", "MIRROR").use_axis[1] = True
    thing["note"], mesh["author"] = "by hand", "nobody"
    return with_keys(thing)


def with_keys(thing):
    """Adds a shape key that opens a mouth, so to speak."""
    thing.shape_key_add(name="Basis", from_mix=False)
    key = thing.shape_key_add(name="smile", from_mix=False)
    key.value, key.slider_max = 0.25, 2.0
    for row in range(40):
        key.data[row].co.z += 0.05
    return thing


@pytest.fixture
def snapshot():
    """What hangs on an object, property by property, as values that can be compared."""
    return _snapshot


def _snapshot(thing):
    mesh = thing.data
    return {
        "vertices": values(mesh.vertices, "co", 3),
        "corners": values(mesh.loops, "vertex_index", 1, np.int32),
        "edges": values(mesh.edges, "vertices", 2, np.int32),
        "faces": values(mesh.polygons, "loop_total", 1, np.int32),
        "material of each face": values(mesh.polygons, "material_index", 1, np.int32),
        "smooth": values(mesh.polygons, "use_smooth", 1, bool),
        "materials": [m.name for m in mesh.materials],
        "slots": [(slot.name, slot.link) for slot in thing.material_slots],
        "uvs": {layer.name: values(layer.data, "uv", 2) for layer in mesh.uv_layers},
        "active uv": mesh.uv_layers.active.name,
        "attributes": {a.name: attribute(a) for a in mesh.attributes if a.name != "position"},
        "groups": [(g.name, g.index, g.lock_weight) for g in thing.vertex_groups],
        "weights": [[(g.group, g.weight) for g in v.groups] for v in mesh.vertices],
        "modifiers": [(m.name, m.type, properties(m)) for m in thing.modifiers],
        "keys": keys(mesh),
        "matrix": [tuple(row) for row in thing.matrix_basis],
        "properties": {name: thing[name] for name in thing.keys()},
        "properties of the mesh": {name: mesh[name] for name in mesh.keys()},
        "collections": sorted(c.name for c in thing.users_collection),
    }


def values(items, name, width, kind=np.float32):
    numbers = np.empty(width * len(items), dtype=kind)
    items.foreach_get(name, numbers)
    return numbers.tolist()


def attribute(a):
    kinds = {"FLOAT": "value", "INT": "value", "BOOLEAN": "value", "BYTE_COLOR": "color", "FLOAT_COLOR": "color"}
    kinds |= {"FLOAT_VECTOR": "vector", "FLOAT2": "vector", "INT32_2D": "value", "INT8": "value"}
    read = (getattr(item, kinds[a.data_type]) for item in a.data)
    return a.data_type, a.domain, [tuple(v) if hasattr(v, "__len__") else v for v in read]


def properties(modifier):
    plain = (p for p in modifier.bl_rna.properties if p.type in {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"})
    read = {p.identifier: getattr(modifier, p.identifier) for p in plain if p.identifier != "execution_time"}
    return {name: tuple(v) if hasattr(v, "__len__") and not isinstance(v, (str, set)) else v for name, v in read.items()}


def keys(mesh):
    if mesh.shape_keys is None:
        return None
    told = ("name", "value", "slider_min", "slider_max", "mute", "vertex_group", "interpolation")
    blocks = mesh.shape_keys.key_blocks
    return [({name: getattr(key, name) for name in told}, values(key.data, "co", 3)) for key in blocks]
