"""From objects to a drape, and from its result to an object or a shape key."""

import bpy
import mesh_draping as md
import numpy as np
from mesh_draping._blender import moved, world

from . import marks

#: Distance, in longest sides of the target's box, that is the top of the heat map.
HEAT_AT_TOP = 0.02
HEAT = "Drape distance"
SHAPE_KEY = "Draped"


def inputs(settings) -> dict:
    """What `mesh_draping.Drape` takes, out of the scene; raises `mesh_draping.Error` where something lacks."""
    if settings.source is None or settings.target is None:
        raise md.Error("choose a source and a target")
    if settings.source == settings.target:
        raise md.Error("source and target are the same object")
    parts = {part.group: vertices_of(settings.source, part.group) for part in settings.parts}
    named = {kind: [p.group for p in settings.parts if p.treatment == kind] for kind in ("free", "rigid")}
    return {
        "source": md.Source(settings.source, parts=parts),
        "target": target(settings.target),
        "landmarks": marks.entries(settings),
        "preset": settings.preset,
        "seed": settings.seed,
        "overlap": settings.overlap,
        **named,
    }


def target(thing) -> md.Target:
    """An object as a target; without faces its vertices are a cloud."""
    return md.Target(thing)


def vertices_of(thing, group: str) -> "list[int]":
    """The vertices that have more than half a weight in a vertex group."""
    found = thing.vertex_groups.get(group)
    if found is None:
        raise md.Error(f"{thing.name} has no vertex group '{group}'")
    index = found.index
    weighted = ((v.index, g.weight) for v in thing.data.vertices for g in v.groups if g.group == index)
    return [row for row, weight in weighted if weight > 0.5]


def put_result(settings, result: md.Result) -> bpy.types.Object:
    """The result as the scene asks for it: a new object, or a shape key of the source."""
    source = settings.source
    vertices = local(source, result.vertices)
    if settings.result == "shape_key":
        put_shape_key(source, vertices)
        put_heat(source.data, result.distances)
        return source
    draped = copied(source)
    put_vertices(draped.data, vertices, result, source)
    put_heat(draped.data, result.distances)
    return draped


def local(thing, vertices: np.ndarray) -> np.ndarray:
    """Points of the world in the coordinates of an object."""
    matrix = world(thing)
    return vertices if matrix is None else moved(np.linalg.inv(matrix), vertices)


def copied(source) -> bpy.types.Object:
    """The object with a mesh of its own: UVs, weights, materials, modifiers and shape keys as they are."""
    copy = source.copy()
    copy.data = source.data.copy()
    copy.name = f"{source.name} draped"
    for owner in source.users_collection or (bpy.context.scene.collection,):
        owner.objects.link(copy)
    return copy


def put_vertices(mesh, vertices: np.ndarray, result: md.Result, source) -> None:
    """Moves the vertices of a mesh; its shape keys go along."""
    if mesh.shape_keys:
        put_keys(mesh.shape_keys.key_blocks, vertices, result, source)
    mesh.vertices.foreach_set("co", flat(vertices))
    mesh.update()


def put_keys(keys, vertices: np.ndarray, result: md.Result, source) -> None:
    """The first key is the result; the others are moved as the map moves directions around each vertex."""
    basis = coordinates(keys[0], len(vertices))
    for key in keys:
        offsets = coordinates(key, len(vertices)) - basis
        key.data.foreach_set("co", flat(vertices + carried(offsets, result, source)))


def carried(offsets: np.ndarray, result: md.Result, source) -> np.ndarray:
    """Displacements of the source, in its coordinates before and after."""
    if not offsets.any():
        return offsets
    matrix = world(source)
    if matrix is None:
        return result.carry(offsets)
    there = result.carry(offsets @ matrix[:3, :3].T)
    return there @ np.linalg.inv(matrix)[:3, :3].T


def coordinates(key, n: int) -> np.ndarray:
    """Where a shape key has the vertices."""
    numbers = np.empty(3 * n, dtype=np.float32)
    key.data.foreach_get("co", numbers)
    return numbers.astype(np.float64).reshape(-1, 3)


def put_shape_key(source, vertices: np.ndarray) -> None:
    """Adds the result as a shape key, or moves the one that is there; the source itself stays as it is."""
    if source.data.shape_keys is None:
        source.shape_key_add(name="Basis", from_mix=False)
    keys = source.data.shape_keys.key_blocks
    key = keys.get(SHAPE_KEY) or source.shape_key_add(name=SHAPE_KEY, from_mix=False)
    key.data.foreach_set("co", flat(vertices))
    key.value = 1.0
    source.data.update()


def put_heat(mesh, distances: np.ndarray) -> None:
    """The distance to the target as a colour attribute: blue on it, red from a fiftieth of its longest side on."""
    heat = mesh.color_attributes.get(HEAT) or mesh.color_attributes.new(HEAT, "FLOAT_COLOR", "POINT")
    share = np.clip(distances / HEAT_AT_TOP, 0.0, 1.0)
    colours = np.stack([share, 1.0 - np.abs(2.0 * share - 1.0), 1.0 - share, np.ones_like(share)], axis=1)
    heat.data.foreach_set("color", flat(colours))


def flat(rows: np.ndarray) -> np.ndarray:
    """Rows in single precision, as Blender keeps them, one after the other."""
    return np.ascontiguousarray(rows, dtype=np.float32).reshape(-1)


def told(result: md.Result) -> str:
    """What a drape came to, in a line."""
    figures = result.figures
    return f"Q {figures['q_transfer']:.3f}, {int(figures['folds'])} new folds, farthest {100 * figures['hausdorff']:.1f} %"
