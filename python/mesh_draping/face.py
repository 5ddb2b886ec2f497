"""Landmarks of faces without a click: ``pip install mesh-draping[face]``.

    from mesh_draping import face
    landmarks = face.mark("head.obj", "scan.ply", "pairs.json")

The shape is looked at from all around, shaded, by a detector of faces (MediaPipe 0.10.21, whose models are in its package: nothing
is downloaded). Around the view in which it is surest, more views are taken; what it finds in each is cast back onto the
surface, and a place is kept where several views agree on it. What a face has no surface at, such as the inside of an open mouth,
is not marked; nor is a face that is a small part of the shape, as on a whole body.
"""

from __future__ import annotations

import json
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

import numpy as np

from . import _native
from ._numpy import Array
from ._shapes import Path, Source, Target, as_source, as_target
from .landmarks import Entry

#: Rows of MediaPipe's face mesh, by what is there. Left and right are those of the person.
PLACES = {
    "nose tip": 1,
    "nose bridge": 168,
    "under the nose": 2,
    "left nostril": 358,
    "right nostril": 129,
    "left eye, outer corner": 263,
    "left eye, inner corner": 362,
    "right eye, outer corner": 33,
    "right eye, inner corner": 133,
    "left brow, outer end": 276,
    "left brow, inner end": 285,
    "right brow, outer end": 46,
    "right brow, inner end": 55,
    "left corner of the mouth": 291,
    "right corner of the mouth": 61,
    "upper lip": 0,
    "lower lip": 17,
    "chin": 152,
    "forehead": 10,
    "left cheek": 425,
    "right cheek": 205,
    "left jaw": 397,
    "right jaw": 172,
}
#: Pixels along the side of a picture: of the first look, and of those that count.
COARSE, FINE = 224, 480
#: Half of what a picture shows, seen from this many times as far.
AWAY = 3.0
#: Turns of the views that count, in degrees, about the surest one.
YAWS, PITCHES = (-30, -15, 0, 15, 30), (-15, 0, 15)
#: Views agree within this share of the face's size.
AGREE = 0.02
#: A place that fewer views agree on is not marked.
LEAST_VIEWS = 3
#: Of a face whose size is to be known, this many places must be on the surface.
LEAST_PLACES = 8


class Mark(NamedTuple):
    """A place of a face."""

    point: Array
    """Where it is: shape (3,), in the shape's units and axes."""
    confidence: float
    """The share of all views in which it was found there, 0 to 1."""


def mark(source: Any, target: Any, path: Optional[Path] = None, *, least: float = 0.2) -> List[Entry]:
    """Landmarks of two faces, as a landmark file has them, each with the lower confidence of both sides.

    ``path``: a file to write them to. ``least``: the confidence from which a place is marked.
    """
    source, target = as_source(source), as_target(target)
    return paired(find(source), find(target), path, least=least)


def paired(
    on_source: Dict[str, Mark], on_target: Dict[str, Mark], path: Optional[Path] = None, *, least: float = 0.2
) -> List[Entry]:
    """Landmarks of places that :func:`find` found: once per template, its places do for all targets."""
    entries: List[Entry] = []
    for name in PLACES:
        if name in on_source and name in on_target:
            both = on_source[name], on_target[name]
            sure = min(m.confidence for m in both)
            places = [{"point": m.point.tolist()} for m in both]
            if sure >= least:
                entries.append({"name": name, "source": places[0], "target": places[1], "confidence": sure})
    if path is not None:
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"landmarks": entries}, file, indent=2)
    return entries


def find(mesh: Any) -> Dict[str, Mark]:
    """The places of a face on a mesh of any kind, by name; none where no face is seen."""
    surface, vertices = _surface(mesh)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    centre, size = (low + high) / 2, float((high - low).max())
    detector = _detector()
    first = _surest(surface, centre, size / 2, detector)
    if first is None:
        return {}
    seen = _places(surface, first, detector)
    seen = seen if seen is None else seen[np.isfinite(seen).all(axis=1)]
    if seen is None or len(seen) < LEAST_PLACES:
        return {}
    face = np.median(seen, axis=0), float(np.ptp(seen, axis=0).max())
    found = [_places(surface, view, detector) for view in _around(first, *face)]
    return _agreed([f for f in found if f is not None], len(found), face[1])


class View(NamedTuple):
    """A camera that looks at a point."""

    centre: Array
    forward: Array
    up: Array
    half: float

    def rays(self, pixels: Array, n: int) -> "tuple[Array, Array]":
        """Origins and directions through places (x, y) of a picture of n by n pixels."""
        right = np.cross(self.forward, self.up)
        x, y = (pixels / n * 2.0 - 1.0).T * self.half
        far = AWAY * self.half * self.forward
        directions = far + x[:, None] * right - y[:, None] * self.up
        origins = np.broadcast_to(self.centre - far, directions.shape)
        return np.ascontiguousarray(origins), np.ascontiguousarray(directions)


def _surface(mesh: Any) -> "tuple[_native.Surface, Array]":
    if isinstance(mesh, Source):
        return _native.Surface.of_source(mesh._native), mesh.vertices
    target: Target = as_target(mesh)
    surface = _native.Surface.of_target(target._native)
    if surface is None:
        raise _native.Error("a face is found on a surface; this is a cloud of points")
    return surface, target.vertices


def _picture(surface: _native.Surface, view: View, n: int) -> Array:
    """The shape as clay, lit from the camera: uint8 of shape (n, n, 3)."""
    grid = np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2) + 0.5
    origins, directions = view.rays(grid, n)
    far = surface.cast(origins, directions)
    is_hit = np.isfinite(far).reshape(n, n)
    points = (origins + np.where(np.isfinite(far), far, 0.0)[:, None] * directions).reshape(n, n, 3)
    normals = np.cross(np.gradient(points, axis=1), np.gradient(points, axis=0))
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    normals = normals / np.where(lengths > 0, lengths, 1.0)
    light = view.forward - 0.4 * view.up
    lit = np.abs(normals @ (light / np.linalg.norm(light)))
    shade = np.where(is_hit, 0.15 + 0.8 * lit, 0.45)
    # The colour of skin: what the detector was trained on.
    return (255 * np.clip(shade[..., None] * np.array([1.0, 0.84, 0.74]), 0, 1)).astype(np.uint8)


def _surest(surface: _native.Surface, centre: Array, half: float, detector: Any) -> Optional[View]:
    """Of views from all around, with each axis up, the one in which a face is seen best."""
    best, most = None, 0.0
    for axis in range(3):
        for sign in (1.0, -1.0):
            up, side = np.zeros(3), np.zeros(3)
            up[axis], side[(axis + 1) % 3] = sign, 1.0
            for turn in range(0, 360, 45):
                view = View(centre, _turned(side, up, turn), up, half)
                sure = detector.confidence(_picture(surface, view, COARSE))
                if sure > most:
                    best, most = view, sure
    return best


def _around(view: View, centre: Array, size: float) -> "list[View]":
    right = np.cross(view.forward, view.up)
    views = []
    for yaw in YAWS:
        for pitch in PITCHES:
            forward = _turned(_turned(view.forward, right, pitch), view.up, yaw)
            up = _turned(view.up, right, pitch)
            up = _turned(up, view.up, yaw)
            views.append(View(centre, forward, up, size))
    return views


def _turned(v: Array, axis: Array, degrees: float) -> Array:
    """Rodrigues' formula."""
    angle = np.radians(degrees)
    c, s = np.cos(angle), np.sin(angle)
    turned: Array = v * c + np.cross(axis, v) * s + axis * float(axis @ v) * (1 - c)
    return turned


def _places(surface: _native.Surface, view: View, detector: Any) -> Any:
    """Where the places are in space by one view, a row each, NaN where there is no surface; None without a face."""
    pixels = detector.places(_picture(surface, view, FINE), FINE)
    if pixels is None:
        return None
    origins, directions = view.rays(pixels, FINE)
    far = surface.cast(origins, directions)[:, None]
    return np.where(np.isfinite(far), origins + np.where(np.isfinite(far), far, 0.0) * directions, np.nan)


def _agreed(found: "Sequence[Array]", n_views: int, size: float) -> Dict[str, Mark]:
    """Places that enough views agree on, each the mean of those that do."""
    marks: Dict[str, Mark] = {}
    if not found:
        return marks
    for name, points in zip(PLACES, np.swapaxes(np.array(found), 0, 1)):
        points = points[np.isfinite(points).all(axis=1)]
        if len(points) == 0:
            continue
        near = points[np.linalg.norm(points - np.median(points, axis=0), axis=1) < AGREE * size]
        if len(near) >= LEAST_VIEWS:
            marks[name] = Mark(near.mean(axis=0), len(near) / n_views)
    return marks


class _Detector:
    """MediaPipe, with the models of its package."""

    def __init__(self) -> None:
        import mediapipe

        faces = mediapipe.solutions
        self._face = faces.face_detection.FaceDetection(model_selection=0, min_detection_confidence=0.3)
        self._mesh = faces.face_mesh.FaceMesh(static_image_mode=True, min_detection_confidence=0.3)

    def confidence(self, picture: Array) -> float:
        """How sure it is of a face, 0 to 1."""
        found = self._face.process(picture).detections
        return max((float(d.score[0]) for d in found), default=0.0) if found else 0.0

    def places(self, picture: Array, n: int) -> Optional[Array]:
        """Pixels (x, y) of the places, a row each; None without a face."""
        found = self._mesh.process(picture).multi_face_landmarks
        if not found:
            return None
        rows = [found[0].landmark[row] for row in PLACES.values()]
        return np.array([[mark.x * n, mark.y * n] for mark in rows])


def _detector() -> _Detector:
    try:
        return _Detector()
    except ImportError as error:
        raise _native.Error(f"finding faces needs `pip install mesh-draping[face]`: {error}") from None
