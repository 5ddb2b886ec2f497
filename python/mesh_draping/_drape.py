"""The drape: at once, and step by step."""

from __future__ import annotations

import json
from functools import cached_property
from typing import Any, Callable, Iterable, Iterator, Optional, Sequence, Union

from . import _native
from ._judge import positions
from ._numpy import Array
from ._settings import resolved as resolved_settings
from ._shapes import Gathered, Path, as_source, as_target, gathered, rows
from ._warp import Warp
from .landmarks import resolved

Step = _native.Step
#: True for a bar of ``tqdm``, or a function that is called with every step.
Progress = Union[None, bool, Callable[[Step], Any]]


def drape(
    source: Any,
    target: Any,
    landmarks: Any = None,
    preset: Optional[str] = None,
    seed: Optional[int] = None,
    *,
    progress: Progress = None,
    **options: Any,
) -> "Result":
    """Drapes the source over the target, led by landmarks; the whole method, to the bits of ``drape transfer``.

    ``source``, ``target``: meshes of any kind (see :mod:`mesh_draping`).
    ``landmarks``: places that belong together, of any kind (see :mod:`mesh_draping.landmarks`); None for none.
    ``preset``: a name of :func:`presets`; "standard" where none is given. ``seed``: of every random draw; 0.
    ``progress``: True for a bar of tqdm, or a function that is called with every :class:`Step`.
    ``options``: everything that :class:`Drape` takes.

    Other Python threads run meanwhile, and Ctrl-C stops it.
    """
    run = Drape(source, target, landmarks, preset, seed, **options)
    return run.run(progress)


class Drape:
    """A drape that is stepped, looked at, changed and cancelled.

        run = Drape("horse.obj", "wolf.obj", "pairs.json")
        for step in run:
            print(step.iteration, step.total)
        result = run.finish()

    ``free``: parts that are carried along and attract nothing; ``rigid``: parts whose pieces move as one body each;
    ``draped``: inner parts that are draped after all. Each is a list of names: groups, objects or materials of the
    source's file, ``property:NAME`` of a PLY file, files of vertex rows, ``hidden``, ``hidden:1`` …, or ``parts`` of
    :class:`Source`.
    ``weights``: how strongly each vertex is attracted, a file of lines "vertex weight" or ``property:NAME``.
    ``hidden``: False drapes inner pieces that no one named like the rest.
    ``symmetric``: True makes the result as symmetric as the source is.
    ``prior``: shapes that the source took before, as results, paths or arrays of shape (n, 3): what to expect of the next one.
    The one of them and those between that fits best is one more start to try, and what the target does not show is taken
    from them.
    ``truth``: where each vertex belongs, to judge by: a path, or an array of shape (n, 3).
    ``start``: a shape of the source that nearly fits, likewise: the result of the frame before. No start is searched then, and
    the run is a third as long.
    ``first_frame``: the result of the first frame of a motion, likewise, beside ``start``: the surface holds to its angles and
    areas, which lead back what slid along it.
    ``smooth_change``: weight of an even change along the surface from where the drape starts: over the frames of a motion less
    trembling, and limbs that lag. 50 is a good value.
    ``config``: a TOML file of settings over those of the preset. ``settings``: single settings over both, by the names of
    :func:`mesh_draping.settings`, such as ``overlap="source-partial"`` or ``sampling={"n_samples": 4000}``.
    """

    def __init__(
        self,
        source: Any,
        target: Any,
        landmarks: Any = None,
        preset: Optional[str] = None,
        seed: Optional[int] = None,
        *,
        free: Sequence[str] = (),
        rigid: Sequence[str] = (),
        draped: Sequence[str] = (),
        weights: Optional[str] = None,
        hidden: bool = True,
        symmetric: bool = False,
        smooth_change: float = 0.0,
        prior: Iterable[Any] = (),
        truth: Any = None,
        start: Any = None,
        first_frame: Any = None,
        config: Optional[Path] = None,
        **settings: Any,
    ) -> None:
        self.source, self.target = as_source(source), as_target(target)
        chosen = resolved_settings(preset, config, seed, settings)
        inputs = _native.Inputs(
            self.source._native,
            self.target._native,
            resolved(landmarks, self.source, self.target),
            free=list(free),
            rigid=list(rigid),
            draped=list(draped),
            weights=weights,
            hidden=hidden,
            symmetric=symmetric,
            smooth_change=smooth_change,
            prior=[shape for shape in (positions(self.source, one) for one in prior) if shape is not None],
        )
        shapes = (positions(self.source, shape) for shape in (truth, start, first_frame))
        self._native = _native.Draping(inputs, chosen, *shapes)

    def step(self) -> Optional[Step]:
        """One iteration; None when the run is over."""
        return self._native.step()

    def __iter__(self) -> Iterator[Step]:
        while (step := self.step()) is not None:
            yield step

    @property
    def iteration(self) -> int:
        """How many iterations are done."""
        return self._native.iteration

    @property
    def n_iterations(self) -> int:
        """How many the run has; it grows where landmarks are changed late."""
        return self._native.n_iterations

    @property
    def vertices(self) -> Array:
        """Where the source's vertices are now: shape (n, 3), in the target's units and axes."""
        return self._native.vertices

    @property
    def initial(self) -> Array:
        """Where they started, likewise."""
        return self._native.initial

    @property
    def notes(self) -> "list[str]":
        """What was assumed and decided so far, in words."""
        return self._native.notes

    def set_landmarks(self, landmarks: Any) -> None:
        """Goes on with other landmarks: they deform the present shape, and the run gets time to settle."""
        self._native.set_landmarks(resolved(landmarks, self.source, self.target))

    def extend(self, n_iterations: int) -> None:
        """Gives the run more iterations."""
        self._native.extend(n_iterations)

    def cancel(self) -> None:
        """Ends it, from any thread: whoever steps it next gets :class:`Cancelled`."""
        self._native.cancel()

    @property
    def is_cancelled(self) -> bool:
        """Whether it was cancelled."""
        return self._native.is_cancelled

    def run(self, progress: Progress = None) -> "Result":
        """All iterations that are left, and the end."""
        show, close = _shown(self, progress)
        try:
            for step in self:
                show(step)
        finally:
            close()
        return self.finish()

    def finish(self) -> "Result":
        """Ends the drape where it is: folds are taken out, the result is judged and explained."""
        return Result(self._native.finish())


def _shown(run: Drape, progress: Progress) -> "tuple[Callable[[Step], Any], Callable[[], Any]]":
    """What shows a step, and what ends that."""
    if progress is None or progress is False:
        return (lambda step: None), (lambda: None)
    if callable(progress):
        return progress, (lambda: None)
    from tqdm.auto import tqdm

    bar = tqdm(total=run.n_iterations, desc="drape", unit="it")

    def show(step: Step) -> None:
        bar.total = step.n_iterations
        bar.set_postfix(total=f"{step.total:.3g}", refresh=False)
        bar.update(1)

    return show, bar.close


class Result:
    """A draped source with its report."""

    def __init__(self, native: _native.Outcome) -> None:
        self._native = native

    @cached_property
    def vertices(self) -> Array:
        """The result: float64 of shape (n, 3), a row per vertex of the source, in the target's units and axes."""
        return self._native.vertices

    @cached_property
    def initial(self) -> Array:
        """Where the drape started, likewise."""
        return self._native.initial

    @cached_property
    def faces(self) -> Gathered:
        """The source's faces, in its order: int64 of shape (m, k) where all have k corners, else a list of arrays."""
        return gathered(*self._native.source.polygons)

    @cached_property
    def distances(self) -> Array:
        """Distance of each vertex to the target, shape (n,), in longest sides of the target's box."""
        return self._native.distances

    @cached_property
    def _told(self) -> "dict[str, Any]":
        return json.loads(self._native.json())

    @property
    def figures(self) -> "dict[str, float]":
        """Figures by name, as the command line's ``--json``; lengths in longest sides of the target's box."""
        return self._told["figures"]

    @property
    def report(self) -> "dict[str, Any]":
        """Every measure of the result."""
        return self._told["report"]

    @property
    def explanation(self) -> "dict[str, Any]":
        """Where the result is worst and why, and how near it is part by part."""
        return self._told["explanation"]

    @property
    def history(self) -> "dict[str, list[Any]]":
        """The terms of the loss over the run: pairs (iteration, value), unweighted."""
        return self._told["history"]

    @property
    def notes(self) -> "list[str]":
        """What was found in the inputs, assumed, left out and repaired, in words."""
        return self._told["notes"]

    @property
    def settings(self) -> "dict[str, Any]":
        """The settings of the run."""
        return self._told["settings"]

    def write(self, path: Path) -> None:
        """Writes the source's file with its vertices at the result: in its own format nothing else changes."""
        self._native.write(path)

    def carry(self, displacements: Any) -> Array:
        """Displacements from the rest shape, such as those of shape keys, shape (n, 3), taken to the result."""
        return self._native.carry(rows(displacements))

    def bake(
        self,
        colors: Optional[Path] = None,
        *,
        normal: Optional[Path] = None,
        displacement: Optional[Path] = None,
        size: int = 2048,
        depth: int = 8,
        painted: Optional[Path] = None,
    ) -> "list[str]":
        """Bakes the target's picture and colours into the source's texture coordinates, as a PNG file; what is worth knowing
        about it, in words.

        ``normal``: a PNG file for the target's normals, in the coordinates of the result (object space).
        ``displacement``: a PNG file for how far the target lies out of the result, with 16 bits: the middle is nothing; what
        white and black mean is among the words that come back.
        ``size``: texels along a side. ``depth``: 8 or 16 bits a sample of colours and normals.
        ``painted``: the target's file with its colours, where the target was not read from one.
        """
        return self._native.bake((colors, normal, displacement), size, depth, painted)

    def warp(self) -> Warp:
        """What the drape did to space, to do it to other points."""
        return Warp(self._native.warp())

    def to_trimesh(self) -> Any:
        """The result as ``trimesh.Trimesh``, vertices in their order; polygons become triangles."""
        import trimesh

        triangles = trimesh.geometry.triangulate_quads(self.faces)
        return trimesh.Trimesh(self.vertices, triangles, process=False)

    def __str__(self) -> str:
        return self._native.text()

    def __repr__(self) -> str:
        return f"Result({len(self.vertices)} vertices, Q {self.figures['q_transfer']:.4f})"
