"""Landmarks as empties: NAME.source on the source, NAME.target on the target, both in one collection.

An empty that stands for a vertex keeps its row; one that was moved by hand since, or set by hand, counts where it is. Empties
are children of their object and follow it. The weight of a pair is a property of the empty on the source.
"""

import json

import bpy
from mathutils import Vector

COLLECTION = "Drape marks"
SIZE = 0.02
#: Shares of an object's longest side within which a mark is still at its vertex.
AT_VERTEX = 1e-5


def collection(settings) -> bpy.types.Collection:
    """The collection of the marks; made where there is none."""
    if settings.marks is None:
        settings.marks = bpy.data.collections.new(COLLECTION)
        bpy.context.scene.collection.children.link(settings.marks)
    return settings.marks


def put(settings, name: str, side: str, local: Vector, vertex: "int | None" = None) -> bpy.types.Object:
    """Marks a place of the source or the target, in the coordinates of its object."""
    thing = settings.source if side == "source" else settings.target
    label = f"{name}.{side}"
    empty = find(settings, name, side) or bpy.data.objects.new(label, None)
    empty.empty_display_type = "SPHERE"
    empty.empty_display_size = SIZE * max(thing.dimensions)
    empty.parent = thing
    empty.location = local
    empty["side"], empty["mark"] = side, name
    if vertex is None:
        empty.pop("vertex", None)
    else:
        empty["vertex"] = vertex
    marks = collection(settings)
    if empty.name not in marks.objects:
        marks.objects.link(empty)
    return empty


def find(settings, name: str, side: str) -> "bpy.types.Object | None":
    """The empty that marks a place."""
    if settings.marks is None:
        return None
    for empty in settings.marks.objects:
        if label(empty) == (name, side):
            return empty
    return None


def label(empty) -> "tuple[str, str] | None":
    """Name and side of an empty: as it was made, or as it is called."""
    if "mark" in empty and "side" in empty:
        return empty["mark"], empty["side"]
    name, dot, side = empty.name.partition(".")
    side = side.split(".")[0]
    return (name, side) if dot and side in ("source", "target") else None


def place(thing, empty) -> dict:
    """Where an empty is, as a landmark file has it: a vertex, or a point of the world."""
    bpy.context.view_layer.update()
    row = empty.get("vertex")
    if row is not None and row < len(thing.data.vertices):
        at = thing.data.vertices[row].co
        here = thing.matrix_world.inverted() @ empty.matrix_world.translation
        if (here - at).length <= AT_VERTEX * max(thing.dimensions):
            return {"vertex": row}
    return {"point": list(empty.matrix_world.translation)}


def entries(settings) -> "list[dict]":
    """All pairs that are complete, as a landmark file has them, by their names."""
    sides: dict = {}
    for empty in settings.marks.objects if settings.marks else ():
        if (known := label(empty)) is not None:
            sides.setdefault(known[0], {})[known[1]] = empty
    return [
        {
            "name": name,
            "source": place(settings.source, pair["source"]),
            "target": place(settings.target, pair["target"]),
            **weight(pair["source"]),
        }
        for name, pair in sorted(sides.items())
        if len(pair) == 2
    ]


def weight(empty) -> dict:
    """What a pair counts, as a landmark file has it: nothing where that is 1."""
    known = empty.get("weight", 1.0)
    return {} if known == 1.0 else {"weight": known}


def put_entries(settings, found: "list[dict]") -> int:
    """Marks the places of a landmark file that was read for source and target; how many curves it had, which are passed over."""
    points = [entry for entry in found if "curve" not in entry]
    for k, entry in enumerate(points):
        name = entry.get("name") or f"mark {k}"
        for side, thing in (("source", settings.source), ("target", settings.target)):
            at = entry[side]
            row = at.get("vertex")
            empty = put(settings, name, side, _local(thing, at), row)
            if side == "source":
                empty["weight"] = float(entry.get("weight", 1.0))
    return len(found) - len(points)


def _local(thing, at: dict) -> Vector:
    """A place of a landmark file in the coordinates of an object."""
    mesh = thing.data
    if "vertex" in at:
        return mesh.vertices[at["vertex"]].co
    if "face" in at:
        corners = mesh.polygons[at["face"]].vertices
        weighted = (mesh.vertices[v].co * w for v, w in zip(corners, at["barycentric"]))
        return sum(weighted, Vector((0, 0, 0)))
    return thing.matrix_world.inverted() @ Vector(at["point"])


def next_name(settings) -> str:
    """A name that no mark has; that of a mark whose other half lacks comes first."""
    known: dict = {}
    for empty in settings.marks.objects if settings.marks else ():
        if (mark := label(empty)) is not None:
            known.setdefault(mark[0], set()).add(mark[1])
    half = [name for name, sides in known.items() if len(sides) == 1]
    number = 1
    while f"mark {number}" in known:
        number += 1
    return half[0] if half else f"mark {number}"


def to_json(settings) -> str:
    """All marks as a landmark file."""
    return json.dumps({"landmarks": entries(settings)}, indent=2)
