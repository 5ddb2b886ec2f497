"""Mesh draping in Blender: the source object's mesh in the shape of the target object."""

from . import operators, panel, properties, wait

MODULES = (properties, operators, wait, panel)


def register() -> None:
    for module in MODULES:
        module.register()


def unregister() -> None:
    for module in reversed(MODULES):
        module.unregister()
