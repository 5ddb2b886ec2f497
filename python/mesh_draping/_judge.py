"""The judge, and the initial deformation alone."""

from __future__ import annotations

import json
from typing import Any, NamedTuple

from . import _native
from ._numpy import Array
from ._shapes import Path, Source, as_source, as_target, rows
from .landmarks import resolved


class Judgement(NamedTuple):
    """What the judge says of a shape."""

    figures: "dict[str, float]"
    """Figures by name, as the command line's ``--json``; lengths in longest sides of the target's box."""
    report: "dict[str, Any]"
    """Every measure."""


def metrics(source: Any, result: Any, target: Any, landmarks: Any = None, *, truth: Any = None) -> Judgement:
    """Judges any shape of the source: ours, another tool's, or a hand's.

    ``result`` and ``truth`` (where each vertex belongs) are paths of meshes with the source's vertices, or arrays of
    shape (n, 3), in the target's units and axes.
    """
    source, target = as_source(source), as_target(target)
    places = resolved(landmarks, source, target)
    result, truth = positions(source, result), positions(source, truth)
    told = json.loads(_native.metrics(source._native, result, target._native, places, truth))
    return Judgement(told["figures"], told["report"])


def init(source: Any, target: Any, landmarks: Any = None, *, method: str = "standard") -> Array:
    """The source brought to its landmarks and no further: shape (n, 3), in the target's units and axes.

    ``method``: standard, paper or affine.
    """
    source, target = as_source(source), as_target(target)
    places = resolved(landmarks, source, target)
    shape, _ = _native.initial(source._native, target._native, places, method)
    return shape


def positions(source: Source, shape: Any) -> "Array | None":
    """Positions for the source's vertices from a path, a mesh or an array."""
    if shape is None:
        return None
    if isinstance(shape, (str, bytes)) or hasattr(shape, "__fspath__"):
        return _native.read_vertices(source._native, shape)
    return rows(getattr(shape, "vertices", shape))
