"""What the panel asks for, kept in the scene."""

import bpy
from bpy.props import CollectionProperty, EnumProperty, IntProperty, PointerProperty, StringProperty

PRESETS = [
    ("standard", "Standard", "The method, from coarse to fine"),
    ("quick", "Quick", "A fifth of it, to look at before the real run"),
    ("network", "Network", "The paper's network under the same losses"),
]
OVERLAPS = [
    ("auto", "Found out", "What lies beyond the other shape is found and left out"),
    ("full", "Both whole", "Both shapes are whole"),
    ("source-partial", "Source is a part", "The source covers only a part of the target"),
    ("target-partial", "Target is a part", "The target covers only a part of the source"),
    ("both", "Both are parts", "Each has parts that the other lacks"),
]
RESULTS = [
    ("object", "New object", "A copy of the source with everything on it, in the target's shape"),
    ("shape_key", "Shape key", "A shape key of the source"),
]
TREATMENTS = [
    ("free", "Free", "Attracts nothing and is carried along, as the lining of a mouth"),
    ("rigid", "Rigid", "Its pieces move as one body each, as eyes and teeth"),
]


def is_mesh(_owner, thing) -> bool:
    return thing.type == "MESH"


class DRAPE_Part(bpy.types.PropertyGroup):
    """A vertex group of the source that is treated in its own way."""

    group: StringProperty(name="Vertex group")
    treatment: EnumProperty(name="Treatment", items=TREATMENTS)


class DRAPE_Settings(bpy.types.PropertyGroup):
    """What is draped over what, and how."""

    source: PointerProperty(name="Source", type=bpy.types.Object, poll=is_mesh, description="The mesh to deform")
    target: PointerProperty(name="Target", type=bpy.types.Object, poll=is_mesh, description="The shape to drape it over")
    marks: PointerProperty(
        name="Marks", type=bpy.types.Collection, description="Empties named NAME.source and NAME.target"
    )
    preset: EnumProperty(name="Preset", items=PRESETS)
    overlap: EnumProperty(name="Overlap", items=OVERLAPS)
    result: EnumProperty(name="Result", items=RESULTS)
    seed: IntProperty(name="Seed", min=0, description="Same seed, same result")
    parts: CollectionProperty(type=DRAPE_Part)
    told: StringProperty(description="What the last drape came to")


CLASSES = (DRAPE_Part, DRAPE_Settings)


def register() -> None:
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.mesh_draping = PointerProperty(type=DRAPE_Settings)


def unregister() -> None:
    del bpy.types.Scene.mesh_draping
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
