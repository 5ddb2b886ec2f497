"""The map of a finished drape."""

from __future__ import annotations

from typing import Any

from . import _native
from ._numpy import Array
from ._shapes import Path, rows


class Warp:
    """What a drape did to space: levels of detail, hair and collision hulls of the source move along."""

    def __init__(self, native: _native.Warp) -> None:
        self._native = native

    @classmethod
    def load(cls, path: Path) -> "Warp":
        """Reads a map from a ``.drape`` file."""
        return cls(_native.Warp.load(path))

    def save(self, path: Path) -> None:
        """Writes the map to a ``.drape`` file, for ``drape apply``."""
        self._native.save(path)

    def apply(self, points: Any) -> Array:
        """The images, shape (n, 3), of points of shape (n, 3) in the units and axes of the drape's source."""
        return self._native.apply(rows(points))
