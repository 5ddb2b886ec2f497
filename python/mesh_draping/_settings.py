"""Presets and settings."""

from __future__ import annotations

import json
from typing import Any, Mapping, Optional

from . import _native
from ._shapes import Path


def presets() -> "list[str]":
    """The names of the presets, the default first."""
    return _native.Settings.names()


def settings(
    preset: Optional[str] = None, *, config: Optional[Path] = None, seed: Optional[int] = None, **changes: Any
) -> str:
    """All settings of a run as a TOML file has them: those that :func:`drape` would use with the same arguments."""
    return resolved(preset, config, seed, changes).toml()


def resolved(
    preset: Optional[str], config: Optional[Path], seed: Optional[int], changes: "Mapping[str, Any]"
) -> _native.Settings:
    """A preset, a TOML file over it, and changes over both."""
    try:
        text = json.dumps(changes)
    except TypeError as error:
        raise _native.Error(f"settings: {error}") from None
    return _native.Settings(preset, config, seed, text)
