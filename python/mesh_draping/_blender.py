"""Meshes of Blender as arrays, by its own bulk access."""

from __future__ import annotations

from typing import Any, Tuple

from ._numpy import Array, np


def arrays(mesh: Any) -> "Tuple[Array, Array, Array]":
    """Vertices (n, 3), corners of all polygons and how many each has, of a mesh or a mesh object.

    Those of an object are in the world's units and axes; shape keys and modifiers are not applied.
    """
    data = getattr(mesh, "data", mesh)
    vertices = positions(data)
    corners = np.empty(len(data.loops), dtype=np.int32)
    data.loops.foreach_get("vertex_index", corners)
    counts = np.empty(len(data.polygons), dtype=np.int32)
    data.polygons.foreach_get("loop_total", counts)
    matrix = world(mesh)
    if matrix is not None:
        vertices = moved(matrix, vertices)
    return vertices, corners.astype(np.int64), counts.astype(np.int64)


def positions(data: Any) -> Array:
    """Where the vertices of a mesh are: float64 of shape (n, 3); Blender keeps them in single precision."""
    flat = np.empty(3 * len(data.vertices), dtype=np.float32)
    data.vertices.foreach_get("co", flat)
    return flat.astype(np.float64).reshape(-1, 3)


def world(mesh: Any) -> "Array | None":
    """Where an object stands in the world, as a matrix of shape (4, 4); none where it stands at the origin as it is."""
    matrix = getattr(mesh, "matrix_world", None)
    if matrix is None:
        return None
    numbers = np.array([list(row) for row in matrix], dtype=np.float64)
    return None if (numbers == np.eye(4)).all() else numbers


def moved(matrix: Array, vertices: Array) -> Array:
    """Points through a matrix of shape (4, 4)."""
    return vertices @ matrix[:3, :3].T + matrix[:3, 3]
