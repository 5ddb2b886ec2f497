"""Creatures built in code, whose every vertex has a known true place: to try things on, and to measure them."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, Iterable, Iterator, List, NamedTuple, Union

from . import _native
from ._numpy import Array, np
from ._shapes import Gathered, Path, gathered

if TYPE_CHECKING:
    from pathlib import Path as _Path

#: Kinds of creature.
PLANS = ("quadruped", "person", "bird", "insect", "head")
#: States of the target.
VARIANTS = ("mesh", "cloud", "cracked", "half-scan")


class Pair(NamedTuple):
    """A source, a target in other triangles, and where each vertex of the source truly belongs."""

    source: "tuple[Array, Gathered]"
    """Vertices (n, 3) and faces."""
    target: "Union[Array, tuple[Array, Gathered]]"
    """Vertices and faces, or the points of a cloud."""
    landmarks: "List[dict[str, Any]]"
    """Entries of a landmark file."""
    truth: Array
    """Where each vertex of the source truly belongs: shape (n, 3)."""


def pair(
    plan: str = "quadruped",
    seed: int = 0,
    *,
    angle: float = 60.0,
    ratio: float = 1.75,
    landmarks: int = 16,
    variant: str = "mesh",
) -> Pair:
    """The template of a plan, to be draped over the individual of a seed.

    ``angle``: largest turn of a joint, 0 to 120 degrees. ``ratio``: largest ratio of lengths, 1 to 3. ``landmarks``: how
    many, 0 to 20. ``variant``: mesh, cloud, cracked or half-scan.
    """
    return _pair(_made(plan, seed, angle, ratio, landmarks, variant))


def motion(
    plan: str = "quadruped",
    seed: int = 0,
    n_frames: int = 60,
    *,
    angle: float = 60.0,
    ratio: float = 1.75,
    landmarks: int = 16,
) -> "Iterator[Pair]":
    """The frames of a creature in motion: joints turn there and back, as a sine, each frame in triangles of its own.

    ``angle``: largest turn of a joint on the way. Others as for :func:`pair`.
    """
    for frame in range(n_frames):
        turn = angle * 0.5 * (1.0 - math.cos(2.0 * math.pi * frame / n_frames))
        made = _native.Creature.posed(
            plan, seed=seed, frame=frame, angle=turn, ratio=ratio, landmarks=landmarks
        )
        yield _pair(made)


def _pair(made: _native.Creature) -> Pair:
    points, (corners, counts) = made.target_vertices, made.target_polygons
    return Pair(
        (made.source_vertices, gathered(*made.source_polygons)),
        (points, gathered(corners, counts)) if len(counts) else points,
        json.loads(made.landmarks_json())["landmarks"],
        made.truth,
    )


def write(folder: Path, plan: str = "quadruped", seed: int = 0, **dial: Any) -> _Path:
    """Writes a pair as ``source.obj`` (with UVs and groups), ``target.ply`` and ``landmarks.json`` into a folder.

    ``dial``: as for :func:`pair`.
    """
    from pathlib import Path as _Path

    made = _made(plan, seed, **dial)
    folder = _Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "source.obj").write_text(made.source_obj())
    (folder / "target.ply").write_text(made.target_ply())
    (folder / "landmarks.json").write_text(made.landmarks_json())
    np.save(folder / "truth.npy", made.truth)
    return folder


def run(
    plans: Iterable[str] = PLANS, seeds: Iterable[int] = (0, 1), preset: str = "standard", **dial: Any
) -> "List[dict[str, Any]]":
    """Drapes creatures and judges them by their truth; a row of figures for each.

    ``dial``: as for :func:`pair`. The command ``drape bench`` does the same with files, tables and pictures.
    """
    from ._drape import drape

    seeds = list(seeds)
    rows = []
    for plan in plans:
        for seed in seeds:
            source, target, landmarks, truth = pair(plan, seed, **dial)
            result = drape(source, target, landmarks, preset, truth=truth)
            rows.append({"plan": plan, "seed": seed, "preset": preset, **result.figures})
    return rows


def _made(
    plan: str,
    seed: int,
    angle: float = 60.0,
    ratio: float = 1.75,
    landmarks: int = 16,
    variant: str = "mesh",
) -> _native.Creature:
    return _native.Creature(
        plan, seed=seed, angle=angle, ratio=ratio, landmarks=landmarks, variant=variant
    )
