"""Meshes and clouds out of whatever a caller has."""

from __future__ import annotations

import os
from typing import Any, Iterable, Mapping, Sequence, Tuple, Union

from . import _native
from ._numpy import Array, np

Path = Union[str, "os.PathLike[str]"]
Faces = Union[Array, Sequence[Sequence[int]]]
Polygons = Tuple[Array, Array]
#: Faces as they come out: an array where all have as many corners.
Gathered = Union[Array, "list[Array]"]


class Source:
    """The mesh to deform: read once, draped as often as you like.

    ``mesh``: a path, ``trimesh.Trimesh``, a mesh or mesh object of Blender, or ``(vertices, faces)``.
    ``weld``: vertices no farther apart than this, in its units, move as one: 0 for equal places only, ``"off"`` for none.
    ``morphs``: what becomes of the morph targets of a glTF file when it is written: "keep", "carry" or "drop".
    ``parts``: named parts for ``free=`` and ``rigid=``, each a list of rows of vertices.
    """

    def __init__(
        self,
        mesh: Any,
        *,
        weld: Union[float, str] = 0,
        morphs: str = "keep",
        parts: Mapping[str, Iterable[int]] = {},
    ) -> None:
        if _is_path(mesh):
            native = _native.Source.read(mesh, str(weld), morphs)
        else:
            vertices, faces, _ = _arrays(mesh)
            if faces is None:
                raise _native.Error("a source needs faces: give (vertices, faces)")
            native = _native.Source.of_polygons(rows(vertices), *polygons(faces), str(weld))
        for name, vertices in parts.items():
            native = native.with_part(name, np.asarray(list(vertices), dtype=np.int64))
        self._native = native

    @property
    def vertices(self) -> Array:
        """Where the vertices are at rest: float64 of shape (n, 3), in the order of the file or array."""
        return self._native.vertices

    @property
    def faces(self) -> Gathered:
        """The faces: int64 of shape (m, k) where all have k corners, else a list of arrays."""
        return gathered(*self._native.polygons)

    def write(self, path: Path, vertices: Array) -> None:
        """Writes the source's file with its vertices elsewhere; in its own format nothing else changes."""
        self._native.write(path, rows(vertices))

    def __len__(self) -> int:
        return self._native.n_vertices

    def __repr__(self) -> str:
        return f"Source({len(self)} vertices)"


class Target:
    """The shape to drape over: a mesh with any defect, or a cloud.

    ``mesh``: as for :class:`Source`; also points of shape (n, 3), or ``(points, None, normals)``.
    """

    def __init__(self, mesh: Any) -> None:
        if _is_path(mesh):
            self._native = _native.Target.read(mesh)
            return
        vertices, faces, normals = _arrays(mesh)
        if faces is None or len(faces) == 0:
            normals = None if normals is None else rows(normals)
            self._native = _native.Target.of_points(rows(vertices), normals)
        else:
            self._native = _native.Target.of_polygons(rows(vertices), *polygons(faces))

    @property
    def vertices(self) -> Array:
        """The vertices or points: float64 of shape (n, 3)."""
        return self._native.vertices

    @property
    def notes(self) -> "list[str]":
        """What was left out as no part of the shape, in words."""
        return self._native.notes

    def __repr__(self) -> str:
        return f"Target({len(self.vertices)} vertices)"


def as_source(mesh: Any) -> Source:
    """The mesh as a source."""
    return mesh if isinstance(mesh, Source) else Source(mesh)


def as_target(mesh: Any) -> Target:
    """The mesh as a target."""
    return mesh if isinstance(mesh, Target) else Target(mesh)


def rows(array: Any) -> Array:
    """An array of rows of float64; the array itself where it is one already."""
    try:
        numbers = np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise _native.Error(f"points must be an array of shape (n, 3): {error}") from None
    if numbers.ndim != 2 or numbers.shape[1] != 3:
        raise _native.Error(f"points must be an array of shape (n, 3), not {numbers.shape}")
    return numbers


def polygons(faces: Faces) -> Polygons:
    """Faces as corners, one face after the other, and how many corners each has."""
    if isinstance(faces, np.ndarray) and faces.ndim == 2:
        check_whole(faces)
        corners = np.ascontiguousarray(faces, dtype=np.int64).reshape(-1)
        return corners, np.full(len(faces), faces.shape[1], dtype=np.int64)
    lists = [np.asarray(face) for face in faces]
    counts = np.fromiter((len(face) for face in lists), dtype=np.int64, count=len(lists))
    corners = np.concatenate(lists) if lists else np.empty(0, dtype=np.int64)
    check_whole(corners)
    return np.ascontiguousarray(corners, dtype=np.int64), counts


def check_whole(numbers: Array) -> None:
    """Refuses rows that are no whole numbers."""
    if numbers.size and not np.issubdtype(numbers.dtype, np.integer):
        raise _native.Error(f"faces must be whole numbers, not {numbers.dtype}")


def gathered(corners: Array, counts: Array) -> Gathered:
    """Faces as one array where all have as many corners, else a list of arrays."""
    if len(counts) and (counts == counts[0]).all():
        return corners.reshape(len(counts), counts[0])
    return np.split(corners, np.cumsum(counts)[:-1]) if len(counts) else []


def _is_path(mesh: Any) -> bool:
    return isinstance(mesh, (str, os.PathLike))


def _arrays(mesh: Any) -> "Tuple[Any, Any, Any]":
    """Vertices, faces and normals of a mesh in memory; the last two may lack."""
    if isinstance(mesh, (np.ndarray, list)):
        return mesh, None, None
    if isinstance(mesh, tuple) and len(mesh) in (2, 3):
        vertices, faces, *normals = mesh
        return vertices, faces, (normals or [None])[0]
    if hasattr(mesh, "polygons") or hasattr(getattr(mesh, "data", None), "polygons"):
        from ._blender import arrays

        vertices, corners, counts = arrays(mesh)
        return vertices, gathered(corners, counts), None
    if hasattr(mesh, "vertices"):
        # A mesh or a cloud of trimesh, or anything that is made as these are.
        return mesh.vertices, getattr(mesh, "faces", None), None
    kind = type(mesh).__name__
    raise _native.Error(f"{kind} is no mesh: give a path, (vertices, faces), or a mesh of trimesh or Blender")
