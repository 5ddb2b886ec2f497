"""Landmarks: read and written in every form, looked at, mirrored, and where one more would help.

Wherever landmarks are taken, they may be

- the path of a landmark file of any form,
- a list of entries as in such a file: ``{"name": "nose", "source": {"vertex": 12}, "target": {"point": [0, 2, 0.3]}}``, with
  a ``"weight"`` if it is not 1, or a curve: ``{"curve": {"source": [7, 8, 12], "target": [[0, 1, 0], [1, 1, 0]]}}``,
- a list of pairs ``(row of the source's vertex, target)`` where the target is a row of its vertices or a point,
- two arrays ``(rows of the source's vertices, shape (k,); points of the target, shape (k, 3))``.
"""

from __future__ import annotations

import json
import numbers
import os
import warnings
from typing import Any, Iterable, List, Mapping, NamedTuple

from . import _native
from ._numpy import np
from ._shapes import Path, Source, Target, as_source, as_target

#: An entry of a landmark file.
Entry = Mapping[str, Any]


class Check(NamedTuple):
    """What looks wrong with landmarks."""

    residuals: "list[float]"
    """How far each is from where the others expect it, in longest sides of the target's box; NaN where nothing tells."""
    findings: "list[str]"
    """What looks wrong, in words; none where nothing does."""


def read(path: Path, source: Any, target: Any) -> "List[Entry]":
    """The entries of a landmark file of any form."""
    source, target = as_source(source), as_target(target)
    return _entries(_native.Landmarks.read(path, source._native, target._native), source, target)


def write(landmarks: Any, source: Any, target: Any, path: Path, form: str = "json") -> float:
    """Writes landmarks as ``form``: json (nothing is lost), lists, text, ids or points.

    Gives how far the farthest place had to move to the nearest vertex, where the form holds vertices only. Warns of weights
    and curves that the form has no place for.
    """
    source, target = as_source(source), as_target(target)
    text, moved, lost = resolved(landmarks, source, target).text(source._native, target._native, form)
    _warn(lost)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return moved


def read_wrap(on_source: Path, on_target: Path, source: Any, target: Any) -> "List[Entry]":
    """The entries of the two point files of Faceform Wrap, ``[[triangle, u, v], …]`` or the same by name."""
    source, target = as_source(source), as_target(target)
    found = _native.Landmarks.read_wrap(on_source, on_target, source._native, target._native)
    return _entries(found, source, target)


def write_wrap(landmarks: Any, source: Any, target: Any, on_source: Path, on_target: Path) -> None:
    """Writes landmarks as the two point files of Faceform Wrap."""
    source, target = as_source(source), as_target(target)
    *texts, lost = resolved(landmarks, source, target).wrap_texts(source._native, target._native)
    _warn(lost)
    for path, text in zip((on_source, on_target), texts):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


def check(landmarks: Any, source: Any, target: Any) -> Check:
    """How far each landmark is from where the others expect it, and what looks wrong."""
    source, target = as_source(source), as_target(target)
    found = resolved(landmarks, source, target).check(source._native, target._native)
    return Check(*found)


def suggest(landmarks: Any, source: Any, target: Any, n: int = 3) -> "List[Entry]":
    """The ``n`` most useful places to mark next, most useful first.

    Each has a source, a first guess of its target, ``distance_to_landmarks`` along the source in longest sides of its
    box (None on a piece without a landmark), and ``initial_miss`` in longest sides of the target's box.
    """
    source, target = as_source(source), as_target(target)
    found = resolved(landmarks, source, target).suggest(source._native, target._native, n)
    return json.loads(found)


def mirror(landmarks: Any, source: Any, target: Any) -> "List[Entry]":
    """These landmarks, and those of the other half of a symmetric source."""
    source, target = as_source(source), as_target(target)
    mirrored = resolved(landmarks, source, target).mirrored(source._native, target._native)
    return _entries(mirrored, source, target)


def resolved(landmarks: Any, source: Source, target: Target) -> _native.Landmarks:
    """Landmarks of any kind, looked up on both shapes."""
    if landmarks is None:
        return _native.Landmarks.none()
    if isinstance(landmarks, (str, os.PathLike)):
        return _native.Landmarks.read(landmarks, source._native, target._native)
    entries = _listed(landmarks)
    if not entries:
        return _native.Landmarks.none()
    text = json.dumps({"landmarks": entries}, default=_plain)
    return _native.Landmarks.parse(text, source._native, target._native)


def _entries(landmarks: _native.Landmarks, source: Source, target: Target) -> "List[Entry]":
    text, _, _ = landmarks.text(source._native, target._native, "json")
    return json.loads(text)["landmarks"]


def _warn(lost: "list[str]") -> None:
    """Says what a form of landmark file leaves out."""
    for words in lost:
        warnings.warn(f"{words}: this form has no place for it", stacklevel=3)


def _listed(landmarks: Any) -> "List[Entry]":
    if isinstance(landmarks, Mapping):
        return list(landmarks.get("landmarks", []))
    if _is_two_arrays(landmarks):
        landmarks = zip(*landmarks)
    return [_entry(item) for item in landmarks]


def _is_two_arrays(landmarks: Any) -> bool:
    is_pair = isinstance(landmarks, (tuple, list)) and len(landmarks) == 2
    return is_pair and all(isinstance(part, np.ndarray) and part.ndim == n for n, part in enumerate(landmarks, 1))


def _entry(item: Any) -> Entry:
    if isinstance(item, Mapping):
        return item
    try:
        vertex, target = item
    except (TypeError, ValueError):
        raise _native.Error(f"{item!r} is no landmark: give an entry or a pair (vertex, target)") from None
    is_row = isinstance(target, numbers.Integral)
    place = {"vertex": int(target)} if is_row else {"point": [float(x) for x in target]}
    return {"source": {"vertex": int(vertex)}, "target": place}


def _plain(value: Any) -> Any:
    """Numbers and arrays of numpy as JSON has them."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, Iterable):
        return list(value)
    raise _native.Error(f"{value!r} cannot be part of a landmark")
